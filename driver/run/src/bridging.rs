//! Runs what a case of kind "bridging" asks for: σ(w), the notched beam, and beams made at random.

use crate::columns::{self, BEAM, BRIDGING, Group};
use crate::columns::{BeamRow, BridgingRow, ScatterRow};
use crate::number::{rounded, significant};
use crate::program::About;
use crate::signals::{self, Interrupt};
use pullout_bridging::{
    Average, BeamLoad, Beams, Bond, BridgingFibre, Composite, CrackTotals, CrackWork, Curve, EurocodeClass, Fibre,
    Inclination, Invalid, LayeredBeam, Matrix, ModelCode2010, NotchedBeam, Orientation, Polyline, RESIDUAL_CMOD,
    Residual, Scatter, SectionLaw, Sides, StrengthClass, Table, averages, averages_with_shares, quantile, scatter,
    wall_zones,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// CMOD to which a beam is tested, mm (EN 14651).
const LAST_CMOD: f64 = 4.0;
/// Number of CMODs of the results in addition to those of the standard, narrower at the beginning.
const CMODS: usize = 81;
/// CMOD up to which f_L is taken, mm (EN 14651).
const LIMIT_CMOD: f64 = 0.05;
/// w_u of the Model Code's linear model, mm.
const ULTIMATE_OPENING: f64 = 2.5;
/// Openings at which σ is evaluated unless the case says otherwise: the last, mm, and how many, closer at the
/// beginning. Strengths of beams take them too, on to the last CMOD: a crack opens by less than the CMOD.
pub const OPENINGS: (f64, usize) = (3.5, 200);
/// Load of a curve's end, as a part of its peak, below which nothing is left.
const NEGLIGIBLE_LOAD: f64 = 0.01;
/// Openings at which such a part is looked for.
const FEW_OPENINGS: usize = 10;
/// Part of σ_f beyond the largest angle of the curves that is worth a warning.
const NOTICED_SHARE: f64 = 1e-3;
/// Difference of work by straight lines between the rows, as a part of the whole work, that is worth a warning.
const NOTICED_BY_ROWS: f64 = 0.01;
/// Openings up to which the work is given, mm.
const WORK_TO: [f64; 3] = [0.5, 2.5, 3.5];
/// Quantiles that are given.
pub(crate) const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];

/// A run of fibres across a crack.
#[derive(Clone, Debug)]
pub struct BridgingProgram {
    /// Properties that programs of all kinds have.
    pub about: About,
    /// The fibre.
    pub fibre: Fibre,
    /// Source of a fibre's load.
    pub source: LoadSource,
    /// Sides of the crack from which fibres pull out.
    pub sides: Sides,
    /// V_f.
    pub volume_fraction: f64,
    /// η_E: the matrix's part in the stretch of the fibre.
    pub modular_ratio: f64,
    /// The matrix.
    pub matrix: Matrix,
    /// Directions of the fibres.
    pub orientation: Orientation,
    /// w_a, mm.
    pub activation: f64,
    /// Openings, mm, from 0.
    pub openings: Vec<f64>,
    /// The test.
    pub beam: Option<NotchedBeam>,
    /// Beams made at random.
    pub scatter: Option<Scatter>,
    /// Tables of σ(w) for other programs.
    pub tables: ForeignTables,
}

/// Tables of σ(w) for other programs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForeignTables {
    /// Whether ABAQUS's is written.
    pub abaqus: bool,
    /// Width of the elements that a smeared crack localises in, mm, if its strains are written.
    pub crack_band: Option<f64>,
}

/// Source of a fibre's load.
#[derive(Clone, Debug)]
pub enum LoadSource {
    /// A bond law, and the effect of the inclination angle on it.
    Bond(Bond, Inclination),
    /// Curves of tests.
    Curves(Curves),
    /// Curves of runs of a specimen.
    Simulated(Simulations),
}

/// Curves of tests of one fibre.
#[derive(Clone, Debug)]
pub struct Curves {
    /// The curves.
    pub curves: Vec<Curve>,
    /// Degrees beyond which fibres carry nothing.
    pub cut_deg: f64,
    /// Effect of the angle where all curves are at 0°.
    pub inclination: Option<Inclination>,
    /// Factor on all loads.
    pub scale: f64,
}

/// Runs of a specimen with one fibre.
#[derive(Clone, Debug)]
pub struct Simulations {
    /// The specimen's case.
    pub base: PathBuf,
    /// Those that a table needs, except for lengths that are too short to be run.
    pub runs: Vec<FibreSimulation>,
    /// Embedded lengths of the table, mm.
    pub lengths: Vec<f64>,
    /// Degrees beyond which fibres carry nothing.
    pub cut_deg: f64,
    /// The folder that keeps results for all that need them.
    pub cache: PathBuf,
}

/// A run of a specimen with one fibre.
#[derive(Clone, Debug)]
pub struct FibreSimulation {
    /// Degrees.
    pub angle_deg: f64,
    /// mm.
    pub embedded: f64,
    /// Overrides as texts of `--set`.
    pub overrides: Vec<String>,
}

impl Simulations {
    /// Curves for all lengths of the table from those of the runs: what is too short to be run is taken in proportion to
    /// the shortest one at the angle.
    pub fn complete(&self, run: &[Curve]) -> Vec<Curve> {
        let mut all = run.to_vec();
        for shortest in run {
            let same = |curve: &&Curve| curve.angle_deg == shortest.angle_deg;
            if run.iter().filter(same).any(|other| other.embedded < shortest.embedded) {
                continue;
            }
            all.extend(self.lengths.iter().filter(|length| **length < shortest.embedded).map(|&embedded| {
                let part = embedded / shortest.embedded;
                let scaled = |values: &[f64]| values.iter().map(|value| part * value).collect();
                Curve { embedded, slip: scaled(&shortest.slip), load: scaled(&shortest.load), ..*shortest }
            }));
        }
        all
    }
}

impl BridgingProgram {
    /// Columns of `bridging.csv`, then those of `beam.csv`.
    pub fn columns(&self) -> Vec<String> {
        let bridging = columns::names_without(BRIDGING, self.left_out());
        let beam = self.beam.map(|_| columns::names_without(BEAM, self.left_out()));
        bridging.into_iter().chain(beam.into_iter().flatten()).collect()
    }

    /// The columns that no beams were made for.
    pub fn left_out(&self) -> &'static [Group] {
        if self.scatter.is_none() { &[Group::Band] } else { &[] }
    }

    /// The last opening that results depend on, mm: the case's, or with a beam its last CMOD.
    fn last_opening(&self) -> f64 {
        let last = self.openings.last().copied().unwrap_or_default();
        if self.beam.is_some() { last.max(LAST_CMOD) } else { last }
    }

    /// Openings from which strengths of beams are computed: the case's, and with them those of [`OPENINGS`], in the same
    /// manner on to the last CMOD.
    fn openings_of_beam(&self) -> Vec<f64> {
        let (end, count) = OPENINGS;
        let graded = (0_u32..).map(|k| end * (f64::from(k) / (count - 1) as f64).powi(2));
        let mut all: Vec<f64> = graded.take_while(|opening| *opening < LAST_CMOD).chain([LAST_CMOD]).collect();
        all.extend(&self.openings);
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// Returns the assumptions where the curves of fibres give no information; `simulated` are the curves of
    /// [`LoadSource::Simulated`].
    ///
    /// # Errors
    /// Numbers without sense.
    pub fn assumptions(&self, simulated: &[Curve]) -> Result<Vec<String>, Invalid> {
        let (curves, cut_deg, name) = match &self.source {
            LoadSource::Bond(..) => return Ok(Vec::new()),
            LoadSource::Curves(of) => (of.curves.as_slice(), of.cut_deg, "curve"),
            LoadSource::Simulated(simulations) => (simulated, simulations.cut_deg, "run"),
        };
        let last = self.last_opening();
        let mut warnings = Vec::from_iter(cut_short(curves, name, last));
        let widest = curves.iter().map(|curve| curve.angle_deg).fold(0.0, f64::max);
        let is_given = matches!(&self.source, LoadSource::Curves(Curves { inclination: Some(_), .. }));
        if widest < cut_deg && !is_given {
            let share = self.share_beyond(widest, simulated)?;
            if share > NOTICED_SHARE {
                warnings.push(format!(
                    "fibres at more than {}°, the largest angle of the curves, carry up to {} % of the fibres' stress: up to cut_deg, {}°, their load is assumed to be that at {0}°",
                    number(widest),
                    significant(100.0 * share, 2),
                    number(cut_deg),
                ));
            }
        }
        Ok(warnings)
    }

    /// The greatest part of σ_f that fibres at more than an angle carry, at any of a few openings.
    fn share_beyond(&self, angle_deg: f64, simulated: &[Curve]) -> Result<f64, Invalid> {
        let source = match &self.source {
            LoadSource::Curves(curves) => LoadSource::Curves(Curves { cut_deg: angle_deg, ..curves.clone() }),
            LoadSource::Simulated(simulations) => {
                LoadSource::Simulated(Simulations { cut_deg: angle_deg, ..simulations.clone() })
            }
            LoadSource::Bond(..) => return Ok(0.0),
        };
        let within = Self { source, ..self.clone() }.composite(simulated)?;
        let all = self.composite(simulated)?;
        let few = self.openings.iter().skip(1).step_by(self.openings.len().div_ceil(FEW_OPENINGS));
        let share = |&opening: &f64| {
            let [all, within] = [&all, &within].map(|composite| composite.average(opening).stress);
            if all > 0.0 { 1.0 - within / all } else { 0.0 }
        };
        Ok(few.map(share).fold(0.0, f64::max))
    }

    /// The fibres in their matrix; `simulated` are the curves of [`LoadSource::Simulated`].
    ///
    /// # Errors
    /// Numbers without sense.
    pub fn composite(&self, simulated: &[Curve]) -> Result<Composite, Invalid> {
        let table = |curves: &[Curve], cut_deg: f64, inclination: Option<Inclination>| {
            let table = Table::new(curves, cut_deg, self.fibre.length)?;
            BridgingFibre::of_table(self.fibre, table, inclination, self.sides)
        };
        let fibre = match &self.source {
            LoadSource::Bond(bond, inclination) => {
                BridgingFibre::new(self.fibre, bond, *inclination, self.sides, self.modular_ratio)?
            }
            LoadSource::Curves(Curves { curves, cut_deg, inclination, scale }) => {
                let scaled = |curve: &Curve| {
                    let load = curve.load.iter().map(|load| scale * load).collect();
                    Curve { load, ..curve.clone() }
                };
                table(&curves.iter().map(scaled).collect::<Vec<_>>(), *cut_deg, *inclination)?
            }
            LoadSource::Simulated(simulations) => table(&simulations.complete(simulated), simulations.cut_deg, None)?,
        };
        Composite::new(fibre, self.volume_fraction, &self.orientation, self.matrix, self.activation)
    }
}

/// Results.
#[derive(Clone, Debug, Default)]
pub struct BridgingResults {
    /// Over the openings.
    pub rows: Vec<BridgingRow>,
    /// Over the CMOD.
    pub beam: Vec<BeamRow>,
    /// The beams made at random.
    pub scatter: Vec<ScatterRow>,
    /// Curves of runs of a specimen.
    pub curves: Vec<Curve>,
    /// Results in a few numbers.
    pub findings: Findings,
    /// Things the user should know.
    pub warnings: Vec<String>,
}

/// Bridging in a few numbers, as `summary.json` has them. Stresses in MPa, lengths in mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// Unit of each column of `bridging.csv` and `beam.csv`.
    pub units: BTreeMap<String, String>,
    /// η: fibres through the crack over those of fibres that are all perpendicular to it.
    pub efficiency: f64,
    /// η by the zones of Dupont and Vandewalle, of a section with walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub efficiency_by_zones: Option<f64>,
    /// Fibres through a square centimetre.
    pub fibres_per_cm2: f64,
    /// Greatest σ, and its opening.
    pub sigma_peak: f64,
    /// See above.
    pub w_peak: f64,
    /// Greatest σ of the fibres alone, and its opening.
    pub sigma_fibre_peak: f64,
    /// See above.
    pub w_fibre_peak: f64,
    /// ∫σ dw, N/mm, up to openings.
    pub work: Vec<WorkToOpening>,
    /// Greatest estimate of the error of the fibres' stress over its peak.
    pub error: f64,
    /// The runs that the curves of fibres are of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulations: Option<SimulationFindings>,
    /// Results of the notched beam by the mean σ(w).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beam: Option<BeamFindings>,
    /// Results of the beams made at random.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scatter: Option<ScatterFindings>,
}

/// Findings of the runs of fibres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SimulationFindings {
    /// Number of curves that the table has from them.
    pub runs: usize,
    /// Number of these that existed before.
    pub kept: usize,
    /// Number of those that stopped early, after their load had fallen to half the peak.
    #[serde(default)]
    pub unfinished: usize,
    /// CPU time of all of them, s, including those that existed before.
    pub cpu_time_s: f64,
}

/// Work of the crack.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WorkToOpening {
    /// Opening, mm.
    pub to: f64,
    /// N/mm.
    pub work: f64,
    /// Estimate of its error, N/mm.
    #[serde(default)]
    pub error: f64,
}

/// Strengths of a notched beam, MPa.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BeamFindings {
    /// f_L.
    #[serde(rename = "f_L")]
    pub limit: f64,
    /// f_R1 … f_R4.
    #[serde(rename = "f_R")]
    pub residual: [f64; 4],
    /// Strengths by the fib Model Code 2010 from the mean f_R1 and f_R3, for w_u = 2.5 mm.
    pub model_code_2010: CodeFindings,
}

/// See [`ModelCode2010`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CodeFindings {
    /// f_Ftu of the rigid-plastic model.
    #[serde(rename = "f_Ftu_rigid_plastic")]
    pub rigid_plastic: f64,
    /// f_Fts of the linear model,
    #[serde(rename = "f_Fts")]
    pub serviceability: f64,
    /// and its f_Ftu.
    #[serde(rename = "f_Ftu")]
    pub ultimate: f64,
    /// σ(w) where the linear model has f_Fts and f_Ftu: at 0.5 mm and at w_u.
    pub sigma: [f64; 2],
}

/// Scatter of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Coefficient of variation.
    pub cv: f64,
    /// 5 % quantile: the characteristic value.
    pub characteristic: f64,
    /// 95 % quantile.
    pub upper: f64,
}

/// Findings of beams made at random.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ScatterFindings {
    /// Number of beams.
    pub beams: usize,
    /// Fibres across the ligament.
    pub fibres: Spread,
    /// f_L.
    #[serde(rename = "f_L")]
    pub limit: Spread,
    /// f_R1 … f_R4.
    #[serde(rename = "f_R")]
    pub residual: [Spread; 4],
    /// Class of the fib Model Code 2010 by the characteristic values; none below all of them.
    pub class: Option<String>,
    /// Class of EN 1992-1-1:2023, annex L, by the characteristic values; none below all of them.
    #[serde(default)]
    pub class_en_1992_2023: Option<String>,
    /// Whether fibres may replace bars: f_R1k/f_Lk > 0.4, f_R3k/f_R1k > 0.5.
    pub structural: bool,
}

impl Spread {
    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let cv = if mean == 0.0 { 0.0 } else { variance.sqrt() / mean };
        Self { mean, cv, characteristic: quantile(values, QUANTILES[0]), upper: quantile(values, QUANTILES[2]) }
    }
}

/// CMODs at which a beam's results are given: those of the standard among others.
fn cmods() -> Vec<f64> {
    let even = (0..CMODS).map(|k| LAST_CMOD * (k as f64 / (CMODS - 1) as f64).powi(2));
    let mut all: Vec<f64> = even.chain(RESIDUAL_CMOD).chain([LIMIT_CMOD]).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Warns of curves that end with a load before the last opening and extraction: what follows is a straight line.
fn cut_short(curves: &[Curve], name: &str, last: f64) -> Option<String> {
    let mut short = curves.iter().filter_map(|curve| {
        let (slip, load) = (*curve.slip.last()?, *curve.load.last()?);
        let peak = curve.load.iter().copied().fold(0.0, f64::max);
        (slip < last.min(curve.embedded) && load > NEGLIGIBLE_LOAD * peak).then_some((curve, slip, load))
    });
    let (curve, slip, load) = short.next()?;
    let others = match short.count() {
        0 => String::new(),
        others => format!(" (and {others} more)"),
    };
    Some(format!(
        "fibre at {}°, {} mm{others}: its {name} ends at a slip of {} mm with {} N; beyond it the load is assumed to fall linearly to 0 at extraction",
        number(curve.angle_deg),
        number(curve.embedded),
        number(slip),
        number(load)
    ))
}

fn number(value: f64) -> String {
    significant(value, 4)
}

/// Runs a case to its end, with the simulated curves of fibres if it asks for them.
///
/// # Errors
/// A message: numbers without sense, a signal.
pub fn complete(
    program: &BridgingProgram,
    simulated: Option<(Vec<Curve>, SimulationFindings)>,
    threads: NonZeroUsize,
) -> Result<(Composite, BridgingResults), String> {
    let (curves, simulations) = simulated.unzip();
    let curves = curves.unwrap_or_default();
    let composite = program.composite(&curves).map_err(|error| error.to_string())?;
    let mut results = run(program, &composite, threads)?;
    results.findings.simulations = simulations;
    results.warnings.extend(program.assumptions(&curves).map_err(|error| error.to_string())?);
    results.curves = curves;
    Ok((composite, results))
}

/// Runs it by so many threads; the results have the same bits with any number.
///
/// # Errors
/// Numbers without sense, results that are no finite numbers, or no threads.
pub fn run(program: &BridgingProgram, composite: &Composite, threads: NonZeroUsize) -> Result<BridgingResults, String> {
    let threads = rayon::ThreadPoolBuilder::new().num_threads(threads.get());
    let pool = threads.build().map_err(|error| error.to_string())?;
    let results = pool.install(|| run_here(program, composite))?;
    finite_strengths(&results)?;
    Ok(results)
}

/// Refuses averages that are not finite.
fn finite(fibres: &[Average]) -> Result<(), String> {
    let unsound = fibres.iter().find_map(|average| {
        let Average { stress, active, ruptured, spalled_mean, error, .. } = *average;
        Some((average.opening, first_not_finite([stress, active, ruptured, spalled_mean, error])?))
    });
    unsound.map_or(Ok(()), |(opening, value)| {
        Err(format!(
            "σ of the fibres at w = {opening} mm is {value}: a number of the case is far too large or too small"
        ))
    })
}

/// Refuses loads and strengths of beams that are not finite.
fn finite_strengths(results: &BridgingResults) -> Result<(), String> {
    let unsound = results.beam.iter().find_map(|BeamRow { load, strength, quantiles }| {
        let BeamLoad { force, neutral_axis, rotation, .. } = *load;
        let value = first_not_finite([force, neutral_axis, rotation, *strength].into_iter().chain(*quantiles))?;
        Some((format!("the beam at a CMOD of {} mm", load.cmod), value))
    });
    let of_scatter = |ScatterRow { beam, residual, .. }: &ScatterRow| {
        let value = first_not_finite(residual.residual.into_iter().chain([residual.limit]))?;
        Some((format!("beam {beam}"), value))
    };
    unsound.or_else(|| results.scatter.iter().find_map(of_scatter)).map_or(Ok(()), |(of, value)| {
        Err(format!("the load of {of} is {value}: a number of the case is far too large or too small"))
    })
}

fn first_not_finite(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    values.into_iter().find(|value| !value.is_finite())
}

fn run_here(program: &BridgingProgram, composite: &Composite) -> Result<BridgingResults, String> {
    let message = |error: Invalid| error.to_string();
    let openings = &program.openings;
    let (fibres, shares): (Vec<Average>, Vec<[f64; 9]>) = averages_with_shares(composite, openings).into_iter().unzip();
    finite(&fibres)?;
    let mut rows: Vec<BridgingRow> = fibres
        .iter()
        .zip(shares)
        .map(|(fibres, shares)| BridgingRow {
            fibres: *fibres,
            matrix: composite.matrix_stress(fibres.opening),
            // of no stress there are no shares
            shares: if fibres.stress > 0.0 { shares } else { [f64::NAN; 9] },
            quantiles: [0.0; 3],
        })
        .collect();
    let findings = findings(program, composite, &fibres).map_err(message)?;
    let mut results = BridgingResults { findings, ..BridgingResults::default() };
    results.warnings.extend(few_rows(&rows, &results.findings.work));
    if let Some(geometry) = &program.beam {
        let openings = program.openings_of_beam();
        let fibres = averages_also_at(composite, fibres, &openings);
        finite(&fibres)?;
        let law = composite.law(&fibres);
        let section = [SectionLaw::new(&program.matrix, &law, geometry.hinge())];
        if section[0].snaps {
            let warning = "σ(w) falls so steeply that layers of the beam's hinge snap: each takes the least opening";
            results.warnings.push(warning.into());
        }
        let tested = LayeredBeam::new(*geometry, &section, &program.matrix);
        let cmods = cmods();
        let row = |&cmod: &f64| {
            let load = tested.at(cmod);
            BeamRow { load, strength: geometry.flexural_strength(load.force), quantiles: [0.0; 3] }
        };
        results.beam = cmods.iter().map(row).collect();
        let Residual { limit, residual } = tested.residual();
        let code = ModelCode2010::new(residual[0], residual[2], ULTIMATE_OPENING);
        results.findings.beam = Some(BeamFindings {
            limit,
            residual,
            model_code_2010: CodeFindings {
                rigid_plastic: code.rigid_plastic,
                serviceability: code.serviceability,
                ultimate: code.ultimate,
                sigma: [0.5, ULTIMATE_OPENING].map(|opening| law.at(opening)),
            },
        });
        if let Some(settings) = &program.scatter {
            let is_stopped = || signals::received().is_some();
            let beams = scatter(composite, geometry, &openings, &cmods, settings, &is_stopped).map_err(message)?;
            let interrupted = || format!("interrupted by {}", signals::received().map_or("a signal", Interrupt::words));
            let beams = beams.ok_or_else(interrupted)?;
            for row in &mut rows {
                let k = openings.partition_point(|opening| *opening < row.fibres.opening);
                let stresses: Vec<f64> = beams.bridging.iter().map(|beam| beam[k]).collect();
                row.quantiles = QUANTILES.map(|part| quantile(&stresses, part));
            }
            for (k, row) in results.beam.iter_mut().enumerate() {
                let forces: Vec<f64> = beams.loads.iter().map(|beam| beam[k].force).collect();
                row.quantiles = QUANTILES.map(|part| quantile(&forces, part));
            }
            results.findings.scatter = Some(scatter_findings(&beams));
            let beam = |(k, (&fibres, &residual))| ScatterRow { beam: k + 1, fibres, residual };
            results.scatter = beams.fibres.iter().zip(&beams.residual).enumerate().map(beam).collect();
        }
    }
    results.rows = rows;
    Ok(results)
}

/// Averages at openings, of which there are some already.
fn averages_also_at(composite: &Composite, known: Vec<Average>, openings: &[f64]) -> Vec<Average> {
    let is_known = |opening: f64| known.binary_search_by(|average| average.opening.total_cmp(&opening)).is_ok();
    let missing: Vec<f64> = openings.iter().copied().filter(|&opening| !is_known(opening)).collect();
    let mut all = averages(composite, &missing);
    all.extend(known);
    all.sort_by(|a, b| a.opening.total_cmp(&b.opening));
    all
}

fn findings(program: &BridgingProgram, composite: &Composite, fibres: &[Average]) -> Result<Findings, Invalid> {
    let last = program.openings.last().copied().unwrap_or_default();
    let ends: Vec<f64> = WORK_TO.into_iter().filter(|to| *to < last).chain([last]).collect();
    let CrackTotals { work, peak, fibre_peak } = composite.totals(&ends);
    let efficiency_by_zones = match &program.orientation {
        Orientation::Section { size, faces } => Some(wall_zones(*size, faces, program.fibre.length)?),
        _ => None,
    };
    let units = program.columns().into_iter().filter_map(|name| {
        let (_, unit, _) = columns::shown(&name)?;
        Some((name, unit.to_owned()))
    });
    let greatest_error = fibres.iter().map(|average| average.error).fold(0.0, f64::max);
    Ok(Findings {
        units: units.collect(),
        efficiency: composite.directions.efficiency,
        efficiency_by_zones,
        fibres_per_cm2: 100.0 * composite.fibres_per_area(),
        sigma_peak: peak.stress,
        w_peak: peak.opening,
        sigma_fibre_peak: fibre_peak.stress,
        w_fibre_peak: fibre_peak.opening,
        work: work.into_iter().map(|CrackWork { to, work, error }| WorkToOpening { to, work, error }).collect(),
        error: if fibre_peak.stress > 0.0 { greatest_error / fibre_peak.stress } else { 0.0 },
        ..Findings::default()
    })
}

/// Warns of rows whose straight lines have another work than σ(w).
fn few_rows(rows: &[BridgingRow], works: &[WorkToOpening]) -> Option<String> {
    let law = Polyline::new(rows.iter().map(|row| (row.fibres.opening, row.fibres.stress + row.matrix)));
    let of_rows = |to: f64| {
        let within = law.points().filter(|point| point.0 < to).chain([(to, law.at(to))]).collect::<Vec<_>>();
        within.windows(2).map(|ends| 0.5 * (ends[1].0 - ends[0].0) * (ends[0].1 + ends[1].1)).sum::<f64>()
    };
    let difference = |work: &WorkToOpening| (of_rows(work.to) - work.work).abs();
    let worst = works.iter().max_by(|a, b| difference(a).total_cmp(&difference(b)))?;
    (difference(worst) > NOTICED_BY_ROWS * works.last()?.work).then(|| {
        format!(
            "openings: straight lines between the {} openings have a work of {} N/mm up to {} mm, σ(w) has {} N/mm: give \
             more openings, or \"spacing\": \"power2\", if tables or sums over the rows of bridging.csv are used",
            rows.len(),
            number(of_rows(worst.to)),
            rounded(worst.to),
            number(worst.work)
        )
    })
}

fn scatter_findings(beams: &Beams) -> ScatterFindings {
    let of = |value: &dyn Fn(&Residual) -> f64| Spread::of(&beams.residual.iter().map(value).collect::<Vec<_>>());
    let limit = of(&|beam| beam.limit);
    let residual = [0, 1, 2, 3].map(|k| of(&|beam| beam.residual[k]));
    let [f_r1, f_r3] = [0, 2].map(|k: usize| residual[k].characteristic);
    let class = StrengthClass::new(limit.characteristic, f_r1, f_r3);
    ScatterFindings {
        beams: beams.residual.len(),
        fibres: Spread::of(&beams.fibres.iter().map(|&count| count as f64).collect::<Vec<_>>()),
        limit,
        residual,
        class: class.map(|class| class.to_string()),
        class_en_1992_2023: EurocodeClass::new(f_r1, f_r3).map(|class| class.to_string()),
        structural: class.is_some_and(|class| class.structural),
    }
}

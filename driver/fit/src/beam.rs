//! `pullout fit beam`: identifies σ(w) from the test of a notched beam, and the bond from σ(w).
//!
//! ```text
//! CSV ── rigid hinge (start) ── hinge model, L-curve ── σ(w), E, f_t ± error ── τ and f ± error ── output
//! ```

use crate::doubt::doubts;
use pullout_bridging::{
    Bond, BridgingFit, Closed, Estimate, Fitted, Inclination, Invalid, LayeredBeam, MeasuredBeam, NotchedBeam,
    Polyline, RESIDUAL_CMOD, Residual, SectionLaw, Shape, SoughtBond, bond_from_bridging, bond_from_strengths,
    fast_inverse, full_inverse,
};
use pullout_case::CsvFile;
use pullout_run::bridging::{BridgingProgram, Curves, ForeignTables, LoadSource};
use pullout_run::number::rounded;
use std::array::from_fn;
use std::path::Path;

mod output;
pub use output::{describe, write};

/// Columns of strengths.
const STRENGTHS: [&str; 5] = ["f_L", "f_R1", "f_R2", "f_R3", "f_R4"];
/// Openings whose σ_f determines the bond, mm. The matrix no longer carries stress there, and the test covers them.
const BOND_OPENINGS: [f64; 6] = [0.3, 0.6, 1.0, 1.5, 2.0, 2.5];
/// Points of the computed curve and of the case's own law.
const POINTS: usize = 160;

/// Columns that are read from a test's file.
#[derive(Clone, Debug, Default)]
pub struct BeamColumns {
    /// CMOD, mm.
    pub cmod: Option<String>,
    /// Load.
    pub load: Option<String>,
    /// N for the unit of the file's load.
    pub load_factor: f64,
}

/// Reads the test of a beam: the columns `cmod` and `load` (or those that are named), or strengths `f_R1` … `f_R4`, a row for each
/// beam. `f_L` is read if it is there: nothing is fitted to it, it is reported with the strengths.
///
/// # Errors
/// One sentence for each thing that is wrong.
pub fn read_beam_test(path: &Path, columns: &BeamColumns) -> Result<MeasuredBeam, Vec<String>> {
    let csv = CsvFile::read(path)?;
    let rows = |wanted: &[&str]| {
        let places = wanted.iter().map(|name| csv.column(name)).collect::<Result<Vec<usize>, Vec<String>>>()?;
        csv.numbers(&places, false)
    };
    if columns.cmod.is_none() && columns.load.is_none() && csv.column(STRENGTHS[1]).is_ok() {
        let names = &STRENGTHS[usize::from(csv.column(STRENGTHS[0]).is_err())..];
        let rows = rows(names)?;
        let wrong =
            rows.iter().enumerate().find_map(|(row, values)| Some((row, values.iter().position(|f| *f <= 0.0)?)));
        if let Some((row, k)) = wrong {
            let message = format!("{} is {}: strengths are above 0", names[k], rows[row][k]);
            return Err(csv.fault(csv.line(row), message));
        }
        let beam = |row: &Vec<f64>| {
            let (limit, residual) = row.split_at(row.len() - RESIDUAL_CMOD.len());
            Residual { limit: limit.first().copied().unwrap_or(f64::NAN), residual: from_fn(|k| residual[k]) }
        };
        return Ok(MeasuredBeam::Strengths(rows.iter().map(beam).collect()));
    }
    let names = [columns.cmod.as_deref().unwrap_or("cmod"), columns.load.as_deref().unwrap_or("load")];
    let rows = rows(&names)?;
    if let Some(row) = (1..rows.len()).find(|&row| rows[row][0] <= rows[row - 1][0]) {
        let [before, after] = [rows[row - 1][0], rows[row][0]];
        let message = format!("the CMOD {after} mm follows {before} mm: the CMODs of a test must rise");
        return Err(csv.fault(csv.line(row), message));
    }
    Ok(MeasuredBeam::Curve(rows.iter().map(|row| [row[0], columns.load_factor * row[1]]).collect()))
}

/// Result of the fit.
#[derive(Clone, Debug)]
pub struct BeamFit {
    /// The test's geometry.
    pub geometry: NotchedBeam,
    /// σ(w) by a rigid hinge.
    pub fast: Polyline,
    /// σ(w), E and f_t by the hinge model.
    pub full: BridgingFit,
    /// σ_m (1 − V_f) of the case at the openings of `full`, MPa: the matrix's part of σ(w).
    pub matrix: Vec<f64>,
    /// σ(w) as the case has it, for a picture: to 3e-4.
    pub predicted: Polyline,
    /// The bond; or why it was not sought.
    pub bond: Result<FittedBond, String>,
    /// f_L and f_R1 … f_R4 of the test, if it goes so far.
    pub tested: Option<Residual>,
    /// Tables of σ(w) for other programs that the case asks for.
    pub tables: ForeignTables,
}

/// Names of quantities with their units.
pub type Names = &'static [(&'static str, &'static str)];

/// The bond that a test determines.
#[derive(Clone, Debug)]
pub struct FittedBond {
    /// Names and units of the fitted quantities: τ and, if the test determines it, f; or the factor on a table's loads.
    pub names: Names,
    /// Their values.
    pub fitted: Fitted,
}

/// What is sought of a case's fibres: names and units, and where the search begins.
fn sought(program: &BridgingProgram) -> Result<(Names, Vec<f64>), String> {
    match &program.source {
        LoadSource::Bond(Bond::Closed(closed), Inclination::Exp { f }) if *f > 0.0 => {
            Ok((&[("tau", "MPa"), ("f", "")], vec![closed.tau, *f]))
        }
        LoadSource::Bond(Bond::Closed(closed), _) => Ok((&[("tau", "MPa")], vec![closed.tau])),
        LoadSource::Curves(curves) => Ok((&[("scale", "")], vec![curves.scale])),
        _ => Err("sought for the models \"closed\" and \"table\" alone".into()),
    }
}

/// A case with values of what is sought.
fn with_bond(program: &BridgingProgram, values: &[f64]) -> BridgingProgram {
    let source = match (&program.source, values) {
        (LoadSource::Bond(Bond::Closed(closed), inclination), [tau, others @ ..]) => {
            let inclination = others.first().map_or(*inclination, |f| Inclination::Exp { f: *f });
            LoadSource::Bond(Bond::Closed(Closed { tau: *tau, ..closed.clone() }), inclination)
        }
        (LoadSource::Curves(curves), [scale, ..]) => LoadSource::Curves(Curves { scale: *scale, ..curves.clone() }),
        (source, _) => source.clone(),
    };
    BridgingProgram { source, ..program.clone() }
}

impl BeamFit {
    /// Finds it. Geometry, fibre and dosage are those of the case; the shape is that of σ(w) from strengths.
    ///
    /// # Errors
    /// Data that are not those of a test, or a case without sense.
    pub fn new(program: &BridgingProgram, test: &MeasuredBeam, shape: Shape) -> Result<Self, Invalid> {
        let geometry = program.beam.unwrap_or_default();
        let fast = fast_inverse(&geometry, test)?;
        let full = full_inverse(&geometry, &program.matrix, test, shape)?;
        let end = program.openings.last().copied().unwrap_or_default();
        let rule = "a fit does not run \"fe\": use the fibres.csv of its run with model \"table\"";
        let composite = match &program.source {
            LoadSource::Simulated(_) => return Err(Invalid { place: "fibre.model".into(), rule: rule.into() }),
            _ => program.composite(&[])?,
        };
        let matrix = full.openings.iter().map(|opening| composite.matrix_stress(*opening)).collect();
        let predicted = composite.roughly().law_to(end, POINTS);
        let bond = sought(program).and_then(|(names, start)| {
            let with = |values: &[f64]| with_bond(program, values).composite(&[]);
            let sought = SoughtBond { composite: &with, start: &start };
            let found = match test {
                MeasuredBeam::Strengths(beams) => bond_from_strengths(&sought, &geometry, beams),
                MeasuredBeam::Curve(_) => {
                    let left = |opening: f64| full.law.at(opening) - composite.matrix_stress(opening);
                    let target = BOND_OPENINGS.map(|opening| [opening, left(opening)]);
                    let target: Vec<[f64; 2]> = target.into_iter().filter(|row| row[1] > 0.0).collect();
                    bond_from_bridging(&sought, &target)
                }
            };
            found.map(|fitted| FittedBond { names, fitted }).map_err(|error| error.to_string())
        });
        let tested = test.strengths(&geometry);
        Ok(Self { geometry, fast, full, matrix, predicted, bond, tested, tables: program.tables })
    }

    /// Warns of data in other units, and of a σ(w) that misses them.
    fn doubts(&self, test: &MeasuredBeam) -> Vec<String> {
        let greatest = test.greatest_strength(&self.geometry);
        let mut data = vec![("flexural strength at the greatest load", greatest, "MPa", [0.5, 60.0])];
        if let MeasuredBeam::Curve(rows) = test {
            let last = rows.iter().map(|row| row[0]).fold(0.0, f64::max);
            data.push(("greatest CMOD", last, "mm", [0.1, 50.0]));
        }
        let bond = self.bond.as_ref().ok().map(|bond| ("bond", bond.fitted.rms));
        let mut doubts = doubts(&data, [("", self.full.fitted.rms)].into_iter().chain(bond));
        let searches =
            [("σ(w)", Some(&self.full.fitted)), ("the bond", self.bond.as_ref().ok().map(|bond| &bond.fitted))];
        let unfinished = searches.into_iter().filter(|(_, fitted)| fitted.is_some_and(|fitted| !fitted.reached));
        doubts.extend(
            unfinished.map(|(what, _)| format!("the search for {what} did not come to its end: take it as a start")),
        );
        doubts
    }

    /// The computed test at CMODs.
    fn forces(&self, cmods: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
        let section = [SectionLaw::new(&self.full.matrix, &self.full.law, self.geometry.hinge())];
        let beam = LayeredBeam::new(self.geometry, &section, &self.full.matrix);
        cmods.map(|cmod| (cmod, beam.at(cmod).force)).collect()
    }

    /// σ at openings without the matrix's part.
    fn of_fibres(&self) -> impl Iterator<Item = Estimate> + '_ {
        let totals = self.full.fitted.estimates[2..].iter().zip(&self.matrix);
        totals.map(|(total, matrix)| Estimate { value: total.value - matrix, ..*total })
    }

    /// Name, unit and estimate of each number: E, f_t, σ at openings without the matrix's part, those of the bond.
    fn numbers(&self) -> Vec<(String, &'static str, Estimate)> {
        let stresses = self.full.openings.iter().map(|opening| (format!("sigma({})", rounded(*opening)), "MPa"));
        let names = [("E".to_owned(), "MPa"), ("f_t".to_owned(), "MPa")].into_iter().chain(stresses);
        let of_law = names.zip(self.full.fitted.estimates[..2].iter().copied().chain(self.of_fibres()));
        let of_bond =
            |bond: &FittedBond| bond.names.iter().copied().zip(bond.fitted.estimates.clone()).collect::<Vec<_>>();
        let bond = self.bond.iter().flat_map(of_bond).map(|((name, unit), estimate)| (name.to_owned(), unit, estimate));
        let of_law = of_law.map(|((name, unit), estimate)| (name, unit, estimate));
        of_law.chain(bond).collect()
    }
}

/// The measured points: the curve's, or those of the strengths.
fn measured_points(geometry: &NotchedBeam, test: &MeasuredBeam) -> Vec<(f64, f64)> {
    match test {
        MeasuredBeam::Curve(rows) => rows.iter().map(|row| (row[0], row[1])).collect(),
        MeasuredBeam::Strengths(beams) => {
            let force = |strength: f64| strength / geometry.flexural_strength(1.0);
            RESIDUAL_CMOD.into_iter().zip(Residual::mean(beams).residual.map(force)).collect()
        }
    }
}

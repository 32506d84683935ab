//! Identifies parameters from experiments: `pullout fit CASE` fits parameters of any case ([`fit_case`]), `pullout fit beam` finds
//! σ(w) from the test of a notched beam, and `pullout fit bond` the bond law from the load–slip curve of a perpendicular fibre.
//!
//! ```text
//! CSV ─ curve ── mean traction against mean slip ── regression ── inverse finite elements ── law ± error ─ output
//!                     (geometry)                     (6.23, 6.24)     (specimen, simulation, search)   (uncertainty)
//! ```
//!
//! The regressions of the thesis's section 6.2 assume uniform bond along the fibre. The computed pull-out does not: the law is
//! adjusted until the computed and the measured curve agree.

mod beam;
mod case;
mod curve;
mod doubt;
mod geometry;
mod law;
mod output;
mod places;
mod regression;
mod search;
mod simulation;
mod specimen;
#[cfg(test)]
mod test;
mod uncertainty;

pub use beam::{BeamColumns, BeamFit, describe as describe_beam, read_beam_test, write as write_beam};
pub use case::{CaseFit, CaseRequest, FittedTest, Free, Test, fit_case};
pub use curve::LoadSlipCurve;
pub use geometry::{SlipAt, TestFibre};
pub use law::{BondSlipLaw, LawQuantity, Piecewise, Powers};
pub use output::{describe, write};
pub use places::{BestFit, Range, least_squares};
pub use search::Simulation;
pub use simulation::{SimulatedCurve, Weights};
pub use specimen::{Materials, MatrixLaw};
pub use uncertainty::Uncertainty;

use geometry::BondPoint;
use levenberg_marquardt::LevenbergMarquardt;
use pullout_case::CaseErrors;
use pullout_run::isolation::Need;
use search::Search;
use serde_json::Value;
use simulation::Simulator;
use specimen::Specimen;
use std::f64::consts::PI;
use std::path::PathBuf;

/// The form of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawForm {
    /// Linear, power, power (6.24).
    Powers,
    /// Straight lines through so many points besides (0, 0) (6.23).
    Piecewise {
        /// Number of points.
        points: usize,
    },
}

/// Data besides the curve, and settings of the search for the law.
#[derive(Clone, Debug)]
pub struct FitRequest {
    /// The fibre.
    pub fibre: TestFibre,
    /// Where the slip was measured.
    pub slip_at: SlipAt,
    /// The forms that are fitted.
    pub forms: Vec<LawForm>,
    /// τ_res, MPa; `None`: 0, or that of the user's own case.
    pub residual: Option<f64>,
    /// Weighting of the rows.
    pub weights: Weights,
    /// Materials of the default simulation.
    pub materials: Materials,
    /// A case of the user's own instead of the default simulation.
    pub specimen_case: Option<PathBuf>,
    /// Largest number of simulations for each form.
    pub max_runs: usize,
    /// Folders in which plugins are looked for first.
    pub plugin_paths: Vec<PathBuf>,
}

/// Reason why there is no law.
#[derive(Debug)]
pub enum FitError {
    /// The input is wrong.
    Input(String),
    /// The simulation's case is wrong.
    Case(CaseErrors),
    /// The simulation cannot be run.
    Failed(String),
}

/// A law and how well it is known.
#[derive(Clone, Debug)]
pub struct FittedLaw {
    /// The law by regression alone.
    pub regression: BondSlipLaw,
    /// The law by inverse finite elements.
    pub law: BondSlipLaw,
    /// Numbers with their errors; `None` if there were no runs left for it.
    pub uncertainty: Option<Uncertainty>,
    /// Curve.
    pub simulated: SimulatedCurve,
    /// Agreement of its curve with the measured one.
    pub quality: Quality,
    /// RMS difference of the regression's curve.
    pub regression_rms: f64,
    /// Runs of the simulation.
    pub runs: usize,
    /// Reason why it is not the best law of its form.
    pub trouble: Option<String>,
    /// τ_res, MPa.
    pub residual: f64,
    /// A case that computes the curve.
    pub case: Value,
}

/// The distance of two curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// RMS difference of the loads as a part of the measured peak.
    pub rms: f64,
    /// 1 − Σ(difference)²/Σ(load − mean load)².
    pub r_squared: f64,
}

/// The search ends when the sum of squares would fall by less than this fraction.
const SMALLEST_GAIN: f64 = 1e-4;
/// The search ends when the coordinates would move by less than this fraction.
const SMALLEST_MOVE: f64 = 1e-4;
/// Largest first step, as a fraction of the coordinates: the regressions are close.
const FIRST_STEP: f64 = 1.0;

/// Name of the copy of the measured curve next to the cases.
pub(crate) const CURVE_FILE: &str = "curve.csv";

/// Fits a curve. `progress` receives the form, the number of runs so far, and the RMS difference of each law that is tried.
///
/// # Errors
/// [`FitError`]. A search that stops early is no error: see [`FittedLaw::trouble`].
pub fn fit(
    curve: &LoadSlipCurve,
    request: &FitRequest,
    progress: &dyn Fn(&str, usize, f64),
) -> Result<Vec<FittedLaw>, FitError> {
    let bond = request.fibre.mean_bond(curve, request.slip_at);
    let specimen = specimen(curve, request)?;
    let starts: Result<Vec<[BondSlipLaw; 2]>, FitError> =
        request.forms.iter().map(|form| start(*form, &bond, curve, &request.fibre)).collect();
    let weights = request.weights.of(curve);
    let fit = |[regression, start]: [BondSlipLaw; 2]| {
        let simulator = Simulator {
            specimen: &specimen,
            slip_at: request.slip_at,
            plugin_paths: &request.plugin_paths,
            form: &start,
            curve,
            weights: &weights,
        };
        // reading it reports all its problems
        pullout_case::read_document(specimen.computed(&start), &specimen.file, &request.plugin_paths)
            .map_err(FitError::Case)?;
        let coordinates = start.coordinates();
        let report = |runs: usize, rms: f64| progress(start.form(), runs, rms);
        // the derivatives at the end give the uncertainty
        let mut search = Search::new(&simulator, request.max_runs, coordinates.len(), &report);
        let no_curve = |message| FitError::Failed(format!("the law of the regression gives no curve: {message}"));
        search.begin(&coordinates).map_err(no_curve)?;
        let first = search.best.clone();
        if let Some(failure) = first.as_ref().and_then(|first| first.run.curve.failure_at_once()) {
            return Err(FitError::Failed(format!("the simulation fails at once: {failure}")));
        }
        let method =
            LevenbergMarquardt::new().with_ftol(SMALLEST_GAIN).with_xtol(SMALLEST_MOVE).with_stepbound(FIRST_STEP);
        let (search, trouble) = search.search(method);
        let Some((first, best)) = first.zip(search.best.as_ref()) else {
            return Err(FitError::Failed("no law gives a curve".into()));
        };
        let found = best.run.clone();
        let has_left = search.runs() + coordinates.len() <= request.max_runs;
        let slopes = has_left.then(|| simulator.slopes(&best.coordinates, &found)).and_then(Result::ok);
        if slopes.is_some() {
            search.count_derivative_runs();
        }
        let differences = simulator.off(&found.curve);
        let uncertainty = slopes.map(|slopes| uncertainty::uncertainty(&found.law, &differences, &slopes, &weights));
        let title = format!("Pull-out of a perpendicular fibre with the fitted bond law ({})", found.law.form());
        let column = request.slip_at.column();
        let compare =
            serde_json::json!({ "file": CURVE_FILE, "file_x": "slip", "file_y": "load", "x": column, "y": "load" });
        Ok(FittedLaw {
            regression,
            uncertainty,
            quality: quality(curve, simulator.rms(&found)),
            regression_rms: simulator.rms(&first.run),
            runs: search.runs(),
            trouble: trouble.or_else(|| shortfall(curve, &found.curve)),
            residual: specimen.residual(),
            case: specimen.kept(&found.law, &title, compare),
            law: found.law,
            simulated: found.curve,
        })
    };
    starts?.into_iter().map(fit).collect()
}

/// A failure of the last simulation that leaves a part of the curve without a comparison.
fn shortfall(curve: &LoadSlipCurve, simulated: &SimulatedCurve) -> Option<String> {
    /// The end of the curve need be reached to this part only.
    const REACHED: f64 = 0.999;
    let (reached, wanted) = (simulated.slips.last().copied().unwrap_or(0.0), curve.largest_slip());
    let reason = simulated.failure.as_deref().unwrap_or("its steps end there");
    (reached < REACHED * wanted).then(|| format!("the simulation ends at a slip of {reached} of {wanted} mm: {reason}"))
}

fn quality(curve: &LoadSlipCurve, rms: f64) -> Quality {
    let count = curve.loads.len() as f64;
    let mean = curve.loads.iter().sum::<f64>() / count;
    let scatter: f64 = curve.loads.iter().map(|load| (load - mean).powi(2)).sum();
    let left = count * (rms * curve.peak().load).powi(2);
    Quality { rms, r_squared: 1.0 - left / scatter }
}

/// Returns what the simulations need a process of their own for, if they do: one for the whole fit.
pub fn need(request: &FitRequest) -> Option<Need> {
    match &request.specimen_case {
        Some(file) => pullout_case::need(file, &[], &request.plugin_paths),
        // one that cannot be made calls nothing
        None => default_specimen(request).ok()?.need(&request.plugin_paths),
    }
}

fn default_specimen(request: &FitRequest) -> Result<Specimen, String> {
    Specimen::perpendicular_fibre(&request.fibre, &request.materials, request.residual.unwrap_or(0.0))
}

/// The simulation, up to the end of the curve.
fn specimen(curve: &LoadSlipCurve, request: &FitRequest) -> Result<Specimen, FitError> {
    let fibre = &request.fibre;
    let specimen = match &request.specimen_case {
        None => default_specimen(request).map_err(FitError::Input)?,
        Some(file) => {
            let named = |message: String| FitError::Input(format!("{}: {message}", file.display()));
            // reading the file unchanged reports everything that is wrong with it
            pullout_case::read(file, &[], &request.plugin_paths).map_err(FitError::Case)?;
            let document = pullout_case::document(file, &[]).unwrap_or_default();
            Specimen::own(document, file, request.residual).map_err(named)?
        }
    };
    let end = curve.largest_slip();
    let stretch = match request.slip_at {
        SlipAt::Grip => 0.0,
        SlipAt::Exit => curve.peak().load * fibre.free_length / fibre.axial_stiffness(),
    };
    Ok(specimen.pulled(curve.peak().slip + stretch, end + stretch, (request.slip_at.column(), end)))
}

/// The law of the regression, and the one that the search begins with: its elastic stiffness is that of a fibre that
/// stretches unevenly.
fn start(
    form: LawForm,
    bond: &[BondPoint],
    curve: &LoadSlipCurve,
    fibre: &TestFibre,
) -> Result<[BondSlipLaw; 2], FitError> {
    match form {
        LawForm::Powers => {
            let law = regression::powers(bond).unwrap_or_else(|| rough(curve, bond, fibre));
            let elastic_stiffness = fibre.elastic_stiffness(law.elastic_stiffness);
            Ok([BondSlipLaw::Powers(law), BondSlipLaw::Powers(Powers { elastic_stiffness, ..law })])
        }
        LawForm::Piecewise { points } => {
            let law = regression::piecewise(bond, points).ok_or_else(|| {
                let message = format!("{} usable rows are too few for --points {points}: give fewer", bond.len());
                FitError::Input(message)
            })?;
            let mut begin = law.clone();
            let stiffness = fibre.elastic_stiffness(law.elastic_stiffness());
            if let [first, second, ..] = &mut begin.points[..]
                && stiffness > second[1] / second[0]
                && first[1] / stiffness < second[0]
            {
                first[0] = first[1] / stiffness;
            }
            Ok([BondSlipLaw::Piecewise(law), BondSlipLaw::Piecewise(begin)])
        }
    }
}

/// A law with the right peak, for a curve whose regression is none.
fn rough(curve: &LoadSlipCurve, bond: &[BondPoint], fibre: &TestFibre) -> Powers {
    /// Stiffness over the secant of the peak, and exponents like those of the fibres of chapter 6.
    const STIFFNESS: f64 = 5.0;
    const EXPONENTS: [f64; 2] = [0.2, -0.2];
    let peak = bond.iter().copied().max_by(|a, b| a.traction.total_cmp(&b.traction)).unwrap_or_else(|| {
        let load = curve.peak().load;
        BondPoint { slip: curve.peak().slip, traction: load / (PI * fibre.diameter * fibre.embedded_length) }
    });
    let power = |exponent: f64| [peak.traction / peak.slip.powf(exponent), exponent];
    Powers {
        elastic_stiffness: STIFFNESS * peak.traction / peak.slip,
        rise: power(EXPONENTS[0]),
        fall: power(EXPONENTS[1]),
    }
}

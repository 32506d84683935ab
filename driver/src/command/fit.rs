//! `pullout fit`: identifies parameters of a case, and laws, from experiments.

use super::{DONE, FAILED, Isolation, Refusal, complain, folder_of, isolated, run, say};
use clap::{Args, Subcommand, ValueEnum};
use pullout_fit::{
    FitError, FitRequest, FittedLaw, LawForm, LoadSlipCurve, Materials, MatrixLaw, SlipAt, TestFibre, Weights,
};
use pullout_report::directory::{Access, Kind, ResultDirectory};
use pullout_run::isolation::{self, Work};
use pullout_run::number::significant;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

mod beam;
mod case;

/// Fit of parameters of a case, or of a law.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(super) struct Fit {
    #[command(subcommand)]
    law: Option<FitTarget>,
    #[command(flatten)]
    case: case::CaseFitArguments,
}

/// Law that is fitted.
#[derive(Debug, Subcommand)]
enum FitTarget {
    /// Fit a bond law to the load–slip curve of a perpendicular fibre.
    ///
    /// A regression of the mean traction P/(π D (L − g)) on the mean slip g gives a first law: straight lines (form
    /// piecewise), or a line and two powers (form powers). The law is then adjusted until a simulated pull-out matches
    /// the measured curve. Results in the result directory: FORM-law.json (contact.law.props, to paste into a case),
    /// FORM-case.json (a complete case), FORM-curve.csv (its computed curve), fit.json (all parameters with standard
    /// errors and correlations), plots/ and report.html.
    Bond(Box<Bond>),
    /// Fit σ(w) to the test of a notched beam, and the bond to σ(w).
    ///
    /// A rigid hinge gives a first σ(w). Then E, f_t and σ at a set of openings are adjusted until the hinge model
    /// matches the measured curve (Levenberg–Marquardt, smoothed at the corner of the L-curve). From strengths, the
    /// smoothest σ(w) is found; cross-validation chooses how smooth. If the fibre model of the case is "closed", friction
    /// and snubbing are fitted as well; if it is "table", the factor on the loads. Results in the result directory:
    /// sigma.csv, curve.csv, fit.json (all parameters with standard errors), bond-case.json (the case with the fitted
    /// bond), plots/ and report.html.
    Beam(Box<beam::Beam>),
}

/// Forms to fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
enum Forms {
    /// k_e s, a_1 s^b_1, a_2 s^b_2.
    Powers,
    /// Straight lines.
    Piecewise,
    /// Both forms, one after the other.
    Both,
}

/// A fit of a bond law, which another process carries out where the simulation calls a plugin that may end it.
#[derive(Debug, Serialize, Deserialize, Args)]
pub(super) struct Bond {
    /// The measured curve: CSV with a header line, slip in mm, load in N. Lines that begin with # are comments.
    #[arg(value_name = "CURVE.csv")]
    #[serde(with = "isolation::path")]
    curve: PathBuf,
    /// Column of the slip [default: 'slip' if there are 'slip' and 'load', else the first].
    #[arg(long, value_name = "COLUMN")]
    slip: Option<String>,
    /// Column of the load [default: 'load' if there are 'slip' and 'load', else the second].
    #[arg(long, value_name = "COLUMN")]
    load: Option<String>,
    /// Diameter of the fibre, mm.
    #[arg(long, value_name = "D", value_parser = positive, allow_negative_numbers = true)]
    diameter: f64,
    /// Embedded length, mm.
    #[arg(long, value_name = "L", value_parser = positive, allow_negative_numbers = true)]
    length: f64,
    /// Young's modulus of the fibre, MPa. The fibre's elongation is subtracted from the slip.
    #[arg(long = "fibre-E", value_name = "E", default_value_t = 210e3, value_parser = positive, allow_negative_numbers = true)]
    fibre_modulus: f64,
    /// Yield stress of the fibre, MPa; it hardens with 1 % of E [default: it stays elastic].
    #[arg(long, value_name = "F_Y", value_parser = positive, allow_negative_numbers = true)]
    fibre_yield: Option<f64>,
    /// Where the slip was measured.
    #[arg(long, value_enum, default_value = "grip")]
    slip_at: SlipAt,
    /// Free length of the fibre between exit face and grip, mm. With --slip-at grip its elongation is part of the
    /// measured slip.
    #[arg(long, value_name = "L_F", default_value_t = 3.0, value_parser = positive, allow_negative_numbers = true)]
    free_length: f64,
    /// Forms to fit.
    #[arg(long, value_enum, default_value = "both")]
    form: Forms,
    /// Number of points of the form piecewise, without (0, 0). The last point is at the largest slip.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u8).range(2..=12))]
    points: u8,
    /// Residual friction tau_res, MPa. It is not fitted [default: 0, or that of --specimen-case].
    #[arg(long, value_name = "TAU", value_parser = not_negative, allow_negative_numbers = true)]
    tau_res: Option<f64>,
    /// Weights of the curve's rows: the same for both branches, or for all rows.
    #[arg(long, value_enum, default_value = "balanced")]
    weights: Weights,
    /// Law of the matrix in the simulation.
    #[arg(long, value_enum, default_value = "elastic", conflicts_with = "specimen_case")]
    matrix: MatrixLaw,
    /// Young's modulus of the matrix, MPa.
    #[arg(long = "matrix-E", value_name = "E", default_value_t = 23.7e3, value_parser = positive, allow_negative_numbers = true, conflicts_with = "specimen_case")]
    matrix_modulus: f64,
    /// Simulate with this case of kind "pullout", whose contact law is bond_slip. Only its bond law changes. Slip and
    /// load of its history are compared with the curve.
    #[arg(long, value_name = "CASE.json")]
    #[serde(with = "isolation::optional_path")]
    specimen_case: Option<PathBuf>,
    /// Largest number of simulations for each form.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..))]
    max_runs: u32,
    /// Result directory [default: out/<curve file stem>/].
    #[arg(short, long, value_name = "DIR")]
    #[serde(with = "isolation::optional_path")]
    out: Option<PathBuf>,
    /// Also replace files in the result directory that pullout did not write or that were changed since, and list them.
    #[arg(long)]
    overwrite: bool,
    /// Search this folder for plugins first (may be repeated).
    #[arg(long = "plugin-path", value_name = "DIR")]
    #[serde(with = "isolation::paths")]
    plugin_paths: Vec<PathBuf>,
    #[serde(skip)]
    #[command(flatten)]
    isolation: Isolation,
    /// Print only errors.
    #[arg(long)]
    quiet: bool,
}

impl Work for Bond {
    const NAME: &'static str = "fit-bond";
}

/// Opens the result directory of a fit, or returns why it cannot.
fn open(folder: &Path, inputs: &[PathBuf], overwrite: bool) -> Result<ResultDirectory, Refusal> {
    run::open_for(folder, Kind::Fit, Access { inputs, overwrite, is_locked: false })
}

fn positive(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|value: &f64| value.is_finite() && *value > 0.0)
        .ok_or_else(|| "a number > 0 is needed".into())
}

fn not_negative(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|value: &f64| value.is_finite() && *value >= 0.0)
        .ok_or_else(|| "a number ≥ 0 is needed".into())
}

impl Fit {
    /// Returns the process in which plugins are called.
    pub(super) fn isolation(&self) -> Isolation {
        match (&self.law, &self.case) {
            (Some(FitTarget::Bond(bond)), _) => bond.isolation,
            (Some(FitTarget::Beam(beam)), _) => beam.reading.isolation,
            (None, case) => case.isolation,
        }
    }
}

/// Fits a law.
pub(super) fn act(fit: &Fit) -> Result<u8, Refusal> {
    match &fit.law {
        Some(FitTarget::Bond(bond)) => bond.act(),
        Some(FitTarget::Beam(beam)) => beam.act(),
        None => fit.case.act(),
    }
}

impl Bond {
    /// Fits the law, here or in a process of its own.
    pub(super) fn act(&self) -> Result<u8, Refusal> {
        let curve = LoadSlipCurve::read(&self.curve, self.slip.as_deref(), self.load.as_deref());
        let curve = curve.map_err(|problems| Refusal::input(problems.join("\n")))?;
        let request = self.request();
        if let Some(need) = pullout_fit::need(&request) {
            return Ok(isolated::carry_out(self, &need, &self.curve, self.quiet));
        }
        let mut directory = self.open()?;
        let progress = |form: &str, runs: usize, rms: f64| {
            if !self.quiet {
                complain(format!("{form}: run {runs}, RMS {} % of the peak", significant(100.0 * rms, 4)));
            }
        };
        let laws = pullout_fit::fit(&curve, &request, &progress).map_err(|error| match error {
            FitError::Input(message) => Refusal::input(message),
            FitError::Case(errors) => errors.into(),
            FitError::Failed(message) => Refusal::failed(format!("{}: {message}", self.curve.display())),
        })?;
        directory.begin(&[])?;
        let source = self.curve.display().to_string();
        let warnings = pullout_fit::write(&mut directory, &source, &curve, &request, &laws)?;
        directory.remove_earlier()?;
        directory.finish()?;
        let code = self.print_laws(&laws);
        warnings.iter().for_each(|warning| complain(format!("{source}: warning: {warning}")));
        Ok(code)
    }

    fn request(&self) -> FitRequest {
        let piecewise = LawForm::Piecewise { points: usize::from(self.points) };
        FitRequest {
            fibre: TestFibre {
                diameter: self.diameter,
                embedded_length: self.length,
                free_length: self.free_length,
                youngs_modulus: self.fibre_modulus,
            },
            slip_at: self.slip_at,
            forms: match self.form {
                Forms::Powers => vec![LawForm::Powers],
                Forms::Piecewise => vec![piecewise],
                Forms::Both => vec![LawForm::Powers, piecewise],
            },
            residual: self.tau_res,
            weights: self.weights,
            materials: Materials {
                matrix: self.matrix,
                matrix_modulus: self.matrix_modulus,
                fibre_yield: self.fibre_yield,
            },
            specimen_case: self.specimen_case.clone(),
            max_runs: self.max_runs as usize,
            plugin_paths: self.plugin_paths.clone(),
        }
    }

    fn folder(&self) -> PathBuf {
        folder_of(&self.curve, self.out.as_deref(), true)
    }

    /// Opens the result directory, or returns why it cannot.
    fn open(&self) -> Result<ResultDirectory, Refusal> {
        let mut inputs = vec![self.curve.clone()];
        inputs.extend(self.specimen_case.iter().flat_map(|case| pullout_case::inputs(case, &[])));
        open(&self.folder(), &inputs, self.overwrite)
    }

    /// Prints the result. Returns the exit code.
    fn print_laws(&self, laws: &[FittedLaw]) -> u8 {
        let mut code = DONE;
        for law in laws {
            if !self.quiet {
                say(&pullout_fit::describe(law));
            }
            if let Some(trouble) = &law.trouble {
                complain(format!("{}: {}: {trouble}", self.curve.display(), law.law.form()));
                code = FAILED;
            }
        }
        if !self.quiet {
            say(&format!("-> {}\n", self.folder().display()));
        }
        code
    }
}

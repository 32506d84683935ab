//! `pullout fit beam`.

use super::super::{DONE, Reading, Refusal, complain, folder_of, read, say};
use pullout_bridging::{MeasuredBeam, Shape};
use pullout_case::Case;
use pullout_fit::{BeamColumns, BeamFit, describe_beam, read_beam_test, write_beam};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(in super::super) struct Beam {
    /// The test: CSV with a header line. Columns are CMOD in mm and load in N, or the strengths f_R1 … f_R4 in
    /// MPa; several beams are averaged and give a band of σ(w). A column f_L is only reported.
    #[arg(value_name = "BEAM.csv")]
    test: PathBuf,
    /// Case of kind "bridging" with beam, matrix, fibre and dosage.
    #[arg(long, value_name = "CASE.json")]
    case: PathBuf,
    /// Column of the CMOD [default: cmod].
    #[arg(long, value_name = "COLUMN")]
    cmod: Option<String>,
    /// Column of the load [default: load].
    #[arg(long, value_name = "COLUMN")]
    load: Option<String>,
    /// Factor on the load: 1000 if the load is in kN.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = super::positive, allow_negative_numbers = true)]
    load_factor: f64,
    /// Shape of the σ(w) that is fitted to strengths.
    #[arg(long, value_enum, default_value_t = Shapes::Smooth)]
    shape: Shapes,
    /// Result directory [default: out/<test file stem>/].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also replace files in the result directory that pullout did not write or that were changed since, and list them.
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    pub(super) reading: Reading,
    /// Print only errors.
    #[arg(long)]
    quiet: bool,
}

/// Shapes of the σ(w) that is fitted to strengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Shapes {
    /// As smooth as the strengths allow, never negative, and decreasing after its peak.
    Smooth,
    /// Two descending straight lines.
    Bilinear,
}

impl Beam {
    pub(super) fn act(&self) -> Result<u8, Refusal> {
        let columns = BeamColumns { cmod: self.cmod.clone(), load: self.load.clone(), load_factor: self.load_factor };
        let test = read_beam_test(&self.test, &columns).map_err(|problems| Refusal::input(problems.join("\n")))?;
        let shape = match self.shape {
            Shapes::Smooth => Shape::Smooth,
            Shapes::Bilinear => Shape::Bilinear,
        };
        if shape != Shape::Smooth && matches!(test, MeasuredBeam::Curve(_)) {
            let message = "--shape: needs strengths f_R1 … f_R4; a curve gives σ at its openings by itself";
            return Err(Refusal::input(format!("{}: {message}", self.test.display())));
        }
        let source = self.reading.source(&self.case);
        let Case::Bridging(program) = read(&source)? else {
            let message = "$.kind: a beam is fitted with a case of kind \"bridging\"";
            return Err(Refusal::input(format!("{}: {message}", self.case.display())));
        };
        let folder = folder_of(&self.test, self.out.as_deref(), true);
        let mut inputs = source.inputs();
        inputs.push(self.test.clone());
        let mut directory = super::open(&folder, &inputs, self.overwrite)?;
        let refused = |error| Refusal::input(format!("{}: {error}", self.test.display()));
        let fit = BeamFit::new(&program, &test, shape).map_err(refused)?;
        let document = source.text().unwrap_or_default();
        directory.begin(&[])?;
        let warnings = write_beam(&mut directory, &self.test.display().to_string(), &document, &test, &fit)?;
        directory.remove_earlier()?;
        directory.finish()?;
        if !self.quiet {
            say(&(describe_beam(&fit) + &format!("-> {}\n", folder.display())));
        }
        let test = self.test.display();
        warnings.iter().for_each(|warning| complain(format!("{test}: warning: {warning}")));
        Ok(DONE)
    }
}

//! `pullout fit beam`.

use super::super::{BAD_INPUT, DONE, FAILED, Reading, complain, refuse, run, say};
use pullout_case::Case;
use pullout_fit::{BeamColumns, BeamFit, describe_beam, read_beam_test, write_beam};
use pullout_report::directory::{Access, Kind};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(in super::super) struct Beam {
    /// The test: CSV with a header line, CMOD in mm and load in N, or the strengths f_L, f_R1 … f_R4 in MPa (of several
    /// beams their means are taken).
    #[arg(value_name = "BEAM.csv")]
    test: PathBuf,
    /// The case of kind "bridging" that says beam, matrix, fibre and dosage.
    #[arg(long, value_name = "CASE.json")]
    case: PathBuf,
    /// Column of the CMOD [default: cmod].
    #[arg(long, value_name = "COLUMN")]
    cmod: Option<String>,
    /// Column of the load [default: load].
    #[arg(long, value_name = "COLUMN")]
    load: Option<String>,
    /// Factor on the load: 1000 if it is in kN.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = super::positive)]
    load_factor: f64,
    /// Result directory [default: out/<test file stem>/].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace files in the result directory that this program did not write, or that were changed since; they are listed.
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    pub(super) reading: Reading,
    /// Say nothing but errors.
    #[arg(long)]
    quiet: bool,
}

impl Beam {
    pub(super) fn act(&self) -> u8 {
        let columns = BeamColumns { cmod: self.cmod.clone(), load: self.load.clone(), load_factor: self.load_factor };
        let test = match read_beam_test(&self.test, &columns) {
            Ok(test) => test,
            Err(problems) => {
                problems.iter().for_each(complain);
                return BAD_INPUT;
            }
        };
        let program = match self.reading.case(&self.case) {
            Ok(Case::Bridging(program)) => program,
            Ok(_) => {
                complain(format!("{}: $.kind: a beam is fitted with a case of kind \"bridging\"", self.case.display()));
                return BAD_INPUT;
            }
            Err(errors) => return refuse(&errors),
        };
        let folder = self.out.clone();
        let folder = folder.unwrap_or_else(|| PathBuf::from("out").join(self.test.file_stem().unwrap_or_default()));
        let mut inputs = pullout_case::inputs(&self.case, &self.reading.overrides);
        inputs.push(self.test.clone());
        let access = Access { inputs: &inputs, overwrite: self.overwrite, is_locked: false };
        let mut directory = match run::open_for(&folder, Kind::Fit, access) {
            Ok(directory) => directory,
            Err(code) => return code,
        };
        let fit = match BeamFit::new(&program, &test) {
            Ok(fit) => fit,
            Err(error) => {
                complain(format!("{}: {error}", self.test.display()));
                return BAD_INPUT;
            }
        };
        let document = pullout_case::document(&self.case, &self.reading.overrides).unwrap_or_default();
        let written = directory.begin(&[]).and_then(|()| {
            write_beam(&mut directory, &self.test.display().to_string(), &document, &test, &fit)?;
            directory.remove_earlier()?;
            directory.finish()
        });
        if let Err(error) = written {
            complain(error);
            return FAILED;
        }
        if !self.quiet {
            say(&(describe_beam(&fit) + &format!("-> {}\n", folder.display())));
        }
        DONE
    }
}

//! `pullout fit CASE`.

use super::super::{DONE, Isolation, Refusal, complain, say};
use pullout_engine::CaseSource;
use pullout_fit::{CaseRequest, Free, Test, fit_case};
use pullout_run::isolation::prints::Prints;
use pullout_run::number::significant;
use std::path::PathBuf;
use std::sync::Arc;

/// Arguments of `fit CASE`. With the subcommands `fit bond` and `fit beam`, none of them is required.
#[derive(Debug, clap::Args)]
pub(in super::super) struct CaseFitArguments {
    /// The case with the initial values. To fit several tests together, give a --data for each, and one case for each
    /// or one for all.
    #[arg(value_name = "CASE.json", required = true)]
    cases: Vec<PathBuf>,
    /// Parameter of the case to fit, with its bounds, e.g. material.props.E=1e4:4e4 (may be repeated).
    #[arg(long = "free", value_name = "PATH=lo:hi", required = true, value_parser = Free::parse)]
    free: Vec<Free>,
    /// Measured curve: CSV with a header line (once for each test).
    #[arg(long, value_name = "CURVE.csv", required = true)]
    data: Vec<PathBuf>,
    /// History columns to compare with the data (once, or once for each test). The columns of the data have the same
    /// names, or are the first two.
    #[arg(long, value_name = "X,Y", default_value = "slip,load", value_parser = columns)]
    curve: Vec<[String; 2]>,
    /// Weight of a test's squared differences, relative to its largest value (once for each test) [default: 1].
    #[arg(long = "weight", value_name = "W", value_parser = super::positive, allow_negative_numbers = true)]
    weights: Vec<f64>,
    /// Number of starting points: the values of the case, and others between the bounds. The best result counts.
    #[arg(long, value_name = "N", default_value_t = CaseRequest::STARTS, value_parser = clap::value_parser!(u32).range(1..))]
    starts: u32,
    /// Largest number of runs of all searches together.
    #[arg(long, value_name = "N", default_value_t = CaseRequest::MOST_RUNS, value_parser = clap::value_parser!(u32).range(1..))]
    max_runs: u32,
    /// Result directory [default: out/<case file stem>-fit/].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also replace files in the result directory that pullout did not write or that were changed since, and list them.
    #[arg(long)]
    overwrite: bool,
    /// Override an entry of the case, e.g. steps.0.increments=5 (VALUE is JSON, otherwise a string).
    #[arg(long = "set", value_name = "a.b.c=VALUE")]
    overrides: Vec<String>,
    /// Search this folder for plugins first (may be repeated).
    #[arg(long = "plugin-path", value_name = "DIR")]
    plugin_paths: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) isolation: Isolation,
    /// Print only errors.
    #[arg(long)]
    quiet: bool,
}

/// "slip,load".
fn columns(text: &str) -> Result<[String; 2], String> {
    let names = text.split_once(',').map(|(x, y)| [x.trim().to_owned(), y.trim().to_owned()]);
    names.filter(|[x, y]| !x.is_empty() && !y.is_empty() && x != y).ok_or_else(|| "write X,Y: two columns".into())
}

impl CaseFitArguments {
    pub(super) fn act(&self) -> Result<u8, Refusal> {
        let request = CaseRequest {
            tests: self.tests()?,
            free: self.free.clone(),
            starts: self.starts as usize,
            max_runs: self.max_runs as usize,
            stop: Arc::default(),
        };
        let case = &self.cases[0];
        let folder = self.out.clone().unwrap_or_else(|| {
            let stem = case.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            PathBuf::from("out").join(stem + "-fit")
        });
        let read = |case: &PathBuf| pullout_case::inputs(case, &self.overrides);
        let inputs: Vec<PathBuf> = self.cases.iter().flat_map(read).chain(self.data.iter().cloned()).collect();
        let mut directory = super::open(&folder, &inputs, self.overwrite)?;
        let progress = |runs: usize, rms: f64| {
            if !self.quiet {
                complain(format!("run {runs}, RMS difference {}", significant(rms, 4)));
            }
        };
        let found = {
            let _prints = Prints::discard();
            fit_case(&request, &progress)
        };
        let fit = found.map_err(|problems| Refusal::input(problems.join("\n")))?;
        directory.begin(&[])?;
        let undrawn = fit.write(&mut directory, &request)?;
        directory.remove_earlier()?;
        directory.finish()?;
        if !self.quiet {
            say(&(fit.describe() + &format!("-> {}\n", folder.display())));
        }
        for warning in fit.warnings.iter().chain(&undrawn).filter(|_| !self.quiet) {
            match &self.data[..] {
                [data] => complain(format!("{}: warning: {warning}", data.display())),
                _ => complain(format!("warning: {warning}")),
            }
        }
        match &fit.trouble {
            None => Ok(DONE),
            Some(trouble) if request.tests.len() > 1 => Err(Refusal::failed(trouble)),
            Some(trouble) => Err(Refusal::failed(format!("{}: {trouble}", case.display()))),
        }
    }

    /// The tests, in the order of the data.
    fn tests(&self) -> Result<Vec<Test>, Refusal> {
        let count = self.data.len();
        let several = |what: &str, given: usize| match given {
            0 => Err(Refusal::input(format!("{what} is needed"))),
            _ if given == 1 || given == count => Ok(()),
            _ => Err(Refusal::input(format!(
                "{what} is given {given} times, --data {count} times: one for each, or one for all"
            ))),
        };
        several("CASE.json", self.cases.len())?;
        several("--data", count)?;
        several("--curve", self.curve.len())?;
        several("--weight", self.weights.len().max(1))?;
        let test = |(k, data): (usize, &PathBuf)| {
            let (overrides, plugin_paths) = (self.overrides.clone(), self.plugin_paths.clone());
            Test {
                source: CaseSource { overrides, plugin_paths, ..CaseSource::file(&self.cases[k % self.cases.len()]) },
                data: data.clone(),
                points: None,
                curve: self.curve[k % self.curve.len()].clone(),
                weight: if self.weights.is_empty() { 1.0 } else { self.weights[k % self.weights.len()] },
            }
        };
        Ok(self.data.iter().enumerate().map(test).collect())
    }
}

//! `pullout plugin build`.

use super::super::{DONE, Refusal, complain, say};
use pullout_check::build::{self, BuildRequest, Form};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(in crate::command) struct BuildArguments {
    /// Fortran (.f .for .ftn fixed form; .f90 … free form), C, C++; object files are linked as they are.
    #[arg(required = true, value_name = "SOURCE")]
    sources: Vec<PathBuf>,
    /// The library [default: lib<first source>.so in this folder].
    #[arg(short, long, value_name = "OUT.so")]
    output: Option<PathBuf>,
    /// Read the Fortran sources in fixed form, whatever their suffix.
    #[arg(long, conflicts_with = "free")]
    fixed: bool,
    /// Read the Fortran sources in free form, whatever their suffix.
    #[arg(long)]
    free: bool,
    /// Additional compiler flag, e.g. --flag=-fopenmp (may be repeated).
    #[arg(long = "flag", value_name = "FLAG", allow_hyphen_values = true)]
    flags: Vec<String>,
    /// Check array bounds, uninitialised reals and invalid operations at run time. Calls are slower; errors are
    /// reported with the line of the source.
    #[arg(long)]
    debug: bool,
}

pub(super) fn run(arguments: &BuildArguments) -> Result<u8, Refusal> {
    let form = match (arguments.fixed, arguments.free) {
        (true, _) => Some(Form::Fixed),
        (_, true) => Some(Form::Free),
        _ => None,
    };
    let request = BuildRequest {
        sources: arguments.sources.clone(),
        output: arguments.output.clone(),
        form,
        flags: arguments.flags.clone(),
        debug: arguments.debug,
    };
    let built = build::build(&request).map_err(|refusal| match refusal {
        build::Refusal::File { .. } => Refusal::input(refusal),
        _ => Refusal::failed(refusal),
    })?;
    built.words().iter().for_each(complain);
    say(&format!("{}: {}\n", built.library.display(), built.entry_points.join(", ")));
    Ok(DONE)
}

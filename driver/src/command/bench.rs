//! `pullout bench`: starts the program `pullout-bench`, if it is installed.

use super::Refusal;
use pullout_run::isolation;
use std::ffi::OsString;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::Command;

/// The program, next to this one.
const PROGRAM: &str = "pullout-bench";

/// Arguments that are passed on.
#[derive(Debug, clap::Args)]
pub(super) struct BenchArguments {
    /// Arguments of `pullout-bench`.
    #[arg(value_name = "ARGUMENTS", trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

/// Replaces this process by the other program. Returns only if that fails, with the reason.
pub(super) fn run(BenchArguments { arguments }: &BenchArguments) -> Refusal {
    match isolation::program().and_then(Path::canonicalize).map(|path| path.with_file_name(PROGRAM)) {
        Ok(program) if program.is_file() => {
            let error = Command::new(&program).args(arguments).exec();
            Refusal::failed(format!("{}: {error}", program.display()))
        }
        _ => {
            let line: Vec<_> = arguments.iter().map(|argument| argument.to_string_lossy()).collect();
            let line = line.join(" ");
            Refusal::input(format!(
                "{PROGRAM} is not installed next to pullout; in the source folder, use `cargo run --release -p {PROGRAM} -- {line}`"
            ))
        }
    }
}

//! Compilers of other languages. Where one is missing a test says so and passes, unless
//! `PULLOUT_REQUIRE_CLIENTS=1` makes that a failure.

use std::io::Write;
use std::process::{Command, Output};

/// A program that the tests of clients need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tool {
    /// gcc.
    C,
    /// g++.
    Cpp,
    /// gfortran.
    Fortran,
    /// valgrind.
    Valgrind,
    /// nm, which lists the symbols of a library.
    Nm,
}

impl Tool {
    /// The program's name.
    pub fn program(self) -> &'static str {
        match self {
            Self::C => "gcc",
            Self::Cpp => "g++",
            Self::Fortran => "gfortran",
            Self::Valgrind => "valgrind",
            Self::Nm => "nm",
        }
    }
}

/// A command with this tool; `None`, after a notice, where it is not installed.
///
/// # Panics
/// If it is missing and `PULLOUT_REQUIRE_CLIENTS` is 1.
pub fn find(tool: Tool) -> Option<Command> {
    let program = tool.program();
    if Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success()) {
        return Some(Command::new(program));
    }
    let required = std::env::var_os("PULLOUT_REQUIRE_CLIENTS").is_some_and(|value| value == "1");
    assert!(!required, "{program} is missing, and PULLOUT_REQUIRE_CLIENTS=1");
    // Not `println!`, which the test harness shows only for failures; a closed stderr is no failure.
    let _ = writeln!(std::io::stderr(), "NOTICE: {program} is not installed: this check is skipped");
    None
}

/// Runs a command that must succeed.
///
/// # Panics
/// With the program's own words if it does not.
pub fn run(command: &mut Command) -> Output {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{command:?}: {}\n{out}\n{err}", output.status);
    output
}

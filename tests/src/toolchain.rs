//! Compilers of other languages. Where one is missing a test says so and passes, unless
//! `PULLOUT_REQUIRE_CLIENTS=1` makes that a failure.

use std::io::Write;
use std::path::PathBuf;
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
    /// cmake.
    CMake,
    /// pkg-config.
    PkgConfig,
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
            Self::CMake => "cmake",
            Self::PkgConfig => "pkg-config",
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
    skip(&format!("{program} is not installed"));
    None
}

/// Returns whether a C++ program that includes a header, or is linked with a library, can be built here. Prints a notice if not.
///
/// # Panics
/// If it cannot and `PULLOUT_REQUIRE_CLIENTS` is 1.
pub fn has_library(name: &str, arguments: &[&str]) -> bool {
    let mut command = Command::new("g++");
    command.args(["-x", "c++", "/dev/null", "-x", "none", "-shared", "-fPIC", "-o", "/dev/null"]).args(arguments);
    let has = command.output().is_ok_and(|output| output.status.success());
    if !has {
        skip(&format!("{name} is not installed"));
    }
    has
}

/// Returns the file or folder that an environment variable names. If it is not set, prints a notice and returns `None`.
///
/// # Panics
/// If it is not set and `PULLOUT_REQUIRE_CLIENTS` is 1.
pub fn named_by(variable: &str) -> Option<PathBuf> {
    let path = std::env::var_os(variable).map(PathBuf::from);
    if path.is_none() {
        skip(&format!("{variable} is not set"));
    }
    path
}

/// Says that a check is skipped and why.
fn skip(reason: &str) {
    let required = std::env::var_os("PULLOUT_REQUIRE_CLIENTS").is_some_and(|value| value == "1");
    assert!(!required, "{reason}, and PULLOUT_REQUIRE_CLIENTS=1");
    notice(reason);
}

/// Reports that an optional check is skipped, and why.
pub fn notice(reason: &str) {
    // Not `println!`, which the test harness shows only for failures; a closed stderr is no failure.
    let _ = writeln!(std::io::stderr(), "NOTICE: {reason}: this check is skipped");
}

/// Runs a command that must succeed.
///
/// # Panics
/// With the program's output if it fails.
pub fn run(command: &mut Command) -> Output {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{command:?}: {}\n{out}\n{err}", output.status);
    output
}

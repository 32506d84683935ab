//! Our laws in third-party programs, from an installation: `cargo xtask install --prefix P`, then
//! `PULLOUT_PREFIX=P cargo test -p end-to-end-tests --test elsewhere`. The Python programs need `PULLOUT_PYTHON`, a
//! Python with what `examples/requirements.txt` lists. Without these variables the checks are skipped; without a `ccx` on the PATH those
//! with CalculiX.

mod abaqus;
mod calculix;
mod compiled;
mod python;

use end_to_end_tests::{named_by, run, shipped_laws, workspace};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The installation.
struct Installation {
    prefix: PathBuf,
}

impl Installation {
    /// Finds the installation that `PULLOUT_PREFIX` names.
    fn find() -> Option<Self> {
        named_by("PULLOUT_PREFIX").map(|prefix| Self { prefix })
    }

    /// The program, with nothing of the caller's plugins.
    fn program(&self) -> Command {
        let mut command = Command::new(self.prefix.join("bin/pullout"));
        command.env_remove("PULLOUT_PLUGIN_PATH");
        command
    }

    /// The library of a law.
    fn library(&self, law: &str) -> PathBuf {
        self.prefix.join("lib/pullout").join(umat_abi::host::library_file_name(law))
    }

    /// Runs a case into a folder.
    fn run_case(&self, case: &Path, overrides: &[String], out: &Path) {
        let mut command = self.program();
        command.args(["run", "--quiet", "--out"]).arg(out).arg(case);
        for entry in overrides {
            command.args(["--set", entry]);
        }
        run(&mut command);
    }
}

/// Columns of a `history.csv`, row by row.
fn history(out: &Path, columns: &[&str]) -> Vec<Vec<f64>> {
    let file = out.join("history.csv");
    let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<_> = lines.next().expect("a header").split(',').collect();
    let place = |name: &&str| header.iter().position(|column| column == name).unwrap_or_else(|| panic!("{name}"));
    let places: Vec<_> = columns.iter().map(place).collect();
    let row = |line: &str| {
        let fields: Vec<_> = line.split(',').collect();
        places.iter().map(|&k| fields[k].parse().expect("a number")).collect()
    };
    lines.map(row).collect()
}

/// Lines of numbers.
fn numbers(output: &[u8]) -> Vec<Vec<f64>> {
    let line = |line: &str| line.split_whitespace().map(|word| word.parse().expect("a number")).collect();
    String::from_utf8_lossy(output).lines().map(line).collect()
}

#[test]
fn the_program_knows_the_plugins_that_are_installed_with_it() {
    let Some(installation) = Installation::find() else { return };
    for law in shipped_laws().iter().map(String::as_str).chain(["pullout_laws"]) {
        let info = installation.program().args(["plugin", "info", law]).output().expect("the program starts");
        let info = String::from_utf8_lossy(&info.stdout).into_owned();
        assert!(info.contains(&*installation.library(law).to_string_lossy()), "{info}");
        assert!(info.contains("Process: pullout's own"), "{law}: {info}");
    }
}

#[test]
fn manual_pages_and_completions_are_installed() {
    let Some(installation) = Installation::find() else { return };
    let pages = ["man/man1/pullout.1", "man/man1/pullout-run.1"];
    let completions = [
        "bash-completion/completions/pullout",
        "zsh/site-functions/_pullout",
        "fish/vendor_completions.d/pullout.fish",
    ];
    for file in pages.into_iter().chain(completions) {
        let file = installation.prefix.join("share").join(file);
        let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        assert!(text.contains("pullout"), "{}", file.display());
    }
}

/// A file of `examples/`.
fn example(file: &str) -> PathBuf {
    workspace("examples").join(file)
}

//! Programs that drive a material point, each through its Python module: simcoon (C++), jaxmat (compiled by JAX), singlepointsim
//! (Python around a Fortran UMAT).

use super::points::{ComparedLaw, Row};
use crate::BenchError;
use std::ffi::OsStr;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// A program that drives a material point.
#[derive(Debug)]
pub struct Rival {
    /// Name of the package, and of its module.
    pub name: &'static str,
    /// Script that runs it, and prints times; its doc comment says how.
    script: &'static str,
    /// Name of a file with its UMAT, and the file's text.
    umat: Option<(&'static str, &'static str)>,
}

/// All of them, in the order in which [`ComparedLaw`] has their laws.
pub const RIVALS: [Rival; 3] = [
    Rival { name: "simcoon", script: include_str!("simcoon_point.py"), umat: None },
    Rival { name: "jaxmat", script: include_str!("jaxmat_point.py"), umat: None },
    Rival {
        name: "singlepointsim",
        script: include_str!("singlepointsim_point.py"),
        umat: Some(("j2.f90", include_str!("../../../tests/umats/j2.f90"))),
    },
];

/// One thread: the arrays are small, and those that wait for work would count as work.
const THREADS: [&str; 3] = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"];

/// A law as a rival has it: name, number of states, parameters.
pub type RivalLaw = (&'static str, usize, &'static [f64]);

/// A Python that has a rival.
#[derive(Debug)]
pub struct Installed {
    rival: &'static Rival,
    python: PathBuf,
    /// Name and version.
    pub program: String,
}

impl Rival {
    /// Finds the installed program. `None`: there is no such Python, or it does not have this program.
    pub fn find(&'static self, python: Option<&Path>) -> Option<Installed> {
        let python = python.unwrap_or(Path::new("python3")).to_owned();
        let name = self.name;
        let version = format!("import {name}, importlib.metadata; print(importlib.metadata.version('{name}'))");
        let output = command(&python).args(["-c", &version]).output().ok()?;
        let version = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        output.status.success().then(|| Installed { rival: self, python, program: format!("{name} {version}") })
    }
}

impl Installed {
    fn script(
        &self,
        law: &ComparedLaw,
        (name, states, props): RivalLaw,
        increments: usize,
        folder: &Path,
    ) -> Result<Command, BenchError> {
        // named otherwise than the module, which it would hide
        let script = folder.join(format!("{}_point.py", self.rival.name));
        std::fs::write(&script, self.rival.script)?;
        if let Some((file, text)) = self.rival.umat {
            std::fs::write(folder.join(file), text)?;
        }
        let mut command = command(&self.python);
        command
            .current_dir(folder)
            .arg(script)
            .arg(name)
            .arg(states.to_string())
            .arg(increments.to_string())
            .arg(law.strain.to_string());
        command.args(props.iter().map(f64::to_string)).stdin(Stdio::piped()).stdout(Stdio::piped());
        Ok(command)
    }

    /// Starts it for many runs of a path.
    ///
    /// # Errors
    /// The program cannot be started.
    pub fn start(
        &self,
        law: &ComparedLaw,
        its: RivalLaw,
        increments: usize,
        folder: &Path,
    ) -> Result<Worker, BenchError> {
        let mut child = self.script(law, its, increments, folder)?.spawn()?;
        let (input, output) = (child.stdin.take(), child.stdout.take().map(BufReader::new));
        let rows = folder.join(format!("{}.bin", self.rival.name));
        Ok(Worker { rival: self.rival, child, input, output, rows })
    }

    /// Runs a path once, with everything from the start of the program to its end.
    ///
    /// # Errors
    /// The run fails.
    pub fn run_whole(
        &self,
        law: &ComparedLaw,
        its: RivalLaw,
        increments: usize,
        folder: &Path,
    ) -> Result<(), BenchError> {
        let mut child = self.script(law, its, increments, folder)?.spawn()?;
        if let Some(mut input) = child.stdin.take() {
            writeln!(input)?;
        }
        let output = child.wait_with_output()?;
        if output.status.success() { Ok(()) } else { Err(failed(self.rival, "it ended with an error")) }
    }
}

fn command(python: &Path) -> Command {
    let mut command = Command::new(python);
    command.arg("-B").envs(THREADS.map(|name| (OsStr::new(name), OsStr::new("1"))));
    command
}

fn failed(rival: &Rival, why: &str) -> BenchError {
    BenchError::Failed(format!("{}: {why}", rival.name))
}

/// A rival, waiting for work.
pub struct Worker {
    rival: &'static Rival,
    child: Child,
    input: Option<ChildStdin>,
    output: Option<BufReader<ChildStdout>>,
    rows: PathBuf,
}

impl Worker {
    /// Time of the processor that the solver took, s, and strain and stress after each increment.
    ///
    /// # Errors
    /// The run fails, or its answer is invalid.
    pub fn run(&mut self) -> Result<(f64, Vec<Row>), BenchError> {
        let failed = |why| failed(self.rival, why);
        let (Some(input), Some(output)) = (&mut self.input, &mut self.output) else { return Err(failed("no pipe")) };
        writeln!(input, "{}", self.rows.display())?;
        let mut line = String::new();
        output.read_line(&mut line)?;
        let seconds = line.trim().parse().map_err(|_| failed("it ended with an error"))?;
        let bytes = std::fs::read(&self.rows)?;
        let (numbers, _) = bytes.as_chunks::<8>();
        let (rows, _) = numbers.as_chunks::<7>();
        let row = |row: &[[u8; 8]; 7]| {
            let [strain, stress @ ..] = row.map(f64::from_le_bytes);
            (strain, stress)
        };
        Ok((seconds, rows.iter().map(row).collect()))
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // the end of its input is the end of its work
        self.input = None;
        let _ = self.child.wait();
    }
}

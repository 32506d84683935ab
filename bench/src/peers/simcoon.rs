//! simcoon, a C++ library with a solver of material points, through its Python module.

use super::points::ComparedLaw;
use crate::BenchError;
use std::ffi::OsStr;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// Script that prints the version of simcoon; it fails where simcoon is not installed.
const VERSION: &str = "import simcoon, importlib.metadata; print(importlib.metadata.version('simcoon'))";
const SCRIPT: &str = include_str!("point.py");
/// One thread: the arrays are small, and those that wait for work would count as work.
const THREADS: [&str; 3] = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"];

/// A Python that has it.
#[derive(Clone, Debug)]
pub struct Simcoon {
    python: PathBuf,
    /// Name and version.
    pub program: String,
}

impl Simcoon {
    /// `None`: there is no such Python, or it has no simcoon.
    pub fn find(python: Option<&Path>) -> Option<Self> {
        let python = python.unwrap_or(Path::new("python3")).to_owned();
        let output = command(&python).args(["-c", VERSION]).output().ok()?;
        let version = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        output.status.success().then(|| Self { python, program: format!("simcoon {version}") })
    }

    fn script(&self, law: &ComparedLaw, increments: usize, folder: &Path) -> Result<Command, BenchError> {
        // named otherwise than the module, which it would hide
        let script = folder.join("point.py");
        std::fs::write(&script, SCRIPT)?;
        let mut command = command(&self.python);
        let (name, states, props) = law.simcoon;
        command.arg(script).arg(name).arg(states.to_string()).arg(increments.to_string()).arg(law.strain.to_string());
        command.args(props.iter().map(f64::to_string)).stdin(Stdio::piped()).stdout(Stdio::piped());
        Ok(command)
    }

    /// Starts it for many runs of a path.
    ///
    /// # Errors
    /// The program cannot be started.
    pub fn start(&self, law: &ComparedLaw, increments: usize, folder: &Path) -> Result<Worker, BenchError> {
        let mut child = self.script(law, increments, folder)?.spawn()?;
        let (input, output) = (child.stdin.take(), child.stdout.take().map(BufReader::new));
        Ok(Worker { child, input, output, stresses: folder.join("stresses.bin") })
    }

    /// Runs a path once, with everything from the start of the program to its end.
    ///
    /// # Errors
    /// The run fails.
    pub fn run_whole(&self, law: &ComparedLaw, increments: usize, folder: &Path) -> Result<(), BenchError> {
        let mut child = self.script(law, increments, folder)?.spawn()?;
        if let Some(mut input) = child.stdin.take() {
            writeln!(input)?;
        }
        let output = child.wait_with_output()?;
        if output.status.success() { Ok(()) } else { Err(failed("it ended with an error")) }
    }
}

fn command(python: &Path) -> Command {
    let mut command = Command::new(python);
    command.arg("-B").envs(THREADS.map(|name| (OsStr::new(name), OsStr::new("1"))));
    command
}

fn failed(why: &str) -> BenchError {
    BenchError::Failed(format!("simcoon: {why}"))
}

/// simcoon, waiting for work.
pub struct Worker {
    child: Child,
    input: Option<ChildStdin>,
    output: Option<BufReader<ChildStdout>>,
    stresses: PathBuf,
}

impl Worker {
    /// Time of the processor that the solver took, s, and the stress after each increment.
    ///
    /// # Errors
    /// The run fails, or its answer is invalid.
    pub fn run(&mut self) -> Result<(f64, Vec<[f64; 6]>), BenchError> {
        let (Some(input), Some(output)) = (&mut self.input, &mut self.output) else { return Err(failed("no pipe")) };
        writeln!(input, "{}", self.stresses.display())?;
        let mut line = String::new();
        output.read_line(&mut line)?;
        let seconds = line.trim().parse().map_err(|_| failed("it ended with an error"))?;
        let bytes = std::fs::read(&self.stresses)?;
        let (numbers, _) = bytes.as_chunks::<8>();
        let (rows, _) = numbers.as_chunks::<6>();
        Ok((seconds, rows.iter().map(|row| row.map(f64::from_le_bytes)).collect()))
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // the end of its input is the end of its work
        self.input = None;
        let _ = self.child.wait();
    }
}

//! Strain paths through the program itself: plugin, stress-free sides found by Newton's method, increments cut back
//! where they fail.

use super::path::{Components, LEGS, Path};
use super::subject::MeasuredLaw;
use crate::BenchError;
use pullout_case::Case;
use pullout_run::path::{self, Observer, Row, Statistics, Stop};
use pullout_run::program::Program;
use serde_json::{Value, json};
use std::io;
use std::path::PathBuf;

/// A path as the driver runs it.
#[derive(Debug)]
pub struct Driven {
    program: Box<Program>,
    /// Place at which the stress begins in a row.
    stress: usize,
}

/// Result of a run.
#[derive(Debug)]
pub struct Run {
    /// The stress after each increment.
    pub stresses: Vec<Components>,
    /// Cost of the run.
    pub statistics: Statistics,
}

impl Driven {
    /// A subject along a path in `n` increments; where the path is one of uniaxial or biaxial stress, the sides are free.
    ///
    /// # Errors
    /// The plugin is missing or refuses the parameters.
    pub fn new(subject: &MeasuredLaw, path: Path, n: usize, plugin_paths: &[PathBuf]) -> Result<Self, BenchError> {
        let document = json!({
            "kind": "point",
            "title": format!("{}, {}", subject.name, path.name()),
            "material": { "plugin": subject.law, "props": subject.props },
            "mode": "3d",
            "steps": steps(subject, path, n),
            "output": { "plots": false },
        });
        Self::read(document, plugin_paths)
    }

    /// A point as a case describes it, in three dimensions.
    ///
    /// # Errors
    /// The case is refused.
    pub fn read(document: Value, plugin_paths: &[PathBuf]) -> Result<Self, BenchError> {
        let case = pullout_case::read_document(document, &PathBuf::from("bench.json"), plugin_paths)?;
        let Case::Path(program) = case else { unreachable!("the document is of kind point") };
        let columns = program.columns();
        let column = columns.iter().position(|column| column == "s11").expect("a point has stresses");
        // step and increment are no values of a row
        Ok(Self { program, stress: column - 2 })
    }

    /// Runs it from the start.
    ///
    /// # Errors
    /// The message of a point that cannot be advanced.
    pub fn run(&self) -> Result<Run, String> {
        let mut stresses = Stresses { first: self.stress, rows: Vec::new() };
        let (statistics, result) = path::run(&self.program, &mut stresses);
        match result {
            Ok(()) => Ok(Run { stresses: stresses.rows, statistics }),
            Err(Stop::Failed(failure)) => Err(failure.message),
            Err(Stop::Write(error)) => Err(error.to_string()),
        }
    }
}

fn steps(subject: &MeasuredLaw, path: Path, n: usize) -> Value {
    let extent = &subject.extent;
    match path {
        Path::Tension => json!([{ "increments": n, "target": { "e11": extent.tension } }]),
        Path::Compression => json!([{ "increments": n, "target": { "e11": -extent.compression } }]),
        Path::Biaxial => json!([{
            "increments": n,
            "target": { "e11": -extent.compression },
            "constraints": [{ "s22": 1, "s11": -0.52, "equals": 0 }],
        }]),
        Path::Cyclic => {
            let leg = |corner: &f64| json!({ "increments": n / LEGS, "target": { "e11": corner } });
            Path::corners(extent)[1..].iter().map(leg).collect()
        }
        Path::NonProportional => path.strains(extent, n).iter().map(one_increment).collect(),
    }
}

fn one_increment(strain: &Components) -> Value {
    let [e11, e22, e33, g12, g13, g23] = strain;
    json!({
        "increments": 1,
        "target": { "e11": e11, "e22": e22, "e33": e33, "g12": g12, "g13": g13, "g23": g23 },
    })
}

/// Keeps the stress of each increment.
struct Stresses {
    first: usize,
    rows: Vec<Components>,
}

impl Observer for Stresses {
    fn row(&mut self, row: Row<'_>) -> io::Result<()> {
        if row.step > 0 {
            self.rows.push(std::array::from_fn(|i| row.values[self.first + i]));
        }
        Ok(())
    }

    fn increment_done(&mut self, _: Row<'_>, _: Statistics) {}
}

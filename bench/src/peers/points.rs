//! A material point here and in simcoon: the same law, the same increments of uniaxial stress.

use super::simcoon::Simcoon;
use crate::laws::driven::Driven;
use crate::timing::{children_time, median, thread_time};
use crate::{BenchError, Settings};
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Stdio};

/// Increments, and how often each side has its turn.
const FULL: (usize, usize) = (20_000, 11);
const QUICK: (usize, usize) = (500, 3);

/// A law with parameters, as both sides have it.
pub struct ComparedLaw {
    /// Name of our plugin.
    pub plugin: &'static str,
    props: &'static [f64],
    /// Law of simcoon: name, number of states, parameters.
    pub simcoon: (&'static str, usize, &'static [f64]),
    /// ε_11 at the end.
    pub strain: f64,
    /// σ_11 at a strain, MPa.
    exact: fn(f64) -> f64,
}

/// E, MPa, and ν.
const ELASTIC: [f64; 2] = [210e3, 0.3];
/// First yield and the modulus of linear hardening, MPa.
const YIELD: [f64; 2] = [347.0, 2100.0];

const LAWS: [ComparedLaw; 2] = [
    ComparedLaw {
        plugin: "linear_elastic",
        props: &ELASTIC,
        simcoon: ("ELISO", 1, &[ELASTIC[0], ELASTIC[1], 0.0]),
        strain: 0.02,
        exact: |strain| ELASTIC[0] * strain,
    },
    ComparedLaw {
        plugin: "j2_plasticity",
        props: &[ELASTIC[0], ELASTIC[1], YIELD[0], 0.0, YIELD[0] + YIELD[1], 1.0],
        // hardening k p^m with m = 1
        simcoon: ("EPICP", 8, &[ELASTIC[0], ELASTIC[1], 0.0, YIELD[0], YIELD[1], 1.0]),
        strain: 0.02,
        exact: |strain| {
            let [modulus, _] = ELASTIC;
            let [first, hardening] = YIELD;
            let tangent = modulus * hardening / (modulus + hardening);
            (modulus * strain).min(first + tangent * (strain - first / modulus))
        },
    },
];

/// A program along a path.
pub struct Run {
    pub program: String,
    /// Median of the processor's time of the analysis alone, s.
    pub analysis: f64,
    /// Median of the processor's time of the whole process, s.
    pub process: f64,
    /// max |σ − σ_exact| over the path, all components, over the largest stress.
    pub error: f64,
    /// σ_11 at the end, MPa.
    pub result: f64,
}

/// A law on both sides.
pub struct Compared {
    pub law: &'static str,
    pub increments: usize,
    pub rounds: usize,
    pub ours: Run,
    /// `None`: not installed.
    pub theirs: Option<Run>,
    /// Medians of their time over ours: of the analysis, of the process.
    pub ratios: Option<[f64; 2]>,
}

/// All laws.
pub fn compare(settings: &Settings) -> Result<Vec<Compared>, BenchError> {
    let (increments, rounds) = if settings.quick { QUICK } else { FULL };
    let simcoon = Simcoon::find(settings.python.as_deref());
    LAWS.iter().map(|law| law.compare(settings, increments, rounds, simcoon.as_ref())).collect()
}

/// Times and results, one of each round.
#[derive(Default)]
struct Turns {
    analysis: Vec<f64>,
    process: Vec<f64>,
    stresses: Vec<[f64; 6]>,
}

impl Turns {
    fn over(&self, other: &Self) -> [f64; 2] {
        let ratio =
            |own: &[f64], other: &[f64]| median(own.iter().zip(other).map(|(own, other)| own / other).collect());
        [ratio(&self.analysis, &other.analysis), ratio(&self.process, &other.process)]
    }

    fn run(self, program: &str, law: &ComparedLaw, increments: usize) -> Result<Run, BenchError> {
        if self.stresses.len() != increments {
            let rows = self.stresses.len();
            return Err(BenchError::Failed(format!("{program}: {rows} rows of {increments} increments")));
        }
        Ok(Run {
            program: program.into(),
            analysis: median(self.analysis),
            process: median(self.process),
            error: law.error(&self.stresses),
            result: self.stresses.last().map_or(f64::NAN, |stress| stress[0]),
        })
    }
}

impl ComparedLaw {
    fn compare(
        &self,
        settings: &Settings,
        increments: usize,
        rounds: usize,
        simcoon: Option<&Simcoon>,
    ) -> Result<Compared, BenchError> {
        let folder = tempfile::tempdir()?;
        let driven = Driven::read(self.document(increments), &settings.plugin_paths)?;
        let case = folder.path().join("case.json");
        std::fs::write(&case, self.document(increments).to_string())?;
        let mut worker = simcoon.map(|simcoon| simcoon.start(self, increments, folder.path())).transpose()?;
        let (mut ours, mut theirs) = (Turns::default(), Turns::default());
        for _ in 0..rounds {
            let start = thread_time();
            let run = driven.run().map_err(BenchError::Failed)?;
            ours.analysis.push((thread_time() - start).as_secs_f64());
            ours.stresses = run.stresses;
            if let Some(worker) = &mut worker {
                let (seconds, stresses) = worker.run()?;
                theirs.analysis.push(seconds);
                theirs.stresses = stresses;
            }
        }
        // an idle child that is waited for would count
        drop(worker);
        for _ in 0..rounds {
            ours.process.push(of_children(|| self.run_whole(&case, settings, folder.path()))?);
            if let Some(simcoon) = simcoon {
                theirs.process.push(of_children(|| simcoon.run_whole(self, increments, folder.path()))?);
            }
        }
        let ratios = simcoon.map(|_| theirs.over(&ours));
        let theirs = simcoon.map(|simcoon| theirs.run(&simcoon.program, self, increments)).transpose()?;
        let ours = ours.run("pullout", self, increments)?;
        Ok(Compared { law: self.plugin, increments, rounds, ours, theirs, ratios })
    }

    /// Returns a case with a single output row, so that file output is not timed.
    fn document(&self, increments: usize) -> Value {
        json!({
            "kind": "point",
            "title": self.plugin,
            "material": { "plugin": self.plugin, "props": self.props },
            "mode": "3d",
            "steps": [{ "increments": increments, "target": { "e11": self.strain } }],
            "output": { "plots": false },
        })
    }

    fn run_whole(&self, case: &Path, settings: &Settings, folder: &Path) -> Result<(), BenchError> {
        let program = std::env::current_exe()?.with_file_name("pullout");
        if !program.is_file() {
            let words = format!("{}: there is no pullout beside this program: cargo build --release", self.plugin);
            return Err(BenchError::Failed(words));
        }
        let mut command = Command::new(program);
        command.args(["run", "--quiet", "--set", "output.every=100000000", "--out"]);
        command.arg(folder.join("out")).arg(case).stdout(Stdio::null());
        for path in &settings.plugin_paths {
            command.arg("--plugin-path").arg(path);
        }
        if command.status()?.success() {
            Ok(())
        } else {
            Err(BenchError::Failed(format!("{}: pullout run failed", self.plugin)))
        }
    }

    fn error(&self, stresses: &[[f64; 6]]) -> f64 {
        let count = stresses.len() as f64;
        let along = stresses.iter().enumerate().map(|(k, stress)| {
            let exact = (self.exact)(self.strain * (k + 1) as f64 / count);
            (exact, stress.iter().zip([exact, 0.0, 0.0, 0.0, 0.0, 0.0]).map(|(own, exact)| (own - exact).abs()))
        });
        let (mut largest, mut worst) = (0.0_f64, 0.0_f64);
        for (exact, differences) in along {
            largest = largest.max(exact.abs());
            for difference in differences {
                worst = if difference.is_nan() { f64::INFINITY } else { worst.max(difference) };
            }
        }
        worst / largest
    }
}

/// Time of the processors on children while something is done, s.
fn of_children(work: impl FnOnce() -> Result<(), BenchError>) -> Result<f64, BenchError> {
    let before = children_time();
    work()?;
    Ok((children_time() - before).as_secs_f64())
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn the_exact_answers_are_exact() {
        let [elastic, plastic] = &LAWS;
        assert_eq!((elastic.exact)(0.01), 2100.0);
        assert_eq!((plastic.exact)(1e-3), 210.0);
        // ε = σ/E + (σ − σ_y)/H
        let stress = (plastic.exact)(0.02);
        assert!((stress / 210e3 + (stress - 347.0) / 2100.0 - 0.02).abs() < 1e-15);
        // the same at first yield from both sides
        assert!(((plastic.exact)(347.0 / 210e3) - 347.0).abs() < 1e-10);
    }

    #[test]
    fn an_error_is_the_worst_component() {
        let [elastic, _] = &LAWS;
        let mut stresses = [[2100.0, 0.0, 0.0, 0.0, 0.0, 0.0], [4200.0, 0.0, 0.0, 0.0, 0.0, 0.0]];
        assert!(elastic.error(&stresses) < 1e-15);
        stresses[0][3] = -4.2;
        assert!((elastic.error(&stresses) - 1e-3).abs() < 1e-15);
        stresses[1][5] = f64::NAN;
        assert!(elastic.error(&stresses).is_infinite());
    }
}

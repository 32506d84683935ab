//! A material point here and in other programs: the same law, the same increments of uniaxial stress.

use super::rival::{Installed, RIVALS, Rival, RivalLaw, Worker};
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
    /// The law of each of [`RIVALS`]; `None`: it has none.
    rivals: [Option<RivalLaw>; RIVALS.len()],
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
        rivals: [Some(("ELISO", 1, &[ELASTIC[0], ELASTIC[1], 0.0])), Some(("elastic", 0, &ELASTIC)), None],
        strain: 0.02,
        exact: |strain| ELASTIC[0] * strain,
    },
    ComparedLaw {
        plugin: "j2_plasticity",
        props: &[ELASTIC[0], ELASTIC[1], YIELD[0], 0.0, YIELD[0] + YIELD[1], 1.0],
        rivals: [
            // hardening k p^m with m = 1
            Some(("EPICP", 8, &[ELASTIC[0], ELASTIC[1], 0.0, YIELD[0], YIELD[1], 1.0])),
            Some(("J2", 0, &[ELASTIC[0], ELASTIC[1], YIELD[0], YIELD[1]])),
            Some(("j2.f90", 7, &[ELASTIC[0], ELASTIC[1], YIELD[0], YIELD[1]])),
        ],
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

/// Strain ε_11 and the stress after an increment.
pub(crate) type Row = (f64, [f64; 6]);

/// A law on all sides.
pub struct Compared {
    pub law: &'static str,
    pub increments: usize,
    pub rounds: usize,
    pub ours: Run,
    pub theirs: Vec<Peer>,
}

/// One of the other programs.
pub struct Peer {
    pub name: &'static str,
    /// Its run, and medians of its time over ours: of the analysis, of the process; `None`: not installed.
    pub run: Option<(Run, [f64; 2])>,
}

/// All laws.
pub fn compare(settings: &Settings) -> Result<Vec<Compared>, BenchError> {
    let (increments, rounds) = if settings.quick { QUICK } else { FULL };
    let rivals = RIVALS.each_ref().map(|rival| rival.find(settings.python.as_deref()));
    LAWS.iter().map(|law| law.compare(settings, increments, rounds, &rivals)).collect()
}

/// Times and results, one of each round.
#[derive(Default)]
struct Turns {
    analysis: Vec<f64>,
    process: Vec<f64>,
    rows: Vec<Row>,
}

impl Turns {
    fn over(&self, other: &Self) -> [f64; 2] {
        let ratio =
            |own: &[f64], other: &[f64]| median(own.iter().zip(other).map(|(own, other)| own / other).collect());
        [ratio(&self.analysis, &other.analysis), ratio(&self.process, &other.process)]
    }

    fn run(self, program: &str, law: &ComparedLaw, increments: usize) -> Result<Run, BenchError> {
        if self.rows.len() != increments {
            let rows = self.rows.len();
            return Err(BenchError::Failed(format!("{program}: {rows} rows of {increments} increments")));
        }
        Ok(Run {
            program: program.into(),
            analysis: median(self.analysis),
            process: median(self.process),
            error: law.error(&self.rows),
            result: self.rows.last().map_or(f64::NAN, |(_, stress)| stress[0]),
        })
    }
}

impl ComparedLaw {
    fn compare(
        &self,
        settings: &Settings,
        increments: usize,
        rounds: usize,
        rivals: &[Option<Installed>; RIVALS.len()],
    ) -> Result<Compared, BenchError> {
        let folder = tempfile::tempdir()?;
        let driven = Driven::read(self.document(increments), &settings.plugin_paths)?;
        let case = folder.path().join("case.json");
        std::fs::write(&case, self.document(increments).to_string())?;
        // those that have the law; of these, those that are installed
        let peers = || {
            RIVALS
                .iter()
                .zip(&self.rivals)
                .zip(rivals)
                .filter_map(|((rival, its), installed)| Some((rival, (*its)?, installed.as_ref())))
        };
        let theirs: Vec<(RivalLaw, &Installed)> =
            peers().filter_map(|(_, its, installed)| Some((its, installed?))).collect();
        let start = |(its, rival): &(RivalLaw, &Installed)| rival.start(self, *its, increments, folder.path());
        let mut workers = theirs.iter().map(start).collect::<Result<Vec<Worker>, _>>()?;
        let (mut ours, mut turns) = (Turns::default(), Vec::new());
        turns.resize_with(theirs.len(), Turns::default);
        for _ in 0..rounds {
            let start = thread_time();
            let run = driven.run().map_err(BenchError::Failed)?;
            ours.analysis.push((thread_time() - start).as_secs_f64());
            let strain = |k: usize| self.strain * (k + 1) as f64 / increments as f64;
            ours.rows = run.stresses.into_iter().enumerate().map(|(k, stress)| (strain(k), stress)).collect();
            for (worker, its) in workers.iter_mut().zip(&mut turns) {
                let (seconds, rows) = worker.run()?;
                its.analysis.push(seconds);
                its.rows = rows;
            }
        }
        // an idle child that is waited for would count
        drop(workers);
        for _ in 0..rounds {
            ours.process.push(of_children(|| self.run_whole(&case, settings, folder.path()))?);
            for ((law, rival), its) in theirs.iter().zip(&mut turns) {
                its.process.push(of_children(|| rival.run_whole(self, *law, increments, folder.path()))?);
            }
        }
        let mut turns = turns.into_iter();
        let peer = |(rival, _, installed): (&Rival, _, Option<&Installed>)| {
            let run = installed.and_then(|installed| Some((installed, turns.next()?)));
            let run = run.map(|(installed, its)| {
                let ratios = its.over(&ours);
                its.run(&installed.program, self, increments).map(|run| (run, ratios))
            });
            Ok::<_, BenchError>(Peer { name: rival.name, run: run.transpose()? })
        };
        let theirs = peers().map(peer).collect::<Result<_, _>>()?;
        let ours = ours.run("pullout", self, increments)?;
        Ok(Compared { law: self.plugin, increments, rounds, ours, theirs })
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
            let words = format!("{}: no pullout next to this program; run `cargo build --release`", self.plugin);
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

    fn error(&self, rows: &[Row]) -> f64 {
        let along = rows.iter().map(|(strain, stress)| {
            let exact = (self.exact)(*strain);
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
        let mut rows = [(0.01, [2100.0, 0.0, 0.0, 0.0, 0.0, 0.0]), (0.02, [4200.0, 0.0, 0.0, 0.0, 0.0, 0.0])];
        assert!(elastic.error(&rows) < 1e-15);
        rows[0].1[3] = -4.2;
        assert!((elastic.error(&rows) - 1e-3).abs() < 1e-15);
        rows[1].1[5] = f64::NAN;
        assert!(elastic.error(&rows).is_infinite());
    }
}

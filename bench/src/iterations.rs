//! Where Newton's iterations go: of five fibres, by what makes each of them necessary.

use super::page::Page;
use super::runs::read;
use super::table::{Cell, Table};
use super::{BenchError, Settings};
use fe_core::stepping::{
    Analysis, AnalysisStatistics, Directive, Flips, IncrementObserver, Iteration, Record, Snapshot,
};
use std::io;

/// A scene: its name, the case, what is set in it, and the slip to which it is pulled, mm: in full and if quick.
struct Scene {
    name: &'static str,
    case: &'static str,
    set: &'static [&'static str],
    slips: [f64; 2],
}

const SCENES: [Scene; 5] = [
    Scene {
        name: "45°, cover",
        case: include_str!("../../cases/chapter-7/inclined-fibre.json"),
        set: &["mesh.specimen.cover=true", "contact.law.props.p_0=3", "spalling={\"opening\":0.2,\"stress\":0.03}"],
        slips: [2.0, 0.01],
    },
    Scene {
        name: "hook",
        case: include_str!("../../cases/chapter-9/hooked.json"),
        set: &["steps.0.increments.maximum=0.064"],
        slips: [5.0, 0.01],
    },
    Scene {
        name: "perpendicular",
        case: include_str!("../../cases/chapter-6/6.14-plane.json"),
        set: &[],
        slips: [2.0, 0.01],
    },
    Scene { name: "pair", case: include_str!("../../cases/chapter-7/two-fibres.json"), set: &[], slips: [2.0, 0.01] },
    Scene { name: "bar", case: include_str!("../../cases/chapter-8/bar.json"), set: &[], slips: [10.0, 0.01] },
];

/// What makes an iteration necessary. Each has one cause: what the evaluation before it showed.
const CAUSES: [&str; 9] = [
    "prediction",
    "settlement",
    "contact opens or closes",
    "stick or slip",
    "presses or pulls",
    "cracks open or close",
    "flow begins or ends",
    "several of these",
    "nothing flipped",
];

/// Increments whose residuals are shown of each scene: at these parts of them.
const SHOWN: [f64; 4] = [0.1, 0.35, 0.6, 0.85];

/// Counts of one run.
struct Counted {
    name: &'static str,
    statistics: AnalysisStatistics,
    /// Iterations of accepted increments by cause.
    by_cause: [u64; CAUSES.len()],
    /// Corrections of which a part was applied.
    shortened: u64,
    increments: Vec<(f64, Vec<Iteration>)>,
    peak: f64,
    work: f64,
    stopped: Option<String>,
}

impl Counted {
    fn accepted(&self) -> u64 {
        self.by_cause.iter().sum()
    }
}

/// The cause of an iteration, as an index into [`CAUSES`].
fn cause(iterations: &[Iteration], index: usize) -> usize {
    if index == 0 {
        return 0;
    }
    if iterations[index].begins_round {
        return 1;
    }
    let Flips { opened, slid, pressed, cracked, flowed } = iterations[index - 1].flips;
    let kinds = [opened, slid, pressed, cracked, flowed];
    match kinds.iter().filter(|count| **count > 0).count() {
        0 => CAUSES.len() - 1,
        1 => 2 + kinds.iter().position(|count| *count > 0).unwrap_or(0),
        _ => CAUSES.len() - 2,
    }
}

impl IncrementObserver for Counted {
    fn increment(&mut self, record: &Record, _snapshot: &Snapshot<'_>) -> io::Result<Directive> {
        let iterations = &record.iterations;
        for (index, iteration) in iterations.iter().enumerate().filter(|_| record.step > 0) {
            self.by_cause[cause(iterations, index)] += 1;
            self.shortened += u64::from(iteration.step_length < 1.0);
        }
        self.peak = self.peak.max(record.load);
        self.work = record.energies.external_work;
        if record.step > 0 {
            self.increments.push((record.slip, iterations.clone()));
        }
        Ok(Directive::GoOn)
    }
}

/// Counts the iterations of all scenes.
pub(super) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("case.json");
    let mut runs = Vec::new();
    for Scene { name, case, set, slips: [full, quick] } in &SCENES {
        std::fs::write(&file, case)?;
        let slip = if settings.quick { quick } else { full };
        let mut overrides: Vec<String> = set.iter().map(ToString::to_string).collect();
        overrides.extend([format!("steps.0.slip={slip}"), "output.plots=false".into()]);
        let program = read(&file, &overrides, &settings.plugin_paths)?;
        let mut analysis = Analysis::new(&program.model).map_err(|error| BenchError::Failed(error.to_string()))?;
        analysis.watch_flips();
        let mut counted = Counted {
            name,
            statistics: AnalysisStatistics::default(),
            by_cause: [0; CAUSES.len()],
            shortened: 0,
            increments: Vec::new(),
            peak: 0.0,
            work: 0.0,
            stopped: None,
        };
        let ran = analysis.run(&mut counted);
        counted.stopped = ran.err().map(|error| format!("{name}: {error}"));
        counted.statistics = analysis.statistics();
        runs.push(counted);
    }
    Ok(page(&runs))
}

const METHOD: &str = "\
Newton's iterations of five fibres, each with the one cause that made it necessary: it is the first of its increment (the prediction); or the first after contact
has settled (multipliers, openings) or the far field shrunk; or the evaluation before it showed points on another branch than the one before that: contact points that open
or close, begin to slip or to stick, begin to press or to pull (friction follows pressure alone), damaged points a principal stress of which changes its sign, points of other laws that begin to flow or cease to; or nothing of the
kind, and what is left is smooth: geometry, friction, flow, and what a factor that is used again has left over. The hook's greatest increment is that of its case.";

fn page(runs: &[Counted]) -> Page {
    let mut data = Table::new([
        "scene",
        "increment",
        "slip_mm",
        CAUSES[0],
        CAUSES[1],
        CAUSES[2],
        CAUSES[3],
        CAUSES[4],
        CAUSES[5],
        CAUSES[6],
        CAUSES[7],
        CAUSES[8],
        "first_residual_over_scale",
        "last_residual_over_scale",
    ]);
    let row = |what: &str, value: &dyn Fn(&Counted) -> Cell| {
        let mut cells = runs.iter().map(value);
        let mut next = || cells.next().unwrap_or(Cell::Absent("–"));
        [what.into(), next(), next(), next(), next(), next()]
    };
    let [a, b, c, d, e] = SCENES.map(|scene| scene.name);
    let mut by_cause = Table::new(["cause", a, b, c, d, e]);
    for (k, cause) in CAUSES.iter().enumerate() {
        by_cause.push(row(cause, &|run| run.by_cause[k].into()));
    }
    by_cause.push(row("all", &|run| run.accepted().into()));
    by_cause.push(row("an increment", &|run| (run.accepted() as f64 / run.statistics.increments.max(1) as f64).into()));
    let mut further = Table::new([
        "scene",
        "increments",
        "in attempts thrown away",
        "attempts thrown away",
        "shortened corrections",
        "settlements",
        "evaluations",
        "factorisations",
        "solutions",
        "peak [N]",
        "work [N mm]",
    ]);
    let mut residuals = Table::new(["scene", "slip [mm]", "residual over scale, iteration by iteration"]);
    for run in runs {
        let AnalysisStatistics { increments, iterations, cutbacks, settlements, evaluations, solutions, .. } =
            run.statistics;
        let factorisations = run.statistics.factorisations + run.statistics.block_factorisations;
        further.push([
            run.name.into(),
            increments.into(),
            iterations.saturating_sub(run.accepted()).into(),
            cutbacks.into(),
            run.shortened.into(),
            settlements.into(),
            evaluations.into(),
            factorisations.into(),
            solutions.into(),
            run.peak.into(),
            run.work.into(),
        ]);
        for (number, (slip, iterations)) in run.increments.iter().enumerate() {
            let mut counts = [0_u64; CAUSES.len()];
            (0..iterations.len()).for_each(|k| counts[cause(iterations, k)] += 1);
            let [a, b, c, d, e, f, g, h, i] = counts.map(Cell::from);
            let relative = |iteration: Option<&Iteration>| iteration.map(|at| at.residual / at.scale);
            let [first, last] = [iterations.first(), iterations.last()].map(|at| Cell::from(relative(at)));
            let number = (number + 1).into();
            data.push([run.name.into(), number, (*slip).into(), a, b, c, d, e, f, g, h, i, first, last]);
        }
        let count = run.increments.len();
        for (slip, iterations) in SHOWN.iter().filter_map(|part| run.increments.get((part * count as f64) as usize)) {
            let shown = iterations.iter().enumerate().map(|(k, iteration)| {
                let mark = if k > 0 && iteration.begins_round { "/ " } else { "" };
                format!("{mark}{:.0e}", iteration.residual / iteration.scale)
            });
            residuals.push([run.name.into(), (*slip).into(), shown.collect::<Vec<_>>().join(", ").into()]);
        }
    }
    let stopped: Vec<String> = runs.iter().filter_map(|run| run.stopped.clone()).collect();
    Page {
        title: "Where Newton's iterations go",
        method: METHOD.into(),
        data,
        summaries: vec![
            ("Iterations of accepted increments by cause".into(), by_cause),
            ("Further counts".into(), further),
            ("Residuals of some increments".into(), residuals),
        ],
        notes: vec!["A stroke / stands where contact has settled or the far field shrunk.".into()],
        figures: Vec::new(),
        failed: (!stopped.is_empty()).then(|| stopped.join("; ")),
    }
}

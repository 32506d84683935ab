//! Curves of one fibre at angles and lengths from runs of a specimen, which are kept for later use.
//!
//! Each run's folder has its fingerprint as its name: cases and studies that need the same run share it, and a table goes
//! on where it was interrupted.

use super::execution::{Execution, RunOutcome, execute};
use super::{Member, RunSeries, Study, StudyRun};
use pullout_bridging::Curve;
use pullout_engine::CaseSource;
use pullout_report::directory::Lock;
use pullout_report::history::History;
use pullout_report::summary::{Status, Summary};
use pullout_run::bridging::{SimulationFindings, Simulations};
use pullout_run::number::significant;
use pullout_run::signals;

/// The part of the peak load to which the load must have fallen where a run stops early: from there on it is taken to fall
/// straight to 0 at extraction, with a warning.
const FALLEN: f64 = 0.5;
/// Digits of a fingerprint that name a folder.
const DIGITS: usize = 24;

/// Runs what is not there yet for a case of kind "bridging", and reads the curves. `finished` receives name, exit code, number done and total for each run.
///
/// # Errors
/// A case that is refused, a run that failed before its load had fallen to half the peak, by its angle and length.
pub fn curves_of_fibres(
    simulations: &Simulations,
    bridging: &CaseSource,
    execution: &Execution<'_>,
    finished: &(dyn Fn(&str, u8, usize, usize) + Sync),
) -> Result<(Vec<Curve>, SimulationFindings), String> {
    let study = study(simulations, bridging)?;
    std::fs::create_dir_all(&simulations.cache).map_err(|error| format!("{}: {error}", simulations.cache.display()))?;
    let lock = Lock::wait(&simulations.cache, || signals::received().is_some());
    let lock = lock.map_err(|error| error.to_string())?;
    let states = execute(&study, execution, &|run, code, count, of| {
        finished(&study.members[run.member].title, code, count, of);
    });
    drop(lock);
    let states = states.map_err(|error| error.to_string())?;
    if let Some(signal) = signals::received() {
        return Err(format!("interrupted by {}: runs of fibres that are done are kept", signal.words()));
    }
    let mut findings = SimulationFindings { runs: study.runs.len(), ..SimulationFindings::default() };
    let mut curves = Vec::new();
    for ((run, simulation), state) in study.runs.iter().zip(&simulations.runs).zip(states) {
        let folder = simulations.cache.join(&run.folder);
        let name = &study.members[run.member].title;
        let failed = |message: &str| format!("fibre at {name}: {message} ({})", folder.display());
        let summary = Summary::read(&folder.join("summary.json"));
        let summary = summary.map_err(|_| failed("it was not run; output.txt has the reason"))?;
        findings.kept += usize::from(state == RunOutcome::Kept);
        findings.cpu_time_s += summary.cpu_time_s.unwrap_or_default();
        let columns = ["slip", "load"];
        let history = History::of_run(&folder, |table| table.read_columns(&columns));
        let history = history.map_err(|error| failed(&error.to_string()))?;
        let [slips, loads] = columns.map(|name| history.column(name).unwrap_or_default());
        let mut curve = Curve {
            angle_deg: simulation.angle_deg,
            embedded: simulation.embedded,
            slip: Vec::new(),
            load: Vec::new(),
        };
        for (&slip, &load) in slips.iter().zip(loads) {
            // the grip of a run never goes back, except by rounding
            if slip >= 0.0 && curve.slip.last().is_none_or(|last| slip > *last) {
                curve.slip.push(slip);
                curve.load.push(load.max(0.0));
            }
        }
        if summary.status != Status::Done {
            let peak = curve.load.iter().copied().fold(0.0, f64::max);
            if curve.load.last().is_none_or(|&load| load >= FALLEN * peak) {
                return Err(failed(summary.message.as_deref().unwrap_or("it failed")));
            }
            findings.unfinished += 1;
        }
        curves.push(curve);
    }
    Ok((curves, findings))
}

/// The runs as a study of one series.
fn study(simulations: &Simulations, bridging: &CaseSource) -> Result<Study, String> {
    let (mut members, mut runs) = (Vec::new(), Vec::new());
    for (member, simulation) in simulations.runs.iter().enumerate() {
        let title = format!("{}°, {} mm", significant(simulation.angle_deg, 4), significant(simulation.embedded, 4));
        members.push(Member { label: member.to_string(), title, x: None });
        let (file, overrides) = (simulations.base.clone(), simulation.overrides.clone());
        let case = CaseSource { file, overrides, document: None, ..bridging.clone() };
        let libraries = match case.need() {
            Some(_) => None,
            None => Some(case.case().map_err(|errors| errors.to_string())?.libraries()),
        };
        let fingerprint = case.key(libraries);
        let folder = fingerprint.chars().take(DIGITS).collect::<String>().into();
        runs.push(StudyRun { member, case, fingerprint, folder, ..StudyRun::default() });
    }
    let series = vec![RunSeries { name: "fibres".into(), title: String::new() }];
    Ok(Study { file: simulations.base.clone(), members, series, runs, ..Study::default() })
}

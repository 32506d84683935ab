//! Runs of cases that the page asks for, their pictures, and verdicts on laws.

use crate::done::Done;
use crate::subject::{CALL_TIME_LIMIT, Subject};
use pullout_case::Case;
use pullout_check::conformance::Judgement;
use pullout_engine::{CaseSource, Error, Message, Outcome, REPLAY, Settings};
use pullout_fit::{CaseRequest, Free, Test, fit_case};
use pullout_report::history::History;
use pullout_report::plots::figure::Drawing;
use pullout_report::plots::{self, MeasuredCurve, Spec, selection};
use pullout_run::isolation::{self, Child};
use pullout_run::number;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Runs that are kept, so that ghosts are not run again.
const MOST_KEPT: usize = 32;
/// Largest number of rows of a run that is kept.
const LONGEST_KEPT: usize = 100_000;
/// Largest number of pages and kinds of requests for which the newest request ends the older one.
const MOST_PAGES: usize = 32;
/// States in which a verdict looks at a law.
const STATES: usize = 20;

/// What a page asks for.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Wanted {
    /// Page that sent the request: a newer request of the page ends the older one.
    page: String,
    /// Case.
    document: Value,
    /// Earlier settings that are drawn with it.
    #[serde(default)]
    ghosts: Vec<Ghost>,
    /// Measured curves.
    #[serde(default)]
    curves: Vec<MeasuredCurve>,
    /// Numbers that are fitted to them, as `pullout fit` takes them: "material.props.E=1e4:4e4".
    #[serde(default)]
    free: Vec<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Ghost {
    name: String,
    document: Value,
}

/// Checks of a library around the path of a case. Another process makes them and sends a [`Judgement`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Examination {
    /// Case.
    pub case: CaseSource,
    /// Library, as the case names it.
    pub plugin: String,
    /// Number of states in which the law is checked.
    pub states: usize,
}

impl isolation::Work for Examination {
    const NAME: &'static str = "examine";
}

/// Message of the process that examines a law.
#[derive(Deserialize)]
#[serde(untagged)]
enum ExaminationMessage {
    Judgement(Judgement),
    Message(Message),
}

/// Runs so far.
#[derive(Default)]
pub(crate) struct Work {
    kept: Mutex<Vec<(String, Arc<Done>)>>,
    pages: Mutex<Vec<(String, Arc<AtomicBool>)>>,
    /// Held by the check that goes on: of those that wait, the newest of a page is the next.
    checking: Mutex<()>,
}

impl Work {
    /// Runs the case and draws it over its ghosts.
    pub fn run(&self, subject: &Subject, wanted: &Wanted) -> Value {
        let stop = self.newest(("run", &wanted.page));
        let done = match self.done(subject, &wanted.document, &stop) {
            Ok(done) => done,
            Err(refusal) => return refusal,
        };
        let kind = |done: &Done| done.spec.as_ref().map(|spec| std::mem::discriminant(&spec.subject));
        let ghosts = wanted.ghosts.iter().filter_map(|ghost| {
            let earlier = self.done(subject, &ghost.document, &stop).ok()?;
            (kind(&earlier) == kind(&done)).then(|| (ghost.name.clone(), earlier))
        });
        let runs: Vec<(String, Arc<Done>)> = std::iter::once(("now".to_owned(), done.clone())).chain(ghosts).collect();
        let several = runs.len() > 1;
        let specs: Vec<(&str, &History, Spec)> = runs
            .iter()
            .enumerate()
            .filter_map(|(k, (name, run))| {
                let own = run.spec.clone()?;
                let title = if several { name.clone() } else { String::new() };
                let curves = match k {
                    0 => own.curves.into_iter().chain(wanted.curves.iter().cloned()).collect(),
                    _ => Vec::new(),
                };
                Some((name.as_str(), &run.history, Spec { title, curves, ..own }))
            })
            .collect();
        let drawn: Vec<plots::PlottedRun<'_>> =
            specs.iter().map(|(name, history, spec)| plots::PlottedRun { history, spec, name }).collect();
        let figures: Vec<Value> = selection::figures(&drawn)
            .iter()
            .filter_map(|figure| {
                let drawing: Drawing = figure.drawing().ok()?;
                let lines = figure.lines.iter().map(|line| json!({ "label": line.label, "points": line.points }));
                Some(json!({ "name": figure.name, "drawing": drawing, "lines": lines.collect::<Vec<_>>() }))
            })
            .collect();
        json!({
            "status": done.summary.status,
            "message": done.summary.message,
            "warnings": done.summary.warnings,
            "findings": done.summary.bridging,
            "compare": done.summary.compare,
            "increments": done.summary.increments,
            "iterations": done.summary.iterations,
            "replay": done.replay,
            "prints": done.prints,
            "milliseconds": done.milliseconds,
            "figures": figures,
        })
    }

    /// The rows of a case as CSV.
    pub fn csv(&self, subject: &Subject, wanted: &Wanted) -> Result<String, Value> {
        let done = self.done(subject, &wanted.document, &self.newest(("run", &wanted.page)))?;
        let columns = done.history.columns();
        let mut text = (columns.join(",") + "\n").into_bytes();
        for row in 0..done.history.rows() {
            let values = (0..columns.len()).filter_map(|column| done.history.column_at(column)?.get(row).copied());
            for (column, value) in values.enumerate() {
                text.extend(Some(b',').filter(|_| column > 0));
                number::push_exact(&mut text, value);
            }
            text.push(b'\n');
        }
        Ok(String::from_utf8_lossy(&text).into_owned())
    }

    /// Fits numbers of the case to the measured curves. A request without numbers only ends the fit that goes on.
    pub fn fit(&self, subject: &Subject, wanted: &Wanted) -> Value {
        let stop = self.newest(("fit", &wanted.page));
        let superseded = || json!({ "status": "superseded" });
        if wanted.free.is_empty() {
            return superseded();
        }
        let fitted = || {
            let source = self.source(subject, &wanted.document)?;
            let test = |curve: &MeasuredCurve| Test {
                source: source.clone(),
                data: curve.label.clone().into(),
                points: Some(curve.points.iter().map(|&(x, y)| [x, y]).collect()),
                curve: [curve.x.clone(), curve.y.clone()],
                weight: 1.0,
            };
            let tests: Vec<Test> = wanted.curves.iter().map(test).collect();
            if tests.is_empty() {
                return Err(refusal("", "there is no measured curve"));
            }
            let free = |text: &String| Free::parse(text).map_err(|message| refusal(text, &message));
            let free: Vec<Free> = wanted.free.iter().map(free).collect::<Result<_, Value>>()?;
            let (starts, max_runs) = (CaseRequest::STARTS as usize, CaseRequest::MOST_RUNS as usize);
            let request = CaseRequest { tests, free, starts, max_runs, stop: stop.clone() };
            Ok(fit_case(&request, &|_, _| {}).map_err(|messages| problems(&messages))?.summary(&request))
        };
        let answer = fitted().unwrap_or_else(|refusal| refusal);
        if stop.load(Ordering::Relaxed) { superseded() } else { answer }
    }

    /// What `pullout plugin check` says of the law around the path of the case.
    pub fn check(&self, subject: &Subject, wanted: &Wanted) -> Value {
        let stop = self.newest(("check", &wanted.page));
        let _one_at_a_time = self.checking.lock().unwrap_or_else(PoisonError::into_inner);
        if stop.load(Ordering::Relaxed) {
            return json!({ "status": "superseded" });
        }
        let case = match self.source(subject, &wanted.document) {
            Ok(case) => case,
            Err(refusal) => return refusal,
        };
        let plugin = wanted.document["material"]["plugin"].as_str().unwrap_or_default().to_owned();
        let checked = || -> io::Result<Value> {
            let mut child = Child::start(&Examination { case, plugin, states: STATES }, Some(&subject.folder))?;
            let mut answer = None;
            child.wait(&|| None, None, &mut |messages| {
                for message in messages {
                    answer = match message {
                        ExaminationMessage::Judgement(judgement) => serde_json::to_value(judgement).ok(),
                        ExaminationMessage::Message(Message::Refused(all)) => Some(problems(&all)),
                        ExaminationMessage::Message(_) => continue,
                    };
                }
            })?;
            let printed = || Ok(refusal("", String::from_utf8_lossy(&child.printed()?).trim_end()));
            answer.map_or_else(printed, Ok)
        };
        checked().unwrap_or_else(|error| refusal("", &error.to_string()))
    }

    /// The case as lines of an ABAQUS input file.
    pub fn abaqus(&self, subject: &Subject, wanted: &Wanted) -> Result<String, Value> {
        let prepared = self.source(subject, &wanted.document)?.read().map_err(|errors| problems(&errors.problems))?;
        let plugin = match prepared.case() {
            Some(Case::Path(program)) => Some(&program.plugin),
            _ => None,
        };
        if let Some((law, plugin)) = plugin.and_then(|plugin| Some((plugin.law.as_ref()?, plugin))) {
            return Ok(pullout_case::abaqus::with_props(law, &plugin.props));
        }
        let material = &wanted.document["material"];
        let numbers: Vec<String> =
            material["props"].as_array().into_iter().flatten().map(ToString::to_string).collect();
        let lines: Vec<String> = numbers.chunks(8).map(|line| line.join(", ")).collect();
        let mut text =
            format!("*MATERIAL, NAME=USER\n*USER MATERIAL, CONSTANTS={}\n{}\n", numbers.len(), lines.join("\n"));
        if let Some(depvar) = material["nstatv"].as_u64().filter(|count| *count > 0) {
            let _ = writeln!(text, "*DEPVAR\n{depvar},");
        }
        Ok(text)
    }

    /// Ends the older request of a page for the same; the flag of the newest.
    fn newest(&self, (what, page): (&str, &str)) -> Arc<AtomicBool> {
        let page = format!("{what} {page}");
        let mut pages = self.pages.lock().unwrap_or_else(PoisonError::into_inner);
        let stop = Arc::new(AtomicBool::new(false));
        if let Some(place) = pages.iter().position(|(name, _)| *name == page) {
            pages.remove(place).1.store(true, Ordering::Relaxed);
        } else if pages.len() == MOST_PAGES {
            pages.remove(0);
        }
        pages.push((page, stop.clone()));
        stop
    }

    /// Reading a case: of the lab's folder, and no file outside of it.
    fn source(&self, subject: &Subject, document: &Value) -> Result<CaseSource, Value> {
        let mut document = document.clone();
        let plugin = document["material"]["plugin"].as_str().unwrap_or_default().to_owned();
        if document["material"].is_object() && !subject.admits(&plugin) {
            return Err(refusal(
                "material.plugin",
                "neither a shipped law nor the library that the lab was opened with",
            ));
        }
        let is_own = subject.is_own(&plugin);
        if is_own && document["material"]["call_time_limit_s"].is_null() {
            document["material"]["call_time_limit_s"] = json!(CALL_TIME_LIMIT);
        }
        Ok(CaseSource { is_untrusted: !is_own, ..CaseSource::document(document, &subject.folder) })
    }

    fn done(&self, subject: &Subject, document: &Value, stop: &Arc<AtomicBool>) -> Result<Arc<Done>, Value> {
        if let Some(finished) = &subject.finished {
            return Ok(finished.clone());
        }
        let key = format!("{} {document}", subject.data_version());
        {
            let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(place) = kept.iter().position(|(name, _)| *name == key) {
                let found = kept.remove(place);
                kept.push(found);
                return Ok(kept[kept.len() - 1].1.clone());
            }
        }
        let start = Instant::now();
        let prepared = self.source(subject, document)?.read().map_err(|errors| problems(&errors.problems))?;
        let threads = std::thread::available_parallelism().ok();
        let settings = Settings { threads, stop: stop.clone(), ..Settings::default() };
        let outcome = prepared.run(settings).map_err(|error| match error {
            Error::Case(errors) => problems(&errors.problems),
            Error::Stopped => json!({ "status": "superseded" }),
            Error::System(error) => refusal("", &error.to_string()),
        })?;
        if stop.load(Ordering::Relaxed) {
            return Err(json!({ "status": "superseded" }));
        }
        let milliseconds = 1e3 * start.elapsed().as_secs_f64();
        let Outcome { history, summary, mut documents, prints, spec, .. } = outcome;
        let replay = documents.remove(REPLAY);
        let done = Arc::new(Done { history, summary, replay, prints, spec, milliseconds });
        if done.history.rows() <= LONGEST_KEPT {
            let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
            if kept.len() == MOST_KEPT {
                kept.remove(0);
            }
            kept.push((key, done.clone()));
        }
        Ok(done)
    }
}

fn problems<P: ToString>(problems: &[P]) -> Value {
    let all: Vec<Value> = problems.iter().map(|problem| json!({ "words": problem.to_string() })).collect();
    json!({ "status": "refused", "problems": all })
}

fn refusal(place: &str, message: &str) -> Value {
    let words = if place.is_empty() { message.to_owned() } else { format!("{place}: {message}") };
    json!({ "status": "refused", "problems": [{ "words": words }] })
}

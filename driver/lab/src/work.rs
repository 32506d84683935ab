//! Runs of cases that the page asks for, their pictures, and verdicts on laws.

use crate::subject::{CALL_TIME_LIMIT, Subject};
use pullout_case::{Case, CaseProblem};
use pullout_check::conformance::Judgement;
use pullout_engine::{Error, Message, Outcome, Settings, Source};
use pullout_report::history::History;
use pullout_report::plots::figure::Drawing;
use pullout_report::plots::{self, CaseKind, Curve, Spec, selection};
use pullout_report::summary::Summary;
use pullout_run::isolation::{self, Child};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Runs that are kept, so that ghosts are not run again.
const MOST_KEPT: usize = 32;
/// Rows of a run that is kept at most.
const LONGEST_KEPT: usize = 100_000;
/// Pages whose newest request ends their older one.
const MOST_PAGES: usize = 16;
/// States in which a verdict looks at a law.
const STATES: usize = 20;

/// What a page asks for.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Wanted {
    /// Page that asks: its newer request ends the older one.
    page: String,
    /// Case.
    document: Value,
    /// Earlier settings that are drawn with it.
    #[serde(default)]
    ghosts: Vec<Ghost>,
    /// Measured curves.
    #[serde(default)]
    curves: Vec<Curve>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Ghost {
    name: String,
    document: Value,
}

/// Checks of a library around the path of a case, which another process makes and tells as a [`Judgement`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Examination {
    /// Case.
    pub case: Source,
    /// Library, as the case names it.
    pub plugin: String,
    /// States in which the law is looked at.
    pub states: usize,
}

impl isolation::Work for Examination {
    const NAME: &'static str = "examine";
}

/// What the process tells that examines a law.
#[derive(Deserialize)]
#[serde(untagged)]
enum Told {
    Judgement(Judgement),
    Message(Message),
}

/// A run that is over.
struct Done {
    history: History,
    summary: Summary,
    replay: Option<Value>,
    prints: String,
    subject: CaseKind,
    units: BTreeMap<String, String>,
    law: String,
    milliseconds: f64,
}

/// Runs so far.
#[derive(Default)]
pub(crate) struct Work {
    kept: Mutex<Vec<(String, Arc<Done>)>>,
    pages: Mutex<Vec<(String, Arc<AtomicBool>)>>,
}

impl Work {
    /// Runs the case and draws it over its ghosts.
    pub fn run(&self, subject: &Subject, wanted: &Wanted) -> Value {
        let stop = self.newest(&wanted.page);
        let done = match self.done(subject, &wanted.document, &stop) {
            Ok(done) => done,
            Err(refusal) => return refusal,
        };
        let ghosts = wanted.ghosts.iter().filter_map(|ghost| {
            let earlier = self.done(subject, &ghost.document, &stop).ok()?;
            let is_alike = std::mem::discriminant(&earlier.subject) == std::mem::discriminant(&done.subject);
            is_alike.then(|| (ghost.name.clone(), earlier))
        });
        let runs: Vec<(String, Arc<Done>)> = std::iter::once(("now".to_owned(), done.clone())).chain(ghosts).collect();
        let several = runs.len() > 1;
        let specs: Vec<Spec> = runs
            .iter()
            .enumerate()
            .map(|(k, (name, run))| Spec {
                title: if several { name.clone() } else { String::new() },
                law: run.law.clone(),
                subject: run.subject.clone(),
                units: run.units.clone(),
                curves: if k == 0 { wanted.curves.clone() } else { Vec::new() },
                inputs: BTreeMap::new(),
            })
            .collect();
        let drawn: Vec<plots::Run<'_>> = runs
            .iter()
            .zip(&specs)
            .map(|((name, run), spec)| plots::Run { history: &run.history, spec, name })
            .collect();
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
        let done = self.done(subject, &wanted.document, &self.newest(&wanted.page))?;
        let columns = done.history.columns();
        let mut text = columns.join(",") + "\n";
        for row in 0..done.history.rows() {
            let values = (0..columns.len()).filter_map(|column| done.history.column_at(column)?.get(row).copied());
            for (column, value) in values.enumerate() {
                let _ = write!(text, "{}{value:?}", if column == 0 { "" } else { "," });
            }
            text.push('\n');
        }
        Ok(text)
    }

    /// What `pullout plugin check` says of the law around the path of the case.
    pub fn check(&self, subject: &Subject, wanted: &Wanted) -> Value {
        let case = match self.source(subject, &wanted.document) {
            Ok(case) => case,
            Err(refusal) => return refusal,
        };
        let plugin = wanted.document["material"]["plugin"].as_str().unwrap_or_default().to_owned();
        let checked = || -> std::io::Result<Value> {
            let mut child = Child::start(&Examination { case, plugin, states: STATES }, Some(&subject.folder))?;
            let mut answer = None;
            child.wait(&|| None, None, &mut |told| {
                for told in told {
                    answer = match told {
                        Told::Judgement(judgement) => serde_json::to_value(judgement).ok(),
                        Told::Message(Message::Refused(all)) => Some(problems(&all)),
                        Told::Message(_) => continue,
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

    /// Ends the older request of a page; the flag of the newest.
    fn newest(&self, page: &str) -> Arc<AtomicBool> {
        let mut pages = self.pages.lock().unwrap_or_else(PoisonError::into_inner);
        let stop = Arc::new(AtomicBool::new(false));
        if let Some(place) = pages.iter().position(|(name, _)| name == page) {
            pages.remove(place).1.store(true, Ordering::Relaxed);
        } else if pages.len() == MOST_PAGES {
            pages.remove(0);
        }
        pages.push((page.to_owned(), stop.clone()));
        stop
    }

    /// Reading a case: of the lab's folder, and no file outside of it.
    fn source(&self, subject: &Subject, document: &Value) -> Result<Source, Value> {
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
        Ok(Source { is_untrusted: !is_own, ..Source::document(document, &subject.folder) })
    }

    fn done(&self, subject: &Subject, document: &Value, stop: &Arc<AtomicBool>) -> Result<Arc<Done>, Value> {
        let key = document.to_string();
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
        let settings = Settings { stop: stop.clone(), ..Settings::default() };
        let outcome = prepared.run(settings).map_err(|error| match error {
            Error::Case(errors) => problems(&errors.problems),
            Error::Stopped => json!({ "status": "superseded" }),
            Error::System(error) => refusal("", &error.to_string()),
        })?;
        if stop.load(Ordering::Relaxed) {
            return Err(json!({ "status": "superseded" }));
        }
        let milliseconds = 1e3 * start.elapsed().as_secs_f64();
        let (law, subject, units) = match prepared.case() {
            Some(case) => {
                let spec = Spec::of(case, BTreeMap::new());
                (spec.law, spec.subject, spec.units)
            }
            None => (law_of(document), kind_of(document), BTreeMap::new()),
        };
        let Outcome { history, summary, replay, prints, .. } = outcome;
        let done = Arc::new(Done { history, summary, replay, prints, subject, units, law, milliseconds });
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

/// The law's name in a case that is read elsewhere.
fn law_of(document: &Value) -> String {
    let plugin = document["material"]["plugin"].as_str().unwrap_or("computed");
    umat_abi::host::library_name(plugin.as_ref())
}

/// The kind of a case that is read elsewhere, and of a point the strains that its steps name.
fn kind_of(document: &Value) -> CaseKind {
    match document["kind"].as_str() {
        Some("interface") => CaseKind::Interface,
        Some("pullout") => CaseKind::Pullout,
        Some("bridging") => CaseKind::Bridging,
        _ => {
            let names = ["e11", "e22", "e33", "g12", "g13", "g23"];
            let steps = document["steps"].as_array().into_iter().flatten();
            let named: Vec<&Value> = steps.map(|step| &step["target"]).collect();
            let is_driven = |name: &str| named.iter().any(|target| target[name].is_number());
            CaseKind::Point { controlled: (0..6).filter(|&k| is_driven(names[k])).collect() }
        }
    }
}

fn problems(problems: &[CaseProblem]) -> Value {
    let all: Vec<Value> = problems.iter().map(|problem| json!({ "words": problem.to_string() })).collect();
    json!({ "status": "refused", "problems": all })
}

fn refusal(place: &str, message: &str) -> Value {
    let words = if place.is_empty() { message.to_owned() } else { format!("{place}: {message}") };
    json!({ "status": "refused", "problems": [{ "words": words }] })
}

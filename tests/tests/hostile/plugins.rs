//! Plugins that misbehave in every way that `misbehaving.c` knows, called at material points, in elements, at contact points
//! and when they are loaded.

use crate::process::{MARK, Outcome, inventory, none_is_left, outcome, pullout};
use crate::suite::{Form, Tally, each};
use end_to_end_tests::{Tool, find, run as compile, workspace};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Attempts of the short form.
const SHORT: u64 = 60;
/// Young's modulus of the plugin, MPa.
pub const MODULUS: f64 = 1000.0;
/// Step and increment in which the fault is made: rows of those before are finished.
pub const PLACE: [u32; 2] = [2, 3];
/// The name of a fault that is made when the library is loaded.
const AT_LOADING: &str = "FAULT_AT_LOADING";
/// The library, and its source.
pub const LIBRARY: &str = "libmisbehaving.so";
const SOURCE: &str = "driver/tests/isolation/misbehaving.c";

/// Caller of the plugin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Host {
    /// A material point.
    Point,
    /// Elements of a plate.
    Element,
    /// A contact point.
    Uinter,
    /// A contact point under a prescribed pressure.
    Fric,
    /// The bond of a fibre.
    Bond,
    /// The loader.
    Constructor,
}

const HOSTS: [Host; 6] = [Host::Point, Host::Element, Host::Uinter, Host::Fric, Host::Bond, Host::Constructor];

/// Class of a run's outcome. The rows are always those of a sound run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Class {
    /// All is done.
    Harmless,
    /// All is done, with a warning in these words.
    Warned(&'static str),
    /// The run fails in the increment of the fault, with a message that names the plugin and has these words.
    Fails(&'static str),
    /// The library cannot be loaded, with these words.
    NotLoaded(&'static str),
    /// The run is done, or fails with a message.
    WithMessage,
}

use Class::{Fails, Harmless, NotLoaded, Warned, WithMessage};

/// Each fault by its name in the source, what comes of it in a call, and when the library is loaded.
const TABLE: [(&str, Class, Class); 82] = [
    ("NONE", Harmless, Harmless),
    ("EXIT_0", Fails("exit code 0"), NotLoaded("exit code 0")),
    ("EXIT_7", Fails("exit code 7"), NotLoaded("exit code 7")),
    ("ABORT", Fails("SIGABRT"), NotLoaded("SIGABRT")),
    ("WILD_POINTER", Fails("SIGSEGV"), NotLoaded("SIGSEGV")),
    ("ENDLESS_LOOP", Fails("did not return within 1 s"), NotLoaded("longer than 1 s")),
    ("STACK", Fails("stack"), NotLoaded("stack")),
    ("TRAP", Fails("SIGFPE"), NotLoaded("SIGFPE")),
    ("CLOSE_STDOUT", Fails(CLOSED), Harmless),
    ("PRINT", Fails("SIGABRT"), NotLoaded("SIGABRT")),
    ("HANG_AT_EXIT", Warned(BEHIND), Warned(BEHIND)),
    ("FORK_MANY", Harmless, Harmless),
    ("FORK_APART", Harmless, Harmless),
    ("FORK_AND_HANG", Fails("did not return within 1 s"), NotLoaded("longer than 1 s")),
    ("TRACE_ITSELF", Harmless, Harmless),
    ("TRACE_AND_CRASH", Fails("SIGSEGV"), NotLoaded("SIGSEGV")),
    ("KILL_GROUP", Fails("SIGKILL"), NotLoaded("SIGKILL")),
    // only the superuser may become another one, and may lift a limit again
    ("CHANGE_USER", WithMessage, WithMessage),
    ("FEW_DESCRIPTORS", WithMessage, WithMessage),
    ("SMALL_FILES", Fails("lowered the limit of the size of files"), WithMessage),
    ("QUICK_EXIT", Fails("exit code 0"), NotLoaded("exit code 0")),
    ("EXIT_AT_ONCE", Fails("exit code 0"), NotLoaded("exit code 0")),
    ("THREAD_EXIT", Fails(""), NotLoaded("")),
    ("KILL_ITSELF", Fails("SIGKILL"), NotLoaded("SIGKILL")),
    // without a handler of ours it is nobody's
    ("RAISE_SEGV", Fails("SIGSEGV"), Harmless),
    ("RAISE_XFSZ", Fails("SIGXFSZ"), NotLoaded("SIGXFSZ")),
    ("RAISE_ALARM", Fails("SIGALRM"), NotLoaded("SIGALRM")),
    ("STACK_SMASHED", Fails("SIG"), NotLoaded("SIG")),
    ("FREED_TWICE", Fails("SIGABRT"), NotLoaded("SIGABRT")),
    ("ABORT_AT_EXIT", Warned(BEHIND), Warned(BEHIND)),
    ("SEGV_AT_EXIT", Warned(BEHIND), Warned(BEHIND)),
    ("EXIT_5_AT_EXIT", Warned(BEHIND), Warned(BEHIND)),
    ("FORK_RETURNS", Warned(COPY), Warned(COPY)),
    ("FORK_EXITS", Harmless, Harmless),
    ("FORK_STAYS", Harmless, Harmless),
    ("CLOSE_AND_PRINT", Fails(CLOSED), Harmless),
    ("CLOSE_STDIN", Harmless, Harmless),
    ("CLOSE_STDERR", Fails(CLOSED), WithMessage),
    ("CLOSE_ALL", Fails(CLOSED), WithMessage),
    ("NO_DESCRIPTORS", WithMessage, WithMessage),
    ("CHANGE_FOLDER", Harmless, Harmless),
    ("UMASK", Harmless, Harmless),
    ("LOCALE", Harmless, Harmless),
    ("IGNORE_SIGNALS", Harmless, Harmless),
    ("PRINT_MUCH", Harmless, Harmless),
    ("FLUSH_TO_ZERO", Warned(MODES), Warned(MODES)),
    ("ROUND_UP", Warned(MODES), Warned(MODES)),
    ("LEAVE_TRAPS", Warned(MODES), Warned(MODES)),
    ("STRESS_BEHIND", Fails("which has"), Harmless),
    ("STRESS_FAR", Fails("which has"), Harmless),
    ("STRESS_FRONT", Fails("(0), which has"), Harmless),
    ("STATEV_BEHIND", Fails("writes STATEV(3), which has 2 elements"), Harmless),
    ("STATEV_FAR", Fails("writes STATEV(1003), which has 2 elements"), Harmless),
    ("STATEV_FRONT", Fails("wrote STATEV(0), which has 2 elements"), Harmless),
    ("TANGENT_BEHIND", Fails("writes DD"), Harmless),
    ("TANGENT_FAR", Fails("writes DD"), Harmless),
    ("PROPS_BEHIND", Fails("writes PROPS(5), which has 4 elements"), Harmless),
    ("ENERGY_BEHIND", Fails("(2), which has 1 elements"), Harmless),
    ("PNEWDT_BEHIND", Fails("PNEWDT(2), which has 1 elements"), Harmless),
    ("NAME_BEHIND", Fails("(81), which has 80 elements"), Harmless),
    ("WRITE_PROPS", Warned("writes PROPS, which"), Harmless),
    ("WRITE_NSTATV", Warned("writes NSTATV, which"), Harmless),
    ("WRITE_NPROPS", Warned("writes NPROPS, which"), Harmless),
    ("WRITE_COMPONENTS", Warned("writes N"), Harmless),
    ("WRITE_STRAIN", Warned("writes "), Harmless),
    ("WRITE_INCREMENT", Warned("writes D"), Harmless),
    ("WRITE_TIME", Warned("writes TIME, which"), Harmless),
    ("WRITE_DTIME", Warned("writes DTIME"), Harmless),
    ("WRITE_COORDS", Warned("writes COORDS, which"), Harmless),
    ("WRITE_NAME", Warned("writes C"), Harmless),
    ("WRITE_POINT", Warned("writes NO"), Harmless),
    ("WRITE_KINC", Warned("writes K"), Harmless),
    ("WRITE_TEMP", Warned("writes TEMP"), Harmless),
    ("NAN_STRESS", Fails("= NaN"), Harmless),
    ("INFINITE_STRESS", Fails("= inf"), Harmless),
    ("NAN_STATEV", Fails("returned STATEV(2) = NaN"), Harmless),
    ("INFINITE_STATEV", Fails("returned STATEV(2) = -inf"), Harmless),
    ("NAN_ENERGY", Fails("(1) = NaN"), Harmless),
    ("CUT_BACK", Fails("0.5"), Harmless),
    ("NAN_PNEWDT", Fails("PNEWDT = NaN"), Harmless),
    ("NEGATIVE_PNEWDT", Fails("PNEWDT = -"), Harmless),
    ("LM_7", Harmless, Harmless),
];
const CLOSED: &str = "it closed the standard output or another descriptor";
const BEHIND: &str = "exit handlers of its library";
const COPY: &str = "a copy of the process that a plugin made (fork)";
const MODES: &str = "floating-point modes";

/// Every fault with every host.
pub fn run(form: &Form) -> Tally {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(library) = built(folder.path()) else { return Tally::default() };
    let text = fs::read_to_string(workspace(SOURCE)).expect("the source");
    let faults = names(&text);
    assert_eq!(faults, TABLE.map(|(name, ..)| name), "the table has every fault of the source, in order");
    let sound: [OnceLock<Attempt>; HOSTS.len()] = Default::default();
    each(&form.numbers((HOSTS.len() * TABLE.len()) as u64, SHORT), |number, _| {
        let (fault, which) = (number as usize / HOSTS.len(), number as usize % HOSTS.len());
        let host = HOSTS[which];
        let (name, in_a_call, at_loading) = TABLE[fault];
        let class = match host {
            Host::Constructor => at_loading,
            Host::Fric if name == "LM_7" => Fails("LM = 7"),
            _ => in_a_call,
        };
        let sound = sound[which].get_or_init(|| Attempt::make(&library, host, 0).expect("a sound run"));
        let ended = Attempt::make(&library, host, fault);
        ended.and_then(|ended| ended.judge(class, sound)).map_err(|reason| format!("{name}, {host:?}: {reason}"))
    })
}

/// Builds the library into a folder, if there is a compiler.
pub fn built(folder: &Path) -> Option<PathBuf> {
    let library = folder.join(LIBRARY);
    let mut compiler = find(Tool::C)?;
    compiler.args(["-shared", "-fPIC", "-O1", "-w", "-I"]).arg(workspace("umat-abi/include"));
    compile(compiler.arg("-o").arg(&library).arg(workspace(SOURCE)).arg("-lm"));
    Some(library)
}

/// The number of a fault.
pub fn number_of(name: &str) -> usize {
    TABLE.iter().position(|(fault, ..)| *fault == name).expect("a fault")
}

/// The faults that the source knows.
fn names(source: &str) -> Vec<&str> {
    let (_, list) = source.split_once("enum fault {").expect("the list of faults");
    let (list, _) = list.split_once('}').expect("its end");
    let words = list.lines().filter(|line| !line.contains("/*")).flat_map(|line| line.split(','));
    words.map(str::trim).filter(|word| !word.is_empty()).collect()
}

fn case(host: Host, fault: usize) -> Value {
    let fault = if host == Host::Constructor { 0 } else { fault };
    let [step, increment] = PLACE;
    let mut law = json!({
        "plugin": format!("./{LIBRARY}"), "nstatv": 2, "props": [MODULUS, fault, step, increment], "call_time_limit_s": 1.0,
    });
    let elastic = |modulus: f64| json!({ "material": { "plugin": "linear_elastic", "props": { "E": modulus, "nu": 0.2 }, "call_time_limit_s": 1.0 } });
    let mut case = match host {
        Host::Point | Host::Constructor => json!({
            "kind": "point", "material": law, "mode": "3d",
            "steps": [
                { "increments": 5, "target": { "e11": 0.005 } },
                { "increments": 5, "target": { "e11": 0.01, "e22": -0.002 } },
            ],
        }),
        Host::Uinter | Host::Fric => {
            let (entry, normal) = if host == Host::Fric { ("fric", "p") } else { ("uinter", "gap") };
            law["entry"] = json!(entry);
            json!({
                "kind": "interface", "material": law,
                "steps": [
                    { "increments": 5, "target": { "slip": 0.1, normal: 0.3 } },
                    { "increments": 5, "target": { "slip": -0.2, normal: -0.1 } },
                ],
            })
        }
        Host::Element => json!({
            "kind": "pullout",
            "mesh": { "specimen": { "type": "plate_with_hole", "cells": 4, "element": "Q4" } },
            "parts": { "plate": { "material": law } },
            "grip": { "nodes": "top", "direction": [0, 1], "lateral": "free" },
            "steps": [ { "slip": 0.01, "increments": 4 }, { "slip": 0.5, "increments": 4 } ],
        }),
        Host::Bond => json!({
            "kind": "pullout",
            "mesh": { "specimen": {
                "type": "perpendicular_fibre", "embedded_elements": 6, "interface_size": 2.0, "largest_size": 6.0,
            } },
            "parts": { "fibre": elastic(210e3), "matrix": elastic(23.7e3) },
            "contact": { "law": law, "enforcement": "penalty" },
            "steps": [ { "slip": 0.001, "increments": 2 }, { "slip": 0.01, "increments": 4 } ],
        }),
    };
    case["title"] = json!("Misbehaving");
    case["output"] = json!({ "plots": false });
    case
}

/// A run and its traces.
struct Attempt {
    outcome: Outcome,
    history: Option<String>,
    summary: Option<Value>,
    /// Whether nothing outside the results was changed.
    is_contained: bool,
    /// The run of the replay case, if there is one.
    replay: Option<Outcome>,
}

impl Attempt {
    fn make(library: &Path, host: Host, fault: usize) -> Result<Self, String> {
        let desk = tempfile::tempdir().expect("a temporary folder");
        let folder = desk.path();
        fs::copy(library, folder.join(LIBRARY)).expect("a copy");
        fs::write(folder.join("case.json"), case(host, fault).to_string()).expect("a case");
        let results = folder.join("out");
        let before = inventory(folder, &results);
        let mut command = pullout(folder, ["run", "case.json", "--quiet", "--out", "out"]);
        if host == Host::Constructor {
            command.env(AT_LOADING, fault.to_string());
        }
        // what it starts has this in its environment
        command.env(MARK, folder);
        let ended = outcome(command)?;
        none_is_left(folder)?;
        let is_contained = inventory(folder, &results) == before && !Path::new("/out").exists();
        let replay = results.join("replay.json").exists().then(|| {
            let arguments = ["run", "out/replay.json", "--quiet", "--set", "output.plots=false", "--out", "again"];
            outcome(pullout(folder, arguments))
        });
        let read = |name: &str| fs::read_to_string(results.join(name)).ok();
        Ok(Self {
            outcome: ended,
            replay: replay.transpose()?,
            history: read("history.csv"),
            summary: read("summary.json").and_then(|text| serde_json::from_str(&text).ok()),
            is_contained,
        })
    }

    fn judge(&self, class: Class, sound: &Self) -> Result<(), String> {
        let stderr = &self.outcome.stderr;
        let code =
            self.outcome.judge(if class == WithMessage { &["misbehaving", "case.json"] } else { &["misbehaving"] })?;
        let wrong = |what: &str| Err(format!("{what}; exit {code}; stderr:\n{stderr}"));
        if !self.is_contained {
            return wrong("files outside the results changed");
        }
        let (codes, words): (&[i32], _) = match class {
            Harmless => (&[0], ""),
            Warned(words) => (&[0], words),
            Fails(words) => (&[1], words),
            NotLoaded(words) => (&[3], words),
            WithMessage => (&[0, 1], ""),
        };
        if !codes.contains(&code) {
            return wrong(&format!("not {class:?}"));
        }
        if !stderr.contains(words) {
            return wrong(&format!("'{words}' is not reported"));
        }
        if class == Harmless && *stderr != sound.outcome.stderr {
            return wrong("words about nothing");
        }
        let status = self.summary.as_ref().map_or("", |summary| summary["status"].as_str().unwrap_or_default());
        let [history, sound] = [self, sound].map(|ended| ended.history.as_deref().unwrap_or_default());
        match code {
            0 if history != sound => return wrong("other rows than of a sound run"),
            0 if status != "done" => return wrong("no summary of what was done"),
            0 => {}
            _ if status == "done" => return wrong("done, says the summary"),
            _ if !sound.starts_with(history) => return wrong("finished rows are not those of a sound run"),
            _ => {}
        }
        if let (Fails(words), Some(replay)) = (class, &self.replay) {
            let code = replay.judge(&["misbehaving"])?;
            if code != 1 || !replay.stderr.contains(words) {
                return wrong(&format!("the replay does not repeat it (exit {code}: {})", replay.stderr));
            }
        }
        if let Fails(_) = class {
            // a header, the initial state, a step and two increments at the least
            if history.lines().count() < 5 {
                return wrong("finished rows are gone");
            }
            if status != "failed" {
                return wrong("no summary of a failure");
            }
            if stderr.lines().filter(|line| line.contains("'misbehaving'")).count() != 1 {
                return wrong("not one message");
            }
        }
        Ok(())
    }
}

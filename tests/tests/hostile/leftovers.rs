//! Plugins that start processes, leave their session or trace themselves, below commands that come to their end or are killed:
//! soon nothing of them is alive.

use crate::plugins::{LIBRARY, MODULUS, PLACE, built, number_of};
use crate::process::{MARK, marked, none_is_left, pullout};
use crate::suite::{Form, Tally, each};
use fastrand::Rng;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};
use wait_timeout::ChildExt;

const FAULTS: [&str; 5] = ["FORK_MANY", "FORK_APART", "FORK_AND_HANG", "FORK_RETURNS", "TRACE_ITSELF"];
/// Whether a plugin with this fault starts programs that stay.
const STAY: [&str; 3] = ["FORK_MANY", "FORK_APART", "FORK_AND_HANG"];
/// What is started, and by which supervisors a plugin is called: its own, one below a study, one of a batch of a sweep.
const COMMANDS: [&[&str]; 4] = [
    &["run", "--quiet", "case.json"],
    &["study", "--quiet", "study.json"],
    &["sweep", "work", "sweep"],
    &["plugin", "check", "--states=2", "--case=case.json", LIBRARY],
];
/// Longest time until a plugin has done what it does, or its command has ended.
const PATIENCE: Duration = Duration::from_secs(20);
/// Increments of a run that is killed.
const MANY: u32 = 10_000_000;

pub fn run(form: &Form) -> Tally {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(library) = built(folder.path()) else { return Tally::default() };
    let ways: Vec<(&[&str], bool)> =
        COMMANDS.map(|command| (command, true)).into_iter().chain([(COMMANDS[0], false)]).collect();
    let all = (ways.len() * FAULTS.len()) as u64;
    each(&form.numbers(all, all), |number, random| {
        let ((command, is_killed), fault) =
            (ways[number as usize / FAULTS.len()], FAULTS[number as usize % FAULTS.len()]);
        attempt(&library, command, fault, is_killed, random)
            .map_err(|reason| format!("{fault}, {command:?}, killed: {is_killed}: {reason}"))
    })
}

fn case(fault: &str, is_killed: bool) -> Value {
    let [step, increment] = PLACE;
    let increments = if is_killed { MANY } else { 5 };
    json!({
        "kind": "point", "mode": "3d", "output": { "plots": false },
        "material": {
            "plugin": format!("./{LIBRARY}"), "nstatv": 2, "props": [MODULUS, number_of(fault), step, increment],
            "call_time_limit_s": if is_killed { 30.0 } else { 0.5 },
        },
        "steps": [
            { "increments": 5, "target": { "e11": 0.005 } },
            { "increments": increments, "target": { "e11": 0.01, "e22": -0.002 } },
        ],
    })
}

fn attempt(library: &Path, line: &[&str], fault: &str, is_killed: bool, random: &mut Rng) -> Result<(), String> {
    let desk = tempfile::tempdir().expect("a temporary folder");
    let folder = desk.path();
    let write = |name: &str, content: Value| fs::write(folder.join(name), content.to_string()).expect("a file");
    fs::copy(library, folder.join(LIBRARY)).expect("a copy");
    write("case.json", case(fault, is_killed));
    write("study.json", json!({ "kind": "study", "base": "case.json", "members": [{ "label": "a" }] }));
    write(
        "sweep.json",
        json!({ "kind": "sweep", "base": "case.json", "parameters": { "steps.0.target.e11": [5e-3, 6e-3] } }),
    );
    let planned = pullout(folder, ["sweep", "plan", "sweep.json", "--out", "sweep"]).output();
    planned.ok().filter(|ended| ended.status.success() || line[0] != "sweep").ok_or("no sweep is planned")?;
    let mut command = pullout(folder, line);
    let mut child = command.env(MARK, folder).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program");
    let start = Instant::now();
    let mut has_begun = false;
    let ended = loop {
        match child.wait_timeout(Duration::from_millis(10)).map_err(|error| error.to_string())? {
            Some(status) => break Some(status),
            None if start.elapsed() > PATIENCE => break None,
            None => {}
        }
        let runs = marked(folder);
        let is_sleep = |process: &&std::ffi::OsString| {
            fs::read(Path::new("/proc").join(process).join("comm")).is_ok_and(|name| name == b"sleep\n")
        };
        has_begun |= if STAY.contains(&fault) { runs.iter().any(|it| is_sleep(&it)) } else { runs.len() > 2 };
        if is_killed && has_begun {
            std::thread::sleep(Duration::from_secs_f64(0.1 * random.f64()));
            break None;
        }
    };
    if ended.is_none() {
        // SIGKILL: nothing can be passed on
        child.kill().and_then(|()| child.wait()).map_err(|error| error.to_string())?;
    }
    none_is_left(folder)?;
    match ended {
        None if !is_killed => Err(format!("no end in {} s", PATIENCE.as_secs())),
        _ if is_killed && !has_begun => Err("the plugin has not begun".into()),
        _ => Ok(()),
    }
}

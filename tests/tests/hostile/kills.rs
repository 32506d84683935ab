//! Runs that are killed at any moment. One with checkpoints goes on to the bits of the run that was not disturbed; one over
//! old results has lost no line of either when the next begins.

use crate::process::{self, outcome, pullout};
use crate::specimen::DAMAGING;
use crate::suite::{Form, Tally, each};
use fastrand::Rng;
use serde_json::json;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

const ALL: u64 = 100;
const SHORT: u64 = 8;
/// One in so many is a run over old results.
const OVER: u64 = 4;

pub fn run(form: &Form) -> Tally {
    let desk = tempfile::tempdir().expect("a temporary folder");
    let whole = desk.path().join("whole");
    let start = Instant::now();
    done(pullout(desk.path(), DAMAGING.run(&whole))).expect("the run that is not disturbed");
    let time = start.elapsed();
    let expected = results(&whole);
    let case = desk.path().join("point.json");
    let point = json!({
        "kind": "point", "mode": "3d", "material": { "plugin": "concrete_damage" }, "output": { "plots": false },
        "steps": [{ "increments": 1_000_000, "target": { "e11": 1e-3 } }]
    });
    fs::write(&case, point.to_string()).expect("a case");
    each(&form.numbers(ALL, SHORT), |number, random| {
        let out = desk.path().join(number.to_string());
        let judged = if number.is_multiple_of(OVER) {
            over_old_results(desk.path(), &case, &out, random)
        } else {
            goes_on(desk.path(), &out, time, &expected, random)
        };
        fs::remove_dir_all(&out).map_err(|error| error.to_string()).and(judged)
    })
}

fn done(command: Command) -> Result<(), String> {
    match outcome(command)?.judge(&["point.json", DAMAGING.name()])? {
        0 => Ok(()),
        code => Err(format!("exit {code}")),
    }
}

/// Kills a run and its restarts at any time, then lets one come to its end.
fn goes_on(
    desk: &Path,
    out: &Path,
    time: Duration,
    expected: &BTreeMap<PathBuf, Vec<u8>>,
    random: &mut Rng,
) -> Result<(), String> {
    for _ in 0..random.usize(1..3) {
        let has_checkpoint = out.join(process::CHECKPOINT).exists();
        let arguments = if has_checkpoint { DAMAGING.restart(out) } else { DAMAGING.run(out) };
        killed(pullout(desk, arguments), time.mul_f64(random.f64()));
    }
    let has_checkpoint = out.join(process::CHECKPOINT).exists();
    done(pullout(desk, if has_checkpoint { DAMAGING.restart(out) } else { DAMAGING.run(out) }))?;
    let found = results(out);
    let differs = |name: &&PathBuf| found.get(*name) != expected.get(*name);
    match expected.keys().chain(found.keys()).find(differs) {
        Some(name) => Err(format!("{} differs from that of the run that was not disturbed", name.display())),
        None => Ok(()),
    }
}

fn killed(mut command: Command, after: Duration) {
    let mut child = command.spawn().expect("the program starts");
    std::thread::sleep(after);
    // SIGKILL; it may be over
    let _ = child.kill();
    child.wait().expect("a child");
}

/// Kills a run over finished results. All old rows must be there, and new rows must be complete.
fn over_old_results(desk: &Path, case: &Path, out: &Path, random: &mut Rng) -> Result<(), String> {
    let run = |increments: &str| {
        let steps = format!("steps.0.increments={increments}");
        let words = ["run", "--quiet", "--set", &steps, "--out"].map(Path::new);
        pullout(desk, words.into_iter().chain([out, case]))
    };
    done(run("300"))?;
    let old = fs::read(out.join(process::HISTORY)).expect("a history");
    killed(run("1000000"), Duration::from_secs_f64(0.3 * random.f64()));
    let places = [out.join(process::HISTORY), out.join("previous").join(process::HISTORY)];
    let present: Vec<Vec<u8>> = places.iter().filter_map(|place| fs::read(place).ok()).collect();
    if !present.contains(&old) {
        return Err("the old rows are lost".into());
    }
    for rows in present {
        let lines = rows.iter().filter(|byte| **byte == b'\n').count();
        if rows.last() != Some(&b'\n') || lines == 0 {
            return Err("a row is cut off".into());
        }
    }
    done(run("5"))?;
    let rows = fs::read(out.join(process::HISTORY)).expect("a history");
    if rows.iter().filter(|byte| **byte == b'\n').count() != 7 || out.join("previous").exists() {
        return Err("the next run does not stand alone".into());
    }
    Ok(())
}

/// Returns the files that must be the same to the last bit.
fn results(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let names = process::inventory(folder, Path::new("")).into_iter().map(|(path, ..)| path);
    let is_result =
        |path: &PathBuf| path.extension().is_some_and(|kind| kind == "csv" || kind == "vtu" || kind == "pvd");
    let content =
        |path: PathBuf| (path.strip_prefix(folder).expect("within").to_owned(), fs::read(&path).expect("a file"));
    names.filter(is_result).map(content).collect()
}

//! Folders of sweeps with a bit flipped in a part of the rows, in a file that a case names, or with a plan that leads elsewhere:
//! refused by name, and never other rows.

use crate::process::{self, outcome, pullout};
use crate::suite::{Form, Tally, each};
use fastrand::Rng;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

const ALL: u64 = 200;
const SHORT: u64 = 24;
/// Names that lead out of the folder, or are none of a folder that was planned.
const FORGED: [&str; 6] = ["..", "../..", "/etc", "../../job", "", "0123456789abcdef"];

pub fn run(form: &Form) -> Tally {
    let desk = tempfile::tempdir().expect("a temporary folder");
    let folder = desk.path();
    fs::write(folder.join("path.csv"), "time,slip\n1,0.1\n2,0.2\n").expect("a table");
    let sweep = json!({
        "kind": "sweep",
        "base": { "kind": "interface", "material": { "plugin": "bond_slip" }, "steps": [{ "table": "path.csv" }] },
        "parameters": { "material.props.k_e": [700, 800, 900, 1000] }, "curves": ["tau"],
    });
    fs::write(folder.join("sweep.json"), sweep.to_string()).expect("a sweep");
    for line in [&["sweep", "plan", "sweep.json", "--out", "whole"][..], &["sweep", "work", "whole", "--in-process"]] {
        let ended = outcome(pullout(folder, line)).expect("an end");
        assert_eq!(ended.status.code(), Some(0), "{}", ended.stderr);
    }
    let rows = collected(folder, "whole").expect("rows").1;
    each(&form.numbers(ALL, SHORT), |number, random| {
        let name = number.to_string();
        process::copy(&folder.join("whole"), &folder.join(&name));
        let judged = attempt(folder, &name, number, random, &rows);
        fs::remove_dir_all(folder.join(&name)).map_err(|error| error.to_string()).and(judged)
    })
}

/// Exit code and rows.
fn collected(folder: &Path, name: &str) -> Result<(i32, String), String> {
    let ended = outcome(pullout(folder, ["sweep", "collect", name]))?;
    Ok((ended.judge(&[name])?, ended.stdout))
}

fn attempt(folder: &Path, name: &str, number: u64, random: &mut Rng, rows: &str) -> Result<(), String> {
    let own = folder.join(name);
    match number % 4 {
        0 => {
            let plan = own.join("sweep.json");
            let mut sweep: Value = serde_json::from_slice(&fs::read(&plan).expect("a plan")).expect("JSON");
            sweep["bundles"] = json!([FORGED[random.usize(..FORGED.len())]]);
            fs::write(&plan, sweep.to_string()).expect("a plan");
            refused(folder, name, "work")
        }
        1 => {
            flip(&only(&own.join("files")).join("path.csv"), random);
            refused(folder, name, "work")
        }
        _ => {
            flip(&only(&own.join("parts")), random);
            match collected(folder, name)? {
                (2, _) => refused(folder, name, "work"),
                (0, again) if again == rows => Err("a flipped bit is not seen".into()),
                (code, again) => Err(format!("exit {code}, other rows: {again}")),
            }
        }
    }
}

fn refused(folder: &Path, name: &str, verb: &str) -> Result<(), String> {
    match outcome(pullout(folder, ["sweep", verb, name]))?.judge(&[name])? {
        2 => Ok(()),
        code => Err(format!("sweep {verb}: exit {code}")),
    }
}

/// One of the entries of a folder.
fn only(folder: &Path) -> PathBuf {
    fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path()).next().expect("an entry")
}

fn flip(file: &Path, random: &mut Rng) {
    let mut content = fs::read(file).expect("a file");
    let at = random.usize(..content.len());
    content[at] ^= 1 << random.u8(..8);
    fs::write(file, content).expect("a file");
}

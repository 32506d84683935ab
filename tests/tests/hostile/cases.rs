//! The shipped cases with keys left out, given twice, of another type or order, with numbers at the ends of their scales,
//! with texts and arrays of all sorts, and with damaged bytes.

use crate::process::{self, inventory, outcome, pullout};
use crate::suite::{Form, Tally, any_damage, each};
use end_to_end_tests::fuzz::{WILD_WORDS, damaged};
use end_to_end_tests::workspace;
use fastrand::Rng;
use serde_json::{Map, Value, json};
use std::fs;
use std::path::{Path, PathBuf};

const ALL: u64 = 1000;
const SHORT: u64 = 120;
/// One in so many is run by a process as well.
const RUN: u64 = 10;
/// Marks a text that is written into the file without quotes.
const RAW: &str = "@raw@";
/// Marks a key that is written as the one before it.
const TWICE: &str = "@twice@";

pub fn run(form: &Form) -> Tally {
    let desk = tempfile::tempdir().expect("a temporary folder");
    process::copy(&workspace("cases"), &desk.path().join("cases"));
    let mut files = Vec::new();
    collect(&desk.path().join("cases"), &mut files);
    files.sort();
    assert!(files.len() > 50, "{} cases", files.len());
    let out = desk.path().join("out");
    let before = inventory(desk.path(), &out);
    let mut tally = each(&form.numbers(ALL, SHORT), |number, random| {
        let file = &files[random.usize(..files.len())];
        let text = mutated(&fs::read(file).expect("a case"), number, random);
        let hostile = file.with_file_name(format!("hostile-{number}.json"));
        fs::write(&hostile, text).expect("a case");
        let judged = judge(&hostile, desk.path(), number);
        fs::remove_file(&hostile).expect("nobody else removes it");
        judged
    });
    if inventory(desk.path(), &out) != before {
        tally.broken.push("files outside the results were changed".into());
    }
    tally
}

fn judge(hostile: &Path, desk: &Path, number: u64) -> Result<(), String> {
    let errors = pullout_case::read(hostile, &[], &[]).err();
    if let Some(errors) = &errors {
        let text = errors.to_string();
        let names = text.lines().all(|line| line.contains("hostile-") || line.starts_with(' '));
        if text.is_empty() || !names || !matches!(errors.exit_code(), 2 | 3) {
            return Err(format!("refused without a name: {text}"));
        }
    }
    if !number.is_multiple_of(RUN) {
        return Ok(());
    }
    let out = desk.join("out").join(number.to_string());
    let case = hostile.to_str().expect("UTF-8");
    let name = hostile.file_name().and_then(|name| name.to_str()).expect("UTF-8");
    let limits = ["--set", "output.plots=false", "--threads", "1"];
    let command = pullout(
        desk,
        ["run", case, "--out"].map(Path::new).into_iter().chain([out.as_path()]).chain(limits.map(Path::new)),
    );
    let code = outcome(command)?.judge(&[name])?;
    let _ = fs::remove_dir_all(&out);
    // `--set` may add a problem or take one away, no more
    match errors {
        None if matches!(code, 2 | 3) => Err(format!("is read without an error and then refused with exit {code}")),
        _ => Ok(()),
    }
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for path in fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "json") {
            files.push(path);
        }
    }
}

/// A case with one to three changes.
fn mutated(case: &[u8], number: u64, random: &mut Rng) -> Vec<u8> {
    if random.u8(..8) == 0 {
        return damaged(case, &any_damage(number));
    }
    let mut document: Value = serde_json::from_slice(case).expect("a shipped case");
    for _ in 0..random.usize(1..4) {
        change(&mut document, random);
    }
    let text = document.to_string();
    let text = text.replace(&format!("\"{RAW}"), "").replace(&format!("{RAW}\""), "").replace(TWICE, "");
    text.into_bytes()
}

/// Changes one place of a document.
fn change(document: &mut Value, random: &mut Rng) {
    let mut places = Vec::new();
    pointers(document, String::new(), &mut places);
    let place = &places[random.usize(..places.len())];
    let Some(value) = document.pointer_mut(place) else { return };
    match value {
        Value::Object(members) if random.bool() && !members.is_empty() => change_members(members, random),
        Value::Array(entries) if random.bool() => change_entries(entries, random),
        Value::Number(_) if random.u8(..4) > 0 => *value = wild_number(random),
        Value::String(_) if random.u8(..4) > 0 => *value = wild_text(random).into(),
        _ => *value = of_another_type(value, random),
    }
}

fn pointers(value: &Value, here: String, all: &mut Vec<String>) {
    let step = |key: &str| format!("{here}/{}", key.replace('~', "~0").replace('/', "~1"));
    match value {
        Value::Object(members) => members.iter().for_each(|(key, member)| pointers(member, step(key), all)),
        // of a long table a few rows
        Value::Array(entries) => {
            entries.iter().take(20).enumerate().for_each(|(k, entry)| pointers(entry, step(&k.to_string()), all));
        }
        _ => {}
    }
    all.push(here);
}

fn change_members(members: &mut Map<String, Value>, random: &mut Rng) {
    let keys: Vec<String> = members.keys().cloned().collect();
    let key = &keys[random.usize(..keys.len())];
    match random.u8(..6) {
        0 => drop(members.shift_remove(key)),
        1 => {
            let again = if random.bool() { members[key].clone() } else { wild_number(random) };
            members.insert(format!("{TWICE}{key}"), again);
        }
        2 => {
            let mut entries: Vec<(String, Value)> = std::mem::take(members).into_iter().collect();
            random.shuffle(&mut entries);
            members.extend(entries);
        }
        3 => {
            let value = members.shift_remove(key).unwrap_or_default();
            let renamed = if random.bool() { format!("{key}x") } else { wild_text(random) };
            members.insert(renamed, value);
        }
        4 => drop(members.insert(wild_text(random), wild_number(random))),
        _ => members.extend((0..random.usize(1..3000)).map(|k| (format!("unknown{k}"), k.into()))),
    }
}

fn change_entries(entries: &mut Vec<Value>, random: &mut Rng) {
    match random.u8(..6) {
        0 => entries.clear(),
        1 if !entries.is_empty() => drop(entries.remove(random.usize(..entries.len()))),
        2 => entries.push(Value::Array(Vec::new())),
        3 => entries.push(wild_number(random)),
        4 if !entries.is_empty() => {
            let entry = entries[random.usize(..entries.len())].clone();
            entries.extend(std::iter::repeat_n(entry, random.usize(1..200)));
        }
        _ => entries.extend(std::iter::repeat_n(Value::from(1), random.usize(1..100_000))),
    }
}

fn wild_number(random: &mut Rng) -> Value {
    const NUMBERS: [f64; 12] = [0.0, -1.0, 1e308, -1e308, 1e-308, 5e-324, 0.5, 1e-12, 1e12, 3.0, 100_000_000.0, 1e19];
    match random.u8(..3) {
        0 => format!("{RAW}{}{RAW}", WILD_WORDS[random.usize(..WILD_WORDS.len())]).into(),
        1 => random.i32(-3..40).into(),
        _ => NUMBERS[random.usize(..NUMBERS.len())].into(),
    }
}

fn wild_text(random: &mut Rng) -> String {
    const TEXTS: [&str; 14] = [
        "",
        " ",
        "NaN",
        "1e5",
        "hold",
        "../../../../../../etc/passwd",
        "/dev/zero",
        "/",
        ".",
        "\u{1b}[2J\u{1b}]0;title\u{7}",
        "\r\n\t\u{0}\u{8}",
        "τ_res → ∞ \u{202e}tfel\u{200b}",
        "🧱🧱🧱",
        "$.steps[0]",
    ];
    match random.u8(..5) {
        0 => "long".repeat(random.usize(1..30_000)),
        1 => (0..random.usize(1..10)).map(|_| random.char(..)).collect(),
        _ => TEXTS[random.usize(..TEXTS.len())].into(),
    }
}

fn of_another_type(value: &Value, random: &mut Rng) -> Value {
    match random.u8(..8) {
        0 => Value::Null,
        1 => random.bool().into(),
        2 => wild_number(random),
        3 => wild_text(random).into(),
        4 => json!([value]),
        5 => json!({ "value": value }),
        6 => json!([]),
        _ => json!({}),
    }
}

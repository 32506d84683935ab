//! Meshes of Gmsh with lines left out, given twice, exchanged, with wrong counts and tags, turned and degenerate elements,
//! numbers that are none, and damaged bytes.

use crate::process::{outcome, pullout};
use crate::suite::{Form, Tally, any_damage, each};
use end_to_end_tests::fuzz::{WILD_WORDS, damaged};
use end_to_end_tests::workspace;
use fastrand::Rng;
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};

const ALL: u64 = 300;
const SHORT: u64 = 60;
/// One in so many is run by a process as well.
const RUN: u64 = 6;
const FILES: [&str; 6] = [
    "quadrilaterals_2.2_text",
    "quadrilaterals_4.1_text",
    "quadrilaterals_2.2_binary",
    "quadrilaterals_4.1_binary",
    "triangles_2.2_binary",
    "triangles_4.1_binary",
];

pub fn run(form: &Form) -> Tally {
    let desk = tempfile::tempdir().expect("a temporary folder");
    let folder = workspace("fe-core/src/mesh/gmsh/data");
    let files = FILES.map(|name| fs::read(folder.join(format!("{name}.msh"))).expect("a mesh"));
    files.iter().zip(FILES).for_each(|(file, name)| {
        let case = write(desk.path(), name, file);
        assert_eq!(process(&case, desk.path()), Ok(0), "{name}");
    });
    each(&form.numbers(ALL, SHORT), |number, random| {
        // two thirds are text
        let file = &files[if random.u8(..3) > 0 { random.usize(..2) } else { random.usize(2..files.len()) }];
        let case = write(desk.path(), &number.to_string(), &mutated(file, number, random));
        judge(&case, desk.path(), number)
    })
}

/// Writes a mesh and a case that pulls at it.
fn write(desk: &Path, name: &str, mesh: &[u8]) -> PathBuf {
    let file = format!("hostile-{name}.msh");
    fs::write(desk.join(&file), mesh).expect("a mesh");
    let elastic = json!({ "material": { "plugin": "linear_elastic", "props": { "E": 1000, "nu": 0.2 } } });
    let case = json!({
        "kind": "pullout",
        "mesh": { "file": file },
        "parts": { "matrix": elastic, "the fibre": elastic },
        "grip": { "direction": "y", "nodes": "grip" },
        "supports": { "bottom": {} },
        "output": { "plots": false },
        "steps": [{ "slip": 0.001, "increments": 1 }],
    });
    let path = desk.join(format!("hostile-{name}.json"));
    fs::write(&path, case.to_string()).expect("a case");
    path
}

/// Runs a case; its exit code.
fn process(case: &Path, desk: &Path) -> Result<i32, String> {
    let out = case.with_extension("");
    let words = ["run", "--quiet", "--threads", "1", "--out"].map(Path::new);
    outcome(pullout(desk, words.into_iter().chain([out.as_path(), case])))?.judge(&["hostile-"])
}

fn judge(case: &Path, desk: &Path, number: u64) -> Result<(), String> {
    if let Err(errors) = pullout_case::read(case, &[], &[]) {
        let text = errors.to_string();
        if !text.lines().all(|line| line.contains("hostile-")) || text.len() > 100_000 {
            return Err(format!("refused in strange words: {text}"));
        }
    }
    if !number.is_multiple_of(RUN) {
        return Ok(());
    }
    process(case, desk).map(drop)
}

fn mutated(file: &[u8], number: u64, random: &mut Rng) -> Vec<u8> {
    let Ok(text) = std::str::from_utf8(file) else { return damaged(file, &any_damage(number)) };
    if random.u8(..6) == 0 {
        return damaged(file, &any_damage(number));
    }
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for _ in 0..random.usize(1..4) {
        change(&mut lines, random);
    }
    lines.join("\n").into_bytes()
}

fn change(lines: &mut Vec<String>, random: &mut Rng) {
    let line = random.usize(..lines.len());
    let other = random.usize(..lines.len());
    match random.u8(..8) {
        0 => lines.truncate(line.max(1)),
        1 if lines.len() > 1 => drop(lines.remove(line)),
        2 => lines.insert(line, lines[other].clone()),
        3 => lines.swap(line, other),
        4 => {
            let mut section = lines.split_off(line);
            random.shuffle(&mut section);
            lines.append(&mut section);
        }
        _ => {
            let mut words: Vec<String> = lines[line].split_whitespace().map(str::to_owned).collect();
            if words.is_empty() {
                return;
            }
            let word = random.usize(..words.len());
            match random.u8(..4) {
                // an element that is turned, or has a node twice
                0 => words.reverse(),
                1 => words[word] = words[random.usize(..words.len())].clone(),
                2 => words[word] = format!("-{}", words[word]),
                _ => words[word] = WILD_WORDS[random.usize(..WILD_WORDS.len())].into(),
            }
            lines[line] = words.join(" ");
        }
    }
}

//! CalculiX: its stresses are those of our laws along its strains. A `ccx` with external behaviours is rare (Debian's has
//! none), and none is required; any `ccx` shows that decks, strains and stresses are understood.

use super::{Installation, example, history};
use end_to_end_tests::{notice, worst};
use std::path::Path;
use std::process::Command;

/// Seven digits are printed.
const PRINTED: f64 = 2e-6;
/// Along a path of printed strains: what a damage law makes of their last digit.
const ALONG_THE_PATH: f64 = 1e-4;
/// Increments of the deck; a linear job is done in one.
const INCREMENTS: usize = 40;
const NAME: &str = "@ABAQUS_CONCRETEDAMAGE_UMAT";

/// `ccx` of the PATH in a folder; `None` where there is none.
fn ccx(folder: &Path, job: &str) -> Option<String> {
    let mut command = Command::new("ccx");
    // where it looks for behaviours
    command.current_dir(folder).env("LD_LIBRARY_PATH", folder).env("OMP_NUM_THREADS", "1").arg(job);
    match command.output() {
        Ok(output) => Some(String::from_utf8_lossy(&output.stdout).into_owned()),
        Err(_) => {
            notice("there is no ccx on the PATH");
            None
        }
    }
}

fn deck() -> String {
    std::fs::read_to_string(example("calculix/one_element.inp")).expect("the shipped deck")
}

/// The first integration point's rows of a table in `job.dat`, one per increment.
fn rows(folder: &Path, job: &str, table: &str) -> Vec<[f64; 6]> {
    let text = std::fs::read_to_string(folder.join(format!("{job}.dat"))).expect("printed results");
    let mut rows = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if !line.trim_start().starts_with(&format!("{table} (elem, integ.pnt.")) {
            continue;
        }
        let first = lines.find(|line| !line.trim().is_empty()).expect("a row of the table");
        let words: Vec<f64> = first.split_whitespace().map(|word| word.parse().expect("a number")).collect();
        assert_eq!(words[..2], [1.0, 1.0], "element and point: {first}");
        rows.push(words[2..].try_into().expect("six components"));
    }
    rows
}

/// The largest difference between CalculiX's stresses and those of our law along its strains, over the largest stress.
fn apart(installation: &Installation, folder: &Path, job: &str, increments: usize, material: &str) -> f64 {
    let (strains, stresses) = (rows(folder, job, "strains"), rows(folder, job, "stresses"));
    assert_eq!((strains.len(), stresses.len()), (increments, increments));
    // 11, 22, 33, 12, 13, 23, of a tensor
    let mut table = "e11,e22,e33,g12,g13,g23\n".to_owned();
    for [e11, e22, e33, e12, e13, e23] in &strains {
        table += &format!("{e11:e},{e22:e},{e33:e},{:e},{:e},{:e}\n", 2.0 * e12, 2.0 * e13, 2.0 * e23);
    }
    std::fs::write(folder.join("strains.csv"), table).expect("a file");
    let case =
        format!(r#"{{"kind": "point", "mode": "3d", "material": {material}, "steps": [{{"table": "strains.csv"}}]}}"#);
    std::fs::write(folder.join("case.json"), case).expect("a file");
    installation.run_case(&folder.join("case.json"), &[], &folder.join("result"));
    let ours = history(&folder.join("result"), &["s11", "s22", "s33", "s12", "s13", "s23"]);
    assert_eq!(ours.len(), increments + 1);
    let pairs = || ours[1..].iter().flatten().zip(stresses.iter().flatten());
    let largest = pairs().fold(0.0_f64, |most, (_, theirs)| most.max(theirs.abs()));
    assert!(largest > 10.0, "{largest}");
    worst(pairs().map(|(a, b)| (a - b).abs())) / largest
}

/// CalculiX's own elasticity in the same deck.
#[test]
fn its_elasticity_is_ours() {
    let Some(installation) = Installation::find() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let deck = deck();
    let (before, rest) = deck.split_once("*USER MATERIAL").expect("a user material");
    let (_, after) = rest.split_once("*DEPVAR\n13\n").expect("state variables");
    let elastic =
        format!("{before}*ELASTIC\n31800., 0.18\n{after}").replace(NAME, "CONCRETE").replace("S, E, SDV", "S, E");
    std::fs::write(folder.path().join("elastic.inp"), elastic).expect("a file");
    if ccx(folder.path(), "elastic").is_none() {
        return;
    }
    let material = r#"{"plugin": "linear_elastic", "props": {"E": 31800, "nu": 0.18}}"#;
    let apart = apart(&installation, folder.path(), "elastic", 1, material);
    println!("CalculiX, elasticity: stresses {apart:.1e} apart");
    assert!(apart <= PRINTED, "{apart:e}");
}

/// Our library as an external behaviour.
#[test]
fn our_law_in_calculix_is_our_law() {
    let Some(installation) = Installation::find() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("one_element.inp"), deck()).expect("a file");
    // A ccx with external behaviours looks for the library before anything else, and says that it is not there.
    let Some(words) = ccx(folder.path(), "one_element") else { return };
    if !words.contains("invalid material name") {
        return notice("ccx was built without external behaviours");
    }
    let library = folder.path().join("libCONCRETEDAMAGE.so");
    std::fs::copy(installation.library("concrete_damage"), &library).expect("a copy");
    let words = ccx(folder.path(), "one_element").expect("as before");
    assert!(words.contains("Job finished"), "{words}");
    let props = [31800.0, 0.18, 5000.0, 1.3, 0.0001905077, 31.47479, 1.05, 3e-4, 0.17227, 0.0, 0.0, 0.0, 0.0, 0.0];
    let material = format!(r#"{{"plugin": "concrete_damage", "props": {props:?}}}"#);
    let apart = apart(&installation, folder.path(), "one_element", INCREMENTS, &material);
    println!("CalculiX, concrete_damage: stresses {apart:.1e} apart");
    assert!(apart <= ALONG_THE_PATH, "{apart:e}");
}

//! `--checkpoint-every` and `--restart`: a run that was killed goes on to the same bits.

use crate::program::{Desk, cases, command, files, timeless};
use serde_json::json;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

/// Increments between checkpoints.
const EVERY: &str = "7";
/// A run may be over before it is killed; then another one is tried.
const ATTEMPTS: usize = 5;

/// Rows of a history, the header not counted; a line under way does.
fn rows(folder: &Path) -> usize {
    fs::read_to_string(folder.join("history.csv")).map_or(0, |text| text.lines().count().saturating_sub(1))
}

/// Starts the program and kills it once the history has so many rows and a checkpoint is there; whether that was before
/// its end.
fn killed_at(arguments: &[&str], folder: &Path, wanted: usize) -> bool {
    let mut child = command().args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts");
    while rows(folder) < wanted || !folder.join("checkpoint.bin").exists() {
        if child.try_wait().expect("a status").is_some() {
            return false;
        }
        sleep(Duration::from_millis(2));
    }
    // SIGKILL
    child.kill().expect("it can be killed");
    let status = child.wait().expect("a status");
    !status.success() && !folder.join("summary.json").exists()
}

/// Kills a run of the case twice and restarts it; all it leaves is what the whole run leaves that made no checkpoints.
fn goes_on_to_the_same_bits(case: &Path, overrides: &[&str]) {
    let desk = Desk::new();
    let case = case.to_string_lossy();
    let settings: Vec<&str> = overrides.iter().flat_map(|entry| ["--set", entry]).collect();
    let (whole, broken) = (desk.path("whole"), desk.path("broken"));
    let out = whole.to_string_lossy();
    let run = ["run", &case, "--quiet", "--out", &out];
    desk.pullout(run.iter().chain(&settings)).expect(0);
    let count = rows(&whole);
    let folder = broken.to_string_lossy();
    let mut begin = vec!["run", &case, "--quiet", "--checkpoint-every", EVERY, "--out", &folder];
    begin.extend(&settings);
    let mut restart = vec!["run", &case, "--quiet", "--restart", &folder];
    restart.extend(&settings);
    let interrupted = (0..ATTEMPTS).any(|_| {
        let _ = fs::remove_dir_all(&broken);
        killed_at(&begin, &broken, count * 2 / 5)
    });
    assert!(interrupted, "the run of {count} rows was over before it could be killed");
    // no checkpoint is made at the same place, and the second kill may come late: what counts is the end
    let again = killed_at(&restart, &broken, count * 7 / 10);
    if again {
        desk.pullout(&restart).expect(0);
    }
    let (whole_files, broken_files) = (files(&whole), files(&broken));
    assert_eq!(whole_files.keys().collect::<Vec<_>>(), broken_files.keys().collect::<Vec<_>>());
    for (name, content) in &whole_files {
        assert!(content == &broken_files[name], "{name} differs");
    }
    assert_eq!(timeless(&whole), timeless(&broken));
}

#[test]
fn a_damaging_matrix_with_friction_fields_and_pictures() {
    let case = cases().join("chapter-6").join("6.14-plane.json");
    goes_on_to_the_same_bits(
        &case,
        &[
            "mesh.specimen.embedded_elements=14",
            "contact.law.props.mu=0.1",
            "output.every=2",
            "output.vtu=9",
            "steps.0.slip=0.5",
        ],
    );
}

#[test]
#[ignore = "long: the other restarts"]
fn a_snap_back() {
    // a coarse mesh snaps as well, and there is nothing to see beyond it
    let overrides = ["mesh.specimen.embedded_elements=32", "steps.0.slip=0.03", "output.vtu=false"];
    goes_on_to_the_same_bits(&cases().join("verification").join("fibre-dropping-bond.json"), &overrides);
}

/// Points of contact that left the fibre come back after the second kill.
#[test]
fn a_fibre_that_is_pushed_back() {
    let case = cases().join("chapter-6").join("6.14-plane.json");
    let specimen = r#"mesh.specimen={"type": "perpendicular_fibre", "embedded_elements": 8, "equal_sizes": true, "free_length": 1}"#;
    let matrix = r#"parts.matrix.material={"plugin": "linear_elastic", "props": {"E": 30000, "nu": 0.2}}"#;
    let steps = r#"steps=[{"slip": 6}, {"slip": 0.2}]"#;
    goes_on_to_the_same_bits(
        &case,
        &[specimen, matrix, steps, "contact.law.props.tau_res=0.5", "contact.law.props.mu=0.1", "output.vtu=false"],
    );
}

#[test]
fn large_displacements_and_sliding() {
    goes_on_to_the_same_bits(&cases().join("verification").join("drag-out-strip.json"), &["output.vtu=false"]);
}

#[test]
#[ignore = "long: the other restarts"]
fn a_bent_fibre_that_tears_its_exit() {
    let case = cases().join("chapter-7").join("inclined-fibre.json");
    goes_on_to_the_same_bits(&case, &["mesh.specimen.mesh_size=2", "steps.0.slip=0.2", "output.vtu=20"]);
}

#[test]
fn a_run_with_checkpoints_is_the_run_to_the_last_bit() {
    let desk = Desk::new();
    let case = cases().join("chapter-6").join("6.14-plane.json");
    let case = case.to_string_lossy();
    let common = [
        "run",
        "--quiet",
        &case,
        "--set",
        "mesh.specimen.embedded_elements=10",
        "--set",
        "steps.0.slip=0.3",
        "--set",
        "output={\"plots\": false, \"vtu\": false}",
    ];
    desk.pullout(common.iter().chain(&["--out", "plain"])).expect(0);
    desk.pullout(common.iter().chain(&["--out", "kept", "--checkpoint-every", "5"])).expect(0);
    let [plain, kept] = ["plain", "kept"].map(|name| fs::read(desk.path(name).join("history.csv")).expect("a history"));
    assert!(plain == kept);
    assert_eq!(timeless(&desk.path("plain")), timeless(&desk.path("kept")));
}

#[test]
fn what_cannot_go_on_is_refused() {
    let desk = Desk::new();
    let case = cases().join("chapter-6").join("6.14-plane.json");
    let case = case.to_string_lossy();
    let coarse = [
        "--set",
        "mesh.specimen.embedded_elements=8",
        "--set",
        "steps.0.slip=0.02",
        "--set",
        "output={\"plots\": false, \"vtu\": false}",
    ];
    let run = ["run", "--quiet", &case];
    desk.pullout(run.iter().chain(&coarse).chain(&["--out", "out", "--checkpoint-every", "4"])).expect(0);
    let before = files(&desk.path("out"));
    let refused = |said: &str, arguments: &[&str]| {
        let outcome = desk.pullout(arguments).expect(2);
        assert!(outcome.stderr.contains(said), "{said}:\n{}", outcome.stderr);
        assert!(files(&desk.path("out")) == before && desk.path("out/summary.json").exists(), "{said}");
    };
    let with = |more: &[&'static str]| -> Vec<String> {
        run.iter().chain(&coarse).chain(more).map(|word| (*word).to_owned()).collect()
    };
    let refused_with = |said: &str, more: &[&'static str]| {
        let words = with(more);
        refused(said, &words.iter().map(String::as_str).collect::<Vec<_>>());
    };
    refused_with("made by another case", &["--restart", "out", "--set", "contact.law.props.k_e=401"]);
    refused_with("made by another case", &["--restart", "out", "--set", "controls.max_iterations=21"]);
    refused_with("checkpoint.bin: ", &["--restart", "nowhere"]);
    refused_with("--restart out goes on in out", &["--restart", "out", "--out", "elsewhere"]);
    refused_with("give one case", &["--restart", "out", "other.json"]);
    refused_with("run the case from its start", &["--restart", "out", "--untrusted"]);
    refused_with("--checkpoint-every", &["--checkpoint-every", "0", "--out", "elsewhere"]);
    let point = json!({
        "kind": "point", "mode": "3d", "material": { "plugin": "linear_elastic" },
        "steps": [{ "increments": 1, "target": { "e11": 1e-3 } }]
    });
    let point = desk.case("point.json", &point);
    refused("only runs of kind", &["run", "--checkpoint-every", "3", &point.to_string_lossy()]);
    // a bit of the state is another one
    let file = desk.path("out/checkpoint.bin");
    let mut content = fs::read(&file).expect("a checkpoint");
    let middle = content.len() / 2;
    content[middle] ^= 1;
    fs::write(&file, &content).expect("a file");
    refused_with("damaged", &["--restart", "out"]);
    content[middle] ^= 1;
    fs::write(&file, &content).expect("a file");
    // a line in front of the rows, of the same length in all
    let history = desk.path("out/history.csv");
    let text = fs::read(&history).expect("a history");
    let header = text.iter().position(|&byte| byte == b'\n').expect("a header") + 1;
    let put_in = [&text[..header], b"0,0,0\n", &text[header..]].concat();
    fs::write(&history, put_in).expect("a file");
    let outcome = desk.pullout(with(&["--restart", "out"])).expect(2);
    assert!(outcome.stderr.contains("rows from before the checkpoint were changed"), "{}", outcome.stderr);
    fs::write(&history, &text).expect("a file");
    // rows from before the checkpoint are gone
    fs::write(&history, &text[..100]).expect("a file");
    let words = with(&["--restart", "out"]);
    let outcome = desk.pullout(words).expect(2);
    assert!(outcome.stderr.contains("rows from before the checkpoint are missing"), "{}", outcome.stderr);
}

/// `fields.pvd` and the files after the last checkpoint are made again; a file from before it must be as it was.
#[test]
fn written_fields_are_those_of_the_run_that_goes_on() {
    let desk = Desk::new();
    let case = cases().join("chapter-6").join("6.14-plane.json");
    let case = case.to_string_lossy();
    let coarse = ["run", "--quiet", &case, "--set", "mesh.specimen.embedded_elements=6", "--set", "steps.0.slip=0.02"];
    let coarse = coarse.into_iter().chain(["--set", "output={\"plots\": false, \"vtu\": 3}"]);
    let run = |more: &[&str], code: i32| desk.pullout(coarse.clone().chain(more.iter().copied())).expect(code);
    run(&["--out", "out", "--checkpoint-every", "8"], 0);
    let whole = files(&desk.path("out"));
    let list = String::from_utf8(whole["fields.pvd"].clone()).expect("text");
    assert!(list.matches("<DataSet").count() > 8, "{list}");
    let late = list.matches("<DataSet").count() / 2 - 1;
    let names = ["fields.pvd", &format!("fields/{late:06}.vtu"), "fields/000000.vtu"];
    let [pvd, late, first] = names.map(|name| desk.path("out").join(name));
    for gone in [&pvd, &late] {
        fs::remove_file(gone).expect("it was written");
    }
    run(&["--restart", "out"], 0);
    assert!(files(&desk.path("out")) == whole);
    let content = fs::read(&first).expect("a field");
    let mut changed = content.clone();
    *changed.last_mut().expect("a byte") ^= 1;
    fs::write(&first, &changed).expect("a field");
    let stderr = run(&["--restart", "out"], 2).stderr;
    assert!(stderr.contains("fields/000000.vtu: is missing or was changed since the checkpoint"), "{stderr}");
    fs::remove_file(&first).expect("a field");
    assert!(run(&["--restart", "out"], 2).stderr.contains("fields/000000.vtu: is missing"));
    fs::write(&first, &content).expect("a field");
    run(&["--restart", "out"], 0);
    // the checkpoint is no file
    fs::remove_file(desk.path("out/checkpoint.bin")).expect("a checkpoint");
    let made = std::process::Command::new("mkfifo").arg(desk.path("out/checkpoint.bin")).status();
    assert!(made.expect("mkfifo").success());
    assert!(run(&["--restart", "out"], 2).stderr.contains("checkpoint.bin: it is a pipe or a device"));
}

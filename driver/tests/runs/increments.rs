//! Runs that repeat the increments of another: the same bits, and curves that are smooth in the parameters.

use crate::program::{self, Desk, cases};
use end_to_end_tests::worst;
use pullout_engine::{CaseSource, INCREMENTS, Outcome, Settings, set_program};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

fn run(source: CaseSource, records: bool) -> Outcome {
    let program = Path::new(env!("CARGO_BIN_EXE_pullout"));
    set_program(program, program);
    let prepared = source.read().unwrap_or_else(|errors| panic!("{errors}"));
    prepared.run(Settings { records, ..Settings::default() }).unwrap_or_else(|error| panic!("{error}"))
}

fn with(case: &Value, changes: &[(&str, f64)], increments: Option<&Value>) -> CaseSource {
    let mut source = CaseSource::document(case.clone(), &cases().join("chapter-6"));
    source.overrides = changes.iter().map(|(path, value)| format!("{path}={value:?}")).collect();
    source.overrides.extend(increments.map(|recorded| format!("increments={}", json!({ "recorded": recorded }))));
    source
}

fn bits(outcome: &Outcome) -> Vec<Vec<u64>> {
    let history = &outcome.history;
    let columns = 0..history.columns().len();
    columns.map(|k| history.column_at(k).unwrap().iter().map(|value| value.to_bits()).collect()).collect()
}

fn repeats(case: &Value) -> Value {
    let base = run(with(case, &[], None), true);
    assert!(base.is_done(), "{:?}", base.summary.message);
    let increments = base.documents[INCREMENTS].clone();
    let again = run(with(case, &[], Some(&increments)), true);
    assert!(again.is_done(), "{:?}", again.summary.message);
    assert!(bits(&again) == bits(&base));
    assert_eq!(again.documents[INCREMENTS], increments);
    increments
}

fn refused(increments: &Value) -> usize {
    increments.to_string().matches("refused").count()
}

fn bond() -> Value {
    json!({
        "kind": "interface",
        "material": { "plugin": "bond_slip", "props": { "law": "A", "k_e": 950.0, "a_1": 10.0, "b_1": 0.4 } },
        "steps": [{ "increments": 20, "target": { "slip": 0.5 }, "until": { "quantity": "slip", "greater_than": 0.3 } },
                  { "increments": 3, "target": { "slip": 0.1 } }],
        "output": { "every": 7 }
    })
}

/// A cracking point, of which an increment is cut back, and one that slides until it has had enough.
#[test]
fn points_are_repeated_to_the_bit() {
    let point = json!({
        "kind": "point",
        "material": { "plugin": "concrete_damage", "props": { "E": 31800.0, "nu": 0.18, "G_f": 0.1 } },
        "characteristic_length": 50.0,
        "steps": [{ "increments": 4, "target": { "e11": 4e-3, "s22": 0.0, "s33": 0.0 } },
                  { "increments": 3, "target": { "s11": 0.0 } }],
        "controls": { "max_iterations": 6 }
    });
    assert!(refused(&repeats(&point)) > 0);
    let increments = repeats(&bond());
    assert_eq!(increments["steps"][0].as_array().unwrap().len(), 13, "the step ended early");
}

fn fibre(slip: f64) -> Value {
    let text = std::fs::read_to_string(cases().join("chapter-6/6.14-plane.json")).unwrap();
    let mut case: Value = serde_json::from_str(&text).unwrap();
    case["mesh"]["specimen"] = program::coarse_fibre();
    case["steps"][0]["slip"] = json!(slip);
    case["output"] = json!({ "vtu": false });
    case
}

/// A record that ends where a run failed would be repeated as if it were the whole run.
#[test]
fn a_run_that_was_not_at_its_end_leaves_no_increments() {
    let mut bar = json!({
        "kind": "point",
        "material": { "plugin": "concrete_damage", "props": { "E": 31800.0, "nu": 0.18, "G_f": 0.1 } },
        "characteristic_length": 50.0,
        // more than it carries
        "steps": [{ "increments": 10, "target": { "s11": 30.0 } }],
        "output": { "plots": false },
    });
    let failed = run(with(&bar, &[], None), true);
    assert!(!failed.is_done() && !failed.documents.contains_key(INCREMENTS));
    let desk = Desk::new();
    let folder = desk.path("out");
    let file = desk.case("bar.json", &bar);
    let record = || {
        let mut command = program::command();
        command.args(["run", "--quiet", "--record-increments", "--out"]).arg(&folder).arg(&file).status().unwrap();
        folder.join("increments.json").exists()
    };
    assert!(!record());
    bar["steps"][0]["target"] = json!({ "s11": 1.0 });
    desk.case("bar.json", &bar);
    assert!(record());
    // nor does one of an earlier run stay
    bar["steps"][0]["target"] = json!({ "s11": 30.0 });
    desk.case("bar.json", &bar);
    assert!(!record());
}

/// Five parameters at five slips across the peak, by runs along the first one, against central differences with the same increments.
#[test]
fn gradients_of_a_pull_out_curve() {
    const PARAMETERS: [&str; 5] = [
        "contact.law.props.k_e",
        "contact.law.props.a_1",
        "contact.law.props.b_1",
        "contact.law.props.b_2",
        "parts.matrix.material.props.E",
    ];
    const SLIPS: [f64; 5] = [0.004, 0.012, 0.02, 0.03, 0.04];
    let case = fibre(0.045);
    let base = run(with(&case, &[], None), true);
    let (increments, trail) = (base.documents[INCREMENTS].clone(), base.trail.clone().unwrap());
    assert!(refused(&increments) > 0);
    let value = |path: &str| path.split('.').fold(&case, |value, key| &value[key]).as_f64().unwrap();
    let loads = |outcome: &Outcome| -> Vec<f64> {
        assert!(outcome.is_done(), "{:?}", outcome.summary.message);
        let column = |name: &str| outcome.history.column(name).unwrap();
        let (slip, load) = (column("slip"), column("load"));
        let at = |s: f64| {
            let k = slip.iter().position(|slip| *slip > s).unwrap();
            load[k - 1] + (load[k] - load[k - 1]) * (s - slip[k - 1]) / (slip[k] - slip[k - 1])
        };
        SLIPS.map(at).to_vec()
    };
    let here = loads(&base);
    assert!(here[2] > here[0] && here[2] > here[4], "the peak is in between: {here:?}");
    for path in PARAMETERS {
        let changed = |relative: f64| [(path, value(path) * (1.0 + relative))];
        let perturbed = with(&case, &changed(1e-6), None).read().unwrap();
        let perturbed =
            perturbed.run(Settings { along: Some(Arc::clone(&trail).into()), ..Settings::default() }).unwrap();
        assert!(perturbed.summary.cutbacks == 0 && perturbed.summary.iterations < base.summary.iterations / 2);
        let forward: Vec<f64> =
            loads(&perturbed).iter().zip(&here).map(|(there, here)| (there - here) / 1e-6).collect();
        let repeated = |relative| loads(&run(with(&case, &changed(relative), Some(&increments)), false));
        let (high, low) = (repeated(1e-4), repeated(-1e-4));
        let central: Vec<f64> = high.iter().zip(&low).map(|(high, low)| (high - low) / 2e-4).collect();
        let greatest = central.iter().fold(0.0_f64, |greatest, slope| greatest.max(slope.abs()));
        let worst = worst(forward.iter().zip(&central).map(|(a, b)| (a - b).abs() / greatest));
        println!("{path}: {central:?}, {worst:.1e}");
        assert!(worst < 1e-4, "{path}: {forward:?}, {central:?}");
    }
}

#[test]
fn the_program_writes_increments_and_reads_them() {
    let desk = Desk::new();
    let mut case = bond();
    case["output"] = json!({ "plots": false });
    let file = desk.case("bond.json", &case);
    let base = desk.run(&file, &[], "base", 0);
    assert!(!base.folder.join("increments.json").exists());
    let output = program::command()
        .arg("run")
        .arg("--record-increments")
        .arg("--overwrite")
        .arg("--out")
        .arg(&base.folder)
        .arg(&file)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    case["increments"] = json!({ "recorded": "base/increments.json" });
    let again = desk.run(&desk.case("again.json", &case), &[], "again", 0);
    let rows = |folder: &Path| std::fs::read_to_string(folder.join("history.csv")).unwrap();
    assert_eq!(rows(&again.folder), rows(&base.folder));
}

#[test]
fn what_no_run_has_recorded_is_refused_with_its_place() {
    let increment = json!([{ "to": { "drives": 1.0 } }]);
    let wrong = [
        (json!(5), "record"),
        (json!("none.json"), "none.json"),
        (json!({ "steps": 1 }), "record"),
        (json!({ "steps": [[[{ "to": { "drives": 1.0 }, "tme": 1.0 }]]] }), "tme"),
        (json!({ "steps": [[[{ "to": { "drives": 2.0 } }]]] }), "steps[0][0][0]"),
        (json!({ "steps": [[[]]] }), "stands"),
        (json!({ "steps": [[increment], [[{ "to": { "drives": 1.0 }, "verdict": "refused" }]]] }), "steps[1][0][0]"),
        (json!({ "steps": [[], [], []] }), "3 steps, the case 2"),
        (json!({ "steps": [[increment]] }), "1 steps, the case 2"),
        (json!({ "steps": [vec![increment.clone(); 21], []] }), "21 increments"),
        (
            json!({ "steps": [[[{ "to": { "slip": { "growth": 1.0, "point": [0, 0] } }, "time": 0.1 }]], []] }),
            "specimen",
        ),
    ];
    for (recorded, part) in wrong {
        let message = with(&bond(), &[], Some(&recorded)).read().unwrap_err().to_string();
        assert!(message.contains("$.increments.recorded") && message.contains(part), "{recorded}: {message}");
    }
}

//! `pullout fit CASE`: parameters of a case from a curve that it made, and messages about wrong input.

use crate::program::{self, Desk, cases, command};
use end_to_end_tests::{Tool, find, run as compile, workspace};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Output;

fn fit(desk: &Desk, case: &Path, arguments: &[&str]) -> Output {
    command().args(["fit", "--quiet"]).args(arguments).arg(case).current_dir(desk.path("")).output().unwrap()
}

fn bond(k_e: f64, a_1: f64) -> Value {
    json!({
        "kind": "interface",
        "material": { "plugin": "bond_slip", "props": { "law": "A", "k_e": k_e, "a_1": a_1, "b_1": 0.4 } },
        "steps": [{ "increments": 150, "target": { "slip": 0.01 } }],
        "output": { "plots": false },
    })
}

/// A curve of what is sought, started elsewhere, gives it back; the case that is written makes the curve.
fn found(case: &Value, sought: &[(&str, f64, [f64; 2])], curve: &str, relative: f64) -> Value {
    let desk = Desk::new();
    let truth: Vec<String> = sought.iter().map(|(path, value, _)| format!("{path}={value:?}")).collect();
    let start = desk.case("start.json", case);
    // files that are called like laws are none of the case's
    for law in ["bond_slip", "linear_elastic"] {
        desk.write(law, "");
    }
    let made = desk.run(&start, &truth.iter().map(String::as_str).collect::<Vec<_>>(), "truth", 0);
    let data = made.folder.join("history.csv");
    let free: Vec<String> =
        sought.iter().map(|(path, _, [low, high])| format!("--free={path}={low:?}:{high:?}")).collect();
    let data = format!("--data={}", data.display());
    let curve = format!("--curve={curve}");
    let mut arguments: Vec<&str> = free.iter().map(String::as_str).collect();
    arguments.extend([data.as_str(), curve.as_str(), "--out=found"]);
    let output = fit(&desk, &start, &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let folder = desk.path("found");
    let read = |name: &str| serde_json::from_str::<Value>(&fs::read_to_string(folder.join(name)).unwrap()).unwrap();
    let result = read("fit.json");
    for (k, (path, value, _)) in sought.iter().enumerate() {
        let number = &result["parameters"][k];
        assert_eq!(number["path"], *path);
        if number["identifiable"] == json!(true) {
            approx::assert_relative_eq!(number["value"].as_f64().unwrap(), *value, max_relative = relative);
        }
        assert!(number["standard_error"].is_number() == (number["identifiable"] == json!(true)), "{number}");
    }
    desk.run(&folder.join("fitted-case.json"), &[], "again", 0);
    let report = fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(folder.join("plots/fitted-curve.svg").is_file() && report.contains("<svg"));
    sought.iter().for_each(|(path, ..)| assert!(report.contains(path), "{path}"));
    result
}

#[test]
fn a_contact_point() {
    let sought = [("material.props.k_e", 950.0, [300.0, 3000.0]), ("material.props.a_1", 10.0, [1.0, 30.0])];
    let result = found(&bond(700.0, 7.0), &sought, "slip,tau", 1e-6);
    assert_eq!(result["status"], "done");
    assert!(result["parameters"].as_array().unwrap().iter().all(|number| number["identifiable"] == json!(true)));
}

#[test]
fn a_loop_of_a_fiftieth_of_the_data_determines_the_stiffness_of_unloading() {
    let mut case = bond(950.0, 10.0);
    case["material"]["props"]["k_u"] = json!(500.0);
    case["steps"] = [0.005, 0.0048, 0.01].map(|slip| json!({ "increments": 20, "target": { "slip": slip } })).into();
    let result = found(&case, &[("material.props.k_u", 300.0, [100.0, 900.0])], "slip,tau", 1e-6);
    assert_eq!((&result["parameters"][0]["identifiable"], &result["warnings"]), (&json!(true), &json!([])));
}

fn bar() -> Value {
    json!({
        "kind": "point",
        "material": { "plugin": "linear_elastic", "props": { "E": 90.0, "nu": 0.2 } },
        "steps": [{ "increments": 10, "target": { "e11": 0.01, "e22": 0.0, "e33": 0.0 } }],
        "output": { "plots": false },
    })
}

/// The numbers of `sought` as a search of data finds them.
fn values(desk: &Desk, case: &Path, arguments: &[&str]) -> Vec<f64> {
    let output = fit(desk, case, &[arguments, &["--out=found", "--overwrite"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = fs::read_to_string(desk.path("found/fit.json")).unwrap();
    let result: Value = serde_json::from_str(&text).unwrap();
    let value = |number: &Value| number["value"].as_f64().unwrap();
    result["parameters"].as_array().unwrap().iter().map(value).collect()
}

/// Compression, whose strains fall.
#[test]
fn a_curve_that_goes_backwards() {
    let mut bar = bar();
    bar["steps"][0]["target"] = json!({ "e11": -0.01 });
    let sought = [("material.props.E", 100.0, [10.0, 300.0])];
    let found = found(&bar, &sought, "e11,s11", 1e-6);
    assert_eq!(found["parameters"][0]["identifiable"], true);
}

/// E of a bar that is held and of one that is free, ν of both: s11 = E (1 − ν)/((1 + ν)(1 − 2ν)) e11 of the one and E e11 of the
/// other. Neither determines both.
#[test]
fn two_tests_share_their_numbers() {
    let desk = Desk::new();
    let (e, nu): (f64, f64) = (100.0, 0.25);
    let mut free = bar();
    free["steps"][0]["target"] = json!({ "e11": 0.01 });
    desk.case("held.json", &bar());
    desk.case("free.json", &free);
    let held = e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    for (name, modulus) in [("held.csv", held), ("free.csv", e)] {
        let rows: Vec<String> = [0.002, 0.005, 0.01].map(|x| format!("{x},{}\n", modulus * x)).into();
        desk.write(name, &format!("strain,stress\n{}", rows.concat()));
    }
    let sought = ["--free=material.props.E=10:300", "--free=material.props.nu=0:0.4", "--curve=e11,s11"];
    let tests = ["held.json", "--data=held.csv", "--data=free.csv", "--weight=1", "--weight=4"];
    let found = values(&desk, Path::new("free.json"), &[&sought[..], &tests].concat());
    approx::assert_relative_eq!(found[0], e, max_relative = 1e-6);
    approx::assert_relative_eq!(found[1], nu, max_relative = 1e-6);
    let result: Value = serde_json::from_slice(&fs::read(desk.path("found/fit.json")).unwrap()).unwrap();
    let is_known = |number: &Value| number["identifiable"] == json!(true);
    assert!(result["parameters"].as_array().unwrap().iter().all(is_known), "{result}");
    assert_eq!((&result["tests"][0]["case"], &result["tests"][1]["weight"]), (&json!("held.json"), &json!(4.0)));
    assert!(result.get("case").is_none());
    for (number, modulus) in [(1, held), (2, e)] {
        let again =
            desk.run(&desk.path(&format!("found/fitted-case-{number}.json")), &[], &format!("again-{number}"), 0);
        let history = program::Table::read(&again.folder.join("history.csv"));
        approx::assert_relative_eq!(history.last("s11"), 0.01 * modulus, max_relative = 1e-6);
        assert!(desk.path(&format!("found/fitted-curve-{number}.csv")).is_file());
    }
    let one = ["held.json", "--data=held.csv", "--data=free.csv", "--data=free.csv", "--free=material.props.E=10:300"];
    let output = fit(&desk, Path::new("free.json"), &[&one[..], &["--curve=e11,s11"]].concat());
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("CASE.json is given 2 times, --data 3 times"));
}

/// Σ w (1 − E/E_k)² is least at E = Σ (w/E_k) / Σ (w/E_k²).
#[test]
fn weights_say_which_of_two_tests_counts() {
    let desk = Desk::new();
    let mut free = bar();
    free["steps"][0]["target"] = json!({ "e11": 0.01 });
    let case = desk.case("free.json", &free);
    let moduli = [80.0_f64, 120.0];
    for (k, modulus) in moduli.iter().enumerate() {
        desk.write(&format!("{k}.csv"), &format!("e11,s11\n0.005,{}\n0.01,{}\n", modulus * 0.005, modulus * 0.01));
    }
    let weights = [1.0, 3.0];
    let arguments = [
        "--free=material.props.E=10:300",
        "--curve=e11,s11",
        "--data=0.csv",
        "--data=1.csv",
        "--weight=1",
        "--weight=3",
    ];
    let sums = |power: i32| -> f64 { std::iter::zip(weights, moduli).map(|(w, e)| w / e.powi(power)).sum() };
    approx::assert_relative_eq!(values(&desk, &case, &arguments)[0], sums(1) / sums(2), max_relative = 1e-6);
}

/// Unloading and reloading are branches of their own, not more points of the first one.
#[test]
fn a_curve_with_cycles() {
    let mut bond = bond(700.0, 7.0);
    let step = |slip: f64| json!({ "increments": 40, "target": { "slip": slip } });
    bond["steps"] = json!([step(0.02), step(0.005), step(0.03), step(-0.01)]);
    let sought = [("material.props.k_e", 950.0, [300.0, 3000.0]), ("material.props.a_1", 10.0, [1.0, 30.0])];
    let result = found(&bond, &sought, "slip,tau", 1e-6);
    assert!(result["rms"].as_f64().unwrap() < 1e-6, "{}", result["rms"]);
}

/// A case that repeats a long record is longer than the arguments of a process may be.
#[test]
fn a_library_of_another_in_many_increments() {
    let Some(mut compiler) = find(Tool::C) else { return };
    let desk = Desk::new();
    let (library, source) = (desk.path("libelastic.so"), workspace("driver/tests/isolation/misbehaving.c"));
    compile(
        compiler
            .args(["-shared", "-fPIC", "-O1", "-I"])
            .arg(workspace("umat-abi/include"))
            .arg("-o")
            .arg(&library)
            .arg(source),
    );
    let case = json!({
        "kind": "point",
        "material": { "plugin": "./libelastic.so", "nstatv": 2, "props": [900.0, 0, 1, 3] },
        "steps": [{ "increments": 6000, "target": { "e11": 0.01 } }],
        "output": { "plots": false },
    });
    let case = desk.case("case.json", &case);
    desk.write("data.csv", "e11,s11\n0.002,2\n0.005,5\n0.01,10\n");
    let arguments = ["--free=material.props.0=100:3000", "--data=data.csv", "--curve=e11,s11"];
    approx::assert_relative_eq!(values(&desk, &case, &arguments)[0], 1000.0, max_relative = 1e-6);
}

/// At the case's own start the whole run is elastic, and no derivative depends on the yield stress. Another start finds it.
#[test]
fn a_search_that_ends_where_it_began_is_not_the_best() {
    let desk = Desk::new();
    let case = json!({
        "kind": "point",
        "material": { "plugin": "j2_plasticity", "props": { "E": 200e3, "nu": 0.3, "hardening": [[900, 0]] } },
        "steps": [{ "increments": 40, "target": { "e11": 0.005, "e22": 0, "e33": 0 } }],
        "output": { "plots": false },
    });
    let case = desk.case("case.json", &case);
    desk.run(&case, &["material.props.hardening.0.0=300"], "truth", 0);
    let arguments = ["--free=material.props.hardening.0.0=100:1000", "--data=truth/history.csv", "--curve=e11,s11"];
    approx::assert_relative_eq!(values(&desk, &case, &arguments)[0], 300.0, max_relative = 1e-9);
    let result = || -> Value { serde_json::from_slice(&fs::read(desk.path("found/fit.json")).unwrap()).unwrap() };
    assert_eq!(result()["searches"]["ended_here"], 1);
    assert!(result()["searches"]["made"].as_u64().unwrap() > 1, "{}", result()["searches"]);
    // the given start alone, and one that finds it: no other is tried
    assert_eq!(values(&desk, &case, &[&arguments[..], &["--starts=1"]].concat()), [900.0]);
    values(&desk, &case, &[&arguments[..], &["--set=material.props.hardening.0.0=400"]].concat());
    assert_eq!(result()["searches"], json!({ "made": 1, "ended_here": 1 }));
}

/// One slope does not determine two constants.
#[test]
fn what_the_curve_does_not_determine_is_reported() {
    let bar = bar();
    let sought = [("material.props.E", 100.0, [10.0, 300.0]), ("material.props.nu", 0.25, [0.0, 0.4])];
    let result = found(&bar, &sought, "e11,s11", 1.0);
    assert!(result["parameters"].as_array().unwrap().iter().all(|number| number["identifiable"] == json!(false)));
    let found = found(&bar, &sought[..1], "e11,s11", 1e-6);
    assert_eq!(found["parameters"][0]["identifiable"], true);
}

/// Across the peak, increments chosen by the run.
#[test]
fn a_pull_out() {
    let text = fs::read_to_string(cases().join("chapter-6/6.14-plane.json")).unwrap();
    let mut case: Value = serde_json::from_str(&text).unwrap();
    case["mesh"]["specimen"] = program::coarse_fibre();
    case["steps"][0]["slip"] = json!(0.03);
    case["output"] = json!({ "vtu": false, "plots": false });
    let sought = [("contact.law.props.k_e", 480.0, [100.0, 1000.0]), ("contact.law.props.a_1", 3.8, [2.0, 6.0])];
    found(&case, &sought, "slip,load", 2e-3);
}

#[test]
fn what_is_wrong_is_one_message_with_its_place() {
    let desk = Desk::new();
    let case = desk.case("bond.json", &bond(700.0, 7.0));
    let table = |name: &str, text: &str| fs::write(desk.path(name), text).unwrap();
    table("data.csv", "slip,tau\n0.001,1\n0.002,2\n0.003,3\n");
    table("numbers.csv", "0.1,1\n0.2,2\n0.3,3\n");
    table("one.csv", "slip\n0.1\n");
    table("cell.csv", "slip,tau\n0.1,1\n0.2,x\n0.3,3\n");
    table("short.csv", "slip,tau\n0.1,1\n");
    table("zero.csv", "slip,tau\n0.1,0\n0.2,0\n0.3,0\n");
    table("far.csv", "slip,tau\n0.001,1\n0.002,2\n0.9,3\n");
    table("empty.csv", "");
    table("before.csv", "slip,tau\n-0.001,1\n0.002,2\n0.003,3\n");
    table("back.csv", "slip,tau\n0.001,1\n0.003,3\n0.002,2\n0.001,1\n");
    table("others.csv", "s,F\n0.001,1\n0.002,2\n0.003,3\n");
    table("force.csv", "time,slip,force\n0.001,1,1\n0.002,2,2\n0.003,3,3\n");
    let k_e = "--free=material.props.k_e=300:3000";
    let wrong: [(&[&str], &str); 16] = [
        (&["--data=data.csv"], "--free"),
        (&[k_e], "--data"),
        (&["--free=material.props.k_e", "--data=data.csv"], "PATH=lo:hi"),
        (&["--free=material.props.k_e=300", "--data=data.csv"], "PATH=lo:hi"),
        (&["--free=material.props.k_e=3000:300", "--data=data.csv"], "3000 is not below 300"),
        (&["--free=material.props.k_e=a:300", "--data=data.csv"], "'a' is not a finite number"),
        (&["--free=material..k_e=1:2", "--data=data.csv"], "empty name"),
        (&["--free=material.props.k=1:2", "--data=data.csv"], "$.material.props.k is not there"),
        (&["--free=material.props.law=1:2", "--data=data.csv"], "$.material.props.law is \"A\", and no number"),
        (&["--free=material.props.k_e=1:2", "--data=data.csv"], "begins with 700, which is not within 1:2"),
        (&[k_e, k_e, "--data=data.csv"], "is given twice"),
        (&[k_e, "--data=none.csv"], "none.csv"),
        (&[k_e, "--data=numbers.csv"], "numbers.csv, line 1: these are numbers"),
        (&[k_e, "--data=one.csv"], "one.csv, line 1: one column"),
        (&[k_e, "--data=cell.csv"], "cell.csv, line 3, column 'tau': 'x' is not a finite number"),
        (&[k_e, "--data=short.csv"], "short.csv: 1 points cannot determine 1 parameters"),
    ];
    let more: [(&[&str], &str); 8] = [
        (&[k_e, "--data=back.csv"], "the data reverse at slip 0.003 (point 2), the run does not"),
        (&[k_e, "--data=before.csv"], "the run begins at slip 0, the data also have -0.001"),
        (&[k_e, "--data=force.csv"], "force.csv, line 1: there is one of the columns of --curve, but not 'tau'"),
        (&[k_e, "--data=zero.csv"], "all values are 0"),
        (&[k_e, "--data=far.csv"], "the run ends at slip 0.01, the data go on to 0.9"),
        (&[k_e, "--data=empty.csv"], "empty.csv"),
        (&[k_e, "--data=others.csv", "--curve=slip,load"], "no column 'load'"),
        (&[k_e, "--data=data.csv", "--curve=slip"], "write X,Y"),
    ];
    for (arguments, part) in wrong.iter().chain(&more) {
        let mut arguments = arguments.to_vec();
        if !arguments.iter().any(|argument| argument.starts_with("--curve")) {
            arguments.push("--curve=slip,tau");
        }
        let output = fit(&desk, &case, &arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(part), "{arguments:?}: {message}");
    }
}

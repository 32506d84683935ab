//! What the README shows works as it stands there: its blocks are taken out, built and run. The UMATs of other
//! languages in `tests/umats/` are driven by the program beside the plugin of the same law.

mod program;

use end_to_end_tests::{Tool, find, run, workspace};
use program::{Desk, Run};
use serde_json::json;
use std::path::Path;
use std::process::Command;

/// The fenced blocks of a language, in order.
fn blocks(language: &str) -> Vec<String> {
    let text = std::fs::read_to_string(workspace("README.md")).expect("README.md");
    let fence = format!("```{language}\n");
    text.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap_or_default().to_owned()).collect()
}

/// Largest difference of two runs' stresses and free strains, relative to the largest entry of each column.
fn difference(a: &Run, b: &Run) -> f64 {
    let mut worst = 0.0_f64;
    for name in ["e11", "e22", "e33", "g12", "s11", "s22", "s33", "s12"] {
        let (a, b) = (a.history.column(name), b.history.column(name));
        assert_eq!(a.len(), b.len());
        let scale = a.iter().fold(1e-300_f64, |m, x| m.max(x.abs()));
        // a component that is free of stress everywhere holds what the iteration left
        if scale > 1e-7 || name.starts_with(['e', 'g']) {
            worst = a.iter().zip(&b).fold(worst, |m, (a, b)| m.max((a - b).abs() / scale));
        }
    }
    worst
}

/// The README's case with a library built from its Fortran or C block, against `linear_elastic`.
fn umat_of_the_readme(tool: Tool, language: &str, file: &str) {
    let Some(mut compiler) = find(tool) else { return };
    let desk = Desk::new();
    let source = desk.write(file, &blocks(language)[0]);
    let library = desk.path("libmy_umat.so");
    run(compiler.args(["-shared", "-fPIC", "-O2", "-o"]).arg(&library).arg(source));
    let case = desk.write("case.json", &blocks("json")[1]);
    let theirs = desk.run(&case, &[], "theirs", 0);
    let ours = desk.run(&case, &["material={\"plugin\": \"linear_elastic\", \"props\": [31800.0, 0.18]}"], "ours", 0);
    assert!((theirs.history.last("s11") - 31.8).abs() < 1e-10);
    assert!(difference(&ours, &theirs) < 1e-12);
    let check = ["plugin", "check", "./libmy_umat.so", "--case", "case.json", "--states", "20"];
    let verdict = desk.pullout(check).expect(0).stdout;
    assert!(verdict.contains("consistent"), "{verdict}");
}

#[test]
fn the_fortran_umat_runs_and_passes_the_check() {
    umat_of_the_readme(Tool::Fortran, "fortran", "my_umat.f");
}

#[test]
fn the_c_umat_runs_and_passes_the_check() {
    umat_of_the_readme(Tool::C, "c", "my_umat.c");
}

#[test]
fn the_first_case_runs_and_unloads() {
    let desk = Desk::new();
    let case = desk.write("case.json", &blocks("json")[0]);
    let run = desk.run(&case, &[], "out", 0);
    assert!(run.peak("s11", "min") < -27.0);
    assert!(run.history.last("s11").abs() < 1e-7, "unloaded");
    assert!(run.history.last("e11") < -1e-4, "inelastic strain stays");
}

#[test]
fn the_rust_law_builds_and_passes_the_check() {
    let desk = Desk::new();
    let contract = workspace("umat-abi");
    let manifest = blocks("toml")[0].replace("../pullout/umat-abi", &contract.to_string_lossy());
    desk.write("Cargo.toml", &format!("{manifest}\n[workspace]\n"));
    desk.write("src/lib.rs", &blocks("rust")[0]);
    let cargo = option_env!("CARGO").unwrap_or("cargo");
    let target = desk.path("target");
    // the versions that this workspace uses, so that nothing has to be looked up
    std::fs::copy(workspace("Cargo.lock"), desk.path("Cargo.lock")).expect("Cargo.lock");
    run(Command::new(cargo).current_dir(desk.path(".")).env("CARGO_TARGET_DIR", &target).args([
        "build",
        "--release",
        "--offline",
        "--quiet",
    ]));
    let library = target.join("release").join("libhyperbolic.so");
    let check = desk.pullout(["plugin", "check", &library.to_string_lossy()]);
    let verdict = check.expect(0).stdout;
    assert!(verdict.contains("none failed"), "{verdict}");
    assert!(desk.pullout(["plugin", "info", &library.to_string_lossy()]).expect(0).stdout.contains("gamma_r"));
}

/// A J2 UMAT in another language along strain cycles, against `j2_plasticity`.
fn plasticity_in(tool: Tool, file: &str) {
    let Some(mut compiler) = find(tool) else { return };
    let desk = Desk::new();
    let library = desk.path("libforeign.so");
    let source = workspace("tests/umats").join(file);
    let include = workspace("umat-abi/include");
    run(compiler.args(["-shared", "-fPIC", "-O2", "-o"]).arg(&library).arg(source).arg("-I").arg(include).arg("-lm"));
    // all strains given: both libraries see the same path to the last bit
    let steps = [0.01, -0.01, 0.02].map(|e| {
        let target =
            json!({ "e11": e, "e22": -0.4 * e, "e33": -0.3 * e, "g12": 0.5 * e, "g13": 0.2 * e, "g23": "hold" });
        json!({ "increments": 50, "target": target })
    });
    let case = |material: serde_json::Value| json!({ "kind": "point", "title": file, "material": material, "mode": "3d", "steps": steps });
    let props = [210_000.0, 0.3, 347.0, 2100.0];
    let theirs = case(json!({ "plugin": library, "props": props, "nstatv": STATES_OF_THE_FOREIGN_UMAT }));
    let table = [[347.0, 0.0], [347.0 + 2100.0 * 10.0, 10.0]];
    let ours = case(json!({ "plugin": "j2_plasticity", "props": { "E": 210_000.0, "nu": 0.3, "hardening": table } }));
    let theirs = desk.run(&desk.case("theirs.json", &theirs), &[], "theirs", 0);
    let ours = desk.run(&desk.case("ours.json", &ours), &[], "ours", 0);
    assert!(ours.peak("s11", "max") > 347.0);
    assert!(difference(&ours, &theirs) < 1e-12, "{file}: {:e}", difference(&ours, &theirs));
    assert!(Path::new(&theirs.folder).join("report.html").is_file());
}

/// Equivalent plastic strain and six plastic strains.
const STATES_OF_THE_FOREIGN_UMAT: usize = 7;

#[test]
fn plasticity_in_fortran_follows_the_plugin() {
    plasticity_in(Tool::Fortran, "j2.f90");
}

#[test]
fn plasticity_in_c_follows_the_plugin() {
    plasticity_in(Tool::C, "j2.c");
}

/// The pull-out case of the README ends with nothing left in the block.
#[test]
fn the_fibre_of_the_readme_is_pulled_out() {
    let desk = Desk::new();
    let case = blocks("json").into_iter().find(|block| block.contains("pullout")).expect("a pull-out case");
    let case = desk.write("fibre.json", &case);
    let coarse = ["mesh.specimen.embedded_elements=12", "output.plots=false", "output.vtu=false"];
    let run = desk.run(&case, &coarse, "fibre", 0);
    let (load, slip) = (run.history.column("load"), run.history.column("slip"));
    let peak = load.iter().fold(0.0_f64, |peak, load| peak.max(*load));
    // πφL times the greatest bond, and what friction adds
    assert!((29.0..33.0).contains(&peak), "{peak}");
    assert!(load.last().unwrap().abs() < 1e-6 * peak && *slip.last().unwrap() == 12.5);
    assert!(run.history.column("energy_error").iter().all(|error| error.abs() < 1e-3));
}

/// The study of the README: friction adds to the peak, and twice the length is twice the peak.
#[test]
fn the_study_of_the_readme_finds_its_claims() {
    let desk = Desk::new();
    let block = |part: &str| blocks("json").into_iter().find(|block| block.contains(part)).expect("a block");
    desk.write("fibre.json", &block("\"kind\": \"pullout\""));
    desk.write("friction.json", &block("\"kind\": \"study\""));
    let coarse = ["mesh.specimen.embedded_elements=12", "steps=[{\"slip\": 1}]"].map(|text| format!("--set={text}"));
    let arguments = ["study", "friction.json"].into_iter().chain(coarse.iter().map(String::as_str));
    let told = desk.pullout(arguments).expect(0).stdout;
    assert!(told.contains("4 of 4 runs done"), "{told}");
    let study: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(desk.path("out/friction/study.json")).expect("study.json"))
            .expect("JSON");
    let claims = study["claims"].as_array().expect("claims");
    assert!(claims.len() == 3 && claims.iter().all(|claim| claim["verdict"] == "found"), "{told}");
    assert!(desk.path("out/friction/plots/work_normalised.png").is_file());
}

/// The curve of the README gives its law back, and the case that is written runs.
#[test]
fn the_bond_law_of_the_readme_is_found() {
    let desk = Desk::new();
    let line = blocks("console").into_iter().find(|block| block.contains("fit bond")).expect("a fit");
    let words: Vec<&str> = line.trim().trim_start_matches("$ pullout ").split(' ').collect();
    let curve = workspace(words[2]);
    let mut arguments = words.clone();
    let curve = curve.to_string_lossy();
    arguments[2] = &curve;
    let said = desk.pullout(arguments.into_iter().chain(["--out", "fit"])).expect(0).stdout;
    assert!(said.contains("b_2"), "{said}");
    let found = program::json(&desk.path("fit/fit.json"));
    let number = |name: &str, key: &str| found["forms"]["powers"]["parameters"][name][key].as_f64().expect("a number");
    // the law in the head of the file; its joints are intersections
    for (name, value) in [
        ("k_e", 400.0),
        ("a_2", 1.0),
        ("b_2", -0.1772),
        ("g_crit", 0.003_999_6),
        ("tau_crit", 1.59985),
        ("g_peak", 0.020_008_9),
        ("tau_peak", 1.99997),
    ] {
        assert!((number(name, "value") / value - 1.0).abs() < 0.05, "{name}: {}", number(name, "value"));
    }
    for (name, value) in [("a_1", 3.44), ("b_1", 0.13865)] {
        assert!((number(name, "value") - value).abs() < 3.0 * number(name, "standard_error"), "{name}");
    }
    let run = desk.run(&desk.path("fit/powers-case.json"), &["output.plots=false", "output.vtu=false"], "again", 0);
    // the noise is what is left
    let rms = run.summary["compare"][0]["rms"].as_f64().expect("a comparison");
    assert!((0.015..0.025).contains(&(rms / run.peak("load", "max"))), "{rms}");
}

//! The command line's contract with scripts: exit codes, messages, files (docs/reference/command-line.md).

use crate::program::{Desk, Outcome, case_files, cases, command, copy_program_to, json, pullout_in};
use end_to_end_tests::shipped_laws;
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

/// Four increments of linear elasticity.
fn elastic() -> Value {
    json!({
        "kind": "point",
        "title": "elastic",
        "material": { "plugin": "linear_elastic", "props": { "E": 1000.0, "nu": 0.25 } },
        "mode": "3d",
        "steps": [ { "increments": 4, "target": { "e11": 0.001 } } ]
    })
}

#[test]
fn bad_input_is_exit_code_2_and_nothing_is_run() {
    const MALFORMED: [(&[&str], &str); 14] = [
        (&["kind=punkt"], "$.kind"),
        (&["tilte=x"], "$.tilte: unknown key; nearest valid name: 'title'"),
        (&["material.props.E=-1"], "$.material.props.E"),
        (&["material.props.e=1"], "$.material.props.e"),
        (&["material.props=[1]"], "$.material.props"),
        (&["steps=[]"], "$.steps"),
        (&["steps.0.increments=0"], "$.steps[0].increments: must be >= 1"),
        (&["steps.0.target.e12=1"], "nearest valid name: 'g12'"),
        (&["steps.0.target.s11=1"], "$.steps[0].target.s11"),
        (&["mode=plane_stress", "steps.0.target.s33=0"], "fixes s33 = s13 = s23 = 0"),
        (&[r#"steps.0={"table": "nowhere.csv"}"#], "$.steps[0].table"),
        (&[r#"until={"quantity": "s12x", "greater_than": 1}"#], "$.until.quantity"),
        (&["steps.0.increments=0", "titel=x", "material.colour=red"], "$.material.colour"),
        (&["steps.0.target.s11=1", "material.props.E=-1", "material.props.nu=0.5"], "$.material.props.nu"),
    ];
    let desk = Desk::new();
    desk.case("case.json", &elastic());
    for (overrides, expected) in MALFORMED {
        for verb in ["run", "check"] {
            let mut arguments = vec![verb, "case.json"];
            overrides.iter().for_each(|entry| arguments.extend(["--set", entry]));
            let outcome = desk.pullout(arguments).expect(2);
            assert!(outcome.stderr.contains("case.json: "), "{}", outcome.stderr);
            assert!(outcome.stderr.contains(expected), "{overrides:?}: {}", outcome.stderr);
            // all of them at once
            assert!(overrides.len() < 3 || outcome.stderr.lines().count() == 3, "{}", outcome.stderr);
            assert!(outcome.stdout.is_empty() && !desk.has_results(), "{overrides:?}");
        }
    }
}

/// A result folder that is a file, or would lie in one, is bad input: it is reported before anything runs.
#[test]
fn a_file_in_the_place_of_a_folder_is_exit_code_2() {
    let desk = Desk::new();
    desk.case("case.json", &elastic());
    desk.case(
        "sweep.json",
        &json!({ "kind": "sweep", "base": "case.json", "parameters": { "material.props.E": [1e3, 2e3] } }),
    );
    desk.write("data.csv", "e11,s11\n0,0\n0.0005,0.5\n0.001,1\n");
    desk.write("file", "mine");
    let fit = ["fit", "case.json", "--free", "material.props.E=1e2:1e4", "--data", "data.csv", "--curve", "e11,s11"];
    for out in ["file", "file/sub"] {
        for line in [&["run", "case.json"][..], &fit, &["sweep", "plan", "sweep.json"]] {
            let outcome = desk.pullout(line.iter().chain(&["--out", out])).expect(2);
            let is_reported = outcome.stderr.ends_with("file: is no folder\n") && outcome.stderr.lines().count() == 1;
            assert!(is_reported, "{line:?} {out}: {}", outcome.stderr);
            assert!(outcome.stdout.is_empty(), "{line:?} {out}: {}", outcome.stdout);
        }
    }
    assert_eq!(std::fs::read_to_string(desk.path("file")).expect("it stays"), "mine");
}

/// Runs `pullout ARGUMENTS` in the desk's folder with a pipe for its standard input, through which `text` comes.
fn fed(desk: &Desk, arguments: &[&str], text: &str) -> Outcome {
    let mut process = command();
    process.current_dir(desk.path("")).args(arguments).stdin(Stdio::piped());
    let mut child = process.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    child.stdin.take().expect("a pipe").write_all(text.as_bytes()).expect("it is read");
    let output = child.wait_with_output().expect("an end");
    Outcome {
        code: output.status.code().expect("an exit code"),
        stdout: String::from_utf8(output.stdout).expect("UTF-8"),
        stderr: String::from_utf8(output.stderr).expect("UTF-8"),
    }
}

#[test]
fn a_case_comes_through_a_pipe() {
    let desk = Desk::new();
    desk.write("path.csv", "e11\n0.001\n");
    for isolate in [false, true] {
        let mut case = elastic();
        case["material"]["isolate"] = json!(isolate);
        // relative to the working directory
        case["steps"] = json!([ { "table": "path.csv" } ]);
        let out = format!("out/{isolate}");
        fed(&desk, &["run", "--quiet", "/dev/stdin", "--out", &out], &case.to_string()).expect(0);
        assert_eq!(json(&desk.path(&out).join("summary.json"))["increments"], 1);
        fed(&desk, &["check", "/dev/fd/0"], &case.to_string()).expect(0);
        let outcome =
            fed(&desk, &["run", "/dev/stdin", "--set", "steps.0.table=nowhere.csv"], &case.to_string()).expect(2);
        assert!(
            outcome.stderr.starts_with("/dev/stdin: $.steps[0].table: nowhere.csv cannot be read"),
            "{}",
            outcome.stderr
        );
    }
    // a study reads its base for each run
    let study = json!({ "kind": "study", "base": "/dev/stdin", "members": [{ "label": "a" }] });
    desk.case("study.json", &study);
    let outcome = fed(&desk, &["study", "study.json"], &elastic().to_string()).expect(2);
    assert!(outcome.stderr.contains("$.base: /dev/stdin: is a pipe or a device"), "{}", outcome.stderr);
}

#[test]
fn files_that_are_no_cases_are_exit_code_2() {
    let desk = Desk::new();
    desk.write("cut.json", "{\"kind\":\n  \"point\",");
    desk.case("case.json", &elastic());
    let outcome = desk.pullout(["run", "cut.json"]).expect(2);
    assert!(outcome.stderr.starts_with("cut.json: line 2"), "{}", outcome.stderr);
    assert!(desk.pullout(["run", "nowhere.json"]).expect(2).stderr.contains("nowhere.json"));
    // one bad case of two: neither is run
    desk.pullout(["run", "case.json", "cut.json"]).expect(2);
    desk.pullout(["run"]).expect(2);
    desk.pullout(["walk", "case.json"]).expect(2);
    desk.pullout(["plot", "nowhere"]).expect(2);
    assert!(!desk.has_results());
    for word in ["--help", "--version"] {
        assert!(desk.pullout([word]).expect(0).stdout.contains("pullout"));
    }
}

/// Twenty steps and two curves name one file: it is a pipe, which is empty when it is read a second time.
#[test]
fn a_table_that_many_places_name_is_read_once() {
    let desk = Desk::new();
    let mut case = elastic();
    case["steps"] = json!(vec![json!({ "table": "/dev/stdin" }); 20]);
    let curve = json!({ "file": "/dev/stdin", "x": "e11", "y": "s11", "file_x": "e11", "file_y": "e22" });
    case["compare"] = json!([curve, curve]);
    let case = desk.case("case.json", &case);
    let arguments = ["run", "--quiet", "--set", "output.plots=false", "--out", "out", case.to_str().expect("UTF-8")];
    fed(&desk, &arguments, "e11,e22\n0.001,0\n0.002,0\n").expect(0);
    let summary = json(&desk.path("out/summary.json"));
    assert_eq!(summary["increments"], 40);
    assert_eq!(summary["compare"].as_array().map(Vec::len), Some(2), "{summary}");
}

/// What people try out of habit: refused with the option or the place, before anything runs, and with what to do instead.
#[test]
fn habits_of_other_programs_are_exit_code_2() {
    let desk = Desk::new();
    desk.case("case.json", &elastic());
    desk.case("study.json", &json!({ "kind": "study", "base": "case.json", "members": [{ "label": "a" }] }));
    desk.write("commented.json", &format!("{{\n  // of steel\n{}", &elastic().to_string()[1..]));
    desk.write("data.csv", "slip,load\n0,0\n1,1\n");
    let bond = ["fit", "bond", "data.csv", "--length", "12"];
    let refused: [(&[&str], &str); 7] = [
        (&[&bond[..], &["--diameter", "-1"]].concat(), "--diameter"),
        (&[&bond[..], &["--diameter", "0"]].concat(), "--diameter"),
        (&["run", "case.json", "--threads", "0"], "--threads"),
        (&["run", "case.json", "--threads", "-2"], "--threads"),
        (&["props", "j2_plasticity"], "pullout plugin info j2_plasticity"),
        (&["props", "concrete_damage_implex"], "pullout plugin info concrete_damage_implex"),
        (&["study", "case.json"], "`pullout run`"),
    ];
    for (arguments, place) in refused {
        let outcome = desk.pullout(arguments.iter()).expect(2);
        assert!(outcome.stderr.contains(place) && outcome.stdout.is_empty(), "{arguments:?}: {}", outcome.stderr);
    }
    for file in ["commented.json", "study.json"] {
        let outcome = desk.pullout(["run", file]).expect(2);
        assert!(outcome.stderr.contains(file), "{}", outcome.stderr);
    }
    assert!(!desk.has_results());
    // where results go has a short name
    desk.pullout(["run", "--quiet", "case.json", "-o", "there"]).expect(0);
    assert!(desk.path("there/history.csv").is_file());
}

#[test]
fn a_plugin_that_cannot_be_loaded_is_exit_code_3() {
    let desk = Desk::new();
    desk.case("case.json", &elastic());
    desk.write("text.so", "no library");
    for plugin in ["nowhere", "./nowhere.so", "./text.so"] {
        for verb in ["run", "check"] {
            let outcome = desk.pullout([verb, "case.json", "--set", &format!("material.plugin={plugin}")]).expect(3);
            assert!(outcome.stderr.contains("$.material.plugin: "), "{}", outcome.stderr);
            assert!(outcome.stderr.contains(plugin.trim_start_matches("./")), "{}", outcome.stderr);
        }
        desk.pullout(["plugin", "info", plugin]).expect(3);
        desk.pullout(["plugin", "check", plugin]).expect(3);
    }
    let outcome = desk.pullout(["run", "case.json", "--set", "material.symbol=absent_umat_"]).expect(3);
    assert!(
        outcome.stderr.contains("$.material.symbol: ") && outcome.stderr.contains("absent_umat_"),
        "{}",
        outcome.stderr
    );
    assert!(!desk.has_results());
}

#[test]
fn the_same_stem_twice_is_exit_code_2() {
    let desk = Desk::new();
    desk.case("case.json", &elastic());
    desk.case("other/case.json", &elastic());
    let outcome = desk.pullout(["run", "case.json", "other/case.json"]).expect(2);
    assert!(outcome.stderr.contains("the same name"), "{}", outcome.stderr);
    desk.pullout(["run", "case.json", "case.json", "--out", "out"]).expect(2);
    assert!(!desk.has_results());
}

#[test]
fn results_go_where_they_are_asked_for() {
    let desk = Desk::new();
    desk.case("first.json", &elastic());
    desk.case("second.json", &elastic());
    let there = |path: &str| desk.path(path).join("history.csv").is_file();
    assert!(desk.pullout(["run", "first.json"]).expect(0).stdout.contains("first: done, 4 increments"));
    assert!(there("out/first"));
    desk.pullout(["run", "first.json", "--out", "one"]).expect(0);
    assert!(there("one"));
    desk.pullout(["run", "first.json", "second.json", "--out", "many"]).expect(0);
    assert!(there("many/first") && there("many/second") && !there("many"));
}

#[test]
fn several_cases_all_run_and_the_largest_code_counts() {
    let desk = Desk::new();
    let mut failing = elastic();
    failing["material"] = json!({ "plugin": "concrete_damage" });
    failing["steps"] = json!([ { "increments": 5, "target": { "s11": 4.0 } } ]);
    desk.case("failing.json", &failing);
    desk.case("sound.json", &elastic());
    desk.pullout(["run", "failing.json", "sound.json"]).expect(1);
    assert_eq!(json(&desk.path("out/failing/summary.json"))["status"], "failed");
    assert_eq!(json(&desk.path("out/sound/summary.json"))["status"], "done");
}

#[test]
fn overrides_reach_every_case() {
    let desk = Desk::new();
    for name in ["first.json", "second.json"] {
        desk.case(name, &elastic());
    }
    let overrides = ["--set", "steps.0.increments=7", "--set", "title=seven", "--set", "controls.max_iterations=3"];
    desk.pullout([&["run", "first.json", "second.json"][..], &overrides].concat()).expect(0);
    for name in ["first", "second"] {
        let summary = json(&desk.path(&format!("out/{name}/summary.json")));
        assert_eq!((&summary["increments"], &summary["title"]), (&json!(7), &json!("seven")));
    }
}

#[test]
fn quiet_prints_nothing() {
    let desk = Desk::new();
    desk.case("case.json", &elastic());
    let outcome = desk.pullout(["run", "--quiet", "case.json"]).expect(0);
    assert_eq!((outcome.stdout.as_str(), outcome.stderr.as_str()), ("", ""));
    // a run long enough for progress lines
    let long = ["--set", "steps.0.increments=400000", "--set", "output.every=400000", "--set", "output.plots=false"];
    let outcome = desk.pullout([&["run", "--quiet", "case.json"][..], &long].concat()).expect(0);
    assert_eq!((outcome.stdout.as_str(), outcome.stderr.as_str()), ("", ""));
}

#[test]
fn a_reader_that_went_away_is_no_panic() {
    let desk = Desk::new();
    desk.case("case.json", &elastic());
    let case = desk.path("case.json");
    let case = case.to_str().expect("UTF-8");
    let calls: [(&[&str], i32); 7] = [
        (&["plugin", "list"], 0),
        (&["plugin", "info", "bond_slip"], 0),
        (&["schema"], 0),
        (&["--help"], 0),
        (&["run", case], 0),
        (&["run", case, "--set", "titel=x"], 2),
        (&["props", "concrete_damage", "--E", "31800", "--nu", "0.18", "--ft", "3.5", "--fc", "34.8"], 0),
    ];
    for (arguments, code) in calls {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let mut process = command();
        process.current_dir(desk.path("")).args(arguments).stderr(writer.try_clone().expect("a pipe")).stdout(writer);
        assert_eq!(process.status().expect("the program starts").code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn every_law_is_listed_and_described() {
    let desk = Desk::new();
    let list = desk.pullout(["plugin", "list", "--plugin-path", "/nowhere/at/all"]).expect(0).stdout;
    let searched = list.split("Searched:").nth(1).expect("the folders");
    assert!(searched.contains("/nowhere/at/all (does not exist)") && searched.lines().count() > 3, "{list}");
    for law in &shipped_laws() {
        // next to its own library there is the one of all laws
        let library = format!("{}{law}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
        let own = |line: &&str| line.split_whitespace().next() == Some(law) && line.ends_with(&library);
        let line = list.lines().find(own).expect(law);
        let fields: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(fields[1], "0.1.0");
        assert!(fields[2..].contains(&if law == "bond_slip" { "fric" } else { "umat" }), "{line}");
        let file = fields.last().expect("the library's file");
        let by_name = desk.pullout(["plugin", "info", law]).expect(0).stdout;
        assert_eq!(by_name, desk.pullout(["plugin", "info", file]).expect(0).stdout);
        for expected in [law, "PROPS (", "STATEV (", "default", "bounds", "MPa", "Modes: ", "dissipated_energy"] {
            assert!(by_name.contains(expected), "{law}: {expected}\n{by_name}");
        }
    }
    let info = desk.pullout(["plugin", "info", "inelastic_damage"]).expect(0).stdout;
    for expected in ["kappa", "alpha", "0 (rational)", "3d (NTENS 6)", "plane_stress (NTENS 3)", "Derived: D from eta"]
    {
        assert!(info.contains(expected), "{expected}\n{info}");
    }
}

#[test]
fn every_shipped_law_passes_the_check() {
    let desk = Desk::new();
    for law in &shipped_laws() {
        let Outcome { stdout: report, stderr, .. } = desk.pullout(["plugin", "check", law, "--states", "60"]).expect(0);
        assert!(report.contains(": none failed"), "{law}\n{report}");
        // the rows hold its messages about input that makes no sense
        assert!(stderr.is_empty() && report.contains("the plugin says '"), "{law}: {stderr}\n{report}");
    }
    // with a case's parameters and mode
    let case = cases().join("examples/crack-band-50mm.json");
    let arguments = ["plugin", "check", "concrete_damage", "--states", "60", "--case", case.to_str().expect("UTF-8")];
    desk.pullout(arguments).expect(0);
    desk.pullout(["plugin", "check", "pure_damage", "--case", case.to_str().expect("UTF-8")]).expect(2);
    // the case's library, spelled in another way
    let library = end_to_end_tests::plugin("linear_elastic");
    std::fs::create_dir(desk.path("lib")).expect("a folder");
    std::fs::copy(&library, desk.path("lib").join(library.file_name().expect("a name"))).expect("a copy");
    let [name, other] = ["./lib", "./lib/../lib"]
        .map(|folder| format!("{folder}/{}", library.file_name().expect("a name").to_string_lossy()));
    let mut case = elastic();
    case["material"]["plugin"] = json!(name);
    desk.case("spelled.json", &case);
    desk.pullout(["plugin", "check", &other, "--states", "20", "--case", "spelled.json"]).expect(0);
}

#[test]
fn faulty_plugins_fail_the_check() {
    let desk = Desk::new();
    for (plugin, check) in [
        ("halved_interface_tangent", "consistent tangent"),
        ("halved_tangent", "consistent tangent"),
        ("hidden_memory", "repeated call"),
        ("panicking", "answers"),
        ("secant_tangent", "consistent tangent"),
        ("state_overrun", "array bounds"),
        ("unset_entry", "tangent entries set"),
    ] {
        let report = desk.pullout(["plugin", "check", plugin, "--states", "60"]).expect(1).stdout;
        let found = |line: &str| line.to_lowercase().starts_with("fail") && line.contains(check);
        assert!(report.lines().any(found), "{plugin}: {check}\n{report}");
    }
}

#[test]
fn the_schema_accepts_every_shipped_case() {
    let desk = Desk::new();
    let schema: Value = serde_json::from_str(&desk.pullout(["schema"]).expect(0).stdout).expect("JSON");
    assert!(schema["$schema"].as_str().is_some_and(|text| text.contains("2020-12")), "{}", schema["$schema"]);
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    for file in case_files() {
        let case = json(&file);
        let errors: Vec<String> = validator.iter_errors(&case).map(|error| error.to_string()).collect();
        assert!(errors.is_empty(), "{}: {errors:?}", file.display());
        let mut wrong = case;
        wrong["unknown key"] = json!(1);
        assert!(!validator.is_valid(&wrong), "{}", file.display());
    }
    let files: Vec<String> = case_files().iter().map(|file| file.display().to_string()).collect();
    let arguments = ["check".to_owned()].into_iter().chain(files);
    let checked = pullout_in(&desk.path(""), arguments).expect(0).stdout;
    assert_eq!(checked.lines().count(), case_files().len());
}

#[test]
fn calibrated_parameters_reproduce_the_strengths() {
    let desk = Desk::new();
    for (youngs_modulus, tensile, compressive) in [("31800", 3.5, 34.8), ("23700", 2.4, 34.8)] {
        let (ft, fc) = (tensile.to_string(), compressive.to_string());
        let arguments = ["props", "concrete_damage", "--E", youngs_modulus, "--nu", "0.18", "--ft", &ft, "--fc", &fc];
        let material: Value = serde_json::from_str(&desk.pullout(arguments).expect(0).stdout).expect("JSON");
        let mut case = elastic();
        case["material"] = material;
        for (name, end, strength, which) in [("t", 4e-4, tensile, "max"), ("c", -5e-3, -compressive, "min")] {
            case["steps"] = json!([ { "increments": 4000, "target": { "e11": end } } ]);
            let run = desk.run(&desk.case(&format!("{name}.json"), &case), &["output.plots=false"], name, 0);
            let peak = run.peak("s11", which);
            assert!((peak / strength - 1.0).abs() < 1e-5, "{name}: {peak} for {strength}");
        }
    }
    desk.pullout(["props", "concrete_damage", "--E", "31800", "--nu", "0.18", "--ft", "-3.5", "--fc", "34.8"])
        .expect(2);
    // a class is its values, of which some may be given
    let printed =
        |arguments: &[&str]| desk.pullout([&["props", "concrete_damage"], arguments].concat()).expect(0).stdout;
    let values = ["--E", "30000", "--nu", "0.2", "--ft", "3.5088213", "--fc", "48", "--Gf", "0.14654"];
    let [of_class, of_values] = [&["--class", "C40", "--E", "30000"][..], &values].map(printed);
    let number = |text: &str, name: &str| {
        serde_json::from_str::<Value>(text).expect("JSON")["props"][name].as_f64().expect("a number")
    };
    for name in ["E", "nu", "A_t", "Y_t0", "A_c", "Y_c0", "beta", "G_f"] {
        let [class, value] = [&of_class, &of_values].map(|text| number(text, name));
        assert!((class / value - 1.0).abs() < 1e-4, "{name}: {class}, not {value}");
    }
    assert!(desk.pullout(["props", "concrete_damage", "--class", "B40"]).expect(2).stderr.contains("--class"));
    desk.pullout(["props", "concrete_damage", "--E", "31800"]).expect(2);
}

#[test]
fn pictures_of_two_runs_are_overlaid() {
    let desk = Desk::new();
    for (name, modulus) in [("soft", 500.0), ("stiff", 2000.0)] {
        let mut case = elastic();
        case["title"] = json!(format!("{name} one"));
        case["material"]["props"]["E"] = json!(modulus);
        desk.case(&format!("{name}.json"), &case);
    }
    desk.pullout(["run", "--quiet", "soft.json", "stiff.json"]).expect(0);
    let picture = |path: &str| std::fs::read_to_string(desk.path(path)).expect("a picture");
    let before = picture("out/soft/plots/stress_strain.svg");
    assert!(!before.contains("stiff one"));
    desk.pullout(["plot", "out/soft", "out/stiff", "--out", "both"]).expect(0);
    let both = picture("both/stress_strain.svg");
    assert!(both.contains("soft one") && both.contains("stiff one"));
    assert_eq!(before, picture("out/soft/plots/stress_strain.svg"));
    // redrawn alone it is the same picture
    std::fs::remove_file(desk.path("out/soft/plots/stress_strain.svg")).expect("a picture");
    desk.pullout(["plot", "out/soft"]).expect(0);
    assert_eq!(before, picture("out/soft/plots/stress_strain.svg"));
}

/// A folder as the user's own: relative paths in a case do not depend on where the program is started.
#[test]
fn paths_are_relative_to_the_case_file() {
    let desk = Desk::new();
    let mut case = elastic();
    case["steps"] = json!([ { "table": "../tables/path.csv" } ]);
    desk.write("tables/path.csv", "e11\n0.001\n");
    desk.case("cases/case.json", &case);
    desk.pullout(["run", "cases/case.json"]).expect(0);
    pullout_in(Path::new("/"), ["run".into(), desk.path("cases/case.json"), "--out".into(), desk.path("else")])
        .expect(0);
    assert!(desk.path("else/history.csv").is_file());
}

/// `pullout_laws` holds every law; CMNAME chooses.
#[test]
fn the_library_of_all_laws_is_driven_by_cmname() {
    let desk = Desk::new();
    for (name, stresses) in [("5.3-compression-concrete-damage", "s11"), ("5.3-tension-model-iv", "s11")] {
        let file = cases().join(format!("chapter-5/{name}.json"));
        let single = desk.run(&file, &["compare=[]"], "single", 0);
        let law = json(&file)["material"]["plugin"].as_str().expect("a name").to_owned();
        let cmname = format!("material.cmname={}-C30", law.to_uppercase());
        let together = desk.run(&file, &["compare=[]", "material.plugin=pullout_laws", &cmname], "together", 0);
        assert_eq!(single.history.columns, together.history.columns);
        assert_eq!(single.history.column(stresses), together.history.column(stresses));
    }
    let case = desk.case("case.json", &elastic());
    let case = case.to_str().expect("UTF-8");
    let library = "material.plugin=pullout_laws";
    let outcome = desk.pullout(["check", case, "--set", library]).expect(2);
    assert!(outcome.stderr.contains("$.material.cmname: is missing"), "{}", outcome.stderr);
    let outcome = desk.pullout(["check", case, "--set", library, "--set", "material.cmname=GRANITE"]).expect(2);
    assert!(outcome.stderr.contains("$.material.cmname: "), "{}", outcome.stderr);
    let list = desk.pullout(["plugin", "list"]).expect(0).stdout;
    let together: Vec<&str> = list.lines().filter(|line| line.contains("libpullout_laws")).collect();
    for law in &shipped_laws() {
        assert!(together.iter().any(|line| line.starts_with(law)), "{law} is not in pullout_laws:\n{list}");
    }
}

#[test]
fn a_program_that_was_copied_without_its_laws_finds_them_where_they_were_built() {
    let desk = Desk::new();
    desk.case("case.json", &elastic());
    let program = desk.path("bin").join("pullout");
    std::fs::create_dir(desk.path("bin")).expect("a folder");
    copy_program_to(&program);
    let printed = |arguments: &[&str]| {
        let mut process = std::process::Command::new(&program);
        let process = process.env_remove("PULLOUT_PLUGIN_PATH").current_dir(desk.path("")).args(arguments);
        let output = process.output().expect("the program starts");
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{text}");
        text
    };
    assert!(printed(&["plugin", "info", "linear_elastic"]).contains("Process: pullout's own"));
    printed(&["run", "--quiet", "case.json"]);
    // a library next to it is tried first, and judged as it is
    std::fs::write(desk.path("bin").join("libpullout_utilities.so"), "no library").expect("a file");
    let output = std::process::Command::new(&program).args(["plugin", "info", "linear_elastic"]).output();
    let output = output.expect("the program starts");
    assert_eq!(output.status.code(), Some(3), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cargo xtask install"));
}

#[test]
fn measurements_are_a_program_of_their_own() {
    let desk = Desk::new();
    let program = desk.path("pullout");
    copy_program_to(&program);
    let bench = || {
        let output = std::process::Command::new(&program).args(["bench", "laws", "--quick"]).output();
        output.expect("the program starts")
    };
    let output = bench();
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("`cargo run --release -p pullout-bench -- laws --quick`"), "{stderr}");
    // the program next to it is started
    std::os::unix::fs::symlink("/bin/echo", desk.path("pullout-bench")).expect("a link");
    assert_eq!(String::from_utf8_lossy(&bench().stdout), "laws --quick\n");
}

#[test]
fn manual_pages_and_completions_list_the_commands_and_hide_what_is_hidden() {
    let desk = Desk::new();
    desk.pullout(["pages", "share"]).expect(0);
    let read = |file: &str| std::fs::read_to_string(desk.path("share").join(file)).expect(file);
    assert!(read("man/man1/pullout.1").contains("pullout\\-run(1)"));
    assert!(read("man/man1/pullout-plugin-check.1").contains("\\-\\-plugin\\-path"));
    for file in
        ["bash-completion/completions/pullout", "zsh/site-functions/_pullout", "fish/vendor_completions.d/pullout.fish"]
    {
        let text = read(file);
        assert!(text.contains("plugin-path") && text.contains("study"), "{file}");
        for hidden in ["worker", "pages", "before-run", "aftermath"] {
            assert!(!text.contains(hidden), "{file}: {hidden}");
        }
    }
    assert!(!desk.path("share/man/man1/pullout-pages.1").exists());
}

#[test]
fn slips_of_units_and_defaults_are_reported_by_check() {
    let desk = Desk::new();
    let mut case = elastic();
    case["material"]["props"] = json!({ "E": 31.8 });
    desk.case("case.json", &case);
    let outcome = desk.pullout(["check", "case.json"]).expect(0);
    assert!(outcome.stderr.contains("case.json: note: defaults used: material.props: nu = 0.18"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("material.props.E = 31.8 MPa is outside the usual range"), "{}", outcome.stderr);
    assert_eq!(outcome.stdout, "case.json: no errors\n");
    let quiet = desk.pullout(["check", "--quiet", "case.json"]).expect(0);
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty(), "{}", quiet.stderr);
    desk.pullout(["run", "--quiet", "case.json"]).expect(0);
    let report = std::fs::read_to_string(desk.path("out/case/report.html")).expect("a report");
    assert!(report.contains("material.props: nu = 0.18") && report.contains("outside the usual range"));
    let calibrated = ["--E", "31800", "--nu", "0.18", "--ft", "3500", "--fc", "40"];
    let outcome = desk.pullout(["props", "concrete_damage"].iter().chain(&calibrated));
    assert!(outcome.stderr.contains("--ft 3500 is outside the usual range"), "{}", outcome.stderr);
    for (options, words) in [
        (&["--E", "31800", "--nu", "0.18", "--ft", "42", "--fc", "3.2"][..], "f_t must not exceed f_c"),
        (&["--class", "C30/25"][..], "--class C30/25 is no class of the Model Code: is it C30/37?"),
    ] {
        let outcome = desk.pullout(["props", "concrete_damage"].iter().chain(options)).expect(2);
        assert!(outcome.stdout.is_empty() && outcome.stderr.contains(words), "{}", outcome.stderr);
    }
}

#[test]
fn nothing_to_do_names_what_to_type_and_a_lone_file_its_command() {
    let desk = Desk::new();
    let alone = desk.pullout([""; 0]).expect(0);
    assert!(["pullout lab", "pullout new", "pullout examples"].iter().all(|command| alone.stdout.contains(command)));
    desk.case("case.json", &elastic());
    desk.case("family.json", &json!({ "kind": "study", "base": "case.json", "members": [{ "label": "a" }] }));
    desk.write("umat.f", "      END\n");
    for (file, command) in [
        ("case.json", "pullout run case.json"),
        ("family.json", "pullout study family.json"),
        ("umat.f", "pullout lab umat.f"),
    ] {
        let outcome = desk.pullout([file]).expect(2);
        assert!(outcome.stderr.contains(command), "{}", outcome.stderr);
    }
    assert!(!desk.pullout(["nothing.json"]).expect(2).stderr.contains("pullout run"));
    assert!(!desk.has_results());
}

#[test]
fn new_files_are_those_of_the_book_and_never_replace_others() {
    let desk = Desk::new();
    let kinds = ["point", "umat", "umat-c", "law", "bond", "fibre", "hooked-fibre", "beam", "study", "sweep"];
    for kind in kinds {
        let outcome = desk.pullout(["new", kind, kind]).expect(0);
        let files: Vec<&str> = outcome.stdout.lines().take_while(|line| !line.is_empty()).collect();
        assert!(!files.is_empty() && files.iter().all(|file| desk.path(file).is_file()), "{}", outcome.stdout);
        // their libraries are not built yet, and sweeps are checked by their plan
        for case in files
            .iter()
            .filter(|file| file.ends_with(".json") && !file.contains("umat") && !file.ends_with("bonds.json"))
        {
            desk.pullout(["check", "--quiet", case]).expect(0);
        }
    }
    desk.write("kept/umat.json", "mine");
    let refused = desk.pullout(["new", "umat", "kept"]).expect(2);
    assert!(refused.stderr.contains("umat.json") && !desk.path("kept/my_umat.f").exists());
    assert_eq!(std::fs::read_to_string(desk.path("kept/umat.json")).expect("a file"), "mine");
}

#[test]
fn examples_are_listed_with_what_they_show() {
    let desk = Desk::new();
    let all = desk.pullout(["examples"]).expect(0).stdout;
    let listed = all.lines().filter(|line| line.contains(".json")).count();
    assert!(listed > 100 && all.contains("6.16-full-pull-out.json"), "{all}");
    let some = desk.pullout(["examples", "AXISYMMETRIC", "fig. 6.14"]).expect(0).stdout;
    assert!(some.contains("6.14-axisymmetric.json") && some.lines().count() < 12, "{some}");
    desk.pullout(["examples", "no such word"]).expect(2);
}

#[test]
fn summaries_are_one_line_of_json_each_and_nothing_else() {
    let desk = Desk::new();
    desk.case("one.json", &elastic());
    let mut failing = elastic();
    // the stress-free lateral strain of a state that is nowhere
    failing["material"] = json!({ "plugin": "j2_plasticity", "props": { "hardening": [[1.0, 0.0]] } });
    failing["steps"] = json!([{ "increments": 1, "target": { "s11": 100.0 } }]);
    desk.case("two.json", &failing);
    let outcome = desk.pullout(["run", "one.json", "two.json", "--json"]).expect(1);
    let lines: Vec<Value> =
        outcome.stdout.lines().map(|line| serde_json::from_str(line).expect("an object a line")).collect();
    let [one, two] = &lines[..] else { panic!("{}", outcome.stdout) };
    assert_eq!((&one["case"], &one["folder"]), (&json!("one.json"), &json!("out/one")));
    assert_eq!((&one["status"], &two["status"]), (&json!("done"), &json!("failed")));
    assert_eq!(one["peaks"]["s11"]["max"], json!(1.0), "E ε");
    let kept = json(&desk.path("out/one/summary.json"));
    for (key, value) in kept.as_object().expect("an object") {
        assert_eq!(&one[key], value, "{key}");
    }
    // what is refused has none, not even that of an earlier run
    let refused = desk.pullout(["run", "one.json", "--json", "--set", "steps.0.increments=0"]).expect(2);
    assert_eq!(refused.stdout, "");
}

#[test]
fn other_commands_print_json() {
    let desk = Desk::new();
    let list: Value = serde_json::from_str(&desk.pullout(["plugin", "list", "--json"]).expect(0).stdout).expect("JSON");
    let law = list["laws"].as_array().expect("laws").iter().find(|law| law["name"] == "bond_slip").expect("a law");
    assert_eq!(law["entry_points"], json!(["uinter", "fric"]));
    assert!(law["version"].is_string() && law["library"].as_str().is_some_and(|file| Path::new(file).is_file()));
    assert!(list["searched"][0]["folder"].is_string() && list["searched"][0]["exists"].is_boolean());
    desk.case("base.json", &elastic());
    let study = json!({
        "kind": "study", "base": "base.json", "series": [{ "name": "all" }],
        "members": [{ "label": "soft", "x": 1.0 }, { "label": "stiff", "x": 2.0, "set": { "material.props.E": 2000.0 } }],
        "x": { "name": "E" },
        "claims": [{ "claim": "it grows", "expect": { "trend": "increasing" } }],
    });
    desk.case("family.json", &study);
    let said = desk.pullout(["study", "family.json", "--json"]).expect(0).stdout;
    let said: Value = serde_json::from_str(&said).expect("one object");
    assert_eq!((&said["study"], &said["folder"]), (&json!("family.json"), &json!("out/family")));
    assert_eq!((&said["runs"][1]["peak"], said["claims"].as_array().map(Vec::len)), (&json!(2.0), Some(1)));
    desk.case("sweep.json", &json!({ "kind": "sweep", "base": elastic(), "parameters": { "material.props.E": [1.0, 2.0] }, "quantities": { "peak": "peak" } }));
    desk.pullout(["sweep", "plan", "sweep.json", "--out", "store"]).expect(0);
    let status = || -> Value {
        serde_json::from_str(&desk.pullout(["sweep", "status", "store", "--json"]).expect(0).stdout).expect("JSON")
    };
    assert_eq!(
        status(),
        json!({ "folder": "store", "runs": 2, "finished": 0, "endings": {}, "to_do": 2, "cpu_s": 0.0, "wall_s": 0.0 })
    );
    desk.pullout(["sweep", "work", "store", "--in-process", "--quiet"]).expect(0);
    let done = status();
    assert_eq!((&done["finished"], &done["to_do"], &done["endings"]), (&json!(2), &json!(0), &json!({ "done": 2 })));
    assert!(done["wall_s"].as_f64().is_some_and(|time| time > 0.0));
}

#[test]
fn a_report_is_opened_or_its_place_is_printed() {
    use std::os::unix::fs::PermissionsExt;
    let desk = Desk::new();
    desk.case("case.json", &elastic());
    let browser = desk.write("bin/xdg-open", "#!/bin/sh\nprintf %s \"$1\" > opened\n");
    std::fs::set_permissions(&browser, PermissionsExt::from_mode(0o755)).expect("a program");
    let run = |display: Option<&str>| {
        let mut run = command();
        run.current_dir(desk.path("")).args(["run", "case.json", "--quiet", "--open"]);
        run.env("PATH", desk.path("bin")).env_remove("WAYLAND_DISPLAY").env_remove("BROWSER").env_remove("DISPLAY");
        display.map(|display| run.env("DISPLAY", display));
        String::from_utf8(run.output().expect("the program starts").stderr).expect("UTF-8")
    };
    assert!(run(None).contains("out/case/report.html"));
    assert!(!desk.path("opened").exists());
    run(Some(":9"));
    let opened = (0..6000).find_map(|_| {
        std::thread::sleep(std::time::Duration::from_millis(10));
        std::fs::read_to_string(desk.path("opened")).ok().filter(|opened| !opened.is_empty())
    });
    assert_eq!(opened.as_deref(), Some("out/case/report.html"));
}

//! The files that a run leaves: columns, lines, and what is kept of a run that fails or is killed.

use crate::program::{Desk, Table, command, json, send};
use end_to_end_tests::{Tool, find};
use rustix::process::Signal;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

fn point(material: Value, steps: Value) -> Value {
    json!({ "kind": "point", "title": "a point", "material": material, "mode": "3d", "steps": steps })
}

fn interface(material: Value, steps: Value) -> Value {
    json!({ "kind": "interface", "title": "an interface", "material": material, "steps": steps })
}

fn elastic() -> Value {
    json!({ "plugin": "linear_elastic", "props": { "E": 1000.0, "nu": 0.25 } })
}

#[test]
fn columns_of_a_material_point() {
    let desk = Desk::new();
    let case = point(json!({ "plugin": "pure_damage" }), json!([ { "increments": 1, "target": { "e11": 1e-5 } } ]));
    let run = desk.run(&desk.case("case.json", &case), &[], "out", 0);
    let expected = "step,increment,time,e11,e22,e33,g12,g13,g23,s11,s22,s33,s12,s13,s23,eta,Y_max,strain_33,\
                    dissipated_energy,D,sse,spd,scd,iterations";
    assert_eq!(run.history.columns.join(","), expected);
    assert_eq!(run.history.rows[0][..3], [0.0, 0.0, 0.0]);
    // in plane stress e33 comes from the law
    let run = desk.run(&desk.path("case.json"), &["mode=plane_stress"], "plane", 0);
    assert_eq!(run.history.columns.join(","), expected);
    assert!((run.history.last("e33") / -0.18e-5 - 1.0).abs() < 1e-12);
}

#[test]
fn columns_of_large_deformation() {
    let desk = Desk::new();
    let steps = json!([ { "increments": 2, "F": [[1.1, 0, 0], [0, 1, 0], [0, 0, 1]] } ]);
    let mut case = point(elastic(), steps);
    case["nlgeom"] = json!(true);
    let run = desk.run(&desk.case("case.json", &case), &[], "out", 0);
    let expected = "s13,s23,F11,F12,F13,F21,F22,F23,F31,F32,F33,strain_33,dissipated_energy,sse,spd,scd,iterations";
    assert!(run.history.columns.join(",").ends_with(expected), "{:?}", run.history.columns);
    assert_eq!(run.history.column("F11"), [1.0, 1.05, 1.1]);
}

#[test]
fn columns_of_a_contact_point() {
    let desk = Desk::new();
    let states = "slip_1,slip_2,side,kappa,g_pl_1,g_pl_2,g_s_1,g_s_2,open,opening,d,dissipated_energy";
    for entry in ["uinter", "fric"] {
        let material = json!({ "plugin": "bond_slip", "entry": entry, "props": { "normal_stiffness": 1e5 } });
        let case = interface(material, json!([ { "increments": 2, "target": { "slip": 0.1, "p": 3.0 } } ]));
        let run = desk.run(&desk.case(&format!("{entry}.json"), &case), &[], entry, 0);
        let columns = run.history.columns.join(",");
        assert_eq!(columns, format!("step,increment,time,slip,gap,tau,p,{states},sed,sfd,spd,svd,scd,iterations"));
        assert!((run.history.last("p") - 3.0).abs() < 1e-7);
        assert_eq!(run.history.column("gap").iter().all(|gap| gap.is_nan()), entry == "fric");
    }
}

#[test]
fn numbers_are_read_and_written_exactly() {
    let desk = Desk::new();
    // both need correct rounding: a fast parser is off by the last bit
    let (strain, modulus) = (0.000_199_334_792_362_374_94, 31_800.000_000_000_004);
    let material = json!({ "plugin": "linear_elastic", "props": { "E": modulus, "nu": 0.0 } });
    let case = point(material, json!([ { "increments": 1, "target": { "e11": strain } } ]));
    let run = desk.run(&desk.case("case.json", &case), &[], "out", 0);
    assert_eq!(run.history.last("e11").to_bits(), f64::to_bits(strain));
    assert!((run.history.last("s11") / (modulus * strain) - 1.0).abs() < 1e-15);
    let text = std::fs::read_to_string(run.folder.join("history.csv")).expect("a history");
    assert!(text.contains(",0.00019933479236237494,"), "{text}");
}

#[test]
fn pictures_have_the_words_of_the_case_and_the_report_a_date() {
    let desk = Desk::new();
    let mut case = point(elastic(), json!([{ "increments": 2, "target": { "e11": 1e-3 } }]));
    case["output"] = json!({ "plots": { "stress_strain": { "title": "A bar of rubber", "legend": { "s11": "bar" } }, "stress_strian": {} } });
    let run = desk.run(&desk.case("case.json", &case), &[], "out", 0);
    let picture = std::fs::read_to_string(desk.path("out/plots/stress_strain.svg")).expect("a picture");
    assert!(picture.contains("A bar of rubber"));
    let warnings = run.summary["warnings"].as_array().expect("a list");
    assert!(
        warnings
            .iter()
            .any(|warning| warning.as_str().is_some_and(|words| words.contains("output.plots.stress_strian")))
    );
    let report = std::fs::read_to_string(desk.path("out/report.html")).expect("a report");
    let date = report.split("Date</td><td>").nth(1).and_then(|rest| rest.split('<').next()).expect("a date");
    assert!(date.ends_with(" UTC") && date.len() == "2026-01-31 12:05 UTC".len(), "{date}");
    let misspelt =
        desk.pullout(["check", "case.json", "--set", "output.plots.stress_strain={\"titel\": \"x\"}"]).expect(2);
    assert!(misspelt.stderr.contains("output.plots"), "{}", misspelt.stderr);
}

#[test]
fn a_table_makes_one_line_per_row() {
    let desk = Desk::new();
    let values = [0.001, 0.0007000000000000001, -0.3e-3, 0.0];
    let rows: Vec<String> = values.iter().zip([0.5, 0.75, 3.0, 10.0]).map(|(e, t)| format!("{t}, {e}, 2")).collect();
    desk.write("path.csv", &format!("# measured\ntime, e11, s22\n{}\n", rows.join("\n# a remark\n")));
    let steps = json!([ { "increments": 2, "target": { "e11": 1e-4, "s22": 2 } }, { "table": "path.csv" } ]);
    let run = desk.run(&desk.case("case.json", &point(elastic(), steps)), &[], "out", 0);
    assert_eq!(run.history.column("step"), [0.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0]);
    assert_eq!(run.history.column("increment"), [0.0, 1.0, 2.0, 1.0, 2.0, 3.0, 4.0]);
    // step time in the table, total time in the history
    assert_eq!(run.history.column("time"), [0.0, 0.5, 1.0, 1.5, 1.75, 4.0, 11.0]);
    assert_eq!(run.history.column("e11")[3..], values);
    assert!(run.history.column("s22")[3..].iter().all(|s| (s - 2.0).abs() < 1e-7));
}

#[test]
fn a_table_of_a_contact_point() {
    let desk = Desk::new();
    let slips = [0.0005, 0.1, 0.05, -0.01];
    let text: String = slips.iter().map(|slip| format!("{slip}\n")).collect();
    desk.write("path.csv", &format!("slip\n{text}"));
    let case = interface(json!({ "plugin": "bond_slip" }), json!([ { "table": "path.csv" } ]));
    let run = desk.run(&desk.case("case.json", &case), &[], "out", 0);
    assert_eq!(run.history.column("slip")[1..], slips);
    assert_eq!(run.history.column("time"), [0.0, 1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn a_thinned_history_keeps_the_ends_and_all_peaks() {
    let desk = Desk::new();
    let steps = json!([
        { "increments": 20, "target": { "e11": 0.001 } },
        { "increments": 5, "target": { "e11": 0.0 } },
    ]);
    let run = desk.run(&desk.case("case.json", &point(elastic(), steps)), &["output.every=7"], "out", 0);
    assert_eq!(run.history.column("increment"), [0.0, 7.0, 14.0, 20.0, 5.0]);
    assert_eq!(run.summary["increments"], 25);
    assert!((run.peak("s11", "max") - 1.0).abs() < 1e-12);
}

#[test]
fn until_keeps_its_row_and_ends_well() {
    let desk = Desk::new();
    let mut case = point(
        elastic(),
        json!([
            { "increments": 10, "target": { "e11": -0.01 }, "until": { "quantity": "s11", "less_than": -3.5 } },
            { "increments": 10, "target": { "e11": -0.02 } },
            { "increments": 10, "target": { "e11": 0.0 } },
        ]),
    );
    case["until"] = json!({ "quantity": "abs(e11)", "greater_than": 0.01 });
    let run = desk.run(&desk.case("case.json", &case), &[], "out", 0);
    // step 1 ends at e11 = -0.004; the ramp of step 2 starts there and passes 0.01 in its fourth increment
    assert_eq!(run.history.column("step").iter().filter(|&&step| step == 1.0).count(), 4);
    assert_eq!((run.history.last("step"), run.history.last("increment")), (2.0, 4.0));
    assert!((run.history.last("e11") + 0.0104).abs() < 1e-15);
    assert_eq!(run.summary["status"], "done");
}

#[test]
fn cycles_count_their_steps_on() {
    let desk = Desk::new();
    let steps = json!([
        { "increments": 1, "target": { "e11": 0.001 } },
        { "repeat": 3, "steps": [
            { "increments": 2, "target": { "e11": 0.002 } },
            { "increments": 1, "target": { "e11": 0.0 } },
        ] },
        { "increments": 1, "target": { "e11": 0.001 } },
    ]);
    let run = desk.run(&desk.case("case.json", &point(elastic(), steps)), &[], "out", 0);
    assert_eq!(run.history.column("step"), [0.0, 1.0, 2.0, 2.0, 3.0, 4.0, 4.0, 5.0, 6.0, 6.0, 7.0, 8.0]);
    assert_eq!(run.history.column("increment"), [0.0, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0, 1.0]);
    assert_eq!(run.history.last("time"), 8.0);
    let turning: Vec<f64> = [2, 4, 5, 7].map(|k| run.history.column("e11")[k]).to_vec();
    assert_eq!(turning, [0.0015, 0.0, 0.001, 0.0]);
}

/// The case fails; its replay fails in the same way, and so does the replay's replay. `stuck`: not even a piece of
/// the increment succeeds, so that the point stays where it is.
fn fails_and_replays(desk: &Desk, case: &Value, expected: &[&str], stuck: bool) -> Table {
    let run = desk.run(&desk.case("case.json", case), &[], "out", 1);
    assert_eq!(run.summary["status"], "failed");
    for text in expected {
        assert!(run.outcome.stderr.contains(text), "'{text}' is not in {}", run.outcome.stderr);
        assert!(run.summary["message"].as_str().is_some_and(|message| message.contains(text)));
    }
    assert!(run.folder.join("report.html").is_file() && run.folder.join("plots").is_dir());
    let mut replay = run.folder.join("replay.json");
    desk.pullout(["check".as_ref(), replay.as_os_str()]).expect(0);
    for out in ["again", "and_again"] {
        let again = desk.run(&replay, &[], out, 1);
        for text in expected.iter().filter(|text| !text.starts_with("step ")) {
            assert!(again.outcome.stderr.contains(text), "'{text}' is not in {}", again.outcome.stderr);
        }
        assert!(again.outcome.stderr.contains("step 1, increment 1"), "{}", again.outcome.stderr);
        let next = again.folder.join("replay.json");
        if stuck {
            // the replay starts where the run stopped, bit by bit
            assert_eq!(json(&replay)["initial"], json(&next)["initial"]);
        }
        assert_eq!(json(&replay)["title"], json(&next)["title"]);
        replay = next;
    }
    run.history
}

#[test]
fn stress_control_past_the_peak_is_refused_and_replayed() {
    let desk = Desk::new();
    let steps = json!([
        { "increments": 10, "target": { "s11": 3.0 } },
        { "increments": 20, "target": { "s11": 4.0 } },
    ]);
    let expected = [
        "plugin 'concrete_damage', ",
        "step 2, increment 11",
        "stress control cannot pass a peak",
        "control e11 by strain",
    ];
    let history = fails_and_replays(&desk, &point(json!({ "plugin": "concrete_damage" }), steps), &expected, true);
    assert_eq!(history.rows.len(), 21);
    assert_eq!((history.last("step"), history.last("increment")), (2.0, 10.0));
    assert!((history.last("s11") - 3.5).abs() < 1e-6);
}

#[test]
fn the_component_to_control_is_the_one_that_is_ramped() {
    let desk = Desk::new();
    let steps = json!([ { "increments": 10, "target": { "s12": 6.0 } } ]);
    let mut case = point(json!({ "plugin": "concrete_damage" }), steps);
    case["mode"] = json!("plane_stress");
    fails_and_replays(&desk, &case, &["stress control cannot pass a peak", "control g12 by strain"], false);
}

#[test]
fn a_contact_that_does_not_carry_is_refused_and_replayed() {
    let desk = Desk::new();
    let material = json!({ "plugin": "bond_slip", "props": { "normal_law": "soft", "normal_stiffness": 1e5 } });
    let steps = json!([
        { "increments": 5, "target": { "slip": 0.1, "p": 3.0 } },
        { "increments": 6, "target": { "p": -3.0 } },
    ]);
    let expected = ["plugin 'bond_slip', ", "step 2, increment 4", "no gap found for p", "control gap instead"];
    let history = fails_and_replays(&desk, &interface(material, steps), &expected, true);
    assert_eq!(history.rows.len(), 9);
}

#[test]
fn too_few_iterations_for_a_pressure_are_named() {
    let desk = Desk::new();
    let material = json!({ "plugin": "bond_slip", "props": { "normal_law": "soft", "normal_stiffness": 1e5 } });
    let mut case = interface(material, json!([{ "increments": 5, "target": { "slip": 0.1, "p": 3.0 } }]));
    case["controls"] = json!({ "max_iterations": 1 });
    fails_and_replays(&desk, &case, &["no gap found for p", "in 1 iterations, max_iterations"], false);
}

#[test]
fn a_killed_run_leaves_all_finished_lines() {
    const LINES: usize = 20_000;
    let desk = Desk::new();
    let steps = json!([ { "increments": 100_000_000, "target": { "e11": 0.001 } } ]);
    let case = desk.case("case.json", &point(json!({ "plugin": "concrete_damage" }), steps));
    let mut process = command();
    process.args(["run", "--quiet", "--out"]).arg(desk.path("out")).arg(case);
    let mut child = process.spawn().expect("the program starts");
    let history = desk.path("out/history.csv");
    let enough = |bytes: u64| bytes > 100 * LINES as u64;
    let deadline = Instant::now() + Duration::from_secs(60);
    while !std::fs::metadata(&history).is_ok_and(|file| enough(file.len())) {
        assert!(
            Instant::now() < deadline && child.try_wait().expect("a child").is_none(),
            "too few lines were written"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    // SIGKILL
    child.kill().expect("a child");
    child.wait().expect("a child");
    // The kernel copies a line that crosses a page in two parts, and may end the process between them: readers leave
    // that line out.
    let text = std::fs::read_to_string(&history).expect("a history");
    let whole = text.rfind('\n').map_or(0, |end| end + 1);
    std::fs::write(&history, &text[..whole]).expect("a history");
    let table = Table::read(&history);
    assert!(table.rows.len() > LINES / 4, "{} lines", table.rows.len());
    let increments = table.column("increment");
    assert!(increments.iter().enumerate().all(|(k, &increment)| increment == k as f64));
    assert!(!desk.path("out/summary.json").exists());
}

/// A quick case, and a folder with its results.
fn finished(desk: &Desk) -> std::path::PathBuf {
    let steps = json!([ { "increments": 3, "target": { "e11": 0.001 } } ]);
    let case = desk.case("case.json", &point(elastic(), steps));
    desk.run(&case, &[], "out", 0);
    case
}

/// Every file below a folder, with its content.
fn everything(folder: &std::path::Path) -> std::collections::BTreeMap<std::path::PathBuf, Vec<u8>> {
    let mut all = std::collections::BTreeMap::new();
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            all.extend(everything(&path));
        } else {
            all.insert(path.clone(), std::fs::read(&path).expect("a file"));
        }
    }
    all
}

#[test]
fn files_of_the_user_are_refused_before_anything_runs() {
    let names = [
        "plots/mine.svg",
        "fields/mine.vtu",
        "report.html",
        "summary.json",
        "replay.json",
        "checkpoint.bin",
        "history.csv",
        "fields.pvd",
        "umat.log",
        "umat.msg",
        "manifest.json",
    ];
    for isolate in [false, true] {
        for name in names {
            let desk = Desk::new();
            let mut material = elastic();
            material["isolate"] = json!(isolate);
            let steps = json!([ { "increments": 3, "target": { "e11": 0.001 } } ]);
            let case = desk.case("case.json", &point(material, steps));
            desk.write(&format!("out/{name}"), "mine");
            let before = everything(&desk.path("out"));
            let run = |more: &[&str], code| {
                let arguments = ["run", "case.json", "--out", "out"].into_iter().chain(more.iter().copied());
                desk.pullout(arguments.collect::<Vec<_>>()).expect(code).stderr
            };
            let stderr = run(&[], 2);
            assert!(stderr.contains(name) && stderr.contains("--overwrite"), "{stderr}");
            assert_eq!(everything(&desk.path("out")), before, "{name}");
            let stderr = run(&["--overwrite"], 0);
            assert!(stderr.contains(name), "{stderr}");
            assert_eq!(json(&desk.path("out/summary.json"))["status"], "done");
            assert!(!desk.path("out/previous").exists() && case.exists());
            // they are ours now
            run(&[], 0);
        }
    }
}

#[test]
fn a_case_is_not_run_into_what_it_is_read_from() {
    let desk = Desk::new();
    desk.write("here/history.csv", "time, e11\n1, 0.001\n2, 0.002\n");
    let case = point(elastic(), json!([ { "table": "history.csv" } ]));
    desk.case("here/replay.json", &case);
    let before = everything(&desk.path("here"));
    for more in [&[][..], &["--overwrite"]] {
        let arguments = ["run", "here/replay.json", "--out", "here"].into_iter().chain(more.iter().copied());
        let stderr = desk.pullout(arguments.collect::<Vec<_>>()).expect(2).stderr;
        assert!(stderr.contains("history.csv, replay.json") && stderr.contains("another --out"), "{stderr}");
        assert_eq!(everything(&desk.path("here")), before);
    }
    desk.pullout(["run", "here/replay.json", "--out", "there"]).expect(0);
}

#[test]
fn results_without_a_manifest_are_replaced_only_on_demand() {
    let desk = Desk::new();
    finished(&desk);
    std::fs::remove_file(desk.path("out/manifest.json")).expect("a manifest");
    let before = everything(&desk.path("out"));
    let stderr = desk.pullout(["run", "case.json", "--out", "out"]).expect(2).stderr;
    assert!(stderr.contains("history.csv") && stderr.contains("--overwrite"), "{stderr}");
    assert_eq!(everything(&desk.path("out")), before);
    desk.pullout(["run", "case.json", "--out", "out", "--overwrite"]).expect(0);
}

#[test]
fn a_second_run_into_the_same_folder_is_refused() {
    let desk = Desk::new();
    let steps = json!([ { "increments": 100_000_000, "target": { "e11": 0.001 } } ]);
    desk.case("long.json", &point(elastic(), steps));
    finished(&desk);
    let mut process = command();
    process.current_dir(desk.path("")).args(["run", "--quiet", "--out", "out", "long.json"]);
    let mut child = process.spawn().expect("the program starts");
    let deadline = Instant::now() + Duration::from_secs(60);
    while !desk.path("out/previous/summary.json").exists() {
        assert!(Instant::now() < deadline && child.try_wait().expect("a child").is_none(), "it does not begin");
        std::thread::sleep(Duration::from_millis(2));
    }
    let stderr = desk.pullout(["run", "case.json", "--out", "out"]).expect(2).stderr;
    assert!(stderr.contains(&format!("process {} on ", child.id())), "{stderr}");
    // SIGKILL
    child.kill().expect("a child");
    child.wait().expect("a child");
    assert!(desk.path("out/previous/summary.json").exists() && !desk.path("out/summary.json").exists());
    // the next run takes over, and leaves nothing of both
    let run = desk.run(&desk.path("case.json"), &[], "out", 0);
    assert_eq!(run.history.rows.len(), 4);
    assert!(!desk.path("out/previous").exists());
}

/// Waits until a file of a running child is so long.
fn grown(child: &mut std::process::Child, file: &std::path::Path, bytes: u64) {
    let deadline = Instant::now() + Duration::from_secs(120);
    while !std::fs::metadata(file).is_ok_and(|file| file.len() > bytes) {
        let is_alive = child.try_wait().expect("a child").is_none();
        assert!(Instant::now() < deadline && is_alive, "{} does not grow", file.display());
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// A shell that starts the tests in the background has them ignore Ctrl-C, and their children.
fn signals() -> Vec<(Signal, &'static str, i32)> {
    let status = std::fs::read_to_string("/proc/self/status").expect("a status");
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).expect("a mask");
    let is_ignored = u64::from_str_radix(ignored.trim(), 16).expect("a number") & 2 != 0;
    [(Signal::INT, "SIGINT", 130), (Signal::TERM, "SIGTERM", 143)].into_iter().skip(usize::from(is_ignored)).collect()
}

#[test]
fn an_interrupted_run_says_so_and_keeps_what_it_has() {
    for (signal, words, code) in signals() {
        for isolate in [false, true] {
            let desk = Desk::new();
            finished(&desk);
            let mut long = json(&desk.path("case.json"));
            long["steps"][0]["increments"] = json!(100_000_000);
            long["material"]["isolate"] = json!(isolate);
            desk.case("long.json", &long);
            let mut process = command();
            process.current_dir(desk.path("")).args(["run", "--out", "out", "long.json"]);
            process.stderr(std::process::Stdio::piped()).stdout(std::process::Stdio::null());
            let mut child = process.spawn().expect("the program starts");
            let start = desk.path("out/previous/summary.json");
            grown(&mut child, &start, 1);
            grown(&mut child, &desk.path("out/history.csv"), 200_000);
            send(signal, child.id());
            let output = child.wait_with_output().expect("an end");
            let stderr = String::from_utf8(output.stderr).expect("UTF-8");
            assert_eq!(output.status.code(), Some(code), "{stderr}");
            assert!(stderr.contains(&format!("interrupted by {words}")) && stderr.contains("is kept"), "{stderr}");
            let summary = json(&desk.path("out/summary.json"));
            assert_eq!(summary["status"], "interrupted");
            let table = Table::read(&desk.path("out/history.csv"));
            assert_eq!(table.rows.len() as u64, summary["increments"].as_u64().expect("a count") + 1);
            assert!(std::fs::read_to_string(desk.path("out/report.html")).expect("a page").contains(">interrupted<"));
            assert!(desk.path("out/plots/stress_strain.svg").exists() && !desk.path("out/previous").exists());
            desk.run(&desk.path("case.json"), &[], "out", 0);
        }
    }
}

/// `ulimit` as shells have it, and the program with these arguments.
fn limited(desk: &Desk, limit: &str, arguments: &str) -> std::process::Output {
    let mut shell = std::process::Command::new("sh");
    shell
        .current_dir(desk.path(""))
        .env_remove("PULLOUT_PLUGIN_PATH")
        .env("MALLOC_ARENA_MAX", "1")
        .stdin(std::process::Stdio::null());
    let program = env!("CARGO_BIN_EXE_pullout");
    shell.args(["-c", &format!("ulimit {limit} && exec {program} {arguments}")]);
    shell.output().expect("a shell")
}

#[test]
fn a_file_that_cannot_grow_fails_the_run_at_its_step() {
    let desk = Desk::new();
    let steps = json!([
        { "increments": 10, "target": { "e11": 0.001 } },
        { "increments": 1_000_000, "target": { "e11": 0.002 } },
    ]);
    desk.case("case.json", &point(elastic(), steps));
    // 64 KiB to 128 KiB, by the shell's block
    let output = limited(&desk, "-f 128", "run --out out case.json");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("step 2, increment ") && stderr.contains("history.csv: File too large"), "{stderr}");
    let summary = json(&desk.path("out/summary.json"));
    assert_eq!(summary["status"], "failed");
    assert!(summary["message"].as_str().is_some_and(|message| message.contains("File too large")), "{summary}");
    assert!(Table::read(&desk.path("out/history.csv")).rows.len() > 100);
    assert!(everything(&desk.path("out")).keys().all(|path| !path.to_string_lossy().contains("partial")));
    // nothing was lost that the next run could not replace
    desk.pullout(["run", "case.json", "--out", "out", "--set", "steps.1.increments=1"]).expect(0);
    let desk = Desk::new();
    finished(&desk);
    desk.write("file", "");
    let stderr = desk.pullout(["run", "case.json", "--out", "file"]).expect(2).stderr;
    assert!(stderr.starts_with("file: "), "{stderr}");
}

/// A library that the program does not know runs in another process, which shares a file with this one.
#[test]
fn a_limit_of_the_size_of_files_is_not_the_plugins_fault() {
    let desk = Desk::new();
    if find(Tool::C).is_none() {
        return;
    }
    let umat = "void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl, \
                double *ddsddt, double *drplde, double *drpldt, double *stran, double *dstran)\n{ for (int i = 0; i < 6; i++) \
                { stress[i] += 1e3 * dstran[i]; ddsdde[7 * i] = 1e3; } }\n";
    desk.write("mine.c", umat);
    desk.pullout(["plugin", "build", "mine.c", "-o", "libmine.so"]).expect(0);
    let material = json!({ "plugin": "./libmine.so", "props": [], "nstatv": 0 });
    let steps = |increments: u32| json!([ { "increments": increments, "target": { "e11": 0.001 } } ]);
    desk.case("short.json", &point(material.clone(), steps(10)));
    // 512 KiB or 1 MiB, by the shell's block
    let output = limited(&desk, "-f 1024", "run --out short short.json");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    desk.case("long.json", &point(material, steps(100_000)));
    let output = limited(&desk, "-f 1024", "run --out long long.json");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("step 1, increment ") && stderr.contains("history.csv: File too large"), "{stderr}");
    assert!(!stderr.contains("plugin"), "{stderr}");
    // no room for what the processes share
    let output = limited(&desk, "-f 8", "run --out none short.json");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("ulimit -f") && !stderr.contains("--in-process"), "{stderr}");
}

#[test]
fn pictures_and_comparison_of_a_long_history_need_little_memory() {
    let desk = Desk::new();
    let rows: String = (0..=100).map(|k| format!("{},{}\n", 1e-5 * f64::from(k), 0.01 * f64::from(k))).collect();
    desk.write("curve.csv", &format!("strain,stress\n{rows}"));
    let steps = json!([ { "increments": 400_000, "target": { "e11": 0.001 } } ]);
    let mut case = point(elastic(), steps);
    let compare = json!([{ "file": "curve.csv", "x": "e11", "y": "s11", "file_x": "strain", "file_y": "stress" }]);
    case["compare"] = compare;
    desk.case("case.json", &case);
    // kB; a program that reads all rows aborts. Threads and arenas of memory reserve addresses.
    let output = limited(&desk, "-v 200000", "run --quiet --threads 1 --out out case.json");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let summary = json(&desk.path("out/summary.json"));
    assert_eq!((&summary["status"], &summary["increments"]), (&json!("done"), &json!(400_000)));
    assert_eq!(summary["compare"][0]["points"], 101);
    let modulus = summary["peaks"]["s11"]["max"].as_f64().expect("a stress") / 0.001;
    let rms = (0..=100).map(|k| (1e-5 * f64::from(k) * (modulus - 1000.0)).powi(2)).sum::<f64>() / 101.0;
    assert!((summary["compare"][0]["rms"].as_f64().expect("a number") - rms.sqrt()).abs() < 1e-9);
    assert!(desk.path("out/plots/stress_strain.svg").exists());
}

/// A file system of one megabyte, where the tests may mount one.
#[test]
fn a_full_file_system_fails_the_run_at_its_step_and_leaves_whole_rows() {
    let desk = Desk::new();
    let steps = json!([ { "increments": 1_000_000, "target": { "e11": 0.001 } } ]);
    desk.case("case.json", &point(elastic(), steps));
    std::fs::create_dir(desk.path("small")).expect("a folder");
    let program = env!("CARGO_BIN_EXE_pullout");
    // what is in a namespace's file system is seen only there
    let script = format!(
        "mount -t tmpfs -o size=1m none small || exit 99; {program} run --out small/out case.json; code=$?; \
         cp -r small/out copy; ls -a small/out; exit $code"
    );
    let mut unshare = std::process::Command::new("unshare");
    unshare.args(["--mount", "--map-root-user", "sh", "-c", &script]).current_dir(desk.path(""));
    let Ok(output) = unshare.env_remove("PULLOUT_PLUGIN_PATH").stdin(std::process::Stdio::null()).output() else {
        return eprintln!("no unshare: not tested");
    };
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    if output.status.code() == Some(99) || stderr.contains("unshare") {
        return eprintln!("no file system may be mounted here: not tested");
    }
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("step 1, increment ") && stderr.contains("No space left"), "{stderr}");
    assert!(!String::from_utf8_lossy(&output.stdout).contains("partial"));
    assert!(Table::read(&desk.path("copy/history.csv")).rows.len() > 1000);
}

/// A plate of one Q4 in plane strain.
fn plate(desk: &Desk, supports: Value, loads: Value, steps: Value) -> Value {
    let mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n0 1 \"corner\"\n0 2 \"opposite\"\n1 3 \"left\"\n\
                1 4 \"right\"\n2 5 \"plate\"\n$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
                $Elements\n5\n1 15 2 1 1 1\n2 15 2 2 2 4\n3 1 2 3 3 4 1\n4 1 2 4 4 2 3\n5 3 2 5 5 1 2 3 4\n$EndElements\n";
    desk.write("plate.msh", mesh);
    json!({
        "kind": "pullout", "mesh": { "file": "plate.msh" }, "parts": { "plate": { "material": elastic() } },
        "supports": supports, "loads": loads, "steps": steps, "output": { "plots": false }
    })
}

#[test]
fn a_load_that_nobody_measures_is_nan() {
    let desk = Desk::new();
    let loads = json!({ "right": { "traction": [1, 0] } });
    let mut case = plate(&desk, json!({ "left": {} }), loads, json!([{ "drives": { "right": 1 }, "increments": 2 }]));
    case["output"] = json!({ "plots": true, "pictures_at": { "increments": [1] } });
    let run = desk.run(&desk.case("plate.json", &case), &[], "unmeasured", 0);
    for column in ["load", "load_lateral", "load_axial", "load_shear"] {
        assert!(run.history.column(column).iter().all(|load| load.is_nan()), "{column}");
    }
    let run =
        desk.run(&desk.path("plate.json"), &["measure={\"load\": \"left\", \"direction\": \"x\"}"], "measured", 0);
    assert!((run.history.last("load") + 1.0).abs() < 1e-9, "{}", run.history.last("load"));
}

#[test]
fn energies_of_a_rigid_turn_are_rounding_and_not_warned_of() {
    let desk = Desk::new();
    let supports = json!({ "corner": {}, "opposite": { "direction": [1, 1], "drive": "turn" } });
    let case = plate(&desk, supports, json!({}), json!([{ "drives": { "turn": 0.1 }, "increments": 1 }]));
    let run = desk.run(&desk.case("plate.json", &case), &[], "turn", 0);
    let warnings = run.summary["warnings"].to_string();
    assert!(!warnings.contains("energies"), "{warnings}");
}

#[test]
fn a_law_of_the_total_strain_does_not_begin_from_a_stress() {
    let desk = Desk::new();
    let mut case = point(elastic(), json!([ { "increments": 1, "target": { "e11": 1e-4 } } ]));
    case["initial"] = json!({ "stress": { "s11": 5.0 } });
    let outcome = desk.run(&desk.case("point.json", &case), &[], "dropped", 1);
    let failure = outcome.summary["message"].to_string();
    assert!(failure.contains("$.initial.stress: linear_elastic drops the initial stress"), "{failure}");
    // with its strain it is the law's own
    case["initial"] = json!({ "stress": { "s11": 5.0 }, "strain": { "e11": 5e-3, "e22": -1.25e-3, "e33": -1.25e-3 } });
    let kept = desk.run(&desk.case("point.json", &case), &[], "kept", 0);
    assert!((kept.history.column("s11")[0] - 5.0).abs() < 1e-12);
}

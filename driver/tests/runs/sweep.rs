//! Sweeps: right names for what ends a run, nothing lost or done twice whatever ends the work, the same rows by any means.

use crate::program::{Desk, command, send};
use end_to_end_tests::{Tool, find, run as compile, workspace};
use pullout_sweep::Store;
use pullout_sweep::table::{Column, Table};
use rustix::process::Signal;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// The bond of a point, in as many increments.
fn bond(increments: usize) -> Value {
    json!({
        "kind": "interface", "title": "Bond",
        "material": { "plugin": "bond_slip", "props": { "law": "A", "k_e": 950.0, "a_1": 10.0, "b_1": 0.4 } },
        "steps": [{ "increments": increments, "target": { "slip": 0.5 } }],
    })
}

/// A sweep over so many stiffnesses, planned into `store`.
fn planned(desk: &Desk, count: usize, increments: usize) -> PathBuf {
    let stiffness: Vec<f64> = (0..count).map(|k| 500.0 + k as f64).collect();
    let sweep = json!({
        "kind": "sweep", "base": bond(increments),
        "parameters": { "material.props.k_e": stiffness },
        "quantities": { "peak": "peak", "first": { "column": "tau", "at": 0.01 } },
        "curves": ["slip", "tau"],
    });
    let file = desk.case("sweep.json", &sweep);
    let store = desk.path("store");
    desk.pullout(["sweep".as_ref(), "plan".as_ref(), file.as_os_str(), "--out".as_ref(), store.as_os_str()]).expect(0);
    store
}

/// Waits for an event.
fn until(mut has_come: impl FnMut() -> bool) {
    let deadline = Instant::now() + Duration::from_secs(60);
    while !has_come() {
        assert!(Instant::now() < deadline, "not within a minute");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Whether a process has a handler of a signal.
fn heeds(signal: Signal, process: u32) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    caught.is_some_and(|bits| u64::from_str_radix(bits.trim(), 16).expect("bits") >> (signal.as_raw() - 1) & 1 == 1)
}

/// All rows of all parts.
fn rows(store: &Path) -> Vec<Table> {
    let parts = Store::new(store).parts().expect("parts");
    parts.iter().map(|part| Table::read(part, |_| true).expect("a part")).collect()
}

fn texts(table: &Table, name: &str) -> Vec<String> {
    let column = table.column(name).unwrap_or_else(|| panic!("no column {name}"));
    column.texts().iter().map(|text| text.clone().unwrap_or_default()).collect()
}

/// The collected table; stores are also made anew.
fn collected(desk: &Desk, store: &Path) -> Table {
    let out = desk.path("all.jsonl");
    desk.pullout([
        "sweep".as_ref(),
        "collect".as_ref(),
        "--overwrite".as_ref(),
        store.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ])
    .expect(0);
    Table::read(&out, |_| true).expect("a table")
}

#[test]
fn a_table_comes_back_as_it_was_written() {
    let desk = Desk::new();
    let table = Table {
        columns: vec![
            ("a.b".into(), Column::Text(vec![Some("x".into()), None, Some(String::new())])),
            ("number".into(), Column::Number(vec![None, Some(0.1), Some(-f64::MAX)])),
            ("count".into(), Column::Count(vec![Some(3), Some(-1), None])),
            ("list".into(), Column::List(vec![vec![], vec![1.0, 2.0], vec![3.0]])),
        ],
    };
    let path = desk.path("table.jsonl");
    table.write(&path).expect("written");
    assert_eq!(Table::read(&path, |_| true).expect("read"), table);
    let mut csv = Vec::new();
    table.write_csv(&mut csv).expect("written");
    assert!(String::from_utf8(csv).expect("UTF-8").starts_with("a.b,number,count\nx,,3\n,0.1,-1\n"));
}

#[test]
fn rows_are_the_same_by_any_number_of_processes_and_by_threads() {
    let desk = Desk::new();
    let store = planned(&desk, 40, 50);
    let mut found: Vec<Table> = Vec::new();
    for how in [&["--jobs", "1"][..], &["--jobs", "3", "--chunk-runs", "7"], &["--jobs", "2", "--in-process"]] {
        let _ = fs::remove_dir_all(store.join("parts"));
        let arguments = ["sweep", "work", "--quiet"].iter().chain(how).map(std::ffi::OsStr::new);
        desk.pullout(arguments.chain([store.as_os_str()])).expect(0);
        let mut table = collected(&desk, &store);
        table.columns.retain(|(name, _)| !["wall_s", "cpu_s", "time"].contains(&name.as_str()));
        found.push(table);
    }
    assert_eq!(found[0].rows(), 40);
    assert_eq!(texts(&found[0], "status"), ["done"; 40]);
    assert_eq!(found[0], found[1]);
    assert_eq!(found[0], found[2]);
    // below τ = 10 · 0.01^0.4 the bond is elastic: τ = k_e δ
    for row in 0..40 {
        let number = |name: &str| found[0].column(name).and_then(|column| column.number(row)).expect("a number");
        let expected = (number("par.material.props.k_e") * 0.01).min(10.0 * 0.01_f64.powf(0.4));
        assert!((number("q.first") - expected).abs() < 1e-9 * expected, "{} {expected}", number("q.first"));
    }
    let Some(Column::List(curves)) = found[0].column("curve.tau") else { panic!("no curves") };
    assert!(curves.iter().all(|curve| curve.len() == 51));
}

/// After another plan into the same folder the table has what that one varies and keeps, also in rows that were there.
#[test]
fn the_table_has_the_columns_of_the_present_plan() {
    let desk = Desk::new();
    let store = planned(&desk, 3, 5);
    let plan = |sweep: &Value| {
        let file = desk.case("other.json", sweep);
        desk.pullout(["sweep".as_ref(), "plan".as_ref(), file.as_os_str(), "--out".as_ref(), store.as_os_str()])
            .expect(0);
    };
    let work = || desk.pullout(["sweep".as_ref(), "work".as_ref(), store.as_os_str()]).expect(0).stdout;
    let names = |table: &Table| -> Vec<String> {
        let all = table.columns.iter().map(|(name, _)| name.clone());
        all.filter(|name| ["par.", "q.", "curve."].iter().any(|beginning| name.starts_with(beginning))).collect()
    };
    work();
    let mut sweep: Value = serde_json::from_slice(&fs::read(desk.path("sweep.json")).expect("a sweep")).expect("JSON");
    let stiffness = sweep["parameters"]["material.props.k_e"][0].clone();
    // the first of the runs that are there, and one more
    sweep["parameters"] = json!({ "steps.0.increments": [sweep["base"]["steps"][0]["increments"], 7] });
    sweep["base"]["material"]["props"]["k_e"] = stiffness;
    plan(&sweep);
    assert!(work().contains("1 finished before"));
    let table = collected(&desk, &store);
    assert_eq!(names(&table), ["par.steps.0.increments", "q.first", "q.peak", "curve.slip", "curve.tau"]);
    let varied = table.column("par.steps.0.increments").expect("a column");
    assert_eq!([0, 1].map(|row| varied.number(row)), [5.0, 7.0].map(Some));
    // other quantities: all rows are new
    sweep["quantities"] = json!({ "other": "peak" });
    plan(&sweep);
    work();
    assert_eq!(names(&collected(&desk, &store)), ["par.steps.0.increments", "q.other", "curve.slip", "curve.tau"]);
}

/// Builds the plugin with many faults; `None` without a compiler.
fn misbehaving(desk: &Desk) -> Option<PathBuf> {
    let mut compiler = find(Tool::C)?;
    let library = desk.path("libmisbehaving.so");
    let source = workspace("driver/tests/isolation/misbehaving.c");
    let include = workspace("umat-abi/include");
    compile(compiler.args(["-shared", "-fPIC", "-O1", "-I"]).arg(include).arg("-o").arg(&library).arg(source));
    Some(library)
}

#[test]
fn each_run_has_the_name_of_its_end() {
    let desk = Desk::new();
    let Some(library) = misbehaving(&desk) else { return };
    let base = json!({
        "kind": "point", "mode": "3d",
        "material": { "plugin": "./libmisbehaving.so", "nstatv": 2, "props": [1000.0, 0, 1, 3], "call_time_limit_s": 2.0 },
        "steps": [{ "increments": 5, "target": { "s11": 5.0 } }],
    });
    const COUNT: usize = 2000;
    let [killer, failing, hanging] = [700, 1100, 1500];
    let points: Vec<Value> = (0..COUNT)
        .map(|k| {
            let fault = if k == killer { 1 } else if k == hanging { 5 } else { 0 };
            // without stiffness no stress is reached
            let modulus = if k == failing { 0.0 } else { 1000.0 };
            json!({ "steps.0.target.s11": 5.0 + 1e-3 * k as f64, "material.props.1": fault, "material.props.0": modulus })
        })
        .collect();
    let sweep = desk.case("sweep.json", &json!({ "kind": "sweep", "base": base, "points": points }));
    let store = desk.path("store");
    desk.pullout(["sweep".as_ref(), "plan".as_ref(), sweep.as_os_str(), "--out".as_ref(), store.as_os_str()]).expect(0);
    // the store has its own copy
    fs::remove_file(library).expect("removed");
    let outcome = desk.pullout(["sweep".as_ref(), "work".as_ref(), store.as_os_str()]).expect(0);
    assert!(outcome.stdout.contains("2000 runs"), "{}", outcome.stdout);
    let table = collected(&desk, &store);
    let states = texts(&table, "status");
    let others: BTreeMap<usize, &str> = states
        .iter()
        .enumerate()
        .filter(|(_, state)| *state != "done")
        .map(|(run, state)| (run, state.as_str()))
        .collect();
    assert_eq!(others, BTreeMap::from([(killer, "crashed"), (failing, "failed"), (hanging, "timeout")]));
    let messages = texts(&table, "message");
    assert!(messages[killer].contains("exit code 0"), "{}", messages[killer]);
    assert!(messages[hanging].contains("within 2 s"), "{}", messages[hanging]);
    assert!(messages[failing].contains("step 1, increment 1"), "{}", messages[failing]);
    let place =
        |run: usize| ["at_step", "at_increment"].map(|name| table.column(name).and_then(|column| column.number(run)));
    assert_eq!(place(killer), [Some(1.0), Some(3.0)]);
    assert_eq!(place(hanging), [Some(1.0), Some(3.0)]);
    // what crashed can be repeated
    let key = &texts(&table, "key")[killer];
    let replay = store.join("replay").join(format!("{key}.json"));
    let again = desk.run(&replay, &[], "again", 1);
    assert!(again.outcome.stderr.contains("exit code 0"), "{}", again.outcome.stderr);
    // settled: nothing is run again, but on request
    let outcome = desk.pullout(["sweep".as_ref(), "work".as_ref(), store.as_os_str()]).expect(0);
    assert!(outcome.stdout.contains("0 runs"), "{}", outcome.stdout);
    let outcome = desk.pullout(["sweep".as_ref(), "work".as_ref(), "--again".as_ref(), store.as_os_str()]).expect(0);
    assert!(outcome.stdout.contains("3 runs in"), "{}", outcome.stdout);
    let table = collected(&desk, &store);
    assert_eq!(table.column("attempt").and_then(|column| column.number(killer)), Some(2.0));
}

#[test]
fn nothing_is_lost_or_twice_after_kills_at_any_moment() {
    let desk = Desk::new();
    const COUNT: usize = 300;
    let store = planned(&desk, COUNT, 3000);
    let mut random = fastrand::Rng::with_seed(7);
    let mut work = command();
    work.args(["sweep", "work", "--quiet", "--jobs", "2", "--chunk-runs", "10"]).arg(&store).stdout(Stdio::null());
    for _ in 0..10 {
        let mut child = work.spawn().expect("the program starts");
        std::thread::sleep(Duration::from_millis(random.u64(5..900)));
        child.kill().expect("killed");
        child.wait().expect("ended");
    }
    assert!(work.status().expect("the program starts").success());
    let done = |table: &Table| -> Vec<String> {
        let ended = texts(table, "key").into_iter().zip(texts(table, "status"));
        ended.filter(|(_, status)| status == "done").map(|(key, _)| key).collect()
    };
    let keys: Vec<String> = rows(&store).iter().flat_map(done).collect();
    assert_eq!(keys.len(), COUNT);
    assert_eq!(keys.iter().collect::<BTreeSet<_>>().len(), COUNT);
    // a kill costs the runs that the two children were at
    let all: usize = rows(&store).iter().map(Table::rows).sum();
    assert!(all - COUNT <= 2 * 10, "{all} rows");
    assert_eq!(collected(&desk, &store).rows(), COUNT);
    assert_eq!(fs::read_dir(store.join("running")).expect("a folder").count(), 0);
    let status = desk.pullout(["sweep".as_ref(), "status".as_ref(), store.as_os_str()]).expect(0);
    assert!(status.stdout.contains("300 runs, 300 finished (300 done), 0 to do"), "{}", status.stdout);
}

/// Ends the process that watches over it, where the first parameter asks for that.
const KILLER: &str = r#"
#include <signal.h>
#include <stdio.h>
#include <unistd.h>
/* the parent of the process that started this one */
static int watcher(void) {
    char path[32];
    int parent = 0;
    snprintf(path, sizeof path, "/proc/%d/stat", getppid());
    FILE *stat = fopen(path, "r");
    if (!stat || fscanf(stat, "%*d (%*[^)]) %*c %d", &parent) != 1) _exit(9);
    fclose(stat);
    return parent;
}
void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl, double *ddsddt,
           double *drplde, double *drpldt, const double *stran, const double *dstran, const double *time, const double *dtime,
           const double *temp, const double *dtemp, const double *predef, const double *dpred, const char *cmname,
           const int *ndi, const int *nshr, const int *ntens, const int *nstatv, const double *props) {
    if (props[0] == 1.0 && stran[0] + dstran[0] > 0.5) {
        kill(watcher(), SIGKILL);
        sleep(60);
    }
    for (int i = 0; i < *ntens * *ntens; i++) ddsdde[i] = i % (*ntens + 1) ? 0.0 : 1.0;
    for (int i = 0; i < *ntens; i++) stress[i] += dstran[i];
}
"#;

#[test]
fn what_ends_its_worker_three_times_is_lost_and_nothing_else() {
    let desk = Desk::new();
    let Some(mut compiler) = find(Tool::C) else { return };
    let (library, source) = (desk.path("libkiller.so"), desk.write("killer.c", KILLER));
    compile(compiler.args(["-shared", "-fPIC", "-O1", "-o"]).arg(&library).arg(source));
    let material = json!({ "plugin": "./libkiller.so", "nstatv": 1, "props": [0.0] });
    let base = json!({ "kind": "point", "mode": "3d", "material": material,
        "steps": [{ "increments": 4, "target": { "e11": 1.0 } }] });
    let points: Vec<Value> = (0..6)
        .map(|k| json!({ "material.props.0": u8::from(k == 2), "steps.0.target.g12": 0.1 * f64::from(k) }))
        .collect();
    let sweep = desk.case("sweep.json", &json!({ "kind": "sweep", "base": base, "points": points }));
    let store = desk.path("store");
    desk.pullout(["sweep".as_ref(), "plan".as_ref(), sweep.as_os_str(), "--out".as_ref(), store.as_os_str()]).expect(0);
    let work = |more: &str| {
        let mut work = command();
        work.args(["sweep", "work", "--quiet", "--jobs", "1"]).args(more.split_whitespace()).arg(&store);
        work.status().expect("the program starts")
    };
    let status = || desk.pullout(["sweep".as_ref(), "status".as_ref(), store.as_os_str()]).expect(0).stdout;
    for _ in 0..3 {
        assert!(!work("").success(), "killed");
    }
    // the third loss is known once another worker looks
    assert!(work("").success());
    assert!(status().contains("6 runs, 6 finished (5 done, 1 lost), 0 to do"), "{}", status());
    let table = collected(&desk, &store);
    assert_eq!(texts(&table, "status"), ["done", "done", "lost", "done", "done", "done"]);
    assert_eq!(table.column("attempt").and_then(|column| column.number(2)), Some(3.0));
    assert!(texts(&table, "message")[2].contains("attempt 3"), "{:?}", texts(&table, "message"));
    // what the workers that were killed had done was not done again
    let all: usize = rows(&store).iter().map(Table::rows).sum();
    assert_eq!(all, 5 + 3);
    assert!(work("").success() && !work("--again").success(), "only on request");
}

/// The keys of a sweep.
fn keys(desk: &Desk, sweep: &Value) -> Vec<String> {
    let store = desk.path("store");
    let _ = fs::remove_dir_all(&store);
    let file = desk.case("sweep.json", sweep);
    desk.pullout(["sweep".as_ref(), "plan".as_ref(), file.as_os_str(), "--out".as_ref(), store.as_os_str()]).expect(0);
    desk.pullout(["sweep".as_ref(), "work".as_ref(), "--quiet".as_ref(), store.as_os_str()]).expect(0);
    texts(&collected(desk, &store), "key")
}

#[test]
fn what_changes_a_row_changes_its_key() {
    let desk = Desk::new();
    desk.write("data/measured.csv", "slip,tau\n0.0,0.0\n0.25,5.0\n");
    desk.write("read.dat", "1\n");
    let mut base = bond(5);
    base["files"] = json!(["read.dat"]);
    base["compare"] =
        json!([{ "file": "data/measured.csv", "x": "slip", "y": "tau", "file_x": "slip", "file_y": "tau" }]);
    let mut sweep = json!({ "kind": "sweep", "base": base, "parameters": { "material.props.k_e": [900, 950] } });
    let first = keys(&desk, &sweep);
    assert_eq!(first.len(), 2);
    // a title, the order of members and the way to write a number change nothing
    sweep["base"]["title"] = json!("Another");
    sweep["parameters"] = json!({ "material.props.k_e": [950.0, 900] });
    assert_eq!(keys(&desk, &sweep), [first[1].clone(), first[0].clone()]);
    let mut all: BTreeSet<String> = first.into_iter().collect();
    let mut differs = |sweep: &Value| {
        let new = keys(&desk, sweep);
        assert!(new.iter().all(|key| all.insert(key.clone())), "{sweep}");
    };
    sweep["set"] = json!({ "material.props.a_1": 11.0 });
    differs(&sweep);
    desk.write("data/measured.csv", "slip,tau\n0.0,0.0\n0.25,5.1\n");
    differs(&sweep);
    desk.write("read.dat", "2\n");
    differs(&sweep);
    sweep["curves"] = json!(["tau"]);
    differs(&sweep);
}

#[test]
fn plugins_are_known_by_their_content() {
    let desk = Desk::new();
    let Some(mut compiler) = find(Tool::C) else { return };
    let source = fs::read_to_string(workspace("driver/tests/isolation/misbehaving.c")).expect("a source");
    let source = desk.write("law.c", &source);
    let library = desk.path("liblaw.so");
    let include = workspace("umat-abi/include");
    compile(compiler.args(["-shared", "-fPIC", "-O1", "-I"]).arg(&include).arg("-o").arg(&library).arg(&source));
    let base = json!({
        "kind": "point", "mode": "3d",
        "material": { "plugin": "liblaw.so", "nstatv": 2, "props": [1000.0, 0, 1, 3] },
        "steps": [{ "increments": 2, "target": { "e11": 0.005 } }],
    });
    let sweep = json!({ "kind": "sweep", "base": base, "parameters": { "material.props.0": [900] } });
    let first = keys(&desk, &sweep);
    assert_eq!(keys(&desk, &sweep), first);
    let Some(mut compiler) = find(Tool::C) else { return };
    compile(compiler.args(["-shared", "-fPIC", "-O2", "-I"]).arg(&include).arg("-o").arg(&library).arg(&source));
    assert_ne!(keys(&desk, &sweep), first);
}

#[test]
fn designs_by_table_points_and_product() {
    let desk = Desk::new();
    let base = desk.case("bond.json", &bond(5));
    let table = desk.write("design.csv", "material.props.k_e, steps.0.target.slip\n900, 0.1\n950, 0.2\n");
    let store = desk.path("store");
    let plan = |file: &Path, more: &[&std::ffi::OsStr], code: i32| {
        let arguments = ["sweep".as_ref(), "plan".as_ref(), file.as_os_str(), "--out".as_ref(), store.as_os_str()];
        desk.pullout(arguments.into_iter().chain(more.iter().copied())).expect(code)
    };
    plan(&base, &["--design".as_ref(), table.as_os_str()], 0);
    let runs = |store: &Path| Store::new(store).sweep().expect("a sweep").runs;
    assert_eq!(runs(&store), [[json!(900), json!(0.1)], [json!(950), json!(0.2)]]);
    let product = json!({ "kind": "sweep", "base": "bond.json", "grid": [0.0, 0.0003],
                          "parameters": { "material.props.k_e": [800.0, 900.0], "steps.0.target.slip": [0.0005, 0.0006] }, "curves": ["tau"] });
    let file = desk.case("sweep.json", &product);
    plan(&file, &[], 0);
    assert_eq!(
        runs(&store),
        [[800.0, 5e-4], [800.0, 6e-4], [900.0, 5e-4], [900.0, 6e-4]].map(|run| run.map(|value| json!(value)))
    );
    desk.pullout(["sweep".as_ref(), "work".as_ref(), "--quiet".as_ref(), store.as_os_str()]).expect(0);
    let table = collected(&desk, &store);
    let Some(Column::List(curves)) = table.column("curve.tau") else { panic!("no curves") };
    assert_eq!(curves.iter().map(Vec::len).collect::<Vec<_>>(), [2; 4]);
    // the bond is elastic there
    for (curve, k_e) in curves.iter().zip([800.0, 800.0, 900.0, 900.0]) {
        assert!((curve[1] - 0.0003 * k_e).abs() < 1e-12, "{curve:?}");
    }
    for (wrong, place) in [
        (json!({ "kind": "sweep", "base": "bond.json" }), "needs one of"),
        (json!({ "kind": "sweep", "base": "none.json", "points": [{ "a": 1 }] }), "$.base"),
        (json!({ "kind": "sweep", "base": "bond.json", "points": [{ "material.props.k": 1 }] }), "k_e"),
        (json!({ "kind": "sweep", "base": "bond.json", "points": [{ "a": 1 }, { "b": 1 }] }), "$.points[1]"),
        (
            json!({ "kind": "sweep", "base": "bond.json", "points": [{ "title": "x" }], "curves": ["s1"] }),
            "$.curves[0]",
        ),
        (json!({ "kind": "sweep", "base": "bond.json", "point": [] }), "$.point"),
    ] {
        let file = desk.case("wrong.json", &wrong);
        let outcome = plan(&file, &[], 2);
        assert!(outcome.stderr.contains(place), "{place}: {}", outcome.stderr);
    }
    let script = desk.pullout(["sweep", "submit", "--slurm", "--array", "1-10", "store"]).expect(0).stdout;
    assert!(script.contains("#SBATCH --array=1-10") && script.contains("- 1))/10"), "{script}");
    let outcome = desk.pullout(["sweep", "work", "--chunk", "3/3", "store"]).expect(2);
    assert!(outcome.stderr.contains("K/N"), "{}", outcome.stderr);
}

#[test]
fn parts_of_a_sweep_by_number() {
    let desk = Desk::new();
    let store = planned(&desk, 10, 5);
    // before anything is done, the table has the parameters
    let table = collected(&desk, &store);
    assert_eq!(texts(&table, "status"), ["left"; 10]);
    for (chunk, over) in [("0/3", 0..3), ("2/3", 6..10), ("1/3", 3..6)] {
        let arguments = ["sweep", "work", "--quiet", "--chunk", chunk].map(std::ffi::OsStr::new);
        desk.pullout(arguments.into_iter().chain([store.as_os_str()])).expect(0);
        let table = collected(&desk, &store);
        assert_eq!(table.rows(), 10);
        for run in over {
            assert_eq!(texts(&table, "status")[run], "done");
            assert!(table.column("q.peak").and_then(|peak| peak.number(run)).is_some());
        }
        for (run, status) in texts(&table, "status").iter().enumerate() {
            let number = |name: &str| table.column(name).and_then(|column| column.number(run));
            assert_eq!(number("run"), Some(run as f64));
            assert_eq!(number("par.material.props.k_e"), Some(500.0 + run as f64));
            assert_eq!(number("q.peak").is_some(), status == "done");
        }
    }
}

/// Paths have one meaning wherever they are read, and what is varied stands in the table as it was given.
#[test]
fn the_table_says_what_the_user_wrote() {
    let desk = Desk::new();
    let plan = |sweep: &Value, code: i32| {
        desk.case("sweep.json", sweep);
        sweep_with(&desk, "plan", &["sweep.json", "--out", "store"], code)
    };
    let table = || {
        sweep_with(&desk, "work", &["--quiet", "store"], 0);
        collected(&desk, &desk.path("store"))
    };
    // a row that is there is that of several runs, whose titles differ
    plan(
        &json!({ "kind": "sweep", "base": bond(5), "points": [{ "title": "a" }, { "title": "b" }, { "title": "c" }] }),
        0,
    );
    let titles = table();
    assert_eq!(texts(&titles, "par.title"), ["a", "b", "c"]);
    assert_eq!(texts(&titles, "status"), ["done"; 3]);
    // the rows of a product that grows by another path
    let mut grown = json!({ "kind": "sweep", "base": bond(5), "parameters": { "material.props.k_e": [700, 800] } });
    plan(&grown, 0);
    table();
    grown["parameters"] = json!({ "$.material.props.a_1": [8, 10], "material.props.k_e": [700, 800] });
    plan(&grown, 0);
    let grown = table();
    for (name, expected) in [("a_1", [8.0, 8.0, 10.0, 10.0]), ("k_e", [700.0, 800.0, 700.0, 800.0])] {
        let column = grown.column(&format!("par.material.props.{name}")).expect("a column");
        assert_eq!([0, 1, 2, 3].map(|row| column.number(row)), expected.map(Some));
    }
    let mut twice = json!({ "kind": "sweep", "base": bond(5), "points": [{ "steps[0].increments": 4 }] });
    plan(&twice, 0);
    assert_eq!(table().column("par.steps.0.increments").and_then(|column| column.number(0)), Some(4.0));
    twice["points"][0]["steps.0.increments"] = json!(6);
    assert!(plan(&twice, 2).contains("the path steps.0.increments is given twice"));
    // libraries of the same name, and tables
    let Some(library) = misbehaving(&desk) else { return };
    for folder in ["x", "y"] {
        fs::create_dir(desk.path(folder)).expect("a folder");
        fs::copy(&library, desk.path(folder).join("lib.so")).expect("copied");
        desk.write(&format!("{folder}/t.csv"), "time,e11\n0,0\n1,0.001\n");
    }
    let base = json!({
        "kind": "point", "mode": "3d", "material": { "plugin": "x/lib.so", "nstatv": 2, "props": [1000.0, 0, 1, 3] },
        "steps": [{ "increments": 2, "target": { "e11": 0.005 } }],
    });
    plan(&json!({ "kind": "sweep", "base": base, "parameters": { "material.plugin": ["x/lib.so", "y/lib.so"] } }), 0);
    let libraries = table();
    assert_eq!(texts(&libraries, "par.material.plugin"), ["x/lib.so", "y/lib.so"]);
    assert_eq!(texts(&libraries, "status"), ["done"; 2]);
}

/// Rows of all parts: runs that were carried out.
fn carried_out(store: &Path) -> usize {
    rows(store).iter().map(Table::rows).sum()
}

#[test]
fn two_workers_at_the_same_time_share_the_runs() {
    let desk = Desk::new();
    const COUNT: usize = 120;
    let store = planned(&desk, COUNT, 3000);
    let start = || {
        let mut work = command();
        work.args(["sweep", "work", "--quiet", "--jobs", "1"]).arg(&store);
        work.spawn().expect("the program starts")
    };
    let mut workers = [start(), start()];
    for worker in &mut workers {
        assert!(worker.wait().expect("ended").success());
    }
    assert_eq!(texts(&collected(&desk, &store), "status"), ["done"; COUNT]);
    assert_eq!(carried_out(&store), COUNT, "a run that the other worker had or was at");
    // one goes on with what another leaves that is killed meanwhile
    fs::remove_dir_all(store.join("parts")).expect("removed");
    let [mut killed, mut other] = [start(), start()];
    until(|| store.join("running").read_dir().expect("a folder").count() >= 2);
    std::thread::sleep(Duration::from_millis(100));
    killed.kill().expect("killed");
    killed.wait().expect("ended");
    assert!(other.wait().expect("ended").success());
    assert_eq!(texts(&collected(&desk, &store), "status"), ["done"; COUNT]);
    assert!(carried_out(&store) <= COUNT + 2, "{}", carried_out(&store));
}

#[test]
fn threads_call_only_what_was_built_with_the_program() {
    let desk = Desk::new();
    if misbehaving(&desk).is_none() {
        return;
    }
    let base = json!({
        "kind": "point", "mode": "3d",
        "material": { "plugin": "./libmisbehaving.so", "nstatv": 2, "props": [1000.0, 0, 1, 3] },
        "steps": [{ "increments": 5, "target": { "e11": 0.005 } }],
    });
    let sweep = json!({ "kind": "sweep", "base": base, "parameters": { "steps.0.target.e11": [0.004, 0.005], "material.props.1": [0, 1] } });
    desk.case("sweep.json", &sweep);
    sweep_with(&desk, "plan", &["sweep.json", "--out", "store"], 0);
    sweep_with(&desk, "work", &["--in-process", "--jobs", "1", "store"], 0);
    let table = collected(&desk, &desk.path("store"));
    assert_eq!(texts(&table, "status"), ["done", "crashed", "done", "crashed"]);
    assert!(texts(&table, "message")[1].contains("exit code 0"), "{:?}", texts(&table, "message"));
}

/// A child that a signal ends while the exit handlers of its library run has all its rows: nothing is wrong with it.
#[test]
fn a_signal_ends_the_work_without_a_word_of_exit_handlers() {
    let desk = Desk::new();
    if misbehaving(&desk).is_none() {
        return;
    }
    let material =
        json!({ "plugin": "./libmisbehaving.so", "nstatv": 2, "props": [1000.0, 10, 1, 3], "call_time_limit_s": 50 });
    let base = json!({ "kind": "point", "mode": "3d", "material": material,
        "steps": [{ "increments": 5, "target": { "e11": 0.005 } }] });
    let sweep = json!({ "kind": "sweep", "base": base, "points": [{ "steps.0.target.e11": 0.004 }] });
    desk.case("sweep.json", &sweep);
    sweep_with(&desk, "plan", &["sweep.json", "--out", "store"], 0);
    let mut work = command();
    work.args(["sweep", "work", "--quiet", "--jobs", "1"]).arg(desk.path("store")).stderr(Stdio::piped());
    let mark = desk.path("hangs");
    let child = work.env("HANGS_AT_EXIT", &mark).spawn().expect("the program starts");
    until(|| mark.exists());
    // SIGTERM: a shell lets what it starts in the background ignore Ctrl-C
    send(Signal::TERM, child.id());
    let ended = child.wait_with_output().expect("ended");
    assert_eq!(String::from_utf8_lossy(&ended.stderr), "");
    assert_eq!(ended.status.code(), Some(0), "its run was over");
    assert_eq!(texts(&collected(&desk, &desk.path("store")), "status"), ["done"]);
}

/// The child of a sweep without plugins takes the time that it needs to end: it was ended 0 s after its results, with a warning of the
/// exit handlers of a plugin.
#[test]
fn a_sweep_without_plugins_says_nothing_of_them() {
    let desk = Desk::new();
    let base = json!({ "kind": "bridging", "fibre": { "model": "closed", "diameter": 0.5, "length": 30, "E": 200_000, "tau": 3 },
        "volume_fraction": 0.01, "matrix": { "E": 30_000, "ft": 3 } });
    let sweep = json!({ "kind": "sweep", "base": base, "parameters": { "fibre.tau": [1, 2, 3], "volume_fraction": [0.005, 0.01, 0.02] },
        "curve": { "x": "w", "y": "sigma" }, "quantities": { "peak": "peak" } });
    desk.case("sweep.json", &sweep);
    for store in ["a", "b", "c"] {
        sweep_with(&desk, "plan", &["sweep.json", "--out", store], 0);
        assert_eq!(sweep_with(&desk, "work", &["--quiet", store], 0), "");
        assert_eq!(texts(&collected(&desk, &desk.path(store)), "status"), ["done"; 9]);
    }
}

/// Arguments of a command of `sweep` with a folder.
fn sweep_with(desk: &Desk, action: &str, more: &[&str], code: i32) -> String {
    let arguments = ["sweep", action].into_iter().chain(more.iter().copied());
    desk.pullout(arguments).expect(code).stderr
}

#[test]
fn a_table_replaces_no_file_of_the_users() {
    let desk = Desk::new();
    planned(&desk, 2, 5);
    sweep_with(&desk, "work", &["--quiet", "store"], 0);
    let design = "material.props.k_e\n200\n";
    desk.write("design.csv", design);
    let printed = sweep_with(&desk, "collect", &["store", "--out", "design.csv"], 2);
    assert!(printed.contains("--out design.csv: is no table that was collected of this sweep"), "{printed}");
    assert_eq!(fs::read_to_string(desk.path("design.csv")).expect("a file"), design);
    for name in ["all.json", "all.txt", "all"] {
        let printed = sweep_with(&desk, "collect", &["store", "--out", name], 2);
        assert!(printed.contains(".csv, a .jsonl or a .parquet") && !desk.path(name).exists(), "{printed}");
    }
    let printed = sweep_with(&desk, "collect", &["store", "--out", "store/parts/all.jsonl"], 2);
    assert!(printed.contains("among the files of the sweep itself"), "{printed}");
    // an earlier collection is the program's until it is changed
    for name in ["all.csv", "all.jsonl", "all.parquet"] {
        sweep_with(&desk, "collect", &["store", "--out", name], 0);
        sweep_with(&desk, "collect", &["store", "--out", name], 0);
    }
    desk.write("all.csv", "mine\n");
    sweep_with(&desk, "collect", &["store", "--out", "all.csv"], 2);
    sweep_with(&desk, "collect", &["store", "--out", "all.csv", "--overwrite"], 0);
    assert!(fs::read_to_string(desk.path("all.csv")).expect("a table").starts_with("run,key,status,"));
}

#[test]
fn a_plan_replaces_no_file_of_the_users() {
    let desk = Desk::new();
    let sweep = json!({ "kind": "sweep", "base": bond(5), "parameters": { "material.props.k_e": [900.0] } });
    let file = desk.case("sweep.json", &sweep);
    let text = fs::read_to_string(&file).expect("a sweep");
    // the file that is read; a case; no JSON
    for content in [text.as_str(), &bond(5).to_string(), "{ \"version\": 1 }", "x"] {
        desk.write("store/sweep.json", content);
        let printed = sweep_with(&desk, "plan", &["sweep.json", "--out", "store"], 2);
        assert!(printed.contains("store/sweep.json is no plan that this program wrote"), "{printed}");
        assert_eq!(fs::read_to_string(desk.path("store/sweep.json")).expect("a file"), content);
    }
    let printed = sweep_with(&desk, "plan", &["sweep.json", "--out", "."], 2);
    assert!(printed.contains("is no plan"), "{printed}");
    assert_eq!(fs::read_to_string(&file).expect("a sweep"), text);
    assert!(!desk.path("files").exists());
    // a plan replaces another
    fs::remove_file(desk.path("store/sweep.json")).expect("removed");
    sweep_with(&desk, "plan", &["sweep.json", "--out", "store"], 0);
    sweep_with(&desk, "plan", &["sweep.json", "--out", "store"], 0);
}

#[test]
fn columns_and_points_that_are_not_there_are_refused_by_the_plan() {
    let desk = Desk::new();
    let refused = |desk: &Desk, more: Value, message: &str| {
        let mut sweep = json!({ "kind": "sweep", "base": bond(5), "points": [{ "material.props.k_e": 900.0 }] });
        sweep.as_object_mut().expect("a sweep").extend(more.as_object().expect("members").clone());
        desk.case("sweep.json", &sweep);
        let printed = sweep_with(desk, "plan", &["sweep.json", "--out", "store"], 2);
        assert!(printed.contains(message), "{message}\n{printed}");
        assert!(!desk.path("store/sweep.json").exists());
    };
    for (more, message) in [
        (
            json!({ "quantities": { "t": { "column": "tauu" } } }),
            "$.quantities.t.column: the histories have no column 'tauu'; nearest valid name: 'tau'",
        ),
        (
            json!({ "quantities": { "t": { "column": "tau", "over": ["slp"] } } }),
            "$.quantities.t.over: the histories have no column 'slp'",
        ),
        (json!({ "curve": { "x": "slip", "y": "load" } }), "$.curve.y: the histories have no column 'load'"),
        (json!({ "curves": ["s1"] }), "$.curves[0]: the histories have no column 's1'"),
        (json!({ "points": [] }), "$.points: "),
        (json!({ "work_to": 0 }), "$.work_to: must not be 0"),
    ] {
        refused(&desk, more, message);
    }
    // of a library that only a child loads, too
    if misbehaving(&desk).is_none() {
        return;
    }
    let base = json!({
        "kind": "point", "mode": "3d",
        "material": { "plugin": "./libmisbehaving.so", "nstatv": 2, "props": [1000.0, 0, 1, 3] },
        "steps": [{ "increments": 5, "target": { "s11": 5.0 } }],
    });
    let own = |quantity: Value| json!({ "base": base, "points": [{ "material.props.0": 900.0 }], "quantities": { "q": quantity } });
    refused(&desk, own(json!({ "column": "s1" })), "$.quantities.q.column: the histories have no column 's1'");
    let study = json!({
        "kind": "study", "base": "base.json", "members": [{ "label": "a" }, { "label": "b" }],
        "claims": [{ "claim": "c", "quantity": { "column": "s1" }, "expect": { "greater_than": 1 } }],
    });
    desk.case("base.json", &base);
    desk.case("study.json", &study);
    let printed = desk.pullout(["study", "study.json", "--out", "out"]).expect(2).stderr;
    let message = "$.claims[0].quantity.column: the histories have no column 's1'; nearest valid name: 's11'";
    assert_eq!(printed.matches(message).count(), 1, "{printed}");
    assert!(!desk.path("out").exists());
}

/// τ = k δ on a bond that is elastic, and a point that yields: work is that of the whole path.
#[test]
fn the_work_of_a_cycle_is_what_it_dissipates() {
    let desk = Desk::new();
    let base = json!({
        "kind": "interface",
        "material": { "plugin": "bond_slip", "props": { "law": "A", "k_e": 950.0, "a_1": 10.0, "b_1": 0.4 } },
        "steps": [
            { "increments": 100, "target": { "slip": 0.02 } }, { "increments": 200, "target": { "slip": -0.02 } },
            { "increments": 200, "target": { "slip": 0.02 } },
        ],
    });
    let sweep = json!({
        "kind": "sweep", "base": base, "points": [{ "material.props.k_e": 950.0 }],
        "curves": ["slip", "tau"], "quantities": { "work": "work", "back": { "column": "tau", "at": -0.01 } },
    });
    desk.case("sweep.json", &sweep);
    sweep_with(&desk, "plan", &["sweep.json", "--out", "store"], 0);
    sweep_with(&desk, "work", &["--quiet", "store"], 0);
    let table = collected(&desk, &desk.path("store"));
    let curve = |name: &str| match table.column(name) {
        Some(Column::List(curves)) => curves[0].clone(),
        _ => panic!("no curve"),
    };
    let (slip, tau) = (curve("curve.slip"), curve("curve.tau"));
    let path: f64 = (1..slip.len()).map(|k| 0.5 * (slip[k] - slip[k - 1]) * (tau[k] + tau[k - 1])).sum();
    let number = |name: &str| table.column(name).and_then(|column| column.number(0)).expect("a number");
    assert!((number("q.work") - path).abs() < 1e-12 * path && path > 0.0, "{} {path}", number("q.work"));
    assert!(number("q.back") < 0.0, "{}", number("q.back"));
}

/// A design of ten million runs: what is wrong with it is said before they are made, and a signal ends the planning.
#[test]
fn a_large_plan_is_checked_first_and_heeds_signals() {
    let desk = Desk::new();
    let values = |from: u32| json!(Vec::from_iter(from..from + 200));
    let parameters = json!({
        "material.props.k_e": values(900), "steps.0.increments": values(1), "steps.0.target.slip": values(1),
    });
    let mut sweep = json!({ "kind": "sweep", "base": bond(2), "parameters": parameters });
    sweep["titel"] = json!("wrong");
    desk.case("wrong.json", &sweep);
    // 8 million runs take more memory than this, KB
    let line = "ulimit -v 3000000; exec \"$0\" sweep plan wrong.json --out store";
    let mut shell = std::process::Command::new("sh");
    let output = shell.args(["-c", line, env!("CARGO_BIN_EXE_pullout")]).current_dir(desk.path("")).output();
    let output = output.expect("a shell");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && stderr.contains("$.titel"), "{stderr}");
    sweep.as_object_mut().expect("an object").remove("titel");
    desk.case("right.json", &sweep);
    let mut process = command();
    process.current_dir(desk.path("")).args(["sweep", "plan", "right.json", "--out", "store"]);
    let child = process.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts");
    until(|| heeds(Signal::TERM, child.id()));
    std::thread::sleep(Duration::from_millis(100));
    send(Signal::TERM, child.id());
    let output = child.wait_with_output().expect("an end");
    assert_eq!(output.status.code(), Some(143), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!desk.path("store/sweep.json").exists());
}

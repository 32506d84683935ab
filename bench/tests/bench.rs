//! `pullout-bench --quick` as its users meet it.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// Runs the program in a folder of its own; asserts the exit code.
fn measure(arguments: &[&str], code: i32) -> (TempDir, Output) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_pullout-bench"));
    command.current_dir(&folder).env_remove("PULLOUT_PLUGIN_PATH").stdin(Stdio::null());
    let output = command.args(arguments).output().expect("the program starts");
    let texts = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    assert_eq!(output.status.code(), Some(code), "{texts:?}");
    assert!(!texts[1].contains("panicked at"), "{texts:?}");
    (folder, output)
}

/// The lines of a CSV file by columns.
fn csv(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::Reader::from_path(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let header = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    let rows = reader.records().map(|record| record.expect("a row").iter().map(str::to_owned).collect()).collect();
    (header, rows)
}

/// The numbers of a column; an empty entry is none.
fn numbers(path: &Path, column: &str) -> Vec<Option<f64>> {
    let (header, rows) = csv(path);
    let k = header.iter().position(|name| name == column).unwrap_or_else(|| panic!("{}: {column}", path.display()));
    let number = |text: &String| (!text.is_empty()).then(|| text.parse().expect("a number"));
    rows.iter().map(|row| number(&row[k])).collect()
}

fn pictures(folder: &Path) -> usize {
    let files = std::fs::read_dir(folder).expect("the results").flatten();
    let svgs = files.filter(|file| file.path().extension().is_some_and(|extension| extension == "svg"));
    svgs.inspect(|file| {
        let text = std::fs::read_to_string(file.path()).expect("a picture");
        let svg = roxmltree::Document::parse(&text).expect("well-formed SVG");
        // bars have samples of this size in the legend
        let samples = svg.descendants().filter(|node| {
            [("width", "600"), ("height", "240")].iter().all(|(name, value)| node.attribute(*name) == Some(value))
        });
        let mut colors: Vec<&str> = samples.filter_map(|sample| sample.attribute("fill")).collect();
        let number = colors.len();
        colors.sort_unstable();
        colors.dedup();
        assert_eq!(colors.len(), number, "{}: bars of two series look the same", file.path().display());
    })
    .count()
}

#[test]
fn laws_are_measured() {
    let (folder, _) = measure(&["laws", "--quick", "--out", "results"], 0);
    let results = folder.path().join("results");
    let data = results.join("laws.csv");
    let (_, rows) = csv(&data);
    for series in ["law", "driver", "Box 4.1", "Box 4.2", "Box 5.1"] {
        assert!(rows.iter().filter(|row| row[2] == series).count() >= 15, "{series}");
    }
    let errors = numbers(&data, "error");
    for (row, error) in rows.iter().zip(&errors) {
        let failed = !row[9].is_empty();
        assert_eq!(error.is_none(), failed, "{row:?}");
        assert!(error.is_none_or(|error| error.is_finite() && error >= 0.0), "{row:?}");
        assert!(row[2] != "law" || !failed, "{row:?}");
    }
    let times = numbers(&data, "time_over_law").into_iter().flatten();
    assert!(times.into_iter().all(|ratio| ratio.is_finite() && ratio > 0.0));
    let page = std::fs::read_to_string(results.join("laws.md")).expect("a page");
    assert!(page.contains("rustc 1.") && page.contains("--quick"), "{page}");
    assert!(!page.contains("should not depend"), "{page}");
    assert!(pictures(&results) >= 5);
}

#[test]
fn calls_and_throughput_are_measured() {
    let (folder, _) = measure(&["abi", "throughput", "--quick", "--out", "results"], 0);
    let results = folder.path().join("results");
    for (item, columns) in [
        ("abi", &["direct_ns", "plugin_ns", "overhead_percent", "host_ns", "recorder_ns"][..]),
        ("throughput", &["updates_per_s_tangent", "all_cores_over_one_stress", "single_over_batch_time"]),
    ] {
        let data = results.join(format!("{item}.csv"));
        for column in columns {
            let numbers = numbers(&data, column);
            assert_eq!(numbers.len(), 16, "{item} {column}");
            assert!(numbers.iter().all(|number| number.is_some_and(f64::is_finite)), "{item} {column}: {numbers:?}");
        }
        assert!(results.join(format!("{item}.md")).is_file());
    }
    // four laws have a twin in Fortran, where gfortran is
    let twins = numbers(&results.join("abi.csv"), "fortran_portable_over_plugin");
    let measured = twins.iter().flatten().count();
    assert!(measured == 8 || measured == 0, "{twins:?}");
    assert!(twins.iter().flatten().all(|ratio| ratio.is_finite() && *ratio > 0.0));
    assert_eq!(pictures(&results), 2);
}

#[test]
#[ignore = "long: cost_is_measured_against_unknowns runs specimens as well"]
fn specimens_are_measured() {
    let (folder, _) = measure(&["fe", "skipping", "--quick", "--out", "results"], 0);
    let results = folder.path().join("results");
    let (fe, skipping) = (results.join("fe.csv"), results.join("skipping.csv"));
    // two angles, two things that are varied, two levels, of which the second is what the first is compared with
    for column in ["peak_error", "work_error"] {
        let errors = numbers(&fe, column);
        assert_eq!(errors.len(), 8);
        for (k, error) in errors.iter().enumerate() {
            assert_eq!(error.is_some(), k % 2 == 0, "{column}: {errors:?}");
            assert!(error.is_none_or(|error| (0.0..0.1).contains(&error)), "{column}: {errors:?}");
        }
    }
    assert!(numbers(&fe, "energy_error").iter().all(|error| error.is_some_and(|error| error < 1e-3)));
    let of =
        |column: &str| numbers(&fe, column).into_iter().map(|number| number.expect("a number")).collect::<Vec<f64>>();
    let parts = ["solids_s", "contact_s", "assembly_s", "factorisation_s", "solution_s"].map(of);
    for (k, whole) in of("analysis_s").iter().enumerate() {
        let sum: f64 = parts.iter().map(|part| part[k]).sum();
        assert!(parts.iter().all(|part| part[k] > 0.0) && sum < *whole, "{sum} of {whole}");
    }
    // six ways to skip in each of three blocks and a plate
    let (loads, freedoms) = (numbers(&skipping, "load_N"), numbers(&skipping, "freedoms"));
    assert_eq!(loads.len(), 24);
    for loads in loads.chunks(6) {
        let load = loads[0].expect("a load");
        assert!(loads.iter().flatten().all(|other| (other / load - 1.0).abs() < 0.02), "{loads:?}");
    }
    assert!(freedoms[0] < freedoms[6] && freedoms[6] < freedoms[12] && freedoms[12] == freedoms[17], "{freedoms:?}");
    assert_eq!(pictures(&results), 3);
}

#[test]
fn threads_change_time_and_no_bit() {
    let (folder, _) = measure(&["threads", "--quick", "--out", "results"], 0);
    let (_, rows) = csv(&folder.path().join("results").join("threads.csv"));
    assert!(rows.len() >= 4);
    for row in &rows {
        assert_eq!(row[6], "yes", "{row:?}");
        assert!(row[3].parse::<f64>().is_ok_and(|seconds| seconds > 0.0), "{row:?}");
    }
}

#[test]
fn runs_in_memory_are_timed() {
    let (folder, _) = measure(&["engine", "--quick", "--out", "results"], 0);
    let (_, rows) = csv(&folder.path().join("results").join("engine.csv"));
    assert_eq!(rows.len(), 3);
    for row in &rows {
        assert!(row[1..].iter().all(|time| time.parse::<f64>().is_ok_and(|time| time > 0.0)), "{row:?}");
    }
}

#[test]
fn cost_is_measured_against_unknowns() {
    let (folder, _) = measure(&["scaling", "--quick", "--out", "results"], 0);
    let results = folder.path().join("results");
    let data = results.join("scaling.csv");
    let of =
        |column: &str| numbers(&data, column).into_iter().map(|number| number.expect("a number")).collect::<Vec<f64>>();
    // two sizes of two specimens in turns
    let freedoms = of("freedoms");
    assert_eq!(freedoms.len(), 4);
    assert!(freedoms[0] < freedoms[2] && freedoms[1] < freedoms[3], "{freedoms:?}");
    let parts = ["set_up_s", "solids_s", "assembly_s", "factorisation_s", "solution_s", "rest_s"].map(of);
    assert!(parts.iter().flatten().all(|part| *part > 0.0), "{parts:?}");
    let contact = of("contact_s");
    for (k, whole) in of("cpu_s").iter().enumerate() {
        let sum: f64 = parts.iter().map(|part| part[k]).sum::<f64>() + contact[k];
        assert!((sum / whole - 1.0).abs() < 1e-9, "{sum} of {whole}");
    }
    for (column, count) in [("cpu_per_increment_s", "increments"), ("cpu_per_iteration_s", "iterations")] {
        let (whole, set_up) = (of("cpu_s"), of("set_up_s"));
        for (k, (each, count)) in of(column).iter().zip(of(count)).enumerate() {
            assert!((each * count / (whole[k] - set_up[k]) - 1.0).abs() < 1e-9, "{column}");
        }
    }
    assert_eq!(pictures(&results), 1);
}

#[test]
fn peers_do_the_same_work_or_are_not_installed() {
    let (folder, _) = measure(&["peers", "--quick", "--out", "results"], 0);
    let results = folder.path().join("results");
    let data = results.join("peers.csv");
    let (_, rows) = csv(&data);
    let column = |name: &str| numbers(&data, name);
    let (own, times) = (column("result"), column("time_over_ours"));
    let errors = column("exact_error");
    // two plates, the strip, two laws of a point; ours, then the peers'
    assert_eq!(rows.len(), 13);
    let of_ours: Vec<usize> = (0..rows.len()).filter(|k| rows[*k][2] == "pullout").collect();
    assert_eq!(of_ours, [0, 2, 4, 6, 9]);
    for k in 0..rows.len() {
        let first = *of_ours.iter().rfind(|first| **first <= k).expect("ours");
        let ours = own[first].expect("a result");
        match own[k] {
            _ if k == first => assert_eq!(times[k], Some(1.0), "{:?}", rows[k]),
            // penalty contact: CalculiX's drag is what it is
            Some(theirs) if rows[k][1].contains("strip") => assert!((theirs / ours - 1.0).abs() < 0.05),
            Some(theirs) => assert!((theirs / ours - 1.0).abs() < 1e-3, "{ours} {theirs}"),
            None => assert_eq!(times[k], None),
        }
        assert_eq!(own[k].is_some(), times[k].is_some_and(|ratio| ratio.is_finite() && ratio > 0.0));
        // singlepointsim iterates until the lateral stress is a thousandth, the others to rounding
        let bound = if rows[k][2].starts_with("singlepointsim") { 1e-5 } else { 1e-9 };
        assert!(k < 6 || errors[k].is_none_or(|error| error < bound), "{:?}", rows[k]);
    }
    assert!((errors[4].expect("a drag")) < 5e-3);
    assert!([errors[6], errors[9]].iter().all(|error| error.is_some_and(|error| error < 1e-12)), "{errors:?}");
    let page = std::fs::read_to_string(results.join("peers.md")).expect("a page");
    assert_eq!(page.contains("not installed"), own.iter().any(Option::is_none), "{page}");
}

#[test]
fn an_unknown_item_is_refused_with_the_known_ones() {
    let (folder, output) = measure(&["nonsense"], 2);
    assert!(String::from_utf8_lossy(&output.stderr).contains("laws"));
    assert!(!folder.path().join("bench").exists());
}

#[test]
fn every_iteration_of_five_fibres_has_a_cause() {
    let (folder, _) = measure(&["iterations", "--quick", "--out", "results"], 0);
    let data = folder.path().join("results/iterations.csv");
    let (_, rows) = csv(&data);
    let mut scenes: Vec<&str> = rows.iter().map(|row| row[0].as_str()).collect();
    scenes.dedup();
    assert_eq!(scenes, ["45°, cover", "hook", "perpendicular", "pair", "bar"]);
    let counts = |cause: &str| numbers(&data, cause).into_iter().map(|count| count.expect("a count"));
    assert!(counts("prediction").all(|count| count == 1.0));
    for cause in ["settlement", "stick or slip", "presses or pulls", "nothing flipped"] {
        assert!(counts(cause).sum::<f64>() > 0.0, "{cause}");
    }
}

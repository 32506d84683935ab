//! Cases of kind "bridging" as users meet them: run as a process, results read back.

use crate::program::{Desk, Table, cases, json};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A result directory without a history.
struct Results {
    folder: PathBuf,
    bridging: Table,
    summary: Value,
}

impl Results {
    fn of(desk: &Desk, name: &str, settings: &[&str], out: &str) -> Self {
        let case = cases().join("bridging").join(name);
        let folder = desk.path(out);
        let mut line = vec!["run", "--quiet", "--out", out, case.to_str().expect("UTF-8")];
        settings.iter().for_each(|entry| line.extend(["--set", entry]));
        let outcome = desk.pullout(&line).expect(0);
        assert_eq!(outcome.stdout, "");
        // curves at 0° alone are used for all angles; rows of 0.2 mm pass over the stretch of the fibre
        let expected = |line: &str| {
            line.contains("fibres at more than 0°, the largest angle of the curves")
                || line.contains("openings: straight lines between the 66 openings")
        };
        assert!(outcome.stderr.lines().all(|line| name == "simulated.json" && expected(line)), "{}", outcome.stderr);
        Self {
            bridging: Table::read(&folder.join("bridging.csv")),
            summary: json(&folder.join("summary.json")),
            folder,
        }
    }

    fn number(&self, pointer: &str) -> f64 {
        self.summary["bridging"].pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}"))
    }

    fn table(&self, name: &str) -> Table {
        Table::read(&self.folder.join(name))
    }
}

fn bits(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// σ_0 (1 − 2w/L_f)², whose area is σ_0 L_f/6.
#[test]
fn rigid_fibres_have_their_closed_form() {
    let desk = Desk::new();
    let run = Results::of(&desk, "closed.json", &[], "out");
    let sigma_0 = 1.352_448_021_489_041_8;
    for (w, sigma) in run.bridging.column("w").iter().zip(run.bridging.column("sigma_fibre")) {
        assert!((sigma - sigma_0 * (1.0 - w / 15.0_f64).powi(2)).abs() < 1e-8 * sigma_0, "{w}");
    }
    assert!((run.number("/sigma_fibre_peak") - sigma_0).abs() < 1e-8);
    assert!((run.number("/efficiency") - 0.5).abs() < 1e-12);
    let shares: f64 = (0..9).map(|k| run.bridging.column(&format!("share_{}_{}", 10 * k, 10 * k + 10))[0]).sum();
    assert!((shares - 1.0).abs() < 1e-12);
    let work = run.summary["bridging"]["work"].as_array().expect("work").last().expect("an end")["work"].as_f64();
    assert!((work.expect("a number") - sigma_0 * 5.0).abs() < 1e-7 * 5.0 * sigma_0, "{work:?}");
    assert_eq!(run.summary["bridging"]["units"]["sigma"], "MPa");
}

/// Works and peaks are those of σ(w), whatever openings are asked for; if straight lines between the rows have another work, this is
/// reported. A study takes work and peak of the run.
#[test]
fn openings_change_no_work_and_no_peak() {
    let desk = Desk::new();
    let case = json!({
        "kind": "bridging",
        "fibre": { "model": "closed", "diameter": 0.5, "length": 30, "E": 200_000, "tau": 3, "inclination": { "type": "exp", "f": 0.5 } },
        "volume_fraction": 0.01,
        "matrix": { "E": 30_000, "ft": 3, "softening": "hordijk", "Gf": 0.1 },
        "output": { "plots": false },
    });
    let of = |openings: Value| {
        let mut case = case.clone();
        case["openings"] = openings;
        desk.case("case.json", &case);
        let outcome = desk.pullout(["run", "--quiet", "--out", "out", "case.json"]).expect(0);
        let found = json(&desk.path("out/summary.json"))["bridging"].clone();
        let works = found["work"].as_array().expect("works").iter().map(|work| work["work"].clone());
        let numbers = works.chain(["sigma_peak", "w_peak", "sigma_fibre_peak"].map(|name| found[name].clone()));
        (numbers.map(|number| number.as_f64().expect("a number")).collect::<Vec<_>>(), outcome.stderr)
    };
    let (right, silence) = of(json!({ "to": 5, "points": 4000 }));
    assert_eq!(silence, "");
    // by the trapezoidal rule over the rows
    let rows = Table::read(&desk.path("out/bridging.csv"));
    let (w, sigma) = (rows.column("w"), rows.column("sigma"));
    let sum: f64 = (1..w.len()).map(|k| 0.5 * (w[k] - w[k - 1]) * (sigma[k] + sigma[k - 1])).sum();
    assert!((right[3] - sum).abs() < 1e-6 * sum, "{} for {sum}", right[3]);
    assert!((right[0] - 0.7481).abs() < 1e-4 && (right[1] - 2.946).abs() < 1e-3, "{right:?}");
    for (openings, is_coarse) in [
        (json!({ "to": 5, "points": 5, "spacing": "even" }), true),
        (json!({ "to": 4, "points": 81, "spacing": "even" }), false),
        (json!({ "to": 5, "points": 100 }), false),
    ] {
        let (found, warning) = of(openings.clone());
        for (k, (found, right)) in found.iter().zip(&right).enumerate() {
            let is_same = (found - right).abs() < 1e-6 * right;
            assert!(is_same || k == 3 && openings["to"] == 4, "{k} with {openings}: {found}, {right}");
        }
        assert_eq!(warning.contains("openings: straight lines between the"), is_coarse, "{openings}: {warning}");
    }
    desk.case(
        "study.json",
        &json!({
            "kind": "study", "base": "case.json", "curve": { "x": "w", "y": "sigma" },
            "members": [{ "label": "few", "set": { "openings": { "to": 5, "points": 5, "spacing": "even" } } }],
            "claims": [],
        }),
    );
    desk.pullout(["study", "--quiet", "--out", "study", "study.json"]).expect(0);
    let table = json(&desk.path("study/study.json"));
    let run = &table["runs"][0];
    for (name, right) in [("work", right[3]), ("peak", right[4])] {
        assert!((run[name].as_f64().expect("a number") - right).abs() < 1e-6 * right, "{name}: {run}");
    }
}

#[test]
fn every_shipped_case_of_bridging_runs() {
    let desk = Desk::new();
    for name in ["two-sided", "shear-lag", "beam"] {
        let run = Results::of(&desk, &format!("{name}.json"), &[], name);
        assert_eq!(run.summary["status"], "done");
        for column in &run.bridging.columns {
            // at no opening fibres have no stress to share
            let first = usize::from(column.starts_with("share_"));
            assert!(run.bridging.column(column)[first..].iter().all(|value| value.is_finite()), "{name}: {column}");
        }
        assert!(run.number("/error") < 1e-3, "{name}");
        let report = std::fs::read_to_string(run.folder.join("report.html")).expect("a report");
        assert!(report.contains("<svg") && report.trim_end().ends_with("</html>"), "{name}");
        let shares = run.bridging.columns.iter().filter(|column| column.starts_with("share_"));
        let shares_vary = shares.map(|column| run.bridging.column(column)).any(|shares| {
            let of = |least: fn(f64, f64) -> f64| shares[1..].iter().copied().reduce(least).expect("openings");
            let [least, greatest] = [of(f64::min), of(f64::max)];
            greatest - least > 1e-9
        });
        for picture in ["sigma_w", "shares_w", "load_of_a_fibre", "orientation"] {
            // the same shares at every opening are nothing to draw
            let is_drawn = picture != "shares_w" || shares_vary;
            assert_eq!(run.folder.join(format!("plots/{picture}.svg")).is_file(), is_drawn, "{name}: {picture}");
        }
    }
}

#[test]
fn a_beam_has_the_strengths_of_its_curve() {
    let desk = Desk::new();
    let run = Results::of(&desk, "beam.json", &[], "out");
    let beam = run.table("beam.csv");
    for (k, cmod) in [0.5, 1.5, 2.5, 3.5].iter().enumerate() {
        let row = beam.column("cmod").iter().position(|at| at == cmod).expect("a row at the standard's CMOD");
        let strength = beam.column("f_R")[row];
        assert!((strength - run.number(&format!("/beam/f_R/{k}"))).abs() < 1e-9, "{cmod}");
        let load = beam.column("load")[row];
        assert!((strength - 1.5 * load * 500.0 / (150.0 * 125.0 * 125.0)).abs() < 1e-9);
    }
    assert!(!run.folder.join("scatter.csv").exists());
}

/// Reads the lines of numbers of a file.
fn rows_of(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let numbers = |line: &str| line.split(',').map(|number| number.trim().parse().ok()).collect::<Option<Vec<f64>>>();
    text.lines().filter_map(numbers).collect()
}

/// σ of rows of w and σ, w rising, by straight lines.
fn between(rows: &[[f64; 2]], w: f64) -> f64 {
    let right = rows.partition_point(|row| row[0] < w).clamp(1, rows.len() - 1);
    let [[from, below], [to, above]] = [rows[right - 1], rows[right]];
    below + (above - below) * (w - from) / (to - from)
}

/// ABAQUS's table and that of a crack band, read back, are the σ(w) of the run at all its openings; the first is the only one asked for, then
/// both, then neither; a band in which strains would fall is refused with the widest.
#[test]
fn tables_for_other_programs_have_the_law_of_the_run() {
    let desk = Desk::new();
    let run = Results::of(&desk, "beam.json", &["output.abaqus=true", "output.crack_band=20"], "out");
    let text = std::fs::read_to_string(run.folder.join("abaqus.inp")).expect("a table");
    assert!(text.contains("\n*CONCRETE TENSION STIFFENING, TYPE=DISPLACEMENT\n"), "{text}");
    let abaqus: Vec<[f64; 2]> = rows_of(&run.folder.join("abaqus.inp")).iter().map(|row| [row[1], row[0]]).collect();
    let band = rows_of(&run.folder.join("crack_band.csv"));
    let of_band: Vec<[f64; 2]> = band.iter().map(|row| [20.0 * row[0], row[2]]).collect();
    let columns = ["w", "sigma"].map(|name| run.bridging.column(name));
    for table in [&abaqus, &of_band] {
        assert_eq!(table[0][0], 0.0);
        assert!(table.windows(2).all(|pair| pair[1][0] > pair[0][0]));
        assert!(table.iter().all(|row| row[1] >= 0.0));
        for (w, sigma) in columns[0].iter().zip(&columns[1]).skip(1) {
            assert!((between(table, *w) - sigma).abs() < 1e-9, "{w}: {} for {sigma}", between(table, *w));
        }
    }
    assert!(band.windows(2).all(|pair| pair[1][1] > pair[0][1]), "strains rise");
    let plain = Results::of(&desk, "beam.json", &[], "plain");
    assert!(!plain.folder.join("abaqus.inp").exists() && !plain.folder.join("crack_band.csv").exists());

    let case = cases().join("bridging/beam.json");
    let wide = ["run", "--quiet", "--out", "wide", "--set", "output.crack_band=900", case.to_str().expect("UTF-8")];
    let warning = desk.pullout(wide).expect(0).stderr;
    assert!(warning.contains("output.crack_band") && warning.contains("give less than"), "{warning}");
    assert!(!desk.path("wide/crack_band.csv").exists());
}

/// And with any number of threads the same beams.
#[test]
fn beams_at_random_are_the_same_for_any_number_of_threads() {
    let desk = Desk::new();
    let few = ["scatter.beams=40", "openings.points=21"];
    let run = Results::of(&desk, "monte-carlo.json", &few, "first");
    let case = cases().join("bridging/monte-carlo.json");
    let line = ["run", "--quiet", "--threads", "1", "--out", "second", "--set", few[0], "--set", few[1]];
    desk.pullout(line.iter().copied().chain([case.to_str().expect("UTF-8")])).expect(0);
    for name in ["bridging.csv", "beam.csv", "scatter.csv"] {
        assert!(bits(&run.folder, name) == bits(&desk.path("second"), name), "{name}");
    }
    let scatter = run.table("scatter.csv");
    assert_eq!(scatter.rows.len(), 40);
    let mean = scatter.column("f_R3").iter().sum::<f64>() / 40.0;
    assert!((run.number("/scatter/f_R/2/mean") - mean).abs() < 1e-9);
    let beam = run.table("beam.csv");
    for row in 1..beam.rows.len() {
        let [low, middle, high] = ["load_05", "load_50", "load_95"].map(|name| beam.column(name)[row]);
        assert!(low <= middle && middle <= high);
    }
}

/// And says where; it used to be a stress of 0.
#[test]
fn a_stress_that_is_no_number_fails_the_run() {
    let desk = Desk::new();
    let case = cases().join("bridging/closed.json");
    let line = ["run", "--out", "out", "--set", "fibre.inclination.f=1000", case.to_str().expect("UTF-8")];
    let outcome = desk.pullout(line).expect(1);
    assert!(outcome.stderr.contains("σ of the fibres at w = 0 mm is"), "{}", outcome.stderr);
    let summary = json(&desk.path("out/summary.json"));
    assert_eq!(summary["status"], "failed");
    assert!(summary["message"].as_str().is_some_and(|message| message.contains("σ of the fibres")), "{summary}");
}

/// Columns of either file are a study's, but not of both at once.
#[test]
fn a_study_takes_columns_of_both_files() {
    let desk = Desk::new();
    let base = cases().join("bridging/beam.json");
    let study = |y: &str| {
        serde_json::json!({
            "kind": "study", "base": base, "x": { "name": "V_f" }, "set": { "openings": { "points": 41 } },
            "members": [
                { "label": "half", "x": 0.5, "set": { "volume_fraction": 0.005 } },
                { "label": "one", "x": 1, "set": { "volume_fraction": 0.01 } }
            ],
            "curve": { "x": "cmod", "y": y },
            "claims": [
                { "claim": "f_R3 grows with the dosage", "quantity": { "column": "f_R", "at": 2.5 }, "expect": { "trend": "increasing" } },
                { "claim": "so does σ of the fibres, in proportion", "quantity": { "column": "sigma_fibre", "at": "greatest" },
                  "expect": { "ratio_of": "one", "to": "half", "greater_than": 1.95, "less_than": 2.05 } }
            ]
        })
    };
    desk.case("study.json", &study("f_R"));
    let outcome = desk.pullout(["study", "--quiet", "--out", "study", "study.json"]).expect(0);
    assert_eq!(outcome.stderr, "");
    let claims = json(&desk.path("study/study.json"))["claims"].clone();
    for claim in claims.as_array().expect("claims") {
        assert_eq!(claim["verdict"], "found", "{claim}");
    }
    desk.case("mixed.json", &study("sigma"));
    let outcome = desk.pullout(["check", "mixed.json"]).expect(2);
    assert!(outcome.stderr.contains("$.curve.y: 'sigma' and 'cmod' are columns of two files"), "{}", outcome.stderr);
}

/// From the strengths of beams made at random back to σ(w) and the friction that made them.
#[test]
fn strengths_lead_back_to_the_bond() {
    let desk = Desk::new();
    let few = ["scatter.beams=200", "openings.points=41"];
    let run = Results::of(&desk, "monte-carlo.json", &few, "out");
    let case = cases().join("bridging/monte-carlo.json");
    let case = case.to_str().expect("UTF-8");
    let fit = |more: &[&str], code: i32| {
        let line = ["fit", "beam", "--case", case, "--out", "fit"];
        desk.pullout(line.iter().chain(more).copied()).expect(code)
    };
    let outcome = fit(&["out/scatter.csv"], 0);
    assert!(outcome.stdout.contains("NOT IDENTIFIABLE"), "five numbers do not determine E: {}", outcome.stdout);
    let found = json(&desk.path("fit/fit.json"));
    assert_eq!(found["strengths"]["class"].as_str().map(str::len), Some(2), "{}", found["strengths"]);
    let tau = found["numbers"]["tau"]["value"].as_f64().expect("a friction");
    assert!((tau / 4.0 - 1.0).abs() < 0.1, "{tau}");
    // the matrix that is left is small there: σ is the fibres'
    let sigma = found["numbers"]["sigma(1.25)"]["value"].as_f64().expect("a stress");
    let at = run.bridging.column("w").iter().position(|w| *w >= 1.25).expect("an opening");
    assert!((sigma / run.bridging.column("sigma_fibre")[at] - 1.0).abs() < 0.1, "{sigma}");
    // what it found runs
    desk.pullout(["check", "fit/bond-case.json"]).expect(0);
    assert!(std::fs::read_to_string(desk.path("fit/report.html")).expect("a report").contains("<svg"));
    for (more, message) in [
        (&["out/bridging.csv"][..], "no column is called 'cmod'"),
        (&["out/scatter.csv", "--load", "f_L"], "no column is called 'cmod'"),
        (&["out/beam.csv", "--cmod", "load"], "the CMODs of a test must rise"),
    ] {
        let outcome = fit(more, 2);
        assert!(outcome.stderr.contains(message), "{more:?}: {}", outcome.stderr);
    }
}

/// A case's own strengths give its σ(w) and its friction; of three beams they give a band. What is no strength is named
/// by its line.
#[test]
fn strengths_of_a_case_give_its_law_and_its_friction() {
    let desk = Desk::new();
    let run = Results::of(&desk, "beam.json", &[], "out");
    let case = cases().join("bridging/beam.json");
    let case = case.to_str().expect("UTF-8");
    let strengths = [0, 1, 2, 3].map(|k| run.number(&format!("/beam/f_R/{k}")));
    let row = |part: f64| {
        let all = [run.number("/beam/f_L")].into_iter().chain(strengths).map(|strength| (part * strength).to_string());
        all.collect::<Vec<_>>().join(",") + "\n"
    };
    let write = |name: &str, rows: &[String]| {
        let text = format!("f_L,f_R1,f_R2,f_R3,f_R4\n{}", rows.concat());
        std::fs::write(desk.path(name), text).expect("a file");
    };
    write("own.csv", &[row(1.0)]);
    write("three.csv", &[row(0.9), row(1.0), row(1.1)]);
    write("none.csv", &[row(1.0), "5,4,0,4,4\n".into()]);
    std::fs::write(desk.path("curve.csv"), "cmod,load\n0.1,1\n0.2,2\n0.15,3\n").expect("a file");
    let fit = |more: &[&str], code: i32| desk.pullout([&["fit", "beam", "--case", case], more].concat()).expect(code);
    fit(&["own.csv", "--out", "own", "--set", "output.abaqus=true"], 0);
    let found = json(&desk.path("own/fit.json"));
    let tau = found["numbers"]["tau"]["value"].as_f64().expect("a friction");
    assert!((tau / 4.0 - 1.0).abs() < 5e-3, "{tau}");
    let sigma = Table::read(&desk.path("own/sigma.csv"));
    let abaqus: Vec<[f64; 2]> = rows_of(&desk.path("own/abaqus.inp")).iter().map(|row| [row[1], row[0]]).collect();
    for (w, total) in sigma.column("w").iter().zip(sigma.column("sigma_total")) {
        assert!((between(&abaqus, *w) - total).abs() < 1e-9, "what was found, for ABAQUS: {w}");
        if *w >= 0.4 {
            let at = run.bridging.column("w").iter().position(|other| other >= w).expect("an opening");
            let right = run.bridging.column("sigma")[at];
            assert!((total / right - 1.0).abs() < 0.03, "{w}: {total} for {right}");
        }
    }
    // without f_L the same is found
    let text = std::fs::read_to_string(desk.path("own.csv")).expect("a file");
    let without: String =
        text.lines().filter_map(|line| line.split_once(',')).map(|(_, others)| format!("{others}\n")).collect();
    std::fs::write(desk.path("four.csv"), without).expect("a file");
    fit(&["four.csv", "--out", "four", "--set", "output.abaqus=true"], 0);
    let four = json(&desk.path("four/fit.json"));
    assert_eq!(four["numbers"], found["numbers"]);
    assert!(four["strengths"]["f_L"].is_null() && four["strengths"]["f_R"] == found["strengths"]["f_R"], "{four}");
    // from the load–CMOD curve of the same beam
    fit(&["out/beam.csv", "--out", "of-curve"], 0);
    let of_curve = json(&desk.path("of-curve/fit.json"));
    for (k, strength) in strengths.iter().enumerate() {
        let measured = of_curve["strengths"]["f_R"][k].as_f64().expect("a strength");
        assert!((measured - strength).abs() < 1e-9, "f_R{}: {measured}", k + 1);
    }
    // sigma is without the matrix's part, and sigma_total with it: Hordijk's of f_t 3, G_f 0.13, of 1 − V_f
    let matrix = |w: f64| {
        let x = w * 3.0 / 0.13 / 5.14;
        let falls = (1.0 + (3.0 * x).powi(3)) * (-6.93 * x).exp() - x * 28.0 * (-6.93_f64).exp();
        if x < 1.0 { 3.0 * falls * (1.0 - 0.005) } else { 0.0 }
    };
    let [w_of_run, fibres_of_run] = ["w", "sigma_fibre"].map(|name| run.bridging.column(name));
    let fibres: Vec<[f64; 2]> = w_of_run.iter().zip(fibres_of_run).map(|(w, sigma)| [*w, sigma]).collect();
    // strengths, the first at a CMOD of 0.5 mm, hardly determine what happens before
    for (folder, from, largest_error) in [("own", 0.2, 0.04), ("of-curve", 0.03, 0.05)] {
        let table = Table::read(&desk.path(&format!("{folder}/sigma.csv")));
        let numbers = json(&desk.path(&format!("{folder}/fit.json")))["numbers"].clone();
        let [openings, without, with] = ["w", "sigma", "sigma_total"].map(|name| table.column(name));
        for ((w, sigma), total) in openings.iter().zip(&without).zip(&with) {
            assert!((total - sigma - matrix(*w)).abs() < 1e-9, "{folder}, {w}: {sigma}, {total}");
            assert_eq!(numbers[format!("sigma({w})")]["value"].as_f64(), Some(*sigma), "{folder}, {w}");
            let right = between(&fibres, *w);
            if *w >= from {
                assert!((sigma - right).abs() < largest_error, "{folder}, {w}: {sigma} for {right}");
            }
        }
    }
    assert_eq!(of_curve["strengths"]["class"], found["strengths"]["class"]);
    assert_eq!(of_curve["strengths"]["class_en_1992_2023"], found["strengths"]["class_en_1992_2023"]);
    fit(&["three.csv", "--out", "three", "--shape", "bilinear"], 0);
    let sigma = Table::read(&desk.path("three/sigma.csv"));
    let columns = ["sigma_05", "sigma", "sigma_95"].map(|name| sigma.column(name));
    assert_eq!(columns[0].len(), 3, "where it begins, turns and ends");
    let three = json(&desk.path("three/fit.json"));
    let mut names = three["numbers"].as_object().expect("numbers").keys();
    assert!(names.all(|name| name.len() <= "sigma(0.12345)".len()), "openings with five digits: {}", three["numbers"]);
    // a crack begins with f_t
    assert!((1..3).all(|k| columns[0][k] < columns[1][k] && columns[1][k] < columns[2][k]), "{columns:?}");
    for (more, message) in [
        (&["none.csv"][..], "none.csv, line 3: f_R2 is 0: strengths are above 0"),
        (&["curve.csv"], "curve.csv, line 4: the CMOD 0.15 mm follows 0.2 mm"),
        (&["out/beam.csv", "--shape", "bilinear"], "--shape: needs strengths"),
    ] {
        let outcome = fit(more, 2);
        assert!(outcome.stderr.contains(message), "{more:?}: {}", outcome.stderr);
    }
}

/// Friction that is the same at all angles gives C2 without snubbing. The runs are kept for any later request,
/// and one that fails is named.
#[test]
fn curves_of_runs_give_the_closed_form() {
    let desk = Desk::new();
    let run = Results::of(&desk, "simulated.json", &[], "out");
    let sigma_0 = 0.5 * 0.01 * 24.4 / 0.406;
    for (w, sigma) in run.bridging.column("w").iter().zip(run.bridging.column("sigma_fibre")).skip(1) {
        let exact = sigma_0 * (1.0 - w / 12.2).max(0.0).powi(2);
        assert!((sigma - exact).abs() < 0.005 * sigma_0, "{w}: {sigma} for {exact}");
    }
    assert_eq!(run.number("/simulations/runs"), 2.0);
    let again = Results::of(&desk, "simulated.json", &[], "again");
    assert_eq!(again.number("/simulations/kept"), 2.0);
    assert!(bits(&run.folder, "bridging.csv") == bits(&again.folder, "bridging.csv"));
    // the curves are those of a table
    let table = r#"fibre={"diameter":0.406,"length":24.4,"E":210000,"model":"table","cut_deg":90,"file":"FILE"}"#;
    let table = table.replace("FILE", run.folder.join("fibres.csv").to_str().expect("UTF-8"));
    let of_table = Results::of(&desk, "simulated.json", &[&table], "table");
    assert!(bits(&run.folder, "bridging.csv") == bits(&of_table.folder, "bridging.csv"));
    let case = cases().join("bridging/simulated.json");
    let short = ["run", "--out", "short", "--set", r#"fibre.set={"steps.0.slip": 1}"#, case.to_str().expect("UTF-8")];
    let outcome = desk.pullout(short).expect(0);
    assert!(
        outcome.stderr.contains("fibre at 0°, 6.1 mm (and 1 more): its run ends at a slip of 1 mm with "),
        "{}",
        outcome.stderr
    );
    // the same runs as if they had failed at 8 mm and at 2 mm
    for (end, code) in [(8.0, 0), (2.0, 1)] {
        cut_off(&desk.path("out/fibres"), end);
        let outcome = desk.pullout(["run", "--out", "late", "--overwrite", case.to_str().expect("UTF-8")]).expect(code);
        let message = match code {
            0 => "fibre at 0°, 12.2 mm: its run ends at a slip of 7.9",
            _ => "fibre at 0°, 6.1 mm: planted",
        };
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
        let findings = &json(&desk.path("late/summary.json"))["bridging"]["simulations"];
        assert_eq!(findings["unfinished"].as_u64(), (code == 0).then_some(2));
    }
    let hopeless = r#"fibre.set={"controls":{"max_iterations":2,"force_tolerance":1e-15},"steps.0.increments.initial":0.002,"steps.0.increments.minimum":0.002}"#;
    let line = ["run", "--out", "failed", "--set", hopeless];
    let outcome = desk.pullout(line.iter().copied().chain([case.to_str().expect("UTF-8")])).expect(1);
    assert!(outcome.stderr.contains("fibre at 0°, 6.1 mm: "), "{}", outcome.stderr);
    assert_eq!(json(&desk.path("failed/summary.json"))["status"], "failed");
}

/// Ends the histories of runs at a slip, as those of runs that failed there.
fn cut_off(cache: &Path, end: f64) {
    for folder in std::fs::read_dir(cache).expect("a cache").map(|entry| entry.expect("an entry").path()) {
        if !folder.is_dir() {
            continue;
        }
        let file = folder.join("summary.json");
        let mut summary = json(&file);
        (summary["status"], summary["message"]) = ("failed".into(), "planted".into());
        std::fs::write(&file, summary.to_string()).expect("a summary");
        let history = folder.join("history.csv");
        let slip = Table::read(&history).column("slip").iter().take_while(|slip| **slip <= end).count();
        let text = std::fs::read_to_string(&history).expect("a history");
        let rows: Vec<&str> = text.lines().take(1 + slip).collect();
        std::fs::write(&history, rows.join("\n") + "\n").expect("a history");
    }
}

/// Checks that claims about σ(w) are found or not found, as the descriptions of the studies state.
fn have_their_verdicts(studies: &[(&str, usize)]) {
    let desk = Desk::new();
    for &(name, refuted) in studies {
        let study = cases().join(format!("bridging/claims-{name}.json"));
        desk.pullout(["study", "--quiet", "--out", name, study.to_str().expect("UTF-8")]).expect(0);
        let study = json(&desk.path(name).join("study.json"));
        let verdicts: Vec<&str> =
            study["claims"].as_array().expect("claims").iter().filter_map(|claim| claim["verdict"].as_str()).collect();
        let not_found = verdicts.iter().filter(|verdict| **verdict == "not found").count();
        assert!(!verdicts.contains(&"cannot be told"), "{name}");
        assert_eq!(not_found, refuted, "{name}: {study:#}");
    }
}

#[test]
fn the_claims_have_their_verdicts() {
    have_their_verdicts(&[("directions", 0), ("strength", 1), ("spalling", 0)]);
}

#[test]
#[ignore = "long: the_claims_have_their_verdicts of other studies"]
fn the_claims_about_tests_have_their_verdicts() {
    have_their_verdicts(&[("tests", 4)]);
}

/// A million beams take minutes; a signal ends them at once.
#[test]
fn scatter_heeds_signals() {
    use crate::program::{command, send};
    use rustix::process::Signal;
    use std::time::{Duration, Instant};
    let desk = Desk::new();
    let case = cases().join("bridging/closed.json");
    let mut process = command();
    process.current_dir(desk.path("")).args(["run", "--quiet", "--out", "out", "--set", "scatter={\"beams\":1000000}"]);
    let mut child = process.args(["--set", "beam={}"]).arg(case).spawn().expect("the program starts");
    let deadline = Instant::now() + Duration::from_secs(60);
    while !desk.path("out").exists() {
        assert!(Instant::now() < deadline && child.try_wait().expect("a child").is_none(), "no results");
        std::thread::sleep(Duration::from_millis(2));
    }
    std::thread::sleep(Duration::from_millis(300));
    send(Signal::TERM, child.id());
    assert_eq!(child.wait().expect("an end").code(), Some(143));
    assert_eq!(json(&desk.path("out/summary.json"))["status"], "interrupted");
}

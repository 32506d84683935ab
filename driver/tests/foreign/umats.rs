//! UMATs of different make.

use super::{built, close, point, run};
use crate::program::Desk;
use end_to_end_tests::{Tool, find};
use serde_json::{Value, json};

const E: f64 = 30_000.0;
const NU: f64 = 0.2;

fn tension(increments: u32, strain: f64) -> Value {
    json!([{ "increments": increments, "target": { "e11": strain } }])
}

#[test]
fn elasticity_in_every_language_and_number_of_components() {
    for (source, has_plane_stress) in
        [("elastic.f", true), ("elastic.c", false), ("elastic.cpp", false), ("upper_case.c", false)]
    {
        let desk = Desk::new();
        let Some(library) = built(&desk, source, &[]) else { continue };
        let material = json!({ "plugin": library, "props": [E, NU], "nstatv": 1 });
        let solid = run(&desk, "solid", &point(material.clone(), "3d", tension(4, 1e-3)));
        close(solid.history.last("s11"), E * 1e-3);
        close(solid.history.last("e22"), -NU * 1e-3);
        // e33 = 0: E/(1−ν²); about an axis with u_r free: uniaxial again
        let plane = run(&desk, "plane", &point(material.clone(), "plane_strain", tension(4, 1e-3)));
        close(plane.history.last("s11"), E / (1.0 - NU * NU) * 1e-3);
        close(plane.history.last("s33"), NU * E / (1.0 - NU * NU) * 1e-3);
        let axisymmetric = run(&desk, "axis", &point(material.clone(), "axisymmetric", tension(4, 1e-3)));
        close(axisymmetric.history.last("s11"), E * 1e-3);
        if has_plane_stress {
            let steps = json!([{ "increments": 4, "target": { "e11": 1e-3, "e22": 1e-3, "g12": 2e-3 } }]);
            let sheet = run(&desk, "sheet", &point(material, "plane_stress", steps));
            close(sheet.history.last("s11"), E / (1.0 - NU) * 1e-3);
            close(sheet.history.last("s12"), E / (2.0 * (1.0 + NU)) * 2e-3);
        }
    }
}

/// σ_y + (ε − σ_y/E) E H/(E + H).
fn hardened(strain: f64, modulus: f64, yield_stress: f64, hardening: f64) -> f64 {
    yield_stress + (strain - yield_stress / modulus) * modulus * hardening / (modulus + hardening)
}

#[test]
fn plasticity_that_saves_its_constants_and_calls_sinv() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "j2_save.f", &[]) else { return };
    let (modulus, yield_stress, hardening) = (210e3, 347.0, 2100.0);
    let material = json!({ "plugin": library, "props": [modulus, 0.3, yield_stress, hardening], "nstatv": 1 });
    let steps = json!([
        { "increments": 20, "target": { "e11": 0.01 } },
        { "increments": 3, "target": { "s11": 0.0 } },
    ]);
    let run = run(&desk, "j2", &point(material, "3d", steps));
    let stress = hardened(0.01, modulus, yield_stress, hardening);
    close(run.peak("s11", "max"), stress);
    // unloading is elastic: what stays is the plastic strain
    close(run.history.last("e11"), 0.01 - stress / modulus);
    close(run.history.last("sdv1"), 0.01 - stress / modulus);
}

#[test]
fn plasticity_in_free_form() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "j2.f90", &[]) else { return };
    let material = json!({ "plugin": library, "props": [210e3, 0.3, 347.0, 2100.0], "nstatv": 7 });
    let run = run(&desk, "j2", &point(material, "3d", tension(20, 0.01)));
    close(run.history.last("s11"), hardened(0.01, 210e3, 347.0, 2100.0));
}

#[test]
fn the_material_name_chooses_the_law() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "cmname.for", &[]) else { return };
    // without a name the library's own is passed, in capitals
    for (name, factor) in [(Some("steel-2"), 10.0), (Some("Mortar-C30"), 2.0), (Some("OTHER"), 1.0), (None, 1.0)] {
        let mut material = json!({ "plugin": library, "props": [E, NU], "nstatv": 0 });
        if let Some(name) = name {
            material["cmname"] = json!(name);
        }
        let run = run(&desk, "named", &point(material, "3d", tension(2, 1e-3)));
        close(run.history.last("s11"), factor * E * 1e-3);
    }
}

#[test]
fn libraries_that_share_names_run_side_by_side() {
    let desk = Desk::new();
    let (Some(a), Some(b)) = (built(&desk, "common_a.f", &[]), built(&desk, "common_b.f", &[])) else { return };
    let case =
        |library: Value| point(json!({ "plugin": library, "props": [E, NU], "nstatv": 1 }), "3d", tension(5, 1e-3));
    let files = [desk.case("a.json", &case(a)), desk.case("b.json", &case(b))];
    let out = desk.path("both");
    let [first, second] = files.each_ref().map(|file| file.to_str().expect("UTF-8"));
    desk.pullout(["run", "--quiet", "--out", out.to_str().expect("UTF-8"), first, second]).expect(0);
    for (name, factor) in [("a", 1.0), ("b", 3.0)] {
        let history = crate::program::Table::read(&out.join(name).join("history.csv"));
        close(history.last("s11"), factor * E * 1e-3);
        let summary = crate::program::json(&out.join(name).join("summary.json"));
        assert_eq!(history.last("sdv1"), summary["plugin_calls"].as_f64().expect("a number"), "own COMMON");
    }
}

#[test]
fn states_set_up_in_the_first_increment() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "first_increment.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [E, NU, 0.5], "nstatv": 2 });
    let steps = json!([
        { "increments": 4, "target": { "e11": 1e-3 } },
        { "increments": 4, "target": { "e11": 2e-3 } },
    ]);
    let run = run(&desk, "first", &point(material, "3d", steps));
    // E in the first step, E (1 + ½) in the second
    close(run.history.last("s11"), E * 1e-3 + 1.5 * E * 1e-3);
    assert_eq!((run.history.last("sdv1"), run.history.last("sdv2")), (E, 0.5));
}

#[test]
fn a_cut_back_by_pnewdt_is_honoured() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "cut_back.f", &[]) else { return };
    let largest = 1.1e-4;
    let material = json!({ "plugin": library, "props": [E, NU, largest], "nstatv": 1 });
    let run = run(&desk, "cut", &point(material, "3d", tension(2, 1e-3)));
    close(run.history.last("s11"), E * 1e-3);
    let taken = run.history.last("sdv1");
    assert!(taken > 0.0 && taken <= largest, "{taken}: states of refused increments are restored");
    assert!(run.summary["cutbacks"].as_u64() >= Some(2));
}

#[test]
fn the_analysis_is_announced_and_states_are_initialised() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "database.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [NU], "nstatv": 4 });
    let steps = json!([
        { "increments": 3, "time": 6.0, "target": { "e11": 1e-3 } },
        { "increments": 2, "target": { "e11": 2e-3 } },
    ]);
    let run = run(&desk, "database", &point(material.clone(), "3d", steps.clone()));
    // E = 1000 comes from LOP = 0
    close(run.history.last("s11"), 1000.0 * 2e-3);
    // element 1, point 1 at the origin
    assert!(run.history.column("sdv1").iter().all(|state| *state == 101.0));
    let ends = run.history.column("sdv3");
    assert_eq!(ends, [0.0, 0.0, 1.0, 2.0, 3.0, 4.0], "ended increments before each");
    let starts = run.history.column("sdv2");
    assert!(starts.windows(2).skip(1).all(|pair| pair[1] > pair[0]) && starts[1] >= 1.0, "{starts:?}");
    assert!(run.history.column("sdv4").iter().all(|difference| *difference == 0.0), "one clock");
    let log = run.log();
    let closed = log.lines().find(|line| line.contains("DATABASE CLOSED")).expect("LOP = 3");
    assert!(closed.split_whitespace().skip(3).eq(["5.0", "2", "2"]), "{closed}");
    // what the case says goes before SDVINI
    let mut given = material;
    given["statev0"] = json!([7.0, 0.0, 0.0, 0.0]);
    let given = super::run(&desk, "given", &point(given, "3d", steps));
    assert_eq!(given.history.last("sdv1"), 7.0);
}

#[test]
fn a_library_with_its_own_sinv_runs_its_own() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "own_sinv.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [E, NU], "nstatv": 1 });
    let run = run(&desk, "own", &point(material, "3d", tension(2, 1e-3)));
    close(run.history.last("sdv1"), -E * 1e-3);
}

#[test]
fn another_symbol_is_called_where_the_case_names_it() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "own_sinv.f", &[]) else { return };
    let material = |symbol: &str| json!({ "plugin": library, "props": [E, NU], "nstatv": 1, "symbol": symbol });
    let run = run(&desk, "named", &point(material("umat_"), "3d", tension(2, 1e-3)));
    close(run.history.last("s11"), E * 1e-3);
    let missing = desk.case("missing.json", &point(material("umat_of_mine"), "3d", tension(2, 1e-3)));
    let outcome = desk.pullout(["check", missing.to_str().expect("UTF-8")]).expect(3);
    assert!(
        outcome.stderr.contains("$.material.symbol") && outcome.stderr.contains("umat_of_mine"),
        "{}",
        outcome.stderr
    );
}

/// Symbols of libraries that a library only depends on are not its own: the loader finds a UMAT there, or `system` in
/// the C library.
#[test]
fn a_symbol_of_another_library_is_no_entry_point() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let Some(mut gcc) = find(Tool::C) else { return };
    desk.write("empty.c", "int nothing_of_the_kind;\n");
    let needs = library.as_str().expect("a file");
    let arguments = ["-shared", "-fPIC", "-o", "libempty.so", "empty.c", "-Wl,--no-as-needed", needs];
    let output = gcc.current_dir(desk.path("")).args(arguments).output().expect("gcc");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let case = point(json!({ "plugin": "./libempty.so", "props": [E, NU], "nstatv": 1 }), "3d", tension(2, 1e-3));
    desk.case("case.json", &case);
    let outcome = desk.pullout(["check", "case.json"]).expect(3);
    assert!(outcome.stderr.contains("has none of the symbols umat_"), "{}", outcome.stderr);
    let outcome = desk.pullout(["run", "case.json", "--set", "material.symbol=system"]).expect(3);
    assert!(outcome.stderr.contains("'system' is not the name of an entry point"), "{}", outcome.stderr);
}

/// gfortran -Ofast links a start-up routine that switches on flush-to-zero for the whole process.
#[test]
fn flush_to_zero_is_neutralised_and_named() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &["--flag=-Ofast"]) else { return };
    // a stress of 3e-310 MPa: below the normal numbers, and not 0
    let material = json!({ "plugin": library, "props": [3.0, 0.0], "nstatv": 1 });
    let steps = json!([{ "increments": 1, "target": { "e11": 1e-310, "e22": 0.0, "e33": 0.0 } }]);
    let run = run(&desk, "fast", &point(material, "3d", steps));
    assert_eq!(run.history.last("s11"), 3e-310);
    let warned = |text: &str| text.contains("libelastic.so") && text.contains("flush to zero");
    assert!(warned(&run.outcome.stderr), "{}", run.outcome.stderr);
    assert!(run.summary["warnings"].as_array().expect("a list").iter().any(|text| text.as_str().is_some_and(warned)));
}

/// A call that leaves the processor rounding towards zero: what comes after it rounds to nearest.
#[cfg(target_arch = "x86_64")]
#[test]
fn modes_that_a_call_leaves_behind_are_restored_and_named() {
    if find(Tool::C).is_none() {
        return;
    }
    let desk = Desk::new();
    desk.write(
        "towards_zero.c",
        "#include <xmmintrin.h>\nvoid umat_(double *s, double *v, double *d) {\n    (void)v;\n    s[0] = 1.0;\n    \
         for (int i = 0; i < 36; i++) d[i] = i % 7 == 0;\n    _mm_setcsr(_mm_getcsr() | 0x6000);\n}\n",
    );
    desk.pullout(["plugin", "build", "towards_zero.c"]).expect(0);
    let material = json!({ "plugin": "./libtowards_zero.so", "props": [], "nstatv": 0 });
    let end = json!({ "e11": 1e-3, "e22": 0, "e33": 0, "g12": 0, "g13": 0, "g23": 0 });
    let steps = json!([{ "increments": 10, "target": end }]);
    let run = run(&desk, "modes", &point(material, "3d", steps));
    // k/10 of the end, as rounding to nearest has it
    let expected: Vec<f64> = (0..=10).map(|k| if k == 10 { 1e-3 } else { f64::from(k) / 10.0 * 1e-3 }).collect();
    assert_eq!(run.history.column("e11"), expected);
    let words = &run.outcome.stderr;
    assert!(words.contains("libtowards_zero.so") && words.contains("floating-point modes"), "{words}");
}

#[test]
fn a_plugin_that_ends_the_analysis_fails_the_run() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "stops.f", &[]) else { return };
    for (how, message) in [
        (1, "plugin 'stops', step 1, increment 5: it ended the process instead of returning, exit code 0 (STOP"),
        (2, "the plugin ended the analysis (it called XIT)"),
        (3, "DAMAGE IN ELEMENT 1, POINT 1 AT STRAIN 0.0004"),
    ] {
        let material = json!({ "plugin": library, "props": [E, NU, how, 4.5e-4], "nstatv": 0 });
        let case = desk.case("case.json", &point(material, "3d", tension(10, 1e-3)));
        let out = desk.path("stopped");
        let arguments = ["run", "--quiet", "--out", out.to_str().expect("UTF-8"), case.to_str().expect("UTF-8")];
        let outcome = desk.pullout(arguments).expect(1);
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
        let history = crate::program::Table::read(&out.join("history.csv"));
        assert_eq!(history.rows.len(), 5, "what was finished is kept");
        let replay = out.join("replay.json");
        let again = desk.pullout(["run", "--quiet", replay.to_str().expect("UTF-8")]).expect(1);
        assert!(again.stderr.contains(message.rsplit("it ended").next().expect("words")), "{}", again.stderr);
        close(history.last("s11"), E * 4e-4);
    }
}

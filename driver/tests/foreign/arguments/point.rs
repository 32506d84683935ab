//! At a material point.

use super::{IDENTITY, LARGE, calls, expect, values};
use crate::program::Desk;
use crate::{built, run};
use serde_json::json;

#[test]
fn umat_at_a_point() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let target = json!({ "e11": 5e-3, "e22": 1e-3, "e33": 0, "g12": 4e-3, "g13": 0, "g23": -2e-3 });
    let case = json!({
        "kind": "point", "mode": "3d", "characteristic_length": 12.5, "temperature": 20, "predef": [1, 2],
        "material": { "plugin": library, "props": [1000, 2, 8], "nstatv": 2, "cmname": "Steel-1" },
        "initial": { "strain": { "e11": 1e-3 }, "stress": { "s11": 1, "s22": 3 }, "statev": [4, 5], "time": 10 },
        "steps": [
            { "increments": 2, "time": 4, "target": target, "temperature": 30, "predef": [3, 6] },
            { "increments": 1, "time": 2, "target": target },
        ],
    });
    let run = run(&desk, "point", &case);
    let calls = calls(&run.log(), "UMAT");
    // whether it keeps the initial stress is asked first
    let [asked, calls @ ..] = &calls[..] else { panic!("no call") };
    assert_eq!(values(&asked["stress"]), [1.0, 3.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(values(&asked["dstran"]).iter().all(|x| *x == 0.0));
    assert_eq!(calls.len(), 3, "one call per increment where strains are given");
    // the second increment of the first step
    let expected: [(&str, &[f64]); 36] = [
        ("stress", &[1.0 + 2.0, 3.0 + 0.5, 0.0, 1.0, 0.0, -0.5]),
        ("statev", &[5.0, 5.0]),
        ("ddsdde", &[0.0; 36]),
        ("sse", &[1.0]),
        ("spd", &[2.0]),
        ("scd", &[3.0]),
        ("rpl", &[0.0]),
        ("ddsddt", &[0.0; 6]),
        ("drplde", &[0.0; 6]),
        ("drpldt", &[0.0]),
        ("stran", &[3e-3, 0.5e-3, 0.0, 2e-3, 0.0, -1e-3]),
        ("dstran", &[2e-3, 0.5e-3, 0.0, 2e-3, 0.0, -1e-3]),
        // step time and total time at the start
        ("time", &[2.0, 12.0]),
        ("dtime", &[2.0]),
        ("temp", &[25.0]),
        ("dtemp", &[5.0]),
        ("predef", &[2.0, 4.0]),
        ("dpred", &[1.0, 2.0]),
        ("ndi", &[3.0]),
        ("nshr", &[3.0]),
        ("ntens", &[6.0]),
        ("nstatv", &[2.0]),
        ("props", &[1000.0, 2.0, 8.0]),
        ("nprops", &[3.0]),
        ("coords", &[0.0; 3]),
        ("drot", &IDENTITY),
        ("pnewdt", &[LARGE]),
        ("celent", &[12.5]),
        ("dfgrd0", &IDENTITY),
        ("dfgrd1", &IDENTITY),
        ("noel", &[1.0]),
        ("npt", &[1.0]),
        ("layer", &[1.0]),
        ("kspt", &[1.0]),
        // step, static procedure, no NLGEOM, no perturbation
        ("jstep", &[1.0, 1.0, 0.0, 0.0]),
        ("kinc", &[2.0]),
    ];
    expect(&calls[1], &expected, &[("cmname", "STEEL-1")]);
    // the next step: its own time from 0, increments from 1, what the last one ended with
    let next = &calls[2];
    for (name, expected) in [
        ("time", "0,14"),
        ("dtime", "2"),
        ("temp", "30"),
        ("dtemp", "0"),
        ("predef", "3,6"),
        ("dpred", "0,0"),
        ("jstep", "2,1,0,0"),
        ("kinc", "1"),
        ("statev", "6,5"),
        ("sse", "2"),
    ] {
        assert_eq!(next[name], expected, "{name}");
    }
    assert!(values(&next["dstran"]).iter().all(|x| *x == 0.0));
}

#[test]
fn umat_under_finite_strain() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    // a quarter of the way to a shear: no component of F or DROT is like another
    let f = [[1.1, 0.4, 0.0], [0.0, 0.9, 0.2], [0.0, 0.0, 1.2]];
    let case = json!({
        "kind": "point", "mode": "3d", "nlgeom": true,
        "material": { "plugin": library, "props": [1000], "nstatv": 1 },
        "initial": { "stress": { "s11": 10 } },
        "steps": [{ "increments": 2, "F": f }],
    });
    let run = run(&desk, "finite", &case);
    // the first asks whether it keeps the initial stress
    let calls = &calls(&run.log(), "UMAT")[1..];
    let columns = |f: [[f64; 3]; 3]| (0..9).map(|k| f[k % 3][k / 3]).collect::<Vec<_>>();
    let half = [[1.05, 0.2, 0.0], [0.0, 0.95, 0.1], [0.0, 0.0, 1.1]];
    let close = |found: &str, expected: &[f64]| {
        let found = values(found);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} instead of {expected:?}");
    };
    close(&calls[0]["dfgrd0"], &IDENTITY);
    close(&calls[0]["dfgrd1"], &columns(half));
    close(&calls[1]["dfgrd0"], &columns(half));
    close(&calls[1]["dfgrd1"], &columns(f));
    assert_eq!(calls[0]["jstep"], "1,1,1,0");
    // DROT is a rotation that turns axis 2 towards 1 (the shear F12 > 0): DROT(1,2) > 0; STRESS comes turned by it
    let drot = values(&calls[0]["drot"]);
    let r = |row: usize, column: usize| drot[3 * column + row];
    assert!(r(0, 1) > 0.05 && r(1, 0) < -0.05);
    for i in 0..3 {
        for j in 0..3 {
            let product: f64 = (0..3).map(|k| r(i, k) * r(j, k)).sum();
            assert!((product - f64::from(i == j)).abs() < 1e-14);
        }
    }
    let turned = |i: usize, j: usize| 10.0 * r(i, 0) * r(j, 0);
    close(&calls[0]["stress"], &[turned(0, 0), turned(1, 1), turned(2, 2), turned(0, 1), turned(0, 2), turned(1, 2)]);
}

/// NTENS, NDI, NSHR and the components of each mode.
#[test]
fn umat_in_every_mode() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let target = json!({ "e11": 2e-3, "e22": -1e-3, "e33": 3e-3, "g12": 4e-3, "g13": 5e-3, "g23": 6e-3 });
    for (mode, counts, strains) in [
        ("3d", ["6", "3", "3"], &[2e-3, -1e-3, 3e-3, 4e-3, 5e-3, 6e-3][..]),
        ("axisymmetric", ["4", "3", "1"], &[2e-3, -1e-3, 3e-3, 4e-3]),
        ("plane_strain", ["4", "3", "1"], &[2e-3, -1e-3, 0.0, 4e-3]),
        ("plane_stress", ["3", "2", "1"], &[2e-3, -1e-3, 4e-3]),
    ] {
        let mut target = target.clone();
        let named = target.as_object_mut().expect("an object");
        if mode != "3d" {
            named.retain(|name, _| !["g13", "g23"].contains(&name.as_str()));
        }
        if mode.starts_with("plane") {
            named.remove("e33");
        }
        let case = json!({
            "kind": "point", "mode": mode, "material": { "plugin": library, "props": [1000], "nstatv": 1 },
            "steps": [{ "increments": 2, "target": target }],
        });
        let run = run(&desk, mode, &case);
        let last = calls(&run.log(), "UMAT").pop().expect("a call");
        assert_eq!(["ntens", "ndi", "nshr"].map(|name| last[name].as_str()), counts, "{mode}");
        let n = strains.len();
        let halves: Vec<_> = strains.iter().map(|strain| 0.5 * strain).collect();
        let direct = if n == 3 { 2 } else { 3 };
        let stress = |k: usize| halves[k] * if k < direct { 1000.0 } else { 500.0 };
        for (name, expected) in [
            ("stran", halves.clone()),
            ("dstran", halves.clone()),
            ("stress", (0..n).map(stress).collect()),
            ("ddsdde", vec![0.0; n * n]),
            ("ddsddt", vec![0.0; n]),
            ("drplde", vec![0.0; n]),
        ] {
            let found = values(&last[name]);
            let close = found.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-14 * b.abs());
            assert!(found.len() == n.max(expected.len()) && close, "{mode}, {name}: {found:?}, not {expected:?}");
        }
    }
}

/// The state before a failed increment, and a strain at its end, lead to the same call bit by bit.
#[test]
fn a_replay_at_finite_strain_calls_with_the_same_bits() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let target =
        |x: f64| json!({ "e11": 0.3 * x, "e22": -0.1, "e33": 0.07 * x, "g12": 0.4, "g13": 0.1 * x, "g23": -0.2 });
    let case = |steps: [&serde_json::Value; 3]| {
        json!({
            "kind": "point", "mode": "3d", "nlgeom": true, "steps": steps,
            "material": { "plugin": library, "props": [1000], "nstatv": 1 },
        })
    };
    let turned = json!({ "increments": 3, "F": [[1.1, 0.4, 0.0], [0.0, 0.9, 0.2], [0.1, 0.0, 1.2]] });
    let stretched = json!({ "increments": 3, "time": 0.7, "target": target(1.0) });
    // half-way to half a turn nothing is left of the volume
    let half_turn = json!({ "increments": 1, "F": [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]] });
    let last = json!({ "increments": 1, "time": 0.3, "target": target(-1.3) });
    let failed = desk.case("fails.json", &case([&turned, &stretched, &half_turn]));
    let failed = desk.run(&failed, &[], "fails", 1);
    let mut replay = crate::program::json(&failed.folder.join("replay.json"));
    replay["steps"] = json!([last]);
    let [whole, again] = [("whole", &case([&turned, &stretched, &last])), ("again", &replay)].map(|(name, case)| {
        let run = run(&desk, name, case);
        calls(&run.log(), "UMAT").pop().expect("a call")
    });
    assert_eq!(whole, again);
    assert!(values(&whole["drot"])[1] != 0.0 && values(&whole["stran"])[3] != 0.0);
}

/// STRAN turns with the material; the history's strain is that of U.
#[test]
fn stran_turns_and_the_strain_of_the_history_does_not() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let stretched = json!({ "e11": 0.2, "e22": 0, "e33": 0, "g12": 0, "g13": 0, "g23": 0 });
    let (sine, cosine) = 1.2_f64.sin_cos();
    let stretch = 0.2_f64.exp();
    let turned = [[cosine * stretch, -sine, 0.0], [sine * stretch, cosine, 0.0], [0.0, 0.0, 1.0]];
    let case = json!({
        "kind": "point", "mode": "3d", "nlgeom": true,
        "material": { "plugin": library, "props": [1000], "nstatv": 1 },
        "steps": [{ "increments": 1, "target": stretched }, { "increments": 1, "F": turned }],
    });
    let run = run(&desk, "turned", &case);
    let calls = calls(&run.log(), "UMAT");
    let stran = values(&calls[1]["stran"]);
    let midpoint = 2.0 * 0.1_f64.tanh();
    let expected = [midpoint * cosine * cosine, midpoint * sine * sine, 0.0, 2.0 * midpoint * sine * cosine];
    for (found, expected) in stran.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-14, "{stran:?} instead of {expected:?}");
    }
    for row in 1..=2 {
        let [e11, e22, g12] = ["e11", "e22", "g12"].map(|name| run.history.column(name)[row]);
        assert!((e11 - 0.2).abs() < 1e-14 && e22.abs() < 1e-14 && g12.abs() < 1e-14);
    }
}

/// F33 of plane stress is that of a constant volume, as ABAQUS has it, which is said.
#[test]
fn plane_stress_at_finite_strain() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let mut case = json!({
        "kind": "point", "mode": "plane_stress", "nlgeom": true,
        "material": { "plugin": library, "props": [1000], "nstatv": 1 },
        "steps": [{ "increments": 1, "target": { "e11": 0.3, "e22": -0.1, "g12": 0.4 } }],
    });
    let run = run(&desk, "plane", &case);
    let f = values(&calls(&run.log(), "UMAT").pop().expect("a call")["dfgrd1"]);
    assert!((f[8] * 0.2_f64.exp() - 1.0).abs() < 1e-14 && f[1] > 0.1 && f[1] == f[3], "{f:?}");
    assert!(run.history.last("F33").is_nan() && run.history.last("e33").is_nan());
    // reported once, with the column that follows from it
    let warnings = run.summary["warnings"].as_array().expect("a list");
    let reported: Vec<_> = warnings.iter().filter(|warning| warning.to_string().contains("NaN")).collect();
    assert!(reported.len() == 1 && reported[0].to_string().contains("F33 and the column e33 are NaN"), "{warnings:?}");
    // trial calls find that it works with three components
    case["measure"] = json!("nominal");
    let failed = desk.run(&desk.case("nominal.json", &case), &[], "nominal", 1).outcome.stderr;
    assert!(failed.contains("$.measure") && failed.contains("mode 3d"), "{failed}");
    case["material"]["as"] = json!("plane");
    let refused = desk.pullout(["check".as_ref(), desk.case("nominal.json", &case).as_os_str()]).expect(2);
    assert!(refused.stderr.contains("$.measure") && refused.stderr.contains("mode 3d"), "{}", refused.stderr);
}

//! What each argument of UMAT, UINTER and FRIC is: a plugin prints them (tests/umats/print.c), and each is matched.

use super::{built, run};
use crate::program::Desk;
use serde_json::json;
use std::collections::BTreeMap;

/// The arguments of each call, by name, as printed.
fn calls(stdout: &str, entry: &str) -> Vec<BTreeMap<String, String>> {
    let lines = stdout.lines().filter_map(|line| line.strip_prefix(entry)?.strip_prefix(' '));
    lines
        .map(|line| {
            let pairs = line.split(' ').map(|pair| pair.split_once('=').unwrap_or_else(|| panic!("'{pair}'")));
            pairs.map(|(name, value)| (name.to_owned(), value.to_owned())).collect()
        })
        .collect()
}

fn values(text: &str) -> Vec<f64> {
    text.split(',').map(|value| value.parse().unwrap_or_else(|_| panic!("'{text}'"))).collect()
}

/// Asserts that a call has just these arguments, to rounding; names that blanks pad to 80.
fn expect(call: &BTreeMap<String, String>, expected: &[(&str, &[f64])], names: &[(&str, &str)]) {
    for (name, expected) in expected {
        let found = values(&call[*name]);
        let close = found.iter().zip(*expected).all(|(a, b)| (a - b).abs() <= 1e-14 * b.abs().max(1e-3));
        assert!(found.len() == expected.len() && close, "{name}: {found:?} instead of {expected:?}");
    }
    for (name, text) in names {
        assert_eq!(call[*name], format!("{text:_<80},80"), "{name}");
    }
    let told: Vec<&str> = expected.iter().map(|(name, _)| *name).chain(names.iter().map(|(name, _)| *name)).collect();
    let forgotten: Vec<_> = call.keys().filter(|name| !told.contains(&name.as_str())).collect();
    assert!(forgotten.is_empty(), "not matched: {forgotten:?}");
}

const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
/// PNEWDT on entry.
const LARGE: f64 = 1e36;

#[test]
fn umat_at_a_point() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let target = json!({ "e11": 5e-3, "e22": 1e-3, "e33": 0, "g12": 4e-3, "g13": 0, "g23": -2e-3 });
    let case = json!({
        "kind": "point", "mode": "3d", "characteristic_length": 12.5, "temperature": 20, "predef": [1, 2],
        "material": { "plugin": library, "props": [1000, 7, 8], "nstatv": 2, "cmname": "Steel-1" },
        "initial": { "strain": { "e11": 1e-3 }, "stress": { "s11": 1, "s22": 3 }, "statev": [4, 5], "time": 10 },
        "steps": [
            { "increments": 2, "time": 4, "target": target, "temperature": 30, "predef": [3, 6] },
            { "increments": 1, "time": 2, "target": target },
        ],
    });
    let run = run(&desk, "point", &case);
    let calls = calls(&run.outcome.stdout, "UMAT");
    assert_eq!(calls.len(), 3, "one call per increment where strains are given");
    // the second increment of the first step
    let expected: [(&str, &[f64]); 36] = [
        ("stress", &[1.0 + 2.0, 3.0 + 0.5, 0.0, 1.0, 0.0, -0.5]),
        ("statev", &[5.0, 5.0]),
        ("ddsdde", &[0.0; 36]),
        ("sse", &[1.0]),
        ("spd", &[2.0]),
        ("scd", &[3.0]),
        ("rpl", &[9.0]),
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
        ("props", &[1000.0, 7.0, 8.0]),
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
    let calls = calls(&run.outcome.stdout, "UMAT");
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

#[test]
fn uinter_at_a_point() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let case = json!({
        "kind": "interface", "characteristic_length": 2.5,
        "material": { "plugin": library, "props": [100, 6], "nstatv": 1, "cmname": "bond" },
        "initial": { "slip": 0.01, "gap": 0.02, "time": 5 },
        "steps": [{ "increments": 2, "time": 4, "target": { "slip": 0.05, "gap": -0.02 } }],
    });
    let run = run(&desk, "uinter", &case);
    let calls = calls(&run.outcome.stdout, "UINTER");
    assert_eq!(calls.len(), 3, "one at the initial place, then one per increment");
    assert_eq!((&*calls[0]["lopenclose"], &*calls[0]["lstate"]), ("-1", "-1"));
    // the last call: from gap 0, slip 0.03 to penetration 0.02, slip 0.05; everything at the end of the increment
    let expected: [(&str, &[f64]); 44] = [
        ("stress", &[2.0, 2.0]),
        ("ddsddr", &[0.0; 4]),
        ("dviscous", &[0.0; 4]),
        ("dstructural", &[0.0; 4]),
        ("flux", &[0.0; 2]),
        ("ddfddt", &[0.0; 4]),
        ("ddsddt", &[0.0; 4]),
        ("ddfddr", &[0.0; 4]),
        ("statev", &[1.0]),
        ("sed", &[1.0]),
        ("sfd", &[2.0]),
        ("spd", &[3.0]),
        ("svd", &[4.0]),
        ("scd", &[5.0]),
        ("pnewdt", &[LARGE]),
        ("rdisp", &[0.02, 0.05]),
        ("drdisp", &[0.02, 0.02]),
        ("temp", &[0.0; 2]),
        ("dtemp", &[0.0; 2]),
        ("predef", &[0.0; 2]),
        ("dpred", &[0.0; 2]),
        ("time", &[4.0, 9.0]),
        ("dtime", &[2.0]),
        ("freqr", &[0.0]),
        ("props", &[100.0, 6.0]),
        ("coords", &[0.0; 3]),
        // column 1 is the normal
        ("alocaldir", &IDENTITY),
        ("drot", &[1.0, 0.0, 0.0, 1.0]),
        ("area", &[1.0]),
        ("chrlngth", &[2.5]),
        ("node", &[1.0]),
        ("ndir", &[2.0]),
        ("nstatv", &[1.0]),
        ("npred", &[1.0]),
        ("nprops", &[2.0]),
        ("mcrd", &[3.0]),
        ("kstep", &[1.0]),
        ("kinc", &[2.0]),
        ("kit", &[1.0]),
        ("linper", &[0.0]),
        // as the plugin left them; LSDI is 0 at each call
        ("lopenclose", &[1.0]),
        ("lstate", &[2.0]),
        ("lsdi", &[0.0]),
        ("lprint", &[0.0]),
    ];
    expect(&calls[2], &expected, &[("ciname", "BOND"), ("slname", "SLAVE"), ("msname", "MASTER")]);
}

#[test]
fn fric_at_a_point() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let case = json!({
        "kind": "interface",
        "material": { "plugin": library, "entry": "fric", "props": [100], "nstatv": 1 },
        "steps": [{ "increments": 2, "time": 4, "target": { "slip": 0.04, "p": 6 } }],
    });
    let run = run(&desk, "fric", &case);
    let calls = calls(&run.outcome.stdout, "FRIC");
    assert_eq!(calls.len(), 2);
    assert_eq!(calls[0]["lm"], "1", "sticking until the plugin says otherwise");
    let expected: [(&str, &[f64]); 36] = [
        ("lm", &[0.0]),
        ("tau", &[2.0]),
        ("ddtddg", &[0.0]),
        ("ddtddp", &[0.0]),
        ("dslip", &[0.0]),
        ("sed", &[1.0]),
        ("sfd", &[2.0]),
        ("ddtddt", &[0.0; 2]),
        ("pnewdt", &[LARGE]),
        ("statev", &[1.0]),
        ("dgam", &[0.02]),
        ("taulm", &[0.0]),
        // at the end, and its increment
        ("press", &[6.0]),
        ("dpress", &[3.0]),
        ("ddpddh", &[0.0]),
        // what the plugin called slip so far: half of it
        ("slip", &[0.01]),
        ("kstep", &[1.0]),
        ("kinc", &[2.0]),
        ("time", &[2.0, 2.0]),
        ("dtime", &[2.0]),
        ("noel", &[1.0]),
        ("npt", &[1.0]),
        ("node", &[1.0]),
        ("npatch", &[1.0]),
        ("coords", &[0.0; 3]),
        ("rcoord", &[0.0; 3]),
        ("drot", &[1.0, 0.0, 0.0, 1.0]),
        ("temp", &[0.0; 2]),
        ("predef", &[0.0; 2]),
        ("nfdir", &[1.0]),
        ("mcrd", &[3.0]),
        ("npred", &[1.0]),
        ("nstatv", &[1.0]),
        ("chrlngth", &[1.0]),
        ("props", &[100.0]),
        ("nprops", &[1.0]),
    ];
    expect(&calls[1], &expected, &[("ciname", "PRINT"), ("slname", "SLAVE"), ("msname", "MASTER")]);
}

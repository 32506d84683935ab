//! Paths whose strains go on while no stress grows: creep, relaxation, swelling, lateral unloading, dilatancy, cycles. Each
//! ends where a closed form or a quadrature says, with increments of any size.

use super::{CLOSE, built, built_of, point, run};
use crate::program::Desk;
use serde_json::{Value, json};

/// E, ν.
const BODY: [f64; 2] = [1e5, 0.3];
const G: f64 = BODY[0] / (2.0 * (1.0 + BODY[1]));
const K: f64 = BODY[0] / (3.0 * (1.0 - 2.0 * BODY[1]));

/// A case of `rheology.f90`.
fn body(library: &Value, kind: u32, more: &[f64], mode: &str, steps: Value) -> Value {
    let props: Vec<f64> = [f64::from(kind)].into_iter().chain(BODY).chain(more.iter().copied()).collect();
    point(json!({ "plugin": library, "props": props, "nstatv": 1 }), mode, steps)
}

/// Runs a case and compares the last of a column.
#[track_caller]
fn ends_at(desk: &Desk, name: &str, case: &Value, column: &str, expected: f64, tolerance: f64) {
    let found = run(desk, name, case).history.last(column);
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{name}: {column} {found} instead of {expected}");
}

/// A load at once, and the same held for a time.
fn load_and_hold(target: &Value, increments: u32, time: f64) -> Value {
    let hold: serde_json::Map<_, _> =
        target.as_object().expect("a target").keys().map(|key| (key.clone(), json!("hold"))).collect();
    json!([
        { "increments": 1, "time": 1e-9, "target": target },
        { "increments": increments, "time": time, "target": hold },
    ])
}

/// Maxwell's body: the deviator's strain grows by t/τ of its elastic one, here to 400 times; backward Euler is exact then.
#[test]
fn a_maxwell_body_creeps_to_the_end() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "rheology.f90", &[]) else { return };
    let (tau, time, stress) = (0.05, 20.0, 10.0);
    let axial = |stress: f64| stress / (9.0 * K) + stress / (3.0 * G) * (1.0 + time / tau);
    let shear = |stress: f64| stress / G * (1.0 + time / tau);
    let mut k = 0;
    let mut check = |mode: &str, keys: Value, steps: Value, column: &str, expected: f64, tolerance: f64| {
        k += 1;
        let mut case = body(&library, 1, &[tau], mode, steps);
        for (key, value) in keys.as_object().into_iter().flatten() {
            match key.as_str() {
                "nlgeom" => case[key] = value.clone(),
                _ => case["material"][key] = value.clone(),
            }
        }
        ends_at(&desk, &format!("maxwell{k}"), &case, column, expected, tolerance);
    };
    for increments in [1, 2, 5, 40, 400, 4000] {
        let steps = load_and_hold(&json!({ "s11": stress }), increments, time);
        check("3d", json!({}), steps, "e11", axial(stress), CLOSE);
    }
    let steps = |target: Value| load_and_hold(&target, 100, time);
    check("3d", json!({}), steps(json!({ "s11": -stress })), "e11", axial(-stress), CLOSE);
    check("axisymmetric", json!({}), steps(json!({ "s22": stress })), "e22", axial(stress), CLOSE);
    check("plane_stress", json!({ "as": "3d" }), steps(json!({ "s11": stress })), "e11", axial(stress), 1e-6);
    check("3d", json!({}), steps(json!({ "s12": stress })), "g12", shear(stress), CLOSE);
    check("plane_strain", json!({}), steps(json!({ "s12": -stress })), "g12", shear(-stress), CLOSE);
    check("3d", json!({ "tangent": "numerical" }), steps(json!({ "s11": stress })), "e11", axial(stress), 1e-6);
    // DSTRAN is that of the midpoint: of second order in increments of 3e-4
    check("3d", json!({ "nlgeom": true }), steps(json!({ "s11": stress })), "e11", axial(stress), 1e-6);
    // equal in two directions
    let both = stress * 2.0 / (9.0 * K) + stress / (6.0 * G) * (1.0 + time / tau);
    check("3d", json!({}), steps(json!({ "s11": stress, "s22": stress })), "e11", both, CLOSE);
    // a stress that falls to half, and one that stays as a table says: sums of s Δt/τ
    let count = 800;
    let sum: f64 =
        (1..=count).map(|k| 1.0 - 0.5 * f64::from(k) / f64::from(count)).sum::<f64>() * time / f64::from(count);
    let falling = 0.5 * stress / (9.0 * K) + stress / (3.0 * G) * (0.5 + sum / tau);
    let load = json!({ "increments": 1, "time": 1e-9, "target": { "s11": stress } });
    let to_half = json!([load, { "increments": count, "time": time, "target": { "s11": 0.5 * stress } }]);
    check("3d", json!({}), to_half, "e11", falling, 1e-8);
    let rows: String = (1..=200).map(|k| format!("{},{stress}\n", f64::from(k) * 0.1)).collect();
    desk.write("constant.csv", &format!("time,s11\n{rows}"));
    check("3d", json!({}), json!([load, { "table": "constant.csv" }]), "e11", axial(stress), 1e-9);
    // a strain that is held: the shear stress decays
    let held = json!([
        { "increments": 1, "time": 1e-9, "target": { "g12": 1e-3 } },
        { "increments": 50, "time": 0.5, "target": { "g12": "hold" } },
    ]);
    check("3d", json!({}), held, "s12", G * 1e-3 * (1.0 + 0.01 / tau).powi(-50), 1e-7);
}

/// Norton's creep: at a held stress the rate is constant, from 1e-3 to 0.1.
#[test]
fn a_norton_body_creeps_to_the_end() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "rheology.f90", &[]) else { return };
    let (a, n, time, stress) = (1e-13, 5.0, 100.0, 100.0);
    let creep = |stress: f64, time: f64| a * f64::powf(stress, n) * time;
    let axial = stress / BODY[0] + creep(stress, time);
    let case = |mode: &str, steps: Value| body(&library, 2, &[a, n], mode, steps);
    for increments in [1, 10, 100, 1000] {
        let steps = load_and_hold(&json!({ "s11": stress }), increments, time);
        ends_at(&desk, &format!("norton{increments}"), &case("3d", steps), "e11", axial, CLOSE);
    }
    let steps = load_and_hold(&json!({ "s11": stress }), 100, time);
    let mut finite = case("3d", steps);
    finite["nlgeom"] = json!(true);
    ends_at(&desk, "finite", &finite, "e11", axial, 1e-6);
    // q = s in equal tension along two axes: half the rate along each
    let steps = load_and_hold(&json!({ "s11": stress, "s22": stress }), 50, time);
    let both = stress * (1.0 - BODY[1]) / BODY[0] + 0.5 * creep(stress, time);
    ends_at(&desk, "both", &case("3d", steps), "e11", both, CLOSE);
    let shear = stress / 3.0_f64.sqrt();
    let steps = load_and_hold(&json!({ "s12": shear }), 50, time);
    let sheared = shear / G + 3.0_f64.sqrt() * creep(stress, time);
    ends_at(&desk, "shear", &case("plane_strain", steps), "g12", sheared, 1e-7);
    // half of the stress in a second step
    let mut steps = load_and_hold(&json!({ "s11": stress }), 50, time);
    let steps = steps.as_array_mut().expect("steps");
    steps.push(json!({ "increments": 1, "time": 1e-9, "target": { "s11": 0.5 * stress } }));
    steps.push(json!({ "increments": 3, "time": time, "target": { "s11": "hold" } }));
    let last = 0.5 * stress / BODY[0] + creep(stress, time) + creep(0.5 * stress, time);
    ends_at(&desk, "stairs", &case("3d", json!(steps)), "e11", last, 1e-8);
    // the axial strain is held: σ^(1−n) grows by (n − 1) E A t; backward Euler, of first order
    let relaxed = (f64::powf(stress, 1.0 - n) + (n - 1.0) * BODY[0] * a * 1.0e3).powf(1.0 / (1.0 - n));
    let steps = json!([
        { "increments": 1, "time": 1e-9, "target": { "s11": stress } },
        { "increments": 20_000, "time": 1.0e3, "target": { "e11": "hold" } },
    ]);
    ends_at(&desk, "relaxation", &case("3d", steps), "s11", relaxed, 1e-3);
}

/// A body that swells with time, as slowly drying concrete shrinks with √t, and with temperature, under little or no stress: from
/// strains of rounding on.
#[test]
fn a_body_swells_freely() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "rheology.f90", &[]) else { return };
    let (a, time, small) = (-1e-4, 25.0, 1e-6);
    let mut k = 0;
    let mut check = |power: f64, steps: Value, stress: f64| {
        k += 1;
        let case = body(&library, 3, &[a, power, 0.0], "3d", steps);
        let expected = stress / BODY[0] + a * f64::powf(time, power);
        ends_at(&desk, &format!("swelling{k}"), &case, "e11", expected, 1e-6);
    };
    for power in [0.25, 0.5, 1.0] {
        for increments in [1, 50] {
            check(power, json!([{ "increments": increments, "time": time, "target": { "s11": 0.0 } }]), 0.0);
            check(power, load_and_hold(&json!({ "s11": small }), increments, time), small);
        }
    }
    // loaded and unloaded before: what is left is rounding
    let steps = json!([
        { "increments": 3, "time": 1e-9, "target": { "s11": 30.0 } },
        { "increments": 3, "time": 1e-9, "target": { "s11": 0.0 } },
        { "increments": 50, "time": time, "target": { "s11": "hold" } },
    ]);
    check(0.5, steps, 0.0);
    let steps = json!([
        { "increments": 1, "target": { "s11": 10.0 } },
        { "increments": 10, "target": { "s11": 10.0 }, "temperature": 100.0 },
    ]);
    let mut case = body(&library, 3, &[0.0, 1.0, 1.2e-5], "3d", steps);
    case["temperature"] = json!(0.0);
    ends_at(&desk, "heated", &case, "e11", 10.0 / BODY[0] + 1.2e-3, CLOSE);
}

/// Steel under all-round pressure whose sides are unloaded: q grows to 280 MPa though no stress grows; plastic strain (280 − 200)/2000.
#[test]
fn the_sides_of_steel_are_unloaded() {
    let desk = Desk::new();
    let material = json!({ "plugin": "j2_plasticity",
        "props": { "E": 200e3, "nu": 0.3, "hardening": [[200, 0], [2200, 1]] } });
    let expected = (-300.0 + 0.3 * 40.0) / 200e3 - 80.0 / 2000.0;
    for (mode, axis, sides) in [("3d", 1, [2, 3]), ("axisymmetric", 2, [1, 3])] {
        for increments in [1, 10, 1000] {
            let target = |along: Value, across: f64| json!({ format!("s{axis}{axis}"): along, format!("s{0}{0}", sides[0]): across, format!("s{0}{0}", sides[1]): across });
            let steps = json!([
                { "increments": 1, "target": target(json!(-300.0), -300.0) },
                { "increments": increments, "target": target(json!("hold"), -20.0) },
            ]);
            let case = point(material.clone(), mode, steps);
            ends_at(&desk, &format!("{mode}{increments}"), &case, &format!("e{axis}{axis}"), expected, CLOSE);
        }
    }
}

/// A body that dilates in shear: its all-round pressure falls, its shear is held. λ = (q + μ p − k)/H.
#[test]
fn a_sheared_body_dilates() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "rheology.f90", &[]) else { return };
    let [k, mu, psi, hardening] = [10.0, 0.8, 1.5, 500.0];
    let (pressure, shear) = ([-100.0, -10.0], 30.0);
    let lambda = (3.0_f64.sqrt() * shear + mu * pressure[1] - k) / hardening;
    let volume = pressure[1] / (3.0 * K) + psi * lambda / 3.0;
    let slip = shear / G + 3.0_f64.sqrt() * lambda;
    for (nlgeom, increments, tolerance) in
        [(false, 1, CLOSE), (false, 10, CLOSE), (false, 500, CLOSE), (true, 500, 2e-2)]
    {
        let pressed = |p: f64| json!({ "s11": p, "s22": p, "s33": p, "s12": 0.0 });
        let mut sheared = pressed(pressure[0]);
        sheared["s12"] = json!(shear);
        let mut last = pressed(pressure[1]);
        last["s12"] = json!("hold");
        let steps = json!([
            { "increments": 1, "target": pressed(pressure[0]) },
            { "increments": 1, "target": sheared },
            { "increments": increments, "target": last },
        ]);
        let mut case = body(&library, 4, &[k, mu, psi, hardening], "3d", steps);
        case["nlgeom"] = json!(nlgeom);
        let name = format!("dilatant{nlgeom}{increments}");
        ends_at(&desk, &name, &case, "e11", volume, tolerance);
        ends_at(&desk, &name, &case, "g12", slip, tolerance);
    }
}

/// Cycles of stress between −200 and 250 MPa, the first peak held, with Armstrong and Frederick's hardening: each branch in closed form.
#[test]
fn stress_cycles_ratchet() {
    let desk = Desk::new();
    let sources = ["armstrong_frederick.f", "armstrong_frederick_return.F", "armstrong_frederick_elastic.f"];
    let Some(library) = built_of(&desk, &sources, &[]) else { return };
    let [modulus, nu, yield_stress, c, gamma] = [200e3, 0.3, 200.0, 20e3, 200.0];
    let (high, low) = (250.0, -200.0);
    for cycles in [1, 3, 10] {
        let (mut plastic, mut back) = (0.0, 0.0);
        for _ in 0..cycles {
            for (direction, peak) in [(1.0, high), (-1.0, low)] {
                let next = peak - direction * yield_stress;
                let rest = |back: f64| c - direction * gamma * back;
                plastic += direction / gamma * f64::ln(rest(back) / rest(next));
                back = next;
            }
        }
        let expected = low / modulus + plastic;
        let mut steps = vec![];
        for _ in 0..cycles {
            steps.push(json!({ "increments": 4000, "target": { "s11": high } }));
            steps.push(json!({ "increments": 5, "target": { "s11": "hold" } }));
            steps.push(json!({ "increments": 4000, "target": { "s11": low } }));
        }
        let material = json!({ "plugin": library, "props": [modulus, nu, yield_stress, c, gamma], "nstatv": 7 });
        ends_at(&desk, &format!("cycles{cycles}"), &point(material, "3d", json!(steps)), "e11", expected, 2e-3);
    }
}

/// Clay at 100 kPa that is compressed to 240 kPa, and whose sides are then unloaded to 95 kPa: along the path of stress the yield
/// pressure follows from stress alone, and the shear strain by a quadrature of the flow rule.
#[test]
fn the_sides_of_clay_are_unloaded() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "cam_clay.F", &[]) else { return };
    let [lambda, kappa, m, shear, void] = [0.15, 0.03, 1.1, 6000.0, 0.9];
    let (elastic, plastic) = ((1.0 + void) / kappa, (1.0 + void) / (lambda - kappa));
    // p and q
    let at = |share: f64| {
        let (along, side) = (100.0 + 140.0 * share.min(1.0), 100.0 - 5.0 * (share - 1.0).max(0.0));
        ((along + 2.0 * side) / 3.0, along - side)
    };
    let size = |(p, q): (f64, f64)| p + q * q / (m * m * p);
    let count = 100_000;
    let (mut volume, mut distortion, mut largest) = (0.0, 0.0, 150.0_f64);
    for k in 1..=2 * count {
        let (p, q) = at((f64::from(k) - 0.5) / f64::from(count));
        let end = size(at(f64::from(k) / f64::from(count)));
        if end > largest {
            let by = f64::ln(end / largest) / plastic;
            volume += by;
            distortion += by * 2.0 * q / (m * m * (2.0 * p - size((p, q))));
            largest = end;
        }
    }
    let (p, q) = at(2.0);
    let expected = -((f64::ln(p / 100.0) / elastic + volume) / 3.0 + q / (3.0 * shear) + distortion);
    for increments in [2000, 8000] {
        let steps = json!([
            { "increments": increments, "target": { "s11": -240.0, "s22": -100.0, "s33": -100.0 } },
            { "increments": increments, "target": { "s11": "hold", "s22": -95.0, "s33": -95.0 } },
        ]);
        let material = json!({ "plugin": library, "props": [lambda, kappa, m, shear, void], "nstatv": 3 });
        ends_at(&desk, &format!("clay{increments}"), &point(material, "3d", steps), "e11", expected, 2e-3);
    }
}

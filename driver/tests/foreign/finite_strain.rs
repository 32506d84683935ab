//! UMATs under NLGEOM: hyperelastic ones, which take their strain from DFGRD1, and what DSTRAN and DROT make of others.

use super::{built, close, point, run};
use crate::program::{Desk, Table};
use end_to_end_tests::worst;
use nalgebra::Matrix3;
use serde_json::{Value, json};

#[test]
fn neo_hooke_from_the_deformation_gradient() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    let (mu, kappa) = (80.0, 500.0);
    let material = json!({ "plugin": library, "props": [mu, kappa], "nstatv": 0 });
    let at = |f: [[f64; 3]; 3], name: &str| {
        let mut case = point(material.clone(), "3d", json!([{ "increments": 5, "F": f }]));
        case["nlgeom"] = json!(true);
        run(&desk, name, &case).history
    };
    // simple shear: s12 = μγ, s11 − s22 = μγ², trace 0
    let gamma = 0.8;
    let shear = at([[1.0, gamma, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "shear");
    close(shear.last("s12"), mu * gamma);
    close(shear.last("s11") - shear.last("s22"), mu * gamma * gamma);
    close(shear.last("s11") + shear.last("s22") + shear.last("s33"), 0.0);
    // volume change alone
    let swollen = at([[1.1, 0.0, 0.0], [0.0, 1.1, 0.0], [0.0, 0.0, 1.1]], "swollen");
    close(swollen.last("s11"), kappa * (1.1_f64.powi(3) - 1.0));
    close(swollen.last("s12"), 0.0);
    // a stretch λ along 1 turned by 30°: σ turned likewise
    let (lambda, angle) = (1.3_f64, 30.0_f64.to_radians());
    let (sine, cosine) = angle.sin_cos();
    let turned = at([[cosine * lambda, -sine, 0.0], [sine * lambda, cosine, 0.0], [0.0, 0.0, 1.0]], "turned");
    let deviator = mu * lambda.powf(-5.0 / 3.0) * (lambda * lambda - 1.0) / 3.0;
    let mean = kappa * (lambda - 1.0);
    let (along, across) = (mean + 2.0 * deviator, mean - deviator);
    close(turned.last("s11"), along * cosine * cosine + across * sine * sine);
    close(turned.last("s22"), along * sine * sine + across * cosine * cosine);
    close(turned.last("s12"), (along - across) * sine * cosine);
    close(turned.last("s33"), across);
}

/// Hypoelastic stress of a UMAT that adds C : DSTRAN: the host turns STRESS by DROT, which makes it Jaumann's rate.
#[test]
fn jaumann_elasticity_in_simple_shear() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let (modulus, nu, gamma) = (100.0, 0.25, 2.0_f64);
    let shear_modulus = modulus / (2.0 * (1.0 + nu));
    let material = json!({ "plugin": library, "props": [modulus, nu], "nstatv": 1 });
    let found = |increments: u32| {
        let f = [[1.0, gamma, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut case = point(material.clone(), "3d", json!([{ "increments": increments, "F": f }]));
        case["nlgeom"] = json!(true);
        let history = run(&desk, "shear", &case).history;
        ["s12", "s11", "s22"].map(|name| history.last(name) / shear_modulus)
    };
    // s12 = G sin γ, s11 = −s22 = G (1 − cos γ)
    let exact = [gamma.sin(), 1.0 - gamma.cos(), gamma.cos() - 1.0];
    let error = |found: &[f64; 3]| worst(exact.iter().zip(found).map(|(a, b)| (a - b).abs()));
    let (coarse, fine) = (found(200), found(400));
    // DSTRAN is that of the middle of the increment and not turned to its end, as ABAQUS has it: first order
    let order = (error(&coarse) / error(&fine)).log2();
    assert!((order - 1.0).abs() < 0.02, "order {order}");
    assert!(error(&fine) < 4e-3, "{:e}", error(&fine));
    let limit: [f64; 3] = std::array::from_fn(|k| 2.0 * fine[k] - coarse[k]);
    assert!(error(&limit) < 2e-5, "{:e}", error(&limit));
}

/// A stretched point that turns as a rigid body: stress and STRAN turn with it, to rounding, however large the turns.
#[test]
fn a_rigid_rotation_turns_the_stress_exactly() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [100.0, 0.25], "nstatv": 1 });
    let stretch = [1.2, 0.9, 1.0];
    let turned = |angle: f64| {
        let (sine, cosine) = angle.to_radians().sin_cos();
        [
            [cosine * stretch[0], -sine * stretch[1], 0.0],
            [sine * stretch[0], cosine * stretch[1], 0.0],
            [0.0, 0.0, stretch[2]],
        ]
    };
    let angles = [0.0, 20.0, 75.0, 160.0, 270.0];
    let steps: Vec<_> = angles.iter().map(|angle| json!({ "increments": 1, "F": turned(*angle) })).collect();
    let mut case = point(material, "3d", json!(steps));
    case["nlgeom"] = json!(true);
    let history = run(&desk, "turned", &case).history;
    let row = |name: &str, k: usize| history.column(name)[k];
    for (number, angle) in angles.iter().enumerate() {
        let (k, (sine, cosine)) = (number + 1, angle.to_radians().sin_cos());
        let [along, across] = ["s11", "s22"].map(|name| row(name, 1));
        close(row("s11", k), along * cosine * cosine + across * sine * sine);
        close(row("s22", k), along * sine * sine + across * cosine * cosine);
        close(row("s12", k), (along - across) * sine * cosine);
        // U does not turn
        close(row("e11", k), stretch[0].ln());
        close(row("e22", k), stretch[1].ln());
        close(row("g12", k), 0.0);
    }
}

/// Principal Cauchy stresses of a law by its principal stretches.
type StressByStretches<'l> = &'l dyn Fn([f64; 3]) -> [f64; 3];

/// λ̄_i = J^(−1/3) λ_i and J.
fn isochoric(stretches: [f64; 3]) -> ([f64; 3], f64) {
    let volume: f64 = stretches.iter().product();
    (stretches.map(|stretch| stretch * volume.powf(-1.0 / 3.0)), volume)
}

/// σ_i = (s_i − mean)/J + κ (J − 1).
fn with_pressure(s: [f64; 3], volume: f64, kappa: f64) -> [f64; 3] {
    let mean = s.iter().sum::<f64>() / 3.0;
    s.map(|s| (s - mean) / volume + kappa * (volume - 1.0))
}

/// The root of an increasing function, to the last bit.
fn root(function: impl Fn(f64) -> f64) -> f64 {
    let (mut below, mut above) = (0.05, 5.0);
    for _ in 0..200 {
        let middle = 0.5 * (below + above);
        if function(middle) < 0.0 {
            below = middle;
        } else {
            above = middle;
        }
    }
    0.5 * (below + above)
}

const STRETCH: f64 = 3.0;

/// Mode, targets by the strain at the end, and the principal stretches that a law then has.
fn experiments(law: StressByStretches<'_>) -> [(&'static str, Vec<&'static str>, [f64; 3]); 3] {
    let uniaxial = root(|across| law([STRETCH, across, across])[1]);
    let biaxial = root(|across| law([STRETCH, STRETCH, across])[2]);
    let plane = root(|across| law([STRETCH, across, 1.0])[1]);
    [
        ("3d", vec!["e11"], [STRETCH, uniaxial, uniaxial]),
        ("3d", vec!["e11", "e22"], [STRETCH, STRETCH, biaxial]),
        ("plane_strain", vec!["e11"], [STRETCH, plane, 1.0]),
    ]
}

fn stretched(measure: &str, mode: &str, names: &[&str], material: &Value) -> Value {
    let end = if measure == "nominal" { STRETCH - 1.0 } else { STRETCH.ln() };
    let target: serde_json::Map<String, Value> = names.iter().map(|name| ((*name).to_owned(), json!(end))).collect();
    let mut case = point(material.clone(), mode, json!([{ "increments": 12, "target": target }]));
    case["nlgeom"] = json!(true);
    case["measure"] = json!(measure);
    case
}

fn expect(history: &Table, names: [&str; 6], expected: [f64; 6]) {
    for (name, expected) in names.iter().zip(expected) {
        let found = history.last(name);
        assert!((found - expected).abs() <= 1e-8 * expected.abs().max(1.0), "{name}: {found} instead of {expected}");
    }
}

/// To λ = 3 in uniaxial stress, equibiaxial stress and plane strain, by Hencky's strain and Cauchy's stress and by Biot's,
/// with an exact tangent (neo-Hooke), one by differences (Mooney-Rivlin), and that of the unstrained body (Ogden).
#[test]
fn hyperelasticity_to_three_times_the_length() {
    let desk = Desk::new();
    let neo_hooke = |stretches| {
        let (bar, volume) = isochoric(stretches);
        with_pressure(bar.map(|b| 0.8 * b * b), volume, 40.0)
    };
    let mooney_rivlin = |stretches| {
        let (bar, volume) = isochoric(stretches);
        let first: f64 = bar.iter().map(|b| b * b).sum();
        with_pressure(bar.map(|b| 2.0 * ((0.3 + 0.1 * first) * b * b - 0.1 * b.powi(4))), volume, 40.0)
    };
    let ogden_terms = [(0.63, 1.3), (0.0012, 5.0), (-0.01, -2.0)];
    let ogden = |stretches| {
        let (bar, volume) = isochoric(stretches);
        let sum = |b: f64| ogden_terms.iter().map(|(mu, alpha)| mu * b.powf(*alpha)).sum::<f64>();
        with_pressure(bar.map(sum), volume, 20.0)
    };
    let laws: [(&str, Value, StressByStretches<'_>); 3] = [
        ("neo_hooke.f90", json!([0.8, 40.0]), &neo_hooke),
        ("mooney_rivlin.f90", json!([0.3, 0.1, 40.0]), &mooney_rivlin),
        ("ogden.f90", json!([20.0, 0.63, 1.3, 0.0012, 5.0, -0.01, -2.0]), &ogden),
    ];
    for (source, props, law) in laws {
        let Some(library) = built(&desk, source, &[]) else { return };
        let material = json!({ "plugin": library, "props": props, "nstatv": 0 });
        for (mode, names, stretches) in experiments(law) {
            let (stress, volume) = (law(stretches), stretches.iter().product::<f64>());
            let run = |measure: &str| run(&desk, source, &stretched(measure, mode, &names, &material));
            let (logarithmic, nominal) = (run("logarithmic"), run("nominal"));
            let columns = ["e11", "e22", "e33", "s11", "s22", "s33"];
            let [a, b, c] = stretches;
            let [s, t, u] = stress;
            expect(&logarithmic.history, columns, [a.ln(), b.ln(), c.ln(), s, t, u]);
            let [s, t, u] = [s / a, t / b, u / c].map(|stress| stress * volume);
            expect(&nominal.history, columns, [a - 1.0, b - 1.0, c - 1.0, s, t, u]);
            for run in [logarithmic, nominal] {
                expect(&run.history, ["F11", "F22", "F33", "F12", "s12", "F21"], [a, b, c, 0.0, 0.0, 0.0]);
                let iterations = run.summary["iterations"].as_f64().expect("a number");
                let bound = if source == "ogden.f90" { 40.0 } else { 6.0 };
                assert!(iterations <= bound * 12.0, "{source} {mode}: {iterations} iterations in 12 increments");
            }
        }
    }
}

/// Six components of a history's last line as a matrix; `shear`: of the shear components, with a factor.
fn tensor(history: &Table, normal: &str, (shear, factor): (&str, f64)) -> Matrix3<f64> {
    let [a, b, c] = ["11", "22", "33"].map(|name| history.last(&format!("{normal}{name}")));
    let [d, e, f] = ["12", "13", "23"].map(|name| factor * history.last(&format!("{shear}{name}")));
    Matrix3::new(a, d, e, d, b, f, e, f, c)
}

/// U − 1 and sym(RᵀP) of a path of F, which turns the material.
#[test]
fn nominal_columns_of_a_path_of_f() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "mooney_rivlin.f90", &[]) else { return };
    let material = json!({ "plugin": library, "props": [0.3, 0.1, 4.0], "nstatv": 0 });
    let f = [[1.3, 0.8, 0.1], [-0.3, 0.9, 0.2], [0.2, -0.1, 1.1]];
    let [logarithmic, nominal] = ["logarithmic", "nominal"].map(|measure| {
        let mut case = point(material.clone(), "3d", json!([{ "increments": 3, "F": f }]));
        case["nlgeom"] = json!(true);
        case["measure"] = json!(measure);
        run(&desk, measure, &case).history
    });
    let f = Matrix3::from_fn(|i, j| f[i][j]);
    let stretch = tensor(&nominal, "e", ("g", 0.5)) + Matrix3::identity();
    assert!((stretch * stretch - f.transpose() * f).norm() < 1e-13);
    // ln U by the series of its exponential
    let (mut sum, mut term) = (Matrix3::identity(), Matrix3::identity());
    for k in 1..40 {
        term = term * tensor(&logarithmic, "e", ("g", 0.5)) / f64::from(k);
        sum += term;
    }
    assert!((sum - stretch).norm() < 1e-13);
    let cauchy = tensor(&logarithmic, "s", ("s", 1.0));
    let inverse = f.try_inverse().expect("regular");
    let rotation = f * stretch.try_inverse().expect("regular");
    let product = rotation.transpose() * (cauchy * inverse.transpose() * f.determinant());
    let biot = (product + product.transpose()) * 0.5;
    assert!((tensor(&nominal, "s", ("s", 1.0)) - biot).norm() < 1e-12);
}

/// Steps that are allowed once the material has turned: stresses alone, here none; strains alone; not both, unless the
/// measure turns with the material.
#[test]
fn steps_after_a_turn() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    let material = json!({ "plugin": library, "props": [0.8, 40.0], "nstatv": 0 });
    let sheared = json!({ "increments": 5, "F": [[1.0, 0.6, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] });
    let case = |steps: Value| {
        let mut case = point(material.clone(), "3d", steps);
        case["nlgeom"] = json!(true);
        case
    };
    let history = run(&desk, "unloaded", &case(json!([sheared, { "increments": 5 }]))).history;
    // what is left of F is its rotation, tan φ = γ/2
    let (sine, cosine) = (-0.3_f64.atan()).sin_cos();
    for (name, expected) in [("F11", cosine), ("F21", sine), ("F12", -sine), ("s11", 0.0), ("e11", 0.0), ("g12", 0.0)] {
        assert!((history.last(name) - expected).abs() < 1e-7, "{name}: {}", history.last(name));
    }
    let mixed = json!({ "increments": 5, "target": { "e11": 0.1 } });
    let refused = desk.case("mixed.json", &case(json!([sheared, mixed])));
    let refused = desk.pullout(["check".as_ref(), refused.as_os_str()]).expect(2);
    assert!(refused.stderr.contains("$.steps[1]") && refused.stderr.contains("turned"), "{}", refused.stderr);
    // the second time round it has turned
    let cycle = json!([{ "repeat": 2, "steps": [mixed, sheared] }]);
    let stopped = desk.run(&desk.case("cycle.json", &case(cycle)), &[], "cycle", 1);
    assert!(stopped.outcome.stderr.contains("step 3: the material has turned"), "{}", stopped.outcome.stderr);
    let mut nominal = case(json!([sheared, mixed]));
    nominal["measure"] = json!("nominal");
    let nominal = run(&desk, "nominal", &nominal).history;
    close(nominal.last("e11"), 0.1);
    for name in ["s22", "s33", "s12", "s13", "s23"] {
        assert!(nominal.last(name).abs() < 1e-8);
    }
}

/// One element of the FE core, stretched by 30 %: the load is the nominal stress of the point, for the same increments.
#[test]
fn a_finite_element_has_the_stress_of_the_point() {
    let desk = Desk::new();
    let (increments, stretch) = (20, 0.3);
    let hardening = json!({ "E": 1000.0, "nu": 0.25, "hardening": [[20.0, 0.0], [50.0, 0.3]] });
    for material in [
        json!({ "plugin": "linear_elastic", "props": { "E": 1000.0, "nu": 0.25 } }),
        json!({ "plugin": "j2_plasticity", "props": hardening }),
    ] {
        let target = json!([{ "increments": increments, "target": { "e11": stretch } }]);
        let mut case = point(material.clone(), "plane_strain", target);
        case["nlgeom"] = json!(true);
        case["measure"] = json!("nominal");
        let expected = run(&desk, "point", &case).history;
        let case = json!({
            "kind": "pullout",
            "title": "one element",
            "nlgeom": true,
            "mesh": { "specimen": { "type": "beam", "length": 2, "height": 1, "cells": [1, 1], "element": "Q4" } },
            "parts": { "beam": { "model": "plane_strain", "thickness": 1, "material": material } },
            "supports": { "left": { "direction": "x" }, "bottom": { "direction": "y" } },
            "grip": { "nodes": "right", "direction": "x", "lateral": "free" },
            "steps": [{ "slip": 2.0 * stretch, "increments": increments }],
            "output": { "vtu": false, "plots": false },
        });
        let found = run(&desk, "element", &case).history;
        let (load, stress) = (found.last("load"), expected.last("s11"));
        assert!((load / stress - 1.0).abs() < 1e-6, "{load} N instead of {stress} MPa on 1 mm2");
    }
}

/// Rows of a table, in either measure: strains along 1, the stress along 2 of the measure, and faces that are free.
#[test]
fn a_table_at_finite_strain() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    let (mu, kappa) = (0.8, 40.0);
    let stress = |stretches: [f64; 3]| {
        let (bar, volume) = isochoric(stretches);
        with_pressure(bar.map(|b| mu * b * b), volume, kappa)
    };
    let rows = [(1.2, 0.05, 0.5), (1.7, -0.1, 0.25), (0.8, 0.0, 2.0)];
    for measure in ["logarithmic", "nominal"] {
        let is_nominal = measure == "nominal";
        let mut time = 0.0;
        let text: String = rows
            .iter()
            .map(|(stretch, stress, duration)| {
                time += duration;
                format!("{time},{},{stress}\n", if is_nominal { stretch - 1.0 } else { f64::ln(*stretch) })
            })
            .collect();
        desk.write("path.csv", &format!("time,e11,s22\n{text}"));
        let material = json!({ "plugin": library, "props": [mu, kappa], "nstatv": 0 });
        let mut case = point(material, "3d", json!([{ "table": "path.csv" }]));
        case["nlgeom"] = json!(true);
        case["measure"] = json!(measure);
        let history = run(&desk, measure, &case).history;
        assert_eq!(history.rows.len(), 1 + rows.len());
        for (k, (stretch, across, _)) in rows.iter().enumerate() {
            let row = |name: &str| history.column(name)[k + 1];
            let stretches =
                ["e11", "e22", "e33"].map(|name| if is_nominal { 1.0 + row(name) } else { row(name).exp() });
            assert!((stretches[0] - stretch).abs() < 1e-14);
            let volume: f64 = stretches.iter().product();
            let expected = stress(stretches);
            for (k, name) in ["s11", "s22", "s33"].into_iter().enumerate() {
                let of_measure = expected[k] * if is_nominal { volume / stretches[k] } else { 1.0 };
                assert!((row(name) - of_measure).abs() < 1e-8, "{measure} {name}: {} {of_measure}", row(name));
            }
            assert!((row("s22") - across).abs() < 1e-7 && row("s33").abs() < 1e-7);
        }
        close(history.last("time"), 2.75);
    }
}

/// A step that is ended by a bound on the case's own measure, and one that is ended by a bound on F.
#[test]
fn until_at_finite_strain() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    let material = json!({ "plugin": library, "props": [0.8, 40.0], "nstatv": 0 });
    for (measure, end, until, reached) in [
        ("nominal", 2.0, json!({ "quantity": "e11", "greater_than": 0.74 }), 15),
        ("logarithmic", 2.0, json!({ "quantity": "e11", "greater_than": 0.74 }), 15),
        ("nominal", 2.0, json!({ "quantity": "F11", "greater_than": 1.54 }), 11),
    ] {
        let step = json!({ "increments": 40, "target": { "e11": end }, "until": until });
        let mut case = point(material.clone(), "3d", json!([step, { "increments": 4, "target": { "e11": 0.0 } }]));
        case["nlgeom"] = json!(true);
        case["measure"] = json!(measure);
        let history = run(&desk, measure, &case).history;
        let increments = history.column("step").iter().filter(|step| **step == 1.0).count();
        assert_eq!(increments, reached, "{measure} {until}");
        // and the next goes on from there, back to nothing
        close(history.last("F11"), 1.0);
        assert!(history.last("s11").abs() < 1e-7);
    }
}

/// Increments that the law cuts (PNEWDT), and ones without equilibrium in one piece: the end is that of small ones.
#[test]
fn increments_are_cut_at_finite_strain() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "cut_back.f", &[]) else { return };
    let ran = |name: &str, increments: u32, largest: f64| {
        let material = json!({ "plugin": library, "props": [100.0, 0.25, largest], "nstatv": 1 });
        let steps = json!([{ "increments": increments, "target": { "e11": 0.4 } }]);
        let mut case = point(material, "3d", steps);
        case["nlgeom"] = json!(true);
        run(&desk, name, &case)
    };
    let (cut, small) = (ran("cut", 1, 0.0126), ran("small", 32, 1.0));
    assert!(cut.summary["cutbacks"].as_u64() > Some(1));
    // DSTRAN of pieces of 1/32 of the way, as those of the increments
    for name in ["s11", "e22", "F22"] {
        let (found, expected) = (cut.history.last(name), small.history.last(name));
        assert!((found - expected).abs() < 2e-3 * expected.abs(), "{name}: {found} instead of {expected}");
    }
    close(cut.history.last("F11"), 0.4_f64.exp());

    let Some(library) = built(&desk, "ogden.f90", &[]) else { return };
    let stretched_by = |increments: u32, iterations: u32| {
        let material = json!({ "plugin": library, "props": [20.0, 0.63, 1.3, 0.0012, 5.0, -0.01, -2.0], "nstatv": 0 });
        let mut case = point(material, "3d", json!([{ "increments": increments, "target": { "e11": 1.0 } }]));
        case["nlgeom"] = json!(true);
        case["controls"] = json!({ "max_iterations": iterations });
        run(&desk, "stretched", &case)
    };
    // the tangent of the unstrained body does not get there at once
    let (cut, small) = (stretched_by(1, 6), stretched_by(50, 100));
    assert!(cut.summary["cutbacks"].as_u64() > Some(0), "{}", cut.summary);
    for name in ["s11", "e22", "F11"] {
        let (found, expected) = (cut.history.last(name), small.history.last(name));
        assert!((found - expected).abs() < 1e-7 * expected.abs(), "{name}: {found} instead of {expected}");
    }
}

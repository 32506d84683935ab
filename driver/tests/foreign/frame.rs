//! Local axes, thermal expansion and shrinkage in combination with any law, against closed forms.

use super::{built, built_of, close, point, run};
use crate::program::Desk;
use end_to_end_tests::worst;
use nalgebra::Matrix3;
use serde_json::{Value, json};

/// A unidirectional carbon lamina, MPa: E1, E2, E3, nu12, nu13, nu23, G12, G13, G23.
const LAMINA: [f64; 9] = [140e3, 10e3, 10e3, 0.3, 0.3, 0.45, 5e3, 5e3, 3.5e3];

fn lamina(library: &Value) -> Value {
    json!({ "plugin": library, "props": LAMINA, "nstatv": 1 })
}

/// 1/E(θ) and the shear strain that a unit stress makes, γ12(θ), of a lamina whose fibres are θ off the stress (Jones).
fn off_axis(degrees: f64) -> [f64; 2] {
    let [e1, e2, _, nu, _, _, g, ..] = LAMINA;
    let (s, c) = degrees.to_radians().sin_cos();
    let stretch = c.powi(4) / e1 + (1.0 / g - 2.0 * nu / e1) * s * s * c * c + s.powi(4) / e2;
    let a = 2.0 / e1 + 2.0 * nu / e1 - 1.0 / g;
    let b = 2.0 / e2 + 2.0 * nu / e1 - 1.0 / g;
    [stretch, a * s * c.powi(3) - b * s.powi(3) * c]
}

#[test]
fn a_lamina_pulled_off_its_axes_has_the_modulus_and_the_shear_of_the_closed_form() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "lamina.f90", &[]) else { return };
    for (mode, angle) in [("3d", 15.0), ("plane_stress", 15.0), ("plane_stress", -60.0), ("3d", 90.0)] {
        let mut material = lamina(&library);
        material["orientation"] = json!(angle);
        let history =
            run(&desk, "pulled", &point(material, mode, json!([{ "increments": 2, "target": { "s11": 100.0 } }])));
        let [stretch, shear] = off_axis(angle).map(|compliance| 100.0 * compliance);
        close(history.history.last("e11") / stretch, 1.0);
        close(history.history.last("g12"), shear);
        close(history.history.last("s12"), 0.0);
    }
    // by vectors, the first a negative multiple of axis 2, all in another plane: fibres along 2, so E2 along 3 and 1
    let mut material = lamina(&library);
    material["orientation"] = json!([[0, -2, 0], [0, 1, 3]]);
    let history =
        run(&desk, "vectors", &point(material.clone(), "3d", json!([{ "increments": 1, "target": { "s22": 70.0 } }])));
    close(history.history.last("e22"), 70.0 / LAMINA[0]);
    let shear =
        run(&desk, "shear", &point(material.clone(), "3d", json!([{ "increments": 1, "target": { "s13": 7.0 } }])));
    close(shear.history.last("g13"), 7.0 / LAMINA[8]);
    // in a plane only its own third axis
    let refused = desk.case("refused.json", &point(material, "plane_strain", json!([{ "increments": 1 }])));
    let outcome = desk.pullout(["check", refused.to_str().expect("UTF-8")]).expect(2);
    assert!(outcome.stderr.contains("$.material.orientation"), "{}", outcome.stderr);
}

/// Two elements, 4 × 2 mm, with sets `left`, `right`, and a `corner`.
const COUPON: &str = "$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
0 1 \"corner\"
1 2 \"left\"
1 3 \"right\"
2 4 \"coupon\"
$EndPhysicalNames
$Nodes
6
1 0 0 0
2 1.5 0 0
3 4 0 0
4 0 2 0
5 2 2 0
6 4 2 0
$EndNodes
$Elements
5
1 15 2 1 1 1
2 1 2 2 2 1 4
3 1 2 3 3 3 6
4 3 2 4 4 1 2 5 4
5 3 2 4 4 2 3 6 5
$EndElements
";

/// A coupon in plane stress that is held along 1 at its ends, and free to shorten and to shear.
fn coupon(desk: &Desk, material: &Value, steps: Value) -> Value {
    desk.write("coupon.msh", COUPON);
    json!({
        "kind": "pullout", "title": "Off-axis coupon", "mesh": { "file": "coupon.msh" },
        "parts": { "coupon": { "model": "plane_stress", "thickness": 1, "material": material } },
        "supports": { "left": { "direction": "x" }, "corner": { "direction": "y" } },
        "grip": { "nodes": "right", "direction": [1, 0], "lateral": "free" },
        "steps": steps,
        "output": { "plots": false, "vtu": false },
    })
}

#[test]
fn an_orthotropic_material_expands_along_its_axes_at_points_and_in_parts() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "lamina.f90", &[]) else { return };
    let (angle, heat, along, across) = (30.0_f64, 80.0, -1e-6, 30e-6);
    let mut material = lamina(&library);
    material["orientation"] = json!(angle);
    material["expansion"] = json!([along, across, across]);
    let (s, c) = angle.to_radians().sin_cos();
    let expansion = along * c * c + across * s * s;
    // without a restraint free of stress
    let steps = json!([{ "increments": 2, "temperature": heat, "target": {} }]);
    let free = run(&desk, "free", &point(material.clone(), "3d", steps)).history;
    close(free.last("e11"), expansion * heat);
    close(free.last("e22"), (along * s * s + across * c * c) * heat);
    close(free.last("e33"), across * heat);
    close(free.last("g12"), 2.0 * (along - across) * s * c * heat);
    close(free.last("s11"), 0.0);
    // held along 1, free to shear: σ = −α(θ) T E(θ); then pulled as well
    let stress = -expansion * heat / off_axis(angle)[0];
    let steps = json!([
        { "increments": 2, "temperature": heat, "target": { "e11": 0.0 } }, { "increments": 1, "target": { "e11": 1e-3 } },
    ]);
    let held = run(&desk, "held", &point(material.clone(), "plane_stress", steps)).history;
    close(held.column("s11")[2], stress);
    close(held.last("s11"), stress + 1e-3 / off_axis(angle)[0]);
    let steps = json!([{ "slip": 0.0, "increments": 2, "temperature": heat }, { "slip": 4e-3, "increments": 1 }]);
    let part = run(&desk, "part", &coupon(&desk, &material, steps));
    close(part.history.column("load")[2] / (2.0 * stress), 1.0);
    close(part.history.last("load") / (2.0 * (stress + 1e-3 / off_axis(angle)[0])), 1.0);
    assert!(part.history.last("energy_error").is_nan());
    // in turned axes the tangent is that of the stress: a linear problem is solved at once
    assert!(worst(part.history.column("iterations")) <= 2.0, "{:?}", part.history.column("iterations"));
}

/// Young's modulus of concrete, MPa, Poisson's ratio, and thermal expansion, 1/K.
const E: f64 = 30e3;
const NU: f64 = 0.2;
const ALPHA: f64 = 1e-5;

fn concrete() -> Value {
    json!({ "plugin": "linear_elastic", "props": { "E": E, "nu": NU } })
}

#[test]
fn thermal_strain_is_that_of_a_secant_coefficient_less_that_of_the_initial_temperature() {
    let desk = Desk::new();
    let mut material = concrete();
    material["expansion"] = json!({
        "alpha": [1e-5, 2e-5, 3e-5], "temperatures": [0, 100, 400], "zero_temperature": -20,
    });
    let steps = json!([{ "increments": 4, "temperature": 200, "target": { "e11": 0.0 } }]);
    let mut case = point(material, "3d", steps);
    case["temperature"] = json!(50);
    let history = run(&desk, "secant", &case).history;
    // α(50) = 1.5e-5, α(200) = 2e-5 + 1e-5/3
    let free = (2e-5 + 1e-5 / 3.0) * 220.0 - 1.5e-5 * 70.0;
    close(history.last("s11"), -E * free);
    close(history.last("e22"), (1.0 + NU) * free);
    // another initial temperature, as of a part that was joined hot
    case["material"]["expansion"]["initial_temperature"] = json!(200);
    let history = run(&desk, "joined", &case).history;
    close(history.last("s11"), 0.0);
    close(history.column("s11")[0], 0.0);
}

#[test]
fn what_a_plane_holds_is_stressed_by_heat_and_what_it_leaves_free_is_strained() {
    let desk = Desk::new();
    let heat = 40.0;
    let mut material = concrete();
    material["expansion"] = json!(ALPHA);
    let at = |mode: &str| {
        let steps = json!([{ "increments": 2, "temperature": heat, "target": { "e11": 0.0 } }]);
        run(&desk, mode, &point(material.clone(), mode, steps)).history
    };
    let free = ALPHA * heat;
    // e11 = e33 = 0
    let strain = at("plane_strain");
    close(strain.last("s33"), -E * free / (1.0 - NU));
    close(strain.last("s11"), -E * free / (1.0 - NU));
    close(strain.last("e22"), free * (1.0 + NU) / (1.0 - NU));
    // s33 = 0, and e33 the whole strain
    let stress = at("plane_stress");
    close(stress.last("s11"), -E * free);
    close(stress.last("e33"), (1.0 + NU) * free);
    close(at("axisymmetric").last("e33"), (1.0 + NU) * free);
}

#[test]
fn shrinkage_follows_its_table_of_time() {
    let desk = Desk::new();
    let mut material = concrete();
    material["shrinkage"] = json!({ "times": [0, 10, 30], "strain": [0, -2e-4, -3e-4] });
    let steps = json!([{ "increments": 8, "time": 40, "target": { "e11": 0.0 } }]);
    let held = run(&desk, "held", &point(material.clone(), "3d", steps)).history;
    close(held.column("s11")[1], E * 1e-4);
    close(held.column("s11")[4], E * 2.5e-4);
    close(held.last("s11"), E * 3e-4);
    close(held.last("e22"), -(1.0 + NU) * 3e-4);
    // a bar between walls, in a part: σ = E ε*
    let steps = json!([{ "slip": 0.0, "increments": 4, "time": 20 }]);
    let part = run(&desk, "part", &coupon(&desk, &material, steps));
    close(part.history.last("load") / (2.0 * E * 2.5e-4), 1.0);
    assert!(part.history.last("energy_error").is_nan());
}

/// Two strips of the same height and modulus: κ = 3 Δα T/(2 h) with the whole height h (Timoshenko 1925).
#[test]
fn a_bimetal_bends_as_timoshenko_says() {
    let desk = Desk::new();
    let (length, height, start, heat): (f64, f64, f64, f64) = (20.0, 1.0, 20.0, 50.0);
    // short elements: Q4 are too stiff in bending by (G/E) (length/height of the strip)²
    let columns = 320;
    let mut nodes = String::new();
    for row in 0..5 {
        for column in 0..=columns {
            let place = [column as f64 * length / columns as f64, f64::from(row) * height / 4.0];
            nodes += &format!("{} {} {} 0\n", row * (columns + 1) + column + 1, place[0], place[1]);
        }
    }
    let node = |row: usize, column: usize| row * (columns as usize + 1) + column + 1;
    let mut elements = vec![format!("15 2 1 1 {}", node(0, 0)), format!("15 2 5 5 {}", node(0, columns as usize))];
    elements.extend((0..4).map(|row| format!("1 2 2 2 {} {}", node(row, 0), node(row + 1, 0))));
    for row in 0..4 {
        for column in 0..columns as usize {
            let corners = [node(row, column), node(row, column + 1), node(row + 1, column + 1), node(row + 1, column)];
            let part = if row < 2 { 3 } else { 4 };
            elements.push(format!("3 2 {part} {part} {}", corners.map(|corner| corner.to_string()).join(" ")));
        }
    }
    let lines: String = elements.iter().enumerate().map(|(k, line)| format!("{} {line}\n", k + 1)).collect();
    desk.write(
        "strip.msh",
        &format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n0 1 \"corner\"\n1 2 \"left\"\n2 3 \"lower\"\n2 4 \
             \"upper\"\n0 5 \"tip\"\n$EndPhysicalNames\n$Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{}\n{lines}$EndElements\n",
            5 * (columns + 1),
            elements.len()
        ),
    );
    let part = |alpha: f64| {
        let mut material = json!({ "plugin": "linear_elastic", "props": { "E": E, "nu": 0.0 } });
        material["expansion"] = json!(alpha);
        json!({ "model": "plane_stress", "thickness": 1, "material": material })
    };
    let case = json!({
        "kind": "pullout", "title": "Bimetal", "mesh": { "file": "strip.msh" },
        "parts": { "lower": part(2e-5), "upper": part(1e-5) },
        "supports": { "left": { "direction": "x" }, "corner": { "direction": "y" } },
        "measure": { "exit": "tip", "direction": [0, 1] },
        "temperature": start,
        "steps": [{ "increments": 1, "temperature": start + heat }],
        "output": { "plots": false, "vtu": false },
    });
    let curvature = 1.5 * 1e-5 * heat / height;
    let deflection = 0.5 * curvature * length * length;
    // heated as a whole, and from one end by conduction until it is as warm everywhere
    let mut conducts = case.clone();
    conducts["steps"][0] = json!({ "increments": 1 });
    conducts.as_object_mut().expect("a case").remove("temperature");
    let fixed = json!([{ "nodes": "left", "value": start + heat }]);
    conducts["field"] = json!({ "kind": "temperature", "initial": start, "fixed": fixed });
    let mut together = conducts.clone();
    together["field"]["coupling"] = json!("full");
    for (name, case) in [("bimetal", case), ("conducts", conducts), ("together", together)] {
        let run = run(&desk, name, &case);
        let found = run.history.last("slip_exit");
        // the free end is disturbed over about a height
        assert!((found / deflection - 1.0).abs() < 0.01, "{name}: {found} instead of {deflection}");
        // linear, also in the heat that expands: one iteration for both together, in turn one each
        let most = if name == "together" { 1.0 } else { 2.0 };
        assert!(worst(run.history.column("iterations")) <= most, "{name}: {:?}", run.history.column("iterations"));
    }
}

/// What expands counts: DDSDDT, and DRPLDT of heat that follows the strain, are the derivatives at a given strain of the case.
#[test]
fn derivatives_by_the_temperature_are_those_of_a_material_that_expands() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "heated.f90", &[]) else { return };
    let mut material =
        json!({ "plugin": library, "props": [200e3, 0.3, 0.0, 250.0, 1e-3, 2e3, 0.9, 20.0, 0], "nstatv": 7 });
    material["orientation"] = json!(30.0);
    material["expansion"] = json!({ "alpha": [[1e-5, 2e-5, 2e-5], [3e-5, 4e-5, 2e-5]], "temperatures": [0, 100] });
    for mode in ["3d", "plane_strain", "plane_stress"] {
        let mut material = material.clone();
        if mode == "plane_stress" {
            material["as"] = json!("3d");
        }
        let end = |temperature: f64| {
            let mut target = json!({ "e11": 0.006, "e22": 0.001, "g12": 0.004 });
            if mode == "3d" {
                ["e33", "g13", "g23"].iter().for_each(|name| target[*name] = json!(0.0));
            }
            let steps = json!([{ "increments": 1, "time": 2.0, "temperature": temperature, "target": target }]);
            let mut case = point(material.clone(), mode, steps);
            (case["temperature"], case["output"]) = (json!(20.0), json!({ "heat": true }));
            run(&desk, "end", &case).history
        };
        let [below, here, above] = [49.9, 50.0, 50.1].map(end);
        assert!(here.last("rpl") > 0.1, "it yields");
        for (derivative, of) in [("ddsddt11", "s11"), ("ddsddt22", "s22"), ("ddsddt12", "s12"), ("drpldt", "rpl")] {
            let (found, difference) = (here.last(derivative), 5.0 * (above.last(of) - below.last(of)));
            assert!((found - difference).abs() < 1e-4 * difference.abs(), "{mode}: {derivative} {found} {difference}");
        }
    }
}

/// A plate between walls whose faces are cooled at once: σ = Eα (T₀ − T), with T by Fourier's series, so that the force is
/// E α h (T₀ − T_f) (1 − Σ 8/(nπ)² exp(−k/c (nπ/h)² t)) for odd n. The order in time is the first.
#[test]
fn a_quenched_plate_is_stressed_as_fourier_says() {
    let desk = Desk::new();
    let (height, hot, time): (f64, f64, f64) = (4.0, 100.0, 0.5);
    let (conductivity, capacity) = (2.0, 0.5);
    let mean: f64 = (0..100)
        .map(|k| f64::from(2 * k + 1) * std::f64::consts::PI)
        .map(|wave| 8.0 / (wave * wave) * (-conductivity / capacity * (wave / height).powi(2) * time).exp())
        .sum();
    let exact = E * ALPHA * height * hot * (1.0 - mean);
    for coupling in ["staggered", "full"] {
        let errors = [25, 50, 100].map(|increments| {
            let mut material = concrete();
            material["expansion"] = json!(ALPHA);
            let case = json!({
                "kind": "pullout", "title": "Quenched plate",
                "mesh": { "specimen": { "type": "beam", "length": 1, "height": height, "cells": [1, 16], "element": "Q8" } },
                "parts": { "beam": { "model": "plane_stress", "thickness": 1, "material": material } },
                "field": {
                    "kind": "temperature", "coupling": coupling, "initial": hot, "conductivity": conductivity,
                    "capacity": capacity,
                    "fixed": [{ "nodes": "bottom", "value": 0 }, { "nodes": "top", "value": 0 }],
                },
                "grip": { "nodes": "right", "direction": "x", "lateral": "free" },
                "supports": { "left": { "direction": "x" }, "bottom": { "direction": "y" } },
                "steps": [{ "slip": 0, "increments": increments, "time": time }],
                "output": { "plots": false, "vtu": false },
            });
            let run = run(&desk, "quenched", &case);
            (run.history.last("load") / exact - 1.0).abs()
        });
        let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
        assert!(
            orders.iter().all(|order| (0.9..1.1).contains(order)) && errors[2] < 5e-3,
            "{coupling}: {orders:?} {errors:?}"
        );
    }
}

/// A deformation gradient with shear, stretch and a turn.
const GRADIENT: [[f64; 3]; 3] = [[1.25, 0.35, 0.0], [-0.2, 0.95, 0.0], [0.0, 0.0, 0.9]];

#[test]
fn fibres_along_a_local_axis_are_those_of_a_turned_problem_at_finite_strain() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["hgo.F90", "hgo_modules.f90"], &[]) else { return };
    let material = json!({ "plugin": library, "props": [10.0, 200.0, 30.0, 0.8, 0.0], "nstatv": 2 });
    let stress = |name: &str, material: &Value, f: Matrix3<f64>| {
        let rows: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| f[(i, j)]));
        let mut case = point(material.clone(), "3d", json!([{ "increments": 4, "F": rows }]));
        case["nlgeom"] = json!(true);
        let last = run(&desk, name, &case).history;
        let [s11, s22, s33, s12, s13, s23] = ["s11", "s22", "s33", "s12", "s13", "s23"].map(|name| last.last(name));
        Matrix3::new(s11, s12, s13, s12, s22, s23, s13, s23, s33)
    };
    let (sine, cosine) = 40.0_f64.to_radians().sin_cos();
    let turn = Matrix3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0);
    let gradient = Matrix3::from_fn(|i, j| GRADIENT[i][j]);
    let mut oriented = material.clone();
    oriented["orientation"] = json!(40.0);
    let found = stress("oriented", &oriented, gradient);
    let expected = turn * stress("turned", &material, turn.transpose() * gradient * turn) * turn.transpose();
    assert!(expected.amax() > 10.0);
    close((found - expected).amax() / expected.amax(), 0.0);
    // stresses are sought: the tangent in turned axes leads there
    let steps = json!([{ "increments": 4, "target": { "s11": 40.0, "s22": 5.0 } }]);
    let mut sought = point(oriented, "3d", steps);
    (sought["nlgeom"], sought["material"]["tangent"]) = (json!(true), json!("compare"));
    let run = run(&desk, "sought", &sought);
    close(run.history.last("s11") / 40.0, 1.0);
    let warnings = run.summary["warnings"].as_array().expect("a list").iter();
    let deviations: Vec<f64> = warnings
        .filter_map(|warning| warning.as_str()?.split("stress by ").nth(1)?.split(' ').next()?.parse().ok())
        .collect();
    assert!(deviations.iter().all(|deviation| *deviation < 1e-4), "{deviations:?}");
}

#[test]
fn heat_alone_strains_a_hyperelastic_point_without_stress() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    let mut material = json!({ "plugin": library, "props": [80.0, 500.0], "nstatv": 0, "expansion": 1e-4 });
    let mut case = point(material.clone(), "3d", json!([{ "increments": 3, "temperature": 1000, "target": {} }]));
    case["nlgeom"] = json!(true);
    let free = run(&desk, "free", &case).history;
    close(free.last("e11"), 0.1);
    close(free.last("F33"), 0.1_f64.exp());
    close(free.last("s11"), 0.0);
    // held: the law sees a compression to exp(−0.1)
    case["steps"][0]["target"] = json!({ "e11": 0, "e22": 0, "e33": 0 });
    case["output"] = json!({ "heat": true });
    let held = run(&desk, "held", &case).history;
    close(held.last("s11"), 500.0 * ((-0.3_f64).exp() - 1.0));
    close(held.last("ddsddt11"), -3.0 * 1e-4 * 500.0 * (-0.3_f64).exp());
    // turned local axes change nothing of an isotropic law
    material["orientation"] = json!([[1, 2, 0], [0, 1, 1]]);
    case["material"] = material;
    close(run(&desk, "turned", &case).history.last("s11"), 500.0 * ((-0.3_f64).exp() - 1.0));
}

#[test]
fn one_note_where_a_temperature_changes_nothing() {
    let desk = Desk::new();
    let steps = json!([{ "increments": 1, "temperature": 50, "target": { "e11": 1e-4 } }]);
    let notes = |name: &str, material: Value| {
        let run = run(&desk, name, &point(material, "3d", steps.clone()));
        let warnings = run.summary["warnings"].as_array().expect("a list").clone();
        warnings.iter().filter(|warning| warning.as_str().is_some_and(|text| text.contains("$.temperature"))).count()
    };
    assert_eq!(notes("without", concrete()), 1);
    let mut expands = concrete();
    expands["expansion"] = json!(ALPHA);
    assert_eq!(notes("with", expands), 0);
}

#[test]
fn the_check_sees_the_law_in_its_own_axes() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "lamina.f90", &[]) else { return };
    let mut material = lamina(&library);
    material["orientation"] = json!(25.0);
    material["expansion"] = json!({ "alpha": [1e-6, 3e-5, 3e-5] });
    let steps = json!([{ "increments": 10, "temperature": 50, "target": { "e11": 2e-3, "g12": 1e-3 } }]);
    for mode in ["3d", "plane_strain", "plane_stress"] {
        let case = desk.case("checked.json", &point(material.clone(), mode, steps.clone()));
        let outcome = desk.pullout([
            "plugin",
            "check",
            library.as_str().expect("a path"),
            "--case",
            case.to_str().expect("UTF-8"),
        ]);
        assert!(!outcome.stdout.contains("FAIL"), "{mode}: {}", outcome.stdout);
    }
}

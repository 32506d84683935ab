//! In an element of a specimen: two quadrilaterals deformed homogeneously, in every plane model, under small and large
//! strains. What is expected is integrated here, increment by increment, from the deformation gradient alone.

use super::mesh::Patch;
use super::{LARGE, Printed, calls, expect_within, values};
use crate::program::Desk;
use crate::{built, run};
use end_to_end_tests::rotated_in_plane;
use serde_json::{Value, json};

/// Young's modulus, MPa; ν = 0, G = E/2.
const E: f64 = 1000.0;
/// Displacements go through text, sums of drives and shape functions.
const ROUNDING: f64 = 1e-12;
/// Increments and durations, s, of the two steps, and where they end: ε11 = ε33 about an axis, ε22, and ∂u2/∂x1.
const STEPS: [(usize, f64, [f64; 3]); 2] = [(2, 4.0, [0.02, -0.01, 0.03]), (4, 2.0, [-0.03, 0.05, 0.2])];
const CORNER: [f64; 2] = [2.0, 0.5];

/// Rectangles of 3 × 2 mm and of 1 × 2 mm side by side from (2, 0.5), and a square for the grip.
fn patch() -> Patch {
    let node = |x: f64, y: f64| [CORNER[0] + x, CORNER[1] + y];
    Patch {
        nodes: vec![
            node(0.0, 0.0),
            node(3.0, 0.0),
            node(4.0, 0.0),
            node(0.0, 2.0),
            node(3.0, 2.0),
            node(4.0, 2.0),
            [8.0, 0.0],
            [9.0, 0.0],
            [9.0, 1.0],
            [8.0, 1.0],
        ],
        parts: vec![("body", vec![[1, 2, 5, 4], [2, 3, 6, 5]]), ("spare", vec![[7, 8, 9, 10]])],
        edges: vec![("foot", [7, 8]), ("grip", [9, 10])],
    }
}

fn case(library: &Value, model: &str, nlgeom: bool) -> Value {
    let patch = patch();
    let about_an_axis = model == "axisymmetric";
    let mut supports = patch.supports(1..=6);
    supports.insert("foot".into(), json!({}));
    let steps: Vec<_> = STEPS
        .iter()
        .map(|(increments, time, [e11, e22, slope])| {
            let along = if about_an_axis { 0.0 } else { CORNER[0] };
            let moved = |[x, y]: [f64; 2]| [e11 * (x - along), slope * (x - along) + e22 * (y - CORNER[1])];
            let drives = patch.drives(1..=6, moved);
            json!({ "slip": 0.001, "drives": drives, "time": time, "increments": increments })
        })
        .collect();
    let elastic = json!({ "plugin": "linear_elastic", "props": { "E": 1000, "nu": 0.2 } });
    json!({
        "kind": "pullout", "title": "Two elements", "nlgeom": nlgeom,
        "mesh": { "file": "patch.msh" },
        "parts": {
            "body": {
                "material": { "plugin": library, "props": [E, 1, 7], "nstatv": 2, "statev0": [10, 20], "cmname": "Grout" },
                "model": model,
            },
            "spare": { "material": elastic, "model": model },
        },
        "supports": supports,
        "grip": { "nodes": "grip", "direction": "y", "lateral": "free" },
        "steps": steps,
        "controls": { "locate_peak": false },
        "output": { "plots": false, "vtu": false },
    })
}

/// F11, F22, F33 and F21.
#[derive(Clone, Copy, Debug)]
struct Gradient {
    f11: f64,
    f22: f64,
    f33: f64,
    f21: f64,
}

impl Gradient {
    /// Part of the way through a step.
    fn at(step: usize, fraction: f64, model: &str) -> Self {
        let start = if step == 0 { [0.0; 3] } else { STEPS[step - 1].2 };
        let [e11, e22, f21] = std::array::from_fn(|k| start[k] + fraction * (STEPS[step].2[k] - start[k]));
        let f33 = if model == "axisymmetric" { 1.0 + e11 } else { 1.0 };
        Self { f11: 1.0 + e11, f22: 1.0 + e22, f33, f21 }
    }

    fn columns(self) -> [f64; 9] {
        [self.f11, self.f21, 0.0, 0.0, self.f22, 0.0, 0.0, 0.0, self.f33]
    }
}

/// ε11, ε22, ε33, γ12 of an increment, and its rotation: of ΔF F⁻¹ in the middle, by Hughes and Winget, or of ΔF.
fn increment(from: Gradient, to: Gradient, nlgeom: bool) -> ([f64; 4], f64) {
    let middle = |a: f64, b: f64| if nlgeom { 0.5 * (a + b) } else { 1.0 };
    let [d11, d22, d33] =
        [(from.f11, to.f11), (from.f22, to.f22), (from.f33, to.f33)].map(|(a, b)| (b - a) / middle(a, b));
    let f21 = if nlgeom { 0.5 * (from.f21 + to.f21) } else { 0.0 };
    // [a 0; c b]⁻¹ = [1/a 0; −c/(ab) 1/b]
    let d21 = (to.f21 - from.f21) / middle(from.f11, to.f11) - d22 * f21 / middle(from.f11, to.f11);
    let angle = if nlgeom { 2.0 * (0.25 * d21).atan() } else { 0.0 };
    ([d11, d22, d33, d21], angle)
}

/// The call that led to the end of the second increment of the second step, and what it must have been.
fn matches(model: &str, nlgeom: bool, call: &Printed) {
    let (mut strain, mut stress) = ([0.0; 4], [0.0; 4]);
    let places = [(0, 0.5), (0, 1.0), (1, 0.25), (1, 0.5)];
    let mut from = Gradient::at(0, 0.0, model);
    let (mut last, mut angle) = ([0.0; 4], 0.0);
    let mut start = from;
    for (number, (step, fraction)) in places.into_iter().enumerate() {
        let to = Gradient::at(step, fraction, model);
        (last, angle) = increment(from, to, nlgeom);
        (strain, stress) = (rotated_in_plane(strain, angle, 2.0), rotated_in_plane(stress, angle, 1.0));
        start = from;
        if number + 1 < places.len() {
            for k in 0..4 {
                strain[k] += last[k];
                stress[k] += last[k] * if k < 3 { E } else { 0.5 * E };
            }
        }
        from = to;
    }
    let end = from;
    let picked = |values: [f64; 4]| -> Vec<f64> {
        let [a, b, c, d] = values;
        if model == "plane_stress" { vec![a, b, d] } else { vec![a, b, c, d] }
    };
    let n = picked(last).len();
    // the third point of the second element: left and above
    let root = 1.0 / 3.0_f64.sqrt();
    let [x, y] = [3.0 + 0.5 * (1.0 - root), 1.0 + root];
    let along = if model == "axisymmetric" { x + CORNER[0] } else { x };
    let displacement = [(end.f11 - 1.0) * along, end.f21 * along + (end.f22 - 1.0) * y];
    let moved = if nlgeom { 1.0 } else { 0.0 };
    let coords = [CORNER[0] + x + moved * displacement[0], CORNER[1] + y + moved * displacement[1], 0.0];
    let (sine, cosine) = angle.sin_cos();
    let unit = Gradient { f11: 1.0, f22: 1.0, f33: 1.0, f21: 0.0 };
    let [dfgrd0, dfgrd1] = [start, end].map(|f| if nlgeom { f } else { unit }.columns());
    let counts: [f64; 3] = if model == "plane_stress" { [3.0, 2.0, 1.0] } else { [4.0, 3.0, 1.0] };
    let expected: [(&str, &[f64]); 36] = [
        ("stress", &picked(stress)),
        // after three increments, and the equilibrium at the start
        ("statev", &[14.0, 20.0]),
        ("ddsdde", &vec![0.0; n * n]),
        ("sse", &[4.0]),
        ("spd", &[8.0]),
        ("scd", &[12.0]),
        ("rpl", &[0.0]),
        ("ddsddt", &vec![0.0; n]),
        ("drplde", &vec![0.0; n]),
        ("drpldt", &[0.0]),
        ("stran", &picked(strain)),
        ("dstran", &picked(last)),
        ("time", &[0.5, 4.5]),
        ("dtime", &[0.5]),
        ("temp", &[0.0]),
        ("dtemp", &[0.0]),
        ("predef", &[0.0]),
        ("dpred", &[0.0]),
        ("ntens", &counts[..1]),
        ("ndi", &counts[1..2]),
        ("nshr", &counts[2..]),
        ("nstatv", &[2.0]),
        ("props", &[E, 1.0, 7.0]),
        ("nprops", &[3.0]),
        ("coords", &coords),
        ("drot", &[cosine, sine, 0.0, -sine, cosine, 0.0, 0.0, 0.0, 1.0]),
        ("pnewdt", &[LARGE]),
        // √(1 × 2) mm
        ("celent", &[2.0_f64.sqrt()]),
        ("dfgrd0", &dfgrd0),
        ("dfgrd1", &dfgrd1),
        ("noel", &[2.0]),
        ("npt", &[3.0]),
        ("layer", &[1.0]),
        ("kspt", &[1.0]),
        ("jstep", &[2.0, 1.0, moved, 0.0]),
        ("kinc", &[2.0]),
    ];
    expect_within(ROUNDING, call, &expected, &[("cmname", "GROUT")]);
}

#[test]
fn umat_in_an_element() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    desk.write("patch.msh", &patch().file());
    for model in ["plane_strain", "axisymmetric", "plane_stress"] {
        for nlgeom in [false, true] {
            println!("{model}, nlgeom {nlgeom}");
            let run = run(&desk, "element", &case(&library, model, nlgeom));
            let calls = calls(&run.log(), "UMAT");
            // the last iteration of the increment
            let place = [("jstep", format!("2,1,{},0", i32::from(nlgeom))), ("kinc", "2".into())];
            let point = [("noel", "2".to_owned()), ("npt", "3".into())];
            let is_it = |call: &&Printed| place.iter().chain(&point).all(|(name, value)| call[*name] == *value);
            matches(model, nlgeom, calls.iter().rfind(is_it).expect("a call for it"));
            // the equilibrium at the start takes a moment: a law may divide by DTIME
            assert!(calls.iter().all(|call| values(&call["dtime"])[0] > 0.0));
            // and every point of both elements is called in every increment
            for (step, (increments, ..)) in STEPS.iter().enumerate() {
                for increment in 1..=*increments {
                    for (element, point) in (1..=2).flat_map(|element| (1..=4).map(move |point| (element, point))) {
                        let wanted = [("noel", element), ("npt", point), ("kinc", increment as i32)];
                        let step = format!("{},", step + 1);
                        let mut found = calls.iter().filter(|call| call["jstep"].starts_with(&step));
                        let called =
                            found.any(|call| wanted.iter().all(|(name, value)| call[*name] == value.to_string()));
                        assert!(called, "step {step} {wanted:?}");
                    }
                }
            }
        }
    }
}

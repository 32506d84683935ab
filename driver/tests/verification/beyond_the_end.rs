//! Contact that begins next to the end of its partner, leaves it over an end, and comes back.

use super::grids::{Grids, Places, elastic, model, steps};
use super::{model_of, run_to_end};
use end_to_end_tests::analytical::cylinder::Cylinder;
use fe_core::model::Model;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// MPa; without lateral contraction, so that blocks of the same width are columns.
const MODULUS: f64 = 1e4;
const FRICTION: f64 = 0.3;
/// What the block's top is pressed down by, mm: a stress of 2 MPa that hardly bends the surfaces.
const PRESS: f64 = 1e-3;
/// The block, mm.
const WIDTH: f64 = 6.0;
const HEIGHT: f64 = 3.0;
/// The base, mm.
const DEPTH: f64 = 2.0;

/// A base from x = 0 on with the top at y = 0, and a block over `from` …
fn blocks(base: f64, from: f64) -> Grids {
    let mut grids = Grids::default();
    let (mut below, mut above) = (Places::new(), Places::new());
    let lines = steps(0.0, base, base as usize);
    grids.cells(&mut below, "base", &lines, &steps(-DEPTH, 0.0, 2), |_, _| true);
    grids.line(&mut below, "track", |x| [x, 0.0], &lines);
    grids.line(&mut below, "bottom", |x| [x, -DEPTH], &lines);
    let lines = steps(from, from + WIDTH, 6);
    grids.cells(&mut above, "block", &lines, &steps(0.0, HEIGHT, 2), |_, _| true);
    grids.line(&mut above, "sole", |x| [x, 0.0], &lines);
    grids.line(&mut above, "top", |x| [x, HEIGHT], &lines);
    grids
}

fn friction(coefficient: f64) -> Value {
    json!({ "plugin": "bond_slip", "props": { "law": "none", "normal_law": "hard", "p_0": 0, "mu": coefficient } })
}

/// The top of the block is moved along x and pressed down; bodies stick to nothing else than each other.
fn moved(grids: &Grids, [slave, master]: [&str; 2], coefficient: f64, steps: Value) -> Model {
    let part = json!({ "model": "plane_strain", "thickness": 1, "material": elastic(MODULUS, 0.0) });
    let case = json!({
        "kind": "pullout", "mesh": { "file": "mesh.msh" },
        "parts": { "base": part, "block": part },
        "contact": [ { "name": "sole", "slave": slave, "master": master, "law": friction(coefficient) } ],
        "supports": {
            "bottom": {},
            "across": { "nodes": "top", "direction": "x", "drive": "x" },
            "down": { "nodes": "top", "direction": [0, -1], "drive": "press" },
        },
        "measure": { "slip": "press", "load": "down" },
        "steps": steps,
    });
    model(&case, grids)
}

/// E u A/h of two columns, N.
fn column() -> f64 {
    MODULUS * PRESS * WIDTH / (HEIGHT + DEPTH)
}

/// A block next to its base is pushed onto it and pressed down: a column.
#[test]
fn a_block_that_starts_next_to_its_base_stands_on_it() {
    for surfaces in [["sole", "track"], ["track", "sole"]] {
        let grids = blocks(WIDTH, -8.0);
        let steps = json!([ { "drives": { "x": 8.0 } }, { "drives": { "press": PRESS }, "increments": 2 } ]);
        let model = moved(&grids, surfaces, 0.0, steps);
        let (mut before, mut load) = (0.0_f64, f64::NAN);
        run_to_end(&model, |record, _| {
            if record.step < 2 {
                before = before.max(record.load.abs());
            }
            load = record.load;
        });
        let expected = column();
        println!("{surfaces:?}: {load:.5} N, {expected:.5} N");
        assert!(before < 1e-9 && (load / expected - 1.0).abs() < 1e-3, "{before} {load}");
    }
}

/// A block slides over both ends of its base and back, again and again: friction does what the drive does, and nothing is lost
/// when it comes back.
#[test]
fn a_block_slides_over_both_ends_and_back() {
    let press = json!({ "drives": { "press": PRESS }, "increments": 2 });
    let to = |x: f64| json!({ "drives": { "x": x } });
    let model =
        moved(&blocks(WIDTH, 0.0), ["sole", "track"], FRICTION, json!([press, to(8.0), to(-8.0), to(8.0), to(0.0)]));
    let (mut worst, mut apart, mut last) = (0.0_f64, 0, [f64::NAN; 2]);
    run_to_end(&model, |record, _| {
        worst = worst.max(record.energy_error.abs());
        apart += usize::from(record.counts.released == 12);
        last = [record.load, record.load_lateral];
    });
    let [load, lateral] = last;
    let expected = column();
    println!("{load:.5} N and {lateral:.5} N, {expected:.5} N, energies {worst:.1e}, {apart} increments apart");
    assert!((load / expected - 1.0).abs() < 5e-3, "{load} N, {expected} N");
    assert!((lateral.abs() / (FRICTION * load) - 1.0).abs() < 1e-3, "{lateral} N");
    assert!(worst < 1e-3 && apart > 10, "{worst}, {apart}");
}

/// A block slides over a longer base whose surface carries the contact points: they come in at its front and go out at its rear.
#[test]
fn a_short_master_slides_on_points_that_come_and_go() {
    const PRESSURE: f64 = 2.0;
    let part = json!({ "model": "plane_strain", "thickness": 1, "material": elastic(MODULUS, 0.2) });
    let case = json!({
        "kind": "pullout", "nlgeom": true, "mesh": { "file": "mesh.msh" },
        "parts": { "base": part, "block": part },
        "contact": [ { "name": "sole", "slave": "track", "master": "sole", "law": friction(FRICTION) } ],
        "supports": { "bottom": {}, "level": { "nodes": "top", "direction": "x", "drive": "pull" } },
        "loads": { "top": { "traction": [0, -PRESSURE], "drive": "press" } },
        "measure": { "slip": "pull", "load": "level" },
        "steps": [ { "drives": { "press": 1 } }, { "drives": { "pull": 4.0 } } ],
    });
    let model = model(&case, &blocks(24.0, 3.2));
    let expected = FRICTION * PRESSURE * WIDTH;
    let (mut worst, mut energies, mut sliding) = (0.0_f64, 0.0_f64, 0);
    run_to_end(&model, |record, _| {
        energies = energies.max(record.energy_error.abs());
        if record.step == 2 && record.slip > 0.1 {
            worst = worst.max((record.load / expected - 1.0).abs());
            sliding += 1;
        }
    });
    println!("{expected} N, off by {worst:.1e} in {sliding} increments, energies {energies:.1e}");
    assert!(worst < 5e-3 && sliding > 20 && energies < 1e-3, "{worst} {sliding} {energies}");
}

/// A shaft is pushed into a sleeve that was around nothing, the sleeve is pressed on it from outside (Lamé), and the shaft pulled.
#[test]
fn a_shaft_that_enters_a_sleeve_is_clamped_by_it() {
    const RADIUS: f64 = 5.0;
    const OUTER: f64 = 10.0;
    const LENGTH: f64 = 20.0;
    const PRESSURE: f64 = 10.0;
    let mut grids = Grids::default();
    let (mut shaft, mut sleeve) = (Places::new(), Places::new());
    let start = LENGTH + 1.0;
    let along = steps(start, start + LENGTH, 10);
    grids.cells(&mut shaft, "shaft", &steps(0.0, RADIUS, 2), &along, |_, _| true);
    grids.line(&mut shaft, "surface", |z| [RADIUS, z], &along);
    grids.line(&mut shaft, "axis", |z| [0.0, z], &along);
    grids.line(&mut shaft, "head", |x| [x, start + LENGTH], &steps(0.0, RADIUS, 2));
    let along = steps(0.0, LENGTH, 10);
    let across = steps(RADIUS, OUTER, 8);
    grids.cells(&mut sleeve, "sleeve", &across, &along, |_, _| true);
    grids.line(&mut sleeve, "bore", |z| [RADIUS, z], &along);
    grids.line(&mut sleeve, "outside", |z| [OUTER, z], &along);
    grids.line(&mut sleeve, "foot", |x| [x, 0.0], &across);
    let part = |modulus: f64| json!({ "model": "axisymmetric", "material": elastic(modulus, 0.0) });
    let (of_shaft, of_sleeve) = (200e3, 70e3);
    let pull = -start + 0.03;
    let case = json!({
        "kind": "pullout", "mesh": { "file": "mesh.msh" },
        "parts": { "shaft": part(of_shaft), "sleeve": part(of_sleeve) },
        "contact": [ { "name": "bore", "slave": "bore", "master": "surface", "law": friction(FRICTION) } ],
        "supports": {
            "axis": { "direction": "x" },
            "foot": { "direction": "y" },
            "head": { "direction": "y", "drive": "z" },
        },
        "loads": { "outside": { "pressure": 1, "drive": "press" } },
        "measure": { "slip": "z", "load": "head" },
        "steps": [ { "drives": { "z": -start } }, { "drives": { "press": PRESSURE } }, { "drives": { "z": pull } } ],
    });
    let model = model(&case, &grids);
    // the sleeve alone would close by u₀ under the outer pressure; the pressure on the bore opens it, and presses the shaft
    let ring = Cylinder { inner: RADIUS, outer: OUTER, modulus: of_sleeve, poisson: 0.0 };
    let closes = 2.0 * PRESSURE * OUTER * OUTER * RADIUS / (of_sleeve * (OUTER * OUTER - RADIUS * RADIUS));
    let pressure = closes / (ring.elastic_displacement(1.0, RADIUS) + RADIUS / of_shaft);
    let expected = FRICTION * pressure * 2.0 * PI * RADIUS * LENGTH;
    let (mut load, mut on_bore) = (f64::NAN, f64::NAN);
    run_to_end(&model, |record, snapshot| {
        load = record.load;
        if record.step == 2 {
            let (force, area) = snapshot.contact().points().fold((0.0, 0.0), |(force, area), point| {
                (force + point.area * point.weight * point.pressure, area + point.area)
            });
            on_bore = force / area;
        }
    });
    println!("{on_bore:.4} MPa, {pressure:.4} MPa; {load:.3} N, {expected:.3} N");
    assert!((on_bore / pressure - 1.0).abs() < 1e-3, "{on_bore} MPa, {pressure} MPa");
    assert!((load / expected - 1.0).abs() < 5e-3, "{load} N, {expected} N");
}

/// Ends of steps of a fibre that slides under residual friction alone over `turns`: loads and points past an end; and the largest
/// error of the energies.
fn rubbed(turns: [f64; 4]) -> ([[f64; 2]; 4], f64) {
    let bond = json!({ "plugin": "bond_slip", "props": {
        "law": "B", "form": "piecewise", "normal_law": "hard", "p_0": 1000, "delta_N": 0.004, "k_e": 1000,
        "tau_res": RESIDUAL, "mu": 0, "points": [[0.001, 1.0], [0.01, RESIDUAL]],
    } });
    let specimen = json!({
        "type": "perpendicular_fibre", "embedded_elements": 8, "equal_sizes": true, "free_length": 1,
    });
    let material = |modulus: f64| format!("{}", elastic(modulus, 0.0));
    let model = model_of(
        "chapter-6",
        "6.14-plane",
        &[
            &format!("mesh.specimen={specimen}"),
            &format!("parts.fibre.material={}", material(210e3)),
            &format!("parts.matrix.material={}", material(30e3)),
            &format!("contact={}", json!({ "law": bond })),
            &format!("steps={}", json!(turns.map(|slip| json!({ "slip": slip })))),
        ],
    );
    let (mut ends, mut energies) = ([[f64::NAN; 2]; 4], 0.0_f64);
    run_to_end(&model, |record, _| {
        energies = energies.max(record.energy_error.abs());
        if record.step > 0 {
            ends[record.step as usize - 1] = [record.load, record.counts.released as f64];
        }
    });
    (ends, energies)
}

/// MPa.
const RESIDUAL: f64 = 0.99;

/// The friction of a fibre that is in its hole over this length, N.
fn rubs(length: f64) -> f64 {
    const DIAMETER: f64 = 0.406;
    RESIDUAL * PI * DIAMETER * length
}

const EMBEDDED: f64 = 12.2;

/// A fibre is pulled out, pushed back, pulled out to the last and pushed back again.
#[test]
fn a_fibre_that_is_pushed_back_rubs_along_what_is_in_its_hole() {
    let (ends, energies) = rubbed([6.0, 0.2, 13.0, 0.2]);
    let inside = |slip: f64| rubs(EMBEDDED - slip);
    let expected = [inside(6.0), -inside(0.2), 0.0, -inside(0.2)];
    println!("{ends:?}, {expected:?}, energies {energies:.1e}");
    for ([load, _], expected) in ends.iter().zip(expected) {
        assert!((load - expected).abs() < 5e-3 * inside(0.0), "{load} N, {expected} N");
    }
    assert!(ends[1][1] == 0.0 && ends[2][1] == 32.0 && ends[3][1] == 0.0 && energies < 1e-3, "{ends:?} {energies}");
}

/// A fibre goes to and fro over both ends of its hole: its tail leaves it at one, its head, 1 mm before the face, at the other.
#[test]
fn a_fibre_that_slides_past_both_ends_keeps_its_energies() {
    let (ends, energies) = rubbed([3.0, -3.0, 3.0, -3.0]);
    let (out, back) = (rubs(EMBEDDED - 3.0), -rubs(EMBEDDED - (3.0 - 1.0)));
    println!("{ends:?}, {out} N, {back} N, energies {energies:.1e}");
    for ([load, released], expected) in ends.into_iter().zip([out, back, out, back]) {
        assert!((load / expected - 1.0).abs() < 5e-3 && released > 0.0, "{load} N, {expected} N");
    }
    assert!(energies < 1e-3, "{energies}");
}

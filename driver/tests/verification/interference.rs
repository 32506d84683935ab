//! Surfaces that overlap or gape at the start, shrink fits, and obstacles that do not deform.

use super::grids::{Grids, Places, elastic, model, steps};
use super::run_to_end;
use end_to_end_tests::analytical::cylinder::Cylinder;
use fe_core::model::Model;
use fe_core::stepping::Snapshot;
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI};

const RADIUS: f64 = 5.0;
const OUTER: f64 = 10.0;
/// The length of an axisymmetric shaft, and what a plane ring is thick, mm.
const LENGTH: f64 = 2.0;
/// MPa.
const OF_SHAFT: f64 = 200e3;
const OF_SLEEVE: f64 = 70e3;
const POISSON: f64 = 0.3;
/// Radial overlap, mm.
const OVERLAP: f64 = 5e-3;
/// Pressure on the sleeve's outside, MPa.
const SQUEEZE: f64 = 40.0;

/// Assumption about the axis of shaft and sleeve.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Along {
    Plane(&'static str),
    /// Free to lengthen.
    Free,
    /// Held at both ends.
    Held,
}

impl Along {
    /// Returns the constants for a plane strain computation that replace those of the material.
    fn constants(self, modulus: f64) -> [f64; 2] {
        match self {
            Self::Plane("plane_stress") | Self::Free => {
                // E (1 + 2ν)/(1 + ν)², ν/(1 + ν)
                [modulus * (1.0 + 2.0 * POISSON) / (1.0 + POISSON).powi(2), POISSON / (1.0 + POISSON)]
            }
            Self::Plane(_) | Self::Held => [modulus, POISSON],
        }
    }

    /// Radial displacements of the sleeve's bore, outwards, and of the shaft, inwards, under a pressure of 1 MPa between them.
    fn flexibility(self) -> [f64; 2] {
        let [modulus, poisson] = self.constants(OF_SLEEVE);
        let sleeve = Cylinder { inner: RADIUS, outer: OUTER, modulus, poisson };
        let [modulus, poisson] = self.constants(OF_SHAFT);
        [sleeve.elastic_displacement(1.0, RADIUS), (1.0 + poisson) * (1.0 - 2.0 * poisson) * RADIUS / modulus]
    }

    /// Lamé's pressure of an overlap.
    fn pressure(self, overlap: f64) -> f64 {
        overlap / self.flexibility().iter().sum::<f64>()
    }

    /// The pressure on the bore of a shaft that fits under [`SQUEEZE`] on the outside.
    fn squeezed(self) -> f64 {
        let [modulus, poisson] = self.constants(OF_SLEEVE);
        // u(a) = 2 p b² a (1 − ν²)/(E (b² − a²)) inwards of the ring alone
        let closes = 2.0 * SQUEEZE * OUTER * OUTER * RADIUS * (1.0 - poisson * poisson)
            / (modulus * (OUTER * OUTER - RADIUS * RADIUS));
        closes / self.flexibility().iter().sum::<f64>()
    }
}

/// A shaft whose radius is `larger` by this than the bore of a sleeve around it: a quarter of both, or axisymmetric.
fn shaft_in_sleeve(along: Along, larger: f64, contact: Value, steps_of_case: Value) -> Model {
    let mut grids = Grids::default();
    let (mut shaft, mut sleeve) = (Places::new(), Places::new());
    let shaft_radius = RADIUS + larger;
    let is_plane = matches!(along, Along::Plane(_));
    let (model_name, across) = match along {
        Along::Plane(name) => (name, steps(0.0, FRAC_PI_2, 8)),
        _ => ("axisymmetric", steps(0.0, LENGTH, 2)),
    };
    // a tube with a fine bore replaces a shaft in a plane, whose grid has no middle
    let inside = if is_plane { 0.05 } else { 0.0 };
    let graded = |from: f64, to: f64, count: usize| -> Vec<f64> {
        if from == 0.0 || !is_plane {
            return steps(from, to, count);
        }
        (0..=count).map(|k| from * (to / from).powf(k as f64 / count as f64)).collect()
    };
    let of_shaft = graded(inside, shaft_radius, if is_plane { 16 } else { 2 });
    let of_sleeve = graded(RADIUS, OUTER, 8);
    grids.cells(&mut shaft, "shaft", &of_shaft, &across, |_, _| true);
    grids.line(&mut shaft, "surface", |s| [shaft_radius, s], &across);
    grids.cells(&mut sleeve, "sleeve", &of_sleeve, &across, |_, _| true);
    grids.line(&mut sleeve, "bore", |s| [RADIUS, s], &across);
    grids.line(&mut sleeve, "outside", |s| [OUTER, s], &across);
    let ends = [across[0], across[across.len() - 1]];
    for (name, end) in ["start", "end"].into_iter().zip(ends) {
        grids.line(&mut shaft, name, |r| [r, end], &of_shaft);
        grids.line(&mut sleeve, name, |r| [r, end], &of_sleeve);
    }
    let mut supports = json!({ "start": { "direction": "y" } });
    if is_plane {
        supports["end"] = json!({ "direction": "x" });
        for [r, angle] in &mut grids.nodes {
            let [x, y] = [*r * angle.cos(), *r * angle.sin()];
            [*r, *angle] = [x, y];
        }
    } else {
        grids.line(&mut shaft, "axis", |s| [0.0, s], &across);
        supports["axis"] = json!({ "direction": "x" });
        if along == Along::Held {
            supports["end"] = json!({ "direction": "y" });
        }
    }
    let part = |modulus: f64| {
        let mut part = json!({ "model": model_name, "material": elastic(modulus, POISSON) });
        if is_plane {
            part["thickness"] = json!(LENGTH);
        }
        part
    };
    let mut pair = json!({
        "name": "bore", "slave": "bore", "master": "surface",
        "law": { "plugin": "bond_slip", "props": { "law": "none", "normal_law": "hard", "p_0": 0, "mu": 0 } },
    });
    for (key, value) in contact.as_object().expect("keys of the pair") {
        pair[key] = value.clone();
    }
    let case = json!({
        "kind": "pullout", "mesh": { "file": "mesh.msh" },
        "parts": { "shaft": part(OF_SHAFT), "sleeve": part(OF_SLEEVE) },
        "contact": [ pair ],
        "supports": supports,
        "loads": { "outside": { "pressure": 1, "drive": "squeeze" } },
        "steps": steps_of_case,
    });
    model(&case, &grids)
}

/// The mean pressure between the surfaces, MPa, and their area, mm².
fn on_bore(snapshot: &Snapshot<'_>) -> [f64; 2] {
    let (force, area) = snapshot.contact().points().fold((0.0, 0.0), |(force, area), point| {
        (force + point.area * point.weight * point.pressure, area + point.area)
    });
    [force / area, area]
}

const ALL: [Along; 4] = [Along::Plane("plane_strain"), Along::Plane("plane_stress"), Along::Free, Along::Held];

/// An overlap that grows with a drive, or that the mesh has, makes Lamé's pressure; its work is what both bodies store.
#[test]
fn shrink_fits_have_lames_pressure() {
    for along in ALL {
        for (larger, interference) in
            [(0.0, json!({ "drive": "fit", "depth": OVERLAP })), (OVERLAP, json!({ "drive": "fit" }))]
        {
            let half = json!({ "drives": { "fit": 0.5 }, "increments": 1 });
            let whole = json!({ "drives": { "fit": 1, "squeeze": 0 }, "increments": 2 });
            let contact = json!({ "interference": interference });
            let model = shaft_in_sleeve(along, larger, contact, json!([half, whole]));
            let (mut pressures, mut work, mut energies, mut iterations) = ([f64::NAN; 3], f64::NAN, 0.0_f64, 0);
            let mut area = f64::NAN;
            run_to_end(&model, |record, snapshot| {
                [pressures[record.step as usize], area] = on_bore(snapshot);
                work = record.energies.external_work;
                energies = energies.max(record.energy_error.abs());
                iterations = iterations.max(record.iterations.len());
            });
            let expected = along.pressure(OVERLAP);
            let expected_work = 0.5 * expected * OVERLAP * area;
            println!("{along:?}, {larger}: {pressures:.4?} MPa, {expected:.4} MPa, {work:.4} N mm, {expected_work:.4}");
            assert_eq!(pressures[0], 0.0, "{along:?}: what the mesh has presses nothing at first");
            assert!((pressures[1] / (0.5 * expected) - 1.0).abs() < 5e-3, "{along:?}: {} MPa", pressures[1]);
            assert!((pressures[2] / expected - 1.0).abs() < 5e-3, "{along:?}: {} MPa, {expected} MPa", pressures[2]);
            assert!((work / expected_work - 1.0).abs() < 5e-3 && energies < 1e-6, "{along:?}: {work} N mm, {energies}");
            assert!(iterations <= 4, "{along:?}: the tangent knows the drive");
        }
    }
}

/// A shaft that the mesh makes too thick or too thin has no pressure at first, and then carries load as one that fits.
#[test]
fn gaps_and_overlaps_of_the_mesh_are_closed_on_request() {
    for along in ALL {
        for larger in [OVERLAP, -OVERLAP] {
            for close in [json!("close"), json!({ "close": 2.0 * OVERLAP })] {
                let squeeze = json!({ "drives": { "squeeze": SQUEEZE }, "increments": 2 });
                let model = shaft_in_sleeve(along, larger, json!({ "initial_gap": close }), json!([squeeze]));
                let mut pressures = [f64::NAN; 2];
                run_to_end(&model, |record, snapshot| [pressures[record.step as usize], _] = on_bore(snapshot));
                let expected = along.squeezed();
                println!("{along:?}, {larger}: {pressures:.4?} MPa, {expected:.4} MPa");
                assert!(pressures[0].abs() < 1e-9 * expected, "{along:?}: {} MPa at the start", pressures[0]);
                assert!((pressures[1] / expected - 1.0).abs() < 5e-3, "{along:?}: {pressures:?} MPa, {expected} MPa");
            }
        }
        // a gap larger than what is closed has to close first
        let squeeze = json!({ "drives": { "squeeze": SQUEEZE }, "increments": 2 });
        let close = json!({ "initial_gap": { "close": 0.5 * OVERLAP } });
        let model = shaft_in_sleeve(along, -OVERLAP, close, json!([squeeze]));
        let mut pressure = f64::NAN;
        run_to_end(&model, |_, snapshot| [pressure, _] = on_bore(snapshot));
        let expected = along.squeezed() - along.pressure(OVERLAP);
        assert!((pressure / expected - 1.0).abs() < 5e-3, "{along:?}: {pressure} MPa, {expected} MPa");
    }
}

/// A shaft enters a sleeve that was around nothing, is heated in it across its axis, and pulled.
#[test]
fn a_shaft_that_is_heated_in_a_sleeve_is_clamped() {
    const FRICTION: f64 = 0.3;
    const EXPANSION: f64 = 1.2e-5;
    const HEAT: f64 = 50.0;
    const LENGTH: f64 = 20.0;
    let mut grids = Grids::default();
    let (mut shaft, mut sleeve) = (Places::new(), Places::new());
    let start = LENGTH + 1.0;
    let along = steps(start, start + LENGTH, 10);
    let of_shaft = steps(0.0, RADIUS, 2);
    grids.cells(&mut shaft, "shaft", &of_shaft, &along, |_, _| true);
    grids.line(&mut shaft, "surface", |z| [RADIUS, z], &along);
    grids.line(&mut shaft, "axis", |z| [0.0, z], &along);
    grids.line(&mut shaft, "head", |x| [x, start + LENGTH], &of_shaft);
    let along = steps(0.0, LENGTH, 10);
    let across = steps(RADIUS, OUTER, 8);
    grids.cells(&mut sleeve, "sleeve", &across, &along, |_, _| true);
    grids.line(&mut sleeve, "bore", |z| [RADIUS, z], &along);
    grids.line(&mut sleeve, "foot", |x| [x, 0.0], &across);
    let mut of_shaft = elastic(OF_SHAFT, 0.0);
    of_shaft["expansion"] = json!({ "alpha": [EXPANSION, 0, EXPANSION] });
    let friction =
        json!({ "plugin": "bond_slip", "props": { "law": "none", "normal_law": "hard", "p_0": 0, "mu": FRICTION } });
    let case = json!({
        "kind": "pullout", "mesh": { "file": "mesh.msh" }, "temperature": 0,
        "parts": {
            "shaft": { "model": "axisymmetric", "material": of_shaft },
            "sleeve": { "model": "axisymmetric", "material": elastic(OF_SLEEVE, 0.0) },
        },
        "contact": [ { "name": "bore", "slave": "bore", "master": "surface", "law": friction } ],
        "supports": {
            "axis": { "direction": "x" },
            "foot": { "direction": "y" },
            "head": { "direction": "y", "drive": "z" },
        },
        "measure": { "slip": "z", "load": "head" },
        "steps": [
            { "drives": { "z": -start } },
            { "temperature": HEAT, "increments": 2 },
            { "drives": { "z": -start + 0.03 } },
        ],
    });
    let model = model(&case, &grids);
    let ring = Cylinder { inner: RADIUS, outer: OUTER, modulus: OF_SLEEVE, poisson: 0.0 };
    let pressure = EXPANSION * HEAT * RADIUS / (ring.elastic_displacement(1.0, RADIUS) + RADIUS / OF_SHAFT);
    let expected = FRICTION * pressure * 2.0 * PI * RADIUS * LENGTH;
    let (mut load, mut on_bores) = (f64::NAN, [f64::NAN; 4]);
    run_to_end(&model, |record, snapshot| {
        load = record.load;
        [on_bores[record.step as usize], _] = on_bore(snapshot);
    });
    println!("{on_bores:.4?} MPa, {pressure:.4} MPa; {load:.3} N, {expected:.3} N");
    assert!(
        on_bores[1].abs() < 1e-6 && (on_bores[2] / pressure - 1.0).abs() < 1e-3,
        "{on_bores:?} MPa, {pressure} MPa"
    );
    assert!((load / expected - 1.0).abs() < 5e-3, "{load} N, {expected} N");
}

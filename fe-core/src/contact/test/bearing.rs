//! Surfaces that are crushed: pressure, tangent and energy.

use super::tangent::{check, tangent_error, turned};
use super::*;
use crate::element::ElementKind::{Q4, Q8};
use crate::model::Bearing;

/// 2 MPa, reached 0.05 mm deep: under a penalty of some 200 MPa/mm.
const BEARING: Bearing = Bearing { strength: 2.0, depth: 0.05 };

fn bearing(pair: ContactPair) -> ContactPair {
    ContactPair { bearing: Some(BEARING), ..pair }
}

/// By hand: 0.8 MPa at first, then 2 √(0.16 + 0.84 u_b/0.05) MPa up to 2 MPa; back along the penalty.
#[test]
fn a_surface_is_crushed_up_to_what_it_bears_and_stays_crushed() {
    for kind in [Q4, Q8] {
        let scene = Scene::straight(kind);
        for law in [uinter(&[("law", 2.0), ("mu", 0.3)]), hard(0.0, 0.0, &[("law", 2.0), ("mu", 0.3)])] {
            let mut contact = scene.contact(bearing(scene.pair(law)));
            let penalty = contact.penalties().next().expect("a pair");
            let half = 2.0 * 0.58_f64.sqrt();
            let path = [
                (0.8 / penalty, 0.8),
                (0.025 + half / penalty, half),
                (0.1 + 2.0 / penalty, 2.0),
                (0.1 + 1.0 / penalty, 1.0),
                (0.09, 0.0),
                (0.1 + 1.9 / penalty, 1.9),
                (0.12, 2.0),
            ];
            for (penetration, pressure) in path {
                forces(&mut contact, &scene.moved(1, |_| [0.0, -penetration]));
                let wrong = contact.points().find(|point| (point.pressure - pressure).abs() > 1e-9);
                assert!(wrong.is_none(), "{wrong:?} instead of {pressure} at {penetration}");
                contact.commit();
                // what is crushed is no gap any more
                let depth = (penetration - 0.1).max(0.0).min(2.0 / penalty);
                assert!(penetration < 0.1 || contact.points().all(|point| (point.gap + depth).abs() < 1e-9));
            }
        }
    }
}

/// 2/3 p_b δ_b (1 − 0.4³)/0.84 along the rise, p_b (u_b − δ_b) beyond it, on the area.
#[test]
fn crushing_takes_the_work_of_the_pressure_on_what_is_crushed() {
    const STEPS: u32 = 500;
    for kind in [Q4, Q8] {
        let scene = Scene::straight(kind);
        let pair = scene.pair(uinter(&[("law", 2.0)]));
        let mut contact = scene.contact(bearing(pair));
        let area: f64 = contact.points().map(|point| point.area).sum();
        for step in 1..=STEPS {
            let displacements = scene.moved(1, |_| [0.0, -0.12 * f64::from(step) / f64::from(STEPS)]);
            forces(&mut contact, &displacements);
            contact.commit();
        }
        let energies = contact.energies();
        let spent = energies.plugin_dissipated;
        let balance = energies.work - spent - energies.plugin_stored;
        assert!(balance.abs() < 2e-3 * energies.work, "{energies:?}");
        let depth = 0.12 - energies.plugin_stored / area;
        let expected = 2.0 / 3.0 * 0.1 * (1.0 - 0.064) / 0.84 + 2.0 * (depth - 0.05);
        assert!((spent / (area * expected) - 1.0).abs() < 2e-3, "{spent} instead of {}", area * expected);
    }
}

#[test]
fn tangents_of_crushed_surfaces_are_derivatives() {
    let uzawa = Enforcement::Uzawa { tolerance: 1e-9, max_updates: 2 };
    for kind in [Q4, Q8] {
        for scene in [Scene::straight(kind), Scene::rows(kind, parabola, PlaneModel::PlaneStrain)] {
            for law in [
                uinter(&[("law", 2.0), ("mu", 0.3)]),
                uinter(&[("law", 1.0), ("mu", 0.3)]),
                hard(0.0, 0.0, &[("law", 2.0), ("mu", 0.3)]),
                soft(&[("mu", 0.4)]),
            ] {
                for enforcement in [Enforcement::Penalty, uzawa] {
                    let is_soft = matches!(&law, ContactLaw::Fric { normal: NormalLaw::Soft(_), .. });
                    if is_soft && enforcement == uzawa {
                        continue;
                    }
                    let pair = ContactPair { enforcement, ..bearing(scene.pair(law.clone())) };
                    // on the rise, on the plateau, and back
                    check(&scene, pair.clone(), &[[0.1, -0.015], [0.3, -0.03]]);
                    check(&scene, pair.clone(), &[[0.1, -0.03], [0.3, -0.09]]);
                    check(&scene, pair, &[[0.1, -0.09], [0.3, -0.085]]);
                }
            }
        }
    }
}

/// An edge that rotates in what it has crushed is pressed by no more than the strength at any of its points.
#[test]
fn an_edge_turns_in_what_it_crushes() {
    let surface = Bearing { strength: 0.004, depth: 0.05 };
    let crushed = |scene: &Scene| {
        let pair = scene.pair(uinter(&[("law", 2.0), ("mu", 0.3)]));
        scene.contact(ContactPair { bearing: Some(surface), ..pair })
    };
    for (angle, lift, least) in [(0.2, 0.01, 0.0), (0.2, -0.06, 0.004), (-0.2, -0.06, 0.004)] {
        let (scene, displacements) = turned(angle, lift);
        let mut contact = crushed(&scene);
        let (error, _) = tangent_error(&mut contact, &displacements);
        assert!(error < 1e-6, "error {error:.2e} at {angle}, {lift}");
        let pressures: Vec<f64> = contact.points().map(|point| point.pressure).collect();
        let [low, high] = [f64::min, f64::max].map(|of| pressures.iter().copied().reduce(of).expect("a point"));
        assert!((low - least).abs() < 1e-9 && (high - 0.004).abs() < 1e-9, "{pressures:?}");
    }
    const STEPS: u32 = 400;
    let (scene, mut last) = turned(0.0, 0.0);
    let mut contact = crushed(&scene);
    let (mut pushed, mut work) = (forces(&mut contact, &last), 0.0);
    for step in 1..=STEPS {
        let part = f64::from(step) / f64::from(STEPS);
        let (_, displacements) = turned(0.3 * part, -0.05 * part * part);
        let now = forces(&mut contact, &displacements);
        work += (0..now.len()).map(|i| 0.5 * (pushed[i] + now[i]) * (displacements[i] - last[i])).sum::<f64>();
        contact.commit();
        (pushed, last) = (now, displacements);
    }
    let energies = contact.energies();
    let kept = energies.plugin_stored + energies.normal_stored;
    assert!((energies.work / work - 1.0).abs() < 1e-3, "{energies:?} instead of {work}");
    assert!(((energies.plugin_dissipated + kept) / work - 1.0).abs() < 1e-3, "{energies:?} instead of {work}");
}

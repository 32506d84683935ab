//! The stiffness is the derivative of the forces, in every state.

use super::*;
use crate::element::ElementKind::{Q4, Q8};
use crate::model::Quadrature::{Gauss, Nodes, Segments};

/// Central differences of the forces against the blocks, relative to the largest entry; with that entry.
fn tangent_error(contact: &mut Contact, displacements: &[f64]) -> (f64, f64) {
    const STEP: f64 = 1e-6;
    let stiffness = stiffness(contact, displacements);
    let scale = stiffness.iter().map(|row| largest(row)).fold(0.0, f64::max);
    let mut error: f64 = 0.0;
    for column in 0..displacements.len() {
        let mut moved = displacements.to_vec();
        moved[column] += STEP;
        let ahead = forces(contact, &moved);
        moved[column] -= 2.0 * STEP;
        let back = forces(contact, &moved);
        for row in 0..displacements.len() {
            let difference = (ahead[row] - back[row]) / (2.0 * STEP);
            error = error.max((difference - stiffness[row][column]).abs());
        }
    }
    // The trial is left where the tangent belongs.
    forces(contact, displacements);
    (error / scale, scale)
}

/// Goes through `path` of the slave (each point committed), and checks the tangent at its end. The last status counts.
fn check(scene: &Scene, pair: ContactPair, path: &[[f64; 2]]) -> Contact {
    let mut contact = scene.contact(pair);
    let (last, before) = path.split_last().unwrap();
    for &movement in before {
        forces(&mut contact, &scene.shaken(movement, 0.002));
        while contact.settle().again {
            forces(&mut contact, &scene.shaken(movement, 0.002));
        }
        contact.commit();
    }
    let (error, scale) = tangent_error(&mut contact, &scene.shaken(*last, 0.002));
    assert!(scale > 1.0, "there is a stiffness to check: {scale}");
    assert!(error < 1e-6, "error {error:.2e} at {path:?}");
    contact
}

/// A name of a failure: which curve, which elements.
fn scenes() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for kind in [Q4, Q8] {
        scenes.push(Scene::straight(kind));
        scenes.push(Scene::rows(kind, parabola, PlaneModel::PlaneStrain));
        scenes.push(Scene::rows(kind, |x| -parabola(x), PlaneModel::PlaneStress));
    }
    scenes
}

/// Facets of two curved surfaces cut into each other: the gap at the start is the facets'.
fn of(scene: &Scene, law: ContactLaw) -> ContactPair {
    scene.pair(law)
}

#[test]
fn stick_hardening_softening_and_unloading_of_uinter_and_fric() {
    for scene in scenes() {
        for law in [uinter(&[]), hard(1000.0, 0.1, &[])] {
            let sticks = check(&scene, of(&scene, law.clone()), &[[0.012, -0.02]]);
            assert!(sticks.symmetric(), "k_e and ε_N alone");
            check(&scene, of(&scene, law.clone()), &[[0.1, -0.02]]);
            check(&scene, of(&scene, law.clone()), &[[-0.6, 0.01]]);
            check(&scene, of(&scene, law.clone()), &[[0.6, 0.01], [0.58, 0.02]]);
        }
    }
}

#[test]
fn friction_under_pressure_is_unsymmetric() {
    for scene in scenes() {
        for law in [uinter(&[("law", 2.0), ("mu", 0.3)]), hard(0.0, 0.0, &[("law", 2.0), ("mu", 0.3)])] {
            let slides = check(&scene, of(&scene, law.clone()), &[[0.4, -0.05]]);
            assert!(!slides.symmetric());
            assert_eq!(slides.counts().slipping, 6);
            let snubbing = check(&scene, of(&scene, uinter(&[("mu", 0.5)])), &[[0.4, -0.05]]);
            assert!(!snubbing.symmetric());
        }
    }
}

#[test]
fn law_b_and_the_soft_law() {
    for scene in scenes() {
        check(&scene, of(&scene, uinter(&[("law", 1.0), ("mu", 0.3)])), &[[0.1, -0.05], [0.3, -0.04]]);
        for law in [soft(&[("mu", 0.4)]), uinter(&[("normal_law", 1.0), ("p_0", 2.0), ("g_0", 0.1), ("mu", 0.4)])] {
            check(&scene, of(&scene, law.clone()), &[[0.1, -0.05]]);
            check(&scene, of(&scene, law.clone()), &[[0.4, 0.05]]);
            check(&scene, of(&scene, law), &[[0.4, -0.65]]);
        }
        // Inside the fade of the bond, 0.8 g_0 to g_0.
        let fading = uinter(&[("normal_law", 1.0), ("p_0", 2.0), ("g_0", 0.1)]);
        check(&scene, of(&scene, fading), &[[0.1, 0.09]]);
    }
}

#[test]
fn opening_under_the_cap_back_along_the_secant_and_closed_again() {
    for scene in scenes() {
        // ε_N is 200 MPa/mm: the cap of 4 MPa is passed at a gap of 0.02 mm, gone 0.2 mm later.
        let fading = || of(&scene, hard(4.0, 0.2, &[]));
        let opened = check(&scene, fading(), &[[0.01, 0.06], [0.01, 0.12]]);
        assert!(opened.points().all(|point| point.latched && point.pressure < 0.0));
        check(&scene, fading(), &[[0.01, 0.06], [0.01, 0.12], [0.01, 0.05]]);
        check(&scene, fading(), &[[0.01, 0.06], [0.01, 0.12], [0.01, -0.05]]);
        check(&scene, fading(), &[[0.01, 0.06], [0.01, 0.4], [0.01, -0.05]]);
        check(&scene, of(&scene, uinter(&[("p_0", 4.0), ("delta_N", 0.2)])), &[[0.01, 0.06], [0.01, 0.12]]);
    }
}

#[test]
fn an_open_point_does_nothing() {
    let scene = Scene::straight(Q8);
    let mut contact = scene.contact(scene.pair(hard(0.0, 0.0, &[("law", 2.0), ("mu", 0.3)])));
    let open = scene.moved(1, |_| [0.1, 0.3]);
    assert_eq!(largest(&forces(&mut contact, &open)), 0.0);
    assert!(stiffness(&mut contact, &open).iter().all(|row| largest(row) == 0.0));
    assert_eq!(contact.counts().open, 6);
}

#[test]
fn past_the_end_of_the_master_with_and_without_release() {
    for scene in scenes() {
        for law in [uinter(&[("mu", 0.3)]), hard(1000.0, 0.1, &[("mu", 0.3)])] {
            for slide in [1.3, -1.2] {
                for release in [false, true] {
                    let contact = check(&scene, ContactPair { release, ..of(&scene, law.clone()) }, &[[slide, -0.05]]);
                    assert_eq!(contact.counts().released > 0, release && scene.slave.len() == 3 && slide.abs() > 9.0);
                    let fading = contact.points().any(|point| point.weight > 0.0 && point.weight < 1.0);
                    assert_eq!(fading, release, "slide {slide}");
                }
            }
        }
    }
}

#[test]
fn axial_symmetry_and_all_quadratures() {
    for kind in [Q4, Q8] {
        for model in [PlaneModel::Axisymmetric, PlaneModel::PlaneStrain] {
            let scene = Scene::rows(kind, parabola, model);
            for quadrature in [Gauss { points: 3 }, Nodes, Segments { points: 2 }] {
                for width in [Width::OfPart, Width::Given(3.0)] {
                    let pair =
                        ContactPair { quadrature, width, penalty_factor: 3.0, ..of(&scene, uinter(&[("mu", 0.2)])) };
                    check(&scene, pair.clone(), &[[0.3, -0.03]]);
                }
            }
        }
    }
}

#[test]
fn augmented_and_condensed_multipliers() {
    for scene in scenes() {
        let tolerance = 1e-9;
        for law in [uinter(&[]), hard(1000.0, 0.1, &[]), hard(0.0, 0.0, &[("law", 2.0), ("mu", 0.3)])] {
            let uzawa = Enforcement::Uzawa { tolerance, max_updates: 2 };
            let contact = check(
                &scene,
                ContactPair { enforcement: uzawa, ..of(&scene, law.clone()) },
                &[[0.01, -0.03], [0.3, -0.031]],
            );
            // λ = −2 ε_N g_N after two updates.
            let penalty = contact.penalties().next().unwrap();
            let point = contact.points().next().unwrap();
            assert!(point.pressure > 2.5 * penalty * -point.gap, "the multiplier counts: {point:?}");
        }
        let condensed = Enforcement::PerturbedLagrangian { ratio: 1e4 };
        for law in [uinter(&[]), hard(1000.0, 0.1, &[])] {
            let pair = ContactPair { enforcement: condensed, penalty_factor: 0.01, ..of(&scene, law) };
            let contact = check(&scene, pair, &[[0.01, -0.03]]);
            let penalty = contact.penalties().next().unwrap();
            let point = contact.points().next().unwrap();
            assert!((point.pressure / (10_001.0 * penalty * -point.gap) - 1.0).abs() < 1e-12);
        }
    }
}

//! The stiffness is the derivative of the forces, in every state.

use super::*;
use crate::element::ElementKind::{Q4, Q8};
use crate::model::Interference;
use crate::model::Quadrature::{Gauss, Nodes, Segments};

/// Central differences of the forces against the blocks, relative to the largest entry; with that entry.
pub(super) fn tangent_error(contact: &mut Contact, displacements: &[f64]) -> (f64, f64) {
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
pub(super) fn check(scene: &Scene, pair: ContactPair, path: &[[f64; 2]]) -> Contact {
    let mut contact = scene.contact(pair);
    let (last, before) = path.split_last().unwrap();
    for &movement in before {
        forces(&mut contact, &scene.shaken(movement, 0.002));
        while contact.settle() {
            forces(&mut contact, &scene.shaken(movement, 0.002));
        }
        contact.commit();
    }
    let (error, scale) = tangent_error(&mut contact, &scene.shaken(*last, 0.002));
    assert!(scale > 1.0, "there is a stiffness to check: {scale}");
    assert!(error < 1e-6, "error {error:.2e} at {path:?}");
    contact
}

/// Returns whether the stiffness is symmetric to the last bit.
fn is_symmetric(contact: &mut Contact, displacements: &[f64]) -> bool {
    let stiffness = stiffness(contact, displacements);
    (0..displacements.len()).all(|i| (0..i).all(|j| stiffness[i][j] == stiffness[j][i]))
}

/// Flat, hollow and round masters. Facets of curved ones cut into the slave's: a gap at the start, which is subtracted.
fn scenes() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for kind in [Q4, Q8] {
        scenes.push(Scene::straight(kind));
        scenes.push(Scene::rows(kind, parabola, PlaneModel::PlaneStrain));
        scenes.push(Scene::rows(kind, |x| -parabola(x), PlaneModel::PlaneStress));
    }
    scenes
}

#[test]
fn stick_hardening_softening_and_unloading_of_uinter_and_fric() {
    for scene in scenes() {
        for law in [uinter(&[]), hard(1000.0, 0.1, &[])] {
            check(&scene, scene.pair(law.clone()), &[[0.012, -0.02]]);
            check(&scene, scene.pair(law.clone()), &[[0.1, -0.02]]);
            check(&scene, scene.pair(law.clone()), &[[-0.6, 0.01]]);
            check(&scene, scene.pair(law.clone()), &[[0.6, 0.01], [0.58, 0.02]]);
        }
    }
}

/// Blocks with k_e and ε_N alone are symmetric, unless normals are smoothed: over facets of a curve.
#[test]
fn blocks_are_symmetric_without_friction_on_smooth_masters() {
    for (kind, curve, symmetric) in [
        (Q4, (|_| 0.0) as fn(f64) -> f64, true),
        (Q8, |_| 0.0, true),
        (Q8, parabola, true),
        (Q4, parabola, false),
        (Q8, |x| 0.3 * x.cos(), false),
    ] {
        let scene = Scene::rows(kind, curve, PlaneModel::PlaneStrain);
        let end = [0.012, -0.02];
        let mut contact = check(&scene, scene.pair(uinter(&[])), &[end]);
        assert_eq!(is_symmetric(&mut contact, &scene.shaken(end, 0.002)), symmetric, "{kind}");
    }
}

#[test]
fn friction_under_pressure_is_unsymmetric() {
    for scene in scenes() {
        for law in [uinter(&[("law", 2.0), ("mu", 0.3)]), hard(0.0, 0.0, &[("law", 2.0), ("mu", 0.3)])] {
            let end = [0.4, -0.05];
            let mut slides = check(&scene, scene.pair(law.clone()), &[end]);
            assert!(!is_symmetric(&mut slides, &scene.shaken(end, 0.002)));
            let [slipping, open] = [PointStatus::Slipping, PointStatus::Open].map(|status| slides.count(status));
            assert!(slipping > 0 && slipping + open == 6, "{slipping} slip, {open} are open");
            let mut snubbing = check(&scene, scene.pair(uinter(&[("mu", 0.5)])), &[end]);
            assert!(!is_symmetric(&mut snubbing, &scene.shaken(end, 0.002)));
        }
    }
}

#[test]
fn law_b_and_the_soft_law() {
    for scene in scenes() {
        check(&scene, scene.pair(uinter(&[("law", 1.0), ("mu", 0.3)])), &[[0.1, -0.05], [0.3, -0.04]]);
        for law in [soft(&[("mu", 0.4)]), uinter(&[("normal_law", 1.0), ("p_0", 2.0), ("g_0", 0.1), ("mu", 0.4)])] {
            check(&scene, scene.pair(law.clone()), &[[0.1, -0.05]]);
            check(&scene, scene.pair(law.clone()), &[[0.4, 0.05]]);
            check(&scene, scene.pair(law), &[[0.4, -0.65]]);
        }
        // Inside the fade of the bond, 0.8 g_0 to g_0.
        let fading = uinter(&[("normal_law", 1.0), ("p_0", 2.0), ("g_0", 0.1)]);
        check(&scene, scene.pair(fading), &[[0.1, 0.09]]);
    }
}

#[test]
fn opening_under_the_cap_back_along_the_secant_and_closed_again() {
    for scene in scenes() {
        // ε_N is 200 MPa/mm: the cap of 4 MPa is passed at a gap of 0.02 mm, gone 0.2 mm later.
        let fading = || scene.pair(hard(4.0, 0.2, &[]));
        let opened = check(&scene, fading(), &[[0.01, 0.06], [0.01, 0.12]]);
        assert!(opened.points().all(|point| point.latched && point.pressure < 0.0));
        check(&scene, fading(), &[[0.01, 0.06], [0.01, 0.12], [0.01, 0.05]]);
        check(&scene, fading(), &[[0.01, 0.06], [0.01, 0.12], [0.01, -0.05]]);
        check(&scene, fading(), &[[0.01, 0.06], [0.01, 0.4], [0.01, -0.05]]);
        check(&scene, scene.pair(uinter(&[("p_0", 4.0), ("delta_N", 0.2)])), &[[0.01, 0.06], [0.01, 0.12]]);
    }
}

#[test]
fn an_open_point_does_nothing() {
    let scene = Scene::straight(Q8);
    let mut contact = scene.contact(scene.pair(hard(0.0, 0.0, &[("law", 2.0), ("mu", 0.3)])));
    let open = scene.moved(1, |_| [0.1, 0.3]);
    assert_eq!(largest(&forces(&mut contact, &open)), 0.0);
    assert!(stiffness(&mut contact, &open).iter().all(|row| largest(row) == 0.0));
    assert_eq!(contact.count(PointStatus::Open), 6);
}

#[test]
fn past_the_end_of_the_master_with_and_without_release() {
    for scene in scenes() {
        for law in [uinter(&[("mu", 0.3)]), hard(1000.0, 0.1, &[("mu", 0.3)])] {
            for slide in [1.3, -1.2] {
                for release in [false, true] {
                    let contact = check(&scene, ContactPair { release, ..scene.pair(law.clone()) }, &[[slide, -0.05]]);
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
            let scene = Scene::rows(kind, if kind == Q8 { parabola } else { |_| 0.0 }, model);
            for quadrature in [Gauss(3), Nodes, Segments(2)] {
                for width in [Width::OfPart, Width::Given(3.0)] {
                    let pair =
                        ContactPair { quadrature, width, penalty_factor: 3.0, ..scene.pair(uinter(&[("mu", 0.2)])) };
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
                ContactPair { enforcement: uzawa, ..scene.pair(law.clone()) },
                &[[0.01, -0.03], [0.3, -0.031]],
            );
            let penalty = contact.penalties().next().unwrap();
            let point = contact.points().next().unwrap();
            assert!(point.pressure + penalty * point.gap > 5.0, "the multiplier counts: {point:?}");
        }
        let condensed = Enforcement::PerturbedLagrangian { ratio: 1e4 };
        for law in [uinter(&[]), hard(1000.0, 0.1, &[])] {
            let pair = ContactPair { enforcement: condensed, penalty_factor: 0.01, ..scene.pair(law) };
            let contact = check(&scene, pair, &[[0.01, -0.03]]);
            let penalty = contact.penalties().next().unwrap();
            let point = contact.points().next().unwrap();
            assert!((point.pressure / (10_001.0 * penalty * -point.gap) - 1.0).abs() < 1e-12);
        }
    }
}

/// A slave edge of 1 mm over a master, turned about its middle: the gap that its points share stays what it was.
pub(super) fn turned(angle: f64, lift: f64) -> (Scene, Vec<f64>) {
    let row = |from, to, count| Row { kind: Q8, from, to, count };
    let scene = Scene::new(row(1.0, 5.0, 4), row(2.1, 3.1, 1), |_| 0.0, PlaneModel::PlaneStrain);
    let (sine, cosine) = angle.sin_cos();
    let displacements = scene.moved(1, |[x, y]| {
        let x = x - 2.6;
        [x * (cosine - 1.0) - y * sine, x * sine + y * (cosine - 1.0) + lift]
    });
    (scene, displacements)
}

#[test]
fn an_edge_that_turns_through_the_surface_is_held_by_its_deeper_point() {
    // the Gauss points are 1/√3 of half an edge from its middle
    let arm = 0.5 / 3.0_f64.sqrt();
    // without bond only the deeper point of a lifted edge is closed
    for (angle, lift, excess) in [(0.03, -0.01, 0.0), (0.2, -0.01, 1.0), (-0.2, -0.01, 1.0), (0.2, 0.01, 1.0)] {
        let (scene, displacements) = turned(angle, lift);
        let mut contact = scene.contact(scene.pair(uinter(&[("law", 2.0)])));
        let (error, _) = tangent_error(&mut contact, &displacements);
        // the spring has 10⁻³ of the largest entry
        assert!(error < 1e-9, "error {error:.2e} at {angle}, {lift}");
        let penalty = contact.penalties().next().expect("a pair");
        let own = -arm * angle.abs().sin() + lift;
        let expected = excess * 1e-3 * penalty * (lift.min(0.0) - own - 0.01);
        let pressures: Vec<f64> = contact.points().map(|point| point.pressure).collect();
        let [least, most] = [f64::min, f64::max].map(|of| pressures.iter().copied().reduce(of).expect("a point"));
        assert!((least - penalty * (-lift).max(0.0)).abs() < 1e-9 * penalty, "{pressures:?}");
        assert!((most - least - expected).abs() < 1e-12 * penalty, "{pressures:?} instead of {expected} more");
    }
}

#[test]
fn what_turns_an_edge_is_stored() {
    const STEPS: u32 = 400;
    let (scene, mut last) = turned(0.0, 0.0);
    let mut contact = scene.contact(scene.pair(uinter(&[("law", 2.0)])));
    let (mut pushed, mut work) = (forces(&mut contact, &last), 0.0);
    for step in 1..=STEPS {
        let (_, displacements) = turned(0.3 * f64::from(step) / f64::from(STEPS), 0.0);
        let now = forces(&mut contact, &displacements);
        work += (0..now.len()).map(|i| 0.5 * (pushed[i] + now[i]) * (displacements[i] - last[i])).sum::<f64>();
        contact.commit();
        (pushed, last) = (now, displacements);
    }
    let energies = contact.energies();
    assert!(energies.normal_stored > 0.0);
    assert!((energies.work / work - 1.0).abs() < 1e-4, "{energies:?} instead of {work}");
    assert!((energies.normal_stored / work - 1.0).abs() < 1e-4, "{energies:?} instead of {work}");
}

/// Also where laws are asked elsewhere than at their gaps.
#[test]
fn laws_that_are_followed_along_their_tangents() {
    for scene in scenes() {
        let law = uinter(&[("law", 2.0), ("p_0", 0.0), ("mu", 0.3)]);
        let mut contact = scene.contact(scene.pair(law));
        let start = scene.shaken([0.0, -0.02], 0.002);
        forces(&mut contact, &start);
        contact.commit();
        forces(&mut contact, &start);
        let end = scene.shaken([0.4, 0.03], 0.002);
        let change: Vec<f64> = end.iter().zip(&start).map(|(end, start)| end - start).collect();
        contact.predict_gaps(&change, true);
        let (error, scale) = tangent_error(&mut contact, &end);
        assert!(scale > 1.0 && contact.is_elsewhere());
        assert!(error < 1e-6, "error {error:.2e}");
    }
}

/// What the drive of an interference pushes is the derivative of the forces by it, and its work is the pressure's on the overlap.
#[test]
fn an_interference_pushes_by_its_drive() {
    const STEP: f64 = 1e-6;
    for scene in scenes() {
        let laws = [uinter(&[("law", 2.0), ("mu", 0.5)]), hard(0.0, 0.0, &[("law", 2.0), ("mu", 0.5)]), uinter(&[])];
        for law in laws {
            let interference = Some(Interference { drive: 1, depth: Some(0.02) });
            let fit = Fit { interference, ..Fit::default() };
            let mut contact = scene.contact(ContactPair { fit, ..scene.pair(law) });
            let displacements = scene.shaken([0.05, -0.01], 0.0005);
            let mut at = |drive: f64| {
                contact.set_drives(&[f64::NAN, drive]);
                forces(&mut contact, &displacements)
            };
            let [ahead, back] = [1.0 + STEP, 1.0 - STEP].map(&mut at);
            let difference: Vec<f64> = ahead.iter().zip(&back).map(|(a, b)| (b - a) / (2.0 * STEP)).collect();
            contact.set_drives(&[f64::NAN, 1.0]);
            stiffness(&mut contact, &displacements);
            let mut pushed = vec![0.0; displacements.len()];
            contact.add_drive_forces(&[f64::NAN, 1.0], &mut pushed);
            let error: Vec<f64> = pushed.iter().zip(&difference).map(|(a, b)| a - b).collect();
            assert!(largest(&pushed) > 1.0 && largest(&error) < 1e-6 * largest(&pushed), "{pushed:?} {difference:?}");
            let force: f64 = contact.points().map(|point| point.area * point.pressure).sum();
            assert!((contact.fitting_work() / (0.5 * 0.02 * force) - 1.0).abs() < 1e-12, "from nothing to all of it");
            contact.commit();
            assert_eq!(contact.fitting_work(), 0.0);
            contact.set_drives(&[f64::NAN, 7.0]);
            contact.restore();
            assert_eq!(contact.fitting_work(), 0.0, "an attempt that is given up leaves the drive where it was");
        }
    }
}

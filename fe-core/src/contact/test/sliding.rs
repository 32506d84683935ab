//! Points that travel: search, continuity, energies, measures of the slip.

use super::*;
use crate::assembly::Place;
use crate::element::ElementKind::{Q4, Q8};

#[test]
fn a_walk_finds_what_a_full_search_finds() {
    for kind in [Q4, Q8] {
        let scene = Scene::rows(kind, parabola, PlaneModel::PlaneStrain);
        let pair = scene.pair(uinter(&[("mu", 0.2)]));
        let mut contacts =
            [true, false].map(|walk| Contact::new(&scene.mesh, &[pair.clone()], &[86.0; 2], walk).unwrap());
        for step in 0..60 {
            let displacements = scene.shaken([0.05 * f64::from(step) - 0.5, -0.02], 0.01);
            let [walked, searched] = contacts.each_mut().map(|contact| {
                let forces = forces(contact, &displacements);
                contact.commit();
                forces
            });
            let difference: Vec<f64> = walked.iter().zip(&searched).map(|(a, b)| a - b).collect();
            assert!(largest(&difference) < 1e-9 * largest(&searched), "step {step}");
        }
    }
}

#[test]
fn searches_are_counted_only_where_they_happen() {
    let scene = Scene::straight(Q8);
    let mut forces = vec![0.0; scene.freedom_count()];
    for (walk, searches) in [(true, 0), (false, 6)] {
        let mut contact = Contact::new(&scene.mesh, &[scene.pair(uinter(&[]))], &[86.0; 2], walk).unwrap();
        let displacements = scene.moved(1, |_| [0.9, -0.01]);
        let (context, mut blocks) = (context(), Blocks::default());
        let request = Request::StressAndTangent;
        let evaluation = contact.evaluate(&displacements, &context, request, &mut forces, &mut blocks).unwrap();
        assert_eq!((evaluation.points, evaluation.searches, blocks.len()), (6, searches, 6));
    }
}

/// Halving the step halves the largest change of a nodal force: there is no jump where a point passes from one master
/// edge to the next, nor past the end.
#[test]
fn forces_are_continuous_over_many_edges() {
    for kind in [Q4, Q8] {
        for release in [false, true] {
            let scene = Scene::straight(kind);
            let largest_change = |steps: u32| {
                let pair = ContactPair {
                    release,
                    ..scene.pair(uinter(&[("k_e", 2.0), ("a_1", 100.0), ("law", 2.0), ("mu", 0.3)]))
                };
                let mut contact = scene.contact(pair);
                let (mut before, mut change): (Option<Vec<f64>>, f64) = (None, 0.0);
                for step in 0..=steps {
                    let slide = 0.1 + 3.2 * f64::from(step) / f64::from(steps);
                    let now = forces(&mut contact, &scene.moved(1, |[x, _]| [slide, -0.02 - 0.002 * x]));
                    contact.commit();
                    if let Some(before) = before {
                        let difference: Vec<f64> = now.iter().zip(&before).map(|(a, b)| a - b).collect();
                        change = change.max(largest(&difference));
                    }
                    before = Some(now);
                }
                change
            };
            let ratio = largest_change(400) / largest_change(800);
            assert!((1.9..2.1).contains(&ratio), "{kind}, release {release}: {ratio}");
        }
    }
}

/// Slip back and forth under changing pressure: dissipation never falls, and the books close.
#[test]
fn cycles_dissipate_and_energies_balance() {
    let laws = [
        uinter(&[("mu", 0.4)]),
        uinter(&[("law", 1.0), ("mu", 0.4)]),
        uinter(&[("law", 2.0), ("mu", 0.4)]),
        hard(1000.0, 0.1, &[("mu", 0.4)]),
        soft(&[("mu", 0.4)]),
    ];
    for law in laws {
        for release in [false, true] {
            let scene = Scene::rows(Q8, parabola, PlaneModel::PlaneStrain);
            let mut contact = scene.contact(ContactPair { release, ..scene.pair(law.clone()) });
            let (mut spent, mut amplitude) = (0.0, 0.0);
            // The datum: a soft law's pressure at no gap is stored, not worked for.
            forces(&mut contact, &vec![0.0; scene.freedom_count()]);
            contact.commit();
            let datum = contact.energies();
            for step in 0..4000 {
                let time = f64::from(step) / 4000.0;
                amplitude += 1.6 / 4000.0;
                let slide = amplitude * (30.0 * time).sin();
                forces(&mut contact, &scene.moved(1, |_| [slide, -0.02 - 0.015 * (11.0 * time).sin()]));
                contact.commit();
                let dissipated = contact.energies().plugin_dissipated;
                assert!(dissipated >= spent, "dissipation fell in step {step}");
                spent = dissipated;
            }
            let now = contact.energies();
            let stored = now.plugin_stored + now.normal_stored - datum.plugin_stored - datum.normal_stored;
            let balance = now.work - stored - now.plugin_dissipated - now.opening - now.released;
            assert!(spent > 0.0 && (balance / now.work).abs() < 2e-3, "{release} {balance} of {now:?}");
            assert_eq!(now.released != 0.0, release && contact.points().any(|point| point.weight < 1.0));
        }
    }
}

#[test]
fn the_gradient_of_the_mean_slip_is_its_derivative() {
    const STEP: f64 = 1e-6;
    let scene = Scene::rows(Q8, parabola, PlaneModel::PlaneStrain);
    let mut contact = scene.contact(scene.pair(uinter(&[])));
    forces(&mut contact, &scene.moved(1, |_| [0.1, 0.0]));
    assert!(contact.mean_slip() > 0.09, "the slave's slip counts positive in the direction it took");
    contact.commit();
    let displacements = scene.shaken([0.3, -0.02], 0.01);
    forces(&mut contact, &displacements);
    let mut gradient = vec![0.0; displacements.len()];
    contact.add_mean_slip_gradient(&mut gradient);
    for freedom in 0..displacements.len() {
        let mut slip = |side: f64| {
            let mut moved = displacements.clone();
            moved[freedom] += side * STEP;
            forces(&mut contact, &moved);
            contact.mean_slip()
        };
        let difference = (slip(1.0) - slip(-1.0)) / (2.0 * STEP);
        assert!((difference - gradient[freedom]).abs() < 1e-8);
        assert!(gradient[freedom] == 0.0 || contact.freedoms().contains(&freedom));
    }
}

#[test]
fn slip_growth_is_measured_against_the_history() {
    let scene = Scene::straight(Q4);
    let mut contact = scene.contact(ContactPair { critical_slip: 0.02, ..scene.pair(uinter(&[])) });
    forces(&mut contact, &scene.moved(1, |_| [0.01, 0.0]));
    let growth = contact.largest_slip_growth().unwrap();
    assert!((growth.growth - 0.01).abs() < 1e-14 && (growth.ratio - 0.5).abs() < 1e-12);
    forces(&mut contact, &scene.moved(1, |_| [0.4, 0.0]));
    contact.commit();
    forces(&mut contact, &scene.moved(1, |_| [0.7, 0.0]));
    assert!((contact.largest_slip_growth().unwrap().ratio - 1.5).abs() < 1e-12, "0.3 against half of 0.4");
}

#[test]
fn an_attempt_given_up_leaves_no_trace() {
    let scene = Scene::straight(Q8);
    let mut contact = scene.contact(scene.pair(uinter(&[("mu", 0.3)])));
    let first = scene.moved(1, |_| [0.3, -0.01]);
    forces(&mut contact, &first);
    contact.commit();
    let reference = forces(&mut contact, &first);
    forces(&mut contact, &scene.moved(1, |_| [-0.8, -0.05]));
    contact.restore();
    assert_eq!(forces(&mut contact, &first), reference);
}

#[test]
fn displacements_that_are_none_are_trouble_with_a_place() {
    let scene = Scene::straight(Q8);
    let mut contact = scene.contact(scene.pair(uinter(&[])));
    let displacements = scene.moved(0, |_| [f64::NAN, 0.0]);
    let mut forces = vec![0.0; displacements.len()];
    let trouble =
        contact.evaluate(&displacements, &context(), Request::Stress, &mut forces, &mut Blocks::default()).unwrap_err();
    assert!(matches!(&trouble.place, Place::Contact { pair, point: 0, .. } if pair == "fibre"), "{trouble}");
    assert_eq!(trouble.fraction, Some(0.5));
}

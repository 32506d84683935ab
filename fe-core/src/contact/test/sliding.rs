//! Points that travel: search, continuity, energies, measures of the slip.

use super::*;
use crate::assembly::Location;
use crate::contact::PointIndex;
use crate::contact::chain::Foot;
use crate::contact::history::PointState;
use crate::contact::law::PointLaw;
use crate::element::ElementKind::{Q4, Q8};
use umat_abi::host::recorder::RecordedArguments;

#[test]
fn a_walk_finds_what_a_full_search_finds() {
    for kind in [Q4, Q8] {
        let scene = Scene::rows(kind, parabola, PlaneModel::PlaneStrain);
        let pair = scene.pair(uinter(&[("mu", 0.2)]));
        let mut contacts = [true, false].map(|walk| {
            Contact::new(&scene.mesh, std::slice::from_ref(&pair), &[86.0; 2], walk, &FieldValues::default()).unwrap()
        });
        for step in 0..60 {
            // noise so small that a point below a kink, between two edges, has one foot and not two
            let displacements = scene.shaken([0.05 * f64::from(step) - 0.5, -0.02], 0.002);
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

/// Slips are the same to the last bit, since a law may compare a slip with the largest so far.
#[test]
fn a_committed_state_that_is_evaluated_again_has_the_same_slips() {
    for kind in [Q4, Q8] {
        let scene = Scene::rows(kind, parabola, PlaneModel::PlaneStrain);
        let mut contact = scene.contact(scene.pair(uinter(&[("mu", 0.2)])));
        for step in 1..40 {
            let displacements = scene.shaken([0.013 * f64::from(step), -0.02], 0.01);
            forces(&mut contact, &displacements);
            contact.commit();
            let slips: Vec<f64> = contact.points().map(|point| point.slip).collect();
            forces(&mut contact, &displacements);
            assert!(contact.points().map(|point| point.slip).eq(slips), "{kind}, step {step}");
        }
    }
}

#[test]
fn searches_are_counted_only_where_they_happen() {
    let scene = Scene::straight(Q8);
    let mut forces = vec![0.0; scene.freedom_count()];
    for (walk, searches) in [(true, 0), (false, 6)] {
        let mut contact =
            Contact::new(&scene.mesh, &[scene.pair(uinter(&[]))], &[86.0; 2], walk, &FieldValues::default()).unwrap();
        let displacements = scene.moved(1, |_| [0.9, -0.01]);
        let (context, mut blocks) = (context(), Blocks::default());
        let request = Request::StressAndTangent;
        let evaluation = contact.evaluate(&displacements, &context, request, &mut forces, &mut blocks).unwrap();
        assert_eq!((evaluation.points, evaluation.searches, blocks.len()), (6, searches, 3));
    }
}

/// Halving the step halves the largest change of a nodal force: there is no jump where a point passes from one master
/// edge to the next, nor past the end. The exception is the couple τ A g_N/l of the shear, which acts at the slave's
/// side of the gap and is handed from one edge to the next; so the penetration is kept small.
#[test]
fn forces_are_continuous_over_many_edges() {
    for kind in [Q4, Q8] {
        for release in [false, true] {
            let scene = Scene::straight(kind);
            let largest_change = |steps: u32| {
                let law = uinter(&[("law", 2.0), ("mu", 0.3), ("k_f", 20.0)]);
                let pair = ContactPair { release, penalty_factor: 1e6, ..scene.pair(law) };
                let mut contact = scene.contact(pair);
                let (mut before, mut change): (Option<Vec<f64>>, f64) = (None, 0.0);
                for step in 0..=steps {
                    let slide = 0.1 + 3.2 * f64::from(step) / f64::from(steps);
                    let now = forces(&mut contact, &scene.moved(1, |[x, _]| [slide, -2e-6 - 2e-7 * x]));
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

/// Over the facets of a curve normals are smoothed: the direction of the pressure does not jump at their nodes.
#[test]
fn forces_are_continuous_over_facets() {
    for (kind, curve) in [(Q4, parabola as fn(f64) -> f64), (Q4, |x| -parabola(x)), (Q8, |x| 0.3 * x.cos())] {
        let scene = Scene::rows(kind, curve, PlaneModel::PlaneStrain);
        let largest_change = |steps: u32| {
            let mut contact = scene.contact(scene.pair(uinter(&[("law", 2.0), ("mu", 0.0)])));
            let (mut before, mut change): (Option<Vec<f64>>, f64) = (None, 0.0);
            for step in 0..=steps {
                let slide = 0.8 * f64::from(step) / f64::from(steps);
                let now = forces(&mut contact, &scene.moved(1, |_| [slide, -0.1]));
                contact.commit();
                if let Some(before) = before {
                    let difference: Vec<f64> = now.iter().zip(&before).map(|(a, b)| a - b).collect();
                    change = change.max(largest(&difference));
                }
                before = Some(now);
            }
            change
        };
        let ratio = largest_change(2000) / largest_change(16000);
        // eight times, except for how far past a node a point is when it starts on the next edge
        assert!((6.0..10.0).contains(&ratio), "{kind}: {ratio}");
    }
}

/// The two edges of a smoothed node are not stretched alike: τ A ∂s jumps where a point passes it, and a point held back on
/// one side and pushed on from the other would have no equilibrium.
#[test]
fn forces_do_not_jump_within_an_increment_where_a_point_passes_a_smoothed_node() {
    let scene = Scene::rows(Q8, parabola, PlaneModel::PlaneStrain);
    let stretched = |slide: f64| {
        let mut displacements = scene.moved(1, |_| [slide, -0.02]);
        // one edge is stretched, the next compressed
        let master = scene.moved(0, |[x, _]| [0.02 * (x - 2.0 * (0.5 * x).round()).abs(), 0.0]);
        displacements.iter_mut().zip(&master).for_each(|(u, v)| *u += v);
        displacements
    };
    let feet =
        |contact: &Contact| -> Vec<_> { contact.pairs[0].state.trial.points.iter().map(|state| state.foot).collect() };
    let law = uinter(&[("law", 2.0), ("mu", 0.3), ("k_f", 20.0)]);
    let mut contact = scene.contact(ContactPair { master_bends: true, ..scene.pair(law) });
    let mut passed = 0;
    for step in 0..200 {
        let start = 0.005 * f64::from(step);
        forces(&mut contact, &stretched(start));
        contact.commit();
        let home = feet(&contact);
        let Some(point) = (0..home.len()).find(|&point| (0.98..1.0).contains(&home[point].coordinate.abs())) else {
            continue;
        };
        let mut past = |slide: f64| {
            let forces = forces(&mut contact, &stretched(slide));
            let foot = feet(&contact)[point];
            (foot, forces)
        };
        let side = home[point].coordinate.signum();
        let beyond = |foot: Foot| foot.edge != home[point].edge || foot.coordinate * side > 1.0;
        let Some(away) = [-0.02, 0.02].into_iter().find(|away| beyond(past(start + away).0)) else { continue };
        let (mut inside, mut outside) = (start, start + away);
        for _ in 0..60 {
            let middle = 0.5 * (inside + outside);
            *(if beyond(past(middle).0) { &mut outside } else { &mut inside }) = middle;
        }
        let small = 1e-6 * away;
        let ((_, before), (foot, after)) = (past(inside - small), past(outside + small));
        assert_eq!(foot.edge, home[point].edge);
        assert!(foot.coordinate * side > 1.0 && foot.coordinate * side < 1.001);
        let within = largest(&after.iter().zip(&before).map(|(a, b)| a - b).collect::<Vec<f64>>());
        let slip = contact.pairs[0].state.trial.points[point].slip;
        contact.commit();
        let next = forces(&mut contact, &stretched(outside + small));
        let jump = largest(&next.iter().zip(&after).map(|(a, b)| a - b).collect::<Vec<f64>>());
        let state = &contact.pairs[0].state.trial.points[point];
        assert_ne!(state.foot.edge, home[point].edge, "the next increment starts on the next edge");
        assert!((state.slip - slip).abs() < 1e-6);
        assert!(jump > 5.0 * within, "step {step}: {jump:e} against {within:e}");
        passed += 1;
    }
    assert!(passed > 0);
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
            let scene = Scene::rows(if release { Q4 } else { Q8 }, parabola, PlaneModel::PlaneStrain);
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

/// A point under a given force leaves the master: what it stored is released, the force on the slider's way dissipated.
#[test]
fn a_point_that_fades_under_a_force_releases_no_more_than_there_is() {
    let (force, stiffness, slide) = (3.0, 100.0, 10.0);
    let at = |weight: f64, slip: f64| {
        let shear = force / weight;
        let mut state = PointState { weight, slip, shear, ..PointState::default() };
        state.plugin_energies[0] = 0.5 * shear * shear / stiffness;
        state
    };
    let dissipated = |start: &PointState, end: &mut PointState| {
        end.book(start, 1.0);
        let stored = |state: &PointState| state.weight * state.stored();
        end.work - (stored(end) - stored(start)) - end.released
    };
    for left in [0.4, 0.01, 0.004] {
        let (start, mut end) = (at(0.5, 0.0), at(left, slide));
        let elastic = force / stiffness * (1.0 / left - 1.0 / 0.5);
        assert!((dissipated(&start, &mut end) - force * (slide - elastic)).abs() < 1e-9, "{left}: {end:?}");
        assert!(end.released > 0.0);
    }
    // past the end nothing is left: all that was stored is released, and no more
    let (start, mut end) = (at(0.5, 0.0), PointState { weight: 0.0, shear: 0.0, slip: slide, ..at(0.5, 0.0) });
    assert!((dissipated(&start, &mut end) - 0.5 * force * slide).abs() < 1e-9);
    assert!((end.released - 0.5 * start.stored()).abs() < 1e-12);
}

#[test]
fn a_slip_along_a_change_is_its_derivative() {
    const STEP: f64 = 1e-6;
    let scene = Scene::rows(Q8, parabola, PlaneModel::PlaneStrain);
    let mut contact = scene.contact(scene.pair(uinter(&[])));
    forces(&mut contact, &scene.moved(1, |_| [0.1, 0.0]));
    assert!(contact.mean_slip() > 0.09, "the slave's slip counts positive in the direction it took");
    contact.commit();
    let displacements = scene.shaken([0.3, -0.02], 0.01);
    forces(&mut contact, &displacements);
    let point = PointIndex { pair: 0, point: 1 };
    let along = |contact: &Contact, freedom: usize| {
        let mut change = vec![0.0; displacements.len()];
        change[freedom] = 1.0;
        contact.slip_along(point, &change)
    };
    let gradient: Vec<f64> = (0..displacements.len()).map(|freedom| along(&contact, freedom)).collect();
    for freedom in 0..displacements.len() {
        let mut slip = |side: f64| {
            let mut moved = displacements.clone();
            moved[freedom] += side * STEP;
            forces(&mut contact, &moved);
            contact.slip_of(point)
        };
        let difference = (slip(1.0) - slip(-1.0)) / (2.0 * STEP);
        assert!((difference - gradient[freedom]).abs() < 1e-8);
        assert!(gradient[freedom] == 0.0 || contact.freedoms().contains(&freedom));
    }
    let fastest = contact.fastest_point(&gradient).unwrap();
    let others = contact.points().count();
    for index in 0..others {
        let other = PointIndex { pair: 0, point: index };
        assert!(contact.slip_along(other, &gradient).abs() <= contact.slip_along(fastest, &gradient).abs());
    }
}

#[test]
fn slip_growth_is_measured_against_the_history() {
    let scene = Scene::straight(Q4);
    let mut contact = scene.contact(ContactPair { critical_slip: 0.02, ..scene.pair(uinter(&[])) });
    forces(&mut contact, &scene.moved(1, |_| [0.01, 0.0]));
    assert!((contact.points().next().unwrap().slip.abs() - 0.01).abs() < 1e-14);
    assert!((contact.largest_slip_growth() - 0.5).abs() < 1e-12);
    forces(&mut contact, &scene.moved(1, |_| [0.4, 0.0]));
    contact.commit();
    forces(&mut contact, &scene.moved(1, |_| [0.7, 0.0]));
    assert!((contact.largest_slip_growth() - 1.5).abs() < 1e-12, "0.3 against half of 0.4");
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
    assert!(matches!(&trouble.place, Location::Contact { pair, point: 0, .. } if pair == "fibre"), "{trouble}");
    assert_eq!(trouble.fraction, Some(0.5));
}

#[test]
fn slip_towards_the_masters_start_counts_as_well() {
    let scene = Scene::straight(Q4);
    for direction in [1.0, -1.0] {
        let mut contact = scene.contact(scene.pair(uinter(&[])));
        for slide in [0.1, 0.2] {
            forces(&mut contact, &scene.moved(1, |_| [direction * slide, 0.0]));
            assert!((contact.mean_slip() - slide).abs() < 1e-13);
            contact.commit();
        }
    }
}

/// A block that goes round a disc twice: the arc length goes on growing, the gap comes back.
#[test]
fn a_closed_master_is_gone_round_and_round() {
    let half = 0.5_f64.sqrt();
    let mesh = Mesh::new(MeshDefinition {
        nodes: vec![
            [-half, -half],
            [half, -half],
            [half, half],
            [-half, half],
            [0.0, -1.0],
            [1.0, 0.0],
            [0.0, 1.0],
            [-1.0, 0.0],
            [-0.1, 1.05],
            [0.1, 1.05],
            [0.1, 1.2],
            [-0.1, 1.2],
        ],
        parts: vec![Part::new("disc", PlaneModel::PlaneStrain, 1.0), Part::new("block", PlaneModel::PlaneStrain, 1.0)],
        elements: vec![
            ElementDefinition { kind: Q8, part: 0, nodes: (0..8).collect() },
            ElementDefinition { kind: Q4, part: 1, nodes: (8..12).collect() },
        ],
        ..MeshDefinition::default()
    })
    .unwrap();
    let master: Vec<_> = (0..4).map(|edge| ElementEdge { element: 0, edge }).collect();
    let slave = vec![ElementEdge { element: 1, edge: 0 }];
    let scene = Scene { mesh, master, slave };
    let law = uinter(&[("law", 2.0), ("mu", 0.3)]);
    for walk in [true, false] {
        let mut contact =
            Contact::new(&scene.mesh, &[scene.pair(law.clone())], &[86.0; 2], walk, &FieldValues::default()).unwrap();
        let mut turned = |angle: f64| {
            let (sine, cosine) = angle.sin_cos();
            let turn = |[x, y]: [f64; 2]| [cosine * x - sine * y - x, sine * x + cosine * y - y];
            forces(&mut contact, &scene.moved(1, turn));
            contact.commit();
            contact.points().map(|point| (point.gap, point.slip)).collect::<Vec<_>>()
        };
        let start = turned(0.0);
        let mut last = start.clone();
        // The edges run counter-clockwise; their length is that of four parabolas on the circle.
        let mut length = None;
        for step in 1..=80 {
            last = turned(std::f64::consts::TAU * f64::from(step) / 40.0);
            length = if step == 40 { Some(last[0].1 - start[0].1) } else { length };
        }
        let length = length.unwrap();
        assert!((length / std::f64::consts::TAU - 1.0).abs() < 0.01, "{length}");
        for (now, before) in last.iter().zip(&start) {
            assert!((now.0 - before.0).abs() < 1e-12 && (now.1 - before.1 - 2.0 * length).abs() < 1e-12);
        }
    }
}

#[test]
fn a_plugin_that_asks_for_less_is_trouble_with_its_fraction() {
    let scene = Scene::straight(Q4);
    let mut contact = scene.contact(scene.pair(uinter(&[])));
    // The pressure overflows, the plugin refuses.
    let displacements = scene.moved(1, |_| [0.0, -1e307]);
    let mut forces = vec![0.0; displacements.len()];
    let trouble =
        contact.evaluate(&displacements, &context(), Request::Stress, &mut forces, &mut Blocks::default()).unwrap_err();
    assert!(trouble.reason.contains("PNEWDT"), "{trouble}");
    assert_eq!(trouble.fraction, Some(0.5));
    contact.restore();
    let back = vec![0.0; displacements.len()];
    contact.evaluate(&back, &context(), Request::Stress, &mut forces, &mut Blocks::default()).unwrap();
}

/// Checks the arguments of the last point's plugin.
#[test]
fn uinter_and_fric_get_their_arguments() {
    let scene = Scene::straight(Q4);
    let context =
        IncrementContext { step: 2, increment: 3, iteration: 4, step_time: 0.5, total_time: 1.5, time_increment: 0.25 };
    for law in [uinter(&[]), hard(1000.0, 0.1, &[])] {
        let mut contact = scene.contact(scene.pair(law));
        let go = |contact: &mut Contact, movement: [f64; 2]| {
            let displacements = scene.moved(1, |_| movement);
            let (mut forces, mut blocks) = (vec![0.0; displacements.len()], Blocks::default());
            contact.evaluate(&displacements, &context, Request::Stress, &mut forces, &mut blocks).unwrap();
        };
        go(&mut contact, [0.3, -0.01]);
        contact.commit();
        go(&mut contact, [0.4, -0.03]);
        let close = |found: &[f64], wanted: &[f64]| {
            assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} for {wanted:?}");
        };
        // The last of six points: the second Gauss point of the third of three edges on 1.5 … 4.1.
        let edge = 2.6 / 3.0;
        let x = 4.1 - 0.5 * edge * (1.0 - 1.0 / 3.0_f64.sqrt()) + 0.4;
        let penalty = contact.pairs[0].penalty;
        match &contact.pairs[0].law {
            PointLaw::Uinter { call, .. } => {
                // The master runs towards −x.
                close(&call.rdisp, &[0.03, -0.4, 0.0]);
                close(&call.drdisp, &[0.02, -0.1, 0.0]);
                close(&call.time, &[0.75, 1.75]);
                close(&call.coords, &[x, -0.03, 0.0]);
                close(&call.local_directions, &[0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
                close(&[call.dtime, call.area, call.chrlngth], &[0.25, 0.5 * edge * 30.0, edge]);
                assert_eq!((call.counters, call.node), ([2, 3, 4], 6));
            }
            PointLaw::Fric { call, .. } => {
                close(&call.dgam, &[-0.1, 0.0]);
                close(&call.pressure, &[0.03 * penalty, 0.02 * penalty]);
                close(&call.time, &[0.75, 1.75]);
                close(&call.coords, &[x, -0.03, 0.0]);
                close(&call.rcoord, &[x, 0.0, 0.0]);
                close(&[call.dtime, call.chrlngth], &[0.25, edge]);
                close(&call.slip[..1], &[contact.pairs[0].state.committed.points[5].inelastic_slip]);
                assert!(call.slip[0] < -0.1, "softening: most of the slip of 0.3 was inelastic");
                assert_eq!((call.counters, call.node), ([2, 3], 6));
            }
        }
    }
}

#[test]
fn the_last_call_of_a_law_describes_the_increment_of_its_point_only() {
    let scene = Scene::straight(Q4);
    for law in [uinter(&[]), hard(2.0, 0.1, &[])] {
        let is_uinter = matches!(law, ContactLaw::Uinter(_));
        let mut contact = scene.contact(scene.pair(law));
        let count = contact.points().count();
        // setting up may ask the law
        let before = contact.law_calls();
        forces(&mut contact, &scene.moved(1, |_| [0.01, -0.001]));
        contact.commit();
        let start = contact.points().last().map(|point| (point.slip, point.gap, point.statev.to_vec())).unwrap();
        forces(&mut contact, &scene.moved(1, |_| [0.03, -0.002]));
        let last = contact.points().last().unwrap();
        let (pair, point, end) = (last.pair.to_owned(), last.point, (last.slip, last.gap, last.pressure));
        assert!(contact.last_call(&pair, point - 1).is_none() && contact.last_call("other", point).is_none());
        assert_eq!(contact.law_calls() - before, 2 * count as u64);
        contact.restore();
        let call = contact.last_call(&pair, point).expect("it was the last");
        approx::assert_abs_diff_eq!((end.0 - start.0).abs(), 0.02, epsilon = 1e-12);
        let close = |given: f64, expected: f64| approx::assert_abs_diff_eq!(given, expected, epsilon = 1e-12);
        match call {
            RecordedArguments::Uinter(call) => {
                assert!(is_uinter);
                assert_eq!(call.statev, start.2);
                close(call.rdisp[1] - call.drdisp[1], start.0);
                close(call.rdisp[1], end.0);
                // RDISP(1) > 0 is penetration
                close(call.drdisp[0] - call.rdisp[0], start.1);
                close(-call.rdisp[0], end.1);
            }
            RecordedArguments::Fric(call) => {
                assert_eq!((&call.statev, call.pressure[0]), (&start.2, end.2));
                close(call.dgam[0], end.0 - start.0);
                assert!(!is_uinter);
            }
            other => panic!("{other:?}"),
        }
    }
}

/// A block on a slope that is displaced along a tangent: gaps change by the square of it, and with them pressures by many times
/// what they are. Laws are asked where the tangent leads, and followed from there.
#[test]
fn no_point_opens_because_the_surfaces_turn_under_a_correction() {
    let law = || uinter(&[("law", 2.0), ("p_0", 0.0), ("mu", 0.3)]);
    for kind in [Q4, Q8] {
        let scene = Scene::rows(kind, |x| -parabola(x), PlaneModel::PlaneStrain);
        let mut contact = scene.contact(scene.pair(law()));
        let start = scene.moved(1, |_| [0.0, -1e-3]);
        forces(&mut contact, &start);
        contact.commit();
        forces(&mut contact, &start);
        let before: Vec<[f64; 2]> = contact.points().map(|point| [point.pressure, point.gap]).collect();
        let end: Vec<f64> = start.iter().zip(scene.moved(1, |_| [0.0, 2e-2])).map(|(a, b)| a + b).collect();
        let change: Vec<f64> = end.iter().zip(&start).map(|(end, start)| end - start).collect();

        // where the increment starts: closed, and pulled back by what has opened
        contact.predict_gaps(&change, true);
        forces(&mut contact, &end);
        assert!(contact.is_elsewhere());
        assert_eq!(contact.count(PointStatus::Open), 0, "{kind}");
        for (point, [pressure, gap]) in contact.points().zip(&before) {
            assert!(point.gap > 0.0);
            approx::assert_relative_eq!(point.pressure / pressure, point.gap / gap, max_relative = 1e-9);
        }

        // the tangent predicts the actual state: open
        forces(&mut contact, &start);
        contact.predict_gaps(&change, false);
        forces(&mut contact, &end);
        assert_eq!(contact.count(PointStatus::Open), contact.points().count(), "{kind}");

        contact.end_prediction();
        forces(&mut contact, &end);
        assert!(!contact.is_elsewhere());
        assert!(contact.points().all(|point| point.pressure == 0.0));
    }
}

/// A patch that closes within one iteration is evaluated at a pressure no greater than those of before: friction does not hold
/// on to a penetration that the next iteration takes back.
#[test]
fn a_point_that_closes_slides() {
    for kind in [Q4, Q8] {
        let scene = Scene::straight(kind);
        let law = uinter(&[("law", 2.0), ("p_0", 0.0), ("mu", 0.3), ("k_f", 20.0)]);
        let mut contact = scene.contact(scene.pair(law));
        // pressed at one end only
        let tilted = scene.moved(1, |[x, _]| [0.0, -1e-3 + 2e-3 * (x - 1.5)]);
        forces(&mut contact, &tilted);
        contact.commit();
        forces(&mut contact, &tilted);
        let greatest = contact.points().map(|point| point.pressure).fold(0.0, f64::max);
        assert!(contact.count(PointStatus::Open) > 0 && greatest > 0.0, "{kind}");
        let change = scene.moved(1, |_| [1e-2, -0.5]);
        let end: Vec<f64> = tilted.iter().zip(&change).map(|(a, b)| a + b).collect();
        let was_open: Vec<bool> = contact.points().map(|point| point.status == PointStatus::Open).collect();
        let statuses = |contact: &mut Contact| {
            forces(contact, &end);
            let points = contact.points().zip(&was_open).filter(|(_, was_open)| **was_open);
            points.map(|(point, _)| point.status).collect::<Vec<_>>()
        };
        assert!(statuses(&mut contact).iter().all(|status| *status == PointStatus::Sticking), "{kind}");
        forces(&mut contact, &tilted);
        contact.predict_gaps(&change, false);
        assert!(statuses(&mut contact).iter().all(|status| *status == PointStatus::Slipping), "{kind}");
        // pressure and shear are those of the whole penetration: on the law's tangent
        for point in contact.points().zip(&was_open).filter(|(_, was_open)| **was_open).map(|(point, _)| point) {
            approx::assert_relative_eq!(point.shear.abs(), 0.3 * point.pressure, max_relative = 1e-9);
        }
    }
}

/// Matter that was never on the master has no bond with it, whatever its law would give a virgin point: it presses and rubs.
#[test]
fn what_starts_beyond_an_end_has_no_bond() {
    let row = |from: f64| Row { kind: Q4, from, to: from + 2.6, count: 3 };
    let master = Row { kind: Q4, from: 1.0, to: 5.0, count: 4 };
    for law in [uinter(&[]), hard(1000.0, 0.1, &[])] {
        let tractions = |from: f64, depth: f64| {
            let scene = Scene::new(master, row(from), |_| 0.0, PlaneModel::PlaneStrain);
            let mut contact = scene.contact(ContactPair { release: true, ..scene.pair(law.clone()) });
            let way = 1.5 - from;
            for step in 1..=80 {
                forces(&mut contact, &scene.moved(1, |_| [way * f64::from(step) / 80.0, 0.0]));
                contact.commit();
            }
            forces(&mut contact, &scene.moved(1, |_| [way, -depth]));
            assert!(contact.points().all(|point| point.weight == 1.0));
            let points: Vec<[f64; 2]> = contact.points().map(|point| [point.pressure, point.shear]).collect();
            (points, contact.penalties().next().unwrap())
        };
        // on the master from the start: the bond carries tension
        assert!(tractions(1.6, -1e-3).0.iter().all(|[pressure, _]| *pressure < 0.0));
        for start in [6.0, -3.0] {
            assert!(tractions(start, -1e-3).0.iter().all(|[pressure, _]| *pressure == 0.0), "{start}");
            let (pressed, penalty) = tractions(start, 1e-3);
            for [pressure, _] in &pressed {
                assert!((pressure / (1e-3 * penalty) - 1.0).abs() < 1e-9, "{start}: {pressure}");
            }
            // FRIC does not learn that its bond is gone: it has the bond of its slip
            if matches!(law, ContactLaw::Uinter(_)) {
                let shears = || pressed.iter().map(|[_, shear]| shear.abs());
                assert!(
                    shears().all(|shear| shear < 0.1 * (1.0 + 1e-9)) && shears().any(|shear| shear > 0.0),
                    "{start}"
                );
            }
        }
    }
}

/// An iteration may bring a point back over the end that it has passed: it is past the end all the same, neither open nor part of the
/// open length.
#[test]
fn what_only_an_iteration_brings_back_is_past_the_end() {
    let scene = Scene::straight(Q4);
    let mut contact = scene.contact(ContactPair { release: true, ..scene.pair(uinter(&[("mu", 0.3)])) });
    let slid = |slide: f64| scene.moved(1, move |_| [slide, 1e-3]);
    let beyond = |contact: &Contact| contact.points().filter(|point| point.weight == 0.0).count();
    let way = (1..60).map(|step| 0.1 * f64::from(step));
    let mut seen = 0;
    for slide in way {
        forces(&mut contact, &slid(slide));
        contact.commit();
        let gone = beyond(&contact);
        // an attempt goes back by two elements, and is given up for one that stays
        forces(&mut contact, &slid((slide - 2.0).max(0.0)));
        forces(&mut contact, &slid(slide));
        assert_eq!(contact.count(PointStatus::Released), gone, "at {slide}");
        let open: f64 =
            contact.points().filter(|point| point.status == PointStatus::Open).map(|point| point.area).sum();
        assert!((contact.open_length(&[0]) - open).abs() < 1e-12, "at {slide}");
        seen = seen.max(gone);
    }
    assert!(seen > 2);
}

/// The surface of torn matter does not come back.
#[test]
fn points_on_matter_that_is_gone_stay_out() {
    let scene = Scene::straight(Q4);
    let mut contact = scene.contact(ContactPair { release: true, ..scene.pair(uinter(&[("mu", 0.3)])) });
    let point = contact.pairs[0].points[0].area;
    contact.pairs[0].state.committed.points[0].release(point);
    contact.restore();
    for slide in [0.0, 5.0, 0.0] {
        forces(&mut contact, &scene.moved(1, |_| [slide, -0.01]));
        contact.commit();
    }
    let out: Vec<bool> = contact.points().map(|point| point.weight == 0.0).collect();
    assert!(out[0] && !out[1..].contains(&true), "{out:?}");
}

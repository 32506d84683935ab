//! Initial gaps, penalties by role, openings one by one, multipliers.

use super::*;
use crate::element::ElementKind::{Q4, Q8};

/// A slave that starts `gap` above the master.
fn above(gap: f64) -> Scene {
    let mut scene = Scene::straight(Q8);
    let mut definition = MeshDefinition {
        nodes: scene.mesh.nodes().to_vec(),
        parts: scene.mesh.parts().to_vec(),
        ..MeshDefinition::default()
    };
    let mut lifted = vec![false; definition.nodes.len()];
    for element in scene.mesh.elements() {
        let nodes = element.nodes().to_vec();
        if element.part() == 1 {
            nodes.iter().for_each(|&node| lifted[node] = true);
        }
        definition.elements.push(ElementDefinition { kind: element.kind(), part: element.part(), nodes });
    }
    for (node, lifted) in definition.nodes.iter_mut().zip(lifted) {
        node[1] += if lifted { gap } else { 0.0 };
    }
    scene.mesh = Mesh::new(definition).unwrap();
    scene
}

#[test]
fn small_initial_gaps_are_subtracted_and_large_ones_only_open_what_carries_nothing() {
    let unbonded = [("law", 2.0), ("mu", 0.3)];
    // The width is 30 mm, which is no size of the mesh.
    for gap in [1e-6, -1e-6] {
        let scene = above(gap);
        let mut contact = scene.contact(scene.pair(uinter(&[])));
        let none = vec![0.0; scene.freedom_count()];
        assert!(largest(&forces(&mut contact, &none)) < 1e-10);
    }
    for law in [uinter(&[]), hard(5.0, 0.0, &unbonded), uinter(&[("normal_law", 1.0), ("p_0", 2.0), ("g_0", 0.05)])] {
        let scene = above(0.1);
        let error =
            Contact::new(&scene.mesh, &[scene.pair(law)], &[86.0; 2], true, &FieldValues::default()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "contact 'fibre', point 1 at (1.683148, 0.100000): its gap is 1.000e-1 mm at the start, up to ±1.686e-6 is taken \
             as a fault of the mesh; more may only open a pair that carries neither tension nor bond"
        );
    }
    for law in [uinter(&unbonded), hard(0.0, 0.0, &unbonded)] {
        let scene = above(0.1);
        let mut contact = scene.contact(scene.pair(law.clone()));
        assert_eq!(largest(&forces(&mut contact, &scene.moved(1, |_| [0.0, -0.09]))), 0.0);
        assert_eq!(contact.count(PointStatus::Open), 6);
        assert!(largest(&forces(&mut contact, &scene.moved(1, |_| [0.0, -0.11]))) > 0.0, "the whole gap closes");
        let scene = above(-0.1);
        assert!(Contact::new(&scene.mesh, &[scene.pair(law)], &[86.0; 2], true, &FieldValues::default()).is_err());
    }
}

/// Straight surfaces keep the smallest gap, whatever the contact width; an overlap of them is refused.
#[test]
fn straight_surfaces_keep_their_gaps() {
    let free = hard(0.0, 0.0, &[("law", 2.0), ("mu", 0.3)]);
    for width in [Width::Given(1000.0), Width::OfPart] {
        let pair = |scene: &Scene| ContactPair { width, ..scene.pair(free.clone()) };
        let scene = above(5e-4);
        let mut contact = scene.contact(pair(&scene));
        assert_eq!(largest(&forces(&mut contact, &scene.moved(1, |_| [0.0, -4e-4]))), 0.0);
        assert!(largest(&forces(&mut contact, &scene.moved(1, |_| [0.0, -6e-4]))) > 0.0);
        let scene = above(-5e-4);
        let refused = Contact::new(&scene.mesh, &[pair(&scene)], &[86.0; 2], true, &FieldValues::default());
        assert!(refused.unwrap_err().to_string().contains("its gap is -5.000e-4 mm"));
    }
}

/// The chords of one curve miss each other by the sagitta: no gap, with any width.
#[test]
fn facets_of_one_curve_touch() {
    for kind in [Q4, Q8] {
        for curve in [parabola as fn(f64) -> f64, |x: f64| 0.3 * x.cos()] {
            let scene = Scene::rows(kind, curve, PlaneModel::PlaneStrain);
            let mut contact = scene.contact(ContactPair { width: Width::OfPart, ..scene.pair(uinter(&[])) });
            assert!(largest(&forces(&mut contact, &vec![0.0; scene.freedom_count()])) < 1e-9, "{kind}");
        }
    }
}

#[test]
fn penalties_are_filled_by_role_and_left_alone_otherwise() {
    let scene = Scene::straight(Q4);
    let pressure = |law: ContactLaw| {
        let mut contact = scene.contact(scene.pair(law));
        forces(&mut contact, &scene.moved(1, |_| [0.0, -0.01]));
        contact.points().next().unwrap().pressure
    };
    // f min(E t/h)/width: the fibre of 0.7 mm decides.
    let penalty = 100.0 * 86.0 * 0.7 / 30.0;
    assert!((scene.contact(scene.pair(uinter(&[]))).penalties().next().unwrap() / penalty - 1.0).abs() < 1e-12);
    assert!((pressure(uinter(&[])) / (0.01 * penalty) - 1.0).abs() < 1e-10);
    assert!((pressure(uinter(&[("normal_stiffness", 7.0)])) / 0.07 - 1.0).abs() < 1e-10);
    assert!((pressure(hard(0.0, 0.0, &[])) / (0.01 * penalty) - 1.0).abs() < 1e-10);
    // Law none refuses k_f = 0 = k_e: the host fills it.
    let friction = uinter(&[("law", 2.0), ("k_e", 0.0), ("mu", 10.0)]);
    let mut contact = scene.contact(scene.pair(friction));
    forces(&mut contact, &scene.moved(1, |_| [1e-4, -0.01]));
    assert!((contact.points().next().unwrap().shear.abs() / (1e-4 * penalty) - 1.0).abs() < 1e-9);
}

/// Pressed by a force, bodies that touch without pressing would otherwise be free.
#[test]
fn surfaces_that_touch_are_stiff_and_open_as_they_part() {
    let scene = Scene::straight(Q4);
    let mut contact = scene.contact(scene.pair(hard(0.0, 0.0, &[])));
    let largest_stiffness = |contact: &mut Contact, lifted: f64| {
        let stiffness = stiffness(contact, &scene.moved(1, |_| [0.0, lifted]));
        stiffness.iter().map(|row| largest(row)).fold(0.0, f64::max)
    };
    let touching = largest_stiffness(&mut contact, 0.0);
    assert!(touching > 1.0, "{touching}");
    assert_eq!(contact.count(PointStatus::Open), 0);
    assert!(contact.points().all(|point| point.pressure.abs() < 1e-9 && point.shear.abs() < 1e-9));
    assert!((largest_stiffness(&mut contact, -0.01) / touching - 1.0).abs() < 0.1);
    assert_eq!((largest_stiffness(&mut contact, 1e-6), contact.count(PointStatus::Open)), (0.0, 6));
}

#[test]
fn a_tenth_of_the_points_over_the_cap_open_at_a_time() {
    let scene = Scene::straight(Q8);
    let pair = ContactPair { quadrature: Quadrature::Gauss(10), ..scene.pair(hard(4.0, 0.0, &[])) };
    let mut contact = scene.contact(pair);
    let displacements = scene.moved(1, |[x, _]| [0.0, 0.01 * x]);
    forces(&mut contact, &displacements);
    let over = contact.points().filter(|point| point.pressure < -4.0).count();
    assert!((20..30).contains(&over), "{over}");
    assert!(contact.settle());
    forces(&mut contact, &displacements);
    let worst: Vec<_> = contact.points().filter(|point| point.latched).map(|point| point.point).collect();
    assert_eq!(worst, [20, 21], "two points of the last edge: they share the largest tension");
    assert!(contact.points().filter(|point| point.latched).all(|point| point.pressure == 0.0 && point.shear == 0.0));
    let mut rounds = 1;
    while contact.settle() {
        forces(&mut contact, &displacements);
        rounds += 1;
    }
    assert_eq!(contact.points().filter(|point| point.latched).count(), over);
    assert!(rounds > 10);
    contact.restore();
    assert!(contact.points().all(|point| !point.latched), "latches belong to the attempt");
}

/// Under a given force Uzawa's updates bring the gap below the tolerance: one point, in one dimension.
#[test]
fn updates_close_the_gap() {
    for law in [uinter(&[]), hard(1000.0, 0.0, &[])] {
        let scene = Scene::straight(Q4);
        let enforcement = Enforcement::Uzawa { tolerance: 1e-8, max_updates: 10 };
        let mut contact = scene.contact(ContactPair { enforcement, ..scene.pair(law) });
        let penalty = contact.penalties().next().unwrap();
        let (wanted, mut depth, mut rounds) = (3.0, 0.0, 0);
        loop {
            // Newton on p(depth) = wanted is exact: p is linear.
            for _ in 0..2 {
                forces(&mut contact, &scene.moved(1, |_| [0.0, -depth]));
                depth += (wanted - contact.points().next().unwrap().pressure) / penalty;
            }
            forces(&mut contact, &scene.moved(1, |_| [0.0, -depth]));
            let is_settled = !contact.settle();
            rounds += 1;
            if is_settled {
                assert!(contact.points().all(|point| point.gap.abs() <= 1e-8));
                break;
            }
        }
        assert_eq!(rounds, 2, "a spring below λ is held by one update");
        assert!((contact.points().next().unwrap().pressure - wanted).abs() < 1e-9);
        contact.commit();
        forces(&mut contact, &scene.moved(1, |_| [0.0, -depth]));
        assert!((contact.points().next().unwrap().pressure - wanted).abs() < 1e-9, "the next increment starts warm");
    }
}

#[test]
fn an_enforcement_without_a_penalty_is_refused() {
    let scene = Scene::straight(Q4);
    let condensed = Enforcement::PerturbedLagrangian { ratio: 1e4 };
    let pair = ContactPair { enforcement: condensed, ..scene.pair(uinter(&[("normal_stiffness", 7.0)])) };
    let error = Contact::new(&scene.mesh, &[pair], &[1.0, 1.0], true, &FieldValues::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "contact 'fibre': a perturbed Lagrangian of a UINTER needs a parameter whose role is normal_penalty, left at 0 for the \
         host to fill"
    );
}

/// (6.20): p_0 at no gap, nothing from g_0 on, and no jump where the exponential ends.
#[test]
fn the_soft_law_is_that_of_the_thesis_made_continuous() {
    let scene = Scene::straight(Q4);
    let mut contact = scene.contact(scene.pair(soft(&[])));
    let mut pressure = |gap: f64| {
        forces(&mut contact, &scene.moved(1, |_| [0.0, gap]));
        contact.points().next().unwrap().pressure
    };
    assert!((pressure(0.0) - 2.0).abs() < 1e-12);
    assert_eq!(pressure(0.1001), 0.0);
    let e = std::f64::consts::E;
    assert!((pressure(0.05) - 2.0 / (e - 1.0) * 0.5 * (0.5_f64.exp() - 1.0)).abs() < 1e-12);
    let end = 2.0 / (e - 1.0) * (7.0 * 7.0_f64.exp() - 7.0);
    assert!((pressure(-0.6) / end - 1.0).abs() < 1e-12);
    let slope = 2.0 / (e - 1.0) * (8.0 * 7.0_f64.exp() - 1.0) / 0.1;
    assert!((pressure(-0.7) / (end + 0.1 * slope) - 1.0).abs() < 1e-12);
}

/// Lifted off in small steps, the bond costs the triangle under its cap, ½ p_0 (g_c + δ_N), and keeps nothing.
#[test]
fn opening_costs_the_triangle_under_the_cap() {
    let scene = Scene::straight(Q8);
    let (p_0, delta_n) = (4.0, 0.2);
    let mut contact = scene.contact(scene.pair(hard(p_0, delta_n, &[])));
    for step in 0..=1000 {
        let displacements = scene.moved(1, |_| [0.0, 3e-4 * f64::from(step)]);
        forces(&mut contact, &displacements);
        while contact.settle() {
            forces(&mut contact, &displacements);
        }
        contact.commit();
    }
    let area: f64 = contact.points().map(|point| point.area).sum();
    let triangle = 0.5 * p_0 * (p_0 / contact.penalties().next().unwrap() + delta_n) * area;
    let energies = contact.energies();
    assert!((energies.opening / triangle - 1.0).abs() < 2e-3, "{} for {triangle}", energies.opening);
    assert!((energies.work - energies.opening).abs() < 1e-9 * triangle);
    assert_eq!((energies.normal_stored, contact.count(PointStatus::Open)), (0.0, 6));
}

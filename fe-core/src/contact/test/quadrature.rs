//! Areas, and uniform pressure on edges that do not match.

use super::*;
use crate::element::ElementKind::{Q4, Q8};
use crate::model::Quadrature::{Gauss, Nodes, Segments};
use std::f64::consts::PI;

/// Nodal forces of the master under the pressure of the soft law at a uniform gap, against ∫N p dA; relative.
fn error_of_uniform_pressure(kind: ElementKind, quadrature: Quadrature) -> f64 {
    let scene = Scene::new(
        Row { kind, from: 0.0, to: 3.0, count: 5 },
        Row { kind, from: 0.0, to: 3.0, count: 7 },
        |_| 0.0,
        PlaneModel::PlaneStrain,
    );
    let pair = ContactPair { quadrature, width: Width::OfPart, ..scene.pair(soft(&[])) };
    let mut contact = scene.contact(pair);
    let forces = forces(&mut contact, &scene.moved(1, |_| [0.0, -0.01]));
    let pressure = contact.points().next().unwrap().pressure;
    let shares: &[f64] = if kind == Q4 { &[0.5, 0.5] } else { &[1.0 / 6.0, 1.0 / 6.0, 4.0 / 6.0] };
    let mut exact = vec![0.0; forces.len()];
    for &edge in &scene.master {
        for (&node, share) in scene.mesh.edge_nodes(edge).nodes().iter().zip(shares) {
            exact[2 * node + 1] += share * pressure * 0.9 * 0.6;
        }
    }
    let of_master = (0..exact.len()).filter(|&freedom| exact[freedom] != 0.0);
    of_master.map(|freedom| (forces[freedom] - exact[freedom]).abs()).fold(0.0, f64::max) / largest(&exact)
}

#[test]
fn segments_are_exact_where_fixed_points_are_not() {
    assert!(error_of_uniform_pressure(Q4, Segments(1)) < 1e-12);
    assert!(error_of_uniform_pressure(Q8, Segments(2)) < 1e-12);
    assert!(error_of_uniform_pressure(Q8, Segments(3)) < 1e-12);
    let [few, more, many] = [2, 3, 10].map(|points| error_of_uniform_pressure(Q8, Gauss(points)));
    println!("Gauss, 5 against 7 quadratic edges: {few:.3} with 2, {more:.3} with 3, {many:.3} with 10 points");
    assert!(few > many && many > 1e-3);
}

#[test]
fn areas_and_lengths_add_up() {
    for quadrature in [Gauss(2), Nodes, Segments(3)] {
        let scene = Scene::rows(Q8, |_| 0.0, PlaneModel::Axisymmetric);
        let sum = |width: Width| {
            let pair = ContactPair { quadrature, width, ..scene.pair(uinter(&[])) };
            scene.contact(pair).points().map(|point| point.area).sum::<f64>()
        };
        assert!((sum(Width::Given(0.5)) - 0.5 * 2.6).abs() < 1e-13);
        let ring = PI * (4.1_f64.powi(2) - 1.5_f64.powi(2));
        assert!((sum(Width::OfPart) / ring - 1.0).abs() < 1e-13, "{quadrature:?}");
        let pair = ContactPair { quadrature, ..scene.pair(uinter(&[])) };
        let contact = scene.contact(pair);
        for point in contact.points() {
            let x = scene.mesh.nodes()[scene.mesh.edge_nodes(scene.slave[0]).nodes()[0]][0];
            assert!(x == 1.5 && (0.0..=2.6).contains(&point.coordinate));
        }
    }
}

/// The weights tile the surface: what is left of a straight bond falls linearly as the slave leaves, for any rule, and what is in
/// contact grows as it comes back.
#[test]
fn what_is_left_of_the_contact_falls_linearly_to_nothing() {
    let row = |count| Row { kind: Q8, from: 0.0, to: 3.0, count };
    let scene = Scene::new(row(4), row(5), |_| 0.0, PlaneModel::PlaneStrain);
    for quadrature in [Gauss(2), Gauss(3), Nodes, Segments(2)] {
        for direction in [1.0, -1.0] {
            let pair = ContactPair { quadrature, release: true, width: Width::Given(1.0), ..scene.pair(uinter(&[])) };
            let mut contact = scene.contact(pair);
            assert!(contact.points().all(|point| point.weight == 1.0), "{quadrature:?}");
            for step in 0..=31 {
                let slide = 0.1 * f64::from(step);
                forces(&mut contact, &scene.moved(1, |_| [direction * slide, 0.0]));
                contact.commit();
                let left: f64 = contact.points().map(|point| point.area * point.weight).sum();
                assert!((left - (3.0 - slide).max(0.0)).abs() < 1e-9, "{quadrature:?}: {left} after {slide}");
            }
            assert_eq!(contact.count(PointStatus::Released), contact.points().count());
            for step in (0..=31).rev() {
                let slide = 0.1 * f64::from(step);
                forces(&mut contact, &scene.moved(1, |_| [direction * slide, 0.0]));
                contact.commit();
                let back: f64 = contact.points().map(|point| point.area * point.weight).sum();
                assert!((back - (3.0 - slide).max(0.0)).abs() < 1e-9, "{quadrature:?}: {back} back at {slide}");
            }
            assert_eq!(contact.count(PointStatus::Released), 0);
        }
    }
}

#[test]
fn numbers_of_points_out_of_range_are_refused() {
    let scene = Scene::straight(Q4);
    for quadrature in [Gauss(0), Segments(11)] {
        let pair = ContactPair { quadrature, ..scene.pair(uinter(&[])) };
        let error = Contact::new(&scene.mesh, &[pair], &[1.0, 1.0], true, &FieldValues::default()).unwrap_err();
        assert!(error.to_string().contains("from 1 to 10 are possible"), "{error}");
    }
}

use super::*;
use crate::element::ElementKind;
use crate::mesh::{ElementDefinition, MeshDefinition, Part};
use approx::{assert_abs_diff_eq, assert_relative_eq};
use std::f64::consts::PI;

const LOW: f64 = 2.0;
const HIGH: f64 = 5.0;
const HEIGHT: f64 = 1.5;

/// One element over LOW < x < HIGH, 0 < y < HEIGHT, its right edge bulging by `bulge` if quadratic.
fn block(kind: ElementKind, model: PlaneModel, bulge: f64) -> Mesh {
    let mut nodes = vec![[LOW, 0.0], [HIGH, 0.0], [HIGH, HEIGHT], [LOW, HEIGHT]];
    if kind == ElementKind::Q8 {
        let middle = 0.5 * (LOW + HIGH);
        nodes.extend([[middle, 0.0], [HIGH + bulge, 0.5 * HEIGHT], [middle, HEIGHT], [LOW, 0.5 * HEIGHT]]);
    }
    let element = ElementDefinition { kind, part: 0, nodes: (0..nodes.len()).collect() };
    let parts = vec![Part::new("block", model, 0.7)];
    Mesh::new(MeshDefinition { nodes, parts, elements: vec![element], ..MeshDefinition::default() }).unwrap()
}

const RIGHT: ElementEdge = ElementEdge { element: 0, edge: 1 };

fn all_edges() -> Vec<ElementEdge> {
    (0..4).map(|edge| ElementEdge { element: 0, edge }).collect()
}

fn forces(mesh: &Mesh, nlgeom: bool, load: &LoadKind, factor: f64, displacements: &[f64]) -> Vec<f64> {
    let mut forces = vec![0.0; 2 * mesh.nodes().len()];
    let bearers = Bearers { thickness: &|_| nlgeom.then_some(0.7), shares: None };
    external(mesh, &bearers, load, factor, displacements, &mut forces, None);
    forces
}

fn sum(forces: &[f64], component: usize) -> f64 {
    forces.iter().skip(component).step_by(2).sum()
}

#[test]
fn a_force_acts_at_each_of_its_nodes() {
    let mesh = block(ElementKind::Q4, PlaneModel::PlaneStrain, 0.0);
    let load = LoadKind::Force { nodes: vec![1, 3], force: [2.0, -3.0] };
    assert_eq!(forces(&mesh, false, &load, 0.5, &[0.0; 8]), [0.0, 0.0, 1.0, -1.5, 0.0, 0.0, 1.0, -1.5]);
}

/// Two adjacent elements and a separate node. Half of the left element remains, and a tenth of the right one.
#[test]
fn loads_fade_with_their_elements() {
    let nodes = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0], [9.0, 9.0]];
    let element = |nodes: [usize; 4]| ElementDefinition { kind: ElementKind::Q4, part: 0, nodes: nodes.to_vec() };
    let elements = vec![element([0, 1, 4, 3]), element([1, 2, 5, 4])];
    let parts = vec![Part::new("block", PlaneModel::PlaneStress, 0.7)];
    let mesh = Mesh::new(MeshDefinition { nodes, parts, elements, ..MeshDefinition::default() }).unwrap();
    let shares = [0.5, 0.1];
    let top = |element: usize| ElementEdge { element, edge: 2 };
    let edges = vec![top(0), top(1)];
    let found = |load: &LoadKind, nlgeom: bool| {
        let mut forces = vec![0.0; 14];
        let bearers = Bearers {
            thickness: &|_| nlgeom.then_some(0.7),
            shares: Some(Shares::new(&mesh, |element| shares[element])),
        };
        external(&mesh, &bearers, load, 2.0, &[0.0; 14], &mut forces, None);
        [3, 4, 5].map(|node| forces[2 * node + 1])
    };
    // half of each edge's load at each of its ends
    let expected = [shares[0], shares[0] + shares[1], shares[1]].map(|share| share * 2.0 * 3.0 * 0.7 / 2.0);
    for (load, nlgeom) in [
        (LoadKind::Traction { edges: edges.clone(), traction: [0.0, 3.0] }, false),
        (LoadKind::Pressure { edges: edges.clone(), pressure: -3.0 }, false),
        (LoadKind::Pressure { edges, pressure: -3.0 }, true),
    ] {
        for (found, expected) in found(&load, nlgeom).into_iter().zip(expected) {
            assert_relative_eq!(found, expected, max_relative = 1e-14);
        }
    }
    let force = LoadKind::Force { nodes: vec![3, 4, 5], force: [0.0, 1.0] };
    assert_eq!(found(&force, false), [1.0, 1.0, 0.2], "the middle one as the last of its elements");
    let alone = Shares::new(&mesh, |_| 0.0);
    assert_eq!(alone.nodes, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], "the last node has no elements and keeps its force");
}

#[test]
fn a_traction_is_shared_as_the_shape_functions_say() {
    let load = LoadKind::Traction { edges: vec![RIGHT], traction: [4.0, 1.0] };
    let q8 = block(ElementKind::Q8, PlaneModel::PlaneStress, 0.0);
    let found = forces(&q8, false, &load, 2.0, &[0.0; 16]);
    let total = 2.0 * 0.7 * HEIGHT * 4.0;
    // Simpson's rule on a straight quadratic edge.
    for (node, share) in [(1, 1.0 / 6.0), (2, 1.0 / 6.0), (5, 4.0 / 6.0)] {
        assert_relative_eq!(found[2 * node], share * total, max_relative = 1e-14);
        assert_relative_eq!(found[2 * node + 1], 0.25 * share * total, max_relative = 1e-14);
    }
    let q4 = block(ElementKind::Q4, PlaneModel::Axisymmetric, 0.0);
    let found = forces(&q4, false, &load, 1.0, &[0.0; 8]);
    assert_relative_eq!(sum(&found, 0), 4.0 * 2.0 * PI * HIGH * HEIGHT, max_relative = 1e-14);
}

/// ∮ n dA = 0 in the plane; about an axis the axial force of a closed surface is 0, the radial one 2π p A.
#[test]
fn pressure_around_a_body_is_in_equilibrium() {
    for kind in [ElementKind::Q4, ElementKind::Q8] {
        for model in PlaneModel::ALL {
            let mesh = block(kind, model, 0.3);
            let load = LoadKind::Pressure { edges: all_edges(), pressure: 3.0 };
            let found = forces(&mesh, false, &load, 1.0, &vec![0.0; 2 * mesh.nodes().len()]);
            assert_abs_diff_eq!(sum(&found, 1), 0.0, epsilon = 1e-12);
            let radial = if model == PlaneModel::Axisymmetric { -2.0 * PI * 3.0 * mesh.element_area(0) } else { 0.0 };
            assert_abs_diff_eq!(sum(&found, 0), radial, epsilon = 1e-11);
        }
    }
}

/// Pappus: p δV for an arbitrary motion, by a difference of the volumes.
#[test]
fn work_of_a_follower_pressure_is_that_of_the_volume() {
    for model in [PlaneModel::PlaneStrain, PlaneModel::Axisymmetric] {
        let mesh = block(ElementKind::Q8, model, 0.3);
        let displaced = bent(&mesh);
        let volume = |displacements: &[f64]| -> f64 {
            let nodes: Vec<[f64; 2]> = mesh
                .nodes()
                .iter()
                .enumerate()
                .map(|(node, x)| [x[0] + displacements[2 * node], x[1] + displacements[2 * node + 1]])
                .collect();
            let points = ElementKind::Q8.full_integration_points();
            let of_point = |point: &crate::element::IntegrationPoint| {
                let mapped = crate::element::MappedPoint::new(ElementKind::Q8, &nodes, point.coordinates).unwrap();
                point.weight * mapped.determinant * model.depth(mapped.position[0], 0.7)
            };
            points.iter().map(of_point).sum()
        };
        let load = LoadKind::Pressure { edges: all_edges(), pressure: -2.0 };
        let found = forces(&mesh, true, &load, 1.0, &displaced);
        for freedom in 0..found.len() {
            let at = |shift: f64| {
                let mut moved = displaced.clone();
                moved[freedom] += shift;
                volume(&moved)
            };
            // The volume is at most a cubic of one displacement, so differences are exact up to h² of the cube.
            let difference = (at(1e-4) - at(-1e-4)) / 2e-4;
            assert_abs_diff_eq!(found[freedom], 2.0 * difference, epsilon = 1e-7);
        }
    }
}

/// Large and different displacements of all nodes.
fn bent(mesh: &Mesh) -> Vec<f64> {
    (0..2 * mesh.nodes().len()).map(|k| 0.2 * (1.3 * k as f64).sin()).collect()
}

#[test]
fn stiffness_of_a_follower_pressure_agrees_with_differences() {
    for kind in [ElementKind::Q4, ElementKind::Q8] {
        for model in PlaneModel::ALL {
            let mesh = block(kind, model, 0.3);
            let displacements = bent(&mesh);
            let load = LoadKind::Pressure { edges: vec![RIGHT, ElementEdge { element: 0, edge: 2 }], pressure: 5.0 };
            let mut blocks = Blocks::default();
            let size = displacements.len();
            let bearers = Bearers { thickness: &|_| Some(0.7), shares: None };
            external(&mesh, &bearers, &load, 0.4, &displacements, &mut vec![0.0; size], Some(&mut blocks));
            assert_eq!(blocks.len(), 2);
            let mut stiffness = vec![0.0; size * size];
            for (rows, values) in blocks.iter() {
                for (i, row) in rows.iter().enumerate() {
                    for (j, column) in rows.iter().enumerate() {
                        stiffness[row * size + column] += values[i * rows.len() + j];
                    }
                }
            }
            let step = 1e-3;
            for column in 0..size {
                let at = |shift: f64| {
                    let mut moved = displacements.clone();
                    moved[column] += shift;
                    forces(&mesh, true, &load, 0.4, &moved)
                };
                let (plus, minus) = (at(step), at(-step));
                for row in 0..size {
                    let difference = -(plus[row] - minus[row]) / (2.0 * step);
                    assert_abs_diff_eq!(stiffness[row * size + column], difference, epsilon = 1e-8);
                }
            }
        }
    }
}

#[test]
fn small_displacements_and_dead_loads_have_no_stiffness() {
    let mesh = block(ElementKind::Q8, PlaneModel::PlaneStrain, 0.3);
    let displacements = bent(&mesh);
    let pressure = LoadKind::Pressure { edges: all_edges(), pressure: 5.0 };
    let traction = LoadKind::Traction { edges: all_edges(), traction: [1.0, 2.0] };
    let mut blocks = Blocks::default();
    for (nlgeom, load) in [(false, &pressure), (true, &traction)] {
        let mut found = vec![0.0; 16];
        let bearers = Bearers { thickness: &|_| nlgeom.then_some(0.7), shares: None };
        external(&mesh, &bearers, load, 1.0, &displacements, &mut found, Some(&mut blocks));
        assert!(blocks.is_empty());
        assert_eq!(found, forces(&mesh, nlgeom, load, 1.0, &[0.0; 16]), "it acts on the reference edge");
    }
}

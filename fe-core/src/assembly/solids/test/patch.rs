//! Patch tests: a linear motion gives the same stress everywhere, in equilibrium at inner nodes.

use super::*;
use crate::element::MappedPoint;
use crate::kinematics::test::strain_displacement::StrainDisplacement;
use crate::mesh::Element;

/// Nodes on no boundary edge.
fn inner_nodes(mesh: &Mesh) -> Vec<usize> {
    let outer: Vec<usize> = mesh.boundary_edges().flat_map(|edge| mesh.edge_nodes(edge).nodes().to_vec()).collect();
    (0..mesh.nodes().len()).filter(|node| !outer.contains(node)).collect()
}

fn check(model: &Model, motions: &[Vec<f64>], context: &str) {
    let mut solids = Solids::new(model).unwrap();
    let mut last = Vec::new();
    for displacements in motions {
        last = forces(&mut solids, displacements, Request::StressAndTangent);
        solids.commit(displacements);
    }
    let first = solids.point(0, 0).stress;
    assert!(largest(&first) > 0.1, "{context}: {first:?}");
    for element in 0..model.mesh.elements().len() {
        for point in 0..solids.point_count(element) {
            let stress = solids.point(element, point).stress;
            let difference: Vec<f64> = stress.iter().zip(first).map(|(a, b)| a - b).collect();
            assert!(largest(&difference) < 1e-10 * largest(&first), "{context}: {stress:?} {first:?}");
        }
    }
    let inner = inner_nodes(&model.mesh);
    assert!(inner.len() >= 4);
    for node in inner {
        let force = &last[2 * node..2 * node + 2];
        assert!(largest(force) < 1e-10 * largest(&last), "{context}, node {node}: {force:?}");
    }
}

#[test]
fn linear_motions_give_one_stress_in_equilibrium() {
    for law in [linear_elastic(), j2_plasticity()] {
        for variant in Variant::ALL {
            for plane_model in PlaneModel::ALL {
                let axisymmetric = plane_model == PlaneModel::Axisymmetric;
                // About an axis the rules are exact for straight edges, and one stress without shear is in equilibrium
                // where that along r is that around it.
                let mesh = patch(variant, plane_model, 0.1, if axisymmetric { 0.0 } else { 0.03 });
                for (nlgeom, size) in [(false, 0.02), (true, 0.3)] {
                    let at = |share: f64| {
                        let s = size * share;
                        moved(&mesh, |[x, y]| match axisymmetric {
                            true => [(1.0 + s) * x, (1.0 - 0.3 * s) * y],
                            false => [(1.0 + s) * x + 0.7 * s * y + 0.1, (1.0 - 0.2 * s) * y - 0.4 * s * x],
                        })
                    };
                    let motions = [at(0.5), at(1.0)];
                    let context = format!("{} {variant:?} {plane_model:?} {nlgeom}", law.name);
                    check(&model(mesh.clone(), &law, variant.average, nlgeom), &motions, &context);
                }
            }
        }
    }
}

/// The stress of the small-strain patch by Hooke's law in closed form.
#[test]
fn stress_is_that_of_the_law() {
    let mesh = patch(Variant::new(ElementKind::Q8), PlaneModel::PlaneStress, 0.1, 0.03);
    let displacements = moved(&mesh, |[x, y]| [x + 1e-3 * x + 2e-3 * y, y - 2e-3 * y]);
    let mut solids = Solids::new(&model(mesh, &linear_elastic(), false, false)).unwrap();
    advance(&mut solids, &displacements);
    let factor = 1000.0 / (1.0 - 0.09);
    let expected = [factor * (1e-3 - 0.3 * 2e-3), factor * (-2e-3 + 0.3 * 1e-3), 0.0, 1000.0 / 2.6 * 2e-3];
    for (found, expected) in solids.point(3, 2).stress.iter().zip(expected) {
        approx::assert_abs_diff_eq!(*found, expected, epsilon = 1e-12);
    }
}

/// Kinds side by side in one part.
#[test]
fn kinds_mix_in_a_part() {
    let nodes = vec![[0.0, 0.0], [1.0, 0.1], [1.1, 1.0], [0.0, 0.9], [2.0, 0.5]];
    let definition = |kind, nodes| ElementDefinition { kind, part: 0, nodes };
    let elements = vec![definition(ElementKind::Q4, vec![0, 1, 2, 3]), definition(ElementKind::T3, vec![1, 4, 2])];
    let mesh = mesh(nodes, Variant::new(ElementKind::Q4), PlaneModel::PlaneStrain, elements);
    let displacements = moved(&mesh, |[x, y]| [1.001 * x, 0.999 * y + 0.002 * x]);
    let mut solids = Solids::new(&model(mesh.clone(), &linear_elastic(), false, false)).unwrap();
    advance(&mut solids, &displacements);
    let counts: Vec<usize> = mesh.elements().iter().map(Element::nodes).map(<[usize]>::len).collect();
    assert_eq!(counts, [4, 3]);
    for (a, b) in solids.point(0, 3).stress.iter().zip(solids.point(1, 0).stress) {
        approx::assert_abs_diff_eq!(*a, b, epsilon = 1e-12);
    }
}

/// The loops over nodes against the matrix B of [`crate::kinematics`], B-bar included: f = Σ Bᵀ σ dV, ε = B u.
#[test]
fn forces_and_strains_are_those_of_the_matrix_b() {
    for variant in Variant::ALL {
        for plane_model in PlaneModel::ALL {
            let mesh = single(variant, plane_model, 0.1);
            let displacements = moved(&mesh, |[x, y]| [x + 0.01 * (x * y + y), y + 0.02 * (x * x - y)]);
            let mut solids = Solids::new(&model(mesh.clone(), &linear_elastic(), variant.average, false)).unwrap();
            let found = forces(&mut solids, &displacements, Request::Stress);
            solids.commit(&displacements);
            let (nodes, count) = mesh.element_positions(0);
            let mut matrices: Vec<(StrainDisplacement, f64)> = mesh
                .integration_points(0)
                .iter()
                .map(|point| {
                    let mapped = MappedPoint::new(variant.kind, &nodes[..count], point.coordinates).unwrap();
                    let volume = plane_model.depth(mapped.position[0], 0.7) * mapped.determinant * point.weight;
                    (StrainDisplacement::new(plane_model, &mapped).unwrap(), volume)
                })
                .collect();
            if variant.average {
                StrainDisplacement::average_dilatation(&mut matrices);
            }
            let mut expected = vec![0.0; found.len()];
            for (point, (matrix, volume)) in matrices.iter().enumerate() {
                let view = solids.point(0, point);
                // In plane stress the matrix has the shear third.
                let order = if plane_model == PlaneModel::PlaneStress { [0, 1, 3, 2] } else { [0, 1, 2, 3] };
                let strain = matrix.strain(&displacements);
                for (k, &component) in order.iter().enumerate() {
                    approx::assert_abs_diff_eq!(view.strain[component], strain[k], epsilon = 1e-15);
                }
                matrix.add_internal_force(&order.map(|component| view.stress[component]), *volume, &mut expected);
            }
            let scale = largest(&expected);
            for (found, expected) in found.iter().zip(&expected) {
                approx::assert_abs_diff_eq!(found, expected, epsilon = 1e-13 * scale);
            }
        }
    }
}

//! One element of the field: what it needs of the mesh, and its equations.

use crate::assembly::solids::{PointField, ReturnedHeat};
use crate::element::{MAX_NODES, MappedPoint};
use crate::mesh::Mesh;
use std::f64::consts::PI;
use umat_abi::host::Transfer;

/// An integration point.
#[derive(Clone, Copy, Debug)]
struct FieldPoint {
    /// N_i.
    values: [f64; MAX_NODES],
    /// ∂N_i/∂x.
    gradients: [[f64; 2]; MAX_NODES],
    /// dV.
    volume: f64,
}

/// Conductivity, and per time capacity and the density by which U of UMATHT counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Medium {
    pub(super) conductivity: f64,
    pub(super) capacity_rate: f64,
    pub(super) density_rate: f64,
}

/// An element of the field.
#[derive(Clone, Debug)]
pub(super) struct FieldElement {
    pub(super) element: usize,
    pub(super) nodes: Vec<usize>,
    points: Vec<FieldPoint>,
}

impl FieldElement {
    pub(super) fn new(mesh: &Mesh, element: usize) -> Self {
        let definition = &mesh.elements()[element];
        let (kind, thickness) = (definition.kind(), definition.thickness());
        let model = mesh.parts()[definition.part()].model;
        let (positions, count) = mesh.element_positions(element);
        let points = mesh.integration_points(element).iter().map(|point| {
            let mapped = MappedPoint::new(kind, &positions[..count], point.coordinates)
                .expect("checked: a mesh has no inverted element");
            let (mut values, mut gradients) = ([0.0; MAX_NODES], [[0.0; 2]; MAX_NODES]);
            values[..count].copy_from_slice(mapped.shape.values());
            gradients[..count].copy_from_slice(mapped.shape.derivatives());
            let depth = model.depth(mapped.position[0], thickness);
            FieldPoint { values, gradients, volume: depth * mapped.determinant * point.weight }
        });
        Self { element, nodes: definition.nodes().to_vec(), points: points.collect() }
    }

    pub(super) fn point_count(&self) -> usize {
        self.points.len()
    }

    /// The field at a point, of values at all nodes of the mesh at the start and at the end.
    pub(super) fn at(&self, point: usize, values: [&[f64]; 2]) -> PointField {
        let FieldPoint { values: shapes, gradients, .. } = &self.points[point];
        let ends = values.map(|values| self.nodes.iter().zip(shapes).map(|(&node, shape)| shape * values[node]).sum());
        let along = |k: usize| self.nodes.iter().zip(gradients).map(|(&node, by)| by[k] * values[1][node]).sum();
        PointField { ends, gradient: [along(0), along(1)] }
    }

    /// R and K, row by row, with θ at its nodes at the start and at the end, and what the laws at its points returned.
    pub(super) fn equations(
        &self,
        medium: Medium,
        [start, end]: [&[f64]; 2],
        heat: &[ReturnedHeat],
    ) -> (Vec<f64>, Vec<f64>) {
        let count = self.nodes.len();
        let Medium { conductivity, capacity_rate, density_rate } = medium;
        let (mut residual, mut matrix) = (vec![0.0; count], vec![0.0; count * count]);
        for (point, ReturnedHeat { source: [rpl, drpldt], transfer, .. }) in self.points.iter().zip(heat) {
            let FieldPoint { values, gradients, volume } = point;
            if let Some(transfer) = transfer {
                self.add_transfer(point, transfer, [*rpl, *drpldt], density_rate, (&mut residual, &mut matrix));
                continue;
            }
            let (mut rate, mut gradient) = (0.0, [0.0; 2]);
            for i in 0..count {
                rate += values[i] * (end[i] - start[i]);
                gradient[0] += gradients[i][0] * end[i];
                gradient[1] += gradients[i][1] * end[i];
            }
            let source = volume * (rpl - capacity_rate * rate);
            let (flow, storage) = (volume * conductivity, volume * (capacity_rate - drpldt));
            for i in 0..count {
                let [x, y] = gradients[i];
                residual[i] += values[i] * source - flow * (x * gradient[0] + y * gradient[1]);
                for j in 0..count {
                    matrix[i * count + j] +=
                        flow * (x * gradients[j][0] + y * gradients[j][1]) + storage * values[i] * values[j];
                }
            }
        }
        (residual, matrix)
    }

    /// Adds the part of a point whose heat is that of UMATHT:
    ///
    /// ```text
    /// R_i += N_i (r − ρ (U − U_n)/Δt) + ∇N_i·f
    /// K_ij += N_i (ρ/Δt (∂U/∂θ N_j + ∂U/∂∇θ·∇N_j) − ∂r/∂θ N_j) − ∇N_i·(∂f/∂θ N_j + ∂f/∂∇θ ∇N_j)
    /// ```
    fn add_transfer(
        &self,
        point: &FieldPoint,
        transfer: &Transfer,
        [rpl, drpldt]: [f64; 2],
        density_rate: f64,
        (residual, matrix): (&mut [f64], &mut [f64]),
    ) {
        let count = self.nodes.len();
        let FieldPoint { values, gradients, volume } = point;
        let dot = |a: &[f64; 2], b: &[f64; 2]| a[0] * b[0] + a[1] * b[1];
        let source = rpl - density_rate * transfer.energy;
        for i in 0..count {
            residual[i] += volume * (values[i] * source + dot(&gradients[i], &transfer.flux));
        }
        for j in 0..count {
            let energy = transfer.energy_by_temperature * values[j] + dot(&transfer.energy_by_gradient, &gradients[j]);
            let storage = density_rate * energy - drpldt * values[j];
            let flux: [f64; 2] = std::array::from_fn(|k| {
                transfer.flux_by_temperature[k] * values[j] + dot(&transfer.flux_by_gradient[k], &gradients[j])
            });
            for i in 0..count {
                matrix[i * count + j] += volume * (values[i] * storage - dot(&gradients[i], &flux));
            }
        }
    }

    /// ∫ (α/l + l |∇d|²)/π dV, of d at all nodes of the mesh.
    pub(super) fn surface(&self, values: &[f64], length: f64) -> f64 {
        let density = |point: &FieldPoint| {
            let (mut d, mut gradient) = (0.0, [0.0; 2]);
            for (i, &node) in self.nodes.iter().enumerate() {
                d += point.values[i] * values[node];
                gradient[0] += point.gradients[i][0] * values[node];
                gradient[1] += point.gradients[i][1] * values[node];
            }
            let square = gradient[0] * gradient[0] + gradient[1] * gradient[1];
            point.volume * ((2.0 * d - d * d) / length + length * square) / PI
        };
        self.points.iter().map(density).sum()
    }
}

//! Strains by the matrix B, a reference for the element's own. Shared by tests and the solver's benchmark, which import what it
//! uses.

use super::{MappedPoint, PlaneModel};

/// The most components that a plane stress or strain has.
const COMPONENTS: usize = 4;

/// The most degrees of freedom that an element has.
pub const MAX_FREEDOMS: usize = 16;

/// A hoop strain was asked for where there is no radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadiusError {
    /// x of the point.
    pub radius: f64,
}

/// The matrix B of one point: strains from nodal displacements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainDisplacement {
    component_count: usize,
    freedom_count: usize,
    /// One column per degree of freedom, so that each node's part is contiguous.
    columns: [[f64; COMPONENTS]; MAX_FREEDOMS],
}

impl StrainDisplacement {
    /// B at a mapped point.
    ///
    /// # Errors
    ///
    /// In axial symmetry, where the radius is not positive.
    pub fn new(model: PlaneModel, point: &MappedPoint) -> Result<Self, RadiusError> {
        let radius = point.position[0];
        if model == PlaneModel::Axisymmetric && (radius <= 0.0 || radius.is_nan()) {
            return Err(RadiusError { radius });
        }
        let component_count = model.stress_state().components().len();
        let shear = component_count - 1;
        let mut columns = [[0.0; COMPONENTS]; MAX_FREEDOMS];
        for (node, (value, [by_x, by_y])) in point.shape.values().iter().zip(point.shape.derivatives()).enumerate() {
            let (u, v) = (2 * node, 2 * node + 1);
            columns[u][0] = *by_x;
            columns[v][1] = *by_y;
            columns[u][shear] = *by_y;
            columns[v][shear] = *by_x;
            if model == PlaneModel::Axisymmetric {
                columns[u][2] = value / radius;
            }
        }
        let freedom_count = 2 * point.shape.values().len();
        Ok(Self { component_count, freedom_count, columns })
    }

    /// B-bar: gives all points of an element, each with its volume, the mean of their dilatation, so that a nearly
    /// incompressible Q4 does not lock. Does nothing in plane stress, where nothing locks.
    pub fn average_dilatation(points: &mut [(Self, f64)]) {
        if points.iter().any(|(point, _)| point.component_count != COMPONENTS) {
            return;
        }
        let total: f64 = points.iter().map(|(_, volume)| volume).sum();
        for freedom in 0..points.first().map_or(0, |(point, _)| point.freedom_count) {
            let mean = points.iter().map(|(point, volume)| point.dilatation(freedom) * volume).sum::<f64>() / total;
            for (point, _) in points.iter_mut() {
                let third = (mean - point.dilatation(freedom)) / 3.0;
                point.columns[freedom][..3].iter_mut().for_each(|direct| *direct += third);
            }
        }
    }

    /// ε₁₁ + ε₂₂ + ε₃₃ of a unit displacement.
    fn dilatation(&self, freedom: usize) -> f64 {
        self.columns[freedom][..3].iter().sum()
    }

    /// The columns of B, one per degree of freedom; components that the model has not are 0.
    pub fn columns(&self) -> &[[f64; COMPONENTS]] {
        &self.columns[..self.freedom_count]
    }

    /// ε = B u; components that the model has not are 0.
    ///
    /// # Panics
    ///
    /// If `displacements` does not hold two for each node.
    pub fn strain(&self, displacements: &[f64]) -> [f64; COMPONENTS] {
        assert_eq!(displacements.len(), self.freedom_count, "two displacements for each node");
        let mut strain = [0.0; COMPONENTS];
        for (column, displacement) in self.columns().iter().zip(displacements) {
            for component in 0..COMPONENTS {
                strain[component] += column[component] * displacement;
            }
        }
        strain
    }
}

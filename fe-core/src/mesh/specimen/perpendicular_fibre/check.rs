//! Requirements on the parameters of a fibre in a block.

use super::{Configuration, PerpendicularFibre};
use crate::mesh::specimen::SpecimenError;
use crate::mesh::specimen::requirement::Requirements;

impl PerpendicularFibre {
    /// Checks the parameters.
    pub(super) fn check(&self) -> Result<(), SpecimenError> {
        let mut required = Requirements::default();
        required.positive([
            ("width", self.width),
            ("depth", self.depth),
            ("matrix_thickness", self.matrix_thickness),
            ("fibre_diameter", self.fibre_diameter),
            ("embedded_length", self.embedded_length),
            ("free_length", self.free_length),
            ("interface_size", self.mesh.interface_size),
            ("largest_size", self.mesh.largest_size),
        ]);
        let (gap, hole_depth) = (self.tail_gap, self.embedded_length + self.tail_gap);
        required.that(gap >= 0.0 && gap.is_finite(), "tail_gap", gap, "0 or positive");
        required.that(
            hole_depth < self.depth,
            "embedded_length + tail_gap",
            hole_depth,
            format!("less than the depth {}: the ligament below the hole holds the halves together", self.depth),
        );
        let (name, value) = match self.configuration {
            Configuration::Axisymmetric { outer_radius: Some(radius) } => ("outer_radius", radius),
            _ => ("width", self.width),
        };
        let (half, radius) = (self.half_width(), 0.5 * self.fibre_diameter);
        let requirement =
            format!("such that the block reaches beyond the fibre's radius {radius}: it reaches {half:.4}");
        // a value that is not positive is reported already
        let is_reported = value.is_nan() || value <= 0.0;
        required.that(half > radius || is_reported, name, value, requirement);
        if let Configuration::Axisymmetric { outer_radius: Some(radius) } = self.configuration {
            required.positive([("outer_radius", radius)]);
        }
        if !self.is_axisymmetric() {
            self.thickness().check(self.cover, &mut required);
        }
        for (name, asked) in [("cover", self.cover), ("graded_thickness", self.graded_thickness.is_some())] {
            required.that(!asked || !self.is_axisymmetric(), name, "given", "left out of a body of revolution");
        }
        let mesh = &self.mesh;
        required.count([
            ("embedded_elements", mesh.embedded_elements),
            ("elements_across", mesh.elements_across),
            ("slave_edges_per_master", mesh.slave_edges_per_master),
        ]);
        required.that(mesh.growth >= 1.0 && mesh.growth.is_finite(), "growth", mesh.growth, "at least 1");
        if let Some(size) = mesh.exit_size {
            let fits = size > 0.0 && size < self.embedded_length;
            let requirement = format!("positive and less than the embedded_length {}", self.embedded_length);
            required.that(fits, "exit_size", size, requirement);
        }
        if !self.is_axisymmetric() {
            required.nodes_on_axis(self.fibre_element, mesh.elements_across);
        }
        required.check()
    }
}

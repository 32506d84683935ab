//! What the parameters of an inclined fibre must be.

use super::{InclinedFibre, Outside};
use crate::element::{EdgeKind, ElementKind};
use crate::kinematics::PlaneModel;
use crate::mesh::specimen::SpecimenError;
use crate::mesh::specimen::perpendicular_fibre::FibreSection;
use crate::mesh::specimen::requirement::Requirements;

/// Inclinations below this, degrees.
const LARGEST_ANGLE: f64 = 80.0;

impl InclinedFibre {
    /// All that must hold of the parameters.
    pub(super) fn check(&self) -> Result<(), SpecimenError> {
        let mut required = Requirements::default();
        let mesh = &self.mesh;
        for (name, value) in [
            ("width", self.width),
            ("depth", self.depth),
            ("matrix_thickness", self.matrix_thickness),
            ("fibre_diameter", self.fibre_diameter),
            ("embedded_length", self.embedded_length),
            ("exit_radius", self.exit_radius()),
            ("mesh_size", mesh.size),
            ("exit_size", self.exit_size()),
            ("largest_fibre_size", mesh.largest_fibre_size),
            ("growth_rate", mesh.growth_rate),
            ("largest_size", mesh.largest_size),
        ] {
            required.positive(name, value);
        }
        let degrees = self.angle.to_degrees();
        let is_angle = (0.0..=LARGEST_ANGLE).contains(&degrees);
        required.that(is_angle, "angle_deg", degrees, format!("between 0 and {LARGEST_ANGLE}"));
        let (separation, fine, embedded) = (self.separation_length, self.fine_length(), self.embedded_length);
        let requirement = format!("0 or positive, and less than the embedded_length {embedded}");
        required.that((0.0..embedded).contains(&separation), "separation_length", separation, requirement);
        let requirement = format!("0 or positive, and not more than the embedded_length {embedded}");
        required.that((0.0..=embedded).contains(&fine), "fine_length", fine, requirement);
        self.check_outside(&mut required);
        self.thickness().check(self.cover, &mut required);
        self.check_room(&mut required);
        required.count("elements_across", mesh.elements_across);
        let middle = self.fibre.kind.edge_kind() == EdgeKind::Quadratic || mesh.elements_across.is_multiple_of(2);
        let requirement = format!("even with {}: the fibre needs nodes on its axis", self.fibre.kind);
        required.that(middle, "elements_across", mesh.elements_across, requirement);
        let triangles = matches!(self.matrix.kind, ElementKind::T3 | ElementKind::T6);
        required.that(triangles, "matrix_element", self.matrix.kind, "T6 or T3: the block is filled with triangles");
        for (name, model) in [("fibre_model", self.fibre_model), ("matrix_model", self.matrix_model)] {
            let plane = model != PlaneModel::Axisymmetric;
            required.that(plane, name, "axisymmetric", "plane stress or plane strain");
        }
        if let FibreSection::Thickness(thickness) = self.section {
            required.positive("fibre_section", thickness);
        }
        required.check()
    }

    fn check_outside(&self, required: &mut Requirements) {
        match self.outside {
            Outside::Bent { radius, length } => {
                required.positive("free_length", length);
                let (radius, half) = (radius.unwrap_or(1.5 * self.fibre_diameter), 0.5 * self.fibre_diameter);
                let fits = radius > half && radius.is_finite();
                required.that(fits, "bend_radius", radius, format!("more than half of the fibre_diameter, {half}"));
            }
            Outside::Straight { length } => {
                required.that(length >= 0.0 && length.is_finite(), "free_length", length, "0 or positive");
            }
        }
    }

    /// The block must hold the whole fibre and its exit. What is no number has been told already.
    fn check_room(&self, required: &mut Requirements) {
        let (sine, cosine) = self.angle.sin_cos();
        let radius = 0.5 * self.fibre_diameter;
        let reach = self.embedded_length * sine + radius * cosine;
        required.that(
            reach.is_nan() || reach < 0.5 * self.width,
            "embedded_length",
            self.embedded_length,
            format!(
                "such that the fibre stays in the block: it reaches {reach:.3} sideways, half of the width is {}",
                0.5 * self.width
            ),
        );
        let deep = self.embedded_length * cosine + radius * sine;
        required.that(
            deep.is_nan() || deep < self.depth,
            "embedded_length",
            self.embedded_length,
            format!("such that the fibre stays in the block: it reaches {deep:.3} deep, the depth is {}", self.depth),
        );
        // the rounded edge of the acute wedge
        let wedge = radius / cosine + self.exit_radius() * (1.0 + sine) / cosine;
        let requirement = format!("such that the exit's edge, {wedge:.3} beside the axis, stays within the width");
        required.that(wedge.is_nan() || wedge < 0.5 * self.width, "exit_radius", self.exit_radius(), requirement);
        let start = (self.exit_radius() * (1.0 + sine) + radius * sine) / cosine;
        let requirement = format!("such that the exit's edge, {start:.3} deep along the fibre, ends above its tail");
        required.that(start.is_nan() || start < self.embedded_length, "exit_radius", self.exit_radius(), requirement);
    }
}

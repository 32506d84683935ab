//! The section of a round fibre in the plane: it has the area of the circle or its bending inertia, not both.

use super::PulloutProgram;
use super::fibre::FibreGeometry;
use crate::number::significant;
use fe_core::assembly::Solids;
use fe_core::kinematics::PlaneModel;
use fe_core::mesh::Element;
use std::f64::consts::PI;

/// Thickness of a plane fibre over its height, the diameter, for the area of the circle.
pub const EQUAL_AREA: f64 = PI / 4.0;
/// Thickness of a plane fibre relative to its height, the diameter, that gives the bending inertia of the circle.
pub const EQUAL_INERTIA: f64 = 3.0 * PI / 16.0;

/// Share of the work that the fibre's yielding takes up to which its section does not matter.
const SMALL_SHARE: f64 = 0.05;
/// Part of the bending inertia by which the section may miss the round one without a warning.
const INERTIA_TOLERANCE: f64 = 0.1;

/// Warns of a fibre that yields while its section bends otherwise than the round one, with the share of the work that this
/// concerns.
pub fn warning(program: &PulloutProgram, solids: &Solids, work: f64) -> Option<String> {
    let diameter = program.fibre_diameter?;
    let index = FibreGeometry::of(&program.model)?.part;
    let part = program.model.mesh.parts().get(index).filter(|part| part.model != PlaneModel::Axisymmetric)?;
    // layers have the plastic moment of the circle
    let is_layer = |element: &Element| element.part() == index && element.thickness() != part.thickness;
    if program.model.mesh.elements().iter().any(is_layer) {
        return None;
    }
    let inertia = part.thickness / (EQUAL_INERTIA * diameter);
    let share = solids.part_energies().get(index)?.plastic / work.abs();
    (share > SMALL_SHARE && share.is_finite() && (inertia - 1.0).abs() > INERTIA_TOLERANCE).then(|| {
        format!(
            "fibre: its yielding takes {} % of the work, and its section has {} times the bending inertia of the round one: \
             where it bends, that is by how much it is too stiff, and it yields under {} of the round one's plastic moment \
             (parts.{}.thickness \"layers\" with elements_across 4 has its area and plastic moment)",
            significant(100.0 * share, 2),
            significant(inertia, 3),
            significant(1.5 * part.thickness / diameter, 3),
            part.name
        )
    })
}

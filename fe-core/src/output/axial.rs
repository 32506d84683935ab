//! The axial stress of a slender part.

use super::fields::{Fields, FieldsError};
use crate::element::MappedPoint;
use crate::mesh::Mesh;
use crate::plane::{distance, dot, minus};

/// Mean axial stress of a part's cross-sections along its axis: pairs of arc length, mm, and stress, MPa.
///
/// `axis` is a polyline through reference positions. Its length is cut into `sections` equal pieces; each integration
/// point of the part counts, with its area (its volume in axial symmetry), for the piece that holds the point of the axis nearest to it. The stress is
/// t·σt with t the axis's direction, turned with the body by the deformation gradient; the arc length is the mean of the
/// piece's points. A stress that is linear along a straight axis is reproduced; times the cross-section it is the axial
/// force. Pieces without points are left out, and there are none along an axis of one place.
pub fn axial_stress(
    mesh: &Mesh,
    fields: &Fields,
    part: usize,
    axis: &[[f64; 2]],
    sections: usize,
) -> Result<Vec<(f64, f64)>, FieldsError> {
    fields.check(mesh)?;
    let length: f64 = axis.windows(2).map(|ends| distance(ends[1], ends[0])).sum();
    // volume, its first moment along the axis, and the stress's integral
    let mut sums = vec![[0.0; 3]; sections];
    let mut stresses = fields.stresses.iter();
    for (index, element) in mesh.elements().iter().enumerate() {
        let (positions, count) = mesh.element_positions(index);
        for (point, &[s11, s22, _, s12]) in mesh.integration_points(index).iter().zip(stresses.by_ref()) {
            let Ok(mapped) = MappedPoint::new(element.kind(), &positions[..count], point.coordinates) else { continue };
            let Some((arc, direction)) = projected(axis, mapped.position).filter(|_| element.part() == part) else {
                continue;
            };
            let [x, y] = turned(fields, element.nodes(), &mapped, direction);
            let depth = mesh.parts()[part].model.depth(mapped.position[0], element.thickness());
            let weight = point.weight * mapped.determinant * depth;
            let section = (arc / length * sections as f64) as usize;
            if let Some(sum) = sums.get_mut(section.min(sections.saturating_sub(1))) {
                let stress = s11 * x * x + 2.0 * s12 * x * y + s22 * y * y;
                *sum = [sum[0] + weight, sum[1] + weight * arc, sum[2] + weight * stress];
            }
        }
    }
    let filled = sums.into_iter().filter(|[volume, ..]| *volume > 0.0);
    Ok(filled.map(|[volume, moment, integral]| (moment / volume, integral / volume)).collect())
}

/// Arc length and direction of a polyline at its point nearest to a position.
fn projected(axis: &[[f64; 2]], position: [f64; 2]) -> Option<(f64, [f64; 2])> {
    let mut nearest: Option<(f64, f64, [f64; 2])> = None;
    let mut start_arc = 0.0;
    for ends in axis.windows(2) {
        let along = minus(ends[1], ends[0]);
        let length = along[0].hypot(along[1]);
        if length > 0.0 {
            let direction = along.map(|component| component / length);
            let offset = minus(position, ends[0]);
            let within = dot(offset, direction).clamp(0.0, length);
            let distance = (offset[0] - within * direction[0]).hypot(offset[1] - within * direction[1]);
            if nearest.is_none_or(|(least, ..)| distance < least) {
                nearest = Some((distance, start_arc + within, direction));
            }
        }
        start_arc += length;
    }
    nearest.map(|(_, arc, direction)| (arc, direction))
}

/// F t, to unit length.
fn turned(fields: &Fields, nodes: &[usize], mapped: &MappedPoint, [x, y]: [f64; 2]) -> [f64; 2] {
    let mut direction = [x, y];
    for (&node, gradient) in nodes.iter().zip(mapped.shape.derivatives()) {
        let along = gradient[0] * x + gradient[1] * y;
        for k in 0..2 {
            direction[k] += fields.displacements[2 * node + k] * along;
        }
    }
    let length = direction[0].hypot(direction[1]);
    direction.map(|component| component / length)
}

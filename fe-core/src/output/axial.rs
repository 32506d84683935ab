//! The axial stress of a slender part.

use super::fields::{Fields, FieldsError};
use crate::element::MappedPoint;
use crate::mesh::Mesh;
use crate::plane::{dot, minus, range};

/// Mean axial stress of a part's cross-sections along its axis: pairs of arc length, mm, and stress, MPa.
///
/// `axis` is a polyline through reference positions. Elements that lie side by side along it form a cross-section, and where there are more than
/// `sections` of them, neighbours are taken together. The stress is t·σt with t the axis's direction, turned with the body by the deformation
/// gradient. Each integration point counts with its area across the axis: in a bend, where the outer side is longer, both sides count alike,
/// so that bending has no part in the mean. A stress that is linear along a straight axis is reproduced; times the cross-section it is the
/// axial force. There are no sections along an axis of one place.
pub fn axial_stress(
    mesh: &Mesh,
    fields: &Fields,
    part: usize,
    axis: &[[f64; 2]],
    sections: usize,
) -> Result<Vec<(f64, f64)>, FieldsError> {
    fields.check(mesh)?;
    let mut places = Vec::new();
    let mut stresses = fields.stresses.iter();
    for (index, element) in mesh.elements().iter().enumerate() {
        let (positions, count) = mesh.element_positions(index);
        let place = (element.part() == part).then(|| Place::new(axis, &positions[..count])).flatten();
        let mut sums = [0.0; 3];
        for (point, &[s11, s22, _, s12]) in mesh.integration_points(index).iter().zip(stresses.by_ref()) {
            let Some(place) = &place else { continue };
            let Ok(mapped) = MappedPoint::new(element.kind(), &positions[..count], point.coordinates) else { continue };
            let Some((arc, direction)) = projected(axis, mapped.position) else { continue };
            let [x, y] = turned(fields, element.nodes(), &mapped, direction);
            let depth = mesh.parts()[part].model.depth(mapped.position[0], element.thickness());
            let area = point.weight * mapped.determinant * depth / place.length;
            let stress = s11 * x * x + 2.0 * s12 * x * y + s22 * y * y;
            sums = add(sums, [area, area * arc, area * stress]);
        }
        places.extend(place.map(|place| (place, sums)));
    }
    places.sort_by(|a, b| a.0.middle.total_cmp(&b.0.middle));
    // the middle of a section's first element, and sums of area, its moment along the axis and the stress's integral
    let mut columns: Vec<(f64, [f64; 3])> = Vec::new();
    for (place, sums) in places {
        match columns.last_mut() {
            Some((first, column)) if place.middle - *first <= 0.5 * place.extent => *column = add(*column, sums),
            _ => columns.push((place.middle, sums)),
        }
    }
    let count = sections.min(columns.len());
    let mut sums = vec![[0.0; 3]; count];
    for (index, (_, column)) in columns.iter().enumerate() {
        if let Some(sum) = sums.get_mut(index * count / columns.len()) {
            *sum = add(*sum, *column);
        }
    }
    let filled = sums.into_iter().filter(|[area, ..]| *area > 0.0);
    Ok(filled.map(|[area, moment, integral]| (moment / area, integral / area)).collect())
}

/// Where an element lies along an axis.
struct Place {
    /// Arc length of its middle, mm.
    middle: f64,
    /// Difference of its nodes' arc lengths, mm.
    extent: f64,
    /// How long it is itself, mm: on the outer side of a bend it is longer than its piece of the axis.
    length: f64,
}

impl Place {
    fn new(axis: &[[f64; 2]], nodes: &[[f64; 2]]) -> Option<Self> {
        let centre = nodes.iter().fold([0.0; 2], |[x, y], node| [x + node[0], y + node[1]]);
        let (_, direction) = projected(axis, centre.map(|sum| sum / nodes.len() as f64))?;
        let arcs = nodes.iter().filter_map(|&node| projected(axis, node)).map(|(arc, _)| arc);
        let [from, to] = range(arcs);
        let [start, end] = range(nodes.iter().map(|&node| dot(node, direction)));
        Some(Self { middle: 0.5 * (from + to), extent: to - from, length: end - start })
    }
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + b[k])
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

//! The axial stress of a slender part.

use super::fields::{Fields, FieldsError};
use crate::element::MappedPoint;
use crate::mesh::{ElementEdge, Mesh};
use crate::plane::{dot, minus, range};
use std::f64::consts::FRAC_1_SQRT_2;

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
    let column_of = columns_along(mesh, part, axis);
    // sums of area, its moment along the axis and the stress's integral
    let mut columns = vec![[0.0; 3]; column_of.iter().flatten().max().map_or(0, |last| last + 1)];
    let mut stresses = fields.stresses.iter();
    for (index, (element, column)) in mesh.elements().iter().zip(column_of).enumerate() {
        let (positions, count) = mesh.element_positions(index);
        let length = column.and_then(|_| length_along(axis, &positions[..count]));
        for (point, &[s11, s22, _, s12]) in mesh.integration_points(index).iter().zip(stresses.by_ref()) {
            let (Some(column), Some(length)) = (column, length) else { continue };
            let Ok(mapped) = MappedPoint::new(element.kind(), &positions[..count], point.coordinates) else { continue };
            let Some((arc, direction)) = projected(axis, mapped.position) else { continue };
            let [x, y] = turned(fields, element.nodes(), &mapped, direction);
            let depth = mesh.parts()[part].model.depth(mapped.position[0], element.thickness());
            let area = point.weight * mapped.determinant * depth / length;
            let stress = s11 * x * x + 2.0 * s12 * x * y + s22 * y * y;
            columns[column] = add(columns[column], [area, area * arc, area * stress]);
        }
    }
    columns.retain(|[area, ..]| *area > 0.0);
    columns.sort_by(|[a, p, _], [b, q, _]| (p / a).total_cmp(&(q / b)));
    let count = sections.min(columns.len());
    let mut sums = vec![[0.0; 3]; count];
    for (index, column) in columns.iter().enumerate() {
        if let Some(sum) = sums.get_mut(index * count / columns.len()) {
            *sum = add(*sum, *column);
        }
    }
    Ok(sums.into_iter().map(|[area, moment, integral]| (moment / area, integral / area)).collect())
}

/// Numbers the cross-sections of a part: elements lie in one if they share an edge that runs along the axis rather than across it. No
/// places decide: where a bend begins, the middles of elements of one cross-section lie apart along the axis. Other parts' elements have
/// no number.
fn columns_along(mesh: &Mesh, part: usize, axis: &[[f64; 2]]) -> Vec<Option<usize>> {
    let elements = mesh.elements();
    let mut columns = vec![None; elements.len()];
    let mut count = 0;
    for first in 0..elements.len() {
        if elements[first].part() != part || columns[first].is_some() {
            continue;
        }
        let mut open = vec![first];
        columns[first] = Some(count);
        while let Some(element) = open.pop() {
            for edge in 0..elements[element].kind().corner_count() {
                let edge = ElementEdge { element, edge };
                let Some(other) = mesh.neighbour(edge).map(|other| other.element) else { continue };
                if elements[other].part() == part && columns[other].is_none() && runs_along(mesh, edge, axis) {
                    columns[other] = Some(count);
                    open.push(other);
                }
            }
        }
        count += 1;
    }
    columns
}

fn runs_along(mesh: &Mesh, edge: ElementEdge, axis: &[[f64; 2]]) -> bool {
    let [start, end, _] = mesh.edge_positions(&mesh.edge_nodes(edge), None);
    let middle = std::array::from_fn(|k| 0.5 * (start[k] + end[k]));
    let [x, y] = minus(end, start);
    projected(axis, middle).is_some_and(|(_, direction)| dot([x, y], direction).abs() > FRAC_1_SQRT_2 * x.hypot(y))
}

/// Returns how long an element is along the axis, mm: on the outer side of a bend it is longer than its piece of the axis.
fn length_along(axis: &[[f64; 2]], nodes: &[[f64; 2]]) -> Option<f64> {
    let centre = nodes.iter().fold([0.0; 2], |[x, y], node| [x + node[0], y + node[1]]);
    let (_, direction) = projected(axis, centre.map(|sum| sum / nodes.len() as f64))?;
    let [start, end] = range(nodes.iter().map(|&node| dot(node, direction)));
    Some(end - start)
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

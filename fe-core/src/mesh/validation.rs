//! The checks of a mesh definition, except those of its connections, which [`super::topology`] checks as it finds them.

use std::collections::{BTreeMap, HashSet};

use super::{Element, ElementDefinition, MeshDefinition, MeshError, Part};
use crate::element::{ElementKind, IntegrationPoint, MAX_NODES, MappedPoint, MappingError};
use crate::kinematics::PlaneModel;
use crate::plane::range;

/// det J below this fraction of the square of the element's diagonal is refused. It is a difference of products as large
/// as that square, so rounding leaves about 1e-16 of it: 1e-10 keeps six digits and still allows slivers of 1 : 1e9.
pub const SMALLEST_RELATIVE_DETERMINANT: f64 = 1e-10;

/// Returns the number of an index in messages; the index may be any.
fn number(index: usize) -> usize {
    index.saturating_add(1)
}

fn unsound<T>(fault: String) -> Result<T, MeshError> {
    Err(MeshError(fault))
}

pub(super) fn check_nodes(definition: &MeshDefinition) -> Result<(), MeshError> {
    match definition.nodes.iter().zip(1..).find(|(position, _)| !position.iter().all(|x| x.is_finite())) {
        Some(([x, y], node)) => unsound(format!("node {node}: its position ({x}, {y}) is not finite")),
        None => Ok(()),
    }
}

pub(super) fn check_parts(definition: &MeshDefinition) -> Result<(), MeshError> {
    let mut first_with = BTreeMap::new();
    for (Part { name, thickness, .. }, second) in definition.parts.iter().zip(1..) {
        if let Some(first) = first_with.insert(name.as_str(), second) {
            return unsound(format!("parts {first} and {second} are both called '{name}'"));
        }
        if !(*thickness > 0.0 && thickness.is_finite()) {
            return unsound(format!("part '{name}': its thickness is {thickness}, it must be positive"));
        }
    }
    Ok(())
}

pub(super) fn checked_elements(definition: &MeshDefinition) -> Result<Vec<Element>, MeshError> {
    if definition.elements.is_empty() {
        return unsound("the mesh has no elements".to_owned());
    }
    let count = definition.elements.len();
    let is_sound = |own: &(&usize, &f64)| *own.0 < count && *own.1 > 0.0 && own.1.is_finite();
    if let Some((&element, &thickness)) = definition.thicknesses.iter().find(|own| !is_sound(own)) {
        let what = format!("its thickness is {thickness}, it must be positive, of one of the {count} elements");
        return unsound(format!("element {}: {what}", number(element)));
    }
    (0..definition.elements.len()).map(|element| checked_element(definition, element)).collect()
}

fn checked_element(definition: &MeshDefinition, element: usize) -> Result<Element, MeshError> {
    check_node_indices(definition, element)?;
    let ElementDefinition { kind, part: part_index, ref nodes } = definition.elements[element];
    let refuse = |fault: String| MeshError::of_element(element, kind, &fault);
    let no_part =
        || refuse(format!("its part {} does not exist, the mesh has {}", number(part_index), definition.parts.len()));
    let part = definition.parts.get(part_index).ok_or_else(no_part)?;
    let integration = part.integration.unwrap_or(kind.default_integration());
    let no_rule =
        || refuse(format!("part '{}' asks for {integration} integration, which {kind} does not have", part.name));
    let points = kind.integration_points(integration).ok_or_else(no_rule)?;
    if part.model == PlaneModel::Axisymmetric
        && let Some(&node) = nodes.iter().find(|&&node| definition.nodes[node][0] < 0.0)
    {
        let (node, radius) = (node + 1, definition.nodes[node][0]);
        let what = format!("node {node} has the radius {radius}, negative in the axisymmetric part '{}'", part.name);
        return Err(refuse(what));
    }
    let positions: Vec<[f64; 2]> = nodes.iter().map(|&node| definition.nodes[node]).collect();
    checked_area(definition, element, &positions, points)?;
    // Any rule gives the area; the full one sees folds that the reduced one misses.
    let area = checked_area(definition, element, &positions, kind.full_integration_points())?;
    if let Some(fold) = folded_corner(kind, &positions) {
        return Err(refuse(fold));
    }
    let mut indices = [0; MAX_NODES];
    indices[..nodes.len()].copy_from_slice(nodes);
    let thickness = definition.thicknesses.get(&element).copied().unwrap_or(part.thickness);
    Ok(Element { kind, part: part_index, nodes: indices, area, thickness })
}

fn check_node_indices(definition: &MeshDefinition, element: usize) -> Result<(), MeshError> {
    let ElementDefinition { kind, ref nodes, .. } = definition.elements[element];
    let refuse = |fault: String| Err(MeshError::of_element(element, kind, &fault));
    if nodes.len() != kind.node_count() {
        return refuse(format!("it has {} nodes, {kind} needs {}", nodes.len(), kind.node_count()));
    }
    let count = definition.nodes.len();
    for (position, &node) in nodes.iter().enumerate() {
        if node >= count {
            return refuse(format!("its node {} does not exist, the mesh has {count}", number(node)));
        }
        if nodes[..position].contains(&node) {
            return refuse(format!("it has node {} twice", node + 1));
        }
    }
    Ok(())
}

/// The area by these points, each of which must have a sound Jacobian and, about an axis, a radius.
fn checked_area(
    definition: &MeshDefinition,
    element: usize,
    positions: &[[f64; 2]],
    points: &[IntegrationPoint],
) -> Result<f64, MeshError> {
    let ElementDefinition { kind, part, .. } = definition.elements[element];
    let part = &definition.parts[part];
    let refuse = |fault: String| MeshError::of_element(element, kind, &fault);
    let mut area = 0.0;
    let diagonal_squared = diagonal_squared(positions);
    for (integration_point, point) in points.iter().zip(1..) {
        let folded = |error: MappingError| {
            refuse(format!("at integration point {point} {error} (nodes go counter-clockwise; is it folded?)"))
        };
        let MappedPoint { position: [radius, _], determinant, .. } =
            MappedPoint::new(kind, positions, integration_point.coordinates).map_err(folded)?;
        if determinant < SMALLEST_RELATIVE_DETERMINANT * diagonal_squared {
            let place = format!("at integration point {point} the Jacobian determinant is {determinant:.3e}");
            let lost = format!("lost in rounding against its diagonal squared, {diagonal_squared:.3e}");
            return Err(refuse(format!("{place}, {lost}")));
        }
        if part.model == PlaneModel::Axisymmetric && radius <= 0.0 {
            let what = format!("not positive in the axisymmetric part '{}'", part.name);
            return Err(refuse(format!("integration point {point} has the radius {radius}, {what}")));
        }
        area += integration_point.weight * determinant;
    }
    Ok(area)
}

/// Says at which corner an element is folded: a middle node is nearer to it than a quarter of the edge, or the corner points
/// inwards. The element covers its place twice there, and no integration point need see it. Quarter points, which make det J 0
/// around the tip of a crack, are no folds.
pub(super) fn folded_corner(kind: ElementKind, positions: &[[f64; 2]]) -> Option<String> {
    let rounding = SMALLEST_RELATIVE_DETERMINANT * diagonal_squared(positions);
    let corners = &kind.reference_coordinates()[..kind.corner_count()];
    (1..).zip(corners).find_map(|(corner, &place)| match MappedPoint::new(kind, positions, place) {
        Err(MappingError::Jacobian { determinant }) if determinant < -rounding => {
            Some(format!("at its corner {corner} the Jacobian determinant is {determinant:.3e}; it is folded there"))
        }
        _ => None,
    })
}

/// The square of the diagonal of the box around these positions.
fn diagonal_squared(positions: &[[f64; 2]]) -> f64 {
    (0..2)
        .map(|k| {
            let [low, high] = range(positions.iter().map(|position| position[k]));
            (high - low) * (high - low)
        })
        .sum()
}

pub(super) fn check_sets(definition: &MeshDefinition) -> Result<(), MeshError> {
    let count = definition.nodes.len();
    for (name, nodes) in &definition.node_sets {
        let mut seen = HashSet::new();
        if nodes.is_empty() {
            return unsound(format!("node set '{name}' is empty"));
        }
        for &node in nodes {
            if node >= count {
                return unsound(format!(
                    "node set '{name}': node {} does not exist, the mesh has {count}",
                    number(node)
                ));
            }
            if !seen.insert(node) {
                return unsound(format!("node set '{name}' has node {} twice", node + 1));
            }
        }
    }
    for (name, edges) in &definition.edge_sets {
        let mut seen = HashSet::new();
        if edges.is_empty() {
            return unsound(format!("edge set '{name}' is empty"));
        }
        for &edge in edges {
            let exists = definition.elements.get(edge.element).is_some_and(|e| edge.edge < e.kind.corner_count());
            let what = || format!("edge {} of element {}", number(edge.edge), number(edge.element));
            if !exists {
                return unsound(format!("edge set '{name}': {} does not exist", what()));
            }
            if !seen.insert(edge) {
                return unsound(format!("edge set '{name}' has {} twice", what()));
            }
        }
    }
    Ok(())
}

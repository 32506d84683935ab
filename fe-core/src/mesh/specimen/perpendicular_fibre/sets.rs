//! The named sets of a fibre in a block.

use super::PerpendicularFibre;
use super::lines::Lines;
use crate::mesh::specimen::{ContactSurfaces, SurfaceRole, contact_width};
use crate::mesh::structured::{Grid, Side};
use crate::mesh::{ElementEdge, MeshDefinition};

/// Grip, sides or outer surface and axis, bottom.
pub(super) fn name_outer_sets(
    mesh: &mut MeshDefinition,
    parameters: &PerpendicularFibre,
    fibre: &Grid,
    matrix: &Grid,
    lines: &Lines,
) {
    mesh.node_set("grip", fibre.side_nodes(Side::Top));
    mesh.node_set("bottom", matrix.side_nodes(Side::Bottom));
    if parameters.is_axisymmetric() {
        mesh.node_set("outer", matrix.side_nodes(Side::Right));
        mesh.node_set("axis", fibre.side_nodes(Side::Left));
        mesh.node_set("axis", (0..=2 * lines.ligament_rows).filter_map(|j| matrix.node(0, j)));
    } else {
        mesh.node_set("sides", matrix.side_nodes(Side::Left));
        mesh.node_set("sides", matrix.side_nodes(Side::Right));
    }
}

/// The edge sets; returns the contact pairs.
pub(super) fn name_surfaces(
    mesh: &mut MeshDefinition,
    parameters: &PerpendicularFibre,
    fibre: &Grid,
    matrix: &Grid,
    lines: &Lines,
) -> Vec<ContactSurfaces> {
    let (first, end, top) = (lines.middle_columns.start, lines.middle_columns.end, matrix.rows - 1);
    let face = [end..matrix.columns, 0..first].map(|columns| matrix.edges(columns, top..matrix.rows, Side::Top));
    mesh.edge_set("exit_face", face.concat());
    mesh.edge_set("bottom_face", matrix.side_edges(Side::Bottom));
    mesh.edge_set("fibre_tail", fibre.side_edges(Side::Bottom));
    mesh.edge_set("hole_end", matrix.edges(first..end, lines.ligament_rows - 1..lines.ligament_rows, Side::Top));
    let along = lines.rows_below_fibre..matrix.rows;
    let mut pair = |name: &str, hole: (&str, Vec<ElementEdge>), surface: (&str, Side)| {
        mesh.edge_set(hole.0, hole.1);
        mesh.edge_set(surface.0, fibre.side_edges(surface.1));
        ContactSurfaces {
            name: name.to_owned(),
            slave: hole.0.to_owned(),
            master: surface.0.to_owned(),
            role: SurfaceRole::Bonded,
            width: (!parameters.is_axisymmetric()).then(|| contact_width(parameters.fibre_diameter)),
        }
    };
    let right_wall = matrix.edges(end..end + 1, along.clone(), Side::Left);
    if parameters.is_axisymmetric() {
        return vec![pair("interface", ("hole_surface", right_wall), ("fibre_surface", Side::Right))];
    }
    let left_wall = matrix.edges(first - 1..first, along, Side::Right);
    vec![
        pair("interface_left", ("hole_left", left_wall), ("fibre_left", Side::Left)),
        pair("interface_right", ("hole_right", right_wall), ("fibre_right", Side::Right)),
    ]
}

/// Supports (b) and (c); returns what is missing.
pub(super) fn name_supports_of_face(
    mesh: &mut MeshDefinition,
    parameters: &PerpendicularFibre,
    matrix: &Grid,
) -> Vec<String> {
    let mut missing = Vec::new();
    for (name, limit) in std::iter::zip(["face_near", "face_away"], parameters.support_limits()) {
        match limit {
            Some(limit) => {
                // Nodes lie on the stops to the bit.
                let distance = |stop: &f64| (stop - limit).abs();
                let stops = parameters.stops().into_iter();
                let reach = stops.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(limit);
                let face = matrix.side_nodes(Side::Top);
                let nodes: Vec<usize> = face.into_iter().filter(|&node| mesh.nodes[node][0].abs() >= reach).collect();
                mesh.node_set(name, nodes);
            }
            None => missing.push(format!("the block is too narrow for the support '{name}'")),
        }
    }
    missing
}

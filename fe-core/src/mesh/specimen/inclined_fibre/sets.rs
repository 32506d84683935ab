//! The named sets of an inclined fibre in a block, and how its end hangs on a node.

use super::InclinedFibre;
use super::outline::{Surface, SurfaceEdges};
use crate::element::EdgeKind;
use crate::mesh::specimen::perpendicular_fibre::{AWAY_LENGTH, NEAR_CLEARANCE};
use crate::mesh::specimen::{ContactSurfaces, NodeCoupling, SurfaceRole};
use crate::mesh::structured::{Grid, Side, StructuredMesh};
use crate::mesh::{ElementEdge, MeshDefinition};

/// Where supports (b) and (c) begin on the left and on the right of the hole, x in mm: those that the block has room for.
pub(super) fn support_limits(parameters: &InclinedFibre) -> [[f64; 2]; 2] {
    let (half, phi) = (0.5 * parameters.width, parameters.fibre_diameter);
    // where the walls would meet the face without a rounded edge
    let corner = 0.5 * phi / parameters.angle.cos();
    [-1.0, 1.0].map(|side| [side * (corner + NEAR_CLEARANCE * phi), side * (half - AWAY_LENGTH)])
}

/// Ends and sides of the fibre.
pub(super) fn name_fibre_sets(mesh: &mut StructuredMesh, fibre: &Grid) {
    mesh.node_set("grip", fibre.side_nodes(Side::Right));
    mesh.edge_set("fibre_tail", fibre.side_edges(Side::Left));
    mesh.edge_set("fibre_right", fibre.side_edges(Side::Bottom));
    mesh.edge_set("fibre_left", fibre.side_edges(Side::Top));
}

/// The edge sets of the block; returns the contact pairs.
pub(super) fn name_surfaces(definition: &mut MeshDefinition, edges: &SurfaceEdges) -> Vec<ContactSurfaces> {
    let mut pairs = Vec::new();
    for (&surface, edges) in edges {
        let (name, pair) = match surface {
            Surface::Bottom => ("bottom_face", None),
            Surface::Sides => continue,
            Surface::Face => ("exit_face", None),
            Surface::HoleEnd => ("hole_end", None),
            Surface::Beyond => ("hole_beyond", None),
            Surface::HoleLeft => ("hole_left", Some(("interface_left", "fibre_left", SurfaceRole::Bonded))),
            Surface::HoleRight => ("hole_right", Some(("interface_right", "fibre_right", SurfaceRole::Bonded))),
            Surface::SeparationLeft => {
                ("hole_separation_left", Some(("separation_left", "fibre_left", SurfaceRole::Separation)))
            }
            Surface::SeparationRight => {
                ("hole_separation_right", Some(("separation_right", "fibre_right", SurfaceRole::Separation)))
            }
            Surface::ExitLeft => ("hole_exit_left", Some(("exit_left", "fibre_left", SurfaceRole::Exit))),
            Surface::ExitRight => ("hole_exit_right", Some(("exit_right", "fibre_right", SurfaceRole::Exit))),
        };
        definition.edge_sets.insert(name.to_owned(), edges.clone());
        pairs.extend(pair.map(|(pair, master, role)| ContactSurfaces {
            name: pair.to_owned(),
            slave: name.to_owned(),
            master: master.to_owned(),
            role,
        }));
    }
    pairs
}

/// Sides, bottom, and supports (b) and (c); returns what is missing.
pub(super) fn name_supports(
    definition: &mut MeshDefinition,
    parameters: &InclinedFibre,
    edges: &SurfaceEdges,
) -> Vec<String> {
    let [[near_left, away_left], [near_right, away_right]] = support_limits(parameters);
    let mut missing = Vec::new();
    for (name, surface, between) in [
        ("sides", Surface::Sides, None),
        ("bottom", Surface::Bottom, None),
        ("face_near", Surface::Face, Some([near_left, near_right])),
        ("face_away", Surface::Face, Some([away_left, away_right])),
    ] {
        let nodes = edges[&surface].iter().flat_map(|&edge| nodes_of(definition, edge));
        let beyond =
            |x: f64| between.is_none_or(|[left, right]| x <= left + rounding(left) || x >= right - rounding(right));
        let mut nodes: Vec<usize> = nodes.filter(|&node| beyond(definition.nodes[node][0])).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let [left, right] = [-1.0, 1.0].map(|side| nodes.iter().any(|&node| definition.nodes[node][0] * side > 0.0));
        if left && right {
            definition.node_sets.insert(name.to_owned(), nodes);
        } else {
            missing.push(format!("the block is too narrow for the support '{name}'"));
        }
    }
    missing
}

fn rounding(x: f64) -> f64 {
    1e-9 * x.abs()
}

fn nodes_of(definition: &MeshDefinition, edge: ElementEdge) -> Vec<usize> {
    let element = &definition.elements[edge.element];
    let corners = element.kind.corner_count();
    let mut nodes = vec![element.nodes[edge.edge], element.nodes[(edge.edge + 1) % corners]];
    if element.kind.edge_kind() == EdgeKind::Quadratic {
        nodes.push(element.nodes[corners + edge.edge]);
    }
    nodes
}

/// Adds a node that moves by the mean displacement of the fibre's outer end, and makes it the grip.
pub(super) fn hang_on_a_node(definition: &mut MeshDefinition, fibre: &Grid) -> NodeCoupling {
    // the consistent share of each node in a uniform traction on the end
    let mut shares: Vec<(usize, f64)> = Vec::new();
    let end = fibre.side_edges(Side::Right);
    for &edge in &end {
        let nodes = nodes_of(definition, edge);
        let weights: &[f64] = if nodes.len() == 3 { &[1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0] } else { &[0.5, 0.5] };
        for (&node, weight) in nodes.iter().zip(weights) {
            let share = weight / end.len() as f64;
            match shares.iter_mut().find(|(other, _)| *other == node) {
                Some((_, sum)) => *sum += share,
                None => shares.push((node, share)),
            }
        }
    }
    let grip = definition.nodes.len();
    let position = shares.iter().fold([0.0; 2], |[x, y], (node, share)| {
        let [n_x, n_y] = definition.nodes[*node];
        [x + share * n_x, y + share * n_y]
    });
    definition.nodes.push(position);
    definition.node_sets.insert("grip".to_owned(), vec![grip]);
    // Σ share u = u_grip, solved for the node with the largest share
    let largest = (0..shares.len()).max_by(|&a, &b| shares[a].1.total_cmp(&shares[b].1)).expect("an end has nodes");
    let (dependent, own) = shares.swap_remove(largest);
    let mut terms = vec![(grip, 1.0 / own)];
    terms.extend(shares.into_iter().map(|(node, share)| (node, -share / own)));
    NodeCoupling { dependent, terms }
}

//! The named sets of fibres in a block, and how an end hangs on a node.

use super::outline::{Surface, SurfaceEdges};
use super::{Fibre, Fibres, Laid};
use crate::mesh::MeshDefinition;
use crate::mesh::specimen::perpendicular_fibre::{AWAY_LENGTH, NEAR_CLEARANCE};
use crate::mesh::specimen::{ContactSurfaces, NodeCoupling, SurfaceRole, contact_width};
use crate::mesh::structured::{Grid, Side};

/// Returns where supports (b) and (c) begin on the left and on the right of the holes, x in mm: those that the block has room for.
pub(super) fn support_limits(parameters: &Fibres, laid: &[Laid<'_>]) -> [[f64; 2]; 2] {
    [-1.0, 1.0].map(|side| {
        let near = laid.iter().map(|Laid { fibre, path, .. }| {
            // where the walls would meet the face without a rounded edge
            let corner = 0.5 * fibre.diameter / path.lean(0.0).cos();
            side * fibre.exit + (corner + NEAR_CLEARANCE * fibre.diameter)
        });
        [side * near.fold(f64::NEG_INFINITY, f64::max), side * (0.5 * parameters.width - AWAY_LENGTH)]
    })
}

/// Ends and sides of a fibre.
pub(super) fn name_fibre_sets(definition: &mut MeshDefinition, fibre: &Fibre, grid: &Grid) {
    definition.node_set(&fibre.set("grip", ""), grid.side_nodes(Side::Right));
    definition.edge_set(&fibre.set("fibre", "tail"), grid.side_edges(Side::Left));
    definition.edge_set(&fibre.set("fibre", "right"), grid.side_edges(Side::Bottom));
    definition.edge_set(&fibre.set("fibre", "left"), grid.side_edges(Side::Top));
}

/// Makes the grips of fibres with names one set `grip` as well.
pub(super) fn join_grips(definition: &mut MeshDefinition, fibres: &[Fibre]) {
    let sets = fibres.iter().filter(|fibre| fibre.name.is_some()).map(|fibre| fibre.set("grip", ""));
    let nodes: Vec<usize> = sets.flat_map(|name| definition.node_sets[&name].clone()).collect();
    definition.node_sets.entry("grip".to_owned()).or_default().extend(nodes);
}

/// The edge sets of the block; returns the contact pairs.
pub(super) fn name_surfaces(
    definition: &mut MeshDefinition,
    fibres: &[Fibre],
    edges: &SurfaceEdges,
) -> Vec<ContactSurfaces> {
    let mut pairs = Vec::new();
    for (&(index, surface), edges) in edges {
        let fibre = &fibres[index];
        let (name, pair) = match surface {
            Surface::Bottom => ("bottom_face".to_owned(), None),
            Surface::Sides => continue,
            Surface::Face => ("exit_face".to_owned(), None),
            Surface::HoleEnd => (fibre.set("hole", "end"), None),
            Surface::Beyond => (fibre.set("hole", "beyond"), None),
            Surface::HoleLeft => (fibre.set("hole", "left"), Some(("interface", "left", SurfaceRole::Bonded))),
            Surface::HoleRight => (fibre.set("hole", "right"), Some(("interface", "right", SurfaceRole::Bonded))),
            Surface::SeparationLeft => {
                (fibre.set("hole", "separation_left"), Some(("separation", "left", SurfaceRole::Separation)))
            }
            Surface::SeparationRight => {
                (fibre.set("hole", "separation_right"), Some(("separation", "right", SurfaceRole::Separation)))
            }
            Surface::ExitLeft => (fibre.set("hole", "exit_left"), Some(("exit", "left", SurfaceRole::Exit))),
            Surface::ExitRight => (fibre.set("hole", "exit_right"), Some(("exit", "right", SurfaceRole::Exit))),
        };
        definition.edge_sets.insert(name.clone(), edges.clone());
        pairs.extend(pair.map(|(base, side, role)| ContactSurfaces {
            name: fibre.pair(base, side),
            slave: name,
            master: fibre.set("fibre", side),
            role,
            width: Some(contact_width(fibre.diameter)),
        }));
    }
    pairs
}

/// Sides, bottom, and supports (b) and (c); returns what is missing.
pub(super) fn name_supports(
    definition: &mut MeshDefinition,
    parameters: &Fibres,
    laid: &[Laid<'_>],
    edges: &SurfaceEdges,
) -> Vec<String> {
    let [[near_left, away_left], [near_right, away_right]] = support_limits(parameters, laid);
    let mut missing = Vec::new();
    for (name, surface, between) in [
        ("sides", Surface::Sides, None),
        ("bottom", Surface::Bottom, None),
        ("face_near", Surface::Face, Some([near_left, near_right])),
        ("face_away", Surface::Face, Some([away_left, away_right])),
    ] {
        let nodes =
            edges[&(0, surface)].iter().flat_map(|edge| definition.elements[edge.element].edge_nodes(edge.edge));
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

/// Adds a node that moves by the mean displacement of a fibre's outer end, and makes it the grip.
pub(super) fn hang_on_a_node(definition: &mut MeshDefinition, fibre: &Fibre, grid: &Grid) -> NodeCoupling {
    // the consistent share of each node in a uniform traction on the end
    let mut shares: Vec<(usize, f64)> = Vec::new();
    let end = grid.side_edges(Side::Right);
    for edge in &end {
        let nodes = definition.elements[edge.element].edge_nodes(edge.edge);
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
    definition.node_sets.insert(fibre.set("grip", ""), vec![grip]);
    // Σ share u = u_grip, solved for the node with the largest share
    let largest = (0..shares.len()).max_by(|&a, &b| shares[a].1.total_cmp(&shares[b].1)).expect("an end has nodes");
    let (dependent, own) = shares.swap_remove(largest);
    let mut terms = vec![(grip, 1.0 / own)];
    terms.extend(shares.into_iter().map(|(node, share)| (node, -share / own)));
    NodeCoupling { dependent, terms }
}

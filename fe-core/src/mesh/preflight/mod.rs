//! Faults of a mesh that no single element shows: nodes that hang on edges, pieces that are not connected, bodies that
//! nothing holds.
//!
//! [`findings`] checks the mesh alone. [`bodies`] and [`rigid_body_freedom`] are for callers who know the supports.

mod hanging;
mod rigid;

#[cfg(test)]
mod test;

pub use rigid::{RigidMode, rigid_body_freedom};

use super::{Element, Mesh};

/// A suspicious property of a mesh. Messages count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Finding {
    /// A node on an edge that does not have it, within one body or part: displacements open a gap there.
    #[error(
        "node {} at ({}, {}) hangs on edge {} of element {}, which does not have it: the bodies come apart there; refine the element or couple the node",
        node + 1, position[0], position[1], edge + 1, element + 1
    )]
    HangingNode {
        /// The node.
        node: usize,
        /// Position, mm.
        position: [f64; 2],
        /// The element on whose edge it lies.
        element: usize,
        /// The edge in the element.
        edge: usize,
    },
    /// The middle node of a quadratic edge is a node of an element that is not across that edge.
    #[error(
        "node {} at ({}, {}) is the middle of edge {} of element {} and a node of element {} next to it: a T-junction, along which the displacements differ; let edges meet edges",
        node + 1, position[0], position[1], edge + 1, element + 1, other + 1
    )]
    TJunction {
        /// The node.
        node: usize,
        /// Position, mm.
        position: [f64; 2],
        /// The element whose edge has the node in its middle.
        element: usize,
        /// The edge in the element.
        edge: usize,
        /// The other element.
        other: usize,
    },
    /// A part of several bodies.
    #[error(
        "part '{part}' is in {} pieces that share no node, the first ones with the elements {} and {}; fine if they are several bodies, else merge their nodes",
        first_elements.len(), first_elements[0] + 1, first_elements[1] + 1
    )]
    Pieces {
        /// The part.
        part: String,
        /// The first element of each piece.
        first_elements: Vec<usize>,
    },
}

impl Finding {
    /// Returns whether it makes results wrong for certain; pieces may be meant.
    pub fn is_fault(&self) -> bool {
        !matches!(self, Self::Pieces { .. })
    }
}

/// Elements that hang together by shared nodes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Body {
    /// Nodes, ascending.
    pub nodes: Vec<usize>,
    /// Elements, ascending.
    pub elements: Vec<usize>,
}

/// All findings: hanging nodes, T-junctions, pieces. Nodes in `exempt` do not count as hanging: those that a coupling
/// ties and those of contact surfaces within one part.
pub fn findings(mesh: &Mesh, exempt: &[usize]) -> Vec<Finding> {
    let bodies = bodies(mesh);
    let mut findings = hanging::hanging_nodes(mesh, &bodies, exempt);
    findings.extend(hanging::t_junctions(mesh));
    findings.extend(pieces(mesh, &bodies));
    findings
}

/// The bodies of a mesh, in the order of their first elements.
pub fn bodies(mesh: &Mesh) -> Vec<Body> {
    bodies_of(mesh, |_| true)
}

/// The bodies that some elements of a mesh make, in the order of their first elements.
pub fn bodies_of(mesh: &Mesh, is_meant: impl Fn(&Element) -> bool) -> Vec<Body> {
    let mut leader: Vec<usize> = (0..mesh.nodes().len()).collect();
    for element in mesh.elements().iter().filter(|element| is_meant(element)) {
        let first = leader_of(&mut leader, element.nodes()[0]);
        for &node in &element.nodes()[1..] {
            let other = leader_of(&mut leader, node);
            leader[other] = first;
        }
    }
    let mut bodies: Vec<Body> = Vec::new();
    let mut body_of_leader = vec![None; mesh.nodes().len()];
    for (index, element) in mesh.elements().iter().enumerate().filter(|(_, element)| is_meant(element)) {
        let body = *body_of_leader[leader_of(&mut leader, element.nodes()[0])].get_or_insert_with(|| {
            bodies.push(Body { nodes: Vec::new(), elements: Vec::new() });
            bodies.len() - 1
        });
        bodies[body].elements.push(index);
    }
    for node in 0..mesh.nodes().len() {
        // Free nodes lead themselves and have no body.
        if let Some(body) = body_of_leader[leader_of(&mut leader, node)] {
            bodies[body].nodes.push(node);
        }
    }
    bodies
}

/// Returns the node that represents all nodes joined with this one so far.
fn leader_of(leader: &mut [usize], mut node: usize) -> usize {
    while leader[node] != node {
        // Halves the way for the next search.
        leader[node] = leader[leader[node]];
        node = leader[node];
    }
    node
}

/// Parts whose elements are in several bodies.
fn pieces(mesh: &Mesh, bodies: &[Body]) -> Vec<Finding> {
    let mut first_elements = vec![Vec::new(); mesh.parts().len()];
    for body in bodies {
        let mut seen = vec![false; mesh.parts().len()];
        for &element in &body.elements {
            let part = mesh.elements()[element].part();
            if !seen[part] {
                seen[part] = true;
                first_elements[part].push(element);
            }
        }
    }
    std::iter::zip(mesh.parts(), first_elements)
        .filter(|(_, first_elements)| first_elements.len() > 1)
        .map(|(part, first_elements)| Finding::Pieces { part: part.name.clone(), first_elements })
        .collect()
}

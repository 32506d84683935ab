//! Nodes on edges that do not have them.

use super::{Body, Finding};
use crate::element::{EdgeKind, EdgePoint};
use crate::mesh::{ElementEdge, Mesh};
use crate::plane::{distance, dot, minus};

/// A node is on an edge if it is closer than this fraction of the edge's length: more than what files with seven digits
/// round away, less than any gap that somebody meant.
const RELATIVE_DISTANCE: f64 = 1e-5;

/// Boundary nodes in the interior of boundary edges of the same body or the same part.
pub(super) fn hanging_nodes(mesh: &Mesh, bodies: &[Body], exempt: &[usize]) -> Vec<Finding> {
    let mut body_of_node = vec![usize::MAX; mesh.nodes().len()];
    for (index, body) in bodies.iter().enumerate() {
        body.nodes.iter().for_each(|&node| body_of_node[node] = index);
    }
    let nodes = boundary_nodes(mesh, exempt);
    let mut findings = Vec::new();
    for edge in mesh.boundary_edges() {
        let edge_nodes = mesh.edge_nodes(edge);
        let (part, body) = (mesh.elements()[edge.element].part(), body_of_node[edge_nodes.nodes()[0]]);
        let line = EdgeLine::new(mesh, edge);
        let [low, high] = line.box_along_x();
        let start = nodes.partition_point(|&(node, _)| mesh.nodes()[node][0] < low);
        for &(node, node_part) in nodes[start..].iter().take_while(|&&(node, _)| mesh.nodes()[node][0] <= high) {
            let position = mesh.nodes()[node];
            let related = node_part == part || body_of_node[node] == body;
            let is_inside = || related && !edge_nodes.nodes().contains(&node) && line.has_inside(position);
            if is_inside() && !lies_upon(mesh, node_part, node, &line) {
                let ElementEdge { element, edge } = edge;
                findings.push(Finding::HangingNode { node, position, element, edge });
            }
        }
    }
    findings
}

/// Returns whether a part with a node on an edge lies on the same side of it as the edge's own element: then it passes in front of
/// that element, as a fibre does before its cover, and does not end there.
fn lies_upon(mesh: &Mesh, part: usize, node: usize, line: &EdgeLine) -> bool {
    let [start, end, _] = line.nodes;
    let (along, position) = (minus(end, start), mesh.nodes()[node]);
    // the body of an edge is on its left
    let inwards = [-along[1], along[0]];
    let elements = mesh.elements().iter().filter(|element| element.part() == part && element.nodes().contains(&node));
    let mut depths = elements.map(|element| {
        let corners = &element.nodes()[..element.kind().corner_count()];
        corners.iter().map(|&corner| dot(minus(mesh.nodes()[corner], position), inwards)).sum::<f64>()
    });
    depths.any(|depth| depth > RELATIVE_DISTANCE * dot(along, along))
}

/// Middle nodes of boundary edges that other elements have too.
pub(super) fn t_junctions(mesh: &Mesh) -> Vec<Finding> {
    let mut middle_of = vec![None; mesh.nodes().len()];
    for edge in mesh.boundary_edges() {
        if let Some(&middle) = mesh.edge_nodes(edge).nodes().get(2) {
            middle_of[middle] = Some(edge);
        }
    }
    let mut findings = Vec::new();
    for (other, element) in mesh.elements().iter().enumerate() {
        for &node in element.nodes() {
            if let Some(ElementEdge { element, edge }) = middle_of[node].filter(|edge| edge.element != other) {
                findings.push(Finding::TJunction { node, position: mesh.nodes()[node], element, edge, other });
            }
        }
    }
    findings
}

/// The nodes of boundary edges, each once for every part that has it, sorted by x.
fn boundary_nodes(mesh: &Mesh, exempt: &[usize]) -> Vec<(usize, usize)> {
    let mut is_exempt = vec![false; mesh.nodes().len()];
    exempt.iter().for_each(|&node| is_exempt[node] = true);
    let mut nodes = Vec::new();
    for edge in mesh.boundary_edges() {
        let part = mesh.elements()[edge.element].part();
        nodes.extend(mesh.edge_nodes(edge).nodes().iter().filter(|&&node| !is_exempt[node]).map(|&node| (node, part)));
    }
    nodes.sort_unstable();
    nodes.dedup();
    nodes.sort_by(|&(a, _), &(b, _)| mesh.nodes()[a][0].total_cmp(&mesh.nodes()[b][0]));
    nodes
}

/// An edge as a curve.
struct EdgeLine {
    kind: EdgeKind,
    nodes: [[f64; 2]; 3],
    tolerance: f64,
}

impl EdgeLine {
    fn new(mesh: &Mesh, edge: ElementEdge) -> Self {
        let edge_nodes = mesh.edge_nodes(edge);
        let nodes = mesh.edge_positions(&edge_nodes, None);
        let length = distance(nodes[0], nodes[1]);
        Self { kind: edge_nodes.kind(), nodes, tolerance: RELATIVE_DISTANCE * length }
    }

    /// The x that its points can have: a parabola lies within its Bézier points, of which the middle one is
    /// 2 x₃ − (x₁ + x₂)/2.
    fn box_along_x(&self) -> [f64; 2] {
        let [start, end, middle] = self.nodes.map(|node| node[0]);
        let (mut low, mut high) = (start.min(end), start.max(end));
        if self.kind == EdgeKind::Quadratic {
            let control = 2.0 * middle - 0.5 * (start + end);
            (low, high) = (low.min(control), high.max(control));
        }
        [low - self.tolerance, high + self.tolerance]
    }

    /// Returns whether a point lies on the edge, but on none of its nodes: a node there could be merged, and belongs to
    /// another piece if it was not.
    fn has_inside(&self, point: [f64; 2]) -> bool {
        let nodes = &self.nodes[..self.kind.node_count()];
        let at_node = nodes.iter().any(|&node| distance(point, node) <= self.tolerance);
        !at_node && self.closest_distance(point) <= self.tolerance
    }

    /// The distance from a point to the edge. Starts at the projection onto the chord; Gauss–Newton on |x(s) − p|²,
    /// which converges fast where it matters, at points on the edge.
    fn closest_distance(&self, point: [f64; 2]) -> f64 {
        const ITERATIONS: usize = 12;
        let [start, end, _] = self.nodes;
        let (chord, offset) = (minus(end, start), minus(point, start));
        let mut s = (2.0 * dot(offset, chord) / dot(chord, chord) - 1.0).clamp(-1.0, 1.0);
        let mut closest = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let EdgePoint { position, tangent } = self.kind.point(&self.nodes, s);
            let offset = minus(point, position);
            closest = closest.min(offset[0].hypot(offset[1]));
            let squared = dot(tangent, tangent);
            if squared == 0.0 {
                break;
            }
            s = (s + dot(offset, tangent) / squared).clamp(-1.0, 1.0);
        }
        closest
    }
}

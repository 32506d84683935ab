//! The master surface: edges in a row, with one coordinate along all of them.

use crate::element::{EdgeKind, LinePoint, gauss_legendre};
use crate::mesh::{EdgeNodes, ElementEdge, Mesh};
use crate::model::ModelError;
use std::sync::LazyLock;

/// The rule for arc lengths. |X'| of a quadratic edge is the root of a parabola, smooth while the middle node lies well
/// between its ends: ten points leave no error above rounding.
pub(super) static ARC_LENGTH_RULE: LazyLock<Vec<LinePoint>> = LazyLock::new(|| gauss_legendre(10));

/// Directions of neighbouring edges that differ by less than this do not need smoothing; rad.
const STRAIGHT: f64 = 1e-6;
/// Directions that differ by more are meant: a corner; rad.
pub(super) const CORNER: f64 = 0.5;
/// Nodes of an edge (three) and of its neighbours (two more each).
pub(super) const MAX_SHAPE_NODES: usize = 7;

/// Edges of which each starts where the one before ends. The body lies on the left. Counted without end in both
/// directions if closed: edge −1 is the last one, and the arc length goes on growing from round to round.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    kinds: Vec<EdgeKind>,
    nodes: Vec<[usize; 3]>,
    reference: Vec<[[f64; 2]; 3]>,
    /// Arc length at the start of each edge.
    starts: Vec<f64>,
    /// Reference arc length of all edges, mm.
    pub length: f64,
    /// Whether the last edge ends where the first one starts.
    pub closed: bool,
    /// Whether normals are smoothed where each edge meets the next.
    smooth: Vec<bool>,
}

/// A place on a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Foot {
    /// The edge, counted without end on closed chains.
    pub edge: i64,
    /// ξ; beyond ±1 only past the ends of an open chain.
    pub coordinate: f64,
    /// Whether it is held by a convex corner at ξ = ±1, in whose wedge of normals the point lies.
    pub corner: bool,
}

/// Shape functions of an edge with two derivatives by ξ: along the end's tangent past the ends of an open chain. With
/// the smoothed direction m = Σ turn x in place of x' = Σ first x, in which its neighbours' nodes have a part.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EdgeShape {
    count: usize,
    nodes: [usize; MAX_SHAPE_NODES],
    pub values: [f64; MAX_SHAPE_NODES],
    pub first: [f64; MAX_SHAPE_NODES],
    pub second: [f64; MAX_SHAPE_NODES],
    pub turn: [f64; MAX_SHAPE_NODES],
    /// Derivatives of `turn` by ξ.
    pub turning: [f64; MAX_SHAPE_NODES],
    /// Whether m is something else than x'.
    pub smoothed: bool,
}

impl EdgeShape {
    /// The nodes: the edge's own, then those of its neighbours.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes[..self.count]
    }

    /// Adds `factor` (and its derivative) × the direction of an edge with these nodes and derivatives to m.
    fn add_direction(&mut self, nodes: &[usize], first: &[f64; 3], [factor, derivative]: [f64; 2]) {
        for (&node, first) in nodes.iter().zip(first) {
            let place = self.nodes().iter().position(|&other| other == node).unwrap_or(self.count);
            if place == self.count {
                self.nodes[place] = node;
                self.count += 1;
            }
            self.turn[place] += factor * first;
            self.turning[place] += derivative * first;
        }
    }
}

impl Chain {
    /// Orders the edges of a master surface. `bends`: normals are smoothed over nodes where it is straight, too.
    ///
    /// # Errors
    /// They are no single row, open or closed.
    pub fn new(mesh: &Mesh, edges: &[ElementEdge], pair: &str, bends: bool) -> Result<Self, ModelError> {
        let (order, closed) = order(mesh, edges, pair)?;
        let mut chain = Self { closed, ..Self::default() };
        for edge in order {
            let edge = mesh.edge_nodes(edge);
            chain.add(&edge, mesh.edge_positions(&edge, None));
        }
        let straight = if bends { 0.0 } else { STRAIGHT };
        chain.smooth = (0..chain.len() as i64).map(|edge| chain.turns_after(edge, straight..CORNER)).collect();
        Ok(chain)
    }

    /// A chain of one edge.
    pub fn of_edge(edge: &EdgeNodes, reference: &[[f64; 2]; 3]) -> Self {
        let mut chain = Self::default();
        chain.add(edge, *reference);
        chain
    }

    /// Adds an edge at the end.
    fn add(&mut self, edge: &EdgeNodes, reference: [[f64; 2]; 3]) {
        let mut nodes = [edge.nodes()[0]; 3];
        nodes[..edge.nodes().len()].copy_from_slice(edge.nodes());
        self.kinds.push(edge.kind());
        self.nodes.push(nodes);
        self.reference.push(reference);
        self.starts.push(self.length);
        self.length += self.length_within(self.kinds.len() - 1, 1.0);
    }

    /// Returns whether the next edge turns by an angle in this range in the reference configuration.
    fn turns_after(&self, edge: i64, range: std::ops::Range<f64>) -> bool {
        if !self.goes_on(edge, 1) {
            return false;
        }
        let direction = |edge: i64, coordinate: f64| {
            let index = self.index(edge);
            self.kinds[index].point(&self.reference[index], coordinate).tangent
        };
        let ([a, b], [c, d]) = (direction(edge, 1.0), direction(edge + 1, -1.0));
        let angle = (a * d - b * c).atan2(a * c + b * d).abs();
        range.contains(&angle)
    }

    /// Returns how many edges there are.
    pub fn len(&self) -> usize {
        self.kinds.len()
    }

    /// The edge at a place, from 0.
    fn index(&self, edge: i64) -> usize {
        edge.rem_euclid(self.kinds.len() as i64) as usize
    }

    /// Nodes of an edge: start, end and, on quadratic ones, the middle.
    pub fn nodes(&self, edge: i64) -> &[usize] {
        let index = self.index(edge);
        &self.nodes[index][..self.kinds[index].node_count()]
    }

    /// Returns whether another edge comes before (−1) or after (1) this one.
    pub fn goes_on(&self, edge: i64, side: i64) -> bool {
        self.closed || (0..self.kinds.len() as i64).contains(&(edge + side))
    }

    /// Returns whether normals are smoothed at the start (−1) or the end (1) of an edge.
    pub fn is_smooth_at(&self, edge: i64, side: i64) -> bool {
        let joint = if side < 0 { edge - 1 } else { edge };
        self.goes_on(edge, side) && self.smooth.get(self.index(joint)).is_some_and(|smooth| *smooth)
    }

    /// Returns where past an end of an open chain ξ lies: how far the straight extension has gone.
    fn excess(&self, edge: i64, coordinate: f64) -> f64 {
        let side = if coordinate < 0.0 { -1 } else { 1 };
        if coordinate.abs() > 1.0 && !self.goes_on(edge, side) { coordinate - side as f64 } else { 0.0 }
    }

    /// Shape functions at a place.
    pub fn shape(&self, edge: i64, coordinate: f64) -> EdgeShape {
        let kind = self.kinds[self.index(edge)];
        let excess = self.excess(edge, coordinate);
        let at = coordinate - excess;
        let (values, first) = (kind.shape_functions(at), kind.shape_derivatives(at));
        let second = if excess == 0.0 { kind.shape_second_derivatives() } else { [0.0; 3] };
        let mut shape = EdgeShape { count: kind.node_count(), ..EdgeShape::default() };
        for (node, &index) in self.nodes(edge).iter().enumerate() {
            shape.nodes[node] = index;
            shape.values[node] = values[node] + first[node] * excess;
            (shape.first[node], shape.turn[node]) = (first[node], first[node]);
            (shape.second[node], shape.turning[node]) = (second[node], second[node]);
        }
        if excess == 0.0 {
            self.smooth(edge, at, &mut shape);
        }
        shape
    }

    /// Adds to m, at each end of an edge that is smoothed, what makes it there the mean of both edges' directions dx/ds₀;
    /// linearly from 0 at the other end.
    fn smooth(&self, edge: i64, coordinate: f64, shape: &mut EdgeShape) {
        for side in [-1, 1] {
            if !self.is_smooth_at(edge, side) {
                continue;
            }
            let end = side as f64;
            let share = [0.5 * (1.0 + end * coordinate), 0.5 * end];
            let [own, other] = [(edge, end), (edge + side, -end)].map(|(edge, at)| self.stretch(edge, at));
            let directions = [(edge, end, -0.5), (edge + side, -end, 0.5 * own / other)];
            for (edge, at, factor) in directions {
                let first = self.kinds[self.index(edge)].shape_derivatives(at);
                shape.add_direction(self.nodes(edge), &first, share.map(|share| factor * share));
            }
            shape.smoothed = true;
        }
    }

    /// ds₀/dξ within an edge.
    fn stretch(&self, edge: i64, coordinate: f64) -> f64 {
        let index = self.index(edge);
        self.kinds[index].point(&self.reference[index], coordinate).stretch()
    }

    /// Reference arc length s₀ at a place, mm, with its two derivatives by ξ.
    pub fn arc_length(&self, edge: i64, coordinate: f64) -> [f64; 3] {
        let index = self.index(edge);
        let rounds = edge.div_euclid(self.kinds.len() as i64) as f64;
        let excess = self.excess(edge, coordinate);
        let at = coordinate - excess;
        let (kind, nodes) = (self.kinds[index], &self.reference[index]);
        let tangent = kind.point(nodes, at).tangent;
        let stretch = tangent[0].hypot(tangent[1]);
        let inside = self.starts[index] + rounds * self.length + self.length_within(index, at);
        if excess != 0.0 {
            return [inside + excess * stretch, stretch, 0.0];
        }
        let mut bend = 0.0;
        for (second, node) in kind.shape_second_derivatives().iter().zip(nodes).take(kind.node_count()) {
            bend += second * (tangent[0] * node[0] + tangent[1] * node[1]);
        }
        [inside, stretch, bend / stretch]
    }

    /// Reference length of an edge from its start to ξ.
    fn length_within(&self, index: usize, coordinate: f64) -> f64 {
        let half = 0.5 * (coordinate + 1.0);
        let part = |point: &LinePoint| {
            let at = half * (point.coordinate + 1.0) - 1.0;
            point.weight * self.kinds[index].point(&self.reference[index], at).stretch()
        };
        half * ARC_LENGTH_RULE.iter().map(part).sum::<f64>()
    }
}

/// The edges in a row, and whether it closes.
fn order(mesh: &Mesh, edges: &[ElementEdge], pair: &str) -> Result<(Vec<ElementEdge>, bool), ModelError> {
    let broken =
        |reason: String| ModelError::of_pair(pair, format!("the master is no single chain of edges: {reason}"));
    let rows = mesh.rows(edges).map_err(|edge| {
        let nodes = mesh.edge_nodes(edge);
        broken(format!("it branches at the edge of nodes {}–{}", nodes.nodes()[0] + 1, nodes.nodes()[1] + 1))
    })?;
    match rows.into_iter().next() {
        None => Err(broken("it has no edges".to_owned())),
        Some((row, _)) if row.len() < edges.len() => {
            Err(broken(format!("it is in pieces: {} of {} edges hang together", row.len(), edges.len())))
        }
        Some(whole) => Ok(whole),
    }
}

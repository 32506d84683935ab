//! Overlap of deformed bodies with each other, or with themselves, whether or not a contact pair is defined there.
//!
//! # Equations
//!
//! Points of the boundary are tested: the ends and the middle of each edge. A point lies in a body around which the body's
//! boundary turns: the crossings of a ray from the point to x = ∞ with the deformed edges, upward ones less downward ones,
//! are
//!
//! ```text
//! w(x) = Σ sign(dy/ds) > 0        over the edges' s with y(s) = y, x(s) > x
//! ```
//!
//! exactly on curved edges, too. On its own body's boundary a point is tested a little outside of it: there w > 0 is matter
//! that has come from elsewhere. The depth is the distance to the nearest boundary edge of the body that the point lies in;
//! of its own body only edges count that face it.

use super::{ElementEdge, Mesh, preflight};
use crate::element::EdgeKind;
use crate::plane::distance;
use serde::{Deserialize, Serialize};

#[cfg(test)]
mod test;

/// Part of an edge's length below which a depth is rounding of positions.
const ROUNDING: f64 = 1e-9;
/// Distance outside its own body at which a point is tested against it, relative to the edge's length.
const OUTSIDE: f64 = 1e-6;
/// Part of half an edge's length: at corners of a body's boundary its edges are tested against that body so far before their
/// ends, since outside of an edge's very end may be inside of the next one.
const BEFORE_CORNER: f64 = 1e-3;

/// A point of a body's boundary inside of a body. `P`: how parts are named, by their indices or as texts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Overlap<P = usize> {
    /// Distance to the nearest edge of the body that it lies in, mm.
    pub depth: f64,
    /// Present position of the point, mm.
    pub position: [f64; 2],
    /// The part that it belongs to.
    pub part: P,
    /// The part that it lies in, by that nearest edge; may be its own.
    pub inside: P,
}

impl Mesh {
    /// Returns the deepest overlap of the bodies that these displacements (two per node, mm) deform; `None` if nothing
    /// overlaps. Elements that are left out are ignored, such as those in another plane, which overlap others by
    /// design.
    pub fn overlap(&self, displacements: &[f64], is_left_out: impl Fn(usize) -> bool) -> Option<Overlap> {
        let bodies = self.outlines(displacements, |edge| is_left_out(edge.element));
        let found = bodies.iter().enumerate().flat_map(|(own, body)| {
            let bodies = &bodies;
            body.edges.iter().flat_map(move |edge| deepest_of(edge, own, bodies))
        });
        found.max_by(|a, b| a.depth.total_cmp(&b.depth))
    }

    /// The deformed boundary of each body.
    fn outlines(&self, displacements: &[f64], is_left_out: impl Fn(ElementEdge) -> bool) -> Vec<Outline> {
        let is_outer = |edge: ElementEdge| !is_left_out(edge) && self.neighbour(edge).is_none_or(&is_left_out);
        let bodies = preflight::bodies(self);
        let mut body_of = vec![0; self.elements.len()];
        for (index, body) in bodies.iter().enumerate() {
            body.elements.iter().for_each(|&element| body_of[element] = index);
        }
        let mut outlines: Vec<Outline> = bodies.iter().map(|_| Outline::default()).collect();
        for edge in self.edges().filter(|&edge| is_outer(edge)) {
            outlines[body_of[edge.element]].add(self.deformed_edge(edge, displacements));
        }
        outlines
    }

    fn deformed_edge(&self, edge: ElementEdge, displacements: &[f64]) -> Edge {
        let ends = self.edge_nodes(edge);
        let nodes = self.edge_positions(&ends, Some(displacements));
        let kind = ends.kind();
        let part = self.elements[edge.element].part;
        Edge { kind, nodes, ends: [ends.nodes()[0], ends.nodes()[1]], part, turn: turn(kind, &nodes) }
    }
}

/// The s between the ends of an edge at which y turns, and y there.
fn turn(kind: EdgeKind, nodes: &[[f64; 2]; 3]) -> Option<[f64; 2]> {
    let [start, end, middle] = nodes.map(|[_, y]| y);
    let bend = start + end - 2.0 * middle;
    let at = -0.5 * (end - start) / bend;
    (kind == EdgeKind::Quadratic && at.abs() < 1.0).then(|| [at, kind.point(nodes, at).position[1]])
}

/// The overlap of a body's edge with each body.
fn deepest_of(edge: &Edge, own: usize, bodies: &[Outline]) -> Vec<Overlap> {
    let length = edge.length();
    if length.is_nan() || length <= 0.0 {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (index, body) in bodies.iter().enumerate().filter(|(_, body)| body.may_have(edge)) {
        for s in [-1.0, 0.0, 1.0] {
            let overlap = if index == own { body.fold(edge, s, length) } else { body.depth_of(edge, s) };
            found.extend(overlap.filter(|overlap| overlap.depth > ROUNDING * length));
        }
    }
    found
}

/// A deformed edge of a boundary: the body lies on its left.
#[derive(Debug)]
struct Edge {
    kind: EdgeKind,
    /// Start, end and, on quadratic edges, the middle.
    nodes: [[f64; 2]; 3],
    /// The nodes at its ends.
    ends: [usize; 2],
    part: usize,
    /// Places where y turns.
    turn: Option<[f64; 2]>,
}

impl Edge {
    fn length(&self) -> f64 {
        distance(self.nodes[1], self.nodes[0])
    }

    fn at(&self, s: f64) -> [f64; 2] {
        self.kind.point(&self.nodes, s).position
    }

    fn outward(&self, s: f64) -> Option<[f64; 2]> {
        self.kind.point(&self.nodes, s).outward_normal()
    }

    /// The box that it lies in: a parabola leaves that of its nodes by an eighth of its second difference at most.
    fn bounds(&self) -> [[f64; 2]; 2] {
        let nodes = &self.nodes[..self.kind.node_count()];
        let least = |k: usize| nodes.iter().map(|node| node[k]).fold(f64::INFINITY, f64::min);
        let most = |k: usize| nodes.iter().map(|node| node[k]).fold(f64::NEG_INFINITY, f64::max);
        let bulge = |k: usize| match self.kind {
            EdgeKind::Linear => 0.0,
            EdgeKind::Quadratic => 0.125 * (self.nodes[0][k] + self.nodes[1][k] - 2.0 * self.nodes[2][k]).abs(),
        };
        [[0, 1].map(|k| least(k) - bulge(k)), [0, 1].map(|k| most(k) + bulge(k))]
    }

    /// Upward crossings less downward ones of the ray from a point to x = ∞.
    fn crossings(&self, point: [f64; 2]) -> i32 {
        let ends = [[-1.0, self.nodes[0][1]], [1.0, self.nodes[1][1]]];
        match self.turn {
            None => self.crossing(point, ends),
            Some(turn) => self.crossing(point, [ends[0], turn]) + self.crossing(point, [turn, ends[1]]),
        }
    }

    /// Counts the crossings of a piece on which y grows or falls, between two s with their y.
    fn crossing(&self, [x, y]: [f64; 2], [[from, y_from], [to, y_to]]: [[f64; 2]; 2]) -> i32 {
        let sign = match (y_from <= y, y_to <= y) {
            (true, false) => 1,
            (false, true) => -1,
            _ => return 0,
        };
        let (mut low, mut high) = if sign > 0 { (from, to) } else { (to, from) };
        if self.kind == EdgeKind::Linear {
            let s = low + (y - y_from.min(y_to)) / (y_from - y_to).abs() * (high - low);
            return if self.at(s)[0] > x { sign } else { 0 };
        }
        // bisection to the last bit: a piece is crossed once
        loop {
            let middle = 0.5 * (low + high);
            if middle == low || middle == high {
                return if self.at(middle)[0] > x { sign } else { 0 };
            }
            *(if self.at(middle)[1] <= y { &mut low } else { &mut high }) = middle;
        }
    }

    /// The distance of a point.
    fn distance(&self, point: [f64; 2]) -> f64 {
        /// Starts of Newton: d² is of fourth degree in s.
        const STARTS: i32 = 8;
        const ITERATIONS: usize = 20;
        let squared = |s: f64| {
            let [x, y] = self.at(s);
            (x - point[0]).powi(2) + (y - point[1]).powi(2)
        };
        let starts = (0..=STARTS).map(|k| f64::from(2 * k) / f64::from(STARTS) - 1.0);
        let Some(mut s) = starts.min_by(|a, b| squared(*a).total_cmp(&squared(*b))) else { return f64::INFINITY };
        let mut least = squared(s);
        let [bend_x, bend_y] = [0, 1].map(|k| {
            let second = self.kind.shape_second_derivatives();
            (0..3).map(|node| second[node] * self.nodes[node][k]).sum::<f64>()
        });
        for _ in 0..ITERATIONS {
            let at = self.kind.point(&self.nodes, s);
            let [d_x, d_y] = [at.position[0] - point[0], at.position[1] - point[1]];
            let slope = d_x * at.tangent[0] + d_y * at.tangent[1];
            let curvature = at.tangent[0].powi(2) + at.tangent[1].powi(2) + d_x * bend_x + d_y * bend_y;
            s = (s - slope / curvature).clamp(-1.0, 1.0);
            // towards a maximum, or back and forth: the least so far is near enough
            let found = squared(s);
            if found.is_nan() || found >= least {
                break;
            }
            least = found;
        }
        least.sqrt()
    }
}

/// The deformed boundary of a body.
#[derive(Debug)]
struct Outline {
    edges: Vec<Edge>,
    /// The box that it lies in: least and greatest x and y.
    bounds: [[f64; 2]; 2],
}

impl Default for Outline {
    fn default() -> Self {
        Self { edges: Vec::new(), bounds: [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]] }
    }
}

impl Outline {
    fn add(&mut self, edge: Edge) {
        let [least, most] = edge.bounds();
        for k in 0..2 {
            self.bounds[0][k] = self.bounds[0][k].min(least[k]);
            self.bounds[1][k] = self.bounds[1][k].max(most[k]);
        }
        self.edges.push(edge);
    }

    /// Returns whether an edge reaches into the box.
    fn may_have(&self, edge: &Edge) -> bool {
        let [least, most] = edge.bounds();
        (0..2).all(|k| most[k] >= self.bounds[0][k] && least[k] <= self.bounds[1][k])
    }

    fn has(&self, point: [f64; 2]) -> bool {
        self.edges.iter().map(|edge| edge.crossings(point)).sum::<i32>() > 0
    }

    /// Returns how deep a point of another body's edge lies in this one.
    fn depth_of(&self, edge: &Edge, s: f64) -> Option<Overlap> {
        let position = edge.at(s);
        self.has(position).then(|| nearest(self.edges.iter(), edge, position)).flatten()
    }

    /// Returns how deep a point of its own edge lies in what has come from elsewhere.
    fn fold(&self, edge: &Edge, s: f64, length: f64) -> Option<Overlap> {
        let s = s * (1.0 - BEFORE_CORNER);
        let (position, [n_x, n_y]) = (edge.at(s), edge.outward(s)?);
        let outside = [position[0] + OUTSIDE * length * n_x, position[1] + OUTSIDE * length * n_y];
        if !self.has(outside) {
            return None;
        }
        let faces = |other: &&Edge| {
            let is_apart = !other.ends.iter().any(|node| edge.ends.contains(node));
            is_apart && other.outward(0.0).is_some_and(|[x, y]| x * n_x + y * n_y < 0.0)
        };
        nearest(self.edges.iter().filter(faces), edge, position)
    }
}

/// The overlap of a point of an edge that lies within these edges.
fn nearest<'a>(edges: impl Iterator<Item = &'a Edge>, of: &Edge, position: [f64; 2]) -> Option<Overlap> {
    let distances = edges.map(|other| (other.distance(position), other.part));
    let (depth, inside) = distances.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    Some(Overlap { depth, position, part: of.part, inside })
}

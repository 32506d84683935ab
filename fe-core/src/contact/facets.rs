//! How far the surfaces of a pair may miss each other although they are meant to be one: facets of curves, rounded coordinates.

use super::chain::{CORNER, Foot};
use super::quadrature::ContactPoint;
use crate::mesh::{ElementEdge, Mesh};
use crate::plane::distance;
use std::collections::HashMap;

/// Rounding of a coordinate in mesh files, relative to its size.
const ROUNDING: f64 = 1e-6;
/// Part of length × turn: a chord of an arc is L θ/8 away from it, and where an arc has one chord alone each end shows
/// half of θ.
const SAGITTA: f64 = 0.25;
/// Part of the turn by which neighbouring parabolas bend differently: 0.008 f''' L³ is what a parabola misses of a curve,
/// and f''' L is the jump of its curvature; twice that.
const BEND: f64 = 1.0 / 16.0;
/// Factor by which curvatures may be estimated too low: near the end of an arc an estimate sees half of it.
const ESTIMATE: f64 = 2.0;

/// An edge as a piece of a curve.
#[derive(Clone, Copy, Debug, Default)]
struct Facet {
    length: f64,
    /// The turn at its ends that its own shape does not follow, rad.
    kink: f64,
    /// Greatest curvature there, 1/mm.
    curvature: f64,
}

impl Facet {
    /// Widens it to what either allows.
    fn or(self, other: Self) -> Self {
        Self {
            length: self.length.max(other.length),
            kink: self.kink.max(other.kink),
            curvature: self.curvature.max(other.curvature),
        }
    }

    /// How far it may miss a curve that the other surface follows with this curvature: nothing if that one is straight.
    fn deviation(&self, curvature: f64) -> f64 {
        SAGITTA * self.length * self.kink.min(ESTIMATE * self.length * curvature)
    }
}

/// The edges of both surfaces.
pub(super) struct Facets {
    /// By element.
    slave: HashMap<usize, Facet>,
    /// In the order of the chain.
    master: Vec<Facet>,
}

impl Facets {
    /// Measures the edges of a pair. A slave that branches counts as straight.
    pub fn new(mesh: &Mesh, slave: &[ElementEdge], master: &[ElementEdge]) -> Self {
        let mut of_slave: HashMap<usize, Facet> = HashMap::new();
        for (row, closed) in mesh.rows(slave).unwrap_or_default() {
            for (edge, facet) in row.iter().zip(facets(mesh, &row, closed)) {
                let known = of_slave.entry(edge.element).or_default();
                *known = known.or(facet);
            }
        }
        let rows = mesh.rows(master).unwrap_or_default();
        let master = rows.iter().flat_map(|(row, closed)| facets(mesh, row, *closed)).collect();
        Self { slave: of_slave, master }
    }

    /// Returns the largest gap or overlap, mm, that discretisation makes of one curve at a point and its foot.
    pub fn allowed(&self, point: &ContactPoint, at: [f64; 2], foot: Foot) -> f64 {
        let under = foot.edge.rem_euclid(self.master.len() as i64) as usize;
        let master = self.master[under];
        let edges = point.elements.iter().filter_map(|element| self.slave.get(element));
        let slave = edges.fold(Facet::default(), |all, facet| all.or(*facet));
        let rounding = ROUNDING * point.edge_length.max(at[0].hypot(at[1]));
        slave.deviation(master.curvature) + master.deviation(slave.curvature) + rounding
    }
}

/// The edges of a row.
fn facets(mesh: &Mesh, row: &[ElementEdge], closed: bool) -> Vec<Facet> {
    // directions at both ends, chord, curvature with its sign
    let shapes = row.iter().map(|&edge| {
        let edge = mesh.edge_nodes(edge);
        let positions = mesh.edge_positions(&edge, None);
        let [start, end] = [-1.0, 1.0].map(|at| edge.kind().point(&positions, at).tangent);
        let length = distance(positions[0], positions[1]);
        (start, end, length, angle(start, end) / length)
    });
    let shapes: Vec<_> = shapes.collect();
    let own = |&(_, _, length, curvature): &([f64; 2], [f64; 2], f64, f64)| Facet {
        length,
        kink: 0.0,
        curvature: curvature.abs(),
    };
    let mut facets: Vec<Facet> = shapes.iter().map(own).collect();
    let joints = if closed { row.len() } else { row.len().saturating_sub(1) };
    for joint in 0..joints {
        let next = (joint + 1) % row.len();
        let ((_, end, length, bend), (start, _, next_length, next_bend)) = (shapes[joint], shapes[next]);
        let turn = angle(end, start).abs();
        // a corner is meant
        if turn > CORNER {
            continue;
        }
        let mean = 0.5 * (length + next_length);
        let kink = turn + BEND * (bend - next_bend).abs() * mean;
        let curvature = turn / mean + bend.abs().max(next_bend.abs());
        for facet in [joint, next] {
            facets[facet] = facets[facet].or(Facet { length: 0.0, kink, curvature });
        }
    }
    facets
}

/// The angle from one direction to another, rad.
fn angle([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (a * d - b * c).atan2(a * c + b * d)
}

//! Gap and slip of a contact point with their first and second derivatives by the nodes' positions.

use super::chain::{Chain, EdgeShape, Foot, MAX_SHAPE_NODES};
use crate::plane::dot;
use serde::{Deserialize, Serialize};

/// Nodes of a contact point: at most three of a slave edge, three of a master edge and two of each of its neighbours.
pub(super) const MAX_NODES: usize = 3 + MAX_SHAPE_NODES;
/// Freedoms of as many nodes.
pub(super) const MAX_FREEDOMS: usize = 2 * MAX_NODES;
/// d shorter than this × |x'| has no direction to be trusted: the edge's normal is the corner's.
const NO_LENGTH: f64 = 1e-12;

/// A slave point: nodes of its edge and their shape functions there.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlavePoint {
    pub nodes: [usize; 3],
    pub values: [f64; 3],
    pub count: usize,
}

impl SlavePoint {
    /// Returns where it is.
    pub fn position(&self, position: &impl Fn(usize) -> [f64; 2]) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for k in 0..self.count {
            let node = position(self.nodes[k]);
            sum = [sum[0] + self.values[k] * node[0], sum[1] + self.values[k] * node[1]];
        }
        sum
    }
}

/// Gap g and arc length s of one point, their gradients, and what their second derivatives are made of; the module's
/// page has the equations. Freedoms are ordered node by node, slave nodes first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Kinematics {
    count: usize,
    nodes: [usize; MAX_NODES],
    /// x_s, mm.
    pub position: [f64; 2],
    /// x(ξ), mm.
    pub foot: [f64; 2],
    /// T, along m.
    pub tangent: [f64; 2],
    /// n.
    pub normal: [f64; 2],
    /// g, mm.
    pub gap: f64,
    /// s = s₀(ξ), mm.
    pub arc_length: f64,
    /// n·dx/ds₀: how far the normal leans against its edge; 0 where it is the edge's own.
    pub lean: f64,
    /// v = A n: the forces of a unit of tension. It is ∂g/∂x where the normals are not smoothed.
    pub pull: [f64; MAX_FREEDOMS],
    /// ∂g/∂x.
    pub gap_gradient: [f64; MAX_FREEDOMS],
    /// ∂s/∂x.
    pub slip_gradient: [f64; MAX_FREEDOMS],
    second: Second,
}

/// Ingredients of the second derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Second {
    /// A and B: ∂d/∂x and ∂m/∂x at fixed ξ, per node.
    arm: [f64; MAX_NODES],
    turn: [f64; MAX_NODES],
    /// a = A T, b = B n, b̄ = B̄ n, c = A m' − B̄ m − B x' + B' d, with B̄ = ∂x'/∂x.
    a: [f64; MAX_FREEDOMS],
    b: [f64; MAX_FREEDOMS],
    b_edge: [f64; MAX_FREEDOMS],
    c: [f64; MAX_FREEDOMS],
    /// ∂ξ/∂x.
    coordinate: [f64; MAX_FREEDOMS],
    /// Second derivative of ∂v: coefficients of a bᵀ, b̄ aᵀ, a aᵀ and b̄ bᵀ.
    pull: [f64; 4],
    /// Second derivative of the slip, ∂²s: coefficients of (A B 1 + c ∂ξᵀ + symmetric) and of ∂ξ ∂ξᵀ.
    slip: [f64; 2],
}

/// x', x'', m and m' at the foot.
struct Directions {
    tangent: [f64; 2],
    bend: [f64; 2],
    direction: [f64; 2],
    turning: [f64; 2],
}

impl Directions {
    fn new(shape: &EdgeShape, position: &impl Fn(usize) -> [f64; 2]) -> Self {
        let mut sums = [[0.0; 2]; 4];
        for (k, &node) in shape.nodes().iter().enumerate() {
            let x = position(node);
            let factors = [shape.first[k], shape.second[k], shape.turn[k], shape.turning[k]];
            for (sum, factor) in sums.iter_mut().zip(factors) {
                *sum = [sum[0] + factor * x[0], sum[1] + factor * x[1]];
            }
        }
        let [tangent, bend, direction, turning] = sums;
        Self { tangent, bend, direction, turning }
    }
}

/// The normal to the right of a tangent: out of the body that lies on its left.
fn right_of([x, y]: [f64; 2]) -> [f64; 2] {
    [y, -x]
}

impl Kinematics {
    /// Evaluates the kinematics of a slave point over its foot.
    ///
    /// # Errors
    /// The reason why the foot gives no gap.
    pub fn new(
        chain: &Chain,
        slave: &SlavePoint,
        foot: Foot,
        position: &impl Fn(usize) -> [f64; 2],
    ) -> Result<Self, &'static str> {
        let shape = chain.shape(foot.edge, foot.coordinate);
        let mut point = Self::over(slave, &shape, position);
        let directions = Directions::new(&shape, position);
        let Directions { tangent, bend, direction, turning } = directions;
        let stretch = direction[0].hypot(direction[1]);
        if stretch.is_nan() || stretch <= 0.0 {
            return Err("the master edge under it has no length");
        }
        point.tangent = direction.map(|t| t / stretch);
        point.normal = right_of(point.tangent);
        let arm = [0, 1].map(|i| point.position[i] - point.foot[i]);
        let [arc_length, by_coordinate, by_coordinate_twice] = chain.arc_length(foot.edge, foot.coordinate);
        point.arc_length = arc_length;
        if foot.corner && arm[0].hypot(arm[1]) > NO_LENGTH * stretch {
            point.at_corner(arm, neighbour_normal(chain, foot, position));
            return Ok(point);
        }
        point.gap = dot(arm, point.normal);
        let denominator = dot(tangent, direction) - dot(arm, turning);
        if denominator <= 0.0 {
            return Err("it lies beyond the centre of the master's curvature");
        }
        point.fill(slave.count, &shape, &directions, arm, denominator);
        for freedom in 0..2 * point.count {
            point.slip_gradient[freedom] = by_coordinate * point.second.coordinate[freedom];
        }
        if shape.smoothed {
            point.lean = dot(tangent, point.normal) / by_coordinate;
        }
        let along = dot(direction, bend) + 2.0 * dot(tangent, turning);
        point.second.slip = [by_coordinate / denominator, by_coordinate_twice - along * by_coordinate / denominator];
        Ok(point)
    }

    /// Nodes, positions and A; the rest is 0.
    fn over(slave: &SlavePoint, shape: &EdgeShape, position: &impl Fn(usize) -> [f64; 2]) -> Self {
        let mut nodes = [0; MAX_NODES];
        let mut arm = [0.0; MAX_NODES];
        let mut foot = [0.0; 2];
        nodes[..slave.count].copy_from_slice(&slave.nodes[..slave.count]);
        arm[..slave.count].copy_from_slice(&slave.values[..slave.count]);
        for (k, &node) in shape.nodes().iter().enumerate() {
            nodes[slave.count + k] = node;
            arm[slave.count + k] = -shape.values[k];
            let x = position(node);
            foot = [foot[0] + shape.values[k] * x[0], foot[1] + shape.values[k] * x[1]];
        }
        let count = slave.count + shape.nodes().len();
        let (position, second) = (slave.position(position), Second { arm, ..Second::default() });
        Self { count, nodes, position, foot, second, ..Self::default() }
    }

    /// Distance from a corner: its side is that of the mean of the two edges' normals; no slip.
    fn at_corner(&mut self, arm: [f64; 2], other: [f64; 2]) {
        let mean = [self.normal[0] + other[0], self.normal[1] + other[1]];
        let length = arm[0].hypot(arm[1]);
        self.gap = if dot(arm, mean) < 0.0 { -length } else { length };
        self.normal = arm.map(|d| d / self.gap);
        // T to the left of n, so that n is again to the right of T.
        self.tangent = [-self.normal[1], self.normal[0]];
        for node in 0..self.count {
            for i in 0..2 {
                self.pull[2 * node + i] = self.second.arm[node] * self.normal[i];
                self.second.a[2 * node + i] = self.second.arm[node] * self.tangent[i];
            }
        }
        self.gap_gradient = self.pull;
        self.second.pull = [0.0, 0.0, 1.0 / self.gap, 0.0];
    }

    /// Gradients of g and ξ and the ingredients of the second derivatives.
    fn fill(&mut self, slave: usize, shape: &EdgeShape, directions: &Directions, arm: [f64; 2], denominator: f64) {
        let Directions { tangent, direction, turning, .. } = directions;
        let (gap, normal, second) = (self.gap, self.normal, &mut self.second);
        for node in 0..self.count {
            let of_master = |factors: &[f64; MAX_SHAPE_NODES]| if node < slave { 0.0 } else { factors[node - slave] };
            let (arm_of, turn, turned) = (second.arm[node], of_master(&shape.turn), of_master(&shape.turning));
            let turn_of_edge = of_master(&shape.first);
            second.turn[node] = turn;
            for i in 0..2 {
                let freedom = 2 * node + i;
                self.pull[freedom] = arm_of * normal[i];
                second.a[freedom] = arm_of * self.tangent[i];
                second.b[freedom] = turn * normal[i];
                second.b_edge[freedom] = turn_of_edge * normal[i];
                second.c[freedom] =
                    arm_of * turning[i] - turn_of_edge * direction[i] - turn * tangent[i] + turned * arm[i];
                second.coordinate[freedom] = (arm_of * direction[i] + turn * gap * normal[i]) / denominator;
            }
        }
        let stretch = direction[0].hypot(direction[1]);
        let (mut along, mut across) = (stretch, 0.0);
        if shape.smoothed {
            (along, across) = (dot(*tangent, self.tangent), dot(*tangent, normal));
        }
        for freedom in 0..2 * self.count {
            self.gap_gradient[freedom] = self.pull[freedom] - across * second.coordinate[freedom];
        }
        second.pull = [along, stretch, dot(normal, *turning), gap].map(|factor| -factor / denominator);
    }

    /// The nodes: slave, then master.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes[..self.count]
    }

    /// Two for each node.
    pub fn freedom_count(&self) -> usize {
        2 * self.count
    }

    /// Indices of the freedoms, into an array of which [`Self::freedom_count`] are used.
    pub fn freedoms(&self) -> [usize; MAX_FREEDOMS] {
        let mut freedoms = [0; MAX_FREEDOMS];
        for (k, node) in self.nodes().iter().enumerate() {
            (freedoms[2 * k], freedoms[2 * k + 1]) = (2 * node, 2 * node + 1);
        }
        freedoms
    }

    /// The change of what has this gradient along a change of all displacements.
    pub fn along(&self, gradient: &[f64; MAX_FREEDOMS], change: &[f64]) -> f64 {
        let freedoms = self.freedoms();
        (0..self.freedom_count()).map(|i| gradient[i] * change[freedoms[i]]).sum()
    }

    /// Returns `by_pull` ∂v_i/∂x_j + `by_slip` ∂²s/∂x_i∂x_j. It is the same to the last bit when i and j change places,
    /// unless normals are smoothed.
    pub fn second_derivative(&self, by_pull: f64, by_slip: f64, i: usize, j: usize) -> f64 {
        let Second { arm, turn, a, b, b_edge, c, coordinate, pull, slip } = &self.second;
        let of_pull = (pull[0] * (a[i] * b[j]) + pull[1] * (b_edge[i] * a[j]))
            + pull[2] * (a[i] * a[j])
            + pull[3] * (b_edge[i] * b[j]);
        let same_direction = if (i ^ j) & 1 == 0 { arm[i / 2] * turn[j / 2] + turn[i / 2] * arm[j / 2] } else { 0.0 };
        let of_slip = slip[0] * (same_direction + (c[i] * coordinate[j] + coordinate[i] * c[j]))
            + slip[1] * (coordinate[i] * coordinate[j]);
        by_pull * of_pull + by_slip * of_slip
    }
}

/// The normal of the edge on the other side of the corner where a foot is.
fn neighbour_normal(chain: &Chain, foot: Foot, position: &impl Fn(usize) -> [f64; 2]) -> [f64; 2] {
    let side = if foot.coordinate < 0.0 { -1 } else { 1 };
    let shape = chain.shape(foot.edge + side, -foot.coordinate);
    let tangent = Directions::new(&shape, position).direction;
    let stretch = tangent[0].hypot(tangent[1]);
    right_of(tangent.map(|t| t / stretch))
}

//! Edges of elements: shape functions along them and Gauss–Legendre points.
//!
//! ```text
//! linear     1-------2           quadratic     1---3---2          s from −1 at node 1 to 1 at node 2
//! ```

/// The kinds of edge. Nodes: start, end and, on quadratic edges, the middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EdgeKind {
    /// Two nodes.
    Linear,
    /// Three nodes.
    Quadratic,
}

/// A point of an edge in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgePoint {
    /// (x, y).
    pub position: [f64; 2],
    /// ∂(x, y)/∂s; its length is the arc length per unit of s.
    pub tangent: [f64; 2],
}

impl EdgePoint {
    /// ds → length: |∂x/∂s|.
    pub fn stretch(&self) -> f64 {
        self.tangent[0].hypot(self.tangent[1])
    }

    /// The unit normal to the right of the edge's direction: outward on an element's edge. `None` where the tangent
    /// vanishes.
    pub(crate) fn outward_normal(&self) -> Option<[f64; 2]> {
        let stretch = self.stretch();
        (stretch > 0.0).then(|| [self.tangent[1] / stretch, -self.tangent[0] / stretch])
    }
}

impl EdgeKind {
    /// Returns how many nodes it has.
    pub const fn node_count(self) -> usize {
        match self {
            Self::Linear => 2,
            Self::Quadratic => 3,
        }
    }

    /// Shape functions at s: start, end, middle; the last one is 0 on linear edges.
    pub fn shape_functions(self, s: f64) -> [f64; 3] {
        match self {
            Self::Linear => [0.5 * (1.0 - s), 0.5 * (1.0 + s), 0.0],
            Self::Quadratic => [0.5 * s * (s - 1.0), 0.5 * s * (s + 1.0), (1.0 - s) * (1.0 + s)],
        }
    }

    /// First derivatives by s.
    pub(crate) fn shape_derivatives(self, s: f64) -> [f64; 3] {
        match self {
            Self::Linear => [-0.5, 0.5, 0.0],
            Self::Quadratic => [s - 0.5, s + 0.5, -2.0 * s],
        }
    }

    /// Second derivatives by s: for curvature and for projecting a point.
    pub(crate) fn shape_second_derivatives(self) -> [f64; 3] {
        match self {
            Self::Linear => [0.0; 3],
            Self::Quadratic => [1.0, 1.0, -2.0],
        }
    }

    /// The point at s of an edge through these nodes (start, end, middle), of which a linear edge uses the first two.
    pub fn point(self, nodes: &[[f64; 2]; 3], s: f64) -> EdgePoint {
        let (values, derivatives) = (self.shape_functions(s), self.shape_derivatives(s));
        let mut point = EdgePoint { position: [0.0; 2], tangent: [0.0; 2] };
        for node in 0..self.node_count() {
            for k in 0..2 {
                point.position[k] += values[node] * nodes[node][k];
                point.tangent[k] += derivatives[node] * nodes[node][k];
            }
        }
        point
    }
}

/// A point of a rule on −1 ≤ s ≤ 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinePoint {
    /// s.
    pub coordinate: f64,
    /// Weight; they sum to 2.
    pub weight: f64,
}

/// The Gauss–Legendre rule of `count` points, in ascending order: exact to degree 2·count − 1. No points for 0.
pub(crate) fn gauss_legendre(count: usize) -> Vec<LinePoint> {
    (0..count).rev().map(|index| gauss_legendre_point(count, index)).collect()
}

/// The root of the Legendre polynomial P_n that is `index` away from the largest, by Newton from Tricomi's estimate.
fn gauss_legendre_point(count: usize, index: usize) -> LinePoint {
    /// Quadratic convergence from an estimate good to 1/n²: five suffice, the rest is margin.
    const ITERATIONS: usize = 10;
    if count == 2 * index + 1 {
        // Exactly 0, which Newton only comes near to.
        let (_, slope) = legendre(count, 0.0);
        return LinePoint { coordinate: 0.0, weight: 2.0 / (slope * slope) };
    }
    let mut s = (std::f64::consts::PI * (index as f64 + 0.75) / (count as f64 + 0.5)).cos();
    for _ in 0..ITERATIONS {
        let (value, slope) = legendre(count, s);
        s -= value / slope;
    }
    let (_, slope) = legendre(count, s);
    LinePoint { coordinate: s, weight: 2.0 / ((1.0 - s) * (1.0 + s) * slope * slope) }
}

/// P_n(s) by its three-term recurrence, and P_n'(s), for |s| < 1.
fn legendre(degree: usize, s: f64) -> (f64, f64) {
    let (mut previous, mut current) = (0.0, 1.0);
    for k in 1..=degree {
        let k = k as f64;
        (previous, current) = (current, ((2.0 * k - 1.0) * s * current - (k - 1.0) * previous) / k);
    }
    (current, degree as f64 * (previous - s * current) / ((1.0 - s) * (1.0 + s)))
}

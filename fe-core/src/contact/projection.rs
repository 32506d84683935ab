//! The foot of a point on a chain: where d(ξ) = x_s − x(ξ) is normal to the direction m(ξ) and nearest (6.14–6.18).

use super::chain::{Chain, Foot};
use crate::plane::dot;

/// Edges that a walk passes before the neighbourhood counts as lost.
const LONGEST_WALK: usize = 16;
/// d·m below this × x'·m counts as 0: rounding of ξ, of order 1.
const ROUNDING: f64 = 1e-13;
/// Newton and bisections on one edge: bisection alone would end within as many.
const MOST_ITERATIONS: usize = 60;

/// Places of an edge are within this × the distance of its farthest node from any centre: Σ|N| ≤ 5/4 on a quadratic edge,
/// and something for rounding.
const REACH: f64 = 1.26;
/// Distance past a smoothed end of its edge, in ξ, within which a foot stays on it until the increment is over: see the
/// module's page.
const OVERSHOOT: f64 = 1e-3;

/// Newton without a bracket.
const FEW_ITERATIONS: usize = 5;
/// Positions are known to a few units of their last place. A foot within it stays where it is: a converged state that is
/// evaluated again gives the same slip, and its law the tangent of the loading that led there.
const POSITION_ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Small step of ξ: its square is rounding.
const SMALL_STEP: f64 = 1e-9;

/// Nearest place of an edge: inside it, or before or after it.
enum OnEdge {
    Inside(f64),
    Before,
    After,
}

/// d·m and its derivative by ξ, and x'·m, at a place in the present configuration.
struct Slope {
    value: f64,
    derivative: f64,
    stretch_squared: f64,
}

/// Searches on a chain whose nodes are at `position`.
pub(super) struct Projection<'a, P: Fn(usize) -> [f64; 2]> {
    pub chain: &'a Chain,
    pub position: P,
}

impl<P: Fn(usize) -> [f64; 2]> Projection<'_, P> {
    /// The foot near another one: a walk along the chain, edge by edge. `None` if it is not found near there.
    pub fn near(&self, point: [f64; 2], last: Foot) -> Option<Foot> {
        if let Some(foot) = self.on_same_edge(point, last) {
            return Some(foot);
        }
        let (mut edge, mut from, mut came) = (last.edge, last.coordinate.clamp(-1.0, 1.0), 0);
        for _ in 0..LONGEST_WALK {
            let side = match self.on_edge(point, edge, from) {
                OnEdge::Inside(coordinate) => return Some(Foot { edge, coordinate, corner: false }),
                OnEdge::Before => -1,
                OnEdge::After => 1,
            };
            let end = side as f64;
            if !self.chain.goes_on(edge, side) {
                let Slope { value, stretch_squared, .. } = self.slope(point, edge, end);
                return Some(Foot { edge, coordinate: end + value / stretch_squared, corner: false });
            }
            if came == -side {
                return Some(Foot { edge, coordinate: end, corner: true });
            }
            (edge, from, came) = (edge + side, -end, side);
        }
        None
    }

    /// The foot on an edge or on its continuation, where it has passed a smoothed end by no more than [`OVERSHOOT`] since
    /// the increment's start, `last`. A foot that was past an end then starts on the next edge.
    fn on_same_edge(&self, point: [f64; 2], last: Foot) -> Option<Foot> {
        let side = |coordinate: f64| if coordinate < 0.0 { -1 } else { 1 };
        let (before, was_past) = (side(last.coordinate), last.coordinate.abs() > 1.0);
        if last.corner || was_past && !self.chain.is_smooth_at(last.edge, before) {
            return None;
        }
        let (edge, from) = if was_past { (last.edge + before, -(before as f64)) } else { (last.edge, last.coordinate) };
        let coordinate = self.close_by(point, edge, from, 1.0 + OVERSHOOT)?;
        let is_inside = coordinate.abs() < 1.0 || self.chain.is_smooth_at(edge, side(coordinate));
        is_inside.then_some(Foot { edge, coordinate, corner: false })
    }

    /// The foot on the whole chain. Edges that are farther away than a place that is known are passed over.
    pub fn anywhere(&self, point: [f64; 2]) -> Option<Foot> {
        let edges = || 0..self.chain.len() as i64;
        let clearances = edges().map(|edge| (self.clearance(point, edge), edge));
        let (_, first) = clearances.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
        let (known, _) = self.nearest_on(point, first);
        let mut nearest = (f64::INFINITY, Foot { edge: 0, coordinate: 0.0, corner: false });
        for edge in edges().filter(|&edge| edge == first || self.clearance(point, edge) <= known) {
            let (distance, coordinate) = self.nearest_on(point, edge);
            if distance < nearest.0 {
                nearest = (distance, Foot { edge, coordinate, corner: false });
            }
        }
        self.near(point, nearest.1)
    }

    /// |d| at the nearest place of an edge, and ξ there.
    fn nearest_on(&self, point: [f64; 2], edge: i64) -> (f64, f64) {
        let mut nearest = (f64::INFINITY, 0.0);
        for start in [-1.0, 0.0, 1.0] {
            let coordinate = match self.on_edge(point, edge, start) {
                OnEdge::Inside(coordinate) => coordinate,
                OnEdge::Before => -1.0,
                OnEdge::After => 1.0,
            };
            let distance = self.distance(point, edge, coordinate);
            if distance < nearest.0 {
                nearest = (distance, coordinate);
            }
        }
        nearest
    }

    /// Returns a lower bound of the distance to an edge: its places lie in a circle around the middle of its ends.
    pub fn clearance(&self, point: [f64; 2], edge: i64) -> f64 {
        let nodes = self.chain.nodes(edge);
        let [a, b] = [0, 1].map(|end| (self.position)(nodes[end]));
        let centre = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        let from_centre = |place: [f64; 2]| (place[0] - centre[0]).hypot(place[1] - centre[1]);
        let radius = nodes.iter().map(|&node| from_centre((self.position)(node))).fold(0.0, f64::max);
        from_centre(point) - REACH * radius
    }

    /// |d| at a place.
    fn distance(&self, point: [f64; 2], edge: i64, coordinate: f64) -> f64 {
        let shape = self.chain.shape(edge, coordinate);
        let mut arm = point;
        for (value, &node) in shape.values.iter().zip(shape.nodes()) {
            let position = (self.position)(node);
            arm = [arm[0] - value * position[0], arm[1] - value * position[1]];
        }
        arm[0].hypot(arm[1])
    }

    fn slope(&self, point: [f64; 2], edge: i64, coordinate: f64) -> Slope {
        let shape = self.chain.shape(edge, coordinate);
        let (mut arm, mut tangent, mut direction, mut turning) = (point, [0.0; 2], [0.0; 2], [0.0; 2]);
        for (k, &node) in shape.nodes().iter().enumerate() {
            let position = (self.position)(node);
            for i in 0..2 {
                arm[i] -= shape.values[k] * position[i];
                tangent[i] += shape.first[k] * position[i];
                direction[i] += shape.turn[k] * position[i];
                turning[i] += shape.turning[k] * position[i];
            }
        }
        let stretch_squared = dot(tangent, direction);
        Slope { value: dot(arm, direction), derivative: dot(arm, turning) - stretch_squared, stretch_squared }
    }

    /// The foot on one edge, near ξ = `from` if there are several.
    fn on_edge(&self, point: [f64; 2], edge: i64, from: f64) -> OnEdge {
        if let Some(coordinate) = self.close_by(point, edge, from, 1.0) {
            return OnEdge::Inside(coordinate);
        }
        let sign = |coordinate: f64| {
            let Slope { value, stretch_squared, .. } = self.slope(point, edge, coordinate);
            if value.abs() <= ROUNDING * stretch_squared { 0.0 } else { value }
        };
        // d·m falls through 0 at a nearest place: the bracket is (positive, negative).
        let (start, end) = (sign(-1.0), sign(1.0));
        let middle = if from.abs() < 1.0 { sign(from) } else { 0.0 };
        match (start > 0.0, end < 0.0) {
            (true, true) => self.within(point, edge, (-1.0, from, 1.0)),
            _ if start == 0.0 && middle <= 0.0 => OnEdge::Inside(-1.0),
            _ if end == 0.0 && middle >= 0.0 => OnEdge::Inside(1.0),
            (true, false) if middle < 0.0 => self.within(point, edge, (-1.0, from, from)),
            (false, true) if middle > 0.0 => self.within(point, edge, (from, from, 1.0)),
            (true, false) => OnEdge::After,
            (false, true) => OnEdge::Before,
            // Both ends are nearer than what lies between: the one that is nearer from here.
            (false, false) if middle > 0.0 || (middle == 0.0 && from > 0.0) => OnEdge::After,
            (false, false) => OnEdge::Before,
        }
    }

    /// The foot at |ξ| < `limit` of one edge by a few steps of Newton alone, which do where the last foot was near.
    fn close_by(&self, point: [f64; 2], edge: i64, from: f64, limit: f64) -> Option<f64> {
        let mut at = from;
        let rounding = POSITION_ROUNDING * point[0].hypot(point[1]);
        for _ in 0..FEW_ITERATIONS {
            let Slope { value, derivative, stretch_squared } = self.slope(point, edge, at);
            if value.abs() <= rounding * stretch_squared.sqrt() && derivative < 0.0 && at.abs() < limit {
                return Some(at);
            }
            let step = -value / derivative;
            at += step;
            if derivative >= 0.0 || step.abs() > 1.0 || at.abs() >= limit {
                return None;
            }
            // The next step would be of the order of this one's square.
            if step.abs() <= SMALL_STEP {
                return Some(at);
            }
        }
        None
    }

    /// Newton between a place where d·m > 0 and one where it is < 0; half an edge at most in one iteration, and
    /// bisection where Newton leaves the bracket.
    fn within(&self, point: [f64; 2], edge: i64, (mut low, from, mut high): (f64, f64, f64)) -> OnEdge {
        let mut at = from.clamp(low, high);
        for _ in 0..MOST_ITERATIONS {
            let Slope { value, derivative, stretch_squared } = self.slope(point, edge, at);
            if value.abs() <= f64::EPSILON * stretch_squared {
                break;
            }
            if value > 0.0 {
                low = low.max(at);
            } else {
                high = high.min(at);
            }
            let step = (-value / derivative).clamp(-1.0, 1.0);
            let newton = at + step;
            let next = if derivative < 0.0 && low < newton && newton < high { newton } else { 0.5 * (low + high) };
            if (next - at).abs() <= f64::EPSILON {
                at = next;
                break;
            }
            at = next;
        }
        OnEdge::Inside(at)
    }
}

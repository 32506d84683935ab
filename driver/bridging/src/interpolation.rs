//! Curves through points: straight lines, and monotone cubics.

/// Straight lines for the cubic between two points.
const LINES: usize = 6;

/// Straight lines through (x, y), x increasing; constant beyond both ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyline {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Polyline {
    /// Interpolates through points by rising x; of points at one x the last counts.
    pub fn new(points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut line = Self::default();
        for (x, y) in points {
            if line.x.last().is_some_and(|&last| x <= last) {
                line.x.pop();
                line.y.pop();
            }
            line.x.push(x);
            line.y.push(y);
        }
        line
    }

    /// Returns the monotone cubic through (x, y), x increasing, as straight lines.
    pub(crate) fn smooth(x: &[f64], y: &[f64]) -> Self {
        let slopes = monotone_slopes(x, y);
        let between = x.windows(2).flat_map(|ends| {
            (0..LINES).map(|k| ends[0] + (ends[1] - ends[0]) * k as f64 / LINES as f64).collect::<Vec<_>>()
        });
        let all = between.chain(x.last().copied());
        Self::new(all.map(|x_k| (x_k, monotone(x_k, x, y, &slopes))))
    }

    /// The points.
    pub fn points(&self) -> impl DoubleEndedIterator<Item = (f64, f64)> + '_ {
        self.x.iter().copied().zip(self.y.iter().copied())
    }

    /// y at x.
    pub fn at(&self, x: f64) -> f64 {
        self.at_place(self.place(x))
    }

    /// The index of the point after x, with the part of the way to it.
    pub(crate) fn place(&self, x: f64) -> (usize, f64) {
        let right = self.x.partition_point(|&node| node < x);
        if right == 0 {
            (0, 1.0)
        } else if right == self.x.len() {
            (right - 1, 1.0)
        } else {
            (right, (x - self.x[right - 1]) / (self.x[right] - self.x[right - 1]))
        }
    }

    /// y at a place of a line with the same x.
    pub(crate) fn at_place(&self, (right, part): (usize, f64)) -> f64 {
        match (self.y.get(right.wrapping_sub(1)), self.y.get(right)) {
            (Some(from), Some(to)) => from + part * (to - from),
            (None, Some(first)) => *first,
            _ => 0.0,
        }
    }

    /// The least x at which y, or the greatest y if that is less, is reached, of a line that never falls.
    pub fn first_reaching(&self, y: f64) -> f64 {
        let y = self.y.last().map_or(y, |&last| y.min(last));
        let right = self.y.partition_point(|&value| value < y);
        let (Some(&to), Some(&above)) = (self.x.get(right), self.y.get(right)) else { return 0.0 };
        if right == 0 {
            return to;
        }
        let (from, below) = (self.x[right - 1], self.y[right - 1]);
        from + (y - below) / (above - below) * (to - from)
    }

    /// The greatest y so far, as a line over x.
    pub fn highest(&self) -> Self {
        let mut greatest = f64::NEG_INFINITY;
        let highest = self.points().map(|(x, y)| {
            greatest = greatest.max(y);
            (x, greatest)
        });
        Self::new(highest.collect::<Vec<_>>())
    }
}

/// Slopes at the nodes of the monotone cubic through (x, y) (Fritsch and Butland 1984, as PCHIP has them).
pub fn monotone_slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    let step: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let secant: Vec<f64> = y.windows(2).zip(&step).map(|(pair, step)| (pair[1] - pair[0]) / step).collect();
    let end = |h_0: f64, h_1: f64, d_0: f64, d_1: f64| {
        let slope = ((2.0 * h_0 + h_1) * d_0 - h_0 * d_1) / (h_0 + h_1);
        if slope * d_0 <= 0.0 {
            0.0
        } else if d_0 * d_1 < 0.0 && slope.abs() > 3.0 * d_0.abs() {
            3.0 * d_0
        } else {
            slope
        }
    };
    match n {
        0 | 1 => vec![0.0; n],
        2 => vec![secant[0]; 2],
        _ => {
            let mut slopes = vec![end(step[0], step[1], secant[0], secant[1])];
            for k in 1..n - 1 {
                let (before, after) = (secant[k - 1], secant[k]);
                slopes.push(if before * after <= 0.0 {
                    0.0
                } else {
                    let (w_1, w_2) = (2.0 * step[k] + step[k - 1], step[k] + 2.0 * step[k - 1]);
                    (w_1 + w_2) / (w_1 / before + w_2 / after)
                });
            }
            slopes.push(end(step[n - 2], step[n - 3], secant[n - 2], secant[n - 3]));
            slopes
        }
    }
}

/// The cubic through two nodes (x, y) with their slopes, at x.
fn cubic(x: f64, nodes: [f64; 2], values: [f64; 2], slopes: [f64; 2]) -> f64 {
    let step = nodes[1] - nodes[0];
    let t = (x - nodes[0]) / step;
    let u = 1.0 - t;
    values[0] * u * u * (1.0 + 2.0 * t)
        + values[1] * t * t * (1.0 + 2.0 * u)
        + step * t * u * (slopes[0] * u - slopes[1] * t)
}

/// Returns the monotone cubic through (nodes, values) at x, constant beyond both ends; `slopes` are
/// [`monotone_slopes`].
pub fn monotone(x: f64, nodes: &[f64], values: &[f64], slopes: &[f64]) -> f64 {
    let right = nodes.partition_point(|&node| node < x);
    if right == 0 {
        return values[0];
    }
    if right == nodes.len() {
        return values[right - 1];
    }
    let left = right - 1;
    cubic(x, [nodes[left], nodes[right]], [values[left], values[right]], [slopes[left], slopes[right]])
}

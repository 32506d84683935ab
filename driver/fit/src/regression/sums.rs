//! Straight lines by weighted least squares over any stretch of the points, each in constant time.

/// A straight line y = a + b x, and what is left: Σ w (y − a − b x)².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    /// a.
    pub intercept: f64,
    /// b.
    pub slope: f64,
    /// The sum of squares.
    pub residual: f64,
}

/// Running sums of w, wx, wy, wxx, wxy, wyy.
#[derive(Clone, Debug)]
pub struct Sums(Vec<[f64; 6]>);

impl Sums {
    /// Sums over points (x, y, w).
    pub fn of(points: impl IntoIterator<Item = [f64; 3]>) -> Self {
        let mut sums = vec![[0.0; 6]];
        let mut total = [0.0; 6];
        for [x, y, w] in points {
            let terms = [w, w * x, w * y, w * x * x, w * x * y, w * y * y];
            total.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            sums.push(total);
        }
        Self(sums)
    }

    fn over(&self, from: usize, to: usize) -> [f64; 6] {
        std::array::from_fn(|k| self.0[to][k] - self.0[from][k])
    }

    /// The best line over the points from..to; `None` if they are at one x.
    pub fn line(&self, from: usize, to: usize) -> Option<Line> {
        let [w, x, y, xx, xy, yy] = self.over(from, to);
        let (sxx, sxy, syy) = (xx - x * x / w, xy - x * y / w, yy - y * y / w);
        let slope = sxy / sxx;
        let line = Line { slope, intercept: (y - slope * x) / w, residual: (syy - slope * sxy).max(0.0) };
        (sxx > f64::EPSILON * xx && slope.is_finite()).then_some(line)
    }

    /// The best line through the origin over the points from..to; `None` if they are there themselves.
    pub fn line_through_origin(&self, from: usize, to: usize) -> Option<Line> {
        let [_, _, _, xx, xy, yy] = self.over(from, to);
        let slope = xy / xx;
        slope.is_finite().then(|| Line { intercept: 0.0, slope, residual: (yy - slope * xy).max(0.0) })
    }
}

//! The power of x with which y grows.

/// The slope of the straight line with the least squares through the logarithms of points. `None`: fewer than two
/// points are positive.
pub fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let positive = points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0 && y.is_finite());
    let logarithms: Vec<(f64, f64)> = positive.map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logarithms.len() as f64;
    let (x, y) = logarithms.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
    let (above, below) = logarithms.iter().fold((0.0, 0.0), |(above, below), point| {
        (above + (point.0 - x) * (point.1 - y), below + (point.0 - x).powi(2))
    });
    (logarithms.len() > 1 && below > 0.0).then(|| above / below)
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn powers_have_their_exponents() {
        let of = |power: f64| [1e3, 4e3, 2e4, 2e5].map(|x: f64| (x, 3e-5 * x.powf(power)));
        for power in [0.0, 1.0, 1.3, 1.5, -2.0] {
            assert!((exponent(&of(power)).unwrap() - power).abs() < 1e-12, "{power}");
        }
    }

    #[test]
    fn the_squares_are_the_least() {
        // logarithms 0, 1, 2 and 0, 2, 1: the slope is Σ(x − 1)(y − 1)/Σ(x − 1)² = 1/2
        let e = std::f64::consts::E;
        let points = [(1.0, 1.0), (e, e * e), (e * e, e)];
        assert!((exponent(&points).unwrap() - 0.5).abs() < 1e-14);
    }

    #[test]
    fn one_point_has_no_slope() {
        assert_eq!(exponent(&[(1.0, 2.0)]), None);
        assert_eq!(exponent(&[(2.0, 2.0), (2.0, 3.0)]), None);
        assert_eq!(exponent(&[(1.0, 2.0), (2.0, 0.0), (3.0, f64::NAN)]), None);
    }
}

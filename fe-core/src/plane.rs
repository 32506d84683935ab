//! Vectors of the plane, and others as short.

/// a · b.
pub(crate) fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// a − b.
pub(crate) fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// The principal values in the plane of a tensor 11, 22, 33, 12, the greater one first.
pub(crate) fn principal([t11, t22, _, t12]: [f64; 4]) -> [f64; 2] {
    let (mean, radius) = (0.5 * (t11 + t22), (0.5 * (t11 - t22)).hypot(t12));
    [mean + radius, mean - radius]
}

/// |a − b|.
pub(crate) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The least and the greatest of some values; ∞ and −∞ of none.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, greatest], value| [least.min(value), greatest.max(value)])
}

//! Deterministic random strain paths, and how far two arrays are apart.

use battery::{Random, worst};

/// Strain increments of a path that wanders between random corners of the given size, with `ntens` components.
pub fn strain_path(seed: u64, ntens: usize, size: f64, increments: usize) -> Vec<[f64; 6]> {
    const INCREMENTS_PER_LEG: usize = 5;
    let mut random = Random::new(seed);
    let mut corner = [0.0; 6];
    let mut path = Vec::with_capacity(increments);
    while path.len() < increments {
        let mut next = [0.0; 6];
        next[..ntens].fill_with(|| size * random.signed());
        let increment = std::array::from_fn(|i| (next[i] - corner[i]) / INCREMENTS_PER_LEG as f64);
        path.extend(std::iter::repeat_n(increment, INCREMENTS_PER_LEG.min(increments - path.len())));
        corner = next;
    }
    path
}

/// Largest difference of two arrays relative to the largest entry; NaN counts as infinite.
pub fn difference(left: &[f64], right: &[f64]) -> f64 {
    assert_eq!(left.len(), right.len(), "arrays of one length");
    let scale = right.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    worst(left.iter().zip(right).map(|(a, b)| (a - b).abs())) / scale
}

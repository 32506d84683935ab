//! Fewer points, same picture.

use super::axis::drawable;

/// Most points that a drawn line has.
pub(super) const MOST_POINTS: usize = 2000;

/// Picks x or y of a point.
pub(super) type Coordinate = fn(&(f64, f64)) -> f64;

/// Reduces points to at most `most` (if ≥ 12) in the same order. The sequence is cut into sections, and each keeps its first and
/// last point and the extremes of x and y. Peaks and loops keep their true height.
pub(super) fn decimate(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    if points.len() <= most {
        return points.to_vec();
    }
    let stretches = (most / 6).max(1);
    let mut kept = Vec::with_capacity(most);
    for stretch in points.chunks(points.len().div_ceil(stretches)) {
        let mut indices = vec![0, stretch.len() - 1];
        let coordinates: [Coordinate; 2] = [|point| point.0, |point| point.1];
        for coordinate in coordinates {
            let order = |a: &usize, b: &usize| coordinate(&stretch[*a]).total_cmp(&coordinate(&stretch[*b]));
            indices.extend((0..stretch.len()).min_by(order));
            indices.extend((0..stretch.len()).max_by(order));
        }
        indices.sort_unstable();
        indices.dedup();
        kept.extend(indices.into_iter().map(|index| stretch[index]));
    }
    kept
}

/// The stretches between points that cannot be drawn.
pub(super) fn drawable_stretches(points: &[(f64, f64)]) -> impl Iterator<Item = &[(f64, f64)]> {
    points.split(|&(x, y)| !drawable(x) || !drawable(y)).filter(|stretch| !stretch.is_empty())
}

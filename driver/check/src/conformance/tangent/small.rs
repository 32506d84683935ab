//! Small entries of a stiffness: where rows differ much in size, as those of fibres and of nearly incompressible materials do, an
//! entry may be wrong by all of itself and still be little of the largest.

use super::super::subject::{Answer, CheckedEntryPoint, Subject, largest};
use super::super::tolerances::{
    DIFFERENCES_DECIDE, PLANE_STRESS_ITERATION, ROUNDING_OF_F, SMALL_ENTRY, SMALL_ENTRY_RESOLVED,
};
use super::{Mismatch, STEPS, Scale};

/// Returns the entry of a UMAT's DDSDDE that differs most from the differences, relative to its own row and column, and that
/// scale; `None` if all are right as far as the differences resolve them. `quotients`: one matrix for each of [`STEPS`].
pub(super) fn wrong_entry(
    subject: &Subject<'_>,
    quotients: &[Vec<f64>],
    answer: &Answer,
    sizes: &[f64],
) -> Option<(Mismatch, Scale)> {
    let reported = &answer.tangent;
    if !matches!(subject.entry, CheckedEntryPoint::Umat(_)) || quotients.len() < STEPS.len() {
        return None;
    }
    let n = subject.entry.inputs();
    let matrices: Vec<&[f64]> = quotients.iter().chain([reported]).map(Vec::as_slice).collect();
    let scale = Scale::of_rows_and_columns(n, &matrices);
    // what iterations and rounding may leave of a stress
    let stiffness = largest(reported);
    let of_gradient = if subject.finite { ROUNDING_OF_F * stiffness } else { 0.0 };
    let noise = PLANE_STRESS_ITERATION * (stiffness * largest(sizes) + largest(&answer.output)) + of_gradient;
    let mut worst: Option<(f64, usize, usize)> = None;
    for k in 0..reported.len() {
        let errors: Vec<f64> = quotients.iter().map(|matrix| (matrix[k] - reported[k]).abs()).collect();
        let best = (0..errors.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b]))?;
        let (column, relative) = (k % n, errors[best] * scale.weights[k]);
        // with the two next steps, on both sides if there are such
        let first = best.saturating_sub(1).min(errors.len() - 3);
        let agree = (first..first + 3)
            .all(|other| (quotients[other][k] - quotients[best][k]).abs() <= DIFFERENCES_DECIDE * errors[best]);
        let is_resolved = errors[best] > SMALL_ENTRY_RESOLVED * noise / (STEPS[best] * sizes[column]);
        if relative > SMALL_ENTRY && agree && is_resolved && worst.is_none_or(|(error, ..)| relative > error) {
            worst = Some((relative, k, best));
        }
    }
    let (error, k, best) = worst?;
    let differences = quotients[best].clone();
    let (expected, found) = (differences[k], reported[k]);
    Some((Mismatch { error, row: k / n, column: k % n, expected, found, differences, is_small: true }, scale))
}

//! Proportional paths: results that must not depend on the number of increments.

use super::proportional::{deviation, equal, stress_after};
use super::{Random, Sample};
use umat_abi::law::{Law, StressState};

/// One, ten, … increments of a proportional path end at the same stress to 1e-12.
pub fn check_path_exactness<L: Law>(sample: &Sample<'_>, stress_state: StressState, strain: &[f64; 6], counts: &[u32]) {
    let after = |count: u32| stress_after::<L>(sample, stress_state, strain, equal(count));
    let expected = after(counts[0]);
    for &count in &counts[1..] {
        let stress = after(count);
        assert!(
            deviation(&stress, &expected) <= 1e-12,
            "{}: {count} increments: {stress:?} against {expected:?}",
            L::INFO.name.to_string_lossy(),
        );
    }
}

/// Increments of a proportional path whose end stress must be the same.
pub const PATH_COUNTS: [u32; 4] = [1, 10, 1000, 100_000];

/// [`check_path_exactness`] in random directions to strains of a third of the size to ten times it: `many` with the
/// first three counts, `few` of them with all.
pub fn check_random_paths<L: Law>(
    sample: &Sample<'_>,
    stress_state: StressState,
    many: usize,
    few: usize,
    counts: &[u32],
) {
    let mut random = Random::new(0x9A7B);
    for number in 0..many {
        let scale = sample.size * 10_f64.powf(1.5 * random.unit() - 0.5);
        let strain = random.strain(stress_state, scale);
        let all = if number < few { counts.len() } else { counts.len().min(3) };
        check_path_exactness::<L>(sample, stress_state, &strain, &counts[..all]);
    }
}

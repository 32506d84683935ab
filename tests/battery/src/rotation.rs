//! A rotated history gives the rotated stress.

use super::{Random, Sample, rotated};
use umat_abi::law::{Law, StressState};

/// Returns the largest difference between the stresses of a random history and of the same one turned (in the plane
/// states about axis 3), over 1e-12 of the largest stress and the rounding of the elastic one; and the strain at which
/// it occurs.
pub fn rotation_error<L: Law>(sample: &Sample<'_>, stress_state: StressState, random: &mut Random) -> (f64, [f64; 6]) {
    let rotation = random.rotation_in(stress_state);
    let mut point = sample.point::<L>(stress_state);
    let mut turned = sample.point::<L>(stress_state);
    let mut worst = (0.0_f64, [0.0; 6]);
    for _ in 0..3 {
        let strain = sample.strain(random, stress_state);
        let stress = point.advance(&strain).stress;
        let turned_stress = turned.advance(&rotated(&strain, &rotation, 2.0)).stress;
        let expected = rotated(&stress, &rotation, 1.0);
        let largest = stress.iter().fold(1e-300_f64, |m, x| m.max(x.abs()));
        // a stress far below the elastic one is the difference of large numbers
        let elastic = strain.iter().fold(0.0_f64, |m, x| m.max(x.abs())) * sample.props[0];
        let allowed = 1e-12 * largest + 1e-15 * elastic;
        for i in 0..6 {
            let error = (turned_stress[i] - expected[i]).abs() / allowed;
            if error > worst.0 || error.is_nan() {
                worst = (error, strain);
            }
        }
    }
    worst
}

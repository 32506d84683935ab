//! Work = stored + dissipated on fine paths, and hyperelasticity while damage rests.

use super::{Point, Random};
use models::tensor::work;
use umat_abi::law::{Law, StressState};

/// Sums over the steps of random paths, relative to Σ |σ_mid : Δε|.
#[derive(Clone, Copy, Debug)]
pub struct Imbalance {
    /// Σ |σ_mid : Δε − ΔΨ − Δdissipation|.
    pub absolute: f64,
    /// The part of it that the law gave back without having received it.
    pub created: f64,
}

/// The energy balance of random paths. Each path has three straight legs of `steps` increments. Where σ is continuous a step's share is
/// O(Δε³), at a kink O(Δε²), at a jump of σ O(Δε): the sum falls as 1/steps² or, with jumps, 1/steps.
pub fn imbalance<L: Law>(props: &[f64], stress_state: StressState, size: f64, paths: usize, steps: u32) -> Imbalance {
    let mut random = Random::new(0xE4E6);
    let (mut absolute, mut created, mut scale) = (0.0, 0.0, 0.0);
    for _ in 0..paths {
        let mut point = Point::<L>::virgin(props, stress_state);
        let (mut stored, mut dissipated) = (0.0, 0.0);
        for _ in 0..3 {
            let from = point.strain;
            let leg_size = size * 10_f64.powf(random.unit() - 0.5);
            let to = random.strain(stress_state, leg_size);
            for step in 1..=steps {
                let at = |s: f64| -> [f64; 6] {
                    std::array::from_fn(|i| from[i] + (to[i] - from[i]) * s / f64::from(steps))
                };
                let (start, end) = (at(f64::from(step - 1)), at(f64::from(step)));
                let middle = point.trial(&at(f64::from(step) - 0.5)).0.stress;
                let increment: [f64; 6] = std::array::from_fn(|i| end[i] - start[i]);
                let response = point.advance(&end);
                let done = work(&middle, &increment);
                let surplus = done - (response.stored_energy - stored) - (response.dissipated_energy - dissipated);
                absolute += surplus.abs();
                created += (-surplus).max(0.0);
                scale += done.abs();
                (stored, dissipated) = (response.stored_energy, response.dissipated_energy);
            }
        }
    }
    Imbalance { absolute: absolute / scale, created: created / scale }
}

/// After damage, on closed triangles of strain small enough not to add to it: the tangent is
/// symmetric to 1e-12 and the work of the loop is at most `tolerance` of the work's absolute value.
/// Returns how many loops of `count` left the first state untouched and were compared.
pub fn check_frozen_damage<L: Law>(
    props: &[f64],
    stress_state: StressState,
    size: f64,
    count: usize,
    (steps, tolerance): (u32, f64),
) -> usize {
    let mut random = Random::new(0xF402);
    let mut compared = 0;
    for _ in 0..count {
        let mut point = Point::<L>::virgin(props, stress_state);
        let damaging = random.strain(stress_state, size);
        point.advance(&damaging);
        let corners: [[f64; 6]; 3] = std::array::from_fn(|_| random.strain(stress_state, 0.2 * size));
        let history = point.state[..point.state.len() - 2].to_vec();
        point.advance(&corners[2]);
        let (mut sum, mut scale, mut symmetric) = (0.0, 0.0_f64, true);
        for corner in corners {
            let from = point.strain;
            for step in 1..=steps {
                let at = |s: f64| -> [f64; 6] {
                    std::array::from_fn(|i| from[i] + (corner[i] - from[i]) * s / f64::from(steps))
                };
                let middle = point.trial(&at(f64::from(step) - 0.5)).0.stress;
                let end = at(f64::from(step));
                let done = work(&middle, &std::array::from_fn(|i| end[i] - point.strain[i]));
                let tangent = point.advance(&end).tangent;
                sum += done;
                scale += done.abs();
                let largest = tangent.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
                symmetric &= (0..6).all(|i| (0..i).all(|j| (tangent[i][j] - tangent[j][i]).abs() <= 1e-12 * largest));
            }
        }
        if point.state[..history.len()] == history[..] {
            compared += 1;
            assert!(symmetric, "tangent at frozen damage is not symmetric");
            assert!(sum.abs() <= tolerance * scale, "closed loop does {sum:e} of {scale:e} at frozen damage");
        }
    }
    compared
}

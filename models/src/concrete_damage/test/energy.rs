//! Thermodynamics: convexity at frozen damage, dissipation, energy balance.

use super::*;
use crate::tensor::work;
use approx::assert_relative_eq;

/// Smallest eigenvalue of a symmetric 6×6 matrix by cyclic Jacobi rotations.
pub(super) fn smallest_eigenvalue(mut m: [[f64; 6]; 6]) -> f64 {
    for _ in 0..60 {
        for p in 0..6 {
            for q in p + 1..6 {
                if m[p][q] == 0.0 {
                    continue;
                }
                let angle = 0.5 * (2.0 * m[p][q]).atan2(m[q][q] - m[p][p]);
                let (s, c) = angle.sin_cos();
                for k in 0..6 {
                    (m[k][p], m[k][q]) = (c * m[k][p] - s * m[k][q], s * m[k][p] + c * m[k][q]);
                }
                for k in 0..6 {
                    (m[p][k], m[q][k]) = (c * m[p][k] - s * m[q][k], s * m[p][k] + c * m[q][k]);
                }
            }
        }
    }
    (0..6).map(|i| m[i][i]).fold(f64::INFINITY, f64::min)
}

#[test]
fn frozen_damage_gives_a_symmetric_positive_stiffness() {
    let props = defaults();
    let mut random = Random::new(0xC0);
    for stress_state in STRESS_STATES {
        for _ in 0..2000 {
            let mut point = Point::<ConcreteDamage>::virgin(&props, stress_state);
            // damage beyond anything that the strains tried below can add to
            point.state[..4].copy_from_slice(&[10_f64.powf(6.0 * random.unit() - 3.0), 0.0, 1e9, 1e9]);
            point.state[1] = 10_f64.powf(6.0 * random.unit() - 3.0);
            let strain = random.strain(stress_state, 1e-3);
            let c = point.trial(&strain).0.tangent;
            let scale = c.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
            for i in 0..6 {
                for j in 0..i {
                    assert!((c[i][j] - c[j][i]).abs() <= 1e-12 * scale);
                }
            }
            assert!(smallest_eigenvalue(c) >= -1e-12 * scale, "{:e}", smallest_eigenvalue(c) / scale);
        }
    }
}

/// Random smooth paths of `count` increments: work done = energy stored + dissipated, with an error that
/// falls with the square of the increment.
fn balance_error(props: &[f64; 14], stress_state: StressState, length: Option<f64>, seed: u64, count: u32) -> f64 {
    let mut random = Random::new(seed);
    let waves: Vec<[f64; 6]> = (0..3).map(|_| random.strain(stress_state, 3e-4)).collect();
    let mut point = Point::<ConcreteDamage>::virgin(props, stress_state);
    point.characteristic_length = length;
    let (mut done, mut stored) = (0.0, 0.0);
    for i in 1..=count {
        let t = f64::from(i) / f64::from(count);
        let strain: [f64; 6] = std::array::from_fn(|k| {
            waves.iter().enumerate().map(|(n, w)| w[k] * (t * (n as f64 + 1.0) * std::f64::consts::PI).sin()).sum()
        });
        let (old_strain, old_stress) = (point.strain, point.stress);
        let before = point.state[DISSIPATED_ENERGY_STATE];
        let response = point.advance(&strain);
        assert!(response.dissipated_energy >= before);
        let mean = std::array::from_fn(|k| 0.5 * (old_stress[k] + response.stress[k]));
        done += work(&mean, &std::array::from_fn(|k| strain[k] - old_strain[k]));
        stored = response.stored_energy;
        assert!(stored >= 0.0);
    }
    let dissipated = point.state[DISSIPATED_ENERGY_STATE];
    (done - stored - dissipated).abs() / dissipated.max(1e-300)
}

#[test]
fn work_is_stored_or_dissipated() {
    for (props, length) in variants() {
        for stress_state in STRESS_STATES {
            for seed in 1..=3 {
                let coarse = balance_error(&props, stress_state, length, seed, 1000);
                let fine = balance_error(&props, stress_state, length, seed, 8000);
                assert!(fine < 2e-4, "{stress_state:?} {seed}: {coarse:e} {fine:e} {props:?}");
                println!("{coarse:.1e} {fine:.1e}");
                assert!(fine < coarse / 8.0 || fine < 1e-5, "{stress_state:?} {seed}: {coarse:e} {fine:e}");
            }
        }
    }
}

/// In uniaxial stress the dissipated energy does not depend on the increments, and is ∫ σ dε − Ψ.
#[test]
fn uniaxial_dissipation_is_exact() {
    for (props, length) in [(defaults(), None), (with(defaults(), &[("G_f", 0.1), ("G_c", 25.0)]), Some(20.0))] {
        for end in [8e-4, -5e-3] {
            let mut reference = None;
            for count in [1, 7, 100, 20_000] {
                let mut path = StressRatio::virgin(&props, 0.0);
                path.point.characteristic_length = length;
                let (mut done, mut last) = (0.0, 0.0);
                for i in 1..=count {
                    let stress = path.advance(end * f64::from(i) / f64::from(count));
                    done += 0.5 * (last + stress) * end / f64::from(count);
                    last = stress;
                }
                let dissipated = path.point.state[DISSIPATED_ENERGY_STATE];
                assert_relative_eq!(dissipated, *reference.get_or_insert(dissipated), max_relative = 1e-10);
                if count == 20_000 {
                    assert_relative_eq!(dissipated, done - 0.5 * last * end, max_relative = 1e-6);
                }
            }
        }
    }
}

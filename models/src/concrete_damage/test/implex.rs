//! IMPL-EX integration against the implicit law.

use super::*;
use crate::tensor::work;
use approx::assert_relative_eq;
use battery::worst;
use umat_abi::law::parameters_of;

/// A crack that opens while it is sheared, the sides pressed: 3 times the strain of the peak.
const PATH: [f64; 6] = [3e-4, -8e-5, -4e-5, 1.2e-4, 0.0, 0.0];
const OVERSTRESS_WORK: usize = 11;
const ETA_T_APPLIED: usize = 7;
const RESISTANCE: f64 = 2e-5;

pub(super) fn banded() -> [f64; 14] {
    with(defaults(), &[("G_f", 0.1), ("G_c", 20.0)])
}

fn virgin<'p>(props: &'p [f64; 14], stress_state: StressState) -> Point<'p, ConcreteDamageImplex> {
    virgin_of(props, stress_state)
}

pub(super) fn virgin_of<'p, L: Law>(props: &'p [f64], stress_state: StressState) -> Point<'p, L> {
    let mut point = Point::virgin(props, stress_state);
    point.characteristic_length = Some(20.0);
    point
}

fn part(path: &[f64; 6], progress: f64) -> [f64; 6] {
    path.map(|component| component * progress)
}

fn along(stress_state: StressState, mut path: [f64; 6]) -> [f64; 6] {
    if stress_state == StressState::PlaneStress {
        path[2] = 0.0;
    }
    path
}

/// Returns the greatest deviation from the implicit law along the softening half of a path of `count` increments,
/// without the stress that resists crack opening, and the work of the overstress from the virgin state.
fn deviation(stress_state: StressState, count: u32) -> [f64; 2] {
    let props = banded();
    let path = along(stress_state, PATH);
    let mut point = virgin(&props, stress_state);
    let mut implicit = Point::<ConcreteDamage>::virgin(&props, stress_state);
    implicit.characteristic_length = point.characteristic_length;
    let mut greatest: f64 = 0.0;
    for i in 1..=count {
        let strain = part(&path, f64::from(i) / f64::from(count));
        let (found, expected) = (point.advance(&strain).stress, implicit.advance(&strain).stress);
        if 2 * i > count {
            // that of an undamaged point is elastic
            let mut elastic = virgin(&props, stress_state);
            let elastic = elastic.advance(&part(&path, 1.0 / f64::from(count))).stress;
            let damage = point.state[ETA_T_APPLIED] / (1.0 + point.state[ETA_T_APPLIED]);
            let error = |i: usize| (found[i] - expected[i] - RESISTANCE * damage * elastic[i]).abs();
            greatest = worst((0..6).map(error).chain([greatest]));
        }
    }
    [greatest, point.state[OVERSTRESS_WORK]]
}

#[test]
fn deviates_from_the_implicit_law_by_second_order() {
    for stress_state in STRESS_STATES {
        let [coarse, fine] = [400, 800].map(|count| deviation(stress_state, count));
        let [deviation, work] = [0, 1].map(|i| (coarse[i] / fine[i]).log2());
        assert!(fine[0] > 0.0 && (1.7..2.3).contains(&deviation), "{stress_state:?}: order {deviation}");
        assert!(fine[1] > 0.0 && (0.95..2.3).contains(&work), "{stress_state:?}: order {work}");
    }
}

#[test]
fn is_the_implicit_law_until_damage_begins() {
    let props = banded();
    for stress_state in STRESS_STATES {
        let mut point = virgin(&props, stress_state);
        let mut implicit = Point::<ConcreteDamage>::virgin(&props, stress_state);
        implicit.characteristic_length = point.characteristic_length;
        for progress in [0.1, 0.2, -0.1] {
            let strain = part(&along(stress_state, PATH), progress);
            let (found, expected) = (point.advance(&strain), implicit.advance(&strain));
            assert_eq!((found.stress, found.tangent), (expected.stress, expected.tangent));
            assert_eq!(found.stored_energy, expected.stored_energy);
        }
        assert_eq!(point.state[OVERSTRESS_WORK], 0.0);
    }
}

/// The parameters on the page are those of the implicit law.
#[test]
fn its_page_has_the_states_that_hosts_see() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/src/concrete_damage/implex.md");
    battery::pages::check(page, &ConcreteDamageImplex::INFO, &[STATES]);
}

#[test]
fn tangent_is_the_derivative_of_the_stress_symmetric_and_positive() {
    check_tangent::<ConcreteDamageImplex>(&banded());
}

pub(super) fn check_tangent<L: Law>(props: &[f64]) {
    let sample = Sample { characteristic_length: Some(20.0), ..Sample::new(props, 3e-4) };
    battery::check_tangents::<L>("IMPL-EX", &[sample]);
    let mut random = Random::new(0x1E);
    for stress_state in STRESS_STATES {
        for _ in 0..300 {
            let mut point = virgin_of::<L>(props, stress_state);
            for _ in 0..4 {
                point.advance(&random.strain(stress_state, 3e-4));
            }
            let c = point.trial(&random.strain(stress_state, 1e-3)).0.tangent;
            let scale = c.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
            for i in 0..6 {
                for j in 0..i {
                    assert!((c[i][j] - c[j][i]).abs() <= 1e-12 * scale, "{c:?}");
                }
            }
            assert!(energy::smallest_eigenvalue(c) >= -1e-12 * scale);
        }
    }
}

#[test]
fn work_is_stored_and_dissipated_to_the_last_digits() {
    check_work::<ConcreteDamageImplex>(&banded());
}

pub(super) fn check_work<L: Law>(props: &[f64]) {
    for stress_state in STRESS_STATES {
        let mut point = virgin_of::<L>(props, stress_state);
        let (mut done, mut stored) = (0.0, 0.0);
        for i in 0..300 {
            // there, halfway back, and further
            let progress =
                [0.004 * f64::from(i), 0.8 - 0.004 * f64::from(i), 0.012 * f64::from(i) - 2.4][(i / 100) as usize];
            let (strain, stress) = (point.strain, point.stress);
            let response = point.advance(&part(&along(stress_state, PATH), progress));
            let increment: [f64; 6] = std::array::from_fn(|i| point.strain[i] - strain[i]);
            let mean: [f64; 6] = std::array::from_fn(|i| 0.5 * (stress[i] + response.stress[i]));
            done += work(&mean, &increment);
            stored = response.stored_energy;
        }
        let dissipated = point.state.last().copied().unwrap_or_default();
        assert_relative_eq!(done, stored + dissipated, max_relative = 1e-12);
        assert!(dissipated > 0.0);
    }
}

/// Increments of unequal length lag no more than equal ones of the greater length if DTIME gives their lengths.
#[test]
fn the_time_increment_scales_the_extrapolation() {
    let props = banded();
    let lag = |times: [f64; 2]| {
        let mut point = virgin(&props, StressState::ThreeD);
        let mut progress = 0.0;
        for i in 0..400 {
            let which = i % 2;
            progress += [0.001, 0.004][which];
            point.time_increment = times[which];
            point.advance(&part(&PATH, progress));
        }
        point.state[OVERSTRESS_WORK]
    };
    let (scaled, unscaled) = (lag([1.0, 4.0]), lag([1.0, 1.0]));
    assert!(scaled < 0.5 * unscaled, "{scaled:e} {unscaled:e}");
}

/// A point fails within one increment and its stress lags. The shorter the increments, the more slowly the remaining
/// stress is released; in the end all of it is.
#[test]
fn a_lag_is_made_up_in_as_small_parts_as_increments_are_short() {
    let props = banded();
    let failed = part(&PATH, 20.0);
    let lagging = || {
        let mut point = virgin(&props, StressState::ThreeD);
        point.advance(&part(&PATH, 0.2));
        point.advance(&failed);
        point
    };
    let size = |stress: [f64; 6]| stress.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
    let change = |time: f64| {
        let mut point = lagging();
        point.time_increment = time;
        let before = point.stress;
        let after = point.advance(&failed).stress;
        size(std::array::from_fn(|i| after[i] - before[i])) / size(before)
    };
    assert!(change(1.0) > 0.5, "{}", change(1.0));
    for time in [0.1, 1e-3, 1e-6] {
        assert!(change(time) <= 2.0 * time, "{time}: {}", change(time));
    }
    let mut implicit = Point::<ConcreteDamage>::virgin(&props, StressState::ThreeD);
    implicit.characteristic_length = Some(20.0);
    let settled = implicit.advance(&failed).stress;
    let mut point = lagging();
    point.time_increment = 0.1;
    (0..40).for_each(|_| _ = point.advance(&failed));
    for (found, expected) in point.stress.iter().zip(&settled) {
        assert_relative_eq!(*found, *expected, max_relative = 1e-9, epsilon = 1e-9);
    }
}

#[test]
fn inelastic_strain_is_refused() {
    let props = with(defaults(), &[("b_t", 0.3)]);
    let error = parameters_of::<ConcreteDamageImplex>(&props).expect_err("b_t");
    assert!(error.to_string().contains("b_t and b_c must be 0"), "{error}");
}

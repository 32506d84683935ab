//! Cracks of fixed direction against closed forms.

use super::implex::{banded, check_tangent, check_work, virgin_of};
use super::*;
use crate::concrete_damage::fixed_crack::FreeCracks;
use crate::concrete_damage::split::Split;
use crate::tensor::{Elasticity, Spectral, work};
use approx::assert_relative_eq;

/// Strain at which a crack band of 20 mm is open by 2 mm: nothing is left of the strength.
const OPEN: f64 = 0.1;
/// Far from crushing.
const PRESSED: f64 = -3e-5;
/// Increments of a path, which damage is to follow.
const COUNT: u32 = 400;

/// Frictions of closed cracks: usual ones, and the greatest.
const FRICTIONS: [f64; 2] = [0.5, 1.0];

/// The concrete of the other laws, with the friction of its cracks.
fn with_friction(friction: f64) -> [f64; 15] {
    let concrete = banded();
    std::array::from_fn(|i| concrete.get(i).copied().unwrap_or(friction))
}

fn virgin<'p>(props: &'p [f64; 15], stress_state: StressState) -> Point<'p, ConcreteDamageFixed> {
    virgin_of(props, stress_state)
}

/// Goes straight to a strain.
fn go<L: Law>(point: &mut Point<'_, L>, strain: [f64; 6]) -> [f64; 6] {
    let start = point.strain;
    let at = |part: f64| std::array::from_fn(|i| start[i] + part * (strain[i] - start[i]));
    (1..=COUNT).for_each(|i| _ = point.advance(&at(f64::from(i) / f64::from(COUNT))));
    // at rest: neither extrapolation nor the resistance of cracks
    (0..12).for_each(|_| _ = point.advance(&strain));
    point.stress
}

/// The minimum is known by its conditions: the crack strain is in the cone, the stress in the polar one, and neither works on
/// the other.
#[test]
fn free_cracks_minimise_the_energy() {
    let mut random = Random::new(0xC7AC);
    for (nu, friction) in [-0.5, 0.0, 0.18, 0.45].into_iter().flat_map(|nu| [0.1, 0.5, 1.0].map(|f| (nu, f))) {
        let elasticity = Elasticity::new(30_000.0, nu);
        for _ in 0..1000 {
            let axes = Spectral { values: [0.0; 3], directions: random.rotation() };
            let strain = random.strain(StressState::ThreeD, 1e-3);
            let stress = FreeCracks::new(&elasticity, friction, &axes, &strain).stress;
            let elastic = elasticity.stress(&strain);
            let crack = strain_of(&elasticity, &std::array::from_fn(|i| elastic[i] - stress[i]));
            let entry = |tensor: &[f64; 6], i: usize, j: usize| work(&axes.shear_projector(i, j), tensor);
            let engineering: [f64; 6] = std::array::from_fn(|i| if i < 3 { stress[i] } else { 2.0 * stress[i] });
            let (strains, stresses) = (1e-15, 1e-10);
            for i in 0..3 {
                let [j, k] = [(i + 1) % 3, (i + 2) % 3];
                let openings = [entry(&crack, i, i), entry(&crack, j, j)];
                assert!(openings[0] >= -strains, "{crack:?}");
                let slip = 2.0 * entry(&crack, i, j).abs();
                assert!(friction * slip <= openings[0] + openings[1] + strains, "{crack:?}");
                let shear = entry(&engineering, i, j).abs() + entry(&engineering, i, k).abs();
                assert!(friction * entry(&engineering, i, i) + shear <= stresses, "{stress:?}");
            }
            assert!(Spectral::of_stress(&stress).values[0] <= stresses, "no tension in any direction: {stress:?}");
            assert!(work(&stress, &crack).abs() <= 1e-3 * stresses, "{:e}", work(&stress, &crack));
        }
    }
}

/// K⁻¹ : σ.
fn strain_of(elasticity: &Elasticity, stress: &[f64; 6]) -> [f64; 6] {
    let mean = (stress[0] + stress[1] + stress[2]) / 3.0;
    let [third, mu] = [mean / (3.0 * elasticity.bulk_modulus), elasticity.shear_modulus];
    std::array::from_fn(|i| if i < 3 { third + (stress[i] - mean) / (2.0 * mu) } else { stress[i] / mu })
}

#[test]
fn across_the_principal_strains_it_is_the_split_of_the_turning_crack() {
    let elasticity = Elasticity::new(30_000.0, 0.2);
    let mut random = Random::new(0xC0A);
    for _ in 0..1000 {
        let strain = random.strain(StressState::ThreeD, 1e-3);
        let axes = Spectral::of_strain(&strain);
        let expected = axes.stress(&Split::new(&elasticity, &axes.values).stress);
        let found = FreeCracks::new(&elasticity, 0.5, &axes, &strain).stress;
        for (found, expected) in found.iter().zip(&expected) {
            assert_relative_eq!(*found, *expected, epsilon = 1e-10, max_relative = 1e-10);
        }
    }
}

/// Open cracks carry exactly no stress. The rounding error of a difference of two large stresses would be more than
/// that.
#[test]
fn open_cracks_bear_nothing_to_the_last_digit() {
    let elasticity = Elasticity::new(30_000.0, 0.2);
    let mut random = Random::new(0x0BE4);
    for _ in 0..1000 {
        let axes = Spectral { values: [0.0; 3], directions: random.rotation() };
        // openings, and slips that are less than any sum of two of them
        let openings = std::array::from_fn(|_| random.between(0.5e-3, 1e-3));
        let mut strain = axes.strain(&openings);
        for pair in [[0, 1], [0, 2], [1, 2]] {
            let slip = random.between(-0.9e-3, 0.9e-3);
            let direction = axes.shear_projector(pair[0], pair[1]);
            strain
                .iter_mut()
                .zip(direction)
                .enumerate()
                .for_each(|(k, (e, t))| *e += slip * if k < 3 { t } else { 2.0 * t });
        }
        assert_eq!(FreeCracks::new(&elasticity, 1.0, &axes, &strain).stress, [0.0; 6]);
    }
}

/// There and back, and into compression: the direction of the strain is that of the crack.
#[test]
fn a_crack_that_is_not_sheared_is_the_turning_crack() {
    for stress_state in STRESS_STATES {
        let (concrete, props) = (banded(), with_friction(1.0));
        let mut turning = virgin_of::<ConcreteDamageImplex>(&concrete, stress_state);
        let mut point = virgin(&props, stress_state);
        for end in [1e-3, -1e-3, 3e-3] {
            let strain = [0.3 * end, end, 0.0, 0.0, 0.0, 0.0];
            let (found, expected) = (go(&mut point, strain), go(&mut turning, strain));
            for (found, expected) in found.iter().zip(&expected) {
                assert_relative_eq!(*found, *expected, epsilon = 1e-9, max_relative = 1e-9);
            }
        }
        let dissipated = point.state.len() - 1;
        assert_relative_eq!(point.state[dissipated], *turning.state.last().unwrap(), max_relative = 1e-9);
        assert_eq!(point.state[..6], [0.5, 1.0, 0.0, 0.0, 0.0, 0.0]);
    }
}

/// An open crack carries no shear. Under pressure from all sides it carries what friction holds, as stiff as the virgin solid,
/// slides beyond, and opens as it slides.
#[test]
fn shear_crosses_a_closed_crack_only() {
    for (stress_state, friction) in STRESS_STATES.into_iter().flat_map(|state| FRICTIONS.map(|f| (state, f))) {
        let props = with_friction(friction);
        let shear_modulus = Elasticity::new(props[0], props[1]).shear_modulus;
        let mut point = virgin(&props, stress_state);
        go(&mut point, [OPEN, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let open = go(&mut point, [OPEN, 0.0, 0.0, 0.5 * OPEN, 0.0, 0.0]);
        assert!(open.iter().all(|s| s.abs() < 1e-2), "{open:?}");
        let strain_33 = if stress_state == StressState::PlaneStress { 0.0 } else { PRESSED };
        let pressed = |shear: f64| [PRESSED, PRESSED, strain_33, shear, 0.0, 0.0];
        let pressure = -go(&mut point, pressed(0.0))[0];
        let mut sound = virgin(&props, stress_state);
        assert_relative_eq!(pressure, -go(&mut sound, pressed(0.0))[0], max_relative = 1e-9);
        let limit = friction * pressure / shear_modulus;
        let held = go(&mut point, pressed(0.9 * limit));
        assert_relative_eq!(held[3], 0.9 * limit * shear_modulus, max_relative = 1e-4);
        let slid = go(&mut point, pressed(3.0 * limit));
        assert_relative_eq!(slid[3], -friction * slid[0], max_relative = 1e-2);
        assert!(-slid[0] > pressure, "{slid:?}");
    }
}

/// Tension at any angle to a crack finds no strength but what is left of it.
#[test]
fn tension_across_a_cracked_solid_is_released_in_any_direction() {
    for (stress_state, friction) in STRESS_STATES.into_iter().flat_map(|state| FRICTIONS.map(|f| (state, f))) {
        let props = with_friction(friction);
        for degrees in [15.0_f64, 30.0, 45.0, 60.0, 90.0] {
            let mut point = virgin(&props, stress_state);
            go(&mut point, [OPEN, 0.0, 0.0, 0.0, 0.0, 0.0]);
            let (s, c) = degrees.to_radians().sin_cos();
            let stress = go(&mut point, [c * c, s * s, 0.0, 2.0 * c * s, 0.0, 0.0].map(|x| x * OPEN));
            let [greatest, ..] = Spectral::of_stress(&stress).values;
            assert!(greatest.abs() < 1e-2, "{degrees}°: {stress:?}");
        }
    }
}

#[test]
fn a_turned_crack_is_the_same_crack() {
    let props = with_friction(1.0);
    let sample = Sample { characteristic_length: Some(20.0), ..Sample::new(&props, 3e-4) };
    for stress_state in STRESS_STATES {
        battery::check_rotation::<ConcreteDamageFixed>(&sample, stress_state, 300);
    }
}

#[test]
fn tangent_is_the_derivative_of_the_stress_symmetric_and_positive() {
    FRICTIONS.iter().for_each(|friction| check_tangent::<ConcreteDamageFixed>(&with_friction(*friction)));
}

#[test]
fn work_is_stored_and_dissipated_to_the_last_digits() {
    FRICTIONS.iter().for_each(|friction| check_work::<ConcreteDamageFixed>(&with_friction(*friction)));
}

#[test]
fn its_page_has_the_states_that_hosts_see() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/src/concrete_damage/fixed.md");
    battery::pages::check(page, &ConcreteDamageFixed::INFO, &[PARAMETERS, STATES]);
}

//! DROT: a host under NLGEOM rotates STRESS and STRAN; the boundary rotates tensors in STATEV.

use crate::Loaded;
use battery::rotated;
use end_to_end_tests::{LAWS, PointMemory, difference, strain_path};
use umat_abi::law::StressState;

type Matrix = [[f64; 3]; 3];

/// Rotation about the unit axis (2, −1, 2)/3 by one radian.
fn rotation() -> Matrix {
    let axis = [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0];
    let (sine, cosine) = 1.0_f64.sin_cos();
    let cross = [[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let identity = f64::from(u8::from(i == j));
            cosine * identity + sine * cross[i][j] + (1.0 - cosine) * axis[i] * axis[j]
        })
    })
}

/// Returns the place at which the plastic strain begins in STATEV, if the law has one.
fn plastic_strain(loaded: &Loaded) -> Option<usize> {
    loaded.library.laws()[0].states.iter().position(|state| state.tensor_component == 1)
}

/// A point that is turned and then strained gives the turned answer of the point that is not turned.
#[test]
fn a_turned_point_answers_as_the_resting_one() {
    let r = rotation();
    for law in LAWS {
        let loaded = Loaded::new(law);
        let (resting, path) = loaded.loaded_point(StressState::ThreeD);
        let mut turned = resting.clone();
        turned.stress = rotated(&resting.stress, &r, 1.0);
        turned.stran = rotated(&resting.stran, &r, 2.0);
        for column in 0..3 {
            for row in 0..3 {
                turned.drot[3 * column + row] = r[row][column];
            }
        }
        let mut expected = resting.clone();
        let identity = resting.drot;
        for (k, increment) in path[8..].iter().enumerate() {
            expected.advance(loaded.umat, increment);
            turned.advance(loaded.umat, &rotated(increment, &r, 2.0));
            turned.drot = identity; // it is turned once, then only strained
            compare(&loaded, &turned, &expected, &r, k);
        }
        assert_ne!(expected.stress, resting.stress);
    }
}

fn compare(loaded: &Loaded, turned: &PointMemory, expected: &PointMemory, r: &Matrix, increment: usize) {
    let name = loaded.law.name;
    let apart = difference(&turned.stress, &rotated(&expected.stress, r, 1.0));
    assert!(apart < 1e-12, "{name}, increment {increment}: stresses {apart:e} apart");
    if let Some(start) = plastic_strain(loaded) {
        let components = |point: &PointMemory| point.statev[start..start + 6].to_vec();
        assert!(components(expected).iter().any(|x| x.abs() > 1e-5), "{name} did not flow");
        let apart = difference(&components(turned), &rotated(&components(expected).try_into().expect("six"), r, 2.0));
        assert!(apart < 1e-12, "{name}, increment {increment}: plastic strains {apart:e} apart");
    }
}

/// In a plane host DROT turns about the third axis.
#[test]
fn a_quarter_turn_in_the_plane_swaps_the_plastic_strains() {
    for law in LAWS {
        let loaded = Loaded::new(law);
        let Some(start) = plastic_strain(&loaded) else { continue };
        for stress_state in [StressState::PlaneStrainOrAxisymmetric, StressState::PlaneStress] {
            let mut point = PointMemory::new(law, stress_state);
            for increment in &strain_path(3, point.ntens(), law.strain, 5) {
                point.advance(loaded.umat, increment);
            }
            // what a law that extrapolates settles in an increment of zero is settled in both
            let mut before = point.clone();
            before.dstran = [0.0; 6];
            before.call(loaded.umat);
            let swap = |values: &mut [f64], shear: usize| {
                values.swap(0, 1);
                values[shear] = -values[shear];
            };
            let shear = point.ntens() - 1;
            swap(&mut point.stress, shear);
            swap(&mut point.stran, shear);
            point.dstran = [0.0; 6];
            point.drot = [0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
            point.call(loaded.umat);
            swap(&mut before.stress, shear);
            assert!(difference(&point.stress, &before.stress) < 1e-13, "{}", law.name);
            let mut expected = before.statev[start..start + 6].to_vec();
            swap(&mut expected, 3);
            assert!(difference(&point.statev[start..start + 6], &expected) < 1e-13, "{}", law.name);
        }
    }
}

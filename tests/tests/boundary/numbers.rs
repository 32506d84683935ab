//! NaN and infinity in what changes from call to call: nothing is written, and a cut-back asked for; without PNEWDT, stress
//! becomes NaN.

use crate::{Loaded, for_each_law};
use end_to_end_tests::PointMemory;

fn expect_cut_back(loaded: &Loaded, mut point: PointMemory, what: &str) {
    for on_entry in [1e36, 0.0, -1.0] {
        point.pnewdt = on_entry;
        let before = point.output_bits();
        point.call(loaded.umat);
        assert!(point.pnewdt > 0.0 && point.pnewdt < 1.0, "{}, {what}: PNEWDT {}", loaded.law.name, point.pnewdt);
        assert_eq!(point.output_bits(), before, "{}, {what}", loaded.law.name);
    }
    let before = point.clone();
    let mut arguments = point.arguments();
    arguments.pnewdt = std::ptr::null_mut();
    // SAFETY: what is not NULL is valid.
    unsafe { arguments.call(loaded.umat) };
    assert!(point.stress().iter().all(|x| x.is_nan()), "{}, {what}: {:?}", loaded.law.name, point.stress());
    point.stress = before.stress;
    assert_eq!(point.output_bits(), before.output_bits(), "{}, {what}: no PNEWDT", loaded.law.name);
}

#[test]
fn nan_and_infinite_strains_are_cut_back() {
    for_each_law(|loaded, stress_state| {
        let (point, _) = loaded.loaded_point(stress_state);
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for k in 0..point.ntens() {
                let mut spoilt = point.clone();
                spoilt.stran[k] = value;
                expect_cut_back(loaded, spoilt, "STRAN");
                let mut spoilt = point.clone();
                spoilt.dstran[k] = value;
                expect_cut_back(loaded, spoilt, "DSTRAN");
            }
        }
    });
}

#[test]
fn nan_and_infinite_states_are_cut_back() {
    for_each_law(|loaded, stress_state| {
        let (point, _) = loaded.loaded_point(stress_state);
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for k in 0..loaded.law.states {
                let mut spoilt = point.clone();
                spoilt.statev[k] = value;
                expect_cut_back(loaded, spoilt, "STATEV");
            }
        }
    });
}

#[test]
fn strains_beyond_all_measure_never_return_anything_but_numbers() {
    for_each_law(|loaded, stress_state| {
        for size in [1.0, 1e10, 1e100, 1e150, 1e200, 1e300, f64::MAX] {
            let (mut point, _) = loaded.loaded_point(stress_state);
            point.dstran[0] = size;
            let before = point.output_bits();
            point.call(loaded.umat);
            let numbers = point.stress().iter().chain(point.tangent()).chain(&point.statev).chain(&point.energies);
            assert!(numbers.into_iter().all(|x| x.is_finite()), "{} at {size:e}", loaded.law.name);
            assert!(point.pnewdt == 1.0 || point.output_bits() == before);
        }
    });
}

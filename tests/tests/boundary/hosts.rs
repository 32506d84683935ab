//! Habits of hosts: missing arguments, garbage in outputs, odd PNEWDT, several threads, several spellings.

use crate::{Loaded, for_each_law};
use end_to_end_tests::{LAWS, PointMemory, Sample, strain_path};
use std::ffi::c_char;
use std::ptr;

/// The point after one call with everything given.
fn reference(loaded: &Loaded, point: &PointMemory) -> PointMemory {
    let mut point = point.clone();
    point.call(loaded.umat);
    point
}

#[test]
fn every_argument_a_law_does_not_need_may_be_null() {
    for_each_law(|loaded, stress_state| {
        let (mut point, _) = loaded.loaded_point(stress_state);
        let expected = reference(loaded, &point);
        let mut arguments = point.arguments();
        for pointer in [
            &mut arguments.sse,
            &mut arguments.spd,
            &mut arguments.scd,
            &mut arguments.rpl,
            &mut arguments.ddsddt,
            &mut arguments.drplde,
            &mut arguments.drpldt,
            &mut arguments.pnewdt,
        ] {
            *pointer = ptr::null_mut();
        }
        for pointer in [
            &mut arguments.time,
            &mut arguments.dtime,
            &mut arguments.temp,
            &mut arguments.dtemp,
            &mut arguments.predef,
            &mut arguments.dpred,
            &mut arguments.coords,
            &mut arguments.drot,
            &mut arguments.celent,
            &mut arguments.dfgrd0,
            &mut arguments.dfgrd1,
        ] {
            *pointer = ptr::null();
        }
        for pointer in [
            &mut arguments.noel,
            &mut arguments.npt,
            &mut arguments.layer,
            &mut arguments.kspt,
            &mut arguments.jstep,
            &mut arguments.kinc,
        ] {
            *pointer = ptr::null();
        }
        arguments.cmname = ptr::null();
        arguments.cmname_length = 0;
        // SAFETY: what is left is valid; NULL is what is tested.
        unsafe { arguments.call(loaded.umat) };
        assert_eq!(point.stress, expected.stress);
        assert_eq!(point.statev, expected.statev);
        assert_eq!(point.ddsdde, expected.ddsdde);
    });
}

#[test]
fn a_null_tangent_means_stress_only() {
    for_each_law(|loaded, stress_state| {
        let (mut point, _) = loaded.loaded_point(stress_state);
        let expected = reference(loaded, &point);
        let mut arguments = point.arguments();
        arguments.ddsdde = ptr::null_mut();
        // SAFETY: the rest is valid.
        unsafe { arguments.call(loaded.umat) };
        assert_eq!(point.stress, expected.stress);
        assert_eq!(point.statev, expected.statev);
    });
}

/// TIME of length 1 lies right before memory that must not be read as a number. The law does not read it.
#[test]
fn time_of_length_one_and_names_of_length_one_are_enough() {
    for_each_law(|loaded, stress_state| {
        let (mut point, _) = loaded.loaded_point(stress_state);
        let expected = reference(loaded, &point);
        let (time, name) = (Box::new(0.0_f64), Box::new(b'X'));
        let mut arguments = point.arguments();
        arguments.time = ptr::from_ref(&*time);
        arguments.cmname = ptr::from_ref(&*name).cast::<c_char>();
        arguments.cmname_length = 1;
        // SAFETY: short arrays are what is tested; a law that reads past their ends is caught under valgrind.
        unsafe { arguments.call(loaded.umat) };
        assert_eq!(point.output_bits(), expected.output_bits());
    });
}

#[test]
fn pnewdt_on_entry_does_not_matter_and_success_leaves_it() {
    for_each_law(|loaded, stress_state| {
        let (point, _) = loaded.loaded_point(stress_state);
        let expected = reference(loaded, &point);
        for on_entry in [1e36, 1.0, -1.0, 0.0, f64::NAN] {
            let mut point = point.clone();
            point.pnewdt = on_entry;
            point.call(loaded.umat);
            assert_eq!(point.pnewdt.to_bits(), on_entry.to_bits());
            assert_eq!(point.output_bits(), expected.output_bits());
        }
    });
}

#[test]
fn garbage_in_outputs_is_overwritten() {
    for_each_law(|loaded, stress_state| {
        let (point, _) = loaded.loaded_point(stress_state);
        let expected = reference(loaded, &point);
        for garbage in [0.0, 1e300, f64::NAN, f64::INFINITY] {
            let mut point = point.clone();
            point.ddsdde = [garbage; 36];
            point.energies[..3].fill(garbage);
            point.call(loaded.umat);
            assert_eq!(point.tangent(), expected.tangent());
            assert_eq!(point.energies[..3], expected.energies[..3]);
            assert!(point.energies[..3].iter().all(|energy| energy.is_finite()));
            // Nothing after the NTENS² and NTENS entries is touched, nor are the thermal outputs.
            let ntens = point.ntens();
            assert!(point.ddsdde[ntens * ntens..].iter().all(|x| x.to_bits() == garbage.to_bits()));
            assert_eq!(point.stress[ntens..], [0.0; 6][ntens..]);
            assert_eq!((point.ddsddt, point.drplde), (expected.ddsddt, expected.drplde));
        }
    });
}

/// A UMAT without the trailing CHARACTER length, as hosts written in C declare it.
type WithoutLength = unsafe extern "C" fn(
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *const f64,
    *const f64,
    *const f64,
    *const f64,
    *const f64,
    *const f64,
    *const f64,
    *const f64,
    *const c_char,
    *const i32,
    *const i32,
    *const i32,
    *const i32,
    *const f64,
    *const i32,
    *const f64,
    *const f64,
    *mut f64,
    *const f64,
    *const f64,
    *const f64,
    *const i32,
    *const i32,
    *const i32,
    *const i32,
    *const i32,
    *const i32,
);

#[test]
fn a_host_may_pass_no_character_length() {
    for_each_law(|loaded, stress_state| {
        let (mut point, _) = loaded.loaded_point(stress_state);
        let expected = reference(loaded, &point);
        // SAFETY: in the C calling conventions of the platforms we build for the caller owns the argument area: a
        // missing last argument leaves the others in place.
        let umat = unsafe { std::mem::transmute::<umat_abi::umat::UmatFunction, WithoutLength>(loaded.umat) };
        let a = point.arguments();
        // SAFETY: every pointer is valid.
        unsafe {
            umat(
                a.stress, a.statev, a.ddsdde, a.sse, a.spd, a.scd, a.rpl, a.ddsddt, a.drplde, a.drpldt, a.stran,
                a.dstran, a.time, a.dtime, a.temp, a.dtemp, a.predef, a.dpred, a.cmname, a.ndi, a.nshr, a.ntens,
                a.nstatv, a.props, a.nprops, a.coords, a.drot, a.pnewdt, a.celent, a.dfgrd0, a.dfgrd1, a.noel, a.npt,
                a.layer, a.kspt, a.jstep, a.kinc,
            );
        }
        assert_eq!(point.output_bits(), expected.output_bits());
    });
}

#[test]
fn a_zero_increment_keeps_the_stress_and_calls_can_be_repeated() {
    for_each_law(|loaded, stress_state| {
        let (mut point, _) = loaded.loaded_point(stress_state);
        if ["concrete_damage_implex", "concrete_damage_fixed"].contains(&loaded.law.name) {
            // damage that grew in the last increment is extrapolated into the first of zero; what resists the opening of
            // cracks relaxes to a few thousandths in each
            (0..8).for_each(|_| point.advance(loaded.umat, &[0.0; 6]));
        }
        let mut resting = point.clone();
        resting.dstran = [0.0; 6];
        resting.call(loaded.umat);
        let apart = end_to_end_tests::difference(resting.stress(), point.stress());
        assert!(apart <= 1e-14, "{}: a zero increment changes the stress by {apart:e}", loaded.law.name);
        // Two calls from the same start agree to the bit, whatever was called in between.
        let first = reference(loaded, &point);
        reference(loaded, &resting);
        assert_eq!(reference(loaded, &point).output_bits(), first.output_bits());
    });
}

#[test]
fn eight_threads_at_once_get_the_same_bits() {
    const THREADS: usize = 8;
    let history = |loaded: &Loaded, stress_state| {
        let mut point = PointMemory::new(loaded.law, stress_state);
        let mut bits = Vec::new();
        for increment in strain_path(11, point.ntens(), loaded.law.strain, 500) {
            point.advance(loaded.umat, &increment);
            bits.extend(point.output_bits());
        }
        bits
    };
    for law in LAWS {
        let loaded = &Loaded::new(law);
        for stress_state in Sample::STRESS_STATES {
            let alone = history(loaded, stress_state);
            let start = &std::sync::Barrier::new(THREADS);
            std::thread::scope(|scope| {
                let run = || {
                    start.wait();
                    history(loaded, stress_state)
                };
                let threads: Vec<_> = (0..THREADS).map(|_| scope.spawn(run)).collect();
                for thread in threads {
                    assert_eq!(thread.join().expect("no panic"), alone, "{}", law.name);
                }
            });
        }
    }
}

#[test]
fn every_spelling_of_the_entry_point_is_the_same_law() {
    for_each_law(|loaded, stress_state| {
        let (point, _) = loaded.loaded_point(stress_state);
        let expected = reference(loaded, &point).output_bits();
        let unique = format!("{}_umat_", loaded.law.name);
        for symbol in ["umat_", "umat", "UMAT", unique.as_str()] {
            let mut point = point.clone();
            point.call(loaded.library.umat(Some(symbol)).unwrap_or_else(|error| panic!("{error}")));
            assert_eq!(point.output_bits(), expected, "{symbol}");
        }
    });
}

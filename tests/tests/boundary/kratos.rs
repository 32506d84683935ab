//! Kratos: shears 12, 23, 13, DDSDDE of either order of shears alike, hardly any argument but the necessary ones.

use crate::{Loaded, for_each_law};
use end_to_end_tests::{LAWS, PointMemory, Sample};
use std::ptr::{null, null_mut};
use umat_abi::law::StressState;

/// Exchanges 13 and 23 where there are six components.
fn exchanged(point: &PointMemory) -> PointMemory {
    let mut point = point.clone();
    if point.ntens() == 6 {
        for vector in [&mut point.stress, &mut point.stran, &mut point.dstran] {
            vector.swap(4, 5);
        }
        let before = point.ddsdde;
        let other = |k: usize| [0, 1, 2, 3, 5, 4][k];
        for row in 0..6 {
            for column in 0..6 {
                point.ddsdde[6 * column + row] = before[6 * other(column) + other(row)];
            }
        }
    }
    point
}

/// Calls `<law>_umat_kratos_` with what Kratos gives.
fn call(loaded: &Loaded, point: &mut PointMemory, with_pnewdt: bool) {
    let umat = loaded.library.umat(Some(&format!("{}_umat_kratos_", loaded.law.name))).expect("Kratos's entry");
    let mut arguments = point.arguments();
    for pointer in [&mut arguments.rpl, &mut arguments.ddsddt, &mut arguments.drplde, &mut arguments.drpldt] {
        *pointer = null_mut();
    }
    for pointer in [
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
        *pointer = null();
    }
    if !with_pnewdt {
        arguments.pnewdt = null_mut();
    }
    arguments.cmname = null();
    // SAFETY: what is not NULL is valid.
    unsafe { arguments.call(umat) };
}

#[test]
fn its_order_of_shears_is_exchanged() {
    for_each_law(|loaded, stress_state| {
        let (point, _) = loaded.loaded_point(stress_state);
        let mut expected = point.clone();
        expected.call(loaded.umat);
        // nothing of heat passes there
        (expected.energies[3], expected.drpldt) = (point.energies[3], point.drpldt);
        (expected.ddsddt, expected.drplde) = (point.ddsddt, point.drplde);
        let mut found = exchanged(&point);
        call(loaded, &mut found, false);
        assert_eq!(exchanged(&found).output_bits(), expected.output_bits(), "{} {stress_state:?}", loaded.law.name);
    });
    // without the exchange it shows, where a law is no function of invariants in which 13 and 23 count alike
    let shows = |law: &&'static Sample| {
        let loaded = Loaded::new(law);
        let (point, _) = loaded.loaded_point(StressState::ThreeD);
        let (mut expected, mut ordinary) = (point.clone(), exchanged(&point));
        expected.call(loaded.umat);
        ordinary.call(loaded.umat);
        exchanged(&ordinary).output_bits() != expected.output_bits()
    };
    let distinguished = LAWS.iter().filter(shows).count();
    assert!(distinguished >= 3, "{distinguished}");
}

#[test]
fn what_is_not_computed_is_as_it_was_in_its_order_too() {
    for_each_law(|loaded, stress_state| {
        let (mut point, _) = loaded.loaded_point(stress_state);
        point.dstran[0] = f64::NAN;
        let before = point.output_bits();
        call(loaded, &mut point, true);
        assert_eq!(point.output_bits(), before, "{}", loaded.law.name);
        assert!(point.pnewdt > 0.0 && point.pnewdt < 1.0);
        call(loaded, &mut point, false);
        assert!(point.stress().iter().all(|x| x.is_nan()), "{}", loaded.law.name);
    });
}

//! UMAT for programs that order shears 12, 23, 13 (Kratos): components 13 and 23 are exchanged on the way in and out.
//!
//! States stay in the order of the law's table, tensor states too: they are the law's own.

use super::optional;
use crate::umat::{UmatArguments, UmatFunction};

/// Positions of 13 and 23 among six components.
const EXCHANGED: [usize; 2] = [4, 5];

/// Calls a UMAT whose order is 12, 13, 23 with arguments whose order is 12, 23, 13. Four and three components have one shear.
///
/// # Safety
/// The arguments are those of a UMAT call: every pointer NULL or valid for what ABAQUS defines.
pub unsafe fn umat_kratos(function: UmatFunction, arguments: &UmatArguments) {
    let mut ordered = *arguments;
    // SAFETY: NTENS is NULL or valid.
    if unsafe { optional(arguments.ntens) } != Some(6) {
        // SAFETY: forwarded to the caller.
        return unsafe { ordered.call(function) };
    }
    // STRAN and DSTRAN are the host's
    let mut strains = [[0.0; 6]; 2];
    for (strain, pointer) in strains.iter_mut().zip([&mut ordered.stran, &mut ordered.dstran]) {
        // SAFETY: NULL or six values.
        if let Some(given) = unsafe { optional(pointer.cast::<[f64; 6]>()) } {
            *strain = given;
            strain.swap(EXCHANGED[0], EXCHANGED[1]);
            *pointer = strain.as_ptr();
        }
    }
    // SAFETY: forwarded to the caller; exchanged twice, what the law does not write is as it was.
    unsafe {
        exchange_outputs(&ordered);
        ordered.call(function);
        exchange_outputs(&ordered);
    }
}

/// Exchanges components 13 and 23 of STRESS, DDSDDT and DRPLDE, rows and columns of DDSDDE.
///
/// # Safety
/// As for [`umat_kratos`], with NTENS = 6.
unsafe fn exchange_outputs(arguments: &UmatArguments) {
    let [first, second] = EXCHANGED;
    for vector in [arguments.stress, arguments.ddsddt, arguments.drplde] {
        if !vector.is_null() {
            // SAFETY: six values.
            unsafe { vector.add(first).swap(vector.add(second)) };
        }
    }
    let matrix = arguments.ddsdde;
    if !matrix.is_null() {
        for k in 0..6 {
            // SAFETY: 6·6 values.
            unsafe { matrix.add(6 * k + first).swap(matrix.add(6 * k + second)) };
        }
        for k in 0..6 {
            // SAFETY: as above.
            unsafe { matrix.add(6 * first + k).swap(matrix.add(6 * second + k)) };
        }
    }
}

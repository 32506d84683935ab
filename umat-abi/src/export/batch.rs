//! The body of `<law>_umat_batch_v1`: many points in one call, component by component, each as by `umat_`.

use super::solid::{HeatArguments, SolidArguments, update};
use super::{Refusal, fill_nan, guarded, report};
use crate::batch::BatchArguments;
use crate::law::{Law, MAX_STATES};
use crate::metadata::batch_results;
use std::ptr::{null, null_mut};

/// Runs law `L` on many points. Those that fail keep their states.
///
/// # Safety
/// Every pointer is NULL or valid for as many values as the counts give.
pub unsafe fn batch<L: Law>(a: &BatchArguments) {
    let ntens = usize::try_from(a.ntens).ok().filter(|ntens| (1..=6).contains(ntens)).unwrap_or(0);
    for k in 0..a.n {
        // SAFETY: forwarded to the caller; k < n.
        let status = match guarded(|| unsafe { update_point::<L>(a, k, ntens) }) {
            Ok(()) => batch_results::DONE,
            // without STATUS the host would take the old stress for the new one
            Err(Refusal::CutBack { .. }) if !a.status.is_null() => batch_results::CUT_BACK,
            Err(refusal) => {
                report(L::INFO.name, &refusal);
                // hosts that ignore STATUS would go on with the old values
                for (first, rows) in [(a.stress, ntens), (a.ddsdde, ntens * ntens)] {
                    // SAFETY: an array of `rows` rows of n values, or NULL.
                    (0..rows).for_each(|row| unsafe { fill_nan(column(first, a.n, k, row), 1) });
                }
                batch_results::REFUSED
            }
        };
        if !a.status.is_null() {
            // SAFETY: STATUS has n values.
            unsafe { a.status.add(k).write(status) };
        }
    }
}

/// Returns where an array has a component of a point; NULL if the array is.
///
/// # Safety
/// The array is NULL or has more than `row` rows of `n` > `k` values.
#[inline(always)]
unsafe fn column(first: *mut f64, n: usize, k: usize, row: usize) -> *mut f64 {
    // SAFETY: the caller's promise.
    if first.is_null() { first } else { unsafe { first.add(row * n + k) } }
}

/// # Safety
/// As for [`batch`]; `k` < `n`, and `ntens` is NTENS, or 0 if that is none.
unsafe fn update_point<L: Law>(a: &BatchArguments, k: usize, ntens: usize) -> Result<(), Refusal> {
    let states = L::INFO.states.len();
    let given_states = usize::try_from(a.nstatv).unwrap_or(0);
    let (mut strains, mut stress, mut tangent) = ([[0.0; 6]; 2], [0.0; 6], [0.0; 36]);
    let mut statev = [0.0; MAX_STATES];
    // SAFETY: rows of n values each, k < n.
    let at = |first: *const f64, row| unsafe { column(first.cast_mut(), a.n, k, row) };
    // an array of the point's own, or NULL where the batch has none
    let gather = |first: *const f64, values: &mut [f64]| {
        if first.is_null() {
            return null_mut();
        }
        // SAFETY: as above.
        values.iter_mut().enumerate().for_each(|(row, value)| *value = unsafe { at(first, row).read() });
        values.as_mut_ptr()
    };
    let [strain, dstrain] = &mut strains;
    let nshr = a.ntens.wrapping_sub(a.ndi);
    let point = SolidArguments {
        stran: gather(a.strain, &mut strain[..ntens]),
        dstran: gather(a.dstrain, &mut dstrain[..ntens]),
        stress: gather(a.stress, &mut stress[..ntens]),
        statev: gather(a.statev, &mut statev[..states.min(given_states)]),
        ddsdde: if a.ddsdde.is_null() { null_mut() } else { tangent.as_mut_ptr() },
        ntens: &raw const a.ntens,
        ndi: &raw const a.ndi,
        nshr: &raw const nshr,
        props: a.props,
        nprops: &raw const a.nprops,
        nstatv: &raw const a.nstatv,
        celent: if a.celent.is_null() { null() } else { at(a.celent, 0) },
        drot: null(),
        dtime: null(),
        sse: null_mut(),
        spd: null_mut(),
        scd: null_mut(),
    };
    // SAFETY: arrays of the point's own, as long as the counts say.
    unsafe { update::<L>(&point, &HeatArguments::NONE) }?;
    for (first, values) in
        [(a.stress, &stress[..ntens]), (a.statev, &statev[..states]), (a.ddsdde, &tangent[..ntens * ntens])]
    {
        if !first.is_null() {
            // SAFETY: as above.
            values.iter().enumerate().for_each(|(row, value)| unsafe { at(first, row).write(*value) });
        }
    }
    Ok(())
}

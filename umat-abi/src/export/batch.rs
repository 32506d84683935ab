//! The body of `<law>_umat_batch_v1`: many points in one call, component by component.
//!
//! Parameters are read once. Blocks of [`LANES`] points go through [`Law::update_block`] where the law has it; a block that
//! it hands back, the rest of the arrays, and every call with a tangent go through [`Law::update`] point by point. All of
//! them give the bits of single calls of `umat_`.

use super::solid::check_response;
use super::{Refusal, finite, report, slice};
use crate::floating_point::in_default_environment;
use crate::law::{Block, Increment, LANES, Lane, Law, MAX_STATES, Request, Response, StressState, check_properties_of};
use crate::metadata::{batch_results, flags};
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The arguments of a batch; arrays of `n` values for each component, one component after the other. `status`:
/// [`batch_results`].
#[derive(Clone, Copy, Debug)]
pub struct BatchArguments {
    /// number of points.
    pub n: usize,
    /// number of components.
    pub ntens: i32,
    /// number of direct components.
    pub ndi: i32,
    /// `(nprops)` parameters.
    pub props: *const f64,
    /// number of parameters.
    pub nprops: i32,
    /// `(n,ntens)` total strain at the start.
    pub strain: *const f64,
    /// `(n,ntens)` strain increment.
    pub dstrain: *const f64,
    /// `(n,ntens)` stress at the start, and at the end.
    pub stress: *mut f64,
    /// `(n,nstatv)` state variables.
    pub statev: *mut f64,
    /// number of state variables.
    pub nstatv: i32,
    /// `(n,ntens,ntens)` out: tangent, column by column; or NULL.
    pub ddsdde: *mut f64,
    /// `(n)` characteristic length; or NULL.
    pub celent: *const f64,
    /// `(n)` out: 0 done, 1 a smaller increment is wanted, 2 refused.
    pub status: *mut i32,
}

/// Runs law `L` on many points.
///
/// # Safety
/// Every pointer is NULL or valid for the values that the counts tell.
pub unsafe fn batch<L: Law>(arguments: &BatchArguments) {
    in_default_environment(|| {
        // SAFETY: forwarded to the caller.
        let refusal = unsafe { refuse_or_run::<L>(arguments) };
        if let Err(refusal) = refusal {
            report(L::INFO.name, &refusal);
            // SAFETY: forwarded to the caller.
            (0..arguments.n).for_each(|k| unsafe { refuse_point(arguments, k) });
        }
    });
}

/// What all points share.
struct Plan<'p, L: Law> {
    parameters: L::Parameters<'p>,
    stress_state: StressState,
    request: Request,
}

/// # Safety
/// As for [`batch`].
unsafe fn refuse_or_run<L: Law>(a: &BatchArguments) -> Result<(), Refusal> {
    // SAFETY: PROPS has NPROPS values.
    let plan = catch_unwind(|| unsafe { plan::<L>(a) }).unwrap_or(Err(Refusal::Panic))?;
    let progress = Progress { next: Cell::new(0), singly_until: Cell::new(0), in_block: Cell::new(false) };
    // SAFETY: forwarded to the caller; the plan has checked that no array is missing.
    while catch_unwind(AssertUnwindSafe(|| unsafe { advance::<L>(&plan, a, &progress) })).is_err() {
        let k = progress.next.get();
        if progress.in_block.replace(false) {
            // whose panic it was, single updates tell
            progress.singly_until.set(k + LANES);
        } else {
            report(L::INFO.name, &Refusal::Panic);
            // SAFETY: k < n.
            unsafe { refuse_point(a, k) };
            progress.next.set(k + 1);
        }
    }
    Ok(())
}

/// # Safety
/// As for [`batch`].
unsafe fn plan<L: Law>(a: &BatchArguments) -> Result<Plan<'_, L>, Refusal> {
    let counts = (a.ntens, a.ndi, a.ntens.wrapping_sub(a.ndi));
    let stress_state = StressState::from_counts(counts.0, counts.1, counts.2)
        .filter(|stress_state| stress_state.bits() & L::STRESS_STATES != 0)
        .ok_or(Refusal::Components { first: counts.0, second: counts.1, third: counts.2 })?;
    let nprops = usize::try_from(a.nprops).map_err(|_| Refusal::Null { argument: "NPROPS" })?;
    // SAFETY: forwarded to the caller.
    let props = unsafe { slice(a.props, nprops, "PROPS") }?;
    check_properties_of::<L>(props)?;
    let states = L::INFO.states.len();
    if usize::try_from(a.nstatv).map_or(true, |given| given < states) {
        return Err(Refusal::States { given: a.nstatv, expected: states });
    }
    let arrays = [
        (a.strain, "STRAIN"),
        (a.dstrain, "DSTRAIN"),
        (a.stress.cast_const(), "STRESS"),
        (a.statev.cast_const(), "STATEV"),
    ];
    if let Some(&(_, argument)) = arrays.iter().find(|(pointer, _)| pointer.is_null()) {
        return Err(Refusal::Null { argument });
    }
    let request = if a.ddsdde.is_null() { Request::Stress } else { Request::StressAndTangent };
    Ok(Plan { parameters: L::parameters(props)?, stress_state, request })
}

/// How far a batch is; it outlives a panic.
struct Progress {
    /// The first point that has no result.
    next: Cell<usize>,
    /// Points below are updated singly.
    singly_until: Cell<usize>,
    in_block: Cell<bool>,
}

/// Advances all points from `progress` on.
///
/// # Safety
/// As for [`batch`], with no array missing.
unsafe fn advance<L: Law>(plan: &Plan<'_, L>, a: &BatchArguments, progress: &Progress) {
    #[cfg(target_arch = "x86_64")]
    if L::UPDATES_BLOCKS && std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2; the rest is forwarded to the caller.
        unsafe { advance_avx2::<L>(plan, a, progress) };
        return;
    }
    // SAFETY: forwarded to the caller.
    unsafe { advance_here::<L>(plan, a, progress) };
}

/// The same code in wider registers. No fused operations: the bits stay.
///
/// # Safety
/// As for [`advance`], on a processor with AVX2.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn advance_avx2<L: Law>(plan: &Plan<'_, L>, a: &BatchArguments, progress: &Progress) {
    // SAFETY: forwarded to the caller.
    unsafe { advance_here::<L>(plan, a, progress) };
}

/// # Safety
/// As for [`advance`].
#[inline(always)]
unsafe fn advance_here<L: Law>(plan: &Plan<'_, L>, a: &BatchArguments, progress: &Progress) {
    let mut block = Block {
        stress_state: plan.stress_state,
        strain: [[0.0; LANES]; 6],
        strain_increment: [[0.0; LANES]; 6],
        stress: [[0.0; LANES]; 6],
        characteristic_length: [None; LANES],
    };
    let mut states = [[0.0; LANES]; MAX_STATES];
    let states = &mut states[..L::INFO.states.len()];
    let blocks = L::UPDATES_BLOCKS && plan.request == Request::Stress;
    while progress.next.get() < a.n {
        let k = progress.next.get();
        if blocks && k + LANES <= a.n && k >= progress.singly_until.get() {
            progress.in_block.set(true);
            // SAFETY: k + LANES ≤ n.
            let done = unsafe { advance_block::<L>(plan, a, k, &mut block, states) };
            progress.in_block.set(false);
            if done {
                progress.next.set(k + LANES);
            } else {
                progress.singly_until.set(k + LANES);
            }
        } else {
            // SAFETY: k < n.
            unsafe { advance_point::<L>(plan, a, k) };
            progress.next.set(k + 1);
        }
    }
}

/// Advances LANES points; false: nothing was written, they are to be advanced singly.
///
/// # Safety
/// As for [`advance`]; `k` + LANES ≤ `n`.
#[inline(always)]
unsafe fn advance_block<L: Law>(
    plan: &Plan<'_, L>,
    a: &BatchArguments,
    k: usize,
    block: &mut Block,
    states: &mut [Lane],
) -> bool {
    let components = plan.stress_state.components();
    // SAFETY: row `row` of an array of n columns, columns k to k + LANES.
    let load = |first: *const f64, row: usize| unsafe { first.add(row * a.n + k).cast::<Lane>().read_unaligned() };
    // SAFETY: as above.
    let store = |first: *mut f64, row: usize, lane: &Lane| unsafe {
        first.add(row * a.n + k).cast::<Lane>().write_unaligned(*lane);
    };
    for (row, &i) in components.iter().enumerate() {
        let (strain, increment) = (load(a.strain, row), load(a.dstrain, row));
        block.strain[i] = std::array::from_fn(|lane| strain[lane] + increment[lane]);
        block.strain_increment[i] = increment;
        block.stress[i] = load(a.stress, row);
    }
    if const { L::INFO.flags & flags::USES_CELENT != 0 } && !a.celent.is_null() {
        let lengths = load(a.celent, 0);
        block.characteristic_length = lengths.map(usable_length);
    }
    for (row, state) in states.iter_mut().enumerate() {
        *state = load(a.statev, row);
    }
    if !(are_finite(&block.strain) & are_finite(states)) {
        return false;
    }
    let Some(response) = L::update_block(&plan.parameters, block, states) else { return false };
    if !(are_finite(&response.stress) & are_finite(states) & are_finite(&[response.stored_energy])) {
        return false;
    }
    for (row, &i) in components.iter().enumerate() {
        store(a.stress, row, &response.stress[i]);
    }
    for (row, state) in states.iter().enumerate() {
        store(a.statev, row, state);
    }
    if !a.status.is_null() {
        // SAFETY: STATUS has n values.
        unsafe { std::slice::from_raw_parts_mut(a.status.add(k), LANES) }.fill(batch_results::DONE);
    }
    true
}

/// Whether none is NaN or infinite: x − x is 0 of a number and NaN of anything else.
#[inline(always)]
#[expect(clippy::eq_op, reason = "x - x is not 0 of every x")]
fn are_finite(rows: &[Lane]) -> bool {
    let mut sum = [0.0; LANES];
    for row in rows {
        for lane in 0..LANES {
            sum[lane] += row[lane] - row[lane];
        }
    }
    sum == [0.0; LANES]
}

/// CELENT if it is one.
#[inline(always)]
fn usable_length(length: f64) -> Option<f64> {
    (length.is_finite() && length > 0.0).then_some(length)
}

/// Advances one point.
///
/// # Safety
/// As for [`advance`]; `k` < `n`.
#[inline(never)]
unsafe fn advance_point<L: Law>(plan: &Plan<'_, L>, a: &BatchArguments, k: usize) {
    // constants, for which the compiler unrolls the loops over components
    let outcome = match plan.stress_state {
        // SAFETY: forwarded to the caller.
        StressState::ThreeD => unsafe { update_point::<L>(plan, StressState::ThreeD, a, k) },
        StressState::PlaneStrainOrAxisymmetric => {
            // SAFETY: as above.
            unsafe { update_point::<L>(plan, StressState::PlaneStrainOrAxisymmetric, a, k) }
        }
        // SAFETY: as above.
        StressState::PlaneStress => unsafe { update_point::<L>(plan, StressState::PlaneStress, a, k) },
    };
    let status = match outcome {
        Ok(()) => batch_results::DONE,
        // without STATUS the host would take the old stress for the new one
        Err(Refusal::CutBack { .. }) if !a.status.is_null() => batch_results::CUT_BACK,
        Err(refusal) => {
            report(L::INFO.name, &refusal);
            // SAFETY: forwarded to the caller.
            unsafe { refuse_point(a, k) };
            return;
        }
    };
    if !a.status.is_null() {
        // SAFETY: STATUS has n values.
        unsafe { a.status.add(k).write(status) };
    }
}

/// # Safety
/// As for [`advance_point`].
#[inline(always)]
unsafe fn update_point<L: Law>(
    plan: &Plan<'_, L>,
    stress_state: StressState,
    a: &BatchArguments,
    k: usize,
) -> Result<(), Refusal> {
    // SAFETY: row `row` of an array of n columns, column k.
    let load = |first: *const f64, row: usize| unsafe { first.add(row * a.n + k).read() };
    let mut states = [0.0; MAX_STATES];
    let states = &mut states[..L::INFO.states.len()];
    for (row, state) in states.iter_mut().enumerate() {
        *state = load(a.statev, row);
    }
    finite(states, "NaN or infinity in STATEV")?;
    let mut increment = Increment::at_rest(stress_state);
    for (row, &i) in stress_state.components().iter().enumerate() {
        increment.strain_increment[i] = load(a.dstrain, row);
        increment.strain[i] = load(a.strain, row) + increment.strain_increment[i];
        increment.stress[i] = load(a.stress, row);
    }
    if const { L::INFO.flags & flags::USES_CELENT != 0 } && !a.celent.is_null() {
        increment.characteristic_length = usable_length(load(a.celent, 0));
    }
    if let Some(response) = L::elastic(&plan.parameters, &increment, states, plan.request) {
        // SAFETY: forwarded to the caller.
        unsafe { write_point(plan.request, stress_state, a, k, &response, states) };
        return Ok(());
    }
    finite(&increment.strain, "NaN or infinity in STRAN or DSTRAN")?;
    let response = &L::update(&plan.parameters, &increment, states, plan.request)?;
    check_response::<L>(response, states, plan.request)?;
    // SAFETY: forwarded to the caller.
    unsafe { write_point(plan.request, stress_state, a, k, response, states) };
    Ok(())
}

/// # Safety
/// As for [`advance_point`].
#[inline(always)]
unsafe fn write_point(
    request: Request,
    stress_state: StressState,
    a: &BatchArguments,
    k: usize,
    response: &Response,
    states: &[f64],
) {
    // SAFETY: row `row` of an array of n columns, column k.
    let store = |first: *mut f64, row: usize, value: f64| unsafe { first.add(row * a.n + k).write(value) };
    let components = stress_state.components();
    for (row, &i) in components.iter().enumerate() {
        store(a.stress, row, response.stress[i]);
        if request.wants_tangent() {
            for (column, &j) in components.iter().enumerate() {
                store(a.ddsdde, column * components.len() + row, response.tangent[i][j]);
            }
        }
    }
    for (row, state) in states.iter().enumerate() {
        store(a.statev, row, *state);
    }
}

/// Fills a point's stress and tangent with NaN: hosts that ignore STATUS would go on with the old ones.
///
/// # Safety
/// As for [`batch`]; `k` < `n`.
#[cold]
unsafe fn refuse_point(a: &BatchArguments, k: usize) {
    let ntens = usize::try_from(a.ntens).ok().filter(|ntens| (1..=6).contains(ntens)).unwrap_or(0);
    for (first, rows) in [(a.stress, ntens), (a.ddsdde, ntens * ntens)] {
        if !first.is_null() {
            // SAFETY: an array of `rows` rows of n values.
            (0..rows).for_each(|row| unsafe { first.add(row * a.n + k).write(f64::NAN) });
        }
    }
    if !a.status.is_null() {
        // SAFETY: STATUS has n values.
        unsafe { a.status.add(k).write(batch_results::REFUSED) };
    }
}

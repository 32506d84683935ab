//! The body of `umat_`.

use super::{Answer, CUT_BACK, Refusal, count, finite, guarded, optional, refuse, slice, states, store};
use crate::law::{Increment, Law, Request, Response, StressState, all_finite, check_properties_of};
use crate::metadata::{StateVariable, flags};
use crate::umat::UmatArguments;
use std::ffi::CStr;

/// The arguments that a law of a solid uses: less than half of UMAT's. The rest is not even copied.
///
/// No two that are neighbours on the host's stack are neighbours here: a compiler that sees such pairs copies them by
/// one load of 16 bytes, which waits until both of the host's stores of 8 have left the pipeline (7 ns of a call).
#[derive(Clone, Copy)]
#[repr(C)]
struct Arguments {
    stran: *const f64,
    ndi: *const i32,
    stress: *mut f64,
    ntens: *const i32,
    props: *const f64,
    statev: *mut f64,
    dstran: *const f64,
    nshr: *const i32,
    ddsdde: *mut f64,
    nstatv: *const i32,
    drot: *const f64,
    sse: *mut f64,
    nprops: *const i32,
    spd: *mut f64,
    celent: *const f64,
    scd: *mut f64,
    dtime: *const f64,
}

/// Runs law `L` as a UMAT.
///
/// # Safety
/// The arguments are those of a UMAT call: every pointer NULL or valid for what ABAQUS defines.
#[inline(always)]
pub unsafe fn umat<L: Law>(arguments: &UmatArguments) {
    let &UmatArguments { stress, statev, ddsdde, sse, spd, scd, stran, dstran, ndi, nshr, ntens, .. } = arguments;
    let &UmatArguments { nstatv, props, nprops, drot, celent, pnewdt, dtime, .. } = arguments;
    let used = Arguments {
        stress,
        statev,
        ddsdde,
        sse,
        spd,
        scd,
        stran,
        dstran,
        ndi,
        nshr,
        ntens,
        nstatv,
        props,
        nprops,
        drot,
        celent,
        dtime,
    };
    // SAFETY: forwarded to the caller.
    let outcome = guarded(move || unsafe { update::<L>(&used) });
    if let Err(refusal) = outcome {
        // SAFETY: forwarded to the caller.
        unsafe { refuse_umat(ntens, stress, ddsdde, pnewdt, L::INFO.name, &refusal) };
    }
}

/// Of the few arguments that it needs: all of them together would have to lie in memory before each call.
///
/// # Safety
/// As for [`umat`].
#[cold]
pub(super) unsafe fn refuse_umat(
    ntens: *const i32,
    stress: *mut f64,
    tangent: *mut f64,
    pnewdt: *mut f64,
    name: &CStr,
    refusal: &Refusal,
) {
    // SAFETY: STRESS(NTENS), DDSDDE(NTENS,NTENS), PNEWDT: NULL or valid.
    unsafe {
        refuse(name, refusal, &Answer { components: optional(ntens), most_components: 6, stress, tangent, pnewdt })
    }
}

#[inline(always)]
unsafe fn update<L: Law>(a: &Arguments) -> Result<(), Refusal> {
    // SAFETY: the caller of `umat` passes the arguments of a UMAT call: NULL or valid.
    let (ntens, ndi, nshr) = unsafe { (optional(a.ntens), optional(a.ndi), optional(a.nshr)) };
    let counts = (ntens.unwrap_or(0), ndi.unwrap_or(0), nshr.unwrap_or(0));
    let stress_state = StressState::from_counts(counts.0, counts.1, counts.2)
        .filter(|stress_state| stress_state.bits() & L::STRESS_STATES != 0)
        .ok_or(Refusal::Components { first: counts.0, second: counts.1, third: counts.2 })?;
    // constants, for which the compiler unrolls the loops over components
    match stress_state {
        // SAFETY: forwarded to the caller.
        StressState::ThreeD => unsafe { update_in::<L>(a, StressState::ThreeD) },
        // SAFETY: as above.
        StressState::PlaneStrainOrAxisymmetric => unsafe { update_in::<L>(a, StressState::PlaneStrainOrAxisymmetric) },
        // SAFETY: as above.
        StressState::PlaneStress => unsafe { update_in::<L>(a, StressState::PlaneStress) },
    }
}

#[inline(always)]
unsafe fn update_in<L: Law>(a: &Arguments, stress_state: StressState) -> Result<(), Refusal> {
    // SAFETY (this function): the caller of `umat` passes the arguments of a UMAT call; each is checked for
    // NULL before use, and nothing is read beyond the counts that the host gives.
    // SAFETY: as above.
    let props = unsafe { slice(a.props, count(a.nprops, "NPROPS")?, "PROPS") }?;
    check_properties_of::<L>(props)?;
    let parameters = L::parameters(props)?;
    let mut buffer = super::EMPTY;
    // SAFETY: as above.
    let state = unsafe { states(&L::INFO, a.statev, a.nstatv, &mut buffer) }?;
    // SAFETY: as above.
    let increment = unsafe { read_increment::<L>(a, stress_state) }?;
    if const { first_tensor_state(L::INFO.states).is_some() } {
        // SAFETY: as above.
        if let Some(rotation) = unsafe { incremental_rotation(a.drot) }? {
            rotate_states(L::INFO.states, state, &rotation);
        }
    }
    let request = if a.ddsdde.is_null() { Request::Stress } else { Request::StressAndTangent };
    // nothing fails from a finite response on, so that outputs are written all or not at all
    if let Some(response) = L::elastic(&parameters, &increment, state, request) {
        // SAFETY: as above.
        unsafe { write(a, stress_state, &response, state) };
        return Ok(());
    }
    finite(&increment.strain, "NaN or infinity in STRAN or DSTRAN")?;
    // matched in place: a response is not worth a copy
    match &L::update(&parameters, &increment, state, request) {
        Ok(response) => {
            check_response::<L>(response, state, request)?;
            // SAFETY: as above.
            unsafe { write(a, stress_state, response, state) };
            Ok(())
        }
        Err(failure) => Err((*failure).into()),
    }
}

#[inline(always)]
unsafe fn read_increment<L: Law>(a: &Arguments, stress_state: StressState) -> Result<Increment, Refusal> {
    let components = stress_state.components();
    // SAFETY: STRAN, DSTRAN and STRESS have NTENS values.
    let (stran, dstran, stress) = unsafe {
        (
            slice(a.stran, components.len(), "STRAN")?,
            slice(a.dstran, components.len(), "DSTRAN")?,
            slice(a.stress, components.len(), "STRESS")?,
        )
    };
    let mut increment = Increment::at_rest(stress_state);
    for (k, &i) in components.iter().enumerate() {
        increment.strain[i] = stran[k] + dstran[k];
        increment.strain_increment[i] = dstran[k];
        increment.stress[i] = stress[k];
    }
    if const { L::INFO.flags & flags::USES_CELENT != 0 } {
        // SAFETY: CELENT is NULL or valid.
        increment.characteristic_length =
            unsafe { optional(a.celent) }.filter(|length| length.is_finite() && *length > 0.0);
    }
    if L::USES_TIME_INCREMENT {
        // SAFETY: DTIME is NULL or valid.
        let time_increment = unsafe { optional(a.dtime) };
        increment.time_increment = time_increment.filter(|time| time.is_finite() && *time > 0.0).unwrap_or(1.0);
    }
    Ok(increment)
}

/// A result that is not finite must not reach the host.
#[inline(always)]
pub(super) fn check_response<L: Law>(response: &Response, state: &[f64], request: Request) -> Result<(), Refusal> {
    const REASON: &str = "the update overflowed";
    if L::FINITE_OR_FAILS {
        return Ok(());
    }
    if request.wants_tangent() {
        finite(response.tangent.as_flattened(), REASON)?;
    }
    // one decision: they are independent, a branch for each would not be
    if all_finite(&response.stress) & all_finite(state) & all_finite(&[response.stored_energy]) {
        Ok(())
    } else {
        Err(Refusal::CutBack { fraction: CUT_BACK, reason: REASON })
    }
}

#[inline(always)]
unsafe fn write(a: &Arguments, stress_state: StressState, response: &Response, state: &[f64]) {
    // SAFETY: STRESS(NTENS), DDSDDE(NTENS,NTENS) column-major and STATEV(NSTATV ≥ states) were checked for NULL;
    // DDSDDE and the energies may be NULL.
    unsafe {
        // constant component lists, so that the loops unroll
        match stress_state {
            StressState::ThreeD => write_components(a, response, [0, 1, 2, 3, 4, 5]),
            StressState::PlaneStrainOrAxisymmetric => write_components(a, response, [0, 1, 2, 3]),
            StressState::PlaneStress => write_components(a, response, [0, 1, 3]),
        }
        std::slice::from_raw_parts_mut(a.statev, state.len()).copy_from_slice(state);
        store(a.sse, response.stored_energy);
        store(a.spd, response.dissipated_energy);
        store(a.scd, 0.0);
    }
}

/// # Safety
/// As for [`write`].
#[inline(always)]
unsafe fn write_components<const N: usize>(a: &Arguments, response: &Response, components: [usize; N]) {
    // SAFETY: forwarded to the caller.
    unsafe {
        for k in 0..N {
            // one by one: a pair that a law has just written as two numbers would have to wait for both
            a.stress.add(k).write_volatile(response.stress[components[k]]);
        }
        if !a.ddsdde.is_null() {
            for column in 0..N {
                for row in 0..N {
                    let value = response.tangent[components[row]][components[column]];
                    a.ddsdde.add(column * N + row).write(value);
                }
            }
        }
    }
}

/// Index of the first component of a tensor among the states.
const fn first_tensor_state(states: &[StateVariable]) -> Option<usize> {
    let mut k = 0;
    while k < states.len() {
        if states[k].tensor_component == 1 {
            return Some(k);
        }
        k += 1;
    }
    None
}

/// DROT if it is there and is no identity.
#[inline(always)]
unsafe fn incremental_rotation(drot: *const f64) -> Result<Option<[[f64; 3]; 3]>, Refusal> {
    if drot.is_null() {
        return Ok(None);
    }
    // SAFETY: DROT(3,3), column-major.
    let columns = unsafe { std::slice::from_raw_parts(drot, 9) };
    const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    // all of them, without an early exit: that vectorises
    if columns.iter().zip(&IDENTITY).fold(true, |same, (a, b)| same & (a == b)) {
        return Ok(None);
    }
    finite(columns, "NaN or infinity in DROT")?;
    Ok(Some(std::array::from_fn(|row| std::array::from_fn(|column| columns[3 * column + row]))))
}

/// Strain-like tensor states become R ε Rᵀ.
fn rotate_states(table: &[StateVariable], state: &mut [f64], r: &[[f64; 3]; 3]) {
    for start in (0..table.len()).filter(|&k| table[k].tensor_component == 1) {
        let [xx, yy, zz, xy, xz, yz] = [0, 1, 2, 3, 4, 5].map(|i| state[start + i]);
        let tensor = [[xx, 0.5 * xy, 0.5 * xz], [0.5 * xy, yy, 0.5 * yz], [0.5 * xz, 0.5 * yz, zz]];
        for (component, (i, j)) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
            let mut sum = 0.0;
            for k in 0..3 {
                for l in 0..3 {
                    sum += r[i][k] * tensor[k][l] * r[j][l];
                }
            }
            state[start + component] = if i == j { sum } else { 2.0 * sum };
        }
    }
}

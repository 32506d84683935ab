//! The bodies of `uinter_` and `fric_`.

use super::{Answer, EntryArguments, Refusal, count, guarded, optional, refuse, slice, states, store};
use crate::fric::FricArguments;
use crate::law::{InterfaceIncrement, InterfaceLaw, Request, TangentialIncrement};
use crate::law::{advance_contact, advance_sliding, read_parameters};
use crate::table::States;
use crate::uinter::UinterArguments;
use std::ffi::c_char;

/// Runs law `L` as a UINTER.
///
/// # Safety
/// The arguments are those of a UINTER call: every pointer NULL or valid for what ABAQUS defines.
#[inline]
pub unsafe fn uinter<L: InterfaceLaw>(arguments: &UinterArguments) {
    // SAFETY: forwarded to the caller.
    if let Err(refusal) = guarded(|| unsafe { update_uinter::<L>(arguments) }) {
        // SAFETY: forwarded to the caller.
        unsafe { refuse(L::INFO.name, &refusal, &arguments.answer()) };
    }
}

/// Runs the tangential part of law `L` as a FRIC.
///
/// # Safety
/// The arguments are those of a FRIC call: every pointer NULL or valid for what ABAQUS defines.
#[inline]
pub unsafe fn fric<L: InterfaceLaw>(arguments: &FricArguments) {
    // SAFETY: forwarded to the caller.
    if let Err(refusal) = guarded(|| unsafe { update_fric::<L>(arguments) }) {
        // SAFETY: forwarded to the caller.
        unsafe { refuse(L::INFO.name, &refusal, &arguments.answer()) };
    }
}

impl EntryArguments for UinterArguments {
    fn name(&self) -> *const c_char {
        self.ciname
    }

    unsafe fn answer(&self) -> Answer {
        let &Self { ndir, stress, ddsddr: tangent, pnewdt, .. } = self;
        // SAFETY: NDIR is NULL or valid.
        Answer { components: unsafe { optional(ndir) }, most_components: 3, stress, tangent, pnewdt }
    }
}

impl EntryArguments for FricArguments {
    fn name(&self) -> *const c_char {
        self.ciname
    }

    unsafe fn answer(&self) -> Answer {
        let &Self { nfdir, tau: stress, ddtddg: tangent, pnewdt, .. } = self;
        // SAFETY: NFDIR is NULL or valid.
        Answer { components: unsafe { optional(nfdir) }, most_components: 3, stress, tangent, pnewdt }
    }
}

/// A count of directions within its range.
fn directions(value: Option<i32>, most: i32) -> Result<usize, Refusal> {
    match value {
        Some(n) if (1..=most).contains(&n) => Ok(n as usize),
        other => Err(Refusal::Components { first: other.unwrap_or(0), second: 0, third: 0 }),
    }
}

/// Copies the first values of a slice into a fixed array.
fn padded<const N: usize>(values: &[f64]) -> [f64; N] {
    let mut array = [0.0; N];
    array[..values.len()].copy_from_slice(values);
    array
}

unsafe fn update_uinter<L: InterfaceLaw>(a: &UinterArguments) -> Result<(), Refusal> {
    // SAFETY (this function): the caller of `uinter` passes the arguments of a UINTER call; each is checked for
    // NULL before use, and nothing is read beyond the counts that the host gives.
    // SAFETY: as above.
    let n = directions(unsafe { optional(a.ndir) }, 3)?;
    // SAFETY: as above.
    let props = unsafe { slice(a.props, count(a.nprops, "NPROPS")?, "PROPS") }?;
    let parameters: L::Parameters<'_> = read_parameters(&L::INFO, props)?;
    // SAFETY: as above.
    let mut state: L::State = unsafe { states(a.statev, a.nstatv) }?;
    // SAFETY: as above.
    let increment = unsafe {
        InterfaceIncrement {
            directions: n,
            relative_displacement: padded(slice(a.rdisp, n, "RDISP")?),
            increment: padded(slice(a.drdisp, n, "DRDISP")?),
            traction: padded(slice(a.stress, n, "STRESS")?),
        }
    };
    let request = if a.ddsddr.is_null() { Request::Stress } else { Request::StressAndTangent };
    let response = advance_contact::<L>(&parameters, &increment, &mut state, request)?;
    // SAFETY: as above; outputs are written all or not at all.
    unsafe {
        for i in 0..n {
            a.stress.add(i).write(response.traction[i]);
            if !a.ddsddr.is_null() {
                for j in 0..n {
                    a.ddsddr.add(j * n + i).write(response.tangent[i][j]);
                }
            }
        }
        state.write(std::slice::from_raw_parts_mut(a.statev, L::State::TABLE.len()));
        store(a.sed, response.stored_energy);
        store(a.sfd, response.dissipated_energy);
        for pointer in [a.spd, a.svd, a.scd] {
            store(pointer, 0.0);
        }
    }
    Ok(())
}

/// LM on return: TAU, DDTDDG, DDTDDP and DSLIP are given.
const LM_GIVEN: i32 = 0;
/// LM on entry: the point is open.
const LM_OPEN: i32 = 2;

unsafe fn update_fric<L: InterfaceLaw>(a: &FricArguments) -> Result<(), Refusal> {
    // SAFETY (this function): as in `update_uinter`, for a FRIC call.
    // SAFETY: as above.
    if unsafe { optional(a.lm) } == Some(LM_OPEN) {
        return Ok(()); // an open point carries no shear; the manual lets LM stand
    }
    // SAFETY: as above.
    let n = directions(unsafe { optional(a.nfdir) }, 2)?;
    // SAFETY: as above.
    let props = unsafe { slice(a.props, count(a.nprops, "NPROPS")?, "PROPS") }?;
    let parameters: L::Parameters<'_> = read_parameters(&L::INFO, props)?;
    // SAFETY: as above.
    let mut state: L::State = unsafe { states(a.statev, a.nstatv) }?;
    // SAFETY: as above.
    let increment = unsafe {
        slice(a.tau, n, "TAU")?;
        TangentialIncrement {
            directions: n,
            slip_increment: padded(slice(a.dgam, n, "DGAM")?),
            pressure: optional(a.press).ok_or(Refusal::Null { argument: "PRESS" })?,
        }
    };
    let request = if a.ddtddg.is_null() { Request::Stress } else { Request::StressAndTangent };
    let response = advance_sliding::<L>(&parameters, &increment, &mut state, request)?;
    // SAFETY: as above; outputs are written all or not at all.
    unsafe {
        for i in 0..n {
            a.tau.add(i).write(response.traction[i]);
            if !a.ddtddg.is_null() {
                for j in 0..n {
                    a.ddtddg.add(j * n + i).write(response.slip_tangent[i][j]);
                }
            }
            if !a.ddtddp.is_null() {
                a.ddtddp.add(i).write(response.pressure_tangent[i]);
            }
            if !a.dslip.is_null() {
                a.dslip.add(i).write(response.inelastic_slip_increment[i]);
            }
        }
        state.write(std::slice::from_raw_parts_mut(a.statev, L::State::TABLE.len()));
        store(a.sed, response.stored_energy);
        store(a.sfd, response.dissipated_energy);
        if !a.lm.is_null() {
            a.lm.write(LM_GIVEN);
        }
    }
    Ok(())
}

//! A committed point and a step written into the arguments of each entry point, and the answer read back.

use super::subject::{Answer, Committed, INSTANT, Setting};
use nalgebra::Matrix3;
use pullout_run::deformation::columns;
use umat_abi::host::{
    Alteration, CallOutcome, FricAnswer, FricCall, GRADIENTS, Heat, NotFinite, Overrun, PluginCall, SurfaceFields,
    UinterCall, UmatCall,
};

/// The answer, and whether the call wrote past the end of an array. The answer counts all the same; the overrun has its own row.
pub(super) type Called = (Answer, Result<(), Overrun>);

/// The arguments of a UMAT.
pub(super) fn prepare_umat(call: &mut UmatCall, from: &Committed, step: &[f64], share: f64, end: &Matrix3<f64>) {
    let [stored, plastic, creep, ..] = from.energies;
    let states = call.statev().len();
    call.set_point([&from.input, step, &from.output], &from.statev[..states], [stored, plastic, creep]);
    let Setting { time_increment, temperature, fields, .. } = &from.setting;
    call.time = from.time;
    call.dtime = share * time_increment;
    let share = share_of_fields(share);
    [call.temp, call.dtemp] = [temperature[0], share * temperature[1]];
    call.predef.clone_from(&fields[0]);
    call.dpred.clear();
    call.dpred.extend(fields[1].iter().map(|increment| share * increment));
    [call.jstep[0], call.kinc] = from.counters;
    (call.dfgrd0, call.dfgrd1) = (columns(&from.gradient), columns(end));
}

/// Returns the share of the fields' increments. In an instant nothing grows warmer, not even by rounding.
fn share_of_fields(share: f64) -> f64 {
    if share > INSTANT { share } else { 0.0 }
}

/// Passes temperature and field variables to a contact law.
fn set_fields(fields: &mut SurfaceFields, setting: &Setting, share: f64) {
    let (temperature, [starts, ends]) = setting.over(share_of_fields(share));
    fields.set(temperature, [&starts, &ends]);
}

/// Makes the answer in the form common to all three entry points.
fn answer<I, O>(call: &PluginCall<I, O>, [rows, columns]: [usize; 2], not_finite: Option<NotFinite>) -> Answer {
    Answer {
        outcome: call.outcome(),
        output: call.stress().to_vec(),
        tangent: (0..rows * columns).map(|k| call.tangent(k / columns, k % columns)).collect(),
        statev: call.statev().to_vec(),
        energies: [0.0; 5],
        heat: Heat::default(),
        transfer: None,
        slip_increment: [0.0; 2],
        flags: [0; 2],
        not_finite,
        given: Ok(FricAnswer::Tractions),
    }
}

pub(super) fn umat(call: &mut UmatCall, from: &Committed, filling: f64, alteration: Alteration<'_>) -> Called {
    let n = call.ntens();
    let result = call.call_altered(filling, alteration);
    let result = if result == Ok(CallOutcome::Done) { call.add_generated_heat() } else { result.map(|_| ()) };
    let [stored, plastic, creep] = call.energies;
    let answer = answer(call, [n, n], call.not_finite().or_else(|| call.moduli_not_finite()));
    let energies = [stored, plastic, creep, 0.0, 0.0];
    let answer = Answer { energies, heat: call.heat(), flags: from.flags, ..answer };
    // UMATHT as from nothing: U is its increment, or all of it
    match result.and_then(|()| call.transfer(from.setting.temperature_gradient, (0.0, [0.0; GRADIENTS]))) {
        Ok(Some((transfer, outcome))) if answer.outcome == CallOutcome::Done => {
            let not_finite = answer.not_finite.or_else(|| transfer.not_finite());
            (Answer { transfer: Some(transfer), outcome, not_finite, ..answer }, Ok(()))
        }
        Ok(_) => (answer, Ok(())),
        Err(overrun) => (answer, Err(overrun)),
    }
}

/// The arguments of a UINTER.
pub(super) fn prepare_uinter(call: &mut UinterCall, from: &Committed, step: &[f64], share: f64) {
    call.dtime = share * from.setting.time_increment;
    set_fields(&mut call.fields, &from.setting, share);
    let n = step.len();
    for k in 0..n {
        call.rdisp[k] = from.input[k] + step[k];
    }
    call.drdisp[..n].copy_from_slice(step);
    call.stress_mut().copy_from_slice(&from.output);
    let states = call.statev().len();
    call.statev_mut().copy_from_slice(&from.statev[..states]);
    call.energies = from.energies;
    call.flags = from.flags;
    call.time = from.time.map(|time| time + call.dtime);
    [call.counters[0], call.counters[1]] = from.counters;
}

pub(super) fn uinter(call: &mut UinterCall, filling: f64, alteration: Alteration<'_>) -> Called {
    let n = call.stress().len();
    let result = call.call_altered(filling, alteration).map(|_| ());
    let answer = answer(call, [n, n], call.not_finite().or_else(|| call.moduli_not_finite()));
    (Answer { energies: call.energies, flags: call.flags, ..answer }, result)
}

/// The arguments of a FRIC.
pub(super) fn prepare_fric(call: &mut FricCall, from: &Committed, step: &[f64], share: f64) {
    call.dtime = share * from.setting.time_increment;
    set_fields(&mut call.fields, &from.setting, share);
    let n = step.len() - 1;
    call.lm = from.flags[0];
    call.dgam[..n].copy_from_slice(&step[..n]);
    call.pressure = [from.input[n] + step[n], step[n]];
    call.slip = from.slip;
    call.stress_mut().copy_from_slice(&from.output);
    let states = call.statev().len();
    call.statev_mut().copy_from_slice(&from.statev[..states]);
    call.energies.copy_from_slice(&from.energies[..2]);
    call.time = from.time.map(|time| time + call.dtime);
    [call.counters[0], call.counters[1]] = from.counters;
}

pub(super) fn fric(call: &mut FricCall, filling: f64, alteration: Alteration<'_>) -> Called {
    let n = call.stress().len();
    let result = call.call_altered(filling, alteration).map(|_| ());
    let is_closed = call.pressure[0] > 0.0;
    let entry = |row: usize, column: usize| {
        if column < n { call.tangent(row, column) } else { call.pressure_tangent[row] }
    };
    let answer = Answer {
        tangent: (0..n * (n + 1)).map(|k| entry(k / (n + 1), k % (n + 1))).collect(),
        energies: [call.energies[0], call.energies[1], 0.0, 0.0, 0.0],
        slip_increment: call.dslip,
        flags: [if is_closed { call.next_lm() } else { FricCall::OPEN }, 0],
        given: call.answer(),
        ..answer(call, [n, n], call.not_finite().or_else(|| call.moduli_not_finite()))
    };
    (answer, result)
}

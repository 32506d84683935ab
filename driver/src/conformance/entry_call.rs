//! A committed point and a step written into the arguments of each entry point, and the answer read back.

use super::subject::{Answer, Committed};
use umat_abi::host::{Alteration, FricCall, Overrun, UinterCall, UmatCall};

/// The answer, and whether it wrote behind an array: the answer counts all the same, the overrun has a row of its own.
pub(super) type Called = (Answer, Result<(), Overrun>);

/// The arguments of a UMAT.
pub(super) fn prepare_umat(call: &mut UmatCall, from: &Committed, step: &[f64]) {
    let n = step.len();
    call.stran[..n].copy_from_slice(&from.input);
    call.dstran[..n].copy_from_slice(step);
    call.stress_mut().copy_from_slice(&from.output);
    let states = call.statev().len();
    call.statev_mut().copy_from_slice(&from.statev[..states]);
    call.energies.copy_from_slice(&from.energies[..3]);
    call.time = [from.time; 2];
    call.kinc = from.increment;
}

pub(super) fn umat(
    call: &mut UmatCall,
    from: &Committed,
    step: &[f64],
    filling: f64,
    alteration: Alteration<'_>,
) -> Called {
    let n = step.len();
    prepare_umat(call, from, step);
    let result = call.call_altered(filling, alteration).map(|_| ());
    let [stored, plastic, creep] = call.energies;
    let answer = Answer {
        outcome: call.outcome(),
        output: call.stress().to_vec(),
        tangent: (0..n * n).map(|k| call.tangent(k / n, k % n)).collect(),
        statev: call.statev().to_vec(),
        energies: [stored, plastic, creep, 0.0, 0.0],
        slip_increment: [0.0; 2],
        flags: from.flags,
        lm: 0,
    };
    (answer, result)
}

/// The arguments of a UINTER.
pub(super) fn prepare_uinter(call: &mut UinterCall, from: &Committed, step: &[f64]) {
    let n = step.len();
    for k in 0..n {
        call.rdisp[k] = from.input[k] + step[k];
    }
    call.drdisp[..n].copy_from_slice(step);
    call.traction_mut().copy_from_slice(&from.output);
    let states = call.statev().len();
    call.statev_mut().copy_from_slice(&from.statev[..states]);
    call.energies = from.energies;
    call.flags = from.flags;
    call.time = [from.time + call.dtime; 2];
    call.counters[1] = from.increment;
}

pub(super) fn uinter(
    call: &mut UinterCall,
    from: &Committed,
    step: &[f64],
    filling: f64,
    alteration: Alteration<'_>,
) -> Called {
    let n = step.len();
    prepare_uinter(call, from, step);
    let result = call.call_altered(filling, alteration).map(|_| ());
    let answer = Answer {
        outcome: call.outcome(),
        output: call.traction().to_vec(),
        tangent: (0..n * n).map(|k| call.tangent(k / n, k % n)).collect(),
        statev: call.statev().to_vec(),
        energies: call.energies,
        slip_increment: [0.0; 2],
        flags: call.flags,
        lm: 0,
    };
    (answer, result)
}

/// The arguments of a FRIC.
pub(super) fn prepare_fric(call: &mut FricCall, from: &Committed, step: &[f64]) {
    let n = step.len() - 1;
    call.lm = 0;
    call.dgam[..n].copy_from_slice(&step[..n]);
    call.pressure = [from.input[n] + step[n], step[n]];
    call.slip = from.slip;
    call.traction_mut().copy_from_slice(&from.output);
    let states = call.statev().len();
    call.statev_mut().copy_from_slice(&from.statev[..states]);
    call.energies.copy_from_slice(&from.energies[..2]);
    call.time = [from.time + call.dtime; 2];
    call.counters[1] = from.increment;
}

pub(super) fn fric(
    call: &mut FricCall,
    from: &Committed,
    step: &[f64],
    filling: f64,
    alteration: Alteration<'_>,
) -> Called {
    let n = step.len() - 1;
    prepare_fric(call, from, step);
    let result = call.call_altered(filling, alteration).map(|_| ());
    let entry = |row: usize, column: usize| {
        if column < n { call.tangent(row, column) } else { call.pressure_tangent[row] }
    };
    let answer = Answer {
        outcome: call.outcome(),
        output: call.traction().to_vec(),
        tangent: (0..n * (n + 1)).map(|k| entry(k / (n + 1), k % (n + 1))).collect(),
        statev: call.statev().to_vec(),
        energies: [call.energies[0], call.energies[1], 0.0, 0.0, 0.0],
        slip_increment: call.dslip,
        flags: from.flags,
        lm: call.lm,
    };
    (answer, result)
}

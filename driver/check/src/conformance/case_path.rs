//! The case's own path: the point before each increment and the arguments of the plugin's calls. It determines the scale of the
//! law and the states that occur in use.

use super::Options;
use super::report::{Ledger, Report, Verdict};
use super::subject::{CheckedEntryPoint, Committed, Setting};
use pullout_run::isolation::worker;
use pullout_run::path::{self, Accepted, ContactPointState, MaterialPoint, Observer, Row, Statistics, Stop};
use pullout_run::program::{InterfaceEntry, PointKind, Program};
use std::io;
use std::time::Duration;
use umat_abi::host::{ExternalDatabases, FricCall, UinterCall, UmatCall};
use umat_abi::law::StressState;

/// Increments kept; of a longer path every second, fourth, ...
const KEPT: usize = 4096;
/// Name of the row.
const CHECK: &str = "case's path";
/// Time that the path may take: a check is not a run.
const TIME_LIMIT: Duration = Duration::from_millis(1500);

/// One increment of the path.
#[derive(Clone, Debug)]
pub(super) struct Increment {
    /// The point before it.
    pub(super) from: Committed,
    pub(super) step: Vec<f64>,
    /// Outputs, STATEV and energies after it.
    pub(super) answer: Vec<f64>,
}

/// Path that a case takes a plugin along.
#[derive(Clone, Debug)]
pub(super) struct CasePath {
    /// The entry point that it calls.
    pub(super) entry: CheckedEntryPoint,
    pub(super) increments: Vec<Increment>,
    /// The point before the first increment, reached or not; `None`: the case cannot begin.
    pub(super) start: Option<Committed>,
    /// What is to be said of it.
    remarks: Vec<String>,
    /// One of so many is kept.
    stride: usize,
    /// Number of increments, kept or not.
    pub(super) taken: u64,
    /// Whether it ended with a failure, and not for its length.
    pub(super) is_failed: bool,
}

impl CasePath {
    /// Runs a case, whose UMAT is called as a run calls it: with six components in a plane too, if the case says so or the
    /// UMAT needs it. The rows are then of those six.
    pub(super) fn of(
        program: &Program,
        options: &Options,
        databases: &mut ExternalDatabases,
        report: &mut Report,
    ) -> Self {
        let mut entry = entry(program);
        // the calls that find out are part of it
        Ledger::new(report, options.label(entry)).begin(CHECK);
        let mut reason = None;
        if let (
            PointKind::Point(point),
            CheckedEntryPoint::Umat(StressState::PlaneStrainOrAxisymmetric | StressState::PlaneStress),
        ) = (&program.kind, entry)
            && let Ok((stress_state, why)) = path::components_of_calls(program, point, databases)
        {
            (entry, reason) =
                (CheckedEntryPoint::Umat(stress_state), why.map(|why| format!("NTENS = 6, as a run calls it: {why}")));
        }
        if let PointKind::Interface(contact) = &program.kind
            && let Ok((directions, why)) = path::directions_of_calls(program, contact, databases)
        {
            entry = contact_entry(contact.entry, directions);
            reason = why.map(|why| format!("two slip directions, as a run calls it: {why}"));
        }
        Ledger::new(report, options.label(entry)).begin(CHECK);
        let time_limit = TIME_LIMIT.min(options.share_of_time());
        let (mut path, failure) = Self::along(program, entry, options, time_limit, databases, &mut || ());
        let reason = reason.map(|reason| format!("called with {reason}"));
        path.remarks = reason.into_iter().chain(failure).collect();
        path
    }

    /// Adds the row; `fails`: not even the point before the first increment can be called.
    pub(super) fn report(&self, fails: bool, ledger: &mut Ledger<'_>) {
        let verdict = match self.remarks.is_empty() {
            _ if fails => Verdict::Fail,
            true => Verdict::Info,
            false => Verdict::Warn,
        };
        ledger.row(CHECK, verdict, format!("{} increments", self.taken), self.remarks.join("; "));
    }

    /// Returns whether the case ends before its first increment does.
    pub(super) fn fails_at_once(&self) -> bool {
        self.is_failed && self.increments.is_empty()
    }

    /// Runs the same case once more, in a fraction of the time. `between` is called after each increment.
    pub(super) fn again(
        &self,
        program: &Program,
        options: &Options,
        databases: &mut ExternalDatabases,
        between: &mut dyn FnMut(),
    ) -> Self {
        const PART: u32 = 4;
        let time_limit = TIME_LIMIT.min(options.share_of_time()) / PART;
        Self::along(program, self.entry, options, time_limit, databases, between).0
    }

    /// Runs a case and calls `between` after each increment. Returns the path, and why it ended early if it did.
    fn along(
        program: &Program,
        entry: CheckedEntryPoint,
        options: &Options,
        time_limit: Duration,
        databases: &mut ExternalDatabases,
        between: &mut dyn FnMut(),
    ) -> (Self, Option<String>) {
        let mut program = program.clone();
        program.about.every = 1;
        let longest = options.longest_path.unwrap_or(u64::MAX);
        let end = super::processor_time() + time_limit;
        let mut keeper =
            Keeper { entry, increments: Vec::new(), start: None, stride: 1, count: 0, end, longest, between };
        let (statistics, result) = path::run_within(&program, databases, &mut keeper);
        let is_failed = matches!(result, Err(Stop::Failed(_)));
        let failure = match result {
            Ok(()) => None,
            Err(Stop::Failed(failure)) => Some(failure.message),
            Err(Stop::Write(_)) if keeper.count as u64 >= longest => {
                Some(format!("stopped after {longest} increments: the plugin does not survive the next one"))
            }
            Err(Stop::Write(_)) => Some(format!(
                "stopped after {} increments, because it takes longer than {:.1} s",
                statistics.increments,
                time_limit.as_secs_f64()
            )),
        };
        let Keeper { increments, start, stride, .. } = keeper;
        let taken = statistics.increments;
        (Self { entry, increments, start, remarks: Vec::new(), stride, taken, is_failed }, failure)
    }

    /// The increments that both have, in pairs.
    pub(super) fn pairs<'p>(&'p self, other: &'p Self) -> impl Iterator<Item = (&'p Increment, &'p Increment)> {
        let stride = self.stride.max(other.stride);
        let [these, others] = [self, other].map(|path| path.increments.iter().step_by(stride / path.stride));
        these.zip(others)
    }

    /// Returns the largest magnitude of each input at the ends of the increments.
    pub(super) fn sizes(&self) -> Vec<f64> {
        let largest = |k: usize| {
            let ends = self.increments.iter().map(|increment| (increment.from.input[k] + increment.step[k]).abs());
            ends.fold(0.0, f64::max)
        };
        (0..self.entry.inputs()).map(largest).collect()
    }
}

/// The entry point of a case, with the components of its mode.
pub(super) fn entry(program: &Program) -> CheckedEntryPoint {
    match &program.kind {
        PointKind::Point(point) => CheckedEntryPoint::Umat(point.mode.stress_state()),
        PointKind::Interface(contact) => contact_entry(contact.entry, contact.tangential_directions),
    }
}

fn contact_entry(entry: InterfaceEntry, tangential_directions: usize) -> CheckedEntryPoint {
    match entry {
        InterfaceEntry::Uinter => CheckedEntryPoint::Uinter(1 + tangential_directions),
        InterfaceEntry::Fric => CheckedEntryPoint::Fric(tangential_directions),
    }
}

/// Keeps the increments of a run.
struct Keeper<'k> {
    entry: CheckedEntryPoint,
    increments: Vec<Increment>,
    start: Option<Committed>,
    stride: usize,
    count: usize,
    /// Processor time ([`super::processor_time`]) at which it ends.
    end: Duration,
    longest: u64,
    /// Called after each increment.
    between: &'k mut dyn FnMut(),
}

impl Observer for Keeper<'_> {
    fn row(&mut self, row: Row<'_>) -> io::Result<()> {
        if row.step == 0 { Ok(()) } else { self.go_on() }
    }

    fn begins(&mut self, start: Accepted<'_>) -> io::Result<()> {
        self.start = Some(self.increment(start).from);
        self.go_on()
    }

    fn looks_outside_arrays(&self) -> bool {
        // a row of its own says so
        false
    }

    fn increment_done(&mut self, _row: Row<'_>, _so_far: Statistics) {}

    fn accepted(&mut self, accepted: Accepted<'_>) {
        self.count += 1;
        worker::note_call();
        (self.between)();
        if !(self.count - 1).is_multiple_of(self.stride) {
            return;
        }
        if self.increments.len() == KEPT {
            self.stride *= 2;
            self.increments = std::mem::take(&mut self.increments).into_iter().step_by(2).collect();
            if !(self.count - 1).is_multiple_of(self.stride) {
                return;
            }
        }
        self.increments.push(self.increment(accepted));
    }
}

impl Keeper<'_> {
    /// Refuses to go on where it takes too long, or where the plugin would not come back.
    fn go_on(&self) -> io::Result<()> {
        let is_left = super::processor_time() > self.end || self.count as u64 >= self.longest;
        if is_left { Err(io::ErrorKind::TimedOut.into()) } else { Ok(()) }
    }

    fn increment(&self, accepted: Accepted<'_>) -> Increment {
        match accepted {
            Accepted::Umat(before, call) => of_umat(self.entry, before, call),
            Accepted::Uinter(before, call) => of_uinter(before, call),
            Accepted::Fric(before, call) => of_fric(before, call),
        }
    }
}

fn of_umat(entry: CheckedEntryPoint, before: &MaterialPoint, call: &UmatCall) -> Increment {
    let called = call.solid().unwrap_or(call);
    let mut gradient = before.deformation_gradient;
    if call.is_through_solid() {
        // in plane stress the thickness is found by the call
        gradient[(2, 2)] = called.dfgrd0[2][2];
    }
    let [stored, plastic, creep] = before.energies;
    let mut point = [entry.of_six(&before.strain), entry.of_six(&before.stress)];
    let mut step = called.dstran[..called.ntens()].to_vec();
    let mut stress = called.stress().to_vec();
    if let Some(view) = call.law_view() {
        // the law is checked in its own axes, without the strains that it does not see
        if call.is_through_solid() {
            point = [called.stran.to_vec(), call.stress_state().six(&view.stress_before).to_vec()];
        } else {
            let count = call.ntens();
            point = [view.strain[..count].to_vec(), view.stress_before[..count].to_vec()];
            (step, stress) = (view.strain_increment[..count].to_vec(), view.stress[..count].to_vec());
        }
        gradient = nalgebra::Matrix3::from_fn(|row, column| view.dfgrd0[column][row]);
        gradient[(2, 2)] = if call.is_through_solid() { called.dfgrd0[2][2] } else { gradient[(2, 2)] };
    }
    let [input, output] = point;
    let from = Committed {
        input,
        output,
        statev: before.statev.clone(),
        energies: [stored, plastic, creep, 0.0, 0.0],
        time: call.time,
        counters: [call.jstep[0], call.kinc],
        gradient,
        setting: Setting {
            time_increment: call.dtime,
            temperature: [call.temp, call.dtemp],
            fields: [call.predef.clone(), call.dpred.clone()],
            ..Setting::default()
        },
        ..Committed::zero(entry, before.statev.len())
    };
    let answer = [&stress, called.statev(), &called.energies].concat();
    Increment { from, step, answer }
}

fn of_uinter(before: &ContactPointState, call: &UinterCall) -> Increment {
    // what surrounds the point stays with the call of the plane
    let (fields, call) = (&call.fields, call.wide().unwrap_or(call));
    let directions = call.stress().len();
    let entry = CheckedEntryPoint::Uinter(directions);
    let from = Committed {
        input: [-before.gap, before.slip[0], before.slip[1]][..directions].to_vec(),
        output: [before.pressure, before.shear[0], before.shear[1]][..directions].to_vec(),
        statev: before.statev.clone(),
        energies: before.energies,
        flags: before.flags,
        time: call.time.map(|time| time - call.dtime),
        counters: [call.counters[0], call.counters[1]],
        setting: Setting::of_contact(fields, call.dtime),
        ..Committed::zero(entry, before.statev.len())
    };
    let answer = [call.stress(), call.statev(), &call.energies].concat();
    Increment { from, step: call.drdisp[..directions].to_vec(), answer }
}

fn of_fric(before: &ContactPointState, call: &FricCall) -> Increment {
    let (fields, call) = (&call.fields, call.wide().unwrap_or(call));
    let directions = call.stress().len();
    let entry = CheckedEntryPoint::Fric(directions);
    let [stored, dissipated, ..] = before.energies;
    let from = Committed {
        input: before.slip[..directions].iter().copied().chain([before.pressure]).collect(),
        output: before.shear[..directions].to_vec(),
        statev: before.statev.clone(),
        energies: [stored, dissipated, 0.0, 0.0, 0.0],
        slip: before.inelastic_slip,
        flags: before.flags,
        time: call.time.map(|time| time - call.dtime),
        counters: call.counters,
        setting: Setting::of_contact(fields, call.dtime),
        ..Committed::zero(entry, before.statev.len())
    };
    let answer = [call.stress(), call.statev(), &call.energies].concat();
    Increment { from, step: call.dgam[..directions].iter().copied().chain([call.pressure[1]]).collect(), answer }
}

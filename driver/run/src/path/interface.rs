//! A contact point along a path of slip and gap or pressure.
//!
//! Outside the plugin gap > 0 is open and p > 0 is compression: gap = −RDISP(1), p = STRESS(1).

use super::subdivision::{AttemptFailure, Dependence, Divisible, depends_on_length, take_steps};
use super::{Accepted, Observer, Recorder, Statistics, Stop, newton::STRESS_TOLERANCE, replay};
use crate::arguments::ContactArguments;
use crate::columns::{self, CONTACT, ContactPointState as Committed};
use crate::number::exact;
use crate::program::lerp;
use crate::program::{
    FieldValues, InterfaceEntry, InterfaceGoal, InterfaceProgram, InterfaceStep, NormalControl, Pace, Program,
};
use std::io;
use umat_abi::host::{
    Clock, Derived, ExternalDatabases, FricAnswer, FricCall, LoadError, MOMENT, SurfaceFields, Trespass, UinterCall,
    judge,
};

/// Index of the normal value in \[slip, slip2, normal\].
const NORMAL: usize = 2;

/// Runs an interface program.
pub(super) fn run(
    program: &Program,
    interface: &InterfaceProgram,
    databases: &mut ExternalDatabases,
    observer: &mut dyn Observer,
    statistics: &mut Statistics,
) -> Result<(), Stop> {
    let mut runner = Runner::new(program, interface, databases).map_err(Stop::unusable)?;
    let mut recorder = Recorder::new(program, observer);
    if let Some(reason) = runner.call.why_wide() {
        recorder.observer.warn(format!(
            "{} is called with two slip directions: {reason} (\"slip2\": 0 in the steps asks for that)",
            program.plugin.name
        ));
    }
    recorder.initial(|values| runner.fill(values))?;
    let result = take_steps(&mut runner, &interface.steps, program, &mut recorder, statistics);
    if runner.depends_on_length == Some(true) {
        recorder.observer.warn(format!("{}: {}", program.plugin.name, depends_on_length("CHRLNGTH")));
    }
    result
}

/// Returns the number of tangential directions with which the contact law of a program is called, and why there are two
/// in a plane.
///
/// # Errors
/// The law cannot be called at all.
pub fn directions_of_calls(
    program: &Program,
    interface: &InterfaceProgram,
    databases: &mut ExternalDatabases,
) -> Result<(usize, Option<String>), String> {
    let runner = Runner::new(program, interface, databases)?;
    let reason = runner.call.why_wide().map(str::to_owned);
    Ok((runner.directions + usize::from(reason.is_some()), reason))
}

/// The entry point in use.
enum Call {
    Uinter(Box<UinterCall>),
    Fric(Box<FricCall>),
}

/// Sets a call to the start of an increment.
fn set_uinter(call: &mut UinterCall, start: &Committed, directions: usize) {
    let tractions = [start.pressure, start.shear[0], start.shear[1]];
    call.stress_mut().copy_from_slice(&tractions[..=directions]);
    call.statev_mut().copy_from_slice(&start.statev);
    call.energies = start.energies;
    call.flags = start.flags;
}

/// Sets a call to the start of an increment.
fn set_fric(call: &mut FricCall, start: &Committed, directions: usize) {
    call.lm = start.flags[0];
    call.stress_mut().copy_from_slice(&start.shear[..directions]);
    call.statev_mut().copy_from_slice(&start.statev);
    call.energies = [start.energies[0], start.energies[1]];
}

impl Call {
    /// Sets tractions, states and energies to those at the start of an increment.
    fn set_point(&mut self, start: &Committed, directions: usize) {
        match self {
            Self::Uinter(call) => set_uinter(call, start, directions),
            Self::Fric(call) => set_fric(call, start, directions),
        }
    }

    /// Returns why calls in a plane are made with two slip directions, if they are.
    fn why_wide(&self) -> Option<&str> {
        match self {
            Self::Uinter(call) => call.why_wide(),
            Self::Fric(call) => call.why_wide(),
        }
    }

    /// Temperature and field variables.
    fn fields(&mut self) -> &mut SurfaceFields {
        match self {
            Self::Uinter(call) => &mut call.fields,
            Self::Fric(call) => &mut call.fields,
        }
    }
}

/// Goal of the current increment: \[slip, slip2, normal\] at its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct InterfaceIncrementGoal {
    pub(super) normal: NormalControl,
    start: [f64; 3],
    pub(super) end: [f64; 3],
    /// Step time at the start and at the end of the increment.
    pub(super) step_time: (f64, f64),
    /// Total time at the start of the step.
    pub(super) time_of_step: f64,
}

struct Runner<'p> {
    call: Call,
    databases: &'p mut ExternalDatabases,
    /// Time and counters of the present attempt, for UEXTERNALDB.
    clock: Clock,
    directions: usize,
    arguments: &'p ContactArguments,
    derived: &'p [Derived],
    /// Whether no metadata vouch for the plugin.
    is_plain: bool,
    max_iterations: u32,
    committed: Committed,
    trial: Committed,
    goal: InterfaceIncrementGoal,
    /// Temperature and field variables at the start and at the end of the current increment.
    fields: [FieldValues; 2],
    /// \[slip, slip2, normal\] and fields at the start of the step.
    start: ([f64; 3], FieldValues),
    /// ∂p/∂penetration of the last evaluation.
    normal_stiffness: f64,
    /// Whether nothing has been attempted yet.
    is_first_attempt: bool,
    /// Whether the law's answer depends on CHRLNGTH, which the case does not give; `None`: it does.
    depends_on_length: Option<bool>,
}

impl<'p> Runner<'p> {
    fn new(
        program: &'p Program,
        interface: &'p InterfaceProgram,
        databases: &'p mut ExternalDatabases,
    ) -> Result<Self, String> {
        let plugin = &program.plugin;
        let directions = interface.tangential_directions;
        let arguments = &interface.arguments;
        let failed = |error: LoadError| error.to_string();
        let call = match interface.entry {
            InterfaceEntry::Uinter => {
                let mut call = plugin.uinter(directions + 1).map_err(failed)?;
                call.chrlngth = program.characteristic_length.unwrap_or(call.chrlngth);
                arguments.set_uinter(&mut call);
                plugin.probe_uinter(&mut call).map_err(failed)?;
                Call::Uinter(Box::new(call))
            }
            InterfaceEntry::Fric => {
                let mut call = plugin.fric(directions).map_err(failed)?;
                call.chrlngth = program.characteristic_length.unwrap_or(call.chrlngth);
                arguments.set_fric(&mut call);
                plugin.probe_fric(&mut call).map_err(failed)?;
                Call::Fric(Box::new(call))
            }
        };
        let [slip, slip2, gap] = interface.initial_displacement;
        let [pressure, shear, shear2] = arguments.traction.unwrap_or_default();
        let energies = arguments.energies.unwrap_or_default();
        let (gap, energies, flags) = match interface.entry {
            InterfaceEntry::Uinter => (gap, energies, arguments.flags.unwrap_or([-1; 2])),
            InterfaceEntry::Fric => {
                let [stored, dissipated, ..] = energies;
                let energies = [stored, dissipated, f64::NAN, f64::NAN, f64::NAN];
                (f64::NAN, energies, [arguments.lm.unwrap_or(FricCall::STICKING), 0])
            }
        };
        let committed = Committed {
            slip: [slip, slip2],
            gap,
            shear: [shear, shear2],
            pressure,
            inelastic_slip: arguments.slip.unwrap_or_default(),
            statev: interface.initial_statev.clone(),
            energies,
            flags,
            step_time: 0.0,
            total_time: interface.initial_time,
            fields: interface.initial_fields.clone(),
        };
        let mut runner = Self {
            call,
            databases,
            clock: Clock::default(),
            directions,
            arguments,
            is_plain: plugin.law.is_none(),
            derived: plugin.law.as_ref().map_or(&[], |law| &law.derived),
            max_iterations: program.controls.max_iterations,
            trial: committed.clone(),
            committed,
            goal: InterfaceIncrementGoal {
                normal: NormalControl::Gap,
                start: [0.0; 3],
                end: [0.0; 3],
                step_time: (0.0, 0.0),
                time_of_step: interface.initial_time,
            },
            fields: [interface.initial_fields.clone(), interface.initial_fields.clone()],
            start: ([0.0; 3], interface.initial_fields.clone()),
            normal_stiffness: 0.0,
            is_first_attempt: true,
            depends_on_length: program.characteristic_length.is_none().then_some(false),
        };
        runner.set_fields(1.0, 1.0);
        runner.find_initial_traction()?;
        Ok(runner)
    }

    /// Passes temperature and field variables at two fractions of the increment to the plugin.
    fn set_fields(&mut self, from: f64, to: f64) {
        let [start, end] = &self.fields;
        let trial = &mut self.trial.fields;
        trial.set_between(start, end, from);
        let before = trial.clone();
        trial.set_between(start, end, to);
        self.call.fields().set([before.temperature, trial.temperature], [&before.variables, &trial.variables]);
    }

    /// Finds the traction at the initial position. A soft contact carries pressure at gap 0: the history's first line
    /// shows that traction, and the energy stored with it.
    fn find_initial_traction(&mut self) -> Result<(), String> {
        if matches!(self.call, Call::Uinter(_)) && self.arguments.traction.is_none() {
            let place = [self.committed.slip[0], self.committed.slip[1], -self.committed.gap];
            self.evaluate(place, MOMENT, false, &mut Statistics::default())
                .map_err(|(AttemptFailure::CutBack { reason, .. } | AttemptFailure::Fatal(reason))| reason)?;
            self.committed.shear = self.trial.shear;
            self.committed.pressure = self.trial.pressure;
            if self.arguments.energies.is_none() {
                // what is stored; nothing is dissipated on no way
                self.committed.energies[0] = self.trial.energies[0];
            }
        }
        Ok(())
    }

    /// Makes one call from the committed state; `place` is \[slip, slip2, penetration\] (UINTER) or
    /// \[slip, slip2, pressure\] (FRIC) at the end. `is_first`: the case may give the increments, as sums and
    /// differences round.
    fn evaluate(
        &mut self,
        place: [f64; 3],
        time_increment: f64,
        is_first: bool,
        statistics: &mut Statistics,
    ) -> Result<(), AttemptFailure> {
        statistics.plugin_calls += 1;
        let of_path = ContactArguments::default();
        let given = if is_first { self.arguments } else { &of_path };
        let committed = &self.committed;
        let trial = &mut self.trial;
        trial.slip = [place[0], place[1]];
        self.call.set_point(committed, self.directions);
        let (outcome, not_finite) = match &mut self.call {
            Call::Uinter(call) => {
                let displacement = [place[NORMAL], place[0], place[1]];
                let before = [-committed.gap, committed.slip[0], committed.slip[1]];
                call.rdisp = displacement;
                call.drdisp = given.drdisp.unwrap_or_else(|| std::array::from_fn(|i| displacement[i] - before[i]));
                call.dtime = given.dtime.unwrap_or(time_increment);
                call.time = given.time.unwrap_or([self.arguments.start() + trial.step_time, trial.total_time]);
                let outcome = call.call();
                trial.gap = -place[NORMAL];
                trial.pressure = call.stress()[0];
                trial.shear[..self.directions].copy_from_slice(&call.stress()[1..]);
                trial.statev.copy_from_slice(call.statev());
                trial.energies = call.energies;
                trial.flags = call.flags;
                self.normal_stiffness = call.tangent(0, 0);
                (outcome, call.not_finite())
            }
            Call::Fric(call) => {
                call.dgam = [place[0] - committed.slip[0], place[1] - committed.slip[1]];
                call.slip = committed.inelastic_slip;
                call.pressure = [place[NORMAL], given.dpress.unwrap_or(place[NORMAL] - committed.pressure)];
                call.dtime = given.dtime.unwrap_or(time_increment);
                call.time = given.time.unwrap_or([self.arguments.start() + trial.step_time, trial.total_time]);
                let outcome = call.call();
                trial.pressure = place[NORMAL];
                trial.shear = [0.0; 2];
                match call.answer() {
                    Ok(FricAnswer::Tractions) => trial.shear[..self.directions].copy_from_slice(call.stress()),
                    Ok(FricAnswer::Sticks) => {
                        return Err(AttemptFailure::Fatal(
                            "it returned LM = 1 (the host enforces stick): under a prescribed slip the \
                             traction is then undefined"
                                .into(),
                        ));
                    }
                    Ok(FricAnswer::NoShear) => {}
                    Err(message) => return Err(AttemptFailure::Fatal(message)),
                }
                trial.statev.copy_from_slice(call.statev());
                trial.inelastic_slip = std::array::from_fn(|i| committed.inelastic_slip[i] + call.dslip[i]);
                trial.energies[..2].copy_from_slice(&call.energies);
                // without pressure nothing touches
                trial.flags = [if place[NORMAL] > 0.0 { call.next_lm() } else { FricCall::OPEN }, 0];
                (outcome, call.not_finite())
            }
        };
        Ok(judge(outcome, not_finite)?)
    }

    /// Makes the last call of a plugin that nobody vouches for again, to see whether it leaves its arrays.
    fn trespass(&mut self) -> Option<Trespass> {
        if !self.is_plain {
            return None;
        }
        self.call.set_point(&self.committed, self.directions);
        match &mut self.call {
            Call::Uinter(call) => call.trespass_again(),
            Call::Fric(call) => call.trespass_again(),
        }
    }

    /// UINTER under a prescribed pressure: Newton on DDSDDR(1,1) for the penetration, with bisection once two places
    /// enclose the pressure.
    fn find_pressure(
        &mut self,
        slip: [f64; 2],
        pressure: f64,
        dtime: f64,
        is_first: bool,
        statistics: &mut Statistics,
    ) -> Result<u32, AttemptFailure> {
        let tolerance = STRESS_TOLERANCE * pressure.abs().max(1.0);
        let mut penetration = -self.committed.gap;
        let (mut below, mut above) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut is_lost = false;
        for iteration in 1..=self.max_iterations {
            self.evaluate([slip[0], slip[1], penetration], dtime, is_first && iteration == 1, statistics)?;
            let residual = self.trial.pressure - pressure;
            if residual.abs() <= tolerance {
                return Ok(iteration);
            }
            if residual < 0.0 {
                below = below.max(penetration)
            } else {
                above = above.min(penetration)
            }
            let newton = penetration - residual / self.normal_stiffness;
            penetration = if newton.is_finite() && newton > below && newton < above {
                newton
            } else if below.is_finite() && above.is_finite() {
                0.5 * (below + above)
            } else {
                is_lost = true;
                break;
            };
        }
        let within = match self.max_iterations {
            _ if is_lost => String::new(),
            most => format!(" in {most} iterations, max_iterations"),
        };
        Err(AttemptFailure::CutBack {
            fraction: 0.5,
            reason: format!(
                "no gap found for p = {} MPa{within} (reached {} MPa): {}the normal law does not carry it; control gap \
                 instead",
                exact(pressure),
                exact(self.committed.pressure),
                if is_lost { "" } else { "these are too few, or " }
            ),
        })
    }
}

impl Divisible for Runner<'_> {
    type Goal = InterfaceGoal;

    fn begin(&mut self, step: &InterfaceStep, _number: u32, _program: &Program) -> Result<(), Stop> {
        let Committed { slip: [slip, slip2], gap, pressure, ref fields, .. } = self.committed;
        let normal = match step.goal.normal {
            NormalControl::Gap => gap,
            NormalControl::Pressure => pressure,
        };
        self.start = ([slip, slip2, normal], fields.clone());
        self.committed.step_time = 0.0;
        self.goal.time_of_step = self.committed.total_time;
        Ok(())
    }

    fn aim(&mut self, step: &InterfaceStep, number: u32, index: usize) {
        if index == 0 {
            let counters = self.arguments.counters(number, 1);
            [self.clock.step, self.clock.increment, _] = counters;
            match &mut self.call {
                Call::Uinter(call) => call.counters = counters,
                Call::Fric(call) => [call.counters[0], call.counters[1], _] = counters,
            }
        }
        let (start, fields) = &self.start;
        let goal = &mut self.goal;
        let ends = &step.goal.ends;
        goal.normal = step.goal.normal;
        goal.step_time = step.pace.times(index, self.committed.step_time);
        for i in 0..3 {
            let held = |end: &[Option<f64>; 3]| end[i].unwrap_or(start[i]);
            (goal.start[i], goal.end[i]) = match step.pace {
                Pace::Equal { .. } => {
                    let [before, after] = step.pace.shares(index);
                    (lerp(start[i], held(&ends[0]), before), lerp(start[i], held(&ends[0]), after))
                }
                Pace::Rows(_) if index == 0 => (start[i], held(&ends[0])),
                Pace::Rows(_) => (held(&ends[index - 1]), held(&ends[index])),
            };
        }
        step.fields.set_increment(fields, &self.committed.fields, &step.pace, index, &mut self.fields);
    }

    fn report_start(&mut self, observer: &mut dyn Observer) -> io::Result<()> {
        self.set_fields(0.0, 1.0);
        let duration = self.goal.step_time.1 - self.goal.step_time.0;
        let time = [self.committed.step_time, self.committed.total_time].map(|start| start + duration);
        observer.begins(match &mut self.call {
            Call::Uinter(call) => {
                (call.dtime, call.time) = (duration, time);
                Accepted::Uinter(&self.committed, call)
            }
            Call::Fric(call) => {
                (call.dtime, call.time) = (duration, time);
                Accepted::Fric(&self.committed, call)
            }
        })
    }

    fn attempt(&mut self, from: f64, to: f64, statistics: &mut Statistics) -> Result<u32, AttemptFailure> {
        let goal = self.goal;
        let place: [f64; 3] = std::array::from_fn(|i| lerp(goal.start[i], goal.end[i], to));
        let at = |fraction| lerp(goal.step_time.0, goal.step_time.1, fraction);
        let time_increment = at(to) - at(from);
        self.trial.step_time = at(to);
        self.trial.total_time = goal.time_of_step + at(to);
        self.set_fields(from, to);
        let is_first = std::mem::take(&mut self.is_first_attempt);
        if is_first {
            let ContactArguments { dtemp, dpred, .. } = self.arguments;
            self.call.fields().set_increments(*dtemp, dpred.as_deref());
        }
        let start = [self.committed.step_time, self.committed.total_time];
        self.clock = Clock { time: start, time_increment, ..self.clock };
        self.databases.increment_starts(self.clock);
        let [slip, slip2, normal] = place;
        let iterations = match (goal.normal, &self.call) {
            (NormalControl::Pressure, Call::Uinter(_)) => {
                self.find_pressure([slip, slip2], normal, time_increment, is_first, statistics)?
            }
            (control, _) => {
                let normal = if control == NormalControl::Gap { -normal } else { normal };
                self.evaluate([slip, slip2, normal], time_increment, is_first, statistics)?;
                1
            }
        };
        statistics.iterations += u64::from(iterations);
        Ok(iterations)
    }

    fn look_again(&mut self, _from: f64, _statistics: &mut Statistics) -> Option<String> {
        let result = match &self.call {
            Call::Uinter(call) => call.not_finite(),
            Call::Fric(call) => call.not_finite(),
        }?;
        self.trespass().map(|trespass| format!("it returned {result}; it {trespass}"))
    }

    fn look_outside(&mut self) -> Option<String> {
        if !self.is_plain {
            return None;
        }
        let (start, directions) = (&self.committed, self.directions);
        let is_length_open = self.depends_on_length == Some(false);
        let dependence = Dependence::find(|| match &mut self.call {
            Call::Uinter(call) => {
                call.leave_record();
                let prepare = |call: &mut UinterCall| set_uinter(call, start, directions);
                [call.depends_on_surroundings(prepare), is_length_open && call.depends_on_length(prepare)]
            }
            Call::Fric(call) => {
                call.leave_record();
                let prepare = |call: &mut FricCall| set_fric(call, start, directions);
                [call.depends_on_surroundings(prepare), is_length_open && call.depends_on_length(prepare)]
            }
        });
        if dependence.on_length {
            self.depends_on_length = Some(true);
        }
        if !dependence.on_surroundings {
            return None;
        }
        self.trespass().map(|trespass| format!("it {trespass}, and its answer depends on it"))
    }

    fn commit(&mut self, observer: &mut dyn Observer) {
        observer.accepted(match &self.call {
            Call::Uinter(call) => Accepted::Uinter(&self.committed, call),
            Call::Fric(call) => Accepted::Fric(&self.committed, call),
        });
        self.committed.clone_from(&self.trial);
        let end = [self.committed.step_time, self.committed.total_time];
        self.databases.increment_ends(Clock { time: end, ..self.clock });
        // to the law a piece of an increment is one: no two have the same number
        self.clock.increment = self.clock.increment.saturating_add(1);
        match &mut self.call {
            Call::Uinter(call) => call.counters[1] = self.clock.increment,
            Call::Fric(call) => call.counters[1] = self.clock.increment,
        }
    }

    fn fill(&self, values: &mut [f64]) {
        let state = &self.committed;
        let derived = self.derived.iter().map(|derived| derived.value(&state.statev));
        let left_out = columns::left_out_of_contact(self.directions);
        columns::fill(CONTACT, left_out, state, state.statev.iter().copied().chain(derived), values);
    }

    fn replay(&self, program: &Program, to: f64) -> serde_json::Value {
        let Clock { step, increment, .. } = self.clock;
        let mut goal = self.goal;
        goal.end = std::array::from_fn(|i| lerp(goal.start[i], goal.end[i], to));
        goal.step_time.1 = lerp(goal.step_time.0, goal.step_time.1, to);
        let [start, end] = &self.fields;
        let mut fields_at_end = end.clone();
        fields_at_end.set_between(start, end, to);
        replay::interface(program, &self.committed, &goal, &fields_at_end, [step, increment, 1])
    }
}

//! A material point along a path.

use super::finite::Finite;
use super::newton::{Divergence, Evaluation, LARGEST_CHANGE, STRESS_TOLERANCE, Targets, is_unknown};
use super::subdivision::{AttemptFailure, Dependence, Divisible, depends_on_length, take_steps};
use super::{Accepted, Observer, Recorder, RunFailure, Statistics, Stop, replay};
use crate::arguments::UmatArguments;
use crate::columns::{self, Group, POINT, PointRow};
use crate::deformation::matrix;
use crate::number::exact;
use crate::program::lerp;
use crate::program::{
    Constraint, Control, FieldValues, Measure, PointDrive, PointGoal, PointProgram, PointStep, Program,
};
use crate::program::{STRAIN_NAMES, STRESS_NAMES, TURNED, gradient_needs_thickness, nominal_needs_thickness};
use nalgebra::Matrix3;
use std::io;
use umat_abi::host::{
    CallOutcome, Clock, Derived, ExternalDatabases, FOLLOWS_GRADIENT, Heat, InitialPoint, InitialStates,
    InitialStresses, NotFinite, TangentSource, Trespass, UmatCall, judge,
};
use umat_abi::law::{Request, StressState};

/// A sought strain that moves on continuously changes less in half of an increment, and by the same factor from half to half; a
/// jump does not: the largest factor, its tolerance, and how often it must come again.
const FALLING: f64 = 0.95;
const STEADY: f64 = 0.05;
const AGAIN: u32 = 2;
/// Strains that were sought and have grown large are taken back for a trial: torn matter comes back with less than this part of the
/// largest stress of the step. A stiffness that is a secant leaves a quarter of it at most.
const RESISTANCE: f64 = 0.35;
/// Torn matter also has less than this part of the stiffness that it began with, where a small share of those strains is taken back.
const STIFFNESS: f64 = 0.05;
const SMALL_SHARE: f64 = 1e-4;
/// The share of the last increment that is taken back to see how the matter unloads.
const A_LITTLE_BACK: f64 = 1e-3;
/// The part of the time increment that such a trial takes.
const INSTANT: f64 = 1e-3;
/// Growth of such strains until they are tried again.
const GROWN: f64 = 1.5;
/// Largest rounding error of a stress that does not respond, as a part of DDSDDE times the strain.
const ROUNDING: f64 = 1e-9;

const INVERTED: &str = "the deformation gradient inverts the volume (det F <= 0)";

/// Runs a point program.
pub(super) fn run(
    program: &Program,
    point: &PointProgram,
    databases: &mut ExternalDatabases,
    observer: &mut dyn Observer,
    statistics: &mut Statistics,
) -> Result<(), Stop> {
    let (mut runner, reason) = Runner::new(program, point, databases).map_err(Stop::unusable)?;
    let mut recorder = Recorder::new(program, observer);
    if let Some(reason) = reason {
        recorder.observer.warn(format!("{} is called with NTENS = 6: {reason}", program.plugin.name));
    }
    if let Ok(Some(doubt)) = program.plugin.doubt_of_plane(&mut runner.call) {
        recorder.observer.warn(format!("{}: {doubt}", program.plugin.name));
    }
    match runner.initial_stress_found() {
        Ok(None) => {}
        Ok(Some(changed)) => recorder.observer.warn(format!("{} {changed}", program.plugin.name)),
        Err(dropped) => {
            return Err(Stop::unusable(format!("$.initial.stress: {} {dropped}", program.plugin.name)));
        }
    }
    let is_untold = runner.plane_stress && program.plugin.law.is_none() && !runner.call.is_through_solid();
    if is_untold && point.nlgeom && point.measure == Measure::Nominal {
        return Err(Stop::unusable(format!("$.measure: {}", nominal_needs_thickness(&program.plugin.name))));
    }
    if is_untold && runner.finite.is_some() {
        recorder.observer.warn(gradient_needs_thickness(&program.plugin.name));
    } else if is_untold {
        recorder.observer.warn(format!(
            "the column e33 is NaN: in plane stress UMAT does not get the strain 33, and the library of '{}' names no state variable that holds it (\"as\": \"3d\" finds it)",
            program.plugin.name
        ));
    }
    recorder.initial(|values| runner.fill(values))?;
    let result = take_steps(&mut runner, &point.steps, program, &mut recorder, statistics);
    if let Some(result) = runner.moduli_not_finite {
        recorder.observer.warn(format!(
            "{}: it returned {result}; where the tangent was needed, differences of the stress took its place",
            program.plugin.name
        ));
    }
    if let Some(share) = runner.coarseness_of_tolerance() {
        recorder.observer.warn(format!(
            "stresses that the case sets are met to {STRESS_TOLERANCE:e} MPa, {share:.1e} of the stiffness times the largest strain: \
             enter moduli and stresses in a smaller unit"
        ));
    }
    if runner.depends_on_length == Some(true) {
        recorder.observer.warn(format!("{}: {}", program.plugin.name, depends_on_length("CELENT")));
    }
    if let Some(names) = runner.names_of_unknown() {
        recorder.observer.warn(format!(
            "{} does not compute {names} (their rows and columns of DDSDDE are 0): pullout left those strains unchanged; use mode 1d or beam for a law with one or two components",
            program.plugin.name
        ));
    }
    if let Some(deviation) = runner.call.take_largest_deviation() {
        recorder.observer.warn(format!("{}: {deviation}", program.plugin.name));
    }
    result
}

/// Finds the components that the UMAT of a program is called with, and why these are six in a plane whose case does not ask
/// for them.
///
/// # Errors
/// The UMAT cannot be called at all.
pub fn components_of_calls(
    program: &Program,
    point: &PointProgram,
    databases: &mut ExternalDatabases,
) -> Result<(StressState, Option<String>), String> {
    let (runner, reason) = Runner::new(program, point, databases)?;
    let called = runner.call.solid().unwrap_or(&runner.call);
    Ok((called.stress_state(), reason))
}

/// The state of the point between increments.
#[derive(Clone, Debug)]
pub struct Committed {
    /// STRAN, six components.
    pub strain: [f64; 6],
    /// STRESS, six components, MPa.
    pub stress: [f64; 6],
    /// STATEV.
    pub statev: Vec<f64>,
    /// SSE, SPD, SCD.
    pub energies: [f64; 3],
    /// RPL and its like, in six components.
    pub heat: Heat,
    /// TIME(1), s.
    pub step_time: f64,
    /// TIME(2), s.
    pub total_time: f64,
    /// F.
    pub deformation_gradient: Matrix3<f64>,
    /// TEMP and PREDEF.
    pub fields: FieldValues,
}

/// Goal of the current increment.
#[derive(Clone, Debug)]
pub(super) struct PointIncrementGoal {
    /// Values at the start of the increment, by component (of the controlled quantity).
    start: [f64; 6],
    /// Controls with the values at the end of the increment.
    pub(super) controls: [Control; 6],
    /// Left sides of the relations at the start of the increment.
    relations_at_start: Vec<f64>,
    /// Relations with the right sides at the end of the increment.
    pub(super) relations: Vec<Constraint>,
    /// Step time at the start and at the end of the increment.
    pub(super) step_time: (f64, f64),
    pub(super) deformation_gradient: Option<(Matrix3<f64>, Matrix3<f64>)>,
    /// Temperature and field variables at the start and at the end of the increment.
    pub(super) fields: [FieldValues; 2],
}

impl PointIncrementGoal {
    /// Returns whether any component is not given by its strain.
    fn controls_stress(&self, components: &[usize]) -> bool {
        components.iter().any(|&i| !matches!(self.controls[i], Control::Strain(_)))
    }
}

struct Runner<'p> {
    components: &'static [usize],
    /// Groups of columns that the history has not.
    left_out: &'static [Group],
    /// Whether the history has heat and its derivatives.
    shows_heat: bool,
    controllable: &'static [usize],
    /// `None`: small strain.
    finite: Option<Finite>,
    arguments: &'p UmatArguments,
    plane_stress: bool,
    /// State variable that holds ε33, if the law has one.
    strain_33: Option<usize>,
    max_iterations: u32,
    derived: &'p [Derived],
    /// Whether no metadata vouch for the plugin.
    is_plain: bool,
    databases: &'p mut ExternalDatabases,
    call: UmatCall,
    committed: Committed,
    /// The largest component of stress at the end of any increment so far.
    largest_stress: f64,
    /// The same since the start of the step.
    largest_stress_of_step: f64,
    /// Change of the strains in the last increment that changed any.
    last_increment: [f64; 6],
    /// Tangent at the last committed state, for the first guess.
    tangent: Option<[[f64; 6]; 6]>,
    plan: Plan,
    goal: PointIncrementGoal,
    trial: Trial,
    /// Whether nothing has been attempted yet.
    is_first_attempt: bool,
    /// First entry of DDSDDE that was not finite where an equilibrium was found all the same.
    moduli_not_finite: Option<NotFinite>,
    /// Whether the law's answer depends on CELENT, which the case does not give; `None`: it does.
    depends_on_length: Option<bool>,
    /// Whether it is known that the stress follows the strains.
    follows_strain: bool,
    /// The largest modulus of the first tangent.
    stiffness: Option<f64>,
    /// The largest component of the case's strain at the end of any increment so far.
    largest_strain: f64,
    /// Components that the law has known nothing of whenever they were sought, once any was.
    unknown: Option<[bool; 6]>,
    /// Change of the sought strains in the step at which the matter was last tried for being torn.
    tried_change: f64,
    /// Attempts from the committed state that were refused as jumps.
    refused: Refused,
}

/// The largest changes of a strain in attempts that were refused as jumps, each for half of the increment of the one before.
#[derive(Clone, Copy, Debug, Default)]
struct Refused {
    change: Option<f64>,
    factor: Option<f64>,
    steady: u32,
}

impl Refused {
    fn push(&mut self, change: f64) {
        let factor = self.change.map(|last| change / last);
        let is_steady = |(factor, last): (f64, f64)| factor < FALLING && (factor - last).abs() <= STEADY * last;
        self.steady = if factor.zip(self.factor).is_some_and(is_steady) { self.steady + 1 } else { 0 };
        (self.change, self.factor) = (Some(change), factor);
    }

    /// Returns whether the change falls with the increment, as that of a continuous solution does.
    fn falls_steadily(&self) -> bool {
        self.steady >= AGAIN
    }
}

/// The end of the last attempt.
#[derive(Clone, Debug)]
struct Trial {
    strain: [f64; 6],
    tangent: Option<[[f64; 6]; 6]>,
    /// First entry of DDSDDE in its iterations that was not finite.
    moduli_not_finite: Option<NotFinite>,
    step_time: f64,
    total_time: f64,
    fields: FieldValues,
}

impl<'p> Runner<'p> {
    /// Makes a point at its initial state; also returns why its calls go through six components, if the UMAT needs
    /// them.
    fn new(
        program: &'p Program,
        point: &'p PointProgram,
        databases: &'p mut ExternalDatabases,
    ) -> Result<(Self, Option<String>), String> {
        let plugin = &program.plugin;
        let stress_state = point.mode.stress_state();
        let mut call = plugin.umat(stress_state).map_err(|error| error.to_string())?;
        if let Some(length) = program.characteristic_length {
            call.celent = length;
        }
        call.jstep[2] = i32::from(point.nlgeom);
        (call.temp, call.time[1]) = (point.initial.fields.temperature, point.initial.time);
        point.arguments.set(&mut call);
        let initial = &point.initial;
        let variables = &initial.fields.variables;
        if !variables.is_empty() {
            call.predef.clone_from(variables);
            call.dpred = vec![0.0; variables.len()];
        }
        let plane_stress = stress_state.components().len() == 3;
        let strain_33 = plugin.strain_33();
        let committed = Committed {
            strain: initial.strain,
            stress: initial_stress(program, point, &call)?,
            statev: InitialStates::new(&plugin.library, initial.statev.as_deref(), plugin.nstatv)
                .of_point(&initial_point(&call))?,
            energies: point.arguments.energies.unwrap_or_default(),
            heat: Heat::default(),
            step_time: 0.0,
            total_time: initial.time,
            deformation_gradient: matrix(&initial.deformation_gradient),
            fields: initial.fields.clone(),
        };
        let Committed { strain, stress, statev, .. } = &committed;
        call.set_point([strain, &[0.0; 6], stress], statev, [0.0; 3]);
        let reason = plugin.probe(&mut call).map_err(|error| error.to_string())?;
        if point.heat {
            call.generate_heat();
        }
        let free = call.free_strain_33(initial.fields.temperature, initial.time);
        let thickness = thickness_at(&call, committed.strain[2], strain_33, &committed.statev, free);
        let finite = point.nlgeom.then(|| Finite::new(point, plugin, &committed, thickness));
        let goal = PointIncrementGoal {
            start: [0.0; 6],
            controls: [Control::FREE; 6],
            relations_at_start: Vec::new(),
            relations: Vec::new(),
            step_time: (0.0, 0.0),
            deformation_gradient: None,
            fields: [initial.fields.clone(), initial.fields.clone()],
        };
        let runner = Self {
            components: stress_state.components(),
            left_out: columns::left_out_of_point(point.nlgeom, point.heat),
            shows_heat: point.heat,
            controllable: point.mode.controllable(),
            finite,
            arguments: &point.arguments,
            plane_stress,
            strain_33,
            max_iterations: program.controls.max_iterations,
            is_plain: plugin.law.is_none(),
            derived: plugin.law.as_ref().map_or(&[], |law| &law.derived),
            databases,
            call,
            trial: Trial {
                strain: committed.strain,
                tangent: None,
                moduli_not_finite: None,
                step_time: 0.0,
                total_time: initial.time,
                fields: initial.fields.clone(),
            },
            largest_stress: committed.stress.iter().fold(0.0, |largest, s| s.abs().max(largest)),
            largest_stress_of_step: 0.0,
            committed,
            last_increment: [0.0; 6],
            tangent: None,
            plan: Plan { time: initial.time, ..Plan::default() },
            goal,
            is_first_attempt: true,
            depends_on_length: program.characteristic_length.is_none().then_some(false),
            moduli_not_finite: None,
            refused: Refused::default(),
            tried_change: 0.0,
            unknown: None,
            stiffness: None,
            largest_strain: 0.0,
            follows_strain: plugin.law.is_some() || point.nlgeom || point.arguments.dfgrd1.is_some(),
        };
        Ok((runner, reason))
    }

    /// Returns the tolerance of stresses relative to the first stiffness times the largest strain, if the run solved for stresses
    /// and that is not small.
    fn coarseness_of_tolerance(&self) -> Option<f64> {
        const SMALL: f64 = 1e-4;
        let share = STRESS_TOLERANCE / (self.stiffness? * self.largest_strain);
        (share.is_finite() && share > SMALL).then_some(share)
    }

    /// Judges what the law makes of the stress that it begins with: a note, or why it cannot begin.
    fn initial_stress_found(&mut self) -> Result<Option<String>, String> {
        // a call whose arguments the case gives one by one is made once
        if self.committed.stress == [0.0; 6] || *self.arguments != UmatArguments::default() {
            return Ok(None);
        }
        self.prepare_call(0.0, 1.0);
        self.databases.increment_starts(clock(&self.call, self.call.time));
        let Committed { strain, stress, statev, energies, deformation_gradient, .. } = &self.committed;
        if let Some(finite) = &mut self.finite
            && finite.deform(&self.committed, deformation_gradient, &mut self.call).is_none()
        {
            return Ok(None);
        }
        self.call.set_point([strain, &[0.0; 6], stress], statev, *energies);
        let answer = self.call.call(Request::Stress);
        let answers = matches!(answer, Ok(CallOutcome::Done)) && self.call.not_finite().is_none();
        let judged = if answers { self.call.judge_initial_stress(stress) } else { Ok(None) };
        self.call.set_point([strain, &[0.0; 6], stress], statev, *energies);
        judged
    }

    /// ε33 of plane stress, ln F₃₃ at finite strain, at the committed state.
    fn thickness(&self) -> f64 {
        let Committed { strain, statev, fields, total_time, .. } = &self.committed;
        let free = self.call.free_strain_33(fields.temperature, *total_time);
        thickness_at(&self.call, strain[2], self.strain_33, statev, free)
    }

    /// Replaces the tangent for the first guess by that of a zero increment, where nothing grows, or by that of unloading where this
    /// leads back.
    ///
    /// Below the peak of a softening law two strains have the same lower stress: further along the softening branch
    /// and back along the unloading branch. A step that asks for a lower stress means the latter; the tangent of the
    /// last loading increment would lead to the former. So would that of a zero increment of a law that ends its increments on the surface
    /// and counts what is on it as loading; therefore the law is asked a little way back, too.
    fn unloading_tangent(&mut self, statistics: &mut Statistics) {
        self.tangent = None;
        if self.goal.deformation_gradient.is_some() || !self.goal.controls_stress(self.components) {
            return;
        }
        self.prepare_call(0.0, 1.0);
        self.databases.increment_starts(clock(&self.call, self.call.time));
        let last = self.last_increment;
        if last != [0.0; 6] {
            self.tangent = self.tangent_after(&last.map(|strain| -A_LITTLE_BACK * strain), statistics);
            let (_, guess) = self.first_increment(1.0, &mut Vec::new());
            let leads_back = guess.iter().zip(&last).map(|(a, b)| a * b).sum::<f64>() < 0.0;
            if self.tangent.is_some() && leads_back {
                return;
            }
        }
        self.tangent = self.tangent_after(&[0.0; 6], statistics);
    }

    /// The tangent after an increment from the committed state; `None` if there is none of numbers.
    fn tangent_after(&mut self, increment: &[f64; 6], statistics: &mut Statistics) -> Option<[[f64; 6]; 6]> {
        let strain = *self.strain();
        let end = || std::array::from_fn(|i| strain[i] + increment[i]);
        let evaluation = self.point(statistics).evaluate(increment, end, Request::StressAndTangent).ok()?;
        evaluation.tangent.as_flattened().iter().all(|x| x.is_finite()).then_some(evaluation.tangent)
    }

    /// Left side of a relation at the committed state.
    fn relation(&self, relation: &Constraint) -> f64 {
        self.components
            .iter()
            .map(|&i| relation.strain[i] * self.strain()[i] + relation.stress[i] * self.stress()[i])
            .sum()
    }

    /// The case's strain.
    fn strain(&self) -> &[f64; 6] {
        self.finite.as_ref().map_or(&self.committed.strain, |finite| &finite.strain)
    }

    /// The case's stress.
    fn stress(&self) -> &[f64; 6] {
        self.finite.as_ref().map_or(&self.committed.stress, |finite| &finite.stress)
    }

    /// Controls and relations at a fraction of the increment.
    fn targets_at(&self, fraction: f64, relations: &mut Vec<Constraint>) -> [Control; 6] {
        let mut controls = self.goal.controls;
        for (control, &start) in controls.iter_mut().zip(&self.goal.start) {
            match control {
                Control::Strain(end) | Control::Stress(end) => *end = lerp(start, *end, fraction),
                _ => {}
            }
        }
        relations.clone_from(&self.goal.relations);
        for (relation, &start) in relations.iter_mut().zip(&self.goal.relations_at_start) {
            relation.equals = lerp(start, relation.equals, fraction);
        }
        controls
    }

    /// Sets what does not change during the iterations of an attempt.
    fn prepare_call(&mut self, from: f64, to: f64) {
        let (plan, goal) = (&self.plan, &self.goal);
        let call = &mut self.call;
        let at = |fraction| lerp(goal.step_time.0, goal.step_time.1, fraction);
        call.time = [self.arguments.start() + at(from), plan.time + at(from)];
        call.dtime = at(to) - at(from);
        let [start, end] = &goal.fields;
        call.temp = lerp(start.temperature, end.temperature, from);
        let variables = call.predef.iter_mut().zip(&mut call.dpred);
        for ((value, increment), (start, end)) in variables.zip(start.variables.iter().zip(&end.variables)) {
            *value = lerp(*start, *end, from);
            *increment = lerp(*start, *end, to) - *value;
        }
        self.trial.fields.set_between(start, end, to);
        call.dtemp = self.trial.fields.temperature - call.temp;
        self.trial.step_time = at(to);
        self.trial.total_time = plan.time + at(to);
    }

    /// The point that the plugin is called at.
    fn point<'r>(&'r mut self, statistics: &'r mut Statistics) -> Point<'r> {
        Point {
            call: &mut self.call,
            committed: &self.committed,
            finite: self.finite.as_mut(),
            strain_33: self.strain_33,
            components: self.components,
            statistics,
        }
    }

    /// Replaces the increments of the first call by those in the case, which carry no rounding error.
    fn hand_over(&mut self) {
        let UmatArguments { dtime, dtemp, dpred, .. } = self.arguments;
        self.call.dtime = dtime.unwrap_or(self.call.dtime);
        self.call.dtemp = dtemp.unwrap_or(self.call.dtemp);
        if let Some(dpred) = dpred {
            self.call.dpred.clone_from(dpred);
        }
    }

    /// Returns what the increment must satisfy at a fraction of it, and the strain increment that an attempt begins with.
    fn first_increment<'r>(&self, to: f64, relations: &'r mut Vec<Constraint>) -> (Targets<'r>, [f64; 6]) {
        let controls = self.targets_at(to, relations);
        let (components, largest_stress, measure) = (self.components, self.largest_stress, self.plan.measure);
        let targets =
            Targets { components, controls, constraints: relations, strain: *self.strain(), largest_stress, measure };
        let mut increment = [0.0; 6];
        for &i in self.components {
            if let Control::Strain(end) = controls[i] {
                increment[i] = end - targets.strain[i];
            }
        }
        if !targets.strain_only()
            && let Some(tangent) = &self.tangent
        {
            targets.first_guess(&mut increment, self.stress(), tangent);
        }
        (targets, increment)
    }

    /// F at a fraction of the increment.
    fn gradient_at(&self, to: f64) -> Option<Matrix3<f64>> {
        let (start, end) = self.goal.deformation_gradient?;
        Some(if to == 1.0 { end } else { start + (end - start) * to })
    }

    /// What a call is asked for where strains are given: DDSDDE as well if it is compared, or if DDSDDT of what expands is shown.
    fn request(&self) -> Request {
        let compares = self.call.tangent_source() == TangentSource::Compared;
        let expands = self.call.frame().is_some_and(|frame| frame.expansion.is_some());
        if compares || (self.shows_heat && expands) { Request::StressAndTangent } else { Request::Stress }
    }

    /// Goes to F at a fraction of the increment.
    fn attempt_deformation(&mut self, to: f64, statistics: &mut Statistics) -> Result<u32, AttemptFailure> {
        let Some(end) = self.gradient_at(to) else { return Ok(0) };
        let request = self.request();
        let mut point = self.point(statistics);
        let Some(finite) = point.finite.as_mut() else { return Ok(0) };
        let strain = finite.strain_of_case(&end);
        let entry =
            finite.deform(point.committed, &end, point.call).ok_or_else(|| AttemptFailure::Fatal(INVERTED.into()))?;
        point.call(&entry.strain, &entry.stress, &entry.increment, request)?;
        self.trial.strain = strain;
        self.trial.tangent = None;
        statistics.iterations += 1;
        Ok(1)
    }
}

/// Returns ε33 of plane stress: `found` where calls go through six components, else the law's value in STATEV plus the
/// `free` part that the law does not see; NaN if the law has no such value.
fn thickness_at(call: &UmatCall, found: f64, state: Option<usize>, statev: &[f64], free: f64) -> f64 {
    if call.is_through_solid() { found } else { state.map_or(f64::NAN, |k| statev[k] + free) }
}

/// Returns the point of a call as SDVINI and SIGINI receive it.
fn initial_point(call: &UmatCall) -> InitialPoint {
    InitialPoint { coordinates: call.coords, element: call.noel, point: call.npt }
}

/// Stress at the start: the case's, or SIGINI's, or none.
fn initial_stress(program: &Program, point: &PointProgram, call: &UmatCall) -> Result<[f64; 6], String> {
    let components = call.stress_state().components();
    let given = point.initial.stress.as_ref().map(|stress| components.iter().map(|&i| stress[i]).collect::<Vec<_>>());
    let mut values = InitialStresses::new(&program.plugin.library, given.as_deref(), components.len())
        .of_point(&initial_point(call), point.mode.element_type())?;
    if let (None, Some(frame)) = (&given, call.frame()) {
        // SIGINI speaks of the local axes
        frame.stress_outside(&mut values, call.stress_state());
    }
    Ok(call.stress_state().six(&values))
}

/// Returns the clock that UEXTERNALDB receives for the increment of a call.
fn clock(call: &UmatCall, time: [f64; 2]) -> Clock {
    Clock { time, time_increment: call.dtime, step: call.jstep[0], increment: call.kinc }
}

/// Calls the plugin from the committed state.
struct Point<'r> {
    call: &'r mut UmatCall,
    committed: &'r Committed,
    finite: Option<&'r mut Finite>,
    strain_33: Option<usize>,
    components: &'static [usize],
    statistics: &'r mut Statistics,
}

impl Point<'_> {
    /// Computes stress and tangent of the case after an increment of its strain, or at its `end`.
    #[inline]
    fn evaluate(
        &mut self,
        increment: &[f64; 6],
        end: impl FnOnce() -> [f64; 6],
        request: Request,
    ) -> Result<Evaluation, AttemptFailure> {
        let Some(finite) = self.finite.as_mut() else {
            let Committed { strain, stress, .. } = self.committed;
            self.call(strain, stress, increment, request)?;
            return Ok(evaluation(self.call, self.components));
        };
        let end = end();
        let entry = finite
            .stretch(self.committed, &end, self.call)
            .ok_or_else(|| AttemptFailure::CutBack { fraction: 0.5, reason: INVERTED.into() })?;
        self.call(&entry.strain, &entry.stress, &entry.increment, request)?;
        let returned = evaluation(self.call, self.components);
        let Some(finite) = &self.finite else { return Ok(returned) };
        let free = self.call.free_strain_33_at_end();
        let thickness = thickness_at(self.call, self.call.strain_33, self.strain_33, self.call.statev(), free);
        Ok(finite.evaluation(&returned, &end, self.components, thickness))
    }

    /// One call.
    #[inline]
    fn call(
        &mut self,
        strain: &[f64; 6],
        stress: &[f64; 6],
        increment: &[f64; 6],
        request: Request,
    ) -> Result<(), AttemptFailure> {
        let call = &mut *self.call;
        call.set_point([strain, increment, stress], &self.committed.statev, self.committed.energies);
        self.statistics.plugin_calls += 1;
        let outcome = call.call(request);
        judge(outcome, call.not_finite())?;
        let generated = call.add_generated_heat().map(|()| CallOutcome::Done);
        Ok(judge(generated, call.heat_not_finite())?)
    }
}

/// The result of a call in six components.
#[inline]
fn evaluation(call: &UmatCall, components: &[usize]) -> Evaluation {
    let mut evaluation = Evaluation { stress: [0.0; 6], tangent: call.moduli() };
    components.iter().zip(call.stress()).for_each(|(&i, stress)| evaluation.stress[i] = *stress);
    evaluation
}

impl Divisible for Runner<'_> {
    type Goal = PointGoal;

    fn begin(&mut self, step: &PointStep, number: u32, program: &Program) -> Result<(), Stop> {
        self.committed.step_time = 0.0;
        if let Some(finite) = &self.finite
            && finite.measure == Measure::Logarithmic
            && finite.is_turned()
            && step.goal.mixes_strain_and_stress(self.controllable)
        {
            let message = format!("plugin '{}', step {number}: {TURNED}", program.plugin.name);
            return Err(Stop::Failed(RunFailure {
                step: number,
                increment: 1,
                message,
                replay: serde_json::Value::Null,
            }));
        }
        let controls = match &step.goal.drive {
            PointDrive::Components { controls, .. } => *controls,
            PointDrive::DeformationGradient(_) => [Control::FREE; 6],
        };
        let start = std::array::from_fn(|i| match controls[i] {
            _ if !self.controllable.contains(&i) => self.strain()[i],
            Control::Strain(_) | Control::HoldStrain => self.strain()[i],
            Control::Stress(_) | Control::HoldStress => self.stress()[i],
            Control::Constraint(_) => 0.0,
        });
        let relations: Vec<f64> = step.goal.constraints.iter().map(|relation| self.relation(relation)).collect();
        let mut constraints = step.goal.constraints.clone();
        for (constraint, start) in constraints.iter_mut().zip(&relations).filter(|(constraint, _)| constraint.hold) {
            constraint.equals = *start;
        }
        let Committed { total_time: time, deformation_gradient: gradient, ref fields, .. } = self.committed;
        let measure = self.measure(step, &start);
        self.tried_change = 0.0;
        self.largest_stress_of_step = self.stress().iter().fold(0.0, |largest, s| s.abs().max(largest));
        self.plan = Plan {
            start,
            strain: *self.strain(),
            measure,
            relations,
            constraints,
            time,
            gradient,
            fields: fields.clone(),
        };
        Ok(())
    }

    fn aim(&mut self, step: &PointStep, number: u32, index: usize) {
        if index == 0 {
            [self.call.jstep[0], self.call.kinc] = self.arguments.counters(number, 1);
        }
        let [before, after] = step.pace.shares(index);
        let controllable = self.controllable;
        let (strain, stress) = (*self.strain(), *self.stress());
        let (plan, goal) = (&self.plan, &mut self.goal);
        goal.step_time = step.pace.times(index, self.committed.step_time);
        goal.deformation_gradient = None;
        step.fields.set_increment(&plan.fields, &self.committed.fields, &step.pace, index, &mut goal.fields);
        goal.relations.clone_from(&plan.constraints);
        goal.relations_at_start.clear();
        for (relation, &start) in goal.relations.iter_mut().zip(&plan.relations) {
            goal.relations_at_start.push(lerp(start, relation.equals, before));
            relation.equals = lerp(start, relation.equals, after);
        }
        match &step.goal.drive {
            PointDrive::Components { controls, rows } => {
                let row = rows.get(index);
                for i in 0..6 {
                    let start = plan.start[i];
                    let end = |end: f64| row.map_or(lerp(start, end, after), |row| row[i]);
                    goal.controls[i] = match controls[i] {
                        _ if !controllable.contains(&i) => Control::Strain(start),
                        Control::Strain(value) => Control::Strain(end(value)),
                        Control::Stress(value) => Control::Stress(end(value)),
                        Control::HoldStrain => Control::Strain(start),
                        Control::HoldStress => Control::Stress(start),
                        relation @ Control::Constraint(_) => relation,
                    };
                    goal.start[i] = match controls[i] {
                        Control::Stress(_) | Control::HoldStress if row.is_some() && controllable.contains(&i) => {
                            stress[i]
                        }
                        _ if row.is_some() => strain[i],
                        Control::Strain(end) | Control::Stress(end) if controllable.contains(&i) => {
                            lerp(start, end, before)
                        }
                        _ => start,
                    };
                }
            }
            PointDrive::DeformationGradient(end) => {
                let end = matrix(end);
                let at = |share: f64| if share == 1.0 { end } else { plan.gradient + (end - plan.gradient) * share };
                goal.deformation_gradient = Some((at(before), at(after)));
            }
        }
    }

    fn report_start(&mut self, observer: &mut dyn Observer) -> io::Result<()> {
        self.prepare_call(0.0, 1.0);
        self.hand_over();
        observer.begins(Accepted::Umat(&self.committed, &self.call))
    }

    fn prepare_guess(&mut self, number: u32, statistics: &mut Statistics) {
        // the first call of a replay is not to depend on another before it
        if !(number == 1 && self.arguments.dstran.is_some()) {
            self.unloading_tangent(statistics);
        }
    }

    fn attempt(&mut self, from: f64, to: f64, statistics: &mut Statistics) -> Result<u32, AttemptFailure> {
        self.prepare_call(from, to);
        let is_first = std::mem::take(&mut self.is_first_attempt);
        if is_first {
            self.hand_over();
        }
        self.databases.increment_starts(clock(&self.call, self.call.time));
        if self.goal.deformation_gradient.is_some() {
            return self.attempt_deformation(to, statistics);
        }
        let mut relations = Vec::new();
        let (targets, mut increment) = self.first_increment(to, &mut relations);
        if is_first && let Some(dstran) = &self.arguments.dstran {
            self.components.iter().zip(dstran).for_each(|(&i, value)| increment[i] = *value);
        }
        let strain_only = targets.strain_only();
        let ddsdde = self.arguments.ddsdde == Some(true);
        let request = if ddsdde { Request::StressAndTangent } else { self.request() };
        let max_iterations = self.max_iterations;
        let mut point = self.point(statistics);
        let (mut last_tangent, mut moduli_not_finite) = (None, None);
        let solved = if strain_only {
            point.evaluate(&increment, || targets.end(&increment), request).map_err(Divergence::Evaluation).map(|_| 1)
        } else {
            targets.solve_increment(&mut increment, max_iterations, |increment| {
                let evaluation = point.evaluate(increment, || targets.end(increment), Request::StressAndTangent)?;
                last_tangent = Some(evaluation.tangent);
                moduli_not_finite = moduli_not_finite.or_else(|| point.call.moduli_not_finite());
                Ok(evaluation)
            })
        };
        self.trial.tangent = last_tangent;
        self.trial.moduli_not_finite = moduli_not_finite;
        let iterations = match solved {
            Ok(iterations) => iterations,
            Err(Divergence::Evaluation(trouble)) => return Err(trouble),
            Err(Divergence::NotConverged { residual }) => {
                return Err(AttemptFailure::CutBack { fraction: 0.5, reason: self.not_converged(&residual) });
            }
            Err(Divergence::Far { component, change, is_determined, iterations }) => {
                self.refused.push(change.abs());
                if !is_determined || !self.refused.falls_steadily() {
                    return Err(AttemptFailure::CutBack { fraction: 0.5, reason: far(component, change) });
                }
                iterations
            }
        };
        statistics.iterations += u64::from(iterations);
        if !self.follows_strain && self.follows_gradient_alone(&increment) {
            return Err(AttemptFailure::Fatal(FOLLOWS_GRADIENT.into()));
        }
        self.trial.strain = targets.end(&increment);
        if let Some(size) = targets.measure.filter(|_| !strain_only)
            && let (component, change) = targets.largest_change(&self.trial.strain, &self.plan.strain)
            && change.abs() > (LARGEST_CHANGE * size).max(GROWN * self.tried_change)
        {
            if !self.resists(&targets.controls, statistics) {
                return Err(AttemptFailure::CutBack { fraction: 0.5, reason: torn(component, change) });
            }
            self.tried_change = change.abs();
        }
        if let Some(tangent) = last_tangent
            && self.stiffness.is_none()
        {
            self.stiffness = Some((0..6).fold(0.0, |most, i| tangent[i][i].abs().max(most)));
        }
        if let Some(tangent) = last_tangent
            && self.unknown != Some([false; 6])
        {
            let so_far = self.unknown.unwrap_or([true; 6]);
            let components = self.components;
            self.unknown = Some(std::array::from_fn(|i| {
                let is_sought =
                    so_far[i] && matches!(targets.controls[i], Control::Stress(_)) && components.contains(&i);
                is_sought && is_unknown(components, i, &tangent)
            }));
        }
        Ok(iterations)
    }

    fn look_again(&mut self, from: f64, statistics: &mut Statistics) -> Option<String> {
        match self.call.not_finite() {
            Some(result) => self.trespass().map(|trespass| format!("it returned {result}; it {trespass}")),
            None if self.goal.deformation_gradient.is_some() => None,
            None => self.blame_tangent(from, statistics),
        }
    }

    fn look_outside(&mut self) -> Option<String> {
        if !self.is_plain {
            return None;
        }
        let Committed { stress, statev, energies, .. } = &self.committed;
        let stress: Vec<f64> = self.components.iter().map(|&i| stress[i]).collect();
        let is_length_open = self.depends_on_length == Some(false);
        let call = &mut self.call;
        let dependence = Dependence::find(|| {
            call.leave_record();
            let (strain, increment, strain_33) = (call.stran, call.dstran, self.committed.strain[2]);
            let ntens = stress.len();
            let prepare = |call: &mut UmatCall| {
                call.set_point([&strain[..ntens], &increment[..ntens], &stress], statev, *energies);
                call.strain_33 = strain_33;
            };
            [call.depends_on_surroundings(prepare), is_length_open && call.depends_on_length(prepare)]
        });
        if dependence.on_length {
            self.depends_on_length = Some(true);
        }
        if !dependence.on_surroundings {
            return None;
        }
        // where nothing is found, the answer stays
        let trespass = aside(&mut self.call, |call| trespass(call, &self.committed, self.components))?;
        Some(format!("it {trespass}, and its answer depends on it"))
    }

    fn commit(&mut self, observer: &mut dyn Observer) {
        observer.accepted(Accepted::Umat(&self.committed, &self.call));
        let before = *self.strain();
        let state = &mut self.committed;
        take_over(&self.call, self.components, &self.trial.strain, self.strain_33, state, self.finite.as_mut());
        let moved: [f64; 6] = std::array::from_fn(|i| self.trial.strain[i] - before[i]);
        if moved != [0.0; 6] {
            self.last_increment = moved;
        }
        let largest = self.components.iter().fold(0.0_f64, |largest, &i| largest.max(state.stress[i].abs()));
        self.largest_stress = self.largest_stress.max(largest);
        self.largest_stress_of_step = self.largest_stress_of_step.max(largest);
        let strain = &self.trial.strain;
        self.largest_strain = self.components.iter().fold(self.largest_strain, |most, &i| most.max(strain[i].abs()));
        self.moduli_not_finite = self.moduli_not_finite.or(self.trial.moduli_not_finite);
        self.refused = Refused::default();
        state.step_time = self.trial.step_time;
        state.total_time = self.trial.total_time;
        state.fields.clone_from(&self.trial.fields);
        self.tangent = self.trial.tangent;
        self.databases.increment_ends(clock(&self.call, [self.trial.step_time, self.trial.total_time]));
        // to the law a piece of an increment is one: no two have the same number
        self.call.kinc = self.call.kinc.saturating_add(1);
    }

    fn fill(&self, values: &mut [f64]) {
        let state = &self.committed;
        let mut strain = *self.strain();
        if self.plane_stress {
            let thickness = self.thickness();
            strain[2] = self.finite.as_ref().map_or(thickness, |finite| finite.strain_33(thickness));
        }
        if !self.components.contains(&1) {
            // no law returns the strains across
            [strain[1], strain[2]] = [f64::NAN; 2];
        }
        let gradient = self.finite.as_ref().map(|finite| finite.gradient(state, self.thickness())).unwrap_or_default();
        let row = PointRow {
            time: state.total_time,
            strain,
            stress: *self.stress(),
            gradient: std::array::from_fn(|i| std::array::from_fn(|j| gradient[(i, j)])),
            energies: state.energies,
            heat: state.heat,
        };
        let derived = self.derived.iter().map(|derived| derived.value(&state.statev));
        columns::fill(POINT, self.left_out, &row, state.statev.iter().copied().chain(derived), values);
    }

    fn replay(&self, program: &Program, to: f64) -> serde_json::Value {
        let mut goal = self.goal.clone();
        let (targets, increment) = self.first_increment(to, &mut goal.relations);
        goal.controls = targets.controls;
        goal.step_time.1 = lerp(goal.step_time.0, goal.step_time.1, to);
        let [start, end] = &self.goal.fields;
        goal.fields[1].set_between(start, end, to);
        let strain_only = targets.strain_only();
        let state = &self.committed;
        goal.deformation_gradient = match (self.gradient_at(to), &self.finite) {
            (None, Some(finite)) if strain_only => finite.end_of(state, &targets.end(&increment)),
            (end, _) => end,
        }
        .map(|end| (state.deformation_gradient, end));
        let is_found = self.finite.is_none() && !strain_only;
        let guess = is_found.then(|| self.components.iter().map(|&i| increment[i]).collect());
        replay::point(program, state, &goal, &self.call, guess)
    }
}

impl Runner<'_> {
    /// Returns the measure of the strains that a step seeks ([`Targets::measure`]); `start`: controlled quantities. Relations
    /// and fields drive strains of any size, and so do stresses that grow.
    fn measure(&self, step: &PointStep, start: &[f64; 6]) -> Option<f64> {
        let PointDrive::Components { controls, rows } = &step.goal.drive else { return None };
        let mut size = self.strain().iter().fold(0.0_f64, |largest, e| largest.max(e.abs()));
        for &i in self.controllable {
            let ends = |end: f64| rows.iter().map(|row| row[i]).chain(rows.is_empty().then_some(end)).map(f64::abs);
            match controls[i] {
                Control::Strain(end) => size = ends(end).fold(size, f64::max),
                Control::Stress(end) if ends(end).any(|end| end > start[i].abs() + STRESS_TOLERANCE) => return None,
                _ => {}
            }
        }
        let drives_more = !step.goal.constraints.is_empty() || step.fields != crate::program::StepFields::default();
        (size > 0.0 && !drives_more).then_some(size)
    }

    /// Returns whether the stress of the last call, which `increment` has not changed, follows DFGRD1. That is found out once.
    fn follows_gradient_alone(&mut self, increment: &[f64; 6]) -> bool {
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |most, value| most.max(value.abs()));
        let strain = largest(&mut increment.iter().copied());
        if strain == 0.0 {
            return false;
        }
        self.follows_strain = true;
        let start: Vec<f64> = self.components.iter().map(|&i| self.committed.stress[i]).collect();
        let change = largest(&mut self.call.stress().iter().zip(&start).map(|(end, start)| end - start));
        if change > ROUNDING * largest(&mut self.call.ddsdde().iter().copied()) * strain {
            return false;
        }
        aside(&mut self.call, |call| {
            let (strain, increment) = (call.stran, call.dstran);
            let [strain, increment] = [&strain[..start.len()], &increment[..start.len()]];
            call.set_point([strain, increment, &start], &self.committed.statev, self.committed.energies);
            call.follows_gradient_alone()
        })
    }

    /// Returns whether the matter at the end of the last call resists.
    ///
    /// The sought strains of the step are taken back at once. Resisting matter then reaches stresses such as it has
    /// carried in the step, and the way back begins with some stiffness. What is elastic returns to these stresses;
    /// what creeps, flows or swells is pressed the other way; what is torn returns with little.
    fn resists(&mut self, controls: &[Control; 6], statistics: &mut Statistics) -> bool {
        let (mut end, mut finite) = (self.committed.clone(), self.finite.clone());
        take_over(&self.call, self.components, &self.trial.strain, self.strain_33, &mut end, finite.as_mut());
        let (strain, stress) = (self.trial.strain, finite.as_ref().map_or(end.stress, |finite| finite.stress));
        let mut back = [0.0; 6];
        for &i in self.components.iter().filter(|&&i| !matches!(controls[i], Control::Strain(_))) {
            back[i] = self.plan.strain[i] - strain[i];
        }
        let (components, strain_33) = (self.components, self.strain_33);
        let largest = |values: &[f64; 6]| components.iter().fold(0.0_f64, |most, &i| most.max(values[i].abs()));
        // at once, so that nothing relaxes; each time nothing moves then, so that no resistance of a rate counts
        let none = [0.0; 6];
        let a_little = back.map(|strain| SMALL_SHARE * strain);
        let rest = std::array::from_fn(|i| back[i] - a_little[i]);
        let mut here = strain;
        let mut stresses = [[0.0; 6]; 5];
        let result: Result<(), AttemptFailure> = aside(&mut self.call, |call| {
            call.dtime *= INSTANT;
            for (by, stress) in [none, a_little, none, rest, none].iter().zip(&mut stresses) {
                here = std::array::from_fn(|i| here[i] + by[i]);
                let (committed, finite_now) = (&end, finite.as_mut());
                let mut point =
                    Point { call, committed, finite: finite_now, strain_33, components, statistics: &mut *statistics };
                *stress = point.evaluate(by, || here, Request::Stress)?.stress;
                take_over(call, components, &here, strain_33, &mut end, finite.as_mut());
            }
            Ok(())
        });
        if result.is_err() {
            return true;
        }
        let [before, _, after, _, answer] = stresses;
        let unloading = std::array::from_fn(|i| after[i] - before[i]);
        let is_soft = largest(&unloading) < STIFFNESS * self.stiffness.unwrap_or_default() * largest(&a_little);
        let borne = self.largest_stress_of_step.max(largest(&stress));
        borne <= STRESS_TOLERANCE * self.largest_stress.max(1.0) || (!is_soft && largest(&answer) >= RESISTANCE * borne)
    }

    /// Makes the last call of a plugin that nobody vouches for again, to see whether it leaves its arrays.
    fn trespass(&mut self) -> Option<Trespass> {
        if self.is_plain { trespass(&mut self.call, &self.committed, self.components) } else { None }
    }

    /// Tries the rest of an increment, or a part of it, with differences in place of the plugin's tangent; if these lead to an
    /// equilibrium, returns what is wrong with the plugin's. The parts are larger than those that were tried in vain.
    fn blame_tangent(&mut self, from: f64, statistics: &mut Statistics) -> Option<String> {
        const RIGHT: f64 = 1e-3;
        const HALVINGS: i32 = 5;
        const ADVICE: &str = "\"tangent\": \"numerical\" finds an equilibrium";
        let source = self.call.tangent_source();
        if source == TangentSource::Numerical || !self.goal.controls_stress(self.components) {
            return None;
        }
        let not_finite = self.trial.moduli_not_finite;
        self.call.set_tangent_source(TangentSource::Numerical);
        // what the first guess is made of is the plugin's as well
        let last = self.tangent;
        self.unloading_tangent(statistics);
        let is_found =
            (0..HALVINGS).any(|k| self.attempt(from, from + (1.0 - from) * 0.5_f64.powi(k), statistics).is_ok());
        self.tangent = last;
        self.call.set_tangent_source(TangentSource::Compared);
        let mut compare = || {
            let end = self.trial.strain;
            let strain = *self.strain();
            let increment = std::array::from_fn(|i| end[i] - strain[i]);
            self.point(statistics).evaluate(&increment, || end, Request::StressAndTangent).ok()?;
            self.call.largest_deviation()
        };
        let deviation = if is_found && not_finite.is_none() { compare() } else { None };
        self.call.set_tangent_source(source);
        let found = match (not_finite, deviation) {
            (Some(result), _) if is_found => format!("it returned {result}"),
            (Some(result), _) => return Some(format!("no equilibrium found: it returned {result}")),
            (None, Some(deviation)) if deviation.deviation > RIGHT => format!(
                "its tangent is wrong: it differs from differences of the stress by {:.1e} of its largest entry",
                deviation.deviation
            ),
            _ if is_found => "iterations with its tangent do not converge".to_owned(),
            _ => return None,
        };
        Some(format!("no equilibrium found: {found}; {ADVICE}"))
    }

    /// Names of the stresses that the law knows nothing of.
    fn names_of_unknown(&self) -> Option<String> {
        let unknown = self.unknown?;
        let names: Vec<&str> = self.components.iter().filter(|&&i| unknown[i]).map(|&i| STRESS_NAMES[i]).collect();
        (!names.is_empty()).then(|| names.join(", "))
    }

    /// Words for a residual that does not vanish.
    fn not_converged(&self, residual: &[f64; 6]) -> String {
        // a law that yields has answered before
        let no_answer = |i: usize, stress: f64| {
            residual[i].abs() > STRESS_TOLERANCE
                && stress == self.committed.stress[i]
                && self.unknown.is_none_or(|unknown| unknown[i])
                && self.trial.tangent.is_some_and(|tangent| is_unknown(self.components, i, &tangent))
        };
        let mut stresses = self.components.iter().zip(self.call.stress());
        if let Some((&i, _)) = stresses.find(|(i, stress)| no_answer(**i, **stress)) {
            return format!(
                "no equilibrium found: {stress} does not depend on the strain (its row and column of DDSDDE are 0) and misses its target by {:.3e} MPa: leave {stress} out",
                residual[i],
                stress = STRESS_NAMES[i]
            );
        }
        let worst = |i: &usize| residual[*i].abs();
        // a ramped stress is the culprit rather than the free components that it drags along; those may start as far
        // from their target as the last increment was allowed to leave them
        let ramped =
            |i: &usize| matches!(self.goal.controls[*i], Control::Stress(end) if is_far(self.goal.start[*i], end));
        let candidates: Vec<usize> = self.components.iter().copied().filter(ramped).collect();
        let by_residual = |a: &usize, b: &usize| worst(a).total_cmp(&worst(b));
        if let Some(i) = candidates.into_iter().max_by(by_residual) {
            let Control::Stress(end) = self.goal.controls[i] else { return String::new() };
            return format!(
                "no equilibrium found for {stress} = {end} MPa (reached {reached} MPa): stress control cannot pass a \
                 peak; control {strain} by strain instead",
                stress = STRESS_NAMES[i],
                end = exact(end),
                reached = exact(self.stress()[i]),
                strain = STRAIN_NAMES[i],
            );
        }
        match self.components.iter().copied().max_by(by_residual) {
            Some(i) => format!(
                "no equilibrium found: {} misses its target by {:.3e} MPa; control {} by strain, or use smaller increments",
                STRESS_NAMES[i], residual[i], STRAIN_NAMES[i]
            ),
            None => "no equilibrium found".into(),
        }
    }
}

/// Returns whether stresses differ by more than equilibrium leaves.
fn is_far(from: f64, to: f64) -> bool {
    (to - from).abs() > STRESS_TOLERANCE * to.abs().max(1.0)
}

/// Takes the end of the last call over as a state.
fn take_over(
    call: &UmatCall,
    components: &[usize],
    strain: &[f64; 6],
    strain_33: Option<usize>,
    state: &mut Committed,
    finite: Option<&mut Finite>,
) {
    components.iter().zip(call.stress()).for_each(|(&i, stress)| state.stress[i] = *stress);
    state.statev.copy_from_slice(call.statev());
    match finite {
        None => state.strain = *strain,
        Some(finite) => {
            let free = call.free_strain_33_at_end();
            let thickness = thickness_at(call, call.strain_33, strain_33, &state.statev, free);
            finite.commit(*strain, state, thickness);
        }
    }
    if call.is_through_solid() && call.stress_state() == StressState::PlaneStress {
        state.strain[2] = call.strain_33;
    }
    state.energies = call.energies;
    let Heat { rpl, ddsddt, drplde, drpldt } = call.heat();
    let [ddsddt, drplde] = [ddsddt, drplde].map(|values| call.stress_state().six(&values));
    state.heat = Heat { rpl, ddsddt, drplde, drpldt };
}

/// Makes other calls, and leaves arguments and results as they were, except for DDSDDE.
fn aside<T>(call: &mut UmatCall, work: impl FnOnce(&mut UmatCall) -> T) -> T {
    let (strain, increment, dtime) = (call.stran, call.dstran, call.dtime);
    let (stress, statev) = (call.stress().to_vec(), call.statev().to_vec());
    let (energies, heat, strain_33) = (call.energies, call.heat(), call.strain_33);
    let kinematics = (call.drot, call.dfgrd0, call.dfgrd1);
    let result = work(call);
    let ntens = stress.len();
    call.set_point([&strain[..ntens], &increment[..ntens], &stress], &statev, energies);
    call.set_heat(heat);
    call.strain_33 = strain_33;
    call.dtime = dtime;
    (call.drot, call.dfgrd0, call.dfgrd1) = kinematics;
    result
}

/// Makes a call from a committed state again, to see whether it leaves its arrays.
fn trespass(call: &mut UmatCall, committed: &Committed, components: &[usize]) -> Option<Trespass> {
    let Committed { stress, statev, energies, .. } = committed;
    let (strain, increment) = (call.stran, call.dstran);
    let stress: Vec<f64> = components.iter().map(|&i| stress[i]).collect();
    let ntens = stress.len();
    call.set_point([&strain[..ntens], &increment[..ntens], &stress], statev, *energies);
    call.trespass_again()
}

/// Words for matter that does not resist.
fn torn(component: usize, change: f64) -> String {
    let strain = STRAIN_NAMES[component];
    format!(
        "no equilibrium found near the last one: {strain} would change by {change:.3e} in the step, to a state with as little resistance as torn material; control {strain} by strain"
    )
}

/// Words for an equilibrium that is not the next one.
fn far(component: usize, change: f64) -> String {
    let strain = STRAIN_NAMES[component];
    format!(
        "no equilibrium found near the last one: {strain} would jump by {change:.3e}; control {strain} by strain, or use \
         smaller increments"
    )
}

/// The point at the start of a step, and the relations with their right sides at its end.
#[derive(Clone, Debug, Default)]
struct Plan {
    /// Values of the controlled quantity, by component.
    start: [f64; 6],
    /// The case's strain.
    strain: [f64; 6],
    /// Measure of the strains that are sought ([`Targets::measure`]).
    measure: Option<f64>,
    /// Left sides of the relations.
    relations: Vec<f64>,
    constraints: Vec<Constraint>,
    /// Total time, s.
    time: f64,
    gradient: Matrix3<f64>,
    fields: FieldValues,
}

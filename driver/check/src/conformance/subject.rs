//! Subject of a check: one entry point with one set of components, called through the ABI as a function from (committed
//! point, step) to an answer. UMAT, UINTER and FRIC look alike from here.
//!
//! | | input | output |
//! |---|---|---|
//! | UMAT | NTENS strains | NTENS stresses |
//! | UINTER | penetration, slips | pressure, shear tractions |
//! | FRIC | slips, pressure | shear tractions |

use super::Options;
use super::case_path::CasePath;
use super::entry_call::{fric, prepare_fric, prepare_uinter, prepare_umat, uinter, umat};
use super::report::Verdict;
use super::sample::SampledState;
use nalgebra::Matrix3;
use pullout_run::deformation::{columns, incremental_motion, of_constant_volume, rotated, spinless, symmetric};
use pullout_run::isolation::worker;
use pullout_run::program::PointKind;
use std::collections::BTreeMap;
use std::sync::Arc;
use umat_abi::host::{
    Alignment, Alteration, CallFailure, CallOutcome, FricAnswer, FricCall, GRADIENTS, Heat, LoadError, NotFinite,
    Plugin, Probed, SurfaceFields, Transfer, UinterCall, UmatCall, Validation, judge, same_bits,
};
use umat_abi::law::{Request, StressState};

/// Entry point and components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckedEntryPoint {
    /// UMAT.
    Umat(StressState),
    /// UINTER with NDIR directions.
    Uinter(usize),
    /// FRIC with NFDIR directions.
    Fric(usize),
}

impl CheckedEntryPoint {
    pub(super) fn label(self) -> &'static str {
        match self {
            Self::Umat(StressState::ThreeD) => "3D, NTENS 6",
            Self::Umat(StressState::PlaneStrainOrAxisymmetric) => "plane strain, NTENS 4",
            Self::Umat(StressState::PlaneStress) => "plane stress, NTENS 3",
            Self::Umat(StressState::OneD) => "1d, NTENS 1",
            Self::Umat(StressState::Beam) => "beam, NTENS 2",
            Self::Uinter(2) => "UINTER, NDIR 2",
            Self::Uinter(_) => "UINTER, NDIR 3",
            Self::Fric(1) => "FRIC, NFDIR 1",
            Self::Fric(_) => "FRIC, NFDIR 2",
        }
    }

    /// Number of inputs.
    pub(super) fn inputs(self) -> usize {
        match self {
            Self::Umat(stress_state) => stress_state.components().len(),
            Self::Uinter(n) => n,
            Self::Fric(n) => n + 1,
        }
    }

    /// Returns what output number `k` is called.
    pub(super) fn output_name(self, k: usize) -> String {
        const STRESSES: [&str; 6] = pullout_run::program::STRESS_NAMES;
        match self {
            Self::Umat(stress_state) => STRESSES[stress_state.components()[k]].into(),
            Self::Uinter(_) if k == 0 => "p".into(),
            Self::Uinter(_) => format!("tau{k}"),
            Self::Fric(_) => format!("tau{}", k + 1),
        }
    }

    /// Six components of a tensor of a UMAT from those that it has; 0 for contact.
    pub(super) fn six(self, values: &[f64]) -> [f64; 6] {
        if let Self::Umat(stress_state) = self { stress_state.six(values) } else { [0.0; 6] }
    }

    /// Returns the components of a tensor that a UMAT has; none for contact.
    pub(super) fn of_six(self, six: &[f64; 6]) -> Vec<f64> {
        let Self::Umat(stress_state) = self else { return Vec::new() };
        stress_state.components().iter().map(|&i| six[i]).collect()
    }

    /// Number of outputs.
    pub(super) fn outputs(self) -> usize {
        match self {
            Self::Fric(n) => n,
            other => other.inputs(),
        }
    }

    /// Returns what input number `k` is called.
    pub(super) fn input_name(self, k: usize) -> String {
        const STRAINS: [&str; 6] = pullout_run::program::STRAIN_NAMES;
        match self {
            Self::Umat(stress_state) => STRAINS[stress_state.components()[k]].into(),
            Self::Uinter(_) if k == 0 => "penetration".into(),
            Self::Fric(n) if k == n => "pressure".into(),
            Self::Uinter(_) => format!("slip{k}"),
            Self::Fric(_) => format!("slip{}", k + 1),
        }
    }
}

/// Arguments of a call besides the point and the step, as the case has them.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    /// DTIME, s.
    pub(super) time_increment: f64,
    /// TEMP and DTEMP.
    pub(super) temperature: [f64; 2],
    /// PREDEF and DPRED.
    pub(super) fields: [Vec<f64>; 2],
    /// DTEMDX of UMATHT.
    pub(super) temperature_gradient: [f64; GRADIENTS],
}

impl Setting {
    /// Reads the setting of a contact law's call. Such a law gets temperature and field variables at the end of the increment.
    pub(super) fn of_contact(call: &SurfaceFields, time_increment: f64) -> Self {
        let [end, increment] = call.temperature();
        let [ends, increments] = call.predef().map(|pairs| pairs.iter().copied().step_by(2).collect::<Vec<f64>>());
        let starts = ends.iter().zip(&increments).map(|(end, increment)| end - increment).collect();
        let temperature = [end - increment, increment];
        Self { time_increment, temperature, fields: [starts, increments], ..Self::default() }
    }

    /// The temperature, and field variables, at the start and after a share of their increments.
    pub(super) fn over(&self, share: f64) -> ([f64; 2], [Vec<f64>; 2]) {
        let [temperature, increment] = self.temperature;
        let [starts, increments] = &self.fields;
        let ends = starts.iter().zip(increments).map(|(start, increment)| start + share * increment);
        ([temperature, temperature + share * increment], [starts.clone(), ends.collect()])
    }
}

impl Default for Setting {
    fn default() -> Self {
        let fields = [vec![0.0], vec![0.0]];
        Self { time_increment: 1.0, temperature: [0.0; 2], fields, temperature_gradient: [0.0; GRADIENTS] }
    }
}

/// State of a point that a host keeps between calls.
#[derive(Clone, Debug)]
pub(super) struct Committed {
    pub(super) input: Vec<f64>,
    pub(super) output: Vec<f64>,
    pub(super) statev: Vec<f64>,
    pub(super) energies: [f64; 5],
    /// FRIC: accumulated DSLIP.
    pub(super) slip: [f64; 2],
    /// UINTER: LOPENCLOSE, LSTATE; FRIC: LM of the next call.
    pub(super) flags: [i32; 2],
    /// Step time and total time, s.
    pub(super) time: [f64; 2],
    /// Step and increment, from 1.
    pub(super) counters: [i32; 2],
    /// F.
    pub(super) gradient: Matrix3<f64>,
    /// Setting of the next increment.
    pub(super) setting: Setting,
}

impl Committed {
    /// A point of zeros.
    pub(super) fn zero(entry: CheckedEntryPoint, nstatv: usize) -> Self {
        Self {
            input: vec![0.0; entry.inputs()],
            output: vec![0.0; entry.outputs()],
            statev: vec![0.0; nstatv],
            energies: [0.0; 5],
            slip: [0.0; 2],
            flags: if let CheckedEntryPoint::Fric(_) = entry { [FricCall::STICKING, 0] } else { [-1; 2] },
            time: [0.0; 2],
            counters: [1; 2],
            gradient: Matrix3::identity(),
            setting: Setting::default(),
        }
    }
}

/// Values that a call returned.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Answer {
    pub(super) outcome: CallOutcome,
    pub(super) output: Vec<f64>,
    /// Row by row: outputs × inputs.
    pub(super) tangent: Vec<f64>,
    pub(super) statev: Vec<f64>,
    pub(super) energies: [f64; 5],
    /// RPL and its derivatives; 0 for contact.
    pub(super) heat: Heat,
    /// Answer of UMATHT, if it is called.
    pub(super) transfer: Option<Transfer>,
    pub(super) slip_increment: [f64; 2],
    pub(super) flags: [i32; 2],
    /// A result that no host can go on with.
    pub(super) not_finite: Option<NotFinite>,
    /// Tractions that FRIC asks the host to use by its LM. The other entry points always give theirs.
    pub(super) given: Result<FricAnswer, String>,
}

impl Answer {
    /// Returns whether stresses and states are bit for bit the same (NaN equals NaN).
    pub(super) fn same_response(&self, other: &Self) -> bool {
        same_bits(&self.output, &other.output)
            && same_bits(&self.statev, &other.statev)
            && same_bits(&self.energies, &other.energies)
    }

    /// Returns whether they are bit for bit the same, tangent included.
    pub(super) fn same(&self, other: &Self) -> bool {
        self.same_response(other)
            && same_bits(&self.tangent, &other.tangent)
            && same_bits(&self.heat_values(), &other.heat_values())
            && self.outcome == other.outcome
    }

    /// Returns RPL and its derivatives, one after the other.
    pub(super) fn heat_values(&self) -> [f64; 14] {
        let Heat { rpl, ddsddt: [a, b, c, d, e, f], drplde: [g, h, i, j, k, l], drpldt } = self.heat;
        [rpl, drpldt, a, b, c, d, e, f, g, h, i, j, k, l]
    }
}

/// The largest absolute value.
pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0_f64, |m, x| m.max(x.abs()))
}

/// Returns the largest absolute difference; infinity if a number stands against NaN.
pub(super) fn distance(a: &[f64], b: &[f64]) -> f64 {
    let difference = |(x, y): (&f64, &f64)| match (x - y).abs() {
        _ if x.to_bits() == y.to_bits() => 0.0,
        difference if difference.is_nan() => f64::INFINITY,
        difference => difference,
    };
    a.iter().zip(b).map(difference).fold(0.0, f64::max)
}

/// Reason why a call gave no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum NoAnswer {
    /// Failure that any host recognises; a cut-back request left the arrays as they were.
    #[error("{0}")]
    Call(CallFailure),
    /// The message of a refusal, or of missing tractions.
    #[error("{0}")]
    Refused(String),
}

#[derive(Debug)]
enum Call {
    Umat(Box<UmatCall>),
    Uinter(Box<UinterCall>),
    Fric(Box<FricCall>),
}

impl Call {
    /// Sets the arguments that a case has and no increment changes.
    fn set(&mut self, options: &Options) {
        let Some(program) = options.program.as_deref() else { return };
        match (self, &program.kind) {
            (Self::Umat(call), PointKind::Point(point)) => {
                point.arguments.set(call);
                call.jstep[2] = i32::from(point.nlgeom);
            }
            (Self::Uinter(call), PointKind::Interface(contact)) => contact.arguments.set_uinter(call),
            (Self::Fric(call), PointKind::Interface(contact)) => contact.arguments.set_fric(call),
            _ => {}
        }
    }

    /// Gives these arguments to another call.
    fn twin(&self, mut other: Self) -> Self {
        match (self, &mut other) {
            (Self::Umat(this), Self::Umat(other)) => {
                (other.coords, other.jstep) = (this.coords, this.jstep);
                [other.noel, other.npt] = [this.noel, this.npt];
            }
            (Self::Uinter(this), Self::Uinter(other)) => {
                (other.coords, other.local_directions) = (this.coords, this.local_directions);
                (other.area, other.node) = (this.area, this.node);
            }
            (Self::Fric(this), Self::Fric(other)) => {
                (other.coords, other.rcoord, other.node) = (this.coords, this.rcoord, this.node);
            }
            _ => {}
        }
        other
    }
}

/// One entry point with one set of components.
pub(super) struct Subject<'p> {
    pub(super) plugin: &'p Plugin,
    pub(super) entry: CheckedEntryPoint,
    /// Name of the entry point in rows.
    pub(super) label: &'static str,
    pub(super) props: Vec<f64>,
    /// CELENT or CHRLNGTH.
    pub(super) length: f64,
    pub(super) nstatv: usize,
    /// Typical magnitude of each input.
    pub(super) size: Vec<f64>,
    /// Typical magnitude of each output's tangent row times the inputs' sizes, in the virgin state.
    pub(super) output_size: Vec<f64>,
    /// Share of the case's DTIME, DTEMP and DPRED that each call makes.
    pub(super) share: f64,
    /// Whether F follows the strain (NLGEOM).
    pub(super) finite: bool,
    /// Whether the answer depends on DFGRD0 or DFGRD1.
    pub(super) reads_gradient: bool,
    /// DFGRD1 of the next call, if it is not that of a step without spin.
    end: Option<Matrix3<f64>>,
    /// The case's path, if it calls this entry point.
    pub(super) path: Option<Arc<CasePath>>,
    /// DROT, column-major.
    pub(super) rotation: [[f64; 3]; 3],
    /// Calls so far.
    pub(super) calls: u64,
    /// Time of a call, s.
    pub(super) call_time: f64,
    /// Arrays that were written past their ends, and the number of such calls.
    pub(super) overruns: BTreeMap<&'static str, usize>,
    call: Call,
}

/// Share of DTIME in which nothing happens, of a step of zero: some laws divide by DTIME.
pub(super) const INSTANT: f64 = 1e-14;
const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Host-filled parameters (`role`): 0 in PROPS means that the host chooses.
const PENALTY: f64 = 1e4;

impl<'p> Subject<'p> {
    pub(super) fn new(
        plugin: &'p Plugin,
        entry: CheckedEntryPoint,
        props: &[f64],
        options: &Options,
        path: Option<Arc<CasePath>>,
    ) -> Result<Self, LoadError> {
        let law = plugin.law.as_ref();
        let nstatv = law.map_or(plugin.nstatv, |law| law.states.len());
        let mut props = props.to_vec();
        for (value, parameter) in props.iter_mut().zip(law.map_or(&[][..], |law| &law.parameters)) {
            if *value == 0.0 && !parameter.role.is_empty() && parameter.admits(PENALTY) {
                *value = PENALTY;
            }
        }
        let length = characteristic_length(plugin, &props, options.characteristic_length);
        let mut call = Self::prepare(plugin, entry, &props, nstatv)?;
        let finite = match options.program.as_deref().map(|program| &program.kind) {
            Some(PointKind::Point(point)) => point.nlgeom,
            _ => false,
        };
        call.set(options);
        Ok(Self {
            plugin,
            entry,
            label: options.label(entry),
            props,
            length,
            nstatv,
            size: vec![1e-4; entry.inputs()],
            output_size: vec![1.0; entry.outputs()],
            share: 1.0,
            finite,
            reads_gradient: false,
            end: None,
            path,
            rotation: IDENTITY,
            calls: 0,
            call_time: 0.0,
            overruns: BTreeMap::new(),
            call,
        })
    }

    fn prepare(plugin: &Plugin, entry: CheckedEntryPoint, props: &[f64], nstatv: usize) -> Result<Call, LoadError> {
        // One symbol cannot be both UINTER and FRIC.
        let has_one_kind = plugin.law.as_ref().is_none_or(|law| law.kinds.count_ones() == 1);
        let symbol = plugin.symbol.clone().filter(|_| has_one_kind);
        let plugin = Plugin { symbol, props: props.to_vec(), nstatv, ..plugin.clone() };
        Ok(match entry {
            CheckedEntryPoint::Umat(state) => {
                let mut call = plugin.plain_umat(state)?;
                call.generate_heat();
                Call::Umat(Box::new(call))
            }
            CheckedEntryPoint::Uinter(directions) => Call::Uinter(Box::new(plugin.uinter(directions)?)),
            CheckedEntryPoint::Fric(directions) => Call::Fric(Box::new(plugin.fric(directions)?)),
        })
    }

    /// A twin with buffers of its own, for another thread or other properties.
    pub(super) fn twin(&self, props: &[f64]) -> Result<Self, LoadError> {
        self.twin_of(self.plugin, props)
    }

    /// Creates a twin as [`Self::twin`] does, with calls of another handle of the library.
    pub(super) fn twin_of<'q>(&self, plugin: &'q Plugin, props: &[f64]) -> Result<Subject<'q>, LoadError> {
        Ok(Subject {
            plugin,
            entry: self.entry,
            label: self.label,
            props: props.to_vec(),
            length: self.length,
            nstatv: self.nstatv,
            size: self.size.clone(),
            output_size: self.output_size.clone(),
            share: self.share,
            finite: self.finite,
            reads_gradient: self.reads_gradient,
            end: None,
            path: self.path.clone(),
            rotation: IDENTITY,
            calls: 0,
            call_time: 0.0,
            overruns: BTreeMap::new(),
            call: self.call.twin(Self::prepare(plugin, self.entry, props, self.nstatv)?),
        })
    }

    /// Creates a twin whose calls of UMAT are followed by UMATHT with these parameters; `None`: there is none.
    pub(super) fn with_umatht(&self, props: &[f64]) -> Option<Self> {
        let mut twin = self.twin(&self.props).ok()?;
        let Call::Umat(call) = &mut twin.call else { return None };
        call.transfer_heat(props).then_some(twin)
    }

    /// Returns a call of plane stress through six components; `None` if the plugin does not support that.
    pub(super) fn through_six(&self) -> Option<UmatCall> {
        let solid = StressState::ThreeD;
        if self.plugin.law.as_ref().is_some_and(|law| law.stress_states & solid.bits() == 0) {
            return None;
        }
        let prepare = |entry| {
            let call = Self::prepare(self.plugin, entry, &self.props, self.nstatv).ok()?;
            let Call::Umat(mut call) = self.call.twin(call) else { return None };
            call.celent = self.length;
            Some(*call)
        };
        let (mut plane, mut solid) = (prepare(self.entry)?, prepare(CheckedEntryPoint::Umat(solid))?);
        let blank = self.blank();
        let from = Committed { input: vec![0.0; 6], output: vec![0.0; 6], ..blank };
        prepare_umat(&mut solid, &from, &[0.0; 6], self.share, &from.gradient);
        matches!(solid.probe(Alignment::End), Ok(Probed::Clean)).then(|| plane.go_through(solid))?;
        Some(plane)
    }

    /// Returns the stresses after a step from a point of zeros, by a call through six components
    /// ([`Self::through_six`]); `None` if the call fails.
    pub(super) fn evaluate_through(&self, call: &mut UmatCall, from: &Committed, step: &[f64]) -> Option<Vec<f64>> {
        call.strain_33 = 0.0;
        prepare_umat(call, from, step, self.share, &self.end_gradient(from, step));
        let outcome = call.call(Request::Stress).ok()?;
        judge(Ok(outcome), call.not_finite()).ok()?;
        Some(call.stress().to_vec())
    }

    /// Returns whether the metadata claims a flag.
    pub(super) fn claims(&self, flag: u32) -> bool {
        self.plugin.law.as_ref().is_some_and(|law| law.has(flag))
    }

    /// Returns whether the plugin has metadata: then the contract binds it.
    pub(super) fn described(&self) -> bool {
        self.plugin.law.is_some()
    }

    /// The verdict on what the contract demands of plugins with metadata.
    pub(super) fn blame(&self) -> Verdict {
        if self.described() { Verdict::Fail } else { Verdict::Warn }
    }

    /// The verdict on no answer to a step of zero, which hosts ask for before the first iteration: no law may answer it with NaN.
    pub(super) fn blame_for(&self, trouble: &NoAnswer) -> Verdict {
        if matches!(trouble, NoAnswer::Call(CallFailure::NotFinite(_))) { Verdict::Fail } else { self.blame() }
    }

    /// The point before the first increment: the case's, reached or not, or one of zeros without a case.
    pub(super) fn virgin(&self) -> Committed {
        let path = self.path.as_ref();
        let first = path.and_then(|path| path.increments.first()).map(|increment| &increment.from);
        let start = first.or_else(|| path?.start.as_ref());
        start.cloned().unwrap_or_else(|| Committed::zero(self.entry, self.nstatv))
    }

    /// Returns the point before the first increment, with the DTIME, DTEMP and DPRED of another increment.
    pub(super) fn virgin_during(&self, other: &Committed) -> Committed {
        let mut virgin = self.virgin();
        let Setting { time_increment, temperature, fields, .. } = &other.setting;
        virgin.setting.time_increment = *time_increment;
        virgin.setting.temperature[1] = temperature[1];
        virgin.setting.fields[1].clone_from(&fields[1]);
        virgin
    }

    /// Returns how many of `wanted` things, each of so many calls, can be afforded in a time, s; at least a few.
    pub(super) fn affordable(&self, wanted: usize, calls_each: usize, seconds: f64) -> usize {
        const FEW: usize = 2;
        let affordable = seconds / (self.call_time * calls_each as f64).max(f64::MIN_POSITIVE);
        wanted.min((affordable as usize).max(FEW))
    }

    /// A point without strain and stress in the case's setting. The states of a law that describes them are zero then; those of
    /// any other are the case's.
    pub(super) fn blank(&self) -> Committed {
        let Committed { setting, time, counters, statev, .. } = self.virgin();
        let zero = Committed::zero(self.entry, self.nstatv);
        let statev = if self.described() { zero.statev.clone() } else { statev };
        Committed { setting, time, counters, statev, ..zero }
    }

    /// Returns how many of the case's DTIME its path takes; 1 without a case.
    pub(super) fn path_length(&self) -> f64 {
        self.path.as_ref().map_or(1.0, |path| path.taken.max(1) as f64)
    }

    /// Returns the point after an accepted step.
    pub(super) fn advanced(&self, from: &Committed, step: &[f64], answer: &Answer) -> Committed {
        let mut setting = from.setting.clone();
        setting.temperature[0] += self.share * setting.temperature[1];
        let [fields, increments] = &mut setting.fields;
        fields.iter_mut().zip(increments).for_each(|(field, increment)| *field += self.share * *increment);
        let time_increment = self.share * from.setting.time_increment;
        Committed {
            input: from.input.iter().zip(step).map(|(x, d)| x + d).collect(),
            output: answer.output.clone(),
            statev: answer.statev.clone(),
            energies: answer.energies,
            slip: [from.slip[0] + answer.slip_increment[0], from.slip[1] + answer.slip_increment[1]],
            flags: answer.flags,
            time: from.time.map(|time| time + time_increment),
            counters: [from.counters[0], from.counters[1] + 1],
            gradient: self.end_gradient(from, step),
            setting,
        }
    }

    /// F at the end of a step without spin.
    pub(super) fn end_gradient(&self, from: &Committed, step: &[f64]) -> Matrix3<f64> {
        match self.end {
            Some(end) => end,
            None if self.finite => spinless(&self.tensor(step), &from.gradient).unwrap_or(from.gradient),
            None => from.gradient,
        }
    }

    /// The strains of an input as a tensor; 0 for contact.
    pub(super) fn tensor(&self, input: &[f64]) -> Matrix3<f64> {
        symmetric(&self.entry.six(input), 2.0)
    }

    /// Returns the point after F₁, with DSTRAN, DROT and the rotated STRAN and STRESS that a host passes with it.
    /// `None`: there is no such motion, or no answer.
    pub(super) fn deformed(&mut self, from: &Committed, end: &Matrix3<f64>) -> Option<Committed> {
        self.moved(from, end, |subject, before, step| subject.after(before, step).ok())
    }

    /// The answer there ([`Self::deformed`]).
    pub(super) fn answer_deformed(&mut self, from: &Committed, end: &Matrix3<f64>) -> Option<Answer> {
        self.moved(from, end, |subject, before, step| subject.evaluate(before, step).ok())
    }

    /// Makes a step to F₁.
    fn moved<T>(
        &mut self,
        from: &Committed,
        end: &Matrix3<f64>,
        make: impl FnOnce(&mut Self, &Committed, &[f64]) -> Option<T>,
    ) -> Option<T> {
        let entry = self.entry;
        let motion = incremental_motion(&from.gradient, end).filter(|_| matches!(entry, CheckedEntryPoint::Umat(_)))?;
        let turned = |values: &[f64], shear: f64| entry.of_six(&rotated(&entry.six(values), &motion.rotation, shear));
        let before = Committed { input: turned(&from.input, 2.0), output: turned(&from.output, 1.0), ..from.clone() };
        let step = entry.of_six(&motion.strain_increment);
        self.rotation = columns(&motion.rotation);
        self.end = Some(*end);
        let made = make(self, &before, &step);
        self.rotation = IDENTITY;
        self.end = None;
        made
    }

    /// Returns whether a law of small strains of which nothing is known follows DFGRD1 alone.
    pub(super) fn follows_gradient_alone(&mut self) -> bool {
        let virgin = self.virgin();
        let none = vec![0.0; self.entry.inputs()];
        let is_asked = !self.described() && !self.finite;
        let Call::Umat(call) = &mut self.call else { return false };
        prepare_umat(call, &virgin, &none, self.share, &virgin.gradient);
        is_asked && call.follows_gradient_alone()
    }

    /// Finds out whether the law reads the deformation gradients: then the answer changes without them.
    pub(super) fn find_out_what_is_read(&mut self, sample: &[SampledState]) {
        const ASKED: usize = 20;
        let asked = if self.finite { ASKED } else { 0 };
        self.reads_gradient = sample.iter().rev().take(asked).any(|state| {
            let with = self.call(&state.from, &state.step, 0.0, Alteration::None);
            let blind = Committed { gradient: Matrix3::identity(), ..state.from.clone() };
            self.end = Some(Matrix3::identity());
            let without = self.call(&blind, &state.step, 0.0, Alteration::None);
            self.end = None;
            !with.same(&without)
        });
    }

    /// Returns the stress of an elastic material at this input: the scale for rounding errors.
    pub(super) fn elastic_size(&self, input: &[f64]) -> f64 {
        let sizes = input.iter().zip(&self.size).fold(0.0_f64, |m, (x, size)| m.max((x / size).abs()));
        largest(&self.output_size) * sizes
    }

    /// A name for state variable `k`.
    pub(super) fn state_name(&self, k: usize) -> String {
        let named = self.plugin.law.as_ref().and_then(|law| law.states.get(k));
        named.map_or_else(|| format!("sdv{}", k + 1), |state| state.name.clone())
    }

    /// Returns whether state variable `k` may hold a history. The last two of a UMAT with metadata do not: they hold the thickness
    /// strain and an energy.
    pub(super) fn is_history(&self, k: usize) -> bool {
        let outputs = ["strain_33", "dissipated_energy"];
        let law = self.plugin.law.as_ref();
        law.and_then(|law| law.states.get(k)).is_none_or(|state| !outputs.contains(&state.name.as_str()))
    }

    /// Names of optional arguments and of the tangent.
    pub(super) fn argument_names(&self) -> (&'static [&'static str], &'static str) {
        match self.call {
            Call::Umat(_) => (UmatCall::OPTIONAL_ARGUMENTS, UmatCall::TANGENT_ARGUMENT),
            Call::Uinter(_) => (UinterCall::OPTIONAL_ARGUMENTS, UinterCall::TANGENT_ARGUMENT),
            Call::Fric(_) => (FricCall::OPTIONAL_ARGUMENTS, FricCall::TANGENT_ARGUMENT),
        }
    }

    /// The response to a step, or why there is none.
    pub(super) fn evaluate(&mut self, from: &Committed, step: &[f64]) -> Result<Answer, NoAnswer> {
        let mut answer = self.call(from, step, 0.0, Alteration::None);
        match judge(Ok(answer.outcome), answer.not_finite) {
            // the sign of our own laws
            Err(CallFailure::CutBack(_)) if self.described() && answer.output.iter().any(|x| x.is_nan()) => {
                let why = "it refused: NaN and a cut-back request (a panic, or a configuration error)";
                return Err(NoAnswer::Refused(why.into()));
            }
            judgement => judgement.map_err(NoAnswer::Call)?,
        }
        match &answer.given {
            Ok(FricAnswer::Tractions) => {}
            Ok(FricAnswer::NoShear) => {
                answer.output.fill(0.0);
                answer.tangent.fill(0.0);
            }
            Ok(FricAnswer::Sticks) => return Err(NoAnswer::Refused("it returned LM = 1, no tractions".into())),
            Err(words) => return Err(NoAnswer::Refused(words.clone())),
        }
        Ok(answer)
    }

    /// The point after a step, or why there is none.
    pub(super) fn after(&mut self, from: &Committed, step: &[f64]) -> Result<Committed, NoAnswer> {
        let answer = self.evaluate(from, step)?;
        Ok(self.advanced(from, step, &answer))
    }

    /// Goes along a step, halving it where the plugin asks for a cut-back; returns the number of cut-backs.
    pub(super) fn advance(&mut self, point: &mut Committed, step: &[f64]) -> Result<usize, NoAnswer> {
        const MOST_HALVINGS: u32 = 10;
        self.advance_halving(point, step, MOST_HALVINGS)
    }

    fn advance_halving(&mut self, point: &mut Committed, step: &[f64], halvings: u32) -> Result<usize, NoAnswer> {
        match self.after(point, step) {
            Ok(after) => {
                *point = after;
                Ok(0)
            }
            Err(NoAnswer::Call(CallFailure::CutBack(_))) if halvings > 0 => {
                let half: Vec<f64> = step.iter().map(|d| 0.5 * d).collect();
                self.share *= 0.5;
                let first = self.advance_halving(point, &half, halvings - 1);
                let both = first.and_then(|first| Ok(1 + first + self.advance_halving(point, &half, halvings - 1)?));
                self.share *= 2.0;
                both
            }
            Err(trouble) => Err(trouble),
        }
    }

    /// Makes one call, whatever it returns. The tangents are filled with `filling` before; `alteration` may spoil an input.
    pub(super) fn call(&mut self, from: &Committed, step: &[f64], filling: f64, alteration: Alteration<'_>) -> Answer {
        self.calls += 1;
        worker::note_call();
        self.prepare_call(from, step);
        let (answer, result) = match &mut self.call {
            Call::Umat(call) => umat(call, from, filling, alteration),
            Call::Uinter(call) => uinter(call, filling, alteration),
            Call::Fric(call) => fric(call, filling, alteration),
        };
        if let Err(overrun) = result {
            *self.overruns.entry(overrun.array).or_default() += 1;
        }
        answer
    }

    /// Takes the calls of a child process out of the record of its parent's.
    pub(super) fn leave_record(&mut self) {
        match &mut self.call {
            Call::Umat(call) => call.leave_record(),
            Call::Uinter(call) => call.leave_record(),
            Call::Fric(call) => call.leave_record(),
        }
    }

    /// One call in a child process with its arrays fenced.
    pub(super) fn probe(&mut self, from: &Committed, step: &[f64], alignment: Alignment) -> std::io::Result<Probed> {
        self.prepare_call(from, step);
        match &mut self.call {
            Call::Umat(call) => call.probe(alignment),
            Call::Uinter(call) => call.probe(alignment),
            Call::Fric(call) => call.probe(alignment),
        }
    }

    /// Writes the arguments of a call.
    fn prepare_call(&mut self, from: &Committed, step: &[f64]) {
        let end = self.end_gradient(from, step);
        let keeps_volume = self.finite && self.entry == CheckedEntryPoint::Umat(StressState::PlaneStress);
        match &mut self.call {
            Call::Umat(call) => {
                call.celent = self.length;
                call.drot = self.rotation;
                prepare_umat(call, from, step, self.share, &end);
                if keeps_volume {
                    let passed = [from.gradient, end].map(|gradient| columns(&of_constant_volume(gradient)));
                    [call.dfgrd0, call.dfgrd1] = passed;
                }
            }
            Call::Uinter(call) => {
                call.chrlngth = self.length;
                prepare_uinter(call, from, step, self.share);
            }
            Call::Fric(call) => {
                call.chrlngth = self.length;
                prepare_fric(call, from, step, self.share);
            }
        }
    }
}

/// The given length, or one that the law accepts.
fn characteristic_length(plugin: &Plugin, props: &[f64], given: Option<f64>) -> f64 {
    const CANDIDATES: [f64; 4] = [1.0, 10.0, 50.0, 0.1];
    let accepted =
        |length: &f64| plugin.law.as_ref().is_none_or(|law| law.validate(props, Some(*length)) == Validation::Valid);
    given.unwrap_or_else(|| CANDIDATES.into_iter().find(accepted).unwrap_or(CANDIDATES[0]))
}

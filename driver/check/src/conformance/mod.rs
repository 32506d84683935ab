//! `pullout plugin check`: tests a plugin against the claims of its metadata, through the ABI.
//!
//! Every check drives the plugin itself, as a host does, on a sample of random histories, and compares the
//! answers with each other: differences of the stress with the tangent, a call with its repetition, a path
//! with the rotated path, work with energy. A law that breaks a claim fails; a plain UMAT, which claims
//! nothing, gets warnings and information.
//!
//! The checks call the plugin in this process; only those for accesses outside its arrays use child processes. Crashes of the
//! process are handled by workers around it, one for each [`CheckGroup`]; all groups use the same sample.

mod bad_input;
mod bounds;
mod case_path;
mod determinism;
mod energy;
mod entry_call;
mod heat;
mod hidden_data;
mod memory;
mod messages;
mod metadata;
mod nonlinear;
mod null_arguments;
mod precision;
mod properties;
mod random;
mod report;
mod rotation;
mod sample;
mod scale;
mod slip;
mod step_size;
mod subject;
mod tangent;
mod tolerances;
mod virgin;

pub use report::{CheckRow, Event, Judged, Judgement, Report, Verdict};
pub use subject::CheckedEntryPoint;

use case_path::CasePath;
use pullout_run::program::Program;
use report::Ledger;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::Duration;
use subject::Subject;
use umat_abi::host::{ExternalDatabases, FOLLOWS_GRADIENT, LawDescription, Plugin, Routine};
use umat_abi::law::StressState;
use umat_abi::metadata::kinds;

/// Settings of a check.
#[derive(Clone, Debug)]
pub struct Options {
    /// PROPS; `None`: the plugin's, or if it has none the defaults of the metadata.
    pub props: Option<Vec<f64>>,
    /// PROPS of UMATHT; `None`: it is not called.
    pub umatht_props: Option<Vec<f64>>,
    /// CELENT, mm; `None`: one that the law accepts.
    pub characteristic_length: Option<f64>,
    /// Number of random histories per stress state.
    pub states: usize,
    /// The case whose path determines the scale of the law.
    pub program: Option<Arc<Program>>,
    /// Makes the rows of one group only.
    pub group: Option<CheckGroup>,
    /// States of the sample that are left out, because a plugin did not survive them.
    pub skipped: Vec<usize>,
    /// Increments of the case that are taken at most, for the same reason.
    pub longest_path: Option<u64>,
    /// Time for everything, s: a law whose calls take long is looked at in fewer states.
    pub seconds: Option<f64>,
    /// The one stress state that is checked of the laws of a library with metadata, without a case.
    pub stress_state: Option<StressState>,
    /// Whether the four components in a plane are those of axisymmetry.
    pub is_axisymmetric: bool,
    /// Receives each event as it occurs, since a plugin may end the process.
    pub listener: Option<fn(Event)>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            props: None,
            umatht_props: None,
            characteristic_length: None,
            states: 200,
            program: None,
            group: None,
            skipped: Vec::new(),
            longest_path: None,
            seconds: None,
            stress_state: None,
            is_axisymmetric: false,
            listener: None,
        }
    }
}

/// Checks that share one process, which the plugin may end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
pub enum CheckGroup {
    /// The metadata, the case's path and the sample around it.
    States,
    /// DDSDDE, and the derivatives that couple with a temperature.
    Tangent,
    /// Arrays, memory between calls, threads.
    Memory,
    /// Paths of several increments: energies, rotations, sizes of increments.
    Paths,
    /// Input that makes no sense.
    BadInput,
}

impl CheckGroup {
    /// Returns what it looks at.
    pub fn words(self) -> &'static str {
        match self {
            Self::States => "what a sample of states shows",
            Self::Tangent => "DDSDDE",
            Self::Memory => "arrays, memory between calls, threads",
            Self::Paths => "energies, rotations, sizes of increments",
            Self::BadInput => "input that makes no sense",
        }
    }
}

/// Returns the processor time of this thread so far: verdicts do not depend on the load of the machine. Waiting plugins are
/// detected by the supervising process.
fn processor_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::try_from(time).unwrap_or_default()
}

impl Options {
    /// Returns what may be spent on one of the things that every group does before its checks.
    fn share_of_time(&self) -> Duration {
        const SHARE: f64 = 0.2;
        self.seconds.map_or(Duration::MAX, |seconds| Duration::from_secs_f64(SHARE * seconds))
    }

    /// Returns whether the rows of a group are wanted.
    fn wants(&self, group: CheckGroup) -> bool {
        self.group.is_none_or(|wanted| wanted == group)
    }

    /// Returns what rows of an entry point are called.
    fn label(&self, entry: CheckedEntryPoint) -> &'static str {
        match entry {
            CheckedEntryPoint::Umat(StressState::PlaneStrainOrAxisymmetric) if self.is_axisymmetric => {
                "axisymmetric, NTENS 4"
            }
            _ => entry.label(),
        }
    }

    /// PROPS for a plugin.
    fn properties(&self, plugin: &Plugin) -> Vec<f64> {
        match (&self.props, &plugin.law) {
            (Some(props), _) => props.clone(),
            (None, Some(law)) if plugin.props.is_empty() => metadata::default_properties(law),
            (None, _) => plugin.props.clone(),
        }
    }
}

/// Checks a plugin: its metadata, then every entry point with every stress state.
pub fn check(plugin: &Plugin, options: &Options) -> Report {
    let mut report = Report { listener: options.listener, ..Report::default() };
    let props = options.properties(plugin);
    let describes = options.wants(CheckGroup::States);
    if let Some(law) = plugin.law.as_ref().filter(|_| describes) {
        metadata::check(law, &props, options.characteristic_length, &mut Ledger::new(&mut report, "-"));
    }
    if describes {
        let left_out = plugin.library.routines().iter().filter(|routine| !routine.is_called);
        let names: Vec<String> = left_out.map(Routine::name).collect();
        if !names.is_empty() {
            let detail =
                format!("{}: not called by this program: what the law expects of them is missing", names.join(", "));
            Ledger::new(&mut report, "-").row("other routines", Verdict::Warn, format!("{}", names.len()), detail);
        }
    }
    // SDVINI and the path of the case within one analysis that lasts as long as the check
    let mut databases = ExternalDatabases::begin([&plugin.library]);
    let kept = if options.wants(CheckGroup::Memory) { kept_properties(plugin, &props, options) } else { None };
    let path =
        options.program.as_deref().map(|program| Arc::new(CasePath::of(program, options, &mut databases, &mut report)));
    let mut subjects = Vec::new();
    for entry in entries(plugin.law.as_ref(), path.as_deref(), options) {
        let label = options.label(entry);
        let path = path.clone().filter(|path| path.entry == entry);
        match Subject::new(plugin, entry, &props, options, path) {
            Ok(subject) => subjects.push(subject),
            Err(error) if describes => {
                Ledger::new(&mut report, label).row("entry point", Verdict::Fail, "missing", error.to_string());
            }
            Err(_) => {}
        }
    }
    // a failure before the first increment is reported once: all other checks need the point before it
    subjects.retain_mut(|subject| begins(subject, options, &mut Ledger::new(&mut report, subject.label)));
    for subject in &mut subjects {
        let label = subject.label;
        let kept = kept.as_ref().filter(|(of, _)| *of == label).map(|(_, finding)| finding);
        check_subject(subject, kept, options, &mut databases, &mut Ledger::new(&mut report, label));
    }
    if options.wants(CheckGroup::Paths) {
        virgin::agreement_with_three_d(&mut subjects, &mut report);
    }
    for subject in &subjects {
        memory::overruns(subject, &mut Ledger::new(&mut report, subject.label));
    }
    report
}

/// Looks for what a law keeps of the PROPS of its first call, before this process makes any.
fn kept_properties(plugin: &Plugin, props: &[f64], options: &Options) -> Option<(&'static str, properties::Finding)> {
    let program = options.program.as_deref();
    let of_case = program.map(case_path::entry);
    let entry = of_case.or_else(|| entries(plugin.law.as_ref(), None, options).into_iter().next())?;
    let subject = Subject::new(plugin, entry, props, options, None).ok()?;
    Some((subject.label, properties::find(&subject, program)))
}

/// Every entry point and set of components that the law claims.
fn entries(law: Option<&LawDescription>, path: Option<&CasePath>, options: &Options) -> Vec<CheckedEntryPoint> {
    const SOLID: [StressState; 3] =
        [StressState::ThreeD, StressState::PlaneStrainOrAxisymmetric, StressState::PlaneStress];
    let Some(law) = law else {
        return vec![path.map_or(CheckedEntryPoint::Umat(StressState::ThreeD), |path| path.entry)];
    };
    let mut entries = Vec::new();
    if law.kinds & kinds::UMAT != 0 {
        let supported = SOLID
            .into_iter()
            .filter(|stress_state| stress_state.bits() & law.stress_states != 0)
            .filter(|stress_state| options.stress_state.is_none_or(|wanted| wanted == *stress_state));
        entries.extend(supported.map(CheckedEntryPoint::Umat));
    }
    if law.kinds & kinds::UINTER != 0 {
        entries.extend([2, 3].map(CheckedEntryPoint::Uinter));
    }
    if law.kinds & kinds::FRIC != 0 {
        entries.extend([1, 2].map(CheckedEntryPoint::Fric));
    }
    entries
}

/// Reports the case's path. Returns whether the plugin answers at its start, so that further checks are possible.
fn begins(subject: &mut Subject<'_>, options: &Options, ledger: &mut Ledger<'_>) -> bool {
    let Some(path) = subject.path.clone() else { return true };
    // that it does not survive its first increment has been reported already
    ledger.is_muted = !options.wants(CheckGroup::States) || options.longest_path == Some(0);
    let has_answer = !path.fails_at_once() || (path.start.is_some() && virgin::answers(subject));
    path.report(!has_answer || !subject.overruns.is_empty(), ledger);
    has_answer
}

/// All checks of one entry point and stress state. `kept`: what is known of PROPS that its law keeps.
fn check_subject(
    subject: &mut Subject<'_>,
    kept: Option<&properties::Finding>,
    options: &Options,
    databases: &mut ExternalDatabases,
    ledger: &mut Ledger<'_>,
) {
    ledger.is_muted = !options.wants(CheckGroup::States);
    if !ledger.is_muted {
        virgin::virgin_state(subject, ledger);
    }
    // a library that does not survive its case's first increment says nothing more
    if options.longest_path == Some(0) {
        let detail =
            "not tested: the plugin does not survive the case's first increment: only the virgin state was judged";
        return ledger.row("answers", Verdict::NotTested, "none", detail);
    }
    let first = options.wants(CheckGroup::Memory).then(|| determinism::first_call(subject, ledger));
    if subject.follows_gradient_alone() {
        ledger.is_muted = !options.wants(CheckGroup::States);
        return ledger.row("strain", Verdict::Fail, "not read", FOLLOWS_GRADIENT);
    }
    scale::find(subject, ledger);
    let sample = sample::draw(subject, options, ledger);
    if sample.is_empty() {
        ledger.is_muted = !options.wants(CheckGroup::Memory);
        if !ledger.is_muted {
            // a law that answers nowhere may do so for what it reads outside its arrays
            bounds::check(subject, &sample::unanswered(subject), ledger);
        }
        return;
    }
    if !ledger.is_muted {
        nonlinear::check(subject, &sample, ledger);
    }
    ledger.is_muted = false;
    subject.find_out_what_is_read(&sample);
    if options.wants(CheckGroup::Tangent) {
        tangent::check(subject, &sample, ledger);
        tangent::symmetry(subject, &sample, ledger);
        tangent::shear_stiffness(subject, ledger);
        heat::check(subject, &sample, ledger);
        heat::check_transfer(subject, options.umatht_props.as_deref(), &sample, ledger);
    }
    if let Some(first) = &first {
        if let Some(finding) = kept {
            properties::report(finding, ledger);
        }
        memory::unset_entries(subject, &sample, ledger);
        memory::inputs_untouched(subject, &sample, ledger);
        determinism::repeatability(subject, &sample, ledger);
        determinism::call_order(subject, &sample, first, options, databases, ledger);
        hidden_data::check(subject, &sample, ledger);
        bounds::check(subject, &sample, ledger);
        precision::check(subject, &sample, ledger);
        determinism::threads(subject, &sample, ledger);
        determinism::stress_only(subject, &sample, ledger);
    }
    if options.wants(CheckGroup::Paths) {
        virgin::zero_increment(subject, &sample, ledger);
        virgin::strain_33(subject, &sample, ledger);
        virgin::thickness(subject, ledger);
        rotation::check(subject, options.states, ledger);
        rotation::incremental_rotation(subject, &sample, ledger);
        rotation::objectivity(subject, &sample, ledger);
        slip::inelastic(subject, &sample, ledger);
        step_size::check(subject, ledger);
        energy::check(subject, ledger);
    }
    if options.wants(CheckGroup::BadInput) {
        bad_input::not_finite(subject, &sample, ledger);
        bad_input::properties(subject, &sample, ledger);
        bad_input::counts(subject, &sample, ledger);
        bad_input::characteristic_length(subject, &sample, options.characteristic_length.is_some(), ledger);
        null_arguments::check(subject, &sample, ledger);
    }
}

//! Runs a model, and turns its records into rows of the history.

use super::checkpoint::Saved;
use super::fields::{FieldWriter, WrittenFields};
use super::findings::{self, Borne, Findings, Rupture};
use super::moments::Moments;
use super::peak::PeakKeeper;
use super::{PictureAt, PulloutProgram, SpecimenSettings, crack_band, overlap, replay, section};
use crate::columns::{self, place_in_specimen};
use crate::number::significant;
use crate::path::{self, Row, RunFailure, Statistics, Stop};
use fe_core::assembly::PointFailure;
use fe_core::model::{Model, Step, StepControl};
use fe_core::output::Fields;
use fe_core::stepping::{
    Analysis, Checkpoint, Directive, ENERGY_BUDGET, Energies, IncrementObserver, Record, RunError,
    STABILISATION_BUDGET, Snapshot, Trail,
};
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

#[cfg(test)]
pub(super) mod test;

/// A step is at its end within this part of its duration: increments add up with rounding.
const END_TOLERANCE: f64 = 1e-9;

/// Outcome of a run: its cost, its end, its findings, and the states that pictures show.
#[derive(Debug)]
pub struct SpecimenOutcome {
    /// Cost of the run.
    pub statistics: Statistics,
    /// End of the run. Rows that were observed stay valid.
    pub result: Result<(), Stop>,
    /// Findings besides the history.
    pub findings: Findings,
    /// The state at the greatest load, if the run went on from there and pictures are wanted.
    pub peak: Option<SavedState>,
    /// The state at the end, if pictures are wanted and anything was computed.
    pub end: Option<SavedState>,
    /// The states that the case asks pictures of, as far as the run came to them.
    pub moments: Vec<(PictureAt, SavedState)>,
    /// The states that it went through, if they were kept.
    pub trail: Option<Trail>,
}

impl SpecimenOutcome {
    fn stopped(stop: Stop) -> Self {
        Self {
            statistics: Statistics::default(),
            result: Err(stop),
            findings: Findings::default(),
            peak: None,
            end: None,
            moments: Vec::new(),
            trail: None,
        }
    }
}

/// A state that pictures show.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SavedState {
    /// Slip, mm.
    pub slip: f64,
    /// Load, N.
    pub load: f64,
    /// The fields.
    pub fields: Fields,
}

/// Runs a program to its end, to an `until`, or to a failure.
pub fn run(
    program: &PulloutProgram,
    settings: &SpecimenSettings<'_>,
    observer: &mut dyn path::Observer,
) -> SpecimenOutcome {
    let SpecimenSettings { threads, folder, checkpoints, pictures, keeps_trail, along } = settings;
    let model = &program.model;
    let from = checkpoints.from.as_deref();
    let start = Instant::now();
    let analysis = from.map_or_else(|| Analysis::new(model), |saved| Analysis::resume(model, &saved.analysis));
    let mut analysis = match analysis {
        Ok(analysis) => analysis,
        Err(error) => return SpecimenOutcome::stopped(Stop::unusable(error.to_string())),
    };
    analysis.set_threads(threads.clone());
    if let Some(flag) = observer.stop() {
        analysis.stop_at(flag);
    }
    if let Some(every) = checkpoints.every {
        analysis.checkpoint_every(every);
    }
    match (along, &program.about.recorded) {
        (Some(along), _) => analysis.follow(along),
        (None, Some(recorded)) => analysis.repeat(recorded.as_ref().clone()),
        (None, None) => {}
    }
    if *keeps_trail {
        analysis.keep_trail();
    }
    let set_up = start.elapsed();
    let written = from.and_then(|saved| saved.recorder.fields.as_ref());
    let writer = |folder: &Path| match written {
        Some(written) => FieldWriter::resume(folder, model, written),
        None => FieldWriter::create(folder, model, checkpoints.every.is_some()),
    };
    let fields = match folder.filter(|_| program.fields_every.is_some()).map(writer).transpose() {
        Ok(fields) => fields,
        Err(error) => return SpecimenOutcome::stopped(Stop::Write(error)),
    };
    let mut recorder = Recorder::new(program, settings, observer, fields);
    if let Some(saved) = from {
        recorder.state = saved.recorder.clone();
    }
    let start = Instant::now();
    let ended = analysis.run(&mut recorder);
    let trail = analysis.take_trail();
    if analysis.is_stopped() {
        // in the middle of an increment nobody asks it
        recorder.observer.ends_here();
    }
    let snapshot = analysis.snapshot();
    let mut findings = Findings::default();
    let ended = ended.map_err(|error| match error {
        RunError::Failed { step, increment, progress, ref trouble } => {
            let PointFailure { place, reason, .. } = trouble.clone();
            findings.failure = Some(findings::SpecimenFailure { step, increment, progress, place, reason });
            let replay = replay::of(program, trouble, &snapshot);
            Stop::Failed(RunFailure { step, increment, message: error.to_string(), replay })
        }
        RunError::Write(error) => Stop::Write(error),
    });
    let result = recorder.finish(&snapshot).map_err(Stop::Write).and(ended);
    findings.stabilisation_share = analysis.stabilisation_share();
    let relaxes = model.controls.relaxation_time > 0.0;
    let spalled = snapshot.solids().spalled();
    let (at_peak, at_end) = (recorder.state.peak.shape(), (snapshot.displacements(), spalled.as_slice()));
    let mut warnings = analysis.remarks();
    warnings.extend(imbalance(model, recorder.state.energy_error));
    warnings.extend(stabilisation_warning(findings.stabilisation_share, relaxes));
    warnings.extend(recorder.state.moments.as_ref().and_then(|moments| moments.missed(&program.pictures_at)));
    warnings.extend(overlap::measure(program, at_peak, at_end, snapshot.contact().crushed(), &mut findings));
    let work = recorder.state.energies.external_work;
    warnings.extend(crack_band::warnings(model, snapshot.solids(), work));
    warnings.extend(section::warning(program, snapshot.solids(), work));
    warnings.extend(Rupture::warnings(&recorder.state.ruptures, &model.measured, program.rupture_strain));
    warnings.into_iter().for_each(|warning| recorder.observer.warn(warning));
    let elapsed = start.elapsed();
    let done = analysis.statistics();
    let Recorder { fields, state, .. } = recorder;
    let RecorderState { peak, moments, ruptures, present, energies, energy_error, initial_displacement, .. } = state;
    let writing = fields.map_or(Duration::ZERO, |fields| fields.spent);
    findings.peak_load = peak.peak;
    findings.ruptures = ruptures;
    findings.energy_error_max = model.is_driven_alone().then_some(energy_error);
    findings.initial_displacement = initial_displacement;
    findings.energies = findings::energies(&present.values, energies.unaccounted);
    findings.statistics = findings::statistics(&analysis);
    findings.times = findings::times(set_up, elapsed.saturating_sub(writing), &analysis.times(), writing);
    let pairs = model.contacts.iter().map(|pair| pair.name.clone());
    findings.penalties = pairs.zip(snapshot.contact().penalties()).collect();
    let [slip, load] = ["slip", "load"].map(|name| present.value(name));
    let end = || SavedState { slip, load, fields: Fields::of(&snapshot) };
    let goes_on = |state: &SavedState| state.fields.time < snapshot.time();
    SpecimenOutcome {
        statistics: Statistics {
            increments: done.increments,
            iterations: done.iterations,
            plugin_calls: snapshot.solids().counters().umat_calls + snapshot.contact().law_calls(),
            cutbacks: done.cutbacks,
        },
        result,
        findings,
        peak: peak.into_state().filter(goes_on),
        end: pictures.then(end),
        moments: moments.map(|kept| kept.into_states(&program.pictures_at)).unwrap_or_default(),
        trail,
    }
}

/// Warns of stabilisation that may govern the result, and says what lessens it.
fn stabilisation_warning(share: f64, relaxes: bool) -> Option<String> {
    let shorter = if relaxes { "a shorter relaxation_time or " } else { "" };
    (share > STABILISATION_BUDGET).then(|| {
        format!(
            "stabilisation took {:.2} % of the work: beyond 1 % it may govern the result ({shorter}smaller increments take \
             less)",
            100.0 * share
        )
    })
}

/// Returns what users should know of energies that miss the work by more than increments are chosen for.
fn imbalance(model: &Model, error: f64) -> Option<String> {
    if error <= ENERGY_BUDGET {
        return None;
    }
    let is_equal = |step: &Step| matches!(step.control, StepControl::Fixed { .. });
    let advice = if model.steps.iter().any(is_equal) {
        "; the work of equal increments is a sum of trapezoids, which more of them, or increments that the program chooses \
         (no number), make exact"
    } else {
        ""
    };
    Some(format!(
        "the energies miss the work of the drives by up to {} % of it, more than {} %{advice}",
        significant(100.0 * error, 2),
        100.0 * ENERGY_BUDGET
    ))
}

/// Writer of the increments; decides when a step or the run ends early.
struct Recorder<'p, 'o> {
    program: &'p PulloutProgram,
    settings: &'p SpecimenSettings<'p>,
    observer: &'o mut dyn path::Observer,
    fields: Option<FieldWriter>,
    /// State with which a resumed run goes on, except for the fields.
    state: RecorderState,
}

/// State with which a recorder goes on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct RecorderState {
    pub(super) fields: Option<WrittenFields>,
    peak: PeakKeeper,
    /// `None`: no pictures are wanted.
    moments: Option<Moments>,
    ruptures: IndexMap<String, Rupture>,
    /// What the wires have borne so far.
    borne: Vec<Borne>,
    present: Present,
    energies: Energies,
    /// Cost of finished increments, without calls of plugins and attempts that were given up.
    so_far: Statistics,
    /// The greatest energy error so far.
    energy_error: f64,
    /// Displacement that an initial stress gave the specimen, mm.
    initial_displacement: Option<f64>,
    /// Total time at the start of the present step.
    step_start: f64,
}

/// The last row, and whether it was written.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Present {
    step: u32,
    increment: u32,
    /// Values of the columns, as [`columns::values_of_specimen`] makes them.
    values: Vec<f64>,
    iterations: u32,
    written: bool,
}

impl Present {
    fn row(&self) -> Row<'_> {
        Row { step: self.step, increment: self.increment, values: &self.values, iterations: self.iterations }
    }

    /// The value of a column; 0 of one that is not there.
    fn value(&self, name: &str) -> f64 {
        place_in_specimen(name).map_or(0.0, |place| self.values[place])
    }

    fn time(&self) -> f64 {
        self.value("time")
    }
}

impl<'p, 'o> Recorder<'p, 'o> {
    fn new(
        program: &'p PulloutProgram,
        settings: &'p SpecimenSettings<'p>,
        observer: &'o mut dyn path::Observer,
        fields: Option<FieldWriter>,
    ) -> Self {
        let values = vec![0.0; columns::count_in_specimen(&program.model.measured.fibres)];
        let present = Present { step: 0, increment: 0, values, iterations: 0, written: true };
        let state = RecorderState {
            fields: None,
            peak: PeakKeeper::default(),
            moments: settings.pictures.then(|| Moments::new(&program.pictures_at)),
            ruptures: IndexMap::new(),
            borne: Vec::new(),
            present,
            energies: Energies::default(),
            so_far: Statistics::default(),
            energy_error: 0.0,
            initial_displacement: None,
            step_start: 0.0,
        };
        Self { program, settings, observer, fields, state }
    }

    fn state(&self) -> RecorderState {
        RecorderState { fields: self.fields.as_ref().map(FieldWriter::written), ..self.state.clone() }
    }

    /// Writes the last row and the last fields if they were not due: a run that fails keeps all that it reached.
    fn finish(&mut self, snapshot: &Snapshot<'_>) -> io::Result<()> {
        self.finish_history()?;
        if self.settings.pictures {
            let [slip, load] = ["slip", "load"].map(|name| self.state.present.value(name));
            self.observer.state_reached(slip, load, snapshot, true);
        }
        self.fields.as_mut().map_or(Ok(()), |fields| fields.finish(snapshot))
    }

    fn finish_history(&mut self) -> io::Result<()> {
        if self.state.present.written { Ok(()) } else { self.observer.row(self.state.present.row()) }
    }

    fn directive(&self) -> Directive {
        let step = (self.state.present.step as usize).checked_sub(1);
        let step_until = step.and_then(|step| self.program.step_untils.get(step)).and_then(Option::as_ref);
        let repeats = self.settings.recorded(self.program).is_some();
        let row = self.state.present.row();
        row.directive(self.program.about.until.as_ref(), step_until, repeats, self.observer.ends_here())
    }

    /// Returns whether the present step ends with the present row.
    fn is_at_end_of_step(&self) -> bool {
        if let Some(recorded) = self.settings.recorded(self.program) {
            return recorded.of_step(self.state.present.step).len() == self.state.present.increment as usize;
        }
        let step =
            (self.state.present.step as usize).checked_sub(1).and_then(|step| self.program.model.steps.get(step));
        step.is_some_and(|step| self.state.present.time() >= self.state.step_start + step.time * (1.0 - END_TOLERANCE))
    }

    /// Returns whether the present row is the last of its step or run, or its turn has come.
    fn is_due(&self, directive: Directive, every: usize) -> bool {
        directive != Directive::GoOn
            || self.is_at_end_of_step()
            || (self.state.present.increment as usize).is_multiple_of(every)
    }

    /// Takes an increment down; says how the run goes on.
    fn accept(&mut self, record: &Record) -> io::Result<Directive> {
        if record.step != self.state.present.step {
            self.state.step_start = self.state.present.time();
        }
        self.state.energies = record.energies;
        self.state.energy_error = self.state.energy_error.max(record.energy_error.abs());
        self.state.present = Present {
            step: record.step,
            increment: record.increment,
            values: columns::values_of_specimen(record),
            iterations: u32::try_from(record.iterations.len()).unwrap_or(u32::MAX),
            written: false,
        };
        if record.step == 0 {
            self.state.present.written = true;
            self.observer.row(self.state.present.row())?;
            return Ok(Directive::GoOn);
        }
        let directive = self.directive();
        if self.is_due(directive, self.program.about.every) {
            self.state.present.written = true;
            self.observer.row(self.state.present.row())?;
        }
        self.state.so_far.increments += 1;
        self.state.so_far.iterations += u64::from(self.state.present.iterations);
        self.state.so_far.cutbacks += u64::from(record.cutbacks);
        self.observer.increment_done(self.state.present.row(), self.state.so_far);
        Ok(directive)
    }
}

impl IncrementObserver for Recorder<'_, '_> {
    fn increment(&mut self, record: &Record, snapshot: &Snapshot<'_>) -> io::Result<Directive> {
        if record.step == 0 {
            self.state.initial_displacement = initial_displacement(snapshot);
        }
        if record.step > 0 {
            self.observer.tried(record.step, &record.tried);
        }
        let directive = self.accept(record)?;
        self.state.peak.observe(record, snapshot, self.settings.pictures);
        let number = self.state.so_far.increments;
        let is_moment = self
            .state
            .moments
            .as_mut()
            .is_some_and(|moments| moments.observe(&self.program.pictures_at, number, record, snapshot));
        let measured = &self.program.model.measured;
        let breaks = Rupture::add(
            &mut self.state.ruptures,
            &mut self.state.borne,
            record,
            measured,
            self.program.rupture_strain,
        );
        if breaks {
            // it is the last row
            self.finish_history()?;
            self.state.present.written = true;
        }
        let directive = if breaks { Directive::EndRun } else { directive };
        if self.settings.pictures {
            self.observer.state_reached(record.slip, record.load, snapshot, false);
        }
        if let Some(every) = self.program.fields_every
            && (self.is_due(directive, every) || is_moment)
            && let Some(fields) = &mut self.fields
        {
            fields.write(snapshot)?;
        }
        Ok(directive)
    }

    fn checkpoint(&mut self, checkpoint: &Checkpoint) -> io::Result<()> {
        let Some(folder) = self.settings.folder else { return Ok(()) };
        let saved = Saved { analysis: checkpoint.clone(), recorder: self.state(), observer: self.observer.state() };
        self.settings.checkpoints.write(folder, &saved)
    }
}

/// The greatest displacement, mm, if there is an initial stress and it moved anything but by rounding.
fn initial_displacement(snapshot: &Snapshot<'_>) -> Option<f64> {
    /// Part of the specimen's size.
    const ROUNDING: f64 = 1e-9;
    let model = snapshot.model();
    if !model.has_initial_stress() {
        return None;
    }
    let greatest =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |greatest: f64, value| greatest.max(value.abs()));
    let size = greatest(&mut model.mesh.nodes().iter().flatten().copied());
    let moved = greatest(&mut snapshot.displacements().iter().copied());
    (moved > ROUNDING * size).then_some(moved)
}

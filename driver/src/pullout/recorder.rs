//! Runs a model, and turns its records into rows of the history.

use super::fields::FieldWriter;
use super::{COLUMNS, Program};
use crate::path::program::Until;
use crate::path::{self, Failure, Row, Statistics, Stop};
use fe_core::stepping::{Analysis, Directive, Observer, Record, RunError, Snapshot};
use std::io;
use std::path::Path;

#[cfg(test)]
mod test;

/// Columns before the values of a [`Row`]: step and increment.
const LEADING_COLUMNS: usize = 2;
/// Values of a [`Row`]: the columns but step, increment and iterations.
const VALUES: usize = COLUMNS.len() - LEADING_COLUMNS - 1;
/// A step is at its end within this part of its duration: increments add up with rounding.
const END_TOLERANCE: f64 = 1e-9;

/// Runs a program to its end, to an `until`, or to a failure; fields go to `folder`. Rows that were observed stay valid.
///
/// # Errors
/// [`Stop`]; the statistics tell how far it came.
pub fn run(program: &Program, folder: &Path, observer: &mut dyn path::Observer) -> (Statistics, Result<(), Stop>) {
    let mut analysis = match Analysis::new(&program.model) {
        Ok(analysis) => analysis,
        Err(error) => return (Statistics::default(), Err(failure(1, 1, error.to_string()))),
    };
    let fields = match program.output.fields_every.map(|_| FieldWriter::create(folder, &program.model)).transpose() {
        Ok(fields) => fields,
        Err(error) => return (Statistics::default(), Err(Stop::Write(error))),
    };
    let mut recorder = Recorder::new(program, observer, fields);
    let result = analysis.run(&mut recorder).map_err(|error| match error {
        RunError::Failed { step, increment, .. } => failure(step, increment, error.to_string()),
        RunError::Write(error) => Stop::Write(error),
    });
    let result = recorder.finish().map_err(Stop::Write).and(result);
    let done = analysis.statistics();
    let statistics = Statistics {
        increments: done.increments,
        iterations: done.iterations,
        plugin_calls: analysis.snapshot().solids().counters().umat_calls,
        cutbacks: done.cutbacks,
    };
    (statistics, result)
}

fn failure(step: u32, increment: u32, message: String) -> Stop {
    Stop::Failed(Failure { step, increment, message, replay: serde_json::Value::Null })
}

/// Which increments are written, and when a step or the run ends early.
struct Recorder<'a> {
    program: &'a Program,
    observer: &'a mut dyn path::Observer,
    fields: Option<FieldWriter>,
    present: Present,
    /// Total time at the start of the present step.
    step_start: f64,
}

/// The last row, and whether it was written.
struct Present {
    step: u32,
    increment: u32,
    values: [f64; VALUES],
    iterations: u32,
    written: bool,
}

impl Present {
    fn row(&self) -> Row<'_> {
        Row { step: self.step, increment: self.increment, values: &self.values, iterations: self.iterations }
    }

    fn time(&self) -> f64 {
        self.values[0]
    }

    fn has_reached(&self, until: Option<&Until>) -> bool {
        let place = [f64::from(self.step), f64::from(self.increment)];
        until.is_some_and(|until| until.reached(&place, &self.values, self.iterations))
    }
}

impl<'a> Recorder<'a> {
    fn new(program: &'a Program, observer: &'a mut dyn path::Observer, fields: Option<FieldWriter>) -> Self {
        let present = Present { step: 0, increment: 0, values: [0.0; VALUES], iterations: 0, written: true };
        Self { program, observer, fields, present, step_start: 0.0 }
    }

    /// Writes the last row if it was not due: a run that fails keeps all that it reached.
    fn finish(&mut self) -> io::Result<()> {
        if self.present.written { Ok(()) } else { self.observer.row(self.present.row()) }
    }

    fn directive(&self) -> Directive {
        let step = (self.present.step as usize).checked_sub(1);
        let step_until = step.and_then(|step| self.program.step_untils.get(step)).and_then(Option::as_ref);
        if self.present.has_reached(self.program.until.as_ref()) {
            Directive::EndRun
        } else if self.present.has_reached(step_until) {
            Directive::EndStep
        } else {
            Directive::GoOn
        }
    }

    /// Whether the present step ends with the present row.
    fn is_at_end_of_step(&self) -> bool {
        let step = (self.present.step as usize).checked_sub(1).and_then(|step| self.program.model.steps.get(step));
        step.is_some_and(|step| self.present.time() >= self.step_start + step.time * (1.0 - END_TOLERANCE))
    }

    /// Whether the present row is the last of its step or run, or its turn has come.
    fn is_due(&self, directive: Directive, every: usize) -> bool {
        directive != Directive::GoOn
            || self.is_at_end_of_step()
            || (self.present.increment as usize).is_multiple_of(every)
    }

    /// Takes an increment down; says how the run goes on.
    fn accept(&mut self, record: &Record) -> io::Result<Directive> {
        if record.step != self.present.step {
            self.step_start = self.present.time();
        }
        self.present = Present {
            step: record.step,
            increment: record.increment,
            values: values(record),
            iterations: u32::try_from(record.iterations.len()).unwrap_or(u32::MAX),
            written: false,
        };
        if record.step == 0 {
            self.present.written = true;
            self.observer.row(self.present.row())?;
            return Ok(Directive::GoOn);
        }
        let directive = self.directive();
        if self.is_due(directive, self.program.output.every) {
            self.present.written = true;
            self.observer.row(self.present.row())?;
        }
        self.observer.increment_done(self.present.row());
        Ok(directive)
    }
}

impl Observer for Recorder<'_> {
    fn increment(&mut self, record: &Record, snapshot: &Snapshot<'_>) -> io::Result<Directive> {
        let directive = self.accept(record)?;
        if let Some(every) = self.program.output.fields_every
            && self.is_due(directive, every)
            && let Some(fields) = &mut self.fields
        {
            fields.write(snapshot)?;
        }
        Ok(directive)
    }
}

/// In the order of [`COLUMNS`].
fn values(record: &Record) -> [f64; VALUES] {
    let energies = &record.energies;
    let count = |count: usize| count as f64;
    [
        record.time,
        record.slip,
        record.load,
        record.load_lateral,
        record.slip_exit,
        record.slip_tail,
        energies.external_work,
        energies.elastic,
        energies.plastic,
        energies.damage,
        energies.interface,
        energies.opening,
        energies.stabilisation,
        record.energy_error,
        count(record.counts.damaged),
        count(record.counts.yielding),
        count(record.counts.sticking),
        count(record.counts.slipping),
        count(record.counts.open),
        count(record.counts.released),
        record.greatest_pressure,
        f64::from(record.cutbacks),
    ]
}

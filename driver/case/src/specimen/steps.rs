//! Steps: where the drives go, and how.

use super::boundary::{Boundary, Drives, SLIP};
use crate::document::pullout as document;
use crate::document::pullout::PulloutStep as StepDocument;
use crate::document::{Cycles, PulloutCase};
use crate::problem::Place;
use crate::reader::{Reader, UsedDefaults};
use crate::steps::{self, Counted, Found};
use crate::{fields as field_values, history};
use fe_core::model::{Fields, Measured, Step, StepControl};
use pullout_run::columns;
use pullout_run::program::Until;

/// Default sizes of automatic increments, as fractions of a step.
const INITIAL: f64 = 1e-3;
const MAXIMUM: f64 = 0.02;
const MINIMUM: f64 = 1e-8;

/// A step of the model, and what ends it early.
#[derive(Clone, Debug)]
pub struct ResolvedStep {
    pub step: Step,
    pub until: Option<Until>,
    /// Temperature at its end; `None`: as before.
    pub temperature: Option<f64>,
    /// Field variables at its end; `None`: as before.
    pub predef: Option<Vec<f64>>,
}

impl Counted for ResolvedStep {
    fn increments(&self) -> usize {
        if let StepControl::Fixed { increments } = self.step.control { increments } else { 1 }
    }
}

/// All steps, cycles expanded.
pub fn resolve(reader: &mut Reader<'_>, case: &PulloutCase, boundary: &mut Boundary) -> Vec<ResolvedStep> {
    let place = Place::root().key("steps");
    let columns = columns::of_specimen(&boundary.measured.fibres);
    let Boundary { drives, measured, .. } = boundary;
    let steps = steps::expand(reader, &case.steps, &place, &mut |reader, step, place| match step {
        StepDocument::Ramp(ramp) => Found::Step(Some(one_step(reader, ramp, drives, (&columns, measured), place))),
        StepDocument::Cycle(cycle) => Found::Cycle(cycle),
        StepDocument::Cycles(wrapper) => Found::Cycles(&wrapper.cycles),
    });
    for (name, place) in drives.idle() {
        reader.warn(format!("{}: no step moves the drive '{name}': it stays 0", place.in_words()));
    }
    steps
}

/// Returns how far the grip is pulled, mm.
pub fn greatest_slip(case: &PulloutCase) -> f64 {
    fn of(steps: &[StepDocument]) -> f64 {
        let slips = steps.iter().map(|step| match step {
            StepDocument::Ramp(ramp) => ramp.slip.unwrap_or(0.0),
            StepDocument::Cycle(cycle) | StepDocument::Cycles(Cycles { cycles: cycle }) => of(&cycle.steps),
        });
        slips.fold(0.0, f64::max)
    }
    of(&case.steps)
}

/// Temperature and field variables, as far as anything says something of them.
pub fn fields(reader: &mut Reader<'_>, case: &PulloutCase, steps: &[ResolvedStep]) -> Fields {
    let initial = field_values::initial(&case.course);
    let count = initial.variables.len();
    if let Some(wrong) = steps.iter().filter_map(|step| step.predef.as_ref()).find(|end| end.len() != count) {
        let message =
            format!("a step gives {} field variables, but the case has {count} at the start ($.predef)", wrong.len());
        reader.problem(&Place::root().key("steps"), message);
        return Fields::default();
    }
    let mut now = initial.clone();
    let end = |step: &ResolvedStep| {
        now.temperature = step.temperature.unwrap_or(now.temperature);
        now.variables = step.predef.clone().unwrap_or_else(|| now.variables.clone());
        now.clone()
    };
    let ends: Vec<_> = steps.iter().map(end).collect();
    Fields { initial, ends }
}

fn one_step(
    reader: &mut Reader<'_>,
    ramp: &document::PulloutRamp,
    drives: &mut Drives,
    (columns, measured): (&[String], &Measured),
    place: &Place,
) -> ResolvedStep {
    let mut targets = vec![None; drives.len()];
    let mut named: Vec<(&str, f64, Place)> = Vec::new();
    let of_fibres = drives.of_fibres();
    named.extend(ramp.slip.filter(|_| of_fibres.is_empty()).map(|slip| (SLIP, slip, place.key(SLIP))));
    let given = ramp.drives.iter().flatten();
    named.extend(given.map(|(name, value)| (name.as_str(), *value, place.key("drives").key(name))));
    for (name, value, place) in named {
        match drives.moved(name) {
            Some(index) if targets[index].is_some() => {
                reader.problem(&place, format!("the drive '{name}' is given twice"));
            }
            Some(index) => targets[index] = Some(value),
            None if name == SLIP => {
                reader
                    .problem(&place, "nothing is pulled: the specimen has no grip and no support has the drive 'slip'");
            }
            None => drives.report_unknown(reader, name, &place),
        }
    }
    if let Some(slip) = ramp.slip {
        for index in of_fibres {
            drives.move_one(index);
            targets[index].get_or_insert(slip);
        }
    }

    let place_of_until = place.key("until");
    let until = history::until(reader, ramp.end.until.as_ref(), Some(columns), &place_of_until);
    refuse_unmeasured(reader, until.as_ref(), columns, measured, &place_of_until);
    let mut taken = UsedDefaults::default();
    let time = taken.real("time", ramp.time, 1.0);
    let control = control(reader, ramp.increments, &place.key("increments"), &mut taken);
    // reported once, not for each of many steps
    reader.note_defaults(&Place::root().key("steps"), &taken.0);
    let step = Step { time, targets, control };
    ResolvedStep { step, until, temperature: ramp.end.temperature, predef: ramp.end.predef.clone() }
}

/// Refuses to wait for a column that stays NaN.
pub fn refuse_unmeasured(
    reader: &mut Reader<'_>,
    until: Option<&Until>,
    columns: &[String],
    measured: &Measured,
    place: &Place,
) {
    let Some(name) = until.map(|until| columns[until.column].as_str()) else { return };
    let missing = match name {
        "slip_exit" if measured.exit_node.is_none() && measured.fibres.is_empty() => "$.measure.exit names no node",
        "slip_tail" if measured.tail_node.is_none() && measured.fibres.is_empty() => "$.measure.tail names no node",
        name if name.starts_with("load") && measured.supports.is_empty() => {
            "nothing is gripped and $.measure.load names no support"
        }
        _ => return,
    };
    reader.problem(&place.key("quantity"), format!("'{name}' is nan throughout: {missing}"));
}

fn control(
    reader: &mut Reader<'_>,
    increments: Option<document::StepIncrements>,
    place: &Place,
    taken: &mut UsedDefaults,
) -> StepControl {
    let given = match increments {
        Some(document::StepIncrements::Equal(n)) => return StepControl::Fixed { increments: n.0 },
        Some(document::StepIncrements::Automatic(sizes)) => sizes,
        None => document::AutomaticIncrements::default(),
    };
    let [initial, maximum, minimum] = [given.initial, given.maximum, given.minimum].map(|size| size.map(|size| size.0));
    let maximum = taken.real("increments.maximum", maximum, MAXIMUM.max(initial.unwrap_or(0.0)));
    let initial = taken.real("increments.initial", initial, INITIAL.min(maximum));
    let minimum = taken.real("increments.minimum", minimum, MINIMUM.min(initial));
    if initial > maximum {
        reader.problem(&place.key("initial"), format!("{initial} is greater than the maximum, {maximum}"));
    }
    if minimum > initial {
        reader.problem(&place.key("minimum"), format!("{minimum} is greater than the initial increment, {initial}"));
    }
    StepControl::Automatic { initial, maximum, minimum }
}

//! Makes the steps of a case from the prescribed quantities in the steps of a job.

use super::element::Brick;
use super::model::{Amplitude, Change, Model, Quantity, Step};
use super::schedule::{Fields, Row, Schedule};
use super::uniform::{Course, Loading, SAME, Target, Values};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Most rows of a table.
const MOST_ROWS: f64 = 100_000.0;

/// Loading of the point.
pub(super) struct Evolution {
    pub(super) steps: Vec<Value>,
    pub(super) nlgeom: bool,
    pub(super) left_out: Vec<String>,
    /// Shear strains that are held at 0 though nodes are free to shear the element.
    pub(super) loose_shears: BTreeSet<&'static str>,
}

/// Amplitudes that are used, by name.
type Amplitudes<'m> = BTreeMap<String, &'m Amplitude>;

/// Duration of a step, and how values without an amplitude reach their end.
#[derive(Clone, Copy, Debug)]
struct Span {
    /// Total time at its start.
    start: f64,
    duration: f64,
    /// They jump at its start.
    at_once: bool,
}

impl Evolution {
    /// Makes an evolution from all steps. `has_thickness`: whether nominal stresses can be known.
    ///
    /// # Errors
    /// Displacements or loads that are not those of a uniform state, with the place of one of them.
    pub(super) fn of(model: &Model, brick: &Brick, has_thickness: bool) -> Result<Self, String> {
        let nlgeom = has_thickness && model.steps.iter().any(|step| step.nlgeom == Some(true));
        let mut left_out = Vec::new();
        omissions_of_nlgeom(model, nlgeom, &mut left_out);
        let held = |change: &Change| (change.quantity, Course { from: Some(0.0), change: change.clone() });
        let mut courses: BTreeMap<Quantity, Course> = model.fixed.iter().map(held).collect();
        let mut loading = Loading::new(model, brick, nlgeom);
        let mut schedule = Schedule::new(model, nlgeom);
        let mut start = 0.0;
        for (number, step) in model.steps.iter().enumerate() {
            if !step.has_procedure {
                return Err(format!("{}: a step without *STATIC", step.place));
            }
            begin(&mut courses, step, number == 0, |quantity| model.initial.of(quantity));
            let amplitudes = amplitudes(model, &courses)?;
            let span = Span { start, duration: step.time, at_once: step.at_once };
            let is_driven = span.at_once || !amplitudes.is_empty();
            let mut end_of = |time: f64| -> Result<(Target, Fields), String> {
                let values = values_at(&courses, time, &span, &amplitudes);
                let fields = Fields::of(&values, model, step)?;
                Ok((loading.target(&values)?, fields))
            };
            if is_driven {
                let times = ends(step)?;
                let mut rows_at = || -> Result<Vec<Row>, String> {
                    let row = |time: &f64| end_of(*time).map(|(target, fields)| Row { time: *time, target, fields });
                    times.iter().map(row).collect()
                };
                let mut rows = rows_at()?;
                let has_gradient = |row: &Row| row.target.gradient.is_some();
                if rows.iter().any(has_gradient) && !rows.iter().all(has_gradient) {
                    // once the element has turned, all have one
                    rows = rows_at()?;
                }
                let is_relative = |quantity: &Quantity| {
                    let course = &courses[quantity];
                    course.from.is_none() && course.change.amplitude.is_none() && !span.at_once
                };
                let relative: BTreeSet<usize> = courses
                    .keys()
                    .filter_map(|quantity| match *quantity {
                        Quantity::Displacement(_, axis) if is_relative(quantity) => Some(axis),
                        _ => None,
                    })
                    .collect();
                schedule.driven(step, &rows, &relative)?;
            } else {
                let (target, fields) = end_of(step.time)?;
                let times = if is_even(step) { Vec::new() } else { ends(step)? };
                schedule.ramped(step, &Row { time: step.time, target, fields }, increments(step), &times)?;
            }
            for course in courses.values_mut() {
                course.end(&span, &amplitudes);
            }
            start += step.time;
        }
        left_out.extend(loading.left_out);
        left_out.extend(schedule.left_out);
        Ok(Self { steps: schedule.steps, nlgeom, left_out, loose_shears: loading.loose_shears })
    }
}

/// Lists what large deformations of the job are not those of the case.
fn omissions_of_nlgeom(model: &Model, nlgeom: bool, left_out: &mut Vec<String>) {
    if let Some(step) = model.steps.iter().find(|step| step.nlgeom == Some(true) && !nlgeom) {
        let message = "NLGEOM in plane stress: nominal stresses need a thickness strain, which a UMAT does not report: the case has small strains. A 3-D element (C3D8, free faces) has the same stresses";
        left_out.push(format!("{}: {message}", step.place));
    }
    if !nlgeom {
        return;
    }
    let mut changes = model.steps.iter().flat_map(|step| &step.changes);
    let is_pressure = |change: &&Change| matches!(change.quantity, Quantity::Pressure { .. }) && change.value != 0.0;
    if let Some(change) = changes.find(is_pressure) {
        let message = "a pressure on the deformed area: the case has it on the initial area";
        left_out.push(format!("{}: {message}", change.place));
    }
    let mut is_large = false;
    for step in &model.steps {
        is_large = step.nlgeom.unwrap_or(is_large);
        if !is_large {
            let message = "a step without NLGEOM: it gets large deformations like the others";
            left_out.push(format!("{}: {message}", step.place));
        }
    }
}

impl Course {
    /// Returns the value at a time within a step.
    fn at(&self, time: f64, span: &Span, amplitudes: &Amplitudes<'_>) -> f64 {
        let change = &self.change;
        match change.amplitude.as_ref().and_then(|name| amplitudes.get(name)) {
            Some(amplitude) => {
                let time = if amplitude.of_total_time { span.start + time } else { time };
                change.value * factor(&amplitude.points, time)
            }
            None if span.at_once => change.value,
            None => {
                let from = self.from.unwrap_or(0.0);
                from + (change.value - from) * time / span.duration
            }
        }
    }

    /// Ends a step. An amplitude over the total time goes on; other values stay as they are.
    fn end(&mut self, span: &Span, amplitudes: &Amplitudes<'_>) {
        let value = self.at(span.duration, span, amplitudes);
        self.from = Some(value);
        let goes_on = |name: &String| amplitudes.get(name).is_some_and(|amplitude| amplitude.of_total_time);
        if !self.change.amplitude.as_ref().is_some_and(goes_on) {
            (self.change.value, self.change.amplitude) = (value, None);
        }
    }
}

/// Values of all quantities at a time within a step.
fn values_at<'c>(
    courses: &'c BTreeMap<Quantity, Course>,
    time: f64,
    span: &Span,
    amplitudes: &Amplitudes<'_>,
) -> Values<'c> {
    let value =
        |(quantity, course): (&Quantity, &'c Course)| (*quantity, (course.at(time, span, amplitudes), &course.change));
    courses.iter().map(value).collect()
}

/// Linear between the points, constant beyond them.
fn factor(points: &[(f64, f64)], time: f64) -> f64 {
    let after = points.partition_point(|(at, _)| *at < time);
    match (after.checked_sub(1).map(|before| points[before]), points.get(after)) {
        (Some((t0, a0)), Some((t1, a1))) => a0 + (a1 - a0) * (time - t0) / (t1 - t0),
        (Some((_, end)), None) => end,
        (None, Some((_, first))) => *first,
        (None, None) => 0.0,
    }
}

/// Number of increments of a step: all as long as the first one, except for the last.
fn increments(step: &Step) -> f64 {
    // a quotient that is a whole number up to rounding
    (step.time / step.increment - SAME).ceil().max(1.0)
}

fn is_even(step: &Step) -> bool {
    (increments(step) * step.increment - step.time).abs() <= SAME * step.time
}

/// The times at which the increments of a step end.
fn ends(step: &Step) -> Result<Vec<f64>, String> {
    let count = increments(step);
    if count > MOST_ROWS {
        return Err(format!("{}: {count} increments are more than the {MOST_ROWS} rows of a table", step.place));
    }
    let end = |k: u64| if is_even(step) { step.time * k as f64 / count } else { step.increment * k as f64 };
    Ok((1..count as u64).map(end).chain([step.time]).collect())
}

/// Lets the changes of a step replace what there was. Loads and fields that OP=NEW takes away go back to where they began.
fn begin(courses: &mut BTreeMap<Quantity, Course>, step: &Step, is_first: bool, initial: impl Fn(Quantity) -> f64) {
    let before: BTreeMap<Quantity, f64> =
        courses.iter().filter_map(|(quantity, course)| Some((*quantity, course.from?))).collect();
    courses.retain(|quantity, course| {
        if !step.anew.contains(quantity.keyword()) {
            return true;
        }
        (course.change.value, course.change.amplitude) = (initial(*quantity), None);
        !matches!(quantity, Quantity::Displacement(..))
    });
    for change in &step.changes {
        let quantity = change.quantity;
        // a node that was free may be anywhere
        let is_known = is_first || !matches!(quantity, Quantity::Displacement(..));
        let from = before.get(&quantity).copied().or_else(|| is_known.then(|| initial(quantity)));
        courses.insert(quantity, Course { from, change: change.clone() });
    }
}

/// The amplitudes that are used.
fn amplitudes<'m>(model: &'m Model, courses: &BTreeMap<Quantity, Course>) -> Result<Amplitudes<'m>, String> {
    let mut used = BTreeMap::new();
    for change in courses.values().map(|course| &course.change) {
        let Some(name) = &change.amplitude else { continue };
        let found = model.amplitudes.get(name);
        let amplitude = found.ok_or_else(|| format!("{}: there is no amplitude {name}", change.place))?;
        if let Some(refusal) = &amplitude.refusal {
            return Err(format!("{refusal} cannot be imported"));
        }
        used.insert(name.clone(), amplitude);
    }
    Ok(used)
}

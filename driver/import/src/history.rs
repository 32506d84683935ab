//! Makes the steps of a case from the prescribed quantities in the steps of a job.

use super::element::Brick;
use super::keywords::LinePosition;
use super::model::{Amplitude, Change, Model, Quantity, Step};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

const STRAINS: [&str; 3] = ["e11", "e22", "e33"];
const STRESSES: [&str; 3] = ["s11", "s22", "s33"];
/// Shear strains and the two axes of each.
const SHEARS: [(&str, usize, usize); 3] = [("g12", 0, 1), ("g13", 0, 2), ("g23", 1, 2)];
/// Relative difference of values that are the same.
const SAME: f64 = 1e-6;

/// Loading of the point.
pub(super) struct Evolution {
    pub(super) steps: Vec<Value>,
    pub(super) nlgeom: bool,
    pub(super) left_out: Vec<String>,
}

/// A quantity from the start of a step to its end.
#[derive(Clone, Debug)]
struct Course {
    from: f64,
    change: Change,
}

/// Values of all quantities at some time.
type Values<'c> = BTreeMap<Quantity, (f64, &'c Change)>;

impl Evolution {
    /// Makes an evolution from all steps. `has_thickness`: whether nominal stresses can be known.
    ///
    /// # Errors
    /// Displacements or loads that are not those of a uniform state, with the place of one of them.
    pub(super) fn of(model: &Model, brick: &Brick, has_thickness: bool) -> Result<Self, String> {
        let mut evolution = Self { steps: Vec::new(), nlgeom: false, left_out: Vec::new() };
        if let Some(step) = model.steps.iter().find(|step| step.nlgeom == Some(true)) {
            evolution.nlgeom = has_thickness;
            if !has_thickness {
                let message = "NLGEOM in plane stress: nominal stresses need a thickness strain, which a UMAT does not report: the case has small strains. A 3-D element (C3D8, free faces) has the same stresses";
                evolution.left_out.push(format!("{}: {message}", step.place));
            }
        }
        let changes = model.steps.iter().flat_map(|step| &step.changes);
        let mut pressures =
            changes.filter(|change| matches!(change.quantity, Quantity::Pressure(_)) && change.value != 0.0);
        if let Some(change) = pressures.next().filter(|_| evolution.nlgeom) {
            let message = "a pressure on the deformed area: the case has it on the initial area";
            evolution.left_out.push(format!("{}: {message}", change.place));
        }
        let held = |change: &Change| (change.quantity, Course { from: 0.0, change: change.clone() });
        let mut courses: BTreeMap<Quantity, Course> = model.fixed.iter().map(held).collect();
        let mut start = 0.0;
        let mut fields = model.initial.fields.clone();
        let mut temperature = model.initial.temperature.unwrap_or(0.0);
        let mut is_large = false;
        for step in &model.steps {
            if !step.has_procedure {
                return Err(format!("{}: a step without *STATIC", step.place));
            }
            is_large = step.nlgeom.unwrap_or(is_large);
            if evolution.nlgeom && !is_large {
                let message = "a step without NLGEOM: it gets large deformations like the others";
                evolution.left_out.push(format!("{}: {message}", step.place));
            }
            let initial = |quantity: Quantity| match quantity {
                Quantity::Temperature => temperature,
                Quantity::Field(index) => fields.get(index).copied().unwrap_or(0.0),
                _ => 0.0,
            };
            begin(&mut courses, step, initial);
            let amplitudes = amplitudes(model, &courses)?;
            let times = breakpoints(&amplitudes, step.time, start);
            if times.len() > 1 {
                evolution.left_out.push(format!(
                    "{}: the step as a single one: it becomes {} steps, one for each straight piece of its amplitudes. From here on, KSTEP, KINC and TIME(1) differ from those of the job",
                    step.place,
                    times.len()
                ));
            }
            let mut before = 0.0;
            for time in times {
                let values: Values<'_> = courses
                    .iter()
                    .map(|(quantity, course)| {
                        (*quantity, (course.at(time, step.time, start, &amplitudes), &course.change))
                    })
                    .collect();
                // a quotient that is a whole number up to rounding
                let increments = ((time - before) / step.increment - SAME).ceil().max(1.0);
                let mut ramp = json!({ "increments": increments as u64, "time": time - before });
                evolution.target(&values, brick, model, &mut ramp)?;
                for (quantity, (value, _)) in &values {
                    match *quantity {
                        Quantity::Temperature => temperature = *value,
                        Quantity::Field(index) if index < fields.len() => fields[index] = *value,
                        Quantity::Field(_) => {
                            return Err(format!("{}: a field variable without an initial value", step.place));
                        }
                        _ => {}
                    }
                }
                if values.contains_key(&Quantity::Temperature) {
                    ramp["temperature"] = json!(temperature);
                }
                if !fields.is_empty() {
                    ramp["predef"] = json!(fields);
                }
                evolution.steps.push(ramp);
                before = time;
            }
            for course in courses.values_mut() {
                course.from = course.at(step.time, step.time, start, &amplitudes);
                (course.change.value, course.change.amplitude) = (course.from, None);
            }
            start += step.time;
        }
        if evolution.steps.is_empty() {
            return Err("has no step".into());
        }
        Ok(evolution)
    }

    /// Strains and stresses at the end of a ramp.
    fn target(&mut self, values: &Values<'_>, brick: &Brick, model: &Model, ramp: &mut Value) -> Result<(), String> {
        let dimensions = brick.shape.dimensions;
        let mut gradient = [[None; 3]; 3];
        for axis in 0..dimensions {
            gradient[axis] = displacement_gradient(values, brick, model, axis)?;
            if let Some(place) = partly_driven(values, brick, model, axis, &gradient[axis]) {
                let message =
                    "a displacement of only some nodes of a face: the case has uniform strain, as if all nodes had it";
                let omission = format!("{place}: {message}");
                if !self.left_out.contains(&omission) {
                    self.left_out.push(omission);
                }
            }
        }
        let stresses = stresses(values, brick, model)?;
        let shears = SHEARS.iter().filter(|(_, i, j)| *i < dimensions && *j < dimensions);
        let is_sheared =
            shears.clone().any(|&(_, i, j)| [gradient[i][j], gradient[j][i]].iter().flatten().any(|x| *x != 0.0));
        let mut hoop = None;
        if brick.is_axisymmetric() {
            hoop = hoop_strain(values, brick, model, gradient[0][0])?;
        }
        if self.nlgeom && is_sheared {
            let place = first_place(values).unwrap_or_default();
            let refusal =
                || format!("{place}: a shear at large deformations with free displacements: its rotation is not known");
            let mut rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            for i in 0..dimensions {
                for j in 0..dimensions {
                    rows[i][j] += gradient[i][j].ok_or_else(refusal)?;
                }
            }
            if brick.is_axisymmetric() {
                rows[2][2] += hoop.ok_or_else(refusal)?;
            }
            ramp["F"] = json!(rows);
            return Ok(());
        }
        let in_plane = (0..dimensions).map(|axis| (axis, gradient[axis][axis], stresses[axis]));
        let around = brick.is_axisymmetric().then_some((2, hoop, stresses[0]));
        let mut target = json!({});
        for (axis, strain, stress) in in_plane.chain(around) {
            match strain {
                Some(strain) => target[STRAINS[axis]] = json!(strain),
                None if stress != 0.0 => target[STRESSES[axis]] = json!(stress),
                None => {}
            }
        }
        for (name, i, j) in shears {
            // a free one of the two turns the element instead; + 0.0: of two negative zeros none is made
            if let (Some(a), Some(b)) = (gradient[*i][*j], gradient[*j][*i]) {
                target[*name] = json!(a + b + 0.0);
            }
        }
        ramp["target"] = target;
        Ok(())
    }
}

impl Course {
    /// Returns the value at a time within a step, given the step's duration and its start in total time.
    fn at(&self, time: f64, duration: f64, start: f64, amplitudes: &BTreeMap<String, &Amplitude>) -> f64 {
        match self.change.amplitude.as_ref().and_then(|name| amplitudes.get(name)) {
            Some(amplitude) => {
                let time = if amplitude.of_total_time { start + time } else { time };
                self.change.value * factor(&amplitude.points, time)
            }
            None => self.from + (self.change.value - self.from) * time / duration,
        }
    }
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

/// Lets the changes of a step replace what there was. Loads that OP=NEW takes away go back to 0.
fn begin(courses: &mut BTreeMap<Quantity, Course>, step: &Step, initial: impl Fn(Quantity) -> f64) {
    courses.retain(|quantity, course| {
        if !step.anew.contains(quantity.keyword()) {
            return true;
        }
        course.change.value = initial(*quantity);
        !matches!(quantity, Quantity::Displacement(..))
    });
    for change in &step.changes {
        let from = courses.get(&change.quantity).map_or_else(|| initial(change.quantity), |course| course.from);
        courses.insert(change.quantity, Course { from, change: change.clone() });
    }
}

/// The amplitudes that are used.
fn amplitudes<'m>(
    model: &'m Model,
    courses: &BTreeMap<Quantity, Course>,
) -> Result<BTreeMap<String, &'m Amplitude>, String> {
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

/// The times of a step at which a ramp ends: where an amplitude bends, and the end.
fn breakpoints(amplitudes: &BTreeMap<String, &Amplitude>, duration: f64, start: f64) -> Vec<f64> {
    let mut times: Vec<f64> = amplitudes
        .values()
        .flat_map(|amplitude| {
            let offset = if amplitude.of_total_time { start } else { 0.0 };
            amplitude.points.iter().map(move |(time, _)| time - offset)
        })
        .filter(|time| *time > SAME * duration && *time < (1.0 - SAME) * duration)
        .collect();
    times.push(duration);
    times.sort_by(f64::total_cmp);
    times.dedup_by(|a, b| (*a - *b).abs() <= SAME * duration);
    times
}

fn first_place(values: &Values<'_>) -> Option<String> {
    values.values().next().map(|(_, change)| change.place.to_string())
}

/// The displacements along an axis that nodes of the element have prescribed: node, value, place.
fn displacements<'v>(
    values: &'v Values<'_>,
    model: &'v Model,
    axis: usize,
) -> impl Iterator<Item = (usize, f64, &'v LinePosition)> {
    values.iter().filter_map(move |(quantity, (value, change))| match *quantity {
        Quantity::Displacement(node, along) if along == axis => {
            Some((model.node_in_element(node)?, *value, &change.place))
        }
        _ => None,
    })
}

/// Returns what the displacements along an axis say of their gradient.
fn displacement_gradient(
    values: &Values<'_>,
    brick: &Brick,
    model: &Model,
    axis: usize,
) -> Result<[Option<f64>; 3], String> {
    let prescribed: Vec<(usize, f64)> =
        displacements(values, model, axis).map(|(node, value, _)| (node, value)).collect();
    brick.gradient(&prescribed).map_err(|()| match displacements(values, model, axis).last() {
        Some((.., place)) => format!("{place}: the displacements along {} are those of no uniform strain", axis + 1),
        None => "the displacements are those of no uniform strain".into(),
    })
}

/// Finds a face of which some nodes, but not all, have a displacement along an axis prescribed that makes a strain; returns
/// where one of these is prescribed.
fn partly_driven<'v>(
    values: &'v Values<'_>,
    brick: &Brick,
    model: &'v Model,
    axis: usize,
    gradient: &[Option<f64>; 3],
) -> Option<&'v LinePosition> {
    let prescribed: BTreeMap<usize, &LinePosition> =
        displacements(values, model, axis).map(|(node, _, place)| (node, place)).collect();
    let makes_strain = |normal: &usize| gradient[*normal].is_some_and(|strain| *normal == axis || strain != 0.0);
    let faces = (0..brick.shape.dimensions).filter(makes_strain).flat_map(|normal| [(normal, 0.0), (normal, 1.0)]);
    faces.into_iter().find_map(|(normal, share)| {
        let nodes = (0..brick.nodes.len()).filter(|&node| brick.nodes[node][normal] == share);
        let (with, without): (Vec<usize>, Vec<usize>) = nodes.partition(|node| prescribed.contains_key(node));
        let first = with.first().filter(|_| !without.is_empty())?;
        prescribed.get(first).copied()
    })
}

/// u/r, where displacements prescribe it.
fn hoop_strain(values: &Values<'_>, brick: &Brick, model: &Model, radial: Option<f64>) -> Result<Option<f64>, String> {
    if brick.origin[0].abs() <= SAME * brick.edges[0] {
        return Ok(radial);
    }
    let mut strains = Vec::new();
    let mut sides = BTreeSet::new();
    for (node, value, _) in displacements(values, model, 0) {
        let share = brick.nodes[node][0];
        strains.push(value / (brick.origin[0] + share * brick.edges[0]));
        sides.insert(share > 0.5);
    }
    let is_uniform = |radial: f64| strains.iter().all(|strain| (strain - radial).abs() <= SAME * radial.abs());
    match radial {
        Some(radial) if sides.len() > 1 && is_uniform(radial) => Ok(Some(radial)),
        _ => {
            let place = first_place(values).unwrap_or_default();
            Err(format!("{place}: an axisymmetric element off the axis is strained uniformly only by u = k r"))
        }
    }
}

/// Normal stresses of the loads on the faces.
fn stresses(values: &Values<'_>, brick: &Brick, model: &Model) -> Result<[f64; 3], String> {
    // of each axis: of its near and its far face
    let mut tractions: BTreeMap<usize, BTreeMap<bool, f64>> = BTreeMap::new();
    let mut forces: BTreeMap<(usize, bool), Vec<f64>> = BTreeMap::new();
    let mut places = BTreeMap::new();
    for (quantity, (value, change)) in values {
        let place = &change.place;
        match *quantity {
            Quantity::Pressure(face) => {
                let normal = brick.normal(face).ok_or_else(|| format!("{place}: there is no face {face}"))?;
                let (axis, is_far) = normal;
                *tractions.entry(axis).or_default().entry(is_far).or_insert(0.0) -= value;
                places.insert(axis, place);
            }
            Quantity::Force(node, axis) => {
                let Some(node) = model.node_in_element(node) else { continue };
                if brick.is_axisymmetric() || brick.shape.nodes > brick.shape.corners || axis >= brick.shape.dimensions
                {
                    return Err(format!("{place}: forces at nodes of such an element cannot be imported: use *DSLOAD"));
                }
                forces.entry((axis, brick.nodes[node][axis] > 0.5)).or_default().push(*value);
                places.insert(axis, place);
            }
            _ => {}
        }
    }
    for ((axis, is_far), forces) in forces {
        let place = places[&axis];
        let is_even = forces.iter().all(|force| (force - forces[0]).abs() <= SAME * forces[0].abs());
        let is_zero = forces.iter().all(|force| *force == 0.0);
        if !is_zero && (forces.len() != brick.shape.corners / 2 || !is_even) {
            return Err(format!("{place}: forces that are not the same at all nodes of a face make no uniform stress"));
        }
        let outward = if is_far { 1.0 } else { -1.0 };
        let traction = outward * forces.iter().sum::<f64>() / brick.area(axis);
        *tractions.entry(axis).or_default().entry(is_far).or_insert(0.0) += traction;
    }
    let mut stresses = [0.0; 3];
    for (axis, sides) in tractions {
        let values: Vec<_> = sides.values().copied().collect();
        if values.iter().any(|value| (value - values[0]).abs() > SAME * values[0].abs()) {
            return Err(format!("{}: different loads on opposite faces make no uniform stress", places[&axis]));
        }
        stresses[axis] = values[0];
    }
    Ok(stresses)
}

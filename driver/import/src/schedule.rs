//! Divides the steps of a job into ramps, tables and steps of one deformation gradient.

use super::model::{Model, Quantity, Step};
use super::uniform::{Control, Matrix, SAME, STRAINS, STRESSES, Target, Values, axes_of};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// Temperature and field variables at some time.
#[derive(Clone, Debug)]
pub(super) struct Fields {
    /// `None`: no step changes it.
    temperature: Option<f64>,
    variables: Vec<f64>,
}

impl Fields {
    /// Takes the fields from the values of all quantities.
    ///
    /// # Errors
    /// A field variable has no initial value.
    pub(super) fn of(values: &Values<'_>, model: &Model, step: &Step) -> Result<Self, String> {
        let mut fields = Self { temperature: None, variables: model.initial.fields.clone() };
        for (quantity, (value, _)) in values {
            match *quantity {
                Quantity::Temperature => fields.temperature = Some(*value),
                Quantity::Field(index) => {
                    let variable = fields.variables.get_mut(index);
                    *variable.ok_or_else(|| format!("{}: a field variable without an initial value", step.place))? =
                        *value;
                }
                _ => {}
            }
        }
        Ok(fields)
    }

    fn numbers(&self) -> Vec<f64> {
        self.temperature.iter().chain(&self.variables).copied().collect()
    }

    fn put_into(&self, ramp: &mut Value) {
        if let Some(temperature) = self.temperature {
            ramp["temperature"] = json!(temperature);
        }
        if !self.variables.is_empty() {
            ramp["predef"] = json!(self.variables);
        }
    }
}

/// What is prescribed at the end of an increment.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// Time in the step.
    pub(super) time: f64,
    pub(super) target: Target,
    pub(super) fields: Fields,
}

/// How a component goes through a step.
struct Way {
    /// Value at the start, if the case determines it.
    start: Option<f64>,
    /// Linear in time from wherever the component is.
    is_ramp: bool,
    /// It leaves an unknown value along a line.
    is_from_anywhere: bool,
}

/// Steps of the case as made so far.
pub(super) struct Schedule {
    pub(super) steps: Vec<Value>,
    pub(super) left_out: Vec<String>,
    present: [Option<Control>; 6],
    /// Deformation gradient, if it is known.
    gradient: Option<Matrix>,
    temperature: f64,
    fields: Vec<f64>,
    has_initial_stress: bool,
}

impl Schedule {
    pub(super) fn new(model: &Model, nlgeom: bool) -> Self {
        let mut identity = [[0.0; 3]; 3];
        (0..3).for_each(|axis| identity[axis][axis] = 1.0);
        Self {
            steps: Vec::new(),
            left_out: Vec::new(),
            present: [None; 6],
            gradient: nlgeom.then_some(identity),
            temperature: model.initial.of(Quantity::Temperature),
            fields: model.initial.fields.clone(),
            has_initial_stress: !model.initial.stress.is_empty(),
        }
    }

    /// Adds a step whose values are linear in time. `times`: ends of its increments, if these are not equally long.
    pub(super) fn ramped(&mut self, step: &Step, end: &Row, increments: f64, times: &[f64]) -> Result<(), String> {
        let is_gradient = end.target.gradient.is_some();
        if times.is_empty() || (is_gradient && self.gradient.is_none()) {
            if !times.is_empty() {
                self.left_out.push(format!(
                    "{}: increments of {}: the case has {increments} of the same length",
                    step.place, step.increment
                ));
            }
            let mut ramp = json!({ "increments": increments as u64, "time": step.time });
            end.target.put_into(&mut ramp);
            end.fields.put_into(&mut ramp);
            self.steps.push(ramp);
            self.end(end);
            return Ok(());
        }
        let rows: Vec<Row> = times.iter().map(|time| self.between(end, *time)).collect();
        if is_gradient {
            self.pieces(step, &rows);
            return Ok(());
        }
        let ways: [Way; 6] = std::array::from_fn(|i| {
            let start = self.start(i, end);
            Way { start, is_ramp: true, is_from_anywhere: start.is_none() }
        });
        self.table(step, &rows, &ways);
        Ok(())
    }

    /// Adds a step whose values at the ends of all increments are given. `relative`: axes along which nodes leave an unknown
    /// displacement along a line.
    ///
    /// # Errors
    /// The way of a component depends on where it is, which an import cannot know.
    pub(super) fn driven(&mut self, step: &Step, rows: &[Row], relative: &BTreeSet<usize>) -> Result<(), String> {
        let Some(end) = rows.last() else { return Ok(()) };
        let refusal = |name: &str| {
            format!(
                "{}: {name} starts from a value that is not known and does not go straight to its end: split the step",
                step.place
            )
        };
        if rows.iter().any(|row| row.target.gradient.is_some()) {
            if self.gradient.is_none() && !relative.is_empty() {
                return Err(refusal("a displacement"));
            }
            self.pieces(step, rows);
            return Ok(());
        }
        let mut ways = Vec::new();
        for i in 0..6 {
            let start = self.start(i, end);
            let is_strain = matches!(end.target.controls[i], Some(Control::Strain(_)));
            let is_from_anywhere = start.is_none()
                && if is_strain { axes_of(i).iter().any(|axis| relative.contains(axis)) } else { !step.at_once };
            let values = |row: &Row| row.target.controls[i].map_or(0.0, Control::value);
            let is_linear = is_linear(rows, start.unwrap_or(0.0), values);
            if is_from_anywhere && !is_linear {
                return Err(refusal(end.target.controls[i].map_or("", |control| control.name(i))));
            }
            ways.push(Way { start, is_ramp: is_linear && (start.is_some() || is_from_anywhere), is_from_anywhere });
        }
        let before =
            Fields { temperature: end.fields.temperature.map(|_| self.temperature), variables: self.fields.clone() };
        let is_ramp = |k: usize| is_linear(rows, before.numbers()[k], |row| row.fields.numbers()[k]);
        let exists = |i: usize| end.target.controls[i].is_some();
        let all_ramp = (0..6).all(|i| !exists(i) || ways[i].is_ramp) && (0..before.numbers().len()).all(is_ramp);
        if all_ramp && equally_long(rows) {
            return self.ramped(step, end, rows.len() as f64, &[]);
        }
        self.table(step, rows, &ways);
        Ok(())
    }

    /// Value of a component at the start, if the case determines it.
    fn start(&self, component: usize, end: &Row) -> Option<f64> {
        let is_first = self.steps.is_empty();
        match (end.target.controls[component], self.present[component]) {
            (Some(Control::Strain(_)), Some(Control::Strain(value)))
            | (Some(Control::Stress(_)), Some(Control::Stress(value))) => Some(value),
            (Some(Control::Strain(_)), _) if is_first => Some(0.0),
            (Some(Control::Stress(_)), _) if is_first && !self.has_initial_stress => Some(0.0),
            _ => None,
        }
    }

    /// Returns what is prescribed at a time on the line to the end of a step.
    fn between(&self, end: &Row, time: f64) -> Row {
        let share = time / end.time;
        let lerp = |from: f64, to: f64| from + (to - from) * share;
        let mut row = Row { time, ..end.clone() };
        for (i, control) in row.target.controls.iter_mut().enumerate() {
            let start = self.start(i, end).unwrap_or(0.0);
            *control = control.map(|control| control.with(lerp(start, control.value())));
        }
        if let (Some(to), Some(from)) = (&mut row.target.gradient, &self.gradient) {
            to.iter_mut().flatten().zip(from.iter().flatten()).for_each(|(to, from)| *to = lerp(*from, *to));
        }
        row.fields.temperature = row.fields.temperature.map(|to| lerp(self.temperature, to));
        row.fields.variables.iter_mut().zip(&self.fields).for_each(|(to, from)| *to = lerp(*from, *to));
        row
    }

    /// Adds a table: one row for each increment.
    fn table(&mut self, step: &Step, rows: &[Row], ways: &[Way]) {
        let Some(end) = rows.last() else { return };
        let mut columns = Map::new();
        let mut column = |name: &str, values: &dyn Fn(&Row) -> f64| {
            columns.insert(name.to_owned(), rows.iter().map(|row| json!(values(row) + 0.0)).collect());
        };
        column("time", &|row| row.time);
        let mut constraints = Vec::new();
        let mut free = None;
        let mut count = 0;
        for (i, way) in ways.iter().enumerate() {
            let Some(control) = end.target.controls[i] else { continue };
            let name = control.name(i);
            let values = |row: &Row| row.target.controls[i].map_or(0.0, Control::value);
            let is_strain = matches!(control, Control::Strain(_));
            if way.is_from_anywhere {
                constraints.push(json!({ name: 1.0, "equals": control.value() }));
            } else if is_strain
                || way.start.is_some_and(|start| start != 0.0)
                || rows.iter().any(|row| values(row) != 0.0)
            {
                column(name, &values);
                count += 1;
            } else {
                free = free.or(Some(name));
            }
        }
        // a table needs a component: one that is free keeps its stress of 0
        if let Some(name) = free.filter(|_| count == 0) {
            column(name, &|_| 0.0);
        }
        if end.fields.temperature.is_some() {
            column("temperature", &|row| row.fields.temperature.unwrap_or(0.0));
        }
        for index in 0..end.fields.variables.len() {
            column(&format!("predef{}", index + 1), &|row| row.fields.variables[index]);
        }
        let mut table = json!({ "table": columns });
        if !constraints.is_empty() {
            table["constraints"] = json!(constraints);
            if !equally_long(rows) {
                self.left_out.push(format!(
                    "{}: a line in time from a value that is not known: it is one over the increments, which are not \
                     equally long",
                    step.place
                ));
            }
        }
        self.steps.push(table);
        self.end(end);
    }

    /// Adds steps of deformation gradients: one for each straight piece.
    fn pieces(&mut self, step: &Step, rows: &[Row]) {
        let Some(end) = rows.last() else { return };
        let numbers = |row: &Row| -> Vec<f64> {
            let gradient = row.target.gradient.unwrap_or_default();
            gradient.into_iter().flatten().chain(row.fields.numbers()).collect()
        };
        let mut before = self.gradient.map(|gradient| {
            let temperature = end.fields.temperature.map(|_| self.temperature);
            let fields = Fields { temperature, variables: self.fields.clone() };
            gradient.into_iter().flatten().chain(fields.numbers()).collect::<Vec<f64>>()
        });
        let (mut first, mut start, mut count) = (0, 0.0, 0);
        while first < rows.len() {
            let mut last = first;
            if let Some(before) = &before {
                let (length, once) = (rows[first].time - start, numbers(&rows[first]));
                let continues = |k: usize| {
                    let steps = (k + 1 - first) as f64;
                    let is_as_long = (rows[k].time - start - steps * length).abs() <= SAME * length;
                    let scale = before.iter().chain(&once).fold(0.0, |most: f64, value| most.max(value.abs()));
                    let ends = numbers(&rows[k]);
                    is_as_long
                        && (0..ends.len())
                            .all(|i| (ends[i] - before[i] - steps * (once[i] - before[i])).abs() <= SAME * SAME * scale)
                };
                while last + 1 < rows.len() && continues(last + 1) {
                    last += 1;
                }
            }
            let mut ramp = json!({ "increments": last + 1 - first, "time": rows[last].time - start });
            rows[last].target.put_into(&mut ramp);
            rows[last].fields.put_into(&mut ramp);
            self.steps.push(ramp);
            before = Some(numbers(&rows[last]));
            (first, start, count) = (last + 1, rows[last].time, count + 1);
        }
        if count > 1 {
            self.left_out.push(format!(
                "{}: the step as a single one: it becomes {count} steps, one for each straight piece of its deformation \
                 gradient. From here on, KSTEP, KINC and TIME(1) differ from those of the job",
                step.place
            ));
        }
        self.end(end);
    }

    fn end(&mut self, end: &Row) {
        self.present = end.target.controls;
        self.gradient = end.target.gradient;
        self.temperature = end.fields.temperature.unwrap_or(self.temperature);
        self.fields.clone_from(&end.fields.variables);
    }
}

/// Returns whether values lie on a line in time from a start to that of the last row.
fn is_linear(rows: &[Row], start: f64, value: impl Fn(&Row) -> f64) -> bool {
    let Some(last) = rows.last() else { return true };
    let end = value(last);
    let scale = rows.iter().map(&value).fold(start.abs(), |most, value| most.max(value.abs()));
    rows.iter().all(|row| (value(row) - start - (end - start) * row.time / last.time).abs() <= SAME * SAME * scale)
}

fn equally_long(rows: &[Row]) -> bool {
    let Some(last) = rows.last() else { return true };
    let length = last.time / rows.len() as f64;
    rows.iter().enumerate().all(|(k, row)| (row.time - (k + 1) as f64 * length).abs() <= SAME * length)
}

impl Control {
    /// The prescribed value.
    fn value(self) -> f64 {
        match self {
            Self::Strain(value) | Self::Stress(value) => value,
        }
    }

    /// Returns the same quantity with another value.
    fn with(self, value: f64) -> Self {
        match self {
            Self::Strain(_) => Self::Strain(value),
            Self::Stress(_) => Self::Stress(value),
        }
    }

    /// The name of it in cases.
    fn name(self, component: usize) -> &'static str {
        match self {
            Self::Strain(_) => STRAINS[component],
            Self::Stress(_) => STRESSES[component],
        }
    }
}

impl Target {
    /// Writes the target into a ramp.
    fn put_into(&self, ramp: &mut Value) {
        if let Some(gradient) = self.gradient {
            ramp["F"] = json!(gradient);
            return;
        }
        let named = self.controls.iter().enumerate().filter_map(|(i, control)| Some((i, (*control)?)));
        let given = named.filter(|(_, control)| matches!(control, Control::Strain(_)) || control.value() != 0.0);
        ramp["target"] = given.map(|(i, control)| (control.name(i).to_owned(), json!(control.value() + 0.0))).collect();
    }
}

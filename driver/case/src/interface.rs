//! Kind "interface": slips, gap or pressure.

use crate::document::{
    ContactArguments, EndValue, EntryPoint, InterfaceCase, InterfaceRamp, InterfaceStep as StepDocument,
};
use crate::document::{Cycles, InterfaceTable, TableSource};
use crate::plugin::{self, Length, Level, Use};
use crate::point::{Resolved, statev};
use crate::problem::Place;
use crate::reader::Reader;
use crate::steps::{self, Found};
use crate::{fields, history};
use pullout_run::columns;
use pullout_run::program::{
    InterfaceEntry, InterfaceGoal, InterfaceProgram, InterfaceStep, NormalControl, Pace, PathStep, PointKind,
};

/// Names of targets and of table columns.
const NAMES: [&str; 4] = ["slip", "slip2", "gap", "p"];

/// Properties of the case that its steps must agree with.
struct Setting<'c> {
    entry: EntryPoint,
    field_variables: usize,
    columns: Option<&'c [String]>,
}

/// A goal whose normal control may be that of the step before it.
#[derive(Clone, Debug)]
struct OpenGoal {
    normal: Option<NormalControl>,
    ends: Vec<[Option<f64>; 3]>,
}

/// Resolves the plugin, the initial state and the steps.
pub fn resolve(reader: &mut Reader<'_>, case: &InterfaceCase) -> Resolved {
    let root = Place::root();
    let length = Length::of(case.path.characteristic_length);
    let characteristic_length = length.given();
    let place = root.key("material");
    let material = &case.path.material;
    let message = "kind \"interface\" calls the entry point uinter or fric; use kind \"point\" for umat";
    let entry = plugin::contact_entry(reader, material.entry, &place, message);
    let purpose = Use { level: Level::Point, entry, mode: None, length, normal: None };
    let plugin = plugin::resolve(reader, material, &place, purpose);
    let place = root.key("initial");
    let given = case.initial.clone().unwrap_or_default();
    if entry == EntryPoint::Fric && given.gap.is_some() {
        reader.problem(&place.key("gap"), GAP_OF_FRIC);
    }
    let states = plugin.as_ref().map_or(0, |plugin| plugin.nstatv);
    let initial_statev =
        statev(reader, material, given.statev.as_deref(), plugin.as_ref()).unwrap_or_else(|| vec![0.0; states]);
    let place = root.key("steps");
    let mut directions = if given.slip2.is_some() { 2 } else { 1 };
    directions = directions.max(directions_of(reader, &case.path.steps));
    let columns = plugin.as_ref().map(|plugin| columns::of_contact(directions, &plugin.state_names()));
    let initial_fields = fields::initial(&case.course);
    let place_of_arguments = root.key("arguments");
    let arguments = case.arguments.as_ref();
    warn_of_effect(reader, arguments, entry, &place_of_arguments);
    let dpred = arguments.and_then(|given| given.dpred.as_deref());
    fields::check_count(reader, dpred, initial_fields.variables.len(), &place_of_arguments.key("dpred"));
    let setting = Setting { entry, field_variables: initial_fields.variables.len(), columns: columns.as_deref() };
    let open = steps::expand(reader, &case.path.steps, &place, &mut |reader, step, place| match step {
        StepDocument::Ramp(ramp) => Found::Step(Some(ramp_step(reader, ramp, &setting, place))),
        StepDocument::Table(table) => Found::Step(table_step(reader, table, &setting, place)),
        StepDocument::Cycle(cycle) => Found::Cycle(cycle),
        StepDocument::Cycles(wrapper) => Found::Cycles(&wrapper.cycles),
    });
    let kind = PointKind::Interface(InterfaceProgram {
        entry: if entry == EntryPoint::Fric { InterfaceEntry::Fric } else { InterfaceEntry::Uinter },
        tangential_directions: directions,
        initial_statev,
        initial_time: given.time.unwrap_or(0.0),
        arguments: arguments.cloned().unwrap_or_default(),
        initial_displacement: [given.slip, given.slip2, given.gap].map(Option::unwrap_or_default),
        initial_fields,
        steps: close(open, entry),
    });
    Resolved { plugin, kind, columns, characteristic_length }
}

/// Warns of arguments that the entry point does not have.
fn warn_of_effect(reader: &mut Reader<'_>, given: Option<&ContactArguments>, entry: EntryPoint, place: &Place) {
    let Some(given) = given else { return };
    let (fric, uinter) = (EntryPoint::Fric, EntryPoint::Uinter);
    for (is_given, key, of) in [
        (given.lm.is_some(), "lm", fric),
        (given.slip.is_some(), "slip", fric),
        (given.dpress.is_some(), "dpress", fric),
        (given.rcoord.is_some(), "rcoord", fric),
        (given.flags.is_some(), "flags", uinter),
        (given.alocaldir.is_some(), "alocaldir", uinter),
        (given.area.is_some(), "area", uinter),
        (given.drdisp.is_some(), "drdisp", uinter),
    ] {
        if is_given && of != entry {
            let name = if of == fric { "fric" } else { "uinter" };
            reader.warn_no_effect(&place.key(key), format_args!("it is an argument of {name} alone"));
        }
    }
}

/// A step that says nothing of the normal direction goes on with the control of the step before it.
fn close(open: Vec<PathStep<OpenGoal>>, entry: EntryPoint) -> Vec<InterfaceStep> {
    let mut normal = if entry == EntryPoint::Fric { NormalControl::Pressure } else { NormalControl::Gap };
    open.into_iter()
        .map(|PathStep { pace, goal, until, fields }| {
            normal = goal.normal.unwrap_or(normal);
            PathStep { pace, goal: InterfaceGoal { normal, ends: goal.ends }, until, fields }
        })
        .collect()
}

/// 2 if any step names `slip2`: `until` of an earlier step may then name its columns.
fn directions_of(reader: &mut Reader<'_>, documents: &[StepDocument]) -> usize {
    let directions = documents.iter().map(|step| match step {
        StepDocument::Cycle(cycle) | StepDocument::Cycles(Cycles { cycles: cycle }) => {
            directions_of(reader, &cycle.steps)
        }
        StepDocument::Ramp(ramp) => 1 + usize::from(ramp.target.slip2.is_some()),
        StepDocument::Table(table) => {
            const SECOND: &str = "slip2";
            let is_there = match &table.table {
                TableSource::Columns(columns) => columns.contains_key(SECOND),
                TableSource::File(name) => {
                    let csv = reader.named(name).ok().and_then(|path| reader.csv(&path).ok());
                    csv.is_some_and(|csv| csv.column(SECOND).is_ok())
                }
            };
            1 + usize::from(is_there)
        }
    });
    directions.max().unwrap_or(1)
}

const GAP_OF_FRIC: &str = "FRIC has no normal law: prescribe the pressure 'p' instead of the gap";

/// Returns the meaning of the normal value. A gap under FRIC, and gap and pressure at once, are problems.
fn normal_control(
    reader: &mut Reader<'_>,
    gap: bool,
    pressure: bool,
    entry: EntryPoint,
    place: impl Fn(&str) -> Place,
) -> Option<NormalControl> {
    if gap && entry == EntryPoint::Fric {
        reader.problem(&place("gap"), GAP_OF_FRIC);
    } else if gap && pressure {
        reader.problem(&place("p"), "the normal direction is controlled by 'gap' and by 'p': give one of them");
    }
    match (gap, pressure) {
        (true, _) => Some(NormalControl::Gap),
        (false, true) => Some(NormalControl::Pressure),
        (false, false) => None,
    }
}

fn ramp_step(
    reader: &mut Reader<'_>,
    ramp: &InterfaceRamp,
    setting: &Setting<'_>,
    place: &Place,
) -> PathStep<OpenGoal> {
    let target = &ramp.target;
    let place_of_target = place.key("target");
    let normal = normal_control(reader, target.gap.is_some(), target.p.is_some(), setting.entry, |name| {
        place_of_target.key(name)
    });
    let value = |end: Option<EndValue>| match end {
        Some(EndValue::Value(value)) => Some(value),
        Some(EndValue::Hold(_)) | None => None,
    };
    let until = history::until(reader, ramp.end.until.as_ref(), setting.columns, &place.key("until"));
    let ends = vec![[value(target.slip), value(target.slip2), value(target.gap.or(target.p))]];
    let pace = steps::pace(ramp.increments, ramp.time);
    let fields = fields::of_step(reader, &ramp.end, setting.field_variables, place);
    PathStep { pace, goal: OpenGoal { normal, ends }, until, fields }
}

fn table_step(
    reader: &mut Reader<'_>,
    step: &InterfaceTable,
    setting: &Setting<'_>,
    place: &Place,
) -> Option<PathStep<OpenGoal>> {
    let until = history::until(reader, step.end.until.as_ref(), setting.columns, &place.key("until"));
    let count = setting.field_variables;
    let mut fields = fields::of_step(reader, &step.end, count, place);
    let place_of_table = place.key("table");
    let (file, table) = fields::read_table(reader, &step.table, &NAMES, count, &place_of_table)?;
    fields::take_columns(reader, &mut fields, &table, NAMES.len(), &file, place);
    let [slip, slip2, gap, p] = [0, 1, 2, 3].map(|k| table.columns[k]);
    let normal = normal_control(reader, gap.is_some(), p.is_some(), setting.entry, |_| place_of_table.clone());
    let ends = table.rows.iter().map(|row| [slip, slip2, gap.or(p)].map(|column| column.map(|column| row[column])));
    let goal = OpenGoal { normal, ends: ends.collect() };
    Some(PathStep { pace: Pace::Rows(table.time_increments.clone()), goal, until, fields })
}

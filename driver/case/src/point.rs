//! Kind "point": modes, controls, initial state, steps.

use crate::constraints::{self, fixed_by_mode};
use crate::document::{self, Components, EndValue, EntryPoint, Material, Matrix, PointCase, PointRamp};
use crate::document::{PointStep as StepDocument, PointTable};
use crate::plugin::{self, Length, Level, Use};
use crate::problem::{Place, Problem, hint};
use crate::reader::Reader;
use crate::steps::{self, Found};
use crate::{fields, history};
use pullout_run::columns;
use pullout_run::deformation::{self, Polar, exponential, matrix, rotated, turns};
use pullout_run::program::{
    Control, Measure, Mode, Pace, PointDrive, PointGoal, PointKind, PointProgram, PointState, PointStep, STRAIN_NAMES,
    STRESS_NAMES, StepFields, TURNED, gradient_needs_thickness, nominal_needs_thickness,
};
use std::array::from_fn;
use umat_abi::host::Plugin;

/// The parts of a program that the kinds of points resolve; reading a case adds the rest.
pub struct Resolved {
    pub plugin: Option<Plugin>,
    pub kind: PointKind,
    pub columns: Option<Vec<String>>,
    pub characteristic_length: Option<f64>,
}

const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Properties of the case that its steps must agree with.
struct Setting<'c> {
    mode: Mode,
    nlgeom: bool,
    measure: Measure,
    field_variables: usize,
    columns: Option<&'c [String]>,
}

/// Resolves the plugin, the initial state and the steps.
pub fn resolve(reader: &mut Reader<'_>, case: &PointCase) -> Resolved {
    let root = Place::root();
    let mode = case.mode.unwrap_or_default();
    let nlgeom = case.nlgeom.unwrap_or(false);
    if mode.is_of_line() && nlgeom {
        let message = format!("mode {} is for small strains only: the transverse stretches are unknown", mode.name());
        reader.problem(&root.key("nlgeom"), message);
    }
    let length = Length::of(case.path.characteristic_length);
    let characteristic_length = length.given();
    let place = root.key("material");
    let material = &case.path.material;
    if let Some(EntryPoint::Uinter | EntryPoint::Fric) = material.entry {
        let message = "kind \"point\" calls the entry point umat; use kind \"interface\" for uinter and fric";
        reader.problem(&place.key("entry"), message);
    }
    let mut plugin = plugin::resolve(
        reader,
        material,
        &place,
        Use {
            level: Level::Point,
            entry: EntryPoint::Umat,
            mode: Some((mode, root.key("mode"))),
            length,
            normal: None,
        },
    );
    if let Some(plugin) = &mut plugin {
        plugin::begin_at(reader, plugin, material, fields::initial(&case.course).temperature, &place);
    }
    let heat = case.path.output.as_ref().is_some_and(|output| output.heat == Some(true));
    if let Some(plugin) = &plugin {
        let silent = (!heat).then_some("\"output\": {\"heat\": true} shows what it adds to RPL");
        let reasons = [("hetval", silent), ("umatht", Some("a point has no gradient of the temperature"))];
        plugin::report_heat_routines(reader, &plugin.library, reasons);
    }
    let columns = plugin.as_ref().map(|plugin| columns::of_point(nlgeom, heat, &plugin.state_names()));
    if case.measure.is_some() && !nlgeom {
        reader.problem(&root.key("measure"), "small strains have no measure: it needs \"nlgeom\": true");
    }
    let measure = case.measure.unwrap_or_default();
    if let (Mode::PlaneStress, true, Some(plugin)) = (mode, nlgeom, &plugin) {
        check_thickness(reader, plugin, measure);
    }
    let initial = initial(reader, case, plugin.as_ref(), mode, nlgeom);
    if let Some(given) = &case.arguments {
        check_arguments(reader, given, mode, nlgeom, initial.fields.variables.len());
    }
    let setting =
        Setting { mode, nlgeom, measure, field_variables: initial.fields.variables.len(), columns: columns.as_deref() };
    let place = root.key("steps");
    let mut gradient = initial.deformation_gradient;
    let steps = steps::expand(reader, &case.path.steps, &place, &mut |reader, step, place| {
        let step = match step {
            StepDocument::Ramp(ramp) => Some(ramp_step(reader, ramp, &setting, place)),
            StepDocument::Table(table) => table_step(reader, table, &setting, place),
            StepDocument::Cycle(cycle) => return Found::Cycle(cycle),
            StepDocument::Cycles(wrapper) => return Found::Cycles(&wrapper.cycles),
        };
        if let Some(PointDrive::DeformationGradient(end)) = step.as_ref().map(|step| &step.goal.drive) {
            gradient = *end;
        } else if nlgeom && step.as_ref().is_some_and(|step| steps_apart(step, &setting, &gradient)) {
            reader.problem(place, TURNED);
        }
        Found::Step(step)
    });
    let initial_temperature = initial.fields.temperature;
    let heats = |step: &PointStep| {
        let StepFields { temperature, temperatures, .. } = &step.fields;
        temperature.iter().chain(temperatures.iter().flatten()).any(|end| *end != initial_temperature)
    };
    if steps.iter().any(heats)
        && let Some(reason) = plugin::without_expansion(plugin.iter())
    {
        reader.warn_no_effect(&root.key("temperature"), reason);
    }
    let arguments = case.arguments.clone().unwrap_or_default();
    let kind = PointKind::Point(PointProgram { mode, nlgeom, measure, heat, initial, arguments, steps });
    Resolved { plugin, kind, columns, characteristic_length }
}

/// Says what is not known of the thickness in plane stress at finite strain. With six components it is found; where trial
/// calls decide on these, the run says it.
fn check_thickness(reader: &mut Reader<'_>, plugin: &Plugin, measure: Measure) {
    let goes_through_six = plugin.goes_through_six(Mode::PlaneStress.stress_state());
    if plugin.strain_33().is_some() || goes_through_six == Some(true) {
        return;
    }
    match (measure, goes_through_six) {
        (_, None) => {}
        (Measure::Nominal, _) => reader.problem(&Place::root().key("measure"), nominal_needs_thickness(&plugin.name)),
        (Measure::Logarithmic, _) => reader.warn(gradient_needs_thickness(&plugin.name)),
    }
}

/// Returns whether a step controls strains and Cauchy stresses of a material that has turned.
fn steps_apart(step: &PointStep, setting: &Setting<'_>, gradient: &Matrix) -> bool {
    setting.measure == Measure::Logarithmic
        && step.goal.mixes_strain_and_stress(setting.mode.controllable())
        && turns(&Polar::new(&matrix(gradient)).rotation)
}

fn ramp_step(reader: &mut Reader<'_>, ramp: &PointRamp, setting: &Setting<'_>, place: &Place) -> PointStep {
    let target = ramp.target.as_ref();
    let mut controls = [Control::FREE; 6];
    let named = target_controls(reader, target, setting, &mut controls, &place.key("target"));
    let relations = ramp.constraints.as_deref().unwrap_or_default();
    let gradient = match (ramp.deformation_gradient, target.and_then(|target| target.deformation_gradient)) {
        (Some(_), Some(_)) => {
            reader.problem(&place.key("target").key("F"), "F is given twice: in the step and in its target");
            None
        }
        (Some(end), None) => Some((end, place.key("F"))),
        (None, Some(end)) => Some((end, place.key("target").key("F"))),
        (None, None) => None,
    };
    let (drive, constraints) = if let Some((end, place_of_end)) = gradient {
        check_gradient(reader, &end, setting.mode, setting.nlgeom, &place_of_end, true);
        if named.contains(&true) || !relations.is_empty() {
            let message = "F determines all strains: leave the components of target and the constraints out";
            reader.problem(&place_of_end, message);
        }
        (PointDrive::DeformationGradient(end), Vec::new())
    } else {
        let place = place.key("constraints");
        let constraints = constraints::assign(reader, relations, &mut controls, &named, setting.mode, &place);
        (PointDrive::Components { controls, rows: Vec::new() }, constraints)
    };
    let fields = fields::of_step(reader, &ramp.end, setting.field_variables, place);
    let until = history::until(reader, ramp.end.until.as_ref(), setting.columns, &place.key("until"));
    PointStep { pace: steps::pace(ramp.increments, ramp.time), goal: PointGoal { drive, constraints }, until, fields }
}

/// Sets the controls of the named components; says which are named.
fn target_controls(
    reader: &mut Reader<'_>,
    target: Option<&document::StepTarget>,
    setting: &Setting<'_>,
    controls: &mut [Control; 6],
    place: &Place,
) -> [bool; 6] {
    let [strain, stress] = target.map_or([[None; 6]; 2], |target| target.components.strain_and_stress());
    check_names(
        reader,
        &strain.map(|v| v.is_some()),
        &stress.map(|v| v.is_some()),
        setting.mode,
        |name| place.key(name),
        "",
    );
    let mut named = [false; 6];
    for i in 0..6 {
        let control = match (strain[i], stress[i]) {
            (Some(EndValue::Value(value)), _) => Control::Strain(value),
            (Some(EndValue::Hold(_)), _) => Control::HoldStrain,
            (None, Some(EndValue::Value(value))) => Control::Stress(value),
            (None, Some(EndValue::Hold(_))) => Control::HoldStress,
            (None, None) => continue,
        };
        if let Control::Strain(value) = control
            && setting.measure == Measure::Nominal
            && i < 3
            && value <= -1.0
        {
            reader.problem(&place.key(STRAIN_NAMES[i]), format!("a nominal strain must be > -1, it is {value}"));
        }
        (controls[i], named[i]) = (control, true);
    }
    named
}

/// Components that the mode fixes, and components named as strain and as stress.
fn check_names(
    reader: &mut Reader<'_>,
    strain: &[bool; 6],
    stress: &[bool; 6],
    mode: Mode,
    place: impl Fn(&str) -> Place,
    prefix: &str,
) {
    for i in 0..6 {
        let names = [(STRAIN_NAMES[i], strain[i]), (STRESS_NAMES[i], stress[i])];
        if !mode.controllable().contains(&i) {
            for (name, _) in names.iter().filter(|(_, named)| *named) {
                reader.problem(&place(name), format!("{prefix}{}", fixed_by_mode(name, mode)));
            }
        } else if strain[i] && stress[i] {
            let message =
                format!("{prefix}the same component is given as '{}' and as '{}'", STRAIN_NAMES[i], STRESS_NAMES[i]);
            reader.problem(&place(STRESS_NAMES[i]), message);
        }
    }
}

fn table_step(reader: &mut Reader<'_>, step: &PointTable, setting: &Setting<'_>, place: &Place) -> Option<PointStep> {
    let count = setting.field_variables;
    let mut fields = fields::of_step(reader, &step.end, count, place);
    let until = history::until(reader, step.end.until.as_ref(), setting.columns, &place.key("until"));
    let components = [STRAIN_NAMES, STRESS_NAMES].concat();
    let place_of_table = place.key("table");
    let (file, table) = fields::read_table(reader, &step.table, &components, count, &place_of_table)?;
    let there = |first: usize| -> [bool; 6] { from_fn(|i| table.columns[first + i].is_some()) };
    let (strain, stress) = (there(0), there(6));
    let prefix = format!("{file}: ");
    check_names(reader, &strain, &stress, setting.mode, |_| place_of_table.clone(), &prefix);
    let named = from_fn(|i| strain[i] || stress[i]);
    let columns: [Option<usize>; 6] = from_fn(|i| table.columns[i].or(table.columns[6 + i]));
    let mut controls = from_fn(|i| match (strain[i], stress[i]) {
        (true, _) => Control::Strain(0.0),
        (false, true) => Control::Stress(0.0),
        (false, false) => Control::FREE,
    });
    let relations = step.constraints.as_deref().unwrap_or_default();
    let constraints =
        constraints::assign(reader, relations, &mut controls, &named, setting.mode, &place.key("constraints"));
    fields::take_columns(reader, &mut fields, &table, components.len(), &file, place);
    let rows = table.rows.iter().map(|row| columns.map(|column| column.map_or(0.0, |column| row[column]))).collect();
    let goal = PointGoal { drive: PointDrive::Components { controls, rows }, constraints };
    Some(PointStep { pace: Pace::Rows(table.time_increments.clone()), goal, until, fields })
}

/// Checks the arguments of the first call. At finite strain the steps determine the kinematic ones. Increments must be
/// as many as the mode and the case have.
fn check_arguments(
    reader: &mut Reader<'_>,
    given: &document::UmatArguments,
    mode: Mode,
    nlgeom: bool,
    field_variables: usize,
) {
    let place = Place::root().key("arguments");
    let kinematics = [&given.drot, &given.dfgrd0, &given.dfgrd1];
    if nlgeom && (kinematics.into_iter().any(Option::is_some) || given.dstran.is_some()) {
        let message = "drot, dfgrd0, dfgrd1 and dstran belong to cases without nlgeom: here the steps determine them";
        reader.problem(&place, message);
    } else if let Some(dstran) = &given.dstran {
        let count = mode.stress_state().components().len();
        if dstran.len() != count {
            let message = format!("{} values given, {count} needed in mode {}", dstran.len(), mode.name());
            reader.problem(&place.key("dstran"), message);
        }
    }
    fields::check_count(reader, given.dpred.as_deref(), field_variables, &place.key("dpred"));
}

/// A deformation gradient must turn nothing inside out and fit the mode.
fn check_gradient(reader: &mut Reader<'_>, f: &Matrix, mode: Mode, nlgeom: bool, place: &Place, of_step: bool) {
    if !nlgeom && (of_step || *f != IDENTITY) {
        reader.problem(place, "a deformation gradient needs \"nlgeom\": true");
    }
    let determinant = nalgebra::Matrix3::from_fn(|i, j| f[i][j]).determinant();
    if !(determinant > 0.0 && determinant.is_finite()) {
        reader.problem(place, format!("the determinant must be > 0, it is {determinant}"));
    }
    if mode == Mode::ThreeD {
        return;
    }
    if [f[0][2], f[1][2], f[2][0], f[2][1]].iter().any(|entry| *entry != 0.0) {
        reader.problem(place, format!("mode {} needs F13 = F23 = F31 = F32 = 0", mode.name()));
    }
    let fixed = mode == Mode::PlaneStrain || (mode == Mode::PlaneStress && of_step);
    if fixed && f[2][2] != 1.0 {
        let why = if mode == Mode::PlaneStress { " (the law finds the thickness strain)" } else { "" };
        reader.problem(place, format!("mode {} needs F33 = 1{why}, it is {}", mode.name(), f[2][2]));
    }
}

fn initial(reader: &mut Reader<'_>, case: &PointCase, plugin: Option<&Plugin>, mode: Mode, nlgeom: bool) -> PointState {
    let root = Place::root();
    let place = root.key("initial");
    let given = case.initial.clone().unwrap_or_default();
    let mut strain = components(reader, given.strain.as_ref(), &STRAIN_NAMES, mode, &place.key("strain"));
    let place_of_stress = place.key("stress");
    let stress =
        given.stress.as_ref().map(|stress| components(reader, Some(stress), &STRESS_NAMES, mode, &place_of_stress));
    let mut deformation_gradient = IDENTITY;
    if let Some(gradient) = given.deformation_gradient {
        check_gradient(reader, &gradient, mode, nlgeom, &place.key("F"), false);
        deformation_gradient = gradient;
        if given.strain.is_none() {
            let polar = Polar::new(&matrix(&gradient));
            strain = rotated(&polar.logarithmic_strain(), &polar.rotation, 2.0);
        }
    } else if nlgeom {
        // symmetric: its columns are its rows
        deformation_gradient = deformation::columns(&exponential(&strain));
    }
    let fields = fields::initial(&case.course);
    let statev = statev(reader, &case.path.material, given.statev.as_deref(), plugin);
    if let Some(plugin) = plugin {
        plugin::report_initial_values(reader, &plugin.library, [statev.is_some(), stress.is_some()]);
    }
    PointState {
        strain,
        stress: stress.map(Box::new),
        statev,
        time: given.time.unwrap_or(0.0),
        deformation_gradient,
        fields,
    }
}

/// STATEV at the start, from `material.statev0` or `initial.statev`; `None` if neither is given.
pub fn statev(
    reader: &mut Reader<'_>,
    material: &Material,
    initial: Option<&[f64]>,
    plugin: Option<&Plugin>,
) -> Option<Vec<f64>> {
    let place = Place::root().key("initial").key("statev");
    let place_of_other = Place::root().key("material").key("statev0");
    let (values, place) = match (initial, material.statev0.as_deref()) {
        (Some(_), Some(_)) => {
            reader.problem(&place, "the initial states are given twice: here and as $.material.statev0");
            return None;
        }
        (Some(values), None) => (values, place),
        (None, Some(values)) => (values, place_of_other),
        (None, None) => return None,
    };
    if let Some(plugin) = plugin {
        check_count(reader, values, plugin, &place);
    }
    Some(values.to_vec())
}

/// Initial states must be as many as the law has.
pub fn check_count(reader: &mut Reader<'_>, statev: &[f64], plugin: &Plugin, place: &Place) {
    if statev.len() != plugin.nstatv {
        let message = format!("{} values given, {} has {} state variables", statev.len(), plugin.name, plugin.nstatv);
        reader.problem(place, message);
    }
}

/// Six components from a list of six or of the mode's, or by name.
pub fn components(
    reader: &mut Reader<'_>,
    given: Option<&Components>,
    names: &[&str; 6],
    mode: Mode,
    place: &Place,
) -> [f64; 6] {
    let mut values = [0.0; 6];
    let seen = mode.stress_state().components();
    match given {
        None => {}
        Some(Components::List(list)) if list.len() == 6 => values.copy_from_slice(list),
        Some(Components::List(list)) if list.len() == seen.len() => {
            seen.iter().zip(list).for_each(|(i, value)| values[*i] = *value);
        }
        Some(Components::List(list)) => {
            let of_mode = if seen.len() == 6 { String::new() } else { format!(" (or the {} of the mode)", seen.len()) };
            let message = format!("{} values given, 6 needed{of_mode}: {}", list.len(), names.join(", "));
            reader.problem(place, message);
        }
        Some(Components::Named(named)) => {
            for (name, value) in named {
                match names.iter().position(|known| known == name) {
                    Some(i) => values[i] = *value,
                    None => {
                        reader.push(Problem::structure(place.key(name), format!("unknown key{}", hint(name, names))));
                    }
                }
            }
        }
    }
    // The strain 33 of plane stress is the law's; an initial value says where it starts.
    let kept = |i: usize| seen.contains(&i) || (mode == Mode::PlaneStress && i == 2 && names[i] == STRAIN_NAMES[2]);
    let free = |i: usize| kept(i) && !(mode == Mode::PlaneStrain && names[i] == STRAIN_NAMES[2]);
    for i in (0..6).filter(|i| !free(*i)) {
        if values[i] != 0.0 {
            reader.problem(place, format!("{} must be 0 in mode {}, it is {}", names[i], mode.name(), values[i]));
        }
    }
    values
}

//! Describes the input of a run in text and tables.

use pullout_case::Case;
use pullout_run::bridging;
use pullout_run::number::{self, rounded, signed};
use pullout_run::program::{
    About, Constraint, Control, InterfaceEntry, InterfaceGoal, InterfaceProgram, Measure, Mode, NormalControl, Pace,
    PathStep, PointDrive, PointGoal, PointKind, PointProgram, Program, STRAIN_NAMES, STRESS_NAMES, StepFields, Until,
};
use std::collections::BTreeMap;
use umat_abi::host::{LawDescription, Manner, TangentSource};

mod specimen;

/// Most steps that are listed; of more (long cycles) only the number is given.
const MOST_STEPS: usize = 40;

/// Account of what was run.
#[derive(Default)]
pub(crate) struct Account {
    pub case_file: String,
    pub description: String,
    /// Name of the law; of a specimen, that of its first one.
    pub law: String,
    /// The description of a point's law.
    pub law_description: String,
    pub mode: String,
    /// Other settings, by name.
    pub settings: Vec<(String, String)>,
    /// PROPS of a point.
    pub parameters: Vec<Parameter>,
    /// The laws of a specimen's parts and contact pairs, in the order of the summary's plugins; empty for a point.
    pub laws: Vec<LawAccount>,
    /// Values that the case leaves to defaults, a line for each place.
    pub defaults: Vec<String>,
    /// The first steps.
    pub steps: Vec<String>,
    /// Steps that `steps` leaves out.
    pub steps_left_out: usize,
}

/// A law of a specimen.
pub(crate) struct LawAccount {
    /// Owner of the law: "part fibre".
    pub subject: String,
    pub law: String,
    pub description: String,
    pub parameters: Vec<Parameter>,
}

/// A line of the table of parameters.
#[derive(Default)]
pub(crate) struct Parameter {
    pub name: String,
    /// Exact value, with the name of the choice if it is one.
    pub value: String,
    pub unit: String,
    pub meaning: String,
}

impl Account {
    /// Makes an account of a case.
    pub fn of(case: &Case) -> Self {
        let about = case.about();
        let of_kind = match case {
            Case::Path(program) => Self::of_point(program),
            Case::Pullout(program) => specimen::account(program),
            Case::Bridging(program) => Self::of_bridging(program),
        };
        Self {
            case_file: about.case_file.display().to_string(),
            description: about.description.clone(),
            defaults: about.defaults.clone(),
            ..of_kind
        }
    }

    /// Returns everything that distinguishes runs, by name.
    pub fn inputs(&self) -> BTreeMap<String, String> {
        let of = |owner: &str, parameters: &[Parameter]| -> Vec<(String, String)> {
            let named = |parameter: &Parameter| (format!("{owner}{}", parameter.name), parameter.value.clone());
            parameters.iter().map(named).collect()
        };
        let laws = self.laws.iter().flat_map(|law| {
            let name = (format!("law of {}", law.subject), law.law.clone());
            std::iter::once(name).chain(of(&format!("{}: ", law.subject), &law.parameters))
        });
        let steps = self.steps.iter().enumerate().map(|(k, step)| (format!("step {}", k + 1), step.clone()));
        let own = [("law".to_owned(), self.law.clone()), ("mode".to_owned(), self.mode.clone())];
        let settings = self.settings.iter().cloned();
        of("", &self.parameters).into_iter().chain(laws).chain(steps).chain(own).chain(settings).collect()
    }

    /// Makes an account of fibres across a crack: the parts of the case as it has them.
    fn of_bridging(program: &bridging::BridgingProgram) -> Self {
        let mut settings = vec![("Fibre".to_owned(), entries(&program.fibre))];
        match &program.source {
            bridging::LoadSource::Bond(bond, inclination) => {
                settings.push(("Bond".into(), entries(bond)));
                settings.push(("Angle".into(), entries(inclination)));
            }
            bridging::LoadSource::Curves(of) => {
                let cut = rounded(of.cut_deg);
                settings.push(("Curves".into(), format!("{}, none beyond {cut}°", of.curves.len())));
                settings.push(("Factor on the loads".into(), exact(of.scale)));
                settings.extend(of.inclination.map(|inclination| ("Angle".to_owned(), entries(&inclination))));
            }
            bridging::LoadSource::Simulated(simulations) => {
                let (runs, cut) = (simulations.runs.len(), rounded(simulations.cut_deg));
                settings.push((
                    "Curves".into(),
                    format!("{runs} runs of {}, none beyond {cut}°", simulations.base.display()),
                ));
            }
        }
        let sides = match program.sides {
            pullout_bridging::Sides::One => "fibres pull out of one side",
            pullout_bridging::Sides::Two => "fibres pull out of both sides",
        };
        settings.extend([
            ("Sides".to_owned(), sides.to_owned()),
            ("V_f".into(), exact(program.volume_fraction)),
            ("η_E".into(), exact(program.modular_ratio)),
            ("Matrix".into(), entries(&program.matrix)),
            ("Orientation".into(), entries(&program.orientation)),
            ("w_a".into(), format!("{} mm", exact(program.activation))),
        ]);
        settings.extend(program.beam.map(|beam| ("Beam".to_owned(), entries(&beam))));
        settings.extend(program.scatter.map(|scatter| ("Scatter".to_owned(), entries(&scatter))));
        Self { settings, ..Self::default() }
    }

    /// Makes an account of a material or contact point.
    pub(super) fn of_point(program: &Program) -> Self {
        let law = program.plugin.law.as_ref();
        let columns = program.columns();
        let (mode, (steps, steps_left_out)) = match &program.kind {
            PointKind::Point(point) => {
                (point_mode(point), described(&point.steps, |of| step(of, point_goal, &columns)))
            }
            PointKind::Interface(contact) => (
                interface_mode(contact),
                described(&contact.steps, |of| {
                    step(of, |goal| interface_goal(goal, matches!(of.pace, Pace::Rows(_))), &columns)
                }),
            ),
        };
        Self {
            law: program.plugin.name.clone(),
            law_description: law.map(|law| law.description.clone()).unwrap_or_default(),
            mode,
            settings: settings(program, &columns),
            parameters: parameters(law, &program.plugin.props),
            steps,
            steps_left_out,
            ..Self::default()
        }
    }
}

/// The entries of an object in one line: "diameter 0.75, length 60".
fn entries(value: &impl serde::Serialize) -> String {
    fn text_of(value: &serde_json::Value) -> String {
        match value {
            serde_json::Value::Object(entries) => {
                let entry = |(key, value): (&String, &serde_json::Value)| match value {
                    // what kind it is
                    serde_json::Value::String(kind) if key == "type" || key == "model" => kind.clone(),
                    serde_json::Value::Object(_) => format!("{key} ({})", text_of(value)),
                    value => format!("{key} {}", text_of(value)),
                };
                entries.iter().filter(|(_, value)| !value.is_null()).map(entry).collect::<Vec<_>>().join(", ")
            }
            serde_json::Value::Array(values) => values.iter().map(text_of).collect::<Vec<_>>().join(" × "),
            serde_json::Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), exact),
            serde_json::Value::String(text) => text.clone(),
            other => other.to_string(),
        }
    }
    serde_json::to_value(value).map(|value| text_of(&value)).unwrap_or_default()
}

/// Returns the texts of the first steps, and the number of those left out.
fn described<S>(steps: &[S], step: impl Fn(&S) -> String) -> (Vec<String>, usize) {
    (steps.iter().take(MOST_STEPS).map(step).collect(), steps.len().saturating_sub(MOST_STEPS))
}

/// Returns PROPS with their metadata.
fn parameters(law: Option<&LawDescription>, props: &[f64]) -> Vec<Parameter> {
    let described = |index: usize| {
        let parameters = &law?.parameters;
        // a repeating group stands once in the metadata, at the end
        let size = law?.group.as_ref().map_or(0, |group| group.size);
        let fixed = parameters.len().saturating_sub(size);
        let repeat = if index < fixed || size == 0 { None } else { Some((index - fixed) / size + 1) };
        let parameter = parameters.get(if repeat.is_some() { fixed + (index - fixed) % size } else { index })?;
        let choice = parameter.choices.iter().find(|choice| choice.value == props[index]);
        Some(Parameter {
            name: repeat.map_or(parameter.name.clone(), |repeat| format!("{} {repeat}", parameter.name)),
            value: match choice {
                Some(choice) => format!("{} ({})", signed(props[index].to_string()), choice.name),
                None => exact(props[index]),
            },
            unit: parameter.unit.clone(),
            meaning: parameter.doc.clone(),
        })
    };
    let plain = |index: usize| Parameter {
        name: format!("PROPS({})", index + 1),
        value: exact(props[index]),
        ..Parameter::default()
    };
    (0..props.len()).map(|index| described(index).unwrap_or_else(|| plain(index))).collect()
}

/// All digits, since parameters are what a run is repeated from.
fn exact(value: f64) -> String {
    signed(number::exact(value))
}

/// Returns how a UMAT is called, where the case says so.
fn called(manner: Manner) -> Option<String> {
    let components = (manner.as_three_d == Some(true)).then_some("called with NTENS = 6");
    let tangent = match manner.tangent {
        Some(TangentSource::Numerical) => Some("DDSDDE by differences of the stress"),
        Some(TangentSource::Compared) => Some("DDSDDE compared with differences of the stress"),
        Some(TangentSource::Reported) | None => None,
    };
    let words: Vec<&str> = components.into_iter().chain(tangent).collect();
    (!words.is_empty()).then(|| words.join(", "))
}

fn settings(program: &Program, columns: &[String]) -> Vec<(String, String)> {
    let mut settings = Vec::new();
    settings.extend(called(program.plugin.manner).map(|how| ("UMAT".to_string(), how)));
    if let Some(length) = program.characteristic_length {
        settings.push(("Characteristic length".to_string(), format!("{} mm", exact(length))));
    }
    settings.extend(until_and_every(&program.about, columns));
    settings
}

/// Returns where a run ends early, and which increments the history has, if the case says so.
fn until_and_every(about: &About, columns: &[String]) -> impl Iterator<Item = (String, String)> {
    let until = about.until.as_ref().map(|until| ("Until".to_owned(), bound(until, columns)));
    let every = (about.every > 1).then(|| ("History".to_owned(), format!("every {}th increment", about.every)));
    until.into_iter().chain(every)
}

fn point_mode(point: &PointProgram) -> String {
    let mode = match point.mode {
        Mode::ThreeD => "material point, 3-D (NTENS 6)",
        Mode::PlaneStrain => "material point, plane strain (NTENS 4)",
        Mode::Axisymmetric => "material point, axisymmetric (NTENS 4)",
        Mode::PlaneStress => "material point, plane stress (NTENS 3)",
        Mode::OneD => "material point, one component of stress (NTENS 1)",
        Mode::Beam => "material point, beam: axial stress and shear (NTENS 2)",
    };
    match (point.nlgeom, point.measure) {
        (false, _) => mode.into(),
        (true, Measure::Logarithmic) => format!("{mode}, finite strain: ln U and Cauchy stress"),
        (true, Measure::Nominal) => format!("{mode}, finite strain: U - 1 and nominal (Biot) stress"),
    }
}

fn interface_mode(contact: &InterfaceProgram) -> String {
    let entry = match contact.entry {
        InterfaceEntry::Uinter => "UINTER",
        InterfaceEntry::Fric => "FRIC",
    };
    let directions =
        if contact.tangential_directions == 2 { "two tangential directions" } else { "one tangential direction" };
    format!("contact point through {entry}, {directions}")
}

/// Returns what a step does, of whatever kind of point; `leads`: where to.
fn step<G>(step: &PathStep<G>, leads: impl FnOnce(&G) -> String, columns: &[String]) -> String {
    let mut text = match &step.pace {
        Pace::Equal { increments, time } => format!("{}, time {}: ", count(*increments, "increment"), rounded(*time)),
        Pace::Rows(rows) => format!("table of {}: ", count(rows.len(), "row")),
    };
    text.push_str(&leads(&step.goal));
    if let Some(until) = &step.until {
        text.push_str(&format!("; until {}", bound(until, columns)));
    }
    text + &fields(&step.fields)
}

fn point_goal(goal: &PointGoal) -> String {
    let mut text = match &goal.drive {
        PointDrive::Components { controls, rows } if rows.is_empty() => {
            let targets: Vec<String> = (0..6).filter_map(|k| target(k, controls[k])).collect();
            if targets.is_empty() { "stress-free".into() } else { targets.join(", ") }
        }
        PointDrive::Components { controls, .. } => {
            let name = |k: usize| match controls[k] {
                Control::Strain(_) | Control::HoldStrain => Some(STRAIN_NAMES[k]),
                Control::FREE => None,
                _ => Some(STRESS_NAMES[k]),
            };
            (0..6).filter_map(name).collect::<Vec<&str>>().join(", ")
        }
        PointDrive::DeformationGradient(end) => {
            let row = |row: &[f64; 3]| row.map(rounded).join(" ");
            format!("F → [{}]", end.each_ref().map(row).join("; "))
        }
    };
    for constraint in &goal.constraints {
        text.push_str(&format!("; {}", relation(constraint)));
    }
    text
}

/// Returns where temperature and field variables go.
fn fields(fields: &StepFields) -> String {
    let mut text = String::new();
    if let Some(temperature) = fields.temperature {
        text.push_str(&format!("; temperature → {}", rounded(temperature)));
    }
    if let Some(variables) = fields.predef.as_ref().filter(|variables| !variables.is_empty()) {
        let values: Vec<String> = variables.iter().map(|value| rounded(*value)).collect();
        text.push_str(&format!("; field variables → {}", values.join(", ")));
    }
    text
}

/// Returns what happens to a component; nothing of those that are simply stress-free.
fn target(component: usize, control: Control) -> Option<String> {
    let (strain, stress) = (STRAIN_NAMES[component], STRESS_NAMES[component]);
    match control {
        Control::FREE | Control::Constraint(_) => None,
        Control::Strain(value) => Some(format!("{strain} → {}", rounded(value))),
        Control::HoldStrain => Some(format!("{strain} held")),
        Control::Stress(value) => Some(format!("{stress} → {} MPa", rounded(value))),
        Control::HoldStress => Some(format!("{stress} held")),
    }
}

fn relation(constraint: &Constraint) -> String {
    let strains = STRAIN_NAMES.iter().zip(constraint.strain);
    let terms = strains.chain(STRESS_NAMES.iter().zip(constraint.stress)).filter(|(_, factor)| *factor != 0.0);
    let terms: Vec<String> = terms.map(|(name, factor)| format!("{} {name}", rounded(factor))).collect();
    let terms = terms.join(" + ");
    if constraint.hold { format!("{terms} held") } else { format!("{terms} = {}", rounded(constraint.equals)) }
}

fn interface_goal(goal: &InterfaceGoal, is_table: bool) -> String {
    let normal = match goal.normal {
        NormalControl::Gap => ("gap", "mm"),
        NormalControl::Pressure => ("p", "MPa"),
    };
    let names = [("slip", "mm"), ("slip2", "mm"), normal];
    let first = goal.ends.first().copied().unwrap_or_default();
    let words = names.into_iter().zip(first).enumerate().filter_map(|(k, ((name, unit), end))| match end {
        Some(_) if is_table => Some(name.to_owned()),
        None if is_table => None,
        Some(end) => Some(format!("{name} → {} {unit}", rounded(end))),
        None => (k != 1).then(|| format!("{name} held")),
    });
    words.collect::<Vec<String>>().join(", ")
}

fn bound(until: &Until, columns: &[String]) -> String {
    let name = columns.get(until.column).map_or("?", String::as_str);
    let quantity = if until.absolute { format!("|{name}|") } else { name.to_owned() };
    let greater = until.greater_than.map(|bound| format!("{quantity} > {}", rounded(bound)));
    let less = until.less_than.map(|bound| format!("{quantity} < {}", rounded(bound)));
    greater.into_iter().chain(less).collect::<Vec<_>>().join(" or ")
}

fn count(number: usize, noun: &str) -> String {
    if number == 1 { format!("1 {noun}") } else { format!("{number} {noun}s") }
}

//! Interpretation of a job's keywords.

use super::element::{Brick, Shape};
use super::keywords::{Data, Keyword, LinePosition};
use super::options::not_understood;
use super::orientation::{self, Axes};
use pullout_case::abaqus::VALUES_A_LINE;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Step time and first increment of a *STATIC without data.
const ONE: f64 = 1.0;

/// Keywords that do not affect the problem.
const OF_NO_MATTER: [&str; 35] = [
    "ASSEMBLY",
    "CONTACT FILE",
    "CONTACT OUTPUT",
    "CONTACT PRINT",
    "DISTRIBUTION TABLE",
    "EL FILE",
    "EL PRINT",
    "ELEMENT OUTPUT",
    "END ASSEMBLY",
    "END INSTANCE",
    "END PART",
    "ENERGY FILE",
    "ENERGY OUTPUT",
    "ENERGY PRINT",
    "FILE FORMAT",
    "FILE OUTPUT",
    "HOURGLASS STIFFNESS",
    "INCREMENTATION OUTPUT",
    "INTEGRATED OUTPUT",
    "MONITOR",
    "NODE FILE",
    "NODE OUTPUT",
    "NODE PRINT",
    "OUTPUT",
    "PART",
    "PHYSICAL CONSTANTS",
    "PREPRINT",
    "PRINT",
    "RESTART",
    "SECTION CONTROLS",
    "SECTION FILE",
    "SECTION PRINT",
    "SOLVER CONTROLS",
    "SYSTEM OUTPUT",
    "USER OUTPUT VARIABLES",
];
/// Keywords that tie nodes to each other, rotate their axes, or belong to another procedure: ignoring them would change the
/// problem.
const REFUSED: [&str; 17] = [
    "BUCKLE",
    "COUPLED TEMPERATURE-DISPLACEMENT",
    "COUPLING",
    "DYNAMIC",
    "EMBEDDED ELEMENT",
    "EQUATION",
    "FREQUENCY",
    "GEOSTATIC",
    "HEAT TRANSFER",
    "KINEMATIC",
    "KINEMATIC COUPLING",
    "MPC",
    "RIGID BODY",
    "SOILS",
    "STEADY STATE DYNAMICS",
    "TIE",
    "TRANSFORM",
];
/// Keywords that write a job for its author.
const GENERATORS: [&str; 7] = ["ELCOPY", "ELGEN", "NCOPY", "NFILL", "NGEN", "NMAP", "SYSTEM"];

/// A user material.
#[derive(Clone, Debug)]
pub(super) struct Material {
    pub(super) name: String,
    pub(super) place: LinePosition,
    pub(super) constants: Vec<f64>,
    /// NSTATV.
    pub(super) states: usize,
    /// *EXPANSION in the form of a case.
    pub(super) expansion: Option<Value>,
    /// What is not imported of it, with places.
    pub(super) left_out: Vec<String>,
    is_user: bool,
}

/// The state before the first step.
#[derive(Clone, Debug, Default)]
pub(super) struct Initial {
    pub(super) stress: Vec<f64>,
    pub(super) states: Vec<f64>,
    pub(super) temperature: Option<f64>,
    pub(super) fields: Vec<f64>,
}

/// Changes that a step makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Quantity {
    /// Component of a node, by its axis from 0.
    Displacement(u64, usize),
    /// Force component of a node, by its axis from 0.
    Force(u64, usize),
    /// Load on a face, counted from 1; those of surfaces and of elements add up.
    Pressure {
        face: usize,
        of_surface: bool,
    },
    Temperature,
    /// A field variable, from 0.
    Field(usize),
}

impl Initial {
    /// Returns the value of a quantity before the first step.
    pub(super) fn of(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Temperature => self.temperature.unwrap_or(0.0),
            Quantity::Field(index) => self.fields.get(index).copied().unwrap_or(0.0),
            _ => 0.0,
        }
    }
}

impl Quantity {
    /// The keyword that OP=NEW is of.
    pub(super) fn keyword(self) -> &'static str {
        match self {
            Self::Displacement(..) => "BOUNDARY",
            Self::Force(..) => "CLOAD",
            Self::Pressure { of_surface: true, .. } => "DSLOAD",
            Self::Pressure { of_surface: false, .. } => "DLOAD",
            Self::Temperature => "TEMPERATURE",
            Self::Field(_) => "FIELD",
        }
    }
}

/// A new value of a quantity.
#[derive(Clone, Debug)]
pub(super) struct Change {
    pub(super) quantity: Quantity,
    pub(super) value: f64,
    /// Name of its amplitude.
    pub(super) amplitude: Option<String>,
    pub(super) place: LinePosition,
}

/// A factor over time.
#[derive(Clone, Debug)]
pub(super) struct Amplitude {
    pub(super) of_total_time: bool,
    pub(super) points: Vec<(f64, f64)>,
    /// Reason why it cannot be used.
    pub(super) refusal: Option<String>,
}

/// A step.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) place: LinePosition,
    pub(super) nlgeom: Option<bool>,
    pub(super) time: f64,
    pub(super) increment: f64,
    pub(super) has_procedure: bool,
    /// Values without an amplitude jump at its start: AMPLITUDE=STEP, or the default of *VISCO.
    pub(super) at_once: bool,
    /// Keywords whose earlier values were replaced.
    pub(super) anew: BTreeSet<String>,
    pub(super) changes: Vec<Change>,
}

struct Element {
    shape: Shape,
    nodes: Vec<u64>,
    place: LinePosition,
}

struct Section {
    material: String,
    thickness: f64,
    orientation: Option<String>,
    place: LinePosition,
}

/// The model as read so far.
#[derive(Default)]
pub(super) struct Model {
    pub(super) title: Option<String>,
    pub(super) initial: Initial,
    pub(super) amplitudes: BTreeMap<String, Amplitude>,
    /// Values at the start, all 0.
    pub(super) fixed: Vec<Change>,
    pub(super) steps: Vec<Step>,
    pub(super) left_out: Vec<String>,
    nodes: BTreeMap<u64, [f64; 3]>,
    node_sets: BTreeMap<String, BTreeSet<u64>>,
    element: Option<Element>,
    element_sets: BTreeMap<String, BTreeSet<u64>>,
    surfaces: BTreeMap<String, Vec<usize>>,
    section: Option<Section>,
    materials: Vec<Material>,
    orientations: BTreeMap<String, Axes>,
    /// Where an instance is moved.
    shifted: Option<LinePosition>,
    /// The keywords belong to the last material.
    is_in_material: bool,
    /// The present *STEP is left out.
    is_in_perturbation: bool,
    /// Where the first step that is left out begins.
    perturbation: Option<LinePosition>,
    /// AMPLITUDE of the present *STEP.
    variation: Option<String>,
}

impl Model {
    /// Takes a keyword over.
    ///
    /// # Errors
    /// Why there can be no case of this job.
    pub(super) fn take(&mut self, keyword: &Keyword) -> Result<(), String> {
        let count = self.left_out.len();
        let is_understood = self.take_over(keyword)?;
        self.is_in_material = match keyword.name.as_str() {
            "MATERIAL" | "USER MATERIAL" | "DEPVAR" | "EXPANSION" => true,
            _ => self.is_in_material && !is_understood,
        };
        if let Some(material) = self.materials.last_mut().filter(|_| self.is_in_material) {
            material.left_out.extend_from_slice(&self.left_out[count..]);
        }
        Ok(())
    }

    /// Takes a keyword over; returns whether it is one that is understood.
    fn take_over(&mut self, keyword: &Keyword) -> Result<bool, String> {
        let place = &keyword.place;
        if self.is_in_perturbation && !["AMPLITUDE", "STEP", "END STEP"].contains(&keyword.name.as_str()) {
            return Ok(true);
        }
        if keyword.name != "AMPLITUDE" {
            for option in not_understood(keyword) {
                self.left_out.push(format!("{place}: {option} of *{}", keyword.name));
            }
        }
        match keyword.name.as_str() {
            "HEADING" => self.title = keyword.data.first().map(|line| line.fields.join(", ")),
            "NODE" => self.node(keyword)?,
            "NSET" => self.node_set(keyword)?,
            "ELEMENT" => self.element(keyword)?,
            "ELSET" => {
                let sets = &self.element_sets;
                let members = members(keyword, |name| sets.get(name).cloned())?;
                self.element_sets.entry(name_of(keyword, "ELSET")?).or_default().extend(members);
            }
            "SURFACE" => self.surface(keyword)?,
            "INSTANCE" if keyword.data.len() > 1 => {
                return Err(format!("{place}: a rotated instance cannot be imported"));
            }
            "INSTANCE" => {
                if let Some(line) = keyword.data.first()
                    && line.numbers(0)?.iter().any(|shift| *shift != 0.0)
                {
                    self.shifted = Some(line.place.clone());
                }
            }
            "SOLID SECTION" => self.section(keyword)?,
            "MATERIAL" => self.materials.push(Material {
                name: name_of(keyword, "NAME")?,
                place: place.clone(),
                constants: Vec::new(),
                states: 0,
                expansion: None,
                left_out: Vec::new(),
                is_user: false,
            }),
            "EXPANSION" => self.expansion(keyword)?,
            "ORIENTATION" => self.orientation(keyword)?,
            "USER MATERIAL" => self.constants(keyword)?,
            "DEPVAR" => {
                let material =
                    self.materials.last_mut().ok_or_else(|| format!("{place}: *DEPVAR outside a material"))?;
                material.states = keyword.data.first().map_or(Ok(0.0), |line| line.number(0))? as usize;
            }
            "AMPLITUDE" => self.amplitude(keyword)?,
            "INITIAL CONDITIONS" => self.initial_conditions(keyword)?,
            "STEP" => self.step(keyword),
            "STATIC" | "VISCO" => self.procedure(keyword)?,
            "BOUNDARY" => self.boundary(keyword)?,
            "CLOAD" | "DLOAD" | "DSLOAD" | "TEMPERATURE" | "FIELD" => self.load(keyword)?,
            "END STEP" => self.is_in_perturbation = false,
            "PARAMETER" => return Err(format!("{place}: *PARAMETER is not imported: write the numbers in")),
            name if GENERATORS.contains(&name) => {
                return Err(format!(
                    "{place}: *{name} is not imported: write out the nodes and elements that it makes"
                ));
            }
            name if REFUSED.contains(&name) => {
                return Err(format!("{place}: *{name} makes it another problem than that of a material point"));
            }
            name if OF_NO_MATTER.contains(&name) => {}
            name => {
                self.left_out.push(format!("{place}: *{name}"));
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Returns why there is nothing to run; `None` if there are steps.
    pub(super) fn without_steps(&self) -> Option<String> {
        let reason = || match &self.perturbation {
            Some(place) => format!("{place}: *STEP, PERTURBATION is left out, and there is no other step"),
            None => "has no step".to_owned(),
        };
        self.steps.is_empty().then(reason)
    }

    /// Where the section of the element begins.
    pub(super) fn section_place(&self) -> Option<&LinePosition> {
        self.section.as_ref().map(|section| &section.place)
    }

    /// The user material of a name.
    pub(super) fn material(&self, name: &str) -> Result<&Material, String> {
        let users = || self.materials.iter().filter(|material| material.is_user);
        users().find(|material| material.name.eq_ignore_ascii_case(name)).ok_or_else(|| {
            let names: Vec<_> = users().map(|material| material.name.as_str()).collect();
            let there = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            format!("has no *USER MATERIAL {name}; there is {there}")
        })
    }

    /// The element, and what it is of.
    pub(super) fn brick_and_material(&self) -> Result<(Brick, &Material), String> {
        let Some(element) = &self.element else {
            return Err("has no element; --material NAME imports only a material".into());
        };
        let coordinates = element.nodes.iter().map(|node| self.nodes.get(node).copied());
        let coordinates: Option<Vec<_>> = coordinates.collect();
        let coordinates = coordinates.ok_or_else(|| format!("{}: a node of the element is missing", element.place))?;
        let thickness = self.section.as_ref().map_or(1.0, |section| section.thickness);
        let brick = Brick::new(element.shape, &coordinates, thickness);
        let brick = brick.ok_or_else(|| format!("{}: the element is no box along the axes", element.place))?;
        if let Some(place) = self.shifted.as_ref().filter(|_| brick.is_axisymmetric()) {
            return Err(format!("{place}: a moved axisymmetric instance cannot be imported: write its radii in"));
        }
        let section = self.section.as_ref().ok_or("has no *SOLID SECTION")?;
        Ok((brick, self.material(&section.material)?))
    }

    /// The place of a node in the element.
    pub(super) fn node_in_element(&self, node: u64) -> Option<usize> {
        self.element.as_ref()?.nodes.iter().position(|other| *other == node)
    }

    fn node(&mut self, keyword: &Keyword) -> Result<(), String> {
        if keyword.parameter("SYSTEM").is_some_and(|system| !system.eq_ignore_ascii_case("R")) {
            return Err(format!("{}: only rectangular coordinates can be imported", keyword.place));
        }
        let mut labels = BTreeSet::new();
        for line in &keyword.data {
            let label = label(line, 0)?;
            self.nodes.insert(label, [line.number(1)?, line.number(2)?, line.number(3)?]);
            labels.insert(label);
        }
        if let Some(set) = keyword.capitals("NSET") {
            self.node_sets.entry(set).or_default().extend(labels);
        }
        Ok(())
    }

    fn node_set(&mut self, keyword: &Keyword) -> Result<(), String> {
        let sets = &self.node_sets;
        let mut found = members(keyword, |name| sets.get(name).cloned())?;
        if keyword.parameter("ELSET").is_some() {
            found.extend(self.element.iter().flat_map(|element| element.nodes.iter().copied()));
        }
        self.node_sets.entry(name_of(keyword, "NSET")?).or_default().extend(found);
        Ok(())
    }

    fn element(&mut self, keyword: &Keyword) -> Result<(), String> {
        let kind = name_of(keyword, "TYPE")?;
        let Some(shape) = Shape::of(&kind) else {
            return Err(format!(
                "{}: elements {kind} make no material point (C3D8, C3D20, CPE4, CPS4, CAX4 and their \
                                kin do)",
                keyword.place
            ));
        };
        let mut lines = keyword.data.iter();
        while let Some(line) = lines.next() {
            if let Some(other) = &self.element {
                return Err(format!(
                    "{}: a second element, after {}: only a job of one is a material point",
                    line.place, other.place
                ));
            }
            let mut fields = line.fields.clone();
            while fields.len() <= shape.nodes {
                let next = lines.next().ok_or_else(|| format!("{}: {kind} has {} nodes", line.place, shape.nodes))?;
                fields.extend(next.fields.iter().cloned());
            }
            let all = Data { place: line.place.clone(), fields };
            let nodes = (1..=shape.nodes).map(|field| label(&all, field)).collect::<Result<_, _>>()?;
            let label = label(&all, 0)?;
            self.element = Some(Element { shape, nodes, place: line.place.clone() });
            if let Some(set) = keyword.capitals("ELSET") {
                self.element_sets.entry(set).or_default().insert(label);
            }
        }
        Ok(())
    }

    fn surface(&mut self, keyword: &Keyword) -> Result<(), String> {
        let mut faces = Vec::new();
        for line in &keyword.data {
            match face(line.text(1), 'S') {
                Some(face) => faces.push(face),
                None => self.left_out.push(format!("{}: a surface that is no face S1, S2, …", line.place)),
            }
        }
        self.surfaces.insert(name_of(keyword, "NAME")?, faces);
        Ok(())
    }

    fn section(&mut self, keyword: &Keyword) -> Result<(), String> {
        if keyword.parameter("COMPOSITE").is_some() {
            self.left_out.push(format!("{}: COMPOSITE of the section", keyword.place));
        }
        let thickness = keyword.data.first().map_or(Ok(0.0), |line| line.number(0))?;
        let thickness = if thickness > 0.0 { thickness } else { 1.0 };
        let (material, orientation) = (name_of(keyword, "MATERIAL")?, keyword.capitals("ORIENTATION"));
        self.section = Some(Section { material, thickness, orientation, place: keyword.place.clone() });
        Ok(())
    }

    /// The local axes of the element's section.
    ///
    /// # Errors
    /// They cannot be imported, with the line that says so.
    pub(super) fn local_axes(&self) -> Result<Option<&Axes>, String> {
        let section = self.section.as_ref();
        let Some((place, name)) = section.and_then(|section| Some((&section.place, section.orientation.as_ref()?)))
        else {
            return Ok(None);
        };
        match self.orientations.get(name) {
            None => Err(format!("{place}: there is no *ORIENTATION {name}")),
            Some(Axes::Unknown(reason)) => Err(format!("{reason} cannot be imported")),
            Some(axes) => Ok(Some(axes)),
        }
    }

    fn expansion(&mut self, keyword: &Keyword) -> Result<(), String> {
        let place = &keyword.place;
        let count = match keyword.capitals("TYPE").as_deref() {
            None | Some("ISO") => 1,
            Some("ORTHO") => 3,
            Some(_) => 0,
        };
        let depends = keyword.parameter("DEPENDENCIES").is_some_and(|count| count.parse() != Ok(0));
        if count == 0 || depends || keyword.parameter("USER").is_some() || keyword.data.is_empty() {
            self.left_out.push(format!("{place}: *EXPANSION that is neither ISO nor ORTHO over the temperature alone"));
            return Ok(());
        }
        let zero = keyword.parameter("ZERO").map_or(Ok(0.0), str::parse::<f64>);
        let zero = zero.map_err(|_| format!("{place}: ZERO is no number"))?;
        let (mut coefficients, mut temperatures) = (Vec::new(), Vec::new());
        for line in &keyword.data {
            let values = (0..count).map(|field| line.number(field)).collect::<Result<Vec<_>, _>>()?;
            coefficients.push(if count == 1 { json!(values[0]) } else { json!(values) });
            temperatures.push(line.number(count)?);
        }
        let mut expansion = json!({ "zero_temperature": zero });
        if let [only] = &coefficients[..] {
            expansion["alpha"] = only.clone();
        } else {
            (expansion["alpha"], expansion["temperatures"]) = (json!(coefficients), json!(temperatures));
        }
        let material = self.materials.last_mut().ok_or_else(|| format!("{place}: *EXPANSION outside a material"))?;
        material.expansion = Some(expansion);
        Ok(())
    }

    fn orientation(&mut self, keyword: &Keyword) -> Result<(), String> {
        let axes = orientation::read(keyword)?;
        if let Axes::Unknown(reason) = &axes {
            self.left_out.push(reason.clone());
        }
        self.orientations.insert(name_of(keyword, "NAME")?, axes);
        Ok(())
    }

    fn constants(&mut self, keyword: &Keyword) -> Result<(), String> {
        let place = &keyword.place;
        if keyword.capitals("TYPE").is_some_and(|kind| kind != "MECHANICAL") {
            self.left_out.push(format!("{place}: *USER MATERIAL that is not mechanical"));
            return Ok(());
        }
        let material =
            self.materials.last_mut().ok_or_else(|| format!("{place}: *USER MATERIAL outside a material"))?;
        let mut constants = Vec::new();
        for line in &keyword.data {
            // what a line before leaves out is 0
            constants.resize(constants.len().next_multiple_of(VALUES_A_LINE), 0.0);
            constants.extend(line.numbers(0)?);
        }
        let wanted = keyword.parameter("CONSTANTS").and_then(|count| count.parse::<usize>().ok());
        let wanted = wanted.ok_or_else(|| format!("{place}: CONSTANTS is no number"))?;
        if constants.len() != wanted {
            return Err(format!("{place}: CONSTANTS={wanted}, but {} are given", constants.len()));
        }
        (material.constants, material.is_user) = (constants, true);
        Ok(())
    }

    fn amplitude(&mut self, keyword: &Keyword) -> Result<(), String> {
        let definition = keyword.capitals("DEFINITION").unwrap_or_else(|| "TABULAR".into());
        let smoothed = keyword.parameter("SMOOTH").is_some_and(|smooth| smooth.parse::<f64>() != Ok(0.0));
        let refusal = if definition != "TABULAR" {
            Some(format!("{}: an amplitude by {definition}", keyword.place))
        } else if smoothed || keyword.capitals("VALUE").is_some_and(|value| value != "RELATIVE") {
            Some(format!("{}: an amplitude with SMOOTH or VALUE", keyword.place))
        } else {
            let others = not_understood(keyword);
            others.first().map(|option| format!("{}: an amplitude with {option}", keyword.place))
        };
        let mut points = Vec::new();
        for line in keyword.data.iter().filter(|_| refusal.is_none()) {
            points.extend(line.numbers(0)?.chunks_exact(2).map(|pair| (pair[0], pair[1])));
        }
        let of_total_time = keyword.capitals("TIME").is_some_and(|time| time.starts_with("TOTAL"));
        let amplitude = Amplitude { of_total_time, points, refusal };
        self.amplitudes.insert(name_of(keyword, "NAME")?, amplitude);
        Ok(())
    }

    fn initial_conditions(&mut self, keyword: &Keyword) -> Result<(), String> {
        let kind = keyword.capitals("TYPE").unwrap_or_default();
        if let Some(option) = keyword.first_of(&["USER", "GEOSTATIC", "FILE", "INPUT", "SECTION POINTS"]) {
            self.left_out.push(format!("{}: initial {kind} by {option}", keyword.place));
            return Ok(());
        }
        let Some(first) = keyword.data.first() else { return Ok(()) };
        match kind.as_str() {
            "STRESS" => self.initial.stress = first.numbers(1)?,
            "SOLUTION" => {
                let mut states = first.numbers(1)?;
                for line in &keyword.data[1..] {
                    states.extend(line.numbers(0)?);
                }
                self.initial.states = states;
            }
            "TEMPERATURE" => self.initial.temperature = Some(self.same_everywhere(keyword)?),
            "FIELD" => {
                let (index, value) = (variable(keyword)?, self.same_everywhere(keyword)?);
                let fields = &mut self.initial.fields;
                fields.resize(fields.len().max(index + 1), 0.0);
                fields[index] = value;
            }
            _ => self.left_out.push(format!("{}: initial {kind}", keyword.place)),
        }
        Ok(())
    }

    fn step(&mut self, keyword: &Keyword) {
        self.is_in_perturbation = keyword.parameter("PERTURBATION").is_some();
        if self.is_in_perturbation {
            let message = "*STEP, PERTURBATION: the linear response about the state before it: the step is left out";
            self.left_out.push(format!("{}: {message}", keyword.place));
            self.perturbation.get_or_insert_with(|| keyword.place.clone());
            return;
        }
        let nlgeom = keyword.capitals("NLGEOM").map(|value| value != "NO");
        self.variation = keyword.capitals("AMPLITUDE");
        self.steps.push(Step {
            place: keyword.place.clone(),
            nlgeom,
            time: ONE,
            increment: ONE,
            has_procedure: false,
            at_once: false,
            anew: BTreeSet::new(),
            changes: Vec::new(),
        });
    }

    fn procedure(&mut self, keyword: &Keyword) -> Result<(), String> {
        let place = &keyword.place;
        let step = self.steps.last_mut().ok_or_else(|| format!("{place}: *{} outside a step", keyword.name))?;
        step.has_procedure = true;
        step.at_once = self.variation.as_ref().map_or(keyword.name == "VISCO", |variation| variation == "STEP");
        if keyword.parameter("RIKS").is_some() {
            return Err(format!("{place}: a load of unknown size (RIKS) cannot be imported"));
        }
        if let Some(line) = keyword.data.first() {
            let (increment, time) = (line.number(0)?, line.number(1)?);
            step.time = if time > 0.0 { time } else { ONE };
            step.increment = if increment > 0.0 { increment.min(step.time) } else { step.time };
            if keyword.parameter("DIRECT").is_none() && step.increment < step.time {
                self.left_out
                    .push(format!("{place}: automatic increments: all are as large as the first, {}", step.increment));
            }
        }
        Ok(())
    }

    fn boundary(&mut self, keyword: &Keyword) -> Result<(), String> {
        if let Some(option) = keyword.first_of(&["USER", "FIXED", "SUBMODEL"]) {
            return Err(format!("{}: *BOUNDARY, {option} cannot be imported", keyword.place));
        }
        if keyword.capitals("TYPE").is_some_and(|kind| kind != "DISPLACEMENT") {
            return Err(format!("{}: only displacements are taken over", keyword.place));
        }
        for line in &keyword.data {
            let axes = match line.text(1).to_ascii_uppercase().as_str() {
                "ENCASTRE" | "PINNED" => 0..3,
                "XSYMM" => 0..1,
                "YSYMM" => 1..2,
                "ZSYMM" => 2..3,
                _ => {
                    let first = label(line, 1)? as usize;
                    let last = if line.text(2).is_empty() { first } else { label(line, 2)? as usize };
                    if first == 0 {
                        return Err(format!("{}: there is no degree of freedom 0", line.place));
                    }
                    if last > 3 {
                        self.left_out.push(format!("{}: degrees of freedom beyond 3", line.place));
                    }
                    first - 1..last.min(3)
                }
            };
            let value = line.number(3)?;
            for node in self.nodes_of(line)? {
                let changes = axes.clone().map(|axis| Quantity::Displacement(node, axis));
                self.change(keyword, line, value, changes.collect())?;
            }
        }
        self.anew(keyword, "BOUNDARY");
        Ok(())
    }

    fn load(&mut self, keyword: &Keyword) -> Result<(), String> {
        if self.steps.is_empty() {
            return Err(format!("{}: *{} outside a step", keyword.place, keyword.name));
        }
        if let Some(option) = keyword.first_of(&["USER", "FILE", "FOLLOWER", "CYCLIC MODE"]) {
            self.left_out.push(format!("{}: *{} by {option}", keyword.place, keyword.name));
            return Ok(());
        }
        for line in &keyword.data {
            let (quantities, value) = match keyword.name.as_str() {
                "CLOAD" => {
                    let axis = label(line, 1)?.checked_sub(1).filter(|axis| *axis < 3);
                    let axis = axis.ok_or_else(|| format!("{}: a force along 1, 2 or 3 is wanted", line.place))?;
                    let nodes = self.nodes_of(line)?.into_iter();
                    (nodes.map(|node| Quantity::Force(node, axis as usize)).collect(), line.number(2)?)
                }
                "DSLOAD" => {
                    let surface = self.surfaces.get(&local(line.text(0))).cloned();
                    let faces =
                        surface.ok_or_else(|| format!("{}: there is no surface {}", line.place, line.text(0)))?;
                    if !line.text(1).eq_ignore_ascii_case("P") {
                        self.left_out.push(format!("{}: a load {}", line.place, line.text(1)));
                        continue;
                    }
                    let pressure = |face| Quantity::Pressure { face, of_surface: true };
                    (faces.into_iter().map(pressure).collect(), line.number(2)?)
                }
                "DLOAD" => {
                    let Some(face) = face(line.text(1), 'P') else {
                        self.left_out.push(format!("{}: a load {}", line.place, line.text(1)));
                        continue;
                    };
                    (vec![Quantity::Pressure { face, of_surface: false }], line.number(2)?)
                }
                "FIELD" => (vec![Quantity::Field(variable(keyword)?)], self.same_everywhere(keyword)?),
                _ => (vec![Quantity::Temperature], self.same_everywhere(keyword)?),
            };
            self.change(keyword, line, value, quantities)?;
        }
        self.anew(keyword, &keyword.name);
        Ok(())
    }

    fn change(&mut self, keyword: &Keyword, line: &Data, value: f64, quantities: Vec<Quantity>) -> Result<(), String> {
        let amplitude = keyword.capitals("AMPLITUDE");
        let place = line.place.clone();
        let changes = quantities.into_iter().map(|quantity| Change {
            quantity,
            value,
            amplitude: amplitude.clone(),
            place: place.clone(),
        });
        match self.steps.last_mut() {
            Some(step) => {
                for change in changes {
                    let is_load = matches!(change.quantity, Quantity::Force(..) | Quantity::Pressure { .. });
                    let is_same = |other: &&Change| other.quantity == change.quantity;
                    if let Some(other) = step.changes.iter().find(is_same).filter(|_| is_load) {
                        let message = format!("{}: a load: that of {} replaces it", other.place, change.place);
                        if !self.left_out.contains(&message) {
                            self.left_out.push(message);
                        }
                    }
                    step.changes.push(change);
                }
            }
            None if value != 0.0 => return Err(format!("{place}: a displacement other than 0 before the first step")),
            None => self.fixed.extend(changes),
        }
        Ok(())
    }

    fn anew(&mut self, keyword: &Keyword, name: &str) {
        if let Some(step) = self.steps.last_mut().filter(|_| keyword.capitals("OP").as_deref() == Some("NEW")) {
            step.anew.insert(name.to_owned());
        }
    }

    /// The value that all data lines give to all corners of the element.
    fn same_everywhere(&self, keyword: &Keyword) -> Result<f64, String> {
        let Some(first) = keyword.data.first() else { return Ok(0.0) };
        let value = first.number(1)?;
        let mut nodes = BTreeSet::new();
        for line in &keyword.data {
            nodes.extend(self.nodes_of(line)?);
            if line.number(1)? != value {
                return Err(format!("{}: a temperature or field that is not the same at all nodes", line.place));
            }
        }
        let corners = self.element.iter().flat_map(|element| element.nodes.iter().take(element.shape.corners));
        match corners.copied().find(|node| !nodes.contains(node)) {
            Some(node) => {
                Err(format!("{}: a temperature or field of some nodes of the element, not of {node}", first.place))
            }
            None => Ok(value),
        }
    }

    /// The nodes that the first field of a line names.
    fn nodes_of(&self, line: &Data) -> Result<BTreeSet<u64>, String> {
        let name = local(line.text(0));
        if let Ok(node) = name.parse() {
            return Ok(BTreeSet::from([node]));
        }
        self.node_sets.get(&name).cloned().ok_or_else(|| format!("{}: there is no node set {name}", line.place))
    }
}

/// A name without its instance, in capitals.
fn local(name: &str) -> String {
    name.rsplit('.').next().unwrap_or(name).trim_matches('"').to_ascii_uppercase()
}

fn name_of(keyword: &Keyword, parameter: &str) -> Result<String, String> {
    keyword.capitals(parameter).ok_or_else(|| format!("{}: *{} needs {parameter}", keyword.place, keyword.name))
}

fn label(line: &Data, field: usize) -> Result<u64, String> {
    let text = line.text(field);
    text.parse().map_err(|_| format!("{}: '{text}' is not a whole number", line.place))
}

/// Index of the field variable.
fn variable(keyword: &Keyword) -> Result<usize, String> {
    const MOST: usize = 100;
    let number = keyword.parameter("VARIABLE").map_or(Ok(1), str::parse);
    let number = number.ok().filter(|number| (1..=MOST).contains(number));
    number.map(|number| number - 1).ok_or_else(|| format!("{}: VARIABLE is from 1 to {MOST}", keyword.place))
}

/// The number of a face: S1, P1, …
fn face(text: &str, letter: char) -> Option<usize> {
    text.to_ascii_uppercase().strip_prefix(letter)?.parse().ok()
}

/// The labels on data lines, of other sets, or with GENERATE from a first to a last one.
fn members(keyword: &Keyword, set: impl Fn(&str) -> Option<BTreeSet<u64>>) -> Result<BTreeSet<u64>, String> {
    const MOST: u64 = 1000;
    let mut labels = BTreeSet::new();
    for line in &keyword.data {
        if keyword.parameter("GENERATE").is_some() {
            let (first, last) = (label(line, 0)?, label(line, 1)?);
            let step = if line.text(2).is_empty() { 1 } else { label(line, 2)? };
            if step == 0 || last.saturating_sub(first) / step > MOST {
                return Err(format!("{}: more than {MOST} members are not those of one element", line.place));
            }
            labels.extend((first..=last).step_by(step as usize));
            continue;
        }
        for field in 0..line.fields.len() {
            match set(&local(line.text(field))) {
                Some(others) => labels.extend(others),
                None => {
                    let name = local(line.text(field));
                    labels.insert(name.parse().map_err(|_| format!("{}: there is no set {name}", line.place))?);
                }
            }
        }
    }
    Ok(labels)
}

//! The mesh: a specimen's or a file's, with the parts' models and thicknesses.

use super::generated::generate;
use crate::document::PulloutCase;
use crate::document::pullout as document;
use crate::problem::{Place, hint, nearest};
use crate::reader::{Reader, UsedDefaults};
use fe_core::kinematics::PlaneModel;
use fe_core::mesh::specimen::{PulledFibre, Specimen, SpecimenError};
use fe_core::mesh::{Mesh, MeshDefinition, Part, gmsh};
use pullout_run::input::{self, Input};
use pullout_run::number::significant;
use pullout_run::pullout::FibreAxis;
use pullout_run::pullout::section::{EQUAL_AREA, EQUAL_INERTIA};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

/// The part around a fibre.
pub const MATRIX: &str = "matrix";
/// The part of a specimen that consists of matrix concrete on both faces of the fibre.
pub const COVER: &str = "cover";

/// A mesh as its maker gave it, and what the specimen says where the case says nothing.
#[derive(Clone, Debug, Default)]
pub struct MeshAndSets {
    /// Description of the mesh for the report.
    pub words: String,
    /// The mesh with its fibres and contact pairs, those of the fibres' ends among them; of a file the mesh alone.
    pub specimen: Specimen,
    /// Ways to be held: their names, and the node sets that they hold in both directions, or in one. The first is the
    /// default.
    pub supports: Vec<DefaultSupports>,
    /// Node set that is pulled.
    pub grip: Option<&'static str>,
    /// Whether each of several fibres has a drive of its own.
    pub grips_each: bool,
}

impl MeshAndSets {
    /// The fibre that is alone.
    pub fn lone_fibre(&self) -> Option<&PulledFibre> {
        if let [fibre] = &self.specimen.fibres[..] { Some(fibre) } else { None }
    }

    /// The fibres, if there are several.
    pub fn several_fibres(&self) -> &[PulledFibre] {
        if self.lone_fibre().is_none() { &self.specimen.fibres } else { &[] }
    }

    /// How deep the fibre that is alone lies in the block, along its axis, and where it points.
    pub fn axis(&self) -> Option<FibreAxis> {
        let fibre = self.lone_fibre()?;
        let at = |station: &[usize; 3]| self.specimen.definition.nodes[station[1]];
        let within = fibre.stations.iter().take_while(|station| station[1] != fibre.exit_node).count();
        let stations: Vec<[f64; 2]> = fibre.stations.get(..=within)?.iter().map(at).collect();
        let step = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        Some(FibreAxis { embedded: stations.windows(2).map(step).sum(), direction: fibre.direction })
    }

    /// The diameter of all fibres, mm, if it is one.
    pub fn diameter(&self) -> Option<f64> {
        let fibres = &self.specimen.fibres;
        let diameter = fibres.first()?.diameter;
        fibres.iter().all(|fibre| fibre.diameter == diameter).then_some(diameter)
    }
}

/// A way in which a specimen is held.
#[derive(Clone, Debug)]
pub struct DefaultSupports {
    pub name: &'static str,
    pub supports: Vec<Held>,
}

impl DefaultSupports {
    /// Its name with what it holds, for messages.
    pub fn in_words(&self) -> String {
        let held = self.supports.iter().map(|(set, directions)| {
            let along = match directions {
                [[_, 0.0]] => "x",
                [[0.0, _]] => "y",
                _ => "both",
            };
            if *set == self.name { along.to_owned() } else { format!("{set}: {along}") }
        });
        format!("{} ({})", self.name, held.collect::<Vec<_>>().join(", "))
    }
}

/// A node set, and the directions in which it is held.
pub type Held = (&'static str, &'static [[f64; 2]]);

/// Slip over embedded length beyond which the slip is hardly meant: all fibres have left the block long before.
const USUAL_SLIPS: f64 = 10.0;

/// Warns of a slip that is many times the length of the fibre that is embedded most.
fn warn_of_slip(reader: &mut Reader<'_>, slip: f64, definition: &MeshDefinition, fibres: &[PulledFibre]) {
    let length = |fibre: &PulledFibre| {
        let [[x, y], [of_tail, at_tail]] = [fibre.exit_node, fibre.tail_node].map(|node| definition.nodes[node]);
        (x - of_tail).hypot(y - at_tail)
    };
    let embedded = fibres.iter().map(length).fold(0.0, f64::max);
    if !fibres.is_empty() && slip > USUAL_SLIPS * embedded {
        let [slip, embedded] = [slip, embedded].map(|length| significant(length, 4));
        reader.warn(format!("steps: slip = {slip} mm is many times the embedded length, {embedded} mm: is it in mm?"));
    }
}

/// Makes or reads the mesh.
pub fn resolve(reader: &mut Reader<'_>, case: &PulloutCase) -> Option<MeshAndSets> {
    let place = Place::root().key("mesh");
    match &case.mesh {
        document::MeshSource::Specimen(source) => {
            let place = place.key("specimen");
            let mut taken = UsedDefaults::default();
            let slip = super::steps::greatest_slip(case);
            match generate(&source.specimen, thickness_of(case, MATRIX), slip, &mut taken) {
                Ok(mut ground) => {
                    let diameter = ground.diameter();
                    let Specimen { definition, fibres, notes, .. } = &mut ground.specimen;
                    adapt_parts(reader, case, definition, diameter);
                    let thickness = |key: &str| Place::root().key("parts").key(key).key("thickness");
                    let is_fibre = |key: &str| {
                        let mut names = fibres.iter().map(|fibre| definition.parts[fibre.part].name.as_str());
                        names.any(|name| section_of(case, name).0 == key)
                    };
                    for (key, _) in case.parts.iter().filter(|(_, part)| is_layered(part.thickness)) {
                        if !is_fibre(key) {
                            reader.problem(&thickness(key), "layers are those of a fibre's section: give it in mm");
                        }
                    }
                    for fibre in fibres.iter() {
                        let name = definition.parts[fibre.part].name.clone();
                        let (key, section) = section_of(case, &name);
                        let part = &definition.parts[fibre.part];
                        if is_layered(section) {
                            layer(reader, definition, fibre, &thickness(key));
                        } else if part.model != PlaneModel::Axisymmetric {
                            note_section(reader, fibre.diameter, part.thickness);
                        }
                    }
                    warn_of_slip(reader, slip, definition, fibres);
                    notes.drain(..).for_each(|note| reader.note(note));
                    reader.note_defaults(&place, &taken.0);
                    Some(ground)
                }
                Err(SpecimenError::Parameters { problems }) => {
                    for problem in problems {
                        // a sum of parameters is reported at its first
                        let key = problem.name.split_whitespace().next().unwrap_or(problem.name);
                        let of_fibre = problem.fibre.map(|index| place.key("fibres").index(index));
                        let of = of_fibre.unwrap_or_else(|| place.clone());
                        reader.problem(
                            &key.split('.').fold(of, |place, key| place.key(key)),
                            format!("is {}, it must be {}", problem.value, problem.requirement),
                        );
                    }
                    None
                }
                Err(error) => {
                    reader.problem(&place, error.to_string());
                    None
                }
            }
        }
        document::MeshSource::File(source) => {
            let parts = file_parts(reader, case);
            let place = place.key("file");
            let file = reader.file(&source.file, &place)?;
            let bytes = input::read(&file, Input::Mesh);
            let bytes = bytes.map_err(|error| format!("{} cannot be read: {error}", file.display()));
            let bytes = reader.without_problem(bytes, &place)?;
            let (definition, turned) = reader.without_problem(gmsh::read(&file, &bytes, &parts), &place)?;
            if let Some(first) = turned.first() {
                let which = match turned.len() {
                    1 => format!("element {first} has"),
                    count => format!("{count} elements (the first is {first}) have"),
                };
                reader.warn(format!("{}: {which} clockwise nodes: turned round", file.display()));
            }
            let specimen = Specimen { definition, ..Specimen::default() };
            Some(MeshAndSets { words: format!("file {}", source.file), specimen, ..MeshAndSets::default() })
        }
    }
}

/// Parts of the area of a round fibre by which that of the plane one may miss it without a warning.
const AREA_TOLERANCE: f64 = 0.05;

/// Notes the section of a round fibre in the plane, and warns of an area that falsifies its axial stress.
fn note_section(reader: &mut Reader<'_>, diameter: f64, thickness: f64) {
    let [area, inertia] = [EQUAL_AREA, EQUAL_INERTIA].map(|equal| thickness / (equal * diameter));
    let section = format!(
        "fibre: height {diameter} mm, thickness {thickness:.4} mm; area {area:.3} and bending inertia {inertia:.3} of the round one"
    );
    if (area - 1.0).abs() <= AREA_TOLERANCE {
        reader.note(section);
    } else {
        reader.warn(format!("{section}: its axial stress is {:.3} times that of the round one", 1.0 / area));
    }
}

/// Thicknesses of the inner and the outer half of a layered fibre's height, t and T, relative to its diameter. Its area
/// t φ/2 + T φ/2 = πφ²/4 and its plastic moment (t + 3 T) φ²/16 = φ³/6 are those of the circle.
const LAYERS: [f64; 2] = [0.75 * PI - 4.0 / 3.0, 4.0 / 3.0 - 0.25 * PI];

/// The name under which the case describes a part, and its thickness there.
fn section_of<'n>(case: &PulloutCase, name: &'n str) -> (&'n str, Option<document::Thickness>) {
    let key = called(name, |name| case.parts.contains_key(name));
    (key, thickness_of(case, key))
}

/// Returns whether a thickness is that of a round section's layers.
fn is_layered(section: Option<document::Thickness>) -> bool {
    matches!(section, Some(document::Thickness::Section(document::Section::Layers)))
}

/// Gives the elements of a round fibre the thicknesses of its layers.
fn layer(reader: &mut Reader<'_>, definition: &mut MeshDefinition, fibre: &PulledFibre, place: &Place) {
    let at = |node: usize| definition.nodes[node];
    let axis: Vec<[[f64; 2]; 2]> = fibre.stations.windows(2).map(|ends| [at(ends[0][1]), at(ends[1][1])]).collect();
    // of the middle of an element: the middle between its corners on both sides of a column
    let distance = |[x, y]: [f64; 2]| {
        let of = |[[a, b], [c, d]]: [[f64; 2]; 2]| {
            let (u, v) = (c - a, d - b);
            let share = (((x - a) * u + (y - b) * v) / (u * u + v * v)).clamp(0.0, 1.0);
            (x - a - share * u).hypot(y - b - share * v)
        };
        axis.iter().map(|piece| of(*piece)).fold(f64::INFINITY, f64::min)
    };
    let mut rows = [0_usize; 2];
    let mut thicknesses = BTreeMap::new();
    let elements = definition.elements.iter().enumerate().filter(|(_, element)| element.part == fibre.part);
    for (index, element) in elements {
        let corners = &element.nodes[..element.kind.corner_count()];
        let sum = corners.iter().fold([0.0; 2], |[x, y], &node| [x + at(node)[0], y + at(node)[1]]);
        let is_outer = distance(sum.map(|sum| sum / corners.len() as f64)) > 0.25 * fibre.diameter;
        rows[usize::from(is_outer)] += 1;
        thicknesses.insert(index, LAYERS[usize::from(is_outer)] * fibre.diameter);
    }
    if rows[0] != rows[1] || rows[0] % (2 * axis.len()) != 0 {
        reader.problem(place, "layers take an elements_across of 4 or 8 in the specimen");
        return;
    }
    definition.thicknesses.append(&mut thicknesses);
    reader.note(format!(
        "fibre: height {} mm, in layers {:.4} and {:.4} mm thick; area and plastic moment of the round one, 1.03 of its bending inertia",
        fibre.diameter,
        LAYERS[0] * fibre.diameter,
        LAYERS[1] * fibre.diameter
    ));
}

/// Usual thicknesses of plane parts, mm.
const USUAL_THICKNESS: [f64; 2] = [1e-3, 1e5];

/// Checks the mesh; its faults are reported at `mesh`. The nodes of a part are a set of its name, unless there is another.
pub fn checked(reader: &mut Reader<'_>, ground: &MeshAndSets) -> Option<Mesh> {
    let mut definition = ground.specimen.definition.clone();
    for part in definition.parts.iter().filter(|part| part.model != PlaneModel::Axisymmetric) {
        if !(USUAL_THICKNESS[0]..=USUAL_THICKNESS[1]).contains(&part.thickness) {
            let what = format!("the thickness of the part '{}'", part.name);
            reader.warn_unusual(&what, part.thickness, "mm", USUAL_THICKNESS);
        }
    }
    let (round, plane): (Vec<&Part>, Vec<&Part>) =
        definition.parts.iter().partition(|part| part.model == PlaneModel::Axisymmetric);
    if let (Some(round), Some(plane)) = (round.first(), plane.first()) {
        let message =
            format!("part '{}' is axisymmetric and this one is not: a mesh has an axis, or it has none", round.name);
        reader.problem(&Place::root().key("parts").key(&plane.name).key("model"), message);
    }
    for (index, part) in definition.parts.iter().enumerate() {
        let nodes = || {
            let elements = definition.elements.iter().filter(|element| element.part == index);
            BTreeSet::from_iter(elements.flat_map(|element| element.nodes.iter().copied())).into_iter().collect()
        };
        definition.node_sets.entry(part.name.clone()).or_insert_with(nodes);
    }
    reader.without_problem(Mesh::new(definition), &Place::root().key("mesh"))
}

/// Refuses the thickness of a body of revolution.
fn check_thickness(reader: &mut Reader<'_>, model: PlaneModel, given: &document::Part, place: &Place) {
    if model == PlaneModel::Axisymmetric && given.thickness.is_some() {
        reader.problem(&place.key("thickness"), "an axisymmetric part has none, it goes all around: leave it out");
    }
}

/// The thickness of a part, mm; `Err` if it refers to a fibre that the mesh does not have.
pub fn thickness(given: document::Thickness, diameter: Option<f64>) -> Result<f64, &'static str> {
    let section = match given {
        document::Thickness::Value(value) => return Ok(value.0),
        document::Thickness::Section(section) => section,
    };
    let diameter = diameter.ok_or("the mesh has no round fibre: give the thickness in mm")?;
    Ok(match section {
        document::Section::EqualArea | document::Section::Layers => EQUAL_AREA * diameter,
        document::Section::EqualInertia => EQUAL_INERTIA * diameter,
    })
}

/// The thickness that the case gives the part that it describes under a name.
fn thickness_of(case: &PulloutCase, name: &str) -> Option<document::Thickness> {
    case.parts.get(name)?.thickness
}

/// The parts of a file: plane strain of thickness 1 unless the case says otherwise.
fn file_parts(reader: &mut Reader<'_>, case: &PulloutCase) -> Vec<Part> {
    let mut parts = Vec::new();
    for (name, given) in &case.parts {
        let place = Place::root().key("parts").key(name);
        let thickness = given.thickness.map_or(Ok(1.0), |given| thickness(given, None));
        let thickness = reader.without_problem(thickness, &place.key("thickness")).unwrap_or(1.0);
        let model = given.model.unwrap_or(PlaneModel::PlaneStrain);
        check_thickness(reader, model, given, &place);
        parts.push(Part { name: name.clone(), model, thickness, integration: given.integration });
    }
    parts
}

/// Returns what the case calls a part of a specimen: by its name, or else the cover as the matrix and fibre.NAME as all fibres.
pub fn called(part: &str, is_listed: impl Fn(&str) -> bool) -> &str {
    match part {
        part if is_listed(part) => part,
        COVER => MATRIX,
        part => part.split_once('.').map_or(part, |(all, _)| all),
    }
}

/// Changes a specimen's parts to what the case says.
fn adapt_parts(reader: &mut Reader<'_>, case: &PulloutCase, definition: &mut MeshDefinition, diameter: Option<f64>) {
    let root = Place::root().key("parts");
    let given = &case.parts;
    let names: Vec<String> = definition.parts.iter().map(|part| part.name.clone()).collect();
    let is_listed = |name: &str| given.contains_key(name);
    let called = |part: &'_ str| called(part, is_listed).to_owned();
    let known: BTreeSet<String> = names.iter().map(|name| called(name)).chain(names.iter().cloned()).collect();
    let unknown: Vec<&String> = given.keys().filter(|name| !known.contains(*name)).collect();
    for name in &unknown {
        reader.problem(&root.key(name), format!("the specimen has no part '{name}'{}", hint(name, &known)));
    }
    if is_listed(COVER) && names.iter().any(|name| name == COVER) {
        reader.problem(&root.key(COVER), format!("is what the part '{MATRIX}' is: leave it out"));
    }
    for part in &mut definition.parts {
        let name = if part.name == COVER { MATRIX.to_owned() } else { called(&part.name) };
        let is_meant = |given: &&String| nearest(given, &names) == Some(part.name.as_str());
        if part.name != COVER && !is_listed(&name) && !unknown.iter().any(is_meant) {
            reader.problem(&root.key(&name), "is missing: the specimen has this part, which needs a material");
        }
        let Some(given) = given.get(&name) else { continue };
        part.model = given.model.unwrap_or(part.model);
        check_thickness(reader, part.model, given, &root.key(&name));
        part.integration = given.integration.or(part.integration);
        match given.thickness.filter(|_| part.name != COVER).map(|given| thickness(given, diameter)) {
            Some(Ok(value)) => part.thickness = value,
            Some(Err(message)) => reader.problem(&root.key(&name).key("thickness"), message),
            None => {}
        }
    }
}

//! The laws of the parts.

use super::KnownMesh;
use super::mesh::called;
use super::uniaxial;
use crate::document::pullout as document;
use crate::document::{EntryPoint, PulloutCase};
use crate::fields;
use crate::plugin::{self, Length, Level, Use};
use crate::point::{check_count, components};
use crate::problem::Place;
use crate::reader::{Reader, USUAL_STRENGTH_OF_WIRES, UsedDefaults};
use fe_core::element::{ElementKind, Integration};
use fe_core::kinematics::PlaneModel;
use fe_core::mesh::Mesh;
use fe_core::mesh::specimen::PulledFibre;
use fe_core::model::{PluginLaw, Wire};
use pullout_run::number::rounded;
use pullout_run::program::{Mode, STRESS_NAMES};
use std::collections::BTreeMap;

/// Laws and options of the mesh's parts, in their order.
pub(crate) struct Parts {
    pub laws: Vec<PluginLaw>,
    /// Whether their Q4 are averaged.
    pub average_dilatation: Vec<bool>,
    /// Large displacements; `None`: as the case says for all.
    pub nlgeom: Vec<Option<bool>>,
}

/// `None` if a law is missing. `has_field`: whether each part of the mesh has the scalar field, if the case has one.
pub fn resolve(
    reader: &mut Reader<'_>,
    case: &PulloutCase,
    scene: KnownMesh<'_>,
    has_field: Option<&[bool]>,
) -> Option<Parts> {
    let root = Place::root().key("parts");
    let given = &case.parts;
    let mut resolved = BTreeMap::new();
    for (name, part) in given {
        let place = root.key(name);
        // the first of the parts that it is said of
        let is_meant = |part: &str| called(part, |name| given.contains_key(name)) == name;
        let index = scene.mesh.and_then(|mesh| mesh.parts().iter().position(|part| is_meant(&part.name)));
        let law = law(reader, part, index.zip(scene.mesh), &place);
        let average = part.average_dilatation;
        if let Some((index, mesh)) = index.zip(scene.mesh) {
            let mut taken = defaults(part, index, mesh);
            let mut elements = mesh.elements().iter().filter(|element| element.part() == index);
            let averages = mesh.parts()[index].model != PlaneModel::PlaneStress
                && elements.any(|element| element.kind() == ElementKind::Q4);
            if averages && average.is_none() {
                taken.note("average_dilatation", true);
            } else if !averages && average.is_some() {
                let reason = "it is for Q4 elements in plane strain or axial symmetry";
                reader.warn_no_effect(&place.key("average_dilatation"), reason);
            }
            if part.nlgeom.is_none() && case.nlgeom.is_none() {
                taken.note("nlgeom", false);
            }
            reader.note_defaults(&place, &taken.0);
        }
        resolved.insert(name.as_str(), (law, average.unwrap_or(true), part.nlgeom));
    }
    let mut parts = Parts { laws: Vec::new(), average_dilatation: Vec::new(), nlgeom: Vec::new() };
    for (index, part) in scene.mesh?.parts().iter().enumerate() {
        let name = called(&part.name, |name| given.contains_key(name));
        let (law, average_dilatation, nlgeom) = resolved.get(name)?;
        let mut law = law.clone()?;
        let material = &given.get(name)?.material;
        let place = root.key(name).key("material");
        let field = case.field.as_ref().filter(|_| has_field.is_some_and(|parts| parts[index]));
        let temperature = match field {
            Some(field) if field.kind == document::FieldKind::PhaseField && material.expansion.is_some() => {
                let message =
                    "would expand with the phase field, which its law is given in place of a temperature: leave it out";
                reader.problem(&place.key("expansion"), message);
                return None;
            }
            Some(field) => field.initial.unwrap_or_default(),
            None => fields::initial(&case.course).temperature,
        };
        plugin::begin_at(reader, &mut law.plugin, material, temperature, &place);
        parts.laws.push(law);
        parts.average_dilatation.push(*average_dilatation);
        parts.nlgeom.push(*nlgeom);
    }
    Some(parts)
}

/// Usual elongations of wires: 1 is 100 %.
const USUAL_ELONGATION: [f64; 2] = [1e-3, 1.0];

/// The tension test of a wire's law: increments of strain, and their number.
const STRETCH: f64 = 5e-4;
const STRETCHES: usize = 1000;
/// A slope below this part of the first one is that of a wire that yields.
const YIELDING: f64 = 0.5;
/// Stresses of a wire that differ by less than this part are the same: that of the increments of the test.
const SAME_STRESS: f64 = 5e-3;

/// Warns of a strength that the law of a wire does not reach, or reaches before it yields.
fn warn_of_strength(reader: &mut Reader<'_>, key: &str, strength: f64, law: &PluginLaw, mesh: &Mesh, part: usize) {
    let Some(states) = uniaxial::states(law, mesh, part, STRETCH, STRETCHES) else { return };
    // on the first section
    let nominal: Vec<f64> = states.iter().map(|state| state.stress * (2.0 * state.strain[1]).exp()).collect();
    let (Some(first), Some(last)) = (nominal.first(), nominal.last()) else { return };
    let greatest = nominal.iter().copied().fold(0.0, f64::max);
    let yields = nominal.windows(2).find(|pair| pair[1] - pair[0] < YIELDING * first).map(|pair| pair[0]);
    let necks = *last < greatest;
    let message = match yields {
        _ if necks && strength > (1.0 + SAME_STRESS) * greatest => format!(
            "the law of the wire carries at most {} MPa on its first section: it necks and never breaks by its strength",
            rounded(greatest.round())
        ),
        Some(yields) if strength < (1.0 - SAME_STRESS) * yields => {
            format!("the law of the wire yields at {} MPa only: it breaks while it is elastic", rounded(yields.round()))
        }
        _ => return,
    };
    reader.warn(format!("{key} = {} MPa: {message}", rounded(strength)));
}

/// The wires of fibres, with what the case says of their strength.
pub fn wires(
    reader: &mut Reader<'_>,
    case: &PulloutCase,
    mesh: &Mesh,
    fibres: &[PulledFibre],
    laws: &[PluginLaw],
) -> Vec<Wire> {
    let root = Place::root().key("parts");
    let given = &case.parts;
    let names: Vec<&str> =
        fibres.iter().map(|fibre| called(&mesh.parts()[fibre.part].name, |name| given.contains_key(name))).collect();
    for (name, part) in given {
        for (key, is_given) in [("strength", part.strength.is_some()), ("elongation", part.elongation.is_some())] {
            if is_given && !names.contains(&name.as_str()) {
                reader.warn_no_effect(&root.key(name).key(key), "this part is no fibre of a specimen");
            }
        }
    }
    let wire = |(fibre, name): (&PulledFibre, &str)| {
        let mut wire = Wire::new(mesh, fibre);
        if let Some(part) = given.get(name) {
            [wire.strength, wire.elongation] = [part.strength, part.elongation].map(|limit| limit.map(|limit| limit.0));
            for (key, limit, unit, usual) in [
                ("strength", wire.strength, "MPa", USUAL_STRENGTH_OF_WIRES),
                ("elongation", wire.elongation, "", USUAL_ELONGATION),
            ] {
                if let Some(limit) = limit.filter(|limit| !(usual[0]..=usual[1]).contains(limit)) {
                    reader.warn_unusual(&format!("parts.{name}.{key}"), limit, unit, usual);
                }
            }
            if let Some(strength) = wire.strength {
                let key = format!("parts.{name}.strength");
                warn_of_strength(reader, &key, strength, &laws[fibre.part], mesh, fibre.part);
            }
        }
        wire
    };
    fibres.iter().zip(names).map(wire).collect()
}

/// What the case leaves to the mesh.
fn defaults(given: &document::Part, index: usize, mesh: &Mesh) -> UsedDefaults {
    let part = &mesh.parts()[index];
    let mut taken = UsedDefaults::default();
    if given.model.is_none() {
        taken.note("model", mode(part.model).name());
    }
    if given.thickness.is_none() && part.model != PlaneModel::Axisymmetric {
        taken.note("thickness", rounded(part.thickness));
    }
    if given.integration.is_none() {
        let of_part = || mesh.elements().iter().filter(|element| element.part() == index);
        let is_used = |rule: &Integration| of_part().any(|element| element.kind().default_integration() == *rule);
        let rules = [Integration::Full, Integration::Reduced].into_iter().filter(is_used);
        taken.note("integration", rules.map(|rule| rule.to_string()).collect::<Vec<_>>().join(", "));
    }
    taken
}

fn law(
    reader: &mut Reader<'_>,
    part: &document::Part,
    known: Option<(usize, &Mesh)>,
    place: &Place,
) -> Option<PluginLaw> {
    let place_of_material = place.key("material");
    let material = &part.material;
    if let Some(EntryPoint::Uinter | EntryPoint::Fric) = material.entry {
        reader.problem(
            &place_of_material.key("entry"),
            "a part calls the entry point umat; uinter and fric are for contact",
        );
    }
    let mode = known.map(|(index, mesh)| (mode(mesh.parts()[index].model), place.key("model")));
    let length = known.map_or(Length::Unknown, |(index, mesh)| Length::OfElements(extreme_lengths(mesh, index)));
    let purpose = Use { level: Level::Specimen, entry: EntryPoint::Umat, mode, length, normal: None };
    let plugin = plugin::resolve(reader, material, &place_of_material, purpose)?;
    if let Some(statev0) = &material.statev0 {
        check_count(reader, statev0, &plugin, &place_of_material.key("statev0"));
    }
    let mode = known.map_or(Mode::PlaneStrain, |(index, mesh)| self::mode(mesh.parts()[index].model));
    let place = place.key("initial").key("stress");
    let stress = part.initial.as_ref().and_then(|initial| initial.stress.as_ref()).map(|stress| {
        let [s11, s22, s33, s12, ..] = components(reader, Some(stress), &STRESS_NAMES, mode, &place);
        [s11, s22, s33, s12]
    });
    plugin::report_initial_values(reader, &plugin.library, [material.statev0.is_some(), stress.is_some()]);
    Some(PluginLaw { plugin, statev0: material.statev0.clone(), stress0: stress })
}

fn mode(model: PlaneModel) -> Mode {
    match model {
        PlaneModel::PlaneStress => Mode::PlaneStress,
        PlaneModel::PlaneStrain => Mode::PlaneStrain,
        PlaneModel::Axisymmetric => Mode::Axisymmetric,
    }
}

/// The elements of a part with the least and the greatest CELENT, mm.
fn extreme_lengths(mesh: &Mesh, part: usize) -> Vec<(usize, f64)> {
    let elements = || (0..mesh.elements().len()).filter(|&element| mesh.elements()[element].part() == part);
    let lengths = || elements().map(|element| (element, mesh.characteristic_length(element)));
    let least = lengths().min_by(|a, b| a.1.total_cmp(&b.1));
    let greatest = lengths().max_by(|a, b| a.1.total_cmp(&b.1));
    least.into_iter().chain(greatest).collect()
}

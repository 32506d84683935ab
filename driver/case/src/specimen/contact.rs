//! Contact pairs.

use super::KnownMesh;
use super::bearing::{self, Bearings};
use super::boundary::Drives;
use super::mesh::MATRIX;
use crate::document::pullout as document;
use crate::document::{EntryPoint, PropValue, Props, PulloutCase};
use crate::plugin::{self, Length, Level, Use};
use crate::problem::{Place, hint};
use crate::reader::{Reader, UsedDefaults};
use fe_core::mesh::specimen::{ContactSurfaces, SurfaceRole};
use fe_core::mesh::{ElementEdge, Mesh};
use fe_core::model::{ContactLaw, ContactPair, Enforcement, Fit, Interference, NormalLaw, PluginLaw, Width};
use indexmap::IndexMap;
use pullout_run::number::rounded;
use std::collections::BTreeMap;

/// Factor of the penalty.
const PENALTY_FACTOR: f64 = 100.0;
/// Tension that a bonded surface carries where it separates at the exit, MPa (6.27).
const SEPARATION_TENSION: f64 = 2.0;
/// The law's parameter for it.
const SEPARATION_PARAMETER: &str = "p_0";

/// All pairs; `None` if any is unusable.
pub fn resolve(
    reader: &mut Reader<'_>,
    case: &PulloutCase,
    scene: KnownMesh<'_>,
    bearings: &Bearings<'_>,
    drives: &mut Drives,
) -> Option<Vec<ContactPair>> {
    let place = Place::root().key("contact");
    let defaults = scene.ground.map_or(&[][..], |ground| &ground.specimen.contact_pairs);
    let Some(given) = &case.contact else {
        if let Some(pair) = defaults.first() {
            let message = format!("is missing: the specimen has the contact pair '{}', which needs a law", pair.name);
            reader.problem(&place, message);
        }
        return Some(Vec::new());
    };
    let pairs = match given {
        document::Contact::All(pair) => {
            let fit = fit(pair, drives, &place);
            all_pairs(reader, pair, fit, defaults, (scene, bearings), &place)
        }
        document::Contact::Pairs(pairs) => {
            let mut resolved: Vec<Option<ContactPair>> = Vec::new();
            let mut names: Vec<&str> = Vec::new();
            for (k, pair) in pairs.iter().enumerate() {
                let place = place.index(k);
                let name = pair.name.as_deref();
                if let Some(name) = name.filter(|name| names.contains(name)) {
                    reader.problem(&place.key("name"), format!("the pair '{name}' is given twice"));
                }
                names.extend(name);
                let own = defaults.iter().find(|default| Some(default.name.as_str()) == name);
                let fit = fit(pair, drives, &place);
                resolved.push(one_pair(reader, pair, fit, own, k, (scene, bearings), &place));
            }
            let is_missing =
                |default: &&ContactSurfaces| !is_on_request(default) && !names.contains(&default.name.as_str());
            for missing in defaults.iter().filter(is_missing) {
                reader.problem(&place, format!("the specimen's contact pair '{}' is missing", missing.name));
            }
            resolved.into_iter().collect()
        }
    };
    if let (document::Contact::All(pair), false) = (given, defaults.is_empty()) {
        let roles = [
            ("exit", pair.exit.is_some(), SurfaceRole::Exit),
            ("separation", pair.separation.is_some(), SurfaceRole::Separation),
        ];
        for (key, ..) in
            roles.iter().filter(|(_, given, role)| *given && defaults.iter().all(|pair| pair.role != *role))
        {
            reader.warn_no_effect(&place.key(key), "the specimen has no such surfaces");
        }
    }
    let all = match given {
        document::Contact::All(pair) => vec![(&**pair, None, place.clone())],
        document::Contact::Pairs(pairs) => {
            pairs.iter().enumerate().map(|(k, pair)| (pair, pair.name.as_deref(), place.index(k))).collect()
        }
    };
    if scene.ground.is_some() {
        for (pair, name, place) in all {
            let mut own = defaults.iter().filter(|line| name.is_none_or(|name| name == line.name));
            let is_rigid = matches!(pair.bearing, None | Some(document::Bearing::Word(document::BearingWord::Rigid)));
            if !is_rigid
                && !own.any(|line| Bearings::is_side(line) && matches!(width(pair, Some(line)), Width::Given(_)))
            {
                let message = "is for the sides of round fibres in plane specimens: there are none here";
                reader.problem(&place.key("bearing"), message);
            }
        }
    }
    note_widths(reader, pairs.as_deref().unwrap_or_default(), defaults, scene);
    pairs
}

/// Returns whether a specimen's pair is in contact only where the case says so.
fn is_on_request(pair: &ContactSurfaces) -> bool {
    pair.role == SurfaceRole::End
}

/// Notes the widths of the contact lines of round fibres in the plane.
fn note_widths(reader: &mut Reader<'_>, pairs: &[ContactPair], defaults: &[ContactSurfaces], scene: KnownMesh<'_>) {
    let mut parts = scene.mesh.into_iter().flat_map(|mesh| mesh.parts());
    let Some(matrix) = parts.find(|part| part.name == MATRIX) else { return };
    let is_line = |default: &&ContactSurfaces| default.width.is_some() && !is_on_request(default);
    for default in defaults.iter().filter(is_line) {
        let Some(pair) = pairs.iter().find(|pair| pair.name == default.name) else { continue };
        let width = match pair.width {
            Width::Given(width) => width,
            Width::OfPart => slave_thickness(pair, scene).unwrap_or(matrix.thickness),
        };
        let factor = width / matrix.thickness;
        reader.note(format!(
            "each contact line is {width:.4} mm wide, the matrix {} mm thick: the traction on the matrix is {factor:.3} of the \
             contact pressure",
            matrix.thickness
        ));
    }
}

/// The thickness of the part that a pair's slave surface belongs to.
fn slave_thickness(pair: &ContactPair, scene: KnownMesh<'_>) -> Option<f64> {
    let mesh = scene.mesh?;
    let element = pair.slave.first()?.element;
    Some(mesh.parts()[mesh.elements()[element].part()].thickness)
}

/// The pairs that bond fibres, line by line: those of a specimen that share a master, which names the line, and any other pair
/// by itself.
pub fn interface_lines<'n>(
    contacts: &'n [ContactPair],
    defaults: &'n [ContactSurfaces],
) -> IndexMap<&'n str, Vec<usize>> {
    let mut lines: IndexMap<&str, Vec<usize>> = IndexMap::new();
    for (index, pair) in contacts.iter().enumerate() {
        match defaults.iter().find(|default| default.name == pair.name) {
            Some(ContactSurfaces { role: SurfaceRole::Exit | SurfaceRole::End, .. }) => {}
            Some(ContactSurfaces { master, .. }) => lines.entry(master).or_default().push(index),
            None => lines.entry(&pair.name).or_default().push(index),
        }
    }
    lines
}

/// The width of a line of contact over the diameter of a round fibre; 1 without one, and in axial symmetry.
pub fn bearing_factor(contacts: &[ContactPair], diameter: Option<f64>) -> f64 {
    match (contacts.first().map(|pair| pair.width), diameter) {
        (Some(Width::Given(width)), Some(diameter)) => width / diameter,
        _ => 1.0,
    }
}

/// Resolves one contact for all pairs of the specimen; the law is loaded and checked once.
fn all_pairs(
    reader: &mut Reader<'_>,
    pair: &document::Pair,
    fit: Fit,
    defaults: &[ContactSurfaces],
    (scene, bearings): (KnownMesh<'_>, &Bearings<'_>),
    place: &Place,
) -> Option<Vec<ContactPair>> {
    let names_surfaces = pair.slave.is_some() || pair.master.is_some();
    let (first, others) = match defaults {
        [first, others @ ..] if !names_surfaces => (first, others),
        _ => return one_pair(reader, pair, fit, None, 0, (scene, bearings), place).map(|pair| vec![pair]),
    };
    let first = one_pair(reader, pair, fit, Some(first), 0, (scene, bearings), place)?;
    let mut pairs = vec![first];
    let mut laws = Vec::new();
    for default in others.iter().filter(|default| !is_on_request(default) || pair.end.is_some()) {
        let law = match laws.iter().find(|(role, _)| *role == default.role) {
            Some((_, law)) => Clone::clone(law),
            None => {
                let law = law_of_role(reader, pair, default.role, &pairs[0].law, place)?;
                laws.push((default.role, law.clone()));
                law
            }
        };
        let (slave, master) = surfaces(reader, pair, Some(default), scene, place)?;
        let width = width(pair, Some(default));
        let fit = if default.role == SurfaceRole::Bonded { fit } else { Fit::default() };
        let mut taken = UsedDefaults::default();
        let bearing = bearings.of(reader, pair, Some(default), width, place);
        let (penalty_factor, enforcement) = normal_direction(pair, bearing.is_some(), &mut taken);
        if bearing.is_some() != pairs[0].bearing.is_some() {
            reader.note_defaults(&place.key(&default.name), &taken.0);
        }
        let normal = ContactPair { penalty_factor, enforcement, bearing, ..pairs[0].clone() };
        pairs.push(ContactPair { name: default.name.clone(), slave, master, width, law, fit, ..normal });
    }
    Some(pairs)
}

/// The law of the other surfaces of a specimen: that of the bonded ones with other parameters.
fn law_of_role(
    reader: &mut Reader<'_>,
    pair: &document::Pair,
    role: SurfaceRole,
    bonded: &ContactLaw,
    place: &Place,
) -> Option<ContactLaw> {
    let (given, key, default) = match role {
        SurfaceRole::Bonded => return Some(bonded.clone()),
        SurfaceRole::Exit => (&pair.exit, "exit", Some(("law", PropValue::Choice("none".into())))),
        SurfaceRole::Separation => {
            (&pair.separation, "separation", Some((SEPARATION_PARAMETER, PropValue::Number(SEPARATION_TENSION))))
        }
        // it is there where the case gives it
        SurfaceRole::End => (&pair.end, "end", None),
    };
    let other = match (given, default.filter(|default| has_default(bonded, default))) {
        (Some(given), _) => given.clone(),
        // with FRIC the tension is the host's
        (None, Some((SEPARATION_PARAMETER, _))) if matches!(bonded, ContactLaw::Fric { .. }) => {
            return Some(bonded.clone());
        }
        (None, Some((name, value))) => BTreeMap::from([(name.to_owned(), value)]),
        (None, None) => {
            let message =
                "is missing: the specimen has such surfaces; give the parameters of the law that are different there";
            reader.problem(&place.key(key), message);
            return None;
        }
    };
    let mut changed = pair.clone();
    match changed.law.props.get_or_insert_with(|| Props::Named(BTreeMap::new())) {
        Props::Named(props) => props.extend(other),
        Props::List(_) => {
            let message = "the law's props are a list: give them by name, or contact pair by pair";
            reader.problem(&place.key(key), message);
            return None;
        }
    }
    law(reader, &changed, place)
}

/// Returns whether a law has a parameter that takes the value.
fn has_default(law: &ContactLaw, (name, value): &(&str, PropValue)) -> bool {
    let (ContactLaw::Uinter(plugin) | ContactLaw::Fric { law: plugin, .. }) = law;
    let parameters = plugin.law.iter().flat_map(|law| &law.parameters);
    parameters.filter(|parameter| parameter.name == *name).any(|parameter| match value {
        PropValue::Choice(choice) => parameter.choices.iter().any(|known| known.name == *choice),
        _ => parameter.choices.is_empty(),
    })
}

fn one_pair(
    reader: &mut Reader<'_>,
    pair: &document::Pair,
    fit: Fit,
    default: Option<&ContactSurfaces>,
    index: usize,
    (scene, bearings): (KnownMesh<'_>, &Bearings<'_>),
    place: &Place,
) -> Option<ContactPair> {
    let surfaces = surfaces(reader, pair, default, scene, place);
    let law = law(reader, pair, place);
    let width = width(pair, default);
    let mut taken = UsedDefaults::default();
    let quadrature = pair.quadrature.clone().unwrap_or_default();
    quadrature.note_of("quadrature", &mut taken);
    // what a soft normal law has no use for
    let mut unused = UsedDefaults::default();
    let mut of_hard = &mut taken;
    let keys = [("penalty_factor", pair.penalty_factor.is_some()), ("enforcement", pair.enforcement.is_some())];
    if let Some(ContactLaw::Fric { normal: NormalLaw::Soft(_), .. }) = &law {
        of_hard = &mut unused;
        for (key, _) in keys.iter().filter(|(_, given)| *given) {
            reader.problem(&place.key(key), "is for the hard normal law: leave it out with a soft one");
        }
    }
    let bearing = bearings.of(reader, pair, default, width, place);
    let (penalty_factor, enforcement) = normal_direction(pair, bearing.is_some(), of_hard);
    let release = taken.or("release", pair.release, true);
    if pair.width.is_none() {
        match width {
            Width::Given(width) => taken.note("width", rounded(width)),
            Width::OfPart => taken.note("width", "part"),
        }
    }
    reader.note_defaults(place, &taken.0);
    let name = pair.name.clone().or_else(|| default.map(|default| default.name.clone()));
    let (slave, master) = surfaces?;
    Some(ContactPair {
        critical_slip: pair.critical_slip.map_or(0.0, |slip| slip.0),
        // the parts say, once they are known
        master_bends: false,
        name: name.unwrap_or_else(|| format!("contact {}", index + 1)),
        slave,
        master,
        law: law?,
        quadrature: *quadrature,
        width,
        penalty_factor,
        enforcement,
        release,
        fit,
        bearing,
    })
}

/// What is closed at the start, and the interference with its drive.
fn fit(pair: &document::Pair, drives: &mut Drives, place: &Place) -> Fit {
    let closes_within = match &pair.initial_gap {
        None | Some(document::InitialGap::Word(document::InitialGapWord::Keep)) => 0.0,
        Some(document::InitialGap::Word(document::InitialGapWord::Close)) => f64::INFINITY,
        Some(document::InitialGap::Within(within)) => within.close.0,
    };
    let place = place.key("interference");
    let interference = pair.interference.as_ref().map(|given| Interference {
        drive: drives.followed(&given.drive, &place.key("drive")),
        depth: given.depth.map(|depth| depth.0),
    });
    Fit { closes_within, interference }
}

/// The slave and the master, each a chain.
fn surfaces(
    reader: &mut Reader<'_>,
    pair: &document::Pair,
    default: Option<&ContactSurfaces>,
    scene: KnownMesh<'_>,
    place: &Place,
) -> Option<(Vec<ElementEdge>, Vec<ElementEdge>)> {
    let slave =
        surface(reader, pair.slave.as_deref(), default.map(|pair| pair.slave.as_str()), scene, &place.key("slave"));
    let master =
        surface(reader, pair.master.as_deref(), default.map(|pair| pair.master.as_str()), scene, &place.key("master"));
    let (slave, master) = slave.zip(master)?;
    let slave = facing(scene.mesh?, slave, &master);
    if let Some(edge) = slave.iter().find(|edge| master.contains(edge)) {
        let message = format!("it has an edge of element {} that the slave has as well", edge.element + 1);
        reader.problem(&place.key("master"), message);
        return None;
    }
    Some((slave, master))
}

/// Slave edges between two bodies, a block and the cover in its slot, as the one has them that the master lies against:
/// the master's nearest edge goes the other way. A file's curves may be on either.
fn facing(mesh: &Mesh, slave: Vec<ElementEdge>, master: &[ElementEdge]) -> Vec<ElementEdge> {
    let ends = |edge: ElementEdge| [0, 1].map(|k| mesh.nodes()[mesh.edge_nodes(edge).nodes()[k]]);
    let middle = |[a, b]: [[f64; 2]; 2]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    let along = |[a, b]: [[f64; 2]; 2]| [b[0] - a[0], b[1] - a[1]];
    let is_turned = |edge: ElementEdge| {
        let [x, y] = middle(ends(edge));
        let distance = |other: ElementEdge| {
            let [u, v] = middle(ends(other));
            (u - x).hypot(v - y)
        };
        let nearest = master.iter().min_by(|a, b| distance(**a).total_cmp(&distance(**b)));
        nearest.is_some_and(|&nearest| {
            let (this, that) = (along(ends(edge)), along(ends(nearest)));
            this[0] * that[0] + this[1] * that[1] > 0.0
        })
    };
    let other_side = |&edge: &ElementEdge| mesh.neighbour(edge).filter(|_| is_turned(edge));
    match slave.iter().map(other_side).collect::<Option<Vec<_>>>() {
        // a chain that goes the other way
        Some(turned) => turned.into_iter().rev().collect(),
        None => slave,
    }
}

fn surface(
    reader: &mut Reader<'_>,
    given: Option<&str>,
    default: Option<&str>,
    scene: KnownMesh<'_>,
    place: &Place,
) -> Option<Vec<ElementEdge>> {
    let Some(name) = given.or(default) else {
        // a specimen that could not be read may have pairs of its own
        scene.ground?;
        let names: Vec<&str> = scene.mesh.into_iter().flat_map(|mesh| mesh.edge_set_names()).collect();
        reader.problem(place, format!("is missing: name an edge set{}", hint("", &names)));
        return None;
    };
    let edges = scene.edge_set(reader, name, place)?;
    let chain = chain(scene.mesh?, edges).map_err(|message| format!("'{name}': {message}"));
    reader.without_problem(chain, place)
}

/// Returns the edges in the order in which they follow each other.
///
/// # Errors
/// The reason why they are no chain.
fn chain(mesh: &Mesh, edges: &[ElementEdge]) -> Result<Vec<ElementEdge>, String> {
    let start = |edge: ElementEdge| {
        let [x, y] = mesh.nodes()[mesh.edge_nodes(edge).nodes()[0]];
        format!("({x:.6}, {y:.6})")
    };
    let branch = |edge: ElementEdge| format!("its edges branch near {}: they must be one chain", start(edge));
    let mut rows = mesh.rows(edges).map_err(branch)?;
    let open: Vec<String> = rows.iter().filter(|(_, closes)| !closes).map(|(row, _)| start(row[0])).collect();
    Err(match (open.len(), rows.len()) {
        (1, 1) => return Ok(rows.remove(0).0),
        (0, _) => "its edges are a closed ring: they must be one chain with two ends".into(),
        (1, _) => "its edges are a chain and a closed ring: they must be one chain".into(),
        (count, _) => {
            format!("its edges are {count} pieces, starting at {}: they must be one chain", open.join(", "))
        }
    })
}

fn law(reader: &mut Reader<'_>, pair: &document::Pair, place: &Place) -> Option<ContactLaw> {
    let place_of_law = place.key("law");
    let material = &pair.law;
    let message = "contact calls the entry point uinter or fric";
    let entry = plugin::contact_entry(reader, material.entry, &place_of_law, message);
    if material.statev0.is_some() {
        reader.problem(&place_of_law.key("statev0"), "the states of contact start from 0: leave it out");
    }
    let place = place.key("normal");
    let normal = pair.normal;
    let beside = normal.filter(|_| entry == EntryPoint::Fric).map(|normal| (normal, place.clone()));
    let length = Length::Unknown;
    let purpose = Use { level: Level::Specimen, entry, mode: None, length, normal: beside };
    let law = plugin::resolve(reader, material, &place_of_law, purpose).map(PluginLaw::from);
    match (entry, normal) {
        (EntryPoint::Fric, Some(normal)) => Some(ContactLaw::Fric { law: law?, normal }),
        (EntryPoint::Fric, None) => {
            let message = "is missing: FRIC has no normal law; give {\"hard\": {}} (unilateral) or another";
            reader.problem(&place, message);
            None
        }
        (_, Some(_)) => {
            reader.problem(&place, "a UINTER plugin has the normal law: leave it out, or set law.entry to fric");
            None
        }
        (_, None) => law.map(ContactLaw::Uinter),
    }
}

fn width(pair: &document::Pair, default: Option<&ContactSurfaces>) -> Width {
    match &pair.width {
        Some(document::Width::Given(width)) => Width::Given(width.0),
        Some(document::Width::Part(_)) => Width::OfPart,
        None => default.and_then(|pair| pair.width).map_or(Width::OfPart, Width::Given),
    }
}

/// The penalty's factor and the enforcement: what is crushed has a soft penalty without updates, unless the case gives one of both.
fn normal_direction(pair: &document::Pair, is_crushed: bool, taken: &mut UsedDefaults) -> (f64, Enforcement) {
    if is_crushed && pair.penalty_factor.is_none() && pair.enforcement.is_none() {
        taken.note("penalty_factor", bearing::PENALTY_FACTOR);
        taken.note("enforcement", "penalty");
        return (bearing::PENALTY_FACTOR, Enforcement::Penalty);
    }
    let penalty_factor = taken.real("penalty_factor", pair.penalty_factor, PENALTY_FACTOR);
    let enforcement = pair.enforcement.clone().unwrap_or_default();
    enforcement.note_of("enforcement", taken);
    (penalty_factor, *enforcement)
}

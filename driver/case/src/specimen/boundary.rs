//! Drives, supports and loads of a specimen, and the quantities measured on it.

use super::KnownMesh;
use super::couplings::node;
use super::mesh::MeshAndSets;
use crate::document::PulloutCase;
use crate::document::pullout as document;
use crate::problem::{Place, hint};
use crate::reader::{Reader, UsedDefaults};
use fe_core::mesh::specimen::PulledFibre;
use fe_core::model::{Load, LoadKind, Measured, MeasuredFibre, Support};
use indexmap::IndexMap;
use pullout_run::number::significant;
use std::collections::BTreeMap;

/// The drive of the grip.
pub const SLIP: &str = "slip";
/// The support that the drive of the grip moves.
const GRIP: &str = "grip";
/// Both axes.
pub const BOTH: &[[f64; 2]] = &[[1.0, 0.0], [0.0, 1.0]];

/// Supports, drives, loads and measurements of a specimen.
pub struct Boundary {
    pub drives: Drives,
    pub supports: Vec<Support>,
    pub loads: Vec<Load>,
    pub measured: Measured,
}

/// The drives in order of their first mention.
#[derive(Default)]
pub struct Drives {
    drives: IndexMap<String, Drive>,
}

struct Drive {
    /// Place of its first mention.
    place: Place,
    /// Whether a step moves it.
    moved: bool,
    /// Whether it pulls one of several fibres.
    of_fibre: bool,
}

impl Drives {
    /// Index of a drive that something follows.
    pub fn followed(&mut self, name: &str, place: &Place) -> usize {
        let entry = self.drives.entry(name.to_owned());
        let index = entry.index();
        entry.or_insert_with(|| Drive { place: place.clone(), moved: false, of_fibre: false });
        index
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.drives.get_index_of(name)
    }

    /// Index of a drive that a step moves; `None` if nothing follows it.
    pub fn moved(&mut self, name: &str) -> Option<usize> {
        let index = self.index(name)?;
        self.move_one(index);
        Some(index)
    }

    /// Says that nothing follows the drive of this name.
    pub fn report_unknown(&self, reader: &mut Reader<'_>, name: &str, place: &Place) {
        let known = hint(name, self.drives.keys());
        reader.problem(place, format!("no support, load or interference has the drive '{name}'{known}"));
    }

    /// Notes that a step moves a drive.
    pub fn move_one(&mut self, index: usize) {
        self.drives[index].moved = true;
    }

    /// Names and places of the drives that no step moves.
    pub fn idle(&self) -> impl Iterator<Item = (&str, &Place)> {
        self.drives.iter().filter(|(_, drive)| !drive.moved).map(|(name, drive)| (name.as_str(), &drive.place))
    }

    /// Index of the drive of one of several fibres.
    fn of_fibre(&mut self, fibre: &PulledFibre, place: &Place) -> usize {
        let index = self.followed(&format!("{SLIP}.{}", fibre.name.as_deref().unwrap_or_default()), place);
        self.drives[index].of_fibre = true;
        index
    }

    /// Indices of the drives that pull one of several fibres each.
    pub fn of_fibres(&self) -> Vec<usize> {
        (0..self.drives.len()).filter(|&index| self.drives[index].of_fibre).collect()
    }

    pub fn names(&self) -> Vec<String> {
        self.drives.keys().cloned().collect()
    }

    pub fn len(&self) -> usize {
        self.drives.len()
    }
}

/// Grip, supports, loads and measure, with the drives that contact has.
pub fn resolve(reader: &mut Reader<'_>, case: &PulloutCase, scene: KnownMesh<'_>, drives: Drives) -> Boundary {
    let mut boundary = Boundary { drives, supports: Vec::new(), loads: Vec::new(), measured: Measured::default() };
    boundary.add_grip(reader, case, scene);
    boundary.add_supports(reader, case, scene);
    boundary.add_loads(reader, case, scene);
    boundary.measure(reader, case, scene);
    boundary
}

impl Boundary {
    fn add_grip(&mut self, reader: &mut Reader<'_>, case: &PulloutCase, scene: KnownMesh<'_>) {
        let place = Place::root().key(GRIP);
        let default = scene.ground.and_then(|ground| Some((ground.grip?, ground.specimen.pull_direction)));
        if case.grip.is_none() && default.is_none() {
            if scene.ground.is_none() {
                // the specimen that could not be read may have one
                self.drives.followed(SLIP, &place);
                self.drives.moved(SLIP);
            }
            return;
        }
        let given = case.grip.clone().unwrap_or_default();
        let fibres = scene.ground.filter(|_| given.nodes.is_none()).map_or(&[][..], MeshAndSets::several_fibres);
        // known even where the rest is not: steps may name it
        let drives: Vec<usize> = match scene.ground.is_some_and(|ground| ground.grips_each) && !fibres.is_empty() {
            true => fibres.iter().map(|fibre| self.drives.of_fibre(fibre, &place)).collect(),
            false => vec![self.drives.followed(SLIP, &place)],
        };
        let name = given.nodes.as_deref().or(default.map(|(nodes, _)| nodes));
        let direction = given.direction.and_then(|given| unit(reader, given, &place.key("direction")));
        let direction = direction.or(default.filter(|_| given.direction.is_none()).map(|(_, direction)| direction));
        if scene.ground.is_some() && name.is_none() {
            reader.problem(&place.key("nodes"), "is missing: name the node set that is pulled");
        }
        if scene.ground.is_some() && direction.is_none() && given.direction.is_none() {
            reader.problem(&place.key("direction"), "is missing: in which direction is it pulled?");
        }
        let nodes = name.and_then(|name| scene.node_set(reader, name, &place.key("nodes")));
        let (Some(nodes), Some([x, y])) = (nodes, direction) else { return };
        let mut taken = UsedDefaults::default();
        if given.nodes.is_none() {
            taken.note("nodes", name.unwrap_or_default());
        }
        if given.direction.is_none() {
            taken.note("direction", format_args!("[{}, {}]", significant(x, 4), significant(y, 4)));
        }
        if given.lateral.is_none() {
            taken.note("lateral", "fixed");
        }
        reader.note_defaults(&place, &taken.0);
        self.measured.slip.clone_from(&drives);
        self.measured.direction = [x, y];
        let mut pull = |name: &str, nodes: &[usize], drive: usize| {
            let index = self.supports.len();
            let along = Support { name: name.into(), nodes: nodes.to_vec(), direction: [x, y], drive: Some(drive) };
            if given.lateral != Some(document::Lateral::Free) {
                let across =
                    Support { name: format!("{name}, lateral"), direction: [-y, x], drive: None, ..along.clone() };
                self.supports.extend([along, across]);
            } else {
                self.supports.push(along);
            }
            self.measured.supports.push(index);
            index
        };
        if fibres.is_empty() {
            pull(GRIP, nodes, drives[0]);
        }
        for (index, fibre) in fibres.iter().enumerate() {
            let &PulledFibre { part, direction: axis, exit_node, tail_node, .. } = fibre;
            let name = fibre.name.clone().unwrap_or_default();
            let grip = format!("{GRIP}.{name}");
            let Some(nodes) = scene.node_set(reader, &grip, &place) else { continue };
            let slip = drives[index.min(drives.len() - 1)];
            let support = pull(&grip, nodes, slip);
            self.measured.fibres.push(MeasuredFibre {
                name,
                slip,
                support,
                axis,
                exit_node,
                tail_node,
                part: Some(part),
                lines: Vec::new(),
            });
        }
    }

    fn add_supports(&mut self, reader: &mut Reader<'_>, case: &PulloutCase, scene: KnownMesh<'_>) {
        let place = Place::root().key("supports");
        let ways = scene.ground.map_or(&[][..], |ground| &ground.supports);
        let named = match &case.supports {
            Some(document::Supports::Given(supports)) => return self.add_given(reader, supports, scene, &place),
            Some(document::Supports::Named(name)) => Some(name),
            None => None,
        };
        let way = match named {
            None => ways.first(),
            Some(name) => ways.iter().find(|way| way.name == name),
        };
        let Some(way) = way else {
            if let (Some(name), Some(_)) = (named, scene.ground) {
                let names: Vec<&str> = ways.iter().map(|way| way.name).collect();
                let message = if names.is_empty() {
                    "the mesh has no supports of its own: give them by name, as {\"base\": {\"nodes\": …}}".to_owned()
                } else {
                    format!("the specimen has no supports '{name}'{}", hint(name, &names))
                };
                reader.problem(&place, message);
            }
            return;
        };
        if named.is_none() {
            reader.note_defaults(&place, &[way.in_words()]);
        }
        for (set, directions) in &way.supports {
            let Some(nodes) = scene.node_set(reader, set, &place) else { continue };
            self.hold(set, nodes, directions, None);
        }
    }

    fn add_given(
        &mut self,
        reader: &mut Reader<'_>,
        supports: &BTreeMap<String, document::Support>,
        scene: KnownMesh<'_>,
        place: &Place,
    ) {
        for (name, support) in supports {
            let place = place.key(name);
            if self.measured.supports.iter().any(|&support| self.supports[support].name == *name) {
                reader.problem(&place, "this name is taken by the grip");
            }
            let drive = support.drive.as_deref().map(|drive| self.drives.followed(drive, &place.key("drive")));
            let own;
            let directions = match support.direction {
                None | Some(document::SupportDirection::Both(_)) => BOTH,
                Some(document::SupportDirection::One(direction)) => {
                    own = unit(reader, direction, &place.key("direction"));
                    own.as_slice()
                }
            };
            if drive.is_some() && directions.len() > 1 {
                reader.problem(&place.key("direction"), "is missing: a drive moves along one direction");
            }
            let set = support.nodes.as_deref().unwrap_or(name);
            let place_of_set = if support.nodes.is_some() { place.key("nodes") } else { place.clone() };
            if let Some(nodes) = scene.node_set(reader, set, &place_of_set) {
                self.hold(name, nodes, directions, drive);
            }
        }
    }

    fn hold(&mut self, name: &str, nodes: &[usize], directions: &[[f64; 2]], drive: Option<usize>) {
        for &direction in directions {
            self.supports.push(Support { name: name.into(), nodes: nodes.to_vec(), direction, drive });
        }
    }

    fn add_loads(&mut self, reader: &mut Reader<'_>, case: &PulloutCase, scene: KnownMesh<'_>) {
        let place = Place::root().key("loads");
        for (name, load) in case.loads.iter().flatten() {
            let place = place.key(name);
            let place_of_drive = if load.drive.is_some() { place.key("drive") } else { place.clone() };
            let drive = self.drives.followed(load.drive.as_deref().unwrap_or(name), &place_of_drive);
            if load.drive.is_none() && self.measured.slip.contains(&drive) {
                let message = format!(
                    "has the name of the grip's drive '{name}', which would multiply it: rename the load, or confirm with \"drive\": \"{name}\""
                );
                reader.problem(&place, message);
            }
            if let Some(kind) = load_kind(reader, name, load, scene, &place) {
                self.loads.push(Load { name: name.clone(), drive, kind });
            }
        }
    }

    fn measure(&mut self, reader: &mut Reader<'_>, case: &PulloutCase, scene: KnownMesh<'_>) {
        let place = Place::root().key("measure");
        let given = case.measure.clone().unwrap_or_default();
        if let Some(name) = &given.slip {
            self.measured.slip = self.drives.index(name).into_iter().collect();
            if self.measured.slip.is_empty() {
                self.drives.report_unknown(reader, name, &place.key("slip"));
            }
        } else if self.measured.slip.is_empty() {
            self.measured.slip = self.drives.index(SLIP).into_iter().collect();
        }
        if let Some(name) = &given.load {
            let index = self.supports.iter().position(|support| support.name == *name);
            if index.is_none() && scene.mesh.is_some() {
                let mut names: Vec<&str> = self.supports.iter().map(|support| support.name.as_str()).collect();
                names.dedup();
                reader.problem(&place.key("load"), format!("there is no support '{name}'{}", hint(name, &names)));
            }
            if let Some(index) = index {
                self.measured.direction = self.pull_direction(&self.supports[index]);
                self.measured.supports = vec![index];
            }
        }
        if let Some(direction) = given.direction.and_then(|given| unit(reader, given, &place.key("direction"))) {
            self.measured.direction = direction;
        }
        let fibre = scene.ground.and_then(MeshAndSets::lone_fibre);
        let mut find = |given: Option<&document::NodeReference>, default: Option<usize>, key: &str| match given {
            Some(reference) => node(reader, reference, scene, &place.key(key)),
            None => default,
        };
        self.measured.axis = fibre.map(|fibre| fibre.direction);
        self.measured.exit_node = find(given.exit.as_ref(), fibre.map(|fibre| fibre.exit_node), "exit");
        self.measured.tail_node = find(given.tail.as_ref(), fibre.map(|fibre| fibre.tail_node), "tail");
    }

    /// The direction in which the reaction of a support is the load, where the case names none: the support's if it has only
    /// one, else the grip's, or that of what the slip moves without one.
    fn pull_direction(&self, support: &Support) -> [f64; 2] {
        let is_held_once = self.supports.iter().filter(|other| other.name == support.name).count() == 1;
        if is_held_once {
            return normalised(support.direction);
        }
        // a grip is what is measured until the case names another support
        if !self.measured.supports.is_empty() {
            return self.measured.direction;
        }
        let moves = |support: &&Support| support.drive.is_some_and(|drive| self.measured.slip.contains(&drive));
        normalised(self.supports.iter().find(moves).unwrap_or(support).direction)
    }
}

fn load_kind(
    reader: &mut Reader<'_>,
    name: &str,
    load: &document::Load,
    scene: KnownMesh<'_>,
    place: &Place,
) -> Option<LoadKind> {
    let given = [load.force.is_some(), load.traction.is_some(), load.pressure.is_some()];
    if given.iter().filter(|given| **given).count() != 1 {
        reader.problem(place, "needs exactly one of \"force\", \"traction\" and \"pressure\"");
        return None;
    }
    let [nodes, edges] = [("nodes", &load.nodes), ("edges", &load.edges)];
    let ((right, set), (wrong, other), what) = match load.force {
        Some(_) => (nodes, edges, "a force acts on nodes"),
        None => (edges, nodes, "it acts on edges"),
    };
    if other.is_some() {
        reader.problem(&place.key(wrong), format!("{what}: name the set as \"{right}\""));
    }
    let place_of_set = if set.is_some() { place.key(right) } else { place.clone() };
    let set = set.as_deref().unwrap_or(name);
    if let Some(force) = load.force {
        return Some(LoadKind::Force { nodes: scene.node_set(reader, set, &place_of_set)?.to_vec(), force });
    }
    let edges = scene.edge_set(reader, set, &place_of_set)?.to_vec();
    if let Some((mesh, inner)) =
        scene.mesh.and_then(|mesh| Some((mesh, *edges.iter().find(|edge| mesh.neighbour(**edge).is_some())?)))
    {
        let other = mesh.neighbour(inner).map_or(inner.element, |other| other.element);
        let message = format!(
            "an edge of '{set}' lies inside the body, between the elements {} and {}: a traction or pressure acts on \
             the surface of a body; name edges on its boundary, or give forces at nodes",
            inner.element + 1,
            other + 1
        );
        reader.problem(&place_of_set, message);
    }
    match (load.traction, load.pressure) {
        (Some(traction), _) => Some(LoadKind::Traction { edges, traction }),
        (None, pressure) => Some(LoadKind::Pressure { edges, pressure: pressure? }),
    }
}

/// A direction of length 1.
fn unit(reader: &mut Reader<'_>, direction: document::Direction, place: &Place) -> Option<[f64; 2]> {
    match direction {
        document::Direction::Axis(axis) => Some(BOTH[axis as usize]),
        document::Direction::Vector(vector) => {
            let direction = normalised(vector);
            if !direction.iter().all(|component| component.is_finite()) {
                reader.problem(place, format!("[{}, {}] has no direction", vector[0], vector[1]));
                return None;
            }
            Some(direction)
        }
    }
}

/// NaN if it has no length.
fn normalised([x, y]: [f64; 2]) -> [f64; 2] {
    // scaled first: squares of long vectors overflow
    let scale = x.abs().max(y.abs());
    let (x, y) = (x / scale, y / scale);
    let length = x.hypot(y);
    [x / length, y / length]
}

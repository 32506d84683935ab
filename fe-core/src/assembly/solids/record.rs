//! Data of each element and of each part that stay the same from the start, and each element's last evaluation.

use super::TangentChoice;
use super::block::{BlockPlace, ElementBlock};
use super::element::ReferenceElement;
use super::points::Points;
use crate::element::{ElementKind, MAX_NODES, MappedPoint};
use crate::kinematics::PlaneModel;
use crate::mesh::Mesh;
use crate::model::{Model, ModelError, PluginLaw};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;
use umat_abi::host::{InitialPoint, Validation, recorder};
use umat_abi::metadata::{flags, stress_states};

/// Largest number of elements in a block: some 0.1 ms of work. Laws that may not be called by several threads have one
/// block for each part.
const ELEMENTS_PER_BLOCK: usize = 16;

/// Data of an element, and the status of its last evaluation.
#[derive(Clone, Debug)]
pub(super) struct ElementData {
    /// Index in the mesh.
    pub(super) element: usize,
    pub(super) kind: ElementKind,
    nodes: [usize; MAX_NODES],
    pub(super) characteristic_length: f64,
    /// Points among those of the block.
    pub(super) points: Range<usize>,
    /// Gradients among those of the block: one per point and node.
    gradients: Range<usize>,
    /// Nodal values in arrays over the block.
    pub(super) nodal: Range<usize>,
    /// Stiffness among those of the block.
    pub(super) stiffness: Range<usize>,
    pub(super) built: Built,
    /// The trial state is that of the evaluated displacements, from the committed state.
    pub(super) is_evaluated: bool,
    /// Whether the stiffness is there too.
    pub(super) has_tangent: bool,
}

/// How the stiffness of an element was built, as it is kept between runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Built {
    pub(super) choice: TangentChoice,
    /// A DDSDDE is another one than that of the stiffness.
    pub(super) moduli_changed: bool,
    pub(super) is_unsymmetric: bool,
    pub(super) version: u64,
    /// Forces and energy left of it once it is released.
    pub(super) spalled: Option<Spalled>,
}

/// Remainder of a released element: nodal forces that fade, a soft spring while they do, and its energy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Spalled {
    /// Nodal forces when it was released, N, and the displacements of its nodes, mm.
    forces: Vec<[f64; 2]>,
    displacements: Vec<[f64; 2]>,
    /// Part of the forces that acts.
    share: f64,
    /// Nodal forces at the start of the increment, and of the last evaluation.
    start: Vec<[f64; 2]>,
    end: Vec<[f64; 2]>,
    /// Energy stored when it was released, and the work of its forces since, N·mm: trapezoidal, like the external work.
    pub(super) energy: f64,
    /// Work in the increment of the last evaluation.
    pub(super) work: f64,
}

impl Spalled {
    /// Stiffness while its forces fade, relative to its virgin one: cracked neighbours cannot carry a force that does not yield.
    const SOFT: f64 = 1e-5;
    /// Relative stiffness that Newton's method uses once there is none: nodes held by released elements alone follow their
    /// neighbours.
    const GHOST: f64 = 1e-8;

    pub(super) fn new(forces: &[[f64; 2]], displacements: &[[f64; 2]], stored: f64) -> Self {
        let forces = forces.to_vec();
        Self {
            displacements: displacements.to_vec(),
            share: 1.0,
            start: forces.clone(),
            end: forces.clone(),
            forces,
            energy: stored,
            work: 0.0,
        }
    }

    /// Returns the part of its forces that acts.
    pub(super) fn share(&self) -> f64 {
        self.share
    }

    /// Sets the share of its forces that acts, and returns the share of the virgin stiffness that it then has.
    pub(super) fn set_share(&mut self, share: f64) -> f64 {
        self.share = share;
        (Self::SOFT * share).max(Self::GHOST)
    }

    /// Evaluates its nodal forces over an increment of its nodes, f = share f₀ + K (u − u₀), and 0 once the share is 0.
    pub(super) fn act(&mut self, [start, end]: [&[[f64; 2]]; 2], stiffness: &[f64], forces: &mut [[f64; 2]]) {
        let moved: Vec<f64> =
            end.as_flattened().iter().zip(self.displacements.as_flattened()).map(|(u, v)| u - v).collect();
        let rows = stiffness.chunks(moved.len());
        for ((force, own), row) in forces.as_flattened_mut().iter_mut().zip(self.forces.as_flattened()).zip(rows) {
            let spring: f64 = row.iter().zip(&moved).map(|(stiffness, moved)| stiffness * moved).sum();
            *force = if self.share > 0.0 { self.share * own + spring } else { 0.0 };
        }
        self.end.copy_from_slice(forces);
        let change = end.as_flattened().iter().zip(start.as_flattened()).map(|(end, start)| end - start);
        let means =
            self.start.as_flattened().iter().zip(self.end.as_flattened()).map(|(start, end)| 0.5 * (start + end));
        self.work = means.zip(change).map(|(force, change)| force * change).sum();
    }

    /// Books the increment of the last evaluation.
    pub(super) fn commit(&mut self) {
        self.energy += std::mem::take(&mut self.work);
        self.start.copy_from_slice(&self.end);
    }
}

impl ElementData {
    pub(super) fn nodes(&self) -> &[usize] {
        &self.nodes[..self.kind.node_count()]
    }

    /// Discards the last evaluation.
    pub(super) fn forget(&mut self) {
        (self.is_evaluated, self.has_tangent) = (false, false);
        if let Some(spalled) = &mut self.built.spalled {
            spalled.work = 0.0;
        }
    }
}

/// Properties that all elements of a part share.
#[derive(Debug)]
pub(super) struct PartData {
    pub(super) name: String,
    axisymmetric: bool,
    average: bool,
    /// The dissipation of its law is damage, not plastic flow.
    pub(super) damages: bool,
    /// The states of its law that are damage, or grow with it.
    damage: Vec<usize>,
    /// The state of its law that is the work of the overstress: it extrapolates.
    pub(super) overstress_work: Option<usize>,
    /// The state of its law that is the equivalent plastic strain.
    pub(super) plastic_strain: Option<usize>,
    /// Whether its tangent may be negative.
    pub(super) softens: bool,
    /// Whether equilibrium with it may lose its stability.
    pub(super) may_lose_stability: bool,
    /// Whether it has large displacements.
    pub(super) nlgeom: bool,
    /// Shape functions at the points of each kind of element.
    values: [Vec<[f64; MAX_NODES]>; ElementKind::ALL.len()],
}

impl PartData {
    /// Shape functions at a point of an element, from its first.
    pub(super) fn values(&self, kind: ElementKind, point: usize) -> &[f64; MAX_NODES] {
        &self.values[kind as usize][point]
    }
}

/// The points of some elements of a part, and their reference configuration.
#[derive(Debug)]
pub(super) struct Body {
    pub(super) part: Arc<PartData>,
    /// Index of the part.
    pub(super) index: usize,
    pub(super) points: Points,
    gradients: Vec<[f64; 2]>,
    pub(super) volumes: Vec<f64>,
    pub(super) positions: Vec<[f64; 2]>,
}

/// An element's reference configuration, of what its body has of all elements.
fn reference<'a, const N: usize>(
    part: &'a PartData,
    (gradients, volumes, positions): (&'a [[f64; 2]], &'a [f64], &'a [[f64; 2]]),
    record: &ElementData,
) -> ReferenceElement<'a, N> {
    ReferenceElement {
        gradients: gradients[record.gradients.clone()].as_chunks::<N>().0,
        values: &part.values[record.kind as usize],
        volumes: &volumes[record.points.clone()],
        positions: &positions[record.points.clone()],
        axisymmetric: part.axisymmetric,
        average: part.average && record.kind == ElementKind::Q4,
        first_point: record.points.start,
    }
}

impl Body {
    /// An element's reference configuration, and the points.
    pub(super) fn split<const N: usize>(&mut self, record: &ElementData) -> (ReferenceElement<'_, N>, &mut Points) {
        let Self { part, points, gradients, volumes, positions, .. } = self;
        (reference(part, (gradients, volumes, positions), record), points)
    }

    /// An element's reference configuration.
    pub(super) fn reference<const N: usize>(&self, record: &ElementData) -> ReferenceElement<'_, N> {
        reference(&self.part, (&self.gradients, &self.volumes, &self.positions), record)
    }

    /// Returns whether a point's law has a damage that has grown, or has none and has dissipated.
    pub(super) fn has_failed(&self, point: usize) -> bool {
        let states = &self.points.committed;
        if self.part.damages {
            let statev = &states.statev[self.points.statev(point)];
            return self.part.damage.iter().any(|&state| statev[state] > 0.0);
        }
        let [_, plastic, creep] = states.energies[point];
        plastic + creep > 0.0
    }

    /// A point as user subroutines get it: its element, and its number in it.
    fn initial_point(&self, point: usize, element: usize, number: usize) -> InitialPoint {
        let [x, y] = self.positions[point];
        InitialPoint { coordinates: [x, y, 0.0], element: number_of(element), point: number_of(number) }
    }

    fn add_points(&mut self, mesh: &Mesh, element: usize) {
        let (kind, thickness) = (mesh.elements()[element].kind(), mesh.elements()[element].thickness());
        let model = mesh.parts()[self.index].model;
        let (positions, count) = mesh.element_positions(element);
        for point in mesh.integration_points(element) {
            let mapped = MappedPoint::new(kind, &positions[..count], point.coordinates)
                .expect("checked: a mesh has no inverted element");
            self.gradients.extend_from_slice(mapped.shape.derivatives());
            let depth = model.depth(mapped.position[0], thickness);
            self.volumes.push(depth * mapped.determinant * point.weight);
            self.positions.push(mapped.position);
        }
    }
}

/// A model's elements, divided.
pub(super) struct Divided {
    pub(super) blocks: Vec<ElementBlock>,
    /// The place of each element.
    pub(super) places: Vec<BlockPlace>,
    /// Findings on its laws that users should know.
    pub(super) notes: Vec<String>,
}

/// Divides the elements of a model into blocks, in the order of the first element of each, and finds the place of each
/// element. If threads do not share them, a part is one block.
pub(super) fn blocks(model: &Model, share_threads: bool) -> Result<Divided, ModelError> {
    let mut notes = Vec::new();
    let Model { mesh, laws, average_dilatation, nlgeom, .. } = model;
    let parts = mesh.parts();
    for (count, what) in [
        (laws.len(), "laws"),
        (average_dilatation.len(), "choices of average dilatation"),
        (nlgeom.len(), "choices of large displacements"),
    ] {
        if count != parts.len() {
            return Err(ModelError(format!("the mesh has {} parts, but {count} {what} were given", parts.len())));
        }
    }
    let groups = groups(mesh, if share_threads { ELEMENTS_PER_BLOCK } else { usize::MAX });
    let shared = laws
        .iter()
        .enumerate()
        .map(|(part, law)| checked_part(mesh, part, law, [average_dilatation[part], nlgeom[part]]).map(Arc::new))
        .collect::<Result<Vec<_>, _>>()?;
    let mut blocks = Vec::with_capacity(groups.len());
    let mut places = vec![BlockPlace::default(); mesh.elements().len()];
    for Group { part, elements } in &groups {
        for (local, &element) in elements.iter().enumerate() {
            places[element] = BlockPlace { block: blocks.len(), local };
        }
        blocks.push(block(mesh, *part, &shared[*part], &laws[*part], elements)?);
    }
    set_initial_states(laws, &mut blocks, &places)?;
    set_initial_stresses(mesh, laws, &mut blocks, &places)?;
    for block in &mut blocks {
        let mut initial = model.fields.initial.clone();
        if let Some(field) = model.field.as_ref().filter(|field| field.parts[block.body.index]) {
            initial.temperature = field.initial;
        }
        block.set_fields(&initial, &initial);
    }
    for (part, law) in laws.iter().enumerate() {
        let mut of_part = blocks.iter_mut().map(|block| &mut block.body).filter(|body| body.index == part);
        let Some(first) = of_part.next() else { continue };
        if let Some((_, length)) = largest_element(mesh, part) {
            first.points.call.celent = length;
        }
        notes.extend(first.points.prepare(law, &shared[part].name, nlgeom[part])?);
        if nlgeom[part] && parts[part].model == PlaneModel::PlaneStress && !first.points.knows_thickness() {
            notes.push(format!(
                "part '{}': {} does not report the strain 33 in plane stress: its thickness stays the initial one (\"as\": \"3d\" finds it)",
                shared[part].name, law.name
            ));
        }
        for body in of_part {
            body.points.take_from(law, &first.points, &shared[part].name)?;
        }
    }
    Ok(Divided { blocks, places, notes })
}

/// Returns whether UMATs may be called from several threads: all declare it, and none is watched.
pub(super) fn may_share_threads(laws: &[PluginLaw]) -> bool {
    let is_safe = |law: &PluginLaw| law.law.as_ref().is_some_and(|law| law.flags & flags::THREAD_SAFE != 0);
    laws.iter().all(is_safe) && recorder::installed().is_none()
}

/// Elements of one part.
struct Group {
    part: usize,
    elements: Vec<usize>,
}

/// Returns the elements of each part in groups of at most `limit`. Parts without elements get an empty group each,
/// after the others.
fn groups(mesh: &Mesh, limit: usize) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    let mut last_of_part: Vec<Option<usize>> = vec![None; mesh.parts().len()];
    for (element, definition) in mesh.elements().iter().enumerate() {
        let part = definition.part();
        match last_of_part[part].map(|last| &mut groups[last].elements) {
            Some(elements) if elements.len() < limit => elements.push(element),
            _ => {
                last_of_part[part] = Some(groups.len());
                groups.push(Group { part, elements: vec![element] });
            }
        }
    }
    let empty = last_of_part.iter().enumerate().filter(|(_, last)| last.is_none());
    groups.extend(empty.map(|(part, _)| Group { part, elements: Vec::new() }));
    groups
}

fn checked_part(
    mesh: &Mesh,
    part: usize,
    law: &PluginLaw,
    [average, nlgeom]: [bool; 2],
) -> Result<PartData, ModelError> {
    let definition = &mesh.parts()[part];
    check_law(mesh, part, law)?;
    let overstress_work = law.overstress_work();
    let damage = law.damage_states();
    Ok(PartData {
        name: definition.name.clone(),
        axisymmetric: definition.model == PlaneModel::Axisymmetric,
        // In plane stress nothing locks.
        average: average && definition.model != PlaneModel::PlaneStress,
        damages: !damage.is_empty(),
        damage,
        overstress_work,
        plastic_strain: law.equivalent_plastic_strain(),
        softens: law.softens(),
        may_lose_stability: law.may_lose_stability(),
        nlgeom,
        values: std::array::from_fn(|kind| {
            let kind = ElementKind::ALL[kind];
            let integration = definition.integration.unwrap_or(kind.default_integration());
            let points = kind.integration_points(integration).unwrap_or_default();
            points.iter().map(|point| kind.shape_functions(point.coordinates).values).collect()
        }),
    })
}

/// Makes a block of some elements of a part.
fn block(
    mesh: &Mesh,
    part: usize,
    shared: &Arc<PartData>,
    law: &PluginLaw,
    elements: &[usize],
) -> Result<ElementBlock, ModelError> {
    let count = elements.iter().map(|&element| mesh.integration_points(element).len()).sum();
    let mut body = Body {
        part: Arc::clone(shared),
        index: part,
        points: Points::new(law, mesh.parts()[part].model, &shared.name, count)?,
        gradients: Vec::new(),
        volumes: Vec::with_capacity(count),
        positions: Vec::with_capacity(count),
    };
    let mut records: Vec<ElementData> = Vec::with_capacity(elements.len());
    for &element in elements {
        let definition = &mesh.elements()[element];
        let kind = definition.kind();
        let (first_point, first_gradient) = (body.volumes.len(), body.gradients.len());
        body.add_points(mesh, element);
        let count = kind.node_count();
        let mut nodes = [0; MAX_NODES];
        nodes[..count].copy_from_slice(definition.nodes());
        let nodal = records.last().map_or(0, |last| last.nodal.end);
        let stiffness = records.last().map_or(0, |last| last.stiffness.end);
        records.push(ElementData {
            element,
            kind,
            nodes,
            characteristic_length: mesh.characteristic_length(element),
            points: first_point..body.volumes.len(),
            gradients: first_gradient..body.gradients.len(),
            nodal: nodal..nodal + count,
            stiffness: stiffness..stiffness + 4 * count * count,
            // The virgin stiffness is not built yet.
            built: Built { moduli_changed: true, ..Built::default() },
            is_evaluated: false,
            has_tangent: false,
        });
    }
    Ok(ElementBlock::new(body, records))
}

/// STATEV of every point: of the case, of the library's SDVINI, or zeros.
fn set_initial_states(
    laws: &[PluginLaw],
    blocks: &mut [ElementBlock],
    places: &[BlockPlace],
) -> Result<(), ModelError> {
    let mut initial: Vec<_> = laws.iter().map(PluginLaw::initial_states).collect();
    for (element, place) in places.iter().enumerate() {
        let ElementBlock { body, records, .. } = &mut blocks[place.block];
        let (law, initial) = (&laws[body.index], &mut initial[body.index]);
        if initial.are_zero() {
            continue;
        }
        for (number, point) in records[place.local].points.clone().enumerate() {
            let at = body.initial_point(point, element, number);
            let statev =
                initial.of_point(&at).map_err(|error| ModelError::of_part(&body.part.name, law.error(error)))?;
            body.points.set_initial_states(point, &statev);
        }
    }
    Ok(())
}

/// Stress of every point: of the case, of the library's SIGINI, or 0. Whether it is in equilibrium shows at the start.
fn set_initial_stresses(
    mesh: &Mesh,
    laws: &[PluginLaw],
    blocks: &mut [ElementBlock],
    places: &[BlockPlace],
) -> Result<(), ModelError> {
    let model = |part: usize| mesh.parts()[part].model;
    let mut initial: Vec<_> = laws.iter().enumerate().map(|(part, law)| law.initial_stresses(model(part))).collect();
    for (element, place) in places.iter().enumerate() {
        let ElementBlock { body, records, .. } = &mut blocks[place.block];
        let (law, initial) = (&laws[body.index], &mut initial[body.index]);
        if initial.are_zero() {
            continue;
        }
        let ElementData { kind, ref points, .. } = records[place.local];
        for (number, point) in points.clone().enumerate() {
            let at = body.initial_point(point, element, number);
            let mut stress = initial
                .of_point(&at, &element_type(model(body.index), kind))
                .map_err(|error| ModelError::of_part(&body.part.name, law.error(error)))?;
            if let (None, Some(frame)) = (&law.stress0, &law.frame) {
                // SIGINI speaks of the local axes
                frame.stress_outside(&mut stress, model(body.index).stress_state());
            }
            body.points.set_initial_stress(point, &stress);
        }
    }
    Ok(())
}

/// Returns what ABAQUS calls an element.
fn element_type(model: PlaneModel, kind: ElementKind) -> String {
    let family = match model {
        PlaneModel::PlaneStress => "CPS",
        PlaneModel::PlaneStrain => "CPE",
        PlaneModel::Axisymmetric => "CAX",
    };
    format!("{family}{}", kind.node_count())
}

/// NOEL or NPT of an index: a plugin counts from 1.
pub(super) fn number_of(index: usize) -> i32 {
    i32::try_from(index + 1).unwrap_or(i32::MAX)
}

/// Returns the element of a part with the greatest characteristic length, and that length.
fn largest_element(mesh: &Mesh, part: usize) -> Option<(usize, f64)> {
    let of_part = (0..mesh.elements().len()).filter(|&element| mesh.elements()[element].part() == part);
    let with_length = of_part.map(|element| (element, mesh.characteristic_length(element)));
    with_length.max_by(|(_, a), (_, b)| a.total_cmp(b))
}

/// Checks plane model, parameters and size of elements with the law itself.
fn check_law(mesh: &Mesh, part: usize, plugin: &PluginLaw) -> Result<(), ModelError> {
    let Some(law) = &plugin.law else { return Ok(()) };
    let definition = &mesh.parts()[part];
    let (needed, form) = match definition.model {
        PlaneModel::PlaneStress => (stress_states::PLANE_STRESS, "plane-stress"),
        PlaneModel::PlaneStrain => (stress_states::PLANE_STRAIN, "plane-strain"),
        PlaneModel::Axisymmetric => (stress_states::AXISYMMETRIC, "axisymmetric"),
    };
    let (part_name, law_name) = (&definition.name, &plugin.name);
    let through_six = plugin.manner.has_six(law, definition.model.stress_state());
    if law.stress_states & needed == 0 && !through_six {
        return Err(ModelError::of_part(part_name, format!("{law_name} has no {form} form")));
    }
    let Some((element, length)) = largest_element(mesh, part) else { return Ok(()) };
    match law.validate(&plugin.props, Some(length)) {
        Validation::Valid => Ok(()),
        Validation::Invalid(message) | Validation::NeedsCharacteristicLength(message) => {
            let place = format!("part '{part_name}', element {} (characteristic length {length} mm)", element + 1);
            Err(ModelError(format!("{place}: {law_name}: {message}")))
        }
    }
}

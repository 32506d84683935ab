//! What stays of each element and of each part from the start.

use super::TangentChoice;
use super::element::Shape;
use super::error::SolidsError;
use super::points::Points;
use crate::element::{ElementKind, MAX_NODES, MappedPoint};
use crate::kinematics::PlaneModel;
use crate::mesh::Mesh;
use crate::model::{Model, PluginLaw};
use std::ops::Range;
use umat_abi::host::Validation;
use umat_abi::metadata::stress_states;

/// An element, and what is known of its last evaluation.
#[derive(Clone, Debug)]
pub(super) struct Record {
    pub(super) kind: ElementKind,
    pub(super) part: usize,
    nodes: [usize; MAX_NODES],
    pub(super) characteristic_length: f64,
    /// Its points among those of the part.
    pub(super) points: Range<usize>,
    /// Its gradients among those of the part: one per point and node.
    gradients: Range<usize>,
    /// Its nodal values in arrays over all elements.
    pub(super) nodal: Range<usize>,
    /// Its stiffness among all.
    pub(super) stiffness: Range<usize>,
    pub(super) choice: TangentChoice,
    /// The trial state is that of the evaluated displacements, from the committed state.
    pub(super) is_evaluated: bool,
    /// And so is the stiffness.
    pub(super) has_tangent: bool,
    /// A DDSDDE is another one than that of the stiffness.
    pub(super) moduli_changed: bool,
    pub(super) is_unsymmetric: bool,
    pub(super) version: u64,
}

impl Record {
    pub(super) fn nodes(&self) -> &[usize] {
        &self.nodes[..self.kind.node_count()]
    }

    /// The last evaluation says nothing any more.
    pub(super) fn forget(&mut self) {
        (self.is_evaluated, self.has_tangent) = (false, false);
    }
}

/// A part: its points, and their reference configuration.
#[derive(Debug)]
pub(super) struct Body {
    pub(super) name: String,
    pub(super) points: Points,
    axisymmetric: bool,
    average: bool,
    /// The dissipation of its law is damage, not plastic flow.
    pub(super) damages: bool,
    /// Its tangent may be negative: the law damages, or does not say.
    pub(super) softens: bool,
    /// Equilibrium with it may lose its stability: it softens, or its tangent is unsymmetric, so that bands may form
    /// while it still hardens (Rudnicki and Rice 1975).
    pub(super) may_lose_stability: bool,
    /// It has large displacements.
    pub(super) nlgeom: bool,
    gradients: Vec<[f64; 2]>,
    /// Shape functions at the points of each kind of element.
    values: [Vec<[f64; MAX_NODES]>; ElementKind::ALL.len()],
    pub(super) volumes: Vec<f64>,
    pub(super) positions: Vec<[f64; 2]>,
}

impl Body {
    /// An element's reference configuration, and the points.
    pub(super) fn split<const N: usize>(&mut self, record: &Record) -> (Shape<'_, N>, &mut Points) {
        let shape = Shape {
            gradients: self.gradients[record.gradients.clone()].as_chunks::<N>().0,
            values: &self.values[record.kind as usize],
            volumes: &self.volumes[record.points.clone()],
            positions: &self.positions[record.points.clone()],
            axisymmetric: self.axisymmetric,
            average: self.average && record.kind == ElementKind::Q4,
            first_point: record.points.start,
        };
        (shape, &mut self.points)
    }

    /// Shape functions at a point of an element, from its first.
    pub(super) fn values(&self, kind: ElementKind, point: usize) -> &[f64; MAX_NODES] {
        &self.values[kind as usize][point]
    }
}

/// The parts and the elements of a model.
pub(super) fn bodies(model: &Model) -> Result<(Vec<Body>, Vec<Record>), SolidsError> {
    let Model { mesh, laws, average_dilatation, nlgeom, .. } = model;
    let parts = mesh.parts();
    if laws.len() != parts.len() {
        return Err(SolidsError::LawCount { parts: parts.len(), laws: laws.len() });
    }
    if average_dilatation.len() != parts.len() {
        return Err(SolidsError::AverageDilatationCount { parts: parts.len(), choices: average_dilatation.len() });
    }
    if nlgeom.len() != parts.len() {
        return Err(SolidsError::LargeDisplacementCount { parts: parts.len(), choices: nlgeom.len() });
    }
    let mut counts = vec![0; parts.len()];
    for (element, definition) in mesh.elements().iter().enumerate() {
        counts[definition.part()] += mesh.integration_points(element).len();
    }
    let mut bodies = Vec::with_capacity(parts.len());
    for (part, law) in laws.iter().enumerate() {
        bodies.push(body(mesh, part, law, [average_dilatation[part], nlgeom[part]], counts[part])?);
    }
    let records = records(mesh, &mut bodies);
    set_initial_states(laws, &mut bodies, &records)?;
    for (body, law) in bodies.iter_mut().zip(laws) {
        body.points.find_elastic(law, &body.name)?;
    }
    Ok((bodies, records))
}

fn body(
    mesh: &Mesh,
    part: usize,
    law: &PluginLaw,
    [average, nlgeom]: [bool; 2],
    count: usize,
) -> Result<Body, SolidsError> {
    let definition = &mesh.parts()[part];
    check_law(mesh, part, law)?;
    let mut points = Points::new(law, definition.model, &definition.name, count)?;
    if let Some(element) = largest_element(mesh, part) {
        points.call.celent = mesh.characteristic_length(element);
    }
    let softens = law.law.as_ref().is_none_or(has_damage);
    Ok(Body {
        name: definition.name.clone(),
        points,
        axisymmetric: definition.model == PlaneModel::Axisymmetric,
        // In plane stress nothing locks.
        average: average && definition.model != PlaneModel::PlaneStress,
        damages: law.law.as_ref().is_some_and(has_damage),
        softens,
        may_lose_stability: softens || !law.has_symmetric_tangent(),
        nlgeom,
        gradients: Vec::new(),
        values: std::array::from_fn(|kind| {
            let kind = ElementKind::ALL[kind];
            let integration = definition.integration.unwrap_or(kind.default_integration());
            let points = kind.integration_points(integration).unwrap_or_default();
            points.iter().map(|point| padded(kind.shape_functions(point.coordinates).values())).collect()
        }),
        volumes: Vec::with_capacity(count),
        positions: Vec::with_capacity(count),
    })
}

/// STATEV of every point: of the case, of the library's SDVINI, or zeros.
fn set_initial_states(laws: &[PluginLaw], bodies: &mut [Body], records: &[Record]) -> Result<(), SolidsError> {
    let mut initial: Vec<_> = laws.iter().map(PluginLaw::initial_states).collect();
    for (element, record) in records.iter().enumerate() {
        let (law, initial) = (&laws[record.part], &mut initial[record.part]);
        if initial.are_zero() {
            continue;
        }
        let body = &mut bodies[record.part];
        for (number, point) in record.points.clone().enumerate() {
            let statev = law
                .states_of_point(initial, body.positions[point], number_of(element), number_of(number))
                .map_err(|source| SolidsError::Umat { part: body.name.clone(), source })?;
            body.points.set_initial_states(point, &statev);
        }
    }
    Ok(())
}

/// NOEL or NPT of an index: a plugin counts from 1.
pub(super) fn number_of(index: usize) -> i32 {
    i32::try_from(index + 1).unwrap_or(i32::MAX)
}

fn padded(values: &[f64]) -> [f64; MAX_NODES] {
    std::array::from_fn(|node| values.get(node).copied().unwrap_or(0.0))
}

/// Whether a law tells a damage: then what it dissipates is damage.
fn has_damage(law: &umat_abi::host::Law) -> bool {
    let mut names = law.derived.iter().map(|derived| &derived.name).chain(law.states.iter().map(|state| &state.name));
    names.any(|name| {
        name.eq_ignore_ascii_case("d") || name.starts_with("D_") || name.starts_with("d_") || name.contains("damage")
    })
}

fn largest_element(mesh: &Mesh, part: usize) -> Option<usize> {
    let length = |&element: &usize| mesh.characteristic_length(element);
    let of_part = (0..mesh.elements().len()).filter(|&element| mesh.elements()[element].part() == part);
    of_part.max_by(|a, b| length(a).total_cmp(&length(b)))
}

/// What the law itself says of the plane model, the parameters and the size of elements.
fn check_law(mesh: &Mesh, part: usize, plugin: &PluginLaw) -> Result<(), SolidsError> {
    let Some(law) = &plugin.law else { return Ok(()) };
    let definition = &mesh.parts()[part];
    let needed = match definition.model {
        PlaneModel::PlaneStress => stress_states::PLANE_STRESS,
        PlaneModel::PlaneStrain => stress_states::PLANE_STRAIN,
        PlaneModel::Axisymmetric => stress_states::AXISYMMETRIC,
    };
    let (part_name, law_name) = (definition.name.clone(), plugin.name.clone());
    if law.stress_states & needed == 0 {
        return Err(SolidsError::PlaneModel { part: part_name, law: law_name, model: definition.model });
    }
    let Some(element) = largest_element(mesh, part) else { return Ok(()) };
    let length = mesh.characteristic_length(element);
    match law.validate(&plugin.props, Some(length)) {
        Validation::Valid => Ok(()),
        Validation::Invalid(message) | Validation::NeedsCharacteristicLength(message) => {
            Err(SolidsError::Parameters { part: part_name, law: law_name, element, length, message })
        }
    }
}

/// The elements, in the order of the mesh; gradients, volumes and positions of their points go to their parts.
fn records(mesh: &Mesh, bodies: &mut [Body]) -> Vec<Record> {
    let mut records: Vec<Record> = Vec::with_capacity(mesh.elements().len());
    for (element, definition) in mesh.elements().iter().enumerate() {
        let (kind, part) = (definition.kind(), definition.part());
        let body = &mut bodies[part];
        let (first_point, first_gradient) = (body.volumes.len(), body.gradients.len());
        add_points(mesh, element, body);
        let count = kind.node_count();
        let mut nodes = [0; MAX_NODES];
        nodes[..count].copy_from_slice(definition.nodes());
        let nodal = records.last().map_or(0, |last| last.nodal.end);
        let stiffness = records.last().map_or(0, |last| last.stiffness.end);
        records.push(Record {
            kind,
            part,
            nodes,
            characteristic_length: mesh.characteristic_length(element),
            points: first_point..body.volumes.len(),
            gradients: first_gradient..body.gradients.len(),
            nodal: nodal..nodal + count,
            stiffness: stiffness..stiffness + 4 * count * count,
            choice: TangentChoice::default(),
            is_evaluated: false,
            has_tangent: false,
            // The virgin stiffness is not built yet.
            moduli_changed: true,
            is_unsymmetric: false,
            version: 0,
        });
    }
    records
}

fn add_points(mesh: &Mesh, element: usize, body: &mut Body) {
    let kind = mesh.elements()[element].kind();
    let part = &mesh.parts()[mesh.elements()[element].part()];
    let (positions, count) = mesh.element_positions(element);
    for point in mesh.integration_points(element) {
        let mapped = MappedPoint::new(kind, &positions[..count], point.coordinates)
            .expect("checked: a mesh has no inverted element");
        body.gradients.extend_from_slice(mapped.shape.derivatives());
        let depth = part.model.depth(mapped.position[0], part.thickness);
        body.volumes.push(depth * mapped.determinant * point.weight);
        body.positions.push(mapped.position);
    }
}

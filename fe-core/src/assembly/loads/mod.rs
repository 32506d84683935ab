//! Consistent nodal forces of loads, and the stiffness of pressures that follow their edges.
//!
//! ```text
//! traction    f_i = ∫ N_i t dA                        dA = |∂X/∂s| ds · depth, reference
//! pressure    f_i = −p ∫ N_i n dA                     n dA = (∂y/∂s, −∂x/∂s) ds · depth, outward
//! depth       the element's thickness, or 2πr
//! ```
//!
//! Under large displacements a pressure acts on the present edge, with the present radius or thickness. Its stiffness leaves
//! the change of the thickness out: no law of plane stress returns it at an edge. Tractions and forces keep direction and area.
//!
//! Loads on released elements fade with their forces: on an edge with those of its element, at a node with those of the last of
//! its elements.

use super::system::freedoms;
use crate::element::EdgePoint;
use crate::kinematics::PlaneModel;
use crate::mesh::{EdgeNodes, ElementEdge, Mesh};
use crate::model::{Freedom, Load, LoadKind, Model};
use crate::solver::Blocks;

#[cfg(test)]
mod test;

/// Gauss–Legendre points and weights: exact to degree 5, which N (2) · ∂x/∂s (1) · r (2) of a quadratic edge has.
const RULE: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Elements that carry loads.
pub struct Bearers<'a> {
    /// The present thickness of an element with large displacements, mm.
    pub thickness: &'a dyn Fn(usize) -> Option<f64>,
    /// Shares of the loads that are left; `None`: no element was released.
    pub shares: Option<Shares>,
}

impl Bearers<'_> {
    fn of_element(&self, element: usize) -> f64 {
        self.shares.as_ref().map_or(1.0, |shares| shares.elements[element])
    }

    fn of_node(&self, node: usize) -> f64 {
        self.shares.as_ref().map_or(1.0, |shares| shares.nodes[node])
    }
}

/// The parts of their loads that elements and nodes bear.
#[derive(Clone, Debug)]
pub struct Shares {
    elements: Vec<f64>,
    nodes: Vec<f64>,
}

impl Shares {
    /// Makes the shares of nodes from those of the elements. A node carries its force as long as any of its elements
    /// does; a node without elements always does.
    pub fn new(mesh: &Mesh, of_element: impl Fn(usize) -> f64) -> Self {
        let elements: Vec<f64> = (0..mesh.elements().len()).map(of_element).collect();
        let mut nodes: Vec<Option<f64>> = vec![None; mesh.nodes().len()];
        for (element, &share) in mesh.elements().iter().zip(&elements) {
            for &node in element.nodes() {
                nodes[node] = Some(nodes[node].map_or(share, |most| most.max(share)));
            }
        }
        Self { elements, nodes: nodes.into_iter().map(|share| share.unwrap_or(1.0)).collect() }
    }
}

/// Adds the nodal forces (N) of `factor` times a load to `forces`.
///
/// `displacements` (two per node, mm) matter to pressures on elements with large displacements. Then, if `blocks` are given, each
/// loaded edge adds one: −∂force/∂displacement, what the load adds to the system's stiffness. It is not symmetric.
///
/// # Panics
///
/// If the load names nodes or edges that the mesh does not have, or the vectors do not hold two per node.
pub fn external(
    mesh: &Mesh,
    bearers: &Bearers<'_>,
    load: &LoadKind,
    factor: f64,
    displacements: &[f64],
    forces: &mut [f64],
    mut blocks: Option<&mut Blocks>,
) {
    match load {
        LoadKind::Force { nodes, force } => {
            for &node in nodes {
                let factor = factor * bearers.of_node(node);
                for component in 0..2 {
                    forces[Freedom { node, component }.index()] += factor * force[component];
                }
            }
        }
        LoadKind::Traction { edges, traction } => {
            for &edge in edges {
                let loaded = LoadedEdge::new(mesh, edge, None);
                let factor = factor * bearers.of_element(edge.element);
                loaded.add(forces, |point| traction.map(|component| factor * component * point.stretch()));
            }
        }
        LoadKind::Pressure { edges, pressure } => {
            for &edge in edges {
                let pressure = factor * pressure * bearers.of_element(edge.element);
                let present = (bearers.thickness)(edge.element);
                let mut loaded = LoadedEdge::new(mesh, edge, present.map(|_| displacements));
                loaded.thickness = present.unwrap_or(loaded.thickness);
                loaded.add(forces, |point| [-pressure * point.tangent[1], pressure * point.tangent[0]]);
                if let Some(blocks) = blocks.as_deref_mut()
                    && present.is_some()
                {
                    loaded.add_pressure_stiffness(pressure, blocks);
                }
            }
        }
    }
}

/// An edge at the position where its load acts.
struct LoadedEdge {
    edge: EdgeNodes,
    positions: [[f64; 2]; 3],
    model: PlaneModel,
    thickness: f64,
}

impl LoadedEdge {
    /// Makes a loaded edge at its reference position, or displaced.
    fn new(mesh: &Mesh, edge: ElementEdge, displacements: Option<&[f64]>) -> Self {
        let element = mesh.elements()[edge.element];
        let model = mesh.parts()[element.part()].model;
        let edge = mesh.edge_nodes(edge);
        let positions = mesh.edge_positions(&edge, displacements);
        Self { edge, positions, model, thickness: element.thickness() }
    }

    fn depth(&self, point: &EdgePoint) -> f64 {
        self.model.depth(point.position[0], self.thickness)
    }

    /// Adds ∫ N_i q ds of `load` = q per depth.
    fn add(&self, forces: &mut [f64], load: impl Fn(&EdgePoint) -> [f64; 2]) {
        for (s, weight) in RULE {
            let point = self.edge.kind().point(&self.positions, s);
            let (values, depth) = (self.edge.kind().shape_functions(s), self.depth(&point));
            let load = load(&point);
            for (&node, value) in self.edge.nodes().iter().zip(values) {
                for component in 0..2 {
                    forces[Freedom { node, component }.index()] += weight * depth * value * load[component];
                }
            }
        }
    }

    /// Adds the block p ∂(∫ N_i n dA)/∂u_j.
    fn add_pressure_stiffness(&self, pressure: f64, blocks: &mut Blocks) {
        let nodes = self.edge.nodes();
        let rows = freedoms(nodes);
        let size = rows.len();
        let mut values = vec![0.0; size * size];
        for (s, weight) in RULE {
            let point = self.edge.kind().point(&self.positions, s);
            let (shape, slopes) = (self.edge.kind().shape_functions(s), self.edge.kind().shape_derivatives(s));
            let depth = self.depth(&point);
            // ∂depth/∂x: 2π about an axis.
            let widening = match self.model {
                PlaneModel::Axisymmetric => std::f64::consts::TAU,
                PlaneModel::PlaneStress | PlaneModel::PlaneStrain => 0.0,
            };
            for i in 0..nodes.len() {
                let factor = weight * pressure * shape[i];
                for j in 0..nodes.len() {
                    let [x_row, y_row] = [2 * i * size, (2 * i + 1) * size];
                    values[x_row + 2 * j] += factor * point.tangent[1] * widening * shape[j];
                    values[y_row + 2 * j] -= factor * point.tangent[0] * widening * shape[j];
                    values[x_row + 2 * j + 1] += factor * depth * slopes[j];
                    values[y_row + 2 * j] -= factor * depth * slopes[j];
                }
            }
        }
        blocks.push(&rows, &values);
    }
}

/// The freedoms at which a model's loads act.
pub(crate) fn loaded_freedoms(model: &Model) -> Vec<usize> {
    let of_load = |load: &Load| match &load.kind {
        LoadKind::Force { nodes, .. } => freedoms(nodes),
        LoadKind::Traction { edges, .. } | LoadKind::Pressure { edges, .. } => {
            edges.iter().flat_map(|&edge| freedoms(model.mesh.edge_nodes(edge).nodes())).collect()
        }
    };
    model.loads.iter().flat_map(of_load).collect()
}

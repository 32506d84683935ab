//! Multi-point constraints and ties.

use super::KnownMesh;
use crate::document::PulloutCase;
use crate::document::pullout as document;
use crate::problem::Place;
use crate::reader::Reader;
use fe_core::mesh::specimen::NodeCoupling;
use fe_core::mesh::{ElementEdge, Mesh};
use fe_core::model::{Coupling, Freedom};
use std::collections::BTreeSet;

/// A node is at a position, and on an edge, within this part of the mesh's size.
const RELATIVE_TOLERANCE: f64 = 1e-6;
/// Shares of an edge up to this are rounding.
const LEAST_SHARE: f64 = 1e-3;

/// All couplings, the specimen's first; unusable ones are left out.
pub fn resolve(reader: &mut Reader<'_>, case: &PulloutCase, scene: KnownMesh<'_>) -> Vec<Coupling> {
    let root = Place::root().key("couplings");
    let own = scene.ground.into_iter().flat_map(|ground| &ground.specimen.couplings);
    let mut couplings: Vec<Coupling> =
        own.flat_map(|coupling| [0, 1].map(|component| along(coupling, component))).collect();
    for (k, coupling) in case.couplings.iter().flatten().enumerate() {
        let place = root.index(k);
        match coupling {
            document::Coupling::Terms(terms) => couplings.extend(from_terms(reader, terms, scene, &place)),
            document::Coupling::Tie(tie) => couplings.extend(from_tie(reader, tie, scene, &place)),
        }
    }
    couplings
}

/// One component of a node that follows others.
fn along(coupling: &NodeCoupling, component: usize) -> Coupling {
    let freedom = |node| Freedom { node, component };
    Coupling {
        dependent: freedom(coupling.dependent),
        terms: coupling.terms.iter().map(|&(node, factor)| (freedom(node), factor)).collect(),
    }
}

fn from_terms(
    reader: &mut Reader<'_>,
    given: &document::Terms,
    scene: KnownMesh<'_>,
    place: &Place,
) -> Option<Coupling> {
    let place_of_dependent = place.key("dependent");
    let dependent = node(reader, &given.dependent.node, scene, &place_of_dependent.key("node"));
    let dependent = dependent.map(|node| Freedom { node, component: given.dependent.component as usize });
    let mut terms = Vec::new();
    for (k, term) in given.terms.iter().enumerate() {
        let place = place.key("terms").index(k);
        let Some(node) = node(reader, &term.node, scene, &place.key("node")) else { continue };
        let freedom = Freedom { node, component: term.component as usize };
        if Some(freedom) == dependent {
            reader.problem(&place, "a displacement cannot follow itself");
        } else if terms.iter().any(|(other, _)| *other == freedom) {
            reader.problem(&place, "this displacement is named twice");
        }
        terms.push((freedom, term.factor.unwrap_or(1.0)));
    }
    Some(Coupling { dependent: dependent?, terms })
}

/// Both displacements of each node follow the edge that it lies on.
fn from_tie(reader: &mut Reader<'_>, tie: &document::Tie, scene: KnownMesh<'_>, place: &Place) -> Vec<Coupling> {
    let nodes = scene.node_set(reader, &tie.tie, &place.key("tie"));
    let edges = scene.edge_set(reader, &tie.to, &place.key("to"));
    let (Some(nodes), Some(edges), Some(mesh)) = (nodes, edges, scene.mesh) else { return Vec::new() };
    let mut couplings = Vec::new();
    for &node in nodes {
        if edges.iter().any(|&edge| mesh.edge_nodes(edge).nodes().contains(&node)) {
            continue;
        }
        let [x, y] = mesh.nodes()[node];
        match edges.iter().map(|&edge| closest(mesh, edge, [x, y])).min_by(|a, b| a.distance.total_cmp(&b.distance)) {
            Some(point) if point.distance <= RELATIVE_TOLERANCE * extent(mesh) => {
                couplings.extend([0, 1].map(|component| point.coupling(mesh, node, component)));
            }
            nearest => {
                let distance = nearest.map_or(f64::INFINITY, |point| point.distance);
                let message = format!(
                    "node {} of '{}' at ({x:.6}, {y:.6}) lies {distance:.3e} mm away from the edges of '{}'",
                    node + 1,
                    tie.tie,
                    tie.to
                );
                reader.problem(place, message);
                return Vec::new();
            }
        }
    }
    if let Some([long, short]) = finer_edge(mesh, nodes, edges) {
        let [x, y] = middle(mesh, long);
        reader.warn(format!(
            "{place}: '{}' is coarser than '{}', which it follows: an edge near ({x:.6}, {y:.6}) spans more than one \
             of its edges (element {}); the stresses there are wrong: tie the finer side to the coarser one",
            tie.tie,
            tie.to,
            short.element + 1
        ));
    }
    couplings
}

/// Finds an edge between tied nodes along which a whole edge of those that they are tied to is shorter; both of them.
fn finer_edge(mesh: &Mesh, tied: &[usize], to: &[ElementEdge]) -> Option<[ElementEdge; 2]> {
    let tolerance = RELATIVE_TOLERANCE * extent(mesh);
    let corners = |edge: ElementEdge| -> [usize; 2] { std::array::from_fn(|k| mesh.edge_nodes(edge).nodes()[k]) };
    let tied: BTreeSet<usize> = tied.iter().copied().collect();
    let following = mesh.edges().filter(|edge| !to.contains(edge) && corners(*edge).iter().all(|c| tied.contains(c)));
    following.into_iter().find_map(|long| {
        let places = |edge: ElementEdge| corners(edge).map(|corner| closest(mesh, long, mesh.nodes()[corner]));
        let lies_along = |edge: &&ElementEdge| {
            let [a, b] = places(**edge);
            let share = 0.5 * (a.coordinate - b.coordinate).abs();
            a.distance.max(b.distance) <= tolerance && share > LEAST_SHARE && share < 1.0 - LEAST_SHARE
        };
        Some([long, *to.iter().find(lies_along)?])
    })
}

/// The point half-way along an edge, mm.
fn middle(mesh: &Mesh, edge: ElementEdge) -> [f64; 2] {
    let nodes = mesh.edge_nodes(edge);
    let ends = [0, 1].map(|k| mesh.nodes()[nodes.nodes()[k]]);
    [0, 1].map(|k| 0.5 * (ends[0][k] + ends[1][k]))
}

/// A point of an edge.
#[derive(Clone, Copy)]
struct PointOnEdge {
    edge: ElementEdge,
    coordinate: f64,
    distance: f64,
}

impl PointOnEdge {
    fn coupling(&self, mesh: &Mesh, node: usize, component: usize) -> Coupling {
        let edge = mesh.edge_nodes(self.edge);
        let shapes = edge.kind().shape_functions(self.coordinate);
        let terms = edge.nodes().iter().zip(shapes).filter(|(_, shape)| *shape != 0.0);
        let terms = terms.map(|(&node, shape)| (Freedom { node, component }, shape)).collect();
        Coupling { dependent: Freedom { node, component }, terms }
    }
}

/// Newton on the foot of the perpendicular, from the chord's.
fn closest(mesh: &Mesh, edge: ElementEdge, position: [f64; 2]) -> PointOnEdge {
    const ITERATIONS: usize = 20;
    let nodes = mesh.edge_nodes(edge);
    let mut corners = [[0.0; 2]; 3];
    for (corner, &node) in corners.iter_mut().zip(nodes.nodes()) {
        *corner = mesh.nodes()[node];
    }
    let mut coordinate: f64 = 0.0;
    for _ in 0..ITERATIONS {
        let point = nodes.kind().point(&corners, coordinate);
        let [dx, dy] = [position[0] - point.position[0], position[1] - point.position[1]];
        let [tx, ty] = point.tangent;
        coordinate = (coordinate + (dx * tx + dy * ty) / (tx * tx + ty * ty)).clamp(-1.0, 1.0);
    }
    let point = nodes.kind().point(&corners, coordinate);
    let distance = (position[0] - point.position[0]).hypot(position[1] - point.position[1]);
    PointOnEdge { edge, coordinate, distance }
}

/// The diagonal of the box around all nodes, mm.
fn extent(mesh: &Mesh) -> f64 {
    let range = |k: usize| {
        let values = || mesh.nodes().iter().map(|position| position[k]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    range(0).hypot(range(1))
}

/// The node that a case means.
pub fn node(
    reader: &mut Reader<'_>,
    reference: &document::NodeReference,
    scene: KnownMesh<'_>,
    place: &Place,
) -> Option<usize> {
    match reference {
        document::NodeReference::Set(name) => {
            let nodes = scene.node_set(reader, name, place)?;
            if nodes.len() > 1 {
                reader.problem(place, format!("the node set '{name}' has {} nodes; one is needed", nodes.len()));
            }
            (nodes.len() == 1).then(|| nodes[0])
        }
        document::NodeReference::Position([x, y]) => {
            let mesh = scene.mesh?;
            let distance = |node: &usize| (mesh.nodes()[*node][0] - x).hypot(mesh.nodes()[*node][1] - y);
            let nearest = (0..mesh.nodes().len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            if distance(&nearest) > RELATIVE_TOLERANCE * extent(mesh) {
                let [near_x, near_y] = mesh.nodes()[nearest];
                let message = format!("no node is at ({x}, {y}); the nearest is at ({near_x}, {near_y})");
                reader.problem(place, message);
                return None;
            }
            if scene.loose.contains(&nearest) {
                scene.report_loose_node(reader, nearest, "", place);
            }
            Some(nearest)
        }
    }
}

//! Contact points of a slave surface: their positions, and the area and length that belong to each.

use super::chain::{ARC_LENGTH_RULE, Chain};
use super::kinematics::SlavePoint;
use super::projection::Projection;
use crate::element::{EdgeKind, LinePoint, gauss_legendre};
use crate::kinematics::PlaneModel;
use crate::mesh::{EdgeNodes, ElementEdge, Mesh};
use crate::model::{ContactPair, ModelError, Quadrature, Width};
use crate::plane::distance;
use std::collections::HashMap;
use std::ops::Range;

/// The most Gauss points of an edge or a segment.
const MOST_POINTS: usize = 10;
/// Points of the rule for a node's share ∫N dA: exact for a quadratic edge with its middle in the middle under a radius.
const NODE_SHARE_POINTS: usize = 6;
/// Projected master nodes nearer than this to an end of a slave edge, or to each other, do not split it (ξ, edge: 2).
const SHORTEST_SEGMENT: f64 = 1e-9;
/// A master node splits a slave edge if it lies within this × the edge's length of it.
const SPLIT_DISTANCE: f64 = 0.5;

/// A contact point in the reference configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactPoint {
    pub slave: SlavePoint,
    /// Tributary area, mm².
    pub area: f64,
    /// Tributary length ℓ along the slave surface, mm.
    pub length: f64,
    /// Part of ℓ that lies before the point, mm: along its edge at first, along the master once the point is placed
    /// over it.
    pub length_before: f64,
    /// Gap at the start that is measured as 0, mm: a fault of the mesh, or closed on request.
    pub start_gap: f64,
    /// Overlap that interference presses out at a drive of 1, mm.
    pub overlap: f64,
    /// Reference arc length along the slave edges in the order given, mm.
    pub coordinate: f64,
    /// Length of its slave edge, mm.
    pub edge_length: f64,
    /// Direction of its slave edge there, unit length.
    pub direction: [f64; 2],
    /// The elements of its slave edge, or of the two that meet at a node.
    pub elements: [usize; 2],
    /// Slave edge if its points share a gap, as those inside a quadratic edge do.
    pub patch: Option<usize>,
}

/// A slave edge with what its points need.
struct SlaveEdge {
    edge: EdgeNodes,
    reference: [[f64; 2]; 3],
    model: PlaneModel,
    width: Width,
    thickness: f64,
    start: f64,
    index: usize,
    element: usize,
}

impl SlaveEdge {
    fn new(mesh: &Mesh, edge: ElementEdge, width: Width, start: f64, index: usize) -> Self {
        let element = edge.element;
        let of_element = &mesh.elements()[element];
        let (model, thickness) = (mesh.parts()[of_element.part()].model, of_element.thickness());
        let edge = mesh.edge_nodes(edge);
        let reference = mesh.edge_positions(&edge, None);
        Self { edge, reference, model, width, thickness, start, index, element }
    }

    fn kind(&self) -> EdgeKind {
        self.edge.kind()
    }

    /// Length and area per unit of ξ.
    fn measure(&self, coordinate: f64) -> [f64; 2] {
        let point = self.kind().point(&self.reference, coordinate);
        let length = point.stretch();
        let width = match self.width {
            Width::Given(width) => width,
            Width::OfPart => self.model.depth(point.position[0], self.thickness),
        };
        [length, length * width]
    }

    /// Length from one ξ to another.
    fn length(&self, from: f64, to: f64) -> f64 {
        let half = 0.5 * (to - from);
        ARC_LENGTH_RULE.iter().map(|p| half * p.weight * self.measure(from + half * (p.coordinate + 1.0))[0]).sum()
    }

    fn direction(&self, coordinate: f64) -> [f64; 2] {
        let point = self.kind().point(&self.reference, coordinate);
        point.tangent.map(|t| t / point.stretch())
    }

    /// Gauss points between two ξ. Their shares of the length lie side by side in the order of the points.
    fn add_gauss(&self, rule: &[LinePoint], from: f64, to: f64, points: &mut Vec<ContactPoint>) {
        let half = 0.5 * (to - from);
        let patch = (self.kind() == EdgeKind::Quadratic).then_some(self.index);
        let edge_length = self.length(-1.0, 1.0);
        let mut share_start = self.length(-1.0, from);
        for LinePoint { coordinate, weight } in rule {
            let at = from + half * (coordinate + 1.0);
            let [length, area] = self.measure(at).map(|measure| measure * half * weight);
            let along = self.length(-1.0, at);
            let count = self.kind().node_count();
            let mut nodes = [0; 3];
            nodes[..count].copy_from_slice(self.edge.nodes());
            points.push(ContactPoint {
                slave: SlavePoint { nodes, values: self.kind().shape_functions(at), count },
                area,
                length,
                length_before: (along - share_start).clamp(0.0, length),
                start_gap: 0.0,
                overlap: 0.0,
                coordinate: self.start + along,
                edge_length,
                direction: self.direction(at),
                elements: [self.element; 2],
                patch,
            });
            share_start += length;
        }
    }
}

/// The contact points of a pair on some edges.
///
/// # Errors
/// No edges, or a number of points that is not possible.
pub(super) fn contact_points(
    mesh: &Mesh,
    pair: &ContactPair,
    slave: &[ElementEdge],
    master: &Chain,
) -> Result<Vec<ContactPoint>, ModelError> {
    let unusable = |reason: String| Err(ModelError::of_pair(&pair.name, reason));
    if slave.is_empty() {
        return unusable("the slave surface has no edges".to_owned());
    }
    if let Quadrature::Gauss(points) | Quadrature::Segments(points) = pair.quadrature
        && !(1..=MOST_POINTS).contains(&points)
    {
        return unusable(format!("{points} points per edge, from 1 to {MOST_POINTS} are possible"));
    }
    let mut edges = Vec::with_capacity(slave.len());
    let mut start = 0.0;
    for (index, &edge) in slave.iter().enumerate() {
        let edge = SlaveEdge::new(mesh, edge, pair.width, start, index);
        start += edge.length(-1.0, 1.0);
        edges.push(edge);
    }
    let mut points = Vec::new();
    match pair.quadrature {
        Quadrature::Gauss(count) => {
            let rule = gauss_legendre(count);
            edges.iter().for_each(|edge| edge.add_gauss(&rule, -1.0, 1.0, &mut points));
        }
        Quadrature::Segments(count) => {
            let rule = gauss_legendre(count);
            for edge in &edges {
                let bounds = segment_bounds(mesh, edge, master);
                bounds.windows(2).for_each(|ends| edge.add_gauss(&rule, ends[0], ends[1], &mut points));
            }
        }
        Quadrature::Nodes => points = node_points(&edges),
    }
    // A corner of a quadratic edge on the axis has none.
    points.retain(|point| point.area > 0.0);
    Ok(points)
}

/// Returns the ranges of points that share a gap, in order: those of a patch; any other point is on its own.
pub(super) fn patches(points: &[ContactPoint]) -> Vec<Range<usize>> {
    let mut patches: Vec<Range<usize>> = Vec::new();
    for (index, point) in points.iter().enumerate() {
        match patches.last_mut() {
            Some(last) if point.patch.is_some() && points[last.start].patch == point.patch => last.end = index + 1,
            _ => patches.push(index..index + 1),
        }
    }
    patches
}

/// −1, the feet of the master's corner nodes on a slave edge, 1: between them everything is smooth.
fn segment_bounds(mesh: &Mesh, edge: &SlaveEdge, master: &Chain) -> Vec<f64> {
    let mut bounds = vec![-1.0, 1.0];
    let reach = SPLIT_DISTANCE * edge.length(-1.0, 1.0);
    let slave = Chain::of_edge(&edge.edge, &edge.reference);
    let projection = Projection { chain: &slave, position: |node: usize| mesh.nodes()[node] };
    for index in 0..master.len() as i64 {
        for &node in &master.nodes(index)[..2] {
            let point = mesh.nodes()[node];
            // most of the master is far from an edge of the slave
            if projection.clearance(point, 0) > reach {
                continue;
            }
            let Some(foot) = projection.anywhere(point) else { continue };
            let on = edge.kind().point(&edge.reference, foot.coordinate).position;
            if distance(point, on) <= reach {
                bounds.push(foot.coordinate);
            }
        }
    }
    bounds.retain(|bound| (-1.0..=1.0).contains(bound));
    bounds.sort_by(f64::total_cmp);
    bounds.dedup_by(|next, kept| *next - *kept < SHORTEST_SEGMENT);
    // The last bound is the edge's end, even where a foot just before it was kept instead.
    *bounds.last_mut().expect("−1 at least") = 1.0;
    bounds
}

/// The slave nodes with ∫N dA.
fn node_points(edges: &[SlaveEdge]) -> Vec<ContactPoint> {
    let rule = gauss_legendre(NODE_SHARE_POINTS);
    let mut points: Vec<ContactPoint> = Vec::new();
    let mut place = HashMap::new();
    for edge in edges {
        let edge_length = edge.length(-1.0, 1.0);
        for (local, &node) in edge.edge.nodes().iter().enumerate() {
            let at = [-1.0, 1.0, 0.0][local];
            let index = *place.entry(node).or_insert_with(|| {
                points.push(ContactPoint {
                    slave: SlavePoint { nodes: [node; 3], values: [1.0, 0.0, 0.0], count: 1 },
                    area: 0.0,
                    length: 0.0,
                    length_before: 0.0,
                    start_gap: 0.0,
                    overlap: 0.0,
                    coordinate: edge.start + edge.length(-1.0, at),
                    edge_length,
                    direction: edge.direction(at),
                    elements: [edge.element; 2],
                    patch: None,
                });
                points.len() - 1
            });
            let (mut length, mut area) = (0.0, 0.0);
            for point in &rule {
                let value = edge.kind().shape_functions(point.coordinate)[local] * point.weight;
                let measure = edge.measure(point.coordinate);
                length += value * measure[0];
                area += value * measure[1];
            }
            points[index].elements[1] = edge.element;
            points[index].length += length;
            points[index].area += area;
            // All of it lies before an end, half of it before a middle.
            points[index].length_before += [0.0, length, 0.5 * length][local];
        }
    }
    points
}

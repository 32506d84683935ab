//! Position of a specimen's fibre, which pictures follow and zoom to.

use fe_core::mesh::{ElementEdge, Mesh};
use fe_core::model::Model;

/// The node set of a fibre's axis in the specimens that have one.
const AXIS: &str = "fibre_axis";

/// A fibre that is measured at its exit and at its tail.
#[derive(Clone, Debug, PartialEq)]
pub struct FibreGeometry {
    /// Index of its part.
    pub part: usize,
    /// Polyline from the tail over the exit to the grip, reference positions, mm.
    pub axis: Vec<[f64; 2]>,
    /// Node where it leaves the matrix.
    pub exit_node: usize,
    /// Distance of the hole's wall from the exit node, mm.
    pub radius: f64,
}

impl FibreGeometry {
    /// `None` for models without a fibre in a hole.
    pub fn of(model: &Model) -> Option<Self> {
        let first = model.measured.fibres.first();
        let of_first = first.map(|fibre| (fibre.tail_node, fibre.exit_node));
        let (tail, exit_node) = model.measured.tail_node.zip(model.measured.exit_node).or(of_first)?;
        let mesh = &model.mesh;
        let part = mesh.elements().iter().find(|element| element.nodes().contains(&tail))?.part();
        let exit = mesh.nodes()[exit_node];
        let wall = model.contacts.iter().flat_map(|pair| &pair.slave);
        let wall = wall.flat_map(|&edge| mesh.edge_nodes(edge).nodes().to_vec());
        let distances = wall.map(|node| distance(mesh.nodes()[node], exit));
        let radius = distances.min_by(f64::total_cmp).filter(|radius| *radius > 0.0)?;
        let mut axis = vec![mesh.nodes()[tail], exit];
        axis.extend(grip(model).filter(|&grip| distance(grip, exit) > radius));
        let mut fibre = Self { part, axis, exit_node, radius };
        let named = first.map(|fibre| format!("fibre.{}.axis", fibre.name));
        if let Some(nodes) = mesh.node_set(named.as_deref().unwrap_or(AXIS)) {
            // a bend is no kink
            let mut axis: Vec<[f64; 2]> = nodes.iter().map(|&node| mesh.nodes()[node]).collect();
            axis.sort_by(|&a, &b| fibre.arc(a).total_cmp(&fibre.arc(b)));
            fibre.axis = axis;
        }
        Some(fibre)
    }

    /// The distance along the axis from the tail, mm, of the place of the axis nearest to a position.
    fn arc(&self, [x, y]: [f64; 2]) -> f64 {
        let (mut nearest, mut start) = ((f64::INFINITY, 0.0), 0.0);
        for ends in self.axis.windows(2) {
            let [[a_x, a_y], [b_x, b_y]] = [ends[0], ends[1]];
            let length = distance(ends[0], ends[1]);
            let along = ((x - a_x) * (b_x - a_x) + (y - a_y) * (b_y - a_y)) / length;
            let within = along.clamp(0.0, length);
            let share = within / length;
            let away = distance([x, y], [a_x + share * (b_x - a_x), a_y + share * (b_y - a_y)]);
            if away < nearest.0 {
                nearest = (away, start + within);
            }
            start += length;
        }
        nearest.1
    }
}

/// Position of a wall of the hole along the fibre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Distance from the tail along the fibre, both in the reference configuration, where the wall's arc length is 0, mm.
    pub start: f64,
    /// 1 if it runs from the tail to the exit, −1 if it runs back. Shear that resists the pull has this sign.
    pub direction: f64,
}

impl Wall {
    /// Finds the wall of a fibre on the slave surface of a contact pair.
    pub fn of(fibre: &FibreGeometry, mesh: &Mesh, slave: &[ElementEdge]) -> Option<Self> {
        let end = |edge: &ElementEdge, k: usize| fibre.arc(mesh.nodes()[mesh.edge_nodes(*edge).nodes()[k]]);
        let (start, end) = (end(slave.first()?, 0), end(slave.last()?, 1));
        Some(Self { start, direction: if end >= start { 1.0 } else { -1.0 } })
    }

    /// Distance from the tail along the fibre, mm.
    pub fn along_fibre(&self, arc: f64) -> f64 {
        self.start + self.direction * arc
    }
}

/// The middle of what is gripped.
fn grip(model: &Model) -> Option<[f64; 2]> {
    let nodes = &model.supports.get(*model.measured.supports.first()?)?.nodes;
    let sum = |k: usize| nodes.iter().map(|&node| model.mesh.nodes()[node][k]).sum::<f64>();
    Some([sum(0), sum(1)].map(|sum| sum / nodes.len() as f64))
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod test;

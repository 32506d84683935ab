//! Where the fibre of a specimen is: what pictures follow and zoom to.

use fe_core::model::Model;

/// A fibre that is measured at its exit and at its tail.
#[derive(Clone, Debug, PartialEq)]
pub struct Fibre {
    /// Index of its part.
    pub part: usize,
    /// Polyline from the tail over the exit to the grip, reference positions, mm.
    pub axis: Vec<[f64; 2]>,
    /// Its node where it leaves the matrix.
    pub exit_node: usize,
    /// Distance of the hole's wall from the exit node, mm.
    pub radius: f64,
}

impl Fibre {
    /// `None` for models without a fibre in a hole.
    pub fn of(model: &Model) -> Option<Self> {
        let (tail, exit_node) = model.measured.tail_node.zip(model.measured.exit_node)?;
        let mesh = &model.mesh;
        let part = mesh.elements().iter().find(|element| element.nodes().contains(&tail))?.part();
        let exit = mesh.nodes()[exit_node];
        let wall = model.contacts.iter().flat_map(|pair| &pair.slave);
        let wall = wall.flat_map(|&edge| mesh.edge_nodes(edge).nodes().to_vec());
        let distances = wall.map(|node| distance(mesh.nodes()[node], exit));
        let radius = distances.min_by(f64::total_cmp).filter(|radius| *radius > 0.0)?;
        let mut axis = vec![mesh.nodes()[tail], exit];
        axis.extend(grip(model, exit));
        Some(Self { part, axis, exit_node, radius })
    }
}

/// The point of the line along the pull direction that is level with the grip; `None` if that is the exit.
fn grip(model: &Model, exit: [f64; 2]) -> Option<[f64; 2]> {
    let nodes = &model.supports.get(model.measured.support?)?.nodes;
    let [d_x, d_y] = model.measured.direction;
    let along = |&node: &usize| {
        let [x, y] = model.mesh.nodes()[node];
        (x - exit[0]) * d_x + (y - exit[1]) * d_y
    };
    let mean = nodes.iter().map(along).sum::<f64>() / nodes.len() as f64;
    (mean > 0.0).then(|| [exit[0] + mean * d_x, exit[1] + mean * d_y])
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

//! Rigid motions that the constraints leave to a body.

use super::Body;
use crate::kinematics::PlaneModel;
use crate::mesh::Mesh;
use crate::plane::dot;

/// A motion counts as free if the constraints resist less than this of it.
const TOLERANCE: f64 = 1e-6;

/// A rigid motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RigidMode {
    /// Along a unit vector.
    Translation {
        /// The direction; its larger component is positive.
        direction: [f64; 2],
    },
    /// About a point.
    Rotation {
        /// The point, mm. If translations are free too, it is one of many.
        centre: [f64; 2],
    },
}

impl std::fmt::Display for RigidMode {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // No "-0.000" in messages.
        let rounded = |x: f64| (1e3 * x).round() / 1e3 + 0.0;
        match self {
            Self::Translation { direction } => match direction.map(rounded) {
                [1.0, 0.0] => formatter.write_str("can move along x"),
                [0.0, 1.0] => formatter.write_str("can move along y"),
                [x, y] => write!(formatter, "can move along ({x}, {y})"),
            },
            Self::Rotation { centre } => {
                let [x, y] = centre.map(rounded);
                write!(formatter, "can rotate about ({x}, {y})")
            }
        }
    }
}

/// The rigid motions of a body that constraints of nodes along directions (of any length > 0) leave free: translations
/// first. Constraints of nodes that the body does not have are ignored.
///
/// A plane body has three, u = t + ω × (x − c): t₁, t₂ and, made a length by the body's size L, ωL. A constraint of a
/// node along the unit vector d forbids d·u, so it is the row
///
/// ```text
/// [ d₁   d₂   ((x₁ − c₁) d₂ − (x₂ − c₂) d₁)/L ]
/// ```
///
/// and what remains is the null space of all rows. A body of revolution has one, along its axis.
pub fn rigid_body_freedom(mesh: &Mesh, body: &Body, constraints: &[(usize, [f64; 2])]) -> Vec<RigidMode> {
    let constraints: Vec<(usize, [f64; 2])> = constraints
        .iter()
        .filter(|(node, _)| body.nodes.binary_search(node).is_ok())
        .filter_map(|&(node, [x, y])| {
            let length = x.hypot(y);
            (length > 0.0).then(|| (node, [x / length, y / length]))
        })
        .collect();
    let element = &mesh.elements()[body.elements[0]];
    if mesh.parts()[element.part()].model == PlaneModel::Axisymmetric {
        let held = constraints.iter().any(|(_, direction)| direction[1].abs() > TOLERANCE);
        return if held { vec![] } else { vec![RigidMode::Translation { direction: [0.0, 1.0] }] };
    }
    plane_modes(mesh, body, &constraints)
}

fn plane_modes(mesh: &Mesh, body: &Body, constraints: &[(usize, [f64; 2])]) -> Vec<RigidMode> {
    let (centre, size) = centre_and_size(mesh, body);
    let rows: Vec<[f64; 3]> = constraints
        .iter()
        .map(|&(node, d)| {
            let x = mesh.nodes()[node];
            [d[0], d[1], ((x[0] - centre[0]) * d[1] - (x[1] - centre[1]) * d[0]) / size]
        })
        .collect();
    let resisted = orthonormal_basis(&[], &rows);
    // The rotation is what is free of a unit rotation; what is free and orthogonal to it has no rotation.
    let rotation = orthonormal_basis(&resisted, &[[0.0, 0.0, 1.0]]);
    let known = [&resisted[..], &rotation[..]].concat();
    let mut modes: Vec<RigidMode> = orthonormal_basis(&known, &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        .into_iter()
        .map(|[x, y, _]| {
            let sign = if x.abs() >= y.abs() { x.signum() } else { y.signum() };
            RigidMode::Translation { direction: [sign * x, sign * y] }
        })
        .collect();
    modes.extend(rotation.into_iter().map(|[x, y, turn]| RigidMode::Rotation {
        centre: [centre[0] - y * size / turn, centre[1] + x * size / turn],
    }));
    modes
}

/// The mean of the nodes and the largest distance from it.
fn centre_and_size(mesh: &Mesh, body: &Body) -> ([f64; 2], f64) {
    let positions = || body.nodes.iter().map(|&node| mesh.nodes()[node]);
    let count = body.nodes.len() as f64;
    let centre = positions().fold([0.0; 2], |sum, x| [sum[0] + x[0] / count, sum[1] + x[1] / count]);
    let size = positions().map(|x| (x[0] - centre[0]).hypot(x[1] - centre[1])).fold(0.0, f64::max);
    (centre, size)
}

/// An orthonormal basis of what `vectors` add to the orthonormal `known`: Gram–Schmidt that always takes the vector
/// with the largest remainder, so that the order of nearly parallel ones does not matter.
fn orthonormal_basis(known: &[[f64; 3]], vectors: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let remove = |vector: &mut [f64; 3], unit: &[f64; 3]| {
        // Twice: the second pass takes what rounding left.
        for _ in 0..2 {
            let along = dot(*vector, *unit);
            vector.iter_mut().zip(unit).for_each(|(entry, unit)| *entry -= along * unit);
        }
    };
    let mut remainders = vectors.to_vec();
    for unit in known {
        remainders.iter_mut().for_each(|vector| remove(vector, unit));
    }
    let mut basis: Vec<[f64; 3]> = Vec::new();
    while known.len() + basis.len() < 3 {
        // Backwards, so that of equal ones the first is taken: x before y.
        let longest = remainders.iter().rev().copied().max_by(|a, b| dot(*a, *a).total_cmp(&dot(*b, *b)));
        let Some(largest) = longest else { break };
        let length = dot(largest, largest).sqrt();
        if length <= TOLERANCE {
            break;
        }
        let unit = largest.map(|entry| entry / length);
        remainders.iter_mut().for_each(|vector| remove(vector, &unit));
        basis.push(unit);
    }
    basis
}

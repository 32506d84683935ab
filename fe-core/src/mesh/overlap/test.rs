use super::*;
use crate::element::ElementKind::{self, *};
use crate::kinematics::PlaneModel::PlaneStrain;
use crate::mesh::specimen::{PerpendicularFibre, TwoBlocks, perpendicular_fibre, two_blocks};
use crate::mesh::{ElementDefinition, MeshDefinition, Part};

/// Two blocks 1 mm high and wide upon each other.
fn blocks(kind: ElementKind) -> Mesh {
    let parameters = TwoBlocks { width: 1.0, heights: [1.0; 2], edges: [4, 3], rows: [2; 2], element: kind };
    Mesh::new(two_blocks(&parameters).unwrap()).unwrap()
}

fn moved(mesh: &Mesh, by: impl Fn(usize, [f64; 2]) -> [f64; 2]) -> Vec<f64> {
    let mut displacements = vec![0.0; 2 * mesh.nodes().len()];
    for element in mesh.elements() {
        for &node in element.nodes() {
            let moved = by(element.part(), mesh.nodes()[node]);
            displacements[2 * node..2 * node + 2].copy_from_slice(&moved);
        }
    }
    displacements
}

#[test]
fn blocks_overlap_by_what_they_are_pushed() {
    for kind in ElementKind::ALL {
        let mesh = blocks(kind);
        for (by, depth) in [([0.0, 0.25], None), ([0.0, 0.0], None), ([0.3, -0.05], Some(0.05))] {
            let displacements = moved(&mesh, |part, _| if part == 1 { by } else { [0.0; 2] });
            let found = mesh.overlap(&displacements, |_| false);
            match depth {
                None => assert_eq!(found, None, "{kind} by {by:?}"),
                Some(depth) => {
                    let found = found.expect("an overlap");
                    assert!((found.depth - depth).abs() < 1e-14, "{kind}: {found:?}");
                    assert_eq!(found.part + found.inside, 1, "of the one in the other");
                }
            }
            assert_eq!(
                mesh.overlap(&displacements, |element| mesh.elements()[element].part() == 0),
                None,
                "{kind}: elements that are left out do not count"
            );
        }
    }
}

#[test]
fn a_corner_lies_as_deep_as_its_nearest_face() {
    let mesh = blocks(Q4);
    // the upper block's corner (0, 0) comes to (0.9, −0.25): 0.1 from the lower block's side
    let found = mesh.overlap(&moved(&mesh, |part, _| if part == 1 { [0.9, -0.25] } else { [0.0; 2] }), |_| false);
    let found = found.expect("an overlap");
    assert!((found.depth - 0.1).abs() < 1e-14, "{found:?}");
}

/// Upper edges on a parabola y = −c (2x − 1)² below a flat face.
#[test]
fn curved_edges_are_curved() {
    let quadratic =
        [[0.0, -1.0], [1.0, -1.0], [1.0, 0.0], [0.0, 0.0], [0.5, -1.0], [1.0, -0.5], [0.5, 0.2], [0.0, -0.5]];
    let upper = [[-1.0, 0.1], [2.0, 0.1], [2.0, 1.0], [-1.0, 1.0]];
    let mesh = Mesh::new(MeshDefinition {
        nodes: quadratic.into_iter().chain(upper).collect(),
        parts: vec![Part::new("bulge", PlaneStrain, 1.0), Part::new("plate", PlaneStrain, 1.0)],
        elements: vec![
            ElementDefinition { kind: Q8, part: 0, nodes: (0..8).collect() },
            ElementDefinition { kind: Q4, part: 1, nodes: (8..12).collect() },
        ],
        ..MeshDefinition::default()
    })
    .unwrap();
    let at = |lift: f64| mesh.overlap(&moved(&mesh, |part, _| [0.0, if part == 1 { lift } else { 0.0 }]), |_| false);
    let found = at(0.0).expect("an overlap");
    assert!((found.depth - 0.1).abs() < 1e-14, "{found:?}");
    assert_eq!((found.position[0], found.part + found.inside), (0.5, 1), "{found:?}");
    assert_eq!(at(0.1 + 1e-6), None, "above the top of the bulge");
    // a point below the bulge, above the chord: y = 0.2 (1 − (2x − 1)²) at x = 0.25 is 0.15
    let outline = &mesh.outlines(&moved(&mesh, |_, _| [0.0; 2]), |_| false)[0];
    assert!(outline.has([0.25, 0.1499]) && !outline.has([0.25, 0.1501]));
    let distance = outline.edges.iter().map(|edge| edge.distance([0.5, 0.3])).fold(f64::INFINITY, f64::min);
    assert!((distance - 0.1).abs() < 1e-14, "{distance}");
}

/// A ring of 1 mm cells around a slot, open on its right: its lips are pushed through each other.
#[test]
fn a_body_that_folds_on_itself_is_found() {
    let mut nodes = Vec::new();
    for y in 0..4 {
        nodes.extend((0..6).map(|x| [f64::from(x), f64::from(y)]));
    }
    let cell = |x: usize, y: usize| [6 * y + x, 6 * y + x + 1, 6 * y + x + 7, 6 * y + x + 6].to_vec();
    let cells = (0..5).flat_map(|x| [(x, 0), (x, 2)]).chain([(0, 1)]);
    let elements = cells.map(|(x, y)| ElementDefinition { kind: Q4, part: 0, nodes: cell(x, y) }).collect();
    let parts = vec![Part::new("clamp", PlaneStrain, 1.0)];
    let mesh = Mesh::new(MeshDefinition { nodes, parts, elements, ..MeshDefinition::default() }).unwrap();
    // the upper arm leans down by 0.3 mm per mm from x = 1 on, the lower one stays
    let lean = |by: f64| moved(&mesh, move |_, [x, y]| [0.0, if y >= 2.0 { -by * (x - 1.0).max(0.0) } else { 0.0 }]);
    assert_eq!(mesh.overlap(&lean(0.0), |_| false), None);
    assert_eq!(mesh.overlap(&lean(0.2), |_| false), None);
    let found = mesh.overlap(&lean(0.3), |_| false).expect("an overlap");
    // of the lower lip just before its corner (5, 1) below the leaning face
    let below = 0.3 * (5.0 - 0.5 * BEFORE_CORNER - 1.0) - 1.0;
    assert!((found.depth - below / 1.09_f64.sqrt()).abs() < 1e-12, "{found:?}");
    assert_eq!((found.part, found.inside), (0, 0));
}

#[test]
fn a_fibre_pushed_through_the_bottom_of_its_hole_is_found() {
    let made = perpendicular_fibre(&PerpendicularFibre::default()).unwrap();
    let mesh = Mesh::new(made.definition).unwrap();
    let fibre = mesh.parts().iter().position(|part| part.name == "fibre").unwrap();
    let push = |by: f64| moved(&mesh, move |part, _| [0.0, if part == fibre { -by } else { 0.0 }]);
    assert_eq!(mesh.overlap(&push(-0.5), |_| false), None);
    let found = mesh.overlap(&push(0.2), |_| false).expect("an overlap");
    let gap = PerpendicularFibre::default().tail_gap;
    assert!((found.depth - (0.2 - gap)).abs() < 1e-12, "{found:?} with a gap of {gap}");
}

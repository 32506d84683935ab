use super::*;
use crate::element::ElementKind::{self, *};
use crate::kinematics::PlaneModel;
use crate::mesh::structured::{MeshBlock, Side};
use crate::mesh::{ElementDefinition, MeshDefinition, Part};

fn part(name: &str) -> Part {
    Part::new(name, PlaneModel::PlaneStrain, 1.0)
}

/// Two columns of cells upon x = 1, `left` and `right` rows high, of two parts or of one; joined where nodes coincide.
fn columns(kind: ElementKind, rows: [usize; 2], parts: usize, glued: bool) -> Mesh {
    let mut mesh = MeshDefinition::default();
    for name in &["left", "right"][..parts] {
        mesh.add_part(part(name));
    }
    let eta = rows.map(|rows| (0..=rows).map(|row| row as f64 / rows as f64).collect::<Vec<_>>());
    let left = mesh.block(&MeshBlock::new(0, kind, &[0.0, 1.0], &eta[0])).unwrap();
    let others = if glued { left.side_nodes(Side::Right) } else { vec![] };
    mesh.glued_block(&MeshBlock::new(parts - 1, kind, &[1.0, 2.0], &eta[1]), &others).unwrap();
    Mesh::new(mesh).unwrap()
}

#[test]
fn sound_meshes_have_no_findings() {
    for kind in ElementKind::ALL {
        assert_eq!(findings(&columns(kind, [3, 3], 1, true), &[]), []);
        assert_eq!(findings(&columns(kind, [3, 3], 2, true), &[]), []);
        // Surfaces in contact may have any nodes.
        assert_eq!(findings(&columns(kind, [3, 4], 2, false), &[]), []);
    }
}

#[test]
fn hanging_nodes_are_named_with_their_edge() {
    // Nodes of the right column at y = 1/3, 2/3 (and middles) on the only edge of the left one.
    for (kind, count) in [(T3, 2), (Q4, 2), (T6, 4), (Q8, 4)] {
        let mesh = columns(kind, [1, 3], 1, true);
        let hanging = findings(&mesh, &[]);
        assert_eq!(hanging.iter().filter(|f| matches!(f, Finding::HangingNode { .. })).count(), count, "{kind}");
        for finding in &hanging {
            assert!(finding.is_fault());
            if let Finding::HangingNode { node, position, element, edge } = *finding {
                assert_eq!((position[0], element, edge), (1.0, 0, 1));
                assert_eq!(mesh.nodes()[node], position);
            }
        }
        let nodes: Vec<usize> = (0..mesh.nodes().len()).collect();
        assert!(findings(&mesh, &nodes).iter().all(|f| !matches!(f, Finding::HangingNode { .. })), "tied");
    }
    let message = findings(&columns(Q4, [1, 3], 1, true), &[])[0].to_string();
    assert!(message.starts_with("node 7 at (1, 0.3333333333333333) hangs on edge 2 of element 1, which"), "{message}");
}

#[test]
fn nodes_on_curved_edges_are_found() {
    // A Q8 whose right edge bulges to x = 1.2 at its middle, x = 1 + 0.2 (1 − η²); another part's T3 touches it inside.
    let on_edge = [1.0 + 0.2 * (1.0 - 0.36), 0.8];
    let mut definition = MeshDefinition {
        nodes: vec![
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [0.5, 0.0],
            [1.2, 0.5],
            [0.5, 1.0],
            [0.0, 0.5],
            on_edge,
            [2.0, 0.5],
            [2.0, 1.0],
        ],
        parts: vec![part("body")],
        elements: vec![
            ElementDefinition { kind: Q8, part: 0, nodes: (0..8).collect() },
            ElementDefinition { kind: T3, part: 0, nodes: vec![8, 9, 10] },
        ],
        ..MeshDefinition::default()
    };
    let hanging = |definition: &MeshDefinition| findings(&Mesh::new(definition.clone()).unwrap(), &[]);
    assert_eq!(hanging(&definition)[0], Finding::HangingNode { node: 8, position: on_edge, element: 0, edge: 1 });
    definition.nodes[8][0] += 1e-3;
    assert!(matches!(hanging(&definition)[..], [Finding::Pieces { .. }]));
}

/// A fibre of two columns of Q4, −¼ ≤ x ≤ ¼, that is glued to the block in the middle of its lower end, passes in front of a
/// cover, −½ ≤ x ≤ ½, on the same block. The cover ends at y = 1, where the fibre has nodes.
#[test]
fn nodes_of_what_passes_in_front_do_not_hang() {
    let mut mesh = MeshDefinition::default();
    for name in ["block", "cover", "fibre"] {
        mesh.add_part(part(name));
    }
    let below = mesh.block(&MeshBlock::new(0, Q4, &[-0.5, 0.0, 0.5], &[-1.0, 0.0])).unwrap().side_nodes(Side::Top);
    mesh.glued_block(&MeshBlock::new(1, Q4, &[-0.5, 0.5], &[0.0, 1.0]), &below).unwrap();
    mesh.glued_block(&MeshBlock::new(2, Q4, &[-0.25, 0.0, 0.25], &[0.0, 1.0, 2.0]), &below).unwrap();
    let found = findings(&Mesh::new(mesh).unwrap(), &[]);
    let hanging: Vec<[f64; 2]> = found
        .iter()
        .filter_map(|finding| match finding {
            Finding::HangingNode { position, .. } => Some(*position),
            _ => None,
        })
        .collect();
    // not the three nodes of the fibre at y = 1; but the cover does not have the block's node in the middle of its end
    assert!(hanging.iter().all(|position| position[1] == 0.0), "{found:?}");
    assert!(hanging.contains(&[0.0, 0.0]), "{found:?}");
}

#[test]
fn quadratic_edges_must_meet_edges() {
    // The right column's node at y = ½ is the middle of the left one's edge.
    for kind in [T6, Q8] {
        let mesh = columns(kind, [1, 2], 1, true);
        let junctions: Vec<_> =
            findings(&mesh, &[]).into_iter().filter(|f| matches!(f, Finding::TJunction { .. })).collect();
        assert!(junctions.len() >= 2, "{kind}: two cells meet in the middle");
        assert!(junctions.iter().all(|f| matches!(f, Finding::TJunction { position: [1.0, 0.5], element: 0, .. })));
        assert!(
            junctions[0].to_string().contains("at (1, 0.5) is the middle of edge 2 of element 1 and a node of element")
        );
    }
}

#[test]
fn pieces_of_a_part_are_reported() {
    let mesh = columns(Q8, [2, 2], 1, false);
    let found = findings(&mesh, &[]);
    assert_eq!(found, [Finding::Pieces { part: "left".into(), first_elements: vec![0, 2] }]);
    assert!(!found[0].is_fault());
    assert_eq!(
        found[0].to_string(),
        "part 'left' is in 2 pieces that share no node, the first ones with the elements 1 and 3; fine if they are several bodies, else merge their nodes"
    );
}

#[test]
fn bodies_are_elements_that_share_nodes() {
    let mesh = columns(Q4, [2, 3], 2, false);
    let found = bodies(&mesh);
    assert_eq!(found.iter().map(|body| &*body.elements).collect::<Vec<_>>(), [&[0, 1][..], &[2, 3, 4]]);
    assert_eq!(
        found.iter().map(|body| body.nodes.clone()).collect::<Vec<_>>(),
        [(0..6).collect::<Vec<_>>(), (6..14).collect()]
    );
    let joined = bodies(&columns(Q4, [2, 2], 2, true));
    assert_eq!(joined.len(), 1);
    assert_eq!(joined[0].nodes, (0..9).collect::<Vec<_>>());
}

/// Returns messages about what is free in the square [0, 1]² of one Q4; nodes counter-clockwise from the origin.
fn freedom(model: PlaneModel, constraints: &[(usize, [f64; 2])]) -> Vec<String> {
    let mesh = Mesh::new(MeshDefinition {
        nodes: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        parts: vec![Part::new("body", model, 1.0)],
        elements: vec![ElementDefinition { kind: Q4, part: 0, nodes: vec![0, 1, 2, 3] }],
        ..MeshDefinition::default()
    })
    .unwrap();
    rigid_body_freedom(&mesh, &bodies(&mesh)[0], constraints).iter().map(ToString::to_string).collect()
}

#[test]
fn unsupported_motions_are_reported() {
    let (x, y) = ([1.0, 0.0], [0.0, 1.0]);
    let plane = |constraints: &[(usize, [f64; 2])]| freedom(PlaneModel::PlaneStress, constraints);
    let none: [&str; 0] = [];
    assert_eq!(plane(&[]), ["can move along x", "can move along y", "can rotate about (0.5, 0.5)"]);
    assert_eq!(plane(&[(0, x), (3, x)]), ["can move along y"]);
    assert_eq!(plane(&[(0, y), (1, [0.0, -3.0])]), ["can move along x"]);
    assert_eq!(plane(&[(0, x), (0, y)]), ["can rotate about (0, 0)"]);
    // A roller on each of two lines: it turns about where their normals meet.
    assert_eq!(plane(&[(1, x), (3, y)]), ["can rotate about (0, 0)"]);
    assert_eq!(plane(&[(0, [1.0, -1.0]), (2, [2.0, -2.0]), (3, [1.0, -1.0])]), ["can move along (0.707, 0.707)"]);
    assert_eq!(plane(&[(0, x), (0, y), (1, y)]), none);
    // Other bodies' nodes and directions of no length hold nothing.
    assert_eq!(plane(&[(0, x), (0, y), (9, y), (1, [0.0, 0.0])]), ["can rotate about (0, 0)"]);
}

#[test]
fn a_body_of_revolution_can_only_move_along_its_axis() {
    let axial: &[&str] = &["can move along y"];
    assert_eq!(freedom(PlaneModel::Axisymmetric, &[]), axial);
    assert_eq!(freedom(PlaneModel::Axisymmetric, &[(0, [1.0, 0.0]), (3, [1.0, 0.0])]), axial);
    assert_eq!(freedom(PlaneModel::Axisymmetric, &[(2, [0.6, 0.8])]), [""; 0]);
}

/// Motions that are reported as free are free, and as many as the rank of the constraints leaves.
#[test]
fn free_motions_obey_the_constraints() {
    let mesh = columns(Q8, [2, 2], 2, true);
    let body = &bodies(&mesh)[0];
    let mut numbers = end_to_end_tests::Random::new(7);
    let mut random = move || numbers.unit();
    for _ in 0..200 {
        let count = (4.0 * random()) as usize;
        let constraints: Vec<(usize, [f64; 2])> = (0..count)
            .map(|_| {
                let angle = 6.0 * random();
                ((random() * mesh.nodes().len() as f64) as usize, [angle.cos(), angle.sin()])
            })
            .collect();
        let modes = rigid_body_freedom(&mesh, body, &constraints);
        // directions at random are independent, but a node has two at most
        let of_node = |node: usize| constraints.iter().filter(|(of, _)| *of == node).count().min(2);
        let held: usize = (0..mesh.nodes().len()).map(of_node).sum();
        assert_eq!(modes.len(), 3 - held.min(3));
        for mode in modes {
            for &(node, d) in &constraints {
                let x = mesh.nodes()[node];
                let (velocity, scale) = match mode {
                    RigidMode::Translation { direction } => (direction, 1.0),
                    RigidMode::Rotation { centre: c } => ([c[1] - x[1], x[0] - c[0]], 1.0 + c[0].hypot(c[1])),
                };
                assert!((velocity[0] * d[0] + velocity[1] * d[1]).abs() < 1e-8 * scale);
            }
        }
    }
}

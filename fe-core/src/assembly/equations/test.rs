use super::*;
use crate::element::ElementKind;
use crate::kinematics::PlaneModel;
use crate::mesh::{ElementDefinition, Mesh, MeshDefinition, Part};
use crate::model::{Controls, Measured, Model, Skipping};
use approx::assert_abs_diff_eq;

/// A unit square of one Q4 with an extra node, two drives and these constraints.
fn model(supports: Vec<Support>, couplings: Vec<Coupling>) -> Model {
    let mesh = Mesh::new(MeshDefinition {
        nodes: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [5.0, 5.0]],
        parts: vec![Part::new("block", PlaneModel::PlaneStrain, 1.0)],
        elements: vec![ElementDefinition { kind: ElementKind::Q4, part: 0, nodes: vec![0, 1, 2, 3] }],
        ..MeshDefinition::default()
    })
    .unwrap();
    Model {
        fields: crate::model::Fields::default(),
        mesh,
        laws: Vec::new(),
        average_dilatation: vec![false],
        contacts: Vec::new(),
        drives: vec!["pull".into(), "push".into()],
        supports,
        couplings,
        loads: Vec::new(),
        nlgeom: vec![false],
        measured: Measured::default(),
        steps: Vec::new(),
        controls: Controls::default(),
        initial_drives: Vec::new(),
        field: None,
        skipping: Skipping::ALL,
    }
}

fn support(name: &str, nodes: &[usize], direction: [f64; 2], drive: Option<usize>) -> Support {
    Support { name: name.into(), nodes: nodes.to_vec(), direction, drive }
}

fn freedom(node: usize, component: usize) -> Freedom {
    Freedom { node, component }
}

fn displacements(equations: &Equations, drives: [f64; 2]) -> Vec<f64> {
    let unknowns: Vec<f64> = (0..equations.count()).map(|k| 0.1 + k as f64).collect();
    let mut displacements = vec![0.0; equations.freedom_count()];
    equations.add_displacements(&unknowns, &drives, &mut displacements);
    displacements
}

#[test]
fn held_freedoms_stay_and_driven_ones_follow_their_drive() {
    let supports = vec![support("base", &[0, 1], [0.0, 1.0], None), support("grip", &[2, 3], [0.0, -2.0], Some(0))];
    let equations = Equations::new(&model(supports, Vec::new())).unwrap();
    assert_eq!(equations.count(), 4, "x of the four nodes; the free node has none");
    let u = displacements(&equations, [0.3, 9.0]);
    assert_eq!([u[1], u[3], u[5], u[7]], [0.0, 0.0, -0.3, -0.3]);
    assert_eq!([u[0], u[2], u[4], u[6]], [0.1, 1.1, 2.1, 3.1]);
    assert_eq!([u[8], u[9]], [0.0, 0.0]);
    assert_eq!(equations.drive_forces(&[0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 3.0, 0.0, 0.0]), [-7.0, 0.0]);
}

#[test]
fn a_roller_in_rotated_axes_moves_along_its_normal_by_its_drive_only() {
    let direction = [0.6, 0.8];
    let equations = Equations::new(&model(vec![support("roller", &[2], direction, Some(1))], Vec::new())).unwrap();
    let u = displacements(&equations, [0.0, 0.25]);
    assert_abs_diff_eq!(0.6 * u[4] + 0.8 * u[5], 0.25, epsilon = 1e-15);
    assert!(u[4] != 0.0);
    // The roller carries no force along itself: only the normal part of a force reaches the drive.
    let (along, normal) = ([-0.8, 0.6], direction);
    let mut forces = vec![0.0; 10];
    forces[4..6].copy_from_slice(&[2.0 * normal[0] + 5.0 * along[0], 2.0 * normal[1] + 5.0 * along[1]]);
    let virtual_work: f64 = equations.reduce(&forces).iter().zip(0..).map(|(force, k)| force * (0.1 + k as f64)).sum();
    let direct: f64 = forces.iter().zip(displacements(&equations, [0.0, 0.0])).map(|(f, u)| f * u).sum();
    assert_abs_diff_eq!(virtual_work, direct, epsilon = 1e-12);
}

#[test]
fn two_directions_hold_a_node_wherever_they_point() {
    let supports = vec![support("a", &[2], [0.6, 0.8], Some(0)), support("b", &[2], [-0.8, 0.6], None)];
    let u = displacements(&Equations::new(&model(supports, Vec::new())).unwrap(), [2.0, 0.0]);
    assert_abs_diff_eq!(u[4], 1.2, epsilon = 1e-15);
    assert_abs_diff_eq!(u[5], 1.6, epsilon = 1e-15);
}

#[test]
fn two_drives_move_a_node_along_directions_in_rotated_axes() {
    let supports = vec![support("pull", &[2], [0.6, 0.8], Some(0)), support("bend", &[2], [-0.8, 0.6], Some(1))];
    let equations = Equations::new(&model(supports, Vec::new())).unwrap();
    let u = displacements(&equations, [2.0, 0.5]);
    assert_abs_diff_eq!(u[4], 2.0 * 0.6 - 0.5 * 0.8, epsilon = 1e-15);
    assert_abs_diff_eq!(u[5], 2.0 * 0.8 + 0.5 * 0.6, epsilon = 1e-15);
    let mut forces = vec![0.0; 10];
    forces[4..6].copy_from_slice(&[3.0, 7.0]);
    let [along, across] = equations.drive_forces(&forces)[..] else { panic!("two drives") };
    assert_abs_diff_eq!(along, 3.0 * 0.6 + 7.0 * 0.8, epsilon = 1e-14);
    assert_abs_diff_eq!(across, -3.0 * 0.8 + 7.0 * 0.6, epsilon = 1e-14);
}

#[test]
fn the_same_support_twice_is_one_and_a_different_one_a_contradiction() {
    let twice = vec![support("side", &[0, 1], [1.0, 0.0], None), support("corner", &[1], [-3.0, 0.0], None)];
    assert_eq!(Equations::new(&model(twice, Vec::new())).unwrap().count(), 6);
    let other = vec![support("side", &[1], [1.0, 0.0], None), support("grip", &[1], [1.0, 0.0], Some(0))];
    let error = Equations::new(&model(other, Vec::new())).unwrap_err();
    assert_eq!(error.to_string(), "node 2 (from 1) is held twice along one direction, by side and by grip");
}

#[test]
fn chains_of_couplings_are_followed_and_their_forces_handed_back() {
    // u_2 = 2 u_3, u_3 = 0.5 u_4 + 0.5 u_5 along y; node 5 (index 4) is the centre of a grip
    let couplings = vec![
        Coupling { dependent: freedom(1, 1), terms: vec![(freedom(2, 1), 2.0)] },
        Coupling { dependent: freedom(2, 1), terms: vec![(freedom(3, 1), 0.5), (freedom(4, 1), 0.5)] },
    ];
    let model = model(vec![support("grip", &[4], [0.0, 1.0], Some(0))], couplings);
    let equations = Equations::new(&model).unwrap();
    let u = displacements(&equations, [0.4, 0.0]);
    assert_eq!(u[9], 0.4);
    assert_abs_diff_eq!(u[5], 0.5 * u[7] + 0.2, epsilon = 1e-15);
    assert_abs_diff_eq!(u[3], 2.0 * u[5], epsilon = 1e-15);
    let mut forces = vec![0.0; 10];
    forces[3] = 7.0;
    assert_eq!(equations.drive_forces(&forces), [7.0, 0.0]);
    equations.transfer_coupled_forces(&mut forces);
    assert_eq!(forces, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 7.0, 0.0, 7.0]);
}

#[test]
fn circles_and_senseless_constraints_are_reported() {
    let circle = vec![
        Coupling { dependent: freedom(0, 0), terms: vec![(freedom(1, 0), 1.0)] },
        Coupling { dependent: freedom(1, 0), terms: vec![(freedom(0, 0), 1.0)] },
    ];
    let error = Equations::new(&model(Vec::new(), circle)).unwrap_err();
    assert_eq!(error.to_string(), "the coupling of node 1 (from 1) depends on itself");
    for (one, text) in [
        (support("s", &[0], [0.0, 0.0], None), "s: (0, 0) is no direction"),
        (support("s", &[99], [1.0, 0.0], None), "s: there is no node 100 (from 1)"),
        (support("s", &[0], [1.0, 0.0], Some(7)), "s: there is no drive 8 (from 1)"),
    ] {
        assert_eq!(Equations::new(&model(vec![one], Vec::new())).unwrap_err().to_string(), text);
    }
}

//! Gap and slip against closed forms and properties.

use super::*;
use crate::contact::chain::{Chain, Foot};
use crate::contact::kinematics::{Kinematics, SlavePoint};
use crate::contact::projection::Projection;
use crate::element::ElementKind::{Q4, Q8};

type Vector = [f64; 6];

fn outer(a: Vector, b: Vector) -> [Vector; 6] {
    a.map(|a| b.map(|b| a * b))
}

/// Σ factor · matrix.
fn combination(terms: &[(f64, [Vector; 6])]) -> [Vector; 6] {
    std::array::from_fn(|i| std::array::from_fn(|j| terms.iter().map(|(factor, matrix)| factor * matrix[i][j]).sum()))
}

/// (2.9)–(2.11), (2.20), (2.18) and (2.19 with l_0/l_n²). The thesis's node 1 is the end of our edge, its normal to
/// the left of 1 → 2 then ours, its slip the negative of ours.
#[test]
fn a_linear_edge_gives_the_closed_forms_of_the_thesis() {
    let scene = Scene::new(
        Row { kind: Q4, from: 0.0, to: 1.3, count: 1 },
        Row { kind: Q4, from: 0.0, to: 1.3, count: 1 },
        |_| 0.0,
        PlaneModel::PlaneStrain,
    );
    let chain = Chain::new(&scene.mesh, &scene.master, "p", false).unwrap();
    let mut random = Random::new(3);
    for _ in 0..20 {
        let displacements: Vec<f64> = (0..scene.freedom_count()).map(|_| 0.2 * random.signed()).collect();
        let position = |node: usize| [0, 1].map(|i| scene.mesh.nodes()[node][i] + displacements[2 * node + i]);
        let slave_node = 4;
        let slave = SlavePoint { nodes: [slave_node; 3], values: [1.0, 0.0, 0.0], count: 1 };
        let from = Foot { edge: 0, coordinate: 0.0, corner: false };
        let foot = Projection { chain: &chain, position }.near(position(slave_node), from).unwrap();
        let kinematics = Kinematics::new(&chain, &slave, foot, &position).unwrap();
        let [start, end] = [0, 1].map(|k| chain.nodes(0)[k]);
        let (x_1, x_2, x_s) = (position(end), position(start), position(slave_node));
        let (l_0, l_n) = (1.3, (x_2[0] - x_1[0]).hypot(x_2[1] - x_1[1]));
        let e_1 = [(x_2[0] - x_1[0]) / l_n, (x_2[1] - x_1[1]) / l_n];
        let e_2 = [-e_1[1], e_1[0]];
        let along = |e: [f64; 2]| (x_s[0] - x_1[0]) * e[0] + (x_s[1] - x_1[1]) * e[1];
        let (gap, alpha) = (along(e_2), along(e_1) / l_n);
        // node order s, 1, 2
        let vector =
            |e: [f64; 2], [s, one, two]: [f64; 3]| [s * e[0], s * e[1], one * e[0], one * e[1], two * e[0], two * e[1]];
        let a = vector(e_2, [1.0, alpha - 1.0, -alpha]);
        let b = vector(e_2, [0.0, 1.0, -1.0]);
        let c = vector(e_1, [1.0, alpha - 1.0, -alpha]);
        let b_1 = vector(e_1, [0.0, 1.0, -1.0]);
        let f: Vector = std::array::from_fn(|i| l_0 / l_n * c[i] - gap * l_0 / (l_n * l_n) * b[i]);
        let by_gap =
            combination(&[(1.0 / l_n, outer(b, c)), (1.0 / l_n, outer(c, b)), (-gap / (l_n * l_n), outer(b, b))]);
        let (first, second) = (l_0 / (l_n * l_n), -2.0 * gap * l_0 / l_n.powi(3));
        let by_slip = combination(&[
            (-first, outer(a, b)),
            (-first, outer(b, a)),
            (first, outer(b_1, c)),
            (first, outer(c, b_1)),
            (second, outer(b, b_1)),
            (second, outer(b_1, b)),
        ]);
        assert!((kinematics.gap - gap).abs() < 1e-14);
        assert!((kinematics.arc_length - l_0 * (1.0 - alpha)).abs() < 1e-13);
        // ours: s, start = 2, end = 1
        let theirs = [0, 1, 4, 5, 2, 3];
        for i in 0..6 {
            assert!((kinematics.gap_gradient[i] - a[theirs[i]]).abs() < 1e-13);
            assert!((kinematics.slip_gradient[i] + f[theirs[i]]).abs() < 1e-13);
            for j in 0..6 {
                let (row, column) = (theirs[i], theirs[j]);
                assert!((kinematics.second_derivative(1.0, 0.0, i, j) - by_gap[row][column]).abs() < 1e-12);
                assert!((kinematics.second_derivative(0.0, 1.0, i, j) + by_slip[row][column]).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn a_rigid_rotation_changes_neither_gap_nor_slip() {
    for kind in [Q4, Q8] {
        let scene = Scene::rows(kind, parabola, PlaneModel::PlaneStrain);
        let mut contact = scene.contact(scene.pair(uinter(&[("mu", 0.2)])));
        let first = scene.shaken([0.3, -0.03], 0.01);
        forces(&mut contact, &first);
        let before: Vec<_> = contact.points().map(|point| (point.gap, point.slip, point.pressure)).collect();
        let (sine, cosine) = 1.1_f64.sin_cos();
        let mut turned = first.clone();
        for (node, [x, y]) in scene.mesh.nodes().iter().enumerate() {
            let at = [x + first[2 * node], y + first[2 * node + 1]];
            turned[2 * node] = cosine * at[0] - sine * at[1] + 5.0 - x;
            turned[2 * node + 1] = sine * at[0] + cosine * at[1] - 3.0 - y;
        }
        forces(&mut contact, &turned);
        for (point, (gap, slip, pressure)) in contact.points().zip(before) {
            assert!((point.gap - gap).abs() < 1e-13 && (point.slip - slip).abs() < 1e-13, "{point:?}");
            assert!((point.pressure - pressure).abs() < 1e-10);
        }
    }
}

#[test]
fn forces_and_moments_balance() {
    for kind in [Q4, Q8] {
        let scene = Scene::rows(kind, parabola, PlaneModel::PlaneStrain);
        for slide in [0.4, 1.4] {
            let pair = ContactPair { release: true, ..scene.pair(uinter(&[("mu", 0.5)])) };
            let mut contact = scene.contact(pair);
            let displacements = scene.shaken([slide, -0.05], 0.02);
            let forces = forces(&mut contact, &displacements);
            let mut sum = [0.0; 3];
            for (node, [x, y]) in scene.mesh.nodes().iter().enumerate() {
                let (f, g) = (forces[2 * node], forces[2 * node + 1]);
                let at = [x + displacements[2 * node], y + displacements[2 * node + 1]];
                sum = [sum[0] + f, sum[1] + g, sum[2] + at[0] * g - at[1] * f];
            }
            assert!(largest(&sum) < 1e-12 * forces.iter().map(|f| f.abs()).sum::<f64>(), "{sum:?}");
        }
    }
}

/// The foot on random curved edges is a place of least distance: no place of the chain is nearer, and d·x' = 0.
#[test]
fn feet_on_random_curves_are_the_nearest_places() {
    let mut random = Random::new(11);
    let scene = Scene::new(
        Row { kind: Q8, from: 0.0, to: 5.0, count: 5 },
        Row { kind: Q8, from: 0.0, to: 5.0, count: 5 },
        |_| 0.0,
        PlaneModel::PlaneStrain,
    );
    let chain = Chain::new(&scene.mesh, &scene.master, "p", false).unwrap();
    let mut inside = 0;
    for _ in 0..60 {
        // Straight at the start, so that no normal is smoothed.
        let displacements: Vec<f64> = (0..scene.freedom_count()).map(|_| 0.06 * random.signed()).collect();
        let position = |node: usize| {
            let [x, y] = scene.mesh.nodes()[node];
            [x + displacements[2 * node], y + 0.2 * x.sin() + displacements[2 * node + 1]]
        };
        let projection = Projection { chain: &chain, position };
        let x = 2.5 + 2.0 * random.signed();
        let point = [x, 0.2 * x.sin() + 0.15 * random.signed()];
        let foot = projection.anywhere(point).unwrap();
        let at = |edge: i64, coordinate: f64| {
            let shape = chain.shape(edge, coordinate);
            let mut place = [[0.0; 2]; 2];
            for (k, &node) in chain.nodes(edge).iter().enumerate() {
                for i in 0..2 {
                    place[0][i] += shape.values[k] * position(node)[i];
                    place[1][i] += shape.first[k] * position(node)[i];
                }
            }
            place
        };
        let distance = |place: [f64; 2]| (place[0] - point[0]).hypot(place[1] - point[1]);
        let [place, tangent] = at(foot.edge, foot.coordinate);
        if !foot.corner {
            inside += 1;
            let along = (point[0] - place[0]) * tangent[0] + (point[1] - place[1]) * tangent[1];
            assert!(along.abs() < 1e-14, "{along:e}");
        }
        for edge in 0..5 {
            for step in 0..=200 {
                let [other, _] = at(edge, -1.0 + 0.01 * f64::from(step));
                assert!(distance(place) <= distance(other) + 1e-14);
            }
        }
    }
    assert!(inside > 30);
}

/// No point of an edge is nearer than its clearance, which is not far below the distance.
#[test]
fn a_clearance_is_a_bound_of_the_distance() {
    let mut random = Random::new(12);
    let scene = Scene::new(
        Row { kind: Q8, from: 0.0, to: 3.0, count: 3 },
        Row { kind: Q8, from: 0.0, to: 3.0, count: 3 },
        |_| 0.0,
        PlaneModel::PlaneStrain,
    );
    let chain = Chain::new(&scene.mesh, &scene.master, "p", false).unwrap();
    for _ in 0..200 {
        let displacements: Vec<f64> = (0..scene.freedom_count()).map(|_| 0.3 * random.signed()).collect();
        let position = |node: usize| {
            let [x, y] = scene.mesh.nodes()[node];
            [x + displacements[2 * node], y + displacements[2 * node + 1]]
        };
        let projection = Projection { chain: &chain, position };
        let point = [1.5 + 4.0 * random.signed(), 4.0 * random.signed()];
        for edge in 0..3 {
            let clearance = projection.clearance(point, edge);
            let distances = (0..=200).map(|step| {
                let shape = chain.shape(edge, -1.0 + 0.01 * f64::from(step));
                let place = [0, 1].map(|i| {
                    let along = chain.nodes(edge).iter().zip(&shape.values);
                    along.map(|(&node, value)| value * position(node)[i]).sum::<f64>()
                });
                (place[0] - point[0]).hypot(place[1] - point[1])
            });
            let least = distances.fold(f64::INFINITY, f64::min);
            assert!(clearance <= least, "{clearance} {least}");
            // of edges of length 1 that are moved by 0.3
            assert!(clearance >= least - 2.2, "{clearance} {least}");
        }
    }
}

/// In the wedge of a convex corner the distance is that of the corner: its derivatives against differences of the gap.
#[test]
fn a_convex_corner_holds_the_foot() {
    let scene = Scene::new(
        Row { kind: Q4, from: 0.0, to: 2.0, count: 2 },
        Row { kind: Q4, from: 0.0, to: 2.0, count: 1 },
        |x| -0.5 * (x - 1.0).abs(),
        PlaneModel::PlaneStrain,
    );
    let chain = Chain::new(&scene.mesh, &scene.master, "p", false).unwrap();
    let corner = chain.nodes(0)[1];
    let slave = SlavePoint { nodes: [scene.mesh.elements()[2].nodes()[3]; 3], values: [1.0, 0.0, 0.0], count: 1 };
    let of = |d: [f64; 2]| {
        let position = |node: usize| match node {
            node if node == slave.nodes[0] => [1.0 + d[0], d[1]],
            node => scene.mesh.nodes()[node],
        };
        let foot = Projection { chain: &chain, position }.anywhere([1.0 + d[0], d[1]]).unwrap();
        (foot, Kinematics::new(&chain, &slave, foot, &position).unwrap())
    };
    let (foot, kinematics) = of([0.03, 0.1]);
    assert!(foot.corner);
    assert_eq!(scene.mesh.nodes()[corner], [1.0, 0.0]);
    assert!((kinematics.gap - 0.03_f64.hypot(0.1)).abs() < 1e-15);
    assert_eq!(largest(&kinematics.slip_gradient), 0.0);
    const STEP: f64 = 1e-5;
    for j in 0..2 {
        let moved = |side: f64| {
            let mut d = [0.03, 0.1];
            d[j] += side * STEP;
            of(d).1
        };
        let (ahead, back) = (moved(1.0), moved(-1.0));
        assert!(((ahead.gap - back.gap) / (2.0 * STEP) - kinematics.gap_gradient[j]).abs() < 1e-8);
        for i in 0..2 {
            let difference = (ahead.gap_gradient[i] - back.gap_gradient[i]) / (2.0 * STEP);
            assert!((difference - kinematics.second_derivative(1.0, 0.0, i, j)).abs() < 1e-5);
        }
    }
    // Far to one side the foot is on an edge again, and the gap goes on without a jump at the wedge's side.
    let (foot, on_edge) = of([0.0501, 0.1]);
    let (_, in_wedge) = of([0.0499, 0.1]);
    assert!(!foot.corner);
    assert!((on_edge.gap - in_wedge.gap - 0.0002 * on_edge.normal[0]).abs() < 1e-7);
}

#[test]
fn a_master_in_pieces_is_refused() {
    let scene = Scene::straight(Q4);
    let mut pair = scene.pair(uinter(&[]));
    pair.master.remove(1);
    let error = Contact::new(&scene.mesh, &[pair], &[1.0, 1.0], true, &FieldValues::default()).unwrap_err().to_string();
    assert_eq!(
        error,
        "contact 'fibre': the master is no single chain of edges: it is in pieces: 1 of 3 edges hang together"
    );
}

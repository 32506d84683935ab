use super::*;
use crate::element::ElementKind::{self, *};
use crate::kinematics::PlaneModel;
use crate::mesh::Mesh;
use std::f64::consts::FRAC_PI_2;

fn sizes(positions: &[f64]) -> Vec<f64> {
    positions.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

fn body(mesh: &mut MeshDefinition) -> usize {
    mesh.add_part(Part::new("body", PlaneModel::PlaneStress, 1.0))
}

#[test]
fn geometric_gradings_meet_their_closed_form() {
    let (length, count, q) = (7.0, 12, 1.2_f64);
    let first = length * (q - 1.0) / (q.powi(count as i32) - 1.0);
    let last = first * q.powi(count as i32 - 1);
    for grading in [
        Grading::Ratio { count, ratio: last / first },
        Grading::First { count, first },
        Grading::Capped { first, growth: q, largest: 100.0 },
    ] {
        let positions = grading.positions(length).unwrap();
        assert_eq!((positions[0], positions[count]), (0.0, length));
        assert_eq!(positions.len(), count + 1, "{grading:?}");
        for (index, size) in sizes(&positions).into_iter().enumerate() {
            approx::assert_relative_eq!(size, first * q.powi(index as i32), max_relative = 1e-10);
        }
    }
}

#[test]
fn gradings_can_shrink() {
    for grading in [Grading::Ratio { count: 9, ratio: 0.2 }, Grading::First { count: 9, first: 0.3 }] {
        let sizes = sizes(&grading.positions(1.0).unwrap());
        let growth = sizes[1] / sizes[0];
        assert!(growth < 1.0 && sizes.windows(2).all(|pair| (pair[1] / pair[0] / growth - 1.0).abs() < 1e-9));
    }
    let first = sizes(&Grading::First { count: 9, first: 0.3 }.positions(1.0).unwrap())[0];
    approx::assert_relative_eq!(first, 0.3, max_relative = 1e-12);
}

#[test]
fn equal_sizes_are_the_limit_of_all_gradings() {
    for grading in [
        Grading::Uniform { count: 8 },
        Grading::Ratio { count: 8, ratio: 1.0 },
        Grading::First { count: 8, first: 0.25 },
        Grading::Capped { first: 0.25, growth: 1.3, largest: 0.25 },
    ] {
        let positions = grading.positions(2.0).unwrap();
        assert_eq!(positions.len(), 9);
        for size in sizes(&positions) {
            approx::assert_relative_eq!(size, 0.25, max_relative = 1e-12);
        }
    }
    assert_eq!(Grading::Capped { first: 2.0, growth: 1.0, largest: 2.0 }.positions(2.0).unwrap(), [0.0, 2.0]);
}

#[test]
fn capped_sizes_grow_and_stay() {
    let sizes = sizes(&Grading::Capped { first: 0.1, growth: 1.5, largest: 1.0 }.positions(20.0).unwrap());
    let scale = sizes[0] / 0.1;
    assert!((0.9..1.1).contains(&scale), "{scale}");
    for pair in sizes.windows(2) {
        approx::assert_relative_eq!(pair[1], (1.5 * pair[0]).min(scale), max_relative = 1e-10);
    }
    let through = capped_through(&[1.0, 2.0, 5.0, 21.0], 0.1, 1.5, 1.0).unwrap();
    for stop in [1.0, 2.0, 5.0, 21.0] {
        assert!(through.contains(&stop));
    }
    // Each piece is scaled to end on its stop, so neighbours differ by a little more than the growth.
    assert!(through.windows(3).all(|p| (p[2] - p[1]) / (p[1] - p[0]) < 1.5 * 1.5));
}

#[test]
fn gradings_that_cannot_be_are_refused() {
    let message = |grading: Grading, length: f64| grading.positions(length).unwrap_err().to_string();
    let uniform = Grading::Uniform { count: 3 };
    assert_eq!(message(uniform, 0.0), "the length to divide is 0, it must be positive");
    assert_eq!(message(uniform, f64::NAN), "the length to divide is NaN, it must be positive");
    assert_eq!(message(Grading::Uniform { count: 0 }, 1.0), "a line must be divided at least once");
    assert_eq!(
        message(Grading::Ratio { count: 3, ratio: -1.0 }, 1.0),
        "the ratio of the sizes is -1, it must be positive"
    );
    assert_eq!(
        message(Grading::First { count: 3, first: 2.0 }, 1.0),
        "the first size is 2, more than the length 1 to divide"
    );
    assert!(message(Grading::Capped { first: 1e-7, growth: 1.0, largest: 1.0 }, 1.0).contains("more than 100000"));
    assert!(message(Grading::Ratio { count: 50, ratio: 1e12 }, 1.0).starts_with("the sizes go down to"));
}

/// A quarter ring from radius 1 to 2.
fn ring(kind: ElementKind, diagonal: Diagonal) -> Mesh {
    let radii = Grading::Ratio { count: 3, ratio: 2.0 }.positions(1.0).unwrap();
    let angles = Grading::Uniform { count: 4 }.positions(FRAC_PI_2).unwrap();
    let map = |[s, angle]: [f64; 2]| [(1.0 + s) * angle.cos(), (1.0 + s) * angle.sin()];
    let mut mesh = MeshDefinition::default();
    let part = body(&mut mesh);
    let cut = |_, _| diagonal;
    let grid = mesh.block(&MeshBlock::new(part, kind, &radii, &angles).mapped(&map).cut(&cut)).unwrap();
    for (name, side) in [("bottom", Side::Bottom), ("right", Side::Right), ("top", Side::Top), ("left", Side::Left)] {
        mesh.edge_set(name, grid.side_edges(side));
        mesh.node_set(name, grid.side_nodes(side));
    }
    Mesh::new(mesh).unwrap()
}

#[test]
fn mapped_grids_of_all_kinds_are_sound_and_know_their_sides() {
    for (kind, diagonal) in ElementKind::ALL.into_iter().flat_map(|k| [(k, Diagonal::Rising), (k, Diagonal::Falling)]) {
        let mesh = ring(kind, diagonal);
        assert_eq!(mesh.elements().len(), 12 * if kind.corner_count() == 3 { 2 } else { 1 });
        let area: f64 = (0..mesh.elements().len()).map(|element| mesh.element_area(element)).sum();
        let (exact, error) = (
            0.75 * std::f64::consts::PI,
            if kind.edge_kind() == crate::element::EdgeKind::Quadratic { 1e-3 } else { 0.03 },
        );
        approx::assert_relative_eq!(area, exact, max_relative = error);
        // The four sides are the boundary, each chain end to start.
        let mut count = 0;
        for name in ["bottom", "right", "top", "left"] {
            let edges = mesh.edge_set(name).unwrap();
            count += edges.len();
            for pair in edges.windows(2) {
                assert_eq!(mesh.edge_nodes(pair[0]).nodes()[1], mesh.edge_nodes(pair[1]).nodes()[0]);
            }
            for &edge in edges {
                assert_eq!(mesh.neighbour(edge), None);
                for &node in mesh.edge_nodes(edge).nodes() {
                    assert!(mesh.node_set(name).unwrap().contains(&node));
                }
            }
        }
        assert_eq!(mesh.boundary_edges().count(), count);
        for (name, radius) in [("left", 1.0), ("right", 2.0)] {
            // Corners and middles alike.
            for &node in mesh.node_set(name).unwrap() {
                let [x, y] = mesh.nodes()[node];
                approx::assert_relative_eq!(x.hypot(y), radius, max_relative = 1e-14);
            }
        }
    }
}

#[test]
fn cells_can_be_left_out() {
    let line = [0.0, 1.0, 2.0, 3.0];
    for kind in ElementKind::ALL {
        let mut mesh = MeshDefinition::default();
        let part = body(&mut mesh);
        let keep = |column, row| (column, row) != (1, 1);
        let grid = mesh.block(&MeshBlock::new(part, kind, &line, &line).keeping(&keep)).unwrap();
        assert_eq!(grid.edge(1, 1, Side::Left), None);
        assert_eq!((grid.edge(3, 0, Side::Left), grid.edge(0, 3, Side::Left), grid.node(7, 0)), (None, None, None));
        mesh.edge_set("hole", vec![grid.edge(0, 1, Side::Right).unwrap(), grid.edge(1, 2, Side::Bottom).unwrap()]);
        let mesh = Mesh::new(mesh).unwrap();
        assert_eq!(mesh.boundary_loops().len(), 2);
        assert!(mesh.edge_set("hole").unwrap().iter().all(|&edge| mesh.neighbour(edge).is_none()));
        assert_eq!(mesh.free_nodes(), [0; 0]);
    }
}

#[test]
fn blocks_are_glued_only_where_asked() {
    let (left, right, height) = ([0.0, 0.5, 1.0], [1.0, 1.5, 2.0], [0.0, 0.3, 1.0]);
    for kind in ElementKind::ALL {
        let side = if kind.edge_kind() == crate::element::EdgeKind::Quadratic { 5 } else { 3 };
        for (glued, loops) in [(true, 1), (false, 2)] {
            let mut mesh = MeshDefinition::default();
            let part = body(&mut mesh);
            let first = mesh.block(&MeshBlock::new(part, kind, &left, &height)).unwrap();
            let before = mesh.nodes.len();
            let others = if glued { first.side_nodes(Side::Right) } else { vec![] };
            let second = mesh.glued_block(&MeshBlock::new(part, kind, &right, &height), &others).unwrap();
            assert_eq!(mesh.nodes.len(), before + second.nodes().count() - if glued { side } else { 0 });
            let mesh = Mesh::new(mesh).unwrap();
            assert_eq!(mesh.boundary_loops().len(), loops);
        }
    }
}

#[test]
fn blocks_that_cannot_be_are_refused() {
    let line = [0.0, 1.0];
    let mut mesh = MeshDefinition::default();
    let part = body(&mut mesh);
    let message = |result: Result<Grid, MeshError>| result.unwrap_err().to_string();
    let divisions = "must be at least two ascending numbers";
    assert_eq!(
        message(mesh.block(&MeshBlock::new(part, Q4, &[0.0], &line))),
        format!("the divisions of a block along ξ {divisions}")
    );
    assert_eq!(
        message(mesh.block(&MeshBlock::new(part, Q4, &line, &[0.0, 1.0, 1.0]))),
        format!("the divisions of a block along η {divisions}")
    );
    let map = |[x, y]: [f64; 2]| [1.0 / (x - 1.0), y];
    assert_eq!(
        message(mesh.block(&MeshBlock::new(part, Q8, &line, &line).mapped(&map))),
        "the map of a block gives (inf, 0) at ξ = 1, η = 0"
    );
}

/// Checks that they are refused before memory is allocated for them.
#[test]
fn more_cells_than_a_mesh_may_have_are_refused() {
    let line = Grading::Uniform { count: MOST_DIVISIONS }.positions(1.0).unwrap();
    let mut mesh = MeshDefinition::default();
    let error = mesh.block(&MeshBlock::new(0, ElementKind::Q8, &line, &line)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "100000 × 100000 cells are too many, a mesh has at most 1000000; are the sizes too small?"
    );
}

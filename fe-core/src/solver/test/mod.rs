use std::sync::Arc;

use super::*;
use crate::element::{ElementKind, Integration, MappedPoint};
use crate::kinematics::PlaneModel;
use crate::kinematics::test::strain_displacement::{MAX_FREEDOMS, StrainDisplacement};
use end_to_end_tests::Random;
use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};
use grid::Bodies;

mod grid;
mod parts;

/// A held body and a free one on top of it; contact equations where they meet.
struct Scene {
    bodies: Bodies,
    matrix: SystemMatrix,
    contact: Vec<usize>,
}

impl Scene {
    fn new() -> Self {
        let mut bodies = Bodies::default();
        bodies.add(7, 4, 30.0, true);
        bodies.add(7, 2, 210.0, false);
        let matrix = bodies.matrix();
        let contact = bodies.surfaces[0][1].iter().chain(&bodies.surfaces[1][0]).copied().collect();
        Self { bodies, matrix, contact }
    }

    /// Random unsymmetric, indefinite blocks of six equations of either surface, displaced by `slide` nodes.
    fn couple(&mut self, seed: u64, slide: usize) {
        let mut numbers = Random::new(seed);
        let (lower, upper) = (&self.bodies.surfaces[0][1], &self.bodies.surfaces[1][0]);
        self.matrix.contact.clear();
        for start in (0..lower.len() - 4 - 2 * slide).step_by(4) {
            let rows = [&lower[start + 2 * slide..][..4], &upper[start..][..4]].concat();
            self.matrix.contact.push(&rows, &numbers.vector(64).iter().map(|x| 100.0 * x).collect::<Vec<_>>());
        }
    }

    /// Springs between nodes opposite each other: symmetric.
    fn bond(&mut self, stiffness: f64) {
        self.matrix.contact.clear();
        let (lower, upper) = (&self.bodies.surfaces[0][1], &self.bodies.surfaces[1][0]);
        for (&master, &slave) in lower.iter().zip(&upper[2..]) {
            self.matrix.contact.push(&[master, slave], &[stiffness, -stiffness, -stiffness, stiffness]);
        }
    }

    fn solver(&self, first_method: Option<Method>) -> LinearSolver {
        let options = SolverOptions { first_method, ..SolverOptions::default() };
        LinearSolver::new(self.matrix.pattern(), &self.bodies.nodes, options)
    }

    fn size(&self) -> usize {
        self.bodies.nodes.len()
    }
}

fn dense(matrix: &SystemMatrix) -> Mat<f64> {
    let size = matrix.pattern().size();
    let mut full = Mat::zeros(size, size);
    for column in 0..size {
        for row in 0..size {
            if let Some(place) = matrix.pattern().index(row, column) {
                full[(row, column)] = matrix.values[place];
            }
        }
    }
    for (rows, values) in matrix.contact.iter() {
        for (i, &row) in rows.iter().enumerate() {
            for (j, &column) in rows.iter().enumerate() {
                full[(row, column)] += values[i * rows.len() + j];
            }
        }
    }
    full
}

/// Solves for a random right side, and compares with dense LU to 1e-10 of the greatest displacement.
#[track_caller]
fn check_solution(solver: &mut LinearSolver, matrix: &SystemMatrix) {
    let right_side = Random::new(77).vector(matrix.pattern().size());
    let mut found = right_side.clone();
    solver.solve(matrix, &mut found).unwrap();
    let column = Mat::from_fn(right_side.len(), 1, |row, _| right_side[row]);
    let expected = PartialPivLu::new(dense(matrix).as_ref()).solve(&column);
    let scale = (0..right_side.len()).map(|row| expected[(row, 0)].abs()).fold(0.0, f64::max);
    for (row, value) in found.iter().enumerate() {
        assert!((value - expected[(row, 0)]).abs() <= 1e-10 * scale, "row {row}: {value} for {}", expected[(row, 0)]);
    }
}

/// Changes the signs of the diagonal in a few rows far from contact: symmetric, indefinite.
fn soften(matrix: &mut SystemMatrix) {
    for equation in [20, 41, 60] {
        let place = matrix.pattern().index(equation, equation).unwrap();
        matrix.values[place] *= -1.0;
    }
}

/// Adds noise to the solids: unsymmetric.
fn disturb(matrix: &mut SystemMatrix) {
    let mut numbers = Random::new(5);
    matrix.values.iter_mut().for_each(|value| *value += 1.0 * numbers.signed());
}

#[test]
fn a_pattern_joins_what_shares_a_group_and_has_its_diagonal() {
    let groups: [&[usize]; 3] = [&[0, 2], &[2, 3, 2], &[]];
    let pattern = Pattern::from_groups(5, groups.into_iter());
    assert_eq!((pattern.size(), pattern.entries()), (5, 9));
    assert_eq!(pattern.column_starts(), [0, 2, 3, 6, 8, 9]);
    assert_eq!(pattern.rows(), [0, 2, 1, 0, 2, 3, 2, 3, 4]);
    assert_eq!((pattern.index(3, 2), pattern.index(1, 2), pattern.index(0, 9)), (Some(5), None, None));
}

#[test]
fn the_product_is_that_of_the_dense_matrix() {
    let mut scene = Scene::new();
    scene.couple(1, 1);
    disturb(&mut scene.matrix);
    let x = Random::new(3).vector(scene.size());
    let mut y = vec![0.0; x.len()];
    scene.matrix.multiply(&x, &mut y);
    let full = dense(&scene.matrix);
    for (row, value) in y.iter().enumerate() {
        let expected: f64 = x.iter().enumerate().map(|(column, x)| full[(row, column)] * x).sum();
        assert!((value - expected).abs() < 1e-10);
    }
}

#[test]
fn every_method_solves_a_body_that_contact_alone_holds() {
    let mut scene = Scene::new();
    for method in [Method::BlockLu, Method::GeneralLu] {
        let mut solver = scene.solver(Some(method));
        for seed in 1..4 {
            scene.couple(seed, 0);
            let report = solver.factorise(&scene.matrix, Symmetry::Symmetric).unwrap();
            assert_eq!(report.method, method);
            check_solution(&mut solver, &scene.matrix);
        }
    }
}

#[test]
fn unsymmetric_solids_are_solved() {
    let mut scene = Scene::new();
    scene.couple(4, 0);
    disturb(&mut scene.matrix);
    for method in [None, Some(Method::GeneralLu)] {
        let mut solver = scene.solver(method);
        let report = solver.factorise(&scene.matrix, Symmetry::Unsymmetric).unwrap();
        assert_eq!(report.method, method.unwrap_or(Method::BlockLu));
        check_solution(&mut solver, &scene.matrix);
    }
}

#[test]
fn numbers_that_overflow_on_the_way_are_an_error() {
    let mut scene = Scene::new();
    let mut numbers = Random::new(9);
    scene.matrix.values.iter_mut().for_each(|value| *value = numbers.signed() * 10f64.powf(305.0 * numbers.signed()));
    for method in [Method::BlockLu, Method::GeneralLu] {
        for symmetry in [Symmetry::Symmetric, Symmetry::Unsymmetric] {
            assert!(scene.solver(Some(method)).factorise(&scene.matrix, symmetry).is_err());
        }
    }
}

#[test]
fn pivots_that_a_supernode_lacks_are_left_to_general_lu() {
    // A cyclic shift: regular, but each diagonal block of a part of it is singular.
    let size = 200;
    let groups: Vec<[usize; 2]> = (0..size).map(|i| [i, (i + 1) % size]).collect();
    let pattern = Arc::new(Pattern::from_groups(size, groups.iter().map(|group| &group[..])));
    let mut matrix = SystemMatrix::new(Arc::clone(&pattern));
    for [column, row] in &groups {
        matrix.values[pattern.index(*row, *column).unwrap()] = 1.0 + *row as f64;
    }
    let nodes: Vec<usize> = (0..size).collect();
    let mut solver = LinearSolver::new(&pattern, &nodes, SolverOptions::default());
    assert_eq!(solver.factorise(&matrix, Symmetry::Unsymmetric).unwrap().method, Method::GeneralLu);
    check_solution(&mut solver, &matrix);
}

#[test]
fn lu_keeps_its_analysis_while_the_blocks_fit() {
    let mut scene = Scene::new();
    scene.couple(1, 0);
    let mut solver = scene.solver(Some(Method::BlockLu));
    let mut reused = Vec::new();
    for slide in [0, 0, 1, 0, 1] {
        scene.couple(3, slide);
        reused.push(solver.factorise(&scene.matrix, Symmetry::Unsymmetric).unwrap().symbolic_reused);
        check_solution(&mut solver, &scene.matrix);
    }
    assert_eq!(reused, [false, true, false, true, true]);
}

#[test]
fn lu_does_again_what_changed_and_what_is_above_it_to_the_same_bits() {
    let mut scene = Scene::new();
    scene.couple(1, 0);
    disturb(&mut scene.matrix);
    let mut kept = scene.solver(Some(Method::BlockLu));
    let options = SolverOptions { first_method: Some(Method::BlockLu), forgets: true };
    let mut forgetful = LinearSolver::new(scene.matrix.pattern(), &scene.bodies.nodes, options);
    let size = scene.size();
    let all = kept.factorise(&scene.matrix, Symmetry::Unsymmetric).unwrap().flops.unwrap();
    let mut done = Vec::new();
    for round in 0..size {
        match round % 3 {
            // a single number, of another equation each time; contact by other numbers; nothing
            0 => {
                let place = scene.matrix.pattern().index(round, round).unwrap();
                scene.matrix.values[place] *= if round % 2 == 0 { 1.1 } else { -1.0 };
            }
            1 => scene.couple(round as u64, 0),
            _ => {}
        }
        let report = kept.factorise(&scene.matrix, Symmetry::Unsymmetric).unwrap();
        let expected = forgetful.factorise(&scene.matrix, Symmetry::Unsymmetric).unwrap();
        assert_eq!((report.method, expected.flops), (Method::BlockLu, Some(all)));
        done.push(report.flops.unwrap() / all);
        let (mut x, mut y) = (Random::new(9).vector(size), Random::new(9).vector(size));
        kept.solve(&scene.matrix, &mut x).unwrap();
        forgetful.solve(&scene.matrix, &mut y).unwrap();
        assert_eq!(x, y, "round {round}");
    }
    assert!(done.iter().skip(2).step_by(3).all(|part| *part == 0.0), "nothing has changed: {done:?}");
    let of_one: Vec<f64> = done.iter().step_by(3).copied().collect();
    let mean = of_one.iter().sum::<f64>() / of_one.len() as f64;
    assert!(of_one.iter().all(|part| *part > 0.0) && mean < 0.7, "a number changes its panel and those above: {mean}");
    // a matrix that is refused on the way leaves nothing that could stay
    let mut singular = scene.matrix.clone();
    singular.values.fill(0.0);
    assert!(kept.factorise(&singular, Symmetry::Unsymmetric).is_err());
    assert_eq!(kept.factorise(&scene.matrix, Symmetry::Unsymmetric).unwrap().flops, Some(all));
    check_solution(&mut kept, &scene.matrix);
}

#[test]
fn lu_forgets_old_blocks_when_they_outweigh_the_present_ones() {
    let pattern = Arc::new(Pattern::from_groups(40, std::iter::empty()));
    let mut matrix = SystemMatrix::new(Arc::clone(&pattern));
    matrix.values.fill(50.0);
    let nodes: Vec<usize> = (0..40).collect();
    let options = SolverOptions { first_method: Some(Method::BlockLu), ..SolverOptions::default() };
    let mut solver = LinearSolver::new(&pattern, &nodes, options);
    let mut factor_entries = Vec::new();
    for start in [0, 20, 0] {
        matrix.contact.clear();
        matrix.contact.push(&nodes[start..start + 10], &Random::new(3).vector(100));
        let report = solver.factorise(&matrix, Symmetry::Unsymmetric).unwrap();
        assert!(!report.symbolic_reused);
        factor_entries.push(report.factor_entries.unwrap());
        check_solution(&mut solver, &matrix);
    }
    assert!(factor_entries.iter().all(|&entries| entries == factor_entries[0]), "{factor_entries:?}");
}

#[test]
fn a_body_that_nothing_holds_is_an_error_by_every_method() {
    let mut scene = Scene::new();
    for blocks in [false, true] {
        if blocks {
            scene.bond(1.0);
            // Only the horizontal springs stay: the upper body can still lift and turn.
            let horizontal = scene.bodies.surfaces[0][1][0];
            let mut kept = Blocks::default();
            scene.matrix.contact.iter().filter(|(rows, _)| rows[0] % 2 == horizontal % 2).for_each(|(rows, values)| {
                kept.push(rows, values);
            });
            scene.matrix.contact = kept;
        }
        for method in [Method::BlockLu, Method::GeneralLu] {
            let mut solver = scene.solver(Some(method));
            let error = solver.factorise(&scene.matrix, Symmetry::Symmetric).unwrap_err();
            assert!(matches!(error, SolverError::Singular { .. }), "{method:?}: {error}");
            let mut x = vec![1.0; scene.size()];
            assert_eq!(solver.solve(&scene.matrix, &mut x), Err(SolverError::NotFactorised));
        }
    }
}

#[test]
fn numbers_that_are_none_are_refused() {
    let mut scene = Scene::new();
    scene.bond(50.0);
    let mut solver = scene.solver(None);
    solver.factorise(&scene.matrix, Symmetry::Symmetric).unwrap();
    let mut x = vec![0.0; scene.size()];
    x[3] = f64::NAN;
    assert_eq!(solver.solve(&scene.matrix, &mut x), Err(SolverError::RightSide { equation: 3 }));

    let place = scene.matrix.pattern().index(11, 10).unwrap();
    let value = std::mem::replace(&mut scene.matrix.values[place], f64::NAN);
    let error = solver.factorise(&scene.matrix, Symmetry::Symmetric).unwrap_err();
    assert_eq!(error, SolverError::NotFinite { row: 11, column: 10 });
    assert_eq!(error.to_string(), "the entry in row 12, column 11 of the matrix is not finite");
    scene.matrix.values[place] = value;

    let [a, b] = [scene.contact[0], scene.contact[1]];
    scene.matrix.contact.push(&[a, b], &[1.0, f64::INFINITY, 0.0, 1.0]);
    for method in [Method::BlockLu, Method::GeneralLu] {
        let error = scene.solver(Some(method)).factorise(&scene.matrix, Symmetry::Symmetric).unwrap_err();
        assert_eq!(error, SolverError::NotFinite { row: a, column: b });
    }
}

#[test]
fn a_factor_of_another_matrix_is_noticed() {
    let mut scene = Scene::new();
    scene.bond(50.0);
    let mut solver = scene.solver(None);
    solver.factorise(&scene.matrix, Symmetry::Symmetric).unwrap();
    let right_side = Random::new(8).vector(scene.size());
    let mut x = right_side.clone();
    scene.matrix.values.iter_mut().for_each(|value| *value *= 1.5);
    assert!(matches!(solver.solve(&scene.matrix, &mut x), Err(SolverError::Residual { .. })));
    assert_eq!(x, right_side, "as it was");
}

#[test]
fn refinement_repairs_a_factor_that_is_almost_right() {
    let mut scene = Scene::new();
    scene.bond(50.0);
    let mut solver = scene.solver(None);
    solver.factorise(&scene.matrix, Symmetry::Symmetric).unwrap();
    scene.matrix.values.iter_mut().for_each(|value| *value *= 1.0 + 1e-7);
    scene.bond(50.0 * (1.0 + 1e-7));
    let report = solver.solve(&scene.matrix, &mut Random::new(8).vector(scene.size())).unwrap();
    assert!(report.refined && report.relative_residual < REFINED_RESIDUAL);
}

#[test]
fn nothing_to_solve_is_solved() {
    let pattern = Arc::new(Pattern::from_groups(0, std::iter::empty()));
    let matrix = SystemMatrix::new(Arc::clone(&pattern));
    for first_method in [None, Some(Method::BlockLu), Some(Method::GeneralLu)] {
        for symmetry in [Symmetry::Symmetric, Symmetry::Unsymmetric] {
            let mut solver =
                LinearSolver::new(&pattern, &[], SolverOptions { first_method, ..SolverOptions::default() });
            solver.factorise(&matrix, symmetry).unwrap();
            assert_eq!(solver.solve(&matrix, &mut []).unwrap().relative_residual, 0.0);
        }
    }
}

#[test]
fn every_equation_may_be_in_contact() {
    let pattern = Arc::new(Pattern::from_groups(3, std::iter::empty()));
    let mut matrix = SystemMatrix::new(Arc::clone(&pattern));
    matrix.contact.push(&[2, 0, 1], &[0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 4.0, 0.0, 1.0]);
    let mut solver = LinearSolver::new(&pattern, &[0, 1, 2], SolverOptions::default());
    solver.factorise(&matrix, Symmetry::Symmetric).unwrap();
    check_solution(&mut solver, &matrix);
}

#[test]
fn repeats_are_equal_bit_by_bit() {
    let mut scene = Scene::new();
    scene.couple(6, 0);
    for method in [Method::BlockLu, Method::GeneralLu] {
        let solve = || {
            let mut solver = scene.solver(Some(method));
            solver.factorise(&scene.matrix, Symmetry::Symmetric).unwrap();
            solver.factorise(&scene.matrix, Symmetry::Symmetric).unwrap();
            let mut x = Random::new(8).vector(scene.size());
            solver.solve(&scene.matrix, &mut x).unwrap();
            x
        };
        assert_eq!(solve(), solve());
    }
}

/// A body on its own with two of its sides as border, and S and u_I by dense algebra.
fn dense_condensation(matrix: &SystemMatrix, border: &[usize], displacements: &[f64]) -> (Mat<f64>, Mat<f64>) {
    let full = dense(matrix);
    let inside: Vec<usize> = (0..full.nrows()).filter(|equation| !border.contains(equation)).collect();
    let part =
        |rows: &[usize], columns: &[usize]| Mat::from_fn(rows.len(), columns.len(), |i, j| full[(rows[i], columns[j])]);
    let influence = PartialPivLu::new(part(&inside, &inside).as_ref()).solve(&part(&inside, border));
    let condensed = part(border, border) - part(border, &inside) * &influence;
    let border_displacements = Mat::from_fn(border.len(), 1, |row, _| displacements[row]);
    let interior = influence * border_displacements;
    let mut expanded = Mat::zeros(full.nrows(), 1);
    inside.iter().enumerate().for_each(|(place, &equation)| expanded[(equation, 0)] = -interior[(place, 0)]);
    border.iter().zip(displacements).for_each(|(&equation, value)| expanded[(equation, 0)] = *value);
    (condensed, expanded)
}

#[test]
fn a_superelement_is_the_schur_complement_and_expands() {
    for held in [true, false] {
        let mut bodies = Bodies::default();
        bodies.add(9, 4, 30e3, held);
        let matrix = bodies.matrix();
        let [lower, upper] = &bodies.surfaces[0];
        let mut border = [upper.as_slice(), lower].concat();
        border.reverse();
        let mut superelement = Superelement::new(matrix.pattern(), &matrix.values, &bodies.nodes, &border).unwrap();
        let displacements = Random::new(4).vector(border.len());
        let (condensed, expanded) = dense_condensation(&matrix, &border, &displacements);
        let count = border.len();
        for (place, value) in superelement.stiffness().iter().enumerate() {
            let (row, column) = (place / count, place % count);
            assert!((value - condensed[(row, column)]).abs() < 1e-10 * 30e3);
            assert_eq!(*value, superelement.stiffness()[column * count + row]);
        }
        let mut found = vec![0.0; bodies.nodes.len()];
        superelement.expand(&displacements, &mut found);
        for (row, value) in found.iter().enumerate() {
            assert!((value - expanded[(row, 0)]).abs() < 1e-10);
        }
        border.iter().zip(&displacements).for_each(|(&equation, value)| assert_eq!(found[equation], *value));
    }
}

#[test]
fn a_superelement_may_be_all_border_or_have_none() {
    let mut bodies = Bodies::default();
    bodies.add(2, 2, 30e3, true);
    let matrix = bodies.matrix();
    let all: Vec<usize> = (0..bodies.nodes.len()).collect();
    let whole = Superelement::new(matrix.pattern(), &matrix.values, &bodies.nodes, &all).unwrap();
    let full = dense(&matrix);
    for (place, value) in whole.stiffness().iter().enumerate() {
        assert!((value - full[(place / all.len(), place % all.len())]).abs() < 1e-10 * 30e3);
    }
    let mut none = Superelement::new(matrix.pattern(), &matrix.values, &bodies.nodes, &[]).unwrap();
    let mut displacements = vec![1.0; all.len()];
    none.expand(&[], &mut displacements);
    assert!(none.stiffness().is_empty() && displacements.iter().all(|&value| value == 0.0));
}

#[test]
fn a_superelement_refuses_an_interior_that_is_not_stable() {
    let mut scene = Scene::new();
    let condense = |scene: &Scene, border: &[usize]| {
        Superelement::new(scene.matrix.pattern(), &scene.matrix.values, &scene.bodies.nodes, border)
            .map(|_| ())
            .unwrap_err()
    };
    // The upper body has no border and no support.
    let free = condense(&scene, &scene.bodies.surfaces[0][1]);
    assert!(matches!(free, SolverError::NotDefinite { .. } | SolverError::Singular { .. }), "{free}");
    let surfaces = scene.contact.clone();
    soften(&mut scene.matrix);
    let SolverError::NotDefinite { equation } = condense(&scene, &surfaces) else { panic!("softened") };
    assert!(!surfaces.contains(&equation));
    scene.matrix.values[7] = f64::NAN;
    assert!(matches!(condense(&scene, &surfaces), SolverError::NotFinite { .. }));
}

#[test]
fn a_soft_mode_next_to_a_stiff_contact_is_solved_as_well_as_rounding_allows() {
    let mut scene = Scene::new();
    scene.bond(1e9);
    // All springs but one pair are weak: the upper body turns about it against almost nothing.
    let mut kept = Blocks::default();
    for (place, (rows, values)) in scene.matrix.contact.iter().enumerate() {
        let factor = if place < 2 { 1.0 } else { 1e-11 };
        kept.push(rows, &values.iter().map(|value| factor * value).collect::<Vec<_>>());
    }
    scene.matrix.contact = kept;
    for method in [Method::BlockLu, Method::GeneralLu] {
        let mut solver = scene.solver(Some(method));
        solver.factorise(&scene.matrix, Symmetry::Symmetric).unwrap();
        let mut x = Random::new(8).vector(scene.size());
        let report = solver.solve(&scene.matrix, &mut x).unwrap();
        assert!(report.relative_residual > REFINED_RESIDUAL, "otherwise this tests nothing");
        assert!(report.relative_residual < LARGEST_RESIDUAL);
    }
}

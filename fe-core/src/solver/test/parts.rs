//! Large definite matrices in parts, by one thread or several.

use super::analysis::cholesky_flops;
use super::cut::{Cut, cut};
use super::graph::NodeGraph;
use super::ordering::elimination_order;
use super::*;
use crate::threads::Threads;
use std::num::NonZeroUsize;

/// Cut three times: 22 000 equations.
const COLUMNS: usize = 90;
const ROWS: usize = 40;

fn body(held: bool) -> Bodies {
    let mut bodies = Bodies::default();
    bodies.add(COLUMNS, ROWS, 30.0, held);
    bodies
}

fn solver(bodies: &Bodies, matrix: &SystemMatrix) -> LinearSolver {
    LinearSolver::new(matrix.pattern(), &bodies.nodes, SolverOptions::default())
}

fn in_parts(bodies: &Bodies, matrix: &SystemMatrix, threads: usize) -> LinearSolver {
    let mut solver = solver(bodies, matrix).with_positions(bodies.positions.clone());
    solver.set_threads(&Threads::new(NonZeroUsize::new(threads).unwrap()).unwrap());
    solver
}

/// The equations on both sides of a cut, and on it.
fn cut_of(bodies: &Bodies, matrix: &SystemMatrix) -> ([Vec<usize>; 2], Vec<usize>) {
    let graph = NodeGraph::new(matrix.pattern(), &bodies.nodes, &[]);
    let Cut { halves, between } = cut(&graph.graph, &graph.positions(&bodies.positions)).unwrap();
    (halves.map(|half| graph.all_equations(&half)), graph.all_equations(&between))
}

#[test]
fn a_cut_separates_two_halves_along_the_shorter_side() {
    let bodies = body(true);
    let matrix = bodies.matrix();
    let (halves, between) = cut_of(&bodies, &matrix);
    assert_eq!(between.len(), 2 * (2 * ROWS + 1), "a line of nodes");
    let size = bodies.nodes.len();
    let mut side = vec![2; size];
    for (half, equations) in halves.iter().enumerate() {
        assert!(equations.len() as f64 > 0.49 * (size - between.len()) as f64, "they are equal");
        equations.iter().for_each(|&equation| side[equation] = half);
    }
    assert_eq!(halves.iter().map(Vec::len).sum::<usize>() + between.len(), size);
    for column in 0..size {
        for &row in matrix.pattern().column(column) {
            assert!(side[row] == side[column] || side[row] == 2 || side[column] == 2, "{row} and {column} are coupled");
        }
    }
}

#[test]
fn parts_give_the_solution_of_the_whole_and_threads_change_no_bit() {
    let bodies = body(true);
    let matrix = bodies.matrix();
    let right_side = Random::new(3).vector(bodies.nodes.len());
    let solve = |solver: &mut LinearSolver| {
        let report = solver.factorise(&matrix, Symmetry::Symmetric).unwrap();
        let mut x = right_side.clone();
        let solved = solver.solve(&matrix, &mut x).unwrap();
        assert!(!solved.refined, "{solved:?}");
        (x, report)
    };
    let (whole, one_piece) = solve(&mut solver(&bodies, &matrix));
    let mut first = in_parts(&bodies, &matrix, 1);
    let (one, report) = solve(&mut first);
    assert_eq!((one_piece.method, report.method), (Method::BlockLu, Method::Parts), "it is cut");
    // an LU takes twice as many as LLᵀ; each leaf factorises its border too, to take it off again
    assert!(report.flops < one_piece.flops, "{report:?} for {one_piece:?}");
    let scale = whole.iter().fold(0.0, |greatest: f64, x| greatest.max(x.abs()));
    for (x, whole) in one.iter().zip(&whole) {
        assert!((x - whole).abs() < 1e-11 * scale, "{x} for {whole}");
    }
    assert_eq!(solve(&mut first).0, one, "a factorisation leaves no trace");
    for threads in [2, 3] {
        let (several, _) = solve(&mut in_parts(&bodies, &matrix, threads));
        assert_eq!(several, one, "{threads} threads");
    }
}

#[test]
fn parts_that_stay_are_not_factorised_again() {
    let bodies = body(true);
    let mut matrix = bodies.matrix();
    let right_side = Random::new(5).vector(bodies.nodes.len());
    let solve = |solver: &mut LinearSolver, matrix: &SystemMatrix| {
        let report = solver.factorise(matrix, Symmetry::Symmetric).unwrap();
        assert_eq!(report.method, Method::Parts);
        let mut x = right_side.clone();
        solver.solve(matrix, &mut x).unwrap();
        (x, report.flops.unwrap())
    };
    let mut kept = in_parts(&bodies, &matrix, 2);
    let (first, all) = solve(&mut kept, &matrix);
    let (again, none) = solve(&mut kept, &matrix);
    assert_eq!((again, none), (first, 0.0), "nothing has changed");
    // in a corner, then everywhere along a cut: an eighth of the leaves and the fronts above, or most of them
    let (_, between) = cut_of(&bodies, &matrix);
    for (changed, most) in [(&[2000][..], 0.6), (&between, 1.0)] {
        for &equation in changed {
            let place = matrix.pattern().index(equation, equation).unwrap();
            matrix.values[place] *= 1.5;
        }
        let (x, flops) = solve(&mut kept, &matrix);
        assert!(flops > 0.0 && flops <= most * all, "{flops} of {all}");
        assert_eq!(x, solve(&mut in_parts(&bodies, &matrix, 1), &matrix).0, "the bits of a fresh factorisation");
    }
    // a matrix that is refused in between
    let mut soft = matrix.clone();
    soften(&mut soft);
    assert_eq!(kept.factorise(&soft, Symmetry::Symmetric).unwrap().method, Method::BlockLu);
    assert_eq!(solve(&mut kept, &matrix).0, solve(&mut in_parts(&bodies, &matrix, 1), &matrix).0);
}

#[test]
fn what_is_not_definite_goes_on_to_the_next_method() {
    let bodies = body(true);
    let mut matrix = bodies.matrix();
    soften(&mut matrix);
    let report = in_parts(&bodies, &matrix, 2).factorise(&matrix, Symmetry::Symmetric).unwrap();
    assert_eq!(report.method, Method::BlockLu);
    // what is soft in the cut only
    let (_, between) = cut_of(&bodies, &matrix);
    let mut matrix = bodies.matrix();
    let place = matrix.pattern().index(between[30], between[30]).unwrap();
    matrix.values[place] *= 0.1;
    let report = in_parts(&bodies, &matrix, 2).factorise(&matrix, Symmetry::Symmetric).unwrap();
    assert_eq!(report.method, Method::BlockLu);
    // a body that nothing holds
    let free = body(false);
    let matrix = free.matrix();
    let error = in_parts(&free, &matrix, 2).factorise(&matrix, Symmetry::Symmetric).unwrap_err();
    assert!(matches!(error, SolverError::Singular { .. }), "{error}");
}

#[test]
fn an_order_by_dissection_has_every_equation_once_and_less_fill() {
    // 38 720 equations: least degree alone needs an eighth more
    let mut bodies = Bodies::default();
    bodies.add(80, 80, 30.0, true);
    let matrix = bodies.matrix();
    let (pattern, size) = (matrix.pattern(), bodies.nodes.len());
    let last: Vec<usize> = (0..size).filter(|equation| equation % 1000 == 7).collect();
    let (order, _) = elimination_order(pattern, &bodies.nodes, &bodies.positions, &last).unwrap();
    let mut seen = vec![0; size];
    order.iter().for_each(|&equation| seen[equation] += 1);
    assert!(seen.iter().all(|&times| times == 1));
    assert_eq!(&order[size - last.len()..], &last, "what is to be last is");
    let [(with_places, follows_cuts), (without, follows_none)] = [&*bodies.positions, &[]].map(|positions| {
        let (order, follows_cuts) = elimination_order(pattern, &bodies.nodes, positions, &[]).unwrap();
        (cholesky_flops(pattern, &order).unwrap(), follows_cuts)
    });
    let ratio = with_places / without;
    assert!((0.7..0.92).contains(&ratio), "{ratio}");
    assert!(follows_cuts && !follows_none, "nothing is known of places without them");
}

#[test]
fn what_has_no_extent_or_no_couplings_is_ordered_too() {
    let mut bodies = Bodies::default();
    bodies.add(60, 30, 30.0, true);
    let matrix = bodies.matrix();
    let size = bodies.nodes.len();
    let is_complete = |mut order: Vec<usize>| {
        order.sort_unstable();
        order.into_iter().eq(0..size)
    };
    // all nodes in one place, or in no place at all: any cut is as good as another
    for position in [[1.0, 1.0], [f64::NAN, f64::INFINITY]] {
        let order = elimination_order(matrix.pattern(), &bodies.nodes, &vec![position; size], &[]);
        assert!(is_complete(order.unwrap().0));
    }
    let diagonal = Pattern::from_groups(size, std::iter::empty());
    let order = elimination_order(&diagonal, &bodies.nodes, &bodies.positions, &[]);
    assert!(is_complete(order.unwrap().0));
}

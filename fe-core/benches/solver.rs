//! Time of the linear solver: analysis, factorisation, contact alone, solution, by each method.
//!
//! `cargo bench -p fe-core --bench solver`. Two elastic bodies of Q8 elements, the upper held by contact alone, in
//! systems of 5 000 to 80 000 equations, with 200 and 800 contact equations. Medians, milliseconds.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use end_to_end_tests::Random;
use fe_core::element::{ElementKind, Integration, MappedPoint};
use fe_core::kinematics::PlaneModel;
use fe_core::solver::{LinearSolver, Method, Pattern, SolverOptions, Symmetry, SystemMatrix};
use grid::Bodies;
use strain_displacement::{MAX_FREEDOMS, StrainDisplacement};

#[path = "../src/solver/test/grid.rs"]
mod grid;
#[allow(dead_code, reason = "the tests use all of it")]
#[path = "../src/kinematics/test/strain_displacement.rs"]
mod strain_displacement;

const REPEATS: usize = 7;
/// Columns of elements: 201 nodes on each surface.
const COLUMNS: usize = 100;

/// Milliseconds of each repeat, the median.
fn median(repeats: usize, mut body: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..repeats)
        .map(|_| {
            let start = Instant::now();
            body();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// A system whose first nodes on both surfaces are bonded, with friction: blocks of four equations.
fn system(rows: usize, bonded: usize, friction: f64) -> (Bodies, SystemMatrix, Vec<usize>) {
    let mut bodies = Bodies::default();
    bodies.add(COLUMNS, rows, 30e3, true);
    bodies.add(COLUMNS, 2, 210e3, false);
    let mut matrix = bodies.matrix();
    // The first node of the lower surface is held.
    let (lower, upper) = (&bodies.surfaces[0][1][..2 * bonded], &bodies.surfaces[1][0][2..][..2 * bonded]);
    let (normal, tangential) = (1e6, 1e3);
    for (master, slave) in lower.chunks_exact(2).zip(upper.chunks_exact(2)) {
        let row_x = [tangential, friction * normal, -tangential, -friction * normal];
        let row_y = [0.0, normal, 0.0, -normal];
        let values = [row_x, row_y, row_x.map(|value| -value), row_y.map(|value| -value)].concat();
        matrix.contact.push(&[master[0], master[1], slave[0], slave[1]], &values);
    }
    let contact = lower.iter().chain(upper).copied().collect();
    (bodies, matrix, contact)
}

fn measure(rows: usize, bonded: usize, method: Method, repeats: usize) {
    let friction = if method == Method::Parts { 0.0 } else { 0.3 };
    let (bodies, matrix, contact) = system(rows, bonded, friction);
    // the same values each time: all of it would stay
    let options = SolverOptions { first_method: Some(method), forgets: true };
    let symmetry = if method < Method::BlockLu { Symmetry::Symmetric } else { Symmetry::Unsymmetric };
    let fresh = || LinearSolver::new(matrix.pattern(), &bodies.nodes, options);
    let first = median(repeats, || {
        black_box(fresh().factorise(&matrix, symmetry)).expect("a regular matrix");
    });
    let mut solver = fresh();
    let report = solver.factorise(&matrix, symmetry).expect("a regular matrix");
    assert_eq!(report.method, method, "no method gave way");
    let again = median(repeats, || {
        black_box(solver.factorise(&matrix, symmetry)).expect("a regular matrix");
    });
    let right_side = Random::new(1).vector(bodies.nodes.len());
    let mut refined = false;
    let solve = median(repeats, || {
        let mut x = right_side.clone();
        refined = black_box(solver.solve(&matrix, &mut x)).expect("an accurate solution").refined;
    });
    println!(
        "{:>7} {:>5} {:<10} {first:>9.1} {again:>9.1} {solve:>9.2} {:>9.2} {:>9.2} {}",
        bodies.nodes.len(),
        contact.len(),
        format!("{method:?}"),
        report.flops.unwrap_or(f64::NAN) * 1e-9,
        report.factor_entries.map_or(f64::NAN, |entries| entries as f64 * 1e-6),
        if refined { "refined" } else { "" }
    );
}

fn main() {
    // `cargo test --benches` runs this too, without `--bench`: then it only shows that it works.
    let full = std::env::args().any(|argument| argument == "--bench");
    let (rows, repeats): (&[usize], usize) = if full { (&[6, 31, 131], REPEATS) } else { (&[2], 1) };
    println!(
        "{:>7} {:>5} {:<10} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "size", "|Z|", "method", "first ms", "again ms", "solve ms", "Gflop", "M numbers"
    );
    for &rows in rows {
        for bonded in [50, 200] {
            for method in [Method::BlockLu, Method::GeneralLu] {
                measure(rows, bonded, method, repeats);
            }
        }
    }
}

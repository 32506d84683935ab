//! Everything about a factorisation that follows from the pattern: supernodes, fill, for an order of elimination.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::SymbolicSupernodalParams;
use faer::sparse::linalg::cholesky::simplicial::{
    EliminationTreeRef, prefactorize_symbolic_cholesky, prefactorize_symbolic_cholesky_scratch,
};
use faer::sparse::linalg::cholesky::supernodal;
use faer::sparse::{SymbolicSparseColMat, SymbolicSparseColMatRef};

use super::graph::NONE;
use super::pattern::accumulate;
use super::{Pattern, SolverError};

/// `equations` body by body (a body: what the pattern connects), ascending in each: eliminated in this order, the
/// equations of one body have columns of one shape.
pub(super) fn body_by_body(pattern: &Pattern, equations: &[usize]) -> Vec<usize> {
    let mut body = vec![NONE; pattern.size()];
    let mut front = Vec::new();
    for first in 0..pattern.size() {
        if body[first] != NONE {
            continue;
        }
        body[first] = first;
        front.push(first);
        while let Some(equation) = front.pop() {
            for &row in pattern.column(equation) {
                if body[row] == NONE {
                    body[row] = first;
                    front.push(row);
                }
            }
        }
    }
    let mut ordered = equations.to_vec();
    ordered.sort_by_key(|&equation| (body[equation], equation));
    ordered
}

/// Gives `use_tree` the upper triangle in the order of elimination, its elimination tree, and how many entries each
/// column of the factor has.
fn with_tree<R>(
    pattern: &Pattern,
    order: &[usize],
    places: &[usize],
    use_tree: impl FnOnce(SymbolicSparseColMatRef<'_, usize>, EliminationTreeRef<'_, usize>, &[usize]) -> R,
) -> Result<R, SolverError> {
    let size = pattern.size();
    let (upper, _) = triangle(pattern, order, places, |column, row| row <= column);
    let (mut parents, mut counts) = (vec![0; size], vec![0; size]);
    let scratch = prefactorize_symbolic_cholesky_scratch::<usize>(size, upper.row_idx().len());
    let mut memory = MemBuffer::try_new(scratch)?;
    let tree = prefactorize_symbolic_cholesky(&mut parents, &mut counts, upper.as_ref(), MemStack::new(&mut memory));
    Ok(use_tree(upper.as_ref(), tree, &counts))
}

/// The entries (column, row) that are to be kept of the matrix in the order of elimination, and where their values are
/// in the pattern.
fn triangle(
    pattern: &Pattern,
    order: &[usize],
    places: &[usize],
    keep: impl Fn(usize, usize) -> bool,
) -> (SymbolicSparseColMat<usize>, Vec<usize>) {
    let size = pattern.size();
    let (mut starts, mut rows, mut from) = (vec![0; size + 1], Vec::new(), Vec::new());
    for (column, &equation) in order.iter().enumerate() {
        let first = pattern.column_starts()[equation];
        for (offset, &row) in pattern.column(equation).iter().enumerate() {
            if keep(column, places[row]) {
                rows.push(places[row]);
                from.push(first + offset);
                starts[column + 1] += 1;
            }
        }
    }
    accumulate(&mut starts);
    (SymbolicSparseColMat::new_unsorted_checked(size, size, starts, None, rows), from)
}

/// The place of each equation in an order.
fn inverse(order: &[usize]) -> Vec<usize> {
    let mut places = vec![0; order.len()];
    order.iter().enumerate().for_each(|(place, &equation)| places[equation] = place);
    places
}

/// Multiplications and additions of LLᵀ in this order.
pub(super) fn cholesky_flops(pattern: &Pattern, order: &[usize]) -> Result<f64, SolverError> {
    with_tree(pattern, order, &inverse(order), |_, _, counts| flops(counts))
}

fn flops(counts: &[usize]) -> f64 {
    counts.iter().map(|&count| (count as f64).powi(2)).sum()
}

/// An order of elimination with all that follows from it.
#[derive(Debug)]
pub(super) struct Analysis {
    /// The equation that is eliminated as number k.
    pub order: Vec<usize>,
    /// Lower triangle of the matrix in that order, rows unsorted.
    pub lower: SymbolicSparseColMat<usize>,
    /// Index in the pattern of the value of each entry of `lower`.
    pub from: Vec<usize>,
    /// Index of the value of its mirror image.
    pub mirror_from: Vec<usize>,
    /// Index in `lower` of each diagonal entry.
    pub diagonal: Vec<usize>,
    /// Columns of one shape, and their rows. Simplicial factors are six times slower on small systems.
    pub supernodes: supernodal::SymbolicSupernodalCholesky<usize>,
    /// Multiplications and additions of LLᵀ.
    pub flops: f64,
}

impl Analysis {
    /// Makes an analysis of a pattern to be eliminated in `order`.
    pub(super) fn new(pattern: &Pattern, order: Vec<usize>) -> Result<Self, SolverError> {
        let places = inverse(&order);
        let scratch = supernodal::factorize_supernodal_symbolic_cholesky_scratch::<usize>(pattern.size());
        let mut memory = MemBuffer::try_new(scratch)?;
        let (supernodes, flops) = with_tree(pattern, &order, &places, |upper, tree, counts| {
            let parameters = SymbolicSupernodalParams::default();
            let stack = MemStack::new(&mut memory);
            let supernodes = supernodal::factorize_supernodal_symbolic_cholesky(upper, tree, counts, stack, parameters);
            (supernodes, flops(counts))
        })?;
        let (lower, from) = triangle(pattern, &order, &places, |column, row| row >= column);
        let transposed = pattern.transposed_places();
        let mirror_from = from.iter().map(|&place| transposed[place]).collect();
        let diagonal = (0..pattern.size())
            .map(|column| {
                let rows = lower.as_ref().row_idx_of_col_raw(column);
                lower.col_ptr()[column] + rows.iter().position(|&row| row == column).unwrap_or(0)
            })
            .collect();
        Ok(Self { order, mirror_from, diagonal, supernodes: supernodes?, flops, lower, from })
    }
}

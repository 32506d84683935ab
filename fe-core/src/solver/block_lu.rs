//! Sparse LU of a matrix with a symmetric pattern and unsymmetric values: the supernodes of LLᵀ, pivoting inside them.
//!
//! faer's sparse LU orders columns so that any row may become a pivot; on stiffness matrices that costs several times
//! the fill. Here rows change places inside a supernode only. That is stable as long as no pivot is small against its
//! column, which is checked; a matrix that is refused goes to faer's LU.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::prelude::Reborrow;
use faer::{Accum, MatMut, MatRef, Par, Spec};

use super::analysis::Analysis;
use super::graph::NONE;
use super::method::{Factorisation, Layout};
use super::{Pattern, SolverError, SystemMatrix, column};
use crate::threads::Threads;

/// The least pivot, relative to the greatest entry of its column before elimination.
const SMALLEST_PIVOT: f64 = 1e-8;

/// A = L U by supernodes, rows exchanged inside each.
///
/// L has of each supernode its square block, factorised, and the rows below, U has what is right of the block,
/// transposed: both by columns, one for each of the supernode's.
pub(super) struct BlockLu {
    analysis: Arc<Analysis>,
    panels: Vec<Panel>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// The values that it is the factor of, and whether it is.
    values: Vec<f64>,
    is_factor: bool,
    /// Supernodes that something below them in the tree of elimination has changed.
    changed: Vec<bool>,
    /// Multiplications and additions of the last factorisation, without supernodes that were kept.
    flops: f64,
    /// The row of its block that comes to each place.
    permutation: Vec<usize>,
    /// The greatest entry of each column of A.
    scales: Vec<f64>,
    queue: Queue,
    /// Row in the present panel of each row of the system.
    local: Vec<usize>,
    product: Vec<f64>,
    inverse: Vec<usize>,
    /// A vector in the order of elimination.
    ordered: Vec<f64>,
    /// A supernode's part of a vector, and what it adds to the rows below.
    work: Vec<f64>,
    memory: MemBuffer,
}

/// Place of a supernode in the factors.
#[derive(Clone, Copy)]
struct Panel {
    start: usize,
    columns: usize,
    /// Number of rows below its block.
    below: usize,
    /// Starts of its values in L and in U.
    lower: usize,
    upper: usize,
}

impl Panel {
    fn end(&self) -> usize {
        self.start + self.columns
    }

    fn height(&self) -> usize {
        self.columns + self.below
    }

    /// Returns the block and the rows below.
    fn lower<'a>(&self, lower: &'a [f64]) -> MatRef<'a, f64> {
        let values = &lower[self.lower..][..self.height() * self.columns];
        MatRef::from_column_major_slice(values, self.height(), self.columns)
    }

    /// Returns the part to the right of its block, transposed.
    fn upper<'a>(&self, upper: &'a [f64]) -> MatRef<'a, f64> {
        MatRef::from_column_major_slice(&upper[self.upper..][..self.below * self.columns], self.below, self.columns)
    }
}

/// Queue of earlier supernodes that the present one has to subtract: each waits at the supernode that has its next row.
struct Queue {
    heads: Vec<usize>,
    next: Vec<usize>,
    /// Number of its rows that a supernode has passed.
    passed: Vec<usize>,
    /// The supernode of each row.
    owner: Vec<usize>,
}

impl Queue {
    /// Puts a supernode into the queue of the supernode to which the first of `rows` belongs.
    fn wait(&mut self, supernode: usize, rows: &[usize]) {
        if let Some(&row) = rows.first() {
            self.next[supernode] = std::mem::replace(&mut self.heads[self.owner[row]], supernode);
        }
    }
}

impl Factorisation for BlockLu {
    fn analyse(pattern: &Pattern, layout: &Layout) -> Result<Option<Self>, SolverError> {
        Self::new(Analysis::new(pattern, layout.elimination_order(pattern)?)?).map(Some)
    }

    /// Factorises; `false` if a pivot is too small.
    ///
    /// A supernode stays as it is, to the last bit, if its own values are those of the last factorisation and nothing that
    /// it subtracts has changed: that comes from its descendants in the tree of elimination, whose next row is in their
    /// parent.
    fn factorise(&mut self, values: &[f64], _: &SystemMatrix, _: &Threads) -> Result<bool, SolverError> {
        self.set_scales(values);
        self.queue.heads.fill(NONE);
        self.queue.passed.fill(0);
        self.changed.fill(!self.is_factor);
        self.is_factor = false;
        self.flops = 0.0;
        let analysis = Arc::clone(&self.analysis);
        for index in 0..self.panels.len() {
            let panel = self.panels[index];
            let rows = analysis.supernodes.supernode(index).pattern();
            let changed = self.changed[index] || self.differs(&analysis, panel, values);
            let mut earlier = std::mem::replace(&mut self.queue.heads[index], NONE);
            if changed {
                (panel.start..panel.end()).chain(rows.iter().copied()).zip(0..).for_each(|(row, local)| {
                    self.local[row] = local;
                });
                self.assemble(&analysis, panel, values);
            }
            while earlier != NONE {
                let next = self.queue.next[earlier];
                let rows = analysis.supernodes.supernode(earlier).pattern();
                let (begin, shared) = self.pass(earlier, rows, panel);
                if changed {
                    self.subtract(earlier, &rows[begin..], (begin, shared), panel);
                }
                earlier = next;
            }
            if changed {
                if !self.eliminate(panel) {
                    return Ok(false);
                }
                if let Some(&row) = rows.first() {
                    self.changed[self.queue.owner[row]] = true;
                }
            }
            self.queue.wait(index, rows);
        }
        self.values.clear();
        self.values.extend_from_slice(values);
        self.is_factor = true;
        Ok(true)
    }

    fn solve(&mut self, right_side: &mut [f64], _: &Threads) {
        let Analysis { supernodes, order, .. } = &*self.analysis;
        let x = &mut self.ordered;
        x.iter_mut().zip(order).for_each(|(to, &equation)| *to = right_side[equation]);
        for (index, panel) in self.panels.iter().enumerate() {
            let (block, below) = panel.lower(&self.lower).split_at_row(panel.columns);
            let (own, outside) = self.work.split_at_mut(panel.columns);
            let permutation = &self.permutation[panel.start..panel.end()];
            own.iter_mut().zip(permutation).for_each(|(own, &row)| *own = x[panel.start + row]);
            let outside = &mut outside[..panel.below];
            solve_unit_lower_triangular_in_place(block, column(own), Par::Seq);
            matmul(column(outside), Accum::Replace, below, column(own).rb(), 1.0, Par::Seq);
            x[panel.start..panel.end()].copy_from_slice(own);
            supernodes.supernode(index).pattern().iter().zip(outside).for_each(|(&row, value)| x[row] -= *value);
        }
        for (index, panel) in self.panels.iter().enumerate().rev() {
            let outside = &mut self.work[..panel.below];
            outside.iter_mut().zip(supernodes.supernode(index).pattern()).for_each(|(value, &row)| *value = x[row]);
            let own = &mut x[panel.start..panel.end()];
            let upper = panel.upper(&self.upper).transpose();
            matmul(column(own), Accum::Add, upper, column(outside).rb(), -1.0, Par::Seq);
            let block = panel.lower(&self.lower).split_at_row(panel.columns).0;
            solve_upper_triangular_in_place(block, column(own), Par::Seq);
        }
        x.iter().zip(order).for_each(|(from, &equation)| right_side[equation] = *from);
    }

    fn forget(&mut self) {
        self.is_factor = false;
    }

    fn size(&self) -> Option<(f64, usize)> {
        Some((self.flops, self.lower.len() + self.upper.len()))
    }
}

impl BlockLu {
    /// Memory for a factor.
    fn new(analysis: Analysis) -> Result<Self, SolverError> {
        let supernodes = &analysis.supernodes;
        let (size, count) = (supernodes.nrows(), supernodes.n_supernodes());
        let mut panels: Vec<Panel> = Vec::with_capacity(count);
        let (mut owner, mut upper) = (vec![0; size], 0);
        for index in 0..count {
            let (start, end) = (supernodes.supernode_begin()[index], supernodes.supernode_end()[index]);
            let below = supernodes.supernode(index).pattern().len();
            let lower = supernodes.col_ptr_for_val()[index];
            panels.push(Panel { start, columns: end - start, below, lower, upper });
            owner[start..end].fill(index);
            upper += below * (end - start);
        }
        let widest = panels.iter().map(|panel| panel.columns).max().unwrap_or(0);
        let product = panels.iter().map(|panel| panel.below * widest).max().unwrap_or(0);
        Ok(Self {
            lower: vec![0.0; supernodes.len_val()],
            upper: vec![0.0; upper],
            values: Vec::new(),
            is_factor: false,
            changed: vec![true; count],
            flops: 0.0,
            permutation: vec![0; size],
            scales: vec![0.0; size],
            queue: Queue { heads: vec![NONE; count], next: vec![NONE; count], passed: vec![0; count], owner },
            local: vec![NONE; size],
            product: vec![0.0; product],
            inverse: vec![0; widest],
            work: vec![0.0; panels.iter().map(Panel::height).max().unwrap_or(0)],
            memory: MemBuffer::try_new(lu_in_place_scratch::<usize, f64>(widest, widest, Par::Seq, Spec::default()))?,
            ordered: vec![0.0; size],
            panels,
            analysis: Arc::new(analysis),
        })
    }

    /// Returns whether a value of A in a panel is another one than at the last factorisation.
    fn differs(&self, analysis: &Analysis, panel: Panel, values: &[f64]) -> bool {
        let starts = analysis.lower.col_ptr();
        let entries = starts[panel.start]..starts[panel.end()];
        let places = analysis.from[entries.clone()].iter().chain(&analysis.mirror_from[entries]);
        places.into_iter().any(|&place| values[place].to_bits() != self.values[place].to_bits())
    }

    fn set_scales(&mut self, values: &[f64]) {
        self.scales.fill(0.0);
        let (starts, rows) = (self.analysis.lower.col_ptr(), self.analysis.lower.row_idx());
        for column in 0..self.scales.len() {
            for entry in starts[column]..starts[column + 1] {
                let row = rows[entry];
                self.scales[column] = self.scales[column].max(values[self.analysis.from[entry]].abs());
                self.scales[row] = self.scales[row].max(values[self.analysis.mirror_from[entry]].abs());
            }
        }
    }

    /// Writes A into a panel.
    fn assemble(&mut self, analysis: &Analysis, panel: Panel, values: &[f64]) {
        let (starts, rows) = (analysis.lower.col_ptr(), analysis.lower.row_idx());
        self.lower[panel.lower..][..panel.height() * panel.columns].fill(0.0);
        self.upper[panel.upper..][..panel.below * panel.columns].fill(0.0);
        for column in panel.start..panel.end() {
            let place = column - panel.start;
            for entry in starts[column]..starts[column + 1] {
                let local = self.local[rows[entry]];
                let mirrored = values[analysis.mirror_from[entry]];
                // The diagonal is written twice, and is its own mirror image.
                self.lower[panel.lower + place * panel.height() + local] = values[analysis.from[entry]];
                if local < panel.columns {
                    self.lower[panel.lower + local * panel.height() + place] = mirrored;
                } else {
                    self.upper[panel.upper + place * panel.below + local - panel.columns] = mirrored;
                }
            }
        }
    }

    /// Takes an earlier supernode with these rows past a panel: the first of its rows that the panel has, and how many.
    fn pass(&mut self, earlier: usize, rows: &[usize], panel: Panel) -> (usize, usize) {
        let begin = self.queue.passed[earlier];
        let shared = rows[begin..].partition_point(|&row| row < panel.end());
        self.queue.passed[earlier] = begin + shared;
        self.queue.wait(earlier, &rows[begin + shared..]);
        (begin, shared)
    }

    /// Subtracts what the elimination of an earlier supernode takes from a panel: `rows` are those from `begin` on, the
    /// first `shared` of them are the panel's.
    fn subtract(&mut self, earlier: usize, rows: &[usize], (begin, shared): (usize, usize), panel: Panel) {
        let from = self.panels[earlier];
        self.flops += (2 * from.columns * shared * (2 * rows.len() - shared)) as f64;

        let (before, present) = self.lower.split_at_mut(panel.lower);
        let lower = from.lower(before).split_at_row(from.columns + begin).1;
        let (upper_before, upper_present) = self.upper.split_at_mut(panel.upper);
        let upper = from.upper(upper_before).split_at_row(begin).1;

        let product = &mut self.product[..rows.len() * shared];
        multiply(product, lower, upper.subrows(0, shared));
        let locals = |row: &usize| self.local[*row];
        for (column, values) in rows[..shared].iter().zip(product.chunks_exact(rows.len())) {
            let target = &mut present[(column - panel.start) * panel.height()..];
            rows.iter().zip(values).for_each(|(row, value)| target[locals(row)] -= value);
        }
        let rest = &rows[shared..];
        if rest.is_empty() {
            return;
        }
        let product = &mut self.product[..rest.len() * shared];
        multiply(product, upper.split_at_row(shared).1, lower.subrows(0, shared));
        for (column, values) in rows[..shared].iter().zip(product.chunks_exact(rest.len())) {
            let target = &mut upper_present[(column - panel.start) * panel.below..];
            rest.iter().zip(values).for_each(|(row, value)| target[locals(row) - panel.columns] -= value);
        }
    }

    /// Factorises the block of a panel and divides the rest by it; `false` if a pivot is too small.
    fn eliminate(&mut self, panel: Panel) -> bool {
        let (columns, below) = (panel.columns as f64, panel.below as f64);
        self.flops += columns * columns * (2.0 / 3.0 * columns + 2.0 * below);
        let values = &mut self.lower[panel.lower..][..panel.height() * panel.columns];
        let lower = MatMut::from_column_major_slice_mut(values, panel.height(), panel.columns);
        let (mut block, below) = lower.split_at_row_mut(panel.columns);
        let permutation = &mut self.permutation[panel.start..panel.end()];
        let (info, _) = lu_in_place(
            block.as_mut(),
            permutation,
            &mut self.inverse[..panel.columns],
            Par::Seq,
            MemStack::new(&mut self.memory),
            Spec::default(),
        );
        for (column, scale) in self.scales[panel.start..panel.end()].iter().enumerate() {
            let pivot = block[(column, column)];
            if pivot.is_nan() || pivot.abs() <= SMALLEST_PIVOT * scale {
                return false;
            }
        }
        solve_lower_triangular_in_place(block.as_ref().transpose(), below.transpose_mut(), Par::Seq);
        let upper = &mut self.upper[panel.upper..][..panel.below * panel.columns];
        if info.transposition_count > 0 && panel.below > 0 {
            let copy = &mut self.product[..upper.len()];
            copy.copy_from_slice(upper);
            for (target, &source) in upper.chunks_exact_mut(panel.below).zip(&*permutation) {
                target.copy_from_slice(&copy[source * panel.below..][..panel.below]);
            }
        }
        let upper = MatMut::from_column_major_slice_mut(upper, panel.below, panel.columns);
        solve_unit_lower_triangular_in_place(block.as_ref(), upper.transpose_mut(), Par::Seq);
        true
    }
}

/// product = left rightᵀ.
fn multiply(product: &mut [f64], left: MatRef<'_, f64>, right: MatRef<'_, f64>) {
    let product = MatMut::from_column_major_slice_mut(product, left.nrows(), right.nrows());
    matmul(product, Accum::Replace, left, right.transpose(), 1.0, Par::Seq);
}

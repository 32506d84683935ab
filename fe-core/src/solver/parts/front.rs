//! Two parts joined at their cut: a front, dense on the cut and the border.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, Mat, MatMut, MatRef, Par, Spec};

use super::{Elimination, Substructure};
use crate::solver::graph::NONE;
use crate::solver::zone::dense_cholesky_flops;
use crate::solver::{Pattern, SINGULAR_PIVOT, SolverError, column};
use crate::threads::Threads;

pub(super) struct Front {
    parts: [Box<dyn Substructure>; 2],
    /// The equations of the cut and of the border in the system, ascending each; in this order they are in F.
    equations: Vec<usize>,
    cut: usize,
    places: [Places; 2],
    /// Entries that the leaves do not contain exactly once.
    own: Vec<Own>,
    /// F, then L_CC, W and S: the lower triangle.
    matrix: Mat<f64>,
    /// Whether the factor is that of the parts as they are.
    is_factorised: bool,
    x: Vec<f64>,
    memory: MemBuffer,
}

/// The place in F of each equation of a part's border.
struct Places {
    all: Vec<usize>,
    /// Those in the cut, and those in the border of the front: number among `all` and place, ascending.
    in_cut: Vec<[usize; 2]>,
    in_border: Vec<[usize; 2]>,
}

impl Places {
    fn new(all: Vec<usize>, cut: usize) -> Self {
        let pairs = all.iter().enumerate().map(|(number, &place)| [number, place]);
        let (in_cut, in_border) = pairs.partition(|[_, place]| *place < cut);
        Self { all, in_cut, in_border }
    }
}

/// An entry of A between equations of a front.
struct Own {
    /// Place in the pattern.
    from: usize,
    row: usize,
    column: usize,
    /// 1 less the number of leaves that contain it.
    times: f64,
    value: f64,
}

impl Front {
    /// Joins two parts at the equations of a cut, ascending. `is_inside` returns whether an equation is in the parts or
    /// the cut.
    pub(super) fn new(
        pattern: &Pattern,
        parts: [Box<dyn Substructure>; 2],
        cut: &[usize],
        is_inside: impl Fn(usize) -> bool,
    ) -> Result<Self, SolverError> {
        let coupled = cut.iter().flat_map(|&equation| pattern.column(equation)).copied();
        let of_parts = parts.iter().flat_map(|part| part.border()).copied();
        let mut border: Vec<usize> = coupled.chain(of_parts).filter(|&equation| !is_inside(equation)).collect();
        border.sort_unstable();
        border.dedup();
        let equations = [cut, &border].concat();
        let mut place_of = vec![NONE; pattern.size()];
        equations.iter().enumerate().for_each(|(place, &equation)| place_of[equation] = place);
        let places = parts
            .each_ref()
            .map(|part| Places::new(part.border().iter().map(|&equation| place_of[equation]).collect(), cut.len()));
        let own = own_entries(pattern, &parts, cut, &place_of, equations.len());
        let size = equations.len();
        let memory = cholesky_in_place_scratch::<f64>(cut.len(), Par::Seq, Spec::default());
        Ok(Self {
            parts,
            cut: cut.len(),
            equations,
            places,
            own,
            matrix: Mat::zeros(size, size),
            is_factorised: false,
            x: vec![0.0; size],
            memory: MemBuffer::try_new(memory)?,
        })
    }

    /// Assembles F and eliminates the cut; `false` if it is not definite.
    fn eliminate(&mut self, threads: &Threads) -> bool {
        self.assemble(threads);
        let scales: Vec<f64> = (0..self.cut).map(|place| self.matrix[(place, place)]).collect();
        let (mut of_cut, _, coupling, schur) = self.matrix.as_mut().split_at_mut(self.cut, self.cut);
        let factorised = cholesky_in_place(
            of_cut.rb_mut(),
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut self.memory),
            Spec::default(),
        );
        let is_sound = |(place, scale): (usize, &f64)| of_cut[(place, place)].powi(2) > SINGULAR_PIVOT * scale;
        if factorised.is_err() || !scales.iter().enumerate().all(is_sound) {
            return false;
        }
        // The border in two pieces, whatever the threads are: S_11 and S_22 take as long as S_21.
        let half = coupling.nrows() / 2;
        let of_cut = of_cut.rb();
        let (mut first, mut second) = coupling.split_at_row_mut(half);
        threads.join(
            || solve_lower_triangular_in_place(of_cut, first.rb_mut().transpose_mut(), Par::Seq),
            || solve_lower_triangular_in_place(of_cut, second.rb_mut().transpose_mut(), Par::Seq),
        );
        let (first, second) = (first.rb(), second.rb());
        let (of_first, _, between, of_second) = schur.split_at_mut(half, half);
        threads.join(
            || {
                subtract_square(of_first, first);
                subtract_square(of_second, second);
            },
            || matmul(between, Accum::Add, second, first.transpose(), -1.0, Par::Seq),
        );
        true
    }

    /// F, its lower triangle.
    fn assemble(&mut self, threads: &Threads) {
        let (cut, own, places) = (self.cut, &self.own, &self.places);
        let schurs = self.parts.each_ref().map(|part| part.schur());
        let (mut of_cut, of_border) = self.matrix.as_mut().split_at_col_mut(cut);
        let (_, mut of_border) = of_border.split_at_row_mut(cut);
        let of_cut_columns = || {
            clear_lower(of_cut.rb_mut());
            own.iter().for_each(|own| of_cut[(own.row, own.column)] += own.times * own.value);
            for (schur, Places { in_cut, in_border, .. }) in schurs.iter().zip(places) {
                for (k, &[column, to_column]) in in_cut.iter().enumerate() {
                    in_cut[k..].iter().for_each(|&[row, to]| of_cut[(to, to_column)] += schur[(row, column)]);
                    for &[row, to] in in_border {
                        of_cut[(to, to_column)] += schur[(row.max(column), row.min(column))];
                    }
                }
            }
        };
        let of_border_columns = || {
            clear_lower(of_border.rb_mut());
            for (schur, Places { in_border, .. }) in schurs.iter().zip(places) {
                for (k, &[column, to_column]) in in_border.iter().enumerate() {
                    for &[row, to] in &in_border[k..] {
                        of_border[(to - cut, to_column - cut)] += schur[(row, column)];
                    }
                }
            }
        };
        threads.join(of_cut_columns, of_border_columns);
    }

    /// Returns the flops of the elimination of the cut.
    fn flops(&self) -> f64 {
        let (cut, border) = (self.cut as f64, self.border().len() as f64);
        dense_cholesky_flops(self.cut) + cut * border * (cut + border)
    }
}

impl Substructure for Front {
    fn border(&self) -> &[usize] {
        &self.equations[self.cut..]
    }

    fn each_leaf(&self, give: &mut dyn FnMut(&[usize])) {
        self.parts.iter().for_each(|part| part.each_leaf(give));
    }

    fn forget(&mut self) {
        self.is_factorised = false;
        self.parts.iter_mut().for_each(|part| part.forget());
    }

    fn factorise(&mut self, values: &[f64], threads: &Threads) -> Elimination {
        let [first, second] = &mut self.parts;
        let (first, second) = threads.join(|| first.factorise(values, threads), || second.factorise(values, threads));
        let parts = first.and(second);
        let mut is_same = self.is_factorised && parts == Elimination::Unchanged;
        for own in &mut self.own {
            is_same &= own.value.to_bits() == values[own.from].to_bits();
            own.value = values[own.from];
        }
        if is_same {
            return Elimination::Unchanged;
        }
        self.is_factorised = parts != Elimination::Refused && self.eliminate(threads);
        if self.is_factorised { parts.and(Elimination::Done(self.flops())) } else { Elimination::Refused }
    }

    fn schur(&self) -> MatRef<'_, f64> {
        let border = self.border().len();
        self.matrix.as_ref().submatrix(self.cut, self.cut, border, border)
    }

    fn forward(&mut self, right_side: &[f64], threads: &Threads) {
        let [first, second] = &mut self.parts;
        threads.join(|| first.forward(right_side, threads), || second.forward(right_side, threads));
        let (in_cut, in_border) = self.x.split_at_mut(self.cut);
        in_cut.iter_mut().zip(&self.equations).for_each(|(value, &equation)| *value = right_side[equation]);
        in_border.fill(0.0);
        for (part, places) in self.parts.iter().zip(&self.places) {
            places.all.iter().zip(part.border_part()).for_each(|(&place, value)| self.x[place] += value);
        }
        let (of_cut, _, coupling, _) = self.matrix.as_ref().split_at(self.cut, self.cut);
        let (in_cut, in_border) = self.x.split_at_mut(self.cut);
        solve_lower_triangular_in_place(of_cut, column(in_cut), Par::Seq);
        matmul(column(in_border), Accum::Add, coupling, column(in_cut).rb(), -1.0, Par::Seq);
    }

    fn border_part(&self) -> &[f64] {
        &self.x[self.cut..]
    }

    fn backward(&mut self, x: &[f64], places: &[usize], threads: &Threads) {
        let (in_cut, in_border) = self.x.split_at_mut(self.cut);
        in_border.iter_mut().zip(places).for_each(|(value, &place)| *value = x[place]);
        let (of_cut, _, coupling, _) = self.matrix.as_ref().split_at(self.cut, self.cut);
        matmul(column(in_cut), Accum::Add, coupling.transpose(), column(in_border).rb(), -1.0, Par::Seq);
        solve_upper_triangular_in_place(of_cut.transpose(), column(in_cut), Par::Seq);
        let ([first, second], [at_first, at_second], x) = (&mut self.parts, &self.places, &self.x);
        threads.join(|| first.backward(x, &at_first.all, threads), || second.backward(x, &at_second.all, threads));
    }

    fn collect(&self, x: &mut [f64]) {
        self.parts.iter().for_each(|part| part.collect(x));
        self.equations[..self.cut].iter().zip(&self.x).for_each(|(&equation, value)| x[equation] = *value);
    }

    fn entries(&self) -> usize {
        self.parts.iter().map(|part| part.entries()).sum::<usize>() + self.equations.len() * self.cut
    }
}

/// The diagonal and what is below it.
fn clear_lower(mut matrix: MatMut<'_, f64>) {
    let size = matrix.nrows();
    for (column, entries) in matrix.rb_mut().col_iter_mut().enumerate() {
        entries.subrows_mut(column, size - column).fill(0.0);
    }
}

/// S ← S − W Wᵀ, the lower triangle.
fn subtract_square(schur: MatMut<'_, f64>, coupling: MatRef<'_, f64>) {
    triangular::matmul(
        schur,
        BlockStructure::TriangularLower,
        Accum::Add,
        coupling,
        BlockStructure::Rectangular,
        coupling.transpose(),
        BlockStructure::Rectangular,
        -1.0,
        Par::Seq,
    );
}

/// Entries of the lower triangle between the cut and all of a front, that not just one of the leaves has.
fn own_entries(
    pattern: &Pattern,
    parts: &[Box<dyn Substructure>; 2],
    cut: &[usize],
    place_of: &[usize],
    size: usize,
) -> Vec<Own> {
    let (mut leaves_at, mut count) = (vec![Vec::new(); size], 0_usize);
    for part in parts {
        part.each_leaf(&mut |leaf| {
            let places = leaf.iter().map(|&equation| place_of[equation]);
            places.filter(|&place| place != NONE).for_each(|place| leaves_at[place].push(count));
            count += 1;
        });
    }
    let mut own = Vec::new();
    for (column, &equation) in cut.iter().enumerate() {
        for (offset, &row) in pattern.column(equation).iter().enumerate() {
            let row = place_of[row];
            if row == NONE || row < column {
                continue;
            }
            let times = leaves_at[row].iter().filter(|leaf| leaves_at[column].contains(leaf)).count();
            if times != 1 {
                let from = pattern.column_starts()[equation] + offset;
                own.push(Own { from, row, column, times: 1.0 - times as f64, value: 0.0 });
            }
        }
    }
    own
}

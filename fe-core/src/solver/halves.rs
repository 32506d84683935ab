//! Sparse LLᵀ of a definite matrix in two halves, which two threads factorise at the same time.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltParams, LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::cholesky::llt::solve::solve_in_place;
use faer::{Mat, MatMut, Par, Spec};

use super::cut::{Cut, cut};
use super::graph::{NONE, NodeGraph};
use super::zone::{Zone, dense_cholesky_flops};
use super::{Pattern, SINGULAR_PIVOT, SolverError};
use crate::threads::Threads;

/// Fewer equations are factorised in one piece: a few milliseconds.
const LEAST_EQUATIONS: usize = 10_000;

/// The most that the cut may cost, relative to the halves: one thread does it while the other waits.
const LARGEST_CUT: f64 = 0.2;

/// A cut Z separates the equations I into two halves that A does not couple:
///
/// ```text
/// S   = A_ZZ − Σ A_Zi A_ii⁻¹ A_iZ            i = 1, 2: each from a factor of the half with its part of Z last
/// x_Z = S⁻¹ (b_Z − Σ A_Zi A_ii⁻¹ b_i)        S = L Lᵀ, dense
/// x_i = A_ii⁻¹ (b_i − A_iZ x_Z)
/// ```
///
/// Both halves take A_ZZ with them, which leaves each definite if A is; what is counted twice is taken off S.
/// Where the cut is follows from the pattern alone, so the number of threads changes no bit.
pub(super) struct Halves {
    halves: [Half; 2],
    between: Vec<usize>,
    /// A_ZZ: place of the value, row and column in the cut, and how many times less than once the halves have it.
    own: Vec<(usize, usize, usize, f64)>,
    /// S, then L.
    schur: Mat<f64>,
    right_side: Vec<f64>,
    memory: MemBuffer,
}

/// A half, and the equations of the cut that it is coupled with.
struct Half {
    /// Its equations in the system, ascending.
    equations: Vec<usize>,
    /// Where the values of its matrix are among those of the system.
    from: Vec<usize>,
    values: Vec<f64>,
    zone: Zone,
    /// The place in the cut of each equation of the zone.
    border: Vec<usize>,
    x: Vec<f64>,
    ordered: Vec<f64>,
}

impl Halves {
    /// Cuts a pattern; `None` if it is small, or the cut too long. `nodes` and `positions` are those of each equation.
    pub(super) fn new(pattern: &Pattern, nodes: &[usize], positions: &[[f64; 2]]) -> Result<Option<Self>, SolverError> {
        if pattern.size() < LEAST_EQUATIONS || positions.len() != pattern.size() {
            return Ok(None);
        }
        let graph = NodeGraph::new(pattern, nodes, &[]);
        let Some(Cut { halves, between }) = cut(&graph.graph, &graph.positions(positions)) else { return Ok(None) };
        let [first, second] = halves.map(|half| graph.all_equations(&half));
        let between = graph.all_equations(&between);
        let mut places = vec![NONE; pattern.size()];
        between.iter().enumerate().for_each(|(place, &equation)| places[equation] = place);
        let half = |equations: &[usize]| Half::new(pattern, nodes, positions, equations, &places);
        let halves = [half(&first)?, half(&second)?];
        let size = between.len();
        let inside: f64 = halves.iter().map(|half| half.zone.flops()).sum();
        if dense_cholesky_flops(size) + halves.iter().map(|half| dense_cholesky_flops(half.zone.len())).sum::<f64>()
            > LARGEST_CUT * inside
        {
            return Ok(None);
        }
        let touched = halves.each_ref().map(|half| {
            let mut touched = vec![false; size];
            half.border.iter().for_each(|&place| touched[place] = true);
            touched
        });
        let mut own = Vec::new();
        for (column, &equation) in between.iter().enumerate() {
            for (offset, &row) in pattern.column(equation).iter().enumerate().filter(|(_, row)| places[**row] != NONE) {
                let row = places[row];
                let times = touched.iter().filter(|touched| touched[row] && touched[column]).count();
                if times != 1 {
                    own.push((pattern.column_starts()[equation] + offset, row, column, 1.0 - times as f64));
                }
            }
        }
        Ok(Some(Self {
            halves,
            own,
            schur: Mat::zeros(size, size),
            right_side: vec![0.0; size],
            memory: MemBuffer::try_new(cholesky_in_place_scratch::<f64>(size, Par::Seq, parameters()))?,
            between,
        }))
    }

    /// Factorises; `false` if the matrix is not definite.
    pub(super) fn factorise(&mut self, values: &[f64], threads: &Threads) -> bool {
        let [first, second] = &mut self.halves;
        let (first, second) = threads.join(|| first.factorise(values), || second.factorise(values));
        if !(first && second) {
            return false;
        }
        self.schur.fill(0.0);
        for &(from, row, column, times) in &self.own {
            self.schur[(row, column)] += times * values[from];
        }
        for half in &self.halves {
            let schur = half.zone.schur();
            for (column, &target) in half.border.iter().enumerate() {
                for (row, &place) in half.border.iter().enumerate() {
                    self.schur[(place, target)] += schur[(row, column)];
                }
            }
        }
        let scales: Vec<f64> = (0..self.between.len()).map(|place| self.schur[(place, place)]).collect();
        let factorised = cholesky_in_place(
            self.schur.as_mut(),
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut self.memory),
            parameters(),
        );
        let is_sound = |(place, scale): (usize, &f64)| self.schur[(place, place)].powi(2) > SINGULAR_PIVOT * scale;
        factorised.is_ok() && scales.iter().enumerate().all(is_sound)
    }

    /// Solves in place.
    pub(super) fn solve(&mut self, x: &mut [f64], threads: &Threads) {
        let [first, second] = &mut self.halves;
        threads.join(|| first.forward(x), || second.forward(x));
        self.right_side.iter_mut().zip(&self.between).for_each(|(value, &equation)| *value = x[equation]);
        for half in &self.halves {
            half.border.iter().zip(half.zone_part()).for_each(|(&place, value)| self.right_side[place] += value);
        }
        let size = self.between.len();
        let cut = MatMut::from_column_major_slice_mut(&mut self.right_side, size, 1);
        solve_in_place(self.schur.as_ref(), cut, Par::Seq, MemStack::new(&mut self.memory));
        let ([first, second], solution) = (&mut self.halves, &self.right_side);
        threads.join(|| first.backward(solution), || second.backward(solution));
        // both know their part of the cut, to other bits than the cut itself
        for half in &self.halves {
            half.equations.iter().zip(&half.x).for_each(|(&equation, value)| x[equation] = *value);
        }
        self.between.iter().zip(&self.right_side).for_each(|(&equation, value)| x[equation] = *value);
    }

    /// Multiplications and additions of a factorisation.
    pub(super) fn flops(&self) -> f64 {
        self.halves.iter().map(|half| half.zone.flops()).sum::<f64>() + dense_cholesky_flops(self.between.len())
    }

    /// How many numbers the factors have.
    pub(super) fn entries(&self) -> usize {
        self.halves.iter().map(|half| half.zone.entries()).sum::<usize>() + self.between.len().pow(2)
    }
}

impl Half {
    /// The half of these equations; `places` has the place in the cut of its equations.
    fn new(
        pattern: &Pattern,
        nodes: &[usize],
        positions: &[[f64; 2]],
        inside: &[usize],
        places: &[usize],
    ) -> Result<Self, SolverError> {
        let mut is_border = vec![false; pattern.size()];
        for &equation in inside {
            pattern.column(equation).iter().filter(|row| places[**row] != NONE).for_each(|&row| is_border[row] = true);
        }
        let border = (0..pattern.size()).filter(|&equation| is_border[equation]);
        let mut equations: Vec<usize> = inside.iter().copied().chain(border).collect();
        equations.sort_unstable();
        let (own, from) = pattern.restricted_to(&equations);
        let own_nodes: Vec<usize> = equations.iter().map(|&equation| nodes[equation]).collect();
        let last: Vec<usize> = (0..equations.len()).filter(|&k| is_border[equations[k]]).collect();
        let own_positions: Vec<[f64; 2]> = equations.iter().map(|&equation| positions[equation]).collect();
        let zone = Zone::new(&own, &own_nodes, &own_positions, &last)?;
        let mut border = vec![NONE; last.len()];
        last.iter().for_each(|&k| border[zone.place_of(k)] = places[equations[k]]);
        let size = equations.len();
        Ok(Self {
            values: vec![0.0; from.len()],
            from,
            zone,
            border,
            x: vec![0.0; size],
            ordered: vec![0.0; size],
            equations,
        })
    }

    /// `false` if it is not definite.
    fn factorise(&mut self, values: &[f64]) -> bool {
        self.values.iter_mut().zip(&self.from).for_each(|(value, &from)| *value = values[from]);
        self.zone.condense(&self.values).is_ok()
    }

    fn zone_part(&self) -> &[f64] {
        &self.ordered[self.ordered.len() - self.border.len()..]
    }

    /// L⁻¹ b_i, and −A_Zi A_ii⁻¹ b_i in the zone.
    fn forward(&mut self, right_side: &[f64]) {
        self.x.iter_mut().zip(&self.equations).for_each(|(value, &equation)| *value = right_side[equation]);
        self.zone.gather(&self.x, &mut self.ordered);
        let first = self.ordered.len() - self.border.len();
        self.ordered[first..].fill(0.0);
        self.zone.forward(&mut self.ordered);
    }

    /// x_i from the solution in the cut.
    fn backward(&mut self, cut: &[f64]) {
        let first = self.ordered.len() - self.border.len();
        self.ordered[first..].iter_mut().zip(&self.border).for_each(|(value, &place)| *value = cut[place]);
        self.zone.backward(&mut self.ordered);
        self.zone.scatter(&self.ordered, &mut self.x);
    }
}

fn parameters() -> Spec<LltParams, f64> {
    Spec::default()
}

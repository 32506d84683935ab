//! Sparse LLᵀ of a definite matrix by parts, which threads share, and which stay as they are if their values do.

mod front;
mod leaf;
mod plan;

use faer::MatRef;

use super::method::{Factorisation, Layout};
use super::{Pattern, SolverError, SystemMatrix};
use crate::threads::Threads;

/// Fewer equations are factorised in one piece: a few milliseconds.
const LEAST_EQUATIONS: usize = 10_000;

/// The equations I of a part, and B, its border: those of others that it is coupled with. With nothing in I left,
///
/// ```text
/// S = A_BB − A_BI A_II⁻¹ A_IB
/// ```
///
/// A leaf finds it from a sparse factor with B last. What was cut in two parts has the cut C between them, and
///
/// ```text
/// F   = A + Σ S_part                          on C and B, dense
/// S   = F_BB − W Wᵀ      W = F_BC L_CC⁻ᵀ      F_CC = L_CC L_CCᵀ
/// ```
///
/// This is the multifrontal method (Duff and Reid 1983) on a nested dissection (George 1973). Each leaf has the entries
/// of A between the equations of its border, which leaves it definite if A is; what is counted twice is taken off F.
/// The cuts follow from the pattern and the positions alone, and the same values give the same S: neither
/// the number of threads nor parts that are kept change a bit.
pub(super) struct Parts {
    root: Box<dyn Substructure>,
    /// Multiplications and additions of the last factorisation, without parts that were kept.
    flops: f64,
}

/// Outcome of the elimination of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Elimination {
    /// Values are those of the last time.
    Unchanged,
    /// Definite; the number of multiplications and additions that it took.
    Done(f64),
    /// Not definite.
    Refused,
}

impl Elimination {
    /// Joins what was done in two parts.
    fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Refused, _) | (_, Self::Refused) => Self::Refused,
            (Self::Unchanged, done) | (done, Self::Unchanged) => done,
            (Self::Done(one), Self::Done(other)) => Self::Done(one + other),
        }
    }
}

/// Substructure of the system: a leaf, or a front that joins two substructures.
trait Substructure: Send + Sync {
    /// Returns the border in the system, ascending.
    fn border(&self) -> &[usize];

    /// Gives the borders of all of its leaves.
    fn each_leaf(&self, give: &mut dyn FnMut(&[usize]));

    fn factorise(&mut self, values: &[f64], threads: &Threads) -> Elimination;

    /// Discards the factor.
    fn forget(&mut self);

    /// S, its lower triangle: rows and columns of the border, ascending.
    fn schur(&self) -> MatRef<'_, f64>;

    /// Reduces a right side; [`Self::border_part`] then has −A_BI A_II⁻¹ b_I.
    fn forward(&mut self, right_side: &[f64], threads: &Threads);

    fn border_part(&self) -> &[f64];

    /// x_I from x_B, which is at these places of `x`.
    fn backward(&mut self, x: &[f64], places: &[usize], threads: &Threads);

    /// Writes x_I.
    fn collect(&self, x: &mut [f64]);

    /// Returns how many numbers the factor has.
    fn entries(&self) -> usize;
}

impl Factorisation for Parts {
    fn applies(is_symmetric: bool) -> bool {
        is_symmetric
    }

    /// Cuts a pattern; `None` if it is small, or cannot be cut where few nodes are.
    fn analyse(pattern: &Pattern, layout: &Layout) -> Result<Option<Self>, SolverError> {
        let Layout { nodes, positions, threads, .. } = layout;
        if pattern.size() < LEAST_EQUATIONS || positions.len() != pattern.size() {
            return Ok(None);
        }
        Ok(plan::plan(pattern, nodes, positions, threads)?.map(|root| Self { root, flops: 0.0 }))
    }

    fn factorise(&mut self, values: &[f64], _: &SystemMatrix, threads: &Threads) -> Result<bool, SolverError> {
        let elimination = self.root.factorise(values, threads);
        self.flops = if let Elimination::Done(flops) = elimination { flops } else { 0.0 };
        Ok(elimination != Elimination::Refused)
    }

    fn solve(&mut self, x: &mut [f64], threads: &Threads) {
        self.root.forward(x, threads);
        // the whole has no border
        self.root.backward(&[], &[], threads);
        self.root.collect(x);
    }

    fn forget(&mut self) {
        self.root.forget();
    }

    fn size(&self) -> Option<(f64, usize)> {
        Some((self.flops, self.root.entries()))
    }
}

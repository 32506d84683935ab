#![doc = include_str!("doc.md")]

mod analysis;
mod block_lu;
mod blocks;
mod cholesky;
mod condensation;
mod cut;
mod error;
mod general_lu;
mod graph;
mod linear;
mod method;
mod ordering;
mod parts;
mod pattern;
mod whole;
mod zone;

use faer::MatMut;
use method::{Analysed, Factorisation, Layout, methods};

pub use blocks::Blocks;
pub use condensation::Superelement;
pub use error::SolverError;
pub use linear::LinearSolver;
pub use pattern::{Pattern, SystemMatrix};

#[cfg(test)]
mod test;

/// A solution that leaves more of the right side than this is refined: a well-conditioned system leaves 1e-12.
pub const REFINED_RESIDUAL: f64 = 1e-10;

/// A solution that leaves more of the right side than this is an error: two orders below the usual tolerance on the
/// residual force.
pub const ACCEPTED_RESIDUAL: f64 = 1e-8;

/// Residual due to rounding alone, relative to ‖K‖ ‖x‖: products in a row of some thirty entries, each to 1e-16. With a
/// soft mode next to a stiff contact it may exceed the tolerances, and no solver leaves less. Such a solution is
/// refined only above this, and accepted up to [`ROUNDING_MARGIN`] times this.
pub const ROUNDING: f64 = 1e-15;

/// Accepted residual of a solution over [`ROUNDING`]: it has the rounding of its factors too.
pub const ROUNDING_MARGIN: f64 = 10.0;

/// Largest residual that is accepted because of [`ROUNDING`]: with one digit or two a solution is useless.
pub const LARGEST_RESIDUAL: f64 = 1e-4;

/// A pivot of this size, relative to the entry that it is left over from, is rounding: elimination loses about one
/// unit of 1e-16 in each of the hundreds of updates of an entry.
const SINGULAR_PIVOT: f64 = 1e-13;

/// A matrix whose norm times that of its inverse is greater than this is singular.
const LARGEST_GROWTH: f64 = 1.0 / SINGULAR_PIVOT;

/// Entries of a contact block that differ from their mirror images by less than this, relative to its greatest, are
/// symmetric: a block is a sum of a few products.
const SYMMETRIC_BLOCK: f64 = 1e-13;

/// Symmetry of the values of the solids. The caller who computed them states it for each factorisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Symmetry {
    /// Symmetric up to rounding: one triangle is read.
    Symmetric,
    /// Perhaps not symmetric.
    Unsymmetric,
}

// another one is a file with its `Factorisation`, and a row here
methods! {
    /// LLᵀ in parts.
    Parts = parts::Parts,
    /// LU, pivoting inside supernodes.
    BlockLu = block_lu::BlockLu,
    /// LU, full partial pivoting.
    GeneralLu = general_lu::GeneralLu,
}

/// A vector as a matrix of one column.
fn column(values: &mut [f64]) -> MatMut<'_, f64> {
    let length = values.len();
    MatMut::from_column_major_slice_mut(values, length, 1)
}

/// Options of a solver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SolverOptions {
    /// The first method to try wherever it applies; `None`: chosen by the number of operations.
    pub first_method: Option<Method>,
    /// Whether all of a factor is computed anew each time, also what would come out the same.
    pub forgets: bool,
}

/// Report on a factorisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FactorisationReport {
    /// The method that succeeded.
    pub method: Method,
    /// Whether an earlier analysis of the pattern served again.
    pub symbolic_reused: bool,
    /// Multiplications and additions, if the method knows.
    pub flops: Option<f64>,
    /// Numbers in the factors, if the method knows.
    pub factor_entries: Option<usize>,
}

/// Accuracy of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveReport {
    /// Residual relative to the right side: greatest entry over greatest entry.
    pub relative_residual: f64,
    /// Whether it was refined.
    pub refined: bool,
}

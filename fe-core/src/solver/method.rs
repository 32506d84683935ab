//! Methods of factorisation: what a method does, and how the list of them is made.

use std::sync::{Arc, OnceLock};

use super::ordering::elimination_order;
use super::{Pattern, SolverError, SystemMatrix};
use crate::threads::Threads;

/// What is known of the equations beyond the pattern of their matrix.
#[derive(Clone)]
pub(super) struct Layout {
    /// Pattern of the solids alone.
    pub(super) solids: Arc<Pattern>,
    /// Node of each equation.
    pub(super) nodes: Vec<usize>,
    /// Positions of each equation, if known.
    pub(super) positions: Vec<[f64; 2]>,
    /// Whether the solids alone fill less along cuts: found once, contact changes the pattern too often.
    is_dissected: OnceLock<bool>,
    pub(super) threads: Threads,
}

impl Layout {
    pub(super) fn new(solids: &Arc<Pattern>, nodes: &[usize]) -> Self {
        let (nodes, positions) = (nodes.to_vec(), Vec::new());
        let (solids, is_dissected, threads) = (Arc::clone(solids), OnceLock::new(), Threads::default());
        Self { solids, nodes, positions, is_dissected, threads }
    }

    /// Returns the order of elimination of a pattern, along cuts if those suit the solids.
    pub(super) fn elimination_order(&self, pattern: &Pattern) -> Result<Vec<usize>, SolverError> {
        let order = |pattern: &Pattern, positions| elimination_order(pattern, &self.nodes, positions, &[]);
        let is_dissected = match self.is_dissected.get() {
            Some(known) => *known,
            None => {
                let (_, follows_cuts) = order(&self.solids, &self.positions)?;
                *self.is_dissected.get_or_init(|| follows_cuts)
            }
        };
        Ok(order(pattern, if is_dissected { &self.positions } else { &[] })?.0)
    }
}

/// The factorisation of matrices over one pattern.
pub(super) trait Factorisation: Send + Sync {
    /// Returns whether the method is for such a matrix.
    fn applies(_is_symmetric: bool) -> bool
    where
        Self: Sized,
    {
        true
    }

    /// Analyses a pattern; `None` if the method is not for it.
    fn analyse(pattern: &Pattern, layout: &Layout) -> Result<Option<Self>, SolverError>
    where
        Self: Sized;

    /// Factorises `values`, those of `matrix` by the pattern that was analysed; `false`: another method has to.
    fn factorise(&mut self, values: &[f64], matrix: &SystemMatrix, threads: &Threads) -> Result<bool, SolverError>;

    /// Solves in place with the last factor.
    fn solve(&mut self, x: &mut [f64], threads: &Threads);

    /// Discards the factor: nothing of it is kept at the next factorisation.
    fn forget(&mut self) {}

    /// Multiplications and additions of the last factorisation, without what was kept, and how many numbers the factor has, if
    /// the method knows.
    fn size(&self) -> Option<(f64, usize)> {
        None
    }
}

/// A method as it was analysed for a pattern.
pub(super) type Analysed = Option<Box<dyn Factorisation>>;

macro_rules! methods {
    ($($(#[$doc:meta])* $method:ident = $factorisation:ty),+ $(,)?) => {
        /// Methods of factorisation, in the order in which they are tried.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Method {
            $($(#[$doc])* $method,)+
        }

        impl Method {
            const ALL: [Self; [$(stringify!($method)),+].len()] = [$(Self::$method),+];

            /// Returns whether the method is for such a matrix.
            fn applies(self, is_symmetric: bool) -> bool {
                match self {
                    $(Self::$method => <$factorisation>::applies(is_symmetric),)+
                }
            }

            /// Analyses a pattern.
            fn analyse(self, pattern: &Pattern, layout: &Layout) -> Result<Analysed, SolverError> {
                match self {
                    $(Self::$method => {
                        Ok(<$factorisation>::analyse(pattern, layout)?.map(|analysed| Box::new(analysed) as _))
                    })+
                }
            }
        }
    };
}

pub(super) use methods;

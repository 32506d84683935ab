//! Threads that share the work of one analysis.
//!
//! Shared work is cut into pieces by the model alone, and the pieces are joined in their order: results have the same bits
//! for any number of threads.

use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, PoisonError};

/// Stack of a thread, bytes: a plugin may keep arrays there.
const STACK: usize = 1 << 24;

/// One thread, the caller's, or several.
#[derive(Clone, Debug, Default)]
pub struct Threads(Option<Arc<ThreadPool>>);

/// Pools that [`Threads::within`] made and no analysis uses.
static IDLE: Mutex<Vec<Arc<ThreadPool>>> = Mutex::new(Vec::new());

impl Threads {
    /// Runs an analysis on one of so many threads, which share its work. They remain for the next one: what rayon keeps of a pool that
    /// the caller's thread joins ([`Self::new`]), 10 kB, is never freed. With one thread it runs on the caller's.
    ///
    /// # Errors
    ///
    /// The system provides no threads.
    pub fn within<R: Send>(
        count: NonZeroUsize,
        analysis: impl FnOnce(Self) -> R + Send,
    ) -> Result<R, ThreadPoolBuildError> {
        if count.get() == 1 {
            return Ok(analysis(Self::default()));
        }
        let idle = || IDLE.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = {
            let mut pools = idle();
            let place = pools.iter().position(|pool| pool.current_num_threads() == count.get());
            place.map(|place| pools.swap_remove(place))
        };
        let pool = kept.map_or_else(|| pool_of(count).build().map(Arc::new), Ok)?;
        let result = pool.install(|| analysis(Self(Some(pool.clone()))));
        idle().push(pool);
        Ok(result)
    }

    /// Makes a pool of so many threads. The caller's is one of them if possible: waking another one takes up to half a
    /// millisecond, and the caller's has the data. A thread can join a pool only once, so one `Threads` does all its
    /// work.
    ///
    /// # Errors
    ///
    /// The system provides no threads.
    pub fn new(count: NonZeroUsize) -> Result<Self, ThreadPoolBuildError> {
        if count.get() == 1 {
            return Ok(Self::default());
        }
        let pool = pool_of(count).use_current_thread().build().or_else(|_| pool_of(count).build())?;
        Ok(Self(Some(Arc::new(pool))))
    }

    /// Runs both, at the same time if there is a thread for each.
    pub(crate) fn join<A: Send, B: Send>(
        &self,
        first: impl FnOnce() -> A + Send,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        match &self.0 {
            None => (first(), second()),
            Some(pool) => pool.join(first, second),
        }
    }

    /// Returns how many.
    pub(crate) fn count(&self) -> usize {
        self.0.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// Runs some work on each piece.
    pub(crate) fn for_each<P: Send>(&self, pieces: &mut [P], work: impl Fn(&mut P) + Send + Sync) {
        match &self.0 {
            None => pieces.iter_mut().for_each(work),
            Some(pool) => {
                let length = at_a_time(pieces.len(), pool);
                pool.install(|| pieces.par_iter_mut().with_max_len(length).for_each(work));
            }
        }
    }

    /// Returns, of the results that `work` gives for the pieces, the one with the least key; `None` if there are none.
    pub(crate) fn least<P: Send, R: Send, K: Ord + Send>(
        &self,
        pieces: &mut [P],
        work: impl Fn(&mut P) -> Option<R> + Send + Sync,
        key: impl Fn(&R) -> K + Send + Sync,
    ) -> Option<R> {
        match &self.0 {
            None => pieces.iter_mut().filter_map(work).min_by_key(key),
            Some(pool) => {
                let length = at_a_time(pieces.len(), pool);
                pool.install(|| pieces.par_iter_mut().with_max_len(length).filter_map(work).min_by_key(key))
            }
        }
    }
}

fn pool_of(count: NonZeroUsize) -> ThreadPoolBuilder {
    ThreadPoolBuilder::new().num_threads(count.get()).stack_size(STACK)
}

/// Some pieces have nothing to do: a thread takes a small part of its share at a time.
fn at_a_time(pieces: usize, pool: &ThreadPool) -> usize {
    pieces.div_ceil(16 * pool.current_num_threads()).max(1)
}

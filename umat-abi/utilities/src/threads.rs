//! GETNUMTHREADS, get_thread_id.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};
use std::thread::available_parallelism;

/// The numbers of the threads that asked and still run, and how many there can be.
static TAKEN: Mutex<(BTreeSet<i32>, i32)> = Mutex::new((BTreeSet::new(), 0));

/// A thread's number: the least that no other has, from 0.
struct Number(i32);

impl Number {
    fn take() -> Self {
        let (taken, most) = &mut *TAKEN.lock().unwrap_or_else(PoisonError::into_inner);
        let number = (0..).find(|number| !taken.contains(number)).unwrap_or_default();
        taken.insert(number);
        *most = (*most).max(number + 1);
        Self(number)
    }
}

impl Drop for Number {
    fn drop(&mut self) {
        TAKEN.lock().unwrap_or_else(PoisonError::into_inner).0.remove(&self.0);
    }
}

thread_local! {
    static NUMBER: Number = Number::take();
}

fn number() -> i32 {
    // at the end of a thread it has no number any more
    NUMBER.try_with(|number| number.0).unwrap_or_default()
}

/// Returns the number of threads that the host takes, or that have asked.
fn count() -> i32 {
    let processors = available_parallelism().map_or(1, |count| i32::try_from(count.get()).unwrap_or(i32::MAX));
    TAKEN.lock().unwrap_or_else(PoisonError::into_inner).1.max(processors)
}

/// get_thread_id(): the number of this thread, from 0.
#[unsafe(no_mangle)]
extern "C" fn get_thread_id_() -> i32 {
    number()
}

/// get_thread_id() for calls from C: the number of this thread, from 0.
#[unsafe(no_mangle)]
extern "C" fn get_thread_id() -> i32 {
    number()
}

/// GETNUMTHREADS(): how many threads there are.
#[unsafe(no_mangle)]
extern "C" fn getnumthreads_() -> i32 {
    count()
}

/// getNumThreads() for calls from C: how many threads there are.
#[unsafe(no_mangle)]
extern "C" fn getNumThreads() -> i32 {
    count()
}

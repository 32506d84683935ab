//! `MutexInit`, `MutexLock`, `MutexUnlock`: locks by number, 1 to 100.

use crate::messages::say;
use std::sync::{Condvar, Mutex, PoisonError};
use std::thread::{self, ThreadId};

/// Greatest ID.
const LOCKS: usize = 100;

/// A lock that one routine takes and another releases.
struct Lock {
    holder: Mutex<Option<ThreadId>>,
    released: Condvar,
}

static ALL: [Lock; LOCKS] = [const { Lock { holder: Mutex::new(None), released: Condvar::new() } }; LOCKS];

/// The lock of an ID.
///
/// # Safety
/// `id` can be read.
unsafe fn lock(id: *const i32, routine: &str) -> Option<&'static Lock> {
    // SAFETY: said above.
    let id = unsafe { *id };
    let lock = usize::try_from(id).ok().and_then(|id| ALL.get(id.checked_sub(1)?));
    if lock.is_none() {
        say(&format!("***ERROR: {routine}: there is no mutex {id}; they are numbered from 1 to {LOCKS}"));
    }
    lock
}

/// MutexInit(ID): a lock that no thread holds. (Every lock is one from the start.)
#[unsafe(no_mangle)]
unsafe extern "C" fn mutexinit_(id: *const i32) {
    // SAFETY: the argument is as the manual says.
    unsafe { lock(id, "MutexInit") };
}

/// MutexLock(ID): waits until no other thread holds the lock, and takes it.
#[unsafe(no_mangle)]
unsafe extern "C" fn mutexlock_(id: *const i32) {
    // SAFETY: the argument is as the manual says.
    let Some(lock) = (unsafe { lock(id, "MutexLock") }) else { return };
    let mut holder = lock.holder.lock().unwrap_or_else(PoisonError::into_inner);
    let me = thread::current().id();
    if *holder == Some(me) {
        // Waiting for oneself would take forever.
        say("***WARNING: MutexLock: this thread holds the mutex already (MutexUnlock was left out)");
        return;
    }
    while holder.is_some() {
        holder = lock.released.wait(holder).unwrap_or_else(PoisonError::into_inner);
    }
    *holder = Some(me);
}

/// MutexUnlock(ID): releases the lock.
#[unsafe(no_mangle)]
unsafe extern "C" fn mutexunlock_(id: *const i32) {
    // SAFETY: the argument is as the manual says.
    let Some(lock) = (unsafe { lock(id, "MutexUnlock") }) else { return };
    *lock.holder.lock().unwrap_or_else(PoisonError::into_inner) = None;
    lock.released.notify_one();
}

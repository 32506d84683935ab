//! Runs what a case asks for: a material or contact point along a path ([`path`]), a specimen ([`pullout`]), fibres
//! across a crack ([`bridging`]).
//!
//! A program ([`program`], [`pullout::PulloutProgram`]) comes in, rows go out to an observer. What calls libraries that nobody
//! here wrote does so in a process of its own ([`isolation`]).

pub mod arguments;
pub mod bridging;
pub mod columns;
pub mod date;
pub mod deformation;
pub mod input;
pub mod isolation;
pub mod number;
pub mod path;
pub mod program;
pub mod pullout;
pub mod replay;
pub mod signals;
pub mod sources;

use std::thread::{self, Builder};

/// Stack of every thread that calls plugins, bytes: automatic Fortran arrays live there.
pub const PLUGIN_STACK: usize = 64 << 20;

/// Does each piece of work in a thread of its own, which may call plugins. Returns, in their order, what they gave or the panic that
/// ended them; an error: the system gives no thread.
pub fn in_threads<R: Send>(
    works: impl IntoIterator<Item = impl FnOnce() -> R + Send>,
) -> Vec<std::io::Result<thread::Result<R>>> {
    thread::scope(|scope| {
        let start = |work| Builder::new().stack_size(PLUGIN_STACK).spawn_scoped(scope, work);
        let started: Vec<_> = works.into_iter().map(start).collect();
        started.into_iter().map(|thread| Ok(thread?.join())).collect()
    })
}

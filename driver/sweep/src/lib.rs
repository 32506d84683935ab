//! Many runs of a case of which numbers are kept: planned, worked off by any number of processes, collected.
//!
//! A sweep is a folder ([`store`]). Its work is done by children of the program, each of which runs many cases one after
//! another ([`Batch`]); what ends a child is a row of its own, and the next child goes on behind it ([`work`]). Rows have the
//! hash of everything that they depend on as their key: runs that are there are not made again, whichever process made them.

mod batch;
mod claim;
mod collect;
mod collection;
#[cfg(feature = "parquet")]
mod export;
mod plan;
mod run;
pub mod slurm;
pub mod store;
pub mod table;
mod work;

pub use batch::Batch;
pub use collect::{Standing, collect};
pub use collection::Collection;
pub use plan::{Planning, plan};
pub use store::Store;
pub use work::{Work, Worked, work};

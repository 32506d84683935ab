//! Plans many runs of a case, runs them in any number of processes, and collects their numbers.
//!
//! A sweep is a folder ([`store`]). Its work is done by children of pullout, each of which runs many cases one after
//! another ([`Batch`]). A run that ends its child gets a row of its own, and the next child continues after it ([`work`]). The key
//! of a row is the hash of everything that it depends on: a run that is there is not made again, whichever process made it.

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
pub use work::{WorkSettings, Worked, work};

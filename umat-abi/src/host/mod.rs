//! The host side: finding, loading and calling plugins, ours and anybody's.

mod altered;
mod call;
mod description;
mod discovery;
mod interface_call;
mod library;
mod memory;
pub mod recorder;

pub use altered::Alteration;
pub use call::{CallOutcome, UmatCall};
pub use description::{Choice, Derived, Group, Law, Parameter, State, Validation};
pub use discovery::{Found, library_file_name, library_path, names_a_file, search_paths};
pub use interface_call::{ContactArrays, FricCall, UinterCall};
pub use library::{Library, LoadError};
pub use memory::Overrun;

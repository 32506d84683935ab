//! The host side: finding, loading and calling plugins, our own and others'.

mod altered;
mod call;
mod data;
mod description;
mod discovery;
mod exchange;
mod fence;
mod frame;
mod guard;
mod initial;
mod interface_call;
mod library;
mod manner;
mod memory;
mod plugin;
mod plugin_call;
mod prints;
mod probe;
pub mod recorder;
mod routines;
mod split;
mod thermal;
mod utilities;
mod verdict;

/// DTIME of a call that takes no time, s: laws divide by it.
pub const MOMENT: f64 = 1e-12;

pub use crate::law::Heat;
pub use altered::Alteration;
pub use call::{CallOutcome, UmatCall, UmatInputs};
pub use data::DataSnapshot;
pub use description::{Choice, Derived, LawDescription, Parameter, ParameterGroup, StateDescription, Validation};
pub use discovery::{
    Found, SOURCES, is_source, library_file_name, library_name, library_path, names_a_file, real_path, search_also,
    search_from_program, search_paths,
};
pub use frame::{Course, Expansion, Frame, FreeStrain, LawView};
pub use guard::WrittenInput;
pub use initial::{InitialPoint, InitialStates, InitialStresses};
pub use interface_call::{FricAnswer, FricCall, FricInputs, SurfaceFields, UinterCall, UinterInputs};
pub use library::{Library, LoadError, Routine, Stamp, binds_deeply, stamp};
pub use manner::{FOLLOWS_GRADIENT, Manner, TangentDeviation, TangentSource, WRITTEN_FOR_SIX};
pub use memory::{NotFinite, Overrun, Trespass, same_bits};
pub use plugin::Plugin;
pub use plugin_call::PluginCall;
pub use prints::{flush_prints, print_by_lines, write_messages_to};
pub use probe::{Alignment, Probed, compute as compute_in_child};
pub use routines::{Clock, ExternalDatabases};
pub use split::split;
pub use thermal::{GRADIENTS, Transfer};
pub use utilities::{UTILITIES, announce_job, utilities_path};
pub use verdict::{CallFailure, judge};

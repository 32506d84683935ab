//! The contract between constitutive laws and the programs that call them.
//!
//! - [`umat`], [`fric`], [`uinter`]: the three entry points exactly as gfortran passes them; [`batch`]: UMAT for many points.
//! - [`law`]: what a law is in Rust: pure functions and one table.
//! - [`table`]: the macros that make its parameters and states of one table.
//! - [`metadata`]: the optional self-description of a plugin, `pullout_plugin_v1`.
//! - [`export`]: from a law to the symbols of a shared library ([`export_umat!`], [`export_interface!`],
//!   [`export_library!`]).
//! - `host` (feature `host`): finding, loading and calling any such library.

pub mod batch;
pub mod export;
mod floating_point;
pub mod fric;
#[cfg(feature = "host")]
pub mod host;
pub mod law;
pub mod metadata;
pub mod table;
pub mod uinter;
pub mod umat;

pub use floating_point::in_default_environment;

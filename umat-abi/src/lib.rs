//! The contract between constitutive laws and the programs that call them.
//!
//! - [`law`]: what a law is in Rust: pure functions and one table.
//! - [`metadata`]: the optional self-description of a plugin, `pullout_plugin_v1`.

pub mod law;
pub mod metadata;

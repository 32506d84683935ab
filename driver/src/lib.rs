//! The material-point driver: any UMAT along strain, stress and mixed paths; any UINTER or FRIC along
//! slip, gap and pressure paths.
//!
//! Data flows one way: a case file ([`case`]) becomes a checked program ([`path::program`]), which is run
//! ([`path`]) and recorded ([`output`]). [`conformance`] tests a plugin against what its metadata claims.

pub mod bench;
pub mod build;
pub mod case;
pub mod command;
pub mod conformance;
pub mod fit;
pub mod import;
mod input;
mod isolation;
pub mod output;
pub mod path;
pub mod pullout;
mod signals;
pub mod study;

/// Stack of every thread that calls plugins, bytes: automatic Fortran arrays live there.
pub const PLUGIN_STACK: usize = 64 << 20;

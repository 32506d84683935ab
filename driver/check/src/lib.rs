//! Plugins before they are used: built from sources of Fortran, C and C++ ([`build`]), described ([`description`]), and tested
//! against what their metadata claims ([`conformance`]).

pub mod build;
pub mod conformance;
pub mod description;

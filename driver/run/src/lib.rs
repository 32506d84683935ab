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

/// Stack of every thread that calls plugins, bytes: automatic Fortran arrays live there.
pub const PLUGIN_STACK: usize = 64 << 20;

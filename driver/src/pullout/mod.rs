//! Specimens in two dimensions: what a case asks for, checked and resolved, and its run.

mod fields;
mod program;
mod recorder;

pub use program::{COLUMNS, Output, Program};
pub use recorder::run;

//! Specimens in two dimensions: what a case asks for, checked and resolved, its run, and its results in addition to the
//! history.

pub mod checkpoint;
mod crack_band;
pub mod fibre;
mod fields;
mod findings;
mod moments;
mod overlap;
mod peak;
mod program;
mod recorder;
mod replay;
pub mod section;

pub use findings::{Findings, Rupture, SpecimenFailure};
pub use peak::PeakLoad;
pub use program::{FibreAxis, PictureAt, PulloutProgram, SpecimenSettings};
pub use recorder::{SavedState, SpecimenOutcome, run};

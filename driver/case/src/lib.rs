//! Reading of case files into programs ([`Case`]), with everything that is wrong with them at once.
//!
//! A file is parsed (`json`), overridden (`--set`), compared with the schema that its serde types make
//! (`document`, `structure`), and resolved: plugin and parameters, steps, tables, curves. No step stops at
//! the first problem; broken JSON, an unknown kind and a wrong structure leave nothing to go on with.

pub mod abaqus;
mod bridging;
mod concrete;
mod constraints;
mod document;
mod fields;
mod history;
mod host_normal;
mod increments;
mod interface;
mod json;
mod plugin;
mod point;
mod problem;
mod props;
mod read;
mod reader;
mod specimen;
mod steps;
mod structure;
mod table;
#[cfg(test)]
mod test;
mod validation;

pub use concrete::measured as concrete_of_class;
pub use document::{Positive, study, sweep};
pub use json::{dotted, value_at};
pub use plugin::{ALL_LAWS, frame_from_json, not_found, where_to_look};
pub use problem::{CaseErrors, Place as JsonPlace, Problem as CaseProblem, ProblemKind, hint};
pub use props::props_from_json;
pub use read::{
    Case, document, inputs, is_study, named_inputs, need, overridden, read, read_by, read_document, read_study,
    read_sweep, read_text,
};
pub use reader::{Reader, outside_usual};
pub use structure::schema;
pub use table::CsvFile;

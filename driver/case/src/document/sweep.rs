//! The sweep file as serde reads it and as `pullout schema` prints it.

use super::CommonEntries;
use super::study::{Columns, QuantityOfFile};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Many runs of a case, each of which leaves a row of numbers (kind "sweep").
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct SweepFile {
    /// "sweep".
    #[schemars(extend("const" = "sweep"))]
    pub kind: String,
    /// Title and text.
    #[serde(flatten)]
    pub head: CommonEntries,
    /// The case that is varied: its file, relative to the sweep file, or the case itself.
    pub base: Base,
    /// Overrides for all runs: dotted path and value, as `--set` has them.
    pub set: Option<Map<String, Value>>,
    /// Values by dotted path. Every combination is a run; the last path varies fastest.
    pub parameters: Option<Map<String, Value>>,
    /// The runs one by one: values by dotted path. All runs have the same paths.
    #[schemars(length(min = 1))]
    pub points: Option<Vec<Map<String, Value>>>,
    /// The runs as a CSV table whose header has the dotted paths, relative to the sweep file.
    #[schemars(length(min = 1))]
    pub design: Option<String>,
    /// Numbers to keep of each run, by the names of their columns `q.NAME` (default: peak, slip_at_peak, work and end).
    pub quantities: Option<BTreeMap<String, QuantityOfFile>>,
    /// The curve whose peak and work count; default: load against slip, τ against slip, σ11 against ε11.
    pub curve: Option<Columns>,
    /// Value of x, with its sign, up to which the work (the integral of y along the curve) is taken. Default: the whole
    /// path of the run.
    pub work_to: Option<f64>,
    /// History columns to keep, as computed or on the grid.
    pub curves: Option<Vec<String>>,
    /// Ascending values of x at which the columns are kept, interpolated along the first branch of the curve. Beyond
    /// the range of the run, columns are NaN.
    #[schemars(length(min = 1))]
    pub grid: Option<Vec<f64>>,
}

/// A case by its file, or itself.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Base {
    /// The file.
    File(String),
    /// The case.
    Case(Map<String, Value>),
}

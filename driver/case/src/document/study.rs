//! The study file as serde reads it and as `pullout schema` prints it.

use super::{CommonEntries, Positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// A family of runs: a case, its variations, and claims about the results (kind "study").
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct StudyFile {
    /// "study".
    #[schemars(extend("const" = "study"))]
    pub kind: String,
    /// Title and text.
    #[serde(flatten)]
    pub head: CommonEntries,
    /// Case file that the runs vary, relative to the study file.
    #[schemars(length(min = 1))]
    pub base: String,
    /// Overrides for all runs: dotted path and value, as `--set` has them.
    pub set: Option<Map<String, Value>>,
    /// Quantity that is varied along the list of members.
    pub x: Option<Abscissa>,
    /// The runs of each series.
    #[schemars(length(min = 1))]
    pub members: Vec<MemberOfFile>,
    /// Lists of runs with the same members; default: one, named "runs".
    #[schemars(length(min = 1))]
    pub series: Option<Vec<SeriesOfFile>>,
    /// History columns of the curve whose peak and work count; default: load against slip, τ against slip, σ11 against ε11.
    pub curve: Option<Columns>,
    /// Value of x, with its sign, up to which the work (the integral of y along the curve) is taken. Default: the end
    /// of the shortest finished run, if all curves run to one side and none turns back by more than 5 % of its reach;
    /// otherwise the whole path of each run.
    pub work_to: Option<f64>,
    /// More pictures of all runs, by history columns.
    pub overlays: Option<Vec<Columns>>,
    /// Claims that are tested.
    pub claims: Option<Vec<ClaimOfFile>>,
}

/// Quantity that is varied.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Abscissa {
    /// Name for axes and tables; `_{0}` is an index.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Unit; none of a pure number.
    #[serde(default)]
    pub unit: String,
    /// Logarithmic axis.
    #[serde(default)]
    pub logarithmic: bool,
}

/// One run of each series.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MemberOfFile {
    /// Short name, and name of the result directory.
    #[schemars(length(min = 1))]
    pub label: String,
    /// Title in legends and tables; default: the label, or x with its unit.
    pub title: Option<String>,
    /// Value of x, such as an angle in degrees. Either all members have one or none.
    pub x: Option<f64>,
    /// Overrides: dotted path and value, as `--set` has them. They come after those of the series.
    pub set: Option<Map<String, Value>>,
}

/// A list of runs.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SeriesOfFile {
    /// Short name, and name of the directory of its runs.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Title in legends and tables; default: the name.
    pub title: Option<String>,
    /// Case file of this series instead of the study's, relative to the study file.
    #[schemars(length(min = 1))]
    pub base: Option<String>,
    /// Overrides: dotted path and value, as `--set` has them. They come after those of the study.
    pub set: Option<Map<String, Value>>,
}

/// Two history columns.
#[derive(Clone, Debug, Default, Deserialize, Serialize, JsonSchema, PartialEq, Eq)]
#[serde(deny_unknown_fields)]
pub struct Columns {
    /// Along x.
    pub x: String,
    /// Along y.
    pub y: String,
}

/// A claim and its test.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClaimOfFile {
    /// Text of the claim.
    #[schemars(length(min = 1))]
    pub claim: String,
    /// Name of a series, or several names; default: all. The claim holds if it holds in each.
    pub series: Option<OneOrMany>,
    /// Members to test; default: all.
    pub members: Option<Vec<MemberName>>,
    /// Quantity that is tested (default "peak"; "curve_within" and "done" need none).
    pub quantity: Option<QuantityOfFile>,
    /// The test.
    pub expect: Expectation<MemberName, String>,
}

/// One name or several.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema, PartialEq)]
#[serde(untagged)]
pub enum OneOrMany {
    /// One.
    One(String),
    /// Several.
    Many(Vec<String>),
}

/// A member by its x or its label.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum MemberName {
    /// Value of x.
    X(f64),
    /// Label.
    Label(String),
}

/// A number that a run gives.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema, PartialEq)]
#[serde(untagged)]
pub enum QuantityOfFile {
    /// By name.
    Named(NamedQuantity),
    /// A history column somewhere.
    Column(ColumnValue),
}

/// Numbers of a run.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum NamedQuantity {
    /// The curve's greatest ordinate in magnitude.
    Peak,
    /// The curve's abscissa at its peak.
    SlipAtPeak,
    /// The integral of y along the curve (see `work_to`).
    Work,
    /// The curve's last ordinate.
    End,
    /// Number of increments.
    Increments,
    /// Newton iterations.
    Iterations,
    /// Attempts given up.
    Cutbacks,
    /// The greatest imbalance of the energies.
    EnergyErrorMax,
    /// CPU time, s.
    CpuTime,
}

/// A history column somewhere.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct ColumnValue {
    /// The column.
    pub column: String,
    /// Place in the history (default "end").
    pub at: Option<Where>,
    /// Divisor: another column at the same place, or the sum of several.
    pub over: Option<OneOrMany>,
}

impl ColumnValue {
    /// Returns the place in the history.
    pub fn at(&self) -> Where {
        self.at.unwrap_or(Where::Named(NamedPlace::End))
    }

    /// Returns the columns that it is divided by the sum of; none: it stands alone.
    pub fn over(&self) -> &[String] {
        match &self.over {
            None => &[],
            Some(OneOrMany::One(column)) => std::slice::from_ref(column),
            Some(OneOrMany::Many(columns)) => columns,
        }
    }
}

/// A place in a history.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema, PartialEq)]
#[serde(untagged)]
pub enum Where {
    /// By name.
    Named(NamedPlace),
    /// The row in which the curve's x first reaches this value (with the sign of x).
    X(f64),
}

/// Places in a history.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum NamedPlace {
    /// The last row.
    End,
    /// The row of the curve's peak.
    Peak,
    /// The row where the column is greatest.
    Greatest,
    /// The row where the column is least.
    Least,
}

/// Expectation about the numbers of the members.
// M and S: names of a member and a series in a file, their indices in the study that is made of it
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged, deny_unknown_fields)]
#[schemars(rename = "Expectation")]
pub enum Expectation<M = usize, S = usize> {
    /// A trend from member to member, in the order of their x (or of the list).
    Trend {
        /// Direction of the trend.
        trend: Direction,
        /// Change in the opposite direction that a step may make, relative to the greatest magnitude (default 0).
        #[schemars(range(min = 0.0))]
        tolerance: Option<f64>,
    },
    /// The greatest number is that of a member.
    Maximum {
        /// The member.
        maximum_at: M,
    },
    /// The greatest number is that of a member whose x is strictly between two values, not at the ends of a range.
    MaximumBetween {
        /// Lower and upper value of x, both excluded; members inside and outside are needed.
        maximum_between: [f64; 2],
    },
    /// The least number is that of a member.
    Minimum {
        /// The member.
        minimum_at: M,
    },
    /// Each number is near that of a member.
    Within {
        /// Greatest difference relative to it.
        within: Positive,
        /// The member.
        of: M,
    },
    /// Each curve is near that of a member, up to where both go.
    Curve {
        /// Greatest area between the two curves, relative to the area below the member's.
        curve_within: Positive,
        /// The member.
        of: M,
    },
    /// Each number is greater than that of the same member in another series.
    Above {
        /// The other series.
        above: S,
    },
    /// Each number is less than that of the same member in another series.
    Below {
        /// The other series.
        below: S,
    },
    /// The number of one member over that of another.
    Ratio {
        /// The one.
        ratio_of: M,
        /// The other.
        to: M,
        /// Lower bound.
        greater_than: Option<f64>,
        /// Upper bound.
        less_than: Option<f64>,
    },
    /// The number of each member over that of the same member in another series.
    OverSeries {
        /// The other series.
        over_series: S,
        /// Lower bound.
        greater_than: Option<f64>,
        /// Upper bound.
        less_than: Option<f64>,
    },
    /// Every run goes to its end.
    Done {
        /// Whether every run is expected to reach its end.
        done: bool,
    },
    /// Bounds for the number of each member.
    Bounds {
        /// Lower bound.
        greater_than: Option<f64>,
        /// Upper bound.
        less_than: Option<f64>,
    },
}

/// Direction of a trend.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Each is greater than the one before.
    Increasing,
    /// Each is less than the one before.
    Decreasing,
}

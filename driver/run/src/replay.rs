//! Parts common to replay cases: those that repeat a call of a plugin, and those that repeat an increment that failed.

use crate::program::FieldValues;
use serde_json::{Value, json};
use std::path::Path;

/// Title of a case that repeats a call, up to that of the case whose call it is.
pub const OF_CALL: &str = "Replay of a call: ";
/// Title of a case that repeats an increment, up to that of the case whose increment it is.
pub(crate) const OF_INCREMENT: &str = "Replay of a failed increment: ";

/// Names the case that is repeated in part, by a title that begins with `what`, and the folder from which it was run.
pub fn entitle(replay: &mut Value, what: &str, title: &str, job_folder: &Path) {
    replay["title"] = json!(format!("{what}{}", title.strip_prefix(what).unwrap_or(title)));
    replay["job_folder"] = json!(job_folder.to_string_lossy());
}

/// A library by its absolute path: a case may be moved.
pub(crate) fn library(path: &Path) -> Value {
    json!(std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()).to_string_lossy())
}

/// Sets temperature and field variables before and at the end of the only step.
pub(crate) fn set_fields(case: &mut Value, start: &FieldValues, end: &FieldValues) {
    case["temperature"] = json!(start.temperature);
    case["steps"][0]["temperature"] = json!(end.temperature);
    if !start.variables.is_empty() {
        case["predef"] = json!(start.variables);
        case["steps"][0]["predef"] = json!(end.variables);
    }
}

/// The values of some components by their names.
pub(crate) fn named(names: &[&str; 6], components: &[usize], values: &[f64; 6]) -> Value {
    let entries = components.iter().map(|&i| (names[i].to_owned(), json!(values[i])));
    Value::Object(entries.collect())
}

/// A matrix row by row, from one column by column; what is missing is 0.
pub(crate) fn rows(columns: &[f64]) -> Value {
    let entry = |place: usize| columns.get(place).copied().unwrap_or_default();
    json!(std::array::from_fn::<[f64; 3], 3, _>(|row| std::array::from_fn(|column| entry(3 * column + row))))
}

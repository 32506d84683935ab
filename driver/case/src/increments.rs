//! Increments of another run that are repeated.

use crate::document::RunIncrements;
use crate::problem::Place;
use crate::reader::Reader;
use fe_core::stepping::{LeadingQuantity, Recorded};
use pullout_run::input::{self, Input};
use serde_json::Value;
use std::sync::Arc;

/// Returns the recorded increments that a case gives. `steps`: the largest number of increments of each step; `None`:
/// any number, for a specimen. `may_end_early`: the case can end before its last step.
pub fn recorded(
    reader: &mut Reader<'_>,
    given: Option<&RunIncrements>,
    steps: &[Option<u64>],
    may_end_early: bool,
) -> Option<Arc<Recorded>> {
    let place = Place::root().key("increments").key("recorded");
    let read: Result<Recorded, String> = match &given?.recorded {
        Value::String(name) => {
            let file = reader.file(name, &place)?;
            let wrong = |error: String| format!("{}: {error}", file.display());
            let text = input::read(&file, Input::Case).map_err(|error| wrong(error.to_string()));
            text.and_then(|text| serde_json::from_slice(&text).map_err(|error| wrong(error.to_string())))
        }
        inline => serde_json::from_value(inline.clone()).map_err(|error| error.to_string()),
    };
    let read = read.map_err(|error| format!("is no record of increments (--record-increments writes one): {error}"));
    let recorded = reader.without_problem(read, &place)?;
    let mistake = mistake(&recorded, steps, may_end_early);
    reader.without_problem(mistake.map_or(Ok(Arc::new(recorded)), Err), &place)
}

fn mistake(recorded: &Recorded, steps: &[Option<u64>], may_end_early: bool) -> Option<String> {
    if let Some((place, why)) = recorded.mistake() {
        return Some(format!("{place} {why}"));
    }
    // what is not recorded would be left out
    if recorded.steps.len() > steps.len() || recorded.steps.len() < steps.len() && !may_end_early {
        return Some(format!("has {} steps, the case {}", recorded.steps.len(), steps.len()));
    }
    for (index, (increments, most)) in recorded.steps.iter().zip(steps).enumerate() {
        let Some(most) = most else { continue };
        if increments.len() as u64 > *most {
            return Some(format!(
                "steps[{index}] has {} increments, step {} of the case {most}",
                increments.len(),
                index + 1
            ));
        }
        let is_whole = |tried: &fe_core::stepping::Tried| tried.to == LeadingQuantity::Drives(1.0);
        if let Some(k) = increments.iter().position(|attempts| !attempts.last().is_some_and(is_whole)) {
            return Some(format!("steps[{index}][{k}] does not end with the increment: it is of a specimen"));
        }
    }
    None
}

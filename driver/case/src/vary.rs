//! Models that differ from that of a case in one number, by which its history is differentiated.

use crate::problem::{CaseErrors, Place, Problem};
use crate::read::Case;
use fe_core::stepping::Analysis;
use pullout_run::pullout::Varied;
use serde_json::Value;

/// Relative step by which numbers are moved: that of positions' rounding is 1e-10 of the forces, beyond 1e-4 curves are no lines.
const STEP: f64 = 1e-5;

/// Returns the number at a path of a case, as `--set` has paths.
///
/// # Errors
/// What is wrong with the path.
pub fn number_at(document: &Value, path: &str) -> Result<f64, String> {
    let found = path
        .split('.')
        .try_fold(document, |value, name| value.get(name).or_else(|| value.get(name.parse::<usize>().ok()?)));
    match found {
        Some(found) => found.as_f64().ok_or_else(|| format!("$.{path} is {found}, and no number")),
        None => Err(format!("$.{path} is not there: give it its value")),
    }
}

/// Adds the models of a specimen with moved numbers. `document`: the case; `read` reads it with one more override.
///
/// # Errors
/// Paths by which no history can be differentiated.
pub fn vary(
    case: &mut Case,
    document: &Value,
    paths: &[String],
    read: &dyn Fn(&str) -> Result<Case, CaseErrors>,
) -> Result<(), CaseErrors> {
    if paths.is_empty() {
        return Ok(());
    }
    let file = case.about().case_file.clone();
    let mut problems = Vec::new();
    let Case::Pullout(program) = case else {
        let message =
            "derivatives are those of a case of kind \"pullout\"; runs of points are so short that differences do";
        return Err(CaseErrors { file, problems: vec![Problem::new(Place::root(), message)] });
    };
    for (k, path) in paths.iter().enumerate() {
        if paths[..k].contains(path) {
            problems.push(Problem::new(Place::derivative(path), "is given twice"));
            continue;
        }
        match moved(document, path, read) {
            Ok((step, other)) => match Analysis::may_accompany(&program.model, &other.model) {
                Ok(()) => program.varied.push(Varied { path: path.clone(), step, model: other.model }),
                Err(error) => problems.push(Problem::new(Place::derivative(path), error.to_string())),
            },
            Err(message) => problems.push(Problem::new(Place::derivative(path), message)),
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(CaseErrors { file, problems }) }
}

/// The case with a moved number: upwards, or downwards where that is not allowed.
fn moved(
    document: &Value,
    path: &str,
    read: &dyn Fn(&str) -> Result<Case, CaseErrors>,
) -> Result<(f64, Box<pullout_run::pullout::Program>), String> {
    let value = number_at(document, path)?;
    let size = STEP * if value == 0.0 { 1.0 } else { value.abs() };
    let mut refusal = String::new();
    for end in [value + size, value - size] {
        match read(&format!("{path}={end:?}")) {
            Ok(Case::Pullout(program)) => return Ok((end - value, program)),
            Ok(_) => refusal = "is not the number of a specimen".into(),
            Err(errors) => {
                let first = errors.problems.first().map(ToString::to_string).unwrap_or_default();
                refusal = format!("the case cannot be read with {end:?}: {first}");
            }
        }
    }
    Err(refusal)
}

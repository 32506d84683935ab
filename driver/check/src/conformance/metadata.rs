//! The metadata itself: bounds, defaults, names, the validate function.

use super::report::{Ledger, Verdict};
use std::collections::HashSet;
use umat_abi::host::{LawDescription, Validation};
use umat_abi::law::MAX_STATES;
use umat_abi::metadata::kinds;

/// PROPS made of the defaults, the repeating group as often as it must occur.
pub(super) fn default_properties(law: &LawDescription) -> Vec<f64> {
    let defaults: Vec<f64> = law.parameters.iter().map(|parameter| parameter.default_value).collect();
    let Some(group) = &law.group else { return defaults };
    let (fixed, repeated) = defaults.split_at(defaults.len() - group.size);
    let times = group.count_parameter.map_or(group.minimum, |k| defaults[k].max(0.0) as usize);
    fixed.iter().chain(repeated.iter().cycle().take(times * group.size)).copied().collect()
}

/// The parameter that describes `props[k]`.
pub(super) fn parameter_of(law: &LawDescription, k: usize) -> usize {
    match &law.group {
        Some(group) if k >= law.parameters.len() - group.size => {
            let fixed = law.parameters.len() - group.size;
            fixed + (k - fixed) % group.size
        }
        _ => k,
    }
}

/// All checks of the description.
pub(super) fn check(law: &LawDescription, props: &[f64], length: Option<f64>, ledger: &mut Ledger<'_>) {
    report(ledger, "parameters", format!("{}", law.parameters.len()), parameter_errors(law));
    report(ledger, "state variables", format!("{}", law.states.len()), state_errors(law));
    let mut errors = Vec::new();
    match law.validate(props, length) {
        Validation::Valid => {}
        Validation::NeedsCharacteristicLength(_) if length.is_none() => {}
        Validation::NeedsCharacteristicLength(message) | Validation::Invalid(message) => {
            errors.push(format!("refuses the properties {props:?}: {message}"));
        }
    }
    let refused = |props: &[f64]| matches!(law.validate(props, length), Validation::Invalid(_));
    for k in 0..props.len() {
        let mut wrong = props.to_vec();
        wrong[k] = f64::NAN;
        if !refused(&wrong) {
            errors.push(format!("accepts {} = NaN", law.parameters[parameter_of(law, k)].name));
        }
    }
    if law.group.is_none() && (refused(props) || !refused(&[props, &[1.0]].concat())) {
        errors.push("accepts one property too many".into());
    }
    report(ledger, "validate()", String::new(), errors);
}

fn report(ledger: &mut Ledger<'_>, check: &'static str, figure: String, errors: Vec<String>) {
    let verdict = if errors.is_empty() { Verdict::Pass } else { Verdict::Fail };
    ledger.row(check, verdict, figure, errors.join("; "));
}

fn parameter_errors(law: &LawDescription) -> Vec<String> {
    let mut errors = Vec::new();
    let mut names = HashSet::new();
    for parameter in &law.parameters {
        let name = &parameter.name;
        if name.is_empty() || !names.insert(name) {
            errors.push(format!("the name '{name}' is empty or occurs twice"));
        }
        if parameter.unit.is_empty() || parameter.doc.is_empty() {
            errors.push(format!("{name} has no unit or no documentation"));
        }
        if !parameter.admits(parameter.default_value) {
            errors.push(format!("the default {} of {name} is not {}", parameter.default_value, parameter.bounds()));
        }
    }
    errors
}

fn state_errors(law: &LawDescription) -> Vec<String> {
    let mut errors = Vec::new();
    let mut names = HashSet::new();
    for state in &law.states {
        if state.name.is_empty() || !names.insert(&state.name) {
            errors.push(format!("the name '{}' is empty or occurs twice", state.name));
        }
    }
    if law.states.len() > MAX_STATES {
        errors.push(format!("more than {MAX_STATES} states"));
    }
    let components: Vec<u32> = law.states.iter().map(|state| state.tensor_component).collect();
    for (k, &component) in components.iter().enumerate() {
        let expected = if k > 0 && (1..6).contains(&components[k - 1]) { components[k - 1] + 1 } else { component };
        if component != expected || component > 6 || (component > 1 && k == 0) {
            errors.push(format!("tensor components of '{}' are not six in a row", law.states[k].name));
        }
    }
    if law.kinds & kinds::UMAT != 0 {
        let ends = law.states.iter().rev().take(2).map(|state| state.name.as_str());
        if !ends.eq(["dissipated_energy", "strain_33"]) {
            errors.push("the last states are not strain_33 and dissipated_energy".into());
        }
        if law.stress_states == 0 {
            errors.push("a UMAT without stress states".into());
        }
    }
    if law.kinds == 0 {
        errors.push("no entry point named".into());
    }
    errors
}

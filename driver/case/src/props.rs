//! PROPS from the names of a law's parameters.

use crate::document::{Occurrence, PropValue, Props};
use crate::problem::{Place, Problem, hint, nearest};
use serde_json::Value;
use std::collections::BTreeMap;
use umat_abi::host::{LawDescription, Parameter};

/// Returns the PROPS of a law for a case's `props` (an object by name or an array); `null` means all defaults. Places
/// in problems begin with `$.material.props`. The law's own validation is not called.
///
/// # Errors
/// Everything that is wrong.
pub fn props_from_json(law: &LawDescription, props: &Value) -> Result<Vec<f64>, Vec<Problem>> {
    let place = Place::root().key("material").key("props");
    match serde_json::from_value::<Option<Props>>(props.clone()) {
        Ok(props) => resolve(law, props.as_ref(), &place),
        Err(_) => {
            Err(vec![Problem::new(place, "expected an object of numbers, names and lists, or an array of numbers")])
        }
    }
}

/// Returns PROPS in order, as [`props_from_json`] does.
pub(super) fn resolve(law: &LawDescription, props: Option<&Props>, place: &Place) -> Result<Vec<f64>, Vec<Problem>> {
    let mut problems = Vec::new();
    let values = match props {
        Some(Props::List(values)) => {
            let values = law.completed(values);
            check_list(law, &values, place, &mut problems);
            values
        }
        Some(Props::Named(named)) => by_name(law, named, place, &mut problems),
        None => by_name(law, &BTreeMap::new(), place, &mut problems),
    };
    if problems.is_empty() { Ok(values) } else { Err(problems) }
}

/// Names and values of the parameters that a case leaves to their defaults.
pub(super) fn defaults(law: &LawDescription, props: Option<&Props>) -> Vec<String> {
    let is_given = |name: &str| match props {
        Some(Props::List(_)) => true,
        Some(Props::Named(named)) => named.contains_key(name),
        None => false,
    };
    // a number of occurrences is counted
    let counted = law.group.as_ref().and_then(|group| group.count_parameter);
    let taken = split(law).0.iter().enumerate().filter(|(k, p)| Some(*k) != counted && !is_given(&p.name));
    let words = |(_, p): (usize, &Parameter)| match p.choices.iter().find(|choice| choice.value == p.default_value) {
        Some(choice) => format!("{} = {}", p.name, choice.name),
        None => format!("{} = {}", p.name, p.default_value),
    };
    taken.map(words).collect()
}

/// The parameters of PROPS in their order, those of the group as often as it occurs.
pub(super) fn in_order(law: &LawDescription) -> impl Iterator<Item = &Parameter> {
    let (fixed, repeated) = split(law);
    fixed.iter().chain(repeated.iter().cycle())
}

/// The parameters before the repeating group, and those of one occurrence.
pub(super) fn split(law: &LawDescription) -> (&[Parameter], &[Parameter]) {
    let size = law.group.as_ref().map_or(0, |group| group.size).min(law.parameters.len());
    law.parameters.split_at(law.parameters.len() - size)
}

fn names(parameters: &[Parameter]) -> Vec<&str> {
    parameters.iter().map(|parameter| parameter.name.as_str()).collect()
}

fn by_name(
    law: &LawDescription,
    named: &BTreeMap<String, PropValue>,
    place: &Place,
    problems: &mut Vec<Problem>,
) -> Vec<f64> {
    let (fixed, repeated) = split(law);
    let group = law.group.as_ref();
    let valid = [names(fixed), group.iter().map(|group| group.name.as_str()).collect()].concat();
    for name in named.keys().filter(|name| !valid.contains(&name.as_str())) {
        let message = match group.filter(|_| repeated.iter().any(|p| p.name == *name)) {
            Some(group) => format!(
                "'{name}' belongs to the repeating group '{}': give it there, as \"{}\": [[{}], …]",
                group.name,
                group.name,
                names(repeated).join(", ")
            ),
            None => format!("{} has no parameter '{name}'{}", law.name, hint(name, &valid)),
        };
        problems.push(Problem::structure(place.key(name), message));
    }
    let mut values: Vec<f64> = fixed
        .iter()
        .map(|parameter| match named.get(&parameter.name) {
            None => parameter.default_value,
            Some(value) => one_value(parameter, value, &place.key(&parameter.name), problems),
        })
        .collect();
    if let Some(group) = group {
        let place_of_group = place.key(&group.name);
        let occurrences = occurrences(law, named.get(&group.name), &place_of_group, problems);
        if let Some(count) = group.count_parameter {
            let expected = occurrences.len() as f64;
            let parameter = &fixed[count];
            if named.contains_key(&parameter.name) && values[count] != expected {
                let message = format!(
                    "is {}, but '{}' has {expected} entries; leave {} out, it is counted",
                    values[count], group.name, parameter.name
                );
                problems.push(Problem::new(place.key(&parameter.name), message));
            }
            values[count] = expected;
        }
        values.extend(occurrences.into_iter().flatten());
    }
    values
}

/// A parameter's value; NaN after a problem.
fn one_value(parameter: &Parameter, value: &PropValue, place: &Place, problems: &mut Vec<Problem>) -> f64 {
    let number = match value {
        PropValue::Number(number) => *number,
        PropValue::Choice(name) => {
            if let Some(choice) = parameter.choices.iter().find(|choice| choice.name.eq_ignore_ascii_case(name)) {
                return choice.value;
            }
            let names: Vec<&str> = parameter.choices.iter().map(|choice| choice.name.as_str()).collect();
            let message = if names.is_empty() {
                format!("expected a number, found the text '{name}'")
            } else {
                let near = nearest(name, &names).map_or_else(String::new, |n| format!("; nearest valid name: '{n}'"));
                format!("'{name}' is not one of {}{near}", parameter.bounds())
            };
            problems.push(Problem::new(place.clone(), message));
            return f64::NAN;
        }
        PropValue::Occurrences(_) => {
            problems.push(Problem::new(place.clone(), "expected a number, found an array"));
            return f64::NAN;
        }
    };
    check_bounds(parameter, number, place, problems);
    number
}

fn check_bounds(parameter: &Parameter, value: f64, place: &Place, problems: &mut Vec<Problem>) {
    if !parameter.admits(value) {
        let unit = if parameter.unit == "-" { String::new() } else { format!(" {}", parameter.unit) };
        let what = if parameter.choices.is_empty() { "must be" } else { "must be one of" };
        let message = format!("{} = {value} is not admissible: it {what} {}{unit}", parameter.name, parameter.bounds());
        problems.push(Problem::new(place.clone(), message));
    }
}

/// The occurrences of the repeating group.
fn occurrences(
    law: &LawDescription,
    value: Option<&PropValue>,
    place: &Place,
    problems: &mut Vec<Problem>,
) -> Vec<Vec<f64>> {
    let (_, repeated) = split(law);
    let Some(group) = &law.group else { return Vec::new() };
    let names = names(repeated).join(", ");
    let list = match value {
        Some(PropValue::Occurrences(list)) => list.as_slice(),
        Some(_) => {
            problems.push(Problem::new(place.clone(), format!("expected a list [[{names}], …]")));
            return Vec::new();
        }
        None => &[],
    };
    if list.len() < group.minimum {
        let message = match value {
            None => format!("is missing: {} needs at least {} of [{names}]", law.name, group.minimum),
            Some(_) => format!("{} of [{names}] given, at least {} needed", list.len(), group.minimum),
        };
        problems.push(Problem::new(place.clone(), message));
    }
    list.iter()
        .enumerate()
        .map(|(k, occurrence)| one_occurrence(repeated, occurrence, &place.index(k), problems))
        .collect()
}

fn one_occurrence(
    repeated: &[Parameter],
    occurrence: &Occurrence,
    place: &Place,
    problems: &mut Vec<Problem>,
) -> Vec<f64> {
    let names = names(repeated);
    let values = match occurrence {
        Occurrence::Values(values) => values.clone(),
        Occurrence::Single(value) => vec![*value],
        Occurrence::Named(named) => {
            for name in named.keys().filter(|name| !names.contains(&name.as_str())) {
                problems.push(Problem::structure(place.key(name), format!("unknown key{}", hint(name, &names))));
            }
            repeated.iter().map(|p| named.get(&p.name).copied().unwrap_or(p.default_value)).collect()
        }
    };
    if values.len() != repeated.len() {
        let message = format!("{} values given, {} needed: [{}]", values.len(), repeated.len(), names.join(", "));
        problems.push(Problem::new(place.clone(), message));
        return values;
    }
    for (k, (parameter, value)) in repeated.iter().zip(&values).enumerate() {
        let place =
            if matches!(occurrence, Occurrence::Named(_)) { place.key(&parameter.name) } else { place.index(k) };
        check_bounds(parameter, *value, &place, problems);
    }
    values
}

/// Checks PROPS given as an array: count, bounds, choices.
fn check_list(law: &LawDescription, values: &[f64], place: &Place, problems: &mut Vec<Problem>) {
    let (fixed, repeated) = split(law);
    let least = fixed.len() + repeated.len() * law.group.as_ref().map_or(0, |group| group.minimum);
    let rest = values.len().saturating_sub(fixed.len());
    let fits = if repeated.is_empty() { rest == 0 } else { rest % repeated.len() == 0 };
    if values.len() < least || !fits {
        let names = names(&law.parameters).join(", ");
        let more = if repeated.is_empty() { String::new() } else { format!(", the last {} repeated", repeated.len()) };
        let message = format!("{} values given, {} takes {least}: {names}{more}", values.len(), law.name);
        problems.push(Problem::new(place.clone(), message));
    }
    if let Some(count) = law.group.as_ref().and_then(|group| group.count_parameter)
        && let Some(given) = values.get(count)
        && fits
        && *given != (rest / repeated.len()) as f64
    {
        let message = format!("{} = {given}, but {} follow", fixed[count].name, rest / repeated.len());
        problems.push(Problem::new(place.index(count), message));
    }
    for (k, (parameter, value)) in in_order(law).zip(values).enumerate() {
        check_bounds(parameter, *value, &place.index(k), problems);
    }
}

//! A law as ABAQUS input: keywords, constants and state variables in the order of PROPS and STATEV.

use crate::props::{in_order, props_from_json, split};
use serde_json::{Value, json};
use std::fmt::Write;
use umat_abi::host::{LawDescription, Parameter};
use umat_abi::metadata::{flags, kinds};

/// Values on a data line of `*USER MATERIAL`, `*FRICTION, USER` and `*SURFACE INTERACTION, USER`.
pub const VALUES_A_LINE: usize = 8;

/// Returns the keywords that give a law with its default parameters to ABAQUS, one block for each entry point. Every
/// line ends with a line break, also the last.
///
/// # Errors
/// A message if the defaults of its metadata make no PROPS.
pub fn input(law: &LawDescription) -> Result<String, String> {
    Ok(written(law, &defaults(law)?, " Default values: put in your own."))
}

/// The same with these PROPS.
pub fn with_props(law: &LawDescription, props: &[f64]) -> String {
    written(law, props, "")
}

/// The blocks below a head that ends with a remark.
fn written(law: &LawDescription, props: &[f64], remark: &str) -> String {
    let mut text = format!("** {} {}: {}\n** Units N, mm, MPa.{remark}\n", law.name, law.version, law.description);
    if law.has(flags::USES_CELENT) {
        text.push_str("** Reads CELENT, the characteristic element length.\n");
    }
    if let Some(group) = &law.group {
        let _ = writeln!(
            text,
            "** The last {} constants may be given several times (at least {}).",
            group.size, group.minimum
        );
    }
    let (name, depvar, properties) = (law.name.to_uppercase(), law.states.len(), props.len());
    let unsymmetric = if law.has(flags::SYMMETRIC_TANGENT) { "" } else { ", UNSYMM" };
    let blocks = [kinds::UMAT, kinds::FRIC, kinds::UINTER].into_iter().filter(|kind| law.kinds & kind != 0);
    for (index, kind) in blocks.enumerate() {
        let _ = match kind {
            kinds::UMAT => {
                writeln!(text, "*MATERIAL, NAME={name}\n*USER MATERIAL, CONSTANTS={properties}{unsymmetric}")
            }
            kinds::FRIC => writeln!(
                text,
                "** tangential law; FRIC needs *STEP, UNSYMM=YES where the tangent is unsymmetric\n*SURFACE INTERACTION, \
                 NAME={name}_TANGENTIAL\n1.0,\n*FRICTION, USER, DEPVAR={depvar}, PROPERTIES={properties}"
            ),
            // the first data line is the out-of-plane thickness
            _ => writeln!(
                text,
                "** normal and tangential law\n*SURFACE INTERACTION, NAME={name}, USER, DEPVAR={depvar}, \
                 PROPERTIES={properties}{unsymmetric}\n1.0,"
            ),
        };
        constants(&mut text, law, props);
        if kind == kinds::UMAT && depvar > 0 {
            let _ = writeln!(text, "*DEPVAR\n{depvar},");
        }
        if index == 0 {
            for (index, state) in law.states.iter().enumerate() {
                let _ = writeln!(text, "** SDV{}: {} ({}): {}", index + 1, state.name, state.unit, state.doc);
            }
        }
    }
    let _ = writeln!(text, "** entry points: {}", law.entry_points().join(", "));
    text
}

/// PROPS of the defaults, with the fewest occurrences of the repeating group.
fn defaults(law: &LawDescription) -> Result<Vec<f64>, String> {
    let named = match &law.group {
        Some(group) if group.minimum > 0 => {
            let occurrence: Vec<f64> = split(law).1.iter().map(|parameter| parameter.default_value).collect();
            json!({ &group.name: vec![occurrence; group.minimum] })
        }
        _ => Value::Null,
    };
    props_from_json(law, &named).map_err(|problems| {
        let problems: Vec<_> = problems.iter().map(ToString::to_string).collect();
        format!("{}: its defaults make no PROPS: {}", law.name, problems.join("; "))
    })
}

/// Data lines, each below the names of its values.
fn constants(text: &mut String, law: &LawDescription, props: &[f64]) {
    let with_unit = |Parameter { name, unit, .. }: &Parameter| match unit.as_str() {
        "-" => name.clone(),
        unit => format!("{name} [{unit}]"),
    };
    let mut names = in_order(law).map(with_unit);
    for values in props.chunks(VALUES_A_LINE) {
        let names: Vec<_> = names.by_ref().take(values.len()).collect();
        let values: Vec<_> = values.iter().map(|value| format!("{value:?}")).collect();
        let _ = writeln!(text, "** {}\n{}", names.join(", "), values.join(", "));
    }
}

//! Names and units of columns as axes show them.

use pullout_run::columns::{self, Group};
use std::collections::BTreeMap;

/// Quantity that an axis shows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Quantity {
    /// Symbol or word, in the markup of the pictures (`_{11}` is an index).
    pub name: String,
    /// Unit; empty for a pure number.
    pub unit: String,
}

/// Returns what a column belongs to on axes; states of any law are damage by their names, or stand alone.
pub(crate) fn group_of(column: &str) -> Group {
    match columns::shown(column) {
        Some((.., group)) if group.common().is_some() => group,
        None if is_damage(column) => Group::Damage,
        _ => Group::Other,
    }
}

fn is_damage(column: &str) -> bool {
    matches!(column, "D" | "d" | "damage") || ["D_", "d_", "damage_"].iter().any(|start| column.starts_with(start))
}

impl Quantity {
    /// Returns the quantity of a column; `units` are those of the state variables.
    pub fn of(column: &str, units: &BTreeMap<String, String>) -> Self {
        let (name, unit) = match columns::shown(column) {
            Some((title, unit, _)) => match column.split_once('.') {
                Some((_, fibre)) => (format!("{title}, {fibre}"), unit),
                None => (title.to_owned(), unit),
            },
            None => (symbol(column), units.get(column).map_or("", String::as_str)),
        };
        Self { name, unit: if matches!(unit, "-" | "–" | "1") { String::new() } else { unit.into() } }
    }

    /// Returns the quantity of an axis that holds several columns of a group.
    pub fn common(group: Group) -> Option<Self> {
        group.common().map(|[name, unit]| Self { name: name.into(), unit: unit.into() })
    }

    /// `name [unit]`, the numbers on the axis being the quantity divided by a power of ten.
    pub fn label(&self, exponent: i32) -> String {
        let exponent = exponent.to_string().replace('-', "−");
        let unit = match (exponent.as_str(), self.unit.as_str()) {
            ("0", "") => "–".to_string(),
            ("0", unit) => unit.to_string(),
            (power, "") => format!("10^{{{power}}}"),
            (power, unit) => format!("10^{{{power}}} {unit}"),
        };
        format!("{} [{unit}]", self.name)
    }
}

/// `D_t` → D with index t, `eta_t_max` → η with index t,max, `plastic_strain_11` → plastic strain 11.
fn symbol(column: &str) -> String {
    let mut parts = column.split('_');
    let first = parts.next().unwrap_or_default();
    let greek = match first {
        "alpha" => "α",
        "beta" => "β",
        "eta" => "η",
        "kappa" => "κ",
        "lambda" => "λ",
        "psi" => "ψ",
        "tau" => "τ",
        other => other,
    };
    let index: Vec<&str> = parts.collect();
    if index.is_empty() {
        greek.to_string()
    } else if greek.chars().count() <= 2 {
        format!("{greek}_{{{}}}", index.join(","))
    } else {
        column.replace('_', " ")
    }
}

/// Returns a text with a capital letter, as a row or a title begins.
pub(crate) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

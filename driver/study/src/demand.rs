//! History columns that a file names, and whether histories have them.

use super::Quantity;
use pullout_case::study::{Columns, NamedPlace, Where};
use pullout_case::{CaseProblem, JsonPlace, hint};
use pullout_run::columns;

/// A history column that a file names.
#[derive(Clone, Debug)]
pub struct Demand {
    place: JsonPlace,
    column: String,
    /// A column in whose rows it is looked up.
    partner: Option<String>,
}

impl Demand {
    /// Demands a column by itself.
    pub fn of_column(column: &str, place: JsonPlace) -> Self {
        Self { place, column: column.into(), partner: None }
    }

    /// Demands a column in the rows of another one.
    pub fn in_rows_of(column: &str, other: &str, place: JsonPlace) -> Self {
        Self { place, column: column.into(), partner: Some(other.into()) }
    }

    /// Demands both columns of a curve.
    pub fn of_curve(curve: &Columns, place: &JsonPlace) -> Vec<Self> {
        vec![Self::of_column(&curve.x, place.key("x")), Self::in_rows_of(&curve.y, &curve.x, place.key("y"))]
    }

    /// Demands what a number of a run is made of; `curve` is that of the peak.
    pub fn of_quantity(quantity: &Quantity, curve: &Columns, place: &JsonPlace) -> Vec<Self> {
        let Quantity::Column(value) = quantity else { return Vec::new() };
        let column = &value.column;
        let mut demands = vec![Self::of_column(column, place.key("column"))];
        if matches!(value.at(), Where::X(_) | Where::Named(NamedPlace::Peak)) {
            demands.push(Self::in_rows_of(column, &curve.y, place.key("at")));
        }
        demands.extend(value.over().iter().map(|other| Self::in_rows_of(other, column, place.key("over"))));
        demands
    }

    /// Returns what is wrong with demands on histories of these columns.
    pub fn unmet(demands: &[Self], known: &[String]) -> Vec<CaseProblem> {
        let is_known = |column: &String| known.contains(column);
        let mut problems: Vec<CaseProblem> = Vec::new();
        for Self { place, column, partner } in demands {
            let message = match partner {
                _ if !is_known(column) => format!("the histories have no column '{column}'{}", hint(column, known)),
                Some(other) if columns::are_of_two_files(known, column, other) => {
                    format!("'{column}' and '{other}' are columns of two files: bridging.csv and beam.csv")
                }
                _ => continue,
            };
            // a column is named once although it is needed twice
            if !problems.iter().any(|problem| problem.message == message) {
                problems.push(CaseProblem::new(place.clone(), message));
            }
        }
        problems
    }
}

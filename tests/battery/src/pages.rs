//! The tables of the laws' pages are those that hosts see. `PULLOUT_WRITE_TABLES=1 cargo test -p models pages` writes them.

use std::ffi::CStr;
use umat_abi::law::LawInfo;
use umat_abi::metadata::{Parameter, Text, open_bounds};

/// The head of the table of parameters.
pub const PARAMETERS: &str = "# Parameters\n";
/// The head of the table of state variables.
pub const STATES: &str = "# State variables\n";

fn text(text: Text) -> String {
    // SAFETY: the texts of a table of this program are literals.
    unsafe { CStr::from_ptr(text.as_ptr()) }.to_string_lossy().replace('|', "\\|")
}

/// Formats a number, large ones as `2e18`.
fn number(value: f64) -> String {
    let (plain, exponential) = (format!("{value}"), format!("{value:e}"));
    if exponential.len() < plain.len() { exponential } else { plain }
}

fn admissible(parameter: &Parameter) -> String {
    let choices: Vec<_> = parameter.choices().iter().map(|c| format!("{} {}", c.value, c.name())).collect();
    if !choices.is_empty() {
        return choices.join(", ");
    }
    let is_open = |bit: u32| parameter.open_bounds & bit != 0;
    let lower = if is_open(open_bounds::LOWER) { ">" } else { "≥" };
    let upper = if is_open(open_bounds::UPPER) { "<" } else { "≤" };
    let bounds = [(lower, parameter.lower), (upper, parameter.upper)].into_iter().filter(|(_, x)| x.is_finite());
    bounds.map(|(sign, bound)| format!("{sign} {}", number(bound))).collect::<Vec<_>>().join(", ")
}

fn usual(parameter: &Parameter) -> String {
    let (lower, upper) = (parameter.typical_lower, parameter.typical_upper);
    if lower < upper { format!("{} … {}", number(lower), number(upper)) } else { String::new() }
}

fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let head: Vec<String> = head.iter().map(|name| (*name).to_owned()).collect();
    let rule = head.iter().map(|_| "---".to_owned()).collect();
    [head, rule].into_iter().chain(rows).map(|row| format!("| {} |\n", row.join(" | "))).collect()
}

fn parameters(info: &LawInfo) -> String {
    let row = |p: &Parameter| {
        vec![format!("`{}`", p.name()), text(p.unit), number(p.default_value), admissible(p), usual(p), text(p.doc)]
    };
    table(&["name", "unit", "default", "admissible", "usual", "meaning"], info.parameters.iter().map(row))
}

fn states(info: &LawInfo) -> String {
    let rows = info.states.iter().map(|s| vec![format!("`{}`", s.name()), text(s.unit), text(s.doc)]);
    table(&["name", "unit", "meaning"], rows)
}

/// Returns the page with this table after the head, in place of the table that is there.
fn with_table(page: &str, head: &str, table: &str) -> String {
    let (before, behind) = page.split_once(head).expect("the head");
    let old = behind.trim_start_matches('\n').lines().take_while(|line| line.starts_with('|'));
    let rest = behind.trim_start_matches('\n').lines().skip(old.count()).collect::<Vec<_>>().join("\n");
    format!("{before}{head}\n{table}\n{}\n", rest.trim_start_matches('\n'))
}

/// Compares the tables under these heads of a page with those that hosts see; writes them with `PULLOUT_WRITE_TABLES`.
///
/// # Panics
/// If they differ, or there is no such page.
pub fn check(file: &str, info: &LawInfo, heads: &[&str]) {
    let page = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{file}: {error}"));
    let expected = heads.iter().fold(page.clone(), |page, head| {
        let table = if *head == PARAMETERS { parameters(info) } else { states(info) };
        with_table(&page, head, &table)
    });
    if std::env::var_os("PULLOUT_WRITE_TABLES").is_some() {
        std::fs::write(file, expected).unwrap_or_else(|error| panic!("{file}: {error}"));
    } else {
        assert_eq!(page, expected, "{file}: PULLOUT_WRITE_TABLES=1 writes its tables");
    }
}

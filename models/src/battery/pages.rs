//! The tables of the laws' pages are those that hosts see. `PULLOUT_WRITE_TABLES=1 cargo test -p models pages` writes them.

use crate::{
    biaxial_damage::BiaxialDamage, bond_slip::BondSlip, concrete_damage::ConcreteDamage,
    concrete_damage::ConcreteDamageImplex, drucker_prager::DruckerPrager, inelastic_damage::InelasticDamage,
    j2_plasticity::J2Plasticity, linear_elastic::LinearElastic, pure_damage::PureDamage,
    reverse_cyclic_damage::ReverseCyclicDamage,
};
use std::ffi::CStr;
use umat_abi::law::{InterfaceLaw, Law, LawInfo};
use umat_abi::metadata::{Parameter, Text, open_bounds};

const PARAMETERS: &str = "# Parameters\n";
const STATES: &str = "# State variables\n";

fn text(text: Text) -> String {
    // SAFETY: the texts of a table of this program are literals.
    unsafe { CStr::from_ptr(text.as_ptr()) }.to_string_lossy().replace('|', "\\|")
}

/// `2e18` rather than nineteen digits.
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

/// The page with this table behind the head, in place of one that stands there.
fn with_table(page: &str, head: &str, table: &str) -> String {
    let (before, behind) = page.split_once(head).expect("the head");
    let old = behind.trim_start_matches('\n').lines().take_while(|line| line.starts_with('|'));
    let rest = behind.trim_start_matches('\n').lines().skip(old.count()).collect::<Vec<_>>().join("\n");
    format!("{before}{head}\n{table}\n{}\n", rest.trim_start_matches('\n'))
}

#[test]
fn pages_have_the_tables_that_hosts_see() {
    let pages: [(&str, &LawInfo, &[&str]); 10] = [
        ("linear_elastic/doc.md", &LinearElastic::INFO, &[PARAMETERS, STATES]),
        ("pure_damage/doc.md", &PureDamage::INFO, &[PARAMETERS, STATES]),
        ("inelastic_damage/doc.md", &InelasticDamage::INFO, &[PARAMETERS, STATES]),
        ("reverse_cyclic_damage/doc.md", &ReverseCyclicDamage::INFO, &[PARAMETERS, STATES]),
        ("biaxial_damage/doc.md", &BiaxialDamage::INFO, &[PARAMETERS, STATES]),
        ("concrete_damage/doc.md", &ConcreteDamage::INFO, &[PARAMETERS, STATES]),
        // its parameters are those of the implicit law
        ("concrete_damage/implex.md", &ConcreteDamageImplex::INFO, &[STATES]),
        ("j2_plasticity/doc.md", &J2Plasticity::INFO, &[PARAMETERS, STATES]),
        ("drucker_prager/doc.md", &DruckerPrager::INFO, &[PARAMETERS, STATES]),
        ("bond_slip/doc.md", &BondSlip::INFO, &[PARAMETERS, STATES]),
    ];
    for (file, info, heads) in pages {
        let path = format!("{}/src/{file}", env!("CARGO_MANIFEST_DIR"));
        let page = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let expected = heads.iter().fold(page.clone(), |page, head| {
            let table = if *head == PARAMETERS { parameters(info) } else { states(info) };
            with_table(&page, head, &table)
        });
        if std::env::var_os("PULLOUT_WRITE_TABLES").is_some() {
            std::fs::write(&path, expected).unwrap_or_else(|error| panic!("{path}: {error}"));
        } else {
            assert_eq!(page, expected, "{file}: PULLOUT_WRITE_TABLES=1 writes its tables");
        }
    }
}

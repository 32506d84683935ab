//! Names and units of columns as axes show them.

use std::collections::BTreeMap;

/// What an axis shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Symbol or word, in the markup of the pictures (`_{11}` is an index).
    pub name: String,
    /// Unit; empty for a pure number.
    pub unit: String,
}

/// Columns that belong on a common axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// `e11`, `g12`…
    Strain,
    /// `s11`, `s12`…
    Stress,
    /// `D`, `D_t`, `d`…
    Damage,
    /// `slip_exit`, `slip_tail`.
    Slip,
    /// `load`, `load_axial`…
    Load,
    /// `elastic_energy`, `external_work`…
    Energy,
    /// `open_points`…
    Count,
    /// Anything else: only with itself.
    Other,
}

impl Sort {
    /// Of a column.
    pub fn of(column: &str) -> Self {
        let component = || matches!(&column[1..], "11" | "22" | "33" | "12" | "13" | "23");
        match column.as_bytes().first() {
            Some(b'e' | b'g') if component() => Self::Strain,
            Some(b's') if component() => Self::Stress,
            _ if is_damage(column) => Self::Damage,
            _ if matches!(column, "slip_exit" | "slip_tail") => Self::Slip,
            _ if column == "load" || column.starts_with("load_") => Self::Load,
            _ if matches!(column, "external_work" | "interface_dissipation") || column.ends_with("_energy") => {
                Self::Energy
            }
            _ if column.ends_with("_points") => Self::Count,
            _ => Self::Other,
        }
    }

    /// The quantity of an axis that holds several columns of a sort.
    pub fn common(self) -> Option<Quantity> {
        let (name, unit) = match self {
            Self::Strain => ("ε", ""),
            Self::Stress => ("σ", "MPa"),
            Self::Damage => ("damage", ""),
            Self::Slip => ("slip", "mm"),
            Self::Load => ("load", "N"),
            Self::Energy => ("energy", "N·mm"),
            Self::Count => ("points", ""),
            Self::Other => return None,
        };
        Some(Quantity { name: name.into(), unit: unit.into() })
    }
}

fn is_damage(column: &str) -> bool {
    matches!(column, "D" | "d" | "damage") || ["D_", "d_", "damage_"].iter().any(|start| column.starts_with(start))
}

impl Quantity {
    /// Of a column; `units` are those of the state variables.
    pub fn of(column: &str, units: &BTreeMap<String, String>) -> Self {
        let (name, unit) = match (Sort::of(column), column) {
            (Sort::Strain, _) => {
                (format!("{}_{{{}}}", if column.starts_with('e') { 'ε' } else { 'γ' }, &column[1..]), "")
            }
            (Sort::Stress, _) => (format!("σ_{{{}}}", &column[1..]), "MPa"),
            (_, "slip" | "gap") => (column.into(), "mm"),
            (_, "slip2") => ("slip_{2}".into(), "mm"),
            (_, "tau") => ("τ".into(), "MPa"),
            (_, "tau2") => ("τ_{2}".into(), "MPa"),
            (_, "p") => ("p".into(), "MPa"),
            (_, "time") => ("time".into(), "s"),
            (_, "load") => ("load".into(), "N"),
            (_, "load_lateral") => ("lateral load".into(), "N"),
            (_, "load_axial") => ("axial component of the load".into(), "N"),
            (_, "load_shear") => ("shear component of the load".into(), "N"),
            (_, "spalled_volume") => ("volume of torn matter".into(), "mm³"),
            (_, "spalled_depth") => ("depth of torn matter".into(), "mm"),
            (_, "damaged_volume") => ("damaged volume".into(), "mm³"),
            (_, "separation_length") => ("open length of the interface".into(), "mm"),
            (_, "slip_exit") => ("slip at the exit".into(), "mm"),
            (_, "slip_tail") => ("slip of the tail".into(), "mm"),
            (_, "bearing_pressure_max") => ("greatest bearing pressure".into(), "MPa"),
            (Sort::Energy, _) => (column.replace('_', " "), "N·mm"),
            (Sort::Count, _) => (column.replace('_', " "), ""),
            (_, "sse" | "spd" | "scd") => (column.into(), "N·mm/mm³"),
            (_, "sed" | "sfd" | "svd") => (column.into(), "N·mm/mm²"),
            _ => (symbol(column), units.get(column).map_or("", String::as_str)),
        };
        Self { name, unit: if matches!(unit, "-" | "–" | "1") { String::new() } else { unit.into() } }
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

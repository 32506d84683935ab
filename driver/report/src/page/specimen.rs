//! Parts of the report that only the run of a specimen has.

use crate::without_rounding;
use fe_core::mesh::Overlap;
use maud::{Markup, html};
use pullout_run::number::{rounded, significant};
use pullout_run::pullout::{Findings, PeakLoad};

/// Returns the results in one line.
pub fn load(findings: &Findings) -> Markup {
    html! {
        p {
            @match findings.peak_load {
                Some(PeakLoad { load, slip, step, increment, .. }) => {
                    "Greatest load " (rounded(load)) " N at a slip of " (rounded(slip)) " mm (step " (step)
                    ", increment " (increment) ")."
                },
                None => "No load was measured.",
            }
        }
    }
}

/// What the solver did how often, how long it took, and its penalties.
pub fn work(findings: &Findings) -> Markup {
    html! {
        @if !findings.penalties.is_empty() {
            h2 { "Penalties of contact" }
            table {
                tr { th { "Pair" } th.number { "ε" sub { "N" } " [MPa/mm]" } }
                @for (pair, penalty) in &findings.penalties {
                    tr { td.key { (pair) } td.number { (significant(*penalty, 4)) } }
                }
            }
        }
        @for (when, Overlap { depth, position: [x, y], part, inside }) in &findings.overlaps {
            p {
                "Overlap of deformed bodies at the " (if when == "peak" { "greatest load" } else { "end" }) ": "
                (significant(*depth, 3)) " mm, " (part) " in " (inside) ", at ("
                (significant(*x, 4)) ", " (significant(*y, 4)) ")."
            }
        }
        h2 { "Work done" }
        table {
            @for (name, count) in &findings.statistics {
                tr { td.key { (words(name)) } td.number { (count) } }
            }
            @for (name, seconds) in &findings.times {
                tr { td.key { "Time of " (words(name).to_lowercase()) } td.number { (significant(*seconds, 3)) " s" } }
            }
        }
    }
}

/// The work of the drives, and where it went.
pub fn energies(findings: &Findings) -> Markup {
    let greatest = crate::extremes(findings.energies.values().map(|energy| energy.abs())).1;
    let shown = |energy: f64| without_rounding(energy, greatest);
    let work = shown(findings.energies.get(WORK).copied().unwrap_or(0.0));
    let parts = || {
        let others = findings.energies.iter().filter(|(name, _)| name.as_str() != WORK);
        others.map(|(name, energy)| (name, shown(*energy))).filter(|(_, energy)| *energy != 0.0)
    };
    let sum: f64 = parts().filter(|(name, _)| !OF_OTHERS.contains(&name.as_str())).map(|(_, energy)| energy).sum();
    let missing = shown(work - sum);
    let share = |energy: f64| {
        if work == 0.0 { "–".to_owned() } else { format!("{} %", significant(100.0 * energy / work, 3)) }
    };
    html! {
        h2 { "Energies at the end" }
        table {
            tr { th { "Energy" } th.number { "N·mm" } th.number { "of the work" } }
            tr { td.key { "External work" } td.number { (rounded(work)) } td.number {} }
            @for (name, energy) in parts() {
                tr { td.key { (words(name)) } td.number { (rounded(energy)) } td.number { (share(energy)) } }
            }
            tr { td.key { "External work minus energies" } td.number { (rounded(missing)) } td.number { (share(missing)) } }
        }
        @if let Some(error) = findings.energy_error_max {
            p { "Greatest energy error of all increments: " (significant(error, 3)) "." }
        }
    }
}

const WORK: &str = "external_work";
/// Energies that others have in them: those of which the interface energy consists, and that of a phase field, which is the
/// laws' damage energy anew.
const OF_OTHERS: [&str; 3] = ["interface_stored_energy", "interface_dissipation", "field_energy"];

/// `damage_energy` → Damage energy.
fn words(name: &str) -> String {
    crate::plots::quantity::capital(&name.replace('_', " "))
}

#[cfg(test)]
mod test;

//! What only the run of a specimen has to tell.

use maud::{Markup, html};
use pullout_run::number::{rounded, significant};
use pullout_run::pullout::{Findings, Overlap, PeakLoad};

/// What came out, in a line.
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
        @for (when, Overlap { depth, position: [x, y], part, inside }) in &findings.overlaps {
            p {
                "Overlap of deformed bodies at the " (if when == "peak" { "greatest load" } else { "end" }) ": "
                (significant(*depth, 3)) " mm, " (part) " in " (inside) ", at ("
                (significant(*x, 4)) ", " (significant(*y, 4)) ")."
            }
        }
    }
}

/// The energies with their balance, what was done how often and how long it took.
pub fn findings(findings: &Findings) -> Markup {
    html! {
        (energies(findings))
        @if !findings.penalties.is_empty() {
            h2 { "Penalties of contact" }
            table {
                tr { th { "Pair" } th.number { "ε" sub { "N" } " [MPa/mm]" } }
                @for (pair, penalty) in &findings.penalties {
                    tr { td.key { (pair) } td.number { (significant(*penalty, 4)) } }
                }
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
fn energies(findings: &Findings) -> Markup {
    let work = findings.energies.get(WORK).copied().unwrap_or(0.0);
    let parts = || findings.energies.iter().filter(|(name, _)| name.as_str() != WORK);
    let sum: f64 =
        parts().filter(|(name, _)| !OF_THE_INTERFACE.contains(&name.as_str())).map(|(_, energy)| energy).sum();
    let share = |energy: f64| {
        if work == 0.0 { "–".to_owned() } else { format!("{} %", significant(100.0 * energy / work, 3)) }
    };
    html! {
        h2 { "Energies at the end" }
        table {
            tr { th { "Energy" } th.number { "N·mm" } th.number { "of the work" } }
            tr { td.key { "External work" } td.number { (rounded(work)) } td.number {} }
            @for (name, energy) in parts() {
                tr { td.key { (words(name)) } td.number { (rounded(*energy)) } td.number { (share(*energy)) } }
            }
            tr { td.key { "Work less energies" } td.number { (rounded(work - sum)) } td.number { (share(work - sum)) } }
        }
        p { "Greatest energy error of all increments: " (significant(findings.energy_error_max, 3)) "." }
    }
}

const WORK: &str = "external_work";
/// What the interface energy consists of.
const OF_THE_INTERFACE: [&str; 2] = ["interface_stored_energy", "interface_dissipation"];

/// `damage_energy` → Damage energy.
fn words(name: &str) -> String {
    super::capital(&name.replace('_', " "))
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn energies_are_told_with_their_shares_and_what_is_missing() {
        let interface = [("interface_energy", 5.0), ("interface_stored_energy", 1.0), ("interface_dissipation", 4.0)];
        let energies = [("external_work", 8.0), ("elastic_energy", 2.0)].into_iter().chain(interface);
        let mut found = Findings { energy_error_max: 0.125, ..Findings::default() };
        found.energies = energies.into_iter().map(|(name, energy)| (name.to_owned(), energy)).collect();
        found.statistics.insert("umat_calls".into(), 1234);
        found.penalties.insert("left".into(), 51_724_137.931);
        let page = findings(&found).into_string();
        let row = |key: &str, cells: &str| format!("<td class=\"key\">{key}</td>{cells}");
        let number = |text: &str| format!("<td class=\"number\">{text}</td>");
        for expected in [
            row("Interface energy", &[number("5"), number("62.5 %")].concat()),
            row("Interface dissipation", &[number("4"), number("50 %")].concat()),
            row("Work less energies", &[number("1"), number("12.5 %")].concat()),
            row("Umat calls", &number("1234")),
            "0.125".into(),
        ] {
            assert!(page.contains(&expected), "{expected}\n{page}");
        }
        assert!(load(&found).into_string().contains("No load was measured"));
        found.peak_load = Some(PeakLoad { load: 31.25, slip: 0.0625, step: 1, increment: 7, time: 0.1 });
        let page = load(&found).into_string();
        assert!(page.contains("Greatest load 31.25 N at a slip of 0.0625 mm (step 1, increment 7)"), "{page}");
        assert!(!page.contains("Overlap"), "{page}");
        let (part, inside) = ("fibre".to_owned(), "matrix".to_owned());
        found.overlaps.insert("end".into(), Overlap { depth: 0.0703125, position: [0.25, -0.5], part, inside });
        let page = load(&found).into_string();
        let expected = "Overlap of deformed bodies at the end: 0.0703 mm, fibre in matrix, at (0.25, −0.5).";
        assert!(page.contains(expected), "{page}");
    }
}

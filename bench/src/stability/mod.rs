//! Extreme inputs for the laws and the FE core, and their results: tried, failed, worst.

mod laws;
mod plugins;
mod progress;
mod specimens;
#[cfg(test)]
mod test;
mod variations;

use super::page::Page;
use super::table::{Cell, Table};
use super::{BenchError, Settings};
use progress::Progress;

/// States of each form of a law and each stress state, unless the user says how many.
const STATES: u64 = 1_000_000;
const QUICK_STATES: u64 = 1000;
/// With `--quick`, one variation of the specimens in this many is run.
const QUICK_STRIDE: usize = 12;

/// A line of the one table.
#[derive(Clone, Debug)]
struct Row {
    /// Whose: "law", "plugin", "specimen".
    part: &'static str,
    /// Law and form, or specimen.
    subject: String,
    /// Stress state, or what is varied.
    situation: String,
    /// The promise, or the variation.
    case: String,
    tried: u64,
    /// Not compared, or refused with a clear message.
    excluded: u64,
    failed: u64,
    /// Worst error over the allowed one.
    worst: Option<f64>,
    /// Where, why, how much.
    note: String,
}

/// Everything.
pub(super) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let default = if settings.quick { QUICK_STATES } else { STATES };
    let states = settings.states.unwrap_or(default);
    let laws = laws::measure(states, &Progress::new("laws", laws::total(states)))?;
    let plugins = plugins::measure(settings)?;
    let stride = if settings.quick { QUICK_STRIDE } else { 1 };
    let runs = specimens::measure(stride, specimens::LIMIT, &settings.plugin_paths, |count| {
        Progress::new("specimens", count)
    })?;
    let rows: Vec<Row> =
        laws.iter().map(laws::Thrown::rows).chain([plugins.clone(), specimens::rows(&runs)]).flatten().collect();
    let failed = rows.iter().map(|row| row.failed).sum::<u64>();
    let broken: Vec<String> = rows.iter().filter(|row| row.failed > 0).map(description).collect();
    let mut notes = vec![match failed {
        0 => "Nothing failed.".to_owned(),
        _ => format!("{failed} of {} failed:", rows.iter().map(|row| row.tried).sum::<u64>()),
    }];
    notes.extend(broken);
    notes.extend(specimens::exceptions(&runs));
    let summaries = vec![
        ("Laws".to_owned(), laws::summary(&laws)),
        ("What the laws promise".to_owned(), promises(&rows)),
        ("Plugins (`pullout plugin check`)".to_owned(), plugins::summary(&plugins)),
        ("Specimens".to_owned(), specimens::summary(&runs)),
    ];
    Ok(Page {
        title: "Numerical stability",
        method: METHOD
            .replace("{states}", &states.to_string())
            .replace("{increments}", &specimens::LIMIT.increments.to_string())
            .replace("{seconds}", &specimens::LIMIT.processor.as_secs().to_string()),
        data: data(&rows),
        summaries,
        notes,
        figures: Vec::new(),
        failed: (failed > 0).then(|| format!("{failed} checks failed")),
    })
}

const METHOD: &str = "\
*Laws*: {states} increments of each form of each law in each stress state, in histories of five from the virgin state, half of them with
ordinary parameters, half with any admissible ones (E over 6 decades, ν to 0.4999, A over 24 decades, B from 0.1 to 30,
thresholds of 0). Strains of 1e-16 to 10 and of 1e3 × the peak strain, zero and the committed strain again, its opposite,
subnormal numbers, NaN and ±∞, principal strains that are equal, apart by one unit of the last digit or by 1e-16 … 1e-4 of them. Tangents are
compared with fourth-order differences along a random direction; excluded are those within the reach of the differences of a kink and those
that rounding of the stress hides. *Worst* is the worst error over the one that is allowed. *Plugins*: the same laws through their
libraries, poisoned arguments, wrong counts and NULL among them. *Specimens*: variations of small cases; *refused* is a message before anything runs
(a failure, unless it is a known limit),
*stopped* an end before the last increment, with a message and the rows up to there, *over the limit* a run that the benchmark ended after
{increments} increments or {seconds} s of a processor, *known limit* a failure that is explained in its row and in the notes.";

fn description(row: &Row) -> String {
    let Row { subject, situation, case, failed, tried, note, .. } = row;
    format!("{subject}, {situation}, {case}: {failed} of {tried}. {note}")
}

fn data(rows: &[Row]) -> Table {
    let mut table = Table::new([
        "part",
        "subject",
        "situation",
        "case",
        "tried",
        "excluded",
        "failed",
        "worst_over_allowed",
        "note",
    ]);
    for row in rows {
        table.push([
            row.part.into(),
            row.subject.clone().into(),
            row.situation.clone().into(),
            row.case.clone().into(),
            row.tried.into(),
            row.excluded.into(),
            row.failed.into(),
            row.worst.into(),
            row.note.clone().into(),
        ]);
    }
    table
}

/// Each promise over all laws.
fn promises(rows: &[Row]) -> Table {
    let mut table = Table::new(["promise", "tried", "excluded", "failed", "worst / allowed"]);
    let of_laws: Vec<&Row> = rows.iter().filter(|row| row.part == laws::PART).collect();
    let mut names: Vec<&str> = of_laws.iter().map(|row| row.case.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    for name in names {
        let of_name = || of_laws.iter().filter(|row| row.case == name);
        let sum = |number: fn(&Row) -> u64| Cell::from(of_name().map(|row| number(row)).sum::<u64>());
        let worst = of_name().filter_map(|row| row.worst).reduce(f64::max);
        table.push([name.into(), sum(|row| row.tried), sum(|row| row.excluded), sum(|row| row.failed), worst.into()]);
    }
    table
}

//! The laws through their libraries: what `pullout plugin check` says, the ABI's poisoned arguments among it.

use super::Row;
use super::progress::Progress;
use crate::table::Table;
use crate::{BenchError, Settings};
use models::NAMES;
use pullout_check::conformance::{self, Options, Verdict};
use umat_abi::host::{Found, Plugin, search_paths};

const PART: &str = "plugin";

/// Random histories of each stress state.
const HISTORIES: usize = 1000;
const QUICK_HISTORIES: usize = 40;

/// Checks all of them.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Row>, BenchError> {
    let progress = Progress::new("plugins", NAMES.len() as u64);
    let searched = search_paths(&settings.plugin_paths);
    let states = if settings.quick { QUICK_HISTORIES } else { HISTORIES };
    let mut rows = Vec::new();
    for name in NAMES.iter().copied() {
        let Some(found) = Found::by_name(name, &searched) else {
            return Err(BenchError::Missing { plugin: name.into(), searched });
        };
        let library = pullout_run::isolation::load(&found.path)?;
        for law in library.laws() {
            let plugin = Plugin::with_defaults(&library, law);
            let report = conformance::check(&plugin, &Options { states, ..Options::default() });
            rows.extend(report.rows.into_iter().map(|row| of_check(name, row)));
        }
        progress.advance(1, name);
    }
    Ok(rows)
}

/// A check that does not apply is excluded.
fn of_check(plugin: &str, row: conformance::CheckRow) -> Row {
    let is = |verdict: Verdict| u64::from(row.verdict == verdict);
    Row {
        part: PART,
        subject: plugin.into(),
        situation: row.stress_state.into(),
        case: row.check.into(),
        tried: 1,
        excluded: is(Verdict::Skipped),
        failed: is(Verdict::Fail),
        worst: None,
        note: format!("{} {}", row.figure, row.detail).trim().into(),
    }
}

/// One line for each plugin.
pub(super) fn summary(rows: &[Row]) -> Table {
    let mut table = Table::new(["plugin", "checks", "not applicable", "failed"]);
    for plugin in NAMES.iter().copied() {
        let of_plugin = || rows.iter().filter(|row| row.subject == plugin);
        let sum = |number: fn(&Row) -> u64| of_plugin().map(number).sum::<u64>();
        table.push([
            plugin.into(),
            sum(|row| row.tried).into(),
            sum(|row| row.excluded).into(),
            sum(|row| row.failed).into(),
        ]);
    }
    table
}

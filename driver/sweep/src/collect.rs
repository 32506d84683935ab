//! Rows that a sweep has so far.

use crate::claim::Due;
use crate::run::Measured;
use crate::store::{Keys, Store, Sweep};
use crate::table::{Column, Table};
use crate::work::{Maker, part};
use pullout_run::isolation;
use pullout_run::path::FailureKind;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::io;
use std::path::PathBuf;

/// The word of a row for how a run ended.
pub(crate) fn state(row: &Measured) -> &'static str {
    match row.failed_at.map(|at| at.kind) {
        None if row.is_lost => LOST,
        None => DONE,
        Some(FailureKind::Failed) => "failed",
        Some(FailureKind::Crashed) => "crashed",
        Some(FailureKind::Timeout) => "timeout",
    }
}

const DONE: &str = "done";
const LOST: &str = "lost";
/// The word for a run that has no row yet.
const LEFT: &str = "left";

/// A run that was lost so often is over: it may be what ends its workers.
pub(crate) const MOST_LOSSES: u32 = 3;

/// The rows of a store, by keys.
#[derive(Default)]
pub(crate) struct Known {
    rows: HashMap<String, KnownRow>,
    /// Parts that were read.
    parts: HashSet<PathBuf>,
}

/// The row of a key that counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KnownRow {
    /// Number of the part, and the row in it.
    place: (usize, usize),
    pub is_done: bool,
    is_lost: bool,
    pub attempt: u32,
    time: f64,
}

impl KnownRow {
    /// Returns whether the run is over: it is not run again by itself.
    pub fn is_over(&self) -> bool {
        !self.is_lost || self.attempt >= MOST_LOSSES
    }
}

impl Known {
    /// Reads what parts tell that were not there before.
    pub fn read(&mut self, store: &Store) -> io::Result<()> {
        let wanted = |name: &str| ["key", "status", "attempt", "time"].contains(&name);
        for path in store.parts()? {
            if !self.parts.contains(&path) {
                self.add(self.parts.len(), &Table::read(&path, wanted)?);
                self.parts.insert(path);
            }
        }
        Ok(())
    }

    /// Adds the rows of a part with a number.
    fn add(&mut self, index: usize, part: &Table) {
        let column = |name: &str| part.column(name);
        let keys = column("key").map(Column::texts).unwrap_or_default();
        let states = column("status").map(Column::texts).unwrap_or_default();
        for (row, (key, status)) in keys.iter().zip(states).enumerate() {
            let Some(key) = key else { continue };
            let number = |name: &str| column(name).and_then(|column| column.number(row)).unwrap_or_default();
            let [is_done, is_lost] = [DONE, LOST].map(|word| status.as_deref() == Some(word));
            let (attempt, time) = (number("attempt") as u32, number("time"));
            let new = KnownRow { place: (index, row), is_done, is_lost, attempt, time };
            // done before others, and the last
            let is_better = |old: &KnownRow| (new.is_done, new.time) >= (old.is_done, old.time);
            if self.rows.get(key).is_none_or(is_better) {
                self.rows.insert(key.clone(), new);
            }
        }
    }

    /// Returns whether a run that was due is over meanwhile.
    pub fn is_over_since(&self, due: &Due) -> bool {
        self.best(&due.key).is_some_and(|row| row.attempt >= due.attempt && row.is_over())
    }

    /// The row of a key that counts.
    pub fn best(&self, key: &str) -> Option<KnownRow> {
        self.rows.get(key).copied()
    }
}

/// Progress of a sweep.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Standing {
    /// Runs of the sweep.
    pub runs: usize,
    /// Runs that are over, by their endings.
    pub over: BTreeMap<String, usize>,
    /// Time of the processors on those, s.
    pub cpu_s: f64,
    /// Time of the clock on those, each by itself, s.
    pub wall_s: f64,
}

impl Standing {
    /// Reads how a store stands.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn of(store: &Store) -> io::Result<Self> {
        let sweep = store.sweep()?;
        let wants = |name: &str| ["key", "status", "attempt", "time", "cpu_s", "wall_s"].contains(&name);
        let rows = gather(store, &sweep, wants)?;
        let mut standing = Self { runs: sweep.runs.len(), ..Self::default() };
        let attempt = |row| rows.column("attempt").and_then(|column| column.number(row)).unwrap_or_default();
        for (row, status) in rows.column("status").map(Column::texts).unwrap_or_default().iter().enumerate() {
            let Some(status) = status else { continue };
            if status != LEFT && (status != LOST || attempt(row) >= f64::from(MOST_LOSSES)) {
                *standing.over.entry(status.clone()).or_default() += 1;
            }
        }
        let sum = |name: &str| (0..rows.rows()).filter_map(|row| rows.column(name)?.number(row)).sum();
        (standing.cpu_s, standing.wall_s) = (sum("cpu_s"), sum("wall_s"));
        Ok(standing)
    }

    /// Runs that are left.
    pub fn left(&self) -> usize {
        self.runs - self.over.values().sum::<usize>()
    }
}

/// The rows of a sweep, one for each run in their order, with its number; a run that is left has no more than its parameters.
///
/// # Errors
/// The store cannot be read.
pub fn collect(store: &Store) -> io::Result<Table> {
    gather(store, &store.sweep()?, |_| true)
}

fn gather(store: &Store, sweep: &Sweep, wants: impl Fn(&str) -> bool) -> io::Result<Table> {
    let parts: io::Result<Vec<Table>> = store.parts()?.iter().map(|part| Table::read(part, &wants)).collect();
    let (parts, mut known) = (parts?, Known::default());
    parts.iter().enumerate().for_each(|(index, part)| known.add(index, part));
    let mut keys = Keys::new(sweep, isolation::identity()?);
    let runs: Vec<usize> = (0..sweep.runs.len()).collect();
    let keys: Vec<String> = runs.iter().map(|&run| keys.of(run)).collect();
    let rows: Vec<Option<(usize, usize)>> = keys.iter().map(|key| Some(known.best(key)?.place)).collect();
    let mut table = part(sweep, &[], &[], &Maker::default());
    table.columns.retain(|(name, _)| wants(name));
    table.gather(&parts, &rows);
    // a row of an earlier plan has what that one varied, and runs that are alike but for their titles have one row
    let varied = sweep.varied(&runs).into_iter();
    for (name, column) in varied.chain([("key".to_owned(), Column::Text(keys.into_iter().map(Some).collect()))]) {
        if let Some((_, own)) = table.columns.iter_mut().find(|(other, _)| *other == name) {
            *own = column;
        }
    }
    if let Some((_, Column::Text(states))) = table.columns.iter_mut().find(|(name, _)| name == "status") {
        let left = states.iter_mut().zip(&rows).filter(|(_, row)| row.is_none());
        left.for_each(|(state, _)| *state = Some(LEFT.into()));
    }
    let numbers = runs.into_iter().map(|run| i64::try_from(run).ok()).collect();
    table.columns.insert(0, ("run".to_owned(), Column::Count(numbers)));
    Ok(table)
}

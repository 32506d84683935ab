//! Rows of a sweep: how a table has them, and which there are so far.

use crate::claim::PendingRun;
use crate::run::Measured;
use crate::store::{Keys, Store, Sweep};
use crate::table::{Column, Table};
use pullout_run::isolation;
use pullout_run::path::FailureKind;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::PathBuf;
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use std::{fmt, fs, io};

/// Machine and program that make rows.
#[derive(Default)]
pub(crate) struct Maker {
    pub host: String,
    /// Name of the processor.
    cpu: String,
    /// The program, in hexadecimal.
    pub engine: String,
}

impl Maker {
    /// The program of this identity, on this machine.
    pub fn new(identity: [u8; 32]) -> Self {
        let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
        let cpu_info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = cpu_info
            .lines()
            .find_map(|line| Some(line.strip_prefix("model name")?.split_once(':')?.1.trim().to_owned()));
        let engine = pullout_run::input::digits(identity);
        Self { host: host.trim().to_owned(), cpu: model.unwrap_or_default(), engine }
    }
}

/// A part of the rows of a sweep.
pub(crate) fn part(sweep: &Sweep, runs: &[PendingRun], rows: &[Measured], maker: &Maker) -> Table {
    let keep = &sweep.keep;
    let text = |values: &dyn Fn(usize) -> Option<String>| Column::Text((0..rows.len()).map(values).collect());
    let number = |values: &dyn Fn(usize) -> Option<f64>| Column::Number((0..rows.len()).map(values).collect());
    let count = |values: &dyn Fn(usize) -> Option<u64>| {
        Column::Count((0..rows.len()).map(|k| values(k).and_then(|count| i64::try_from(count).ok())).collect())
    };
    let place = |k: usize| rows[k].failed_at.filter(|at| at.step > 0);
    let mut columns = vec![
        ("key".to_owned(), text(&|k| Some(runs[k].key.clone()))),
        ("status".to_owned(), text(&|k| Some(state(&rows[k]).into()))),
        ("message".to_owned(), text(&|k| rows[k].message.clone())),
        ("at_step".to_owned(), count(&|k| place(k).map(|at| at.step.into()))),
        ("at_increment".to_owned(), count(&|k| place(k).map(|at| at.increment.into()))),
    ];
    let numbers: Vec<usize> = runs.iter().map(|due| due.run).collect();
    columns.extend(sweep.varied(&numbers));
    for (index, name) in keep.quantities.keys().enumerate() {
        columns.push((format!("q.{name}"), number(&|k| rows[k].quantities.get(index).copied().flatten())));
    }
    for (index, name) in keep.curves.iter().enumerate() {
        let lists = rows.iter().map(|row| row.curves.get(index).cloned().unwrap_or_default()).collect();
        columns.push((format!("curve.{name}"), Column::List(lists)));
    }
    for (index, name) in ["increments", "iterations", "cutbacks"].into_iter().enumerate() {
        columns.push((name.to_owned(), count(&|k| Some(rows[k].counts[index]))));
    }
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or(Duration::ZERO).as_secs_f64();
    columns.extend([
        ("wall_s".to_owned(), number(&|k| Some(rows[k].times[0]))),
        ("cpu_s".to_owned(), number(&|k| Some(rows[k].times[1]))),
        ("attempt".to_owned(), count(&|k| Some(runs[k].attempt.into()))),
        ("host".to_owned(), text(&|_| Some(maker.host.clone()))),
        ("cpu".to_owned(), text(&|_| Some(maker.cpu.clone()))),
        ("engine".to_owned(), text(&|_| Some(maker.engine.clone()))),
        ("time".to_owned(), number(&|_| Some(now))),
    ]);
    Table { columns }
}

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
/// Status of a run that has no row yet.
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
    /// Reads the parts that are new since the last call.
    pub fn read(&mut self, store: &Store) -> io::Result<()> {
        let wanted = |name: &str| ["key", "status", "attempt", "time"].contains(&name);
        for path in store.parts()? {
            if !self.parts.contains(&path) {
                self.add(self.parts.len(), &Store::part(&path, wanted)?);
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
            // done before others, then the last attempt: clocks of machines may be ahead
            let rank = |row: &KnownRow| (row.is_done, row.attempt, row.time);
            let is_better = |old: &KnownRow| rank(&new) >= rank(old);
            if self.rows.get(key).is_none_or(is_better) {
                self.rows.insert(key.clone(), new);
            }
        }
    }

    /// Returns whether a run that was due is over meanwhile.
    pub fn is_over_since(&self, due: &PendingRun) -> bool {
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
    /// The store cannot be read.
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

    /// Runs that are over.
    pub fn finished(&self) -> usize {
        self.over.values().sum()
    }

    /// Runs that are left.
    pub fn left(&self) -> usize {
        self.runs - self.finished()
    }
}

impl fmt::Display for Standing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (over, left) = (self.finished(), self.left());
        write!(f, "{} runs, {over} finished", self.runs)?;
        if over == 0 {
            return write!(f, ", {left} to do");
        }
        let words: Vec<String> = self.over.iter().map(|(name, count)| format!("{count} {name}")).collect();
        let each = self.wall_s / over as f64;
        let work = each * left as f64;
        write!(f, " ({}), {left} to do; {each:.4} s each, {work:.0} s of work to do", words.join(", "))
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
    let parts: io::Result<Vec<Table>> = store.parts()?.iter().map(|part| Store::part(part, &wants)).collect();
    let (parts, mut known) = (parts?, Known::default());
    parts.iter().enumerate().for_each(|(index, part)| known.add(index, part));
    let mut keys = Keys::new(sweep, isolation::identity()?);
    let runs: Vec<usize> = (0..sweep.runs.len()).collect();
    let keys: Vec<String> = runs.iter().map(|&run| keys.of(run)).collect();
    let rows: Vec<Option<(usize, usize)>> = keys.iter().map(|key| Some(known.best(key)?.place)).collect();
    let mut table = part(sweep, &[], &[], &Maker::default());
    table.columns.retain(|(name, _)| wants(name));
    table.gather(&parts, &rows);
    // a row of an earlier plan has what that plan varied, and runs that differ only in their titles share one row
    let varied = sweep.varied(&runs).into_iter().enumerate();
    let varied = varied.map(|(k, (name, column))| (name, if sweep.is_whole(k) { column.whole() } else { column }));
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

#[cfg(test)]
mod test {
    use super::*;

    /// A worker whose clock is a day ahead fails; the attempts after it count nevertheless, whichever part is read first.
    #[test]
    fn the_last_attempt_counts_whatever_the_clocks_say() {
        let row = |status: &str, attempt: i64, time: f64| Table {
            columns: vec![
                ("key".into(), Column::Text(vec![Some("k".into())])),
                ("status".into(), Column::Text(vec![Some(status.into())])),
                ("attempt".into(), Column::Count(vec![Some(attempt)])),
                ("time".into(), Column::Number(vec![Some(time)])),
            ],
        };
        let best = |rows: &[Table]| {
            let mut known = Known::default();
            rows.iter().enumerate().for_each(|(index, row)| known.add(index, row));
            known.best("k").expect("a row").place.0
        };
        let rows = [row("failed", 1, 86_400.0), row("crashed", 2, 10.0)];
        assert_eq!(best(&rows), 1);
        let [ahead, later] = rows;
        assert_eq!(best(&[later.clone(), ahead.clone()]), 0);
        // of the same attempt the later one; what is done before all
        assert_eq!(best(&[row("failed", 2, 9.0), later.clone()]), 1);
        assert_eq!(best(&[row("done", 1, 0.0), later]), 0);
    }
}

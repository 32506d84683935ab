//! Works off what is left of a sweep.

use crate::batch::Batch;
use crate::claim::{Claim, ClaimHeader, ClaimedKeys, OrphanedClaim, PendingRun, left_behind};
use crate::collect::{Known, MOST_LOSSES, Maker, part};
use crate::run::{Measured, measure};
use crate::store::{Keep, Keys, Store, Sweep};
use pullout_run::in_threads;
use pullout_run::isolation::{self, End, Need, Passage, Watch, WorkerFailure};
use pullout_run::path::{FailedAt, FailureKind};
use pullout_run::{replay, signals};
use serde_json::Value;
use std::collections::{HashMap, HashSet, VecDeque};
use std::fs;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;
use umat_abi::host;

/// Interval between writes, s: the work lost at most when a machine fails.
const CHUNK: f64 = 30.0;
/// Most runs in a part unless the user says otherwise.
const MOST_IN_A_PART: usize = 20_000;
/// Most numbers of curves in a part: some 600 MB of text, of which a file is read back whole.
const MOST_NUMBERS: usize = 1 << 25;
/// Where the user asks for small parts, the rows of others are read again after so many times what it took: a tenth of the time at
/// most.
const BETWEEN_READINGS: u32 = 10;

/// Settings of a sweep's work.
#[derive(Clone, Debug)]
pub struct WorkSettings {
    /// Part of all runs: its number from 0, and the number of parts.
    pub chunk: Option<(usize, usize)>,
    /// Processes or threads at a time.
    pub jobs: usize,
    /// Runs of one part of the rows; default: as many as take half a minute.
    pub chunk_runs: Option<usize>,
    /// Whether runs are made in threads of this process, if all call only libraries that were built with it.
    pub in_process: bool,
    /// Repeat runs that failed, crashed or took too long.
    pub again: bool,
    /// Whether the folder is from an unknown source: its cases may name plugins of the search path alone.
    pub is_untrusted: bool,
}

/// Outcome of a sweep's work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Worked {
    /// Runs that were there before.
    pub kept: usize,
    /// Runs that are over now.
    pub ran: usize,
    /// Runs that other workers have finished meanwhile, or are running.
    pub elsewhere: usize,
    /// Runs that remain.
    pub left: usize,
}

/// State that all threads share.
struct JobQueue<'w> {
    store: &'w Store,
    sweep: &'w Sweep,
    work: &'w WorkSettings,
    identity: [u8; 32],
    maker: Maker,
    queue: Mutex<Queue>,
    /// Runs that were due at the start.
    count: usize,
    over: AtomicUsize,
    /// Receives the number of finished runs and the total.
    report: &'w (dyn Fn(usize, usize) + Sync),
}

/// Runs that remain, and those of them that other workers have claimed.
struct Queue {
    due: VecDeque<PendingRun>,
    known: Known,
    taken: ClaimedKeys,
    /// The time at which the rows of others are read again.
    next_reading: Instant,
    /// Runs that others have finished since the start.
    elsewhere: usize,
}

/// Runs the remaining runs of a sweep. `report` receives the number of finished runs and the total that remained.
///
/// # Errors
/// The store cannot be read or written, processes cannot be started. What is done is kept.
pub fn work(store: &Store, work: &WorkSettings, report: &(dyn Fn(usize, usize) + Sync)) -> io::Result<Worked> {
    let sweep = store.sweep()?;
    store.check_bundles(&sweep)?;
    if work.is_untrusted {
        refuse_libraries(store, &sweep)?;
    }
    let identity = isolation::identity()?;
    let queue = Queue {
        due: VecDeque::new(),
        known: Known::default(),
        taken: ClaimedKeys::new(),
        next_reading: Instant::now(),
        elsewhere: 0,
    };
    let (queue, over) = (Mutex::new(queue), AtomicUsize::new(0));
    let mut office =
        JobQueue { store, sweep: &sweep, work, identity, maker: Maker::new(identity), queue, count: 0, over, report };
    let (number, of) = work.chunk.unwrap_or((0, 1));
    let count = sweep.runs.len();
    let runs = count * number / of..count * (number + 1) / of;
    let due = office.due(runs.clone())?;
    let is_apart = !work.in_process || office.calls_others(&due);
    office.count = due.len();
    let kept = runs.len() - due.len();
    let jobs = work.jobs.clamp(1, due.len().max(1));
    office.queue().due = due.into();
    for ended in in_threads((0..jobs).map(|_| || office.run_worker(is_apart))) {
        ended?.unwrap_or_else(|panic| resume_unwind(panic))?;
    }
    let (mut queue, ran) = (office.queue(), office.over.load(Ordering::Relaxed));
    office.look(&mut queue)?;
    let others = queue.due.iter().filter(|due| queue.is_taken(due) || queue.known.is_over_since(due)).count();
    let elsewhere = queue.elsewhere + others;
    Ok(Worked { kept, ran, elsewhere, left: office.count - ran - elsewhere })
}

/// Refuses a sweep whose cases choose what is called.
fn refuse_libraries(store: &Store, sweep: &Sweep) -> io::Result<()> {
    for run in 0..sweep.runs.len() {
        let document = sweep.document(run);
        for material in isolation::materials(&document) {
            let names_a_file = material["plugin"].as_str().is_some_and(host::names_a_file);
            let what = match (names_a_file, material["symbol"].is_null()) {
                (true, _) => &material["plugin"],
                (false, false) => &material["symbol"],
                (false, true) => continue,
            };
            let message = "--untrusted allows plugins of the search path, by their names, and no symbol in them";
            let file = store.folder().join("sweep.json");
            let message = format!("{}: run {run} calls {what}: {message}", file.display());
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
    }
    Ok(())
}

impl Queue {
    /// Returns whether another worker is at a run.
    fn is_taken(&self, due: &PendingRun) -> bool {
        self.taken.values().any(|keys| keys.contains(&due.key))
    }
}

impl JobQueue<'_> {
    fn queue(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The runs among these that have no row that counts.
    fn due(&self, runs: std::ops::Range<usize>) -> io::Result<Vec<PendingRun>> {
        let mut queue = self.queue();
        self.look(&mut queue)?;
        let (mut keys, mut seen, mut due) = (Keys::new(self.sweep, self.identity), HashSet::new(), Vec::new());
        for run in runs {
            let key = keys.of(run);
            let attempts = match queue.known.best(&key) {
                Some(row) if row.is_over() && (row.is_done || !self.work.again) => continue,
                Some(row) => row.attempt,
                None => 0,
            };
            // the same case twice is run once
            if seen.insert(key.clone()) {
                due.push(PendingRun { run, key, attempt: attempts + 1 });
            }
        }
        // a run that was lost comes last: if its worker was killed by somebody else, the next kill hits another one
        due.sort_by_key(|due| due.attempt);
        Ok(due)
    }

    /// Returns whether these runs call libraries that were not built with this program.
    fn calls_others(&self, due: &[PendingRun]) -> bool {
        let runs: Vec<usize> = due.iter().map(|due| due.run).collect();
        !runs.is_empty() && self.need(&runs).libraries.keys().any(|library| !isolation::is_shipped(library))
    }

    /// Reads what other workers have claimed and done, and keeps the rows of workers that have ended.
    fn look(&self, queue: &mut Queue) -> io::Result<()> {
        let left = left_behind(self.store, &self.maker.engine, &self.maker.host, &mut queue.taken)?;
        // after the claims, because a row is there before its claim goes; small parts are many and are not read every time
        let start = Instant::now();
        if self.work.chunk_runs.is_none() || start >= queue.next_reading || !left.is_empty() {
            queue.known.read(self.store)?;
            queue.next_reading = Instant::now() + BETWEEN_READINGS * start.elapsed();
        }
        if left.is_empty() {
            return Ok(());
        }
        self.take_over(left, &queue.known)?;
        queue.known.read(self.store)
    }

    /// Keeps the rows of workers that have ended, and names the runs that were lost with them.
    fn take_over(&self, left: Vec<OrphanedClaim>, known: &Known) -> io::Result<()> {
        let mut keys = Keys::new(self.sweep, self.identity);
        let numbers: HashMap<String, usize> = (0..self.sweep.runs.len()).map(|run| (keys.of(run), run)).collect();
        for mut left in left {
            if left.has_begun && left.rows.len() < left.head.runs.len() {
                left.rows.push(lost(&left.host, left.head.runs[left.rows.len()].attempt, &self.sweep.keep));
            }
            let rows = left.head.runs.iter().zip(&left.rows).filter_map(|(due, row)| {
                // it is written already, or no part of the sweep any more
                let is_new = known.best(&due.key).is_none_or(|known| known.attempt < due.attempt);
                let run = *numbers.get(&due.key).filter(|_| is_new)?;
                Some((PendingRun { run, ..due.clone() }, row.clone()))
            });
            let (runs, rows): (Vec<PendingRun>, Vec<Measured>) = rows.unzip();
            self.put(&runs, &rows)?;
        }
        Ok(())
    }

    /// Claims the next block of runs that no other worker has done or is at; `None` if there are none, or a signal asks for
    /// the end.
    fn take(&self) -> io::Result<Option<(Claim, Vec<PendingRun>)>> {
        let mut queue = self.queue();
        if signals::received().is_some() || queue.due.is_empty() {
            return Ok(None);
        }
        let _turn = self.store.turn()?;
        self.look(&mut queue)?;
        // smaller and smaller, so that all processors end at about the same time, but not so small that starting children counts
        let (jobs, most) = (self.work.jobs.max(1), self.work.chunk_runs.unwrap_or(MOST_IN_A_PART));
        let size = queue.due.len().div_ceil(8 * jobs).max(self.count / (64 * jobs)).clamp(1, most);
        let mut block = Vec::new();
        for _ in 0..queue.due.len() {
            if block.len() == size {
                break;
            }
            let Some(mut due) = queue.due.pop_front() else { break };
            if queue.known.is_over_since(&due) {
                queue.elsewhere += 1;
                continue;
            }
            if let Some(row) = queue.known.best(&due.key) {
                due.attempt = due.attempt.max(row.attempt + 1);
            }
            if queue.is_taken(&due) {
                queue.due.push_back(due);
            } else {
                block.push(due);
            }
        }
        if block.is_empty() {
            return Ok(None);
        }
        let head = ClaimHeader { engine: self.maker.engine.clone(), runs: block.clone() };
        Ok(Some((Claim::new(self.store, &self.maker.host, &head)?, block)))
    }

    /// Seconds after which rows are written.
    fn seconds(&self) -> f64 {
        if self.work.chunk_runs.is_some() { f64::INFINITY } else { CHUNK }
    }

    /// Puts rows of runs, which stand in the order of `runs`, into the store.
    fn put(&self, runs: &[PendingRun], rows: &[Measured]) -> io::Result<()> {
        for (due, row) in runs.iter().zip(rows) {
            if let Some(case) = &row.replay {
                self.store.keep_replay(&due.key, case)?;
            }
        }
        let numbers: usize = rows.iter().flat_map(|row| &row.curves).map(Vec::len).sum();
        let each = rows.len().div_ceil(numbers.div_ceil(MOST_NUMBERS).max(1)).max(1);
        for (runs, rows) in runs.chunks(each).zip(rows.chunks(each)) {
            self.store.add(&part(self.sweep, &runs[..rows.len()], rows, &self.maker), runs[0].run)?;
        }
        Ok(())
    }

    /// Takes blocks of runs until none remain. `is_apart`: runs them in children.
    fn run_worker(&self, is_apart: bool) -> io::Result<()> {
        while let Some((mut claim, mut block)) = self.take()? {
            let (mut rows, start) = (Vec::new(), Instant::now());
            let ended = match is_apart {
                true => self.apart(&block, &mut claim, &mut rows, start),
                false => self.here(&block, &mut claim, &mut rows, start),
            };
            if let Err(error) = self.put(&block, &rows) {
                // the next worker takes the rows over
                std::mem::forget(claim);
                return Err(error);
            }
            drop(claim);
            ended?;
            if rows.is_empty() {
                return Ok(());
            }
            let over = self.over.fetch_add(rows.len(), Ordering::Relaxed) + rows.len();
            let mut queue = self.queue();
            for due in block.drain(rows.len()..).rev() {
                queue.due.push_front(due);
            }
            (self.report)(over, self.count - queue.elsewhere);
        }
        Ok(())
    }

    /// Runs in this process.
    fn here(
        &self,
        block: &[PendingRun],
        claim: &mut Claim,
        rows: &mut Vec<Measured>,
        start: Instant,
    ) -> io::Result<()> {
        let stop = Arc::new(AtomicBool::new(false));
        for due in block {
            if signals::received().is_some() || start.elapsed().as_secs_f64() > self.seconds() {
                break;
            }
            claim.begin()?;
            let measured = catch_unwind(AssertUnwindSafe(|| {
                measure(self.store, self.sweep, due.run, self.work.is_untrusted, &stop)
            }));
            let measured = measured.unwrap_or_else(|_| {
                Some(Measured {
                    failed_at: Some(FailedAt { kind: FailureKind::Crashed, step: 0, increment: 0 }),
                    message: Some("the program panicked".into()),
                    ..Measured::without_numbers(&self.sweep.keep)
                })
            });
            let Some(measured) = measured else { break };
            claim.add(&measured)?;
            rows.push(measured);
        }
        Ok(())
    }

    /// Runs in children, one after another.
    fn apart(
        &self,
        block: &[PendingRun],
        claim: &mut Claim,
        rows: &mut Vec<Measured>,
        start: Instant,
    ) -> io::Result<()> {
        while rows.len() < block.len() && signals::received().is_none() {
            let left = self.seconds() - start.elapsed().as_secs_f64();
            if left < 0.0 {
                break;
            }
            let before = rows.len();
            let ended = self.child(&block[before..], left, claim, before);
            *rows = claim.rows()?;
            ended?;
            if rows.len() == before && signals::received().is_none() {
                return Err(io::Error::other("a child ended without a row, and without a reason"));
            }
        }
        Ok(())
    }

    /// Starts a child with runs, which appends its rows to the first `before` rows. If a run ends the child, the row of that run
    /// is added here.
    fn child(&self, runs: &[PendingRun], seconds: f64, claim: &mut Claim, before: usize) -> io::Result<()> {
        let numbers: Vec<usize> = runs.iter().map(|due| due.run).collect();
        let sweep = self.sweep.part(&numbers);
        let need = self.need(&numbers);
        let folder = fs::canonicalize(self.store.folder())?;
        let (rows, seconds) = (fs::canonicalize(&claim.path)?, seconds.clamp(0.0, 1e9));
        let batch = Batch { folder, rows, sweep, seconds, is_untrusted: self.work.is_untrusted };
        let start = Instant::now();
        let ended = isolation::supervise(&mut Passage::new(&batch)?, &Watch::default(), &need)?;
        let count = claim.rows()?.len() - before;
        match ended {
            End::Done(0) => Ok(()),
            End::Done(code) => Err(io::Error::other(format!("a child of the sweep ended with exit code {code}"))),
            End::Failed(_) if count >= runs.len() || signals::received().is_some() => Ok(()),
            End::Failed(failure) => {
                let document = self.sweep.document(runs[count].run);
                let mut row = crash(&failure, &document, self, runs[count].run);
                row.times = [start.elapsed().as_secs_f64(), 0.0];
                claim.add(&row)
            }
        }
    }

    /// Returns how long calls of the libraries of these runs may take.
    fn need(&self, runs: &[usize]) -> Need {
        let vary = |path: &String| path.contains("plugin") || path.contains("material") || path.contains("law");
        let mut need = self.sweep.need(self.store, runs[0]);
        if self.sweep.parameters.iter().any(|path| vary(path) && !path.contains("props")) {
            for &run in runs {
                need.libraries.extend(self.sweep.need(self.store, run).libraries);
            }
        }
        need.specimen = self.sweep.base["kind"] == "pullout";
        need
    }
}

/// The row of a run that was lost with its worker.
fn lost(host: &str, attempt: u32, keep: &Keep) -> Measured {
    let again = if attempt < MOST_LOSSES { "it is run again" } else { "it is not run again unless it is asked for" };
    Measured {
        is_lost: true,
        message: Some(format!("the worker on {host} ended without a word (attempt {attempt}): {again}")),
        ..Measured::without_numbers(keep)
    }
}

/// Returns the row of a run that ended its child.
fn crash(failure: &WorkerFailure, document: &Value, office: &JobQueue<'_>, run: usize) -> Measured {
    let case = failure.replay.clone().map(|mut case| {
        let title = document["title"].as_str().unwrap_or(&office.sweep.title);
        replay::entitle(&mut case, replay::OF_CALL, title, &office.store.bundle(office.sweep, run));
        format!("{case:#}\n")
    });
    Measured {
        failed_at: Some(failure.report.failed_at()),
        message: Some(failure.report.message.clone()),
        replay: case,
        ..Measured::without_numbers(&office.sweep.keep)
    }
}

//! Recorder of a run while it goes on.

use crate::history::{History, HistoryWriter};
use crate::progress::Progress;
use crate::summary::PeakRecorder;
use crate::viewer::ViewerStates;
use fe_core::stepping::{Recorded, Snapshot, Tried};
use indexmap::IndexMap;
use pullout_run::columns::LEADING;
use pullout_run::isolation::worker;
use pullout_run::path::{Observer, Row, Statistics};
use pullout_run::pullout::checkpoint::Saved;
use pullout_run::signals;
use rustix::time::ClockId;
use serde::{Deserialize, Serialize};
use std::cell::Cell;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Recorder of a run: writes or keeps the history, and gathers peaks and progress.
pub struct RunRecorder {
    rows: Rows,
    /// States of a specimen that the report shows; `None`: there is no report.
    states: Option<ViewerStates>,
    /// Flag that another thread sets to end the run.
    stop: Option<Arc<AtomicBool>>,
    /// Extremes of the columns.
    pub peaks: PeakRecorder,
    /// Progress shown to a person.
    pub progress: Progress,
    /// Warnings of the run.
    pub warnings: Vec<String>,
    done: u64,
    /// Increments, if they are kept for another run that repeats them.
    pub recorded: Option<Recorded>,
    /// Values of the state in which a failing run gave up.
    reached: Option<Vec<f64>>,
    /// Step and increment of the last row.
    place: [u32; 2],
    /// Whether the run was asked to end.
    ended: Cell<bool>,
    start: Instant,
    /// Clock of the CPU time of the process, or of the running thread.
    clock: ClockId,
    cpu_start: Duration,
    /// Times that the run took before it was interrupted, of the clock and of the processors, s.
    earlier_s: [f64; 2],
}

/// Receiver of rows.
enum Rows {
    File(HistoryWriter),
    Memory(History),
}

/// Part of a [`RunRecorder`] that a checkpoint holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Kept {
    /// Length of history.csv.
    pub history_bytes: u64,
    /// SHA-256 of that.
    pub history_sha256: String,
    peaks: PeakRecorder,
    states: Option<ViewerStates>,
    done: u64,
    times_s: [f64; 2],
}

/// CPU time of this process so far.
pub fn cpu_time() -> Duration {
    time_of(ClockId::ProcessCPUTime)
}

fn time_of(clock: ClockId) -> Duration {
    Duration::try_from(rustix::time::clock_gettime(clock)).unwrap_or_default()
}

impl Kept {
    /// Reads what a checkpoint keeps; `None`: it holds none.
    pub fn of(saved: &Saved) -> Option<Self> {
        postcard::from_bytes(&saved.observer).ok()
    }
}

impl RunRecorder {
    fn begin(rows: Rows, peaks: PeakRecorder, progress: Progress, clock: ClockId) -> Self {
        let (start, cpu_start) = (Instant::now(), time_of(clock));
        Self {
            rows,
            states: None,
            stop: None,
            peaks,
            progress,
            warnings: Vec::new(),
            done: 0,
            recorded: None,
            reached: None,
            place: [0; 2],
            ended: Cell::new(false),
            start,
            clock,
            cpu_start,
            earlier_s: [0.0; 2],
        }
    }

    /// Begins the record of a run.
    pub fn new(history: &Path, columns: &[String], progress: Progress, is_hashed: bool) -> io::Result<Self> {
        let rows = Rows::File(HistoryWriter::create(history, columns, is_hashed)?);
        let record = Self::begin(rows, PeakRecorder::new(columns), progress, ClockId::ProcessCPUTime);
        Ok(Self { states: Some(ViewerStates::default()), ..record })
    }

    /// Begins the record of a run whose rows stay in memory. `stop` ends it; `is_of_thread`: nothing but the present thread works for it, and
    /// others may work for other runs.
    pub fn in_memory(columns: Vec<String>, progress: Progress, stop: Arc<AtomicBool>, is_of_thread: bool) -> Self {
        let clock = if is_of_thread { ClockId::ThreadCPUTime } else { ClockId::ProcessCPUTime };
        let peaks = PeakRecorder::new(&columns);
        let rows = Rows::Memory(History::empty(columns));
        Self { stop: Some(stop), ..Self::begin(rows, peaks, progress, clock) }
    }

    /// Keeps states of a specimen although there is no report.
    pub fn keep_states(&mut self) {
        self.states = Some(ViewerStates::default());
    }

    /// Goes on with the record of a run that goes on.
    pub fn resume(history: &Path, columns: &[String], progress: Progress, kept: Kept) -> io::Result<Self> {
        let Kept { history_bytes, history_sha256: _, peaks, states, done, times_s: earlier_s } = kept;
        let rows = Rows::File(HistoryWriter::resume(history, columns, history_bytes)?);
        Ok(Self { states, done, earlier_s, ..Self::begin(rows, peaks, progress, ClockId::ProcessCPUTime) })
    }

    /// The rows that stayed in memory.
    pub fn into_history(self) -> History {
        match self.rows {
            Rows::Memory(history) => history,
            Rows::File(_) => History::default(),
        }
    }

    /// Takes the state in which a failing run gave up, by columns, without values that are not finite. It can be taken once.
    pub fn take_reached(&mut self, columns: Vec<String>) -> Option<IndexMap<String, f64>> {
        let values = self.reached.take()?;
        let named = columns.into_iter().skip(LEADING.len()).zip(values);
        Some(named.filter(|(_, value)| value.is_finite()).collect())
    }

    /// The states that the report shows, to be taken once.
    pub fn take_states(&mut self) -> ViewerStates {
        self.states.take().unwrap_or_default()
    }

    /// Returns whether a signal or another thread ended the run.
    pub fn was_ended(&self) -> bool {
        self.ended.get()
    }

    /// Returns where the run was when the last row was written.
    pub fn place(&self) -> String {
        let [step, increment] = self.place;
        format!("step {step}, increment {increment}")
    }

    /// Times that the run took so far, of the clock and of the processors, s.
    pub fn times(&self) -> [f64; 2] {
        let [wall, cpu] = self.earlier_s;
        [wall + self.start.elapsed().as_secs_f64(), cpu + (time_of(self.clock) - self.cpu_start).as_secs_f64()]
    }
}

impl Observer for RunRecorder {
    fn row(&mut self, row: Row<'_>) -> io::Result<()> {
        self.place = [row.step, row.increment];
        if row.step == 0 {
            self.peaks.observe(&row);
        }
        match &mut self.rows {
            Rows::File(writer) => writer.write(&row),
            Rows::Memory(history) => {
                history.push(&row);
                Ok(())
            }
        }
    }

    fn reached(&mut self, row: Row<'_>) {
        self.reached = Some(row.values.to_vec());
    }

    fn ends_here(&self) -> bool {
        let is_stopped = self.stop.as_ref().is_some_and(|stop| stop.load(Ordering::Relaxed));
        let ends = is_stopped || signals::received().is_some();
        self.ended.set(ends);
        ends
    }

    fn tried(&mut self, step: u32, attempts: &[Tried]) {
        if let Some(recorded) = &mut self.recorded {
            recorded.push(step, attempts.to_vec());
        }
    }

    fn stop(&self) -> Option<Arc<AtomicBool>> {
        self.stop.clone()
    }

    fn increment_done(&mut self, row: Row<'_>, so_far: Statistics) {
        self.peaks.observe(&row);
        self.done += 1;
        worker::note_increment(&so_far);
        self.progress.advance(self.done, &row);
    }

    fn state_reached(&mut self, slip: f64, load: f64, snapshot: &Snapshot<'_>, is_last: bool) {
        if let Some(states) = &mut self.states {
            states.observe(slip, load, snapshot, is_last);
        }
    }

    fn warn(&mut self, message: String) {
        self.warnings.push(message);
    }

    fn state(&self) -> Vec<u8> {
        let Self { rows: Rows::File(writer), peaks, states, done, .. } = self else { return Vec::new() };
        let times_s = self.times();
        let (history_bytes, history_sha256) = (writer.bytes(), writer.digest());
        let (peaks, states) = (peaks.clone(), states.clone());
        let kept = Kept { history_bytes, history_sha256, peaks, states, done: *done, times_s };
        postcard::to_stdvec(&kept).unwrap_or_default()
    }
}

//! UEXTERNALDB, called where a library exports it.

use super::guard::{Guard, run};
use super::library::Library;
use super::recorder::{Arguments, ExternalDatabaseRecord, Slot};
use std::path::Path;

/// LOP, LRESTART, TIME(2), DTIME, KSTEP, KINC.
type ExternalDatabaseFunction =
    unsafe extern "C" fn(*const i32, *const i32, *const f64, *const f64, *const i32, *const i32);

/// The symbol, as [`super::Routine::ALL`] has it.
const SYMBOL: &str = "uexternaldb";

/// LOP: why UEXTERNALDB is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Occasion {
    AnalysisStart = 0,
    IncrementStart = 1,
    IncrementEnd = 2,
    AnalysisEnd = 3,
    Restart = 4,
    StepStart = 5,
    StepEnd = 6,
}

/// Times and numbers of an increment that UEXTERNALDB is given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// Step time and total time now: at the increment's start or at its end, s.
    pub time: [f64; 2],
    /// Time increment, s.
    pub time_increment: f64,
    /// Step, from 1.
    pub step: i32,
    /// Increment in the step, from 1.
    pub increment: i32,
}

#[derive(Debug)]
struct ExternalDatabase {
    function: ExternalDatabaseFunction,
    guard: Option<Guard>,
    slot: Option<Slot>,
    library: Library,
}

/// UEXTERNALDB of the libraries of an analysis, in the order of ABAQUS's manual: LOP = 0 when this is made (and 4 where a
/// run goes on from a checkpoint), 5 before the first increment of a step, 1 before an increment, 2 behind it, 6 behind
/// the last one of a step, 3 when it is dropped. An increment that is repeated with another DTIME begins again, with LOP = 1.
///
/// A library that keeps no more than it reads at LOP = 0 is right in a run that goes on only if it gets that call as well:
/// a restart is told by both.
#[derive(Debug, Default)]
pub struct ExternalDatabases {
    databases: Vec<ExternalDatabase>,
    last: (Option<Occasion>, Clock),
}

impl ExternalDatabases {
    /// Begins an analysis with these libraries, each called once.
    pub fn begin<'l>(libraries: impl IntoIterator<Item = &'l Library>) -> Self {
        let mut databases: Vec<ExternalDatabase> = Vec::new();
        for library in libraries {
            let is_known = |path: &Path| databases.iter().any(|other| other.library.path() == path);
            if is_known(library.path()) {
                continue;
            }
            // SAFETY: a function of this name has the signature of the manual; no check is possible. The library is
            // kept.
            if let Some(function) = unsafe { library.find(SYMBOL) } {
                let (guard, slot) = (library.guard(), Slot::of_routine(library));
                databases.push(ExternalDatabase { function, guard, slot, library: library.clone() });
            }
        }
        let start = Clock { step: 1, ..Clock::default() };
        let mut this = Self { databases, last: (None, start) };
        this.call(Occasion::AnalysisStart, start);
        this
    }

    /// Returns whether one of these libraries has a UEXTERNALDB: it may prepare what its laws need.
    pub fn is_in<'l>(libraries: impl IntoIterator<Item = &'l Library>) -> bool {
        libraries.into_iter().any(|library| library.routines().iter().any(|routine| routine.symbol == SYMBOL))
    }

    /// Continues an analysis after the increment of this clock. A step that had begun is not begun again.
    pub fn resume<'l>(libraries: impl IntoIterator<Item = &'l Library>, clock: Clock) -> Self {
        let mut this = Self::begin(libraries);
        this.call(Occasion::Restart, clock);
        if clock.increment > 0 {
            this.last.0 = Some(Occasion::IncrementEnd);
        }
        this
    }

    /// An increment begins, for the first time or again with another length. Told once: what is computed before the first
    /// attempt, or again with the same length, is part of the same beginning.
    pub fn increment_starts(&mut self, clock: Clock) {
        if self.databases.is_empty() || self.last == (Some(Occasion::IncrementStart), clock) {
            return;
        }
        let (occasion, before) = self.last;
        let is_in_step = matches!(occasion, Some(Occasion::IncrementStart | Occasion::IncrementEnd));
        if !is_in_step || before.step != clock.step {
            self.end_step();
            self.call(Occasion::StepStart, Clock { increment: 0, ..clock });
        }
        self.call(Occasion::IncrementStart, clock);
    }

    /// An increment has converged.
    pub fn increment_ends(&mut self, clock: Clock) {
        self.call(Occasion::IncrementEnd, clock);
    }

    /// Ends a step whose last increment has converged.
    fn end_step(&mut self) {
        if let (Some(Occasion::IncrementEnd), clock) = self.last {
            self.call(Occasion::StepEnd, clock);
        }
    }

    fn call(&mut self, occasion: Occasion, clock: Clock) {
        self.last = (Some(occasion), clock);
        let (lop, restart) = (occasion as i32, 0);
        let Clock { time, time_increment, step, increment } = clock;
        for ExternalDatabase { function, guard, slot, .. } in &mut self.databases {
            if let Some(slot) = slot {
                slot.enter(|to| {
                    to.put_integers([Arguments::EXTERNAL_DATABASE, 0]);
                    ExternalDatabaseRecord::write(&[lop, step, increment], to);
                });
            }
            // SAFETY: every pointer is valid for what the manual says.
            run(guard.as_ref(), || unsafe {
                function(&lop, &restart, time.as_ptr(), &time_increment, &step, &increment);
            });
            if let Some(slot) = slot {
                slot.leave();
            }
        }
    }
}

impl Drop for ExternalDatabases {
    fn drop(&mut self) {
        self.end_step();
        self.call(Occasion::AnalysisEnd, self.last.1);
    }
}

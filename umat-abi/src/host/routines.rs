//! Routines other than the entry points, called if a library exports them: UEXTERNALDB here, SDVINI and SIGINI in
//! `initial`.

use super::guard::{Guard, run};
use super::library::Library;
use super::recorder::{RecordedArguments, Slot};

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

/// A routine of a library, ready to be called.
#[derive(Debug)]
pub(super) struct Routine<F> {
    function: F,
    guard: Option<Guard>,
    slot: Option<Slot>,
    /// Keeps the function's code loaded.
    library: Library,
}

impl<F: Copy> Routine<F> {
    /// Finds a routine, if the library has it.
    ///
    /// # Safety
    /// `F` is the type of the function with that name.
    pub(super) unsafe fn find(library: &Library, name: &str) -> Option<Self> {
        // SAFETY: forwarded to the caller; the library is kept.
        let function = unsafe { library.find(name) }?;
        Some(Self { function, guard: library.guard(), slot: Slot::of_routine(library), library: library.clone() })
    }

    /// Makes a call, for which the recorder notes the routine's number and some of its arguments.
    pub(super) fn call<const N: usize>(&mut self, number: i32, noted: [i32; N], call: impl FnOnce(F)) {
        if let Some(slot) = &mut self.slot {
            slot.enter(|to| {
                to.put_integers([number, 0]);
                to.put_integers(noted);
            });
        }
        run(self.guard.as_ref(), || call(self.function));
        if let Some(slot) = &mut self.slot {
            slot.leave();
        }
    }
}

/// UEXTERNALDB of the libraries of an analysis, called in the order of ABAQUS's manual.
///
/// LOP = 0 when this is made (and 4 if a run goes on from a checkpoint), 5 before the first increment of a step, 1
/// before an increment, 2 after it, 6 after the last increment of a step, 3 when this is dropped. An increment that is
/// repeated with another DTIME begins again, with LOP = 1.
///
/// At a restart a library gets both calls, because one that keeps only what it reads at LOP = 0 needs that call as
/// well.
#[derive(Debug, Default)]
pub struct ExternalDatabases {
    databases: Vec<Routine<ExternalDatabaseFunction>>,
    last: (Option<Occasion>, Clock),
}

impl ExternalDatabases {
    /// Begins an analysis with these libraries, each called once.
    pub fn begin<'l>(libraries: impl IntoIterator<Item = &'l Library>) -> Self {
        let mut databases: Vec<Routine<_>> = Vec::new();
        for library in libraries {
            if !databases.iter().any(|other| other.library.path() == library.path()) {
                // SAFETY: a function of this name has the signature of the manual; no check is possible.
                databases.extend(unsafe { Routine::find(library, SYMBOL) });
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

    /// An increment begins, for the first time or again with another length. The library is called once: what is
    /// computed before the first attempt, or again with the same length, is part of the same beginning.
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
        for database in &mut self.databases {
            database.call(RecordedArguments::EXTERNAL_DATABASE, [lop, step, increment], |function| {
                // SAFETY: every pointer is valid for what the manual says.
                unsafe { function(&lop, &restart, time.as_ptr(), &time_increment, &step, &increment) };
            });
        }
    }
}

impl Drop for ExternalDatabases {
    fn drop(&mut self) {
        self.end_step();
        self.call(Occasion::AnalysisEnd, self.last.1);
    }
}

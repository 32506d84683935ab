//! The user subroutines around UMAT: UEXTERNALDB and SDVINI, called where a library exports them.

use super::guard::{Guard, run};
use super::library::Library;
use super::memory::Guarded;
use super::recorder::{Arguments, ExternalDatabaseRecord, InitialStateRecord, Slot};
use std::path::Path;

/// LOP, LRESTART, TIME(2), DTIME, KSTEP, KINC.
type ExternalDatabaseFunction =
    unsafe extern "C" fn(*const i32, *const i32, *const f64, *const f64, *const i32, *const i32);

/// STATEV(NSTATV), COORDS(NCRDS), NSTATV, NCRDS, NOEL, NPT, LAYER, KSPT.
type InitialStateFunction =
    unsafe extern "C" fn(*mut f64, *const f64, *const i32, *const i32, *const i32, *const i32, *const i32, *const i32);

/// LOP: why UEXTERNALDB is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Occasion {
    AnalysisStart = 0,
    IncrementStart = 1,
    IncrementEnd = 2,
    AnalysisEnd = 3,
}

/// What UEXTERNALDB is told of an increment.
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

/// UEXTERNALDB of the libraries of an analysis: called with LOP = 0 when this is made, around increments as the
/// analysis tells, and with LOP = 3 when it is dropped.
#[derive(Debug, Default)]
pub struct ExternalDatabases {
    databases: Vec<ExternalDatabase>,
    last: Clock,
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
            if let Some(function) = unsafe { library.find("uexternaldb") } {
                let (guard, slot) = (library.guard(), Slot::of_routine(library));
                databases.push(ExternalDatabase { function, guard, slot, library: library.clone() });
            }
        }
        let last = Clock { step: 1, ..Clock::default() };
        let mut this = Self { databases, last };
        this.call(Occasion::AnalysisStart, last);
        this
    }

    /// An increment begins, for the first time or again after a cut-back.
    pub fn increment_starts(&mut self, clock: Clock) {
        self.call(Occasion::IncrementStart, clock);
    }

    /// An increment has converged.
    pub fn increment_ends(&mut self, clock: Clock) {
        self.call(Occasion::IncrementEnd, clock);
    }

    fn call(&mut self, occasion: Occasion, clock: Clock) {
        self.last = clock;
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
        self.call(Occasion::AnalysisEnd, self.last);
    }
}

/// STATEV of points at the start.
#[derive(Debug)]
pub struct InitialStates {
    count: usize,
    source: StateSource,
}

#[derive(Debug)]
enum StateSource {
    Zero,
    Given(Vec<f64>),
    Routine {
        function: InitialStateFunction,
        guard: Option<Guard>,
        slot: Option<Slot>,
        /// Keeps the function's code loaded.
        _library: Library,
    },
}

impl InitialStates {
    /// Of a law with `count` states: those given, NSTATV values; otherwise what SDVINI of its library sets, or zeros.
    pub fn new(library: &Library, given: Option<&[f64]>, count: usize) -> Self {
        let source = match given {
            Some(given) => StateSource::Given(given.to_vec()),
            // SAFETY: as for UEXTERNALDB.
            None => match unsafe { library.find("sdvini") } {
                Some(function) => StateSource::Routine {
                    function,
                    guard: library.guard(),
                    slot: Slot::of_routine(library),
                    _library: library.clone(),
                },
                None => StateSource::Zero,
            },
        };
        Self { count, source }
    }

    /// Whether all are 0 at every point, because nobody says otherwise.
    pub fn are_zero(&self) -> bool {
        matches!(self.source, StateSource::Zero)
    }

    /// STATEV of a point: its coordinates, its element and number in it, from 1.
    ///
    /// # Errors
    /// In words, if SDVINI wrote behind STATEV.
    pub fn of_point(&mut self, coordinates: [f64; 3], element: i32, point: i32) -> Result<Vec<f64>, String> {
        let (function, guard, slot) = match &mut self.source {
            StateSource::Zero => return Ok(vec![0.0; self.count]),
            StateSource::Given(given) => return Ok(given.clone()),
            StateSource::Routine { function, guard, slot, .. } => (function, guard, slot),
        };
        if let Some(slot) = slot {
            slot.enter(|to| {
                to.put_integers([Arguments::INITIAL_STATE, 0]);
                InitialStateRecord::write(&[element, point], to);
            });
        }
        let mut guarded = Guarded::new("STATEV", self.count);
        let (dimensions, one) = (3, 1);
        let (states, count) = (guarded.as_mut_ptr(), guarded.count());
        // SAFETY: every pointer is valid for the sizes that the counts tell.
        run(guard.as_ref(), || unsafe {
            function(states, coordinates.as_ptr(), count, &dimensions, &element, &point, &one, &one);
        });
        if let Some(slot) = slot {
            slot.leave();
        }
        guarded.check().map_err(|overrun| format!("SDVINI: {overrun}"))?;
        Ok(guarded.as_slice().to_vec())
    }
}

//! SDVINI and SIGINI: initial states and stresses of points, where the library sets them and the case does not.

use super::library::Library;
use super::memory::{Guarded, NAME_LENGTH, fortran_name};
use super::recorder::{self, RecordedArguments};
use super::routines::Routine;
use std::ffi::c_char;

/// STATEV(NSTATV), COORDS(NCRDS), NSTATV, NCRDS, NOEL, NPT, LAYER, KSPT.
pub type StateFunction =
    unsafe extern "C" fn(*mut f64, *const f64, *const i32, *const i32, *const i32, *const i32, *const i32, *const i32);

/// SIGMA(NTENS), COORDS(NCRDS), NTENS, NCRDS, NOEL, NPT, LAYER, KSPT, LREBAR, NAMES(2)*80 and its hidden length.
pub type StressFunction = unsafe extern "C" fn(
    *mut f64,
    *const f64,
    *const i32,
    *const i32,
    *const i32,
    *const i32,
    *const i32,
    *const i32,
    *const i32,
    *const c_char,
    usize,
);

/// NCRDS.
static DIMENSIONS: i32 = 3;
/// LAYER and KSPT.
static ONE: i32 = 1;
/// LREBAR: the point is of no rebar.
static NO_REBAR: i32 = 0;

/// Material point as SDVINI and SIGINI get it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialPoint {
    /// COORDS, mm.
    pub coordinates: [f64; 3],
    /// NOEL, from 1.
    pub element: i32,
    /// NPT, from 1.
    pub point: i32,
}

/// STATEV of points at the start.
pub type InitialStates = Initial<StateFunction>;
/// STRESS of points at the start.
pub type InitialStresses = Initial<StressFunction>;

/// `count` values of each point.
#[derive(Debug)]
pub struct Initial<F> {
    count: usize,
    source: Source<F>,
}

#[derive(Debug)]
enum Source<F> {
    Zero,
    Given(Vec<f64>),
    Routine(Box<(Routine<F>, Guarded)>),
}

impl<F: Copy> Initial<F> {
    /// The values given; otherwise what a routine of the library sets, or zeros.
    ///
    /// # Safety
    /// `F` is the type of the routine.
    unsafe fn of(library: &Library, (name, array): (&str, &'static str), given: Option<&[f64]>, count: usize) -> Self {
        if let Some(given) = given {
            return Self { count, source: Source::Given(given.to_vec()) };
        }
        // SAFETY: forwarded to the caller.
        let routine = unsafe { Routine::find(library, name) };
        let source = routine.map_or(Source::Zero, |routine| {
            let mut values = Guarded::new(array, count);
            if recorder::fences_arrays() {
                values.fence();
            }
            Source::Routine(Box::new((routine, values)))
        });
        Self { count, source }
    }

    /// The values of a point; `call` makes the call of the routine with room for them.
    fn values(
        &mut self,
        (name, number): (&str, i32),
        point: &InitialPoint,
        call: impl FnOnce(F, &mut Guarded),
    ) -> Result<Vec<f64>, String> {
        let (routine, values) = &mut **match &mut self.source {
            Source::Zero => return Ok(vec![0.0; self.count]),
            Source::Given(given) => return Ok(given.clone()),
            Source::Routine(routine) => routine,
        };
        values.as_mut_slice().fill(0.0);
        routine.call(number, [point.element, point.point], |function| call(function, values));
        values.check().map_err(|overrun| format!("{name}: {overrun}"))?;
        match values.as_slice().iter().position(|value| !value.is_finite()) {
            Some(k) => Err(format!("{name} set {}({}) to {}", values.name(), k + 1, values.as_slice()[k])),
            None => Ok(values.as_slice().to_vec()),
        }
    }

    /// Returns whether all are 0 at every point, because nobody says otherwise.
    pub fn are_zero(&self) -> bool {
        matches!(self.source, Source::Zero)
    }
}

impl InitialStates {
    /// Returns the initial states of a law with `count` states: those given, NSTATV values; otherwise what SDVINI of its library sets, or zeros.
    pub fn new(library: &Library, given: Option<&[f64]>, count: usize) -> Self {
        // SAFETY: a function of this name has the signature of the manual; no check is possible.
        unsafe { Self::of(library, ("sdvini", "STATEV"), given, count) }
    }

    /// Returns STATEV of a point.
    ///
    /// # Errors
    /// A message if SDVINI wrote past STATEV or set a value that is not finite.
    pub fn of_point(&mut self, at: &InitialPoint) -> Result<Vec<f64>, String> {
        let InitialPoint { coordinates, element, point } = at;
        self.values(("SDVINI", RecordedArguments::INITIAL_STATE), at, |function, values| {
            let (states, count) = (values.as_mut_ptr(), values.count());
            // SAFETY: every pointer is valid for the sizes that the counts give.
            unsafe { function(states, coordinates.as_ptr(), count, &DIMENSIONS, element, point, &ONE, &ONE) }
        })
    }
}

impl InitialStresses {
    /// Returns the initial stresses of a law with `count` stress components: those given; otherwise what SIGINI of its library sets, or zeros.
    pub fn new(library: &Library, given: Option<&[f64]>, count: usize) -> Self {
        // SAFETY: as for SDVINI.
        unsafe { Self::of(library, ("sigini", "SIGMA"), given, count) }
    }

    /// Returns STRESS of a point, in the order of UMAT; `element_type` as ABAQUS names it.
    ///
    /// # Errors
    /// A message if SIGINI wrote past SIGMA or set a value that is not finite.
    pub fn of_point(&mut self, at: &InitialPoint, element_type: &str) -> Result<Vec<f64>, String> {
        let InitialPoint { coordinates, element, point } = at;
        // the rebar's name, which is blank, and the type of the element
        let names = [fortran_name(""), fortran_name(element_type)].concat();
        self.values(("SIGINI", RecordedArguments::INITIAL_STRESS), at, |function, values| {
            let (stress, count) = (values.as_mut_ptr(), values.count());
            let names = names.as_ptr().cast::<c_char>();
            // SAFETY: every pointer is valid for the sizes that the counts give.
            unsafe {
                function(
                    stress,
                    coordinates.as_ptr(),
                    count,
                    &DIMENSIONS,
                    element,
                    point,
                    &ONE,
                    &ONE,
                    &NO_REBAR,
                    names,
                    NAME_LENGTH,
                )
            }
        })
    }
}

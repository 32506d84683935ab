//! Lists of steps with cycles in them, expanded.

use crate::document::{Cycle, Increments, MOST_INCREMENTS, Positive};
use crate::problem::Place;
use crate::reader::Reader;
use pullout_run::program::{Pace, PathStep};

/// Most steps of a run after its cycles are expanded.
const MOST_STEPS: usize = 1_000_000;
/// Most rows of tables in memory after cycles are expanded.
const MOST_ROWS: usize = 10_000_000;

/// A step of a document as it was found.
pub(crate) enum Found<'s, S, R> {
    /// A step proper; `None`: it cannot be used, which was said.
    Step(Option<R>),
    /// A cycle of steps.
    Cycle(&'s Cycle<S>),
    /// One in a member named "cycles".
    Cycles(&'s Cycle<S>),
}

/// A step of a program.
pub trait Counted: Clone {
    /// Returns the number of increments.
    fn increments(&self) -> usize;

    /// Rows of its table that a copy of it copies.
    fn rows(&self) -> usize {
        0
    }
}

impl<G: Clone> Counted for PathStep<G> {
    fn increments(&self) -> usize {
        self.pace.increments()
    }

    fn rows(&self) -> usize {
        if let Pace::Rows(rows) = &self.pace { rows.len() } else { 0 }
    }
}

/// A function that resolves one step, unless it is a cycle.
pub type ResolveStep<'r, S, R> = dyn for<'s> FnMut(&mut Reader<'_>, &'s S, &Place) -> Found<'s, S, R> + 'r;

/// Resolves all steps in order; cycles are resolved once and repeated.
pub fn expand<S, R: Counted>(
    reader: &mut Reader<'_>,
    steps: &[S],
    place: &Place,
    resolve: &mut ResolveStep<'_, S, R>,
) -> Vec<R> {
    let mut expanded = Vec::new();
    for (k, step) in steps.iter().enumerate() {
        let place = place.index(k);
        let (cycle, place) = match resolve(reader, step, &place) {
            Found::Step(step) => {
                expanded.extend(step);
                continue;
            }
            Found::Cycle(cycle) => (cycle, place),
            Found::Cycles(cycle) => (cycle, place.key("cycles")),
        };
        let once = expand(reader, &cycle.steps, &place.key("steps"), resolve);
        if fits(reader, &once, cycle.repeat.0, &place.key("repeat")) {
            (0..cycle.repeat.0).for_each(|_| expanded.extend_from_slice(&once));
        }
    }
    fits(reader, &expanded, 1, place);
    expanded
}

/// Returns whether so many repetitions stay within the limits.
fn fits<R: Counted>(reader: &mut Reader<'_>, steps: &[R], repeat: usize, place: &Place) -> bool {
    let sum =
        |count: fn(&R) -> usize| steps.iter().map(count).fold(0_usize, usize::saturating_add).saturating_mul(repeat);
    let limits = [
        ("steps", sum(|_| 1), MOST_STEPS),
        ("increments", sum(R::increments), MOST_INCREMENTS),
        ("table rows", sum(R::rows), MOST_ROWS),
    ];
    for (what, count, most) in limits {
        if count > most {
            reader.problem(place, format!("makes {count} {what} in all; at most {most} are possible"));
            return false;
        }
    }
    true
}

/// Equal increments of a ramp.
pub fn pace(increments: Increments, time: Option<Positive>) -> Pace {
    Pace::Equal { increments: increments.0, time: time.map_or(1.0, |time| time.0) }
}

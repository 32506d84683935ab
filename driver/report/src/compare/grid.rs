//! A curve of a run on a grid: where its x first passes given values, branch by branch where these turn back.

use super::{Branch, NOISE, Turns};

/// Reason why a run has no value at a point of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Off {
    /// Its branch begins after the point: at a reversal, or where the run begins.
    Before {
        /// First x of the branch.
        start: f64,
        /// Whether the run turns back there.
        at_turn: bool,
    },
    /// Its branch ends before the point: at a reversal, or where the run ends.
    Behind {
        /// Last x of the branch.
        end: f64,
        /// Whether the run turns back there.
        at_turn: bool,
    },
    /// The grid turns back where the run does not.
    Turned {
        /// The turn.
        x: f64,
        /// Its number, from 1.
        point: usize,
    },
}

impl Off {
    /// Says it of a value of the quantity `name`.
    pub fn words(&self, name: &str, value: f64) -> String {
        match *self {
            Self::Before { start, at_turn: true } => {
                format!("the run reverses at {name} {start}; after their reversal the data also have {value}")
            }
            Self::Before { start, at_turn: false } => {
                format!("the run begins at {name} {start}, the data also have {value}")
            }
            Self::Behind { end, at_turn } => {
                let how = if at_turn { "turns back" } else { "ends" };
                format!("the run {how} at {name} {end}, the data go on to {value}")
            }
            Self::Turned { x, point } => format!(
                "the data reverse at {name} {x} (point {point}), the run does not: leave out the points from {} on, or give the case a step that reverses as well",
                point + 1
            ),
        }
    }
}

/// A curve at the points of a grid.
#[derive(Clone, Debug, Default)]
pub struct OnGrid {
    /// y at each point.
    pub values: Vec<Result<f64, Off>>,
    /// Turns of the grid and of the run.
    pub turns: Turns,
}

impl OnGrid {
    /// Reads a curve on a grid: y where x first passes each value on its way to the farthest of them, on the branch of the value.
    pub fn of([x, y]: [&[f64]; 2], grid: &[f64]) -> Self {
        let run = |push: &mut dyn FnMut(f64)| {
            x.iter().for_each(|x| push(*x));
            Ok(())
        };
        // reading from memory does not fail
        let turns = Turns::of(grid, run).unwrap_or_default();
        let Turns { of_data, of_run, .. } = &turns;
        // where the grid goes one way, so does what counts of the run
        let of_run = if of_data.is_empty() { &[] } else { &of_run[..] };
        let mut values = Vec::with_capacity(grid.len());
        let (mut first, mut start) = (0, 0);
        for number in 0..=of_data.len() {
            // a turn is the end of one branch and the beginning of the next
            let end = of_data.get(number).map_or(grid.len(), |turn| turn + 1);
            if number > of_run.len() {
                let off = Off::Turned { x: grid[first - 1], point: first };
                values.resize(grid.len(), Err(off));
                break;
            }
            let stop = of_run.get(number).map_or(x.len(), |turn| turn + 1);
            let is_turn = [number > 0, stop < x.len()];
            values.extend(on_branch([&x[start..stop], &y[start..stop]], &grid[first..end], is_turn));
            (first, start) = (end, stop - 1);
        }
        Self { values, turns }
    }
}

/// y of a branch where x first passes the grid's values. `is_turn`: whether the run turns back where the branch begins, and ends.
fn on_branch([x, y]: [&[f64]; 2], grid: &[f64], is_turn: [bool; 2]) -> Vec<Result<f64, Off>> {
    let start = x.first().copied().unwrap_or(f64::NAN);
    let ways = grid.iter().map(|value| value - start);
    let way = ways.fold(0.0_f64, |far, way| if way.abs() > far.abs() { way } else { far });
    // what advances along the way
    let mut branch =
        Branch { direction: if way < 0.0 { -1.0 } else { 1.0 }, noise: NOISE * way.abs(), ..Branch::default() };
    for (&x, &y) in x.iter().zip(y) {
        let x = branch.direction * x;
        if branch.x.last().is_none_or(|&last| x > last) {
            branch.push([x, y]);
        }
    }
    let end = branch.x.last().map_or(start, |last| branch.direction * last);
    let at = |value: &f64| {
        let is_before = branch.x.first().is_none_or(|&first| branch.direction * value < first);
        branch.at(*value).ok_or(match is_before {
            true => Off::Before { start, at_turn: is_turn[0] },
            false => Off::Behind { end, at_turn: is_turn[1] },
        })
    };
    grid.iter().map(at).collect()
}

//! The distance of a run from a measured curve.
//!
//! RMS of history y − file y at the file's (scaled) x, the history interpolated linearly on the **first monotone
//! branch** of its x: from the initial state until x turns back. Points of the file outside that branch are not
//! compared; they are counted.
//!
//! A file whose x turns back, as in cycles, is compared **branch by branch**: its second branch with the history's second one,
//! and so on. Small loops count as branches only if the history has the same ones. If the history has no further branch, the
//! remaining points are left out, with a warning.

use super::extremes;
use super::history::Rows;
use pullout_run::program::Compare;
use serde::{Deserialize, Serialize};
use std::io;
use std::ops::ControlFlow;

mod grid;
#[cfg(test)]
mod test;

pub use grid::{Off, OnGrid};

/// Reversals smaller than this part of x's range are iteration noise, not a branch's end; a point of the file as
/// little outside the branch still belongs to it (scaling rounds).
const NOISE: f64 = 1e-9;

/// Fraction of a file's range of x. If x falls back by no more, that may be scatter, even if the run has no such loop; if by more,
/// it is a reversal. Reversals of a file and of a run that are further apart are not the same.
const SCATTER: f64 = 0.05;

/// Parts of the range of a file by which x turns back, for loops of which the run has the same ones.
const THRESHOLDS: [f64; 6] = [0.001, 0.002, 0.005, 0.01, 0.02, SCATTER];

/// Comparison with one file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// File as the case names it.
    pub file: String,
    /// Root mean square of the differences, in y's unit; `None` if nothing could be compared.
    pub rms: Option<f64>,
    /// Points compared.
    pub points: usize,
    /// Points of the file outside the branch.
    pub outside: usize,
    /// The history's column along x.
    pub x: String,
    /// The history's column that is compared.
    pub y: String,
    /// Reason why points are left out that may lie on another branch.
    #[serde(skip)]
    pub warning: Option<String>,
}

/// The points at which a sequence of x turns back by more than a threshold.
#[derive(Clone, Debug)]
struct Turning {
    threshold: f64,
    /// 0 before it is known.
    direction: f64,
    /// Index and value of the extremes since the last reversal.
    extremes: Option<[(usize, f64); 2]>,
    found: Vec<(usize, f64)>,
}

impl Turning {
    /// Begins a sequence for each of [`THRESHOLDS`].
    fn all(range: f64) -> [Self; THRESHOLDS.len()] {
        THRESHOLDS.map(|part| Self { threshold: part * range, direction: 0.0, extremes: None, found: Vec::new() })
    }

    /// Goes on with the next x. What is not finite is left out.
    fn push(&mut self, index: usize, x: f64) {
        if !x.is_finite() {
            return;
        }
        let Some([least, greatest]) = &mut self.extremes else {
            self.extremes = Some([(index, x); 2]);
            return;
        };
        if x <= least.1 {
            *least = (index, x);
        }
        if x >= greatest.1 {
            *greatest = (index, x);
        }
        let (least, greatest) = (*least, *greatest);
        let new = if x < greatest.1 - self.threshold && self.direction >= 0.0 {
            -1.0
        } else if x > least.1 + self.threshold && self.direction <= 0.0 {
            1.0
        } else {
            return;
        };
        if self.direction != 0.0 {
            self.found.push(if new < 0.0 { greatest } else { least });
        }
        self.direction = new;
        self.extremes = Some([(index, x); 2]);
    }
}

/// Turns of measured x and of the x of a run: indices of the last point of each branch but the last one.
#[derive(Clone, Debug, Default)]
pub struct Turns {
    /// Those of the data.
    pub of_data: Vec<usize>,
    /// Those of the run; not looked for where the data have none.
    pub of_run: Vec<usize>,
    /// The furthest that the data go back without a turn, as a part of their range, if the run has no such turn and it is more than a
    /// little.
    pub scatter: Option<f64>,
}

impl Turns {
    /// Finds the turns of both. Loops of data are those that the run has as well, by the smallest of some parts of the
    /// range (0.1 to 5 %) that shows the same ones in both; where there is none, the greatest counts. `run` goes through the x of the run.
    ///
    /// # Errors
    /// Those of `run`.
    pub fn of(data: &[f64], run: impl FnOnce(&mut dyn FnMut(f64)) -> io::Result<()>) -> io::Result<Self> {
        let (least, greatest) = extremes(data.iter().copied().filter(|x| x.is_finite()));
        let range = (greatest - least).max(0.0);
        let (mut of_data, mut of_run) = (Turning::all(range), Turning::all(range));
        for (index, x) in data.iter().enumerate() {
            of_data.iter_mut().for_each(|turning| turning.push(index, *x));
        }
        if of_data.iter().all(|turning| turning.found.is_empty()) {
            return Ok(Self::default());
        }
        let mut index = 0;
        run(&mut |x| {
            of_run.iter_mut().for_each(|turning| turning.push(index, x));
            index += 1;
        })?;
        let are_same = |(data, run): &(&Turning, &Turning)| {
            // to where it turned off, the run may go back further than the data
            let is_near = |k: usize| {
                let ahead = data.found[k].1 - run.found[k].1;
                let ahead = if k.is_multiple_of(2) {
                    ahead.abs()
                } else {
                    ahead * (run.found[k].1 - run.found[k - 1].1).signum()
                };
                ahead <= SCATTER * range
            };
            data.found.len() == run.found.len() && (0..run.found.len()).all(is_near)
        };
        let same = of_data.iter().zip(&of_run).position(|pair| are_same(&pair));
        let chosen = same.unwrap_or(THRESHOLDS.len() - 1);
        let indices = |turning: &Turning| turning.found.iter().map(|(index, _)| *index).collect::<Vec<_>>();
        let back = of_data.iter().rposition(|other| other.found.len() > of_data[chosen].found.len());
        Ok(Self {
            scatter: back.map(|k| THRESHOLDS[k]),
            of_data: indices(&of_data[chosen]),
            of_run: indices(&of_run[chosen]),
        })
    }

    /// Says what the data do without a turn that counts, if anything.
    pub fn words(&self, x: &str) -> Option<String> {
        let percent = 100.0 * self.scatter?;
        Some(format!(
            "{x} of the data goes back by more than {percent} % of its range, that of the run does not: it counts as scatter, not as a branch of a loop"
        ))
    }
}

/// Compares rows with a curve. They are gone through a few times for each branch, and only those around the curve's points
/// are kept.
///
/// # Errors
/// The rows cannot be read.
pub fn compare(rows: &impl Rows, curve: &Compare) -> io::Result<Comparison> {
    let scaled: Vec<(f64, f64)> = curve.points.iter().map(|(x, y)| (x * curve.scale_x, y * curve.scale_y)).collect();
    let name = |index: usize| rows.columns().get(index).cloned().unwrap_or_default();
    let of_file: Vec<f64> = scaled.iter().map(|(x, _)| *x).collect();
    let turns = Turns::of(&of_file, |push| {
        rows.pairs(curve.x, curve.y, &mut |x, _| {
            push(x);
            ControlFlow::Continue(())
        })
    })?;
    // the row with which each branch of the history begins
    let starts: Vec<usize> = [0].into_iter().chain(turns.of_run.iter().copied()).collect();
    let mut warning = turns.words(&curve.file_x).map(|words| format!("{}: {words}", curve.file));
    let (mut points, mut squares) = (0, 0.0);
    let mut first = 0;
    // a turning point is the last of its branch
    for (number, end) in turns.of_data.iter().map(|turn| turn + 1).chain([scaled.len()]).enumerate() {
        let Some(start) = starts.get(number) else {
            let (turn, (x, _)) = (first, curve.points[first - 1]);
            warning = Some(format!(
                "{}: {} reverses at {x} (point {turn}), but {} of the run does not: the points from {} on are left out",
                curve.file,
                curve.file_x,
                name(curve.x),
                turn + 1,
            ));
            break;
        };
        let branch_points = &scaled[first..end];
        let pairs = |each: &mut dyn FnMut(f64, f64) -> ControlFlow<()>| {
            let mut before = *start;
            rows.pairs(curve.x, curve.y, &mut |x, y| match before {
                0 => each(x, y),
                _ => {
                    before -= 1;
                    ControlFlow::Continue(())
                }
            })
        };
        let branch = Branch::around(&pairs, branch_points.iter().map(|(x, _)| *x).collect())?;
        for (file_x, file_y) in branch_points {
            if let Some(value) = branch.at(*file_x)
                && (value - file_y).is_finite()
            {
                points += 1;
                squares += (value - file_y).powi(2);
            }
        }
        first = end;
    }
    Ok(Comparison {
        file: curve.file.clone(),
        rms: (points > 0).then(|| (squares / points as f64).sqrt()),
        points,
        outside: scaled.len() - points,
        x: name(curve.x),
        y: name(curve.y),
        warning,
    })
}

/// Goes through rows of x and y.
type Pairs<'a> = dyn Fn(&mut dyn FnMut(f64, f64) -> ControlFlow<()>) -> io::Result<()> + 'a;

/// A stretch over which x does not turn back; x times `direction` does not decrease.
#[derive(Default)]
pub struct Branch {
    direction: f64,
    /// direction · x, noise removed: never decreasing.
    x: Vec<f64>,
    y: Vec<f64>,
    noise: f64,
}

impl Branch {
    /// All rows of the branch.
    pub fn first(x: &[f64], y: &[f64]) -> Self {
        let pairs = |each: &mut dyn FnMut(f64, f64) -> ControlFlow<()>| {
            let _ = x.iter().zip(y).try_for_each(|(&x, &y)| each(x, y));
            Ok(())
        };
        // reading from memory does not fail
        Self::traced(&pairs, &mut |_, _| true).unwrap_or_default()
    }

    /// The rows of the branch that [`Branch::at`] needs for these x.
    fn around(pairs: &Pairs<'_>, wanted: Vec<f64>) -> io::Result<Self> {
        let mut along: Option<Vec<f64>> = None;
        Self::traced(pairs, &mut |direction, [from, to]| {
            let along = along.get_or_insert_with(|| {
                let finite = wanted.iter().filter(|x| x.is_finite());
                let mut along: Vec<f64> = finite.map(|x| direction * x).collect();
                along.sort_unstable_by(f64::total_cmp);
                along
            });
            to > from && along.partition_point(|&x| x <= from) < along.partition_point(|&x| x <= to)
        })
    }

    /// Follows the branch. It keeps the first row, the first row at the end, and both ends of each interval between rows for which
    /// `wants` returns true, given the direction and both x along it.
    fn traced(pairs: &Pairs<'_>, wants: &mut dyn FnMut(f64, [f64; 2]) -> bool) -> io::Result<Self> {
        let (mut start, mut least, mut greatest) = (None, f64::INFINITY, f64::NEG_INFINITY);
        pairs(&mut |x, _| {
            if !x.is_finite() {
                return ControlFlow::Break(());
            }
            start.get_or_insert(x);
            (least, greatest) = (x.min(least), x.max(greatest));
            ControlFlow::Continue(())
        })?;
        let noise = NOISE * (greatest - least).max(0.0);
        let start = start.unwrap_or(0.0);
        let mut departure = start;
        pairs(&mut |x, _| {
            if !x.is_finite() || (x - start).abs() > noise {
                departure = if x.is_finite() { x } else { start };
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })?;
        let direction = if departure < start { -1.0 } else { 1.0 };
        let mut branch = Self { direction, noise, ..Self::default() };
        // the row before, and the first with the furthest x so far; whether they were kept
        let mut before: Option<([f64; 2], bool)> = None;
        let mut furthest: Option<([f64; 2], bool)> = None;
        pairs(&mut |x, y| {
            let x = direction * x;
            let Some((last, is_kept)) = before else {
                if x.is_finite() {
                    branch.push([x, y]);
                    (before, furthest) = (Some(([x, y], true)), Some(([x, y], true)));
                    return ControlFlow::Continue(());
                }
                return ControlFlow::Break(());
            };
            if !x.is_finite() || x < last[0] - noise {
                return ControlFlow::Break(());
            }
            let row = [x.max(last[0]), y];
            let is_wanted = wants(direction, [last[0], row[0]]);
            if is_wanted {
                if !is_kept {
                    branch.push(last);
                }
                branch.push(row);
            }
            before = Some((row, is_wanted));
            if row[0] > last[0] {
                furthest = before;
            }
            ControlFlow::Continue(())
        })?;
        if let Some((row, false)) = furthest {
            branch.push(row);
        }
        Ok(branch)
    }

    fn push(&mut self, [x, y]: [f64; 2]) {
        self.x.push(x);
        self.y.push(y);
    }

    /// y at x; `None` outside the branch. Where x stands still, the first y counts.
    pub fn at(&self, x: f64) -> Option<f64> {
        let (&first, &last) = (self.x.first()?, self.x.last()?);
        let x = self.direction * x;
        // NaN is outside as well
        if !(x >= first - self.noise && x <= last + self.noise) {
            return None;
        }
        let x = x.clamp(first, last);
        let right = self.x.partition_point(|&value| value < x);
        let y = *self.y.get(right)?;
        if right == 0 || self.x[right] == x {
            return Some(y);
        }
        let weight = (x - self.x[right - 1]) / (self.x[right] - self.x[right - 1]);
        Some(self.y[right - 1] + weight * (y - self.y[right - 1]))
    }
}

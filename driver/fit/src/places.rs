//! Least squares from several places between bounds: the best end counts, and says how well its numbers are known.
//!
//! Bounds are kept by what is sought instead of the numbers: of u, the number or its logarithm, between two bounds it is z with
//! u = lo + (hi − lo)(1 + sin z)/2, with one bound z with u = lo + z² or hi − z², without bounds u itself.

use super::search::{Best, Search, Simulation, root_mean_square};
use levenberg_marquardt::LevenbergMarquardt;
use nalgebra::{DMatrix, DVector};
use pullout_bridging::{Estimate, estimates};

/// The search ends when the sum of squares would fall, or what is sought would move, by less than this part.
const SMALLEST: f64 = 1e-10;
/// A start on a bound moves inwards by this part of the distance of the bounds, or of its size with one bound: on them nothing has a
/// slope.
const INWARDS: f64 = 0.01;
/// Differences so small, as a part of the greatest value of the data, are what rounding leaves: nothing better is sought.
const AT_ROUNDING: f64 = 1e-6;
/// Ends of searches whose root mean squares differ by less than this part are the same.
const SAME_END: f64 = 1e-3;
/// Bounds that are further apart than this ratio are searched by orders of magnitude.
const WIDE: f64 = 10.0;
/// A number so near to a bound, as a part of the distance of the bounds, lies on it.
const ON_BOUND: f64 = 1e-6;

/// Where a number may lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Bounds; infinite ones are none.
    pub bounds: [f64; 2],
    /// Whether its logarithm is sought.
    pub is_logarithmic: bool,
}

impl Range {
    /// The bounds of the number, or of its logarithm.
    fn inner(&self) -> [f64; 2] {
        // numbers below 0 have no logarithm
        self.bounds.map(|bound| if self.is_logarithmic { bound.max(0.0).ln() } else { bound })
    }

    fn value(&self, sought: f64) -> f64 {
        let u = match self.inner() {
            [low, high] if low.is_finite() && high.is_finite() => low + (high - low) * 0.5 * (1.0 + sought.sin()),
            [low, _] if low.is_finite() => low + sought * sought,
            [_, high] if high.is_finite() => high - sought * sought,
            _ => sought,
        };
        let value = if self.is_logarithmic { u.exp() } else { u };
        value.clamp(self.bounds[0], self.bounds[1])
    }

    fn sought(&self, value: f64) -> f64 {
        let u = if self.is_logarithmic { value.ln() } else { value };
        match self.inner() {
            [low, high] if low.is_finite() && high.is_finite() => {
                (2.0 * (u - low) / (high - low) - 1.0).clamp(-1.0, 1.0).asin()
            }
            [low, _] if low.is_finite() => (u - low).max(0.0).sqrt(),
            [_, high] if high.is_finite() => (high - u).max(0.0).sqrt(),
            _ => u,
        }
    }

    /// ∂value/∂sought.
    fn slope(&self, sought: f64) -> f64 {
        let slope = match self.inner() {
            [low, high] if low.is_finite() && high.is_finite() => 0.5 * (high - low) * sought.cos(),
            [low, _] if low.is_finite() => 2.0 * sought,
            [_, high] if high.is_finite() => -2.0 * sought,
            _ => 1.0,
        };
        if self.is_logarithmic { slope * self.value(sought) } else { slope }
    }

    /// Distance of the bounds, or the size of a value where one of them is infinite.
    fn width(&self, value: f64) -> f64 {
        let width = self.bounds[1] - self.bounds[0];
        if width.is_finite() { width } else { size(value) }
    }

    /// A start, inwards from the bound that it is on.
    pub(super) fn inside(&self, start: f64) -> f64 {
        let inwards = INWARDS * self.width(start);
        match self.bounds {
            [low, _] if start == low => low + inwards,
            [_, high] if start == high => high - inwards,
            _ => start,
        }
    }

    /// Returns the bound that a value lies on.
    pub fn bound(&self, value: f64) -> Option<f64> {
        let near = ON_BOUND * self.width(value);
        self.bounds.into_iter().find(|bound| (bound - value).abs() <= near)
    }
}

/// Place `number`, from 1, of a sequence that fills what lies between the bounds evenly: multiples of powers of 1/φ with
/// φ^(n + 1) = φ + 1 for n numbers, the golden ratio of one (M. Roberts, 2018).
fn place_between(ranges: &[Range], number: usize) -> Vec<f64> {
    let ratio = (0..64).fold(2.0_f64, |ratio, _| (1.0 + ratio).powf(1.0 / (ranges.len() as f64 + 1.0)));
    let place = |(k, range): (usize, &Range)| {
        let [low, high] = range.bounds;
        let part = (0.5 + number as f64 * ratio.powi(-(k as i32 + 1))).fract();
        if low > 0.0 && high > WIDE * low { low * (high / low).powf(part) } else { low + part * (high - low) }
    };
    ranges.iter().enumerate().map(place).collect()
}

pub(super) fn size(value: f64) -> f64 {
    if value == 0.0 { 1.0 } else { value.abs() }
}

/// A simulation by what is sought instead of its numbers.
struct Bounded<'a, S> {
    simulation: &'a S,
    ranges: &'a [Range],
}

impl<S> Bounded<'_, S> {
    fn values(&self, sought: &[f64]) -> Vec<f64> {
        self.ranges.iter().zip(sought).map(|(range, sought)| range.value(*sought)).collect()
    }

    fn sought(&self, values: &[f64]) -> Vec<f64> {
        self.ranges.iter().zip(values).map(|(range, value)| range.sought(*value)).collect()
    }
}

impl<S: Simulation> Simulation for Bounded<'_, S> {
    type Run = S::Run;

    fn run(&self, sought: &[f64]) -> Result<S::Run, String> {
        self.simulation.run(&self.values(sought))
    }

    fn differences(&self, run: &S::Run) -> DVector<f64> {
        self.simulation.differences(run)
    }

    fn derivatives(&self, sought: &[f64], run: &S::Run) -> Result<DMatrix<f64>, String> {
        let mut derivatives = self.simulation.derivatives(&self.values(sought), run)?;
        for ((mut column, range), sought) in derivatives.column_iter_mut().zip(self.ranges).zip(sought) {
            column *= range.slope(*sought);
        }
        Ok(derivatives)
    }

    fn rms(&self, run: &S::Run) -> f64 {
        self.simulation.rms(run)
    }
}

/// The best end of searches from several places.
#[derive(Clone, Debug)]
pub struct BestFit<R> {
    /// Run with the numbers that fit best.
    pub run: R,
    /// These numbers.
    pub estimates: Vec<Estimate>,
    /// Their correlations.
    pub correlation: DMatrix<f64>,
    /// Places that were searched from, and how many of these searches ended here.
    pub searches: [usize; 2],
    /// Runs that were made.
    pub runs: usize,
    /// Reason why it is not the best.
    pub trouble: Option<String>,
}

/// Searches from `start`, and from other places between the bounds until there are `places`, with at most `max_runs` runs.
///
/// `scatter`: standard deviation of the differences; `None`: that of what remains. `progress` receives the number of runs so far and
/// the root mean square of the differences.
///
/// # Errors
/// Reason why there is no curve at the start.
pub fn least_squares<S: Simulation>(
    simulation: &S,
    ranges: &[Range],
    start: &[f64],
    [places, max_runs]: [usize; 2],
    scatter: Option<f64>,
    progress: &dyn Fn(usize, f64),
) -> Result<BestFit<S::Run>, String> {
    let bounded = Bounded { simulation, ranges };
    let mut problem = Search::new(&bounded, max_runs, 0, progress);
    let mut ends: Vec<(Best<S::Run>, Option<String>)> = Vec::new();
    let least = |(best, _): &(Best<S::Run>, _)| root_mean_square(&simulation.differences(&best.run));
    let mut searches = 0;
    while searches < places.max(1) && (searches == 0 || problem.may_run(1 + start.len())) {
        let begin = if searches == 0 {
            std::iter::zip(ranges, start).map(|(range, start)| range.inside(*start)).collect()
        } else {
            place_between(ranges, searches)
        };
        searches += 1;
        match problem.begin(&bounded.sought(&begin)) {
            Err(message) if searches == 1 => return Err(message),
            Err(_) => continue,
            Ok(()) => {}
        }
        let method = LevenbergMarquardt::new().with_ftol(SMALLEST).with_xtol(SMALLEST);
        let trouble;
        (problem, trouble) = problem.search(method);
        ends.extend(problem.best.take().map(|best| (best, trouble)));
        if ends.iter().any(|end| least(end) <= AT_ROUNDING) {
            break;
        }
    }
    let smallest = ends.iter().map(least).fold(f64::INFINITY, f64::min);
    let is_same = |end: &&(Best<S::Run>, _)| least(end) <= smallest * (1.0 + SAME_END) + AT_ROUNDING;
    let searches = [searches, ends.iter().filter(is_same).count()];
    let (best, trouble) = ends.into_iter().find(|end| least(end) <= smallest).ok_or("no run gives a curve")?;
    let values = bounded.values(&best.coordinates);
    problem.count_derivative_runs();
    let derivatives = simulation.derivatives(&values, &best.run);
    let trouble = trouble.or_else(|| derivatives.as_ref().err().cloned());
    // relative changes of the numbers, so that all are of one size
    let sizes = DMatrix::from_diagonal(&DVector::from_iterator(values.len(), values.iter().map(|&value| size(value))));
    let residuals = simulation.differences(&best.run);
    let unknown = |&value: &f64| Estimate { value, standard_error: f64::INFINITY };
    let (estimates, correlation) = match derivatives {
        Ok(slopes) => estimates(&values, residuals.as_slice(), scatter, &(slopes * &sizes), &[], &sizes),
        Err(_) => (values.iter().map(unknown).collect(), DMatrix::identity(values.len(), values.len())),
    };
    Ok(BestFit { run: best.run, estimates, correlation, searches, runs: problem.runs(), trouble })
}

//! A fibre that stretches under any bond law τ(s): EA s″ = π d τ(s) from its free tail to the exit.
//!
//! With straight lines for τ both the first integral, (EA s′)² = 2 π d EA ∫ τ ds, and the length that belongs to a slip
//! are known in closed form on every line. Nothing is iterated along the fibre.

use super::Side;
use crate::interpolation::{monotone, monotone_slopes};
use crate::quadrature::{maximum, root};
use crate::{Fibre, Invalid};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Slip of the tail, as a part of that of the exit, below which its part in the load is below rounding.
const STUCK_TAIL: f64 = 1e-12;
/// Number of lengths at which the greatest load is searched beforehand, closer where they are short.
const PEAK_LENGTHS: usize = 160;
/// Steps of golden section over the logarithm of the slip.
const PEAK_STEPS: usize = 60;
/// The logarithm of the slip, as a part of the length, where the search for a peak begins.
const LEAST_PEAK: f64 = -30.0;
/// z² up to which six terms of its series give a length to rounding.
const SHORT_PASS: f64 = 2e-3;
/// The first factor by which a bracket is widened.
const FIRST_STEP: f64 = 1.05;
/// Number of straight lines per decade of slip that replace a curved law.
const LINES_PER_DECADE: f64 = 25.0;

/// Straight lines through (slip, traction), constant after the last; the first slip is 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct BondLaw {
    /// Slip, mm, and traction, MPa.
    pub points: Vec<[f64; 2]>,
}

impl BondLaw {
    /// Returns lines that approximate a law τ(s), which is linear up to its first joint and smooth between joints,
    /// until `end`.
    pub fn sampled(traction: impl Fn(f64) -> f64, joints: &[f64], end: f64) -> Self {
        let mut points = vec![[0.0, traction(0.0)]];
        let mut ends = joints.to_vec();
        ends.push(end);
        let mut from = ends[0];
        points.push([from, traction(from)]);
        for &to in &ends[1..] {
            let lines = (LINES_PER_DECADE * (to / from).log10()).ceil().max(1.0);
            let ratio = (to / from).powf(1.0 / lines);
            points.extend((1..=lines as i32).map(|k| from * ratio.powi(k)).map(|slip| [slip, traction(slip)]));
            from = to;
        }
        Self { points }
    }
}

/// The bond of a fibre that stretches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShearLag {
    /// τ(s).
    pub law: BondLaw,
}

impl ShearLag {
    /// Checks the points.
    ///
    /// # Errors
    /// Points that are no law.
    pub fn check(&self) -> Result<(), Invalid> {
        let place = |k: usize| format!("fibre.law[{k}]");
        let points = &self.law.points;
        Invalid::unless(points.len() >= 2, "fibre.law".into(), "needs two points [slip, traction] or more")?;
        Invalid::unless(points[0][0] == 0.0, place(0), "must have the slip 0")?;
        for (k, [slip, traction]) in points.iter().enumerate() {
            let finite = slip.is_finite() && *traction >= 0.0 && traction.is_finite();
            Invalid::unless(finite, place(k), "needs a slip and a traction not below 0")?;
            Invalid::unless(
                k == 0 || *slip > points[k - 1][0],
                place(k),
                "must have a greater slip than the one before",
            )?;
        }
        let any = points[1][1] > 0.0;
        Invalid::unless(any || points[0][1] > 0.0, place(1), "must have a traction above 0: the bond begins there")
    }

    pub(crate) fn side(&self, fibre: &Fibre, modulus: f64) -> ShearLagSide {
        ShearLagSide::new(&self.law.points, fibre, modulus)
    }
}

/// A straight line of the law, from its beginning.
#[derive(Clone, Copy, Debug)]
struct Line {
    slip: f64,
    traction: f64,
    slope: f64,
    /// ∫ τ ds up to here.
    work: f64,
    /// Strain here, and length from a tail at rest up to here, for a bond that resists from slip 0 on.
    anchored: [f64; 2],
}

impl Line {
    fn traction_at(&self, slip: f64) -> f64 {
        self.traction + self.slope * (slip - self.slip)
    }
}

/// The law with the fibre it acts on.
#[derive(Clone, Debug)]
pub(crate) struct ShearLagSide {
    lines: Vec<Line>,
    /// κ = 4/(E d), in s″ = κ τ.
    kappa: f64,
    /// EA.
    stiffness: f64,
    /// Lengths, with slip and load of the peak at each.
    lengths: Vec<f64>,
    peak_slips: (Vec<f64>, Vec<f64>),
    peak_loads: (Vec<f64>, Vec<f64>),
}

impl ShearLagSide {
    fn new(points: &[[f64; 2]], fibre: &Fibre, modulus: f64) -> Self {
        let mut lines: Vec<Line> = Vec::new();
        for (k, &[slip, traction]) in points.iter().enumerate() {
            let next = points.get(k + 1);
            let slope = next.map_or(0.0, |&[end, value]| (value - traction) / (end - slip));
            let work =
                lines.last().map_or(0.0, |line| line.work + 0.5 * (line.traction + traction) * (slip - line.slip));
            lines.push(Line { slip, traction, slope, work, anchored: [0.0; 2] });
        }
        let mut side = Self {
            lines,
            kappa: 4.0 / (modulus * fibre.diameter),
            stiffness: modulus * fibre.area(),
            lengths: Vec::new(),
            peak_slips: Default::default(),
            peak_loads: Default::default(),
        };
        for k in 1..side.lines.len() {
            let before = side.lines[k - 1];
            let [strain, length] = before.anchored;
            let passed = side.pass(before.slope, before.traction, side.lines[k].slip - before.slip, strain);
            side.lines[k].anchored = [passed.0, length + passed.1];
        }
        side.lengths = (0..=PEAK_LENGTHS).map(|k| fibre.length * (k as f64 / PEAK_LENGTHS as f64).powi(2)).collect();
        let peaks: Vec<(f64, f64)> = side.lengths.iter().map(|&length| side.peak(length)).collect();
        let with_slopes = |values: Vec<f64>| {
            let slopes = monotone_slopes(&side.lengths, &values);
            (values, slopes)
        };
        let slips = with_slopes(peaks.iter().map(|peak| peak.0).collect());
        let loads = with_slopes(peaks.iter().map(|peak| peak.1).collect());
        (side.peak_slips, side.peak_loads) = (slips, loads);
        side
    }

    fn peak(&self, embedded: f64) -> (f64, f64) {
        if embedded == 0.0 {
            return (0.0, 0.0);
        }
        let load = |logarithm: f64| self.load(embedded * logarithm.exp(), embedded);
        let (logarithm, load) = maximum(load, LEAST_PEAK, 0.0, PEAK_STEPS);
        (embedded * logarithm.exp(), load)
    }

    fn line(&self, slip: f64) -> usize {
        self.lines.partition_point(|line| line.slip <= slip).max(1) - 1
    }

    /// ∫ τ ds from 0.
    fn work(&self, slip: f64) -> f64 {
        let line = &self.lines[self.line(slip)];
        let beyond = slip - line.slip;
        line.work + beyond * (line.traction + 0.5 * line.slope * beyond)
    }

    /// The slip at which ∫ τ ds reaches a value.
    fn slip_of_work(&self, work: f64) -> f64 {
        let line = &self.lines[self.lines.partition_point(|line| line.work <= work).max(1) - 1];
        let left = work - line.work;
        let root = (line.traction * line.traction + 2.0 * line.slope * left).max(0.0).sqrt();
        line.slip + 2.0 * left / (line.traction + root)
    }

    /// Integrates along one line, over `stretch` of slip: from the strain s′ to the strain at its end, and the length between.
    ///
    /// ```text
    /// ε_b² = ε_a² + 2κ ∫τ ds,   z = ω Δs/(ε_a + ε_b),   ω² = κ|τ′|
    /// ω Δx/2 = artanh z where τ rises, arctan z where it falls
    /// ```
    fn pass(&self, slope: f64, traction: f64, stretch: f64, strain: f64) -> (f64, f64) {
        let end = (strain * strain + 2.0 * self.kappa * stretch * (traction + 0.5 * slope * stretch)).max(0.0).sqrt();
        if stretch == 0.0 {
            return (end, 0.0);
        }
        if end == 0.0 {
            // without bond no length of fibre stretches
            return (end, f64::INFINITY);
        }
        let part = stretch / (strain + end);
        // z², with the sign of the slope
        let square = self.kappa * slope * part * part;
        let series = if square.abs() < SHORT_PASS {
            1.0 + square * (1.0 / 3.0 + square * (0.2 + square * (1.0 / 7.0 + square * (1.0 / 9.0 + square / 11.0))))
        } else {
            let z = square.abs().sqrt();
            // rounding must not carry it beyond 1, which is a tail without end
            if square > 0.0 { z.min(1.0).atanh() / z } else { z.atan() / z }
        };
        (end, 2.0 * part * series)
    }

    /// Returns the length of fibre between the exit and a tail that slips by `exit − stretch`, and the strain at the
    /// exit.
    fn length(&self, exit: f64, stretch: f64) -> (f64, f64) {
        let (first, last) = (self.line(exit - stretch), self.line(exit));
        if first == last {
            // the stretch of a stiff fibre is far below the slip: it must not be the difference of slips
            let line = &self.lines[first];
            let (strain, length) = self.pass(line.slope, line.traction_at(exit) - line.slope * stretch, stretch, 0.0);
            return (length, strain);
        }
        let (mut slip, mut strain, mut length) = (exit - stretch, 0.0, 0.0);
        for k in first..=last {
            let line = &self.lines[k];
            let end = if k == last { exit } else { self.lines[k + 1].slip };
            let passed = self.pass(line.slope, line.traction_at(slip), end - slip, strain);
            (slip, strain, length) = (end, passed.0, length + passed.1);
        }
        (length, strain)
    }

    /// The part of the exit's slip by which the fibre has stretched at most: all of it, while the tail is at rest.
    fn longest_stretch(&self, slip: f64) -> f64 {
        if self.lines[0].traction > 0.0 { slip } else { slip * (1.0 - STUCK_TAIL) }
    }

    /// Returns whether the tail does not move: the bond resists at no slip, and the fibre is as long as the slip
    /// requires.
    fn is_anchored(&self, slip: f64, embedded: f64) -> bool {
        let line = &self.lines[self.line(slip)];
        let [strain, length] = line.anchored;
        let rest = || self.pass(line.slope, line.traction, slip - line.slip, strain).1;
        self.lines[0].traction > 0.0 && length <= embedded && length + rest() <= embedded
    }

    fn peak_load(&self, embedded: f64) -> f64 {
        monotone(embedded, &self.lengths, &self.peak_loads.0, &self.peak_loads.1)
    }

    fn load(&self, slip: f64, embedded: f64) -> f64 {
        if slip <= 0.0 || slip >= embedded {
            return 0.0;
        }
        if self.is_anchored(slip, embedded) {
            return self.stiffness * (2.0 * self.kappa * self.work(slip)).sqrt();
        }
        // v = √(slip − slip of the tail): the length begins in proportion to it. The least root: of several states at
        // one slip that of the lowest load
        let longest = self.longest_stretch(slip).sqrt();
        let excess = |v: f64| self.length(slip, v * v).0 + slip - v * v - embedded;
        let traction = self.lines[self.line(slip)].traction_at(slip).max(0.0);
        // of constant traction: near where the slip is large
        let guess = ((embedded - slip) * (0.5 * self.kappa * traction).sqrt()).clamp(1e-9 * longest, longest);
        let (mut low, mut high) = (guess, guess);
        let mut step = FIRST_STEP;
        while low > f64::MIN_POSITIVE && excess(low) > 0.0 {
            high = low;
            low /= step;
            step *= step;
        }
        while high < longest && excess(high) < 0.0 {
            low = high;
            high = (step * high).min(longest);
            step *= FIRST_STEP;
        }
        // the slip of the tail is below what can be resolved
        let v = if high == longest && excess(high) < 0.0 { longest } else { root(excess, low, high) };
        self.stiffness * self.length(slip, v * v).1
    }
}

impl Side for ShearLagSide {
    fn loads(&self, slip: f64, embedded: f64) -> (f64, f64) {
        let load = self.load(slip, embedded);
        if slip <= self.turning_slip(embedded) {
            return (load, load);
        }
        (load, load.max(self.peak_load(embedded)))
    }

    fn stage(&self, slip: f64, embedded: f64) -> u8 {
        if slip >= embedded {
            3
        } else if slip <= 0.0 || self.is_anchored(slip, embedded) {
            0
        } else {
            1
        }
    }

    fn turning_slip(&self, embedded: f64) -> f64 {
        monotone(embedded, &self.lengths, &self.peak_slips.0, &self.peak_slips.1)
    }

    /// Returns the slip of the tail at a load. With it the load gives the slip of the exit, ∫τ ds = P²/(2κ(EA)²), and these the length: one
    /// unknown.
    fn loading_slip(&self, load: f64, embedded: f64) -> f64 {
        if load <= 0.0 {
            return 0.0;
        }
        let strain = load / self.stiffness;
        let work = 0.5 * strain * strain / self.kappa;
        let slip = self.slip_of_work(work);
        if slip.is_finite() && self.is_anchored(slip, embedded) {
            return slip;
        }
        let turning = self.turning_slip(embedded);
        let peak = self.peak_load(embedded);
        let of_tail = |logarithm: f64| {
            let tail = logarithm.exp();
            (tail, self.slip_of_work(self.work(tail) + work))
        };
        let excess = |logarithm: f64| {
            let (tail, exit) = of_tail(logarithm);
            let length = self.length(exit, exit - tail).0;
            if length.is_finite() { length + tail - embedded } else { embedded }
        };
        let spent = 0.5 * (peak / self.stiffness).powi(2) / self.kappa;
        let greatest = self.slip_of_work((self.work(turning) - spent).max(0.0));
        if load >= peak || greatest <= 0.0 {
            return turning;
        }
        let (low, high) = ((STUCK_TAIL * greatest).ln(), greatest.ln());
        if excess(high) >= 0.0 {
            return turning;
        }
        if excess(low) <= 0.0 {
            return of_tail(low).1;
        }
        of_tail(root(excess, low, high)).1
    }
}

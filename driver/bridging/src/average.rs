//! σ_f(w): the mean over lengths and directions (B1), by Gauss–Legendre panels between kinks.

use crate::Composite;
use crate::bridging::Prepared;
use crate::orientation::Directions;
use crate::quadrature::{DEGREES, Resolution, changes, rule};
use rayon::prelude::*;

/// Fewest samples of the angle on a panel.
const FEWEST_ANGLES: usize = 2;
/// Number of bins of the right angle in which shares are given.
const BINS: usize = 9;

/// Bridging at one opening.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Average {
    /// w, mm.
    pub opening: f64,
    /// σ_f, MPa.
    pub stress: f64,
    /// Part of the fibres across the crack that carry load.
    pub active: f64,
    /// Part that has broken.
    pub ruptured: f64,
    /// Mean of the spalled lengths, mm.
    pub spalled_mean: f64,
    /// Estimate of the error of σ_f, MPa: the difference of the last two rules.
    pub error: f64,
}

/// Σ over nodes of load, carrying, broken and spalled.
type Sums = [f64; 4];

/// Returns the averages at openings, in their order.
pub fn averages(composite: &Composite, openings: &[f64]) -> Vec<Average> {
    openings.par_iter().map(|&opening| composite.average(opening)).collect()
}

/// Returns the averages at openings, each with the parts of σ_f that fibres at 0–10°, 10–20°, …, 80–90° carry.
pub fn averages_with_shares(composite: &Composite, openings: &[f64]) -> Vec<(Average, [f64; BINS])> {
    openings.par_iter().map(|&opening| composite.average_with_shares(opening)).collect()
}

impl Composite {
    /// The edges of the bins of [`averages_with_shares`].
    pub(crate) fn bin_edges() -> Vec<f64> {
        (1..BINS).map(|k| (90.0 * k as f64 / BINS as f64).to_radians()).collect()
    }

    /// Fibres at one angle need no integral over it: rounding is cheap.
    pub(crate) fn resolution(&self, directions: &Directions) -> Resolution {
        match (directions.is_single(), self.rough) {
            (true, _) => Resolution::EXACT,
            (false, true) => Resolution::TABLE,
            (false, false) => self.fibre.resolution(),
        }
    }

    /// Bridging at an opening.
    pub fn average(&self, opening: f64) -> Average {
        self.average_over(&self.directions, opening, &mut |_| ())
    }

    /// Returns the average at an opening with the parts that bins of the angle carry: 0 where there is no stress.
    fn average_with_shares(&self, opening: f64) -> (Average, [f64; BINS]) {
        let mut bins = [0.0; BINS];
        let average = self.average_over(&self.binned, opening, &mut |node| match node {
            None => bins = [0.0; BINS],
            Some((angle, load)) => {
                let bin = (angle.to_degrees() * BINS as f64 / 90.0) as usize;
                bins[bin.min(BINS - 1)] += load;
            }
        });
        let total: f64 = bins.iter().sum();
        (average, if total > 0.0 { bins.map(|bin| bin / total) } else { bins })
    }

    /// Averages over lengths and angles. `visit` receives `None` when a rule begins, then angle and weighted load of
    /// each node.
    fn average_over(
        &self,
        directions: &Directions,
        opening: f64,
        visit: &mut impl FnMut(Option<(f64, f64)>),
    ) -> Average {
        if opening < self.activation {
            return Average { opening, ..Average::default() };
        }
        let integral = Integral::new(self, directions, opening - self.activation);
        let agreement = self.resolution(directions).agreement;
        let mut by = |level: usize| {
            visit(None);
            integral.sums(level, &mut |angle, load| visit(Some((angle, load))))
        };
        let mut coarse = by(0);
        let mut error = 0.0;
        for level in 1..DEGREES.len() {
            let fine = by(level);
            error = (fine[0] - coarse[0]).abs();
            coarse = fine;
            if error <= agreement * fine[0].abs() {
                break;
            }
        }
        let scale = self.volume_fraction / self.fibre.fibre.area();
        let crossing = |sum: f64| sum / directions.efficiency;
        Average {
            opening,
            stress: scale * coarse[0],
            active: crossing(coarse[1]),
            ruptured: crossing(coarse[2]),
            spalled_mean: crossing(coarse[3]),
            error: scale * error,
        }
    }
}

/// The ends, and between them the places where `label` changes.
fn refined<L: PartialEq>(ends: &[f64], resolution: Resolution, label: impl Fn(f64) -> L) -> Vec<f64> {
    let mut refined = vec![ends[0]];
    for pair in ends.windows(2) {
        refined.extend(changes(pair[0], pair[1], resolution.samples, resolution.halvings[0], &label));
        refined.push(pair[1]);
    }
    refined
}

/// The double integral at one opening.
struct Integral<'c> {
    composite: &'c Composite,
    directions: &'c Directions,
    opening: f64,
    /// Ends of the panels over the length.
    lengths: Vec<f64>,
    /// Samples of the angle per panel; 0: there are no kinks over the angle.
    samples: usize,
    resolution: Resolution,
}

impl<'c> Integral<'c> {
    fn new(composite: &'c Composite, directions: &'c Directions, opening: f64) -> Self {
        let resolution = composite.resolution(directions);
        let kinks = composite.fibre.has_kinks_over_angles() && !directions.is_single();
        let samples = if kinks { (resolution.samples / (directions.panels.len() - 1)).max(FEWEST_ANGLES) } else { 0 };
        let half = 0.5 * composite.fibre.fibre.length;
        let mut integral = Self { composite, directions, opening, lengths: vec![0.0], samples, resolution };
        let inner = composite.fibre.lengths().iter().copied().filter(|&length| length < half * (1.0 - 1e-9));
        // first the kinks that all angles have in common, then those where a front enters or leaves the angles
        let nodes: Vec<f64> = [0.0].into_iter().chain(inner).chain([half]).collect();
        let common = if composite.fibre.has_all_lengths() {
            nodes
        } else {
            refined(&nodes, resolution, |length| integral.prepare(length).stage())
        };
        integral.lengths = if kinks || directions.is_single() {
            refined(&common, resolution, |length| integral.fronts(length))
        } else {
            common
        };
        integral
    }

    fn prepare(&self, length: f64) -> Prepared<'c> {
        self.composite.fibre.prepare(self.opening, length)
    }

    /// Stages met over the angles, one after the other.
    fn fronts(&self, length: f64) -> u64 {
        let prepared = self.prepare(length);
        let mut met = 0_u64;
        let mut last = 0;
        let mut note = |angle: f64| {
            // eight stages can be distinguished, one in each byte
            let stage = 1 + u64::from(self.composite.fibre.respond(&prepared, angle).stage);
            if stage != last {
                met = met << 8 | stage;
                last = stage;
            }
        };
        if self.directions.is_single() {
            note(self.directions.nodes(0, 0)[0].0);
        }
        for ends in self.directions.panels.windows(2) {
            // with the ends: a front enters there
            let at = |k: usize| ends[0] + (ends[1] - ends[0]) * k as f64 / self.samples.max(1) as f64;
            (0..=self.samples).filter(|_| self.samples > 0).map(at).for_each(&mut note);
        }
        met
    }

    /// Returns the sums by the rule of one degree; `visit` receives angle and weighted load of every node.
    fn sums(&self, level: usize, visit: &mut impl FnMut(f64, f64)) -> Sums {
        let half = 0.5 * self.composite.fibre.fibre.length;
        let mut sums = Sums::default();
        for ends in self.lengths.windows(2) {
            for (node, weight) in rule(level) {
                let length = ends[0] + (ends[1] - ends[0]) * node;
                self.over_angles(level, &self.prepare(length), weight * (ends[1] - ends[0]) / half, &mut sums, visit);
            }
        }
        sums
    }

    fn over_angles(
        &self,
        level: usize,
        prepared: &Prepared<'_>,
        share: f64,
        sums: &mut Sums,
        visit: &mut impl FnMut(f64, f64),
    ) {
        let fibre = &self.composite.fibre;
        // the part of the fibres across the crack
        let cosine = |(angle, weight): (f64, f64)| (angle, weight * angle.cos());
        let mut add = |(angle, weight): (f64, f64)| {
            let response = fibre.respond(prepared, angle);
            let crossing = share * weight;
            sums[0] += crossing * response.load;
            sums[1] += if response.load > 0.0 { crossing } else { 0.0 };
            sums[2] += if response.ruptured { crossing } else { 0.0 };
            sums[3] += crossing * response.spalled;
            visit(angle, crossing * response.load);
        };
        for (panel, ends) in self.directions.panels.windows(2).enumerate() {
            let kinks = match self.samples {
                0 => Vec::new(),
                samples => changes(ends[0], ends[1], samples, self.resolution.halvings[1], |angle| {
                    fibre.respond(prepared, angle).stage
                }),
            };
            if kinks.is_empty() {
                self.directions.crossing(level, panel).iter().copied().for_each(&mut add);
                continue;
            }
            let mut from = ends[0];
            for to in kinks.into_iter().chain([ends[1]]) {
                self.directions.nodes_between(level, from, to).map(cosine).for_each(&mut add);
                from = to;
            }
        }
    }
}

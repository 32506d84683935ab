//! Curves of tests or of simulations at angles and lengths, and interpolation between them.

use crate::Invalid;
use crate::bond::opening;
use crate::interpolation::{Polyline, monotone, monotone_slopes};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Every interval of lengths is divided into so many when two sides are put together.
const PARTS: usize = 2;
/// Number of slips at which two sides are combined, in addition to those of the curves.
const SLIPS: usize = 60;

/// A curve of one fibre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// θ, degrees.
    pub angle_deg: f64,
    /// L_e, mm.
    pub embedded: f64,
    /// Slips, mm, rising,
    pub slip: Vec<f64>,
    /// and loads along the crack's normal, N.
    pub load: Vec<f64>,
}

#[derive(Clone, Debug)]
struct Measured {
    curve: Polyline,
    highest: Polyline,
    peak_slip: f64,
}

impl Measured {
    /// Reads a curve. One that ends with a load goes on straight to none at the slip of extraction, or falls at once beyond that.
    fn new(curve: &Curve) -> Self {
        let mut points: Vec<(f64, f64)> = curve.slip.iter().copied().zip(curve.load.iter().copied()).collect();
        if points.first().is_none_or(|first| first.0 > 0.0) {
            points.insert(0, (0.0, 0.0));
        }
        if let Some(&(slip, _)) = points.last().filter(|last| last.1 != 0.0) {
            points.push((curve.embedded.max(slip.next_up()), 0.0));
        }
        Self::of(Polyline::new(points))
    }

    fn of(curve: Polyline) -> Self {
        let peak = curve.points().fold((0.0, 0.0), |peak, point| if point.1 > peak.1 { point } else { peak });
        Self { highest: curve.highest(), peak_slip: peak.0, curve }
    }
}

/// Curves at all pairs of angles and lengths.
#[derive(Clone, Debug)]
pub struct Table {
    angles: Vec<f64>,
    pub(crate) lengths: Vec<f64>,
    /// Curves by angle, then length.
    curves: Vec<Vec<Measured>>,
    cut: f64,
}

/// Loads at all angles of the table at one opening and length.
#[derive(Clone, Debug)]
pub(crate) struct Row<'t> {
    table: &'t Table,
    loads: Vec<f64>,
    slopes: Vec<f64>,
    greatest: Vec<f64>,
    greatest_slopes: Vec<f64>,
    /// Interval of lengths.
    pub cell: usize,
}

impl Table {
    /// Makes a table of curves in any order; fibres at more than `cut_deg` carry nothing.
    ///
    /// # Errors
    /// Curves that do not make a table, or do not reach half the fibre's length.
    pub fn new(curves: &[Curve], cut_deg: f64, fibre_length: f64) -> Result<Self, Invalid> {
        let distinct = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        for (k, curve) in curves.iter().enumerate() {
            let place = || format!("fibre.curves[{k}]");
            let sound = (0.0..=90.0).contains(&curve.angle_deg) && curve.embedded > 0.0;
            Invalid::unless(sound, place(), "needs an angle of 0 to 90 degrees and a length above 0")?;
            let paired = curve.slip.len() == curve.load.len() && !curve.slip.is_empty();
            Invalid::unless(paired, place(), "needs as many loads as slips")?;
            let rising = curve.slip[0] >= 0.0 && curve.slip.windows(2).all(|pair| pair[1] > pair[0]);
            Invalid::unless(rising, place(), "needs slips that rise")?;
            let finite = curve.slip.iter().chain(&curve.load).all(|value| value.is_finite());
            Invalid::unless(finite, place(), "contains NaN or infinity")?;
        }
        let angles = distinct(curves.iter().map(|curve| curve.angle_deg).collect());
        let lengths = distinct(curves.iter().map(|curve| curve.embedded).collect());
        let longest = lengths.last().copied().unwrap_or(0.0);
        let rule = "must reach half the length of the fibre";
        Invalid::unless(longest >= 0.5 * fibre_length * (1.0 - 1e-9), "fibre.curves".into(), rule)?;
        let in_range = cut_deg >= *angles.last().unwrap_or(&0.0) && cut_deg <= 90.0;
        Invalid::unless(in_range, "fibre.cut_deg".into(), "must lie between the largest angle of the curves and 90")?;
        let find = |angle: f64, length: f64| {
            curves.iter().find(|curve| curve.angle_deg == angle && curve.embedded == length).map(Measured::new)
        };
        let mut rows = Vec::new();
        for &angle in &angles {
            let row: Option<Vec<Measured>> = lengths.iter().map(|&length| find(angle, length)).collect();
            let rule = format!("has no curve for every length at {angle} degrees");
            rows.push(row.ok_or(Invalid { place: "fibre.curves".into(), rule })?);
        }
        let angles = angles.iter().map(|angle| angle.to_radians()).collect();
        Ok(Self { angles, lengths, curves: rows, cut: cut_deg.to_radians() })
    }

    /// The angles at which its slopes change.
    pub(crate) fn angles(&self) -> impl Iterator<Item = f64> + '_ {
        self.angles.iter().copied().chain([self.cut])
    }

    /// Interpolates between lengths: along equal slip up to the peak, along equal s/L_e beyond twice its slip, smoothly in between;
    /// below the least length in proportion to it.
    /// Load, and the greatest so far if it is wanted.
    fn between(&self, angle: usize, slip: f64, embedded: f64, greatest: bool) -> [f64; 2] {
        let upper = self.cell(embedded);
        let row = &self.curves[angle];
        let above = self.lengths[upper];
        let (below, low) = match upper.checked_sub(1) {
            Some(lower) => (self.lengths[lower], Some(&row[lower])),
            None => (0.0, None),
        };
        let part = (embedded - below) / (above - below);
        let at = |curve: &Measured, slip: f64| {
            let place = curve.curve.place(slip);
            let load = curve.curve.at_place(place);
            [load, if greatest { curve.highest.at_place(place) } else { load }]
        };
        let mean = |at_low: f64, at_high: f64| {
            let lower = low.map_or([0.0; 2], |curve| at(curve, at_low));
            let upper = at(&row[upper], at_high);
            [0, 1].map(|k| lower[k] + part * (upper[k] - lower[k]))
        };
        let peak = part * row[upper].peak_slip + (1.0 - part) * low.map_or(0.0, |curve| curve.peak_slip);
        let scaled = || mean(slip * below / embedded, slip * above / embedded);
        if slip <= peak {
            mean(slip, slip)
        } else if slip >= 2.0 * peak {
            scaled()
        } else {
            let t = slip / peak - 1.0;
            let smooth = t * t * (3.0 - 2.0 * t);
            let (equal, scaled) = (mean(slip, slip), scaled());
            [0, 1].map(|k| (1.0 - smooth) * equal[k] + smooth * scaled[k])
        }
    }

    /// The index of the length that ends the interval.
    fn cell(&self, embedded: f64) -> usize {
        self.lengths.partition_point(|&length| length < embedded).min(self.lengths.len() - 1)
    }

    /// Returns the row at all angles; `greatest` only if it is wanted.
    pub(crate) fn row(&self, slip: f64, embedded: f64, greatest: bool) -> Row<'_> {
        let all = (0..self.angles.len()).map(|angle| self.between(angle, slip, embedded, greatest));
        let (loads, greatest): (Vec<f64>, Vec<f64>) = all.map(|[load, greatest]| (load, greatest)).unzip();
        let slopes = monotone_slopes(&self.angles, &loads);
        let greatest_slopes = monotone_slopes(&self.angles, &greatest);
        Row { table: self, loads, slopes, greatest, greatest_slopes, cell: self.cell(embedded) }
    }

    /// Makes a table of openings instead of slips, where both sides of the crack slip. The long side follows the
    /// loading branch of the longest curve.
    pub(crate) fn of_two_sides(&self) -> Self {
        let mut lengths = Vec::new();
        let mut below = 0.0;
        for &above in &self.lengths {
            lengths.extend((1..=PARTS).map(|k| below + (above - below) * k as f64 / PARTS as f64));
            below = above;
        }
        let combined = |angle: usize, length: f64| {
            let row = &self.curves[angle];
            let loading_slip = |load: f64| row[row.len() - 1].highest.first_reaching(load);
            let upper = self.cell(length);
            let measured = row[upper.saturating_sub(1)..=upper].iter().flat_map(|curve| curve.curve.points());
            let graded = (0..=SLIPS).map(|k| length * (k as f64 / SLIPS as f64).powi(2));
            let mut slips: Vec<f64> = measured.map(|point| point.0).chain(graded).collect();
            slips.sort_by(f64::total_cmp);
            let mut points: Vec<(f64, f64)> = Vec::new();
            for slip in slips {
                let [load, greatest] = self.between(angle, slip, length, true);
                let greatest = load.max(greatest);
                let opening = opening(slip, (load, greatest), loading_slip(greatest), loading_slip);
                // where the crack would close the load falls at once
                if points.last().is_none_or(|last| opening > last.0) {
                    points.push((opening, load));
                }
            }
            Measured::of(Polyline::new(points))
        };
        let curves = (0..self.angles.len())
            .map(|angle| lengths.iter().map(|&length| combined(angle, length)).collect())
            .collect();
        Self { angles: self.angles.clone(), lengths, curves, cut: self.cut }
    }
}

impl Row<'_> {
    /// Interpolates between angles, monotonically; constant beyond the largest, nothing beyond the cut. Load, and the greatest so far.
    pub fn at(&self, angle: f64) -> (f64, f64) {
        let angles = &self.table.angles;
        if angle > self.table.cut {
            return (0.0, 0.0);
        }
        (
            monotone(angle, angles, &self.loads, &self.slopes),
            monotone(angle, angles, &self.greatest, &self.greatest_slopes),
        )
    }
}

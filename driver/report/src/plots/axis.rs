//! Range, scale and ticks of an axis.

use super::figure::Reading;
use super::markup;
use super::quantity::Quantity;
use plotters::coord::ranged1d::{BoldPoints, Ranged};
use plotters::coord::types::RangedCoordf64;
use pullout_run::number::{significant, superscript};
use std::ops::Range;

/// Free space beyond the data, as a part of their span.
const MARGIN: f64 = 0.05;

/// An axis whose numbers are the quantity divided by 10^`exponent`.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub label: String,
    pub range: Range<f64>,
    pub scale: f64,
    /// Number of ticks to ask for.
    pub tick_count: usize,
    decimals: usize,
    kind: Kind,
}

/// Meaning of the numbers of an axis.
#[derive(Clone, Debug)]
enum Kind {
    /// Themselves.
    Numbers,
    /// Exponents of ten.
    Exponents,
    /// Indices of names.
    Names(Vec<String>),
}

impl Axis {
    /// Makes an axis for data between `least` and `greatest`; `least_span` widens a narrower range about its middle.
    pub fn new(quantity: &Quantity, (least, greatest): (f64, f64), least_span: f64, tick_count: usize) -> Self {
        let (start, end) = widened(least, greatest, least_span);
        Self::exact(quantity, start..end, tick_count)
    }

    /// Powers of ten around data > 0.
    pub fn logarithmic(quantity: &Quantity, (least, greatest): (f64, f64)) -> Self {
        let exponent = |value: f64| value.max(f64::MIN_POSITIVE).log10();
        let (least, greatest) = (exponent(least), exponent(greatest));
        let spare = MARGIN * (greatest - least).max(1.0);
        let range = least - spare..greatest + spare;
        let tick_count = (greatest - least).ceil() as usize + 1;
        Self { label: quantity.label(0), range, scale: 1.0, tick_count, decimals: 1, kind: Kind::Exponents }
    }

    /// Names side by side; without a quantity's name the names speak for themselves.
    pub fn named(quantity: &Quantity, names: &[String]) -> Self {
        let label = if quantity.name.is_empty() { String::new() } else { quantity.label(0) };
        let range = -0.5..names.len() as f64 - 0.5;
        Self { label, range, scale: 1.0, tick_count: names.len() + 1, decimals: 0, kind: Kind::Names(names.to_vec()) }
    }

    /// Makes an axis for just this range, in the quantity's unit.
    pub fn exact(quantity: &Quantity, range: Range<f64>, tick_count: usize) -> Self {
        let exponent = exponent(range.start.abs().max(range.end.abs()));
        let scale = 10f64.powi(exponent);
        let range = range.start / scale..range.end / scale;
        let decimals = decimals(&range, tick_count);
        Self { label: quantity.label(exponent), range, scale, tick_count, decimals, kind: Kind::Numbers }
    }

    /// Returns what the axis says of a place.
    pub fn reading(&self) -> Reading {
        let Range { start, end } = self.range;
        Reading { label: markup::plain(&self.label), range: [start, end], scale: self.scale }
    }

    /// Returns where ticks are.
    pub fn ticks(&self) -> Vec<f64> {
        RangedCoordf64::from(self.range.clone()).key_points(BoldPoints(self.tick_count))
    }

    /// Characters of the longest number.
    pub fn widest(&self) -> usize {
        self.ticks().iter().map(|&tick| self.text(tick).chars().count()).max().unwrap_or(1)
    }

    /// Text of a tick.
    pub fn text(&self, value: f64) -> String {
        // no "-0.0"
        let value = if value.abs() < 1e-9 * (self.range.end - self.range.start) { 0.0 } else { value };
        let is_whole = (value - value.round()).abs() < 1e-9;
        match &self.kind {
            Kind::Numbers => {}
            Kind::Exponents if is_whole => return format!("10{}", superscript(value.round() as i32)),
            Kind::Exponents => return significant(10f64.powf(value), 2),
            Kind::Names(names) if is_whole && value >= 0.0 => {
                return names.get(value.round() as usize).cloned().unwrap_or_default();
            }
            Kind::Names(_) => return String::new(),
        }
        format!("{value:.*}", self.decimals).replace('-', "−")
    }

    /// Returns whether 0 is a number as any other on this axis.
    pub fn has_zero(&self) -> bool {
        matches!(self.kind, Kind::Numbers) && self.range.start < 0.0 && self.range.end > 0.0
    }

    /// A value in the axis's numbers.
    pub fn scaled(&self, value: f64) -> f64 {
        if matches!(self.kind, Kind::Exponents) { value.log10() } else { value / self.scale }
    }

    /// Position of a scaled value from 0 (start) to 1 (end).
    pub fn position(&self, scaled: f64) -> f64 {
        (scaled - self.range.start) / (self.range.end - self.range.start)
    }
}

/// Margins; a range of one sign starts or ends at zero if that is not far.
fn widened(least: f64, greatest: f64, least_span: f64) -> (f64, f64) {
    let largest = least.abs().max(greatest.abs());
    // smaller numbers have no power of ten to divide by
    let (least, greatest, largest) = if largest > 1e-290 { (least, greatest, largest) } else { (0.0, 0.0, 0.0) };
    // what rounding leaves of a constant is no range
    let span = least_span.max(1e-6 * largest).max(greatest - least);
    let span = if span > 0.0 { span } else { 1.0 };
    let spare = 0.5 * (span - (greatest - least));
    let (start, end) = (least - spare - MARGIN * span, greatest + spare + MARGIN * span);
    let (narrow, near) = (spare > 0.0, 0.3 * span);
    match (least, greatest) {
        _ if narrow => (start, end),
        (least, _) if least >= -1e-6 * span && least < near => (0.0, end),
        (_, greatest) if greatest <= 1e-6 * span && greatest > -near => (start, 0.0),
        _ => (start, end),
    }
}

/// The power of a thousand to divide by: 0 as long as numbers are handy; small ones become 0.1 … 100.
pub(super) fn exponent(largest: f64) -> i32 {
    match largest.log10() {
        _ if (0.011..1e5).contains(&largest) => 0,
        // of nothing, and of what has no power of ten to divide by
        power if power.is_nan() || power.abs() > 290.0 => 0,
        power if power < 0.0 => 3 * ((power + 1.0) / 3.0).floor() as i32,
        power => 3 * (power / 3.0).floor() as i32,
    }
}

/// Returns whether a number can be drawn: sums and differences of such numbers are finite.
pub(super) fn drawable(value: f64) -> bool {
    value.abs() <= 1e290
}

/// Returns the number of decimals that distinguishes neighbouring ticks.
fn decimals(range: &Range<f64>, ticks: usize) -> usize {
    let points = RangedCoordf64::from(range.clone()).key_points(BoldPoints(ticks));
    let step = points.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    if step.is_finite() && step > 0.0 { (-(step * 1.000_001).log10().floor()).clamp(0.0, 12.0) as usize } else { 3 }
}

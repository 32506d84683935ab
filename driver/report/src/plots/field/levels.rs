//! The levels between the colours of a contour picture, and their numbers.

use super::super::axis::exponent;
use super::super::quantity::Quantity;
use pullout_run::number::{signed, significant};

/// Largest number of colours, without the two ends.
const MOST_BANDS: f64 = 13.0;

/// Bands of values: below the first level, between two, above the last.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Levels {
    /// Beginning of the first band, and end of the last.
    pub range: (f64, f64),
    /// Round numbers strictly inside the range, ascending.
    pub between: Vec<f64>,
    /// Name and unit, with the power of ten that the numbers are divided by.
    pub label: String,
    scale: f64,
    decimals: usize,
}

impl Levels {
    /// Makes levels for values between two finite numbers, the second not less than the first.
    pub fn new(quantity: &Quantity, (least, greatest): (f64, f64)) -> Self {
        let largest = least.abs().max(greatest.abs());
        let exponent = if largest > 1e-290 { exponent(largest) } else { 0 };
        let scale = 10f64.powi(exponent);
        let (start, end) = (least / scale, greatest / scale);
        let span = end - start;
        let mut between = Vec::new();
        let mut decimals = 0;
        // what rounding leaves of a constant is one band
        if span > 1e-9 * (largest / scale) && largest > 1e-290 {
            let step = round_step(span / MOST_BANDS);
            decimals = (2 - (step * 1.000_001).log10().floor() as i32).max(0) as usize;
            while decimals > 0 && is_round(step, decimals - 1) {
                decimals -= 1;
            }
            let (first, last) = ((start / step).floor() as i64, (end / step).ceil() as i64);
            let margin = 1e-6 * step;
            let levels = (first..=last).map(|k| k as f64 * step);
            between = levels.filter(|&level| level > start + margin && level < end - margin).collect();
        }
        let between = between.into_iter().map(|level| level * scale).collect();
        Self { range: (least, greatest), between, label: quantity.label(exponent), scale, decimals }
    }

    /// Returns the number of bands.
    pub fn count(&self) -> usize {
        self.between.len() + 1
    }

    /// The values that a band begins and ends with.
    pub fn band(&self, index: usize) -> (f64, f64) {
        let start = if index == 0 { self.range.0 } else { self.between[index - 1] };
        (start, self.between.get(index).copied().unwrap_or(self.range.1))
    }

    /// Text of a level.
    pub fn text(&self, level: f64) -> String {
        let scaled = level / self.scale;
        let scaled = if scaled.abs() < 1e-9 { 0.0 } else { scaled };
        signed(format!("{scaled:.*}", self.decimals))
    }

    /// Text of an end of the range: one digit more than a level has.
    pub fn end_text(&self, value: f64) -> String {
        let scaled = value / self.scale;
        if self.between.is_empty() {
            return significant(scaled, 4);
        }
        let unit = 10f64.powi(self.decimals as i32 + 1);
        // only the digits that are shown; no "−0"
        significant((scaled * unit).round() / unit + 0.0, 12)
    }
}

/// The least of 1, 2, 2.5, 5 times a power of ten that is not less.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let factors = [1.0, 2.0, 2.5, 5.0, 10.0];
    power * factors.into_iter().find(|factor| factor * power >= least * (1.0 - 1e-9)).unwrap_or(10.0)
}

fn is_round(step: f64, decimals: usize) -> bool {
    let shifted = step * 10f64.powi(decimals as i32);
    (shifted - shifted.round()).abs() < 1e-6 * shifted
}

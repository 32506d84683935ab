//! The distance of a run from a measured curve.
//!
//! RMS of history y − file y at the file's (scaled) x, the history interpolated linearly on the **first monotone
//! branch** of its x: from the initial state until x turns back. Points of the file outside that branch are not
//! compared; they are counted.

use super::history::History;
use crate::path::program::Compare;
use serde::{Deserialize, Serialize};

#[cfg(test)]
mod test;

/// Reversals smaller than this part of x's range are iteration noise, not a branch's end; a point of the file as
/// little outside the branch still belongs to it (scaling rounds).
const NOISE: f64 = 1e-9;

/// What came out for one file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// As the case names it.
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
}

/// Compares a history with a curve.
pub fn compare(history: &History, curve: &Compare) -> Comparison {
    let x = history.column_at(curve.x).unwrap_or_default();
    let y = history.column_at(curve.y).unwrap_or_default();
    let branch = Branch::first(x, y);
    let mut points = 0;
    let mut squares = 0.0;
    for (file_x, file_y) in curve.points.iter().map(|(x, y)| (x * curve.scale_x, y * curve.scale_y)) {
        if let Some(value) = branch.at(file_x)
            && (value - file_y).is_finite()
        {
            points += 1;
            squares += (value - file_y).powi(2);
        }
    }
    let name = |index: usize| history.columns().get(index).cloned().unwrap_or_default();
    Comparison {
        file: curve.file.clone(),
        rms: (points > 0).then(|| (squares / points as f64).sqrt()),
        points,
        outside: curve.points.len() - points,
        x: name(curve.x),
        y: name(curve.y),
    }
}

/// The first stretch over which x does not turn back; x times `direction` does not decrease.
pub(crate) struct Branch<'a> {
    direction: f64,
    /// direction · x, noise removed: never decreasing.
    x: Vec<f64>,
    y: &'a [f64],
    noise: f64,
}

impl<'a> Branch<'a> {
    pub(crate) fn first(x: &[f64], y: &'a [f64]) -> Self {
        let end = x.iter().position(|value| !value.is_finite()).unwrap_or(x.len());
        let x = &x[..end];
        let (least, greatest) = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &v| (a.min(v), b.max(v)));
        let noise = NOISE * (greatest - least).max(0.0);
        let start = x.first().copied().unwrap_or(0.0);
        let departure = x.iter().find(|&value| (value - start).abs() > noise).unwrap_or(&start);
        let direction = if *departure < start { -1.0 } else { 1.0 };
        let mut branch = Vec::new();
        let mut furthest = f64::NEG_INFINITY;
        for value in x.iter().map(|value| direction * value) {
            if value < furthest - noise {
                break;
            }
            furthest = value.max(furthest);
            branch.push(furthest);
        }
        Self { direction, x: branch, y, noise }
    }

    /// y at x; `None` outside the branch. Where x stands still, the first y counts.
    pub(crate) fn at(&self, x: f64) -> Option<f64> {
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

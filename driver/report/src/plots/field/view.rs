//! Part of the plane that a picture shows, to equal scales.

use super::super::figure::UNIT;
use super::Window;
use super::region::GridPoint;
use crate::extremes;
use std::ops::Range;

/// Widths and heights of the plot, px.
const WIDTH: Range<f64> = 160.0..460.0;
const HEIGHT: Range<f64> = 170.0..560.0;
/// Free space around the body, as a part of its larger side.
const MARGIN: f64 = 0.04;

/// A window with the place where it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct View {
    pub x: Range<f64>,
    pub y: Range<f64>,
    /// Drawing units per mm.
    scale: f64,
    /// Upper left corner.
    pub corner: GridPoint,
}

impl View {
    /// The window, widened in one direction if the plot would be too flat or too narrow.
    pub fn new(window: &Window) -> Self {
        let (width, height) = (window.x.end - window.x.start, window.y.end - window.y.start);
        let pixels = (WIDTH.end / width).min(HEIGHT.end / height);
        let widened = |range: &Range<f64>, least: f64| {
            let spare = 0.5 * (least / pixels - (range.end - range.start)).max(0.0);
            range.start - spare..range.end + spare
        };
        let (x, y) = (widened(&window.x, WIDTH.start), widened(&window.y, HEIGHT.start));
        Self { x, y, scale: pixels * f64::from(UNIT), corner: (0, 0) }
    }

    /// Returns the view with its upper left corner here.
    pub fn at(self, corner: GridPoint) -> Self {
        Self { corner, ..self }
    }

    /// Width and height of the plot, px.
    pub fn size(&self) -> (i32, i32) {
        let side = |range: &Range<f64>| self.pixels(range.end - range.start).round() as i32;
        (side(&self.x), side(&self.y))
    }

    /// A length in px.
    pub fn pixels(&self, length: f64) -> f64 {
        length * self.scale / f64::from(UNIT)
    }

    /// Returns where a position is drawn; what is far outside stays far outside.
    pub fn place(&self, [x, y]: [f64; 2]) -> GridPoint {
        const FAR: f64 = 1e8;
        let unit = |value: f64| (value * self.scale).clamp(-FAR, FAR).round() as i32;
        (self.corner.0 + unit(x - self.x.start), self.corner.1 + unit(self.y.end - y))
    }

    /// Returns whether the box around positions, all finite, overlaps the window.
    pub fn shows(&self, positions: impl Iterator<Item = [f64; 2]> + Clone) -> bool {
        let overlaps = |k: usize, range: &Range<f64>| {
            let values = || positions.clone().map(|position| position[k]);
            values().all(f64::is_finite) && values().any(|v| v >= range.start) && values().any(|v| v <= range.end)
        };
        overlaps(0, &self.x) && overlaps(1, &self.y)
    }
}

impl Window {
    /// Around positions, with some space; `None` if none is finite or all are one.
    pub fn around(positions: &[[f64; 2]]) -> Option<Self> {
        let range = |k: usize| extremes(positions.iter().filter(|p| p.iter().all(|c| c.is_finite())).map(|p| p[k]));
        let (x, y) = (range(0), range(1));
        let side = (x.1 - x.0).max(y.1 - y.0);
        let spare = MARGIN * side;
        let window = Self { x: x.0 - spare..x.1 + spare, y: y.0 - spare..y.1 + spare };
        (side > 0.0 && side < 1e290).then_some(window)
    }

    /// Returns whether it has a width and a height.
    pub(super) fn is_proper(&self) -> bool {
        let proper = |range: &Range<f64>| {
            let span = range.end - range.start;
            span.is_finite() && span > 1e-9 * range.start.abs().max(range.end.abs())
        };
        proper(&self.x) && proper(&self.y)
    }
}

//! Draws the legend in a corner where nothing is drawn, or below the picture.

use super::axis::Axis;
use super::figure::{CHARACTER, Corners, Drawn, Root, Style, UNIT, WIDTH, draw_mark, left_aligned, shade};
use super::markup;
use plotters::prelude::*;

const TEXT_SIZE: i32 = 13;
const LINE_HEIGHT: i32 = 19;
/// Length of a line's sample, px.
const SAMPLE: i32 = 30;
const PADDING: i32 = 8;
/// Distance from the frame, px.
const OFFSET: i32 = 10;
/// About what remains of the picture's width and height for the plot, px: decides whether a corner is free.
const PLOT: (f64, f64) = (540.0, 370.0);
/// Width for a legend below, px.
const BELOW: i32 = WIDTH - 80;

/// Mark in front of a label.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sample {
    /// A line of this style.
    Line(Style),
    /// A line of this style with the mark of its colour's number.
    MarkedLine(Style),
    /// The mark of this number.
    Mark(usize),
    /// A bar.
    Bar,
    /// Shades from the first to the last.
    Shades,
}

#[derive(Clone, Debug)]
pub(super) struct LegendEntry {
    pub sample: Sample,
    pub color: RGBColor,
    pub label: String,
}

/// A corner of the plot: whether it is on the right side, and on the lower side.
pub(super) type Corner = (bool, bool);

#[derive(Clone, Debug)]
pub(super) struct Legend {
    entries: Vec<LegendEntry>,
    /// Corner in which it stands; `None`: below the picture.
    corner: Option<Corner>,
}

impl Legend {
    /// Looks for a corner that is free of lines and points.
    pub fn place(entries: Vec<LegendEntry>, drawn: &[Vec<(f64, f64)>], x: &Axis, y: &Axis) -> Self {
        let legend = Self { entries, corner: None };
        Self { corner: free_corner(legend.size(), drawn, x, y), ..legend }
    }

    /// Returns what it needs below the picture, px.
    pub fn height_below(&self) -> i32 {
        if self.corner.is_none() && !self.entries.is_empty() { Self::height(self.rows()) } else { 0 }
    }

    /// Returns the rows of a column: all in a corner, as few as there is room for below.
    fn rows(&self) -> usize {
        let columns = if self.corner.is_none() { (BELOW / self.size().0).max(1) as usize } else { 1 };
        self.entries.len().div_ceil(columns)
    }

    fn height(rows: usize) -> i32 {
        2 * PADDING + LINE_HEIGHT * rows as i32 - 4
    }

    fn size(&self) -> (i32, i32) {
        let longest = self.entries.iter().map(|entry| markup::length(&entry.label)).max().unwrap_or(0);
        let text = (longest as f64 * CHARACTER * f64::from(TEXT_SIZE)) as i32;
        (2 * PADDING + SAMPLE + 8 + text, Self::height(self.entries.len()))
    }

    /// Draws it; `plot`: the frame of the plot.
    pub fn draw<'a>(&self, root: &Root<'a>, plot: Corners<i32>) -> Drawn<'a, ()> {
        if self.entries.is_empty() {
            return Ok(());
        }
        let size = self.size();
        let (left, top) = match self.corner {
            Some(corner) => {
                let place = in_corner(corner, plot, size);
                root.draw(&Rectangle::new(place, WHITE.mix(0.85).filled()))?;
                place[0]
            }
            None => (plot[0].0, plot[1].1 + 52 * UNIT),
        };
        let rows = self.rows();
        for (k, entry) in self.entries.iter().enumerate() {
            let y = top + (PADDING + LINE_HEIGHT * (k % rows) as i32 + LINE_HEIGHT / 2 - 2) * UNIT;
            let x = left + PADDING * UNIT + (k / rows) as i32 * size.0 * UNIT;
            let half = LINE_HEIGHT / 3 * UNIT;
            let bar = |start: i32, end: i32, color: RGBColor| {
                Rectangle::new([(x + start * UNIT, y - half), (x + end * UNIT, y + half)], color.filled())
            };
            if let Sample::Line(style) | Sample::MarkedLine(style) = entry.sample {
                root.draw(&PathElement::new(vec![(x, y), (x + SAMPLE * UNIT, y)], style.pen(entry.color)))?;
            }
            match entry.sample {
                Sample::Line(_) => {}
                Sample::Mark(shape) | Sample::MarkedLine(Style { color: shape, .. }) => {
                    draw_mark(root, shape, (x + SAMPLE * UNIT / 2, y), entry.color)?;
                }
                Sample::Bar => root.draw(&bar(0, SAMPLE, entry.color))?,
                Sample::Shades => {
                    for k in 0..SAMPLE {
                        root.draw(&bar(k, k + 1, shade(k as usize, SAMPLE as usize)))?;
                    }
                }
            }
            root.draw(&Text::new(entry.label.clone(), (x + (SAMPLE + 8) * UNIT, y), left_aligned(TEXT_SIZE)))?;
        }
        Ok(())
    }
}

/// Returns the place in a corner of a plot of what has this width and height, px.
pub(super) fn in_corner(
    (on_right, is_lower): Corner,
    [(left, top), (right, bottom)]: Corners<i32>,
    (width, height): (i32, i32),
) -> Corners<i32> {
    let (width, height, offset) = (width * UNIT, height * UNIT, OFFSET * UNIT);
    let x = if on_right { right - offset - width } else { left + offset };
    let y = if is_lower { bottom - offset - height } else { top + offset };
    [(x, y), (x + width, y + height)]
}

/// Returns the part of a plot along x and y that this width and height, px, take with the distance from the frame.
pub(super) fn part_of_plot((width, height): (i32, i32)) -> (f64, f64) {
    (f64::from(width + 2 * OFFSET) / PLOT.0, f64::from(height + 2 * OFFSET) / PLOT.1)
}

/// Looks for a corner with room for so many px, free of what is drawn.
pub(super) fn free_corner(size: (i32, i32), drawn: &[Vec<(f64, f64)>], x: &Axis, y: &Axis) -> Option<Corner> {
    let part = part_of_plot(size);
    let free = |&(right, lower): &Corner| {
        let inside = |(across, up): (f64, f64)| {
            (if right { across > 1.0 - part.0 } else { across < part.0 })
                && (if lower { up < part.1 } else { up > 1.0 - part.1 })
        };
        let passes = |stretch: &Vec<(f64, f64)>| {
            let places: Vec<_> = stretch.iter().map(|&(a, b)| (x.position(a), y.position(b))).collect();
            places.windows(2).any(|ends| along(ends[0], ends[1]).any(inside)) || places.iter().any(|&p| inside(p))
        };
        part.0 < 0.9 && part.1 < 0.6 && !drawn.iter().any(passes)
    };
    [(true, false), (false, false), (true, true), (false, true)].into_iter().find(free)
}

/// Places along a straight stretch, one about every hundredth of the picture.
fn along(start: (f64, f64), end: (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
    let steps = (100.0 * (end.0 - start.0).abs().max((end.1 - start.1).abs())).clamp(1.0, 200.0) as i32;
    (0..=steps).map(move |k| {
        let weight = f64::from(k) / f64::from(steps);
        (start.0 + weight * (end.0 - start.0), start.1 + weight * (end.1 - start.1))
    })
}

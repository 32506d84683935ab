//! The legend: in a corner where nothing is drawn, else below the picture.

use super::axis::Axis;
use super::figure::{CHARACTER, Drawn, Root, Style, UNIT, WIDTH, draw_mark, font, shade};
use super::markup;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const TEXT_SIZE: i32 = 13;
const LINE_HEIGHT: i32 = 19;
/// Length of a line's sample, px.
const SAMPLE: i32 = 30;
const PADDING: i32 = 8;
/// Distance from the frame, px.
pub(super) const OFFSET: i32 = 10;
/// About what remains of the picture's width and height for the plot, px: decides whether a corner is free.
pub(super) const PLOT: (f64, f64) = (540.0, 370.0);
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
pub(super) struct Entry {
    pub sample: Sample,
    pub color: RGBColor,
    pub label: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LegendPosition {
    /// Right side, lower side.
    Corner(bool, bool),
    Below,
}

#[derive(Clone, Debug)]
pub(super) struct Legend {
    entries: Vec<Entry>,
    position: LegendPosition,
}

impl Legend {
    /// Looks for a corner that is free of lines and points.
    pub fn place(entries: Vec<Entry>, drawn: &[Vec<(f64, f64)>], x: &Axis, y: &Axis) -> Self {
        let mut legend = Self { entries, position: LegendPosition::Below };
        if let Some((right, lower)) = free_corner(legend.size(), drawn, x, y) {
            legend.position = LegendPosition::Corner(right, lower);
        }
        legend
    }

    /// Returns what it needs below the picture, px.
    pub fn height_below(&self) -> i32 {
        if self.position == LegendPosition::Below && !self.entries.is_empty() { Self::height(self.rows()) } else { 0 }
    }

    /// Returns the rows of a column: all in a corner, as few as there is room for below.
    fn rows(&self) -> usize {
        let columns = if self.position == LegendPosition::Below { (BELOW / self.size().0).max(1) as usize } else { 1 };
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

    /// Draws it; `frame`: upper left and lower right corner of the plot.
    pub fn draw<'a>(&self, root: &Root<'a>, frame: ((i32, i32), (i32, i32))) -> Drawn<'a, ()> {
        if self.entries.is_empty() {
            return Ok(());
        }
        let (width, height) = (self.size().0 * UNIT, self.size().1 * UNIT);
        let ((left, top), (right, bottom)) = frame;
        let offset = OFFSET * UNIT;
        let corner = match self.position {
            LegendPosition::Corner(on_right, lower) => {
                let x = if on_right { right - offset - width } else { left + offset };
                (x, if lower { bottom - offset - height } else { top + offset })
            }
            LegendPosition::Below => (left, bottom + 52 * UNIT),
        };
        if self.position != LegendPosition::Below {
            let opposite = (corner.0 + width, corner.1 + height);
            root.draw(&Rectangle::new([corner, opposite], WHITE.mix(0.85).filled()))?;
        }
        let rows = self.rows();
        for (k, entry) in self.entries.iter().enumerate() {
            let y = corner.1 + (PADDING + LINE_HEIGHT * (k % rows) as i32 + LINE_HEIGHT / 2 - 2) * UNIT;
            let x = corner.0 + PADDING * UNIT + (k / rows) as i32 * width;
            match entry.sample {
                Sample::Line(style) => {
                    root.draw(&PathElement::new(vec![(x, y), (x + SAMPLE * UNIT, y)], style.pen(entry.color)))?;
                }
                Sample::MarkedLine(style) => {
                    root.draw(&PathElement::new(vec![(x, y), (x + SAMPLE * UNIT, y)], style.pen(entry.color)))?;
                    draw_mark(root, style.color, (x + SAMPLE * UNIT / 2, y), entry.color)?;
                }
                Sample::Bar => {
                    let half = LINE_HEIGHT / 3 * UNIT;
                    let corners = [(x, y - half), (x + SAMPLE * UNIT, y + half)];
                    root.draw(&Rectangle::new(corners, entry.color.filled()))?;
                }
                Sample::Shades => {
                    let half = LINE_HEIGHT / 3 * UNIT;
                    for k in 0..SAMPLE {
                        let (left, right) = (x + k * UNIT, x + (k + 1) * UNIT);
                        let color = shade(k as usize, SAMPLE as usize).filled();
                        root.draw(&Rectangle::new([(left, y - half), (right, y + half)], color))?;
                    }
                }
                Sample::Mark(shape) => draw_mark(root, shape, (x + SAMPLE * UNIT / 2, y), entry.color)?,
            }
            let style = font(TEXT_SIZE).pos(Pos::new(HPos::Left, VPos::Center));
            root.draw(&Text::new(entry.label.clone(), (x + (SAMPLE + 8) * UNIT, y), style))?;
        }
        Ok(())
    }
}

/// Looks for a corner (right side, lower side) with room for so many px, free of what is drawn.
pub(super) fn free_corner(
    (width, height): (i32, i32),
    drawn: &[Vec<(f64, f64)>],
    x: &Axis,
    y: &Axis,
) -> Option<(bool, bool)> {
    let part = (f64::from(width + 2 * OFFSET) / PLOT.0, f64::from(height + 2 * OFFSET) / PLOT.1);
    let free = |&(right, lower): &(bool, bool)| {
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

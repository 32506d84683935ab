//! An inset: a spike that is too narrow to be seen in the whole picture, drawn again in a free corner.

use super::axis::Axis;
use super::decimation::{MOST_POINTS, decimate, drawable_stretches};
use super::figure::{Drawn, Figure, GRID, INK, Root, UNIT, ZERO, bounds, draw_mark, font};
use super::legend::{OFFSET, PLOT, free_corner};
use plotters::prelude::*;
use std::ops::RangeInclusive;

/// Width and height, px.
const SIZE: (i32, i32) = (250, 180);
const TEXT_SIZE: i32 = 11;
const TICKS: usize = 4;
/// A spike stands above three quarters of its height along less than this part of what the picture shows along x.
const NARROW: f64 = 0.03;
/// Narrower windows, relative to the greatest abscissa, have no numbers that tell their ticks apart.
const LEAST_WIDTH: f64 = 1e-6;
/// Fewer points up there are no spike to look at.
const FEWEST: usize = 6;
/// Margin before and after the spike, in widths of it.
const AROUND: (f64, f64) = (1.5, 3.0);

/// A part of a picture, enlarged.
#[derive(Clone, Debug)]
pub(super) struct Inset {
    window: RangeInclusive<f64>,
    x: Axis,
    y: Axis,
    /// Right side, lower side.
    corner: (bool, bool),
}

impl Inset {
    /// Looks for spikes, and for a corner that is free of what is drawn.
    pub fn place(figure: &Figure, drawn: &[Vec<(f64, f64)>], (x, y): (&Axis, &Axis)) -> Option<Self> {
        let curves = || figure.lines.iter().filter(|line| !line.marked).map(|line| line.points.as_slice());
        let (least, greatest) = bounds(curves().flatten().map(|point| point.0));
        let span = greatest - least;
        let spikes = curves().filter_map(|points| spike(points, NARROW * span));
        let (start, end) = spikes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        let window = start.max(least)..=end.min(greatest);
        let width = window.end() - window.start();
        // a jump at one abscissa stays one line however large it is drawn
        let least_width = LEAST_WIDTH * least.abs().max(greatest.abs());
        if !(least_width..=AROUND.1 * 2.0 * NARROW * span).contains(&width) || width == 0.0 {
            return None;
        }
        let shown = curves().flat_map(|points| clipped(points, &window)).flatten().map(|point| point.1);
        let across = Axis::exact(&figure.x, *window.start()..*window.end(), TICKS);
        let up = Axis::new(&figure.y, bounds(shown), 0.0, TICKS);
        Some(Self { window, x: across, y: up, corner: free_corner(SIZE, drawn, x, y)? })
    }

    /// The outline of the corner that it takes, in the numbers of the picture's axes.
    pub fn outline(&self, x: &Axis, y: &Axis) -> Vec<(f64, f64)> {
        let part = (f64::from(SIZE.0 + 2 * OFFSET) / PLOT.0, f64::from(SIZE.1 + 2 * OFFSET) / PLOT.1);
        let at = |(across, up): (f64, f64)| {
            let across = if self.corner.0 { 1.0 - across } else { across };
            let up = if self.corner.1 { up } else { 1.0 - up };
            let along = |axis: &Axis, position: f64| axis.range.start + position * (axis.range.end - axis.range.start);
            (along(x, across), along(y, up))
        };
        [(0.0, 0.0), (part.0, 0.0), part, (0.0, part.1), (0.0, 0.0)].map(at).to_vec()
    }

    /// Draws it, and a frame around what it enlarges; `corners`: upper left and lower right corner of the plot.
    pub fn draw<'a>(
        &self,
        figure: &Figure,
        root: &Root<'a>,
        (left, top, right, bottom): (i32, i32, i32, i32),
        (x, y): (&Axis, &Axis),
    ) -> Drawn<'a, ()> {
        let thin = |color: RGBColor| color.stroke_width(UNIT as u32);
        let enlarged =
            |axis: &Axis, of: &Axis, value: f64| axis.position(value * of.scale / axis.scale).clamp(0.0, 1.0);
        let across = |value| left + (enlarged(x, &self.x, value) * f64::from(right - left)) as i32;
        let up = |value| bottom - (enlarged(y, &self.y, value) * f64::from(bottom - top)) as i32;
        let corners =
            [(across(self.x.range.start), up(self.y.range.end)), (across(self.x.range.end), up(self.y.range.start))];
        root.draw(&frame(corners, thin(ZERO)))?;
        let (width, height, offset) = (SIZE.0 * UNIT, SIZE.1 * UNIT, OFFSET * UNIT);
        let place = (
            if self.corner.0 { right - offset - width } else { left + offset },
            if self.corner.1 { bottom - offset - height } else { top + offset },
        );
        let area = root.clone().shrink(place, (width, height));
        area.fill(&WHITE)?;
        let room = |label: &str, of_picture: &str| if label == of_picture { 0 } else { 16 };
        let labels = (room(&self.x.label, &x.label), room(&self.y.label, &y.label));
        let widest = self.y.ticks().iter().map(|&tick| self.y.text(tick).chars().count()).max().unwrap_or(1) as i32;
        let mut chart = ChartBuilder::on(&area)
            .margin(6 * UNIT)
            .set_label_area_size(LabelAreaPosition::Left, (7 * widest + 10 + labels.1) * UNIT)
            .set_label_area_size(LabelAreaPosition::Bottom, (20 + labels.0) * UNIT)
            .build_cartesian_2d(self.x.range.clone(), self.y.range.clone())?;
        let label = |axis: &Axis, room: i32| if room == 0 { String::new() } else { axis.label.clone() };
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(thin(GRID))
            .axis_style(thin(INK))
            .set_all_tick_mark_size(3 * UNIT)
            .x_labels(TICKS)
            .y_labels(TICKS)
            .x_label_formatter(&|value| self.x.text(*value))
            .y_label_formatter(&|value| self.y.text(*value))
            .label_style(font(TEXT_SIZE))
            .axis_desc_style(font(TEXT_SIZE))
            .x_desc(label(&self.x, labels.0))
            .y_desc(label(&self.y, labels.1))
            .draw()?;
        let plot = chart.plotting_area();
        let scaled = |&(across, up): &(f64, f64)| (self.x.scaled(across), self.y.scaled(up));
        for line in figure.lines.iter().filter(|line| !line.marked) {
            for piece in clipped(&line.points, &self.window) {
                let points = decimate(&piece, MOST_POINTS).iter().map(scaled).collect::<Vec<_>>();
                plot.draw(&PathElement::new(points, line.style.pen(figure.color(line.style))))?;
            }
        }
        for (k, marks) in figure.marks.iter().enumerate() {
            let (within_x, within_y) = (&self.x.range, &self.y.range);
            let points = drawable_stretches(&marks.points).flatten().map(scaled);
            for point in points.filter(|point| within_x.contains(&point.0) && within_y.contains(&point.1)) {
                draw_mark(root, k, plot.map_coordinate(&point), figure.mark_color(marks))?;
            }
        }
        root.draw(&frame([place, (place.0 + width, place.1 + height)], thin(ZERO)))?;
        Ok(())
    }
}

/// The outline of a rectangle. (The SVG of plotters' own has no stroke width.)
fn frame([(left, top), (right, bottom)]: [(i32, i32); 2], style: ShapeStyle) -> PathElement<(i32, i32)> {
    PathElement::new([(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], style)
}

/// Returns the abscissae to be shown around a curve's greatest ordinate, if that is a spike narrower than `width`.
fn spike(points: &[(f64, f64)], width: f64) -> Option<(f64, f64)> {
    let points: Vec<(f64, f64)> = drawable_stretches(points).flatten().copied().collect();
    let peak = (0..points.len()).max_by(|&a, &b| points[a].1.abs().total_cmp(&points[b].1.abs()))?;
    let is_high = |k: &usize| points[*k].1.abs() >= 0.75 * points[peak].1.abs();
    let first = (0..=peak).rev().take_while(is_high).last()?;
    let last = (peak..points.len()).take_while(is_high).last()?;
    let (start, end) = bounds(points[first..=last].iter().map(|point| point.0));
    let falls = first > 0 || last + 1 < points.len();
    let is_spike = falls && points[peak].1 != 0.0 && last + 1 - first >= FEWEST && end - start < width;
    is_spike.then_some((start - AROUND.0 * (end - start), end + AROUND.1 * (end - start)))
}

/// The pieces of a curve within a range of abscissae, cut at its ends.
fn clipped(points: &[(f64, f64)], window: &RangeInclusive<f64>) -> Vec<Vec<(f64, f64)>> {
    let (from, to) = (*window.start(), *window.end());
    let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
    for stretch in drawable_stretches(points) {
        let mut is_going_on = false;
        for ends in stretch.windows(2) {
            let (a, b) = (ends[0], ends[1]);
            if a.0.max(b.0) < from || a.0.min(b.0) > to {
                is_going_on = false;
                continue;
            }
            let cut = |point: (f64, f64)| {
                let x = point.0.clamp(from, to);
                if x == point.0 { point } else { (x, a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0)) }
            };
            match pieces.last_mut().filter(|_| is_going_on) {
                Some(piece) => piece.push(cut(b)),
                None => pieces.push(vec![cut(a), cut(b)]),
            }
            is_going_on = window.contains(&b.0);
        }
    }
    pieces
}

#[cfg(test)]
mod test;

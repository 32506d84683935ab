//! An inset: a spike that is too narrow to be seen in the whole picture, drawn again in a free corner.

use super::axis::Axis;
use super::decimation::{MOST_POINTS, decimate, drawable_stretches};
use super::figure::{AxisSizes, Corners, Drawn, Figure, Root, UNIT, ZERO, bounds, draw_axes, draw_mark, outline};
use super::legend::{Corner, free_corner, in_corner, part_of_plot};
use plotters::prelude::*;
use std::ops::RangeInclusive;

/// Width and height, px.
const SIZE: (i32, i32) = (250, 180);
const AXIS_SIZES: AxisSizes = AxisSizes { marks: 3, numbers: 11, names: 11 };
const TICKS: usize = 4;
/// A spike stands above three quarters of its height along less than this part of what the picture shows along x.
const NARROW: f64 = 0.03;
/// Smallest width of a window, relative to the greatest abscissa. The numbers at the ticks of a narrower one would be equal.
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
    corner: Corner,
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
        // what the picture's own axes say is not said again
        let named = |mut axis: Axis, of_picture: &Axis| {
            if axis.label == of_picture.label {
                axis.label.clear();
            }
            axis
        };
        Some(Self { window, x: named(across, x), y: named(up, y), corner: free_corner(SIZE, drawn, x, y)? })
    }

    /// The outline of the corner that it takes, in the numbers of the picture's axes.
    pub fn outline(&self, x: &Axis, y: &Axis) -> Vec<(f64, f64)> {
        let part = part_of_plot(SIZE);
        let at = |(across, up): (f64, f64)| {
            let across = if self.corner.0 { 1.0 - across } else { across };
            let up = if self.corner.1 { up } else { 1.0 - up };
            let along = |axis: &Axis, position: f64| axis.range.start + position * (axis.range.end - axis.range.start);
            (along(x, across), along(y, up))
        };
        [(0.0, 0.0), (part.0, 0.0), part, (0.0, part.1), (0.0, 0.0)].map(at).to_vec()
    }

    /// Draws it, and a frame around what it enlarges; `plot`: the frame of the whole plot.
    pub fn draw<'a>(
        &self,
        figure: &Figure,
        root: &Root<'a>,
        plot: Corners<i32>,
        (x, y): (&Axis, &Axis),
    ) -> Drawn<'a, ()> {
        let [(left, top), (right, bottom)] = plot;
        let enlarged =
            |axis: &Axis, of: &Axis, value: f64| axis.position(value * of.scale / axis.scale).clamp(0.0, 1.0);
        let across = |value| left + (enlarged(x, &self.x, value) * f64::from(right - left)) as i32;
        let up = |value| bottom - (enlarged(y, &self.y, value) * f64::from(bottom - top)) as i32;
        let corners =
            [(across(self.x.range.start), up(self.y.range.end)), (across(self.x.range.end), up(self.y.range.start))];
        root.draw(&outline(corners, ZERO))?;
        let frame = in_corner(self.corner, plot, SIZE);
        let area = root.clone().shrink(frame[0], (SIZE.0 * UNIT, SIZE.1 * UNIT));
        area.fill(&WHITE)?;
        let room = |axis: &Axis| if axis.label.is_empty() { 0 } else { 16 };
        let mut chart = ChartBuilder::on(&area)
            .margin(6 * UNIT)
            .set_label_area_size(LabelAreaPosition::Left, (7 * self.y.widest() as i32 + 10 + room(&self.y)) * UNIT)
            .set_label_area_size(LabelAreaPosition::Bottom, (20 + room(&self.x)) * UNIT)
            .build_cartesian_2d(self.x.range.clone(), self.y.range.clone())?;
        draw_axes(&mut chart, (&self.x, &self.y), true, AXIS_SIZES)?;
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
        root.draw(&outline(frame, ZERO))?;
        Ok(())
    }
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

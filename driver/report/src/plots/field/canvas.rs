//! Title, frame, axes and what stands to the right of the plot: a colour bar, or what colours mean.

use super::super::axis::Axis;
use super::super::figure::{
    AxisSizes, Drawn, INK, LABEL_SIZE, PALETTE, Root, TICK_SIZE, UNIT, centered, draw_axes, draw_title, finish,
    left_aligned, left_of, outline, pixels, text_width, thin, wrapped,
};
use super::super::guarded;
use super::super::markup;
use super::super::quantity::Quantity;
use super::PictureError;
use super::levels::Levels;
use super::view::View;
use plotters::prelude::*;

/// Colour of elements without a value.
pub(super) const NO_VALUE: &str = "#d9d9d9";

/// Distance of the bar from the plot, its width, and of its numbers from it, px.
const BAR_OFFSET: i32 = 16;
const BAR_WIDTH: i32 = 16;
const BAR_TEXT: i32 = 7;
/// Smallest distance between numbers next to the bar, px.
const LINE: f64 = 15.0;

/// Content to the right of the plot.
pub(super) enum Side<'a> {
    /// A colour bar (none if no element has a value), and whether some elements have none.
    Bar { levels: Option<&'a Levels>, missing: bool },
    /// Meaning of the colours.
    Names(&'a [(RGBColor, &'a str)]),
}

/// A picture without the field itself.
pub(super) struct Canvas {
    view: View,
    svg: String,
    size: (i32, i32),
    description: String,
}

impl Canvas {
    /// Draws it.
    ///
    /// # Errors
    /// The picture cannot be drawn.
    pub fn new(title: &str, note: &str, view: View, side: &Side<'_>) -> Result<Self, PictureError> {
        guarded(|| Self::draw(title, note, view, side)).map_err(PictureError::Wrong)
    }

    fn draw(title: &str, note: &str, view: View, side: &Side<'_>) -> Result<Self, String> {
        let plot = view.size();
        let coordinate = |name: &str| Quantity { name: name.into(), unit: "mm".into() };
        let x = Axis::exact(&coordinate("x"), view.x.clone(), (plot.0 / 55).max(4) as usize);
        let y = Axis::exact(&coordinate("y"), view.y.clone(), (plot.1 / 40).max(4) as usize);
        let left = left_of(&y);
        let width = 10 + left + plot.0 + side.width();
        let lines = wrapped(title, width);
        let top = 12 + 20 * lines.len() as i32 + if note.is_empty() { 0 } else { 18 };
        let size = (width, top + plot.1 + 46 + 8);
        let mut svg = String::new();
        let corner = {
            let root = SVGBackend::with_string(&mut svg, pixels(size)).into_drawing_area();
            let draw = || -> Drawn<'_, (i32, i32)> {
                root.fill(&WHITE)?;
                draw_title(&root, &lines, width)?;
                if !note.is_empty() {
                    let place = (width / 2 * UNIT, (16 + 20 * lines.len() as i32) * UNIT);
                    root.draw(&Text::new(note.to_owned(), place, centered(TICK_SIZE)))?;
                }
                let corner = draw_frame(&root, (&x, &y), (left, top), plot)?;
                side.draw(&root, (corner.0 + plot.0 * UNIT, corner.1), plot.1)?;
                root.present()?;
                Ok(corner)
            };
            draw().map_err(|error| error.to_string())?
        };
        let description = format!("{title} {note} {}", side.description());
        Ok(Self { view: view.at(corner), svg, size, description })
    }

    /// The view, which now knows where it is drawn.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The picture with the field, which is cut at the frame and lies below it.
    pub fn finish(self, body: &str) -> String {
        let ((x, y), (width, height)) = (self.view.corner, pixels(self.view.size()));
        let clipped = format!(
            "<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" viewBox=\"{x} {y} {width} {height}\" \
             overflow=\"hidden\">\n{body}</svg>\n"
        );
        // the white background is the first element
        let background = self.svg.find("/>\n").map_or(0, |end| end + 3);
        let (head, frame) = self.svg.split_at(background);
        finish(&format!("{head}{clipped}{frame}"), self.size, &markup::plain(&self.description))
    }
}

/// Draws frame, ticks and names of the axes of a plot with so much room above and to the left, px; its upper left corner.
fn draw_frame<'a>(
    root: &Root<'a>,
    (x, y): (&Axis, &Axis),
    (left, top): (i32, i32),
    plot: (i32, i32),
) -> Drawn<'a, (i32, i32)> {
    let (width, height) = pixels((10 + left + plot.0, top + plot.1 + 46));
    let (chart_area, _) = root.split_horizontally(width as i32);
    let (chart_area, _) = chart_area.split_vertically(height as i32);
    let mut chart = ChartBuilder::on(&chart_area)
        .margin_left(10 * UNIT)
        .margin_top(top * UNIT)
        .set_label_area_size(LabelAreaPosition::Left, left * UNIT)
        .set_label_area_size(LabelAreaPosition::Bottom, 46 * UNIT)
        .build_cartesian_2d(x.range.clone(), y.range.clone())?;
    draw_axes(&mut chart, (x, y), false, AxisSizes::OF_PICTURES)?;
    let (across, up) = chart.plotting_area().get_pixel_range();
    root.draw(&outline([(across.start, up.start), (across.end, up.end)], INK))?;
    Ok((across.start, up.start))
}

impl Side<'_> {
    /// Returns the width, px.
    fn width(&self) -> i32 {
        match self {
            Self::Bar { levels, .. } => {
                let numbers = levels.map_or(0, |levels| text_width(TICK_SIZE, levels.widest()));
                BAR_OFFSET + BAR_WIDTH + BAR_TEXT + numbers.max(52) + 30
            }
            Self::Names(parts) => {
                let longest = parts.iter().map(|(_, name)| markup::length(name)).max().unwrap_or(0);
                BAR_OFFSET + BAR_WIDTH + BAR_TEXT + text_width(TICK_SIZE, longest) + 14
            }
        }
    }

    fn description(&self) -> String {
        match self {
            Self::Bar { levels, .. } => levels.map_or_else(String::new, |levels| levels.label.clone()),
            Self::Names(parts) => parts.iter().map(|(_, name)| *name).collect::<Vec<_>>().join(", "),
        }
    }

    /// Draws it next to a plot of this height in px whose upper right corner is given.
    fn draw<'a>(&self, root: &Root<'a>, (x, y): (i32, i32), height: i32) -> Drawn<'a, ()> {
        let left = x + BAR_OFFSET * UNIT;
        match self {
            Self::Names(parts) => {
                for (k, &(color, name)) in parts.iter().enumerate() {
                    let top = y + (4 + 22 * k as i32) * UNIT;
                    draw_swatch(root, (left, top), color, name)?;
                }
            }
            Self::Bar { levels, missing } => {
                let spare = if *missing { 30 } else { 0 };
                if *missing {
                    draw_swatch(root, (left, y + (height - BAR_WIDTH) * UNIT), RGBColor(0xd9, 0xd9, 0xd9), "no value")?;
                }
                if let Some(levels) = levels {
                    levels.draw(root, (left, y), height - spare)?;
                }
            }
        }
        Ok(())
    }
}

/// Draws a square of a colour with a name next to it.
fn draw_swatch<'a>(root: &Root<'a>, (x, y): (i32, i32), color: RGBColor, name: &str) -> Drawn<'a, ()> {
    let side = BAR_WIDTH * UNIT;
    let corners = [(x, y), (x + side, y + side)];
    root.draw(&Rectangle::new(corners, color.filled()))?;
    root.draw(&outline(corners, INK))?;
    root.draw(&Text::new(name.to_owned(), (x + side + BAR_TEXT * UNIT, y + side / 2), left_aligned(TICK_SIZE)))?;
    Ok(())
}

impl Levels {
    /// Returns the number of characters of the longest number next to the bar.
    fn widest(&self) -> usize {
        let ends = [self.range.0, self.range.1].map(|end| self.end_text(end));
        let levels = self.between.iter().map(|&level| self.text(level));
        levels.chain(ends).map(|text| text.chars().count()).max().unwrap_or(1)
    }

    /// The bar, its upper left corner and height in px given.
    fn draw<'a>(&self, root: &Root<'a>, (x, y): (i32, i32), height: i32) -> Drawn<'a, ()> {
        let span = self.range.1 - self.range.0;
        let share = |value: f64| if span > 0.0 { (value - self.range.0) / span } else { 0.0 };
        let up = |share: f64| y + ((1.0 - share) * f64::from(height * UNIT)).round() as i32;
        let right = x + BAR_WIDTH * UNIT;
        for band in 0..self.count() {
            let (start, end) = self.band(band);
            let end = if band + 1 == self.count() { 1.0 } else { share(end) };
            root.draw(&Rectangle::new(
                [(x, up(end)), (right, up(share(start)))],
                band_color(band, self.count()).filled(),
            ))?;
        }
        root.draw(&outline([(x, y), (right, y + height * UNIT)], INK))?;
        let place = |share: f64, text: String| -> Drawn<'a, ()> {
            let tick = vec![(right, up(share)), (right + 4 * UNIT, up(share))];
            root.draw(&PathElement::new(tick, thin(INK)))?;
            root.draw(&Text::new(text, (right + BAR_TEXT * UNIT, up(share)), left_aligned(TICK_SIZE)))?;
            Ok(())
        };
        if self.between.is_empty() {
            place(0.5, self.end_text(0.5 * self.range.0 + 0.5 * self.range.1))?;
        } else {
            place(0.0, self.end_text(self.range.0))?;
            place(1.0, self.end_text(self.range.1))?;
        }
        for level in self.numbered(height) {
            place(share(level), self.text(level))?;
        }
        let label = x + (BAR_WIDTH + BAR_TEXT + text_width(TICK_SIZE, self.widest()) + 16) * UNIT;
        let style = centered(LABEL_SIZE).transform(FontTransform::Rotate270);
        root.draw(&Text::new(self.label.clone(), (label, y + height * UNIT / 2), style))?;
        Ok(())
    }

    /// The levels that have room for a number: away from the ends and from each other.
    pub fn numbered(&self, height: i32) -> Vec<f64> {
        let span = self.range.1 - self.range.0;
        let Some(distance) = self.between.windows(2).map(|pair| pair[1] - pair[0]).reduce(f64::min) else {
            return self.between.clone();
        };
        let pixels = |value: f64| value / span * f64::from(height);
        let step = (LINE / pixels(distance)).ceil().max(1.0);
        // zero and its multiples before others
        let chosen = |level: &f64| (level / distance).round().rem_euclid(step) == 0.0;
        let free = |level: &f64| pixels(level - self.range.0) > LINE && pixels(self.range.1 - level) > LINE;
        self.between.iter().copied().filter(|level| chosen(level) && free(level)).collect()
    }
}

/// Viridis (van der Walt & Smith 2015): even steps to the eye, and in print without colours.
pub(super) fn band_color(band: usize, count: usize) -> RGBColor {
    let share = if count > 1 { band as f64 / (count - 1) as f64 } else { 0.5 };
    let colorous::Color { r, g, b } = colorous::VIRIDIS.eval_continuous(share);
    RGBColor(r, g, b)
}

/// A part's colour: that of the lines, light enough for a mesh upon it.
pub(super) fn part_color(part: usize) -> RGBColor {
    let RGBColor(r, g, b) = PALETTE[part % PALETTE.len()];
    let light = |channel: u8| (0.4 * f64::from(channel) + 0.6 * 255.0).round() as u8;
    RGBColor(light(r), light(g), light(b))
}

pub(super) fn hexadecimal(RGBColor(r, g, b): RGBColor) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

//! One picture: axes, lines, measured points, legend.

use super::axis::{Axis, drawable};
use super::decimation::{MOST_POINTS, decimate, drawable_stretches};
use super::guarded;
use super::inset::Inset;
use super::legend::{Legend, LegendEntry, Sample};
use super::markup;
use super::quantity::Quantity;
use crate::extremes;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use serde::Serialize;

/// The area on which a picture is drawn.
pub(super) type Root<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
/// Result of a drawing operation.
pub(super) type Drawn<'a, T> = Result<T, Box<dyn std::error::Error + 'a>>;

/// The picture is drawn this much larger, because the SVG backend rounds to whole units.
pub(super) const UNIT: i32 = 20;
/// Width of the picture, px.
pub(super) const WIDTH: i32 = 640;
/// Height without title and a legend below, px.
const HEIGHT: i32 = 430;
pub(super) const TITLE_SIZE: i32 = 15;
pub(super) const LABEL_SIZE: i32 = 15;
pub(super) const TICK_SIZE: i32 = 13;
/// Mean width of a character of a sans-serif font, em.
pub(super) const CHARACTER: f64 = 0.56;

/// Dashes after the full line, px. The backend draws none: [`Style::pen`] marks them by the width for [`dash`].
const DASHES: [&[i32]; 5] = [&[7, 4], &[2, 3], &[8, 3, 2, 3], &[14, 4], &[14, 3, 2, 3, 2, 3]];

pub(super) const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
/// Width of all bars of one name, in distances of names.
const BARS: f64 = 0.8;
/// The least range of ordinates of marked lines, relative to the greatest one.
const LEAST_SHARE: f64 = 0.1;
pub(super) const GRID: RGBColor = RGBColor(0xe4, 0xe4, 0xe4);
pub(super) const ZERO: RGBColor = RGBColor(0x99, 0x99, 0x99);

/// Okabe & Ito's colours, which the colour-blind can distinguish, yellow left out (too light for a line).
pub(super) const PALETTE: [RGBColor; 7] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0x00, 0x00, 0x00),
];

/// A picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Stem of the file's name.
    pub name: String,
    /// Above the picture; may be empty.
    pub title: String,
    /// Along x.
    pub x: Quantity,
    /// Along y.
    pub y: Quantity,
    /// Computed.
    pub lines: Vec<Line>,
    /// Measured.
    pub marks: Vec<Marks>,
    /// Kind of the axes.
    pub scale: Scale,
    /// x and y are of the same kind: a range that is nothing compared with the other is drawn as nothing.
    pub equal_units: bool,
    /// Meaning of colours and dashes, instead of a row of the legend for each line.
    pub key: Option<Key>,
}

/// Meaning of colours and dashes, by their numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Key {
    /// The meaning of each colour.
    pub colors: Vec<String>,
    /// Meaning of each dash; a single one needs none.
    pub dashes: Vec<String>,
    /// Whether the colours are shades from the first to the last: a bar instead of rows.
    pub shaded: bool,
}

/// A computed curve. Points that are no numbers interrupt it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Label in the legend.
    pub label: String,
    /// Points in the quantities' units.
    pub points: Vec<(f64, f64)>,
    /// The history's columns it comes from.
    pub columns: (String, String),
    /// Colour and dash that distinguish it from the others.
    pub style: Style,
    /// Whether its points have marks: few points, each a result.
    pub marked: bool,
}

impl Line {
    /// Makes a curve that belongs to no history. Its number distinguishes it from others.
    pub fn numbered(label: impl Into<String>, points: Vec<(f64, f64)>, number: usize) -> Self {
        let style = Style { color: number, dash: number };
        Self { label: label.into(), points, columns: Default::default(), style, marked: false }
    }
}

/// Scale of the axes. An axis y without a name shows numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Numbers.
    #[default]
    Linear,
    /// Powers of ten along x; numbers must be > 0.
    Decades,
    /// Powers of ten along x and y; numbers must be > 0.
    BothDecades,
    /// Names at x = 0, 1, 2…: marked lines are bars from 0.
    Names(Vec<String>),
}

/// Colour and dashes of a line, counted from 0: the first dash is a full line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// Number of the colour.
    pub color: usize,
    /// Number of the dash.
    pub dash: usize,
}

/// Measured points.
#[derive(Clone, Debug, PartialEq)]
pub struct Marks {
    /// Label in the legend.
    pub label: String,
    /// Points in the quantities' units.
    pub points: Vec<(f64, f64)>,
    /// Index of the line that they are to be compared with.
    pub line: Option<usize>,
}

/// Two opposite corners of a rectangle; on the picture the upper left and the lower right one.
pub(super) type Corners<T> = [(T, T); 2];

/// A drawn picture whose places have meaning.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drawing {
    /// The picture as SVG.
    pub svg: String,
    /// Width and height, in the picture's own coordinates.
    #[serde(skip)]
    pub size: (u32, u32),
    /// Upper left and lower right corner of the axes' frame, in the picture's own coordinates.
    pub frame: [(i32, i32); 2],
    /// Along x.
    pub x: Reading,
    /// Along y.
    pub y: Reading,
}

/// What an axis says of a place: its numbers from one end of the frame to the other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reading {
    /// Quantity and unit, without markup.
    pub label: String,
    /// Numbers at the ends, left or below first.
    pub range: [f64; 2],
    /// Factor from these numbers to the quantity's unit.
    pub scale: f64,
}

impl Figure {
    /// The picture as SVG.
    ///
    /// # Errors
    /// The picture cannot be drawn.
    pub fn svg(&self) -> Result<String, String> {
        self.drawing().map(|drawing| drawing.svg)
    }

    /// The picture, and what its places mean; of linear axes.
    ///
    /// # Errors
    /// The picture cannot be drawn.
    pub fn drawing(&self) -> Result<Drawing, String> {
        guarded(|| self.draw_whole())
    }

    fn draw_whole(&self) -> Result<Drawing, String> {
        let (x, y) = self.axes();
        let mut occupied = self.occupied(&x, &y);
        let inset = (self.scale == Scale::Linear).then(|| Inset::place(self, &occupied, (&x, &y))).flatten();
        occupied.extend(inset.as_ref().map(|inset| inset.outline(&x, &y)));
        let legend = Legend::place(self.legend_entries(), &occupied, &x, &y);
        let title = wrapped(&self.title, WIDTH);
        let title_height = if title.is_empty() { 8 } else { 14 + 20 * title.len() as i32 };
        let size = (WIDTH, HEIGHT + title_height + legend.height_below());
        let mut svg = String::new();
        let frame = {
            let root = SVGBackend::with_string(&mut svg, pixels(size)).into_drawing_area();
            let frame = self
                .draw(&root, (&x, &y), (&title, title_height), inset.as_ref(), &legend)
                .map_err(|error| error.to_string())?;
            root.present().map_err(|error| error.to_string())?;
            frame
        };
        let description = markup::plain(&format!("{} {}: {} – {}", self.title, self.name, y.label, x.label));
        let svg = finish(&svg, size, &description);
        Ok(Drawing { svg, size: pixels(size), frame, x: x.reading(), y: y.reading() })
    }

    fn axes(&self) -> (Axis, Axis) {
        let all = || self.lines.iter().flat_map(|line| &line.points).chain(self.marks.iter().flat_map(|m| &m.points));
        let (across, up) = (bounds(all().map(|p| p.0)), bounds(all().map(|p| p.1)));
        let least = |other: (f64, f64)| if self.equal_units { 0.25 * (other.1 - other.0).max(0.0) } else { 0.0 };
        let x = match &self.scale {
            Scale::Linear => Axis::new(&self.x, across, least(up), 9),
            Scale::Decades | Scale::BothDecades => Axis::logarithmic(&self.x, across),
            Scale::Names(names) => Axis::named(&self.x, names),
        };
        if self.scale == Scale::BothDecades {
            return (x, Axis::logarithmic(&self.y, up));
        }
        // what is nearly the same for all of a few results shall look so
        let up = if self.has_bars() { (up.0.min(0.0), up.1.max(0.0)) } else { up };
        let least_up = match self.lines.iter().any(|line| line.marked) {
            true => LEAST_SHARE * up.0.abs().max(up.1.abs()),
            false => least(across),
        };
        (x, Axis::new(&self.y, up, least_up, 8))
    }

    /// Returns whether marked lines are bars.
    fn has_bars(&self) -> bool {
        matches!(self.scale, Scale::Names(_))
    }

    /// Opposite corners of the bars of each marked line, in the axes' numbers: those of one name side by side.
    fn bars(&self, x: &Axis, y: &Axis) -> Vec<(Style, Vec<Corners<f64>>)> {
        let lines: Vec<&Line> = self.lines.iter().filter(|line| self.has_bars() && line.marked).collect();
        let width = BARS / lines.len().max(1) as f64;
        let of_line = |(k, line): (usize, &&Line)| {
            let start = |across: f64| x.scaled(across) + k as f64 * width - 0.5 * BARS;
            let points = drawable_stretches(&line.points).flatten();
            let corners = points.map(|&(across, up)| [(start(across), 0.0), (start(across) + width, y.scaled(up))]);
            (line.style, corners.collect())
        };
        lines.iter().enumerate().map(of_line).collect()
    }

    /// Returns the drawn points of each line, in the units of the axes, by uninterrupted sections.
    fn scaled_lines(&self, x: &Axis, y: &Axis) -> Vec<Vec<Vec<(f64, f64)>>> {
        let scaled = |line: &Line| {
            if self.has_bars() && line.marked {
                return Vec::new();
            }
            let all: usize = drawable_stretches(&line.points).map(<[_]>::len).sum();
            drawable_stretches(&line.points)
                .map(|stretch| {
                    let share = (MOST_POINTS * stretch.len() / all.max(1)).max(12);
                    let points = decimate(stretch, share).into_iter();
                    points.map(|(across, up)| (x.scaled(across), y.scaled(up))).collect()
                })
                .collect()
        };
        self.lines.iter().map(scaled).collect()
    }

    /// Returns the lines and single points that a legend must not cover.
    fn occupied(&self, x: &Axis, y: &Axis) -> Vec<Vec<(f64, f64)>> {
        let points = self.marks.iter().flat_map(|marks| drawable_stretches(&marks.points).flatten());
        let points = points.map(|&(across, up)| vec![(x.scaled(across), y.scaled(up))]);
        let bars = self.bars(x, y).into_iter().flat_map(|(_, bars)| bars);
        let outlines =
            bars.map(|[(left, foot), (right, top)]| vec![(left, foot), (left, top), (right, top), (right, foot)]);
        self.scaled_lines(x, y).into_iter().flatten().chain(points).chain(outlines).collect()
    }

    fn legend_entries(&self) -> Vec<LegendEntry> {
        let sample = |line: &Line| match line.marked {
            true if self.has_bars() => Sample::Bar,
            true => Sample::MarkedLine(line.style),
            false => Sample::Line(line.style),
        };
        let entry = |sample, color, label: &str| LegendEntry { sample, color, label: label.to_owned() };
        let mut entries: Vec<LegendEntry> = match &self.key {
            None => self.lines.iter().map(|line| entry(sample(line), self.color(line.style), &line.label)).collect(),
            Some(key) => key.entries(|style| self.color(style)),
        };
        let marks = self.marks.iter().enumerate();
        entries.extend(marks.map(|(k, marks)| entry(Sample::Mark(k), self.mark_color(marks), &marks.label)));
        if entries.len() > 1 || self.key.is_some() { entries } else { Vec::new() }
    }

    /// Returns the colour of a line.
    pub(super) fn color(&self, style: Style) -> RGBColor {
        let of_bars = (self.has_bars() && self.lines.len() > PALETTE.len()).then_some(self.lines.len());
        let shades = self.key.as_ref().filter(|key| key.shaded).map(|key| key.colors.len()).or(of_bars);
        shades.map_or(PALETTE[style.color % PALETTE.len()], |count| shade(style.color, count))
    }

    /// Returns the colour of measured points: that of text next to a single line, that of their line among several.
    pub(super) fn mark_color(&self, marks: &Marks) -> RGBColor {
        let owner = marks.line.filter(|_| self.lines.len() > 1).and_then(|line| self.lines.get(line));
        owner.map_or(INK, |line| self.color(line.style))
    }

    fn draw<'a>(
        &self,
        root: &Root<'a>,
        (x, y): (&Axis, &Axis),
        (title, title_height): (&[String], i32),
        inset: Option<&Inset>,
        legend: &Legend,
    ) -> Drawn<'a, Corners<i32>> {
        root.fill(&WHITE)?;
        draw_title(root, title, WIDTH)?;
        let left = left_of(y);
        let mut chart = ChartBuilder::on(&root.margin(title_height * UNIT, legend.height_below() * UNIT, 0, 0))
            .margin_left(10 * UNIT)
            .margin_right(22 * UNIT)
            .margin_top(4 * UNIT)
            .margin_bottom(8 * UNIT)
            .set_label_area_size(LabelAreaPosition::Left, left * UNIT)
            .set_label_area_size(LabelAreaPosition::Bottom, 46 * UNIT)
            .build_cartesian_2d(x.range.clone(), y.range.clone())?;
        draw_axes(&mut chart, (x, y), true, AxisSizes::OF_PICTURES)?;
        let area = chart.plotting_area();
        for (start, end) in zero_lines(x, y) {
            area.draw(&PathElement::new(vec![start, end], thin(ZERO)))?;
        }
        for (line, stretches) in self.lines.iter().zip(self.scaled_lines(x, y)) {
            for points in stretches {
                area.draw(&PathElement::new(points, line.style.pen(self.color(line.style))))?;
            }
        }
        for (style, bars) in self.bars(x, y) {
            for bar in bars {
                area.draw(&Rectangle::new(bar, self.color(style).filled()))?;
            }
        }
        let marked = self.lines.iter().filter(|line| line.marked && !self.has_bars());
        let marked = marked.map(|line| (line.style.color, self.color(line.style), &line.points));
        let measured = self.marks.iter().enumerate().map(|(k, marks)| (k, self.mark_color(marks), &marks.points));
        for (shape, color, points) in marked.chain(measured) {
            for &(across, up) in drawable_stretches(points).flatten() {
                draw_mark(root, shape, area.map_coordinate(&(x.scaled(across), y.scaled(up))), color)?;
            }
        }
        let (across, up) = area.get_pixel_range();
        let frame = [(across.start, up.start), (across.end, up.end)];
        root.draw(&outline(frame, INK))?;
        if let Some(inset) = inset {
            inset.draw(self, root, frame, (x, y))?;
        }
        legend.draw(root, frame)?;
        Ok(frame)
    }
}

impl Key {
    /// Returns the rows of the legend: colours (or their bar), then dashes.
    fn entries(&self, color: impl Fn(Style) -> RGBColor) -> Vec<LegendEntry> {
        let line =
            |style, color, label: &String| LegendEntry { sample: Sample::Line(style), color, label: label.clone() };
        let of_color = |(k, label)| {
            let style = Style { color: k, dash: 0 };
            line(style, color(style), label)
        };
        let mut rows: Vec<LegendEntry> = match self.colors.as_slice() {
            [first, .., last] if self.shaded => {
                vec![LegendEntry { sample: Sample::Shades, color: INK, label: format!("{first} … {last}") }]
            }
            colors => colors.iter().enumerate().map(of_color).collect(),
        };
        if self.dashes.len() > 1 {
            let dashes = self.dashes.iter().enumerate();
            rows.extend(dashes.map(|(k, label)| line(Style { color: 0, dash: k }, INK, label)));
        }
        rows
    }
}

/// The colour of number `number` of `count` shades; the lightest are left out.
pub(super) fn shade(number: usize, count: usize) -> RGBColor {
    const LIGHTEST: f64 = 0.92;
    let share = LIGHTEST * number as f64 / (count.max(2) - 1) as f64;
    let colorous::Color { r, g, b } = colorous::VIRIDIS.eval_continuous(share);
    RGBColor(r, g, b)
}

/// Width of text in px.
pub(super) fn text_width(size: i32, characters: usize) -> i32 {
    (f64::from(size) * CHARACTER * characters as f64) as i32
}

/// Room to the left of a plot for the numbers and the name of its axis, px.
pub(super) fn left_of(y: &Axis) -> i32 {
    text_width(TICK_SIZE, y.widest()) + 40
}

/// Draws the lines of a title on a picture of this width in px.
pub(super) fn draw_title<'a>(root: &Root<'a>, lines: &[String], width: i32) -> Drawn<'a, ()> {
    for (k, line) in lines.iter().enumerate() {
        let place = (width / 2 * UNIT, (18 + 20 * k as i32) * UNIT);
        root.draw(&Text::new(line.clone(), place, centered(TITLE_SIZE)))?;
    }
    Ok(())
}

/// Sizes of what belongs to axes, px.
#[derive(Clone, Copy)]
pub(super) struct AxisSizes {
    /// Length of the marks at the numbers.
    pub marks: i32,
    /// Text of the numbers.
    pub numbers: i32,
    /// Text of the names.
    pub names: i32,
}

impl AxisSizes {
    pub const OF_PICTURES: Self = Self { marks: 5, numbers: TICK_SIZE, names: LABEL_SIZE };
}

/// Draws axes with their numbers and names, and lines at the numbers where a plot has a grid.
pub(super) fn draw_axes<'a>(
    chart: &mut ChartContext<'_, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
    (x, y): (&Axis, &Axis),
    has_grid: bool,
    sizes: AxisSizes,
) -> Drawn<'a, ()> {
    let mut mesh = chart.configure_mesh();
    if has_grid {
        mesh.light_line_style(TRANSPARENT).bold_line_style(thin(GRID));
    } else {
        mesh.disable_mesh();
    }
    mesh.axis_style(thin(INK))
        .set_all_tick_mark_size(sizes.marks * UNIT)
        .x_labels(x.tick_count)
        .y_labels(y.tick_count)
        .x_label_formatter(&|value| x.text(*value))
        .y_label_formatter(&|value| y.text(*value))
        .label_style(font(sizes.numbers))
        .axis_desc_style(font(sizes.names))
        .x_desc(x.label.clone())
        .y_desc(y.label.clone())
        .draw()?;
    Ok(())
}

/// A title as lines that fit a picture of this width in px.
pub(super) fn wrapped(title: &str, width: i32) -> Vec<String> {
    let most = (f64::from(width - 20) / (CHARACTER * f64::from(TITLE_SIZE))) as usize;
    let mut lines: Vec<String> = Vec::new();
    for word in title.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Returns where x or y is zero inside the frame.
fn zero_lines(x: &Axis, y: &Axis) -> Vec<((f64, f64), (f64, f64))> {
    let horizontal = y.has_zero().then_some(((x.range.start, 0.0), (x.range.end, 0.0)));
    let vertical = x.has_zero().then_some(((0.0, y.range.start), (0.0, y.range.end)));
    horizontal.into_iter().chain(vertical).collect()
}

/// An open mark: circle, square, triangle, diamond, cross, in turn.
pub(super) fn draw_mark<'a>(root: &Root<'a>, shape: usize, (x, y): (i32, i32), color: RGBColor) -> Drawn<'a, ()> {
    let pen = color.stroke_width((1.4 * f64::from(UNIT)) as u32);
    let half = (3.4 * f64::from(UNIT)) as i32;
    let closed = |corners: &[(i32, i32)]| {
        let corners: Vec<_> = corners.iter().map(|(a, b)| (x + a * half / 10, y + b * half / 10)).collect();
        let outline: Vec<_> = corners.iter().chain(&corners[..2]).copied().collect();
        (Polygon::new(corners, WHITE.filled()), PathElement::new(outline, pen))
    };
    let corners: &[(i32, i32)] = match shape % 5 {
        0 => {
            root.draw(&Circle::new((x, y), half, WHITE.filled()))?;
            root.draw(&Circle::new((x, y), half, pen))?;
            return Ok(());
        }
        1 => &[(-9, -9), (9, -9), (9, 9), (-9, 9)],
        2 => &[(0, -12), (11, 8), (-11, 8)],
        3 => &[(0, -13), (13, 0), (0, 13), (-13, 0)],
        _ => {
            for end in [(1, 1), (1, -1)] {
                let (a, b) = (end.0 * half, end.1 * half);
                root.draw(&PathElement::new(vec![(x - a, y - b), (x + a, y + b)], pen))?;
            }
            return Ok(());
        }
    };
    let (fill, outline) = closed(corners);
    root.draw(&fill)?;
    root.draw(&outline)?;
    Ok(())
}

impl Style {
    /// Makes a pen two px wide. The few extra units encode the dash.
    pub(super) fn pen(self, color: RGBColor) -> ShapeStyle {
        color.stroke_width((2 * UNIT) as u32 + (self.dash % (DASHES.len() + 1)) as u32)
    }
}

/// Gives lines whose width encodes a dash their dashes.
fn dash(svg: &str) -> String {
    DASHES.iter().zip(2 * UNIT + 1..).fold(svg.to_owned(), |svg, (dash, width)| {
        let lengths: Vec<String> = dash.iter().map(|length| (length * UNIT).to_string()).collect();
        let dashed = format!("stroke-width=\"{}\" stroke-dasharray=\"{}\"", 2 * UNIT, lengths.join(" "));
        svg.replace(&format!("stroke-width=\"{width}\""), &dashed)
    })
}

/// The font at a size in px (the backend divides by 1.24).
pub(super) fn font(size: i32) -> TextStyle<'static> {
    ("sans-serif", f64::from(size * UNIT) * 1.24).into_text_style(&(1, 1)).color(&INK)
}

pub(super) fn centered(size: i32) -> TextStyle<'static> {
    font(size).pos(Pos::new(HPos::Center, VPos::Center))
}

/// Returns the font of text that begins at the given point, at half its height.
pub(super) fn left_aligned(size: i32) -> TextStyle<'static> {
    font(size).pos(Pos::new(HPos::Left, VPos::Center))
}

/// A pen 1 px wide.
pub(super) fn thin(color: RGBColor) -> ShapeStyle {
    color.stroke_width(UNIT as u32)
}

/// The outline of a rectangle, 1 px wide. (The SVG of plotters' own has no stroke width.)
pub(super) fn outline([(left, top), (right, bottom)]: Corners<i32>, color: RGBColor) -> PathElement<(i32, i32)> {
    PathElement::new([(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], thin(color))
}

pub(super) fn pixels((width, height): (i32, i32)) -> (u32, u32) {
    ((width * UNIT) as u32, (height * UNIT) as u32)
}

/// Least and greatest drawable value, or zeros.
pub(super) fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (least, greatest) = extremes(values.filter(|&value| drawable(value)));
    if least <= greatest { (least, greatest) } else { (0.0, 0.0) }
}

/// Shown at its size in px, with round joins and a name for readers that cannot see it.
pub(super) fn finish(svg: &str, size: (i32, i32), description: &str) -> String {
    let drawn = pixels(size);
    let escaped = maud::html! { title { (description.trim()) } }.into_string();
    let svg = svg.replacen(
        &format!("width=\"{}\" height=\"{}\"", drawn.0, drawn.1),
        &format!("width=\"{}\" height=\"{}\" role=\"img\" stroke-linejoin=\"round\"", size.0, size.1),
        1,
    );
    let (head, body) = svg.split_once(">\n").unwrap_or((&svg, ""));
    format!("{head}>\n{escaped}\n{}", markup::raise_and_lower(&dash(body)))
}

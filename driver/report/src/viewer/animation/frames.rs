//! Draws the frames of an animation and writes their file.

use super::Scenes;
use crate::plots::export::draw_upon;
use crate::plots::field::band_color_text;
use crate::plots::figure::{Figure, Line};
use crate::plots::quantity::Quantity;
use gif::{Encoder, Frame, Repeat};
use pullout_run::number::significant;
use resvg::tiny_skia::{Color, Pixmap};
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::io;

/// Width and height, px.
const SIZE: [u32; 2] = [880, 400];
/// Width of the specimen; the curve is next to it.
const MESH_WIDTH: f64 = 500.0;
/// Where the curve begins, px, and its width.
const CURVE: [f64; 3] = [516.0, 24.0, 356.0];
/// Colours of a field.
const COLORS: usize = 48;
/// Time of a frame and of the last one, hundredths of a second.
const DELAY: u16 = 7;
const REST: u16 = 150;
/// Colours of a file; one more says that a pixel stays as it was.
const MOST_COLORS: usize = 255;
const SAME: u8 = 255;

type Rgb = [u8; 3];

/// Colour of open cracks.
const CRACK: Rgb = [0xe4, 0x00, 0x2b];
/// Colour of the current point on the curve.
const MARK: Rgb = [0xd5, 0x5e, 0x00];

/// Returns a colour as SVG has it.
fn svg_color([red, green, blue]: Rgb) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Returns the colours of cracks and of the current point, of which there may be few pixels, and the most frequent colours of the frames.
/// Unused places are black.
fn palette(frames: &[Vec<Rgb>]) -> Vec<Rgb> {
    let mut counts: HashMap<Rgb, u32> = HashMap::new();
    frames.iter().flatten().for_each(|color| *counts.entry(*color).or_default() += 1);
    counts.extend([CRACK, MARK].map(|color| (color, u32::MAX)));
    let mut colors: Vec<(u32, Rgb)> = counts.into_iter().map(|(color, count)| (count, color)).collect();
    colors.sort_unstable_by(|a, b| b.cmp(a));
    let mut colors: Vec<Rgb> = colors.into_iter().take(MOST_COLORS).map(|(_, color)| color).collect();
    colors.resize(MOST_COLORS + 1, [0; 3]);
    colors
}

/// Place of the nearest colour.
fn nearest(palette: &[Rgb], color: &Rgb) -> u8 {
    let distance =
        |other: &Rgb| -> i32 { other.iter().zip(color).map(|(a, b)| (i32::from(*a) - i32::from(*b)).pow(2)).sum() };
    let places = palette.iter().take(MOST_COLORS).enumerate();
    places.min_by_key(|(_, other)| distance(other)).map_or(0, |(place, _)| place as u8)
}

/// Where a slip and a load are on the picture of the curve, px.
struct OnCurve {
    frame: [(i32, i32); 2],
    ranges: [[f64; 2]; 2],
    unit: f64,
}

impl OnCurve {
    fn at(&self, [slip, load]: [f64; 2]) -> [f64; 2] {
        let [(left, top), (right, bottom)] = self.frame.map(|(x, y)| (f64::from(x), f64::from(y)));
        let [[x0, x1], [y0, y1]] = self.ranges;
        let x = left + (right - left) * (slip - x0) / (x1 - x0);
        let y = bottom + (top - bottom) * (load - y0) / (y1 - y0);
        [CURVE[0] + self.unit * x, CURVE[1] + self.unit * y]
    }
}

impl Scenes {
    /// Draws this many frames, and writes them.
    pub(super) fn gif(&self, frames: usize) -> io::Result<Vec<u8>> {
        let (behind, curve) = self.background()?;
        let moments = self.moments(frames);
        let mut drawn = Vec::new();
        for &moment in &moments {
            let mut pixels = behind.clone();
            draw_upon(&mut pixels, &self.frame(moment, &curve))?;
            drawn.push(pixels.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect::<Vec<Rgb>>());
        }
        let palette = palette(&drawn);
        let [width, height] = SIZE.map(|size| size as u16);
        let mut bytes = Vec::new();
        let flat: Vec<u8> = palette.iter().flatten().copied().collect();
        let mut encoder = Encoder::new(&mut bytes, width, height, &flat).map_err(io::Error::other)?;
        encoder.set_repeat(Repeat::Infinite).map_err(io::Error::other)?;
        let mut known: HashMap<Rgb, u8> = HashMap::new();
        let mut before: Option<Vec<u8>> = None;
        for (k, pixels) in drawn.iter().enumerate() {
            let indices: Vec<u8> =
                pixels.iter().map(|color| *known.entry(*color).or_insert_with(|| nearest(&palette, color))).collect();
            let changed = match &before {
                None => indices.clone(),
                Some(before) => {
                    indices.iter().zip(before).map(|(new, old)| if new == old { SAME } else { *new }).collect()
                }
            };
            let frame = Frame {
                width,
                height,
                delay: if k + 1 == drawn.len() { REST } else { DELAY },
                transparent: Some(SAME),
                buffer: Cow::Owned(changed),
                ..Frame::default()
            };
            encoder.write_frame(&frame).map_err(io::Error::other)?;
            before = Some(indices);
        }
        drop(encoder);
        Ok(bytes)
    }

    /// What all frames have: the curve, and what the colours mean.
    fn background(&self) -> io::Result<(Pixmap, OnCurve)> {
        let [slips, loads] = &self.head.curve;
        let number = |value: &Option<f64>| value.unwrap_or(f64::NAN);
        let figure = Figure {
            x: Quantity::of("slip", &Default::default()),
            y: Quantity::of("load", &Default::default()),
            lines: vec![Line::numbered("", slips.iter().map(number).zip(loads.iter().map(number)).collect(), 0)],
            ..Figure::default()
        };
        let drawing = figure.drawing().map_err(io::Error::other)?;
        let (width, height) = (f64::from(drawing.size.0), f64::from(drawing.size.1));
        let unit = CURVE[2] / width;
        let body = drawing.svg.split_once(">\n").map_or("", |(_, body)| body);
        let mut svg = head();
        let _ = write!(
            svg,
            r#"<svg x="{}" y="{}" width="{}" height="{}" viewBox="0 0 {width} {height}">{body}"#,
            CURVE[0],
            CURVE[1],
            CURVE[2],
            unit * height
        );
        self.key(&mut svg, CURVE[1] + unit * height + 54.0);
        svg.push_str("</svg>");
        let [wide, high] = SIZE;
        let mut pixels = Pixmap::new(wide, high).ok_or_else(|| io::Error::other("the picture is too large"))?;
        pixels.fill(Color::WHITE);
        draw_upon(&mut pixels, &svg)?;
        let reading = |reading: &crate::plots::figure::Reading| reading.range.map(|end| end * reading.scale);
        Ok((pixels, OnCurve { frame: drawing.frame, ranges: [reading(&drawing.x), reading(&drawing.y)], unit }))
    }

    /// Name of the field, its colours, and the numbers at their ends for each part.
    fn key(&self, svg: &mut String, top: f64) {
        let field = &self.head.fields[self.field];
        let left = CURVE[0] + 40.0;
        let unit = if field.unit.is_empty() { String::new() } else { format!(", {}", field.unit) };
        let _ = write!(svg, "{}{}{unit}</text>", text(left, top, "start"), field.name);
        let width = 260.0 / COLORS as f64;
        for k in 0..COLORS {
            let x = left + width * k as f64;
            let _ = write!(
                svg,
                r#"<rect x="{x:.2}" y="{:.1}" width="{:.2}" height="9" fill="{}" shape-rendering="crispEdges"/>"#,
                top + 8.0,
                width + 0.3,
                band_color_text(k, COLORS)
            );
        }
        for (k, (part, [low, high])) in self
            .head
            .parts
            .iter()
            .zip(&field.ranges)
            .filter_map(|(part, [low, high])| Some((part, [(*low)?, (*high)?])))
            .enumerate()
        {
            let y = top + 32.0 + 15.0 * k as f64;
            let (low, high) = (significant(low, 3), significant(high, 3));
            let _ = write!(svg, "{}{low}</text>", text(left, y, "start"));
            let _ = write!(svg, "{}{part}</text>", text(left + 130.0, y, "middle"));
            let _ = write!(svg, "{}{high}</text>", text(left + 260.0, y, "end"));
        }
    }

    /// The specimen at a moment, its place on the curve, slip and load.
    fn frame(&self, moment: (usize, f64), curve: &OnCurve) -> String {
        let [left, right, low, high] = self.view;
        let [width, height] = [MESH_WIDTH, f64::from(SIZE[1])];
        let unit = (width / (right - left)).min(height / (high - low));
        let middle = [0.5 * (left + right), 0.5 * (low + high)];
        let on_picture =
            |[x, y]: [f64; 2]| [0.5 * width + unit * (x - middle[0]), 0.5 * height - unit * (y - middle[1])];
        let place = |node: u32| on_picture(self.position(node as usize, moment));
        let mut svg = head();
        let _ = write!(
            svg,
            r#"<clipPath id="c"><rect width="{width}" height="{height}"/></clipPath><g clip-path="url(#c)">"#
        );
        let left = &self.head.frames[moment.0].left;
        for layer in 0..2 {
            let start = if layer == 0 { [0, 0] } else { self.head.behind };
            let mut fills: BTreeMap<Option<usize>, String> = BTreeMap::new();
            let (triangles, edges) = (self.triangles.as_chunks::<3>().0, self.edges.as_chunks::<2>().0);
            for triangle in triangles.iter().skip(start[0]).take(left[0][layer]) {
                let shares = triangle.map(|node| self.share(node as usize, moment));
                let known = shares.iter().flatten().count();
                let mean = (known == 3).then(|| shares.iter().flatten().sum::<f64>() / 3.0);
                let step = mean.map(|mean| (mean * COLORS as f64).min(COLORS as f64 - 1.0) as usize);
                outline(fills.entry(step).or_default(), triangle.map(place));
            }
            for (step, path) in &fills {
                let fill = step.map_or_else(|| "#d1d1d1".to_owned(), |step| band_color_text(step, COLORS));
                // without a seam between neighbours
                let _ = write!(
                    svg,
                    r#"<path d="{path}" fill="{fill}" stroke="{fill}" stroke-width="0.6" shape-rendering="crispEdges"/>"#
                );
            }
            let mut lines = String::new();
            for edge in edges.iter().skip(start[1]).take(left[1][layer]) {
                outline(&mut lines, edge.map(place));
            }
            let _ = write!(
                svg,
                r##"<path d="{lines}" fill="none" stroke="#000" stroke-opacity="0.22" stroke-width="0.5"/>"##
            );
        }
        let mut cracks = String::new();
        for [x, y, u, v, a, b] in self.cracks[moment.0].iter().map(|crack| crack.map(f64::from)) {
            outline(&mut cracks, [1.0, -1.0].map(|side| on_picture([x + u + side * a, y + v + side * b])));
        }
        let crack = svg_color(CRACK);
        let _ = write!(svg, r##"<path d="{cracks}" fill="none" stroke="{crack}" stroke-width="1.4"/></g>"##);
        let at = self.place(moment);
        let [x, y] = curve.at(at);
        let _ = write!(svg, r##"<circle cx="{x:.1}" cy="{y:.1}" r="4.5" fill="{}"/>"##, svg_color(MARK));
        let below = CURVE[0] + 40.0;
        let [slip, load] = at;
        let _ = write!(svg, "{}slip {slip:.2} mm, load {load:.1} N</text></svg>", text(below, 16.0, "start"));
        svg
    }
}

fn head() -> String {
    let [width, height] = SIZE;
    format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">"#
    )
}

/// The beginning of a text.
fn text(x: f64, y: f64, anchor: &str) -> String {
    format!(
        r##"<text x="{x:.1}" y="{y:.1}" font-family="sans-serif" font-size="12" fill="#222" text-anchor="{anchor}">"##
    )
}

/// Adds a closed outline to a path.
fn outline<const N: usize>(path: &mut String, points: [[f64; 2]; N]) {
    for (k, [x, y]) in points.into_iter().enumerate() {
        let _ = write!(path, "{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' });
    }
    path.push('Z');
}

//! Pictures of fields on a mesh as SVG, to equal scales: the deformed mesh, filled contours, profiles along lines.
//!
//! Fills are drawn as a stack: first all of the body in the lowest colour, then what lies above each level. One path
//! holds what a colour covers, across elements, so there are no seams and the picture stays small.

mod canvas;
mod crosses;
mod levels;
mod profile;
mod region;
mod surface;
mod view;
mod zones;

/// A colour of the scale of fields, as `#rrggbb`.
pub(crate) fn band_color_text(band: usize, count: usize) -> String {
    hexadecimal(band_color(band, count))
}

pub(crate) use crosses::crosses;
pub(crate) use profile::{ALONG_SURFACE, INTERFACE_SHEAR, interface_profiles};
pub(crate) use zones::{Class, deformed_mesh, zones};

use super::quantity::Quantity;
use crate::extremes;
use canvas::{Canvas, Side, band_color, hexadecimal};
use fe_core::element::ElementKind;
use fe_core::mesh::{Element, Mesh};
use fe_core::output::{Activity, Fields, Recovery};
use levels::Levels;
use std::fmt::Write as _;
use std::ops::Range;
use surface::Surface;
use view::View;

#[cfg(test)]
mod test;

/// A mesh as pictures need it. Where a field jumps between parts, the nodes there come once for each part.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureMesh {
    /// Reference positions, mm.
    pub nodes: Vec<[f64; 2]>,
    /// Displacement of each node, mm.
    pub displacements: Vec<[f64; 2]>,
    pub elements: Vec<PictureElement>,
    /// Names of the parts.
    pub parts: Vec<String>,
    /// Parts that are drawn first, so that others hide them.
    pub behind: Vec<usize>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureElement {
    pub kind: ElementKind,
    /// Index of its part.
    pub part: usize,
    /// Indices of its nodes, in the order of [`fe_core::element`].
    pub nodes: Vec<usize>,
}

/// A part of the plane, in deformed positions as drawn, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Range of x from left to right.
    pub x: Range<f64>,
    /// Range of y from below to above.
    pub y: Range<f64>,
}

/// Settings of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldPicture<'a> {
    /// Above the picture; may be empty.
    pub title: String,
    pub mesh: &'a PictureMesh,
    /// Displacements are drawn this many times as large; the picture says so.
    pub magnification: f64,
    /// Window that is shown; `None`: all.
    pub window: Option<Window>,
}

/// A picture that cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PictureError {
    /// No element inside the window, or no finite position.
    #[error("there is nothing to draw: no element lies in the window")]
    Nothing,
    /// Message about an inconsistent mesh, a number of values that is not one per node, a window without area, or a failure of the
    /// drawing library.
    #[error("{0}")]
    Wrong(String),
}

impl PictureMesh {
    /// Makes a picture mesh of computed fields, without what was released: a node for each place that the recovery has values at.
    pub fn new(mesh: &Mesh, fields: &Fields, recovery: &Recovery) -> Self {
        let elements = mesh.elements().iter().enumerate();
        let element = |(index, element): (usize, &Element)| PictureElement {
            kind: element.kind(),
            part: element.part(),
            nodes: recovery.of_element(index).to_vec(),
        };
        let is_left = |(index, _): &(usize, _)| fields.activities[*index] != Activity::Spalled;
        let displacement = |&node: &usize| [fields.displacements[2 * node], fields.displacements[2 * node + 1]];
        Self {
            nodes: recovery.nodes().iter().map(|&node| mesh.nodes()[node]).collect(),
            displacements: recovery.nodes().iter().map(displacement).collect(),
            elements: elements.filter(is_left).map(element).collect(),
            parts: mesh.parts().iter().map(|part| part.name.clone()).collect(),
            behind: fields.behind.clone(),
        }
    }

    /// 1, 2 or 5 times a power of ten, at least 1: with it the largest displacement is about a twentieth of the
    /// body's larger side.
    pub(crate) fn suggested_magnification(&self) -> f64 {
        let lengths = self.displacements.iter().map(|u| u[0].hypot(u[1])).filter(|length| length.is_finite());
        let largest = lengths.fold(0.0, f64::max);
        let side = Window::around(&self.nodes)
            .map_or(0.0, |window| (window.x.end - window.x.start).max(window.y.end - window.y.start));
        let wanted = side / (20.0 * largest);
        if !(wanted > 1.0 && wanted < 1e12) {
            return 1.0;
        }
        let power = 10f64.powf(wanted.log10().floor());
        [5.0, 2.0].into_iter().find(|factor| factor * power <= wanted).unwrap_or(1.0) * power
    }

    fn check(&self) -> Result<(), PictureError> {
        expect_length("displacements", self.displacements.len(), self.nodes.len())?;
        let fits = |element: &PictureElement| {
            element.nodes.len() == element.kind.node_count()
                && element.nodes.iter().all(|&node| node < self.nodes.len())
                && element.part < self.parts.len()
        };
        match self.elements.iter().position(|element| !fits(element)) {
            Some(index) => {
                let fault = format!("element {} of the picture's mesh does not fit its nodes and parts", index + 1);
                Err(PictureError::Wrong(fault))
            }
            None => Ok(()),
        }
    }
}

fn expect_length(what: &str, found: usize, expected: usize) -> Result<(), PictureError> {
    let fault = || PictureError::Wrong(format!("there are {found} {what}, the picture's mesh has {expected} nodes"));
    if found == expected { Ok(()) } else { Err(fault()) }
}

impl<'a> FieldPicture<'a> {
    /// All of a mesh, displacements as they are.
    pub fn new(title: impl Into<String>, mesh: &'a PictureMesh) -> Self {
        Self { title: title.into(), mesh, magnification: 1.0, window: None }
    }

    /// Returns where nodes are drawn, mm.
    fn positions(&self, magnification: f64) -> Vec<[f64; 2]> {
        let moved = |(node, u): (&[f64; 2], &[f64; 2])| [0, 1].map(|k| node[k] + magnification * u[k]);
        self.mesh.nodes.iter().zip(&self.mesh.displacements).map(moved).collect()
    }

    /// Checks the mesh, and finds out what is shown of it.
    fn shown(&self) -> Result<Shown, PictureError> {
        self.mesh.check()?;
        let positions = self.positions(self.magnification);
        let window = match &self.window {
            Some(window) => window.clone(),
            None => Window::around(&positions).ok_or(PictureError::Nothing)?,
        };
        if !window.is_proper() {
            return Err(PictureError::Wrong(format!("the window {:?} × {:?} has no area", window.x, window.y)));
        }
        let view = View::new(&window);
        let seen = surface::seen(self.mesh, &positions, &view);
        if seen.is_empty() {
            return Err(PictureError::Nothing);
        }
        Ok(Shown { positions, view, seen })
    }

    fn is_deformed(&self) -> bool {
        self.magnification != 0.0 && self.mesh.displacements.iter().flatten().any(|&u| u != 0.0)
    }

    /// Returns what the picture says about displacements.
    fn note(&self) -> String {
        match self.magnification {
            _ if !self.is_deformed() => String::new(),
            1.0 => "deformed, to scale".into(),
            factor => format!("deformed, displacements × {}", pullout_run::number::significant(factor, 4)),
        }
    }

    /// Returns the note, followed by `more`.
    fn note_with(&self, more: &str) -> String {
        let note = self.note();
        let separator = if note.is_empty() { "" } else { "; " };
        format!("{note}{separator}{more}")
    }
}

/// Part of a mesh that a picture shows.
struct Shown {
    /// Positions of all nodes as drawn, mm.
    positions: Vec<[f64; 2]>,
    view: View,
    /// Indices of the elements in the view, at least one.
    seen: Vec<usize>,
}

/// Filled contours of values at the nodes, interpolated as the elements do, with a colour bar.
///
/// Levels are round numbers. The bar begins and ends with the least and the greatest value of the elements that are
/// shown, or with `range` where given: values beyond it take the colours of its ends, and the picture says how far they
/// go. Elements with a value that is no finite number are grey.
///
/// # Errors
///
/// As [`deformed_mesh`], or not one value per node.
pub fn contour(
    picture: &FieldPicture<'_>,
    values: &[f64],
    quantity: &Quantity,
    range: Option<(f64, f64)>,
) -> Result<String, PictureError> {
    let mesh = picture.mesh;
    expect_length("values", values.len(), mesh.nodes.len())?;
    let Shown { positions, view, seen } = picture.shown()?;
    let has_value = |element: &PictureElement| element.nodes.iter().all(|&node| super::axis::drawable(values[node]));
    let (known, unknown): (Vec<&PictureElement>, Vec<&PictureElement>) =
        seen.iter().map(|&index| &mesh.elements[index]).partition(|element| has_value(element));
    let data = extremes(known.iter().flat_map(|element| &element.nodes).map(|&node| values[node]));
    let shown = range.filter(|(start, end)| start < end && (end - start).is_finite());
    let shown = shown.or((data.0 <= data.1).then_some(data));
    let levels = shown.map(|range| Levels::new(quantity, range));
    let note = levels.as_ref().map_or_else(|| picture.note(), |levels| note_with_excess(picture, levels, data));
    let side = Side::Bar { levels: levels.as_ref(), missing: !unknown.is_empty() };
    let canvas = Canvas::new(&picture.title, &note, view, &side)?;
    let surface = Surface::new(mesh, positions, canvas.view());
    let mut body = String::new();
    for layer in surface.layers() {
        push_fill(&mut body, canvas::NO_VALUE, &layer.area(|_, element| !has_value(element)));
        if let Some(levels) = &levels {
            let color = |band: usize| hexadecimal(band_color(band, levels.count()));
            push_fill(&mut body, &color(0), &layer.area(|_, element| has_value(element)));
            for (k, &level) in levels.between.iter().enumerate() {
                push_fill(&mut body, &color(k + 1), &layer.area_above(values, level));
            }
        }
        let [inner, boundary] = layer.edges(canvas.view());
        if layer.element_size > LEAST_MESH {
            push_line(&mut body, "#ffffff", 0.3, &inner, " stroke-opacity=\"0.35\"");
        }
        push_line(&mut body, "#222222", 0.8, &boundary, "");
    }
    Ok(canvas.finish(&body))
}

/// The note, and how far the data go beyond the levels' range. Data without a value have an empty range.
fn note_with_excess(picture: &FieldPicture<'_>, levels: &Levels, (least, greatest): (f64, f64)) -> String {
    if least > greatest || (least >= levels.range.0 && greatest <= levels.range.1) {
        return picture.note();
    }
    picture.note_with(&format!("values from {} to {}", levels.end_text(least), levels.end_text(greatest)))
}

/// Elements smaller than this on average, px, are not outlined in contours: lines would hide the colours.
const LEAST_MESH: f64 = 9.0;

fn push_fill(body: &mut String, color: &str, path: &str) {
    if !path.is_empty() {
        // writing to a String cannot fail
        let _ = writeln!(body, "<path fill=\"{color}\" d=\"{path}\"/>");
    }
}

fn push_line(body: &mut String, color: &str, pixels: f64, path: &str, more: &str) {
    if !path.is_empty() {
        let width = (pixels * f64::from(super::figure::UNIT)).round();
        // writing to a String cannot fail
        let _ = writeln!(body, "<path fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"{more} d=\"{path}\"/>");
    }
}

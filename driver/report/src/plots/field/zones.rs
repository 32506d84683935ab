//! Elements in classes: by their parts, or by what they do.

use super::canvas::{Canvas, Side, hexadecimal, part_color};
use super::surface::Surface;
use super::{FieldPicture, LEAST_MESH, PictureError, Shown, expect_length, push_fill, push_line};
use plotters::style::RGBColor;

/// A class of elements: colour and name.
pub type Class<'n> = (RGBColor, &'n str);

/// The elements on the deformed shape, parts in colours; the undeformed outline dashed.
///
/// # Errors
///
/// A mesh that does not fit itself, a window without area or without elements.
pub fn deformed_mesh(picture: &FieldPicture<'_>) -> Result<String, PictureError> {
    let mesh = picture.mesh;
    let parts = mesh.parts.iter().enumerate();
    let parts: Vec<Class<'_>> = parts.map(|(part, name)| (part_color(part), name.as_str())).collect();
    let inner = |element_size: f64| ((0.05 * element_size).clamp(0.15, 0.6), "");
    let (canvas, mut body) = in_classes(picture, &parts, |index| mesh.elements[index].part, inner, 1.0)?;
    if picture.is_deformed() {
        let [_, outline] = Surface::new(mesh, picture.positions(0.0), canvas.view()).edges(canvas.view());
        push_line(&mut body, "#888888", 0.8, &outline, " stroke-dasharray=\"80 60\"");
    }
    Ok(canvas.finish(&body))
}

/// The elements in the colours of their classes, given by their indices.
///
/// # Errors
///
/// As [`deformed_mesh`], or not one class per element.
pub fn zones(picture: &FieldPicture<'_>, of: &[usize], classes: &[Class<'_>]) -> Result<String, PictureError> {
    expect_length("classes", of.len(), picture.mesh.elements.len())?;
    let inner = |element_size: f64| (if element_size > LEAST_MESH { 0.4 } else { 0.15 }, " stroke-opacity=\"0.5\"");
    let (canvas, body) = in_classes(picture, classes, |index| of[index], inner, 0.8)?;
    Ok(canvas.finish(&body))
}

/// Draws the elements in the colours of their classes and names the visible classes next to them. `inner`: width, px, and other
/// attributes of the lines inside parts, by the size of an element; `boundary`: width of the lines around parts.
fn in_classes(
    picture: &FieldPicture<'_>,
    classes: &[Class<'_>],
    class_of: impl Fn(usize) -> usize,
    inner: impl Fn(f64) -> (f64, &'static str),
    boundary: f64,
) -> Result<(Canvas, String), PictureError> {
    let Shown { positions, view, seen } = picture.shown()?;
    let is_seen = |class: usize| seen.iter().any(|&index| class_of(index) == class);
    let named = classes.iter().enumerate().filter(|(class, _)| is_seen(*class));
    let names: Vec<Class<'_>> = named.map(|(_, class)| *class).collect();
    let canvas = Canvas::new(&picture.title, &picture.note(), view, &Side::Names(&names))?;
    let surface = Surface::new(picture.mesh, positions, canvas.view());
    let mut body = String::new();
    for layer in surface.layers() {
        for (class, (color, _)) in classes.iter().enumerate() {
            push_fill(&mut body, &hexadecimal(*color), &layer.area(|index, _| class_of(index) == class));
        }
        let [inside, around] = layer.edges(canvas.view());
        let (width, more) = inner(layer.element_size);
        push_line(&mut body, "#222222", width, &inside, more);
        push_line(&mut body, "#222222", boundary, &around, "");
    }
    Ok((canvas, body))
}

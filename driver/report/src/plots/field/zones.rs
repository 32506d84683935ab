//! Elements in classes.

use super::canvas::{Canvas, Side, hexadecimal};
use super::surface::Surface;
use super::{FieldPicture, LEAST_MESH, PictureError, expect_length, push_fill, push_line};
use plotters::style::RGBColor;

/// A class of elements: colour and name.
pub type Class = (RGBColor, &'static str);

/// The elements in the colours of their classes, given by their indices.
///
/// # Errors
///
/// As [`super::deformed_mesh`], or not one class per element.
pub fn zones(picture: &FieldPicture<'_>, of: &[usize], classes: &[Class]) -> Result<String, PictureError> {
    let mesh = picture.mesh;
    mesh.check()?;
    expect_length("classes", of.len(), mesh.elements.len())?;
    let positions = picture.positions(picture.magnification);
    let view = picture.view(&positions)?;
    let mut seen = vec![false; classes.len()];
    Surface::new(mesh, positions.clone(), &view).indices().for_each(|index| seen[of[index]] = true);
    let names: Vec<Class> = classes.iter().zip(&seen).filter(|(_, seen)| **seen).map(|(class, _)| *class).collect();
    if names.is_empty() {
        return Err(PictureError::Nothing);
    }
    let canvas = Canvas::new(&picture.title, &picture.note(), &picture.axes, view, &Side::Names(&names))?;
    let surface = Surface::new(mesh, positions, canvas.view());
    let mut body = String::new();
    for layer in surface.layers() {
        for (class, (color, _)) in classes.iter().enumerate() {
            push_fill(&mut body, &hexadecimal(*color), &layer.area(|index, _| of[index] == class));
        }
        let [inner, boundary] = layer.edges(canvas.view());
        let width = if layer.element_size > LEAST_MESH { 0.4 } else { 0.15 };
        push_line(&mut body, "#222222", width, &inner, " stroke-opacity=\"0.5\"");
        push_line(&mut body, "#222222", 0.8, &boundary, "");
    }
    Ok(canvas.finish(&body))
}

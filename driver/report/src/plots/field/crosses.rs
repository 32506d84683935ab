//! Principal stresses as crosses: each line along a principal direction, as long as the stress is great.

use super::canvas::{Canvas, Side};
use super::surface::{Surface, extent};
use super::view::View;
use super::{FieldPicture, PictureElement, PictureError, Shown, expect_length, push_line};
use crate::plots::figure::{PALETTE, UNIT};
use fe_core::element::ElementKind;
use fe_core::output::Principal;
use pullout_run::number::significant;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Distance of crosses, and the length of the longest line, px.
const DISTANCE: f64 = 17.0;
const LONGEST: f64 = 16.0;
/// Shorter lines are left out, px.
const SHORTEST: f64 = 1.6;
/// Places looked at along a side of an element at most.
const MOST_PLACES: usize = 24;
/// The longest line is the stress that this part of the places does not exceed: peaks at corners do not make the rest
/// invisible.
const SHARE_IN_SCALE: f64 = 0.95;

/// Principal stresses in the plane from stresses 11, 22, 33, 12 at the nodes, MPa, at even distances: tension and
/// compression in different colours.
///
/// The length follows from the parts for which `in_scale` says so; greater stresses have the longest line, and the
/// picture says from which stress on.
///
/// # Errors
///
/// As [`super::contour`], and [`PictureError::Nothing`] where no place has a stress.
pub fn crosses(
    picture: &FieldPicture<'_>,
    stresses: &[[f64; 4]],
    in_scale: impl Fn(usize) -> bool,
) -> Result<String, PictureError> {
    let mesh = picture.mesh;
    expect_length("stresses", stresses.len(), mesh.nodes.len())?;
    let Shown { positions, view, seen } = picture.shown()?;
    let drawn = positions.as_slice();
    // an element in the background is hidden, or too small for a cross
    let shown = seen.iter().filter(|&&index| !mesh.behind.contains(&mesh.elements[index].part));
    let candidates = shown.flat_map(|&index| {
        let element = &mesh.elements[index];
        places_in(element, drawn, &view).map(move |weights| Candidate::new(element, &weights, drawn, stresses))
    });
    let places = evenly(candidates, &view);
    let longest = |is_counted: &dyn Fn(usize) -> bool| {
        let scaled = places.iter().filter(|place| is_counted(place.part)).map(Candidate::greatest);
        quantile(scaled.filter(|stress| *stress > 0.0).collect(), SHARE_IN_SCALE)
    };
    // where those parts have no stress, the others give the length
    let longest = longest(&in_scale).or_else(|| longest(&|_| true)).ok_or(PictureError::Nothing)?;
    let note = picture.note_with(&format!("longest line: {} MPa and more", significant(longest, 3)));
    let names = [(PALETTE[1], "tension"), (PALETTE[0], "compression")];
    let canvas = Canvas::new(&picture.title, &note, view, &Side::Names(&names))?;
    let surface = Surface::new(mesh, positions, canvas.view());
    let mut body = String::new();
    let [_, boundary] = surface.edges(canvas.view());
    push_line(&mut body, "#999999", 0.8, &boundary, "");
    let mut paths = [String::new(), String::new()];
    for place in &places {
        place.draw(canvas.view(), longest, &mut paths);
    }
    for ((color, _), path) in names.iter().zip(&paths) {
        push_line(&mut body, &super::canvas::hexadecimal(*color), 1.3, path, "");
    }
    Ok(canvas.finish(&body))
}

/// Candidate for a cross: a position with its principal stresses.
struct Candidate {
    part: usize,
    /// Position as it is drawn, mm.
    position: [f64; 2],
    principal: Principal,
}

impl Candidate {
    fn new(element: &PictureElement, weights: &[f64], positions: &[[f64; 2]], stresses: &[[f64; 4]]) -> Self {
        let mut position = [0.0; 2];
        let mut stress = [0.0; 4];
        for (weight, &node) in weights.iter().zip(&element.nodes) {
            position.iter_mut().zip(&positions[node]).for_each(|(sum, value)| *sum += weight * value);
            stress.iter_mut().zip(&stresses[node]).for_each(|(sum, value)| *sum += weight * value);
        }
        Self { part: element.part, position, principal: Principal::new(stress) }
    }

    fn greatest(&self) -> f64 {
        self.principal.in_plane.iter().map(|stress| stress.abs()).fold(0.0, f64::max)
    }

    /// Adds its lines to the paths of tension and compression.
    fn draw(&self, view: &View, longest: f64, paths: &mut [String; 2]) {
        let (x, y) = view.place(self.position);
        for (stress, angle) in self.principal.in_plane.iter().zip([0.0, std::f64::consts::FRAC_PI_2]) {
            let length = LONGEST * (stress.abs() / longest).min(1.0);
            if length.is_nan() || length < SHORTEST {
                continue;
            }
            let half = 0.5 * length * f64::from(UNIT);
            let (sine, cosine) = (self.principal.angle + angle).sin_cos();
            let (dx, dy) = ((half * cosine).round() as i32, (-half * sine).round() as i32);
            let path = &mut paths[usize::from(*stress < 0.0)];
            // writing to a String cannot fail
            let _ = write!(path, "M{} {}l{} {}", x - dx, y - dy, 2 * dx, 2 * dy);
        }
    }
}

/// Shape functions at places spread over an element, about as far from each other as crosses are.
fn places_in<'p>(
    element: &'p PictureElement,
    positions: &'p [[f64; 2]],
    view: &View,
) -> impl Iterator<Item = Vec<f64>> + use<'p> {
    // twice as many: the nearest to each cross is taken
    let count =
        (2.0 * view.pixels(extent(element, positions)) / DISTANCE).ceil().clamp(1.0, MOST_PLACES as f64) as usize;
    let kind: ElementKind = element.kind;
    let triangular = kind.corner_count() == 3;
    let share = move |k: usize| (k as f64 + if triangular { 1.0 / 3.0 } else { 0.5 }) / count as f64;
    let all = (0..count * count).map(move |k| (k % count, k / count));
    let inside = all.filter(move |(column, row)| !triangular || column + row < count);
    inside.map(move |(column, row)| {
        let (a, b) = (share(column), share(row));
        let reference = if triangular { [a, b] } else { [2.0 * a - 1.0, 2.0 * b - 1.0] };
        kind.shape_functions(reference).values().to_vec()
    })
}

/// One place for each square of a grid over the picture, the nearest to its middle.
fn evenly(places: impl Iterator<Item = Candidate>, view: &View) -> Vec<Candidate> {
    let mut nearest: BTreeMap<(i64, i64), (f64, Candidate)> = BTreeMap::new();
    for place in places.filter(|place| view.shows(std::iter::once(place.position))) {
        let pixels = [view.pixels(place.position[0] - view.x.start), view.pixels(view.y.end - place.position[1])];
        let [column, row] = pixels.map(|pixel| (pixel / DISTANCE).floor());
        let away = (pixels[0] / DISTANCE - column - 0.5).hypot(pixels[1] / DISTANCE - row - 0.5);
        match nearest.get(&(column as i64, row as i64)) {
            Some((other, _)) if *other <= away => {}
            _ => {
                nearest.insert((column as i64, row as i64), (away, place));
            }
        }
    }
    nearest.into_values().map(|(_, place)| place).collect()
}

fn quantile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let index = (share * values.len() as f64).ceil() as usize;
    values.get(index.saturating_sub(1)).copied()
}

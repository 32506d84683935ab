//! Thickness of the concrete around a fibre.

use super::perpendicular_fibre::fibre_thickness;
use super::requirement::Requirements;
use crate::element::{ElementKind, MappedPoint};
use crate::mesh::{MeshDefinition, Part};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Range;

#[cfg(test)]
mod test;

/// An element is cut into so many pieces along each side where its mean thickness is taken.
const PIECES: usize = 8;

/// Relative difference below which a mean counts as the full thickness.
const ROUNDING: f64 = 1e-9;

/// Elements of the cover thinner than this share of the block are left out.
const THINNEST: f64 = 0.02;

/// A thickness that grows with the depth below the exit face.
// t(ξ) = min(t, φ + 2 m ξ) within `extent` of the exit, t beyond. With slope 1 the stiffness of the fibre in its block is within 14 % of that
// in space at 0 and 45°, along and across it, in blocks of 3 and 13 mm (`tests/reference/inclined_fibre`)
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GradedThickness {
    /// Spread of the cone to each side divided by its depth. 1 makes the fibre about as stiff in its block as in a 3-D
    /// one.
    #[schemars(range(min = 0.1))]
    pub slope: f64,
    /// Width of the graded zone on each side of the fibre's axis, along the face (default 2 φ + (t − φ)/2 · (1 + tan
    /// θ/slope)).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub extent: Option<f64>,
}

impl Default for GradedThickness {
    fn default() -> Self {
        Self { slope: 1.0, extent: None }
    }
}

/// Exit of a fibre from the block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exit {
    /// x of its axis at the face, mm.
    pub position: f64,
    /// φ, mm.
    pub diameter: f64,
    /// θ, rad.
    pub angle: f64,
}

/// The thickness of the block and of its cover at each place.
#[derive(Clone, Debug)]
pub(super) struct Thickness {
    /// t, mm.
    pub full: f64,
    /// One at least.
    pub exits: Vec<Exit>,
    /// `None`: the same everywhere.
    pub graded: Option<GradedThickness>,
}

impl Thickness {
    /// Checks the requirements of a cover and of a graded thickness.
    pub(super) fn check(&self, has_cover: bool, required: &mut Requirements) {
        let thickest = self.exits.iter().map(|exit| exit.diameter).fold(0.0, f64::max);
        let (holds, requirement) = if has_cover || self.graded.is_some() {
            let least = thickest / (1.0 - THINNEST);
            let what = "there must be concrete on both faces of the fibre";
            (self.full > least, format!("more than {least:.4}: {what}"))
        } else {
            let least = fibre_thickness(thickest);
            let what = format!("at least πφ/4 = {least:.4}, the thickness of the fibre that lies in the block");
            (self.full >= least * (1.0 - ROUNDING), what)
        };
        // a value that is not positive is reported already
        let is_reported = self.full.is_nan() || self.full <= 0.0;
        required.that(holds || is_reported, "matrix_thickness", self.full, requirement);
        if let Some(GradedThickness { slope, extent }) = self.graded {
            required.that(slope >= 0.1 && slope.is_finite(), "graded_thickness.slope", slope, "at least 0.1");
            if let Some(extent) = extent {
                required.positive([("graded_thickness.extent", extent)]);
            }
        }
    }

    /// Returns the part of the matrix on both faces of the fibres, out of plane.
    pub(super) fn cover(&self, matrix: Part) -> Part {
        Part { name: "cover".to_owned(), thickness: self.of_cover(self.exits[0]), ..matrix }
    }

    /// Returns the thickness of the cover of a fibre where nothing is graded, mm.
    fn of_cover(&self, exit: Exit) -> f64 {
        self.full - exit.diameter
    }

    /// Returns how far the graded thickness reaches from an axis along the face, mm.
    pub(super) fn extent(&self, exit: Exit) -> Option<f64> {
        let GradedThickness { slope, extent } = self.graded?;
        Some(extent.unwrap_or(2.0 * exit.diameter + 0.5 * self.of_cover(exit) * (1.0 + exit.angle.tan() / slope)))
    }

    /// Returns the thickness of the block at a place, mm: the least that the exits give.
    fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let near = self.exits.iter().filter(|exit| {
            let extent = self.extent(**exit);
            extent.is_some_and(|extent| (x - exit.position).abs() <= extent)
        });
        let slope = self.graded.map_or(0.0, |graded| graded.slope);
        near.map(|exit| exit.diameter + 2.0 * slope * (-y).max(0.0)).fold(self.full, f64::min)
    }

    /// The mean over an element of the block, mm.
    pub(super) fn mean(&self, kind: ElementKind, positions: &[[f64; 2]]) -> f64 {
        let (mut volume, mut area) = (0.0, 0.0);
        for coordinates in middles(kind) {
            let Ok(mapped) = MappedPoint::new(kind, positions, coordinates) else { continue };
            area += mapped.determinant;
            volume += mapped.determinant * self.at(mapped.position);
        }
        // an impossible element is reported later
        if area > 0.0 { volume / area } else { self.full }
    }

    /// Returns whether the cover of a fibre of this diameter is left out where the block has this thickness.
    pub(super) fn is_bare(&self, thickness: f64, diameter: f64) -> bool {
        thickness - diameter < THINNEST * self.full
    }

    /// Gives elements of block and cover their own thicknesses where these differ from their part's. `cover`: the
    /// elements on both faces of each fibre, and its diameter.
    pub(super) fn assign(&self, definition: &mut MeshDefinition, matrix: usize, cover: &[(Range<usize>, f64)]) {
        for (index, element) in definition.elements.iter().enumerate() {
            let diameter = match cover.iter().find(|(elements, _)| elements.contains(&index)) {
                Some((_, diameter)) => *diameter,
                None if element.part == matrix => 0.0,
                None => continue,
            };
            let positions: Vec<[f64; 2]> = element.nodes.iter().map(|&node| definition.nodes[node]).collect();
            let mean = if self.graded.is_some() { self.mean(element.kind, &positions) } else { self.full };
            if (mean - diameter - definition.parts[element.part].thickness).abs() > ROUNDING * self.full {
                definition.thicknesses.insert(index, mean - diameter);
            }
        }
    }

    /// Returns the notes for reports.
    pub(super) fn notes(&self, has_cover: bool) -> Vec<String> {
        let mut notes = Vec::new();
        for &exit in &self.exits {
            if has_cover {
                notes.push(format!(
                    "cover: matrix concrete on both faces of the fibre, {:.4} mm thick, joins both halves of the block",
                    self.of_cover(exit)
                ));
            }
            if let (Some(GradedThickness { slope, .. }), Some(extent)) = (self.graded, self.extent(exit)) {
                // where the block has its full thickness
                let depth = 0.5 * self.of_cover(exit) / slope;
                notes.push(format!(
                    "thickness of the matrix: from {} mm at the exit face to {} mm at a depth of {depth:.3} mm (slope {slope}), within {extent:.3} mm of the exit",
                    exit.diameter, self.full
                ));
            }
        }
        notes.dedup();
        notes
    }
}

/// The middles of the equal pieces of a reference element.
fn middles(kind: ElementKind) -> Vec<[f64; 2]> {
    let cells = (0..PIECES).flat_map(|row| (0..PIECES).map(move |column| [column as f64, row as f64]));
    let size = 1.0 / PIECES as f64;
    if kind.corner_count() == 4 {
        return cells.map(|cell| cell.map(|index| 2.0 * size * (index + 0.5) - 1.0)).collect();
    }
    // two triangles in each cell, one in each cell on the slope
    let triangles = cells.flat_map(|cell| [1.0, 2.0].map(|thirds| cell.map(|index| size * (index + thirds / 3.0))));
    triangles.filter(|[xi, eta]| xi + eta < 1.0).collect()
}

//! A fibre at an angle to the face that it is pulled out of.

mod axis;
mod check;
mod divisions;
mod outline;
mod sets;
#[cfg(test)]
mod test;

use std::f64::consts::PI;

use super::perpendicular_fibre::{FibreSection, PartMesh, section_notes};
use super::thickness::{GradedThickness, Thickness};
use super::{Specimen, SpecimenError};
use crate::element::ElementKind;
use crate::kinematics::PlaneModel;
use crate::mesh::Part;
use crate::mesh::structured::{Block, Grading, StructuredMesh};
use axis::Axis;
use divisions::Divisions;
use outline::Outline;

/// So much of the embedded fibre is meshed finely unless a length is given, in diameters.
pub const FINE_DIAMETERS: f64 = 5.0;

/// A round fibre in a block, at an angle to the normal of its exit face, for [`inclined_fibre`]. The default is the
/// initially bent fibre of chapter 7 at 45°.
#[derive(Clone, Debug, PartialEq)]
pub struct InclinedFibre {
    /// Inclination θ: the embedded fibre's angle from the outward normal of the exit face, rad.
    pub angle: f64,
    /// What the fibre does outside of the block.
    pub outside: Outside,
    /// The thickness that stands for the round section, equal area.
    pub section: FibreSection,
    /// Plane stress by default: in plane strain its axial stiffness would be 1/(1 − ν²) of the true one.
    pub fibre_model: PlaneModel,
    /// Plane strain by default.
    pub matrix_model: PlaneModel,
    /// Width of the block, 25.4 mm.
    pub width: f64,
    /// Depth of the block, 12.7 mm.
    pub depth: f64,
    /// Thickness of the block, 3.26 mm: the share of one fibre.
    pub matrix_thickness: f64,
    /// Whether there is concrete in front of and behind the fibre, no.
    pub cover: bool,
    /// How the thickness grows around the exit, not at all.
    pub graded_thickness: Option<GradedThickness>,
    /// Diameter φ of the fibre, 0.406 mm.
    pub fibre_diameter: f64,
    /// Embedded length along the fibre's axis, 12.2 mm.
    pub embedded_length: f64,
    /// Radius of the hole's edges at the exit face, mm; `None`: φ/4.
    pub exit_radius: Option<f64>,
    /// Length over which the fibre separates from the matrix at its exit (6.27), mm; 0: none.
    pub separation_length: f64,
    /// Elements of the fibre.
    pub fibre: PartMesh,
    /// Elements of the matrix: T6 or T3.
    pub matrix: PartMesh,
    /// Sizes.
    pub mesh: InclinedMesh,
}

/// What an inclined fibre does outside of the block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outside {
    /// It bends to the outward normal from the exit face on, and goes on along it (initially bent).
    Bent {
        /// Radius of its axis; `None`: 1.5 φ.
        radius: Option<f64>,
        /// Length after the bend, up to the grip, mm.
        length: f64,
    },
    /// It goes on along its axis (initially straight): 0 is loading at the exit (A), more is loading outside (B).
    Straight {
        /// Length from the face to the grip along the axis, mm.
        length: f64,
    },
}

/// Sizes of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InclinedMesh {
    /// All sizes are multiplied by this, 1.
    pub size: f64,
    /// Elements across the fibre, 2; not multiplied.
    pub elements_across: usize,
    /// Size along the fibre where it crosses the exit, mm; `None`: φ/4.
    pub exit_size: Option<f64>,
    /// So much of the fibre inside the block has this size, mm; `None`: [`FINE_DIAMETERS`] φ.
    pub fine_length: Option<f64>,
    /// Largest size along the fibre, 0.5 mm.
    pub largest_fibre_size: f64,
    /// By how much sizes grow per length along the fibre and away from it, 0.3.
    pub growth_rate: f64,
    /// Largest size, 2 mm.
    pub largest_size: f64,
}

impl Default for InclinedMesh {
    fn default() -> Self {
        Self {
            size: 1.0,
            elements_across: 2,
            exit_size: None,
            fine_length: None,
            largest_fibre_size: 0.5,
            growth_rate: 0.3,
            largest_size: 2.0,
        }
    }
}

impl Default for InclinedFibre {
    fn default() -> Self {
        Self {
            angle: 0.25 * PI,
            outside: Outside::Bent { radius: None, length: 3.0 },
            section: FibreSection::EqualArea,
            fibre_model: PlaneModel::PlaneStress,
            matrix_model: PlaneModel::PlaneStrain,
            width: 25.4,
            depth: 12.7,
            matrix_thickness: 3.26,
            cover: false,
            graded_thickness: None,
            fibre_diameter: 0.406,
            embedded_length: 12.2,
            exit_radius: None,
            separation_length: 0.0,
            fibre: PartMesh::default(),
            matrix: PartMesh { kind: ElementKind::T6, integration: None },
            mesh: InclinedMesh::default(),
        }
    }
}

#[doc = include_str!("doc.md")]
///
/// # Errors
///
/// All parameters that cannot be, or what keeps the block from being meshed.
pub fn inclined_fibre(parameters: &InclinedFibre) -> Result<Specimen, SpecimenError> {
    parameters.check()?;
    let divisions = Divisions::new(parameters)?;
    let mut mesh = StructuredMesh::default();
    let [fibre_part, matrix_part] = parameters.parts();
    let (fibre_part, matrix_part) = (mesh.add_part(fibre_part), mesh.add_part(matrix_part));
    let axis = parameters.axis();
    let map = |[s, left]: [f64; 2]| axis.point(s, left);
    let fibre =
        mesh.block(&Block::new(fibre_part, parameters.fibre.kind, &divisions.along, &divisions.across).mapped(&map))?;
    let outline = Outline::new(parameters, &divisions)?;

    // the middle between the fibre's sides: `check` has ruled out kinds without a node there
    let on_axis = |station: usize| fibre.node(2 * station, fibre.rows()).expect("the fibre has nodes on its axis");
    let (exit_node, tail_node) = (on_axis(divisions.exit_station), on_axis(0));
    mesh.node_set("exit", [exit_node]);
    mesh.node_set("tail", [tail_node]);
    mesh.node_set("fibre_axis", (0..divisions.along.len()).map(on_axis));
    sets::name_fibre_sets(&mut mesh, &fibre);
    let mut definition = mesh.definition();
    let (kind, largest_area) = (parameters.matrix.kind, parameters.largest_area());
    // each piece of the outline is an edge of a triangle
    let outer = outline.fill(&mut definition, matrix_part, kind, largest_area, &|_| true)?;
    let outer: Vec<_> = outer.into_iter().flatten().collect();
    let edges = outline.surfaces(&outer);
    let contact_pairs = sets::name_surfaces(&mut definition, &edges);
    let thickness = parameters.thickness();
    let cover_part = parameters.cover.then(|| {
        let [_, matrix] = parameters.parts();
        definition.parts.push(thickness.cover(matrix));
        definition.parts.len() - 1
    });
    if let Some(part) = cover_part {
        let channel = outline.channel(parameters, &definition, &outer)?;
        let is_there = |corners: &[[f64; 2]]| !thickness.is_bare(thickness.mean(ElementKind::T3, corners));
        channel.fill(&mut definition, part, kind, largest_area, &is_there)?;
    }
    thickness.assign(&mut definition, matrix_part, cover_part);
    let mut notes = section_notes(parameters.section, parameters.fibre_diameter, parameters.matrix_thickness);
    notes.extend(thickness.notes(parameters.cover));
    notes.extend(sets::name_supports(&mut definition, parameters, &edges));
    let couplings = match parameters.outside {
        // nothing holds the end of the fibre but its own section: it may turn
        Outside::Straight { length: 0.0 } => vec![sets::hang_on_a_node(&mut definition, &fibre)],
        _ => Vec::new(),
    };
    Ok(Specimen {
        definition,
        pull_direction: [0.0, 1.0],
        fibre_direction: parameters.angle.sin_cos().into(),
        contact_pairs,
        contact_width: Some(PI / 2.0 * parameters.fibre_diameter),
        exit_node,
        tail_node,
        couplings,
        notes,
    })
}

impl InclinedFibre {
    fn axis(&self) -> Axis {
        let bend_radius = match self.outside {
            Outside::Bent { radius, .. } => Some(radius.unwrap_or(1.5 * self.fibre_diameter)),
            Outside::Straight { .. } => None,
        };
        Axis { angle: self.angle, bend_radius }
    }

    /// Arc length of the grip from the exit, mm.
    fn outer_end(&self) -> f64 {
        match self.outside {
            Outside::Bent { length, .. } => self.axis().bend_end() + length,
            Outside::Straight { length } => length,
        }
    }

    fn exit_radius(&self) -> f64 {
        self.exit_radius.unwrap_or(0.25 * self.fibre_diameter)
    }

    fn exit_size(&self) -> f64 {
        self.mesh.size * self.mesh.exit_size.unwrap_or(0.25 * self.fibre_diameter)
    }

    fn fine_length(&self) -> f64 {
        self.mesh.fine_length.unwrap_or(FINE_DIAMETERS * self.fibre_diameter)
    }

    /// Twice an equilateral triangle of the largest size: refinement is asked for where the outline's sizes do not do it.
    fn largest_area(&self) -> f64 {
        let size = self.mesh.size * self.mesh.largest_size;
        0.866 * size * size
    }

    /// Size along the fibre at an arc length, mm.
    fn size_along(&self, s: f64) -> f64 {
        let fine_end = self.axis().bend_end() + 2.0 * self.fibre_diameter;
        let beyond = (-self.fine_length() - s).max(s - fine_end).max(0.0);
        (self.exit_size() + self.mesh.growth_rate * beyond).min(self.mesh.size * self.mesh.largest_fibre_size)
    }

    /// Size in the block at a point, mm.
    fn size_at(&self, [x, y]: [f64; 2]) -> f64 {
        let (sine, cosine) = self.angle.sin_cos();
        let s = (x * sine + y * cosine).clamp(-self.embedded_length, 0.0);
        let distance = ((x - s * sine).hypot(y - s * cosine) - 0.5 * self.fibre_diameter).max(0.0);
        let size = self.size_along(s) + self.mesh.growth_rate * distance;
        size.min(self.mesh.size * self.mesh.largest_size)
    }

    /// Fibre and matrix.
    fn parts(&self) -> [Part; 2] {
        let thickness = self.section.thickness(self.fibre_diameter);
        [
            Part { integration: self.fibre.integration, ..Part::new("fibre", self.fibre_model, thickness) },
            Part {
                integration: self.matrix.integration,
                ..Part::new("matrix", self.matrix_model, self.matrix_thickness)
            },
        ]
    }

    fn thickness(&self) -> Thickness {
        let Self { matrix_thickness, fibre_diameter, angle, graded_thickness, .. } = *self;
        Thickness { full: matrix_thickness, diameter: fibre_diameter, angle, graded: graded_thickness }
    }

    /// Positions across the fibre, from its right to its left side.
    fn positions_across(&self) -> Result<Vec<f64>, SpecimenError> {
        let (radius, count) = (0.5 * self.fibre_diameter, self.mesh.elements_across);
        let across = Grading::Uniform { count }.positions(2.0 * radius);
        let across = across.map_err(SpecimenError::along("mesh.elements_across"))?;
        Ok(across.into_iter().map(|left| left - radius).collect())
    }
}

//! A fibre perpendicular to the face that it is pulled out of.

mod check;
mod lines;
mod sets;

use std::f64::consts::PI;

use super::thickness::{Exit, GradedThickness, Thickness};
use super::{ContactSurfaces, PulledFibre, Specimen, SpecimenError, SurfaceRole};
use crate::element::ElementKind;
use crate::kinematics::PlaneModel;
use crate::mesh::structured::{Diagonal, Grid, MeshBlock};
use crate::mesh::{MeshDefinition, Part};
use crate::schema::{count, positive};
use lines::Lines;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Distance from the fibre to the start of support (b), in diameters.
pub(crate) const NEAR_CLEARANCE: f64 = 2.0;

/// Support (c) holds so much of the exit face, mm, from each side.
pub(crate) const AWAY_LENGTH: f64 = 3.0;

/// A round fibre in a block, perpendicular to its exit face, for [`perpendicular_fibre`]. The default is the specimen of
/// chapters 6 and 7.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
pub struct PerpendicularFibre {
    /// Plane or axisymmetric.
    #[serde(skip)]
    pub configuration: Configuration,
    /// Width of the block.
    #[schemars(schema_with = "positive")]
    pub width: f64,
    /// Depth of the block along the fibre.
    #[schemars(schema_with = "positive")]
    pub depth: f64,
    /// Thickness of the block.
    #[schemars(schema_with = "positive")]
    pub matrix_thickness: f64,
    /// Matrix concrete on both faces of the fibre, out of plane. It joins both halves of the block: part cover (plane
    /// only).
    pub cover: bool,
    /// Make the block as thick as the fibre at the exit face, and thicker with the depth below it: min(t, φ + 2 slope ·
    /// depth), as a cone around the fibre would be (default: the same thickness everywhere; plane only).
    pub graded_thickness: Option<GradedThickness>,
    /// Diameter of the fibre.
    #[schemars(schema_with = "positive")]
    pub fibre_diameter: f64,
    /// Embedded length.
    #[schemars(schema_with = "positive")]
    pub embedded_length: f64,
    /// Length outside the block, up to the grip.
    #[schemars(schema_with = "positive")]
    pub free_length: f64,
    /// Length by which the hole exceeds the fibre.
    #[schemars(range(min = 0.0))]
    pub tail_gap: f64,
    /// Elements of the fibre.
    pub fibre_element: ElementKind,
    /// Elements of the matrix.
    pub matrix_element: ElementKind,
    /// Sizes.
    #[serde(flatten)]
    pub mesh: FibreMesh,
}

/// Plane model of the specimen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Configuration {
    /// A slice with two contact lines and the true area of the fibre: the fibre in plane stress, as in plane strain its axial
    /// stiffness would be 1/(1 − ν²) of the true one, the matrix in plane strain.
    #[default]
    Plane,
    /// A body of revolution about the fibre's axis.
    Axisymmetric {
        /// Radius, mm; `None`: √(width · matrix_thickness/π), the same area.
        outer_radius: Option<f64>,
    },
}

/// The thickness of a plane fibre of height φ with the area of the circle, πφ/4, mm.
pub(super) fn fibre_thickness(diameter: f64) -> f64 {
    PI / 4.0 * diameter
}

/// Sizes of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
pub struct FibreMesh {
    /// Elements of the fibre along its embedded length.
    #[schemars(schema_with = "count")]
    pub embedded_elements: usize,
    /// Size at the exit face.
    // `None`: all are equal
    #[schemars(schema_with = "positive")]
    pub exit_size: Option<f64>,
    /// Elements across the fibre, or across its radius in axial symmetry.
    #[schemars(schema_with = "count")]
    pub elements_across: usize,
    /// Edges of the hole on each edge of the fibre.
    #[schemars(schema_with = "count")]
    pub slave_edges_per_master: usize,
    /// Size across the matrix at the hole.
    #[schemars(schema_with = "positive")]
    pub interface_size: f64,
    /// Ratio of each size to the one before it, away from the hole.
    #[schemars(schema_with = "positive")]
    pub growth: f64,
    /// Largest size.
    #[schemars(schema_with = "positive")]
    pub largest_size: f64,
}

impl Default for FibreMesh {
    fn default() -> Self {
        Self {
            embedded_elements: 40,
            exit_size: Some(0.15),
            elements_across: 2,
            slave_edges_per_master: 1,
            interface_size: 0.1,
            growth: 1.3,
            largest_size: 2.0,
        }
    }
}

impl Default for PerpendicularFibre {
    fn default() -> Self {
        Self {
            configuration: Configuration::Plane,
            width: 25.4,
            depth: 12.7,
            matrix_thickness: 3.26,
            cover: false,
            graded_thickness: None,
            fibre_diameter: 0.406,
            embedded_length: 12.2,
            free_length: 3.0,
            tail_gap: 0.0,
            fibre_element: ElementKind::Q8,
            matrix_element: ElementKind::Q8,
            mesh: FibreMesh::default(),
        }
    }
}

#[doc = include_str!("doc.md")]
///
/// # Errors
///
/// All parameters that cannot be, or the line that sizes do not divide.
pub fn perpendicular_fibre(parameters: &PerpendicularFibre) -> Result<Specimen, SpecimenError> {
    parameters.check()?;
    let lines = Lines::new(parameters)?;
    let mut mesh = MeshDefinition::default();
    let [fibre_part, matrix_part] = parameters.parts();
    let (fibre_part, matrix_part) = (mesh.add_part(fibre_part), mesh.add_part(matrix_part));

    let fibre = mesh.block(
        &MeshBlock::new(fibre_part, parameters.fibre_element, &lines.fibre_x, &lines.fibre_y)
            .cut(&|column, _| mirrored(&lines.fibre_x, column)),
    )?;
    let hole = |column: usize, row: usize| lines.middle_columns.contains(&column) && row >= lines.ligament_rows;
    let matrix = mesh.block(
        &MeshBlock::new(matrix_part, parameters.matrix_element, &lines.matrix_x, &lines.matrix_y)
            .keeping(&|column, row| !hole(column, row))
            .cut(&|column, _| mirrored(&lines.matrix_x, column)),
    )?;

    let thickness = parameters.thickness();
    let mut cover = Vec::new();
    if parameters.cover {
        let part = mesh.add_part(thickness.cover(mesh.parts[matrix_part].clone()));
        let first = mesh.elements.len();
        parameters.fill_hole(&mut mesh, part, &lines, &matrix)?;
        cover.push((first..mesh.elements.len(), parameters.fibre_diameter));
    }

    // `check` has ruled out kinds without a node on the axis.
    let axis_place = if parameters.is_axisymmetric() { 0 } else { fibre.columns };
    let at = |place: usize, row: usize| fibre.node(place, 2 * row).expect("the fibre has nodes on sides and axis");
    let on_axis = |row: usize| at(axis_place, row);
    let (exit_node, tail_node) = (on_axis(parameters.mesh.embedded_elements), on_axis(0));
    mesh.node_set("exit", [exit_node]);
    mesh.node_set("tail", [tail_node]);
    sets::name_outer_sets(&mut mesh, parameters, &fibre, &matrix, &lines);
    let contact_pairs = sets::name_surfaces(&mut mesh, parameters, &fibre, &matrix, &lines);
    let mut notes = Vec::new();
    if parameters.is_axisymmetric() {
        notes.push(format!("outer radius {:.4} mm", parameters.half_width()));
    }
    notes.extend(sets::name_supports_of_face(&mut mesh, parameters, &matrix));
    notes.extend(thickness.notes(parameters.cover));
    thickness.assign(&mut mesh, matrix_part, &cover);
    Ok(Specimen {
        definition: mesh,
        pull_direction: [0.0, 1.0],
        fibres: vec![PulledFibre {
            name: None,
            part: fibre_part,
            diameter: parameters.fibre_diameter,
            direction: [0.0, 1.0],
            exit_node,
            tail_node,
            stations: (0..=fibre.rows)
                .map(|row| [0, axis_place, 2 * fibre.columns].map(|place| at(place, row)))
                .collect(),
            end: ContactSurfaces {
                name: "end_tail".to_owned(),
                slave: "hole_end".to_owned(),
                master: "fibre_tail".to_owned(),
                role: SurfaceRole::End,
                width: (!parameters.is_axisymmetric()).then(|| fibre_thickness(parameters.fibre_diameter)),
            },
        }],
        contact_pairs,
        couplings: Vec::new(),
        notes,
    })
}

/// Diagonals that are the mirror image of each other on both sides of the axis.
fn mirrored(x: &[f64], column: usize) -> Diagonal {
    if x[column] + x[column + 1] < 0.0 { Diagonal::Falling } else { Diagonal::Rising }
}

impl PerpendicularFibre {
    fn is_axisymmetric(&self) -> bool {
        matches!(self.configuration, Configuration::Axisymmetric { .. })
    }

    /// Half of the block's width, or its radius.
    fn half_width(&self) -> f64 {
        match self.configuration {
            Configuration::Plane => 0.5 * self.width,
            Configuration::Axisymmetric { outer_radius } => {
                outer_radius.unwrap_or((self.width * self.matrix_thickness / PI).sqrt())
            }
        }
    }

    /// Fibre and matrix.
    fn parts(&self) -> [Part; 2] {
        let (models, fibre_thickness) = match self.configuration {
            Configuration::Plane => {
                ([PlaneModel::PlaneStress, PlaneModel::PlaneStrain], fibre_thickness(self.fibre_diameter))
            }
            // A thickness that nobody uses.
            Configuration::Axisymmetric { .. } => ([PlaneModel::Axisymmetric; 2], self.matrix_thickness),
        };
        [Part::new("fibre", models[0], fibre_thickness), Part::new("matrix", models[1], self.matrix_thickness)]
    }

    fn thickness(&self) -> Thickness {
        let Self { matrix_thickness, fibre_diameter, graded_thickness, .. } = *self;
        let exit = Exit { position: 0.0, diameter: fibre_diameter, angle: 0.0 };
        Thickness { full: matrix_thickness, exits: vec![exit], graded: graded_thickness }
    }

    /// Adds the cover: the cells of the block that the hole leaves out, on the nodes of its walls and its end.
    fn fill_hole(
        &self,
        mesh: &mut MeshDefinition,
        part: usize,
        lines: &Lines,
        matrix: &Grid,
    ) -> Result<(), SpecimenError> {
        let columns = &lines.middle_columns;
        let (x, y) = (&lines.matrix_x[columns.start..=columns.end], &lines.matrix_y[lines.ligament_rows..]);
        let thickness = self.thickness();
        let is_there = |column: usize, row: usize| {
            let [left, right, low, high] = [x[column], x[column + 1], y[row], y[row + 1]];
            let corners = [[left, low], [right, low], [right, high], [left, high]];
            !thickness.is_bare(thickness.mean(ElementKind::Q4, &corners), self.fibre_diameter)
        };
        let block = MeshBlock::new(part, self.matrix_element, x, y).keeping(&is_there);
        let nodes: Vec<usize> = matrix.nodes().collect();
        mesh.glued_block(&block.cut(&|column, _| mirrored(x, column)), &nodes)?;
        Ok(())
    }

    /// Returns where supports (b) and (c) begin, if the block is wide enough for them.
    fn support_limits(&self) -> [Option<f64>; 2] {
        let (radius, half) = (0.5 * self.fibre_diameter, self.half_width());
        [radius + NEAR_CLEARANCE * self.fibre_diameter, half - AWAY_LENGTH]
            .map(|limit| (limit > radius && limit < half).then_some(limit))
    }

    /// Returns where the divisions across the block stop: the hole, the supports' limits, the end of a graded thickness, the side.
    fn stops(&self) -> Vec<f64> {
        /// Limits closer to each other than this fraction of the half width are one: cells would be slivers.
        const MERGED: f64 = 1e-4;
        let (radius, half) = (0.5 * self.fibre_diameter, self.half_width());
        let mut limits: Vec<f64> = self.support_limits().into_iter().flatten().collect();
        let thickness = self.thickness();
        let extents = thickness.exits.iter().filter_map(|exit| thickness.extent(*exit));
        limits.extend(extents.filter(|extent| *extent > radius && *extent < half));
        limits.sort_by(f64::total_cmp);
        let mut stops = vec![radius];
        for limit in limits {
            if limit - stops[stops.len() - 1] > MERGED * half && half - limit > MERGED * half {
                stops.push(limit);
            }
        }
        stops.push(half);
        stops
    }
}

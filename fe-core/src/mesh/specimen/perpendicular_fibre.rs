#![doc = include_str!("perpendicular_fibre.md")]

use std::f64::consts::PI;

use super::requirement::Requirements;
use super::{ContactSurfaces, Specimen, SpecimenError};
use crate::element::{EdgeKind, ElementKind, Integration};
use crate::kinematics::PlaneModel;
use crate::mesh::structured::{Block, Diagonal, Grading, Grid, Side, StructuredMesh, capped_through};
use crate::mesh::{ElementEdge, Part};

/// Support (b) begins so many diameters beside the fibre.
pub const NEAR_CLEARANCE: f64 = 2.0;

/// Support (c) holds so much of the exit face, mm, from each side.
pub const AWAY_LENGTH: f64 = 3.0;

/// A fibre perpendicular to its exit face: a round one in a block; the default is the specimen of chapters 6 and 7.
#[derive(Clone, Debug, PartialEq)]
pub struct PerpendicularFibre {
    /// Plane or axisymmetric.
    pub configuration: Configuration,
    /// Width of the block, 25.4 mm.
    pub width: f64,
    /// Depth of the block along the fibre, 12.7 mm.
    pub depth: f64,
    /// Thickness of the block, 3.26 mm: the share of one fibre.
    pub matrix_thickness: f64,
    /// Diameter φ of the fibre, 0.406 mm.
    pub fibre_diameter: f64,
    /// Embedded length, 12.2 mm.
    pub embedded_length: f64,
    /// Length outside the block, up to the grip, 3 mm.
    pub free_length: f64,
    /// How much longer than the fibre the hole is, 0 mm.
    pub tail_gap: f64,
    /// Elements of the fibre.
    pub fibre: PartMesh,
    /// Elements of the matrix.
    pub matrix: PartMesh,
    /// Sizes.
    pub mesh: FibreMesh,
}

/// How the specimen becomes plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Configuration {
    /// A slice with two contact lines.
    Plane {
        /// The thickness that stands for the round section.
        section: FibreSection,
        /// Plane stress by default: in plane strain its axial stiffness would be 1/(1 − ν²) of the true one.
        fibre_model: PlaneModel,
        /// Plane strain by default.
        matrix_model: PlaneModel,
    },
    /// A body of revolution about the fibre's axis.
    Axisymmetric {
        /// Its radius, mm; `None`: √(width · matrix_thickness/π), the same area.
        outer_radius: Option<f64>,
    },
}

impl Configuration {
    /// A slice with the true area of the fibre, the fibre in plane stress and the matrix in plane strain.
    pub const PLANE: Self = Self::Plane {
        section: FibreSection::EqualArea,
        fibre_model: PlaneModel::PlaneStress,
        matrix_model: PlaneModel::PlaneStrain,
    };
}

/// The thickness of a plane fibre of height φ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FibreSection {
    /// πφ/4: the area of the circle.
    EqualArea,
    /// 3πφ/16: the moment of inertia of the circle.
    EqualInertia,
    /// This thickness, mm.
    Thickness(f64),
}

impl FibreSection {
    /// The thickness of a fibre of this diameter, mm.
    pub fn thickness(self, diameter: f64) -> f64 {
        match self {
            Self::EqualArea => PI / 4.0 * diameter,
            Self::EqualInertia => 3.0 * PI / 16.0 * diameter,
            Self::Thickness(thickness) => thickness,
        }
    }
}

/// The elements of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartMesh {
    /// Their kind, Q8 by default.
    pub kind: ElementKind,
    /// Their integration; `None`: the kind's default.
    pub integration: Option<Integration>,
}

impl Default for PartMesh {
    fn default() -> Self {
        Self { kind: ElementKind::Q8, integration: None }
    }
}

/// Sizes of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreMesh {
    /// Elements of the fibre along its embedded length, 40.
    pub embedded_elements: usize,
    /// Their size at the exit face, 0.15 mm; `None`: all equal.
    pub exit_size: Option<f64>,
    /// Elements across the fibre (across its radius in axial symmetry), 2.
    pub elements_across: usize,
    /// Edges of the hole on each edge of the fibre, 1.
    pub slave_edges_per_master: usize,
    /// Size across the matrix at the hole, 0.1 mm.
    pub interface_size: f64,
    /// Each size over the one before it, away from the hole, 1.3.
    pub growth: f64,
    /// Largest size, 2 mm.
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
            configuration: Configuration::PLANE,
            width: 25.4,
            depth: 12.7,
            matrix_thickness: 3.26,
            fibre_diameter: 0.406,
            embedded_length: 12.2,
            free_length: 3.0,
            tail_gap: 0.0,
            fibre: PartMesh::default(),
            matrix: PartMesh::default(),
            mesh: FibreMesh::default(),
        }
    }
}

/// Makes the specimen; see this module's page for its shape, its sets and its axes.
///
/// # Errors
///
/// All parameters that cannot be, or the line that sizes do not divide.
pub fn perpendicular_fibre(parameters: &PerpendicularFibre) -> Result<Specimen, SpecimenError> {
    parameters.check()?;
    let lines = Lines::new(parameters)?;
    let mut mesh = StructuredMesh::default();
    let [fibre_part, matrix_part] = parameters.parts();
    let (fibre_part, matrix_part) = (mesh.add_part(fibre_part), mesh.add_part(matrix_part));

    let fibre = mesh.block(
        &Block::new(fibre_part, parameters.fibre.kind, &lines.fibre_x, &lines.fibre_y)
            .cut(&|column, _| mirrored(&lines.fibre_x, column)),
    )?;
    let hole = |column: usize, row: usize| lines.middle_columns.contains(&column) && row >= lines.ligament_rows;
    let matrix = mesh.block(
        &Block::new(matrix_part, parameters.matrix.kind, &lines.matrix_x, &lines.matrix_y)
            .keeping(&|column, row| !hole(column, row))
            .cut(&|column, _| mirrored(&lines.matrix_x, column)),
    )?;

    // `check` has ruled out kinds without a node on the axis.
    let axis_place = if parameters.is_axisymmetric() { 0 } else { fibre.columns() };
    let on_axis = |row: usize| fibre.node(axis_place, 2 * row).expect("the fibre has nodes on its axis");
    let (exit_node, tail_node) = (on_axis(parameters.mesh.embedded_elements), on_axis(0));
    mesh.node_set("exit", [exit_node]);
    mesh.node_set("tail", [tail_node]);
    name_outer_sets(&mut mesh, parameters, &fibre, &matrix, &lines);
    let contact_pairs = name_surfaces(&mut mesh, parameters, &fibre, &matrix, &lines);
    let mut notes = parameters.notes();
    notes.extend(name_supports_of_face(&mut mesh, parameters, &matrix));
    let contact_width = (!parameters.is_axisymmetric()).then_some(PI / 2.0 * parameters.fibre_diameter);
    Ok(Specimen {
        definition: mesh.definition(),
        pull_direction: [0.0, 1.0],
        contact_pairs,
        contact_width,
        exit_node,
        tail_node,
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
            Configuration::Plane { .. } => 0.5 * self.width,
            Configuration::Axisymmetric { outer_radius } => {
                outer_radius.unwrap_or((self.width * self.matrix_thickness / PI).sqrt())
            }
        }
    }

    fn check(&self) -> Result<(), SpecimenError> {
        let mut required = Requirements::default();
        for (name, value) in [
            ("width", self.width),
            ("depth", self.depth),
            ("matrix_thickness", self.matrix_thickness),
            ("fibre_diameter", self.fibre_diameter),
            ("embedded_length", self.embedded_length),
            ("free_length", self.free_length),
            ("mesh.interface_size", self.mesh.interface_size),
            ("mesh.largest_size", self.mesh.largest_size),
        ] {
            required.positive(name, value);
        }
        let (gap, hole_depth) = (self.tail_gap, self.embedded_length + self.tail_gap);
        required.that(gap >= 0.0 && gap.is_finite(), "tail_gap", gap, "0 or positive");
        required.that(
            hole_depth < self.depth,
            "embedded_length + tail_gap",
            hole_depth,
            format!("less than the depth {}: the ligament below the hole holds the halves together", self.depth),
        );
        required.that(
            self.half_width() > 0.5 * self.fibre_diameter,
            "half of the width (the outer radius)",
            self.half_width(),
            format!("more than half of the fibre_diameter, {}", 0.5 * self.fibre_diameter),
        );
        self.check_configuration(&mut required);
        let mesh = &self.mesh;
        required.count("mesh.embedded_elements", mesh.embedded_elements);
        required.count("mesh.elements_across", mesh.elements_across);
        required.count("mesh.slave_edges_per_master", mesh.slave_edges_per_master);
        required.that(mesh.growth >= 1.0 && mesh.growth.is_finite(), "mesh.growth", mesh.growth, "at least 1");
        if let Some(size) = mesh.exit_size {
            let fits = size > 0.0 && size < self.embedded_length;
            let requirement = format!("positive and less than the embedded_length {}", self.embedded_length);
            required.that(fits, "mesh.exit_size", size, requirement);
        }
        let middle = self.fibre.kind.edge_kind() == EdgeKind::Quadratic || mesh.elements_across.is_multiple_of(2);
        required.that(
            self.is_axisymmetric() || middle,
            "mesh.elements_across",
            mesh.elements_across,
            format!("even with {}: the fibre needs nodes on its axis", self.fibre.kind),
        );
        required.check()
    }

    fn check_configuration(&self, required: &mut Requirements) {
        match self.configuration {
            Configuration::Plane { section, fibre_model, matrix_model } => {
                for (name, model) in [("fibre_model", fibre_model), ("matrix_model", matrix_model)] {
                    let plane = model != PlaneModel::Axisymmetric;
                    required.that(plane, name, "axisymmetric", "plane stress or plane strain in a plane configuration");
                }
                if let FibreSection::Thickness(thickness) = section {
                    required.positive("fibre_section", thickness);
                }
            }
            Configuration::Axisymmetric { outer_radius } => {
                if let Some(radius) = outer_radius {
                    required.positive("outer_radius", radius);
                }
            }
        }
    }

    /// Fibre and matrix.
    fn parts(&self) -> [Part; 2] {
        let (models, fibre_thickness) = match self.configuration {
            Configuration::Plane { section, fibre_model, matrix_model } => {
                ([fibre_model, matrix_model], section.thickness(self.fibre_diameter))
            }
            // A thickness that nobody uses.
            Configuration::Axisymmetric { .. } => ([PlaneModel::Axisymmetric; 2], self.matrix_thickness),
        };
        [
            Part { integration: self.fibre.integration, ..Part::new("fibre", models[0], fibre_thickness) },
            Part { integration: self.matrix.integration, ..Part::new("matrix", models[1], self.matrix_thickness) },
        ]
    }

    fn notes(&self) -> Vec<String> {
        let phi = self.fibre_diameter;
        match self.configuration {
            Configuration::Plane { section, .. } => {
                let thickness = section.thickness(phi);
                let (area, inertia) = (thickness / (PI / 4.0 * phi), thickness / (3.0 * PI / 16.0 * phi));
                vec![
                    format!(
                        "fibre: height {phi} mm, thickness {thickness:.4} mm; area {area:.3} and bending inertia {inertia:.3} of the round one"
                    ),
                    format!(
                        "contact width {:.4} mm per line on a matrix of thickness {} mm: the pressure of the contact is not the traction of the matrix",
                        PI / 2.0 * phi,
                        self.matrix_thickness
                    ),
                ]
            }
            Configuration::Axisymmetric { .. } => vec![format!("outer radius {:.4} mm", self.half_width())],
        }
    }

    /// Where supports (b) and (c) begin, if the block is wide enough for them.
    fn support_limits(&self) -> [Option<f64>; 2] {
        let (radius, half) = (0.5 * self.fibre_diameter, self.half_width());
        [radius + NEAR_CLEARANCE * self.fibre_diameter, half - AWAY_LENGTH]
            .map(|limit| (limit > radius && limit < half).then_some(limit))
    }

    /// Where the divisions across the block stop: the hole, the supports' limits, the side.
    fn stops(&self) -> Vec<f64> {
        /// Limits closer to each other than this fraction of the half width are one: cells would be slivers.
        const MERGED: f64 = 1e-4;
        let (radius, half) = (0.5 * self.fibre_diameter, self.half_width());
        let mut limits: Vec<f64> = self.support_limits().into_iter().flatten().collect();
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

/// The divisions of all lines.
struct Lines {
    fibre_x: Vec<f64>,
    /// From the tail to the grip.
    fibre_y: Vec<f64>,
    matrix_x: Vec<f64>,
    /// From the bottom to the exit face.
    matrix_y: Vec<f64>,
    /// Columns of the matrix below the fibre.
    middle_columns: std::ops::Range<usize>,
    /// Rows of the matrix below the hole's end.
    ligament_rows: usize,
    /// Rows of the matrix below the fibre's end.
    rows_below_fibre: usize,
}

impl Lines {
    fn new(parameters: &PerpendicularFibre) -> Result<Self, SpecimenError> {
        let (matrix_x, middle_columns) = matrix_x(parameters)?;
        let radius = 0.5 * parameters.fibre_diameter;
        let across = Grading::Uniform { count: parameters.mesh.elements_across };
        let fibre_x = if parameters.is_axisymmetric() {
            across.positions(radius)
        } else {
            across.positions(2.0 * radius).map(|x| x.into_iter().map(|x| x - radius).collect())
        }
        .map_err(SpecimenError::along("elements across the fibre"))?;
        let masters = embedded_depths(parameters)?;
        let slaves = subdivided(&masters, parameters.mesh.slave_edges_per_master);
        let (gap, ligament) = depths_below(parameters, &slaves)?;
        let matrix_depths = [&slaves[..], &gap, &ligament].concat();
        let free = free_heights(parameters, &masters)?;
        Ok(Self {
            fibre_x,
            fibre_y: masters.iter().rev().map(|depth| 0.0 - depth).chain(free).collect(),
            matrix_x,
            matrix_y: matrix_depths.iter().rev().map(|depth| 0.0 - depth).collect(),
            middle_columns,
            ligament_rows: ligament.len(),
            rows_below_fibre: ligament.len() + gap.len(),
        })
    }
}

/// Across the matrix, and the columns that lie below the fibre.
fn matrix_x(parameters: &PerpendicularFibre) -> Result<(Vec<f64>, std::ops::Range<usize>), SpecimenError> {
    let radius = 0.5 * parameters.fibre_diameter;
    let mesh = &parameters.mesh;
    let right = capped_through(&parameters.stops(), mesh.interface_size, mesh.growth, mesh.largest_size)
        .map_err(SpecimenError::along("mesh sizes across the matrix"))?;
    let middle_width = if parameters.is_axisymmetric() { radius } else { 2.0 * radius };
    // Not coarser than beside the hole, nor than the fibre.
    let count = ((middle_width / mesh.interface_size).ceil() as usize).max(mesh.elements_across);
    let middle = Grading::Uniform { count }
        .positions(middle_width)
        .map_err(SpecimenError::along("mesh.interface_size below the fibre"))?;
    let inner = &middle[1..count];
    if parameters.is_axisymmetric() {
        let x = [&[0.0], inner, &right].concat();
        return Ok((x, 0..count));
    }
    let left: Vec<f64> = right.iter().rev().map(|x| -x).collect();
    let inner: Vec<f64> = inner.iter().map(|x| x - radius).collect();
    let start = left.len() - 1;
    Ok(([left, inner, right].concat(), start..start + count))
}

/// Depths of the fibre's nodes below the exit face, from 0 to the embedded length.
fn embedded_depths(parameters: &PerpendicularFibre) -> Result<Vec<f64>, SpecimenError> {
    let count = parameters.mesh.embedded_elements;
    let grading = match parameters.mesh.exit_size {
        Some(first) if count > 1 => Grading::First { count, first },
        _ => Grading::Uniform { count },
    };
    grading
        .positions(parameters.embedded_length)
        .map_err(SpecimenError::along("mesh.exit_size and mesh.embedded_elements along the fibre"))
}

/// Each division into `count` equal ones; the positions given stay bit by bit.
fn subdivided(positions: &[f64], count: usize) -> Vec<f64> {
    let mut fine = Vec::with_capacity((positions.len() - 1) * count + 1);
    for pair in positions.windows(2) {
        fine.extend((0..count).map(|part| pair[0] + (pair[1] - pair[0]) * part as f64 / count as f64));
    }
    fine.push(positions[positions.len() - 1]);
    fine
}

/// Depths below the fibre's end: of the gap behind it and of the ligament, each without its start.
fn depths_below(parameters: &PerpendicularFibre, slaves: &[f64]) -> Result<(Vec<f64>, Vec<f64>), SpecimenError> {
    let PerpendicularFibre { depth, embedded_length, tail_gap, ref mesh, .. } = *parameters;
    let size = slaves[slaves.len() - 1] - slaves[slaves.len() - 2];
    let below = |start: f64, end: f64, least: f64| {
        let length = end - start;
        let first = size.min(length / least);
        let sizes = Grading::Capped { first, growth: mesh.growth, largest: mesh.largest_size.min(length / least) };
        let mut depths: Vec<f64> =
            sizes.positions(length).map_err(SpecimenError::along("mesh sizes below the fibre"))?[1..]
                .iter()
                .map(|depth| start + depth)
                .collect();
        // Exactly, whatever start + length rounds to.
        depths.pop();
        depths.push(end);
        Ok::<_, SpecimenError>(depths)
    };
    let hole_depth = embedded_length + tail_gap;
    let gap = if tail_gap > 0.0 { below(embedded_length, hole_depth, 1.0)? } else { vec![] };
    // One element would not bend.
    Ok((gap, below(hole_depth, depth, 2.0)?))
}

/// Heights of the fibre's nodes above the exit face, without 0.
fn free_heights(parameters: &PerpendicularFibre, masters: &[f64]) -> Result<Vec<f64>, SpecimenError> {
    let PerpendicularFibre { free_length, ref mesh, .. } = *parameters;
    let sizes = Grading::Capped { first: masters[1], growth: mesh.growth, largest: mesh.largest_size };
    let heights = sizes.positions(free_length).map_err(SpecimenError::along("mesh sizes along the free length"))?;
    Ok(heights[1..].to_vec())
}

/// Grip, sides or outer surface and axis, bottom.
fn name_outer_sets(
    mesh: &mut StructuredMesh,
    parameters: &PerpendicularFibre,
    fibre: &Grid,
    matrix: &Grid,
    lines: &Lines,
) {
    mesh.node_set("grip", fibre.side_nodes(Side::Top));
    mesh.node_set("bottom", matrix.side_nodes(Side::Bottom));
    if parameters.is_axisymmetric() {
        mesh.node_set("outer", matrix.side_nodes(Side::Right));
        mesh.node_set("axis", fibre.side_nodes(Side::Left));
        mesh.node_set("axis", (0..=2 * lines.ligament_rows).filter_map(|j| matrix.node(0, j)));
    } else {
        mesh.node_set("sides", matrix.side_nodes(Side::Left));
        mesh.node_set("sides", matrix.side_nodes(Side::Right));
    }
}

/// The edge sets; returns the contact pairs.
fn name_surfaces(
    mesh: &mut StructuredMesh,
    parameters: &PerpendicularFibre,
    fibre: &Grid,
    matrix: &Grid,
    lines: &Lines,
) -> Vec<ContactSurfaces> {
    let (first, end, top) = (lines.middle_columns.start, lines.middle_columns.end, matrix.rows() - 1);
    let face = [matrix.row_edges(end..matrix.columns(), top, Side::Top), matrix.row_edges(0..first, top, Side::Top)];
    mesh.edge_set("exit_face", face.concat());
    mesh.edge_set("bottom_face", matrix.side_edges(Side::Bottom));
    mesh.edge_set("fibre_tail", fibre.side_edges(Side::Bottom));
    mesh.edge_set("hole_end", matrix.row_edges(first..end, lines.ligament_rows - 1, Side::Top));
    let along = lines.rows_below_fibre..matrix.rows();
    let mut pair = |name: &str, hole: (&str, Vec<ElementEdge>), surface: (&str, Side)| {
        mesh.edge_set(hole.0, hole.1);
        mesh.edge_set(surface.0, fibre.side_edges(surface.1));
        ContactSurfaces { name: name.to_owned(), slave: hole.0.to_owned(), master: surface.0.to_owned() }
    };
    let right_wall = matrix.column_edges(end, along.clone(), Side::Left);
    if parameters.is_axisymmetric() {
        return vec![pair("interface", ("hole_surface", right_wall), ("fibre_surface", Side::Right))];
    }
    let left_wall = matrix.column_edges(first - 1, along, Side::Right);
    vec![
        pair("interface_left", ("hole_left", left_wall), ("fibre_left", Side::Left)),
        pair("interface_right", ("hole_right", right_wall), ("fibre_right", Side::Right)),
    ]
}

/// Supports (b) and (c); returns what is missing.
fn name_supports_of_face(mesh: &mut StructuredMesh, parameters: &PerpendicularFibre, matrix: &Grid) -> Vec<String> {
    let mut missing = Vec::new();
    for (name, limit) in std::iter::zip(["face_near", "face_away"], parameters.support_limits()) {
        match limit {
            Some(limit) => {
                // Nodes lie on the stops to the bit.
                let distance = |stop: &f64| (stop - limit).abs();
                let stops = parameters.stops().into_iter();
                let reach = stops.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(limit);
                let face = matrix.side_nodes(Side::Top);
                let nodes: Vec<usize> = face.into_iter().filter(|&node| mesh.nodes()[node][0].abs() >= reach).collect();
                mesh.node_set(name, nodes);
            }
            None => missing.push(format!("the block is too narrow for the support '{name}'")),
        }
    }
    missing
}

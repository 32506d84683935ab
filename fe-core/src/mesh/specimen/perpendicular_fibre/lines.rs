//! The divisions of a fibre and of the block around it.

use super::PerpendicularFibre;
use crate::mesh::specimen::{SpecimenError, positions, uniform};
use crate::mesh::structured::{Grading, capped_through};

/// The divisions of all lines.
pub(super) struct Lines {
    pub(super) fibre_x: Vec<f64>,
    /// Fibre y from the tail to the grip.
    pub(super) fibre_y: Vec<f64>,
    pub(super) matrix_x: Vec<f64>,
    /// Matrix y from the bottom to the exit face.
    pub(super) matrix_y: Vec<f64>,
    /// Columns of the matrix below the fibre.
    pub(super) middle_columns: std::ops::Range<usize>,
    /// Rows of the matrix below the hole's end.
    pub(super) ligament_rows: usize,
    /// Rows of the matrix below the fibre's end.
    pub(super) rows_below_fibre: usize,
}

impl Lines {
    pub(super) fn new(parameters: &PerpendicularFibre) -> Result<Self, SpecimenError> {
        let (matrix_x, middle_columns) = matrix_x(parameters)?;
        let fibre_x = fibre_x(parameters)?;
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

/// Across the fibre; the mirror image of itself to the bit where it has a node on the axis.
fn fibre_x(parameters: &PerpendicularFibre) -> Result<Vec<f64>, SpecimenError> {
    let (radius, count) = (0.5 * parameters.fibre_diameter, parameters.mesh.elements_across);
    let line = "elements_across";
    Ok(if parameters.is_axisymmetric() {
        uniform(radius, count, line)?
    } else if count.is_multiple_of(2) {
        with_mirror_image(&uniform(radius, count / 2, line)?)
    } else {
        uniform(2.0 * radius, count, line)?.into_iter().map(|x| x - radius).collect()
    })
}

/// Positions from 0 on, and the same to the left of 0.
fn with_mirror_image(positions: &[f64]) -> Vec<f64> {
    positions[1..].iter().rev().map(|x| -x).chain(positions.iter().copied()).collect()
}

/// Across the matrix, and the columns that lie below the fibre.
fn matrix_x(parameters: &PerpendicularFibre) -> Result<(Vec<f64>, std::ops::Range<usize>), SpecimenError> {
    let radius = 0.5 * parameters.fibre_diameter;
    let mesh = &parameters.mesh;
    let right = capped_through(&parameters.stops(), mesh.interface_size, mesh.growth, mesh.largest_size)
        .map_err(SpecimenError::along("mesh sizes across the matrix"))?;
    // Below the fibre no element is wider than next to the hole, nor than in the fibre.
    let across = if parameters.is_axisymmetric() { mesh.elements_across } else { mesh.elements_across.div_ceil(2) };
    let count = ((radius / mesh.interface_size).ceil() as usize).max(across);
    let mut half = uniform(radius, count, "interface_size below the fibre")?;
    half.extend(&right[1..]);
    if parameters.is_axisymmetric() {
        return Ok((half, 0..count));
    }
    let start = right.len() - 1;
    Ok((with_mirror_image(&half), start..start + 2 * count))
}

/// Depths of the fibre's nodes below the exit face, from 0 to the embedded length.
fn embedded_depths(parameters: &PerpendicularFibre) -> Result<Vec<f64>, SpecimenError> {
    let count = parameters.mesh.embedded_elements;
    let grading = match parameters.mesh.exit_size {
        Some(first) if count > 1 => Grading::First { count, first },
        _ => Grading::Uniform { count },
    };
    positions(parameters.embedded_length, grading, "exit_size and embedded_elements along the fibre")
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

/// Returns the depths below the fibre's end: in the gap at its tail and in the ligament, each without its start.
fn depths_below(parameters: &PerpendicularFibre, slaves: &[f64]) -> Result<(Vec<f64>, Vec<f64>), SpecimenError> {
    let PerpendicularFibre { depth, embedded_length, tail_gap, ref mesh, .. } = *parameters;
    let size = slaves[slaves.len() - 1] - slaves[slaves.len() - 2];
    let below = |start: f64, end: f64, least: f64| {
        let length = end - start;
        let first = size.min(length / least);
        let sizes = Grading::Capped { first, growth: mesh.growth, largest: mesh.largest_size.min(length / least) };
        let depths = positions(length, sizes, "mesh sizes below the fibre")?;
        // the end exactly, whatever start + length rounds to
        let inner = depths[1..depths.len() - 1].iter().map(|depth| start + depth);
        Ok::<_, SpecimenError>(inner.chain([end]).collect::<Vec<f64>>())
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
    Ok(positions(free_length, sizes, "mesh sizes along the free length")?[1..].to_vec())
}

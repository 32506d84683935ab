//! The stations along a fibre and its hole.

use super::{Fibres, Laid};
use crate::mesh::MeshError;
use crate::mesh::specimen::requirement::Requirements;
use crate::mesh::specimen::{SpecimenError, uniform};
use crate::mesh::structured::{MOST_DIVISIONS, too_many};

/// Stations closer than this × the size there are one.
const MERGED: f64 = 0.3;
/// Pieces of a line over which the size is integrated.
const SAMPLES: usize = 400;
/// The beginning of an exit's edge is looked for up to so many diameters, and embedded lengths, from the exit.
const EXIT_REACH: f64 = 30.0;
/// Least radius of a rounded edge that begins at the exit, relative to how close to it edges are merged.
const LEAST_EXIT: f64 = 1e-3;

/// The edge of a wall of the hole at the exit face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ExitEdge {
    /// Arc length of the axis where the wall ends and the edge begins, mm.
    pub(super) start: f64,
    /// Radius, mm.
    pub(super) radius: f64,
}

/// The divisions of fibre and hole, as arc lengths of the axis from the exit.
#[derive(Debug)]
pub(super) struct Divisions {
    /// Places along the fibre, from the tail to the grip.
    pub(super) along: Vec<f64>,
    /// Across the fibre, as shares of its width from its right to its left side.
    pub(super) across: Vec<f64>,
    /// The station of the exit in `along`.
    pub(super) exit_station: usize,
    /// The exit edges of the left and the right wall.
    pub(super) exit_edges: [ExitEdge; 2],
}

impl Divisions {
    pub(super) fn new(parameters: &Fibres, laid: &Laid<'_>) -> Result<Self, SpecimenError> {
        let exit_edges = exit_edges(parameters, laid)?;
        let tail = -laid.fibre.embedded_length;
        let end = if laid.hangs() { 0.0 } else { laid.path.end() };
        let mut stops = vec![tail, 0.0, end];
        stops.extend(exit_edges.iter().map(|edge| edge.start).filter(|start| *start < end));
        // nodes where the curvature changes inside the block
        for at in laid.path.curves().flat_map(|(ends, _)| ends) {
            let close = MERGED * parameters.size_along(laid, at);
            if at < 0.0 && stops.iter().all(|stop| (stop - at).abs() > close) {
                stops.push(at);
            }
        }
        stops.sort_by(f64::total_cmp);
        stops.dedup();
        let mut along = vec![tail];
        for ends in stops.windows(2) {
            let pieces = divided(ends[1] - ends[0], &|distance| parameters.size_along(laid, ends[0] + distance));
            let pieces = pieces.map_err(SpecimenError::along("mesh sizes along the fibre"))?;
            let inner = pieces.len() - 2;
            along.extend(pieces[1..=inner].iter().map(|distance| ends[0] + distance));
            along.push(ends[1]);
        }
        let exit_station = along.iter().position(|&s| s == 0.0).expect("the exit is a stop");
        let shares = uniform(1.0, parameters.mesh.elements_across, "elements_across")?;
        let across = shares.into_iter().map(|share| share - 0.5).collect();
        Ok(Self { along, across, exit_station, exit_edges })
    }

    /// The stations of a wall from the tail to where it or the fibre ends.
    pub(super) fn wall(&self, edge: ExitEdge) -> &[f64] {
        let end = self.along.partition_point(|&s| s <= edge.start);
        &self.along[..end]
    }
}

/// The exit edges of both walls. Where an edge begins close to the exit, to the other one or to the end of the fibre it begins
/// there, with another radius, so that no element is a sliver.
fn exit_edges(parameters: &Fibres, laid: &Laid<'_>) -> Result<[ExitEdge; 2], SpecimenError> {
    let Laid { fibre, path, .. } = laid;
    let close = MERGED * parameters.exit_size(fibre);
    let half = 0.5 * fibre.diameter;
    let reach = EXIT_REACH * fibre.diameter;
    let start = |offset: f64| {
        // a fibre may be so near the direction of the exit face that its hole has no edge there
        path.exit_start(offset, fibre.exit_radius(), reach).ok_or_else(|| {
            let name = fibre.name.as_ref().map_or_else(String::new, |name| format!(" '{name}'"));
            MeshError(format!("no rounded edge touches both the exit face and the hole of the fibre{name}"))
        })
    };
    let (left, right) = (start(half)?, start(-half)?);
    let (mut left, mut right) = if (left - right).abs() < close {
        let middle = 0.5 * (left + right);
        (middle, middle)
    } else {
        (left, right)
    };
    // the end of a fibre that is straight from the exit on
    let end = if path.curves().any(|([_, to], _)| to > 0.0) { 0.0 } else { path.end() };
    for start in [&mut left, &mut right] {
        for stop in [0.0, end] {
            if (*start - stop).abs() < close {
                *start = stop;
            }
        }
    }
    let edges = [(left, half), (right, -half)]
        .map(|(start, offset)| ExitEdge { start, radius: path.exit_radius(offset, start) });
    let index = parameters.fibres.iter().position(|other| other.name.is_some() && other.name == fibre.name);
    let mut required = Requirements::default();
    required.of(index);
    let requirement = format!("more than {close:.4}, a part of the size of elements at the exit");
    required.that(
        edges.iter().all(|edge| edge.radius > LEAST_EXIT * close),
        "exit_radius",
        fibre.exit_radius(),
        requirement,
    );
    required.check().map(|()| edges)
}

/// Distances from 0 to `length` that divide a line into pieces of a size that changes along it: n is ∫ds/h, rounded, and each
/// piece has the same share of it.
pub(super) fn divided(length: f64, size: &dyn Fn(f64) -> f64) -> Result<Vec<f64>, MeshError> {
    let at = |sample: usize| length * sample as f64 / SAMPLES as f64;
    let sizes: Vec<f64> = (0..=SAMPLES).map(|sample| size(at(sample))).collect();
    let mut shares = vec![0.0];
    for sample in 0..SAMPLES {
        let share = 0.5 * (at(sample + 1) - at(sample)) * (1.0 / sizes[sample] + 1.0 / sizes[sample + 1]);
        shares.push(shares[sample] + share);
    }
    let whole = shares[SAMPLES];
    let count = whole.round().max(1.0);
    if count.is_nan() || count > MOST_DIVISIONS as f64 {
        return Err(too_many(count, length));
    }
    let count = count as usize;
    let mut positions = vec![0.0];
    for piece in 1..count {
        let share = whole * piece as f64 / count as f64;
        let after = shares.partition_point(|&s| s < share);
        let within = (share - shares[after - 1]) / (shares[after] - shares[after - 1]);
        positions.push(at(after - 1) + within * (at(after) - at(after - 1)));
    }
    positions.push(length);
    Ok(positions)
}

//! The outline of the block with its hole, and the triangles in it.

use std::collections::{BTreeMap, HashMap};

use super::divisions::{Divisions, ExitEdge, divided};
use super::{Fibres, Laid, sets};
use crate::element::ElementKind;
use crate::mesh::specimen::SpecimenError;
use crate::mesh::triangulation::triangulate;
use crate::mesh::{ElementDefinition, ElementEdge, MeshDefinition};
use crate::plane::{distance, dot, minus};
use std::f64::consts::FRAC_PI_2;

/// An edge of a rounded exit turns by at most this.
const EXIT_TURN: f64 = 0.45;
/// Edges of a rounded exit at least.
const EXIT_EDGES: usize = 4;
/// det J at a corner that a curved edge would close, relative to that of straight edges.
const WIDENED: f64 = 0.25;

/// Surface to which an edge of the outline belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Surface {
    Bottom,
    Sides,
    Face,
    HoleEnd,
    /// Walls along the fibre.
    HoleLeft,
    HoleRight,
    /// Walls along the fibre near the exit, where it separates.
    SeparationLeft,
    SeparationRight,
    /// Rounded edges at the exit.
    ExitLeft,
    ExitRight,
    /// Wall beyond the end of the fibre.
    Beyond,
}

#[derive(Clone, Copy, Debug)]
struct OutlinePiece {
    start: [f64; 2],
    middle: [f64; 2],
    surface: Surface,
    /// The fibre whose hole it belongs to; that of the block itself is the first.
    fibre: usize,
    /// The nodes at its start and in its middle that are there already.
    nodes: [Option<usize>; 2],
}

/// The edges around the block, the block on their left.
#[derive(Debug, Default)]
pub(super) struct Outline {
    pieces: Vec<OutlinePiece>,
}

/// The element edges of each fibre's surfaces, in the order of the outline; those of the block itself are the first fibre's.
pub(super) type SurfaceEdges = BTreeMap<(usize, Surface), Vec<ElementEdge>>;

impl Outline {
    pub(super) fn new(parameters: &Fibres, laid: &[Laid<'_>], divisions: &[Divisions]) -> Result<Self, SpecimenError> {
        let (half, depth) = (0.5 * parameters.width, parameters.depth);
        // the face is gone over from the right to the left
        let mut order: Vec<usize> = (0..laid.len()).collect();
        order.sort_by(|&a, &b| laid[b].fibre.exit.total_cmp(&laid[a].fibre.exit));
        let (rightmost, leftmost) = (order[0], order[order.len() - 1]);
        let on_face = |fibre: usize, side: f64| {
            let [left, right] = divisions[fibre].exit_edges;
            arc(&laid[fibre], if side > 0.0 { left } else { right }, side).centre[0]
        };
        // where supports begin between a hole and the side, outwards, not so close to the hole that an edge is a sliver
        let stops = |fibre: usize, limits: [f64; 2], outwards: f64| {
            let least = on_face(fibre, -outwards) * outwards + parameters.exit_size(laid[fibre].fibre);
            let mut stops = Vec::from(limits.map(|limit| limit * outwards));
            stops.retain(|&limit| limit > least && limit < half);
            stops.sort_by(f64::total_cmp);
            stops.into_iter().map(|limit| limit * outwards).collect::<Vec<_>>()
        };
        let [limits_left, limits_right] = sets::support_limits(parameters, laid);
        let mut outline = Self::default();
        outline.line(parameters, laid, [-half, -depth], [half, -depth], Surface::Bottom)?;
        outline.line(parameters, laid, [half, -depth], [half, 0.0], Surface::Sides)?;
        let mut from = half;
        for &stop in stops(rightmost, limits_right, 1.0).iter().rev() {
            outline.line(parameters, laid, [from, 0.0], [stop, 0.0], Surface::Face)?;
            from = stop;
        }
        for fibre in order {
            outline.line(parameters, laid, [from, 0.0], [on_face(fibre, -1.0), 0.0], Surface::Face)?;
            outline.hole(parameters, &laid[fibre], fibre, &divisions[fibre])?;
            from = on_face(fibre, 1.0);
        }
        for &to in stops(leftmost, limits_left, -1.0).iter().chain([&-half]) {
            outline.line(parameters, laid, [from, 0.0], [to, 0.0], Surface::Face)?;
            from = to;
        }
        outline.line(parameters, laid, [-half, 0.0], [-half, -depth], Surface::Sides)?;
        Ok(outline)
    }

    /// A hole: down its right side, around its end, up its left side.
    fn hole(
        &mut self,
        parameters: &Fibres,
        laid: &Laid<'_>,
        index: usize,
        divisions: &Divisions,
    ) -> Result<(), SpecimenError> {
        let [left, right] = divisions.exit_edges;
        let first = self.pieces.len();
        self.exit(parameters, laid, right, -1.0);
        self.wall(parameters, laid, divisions, right, -1.0)?;
        let Laid { fibre, path, .. } = laid;
        let tail = -fibre.embedded_length;
        let end = tail - fibre.tail_gap;
        let point = |s: f64, share: f64| path.point(s, 2.0 * share * fibre.half_width(s));
        if fibre.tail_gap > 0.0 {
            self.add(point(tail, -0.5), point(0.5 * (tail + end), -0.5), Surface::HoleEnd);
        }
        for pair in divisions.across.windows(2) {
            self.add(point(end, pair[0]), point(end, 0.5 * (pair[0] + pair[1])), Surface::HoleEnd);
        }
        if fibre.tail_gap > 0.0 {
            self.add(point(end, 0.5), point(0.5 * (tail + end), 0.5), Surface::HoleEnd);
        }
        self.wall(parameters, laid, divisions, left, 1.0)?;
        self.exit(parameters, laid, left, 1.0);
        self.pieces[first..].iter_mut().for_each(|piece| piece.fibre = index);
        Ok(())
    }

    fn add(&mut self, start: [f64; 2], middle: [f64; 2], surface: Surface) {
        self.pieces.push(OutlinePiece { start, middle, surface, fibre: 0, nodes: [None; 2] });
    }

    /// A straight line without its end.
    fn line(
        &mut self,
        parameters: &Fibres,
        laid: &[Laid<'_>],
        from: [f64; 2],
        to: [f64; 2],
        surface: Surface,
    ) -> Result<(), SpecimenError> {
        let length = distance(to, from);
        let at = |distance: f64| {
            let share = distance / length;
            [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
        };
        let distances = divided(length, &|distance| parameters.size_at(laid, at(distance)));
        let distances = distances.map_err(SpecimenError::along("mesh sizes around the block"))?;
        for pair in distances.windows(2) {
            self.add(at(pair[0]), at(0.5 * (pair[0] + pair[1])), surface);
        }
        Ok(())
    }

    /// The rounded edge of one wall: upwards on the left (`side` 1), downwards on the right (−1).
    fn exit(&mut self, parameters: &Fibres, laid: &Laid<'_>, edge: ExitEdge, side: f64) {
        let Arc { centre, angles, radius } = arc(laid, edge, side);
        let turn = angles[1] - angles[0];
        let by_size = (radius * turn / parameters.exit_size(laid.fibre)).ceil() as usize;
        let count = ((turn / EXIT_TURN).ceil() as usize).max(EXIT_EDGES).max(by_size);
        let at = |twice: usize| {
            let (sine, cosine) = (angles[0] + turn * twice as f64 / (2 * count) as f64).sin_cos();
            [centre[0] + radius * cosine, centre[1] + radius * sine]
        };
        let surface = if side > 0.0 { Surface::ExitLeft } else { Surface::ExitRight };
        // the wall's end is its own point, to the bit, and so is the face's
        for k in 0..count {
            let start = match (k, side > 0.0) {
                (0, true) => laid.path.point(edge.start, 0.5 * laid.fibre.diameter),
                (0, false) => [centre[0], 0.0],
                _ => at(2 * k),
            };
            self.add(start, at(2 * k + 1), surface);
        }
    }

    /// A wall, from the tail upwards on the left, downwards to it on the right.
    fn wall(
        &mut self,
        parameters: &Fibres,
        laid: &Laid<'_>,
        divisions: &Divisions,
        edge: ExitEdge,
        side: f64,
    ) -> Result<(), SpecimenError> {
        let Laid { fibre, path, .. } = laid;
        let along_fibre = divisions.wall(edge);
        let last = along_fibre[along_fibre.len() - 1];
        let mut stations = along_fibre.to_vec();
        if edge.start > last {
            let beyond = divided(edge.start - last, &|_| parameters.exit_size(fibre));
            let beyond = beyond.map_err(SpecimenError::along("mesh sizes beyond the fibre"))?;
            stations.extend(beyond[1..beyond.len() - 1].iter().map(|distance| last + distance));
            // exactly, whatever the sum rounds to
            stations.push(edge.start);
        }
        // without separation the wall that reaches above the exit is a wall like any other
        let separates = |middle: f64| fibre.separation_length > 0.0 && middle > -fibre.separation_length;
        let surface = |middle: f64| match (middle > last, separates(middle), side > 0.0) {
            (true, ..) => Surface::Beyond,
            (false, true, true) => Surface::SeparationLeft,
            (false, true, false) => Surface::SeparationRight,
            (false, false, true) => Surface::HoleLeft,
            (false, false, false) => Surface::HoleRight,
        };
        if side < 0.0 {
            stations.reverse();
        }
        let point = |s: f64| path.point(s, side * fibre.half_width(s));
        for pair in stations.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            self.add(point(pair[0]), point(middle), surface(middle));
        }
        Ok(())
    }

    /// The outline of the channel that a fibre cuts into the block, which has been filled with these outer edges: along
    /// the nodes of its walls, from one edge of the face to the other, and back over the face.
    pub(super) fn channel(
        &self,
        parameters: &Fibres,
        laid: &Laid<'_>,
        fibre: usize,
        block: &MeshDefinition,
        outer: &[ElementEdge],
    ) -> Result<Self, SpecimenError> {
        let mut channel = Self::default();
        let walls = std::iter::zip(&self.pieces, outer)
            .filter(|(piece, _)| !matches!(piece.surface, Surface::Bottom | Surface::Sides | Surface::Face))
            .filter(|(piece, _)| piece.fibre == fibre);
        let mut mouth = None;
        for (piece, edge) in walls.rev() {
            let of_edge = block.elements[edge.element].edge_nodes(edge.edge);
            let (start, end) = (of_edge[0], of_edge[1]);
            let nodes = [Some(end), of_edge.get(2).copied()];
            channel.pieces.push(OutlinePiece { start: block.nodes[end], nodes, ..*piece });
            mouth = Some(start);
        }
        if let (Some(from), Some(to)) = (mouth, channel.pieces.first().map(|piece| piece.start)) {
            let first = channel.pieces.len();
            channel.line(parameters, std::slice::from_ref(laid), block.nodes[from], to, Surface::Face)?;
            channel.pieces[first].nodes[0] = mouth;
        }
        Ok(channel)
    }

    /// Fills the outline with elements of a part, those whose corners `is_wanted`; returns the element edge of each piece of
    /// the outline, if its element was wanted.
    pub(super) fn fill(
        &self,
        definition: &mut MeshDefinition,
        part: usize,
        kind: ElementKind,
        largest_area: f64,
        is_wanted: &dyn Fn(&[[f64; 2]]) -> bool,
    ) -> Result<Vec<Option<ElementEdge>>, SpecimenError> {
        let corners: Vec<[f64; 2]> = self.pieces.iter().map(|piece| piece.start).collect();
        let made = triangulate(&corners, largest_area)?;
        let wanted = made.triangles.iter().filter(|corners| is_wanted(&corners.map(|corner| made.points[corner])));
        let wanted: Vec<&[usize; 3]> = wanted.collect();
        let mut is_used = vec![false; made.points.len()];
        wanted.iter().copied().flatten().for_each(|&corner| is_used[corner] = true);
        let mut node_at = Vec::with_capacity(made.points.len());
        for (point, is_used) in is_used.into_iter().enumerate() {
            let known = self.pieces.get(point).and_then(|piece| piece.nodes[0]);
            node_at.push(known.unwrap_or(definition.nodes.len()));
            if known.is_none() && is_used {
                definition.nodes.push(made.points[point]);
            }
        }
        let mut middles = HashMap::new();
        let mut outer_edges = vec![None; self.pieces.len()];
        for corners in wanted {
            let element = definition.elements.len();
            let mut nodes: Vec<usize> = corners.iter().map(|&corner| node_at[corner]).collect();
            for edge in 0..3 {
                let (start, end) = (corners[edge], corners[(edge + 1) % 3]);
                let is_outer = start < self.pieces.len() && end == (start + 1) % self.pieces.len();
                if is_outer {
                    outer_edges[start] = Some(ElementEdge { element, edge });
                }
                if kind == ElementKind::T6 {
                    let known = if is_outer { self.pieces[start].nodes[1] } else { None };
                    let middle = *middles.entry((start.min(end), start.max(end))).or_insert_with(|| {
                        if let Some(known) = known {
                            return known;
                        }
                        let ([a_x, a_y], [b_x, b_y]) = (made.points[start], made.points[end]);
                        let straight = [0.5 * (a_x + b_x), 0.5 * (a_y + b_y)];
                        definition.nodes.push(if is_outer { self.pieces[start].middle } else { straight });
                        definition.nodes.len() - 1
                    });
                    nodes.push(middle);
                }
            }
            definition.elements.push(ElementDefinition { kind, part, nodes });
        }
        let is_outer = |edge: ElementEdge| outer_edges.contains(&Some(edge));
        outer_edges.iter().flatten().for_each(|&outer| bend_inner_edges(definition, outer, &is_outer));
        Ok(outer_edges)
    }

    /// The element edges of each surface, in the order of the outline.
    pub(super) fn surfaces(&self, outer: &[ElementEdge]) -> SurfaceEdges {
        let mut surfaces = SurfaceEdges::new();
        for (piece, &edge) in std::iter::zip(&self.pieces, outer) {
            surfaces.entry((piece.fibre, piece.surface)).or_default().push(edge);
        }
        surfaces
    }
}

/// Bends the inner edges of a quadratic triangle away from its curved outer edge where that one reaches across them, at a corner
/// narrower than the outer edge turns. det J at a corner is the product of the tangents of both edges, 4 m − 3 c − e for the
/// corner c, the edge's middle m and its other end e; it becomes [`WIDENED`] × that of straight edges.
fn bend_inner_edges(definition: &mut MeshDefinition, outer: ElementEdge, is_outer: &dyn Fn(ElementEdge) -> bool) {
    let ElementEdge { element, edge } = outer;
    let ElementDefinition { kind: ElementKind::T6, nodes, .. } = &definition.elements[element] else { return };
    let turned = |[x, y]: [f64; 2]| [-y, x];
    let (after, opposite) = ((edge + 1) % 3, (edge + 2) % 3);
    // one inner edge leads to the start of the outer one, the other away from its end
    for (corner, other, inner, away) in [(edge, after, opposite, 1.0), (after, edge, after, -1.0)] {
        let chord_and_tangent = |edge: usize, other: usize| {
            let [c, m, e] = [corner, 3 + edge, other].map(|node| definition.nodes[nodes[node]]);
            (minus(e, c), [0, 1].map(|i| 4.0 * m[i] - 3.0 * c[i] - e[i]))
        };
        let (outer_chord, outer_tangent) = chord_and_tangent(edge, other);
        let (chord, tangent) = chord_and_tangent(inner, opposite);
        let product = |outer: [f64; 2], inner: [f64; 2]| away * dot(turned(outer), inner);
        let determinant = product(outer_tangent, tangent);
        if determinant < 0.0 && !is_outer(ElementEdge { element, edge: inner }) {
            let aside = turned(chord).map(|x| away * x);
            let missing = WIDENED * product(outer_chord, chord) - determinant;
            let share = 0.25 * missing / product(outer_tangent, aside);
            let middle = nodes[3 + inner];
            definition.nodes[middle] = [0, 1].map(|i| definition.nodes[middle][i] + share * aside[i]);
        }
    }
}

/// A rounded edge: it touches the wall and the face.
struct Arc {
    centre: [f64; 2],
    radius: f64,
    /// Angles between which it turns, counter-clockwise, rad.
    angles: [f64; 2],
}

fn arc(laid: &Laid<'_>, edge: ExitEdge, side: f64) -> Arc {
    let path = &laid.path;
    let ([x, _], [n_x, _]) = (path.point(edge.start, 0.5 * side * laid.fibre.diameter), path.left(edge.start));
    let lean = path.lean(edge.start);
    let angles = if side > 0.0 { [-lean, FRAC_PI_2] } else { [FRAC_PI_2, 2.0 * FRAC_PI_2 - lean] };
    Arc { centre: [x + side * edge.radius * n_x, -edge.radius], radius: edge.radius, angles }
}

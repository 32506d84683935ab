//! The axis of a fibre, by its arc length from the exit.

use crate::plane::distance;
use std::f64::consts::TAU;

#[cfg(test)]
mod test;

/// A piece of a fibre's axis. Each goes on in the direction in which the one before it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment {
    /// A line.
    Straight {
        /// mm.
        length: f64,
    },
    /// An arc that turns the axis to an angle.
    Arc {
        /// mm.
        radius: f64,
        /// The axis' angle from +y where the arc ends, to the right, rad.
        to: f64,
    },
    /// Waves $w(u) = a (1 − cos(2πu/λ))$ to the left of the direction in which they begin and end, u along it.
    Wave {
        /// a, half of the height from trough to crest, mm; negative: to the right.
        amplitude: f64,
        /// λ, mm.
        length: f64,
        /// Number of waves, a multiple of 1/2.
        count: f64,
    },
}

/// Pieces of half a wave over which its arc length is tabulated.
const PIECES: usize = 64;

impl Segment {
    /// Returns the arc length, mm, of a piece that begins at an angle `lean` from +y, rad.
    pub fn length(self, lean: f64) -> f64 {
        match self {
            Self::Straight { length } => length,
            Self::Arc { radius, to } => radius * (to - lean).abs(),
            Self::Wave { amplitude, length, count } => {
                let (table, _) = wave_table(amplitude, length, count);
                table[table.len() - 1]
            }
        }
    }

    /// The least radius of curvature, mm.
    pub(super) fn least_radius(self) -> f64 {
        match self {
            Self::Straight { .. } => f64::INFINITY,
            Self::Arc { radius, .. } => radius,
            Self::Wave { amplitude, length, .. } => (length / TAU).powi(2) / amplitude.abs(),
        }
    }
}

/// Position and direction of an axis at an arc length.
#[derive(Clone, Copy, Debug)]
struct Station {
    point: [f64; 2],
    /// Angle from +y to the right, rad.
    lean: f64,
}

#[derive(Clone, Debug)]
enum AxisShape {
    Line,
    /// Signed: positive turns to the right.
    Arc(f64),
    Wave {
        amplitude: f64,
        length: f64,
        /// Arc length at the ends of the equal pieces of u.
        table: Vec<f64>,
        step: f64,
    },
}

/// A piece of a path.
#[derive(Clone, Debug)]
struct AxisPiece {
    /// Arc lengths of its ends.
    from: f64,
    to: f64,
    /// Arc length of `station`.
    anchor: f64,
    station: Station,
    /// Angle at its end.
    end_lean: f64,
    shape: AxisShape,
    least_radius: f64,
    /// The point in its middle, from which no other is further away than half of its length.
    middle: [f64; 2],
}

/// An axis: straight beyond both of its ends.
#[derive(Clone, Debug)]
pub(super) struct Path {
    pieces: Vec<AxisPiece>,
}

impl Path {
    /// A path that begins at its embedded end with an angle and crosses y = 0 at x = `exit` after `embedded`.
    pub(super) fn new(lean: f64, segments: &[Segment], embedded: f64, exit: f64) -> Self {
        let (mut s, mut lean) = (-embedded, lean);
        let mut pieces: Vec<AxisPiece> = Vec::new();
        for &segment in segments {
            let length = segment.length(lean);
            let (shape, end_lean) = match segment {
                Segment::Straight { .. } => (AxisShape::Line, lean),
                Segment::Arc { radius, to } => (AxisShape::Arc(radius.copysign(to - lean)), to),
                Segment::Wave { amplitude, length, count } => {
                    let (table, step) = wave_table(amplitude, length, count);
                    (AxisShape::Wave { amplitude, length, table, step }, lean)
                }
            };
            if length > 0.0 {
                let station = Station { point: [0.0; 2], lean };
                let least_radius = segment.least_radius();
                pieces.push(AxisPiece {
                    from: s,
                    to: s + length,
                    anchor: s,
                    station,
                    end_lean,
                    shape,
                    least_radius,
                    middle: [0.0; 2],
                });
                s += length;
            }
            lean = end_lean;
        }
        let mut path = Self { pieces };
        path.put_at([exit, 0.0]);
        path
    }

    /// Places the pieces, beginning with the one that ends at the exit or crosses it.
    fn put_at(&mut self, exit: [f64; 2]) {
        let at_exit = self.pieces.partition_point(|piece| piece.to < -ROUNDING).min(self.pieces.len() - 1);
        let piece = &mut self.pieces[at_exit];
        match piece.shape {
            // no rounding of the embedded length
            AxisShape::Line => (piece.anchor, piece.station.point) = (0.0, exit),
            _ => piece.station.point = moved(exit, piece.at(0.0).point, -1.0),
        }
        let (mut start, mut end) = (piece.at(piece.from).point, piece.end().point);
        for piece in self.pieces[..at_exit].iter_mut().rev() {
            piece.station.point = moved(start, piece.end().point, -1.0);
            start = piece.station.point;
        }
        for piece in &mut self.pieces[at_exit + 1..] {
            piece.station.point = end;
            end = piece.end().point;
        }
        for piece in &mut self.pieces {
            piece.middle = piece.at(0.5 * (piece.from + piece.to)).point;
        }
    }

    /// Arc length of the outer end.
    pub(super) fn end(&self) -> f64 {
        self.pieces[self.pieces.len() - 1].to
    }

    /// Arc lengths where curved pieces begin and end, and their least radius.
    pub(super) fn curves(&self) -> impl Iterator<Item = ([f64; 2], f64)> {
        let curved = self.pieces.iter().filter(|piece| !matches!(piece.shape, AxisShape::Line));
        curved.map(|piece| ([piece.from, piece.to], piece.least_radius))
    }

    fn station(&self, s: f64) -> Station {
        let last = self.pieces.len() - 1;
        let index = self.pieces.partition_point(|piece| piece.to < s).min(last);
        let piece = &self.pieces[index];
        if index == last && s > piece.to { piece.end().on(s - piece.to) } else { piece.at(s) }
    }

    /// The angle from +y at an arc length, rad.
    pub(super) fn lean(&self, s: f64) -> f64 {
        self.station(s).lean
    }

    /// The unit normal to the left.
    pub(super) fn left(&self, s: f64) -> [f64; 2] {
        let (sine, cosine) = self.lean(s).sin_cos();
        [-cosine, sine]
    }

    /// The point at an arc length (0 at the exit, negative below), so far to the left of the axis.
    pub(super) fn point(&self, s: f64, left: f64) -> [f64; 2] {
        let Station { point: [x, y], lean } = self.station(s);
        let (sine, cosine) = lean.sin_cos();
        [x - left * cosine, y + left * sine]
    }

    /// Arc length and distance of the nearest point of the axis between two arc lengths.
    pub(super) fn nearest(&self, point: [f64; 2], range: [f64; 2]) -> (f64, f64) {
        self.nearest_within(point, range, f64::INFINITY).unwrap_or((range[0], f64::INFINITY))
    }

    /// The nearest point of the axis between two arc lengths if it is nearer than a limit.
    pub(super) fn nearest_within(&self, [x, y]: [f64; 2], [from, to]: [f64; 2], limit: f64) -> Option<(f64, f64)> {
        let mut nearest = (from, limit);
        for piece in self.pieces.iter().filter(|piece| piece.from < to && piece.to > from) {
            if piece.least_distance([x, y]) > nearest.1 {
                continue;
            }
            let (from, to) = (piece.from.max(from), piece.to.min(to));
            let candidates = match piece.shape {
                AxisShape::Line => {
                    let (sine, cosine) = piece.station.lean.sin_cos();
                    let [p_x, p_y] = piece.station.point;
                    vec![(piece.anchor + (x - p_x) * sine + (y - p_y) * cosine).clamp(from, to)]
                }
                _ => (0..=PIECES).map(|k| from + (to - from) * k as f64 / PIECES as f64).collect(),
            };
            for s in candidates {
                let distance = distance([x, y], self.point(s, 0.0));
                if distance < nearest.1 {
                    nearest = (s, distance);
                }
            }
        }
        (nearest.1 < limit).then_some(nearest)
    }

    /// The arc length at which an exit edge of this radius begins on the wall `offset` to the left of the axis (negative:
    /// to the right): there a circle touches the wall and the face y = 0 from within the block. May lie above the end of
    /// the fibre. `reach`: how far from the exit it is looked for, mm.
    pub(super) fn exit_start(&self, offset: f64, exit_radius: f64, reach: f64) -> Option<f64> {
        // the circle's centre lies on the line at this distance from the axis, `exit_radius` below the face
        let centre = offset + exit_radius.copysign(offset);
        let above = |s: f64| self.point(s, centre)[1] + exit_radius;
        // the nearest change of sign
        let outwards = if above(0.0) > 0.0 { -1.0 } else { 1.0 };
        let step = outwards * reach / f64::from(STEPS);
        let first = (1..=STEPS).find(|&k| above(f64::from(k) * step) * outwards >= 0.0)?;
        let (mut low, mut high) = (f64::from(first - 1) * step, f64::from(first) * step);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if above(middle) * outwards >= 0.0 { high = middle } else { low = middle }
        }
        let index = self.pieces.partition_point(|piece| piece.to < high);
        Some(match self.pieces.get(index) {
            // to the last bit
            Some(AxisPiece { shape: AxisShape::Line, anchor, station: Station { point: [_, y], lean }, .. }) => {
                let (sine, cosine) = lean.sin_cos();
                anchor + (-exit_radius - centre * sine - y) / cosine
            }
            _ => high,
        })
    }

    /// The radius of the exit edge that begins at an arc length of the wall `offset` to the left of the axis.
    pub(super) fn exit_radius(&self, offset: f64, s: f64) -> f64 {
        let ([_, y], [_, n_y]) = (self.point(s, offset), self.left(s));
        -y / (1.0 + n_y.copysign(n_y * offset))
    }
}

/// Arc lengths from the exit that are less are 0, mm.
const ROUNDING: f64 = 1e-9;
/// Steps in which the beginning of an exit edge is looked for.
const STEPS: u32 = 200;
/// Halvings of such a step: to the last bit.
const BISECTIONS: usize = 60;

impl Station {
    /// Returns the station at a distance along its direction.
    fn on(self, distance: f64) -> Self {
        let (sine, cosine) = self.lean.sin_cos();
        Self { point: moved(self.point, [sine, cosine], distance), ..self }
    }
}

fn moved([x, y]: [f64; 2], [u, v]: [f64; 2], factor: f64) -> [f64; 2] {
    [x + factor * u, y + factor * v]
}

impl AxisPiece {
    /// A distance from a point that none of its points is nearer than, mm.
    fn least_distance(&self, point: [f64; 2]) -> f64 {
        distance(point, self.middle) - 0.5 * (self.to - self.from) - ROUNDING
    }

    fn at(&self, s: f64) -> Station {
        let along = s - self.anchor;
        match &self.shape {
            AxisShape::Line => self.station.on(along),
            AxisShape::Arc(radius) => self.turned(*radius, self.station.lean + along / radius),
            AxisShape::Wave { amplitude, length, table, step } => {
                let u = along_wave(along, *amplitude, *length, table, *step);
                let (wave, slope) = wave_at(u, *amplitude, *length);
                let Station { point, lean } = self.station.on(u);
                let (sine, cosine) = lean.sin_cos();
                Station { point: moved(point, [-cosine, sine], wave), lean: lean - slope.atan() }
            }
        }
    }

    /// ∫ (sin θ, cos θ) ds of an arc, ds = radius dθ.
    fn turned(&self, radius: f64, lean: f64) -> Station {
        let ((sine, cosine), (from_sine, from_cosine)) = (lean.sin_cos(), self.station.lean.sin_cos());
        Station { point: moved(self.station.point, [from_cosine - cosine, sine - from_sine], radius), lean }
    }

    /// Returns where it ends, the angle without rounding.
    fn end(&self) -> Station {
        match self.shape {
            AxisShape::Arc(radius) => self.turned(radius, self.end_lean),
            _ => Station { lean: self.end_lean, ..self.at(self.to) },
        }
    }
}

/// w and dw/du.
fn wave_at(u: f64, amplitude: f64, length: f64) -> (f64, f64) {
    let (sine, cosine) = (TAU * u / length).sin_cos();
    (amplitude * (1.0 - cosine), amplitude * TAU / length * sine)
}

/// ∫ √(1 + w'²) du by three Gauss points.
fn wave_length(from: f64, to: f64, amplitude: f64, length: f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let stretch = |at: f64| wave_at(middle + half * at, amplitude, length).1.hypot(1.0);
    let outer = 0.6_f64.sqrt();
    half * (5.0 * (stretch(-outer) + stretch(outer)) + 8.0 * stretch(0.0)) / 9.0
}

/// Arc lengths at the ends of equal pieces of u, and the length of a piece.
fn wave_table(amplitude: f64, length: f64, count: f64) -> (Vec<f64>, f64) {
    let pieces = (2.0 * count).round().max(1.0) as usize * PIECES;
    let step = count * length / pieces as f64;
    let mut table = vec![0.0];
    for k in 0..pieces {
        table.push(table[k] + wave_length(step * k as f64, step * (k + 1) as f64, amplitude, length));
    }
    (table, step)
}

/// u at an arc length of the wave.
fn along_wave(s: f64, amplitude: f64, length: f64, table: &[f64], step: f64) -> f64 {
    let piece = table.partition_point(|&end| end <= s).clamp(1, table.len() - 1) - 1;
    let from = step * piece as f64;
    let mut u = from + step * (s - table[piece]) / (table[piece + 1] - table[piece]);
    // Newton's method: the arc length is nearly linear in so short a piece
    for _ in 0..3 {
        let too_far = table[piece] + wave_length(from, u, amplitude, length) - s;
        u -= too_far / wave_at(u, amplitude, length).1.hypot(1.0);
    }
    u
}

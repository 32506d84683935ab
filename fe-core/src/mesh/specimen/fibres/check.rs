//! Requirements on the parameters of fibres.

use super::{Fibre, Fibres, Laid, Segment};
use crate::element::ElementKind;
use crate::mesh::specimen::SpecimenError;
use crate::mesh::specimen::requirement::Requirements;

/// Inclinations up to this, degrees.
const LARGEST_ANGLE: f64 = 80.0;
/// Free lengths up to this share of the diameter count as 0.
pub(super) const SHORTEST: f64 = 1e-6;
/// Least radius of the inner side of a curve, as a part of the diameter.
const INNER_RADIUS: f64 = 1e-3;
/// Between the walls of fibres there is at least this share of the smaller diameter.
const LEAST_GAP: f64 = 0.05;
/// Pairs of fibres that are too close to each other before the others are left out.
const MOST_CLOSE: usize = 10;
/// A fibre has come back to itself where places further apart than this × φ along the axis are closer than φ.
const APART: f64 = 3.0;

impl Fibres {
    /// Checks each number on its own.
    pub(super) fn check(&self) -> Result<(), SpecimenError> {
        let mut required = Requirements::default();
        let mesh = &self.mesh;
        required.positive([
            ("width", self.width),
            ("depth", self.depth),
            ("matrix_thickness", self.matrix_thickness),
            ("mesh_size", mesh.size),
            ("largest_fibre_size", mesh.largest_fibre_size),
            ("growth_rate", mesh.growth_rate),
            ("largest_size", mesh.largest_size),
        ]);
        required.count([("fibres", self.fibres.len())]);
        for (index, fibre) in self.fibres.iter().enumerate() {
            required.of(fibre.name.is_some().then_some(index));
            let first = self.fibres.iter().position(|other| other.name == fibre.name);
            let alone = if fibre.name.is_some() {
                "another than those of the fibres before it"
            } else {
                "given: there are others"
            };
            required.that(first == Some(index), "name", fibre.name.as_deref().unwrap_or("missing"), alone);
            required.positive([("exit_size", self.exit_size(fibre))]);
            fibre.check(&mut required);
        }
        required.of(None);
        required.count([("elements_across", mesh.elements_across)]);
        required.nodes_on_axis(self.fibre_element, mesh.elements_across);
        let triangles = matches!(self.matrix_element, ElementKind::T3 | ElementKind::T6);
        required.that(triangles, "matrix_element", self.matrix_element, "T6 or T3: the block is filled with triangles");
        required.check()
    }

    /// The block must hold the fibres, their exits and something between them.
    pub(super) fn check_room(&self, laid: &[Laid<'_>]) -> Result<(), SpecimenError> {
        let mut required = Requirements::default();
        for (index, own) in laid.iter().enumerate() {
            required.of(own.fibre.name.is_some().then_some(index));
            self.check_course(own, &mut required);
        }
        // the axes themselves must be right before their distances say anything
        std::mem::take(&mut required).check()?;
        let mut close = 0;
        for (index, own) in laid.iter().enumerate() {
            required.of(Some(index));
            let samples = own.samples(own.ends());
            for other in &laid[index + 1..] {
                if close == MOST_CLOSE {
                    break;
                }
                let end = other.path.end();
                let least = LEAST_GAP * own.fibre.diameter.min(other.fibre.diameter);
                let gaps = samples.iter().filter_map(|&s| Some((s, own.gap_within(s, other, end, least)?)));
                let Some((s, gap)) = gaps.min_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
                close += 1;
                let [x, y] = own.path.point(s, 0.0);
                let name = other.fibre.name.as_deref().unwrap_or_default();
                let requirement =
                    format!("{least:.3} mm or more away from the fibre '{name}' (near x = {x:.3}, y = {y:.3})");
                required.that(false, "path", format!("{gap:.3} mm"), requirement);
            }
        }
        required.of(None);
        self.thickness(laid).check(self.cover, &mut required);
        required.check()
    }

    /// One fibre by itself: inside the block up to its exit, outside of it from there on, never back to itself.
    fn check_course(&self, own: &Laid<'_>, required: &mut Requirements) {
        let Laid { fibre, path, .. } = own;
        let (half, embedded) = (0.5 * self.width, fibre.embedded_length);
        if path.end() < -SHORTEST * fibre.diameter {
            let whole = embedded + path.end();
            let requirement = format!("not more than the length of the path, {whole:.3}");
            required.that(false, fibre.key("embedded_length", "embedded"), embedded, requirement);
            return;
        }
        let lean = path.lean(0.0).abs();
        let (angle, embedded_key) = (fibre.key("angle_deg", "path"), fibre.key("embedded_length", "embedded"));
        let requirement = format!("within {LARGEST_ANGLE}° of the normal where it leaves the block");
        required.that(lean.to_degrees() <= LARGEST_ANGLE, angle, format!("{:.1}°", lean.to_degrees()), requirement);
        if lean.to_degrees() > LARGEST_ANGLE {
            return;
        }
        // the rounded edges of the exit
        let (sine, cosine) = lean.sin_cos();
        let (radius, exit) = (0.5 * fibre.diameter, fibre.exit_radius());
        let wedge = radius / cosine + exit * (1.0 + sine) / cosine;
        let requirement = format!("such that the exit's edges, {wedge:.3} from the axis, stay within the width");
        required.that(wedge + fibre.exit.abs() < half, "exit_radius", exit, requirement);
        let start = (exit * (1.0 + sine) + radius * sine) / cosine;
        let requirement = format!("such that the exit's edge, {start:.3} deep along the fibre, ends above its tail");
        required.that(start < embedded, "exit_radius", exit, requirement);
        let inside = own.samples([-embedded - fibre.tail_gap, 0.0]);
        let corners = |s: f64| [-1.0, 1.0].map(|side| path.point(s, side * fibre.half_width(s)));
        let reach = |of: &dyn Fn([f64; 2]) -> f64| inside.iter().flat_map(|&s| corners(s)).map(of).fold(0.0, f64::max);
        let sideways = reach(&|[x, _]| x.abs());
        let requirement = format!(
            "such that the fibre stays in the block: it reaches {sideways:.3} sideways, half of the width is {half}"
        );
        required.that(sideways < half, embedded_key, embedded, requirement);
        let deep = reach(&|[_, y]| -y);
        let depth = self.depth;
        let requirement =
            format!("such that the fibre stays in the block: it reaches {deep:.3} deep, the depth is {depth}");
        required.that(deep < depth, embedded_key, embedded, requirement);
        // away from the exit by what the rounded edges take
        let above = inside.iter().find(|&&s| s < -start && corners(s).iter().any(|[_, y]| *y > -0.5 * exit));
        let out = own.samples([0.0, path.end()]).into_iter().find(|&s| s > start && path.point(s, 0.0)[1] < 0.0);
        for (s, requirement) in [
            (above.copied(), "below the exit face up to the embedded_length: it comes out before"),
            (out, "outside of the block from the exit face on: it goes back into it"),
        ] {
            let place = s.map(|s| path.point(s, 0.0)).unwrap_or_default();
            required.that(s.is_none(), "path", format!("near x = {:.3}, y = {:.3}", place[0], place[1]), requirement);
        }
        let samples = own.samples(own.ends());
        let back = samples.iter().find_map(|&s| {
            let point = path.point(s, 0.0);
            let before = [-embedded, s - APART * fibre.diameter];
            path.nearest_within(point, before, 2.0 * fibre.half_width(s)).map(|_| point)
        });
        let [x, y] = back.unwrap_or_default();
        required.that(
            back.is_none(),
            "path",
            format!("near x = {x:.3}, y = {y:.3}"),
            "clear of the same fibre's other parts",
        );
    }
}

impl Fibre {
    /// Returns what a parameter is called in a specimen of one fibre, and among several.
    fn key(&self, alone: &'static str, among: &'static str) -> &'static str {
        if self.name.is_none() { alone } else { among }
    }

    fn check(&self, required: &mut Requirements) {
        let (diameter, embedded) = (self.diameter, self.embedded_length);
        required.positive([
            (self.key("fibre_diameter", "diameter"), diameter),
            (self.key("embedded_length", "embedded"), embedded),
            ("exit_radius", self.exit_radius()),
        ]);
        required.that(self.exit.is_finite(), "exit", self.exit, "finite");
        required.that(self.lean.abs() < std::f64::consts::PI, "tilt_deg", self.lean.to_degrees(), "less than 180");
        let gap = self.tail_gap;
        required.that(gap >= 0.0 && gap.is_finite(), "tail_gap", gap, "0 or positive");
        let (separation, fine) = (self.separation_length, self.fine_length());
        let requirement = format!("0 or positive, and less than the embedded length {embedded}");
        required.that((0.0..embedded).contains(&separation), "separation_length", separation, requirement);
        let requirement = format!("0 or positive, and not more than the embedded length {embedded}");
        required.that((0.0..=embedded).contains(&fine), "fine_length", fine, requirement);
        required.count([("path", self.path.len())]);
        let mut thickest = diameter;
        let mut last = 0.0;
        let requirement = "a line: two points [distance, diameter] or more";
        required.that(self.profile.len() != 1, "width_profile", "a single point", requirement);
        for &[at, width] in &self.profile {
            let fits = at >= last && at < embedded - 2.0 * diameter && width > 0.0 && width.is_finite();
            let requirement =
                "[distance, diameter], distances ascending from 0 and 2 φ or more below the exit, diameters positive";
            required.that(fits, "width_profile", format!("[{at}, {width}]"), requirement);
            (last, thickest) = (at, f64::max(thickest, width));
        }
        let least = 0.5 * thickest + INNER_RADIUS * diameter;
        for &segment in &self.path {
            match segment {
                Segment::Straight { length } => {
                    let name = self.key("free_length", "path");
                    required.that(length >= 0.0 && length.is_finite(), name, length, "0 or positive");
                }
                Segment::Arc { radius, to } => {
                    let name = self.key("bend_radius", "path");
                    let requirement = format!("bent to a radius of more than half of the diameter, {least:.4}");
                    required.that(radius >= least && radius.is_finite(), name, radius, requirement);
                    required.that(to.is_finite(), name, to.to_degrees(), "an angle");
                }
                Segment::Wave { amplitude, length, count } => {
                    let halves = 2.0 * count;
                    let requirement = "waves: a length above 0, and a number of them in halves";
                    let is_wave = length > 0.0 && length.is_finite() && amplitude.is_finite();
                    required.that(
                        is_wave && halves >= 1.0 && halves.fract() == 0.0 && halves < 1e3,
                        "path",
                        count,
                        requirement,
                    );
                    let radius = segment.least_radius();
                    let requirement =
                        format!("waves whose crests have a radius of more than half of the diameter, {least:.4}");
                    required.that(radius >= least || !is_wave, "path", format!("{radius:.4}"), requirement);
                }
            }
        }
    }
}

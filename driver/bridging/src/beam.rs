//! The notched beam in three-point bending by the hinge model.

use crate::Invalid;
use crate::composite::Matrix;
use crate::interpolation::Polyline;
use crate::quadrature::root;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// CMOD of f_R1 … f_R4, mm (EN 14651).
pub const RESIDUAL_CMOD: [f64; 4] = [0.5, 1.5, 2.5, 3.5];
/// CMOD up to which f_L is the greatest, mm (EN 14651).
pub(crate) const LIMIT_CMOD: f64 = 0.05;
/// Parts of it that are looked at.
const LIMIT_PARTS: usize = 25;
/// δ = 0.85 CMOD + 0.04 (EN 14651).
const DEFLECTION: [f64; 2] = [0.85, 0.04];
/// Elongation to which a law goes on with its last stress, mm.
const BEYOND: f64 = 1e3;
/// Compression is elastic up to this part of f_c.
const ELASTIC_PART: f64 = 0.4;
/// Number of straight lines that replace the compression curve.
const COMPRESSION_LINES: usize = 60;
/// Least strain of a line in compression that goes on beyond the last.
const CRUSHED: f64 = 0.05;
/// Rotations between which equilibrium is sought, as parts of the greatest.
const LEAST_ROTATION: f64 = 1e-7;

/// A beam with a notch at midspan; EN 14651's by default.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct NotchedBeam {
    /// b, mm.
    pub width: f64,
    /// h, mm, with the notch.
    pub height: f64,
    /// l, mm.
    pub span: f64,
    /// Depth of the notch, mm.
    pub notch: f64,
    /// s_h, mm; half the ligament by default.
    pub hinge_length: Option<f64>,
}

impl Default for NotchedBeam {
    fn default() -> Self {
        Self { width: 150.0, height: 150.0, span: 500.0, notch: 25.0, hinge_length: None }
    }
}

impl NotchedBeam {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A number without sense.
    pub fn check(&self) -> Result<(), Invalid> {
        let place = |name| format!("beam.{name}");
        let all = [(self.width, "width"), (self.height, "height"), (self.span, "span")];
        for (value, name) in all.into_iter().chain(self.hinge_length.map(|length| (length, "hinge_length"))) {
            Invalid::unless_positive(value, place(name))?;
        }
        let within = self.notch >= 0.0 && self.notch < self.height;
        Invalid::unless(within, place("notch"), "must not be below 0, and less than the height")?;
        Invalid::unless(self.span >= self.height, place("span"), "must not be less than the height")
    }

    /// h_sp.
    pub fn ligament(&self) -> f64 {
        self.height - self.notch
    }

    /// s_h.
    pub fn hinge(&self) -> f64 {
        self.hinge_length.unwrap_or(0.5 * self.ligament())
    }

    /// 6M/(b h_sp²) = 3Fl/(2b h_sp²).
    pub fn flexural_strength(&self, force: f64) -> f64 {
        1.5 * force * self.span / (self.width * self.ligament() * self.ligament())
    }
}

/// Stress over the elongation of the hinge of a layer: elastic up to f_t, then u = s_h σ(w)/E + w; compression elastic,
/// or with f_c the curve of EN 1992-1-1:2004, 3.1.5, beyond 0.4 f_c. Straight lines, so that integrals are exact.
#[derive(Clone, Debug)]
pub struct SectionLaw {
    /// u, σ, ∫σ du and ∫σu du from 0.
    nodes: Vec<[f64; 4]>,
    /// u over w.
    elongation: Polyline,
    cracking: f64,
    /// Whether the law falls more steeply than −E/s_h somewhere: the least w was taken.
    pub snaps: bool,
}

impl SectionLaw {
    /// Makes a section law of σ(w), whose first opening is 0.
    pub fn new(matrix: &Matrix, law: &Polyline, hinge: f64) -> Self {
        let stiffness = matrix.modulus / hinge;
        let points: Vec<(f64, f64)> = law.points().collect();
        let first = points.first().map_or(0.0, |point| point.1);
        let strength = matrix.ft.max(first);
        let cracking = strength / stiffness;
        let mut curve = compression(matrix, hinge);
        curve.push([0.0, 0.0]);
        curve.push([cracking, strength]);
        let mut elongation = vec![(0.0, cracking)];
        let mut snaps = false;
        let mut reached = cracking;
        let end = points.last().copied().unwrap_or_default();
        let beyond = (end.0 + BEYOND, end.1);
        let mut before = (0.0, first);
        for (w, stress) in points.into_iter().skip(1).chain([beyond]) {
            let of = |(w, stress): (f64, f64)| w + stress / stiffness;
            let (from, to) = (of(before), of((w, stress)));
            snaps |= to < from;
            if to > reached {
                if from < reached {
                    let part = (reached - from) / (to - from);
                    curve.push([reached, before.1 + part * (stress - before.1)]);
                    elongation.push((before.0 + part * (w - before.0), reached));
                }
                curve.push([to, stress]);
                reached = to;
            }
            elongation.push((w, reached));
            before = (w, stress);
        }
        Self { nodes: with_integrals(&curve), elongation: Polyline::new(elongation), cracking, snaps }
    }

    /// ∫σ du and ∫σu du from 0 to u.
    fn integrals(&self, u: f64) -> [f64; 2] {
        let left = self.nodes.partition_point(|node| node[0] <= u).clamp(1, self.nodes.len() - 1) - 1;
        let [from, stress, first, second] = self.nodes[left];
        let [to, end, ..] = self.nodes[left + 1];
        let slope = if to > from { (end - stress) / (to - from) } else { 0.0 };
        let [more_first, more_second] = line_integrals(from, u, stress, slope);
        [first + more_first, second + more_second]
    }
}

/// Returns the line integrals of σ = stress + slope (u − a) from a to b.
fn line_integrals(a: f64, b: f64, stress: f64, slope: f64) -> [f64; 2] {
    let step = b - a;
    let first = step * (stress + 0.5 * slope * step);
    [first, a * first + step * step * (0.5 * stress + slope * step / 3.0)]
}

fn with_integrals(curve: &[[f64; 2]]) -> Vec<[f64; 4]> {
    let mut sums = [0.0; 2];
    let mut nodes: Vec<[f64; 4]> = Vec::with_capacity(curve.len());
    for &[u, stress] in curve {
        if let Some(&[from, before, ..]) = nodes.last().filter(|last| u > last[0]) {
            let more = line_integrals(from, u, before, (stress - before) / (u - from));
            sums = [sums[0] + more[0], sums[1] + more[1]];
        }
        nodes.push([u, stress, sums[0], sums[1]]);
    }
    let zero = nodes.iter().find(|node| node[0] == 0.0).copied().unwrap_or_default();
    nodes.iter_mut().for_each(|node| (node[2], node[3]) = (node[2] - zero[2], node[3] - zero[3]));
    nodes
}

/// Returns the branch of compression as (u, σ), by rising u below 0.
fn compression(matrix: &Matrix, hinge: f64) -> Vec<[f64; 2]> {
    let elastic = |strain: f64| [-strain * hinge, -strain * matrix.modulus];
    let Some(fc) = matrix.fc else { return vec![elastic(CRUSHED)] };
    // σ = f_c (kx − x²)/(1 + (k − 2)x), x = ε/ε_c1, k = E ε_c1/f_c; ε_c1 = 0.7 f_c^0.31 ‰ ≤ 2.8 ‰; meets E ε at 0
    let peak = (0.7e-3 * fc.powf(0.31)).min(2.8e-3).max(1.001 * fc / matrix.modulus);
    let k = matrix.modulus * peak / fc;
    let curved = |x: f64| fc * (k * x - x * x) / (1.0 + (k - 2.0) * x);
    // where the curve carries 0.4 f_c
    let elastic_end = ELASTIC_PART * fc / matrix.modulus / peak;
    let from = root(|x| curved(x) - ELASTIC_PART * fc, 0.0, 1.0);
    // the two meet: strain is measured from the elastic line's end
    let at = |x: f64| [-(x - from + elastic_end) * peak * hinge, -curved(x)];
    let mut curve: Vec<[f64; 2]> =
        (1..=COMPRESSION_LINES).rev().map(|j| at(from + (1.0 - from) * j as f64 / COMPRESSION_LINES as f64)).collect();
    curve.insert(0, [curve[0][0] - CRUSHED * hinge, -fc]);
    curve.push([-elastic_end * peak * hinge, -ELASTIC_PART * fc]);
    curve
}

/// A point of the test.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeamLoad {
    /// Opening at the mouth of the notch, mm.
    pub cmod: f64,
    /// Deflection by EN 14651's formula, mm.
    pub deflection: f64,
    /// F, N.
    pub force: f64,
    /// y_0: neutral axis from the top, mm.
    pub neutral_axis: f64,
    /// φ.
    pub rotation: f64,
}

/// Strengths of EN 14651, MPa.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// f_L; not a number if a test does not state it.
    pub limit: f64,
    /// f_R1 … f_R4.
    pub residual: [f64; 4],
}

impl Residual {
    /// The means of several beams.
    pub fn mean(beams: &[Self]) -> Self {
        let mean = |of: &dyn Fn(&Self) -> f64| beams.iter().map(of).sum::<f64>() / beams.len() as f64;
        Self { limit: mean(&|beam| beam.limit), residual: [0, 1, 2, 3].map(|k| mean(&|beam| beam.residual[k])) }
    }
}

/// A beam of strips of equal height, from the top, each with its law.
#[derive(Clone, Debug)]
pub struct LayeredBeam<'l> {
    geometry: NotchedBeam,
    strips: &'l [SectionLaw],
    /// The force that cracks it, and its CMOD.
    cracking: [f64; 2],
}

impl<'l> LayeredBeam<'l> {
    /// Makes a beam of one strip or more.
    pub fn new(geometry: NotchedBeam, strips: &'l [SectionLaw], matrix: &Matrix) -> Self {
        let ligament = geometry.ligament();
        let elongation = strips.last().map_or(0.0, |strip| strip.cracking);
        let strength = elongation * matrix.modulus / geometry.hinge();
        let force = strength / geometry.flexural_strength(1.0);
        Self { geometry, strips, cracking: [force, 2.0 * elongation / ligament * geometry.notch] }
    }

    /// N φ/b and M φ²/b about the neutral axis.
    fn forces(&self, rotation: f64, axis: f64) -> [f64; 2] {
        let height = self.geometry.ligament() / self.strips.len() as f64;
        let mut forces = [0.0; 2];
        for (k, strip) in self.strips.iter().enumerate() {
            let at = |edge: usize| strip.integrals(rotation * (height * edge as f64 - axis));
            let (top, bottom) = (at(k), at(k + 1));
            forces[0] += bottom[0] - top[0];
            forces[1] += bottom[1] - top[1];
        }
        forces
    }

    /// Returns the equilibrium at a CMOD. w(h_sp) = CMOD − φ·notch gives the elongation at the notch and, with φ, the
    /// neutral axis; N = 0 gives φ.
    pub fn at(&self, cmod: f64) -> BeamLoad {
        let NotchedBeam { width, notch, span, .. } = self.geometry;
        let ligament = self.geometry.ligament();
        let deflection = if cmod > 0.0 { DEFLECTION[0] * cmod + DEFLECTION[1] } else { 0.0 };
        let Some(mouth) = self.strips.last() else { return BeamLoad::default() };
        if cmod <= self.cracking[1] {
            let part = if cmod > 0.0 { cmod / self.cracking[1] } else { 0.0 };
            let rotation = part * 2.0 * mouth.cracking / ligament;
            let force = part * self.cracking[0];
            return BeamLoad { cmod, deflection, force, neutral_axis: 0.5 * ligament, rotation };
        }
        let elongation = |rotation: f64| mouth.elongation.at(cmod - notch * rotation);
        let axis = |rotation: f64| ligament - elongation(rotation) / rotation;
        let greatest = if notch > 0.0 { cmod / notch } else { elongation(0.0) / ligament / LEAST_ROTATION };
        let normal = |rotation: f64| self.forces(rotation, axis(rotation))[0];
        let least = LEAST_ROTATION * greatest;
        let rotation = if normal(least) <= 0.0 {
            least
        } else if normal(greatest) >= 0.0 {
            // it is just about to crack, up to rounding
            greatest
        } else {
            root(normal, least, greatest)
        };
        let neutral_axis = axis(rotation);
        let moment = width * self.forces(rotation, neutral_axis)[1] / (rotation * rotation);
        BeamLoad { cmod, deflection, force: 4.0 * moment / span, neutral_axis, rotation }
    }

    /// f_L and f_R1–4.
    pub fn residual(&self) -> Residual {
        let strength = |force: f64| self.geometry.flexural_strength(force);
        let [cracking, at] = self.cracking;
        let early = (1..=LIMIT_PARTS).map(|k| LIMIT_CMOD * k as f64 / LIMIT_PARTS as f64);
        let first = if at <= LIMIT_CMOD { cracking } else { 0.0 };
        // what is no number stays none
        let greater = |greatest: f64, force| if force <= greatest || greatest.is_nan() { greatest } else { force };
        let greatest = early.map(|cmod| self.at(cmod).force).fold(first, greater);
        Residual { limit: strength(greatest), residual: RESIDUAL_CMOD.map(|cmod| strength(self.at(cmod).force)) }
    }
}

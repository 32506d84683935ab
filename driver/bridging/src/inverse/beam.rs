//! σ(w) from F–CMOD.

use super::strengths::{Shape, inverse_of_strengths};
use super::{Fitted, LeastSquares, least_squares};
use crate::Invalid;
use crate::beam::{LIMIT_CMOD, LayeredBeam, NotchedBeam, RESIDUAL_CMOD, Residual, SectionLaw};
use crate::composite::Matrix;
use crate::interpolation::{Polyline, monotone_slopes};
use nalgebra::{Matrix3, Vector3};

/// Openings at which the law is sought from a curve, mm; what the matrix carries after its strength begins at 0.
pub const OPENINGS: [f64; 11] = [0.0, 0.01, 0.03, 0.1, 0.3, 0.6, 1.0, 1.5, 2.0, 2.5, 3.0];
/// Least CMOD that counts, mm: below it the notch's own elastic opening matters, which the model leaves out.
const LEAST_CMOD: f64 = 0.01;
/// Fewer points than this have their derivative from the monotone cubic through them.
const FEW_POINTS: usize = 12;
/// Half the width, in ln CMOD, of the window of a parabola; it grows by this factor until it holds enough points.
const WINDOW: f64 = 0.35;
const WIDER: f64 = 1.4;
const FEWEST_IN_WINDOW: usize = 7;
/// Penalties on second differences from which the L-curve's corner is taken.
const PENALTIES: [f64; 9] = [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0];
/// Evaluations per parameter.
const PATIENCE: usize = 60;
/// E and f_t are known beforehand: a factor e counts as much as a difference by this part of the greatest force.
const PRIOR: f64 = 0.1;
/// Least stress that a search begins with, as a part of the greatest.
const LEAST_STRESS: f64 = 0.02;

/// A test, or what its report states.
#[derive(Clone, Debug, PartialEq)]
pub enum MeasuredBeam {
    /// CMOD, mm, rising, and F, N.
    Curve(Vec<[f64; 2]>),
    /// Strengths of one beam or more, MPa.
    Strengths(Vec<Residual>),
}

impl MeasuredBeam {
    fn check(&self) -> Result<(), Invalid> {
        let rows = match self {
            Self::Curve(rows) => rows,
            Self::Strengths(beams) => {
                let is_sound = |value: f64| value > 0.0 && value.is_finite();
                let sound = |beam: &Residual| beam.residual.into_iter().all(is_sound);
                let sound = !beams.is_empty() && beams.iter().all(sound);
                return Invalid::unless(sound, "test".into(), "must have strengths above 0");
            }
        };
        let finite = rows.iter().flatten().all(|value| value.is_finite());
        let rising = rows.windows(2).all(|pair| pair[1][0] > pair[0][0]);
        Invalid::unless(finite && rising, "test".into(), "must have CMODs that rise")?;
        let some = compared(rows).count() > OPENINGS.len() + 2;
        Invalid::unless(some, "test".into(), "must have more than 12 points from CMOD 0.01 mm on")?;
        Invalid::unless(rows.iter().any(|row| row[1] > 0.0), "test".into(), "must have a force above 0")
    }

    /// Returns f_L and f_R1 … f_R4, MPa, by EN 14651: of several beams the means. `None`: the curve ends before the CMOD of f_R4.
    pub fn strengths(&self, geometry: &NotchedBeam) -> Option<Residual> {
        let rows = match self {
            Self::Curve(rows) => rows,
            Self::Strengths(beams) => return Some(Residual::mean(beams)),
        };
        let curve = Polyline::new(rows.iter().map(|row| (row[0], row[1])));
        let reaches = |cmod: &f64| rows.last().is_some_and(|row| row[0] >= *cmod);
        let early = rows.iter().filter(|row| row[0] <= LIMIT_CMOD).map(|row| row[1]);
        let greatest = early.fold(curve.at(LIMIT_CMOD), f64::max);
        RESIDUAL_CMOD.iter().all(reaches).then(|| Residual {
            limit: geometry.flexural_strength(greatest),
            residual: RESIDUAL_CMOD.map(|cmod| geometry.flexural_strength(curve.at(cmod))),
        })
    }

    /// The greatest flexural strength that a fit compares, MPa.
    pub fn greatest_strength(&self, geometry: &NotchedBeam) -> f64 {
        match self {
            Self::Curve(rows) => geometry.flexural_strength(rows.iter().map(|row| row[1]).fold(0.0, f64::max)),
            Self::Strengths(beams) => Residual::mean(beams).residual.into_iter().fold(0.0, f64::max),
        }
    }
}

/// The points of a curve that the model can be compared with.
fn compared(rows: &[[f64; 2]]) -> impl Iterator<Item = &[f64; 2]> {
    rows.iter().filter(|row| row[0] >= LEAST_CMOD)
}

/// σ(w) by a rigid hinge whose zone of compression has no height:
///
/// ```text
/// σ(w) = f_R/3 + (CMOD/6) df_R/dCMOD    at    w = CMOD h_sp/(h_sp + a)
/// ```
///
/// at each point of the test but the first ones.
///
/// # Errors
/// Data that are not those of a test.
pub fn fast_inverse(geometry: &NotchedBeam, test: &MeasuredBeam) -> Result<Polyline, Invalid> {
    geometry.check()?;
    test.check()?;
    let (cmods, strengths): (Vec<f64>, Vec<f64>) = match test {
        MeasuredBeam::Curve(rows) => compared(rows).map(|row| (row[0], geometry.flexural_strength(row[1]))).unzip(),
        MeasuredBeam::Strengths(beams) => (RESIDUAL_CMOD.to_vec(), Residual::mean(beams).residual.to_vec()),
    };
    let part = geometry.ligament() / geometry.height;
    let slopes = monotone_slopes(&cmods, &strengths);
    let at = |k: usize| {
        let (value, slope) = if cmods.len() < FEW_POINTS {
            (strengths[k], slopes[k])
        } else {
            parabola(&cmods, &strengths, cmods[k]).unwrap_or((strengths[k], slopes[k]))
        };
        (cmods[k] * part, (value / 3.0 + cmods[k] / 6.0 * slope).max(0.0))
    };
    Ok(Polyline::new((0..cmods.len()).map(at)))
}

/// Value and slope at x of the parabola through the points about it (least squares).
fn parabola(x: &[f64], y: &[f64], at: f64) -> Option<(f64, f64)> {
    let mut half = WINDOW;
    let window = loop {
        let from = x.partition_point(|&x| x < at * (-half).exp());
        let to = x.partition_point(|&x| x <= at * half.exp());
        if to - from >= FEWEST_IN_WINDOW || to - from == x.len() {
            break from..to;
        }
        half *= WIDER;
    };
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for k in window {
        let t = (x[k] - at) / at;
        let basis = Vector3::new(1.0, t, t * t);
        normal += basis * basis.transpose();
        right += basis * y[k];
    }
    let solution = normal.lu().solve(&right)?;
    Some((solution[0], solution[1] / at))
}

/// σ(w) with what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct BridgingFit {
    /// Estimates of E, f_t, then σ at `openings` with the matrix's. The parameters of strengths are the stresses that take over as
    /// the matrix softens instead.
    pub fitted: Fitted,
    /// Openings, mm.
    pub openings: Vec<f64>,
    /// σ(w).
    pub law: Polyline,
    /// The matrix with E and f_t.
    pub matrix: Matrix,
    /// Weight of the penalty; 0: the test has as many numbers as the law.
    pub weight: f64,
    /// 5 and 95 % quantiles of σ at `openings` over the beams, if there are several.
    pub band: Option<Vec<[f64; 2]>>,
}

/// Finds σ(w), E and f_t whose beam is nearest to the test, and smooth.
///
/// For a curve it uses Levenberg and Marquardt's method with a penalty on second differences of σ, whose weight is
/// taken from the corner of the L-curve. For strengths it uses the given shape. Strengths cannot determine how the
/// matrix softens, so σ is sought in addition to the given softening.
///
/// # Errors
/// Data that are not those of a test.
pub fn full_inverse(
    geometry: &NotchedBeam,
    matrix: &Matrix,
    test: &MeasuredBeam,
    shape: Shape,
) -> Result<BridgingFit, Invalid> {
    matrix.check()?;
    let start = fast_inverse(geometry, test)?;
    let rows = match test {
        MeasuredBeam::Strengths(beams) => return Ok(inverse_of_strengths(geometry, matrix, beams, shape)),
        MeasuredBeam::Curve(rows) => rows,
    };
    let form = Form { geometry: *geometry, matrix: *matrix, rows, scale: test.greatest_strength(geometry) };
    let start = form.start(&start);
    let fit = |weight: f64, start: &[f64]| {
        let problem = LeastSquares {
            residuals: &|parameters| form.residuals(parameters, weight),
            quantities: &|parameters| form.quantities(parameters),
            data: compared(rows).count(),
            patience: PATIENCE,
        };
        least_squares(&problem, start)
    };
    let mut fits: Vec<(f64, Fitted)> = Vec::new();
    // from the smoothest on, each from the one before
    for &weight in PENALTIES.iter().rev() {
        let from = fits.last().map_or(start.clone(), |(_, fitted)| fitted.parameters.clone());
        fits.push((weight, fit(weight, &from)));
    }
    let corner = corner(&fits);
    let (weight, fitted) = fits.swap_remove(corner);
    let (matrix, law) = form.law(&fitted.parameters);
    Ok(BridgingFit { fitted, openings: OPENINGS.to_vec(), law, matrix, weight, band: None })
}

/// Returns the monotone cubic through stresses at openings. It continues straight on to 1.5 times the last opening,
/// where the test ends.
pub(super) fn smooth_through(nodes: &[f64], stresses: &[f64]) -> Polyline {
    let last = nodes.len() - 1;
    let slope = monotone_slopes(nodes, stresses)[last];
    let beyond = (1.5 * nodes[last], (stresses[last] + 0.5 * nodes[last] * slope).max(0.0));
    Polyline::new(Polyline::smooth(nodes, stresses).points().chain([beyond]))
}

/// The index of the fit where the curve of ln(penalty/weight) over ln(RMS) turns most (Hansen 1992), by the circle
/// through three neighbours.
fn corner(fits: &[(f64, Fitted)]) -> usize {
    let logarithms: Vec<[f64; 2]> = fits
        .iter()
        .map(|(weight, fitted)| [fitted.rms.max(1e-12).ln(), (fitted.penalty / weight).max(1e-12).ln()])
        .collect();
    let curvature = |k: usize| {
        let [a, b, c] = [logarithms[k - 1], logarithms[k], logarithms[k + 1]];
        let side = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]).hypot(q[1] - p[1]);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        -2.0 * area / (side(a, b) * side(b, c) * side(a, c)).max(f64::MIN_POSITIVE)
    };
    (1..fits.len() - 1).max_by(|&i, &j| curvature(i).total_cmp(&curvature(j))).unwrap_or(0)
}

/// The unknowns: ln E, ln f_t, √σ.
struct Form<'t> {
    geometry: NotchedBeam,
    matrix: Matrix,
    rows: &'t [[f64; 2]],
    /// Greatest flexural strength.
    scale: f64,
}

impl Form<'_> {
    fn start(&self, fast: &Polyline) -> Vec<f64> {
        let stresses = OPENINGS.iter().map(|&opening| fast.at(opening).max(LEAST_STRESS * self.scale).sqrt());
        let head = [self.matrix.modulus.ln(), self.matrix.ft.ln()];
        head.into_iter().chain(stresses).collect()
    }

    fn quantities(&self, parameters: &[f64]) -> Vec<f64> {
        let (head, roots) = parameters.split_at(2);
        head.iter().map(|x| x.exp()).chain(roots.iter().map(|root| root * root)).collect()
    }

    fn law(&self, parameters: &[f64]) -> (Matrix, Polyline) {
        let quantities = self.quantities(parameters);
        let matrix = Matrix { modulus: quantities[0], ft: quantities[1], ..self.matrix };
        (matrix, smooth_through(&OPENINGS, &quantities[2..]))
    }

    /// Differences of strengths as parts of the greatest; then the penalties.
    fn residuals(&self, parameters: &[f64], weight: f64) -> Vec<f64> {
        let (matrix, law) = self.law(parameters);
        let section = [SectionLaw::new(&matrix, &law, self.geometry.hinge())];
        let beam = LayeredBeam::new(self.geometry, &section, &matrix);
        let strength = |force: f64| self.geometry.flexural_strength(force);
        let compared = compared(self.rows);
        let mut residuals: Vec<f64> = compared.map(|&[cmod, force]| strength(beam.at(cmod).force - force)).collect();
        let stresses = &self.quantities(parameters)[2..];
        residuals.extend(stresses[1..].windows(3).map(|s| weight * (s[0] - 2.0 * s[1] + s[2])));
        residuals.iter_mut().for_each(|row| *row /= self.scale);
        let [modulus, ft] = [self.matrix.modulus, self.matrix.ft].map(f64::ln);
        residuals.push(PRIOR * (parameters[0] - modulus));
        residuals.push(PRIOR * (parameters[1] - ft));
        residuals
    }
}

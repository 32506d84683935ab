//! σ(w) from strengths alone: the smoothest law that they allow, or a bilinear one.

use super::beam::{BridgingFit, smooth_through};
use super::constrained::constrained;
use super::{Estimate, Fitted};
use crate::beam::{LayeredBeam, NotchedBeam, RESIDUAL_CMOD, Residual, SectionLaw};
use crate::composite::Matrix;
use crate::interpolation::Polyline;
use crate::quantile;
use nalgebra::{DMatrix, DVector};

/// Openings of the smooth law, mm, the last that of f_R4.
const KNOTS: [f64; 11] = [0.0, 0.1, 0.2, 0.4, 0.6, 0.9, 1.25, 1.65, 2.1, 2.5, 2.9];
/// Openings at which the slope of a bilinear law may change, mm: from, to, and how many, with a constant factor
/// between.
const TURNS: (f64, f64, i32) = (0.1, 2.5, 24);
/// Weights of the penalty among which cross-validation chooses: (∫σ''² dw)^½ in MPa/mm^1.5 against a difference in MPa.
const WEIGHTS: [f64; 13] = [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
/// Weights whose predictions are worse than the best by this factor are as good: the smoothest of them counts.
const AS_GOOD: f64 = 1.05;
/// Differences that count as rounding, as parts of the greatest strength.
const ROUNDING: f64 = 1e-5;
/// Linearisations; the weight is chosen on the first of them.
const PATIENCE: usize = 24;
const CHOICES: usize = 3;
/// The search ends when the law would change by less than this part of the greatest strength.
const SETTLED: f64 = 1e-7;
/// Linearisations of a beam other than the mean, and of a place where the slope of a bilinear law may change.
const FEW: usize = 4;
/// Half the distance of differences, as a part of the greatest strength.
const STEP: f64 = 1e-5;
/// Quantiles of the band.
const BAND: [f64; 2] = [0.05, 0.95];

/// The shape of a law of which strengths alone are known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shape {
    /// Smooth; it falls beyond its greatest value. Cross-validation chooses how smooth.
    #[default]
    Smooth,
    /// Two straight lines that fall.
    Bilinear,
}

/// Where a law turns from rising to falling, and how heavy its penalty is.
#[derive(Clone, Copy, Debug, Default)]
struct Choice {
    peak: usize,
    weight: f64,
}

/// f_R1–4 of a law's beam and their derivatives by its stresses, about stresses.
struct Linear {
    about: DVector<f64>,
    strengths: DVector<f64>,
    derivatives: DMatrix<f64>,
}

/// The search for the stresses of a law at its knots.
struct Search {
    geometry: NotchedBeam,
    matrix: Matrix,
    knots: Vec<f64>,
    shape: Shape,
    scale: f64,
}

/// What a search found.
struct Found {
    stresses: DVector<f64>,
    linear: Linear,
    choice: Choice,
    reached: bool,
}

/// Finds the σ(w) whose beam has the strengths f_R1–4; of several beams it has their means. E and f_t are the matrix's:
/// f_L belongs to the matrix and to fibres that have hardly begun to carry: it has no part in this.
pub(super) fn inverse_of_strengths(
    geometry: &NotchedBeam,
    matrix: &Matrix,
    beams: &[Residual],
    shape: Shape,
) -> BridgingFit {
    let mean = Residual::mean(beams);
    let scale = mean.residual.into_iter().fold(0.0, f64::max);
    let search = |knots: Vec<f64>| Search { geometry: *geometry, matrix: *matrix, knots, shape, scale };
    let search = match shape {
        Shape::Smooth => search(KNOTS.into()),
        Shape::Bilinear => {
            let (from, to, count) = TURNS;
            let turn = |k: i32| from * (to / from).powf(f64::from(k) / f64::from(count - 1));
            let turned = (0..count).map(|k| search(vec![KNOTS[0], turn(k), KNOTS[KNOTS.len() - 1]]));
            let missed = |search: Search| {
                let found = search.find(&mean, FEW);
                (search.misfit(&found.stresses, &mean).norm(), search)
            };
            let best = turned.map(missed).min_by(|a, b| a.0.total_cmp(&b.0));
            best.map_or_else(|| search(KNOTS.into()), |(_, search)| search)
        }
    };
    let found = search.find(&mean, PATIENCE);
    let others = match beams {
        [_] => search.without_each(&found, &mean),
        _ => beams.iter().map(|beam| search.near(&found, beam)).collect(),
    };
    search.fit(&found, &mean, beams, &others)
}

impl Search {
    /// Returns the law without the part that the matrix carries.
    fn law(&self, stresses: &DVector<f64>) -> Polyline {
        let stresses = stresses.as_slice();
        match self.shape {
            Shape::Smooth => smooth_through(&self.knots, stresses),
            Shape::Bilinear => straight_through(&self.knots, stresses),
        }
    }

    /// f_R1–4 of a beam with the law.
    fn strengths(&self, stresses: &DVector<f64>) -> DVector<f64> {
        let law = self.matrix.relieved_by(&self.law(stresses));
        let section = [SectionLaw::new(&self.matrix, &law, self.geometry.hinge())];
        let beam = LayeredBeam::new(self.geometry, &section, &self.matrix);
        RESIDUAL_CMOD.map(|cmod| self.geometry.flexural_strength(beam.at(cmod).force)).to_vec().into()
    }

    fn misfit(&self, stresses: &DVector<f64>, test: &Residual) -> DVector<f64> {
        self.strengths(stresses) - DVector::from(test.residual.to_vec())
    }

    fn linear(&self, about: DVector<f64>) -> Linear {
        let step = STEP * self.scale;
        let at = |k: usize, step: f64| {
            let mut moved = about.clone();
            moved[k] += step;
            self.strengths(&moved)
        };
        let columns: Vec<DVector<f64>> =
            (0..about.len()).map(|k| (at(k, step) - at(k, -step)) / (2.0 * step)).collect();
        Linear { strengths: self.strengths(&about), derivatives: DMatrix::from_columns(&columns), about }
    }

    /// (∫σ''² dw)^½ by second differences at unequal distances.
    fn penalties(&self) -> DMatrix<f64> {
        let count = self.knots.len();
        let is_smooth = self.shape == Shape::Smooth;
        let mut penalties = DMatrix::zeros(if is_smooth { count - 2 } else { 0 }, count);
        for (row, three) in self.knots.windows(3).take(penalties.nrows()).enumerate() {
            let [before, after] = [three[1] - three[0], three[2] - three[1]];
            let weight = (0.5 * (before + after)).sqrt() * 2.0 / (before + after);
            penalties[(row, row)] = weight / before;
            penalties[(row, row + 1)] = -weight * (1.0 / before + 1.0 / after);
            penalties[(row, row + 2)] = weight / after;
        }
        penalties
    }

    /// What must not be below 0: both ends, the rises up to the peak and the falls beyond it.
    fn constraints(&self, peak: usize) -> DMatrix<f64> {
        let last = self.knots.len() - 1;
        let mut constraints = DMatrix::zeros(last + 2, last + 1);
        for k in 0..last {
            let falls = if k < peak { -1.0 } else { 1.0 };
            (constraints[(k, k)], constraints[(k, k + 1)]) = (falls, -falls);
        }
        (constraints[(last, 0)], constraints[(last + 1, last)]) = (1.0, 1.0);
        constraints
    }

    /// The stresses by a linear beam, of all strengths but one if it is said which, and the sum of squares.
    fn solved(
        &self,
        linear: &Linear,
        test: &[f64; 4],
        without: Option<usize>,
        choice: Choice,
    ) -> Option<(DVector<f64>, f64)> {
        let right = DVector::from(test.to_vec()) - &linear.strengths + &linear.derivatives * &linear.about;
        let kept: Vec<usize> = (0..test.len()).filter(|k| Some(*k) != without).collect();
        let penalties = choice.weight * self.penalties();
        let (data, count) = (kept.len(), penalties.nrows());
        let mut rows = DMatrix::zeros(data + count, linear.about.len());
        rows.rows_mut(0, data).copy_from(&linear.derivatives.select_rows(&kept));
        rows.rows_mut(data, count).copy_from(&penalties);
        let right = right.select_rows(&kept).resize_vertically(data + count, 0.0);
        let stresses = constrained(rows.clone(), &right, &self.constraints(choice.peak))?;
        let sum = (rows * &stresses - right).norm_squared();
        Some((stresses, sum))
    }

    /// The stresses with the peak that leaves least; of equal ones the first, which is no peak within.
    fn by_peak(
        &self,
        linear: &Linear,
        test: &[f64; 4],
        without: Option<usize>,
        weight: f64,
    ) -> Option<(DVector<f64>, usize)> {
        let peaks = match self.shape {
            Shape::Smooth => self.knots.len() - 1,
            Shape::Bilinear => 1,
        };
        let small = (ROUNDING * self.scale).powi(2);
        let mut best: Option<(DVector<f64>, usize, f64)> = None;
        for peak in 0..peaks {
            let Some((stresses, sum)) = self.solved(linear, test, without, Choice { peak, weight }) else { continue };
            if best.as_ref().is_none_or(|(.., least)| sum < (1.0 - ROUNDING) * least - small) {
                best = Some((stresses, peak, sum));
            }
        }
        best.map(|(stresses, peak, _)| (stresses, peak))
    }

    /// Returns the heaviest of the weights with which three strengths predict the fourth as well as with any.
    fn choose(&self, linear: &Linear, test: &[f64; 4]) -> Choice {
        let missed = |weight: f64| {
            let of = |k: usize| {
                let (stresses, _) = self.by_peak(linear, test, Some(k), weight)?;
                let predicted = linear.strengths[k] + (linear.derivatives.row(k) * (stresses - &linear.about))[0];
                Some((predicted - test[k]).powi(2))
            };
            (0..test.len()).map(|k| of(k).unwrap_or(f64::INFINITY)).sum::<f64>()
        };
        let weight = match self.shape {
            Shape::Smooth => {
                let all = WEIGHTS.map(missed);
                let least = all.iter().copied().fold(f64::INFINITY, f64::min);
                let good = AS_GOOD * least + (ROUNDING * self.scale).powi(2);
                all.iter().rposition(|missed| *missed <= good).map_or(WEIGHTS[0], |k| WEIGHTS[k])
            }
            Shape::Bilinear => 0.0,
        };
        let peak = self.by_peak(linear, test, None, weight).map_or(0, |(_, peak)| peak);
        Choice { peak, weight }
    }

    fn find(&self, test: &Residual, patience: usize) -> Found {
        let even = test.residual.iter().sum::<f64>() / (3 * test.residual.len()) as f64;
        let mut stresses = DVector::from_element(self.knots.len(), even);
        let mut choice = Choice::default();
        let mut reached = false;
        for step in 0..patience {
            let linear = self.linear(stresses.clone());
            if step < CHOICES {
                choice = self.choose(&linear, &test.residual);
            }
            let Some((next, _)) = self.solved(&linear, &test.residual, None, choice) else { break };
            let change = (&next - &stresses).amax();
            stresses = next;
            reached = change <= SETTLED * self.scale;
            if reached {
                break;
            }
        }
        Found { linear: self.linear(stresses.clone()), stresses, choice, reached }
    }

    /// Returns the stresses of a beam whose law is near the one that was found.
    fn near(&self, found: &Found, test: &Residual) -> DVector<f64> {
        let mut linear = Linear { derivatives: found.linear.derivatives.clone(), ..self.of_strengths(&found.stresses) };
        for _ in 0..FEW {
            let Some((next, _)) = self.solved(&linear, &test.residual, None, found.choice) else { break };
            linear = Linear { derivatives: linear.derivatives, ..self.of_strengths(&next) };
        }
        linear.about
    }

    fn of_strengths(&self, stresses: &DVector<f64>) -> Linear {
        Linear { about: stresses.clone(), strengths: self.strengths(stresses), derivatives: DMatrix::zeros(0, 0) }
    }

    /// The stresses of three strengths out of four.
    fn without_each(&self, found: &Found, test: &Residual) -> Vec<DVector<f64>> {
        let solved = |k: usize| self.solved(&found.linear, &test.residual, Some(k), found.choice);
        (0..test.residual.len()).filter_map(solved).map(|(stresses, _)| stresses).collect()
    }

    /// The law with what is known of it. Errors are those of the mean of several beams, or of the jackknife over the
    /// strengths of one.
    fn fit(&self, found: &Found, mean: &Residual, beams: &[Residual], others: &[DVector<f64>]) -> BridgingFit {
        let Found { stresses, choice, reached, .. } = found;
        let count = others.len().max(1) as f64;
        let middle = others.iter().fold(DVector::zeros(stresses.len()), |sum: DVector<f64>, one| sum + one) / count;
        let several = beams.len() > 1;
        let part = if several { 1.0 / (count * (count - 1.0)) } else { (count - 1.0) / count };
        let covariance = |i: usize, j: usize| {
            part * others.iter().map(|one| (one[i] - middle[i]) * (one[j] - middle[j])).sum::<f64>()
        };
        let error = |k: usize| covariance(k, k).sqrt();
        let law = self.matrix.relieved_by(&self.law(stresses));
        let unknown =
            [self.matrix.modulus, self.matrix.ft].map(|value| Estimate { value, standard_error: f64::INFINITY });
        // the law takes this part of a stress
        let relief = |k: usize| 1.0 - self.matrix.stress(self.knots[k]) / self.matrix.ft;
        let sigma = (0..stresses.len())
            .map(|k| Estimate { value: law.at(self.knots[k]), standard_error: relief(k) * error(k) });
        let estimates: Vec<Estimate> = unknown.into_iter().chain(sigma).collect();
        let correlation =
            DMatrix::from_fn(estimates.len(), estimates.len(), |i, j| match (i.checked_sub(2), j.checked_sub(2)) {
                _ if i == j => 1.0,
                (Some(i), Some(j)) if error(i) * error(j) > 0.0 => covariance(i, j) / (error(i) * error(j)),
                _ => 0.0,
            });
        let band = several.then(|| {
            let at = |k: usize| others.iter().map(|one| one[k]).collect::<Vec<f64>>();
            let of_law = |k: usize, stress: f64| self.matrix.stress(self.knots[k]) + relief(k) * stress;
            (0..stresses.len()).map(|k| BAND.map(|part| of_law(k, quantile(&at(k), part)))).collect()
        });
        let root_mean_square = |rows: DVector<f64>| (rows.norm_squared() / rows.len().max(1) as f64).sqrt();
        let fitted = Fitted {
            parameters: [self.matrix.modulus, self.matrix.ft].into_iter().chain(stresses.iter().copied()).collect(),
            rms: root_mean_square(self.misfit(stresses, mean)) / self.scale,
            penalty: root_mean_square(choice.weight * self.penalties() * stresses) / self.scale,
            reached: *reached,
            estimates,
            correlation,
        };
        BridgingFit { fitted, openings: self.knots.clone(), law, matrix: self.matrix, weight: choice.weight, band }
    }
}

/// Straight lines through stresses at openings, straight on until nothing is left.
fn straight_through(knots: &[f64], stresses: &[f64]) -> Polyline {
    let last = knots.len() - 1;
    let falls = (stresses[last - 1] - stresses[last]) / (knots[last] - knots[last - 1]);
    let end = if falls > 0.0 { stresses[last] / falls } else { f64::INFINITY };
    let beyond = (knots[last] + end.min(knots[last]), stresses[last] * (1.0 - (knots[last] / end).min(1.0)));
    Polyline::new(knots.iter().copied().zip(stresses.iter().copied()).chain([beyond]))
}

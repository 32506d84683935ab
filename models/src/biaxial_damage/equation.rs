//! The scalar equation m = M(m) of one update: weights, damage and M at any m, and its solution.

use super::effective::{EffectiveStress, MOST_BREAK_POINTS};
use super::root::{self, Equation};
use super::weights::Weights;
use super::{Parameters, State};
use crate::damage_law::{DamageLaw, integrity};

/// A residual larger than this fraction of m may be a jump of β instead of a root.
const SUSPICIOUS: f64 = 1e-9;
/// M ≤ 1 + max(η_t, η_c), up to rounding.
const UPPER_MARGIN: f64 = 1.0 + 1e-13;

impl State {
    /// η_t of an energy release rate: the committed one unless Y exceeds all before.
    fn eta_t_at(&self, law: &DamageLaw, y: f64) -> f64 {
        if y > self.y_t_max { self.eta_t.max(law.eta(y)) } else { self.eta_t }
    }

    /// η_c likewise.
    fn eta_c_at(&self, law: &DamageLaw, y: f64) -> f64 {
        if y > self.y_c_max { self.eta_c.max(law.eta(y)) } else { self.eta_c }
    }
}

/// Quantities that follow from m and the weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trial {
    pub m: f64,
    pub weights: Weights,
    /// Y = a + β b.
    pub energy_release_rate: f64,
    pub eta_t: f64,
    pub eta_c: f64,
    /// D/(1 − D).
    pub ratio: f64,
    pub a: f64,
    pub b: f64,
}

impl Trial {
    /// M − 1 = (1 − β) D/(1 − D).
    pub fn excess(&self) -> f64 {
        (1.0 - self.weights.beta) * self.ratio
    }

    /// 1 − D.
    pub fn integrity(&self) -> f64 {
        integrity(self.ratio)
    }

    pub fn integrity_t(&self) -> f64 {
        integrity(self.eta_t)
    }

    pub fn integrity_c(&self) -> f64 {
        integrity(self.eta_c)
    }

    pub fn y_t(&self) -> f64 {
        self.weights.r_t * self.energy_release_rate
    }

    pub fn y_c(&self) -> f64 {
        self.weights.r_c * self.energy_release_rate
    }

    /// dD_t/dY_t and dD_c/dY_c, 0 where damage does not grow.
    pub fn damage_rates(&self, parameters: &Parameters, history: &State) -> (f64, f64) {
        let rate = |law: &DamageLaw, y: f64, eta: f64, before: f64| {
            if eta > before { law.damage_rate(y, eta) } else { 0.0 }
        };
        (
            rate(&parameters.tension, self.y_t(), self.eta_t, history.eta_t),
            rate(&parameters.compression, self.y_c(), self.eta_c, history.eta_c),
        )
    }
}

/// D/(1 − D) of D = r_t D_t + r_c D_c.
fn mixed_ratio(r_t: f64, r_c: f64, eta_t: f64, eta_c: f64) -> f64 {
    let (omega_t, omega_c) = (r_t * integrity(eta_t), r_c * integrity(eta_c));
    (omega_t * eta_t + omega_c * eta_c) / (omega_t + omega_c)
}

/// One update: everything but m.
pub(super) struct Update<'u> {
    pub parameters: &'u Parameters,
    pub history: &'u State,
    pub effective: &'u EffectiveStress,
    /// Weights that do not follow m.
    pub fixed: Option<Weights>,
    /// β_b if it does not depend on m.
    pub biaxial: Option<f64>,
}

impl Equation for Update<'_> {
    type Sample = Option<Trial>;

    #[inline]
    fn sample(&self, m: f64) -> Option<Trial> {
        let (a, b) = self.effective.energies(m);
        let weights = match self.fixed {
            Some(weights) => weights,
            None => self.parameters.hydrostatic.weights(&self.effective.principal(m), (a, b), self.biaxial)?,
        };
        let y = a + weights.beta * b;
        let eta_t = self.history.eta_t_at(&self.parameters.tension, weights.r_t * y);
        let eta_c = self.history.eta_c_at(&self.parameters.compression, weights.r_c * y);
        let ratio = mixed_ratio(weights.r_t, weights.r_c, eta_t, eta_c);
        Some(Trial { m, weights, energy_release_rate: y, eta_t, eta_c, ratio, a, b })
    }

    /// Returns NaN if the stress has no direction; that occurs only at zero strain, which comes with fixed weights.
    #[inline]
    fn residual(sample: &Option<Trial>) -> f64 {
        sample.as_ref().map_or(f64::NAN, |trial| trial.excess() - (trial.m - 1.0))
    }

    /// Y_t − Y_t,max and Y_c − Y_c,max: where one falls through 0, damage stops falling with it. A state that
    /// was committed with growing damage lies on such a point if the same strain is met again.
    #[inline]
    fn kinks(&self, sample: &Option<Trial>) -> [f64; 2] {
        sample
            .as_ref()
            .map_or([0.0; 2], |trial| [trial.y_t() - self.history.y_t_max, trial.y_c() - self.history.y_c_max])
    }

    /// Between kinks r_t is monotone (a quotient of linear functions), β is bounded by
    /// [`super::HydrostaticWeight::beta_bounds`], a rises and b falls; a lower bound of M follows.
    fn excluded(&self, start: &Option<Trial>, (m, end): (f64, &Option<Trial>)) -> bool {
        let (Some(start), Some(end)) = (start, end) else { return false };
        let ends = [&start.weights, &end.weights];
        let (beta_lower, beta_upper) = match self.fixed {
            Some(weights) => (weights.beta, weights.beta),
            None => self.parameters.hydrostatic.beta_bounds(ends, self.biaxial, end.a + start.b),
        };
        let y = start.a + beta_lower * end.b;
        let eta_t = self.history.eta_t_at(&self.parameters.tension, y * ends[0].r_t.min(ends[1].r_t));
        let eta_c = self.history.eta_c_at(&self.parameters.compression, y * ends[0].r_c.min(ends[1].r_c));
        // linear in r_t at given η: least at one of the ends
        let [first, second] = ends.map(|weights| mixed_ratio(weights.r_t, weights.r_c, eta_t, eta_c));
        (1.0 - beta_upper) * first.min(second) > (m - 1.0) * UPPER_MARGIN
    }
}

impl Update<'_> {
    /// The least solution; `None` if there is none.
    pub fn solve(&self) -> Option<Trial> {
        let first = self.sample(1.0)?;
        let excess = first.excess();
        // q and with it M do not depend on m
        let constant = self.effective.is_constant() || (self.fixed.is_some() && self.effective.out_of_plane.is_none());
        if excess == 0.0 || constant {
            return Some(Trial { m: 1.0 + excess, ..first });
        }
        let bound = self.effective.energy_bound();
        let eta_t = self.history.eta_t.max(self.parameters.tension.eta(bound));
        let eta_c = self.history.eta_c.max(self.parameters.compression.eta(bound));
        let upper = (1.0 + eta_t.max(eta_c)) * UPPER_MARGIN;
        let mut points = [0.0; MOST_BREAK_POINTS];
        let count = match self.fixed {
            Some(_) => 0,
            None => self.effective.break_points(self.parameters.hydrostatic.kinks(), upper, &mut points),
        };
        let root = root::least_root(self, Some(first), &points[..count], upper)?;
        let trial = self.sample(root.x)?;
        if root.residual.abs() > SUSPICIOUS * root.x {
            let other = self.sample(root.other)?;
            if (other.weights.beta - trial.weights.beta).abs() > SUSPICIOUS {
                return None; // the least β_b jumped past the root
            }
        }
        Some(trial)
    }
}

//! Equilibrium beside that of another model, from which this one differs by a little.

use super::correction::Wanted;
use super::{Attempt, CUT, Committed, Converged, Equilibrium, Iteration, Leader, Target, largest, trouble, unsolvable};
use crate::assembly::{Place, System, Trouble};
use crate::model::IncrementContext;
use umat_abi::law::Request;

/// What is left of the unbalanced forces, as part of the greatest that the difference of the models has made so far.
const TOLERANCE: f64 = 1e-6;
/// What rounding of positions makes of them, as part of what it might at most: 2·10⁻³ to 6·10⁻³ were seen.
const NOISE: f64 = 1e-2;
/// A new factor that leaves more than this, where no more than rounding may be left, has nothing to correct.
const STALLED: f64 = 0.3;
/// A factor that leaves more of them than this is not that of the present tangents.
const SLOW: f64 = 1e-2;
/// Corrections of one equilibrium.
const MOST_CORRECTIONS: usize = 12;
/// Drives so near to where they shall be, as a part of it, are there.
const ROUNDING: f64 = 1e-12;

/// How far a model is from the one that it goes along with: its displacements and drives less those.
#[derive(Clone, Debug, Default)]
pub(in crate::stepping) struct Ahead {
    displacements: Vec<f64>,
    drives: Vec<f64>,
    /// The greatest unbalanced force, N, and the most that what leads has missed, that the difference has made so far.
    greatest: [f64; 2],
    /// The greatest unbalanced force that was left, N.
    left: f64,
}

impl Ahead {
    /// Takes the distance of two states.
    pub(in crate::stepping) fn set(&mut self, own: &Committed, other: &Committed) {
        let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
        self.displacements = difference(&own.displacements, &other.displacements);
        self.drives = difference(&own.drives, &other.drives);
    }

    /// Returns how much of what the difference makes is rounding.
    pub(in crate::stepping) fn uncertainty(&self) -> f64 {
        if self.left > 0.0 { self.left / self.greatest[0] } else { 0.0 }
    }

    fn added_to(&self, other: &Committed) -> Committed {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Committed {
            displacements: sum(&other.displacements, &self.displacements),
            drives: sum(&other.drives, &self.drives),
            ..other.clone()
        }
    }
}

/// The equilibrium that another one is sought beside.
pub(in crate::stepping) struct Beside<'a, 'b> {
    pub(in crate::stepping) other: &'a mut Equilibrium<'b>,
    /// Where its increment started, and where it is.
    pub(in crate::stepping) between: [&'a Committed; 2],
    /// Iterations that led there.
    pub(in crate::stepping) iterations: usize,
    /// A better factor than its last one.
    pub(in crate::stepping) factor: Option<&'a mut System>,
    /// Whether it is where the increment ends.
    pub(in crate::stepping) ends: bool,
}

impl Equilibrium<'_> {
    /// Goes where the residual is that of another equilibrium, and what leads has grown as far: with the other's last factor,
    /// or with one of its own tangents where that does not serve. Says whether it made one.
    pub(in crate::stepping) fn go_beside(
        &mut self,
        beside: Beside<'_, '_>,
        start: &Committed,
        target: &Target,
        context: IncrementContext,
        ahead: &mut Ahead,
    ) -> Result<(Converged, bool), Trouble> {
        let Beside { other, between: [from, at], iterations, mut factor, ends } = beside;
        if self.zone != other.zone {
            self.set_zone(other.zone.clone()).map_err(|error| unsolvable(&error))?;
        }
        self.leading_point = other.leading_point.map(|(point, _)| (point, self.contact.slip_at_start(point)));
        let mut attempt = Attempt {
            trial: ahead.added_to(at),
            iterations: vec![Iteration::default(); iterations],
            ..Attempt::new(start, target, context)
        };
        let growth = other.growth_since(from, target);
        let mut makes_factor = factor.is_none() && !other.memory.factorised;
        let mut has_own_factor = false;
        let mut before = f64::INFINITY;
        for correction in 0..=MOST_CORRECTIONS {
            self.evaluate_for(&attempt, Request::Stress)?;
            let residual = self.memory.residual.iter().zip(&other.memory.residual).map(|(own, other)| own - other);
            let residual: Vec<f64> = residual.collect();
            let sizes = [largest(&residual), self.missing(&attempt, growth)];
            if correction == 0 {
                ahead.greatest = [0, 1].map(|k| sizes[k].max(ahead.greatest[k]));
            }
            let noise = [NOISE * other.memory.rounding, 0.0];
            let is_small = |k: usize| sizes[k] <= (TOLERANCE * ahead.greatest[k]).max(noise[k]);
            let is_stalled = has_own_factor && sizes[0] > STALLED * before && sizes[0] <= other.memory.rounding;
            // a correction of less than the noise is still the best that is known
            if (correction > 0 || sizes == [0.0; 2]) && (is_small(0) || is_stalled) && is_small(1) {
                ahead.left = ahead.left.max(sizes[0]);
                if ends && self.zone.condenses() {
                    self.expand(&mut attempt)?;
                }
                ahead.set(&attempt.trial, at);
                return Ok((self.converged(attempt), has_own_factor));
            }
            makes_factor |= correction > 0 && sizes[0] > SLOW * before;
            if std::mem::take(&mut makes_factor) {
                self.evaluate(&attempt)?;
                self.factorise()?;
                has_own_factor = true;
            }
            before = sizes[0];
            let best = match &mut factor {
                _ if has_own_factor => None,
                Some(factor) => Some(&mut **factor),
                None => Some(&mut other.system),
            };
            let wanted = Wanted { residual, growth, moves_drives: sizes[1] > 0.0 };
            let direction = self.direction_to(&attempt, wanted, best)?;
            let from = std::mem::take(&mut attempt.trial.displacements);
            attempt.trial.displacements = from.iter().zip(&direction.displacements).map(|(u, du)| u + du).collect();
            attempt.trial.drives.iter_mut().zip(&direction.drives).for_each(|(drive, change)| *drive += change);
        }
        Err(trouble(Place::System, "no equilibrium is found beside the run's own".into(), CUT))
    }

    /// How far what leads has grown since the start of an increment.
    fn growth_since(&self, start: &Committed, target: &Target) -> f64 {
        match target {
            Target::Drives(_) => 0.0,
            Target::Led { by: Leader::PointSlip, .. } => {
                self.leading_point.map_or(0.0, |(point, start)| self.contact.slip_of(point) - start)
            }
            Target::Led { by: Leader::Dissipation, .. } => self.solids.trial_dissipation() - start.dissipation,
        }
    }

    /// How much is missing of what the drives, or what leads, shall have done; 0 if no more than rounding.
    fn missing(&self, attempt: &Attempt<'_>, growth: f64) -> f64 {
        match attempt.target {
            Target::Drives(goal) => {
                let missing = goal.iter().zip(&attempt.trial.drives).map(|(to, from)| (to - from).abs());
                missing
                    .zip(goal)
                    .filter(|(missing, to)| *missing > ROUNDING * to.abs())
                    .fold(0.0, |most, (m, _)| most.max(m))
            }
            target @ Target::Led { .. } => (growth - self.growth_since(attempt.start, target)).abs(),
        }
    }
}

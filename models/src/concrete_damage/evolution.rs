//! One update in principal strains: how inelastic strain and damage grow (doc.md).
//!
//! Everything is coaxial with the trial strain, so the whole law is an isotropic function of its three
//! principal values.

use super::Parameters;
use super::crack_band::{Damage, Softening};
use super::criteria::Criteria;
use super::inelastic::Flow;
use super::stress_and_tangent::Degraded;
use umat_abi::table::StateField;

/// Damage η and the largest energy release rate so far, of one branch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Branch {
    /// η.
    pub eta: f64,
    /// The largest Y.
    pub maximum: f64,
}

impl Branch {
    /// Advances to the energy release rate Y: D = max(D_n, D̂(Y)); returns how D grows, if
    /// it does. An excess over the maximum within `rounding` counts as 0.
    #[inline]
    pub fn advance(&mut self, softening: &Softening, energy: f64, rounding: f64) -> Option<Damage> {
        if energy - rounding <= self.maximum.max(softening.curve.law.threshold) {
            return None;
        }
        self.maximum = energy;
        let damage = softening.damage(energy);
        if damage.eta <= self.eta {
            return None;
        }
        self.eta = damage.eta;
        Some(damage)
    }
}

/// History of both branches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct History {
    pub tension: Branch,
    pub compression: Branch,
}

impl StateField<4> for History {
    #[inline(always)]
    fn of([eta_t, eta_c, y_t_max, y_c_max]: [f64; 4]) -> Self {
        Self { tension: Branch { eta: eta_t, maximum: y_t_max }, compression: Branch { eta: eta_c, maximum: y_c_max } }
    }

    #[inline(always)]
    fn values(&self) -> [f64; 4] {
        let Self { tension, compression } = self;
        [tension.eta, compression.eta, tension.maximum, compression.maximum]
    }
}

impl History {
    /// η_t and η_c.
    #[inline(always)]
    pub fn etas(&self) -> [f64; 2] {
        [self.tension.eta, self.compression.eta]
    }

    /// Returns whether nothing is damaged.
    #[inline]
    pub fn is_undamaged(&self) -> bool {
        self.tension.eta == 0.0 && self.compression.eta == 0.0
    }
}

/// The response to one principal trial strain from one committed history.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evolution {
    /// Criteria at the elastic strain of the end.
    pub criteria: Criteria,
    /// Inelastic strain of this increment, if there is any.
    pub flow: Option<Flow>,
    /// The history at the end.
    pub history: History,
    /// Damage in tension and compression where it grows.
    pub growth: [Option<Damage>; 2],
    /// The solid at the new damage.
    pub solid: Degraded,
}

impl Evolution {
    /// Advances `history` to the principal trial strain (descending).
    #[inline(always)]
    pub fn new(parameters: &Parameters, softening: &[Softening; 2], history: &History, strain: &[f64; 3]) -> Self {
        let flow = Flow::new(parameters, history, strain);
        let elastic_strain = flow.as_ref().map_or(*strain, |flow| flow.elastic_strain);
        let criteria = Criteria::new(parameters, &elastic_strain);
        let mut history = *history;
        // ε_e = ε − ε_p is recovered from the state with rounding: the same point must stay the same point
        let rounding = if parameters.has_inelastic_strain() { criteria.rounding(parameters) } else { [0.0; 2] };
        let growth = [
            history.tension.advance(&softening[0], criteria.tension, rounding[0]),
            history.compression.advance(&softening[1], criteria.compression, rounding[1]),
        ];
        let solid = Degraded::new(parameters, history.tension.eta, history.compression.eta, &elastic_strain);
        Self { criteria, flow, history, growth, solid }
    }

    /// Advances `history` to the principal strain (descending), with the stress of a solid whose η_t, η_c are given.
    /// Without inelastic strain.
    #[inline]
    pub fn at_given_damage(
        parameters: &Parameters,
        softening: &[Softening; 2],
        history: &History,
        [eta_t, eta_c]: [f64; 2],
        strain: &[f64; 3],
    ) -> Self {
        let solid = Degraded::new(parameters, eta_t, eta_c, strain);
        Self { growth: [None; 2], solid, ..Self::new(parameters, softening, history, strain) }
    }
}

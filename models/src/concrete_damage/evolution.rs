//! One update in principal strains: inelastic strain, damage, stress, tangent (doc.md).
//!
//! Everything is coaxial with the trial strain, so the whole law is an isotropic function of its three
//! principal values.

use super::criteria::{Criteria, times};
use super::degraded::Degraded;
use super::inelastic::Flow;
use super::softening::{Damage, Softening};
use super::{Branch, History, Parameters};

/// The response to one principal trial strain from one committed history.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evolution {
    criteria: Criteria,
    /// Inelastic strain of this increment, if there is any.
    pub flow: Option<Flow>,
    /// The history at the end.
    pub history: History,
    /// Damage in tension and compression where it grows.
    pub growth: [Option<Damage>; 2],
    /// The solid at the new damage.
    pub solid: Degraded,
}

/// Advances one branch to the energy release rate Y: D = max(D_n, D̂(Y)); returns how D grows, if
/// it does. An excess over the maximum within `rounding` is none.
#[inline]
fn advance(branch: &mut Branch, softening: &Softening, energy: f64, rounding: f64) -> Option<Damage> {
    if energy - rounding <= branch.maximum.max(softening.curve.law.threshold) {
        return None;
    }
    branch.maximum = energy;
    let damage = softening.damage(energy);
    if damage.eta <= branch.eta {
        return None;
    }
    branch.eta = damage.eta;
    Some(damage)
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
            advance(&mut history.tension, &softening[0], criteria.tension, rounding[0]),
            advance(&mut history.compression, &softening[1], criteria.compression, rounding[1]),
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

    /// The consistent tangent in principal axes: H_ij = ∂s_i/∂e_j and d_12, d_13, d_23.
    #[inline]
    pub fn tangent(&self, parameters: &Parameters) -> ([[f64; 3]; 3], [f64; 3]) {
        let (mut tangent, mut shear) = self.solid.stiffness();
        let mut add = |rate: f64, softening: [f64; 3], gradient: [f64; 3]| {
            for i in 0..3 {
                for j in 0..3 {
                    tangent[i][j] += rate * softening[i] * gradient[j];
                }
            }
        };
        if let Some(damage) = &self.growth[0] {
            add(damage.rate, self.solid.tensile_softening(), self.criteria.tension_gradient(parameters));
        }
        if let Some(damage) = &self.growth[1] {
            let softening = self.solid.compressive_softening(parameters);
            add(damage.rate, softening, self.criteria.compression_gradient(parameters));
        }
        if let Some(flow) = &self.flow {
            let (gradient, factors) = flow.gradient(parameters);
            let columns: [[f64; 3]; 3] = std::array::from_fn(|j| times(&tangent, &[0, 1, 2].map(|i| gradient[i][j])));
            tangent = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
            for (d, factor) in shear.iter_mut().zip(factors) {
                *d *= factor;
            }
        }
        (tangent, shear)
    }
}

impl Evolution {
    /// Whether the solid is still virgin at the end.
    #[inline]
    pub fn is_undamaged(&self) -> bool {
        self.history.tension.eta == 0.0 && self.history.compression.eta == 0.0
    }
}

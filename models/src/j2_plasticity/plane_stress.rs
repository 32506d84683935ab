//! Plane stress: the projected return of Simo & Taylor. In sum, difference and shear
//! S = σ11 + σ22, D = σ11 − σ22, T = σ12 everything is diagonal, and one scalar κ remains.

use super::{Parameters, Returned, State, admissible_stress};
use crate::roots::bracketed_newton;
use crate::tensor::{Elasticity, add_dyad};
use umat_abi::law::Request;

/// The moduli of S and D at a given κ = 3Δp/(2q), and the in-plane stress that goes with them.
struct Projected {
    sum_modulus: f64,
    difference_modulus: f64,
    sum: f64,
    difference: f64,
    shear: f64,
}

impl Projected {
    /// S = c tr ε/(1 + cκ/3), D = 2μ(ε11 − ε22)/(1 + 2μκ), T = μγ/(1 + 2μκ), c = E/(1 − ν).
    fn new(elasticity: &Elasticity, trial: &[f64; 6], kappa: f64) -> Self {
        let biaxial = elasticity.youngs_modulus / (1.0 - elasticity.poisson_ratio);
        let two_mu = 2.0 * elasticity.shear_modulus;
        let sum_modulus = biaxial / (1.0 + biaxial * kappa / 3.0);
        let difference_modulus = two_mu / (1.0 + two_mu * kappa);
        Self {
            sum_modulus,
            difference_modulus,
            sum: sum_modulus * (trial[0] + trial[1]),
            difference: difference_modulus * (trial[0] - trial[1]),
            shear: 0.5 * difference_modulus * trial[3],
        }
    }

    /// q² = S²/4 + 3D²/4 + 3T².
    fn equivalent_stress(&self) -> f64 {
        let Self { sum, difference, shear, .. } = *self;
        (0.25 * sum * sum + 0.75 * difference * difference + 3.0 * shear * shear).sqrt()
    }

    /// s as a strain: what κ multiplies to give Δεᵖ.
    fn flow(&self) -> [f64; 6] {
        let Self { sum, difference, shear, .. } = *self;
        [sum / 6.0 + 0.5 * difference, sum / 6.0 - 0.5 * difference, -sum / 3.0, 2.0 * shear, 0.0, 0.0]
    }

    fn stress(&self) -> [f64; 6] {
        let Self { sum, difference, shear, .. } = *self;
        [0.5 * (sum + difference), 0.5 * (sum - difference), 0.0, shear, 0.0, 0.0]
    }

    /// Ξ = (C⁻¹ + κP)⁻¹.
    fn stiffness(&self) -> [[f64; 6]; 6] {
        let mut stiffness = [[0.0; 6]; 6];
        stiffness[0][0] = 0.5 * (self.sum_modulus + self.difference_modulus);
        stiffness[0][1] = 0.5 * (self.sum_modulus - self.difference_modulus);
        stiffness[1][0] = stiffness[0][1];
        stiffness[1][1] = stiffness[0][0];
        stiffness[3][3] = 0.5 * self.difference_modulus;
        stiffness
    }

    /// Ξ s.
    fn stiffness_times_flow(&self) -> [f64; 6] {
        let sum = self.sum_modulus * self.sum / 3.0;
        let difference = self.difference_modulus * self.difference;
        [0.5 * (sum + difference), 0.5 * (sum - difference), 0.0, self.difference_modulus * self.shear, 0.0, 0.0]
    }

    /// −dq/dκ = (3/2) s:Ξ:s/q.
    fn decay(&self, equivalent_stress: f64) -> f64 {
        let (sum, difference, shear) = (self.sum, self.difference, self.shear);
        let sums = self.sum_modulus * sum * sum / 12.0;
        let differences = self.difference_modulus * (0.75 * difference * difference + 3.0 * shear * shear);
        (sums + differences) / equivalent_stress
    }
}

/// Solves q(κ) = σ_y(p + (2/3) κ q(κ)). As 1/q − 1/σ_y, the first term nearly linear in κ, so that
/// Newton's method needs a few steps; the radial return's κ is the start.
fn solve_kappa(parameters: &Parameters<'_>, trial: &[f64; 6], trial_stress: f64, peeq: f64) -> f64 {
    let Parameters { elasticity, hardening } = parameters;
    let two_mu = 2.0 * elasticity.shear_modulus;
    // q falls at least as fast as the sum does: q ≤ q_trial/(1 + cκ/3)
    let slowest = elasticity.youngs_modulus / (3.0 * (1.0 - elasticity.poisson_ratio));
    let highest = (trial_stress / hardening.least() - 1.0) / slowest;
    let (radial, _) = hardening.radial_return(trial_stress, peeq, 1.5 * two_mu);
    let start = (1.5 * radial / hardening.yield_stress(peeq + radial)).min(highest);
    let resolution = f64::EPSILON / two_mu;
    bracketed_newton([0.0, highest], start, resolution, |kappa| {
        let projected = Projected::new(elasticity, trial, kappa);
        let q = projected.equivalent_stress();
        let decay = projected.decay(q);
        let end = peeq + 2.0 / 3.0 * kappa * q;
        let yield_stress = hardening.yield_stress(end);
        let growth = hardening.slope(end) * 2.0 / 3.0 * (q - kappa * decay);
        let value = (yield_stress - q) / (q * yield_stress);
        (value, decay / (q * q) + growth / (yield_stress * yield_stress))
    })
}

/// Returns the trial state with in-plane elastic strain `trial`.
#[inline(always)]
pub(super) fn plane_stress_return(
    parameters: &Parameters<'_>,
    trial: &[f64; 6],
    state: &State,
    request: Request,
) -> Returned {
    let Parameters { elasticity, hardening } = parameters;
    let peeq = state.peeq;
    let elastic = Projected::new(elasticity, trial, 0.0);
    let trial_stress = elastic.equivalent_stress();
    let plastic = trial_stress > admissible_stress(hardening, peeq, 0.0);
    let kappa = if plastic { solve_kappa(parameters, trial, trial_stress, peeq) } else { 0.0 };
    let projected = if plastic { Projected::new(elasticity, trial, kappa) } else { elastic };
    let q = projected.equivalent_stress();
    let peeq_increment = 2.0 / 3.0 * kappa * q;
    let flow = projected.flow();
    let mut tangent = [[0.0; 6]; 6];
    if request.wants_tangent() {
        tangent = projected.stiffness();
        if plastic {
            // Ξ − θ Ξs ⊗ Ξs/(θ s:Ξ:s + (4/9) H q²), θ = 1 − (2/3) H κ
            let slope = hardening.slope(peeq + peeq_increment);
            let theta = 1.0 - 2.0 / 3.0 * slope * kappa;
            let image = projected.stiffness_times_flow();
            let denominator = theta * 2.0 / 3.0 * q * projected.decay(q) + 4.0 / 9.0 * slope * q * q;
            add_dyad(&mut tangent, -theta / denominator, &image, &image);
        }
    }
    let plastic_increment = flow.map(|s| kappa * s);
    let elastic_strain_33 = -elasticity.poisson_ratio / elasticity.youngs_modulus * projected.sum;
    Returned {
        equivalent_stress: q,
        mean_stress: projected.sum / 3.0,
        stress: projected.stress(),
        tangent,
        peeq_increment,
        plastic_increment,
        strain_33: state.plastic_strain[2] + (elastic_strain_33 + plastic_increment[2]),
    }
}

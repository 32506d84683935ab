//! The consistent tangent (doc.md), with ε33 eliminated exactly in plane stress.

use super::effective::{EffectiveStress, Gradient};
use super::equation::Trial;
use super::weights::WeightGradients;
use super::{Parameters, State};
use crate::tensor::add_dyad;

/// 1 − ∂M/∂m below this fraction of its terms is a fold: the response has no derivative there.
const FOLD: f64 = 1e-10;

/// dm/dε and dD/dε of the solution, through m = M(m).
fn total_derivatives(
    parameters: &Parameters,
    history: &State,
    effective: &EffectiveStress,
    trial: &Trial,
    weights: &WeightGradients,
) -> Option<([f64; 6], [f64; 6])> {
    let (m, r_t, r_c, beta) = (trial.m, trial.weights.r_t, trial.weights.r_c, trial.weights.beta);
    let (_, b) = effective.energies(m);
    let (a_gradient, b_gradient) = effective.energy_gradients(m);
    let y = trial.energy_release_rate;
    let y_gradient = Gradient::combination([(1.0, &a_gradient), (beta, &b_gradient), (b, &weights.beta)]);
    let (rate_t, rate_c) = trial.damage_rates(parameters, history);
    // D = r_t D_t(r_t Y) + r_c D_c(r_c Y)
    let by_r_t = (trial.integrity_c() - trial.integrity_t()) + y * (r_t * rate_t - r_c * rate_c);
    let by_y = r_t * r_t * rate_t + r_c * r_c * rate_c;
    let damage = Gradient::combination([(by_r_t, &weights.r_t), (by_y, &y_gradient)]);
    // M − 1 = (1 − β) D/(1 − D)
    let by_damage = (1.0 - beta) * (1.0 + trial.ratio) * (1.0 + trial.ratio);
    let excess = Gradient::combination([(by_damage, &damage), (-trial.ratio, &weights.beta)]);
    let denominator = 1.0 - excess.m;
    if denominator.abs() <= FOLD * (1.0 + excess.m.abs()) {
        return None;
    }
    let m_total = excess.strain.map(|x| x / denominator);
    let damage_total: [f64; 6] = std::array::from_fn(|i| damage.strain[i] + damage.m * m_total[i]);
    let finite = m_total.iter().chain(&damage_total).all(|x| x.is_finite());
    finite.then_some((m_total, damage_total))
}

/// C = (1−D)(2μ I_dev + m k I⊗I) + (1−D) k θ I ⊗ dm − (2μ e + m k θ I) ⊗ dD; at a fold the first term alone,
/// the secant at frozen D and β.
pub(super) fn consistent_tangent(
    parameters: &Parameters,
    history: &State,
    effective: &EffectiveStress,
    trial: &Trial,
    weights: &WeightGradients,
) -> [[f64; 6]; 6] {
    let (mu, k) = (parameters.elasticity.shear_modulus, parameters.elasticity.bulk_modulus);
    let (m, integrity) = (trial.m, trial.integrity());
    let (m_total, damage_total) =
        total_derivatives(parameters, history, effective, trial, weights).unwrap_or(([0.0; 6], [0.0; 6]));
    let direct = integrity * (m * k + 4.0 / 3.0 * mu);
    let cross = integrity * (m * k - 2.0 / 3.0 * mu);
    let mut tangent = [[0.0; 6]; 6];
    for i in 0..3 {
        tangent[i][..3].fill(cross);
        tangent[i][i] = direct;
        tangent[i + 3][i + 3] = integrity * mu;
    }
    if effective.out_of_plane.is_some() {
        // dε33 = ratio (dε11 + dε22) + rate dm
        let (ratio, rate) = (effective.strain_33_ratio(m), effective.strain_33_rate(m));
        let lateral = [ratio, ratio, 0.0, 0.0, 0.0, 0.0];
        add_dyad(&mut tangent, cross, &[1.0, 1.0, 0.0, 0.0, 0.0, 0.0], &lateral);
        add_dyad(&mut tangent, cross * rate, &[1.0, 1.0, 0.0, 0.0, 0.0, 0.0], &m_total);
    }
    let volumetric = k * effective.volumetric(m);
    add_dyad(&mut tangent, integrity * volumetric, &[1.0, 1.0, 1.0, 0.0, 0.0, 0.0], &m_total);
    let mut effective_stress = effective.deviatoric_stress(m);
    for normal in &mut effective_stress[..3] {
        *normal += m * volumetric;
    }
    add_dyad(&mut tangent, -1.0, &effective_stress, &damage_total);
    if effective.out_of_plane.is_some() {
        for i in [2, 4, 5] {
            tangent[i] = [0.0; 6];
            for row in &mut tangent {
                row[i] = 0.0;
            }
        }
    }
    tangent
}

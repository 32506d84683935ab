//! Stress, energy, forces and stiffness at given damage: the hyperelastic part; and the consistent tangent (doc.md).

use super::criteria::{degradable_energy, times};
use super::evolution::{Evolution, History};
use super::plane_stress;
use super::split::{Split, principal_stiffness, principal_stress};
use super::{Parameters, State};
use crate::damage_law::{damage, integrity};
use crate::tensor::{Elasticity, Spectral, stress_norm_squared};
use umat_abi::law::{Failure, Increment, Request, Response, StressState};

/// K_c(D_c) = (1 − D_c) 2μ I_dev + (1 − β D_c) k I ⊗ I.
#[inline]
pub(super) fn degraded_elasticity(parameters: &Parameters, eta_c: f64) -> Elasticity {
    let virgin = &parameters.elasticity;
    if eta_c == 0.0 {
        return *virgin;
    }
    let mu = integrity(eta_c) * virgin.shear_modulus;
    let k = hydrostatic_integrity(parameters, eta_c) * virgin.bulk_modulus;
    Elasticity::from_bulk_and_shear(k, mu)
}

/// 1 − β D_c without cancellation: (1 − β) + β (1 − D_c).
#[inline]
fn hydrostatic_integrity(parameters: &Parameters, eta_c: f64) -> f64 {
    (1.0 - parameters.beta) + parameters.beta * integrity(eta_c)
}

/// The response of the cracked, softened solid to one principal strain at fixed damage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Degraded {
    eta_t: f64,
    eta_c: f64,
    elasticity: Elasticity,
    strain: [f64; 3],
    split: Split,
    /// K_c : ε.
    full: [f64; 3],
    /// σ = (1 − D_t) K_c : ε + D_t σ_NT.
    pub stress: [f64; 3],
}

impl Degraded {
    /// Degrades the stiffness at principal strains in descending order.
    #[inline]
    pub fn new(parameters: &Parameters, eta_t: f64, eta_c: f64, strain: &[f64; 3]) -> Self {
        let elasticity = degraded_elasticity(parameters, eta_c);
        let full = principal_stress(&elasticity, strain);
        let split = Split::new(&elasticity, strain);
        let (w, d) = (integrity(eta_t), damage(eta_t));
        let stress = std::array::from_fn(|i| w * full[i] + d * split.stress[i]);
        Self { eta_t, eta_c, elasticity, strain: *strain, split, full, stress }
    }

    /// Ψ = ½ σ : ε (Ψ is homogeneous of degree 2 in ε).
    #[inline]
    pub fn energy(&self) -> f64 {
        0.5 * dot(&self.stress, &self.strain)
    }

    /// The rounding error to expect in a principal stress, MPa: one unit in the last place of the terms
    /// it is the sum of.
    #[inline]
    pub fn rounding(&self) -> f64 {
        let modulus = self.elasticity.lambda.abs() + 2.0 * self.elasticity.shear_modulus;
        let size = |e: &[f64; 3]| e[0].abs() + e[1].abs() + e[2].abs();
        let (w, d) = (integrity(self.eta_t), damage(self.eta_t));
        f64::EPSILON * modulus * (w * size(&self.strain) + d * size(&self.split.minus))
    }

    /// −∂Ψ/∂D_t = ½ ε : K_c : ε − ψ_NT ≥ 0.
    #[inline]
    pub fn tensile_force(&self) -> f64 {
        (0.5 * (dot(&self.full, &self.strain) - dot(&self.split.stress, &self.strain))).max(0.0)
    }

    /// −∂Ψ/∂D_c = (1 − D_t)(a + β b) + D_t (a⁻ + β b⁻) ≥ 0.
    #[inline]
    pub fn compressive_force(&self, parameters: &Parameters) -> f64 {
        let [full, open] = self.degradable_energies(parameters);
        integrity(self.eta_t) * full + damage(self.eta_t) * open
    }

    /// a + β b and a⁻ + β b⁻: −∂/∂D_c of the energy without cracks, and with open ones.
    #[inline]
    pub fn degradable_energies(&self, parameters: &Parameters) -> [f64; 2] {
        [self.strain, self.split.minus].map(|strain| degradable_energy(parameters, &strain))
    }

    /// ∂σ/∂ε at fixed damage: (1 − D_t) K_c + D_t C_NT, as (H, d).
    #[inline]
    pub fn stiffness(&self) -> ([[f64; 3]; 3], [f64; 3]) {
        let (w, d) = (integrity(self.eta_t), damage(self.eta_t));
        let full = principal_stiffness(&self.elasticity);
        let open = self.split.stiffness(&self.elasticity);
        let shear = self.split.shear_stiffness(&self.elasticity, &self.strain);
        let two_mu = 2.0 * self.elasticity.shear_modulus;
        (
            std::array::from_fn(|i| std::array::from_fn(|j| w * full[i][j] + d * open[i][j])),
            shear.map(|s| w * two_mu + d * s),
        )
    }

    /// ∂σ/∂D_t = −(K_c : ε − σ_NT).
    #[inline]
    pub fn tensile_softening(&self) -> [f64; 3] {
        std::array::from_fn(|i| self.split.stress[i] - self.full[i])
    }

    /// ∂σ/∂D_c = (1 − D_t) K_c' : ε + D_t s', with K_c' : ε = −(2μ e + β k θ I) and
    /// s' = −C_NT(K_c) : [e⁻/(1 − D_c) + (β/(1 − β D_c)) (θ⁻/3) I].
    #[inline]
    pub fn compressive_softening(&self, parameters: &Parameters) -> [f64; 3] {
        let (w, d) = (integrity(self.eta_t), damage(self.eta_t));
        let virgin = &parameters.elasticity;
        let volume: f64 = self.strain.iter().sum();
        let minus = &self.split.minus;
        let mean_minus = (minus[0] + minus[1] + minus[2]) / 3.0;
        let hydrostatic = parameters.beta / hydrostatic_integrity(parameters, self.eta_c);
        let dual = minus.map(|e| (e - mean_minus) * (1.0 + self.eta_c) + hydrostatic * mean_minus);
        let open = times(&self.split.stiffness(&self.elasticity), &dual);
        let volumetric = parameters.beta * virgin.bulk_modulus * volume;
        std::array::from_fn(|i| {
            let full = 2.0 * virgin.shear_modulus * (self.strain[i] - volume / 3.0) + volumetric;
            -(w * full + d * open[i])
        })
    }
}

/// Σ a_i b_i.
#[inline]
pub(super) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Evolution {
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

/// The response of the virgin solid, if a bound without principal values shows that nothing can grow:
/// s̄_1² ≤ s̄ : s̄ bounds Y_t = ⟨s̄_1⟩²/(2E), and Y_c ≤ ½ s̄ : ε. Writes the state.
#[inline(always)]
pub(super) fn elastic_response(
    parameters: &Parameters,
    increment: &Increment,
    state: &mut State,
    request: Request,
) -> Option<Response> {
    let elasticity = &parameters.elasticity;
    let plane_stress = increment.stress_state == StressState::PlaneStress;
    let mut strain = state.trial_strain(&increment.strain);
    if plane_stress {
        strain[2] = elasticity.plane_stress_strain_33(&strain);
    }
    let mut stress = elasticity.stress(&strain);
    let stored_energy = elasticity.stored_energy(&strain);
    // a square that overflows is none below
    let limit = (2.0 * elasticity.youngs_modulus * parameters.tension.threshold).min(f64::MAX);
    // false for NaN too
    if !(stress_norm_squared(&stress) <= limit && stored_energy <= parameters.compression.threshold) {
        return None;
    }
    if plane_stress {
        stress[2] = 0.0;
    }
    state.crack_band = f64::from(u8::from(parameters.wants_crack_band()));
    state.strain_33 = if plane_stress { strain[2] + state.inelastic_strain[2] } else { increment.strain[2] };
    // inelastic strain can be dissipated before η leaves 0 (underflow of a steep damage function)
    let dissipated_energy = state.dissipated_energy;
    Some(Response { stress, tangent: elasticity.tangent(plane_stress, request), stored_energy, dissipated_energy })
}

/// The end of an increment, in the principal axes of the trial strain.
pub(super) struct Point {
    /// ε − ε_p,n, ε33 found.
    pub trial: [f64; 6],
    pub axes: Spectral,
    /// Position of direction 3 among the axes, in plane stress.
    pub normal: Option<usize>,
    pub evolution: Evolution,
}

impl Point {
    /// Decomposes the trial strain and lets `evolve` advance the history; in plane stress finds ε33.
    #[inline]
    pub fn solve(
        parameters: &Parameters,
        evolve: impl Fn(&[f64; 3]) -> Evolution,
        history: &History,
        increment: &Increment,
        state: &State,
    ) -> Result<Self, Failure> {
        let mut trial = state.trial_strain(&increment.strain);
        if increment.stress_state != StressState::PlaneStress {
            let axes = Spectral::of_strain(&trial);
            let evolution = evolve(&axes.values);
            return Ok(Self { trial, axes, normal: None, evolution });
        }
        let elastic = parameters.elasticity.plane_stress_strain_33(&trial);
        let guess = state.strain_33 - state.inelastic_strain[2]
            + parameters.elasticity.plane_stress_strain_33(&increment.strain_increment);
        let solution = plane_stress::solve(parameters, evolve, history, &trial, elastic, guess)
            .ok_or(Failure::CutBack { fraction: 0.25, reason: "no strain 33 makes stress 33 vanish" })?;
        trial[2] = solution.strain_33;
        Ok(Self { trial, axes: solution.axes, normal: Some(solution.normal), evolution: solution.evolution })
    }

    /// σ.
    #[inline]
    pub fn stress(&self, parameters: &Parameters) -> [f64; 6] {
        let mut stress = if self.evolution.history.is_undamaged() {
            parameters.elasticity.stress(&self.trial)
        } else {
            self.axes.stress(&self.evolution.solid.stress)
        };
        if self.normal.is_some() {
            stress[2] = 0.0;
        }
        stress
    }

    /// ∂σ/∂ε.
    #[inline]
    pub fn tangent(&self, parameters: &Parameters) -> [[f64; 6]; 6] {
        if self.evolution.history.is_undamaged() {
            return parameters.elasticity.tangent(self.normal.is_some(), Request::StressAndTangent);
        }
        let full = self.evolution.tangent(parameters);
        let (principal, shear) = self.normal.map_or(full, |k| plane_stress::condense(full, k));
        self.axes.tangent(&principal, &shear)
    }

    /// Writes the new state.
    ///
    /// # Errors
    /// The characteristic length grew beyond its limit after the first call; the damage is then NaN.
    #[inline]
    pub fn commit(
        &self,
        parameters: &Parameters,
        increment: &Increment,
        state: &mut State,
        dissipation: f64,
    ) -> Result<(), Failure> {
        let strain_33 = self.trial[2] + state.inelastic_strain[2];
        state.commit(parameters, increment, &self.evolution.history, strain_33, dissipation)?;
        if let Some(flow) = &self.evolution.flow {
            let principal = std::array::from_fn(|i| flow.tension[i] + flow.compression[i]);
            let inelastic = self.axes.strain(&principal);
            for i in 0..6 {
                state.inelastic_strain[i] += inelastic[i];
            }
        }
        Ok(())
    }
}

impl State {
    /// Takes over the history, ε33 and the energy dissipated in an increment.
    ///
    /// # Errors
    /// The characteristic length grew beyond its limit after the first call; the damage is then NaN.
    #[inline]
    pub(super) fn commit(
        &mut self,
        parameters: &Parameters,
        increment: &Increment,
        history: &History,
        strain_33: f64,
        dissipation: f64,
    ) -> Result<(), Failure> {
        let [eta_t, eta_c] = history.etas();
        if !(eta_t + eta_c + dissipation).is_finite() {
            parameters.check_characteristic_length(increment.characteristic_length)?;
        }
        self.history = *history;
        self.crack_band = f64::from(u8::from(parameters.wants_crack_band()));
        self.strain_33 = strain_33;
        self.dissipated_energy += dissipation;
        Ok(())
    }
}

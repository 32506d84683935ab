//! A material point at finite strain: from the strains of a case to deformation gradients, and from what a UMAT returns
//! to the stresses of the case.
//!
//! With F = R U: a step that is given strains or stresses keeps R and finds U. A case measures it by ln U and Cauchy's
//! stress σ, or by U − 1 and Biot's stress T = ½ (RᵀP + PᵀR), P = J σ F⁻ᵀ ([`Measure`]). STRAN, the sum of midpoint
//! increments that turn with the material, is neither.

use super::newton::Evaluation;
use super::point::Committed;
use crate::deformation::{Polar, columns, components, exponential, exponential_derivative, incremental_motion};
use crate::deformation::{of_constant_volume, rotated, symmetric, turns};
use crate::program::{Measure, Mode, PointProgram};
use models::tensor::Spectral;
use nalgebra::Matrix3;
use umat_abi::host::{Plugin, UmatCall};

/// The finite strain of a point: committed, and that of the last call.
#[derive(Clone)]
pub(super) struct Finite {
    pub(super) measure: Measure,
    /// DDSDDE is ∂σ/∂DSTRAN, as laws for small strains return it; otherwise it is the tangent of the Jaumann rate of J
    /// σ, divided by J.
    incremental_tangent: bool,
    /// Whether it is plane stress: F₃₃ is 1 then, the thickness is the law's.
    plane_stress: bool,
    /// R.
    rotation: Matrix3<f64>,
    /// The case's strain, as far as F determines it.
    pub(super) strain: [f64; 6],
    /// The case's stress.
    pub(super) stress: [f64; 6],
    last: Call,
}

/// Start and end of a call of UMAT.
#[derive(Clone, Copy, Debug)]
struct Call {
    /// F₀.
    start: Matrix3<f64>,
    /// F₁.
    end: Matrix3<f64>,
    /// STRAN + DSTRAN.
    strain: [f64; 6],
    /// DROT.
    rotation: Matrix3<f64>,
    /// STRESS on entry.
    turned_stress: [f64; 6],
}

/// Strain, stress and increment that UMAT receives in addition to DROT, DFGRD0 and DFGRD1.
pub(super) struct FiniteStrainInput {
    pub(super) strain: [f64; 6],
    pub(super) stress: [f64; 6],
    pub(super) increment: [f64; 6],
}

impl Finite {
    /// Begins at a state; `thickness` is ln F₃₃ of plane stress there, NaN where it is not known.
    pub(super) fn new(point: &PointProgram, plugin: &Plugin, start: &Committed, thickness: f64) -> Self {
        let Committed { deformation_gradient: gradient, strain, stress, .. } = start;
        let mut finite = Self {
            measure: point.measure,
            incremental_tangent: plugin.law.is_some(),
            plane_stress: point.mode == Mode::PlaneStress,
            rotation: Polar::new(gradient).rotation,
            strain: [0.0; 6],
            stress: [0.0; 6],
            last: Call {
                start: *gradient,
                end: *gradient,
                strain: *strain,
                rotation: Matrix3::identity(),
                turned_stress: *stress,
            },
        };
        finite.strain = finite.strain_of_case(gradient);
        finite.stress = finite.stress_of_case(gradient, stress, thickness);
        finite
    }

    /// Returns whether R is not 1.
    pub(super) fn is_turned(&self) -> bool {
        turns(&self.rotation)
    }

    /// F; F₃₃ of plane stress has the logarithm `thickness`.
    pub(super) fn gradient(&self, state: &Committed, thickness: f64) -> Matrix3<f64> {
        let mut gradient = state.deformation_gradient;
        if self.plane_stress {
            gradient[(2, 2)] = thickness.exp();
        }
        gradient
    }

    /// Returns the case's strain, as far as F determines it.
    pub(super) fn strain_of_case(&self, gradient: &Matrix3<f64>) -> [f64; 6] {
        let polar = Polar::new(gradient);
        match self.measure {
            Measure::Logarithmic => polar.logarithmic_strain(),
            Measure::Nominal => polar.nominal_strain(),
        }
    }

    /// The case's strain 33 of plane stress.
    pub(super) fn strain_33(&self, thickness: f64) -> f64 {
        match self.measure {
            Measure::Logarithmic => thickness,
            Measure::Nominal => thickness.exp_m1(),
        }
    }

    /// Prepares a call that ends at a strain of the case; `None` if no stretch has it.
    pub(super) fn stretch(
        &mut self,
        from: &Committed,
        strain: &[f64; 6],
        call: &mut UmatCall,
    ) -> Option<FiniteStrainInput> {
        let end = self.end_of(from, strain)?;
        self.deform(from, &end, call)
    }

    /// F at a strain of the case; `None` if no stretch has it.
    pub(super) fn end_of(&self, from: &Committed, strain: &[f64; 6]) -> Option<Matrix3<f64>> {
        if *strain == self.strain {
            // F itself, not what rounding makes of it
            return Some(from.deformation_gradient);
        }
        let stretch = match self.measure {
            Measure::Logarithmic => exponential(strain),
            Measure::Nominal => {
                let is_stretch = Spectral::of_strain(strain).values[2] > -1.0;
                is_stretch.then(|| Matrix3::identity() + symmetric(strain, 2.0))?
            }
        };
        Some(self.rotation * stretch)
    }

    /// Prepares a call that ends at a deformation gradient; `None` if the volume is inverted on the way.
    pub(super) fn deform(
        &mut self,
        from: &Committed,
        end: &Matrix3<f64>,
        call: &mut UmatCall,
    ) -> Option<FiniteStrainInput> {
        let Committed { deformation_gradient: gradient, strain, stress, .. } = from;
        let motion = incremental_motion(gradient, end)?;
        let increment = motion.strain_increment;
        let strain = rotated(strain, &motion.rotation, 2.0);
        let stress = rotated(stress, &motion.rotation, 1.0);
        call.drot = columns(&motion.rotation);
        call.dfgrd0 = columns(&self.passed(gradient));
        call.dfgrd1 = columns(&self.passed(end));
        self.last = Call {
            start: *gradient,
            end: *end,
            strain: std::array::from_fn(|i| strain[i] + increment[i]),
            rotation: motion.rotation,
            turned_stress: stress,
        };
        Some(FiniteStrainInput { strain, stress, increment })
    }

    /// F as it is passed.
    fn passed(&self, gradient: &Matrix3<f64>) -> Matrix3<f64> {
        if self.plane_stress { of_constant_volume(*gradient) } else { *gradient }
    }

    /// Makes the end of the last call the state, whose STRESS and STATEV are what it returned; `strain` is the case's.
    pub(super) fn commit(&mut self, strain: [f64; 6], state: &mut Committed, thickness: f64) {
        (state.deformation_gradient, state.strain) = (self.last.end, self.last.strain);
        self.rotation = Polar::new(&self.last.end).rotation;
        self.strain = strain;
        self.stress = self.stress_of_case(&self.last.end, &state.stress, thickness);
    }

    /// Returns the result of the last call in terms of the case's strain and stress, where `strain` is the one at its
    /// end.
    ///
    /// The tangent is the chain rule applied to DDSDDE with dF = R dU. As far as the law conforms to
    /// `incremental_tangent`, it is exact except for the response of a plastic law to a turned stress.
    pub(super) fn evaluation(
        &self,
        returned: &Evaluation,
        strain: &[f64; 6],
        components_seen: &[usize],
        thickness: f64,
    ) -> Evaluation {
        let mut in_case = Evaluation {
            stress: self.stress_of_case(&self.last.end, &returned.stress, thickness),
            tangent: [[0.0; 6]; 6],
        };
        let stretch_by_strain = match self.measure {
            Measure::Logarithmic => exponential_derivative(strain),
            Measure::Nominal => {
                std::array::from_fn(|i| std::array::from_fn(|j| if i != j { 0.0 } else { [1.0, 0.5][i / 3] }))
            }
        };
        let Some(rates) = Rates::new(self, returned) else { return in_case };
        for &j in components_seen {
            let stretch_rate = symmetric(&stretch_by_strain.map(|row| row[j]), 1.0);
            let gradient_rate = self.rotation * stretch_rate;
            let stress_rate = if self.incremental_tangent {
                rates.incremental(&gradient_rate)
            } else {
                rates.spatial(&gradient_rate)
            };
            let rate = match self.measure {
                Measure::Logarithmic => components(&stress_rate, 1.0),
                Measure::Nominal => self.biot_rate(&rates, &in_case.stress, &stretch_rate, &stress_rate, thickness),
            };
            for &i in components_seen {
                in_case.tangent[i][j] = rate[i];
            }
        }
        in_case
    }

    /// σ, or T = J/2 (σ̂ U⁻¹ + U⁻¹ σ̂) with σ̂ = Rᵀ σ R.
    fn stress_of_case(&self, gradient: &Matrix3<f64>, stress: &[f64; 6], thickness: f64) -> [f64; 6] {
        if self.measure == Measure::Logarithmic {
            return *stress;
        }
        let polar = Polar::new(gradient);
        let turned = polar.rotation.transpose() * symmetric(stress, 1.0) * polar.rotation;
        components(&(turned * polar.inverse_stretch() * self.volume_ratio(gradient, thickness)), 1.0)
    }

    /// J.
    fn volume_ratio(&self, gradient: &Matrix3<f64>, thickness: f64) -> f64 {
        gradient.determinant() * if self.plane_stress { thickness.exp() } else { 1.0 }
    }

    /// dT = tr(U⁻¹ dU) T + J sym(dσ̂ U⁻¹ − σ̂ U⁻¹ dU U⁻¹).
    fn biot_rate(
        &self,
        rates: &Rates,
        biot: &[f64; 6],
        stretch_rate: &Matrix3<f64>,
        stress_rate: &Matrix3<f64>,
        thickness: f64,
    ) -> [f64; 6] {
        let turned = |tensor: &Matrix3<f64>| self.rotation.transpose() * tensor * self.rotation;
        let inverse = rates.inverse * self.rotation;
        let relative_rate = inverse * stretch_rate;
        let sum = turned(stress_rate) * inverse - turned(&rates.stress) * inverse * stretch_rate * inverse;
        let sum = components(&(sum * self.volume_ratio(&self.last.end, thickness)), 1.0);
        std::array::from_fn(|i| relative_rate.trace() * biot[i] + sum[i])
    }
}

/// Derivatives of Cauchy's stress at the end of a call with respect to F₁.
struct Rates {
    /// DDSDDE.
    tangent: [[f64; 6]; 6],
    /// σ₁.
    stress: Matrix3<f64>,
    /// ΔR σ₀ ΔRᵀ.
    turned_stress: Matrix3<f64>,
    /// F₁⁻¹.
    inverse: Matrix3<f64>,
    /// F_m⁻¹.
    middle_inverse: Matrix3<f64>,
    /// 1 − G/2 with G = ΔF F_m⁻¹.
    remainder: Matrix3<f64>,
    /// (1 − W/2)⁻¹ with W = skw G.
    half_turn: Matrix3<f64>,
    /// ΔR.
    rotation: Matrix3<f64>,
}

impl Rates {
    fn new(point: &Finite, returned: &Evaluation) -> Option<Self> {
        let last = &point.last;
        let middle_inverse = ((last.start + last.end) * 0.5).try_inverse()?;
        let gradient = (last.end - last.start) * middle_inverse;
        let identity = Matrix3::identity();
        Some(Self {
            tangent: returned.tangent,
            stress: symmetric(&returned.stress, 1.0),
            turned_stress: symmetric(&last.turned_stress, 1.0),
            inverse: last.end.try_inverse()?,
            middle_inverse,
            remainder: identity - gradient * 0.5,
            half_turn: (identity - (gradient - gradient.transpose()) * 0.25).try_inverse()?,
            rotation: last.rotation,
        })
    }

    /// DDSDDE : ε.
    fn stiffness(&self, strain: &[f64; 6]) -> Matrix3<f64> {
        symmetric(&self.tangent.map(|row| row.iter().zip(strain).map(|(c, e)| c * e).sum()), 1.0)
    }

    /// dσ = DDSDDE : D + W σ − σ W − tr D σ with D + W = dF F₁⁻¹.
    fn spatial(&self, gradient_rate: &Matrix3<f64>) -> Matrix3<f64> {
        let velocity = gradient_rate * self.inverse;
        let spin = (velocity - velocity.transpose()) * 0.5;
        self.stiffness(&components(&velocity, 2.0)) + spin * self.stress
            - self.stress * spin
            - self.stress * velocity.trace()
    }

    /// dσ = DDSDDE : sym dG + Ω σ̄ − σ̄ Ω with dG = (1 − G/2) dF F_m⁻¹, Ω = dΔR ΔRᵀ, σ̄ = ΔR σ₀ ΔRᵀ.
    fn incremental(&self, gradient_rate: &Matrix3<f64>) -> Matrix3<f64> {
        let rate = self.remainder * gradient_rate * self.middle_inverse;
        let half_spin = (rate - rate.transpose()) * 0.25;
        let rotation_rate = self.half_turn * half_spin * (Matrix3::identity() + self.rotation);
        let spin = rotation_rate * self.rotation.transpose();
        self.stiffness(&components(&rate, 2.0)) + spin * self.turned_stress - self.turned_stress * spin
    }
}

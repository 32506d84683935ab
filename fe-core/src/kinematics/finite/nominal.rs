//! The derivative of the nominal stress by the deformation gradient, through the incremental map.

use super::{Components, FiniteIncrement, GRADIENT_COMPONENTS, Gradient, Moduli};
use crate::kinematics::MAX_COMPONENTS;
use crate::plane::dot;

/// `[k][l]`: ∂P_k/∂F_l.
pub type NominalTangent = [[f64; GRADIENT_COMPONENTS]; GRADIENT_COMPONENTS];

/// (row, column) of the plane components of a gradient.
const PLANE: [(usize, usize); 4] = [(0, 0), (0, 1), (1, 0), (1, 1)];

/// Place of a plane component in a gradient.
const fn place(row: usize, column: usize) -> usize {
    2 * row + column
}

/// Rates that an element with averaged dilatation needs in addition to ∂P/∂F. Its own rates are those of the mean
/// dilatation θ̄ and of the mean stress p̄.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AverageRates {
    /// ∂P/∂θ̄.
    pub by_dilatation: Gradient,
    /// ∂P/∂p̄ = J F⁻ᵀ, which is ∂J/∂F as well.
    pub by_pressure: Gradient,
    /// V ∂p̄/∂F per reference volume: J ∂p/∂F + (p − p̄) ∂J/∂F.
    pub pressure: Gradient,
    /// J ∂p/∂θ̄.
    pub pressure_by_dilatation: f64,
    /// ∂(tr G)/∂F.
    pub dilatation: Gradient,
    /// ∂(ln det F_m)/∂F.
    pub middle_volume: Gradient,
}

impl FiniteIncrement {
    /// ∂Δε/∂F, component by component, and ∂φ/∂F.
    fn strain_derivatives(&self) -> ([Gradient; MAX_COMPONENTS], Gradient) {
        let [g11, g12, g21, g22, g33] = self.gradient.map(|component| -0.5 * component);
        let left = [[1.0 + g11, g12], [g21, 1.0 + g22]];
        let inverse = &self.middle_inverse;
        let by_angle = 1.0 / (1.0 + 0.25 * self.spin() * self.spin());
        let mut strain = [[0.0; GRADIENT_COMPONENTS]; MAX_COMPONENTS];
        let mut angle = [0.0; GRADIENT_COMPONENTS];
        for (row, column) in PLANE {
            // ∂G_ab/∂F_cE = (I − ½ G)_ac (F_m⁻¹)_Eb.
            let at = place(row, column);
            let g = |a: usize, b: usize| left[a][row] * inverse[place(column, b)];
            strain[0][at] = g(0, 0);
            strain[1][at] = g(1, 1);
            strain[3][at] = g(0, 1) + g(1, 0);
            angle[at] = 0.5 * by_angle * (g(1, 0) - g(0, 1));
        }
        strain[2][4] = (1.0 + g33) * inverse[4];
        (strain, angle)
    }

    /// Σ a_k ∂Δε_k/∂F, of factors a of the components of the strain increment.
    pub(crate) fn strain_conjugate(&self, factors: &Components) -> Gradient {
        let (strain, _) = self.strain_derivatives();
        std::array::from_fn(|l| factors.iter().zip(&strain).map(|(factor, rates)| factor * rates[l]).sum())
    }

    /// s = ∂σ/∂φ of an isotropic law.
    fn stress_by_angle(&self, stress: &Components, moduli: &Moduli) -> Components {
        let [e11, e22, _, e12] = self.strain_increment();
        // Ω t − t Ω of a symmetric t is (−2 t₁₂, 2 t₁₂, 0, t₁₁ − t₂₂); its shear twice for a strain.
        let strain = [-e12, e12, 0.0, 2.0 * (e11 - e22)];
        let own = [-2.0 * stress[3], 2.0 * stress[3], 0.0, stress[0] - stress[1]];
        std::array::from_fn(|row| own[row] - dot(moduli[row], strain))
    }

    /// J a F⁻ᵀ, column by column of a 4 × 5 matrix of rates of stress.
    fn pulled_back(&self, rates: &[Gradient; MAX_COMPONENTS]) -> NominalTangent {
        let mut result = [[0.0; GRADIENT_COMPONENTS]; GRADIENT_COMPONENTS];
        let [i11, i12, i21, i22, i33] = self.end_inverse.map(|component| component * self.volume_ratio);
        for l in 0..GRADIENT_COMPONENTS {
            let [s11, s22, s33, s12] = [rates[0][l], rates[1][l], rates[2][l], rates[3][l]];
            result[0][l] = s11 * i11 + s12 * i12;
            result[1][l] = s11 * i21 + s12 * i22;
            result[2][l] = s12 * i11 + s22 * i12;
            result[3][l] = s12 * i21 + s22 * i22;
            result[4][l] = s33 * i33;
        }
        result
    }

    /// Adds P tr(δF F⁻¹) − P (F⁻¹ δF)ᵀ.
    fn add_geometric(&self, nominal: &Gradient, tangent: &mut NominalTangent) {
        let inverse = &self.end_inverse;
        for (a, d) in PLANE {
            for (c, e) in PLANE {
                // P_aD F⁻¹_Ec − F⁻¹_Dc P_aE
                tangent[place(a, d)][place(c, e)] +=
                    nominal[place(a, d)] * inverse[place(e, c)] - inverse[place(d, c)] * nominal[place(a, e)];
            }
            tangent[place(a, d)][4] += nominal[place(a, d)] * inverse[4];
            tangent[4][place(a, d)] += nominal[4] * inverse[place(d, a)];
        }
    }

    /// J F⁻ᵀ.
    pub(crate) fn volume_derivative(&self) -> Gradient {
        let [i11, i12, i21, i22, i33] = self.end_inverse.map(|component| component * self.volume_ratio);
        [i11, i21, i12, i22, i33]
    }
}

/// ∂P/∂F through Δε, ΔR and the end configuration: exact for an isotropic law that rotates its tensor states.
pub(crate) fn nominal_tangent(increment: &FiniteIncrement, stress: &Components, moduli: &Moduli) -> NominalTangent {
    let (strain, angle) = increment.strain_derivatives();
    let rates = stress_rates(moduli, &strain, &increment.stress_by_angle(stress, moduli), &angle);
    let mut tangent = increment.pulled_back(&rates);
    increment.add_geometric(&increment.nominal_stress(stress), &mut tangent);
    tangent
}

impl AverageRates {
    /// ∂P/∂F at fixed θ̄ and p̄, and the other rates, of a point with the stress that its law returned and the mean
    /// stress p̄ of its element.
    pub fn of(
        increment: &FiniteIncrement,
        stress: &Components,
        mean_pressure: f64,
        moduli: &Moduli,
    ) -> (NominalTangent, Self) {
        let (strain, angle) = increment.strain_derivatives();
        let mut deviator = strain;
        let dilatation = without_mean(&mut deviator).map(|mean| 3.0 * mean);
        let mut rates = stress_rates(moduli, &deviator, &increment.stress_by_angle(stress, moduli), &angle);
        let pressure = without_mean(&mut rates);
        let mut tangent = increment.pulled_back(&rates);
        increment.add_geometric(&increment.nominal_stress(&with_mean(stress, mean_pressure)), &mut tangent);
        let mut by_dilatation: [Gradient; MAX_COMPONENTS] =
            std::array::from_fn(|row| [(moduli[row][0] + moduli[row][1] + moduli[row][2]) / 3.0, 0.0, 0.0, 0.0, 0.0]);
        let pressure_by_dilatation = without_mean(&mut by_dilatation)[0];
        let by_pressure = increment.volume_derivative();
        let excess = mean(stress) - mean_pressure;
        let [i11, i12, i21, i22, i33] = increment.middle_inverse.map(|component| 0.5 * component);
        let rates = Self {
            by_dilatation: increment.pulled_back(&by_dilatation).map(|row| row[0]),
            by_pressure,
            pressure: std::array::from_fn(|l| increment.volume_ratio * pressure[l] + excess * by_pressure[l]),
            pressure_by_dilatation: increment.volume_ratio * pressure_by_dilatation,
            dilatation,
            middle_volume: [i11, i21, i12, i22, i33],
        };
        (tangent, rates)
    }
}

/// ⅓ tr σ.
pub fn mean(stress: &Components) -> f64 {
    (stress[0] + stress[1] + stress[2]) / 3.0
}

/// The stress with another mean.
pub(crate) fn with_mean(stress: &Components, pressure: f64) -> Components {
    let shift = pressure - mean(stress);
    [stress[0] + shift, stress[1] + shift, stress[2] + shift, stress[3]]
}

/// Takes the mean of the direct components away, column by column, and returns it.
fn without_mean(rates: &mut [Gradient; MAX_COMPONENTS]) -> Gradient {
    let mean: Gradient = std::array::from_fn(|l| (rates[0][l] + rates[1][l] + rates[2][l]) / 3.0);
    for direct in &mut rates[..3] {
        (0..GRADIENT_COMPONENTS).for_each(|l| direct[l] -= mean[l]);
    }
    mean
}

/// C ∂Δε/∂F + s ∂φ/∂F.
fn stress_rates(
    moduli: &Moduli,
    strain: &[Gradient; MAX_COMPONENTS],
    by_angle: &Components,
    angle: &Gradient,
) -> [Gradient; MAX_COMPONENTS] {
    std::array::from_fn(|row| {
        std::array::from_fn(|l| {
            let material: f64 = (0..MAX_COMPONENTS).map(|k| moduli[row][k] * strain[k][l]).sum();
            material + by_angle[row] * angle[l]
        })
    })
}

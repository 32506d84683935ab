#![doc = include_str!("doc.md")]

mod nominal;

pub use nominal::{AverageRates, NominalTangent, mean};
pub(crate) use nominal::{nominal_tangent, with_mean};

use super::MAX_COMPONENTS;

#[cfg(test)]
mod test;

/// Components of a plane gradient, in the order 11, 12, 21, 22, 33.
pub(crate) const GRADIENT_COMPONENTS: usize = 5;

/// A gradient by reference coordinates: of displacements, of a motion, or the nominal stress that is its conjugate.
pub type Gradient = [f64; GRADIENT_COMPONENTS];

/// Components 11, 22, 33, 12 of a stress or of a strain with engineering shear; 33 is 0 in plane stress.
pub type Components = [f64; MAX_COMPONENTS];

/// DDSDDE over [`Components`], row by row; row and column 33 are 0 in plane stress.
pub type Moduli = [[f64; MAX_COMPONENTS]; MAX_COMPONENTS];

/// F of what has not moved.
pub const IDENTITY: Gradient = [1.0, 0.0, 0.0, 1.0, 1.0];

/// The strain of a small displacement gradient.
pub(crate) fn small_strain([h11, h12, h21, h22, h33]: Gradient) -> Components {
    [h11, h22, h33, h12 + h21]
}

/// An end of an increment turns a point inside out.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the volume ratio (det F) is {ratio:.3e} where it must be positive")]
pub struct VolumeError {
    /// det F, at the middle or at the end of the increment.
    pub ratio: f64,
}

/// An increment between two deformation gradients, as a UMAT sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiniteIncrement {
    /// F₁⁻¹.
    pub end_inverse: Gradient,
    /// J: volume at the end per reference volume.
    pub volume_ratio: f64,
    /// F_m⁻¹.
    pub middle_inverse: Gradient,
    /// det F_m.
    pub middle_volume_ratio: f64,
    /// G = ∂Δu/∂x_m.
    pub gradient: Gradient,
}

impl FiniteIncrement {
    /// An increment without motion.
    pub(crate) const REST: Self = Self {
        end_inverse: IDENTITY,
        volume_ratio: 1.0,
        middle_inverse: IDENTITY,
        middle_volume_ratio: 1.0,
        gradient: [0.0; GRADIENT_COMPONENTS],
    };

    /// The increment from `start` to `end`, both F.
    ///
    /// # Errors
    ///
    /// det F is not positive at the end or half-way.
    pub fn new(start: &Gradient, end: &Gradient) -> Result<Self, VolumeError> {
        let middle: Gradient = std::array::from_fn(|k| 0.5 * (start[k] + end[k]));
        let (middle_inverse, middle_volume_ratio) = inverse(&middle)?;
        let (end_inverse, volume_ratio) = inverse(end)?;
        let difference: Gradient = std::array::from_fn(|k| end[k] - start[k]);
        let gradient = product(&difference, &middle_inverse);
        Ok(Self { end_inverse, volume_ratio, middle_inverse, middle_volume_ratio, gradient })
    }

    /// Δε.
    pub fn strain_increment(&self) -> Components {
        small_strain(self.gradient)
    }

    /// tr Δε.
    pub fn dilatation(&self) -> f64 {
        self.gradient[0] + self.gradient[3] + self.gradient[4]
    }

    /// ω.
    pub fn spin(&self) -> f64 {
        0.5 * (self.gradient[2] - self.gradient[1])
    }

    /// ΔR as (cos φ, sin φ).
    pub fn rotation(&self) -> (f64, f64) {
        let half = 0.5 * self.spin();
        let scale = 1.0 / (1.0 + half * half);
        ((1.0 - half * half) * scale, 2.0 * half * scale)
    }

    /// P = J σ F₁⁻ᵀ, whose conjugate is F: f = ∫ P · ∂N/∂X dV.
    pub(crate) fn nominal_stress(&self, stress: &Components) -> Gradient {
        let [s11, s22, s33, s12] = stress.map(|component| component * self.volume_ratio);
        let [i11, i12, i21, i22, i33] = self.end_inverse;
        [s11 * i11 + s12 * i12, s11 * i21 + s12 * i22, s12 * i11 + s22 * i12, s12 * i21 + s22 * i22, s33 * i33]
    }
}

/// R t Rᵀ; `shear` is 2 for strains (engineering shear), 1 for stresses.
pub fn rotated(components: &Components, (cosine, sine): (f64, f64), shear: f64) -> Components {
    let [a, b, c, d] = *components;
    let d = d / shear;
    let (cc, ss, cs) = (cosine * cosine, sine * sine, cosine * sine);
    [cc * a + ss * b - 2.0 * cs * d, ss * a + cc * b + 2.0 * cs * d, c, shear * (cs * (a - b) + (cc - ss) * d)]
}

/// A gradient as a 3 × 3 matrix, column-major: `DFGRD0` and `DFGRD1`.
pub fn columns([f11, f12, f21, f22, f33]: Gradient) -> [[f64; 3]; 3] {
    [[f11, f21, 0.0], [f12, f22, 0.0], [0.0, 0.0, f33]]
}

/// A B.
fn product(a: &Gradient, b: &Gradient) -> Gradient {
    [
        a[0] * b[0] + a[1] * b[2],
        a[0] * b[1] + a[1] * b[3],
        a[2] * b[0] + a[3] * b[2],
        a[2] * b[1] + a[3] * b[3],
        a[4] * b[4],
    ]
}

/// F⁻¹ and det F.
fn inverse(f: &Gradient) -> Result<(Gradient, f64), VolumeError> {
    let plane = f[0] * f[3] - f[1] * f[2];
    let ratio = plane * f[4];
    // Both: two negative factors would have a positive product.
    if !(plane > 0.0 && ratio > 0.0 && ratio.is_finite()) {
        return Err(VolumeError { ratio: if plane > 0.0 { ratio } else { plane } });
    }
    Ok(([f[3] / plane, -f[1] / plane, -f[2] / plane, f[0] / plane, 1.0 / f[4]], ratio))
}

//! Kinematics of a material point at finite strain: polar decomposition F = R U, logarithm and exponential of stretches,
//! and strain increments with rotations as ABAQUS hands them to a UMAT under NLGEOM (Hughes & Winget 1980).
//!
//! Strains are six components 11, 22, 33, 12, 13, 23 with engineering shear.

use models::tensor::Spectral;
use nalgebra::Matrix3;

/// Strain increment and rotation of an increment F₀ → F₁, as a UMAT sees it.
#[derive(Clone, Copy, Debug)]
pub struct IncrementalMotion {
    /// Midpoint strain increment, engineering shear: sym(ΔF F_m⁻¹), F_m = (F₀ + F₁)/2.
    pub strain_increment: [f64; 6],
    /// ΔR = (I − ½W)⁻¹ (I + ½W), W = skw(ΔF F_m⁻¹).
    pub rotation: Matrix3<f64>,
}

/// A matrix from its rows.
pub fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

/// Column-major, as Fortran passes it.
pub fn columns(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|column| std::array::from_fn(|row| matrix[(row, column)]))
}

/// The symmetric matrix of six components; `shear` = 2 for strains (engineering shear), 1 for stresses.
pub fn symmetric(components: &[f64; 6], shear: f64) -> Matrix3<f64> {
    let [a, b, c, d, e, f] = *components;
    Matrix3::new(a, d / shear, e / shear, d / shear, b, f / shear, e / shear, f / shear, c)
}

/// The six components of the symmetric part of a matrix; `shear` as for [`symmetric`].
pub fn components(matrix: &Matrix3<f64>, shear: f64) -> [f64; 6] {
    let off_diagonal = |i, j| shear * 0.5 * (matrix[(i, j)] + matrix[(j, i)]);
    let [d, e, f] = [off_diagonal(0, 1), off_diagonal(0, 2), off_diagonal(1, 2)];
    [matrix[(0, 0)], matrix[(1, 1)], matrix[(2, 2)], d, e, f]
}

/// R t Rᵀ of six components; `shear` as for [`symmetric`].
pub fn rotated(tensor: &[f64; 6], rotation: &Matrix3<f64>, shear: f64) -> [f64; 6] {
    components(&(rotation * symmetric(tensor, shear) * rotation.transpose()), shear)
}

/// The increment's kinematics; `None` if a deformation gradient on the way is singular or inverts the volume.
pub fn incremental_motion(start: &Matrix3<f64>, end: &Matrix3<f64>) -> Option<IncrementalMotion> {
    let middle = (start + end) * 0.5;
    let inverts = |gradient: &Matrix3<f64>| !(gradient.determinant() > 0.0 && gradient.determinant().is_finite());
    if inverts(&middle) || inverts(end) {
        return None;
    }
    let gradient = (end - start) * middle.try_inverse()?;
    let half_spin = (gradient - gradient.transpose()) * 0.25;
    let identity = Matrix3::identity();
    let rotation = (identity - half_spin).try_inverse()? * (identity + half_spin);
    Some(IncrementalMotion { strain_increment: components(&gradient, 2.0), rotation })
}

/// F₁ = (I − ½D)⁻¹ (I + ½D) F₀: the increment whose midpoint strain is D, and which has no spin. `None` if D is too large.
pub fn spinless(increment: &Matrix3<f64>, start: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let identity = Matrix3::identity();
    Some((identity - increment * 0.5).try_inverse()? * (identity + increment * 0.5) * start)
}

/// F in a plane as ABAQUS passes it in plane stress: with the F₃₃ that keeps the volume.
pub fn of_constant_volume(mut gradient: Matrix3<f64>) -> Matrix3<f64> {
    gradient[(2, 2)] /= gradient.determinant();
    gradient
}

/// exp ε: the rotation-free stretch whose logarithmic strain is ε. Symmetric to the last bit.
pub fn exponential(strain: &[f64; 6]) -> Matrix3<f64> {
    let spectral = Spectral::of_strain(strain);
    Matrix3::identity() + symmetric(&spectral.stress(&spectral.values.map(f64::exp_m1)), 1.0)
}

/// ∂(exp ε)/∂ε: components of the stretch by components of the strain.
pub(crate) fn exponential_derivative(strain: &[f64; 6]) -> [[f64; 6]; 6] {
    let spectral = Spectral::of_strain(strain);
    let [a, b, c] = spectral.values;
    let slope = |a: f64, b: f64| if a == b { a.exp() } else { b.exp() * (a - b).exp_m1() / (a - b) };
    let principal = [[a.exp(), 0.0, 0.0], [0.0, b.exp(), 0.0], [0.0, 0.0, c.exp()]];
    spectral.tangent(&principal, &[slope(a, b), slope(a, c), slope(b, c)])
}

/// Returns whether a rotation differs from 1 by more than rounding.
pub fn turns(rotation: &Matrix3<f64>) -> bool {
    (rotation - Matrix3::identity()).norm() > 1e-9
}

/// F = R U of a deformation gradient with det F > 0.
#[derive(Clone, Copy, Debug)]
pub struct Polar {
    /// R; exactly I where F is symmetric and positive definite.
    pub rotation: Matrix3<f64>,
    /// Principal elongations λ − 1 of U and their directions.
    elongations: Spectral,
}

impl Polar {
    /// Decomposes F.
    pub fn new(gradient: &Matrix3<f64>) -> Self {
        let identity = Matrix3::identity();
        let displacement = gradient - identity;
        if *gradient == gradient.transpose() {
            let elongations = Spectral::of_stress(&components(&displacement, 1.0));
            if elongations.values[2] > -1.0 {
                return Self { rotation: identity, elongations };
            }
        }
        // of Green's strain rather than of FᵀF: what is left of a small stretch has all its digits
        let transposed = displacement.transpose();
        let green = (displacement + transposed + transposed * displacement) * 0.5;
        let mut elongations = Spectral::of_stress(&components(&green, 1.0));
        elongations.values = elongations.values.map(|green| 2.0 * green / (1.0 + (1.0 + 2.0 * green).sqrt()));
        let mut polar = Self { rotation: identity, elongations };
        polar.rotation = gradient * polar.inverse_stretch();
        polar
    }

    /// U⁻¹.
    pub(crate) fn inverse_stretch(&self) -> Matrix3<f64> {
        let inverse = self.elongations.values.map(|elongation| 1.0 / (1.0 + elongation));
        symmetric(&self.elongations.stress(&inverse), 1.0)
    }

    /// ln U.
    pub fn logarithmic_strain(&self) -> [f64; 6] {
        self.elongations.strain(&self.elongations.values.map(f64::ln_1p))
    }

    /// U − 1, with twice U's shear components.
    pub(crate) fn nominal_strain(&self) -> [f64; 6] {
        self.elongations.strain(&self.elongations.values)
    }
}

#[cfg(test)]
mod test;

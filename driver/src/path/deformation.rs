//! From deformation gradients to strain increments and rotations (Hughes & Winget 1980), as ABAQUS
//! hands them to a UMAT under NLGEOM.

use nalgebra::Matrix3;

/// What an increment F₀ → F₁ means to a UMAT.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IncrementalMotion {
    /// Midpoint strain increment, engineering shear: sym(ΔF F_m⁻¹), F_m = (F₀ + F₁)/2.
    pub(crate) strain_increment: [f64; 6],
    /// ΔR = (I − ½W)⁻¹ (I + ½W), W = skw(ΔF F_m⁻¹).
    pub(crate) rotation: Matrix3<f64>,
}

/// A matrix from its rows.
pub(crate) fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

/// The increment's kinematics; `None` if a deformation gradient on the way is singular or inverts the volume.
pub(crate) fn incremental_motion(start: &Matrix3<f64>, end: &Matrix3<f64>) -> Option<IncrementalMotion> {
    let middle = (start + end) * 0.5;
    if middle.determinant() <= 0.0 || end.determinant() <= 0.0 {
        return None;
    }
    let gradient = (end - start) * middle.try_inverse()?;
    let spin = (gradient - gradient.transpose()) * 0.5;
    let identity = Matrix3::identity();
    let rotation = (identity - spin * 0.5).try_inverse()? * (identity + spin * 0.5);
    let d = (gradient + gradient.transpose()) * 0.5;
    Some(IncrementalMotion {
        strain_increment: [d[(0, 0)], d[(1, 1)], d[(2, 2)], 2.0 * d[(0, 1)], 2.0 * d[(0, 2)], 2.0 * d[(1, 2)]],
        rotation,
    })
}

/// R t Rᵀ of six components; `shear` = 2 for strains (engineering shear), 1 for stresses.
pub(crate) fn rotated(components: &[f64; 6], rotation: &Matrix3<f64>, shear: f64) -> [f64; 6] {
    let [a, b, c, d, e, f] = *components;
    let tensor = Matrix3::new(a, d / shear, e / shear, d / shear, b, f / shear, e / shear, f / shear, c);
    let turned = rotation * tensor * rotation.transpose();
    [
        turned[(0, 0)],
        turned[(1, 1)],
        turned[(2, 2)],
        shear * turned[(0, 1)],
        shear * turned[(0, 2)],
        shear * turned[(1, 2)],
    ]
}

/// A symmetric tensor from six components with engineering shear.
pub(crate) fn symmetric(strain: &[f64; 6]) -> Matrix3<f64> {
    let [a, b, c, d, e, f] = *strain;
    Matrix3::new(a, 0.5 * d, 0.5 * e, 0.5 * d, b, 0.5 * f, 0.5 * e, 0.5 * f, c)
}

/// F₁ = (I − ½D)⁻¹ (I + ½D) F₀: the increment whose midpoint strain is D, and which has no spin. `None` if D is too large.
pub(crate) fn spinless(increment: &Matrix3<f64>, start: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let identity = Matrix3::identity();
    Some((identity - increment * 0.5).try_inverse()? * (identity + increment * 0.5) * start)
}

/// Column-major, as Fortran passes it.
pub(crate) fn columns(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|column| std::array::from_fn(|row| matrix[(row, column)]))
}

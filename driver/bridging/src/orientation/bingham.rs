//! The density on the sphere of greatest entropy with given second moments: ψ ∝ exp(pᵀ B p).

use crate::Invalid;
use crate::quadrature::{DEGREES, rule};
use nalgebra::{Matrix2, Matrix3, SymmetricEigen, Vector2, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A tensor whose least eigenvalue is below this is a plane or a line: its density has no bound.
const LEAST_EIGENVALUE: f64 = 0.005;
/// Parts of the circle: a periodic function is summed to rounding.
const CIRCLE: usize = 256;
/// Panels over the cosine from an axis.
const PANELS: usize = 8;
/// Intervals of the marginal over the quarter circle.
const SAMPLES: usize = 1024;
const ITERATIONS: usize = 100;
/// Moments are met to this.
const ROUNDING: f64 = 1e-13;

/// p(θ) about the normal n at equal distances over [0, π/2]: 2 sin θ ∫ ψ dφ.
pub fn marginal(a: &[[f64; 3]; 3], normal: &[f64; 3]) -> Result<Vec<f64>, Invalid> {
    let tensor = Matrix3::from_fn(|i, j| a[i][j]);
    let place = || "orientation.a".to_string();
    let symmetric = (tensor - tensor.transpose()).amax() <= 1e-9;
    Invalid::unless(symmetric, place(), "must be symmetric")?;
    Invalid::unless((tensor.trace() - 1.0).abs() <= 1e-6, place(), "must have the trace 1")?;
    let eigen = SymmetricEigen::new(tensor / tensor.trace());
    let positive = eigen.eigenvalues.min() >= LEAST_EIGENVALUE;
    let rule = "must have eigenvalues of 0.005 or more (use \"planar\" or \"aligned\" below)";
    Invalid::unless(positive, place(), rule)?;
    let normal = Vector3::from(*normal);
    Invalid::unless(normal.norm() > 0.0, "orientation.normal".into(), "must not be 0")?;
    let found = parameters(&eigen.eigenvalues);
    let (b, mass) = found.ok_or(Invalid { place: place(), rule: "has no density of greatest entropy".into() })?;
    let matrix = eigen.eigenvectors * Matrix3::from_diagonal(&b) * eigen.eigenvectors.transpose();
    let n = normal.normalize();
    let first = n.cross(&Vector3::ith(n.iamin(), 1.0)).normalize();
    let second = n.cross(&first);
    let along = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        let around = |k: usize| {
            let (y, x) = (TAU * k as f64 / CIRCLE as f64).sin_cos();
            let p = n * cosine + (first * x + second * y) * sine;
            (p.dot(&(matrix * p)) - b.max()).exp()
        };
        2.0 * sine * (0..CIRCLE).map(around).sum::<f64>() * TAU / CIRCLE as f64 / mass
    };
    Ok((0..=SAMPLES).map(|k| along(FRAC_PI_2 * k as f64 / SAMPLES as f64)).collect())
}

/// B in its own axes, its third entry 0, and ∫ exp(pᵀBp − max B) over the sphere: Newton's method on the moments, whose
/// derivatives are covariances.
fn parameters(eigenvalues: &Vector3<f64>) -> Option<(Vector3<f64>, f64)> {
    let mut b = Vector3::zeros();
    for _ in 0..ITERATIONS {
        let (mass, second, fourth) = moments(&b);
        let residual = Vector2::new(eigenvalues[0] - second[0], eigenvalues[1] - second[1]);
        if residual.amax() <= ROUNDING {
            return Some((b, mass));
        }
        let covariance = Matrix2::from_fn(|i, j| fourth[(i, j)] - second[i] * second[j]);
        let step = covariance.lu().solve(&residual)?;
        // far from the solution the moments saturate
        let step = step * (10.0 / step.amax()).min(1.0);
        b += Vector3::new(step[0], step[1], 0.0);
        if step.amax() <= ROUNDING * (1.0 + b.amax()) {
            return Some((b, moments(&b).0));
        }
    }
    None
}

/// ∫ ψ, ⟨p_i²⟩, ⟨p_i² p_j²⟩ of ψ = exp(Σ b_i p_i² − max b).
fn moments(b: &Vector3<f64>) -> (f64, Vector3<f64>, Matrix3<f64>) {
    let greatest = b.max();
    let (mut mass, mut second, mut fourth) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for panel in 0..PANELS {
        for (node, weight) in rule(DEGREES.len() - 1) {
            let z = (panel as f64 + node) / PANELS as f64;
            for k in 0..CIRCLE / 4 {
                // a quarter of the circle, at middles of its parts
                let (y, x) = (TAU * (k as f64 + 0.5) / CIRCLE as f64).sin_cos();
                let in_plane = 1.0 - z * z;
                let squares = Vector3::new(in_plane * x * x, in_plane * y * y, z * z);
                let density = weight * (b.dot(&squares) - greatest).exp();
                mass += density;
                second += squares * density;
                fourth += squares * squares.transpose() * density;
            }
        }
    }
    // 8 octants, dz/panels, dφ
    (mass * 8.0 / PANELS as f64 * TAU / CIRCLE as f64, second / mass, fourth / mass)
}

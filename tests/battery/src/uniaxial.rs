//! Stress control of one direction of strain: what is needed for uniaxial tests in three dimensions.

use super::Point;
use models::roots::bracketed_newton;
use umat_abi::law::{Law, Response};

/// Components 22 and 33 together: uniaxial stress in three dimensions.
pub const BOTH_LATERAL: [f64; 6] = [0.0, 1.0, 1.0, 0.0, 0.0, 0.0];

/// Component 22 alone: plane strain with a free side, or uniaxial plane stress.
pub const ONE_LATERAL: [f64; 6] = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0];

/// Component 33 alone: plane stress out of a three-dimensional law.
pub const OUT_OF_PLANE: [f64; 6] = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];

/// Commits the strain `strain + x direction` for which stress · direction vanishes (which rises with
/// x), from the committed value of x on.
pub fn advance_free<L: Law>(point: &mut Point<'_, L>, strain: &[f64; 6], direction: &[f64; 6]) -> Response {
    let free = direction.iter().position(|&d| d != 0.0).expect("a direction");
    let complete = |x: f64| std::array::from_fn(|i| strain[i] + x * direction[i]);
    let dot = |a: &[f64; 6]| -> f64 { a.iter().zip(direction).map(|(a, d)| a * d).sum() };
    let size = strain.iter().chain(&point.strain).fold(0.0_f64, |m, x| m.max(x.abs()));
    let start = point.strain[free] - strain[free];
    let x = bracketed_newton([start - 20.0 * size, start + 20.0 * size], start, 0.0, |x| {
        let (response, _) = point.trial(&complete(x));
        (dot(&response.stress), dot(&std::array::from_fn(|i| dot(&response.tangent[i]))))
    });
    let response = point.advance(&complete(x));
    let largest = response.stress.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
    assert!(dot(&response.stress).abs() <= 1e-11 * largest, "no lateral strain found: {:?}", response.stress);
    response
}

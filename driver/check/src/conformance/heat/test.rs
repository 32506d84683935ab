use super::super::tangent::Mismatch;
use super::{Kind, classify, summary};
use umat_abi::law::StressState::PlaneStrainOrAxisymmetric;

#[test]
fn a_wrong_derivative_is_called_what_it_is() {
    let derivative = [-3.0, -2.0, 1.0, 4.0];
    let kind = |reported: [f64; 4]| {
        let mismatch = Mismatch::of(derivative.to_vec());
        classify(&reported, &mismatch, Some(PlaneStrainOrAxisymmetric))
    };
    assert_eq!(kind([0.0; 4]), Kind::Zero);
    assert_eq!(kind(derivative.map(|value| -value)), Kind::Scaled(-1.0));
    assert_eq!(kind([-3.0, -2.0, 1.0, 8.0]), Kind::Shears(2.0));
    assert_eq!(kind([-3.0, -2.5, 1.0, 4.0]), Kind::Wrong);
    // of a scalar
    let scalar = Mismatch::of(vec![2.0]);
    assert_eq!(classify(&[3.0], &scalar, None), Kind::Scaled(1.5));
    let words = |kinds: &[Kind]| summary(kinds);
    assert_eq!(words(&[Kind::Scaled(2.0), Kind::Shears(2.0)]), Kind::Shears(2.0).to_string());
    assert_eq!(words(&[Kind::Scaled(2.0), Kind::Scaled(3.0)]), Kind::Wrong.to_string());
}

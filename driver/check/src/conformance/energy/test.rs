use super::{converges, order, stays};

#[test]
fn errors_that_stay_do_not_converge() {
    let falls = |power: i32| [40, 80, 160, 320].map(|n: i32| f64::from(n).powi(-power));
    assert!((order(&falls(1)) - 1.0).abs() < 1e-12 && (order(&falls(2)) - 2.0).abs() < 1e-12);
    assert!(converges(&falls(1)) && converges(&falls(2)));
    assert!(!converges(&[1e-3; 9]) && !converges(&[2e-3, 1e-3, 1e-3, 1e-3]));
    assert!(stays(&[1e-3; 9]) && stays(&[0.5, 0.302, 0.3005, 0.3001, 0.3]) && !stays(&[0.3; 3]));
    assert!(!stays(&falls(1)) && !stays(&falls(2)) && !stays(&[0.3, 0.3, f64::NAN, 0.3]));
    // the stress jumps at random places of the increments: finer ones show it
    let jump = [6.1e-4, 1.2e-3, 8.4e-4, 6.6e-4];
    assert!(!stays(&jump) && !converges(&jump) && converges(&[&jump[..], &[2e-4, 1.2e-4, 5e-5]].concat()));
    // convergent, and useless
    assert!(!converges(&falls(1).map(|error| 1e2 * error)));
}

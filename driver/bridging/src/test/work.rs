//! Works and peaks of σ(w) that no rows are needed for, against closed forms.

use super::*;
use approx::assert_relative_eq;

const SIGMA_0: f64 = 1.352_448_021_489_041_8;
/// w*.
const DEBONDED: f64 = 30.0 * 30.0 * 3.0 / (210_000.0 * 0.5);

fn works(composite: &Composite, ends: &[f64]) -> Vec<f64> {
    let totals = composite.totals(ends);
    for work in &totals.work {
        assert!(work.error <= 1e-6 * work.work, "{work:?}");
    }
    totals.work.iter().map(|work| work.work).collect()
}

/// ∫ σ_0 (1 − 2w/L_f)² dw = σ_0 L_f/6 (1 − (1 − 2w/L_f)³).
#[test]
fn rigid_friction_has_the_work_of_its_cubic() {
    let composite = pulled_out(fibre(), &Orientation::Random3d);
    let ends = [0.5, 2.5, 3.5, 16.0];
    for (to, work) in ends.into_iter().zip(works(&composite, &ends)) {
        let left = (1.0 - to / 15.0_f64).max(0.0);
        assert_relative_eq!(work, SIGMA_0 * 5.0 * (1.0 - left.powi(3)), max_relative = 1e-8);
    }
    let totals = composite.totals(&ends);
    assert_eq!((totals.peak.opening, totals.fibre_peak.opening), (0.0, 0.0));
    assert_relative_eq!(totals.peak.stress, SIGMA_0, max_relative = 1e-9);
}

/// C1 up to w*: ∫ σ_0 (2 √x − x) w* dx = 5/6 σ_0 w*, then σ_0. It begins with a root, and has a kink at w*.
#[test]
fn debonding_has_the_work_of_its_root() {
    let bond = Bond::Closed(friction(Debonding::Elastic, Sliding::Held));
    let composite = composite(fibre(), &bond, Sides::Two, &Orientation::Random3d);
    for to in [0.5 * DEBONDED, 0.5, 5.0_f64] {
        let x: f64 = (to / DEBONDED).min(1.0);
        let closed = SIGMA_0 * (DEBONDED * (4.0 / 3.0 * x * x.sqrt() - 0.5 * x * x) + (to - DEBONDED).max(0.0));
        assert_relative_eq!(works(&composite, &[to])[0], closed, max_relative = 1e-6);
    }
}

/// Fibres that act from w_a on jump there; the matrix has its own energy, G_f (1 − V_f).
#[test]
fn activation_and_matrix_are_their_sum() {
    let bond = Bond::Closed(friction(Debonding::Rigid, Sliding::Shortening));
    let single = BridgingFibre::new(fibre(), &bond, Inclination::Exp { f: 0.5 }, Sides::One, 0.0).expect("a fibre");
    let matrix = Matrix { softening: Softening::Exponential, fracture_energy: 0.1, ..matrix() };
    let composite = Composite::new(single, 0.01, &Orientation::Random3d, matrix, 0.02).expect("a composite");
    let ends = [0.01, 0.5, 15.02];
    let of_fibres = |to: f64| SIGMA_0 * 5.0 * (1.0 - (1.0 - (to - 0.02).max(0.0) / 15.0).powi(3));
    let of_matrix = |to: f64| 0.99 * 0.1 * (1.0 - (-to * 30.0).exp());
    for (to, work) in ends.into_iter().zip(works(&composite, &ends)) {
        assert_relative_eq!(work, of_fibres(to) + of_matrix(to), max_relative = 1e-7);
    }
    let totals = composite.totals(&ends);
    assert_relative_eq!(totals.fibre_peak.opening, 0.02, max_relative = 1e-12);
    assert_relative_eq!(totals.fibre_peak.stress, SIGMA_0, max_relative = 1e-9);
    // what the matrix has lost at w_a is less than what the fibres add
    assert_relative_eq!(totals.peak.stress, SIGMA_0 + 0.99 * 3.0 * (-0.6_f64).exp(), max_relative = 1e-9);
}

/// The greatest of σ_0 (2 √x − x) + 0.99 f_t e^(−f_t w/G_f), by a fine grid.
#[test]
fn the_peak_lies_between_openings() {
    let bond = Bond::Closed(friction(Debonding::Elastic, Sliding::Held));
    let plain = composite(fibre(), &bond, Sides::Two, &Orientation::Random3d);
    let matrix = Matrix { softening: Softening::Exponential, fracture_energy: 0.1, ..matrix() };
    let composite = Composite { matrix, ..plain };
    let sigma = |w: f64| {
        let x = w / DEBONDED;
        SIGMA_0 * (2.0 * x.sqrt() - x) + 0.99 * 3.0 * (-30.0 * w).exp()
    };
    let highest = (0..200_000).map(|k| sigma(DEBONDED * f64::from(k) / 2e5)).fold(0.0, f64::max);
    for ends in [vec![5.0], vec![0.5, 2.5, 3.5, 12.0]] {
        assert_relative_eq!(composite.totals(&ends).peak.stress, highest, max_relative = 1e-8);
    }
}

use super::*;
use approx::{assert_abs_diff_eq, assert_relative_eq};

/// ∫ (Y₀ + Z) dD by the trapezoidal rule in v = ln η, where the integrand and all its derivatives
/// vanish at the lower end: converges faster than any power there.
fn quadrature(law: &DamageLaw, eta: f64) -> f64 {
    let (from, to) = (-200.0_f64, eta.ln());
    let n = 400_000;
    let h = (to - from) / f64::from(n);
    let f = |v: f64| {
        let t = v.exp();
        (law.threshold + t.powf(1.0 / law.b) / law.a) * t / (1.0 + t).powi(2)
    };
    // Simpson's rule
    let mut sum = f(from) + f(to);
    for i in 1..n {
        sum += f(from + f64::from(i) * h) * if i % 2 == 1 { 4.0 } else { 2.0 };
    }
    sum * h / 3.0
}

impl DamageLaw {
    /// lim η→∞ of [`Self::dissipation`]: Y₀ + (π/B)/(A sin(π/B)) for B > 1, infinite otherwise
    /// (docs/theory/crack-band.md).
    fn total_dissipation(&self) -> f64 {
        if self.b <= 1.0 {
            return f64::INFINITY;
        }
        let p = std::f64::consts::PI / self.b;
        self.threshold + p / (self.a * p.sin())
    }
}

#[test]
fn dissipation_is_the_integral_of_the_damage_energy_release_rate() {
    for b in [0.4, 0.5, 0.55, 0.7, 0.94, 0.99, 1.0, 1.01, 1.05, 1.3, 2.0, 6.4] {
        let law = DamageLaw { a: 5000.0, b, threshold: 2e-4 };
        for eta in [1e-6, 0.1, 0.5, 0.999, 1.001, 1.5, 3.0, 50.0, 1e4] {
            assert_relative_eq!(law.dissipation(eta), quadrature(&law, eta), max_relative = 2e-10);
        }
    }
}

/// The dissipation is the same from the energy release rate as from η, also at the greatest η, where only η counts.
#[test]
fn dissipation_on_the_curve_is_the_same() {
    for b in [0.4, 0.94, 1.3, 6.4] {
        let law = DamageLaw { a: 5000.0, b, threshold: 2e-4 };
        for y in [2.000_001e-4, 3e-4, 4.1e-4, 1e-2, 1.0, 1e30, 1e300] {
            let eta = law.eta(y);
            assert_relative_eq!(law.dissipation_on_curve(eta, y), law.dissipation(eta), max_relative = 1e-13);
        }
    }
}

/// B_D(1 + p, 1 − p) of D = η/(1 + η), p = 1/1.3 as a double; 40 digits, rounded.
const REFERENCES: [(f64, f64); 10] = [
    (1e-8, 3.966_152_024_414_864e-15),
    (1e-3, 2.779_511_873_609_019e-6),
    (0.02, 5.436_862_852_724_576e-4),
    (0.1, 8.509_576_327_950_965e-3),
    (0.3, 4.787_544_198_451_692e-2),
    (0.7, 0.150_620_361_471_122_13),
    (0.999, 0.227_591_519_537_540_3),
    (1.5, 0.345_067_021_765_823_75),
    (4.0, 0.742_705_380_896_005_9),
    (100.0, 2.152_643_026_519_287),
];

#[test]
fn few_levels_are_enough() {
    let law = DamageLaw { a: 1.0, b: 1.3, threshold: 0.0 };
    for (eta, integral) in REFERENCES {
        // beyond D = 1/2 it is the rest of the whole
        let size = if eta <= 1.0 { integral } else { law.total_dissipation() };
        assert_abs_diff_eq!(law.dissipation(eta), integral, epsilon = 2e-15 * size);
    }
}

#[test]
fn dissipation_tends_to_its_closed_limit() {
    let law = DamageLaw { a: 5000.0, b: 1.3, threshold: 1.905_077e-4 };
    assert_relative_eq!(law.dissipation(1e60), law.total_dissipation(), max_relative = 1e-12);
    assert!(DamageLaw { b: 0.94, ..law }.total_dissipation().is_infinite());
}

#[test]
fn excess_inverts_eta_and_the_rate_is_the_derivative() {
    let law = DamageLaw { a: 5000.0, b: 1.3, threshold: 2e-4 };
    for y in [2.1e-4, 5e-4, 1e-2, 1.0] {
        let eta = law.eta(y);
        assert_relative_eq!(law.threshold + law.excess(eta), y, max_relative = 1e-13);
        let h = 1e-6 * (y - law.threshold);
        // dD/dY = (dη/dY)/(1+η)²: differences of D itself would cancel as D → 1
        let slope = (law.eta(y + h) - law.eta(y - h)) / (2.0 * h) * integrity(eta).powi(2);
        assert_relative_eq!(law.damage_rate(y, eta), slope, max_relative = 1e-8);
        // dZ/dη = 1/(dη/dY)
        assert_relative_eq!(
            law.excess_rate(eta) * law.damage_rate(y, eta) * (1.0 + eta).powi(2),
            1.0,
            max_relative = 1e-12
        );
    }
    assert_eq!(law.eta(2e-4), 0.0);
    assert_eq!(law.damage_rate(2e-4, 0.0), 0.0);
}

#[test]
fn extreme_arguments_stay_finite() {
    let law = DamageLaw { a: 2e18, b: 6.4, threshold: 6.45e-4 };
    let eta = law.eta(1e6);
    assert_eq!(eta, ETA_MAX);
    assert!(integrity(eta) > 0.0 && law.damage_rate(1e6, eta).is_finite());
    assert!(law.dissipation(eta).is_finite());
}

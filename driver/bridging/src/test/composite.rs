use super::*;
use approx::assert_relative_eq;

#[test]
fn matrices_spend_their_fracture_energy() {
    for softening in [Softening::Exponential, Softening::Hordijk, Softening::Bilinear] {
        let matrix = Matrix { softening, fracture_energy: 0.1, ..matrix() };
        assert_relative_eq!(matrix.stress(0.0), 3.0);
        let panels = (0..60).map(|k| 0.02 * f64::from(k));
        let energy: f64 = panels.map(|w| quadrature::integral(2, w, w + 0.02, |w| matrix.stress(w))).sum();
        assert_relative_eq!(energy, 0.1, max_relative = 2e-3);
    }
}

#[test]
fn the_law_is_the_sum_of_matrix_and_fibres_from_the_activation_on() {
    let bond = Bond::Closed(friction(Debonding::Rigid, Sliding::Shortening));
    let single = BridgingFibre::new(fibre(), &bond, Inclination::Exp { f: 0.5 }, Sides::One, 0.0).expect("a fibre");
    let matrix = Matrix { softening: Softening::Exponential, fracture_energy: 0.1, ..matrix() };
    let composite = Composite::new(single, 0.01, &Orientation::Random3d, matrix, 0.02).expect("a composite");
    assert_eq!(composite.average(0.01).stress, 0.0);
    let plain = pulled_out(fibre(), &Orientation::Random3d);
    assert_relative_eq!(composite.average(1.02).stress, plain.average(1.0).stress, max_relative = 1e-12);
    let law = composite.law(&averages(&composite, &[0.0, 0.02, 0.5, 1.02, 3.0]));
    let expected = plain.average(1.0).stress + 0.99 * 3.0 * (-3.0 * 1.02 / 0.1_f64).exp();
    assert_relative_eq!(law.at(1.02), expected, max_relative = 1e-12);
    assert_relative_eq!(composite.fibres_per_area(), 0.5 * 0.01 / fibre().area());
}

#[test]
fn inputs_are_read_as_a_case_writes_them() {
    let bond: Bond = serde_json::from_str(r#"{"model": "closed", "tau": 3, "debonding": "rigid"}"#).expect("a bond");
    assert_eq!(bond, Bond::Closed(friction(Debonding::Rigid, Sliding::Shortening)));
    let bond: Bond =
        serde_json::from_str(r#"{"model": "shear_lag", "law": [[0, 1], [1, 2]]}"#).expect("a bond of a law");
    assert_eq!(bond, Bond::ShearLag(ShearLag { law: BondLaw { points: vec![[0.0, 1.0], [1.0, 2.0]] } }));
    let read: Fibre = serde_json::from_str(r#"{"diameter": 0.5, "length": 30, "E": 210000}"#).expect("a fibre");
    assert_eq!(read, fibre());
    let read: Matrix = serde_json::from_str(r#"{"E": 30000, "ft": 3}"#).expect("a matrix");
    assert_eq!(read, matrix());
    let read: Orientation = serde_json::from_str(r#"{"type": "random3d"}"#).expect("an orientation");
    assert_eq!(read, Orientation::Random3d);
    let read: NotchedBeam = serde_json::from_str(r#"{"hinge_length": 62.5}"#).expect("a beam");
    assert_eq!(read.hinge(), NotchedBeam::default().hinge());
    let refused = [
        serde_json::from_str::<Inclination>(r#"{"type": "exp", "g": 3}"#).map(drop),
        serde_json::from_str::<Matrix>(r#"{"E": 30000, "ft": 3, "fct": 3}"#).map(drop),
        serde_json::from_str::<Orientation>(r#"{"type": "beta", "r": 1}"#).map(drop),
    ];
    assert!(refused.iter().all(Result::is_err), "{refused:?}");
}

/// Tables 5.1-3 and 5.1-7 of the Model Code 2010 by their formulas, rounded as there; G_F of C40 is 147 N/m.
#[test]
fn concrete_of_a_class_has_the_values_of_the_model_code() {
    for (name, [strength, tensile, modulus]) in
        [("C20/25", [28.0, 2.2, 30.3e3]), ("C40", [48.0, 3.5, 36.3e3]), ("C80/95", [88.0, 4.8, 44.4e3])]
    {
        let concrete = Concrete::of_class(name).expect("a class");
        let errors = [
            (concrete.compressive_strength - strength) / 1e-9,
            (concrete.tensile_strength - tensile) / 0.05,
            (concrete.modulus - modulus) / 50.0,
        ];
        assert!(errors.iter().all(|error| error.abs() <= 1.0), "{name}: {concrete:?}");
        assert_eq!(Concrete::of_mean(strength), Ok(concrete));
    }
    assert!((Concrete::of_class("C40").expect("a class").fracture_energy - 0.147).abs() < 5e-4);
    for name in ["40", "C", "C40/", "c40", "C40/x", "C4", "C500", "C-40", "C40.5"] {
        assert!(Concrete::of_class(name).is_err(), "{name}");
    }
    // EN 206, table 12: cylinders and cubes go together
    for (name, near) in [("C30/25", "C30/37"), ("C40/60", "C40/50"), ("C42/50", "C40/50"), ("C41/51", "no class")] {
        let refused = Concrete::of_class(name).expect_err(name);
        assert!(refused.contains(near), "{refused}");
    }
    for name in ["C12/15", "C30/37", "C55/67", "C90/105"] {
        assert_eq!(Concrete::of_class(name), Concrete::of_class(name.split('/').next().expect("a cylinder")));
    }
    assert!(Concrete::of_mean(5.0).is_err() && Concrete::of_mean(f64::NAN).is_err());
}

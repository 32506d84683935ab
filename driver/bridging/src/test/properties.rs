use super::*;
use proptest::prelude::*;

fn config() -> proptest::test_runner::Config {
    proptest::test_runner::Config {
        cases: 50,
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        ..Default::default()
    }
}

prop_compose! {
    fn bonds()(tau in 0.5..8.0, beta in 0.0..0.1, energy in 0.0..0.003, kind in 0..3_u8, law in prop::bool::ANY) -> Bond {
        if law {
            let points = vec![[0.0, 0.3 * tau], [0.02, tau], [1.0 + 10.0 * beta, 0.5 * tau], [20.0, 0.1 * tau]];
            return Bond::ShearLag(ShearLag { law: BondLaw { points } });
        }
        let debonding = [Debonding::Rigid, Debonding::Elastic, Debonding::Elastic][usize::from(kind)];
        let debonding_energy = if kind == 2 { energy } else { 0.0 };
        Bond::Closed(Closed { tau, beta, debonding_energy, debonding, sliding: Sliding::Shortening, hook: None })
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn loads_are_loads(bond in bonds(), two in prop::bool::ANY, part in 0.01..1.0_f64, angle in 0.0..1.5_f64) {
        let sides = if two { Sides::Two } else { Sides::One };
        let fibre = BridgingFibre::new(fibre(), &bond, Inclination::Exp { f: 0.4 }, sides, 0.0).expect("a fibre");
        for k in 0..60 {
            let response = fibre.at(0.3 * f64::from(k), 15.0 * part, angle);
            prop_assert!(response.load >= 0.0 && response.load.is_finite());
        }
        // out of the matrix, whatever the long side has kept
        prop_assert_eq!(fibre.at(16.0, 15.0 * part, angle).load, 0.0);
    }

    #[test]
    fn bridging_is_in_proportion_to_the_fibres(bond in bonds(), opening in 0.01..10.0_f64) {
        let of = |part: f64| {
            let fibre = BridgingFibre::new(fibre(), &bond, Inclination::default(), Sides::Two, 0.0).expect("a fibre");
            Composite::new(fibre, part, &Orientation::Planar, matrix(), 0.0).expect("a composite").average(opening).stress
        };
        let (one, two) = (of(0.01), of(0.02));
        prop_assert!((2.0 * one - two).abs() <= 1e-12 * two);
    }

    #[test]
    fn stronger_fibres_bridge_more(strength in 200.0..1500.0_f64, opening in 0.01..10.0_f64) {
        let of = |strength| {
            pulled_out(Fibre { strength, rupture_f: 0.2, ..fibre() }, &Orientation::Random3d).average(opening)
        };
        let (weak, strong, whole) = (of(Some(strength)), of(Some(1.2 * strength)), of(None));
        prop_assert!(weak.stress <= strong.stress * (1.0 + 1e-9) && strong.stress <= whole.stress * (1.0 + 1e-9));
        prop_assert!(weak.ruptured >= strong.ruptured - 1e-9);
    }
}

prop_compose! {
    fn extreme()(
        steps in prop::collection::vec((-5.0..0.5_f64, 0.0..1.0_f64), 1..6),
        first in prop::bool::ANY,
        scale in -2.0..2.5_f64,
        modulus in 2.0..10.0_f64,
        slender in 1.0..4.0_f64,
    ) -> (Fibre, Bond) {
        let mut points = vec![[0.0, if first { 10_f64.powf(scale) } else { 0.0 }]];
        for (step, part) in steps {
            let slip = points[points.len() - 1][0] + 10_f64.powf(step);
            points.push([slip, 10_f64.powf(scale) * if points.len() == 1 { part + 0.01 } else { part }]);
        }
        let fibre = Fibre { diameter: 30.0 / 10_f64.powf(slender), modulus: 10_f64.powf(modulus), ..fibre() };
        (fibre, Bond::ShearLag(ShearLag { law: BondLaw { points } }))
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn any_bond_law_of_any_fibre_has_loads((fibre, bond) in extreme(), two in prop::bool::ANY, part in 0.001..1.0_f64) {
        let sides = if two { Sides::Two } else { Sides::One };
        let bridging = BridgingFibre::new(fibre, &bond, Inclination::Exp { f: 0.4 }, sides, 0.0).expect("a fibre");
        for k in 0..40 {
            let load = bridging.at(16.0 * (f64::from(k) / 39.0).powi(4), 15.0 * part, 0.3).load;
            prop_assert!(load >= 0.0 && load.is_finite(), "{} at {}", load, k);
        }
        let average = Composite::new(bridging, 0.01, &Orientation::Planar, matrix(), 0.0).expect("a composite").average(0.3);
        prop_assert!(average.stress >= 0.0 && average.stress.is_finite());
    }
}

use super::*;
use approx::assert_relative_eq;
use std::f64::consts::PI;

/// Constant friction, the same at all angles: P = π d τ (L − s).
fn friction_table(angles: &[f64], lengths: &[f64]) -> Table {
    let curve = |angle_deg: f64, embedded: f64| Curve {
        angle_deg,
        embedded,
        slip: vec![0.0, embedded],
        load: vec![PI * 0.5 * 3.0 * embedded, 0.0],
    };
    let curves: Vec<Curve> = angles.iter().flat_map(|&a| lengths.iter().map(move |&l| curve(a, l))).collect();
    Table::new(&curves, 90.0, 30.0).expect("a table")
}

fn averaged(table: Table, sides: Sides, orientation: &Orientation) -> Composite {
    let fibre = BridgingFibre::of_table(fibre(), table, None, sides).expect("a fibre");
    Composite::new(fibre, 0.01, orientation, matrix(), 0.0).expect("a composite")
}

#[test]
fn curves_without_regard_of_the_angle_are_c2_without_snubbing() {
    let lengths = [1.875, 3.75, 7.5, 11.25, 15.0];
    for sides in [Sides::One, Sides::Two] {
        let table = friction_table(&[0.0, 15.0, 30.0, 45.0, 60.0, 75.0], &lengths);
        let composite = averaged(table, sides, &Orientation::Random3d);
        let sigma_0 = 0.5 * 3.0 * 0.01 * 30.0 / 0.5;
        for opening in [0.0, 0.1, 1.0, 2.5, 7.5, 12.0] {
            let average = composite.average(opening);
            let expected: f64 = sigma_0 * (1.0 - opening / 15.0_f64).powi(2);
            assert_relative_eq!(average.stress, expected, epsilon = 5e-3 * sigma_0, max_relative = 5e-3);
        }
    }
}

#[test]
fn between_lengths_constant_friction_is_exact() {
    let table = friction_table(&[0.0], &[2.0, 7.0, 15.0]);
    for embedded in [0.4, 1.9, 5.0, 14.0] {
        for part in [0.0, 0.3, 0.9, 1.0, 1.2] {
            let expected: f64 = (PI * 0.5 * 3.0 * embedded * (1.0 - part)).max(0.0);
            assert_relative_eq!(table.row(part * embedded, embedded, true).at(0.0).0, expected, epsilon = 1e-12);
        }
    }
}

#[test]
fn aligned_fibres_have_the_mean_over_lengths() {
    let table = friction_table(&[0.0], &[2.0, 5.0, 15.0]);
    let aligned = Orientation::Aligned { mean_deg: 0.0, spread_deg: 0.0 };
    let composite = averaged(table, Sides::One, &aligned);
    assert_eq!(composite.directions.efficiency, 1.0);
    for opening in [0.05_f64, 0.1, 3.0, 9.0] {
        let mean = PI * 0.5 * 3.0 * (15.0 - opening).powi(2) / 2.0 / 15.0;
        assert_relative_eq!(composite.average(opening).stress, 0.01 / fibre().area() * mean, max_relative = 1e-10);
    }
}

#[test]
fn curves_that_end_with_a_load_carry_nothing_after_extraction() {
    for end in [3.0, 20.0] {
        let curve = Curve { angle_deg: 0.0, embedded: 15.0, slip: vec![0.0, end], load: vec![10.0, 8.0] };
        let table = Table::new(&[curve], 90.0, 30.0).expect("a table");
        assert!(table.row(0.99 * end, 15.0, false).at(0.0).0 > 8.0);
        assert_eq!(table.row(end.max(15.0) + 1e-9, 15.0, false).at(0.0).0, 0.0);
    }
}

#[test]
fn angles_beyond_the_cut_carry_nothing() {
    let curves: Vec<Curve> = [0.0, 60.0]
        .map(|angle_deg| Curve { angle_deg, embedded: 15.0, slip: vec![0.0, 15.0], load: vec![10.0, 0.0] })
        .into();
    let table = Table::new(&curves, 80.0, 30.0).expect("a table");
    let row = table.row(1.0, 10.0, true);
    assert!(row.at(79.9_f64.to_radians()).0 > 0.0);
    assert_eq!(row.at(80.1_f64.to_radians()), (0.0, 0.0));
}

#[test]
fn tables_that_are_none_are_refused_with_their_place() {
    let curve =
        |angle_deg: f64, embedded: f64| Curve { angle_deg, embedded, slip: vec![0.0, 1.0], load: vec![1.0, 0.0] };
    let place = |curves: &[Curve], cut: f64| Table::new(curves, cut, 30.0).expect_err("no table").place;
    assert_eq!(place(&[curve(0.0, 7.0)], 80.0), "fibre.curves");
    assert_eq!(place(&[curve(0.0, 15.0), curve(30.0, 7.0)], 80.0), "fibre.curves");
    assert_eq!(place(&[curve(95.0, 15.0)], 80.0), "fibre.curves[0]");
    assert_eq!(
        place(&[curve(0.0, 15.0), Curve { slip: vec![1.0, 0.5], ..curve(30.0, 15.0) }], 80.0),
        "fibre.curves[1]"
    );
    assert_eq!(place(&[curve(85.0, 15.0)], 80.0), "fibre.cut_deg");
}

#[test]
fn two_sides_of_a_table_are_those_of_the_law_it_was_made_of() {
    // soft enough for the long side to count
    let soft = Fibre { modulus: 5000.0, ..fibre() };
    let bond = friction(Debonding::Elastic, Sliding::Shortening);
    let single = |sides| BridgingFibre::new(soft, &Bond::Closed(bond.clone()), Inclination::Exp { f: 0.4 }, sides, 0.0);
    let one = single(Sides::One).expect("a fibre");
    let curve = |angle_deg: f64, embedded: f64| {
        let end = embedded + 2.0 * 3.0 * embedded * embedded / (5000.0 * 0.5);
        let slip: Vec<f64> = (0..=500).map(|k| end * (f64::from(k) / 500.0).powi(2)).collect();
        let load = slip.iter().map(|&slip| one.at(slip, embedded, angle_deg.to_radians()).load).collect();
        Curve { angle_deg, embedded, slip, load }
    };
    let curves: Vec<Curve> = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0]
        .iter()
        .flat_map(|&angle| (1..=24).map(move |k| (angle, 15.0 * f64::from(k) / 24.0)))
        .map(|(angle, length)| curve(angle, length))
        .collect();
    for sides in [Sides::One, Sides::Two] {
        let law = single(sides).expect("a fibre");
        let law = Composite::new(law, 0.01, &Orientation::Random3d, matrix(), 0.0).expect("a composite");
        let table = Table::new(&curves, 90.0, 30.0).expect("a table");
        let table = BridgingFibre::of_table(soft, table, None, sides).expect("a fibre");
        let table = Composite::new(table, 0.01, &Orientation::Random3d, matrix(), 0.0).expect("a composite");
        let peak = law.average(0.3).stress;
        for opening in [0.02, 0.1, 0.3, 0.6, 1.0, 3.0, 8.0] {
            let (a, b) = (law.average(opening).stress, table.average(opening).stress);
            assert_relative_eq!(a, b, epsilon = 5e-3 * peak);
        }
    }
}

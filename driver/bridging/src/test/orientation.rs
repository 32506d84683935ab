use super::*;
use approx::assert_relative_eq;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, LN_2};

fn directions(orientation: &Orientation) -> Directions {
    orientation.directions(60.0, &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn third(a: f64, b: f64, c: f64) -> [[f64; 3]; 3] {
    [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]]
}

#[test]
fn densities_are_densities() {
    let all = [
        Orientation::Random3d,
        Orientation::Planar,
        Orientation::Aligned { mean_deg: 20.0, spread_deg: 10.0 },
        Orientation::Aligned { mean_deg: 0.0, spread_deg: 0.5 },
        Orientation::Beta { r: 1.3, q: 0.8 },
        Orientation::Tensor { a: third(0.6, 0.3, 0.1), normal: [1.0, 0.2, 0.0] },
        Orientation::Histogram { edges_deg: vec![0.0, 10.0, 40.0, 90.0], counts: vec![3.0, 5.0, 2.0], file: None },
        Orientation::Number { eta: 0.7, spread_deg: 20.0 },
        Orientation::Section { size: [150.0, 125.0], faces: Faces { width: 2, height: 1 } },
    ];
    for orientation in &all {
        let directions = directions(orientation);
        assert_relative_eq!(directions.converged(|_| 1.0), 1.0, epsilon = 1e-9);
        assert_relative_eq!(directions.converged(f64::cos), directions.efficiency, epsilon = 1e-12);
    }
}

#[test]
fn efficiencies_in_closed_form() {
    assert_relative_eq!(directions(&Orientation::Random3d).efficiency, 0.5, epsilon = 1e-14);
    assert_relative_eq!(directions(&Orientation::Planar).efficiency, FRAC_2_PI, epsilon = 1e-14);
    let aligned = Orientation::Aligned { mean_deg: 60.0, spread_deg: 0.0 };
    assert_relative_eq!(directions(&aligned).efficiency, 0.5, epsilon = 1e-14);
    // B(r, q + ½)/B(r, q)
    let beta = directions(&Orientation::Beta { r: 2.0, q: 1.5 }).efficiency;
    assert_relative_eq!(beta, (1.0 * 1.0 / 6.0) / (4.0 / 15.0), epsilon = 1e-12);
    let random = directions(&Orientation::Beta { r: 1.0, q: 0.5 });
    assert_relative_eq!(random.efficiency, 0.5, epsilon = 1e-12);
    assert_relative_eq!(random.density(0.7), 0.7_f64.sin(), epsilon = 1e-12);
    let number = directions(&Orientation::Number { eta: 0.62, spread_deg: 20.0 });
    assert_relative_eq!(number.efficiency, 0.62, epsilon = 1e-12);
}

#[test]
fn a_tensor_has_its_second_moments() {
    let isotropic =
        directions(&Orientation::Tensor { a: third(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0), normal: [1.0, 2.0, 3.0] });
    for angle in [0.1, 0.6, 1.2, 1.5] {
        assert_relative_eq!(isotropic.density(angle), f64::sin(angle), epsilon = 1e-10);
    }
    let a = [[0.55, 0.1, 0.02], [0.1, 0.3, -0.05], [0.02, -0.05, 0.15]];
    for normal in [[1.0, 0.0, 0.0], [0.3, -0.7, 0.2], [0.0, 0.0, 2.0]] {
        let moment = directions(&Orientation::Tensor { a, normal }).converged(|angle| angle.cos().powi(2));
        let square: f64 = normal.iter().map(|n| n * n).sum();
        let expected: f64 = (0..9).map(|k| normal[k / 3] * a[k / 3][k % 3] * normal[k % 3]).sum::<f64>() / square;
        assert_relative_eq!(moment, expected, epsilon = 1e-9);
    }
    // nearly a line, nearly a plane
    let line = directions(&Orientation::Tensor { a: third(0.98, 0.01, 0.01), normal: [1.0, 0.0, 0.0] });
    assert_relative_eq!(line.converged(|angle| angle.cos().powi(2)), 0.98, epsilon = 1e-6);
    let plane = directions(&Orientation::Tensor { a: third(0.495, 0.495, 0.01), normal: [1.0, 0.0, 0.0] });
    assert_relative_eq!(plane.efficiency, FRAC_2_PI, epsilon = 5e-3);
}

#[test]
fn walls_turn_fibres_as_dupont_and_vandewalle_say() {
    let ligament = ([150.0, 125.0], Faces { width: 2, height: 1 });
    let zones = wall_zones(ligament.0, &ligament.1, 60.0).expect("a section");
    let exact = directions(&Orientation::Section { size: ligament.0, faces: ligament.1 }).efficiency;
    println!("EN 14651, L_f 60: η {zones:.4} by zones, {exact:.4} by the cut-off");
    assert_relative_eq!(zones, 0.456 * 0.5 + 0.448 * 0.6 + 0.096 * 0.84, epsilon = 1e-12);
    assert_relative_eq!(exact, zones, max_relative = 0.01);
    let free = Orientation::Section { size: [1.0, 1.0], faces: Faces { width: 0, height: 0 } };
    assert_relative_eq!(directions(&free).efficiency, 0.5, epsilon = 1e-6);
    // one wall only
    let wall = Orientation::Section { size: [30.0, 1.0], faces: Faces { width: 1, height: 0 } };
    assert_relative_eq!(directions(&wall).efficiency, 0.5 * LN_2 + 0.25, epsilon = 1e-5);
    // a corner only
    let corner = Orientation::Section { size: [30.0, 30.0], faces: Faces { width: 1, height: 1 } };
    let corner = directions(&corner).efficiency;
    println!("corner: {corner:.4}");
    assert_relative_eq!(corner, 0.84, epsilon = 0.1);
}

/// What is integrated over the density of a section is smooth, the density is not: two coarse rules agree, and with the sum over
/// each interval of its table.
#[test]
fn coarse_rules_are_exact_over_a_density_from_a_table() {
    let section = Orientation::Section { size: [150.0, 125.0], faces: Faces { width: 2, height: 1 } };
    // bins of the angle, as for shares, and a panel within one interval of the table
    for breaks in [vec![], Composite::bin_edges(), vec![0.7001, 0.7002]] {
        let directions = section.directions(60.0, &breaks).expect("a section");
        let load = |angle: f64| (0.35 * angle).exp() * angle.cos();
        let intervals = (0..512).map(|k| [k, k + 1].map(|k| FRAC_PI_2 * f64::from(k) / 512.0));
        let fine = intervals.flat_map(|[from, to]| directions.nodes_between(1, from, to).collect::<Vec<_>>());
        let exact: f64 = fine.map(|(angle, weight)| weight * load(angle)).sum();
        for level in 0..2 {
            let panels = 0..directions.panels.len() - 1;
            let nodes = panels.flat_map(|panel| directions.nodes(level, panel).to_vec());
            let coarse: f64 = nodes.map(|(angle, weight)| weight * load(angle)).sum();
            assert_relative_eq!(coarse, exact, max_relative = 5e-10);
        }
    }
}

#[test]
fn shares_by_angle_are_the_integral_over_the_bins() {
    let composite = pulled_out(fibre(), &Orientation::Random3d);
    let (_, shares) = averages_with_shares(&composite, &[1.0])[0];
    assert_relative_eq!(shares.iter().sum::<f64>(), 1.0, epsilon = 1e-12);
    // ∫ sin cos e^(θ/2)
    let primitive = |degrees: f64| {
        let (double, f) = (2.0 * degrees.to_radians(), 0.5);
        (0.5 * f * double).exp() * (f * double.sin() - 2.0 * double.cos()) / (2.0 * (f * f + 4.0))
    };
    let total = primitive(90.0) - primitive(0.0);
    for (k, share) in shares.iter().enumerate() {
        let from = 10.0 * k as f64;
        assert_relative_eq!(*share, (primitive(from + 10.0) - primitive(from)) / total, epsilon = 1e-9);
    }
}

use super::*;

fn place<T: std::fmt::Debug>(result: Result<T, Invalid>) -> String {
    result.expect_err("refused").place
}

#[test]
fn numbers_without_sense_are_refused_with_their_place() {
    let rigid = Bond::Closed(friction(Debonding::Rigid, Sliding::Shortening));
    let of = |fibre: Fibre, bond: &Bond, inclination: Inclination| {
        place(BridgingFibre::new(fibre, bond, inclination, Sides::One, 0.0))
    };
    let snubbing = Inclination::Exp { f: 0.5 };
    assert_eq!(of(Fibre { diameter: 0.0, ..fibre() }, &rigid, snubbing), "fibre.diameter");
    assert_eq!(of(Fibre { length: 2.0, ..fibre() }, &rigid, snubbing), "fibre.length");
    assert_eq!(of(Fibre { length: f64::NAN, ..fibre() }, &rigid, snubbing), "fibre.length");
    assert_eq!(of(Fibre { modulus: -1.0, ..fibre() }, &rigid, snubbing), "fibre.E");
    assert_eq!(of(Fibre { strength: Some(0.0), ..fibre() }, &rigid, snubbing), "fibre.strength");
    assert_eq!(of(Fibre { rupture_f: -0.1, ..fibre() }, &rigid, snubbing), "fibre.rupture_f");
    assert_eq!(of(fibre(), &rigid, Inclination::Exp { f: -1.0 }), "fibre.inclination.f");
    assert_eq!(of(fibre(), &rigid, Inclination::Spalling { k: 0.1, k_sp: 0.0, ft: 3.0 }), "fibre.inclination.k_sp");
    let closed = |closed: Closed| of(fibre(), &Bond::Closed(closed), snubbing);
    let plain = friction(Debonding::Rigid, Sliding::Shortening);
    assert_eq!(closed(Closed { tau: 0.0, ..plain.clone() }), "fibre.tau");
    assert_eq!(closed(Closed { debonding_energy: 0.1, ..plain.clone() }), "fibre.debonding_energy");
    assert_eq!(closed(Closed { debonding: Debonding::Hardening, ..plain.clone() }), "fibre.beta");
    let law = |points: &[[f64; 2]]| {
        of(fibre(), &Bond::ShearLag(ShearLag { law: BondLaw { points: points.into() } }), snubbing)
    };
    assert_eq!(law(&[[0.0, 1.0]]), "fibre.law");
    assert_eq!(law(&[[0.1, 1.0], [0.2, 1.0]]), "fibre.law[0]");
    assert_eq!(law(&[[0.0, 1.0], [0.0, 2.0]]), "fibre.law[1]");
    assert_eq!(law(&[[0.0, 0.0], [1.0, 0.0]]), "fibre.law[1]");
    let volume = |part: f64| {
        let fibre = BridgingFibre::new(fibre(), &rigid, snubbing, Sides::One, 0.0).expect("a fibre");
        place(Composite::new(fibre, part, &Orientation::Random3d, matrix(), 0.0))
    };
    assert_eq!(volume(0.3), "volume_fraction");
    assert_eq!(volume(f64::NAN), "volume_fraction");
    let orientation = |orientation: Orientation| place(orientation.directions(30.0, &[]));
    assert_eq!(orientation(Orientation::Beta { r: 0.1, q: 1.0 }), "orientation.r");
    assert_eq!(orientation(Orientation::Aligned { mean_deg: 100.0, spread_deg: 5.0 }), "orientation.mean_deg");
    let uneven = Orientation::Histogram { edges_deg: vec![0.0, 50.0, 40.0], counts: vec![1.0, 1.0], file: None };
    assert_eq!(orientation(uneven), "orientation.edges_deg");
    let empty = Orientation::Histogram { edges_deg: vec![0.0, 50.0], counts: vec![0.0], file: None };
    assert_eq!(orientation(empty), "orientation.counts");
    assert_eq!(orientation(Orientation::Number { eta: 0.999, spread_deg: 20.0 }), "orientation.eta");
    let a = [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]];
    assert_eq!(orientation(Orientation::Tensor { a, normal: [1.0, 0.0, 0.0] }), "orientation.a");
    let thin = Orientation::Section { size: [20.0, 125.0], faces: Faces { width: 2, height: 1 } };
    assert_eq!(orientation(thin), "orientation.size[0]");
    assert_eq!(place(NotchedBeam { notch: 200.0, ..NotchedBeam::default() }.check()), "beam.notch");
    assert_eq!(place(Scatter { beams: 0, ..Scatter::default() }.check()), "scatter.beams");
    let plane = pulled_out(fibre(), &Orientation::Planar);
    let openings =
        |openings: &[f64]| scatter(&plane, &NotchedBeam::default(), openings, &[], &Scatter::default(), &|| false);
    assert_eq!(place(openings(&[0.1, 1.0])), "openings");
    assert_eq!(place(openings(&[0.0, 1.0, 1.0])), "openings");
    assert_eq!(place(Matrix { softening: Softening::Hordijk, ..matrix() }.check()), "matrix.Gf");
}

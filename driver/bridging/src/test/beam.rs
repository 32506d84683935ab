use super::*;
use crate::beam::BeamLoad;
use approx::assert_relative_eq;

fn tested(law: Polyline, matrix: &Matrix, geometry: NotchedBeam) -> (Residual, Vec<BeamLoad>) {
    let section = [SectionLaw::new(matrix, &law, geometry.hinge())];
    let beam = LayeredBeam::new(geometry, &section, matrix);
    (beam.residual(), [0.02, 0.1, 0.5, 1.5, 3.5].map(|cmod| beam.at(cmod)).into())
}

fn strengths(law: Polyline) -> Residual {
    tested(law, &matrix(), NotchedBeam::default()).0
}

#[test]
fn a_constant_law_is_its_closed_form() {
    let residual = strengths(Polyline::new([(0.0, 1.0), (5.0, 1.0)])).residual;
    for (computed, expected) in residual.into_iter().zip([2.8111991, 2.8878574, 2.9124789, 2.9257513]) {
        assert_relative_eq!(computed, expected, epsilon = 6e-8);
    }
    // M, φ and y_0 of the closed form
    let (_, loads) = tested(Polyline::new([(0.0, 1.0), (5.0, 1.0)]), &matrix(), NotchedBeam::default());
    let load = loads[2];
    let (k, h) = (30_000.0 * load.rotation / 62.5, 125.0);
    let (tip, y) = (3.0 / k, load.neutral_axis);
    assert_relative_eq!(0.5 * k * y * y + y, 0.5 * 3.0 * tip + h - tip, max_relative = 1e-10);
    let moment = 150.0 * (-k * y.powi(3) / 6.0 + 1.5 * tip * (y + tip / 1.5) + 0.5 * (h * h - (y + tip) * (y + tip)));
    // ∫σ y from the top: compression has its lever from there
    let compression = 150.0 * k * y.powi(3) / 6.0;
    assert_relative_eq!(4.0 * (moment + compression - compression) / 500.0, load.force, max_relative = 1e-9);
    let cmod = load.rotation * (h - y) - 62.5 / 30_000.0 + 25.0 * load.rotation;
    assert_relative_eq!(cmod, 0.5, max_relative = 1e-10);
}

#[test]
fn other_laws_are_those_of_three_hundred_layers() {
    let linear = strengths(Polyline::new([(0.0, 1.5), (3.75, 0.0), (5.0, 0.0)])).residual;
    for (computed, expected) in linear.into_iter().zip([3.871, 3.384, 2.784, 2.156]) {
        assert_relative_eq!(computed, expected, max_relative = 3e-3);
    }
    let law = pulled_out(fibre(), &Orientation::Random3d).law_to(15.0, 400);
    let pulled_out = strengths(law);
    println!("linear {linear:?}, C2 {pulled_out:?}");
    // 3000 layers at CMOD 0.05
    assert_relative_eq!(pulled_out.limit, 3.2569, max_relative = 3e-4);
    for (computed, expected) in pulled_out.residual.into_iter().zip([3.633, 3.483, 3.255, 3.019]) {
        assert_relative_eq!(computed, expected, max_relative = 3e-3);
    }
}

#[test]
fn a_rigid_beam_has_three_times_the_stress() {
    let stiff = Matrix { modulus: 3e9, ..matrix() };
    let residual = tested(Polyline::new([(0.0, 1.0), (5.0, 1.0)]), &stiff, NotchedBeam::default()).0.residual;
    residual.into_iter().for_each(|strength| assert_relative_eq!(strength, 3.0, max_relative = 1e-3));
}

#[test]
fn equal_strips_are_one_section() {
    let law = Polyline::new([(0.0, 2.0), (0.3, 0.8), (4.0, 0.2)]);
    let section = SectionLaw::new(&matrix(), &law, 62.5);
    let (one, seven) = ([section.clone()], vec![section; 7]);
    let at = |strips: &[SectionLaw]| LayeredBeam::new(NotchedBeam::default(), strips, &matrix()).at(1.1).force;
    assert_relative_eq!(at(&one), at(&seven), max_relative = 1e-9);
}

#[test]
fn before_the_crack_the_beam_is_elastic_and_loads_go_on_steadily() {
    let law = Polyline::new([(0.0, 3.0), (0.02, 1.0), (4.0, 0.5)]);
    let section = [SectionLaw::new(&matrix(), &law, 62.5)];
    let beam = LayeredBeam::new(NotchedBeam::default(), &section, &matrix());
    let mut before = beam.at(0.0);
    assert_eq!(before.force, 0.0);
    for k in 1..10_000 {
        let load = beam.at(1e-4 * f64::from(k));
        assert!((load.force - before.force).abs() < 0.05 * 13_000.0, "{before:?} {load:?}");
        before = load;
    }
}

#[test]
fn steep_laws_snap_within_a_layer() {
    let gentle = SectionLaw::new(&matrix(), &Polyline::new([(0.0, 3.0), (0.1, 0.0), (4.0, 0.0)]), 62.5);
    assert!(!gentle.snaps);
    let steep = SectionLaw::new(&matrix(), &Polyline::new([(0.0, 3.0), (0.001, 0.5), (4.0, 0.0)]), 62.5);
    assert!(steep.snaps);
}

#[test]
fn crushing_concrete_carries_less() {
    let law = || Polyline::new([(0.0, 4.0), (4.0, 4.0)]);
    let weak = Matrix { fc: Some(12.0), ..matrix() };
    let strong = Matrix { fc: Some(300.0), ..matrix() };
    let [weak, strong, elastic] =
        [weak, strong, matrix()].map(|matrix| tested(law(), &matrix, NotchedBeam::default()).0.residual[2]);
    assert!(weak < 0.99 * elastic, "{weak} {elastic}");
    assert_relative_eq!(strong, elastic, max_relative = 5e-3);
}

#[test]
fn strength_does_not_depend_on_the_width() {
    let law = || Polyline::new([(0.0, 1.5), (3.75, 0.0), (5.0, 0.0)]);
    let wide = NotchedBeam { width: 300.0, ..NotchedBeam::default() };
    assert_relative_eq!(
        tested(law(), &matrix(), wide).0.residual[1],
        strengths(law()).residual[1],
        max_relative = 1e-10
    );
    // twice the size with twice the openings
    let large = NotchedBeam { width: 150.0, height: 300.0, span: 1000.0, notch: 50.0, hinge_length: Some(125.0) };
    let stretched = Polyline::new([(0.0, 1.5), (7.5, 0.0), (10.0, 0.0)]);
    let section = [SectionLaw::new(&matrix(), &stretched, 125.0)];
    let force = LayeredBeam::new(large, &section, &matrix()).at(3.0).force;
    assert_relative_eq!(large.flexural_strength(force), strengths(law()).residual[1], max_relative = 1e-9);
}

#[test]
fn model_code_next_to_the_law_it_represents() {
    // the linear law is 1.5 MPa at 0 and 0.5 MPa at 2.5 mm
    let residual = strengths(Polyline::new([(0.0, 1.5), (3.75, 0.0), (5.0, 0.0)])).residual;
    let code = ModelCode2010::new(residual[0], residual[2], 2.5);
    assert_relative_eq!(code.serviceability, 1.74, epsilon = 5e-3);
    assert_relative_eq!(code.ultimate, 0.62, epsilon = 5e-3);
    assert_relative_eq!(code.rigid_plastic, residual[2] / 3.0);
    let class = StrengthClass::new(4.0, 3.2, 2.5).expect("a class");
    assert_eq!((class.to_string().as_str(), class.structural), ("3b", true));
    assert_eq!(StrengthClass::new(4.0, 0.9, 0.9), None);
    assert_eq!(StrengthClass::new(4.0, 2.0, 0.9), None);
    assert!(!StrengthClass::new(8.0, 3.0, 3.0).expect("a class").structural);
}

/// Table L.2 of EN 1992-1-1:2023, as the program pycivil quotes it: a class between those of the Model Code, and f_R3k compared with the
/// table's, not with f_R1k.
#[test]
fn classes_of_the_eurocode_lie_between_those_of_the_model_code() {
    let classes = |f_r1, f_r3| {
        let [model_code, eurocode] = [
            StrengthClass::new(4.0, f_r1, f_r3).map(|class| class.to_string()),
            EurocodeClass::new(f_r1, f_r3).map(|class| class.to_string()),
        ];
        (model_code.unwrap_or_default(), eurocode.unwrap_or_default())
    };
    let of = |model_code: &str, eurocode: &str| (model_code.to_owned(), eurocode.to_owned());
    assert_eq!(classes(3.2, 2.5), of("3b", "3.0b"));
    assert_eq!(classes(3.7, 3.4), of("3c", "3.5c"));
    // 1.66/3.4 is below 0.5, 1.66/3 is not
    assert_eq!(classes(3.4, 1.66), of("", "3.0a"));
    // 0.7 · 4.5 = 3.15 is 3.2 in the table
    assert_eq!(classes(4.5, 3.16), of("4b", "4.5a"));
    assert_eq!(classes(4.5, 3.2), of("4b", "4.5b"));
    // below 3.5a, which wants 1.8
    assert_eq!(classes(3.6, 1.77), of("", "3.0a"));
    assert_eq!(classes(12.0, 14.0), of("8d", "8.0e"));
    assert_eq!(classes(0.9, 0.9), of("", ""));
    assert_eq!(classes(2.0, 0.45), of("", ""));
}

/// A CMOD beyond that of cracking by rounding has its force.
#[test]
fn cracking_is_no_jump() {
    let law = Polyline::new([(0.0, 3.0), (0.1, 1.0), (5.0, 0.5)]);
    let section = [SectionLaw::new(&matrix(), &law, 62.5)];
    let beam = LayeredBeam::new(NotchedBeam::default(), &section, &matrix());
    // 2 f_t s_h a/(E h_sp)
    let cracking = 0.0025_f64;
    let [before, at] = [0.5 * cracking, cracking.next_up()].map(|cmod| beam.at(cmod).force);
    assert_relative_eq!(at, 2.0 * before, max_relative = 1e-7);
    for k in 1..20 {
        let force = beam.at(cracking * (1.0 + 0.001 * f64::from(k))).force;
        assert!(force > at && force < 1.01 * at, "{k}: {force} for {at}");
    }
}

//! An elastic fibre in a rigid matrix against one-dimensional shear lag.

use super::{model, model_of, run, run_to_end};
use end_to_end_tests::analytical::pull_out::{DroppingBond, Fibre};
use end_to_end_tests::worst;
use serde_json::{Value, json};

/// The specimen of the cases.
const FIBRE: Fibre = Fibre { diameter: 0.406, modulus: 210e3, length: 12.2 };

#[test]
fn the_linear_bond_gives_the_load_of_shear_lag() {
    /// k, MPa/mm.
    const STIFFNESS: f64 = 40.0;
    let mut errors = Vec::new();
    for elements in [1, 2, 8] {
        let model = model("fibre-elastic-bond", &[&format!("mesh.specimen.embedded_elements={elements}")]);
        let mut error = [f64::NAN; 2];
        run_to_end(&model, |record, _| {
            let load = FIBRE.elastic_load(STIFFNESS, record.slip_exit);
            let tail = FIBRE.elastic_tail_slip(STIFFNESS, record.slip_exit);
            error = [(record.load / load - 1.0).abs(), (record.slip_tail / tail - 1.0).abs()];
        });
        println!("{elements} elements: load {:.2e}, tail {:.2e}", error[0], error[1]);
        errors.push(error[0]);
    }
    // what is left is that real sections do not stay quite plane
    let changes = [(errors[0] - errors[1]).abs(), (errors[1] - errors[2]).abs()];
    assert!(errors[2] < 1e-3 && changes[1] < changes[0], "{errors:?}");
}

#[test]
fn the_dropping_bond_is_followed_through_the_snap_back() {
    let bond = DroppingBond { stiffness: 200.0, strength: 2.0, friction: 1.6 };
    let model = model("fibre-dropping-bond", &[]);
    let (peak, peak_slip) = FIBRE.debonding(&bond, FIBRE.debonded_at_peak(&bond));
    let branch: Vec<(f64, f64)> =
        (0..=4000).map(|k| FIBRE.debonding(&bond, FIBRE.length * f64::from(k) / 4000.0)).collect();
    let turning_slip = branch.iter().map(|(_, u)| *u).fold(0.0, f64::max);
    // distances from the branch, relative to the peak; slips that turn back
    let (mut worst, mut debonded, mut turned, mut last) = (0.0_f64, 0, 0, 0.0);
    let mut greatest = 0.0_f64;
    let end = run(&model, |record, _| {
        greatest = greatest.max(record.load);
        let (load, slip) = (record.load / peak, record.slip_exit / peak_slip);
        let distance = branch.iter().map(|(p, u)| (p / peak - load).abs().max((u / peak_slip - slip).abs()));
        let off = distance.fold(f64::INFINITY, f64::min);
        // elastic before, friction alone afterwards
        let elastic = FIBRE.elastic_load(bond.stiffness, record.slip_exit) / peak;
        let is_debonding = slip > branch[0].1 / peak_slip && record.slip_tail < bond.strength / bond.stiffness;
        if is_debonding {
            turned += u32::from(record.slip_exit < last);
            worst = worst.max(off);
            debonded += 1;
        } else if record.load > 0.0 && (debonded == 0 || record.slip_exit > turning_slip) {
            // friction that slid back is on its unloading line until the slip is what it was
            let friction = FIBRE.friction_load(bond.friction, record.slip_tail) / peak;
            worst = worst.max((elastic - load).abs().min((friction - load).abs()));
        }
        last = record.slip_exit;
    });
    println!(
        "peak {greatest:.4} for {peak:.4} N; {debonded} on the branch, off by {worst:.2e}; turned {turned}; {end:?}"
    );
    end.unwrap();
    assert!(turned > 0 && debonded > 50, "no snap-back was followed");
    assert!((greatest / peak - 1.0).abs() < 5e-3, "peak {greatest} for {peak}");
    // each of the 160 points makes a tooth as it breaks
    assert!(worst < 5e-3, "{worst:.2e} off the branch");
}

#[test]
fn the_full_pull_out_ends_at_nothing() {
    const FRICTION: f64 = 1.0;
    let model = model("fibre-full-pull-out", &[]);
    let full = FIBRE.friction_load(FRICTION, 0.0);
    let (mut worst, mut rise, mut peak, mut lowest, mut last) = (0.0_f64, 0.0_f64, 0.0, f64::INFINITY, f64::NAN);
    let mut outputs = 0;
    run_to_end(&model, |record, _| {
        if record.load > peak {
            (peak, lowest) = (record.load, record.load);
        }
        lowest = record.load.min(lowest);
        rise = rise.max(record.load - lowest);
        // before the tail has slid the bond is not yet exhausted
        if record.slip_tail > 2.0 * FRICTION / 1000.0 {
            let off = (record.load - FIBRE.friction_load(FRICTION, record.slip_tail)).abs() / full;
            worst = worst.max(off);
            outputs += 1;
        }
        last = record.load;
    });
    println!("{outputs} outputs: off by {worst:.2e}, rises by {:.2e}, ends at {last:.2e} N", rise / peak);
    assert!(outputs >= 400);
    assert!(worst < 5e-3, "{worst:.2e}");
    assert!(rise < 5e-4 * peak, "{:.2e}", rise / peak);
    approx::assert_abs_diff_eq!(last, 0.0, epsilon = 1e-6 * full);
}

/// The load after a fibre has left its block, relative to the greatest, and the slip there.
fn after_extraction(overrides: &[&str]) -> [f64; 2] {
    let model = model_of("chapter-7", "full-extraction", overrides);
    let (mut greatest, mut last) = (0.0_f64, [f64::NAN; 2]);
    run_to_end(&model, |record, _| {
        greatest = greatest.max(record.load.abs());
        last = [record.load.abs() / greatest, record.slip];
    });
    last
}

/// Checks the end of an inclined fibre, on a coarse mesh: full-extraction-study has it on the usual one.
fn pulled_out_to_the_last(angle: &str) {
    let [load, slip] = after_extraction(&[angle, "mesh.specimen.mesh_size=2"]);
    assert!(load < 1e-9 && slip == 3.2, "{angle}: {load:.1e} at {slip}");
}

#[test]
fn an_inclined_fibre_is_pulled_out_to_the_last() {
    pulled_out_to_the_last("mesh.specimen.angle_deg=30");
}

#[test]
#[ignore = "long: an_inclined_fibre_is_pulled_out_to_the_last at a smaller angle"]
fn a_more_inclined_fibre_is_pulled_out_to_the_last() {
    pulled_out_to_the_last("mesh.specimen.angle_deg=45");
}

/// The end of a fibre snaps out of its hole, and contact has no viscosity that takes it: with stabilisation, too, something else
/// than the drives has to lead.
#[test]
fn a_fibre_snaps_out_of_a_block_that_does_not_crack() {
    let drucker_prager = r#"parts.matrix.material={"plugin": "drucker_prager", "props": {"E": 23700, "nu": 0.15,
        "cohesion": 38.1, "friction_angle_deg": 18.8, "dilation_angle_deg": 18.8, "cone": "abaqus"}}"#;
    let glued = [
        "mesh.specimen.angle_deg=30",
        "mesh.specimen.cover=false",
        "contact.law.props.p_0=1000",
        "controls.relaxation_time=1e-6",
        "steps.0.increments.maximum=0.05",
        drucker_prager,
    ];
    let [load, slip] = after_extraction(&glued);
    assert!(load < 1e-9 && slip == 3.2, "{load:.1e} at {slip}");
}

/// Loads of the pair of chapter 7 at 6 diameters, its bottom held and its sides on rollers, up to where concrete begins to damage.
fn symmetric_loads(overrides: &[&str]) -> Vec<f64> {
    let common = [
        r#"supports={"bottom": {"direction": "y"}, "sides": {"direction": "x"}}"#,
        r#"steps=[{"slip": 0.006, "increments": 12}]"#,
    ];
    let model = model_of("chapter-7", "two-fibres", &[&common, overrides].concat());
    let mut loads = Vec::new();
    run_to_end(&model, |record, _| loads.extend((record.step == 1).then_some(record.load)));
    loads
}

#[test]
fn half_of_a_pair_bears_half_its_load() {
    let fibre = |name: &str, exit: f64| json!({ "name": name, "exit": exit, "path": [{ "straight": 15.2 }] });
    let fibres = |fibres: &[Value]| format!("mesh.specimen.fibres={}", json!(fibres));
    let pair = fibres(&[fibre("left", -1.218), fibre("right", 1.218)]);
    // the plane of symmetry is its right side
    let half = fibres(&[fibre("left", 6.35 - 1.218)]);
    let whole = symmetric_loads(&[&pair]);
    let half = symmetric_loads(&[&half, "mesh.specimen.width=12.7"]);
    let greatest = whole.iter().copied().fold(0.0, f64::max);
    let apart = worst(whole.iter().zip(&half).map(|(whole, half)| (whole - 2.0 * half).abs() / greatest));
    println!("{greatest:.2} N, {apart:.1e} apart");
    assert!(whole.len() == 12 && greatest > 25.0 && apart < 1e-3, "{whole:?} {half:?}");
}

/// A fibre without bond that is pushed into a rigid block stands on the end of its hole: a bar of its whole length.
#[test]
fn a_fibre_that_is_pushed_stands_on_the_end_of_its_hole() {
    const PUSH: f64 = 1e-3;
    const FREE: f64 = 3.0;
    let area = 0.25 * std::f64::consts::PI * FIBRE.diameter * FIBRE.diameter;
    let expected = -FIBRE.modulus * area * PUSH / (FIBRE.length + FREE);
    for (case, specimen) in [
        ("6.14-plane", r#"{"type": "perpendicular_fibre", "free_length": 3}"#),
        ("6.14-axisymmetric", r#"{"type": "perpendicular_fibre", "axisymmetric": true, "free_length": 3}"#),
        (
            "6.14-plane",
            r#"{"type": "fibres", "fibres": [{"name": "a", "embedded": 12.2, "path": [{"straight": 15.2}]}]}"#,
        ),
    ] {
        let model = model_of(
            "chapter-6",
            case,
            &[
                &format!("mesh.specimen={specimen}"),
                r#"parts.fibre.material={"plugin": "linear_elastic", "props": {"E": 210000, "nu": 0}}"#,
                r#"parts.matrix.material={"plugin": "linear_elastic", "props": {"E": 1e10, "nu": 0}}"#,
                r#"contact={"law": {"plugin": "bond_slip", "props": {"law": "none", "normal_law": "hard", "mu": 0, "p_0": 0}}, "end": {}}"#,
                &format!(r#"steps=[{{"slip": {}, "increments": 4}}]"#, -PUSH),
            ],
        );
        let mut load = f64::NAN;
        run_to_end(&model, |record, _| load = record.load);
        println!("{case}: {load:.5} N, {expected:.5} N");
        assert!((load / expected - 1.0).abs() < 2e-3, "{load} N, {expected} N");
    }
}

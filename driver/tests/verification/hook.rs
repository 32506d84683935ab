//! A wire that is drawn through a bent channel.

use super::{model, model_of, run_to_end};

const DIAMETER: f64 = 0.5;
const YIELD_STRESS: f64 = 200.0;
/// Thickness of the same area as the round wire, mm.
const THICKNESS: f64 = 0.25 * std::f64::consts::PI * DIAMETER;
/// M_p = f_y t φ²/4, N mm.
const PLASTIC_MOMENT: f64 = YIELD_STRESS * THICKNESS * DIAMETER * DIAMETER / 4.0;

/// Returns the deviation of a case's load from M_p times a change of curvature, 1/mm, on average from a slip to the
/// end, and at most.
fn off_from_rigid_plastic(case: &str, overrides: &[&str], change_of_curvature: f64, from: f64) -> [f64; 2] {
    let expected = PLASTIC_MOMENT * change_of_curvature;
    let (mut sum, mut length, mut worst, mut last) = (0.0, 0.0, 0.0_f64, [f64::NAN; 2]);
    run_to_end(&model(case, overrides), |record, _| {
        let [slip, load] = last;
        if slip > from {
            sum += 0.5 * (load + record.load) * (record.slip - slip);
            length += record.slip - slip;
            worst = worst.max((record.load / expected - 1.0).abs());
        }
        last = [record.slip, record.load];
    });
    let mean = sum / length / expected - 1.0;
    println!("{case}: over {length:.2} mm {mean:.3} off on average, {worst:.3} at most");
    assert!(length > 0.04);
    [mean.abs(), worst]
}

/// P = M_p ∫|dκ|: two corners of radius ρ, at both ends of which the curvature changes by 1/ρ.
#[test]
fn a_hook_takes_its_plastic_moment_for_each_change_of_curvature() {
    const RADIUS: f64 = 2.5;
    let [mean, worst] = off_from_rigid_plastic("hook", &[], 4.0 / RADIUS, 0.05);
    assert!(mean < 0.02 && worst < 0.05, "{mean:.3}, {worst:.3}");
}

/// A wave a (1 − cos(2πu/λ)): the curvature goes from 0 to a (2π/λ)², to its opposite, back and to 0, and turns three times, where
/// 2 M_p/(E I) of it are elastic.
#[test]
#[ignore = "long: a_hook_takes_its_plastic_moment_for_each_change_of_curvature has the same law"]
fn a_wave_takes_its_plastic_moment_for_each_change_of_curvature() {
    const GREATEST: f64 = 0.2;
    const YOUNGS_MODULUS: f64 = 600e3;
    let bending_stiffness = YOUNGS_MODULUS * THICKNESS * DIAMETER.powi(3) / 12.0;
    let change = 6.0 * GREATEST - 3.0 * 2.0 * PLASTIC_MOMENT / bending_stiffness;
    let coarse = "mesh.specimen.largest_fibre_size=0.6";
    let [mean, worst] = off_from_rigid_plastic("wave", &[coarse], change, 0.06);
    assert!(mean < 0.05 && worst < 0.06, "{mean:.3}, {worst:.3}");
}

/// The first contact with friction opens in the first increment, and the trapezoidal rule misses the same part of its
/// work in an increment of any size.
#[test]
fn a_first_increment_in_which_contact_opens_stands() {
    let overrides = ["contact.law.props.mu=0.2", "steps.0.slip=0.002", "steps.0.increments.initial=0.01"];
    let mut increments = 0;
    run_to_end(&model("hook", &overrides), |_, _| increments += 1);
    assert!(increments > 1);
}

/// An elastic fibre with an enlarged end is drawn through an elastic block without friction. Its surface has kinks, over which normals
/// are smoothed, and an end, past which points fade: the energies balance all the same, the better the smaller the increments are.
#[test]
fn energies_balance_where_an_enlarged_end_leaves_its_place() {
    let model = model_of(
        "chapter-9",
        "paddled",
        &[
            r#"mesh.specimen={"type": "fibres", "width": 12, "depth": 8, "matrix_thickness": 5, "fibres": [{"name": "paddled",
                "diameter": 0.5, "exit": 0, "embedded": 5, "path": [{"straight": 7}], "width_profile": [[0, 0.75], [2, 0.5]]}]}"#,
            r#"parts.matrix.material={"plugin": "linear_elastic", "props": {"E": 23700, "nu": 0.15}}"#,
            r#"parts.fibre.material={"plugin": "linear_elastic", "props": {"E": 210000, "nu": 0.3}}"#,
            r#"contact.law.props.law="none""#,
            "contact.law.props.mu=0",
            "contact.law.props.p_0=0",
            r#"steps=[{"slip": 0.3, "increments": 100}]"#,
        ],
    );
    let mut greatest = 0.0_f64;
    run_to_end(&model, |record, _| {
        // the end is seated
        if record.slip > 0.02 {
            greatest = greatest.max(record.energy_error.abs());
        }
    });
    println!("{greatest:.1e}");
    assert!(greatest < 1e-3, "{greatest:e}");
}

//! A UMAT that takes its strain from DFGRD1.

use super::{built, close, point, run};
use crate::program::Desk;
use serde_json::json;

#[test]
fn neo_hooke_from_the_deformation_gradient() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    let (mu, kappa) = (80.0, 500.0);
    let material = json!({ "plugin": library, "props": [mu, kappa], "nstatv": 0 });
    let at = |f: [[f64; 3]; 3], name: &str| {
        let mut case = point(material.clone(), "3d", json!([{ "increments": 5, "F": f }]));
        case["nlgeom"] = json!(true);
        run(&desk, name, &case).history
    };
    // simple shear: s12 = μγ, s11 − s22 = μγ², trace 0
    let gamma = 0.8;
    let shear = at([[1.0, gamma, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "shear");
    close(shear.last("s12"), mu * gamma);
    close(shear.last("s11") - shear.last("s22"), mu * gamma * gamma);
    close(shear.last("s11") + shear.last("s22") + shear.last("s33"), 0.0);
    // volume change alone
    let swollen = at([[1.1, 0.0, 0.0], [0.0, 1.1, 0.0], [0.0, 0.0, 1.1]], "swollen");
    close(swollen.last("s11"), kappa * (1.1_f64.powi(3) - 1.0));
    close(swollen.last("s12"), 0.0);
    // a stretch λ along 1 turned by 30°: σ turned likewise
    let (lambda, angle) = (1.3_f64, 30.0_f64.to_radians());
    let (sine, cosine) = angle.sin_cos();
    let turned = at([[cosine * lambda, -sine, 0.0], [sine * lambda, cosine, 0.0], [0.0, 0.0, 1.0]], "turned");
    let deviator = mu * lambda.powf(-5.0 / 3.0) * (lambda * lambda - 1.0) / 3.0;
    let mean = kappa * (lambda - 1.0);
    let (along, across) = (mean + 2.0 * deviator, mean - deviator);
    close(turned.last("s11"), along * cosine * cosine + across * sine * sine);
    close(turned.last("s22"), along * sine * sine + across * cosine * cosine);
    close(turned.last("s12"), (along - across) * sine * cosine);
    close(turned.last("s33"), across);
}

/// Hypoelastic stress of a UMAT that adds C : DSTRAN: the host turns STRESS by DROT, which makes it Jaumann's rate.
#[test]
fn jaumann_elasticity_in_simple_shear() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let (modulus, nu, gamma) = (100.0, 0.25, 2.0_f64);
    let shear_modulus = modulus / (2.0 * (1.0 + nu));
    let material = json!({ "plugin": library, "props": [modulus, nu], "nstatv": 1 });
    let found = |increments: u32| {
        let f = [[1.0, gamma, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut case = point(material.clone(), "3d", json!([{ "increments": increments, "F": f }]));
        case["nlgeom"] = json!(true);
        let history = run(&desk, "shear", &case).history;
        ["s12", "s11", "s22"].map(|name| history.last(name) / shear_modulus)
    };
    // s12 = G sin γ, s11 = −s22 = G (1 − cos γ)
    let exact = [gamma.sin(), 1.0 - gamma.cos(), gamma.cos() - 1.0];
    let error = |found: &[f64; 3]| exact.iter().zip(found).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
    let (coarse, fine) = (found(200), found(400));
    // DSTRAN is that of the middle of the increment and not turned to its end, as ABAQUS has it: first order
    let order = (error(&coarse) / error(&fine)).log2();
    assert!((order - 1.0).abs() < 0.02, "order {order}");
    assert!(error(&fine) < 4e-3, "{:e}", error(&fine));
    let limit: [f64; 3] = std::array::from_fn(|k| 2.0 * fine[k] - coarse[k]);
    assert!(error(&limit) < 2e-5, "{:e}", error(&limit));
}

/// A stretched point that turns as a rigid body: stress and STRAN turn with it, to rounding, however large the turns.
#[test]
fn a_rigid_rotation_turns_the_stress_exactly() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [100.0, 0.25], "nstatv": 1 });
    let stretch = [1.2, 0.9, 1.0];
    let turned = |angle: f64| {
        let (sine, cosine) = angle.to_radians().sin_cos();
        [
            [cosine * stretch[0], -sine * stretch[1], 0.0],
            [sine * stretch[0], cosine * stretch[1], 0.0],
            [0.0, 0.0, stretch[2]],
        ]
    };
    let angles = [0.0, 20.0, 75.0, 160.0, 270.0];
    let steps: Vec<_> = angles.iter().map(|angle| json!({ "increments": 1, "F": turned(*angle) })).collect();
    let mut case = point(material, "3d", json!(steps));
    case["nlgeom"] = json!(true);
    let history = run(&desk, "turned", &case).history;
    let row = |name: &str, k: usize| history.column(name)[k];
    for (number, angle) in angles.iter().enumerate() {
        let (k, (sine, cosine)) = (number + 1, angle.to_radians().sin_cos());
        for (names, share) in [(["s11", "s22", "s12"], 1.0), (["e11", "e22", "g12"], 0.5)] {
            let [along, across, _] = names.map(|name| row(name, 1));
            close(row(names[0], k), along * cosine * cosine + across * sine * sine);
            close(row(names[1], k), along * sine * sine + across * cosine * cosine);
            close(share * row(names[2], k), (along - across) * sine * cosine);
        }
    }
}

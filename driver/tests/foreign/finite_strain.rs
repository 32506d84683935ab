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

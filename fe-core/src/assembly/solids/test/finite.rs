//! Large displacements against closed forms.

use super::*;
use crate::kinematics::finite::rotated;

/// A stressed body spun in steps of 20°: its stress turns along, nothing works.
#[test]
fn rigid_spin_turns_the_stress_and_does_no_work() {
    for law in [linear_elastic(), j2_plasticity()] {
        for variant in Variant::ALL {
            for plane_model in [PlaneModel::PlaneStress, PlaneModel::PlaneStrain] {
                spin(&law, variant, plane_model);
            }
        }
    }
}

fn spin(law: &PluginLaw, variant: Variant, plane_model: PlaneModel) {
    let model = model(patch(variant, plane_model, 0.1, 0.03), law, variant.average, true);
    let mut solids = Solids::new(&model).unwrap();
    let at =
        |angle: f64| moved(&model.mesh, |[x, y]| turned([1.02 * x + 0.01 * y + x * y, 0.995 * y + 0.3 * x * x], angle));
    let mut before = at(0.0);
    let mut force_before = forces(&mut solids, &before, Request::Stress);
    solids.commit(&before);
    let stress_at_start = solids.point(1, 0).stress;
    let energy = solids.energies();
    let (mut work, scale) = (0.0, largest(&force_before) * 0.24);
    for step in 1..=36 {
        let angle = f64::from(step) * 20.0_f64.to_radians();
        let now = at(angle);
        let force = forces(&mut solids, &now, Request::Stress);
        solids.commit(&now);
        for freedom in 0..now.len() {
            work += 0.5 * (force[freedom] + force_before[freedom]) * (now[freedom] - before[freedom]);
        }
        let expected = rotated(&stress_at_start, (angle.cos(), angle.sin()), 1.0);
        for (found, expected) in solids.point(1, 0).stress.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-8 * largest(&stress_at_start), "{} {variant:?}", law.name);
        }
        (before, force_before) = (now, force);
    }
    assert!(work.abs() < 1e-8 * scale, "{work:e} {scale:e}");
    let after = solids.energies();
    assert!((after.stored - energy.stored).abs() < 1e-8 * energy.stored);
    assert!((after.plastic - energy.plastic).abs() <= 1e-8 * energy.plastic);
}

/// Simple shear of an elastic body in equal increments of Δγ. Each adds μΔγ to the shear and turns what is there by φ,
/// tan ½φ = −¼Δγ: σ₁₂ = μΔγ Σ cos 2kφ, σ₁₁ = −σ₂₂ = −μΔγ Σ sin 2kφ. With small increments that is the Jaumann rate's
/// σ₁₂ = μ sin γ, σ₁₁ = −σ₂₂ = μ (1 − cos γ) (Dienes 1979), to first order: the midpoint strain is not turned by ½φ.
#[test]
fn simple_shear_converges_to_the_jaumann_rate() {
    let (amount, shear_modulus) = (2.0_f64, 1000.0 / 2.6);
    let mesh = patch(Variant::new(ElementKind::Q4), PlaneModel::PlaneStrain, 0.1, 0.0);
    let largest_difference = |stress: &[f64; 4], normal: f64, shear: f64| {
        let expected = [normal, -normal, 0.0, shear];
        let differences: Vec<f64> = stress.iter().zip(expected).map(|(a, b)| a - b).collect();
        largest(&differences) / shear_modulus
    };
    let error = |increments: u32| {
        let mut solids = Solids::new(&model(mesh.clone(), &linear_elastic(), false, true)).unwrap();
        for increment in 1..=increments {
            let shear = amount * f64::from(increment) / f64::from(increments);
            advance(&mut solids, &moved(&mesh, |[x, y]| [x + shear * y, y]));
        }
        let stress = solids.point(2, 1).stress;
        let share = amount / f64::from(increments);
        let angle = -2.0 * (0.25 * share).atan();
        let sum = |wave: fn(f64) -> f64| share * (0..increments).map(|k| wave(2.0 * f64::from(k) * angle)).sum::<f64>();
        let incremental = [-shear_modulus * sum(f64::sin), shear_modulus * sum(f64::cos)];
        assert!(largest_difference(&stress, incremental[0], incremental[1]) < 1e-11);
        largest_difference(&stress, shear_modulus * (1.0 - amount.cos()), shear_modulus * amount.sin())
    };
    let errors = [25, 50, 100, 200, 400].map(error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.05, "first order: {errors:?}");
    }
    assert!(errors[4] < 4e-3);
}

/// Stretch along one axis in many increments: the strain is the logarithm.
#[test]
fn strain_of_a_stretch_converges_to_the_logarithm() {
    let mesh = patch(Variant::new(ElementKind::T6), PlaneModel::PlaneStrain, 0.1, 0.03);
    let mut solids = Solids::new(&model(mesh.clone(), &linear_elastic(), false, true)).unwrap();
    for increment in 1..=100 {
        let stretch = 1.0 + 0.01 * f64::from(increment);
        advance(&mut solids, &moved(&mesh, |[x, y]| [stretch * x, y]));
    }
    let strain = solids.point(4, 1).strain;
    assert!((strain[0] - 2.0_f64.ln()).abs() < 1e-5 && largest(&strain[1..]) < 1e-14, "{strain:?}");
}

/// Uniaxial stress in plane stress: σ = E ln λ acts on the present section, A₀ λ^(−2ν).
#[test]
fn a_plate_that_is_stretched_becomes_thinner() {
    let (modulus, poisson, stretch) = (1000.0, 0.3, 1.2_f64);
    let [length, width] = [2.0, 1.0];
    let corners = vec![[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]];
    let element = ElementDefinition { kind: ElementKind::Q4, part: 0, nodes: vec![0, 1, 2, 3] };
    let mesh = mesh(corners, Variant::new(ElementKind::Q4), PlaneModel::PlaneStress, vec![element]);
    let errors = [50, 100].map(|increments| {
        let mut solids = Solids::new(&model(mesh.clone(), &linear_elastic(), false, true)).unwrap();
        let mut force = Vec::new();
        for increment in 1..=increments {
            let along = stretch.powf(f64::from(increment) / f64::from(increments));
            let across = along.powf(-poisson);
            let end = moved(&mesh, |[x, y]| [along * x, across * y]);
            force = forces(&mut solids, &end, Request::Stress);
            solids.commit(&end);
        }
        let section = mesh.parts()[0].thickness * width;
        let expected = modulus * stretch.ln() * section * stretch.powf(-2.0 * poisson);
        // the nodes of the right edge
        ((force[2] + force[4]) / expected - 1.0).abs()
    });
    assert!(errors[1] < 1e-4 && (errors[0] / errors[1] - 4.0).abs() < 0.2, "{errors:?}");
}

/// Small displacements of an unstressed body: both kinematics agree to first order.
#[test]
fn tends_to_small_strains() {
    for variant in Variant::ALL {
        for plane_model in PlaneModel::ALL {
            let mesh = patch(variant, plane_model, 0.1, 0.03);
            let displacements = moved(&mesh, |[x, y]| [x + 1e-9 * (x * x + y), y + 1e-9 * (x * y - 3.0 * y)]);
            let [small, large] = [false, true].map(|nlgeom| {
                let mut solids = Solids::new(&model(mesh.clone(), &linear_elastic(), variant.average, nlgeom)).unwrap();
                let found = forces(&mut solids, &displacements, Request::StressAndTangent);
                (found, solids.stiffness(2).to_vec())
            });
            for (small, large) in [(&small.0, &large.0), (&small.1, &large.1)] {
                let difference: Vec<f64> = small.iter().zip(large).map(|(a, b)| a - b).collect();
                assert!(largest(&difference) < 1e-7 * largest(small), "{variant:?} {plane_model:?}");
            }
        }
    }
}

#[test]
fn a_collapsing_element_is_named() {
    let mesh = patch(Variant::new(ElementKind::Q4), PlaneModel::PlaneStrain, 0.1, 0.0);
    let mut solids = Solids::new(&model(mesh.clone(), &linear_elastic(), false, true)).unwrap();
    for (stretch, reason) in [(0.19, "the volume ratio (det F) is 0.1900, less than 0.2"), (-0.5, "must be positive")] {
        let displacements = moved(&mesh, |[x, y]| [stretch * x, y]);
        let mut forces = vec![0.0; displacements.len()];
        let trouble = solids.evaluate(&displacements, &CONTEXT, Request::Stress, &mut forces).unwrap_err();
        assert!(trouble.to_string().starts_with("element 1, integration point 1 at ("), "{trouble}");
        assert!(trouble.reason.contains(reason), "{trouble}");
        assert_eq!(trouble.fraction, Some(0.5));
    }
    // It goes on from where it was.
    let stretched = moved(&mesh, |[x, y]| [1.1 * x, y]);
    advance(&mut solids, &stretched);
    assert!((solids.point(0, 0).strain[0] - 2.0 * 0.1 / 2.1).abs() < 1e-14);
}

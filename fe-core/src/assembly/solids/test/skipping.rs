//! Skipped elements change no bit of the results, and changes are not skipped.

use super::*;

/// Bends the patch so that some elements yield and others do not.
fn bent(mesh: &Mesh, size: f64) -> Vec<f64> {
    moved(mesh, |[x, y]| [x + size * (x - 0.1) * (x - 0.1), y + 0.1 * size * x * y])
}

#[test]
fn skipping_is_exact_to_the_last_bit() {
    for nlgeom in [false, true] {
        let mesh = patch(Variant::new(ElementKind::Q8), PlaneModel::PlaneStrain, 0.1, 0.03);
        let mut model = model(mesh, &j2_plasticity(), false, nlgeom);
        let mut skipping = Solids::new(&model).unwrap();
        model.skipping = Skipping::NONE;
        let mut plain = Solids::new(&model).unwrap();
        let path = [0.01, 0.01, 0.03, 0.05, 0.05, 0.04, 0.06];
        for (increment, size) in path.into_iter().enumerate() {
            let displacements = bent(&model.mesh, size);
            for request in [Request::Stress, Request::StressAndTangent, Request::StressAndTangent, Request::Stress] {
                let found = [&mut skipping, &mut plain].map(|solids| forces(solids, &displacements, request));
                assert!(same_bits(&found[0], &found[1]), "increment {increment}");
            }
            for element in 0..model.mesh.elements().len() {
                assert!(same_bits(skipping.stiffness(element), plain.stiffness(element)), "increment {increment}");
            }
            skipping.commit(&displacements);
            plain.commit(&displacements);
        }
        assert_eq!(skipping.energies(), plain.energies());
        assert!(skipping.counts().plastic > 0);
        let (less, more) = (skipping.counters(), plain.counters());
        assert_eq!(more.skipped_evaluations, 0);
        assert_eq!(less.evaluations + less.skipped_evaluations, more.evaluations);
        assert_eq!(less.skipped_evaluations, 2 * 5 * path.len() as u64, "the third and the fourth request");
        assert!(less.umat_calls < more.umat_calls && less.stiffness_builds < more.stiffness_builds);
    }
}

/// The elements whose stiffness was built after the latest version was `version`, ascending.
fn changed_since(solids: &Solids, version: u64) -> impl Iterator<Item = usize> {
    (0..solids.places.len()).filter(move |&element| solids.stiffness_version(element) > version)
}

#[test]
fn only_stiffnesses_with_other_moduli_are_built_again() {
    let mesh = patch(Variant::new(ElementKind::Q8), PlaneModel::PlaneStrain, 0.1, 0.03);
    let mut solids = Solids::new(&model(mesh.clone(), &j2_plasticity(), false, false)).unwrap();
    let count = mesh.elements().len();
    forces(&mut solids, &bent(&mesh, 0.0), Request::StressAndTangent);
    assert_eq!(changed_since(&solids, 0).count(), count);
    let version = solids.latest_version();
    forces(&mut solids, &bent(&mesh, 0.001), Request::StressAndTangent);
    assert_eq!(changed_since(&solids, version).count(), 0, "all elastic");
    forces(&mut solids, &bent(&mesh, 0.04), Request::StressAndTangent);
    solids.commit(&bent(&mesh, 0.04));
    let changed: Vec<usize> = changed_since(&solids, version).collect();
    assert!(!changed.is_empty() && changed.len() < count, "{changed:?}");
    for element in 0..count {
        let yielded = (0..solids.point_count(element)).any(|point| solids.point(element, point).energies[1] > 0.0);
        assert_eq!(changed.contains(&element), yielded);
        assert_eq!(solids.stiffness_version(element) > version, yielded);
    }
}

#[test]
fn nothing_is_committed_before_commit() {
    let mesh = patch(Variant::new(ElementKind::T6), PlaneModel::PlaneStress, 0.1, 0.03);
    for nlgeom in [false, true] {
        let model = model(mesh.clone(), &j2_plasticity(), false, nlgeom);
        let [mut direct, mut detour] = [(); 2].map(|()| Solids::new(&model).unwrap());
        for solids in [&mut direct, &mut detour] {
            advance(solids, &bent(&mesh, 0.03));
        }
        forces(&mut detour, &bent(&mesh, 0.2), Request::StressAndTangent);
        detour.restore();
        forces(&mut detour, &bent(&mesh, -0.1), Request::Stress);
        let found = [&mut direct, &mut detour].map(|solids| forces(solids, &bent(&mesh, 0.05), Request::Stress));
        assert_eq!(found[0], found[1]);
    }
}

#[test]
fn elements_that_are_not_active_give_no_forces_and_catch_up() {
    let mesh = patch(Variant::new(ElementKind::Q8), PlaneModel::PlaneStrain, 0.1, 0.03);
    let model = model(mesh.clone(), &linear_elastic(), false, false);
    let [mut all, mut some] = [(); 2].map(|()| Solids::new(&model).unwrap());
    some.set_active(&[true, true, false, true, true]);
    let last = mesh.elements().len() - 1;
    advance(&mut all, &bent(&mesh, 0.01));
    let partial = forces(&mut some, &bent(&mesh, 0.01), Request::Stress);
    some.commit(&bent(&mesh, 0.01));
    assert_eq!(all.point(last, 0), some.point(last, 0));
    assert_eq!(some.point(2, 0).stress, [0.0; 4]);
    let corner = mesh.elements()[2].nodes().iter().find(|&&node| mesh.nodes()[node] == [0.1 + 0.24, 0.12]);
    assert!(corner.is_some() && largest(&partial) > 0.0);
    some.set_active(&[true; 5]);
    let found = [&mut all, &mut some].map(|solids| forces(solids, &bent(&mesh, 0.02), Request::Stress));
    let difference: Vec<f64> = found[0].iter().zip(&found[1]).map(|(a, b)| a - b).collect();
    assert!(largest(&difference) < 1e-14 * largest(&found[0]));
}

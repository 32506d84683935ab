//! A stressed body that turns as one: its stress turns with it, and nothing does work.

use super::patch::{Looking, Matrix, errors, patch, step_to};
use super::*;
use end_to_end_tests::rotated_in_plane;

/// Turn in each step, degrees.
const TURN: f64 = 5.0;
/// Steps of a whole turn.
const STEPS: u32 = 72;
/// Relative to the stress, and to the energy stored.
const EXACT: f64 = 1e-8;

/// R F.
fn turned([[a, b], [c, d]]: Matrix, angle: f64) -> Matrix {
    let (sine, cosine) = angle.sin_cos();
    [[cosine * a - sine * c, cosine * b - sine * d], [sine * a + cosine * c, sine * b + cosine * d]]
}

/// Stretches to `first`, then to `stretch`, and turns by 360°.
fn whole_turn(kind: ElementKind, plane: PlaneModel, law: PluginLaw, [first, stretch]: [Matrix; 2]) {
    let angle = |step: u32| f64::from(step - 2) * TURN.to_radians();
    let mut model = patch(kind, plane, law);
    model.nlgeom.fill(true);
    model.steps = vec![step_to(&model, first, 2), step_to(&model, stretch, 1)];
    let steps = (3..=STEPS + 2).map(|step| step_to(&model, turned(stretch, angle(step)), 1));
    let steps: Vec<_> = steps.collect();
    model.steps.extend(steps);
    let mut start: Option<([f64; 4], Energies)> = None;
    let mut seen = 0;
    let look = |record: &Record, snapshot: &Snapshot<'_>| {
        if record.step == 2 {
            start = Some((snapshot.solids().point(0, 0).stress, record.energies));
        }
        let Some((stress, energies)) = start.filter(|_| record.step > 2) else { return };
        let turn = angle(record.step);
        let [displacement, stress] = errors(snapshot, turned(stretch, turn), rotated_in_plane(stress, turn, 1.0));
        let work = (record.energies.external_work - energies.external_work).abs() / energies.external_work;
        let spent = (record.energies.plastic - energies.plastic).abs() / energies.external_work;
        let place = format!("{kind:?} {plane:?} step {}", record.step);
        assert!(displacement < EXACT && stress < EXACT, "{place}: {displacement:.1e} {stress:.1e}");
        assert!(work < EXACT && spent < EXACT, "{place}: work {work:.1e}, dissipation {spent:.1e}");
        seen += 1;
    };
    Analysis::new(&model).unwrap().run(&mut Looking(look)).unwrap();
    assert_eq!(seen, STEPS);
}

#[test]
fn a_stressed_elastic_body_turns_without_work() {
    let stretch = [[1.02, 0.01], [0.01, 0.99]];
    for kind in [ElementKind::T3, ElementKind::T6, ElementKind::Q4, ElementKind::Q8] {
        for plane in [PlaneModel::PlaneStress, PlaneModel::PlaneStrain] {
            let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
            whole_turn(kind, plane, law, [stretch, stretch]);
        }
    }
}

#[test]
fn a_body_that_has_yielded_turns_with_its_plastic_strain() {
    for plane in [PlaneModel::PlaneStress, PlaneModel::PlaneStrain] {
        let law = PluginLaw::shipped("j2_plasticity", &[("E", 1000.0), ("nu", 0.3)]);
        let law = law.followed_by(&[10.0, 0.0, 110.0, 1.0]);
        // a little back, so that rounding does not decide between elastic and plastic tangents
        let [first, stretch] = [[[1.02, 0.01], [0.01, 0.99]], [[1.019, 0.0095], [0.0095, 0.9905]]];
        whole_turn(ElementKind::Q8, plane, law, [first, stretch]);
    }
}

//! Isotropy: a rotated path gives rotated stresses. And DROT: what turns with the material.

use super::random::Random;
use super::report::{Ledger, Verdict};
use super::sample::{SampledState, step_to, target};
use super::subject::{CheckedEntryPoint, Committed, INSTANT, Subject, distance, largest};
use super::tolerances;
use nalgebra::Matrix3;
use pullout_run::deformation;
use umat_abi::host::Alteration;
use umat_abi::law::StressState;
use umat_abi::metadata::flags;

/// Inputs (or outputs) in the rotated frame. Slips turn in the plane of the interface; a single one changes sign.
fn rotated(entry: CheckedEntryPoint, values: &[f64], rotation: &Matrix3<f64>, shear: f64) -> Vec<f64> {
    let turn = |first: usize| {
        let mut values = values.to_vec();
        let (a, b) = (values[first], values[first + 1]);
        values[first] = rotation[(0, 0)] * a + rotation[(0, 1)] * b;
        values[first + 1] = rotation[(1, 0)] * a + rotation[(1, 1)] * b;
        values
    };
    let flip = |k: usize| {
        let mut values = values.to_vec();
        values[k] = -values[k];
        values
    };
    match entry {
        CheckedEntryPoint::Umat(_) => entry.of_six(&deformation::rotated(&entry.six(values), rotation, shear)),
        CheckedEntryPoint::Uinter(3) => turn(1),
        CheckedEntryPoint::Fric(2) => turn(0),
        CheckedEntryPoint::Uinter(_) => flip(1),
        CheckedEntryPoint::Fric(_) => flip(0),
    }
}

/// An anisotropy that no iteration and no rounding makes.
const CLEAR: f64 = 1e-3;

fn random_rotation(subject: &Subject<'_>, random: &mut Random) -> Matrix3<f64> {
    random.rotation(subject.entry != CheckedEntryPoint::Umat(StressState::ThreeD))
}

/// The largest difference, relative to the largest stress and a floor for the rounding of the elastic stress.
fn relative_error(subject: &Subject<'_>, input: &[f64], output: &[f64], expected: &[f64]) -> f64 {
    let floor = tolerances::CANCELLATION / tolerances::ROTATION * subject.elastic_size(input);
    distance(output, expected) / (largest(expected) + floor).max(f64::MIN_POSITIVE)
}

/// Random paths of three legs, and the same rotated. Where isotropy is not claimed the result is only reported; a law
/// that is isotropic as long as it is elastic and not beyond has axes, or takes shear strains for something else.
pub(super) fn check(subject: &mut Subject<'_>, paths: usize, ledger: &mut Ledger<'_>) {
    ledger.begin("isotropy");
    let claimed = subject.claims(flags::ISOTROPIC);
    if !claimed && (subject.described() || subject.finite) {
        return ledger.skip("not claimed");
    }
    if matches!(subject.entry, CheckedEntryPoint::Umat(StressState::OneD | StressState::Beam)) {
        return ledger.skip("the stresses of a line do not turn");
    }
    let mut random = Random::of_check(0x707);
    let entry = subject.entry;
    let start = if claimed { subject.blank() } else { subject.virgin() };
    let (mut worst, mut elastic, mut refused, mut why) = (0.0_f64, 0.0_f64, 0, String::new());
    for _ in 0..paths {
        let rotation = random_rotation(subject, &mut random);
        let (mut point, mut turned) = (start.clone(), start.clone());
        for leg in 0..3 {
            let end = target(subject, &mut random);
            let (step, turned_step) = (step_to(&point, &end), step_to(&turned, &rotated(entry, &end, &rotation, 2.0)));
            if leg == 0 && !claimed {
                elastic = elastic.max(elastic_anisotropy(subject, &start, &step, &rotation).unwrap_or(f64::INFINITY));
            }
            let ends = (subject.after(&point, &step), subject.after(&turned, &turned_step));
            (point, turned) = match ends {
                (Ok(point), Ok(turned)) => (point, turned),
                (Err(trouble), _) | (_, Err(trouble)) => {
                    refused += 1;
                    why = trouble.to_string();
                    break;
                }
            };
            let expected = rotated(entry, &point.output, &rotation, 1.0);
            worst = worst.max(relative_error(subject, &end, &turned.output, &expected));
        }
    }
    let (verdict, mut detail) = match (claimed, worst <= tolerances::ROTATION) {
        (true, true) => (Verdict::Pass, String::new()),
        (true, false) => (Verdict::Fail, String::new()),
        (false, true) => (Verdict::Info, "isotropic, though not claimed".to_owned()),
        (false, false) if worst > CLEAR && elastic <= tolerances::ROTATION.sqrt() => {
            let words =
                "isotropic while it is elastic and not beyond: a law with axes, or shear strains halved or doubled";
            (Verdict::Warn, words.to_owned())
        }
        (false, false) => (Verdict::Info, "not claimed".to_owned()),
    };
    if refused > 0 {
        let space = if detail.is_empty() { "" } else { "; " };
        detail += &format!("{space}{refused} paths cut short: {why}");
    }
    ledger.add(verdict, format!("{worst:.1e}"), detail);
}

/// Returns how far a small first step and the same rotated differ, relative to the stress that it adds.
fn elastic_anisotropy(
    subject: &mut Subject<'_>,
    start: &Committed,
    step: &[f64],
    rotation: &Matrix3<f64>,
) -> Option<f64> {
    const SMALL: f64 = 1e-4;
    let step: Vec<f64> = step.iter().map(|d| SMALL * d).collect();
    let entry = subject.entry;
    let mut added = |step: &[f64]| {
        let answer = subject.evaluate(start, step).ok()?;
        Some(answer.output.iter().zip(&start.output).map(|(end, begin)| end - begin).collect::<Vec<f64>>())
    };
    let (straight, turned) = (added(&step)?, added(&rotated(entry, &step, rotation, 2.0))?);
    let size = largest(&straight).max(f64::MIN_POSITIVE);
    Some(distance(&turned, &rotated(entry, &straight, rotation, 1.0)) / size)
}

/// DROT: the host has turned stress and strain; states that are tensors turn in the plugin, scalars do not.
pub(super) fn incremental_rotation(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("DROT");
    if !matches!(subject.entry, CheckedEntryPoint::Umat(_)) {
        return;
    }
    if !subject.described() {
        return ledger.skip("no metadata: which states are tensors is unknown");
    }
    let mut random = Random::of_check(0xD407);
    let identity = subject.rotation;
    let mut worst = (0.0_f64, 0);
    for state in sample {
        let rotation = random_rotation(subject, &mut random);
        let mut from = state.from.clone();
        from.input = rotated(subject.entry, &from.input, &rotation, 2.0);
        from.output = rotated(subject.entry, &from.output, &rotation, 1.0);
        let step = rotated(subject.entry, &state.step, &rotation, 2.0);
        let mut turned_before = from.clone();
        turned_before.statev = rotated_states(subject, &from.statev, &rotation);
        let expected = subject.call(&turned_before, &step, 0.0, Alteration::None);
        subject.rotation = deformation::columns(&rotation);
        let found = subject.call(&from, &step, 0.0, Alteration::None);
        subject.rotation = identity;
        let end: Vec<f64> = from.input.iter().zip(&step).map(|(x, d)| x + d).collect();
        let error = relative_error(subject, &end, &found.output, &expected.output)
            .max(distance(&found.statev, &expected.statev) / largest(&expected.statev).max(f64::MIN_POSITIVE));
        if error > worst.0 || error.is_nan() {
            worst = (error, state.number);
        }
    }
    let verdict = if worst.0 <= tolerances::ROTATION { Verdict::Pass } else { Verdict::Fail };
    ledger.add(verdict, format!("{:.1e}", worst.0), "stress and states against states turned before");
}

/// NLGEOM: a point that turns as a rigid body, F₁ = Q F₀, and is then strained answers like one that does not turn, turned. A plain
/// law with axes does not, unless a host gives it strains along them, as *ORIENTATION does: a warning, if it takes its strains from
/// the host and not from DFGRD1.
pub(super) fn objectivity(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("objectivity");
    const STATES: usize = 100;
    if !subject.finite {
        return;
    }
    let sample = &sample[..STATES.min(sample.len())];
    let mut random = Random::of_check(0x0B7E);
    let entry = subject.entry;
    let (mut worst, mut tried) = ((0.0_f64, String::new()), 0);
    for state in sample {
        let rotation = random_rotation(subject, &mut random);
        // (Q + I)⁻¹ in DROT amplifies rounding near half a turn
        if rotation.trace() < 0.0 {
            continue;
        }
        let Ok(point) = subject.after(&state.from, &state.step) else { continue };
        let zero = vec![0.0; state.step.len()];
        subject.share = INSTANT;
        let still = subject.after(&point, &zero);
        let turned = subject
            .deformed(&point, &(rotation * point.gradient))
            .map(|turned| Committed { input: rotated(entry, &point.input, &rotation, 2.0), ..turned });
        subject.share = 1.0;
        let (Ok(still), Some(turned)) = (still, turned) else { continue };
        let turned_step = rotated(entry, &state.step, &rotation, 2.0);
        let answers = (subject.evaluate(&still, &state.step), subject.evaluate(&turned, &turned_step));
        let (Ok(expected), Ok(found)) = answers else { continue };
        tried += 1;
        for (expected, found, when) in
            [(&still.output, &turned.output, "turned"), (&expected.output, &found.output, "strained afterwards")]
        {
            let expected = rotated(entry, expected, &rotation, 1.0);
            // what rounding makes of F, which is not small where the strain is
            let stiffness = largest(&subject.output_size) / largest(&subject.size);
            let floor = tolerances::ROUNDING_OF_F / tolerances::ROTATION * stiffness;
            let error = relative_error(subject, &point.input, found, &expected)
                .min(distance(found, &expected) / floor.max(f64::MIN_POSITIVE));
            if error > worst.0 || error.is_nan() {
                worst = (error, format!("{state}, {when}: {found:.6?}, expected {expected:.6?}"));
            }
        }
    }
    if tried == 0 {
        return ledger.skip("no state could be turned");
    }
    let (verdict, detail) = if worst.0 <= tolerances::ROTATION {
        (Verdict::Pass, format!("F1 = Q F0, then a step: {tried} states"))
    } else if !subject.reads_gradient && has_axes(subject, sample, &mut random) {
        let words = "has axes, which do not turn with the material: right where the host gives it strains along them \
                     (*ORIENTATION in ABAQUS)";
        (subject.blame(), format!("{words}; {}", worst.1))
    } else {
        (Verdict::Fail, worst.1)
    };
    ledger.add(verdict, format!("{:.1e}", worst.0), detail);
}

/// Returns whether the first steps of some of the states, made small, show an anisotropy.
fn has_axes(subject: &mut Subject<'_>, sample: &[SampledState], random: &mut Random) -> bool {
    let start = subject.virgin();
    sample.iter().any(|state| {
        let rotation = random_rotation(subject, random);
        elastic_anisotropy(subject, &start, &state.step, &rotation).is_some_and(|anisotropy| anisotropy > CLEAR)
    })
}

/// STATEV with its strain-like tensors turned.
fn rotated_states(subject: &Subject<'_>, statev: &[f64], rotation: &Matrix3<f64>) -> Vec<f64> {
    let mut states = statev.to_vec();
    let table = subject.plugin.law.as_ref().map_or(&[][..], |law| &law.states);
    for start in (0..table.len()).filter(|&k| table[k].tensor_component == 1) {
        if let Some(six) = states.get_mut(start..start + 6) {
            let tensor: [f64; 6] = std::array::from_fn(|i| six[i]);
            six.copy_from_slice(&deformation::rotated(&tensor, rotation, 2.0));
        }
    }
    states
}

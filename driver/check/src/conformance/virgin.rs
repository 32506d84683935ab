//! States where the answer is known: the virgin state, a step of zero, strain 33, and the same strains
//! given to another stress state.

use super::random::Random;
use super::report::{Ledger, Report, Verdict};
use super::sample::{SampledState, end_of, step_to, target};
use super::subject::{Answer, CheckedEntryPoint, Committed, INSTANT, Subject, distance, largest};
use super::tolerances;
use umat_abi::law::StressState;
use umat_abi::metadata::OVERSTRESS_WORK;

/// Returns whether the plugin answers a step of zero from the start.
pub(super) fn answers(subject: &mut Subject<'_>) -> bool {
    let virgin = subject.virgin();
    subject.share = INSTANT;
    let answer = subject.evaluate(&virgin, &vec![0.0; virgin.input.len()]);
    subject.share = 1.0;
    answer.is_ok()
}

/// Checks a zero step from the start: there must be no stress except an initial one. (Contact in a soft layer begins before the
/// gap closes; there the shear must be zero.)
pub(super) fn virgin_state(subject: &mut Subject<'_>, ledger: &mut Ledger<'_>) {
    ledger.begin("virgin state");
    let virgin = subject.virgin();
    let zero = vec![0.0; subject.entry.inputs()];
    subject.share = INSTANT;
    let answer = subject.evaluate(&virgin, &zero);
    subject.share = 1.0;
    match answer {
        Err(trouble) => ledger.add(subject.blame_for(&trouble), "", trouble.to_string()),
        Ok(answer) => {
            let skipped = usize::from(matches!(subject.entry, CheckedEntryPoint::Uinter(_)));
            // an initial stress of the case stays
            let raised = |output: &[f64]| distance(&output[skipped..], &virgin.output[skipped..]);
            let stress = raised(&answer.output);
            let is_none = stress == 0.0 || {
                // what grows in time, as swelling does, has grown in the instant
                let whole = subject.evaluate(&virgin, &zero).map_or(0.0, |answer| raised(&answer.output));
                stress <= 2.0 * INSTANT * whole + rounding(subject, &answer, &virgin)
            };
            let verdict = if is_none { Verdict::Pass } else { subject.blame() };
            let stresses = (skipped..answer.output.len())
                .filter(|&k| !is_none && answer.output[k] != virgin.output[k])
                .map(|k| (subject.entry.output_name(k), answer.output[k], virgin.output[k]))
                .map(|(name, after, before)| format!("{name} = {after:e} after a step of zero, {before:e} before"));
            let initialised = (0..answer.statev.len())
                .filter(|&k| answer.statev[k] != virgin.statev[k])
                .map(|k| format!("{} = {:e}", subject.state_name(k), answer.statev[k]));
            let details: Vec<_> = stresses.chain(initialised).collect();
            ledger.add(verdict, format!("{stress:e}"), details.join(", "));
        }
    }
}

/// Returns the stress that rounding leaves of that which the case's strains make, and of the initial one.
fn rounding(subject: &Subject<'_>, answer: &Answer, virgin: &Committed) -> f64 {
    let reach = subject.path.as_ref().map_or(0.0, |path| largest(&path.sizes()));
    let made = Some(largest(&answer.tangent) * reach).filter(|stress| stress.is_finite()).unwrap_or(0.0);
    tolerances::CANCELLATION * made.max(largest(&virgin.output))
}

/// A state variable below this share of its largest value is compared with that: it may be a difference of large
/// numbers (dissipation: work less stored energy).
const SMALL_STATE: f64 = 1e-2;

/// The largest value of each state variable in the sample.
fn typical_states(subject: &Subject<'_>, sample: &[SampledState]) -> Vec<f64> {
    (0..subject.nstatv).map(|k| sample.iter().fold(0.0_f64, |m, state| m.max(state.from.statev[k].abs()))).collect()
}

/// Checks that a zero step leaves stress, states and energies unchanged. A law that extrapolates may catch up on the damage by
/// which it lags.
pub(super) fn zero_increment(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("zero increment");
    let zero = vec![0.0; subject.entry.inputs()];
    let mut worst = (0.0, String::new());
    let typical = typical_states(subject, sample);
    for state in sample {
        let Ok(point) = subject.after(&state.from, &state.step) else { continue };
        subject.share = INSTANT;
        let answer = subject.evaluate(&point, &zero);
        subject.share = 1.0;
        let answer = match answer {
            Ok(answer) => answer,
            Err(trouble) => {
                return ledger.add(subject.blame_for(&trouble), "", format!("{state}: {trouble}"));
            }
        };
        let floor = tolerances::CANCELLATION / tolerances::ZERO_INCREMENT * subject.elastic_size(&point.input);
        let stress = distance(&answer.output, &point.output) / (largest(&point.output) + floor).max(f64::MIN_POSITIVE);
        let mut errors = vec![(stress, "stress".to_owned())];
        for k in 0..point.statev.len() {
            let (before, after) = (point.statev[k], answer.statev[k]);
            let scale = before.abs().max(SMALL_STATE * typical[k]).max(f64::MIN_POSITIVE);
            errors.push(((after - before).abs() / scale, subject.state_name(k)));
        }
        if subject.described() {
            let energy = point.energies.iter().map(|x| x.abs()).sum::<f64>().max(f64::MIN_POSITIVE);
            errors.push((distance(&answer.energies, &point.energies) / energy, "energies".into()));
        }
        for (error, what) in errors {
            if error > worst.0 {
                worst = (error, format!("{what} in {state}"));
            }
        }
    }
    let verdict = match worst.0 <= tolerances::ZERO_INCREMENT {
        true => Verdict::Pass,
        false if extrapolates(subject) => {
            let detail = format!("applies the damage by which the extrapolating law lags: {}", worst.1);
            return ledger.add(Verdict::Info, format!("{:.1e}", worst.0), detail);
        }
        false => subject.blame(),
    };
    ledger.add(verdict, format!("{:.1e}", worst.0), worst.1);
}

/// Returns whether the law reports the work that its extrapolation costs.
fn extrapolates(subject: &Subject<'_>) -> bool {
    subject.plugin.law.as_ref().is_some_and(|law| law.state_index(OVERSTRESS_WORK).is_some())
}

/// Checks that the state `strain_33` is ε33 where ε33 is given.
pub(super) fn strain_33(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("strain_33");
    let given =
        matches!(subject.entry, CheckedEntryPoint::Umat(stress_state) if stress_state.components().contains(&2));
    let (Some(index), true) = (subject.plugin.strain_33(), given) else { return };
    for state in sample {
        let Ok(answer) = subject.evaluate(&state.from, &state.step) else { continue };
        let expected = state.from.input[2] + state.step[2];
        if (answer.statev[index] - expected).abs() > f64::EPSILON * expected.abs() {
            let detail = format!("{state}: {:e}, given {expected:e}", answer.statev[index]);
            return ledger.add(Verdict::Fail, "", detail);
        }
    }
    ledger.add(Verdict::Pass, "", "");
}

/// Checks plane stress against the three-dimensional response with the ε33 that makes σ33 zero. If the law reports ε33, it must be
/// this one. At finite strain, where the thickness matters, the stresses must agree as well.
pub(super) fn thickness(subject: &mut Subject<'_>, ledger: &mut Ledger<'_>) {
    const STEPS: usize = 20;
    /// Part of a step that is a small strain.
    const SMALL: f64 = 1e-4;
    /// Errors that iterations and a nearly constant volume leave.
    const SAME: f64 = 1e-3;
    ledger.begin("thickness");
    let index = subject.plugin.strain_33();
    if subject.entry != CheckedEntryPoint::Umat(StressState::PlaneStress) || (index.is_none() && !subject.finite) {
        return;
    }
    let described = subject.described();
    let unseen = |ledger: &mut Ledger<'_>, why: &str| {
        let verdict = if described { Verdict::Skipped } else { Verdict::NotTested };
        ledger.add(verdict, "", format!("{why}: nothing to compare plane stress at finite strain with"));
    };
    let Some(mut space) = subject.through_six() else { return unseen(ledger, "it does not support NTENS 6") };
    let mut random = Random::of_check(0x7417);
    let increments = subject.path.as_ref().map_or(&[][..], |path| &path.increments);
    let every = increments.len().div_ceil(STEPS).max(1);
    let ends = increments.iter().rev().step_by(every).map(|increment| end_of(&increment.from, &increment.step));
    let mut ends: Vec<Vec<f64>> = ends.collect();
    ends.resize_with(STEPS.max(ends.len()), || target(subject, &mut random));
    let blank = subject.blank();
    let (mut least, mut worst, mut strain) = (f64::INFINITY, (0.0, String::new()), (0.0, String::new()));
    let mut compare = |end: &[f64]| {
        let answer = subject.evaluate(&blank, end).ok()?;
        let through = subject.evaluate_through(&mut space, &blank, end)?;
        let error = distance(&answer.output, &through) / largest(&through).max(f64::MIN_POSITIVE);
        let found = index.map(|index| (answer.statev[index], space.strain_33));
        Some((error, found, format!("at strains {end:.4?}: {:.4?}, with NTENS 6 {through:.4?}", answer.output)))
    };
    for end in ends {
        let little: Vec<f64> = end.iter().map(|strain| SMALL * strain).collect();
        let (Some((small, ..)), Some((error, found, words))) = (compare(&little), compare(&end)) else { continue };
        least = small.min(least);
        if error > worst.0 {
            worst = (error, words);
        }
        if let Some((law, space)) = found.filter(|_| error <= SAME) {
            let error = (law - space).abs() / largest(&end).max(space.abs());
            if error > strain.0 {
                strain = (error, format!("strain_33 is {law:.6e} where s33 is 0 at {space:.6e}, at strains {end:.4?}"));
            }
        }
    }
    if least > SAME {
        return unseen(ledger, "with NTENS 6 and s33 = 0 it is another law at small strains already");
    }
    let stresses = if subject.finite { worst.0 } else { 0.0 };
    match (strain.0 <= SAME, stresses <= SAME.max(10.0 * least)) {
        (true, true) => {
            ledger.add(Verdict::Pass, format!("{:.1e}", stresses.max(strain.0)), "as with NTENS 6 and s33 = 0")
        }
        (false, _) => ledger.add(Verdict::Fail, format!("{:.1e}", strain.0), strain.1),
        (true, false) => {
            let why = "at finite strain not the stress of the present thickness (F33), which small strains do not show";
            ledger.add(Verdict::Fail, format!("{:.1e}", worst.0), format!("{why}; {}", worst.1));
        }
    }
}

/// Checks that plane strain, and plane stress with the ε33 that it returned, give the stresses of the 3D response.
pub(super) fn agreement_with_three_d(subjects: &mut [Subject<'_>], report: &mut Report) {
    let Some(solid) = subjects.iter().position(|s| s.entry == CheckedEntryPoint::Umat(StressState::ThreeD)) else {
        return;
    };
    for k in (0..subjects.len()).filter(|&k| k != solid) {
        let CheckedEntryPoint::Umat(stress_state) = subjects[k].entry else { continue };
        let Ok([plane, solid]) = subjects.get_disjoint_mut([k, solid]) else { continue };
        let mut ledger = Ledger::new(report, plane.label);
        agreement(plane, solid, stress_state, &mut ledger);
    }
}

fn agreement(plane: &mut Subject<'_>, solid: &mut Subject<'_>, stress_state: StressState, ledger: &mut Ledger<'_>) {
    ledger.begin("agrees with 3D");
    const PATHS: usize = 20;
    let condensed = stress_state == StressState::PlaneStress;
    let index = plane.plugin.strain_33();
    if condensed && index.is_none() {
        return ledger.skip("no state strain_33");
    }
    let mut random = Random::of_check(0x33);
    let mut worst = (0.0_f64, String::from("stress on random paths"));
    for path in 0..PATHS {
        let (mut point, mut whole) = (plane.blank(), solid.blank());
        for leg in 1..=3 {
            let step = step_to(&point, &target(plane, &mut random));
            let Ok(after) = plane.after(&point, &step) else { break };
            point = after;
            let mut end = plane.entry.six(&point.input);
            if let Some(index) = index.filter(|_| condensed) {
                end[2] = point.statev[index];
            }
            let step = step_to(&whole, &end);
            let Ok(after) = solid.after(&whole, &step) else { break };
            whole = after;
            let expected = plane.entry.six(&point.output);
            let floor = tolerances::PLANE_STRESS_ITERATION / tolerances::AGREEMENT * solid.elastic_size(&end);
            let error = distance(&expected, &whole.output) / (largest(&expected) + floor).max(f64::MIN_POSITIVE);
            if error > worst.0 {
                let detail = format!(
                    "path {path}, leg {leg}: {:.4?} against {:.4?} in 3D at strains {end:?}",
                    point.output, whole.output
                );
                worst = (error, detail);
            }
            if error > tolerances::AGREEMENT {
                break; // what follows starts from different states
            }
        }
    }
    let verdict = match worst.0 <= tolerances::AGREEMENT {
        true => Verdict::Pass,
        // A law may define a plane-stress variant of its own; plane strain is 3D.
        false if condensed => Verdict::Warn,
        false => plane.blame(),
    };
    ledger.add(verdict, format!("{:.1e}", worst.0), worst.1);
}

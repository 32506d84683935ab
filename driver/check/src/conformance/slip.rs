//! DSLIP of FRIC against the slip that the shear traction does not give back.

use super::report::{Ledger, Verdict};
use super::sample::SampledState;
use super::subject::{CheckedEntryPoint, Committed, Subject};
use umat_abi::host::{FricAnswer, FricCall};

/// States looked at.
const STATES: usize = 60;
/// Way back that an elastic stiffness is measured on, relative to the slip.
const BACK: f64 = 1e-6;
/// Difference of two stiffnesses measured so, relative to them; and of DSLIP, relative to the slips.
const SAME: f64 = 1e-4;

/// Checks the inelastic slip where the shear is elastic: with one stiffness against unloading at both ends of an increment,
/// DSLIP = Δγ − Δτ/k. Nothing is said of other laws.
pub(super) fn inelastic(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    let CheckedEntryPoint::Fric(directions) = subject.entry else { return };
    // a law with metadata has its own measure, which its page gives
    if subject.described() {
        return;
    }
    ledger.begin("inelastic slip");
    let (mut looked_at, mut slipping) = (0, 0);
    let mut worst = (0.0_f64, String::new());
    for state in sample.iter().filter(|state| state.from.flags[0] != FricCall::OPEN).take(STATES) {
        let Ok(answer) = subject.evaluate(&state.from, &state.step) else { continue };
        if answer.given != Ok(FricAnswer::Tractions) {
            continue;
        }
        let end = subject.advanced(&state.from, &state.step, &answer);
        // the pressure of the end, so that nothing slides because it falls
        let mut start = state.from.clone();
        start.input[directions] = end.input[directions];
        let Some(after) = stiffness(subject, &end, directions) else { continue };
        // where nothing is to be given back, the stiffness there is no matter
        let before = if start.output.iter().all(|tau| *tau == 0.0) {
            Some(after)
        } else {
            stiffness(subject, &start, directions)
        };
        let Some(before) = before.filter(|before| (before - after).abs() <= SAME * after) else { continue };
        looked_at += 1;
        let size =
            (0..directions).fold(0.0_f64, |most, k| most.max(state.step[k].abs()).max((end.output[k] / after).abs()));
        for k in 0..directions {
            let expected = state.step[k] - end.output[k] / after + start.output[k] / before;
            let found = answer.slip_increment[k];
            slipping += usize::from(expected.abs() > SAME * size);
            let error = (found - expected).abs() / size.max(f64::MIN_POSITIVE);
            if error > worst.0 {
                let name = subject.entry.input_name(k);
                worst = (error, format!("{state}: DSLIP of {name} is {found:e}, its slip less Δτ/k {expected:e}"));
            }
        }
    }
    let figure = format!("{:.1e}", worst.0);
    match worst.0 <= SAME {
        _ if slipping == 0 => ledger.skip("no slip was seen with an elastic shear: DSLIP was not looked at"),
        true => ledger.add(Verdict::Pass, figure, format!("{looked_at} states")),
        // ABAQUS leaves DSLIP to the law
        false => ledger.add(Verdict::Warn, figure, worst.1),
    }
}

/// The stiffness against a small slip back along the shear traction, at constant pressure; `None` if there is no traction, no
/// answer, or none that is elastic: half of the way must give half of the change.
fn stiffness(subject: &mut Subject<'_>, point: &Committed, directions: usize) -> Option<f64> {
    let norm = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>().sqrt();
    let traction = norm(&point.output);
    if traction == 0.0 {
        return None;
    }
    let size = (0..directions).fold(0.0_f64, |most, k| most.max(subject.size[k]));
    let mut along = |share: f64| {
        let mut step = vec![0.0; directions + 1];
        for k in 0..directions {
            step[k] = -share * BACK * size * point.output[k] / traction;
        }
        let answer = subject.evaluate(point, &step).ok()?;
        (answer.given == Ok(FricAnswer::Tractions)).then(|| (traction - norm(&answer.output)) / (share * BACK * size))
    };
    let (whole, half) = (along(1.0)?, along(0.5)?);
    (whole > 0.0 && (whole - half).abs() <= SAME * whole).then_some(whole)
}

//! Dependence on the size of increments: one proportional path in 1, 10, 100 and 1000 increments.

use super::random::Random;
use super::report::{Ledger, Verdict};
use super::sample::target;
use super::subject::{NoAnswer, Subject, distance, largest};
use super::tolerances;
use pullout_run::deformation::exponential;
use umat_abi::metadata::flags;

const COUNTS: [u32; 4] = [1, 10, 100, 1000];
const PATHS: usize = 20;
/// Time limit for a slow law, s.
const TIME: f64 = 2.0;

/// The end stress of a path from the virgin state, or why an increment has none. Where F follows the strain, it is F that
/// grows in proportion: sums of DSTRAN lead to an end that depends on their number.
fn end_stress(subject: &mut Subject<'_>, end: &[f64], count: u32) -> Result<Vec<f64>, NoAnswer> {
    let mut point = subject.virgin();
    let virgin = point.gradient;
    let gradient = if subject.finite { Some(exponential(&subject.entry.six(end)) * virgin) } else { None };
    subject.share = subject.path_length() / f64::from(count);
    for k in 1..=count {
        // From the fraction itself, so that rounding does not add up.
        let fraction = f64::from(k) / f64::from(count);
        point = if let Some(gradient) = gradient {
            let there = if k == count { gradient } else { virgin + (gradient - virgin) * fraction };
            let deformed = subject.deformed(&point, &there);
            deformed.ok_or_else(|| NoAnswer::Refused("it has no answer on a path of F".into()))?
        } else {
            let step: Vec<f64> = end.iter().zip(&point.input).map(|(x, start)| fraction * x - start).collect();
            subject.after(&point, &step)?
        };
    }
    Ok(point.output)
}

/// Checks the errors relative to 1000 increments. A law that claims to be exact must be exact.
pub(super) fn check(subject: &mut Subject<'_>, ledger: &mut Ledger<'_>) {
    ledger.begin("increment size");
    let mut random = Random::of_check(0x57E9);
    let (mut errors, mut paths, mut why) = ([0.0_f64; 3], 0, String::new());
    let calls: u32 = COUNTS.iter().sum();
    for _ in 0..subject.affordable(PATHS, calls as usize, TIME) {
        let end = target(subject, &mut random);
        let stresses: Result<Vec<_>, _> = COUNTS.iter().map(|&count| end_stress(subject, &end, count)).collect();
        subject.share = 1.0;
        let stresses = match stresses {
            Ok(stresses) => stresses,
            Err(trouble) => {
                why = trouble.to_string();
                continue;
            }
        };
        paths += 1;
        let floor = tolerances::CANCELLATION / tolerances::PATH_EXACT * subject.elastic_size(&end);
        let scale = (largest(&stresses[3]) + floor).max(f64::MIN_POSITIVE);
        for k in 0..3 {
            errors[k] = errors[k].max(distance(&stresses[k], &stresses[3]) / scale);
        }
    }
    if paths == 0 {
        return ledger.add(Verdict::Warn, "", format!("no path led to its end: {why}"));
    }
    let worst = largest(&errors);
    let detail = format!(
        "1, 10, 100 increments against 1000: {:.1e}, {:.1e}, {:.1e}{}; {paths} paths",
        errors[0],
        errors[1],
        errors[2],
        if errors[2] > 1e-13 { format!("; order {:.1}", (errors[1] / errors[2]).log10()) } else { String::new() }
    );
    let verdict = match (subject.claims(flags::PATH_EXACT), worst <= tolerances::PATH_EXACT) {
        (true, true) => Verdict::Pass,
        (true, false) => Verdict::Fail,
        (false, _) => Verdict::Info,
    };
    ledger.add(verdict, format!("{worst:.1e}"), detail);
}

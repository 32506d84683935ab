//! Work against stored and dissipated energy, on paths that are subdivided until the trapezoidal rule
//! tells the truth.

use super::case_path::CasePath;
use super::random::Random;
use super::report::{Ledger, Verdict};
use super::sample::target;
use super::subject::{INSTANT, Subject, Trouble};
use super::{Options, tolerances};

/// Increments per leg; each twice the one before.
const INCREMENTS: [u32; 4] = [40, 80, 160, 320];
const LEGS: usize = 3;
const PATHS: usize = 8;
/// What a slow law may take, s.
const TIME: f64 = 2.0;

/// Sums over one path.
#[derive(Default)]
struct Balance {
    work: f64,
    absolute_work: f64,
    energy: f64,
    /// Largest fall of the dissipated energy in an increment.
    fall: f64,
}

fn run(subject: &mut Subject<'_>, targets: &[Vec<f64>], increments: u32) -> Result<Balance, Trouble> {
    let mut point = subject.virgin();
    let zero = vec![0.0; point.input.len()];
    // The stress of the virgin state itself: contact in a soft layer carries pressure before it closes.
    subject.share = INSTANT;
    let start = subject.evaluate(&point, &zero)?;
    point = subject.advanced(&point, &zero, &start);
    subject.share = subject.path_length() / f64::from(increments);
    let first: f64 = point.energies.iter().sum();
    let mut balance = Balance::default();
    for target in targets {
        let step: Vec<f64> =
            target.iter().zip(&point.input).map(|(end, start)| (end - start) / f64::from(increments)).collect();
        for _ in 0..increments {
            let answer = subject.evaluate(&point, &step)?;
            let next = subject.advanced(&point, &step, &answer);
            let work: f64 = (0..next.output.len()).map(|k| 0.5 * (point.output[k] + next.output[k]) * step[k]).sum();
            balance.work += work;
            balance.absolute_work += work.abs();
            balance.fall = balance.fall.max(dissipated(&point.energies) - dissipated(&next.energies));
            point = next;
        }
    }
    balance.energy = point.energies.iter().sum::<f64>() - first;
    Ok(balance)
}

/// All but the stored energy.
fn dissipated(energies: &[f64; 5]) -> f64 {
    energies[1..].iter().sum()
}

/// The rows "energy balance" and "dissipation".
pub(super) fn check(subject: &mut Subject<'_>, options: &Options, ledger: &mut Ledger<'_>) {
    const CHECK: &str = "energy balance";
    ledger.begin(CHECK);
    if subject.reads_gradient {
        return ledger.skip(CHECK, "finite strain: which volume its energies belong to is the law's choice");
    }
    let is_heated =
        |path: &CasePath| path.increments.iter().any(|increment| increment.from.setting.temperature[1] != 0.0);
    if subject.path.as_deref().is_some_and(is_heated) {
        return ledger.skip(CHECK, "the case changes the temperature: heat is energy as well");
    }
    let mut random = Random::new(options.seed ^ 0xE4E6);
    let (mut errors, mut paths, mut fall, mut returned) = ([0.0_f64; INCREMENTS.len()], 0, 0.0_f64, false);
    let calls = LEGS * INCREMENTS.iter().sum::<u32>() as usize;
    let wanted = subject.affordable(PATHS, calls, TIME);
    for _ in 0..wanted {
        let targets: Vec<_> = (0..LEGS).map(|_| target(subject, &mut random)).collect();
        let balances: Result<Vec<_>, _> =
            INCREMENTS.iter().map(|&increments| run(subject, &targets, increments)).collect();
        subject.share = 1.0;
        let Ok(balances) = balances else { continue };
        paths += 1;
        for (error, balance) in errors.iter_mut().zip(&balances) {
            let work = balance.absolute_work.max(f64::MIN_POSITIVE);
            *error += (balance.work - balance.energy).abs() / work / wanted as f64;
            fall = fall.max(balance.fall / work);
            returned |= balance.energy != 0.0;
        }
    }
    if paths == 0 {
        return ledger.add(CHECK, Verdict::Warn, "", "every path was cut short by a cut-back request");
    }
    if !returned && !subject.described() {
        return ledger.add(CHECK, Verdict::Info, "", "the plugin returns no energies");
    }
    let [.., before, last] = errors;
    let converges = last <= tolerances::ENERGY
        && errors[1] >= last * tolerances::ENERGY_REDUCTION.powi(INCREMENTS.len() as i32 - 2);
    let good = last <= tolerances::ENERGY_KINKS || converges;
    let verdict = match good {
        true => Verdict::Pass,
        false if subject.described() => Verdict::Fail,
        false => Verdict::Warn,
    };
    let detail = format!(
        "|work - energy| / work with {before:.1e} before the last halving, order {:.1}, {paths} paths",
        (errors[1] / last.max(f64::MIN_POSITIVE)).log2() / (INCREMENTS.len() - 2) as f64
    );
    ledger.add(CHECK, verdict, format!("{last:.1e}"), detail);
    // Nothing promises it: some published laws do not dissipate at every step.
    let verdict = if fall <= tolerances::DISSIPATION { Verdict::Pass } else { Verdict::Warn };
    ledger.add(
        "dissipation grows",
        verdict,
        format!("{:.1e}", fall.max(0.0)),
        "largest fall in an increment, relative to the work",
    );
}

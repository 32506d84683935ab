//! Compares the work with the stored and dissipated energy. Paths are subdivided until the trapezoidal rule is accurate.

use super::case_path::CasePath;
use super::random::Random;
use super::report::{Ledger, Verdict};
use super::sample::target;
use super::subject::{INSTANT, NoAnswer, Subject};
use super::tolerances;
use pullout_run::deformation::incremental_motion;

/// Increments per leg at first, and how often they are halved before anything is said.
const INCREMENTS: u32 = 40;
const HALVINGS: usize = 3;
/// Most halvings where the error does not yet decide: where a stress jumps, the error falls on average only.
const MOST_HALVINGS: usize = 8;
const LEGS: usize = 3;
const PATHS: usize = 8;
/// Change of log₂(error) in a halving below which the error stays as it is (3.5 %).
const SAME: f64 = 0.05;
/// Time that a slow law may take, s.
const TIME: f64 = 2.0;

/// Ends of the legs of a path, and its |work − energy| / work after each number of halvings.
struct Path {
    targets: Vec<Vec<f64>>,
    errors: Vec<f64>,
}

/// Sums over one path.
#[derive(Default)]
struct Balance {
    work: f64,
    absolute_work: f64,
    energy: f64,
    /// Largest fall of the dissipated energy in an increment.
    fall: f64,
}

fn run(subject: &mut Subject<'_>, targets: &[Vec<f64>], increments: u32) -> Result<Balance, NoAnswer> {
    let mut point = subject.virgin();
    let zero = vec![0.0; point.input.len()];
    // The stress of the virgin state itself: contact in a soft layer carries pressure before it closes.
    subject.share = INSTANT;
    point = subject.after(&point, &zero)?;
    subject.share = subject.path_length() / f64::from(increments);
    let first: f64 = point.energies.iter().sum();
    let mut balance = Balance::default();
    for target in targets {
        let step: Vec<f64> =
            target.iter().zip(&point.input).map(|(end, start)| (end - start) / f64::from(increments)).collect();
        for _ in 0..increments {
            let next = subject.after(&point, &step)?;
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
pub(super) fn check(subject: &mut Subject<'_>, ledger: &mut Ledger<'_>) {
    ledger.begin("energy balance");
    if subject.reads_gradient {
        return volume(subject, ledger);
    }
    let is_heated =
        |path: &CasePath| path.increments.iter().any(|increment| increment.from.setting.temperature[1] != 0.0);
    if subject.path.as_deref().is_some_and(is_heated) {
        return ledger.skip("the case changes the temperature: heat is energy as well");
    }
    let mut random = Random::of_check(0xE4E6);
    let calls = LEGS * (INCREMENTS << (HALVINGS + 1)) as usize;
    let wanted = subject.affordable(PATHS, calls, TIME);
    let mut paths: Vec<Path> = (0..wanted)
        .map(|_| Path { targets: (0..LEGS).map(|_| target(subject, &mut random)).collect(), errors: Vec::new() })
        .collect();
    let (mut errors, mut fall, mut returned, mut is_decided) = (Vec::new(), 0.0_f64, false, true);
    let mut why = String::new();
    for halvings in 0..=MOST_HALVINGS {
        let increments = INCREMENTS << halvings;
        let affordable = || subject.affordable(usize::MAX, LEGS * increments as usize, TIME) >= paths.len();
        if halvings > HALVINGS && (converges(&errors) || stays(&errors)) {
            break;
        }
        if halvings > HALVINGS && !affordable() {
            is_decided = false;
            break;
        }
        paths.retain_mut(|path| {
            let balance = run(subject, &path.targets, increments);
            subject.share = 1.0;
            let balance = match balance {
                Ok(balance) => balance,
                Err(trouble) => {
                    why = trouble.to_string();
                    return false;
                }
            };
            let work = balance.absolute_work.max(f64::MIN_POSITIVE);
            path.errors.push((balance.work - balance.energy).abs() / work);
            fall = fall.max(balance.fall / work);
            returned |= balance.energy != 0.0;
            true
        });
        if paths.is_empty() {
            return ledger.add(Verdict::Warn, "", format!("no path led to its end: {why}"));
        }
        let mean = |level| paths.iter().map(|path| path.errors[level]).sum::<f64>() / paths.len() as f64;
        errors = (0..=halvings).map(mean).collect();
    }
    if !returned && !subject.described() {
        return ledger.add(Verdict::Info, "", "the plugin returns no energies");
    }
    let [.., before, last] = errors[..] else { unreachable!("two subdivisions at least") };
    let verdict = match converges(&errors) {
        true => Verdict::Pass,
        false if subject.described() && is_decided => Verdict::Fail,
        false => Verdict::Warn,
    };
    let detail = format!(
        "|work - energy| / work with {before:.1e} before the last of {} halvings, order {:.1}, {} paths{}",
        errors.len() - 1,
        order(&errors),
        paths.len(),
        if is_decided { "" } else { "; undecided: the plugin is too slow for more halvings" }
    );
    ledger.add(verdict, format!("{last:.1e}"), detail);
    // Nothing promises it: some published laws do not dissipate at every step.
    let verdict = if fall <= tolerances::DISSIPATION { Verdict::Pass } else { Verdict::Warn };
    ledger.row(
        "dissipation grows",
        verdict,
        format!("{:.1e}", fall.max(0.0)),
        "largest fall in an increment, relative to the work",
    );
}

/// Increments of the path of F along which energies at finite strain are compared with the work.
const FINITE_INCREMENTS: u32 = 400;

/// The row "energy balance" at finite strain: SSE, SPD and SCD are per present volume. In as many increments as make the sum of the
/// work exact enough, however many the case has.
fn volume(subject: &mut Subject<'_>, ledger: &mut Ledger<'_>) {
    /// What the sum leaves, and what a law approximates.
    const SAME: f64 = 1e-2;
    let last = subject.path.as_ref().and_then(|path| path.increments.last());
    let Some(last) = last.map(|increment| subject.end_gradient(&increment.from, &increment.step)) else {
        return ledger.skip("finite strain: only a case has it checked");
    };
    let mut point = subject.virgin();
    let first = point.gradient;
    let counts = subject.affordable(FINITE_INCREMENTS as usize, 1, TIME);
    subject.share = subject.path_length() / counts as f64;
    // per reference volume: the work; energies that are per present volume; those that are per reference volume
    let (mut work, mut dissipated_in, start) = (0.0, 0.0, point.energies);
    for k in 1..=counts {
        let there = first + (last - first) * (k as f64 / counts as f64);
        let Some(next) = subject.deformed(&point, &there) else {
            subject.share = 1.0;
            return ledger.skip("finite strain: it has no answer on a straight path of F to the case's end");
        };
        let motion = incremental_motion(&point.gradient, &there);
        let strain = motion.map_or_else(Vec::new, |motion| subject.entry.of_six(&motion.strain_increment));
        let volumes = [point.gradient.determinant(), there.determinant()];
        // the stresses before and after the increment are both rotated
        for (component, by) in strain.iter().enumerate() {
            work += 0.5 * (volumes[0] * point.output[component] + volumes[1] * next.output[component]) * by;
        }
        dissipated_in += 0.5 * (volumes[0] + volumes[1]) * (dissipated(&next.energies) - dissipated(&point.energies));
        point = next;
    }
    subject.share = 1.0;
    if point.energies == [0.0; 5] {
        return ledger.add(Verdict::Info, "", "the plugin returns no energies");
    }
    let ratio = point.gradient.determinant();
    let present = ratio * point.energies[0] - first.determinant() * start[0] + dissipated_in;
    let reference = point.energies.iter().sum::<f64>() - start.iter().sum::<f64>();
    let [present, reference] = [present, reference].map(|energy| energy / work);
    let is = |found: f64| (found - 1.0).abs() <= SAME;
    let figures = format!(
        "{present:.3} of the work if they are per present volume, {reference:.3} if per reference volume (J = {ratio:.3} at the \
         end of a straight path of F to the case's)"
    );
    let (verdict, words) = match (is(present), is(reference)) {
        (true, _) => (Verdict::Pass, "SSE, SPD and SCD are per present volume, as they should"),
        (false, true) => {
            (Verdict::Warn, "SSE, SPD and SCD are per reference volume; hosts expect them per present volume")
        }
        (false, false) => (Verdict::Warn, "SSE, SPD and SCD are not the work of the stresses"),
    };
    ledger.add(verdict, format!("{present:.3}"), format!("{words}: {figures}"));
}

/// Returns whether errors after successive halvings are those of kinks alone, or fall with the increment.
fn converges(errors: &[f64]) -> bool {
    let last = errors.last().copied().unwrap_or(f64::INFINITY);
    last <= tolerances::ENERGY_KINKS
        || last <= tolerances::ENERGY && order(errors) >= tolerances::ENERGY_REDUCTION.log2()
}

/// Returns whether the error has stopped changing with the increment: energy is missing, and finer increments
/// do not help. (Where a stress jumps, the errors of successive halvings differ by chance.)
fn stays(errors: &[f64]) -> bool {
    errors.last_chunk::<4>().is_some_and(|last| last.windows(2).all(|pair| (pair[1] / pair[0]).log2().abs() < SAME))
}

/// Returns the slope of log₂(error) over the number of halvings, by least squares.
fn order(errors: &[f64]) -> f64 {
    let middle = 0.5 * (errors.len() as f64 - 1.0);
    let (mut product, mut square) = (0.0, 0.0);
    for (halvings, error) in errors.iter().enumerate() {
        let from_middle = halvings as f64 - middle;
        product -= from_middle * error.max(f64::MIN_POSITIVE).log2();
        square += from_middle * from_middle;
    }
    product / square
}

#[cfg(test)]
mod test;

//! Scale on which a strain, a slip or a gap is "large" for this law: found from its own response.

use super::report::{Ledger, Verdict};
use super::subject::{CheckedEntryPoint, Subject, largest};

/// The secant differs from the initial one by this share where nonlinearity begins.
const NONLINEAR: f64 = 1e-2;
/// A peak further than this times the strain of nonlinearity says nothing of the beginning.
const PEAK_REACH: f64 = 30.0;
/// Strain for laws without nonlinearity.
const LINEAR_STRAIN: f64 = 1e-3;
/// Slip for laws without nonlinearity, mm.
const LINEAR_SLIP: f64 = 1e-2;
/// Reference pressure of an interface, MPa.
const PRESSURE: f64 = 10.0;

/// Sets [`Subject::size`] and [`Subject::output_size`].
pub(super) fn find(subject: &mut Subject<'_>, ledger: &mut Ledger<'_>) {
    ledger.begin("typical size");
    let is_of_path = of_path(subject);
    match subject.entry {
        _ if is_of_path => {}
        CheckedEntryPoint::Umat(stress_state) => {
            let shear = stress_state.components().iter().position(|&i| i == 3).unwrap_or(0);
            let base = vec![0.0; subject.entry.inputs()];
            let found = [(0, 1.0), (0, -1.0), (shear, 1.0)]
                .into_iter()
                .filter_map(|(component, sign)| nonlinearity(subject, &base, component, sign, 1e-7, 10.0))
                .fold(f64::INFINITY, f64::min);
            subject.size.fill(if found.is_finite() { found } else { LINEAR_STRAIN });
        }
        CheckedEntryPoint::Uinter(n) => {
            let mut press = vec![0.0; n];
            press[0] = 1e-6;
            let virgin = subject.virgin();
            let stiffness = subject.evaluate(&virgin, &press).map_or(0.0, |answer| answer.tangent[0]);
            let closing = if stiffness > 0.0 { (PRESSURE / stiffness).clamp(1e-8, 1.0) } else { LINEAR_SLIP };
            let opening = nonlinearity(subject, &vec![0.0; n], 0, -1.0, 1e-8, 10.0).unwrap_or(f64::INFINITY);
            press[0] = closing;
            let slip = slip_size(subject, &press, 1);
            subject.size.fill(slip);
            subject.size[0] = closing.min(opening);
        }
        CheckedEntryPoint::Fric(n) => {
            let mut press = vec![0.0; n + 1];
            press[n] = PRESSURE;
            let slip = slip_size(subject, &press, 0);
            subject.size.fill(slip);
            subject.size[n] = PRESSURE;
        }
    }
    find_output_size(subject);
    let sizes: Vec<_> =
        (0..subject.size.len()).map(|k| format!("{} {:.2e}", subject.entry.input_name(k), subject.size[k])).collect();
    ledger.add(Verdict::Info, format!("{:.2e}", subject.size[0]), sizes.join(", "));
}

/// Sets the sizes that the case's path has. Who has metadata promises to answer anywhere, and is searched besides.
fn of_path(subject: &mut Subject<'_>) -> bool {
    let Some(path) = subject.path.clone().filter(|path| !path.increments.is_empty()) else { return false };
    if subject.described() {
        return false;
    }
    let mut sizes = path.sizes();
    match subject.entry {
        CheckedEntryPoint::Umat(_) => {
            let largest = largest(&sizes);
            sizes.fill(if largest > 0.0 { largest } else { LINEAR_STRAIN });
        }
        CheckedEntryPoint::Uinter(_) | CheckedEntryPoint::Fric(_) => {
            // a slip that the case does not make is like the one that it makes
            let normal = match subject.entry {
                CheckedEntryPoint::Fric(n) => n,
                _ => 0,
            };
            let slip = (0..sizes.len()).filter(|&k| k != normal).map(|k| sizes[k]).fold(0.0, f64::max);
            for (k, size) in sizes.iter_mut().enumerate().filter(|(_, size)| **size == 0.0) {
                *size = match subject.entry {
                    _ if k != normal && slip > 0.0 => slip,
                    CheckedEntryPoint::Fric(_) if k == normal => PRESSURE,
                    _ => LINEAR_SLIP,
                };
            }
        }
    }
    subject.size = sizes;
    true
}

fn slip_size(subject: &mut Subject<'_>, base: &[f64], component: usize) -> f64 {
    nonlinearity(subject, base, component, 1.0, 1e-7, 1e2).unwrap_or(LINEAR_SLIP)
}

/// The input at the peak of the response to one step in one direction, or twice the one at which it
/// becomes nonlinear; `None` for a linear law.
fn nonlinearity(
    subject: &mut Subject<'_>,
    base: &[f64],
    component: usize,
    sign: f64,
    least: f64,
    most: f64,
) -> Option<f64> {
    const FACTOR: f64 = 1.15;
    let virgin = subject.virgin();
    let mut response = |value: f64| {
        let mut step = base.to_vec();
        step[component] += sign * value;
        // in pieces, if it asks for them
        let mut point = virgin.clone();
        subject.advance(&mut point, &step).ok().map(|_| sign * point.output[component])
    };
    // Contact in a soft layer carries pressure before the gap closes.
    let start = response(0.0)?;
    let mut response = |value: f64| response(value).map(|stress| stress - start);
    let stiffness = response(least)? / least;
    let mut begin = None;
    let mut previous = 0.0;
    let mut value = least;
    while value < most {
        let Some(stress) = response(value) else { break };
        if begin.is_none() && (stress - stiffness * value).abs() > NONLINEAR * (stiffness * value).abs() {
            begin = Some(value);
        }
        if begin.is_some() && stress < previous {
            let peak = value / FACTOR;
            return begin.map(|begin| if peak <= PEAK_REACH * begin { peak } else { 2.0 * begin });
        }
        previous = stress;
        value *= FACTOR;
    }
    begin.map(|begin| 2.0 * begin)
}

/// The stress that a typical step raises in the virgin state.
fn find_output_size(subject: &mut Subject<'_>) {
    let (n, m) = (subject.entry.outputs(), subject.entry.inputs());
    let mut step: Vec<f64> = subject.size.iter().map(|size| 1e-3 * size).collect();
    match subject.entry {
        CheckedEntryPoint::Umat(_) => {}
        CheckedEntryPoint::Uinter(_) => step[0] = subject.size[0],
        CheckedEntryPoint::Fric(k) => step[k] = subject.size[k],
    }
    let virgin = subject.virgin();
    if let Ok(answer) = subject.evaluate(&virgin, &step) {
        let row = |i: usize| (0..m).map(|j| answer.tangent[i * m + j] * subject.size[j]).collect::<Vec<_>>();
        let rows: Vec<f64> = (0..n).map(|i| largest(&row(i))).collect();
        let all = largest(&rows);
        let solid = matches!(subject.entry, CheckedEntryPoint::Umat(_));
        subject.output_size = rows.into_iter().map(|row| if solid { all } else { row }).collect();
    }
}

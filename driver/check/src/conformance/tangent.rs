//! The consistent tangent against differences of the response, and what it is if it is not that.

mod small;

use super::report::{Ledger, Verdict};
use super::sample::{self, SampledState};
use super::subject::{Answer, CheckedEntryPoint, Committed, Subject, distance, largest};
use super::tolerances::{DIFFERENCES_DECIDE, EXCLUDED_SHARE, SYMMETRY, TANGENT, TANGENT_JUMP};
use std::fmt;
use umat_abi::host::GRADIENTS;
use umat_abi::metadata::flags;

/// Steps of the differences, relative to the inputs.
const STEPS: [f64; 4] = [1e-3, 1e-4, 1e-5, 1e-6];
/// Time that a slow law may take, s.
const TIME: f64 = 4.0;
/// Increments of the case's path that are looked at as they are.
const ALONG_THE_PATH: usize = 20;
/// Largest number of wrong states that are examined to identify the tangent.
const CLASSIFIED: usize = 12;

/// Findings at one state.
enum Finding {
    /// The relative error.
    Consistent(f64),
    /// The response has a kink here.
    Kink,
    /// The difference quotients disagree among themselves.
    Undecided,
    Wrong(Mismatch),
}

/// A matrix that is not the derivative.
#[cfg_attr(test, derive(Default))]
pub(super) struct Mismatch {
    error: f64,
    row: usize,
    column: usize,
    expected: f64,
    found: f64,
    pub(super) differences: Vec<f64>,
    /// Whether it is wrong against the size of its own row and column alone ([`small`]).
    is_small: bool,
}

#[cfg(test)]
impl Mismatch {
    /// One of which the differences alone are known.
    pub(super) fn of(differences: Vec<f64>) -> Self {
        Self { differences, ..Self::default() }
    }
}

/// Findings at all states.
pub(super) struct Findings<'s> {
    worst: f64,
    kinks: usize,
    undecided: usize,
    on_path: Option<f64>,
    pub(super) wrong: Vec<(&'s SampledState, Mismatch)>,
    count: usize,
}

impl<'s> Findings<'s> {
    /// Examines a matrix of derivatives at all states. Differences of values smaller than `least` carry no information.
    pub(super) fn of(
        subject: &mut Subject<'_>,
        states: impl Iterator<Item = &'s SampledState>,
        measure: Measure,
        least: f64,
    ) -> Self {
        let mut this = Self { worst: 0.0, kinks: 0, undecided: 0, on_path: None, wrong: Vec::new(), count: 0 };
        for state in states {
            this.count += 1;
            let finding = examine(subject, state, measure, least);
            if let Finding::Consistent(error) | Finding::Wrong(Mismatch { error, .. }) = finding
                && state.is_on_the_path()
            {
                this.on_path = Some(this.on_path.unwrap_or(0.0).max(error));
            }
            match finding {
                Finding::Consistent(error) => this.worst = this.worst.max(error),
                Finding::Kink => this.kinks += 1,
                Finding::Undecided => this.undecided += 1,
                Finding::Wrong(mismatch) => this.wrong.push((state, mismatch)),
            }
        }
        this
    }

    /// Returns a text with the number of each kind.
    fn counts(&self) -> String {
        let Self { count, kinks, undecided, .. } = self;
        let mut counts = format!("{count} states, {kinks} at kinks, {undecided} undecided");
        if let Some(error) = self.on_path {
            counts += &format!("; on the case's path itself {error:.1e} at most");
        }
        counts
    }

    /// The state whose error is the largest.
    fn largest(&self) -> Option<&(&'s SampledState, Mismatch)> {
        self.wrong.iter().max_by(|a, b| a.1.error.total_cmp(&b.1.error))
    }

    /// Adds the row: consistent, with the text `with`, or a description of the errors. `is_choice`: they may be intended.
    pub(super) fn report(
        &self,
        subject: &Subject<'_>,
        measure: Measure,
        with: &str,
        (what, is_choice): (&str, bool),
        ledger: &mut Ledger<'_>,
    ) {
        let counts = self.counts();
        let Some((state, mismatch)) = self.largest() else {
            let excluded = (self.kinks + self.undecided) as f64 > EXCLUDED_SHARE * self.count as f64;
            let verdict = if excluded { Verdict::Warn } else { Verdict::Pass };
            return ledger.add(verdict, format!("{:.1e}", self.worst), format!("consistent{with}; {counts}"));
        };
        let least = self.wrong.iter().map(|(_, mismatch)| mismatch.error).fold(f64::INFINITY, f64::min);
        let entry = subject.entry;
        let ends: Vec<String> = (0..state.step.len())
            .map(|k| format!("{} = {:.3e}", entry.input_name(k), state.from.input[k] + state.step[k]))
            .collect();
        let detail = format!(
            "{what}; relative errors {least:.1e} to {:.1e} in {} wrong of {counts}; the largest in {state}, d({})/d({}) = {:.6e} \
             expected, {:.6e} found, at {}",
            mismatch.error,
            self.wrong.len(),
            measure.row_name(entry, mismatch.row),
            measure.column_name(entry, mismatch.column),
            mismatch.expected,
            mismatch.found,
            ends.join(", ")
        );
        // A plain UMAT promises nothing: a secant is a choice. What is no known choice is a mistake.
        let verdict = if is_choice && !subject.described() { Verdict::Warn } else { Verdict::Fail };
        ledger.add(verdict, format!("{:.1e}", mismatch.error), detail);
    }
}

/// Derivative that a wrong tangent is in truth.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Elastic,
    /// Derivative of σ instead of Jσ/J: without the part of the volume change.
    Cauchy,
    /// DDSDDE · ε = σ.
    Secant,
    /// The stiffness of the next unloading.
    Unloading,
    /// The derivative with rows and columns exchanged.
    Transposed,
    /// The derivative, except for shear components that are twice too large.
    DoubledShear,
    /// Correct except for a factor on the part that loading adds to the unloading stiffness.
    Scaled(f64),
    Wrong,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Elastic => f.write_str("elastic: the virgin tangent"),
            Self::Secant => f.write_str("secant-like: stress = DDSDDE strain"),
            Self::Unloading => f.write_str("secant-like: the stiffness of unloading"),
            Self::Transposed => f.write_str(
                "stored by rows: the transpose of what it should be; Fortran stores columns, DDSDDE(i,j) = d(stress i)/d(strain \
                 j) is element i + NTENS (j - 1)",
            ),
            Self::DoubledShear => f.write_str(
                "right except for shears: twice what they should be, 2 mu in place of mu; STRAN and DSTRAN have engineering shears, \
                 gamma = 2 epsilon",
            ),
            Self::Cauchy => {
                f.write_str("of the Jaumann rate of the Cauchy stress, d(stress)/dD; J wants d(J stress)/dD / J")
            }
            // three digits that are all zero say nothing
            Self::Scaled(factor) if (factor - 1.0).abs() < 5e-3 => {
                write!(f, "wrong: the part due to loading is off by {:.1e} of itself", factor - 1.0)
            }
            Self::Scaled(factor) => write!(f, "wrong: the part due to loading is {factor:.3} of what it should be"),
            Self::Wrong => f.write_str("wrong"),
        }
    }
}

/// The row "consistent tangent".
pub(super) fn check(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("consistent tangent");
    let calls = 1 + 4 * STEPS.len() * subject.entry.inputs();
    let (along, count) = states(subject, sample, calls);
    let measure = Measure::of(subject);
    let findings = Findings::of(subject, along.iter().chain(&sample[..count]), measure, 0.0);
    let with = match (subject.finite, subject.reads_gradient) {
        (true, true) => " with the Jaumann rate of the Kirchhoff stress",
        (true, false) => " with DSTRAN; DFGRD1 is not read",
        (false, _) => "",
    };
    let kinds: Vec<Kind> =
        findings.wrong.iter().take(CLASSIFIED).map(|(state, m)| classify(subject, state, m)).collect();
    let is_choice =
        kinds.iter().all(|kind| matches!(kind, Kind::Elastic | Kind::Cauchy | Kind::Secant | Kind::Unloading));
    findings.report(subject, measure, with, (&summary(&kinds), is_choice), ledger);
}

/// States of the case's path as they are, and how many of the sample, that are looked at in so many calls each.
pub(super) fn states(subject: &Subject<'_>, sample: &[SampledState], calls: usize) -> (Vec<SampledState>, usize) {
    let along = sample::along_the_path(subject, subject.affordable(ALONG_THE_PATH, calls, TIME));
    (along, subject.affordable(sample.len(), calls, TIME).min(sample.len()))
}

/// One word for all wrong states.
fn summary(kinds: &[Kind]) -> String {
    let same = |a: &Kind, b: &Kind| match (a, b) {
        (Kind::Scaled(x), Kind::Scaled(y)) => (x - y).abs() < 1e-2,
        _ => a == b,
    };
    match kinds {
        [first, rest @ ..] if rest.iter().all(|kind| same(first, kind)) => first.to_string(),
        _ => Kind::Wrong.to_string(),
    }
}

/// The magnitude of each input here: the larger of its group's end values and steps.
fn local_sizes(subject: &Subject<'_>, from: &Committed, step: &[f64]) -> Vec<f64> {
    let end = |k: usize| (from.input[k] + step[k]).abs();
    let solid = matches!(subject.entry, CheckedEntryPoint::Umat(_));
    // where a small step leads on, the point before it, at which it may have begun to load, is near
    const REACH: f64 = 30.0;
    let all = (0..step.len()).fold(0.0_f64, |m, k| m.max(end(k))).min(REACH * largest(step));
    (0..step.len()).map(|k| if solid { all } else { end(k) }.max(1e-3 * subject.size[k])).collect()
}

/// Errors are relative to these: entry (i, j) · weight(i, j).
struct Scale {
    columns: usize,
    weights: Vec<f64>,
}

impl Scale {
    /// Determines the scale of errors. Solids: the largest entry. Interfaces: the largest entry of each row (times the inputs'
    /// sizes) or its virgin value, because a normal stiffness does not scale a shear. A row of zeros in all matrices is correct, and
    /// so are entries smaller than `least` times the tolerance.
    fn new(subject: &Subject<'_>, measure: Measure, matrices: &[&[f64]], least: f64) -> Self {
        let columns = measure.columns(subject.entry);
        let entries = columns * measure.rows(subject.entry);
        let weight = |size: f64, of: f64| if of > 0.0 { size / of } else { 0.0 };
        let weights = if matches!(subject.entry, CheckedEntryPoint::Umat(_)) {
            vec![weight(1.0, matrices.iter().map(|matrix| largest(matrix)).fold(least, f64::max)); entries]
        } else {
            let row_size = |i: usize| {
                let row = |matrix: &&[f64]| {
                    (0..columns).map(|j| (matrix[i * columns + j] * subject.size[j]).abs()).fold(0.0, f64::max)
                };
                matrices.iter().map(row).fold(subject.output_size[i], f64::max)
            };
            (0..entries).map(|k| weight(subject.size[k % columns], row_size(k / columns))).collect()
        };
        Self { columns, weights }
    }

    /// Makes the scale for the entries of a square matrix whose rows and columns differ much in size: each is measured by the
    /// largest entries of its row and of its column, √(rᵢ cⱼ).
    fn of_rows_and_columns(columns: usize, matrices: &[&[f64]]) -> Self {
        let most = |of: &dyn Fn(usize) -> usize| {
            let entries = (0..columns).flat_map(|k| matrices.iter().map(move |matrix| (matrix, k)));
            entries.fold(0.0_f64, |most, (matrix, k)| most.max(matrix[of(k)].abs()))
        };
        let size = |k: usize| {
            let (row, column) = (k / columns, k % columns);
            (most(&|j| row * columns + j) * most(&|i| i * columns + column)).sqrt()
        };
        let weights = (0..columns * columns).map(size).map(|size| if size > 0.0 { 1.0 / size } else { 0.0 }).collect();
        Self { columns, weights }
    }

    /// The largest weighted difference, and where.
    fn difference(&self, a: &[f64], b: &[f64]) -> (f64, usize) {
        (0..a.len()).fold((0.0, 0), |worst, k| {
            let error = (a[k] - b[k]).abs() * self.weights[k];
            if error > worst.0 || error.is_nan() { (error, k) } else { worst }
        })
    }
}

/// Quantity that is differentiated, and by what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Measure {
    /// The output itself by the inputs.
    Output,
    /// (1/J) ∂(Jσ)/∂D by symmetric changes of F₁: the Jaumann rate of the Kirchhoff stress, as ABAQUS requires.
    Kirchhoff,
    /// ∂σ/∂D by the same.
    Cauchy,
    /// The stress by the temperature at the end: DDSDDT.
    StressByTemperature,
    /// RPL by the strains: DRPLDE.
    HeatByStrain,
    /// RPL by the temperature at the end: DRPLDT.
    HeatByTemperature,
    /// U by the temperature at the end: DUDT.
    EnergyByTemperature,
    /// U by the gradient of the temperature: DUDG.
    EnergyByGradient,
    /// FLUX of UMATHT by the temperature at the end: DFDT.
    FluxByTemperature,
    /// and by its gradient: DFDG.
    FluxByGradient,
}

impl Measure {
    /// Returns what DDSDDE is the derivative of. A law that takes its strain from DSTRAN alone does not see the changes of F₁.
    fn of(subject: &Subject<'_>) -> Self {
        if subject.finite && subject.reads_gradient { Self::Kirchhoff } else { Self::Output }
    }

    fn is_by_temperature(self) -> bool {
        use Measure::{EnergyByTemperature, FluxByTemperature, HeatByTemperature, StressByTemperature};
        matches!(self, StressByTemperature | HeatByTemperature | EnergyByTemperature | FluxByTemperature)
    }

    fn is_by_gradient(self) -> bool {
        matches!(self, Self::EnergyByGradient | Self::FluxByGradient)
    }

    fn is_of_heat(self) -> bool {
        matches!(self, Self::HeatByStrain | Self::HeatByTemperature)
    }

    fn is_of_energy(self) -> bool {
        matches!(self, Self::EnergyByTemperature | Self::EnergyByGradient)
    }

    fn is_of_flux(self) -> bool {
        matches!(self, Self::FluxByTemperature | Self::FluxByGradient)
    }

    fn columns(self, entry: CheckedEntryPoint) -> usize {
        match self {
            _ if self.is_by_temperature() => 1,
            _ if self.is_by_gradient() => GRADIENTS,
            _ => entry.inputs(),
        }
    }

    fn rows(self, entry: CheckedEntryPoint) -> usize {
        match self {
            _ if self.is_of_heat() || self.is_of_energy() => 1,
            _ if self.is_of_flux() => GRADIENTS,
            _ => entry.outputs(),
        }
    }

    fn row_name(self, entry: CheckedEntryPoint, row: usize) -> String {
        match self {
            _ if self.is_of_heat() => "RPL".to_owned(),
            _ if self.is_of_energy() => "U".to_owned(),
            _ if self.is_of_flux() => format!("FLUX{}", row + 1),
            _ => entry.output_name(row),
        }
    }

    fn column_name(self, entry: CheckedEntryPoint, column: usize) -> String {
        match self {
            _ if self.is_by_temperature() => "TEMP".to_owned(),
            _ if self.is_by_gradient() => format!("DTEMDX{}", column + 1),
            _ => entry.input_name(column),
        }
    }

    /// Returns what is differentiated.
    pub(super) fn value(self, answer: Answer) -> Vec<f64> {
        let transfer = answer.transfer.unwrap_or_default();
        match self {
            _ if self.is_of_heat() => vec![answer.heat.rpl],
            _ if self.is_of_energy() => vec![transfer.energy],
            _ if self.is_of_flux() => transfer.flux.to_vec(),
            _ => answer.output,
        }
    }

    /// The derivative that an answer reports, row by row.
    pub(super) fn reported(self, answer: &Answer) -> Vec<f64> {
        let components = answer.output.len();
        let transfer = answer.transfer.unwrap_or_default();
        match self {
            Self::Output | Self::Kirchhoff | Self::Cauchy => answer.tangent.clone(),
            Self::StressByTemperature => answer.heat.ddsddt[..components].to_vec(),
            Self::HeatByStrain => answer.heat.drplde[..components].to_vec(),
            Self::HeatByTemperature => vec![answer.heat.drpldt],
            Self::EnergyByTemperature => vec![transfer.energy_by_temperature],
            Self::EnergyByGradient => transfer.energy_by_gradient.to_vec(),
            Self::FluxByTemperature => transfer.flux_by_temperature.to_vec(),
            Self::FluxByGradient => transfer.flux_by_gradient.concat(),
        }
    }

    /// The magnitude of each input at a state.
    pub(super) fn sizes(self, subject: &Subject<'_>, from: &Committed, step: &[f64]) -> Vec<f64> {
        /// Size of a temperature that is given as 0.
        const DEGREE: f64 = 1.0;
        if self.is_by_gradient() {
            return vec![largest(&from.setting.temperature_gradient).max(DEGREE); GRADIENTS];
        }
        if !self.is_by_temperature() {
            return local_sizes(subject, from, step);
        }
        let [start, increment] = from.setting.temperature;
        vec![(start + increment).abs().max(increment.abs()).max(DEGREE)]
    }
}

/// Returns the answer near the end of a step, with one input, or the temperature, increased.
fn perturbed(
    subject: &mut Subject<'_>,
    from: &Committed,
    step: &[f64],
    (column, by): (usize, f64),
    measure: Measure,
) -> Option<Answer> {
    if measure.is_by_temperature() {
        let mut warmer = from.clone();
        warmer.setting.temperature[1] += by;
        return subject.evaluate(&warmer, step).ok();
    }
    if measure.is_by_gradient() {
        let mut steeper = from.clone();
        steeper.setting.temperature_gradient[column] += by;
        return subject.evaluate(&steeper, step).ok();
    }
    let mut step = step.to_vec();
    step[column] += by;
    subject.evaluate(from, &step).ok()
}

/// d(output)/d(input) around the end of a step by fourth-order central differences; `None` if a call fails.
fn differences(
    subject: &mut Subject<'_>,
    from: &Committed,
    step: &[f64],
    sizes: &[f64],
    h: f64,
    measure: Measure,
) -> Option<Vec<f64>> {
    let (n, m) = (measure.rows(subject.entry), measure.columns(subject.entry));
    let end = subject.end_gradient(from, step);
    let deforms = match measure {
        Measure::Kirchhoff | Measure::Cauchy => true,
        Measure::HeatByStrain => Measure::of(subject) == Measure::Kirchhoff,
        Measure::Output
        | Measure::StressByTemperature
        | Measure::HeatByTemperature
        | Measure::EnergyByTemperature
        | Measure::EnergyByGradient
        | Measure::FluxByTemperature
        | Measure::FluxByGradient => false,
    };
    let mut matrix = vec![0.0; n * m];
    for j in 0..m {
        let mut shifted = |factor: f64| {
            let by = factor * h * sizes[j];
            if !deforms {
                return Some(measure.value(perturbed(subject, from, step, (j, by), measure)?));
            }
            // F₁ + ½ ε (eᵢ⊗eⱼ + eⱼ⊗eᵢ) F₁
            let mut unit = vec![0.0; m];
            unit[j] = by;
            let there = end + subject.tensor(&unit) * end;
            let output = measure.value(subject.answer_deformed(from, &there)?);
            let volume = if measure == Measure::Kirchhoff { there.determinant() / end.determinant() } else { 1.0 };
            Some(output.into_iter().map(|stress| volume * stress).collect())
        };
        let (far_plus, plus, minus, far_minus) = (shifted(2.0)?, shifted(1.0)?, shifted(-1.0)?, shifted(-2.0)?);
        for i in 0..n {
            let slope = 8.0 * (plus[i] - minus[i]) - (far_plus[i] - far_minus[i]);
            matrix[i * m + j] = slope / (12.0 * h * sizes[j]);
        }
    }
    Some(matrix)
}

/// Compares one state's derivatives with the differences at the best step.
fn examine(subject: &mut Subject<'_>, state: &SampledState, measure: Measure, least: f64) -> Finding {
    let Ok(answer) = subject.evaluate(&state.from, &state.step) else { return Finding::Undecided };
    let sizes = measure.sizes(subject, &state.from, &state.step);
    let reported = measure.reported(&answer);
    let quotients: Vec<Vec<f64>> =
        STEPS.iter().filter_map(|&h| differences(subject, &state.from, &state.step, &sizes, h, measure)).collect();
    let matrices: Vec<&[f64]> = quotients.iter().chain([&reported]).map(Vec::as_slice).collect();
    let scale = Scale::new(subject, measure, &matrices, least);
    let errors: Vec<(f64, usize)> = quotients.iter().map(|matrix| scale.difference(matrix, &reported)).collect();
    let Some(best) = (0..errors.len()).min_by(|&a, &b| errors[a].0.total_cmp(&errors[b].0)) else {
        return Finding::Undecided;
    };
    let (error, k) = errors[best];
    if error <= TANGENT {
        let is_stiffness = matches!(measure, Measure::Output | Measure::Kirchhoff);
        let found = is_stiffness.then(|| small::wrong_entry(subject, &quotients, &answer, &sizes)).flatten();
        return match found {
            Some((mismatch, own)) if !near_kink(subject, state, answer, &sizes, &own, measure) => {
                Finding::Wrong(mismatch)
            }
            _ => Finding::Consistent(error),
        };
    }
    if near_kink(subject, state, answer, &sizes, &scale, measure) {
        return Finding::Kink;
    }
    let neighbours = [best.checked_sub(1), Some(best + 1).filter(|&b| b < quotients.len())];
    let spread = neighbours
        .into_iter()
        .flatten()
        .map(|other| scale.difference(&quotients[best], &quotients[other]).0)
        .fold(0.0, f64::max);
    if spread > DIFFERENCES_DECIDE * error || quotients.len() < 2 {
        return Finding::Undecided;
    }
    let (row, column) = (k / scale.columns, k % scale.columns);
    let differences = quotients[best].clone();
    let (expected, found) = (differences[k], reported[k]);
    Finding::Wrong(Mismatch { error, row, column, expected, found, differences, is_small: false })
}

/// Returns whether one-sided differences disagree, or the derivative itself jumps, within the reach of the differences.
fn near_kink(
    subject: &mut Subject<'_>,
    state: &SampledState,
    here: Answer,
    sizes: &[f64],
    scale: &Scale,
    measure: Measure,
) -> bool {
    let columns = scale.columns;
    let reported = measure.reported(&here);
    let here = measure.value(here);
    for j in 0..columns {
        for h in [1e-6, 1e-4] {
            let sides =
                [-1.0, 1.0].map(|sign| perturbed(subject, &state.from, &state.step, (j, sign * h * sizes[j]), measure));
            let [Some(before), Some(after)] = sides else { return true };
            let jump = |there: &Answer| scale.difference(&measure.reported(there), &reported).0 > TANGENT_JUMP;
            let jumps = jump(&before) || jump(&after);
            let [before, after] = [before, after].map(|answer| measure.value(answer));
            let fold = (0..here.len()).any(|i| {
                let second = after[i] - 2.0 * here[i] + before[i];
                (second / (h * sizes[j])).abs() * scale.weights[i * columns + j] > TANGENT_JUMP
            });
            if fold || jumps {
                return true;
            }
        }
    }
    false
}

/// Returns what a wrong tangent is.
fn classify(subject: &mut Subject<'_>, state: &SampledState, mismatch: &Mismatch) -> Kind {
    const SAME: f64 = 1e-6;
    /// The virgin stiffness by differences over a ten-thousandth of the strain, where a smooth law is not quite linear.
    const VIRGIN: f64 = 1e-4;
    /// A matrix explains DDSDDE if it is so much nearer to it than the derivative is: in a linear law, or one whose derivative is
    /// symmetric, some are the derivative itself.
    const NEARER: f64 = 0.3;
    let Ok(answer) = subject.evaluate(&state.from, &state.step) else { return Kind::Wrong };
    let tangent = &answer.tangent;
    let matrices: [&[f64]; 2] = [tangent, &mismatch.differences];
    let scale = match mismatch.is_small {
        true => Scale::of_rows_and_columns(subject.entry.inputs(), &matrices),
        false => Scale::new(subject, Measure::Output, &matrices, 0.0),
    };
    let nearer = NEARER * scale.difference(&mismatch.differences, tangent).0;
    let is = |matrix: &[f64], same: f64| scale.difference(matrix, tangent).0 < same.min(nearer);
    let sizes = local_sizes(subject, &state.from, &state.step);
    if Measure::of(subject) == Measure::Kirchhoff {
        let cauchy = differences(subject, &state.from, &state.step, &sizes, 1e-4, Measure::Cauchy);
        if cauchy.is_some_and(|cauchy| is(&cauchy, SAME)) {
            return Kind::Cauchy;
        }
    }
    if let Some(habit) = habit(subject.entry, &mismatch.differences, is) {
        return habit;
    }
    let virgin = subject.virgin_during(&state.from);
    let tiny: Vec<f64> = state.step.iter().map(|d| 1e-6 * d).collect();
    // differences, because a wrong tangent may be wrong there as well
    let elastic = differences(subject, &virgin, &tiny, &sizes, 1e-4, Measure::of(subject));
    if elastic.is_some_and(|elastic| is(&elastic, VIRGIN)) {
        return Kind::Elastic;
    }
    let end = subject.advanced(&state.from, &state.step, &answer);
    if subject.entry.outputs() == subject.entry.inputs() {
        let m = end.input.len();
        let misfit = |matrix: &[f64]| {
            let row = |i: usize| (0..m).map(|j| matrix[i * m + j] * end.input[j]).sum();
            distance(&(0..m).map(row).collect::<Vec<f64>>(), &end.output)
        };
        let same = SAME * largest(tangent) * largest(&end.input);
        if misfit(tangent) < same.min(NEARER * misfit(&mismatch.differences)) {
            return Kind::Secant;
        }
    }
    // A little way back, where small steps either way unload.
    let back: Vec<f64> = state.step.iter().map(|d| -1e-3 * d).collect();
    let Some(unloading) = differences(subject, &end, &back, &sizes, 1e-5, Measure::Output) else { return Kind::Wrong };
    if is(&unloading, 1e-3) {
        return Kind::Unloading;
    }
    loading_factor(tangent, &unloading, &mismatch.differences).map_or(Kind::Wrong, Kind::Scaled)
}

/// Returns which of the usual errors made a tangent of a derivative, if it is one of these. `is`: whether the tangent is a matrix,
/// within so much.
fn habit(entry: CheckedEntryPoint, derivative: &[f64], is: impl Fn(&[f64], f64) -> bool) -> Option<Kind> {
    /// Rounding of the differences, and of a law with a few digits.
    const SAME: f64 = 1e-5;
    let n = entry.outputs();
    if n != entry.inputs() {
        return None;
    }
    let of = |entry: &dyn Fn(usize, usize) -> f64| (0..n * n).map(|k| entry(k / n, k % n)).collect::<Vec<f64>>();
    let is = |matrix: &[f64]| is(matrix, SAME);
    if is(&of(&|i, j| derivative[j * n + i])) {
        return Some(Kind::Transposed);
    }
    let CheckedEntryPoint::Umat(stress_state) = entry else { return None };
    let shear = |i: usize| stress_state.components()[i] >= 3;
    // of the diagonal alone, or of all that is multiplied with a shear
    let on_diagonal = of(&|i, j| derivative[i * n + j] * if i == j && shear(i) { 2.0 } else { 1.0 });
    let of_columns = of(&|i, j| derivative[i * n + j] * if shear(j) { 2.0 } else { 1.0 });
    (is(&on_diagonal) || is(&of_columns)).then_some(Kind::DoubledShear)
}

/// The row "shear stiffness": a law whose normal stresses are isotropic at the start, and whose shears are twice as stiff as that
/// goes with, has multiplied engineering shears by 2 mu.
pub(super) fn shear_stiffness(subject: &mut Subject<'_>, ledger: &mut Ledger<'_>) {
    /// What an elastic law leaves of these differences, relative to its stiffness.
    const SAME: f64 = 1e-6;
    let CheckedEntryPoint::Umat(stress_state) = subject.entry else { return };
    if subject.described() {
        return;
    }
    ledger.begin("shear stiffness");
    let virgin = subject.virgin();
    let sizes = subject.size.clone();
    let zero = vec![0.0; sizes.len()];
    let Some(matrix) = differences(subject, &virgin, &zero, &sizes, 1e-5, Measure::of(subject)) else { return };
    let n = zero.len();
    let components = stress_state.components();
    let direct: Vec<usize> = (0..n).filter(|&k| components[k] < 3).collect();
    let shears: Vec<usize> = (0..n).filter(|&k| components[k] >= 3).collect();
    let [first, second, ..] = direct[..] else { return };
    let entry = |i: usize, j: usize| matrix[i * n + j];
    let (stiffness, coupling) = (entry(first, first), entry(first, second));
    let same = |a: f64, b: f64| (a - b).abs() <= SAME * stiffness.abs();
    let is_isotropic =
        direct.iter().all(|&i| direct.iter().all(|&j| same(entry(i, j), if i == j { stiffness } else { coupling })));
    let twice_mu = stiffness - coupling;
    let is_doubled = !shears.is_empty() && shears.iter().all(|&k| same(entry(k, k), twice_mu));
    if is_isotropic && is_doubled && twice_mu > 0.0 {
        let detail = format!(
            "at the start d(stress)/d(shear) = {:.6e} is twice that of an isotropic law, (C11 - C12)/2 = {:.6e}: 2 mu in place of \
             mu? STRAN and DSTRAN have engineering shears, gamma = 2 epsilon",
            entry(shears[0], shears[0]),
            0.5 * twice_mu
        );
        ledger.add(Verdict::Warn, "2.0", detail);
    }
}

/// Returns the factor α with DDSDDE = unloading + α (derivative − unloading), if such a factor explains the difference between
/// DDSDDE and the derivative.
fn loading_factor(tangent: &[f64], unloading: &[f64], derivative: &[f64]) -> Option<f64> {
    let loading: Vec<f64> = derivative.iter().zip(unloading).map(|(d, u)| d - u).collect();
    let found: Vec<f64> = tangent.iter().zip(unloading).map(|(t, u)| t - u).collect();
    let square: f64 = loading.iter().map(|x| x * x).sum();
    let factor = loading.iter().zip(&found).map(|(x, y)| x * y).sum::<f64>() / square;
    let rest: f64 = loading.iter().zip(&found).map(|(x, y)| (y - factor * x).powi(2)).sum();
    let mismatch: f64 = loading.iter().zip(&found).map(|(x, y)| (y - x).powi(2)).sum();
    (rest < 1e-4 * square && rest < 1e-2 * mismatch).then_some(factor)
}

/// C_ij = C_ji as claimed, or how far from it.
pub(super) fn symmetry(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("symmetric tangent");
    let n = subject.entry.outputs();
    if n != subject.entry.inputs() {
        return;
    }
    let mut worst = (0.0_f64, String::new());
    for state in sample {
        let Ok(answer) = subject.evaluate(&state.from, &state.step) else { continue };
        let transposed: Vec<f64> = (0..n * n).map(|k| answer.tangent[(k % n) * n + k / n]).collect();
        let error = distance(&answer.tangent, &transposed) / largest(&answer.tangent).max(f64::MIN_POSITIVE);
        if error > worst.0 {
            worst = (error, state.to_string());
        }
    }
    let (figure, symmetric) = (format!("{:.1e}", worst.0), worst.0 <= SYMMETRY);
    match (subject.claims(flags::SYMMETRIC_TANGENT), symmetric) {
        (true, true) => ledger.add(Verdict::Pass, figure, ""),
        (true, false) => {
            ledger.add(Verdict::Fail, figure, format!("claimed; {}", worst.1));
        }
        (false, true) => ledger.add(Verdict::Info, figure, "symmetric, though not claimed"),
        (false, false) => ledger.add(Verdict::Info, figure, "not claimed"),
    }
}

#[cfg(test)]
mod test;

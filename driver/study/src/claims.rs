//! Claims that hold, fail or are undecided, with the figures.
//!
//! A number that is not known, because its run failed or was not run, can neither confirm nor refute. A claim is refuted
//! by one known counterexample, whatever else is unknown; it is confirmed only if everything is known.

use super::results::Results;
use super::{Claim, NamedQuantity, Quantity, Study};
use pullout_case::study::{Direction, Expectation};
use pullout_report::compare::Branch;
use pullout_report::plots::quantity::Quantity as Shown;
use pullout_run::number::significant;
use serde::Serialize;

#[cfg(test)]
mod test;

/// Verdict on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Verdict {
    /// The claim holds.
    #[serde(rename = "found")]
    Holds,
    /// The claim fails: there is a counterexample.
    #[serde(rename = "not found")]
    Fails,
    /// The claim is undecided: runs failed or were not run.
    #[serde(rename = "cannot be told")]
    Undecided,
}

impl Verdict {
    /// Returns the verdict for readers. Files keep the spelling that scripts know.
    pub fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Fails => "fails",
            Self::Undecided => "undecided",
        }
    }

    /// Joins several answers, all of which must be yes.
    fn of(answers: impl IntoIterator<Item = Option<bool>>) -> Self {
        answers.into_iter().fold(Self::Holds, |verdict, answer| match (verdict, answer) {
            (Self::Fails, _) | (_, Some(false)) => Self::Fails,
            (_, None) => Self::Undecided,
            (verdict, Some(true)) => verdict,
        })
    }
}

/// Outcome of a claim.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimFinding {
    /// Text of the claim.
    pub claim: String,
    /// Whether it was found.
    pub verdict: Verdict,
    /// Statement that was tested.
    pub expected: String,
    /// The numbers, series by series.
    pub figures: Vec<String>,
}

/// Tests all claims.
pub fn test_all(study: &Study, results: &Results) -> Vec<ClaimFinding> {
    study.claims.iter().map(|claim| Tested { study, results, claim }.finding()).collect()
}

/// A claim with all that it is tested with.
struct Tested<'a> {
    study: &'a Study,
    results: &'a Results,
    claim: &'a Claim,
}

impl Tested<'_> {
    fn finding(&self) -> ClaimFinding {
        let mut answers = Vec::new();
        let mut figures = Vec::new();
        for &series in &self.claim.series {
            let (own, text) = self.in_series(series);
            answers.extend(own);
            let title = &self.study.series[series].title;
            figures.push(if title.is_empty() { text } else { format!("{title}: {text}") });
        }
        ClaimFinding {
            claim: self.claim.claim.clone(),
            verdict: Verdict::of(answers),
            expected: self.expected(),
            figures,
        }
    }

    fn value(&self, series: usize, member: usize) -> Option<f64> {
        self.results.runs[self.study.run_of(series, member)].value(&self.claim.quantity, &self.study.curve)
    }

    fn title(&self, member: usize) -> &str {
        &self.study.members[member].title
    }

    /// The answers in one series, and the numbers.
    fn in_series(&self, series: usize) -> (Vec<Option<bool>>, String) {
        let members = &self.claim.members;
        let values: Vec<Option<f64>> = members.iter().map(|&member| self.value(series, member)).collect();
        let listed = |words: &dyn Fn(usize) -> String| {
            let texts: Vec<String> =
                (0..members.len()).map(|k| format!("{} {}", self.title(members[k]), words(k))).collect();
            texts.join(", ")
        };
        let numbers = || listed(&|k| number(values[k]));
        match self.claim.expectation {
            Expectation::Trend { trend, tolerance } => {
                let greatest = values.iter().flatten().map(|value| value.abs()).fold(0.0, f64::max);
                let sign = if trend == Direction::Increasing { 1.0 } else { -1.0 };
                // what is known is compared across what is not
                let known: Vec<f64> = values.iter().copied().flatten().collect();
                let tolerance = tolerance.unwrap_or(0.0);
                let slack = tolerance * greatest;
                let goes = |pair: &[f64]| {
                    let step = sign * (pair[1] - pair[0]);
                    Some(if tolerance > 0.0 { step >= -slack } else { step > 0.0 })
                };
                let unknown = values.iter().filter(|value| value.is_none()).map(|_| None);
                (known.windows(2).map(goes).chain(unknown).collect(), numbers())
            }
            Expectation::Maximum { maximum_at: at } => (self.extreme(series, at, 1.0), numbers()),
            Expectation::MaximumBetween { maximum_between } => {
                let is_inside = |k: usize| self.study.members[members[k]].is_between(maximum_between);
                let (inside, outside): (Vec<usize>, Vec<usize>) = (0..members.len()).partition(|&k| is_inside(k));
                let known: Option<Vec<f64>> = inside.into_iter().map(|k| values[k]).collect();
                let best = known.map(|known| known.into_iter().fold(f64::NEG_INFINITY, f64::max));
                (outside.into_iter().map(|k| Some(best? > values[k]?)).collect(), numbers())
            }
            Expectation::Minimum { minimum_at: at } => (self.extreme(series, at, -1.0), numbers()),
            Expectation::Within { within, of } => {
                let reference = self.value(series, of);
                let near = |value: Option<f64>| Some((value? - reference?).abs() <= within.0 * reference?.abs());
                let away = |k: usize| {
                    let share = values[k].zip(reference).filter(|_| members[k] != of).map(|(v, r)| v / r - 1.0);
                    share.map_or(String::new(), |share| format!(" ({})", percent(share)))
                };
                let text = listed(&|k| number(values[k]) + &away(k));
                (values.iter().map(|&value| near(value)).collect(), text)
            }
            Expectation::Curve { curve_within, of } => {
                let distances: Vec<Option<(f64, f64)>> =
                    members.iter().map(|&member| self.curve_distance(series, member, of)).collect();
                let text = listed(&|k| match distances[k] {
                    Some((share, end)) => format!("{} up to {}", percent(share), significant(end, 4)),
                    None => number(None),
                });
                (distances.into_iter().map(|distance| Some(distance?.0 <= curve_within.0)).collect(), text)
            }
            Expectation::Above { above: other } => self.against(series, other, 1.0),
            Expectation::Below { below: other } => self.against(series, other, -1.0),
            Expectation::Ratio { ratio_of: of, to, greater_than, less_than } => {
                let ratio = self.value(series, of).zip(self.value(series, to)).map(|(a, b)| a / b);
                let text = format!("{} / {} = {}", self.title(of), self.title(to), number(ratio));
                (vec![ratio.map(|ratio| lies(ratio, greater_than, less_than))], text)
            }
            Expectation::OverSeries { over_series: other, greater_than, less_than } => {
                let theirs = members.iter().map(|&member| self.value(other, member));
                let ratios: Vec<Option<f64>> =
                    values.iter().zip(theirs).map(|(own, theirs)| Some((*own)? / theirs?)).collect();
                let answers = ratios.iter().map(|ratio| Some(lies((*ratio)?, greater_than, less_than))).collect();
                (answers, listed(&|k| number(ratios[k])))
            }
            Expectation::Bounds { greater_than, less_than } => {
                let lies = |value: &Option<f64>| Some(lies((*value)?, greater_than, less_than));
                (values.iter().map(lies).collect(), numbers())
            }
            Expectation::Done { done } => {
                let result = |k: usize| &self.results.runs[self.study.run_of(series, members[k])];
                let answers = (0..members.len()).map(|k| result(k).status.map(|_| result(k).is_done() == done));
                let words = |k: usize| match (result(k).status, result(k).reach) {
                    (None, _) => "was not run".to_owned(),
                    (Some(_), reach) => {
                        let how = if result(k).is_done() { "done" } else { "failed" };
                        format!("{how}, to {}", number(reach))
                    }
                };
                (answers.collect(), listed(&words))
            }
        }
    }

    /// Returns whether each other member's number is less (`sign` 1) or greater (−1) than that of `at`.
    fn extreme(&self, series: usize, at: usize, sign: f64) -> Vec<Option<bool>> {
        let best = self.value(series, at);
        let others = self.claim.members.iter().filter(|&&member| member != at);
        others.map(|&member| Some(sign * best? > sign * self.value(series, member)?)).collect()
    }

    /// Against the same members of another series.
    fn against(&self, series: usize, other: usize, sign: f64) -> (Vec<Option<bool>>, String) {
        let pairs = || self.claim.members.iter().map(|&m| (m, self.value(series, m), self.value(other, m)));
        let answers = pairs().map(|(_, own, theirs)| Some(sign * own? > sign * theirs?)).collect();
        let texts = pairs().map(|(m, own, theirs)| format!("{} {} / {}", self.title(m), number(own), number(theirs)));
        let title = &self.study.series[other].title;
        (answers, format!("{} (against {title})", texts.collect::<Vec<_>>().join(", ")))
    }

    /// The area between a member's curve and that of another over the area below the other, and up to where they were
    /// compared: the shorter of their first stretches without a turn of x. Not the greatest difference of ordinates: on a
    /// steep branch that is the chord of the histories' lines.
    fn curve_distance(&self, series: usize, member: usize, of: usize) -> Option<(f64, f64)> {
        let curve = |member: usize| {
            let result = &self.results.runs[self.study.run_of(series, member)];
            result.is_done().then(|| result.curve(&self.study.curve))
        };
        let (own, theirs) = (curve(member)?, curve(of)?);
        let (own_x, own_y): (Vec<f64>, Vec<f64>) = own.into_iter().unzip();
        let (their_x, their_y): (Vec<f64>, Vec<f64>) = theirs.into_iter().unzip();
        let (own, theirs) = (Branch::first(&own_x, &own_y), Branch::first(&their_x, &their_y));
        let mut x: Vec<f64> = own_x.iter().chain(&their_x).copied().collect();
        x.sort_unstable_by(|a, b| a.abs().total_cmp(&b.abs()));
        let both: Vec<[f64; 3]> = x.into_iter().filter_map(|x| Some([x, own.at(x)?, theirs.at(x)?])).collect();
        let (mut between, mut below) = (0.0, 0.0);
        for ends in both.windows(2) {
            let [[a, own_a, their_a], [b, own_b, their_b]] = [ends[0], ends[1]];
            let mean = |start: f64, end: f64| 0.5 * (start.abs() + end.abs()) * (b - a).abs();
            between += mean(own_a - their_a, own_b - their_b);
            below += mean(their_a, their_b);
        }
        let share = between / below;
        share.is_finite().then_some((share, both.last()?[0]))
    }

    /// Returns what is looked for.
    fn expected(&self) -> String {
        let what = self.quantity();
        let bounds = |lower: Option<f64>, upper: Option<f64>| {
            let lower = lower.map(|bound| format!("> {}", significant(bound, 6)));
            let upper = upper.map(|bound| format!("< {}", significant(bound, 6)));
            [lower, upper].into_iter().flatten().collect::<Vec<_>>().join(" and ")
        };
        match self.claim.expectation {
            Expectation::Trend { trend, tolerance } => {
                let tolerance = tolerance.unwrap_or(0.0);
                let way = if trend == Direction::Increasing { "increasing" } else { "decreasing" };
                let slack = if tolerance > 0.0 { format!(", tolerance {}", percent(tolerance)) } else { String::new() };
                format!("{what} {way}{slack}")
            }
            Expectation::Maximum { maximum_at: at } => format!("{what} greatest at {}", self.title(at)),
            Expectation::MaximumBetween { maximum_between: [lower, upper] } => {
                format!("{what} greatest strictly between {} and {}", significant(lower, 6), significant(upper, 6))
            }
            Expectation::Minimum { minimum_at: at } => format!("{what} least at {}", self.title(at)),
            Expectation::Within { within, of } => {
                format!("{what} within {} of that at {}", percent(within.0), self.title(of))
            }
            Expectation::Curve { curve_within, of } => {
                format!(
                    "area between curves within {} of that below the curve at {}",
                    percent(curve_within.0),
                    self.title(of)
                )
            }
            Expectation::Above { above: other } => format!("{what} above {}", self.study.series[other].title),
            Expectation::Below { below: other } => format!("{what} below {}", self.study.series[other].title),
            Expectation::Ratio { ratio_of: of, to, greater_than, less_than } => {
                let bounds = bounds(greater_than, less_than);
                format!("{what} at {} over that at {} {bounds}", self.title(of), self.title(to))
            }
            Expectation::OverSeries { over_series: series, greater_than, less_than } => {
                let bounds = bounds(greater_than, less_than);
                format!("{what} over that of {} {bounds}", self.study.series[series].title)
            }
            Expectation::Bounds { greater_than, less_than } => format!("{what} {}", bounds(greater_than, less_than)),
            Expectation::Done { done: true } => "runs to the end".into(),
            Expectation::Done { done: false } => "does not run to the end".into(),
        }
    }

    /// Name of the quantity, with its unit.
    fn quantity(&self) -> String {
        let [x_unit, y_unit] = &self.study.units;
        let with = |name: &str, unit: &str| if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") };
        match &self.claim.quantity {
            Quantity::Named(NamedQuantity::Peak) => with("peak", y_unit),
            Quantity::Named(NamedQuantity::SlipAtPeak) => with(&format!("{} at the peak", self.study.curve.x), x_unit),
            Quantity::Named(NamedQuantity::Work) => {
                let end = self.results.work_to.map_or(String::new(), |end| format!(" up to {}", significant(end, 4)));
                with(&format!("work{end}"), &work_unit(self.study))
            }
            Quantity::Named(NamedQuantity::End) => with(&format!("last {}", self.study.curve.y), y_unit),
            Quantity::Named(NamedQuantity::Increments) => "increments".into(),
            Quantity::Named(NamedQuantity::Iterations) => "iterations".into(),
            Quantity::Named(NamedQuantity::Cutbacks) => "cutbacks".into(),
            Quantity::Named(NamedQuantity::EnergyErrorMax) => "greatest energy error".into(),
            Quantity::Named(NamedQuantity::CpuTime) => "CPU time [s]".into(),
            Quantity::Column(value) => {
                use pullout_case::study::{NamedPlace, Where};
                let column = &value.column;
                let place = match value.at() {
                    Where::Named(NamedPlace::End) => "at the end".into(),
                    Where::Named(NamedPlace::Peak) => "at the peak".into(),
                    Where::Named(NamedPlace::Greatest) => "at its greatest".into(),
                    Where::Named(NamedPlace::Least) => "at its least".into(),
                    Where::X(x) => format!("at {} = {}", self.study.curve.x, significant(x, 4)),
                };
                match value.over() {
                    [] => with(&format!("{column} {place}"), &Shown::of(column, &Default::default()).unit),
                    over => format!("{column}/({}) {place}", over.join(" + ")),
                }
            }
        }
    }
}

/// Unit of the area below the study's curve.
pub(super) fn work_unit(study: &Study) -> String {
    let [x, y] = &study.units;
    match (x.as_str(), y.as_str()) {
        ("", y) => y.to_owned(),
        (x, "") => x.to_owned(),
        (x, y) => format!("{y}·{x}"),
    }
}

fn lies(value: f64, greater_than: Option<f64>, less_than: Option<f64>) -> bool {
    greater_than.is_none_or(|bound| value > bound) && less_than.is_none_or(|bound| value < bound)
}

fn number(value: Option<f64>) -> String {
    value.map_or("?".into(), |value| significant(value, 5))
}

fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 3))
}

use super::super::{Columns, Member, RunResult, RunSeries, StudyRun};
use super::*;
use pullout_case::Positive;
use pullout_case::study::{ColumnValue, NamedPlace, OneOrMany, Where};
use pullout_report::history::History;
use pullout_report::summary::Status;

/// Curves y = peak·(1 − (1 − x)²) to x = 1; `None`: a run that failed.
fn study(peaks: &[&[Option<f64>]]) -> (Study, Results) {
    let members: Vec<Member> = (0..peaks[0].len())
        .map(|k| Member { label: format!("m{k}"), title: format!("m{k}"), x: Some(10.0 * k as f64) })
        .collect();
    let series = |k: usize| RunSeries { name: format!("s{k}"), title: format!("s{k}") };
    let runs = (0..peaks.len() * members.len()).map(|k| StudyRun {
        series: k / members.len(),
        member: k % members.len(),
        case: pullout_engine::CaseSource::default(),
        folder: "folder".into(),
        fingerprint: String::new(),
        warnings: Vec::new(),
    });
    let result = |peak: &Option<f64>| {
        let x: Vec<f64> = (0..=10).map(|k| 0.1 * f64::from(k)).collect();
        let y: Vec<f64> = x.iter().map(|x| peak.unwrap_or(0.0) * (1.0 - (1.0 - x) * (1.0 - x))).collect();
        let open = x.iter().map(|x| 4.0 * x).collect();
        let all = vec![8.0; x.len()];
        let columns = [("slip", x), ("load", y), ("open", open), ("all", all)];
        RunResult {
            status: Some(if peak.is_some() { Status::Done } else { Status::Failed }),
            history: History::from_columns(columns.map(|(name, values)| (name.to_owned(), values)).into()),
            peak: *peak,
            ..RunResult::default()
        }
    };
    let results = Results { runs: peaks.iter().flat_map(|row| row.iter()).map(result).collect(), work_to: Some(1.0) };
    let study = Study {
        file: "study.json".into(),
        title: "study".into(),
        description: String::new(),
        x: None,
        series: (0..peaks.len()).map(series).collect(),
        runs: runs.collect(),
        curve: Columns { x: "slip".into(), y: "load".into() },
        units: ["mm".into(), "N".into()],
        work_to: None,
        overlays: Vec::new(),
        claims: Vec::new(),
        demands: Vec::new(),
        members,
    };
    (study, results)
}

fn verdict(peaks: &[&[Option<f64>]], members: &[usize], expectation: Expectation) -> (Verdict, Vec<String>) {
    let quantity = Quantity::Named(NamedQuantity::Peak);
    of_quantity(peaks, members, quantity, expectation)
}

fn of_quantity(
    peaks: &[&[Option<f64>]],
    members: &[usize],
    quantity: Quantity,
    expectation: Expectation,
) -> (Verdict, Vec<String>) {
    let (study, results) = study(peaks);
    let claim = Claim { claim: "it is".into(), series: vec![0], members: members.to_vec(), quantity, expectation };
    let finding = Tested { study: &study, results: &results, claim: &claim }.finding();
    (finding.verdict, finding.figures)
}

const FAILED: Option<f64> = None;

fn trend(tolerance: f64) -> Expectation {
    Expectation::Trend { trend: Direction::Increasing, tolerance: Some(tolerance) }
}

#[test]
fn a_trend_is_refuted_by_one_step_and_kept_open_by_a_run_that_failed() {
    let all = [0, 1, 2];
    for (peaks, tolerance, expected) in [
        ([Some(1.0), Some(2.0), Some(3.0)], 0.0, Verdict::Holds),
        ([Some(1.0), Some(3.0), Some(2.0)], 0.0, Verdict::Fails),
        ([Some(1.0), Some(1.0), Some(2.0)], 0.0, Verdict::Fails),
        ([Some(1.0), Some(2.0), Some(1.95)], 0.05, Verdict::Holds),
        ([Some(1.0), FAILED, Some(2.0)], 0.0, Verdict::Undecided),
        ([Some(2.0), FAILED, Some(1.0)], 0.0, Verdict::Fails),
        ([FAILED, FAILED, FAILED], 0.0, Verdict::Undecided),
    ] {
        assert_eq!(verdict(&[&peaks], &all, trend(tolerance)).0, expected, "{peaks:?} {tolerance}");
    }
    let falling = Expectation::Trend { trend: Direction::Decreasing, tolerance: None };
    assert_eq!(verdict(&[&[Some(3.0), Some(2.0)]], &[0, 1], falling).0, Verdict::Holds);
}

#[test]
fn an_extreme_is_greater_than_all_others() {
    let peaks = [Some(1.0), Some(3.0), Some(2.0)];
    assert_eq!(verdict(&[&peaks], &[0, 1, 2], Expectation::Maximum { maximum_at: 1 }).0, Verdict::Holds);
    assert_eq!(verdict(&[&peaks], &[0, 1, 2], Expectation::Maximum { maximum_at: 2 }).0, Verdict::Fails);
    assert_eq!(verdict(&[&peaks], &[0, 1, 2], Expectation::Minimum { minimum_at: 0 }).0, Verdict::Holds);
    let open = [Some(1.0), Some(3.0), FAILED];
    assert_eq!(verdict(&[&open], &[0, 1, 2], Expectation::Maximum { maximum_at: 1 }).0, Verdict::Undecided);
    assert_eq!(verdict(&[&open], &[0, 1, 2], Expectation::Maximum { maximum_at: 0 }).0, Verdict::Fails);
}

#[test]
fn a_maximum_between_two_values_of_x_is_at_neither_end() {
    let all = [0, 1, 2, 3];
    let between = |lower, upper| Expectation::MaximumBetween { maximum_between: [lower, upper] };
    for (peaks, range, expected) in [
        ([Some(1.0), Some(2.0), Some(3.0), Some(2.5)], [0.0, 30.0], Verdict::Holds),
        ([Some(1.0), Some(2.0), Some(3.0), Some(2.5)], [20.0, 40.0], Verdict::Fails),
        ([Some(1.0), Some(2.0), Some(3.0), Some(3.5)], [0.0, 30.0], Verdict::Fails),
        ([Some(1.0), Some(2.0), Some(3.0), Some(3.0)], [0.0, 30.0], Verdict::Fails),
        ([Some(1.0), FAILED, Some(3.0), Some(3.5)], [0.0, 30.0], Verdict::Undecided),
        ([Some(1.0), Some(2.0), Some(3.0), FAILED], [0.0, 30.0], Verdict::Undecided),
        ([Some(4.0), Some(2.0), Some(3.0), FAILED], [0.0, 30.0], Verdict::Fails),
    ] {
        let [lower, upper] = range;
        assert_eq!(verdict(&[&peaks], &all, between(lower, upper)).0, expected, "{peaks:?} {range:?}");
    }
}

#[test]
fn nearness_is_relative_and_given_in_per_cent() {
    let peaks = [Some(1.01), Some(1.0)];
    let within = |tolerance| Expectation::Within { within: Positive(tolerance), of: 1 };
    let (found, figures) = verdict(&[&peaks], &[0, 1], within(0.011));
    assert_eq!((found, figures[0].as_str()), (Verdict::Holds, "s0: m0 1.01 (1 %), m1 1"));
    assert_eq!(verdict(&[&peaks], &[0, 1], within(0.009)).0, Verdict::Fails);
    // proportional curves: the area between them has the same share
    let curve = |tolerance| Expectation::Curve { curve_within: Positive(tolerance), of: 1 };
    assert_eq!(verdict(&[&peaks], &[0], curve(0.0101)).0, Verdict::Holds);
    assert_eq!(verdict(&[&peaks], &[0], curve(0.0099)).0, Verdict::Fails);
    assert_eq!(verdict(&[&[FAILED, Some(1.0)]], &[0], curve(1.0)).0, Verdict::Undecided);
}

#[test]
fn series_are_compared_member_by_member() {
    let [low, high] = [[Some(2.0), Some(2.0)], [Some(1.0), Some(3.0)]];
    assert_eq!(verdict(&[&low, &high], &[0], Expectation::Above { above: 1 }).0, Verdict::Holds);
    assert_eq!(verdict(&[&low, &high], &[0, 1], Expectation::Above { above: 1 }).0, Verdict::Fails);
    assert_eq!(verdict(&[&low, &high], &[1], Expectation::Below { below: 1 }).0, Verdict::Holds);
    let over =
        |less_than| Expectation::OverSeries { over_series: 1, greater_than: Some(0.5), less_than: Some(less_than) };
    assert_eq!(verdict(&[&low, &high], &[0, 1], over(2.1)).0, Verdict::Holds);
    assert_eq!(verdict(&[&low, &high], &[0, 1], over(1.9)).0, Verdict::Fails);
}

#[test]
fn ratios_bounds_and_ends() {
    let peaks = [Some(2.0), Some(3.0), FAILED];
    let ratio = |to| Expectation::Ratio { ratio_of: 1, to, greater_than: Some(1.4), less_than: Some(1.6) };
    let (found, figures) = verdict(&[&peaks], &[0, 1], ratio(0));
    assert_eq!((found, figures[0].as_str()), (Verdict::Holds, "s0: m1 / m0 = 1.5"));
    assert_eq!(verdict(&[&peaks], &[0, 1], ratio(1)).0, Verdict::Fails);
    assert_eq!(verdict(&[&peaks], &[0, 1], ratio(2)).0, Verdict::Undecided);
    let bounds = Expectation::Bounds { greater_than: Some(2.0), less_than: None };
    assert_eq!(verdict(&[&peaks], &[1], bounds.clone()).0, Verdict::Holds);
    assert_eq!(verdict(&[&peaks], &[0], bounds).0, Verdict::Fails);
    assert_eq!(verdict(&[&peaks], &[0, 1], Expectation::Done { done: true }).0, Verdict::Holds);
    assert_eq!(verdict(&[&peaks], &[0, 1, 2], Expectation::Done { done: true }).0, Verdict::Fails);
    assert_eq!(verdict(&[&peaks], &[2], Expectation::Done { done: false }).0, Verdict::Holds);
}

#[test]
fn columns_are_looked_up_where_the_claim_says() {
    let at = |place: Where, over: &[&str]| {
        let over = OneOrMany::Many(over.iter().map(|name| (*name).to_owned()).collect());
        Quantity::Column(ColumnValue { column: "open".into(), at: Some(place), over: Some(over) })
    };
    let lies = |value: f64| Expectation::Bounds { greater_than: Some(value - 1e-12), less_than: Some(value + 1e-12) };
    for (quantity, value) in [
        (at(Where::Named(NamedPlace::End), &[]), 4.0),
        (at(Where::Named(NamedPlace::Peak), &["all"]), 0.5),
        (at(Where::Named(NamedPlace::Least), &[]), 0.0),
        (at(Where::X(0.5), &["all", "all"]), 0.125),
    ] {
        let (found, figures) = of_quantity(&[&[Some(1.0)]], &[0], quantity.clone(), lies(value));
        assert_eq!(found, Verdict::Holds, "{quantity:?}: {figures:?}");
    }
}

//! `pullout fit CASE`: the numbers of any case by which its curve is nearest to a measured one.
//!
//! Least squares ([`search`]) from the values of the case and from others between the bounds: the best end counts. Bounds are kept
//! by what is sought instead of the numbers: z with x = lo + (hi − lo)(1 + sin z)/2.

use super::doubt::doubts;
use super::output::{MOST_MARKS, rows_of, standard_error, table};
use super::search::{self, Best, Increments, STEP, Search, Simulation, root_mean_square};
use super::specimen::make_absolute;
use levenberg_marquardt::LevenbergMarquardt;
use nalgebra::{DMatrix, DVector};
use pullout_bridging::{Estimate, estimates};
use pullout_case::CsvFile;
use pullout_engine::{Outcome, Source};
use pullout_report::compare::Turns;
use pullout_report::directory::ResultDirectory;
use pullout_report::plots;
use pullout_report::plots::figure::{Figure, Line, Marks};
use pullout_report::plots::quantity::Quantity;
use pullout_run::input::folder_of;
use pullout_run::number::significant;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io;
use std::path::PathBuf;

mod report;

/// The search ends when the sum of squares would fall, or what is sought would move, by less than this part.
const SMALLEST: f64 = 1e-10;
/// A start on a bound moves inwards by this part of the distance of the bounds: on them nothing has a slope.
const INWARDS: f64 = 0.01;
/// Data so little outside a run, as a part of their distance from its beginning, are at its end: they were rounded.
const ROUNDING: f64 = 1e-9;
/// Differences so small, as a part of the greatest value of the data, are what rounding leaves: nothing better is sought.
const AT_ROUNDING: f64 = 1e-6;
/// Ends of searches whose root mean squares differ by less than this part are the same.
const SAME_END: f64 = 1e-3;
/// Bounds that are further apart than this ratio are searched by orders of magnitude.
const WIDE: f64 = 10.0;
/// A number so near to a bound, as a part of the distance of the bounds, lies on it.
const ON_BOUND: f64 = 1e-6;

/// A number of a case that is sought.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    /// Place, as `--set` has it.
    pub path: String,
    /// Bounds of the value.
    pub bounds: [f64; 2],
}

/// Numbers of a case to be fitted, and the curve that they are fitted to.
#[derive(Clone, Debug)]
pub struct CaseRequest {
    /// The case with its values to start from.
    pub source: Source,
    /// Numbers that are sought.
    pub free: Vec<Free>,
    /// The measured curve.
    pub data: PathBuf,
    /// Columns of the history that it is compared with.
    pub curve: [String; 2],
    /// Most places that it is searched from, the values of the case first.
    pub starts: usize,
    /// Most runs of all searches.
    pub max_runs: usize,
}

/// Result of a search.
#[derive(Clone, Debug)]
pub struct CaseFit {
    /// Numbers that were sought.
    pub free: Vec<Free>,
    /// Values from which the search began.
    pub starts: Vec<f64>,
    /// The numbers that fit best.
    pub estimates: Vec<Estimate>,
    /// Correlation of the numbers.
    pub correlation: DMatrix<f64>,
    /// Root mean square of the differences, in the unit of the curve.
    pub rms: f64,
    /// Places that it was searched from, and how many of these searches ended here.
    pub searches: [usize; 2],
    /// Runs that were made.
    pub runs: usize,
    /// Reason why it is not the best.
    pub trouble: Option<String>,
    /// Warnings: facts that the user should know although nothing is wrong.
    pub warnings: Vec<String>,
    /// The case with these numbers.
    pub case: Value,
    /// Data: both columns, and what the case computes.
    pub rows: Vec<[f64; 3]>,
}

/// Fits a case. `progress` is told the runs so far and the root mean square of the differences.
///
/// # Errors
/// Everything that is wrong with the input, one sentence each.
pub fn fit_case(request: &CaseRequest, progress: &dyn Fn(usize, f64)) -> Result<CaseFit, Vec<String>> {
    let document = document(request)?;
    let starts = starts(request, &document)?;
    // read once, with its overrides: what is written into the file from now on changes nothing
    let request = &CaseRequest {
        source: Source { document: Some(document.clone()), overrides: Vec::new(), ..request.source.clone() },
        ..request.clone()
    };
    let data = read_data(request)?;
    let file = request.source.file.display();
    let scale = data.iter().fold(0.0_f64, |greatest, row| greatest.max(row[1].abs()));
    let fitted = Fitted { request, data: &data, scale };
    let mut problem = Search::new(&fitted, request.max_runs, 0, progress);
    let bounds: Vec<[f64; 2]> = request.free.iter().map(|free| free.bounds).collect();
    let mut ends: Vec<(Best<Computed>, Option<String>)> = Vec::new();
    let mut searches = 0;
    while searches < request.starts.max(1) && (searches == 0 || problem.may_run(1 + starts.len())) {
        let start = if searches == 0 { starts.clone() } else { place_between(&bounds, searches) };
        searches += 1;
        let sought: Vec<f64> = start.iter().zip(&request.free).map(|(value, free)| free.sought(*value)).collect();
        match problem.begin(&sought) {
            Err(message) if searches == 1 => return Err(vec![format!("{file}: {message}")]),
            Err(_) => continue,
            Ok(()) => {}
        }
        let method = LevenbergMarquardt::new().with_ftol(SMALLEST).with_xtol(SMALLEST);
        let trouble;
        (problem, trouble) = problem.search(method);
        ends.extend(problem.best.take().map(|best| (best, trouble)));
        if ends.iter().any(|(best, _)| fitted.rms(&best.run) <= AT_ROUNDING * scale) {
            break;
        }
    }
    let rms = |(best, _): &(Best<Computed>, Option<String>)| fitted.rms(&best.run);
    let least = ends.iter().map(rms).fold(f64::INFINITY, f64::min);
    let is_same = |end: &&(Best<Computed>, _)| rms(end) <= least * (1.0 + SAME_END) + AT_ROUNDING * scale;
    let searches = [searches, ends.iter().filter(is_same).count()];
    let Some((best, trouble)) = ends.into_iter().find(|end| rms(end) <= least) else {
        return Err(vec![format!("{file}: no run gives a curve")]);
    };
    let values = fitted.values(&best.coordinates);
    problem.count_beside();
    let derivatives = fitted.slopes(&values, &best.run);
    let trouble = trouble.or_else(|| derivatives.as_ref().err().cloned());
    // relative changes of the numbers, so that all are of one size
    let sizes = DMatrix::from_diagonal(&DVector::from_iterator(values.len(), values.iter().map(|&value| size(value))));
    let residuals = fitted.differences(&best.run) * scale;
    let unknown = |&value: &f64| Estimate { value, standard_error: f64::INFINITY };
    let (estimates, correlation) = match derivatives {
        Ok(derivatives) => estimates(&values, residuals.as_slice(), &(derivatives * &sizes), &[], &sizes),
        Err(_) => (values.iter().map(unknown).collect(), DMatrix::identity(values.len(), values.len())),
    };
    let doubts = doubts(&[], [("", least / scale)]);
    let rows = data.iter().zip(&best.run.curve).map(|(row, computed)| [row[0], row[1], *computed]).collect();
    Ok(CaseFit {
        free: request.free.clone(),
        starts,
        estimates,
        correlation,
        rms: least,
        searches,
        runs: problem.runs(),
        trouble,
        warnings: best.run.warning.into_iter().chain(doubts).collect(),
        case: kept(request, document, &values),
        rows,
    })
}

/// Place `number`, from 1, of a sequence that fills what lies between the bounds evenly: multiples of powers of 1/φ with
/// φ^(n + 1) = φ + 1 for n numbers, the golden ratio of one (M. Roberts, 2018).
pub fn place_between(bounds: &[[f64; 2]], number: usize) -> Vec<f64> {
    let ratio = (0..64).fold(2.0_f64, |ratio, _| (1.0 + ratio).powf(1.0 / (bounds.len() as f64 + 1.0)));
    let place = |(k, &[low, high]): (usize, &[f64; 2])| {
        let part = (0.5 + number as f64 * ratio.powi(-(k as i32 + 1))).fract();
        if low > 0.0 && high > WIDE * low { low * (high / low).powf(part) } else { low + part * (high - low) }
    };
    bounds.iter().enumerate().map(place).collect()
}

fn size(value: f64) -> f64 {
    if value == 0.0 { 1.0 } else { value.abs() }
}

impl Free {
    /// `PATH=lo:hi`.
    ///
    /// # Errors
    /// Problem with the text.
    pub fn parse(text: &str) -> Result<Self, String> {
        let form = || "write PATH=lo:hi, e.g. material.props.E=1e4:4e4".to_owned();
        let (path, bounds) = text.rsplit_once('=').ok_or_else(form)?;
        let (low, high) = bounds.split_once(':').ok_or_else(form)?;
        let path = pullout_case::dotted(path);
        if path.split('.').any(str::is_empty) {
            return Err("an empty name in the path: write a.b.c=lo:hi".into());
        }
        let number = |text: &str| {
            let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| format!("'{text}' is not a finite number: {}", form()))
        };
        let bounds = [number(low)?, number(high)?];
        if bounds[0] >= bounds[1] {
            return Err(format!("{} is not below {}", bounds[0], bounds[1]));
        }
        Ok(Self { path, bounds })
    }

    fn value(&self, sought: f64) -> f64 {
        let [low, high] = self.bounds;
        (low + (high - low) * 0.5 * (1.0 + sought.sin())).clamp(low, high)
    }

    fn sought(&self, value: f64) -> f64 {
        let [low, high] = self.bounds;
        (2.0 * (value - low) / (high - low) - 1.0).clamp(-1.0, 1.0).asin()
    }

    /// The bound that a value lies on.
    fn bound(&self, value: f64) -> Option<f64> {
        let near = ON_BOUND * (self.bounds[1] - self.bounds[0]);
        self.bounds.into_iter().find(|bound| (bound - value).abs() <= near)
    }
}

fn document(request: &CaseRequest) -> Result<Value, Vec<String>> {
    let Source { file, overrides, plugin_paths, .. } = &request.source;
    let name = file.display();
    if request.source.need().is_none() {
        pullout_case::read(file, overrides, plugin_paths)
            .map_err(|errors| errors.problems.iter().map(|problem| format!("{name}: {problem}")).collect::<Vec<_>>())?;
    }
    request.source.text().ok_or_else(|| vec![format!("{name}: is no case")])
}

/// The values that the case has.
fn starts(request: &CaseRequest, document: &Value) -> Result<Vec<f64>, Vec<String>> {
    let mut problems = Vec::new();
    let mut starts = Vec::new();
    let file = request.source.file.display();
    for (k, Free { path, bounds: [low, high] }) in request.free.iter().enumerate() {
        if request.free[..k].iter().any(|other| other.path == *path) {
            problems.push(format!("--free {path}: is given twice"));
        }
        let found = pullout_case::value_at(document, path);
        match found.map(|found| (found, found.as_f64())) {
            Some((_, Some(value))) if (*low..=*high).contains(&value) => {
                let inwards = INWARDS * (high - low);
                starts.push(if value == *low {
                    low + inwards
                } else if value == *high {
                    high - inwards
                } else {
                    value
                });
            }
            Some((_, Some(value))) => {
                problems.push(format!("--free {path}: the case begins with {value}, which is not within {low}:{high}"));
            }
            Some((found, None)) => problems.push(format!("{file}: $.{path} is {found}, and no number")),
            None => problems.push(format!("{file}: $.{path} is not there: give it the value to start from")),
        }
    }
    if problems.is_empty() { Ok(starts) } else { Err(problems) }
}

/// The measured points.
fn read_data(request: &CaseRequest) -> Result<Vec<[f64; 2]>, Vec<String>> {
    let file = request.data.display();
    let csv = CsvFile::read(&request.data)?;
    if csv.header.iter().all(|name| name.parse::<f64>().is_ok()) {
        return Err(csv.fault(1, "these are numbers, but the first line must name the columns"));
    }
    if csv.header.len() < 2 {
        return Err(csv.fault(1, "one column, but two are needed"));
    }
    let by_name = request.curve.each_ref().map(|name| csv.column(name).ok());
    let columns = match by_name {
        [Some(x), Some(y)] => [x, y],
        [None, None] => [0, 1],
        [there, _] => {
            let missing = &request.curve[usize::from(there.is_some())];
            return Err(csv.fault(1, format!("there is one of the columns of --curve, but not '{missing}'")));
        }
    };
    let rows = csv.numbers(&columns, true)?;
    if rows.len() <= request.free.len() {
        let message = format!("{} points do not tell {} numbers", rows.len(), request.free.len());
        return Err(vec![format!("{file}: {message}")]);
    }
    let rows: Vec<[f64; 2]> = rows.iter().map(|row| [row[0], row[1]]).collect();
    if rows.iter().all(|row| row[1] == 0.0) {
        return Err(vec![format!("{file}: all values are 0: nothing is told by them")]);
    }
    Ok(rows)
}

/// The case with what was found; files are named so that it runs from any folder.
fn kept(request: &CaseRequest, document: Value, values: &[f64]) -> Value {
    let settings = overrides(&request.free, values);
    let mut case = pullout_case::overridden(document, &settings).unwrap_or_default();
    make_absolute(&mut case, folder_of(&request.source.file));
    case
}

fn overrides(free: &[Free], values: &[f64]) -> Vec<String> {
    free.iter().zip(values).map(|(free, value)| format!("{}={value:?}", free.path)).collect()
}

/// Results of a run.
#[derive(Clone)]
struct Computed {
    /// Values at the points of the data.
    curve: Vec<f64>,
    /// Warning about the data.
    warning: Option<String>,
    /// Way of the run.
    increments: Option<Increments>,
}

/// A case with measured points.
struct Fitted<'a> {
    request: &'a CaseRequest,
    data: &'a [[f64; 2]],
    /// Differences are parts of this.
    scale: f64,
}

impl Fitted<'_> {
    fn values(&self, sought: &[f64]) -> Vec<f64> {
        self.request.free.iter().zip(sought).map(|(free, sought)| free.value(*sought)).collect()
    }

    /// Returns the results of the case with other numbers.
    fn computed(&self, values: &[f64], on: Option<&Increments>) -> Result<Computed, String> {
        let CaseRequest { source, free, curve, .. } = self.request;
        let mut source = source.clone();
        source.overrides.extend(overrides(free, values));
        let (outcome, increments) = search::outcome(source, on)?;
        if !outcome.is_done() {
            return Err(outcome.summary.message.unwrap_or_else(|| "the run did not come to its end".into()));
        }
        let (curve, warning) = at_data(&outcome, curve, self.data)?;
        Ok(Computed { curve, warning, increments })
    }

    /// ∂curve/∂values.
    fn slopes(&self, values: &[f64], run: &Computed) -> Result<DMatrix<f64>, String> {
        let step = |k: usize| {
            let step = STEP * size(values[k]);
            if values[k] + step > self.request.free[k].bounds[1] { -step } else { step }
        };
        let rows = DVector::from_column_slice(&run.curve);
        search::derivatives(values, &rows, run.increments.as_ref(), step, |values, on| {
            Ok(DVector::from_vec(self.computed(values, on)?.curve))
        })
    }
}

impl Simulation for Fitted<'_> {
    type Run = Computed;

    fn run(&self, sought: &[f64]) -> Result<Computed, String> {
        self.computed(&self.values(sought), None)
    }

    fn differences(&self, run: &Computed) -> DVector<f64> {
        let differences = run.curve.iter().zip(self.data).map(|(computed, row)| (computed - row[1]) / self.scale);
        DVector::from_iterator(self.data.len(), differences)
    }

    fn derivatives(&self, sought: &[f64], run: &Computed) -> Result<DMatrix<f64>, String> {
        let mut derivatives = self.slopes(&self.values(sought), run)?;
        for ((mut column, free), sought) in derivatives.column_iter_mut().zip(&self.request.free).zip(sought) {
            column *= 0.5 * (free.bounds[1] - free.bounds[0]) * sought.cos() / self.scale;
        }
        Ok(derivatives)
    }

    fn rms(&self, run: &Computed) -> f64 {
        self.scale * root_mean_square(&self.differences(run))
    }
}

/// Values at the points of the data, and what is to be said of these.
type AtData = (Vec<f64>, Option<String>);

/// The second column where the first passes the data's values for the first time, on its way to the farthest of them; of data
/// that turn back, branch by branch. Also returns what is to be said of the data.
fn at_data(outcome: &Outcome, names: &[String; 2], data: &[[f64; 2]]) -> Result<AtData, String> {
    let history = &outcome.history;
    let column = |name: &String| {
        let missing = || format!("--curve: the history has no column '{name}', but {}", history.columns().join(", "));
        history.column(name).ok_or_else(missing)
    };
    let (x, y, name) = (column(&names[0])?, column(&names[1])?, &names[0]);
    let turns = turns(x, data);
    let warning = turns.words(name);
    let Turns { of_data, of_run, .. } = turns;
    if of_data.is_empty() {
        return Ok((branch_at([x, y], data, name, [false, false])?, warning));
    }
    let mut computed = Vec::with_capacity(data.len());
    let (mut first, mut start) = (0, 0);
    for number in 0..=of_data.len() {
        if number > of_run.len() {
            return Err(format!(
                "the data turn back at {name} {} (point {first}), the run does not: leave out the points from {} on, or give the \
                 case a step that turns back as well",
                data[first - 1][0],
                first + 1
            ));
        }
        // a turn is the end of one branch and the beginning of the next
        let end = of_data.get(number).map_or(data.len(), |turn| turn + 1);
        let stop = of_run.get(number).map_or(x.len(), |turn| turn + 1);
        let branch = [&x[start..stop], &y[start..stop]];
        computed.extend(branch_at(branch, &data[first..end], name, [number > 0, stop < x.len()])?);
        (first, start) = (end, stop - 1);
    }
    Ok((computed, warning))
}

fn turns(x: &[f64], data: &[[f64; 2]]) -> Turns {
    let of_data: Vec<f64> = data.iter().map(|row| row[0]).collect();
    let run = |push: &mut dyn FnMut(f64)| {
        x.iter().for_each(|x| push(*x));
        Ok(())
    };
    // reading from memory does not fail
    Turns::of(&of_data, run).unwrap_or_default()
}

/// y of a branch where x, called `name`, first passes the data's values. Whether the run turns back where the branch begins, and
/// where it ends, is told of data off the branch.
fn branch_at(
    [x, y]: [&[f64]; 2],
    data: &[[f64; 2]],
    name: &str,
    [begins_at_turn, ends_at_turn]: [bool; 2],
) -> Result<Vec<f64>, String> {
    let Some(&start) = x.first() else { return Err("the run has no rows".into()) };
    let way =
        data.iter().map(|row| row[0] - start).fold(0.0_f64, |far, way| if way.abs() > far.abs() { way } else { far });
    let direction = if way < 0.0 { -1.0 } else { 1.0 };
    let rounding = ROUNDING * way.abs();
    // along the way
    let mut points: Vec<[f64; 2]> = Vec::with_capacity(x.len());
    for (&x, &y) in x.iter().zip(y.iter()) {
        if points.last().is_none_or(|last| direction * x > last[0]) {
            points.push([direction * x, y]);
        }
    }
    let last = points.last().map_or(start, |last| direction * last[0]);
    let at = |row: &[f64; 2]| {
        let x = direction * row[0];
        let right = points.partition_point(|point| point[0] < x);
        match (right.checked_sub(1).map(|left| points[left]), points.get(right)) {
            (Some(a), Some(b)) => Ok(a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1])),
            (None, Some(first)) if first[0] - x <= rounding => Ok(first[1]),
            (Some(last), None) if x - last[0] <= rounding => Ok(last[1]),
            (None, _) if begins_at_turn => {
                Err(format!("the run turns back at {name} {start}, behind their turn the data also have {}", row[0]))
            }
            (None, _) => Err(format!("the run begins at {name} {start}, the data also have {}", row[0])),
            (Some(_), None) => {
                let how = if ends_at_turn { "turns back" } else { "ends" };
                Err(format!("the run {how} at {name} {last}, the data go on to {}", row[0]))
            }
        }
    };
    data.iter().map(at).collect()
}

impl CaseFit {
    /// Returns what came out, for a person.
    pub fn describe(&self) -> String {
        let mut text = String::new();
        for (free, estimate) in self.free.iter().zip(&self.estimates) {
            let (value, error) = (estimate.value, standard_error(estimate));
            let known = if estimate.is_identifiable() { "" } else { "  NOT IDENTIFIABLE" };
            let bound = free.bound(value).map_or_else(String::new, |bound| format!("  on its bound {bound}"));
            // to a String it cannot fail
            let _ = writeln!(text, "  {} = {} ± {error}{known}{bound}", free.path, significant(value, 6));
        }
        let [made, here] = self.searches;
        let rms = significant(self.rms, 4);
        let _ = writeln!(text, "  RMS difference {rms}, {} runs; {here} of {made} searches ended here", self.runs);
        text
    }

    /// Writes fit.json, fitted-case.json, fitted-curve.csv, and the curves as a picture with a report. The result is what could
    /// not be drawn.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, directory: &mut ResultDirectory, request: &CaseRequest) -> io::Result<Vec<String>> {
        let number = |k: usize| {
            let (free, estimate) = (&self.free[k], &self.estimates[k]);
            json!({
                "path": free.path,
                "value": estimate.value,
                "start": self.starts[k],
                "bounds": free.bounds,
                "on_bound": free.bound(estimate.value),
                // JSON has no infinity: of what nothing is known is null
                "standard_error": estimate.standard_error,
                "identifiable": estimate.is_identifiable(),
            })
        };
        let parameters: Vec<Value> = (0..self.free.len()).map(number).collect();
        let summary = json!({
            "status": if self.trouble.is_none() { "done" } else { "failed" },
            "message": self.trouble,
            // the first by itself, as it was
            "warning": self.warnings.first(),
            "warnings": self.warnings,
            "case": request.source.file,
            "data": request.data,
            "curve": request.curve,
            "rms": self.rms,
            "runs": self.runs,
            "searches": { "made": self.searches[0], "ended_here": self.searches[1] },
            "parameters": parameters,
            "correlation": rows_of(&self.correlation),
        });
        directory.write("fit.json", format!("{summary:#}\n"))?;
        directory.write("fitted-case.json", format!("{:#}\n", self.case))?;
        let [x, y] = &request.curve;
        directory.write("fitted-curve.csv", table(&format!("{x},{y},computed"), self.rows.iter().copied()))?;
        let drawings = plots::write_all(directory, "plots", &[self.figure(request)])?;
        directory.write("report.html", report::page(self, request, &drawings.pictures).into_string())?;
        Ok(drawings.warnings)
    }

    /// The measured points and the curve that was computed.
    fn figure(&self, request: &CaseRequest) -> Figure {
        let [x, y] = &request.curve;
        let units = BTreeMap::new();
        let points = |column: usize| self.rows.iter().map(move |row| (row[0], row[column]));
        let computed = Line { columns: (x.clone(), y.clone()), ..Line::numbered("computed", points(2).collect(), 0) };
        let every = self.rows.len().div_ceil(MOST_MARKS).max(1);
        Figure {
            name: "fitted-curve".into(),
            title: "Measured and computed curve".into(),
            x: Quantity::of(x, &units),
            y: Quantity::of(y, &units),
            lines: vec![computed],
            marks: vec![Marks { label: "measured".into(), points: points(1).step_by(every).collect(), line: None }],
            ..Figure::default()
        }
    }
}

//! `pullout fit CASE`: the numbers of any case by which its curve is nearest to a measured one.
//!
//! Several tests may share the numbers: each has a case and a curve, whose differences count as parts of its greatest value. Least
//! squares from the values of the case and from others between the bounds ([`super::places`]).

use super::doubt::doubts;
use super::output::{MOST_MARKS, rows_of, standard_error, table};
use super::places::{Range, least_squares, size};
use super::search::{self, Increments, STEP, Simulation, root_mean_square};
use super::specimen::make_absolute;
use nalgebra::{DMatrix, DVector};
use pullout_bridging::Estimate;
use pullout_case::CsvFile;
use pullout_engine::{CaseSource, Outcome};
use pullout_report::compare::{Off, OnGrid};
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
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

mod report;

/// What a fit says that another thread ended.
const STOPPED: &str = "the fit was asked to end";

/// A number of a case that is sought.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    /// Place, as `--set` has it.
    pub path: String,
    /// Bounds of the value.
    pub bounds: [f64; 2],
}

/// A test: a case, and the curve that was measured.
#[derive(Clone, Debug)]
pub struct Test {
    /// The case with its values to start from.
    pub source: CaseSource,
    /// The file of the measured curve, or the name of a curve that stands in none.
    pub data: PathBuf,
    /// The measured points; `None`: those of the file.
    pub points: Option<Vec<[f64; 2]>>,
    /// Columns of the history that it is compared with.
    pub curve: [String; 2],
    /// Weight of its squares relative to those of the other tests.
    pub weight: f64,
}

/// Numbers of cases to be fitted, and the tests that they are fitted to.
#[derive(Clone, Debug)]
pub struct CaseRequest {
    /// The tests, which share the numbers.
    pub tests: Vec<Test>,
    /// Numbers that are sought.
    pub free: Vec<Free>,
    /// Most places that it is searched from, the values of the case first.
    pub starts: usize,
    /// Most runs of all searches, of each case.
    pub max_runs: usize,
    /// Ends the fit, and the run that goes on, when it is set.
    pub stop: Arc<AtomicBool>,
}

impl CaseRequest {
    /// Number of places that a fit is searched from, unless others are asked for.
    pub const STARTS: u32 = 4;
    /// Most runs of a fit, unless others are asked for.
    pub const MOST_RUNS: u32 = 500;
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
    /// Root mean square of the differences: for one test in the unit of the curve, for several as a fraction of their largest values.
    pub rms: f64,
    /// Places that it was searched from, and how many of these searches ended here.
    pub searches: [usize; 2],
    /// Runs that were made of each case.
    pub runs: usize,
    /// Reason why it is not the best.
    pub trouble: Option<String>,
    /// Warnings: facts that the user should know although nothing is wrong.
    pub warnings: Vec<String>,
    /// The tests with these numbers.
    pub tests: Vec<FittedTest>,
}

/// A test with the best parameters.
#[derive(Clone, Debug)]
pub struct FittedTest {
    /// The case.
    pub case: Value,
    /// Data: both columns, and what the case computes.
    pub rows: Vec<[f64; 3]>,
}

impl FittedTest {
    /// Root mean square of the differences, in the unit of the curve.
    pub fn rms(&self) -> f64 {
        let differences = self.rows.iter().map(|[_, measured, computed]| computed - measured);
        root_mean_square(&DVector::from_iterator(self.rows.len(), differences))
    }

    /// The greatest measured value in magnitude.
    fn scale(&self) -> f64 {
        greatest(self.rows.iter().map(|row| row[1]))
    }
}

/// Fits cases. `progress` receives the number of runs so far and the root mean square of the differences.
///
/// # Errors
/// Everything that is wrong with the input, one sentence each; a fit that was asked to end.
pub fn fit_case(request: &CaseRequest, progress: &dyn Fn(usize, f64)) -> Result<CaseFit, Vec<String>> {
    let documents: Vec<Value> = request.tests.iter().map(|test| document(&test.source)).collect::<Result<_, _>>()?;
    let starts = starts(request, &documents)?;
    let fitted = Fitted::of(request, &documents)?;
    let ranges: Vec<Range> = request.free.iter().map(Free::range).collect();
    let found = least_squares(&fitted, &ranges, &starts, [request.starts, request.max_runs], None, progress);
    if request.stop.load(Ordering::Relaxed) {
        return Err(vec![STOPPED.into()]);
    }
    let found = found.map_err(|message| vec![message])?;
    let values: Vec<f64> = found.estimates.iter().map(|estimate| estimate.value).collect();
    let rms = fitted.rms(&found.run);
    let tests: Vec<FittedTest> = std::iter::zip(&fitted.tests, &found.run)
        .map(|(of, run)| FittedTest {
            case: of.kept(&request.free, &values),
            rows: std::iter::zip(&of.data, &run.curve).map(|(row, computed)| [row[0], row[1], *computed]).collect(),
        })
        .collect();
    let is_alone = tests.len() == 1;
    let names: Vec<String> = request.tests.iter().map(|test| test.data.display().to_string()).collect();
    let misfit = |(name, test): (_, &FittedTest)| match is_alone {
        true => ("", rms / fitted.unit),
        false => (name, test.rms() / test.scale()),
    };
    let said = found.run.iter().zip(&names).filter_map(|(run, name)| {
        let warning = run.warning.clone()?;
        Some(if is_alone { warning } else { format!("{name}: {warning}") })
    });
    let doubts = doubts(&[], names.iter().map(String::as_str).zip(&tests).map(misfit));
    Ok(CaseFit {
        free: request.free.clone(),
        starts,
        estimates: found.estimates,
        correlation: found.correlation,
        rms,
        searches: found.searches,
        runs: found.runs,
        trouble: found.trouble,
        warnings: said.chain(doubts).collect(),
        tests,
    })
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

    fn range(&self) -> Range {
        Range { bounds: self.bounds, is_logarithmic: false }
    }

    /// The bound that a value lies on.
    fn bound(&self, value: f64) -> Option<f64> {
        self.range().bound(value)
    }
}

fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |greatest, value| greatest.max(value.abs()))
}

fn document(source: &CaseSource) -> Result<Value, Vec<String>> {
    let name = source.file.display();
    if source.need().is_none() {
        source
            .case()
            .map_err(|errors| errors.problems.iter().map(|problem| format!("{name}: {problem}")).collect::<Vec<_>>())?;
    }
    source.text().ok_or_else(|| vec![format!("{name}: is no case")])
}

/// The values that the cases have: of each number that of the first case which has it.
fn starts(request: &CaseRequest, documents: &[Value]) -> Result<Vec<f64>, Vec<String>> {
    let mut problems = Vec::new();
    let mut starts = Vec::new();
    for (k, Free { path, bounds: [low, high] }) in request.free.iter().enumerate() {
        if request.free[..k].iter().any(|other| other.path == *path) {
            problems.push(format!("--free {path}: is given twice"));
        }
        let found = std::iter::zip(&request.tests, documents)
            .find_map(|(test, document)| Some((test.source.file.display(), pullout_case::value_at(document, path)?)));
        match found.map(|(file, found)| (file, found, found.as_f64())) {
            Some((.., Some(value))) if (*low..=*high).contains(&value) => {
                starts.push(request.free[k].range().inside(value));
            }
            Some((.., Some(value))) => {
                problems.push(format!("--free {path}: the case begins with {value}, which is not within {low}:{high}"));
            }
            Some((file, found, None)) => problems.push(format!("{file}: $.{path} is {found}, and no number")),
            None => {
                let files: Vec<String> =
                    request.tests.iter().map(|test| test.source.file.display().to_string()).collect();
                let files = files.join(", ");
                problems.push(format!("{files}: $.{path} is not there: give it the value to start from"));
            }
        }
    }
    if problems.is_empty() { Ok(starts) } else { Err(problems) }
}

/// The measured points.
fn data(test: &Test) -> Result<Vec<[f64; 2]>, Vec<String>> {
    let rows = test.points.clone().map_or_else(|| read_data(test), Ok)?;
    if rows.iter().all(|row| row[1] == 0.0) {
        return Err(vec![format!("{}: all values are 0: they determine nothing", test.data.display())]);
    }
    Ok(rows)
}

/// The measured points of a file.
fn read_data(test: &Test) -> Result<Vec<[f64; 2]>, Vec<String>> {
    let csv = CsvFile::read(&test.data)?;
    if csv.header.iter().all(|name| name.parse::<f64>().is_ok()) {
        return Err(csv.fault(1, "these are numbers, but the first line must name the columns"));
    }
    if csv.header.len() < 2 {
        return Err(csv.fault(1, "one column, but two are needed"));
    }
    let by_name = test.curve.each_ref().map(|name| csv.column(name).ok());
    let columns = match by_name {
        [Some(x), Some(y)] => [x, y],
        [None, None] => [0, 1],
        [there, _] => {
            let missing = &test.curve[usize::from(there.is_some())];
            return Err(csv.fault(1, format!("there is one of the columns of --curve, but not '{missing}'")));
        }
    };
    let rows = csv.numbers(&columns, true)?;
    Ok(rows.iter().map(|row| [row[0], row[1]]).collect())
}

fn overrides<'a>(numbers: impl IntoIterator<Item = (&'a Free, &'a f64)>) -> Vec<String> {
    numbers.into_iter().map(|(free, value)| format!("{}={value:?}", free.path)).collect()
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

/// A test with its points.
struct Measured {
    /// Its case, read once, with its overrides: what is written into the file from now on changes nothing.
    source: CaseSource,
    curve: [String; 2],
    data: Vec<[f64; 2]>,
    /// Numbers that the case has.
    has: Vec<usize>,
    /// The greatest measured value.
    scale: f64,
    /// Factor of the differences as parts of it.
    weight: f64,
    /// Ends a run.
    stop: Arc<AtomicBool>,
}

/// Cases with measured points.
struct Fitted {
    free: Vec<Free>,
    tests: Vec<Measured>,
    /// Factor from the differences whose squares are summed to those that are reported: the scale of a single test.
    unit: f64,
}

impl Measured {
    /// The numbers that the case has.
    fn numbers<'a>(&self, free: &'a [Free], values: &'a [f64]) -> Vec<(&'a Free, &'a f64)> {
        self.has.iter().map(|&k| (&free[k], &values[k])).collect()
    }

    /// The case with what was found; files are named so that it runs from any folder.
    fn kept(&self, free: &[Free], values: &[f64]) -> Value {
        let document = self.source.text().unwrap_or_default();
        let settings = overrides(self.numbers(free, values));
        let mut case = pullout_case::overridden(document, &settings).unwrap_or_default();
        make_absolute(&mut case, folder_of(&self.source.file));
        case
    }

    /// Returns the results of the case with other numbers.
    fn computed(&self, free: &[Free], values: &[f64], on: Option<&Increments>) -> Result<Computed, String> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(STOPPED.into());
        }
        let mut source = self.source.clone();
        source.overrides.extend(overrides(self.numbers(free, values)));
        let (outcome, increments) = search::outcome(source, on, &self.stop)?;
        if !outcome.is_done() {
            return Err(outcome.summary.message.unwrap_or_else(|| "the run did not come to its end".into()));
        }
        let (curve, warning) = at_data(&outcome, &self.curve, &self.data)?;
        Ok(Computed { curve, warning, increments })
    }

    /// ∂curve/∂values.
    fn slopes(&self, free: &[Free], values: &[f64], run: &Computed) -> Result<DMatrix<f64>, String> {
        let own: Vec<f64> = self.has.iter().map(|&k| values[k]).collect();
        let step = |k: usize| {
            let step = STEP * size(own[k]);
            if own[k] + step > free[self.has[k]].bounds[1] { -step } else { step }
        };
        let rows = DVector::from_column_slice(&run.curve);
        let perturbed = |own: &[f64], on: Option<&Increments>| {
            let mut moved = values.to_vec();
            self.has.iter().zip(own).for_each(|(&k, value)| moved[k] = *value);
            Ok(DVector::from_vec(self.computed(free, &moved, on)?.curve))
        };
        let found = match own.is_empty() {
            true => DMatrix::zeros(rows.len(), 0),
            false => search::derivatives(&own, &rows, run.increments.as_ref(), step, perturbed)?,
        };
        let mut slopes = DMatrix::zeros(rows.len(), values.len());
        self.has.iter().zip(found.column_iter()).for_each(|(&k, column)| slopes.set_column(k, &column));
        Ok(slopes)
    }
}

impl Fitted {
    fn of(request: &CaseRequest, documents: &[Value]) -> Result<Self, Vec<String>> {
        let mean = request.tests.iter().map(|test| test.weight).sum::<f64>() / request.tests.len() as f64;
        let measured = |(test, document): (&Test, &Value)| {
            let data = data(test)?;
            let has = |k: &usize| pullout_case::value_at(document, &request.free[*k].path).is_some();
            Ok(Measured {
                source: CaseSource { document: Some(document.clone()), overrides: Vec::new(), ..test.source.clone() },
                curve: test.curve.clone(),
                has: (0..request.free.len()).filter(has).collect(),
                scale: greatest(data.iter().map(|row| row[1])),
                weight: (test.weight / mean).sqrt(),
                stop: request.stop.clone(),
                data,
            })
        };
        let tests: Vec<Measured> =
            std::iter::zip(&request.tests, documents).map(measured).collect::<Result<_, Vec<String>>>()?;
        let points: usize = tests.iter().map(|test| test.data.len()).sum();
        if points <= request.free.len() {
            let files: Vec<String> = request.tests.iter().map(|test| test.data.display().to_string()).collect();
            let message = format!("{points} points cannot determine {} parameters", request.free.len());
            return Err(vec![format!("{}: {message}", files.join(", "))]);
        }
        let unit = if let [test] = &tests[..] { test.scale } else { 1.0 };
        Ok(Self { free: request.free.clone(), tests, unit })
    }
}

impl Simulation for Fitted {
    type Run = Vec<Computed>;

    fn run(&self, values: &[f64]) -> Result<Vec<Computed>, String> {
        let run = |test: &Measured| {
            let named = |message| format!("{}: {message}", test.source.file.display());
            test.computed(&self.free, values, None).map_err(named)
        };
        self.tests.iter().map(run).collect()
    }

    fn differences(&self, runs: &Vec<Computed>) -> DVector<f64> {
        let of_test = |(test, run): (&Measured, &Computed)| -> Vec<f64> {
            let difference = |(computed, row): (&f64, &[f64; 2])| (computed - row[1]) / test.scale * test.weight;
            run.curve.iter().zip(&test.data).map(difference).collect()
        };
        DVector::from_vec(self.tests.iter().zip(runs).flat_map(of_test).collect())
    }

    fn derivatives(&self, values: &[f64], runs: &Vec<Computed>) -> Result<DMatrix<f64>, String> {
        let mut slopes = DMatrix::zeros(self.tests.iter().map(|test| test.data.len()).sum(), values.len());
        let mut first = 0;
        for (test, run) in self.tests.iter().zip(runs) {
            let named = |message: String| match self.tests.len() {
                1 => message,
                _ => format!("{}: {message}", test.source.file.display()),
            };
            let own = test.slopes(&self.free, values, run).map_err(named)? * (test.weight / test.scale);
            slopes.rows_mut(first, own.nrows()).copy_from(&own);
            first += own.nrows();
        }
        Ok(slopes)
    }

    fn rms(&self, runs: &Vec<Computed>) -> f64 {
        self.unit * root_mean_square(&self.differences(runs))
    }
}

/// Values at the points of the data, and a warning about them.
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
    if x.is_empty() {
        return Err("the run has no rows".into());
    }
    let grid: Vec<f64> = data.iter().map(|row| row[0]).collect();
    let OnGrid { values, turns } = OnGrid::of([x, y], &grid);
    let found = |(value, x): (Result<f64, Off>, &f64)| value.map_err(|off| off.words(name, *x));
    Ok((values.into_iter().zip(&grid).map(found).collect::<Result<_, _>>()?, turns.words(name)))
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
        let of = if self.tests.len() > 1 { " of the greatest values" } else { "" };
        let _ = writeln!(text, "  RMS difference {rms}{of}, {} runs; {here} of {made} searches ended here", self.runs);
        text
    }

    /// Returns the results as `fit.json` has them.
    pub fn summary(&self, request: &CaseRequest) -> Value {
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
        let mut summary = json!({
            "status": if self.trouble.is_none() { "done" } else { "failed" },
            "message": self.trouble,
            // the first by itself, as it was
            "warning": self.warnings.first(),
            "warnings": self.warnings,
            "rms": self.rms,
            "runs": self.runs,
            "searches": { "made": self.searches[0], "ended_here": self.searches[1] },
            "parameters": parameters,
            "correlation": rows_of(&self.correlation),
        });
        let of_test = |(test, fitted): (&Test, &FittedTest)| {
            let Test { source, data, curve, weight, .. } = test;
            json!({ "case": source.file, "data": data, "curve": curve, "weight": weight, "rms": fitted.rms() })
        };
        let tests: Vec<Value> = request.tests.iter().zip(&self.tests).map(of_test).collect();
        if let [test] = &tests[..] {
            ["case", "data", "curve"].iter().for_each(|&key| summary[key] = test[key].clone());
        }
        summary["tests"] = tests.into();
        summary
    }

    /// Writes fit.json, fitted-case.json, fitted-curve.csv, and the curves as a picture with a report; of several tests, files with
    /// their numbers. The result is what could not be drawn.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, directory: &mut ResultDirectory, request: &CaseRequest) -> io::Result<Vec<String>> {
        directory.write("fit.json", format!("{:#}\n", self.summary(request)))?;
        let mut figures = Vec::new();
        for (k, (test, fitted)) in request.tests.iter().zip(&self.tests).enumerate() {
            let number = if self.tests.len() > 1 { format!("-{}", k + 1) } else { String::new() };
            let [x, y] = &test.curve;
            directory.write(&format!("fitted-case{number}.json"), format!("{:#}\n", fitted.case))?;
            let rows = table(&format!("{x},{y},computed"), fitted.rows.iter().copied());
            directory.write(&format!("fitted-curve{number}.csv"), rows)?;
            figures.push(figure(test, fitted, &number));
        }
        let drawings = plots::write_all(directory, "plots", &figures)?;
        directory.write("report.html", report::page(self, request, &drawings.pictures).into_string())?;
        Ok(drawings.warnings)
    }
}

/// The measured points of a test and the curve that was computed.
fn figure(test: &Test, fitted: &FittedTest, number: &str) -> Figure {
    let [x, y] = &test.curve;
    let units = BTreeMap::new();
    let points = |column: usize| fitted.rows.iter().map(move |row| (row[0], row[column]));
    let computed = Line { columns: (x.clone(), y.clone()), ..Line::numbered("computed", points(2).collect(), 0) };
    let every = fitted.rows.len().div_ceil(MOST_MARKS).max(1);
    let of = match number {
        "" => String::new(),
        _ => format!(": {}", test.data.file_stem().unwrap_or_default().to_string_lossy()),
    };
    Figure {
        name: format!("fitted-curve{number}"),
        title: format!("Measured and computed curve{of}"),
        x: Quantity::of(x, &units),
        y: Quantity::of(y, &units),
        lines: vec![computed],
        marks: vec![Marks { label: "measured".into(), points: points(1).step_by(every).collect(), line: None }],
        ..Figure::default()
    }
}

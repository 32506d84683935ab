//! Plans a sweep: from its file to the store.

use crate::store::{Bundle, Keep, Store, Sweep, VERSION, with};
use pullout_case::study::{NamedQuantity, QuantityOfFile};
use pullout_case::sweep::{Base, SweepFile};
use pullout_case::{CaseErrors, CaseProblem, JsonPlace, Reader};
use pullout_engine::CaseSource;
use pullout_run::input::{self, Input};
use pullout_run::signals;
use pullout_study::{Demand, default_curve};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

/// Most runs of a sweep.
const MOST_RUNS: usize = 10_000_000;

/// Runs between two looks at signals.
const LOOK_EVERY: usize = 4096;

/// Variation: dotted paths, and their values.
type Design = (Vec<String>, Values);

/// Values of what is varied.
enum Values {
    /// Run by run.
    Rows(Vec<Vec<Value>>),
    /// By paths: every combination, the last path first.
    Lists(Vec<Vec<Value>>),
}

impl Values {
    /// Number of runs.
    fn count(&self) -> usize {
        match self {
            Self::Rows(rows) => rows.len(),
            Self::Lists(lists) => lists.iter().map(Vec::len).fold(1, usize::saturating_mul),
        }
    }

    /// The values of a run.
    fn of(&self, run: usize) -> Vec<Value> {
        match self {
            Self::Rows(rows) => rows[run].clone(),
            Self::Lists(lists) => {
                let mut rest = run;
                let mut values: Vec<Value> = lists
                    .iter()
                    .rev()
                    .map(|list| {
                        let value = list[rest % list.len()].clone();
                        rest /= list.len();
                        value
                    })
                    .collect();
                values.reverse();
                values
            }
        }
    }
}

/// How a sweep is read.
#[derive(Clone, Copy)]
pub struct Planning<'p> {
    /// The runs as a CSV table.
    pub design: Option<&'p Path>,
    /// Folders where plugins are looked for first.
    pub plugin_paths: &'p [PathBuf],
    /// Whether the sweep is from an unknown source.
    pub is_untrusted: bool,
}

/// A sweep without its runs, which are made once nothing is wrong with it.
struct Draft {
    sweep: Sweep,
    values: Values,
    /// The folder of the case.
    folder: PathBuf,
}

/// Plans a sweep that a file describes, and puts it into a store. With a table of the design, the file may be a case.
///
/// # Errors
/// Everything that is wrong with it.
pub fn plan(file: &Path, how: Planning<'_>, store: &Store) -> Result<Sweep, CaseErrors> {
    let Planning { design, plugin_paths, is_untrusted } = how;
    let refused = |message: String| CaseErrors { file: file.into(), problems: vec![CaseProblem::unreadable(message)] };
    let Some(mut document) = pullout_case::document(file, &[]) else {
        // reading it as a case says what is wrong
        let read = pullout_case::read(file, &[], plugin_paths);
        return Err(read.err().unwrap_or_else(|| refused("the sweep file cannot be read as JSON".into())));
    };
    if let Some(design) = design {
        if document["kind"] != "sweep" {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            document = serde_json::json!({ "kind": "sweep", "base": name });
        }
        let absolute = std::path::absolute(design).unwrap_or_else(|_| design.into());
        document["design"] = absolute.to_string_lossy().into();
    }
    store.may_plan().map_err(|error| refused(error.to_string()))?;
    let mut reader = Reader::new(input::folder_of(file), plugin_paths, is_untrusted);
    let draft = pullout_case::read_sweep(&mut reader, document, |reader, of_file: SweepFile| {
        resolve(reader, &of_file, file, how)
    });
    let problems = reader.into_problems();
    match draft {
        Some(draft) if problems.is_empty() => {
            let sweep = draft.finished(how, store).map_err(|error| {
                let message = format!("its files cannot be put into the store: {error}");
                refused(if error.kind() == io::ErrorKind::Interrupted { error.to_string() } else { message })
            })?;
            store.plan(&sweep).map_err(|error| refused(error.to_string()))?;
            Ok(sweep)
        }
        _ => Err(CaseErrors { file: file.into(), problems }),
    }
}

fn resolve(reader: &mut Reader<'_>, of_file: &SweepFile, file: &Path, how: Planning<'_>) -> Option<Draft> {
    let root = JsonPlace::root();
    let folder = input::folder_of(file);
    let place = root.key("base");
    let (base, folder) = match &of_file.base {
        Base::Case(case) => (Value::Object(case.clone()), folder.to_owned()),
        Base::File(name) => {
            let path = reader.file(name, &place)?;
            let Some(case) = pullout_case::document(&path, &[]) else {
                reader.problem(&place, format!("{} cannot be read as JSON", path.display()));
                return None;
            };
            (case, input::folder_of(&path).to_owned())
        }
    };
    let set = of_file.set.clone().unwrap_or_default();
    let (paths, values): (Vec<String>, Vec<Value>) = set.into_iter().unzip();
    let base = overridden(reader, &base, &paths, &values, &root.key("set"))?;
    let (parameters, values) = match how.design {
        // the table of the command line may lie anywhere
        Some(path) => {
            let place = root.key("design");
            let read = table(path).map_err(|message| reader.problem(&place, format!("{}: {message}", path.display())));
            read.ok()?
        }
        None => design(reader, of_file)?,
    };
    let parameters: Vec<String> = parameters.iter().map(|path| pullout_case::dotted(path)).collect();
    if let Some((_, path)) = parameters.iter().enumerate().find(|(k, path)| parameters[..*k].contains(path)) {
        reader.problem(&root, format!("the path {path} is given twice: give it once"));
        return None;
    }
    if values.count() > MOST_RUNS {
        reader.problem(&root, format!("{} runs are more than the {MOST_RUNS} that a sweep may have", values.count()));
        return None;
    }
    let first = values.of(0);
    overridden(reader, &base, &parameters, &first, &root)?;
    let keep = keep(reader, of_file, &base);
    // the first run shows what is wrong with all
    let first = CaseSource {
        plugin_paths: how.plugin_paths.to_vec(),
        is_untrusted: how.is_untrusted,
        ..CaseSource::document(with(&base, &parameters, &first), &folder)
    };
    match first.columns() {
        Ok(columns) => {
            let demands = demands(of_file, &keep);
            let unmet = columns.map_or_else(Vec::new, |columns| Demand::unmet(&demands, &columns));
            unmet.into_iter().for_each(|problem| reader.push(problem));
        }
        Err(errors) => {
            for problem in errors.problems {
                reader.push(CaseProblem {
                    message: format!("the case of the first run: {problem}"),
                    place: Some(place.clone()),
                    ..problem
                });
            }
            return None;
        }
    }
    let stem = || file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let sweep = Sweep {
        version: VERSION,
        title: of_file.head.title.clone().unwrap_or_else(stem),
        base,
        parameters,
        runs: Vec::new(),
        written: BTreeMap::new(),
        bundles: Vec::new(),
        bundle_of: Vec::new(),
        keep,
    };
    Some(Draft { sweep, values, folder })
}

impl Draft {
    /// Makes the runs, and puts their files into a store.
    fn finished(self, how: Planning<'_>, store: &Store) -> io::Result<Sweep> {
        let Self { mut sweep, values, folder } = self;
        let count = values.count();
        sweep.runs = match values {
            Values::Rows(rows) => rows,
            Values::Lists(_) => {
                let runs = (0..count).map(|run| heed_signals(run).map(|()| values.of(run)));
                runs.collect::<io::Result<_>>()?
            }
        };
        bundle(&mut sweep, &folder, how, store)?;
        Ok(sweep)
    }
}

/// Ends what goes through all runs when a signal asks for the end.
fn heed_signals(run: usize) -> io::Result<()> {
    match signals::received() {
        Some(signal) if run.is_multiple_of(LOOK_EVERY) => {
            let message = format!("interrupted by {}: nothing is planned", signal.words());
            Err(io::Error::new(io::ErrorKind::Interrupted, message))
        }
        _ => Ok(()),
    }
}

/// A case with values, or what is wrong with their paths.
fn overridden(
    reader: &mut Reader<'_>,
    base: &Value,
    paths: &[String],
    values: &[Value],
    place: &JsonPlace,
) -> Option<Value> {
    let texts: Vec<String> = paths.iter().zip(values).map(|(path, value)| format!("{path}={value}")).collect();
    pullout_case::overridden(base.clone(), &texts)
        .map_err(|problems| {
            for problem in problems {
                reader.problem(place, problem.to_string());
            }
        })
        .ok()
}

fn keep(reader: &mut Reader<'_>, of_file: &SweepFile, base: &Value) -> Keep {
    let root = JsonPlace::root();
    let named = |name| QuantityOfFile::Named(name);
    let usual = || {
        BTreeMap::from([
            ("peak".to_owned(), named(NamedQuantity::Peak)),
            ("slip_at_peak".to_owned(), named(NamedQuantity::SlipAtPeak)),
            ("work".to_owned(), named(NamedQuantity::Work)),
            ("end".to_owned(), named(NamedQuantity::End)),
        ])
    };
    if of_file.grid.as_ref().is_some_and(|grid| !grid.is_sorted_by(|a, b| a < b)) {
        reader.problem(&root.key("grid"), "must be ascending");
    }
    if of_file.work_to == Some(0.0) {
        reader.problem(&root.key("work_to"), "must not be 0");
    }
    Keep {
        curve: of_file.curve.clone().unwrap_or_else(|| default_curve(base)),
        work_to: of_file.work_to,
        quantities: of_file.quantities.clone().unwrap_or_else(usual),
        curves: of_file.curves.clone().unwrap_or_default(),
        grid: of_file.grid.clone(),
    }
}

/// Returns the history columns that the file names.
fn demands(of_file: &SweepFile, keep: &Keep) -> Vec<Demand> {
    let root = JsonPlace::root();
    let mut demands = Vec::new();
    if of_file.curve.is_some() {
        demands.extend(Demand::of_curve(&keep.curve, &root.key("curve")));
    }
    for (name, quantity) in &keep.quantities {
        let place = root.key("quantities").key(name);
        demands.extend(Demand::of_quantity(quantity, &keep.curve, &place));
    }
    for (index, column) in keep.curves.iter().enumerate() {
        let place = root.key("curves").index(index);
        demands.push(match keep.grid {
            Some(_) => Demand::in_rows_of(column, &keep.curve.x, place),
            None => Demand::of_column(column, place),
        });
    }
    demands
}

/// Returns what is varied, in one of three ways.
fn design(reader: &mut Reader<'_>, of_file: &SweepFile) -> Option<Design> {
    let root = JsonPlace::root();
    let given = [of_file.parameters.is_some(), of_file.points.is_some(), of_file.design.is_some()];
    if given.iter().filter(|given| **given).count() != 1 {
        reader.problem(&root, "needs one of \"parameters\", \"points\" and \"design\"");
        return None;
    }
    if let Some(parameters) = &of_file.parameters {
        return product(reader, parameters, &root.key("parameters"));
    }
    if let Some(points) = &of_file.points {
        let place = root.key("points");
        let Some(first) = points.first() else {
            reader.problem(&place, "has no runs");
            return None;
        };
        let paths: Vec<String> = first.keys().cloned().collect();
        let mut runs = Vec::new();
        for (index, point) in points.iter().enumerate() {
            let run: Option<Vec<Value>> = paths.iter().map(|path| point.get(path).cloned()).collect();
            match run.filter(|run| run.len() == point.len()) {
                Some(run) => runs.push(run),
                None => {
                    reader.problem(
                        &place.index(index),
                        format!("must have the paths of the first: {}", paths.join(", ")),
                    );
                    return None;
                }
            }
        }
        return Some((paths, Values::Rows(runs)));
    }
    let place = root.key("design");
    let name = of_file.design.as_ref()?;
    let path = reader.file(name, &place)?;
    table(&path).map_err(|message| reader.problem(&place, format!("{}: {message}", path.display()))).ok()
}

/// Returns every combination of the values.
fn product(reader: &mut Reader<'_>, parameters: &Map<String, Value>, place: &JsonPlace) -> Option<Design> {
    let mut lists = Vec::new();
    for (path, values) in parameters {
        let Some(values) = values.as_array().filter(|values| !values.is_empty()) else {
            reader.problem(&place.key(path), "must be a list of values");
            return None;
        };
        lists.push(values.clone());
    }
    let values = Values::Lists(lists);
    if values.count() > MOST_RUNS {
        reader.problem(place, format!("more than the {MOST_RUNS} runs that a sweep may have"));
        return None;
    }
    Some((parameters.keys().cloned().collect(), values))
}

/// Reads a CSV table whose header has the dotted paths. Fields are JSON, otherwise texts.
fn table(path: &Path) -> Result<Design, String> {
    let text = input::text(path, Input::Mesh).map_err(|error| error.to_string())?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let paths: Vec<String> = reader.headers().map_err(|error| error.to_string())?.iter().map(str::to_owned).collect();
    let value = |field: &str| serde_json::from_str(field).unwrap_or_else(|_| Value::from(field));
    let mut runs = Vec::new();
    for record in reader.records() {
        runs.push(record.map_err(|error| error.to_string())?.iter().map(value).collect());
    }
    if runs.is_empty() { Err("has no rows".into()) } else { Ok((paths, Values::Rows(runs))) }
}

/// Puts the files that the cases name into the store, and their names there into the sweep.
fn bundle(sweep: &mut Sweep, folder: &Path, how: Planning<'_>, store: &Store) -> io::Result<()> {
    let original = sweep.base.clone();
    let reader = Reader::new(folder, how.plugin_paths, how.is_untrusted);
    let mut bundle = Bundle::default();
    bundle.take(&mut sweep.base, folder, &reader)?;
    sweep.bundles.push(bundle.put_into(store)?);
    for (number, run) in sweep.runs.iter_mut().enumerate() {
        heed_signals(number)?;
        let names_files = run.iter().any(|value| !(value.is_number() || value.is_boolean()));
        let mut index = 0;
        if names_files {
            // a value may replace a name of the base
            let mut bundle = Bundle::default();
            let mut document = with(&original, &sweep.parameters, run);
            bundle.take(&mut document, folder, &reader)?;
            let stored: Vec<Value> = sweep
                .parameters
                .iter()
                .map(|path| pullout_case::value_at(&document, path).cloned().unwrap_or_default())
                .collect();
            let written = std::mem::replace(run, stored);
            if written != *run {
                sweep.written.insert(number, written);
            }
            let name = bundle.put_into(store)?;
            index = sweep.bundles.iter().position(|other| *other == name).unwrap_or(sweep.bundles.len());
            if index == sweep.bundles.len() {
                sweep.bundles.push(name);
            }
        }
        sweep.bundle_of.push(index);
    }
    if sweep.bundles.len() == 1 {
        sweep.bundle_of.clear();
    }
    Ok(())
}

#[cfg(test)]
mod test {
    use super::*;

    /// As loops within loops, the last path innermost.
    #[test]
    fn every_combination_is_a_run() {
        let lists: [Vec<Value>; 3] =
            [&["a", "b"][..], &["c"], &["d", "e", "f"]].map(|list| list.iter().copied().map(Value::from).collect());
        let mut expected: Vec<Vec<Value>> = vec![Vec::new()];
        for list in &lists {
            let longer = |run: &Vec<Value>| {
                let run = run.clone();
                Vec::from_iter(list.iter().map(move |value| [&run[..], std::slice::from_ref(value)].concat()))
            };
            expected = expected.iter().flat_map(longer).collect();
        }
        let values = Values::Lists(lists.into());
        assert_eq!(values.count(), 6);
        assert_eq!(Vec::from_iter((0..6).map(|run| values.of(run))), expected);
        assert_eq!(Values::Lists(vec![vec![Value::Null; 3]; 60]).count(), usize::MAX);
    }
}

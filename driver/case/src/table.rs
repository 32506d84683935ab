//! CSV files: tables that drive a step, curves to compare with. Lines that begin with `#` are comments.

use crate::problem::hint;
use pullout_run::input::{self, Input};
use pullout_run::number::exact;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

/// Problems reported of one file before the rest is left out.
const MOST_PROBLEMS: usize = 5;

/// A CSV file's header and rows. It is kept as the text that it is: rows of texts would take many times its size.
#[derive(Debug)]
pub struct CsvFile {
    /// Column names.
    pub header: Vec<String>,
    path: PathBuf,
    text: Vec<u8>,
    /// The line of each row.
    lines: Vec<u64>,
}

fn reader(text: &[u8]) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).flexible(true).from_reader(text)
}

impl CsvFile {
    /// Reads a file.
    ///
    /// # Errors
    /// A list of problems, one sentence each.
    pub fn read(path: &Path) -> Result<Self, Vec<String>> {
        let file = path.display();
        let unreadable = |error: io::Error| vec![format!("{file} cannot be read: {error}")];
        let mut text = input::read(path, Input::Table).map_err(unreadable)?;
        let start = text.len() - input::without_mark(&text).map_err(unreadable)?.len();
        let mut reader = reader(&text[start..]);
        let header = reader.headers().map_err(|error| vec![format!("{file}: {error}")])?;
        let header: Vec<String> = header.iter().map(str::to_owned).collect();
        let mut lines = Vec::new();
        let mut problems = Problems::default();
        let mut record = csv::StringRecord::new();
        loop {
            match reader.read_record(&mut record) {
                Ok(false) => break,
                Ok(true) => {
                    let line = record.position().map_or(0, csv::Position::line);
                    if record.len() != header.len() {
                        problems.add(|| {
                            format!("{file}, line {line}: {} fields, but the header has {}", record.len(), header.len())
                        });
                    }
                    lines.push(line);
                }
                Err(error) => problems.add(|| format!("{file}: {error}")),
            }
        }
        if header.iter().all(String::is_empty) {
            problems.add(|| format!("{file} is empty: a header line with column names is needed"));
        } else if lines.is_empty() {
            problems.add(|| format!("{file} has no rows below its header"));
        }
        text.drain(..start);
        problems.or(Self { header, path: path.into(), text, lines })
    }

    /// The rows of columns that a case has itself.
    ///
    /// # Errors
    /// One sentence for each that has not as many values as the first.
    pub fn of_columns(columns: &BTreeMap<String, Vec<f64>>) -> Result<Self, Vec<String>> {
        let mut problems = Problems::default();
        let count = columns.values().next().map_or(0, Vec::len);
        for (name, values) in columns.iter().filter(|(_, values)| values.len() != count) {
            problems.add(|| format!("the column '{name}' has {} values, the first one {count}", values.len()));
        }
        if count == 0 {
            problems.add(|| "the table has no rows".to_owned());
        }
        let line = |fields: Vec<String>| fields.join(",") + "\n";
        let number =
            |k: usize| columns.values().map(|values| values.get(k).copied().map_or_else(String::new, exact)).collect();
        let header: Vec<String> = columns.keys().cloned().collect();
        let rows: String = (0..count).map(|k| line(number(k))).collect();
        let text = (line(header.clone()) + &rows).into_bytes();
        problems.or(Self { header, path: "the table".into(), text, lines: (2..).take(count).collect() })
    }

    /// What messages call it.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// The finite numbers of some columns, row by row. Rows in which one of them is blank are left out if
    /// `skip_blank` says so (several curves of different lengths in one file).
    ///
    /// # Errors
    /// One sentence for each cell that is not a finite number.
    pub fn numbers(&self, columns: &[usize], skip_blank: bool) -> Result<Vec<Vec<f64>>, Vec<String>> {
        let mut problems = Problems::default();
        let mut numbers = Vec::with_capacity(self.lines.len());
        let mut reader = reader(&self.text);
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record).is_ok_and(|is_there| is_there) {
            if skip_blank && columns.iter().any(|column| record[*column].is_empty()) {
                continue;
            }
            let mut row = Vec::with_capacity(columns.len());
            for &column in columns {
                match record[column].parse::<f64>() {
                    Ok(value) if value.is_finite() => row.push(value),
                    _ => problems.add(|| {
                        let line = record.position().map_or(0, csv::Position::line);
                        let (name, cell) = (&self.header[column], &record[column]);
                        format!("line {line}, column '{name}': '{cell}' is not a finite number")
                    }),
                }
            }
            numbers.push(row);
        }
        let named = |problem: &String| format!("{}, {problem}", self.path.display());
        problems.or(numbers).map_err(|problems| problems.iter().map(named).collect())
    }

    /// Returns the position of a column.
    ///
    /// # Errors
    /// No column has this name.
    pub fn column(&self, name: &str) -> Result<usize, Vec<String>> {
        let unknown = || self.fault(1, format!("no column is called '{name}'{}", hint(name, &self.header)));
        self.header.iter().position(|column| column == name).ok_or_else(unknown)
    }

    /// Line number of a row.
    pub fn line(&self, row: usize) -> u64 {
        self.lines.get(row).copied().unwrap_or_default()
    }

    /// Returns a message about a line, with file and line number.
    pub fn fault(&self, line: u64, message: impl Display) -> Vec<String> {
        vec![format!("{}, line {line}: {message}", self.path.display())]
    }
}

/// Problems of a file: the first ones, and their number.
#[derive(Default)]
struct Problems {
    first: Vec<String>,
    count: usize,
}

impl Problems {
    fn add(&mut self, problem: impl FnOnce() -> String) {
        self.count += 1;
        if self.count <= MOST_PROBLEMS {
            self.first.push(problem());
        }
    }

    /// Returns what was read, if nothing is wrong.
    fn or<T>(mut self, read: T) -> Result<T, Vec<String>> {
        match self.count.saturating_sub(MOST_PROBLEMS) {
            0 if self.count == 0 => return Ok(read),
            0 => {}
            more => self.first.push(format!("and {more} more like this")),
        }
        Err(self.first)
    }
}

/// Contents of a table step's file: columns of known names, with time increments.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Table {
    /// The column in [`Self::rows`] of each of the names asked for.
    pub columns: Vec<Option<usize>>,
    /// Time increments; 1 each if the file has no column "time".
    pub time_increments: Vec<f64>,
    /// Values.
    pub rows: Vec<Vec<f64>>,
    /// The first row is at time 0: its increment takes no time.
    pub starts_at_zero: bool,
}

impl Table {
    /// Takes the table of a file whose columns are `time` (optional) and some of `names`.
    ///
    /// # Errors
    /// A list of problems, one sentence each.
    pub fn of(csv: &CsvFile, names: &[&str]) -> Result<Self, Vec<String>> {
        let file = csv.name();
        let mut problems = Problems::default();
        for (k, name) in csv.header.iter().enumerate() {
            if csv.header[..k].contains(name) {
                problems.add(|| format!("{file}: the column '{name}' is there twice"));
            } else if name != "time" && !names.contains(&name.as_str()) {
                let valid = ["time"].iter().chain(names);
                problems.add(|| format!("{file}: no component is called '{name}'{}", hint(name, valid)));
            }
        }
        if !csv.header.iter().any(|name| names.contains(&name.as_str())) && problems.count == 0 {
            problems.add(|| format!("{file}: no column names a component; valid names: {}", names.join(", ")));
        }
        let all: Vec<usize> = (0..csv.header.len()).collect();
        let rows = csv.numbers(&all, false);
        let rows = rows.map_err(|cells| [std::mem::take(&mut problems.first), cells].concat())?;
        let time = csv.header.iter().position(|name| name == "time");
        let mut time_increments = vec![1.0; rows.len()];
        let mut starts_at_zero = false;
        if let Some(time) = time {
            let mut before = 0.0;
            for (k, row) in rows.iter().enumerate() {
                let increment = row[time] - before;
                starts_at_zero |= k == 0 && increment == 0.0;
                if !(increment > 0.0 || (k == 0 && increment == 0.0)) {
                    let what = if k == 0 { "is negative" } else { "is not greater than that of the row before" };
                    problems.add(|| format!("{file}, line {}: the time {} {what}", csv.line(k), row[time]));
                }
                time_increments[k] = increment;
                before = row[time];
            }
        }
        let columns = names.iter().map(|name| csv.header.iter().position(|column| column == name)).collect();
        problems.or(Self { columns, time_increments, rows, starts_at_zero })
    }
}

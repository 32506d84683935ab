//! CSV files: tables that drive a step, curves to compare with. Lines that begin with `#` are comments.

use crate::input::{self, Input};
use std::io;
use std::path::Path;

/// Problems reported of one file before the rest is left out.
const MOST_PROBLEMS: usize = 5;

/// A CSV file's header and rows of text.
#[derive(Debug)]
pub struct CsvFile {
    /// Column names.
    pub header: Vec<String>,
    rows: Vec<(u64, csv::StringRecord)>,
}

impl CsvFile {
    /// Reads a file.
    ///
    /// # Errors
    /// One sentence each of what is wrong.
    pub fn read(path: &Path) -> Result<Self, Vec<String>> {
        let file = path.display();
        let unreadable = |error: io::Error| vec![format!("{file} cannot be read: {error}")];
        let bytes = input::read(path, Input::Table).map_err(unreadable)?;
        let bytes = input::without_mark(&bytes).map_err(unreadable)?;
        let mut reader =
            csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).flexible(true).from_reader(bytes);
        let header = reader.headers().map_err(|error| vec![format!("{file}: {error}")])?;
        let header: Vec<String> = header.iter().map(str::to_owned).collect();
        let mut rows = Vec::new();
        let mut problems = Vec::new();
        for record in reader.records() {
            match record {
                Ok(record) => {
                    let line = record.position().map_or(0, csv::Position::line);
                    if record.len() != header.len() {
                        problems.push(format!(
                            "{file}, line {line}: {} fields, but the header has {}",
                            record.len(),
                            header.len()
                        ));
                    }
                    rows.push((line, record));
                }
                Err(error) => problems.push(format!("{file}: {error}")),
            }
        }
        if header.iter().all(String::is_empty) {
            problems.push(format!("{file} is empty: a header line with column names is needed"));
        } else if rows.is_empty() {
            problems.push(format!("{file} has no rows below its header"));
        }
        if problems.is_empty() { Ok(Self { header, rows }) } else { Err(shortened(problems)) }
    }

    /// The finite numbers of some columns, row by row. Rows in which one of them is blank are left out if
    /// `skip_blank` says so (several curves of different lengths in one file).
    ///
    /// # Errors
    /// One sentence for each cell that is no finite number.
    pub fn numbers(&self, columns: &[usize], skip_blank: bool) -> Result<Vec<Vec<f64>>, Vec<String>> {
        let mut problems = Vec::new();
        let mut numbers = Vec::with_capacity(self.rows.len());
        for (line, record) in &self.rows {
            if skip_blank && columns.iter().any(|column| record[*column].is_empty()) {
                continue;
            }
            let mut row = Vec::with_capacity(columns.len());
            for &column in columns {
                match record[column].parse::<f64>() {
                    Ok(value) if value.is_finite() => row.push(value),
                    _ => problems.push(format!(
                        "line {line}, column '{}': '{}' is no finite number",
                        self.header[column], &record[column]
                    )),
                }
            }
            numbers.push(row);
        }
        if problems.is_empty() { Ok(numbers) } else { Err(shortened(problems)) }
    }

    /// Line number of a row.
    pub fn line(&self, row: usize) -> u64 {
        self.rows.get(row).map_or(0, |(line, _)| *line)
    }
}

fn shortened(mut problems: Vec<String>) -> Vec<String> {
    let more = problems.len().saturating_sub(MOST_PROBLEMS);
    problems.truncate(MOST_PROBLEMS);
    if more > 0 {
        problems.push(format!("and {more} more like this"));
    }
    problems
}

/// What a table step's file says: columns of known names, with time increments.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// For each of the names asked for, its column in [`Self::rows`].
    pub columns: Vec<Option<usize>>,
    /// Time increments; 1 each if the file has no column "time".
    pub time_increments: Vec<f64>,
    /// Values.
    pub rows: Vec<Vec<f64>>,
    /// The first row is at time 0: its increment takes no time.
    pub starts_at_zero: bool,
}

impl Table {
    /// Reads a table whose columns are `time` (optional) and some of `names`.
    ///
    /// # Errors
    /// One sentence each of what is wrong.
    pub fn read(path: &Path, names: &[&str]) -> Result<Self, Vec<String>> {
        let csv = CsvFile::read(path)?;
        let file = path.display();
        let mut problems = Vec::new();
        for (k, name) in csv.header.iter().enumerate() {
            if csv.header[..k].contains(name) {
                problems.push(format!("{file}: the column '{name}' is there twice"));
            } else if name != "time" && !names.contains(&name.as_str()) {
                let valid = ["time"].iter().chain(names);
                problems.push(format!("{file}: no component is called '{name}'{}", super::problem::hint(name, valid)));
            }
        }
        if !csv.header.iter().any(|name| names.contains(&name.as_str())) && problems.is_empty() {
            problems.push(format!("{file}: no column names a component; valid names: {}", names.join(", ")));
        }
        let all: Vec<usize> = (0..csv.header.len()).collect();
        let rows = match csv.numbers(&all, false) {
            Ok(rows) => rows,
            Err(cells) => {
                problems.extend(cells.into_iter().map(|cell| format!("{file}, {cell}")));
                return Err(problems);
            }
        };
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
                    problems.push(format!("{file}, line {}: the time {} {what}", csv.line(k), row[time]));
                }
                time_increments[k] = increment;
                before = row[time];
            }
        }
        let columns = names.iter().map(|name| csv.header.iter().position(|column| column == name)).collect();
        if problems.is_empty() {
            Ok(Self { columns, time_increments, rows, starts_at_zero })
        } else {
            Err(shortened(problems))
        }
    }
}

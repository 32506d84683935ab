//! `history.csv`: written line by line as the run goes on, read back for pictures and comparisons.

use super::{at, malformed, number};
use crate::path::Row;
use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

#[cfg(test)]
mod test;

/// Writes `history.csv` so that a killed run keeps every finished line: each is formatted in memory and handed to the
/// kernel by one `write(2)`.
#[derive(Debug)]
pub struct HistoryWriter {
    file: File,
    path: PathBuf,
    line: Vec<u8>,
    values: usize,
    /// Length of the file.
    bytes: u64,
}

impl HistoryWriter {
    /// Creates the file with its header. The first two columns are `step,increment`, the last is `iterations`.
    pub fn create(path: &Path, columns: &[String]) -> io::Result<Self> {
        let values = value_count(path, columns)?;
        let mut header = csv::Writer::from_writer(Vec::new());
        header.write_record(columns).map_err(|error| malformed(path, error))?;
        let header = header.into_inner().map_err(|error| malformed(path, error))?;
        let mut file = File::create(path).map_err(at(path))?;
        file.write_all(&header).map_err(at(path))?;
        Ok(Self::of(file, path, values, header.len() as u64))
    }

    /// Goes on with a file after so many bytes; what is behind them is dropped.
    ///
    /// # Errors
    /// The file cannot be opened, or is shorter.
    pub fn resume(path: &Path, columns: &[String], bytes: u64) -> io::Result<Self> {
        let values = value_count(path, columns)?;
        let mut file = OpenOptions::new().write(true).open(path).map_err(at(path))?;
        let length = file.metadata().map_err(at(path))?.len();
        if length < bytes {
            return Err(malformed(path, format!("{length} bytes, of which {bytes} should be there already")));
        }
        file.set_len(bytes).map_err(at(path))?;
        file.seek(SeekFrom::Start(bytes)).map_err(at(path))?;
        Ok(Self::of(file, path, values, bytes))
    }

    fn of(file: File, path: &Path, values: usize, bytes: u64) -> Self {
        let longest = values * (number::EXACT_LENGTH + 1) + 3 * 11;
        Self { file, path: path.to_owned(), line: Vec::with_capacity(longest), values, bytes }
    }

    /// Length of the file so far.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Writes one line. On return it is in the kernel's hands; nothing is buffered here.
    pub fn write(&mut self, row: &Row<'_>) -> io::Result<()> {
        if row.values.len() != self.values {
            return Err(malformed(&self.path, format!("{} values for {} columns", row.values.len(), self.values)));
        }
        self.format(row);
        self.bytes += self.line.len() as u64;
        self.file.write_all(&self.line).map_err(at(&self.path))
    }

    /// Fills the line; its capacity suffices for any row, so nothing is allocated.
    fn format(&mut self, row: &Row<'_>) {
        let line = &mut self.line;
        line.clear();
        number::push_integer(line, row.step);
        line.push(b',');
        number::push_integer(line, row.increment);
        for &value in row.values {
            line.push(b',');
            number::push_exact(line, value);
        }
        line.push(b',');
        number::push_integer(line, row.iterations);
        line.push(b'\n');
    }
}

/// Values of a row: all columns but step, increment and iterations.
fn value_count(path: &Path, columns: &[String]) -> io::Result<usize> {
    columns.len().checked_sub(3).ok_or_else(|| malformed(path, "fewer than three columns"))
}

/// A history read back, by columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    columns: Vec<String>,
    data: Vec<Vec<f64>>,
}

impl History {
    /// Reads a file; a last line that a full disk cut off is left out.
    pub fn read(path: &Path) -> io::Result<Self> {
        let text = std::fs::read(path).map_err(at(path))?;
        let finished = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        let mut reader = csv::Reader::from_reader(&text[..finished]);
        let headers = reader.headers().map_err(|error| malformed(path, error))?;
        let columns: Vec<String> = headers.iter().map(String::from).collect();
        let mut data = vec![Vec::new(); columns.len()];
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record).map_err(|error| malformed(path, error))? {
            for (column, field) in data.iter_mut().zip(&record) {
                let line = record.position().map_or(0, csv::Position::line);
                let number = field.trim().parse();
                column.push(number.map_err(|_| malformed(path, format!("line {line}: `{field}` is not a number")))?);
            }
        }
        Ok(Self { columns, data })
    }

    /// A history from columns of equal length.
    pub fn from_columns(columns: Vec<(String, Vec<f64>)>) -> Self {
        let (columns, data) = columns.into_iter().unzip();
        Self { columns, data }
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Number of lines, the initial state included.
    pub fn rows(&self) -> usize {
        self.data.first().map_or(0, Vec::len)
    }

    /// Hands on every row. Its first two columns are step and increment, the last is the iterations.
    pub fn each_row(&self, mut row: impl FnMut(Row<'_>)) {
        let [steps, increments, values @ .., iterations] = self.data.as_slice() else { return };
        let mut line = vec![0.0; values.len()];
        for (k, (step, increment)) in steps.iter().zip(increments).enumerate() {
            line.iter_mut().zip(values).for_each(|(value, column)| *value = column[k]);
            row(Row {
                step: *step as u32,
                increment: *increment as u32,
                values: &line,
                iterations: iterations[k] as u32,
            });
        }
    }

    /// A column by name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.column_at(self.columns.iter().position(|column| column == name)?)
    }

    /// A column by index.
    pub fn column_at(&self, index: usize) -> Option<&[f64]> {
        self.data.get(index).map(Vec::as_slice)
    }
}

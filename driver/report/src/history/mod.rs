//! `history.csv`: written line by line as the run goes on, read back for pictures and comparisons.

use super::{at, malformed};
use pullout_run::input;
use pullout_run::input::{digest, hexadecimal};
use pullout_run::isolation::{out_of_reach, worker};
use pullout_run::number;
use pullout_run::path::Row;
use rustix::io::Errno;
use sha2::{Digest, Sha256};
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::ControlFlow;
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
    /// Digest of the file so far, if checkpoints shall know it.
    digest: Option<Sha256>,
}

impl HistoryWriter {
    /// Creates the file with its header. The first two columns are `step,increment`, the last is `iterations`.
    /// `is_hashed`: [`HistoryWriter::digest`] is wanted.
    pub fn create(path: &Path, columns: &[String], is_hashed: bool) -> io::Result<Self> {
        let values = value_count(path, columns)?;
        let mut header = csv::Writer::from_writer(Vec::new());
        header.write_record(columns).map_err(|error| malformed(path, error))?;
        let header = header.into_inner().map_err(|error| malformed(path, error))?;
        let mut file = File::create(path).map_err(at(path))?;
        file.write_all(&header).map_err(at(path))?;
        Ok(Self::of(file, path, values, header.len() as u64, is_hashed.then(|| Sha256::new_with_prefix(&header))))
    }

    /// Continues a file after so many bytes. The rest is dropped.
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
        Ok(Self::of(file, path, values, bytes, Some(digest(path, bytes).map_err(at(path))?)))
    }

    fn of(file: File, path: &Path, values: usize, bytes: u64, digest: Option<Sha256>) -> Self {
        let file = out_of_reach(file);
        let longest = values * (number::EXACT_LENGTH + 1) + 3 * 11;
        Self { file, path: path.to_owned(), line: Vec::with_capacity(longest), values, bytes, digest }
    }

    /// Length of the file so far.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// SHA-256 of the file so far, hexadecimal; empty if it was not asked for.
    pub fn digest(&self) -> String {
        self.digest.clone().map_or(String::new(), hexadecimal)
    }

    /// Writes one line. On return it is in the kernel's hands; nothing is buffered here.
    pub fn write(&mut self, row: &Row<'_>) -> io::Result<()> {
        if row.values.len() != self.values {
            return Err(malformed(&self.path, format!("{} values for {} columns", row.values.len(), self.values)));
        }
        self.format(row);
        if let Err(error) = self.file.write_all(&self.line) {
            if error.raw_os_error() == Some(Errno::BADF.raw_os_error()) {
                worker::end_for_closed_output();
            }
            // a full disk takes a part of a line
            let _ = self.file.set_len(self.bytes);
            return Err(at(&self.path)(error));
        }
        self.bytes += self.line.len() as u64;
        if let Some(digest) = &mut self.digest {
            digest.update(&self.line);
        }
        Ok(())
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

/// The tables of a run of kind "bridging" that have curves.
pub(crate) const BRIDGING_TABLES: [&str; 2] = ["bridging.csv", "beam.csv"];

/// A history read back, by columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    columns: Vec<String>,
    data: Vec<Vec<f64>>,
}

impl History {
    /// Reads a file; a last line that a full disk cut off is left out.
    pub fn read(path: &Path) -> io::Result<Self> {
        HistoryFile::open(path)?.read()
    }

    /// A history from columns of equal length.
    pub fn from_columns(columns: Vec<(String, Vec<f64>)>) -> Self {
        let (columns, data) = columns.into_iter().unzip();
        Self { columns, data }
    }

    /// A history without rows.
    pub fn empty(columns: Vec<String>) -> Self {
        Self { data: vec![Vec::new(); columns.len()], columns }
    }

    /// Adds a row. The first two columns are step and increment, the last is the iterations.
    pub fn push(&mut self, row: &Row<'_>) {
        let place = [row.step, row.increment].map(f64::from);
        let values = place.into_iter().chain(row.values.iter().copied()).chain([f64::from(row.iterations)]);
        self.data.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
    }

    /// Names and values of the columns.
    pub fn into_columns(self) -> impl Iterator<Item = (String, Vec<f64>)> {
        self.columns.into_iter().zip(self.data)
    }

    /// Returns what a run left in its folder, each table read by `read`: `history.csv`, or else the tables of a case of kind
    /// "bridging", whose columns stand side by side and have different lengths.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn of_run(folder: &Path, read: impl Fn(HistoryFile) -> io::Result<Self>) -> io::Result<Self> {
        let history = folder.join("history.csv");
        let tables: Vec<PathBuf> =
            BRIDGING_TABLES.iter().map(|name| folder.join(name)).filter(|table| table.is_file()).collect();
        if tables.is_empty() || history.is_file() {
            return read(HistoryFile::open(&history)?);
        }
        let mut all = Self::default();
        for table in tables {
            let Self { columns, data } = read(HistoryFile::open(&table)?)?;
            all.columns.extend(columns);
            all.data.extend(data);
        }
        Ok(all)
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Number of lines, the initial state included.
    pub fn rows(&self) -> usize {
        self.data.first().map_or(0, Vec::len)
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

/// Values that a history read back for pictures has in memory, about: 32 MB.
const MOST_VALUES: usize = 4_000_000;
/// Stretches that a longer one is thinned by: a picture has fewer.
const STRETCHES: std::ops::RangeInclusive<usize> = 350..=2000;

/// A history in its file, which is read row by row: it may be longer than memory.
#[derive(Debug)]
pub struct HistoryFile {
    path: PathBuf,
    columns: Vec<String>,
    /// Bytes of whole lines; a last line that a full disk cut off is left out.
    finished: u64,
}

impl HistoryFile {
    /// Opens a file that is there.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn open(path: &Path) -> io::Result<Self> {
        let finished = whole_lines(path).map_err(at(path))?;
        let mut file = Self { path: path.to_owned(), columns: Vec::new(), finished };
        let headers = file.reader()?.headers().map_err(|error| malformed(path, error))?.clone();
        file.columns = headers.iter().map(String::from).collect();
        Ok(file)
    }

    fn reader(&self) -> io::Result<csv::Reader<io::Take<File>>> {
        let file = input::open(&self.path).map_err(at(&self.path))?;
        Ok(csv::ReaderBuilder::new().buffer_capacity(1 << 16).from_reader(file.take(self.finished)))
    }

    /// Passes the numbers in some columns to `row`, row by row, until it returns [`ControlFlow::Break`].
    fn each(&self, wanted: &[usize], row: &mut dyn FnMut(&[f64]) -> ControlFlow<()>) -> io::Result<()> {
        let mut reader = self.reader()?;
        let mut record = csv::StringRecord::new();
        let mut values = vec![0.0; wanted.len()];
        while reader.read_record(&mut record).map_err(|error| malformed(&self.path, error))? {
            for (value, &column) in values.iter_mut().zip(wanted) {
                let field = record.get(column).unwrap_or_default();
                let line = record.position().map_or(0, csv::Position::line);
                let number = field.trim().parse();
                *value =
                    number.map_err(|_| malformed(&self.path, format!("line {line}: `{field}` is not a number")))?;
            }
            if row(&values).is_break() {
                break;
            }
        }
        Ok(())
    }

    fn all(&self) -> Vec<usize> {
        (0..self.columns.len()).collect()
    }

    /// Hands on every row. Its first two columns are step and increment, the last is the iterations.
    ///
    /// # Errors
    /// The file cannot be read, or holds something else.
    pub(crate) fn each_row(&self, mut row: impl FnMut(Row<'_>)) -> io::Result<()> {
        self.each(&self.all(), &mut |values| {
            if let [step, increment, values @ .., iterations] = values {
                let (step, increment, iterations) = (*step as u32, *increment as u32, *iterations as u32);
                row(Row { step, increment, values, iterations });
            }
            ControlFlow::Continue(())
        })
    }

    /// All of it in memory.
    ///
    /// # Errors
    /// The file cannot be read, or holds something else.
    pub fn read(&self) -> io::Result<History> {
        self.read_columns(&self.columns)
    }

    /// Columns of it in memory; those of other names are left out.
    ///
    /// # Errors
    /// The file cannot be read, or holds something else.
    pub fn read_columns<S: AsRef<str>>(&self, names: &[S]) -> io::Result<History> {
        let is_wanted = |k: &usize| names.iter().any(|name| name.as_ref() == self.columns[*k]);
        let wanted: Vec<usize> = self.all().into_iter().filter(is_wanted).collect();
        let mut data = vec![Vec::new(); wanted.len()];
        self.each(&wanted, &mut |values| {
            data.iter_mut().zip(values).for_each(|(column, &value)| column.push(value));
            ControlFlow::Continue(())
        })?;
        Ok(History { columns: wanted.into_iter().map(|k| self.columns[k].clone()).collect(), data })
    }

    /// Returns the rows that pictures need: all rows of a history of usual length. A longer history is cut into many sections, and
    /// each keeps its first and last row and the rows where a column is largest, smallest or NaN. Peaks, loops and gaps remain.
    ///
    /// # Errors
    /// The file cannot be read, or holds something else.
    pub fn for_pictures(&self) -> io::Result<History> {
        self.thinned(MOST_VALUES)
    }

    /// Thins the rows as for [`HistoryFile::for_pictures`]. It keeps about `most` values.
    fn thinned(&self, most: usize) -> io::Result<History> {
        let columns = self.columns.len().max(1);
        let rows = self.rows()?;
        if rows.saturating_mul(columns) <= most {
            return self.read();
        }
        // two rows of a stretch, and three for each column
        let stretches = (2 * most / (columns * (2 + 3 * columns))).clamp(*STRETCHES.start(), *STRETCHES.end());
        let length = rows.div_ceil(stretches);
        let mut data = vec![Vec::new(); columns];
        let mut stretch = Vec::with_capacity(length * columns);
        self.each(&self.all(), &mut |values| {
            stretch.extend_from_slice(values);
            if stretch.len() == length * columns {
                keep_extremes(&stretch, &mut data);
                stretch.clear();
            }
            ControlFlow::Continue(())
        })?;
        keep_extremes(&stretch, &mut data);
        Ok(History { columns: self.columns.clone(), data })
    }

    /// Number of lines but the header.
    fn rows(&self) -> io::Result<usize> {
        let mut file = input::open(&self.path).map_err(at(&self.path))?.take(self.finished);
        let (mut block, mut lines) = (vec![0; 1 << 16], 0_usize);
        loop {
            match file.read(&mut block).map_err(at(&self.path))? {
                0 => return Ok(lines.saturating_sub(1)),
                length => lines += memchr::memchr_iter(b'\n', &block[..length]).count(),
            }
        }
    }
}

/// Adds to each column of `data` the rows of a stretch (row by row) that its drawn lines go through.
fn keep_extremes(stretch: &[f64], data: &mut [Vec<f64>]) {
    let columns = data.len();
    let rows = stretch.len() / columns;
    if rows == 0 {
        return;
    }
    let mut kept = vec![0, rows - 1];
    for column in 0..columns {
        let value = |row: usize| stretch[row * columns + column];
        let numbers = || (0..rows).filter(|&row| value(row).is_finite());
        kept.extend(numbers().min_by(|&a, &b| value(a).total_cmp(&value(b))));
        kept.extend(numbers().max_by(|&a, &b| value(a).total_cmp(&value(b))));
        kept.extend((0..rows).find(|&row| !value(row).is_finite()));
    }
    kept.sort_unstable();
    kept.dedup();
    for row in kept {
        data.iter_mut().zip(&stretch[row * columns..]).for_each(|(column, &value)| column.push(value));
    }
}

/// Length of a file up to the end of its last whole line.
fn whole_lines(path: &Path) -> io::Result<u64> {
    const BLOCK: u64 = 4096;
    let mut file = input::open(path)?;
    let mut end = file.metadata()?.len();
    let mut block = Vec::new();
    while end > 0 {
        let start = end.saturating_sub(BLOCK);
        file.seek(SeekFrom::Start(start))?;
        block.clear();
        (&mut file).take(end - start).read_to_end(&mut block)?;
        if let Some(position) = block.iter().rposition(|&byte| byte == b'\n') {
            return Ok(start + position as u64 + 1);
        }
        end = start;
    }
    Ok(0)
}

/// A source of rows in which two columns can be traversed repeatedly.
pub trait Rows {
    /// Names of the columns.
    fn columns(&self) -> &[String];

    /// Passes x and y of each row to `each` until it returns [`ControlFlow::Break`]; nothing if there are no such columns.
    ///
    /// # Errors
    /// They cannot be read.
    fn pairs(&self, x: usize, y: usize, each: &mut dyn FnMut(f64, f64) -> ControlFlow<()>) -> io::Result<()>;
}

impl Rows for HistoryFile {
    fn columns(&self) -> &[String] {
        &self.columns
    }

    fn pairs(&self, x: usize, y: usize, each: &mut dyn FnMut(f64, f64) -> ControlFlow<()>) -> io::Result<()> {
        if x.max(y) >= self.columns.len() {
            return Ok(());
        }
        self.each(&[x, y], &mut |values| each(values[0], values[1]))
    }
}

impl Rows for History {
    fn columns(&self) -> &[String] {
        &self.columns
    }

    fn pairs(&self, x: usize, y: usize, each: &mut dyn FnMut(f64, f64) -> ControlFlow<()>) -> io::Result<()> {
        let (Some(x), Some(y)) = (self.column_at(x), self.column_at(y)) else { return Ok(()) };
        let _ = x.iter().zip(y).try_for_each(|(&x, &y)| each(x, y));
        Ok(())
    }
}

//! A table in a file: columns of texts, numbers, counts and lists of numbers, a row each line as an object of JSON.

use pullout_report::at;
use serde::de::{DeserializeSeed, IgnoredAny, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// The values of a column, a row each; `None`: the row has none.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// Texts.
    Text(Vec<Option<String>>),
    /// Numbers.
    Number(Vec<Option<f64>>),
    /// Whole numbers.
    Count(Vec<Option<i64>>),
    /// Lists of numbers.
    List(Vec<Vec<f64>>),
}

impl Column {
    /// The texts, if it has any.
    pub fn texts(&self) -> &[Option<String>] {
        if let Self::Text(texts) = self { texts } else { &[] }
    }

    /// The number in a row.
    pub fn number(&self, row: usize) -> Option<f64> {
        match self {
            Self::Number(numbers) => *numbers.get(row)?,
            Self::Count(counts) => counts.get(row)?.map(|count| count as f64),
            Self::Text(_) | Self::List(_) => None,
        }
    }

    /// Numbers that are whole, as such.
    pub(crate) fn whole(self) -> Self {
        match self {
            Self::Number(numbers) => {
                Self::Count(numbers.into_iter().map(|number| number.map(|number| number as i64)).collect())
            }
            other => other,
        }
    }

    fn rows(&self) -> usize {
        match self {
            Self::Text(values) => values.len(),
            Self::Number(values) => values.len(),
            Self::Count(values) => values.len(),
            Self::List(values) => values.len(),
        }
    }

    /// Adds a row of another column of the same kind; an empty one of any other.
    fn push(&mut self, other: Option<&Self>, row: usize) {
        match self {
            Self::Text(texts) => texts.push(other.and_then(|other| other.texts().get(row)?.clone())),
            Self::Number(numbers) => numbers.push(other.and_then(|other| other.number(row))),
            Self::Count(counts) => counts.push(match other {
                Some(Self::Count(others)) => others.get(row).copied().flatten(),
                _ => None,
            }),
            Self::List(lists) => lists.push(match other {
                Some(Self::List(others)) => others.get(row).cloned().unwrap_or_default(),
                _ => Vec::new(),
            }),
        }
    }

    /// The value in a row as text of a CSV table; `None`: no such table has lists.
    fn shown(&self, row: usize) -> Option<String> {
        match self {
            Self::Text(texts) => Some(texts.get(row).cloned().flatten().unwrap_or_default()),
            Self::Number(numbers) => Some(numbers.get(row)?.map_or_else(String::new, |number| number.to_string())),
            Self::Count(counts) => Some(counts.get(row)?.map_or_else(String::new, |count| count.to_string())),
            Self::List(_) => None,
        }
    }
}

/// Named columns of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Names and values.
    pub columns: Vec<(String, Column)>,
}

impl Table {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, column)| column.rows())
    }

    /// A column by its name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|(other, _)| other == name).map(|(_, column)| column)
    }

    /// Adds rows of other tables, each by the number of the table and the row in it; `None`: an empty one.
    pub fn gather(&mut self, tables: &[Self], rows: &[Option<(usize, usize)>]) {
        for (name, column) in &mut self.columns {
            let theirs: Vec<Option<&Column>> = tables.iter().map(|table| table.column(name)).collect();
            for row in rows {
                let (theirs, row) = row.map_or((None, 0), |(table, row)| (theirs[table], row));
                column.push(theirs, row);
            }
        }
    }

    /// Writes a file of lines and puts it into its place at once.
    ///
    /// # Errors
    /// The table cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        replace(path, |file| self.write_lines(BufWriter::new(file)), |_| Ok(()))
    }

    /// Writes a line for each row; numbers that are not finite are `null`.
    ///
    /// # Errors
    /// The table cannot be written.
    pub fn write_lines(&self, mut to: impl Write) -> io::Result<()> {
        for row in 0..self.rows() {
            serde_json::to_writer(&mut to, &Row { table: self, row })?;
            to.write_all(b"\n")?;
        }
        to.flush()
    }

    /// Reads columns of a file of lines; `wants`: by their names. In lists `null` is NaN.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(path: &Path, wants: impl Fn(&str) -> bool) -> io::Result<Self> {
        let content = fs::read(path).map_err(at(path))?;
        let mut columns: Vec<(String, Vec<Option<Cell>>)> = Vec::new();
        let lines = content.split(|byte| *byte == b'\n').filter(|line| !line.is_empty());
        for (row, line) in lines.enumerate() {
            let mut json = serde_json::Deserializer::from_slice(line);
            let cells = Wanted(&wants).deserialize(&mut json).and_then(|cells| json.end().map(|()| cells));
            let cells = cells.map_err(|error| {
                let message = format!("{}: row {}: {error}", path.display(), row + 1);
                io::Error::new(io::ErrorKind::InvalidData, message)
            })?;
            for (index, (name, cell)) in cells.into_iter().enumerate() {
                // rows of a file have their cells in the same order
                let there = columns.get(index).filter(|(other, _)| *other == name).map(|_| index);
                let there = there.or_else(|| columns.iter().position(|(other, _)| *other == name));
                let index = there.unwrap_or_else(|| {
                    columns.push((name, Vec::new()));
                    columns.len() - 1
                });
                columns[index].1.resize_with(row, || None);
                columns[index].1.push(cell);
            }
        }
        let rows = columns.iter().map(|(_, cells)| cells.len()).max().unwrap_or_default();
        let column = |(name, mut cells): (String, Vec<Option<Cell>>)| {
            cells.resize_with(rows, || None);
            (name, Column::of(cells))
        };
        Ok(Self { columns: columns.into_iter().map(column).collect() })
    }

    /// Writes a CSV table without the lists.
    ///
    /// # Errors
    /// The table cannot be written.
    pub fn write_csv(&self, to: impl io::Write) -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(to);
        let columns = || self.columns.iter().filter(|(_, column)| !matches!(column, Column::List(_)));
        writer.write_record(columns().map(|(name, _)| name))?;
        for row in 0..self.rows() {
            writer.write_record(columns().map(|(_, column)| column.shown(row).unwrap_or_default()))?;
        }
        writer.flush()
    }
}

/// Writes a file next to its final place and moves it there. `before` is called with the complete file before it is moved.
pub(crate) fn replace(
    path: &Path,
    write: impl FnOnce(&File) -> io::Result<()>,
    before: impl FnOnce(&Path) -> io::Result<()>,
) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let replace = || {
        let file = tempfile::Builder::new().prefix(".part").tempfile_in(folder)?;
        write(file.as_file())?;
        file.as_file().sync_all()?;
        readable_by_all(file.as_file())?;
        before(file.path())?;
        file.persist(path)?;
        Ok(())
    };
    replace().map_err(at(path))
}

/// Temporary files are their owner's alone; what lies in a store others may read.
fn readable_by_all(file: &File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

/// A row of a table.
struct Row<'t> {
    table: &'t Table,
    row: usize,
}

impl Serialize for Row<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut cells = serializer.serialize_map(Some(self.table.columns.len()))?;
        for (name, column) in &self.table.columns {
            match column {
                Column::Text(texts) => cells.serialize_entry(name, &texts[self.row])?,
                Column::Number(numbers) => cells.serialize_entry(name, &numbers[self.row])?,
                Column::Count(counts) => cells.serialize_entry(name, &counts[self.row])?,
                Column::List(lists) => cells.serialize_entry(name, &lists[self.row])?,
            }
        }
        cells.end()
    }
}

/// Cell of a row.
#[derive(Deserialize)]
#[serde(untagged)]
enum Cell {
    Text(String),
    Count(i64),
    Number(f64),
    List(Vec<Option<f64>>),
}

impl Column {
    /// Makes the column of cells. The first cell that exists determines the kind.
    fn of(cells: Vec<Option<Cell>>) -> Self {
        fn all<V>(cells: Vec<Option<Cell>>, value: impl Fn(Cell) -> Option<V>) -> Vec<Option<V>> {
            cells.into_iter().map(|cell| cell.and_then(&value)).collect()
        }
        match cells.iter().flatten().next() {
            None | Some(Cell::Text(_)) => {
                Self::Text(all(cells, |cell| if let Cell::Text(text) = cell { Some(text) } else { None }))
            }
            Some(Cell::Count(_)) => {
                Self::Count(all(cells, |cell| if let Cell::Count(count) = cell { Some(count) } else { None }))
            }
            Some(Cell::Number(_)) => {
                Self::Number(all(cells, |cell| if let Cell::Number(number) = cell { Some(number) } else { None }))
            }
            Some(Cell::List(_)) => {
                let list = |cell| if let Cell::List(list) = cell { Some(list) } else { None };
                let numbers = |list: Option<Vec<Option<f64>>>| {
                    list.unwrap_or_default().into_iter().map(|number| number.unwrap_or(f64::NAN)).collect()
                };
                Self::List(all(cells, list).into_iter().map(numbers).collect())
            }
        }
    }
}

/// Reads the cells of a row with the wanted names.
struct Wanted<'w, W>(&'w W);

impl<'de, W: Fn(&str) -> bool> DeserializeSeed<'de> for Wanted<'_, W> {
    type Value = Vec<(String, Option<Cell>)>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de, W: Fn(&str) -> bool> Visitor<'de> for Wanted<'_, W> {
    type Value = Vec<(String, Option<Cell>)>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a row")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Self::Value, A::Error> {
        let mut cells = Vec::new();
        while let Some(name) = members.next_key::<String>()? {
            if self.0(&name) {
                cells.push((name, members.next_value()?));
            } else {
                members.next_value::<IgnoredAny>()?;
            }
        }
        Ok(cells)
    }
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn a_full_disk_is_reported_with_the_name_of_the_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("table.jsonl");
        let table = Table { columns: vec![("a".into(), Column::Number(vec![Some(1.0)]))] };
        let full = File::options().write(true).open("/dev/full").expect("a device");
        let error = replace(&path, |_| table.write_lines(&full), |_| Ok(())).expect_err("no space");
        assert_eq!(error.to_string(), format!("{}: No space left on device (os error 28)", path.display()));
    }
}

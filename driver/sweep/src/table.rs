//! A table in a Parquet file: columns of texts, numbers, counts and lists of numbers.

use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType, ZstdLevel};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::{ParquetError, Result};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};
use pullout_report::at;
use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;

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

    /// The column of the schema.
    fn field(&self, name: &str) -> Result<TypePtr> {
        let optional = |kind| Type::primitive_type_builder(name, kind).with_repetition(Repetition::OPTIONAL);
        Ok(Arc::new(match self {
            Self::Text(_) => optional(PhysicalType::BYTE_ARRAY).with_logical_type(Some(LogicalType::String)).build()?,
            Self::Number(_) => optional(PhysicalType::DOUBLE).build()?,
            Self::Count(_) => optional(PhysicalType::INT64).build()?,
            Self::List(_) => {
                let element = Type::primitive_type_builder("element", PhysicalType::DOUBLE)
                    .with_repetition(Repetition::REQUIRED)
                    .build()?;
                let list = Type::group_type_builder("list")
                    .with_repetition(Repetition::REPEATED)
                    .with_fields(vec![Arc::new(element)])
                    .build()?;
                Type::group_type_builder(name)
                    .with_repetition(Repetition::REQUIRED)
                    .with_logical_type(Some(LogicalType::List))
                    .with_fields(vec![Arc::new(list)])
                    .build()?
            }
        }))
    }

    fn write(&self, writer: &mut ColumnWriter<'_>) -> Result<usize> {
        fn levels<T>(values: &[Option<T>]) -> Vec<i16> {
            values.iter().map(|value| i16::from(value.is_some())).collect()
        }
        match (self, writer) {
            (Self::Text(texts), ColumnWriter::ByteArrayColumnWriter(writer)) => {
                let values: Vec<ByteArray> = texts.iter().flatten().map(|text| text.as_str().into()).collect();
                writer.write_batch(&values, Some(&levels(texts)), None)
            }
            (Self::Number(numbers), ColumnWriter::DoubleColumnWriter(writer)) => {
                let values: Vec<f64> = numbers.iter().copied().flatten().collect();
                writer.write_batch(&values, Some(&levels(numbers)), None)
            }
            (Self::Count(counts), ColumnWriter::Int64ColumnWriter(writer)) => {
                let values: Vec<i64> = counts.iter().copied().flatten().collect();
                writer.write_batch(&values, Some(&levels(counts)), None)
            }
            (Self::List(lists), ColumnWriter::DoubleColumnWriter(writer)) => {
                let (mut defined, mut repeated) = (Vec::new(), Vec::new());
                for list in lists {
                    defined.extend(std::iter::repeat_n(i16::from(!list.is_empty()), list.len().max(1)));
                    repeated.extend((0..list.len().max(1)).map(|k| i16::from(k > 0)));
                }
                writer.write_batch(&lists.concat(), Some(&defined), Some(&repeated))
            }
            _ => Ok(0),
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

    /// Writes a Parquet file and puts it into its place at once.
    ///
    /// # Errors
    /// The table cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        replace(path, |file| self.write_parquet(file), |_| Ok(()))
    }

    /// Writes a Parquet file.
    pub(crate) fn write_parquet(&self, file: &File) -> io::Result<()> {
        self.write_to(file).map_err(|error| match error {
            ParquetError::External(error) => error.downcast().map_or_else(io::Error::other, |error| *error),
            other => io::Error::other(other),
        })
    }

    fn write_to(&self, file: &File) -> Result<()> {
        let fields: Result<Vec<TypePtr>> = self.columns.iter().map(|(name, column)| column.field(name)).collect();
        let schema = Type::group_type_builder("runs").with_fields(fields?).build()?;
        let properties = WriterProperties::builder().set_compression(Compression::ZSTD(ZstdLevel::default())).build();
        let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))?;
        let mut group = writer.next_row_group()?;
        for (_, column) in &self.columns {
            if let Some(mut place) = group.next_column()? {
                column.write(place.untyped())?;
                place.close()?;
            }
        }
        group.close()?;
        writer.close()?;
        Ok(())
    }

    /// Reads the columns of a Parquet file that this module wrote; `wants`: by their names.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(path: &Path, wants: impl Fn(&str) -> bool) -> io::Result<Self> {
        let read = || -> Result<Self> {
            let reader = SerializedFileReader::new(File::open(path)?)?;
            let schema = reader.metadata().file_metadata().schema_descr_ptr();
            let mut table = Self::default();
            for (index, leaf) in schema.columns().iter().enumerate() {
                let Some(name) = leaf.path().parts().first().filter(|name| wants(name)) else { continue };
                let mut column = match (leaf.max_rep_level(), leaf.physical_type()) {
                    (0, PhysicalType::BYTE_ARRAY) => Column::Text(Vec::new()),
                    (0, PhysicalType::DOUBLE) => Column::Number(Vec::new()),
                    (0, PhysicalType::INT64) => Column::Count(Vec::new()),
                    _ => Column::List(Vec::new()),
                };
                for group in 0..reader.num_row_groups() {
                    let group = reader.get_row_group(group)?;
                    let rows = usize::try_from(group.metadata().num_rows()).unwrap_or_default();
                    read_column(&mut column, group.get_column_reader(index)?, rows)?;
                }
                table.columns.push((name.clone(), column));
            }
            Ok(table)
        };
        read().map_err(|error| io::Error::new(io::ErrorKind::InvalidData, format!("{}: {error}", path.display())))
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

/// Writes a file beside its place and moves it there; `before` hears of the whole file while it is not in its place yet.
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

/// Values with their levels: whether they are there, and whether they go on with a list.
type Records<V> = (Vec<V>, [Vec<i16>; 2]);

fn records<T: DataType>(mut reader: ColumnReaderImpl<T>, rows: usize) -> Result<Records<T::T>> {
    let (mut values, mut defined, mut repeated) = (Vec::new(), Vec::new(), Vec::new());
    let mut read = 0;
    while read < rows {
        let (records, ..) = reader.read_records(rows - read, Some(&mut defined), Some(&mut repeated), &mut values)?;
        if records == 0 {
            break;
        }
        read += records;
    }
    Ok((values, [defined, repeated]))
}

/// Puts values where their levels are not 0.
fn optional<T>(values: Vec<T>, defined: &[i16]) -> impl Iterator<Item = Option<T>> {
    let mut values = values.into_iter();
    defined.iter().map(move |&level| if level > 0 { values.next() } else { None })
}

fn read_column(column: &mut Column, reader: ColumnReader, rows: usize) -> Result<()> {
    match (column, reader) {
        (Column::Text(texts), ColumnReader::ByteArrayColumnReader(reader)) => {
            let (values, [defined, _]) = records(reader, rows)?;
            let text = |bytes: ByteArray| String::from_utf8_lossy(bytes.data()).into_owned();
            texts.extend(optional(values, &defined).map(|bytes| bytes.map(text)));
        }
        (Column::Number(numbers), ColumnReader::DoubleColumnReader(reader)) => {
            let (values, [defined, _]) = records(reader, rows)?;
            numbers.extend(optional(values, &defined));
        }
        (Column::Count(counts), ColumnReader::Int64ColumnReader(reader)) => {
            let (values, [defined, _]) = records(reader, rows)?;
            counts.extend(optional(values, &defined));
        }
        (Column::List(lists), ColumnReader::DoubleColumnReader(reader)) => {
            let (values, [defined, repeated]) = records(reader, rows)?;
            for (value, again) in optional(values, &defined).zip(repeated) {
                if again == 0 {
                    lists.push(Vec::new());
                }
                if let (Some(list), Some(value)) = (lists.last_mut(), value) {
                    list.push(value);
                }
            }
        }
        _ => {}
    }
    Ok(())
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn a_full_disk_is_told_with_the_name_of_the_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("table.parquet");
        let table = Table { columns: vec![("a".into(), Column::Number(vec![Some(1.0)]))] };
        let full = File::options().write(true).open("/dev/full").expect("a device");
        let error = replace(&path, |_| table.write_parquet(&full), |_| Ok(())).expect_err("no space");
        assert_eq!(error.to_string(), format!("{}: No space left on device (os error 28)", path.display()));
    }
}

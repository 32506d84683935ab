//! Tables as Parquet files, for other programs: in builds with the feature `parquet`.

use crate::table::{Column, Table};
use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::{ParquetError, Result};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};
use std::fs::File;
use std::io;
use std::sync::Arc;

/// Writes a table.
pub(crate) fn write(table: &Table, file: &File) -> io::Result<()> {
    write_to(table, file).map_err(|error| match error {
        ParquetError::External(error) => error.downcast().map_or_else(io::Error::other, |error| *error),
        other => io::Error::other(other),
    })
}

fn write_to(table: &Table, file: &File) -> Result<()> {
    let fields: Result<Vec<TypePtr>> = table.columns.iter().map(|(name, column)| field(column, name)).collect();
    let schema = Type::group_type_builder("runs").with_fields(fields?).build()?;
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (_, column) in &table.columns {
        if let Some(mut place) = group.next_column()? {
            write_column(column, place.untyped())?;
            place.close()?;
        }
    }
    group.close()?;
    writer.close()?;
    Ok(())
}

/// The column of the schema.
fn field(column: &Column, name: &str) -> Result<TypePtr> {
    let optional = |kind| Type::primitive_type_builder(name, kind).with_repetition(Repetition::OPTIONAL);
    Ok(Arc::new(match column {
        Column::Text(_) => optional(PhysicalType::BYTE_ARRAY).with_logical_type(Some(LogicalType::String)).build()?,
        Column::Number(_) => optional(PhysicalType::DOUBLE).build()?,
        Column::Count(_) => optional(PhysicalType::INT64).build()?,
        Column::List(_) => {
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

fn write_column(column: &Column, writer: &mut ColumnWriter<'_>) -> Result<usize> {
    fn levels<T>(values: &[Option<T>]) -> Vec<i16> {
        values.iter().map(|value| i16::from(value.is_some())).collect()
    }
    match (column, writer) {
        (Column::Text(texts), ColumnWriter::ByteArrayColumnWriter(writer)) => {
            let values: Vec<ByteArray> = texts.iter().flatten().map(|text| text.as_str().into()).collect();
            writer.write_batch(&values, Some(&levels(texts)), None)
        }
        (Column::Number(numbers), ColumnWriter::DoubleColumnWriter(writer)) => {
            let values: Vec<f64> = numbers.iter().copied().flatten().collect();
            writer.write_batch(&values, Some(&levels(numbers)), None)
        }
        (Column::Count(counts), ColumnWriter::Int64ColumnWriter(writer)) => {
            let values: Vec<i64> = counts.iter().copied().flatten().collect();
            writer.write_batch(&values, Some(&levels(counts)), None)
        }
        (Column::List(lists), ColumnWriter::DoubleColumnWriter(writer)) => {
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

#[cfg(test)]
mod test {
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    #[test]
    fn a_parquet_file_has_all_that_the_table_has() {
        let table = Table {
            columns: vec![
                ("a.b".into(), Column::Text(vec![Some("x".into()), None])),
                ("number".into(), Column::Number(vec![None, Some(0.1)])),
                ("count".into(), Column::Count(vec![Some(3), Some(-1)])),
                ("list".into(), Column::List(vec![vec![], vec![1.0, 2.0]])),
            ],
        };
        let file = tempfile::tempfile().expect("a file");
        write(&table, &file).expect("written");
        let reader = SerializedFileReader::new(file).expect("a Parquet file");
        let rows = reader.get_row_iter(None).expect("rows").map(|row| row.expect("a row"));
        let found: Vec<Vec<(String, Field)>> = rows.map(|row| row.into_columns()).collect();
        let names = |row: &[(String, Field)]| row.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        assert_eq!(found.len(), 2);
        assert_eq!(names(&found[0]), ["a.b", "number", "count", "list"]);
        let shown = |row: &[(String, Field)]| row.iter().map(|(_, field)| field.to_string()).collect::<Vec<_>>();
        assert_eq!(shown(&found[0]), ["\"x\"", "null", "3", "[]"]);
        assert_eq!(shown(&found[1]), ["null", "0.1", "-1", "[1.0, 2.0]"]);
    }
}

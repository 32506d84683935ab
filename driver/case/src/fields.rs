//! Temperature and field variables: initial values, ends of steps, columns of tables.

use crate::document::{Course, StepEnd, TableSource};
use crate::problem::Place;
use crate::reader::Reader;
use crate::table::{CsvFile, Table};
use pullout_run::program::{FieldValues, StepFields};
use std::rc::Rc;

/// The column, and the key.
const TEMPERATURE: &str = "temperature";
const PREDEF: &str = "predef";

/// Values at the start.
pub fn initial(course: &Course) -> FieldValues {
    FieldValues {
        temperature: course.temperature.unwrap_or_default(),
        variables: course.predef.clone().unwrap_or_default(),
    }
}

/// Values at the end of a step of a case with `count` field variables.
pub fn of_step(reader: &mut Reader<'_>, end: &StepEnd, count: usize, place: &Place) -> StepFields {
    let StepEnd { temperature, predef, .. } = end;
    check_count(reader, predef.as_deref(), count, &place.key(PREDEF));
    StepFields { temperature: *temperature, predef: predef.clone(), ..StepFields::default() }
}

/// Values at a place must be of the case's field variables.
pub fn check_count(reader: &mut Reader<'_>, values: Option<&[f64]>, count: usize, place: &Place) {
    if let Some(values) = values
        && values.len() != count
    {
        let given = values.len();
        let message = format!("{given} values given, but the case has {count} initial field variables ($.{PREDEF})");
        reader.problem(place, message);
    }
}

/// Reads the table of a step, with the name of its file for messages: its columns are `components`, then the temperature and
/// `count` field variables.
pub fn read_table(
    reader: &mut Reader<'_>,
    source: &TableSource,
    components: &[&str],
    count: usize,
    place: &Place,
) -> Option<(String, Rc<Table>)> {
    let variables: Vec<String> = (1..=count).map(|number| format!("{PREDEF}{number}")).collect();
    let of_fields = [TEMPERATURE].into_iter().chain(variables.iter().map(String::as_str));
    let names: Vec<&str> = components.iter().copied().chain(of_fields).collect();
    let (file, table) = match source {
        TableSource::File(name) => {
            let path = reader.file(name, place)?;
            (path.display().to_string(), reader.table(&path, &names))
        }
        TableSource::Columns(columns) => {
            let csv = reader.without_problems(CsvFile::of_columns(columns), place)?;
            (csv.name(), Table::of(&csv, &names).map(Rc::new))
        }
    };
    let table = reader.without_problems(table, place)?;
    if table.starts_at_zero {
        reader.warn(format!("{file}: the first row is at time 0: its increment takes no time"));
    }
    Some((file, table))
}

/// Takes the values of the fields, the first of which is number `first` of the table's columns. `file`: for messages.
pub fn take_columns(
    reader: &mut Reader<'_>,
    fields: &mut StepFields,
    table: &Table,
    first: usize,
    file: &str,
    place: &Place,
) {
    let mut columns = table.columns[first..]
        .iter()
        .map(|column| column.map(|column| table.rows.iter().map(|row| row[column]).collect::<Vec<_>>()));
    fields.temperatures = columns.next().flatten();
    fields.predefs = columns.collect();
    if fields.temperatures.is_some() && fields.temperature.is_some() {
        let message = format!("{file}: the temperature is given twice: in the table and in the step");
        reader.problem(&place.key(TEMPERATURE), message);
    }
    if fields.predefs.iter().any(Option::is_some) && fields.predef.is_some() {
        let message = format!("{file}: field variables are given twice: in the table and in the step");
        reader.problem(&place.key(PREDEF), message);
    }
}

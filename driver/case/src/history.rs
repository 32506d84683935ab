//! Entries common to cases of all kinds, above all `until` and `compare`, which refer to columns of the history.

use crate::document;
use crate::problem::{Place, hint};
use crate::reader::Reader;
use pullout_run::program::{self, About};
use std::path::Path;

/// Returns the entries common to cases of all kinds; the amount of output, and notes made while reading, are added
/// later.
pub fn about(
    reader: &mut Reader<'_>,
    path: &Path,
    given: &document::CommonCaseEntries,
    until: Option<&document::Until>,
    columns: Option<&[String]>,
) -> About {
    let root = Place::root();
    About {
        case_file: path.into(),
        title: given
            .head
            .title
            .clone()
            .unwrap_or_else(|| path.file_stem().unwrap_or_default().to_string_lossy().into()),
        description: given.head.description.clone().unwrap_or_default(),
        until: self::until(reader, until, columns, &root.key("until")),
        compare: compare_all(reader, given.compare.as_deref().unwrap_or_default(), columns, &root.key("compare")),
        ..About::default()
    }
}

/// Index of a column; `None` with a problem if there is none, without one if the columns are not known.
fn column(reader: &mut Reader<'_>, name: &str, columns: Option<&[String]>, place: &Place) -> Option<usize> {
    let columns = columns?;
    let index = columns.iter().position(|column| column == name);
    if index.is_none() {
        reader.problem(place, format!("the history has no column '{name}'{}", hint(name, columns)));
    }
    index
}

/// `NAME` or `abs(NAME)`, and a bound.
pub fn until(
    reader: &mut Reader<'_>,
    until: Option<&document::Until>,
    columns: Option<&[String]>,
    place: &Place,
) -> Option<program::Until> {
    let until = until?;
    let quantity = until.quantity.trim();
    let inner = quantity.strip_prefix("abs").map(str::trim_start).and_then(|rest| rest.strip_prefix('('));
    let (name, absolute) = match inner.and_then(|rest| rest.strip_suffix(')')) {
        Some(name) => (name.trim(), true),
        None => (quantity, false),
    };
    match (until.greater_than, until.less_than) {
        (None, None) => reader.problem(place, "needs \"greater_than\" or \"less_than\""),
        (Some(greater), Some(less)) if greater < less => {
            let message = format!("every value is greater than {greater} or less than {less}: it would stop at once");
            reader.problem(place, message);
        }
        (Some(greater), None) if absolute && greater < 0.0 => {
            reader.problem(&place.key("greater_than"), "an absolute value is always greater: it would stop at once");
        }
        (_, Some(less)) if absolute && less <= 0.0 => {
            reader.problem(&place.key("less_than"), "an absolute value is never less than this");
        }
        _ => {}
    }
    let column = column(reader, name, columns, &place.key("quantity"))?;
    Some(program::Until { column, absolute, greater_than: until.greater_than, less_than: until.less_than })
}

/// All curves.
fn compare_all(
    reader: &mut Reader<'_>,
    curves: &[document::Compare],
    columns: Option<&[String]>,
    place: &Place,
) -> Vec<program::Compare> {
    let resolved = curves.iter().enumerate().map(|(k, curve)| compare(reader, curve, columns, &place.index(k)));
    resolved.flatten().collect()
}

fn compare(
    reader: &mut Reader<'_>,
    curve: &document::Compare,
    columns: Option<&[String]>,
    place: &Place,
) -> Option<program::Compare> {
    let scale_x = curve.scale_x.unwrap_or(1.0);
    if scale_x == 0.0 {
        reader.problem(&place.key("scale_x"), "must not be 0");
    }
    let x = column(reader, &curve.x, columns, &place.key("x"));
    let y = column(reader, &curve.y, columns, &place.key("y"));
    let points = points(reader, curve, place);
    let stem = Path::new(&curve.file)
        .file_stem()
        .map_or_else(|| curve.file.clone(), |stem| stem.to_string_lossy().into_owned());
    Some(program::Compare {
        file: curve.file.clone(),
        points: points?,
        file_x: curve.file_x.clone(),
        file_y: curve.file_y.clone(),
        x: x?,
        y: y?,
        scale_x,
        scale_y: curve.scale_y.unwrap_or(1.0),
        label: curve.label.clone().unwrap_or(stem),
    })
}

/// The two columns of the curve's file.
fn points(reader: &mut Reader<'_>, curve: &document::Compare, place: &Place) -> Option<Vec<(f64, f64)>> {
    let place_of_file = place.key("file");
    let path = reader.file(&curve.file, &place_of_file)?;
    let csv = reader.csv(&path);
    let csv = reader.without_problems(csv, &place_of_file)?;
    let mut find = |name: &str, key: &str| {
        let index = csv.header.iter().position(|column| column == name);
        if index.is_none() {
            let message = format!("{} has no column '{name}'{}", path.display(), hint(name, &csv.header));
            reader.problem(&place.key(key), message);
        }
        index
    };
    let (x, y) = (find(&curve.file_x, "file_x"), find(&curve.file_y, "file_y"));
    let rows = reader.without_problems(csv.numbers(&[x?, y?], true), &place_of_file)?;
    if rows.is_empty() {
        let message = format!("{}: the two columns share no row with numbers", path.display());
        reader.problem(&place_of_file, message);
        return None;
    }
    Some(rows.into_iter().map(|row| (row[0], row[1])).collect())
}

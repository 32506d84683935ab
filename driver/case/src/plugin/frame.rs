//! Local axes, thermal expansion and shrinkage of a material.

use super::{Length, Level, Use};
use crate::document::{
    AxialValues, EntryPoint, Expansion, ExpansionTable, Material, Orientation, Shrinkage, TabularValues,
};
use crate::problem::{Place, Problem};
use crate::reader::{Reader, UsedDefaults};
use crate::structure;
use pullout_run::program::Mode;
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use umat_abi::host::{self, Course, Frame, Plugin};

/// Reads a frame for points of a mode as the members `expansion`, `shrinkage` and `orientation` of a case's material say it, whatever
/// else `material` has; the temperature that nothing expands at is 0 unless they say it.
///
/// # Errors
/// Everything that is wrong with them.
pub fn frame_from_json(material: &Value, mode: Mode) -> Result<Option<Arc<Frame>>, Vec<Problem>> {
    let place = Place::root().key("material");
    let mut document = json!({ "kind": "point", "steps": [], "material": { "plugin": "law" } });
    for key in ["expansion", "shrinkage", "orientation"] {
        if !material[key].is_null() {
            document["material"][key] = material[key].clone();
        }
    }
    let found = structure::check("point", &document).into_iter();
    // the steps are not asked for
    let is_of_material =
        |problem: &Problem| problem.place.as_ref().is_some_and(|found| found.as_str().starts_with(place.as_str()));
    let problems: Vec<Problem> = found.filter(is_of_material).collect();
    if !problems.is_empty() {
        return Err(problems);
    }
    let material: Material = Material::deserialize(&document["material"])
        .map_err(|error| vec![Problem::new(place.clone(), error.to_string())])?;
    let mut reader = Reader::new(Path::new(""), &[], false);
    let purpose = Use {
        level: Level::Point,
        entry: EntryPoint::Umat,
        mode: Some((mode, place.clone())),
        length: Length::Unknown,
        normal: None,
    };
    let frame = of(&mut reader, &material, &place, &purpose);
    if reader.problems.is_empty() { Ok(frame) } else { Err(reader.problems) }
}

/// Reads the frame of a material; `None`: the law sees what the host has.
pub fn of(reader: &mut Reader<'_>, material: &Material, place: &Place, purpose: &Use) -> Option<Arc<Frame>> {
    let Material { expansion, shrinkage, orientation, .. } = material;
    if purpose.entry != EntryPoint::Umat {
        let keys = [
            ("expansion", expansion.is_some()),
            ("shrinkage", shrinkage.is_some()),
            ("orientation", orientation.is_some()),
        ];
        for (key, _) in keys.iter().filter(|(_, given)| *given) {
            reader.problem(&place.key(key), "is for the entry point umat alone");
        }
        return None;
    }
    let mode = purpose.mode.as_ref().map(|(mode, _)| *mode);
    let axes = orientation.as_ref().and_then(|given| axes(reader, given, mode, &place.key("orientation")));
    let expansion = expansion.as_ref().and_then(|given| self::expansion(reader, given, &place.key("expansion")));
    let shrinkage = shrinkage.as_ref().and_then(|given| self::shrinkage(reader, given, &place.key("shrinkage")));
    let mut frame = Frame { axes, expansion, shrinkage };
    let mut courses = frame.expansion.iter().map(|expansion| &expansion.coefficients).chain(&frame.shrinkage);
    if frame.axes.is_none() && !courses.all(Course::is_isotropic) {
        // directions of the material, which follow it
        frame.axes = Some([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    }
    (!frame.is_plain()).then(|| Arc::new(frame))
}

/// Local axes, a row each.
fn axes(reader: &mut Reader<'_>, given: &Orientation, mode: Option<Mode>, place: &Place) -> Option<[[f64; 3]; 3]> {
    let [a, b] = match given {
        Orientation::Angle(angle) => {
            // exact where the axes only change places
            let (sine, cosine) = match angle.rem_euclid(360.0) {
                0.0 => (0.0, 1.0),
                90.0 => (1.0, 0.0),
                180.0 => (0.0, -1.0),
                270.0 => (-1.0, 0.0),
                angle => angle.to_radians().sin_cos(),
            };
            [[cosine, sine, 0.0], [-sine, cosine, 0.0]]
        }
        Orientation::Vectors(vectors) => {
            let mut three = [[0.0; 3]; 2];
            for (to, from) in three.iter_mut().zip(vectors) {
                if !(2..=3).contains(&from.len()) {
                    reader.problem(place, format!("a vector has two or three components, not {}", from.len()));
                    return None;
                }
                to[..from.len()].copy_from_slice(from);
            }
            three
        }
    };
    let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let unit = |a: [f64; 3]| {
        let length = dot(&a, &a).sqrt();
        a.map(|component| component / length)
    };
    let first = unit(a);
    let along = dot(&b, &first);
    let across: [f64; 3] = std::array::from_fn(|k| b[k] - along * first[k]);
    let is_plane = first[0].is_finite() && dot(&across, &across) > 1e-12 * dot(&b, &b);
    if !is_plane {
        reader.problem(place, "the two vectors must not be 0, and not along one line");
        return None;
    }
    let second = unit(across);
    let third: [f64; 3] = std::array::from_fn(|k| {
        let [i, j] = [(k + 1) % 3, (k + 2) % 3];
        first[i] * second[j] - first[j] * second[i]
    });
    if mode.is_some_and(|mode| mode != Mode::ThreeD) && (first[2] != 0.0 || second[2] != 0.0) {
        reader.problem(place, "in a plane local axis 3 is that of the case: the vectors have no component 3");
        return None;
    }
    Some([first, second, third])
}

/// Makes a material that expands free of thermal strain at the temperature at which its points start, unless it has an `initial_temperature`.
pub fn begin_at(reader: &mut Reader<'_>, plugin: &mut Plugin, material: &Material, temperature: f64, place: &Place) {
    let is_given = |given: &Expansion| matches!(given, Expansion::Table(table) if table.initial_temperature.is_some());
    let Some(frame) = plugin.frame.as_mut().filter(|_| !material.expansion.as_ref().is_some_and(is_given)) else {
        return;
    };
    if let Some(expansion) = &mut Arc::make_mut(frame).expansion {
        expansion.initial_temperature = temperature;
        let mut taken = UsedDefaults::default();
        taken.note("initial_temperature", temperature);
        reader.note_defaults(&place.key("expansion"), &taken.0);
    }
}

fn expansion(reader: &mut Reader<'_>, given: &Expansion, place: &Place) -> Option<host::Expansion> {
    let table = match given {
        Expansion::Coefficients(alpha) => ExpansionTable {
            alpha: match alpha {
                AxialValues::Same(alpha) => TabularValues::Constant(*alpha),
                AxialValues::Each(alphas) => TabularValues::List(alphas.map(AxialValues::Same).to_vec()),
            },
            temperatures: None,
            zero_temperature: None,
            initial_temperature: None,
        },
        Expansion::Table(table) => table.clone(),
    };
    let place_of_alpha = place.key("alpha");
    let coefficients = match (&table.alpha, table.temperatures) {
        (TabularValues::Constant(alpha), None) => Course::constant([*alpha; 3]),
        (TabularValues::Constant(_), Some(_)) => {
            reader.problem(&place_of_alpha, "is one number, but there are temperatures: give a list, one for each");
            return None;
        }
        (TabularValues::List(values), None) => match values[..] {
            [AxialValues::Same(first), AxialValues::Same(second), AxialValues::Same(third)] => {
                Course::constant([first, second, third])
            }
            _ => {
                let message = "without temperatures it is a number, or three, of the local axes";
                reader.problem(&place_of_alpha, message);
                return None;
            }
        },
        (TabularValues::List(values), Some(temperatures)) => {
            course(reader, temperatures, values, [place.key("temperatures"), place_of_alpha])?
        }
    };
    let all: Vec<f64> = match &table.alpha {
        TabularValues::Constant(alpha) => vec![*alpha],
        TabularValues::List(values) => values.iter().flat_map(along_axes).collect(),
    };
    warn_unusual(reader, place, &all, "1/K", USUAL_EXPANSION);
    Some(host::Expansion {
        coefficients,
        zero_temperature: table.zero_temperature.unwrap_or(0.0),
        initial_temperature: table.initial_temperature.unwrap_or_default(),
    })
}

fn shrinkage(reader: &mut Reader<'_>, given: &Shrinkage, place: &Place) -> Option<Course> {
    let all: Vec<f64> = given.strain.iter().flat_map(along_axes).collect();
    warn_unusual(reader, &place.key("strain"), &all, "", USUAL_SHRINKAGE);
    course(reader, given.times.clone(), &given.strain, [place.key("times"), place.key("strain")])
}

/// Usual coefficients of expansion, 1/K: those of carbon fibres along their axes are below 0, those of soft polymers the greatest.
const USUAL_EXPANSION: [f64; 2] = [-1e-4, 1e-3];
/// Usual strains of what shrinks or swells.
const USUAL_SHRINKAGE: [f64; 2] = [-0.5, 0.5];

/// Warns of the first value that is outside a usual range.
fn warn_unusual(reader: &mut Reader<'_>, place: &Place, values: &[f64], unit: &str, usual: [f64; 2]) {
    if let Some(value) = values.iter().find(|value| !(usual[0]..=usual[1]).contains(*value)) {
        reader.warn_unusual(place.in_words(), *value, unit, usual);
    }
}

/// The values along the three axes.
fn along_axes(value: &AxialValues) -> [f64; 3] {
    match value {
        AxialValues::Same(value) => [*value; 3],
        AxialValues::Each(values) => *values,
    }
}

fn course(
    reader: &mut Reader<'_>,
    places: Vec<f64>,
    values: &[AxialValues],
    [of_places, of_values]: [Place; 2],
) -> Option<Course> {
    if values.len() != places.len() {
        reader
            .problem(&of_values, format!("{} values given, {} needed, one for each place", values.len(), places.len()));
        return None;
    }
    let course = Course::new(places, values.iter().map(along_axes).collect());
    if course.is_none() {
        reader.problem(&of_places, "must be numbers that grow, at least one");
    }
    course
}

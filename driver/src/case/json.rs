//! JSON text to a value that remembers which keys were given twice, and `--set`.

use super::problem::{Place, Problem};
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::cell::RefCell;
use std::fmt;

/// Reads JSON text. Keys given twice are problems; the last value counts.
///
/// # Errors
/// The syntax error, with line and column.
pub fn parse(text: &str) -> Result<(Value, Vec<Problem>), Problem> {
    let repeated = RefCell::new(Vec::new());
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = Noting { place: Place::root(), repeated: &repeated }.deserialize(&mut deserializer);
    let value = value.and_then(|value| deserializer.end().map(|()| value)).map_err(|error| {
        let message = error.to_string();
        let position = format!(" at line {} column {}", error.line(), error.column());
        let what = message.strip_suffix(&position).unwrap_or(&message);
        Problem::unreadable(format!("line {}, column {}: not valid JSON: {what}", error.line(), error.column()))
    })?;
    Ok((value, repeated.into_inner()))
}

/// Deserialises a value at a place, noting repeated keys on the way.
struct Noting<'a> {
    place: Place,
    repeated: &'a RefCell<Vec<Problem>>,
}

impl<'de> DeserializeSeed<'de> for Noting<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Noting<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut access: A) -> Result<Value, A::Error> {
        let mut elements = Vec::new();
        while let Some(element) =
            access.next_element_seed(Noting { place: self.place.index(elements.len()), repeated: self.repeated })?
        {
            elements.push(element);
        }
        Ok(Value::Array(elements))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut access: A) -> Result<Value, A::Error> {
        let mut members = Map::new();
        while let Some(key) = access.next_key::<String>()? {
            let place = self.place.key(&key);
            let value = access.next_value_seed(Noting { place: place.clone(), repeated: self.repeated })?;
            if members.insert(key, value).is_some() {
                self.repeated.borrow_mut().push(Problem::new(place, "the key is given twice; give it once"));
            }
        }
        Ok(Value::Object(members))
    }
}

/// Applies `a.b.0.c=VALUE`: VALUE is JSON, else a string; missing keys are created.
///
/// # Errors
/// A malformed override, or one whose path leads through a value that has no members.
pub fn set(document: &mut Value, text: &str) -> Result<(), Problem> {
    let wrong = |message: String| Problem::new(Place::option(text), message);
    let Some((path, value)) = text.split_once('=') else {
        return Err(wrong("no '=': write a.b.c=VALUE".into()));
    };
    let segments: Vec<&str> = path.split('.').collect();
    if segments.iter().any(|segment| segment.is_empty()) {
        return Err(wrong("an empty name in the path: write a.b.c=VALUE".into()));
    }
    let value = serde_json::from_str(value).unwrap_or_else(|_| Value::String(value.into()));
    let mut place = Place::root();
    let mut target = document;
    for segment in segments {
        let here = place.clone();
        if target.is_null() {
            *target = Value::Object(Map::new());
        }
        match target {
            Value::Object(members) => {
                place = place.key(segment);
                target = members.entry(segment).or_insert(Value::Null);
            }
            Value::Array(elements) => {
                let count = elements.len();
                let index = segment.parse::<usize>().ok().filter(|index| *index <= count);
                let Some(index) = index else {
                    return Err(wrong(format!(
                        "{here} is an array of {count}: '{segment}' is no index of it (0 to {count}, the last appends)"
                    )));
                };
                if index == count {
                    elements.push(Value::Null);
                }
                place = place.index(index);
                target = &mut elements[index];
            }
            _ => return Err(wrong(format!("{here} is neither an object nor an array: it has no '{segment}'"))),
        }
    }
    *target = value;
    Ok(())
}

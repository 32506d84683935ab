//! Conversion of JSON text to a value, `--set`, and what a value cannot show: keys that were given twice.

use crate::problem::{Place, Problem};
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::fmt;

/// Most values of a case: numbers, texts, arrays, objects. More are data, which tables and meshes hold; in memory each
/// takes some hundred bytes before it is known what it is.
const MOST_VALUES: usize = 1_000_000;

/// Reads JSON text. Keys given twice are problems; the last value counts.
///
/// # Errors
/// The syntax error, with line and column; more values than a case may have.
pub fn parse(text: &str) -> Result<(Value, Vec<Problem>), Problem> {
    let mut found = Found::default();
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = Noting { place: Place::root(), found: &mut found }.deserialize(&mut deserializer);
    let value = value.and_then(|value| deserializer.end().map(|()| value)).map_err(|error| {
        let message = error.to_string();
        let position = format!(" at line {} column {}", error.line(), error.column());
        let what = message.strip_suffix(&position).unwrap_or(&message);
        let kind = if error.is_data() { "" } else { "not valid JSON: " };
        // the error is reported where a value or a name is missed: at the comment, or after its first character
        let line = text.lines().nth(error.line().saturating_sub(1)).unwrap_or_default().as_bytes();
        let from = error.column().saturating_sub(2).min(line.len());
        let here = line[from..].trim_ascii_start();
        let is_comment = !error.is_data() && [&b"//"[..], b"/*", b"#"].iter().any(|mark| here.starts_with(mark));
        let what = if is_comment { "JSON has no comments: put text into \"description\"" } else { what };
        Problem::unreadable(format!("line {}, column {}: {kind}{what}", error.line(), error.column()))
    })?;
    Ok((value, found.repeated))
}

/// Problems and counts of a document that is being parsed.
#[derive(Default)]
struct Found {
    values: usize,
    repeated: Vec<Problem>,
}

/// Deserialises a value at a place, noting repeated keys on the way.
struct Noting<'a> {
    place: Place,
    found: &'a mut Found,
}

impl Noting<'_> {
    /// Descends into a member or an entry.
    fn within(&mut self, place: Place) -> Noting<'_> {
        Noting { place, found: self.found }
    }
}

impl<'de> DeserializeSeed<'de> for Noting<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        self.found.values += 1;
        if self.found.values > MOST_VALUES {
            return Err(D::Error::custom(format!(
                "more than {MOST_VALUES} values: numbers by the thousand belong into tables and meshes"
            )));
        }
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

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut access: A) -> Result<Value, A::Error> {
        let mut elements = Vec::new();
        while let Some(element) = access.next_element_seed(self.within(self.place.index(elements.len())))? {
            elements.push(element);
        }
        Ok(Value::Array(elements))
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut access: A) -> Result<Value, A::Error> {
        let mut members = Map::new();
        while let Some(key) = access.next_key::<String>()? {
            let place = self.place.key(&key);
            let value = access.next_value_seed(self.within(place.clone()))?;
            if members.insert(key, value).is_some() {
                self.found.repeated.push(Problem::new(place, "the key is given twice; give it once"));
            }
        }
        Ok(Value::Object(members))
    }
}

/// Finds texts and keys that would act on a terminal or break a picture: control characters are there for line breaks and
/// tabs of descriptions alone.
pub fn check_texts(value: &Value, place: &Place, problems: &mut Vec<Problem>) {
    let check = |text: &str, place: &Place, allowed: &str, problems: &mut Vec<Problem>| {
        if text.contains(|c: char| c.is_control() && !allowed.contains(c)) {
            let message = "has a control character (a line break, a tab, …), which no page or picture can show";
            problems.push(Problem::new(place.clone(), message));
        }
    };
    match value {
        Value::String(text) => check(text, place, "", problems),
        Value::Array(entries) => {
            // of numbers there may be many
            let others = entries.iter().enumerate().filter(|(_, entry)| !entry.is_number());
            others.for_each(|(k, entry)| check_texts(entry, &place.index(k), problems));
        }
        Value::Object(members) => {
            for (key, member) in members {
                let place = place.key(key);
                check(key, &place, "", problems);
                match member {
                    Value::String(text) if key == "description" => check(text, &place, "\n\r\t", problems),
                    _ => check_texts(member, &place, problems),
                }
            }
        }
        _ => {}
    }
}

/// Writes a path to a place in a document as `a.0.b`, which is also given as `a[0].b` and `$.a[0].b`.
pub fn dotted(path: &str) -> String {
    let mut parts = path.strip_prefix("$.").unwrap_or(path).split('[');
    let mut dotted = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let index = part.split_once(']').filter(|(index, rest)| {
            !index.is_empty()
                && index.bytes().all(|byte| byte.is_ascii_digit())
                && (rest.is_empty() || rest.starts_with('.'))
        });
        match index {
            Some((index, rest)) => dotted.extend([".", index, rest]),
            None => dotted.extend(["[", part]),
        }
    }
    dotted
}

/// The value at a place in a document, if there is one: `a.0.b`, as [`dotted`] writes it.
pub fn value_at<'v>(document: &'v Value, path: &str) -> Option<&'v Value> {
    path.split('.').try_fold(document, |value, part| match value {
        Value::Array(entries) => entries.get(part.parse::<usize>().ok()?),
        other => other.get(part),
    })
}

/// Applies `a.b.0.c=VALUE`: VALUE is JSON, else a string; missing keys are created.
///
/// # Errors
/// A malformed override, or one whose path leads through a value that has no members.
pub fn set(document: &mut Value, text: &str) -> Result<(), Problem> {
    let wrong = |message: String| Problem::structure(Place::option(text), message);
    let Some((path, value)) = text.split_once('=') else {
        return Err(wrong("no '=': write a.b.c=VALUE".into()));
    };
    let path = dotted(path);
    let segments: Vec<&str> = path.split('.').collect();
    if segments.iter().any(|segment| segment.is_empty()) {
        return Err(wrong("an empty name in the path: write a.b.c=VALUE".into()));
    }
    // what is no JSON is a text
    let (value, repeated) = parse(value).unwrap_or_else(|_| (Value::String(value.into()), Vec::new()));
    if let Some(problem) = repeated.first() {
        return Err(wrong(format!("in its value, {problem}")));
    }
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

//! What runs, as a case gives it.

use crate::reader::UsedDefaults;
use pullout_run::number::rounded;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::ops::Deref;

/// Something that runs and has defaults, and which of them a case takes.
#[derive(Clone, Debug)]
pub(crate) struct WithDefaults<T> {
    value: T,
    /// Dotted names and values.
    defaults: Vec<(String, String)>,
}

impl<T> WithDefaults<T> {
    /// Returns whether the case has a member, or leaves it to a default.
    pub fn has(&self, name: &str) -> bool {
        self.defaults.iter().all(|(default, _)| default != name)
    }

    /// Notes the defaults that the case takes, except those that something else decides.
    pub fn note(&self, taken: &mut UsedDefaults, except: &[&str]) {
        let noted = self.defaults.iter().filter(|(name, _)| !except.contains(&name.as_str()));
        noted.for_each(|(name, value)| taken.note(name, value));
    }

    /// Notes the defaults that the case takes of a member.
    pub fn note_of(&self, member: &str, taken: &mut UsedDefaults) {
        self.defaults.iter().for_each(|(name, value)| taken.note(&format!("{member}.{name}"), value));
    }
}

impl<T> Deref for WithDefaults<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: Default + Serialize> Default for WithDefaults<T> {
    fn default() -> Self {
        let value = T::default();
        let defaults = defaults(&value, &Value::Null).unwrap_or_default();
        Self { value, defaults }
    }
}

impl<'de, T: DeserializeOwned + Serialize> Deserialize<'de> for WithDefaults<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut given = Value::deserialize(deserializer)?;
        normalise(&mut given);
        let read = T::deserialize(&given).and_then(|value| Ok((defaults(&value, &given)?, value)));
        read.map(|(defaults, value)| Self { value, defaults }).map_err(D::Error::custom)
    }
}

impl<T: JsonSchema> JsonSchema for WithDefaults<T> {
    fn inline_schema() -> bool {
        T::inline_schema()
    }
    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }
    fn schema_id() -> Cow<'static, str> {
        T::schema_id()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = T::json_schema(generator);
        let members = schema.get_mut("properties").and_then(Value::as_object_mut);
        for member in members.into_iter().flat_map(|members| members.values_mut()) {
            if let Some(member) = member.as_object_mut().filter(|member| member.contains_key("default")) {
                admit_null(member);
            }
        }
        schema
    }
}

/// Lets a member be null, which is its default.
fn admit_null(member: &mut Map<String, Value>) {
    if let Some(reference) = member.remove("$ref") {
        member.insert("anyOf".to_owned(), json!([{ "$ref": reference }, { "type": "null" }]));
    } else if let Some(Value::String(kind)) = member.get("type") {
        member["type"] = json!([kind, "null"]);
    }
}

/// Leaves out what is null, and makes whole numbers of those without a fraction: 5.0 is the integer 5.
fn normalise(value: &mut Value) {
    match value {
        Value::Number(number) => {
            // not of −0, whose sign counts
            let is_whole = |real: &f64| real.fract() == 0.0 && real.is_sign_positive() && *real < 1e15;
            if let Some(whole) = number.as_f64().filter(|real| number.is_f64() && is_whole(real)) {
                *value = Value::from(whole as u64);
            }
        }
        Value::Array(values) => values.iter_mut().for_each(normalise),
        Value::Object(members) => {
            members.retain(|_, member| !member.is_null());
            members.values_mut().for_each(normalise);
        }
        _ => {}
    }
}

/// The members of a value that are not given: dotted names and values.
fn defaults<T: Serialize>(value: &T, given: &Value) -> serde_json::Result<Vec<(String, String)>> {
    fn collect(name: &str, value: &Value, given: Option<&Value>, found: &mut Vec<(String, String)>) {
        match (value, given) {
            (Value::Object(members), given) => {
                for (key, member) in members {
                    let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                    collect(&name, member, given.and_then(|given| given.get(key)), found);
                }
            }
            (Value::Null, _) | (_, Some(_)) => {}
            (value, None) => found.push((name.to_owned(), text(value))),
        }
    }
    fn text(value: &Value) -> String {
        match value {
            Value::Array(values) => format!("[{}]", values.iter().map(text).collect::<Vec<_>>().join(", ")),
            Value::String(word) => word.clone(),
            value => value.as_f64().filter(|_| value.is_f64()).map_or_else(|| value.to_string(), rounded),
        }
    }
    let mut found = Vec::new();
    collect("", &serde_json::to_value(value)?, Some(given), &mut found);
    Ok(found)
}

//! Checks a document against a JSON Schema: the keywords of draft 2020-12 that the schemas of this crate use.

use crate::problem::Place;
use serde_json::{Map, Value};

/// Names of fibres, parts and sets: the one `pattern` of the schemas.
pub const NAME_PATTERN: &str = "^[A-Za-z0-9_-]+$";

/// A value in the document that breaks a keyword of its schema.
#[derive(Clone, Debug)]
pub struct Violation<'v> {
    /// The place of the value.
    pub place: Place,
    /// The value.
    pub instance: &'v Value,
    /// The schema in which the keyword stands.
    pub schema: &'v Value,
    /// The keyword.
    pub keyword: Keyword<'v>,
}

/// A keyword that is broken, and what it wants.
#[derive(Clone, Debug)]
pub enum Keyword<'v> {
    /// `type`: a name or several.
    Type(Vec<JsonType>),
    /// `const`: the one value.
    Constant(&'v Value),
    /// `anyOf`, or `oneOf` where no branch fits: the violations of each branch.
    Union(Vec<Vec<Violation<'v>>>),
    /// `oneOf` where several branches fit.
    Ambiguous,
    /// `additionalProperties: false`: the keys that the schema does not know.
    UnknownKeys(Vec<&'v str>),
    /// `required`: a key that the object lacks.
    Missing(&'v str),
    /// `minimum`, `exclusiveMinimum`, `maximum`, `exclusiveMaximum`: the relation, and the limit.
    Limit(&'static str, &'v Value),
    /// `minItems`: the number.
    MinItems(u64),
    /// `maxItems`: the number.
    MaxItems(u64),
    /// `minLength`, which is 1 in the schemas.
    MinLength,
    /// `maxLength`: the number.
    MaxLength(u64),
    /// `pattern`, which is [`NAME_PATTERN`].
    Pattern,
    /// `format` of a whole number: the least and the greatest. The draft takes it for a comment, serde does not.
    Format(i128, i128),
}

/// The types of JSON Schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JsonType {
    /// A list.
    Array,
    /// `true` or `false`.
    Boolean,
    /// A number without fraction.
    Integer,
    /// `null`.
    Null,
    /// A number.
    Number,
    /// Keys and values.
    Object,
    /// `string`.
    Text,
}

impl JsonType {
    /// The type of a `type` keyword's word.
    fn of_word(word: &str) -> Option<Self> {
        Some(match word {
            "array" => Self::Array,
            "boolean" => Self::Boolean,
            "integer" => Self::Integer,
            "null" => Self::Null,
            "number" => Self::Number,
            "object" => Self::Object,
            "string" => Self::Text,
            _ => return None,
        })
    }

    /// Returns whether a value is of the type; 5.0 is an integer as well.
    fn admits(self, value: &Value) -> bool {
        match self {
            Self::Array => value.is_array(),
            Self::Boolean => value.is_boolean(),
            Self::Integer => {
                value.is_u64() || value.is_i64() || value.as_f64().is_some_and(|number| number.fract() == 0.0)
            }
            Self::Null => value.is_null(),
            Self::Number => value.is_number(),
            Self::Object => value.is_object(),
            Self::Text => value.is_string(),
        }
    }
}

/// The way from the root to a value, without memory of its own.
#[derive(Clone, Copy)]
enum Path<'p> {
    Root,
    Key(&'p Path<'p>, &'p str),
    Index(&'p Path<'p>, usize),
}

impl Path<'_> {
    fn place(&self) -> Place {
        match self {
            Self::Root => Place::root(),
            Self::Key(parent, key) => parent.place().key(key),
            Self::Index(parent, index) => parent.place().index(*index),
        }
    }
}

/// Returns all that is wrong with a document, in the order of its members.
///
/// `root` is the schema in which `$ref` looks for `#/$defs/…`. `heeds_formats`: whether [`Keyword::Format`] counts.
pub fn violations<'v>(root: &'v Value, document: &'v Value, heeds_formats: bool) -> Vec<Violation<'v>> {
    let mut found = Vec::new();
    Check { root, heeds_formats }.value(root, document, &Path::Root, &mut found);
    found
}

/// Whether a number and a limit obey a relation.
type Relation = fn(&f64, &f64) -> bool;

/// Keywords of limits, their relations, and whether a number and a limit obey them.
const LIMITS: [(&str, &str, Relation); 4] = [
    ("minimum", ">=", f64::ge),
    ("exclusiveMinimum", ">", f64::gt),
    ("maximum", "<=", f64::le),
    ("exclusiveMaximum", "<", f64::lt),
];

/// Formats of whole numbers, with the least and the greatest.
const FORMATS: [(&str, i128, i128); 4] = [
    ("int32", i32::MIN as i128, i32::MAX as i128),
    ("uint8", 0, u8::MAX as i128),
    ("uint", 0, u64::MAX as i128),
    ("uint64", 0, u64::MAX as i128),
];

struct Check<'v> {
    root: &'v Value,
    heeds_formats: bool,
}

impl<'v> Check<'v> {
    fn value(&self, schema: &'v Value, instance: &'v Value, path: &Path<'_>, found: &mut Vec<Violation<'v>>) {
        let Value::Object(keywords) = schema else { return };
        if let Some(target) = keywords.get("$ref").and_then(Value::as_str) {
            let target = self.root.pointer(target.trim_start_matches('#')).unwrap_or(&Value::Null);
            self.value(target, instance, path, found);
        }
        let mut report = |keyword| found.push(Violation { place: path.place(), instance, schema, keyword });
        if let Some(types) = keywords.get("type") {
            let words = types.as_array().map_or(std::slice::from_ref(types), Vec::as_slice);
            let types: Vec<JsonType> = words.iter().filter_map(|word| JsonType::of_word(word.as_str()?)).collect();
            if !types.iter().any(|kind| kind.admits(instance)) {
                report(Keyword::Type(types));
            }
        }
        if let Some(constant) = keywords.get("const").filter(|constant| *constant != instance) {
            report(Keyword::Constant(constant));
        }
        if let Some(number) = instance.as_f64() {
            for (keyword, relation, holds) in LIMITS {
                let limit = keywords.get(keyword).and_then(|limit| Some((limit, limit.as_f64()?)));
                if let Some((limit, _)) = limit.filter(|(_, limit)| !holds(&number, limit)) {
                    report(Keyword::Limit(relation, limit));
                }
            }
        }
        let count = |keyword: &str| keywords.get(keyword).and_then(Value::as_u64);
        let format = keywords
            .get("format")
            .and_then(Value::as_str)
            .filter(|_| self.heeds_formats && JsonType::Integer.admits(instance));
        if let Some((_, least, greatest)) = FORMATS.into_iter().find(|(name, ..)| Some(*name) == format) {
            let whole = instance.as_i64().map(i128::from).or(instance.as_u64().map(i128::from));
            if whole.is_none_or(|whole| whole > greatest || whole < least && !keywords.contains_key("minimum")) {
                report(Keyword::Format(least, greatest));
            }
        }
        if let Value::String(text) = instance {
            let length = text.chars().count() as u64;
            if count("minLength").is_some_and(|least| length < least) {
                report(Keyword::MinLength);
            }
            if let Some(most) = count("maxLength").filter(|most| length > *most) {
                report(Keyword::MaxLength(most));
            }
            let is_name =
                |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c));
            if keywords.contains_key("pattern") && !is_name(text) {
                report(Keyword::Pattern);
            }
        }
        if let Value::Array(elements) = instance {
            if let Some(least) = count("minItems").filter(|least| (elements.len() as u64) < *least) {
                report(Keyword::MinItems(least));
            }
            if let Some(most) = count("maxItems").filter(|most| elements.len() as u64 > *most) {
                report(Keyword::MaxItems(most));
            }
        }
        match instance {
            Value::Array(elements) => {
                if let Some(items) = keywords.get("items") {
                    for (index, element) in elements.iter().enumerate() {
                        self.value(items, element, &Path::Index(path, index), found);
                    }
                }
            }
            Value::Object(members) => self.members(schema, keywords, instance, members, path, found),
            _ => {}
        }
        for (keyword, is_exclusive) in [("anyOf", false), ("oneOf", true)] {
            if let Some(Value::Array(branches)) = keywords.get(keyword) {
                found.extend(self.union(schema, branches, is_exclusive, instance, path));
            }
        }
        if let Some(Value::Array(parts)) = keywords.get("allOf") {
            parts.iter().for_each(|part| self.value(part, instance, path, found));
        }
    }

    /// Checks the members of an object.
    fn members(
        &self,
        schema: &'v Value,
        keywords: &'v Map<String, Value>,
        instance: &'v Value,
        members: &'v Map<String, Value>,
        path: &Path<'_>,
        found: &mut Vec<Violation<'v>>,
    ) {
        let properties = keywords.get("properties").and_then(Value::as_object);
        let others = keywords.get("additionalProperties").unwrap_or(&Value::Bool(true));
        let mut unknown = Vec::new();
        for (key, member) in members {
            match (properties.and_then(|known| known.get(key)), others) {
                (Some(known), _) => self.value(known, member, &Path::Key(path, key), found),
                (None, Value::Bool(false)) => unknown.push(key.as_str()),
                (None, others) => self.value(others, member, &Path::Key(path, key), found),
            }
        }
        let mut report = |keyword| found.push(Violation { place: path.place(), instance, schema, keyword });
        if !unknown.is_empty() {
            report(Keyword::UnknownKeys(unknown));
        }
        let required = keywords.get("required").and_then(Value::as_array);
        let missing =
            required.into_iter().flatten().filter_map(Value::as_str).filter(|key| !members.contains_key(*key));
        missing.for_each(|key| report(Keyword::Missing(key)));
    }

    /// Checks the branches of `anyOf` or `oneOf`.
    fn union(
        &self,
        schema: &'v Value,
        branches: &'v [Value],
        is_exclusive: bool,
        instance: &'v Value,
        path: &Path<'_>,
    ) -> Option<Violation<'v>> {
        let mut of_branches = Vec::with_capacity(branches.len());
        let mut fitting = 0;
        for branch in branches {
            let mut found = Vec::new();
            self.value(branch, instance, path, &mut found);
            fitting += usize::from(found.is_empty());
            if fitting > 0 && !is_exclusive {
                return None;
            }
            of_branches.push(found);
        }
        let keyword = match fitting {
            0 => Keyword::Union(of_branches),
            1 => return None,
            _ => Keyword::Ambiguous,
        };
        Some(Violation { place: path.place(), instance, schema, keyword })
    }
}

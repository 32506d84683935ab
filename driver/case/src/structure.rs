//! The schema of the case format, and messages about what a document violates.
//!
//! [`crate::validation`] decides; this module chooses among the branches of a union the one that was meant, so that
//! "neither this nor that nor that" does not reach the user.

use crate::document::bridging::BridgingCase;
use crate::document::study::StudyFile;
use crate::document::sweep::SweepFile;
use crate::document::{InterfaceCase, PointCase, PulloutCase};
use crate::problem::{MOST_SHOWN, Place, Problem, hint, nearest, shown, suggestion};
use crate::validation::{JsonType, Keyword, Violation, violations};
use schemars::generate::SchemaSettings;
use schemars::{Schema, SchemaGenerator};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::sync::OnceLock;

/// A kind of file: its name and its part of the schema.
type KindSchema = (&'static str, fn(&mut SchemaGenerator) -> Schema);

/// The kind of file that describes a family of runs; it is no case.
pub const STUDY: &str = "study";

/// The kind of file that describes many runs of a case of which numbers are kept; it is no case.
pub const SWEEP: &str = "sweep";

/// The kinds of files. A new kind of case: a line here, and an arm in `read`.
const KINDS: [KindSchema; 6] = [
    ("point", SchemaGenerator::subschema_for::<PointCase>),
    ("interface", SchemaGenerator::subschema_for::<InterfaceCase>),
    ("pullout", SchemaGenerator::subschema_for::<PulloutCase>),
    ("bridging", SchemaGenerator::subschema_for::<BridgingCase>),
    (STUDY, SchemaGenerator::subschema_for::<StudyFile>),
    (SWEEP, SchemaGenerator::subschema_for::<SweepFile>),
];

/// The JSON Schema (draft 2020-12) of case files, study files and sweep files.
pub fn schema() -> Value {
    let mut generator = SchemaGenerator::new(SchemaSettings::draft2020_12());
    let branches: Vec<Value> = KINDS.iter().map(|(_, subschema)| subschema(&mut generator).to_value()).collect();
    json!({
        "$schema": DRAFT,
        "title": "Pullout case, study or sweep",
        "description": "Units: N, mm, MPa, s. Shear strains are engineering shear.",
        "type": "object",
        "oneOf": branches,
        "$defs": generator.take_definitions(true),
    })
}

const DRAFT: &str = "https://json-schema.org/draft/2020-12/schema";

/// Returns the schema of a kind, made once: a study reads the cases of all its runs. It has no definitions of other kinds: making
/// them would be most of the time of a short run.
pub fn schema_of_kind(kind: &str) -> Option<&'static Value> {
    static SCHEMAS: [OnceLock<Value>; KINDS.len()] = [const { OnceLock::new() }; KINDS.len()];
    let (index, (_, subschema)) = KINDS.iter().enumerate().find(|(_, (name, _))| *name == kind)?;
    Some(SCHEMAS[index].get_or_init(|| {
        let mut generator = SchemaGenerator::new(SchemaSettings::draft2020_12());
        let branch = subschema(&mut generator).to_value();
        json!({ "$schema": DRAFT, "allOf": [branch], "$defs": generator.take_definitions(true) })
    }))
}

/// The kind that a document names.
///
/// # Errors
/// The document is no object, or names no kind that exists.
pub fn kind_of(document: &Value) -> Result<&str, Problem> {
    let place = Place::root();
    let Value::Object(members) = document else {
        return Err(Problem::new(place, format!("expected an object, found {}", shown(document))));
    };
    let valid: Vec<&str> = KINDS.iter().map(|(name, _)| *name).filter(|name| ![STUDY, SWEEP].contains(name)).collect();
    let message = match members.get("kind") {
        None => format!("is missing; valid names: {}", valid.join(", ")),
        Some(Value::String(name)) => match name.as_str() {
            name if valid.contains(&name) => return Ok(name),
            STUDY | SWEEP => format!("this is {}", what_runs(name)),
            name => format!("no kind of case is called '{name}'{}", hint(name, valid)),
        },
        Some(other) => format!("expected one of {}, found {}", valid.join(", "), shown(other)),
    };
    Err(Problem::structure(place.key("kind"), message))
}

/// Says what a document of a kind is, and which command takes it.
pub fn what_runs(kind: &str) -> String {
    match kind {
        STUDY => "a study of several runs: `pullout study` runs it".into(),
        SWEEP => "a sweep of many runs: `pullout sweep plan` begins it".into(),
        kind => format!("a case of kind '{kind}': `pullout run` runs it"),
    }
}

/// Checks the structure of a document of a kind: serde can read one in which nothing is wrong.
pub fn check(kind: &str, document: &Value) -> Vec<Problem> {
    let Some(schema) = schema_of_kind(kind) else { return Vec::new() };
    let mut findings = Findings::default();
    for error in violations(schema, document, true) {
        findings.describe(&error);
    }
    let Findings { mut problems, meant } = findings;
    problems.retain(|problem| !problem.place.as_ref().is_some_and(|place| meant.contains(place)));
    problems
}

#[derive(Default)]
struct Findings {
    problems: Vec<Problem>,
    /// Keys that are not there, and that unknown ones are nearest to: they are missing because they are misspelt.
    meant: BTreeSet<Place>,
}

impl Findings {
    fn describe(&mut self, error: &Violation<'_>) {
        let place = &error.place;
        let found = || shown(error.instance);
        let message = match &error.keyword {
            Keyword::UnknownKeys(keys) => return self.describe_unknown(error, keys, &property_names(error)),
            Keyword::Missing(key) => {
                return self.problems.push(Problem::structure(place.key(key), "is missing"));
            }
            Keyword::Union(branches) => return self.describe_union(error, branches),
            Keyword::Limit(relation, limit) => format!("must be {relation} {limit}, found {}", found()),
            Keyword::MinItems(limit) => format!("needs at least {}, found {}", entries(*limit), count(error)),
            Keyword::MaxItems(limit) => format!("takes at most {}, found {}", entries(*limit), count(error)),
            Keyword::MinLength => "is empty".to_owned(),
            Keyword::MaxLength(limit) => format!("must have at most {limit} characters"),
            Keyword::Pattern => format!("must consist of letters, digits, - and _, found {}", found()),
            Keyword::Format(least, greatest) => {
                format!("must be a whole number from {least} to {greatest}, without a decimal point, found {}", found())
            }
            Keyword::Ambiguous => format!("fits several forms at once, found {}", found()),
            Keyword::Type(_) | Keyword::Constant(_) => {
                let message = format!("expected {}, found {}", expected(error).unwrap_or_default(), found());
                return self.problems.push(Problem::structure(place.clone(), message));
            }
        };
        self.problems.push(Problem::new(place.clone(), message));
    }

    fn describe_unknown(&mut self, error: &Violation<'_>, unexpected: &[&str], valid: &[String]) {
        let place = &error.place;
        for key in unexpected {
            // to look for a similar name takes longer than all else
            let is_shown = self.problems.len() < MOST_SHOWN;
            let nearest = if is_shown { nearest(key, valid) } else { None };
            let hint = if is_shown { suggestion(nearest, valid) } else { String::new() };
            let meant = nearest.filter(|nearest| error.instance.get(nearest).is_none());
            self.meant.extend(meant.map(|nearest| place.key(nearest)));
            self.problems.push(Problem::structure(place.key(key), format!("unknown key{hint}")));
        }
    }

    /// Describes the branch that was meant: the one whose type fits, then the one with the fewest missing and
    /// unknown keys. If none fits in type, what each expects. Where no branch knows any key, the names in all.
    fn describe_union(&mut self, error: &Violation<'_>, context: &[Vec<Violation<'_>>]) {
        let here = &error.place;
        if let Some(problem) = wrong_tag(context, here) {
            return self.problems.push(problem);
        }
        // Of equally good branches: the first, or the last (the most general) if all lack a key.
        let chosen = |branch: &[Violation<'_>]| tag(branch, here).is_none();
        let any_chosen = context.iter().any(|branch| chosen(branch));
        let candidates = context.iter().enumerate().filter(|(_, branch)| !any_chosen || chosen(branch));
        let best = candidates.min_by_key(|(k, branch)| {
            let misfit = branch_misfit(branch, here);
            (misfit, if misfit < MISFIT_OF_MISSING_KEY { *k } else { context.len() - k })
        });
        let best = best.map(|(_, branch)| branch);
        let fits = best.filter(|branch| branch.iter().all(|e| misfit(e, here) < MISFIT_OF_TYPE));
        if let Some(branch) = fits {
            let strange: Option<Vec<_>> = context.iter().map(|branch| wholly_unknown(branch, here)).collect();
            for error in branch {
                match (wholly_unknown(std::slice::from_ref(error), here), &strange) {
                    (Some((_, keys)), Some(strange)) => {
                        let mut valid = property_names(error);
                        if !keys.iter().any(|key| nearest(key, &valid).is_some()) {
                            let of_all = strange.iter().flat_map(|(error, _)| property_names(error));
                            valid = of_all.collect::<BTreeSet<_>>().into_iter().collect();
                        }
                        self.describe_unknown(error, keys, &valid);
                    }
                    _ => self.describe(error),
                }
            }
            return;
        }
        let mut expectations = Vec::new();
        collect_expectations(context, here, &mut expectations);
        if expectations.iter().any(|text| text.starts_with('"')) {
            expectations.retain(|text| text != type_name(JsonType::Text));
        }
        let hint = word_hint(error.instance, &expectations);
        let message = format!("expected {}, found {}{hint}", either(&expectations), shown(error.instance));
        self.problems.push(Problem::structure(here.clone(), message));
    }
}

/// The keys that the schema of an object knows.
fn property_names(error: &Violation<'_>) -> Vec<String> {
    error.schema["properties"].as_object().map(|known| known.keys().cloned().collect()).unwrap_or_default()
}

/// Returns the error of a branch that knows none of an object's keys, and these.
fn wholly_unknown<'e, 'v>(branch: &'e [Violation<'v>], here: &Place) -> Option<(&'e Violation<'v>, &'e Vec<&'v str>)> {
    branch.iter().find_map(|error| match &error.keyword {
        Keyword::UnknownKeys(unexpected) if error.place == *here => {
            let is_all = error.instance.as_object().is_some_and(|object| object.len() == unexpected.len());
            is_all.then_some((error, unexpected))
        }
        _ => None,
    })
}

/// The first error of a branch that says that a member's word belongs to another branch, and the word of this one.
fn tag<'e, 'v>(branch: &'e [Violation<'v>], here: &Place) -> Option<(&'e Violation<'v>, &'v str)> {
    branch.iter().find_map(|error| match error.keyword {
        Keyword::Constant(Value::String(word)) if error.place != *here => Some((error, word.as_str())),
        _ => None,
    })
}

/// Returns the problem of a word that no branch has, if every branch expects another word in the same member.
fn wrong_tag(context: &[Vec<Violation<'_>>], here: &Place) -> Option<Problem> {
    let (first, _) = tag(context.first()?, here)?;
    let tags = context.iter().map(|branch| tag(branch, here));
    let words = tags.map(|tag| tag.filter(|(error, _)| error.place == first.place));
    let words: Vec<&str> = words.map(|tag| tag.map(|(_, word)| word)).collect::<Option<_>>()?;
    if words.len() < 2 || words.windows(2).any(|pair| pair[0] == pair[1]) {
        return None;
    }
    let message = match first.instance.as_str() {
        Some(found) => format!("there is no '{found}'{}", hint(found, &words)),
        None => format!("expected one of {}, found {}", words.join(", "), shown(first.instance)),
    };
    Some(Problem::structure(first.place.clone(), message))
}

/// A type, constant or list of words that does not fit at all.
const MISFIT_OF_TYPE: usize = 1_000_000;
/// A key that the branch needs: it distinguishes the branches.
const MISFIT_OF_MISSING_KEY: usize = 1_000;
/// A key that the branch does not know.
const MISFIT_OF_UNKNOWN_KEY: usize = 100;

fn branch_misfit(branch: &[Violation<'_>], here: &Place) -> usize {
    let (mut missing, mut unknown): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    for error in branch.iter().filter(|error| error.place == *here) {
        match &error.keyword {
            Keyword::Missing(key) => missing.push(*key),
            Keyword::UnknownKeys(keys) => unknown.extend(keys.iter().copied()),
            _ => {}
        }
    }
    // An unknown key that resembles a missing one is that one, misspelled.
    let misspelled = unknown.iter().filter(|key| nearest(key, &missing).is_some()).count();
    let sum: usize = branch.iter().map(|error| misfit(error, here)).sum();
    sum - MISFIT_OF_MISSING_KEY * misspelled.min(missing.len())
}

fn misfit(error: &Violation<'_>, here: &Place) -> usize {
    if error.place != *here {
        return 1;
    }
    match &error.keyword {
        Keyword::Type(_) | Keyword::Constant(_) => MISFIT_OF_TYPE,
        Keyword::Missing(_) => MISFIT_OF_MISSING_KEY,
        Keyword::UnknownKeys(keys) => MISFIT_OF_UNKNOWN_KEY * keys.len(),
        Keyword::Union(branches) => {
            branches.iter().map(|branch| branch_misfit(branch, here)).min().unwrap_or(MISFIT_OF_TYPE)
        }
        _ => 1,
    }
}

fn collect_expectations(context: &[Vec<Violation<'_>>], here: &Place, all: &mut Vec<String>) {
    for error in context.iter().flatten().filter(|error| error.place == *here) {
        if let Keyword::Union(branches) = &error.keyword {
            collect_expectations(branches, here, all);
        } else if let Some(text) = expected(error).filter(|text| text != "null" && !all.contains(text)) {
            all.push(text);
        }
    }
}

/// Returns what the schema wants, for the errors that are about type or choice.
fn expected(error: &Violation<'_>) -> Option<String> {
    match &error.keyword {
        Keyword::Type(kinds) => {
            let is_one = kinds.len() == 1;
            let named = kinds.iter().filter(|kind| is_one || **kind != JsonType::Null);
            Some(either(&named.map(|kind| type_name(*kind).to_owned()).collect::<Vec<_>>()))
        }
        Keyword::Constant(value) => Some(value.to_string()),
        _ => None,
    }
}

/// The nearest of several quoted words to a text that is none of them.
fn word_hint(found: &Value, expectations: &[String]) -> String {
    let words: Vec<&str> = expectations.iter().map(|text| text.trim_matches('"')).collect();
    let near = found.as_str().and_then(|found| nearest(found, &words));
    near.map_or_else(String::new, |near| format!("; nearest valid name: '{near}'"))
}

fn type_name(kind: JsonType) -> &'static str {
    match kind {
        JsonType::Array => "an array",
        JsonType::Boolean => "true or false",
        JsonType::Integer => "a whole number",
        JsonType::Null => "null",
        JsonType::Number => "a number",
        JsonType::Object => "an object",
        JsonType::Text => "a text",
    }
}

fn either(names: &[String]) -> String {
    match names {
        [] => "something else".to_owned(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

fn entries(limit: u64) -> String {
    if limit == 1 { "1 entry".to_owned() } else { format!("{limit} entries") }
}

fn count(error: &Violation<'_>) -> usize {
    error.instance.as_array().map_or(0, Vec::len)
}

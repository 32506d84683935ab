//! Problems of a case, and their places.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::PathBuf;

/// A place in the JSON document, written `$.steps[0].target.e11`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Place(String);

impl Place {
    /// The whole document.
    pub fn root() -> Self {
        Self("$".into())
    }

    /// A place by its path from the root, such as `fibre.law[2]`.
    pub(crate) fn path(path: &str) -> Self {
        Self(format!("$.{path}"))
    }

    /// The place of a path with points, such as `steps.0.slip`.
    pub(crate) fn of_setting(path: &str) -> Self {
        path.split('.').fold(Self::root(), |place, key| match key.parse() {
            Ok(index) => place.index(index),
            Err(_) => place.key(key),
        })
    }

    /// A command-line override rather than a place in the document.
    pub fn option(text: &str) -> Self {
        Self(format!("--set {text}"))
    }

    /// A member of an object.
    #[must_use]
    pub fn key(&self, key: &str) -> Self {
        let plain = !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || "_$-".contains(c));
        Self(if plain { format!("{}.{key}", self.0) } else { format!("{}[{key:?}]", self.0) })
    }

    /// An element of an array.
    #[must_use]
    pub fn index(&self, index: usize) -> Self {
        Self(format!("{}[{index}]", self.0))
    }

    /// Returns the place as `--set` names it: `material.props`.
    pub fn in_words(&self) -> &str {
        self.0.trim_start_matches("$.")
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Kind of a problem: what its remedy is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProblemKind {
    /// The input is wrong: another value may be right there.
    Input,
    /// The case is built in another way: no value is right at a place that it has not, nor a text where a number is wanted.
    Structure,
    /// The plugin library cannot be found, opened, or lacks the entry point.
    #[serde(rename = "plugin")]
    PluginNotLoadable,
}

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Problem {
    /// Place in the file; `None` if the file as a whole cannot be read as JSON.
    pub place: Option<Place>,
    /// Message: the problem and its remedy.
    pub message: String,
    /// Kind of its remedy.
    pub kind: ProblemKind,
}

impl Problem {
    /// Wrong input at a place.
    pub fn new(place: Place, message: impl Into<String>) -> Self {
        Self { place: Some(place), message: message.into(), kind: ProblemKind::Input }
    }

    /// A place that the case has not, or that takes something else.
    pub fn structure(place: Place, message: impl Into<String>) -> Self {
        Self { kind: ProblemKind::Structure, ..Self::new(place, message) }
    }

    /// A plugin that cannot be loaded.
    pub fn plugin(place: Place, message: impl Into<String>) -> Self {
        Self { place: Some(place), message: message.into(), kind: ProblemKind::PluginNotLoadable }
    }

    /// A plugin that cannot be loaded, wherever the case names it.
    pub fn library(message: impl Into<String>) -> Self {
        Self { kind: ProblemKind::PluginNotLoadable, ..Self::unreadable(message) }
    }

    /// A file that cannot be read at all.
    pub fn unreadable(message: impl Into<String>) -> Self {
        Self { place: None, message: message.into(), kind: ProblemKind::Input }
    }

    /// The problem of a contact's material as one of a bond law that a case of kind "bridging" gives.
    pub(crate) fn of_bond_law(self) -> Self {
        let law = |text: &str| text.replace("$.material", "$.fibre.law");
        let (place, beyond) = match &self.place {
            Some(place) if place.0.starts_with("$.material") => (Place(law(&place.0)), String::new()),
            // not of the law itself: of the case in which it is asked
            other => (Place("$.fibre.law".into()), other.as_ref().map_or(String::new(), |place| format!("{place}: "))),
        };
        Self { place: Some(place), message: format!("{beyond}{}", law(&self.message)), kind: self.kind }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

/// Most problems that are listed one by one; of more, only the number is given.
pub const MOST_SHOWN: usize = 50;
/// Most characters of a problem that are shown.
const LONGEST_LINE: usize = 1000;

/// Everything that is wrong with a case file.
#[derive(Clone, Debug)]
pub struct CaseErrors {
    /// The case file.
    pub file: PathBuf,
    /// At least one problem.
    pub problems: Vec<Problem>,
}

impl CaseErrors {
    /// 3 if all that is wrong is that the plugin cannot be loaded, else 2.
    pub fn exit_code(&self) -> u8 {
        if self.problems.iter().all(|problem| problem.kind == ProblemKind::PluginNotLoadable) { 3 } else { 2 }
    }

    /// Returns what is wrong, a line each, without the file.
    pub fn lines(&self) -> Vec<String> {
        let line = |problem: &Problem| {
            // names and texts of the case may be of any length
            let line: String = problem.to_string().chars().take(LONGEST_LINE + 1).collect();
            let end = line.char_indices().nth(LONGEST_LINE).map_or(line.len(), |(end, _)| end);
            line[..end].replace('\n', "\\n") + if end < line.len() { "…" } else { "" }
        };
        let more = self.problems.len().saturating_sub(MOST_SHOWN);
        let more = (more > 0).then(|| format!("and {more} more problems"));
        self.problems.iter().take(MOST_SHOWN).map(line).chain(more).collect()
    }
}

impl fmt::Display for CaseErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (file, lines) = (self.file.display(), self.lines());
        lines.iter().enumerate().try_for_each(|(k, line)| write!(f, "{}{file}: {line}", if k == 0 { "" } else { "\n" }))
    }
}

impl std::error::Error for CaseErrors {}

/// "; nearest valid name: 'e11'", or the list of valid names if none is near and the list is short.
pub fn hint<S: AsRef<str>>(name: &str, valid: impl IntoIterator<Item = S>) -> String {
    let valid: Vec<S> = valid.into_iter().collect();
    suggestion(nearest(name, &valid), &valid)
}

/// Returns such a hint from the [`nearest`] name of the list.
pub fn suggestion<S: AsRef<str>>(nearest: Option<&str>, valid: &[S]) -> String {
    const MOST_LISTED: usize = 24;
    if let Some(nearest) = nearest {
        return format!("; nearest valid name: '{nearest}'");
    }
    let names: Vec<&str> = valid.iter().map(AsRef::as_ref).collect();
    match names.len() {
        0 => String::new(),
        1..=MOST_LISTED => format!("; valid names: {}", names.join(", ")),
        more => format!("; valid names: {}, … ({more} in all)", names[..MOST_LISTED].join(", ")),
    }
}

/// The most similar name, if any is similar; of equally distant ones that with the longer common end (e12 → g12).
pub fn nearest<'a, S: AsRef<str>>(name: &str, valid: &'a [S]) -> Option<&'a str> {
    let wanted = name.to_lowercase();
    let length = wanted.chars().count();
    let tolerated = (length * 2 / 5).max(1).min(length.saturating_sub(1));
    valid
        .iter()
        .map(|candidate| {
            let candidate = candidate.as_ref();
            let lower = candidate.to_lowercase();
            let common_end = wanted.chars().rev().zip(lower.chars().rev()).take_while(|(a, b)| a == b).count();
            (strsim::damerau_levenshtein(&wanted, &lower), usize::MAX - common_end, candidate)
        })
        .filter(|(distance, ..)| *distance <= tolerated)
        .min()
        .map(|(.., candidate)| candidate)
}

/// A JSON value in a message, cut to a readable length.
pub fn shown(value: &serde_json::Value) -> String {
    const LONGEST: usize = 60;
    let text = value.to_string();
    if text.chars().count() <= LONGEST {
        return text;
    }
    text.chars().take(LONGEST).chain("…".chars()).collect()
}

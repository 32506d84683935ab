//! Faults of a Gmsh file and their places.

use std::path::PathBuf;

/// A fault of a Gmsh file. Tags of nodes and elements in the message are those of Gmsh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{place}: {fault}", path.display())]
pub struct GmshError {
    /// The file.
    pub path: PathBuf,
    /// The place in the file.
    pub place: Place,
    /// The fault in words, with its remedy.
    pub fault: String,
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, from 1.
    Line(usize),
    /// A byte of a binary file, from 0.
    Byte(usize),
}

impl std::fmt::Display for Place {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(formatter, ":{line}"),
            Self::Byte(byte) => write!(formatter, ", byte {byte}"),
        }
    }
}

/// Other text than the format requires here.
pub(super) fn unexpected(expected: &str, found: &str) -> String {
    format!("expected {expected}, found '{found}'; is a count of this section wrong, or the file edited?")
}

/// Too early an end.
pub(super) fn truncated(expected: &str) -> String {
    format!("the file ends where {expected} should be; it is truncated, save it again")
}

/// The beginning of a word in a message, which binary rubbish would make unreadable.
pub(super) fn shown(word: &str) -> String {
    word.chars().take(40).collect::<String>().escape_debug().to_string()
}

/// Physical surfaces to which the caller gave no properties, names of the caller that are no physical surface, and all physical
/// surfaces with elements.
pub(super) fn part_names(without_properties: &[String], without_elements: &[String], available: &[String]) -> String {
    let quoted = |names: &[String]| names.iter().map(|name| format!("'{name}'")).collect::<Vec<_>>().join(", ");
    let mut message = String::new();
    if !without_elements.is_empty() {
        message += &format!("no physical surface with elements is called {}; ", quoted(without_elements));
    }
    if !without_properties.is_empty() {
        message += &format!("no properties are given for the physical surface {}; ", quoted(without_properties));
    }
    message + "the file's physical surfaces are " + &quoted(available)
}

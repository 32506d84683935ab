//! Faults of a Gmsh file, and their words.

/// A fault of a Gmsh file with its place and its remedy, in words. Tags of nodes and elements are those of Gmsh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct GmshError(pub(super) String);

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

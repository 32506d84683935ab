//! Options of the keywords that are understood.

use super::keywords::Keyword;

/// Options by keyword: those that are taken over, that change no result, or that are refused or listed where the keyword is read.
const UNDERSTOOD: [(&str, &[&str]); 22] = [
    ("AMPLITUDE", &["DEFINITION", "NAME", "SMOOTH", "TIME", "VALUE"]),
    ("BOUNDARY", &["AMPLITUDE", "FIXED", "OP", "SUBMODEL", "TYPE", "USER"]),
    ("CLOAD", &["AMPLITUDE", "CYCLIC MODE", "FILE", "FOLLOWER", "OP", "USER"]),
    ("DEPVAR", &[]),
    ("DLOAD", &["AMPLITUDE", "CYCLIC MODE", "FILE", "FOLLOWER", "OP", "USER"]),
    ("DSLOAD", &["AMPLITUDE", "CYCLIC MODE", "FILE", "FOLLOWER", "OP", "USER"]),
    ("ELEMENT", &["ELSET", "TYPE"]),
    ("ELSET", &["ELSET", "GENERATE", "INSTANCE", "INTERNAL"]),
    ("EXPANSION", &["DEPENDENCIES", "TYPE", "USER", "ZERO"]),
    ("FIELD", &["AMPLITUDE", "FILE", "OP", "USER", "VARIABLE"]),
    ("INITIAL CONDITIONS", &["FILE", "GEOSTATIC", "INPUT", "SECTION POINTS", "TYPE", "USER", "VARIABLE"]),
    ("MATERIAL", &["NAME"]),
    ("NODE", &["NSET", "SYSTEM"]),
    ("NSET", &["ELSET", "GENERATE", "INSTANCE", "INTERNAL", "NSET", "UNSORTED"]),
    ("ORIENTATION", &["DEFINITION", "LOCAL DIRECTIONS", "NAME", "SYSTEM"]),
    ("SOLID SECTION", &["COMPOSITE", "CONTROLS", "ELSET", "MATERIAL", "ORIENTATION"]),
    ("STATIC", &["DIRECT", "NO STOP", "RIKS"]),
    ("STEP", &["AMPLITUDE", "CONVERT SDI", "EXTRAPOLATION", "INC", "NAME", "NLGEOM", "PERTURBATION", "UNSYMM"]),
    ("SURFACE", &["INTERNAL", "NAME", "TYPE"]),
    ("TEMPERATURE", &["AMPLITUDE", "FILE", "OP", "USER"]),
    ("USER MATERIAL", &["CONSTANTS", "TYPE", "UNSYMM"]),
    ("VISCO", &["CETOL", "DIRECT", "NO STOP"]),
];

/// Returns the options of a keyword that would be lost without a word.
pub(super) fn not_understood(keyword: &Keyword) -> Vec<&str> {
    let understood = UNDERSTOOD.iter().find(|(name, _)| *name == keyword.name).map(|(_, options)| *options);
    let Some(understood) = understood else { return Vec::new() };
    keyword.options().filter(|option| !understood.contains(option)).collect()
}

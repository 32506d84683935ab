//! `--debug`: what makes a library say where it goes wrong.

use super::source::Language;

/// The C part of such a library: a mark for the host, which traps invalid operations, divisions by zero and overflow
/// while it is called, and a handler that tells the lines of the source below a fatal signal. (Fortran's own handlers
/// and `-ffpe-trap` work in Fortran main programs only.)
pub(super) const SOURCE: &str = include_str!("debug.c");

/// Returns what a compiler gets in place of optimisation.
pub(super) fn flags(language: Language) -> &'static [&'static str] {
    match language {
        Language::Fortran(_) => &[
            "-Og",
            "-g",
            "-fbacktrace",
            "-fcheck=all,no-array-temps",
            "-finit-real=snan",
            "-fsignaling-nans",
            "-finit-derived",
        ],
        _ => &["-Og", "-g", "-fno-omit-frame-pointer"],
    }
}

//! The program `pullout`: its command line.
//!
//! The work is done by other crates: `pullout-case` makes programs of cases, `pullout-run` runs them, `pullout-report`
//! writes their results down; `pullout-study`, `pullout-fit` and `pullout-check` do so many times over.

pub mod command;

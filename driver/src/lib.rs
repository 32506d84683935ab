//! The program `pullout`: its command line.
//!
//! What it does stands in crates beside it: `pullout-case` makes programs of cases, `pullout-run` runs them,
//! `pullout-report` writes down what came out; `pullout-study`, `pullout-fit` and `pullout-check` do so many times over.

pub mod command;

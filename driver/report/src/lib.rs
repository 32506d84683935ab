//! Results of runs as files (docs/reference/result-folder.md).
//!
//! [`history`] is written while the run goes on, one system call a line; [`progress`] shows the user how far it is.
//! Afterwards the history is read back: [`compare`] measures it against experiments, [`plots`] draws it, [`summary`],
//! [`page`] and [`outcome`] report the results. Nothing of the curve is kept in memory during the run.

use std::io;
use std::path::Path;

pub mod bridging;
pub mod compare;
pub mod directory;
pub mod ending;
pub mod history;
pub mod outcome;
pub mod page;
mod pictures;
pub mod plots;
pub mod progress;
pub mod record;
pub mod softening;
pub mod summary;
pub mod viewer;

#[cfg(test)]
mod test;

/// Puts the file's name in front of an error's message.
pub fn at(path: &Path) -> impl FnOnce(io::Error) -> io::Error + '_ {
    move |error| io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}

/// The error of a build that lacks a feature; `need`: what needs it, with the verb.
pub fn lacks(need: &str, feature: &str) -> io::Error {
    let message = format!("{need} the feature `{feature}`: cargo build --release --features {feature}");
    io::Error::new(io::ErrorKind::Unsupported, message)
}

/// Least and greatest of numbers; of none ∞ and −∞.
fn extremes(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    numbers
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), number| (least.min(number), greatest.max(number)))
}

/// Less than this part of the greatest value of its kind is what rounding leaves.
const ROUNDING: f64 = 1e-9;

/// 0 for what is nothing compared with the greatest value.
fn without_rounding(value: f64, greatest: f64) -> f64 {
    if value.abs() < ROUNDING * greatest { 0.0 } else { value }
}

/// A file with wrong content.
fn malformed(path: &Path, message: impl std::fmt::Display) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, format!("{}: {message}", path.display()))
}

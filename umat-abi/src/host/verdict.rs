//! A host's verdict on a call that came back.

use super::call::CallOutcome;
use super::memory::{NotFinite, Overrun};
use std::fmt;

/// Reason why a host cannot use the results of a call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CallFailure {
    /// The plugin asks for this fraction of the increment.
    CutBack(f64),
    /// A result is not finite.
    NotFinite(NotFinite),
    /// The plugin wrote outside an array.
    Overrun(Overrun),
}

impl CallFailure {
    /// The fraction of the increment that is worth a try: `usual` where the plugin does not name one; `None`: no smaller one can
    /// help.
    pub fn fraction(&self, usual: f64) -> Option<f64> {
        match self {
            Self::CutBack(fraction) if *fraction > 0.0 => Some(*fraction),
            Self::CutBack(_) => Some(usual),
            Self::NotFinite(_) => Some(usual),
            Self::Overrun(_) => None,
        }
    }
}

impl fmt::Display for CallFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CutBack(fraction) if fraction.is_nan() || *fraction <= 0.0 => {
                write!(f, "it returned PNEWDT = {fraction:?}, which is no part of the increment")
            }
            Self::CutBack(fraction) => write!(f, "it asks for smaller increments (PNEWDT = {fraction:?})"),
            Self::NotFinite(result) => write!(f, "it returned {result}"),
            Self::Overrun(overrun) => overrun.fmt(f),
        }
    }
}

/// Judges a call by its outcome and by the first result that is not finite.
///
/// # Errors
/// The reason why the host cannot use the results.
#[inline]
pub fn judge(outcome: Result<CallOutcome, Overrun>, not_finite: Option<NotFinite>) -> Result<(), CallFailure> {
    match (outcome, not_finite) {
        (Ok(CallOutcome::Done), None) => Ok(()),
        (Ok(CallOutcome::Done), Some(result)) => Err(CallFailure::NotFinite(result)),
        (Ok(CallOutcome::CutBack(fraction)), _) => Err(CallFailure::CutBack(fraction)),
        (Err(overrun), _) => Err(CallFailure::Overrun(overrun)),
    }
}

#[cfg(test)]
mod test;

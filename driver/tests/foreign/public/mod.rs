//! UMATs of the kinds that are published: what each computes along a path, against closed forms and independent
//! integrations, and what `plugin check` says of it, of a variant with one error (`-DPLANTED`) and of a path on which
//! nothing happens.

mod cases;
mod curves;
mod verdicts;

use super::{built_of, run};
use crate::program::{Desk, Table};
use serde_json::Value;

/// Published law: its sources and the case that drives it.
struct PublishedLaw {
    sources: &'static [&'static str],
    /// The case of a library.
    case: fn(Value) -> Value,
}

impl PublishedLaw {
    /// The sources compiled; `None`, after a notice, where there is no compiler.
    fn built(&self, desk: &Desk, flags: &[&str]) -> Option<Value> {
        desk.write("hardening.txt", cases::HARDENING);
        built_of(desk, self.sources, flags)
    }

    /// The history along the case's own path, or a changed one's.
    fn driven(&self, change: impl Fn(&mut Value)) -> Option<Table> {
        let desk = Desk::new();
        let mut case = (self.case)(self.built(&desk, &[])?);
        change(&mut case);
        Some(run(&desk, "driven", &case).history)
    }

    /// Returns both histories, the second with twice the increments in every step.
    fn refined(&self, increments: usize) -> Option<[Table; 2]> {
        let with = |increments: usize| {
            self.driven(|case| {
                for step in case["steps"].as_array_mut().expect("steps") {
                    step["increments"] = increments.into();
                }
            })
        };
        Some([with(increments)?, with(2 * increments)?])
    }
}

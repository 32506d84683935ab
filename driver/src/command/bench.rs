//! `pullout bench`.

use super::{DONE, FAILED, NO_PLUGIN, complain, say};
use crate::bench::{self, BenchError, Findings, Item, Settings};
use std::path::PathBuf;

/// What is measured, and how.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// What to measure; default: everything.
    #[arg(value_enum, value_name = "ITEM")]
    items: Vec<Item>,
    /// Only show that it works: seconds instead of minutes, and times that mean little.
    #[arg(long)]
    quick: bool,
    /// stability: states thrown at each form of a law in each stress state (default a million; 1000 if quick).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    states: Option<u64>,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "bench/results")]
    out: PathBuf,
    /// peers: a Python that has simcoon (default: PULLOUT_PYTHON, or python3 of the PATH).
    #[arg(long, value_name = "PYTHON")]
    python: Option<PathBuf>,
    /// Look for plugins here first (may be repeated).
    #[arg(long = "plugin-path", value_name = "DIR")]
    plugin_paths: Vec<PathBuf>,
}

/// Measures one item after the other; one that fails does not keep the others from being measured.
pub(super) fn run(arguments: &Arguments) -> u8 {
    let mut items = arguments.items.clone();
    items.sort_unstable();
    items.dedup();
    let items = if items.is_empty() { Item::ALL } else { &items };
    let settings = Settings {
        quick: arguments.quick,
        states: arguments.states,
        python: arguments.python.clone().or_else(|| std::env::var_os("PULLOUT_PYTHON").map(PathBuf::from)),
        plugin_paths: arguments.plugin_paths.clone(),
    };
    let measure = |item: &Item| match bench::measure(*item, &settings, &arguments.out) {
        Ok(Findings { text, failed }) => {
            say(&format!("{text}\n-> {}\n\n", arguments.out.join(format!("{}.md", item.name())).display()));
            failed.map_or(DONE, |failed| {
                complain(format!("{}: {failed}", item.name()));
                FAILED
            })
        }
        Err(error) => {
            complain(format!("{}: {error}", item.name()));
            match error {
                BenchError::Plugin(_) | BenchError::Missing { .. } => NO_PLUGIN,
                BenchError::Case(errors) => errors.exit_code(),
                BenchError::Failed(_) | BenchError::File(_) => FAILED,
            }
        }
    };
    items.iter().map(measure).max().unwrap_or(DONE)
}

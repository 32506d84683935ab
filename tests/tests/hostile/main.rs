//! Hostile input, thrown at the program in numbers: damaged cases, meshes, checkpoints and sweeps, plugins that misbehave, and kills.
//!
//! ```text
//! cargo test -p end-to-end-tests --test hostile                     # a part of each, for every build
//! PULLOUT_HOSTILE=all cargo test -p end-to-end-tests --test hostile # all
//! PULLOUT_HOSTILE=cases:17 cargo test …                             # one, after it failed
//! cargo test … --test hostile -- meshes                             # a module alone
//! ```
//!
//! Expected of each: exit 0, 1, 2 or 3 in time; if not 0, a message that names the file; no panic, no signal, no
//! more than a gigabyte; nothing changed outside the results. Each number gives the same input everywhere.
//!
//! The test program is `pullout` itself when it is called by that name, so that workers that it starts are it as well.

mod cases;
mod checkpoints;
mod kills;
mod leftovers;
mod meshes;
mod plugins;
mod process;
mod specimen;
mod suite;
mod sweeps;

use std::process::ExitCode;
use suite::{Form, Tally};

/// A kind of hostile input.
type Module = (&'static str, fn(&Form) -> Tally);

const MODULES: [Module; 7] = [
    ("cases", cases::run),
    ("meshes", meshes::run),
    ("checkpoints", checkpoints::run),
    ("kills", kills::run),
    ("plugins", plugins::run),
    ("leftovers", leftovers::run),
    ("sweeps", sweeps::run),
];

fn main() -> ExitCode {
    let mut arguments = std::env::args_os();
    if arguments.next().is_some_and(|name| name == process::NAME) {
        return driver::command::main(std::env::args_os()).into();
    }
    let wanted: Vec<String> =
        arguments.filter_map(|word| word.into_string().ok()).filter(|w| !w.starts_with('-')).collect();
    let form = Form::given();
    let is_wanted = |name: &str| {
        form.concerns(name) && (wanted.is_empty() || wanted.iter().any(|word| name.contains(word.as_str())))
    };
    suite::silence_panics();
    process::bound_processes();
    let mut has_failed = false;
    println!("{:12} {:>6} {:>6} {:>8}", "", "tried", "held", "s");
    for (name, run) in MODULES.into_iter().filter(|(name, _)| is_wanted(name)) {
        let start = std::time::Instant::now();
        let tally = run(&form);
        println!(
            "{name:12} {:>6} {:>6} {:>8.1}",
            tally.tried,
            tally.tried - tally.broken.len(),
            start.elapsed().as_secs_f64()
        );
        for broken in &tally.broken {
            println!("{name}:{broken}");
        }
        has_failed |= !tally.broken.is_empty();
    }
    let peak = process::peak_of_children();
    if peak > process::MOST_MEMORY {
        println!("a process took {} MB, more than {} MB", peak >> 20, process::MOST_MEMORY >> 20);
        has_failed = true;
    }
    ExitCode::from(u8::from(has_failed))
}

use super::super::{Command, CommandLine};
use clap::{CommandFactory, Parser};
use pullout_engine::Job;
use serde_json::Value;
use std::collections::BTreeSet;

/// Options of `pullout run`, each with a value: they are passed to the worker.
const FORWARDED: &[(&str, &str)] = &[
    ("out", "--out=elsewhere"),
    ("overrides", "--set=steps.0.increments=5"),
    ("plugin_paths", "--plugin-path=plugins"),
    ("untrusted", "--untrusted"),
    ("restart", "--restart=earlier"),
    ("overwrite", "--overwrite"),
    ("checkpoint_every", "--checkpoint-every=3"),
    ("threads", "--threads=2"),
    ("record_increments", "--record-increments"),
    ("quiet", "--quiet"),
    // which is to be quiet
    ("json", "--json"),
    ("echo", "--echo"),
];
/// Arguments that are no part of a job: the job names its case, all processes learn in another way where plugins are called, and
/// `--watch` and `--open` concern this process alone.
const NOT_FORWARDED: [&str; 4] = ["cases", "in_process", "watch", "open"];

/// The job of a command line, as another process gets it.
fn handed_over(options: &[&str]) -> Value {
    let line = ["pullout", "run", "case.json"].iter().chain(options);
    let Command::Run(arguments) = CommandLine::try_parse_from(line).expect("a command line").command else {
        panic!("another command")
    };
    let text = serde_json::to_string(&arguments.jobs()[0]).expect("JSON");
    let job: Job = serde_json::from_str(&text).expect("a job");
    let again = serde_json::to_value(&job).expect("JSON");
    assert_eq!(again.to_string(), text, "nothing is lost on the way");
    again
}

#[test]
fn each_option_is_passed_to_another_process() {
    let line = CommandLine::command();
    let run = line.find_subcommand("run").expect("the command");
    let known: BTreeSet<&str> = run.get_arguments().map(|argument| argument.get_id().as_str()).collect();
    let listed: BTreeSet<&str> = FORWARDED.iter().map(|(name, _)| *name).chain(NOT_FORWARDED).collect();
    assert_eq!(known, listed, "a new option is forwarded, or deliberately not");
    let plain = handed_over(&[]);
    for &(name, option) in FORWARDED {
        assert_ne!(handed_over(&[option]), plain, "{name}");
    }
    assert_eq!(handed_over(&["--in-process"]), plain);
}

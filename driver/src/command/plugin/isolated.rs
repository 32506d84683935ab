//! `pullout plugin info` of a library that nobody vouches for, in a process of its own.

use super::super::{BAD_INPUT, FAILED, NO_PLUGIN, complain};
use crate::isolation::{self, End, Job, Need, worker};
use std::ffi::OsString;
use std::path::Path;

/// Runs a command line of this program that loads `library` and calls it, if the library needs it; the exit code.
/// `None`: it needs no process of its own, or this is it.
pub(super) fn supervised(library: &Path, command: &[OsString], paths: &[std::path::PathBuf]) -> Option<u8> {
    if worker::is_this_process() {
        return None;
    }
    let need = isolation::need_of_library(library, None, &[], paths)?;
    Some(supervise(library, &Job::of_command(command), &need))
}

fn supervise(library: &Path, job: &Job<'_>, need: &Need) -> u8 {
    match isolation::supervise(job, need) {
        Ok(End::Done(code)) => code,
        Ok(End::Failed(failure)) if failure.report.at_loading => {
            complain(failure.report.message);
            NO_PLUGIN
        }
        Ok(End::Failed(failure)) => {
            complain(format!("{}: {}", library.display(), failure.report.message));
            FAILED
        }
        Err(error) => {
            complain(format!("{}: no process can be started for it: {error}", library.display()));
            BAD_INPUT
        }
    }
}

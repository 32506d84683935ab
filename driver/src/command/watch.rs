//! `pullout run --watch`: runs cases again whenever a file that they depend on changes.

use super::{DONE, complain};
use pullout_engine::CaseSource;
use pullout_lab::FileWatch;
use pullout_run::signals;

/// Executes the work again whenever a file of the cases has changed, until a signal arrives. Returns the exit code of the work
/// that the signal ended, otherwise success.
pub(super) fn again_and_again(cases: &[CaseSource], act: &dyn Fn() -> u8) -> u8 {
    loop {
        // what is saved while they run is a change as well
        let files = cases.iter().map(FileWatch::of_case).reduce(FileWatch::and);
        let Some(mut files) = files else { return DONE };
        let code = act();
        if signals::received().is_some() {
            return code;
        }
        complain(format!("watching {} files; Ctrl-C ends", files.files().count()));
        let changed = files.wait(&|| signals::received().is_some());
        if changed.is_empty() {
            return DONE;
        }
        let names: Vec<String> = changed.iter().map(|file| file.display().to_string()).collect();
        complain(format!("changed: {}", names.join(", ")));
    }
}

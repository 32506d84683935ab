//! Runs that may be interrupted: `--checkpoint-every` and `--restart`.

use pullout_case::Case;
use pullout_engine::Job;
use pullout_report::record::Kept;
use pullout_run::input::{digest, hexadecimal};
use pullout_run::pullout::checkpoint::{self, Checkpoints};
use std::collections::BTreeSet;
use std::fmt::Display;
use std::fs;
use std::path::PathBuf;

/// Returns whether checkpoints or a restart were requested.
fn is_asked_for(job: &Job) -> bool {
    job.options.checkpoint_every.is_some() || job.goes_on
}

/// Checks that a case supports what was requested. The error is the reason why it does not.
pub(super) fn suits(job: &Job, is_specimen: bool) -> Result<(), String> {
    if is_specimen || !is_asked_for(job) {
        return Ok(());
    }
    Err("only runs of kind \"pullout\" have checkpoints: leave --checkpoint-every and --restart out".into())
}

/// Returns warnings about libraries that may keep data for a restart in their own memory.
pub(super) fn warnings(job: &Job, case: &Case) -> Vec<String> {
    let Case::Pullout(program) = case else { return Vec::new() };
    let undescribed = program.laws().into_iter().filter(|(_, law)| is_asked_for(job) && law.law.is_none());
    let libraries: BTreeSet<_> = undescribed.map(|(_, law)| law.library.path().to_owned()).collect();
    let warning = |library: &PathBuf| {
        format!(
            "{}: what it keeps in its own memory (SAVE, COMMON) is in no checkpoint, and is not there after a restart",
            library.display()
        )
    };
    libraries.iter().map(warning).collect()
}

/// Returns the checkpoints of a case's run.
pub(super) fn checkpoints(job: &Job, case: &Case) -> Result<Checkpoints, String> {
    let Case::Pullout(program) = case else {
        return suits(job, false).map(|()| Checkpoints::default());
    };
    let (every, folder) = (job.options.checkpoint_every, &job.folder);
    if !job.goes_on {
        return Checkpoints::new(program, every).map_err(|error| error.to_string());
    }
    let checkpoints = Checkpoints::restart(program, folder, every)?;
    let kept = checkpoints.from.as_deref().and_then(Kept::of);
    let Kept { history_bytes: bytes, history_sha256, .. } = kept.ok_or_else(|| {
        format!("{}: this is not a checkpoint, or it is damaged", folder.join(checkpoint::FILE).display())
    })?;
    let history = folder.join("history.csv");
    let named = |message: &dyn Display| format!("{}: {message}", history.display());
    if fs::metadata(&history).map_err(|error| named(&error))?.len() < bytes {
        return Err(named(&"rows from before the checkpoint are missing"));
    }
    if digest(&history, bytes).map(hexadecimal).map_err(|error| named(&error))? != history_sha256 {
        return Err(named(
            &"rows from before the checkpoint were changed: a restart needs the files as the run left them",
        ));
    }
    Ok(checkpoints)
}

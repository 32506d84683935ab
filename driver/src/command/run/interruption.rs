//! Runs that may be interrupted: `--checkpoint-every` and `--restart`.

use pullout_case::Case;
use pullout_report::record::Kept;
use pullout_run::input::{digest, hexadecimal};
use pullout_run::pullout::PulloutProgram;
use pullout_run::pullout::checkpoint::{self, Checkpoints};
use std::collections::BTreeSet;
use std::fmt::Display;
use std::fs;
use std::path::PathBuf;

/// Runs that may be interrupted.
#[derive(Debug, Default, clap::Args)]
pub(in crate::command) struct Interruption {
    /// Keep the state after every N increments in checkpoint.bin of the result directory (kind "pullout").
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(in crate::command) checkpoint_every: Option<u64>,
    /// Go on with the run that was interrupted in this result directory, from its last checkpoint; later rows and fields
    /// are computed again, to the same bits. What a library keeps in its own memory (SAVE, COMMON) is in no checkpoint:
    /// its UEXTERNALDB is told of the restart (LOP = 4).
    #[arg(long, value_name = "DIR", conflicts_with = "out")]
    pub(in crate::command) restart: Option<PathBuf>,
}

impl Interruption {
    /// Returns whether anything of it was asked for.
    fn is_asked_for(&self) -> bool {
        self.checkpoint_every.is_some() || self.restart.is_some()
    }

    /// Checks that a case may have what was asked for; the error is the reason why not.
    pub(super) fn suits(&self, is_specimen: bool) -> Result<(), String> {
        if is_specimen || !self.is_asked_for() {
            return Ok(());
        }
        Err("only runs of kind \"pullout\" have checkpoints: leave --checkpoint-every and --restart out".into())
    }

    /// Warns of libraries that may keep in their own memory what a restart needs.
    pub(super) fn warn_of_memory(&self, program: &mut PulloutProgram) {
        if !self.is_asked_for() {
            return;
        }
        let undescribed = program.laws().into_iter().filter(|(_, law)| law.law.is_none());
        let libraries: BTreeSet<_> = undescribed.map(|(_, law)| law.library.path().to_owned()).collect();
        program.about.warnings.extend(libraries.iter().map(|library| {
            format!(
                "{}: what it keeps in its own memory (SAVE, COMMON) is in no checkpoint, and is not there after a restart",
                library.display()
            )
        }));
    }

    /// Returns what a case's run does with checkpoints.
    pub(super) fn checkpoints(&self, case: &Case) -> Result<Checkpoints, String> {
        let Case::Pullout(program) = case else {
            return self.suits(false).map(|()| Checkpoints::default());
        };
        match &self.restart {
            None => Checkpoints::new(program, self.checkpoint_every).map_err(|error| error.to_string()),
            Some(folder) => {
                let checkpoints = Checkpoints::restart(program, folder, self.checkpoint_every)?;
                let kept = checkpoints.from.as_deref().and_then(Kept::of);
                let Kept { history_bytes: bytes, history_sha256, .. } = kept.ok_or_else(|| {
                    format!("{}: this is no checkpoint, or it is damaged", folder.join(checkpoint::FILE).display())
                })?;
                let history = folder.join("history.csv");
                let named = |message: &dyn Display| format!("{}: {message}", history.display());
                if fs::metadata(&history).map_err(|error| named(&error))?.len() < bytes {
                    return Err(named(&"rows from before the checkpoint are missing"));
                }
                if digest(&history, bytes).map(hexadecimal).map_err(|error| named(&error))? != history_sha256 {
                    let message = "rows from before the checkpoint were changed: a run goes on with what it left";
                    return Err(named(&message));
                }
                Ok(checkpoints)
            }
        }
    }
}

//! A process of this program that does work for this one without being watched: what it calls that may end it, it watches
//! itself.

use super::passage::{Passage, Work};
use super::supervisor::POLL;
use super::system;
use super::worker::COMMAND;
use crate::signals::Interrupt;
use serde::de::DeserializeOwned;
use std::fs::File;
use std::io::{self, Read, Seek};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// A child, which ends with this process.
#[derive(Debug)]
pub struct Child {
    process: std::process::Child,
    passage: Passage,
    printed: File,
}

/// The command of the program that takes work from a file.
pub(super) fn command(passage: &Path) -> io::Result<Command> {
    let mut command = Command::new(system::program()?);
    command.arg0("pullout").arg(COMMAND).arg(passage);
    Ok(command)
}

impl Child {
    /// Starts one; it works in `folder`, if one is given.
    ///
    /// # Errors
    /// The system does not let it.
    pub fn start(work: &impl Work, folder: Option<&Path>) -> io::Result<Self> {
        let mut passage = Passage::new(work)?;
        let (printed, _) = system::shared_file()?;
        let mut command = command(passage.hand_over(None)?)?;
        command.stdin(Stdio::null()).stdout(printed.try_clone()?).stderr(printed.try_clone()?);
        if let Some(folder) = folder {
            command.current_dir(folder);
        }
        Ok(Self { process: system::spawn(command)?, passage, printed })
    }

    /// Waits for its end, and receives its messages. If `asked` returns an interrupt, the process is asked to end,
    /// once. With `patience` it is asked again after such a time, and then ended by force.
    ///
    /// # Errors
    /// It cannot be waited for.
    pub fn wait<M: DeserializeOwned>(
        &mut self,
        asked: &dyn Fn() -> Option<Interrupt>,
        patience: Option<Duration>,
        hear: &mut dyn FnMut(Vec<M>),
    ) -> io::Result<ExitStatus> {
        let mut last_asked: Option<(Instant, u32)> = None;
        loop {
            let ended = system::wait_for(&mut self.process, POLL)?;
            hear(self.passage.heard());
            if let Some(status) = ended {
                return Ok(status);
            }
            let times = match (last_asked, patience) {
                (None, _) => 1,
                (Some((last, times)), Some(patience)) if last.elapsed() > patience => times + 1,
                _ => continue,
            };
            let Some(interrupt) = asked() else { continue };
            last_asked = Some((Instant::now(), times));
            if times > 2 {
                self.process.kill()?;
            } else {
                interrupt.pass_on_to(&self.process);
            }
        }
    }

    /// Returns what it wrote to the standard output and the standard error.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn printed(&mut self) -> io::Result<Vec<u8>> {
        let mut text = Vec::new();
        self.printed.rewind()?;
        self.printed.read_to_end(&mut text)?;
        Ok(text)
    }
}

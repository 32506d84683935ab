//! Checkpoints of a run, and the run that goes on from one.
//!
//! ```text
//! checkpoint.bin   "pullout checkpoint\n" │ version, fingerprint of the case, increments between checkpoints, SHA-256 │ state
//! ```
//!
//! The state is in postcard's encoding, which keeps every bit of a number. The file is written next to its place and
//! moved there: a killed run leaves a whole one. The fingerprint covers all that the case was resolved to, and the
//! plugins' files. The SHA-256 covers all else: a file with the right one is trusted. It is no signature, so a
//! checkpoint from an unknown source is not read at all.

use super::PulloutProgram;
use super::recorder::RecorderState;
use crate::columns;
use crate::input::{self, Input, hexadecimal};
use crate::isolation::worker;
use fe_core::model::{ContactLaw, ContactPair, Model, PluginLaw};
use fe_core::stepping::Checkpoint;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, Write as _};
use std::path::Path;

/// Name of the file in the result directory.
pub const FILE: &str = "checkpoint.bin";
/// Name of a checkpoint while it is written.
pub const PARTIAL: &str = "checkpoint.partial";
const MAGIC: &[u8] = b"pullout checkpoint\n";
/// Version of the file's layout; a program of another version does not read it either.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), ", layout 13");

/// Use that a run makes of checkpoints.
#[derive(Debug, Default)]
pub struct Checkpoints {
    /// Increments between them; `None`: none are made.
    pub every: Option<u64>,
    /// The one to go on from.
    pub from: Option<Box<Saved>>,
    fingerprint: String,
}

/// A run that was interrupted.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Saved {
    pub(super) analysis: Checkpoint,
    pub(super) recorder: RecorderState,
    /// [`crate::path::Observer::state`].
    pub observer: Vec<u8>,
}

#[derive(Debug, Serialize, Deserialize)]
struct Header {
    version: String,
    fingerprint: String,
    every: u64,
    sha256: String,
}

impl Header {
    /// SHA-256 of what else stands in the file.
    fn digest(&self, state: &[u8]) -> String {
        let Self { version, fingerprint, every, .. } = self;
        hexadecimal(Sha256::new_with_prefix(format!("{version}\n{fingerprint}\n{every}\n")).chain_update(state))
    }
}

impl Checkpoints {
    /// Makes checkpoints of a program that is run from its start.
    ///
    /// # Errors
    /// A plugin's file that cannot be read.
    pub fn new(program: &PulloutProgram, every: Option<u64>) -> io::Result<Self> {
        let fingerprint = if every.is_some() { fingerprint(program)? } else { String::new() };
        Ok(Self { every, from: None, fingerprint })
    }

    /// Makes checkpoints of a program that goes on from the one in a result directory; `every`: `None` is as before.
    ///
    /// # Errors
    /// Why it cannot.
    pub fn restart(program: &PulloutProgram, folder: &Path, every: Option<u64>) -> Result<Self, String> {
        let path = folder.join(FILE);
        let named = |message: &str| format!("{}: {message}", path.display());
        let content = input::read(&path, Input::Checkpoint).map_err(|error| named(&error.to_string()))?;
        let damaged = || named("this is not a checkpoint, or it is damaged");
        let rest = content.strip_prefix(MAGIC).ok_or_else(damaged)?;
        let (header, state): (Header, &[u8]) = postcard::take_from_bytes(rest).map_err(|_| damaged())?;
        if header.version != VERSION {
            return Err(named(&format!("made by pullout {}; this is {VERSION}", header.version.escape_debug())));
        }
        if header.sha256 != header.digest(state) {
            return Err(damaged());
        }
        let fingerprint = fingerprint(program).map_err(|error| error.to_string())?;
        if header.fingerprint != fingerprint {
            return Err(named(
                "made by another case, or with other plugins: a restart needs the same case and plugins",
            ));
        }
        let saved: Box<Saved> = postcard::from_bytes(state).map_err(|_| damaged())?;
        if let Some(file) = saved.recorder.fields.as_ref().and_then(|fields| fields.changed(folder)) {
            let file = folder.join(file);
            return Err(format!(
                "{}: is missing or was changed since the checkpoint: a restart needs the files as the run left them",
                file.display()
            ));
        }
        Ok(Self { every: Some(every.unwrap_or(header.every)), from: Some(saved), fingerprint })
    }

    /// Writes a checkpoint.
    pub(super) fn write(&self, folder: &Path, saved: &Saved) -> io::Result<()> {
        let state = postcard::to_stdvec(saved).map_err(io::Error::other)?;
        let mut header = Header {
            version: VERSION.into(),
            fingerprint: self.fingerprint.clone(),
            every: self.every.unwrap_or_default(),
            sha256: String::new(),
        };
        header.sha256 = header.digest(&state);
        let header = postcard::to_stdvec(&header).map_err(io::Error::other)?;
        let path = folder.join(FILE);
        let partial = folder.join(PARTIAL);
        worker::look_after_plugins();
        let write = || {
            let mut file = File::create(&partial)?;
            [MAGIC, &header, &state].into_iter().try_for_each(|piece| file.write_all(piece))?;
            // the name must not reach the disk before the content
            file.sync_all()?;
            std::fs::rename(&partial, &path)
        };
        let written = write();
        if written.is_err() {
            let _ = std::fs::remove_file(&partial);
        }
        written.map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", path.display())))
    }
}

/// SHA-256 of everything that decides what a run computes and writes. Members are taken apart by name, so that none is
/// forgotten.
fn fingerprint(program: &PulloutProgram) -> io::Result<String> {
    let mut hash = Sha256::new();
    let Model {
        mesh,
        laws,
        average_dilatation,
        contacts,
        drives,
        initial_drives,
        supports,
        couplings,
        loads,
        nlgeom,
        measured,
        fields,
        field,
        steps,
        controls,
        skipping,
    } = &program.model;
    // Debug prints the shortest text that reads back to the same double
    hash.update(format!("{:?}", (mesh, average_dilatation, drives, supports, couplings, loads, nlgeom)));
    hash.update(format!("{:?}", (initial_drives, field)));
    hash.update(format!("{:?}", (measured, fields, steps, controls, skipping)));
    let about = &program.about;
    let written = (about.every, about.plots, program.fields_every, &program.pictures_at, program.rupture_strain);
    hash.update(format!("{:?}", (&program.step_untils, &about.until, written)));
    // what is kept of the rows has the columns of this program
    hash.update(format!("{:?}", columns::of_specimen(&measured.fibres)));
    for pair in contacts {
        let ContactPair {
            name,
            slave,
            master,
            law,
            quadrature,
            width,
            penalty_factor,
            enforcement,
            release,
            master_bends,
            critical_slip,
            fit,
            bearing,
        } = pair;
        hash.update(format!("{:?}", (name, slave, master, quadrature, width)));
        hash.update(format!("{:?}", (penalty_factor, enforcement, release, master_bends, critical_slip, fit, bearing)));
        match law {
            ContactLaw::Uinter(law) => add_law(&mut hash, law)?,
            ContactLaw::Fric { law, normal } => {
                hash.update(format!("{normal:?}"));
                add_law(&mut hash, law)?;
            }
        }
    }
    laws.iter().try_for_each(|law| add_law(&mut hash, law))?;
    Ok(hexadecimal(hash))
}

fn add_law(hash: &mut Sha256, law: &PluginLaw) -> io::Result<()> {
    let path = law.library.path();
    let library = input::hash(path, Input::Library)
        .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", path.display())))?;
    hash.update(library);
    hash.update(format!(
        "{:?}",
        (&law.name, &law.cmname, &law.symbol, &law.props, law.nstatv, &law.statev0, &law.stress0, &law.frame)
    ));
    Ok(())
}

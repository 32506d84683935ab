//! Fingerprint of a result: a hash of everything that it depends on, which tells whether it is still that of its case.
//!
//! The fingerprint covers the case with its overrides, the files that it names, the plugins, and this program.

use super::Run;
use pullout_run::input::{self, Input};
use pullout_run::isolation;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

pub struct Fingerprints {
    program: [u8; 32],
}

impl Fingerprints {
    pub fn new() -> Self {
        Self { program: isolation::identity().unwrap_or_default() }
    }

    /// Returns the fingerprint of a run whose plugins are not loaded here.
    pub fn of_isolated(&self, run: &Run, plugin_paths: &[PathBuf]) -> String {
        let need = pullout_case::need(&run.base, &run.overrides, plugin_paths);
        let libraries: Vec<PathBuf> = need.map(|need| need.libraries.into_keys().collect()).unwrap_or_default();
        self.of(run, &libraries)
    }

    /// Returns the fingerprint of a run whose plugins are these.
    pub fn of(&self, run: &Run, libraries: &[PathBuf]) -> String {
        let document = pullout_case::document(&run.base, &run.overrides).unwrap_or_default();
        let mut files = pullout_case::inputs(&run.base, &run.overrides);
        // the document with its overrides is hashed instead
        files.remove(0);
        files.extend_from_slice(libraries);
        files.sort();
        files.dedup();
        let mut digest = Sha256::new();
        digest.update(self.program);
        // the title and the like are in results as well
        digest.update(document.to_string());
        for file in files {
            digest.update(of_file(&file));
        }
        input::hexadecimal(digest)
    }
}

/// Zeros if it cannot be read: the run will say so.
fn of_file(path: &Path) -> [u8; 32] {
    input::hash(path, Input::Mesh).unwrap_or_default()
}

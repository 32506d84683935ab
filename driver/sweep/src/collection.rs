//! The file into which rows are collected: what is the user's is not replaced.
//!
//! The store notes the hash of each table that was written. A file with such a content is the program's, wherever it lies;
//! any other one is refused, or replaced where that is asked for.

use crate::store::Store;
use crate::table::Table;
use pullout_run::input::{self, Input};
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// A file for a table.
#[derive(Debug)]
pub struct Collection<'s> {
    store: &'s Store,
    path: PathBuf,
    write: Write,
}

/// Writes a table in the form that its file has.
type Write = fn(&Table, &File) -> io::Result<()>;

impl<'s> Collection<'s> {
    /// Makes the file of a store's table. `overwrite`: an existing file is replaced.
    ///
    /// # Errors
    /// The suffix is unknown; the file was not written by pullout, or is part of the store.
    pub fn at(store: &'s Store, path: &Path, overwrite: bool) -> io::Result<Self> {
        let refused = |message: &str| {
            Err(io::Error::new(io::ErrorKind::InvalidData, format!("--out {}: {message}", path.display())))
        };
        let write: Write = match path.extension().and_then(|extension| extension.to_str()) {
            Some("csv") => |table, file| table.write_csv(BufWriter::new(file)),
            Some("jsonl") => |table, file| table.write_lines(BufWriter::new(file)),
            #[cfg(feature = "parquet")]
            Some("parquet") => crate::export::write,
            #[cfg(not(feature = "parquet"))]
            Some("parquet") => {
                return refused(&pullout_report::lacks("a table in Parquet needs", "parquet").to_string());
            }
            _ => return refused("a table is a .csv, a .jsonl or a .parquet"),
        };
        if store.has_inside(path) {
            return refused("lies among the files of the sweep itself: choose another --out");
        }
        if path.parent().is_some_and(|folder| !folder.as_os_str().is_empty() && !folder.is_dir()) {
            return refused("the folder is not there");
        }
        match fs::symlink_metadata(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Ok(entry) if entry.is_dir() => return refused("is a folder"),
            _ if overwrite => {}
            Ok(entry) if entry.is_file() && store.has_collected(&input::hash(path, Input::Mesh)?) => {}
            Ok(_) => {
                return refused(
                    "is no table that was collected of this sweep, or was changed since: choose another --out, or replace \
                     it with --overwrite",
                );
            }
            Err(error) => return Err(io::Error::new(error.kind(), format!("--out {}: {error}", path.display()))),
        }
        Ok(Self { store, path: path.into(), write })
    }

    /// Writes a table: it appears under its name when it is complete.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, table: &Table) -> io::Result<()> {
        crate::table::replace(
            &self.path,
            |file| (self.write)(table, file),
            |written| {
                // one that is too large to be known is replaced only where that is asked for
                input::hash(written, Input::Mesh).map_or(Ok(()), |content| self.store.note_collected(&content))
            },
        )
    }
}

//! Choice of the cases that run in a process of their own.

use super::{system, trust, worker};
use crate::input::folder_of;
use crate::sources;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use umat_abi::host::{self, Found};

/// Longest time of one call unless the case says otherwise, s.
pub const CALL_TIME_LIMIT: f64 = 60.0;

/// Reason why a process of its own is needed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Need {
    /// Whether it is a specimen, whose messages name elements.
    pub specimen: bool,
    /// Longest time of one call of each library, by its absolute path, s.
    pub libraries: BTreeMap<PathBuf, f64>,
    /// Whether the case asks for in-process execution that the command line does not allow.
    pub is_against_a_wish: bool,
}

impl Need {
    /// Returns the need of a library alone.
    pub fn of_library(library: &Path, time_limit: f64) -> Option<Self> {
        let need = || Self { libraries: [(absolute(library), time_limit)].into(), ..Self::default() };
        (!trust::may_run_here(library)).then(need)
    }

    /// Takes in the library that a material names, if it is there, with its longest time of one call: of several the
    /// longest. Returns its absolute path.
    pub fn watch(&mut self, material: &Value, folder: &Path, plugin_paths: &[PathBuf]) -> Option<PathBuf> {
        let library = locate(material["plugin"].as_str()?, folder, plugin_paths)?;
        let limit = material["call_time_limit_s"].as_f64().filter(|limit| *limit > 0.0).unwrap_or(CALL_TIME_LIMIT);
        let longest = self.libraries.entry(library.clone()).or_insert(limit);
        *longest = longest.max(limit);
        Some(library)
    }

    /// The longest time of one call of a library, s.
    pub fn time_limit(&self, library: &Path) -> f64 {
        self.libraries.get(library).copied().unwrap_or(CALL_TIME_LIMIT)
    }

    /// The longest time that anything may take, s: without libraries nothing is limited.
    pub(crate) fn longest_time(&self) -> f64 {
        self.libraries.values().copied().reduce(f64::max).unwrap_or(f64::INFINITY)
    }
}

/// Returns the need of a process of its own for a case that stands in the file `file`; `None` if it has none.
///
/// No library is loaded: its initialisers may do what its routines do.
pub fn need(document: &Value, file: &Path, plugin_paths: &[PathBuf]) -> Option<Need> {
    if worker::is_this_process() || !system::IS_SUPPORTED {
        return None;
    }
    let mut need = Need { specimen: document["kind"] == "pullout", ..Need::default() };
    let mut is_needed = false;
    for material in materials(document) {
        let Some(path) = need.watch(material, folder_of(file), plugin_paths) else { continue };
        // what a symbol is nobody has looked at but the case's author
        let may_run_here = trust::is_let_in(&path) || (material["symbol"].is_null() && trust::is_shipped(&path));
        need.is_against_a_wish |= !may_run_here && material["isolate"] == false;
        is_needed |= !may_run_here || material["isolate"] == true;
    }
    is_needed.then_some(need)
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// Returns everything in a case that names a plugin.
pub fn materials(case: &Value) -> Vec<&Value> {
    let parts = case["parts"].as_object().into_iter().flat_map(|parts| parts.values()).map(|part| &part["material"]);
    let contact = &case["contact"];
    let pairs = contact.as_array().into_iter().flatten().map(|pair| &pair["law"]);
    [&case["material"], &contact["law"]]
        .into_iter()
        .chain(parts)
        .chain(pairs)
        .filter(|value| value.is_object())
        .collect()
}

/// Returns the file that a case in a folder names: a library or a source, which may not be there, or the library of a law that is found.
pub fn named_file(plugin: &str, folder: &Path, plugin_paths: &[PathBuf]) -> Option<PathBuf> {
    if host::names_a_file(plugin) {
        return Some(host::library_path(folder, plugin));
    }
    Found::by_name(plugin, &host::search_paths(plugin_paths)).map(|found| found.path)
}

/// Returns the absolute path of a library that a case in a folder names, if it is there.
pub fn locate(plugin: &str, folder: &Path, plugin_paths: &[PathBuf]) -> Option<PathBuf> {
    let file = named_file(plugin, folder, plugin_paths).filter(|path| path.is_file())?;
    // what cannot be built is reported where the case is read
    sources::library_of(file).ok().map(|path| absolute(&path))
}

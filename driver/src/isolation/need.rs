//! Which cases run in a process of their own.

use crate::case;
use crate::input::{self, Input, folder_of};
use memchr::memmem;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use umat_abi::host::{self, Found};
use umat_abi::metadata::PLUGIN_SYMBOL;

/// Longest time of one call unless the case says otherwise, s.
pub const CALL_TIME_LIMIT: f64 = 60.0;

/// Why a case is isolated, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Need {
    /// Whether it is a specimen, whose messages name elements.
    pub specimen: bool,
    /// The libraries by their absolute paths.
    pub libraries: BTreeMap<PathBuf, Terms>,
}

/// The terms on which a library is called.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// Longest time of one call, s.
    pub time_limit: f64,
    /// It is isolated because the case says so: its metadata vouch for it.
    pub asked_for: bool,
}

impl Default for Terms {
    fn default() -> Self {
        Self { time_limit: CALL_TIME_LIMIT, asked_for: false }
    }
}

impl Need {
    /// The terms of a library.
    pub fn terms(&self, library: &Path) -> Terms {
        self.libraries.get(library).copied().unwrap_or_default()
    }

    /// The longest time that anything may take, s.
    pub fn longest_time(&self) -> f64 {
        self.libraries.values().map(|terms| terms.time_limit).fold(0.0, f64::max)
    }
}

/// Whether a case needs a process of its own. A case that cannot be read does not: reading it again tells what is wrong.
///
/// Nothing is loaded: a library's initialisers may do what its routines do.
pub fn need(file: &Path, overrides: &[String], plugin_paths: &[PathBuf]) -> Option<Need> {
    if !super::system::IS_SUPPORTED {
        return None;
    }
    let document = case::document(file, overrides)?;
    let folder = folder_of(file);
    let mut need = Need { specimen: document["kind"] == "pullout", ..Need::default() };
    let mut is_needed = false;
    for material in materials(&document) {
        let Some(path) = material["plugin"].as_str().and_then(|plugin| locate(plugin, folder, plugin_paths)) else {
            continue;
        };
        let has_laws = describes_laws(&path);
        is_needed |= material["isolate"].as_bool().unwrap_or(!has_laws);
        let path = std::path::absolute(&path).unwrap_or(path);
        let limit = material["call_time_limit_s"].as_f64().filter(|limit| *limit > 0.0).unwrap_or(CALL_TIME_LIMIT);
        let terms = need.libraries.entry(path).or_insert(Terms { time_limit: 0.0, asked_for: false });
        terms.time_limit = terms.time_limit.max(limit);
        terms.asked_for |= has_laws && material["isolate"] == true;
    }
    is_needed.then_some(need)
}

/// Why a command that loads a library needs a process of its own, if it does: it has no metadata, or `case`, which the
/// command reads, needs one. A case may vouch for its library.
pub fn need_of_library(
    library: &Path,
    case: Option<&Path>,
    overrides: &[String],
    plugin_paths: &[PathBuf],
) -> Option<Need> {
    if !super::system::IS_SUPPORTED {
        return None;
    }
    let document = case.and_then(|case| case::document(case, overrides));
    if document.is_some_and(|document| document["material"]["isolate"] == false) {
        return None;
    }
    let of_library = || {
        let path = std::path::absolute(library).unwrap_or_else(|_| library.to_owned());
        (!describes_laws(&path)).then(|| Need { libraries: [(path, Terms::default())].into(), ..Need::default() })
    };
    case.and_then(|case| need(case, overrides, plugin_paths)).or_else(of_library)
}

/// Everything in a case that names a plugin.
fn materials(case: &Value) -> Vec<&Value> {
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

fn locate(plugin: &str, folder: &Path, plugin_paths: &[PathBuf]) -> Option<PathBuf> {
    if host::names_a_file(plugin) {
        Some(host::library_path(folder, plugin)).filter(|path| path.is_file())
    } else {
        Found::by_name(plugin, &host::search_paths(plugin_paths)).map(|found| found.path)
    }
}

/// Whether a library's file mentions our metadata, found without loading it.
pub fn describes_laws(path: &Path) -> bool {
    input::read(path, Input::Library).is_ok_and(|content| memmem::find(&content, PLUGIN_SYMBOL.as_bytes()).is_some())
}

//! Symbols that a library defines, and those that it lacks.

use object::{Object, ObjectSymbol};
use pullout_run::input::{self, Input};
use std::collections::BTreeSet;
use std::io;
use std::path::Path;
use umat_abi::host::{Routine, library_file_name, library_name};

/// Routines that this program calls, by their plain names.
const ROUTINES: [&str; 8] = ["umat", "uinter", "fric", "uexternaldb", "sdvini", "sigini", "hetval", "umatht"];
/// Symbols that are laws.
const LAWS: usize = 3;

/// The dynamic symbols that a library defines.
pub(super) struct Symbols(BTreeSet<String>);

impl Symbols {
    /// Reads them without loading the library.
    pub(super) fn read(library: &Path) -> io::Result<Self> {
        let content = input::read(library, Input::Library)?;
        let file = object::File::parse(&*content).map_err(io::Error::other)?;
        let defined = file.dynamic_symbols().filter(|symbol| symbol.is_definition());
        Ok(Self(defined.filter_map(|symbol| symbol.name().ok().map(str::to_owned)).collect()))
    }

    /// Returns whether it is among them.
    pub(super) fn defines(&self, symbol: &str) -> bool {
        self.0.contains(symbol)
    }

    fn spelling_of(&self, routine: &str) -> Option<String> {
        let spellings = [format!("{routine}_"), routine.to_owned(), routine.to_ascii_uppercase()];
        spellings.into_iter().find(|spelling| self.0.contains(spelling))
    }

    /// The symbols that this program calls.
    pub(super) fn entry_points(&self) -> Vec<String> {
        ROUTINES.iter().filter_map(|routine| self.spelling_of(routine)).collect()
    }

    /// Routines of ABAQUS that this program does not call, by their names in capitals.
    pub(super) fn not_called(&self) -> Vec<String> {
        let left_out = Routine::ALL.iter().filter(|routine| !routine.is_called);
        left_out.filter(|routine| self.spelling_of(routine.symbol).is_some()).map(Routine::name).collect()
    }

    /// All routines that Fortran can call, by their names in capitals.
    pub(super) fn routines(&self) -> Vec<String> {
        self.0.iter().filter_map(|symbol| symbol.strip_suffix('_')).map(str::to_ascii_uppercase).collect()
    }

    /// Returns whether the loader finds a UMAT, UINTER or FRIC, or a routine of the library's own name.
    pub(super) fn has_law(&self, library: &Path) -> bool {
        let own = format!("{}_", library_name(library));
        self.0.contains(&own) || ROUTINES[..LAWS].iter().any(|routine| self.spelling_of(routine).is_some())
    }

    /// Returns why a law that its author sees in the source is not found.
    pub(super) fn hint(&self) -> String {
        if let [routine, ..] = &*self.not_called() {
            return format!("; it has {routine}, which this program does not call");
        }
        let ours = |name: &&String| {
            let lower = name.to_ascii_lowercase();
            ROUTINES[..LAWS].iter().any(|routine| lower.contains(routine))
        };
        let Some(near) = self.0.iter().find(ours) else {
            return "; SUBROUTINE UMAT, or umat_ in C, is what this program calls".into();
        };
        if near.contains("_MOD_") {
            return format!("; {near} is a procedure of a MODULE: take it out of the module");
        }
        if near.starts_with("_Z") {
            return format!("; {near} is a C++ function: declare it extern \"C\"");
        }
        let name = near.trim_end_matches('_');
        format!("; its {near} is found in a library of that name: -o {}", library_file_name(name))
    }
}

/// Returns the names that a linker reports as "undefined reference to `NAME'".
pub(super) fn undefined(words: &str) -> Vec<String> {
    const MARK: &str = "undefined reference to `";
    let names = words.split(MARK).skip(1).filter_map(|rest| rest.split('\'').next());
    names.map(str::to_owned).collect::<BTreeSet<_>>().into_iter().collect()
}

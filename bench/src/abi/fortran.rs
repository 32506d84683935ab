//! Laws written by hand in Fortran, as a UMAT for three dimensions is usually written.

use crate::BenchError;
use pullout_check::build::{BuildRequest, Refusal, build};
use std::path::{Path, PathBuf};

/// A law in Fortran.
struct Twin {
    law: &'static str,
    source: &'static str,
}

const TWINS: &[Twin] = &[
    Twin { law: "linear_elastic", source: include_str!("fortran/linear_elastic.f90") },
    Twin { law: "pure_damage", source: include_str!("fortran/pure_damage.f90") },
    Twin { law: "concrete_damage", source: include_str!("fortran/concrete_damage.f90") },
    Twin { law: "j2_plasticity", source: include_str!("fortran/j2_plasticity.f90") },
];

/// Files that several of them include.
const INCLUDED: [(&str, &str); 2] = [
    ("arguments.inc", include_str!("fortran/arguments.inc")),
    ("damage_function.inc", include_str!("fortran/damage_function.inc")),
];

/// Processors for which it is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Any, as the plugins are.
    Portable,
    /// This one: fused operations, wide registers.
    Native,
}

/// The library of a law's twin in a folder.
#[derive(Clone, Debug)]
pub(crate) enum Library {
    /// Built.
    Built(PathBuf),
    /// gfortran is not installed.
    NotInstalled,
    /// There is no twin of this law.
    None,
}

/// Compiles a law's twin with `-O3`.
///
/// # Errors
/// gfortran is there and refuses.
pub fn library(law: &str, target: Target, folder: &Path) -> Result<Library, BenchError> {
    let Some(twin) = TWINS.iter().find(|twin| twin.law == law) else { return Ok(Library::None) };
    for (name, text) in INCLUDED {
        std::fs::write(folder.join(name), text)?;
    }
    let source = folder.join(format!("{law}.f90"));
    std::fs::write(&source, twin.source)?;
    let (suffix, extra) = match target {
        Target::Portable => ("portable", None),
        Target::Native => ("native", Some("-march=native")),
    };
    let output = folder.join(format!("lib{law}_{suffix}.so"));
    let flags = ["-O3"].into_iter().chain(extra).map(str::to_owned).collect();
    match build(&BuildRequest { sources: vec![source], output: Some(output.clone()), form: None, flags, debug: false })
    {
        Ok(_) => Ok(Library::Built(output)),
        Err(Refusal::NoCompiler { .. }) => Ok(Library::NotInstalled),
        Err(refusal) => Err(BenchError::Failed(refusal.to_string())),
    }
}

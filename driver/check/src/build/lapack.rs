//! LAPACK and BLAS, which ABAQUS brings along and a source may call without a word.

use std::process::{Command, Stdio};

/// Flags that link them.
pub(super) const FLAGS: [&str; 2] = ["-llapack", "-lblas"];
/// Advice where they are not installed.
pub(super) const ADVICE: &str = "--flag=-llapack --flag=-lblas (on Debian: apt install liblapack-dev), or MKL's flags";

/// Names of routines without the letter for the type of numbers.
const ROUTINES: [&str; 70] = [
    "asum", "axpy", "copy", "dot", "dotc", "dotu", "gbsv", "gebal", "gecon", "geequ", "gees", "geesx", "geev", "geevx",
    "gehrd", "gelqf", "gels", "gelsd", "gelss", "gelsy", "gemm", "gemv", "geqp3", "geqrf", "ger", "gesdd", "gesv",
    "gesvd", "gesvx", "getrf", "getri", "getrs", "ggev", "ggevx", "gtsv", "heev", "heevd", "hseqr", "lacpy", "lamch",
    "lange", "lansy", "laset", "laswp", "nrm2", "orgqr", "ormqr", "posv", "potrf", "potri", "potrs", "ppsv", "rot",
    "scal", "swap", "syev", "syevd", "syevr", "syevx", "sygv", "symm", "symv", "syr", "syrk", "sysv", "sytrf", "sytrs",
    "trmm", "trsm", "trtrs",
];

/// Returns whether a symbol is one of theirs, as gfortran spells it.
pub(super) fn has(symbol: &str) -> bool {
    let name = symbol.strip_suffix('_').unwrap_or(symbol);
    let stem = name.strip_prefix(['s', 'd', 'c', 'z']).unwrap_or_default();
    ROUTINES.contains(&stem) || ["idamax", "isamax", "ilaenv"].contains(&name)
}

/// Returns whether a compiler can link them.
pub(super) fn is_installed(linker: &str) -> bool {
    let mut command = Command::new(linker);
    command.args(["-shared", "-o", "/dev/null"]).args(FLAGS).args(["-x", "c", "/dev/null"]);
    command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
}

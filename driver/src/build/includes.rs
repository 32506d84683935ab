//! The files that sources of ABAQUS user subroutines include.

use super::source::Source;
use std::collections::BTreeSet;
use std::io;
use std::path::Path;

/// Double precision, as ABAQUS/Standard has it; good in both forms of source.
const ABA_PARAM: &str = "      implicit real*8 (a-h,o-z)\n      parameter (nprecd=2)\n";
/// Its name, in whatever letters.
const ABA_PARAM_NAME: &str = "ABA_PARAM.INC";
/// What C and C++ sources include: the Fortran compiler's spelling of a routine.
const OMI_FOR_C: &str = "\
#ifndef OMI_FOR_C_H
#define OMI_FOR_C_H
#define FOR_NAME(name, NAME) name##_
#endif
";
/// The prototypes of the entry points.
const HEADER: &str = include_str!("../../../umat-abi/include/pullout_umat.h");

/// Writes them into a folder of the compilers' search path.
pub(super) fn write(folder: &Path, sources: &[Source]) -> io::Result<()> {
    for name in spellings(sources) {
        std::fs::write(folder.join(name), ABA_PARAM)?;
    }
    std::fs::write(folder.join("omi_for_c.h"), OMI_FOR_C)?;
    std::fs::write(folder.join("pullout_umat.h"), HEADER)
}

/// ABA_PARAM.INC in the letters of the sources: they come from systems whose file names have no case.
fn spellings(sources: &[Source]) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for source in sources {
        let upper = source.text.to_ascii_uppercase();
        for (place, found) in upper.match_indices(ABA_PARAM_NAME) {
            names.extend(source.text.get(place..place + found.len()).map(str::to_owned));
        }
    }
    names
}

//! The files that sources of ABAQUS user subroutines include: what these interfaces are, in our words.

use super::scan::Scan;
use std::io;
use std::path::Path;

/// Double precision, as ABAQUS/Standard has it; good in both forms of source, as all of these.
const ABA_PARAM: &str = "      implicit real*8 (a-h,o-z)\n      parameter (nprecd=2)\n";
/// Text of `vaba_param.inc`: double precision, as in ABAQUS/Explicit.
const VABA_PARAM: &str = "      implicit real*8 (a-h,o-z)
      parameter (j_sys_Dimension=2, n_vec_Length=136, maxblk=n_vec_Length)
";
/// The statements of it that remain valid after IMPLICIT NONE.
const ABA_PARAM_TYPED: &str = "      integer nprecd\n      parameter (nprecd=2)";
/// Types of the utility functions, which implicit typing would get wrong.
const HEADER: &str = include_str!("../../../../umat-abi/utilities/include/SMAAspUserSubroutines.hdr");
/// Header of the utility routines for C and C++.
const C_HEADER: &str = include_str!("../../../../umat-abi/utilities/include/SMAAspUserSubroutines.h");
/// Header that C and C++ sources include: the Fortran compiler's spelling of a routine.
const FOR_C: &str = "\
#ifndef PULLOUT_FOR_C_H
#define PULLOUT_FOR_C_H
#define FOR_NAME(name, NAME) name##_
#endif
";
/// The prototypes of the entry points.
const ENTRY_POINTS: &str = include_str!("../../../../umat-abi/include/pullout_umat.h");

/// Fortran's, by their names in small letters; each declares the same if several are included.
const OURS: [(&str, &str); 5] = [
    ("aba_param.inc", ABA_PARAM),
    ("vaba_param.inc", VABA_PARAM),
    ("smaaspusersubroutines.hdr", HEADER),
    ("smaaspuserutilities.hdr", ""),
    ("smaaspuserarrays.hdr", HEADER),
];
/// Include files for C sources.
const FOR_C_SOURCES: [(&str, &str); 6] = [
    ("omi_for_c.h", FOR_C),
    ("aba_for_c.h", FOR_C),
    ("SMAAspUserSubroutines.h", C_HEADER),
    ("SMAAspUserUtilities.h", C_HEADER),
    ("SMAAspUserArrays.h", C_HEADER),
    ("pullout_umat.h", ENTRY_POINTS),
];

fn text_of(name: &str) -> Option<&'static str> {
    OURS.iter().find(|(known, _)| name.eq_ignore_ascii_case(known)).map(|(_, text)| *text)
}

/// Returns whether a Fortran source that includes a file of this name gets ours.
pub(super) fn is_ours(name: &str) -> bool {
    text_of(name).is_some()
}

/// Returns the text that replaces one of our include files in a program unit that begins with IMPLICIT NONE. The file's own
/// IMPLICIT statement would contradict it.
pub(super) fn without_typing(name: &str) -> Option<&'static str> {
    name.eq_ignore_ascii_case("aba_param.inc").then_some(ABA_PARAM_TYPED)
}

/// Writes them into a folder of the compilers' search path, in the letters of the sources: these come from systems
/// whose file names have no case.
pub(super) fn write(folder: &Path, scans: &[Scan]) -> io::Result<()> {
    for name in scans.iter().flat_map(|scan| &scan.ours) {
        std::fs::write(folder.join(name), text_of(name).unwrap_or_default())?;
    }
    for (name, text) in FOR_C_SOURCES {
        std::fs::write(folder.join(name), text)?;
    }
    Ok(())
}

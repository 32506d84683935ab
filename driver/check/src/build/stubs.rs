//! Utility routines of ABAQUS that this program does not offer: a source that has a call of one may never reach it.

use std::fmt::Write;

/// Names in small letters, with those of MPI, which its programs load.
const KNOWN: [&str; 57] = [
    "dbfile",
    "dbfilw",
    "getelementconn",
    "geteventseriesslicelg",
    "geteventseriessliceproperties",
    "getinternal",
    "getnodetoelemconn",
    "getpartinfoc",
    "getsensorid",
    "getsensorvalue",
    "getvrmavgatnode",
    "getvrn",
    "getwave",
    "getwavevel",
    "getwindvel",
    "ivgetsensorid",
    "material_lib_mech",
    "material_lib_therm",
    "mpi_allgather",
    "mpi_allreduce",
    "mpi_barrier",
    "mpi_bcast",
    "mpi_comm_rank",
    "mpi_comm_size",
    "mpi_gather",
    "mpi_initialized",
    "mpi_recv",
    "mpi_reduce",
    "mpi_send",
    "posfil",
    "ptkcompute",
    "ptkgetdataaccess",
    "ptkgetnumintersectedelements",
    "ptkseteventseriesproperties",
    "ptksetmeshandeventseries",
    "smalocalstructarrayaccess",
    "smalocalstructarraycreate",
    "smalocalstructarraydelete",
    "smalocalstructarraysize",
    "smastructarrayaccess",
    "smastructarraycreate",
    "smastructarraydelete",
    "smastructarraysize",
    "vgetinternal",
    "vgetjobname",
    "vgetnumcpus",
    "vgetoutdir",
    "vgetpartinfo",
    "vgetpropertytable",
    "vgetrank",
    "vgetsensorvalue",
    "vgetvrm",
    "vgetvrn",
    "vsprinc",
    "vsprind",
    "xplb_abqerr",
    "xplb_exit",
];

/// Returns whether a symbol is a utility routine of ABAQUS.
pub(super) fn is_utility(symbol: &str) -> bool {
    KNOWN.contains(&symbol.trim_end_matches('_').to_ascii_lowercase().as_str())
}

/// A routine's name as it is documented: in capitals.
pub(super) fn name(symbol: &str) -> String {
    symbol.trim_end_matches('_').to_ascii_uppercase()
}

/// A C source that defines symbols: each ends the run and says by what.
pub(super) fn source(symbols: &[String]) -> String {
    let mut text = String::from("#include <stdio.h>\n#include <stdlib.h>\n");
    for symbol in symbols {
        let _ = writeln!(
            text,
            "void {symbol}(void)\n{{\n  fputs(\"***ERROR: the plugin called {}, a utility routine of ABAQUS that this \
             program does not offer\\n\", stderr);\n  exit(1);\n}}",
            name(symbol)
        );
    }
    text
}

//! The utility routines of ABAQUS/Standard that user subroutines call, under the names that gfortran gives them.
//!
//! | routine | what it does here |
//! |---|---|
//! | `SINV`, `SPRINC`, `SPRIND`, `ROTSIG` | invariants, principal values and directions, rotation |
//! | `XIT`, `STDB_ABQERR` | end the program; print a note, a warning or an error |
//! | `GETJOBNAME`, `GETOUTDIR`, `GETRANK`, `GETNUMCPUS` | the run: the case's name and folder, rank 0 of 1 |
//! | `GETPARTINFO`, `GETVRM` | the model has no part instances; no output variables can be asked for |
//! | `SMAIntArrayCreate` and its kin | arrays found again by their number, of the process or of a thread |
//! | `GETNUMTHREADS`, `get_thread_id`, `GETCOMMUNICATOR` | threads by number from 0; no communicator |
//! | `setTableCollection`, `getPropertyTable`, `getParameterTable`, … | there are no tables: JERROR = 1 |
//! | `MutexInit`, `MutexLock`, `MutexUnlock` | 100 locks, numbered from 1 |
//!
//! The host loads this library with RTLD_GLOBAL before the first plugin. It exports these names, and
//! `pullout_utilities_job_v1`, by which the host passes job name and folder, and nothing else: it is in the way of no
//! symbol of a plugin.
//!
//! Fortran passes everything by reference, and after all arguments the lengths of the CHARACTER ones by value. Every
//! routine relies on its arguments being as the manual says; that is the reason for each `unsafe` block here.

mod arrays;
mod character;
mod job;
mod locks;
mod messages;
mod tables;
mod tensor;
mod threads;

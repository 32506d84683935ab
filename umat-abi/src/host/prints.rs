//! Output that plugins print: Fortran's unit 7, and lines that their runtimes still hold in buffers.
//!
//! Unit 6, `WRITE(*,…)` and C's `printf` write to the standard output, which the host can redirect. Unit 7, the message
//! file of ABAQUS, is not a stream of the operating system: gfortran writes it to a file `fort.7` in the current
//! folder, unless the unit was connected to another file before. Only gfortran's own runtime can connect it.

use super::library::each_loaded;
use std::ffi::c_void;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Runtime function to which OPEN compiles: it takes its parameters in one block.
type OpenFunction = unsafe extern "C" fn(*mut OpenParameters);
/// FLUSH of one unit, or of all if the pointer is NULL.
type FlushFunction = unsafe extern "C" fn(*const i32);

const OPEN: &str = "_gfortran_st_open";
const FLUSH: &str = "_gfortran_flush_i4";
/// A symbol of GCC 9 and later: with it, lengths in [`OpenParameters`] have 64 bits. (Since GCC 8, which is taken for older.)
const PRESENT_RUNTIME: &str = "_gfortran_st_wait_async";

/// ABAQUS's message file.
const MESSAGE_UNIT: i32 = 7;

/// `st_parameter_open` of libgfortran 5, as the compiler lays it out, with spare room at its end.
#[repr(C)]
struct OpenParameters {
    flags: i32,
    unit: i32,
    _source_file_and_line: [usize; 2],
    _message: [usize; 2],
    iostat: *mut i32,
    _record_length: usize,
    file_length: usize,
    file: *const u8,
    status: *const u8,
    status_length: usize,
    _access_form_blank: [usize; 6],
    position: *const u8,
    position_length: usize,
    _others: [usize; 64],
}

/// Flags of the parameters that are present.
mod given {
    pub(super) const IOSTAT: i32 = 1 << 5;
    pub(super) const FILE: i32 = 1 << 8;
    pub(super) const STATUS: i32 = 1 << 9;
    pub(super) const POSITION: i32 = 1 << 13;
}

/// File of unit 7.
static MESSAGES: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Connects unit 7 of all libraries, loaded now or later, with a file; output is appended. Runtimes other than
/// gfortran's are left alone.
pub fn write_messages_to(file: &Path) {
    *MESSAGES.lock().unwrap_or_else(PoisonError::into_inner) = Some(file.to_owned());
    each_loaded(|library| connect(&library, file));
}

/// Connects unit 7 of a library that was just loaded, if there is a file for it.
pub(super) fn note_loaded(library: &libloading::Library) {
    if let Some(file) = &*MESSAGES.lock().unwrap_or_else(PoisonError::into_inner) {
        connect(library, file);
    }
}

/// Flushes the output that the runtimes of C and gfortran hold in buffers.
pub fn flush_prints() {
    each_loaded(|library| {
        // SAFETY: a function of gfortran's runtime; NULL means all units.
        unsafe {
            if let Ok(flush) = library.get::<FlushFunction>(FLUSH) {
                flush(std::ptr::null());
            }
        }
    });
    // SAFETY: NULL means all streams.
    unsafe { libc::fflush(std::ptr::null_mut()) };
}

/// Sets C's standard output to line buffering, so that nothing is lost where a plugin ends the process. To be called
/// before anything is printed.
pub fn print_by_lines() {
    unsafe extern "C" {
        static stdout: *mut libc::FILE;
    }
    // SAFETY: C's own stream, which lives as long as the process; NULL: its own buffer.
    unsafe { libc::setvbuf(stdout, std::ptr::null_mut(), libc::_IOLBF, 0) };
}

/// OPEN(7, FILE=file, STATUS='UNKNOWN', POSITION='APPEND', IOSTAT=ios) by a library's own runtime.
fn connect(library: &libloading::Library, file: &Path) {
    // SAFETY: only its presence is asked for.
    if unsafe { library.get::<*const c_void>(PRESENT_RUNTIME) }.is_err() {
        return;
    }
    let (name, status, position) = (file.as_os_str().as_bytes(), b"UNKNOWN", b"APPEND");
    let mut iostat = 0;
    let mut parameters = OpenParameters {
        flags: given::IOSTAT | given::FILE | given::STATUS | given::POSITION,
        unit: MESSAGE_UNIT,
        _source_file_and_line: [0; 2],
        _message: [0; 2],
        iostat: &raw mut iostat,
        _record_length: 0,
        file_length: name.len(),
        file: name.as_ptr(),
        status: status.as_ptr(),
        status_length: status.len(),
        _access_form_blank: [0; 6],
        position: position.as_ptr(),
        position_length: position.len(),
        _others: [0; 64],
    };
    // SAFETY: the function is that of libgfortran 5, whose block of parameters has this layout in every version so far; it
    // is as large as theirs or larger, and what it points to outlives the call. A failure is reported in `iostat`
    // and leaves the unit as it was.
    unsafe {
        if let Ok(open) = library.get::<OpenFunction>(OPEN) {
            open(&raw mut parameters);
        }
    }
}

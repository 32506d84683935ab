//! Enquiries of a routine about the run: GETJOBNAME, GETOUTDIR, GETRANK, GETNUMCPUS, GETPARTINFO, GETVRM.

use crate::character::{assign, trimmed};
use crate::messages::{forget_issued, say};
use std::sync::{PoisonError, RwLock};

/// CHARACTER*256 OUTDIR, JOBNAME.
const NAME_LENGTH: usize = 256;
/// CHARACTER*80 CPNAME.
const PART_NAME_LENGTH: usize = 80;
/// ARRAY(15), JARRAY(15), FLGRAY(15) of GETVRM.
const COMPONENTS: usize = 15;
/// CHARACTER*3 FLGRAY.
const FLAG_LENGTH: usize = 3;

/// Name and folder.
static JOB: RwLock<Option<(String, String)>> = RwLock::new(None);

/// Sets the job's name and folder; called by this library's host.
#[unsafe(no_mangle)]
unsafe extern "C" fn pullout_utilities_job_v1(
    name: *const u8,
    name_length: usize,
    folder: *const u8,
    folder_length: usize,
) {
    // SAFETY: the host passes two texts with their lengths.
    let job = unsafe { (trimmed(name, name_length), trimmed(folder, folder_length)) };
    forget_issued();
    *JOB.write().unwrap_or_else(PoisonError::into_inner) = Some(job);
}

/// Hands a text out with its length, that of the variable if it does not fit.
///
/// # Safety
/// As described in the routines' manual.
unsafe fn answer(text: &str, variable: *mut u8, length: *mut i32, room: usize) {
    // A caller in C may leave the hidden length out; the manual's is the greatest.
    let room = if room == 0 { NAME_LENGTH } else { room.min(NAME_LENGTH) };
    // SAFETY: said above.
    unsafe {
        assign(variable, room, text);
        *length = i32::try_from(text.len().min(room)).unwrap_or(i32::MAX);
    }
}

fn job() -> Option<(String, String)> {
    JOB.read().unwrap_or_else(PoisonError::into_inner).clone()
}

/// GETJOBNAME(JOBNAME,LENJOBNAME): the job's name and its length.
#[unsafe(no_mangle)]
unsafe extern "C" fn getjobname_(jobname: *mut u8, lenjobname: *mut i32, room: usize) {
    let name = job().map_or_else(|| "pullout".to_owned(), |(name, _)| name);
    // SAFETY: the arguments are as the manual says.
    unsafe { answer(&name, jobname, lenjobname, room) }
}

/// GETOUTDIR(OUTDIR,LENOUTDIR): the folder of the job, which is that of its case, and the length of its name.
#[unsafe(no_mangle)]
unsafe extern "C" fn getoutdir_(outdir: *mut u8, lenoutdir: *mut i32, room: usize) {
    let here = || std::env::current_dir().map_or_else(|_| ".".to_owned(), |folder| folder.display().to_string());
    let folder = job().map_or_else(here, |(_, folder)| folder);
    if folder.len() > NAME_LENGTH {
        say("***WARNING: GETOUTDIR: the folder's name is longer than 256 characters and was cut off");
    }
    // SAFETY: the arguments are as the manual says.
    unsafe { answer(&folder, outdir, lenoutdir, room) }
}

/// GETRANK(KPROCESSNUM): the number of this process, from 0.
#[unsafe(no_mangle)]
unsafe extern "C" fn getrank_(kprocessnum: *mut i32) {
    // SAFETY: the argument is as the manual says.
    unsafe { *kprocessnum = 0 }
}

/// GETNUMCPUS(NUMPROCESSES): the number of processes.
#[unsafe(no_mangle)]
unsafe extern "C" fn getnumcpus_(numprocesses: *mut i32) {
    // SAFETY: the argument is as the manual says.
    unsafe { *numprocesses = 1 }
}

/// GETCOMMUNICATOR(): none in a run of one process.
#[unsafe(no_mangle)]
extern "C" fn getcommunicator_() -> i32 {
    0
}

/// GETPARTINFO(INTNUM,JTYP,CPNAME,LOCNUM,JRCD): the part instance of a node (JTYP 0) or an element (1), and its number
/// there.
///
/// Our models have no part instances: the name is blank, and the number is the given one. JRCD 1: such a node or
/// element cannot exist.
#[unsafe(no_mangle)]
unsafe extern "C" fn getpartinfo_(
    intnum: *const i32,
    jtyp: *const i32,
    cpname: *mut u8,
    locnum: *mut i32,
    jrcd: *mut i32,
    room: usize,
) {
    let room = if room == 0 { PART_NAME_LENGTH } else { room.min(PART_NAME_LENGTH) };
    // SAFETY: the arguments are as the manual says.
    unsafe {
        let is_known = *intnum >= 1 && matches!(*jtyp, 0 | 1);
        assign(cpname, room, "");
        *locnum = if is_known { *intnum } else { 0 };
        *jrcd = i32::from(!is_known);
    }
}

/// GETVRM(VAR,ARRAY,JARRAY,FLGRAY,JRCD,JMAC,JMATYP,MATLAYO,LACCFLA): output variables of the material point, for
/// UVARM and USDFLD. Neither is called here, and nothing can be asked for: JRCD = 1, zeros, and "N/A".
#[unsafe(no_mangle)]
unsafe extern "C" fn getvrm_(
    _var: *const u8,
    array: *mut f64,
    jarray: *mut i32,
    flgray: *mut u8,
    jrcd: *mut i32,
    _jmac: *const i32,
    _jmatyp: *const i32,
    _matlayo: *const i32,
    _laccfla: *const i32,
    _var_length: usize,
    _flgray_length: usize,
) {
    // SAFETY: the arguments are as the manual says.
    unsafe {
        array.write_bytes(0, COMPONENTS);
        jarray.write_bytes(0, COMPONENTS);
        for k in 0..COMPONENTS {
            assign(flgray.add(k * FLAG_LENGTH), FLAG_LENGTH, "N/A");
        }
        *jrcd = 1;
    }
}

//! STDB_ABQERR and XIT.

use crate::character::trimmed;
use std::io::Write;
use std::sync::atomic::{AtomicU32, Ordering};

/// Exit code of a run that failed.
const FAILED: i32 = 1;
/// Longest STRING.
const LONGEST_STRING: usize = 500;
/// CHARACTER*8 CHARV(*).
const CHARV_LENGTH: usize = 8;

/// Warnings and errors of a job that are shown at once: a law that warns in every call is not to flood the terminal.
const MOST_SHOWN: u32 = 10;
/// Number of warnings and errors that the present job has issued.
static ISSUED: AtomicU32 = AtomicU32::new(0);

/// Resets the count of the last job's messages.
pub(crate) fn forget_issued() {
    ISSUED.store(0, Ordering::Relaxed);
}

/// Prints a line among what the plugin itself prints, which hosts keep.
fn log(line: &str) {
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// Prints a warning or an error with what the plugin prints, and shows the first of them.
fn issue(line: &str) {
    log(line);
    match ISSUED.fetch_add(1, Ordering::Relaxed) {
        before if before < MOST_SHOWN => say(line),
        MOST_SHOWN => {
            say("***NOTE: no more messages of STDB_ABQERR are shown; umat.log in the result directory has all")
        }
        _ => {}
    }
}

/// Prints a line; a closed stderr is no reason to stop.
pub(crate) fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Ends the process by `exit`, so that the Fortran runtime writes out its units.
fn end(reason: &str) -> ! {
    say(reason);
    std::process::exit(FAILED)
}

/// XIT: ends the analysis.
#[unsafe(no_mangle)]
extern "C" fn xit_() {
    end("***ERROR: the plugin ended the analysis (it called XIT)")
}

/// STDB_ABQERR(LOP,STRING,INTV,REALV,CHARV): a note (LOP 1), a warning (−1), an error (−2), or an error that ends the
/// analysis (−3). Each %I, %R and %S in STRING is replaced by the next entry of INTV, REALV and CHARV.
#[unsafe(no_mangle)]
unsafe extern "C" fn stdb_abqerr_(
    lop: *const i32,
    string: *const u8,
    intv: *const i32,
    realv: *const f64,
    charv: *const u8,
    string_length: usize,
    charv_length: usize,
) {
    // SAFETY: the arguments are as the manual says.
    let (lop, string) = unsafe { (*lop, trimmed(string, string_length.min(LONGEST_STRING))) };
    let charv_length = if charv_length == 0 { CHARV_LENGTH } else { charv_length.min(LONGEST_STRING) };
    // SAFETY: STRING asks for as many entries as the arrays have.
    let text = filled_in(&string, |kind, index| unsafe {
        match kind {
            'I' => (*intv.add(index)).to_string(),
            'R' => (*realv.add(index)).to_string(),
            _ => trimmed(charv.add(index * charv_length), charv_length),
        }
    });
    match lop {
        -1 => issue(&format!("***WARNING: {text}")),
        -2 => issue(&format!("***ERROR: {text}")),
        -3 => end(&format!("***ERROR: {text}\n***ERROR: the plugin ended the analysis (STDB_ABQERR with LOP = -3)")),
        _ => log(&format!("***NOTE: {text}")),
    }
}

/// The string with %I, %R and %S replaced by the values of their kinds, in order.
fn filled_in(string: &str, value: impl Fn(char, usize) -> String) -> String {
    const KINDS: [char; 3] = ['I', 'R', 'S'];
    let mut used = [0; KINDS.len()];
    let mut text = String::with_capacity(string.len());
    let mut rest = string;
    while let Some(percent) = rest.find('%') {
        let (before, from) = rest.split_at(percent);
        text.push_str(before);
        let kind = from[1..].chars().next().and_then(|c| KINDS.iter().position(|k| k.eq_ignore_ascii_case(&c)));
        match kind {
            Some(kind) => {
                text.push_str(&value(KINDS[kind], used[kind]));
                used[kind] += 1;
                rest = &from[2..];
            }
            None => {
                text.push('%');
                rest = &from[1..];
            }
        }
    }
    text + rest
}

use super::{Backtraces, explanation};

/// What gfortran's runtime writes, with frames of this program after the plugin's.
const REPORT: &str = "At line 7 of file /w/rt.f90\nFortran runtime error: Attempting to allocate already allocated variable 'a'\n\nError \
                      termination. Backtrace:\n#0  0x7fd1 in ???\n#1  0x7fd2 in umat_\n\tat /w/rt.f90:7\n#2  0x560c in call\n\tat \
                      umat-abi/src/umat.rs:29\n#3  0x560d in ???\n";

#[test]
fn backtraces_are_kept_and_all_else_is_passed_on_as_it_comes() {
    let mut backtraces = Backtraces::default();
    let text = format!("a note\n{REPORT}another\n{REPORT}");
    let mut passed = Vec::new();
    for byte in text.as_bytes() {
        passed.extend(backtraces.pass(std::slice::from_ref(byte)));
    }
    assert_eq!(String::from_utf8(passed).expect("UTF-8"), "a note\nanother\n");
    assert_eq!(String::from_utf8(backtraces.rest()).expect("UTF-8"), format!("{REPORT}{REPORT}"));
    // a line of progress has no end
    assert_eq!(Backtraces::default().pass(b"\r 10 % of all"), b"\r 10 % of all");
    assert_eq!(Backtraces::default().pass(b"At noon"), b"At noon");
    assert_eq!(Backtraces::default().pass(b"At li"), b"");
}

#[test]
fn a_runtime_error_is_reported_with_its_way_and_without_our_frames() {
    assert_eq!(
        explanation(REPORT, true).as_deref(),
        Some("umat, rt.f90:7: Fortran runtime error: Attempting to allocate already allocated variable 'a'")
    );
    let stop = "ERROR STOP no root\n\nError termination. Backtrace:\n#0  0x1 in ???\n#1  0x2 in kroot_\n\tat /w/k.f:3\n#2  0x3 in \
                umat_\n\tat /w/u.f:9\n#3  0x4 in call\n\tat a/b.rs:2\n";
    assert_eq!(explanation(stop, true).as_deref(), Some("kroot, k.f:3, called from umat, u.f:9: ERROR STOP no root"));
}

#[test]
fn what_ended_a_worker_is_found_in_its_last_words() {
    let index = "At line 12 of file /home/a b/u.f\nFortran runtime error: Index '7' of dimension 1 of array 'statev' above \
                 upper bound of 6\n\nError termination. Backtrace:\n#0  0x7f01 in ???\n#1  0x7f02 in kpart_\n\tat \
                 /home/a b/u.f:12\n#2  0x7f03 in umat_\n\tat /home/a b/u.f:40\n";
    let reading = "At line 3 of file u.f (unit = 15, file = 'fort.15')\nFortran runtime error: End of file\n";
    let signal = "***ERROR: earlier\n***SIGNAL: SIGFPE\nkpart_ at u.f:9 (discriminator 2)\numat_ at u.f:30\n";
    for (words, expected) in [
        (
            index,
            "kpart, u.f:12, called from umat, u.f:40: Fortran runtime error: Index '7' of dimension 1 of array 'statev' above upper bound of 6",
        ),
        (reading, "u.f:3: Fortran runtime error: End of file"),
        (signal, "kpart, u.f:9"),
        (
            "***ERROR: a\n***ERROR: the plugin ended the analysis (it called XIT)\n",
            "the plugin ended the analysis (it called XIT)",
        ),
    ] {
        assert_eq!(explanation(words, true).as_deref(), Some(expected));
    }
    for line in [
        "free(): invalid next size (normal)",
        "corrupted size vs. prev_size",
        "*** stack smashing detected ***: terminated",
    ] {
        assert!(
            explanation(&format!("x\n{line}\n"), false).expect("known").contains(line.trim_matches('*').trim()),
            "{line}"
        );
    }
    assert_eq!(explanation("a note\n", true), None);
    assert_eq!(explanation("***ERROR: of no consequence\n", false), None);
}

use super::explanation;

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
            "kpart, u.f:12: Fortran runtime error: Index '7' of dimension 1 of array 'statev' above upper bound of 6",
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

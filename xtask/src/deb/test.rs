use super::needed;

#[test]
fn the_newest_version_of_symbols_counts() {
    assert_eq!(needed(b"\x7fELF\0GLIBC_2.2.5\0GLIBC_2.34\0GLIBC_2.17\0memcpy\0"), [2, 34]);
    assert_eq!(needed(b"#!/bin/sh"), [0, 0]);
}

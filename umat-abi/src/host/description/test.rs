use super::{Table, metadata, printable, read_parameters};
use std::mem::offset_of;

#[test]
fn parameters_of_older_libraries_are_read_without_their_usual_values() {
    let now = [1.0, 2.0].map(|value| metadata::Parameter::new(c"E", c"MPa", value, c"").typically(5.0, 7.0));
    // the same as a library has them whose elements end before
    let size = offset_of!(metadata::Parameter, typical_lower);
    let mut before = [0_u64; 2 * size_of::<metadata::Parameter>() / 8];
    for (k, parameter) in now.iter().enumerate() {
        let to = before.as_mut_ptr().wrapping_byte_add(k * size).cast::<u8>();
        // SAFETY: two elements of `size` bytes fit.
        unsafe { std::ptr::copy_nonoverlapping((&raw const *parameter).cast::<u8>(), to, size) };
    }
    let table = |first: *const metadata::Parameter, stride: usize| {
        let mut table = Table::new(&[]);
        (table.first, table.count, table.stride) = (first, 2, stride as u32);
        // SAFETY: as many elements of this size as the table says.
        unsafe { read_parameters(&table) }
    };
    for (first, stride, typical) in
        [(now.as_ptr(), size_of::<metadata::Parameter>(), Some([5.0, 7.0])), (before.as_ptr().cast(), size, None)]
    {
        let read = table(first, stride).expect("parameters");
        assert!(read.iter().all(|parameter| parameter.name == "E" && parameter.typical == typical), "{read:?}");
        assert_eq!([read[0].default_value, read[1].default_value], [1.0, 2.0]);
    }
    assert!(table(before.as_ptr().cast(), size - 8).is_err());
}

#[test]
fn a_plugins_text_does_not_act_on_a_terminal() {
    assert_eq!(printable("one\r\ntwo τ \u{1b}[2J\u{9b}"), "one  two τ \u{fffd}[2J\u{fffd}");
}

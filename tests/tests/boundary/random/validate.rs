//! The validate functions of the descriptions in `libpullout_laws.so`: each law's.

use super::{Changes, Fenced, apply, changes, factors, number, scale};
use end_to_end_tests::{fuzz, plugin};
use proptest::prelude::*;
use proptest::sample::Index;
use std::sync::LazyLock;
use umat_abi::host::LawDescription;
use umat_abi::metadata::{PLUGIN_SYMBOL, Plugin, validation};

/// The description of each law, and its parameters' defaults.
static LAWS: LazyLock<Vec<(&'static Plugin, Vec<f64>)>> = LazyLock::new(|| {
    let described = end_to_end_tests::open(&plugin("pullout_laws"));
    let defaults = |law: &LawDescription| law.parameters.iter().map(|parameter| parameter.default_value).collect();
    // SAFETY: a plugin of ours: nothing but a panic hook is set when it is loaded.
    let library = unsafe { libloading::Library::new(plugin("pullout_laws")) }.expect("a plugin that Cargo built");
    // SAFETY: the symbol is the function that the contract defines.
    let describe =
        *unsafe { library.get::<unsafe extern "C" fn() -> *const Plugin>(PLUGIN_SYMBOL) }.expect("a description");
    // the descriptions live in it
    std::mem::forget(library);
    // SAFETY: static data of a library that stays loaded.
    let first = unsafe { describe().as_ref() };
    // SAFETY: as above.
    std::iter::successors(first, |law| unsafe { law.next.as_ref() })
        .zip(described.laws().iter().map(defaults))
        .collect()
});

/// Number of bytes before and after a message.
const FENCE: usize = 16;
const SIGN: u8 = 0xA5;

#[derive(Clone, Debug)]
struct Call {
    law: Index,
    factors: Changes,
    props: Changes,
    count: Option<i32>,
    length: f64,
    capacity: usize,
    null: [bool; 2],
}

fn call() -> impl Strategy<Value = Call> {
    let count = prop_oneof![4 => Just(None), 1 => (-3..64).prop_map(Some), 1 => Just(Some(i32::MIN))];
    let null = [prop::bool::weighted(0.1), prop::bool::weighted(0.1)];
    let capacity = prop_oneof![1 => Just(512_usize), 1 => 0_usize..520];
    (any::<Index>(), factors(), changes(), count, number(1e3), capacity, null).prop_map(
        |(law, factors, props, count, length, capacity, null)| Call {
            law,
            factors,
            props,
            count,
            length,
            capacity,
            null,
        },
    )
}

fn check(call: &Call) {
    let (law, defaults) = &LAWS[call.law.index(LAWS.len())];
    let mut values = defaults.clone();
    scale(&call.factors, &mut values);
    apply(&call.props, &mut values);
    let count = call.count.unwrap_or(values.len() as i32);
    values.resize(usize::try_from(count).unwrap_or(0), 1.0);
    let mut props = Fenced::new(&values);
    let before = props.bits();
    let mut bytes = vec![SIGN; call.capacity + 2 * FENCE];
    let pointer = if call.null[0] { std::ptr::null() } else { props.pointer().cast_const() };
    let message = if call.null[1] { std::ptr::null_mut() } else { bytes[FENCE..].as_mut_ptr().cast() };
    // SAFETY: NULL, or valid for the sizes that the counts give.
    let status = unsafe { (law.validate)(pointer, count, call.length, message, call.capacity) };
    assert!([validation::OK, validation::INVALID, validation::NEEDS_LENGTH].contains(&status), "{status}");
    assert!(!(call.null[0] || count < 0) || status == validation::INVALID);
    assert!(props.is_intact() && props.bits() == before);
    let (text, behind) = bytes[FENCE..].split_at(call.capacity);
    let around = bytes[..FENCE].iter().chain(behind);
    assert!(around.copied().all(|byte| byte == SIGN), "written around the message");
    if call.null[1] || call.capacity == 0 {
        assert!(text.iter().all(|byte| *byte == SIGN));
        return;
    }
    let end = text.iter().position(|byte| *byte == 0).expect("a message that ends");
    let words = std::str::from_utf8(&text[..end]).expect("text");
    assert!(!words.contains("internal error"), "{words}");
    assert!(status == validation::OK || call.capacity == 1 || !words.is_empty());
}

proptest! {
    #![proptest_config(fuzz::config(3000))]

    #[test]
    fn any_parameters_do_no_harm(call in call()) {
        check(&call);
    }
}

//! Arguments that no host should pass: NULL anywhere, counts of any size, NaN and infinity, names of any bytes. A call
//! is done with finite numbers, refused, or cut back with everything as it was; what lies around the arrays and what is
//! only read stays as it is.
//!
//! Refused calls look alike whether the arguments or a panic were the reason: where the law's own check accepts the
//! parameters and the counts are right, a refusal is a failure of these tests.
//!
//! The long form: `PROPTEST_CASES=1000000 cargo test -p end-to-end-tests --test boundary random`.

mod batch;
mod contact;
mod fenced;
mod umat;
mod validate;

use end_to_end_tests::fuzz::WILD_NUMBERS;
use fenced::Fenced;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use umat_abi::host::Validation;

/// Content of outputs before a call: no law returns it.
const GARBAGE: f64 = -7.25e77;

/// Cells of an array that are changed (modulo its length), and their new values.
type Changes = Vec<(usize, f64)>;

/// Any number, most of them of the size of strains.
fn number(size: f64) -> impl Strategy<Value = f64> + Clone {
    prop_oneof![
        12 => -size..size,
        2 => Just(0.0),
        2 => select(&WILD_NUMBERS[..]),
        1 => any::<f64>(),
    ]
}

/// A few wild numbers for an array, mostly none.
fn changes() -> impl Strategy<Value = Changes> {
    let some = vec((any::<usize>(), prop_oneof![select(&WILD_NUMBERS[..]), any::<f64>()]), 1..3);
    prop_oneof![4 => Just(Vec::new()), 1 => some]
}

fn apply(changes: &Changes, values: &mut [f64]) {
    let count = values.len();
    for (place, value) in changes.iter().filter(|_| count > 0) {
        values[place % count] = *value;
    }
}

/// Factors on parameters, so that many of them are admissible.
fn factors() -> impl Strategy<Value = Changes> {
    let factor = prop_oneof![3 => 0.5..2.0, 1 => 1e-3..1e3, 1 => select(&[0.0, 1e-12, 1e12][..])];
    prop_oneof![1 => Just(Vec::new()), 1 => vec((any::<usize>(), factor), 1..4)]
}

fn scale(factors: &Changes, values: &mut [f64]) {
    let count = values.len();
    for (place, factor) in factors.iter().filter(|_| count > 0) {
        values[place % count] *= factor;
    }
}

/// A count, mostly the right one.
fn count(right: i32) -> impl Strategy<Value = i32> {
    prop_oneof![
        12 => Just(right),
        2 => -2..9_i32,
        1 => select(&[i32::MIN, -1, 0, 64, 65, 10_000, i32::MAX][..]),
        1 => any::<i32>(),
    ]
}

/// Returns a strategy for the arguments that are NULL, mostly none.
fn nulls() -> impl Strategy<Value = Vec<Index>> {
    prop_oneof![3 => Just(Vec::new()), 2 => vec(any::<Index>(), 1..4)]
}

/// PNEWDT on entry: anything but what a refusal leaves.
fn pnewdt() -> impl Strategy<Value = f64> {
    select(&[1.0, 1e36, -1.0, 0.0, f64::NAN, f64::INFINITY][..])
}

/// Sets one of the pointers among the arguments to NULL, by its place in the argument list. All arguments but the CHARACTER
/// lengths are pointers.
macro_rules! nullify {
    ($arguments:expr, $which:expr, [$($name:ident),+ $(,)?]) => {{
        let mut place = 0;
        $(
            if place == $which {
                $arguments.$name = std::ptr::null::<u8>().cast_mut().cast();
            }
            place += 1;
        )+
        place
    }};
}
use nullify;

/// Possible outcome of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    /// All outputs are written.
    Done,
    /// Everything is as it was; the stress is NaN if there is no PNEWDT by which to report it.
    Untouched,
    /// Stress and tangent are NaN, the rest is as it was.
    Refused,
}

/// An array that a call may write, with what it held.
struct Output {
    name: &'static str,
    memory: Fenced,
    before: Vec<u64>,
    /// Number of cells at its start that are written by a call that is done; all others never are.
    written: usize,
    /// Number of cells at its start that become NaN in a refusal.
    spoilt: usize,
    /// Whether the call was given it.
    given: bool,
}

impl Output {
    fn new(name: &'static str, values: &[f64], written: usize, spoilt: usize) -> Self {
        let memory = Fenced::new(values);
        let before = memory.bits();
        Self { name, memory, before, written, spoilt, given: true }
    }

    fn is_untouched(&self) -> bool {
        self.memory.bits() == self.before
    }

    fn is_spoilt(&self) -> bool {
        let spoilt = if self.given { self.spoilt } else { 0 };
        self.memory.values()[..spoilt].iter().all(|x| x.is_nan())
            && self.memory.bits()[spoilt..] == self.before[spoilt..]
    }

    fn is_written(&self) -> bool {
        let written = if self.given { self.written } else { 0 };
        self.memory.values()[..written].iter().all(|x| x.is_finite() && *x != GARBAGE)
            && self.memory.bits()[written..] == self.before[written..]
    }
}

/// Checks that the outputs are one of the allowed answers.
///
/// `pnewdt`: before and after; `None` if it was NULL.
fn judge(outputs: &[Output], pnewdt: Option<[f64; 2]>, allowed: &[Answer], context: &dyn Fn() -> String) {
    for output in outputs {
        assert!(output.memory.is_intact(), "written around {}: {}", output.name, context());
    }
    let matches = |answer: Answer| {
        let agrees = match (answer, pnewdt) {
            (_, None) => true,
            (Answer::Done, Some([before, after])) => before.to_bits() == after.to_bits(),
            (_, Some([_, after])) => after > 0.0 && after < 1.0,
        };
        agrees
            && outputs.iter().all(|output| match answer {
                Answer::Done => output.is_written(),
                Answer::Untouched if pnewdt.is_none() && ["STRESS", "TAU"].contains(&output.name) => output.is_spoilt(),
                Answer::Untouched => output.is_untouched(),
                Answer::Refused => output.is_spoilt(),
            })
    };
    if !allowed.iter().any(|answer| matches(*answer)) {
        let found: Vec<_> =
            [Answer::Done, Answer::Untouched, Answer::Refused].into_iter().filter(|answer| matches(*answer)).collect();
        let values: Vec<_> = outputs.iter().map(|output| (output.name, output.memory.values())).collect();
        panic!("{found:?} instead of {allowed:?}, PNEWDT {pnewdt:?}, {values:?}: {}", context());
    }
}

/// Returns whether a law's own check accepts parameters, whatever the length; it must not panic at any.
fn is_accepted(validation: &Validation) -> bool {
    match validation {
        Validation::Valid => true,
        Validation::Invalid(words) => {
            assert!(!words.is_empty() && !words.contains("internal error"), "{words}");
            false
        }
        Validation::NeedsCharacteristicLength(_) => true,
    }
}

/// A name as Fortran pads it, or bytes; with a NUL where it is shorter than 80 bytes.
fn name(right: &str) -> impl Strategy<Value = Vec<u8>> + use<> {
    let padded = format!("{:80}", right.to_uppercase()).into_bytes();
    let terminated = format!("{right}\0").into_bytes();
    let begins = right.to_owned();
    prop_oneof![
        6 => Just(padded),
        1 => Just(terminated),
        1 => vec(any::<u8>(), 80),
        1 => vec(any::<u8>(), 80).prop_map(move |mut bytes| {
            bytes[..begins.len()].copy_from_slice(begins.as_bytes());
            bytes
        }),
        1 => Just(vec![b' '; 80]),
        1 => Just(vec![0]),
    ]
}

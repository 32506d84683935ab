//! Random input for readers and boundaries: how much of it, and files with damage.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::{Config, RngSeed};

/// Returns a configuration of `cases` inputs, the same in every run of `cargo test`; `PROPTEST_CASES=1000000` makes it
/// so many and other ones each time (`PROPTEST_RNG_SEED=1` the same ones again).
pub fn config(cases: u32) -> Config {
    let given = |name: &str| std::env::var_os(name).is_some();
    let mut config = Config { failure_persistence: None, ..Config::default() };
    if !given("PROPTEST_CASES") {
        config.cases = cases;
        if !given("PROPTEST_RNG_SEED") {
            config.rng_seed = RngSeed::Fixed(1);
        }
    }
    config
}

/// Numbers, and what is not quite one, as text.
pub const WILD_WORDS: [&str; 34] = [
    "0",
    "-0",
    "1",
    "2",
    "3",
    "8",
    "15",
    "16",
    "-1",
    "1.5",
    "1e-320",
    "1e308",
    "-1e308",
    "1e999",
    "-1e999",
    "100000000",
    "2147483647",
    "2147483648",
    "-2147483649",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "99999999999999999999999999999999999999999",
    "NaN",
    "nan",
    "inf",
    "-Infinity",
    "0x10",
    "1_000",
    "",
    "\"\"",
    "\u{0}",
];

/// Numbers at the ends of all scales, NaN and infinity.
pub const WILD_NUMBERS: [f64; 24] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    1e-3,
    -1e-3,
    5e-324,
    -5e-324,
    1e-310,
    f64::MIN_POSITIVE,
    1e-160,
    1e-16,
    1e16,
    1e100,
    1e155,
    1e300,
    1e308,
    -1e308,
    f64::MAX,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

/// A change to a file; places are shares of its length.
#[derive(Clone, Debug)]
pub enum Damage {
    /// Bytes written over others.
    Overwrite(Index, Vec<u8>),
    /// Bytes between others.
    Insert(Index, Vec<u8>),
    /// A number of bytes left out.
    Remove(Index, usize),
    /// A number of bytes repeated, and how often.
    Repeat(Index, usize, usize),
    /// The end is missing.
    Truncate(Index),
    /// A word (what stands between blanks or the signs of JSON) that is another one.
    Word(Index, String),
    /// Two lines that change places.
    SwapLines(Index, Index),
}

/// A few changes.
pub fn damage() -> impl Strategy<Value = Vec<Damage>> {
    vec(one_damage(), 1..5)
}

fn one_damage() -> impl Strategy<Value = Damage> {
    let place = any::<Index>;
    prop_oneof![
        2 => (place(), wild_bytes()).prop_map(|(at, bytes)| Damage::Overwrite(at, bytes)),
        1 => (place(), wild_bytes()).prop_map(|(at, bytes)| Damage::Insert(at, bytes)),
        1 => (place(), 1_usize..40).prop_map(|(at, count)| Damage::Remove(at, count)),
        1 => (place(), 1_usize..40, 1_usize..20).prop_map(|(at, count, times)| Damage::Repeat(at, count, times)),
        1 => place().prop_map(Damage::Truncate),
        6 => (place(), wild_word()).prop_map(|(at, word)| Damage::Word(at, word)),
        1 => (place(), place()).prop_map(|(a, b)| Damage::SwapLines(a, b)),
    ]
}

/// A word that is hardly what is expected.
pub fn wild_word() -> impl Strategy<Value = String> {
    prop_oneof![
        6 => select(&WILD_WORDS[..]).prop_map(str::to_owned),
        2 => (-3_i64..40).prop_map(|number| number.to_string()),
        1 => any::<f64>().prop_map(|number| number.to_string()),
        1 => any::<i64>().prop_map(|number| number.to_string()),
        1 => vec(any::<char>(), 0..6).prop_map(String::from_iter),
    ]
}

/// Bytes of text or of binary numbers.
fn wild_bytes() -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        2 => vec(any::<u8>(), 1..9),
        1 => select(&WILD_NUMBERS[..]).prop_map(|number| number.to_le_bytes().to_vec()),
        1 => prop_oneof![any::<i32>(), -3..40_i32, Just(i32::MIN), Just(i32::MAX)].prop_map(|n| n.to_le_bytes().to_vec()),
        1 => prop_oneof![any::<u64>(), 0..40_u64, Just(u64::MAX), Just(1 << 40)].prop_map(|n| n.to_le_bytes().to_vec()),
    ]
}

/// The file with the changes, one after the other.
pub fn damaged(file: &[u8], changes: &[Damage]) -> Vec<u8> {
    let mut bytes = file.to_vec();
    for change in changes {
        if bytes.is_empty() {
            break;
        }
        let length = bytes.len();
        let range = |at: &Index, count: usize| {
            let start = at.index(length);
            start..(start + count).min(length)
        };
        match change {
            Damage::Overwrite(at, new) => {
                let range = range(at, new.len());
                let fitting = &new[..range.len()];
                bytes[range].copy_from_slice(fitting);
            }
            Damage::Insert(at, new) => drop(bytes.splice(range(at, 0), new.iter().copied())),
            Damage::Remove(at, count) => drop(bytes.drain(range(at, *count))),
            Damage::Repeat(at, count, times) => {
                let range = range(at, *count);
                let copies = bytes[range.clone()].repeat(*times);
                drop(bytes.splice(range.end..range.end, copies));
            }
            Damage::Truncate(at) => bytes.truncate(at.index(length)),
            Damage::Word(at, new) => {
                let words = words(&bytes);
                if !words.is_empty() {
                    drop(bytes.splice(words[at.index(words.len())].clone(), new.bytes()));
                }
            }
            Damage::SwapLines(a, b) => {
                let mut lines: Vec<&[u8]> = bytes.split(|byte| *byte == b'\n').collect();
                let (a, b) = (a.index(lines.len()), b.index(lines.len()));
                lines.swap(a, b);
                bytes = lines.join(&b'\n');
            }
        }
    }
    bytes
}

/// Returns the positions of a text's words.
fn words(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let separates = |byte: u8| byte.is_ascii_whitespace() || b",:[]{}".contains(&byte);
    let mut words: Vec<std::ops::Range<usize>> = Vec::new();
    for (k, _) in bytes.iter().enumerate().filter(|(_, byte)| !separates(**byte)) {
        match words.last_mut() {
            Some(word) if word.end == k => word.end = k + 1,
            _ => words.push(k..k + 1),
        }
    }
    words
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn words_stand_between_blanks_and_signs() {
        let text = b"{\"a\": [1.5,-2]} end";
        let found: Vec<&[u8]> = words(text).into_iter().map(|range| &text[range]).collect();
        assert_eq!(found, [&b"\"a\""[..], b"1.5", b"-2", b"end"]);
    }

    proptest! {
        #![proptest_config(config(200))]
        #[test]
        fn damage_grows_a_file_by_no_more_than_it_says(changes in damage()) {
            let file = b"one two three\nfour five\n".repeat(20);
            let most = file.len() + changes.len() * 40 * 20;
            prop_assert!(damaged(&file, &changes).len() <= most);
        }
    }
}

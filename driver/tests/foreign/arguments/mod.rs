//! What each argument of UMAT, UINTER and FRIC is: a plugin prints them (tests/umats/print.c), and each is matched, at
//! points on their own and in specimens.

mod contact;
mod element;
mod interface;
mod mesh;
mod point;

use std::collections::BTreeMap;

/// The arguments of a call by name, as printed.
type Printed = BTreeMap<String, String>;

/// All calls of an entry point.
fn calls(stdout: &str, entry: &str) -> Vec<Printed> {
    let lines = stdout.lines().filter_map(|line| line.strip_prefix(entry)?.strip_prefix(' '));
    lines
        .map(|line| {
            let pairs = line.split(' ').map(|pair| pair.split_once('=').unwrap_or_else(|| panic!("'{pair}'")));
            pairs.map(|(name, value)| (name.to_owned(), value.to_owned())).collect()
        })
        .collect()
}

fn values(text: &str) -> Vec<f64> {
    text.split(',').map(|value| value.parse().unwrap_or_else(|_| panic!("'{text}'"))).collect()
}

/// Rounding of a number that was computed in a few steps.
const ROUNDING: f64 = 1e-14;

/// Asserts that a call has just these arguments, to rounding; names that blanks pad to 80.
fn expect(call: &Printed, expected: &[(&str, &[f64])], names: &[(&str, &str)]) {
    expect_within(ROUNDING, call, expected, names);
}

/// The same, with what rounding makes of longer computations, as a share of an array's largest value.
fn expect_within(rounding: f64, call: &Printed, expected: &[(&str, &[f64])], names: &[(&str, &str)]) {
    for (name, expected) in expected {
        let found = values(&call[*name]);
        let scale = expected.iter().fold(1e-3_f64, |largest, value| largest.max(value.abs()));
        let close = found.iter().zip(*expected).all(|(a, b)| (a - b).abs() <= rounding * scale);
        assert!(found.len() == expected.len() && close, "{name}: {found:?} instead of {expected:?}");
    }
    for (name, text) in names {
        assert_eq!(call[*name], format!("{text:_<80},80"), "{name}");
    }
    let told: Vec<&str> = expected.iter().map(|(name, _)| *name).chain(names.iter().map(|(name, _)| *name)).collect();
    let forgotten: Vec<_> = call.keys().filter(|name| !told.contains(&name.as_str())).collect();
    assert!(forgotten.is_empty(), "not matched: {forgotten:?}");
}

const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
/// PNEWDT on entry.
const LARGE: f64 = 1e36;

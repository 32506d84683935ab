//! Values of each argument of UMAT, UINTER and FRIC: a plugin prints them (tests/umats/print.c), and each is compared,
//! at points on their own and in specimens.

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
fn expect(call: &Printed, expected: &[Argument<'_>], names: &[(&str, &str)]) {
    expect_within(ROUNDING, call, expected, names);
}

/// Asserts the same with another rounding error, of longer computations, as a share of an array's largest value.
fn expect_within(rounding: f64, call: &Printed, expected: &[Argument<'_>], names: &[(&str, &str)]) {
    for (name, expected) in expected {
        let found = values(&call[*name]);
        let scale = expected.iter().fold(1e-3_f64, |largest, value| largest.max(value.abs()));
        let close = found.iter().zip(*expected).all(|(a, b)| (a - b).abs() <= rounding * scale);
        assert!(found.len() == expected.len() && close, "{name}: {found:?} instead of {expected:?}");
    }
    for (name, text) in names {
        assert_eq!(call[*name], format!("{text:_<80},80"), "{name}");
    }
    let matched: Vec<&str> =
        expected.iter().map(|(name, _)| *name).chain(names.iter().map(|(name, _)| *name)).collect();
    let forgotten: Vec<_> = call.keys().filter(|name| !matched.contains(&name.as_str())).collect();
    assert!(forgotten.is_empty(), "not matched: {forgotten:?}");
}

/// The name of an argument and its values.
type Argument<'v> = (&'v str, &'v [f64]);

/// Arguments that the printing plugin with its two constants gets in every UINTER call of a plane, wherever the point
/// is.
const UINTER_ALWAYS: &[Argument<'_>] = &[
    ("ddsddr", &[0.0; 4]),
    ("dviscous", &[0.0; 4]),
    ("dstructural", &[0.0; 4]),
    ("flux", &[0.0; 2]),
    ("ddfddt", &[0.0; 4]),
    ("ddsddt", &[0.0; 4]),
    ("ddfddr", &[0.0; 4]),
    ("pnewdt", &[LARGE]),
    // at the end, of slave and master, which are as warm as each other
    ("temp", &[30.0; 2]),
    ("dtemp", &[5.0; 2]),
    ("predef", &[3.0, 3.0, 6.0, 6.0]),
    ("dpred", &[1.0, 1.0, 2.0, 2.0]),
    ("freqr", &[0.0]),
    ("props", &[100.0, 6.0]),
    ("drot", &[1.0, 0.0, 0.0, 1.0]),
    ("ndir", &[2.0]),
    ("nstatv", &[1.0]),
    ("npred", &[2.0]),
    ("nprops", &[2.0]),
    ("mcrd", &[3.0]),
    ("linper", &[0.0]),
    // as the plugin left them; LSDI is 0 at each call
    ("lopenclose", &[1.0]),
    ("lstate", &[2.0]),
    ("lsdi", &[0.0]),
    ("lprint", &[0.0]),
];

/// Arguments that the printing plugin with one constant gets in every FRIC call.
const FRIC_ALWAYS: &[Argument<'_>] = &[
    ("ddtddg", &[0.0]),
    ("ddtddp", &[0.0]),
    ("dslip", &[0.0]),
    ("ddtddt", &[0.0; 2]),
    ("pnewdt", &[LARGE]),
    ("taulm", &[0.0]),
    ("ddpddh", &[0.0]),
    // no contact element: NODE identifies the point
    ("noel", &[1.0]),
    ("npt", &[1.0]),
    ("npatch", &[1.0]),
    ("drot", &[1.0, 0.0, 0.0, 1.0]),
    // at the end, of slave and master, which are as warm as each other
    ("temp", &[30.0; 2]),
    ("predef", &[3.0, 3.0, 6.0, 6.0]),
    ("nfdir", &[1.0]),
    ("mcrd", &[3.0]),
    ("npred", &[2.0]),
    ("nstatv", &[1.0]),
    ("props", &[100.0]),
    ("nprops", &[1.0]),
];

const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
/// PNEWDT on entry.
const LARGE: f64 = 1e36;

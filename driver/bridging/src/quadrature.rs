//! Gauss–Legendre rules on panels between kinks, and roots in a bracket.

use gauss_quad::GaussLegendre;
use models::roots::bracketed;
use std::sync::OnceLock;

/// Degrees of the rules; a result is accepted when two neighbours agree.
pub const DEGREES: [usize; 4] = [6, 12, 24, 48];

/// Resolution of an integral.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resolution {
    /// Agreement of two rules, relative, that ends the refinement.
    pub agreement: f64,
    /// Halvings of a distance between samples to a kink, over the length and over the angle.
    pub halvings: [i32; 2],
    /// Samples of a panel of lengths, and of the angle over the quarter circle, between which kinks are looked for.
    pub samples: usize,
}

impl Resolution {
    /// Closed forms, whose kinks are all found: rounding.
    pub const EXACT: Self = Self { agreement: 1e-9, halvings: [44, 44], samples: 12 };
    /// Bond laws of lines and tabulated spalls, which have more kinks than are worth looking for.
    pub const LINES: Self = Self { agreement: 1e-5, halvings: [16, 36], samples: 8 };
    /// Tables, whose curves have a kink at every point.
    pub const TABLE: Self = Self { agreement: 3e-4, halvings: [14, 18], samples: 4 };
}

/// Nodes and weights on (0, 1) of the rule of `DEGREES[level]`.
pub fn rule(level: usize) -> &'static [(f64, f64)] {
    static RULES: [OnceLock<Vec<(f64, f64)>>; DEGREES.len()] = [const { OnceLock::new() }; DEGREES.len()];
    RULES[level].get_or_init(|| {
        let rule = GaussLegendre::new(DEGREES[level]).expect("the degrees are above 1");
        rule.iter().map(|(node, weight)| (0.5 * (node + 1.0), 0.5 * weight)).collect()
    })
}

/// ∫ f over [a, b] by the rule of `DEGREES[level]`.
pub fn integral(level: usize, a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    rule(level).iter().map(|(node, weight)| weight * f(a + (b - a) * node)).sum::<f64>() * (b - a)
}

/// The outermost samples keep this part of the interval from its ends.
const MARGIN: f64 = 1e-10;

/// The places in (a, b) where `label` changes, by sampling and so many halvings. Two changes between
/// neighbouring samples that cancel are not seen.
pub fn changes<L: PartialEq>(
    a: f64,
    b: f64,
    samples: usize,
    halvings: i32,
    mut label: impl FnMut(f64) -> L,
) -> Vec<f64> {
    let at = |k: usize| a + (b - a) * (k as f64 / (samples - 1) as f64).clamp(MARGIN, 1.0 - MARGIN);
    let mut found = Vec::new();
    let mut left = (at(0), label(at(0)));
    for k in 1..samples {
        let right = (at(k), label(at(k)));
        while left.1 != right.1 {
            let (mut low, mut high) = (left.0, right.0);
            let mut beyond = None;
            for _ in 0..halvings {
                let middle = 0.5 * (low + high);
                let here = label(middle);
                if here == left.1 {
                    low = middle;
                } else {
                    high = middle;
                    beyond = Some(here);
                }
            }
            found.push(0.5 * (low + high));
            match beyond {
                Some(here) => left = (high, here),
                None => break,
            }
        }
        left = right;
    }
    found
}

/// A root is found to this part of it.
const ROOT: f64 = 1e-13;

/// A root of f in [a, b], whose ends have values of different signs or 0.
pub fn root(mut f: impl FnMut(f64) -> f64, a: f64, b: f64) -> f64 {
    let ends = [(b, f(b)), (a, f(a))];
    bracketed(f, ends[0], ends[1], ROOT).x
}

/// Returns where f is greatest in [a, b], if it has one maximum there (golden section), and its value.
pub fn maximum(mut f: impl FnMut(f64) -> f64, a: f64, b: f64, steps: usize) -> (f64, f64) {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut low, mut high) = (a, b);
    let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let mut values = inner.map(&mut f);
    for _ in 0..steps {
        if values[0] < values[1] {
            low = inner[0];
            inner = [inner[1], low + GOLDEN * (high - low)];
            values = [values[1], f(inner[1])];
        } else {
            high = inner[1];
            inner = [high - GOLDEN * (high - low), inner[0]];
            values = [f(inner[0]), values[0]];
        }
    }
    if values[0] < values[1] { (inner[1], values[1]) } else { (inner[0], values[0]) }
}

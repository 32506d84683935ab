//! Numbers of trials and failures, and the largest errors.

use std::collections::BTreeMap;
use std::fmt;

/// One promise of a law.
#[derive(Clone, Debug, Default)]
pub struct Check {
    /// Number of times that it was checked.
    pub tried: u64,
    /// Number of those that were not compared, since there is nothing to compare with (see the promise's name).
    pub excluded: u64,
    /// Number of those that were broken.
    pub failed: u64,
    /// The worst error over the one that is allowed; `None`: it holds or does not.
    pub worst: Option<f64>,
    /// Place at which it was broken first.
    pub first: Option<String>,
}

impl Check {
    fn merge(&mut self, other: Self) {
        self.tried += other.tried;
        self.excluded += other.excluded;
        self.failed += other.failed;
        self.worst = self.worst.into_iter().chain(other.worst).reduce(f64::max);
        self.first = self.first.take().or(other.first);
    }
}

/// Name of the comparison of tangents.
pub(super) const TANGENT: &str = "the tangent is the derivative (excluded: at kinks, below rounding)";

/// Largest share of tangents that may be left out, of each reason.
const EXCLUDED_SHARE: f64 = 0.05;
/// Largest share of states that may be cut back, all parameters taken together.
const CUT_BACK_SHARE: f64 = 1e-3;

/// Record of the trials of a law.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    /// Increments that were asked for.
    pub states: u64,
    /// Parameter sets that the law refuses as inconsistent.
    pub sets_refused: u64,
    /// Counts by reason, with the first place of each.
    pub cut_backs: BTreeMap<&'static str, (u64, String)>,
    /// Tangents that are right on one side of a kink that they stand on.
    pub one_sided: u64,
    /// Tangents so small that differences of the stress do not resolve them to 1e-6: not compared further.
    pub unresolved: u64,
    /// Tangents at strains that were not placed on kinks; of those, within the reach of the differences of a kink.
    pub generic_tangents: [u64; 2],
    checks: BTreeMap<&'static str, Check>,
    /// Hash of the bits of all answers, in their order.
    pub(super) digest: u64,
}

impl Ledger {
    /// A promise that holds or does not.
    pub(super) fn require(&mut self, promise: &'static str, holds: bool, context: impl Fn() -> String) {
        let check = self.checks.entry(promise).or_default();
        check.tried += 1;
        if !holds {
            check.failed += 1;
            check.first.get_or_insert_with(context);
        }
    }

    /// A promise that holds to some precision.
    pub(super) fn within(&mut self, promise: &'static str, error: f64, allowed: f64, context: impl Fn() -> String) {
        let ratio = if error == 0.0 { 0.0 } else { error / allowed };
        let ratio = if ratio.is_nan() { f64::INFINITY } else { ratio };
        self.require(promise, ratio <= 1.0, || format!("{error:e} > {allowed:e}: {}", context()));
        let check = self.checks.entry(promise).or_default();
        check.worst = Some(check.worst.map_or(ratio, |worst| worst.max(ratio)));
    }

    /// Something that cannot be compared.
    pub(super) fn exclude(&mut self, promise: &'static str) {
        let check = self.checks.entry(promise).or_default();
        check.tried += 1;
        check.excluded += 1;
    }

    pub(super) fn digest(&mut self, values: &[f64]) {
        for value in values {
            self.digest = (self.digest.rotate_left(5) ^ value.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        }
    }

    /// Adds what came after.
    pub(super) fn merge(&mut self, other: Self) {
        self.states += other.states;
        self.sets_refused += other.sets_refused;
        for (reason, (count, context)) in other.cut_backs {
            self.cut_backs.entry(reason).or_insert((0, context)).0 += count;
        }
        self.one_sided += other.one_sided;
        self.unresolved += other.unresolved;
        for k in 0..2 {
            self.generic_tangents[k] += other.generic_tangents[k];
        }
        for (promise, check) in other.checks {
            self.checks.entry(promise).or_default().merge(check);
        }
    }

    /// States that were cut back.
    pub fn cut_back(&self) -> u64 {
        self.cut_backs.values().map(|(count, _)| count).sum()
    }

    /// All promises, with those on how much may be left out.
    pub fn checks(&self) -> Vec<(&'static str, Check)> {
        let limit = |tried: u64, out: u64, share: f64| {
            let allowed = share * tried as f64;
            let failed = if out as f64 > allowed { out } else { 0 };
            let worst = if out == 0 { 0.0 } else { out as f64 / allowed };
            Check { tried, excluded: out - failed, failed, worst: Some(worst), first: None }
        };
        let [generic, kinks] = self.generic_tangents;
        let tangents = self.checks.get(TANGENT).map_or(0, |check| check.tried);
        let mut checks: Vec<_> = self.checks.iter().map(|(promise, check)| (*promise, check.clone())).collect();
        checks.push((
            "at most 5 % of tangents at strains of no special place are at kinks",
            limit(generic, kinks, EXCLUDED_SHARE),
        ));
        checks.push(("at most 5 % of tangents are below rounding", limit(tangents, self.unresolved, EXCLUDED_SHARE)));
        checks.push(("at most 1 state in 1000 is cut back", limit(self.states, self.cut_back(), CUT_BACK_SHARE)));
        checks
    }

    /// Returns the number of broken promises, counting every time.
    pub fn failures(&self) -> u64 {
        self.checks().iter().map(|(_, check)| check.failed).sum()
    }
}

impl fmt::Display for Ledger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:>8} states, {} cut back, {} sets refused", self.states, self.cut_back(), self.sets_refused)?;
        for (reason, (count, context)) in &self.cut_backs {
            write!(f, "\n    {reason}: {count}, first {context}")?;
        }
        for (promise, check) in self.checks().iter().filter(|(_, check)| check.failed > 0) {
            write!(f, "\n    broken: {promise}: {} of {}", check.failed, check.tried)?;
            check.first.iter().try_for_each(|first| write!(f, ", first {first}"))?;
        }
        Ok(())
    }
}

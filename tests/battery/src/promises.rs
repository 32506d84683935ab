//! Promises of a law, and the macro that makes the tests which hold it to them.

use super::{
    STRESS_STATES, Sample, check_invariants, check_path_exactness, check_random_paths, check_rotation, check_virgin,
};
use umat_abi::law::{Law, StressState};

/// Promises of a solid's law, and the parameters at which it is tested.
pub struct Promises<'p> {
    /// Ordinary parameters.
    pub samples: Vec<Sample<'p>>,
    /// Random histories of each sample and stress state.
    pub histories: usize,
    /// States that never decrease.
    pub monotone: &'static [&'static str],
    /// Dissipation never decreases.
    pub dissipative: bool,
    /// A committed strain met again gives the same stress.
    pub steady: bool,
    /// States that are 0 below the thresholds.
    pub history: &'static [&'static str],
    /// A strain below every threshold.
    pub elastic_strain: fn(&Sample<'_>) -> f64,
    /// Ends of proportional paths, relative to the size of a sample.
    pub path_ends: &'static [[f64; 6]],
    /// Random paths with up to 1000 increments, and with 100 000 as well.
    pub random_paths: [usize; 2],
    /// Numbers of increments that must give the same end of a proportional path; empty: not promised.
    pub path_counts: fn(&Sample<'_>, StressState) -> &'static [u32],
}

impl Promises<'_> {
    /// Applies a check to every stress state and sample.
    fn each(&self, check: impl Fn(&Sample<'_>, StressState)) {
        for stress_state in STRESS_STATES {
            self.samples.iter().for_each(|sample| check(sample, stress_state));
        }
    }

    /// [`check_rotation`] of every sample.
    pub fn check_rotation<L: Law>(&self) {
        self.each(|sample, stress_state| check_rotation::<L>(sample, stress_state, self.histories));
    }

    /// [`check_invariants`] of every sample.
    pub fn check_invariants<L: Law>(&self) {
        self.each(|sample, stress_state| check_invariants::<L>(sample, stress_state, self));
    }

    /// [`check_virgin`] of every sample.
    pub fn check_virgin<L: Law>(&self) {
        self.each(|sample, stress_state| {
            check_virgin::<L>(sample, stress_state, (self.elastic_strain)(sample), self.history);
        });
    }

    /// [`check_path_exactness`] of the given ends and of random ones.
    pub fn check_paths<L: Law>(&self) {
        self.each(|sample, stress_state| {
            let counts = (self.path_counts)(sample, stress_state);
            if counts.is_empty() {
                return;
            }
            for end in self.path_ends {
                check_path_exactness::<L>(sample, stress_state, &end.map(|x| x * sample.size), counts);
            }
            let [many, few] = self.random_paths;
            check_random_paths::<L>(sample, stress_state, many, few, counts);
        });
    }
}

/// Makes the tests that every law of a solid must pass, in a module of the given name: the tangent against differences, the
/// response to turned strains, what never decreases, the virgin solid, proportional paths, and the tables of the law's pages
/// (files of `src/`, with the heads of their tables), which must be those that hosts see.
#[macro_export]
macro_rules! battery {
    ($name:ident: $law:ty, $promises:expr $(, pages: [$($page:literal: $heads:expr),*])?) => {
        mod $name {
            #[allow(clippy::wildcard_imports, reason = "the promises speak of the law's own parameters")]
            use super::*;

            #[test]
            fn tangent_is_the_derivative_of_the_stress() {
                $crate::check_tangents::<$law>(stringify!($name), &$promises.samples);
            }

            #[test]
            fn response_turns_with_the_axes() {
                $promises.check_rotation::<$law>();
            }

            #[test]
            fn nothing_heals() {
                $promises.check_invariants::<$law>();
            }

            #[test]
            fn a_virgin_solid_is_elastic() {
                $promises.check_virgin::<$law>();
            }

            #[test]
            fn increments_of_a_proportional_path_do_not_matter() {
                $promises.check_paths::<$law>();
            }

            $($(
                #[test]
                fn pages_have_the_tables_that_hosts_see() {
                    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/src/", $page);
                    $crate::pages::check(file, &<$law as umat_abi::law::Law>::INFO, $heads);
                }
            )*)?
        }
    };
}

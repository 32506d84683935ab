//! Extreme inputs for a law: strains of 17 decades, zeros, subnormal numbers, repeated principal strains, full damage,
//! corners of the parameters, NaN and infinity. Every answer must be finite and hold the law's invariants; the tangent
//! of ordinary parameter sets is compared with differences; histories are turned, proportional paths walked in other
//! increments.
//!
//! Tests throw 10 000 states at each law and stress state, `pullout-bench stability` as many as it is asked for.

mod corners;
mod history;
mod ledger;
mod strain;
mod subjects;
#[cfg(test)]
mod test;

pub use ledger::{Check, Ledger};
pub use subjects::{Form, forms};

use super::proportional::{deviation, equal, stress_after};
use super::rotation::rotation_error;
use super::{Random, Sample, worst};
use history::History;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use umat_abi::law::{Law, StressState};

/// One law (or one form of it) and what it promises.
pub struct TestedLaw<'p> {
    /// Ordinary parameters: their tangents are compared with differences.
    pub samples: Vec<Sample<'p>>,
    /// Any admissible parameters and a characteristic length.
    pub corner: fn(&mut Random) -> corners::Corner,
    /// States that never decrease; of them those named `eta…` are D/(1 − D).
    pub monotone: &'static [&'static str],
    /// Dissipation never decreases.
    pub dissipative: bool,
    /// The stress is a continuous function of the strain.
    pub continuous: bool,
    /// A committed strain met again gives the same stress.
    pub steady: bool,
    /// The stored energy is ½ σ : ε: no inelastic strain, σ its derivative.
    pub quadratic: bool,
    /// Stress states in which the end of a proportional path does not depend on its increments.
    pub path_exact: &'static [StressState],
}

/// States of one chunk: what one thread takes at a time. A chunk is the same on any thread.
const CHUNK: u64 = 1000;
/// One chunk in so many is made again on the calling thread and compared.
const COMPARED: usize = 40;
/// Share of histories of ordinary parameters after which one is turned and a proportional path is walked.
const PATHS: f64 = 0.05;

impl Form {
    /// Throws states at it, on several threads. `done` receives the size of each share of the states, in any order.
    ///
    /// # Panics
    /// If the law panics.
    pub fn throw(&self, stress_state: StressState, states: u64, threads: usize, done: &(dyn Fn(u64) + Sync)) -> Ledger {
        let chunks = usize::try_from(states.div_ceil(CHUNK)).unwrap_or(usize::MAX);
        let (next, thrown) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
        let size = |chunk: usize| CHUNK.min(states - CHUNK * chunk as u64);
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    loop {
                        let chunk = next.fetch_add(1, Ordering::Relaxed);
                        if chunk >= chunks {
                            break;
                        }
                        let ledger = (self.chunk)(stress_state, chunk as u64, size(chunk));
                        thrown.lock().expect("no thread panicked").push((chunk, ledger));
                        done(size(chunk));
                    }
                });
            }
        });
        let mut ledgers = thrown.into_inner().expect("no thread panicked");
        ledgers.sort_unstable_by_key(|(chunk, _)| *chunk);
        let mut sum = Ledger::default();
        for (chunk, ledger) in ledgers {
            if chunk % COMPARED == 0 {
                let again = (self.chunk)(stress_state, chunk as u64, size(chunk));
                let same = again.digest == ledger.digest;
                sum.require("one thread and several give the same bits", same, || format!("chunk {chunk}"));
            }
            sum.merge(ledger);
        }
        sum
    }
}

/// Throws one chunk of states at a law.
fn throw<L: Law>(subject: &TestedLaw<'_>, stress_state: StressState, chunk: u64, states: u64) -> Ledger {
    let mut random = Random::new((0x57AB_1117 ^ chunk).wrapping_mul(0xD134_2543_DE82_EF95));
    let mut ledger = Ledger::default();
    while ledger.states < states {
        if random.unit() < 0.5 {
            let sample = subject.samples[(random.unit() * subject.samples.len() as f64) as usize];
            let history = History::<L>::new(subject, sample, stress_state, true).expect("ordinary parameters");
            history.run(&mut random, &mut ledger);
            if random.unit() < PATHS {
                turn::<L>(&sample, stress_state, &mut random, &mut ledger);
                if subject.path_exact.contains(&stress_state) {
                    walk::<L>(&sample, stress_state, &mut random, &mut ledger);
                }
            }
        } else {
            let (props, characteristic_length) = (subject.corner)(&mut random);
            let sample = Sample { props: &props, size: 3e-4, characteristic_length };
            match History::<L>::new(subject, sample, stress_state, false) {
                Some(history) => history.run(&mut random, &mut ledger),
                None => ledger.sets_refused += 1,
            }
        }
    }
    ledger
}

/// A rotated history gives the rotated stress.
fn turn<L: Law>(sample: &Sample<'_>, stress_state: StressState, random: &mut Random, ledger: &mut Ledger) {
    let (error, strain) = rotation_error::<L>(sample, stress_state, random);
    ledger.within("a turned history gives the turned stress to 1e-12", error, 1.0, || {
        format!("{:?} {stress_state:?}: {strain:?}", sample.props)
    });
}

/// A proportional path to 100 times the peak strain at most: in one step, in equal ones, and in steps from 1e-14 of it on.
fn walk<L: Law>(sample: &Sample<'_>, stress_state: StressState, random: &mut Random, ledger: &mut Ledger) {
    const STRESS_ERROR: f64 = 1e-12;
    let size = sample.size * 10_f64.powf(3.0 * random.unit() - 1.0);
    let strain = random.strain(stress_state, size);
    let context = || format!("{:?} {stress_state:?}: {strain:?}", sample.props);
    let at_once = stress_after::<L>(sample, stress_state, &strain, equal(1));
    let decades = (-14..=0).map(|k| 10_f64.powi(k));
    let others = [
        stress_after::<L>(sample, stress_state, &strain, equal(1 + (40.0 * random.unit()) as u32)),
        stress_after::<L>(sample, stress_state, &strain, decades),
    ];
    // what is left of a stress is known to the rounding of the elastic one
    let largest = |values: &[f64; 6]| values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let rounding = 1e-15 * sample.props[0] * largest(&strain) / (1.0 - 2.0 * sample.props[1]) / largest(&at_once);
    let worst = worst(others.iter().map(|stress| deviation(stress, &at_once)));
    ledger.within("the increments of a proportional path do not matter", worst, STRESS_ERROR + rounding, context);
}

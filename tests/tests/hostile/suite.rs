//! Many attempts, by number, on all processors.

use end_to_end_tests::fuzz::{Damage, damage};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::any::Any;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

/// Seed of everything.
const SEED: u64 = 0x70_75_6c_6c_6f_75_74;

/// Extent of the trials.
pub enum Form {
    /// Parts of the suite, one of each module.
    Short,
    /// All.
    Whole,
    /// One attempt of one module.
    One(String, u64),
}

/// Result of a module.
#[derive(Debug, Default)]
pub struct Tally {
    pub tried: usize,
    /// Trials that failed: number and reason.
    pub broken: Vec<String>,
}

impl Form {
    /// Returns the form that `PULLOUT_HOSTILE` names.
    pub fn given() -> Self {
        let Ok(text) = std::env::var("PULLOUT_HOSTILE") else { return Self::Short };
        match text.split_once(':').map(|(module, number)| (module.to_owned(), number.parse())) {
            Some((module, Ok(number))) => Self::One(module, number),
            _ if text == "all" => Self::Whole,
            _ => panic!("PULLOUT_HOSTILE={text}: 'all', or a module and a number as in 'cases:17'"),
        }
    }

    /// Returns whether anything of a module is tried.
    pub fn concerns(&self, module: &str) -> bool {
        !matches!(self, Self::One(one, _) if one != module)
    }

    /// The numbers that are tried: of `all` in the short form `short`, evenly spread.
    pub fn numbers(&self, all: u64, short: u64) -> Vec<u64> {
        match self {
            Self::Short => (0..short).map(|k| k * all / short).collect(),
            Self::Whole => (0..all).collect(),
            Self::One(_, number) => vec![*number],
        }
    }
}

/// Makes an attempt for each number.
pub fn each(numbers: &[u64], attempt: impl Fn(u64, &mut fastrand::Rng) -> Result<(), String> + Sync) -> Tally {
    let next = AtomicU64::new(0);
    let broken = Mutex::new(Vec::new());
    let work = || {
        while let Some(&number) = numbers.get(next.fetch_add(1, Ordering::Relaxed) as usize) {
            let mut random = fastrand::Rng::with_seed(SEED ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            let outcome = catch_unwind(AssertUnwindSafe(|| attempt(number, &mut random)));
            let outcome = outcome.unwrap_or_else(|panic| Err(format!("panic: {}", words_of(&*panic))));
            if let Err(reason) = outcome {
                broken.lock().expect("no panic holds it").push((number, reason));
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(2, usize::from) {
            // plugins are called, and deep nesting is read
            thread::Builder::new().stack_size(pullout_run::PLUGIN_STACK).spawn_scoped(scope, work).expect("a thread");
        }
    });
    let mut broken = broken.into_inner().expect("no panic holds it");
    broken.sort();
    Tally { tried: numbers.len(), broken: broken.into_iter().map(|(k, reason)| format!("{k}: {reason}")).collect() }
}

/// Changes of the bytes of a file.
pub fn any_damage(number: u64) -> Vec<Damage> {
    let seed: [u8; 32] = std::array::from_fn(|k| number.to_le_bytes()[k % 8]);
    let mut runner = TestRunner::new_with_rng(Config::default(), TestRng::from_seed(RngAlgorithm::ChaCha, &seed));
    damage().new_tree(&mut runner).expect("it refuses nothing").current()
}

thread_local! {
    /// Place of this thread's last panic.
    static PLACE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Keeps the place of a panic instead of printing it: it is reported with the number of its attempt.
pub fn silence_panics() {
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map_or_else(String::new, ToString::to_string);
        PLACE.with(|last| *last.borrow_mut() = place);
    }));
}

fn words_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
    PLACE.with(|place| format!("{text} ({})", place.borrow()))
}

//! Times of ways that take turns: what else the machine does then meets all of them alike.

use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::{TimeVal, TimeValLike};
use std::time::Duration;

/// Number and length of the turns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timing {
    /// Number of turns of each way.
    rounds: usize,
    /// Least duration of a turn: a way that is faster is repeated.
    turn: Duration,
}

/// A way to be timed; a call is a unit of work.
pub(super) type Way<'a> = Box<dyn FnMut() + 'a>;

impl Timing {
    /// Few short turns.
    pub const QUICK: Self = Self { rounds: 3, turn: Duration::from_micros(50) };
    /// Turns shorter than a time slice of the scheduler, and enough of them for a median.
    pub const FULL: Self = Self { rounds: 15, turn: Duration::from_millis(2) };

    /// Times ways in turns.
    pub fn take_turns(self, mut ways: Vec<Way<'_>>) -> Times {
        let repeats: Vec<u32> = ways.iter_mut().map(|way| self.repeats(way)).collect();
        let mut seconds = vec![Vec::with_capacity(self.rounds); ways.len()];
        for _ in 0..self.rounds {
            for (k, way) in ways.iter_mut().enumerate() {
                let start = thread_time();
                for _ in 0..repeats[k] {
                    way();
                }
                seconds[k].push((thread_time() - start).as_secs_f64() / f64::from(repeats[k]));
            }
        }
        Times(seconds)
    }

    /// Returns the number of times that a way fits into a turn; it is warm then.
    fn repeats(self, way: &mut Way<'_>) -> u32 {
        let mut repeats = 1_u32;
        loop {
            let start = thread_time();
            for _ in 0..repeats {
                way();
            }
            let spent = thread_time() - start;
            if spent >= self.turn || repeats > 1 << 24 {
                return repeats;
            }
            // a short time is measured badly: at most ten times as many
            let wanted = self.turn.as_secs_f64() / spent.as_secs_f64().max(1e-9);
            repeats = (f64::from(repeats) * wanted.clamp(1.1, 10.0)).ceil() as u32;
        }
    }
}

/// Returns the CPU time of this thread.
pub(super) fn thread_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::try_from(time).unwrap_or_default()
}

/// Time that the processors spent on all threads of this process.
pub(super) fn process_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::try_from(time).unwrap_or_default()
}

/// Time that the processors spent on programs that this one started and waited for.
pub(super) fn children_time() -> Duration {
    let of = |time: TimeVal| Duration::from_micros(u64::try_from(time.num_microseconds()).unwrap_or(0));
    getrusage(UsageWho::RUSAGE_CHILDREN).map_or(Duration::ZERO, |usage| of(usage.user_time()) + of(usage.system_time()))
}

/// Seconds of a call, by way and round.
#[derive(Clone, Debug)]
pub(super) struct Times(Vec<Vec<f64>>);

impl Times {
    /// The median of a way, s.
    pub fn seconds(&self, way: usize) -> f64 {
        median(self.0[way].clone())
    }

    /// The median over the rounds of one way's time over another's.
    pub fn ratio(&self, way: usize, to: usize) -> f64 {
        median(self.0[way].iter().zip(&self.0[to]).map(|(a, b)| a / b).collect())
    }
}

/// The middle one; of an even number the upper.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod test {
    use super::*;
    use std::hint::black_box;

    #[test]
    fn a_median_is_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![1.0, 2.0, 3.0, 100.0]), 3.0);
        assert!(median(Vec::new()).is_nan());
    }

    #[test]
    fn ten_times_the_work_takes_about_ten_times_as_long() {
        let work = |count: u32| -> Way<'static> {
            Box::new(move || {
                let mut sum = 0.0_f64;
                for k in 0..count {
                    sum += black_box(f64::from(k)).sqrt();
                }
                black_box(sum);
            })
        };
        let times = Timing { rounds: 9, turn: Duration::from_micros(500) }.take_turns(vec![work(10_000), work(1_000)]);
        // the factor distinguishes calls from repeats, not a fast machine from a slow one
        assert!((3.0..30.0).contains(&times.ratio(0, 1)), "{}", times.ratio(0, 1));
        assert!(times.seconds(0) > times.seconds(1));
    }
}

//! One thread and all of them.

use super::super::solid::{Situation, Solid};
use super::super::timing::median;
use super::super::{BenchError, Settings};
use pullout_run::in_threads;
use std::hint::black_box;
use std::sync::Barrier;
use std::time::Instant;
use umat_abi::host::{Library, UmatCall};
use umat_abi::law::Request;

/// Throughput.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cores {
    /// Updates per second of one thread.
    pub per_second: f64,
    /// Updates of all threads over those of one.
    pub all_over_one: f64,
}

/// Measures repeated updates of one point per thread.
pub(super) fn measure(
    solid: &Solid,
    library: &Library,
    situation: Situation,
    request: Request,
    settings: &Settings,
) -> Result<Cores, BenchError> {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let (rounds, turn_s) = if settings.quick { (3, 2e-4) } else { (15, 4e-3) };
    let prepare = || -> Result<UmatCall, BenchError> {
        let mut call = solid.call(library, situation)?;
        call.dstran = solid.increment(situation);
        Ok(call)
    };
    let mut first = prepare()?;
    let count = updates_in(turn_s, &mut first, request);
    let (mut single, mut ratios) = (Vec::new(), Vec::new());
    for _ in 0..rounds {
        let alone = seconds(&mut first, count, request);
        let together = all(threads, &prepare, count, request)?;
        single.push(alone / count as f64);
        ratios.push(threads as f64 * alone / together);
    }
    Ok(Cores { per_second: 1.0 / median(single), all_over_one: median(ratios) })
}

/// Returns the number of updates that take about so long.
fn updates_in(turn_s: f64, call: &mut UmatCall, request: Request) -> usize {
    let mut count = 100;
    loop {
        let spent = seconds(call, count, request);
        if spent >= turn_s {
            return count;
        }
        count = (count as f64 * (1.2 * turn_s / spent.max(1e-9)).clamp(1.2, 10.0)) as usize;
    }
}

fn seconds(call: &mut UmatCall, count: usize, request: Request) -> f64 {
    let start = Instant::now();
    let _ = black_box(call.repeat(count, request));
    start.elapsed().as_secs_f64()
}

/// Seconds until all threads have made `count` updates each, begun together.
fn all(
    threads: usize,
    prepare: &(impl Fn() -> Result<UmatCall, BenchError> + Sync),
    count: usize,
    request: Request,
) -> Result<f64, BenchError> {
    let start_line = Barrier::new(threads);
    let run = || -> Result<(Instant, Instant), BenchError> {
        let call = prepare();
        start_line.wait();
        let start = Instant::now();
        let _ = black_box(call?.repeat(count, request));
        Ok((start, Instant::now()))
    };
    let panicked = |_| Err(BenchError::Failed("a measuring thread panicked".into()));
    let spans = in_threads((0..threads).map(|_| run)).into_iter().map(|ended| ended?.unwrap_or_else(panicked));
    let spans = spans.collect::<Result<Vec<_>, BenchError>>()?;
    let first = spans.iter().map(|(start, _)| *start).min();
    let last = spans.iter().map(|(_, end)| *end).max();
    Ok(first.zip(last).map_or(f64::NAN, |(first, last)| (last - first).as_secs_f64()))
}

//! Cost of the plugin ABI: one law called through a loaded library's `umat_`, through the same `umat_` linked into the
//! program ("direct"), and as the bare update in Rust.
//!
//! `cargo bench -p end-to-end-tests --bench abi_cost`. The ways alternate in short repeats, and medians are compared:
//! other work of the machine then affects all of them alike.

use end_to_end_tests::{PointMemory, Sample, plugin, sample, strain_path};
use std::hint::black_box;
use std::time::Instant;
use umat_abi::export::umat;
use umat_abi::law::{Increment, Law, Request, StressState, advance_values, parameters_of};
use umat_abi::umat::UmatFunction;

/// Calls of each way in all.
const CALLS: usize = 10_000_000;
const REPEATS: usize = 50;
/// Largest accepted surcharge of a loaded library over a direct call: the greater of the two.
const ACCEPTED_NANOSECONDS: f64 = 5.0;
const ACCEPTED_SHARE: f64 = 0.05;

/// Nanoseconds a call of `body`.
fn time(calls: usize, mut body: impl FnMut()) -> f64 {
    let start = Instant::now();
    for _ in 0..calls {
        body();
    }
    start.elapsed().as_secs_f64() * 1e9 / calls as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The start of an increment of a point that has passed its elastic limit; every call repeats this increment.
struct Start {
    point: PointMemory,
    stress: [f64; 6],
    statev: Vec<f64>,
}

impl Start {
    fn new(law: &Sample, umat: UmatFunction) -> Self {
        let mut point = PointMemory::new(law, StressState::ThreeD);
        let path = strain_path(7, 6, law.strain, 12);
        for increment in &path[..8] {
            point.advance(umat, increment);
        }
        point.dstran = path[8];
        Self { stress: point.stress, statev: point.statev.clone(), point }
    }

    /// Restores the state as a host does before it repeats a call.
    fn restore(&mut self) {
        self.point.stress = self.stress;
        self.point.statev.copy_from_slice(&self.statev);
    }
}

fn measure<L: Law>(law: &Sample, linked: UmatFunction, calls: usize) -> bool {
    let library = end_to_end_tests::open(&plugin(law.name));
    let function = black_box(library.umat(None).expect("umat_"));
    let mut start = Start::new(law, function);
    let linked = black_box(linked);
    let parameters = parameters_of::<L>(law.props).expect("valid parameters");
    let increment = Increment {
        stress_state: StressState::ThreeD,
        strain: std::array::from_fn(|i| start.point.stran[i] + start.point.dstran[i]),
        strain_increment: start.point.dstran,
        stress: start.stress,
        characteristic_length: None,
        time_increment: 1.0,
        temperature: 0.0,
    };
    let mut state = start.statev.clone();
    let mut nanoseconds = [const { Vec::new() }; 3];
    for _ in 0..REPEATS {
        nanoseconds[0].push(time(calls, || {
            start.restore();
            // SAFETY: the point's own memory.
            unsafe { black_box(&mut start.point).arguments().call(function) };
        }));
        nanoseconds[1].push(time(calls, || {
            start.restore();
            // SAFETY: the point's own memory.
            unsafe { black_box(&mut start.point).arguments().call(linked) };
        }));
        nanoseconds[2].push(time(calls, || {
            state.copy_from_slice(&start.statev);
            let response = advance_values::<L>(
                black_box(&parameters),
                black_box(&increment),
                &mut state,
                Request::StressAndTangent,
            );
            black_box(&response).as_ref().expect("a usable increment");
        }));
    }
    let [loaded, direct, bare] = nanoseconds.map(median);
    let surcharge = loaded - direct;
    let accepted = surcharge <= ACCEPTED_NANOSECONDS.max(ACCEPTED_SHARE * direct);
    println!(
        "{:<22} {bare:>10.2} {direct:>10.2} {loaded:>10.2} {surcharge:>+10.2} {:>+8.1} %  {}",
        law.name,
        100.0 * surcharge / direct,
        if accepted { "accepted" } else { "TOO MUCH" }
    );
    accepted
}

/// Measures every law with its `umat_` linked into this program: the same function, with the same 38 arguments, that its library
/// exports.
macro_rules! measure_all {
    (umat: [$($law:ty => $name:literal,)+], $($interface:tt)*) => {
        |calls: usize| [$({
            umat_abi::umat_symbol!(concat!("linked_", $name, "_"), linked, umat::<$law>);
            measure::<$law>(sample($name), linked, calls)
        }),+]
    };
}

fn main() {
    // `cargo test --benches` runs this too, without `--bench`: then it only shows that it works.
    let calls = if std::env::args().any(|argument| argument == "--bench") { CALLS / REPEATS } else { 10 };
    println!("ns a call, medians of {REPEATS} repeats of {calls} calls; accepted: +5 ns or +5 %");
    println!("{:<22} {:>10} {:>10} {:>10} {:>10} {:>10}", "law", "bare", "direct", "dlopen", "surcharge", "");
    let accepted = models::laws!(measure_all)(calls);
    if calls > 10 && accepted.contains(&false) {
        std::process::exit(1);
    }
}

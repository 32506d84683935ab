//! Cost of recording the arguments of a call for a supervisor: calls of the same law in the same state through call
//! objects that were made before and after the recorder was installed.
//!
//! `cargo bench -p end-to-end-tests --bench recorder_cost`. The ways alternate in repeats shorter than a time slice,
//! and those are compared that other work of the machine hardly disturbed.

use end_to_end_tests::{plugin, sample, strain_path};
use std::hint::black_box;
use std::time::Instant;
use umat_abi::host::{UinterCall, UmatCall, recorder};
use umat_abi::law::{Request, StressState};

/// Calls of each way in all.
const CALLS: usize = 10_000_000;
/// Number of repeats: so many that each takes less than a time slice.
const REPEATS: usize = 1000;
/// Largest accepted surcharge (docs/reference/abi.md).
const ACCEPTED_NANOSECONDS: f64 = 300.0;
/// States of a large law.
const MANY_STATES: usize = 200;

/// Makes a call object, and calls it repeatedly from the same state.
type Maker = Box<dyn Fn() -> Box<dyn FnMut()>>;

fn umat(name: &'static str, extra_states: usize) -> Maker {
    Box::new(move || {
        let law = sample(name);
        let library = end_to_end_tests::open(&plugin(name));
        let states = law.states + extra_states;
        let mut call =
            UmatCall::new(&library, None, name, StressState::ThreeD, states, law.props).expect("umat_ of the plugin");
        call.dstran = strain_path(7, 6, law.strain, 1)[0];
        Box::new(move || {
            call.stress_mut().fill(0.0);
            call.statev_mut().fill(0.0);
            call.call(black_box(Request::StressAndTangent)).expect("no overrun");
        })
    })
}

fn uinter() -> Maker {
    Box::new(|| {
        let library = end_to_end_tests::open(&plugin("bond_slip"));
        let law = library.laws()[0].clone();
        let mut props: Vec<f64> = law.parameters.iter().map(|parameter| parameter.default_value).collect();
        if let Some(group) = &law.group {
            props.truncate(law.parameters.len() - group.size);
        }
        if let Some(k) = law.parameters.iter().position(|parameter| parameter.role == "normal_penalty") {
            props[k] = 1e5;
        }
        let mut call = UinterCall::new(&library, None, "bond_slip", 2, law.states.len(), &props).expect("uinter_");
        call.rdisp = [0.0, 0.01, 0.0];
        call.drdisp = call.rdisp;
        Box::new(move || {
            call.stress_mut().fill(0.0);
            call.statev_mut().fill(0.0);
            black_box(call.call()).expect("no overrun");
        })
    })
}

/// Nanoseconds a call.
fn time(calls: usize, body: &mut dyn FnMut()) -> f64 {
    let start = Instant::now();
    for _ in 0..calls {
        body();
    }
    start.elapsed().as_secs_f64() * 1e9 / calls as f64
}

/// Returns the value below which one repeat in ten stays: the others were disturbed.
fn undisturbed(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 10]
}

fn main() {
    // `cargo test --benches` runs this too, without `--bench`: then it only shows that it works.
    let is_bench = std::env::args().any(|argument| argument == "--bench");
    let calls = if is_bench { CALLS / REPEATS } else { 1 };
    let laws = [
        ("linear_elastic", umat("linear_elastic", 0)),
        ("j2_plasticity", umat("j2_plasticity", 0)),
        ("concrete_damage", umat("concrete_damage", 0)),
        ("concrete_damage, many states", umat("concrete_damage", MANY_STATES)),
        ("bond_slip", uinter()),
    ];
    let mut plain: Vec<_> = laws.iter().map(|(_, maker)| maker()).collect();
    let file = tempfile::tempfile().expect("a file");
    let recording = recorder::Recording::create(&file).expect("room");
    recorder::install(&file).expect("the first recorder of this process");
    let mut recorded: Vec<_> = laws.iter().map(|(_, maker)| maker()).collect();
    println!("ns a call, lowest decile of {REPEATS} repeats of {calls} calls; accepted: +{ACCEPTED_NANOSECONDS} ns");
    println!("{:<30} {:>10} {:>10} {:>10}", "law", "plain", "recorded", "surcharge");
    let mut worst = 0.0_f64;
    for (k, (name, _)) in laws.iter().enumerate() {
        let mut nanoseconds = [const { Vec::new() }; 2];
        for _ in 0..REPEATS {
            nanoseconds[0].push(time(calls, &mut plain[k]));
            nanoseconds[1].push(time(calls, &mut recorded[k]));
        }
        let [without, with] = nanoseconds.map(undisturbed);
        worst = worst.max(with - without);
        println!("{name:<30} {without:>10.1} {with:>10.1} {:>+10.1}", with - without);
    }
    assert_eq!(recording.calls(), (laws.len() * REPEATS * calls) as u64, "every call was counted");
    if is_bench && worst > ACCEPTED_NANOSECONDS {
        println!("TOO MUCH");
        std::process::exit(1);
    }
}

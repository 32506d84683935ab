//! `pullout_umat_batch_v1` of each law.

use super::{Changes, Fenced, GARBAGE};
use super::{apply, changes, count, factors, is_accepted, nullify, nulls, number, scale};
use end_to_end_tests::{LAWS, Sample, fuzz, plugin};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use std::sync::LazyLock;
use umat_abi::batch::{BatchArguments, UmatBatch};
use umat_abi::host::{Library, Validation};
use umat_abi::law::StressState;
use umat_abi::metadata::{BATCH_SYMBOL, batch_results};

/// Points of a small batch.
const FEW: usize = 8;

/// Each law's library for its description, once more for its batch function, and that.
static LIBRARIES: LazyLock<Vec<(Library, libloading::Library, UmatBatch)>> = LazyLock::new(|| {
    let open = |law: &Sample| {
        let path = plugin(law.name);
        let described = end_to_end_tests::open(&path);
        // SAFETY: a plugin of ours: nothing but a panic hook is set when it is loaded.
        let library = unsafe { libloading::Library::new(&path) }.expect("the same plugin");
        // SAFETY: the symbol is the function that the contract defines; the library stays loaded as long as the program runs.
        let function = *unsafe { library.get::<UmatBatch>(BATCH_SYMBOL) }.expect("a batch function");
        (described, library, function)
    };
    LAWS.iter().map(open).collect()
});

/// STATUS before the call: no result.
const NO_STATUS: i32 = -77;

/// A call.
#[derive(Clone, Debug)]
struct Call {
    law: usize,
    points: usize,
    counts: [i32; 2],
    nstatv: i32,
    nprops: i32,
    factors: Changes,
    props: Changes,
    /// Changes of strains, increments, stresses, states and lengths of all points.
    arrays: [Changes; 5],
    strains: Vec<f64>,
    nulls: Vec<Index>,
}

fn call() -> impl Strategy<Value = Call> {
    (0..LAWS.len(), select(&Sample::STRESS_STATES[..])).prop_flat_map(|(law, stress_state)| {
        let sample = &LAWS[law];
        let (ntens, ndi, _) = stress_state.counts();
        (
            0..3 * FEW,
            [count(ntens), count(ndi)],
            count(sample.states as i32),
            count(sample.props.len() as i32),
            factors(),
            changes(),
            [(); 5].map(|()| changes()),
            vec(number(sample.strain), 7),
            nulls(),
        )
            .prop_map(move |(points, counts, nstatv, nprops, factors, props, arrays, strains, nulls)| Call {
                law,
                points,
                counts,
                nstatv,
                nprops,
                factors,
                props,
                arrays,
                strains,
                nulls,
            })
    })
}

/// The pointers among the arguments, in their order; the number of them.
fn null(arguments: &mut BatchArguments, which: usize) -> usize {
    nullify!(arguments, which, [props, strain, dstrain, stress, statev, ddsdde, celent, status])
}

fn check(call: &Call) {
    let (library, _, function) = &LIBRARIES[call.law];
    let sample = &LAWS[call.law];
    let n = call.points;
    let [ntens, ndi] = call.counts;
    // arrays are as long as their counts say, as far as memory goes
    let length = |given: i32, most: usize| usize::try_from(given).map_or(0, |given| given.min(most));
    let rows = if (1..=6).contains(&ntens) { ntens as usize } else { 6 };
    let nprops = call.nprops.min(64);
    let mut props: Vec<f64> = (0..length(nprops, 64)).map(|k| sample.props.get(k).copied().unwrap_or(1.0)).collect();
    scale(&call.factors, &mut props);
    apply(&call.props, &mut props);
    let cycle = |count: usize| call.strains.iter().copied().cycle().take(count).collect::<Vec<f64>>();
    let states = length(call.nstatv, 80);
    let mut arrays = [cycle(n * rows), cycle(n * rows), vec![0.1; n * rows], vec![0.0; n * states], vec![10.0; n]];
    for (array, changes) in arrays.iter_mut().zip(&call.arrays) {
        apply(changes, array);
    }
    let [strain, dstrain, stress, statev, celent] = arrays;
    let mut inputs = [&strain, &dstrain, &celent, &props].map(|values| Fenced::new(values));
    let mut outputs = [&stress, &statev, &vec![GARBAGE; n * rows * rows]].map(|values| Fenced::new(values));
    let before = [inputs.each_ref().map(Fenced::bits).to_vec(), outputs.each_ref().map(Fenced::bits).to_vec()];
    let mut status = vec![NO_STATUS; n + 2];
    let mut arguments = {
        let [strain, dstrain, celent, props] = inputs.each_mut().map(|input| input.pointer().cast_const());
        let [stress, statev, ddsdde] = outputs.each_mut().map(Fenced::pointer);
        let nstatv = call.nstatv;
        let status = status[1..].as_mut_ptr();
        BatchArguments { n, ntens, ndi, props, nprops, strain, dstrain, stress, statev, nstatv, ddsdde, celent, status }
    };
    let pointers = null(&mut arguments.clone(), usize::MAX);
    for which in &call.nulls {
        null(&mut arguments, which.index(pointers));
    }
    let a = &arguments;
    // SAFETY: every pointer is NULL or valid for the sizes that the counts give.
    unsafe {
        function(
            a.n, a.ntens, a.ndi, a.props, a.nprops, a.strain, a.dstrain, a.stress, a.statev, a.nstatv, a.ddsdde,
            a.celent, a.status,
        );
    }

    let context = || format!("{} with {props:?}, status {status:?}", sample.name);
    assert!(inputs.iter().chain(&outputs).all(Fenced::is_intact), "written around an array: {}", context());
    assert_eq!(inputs.each_ref().map(Fenced::bits).to_vec(), before[0], "an input was written: {}", context());
    assert_eq!([status[0], status[n + 1]], [NO_STATUS; 2], "written around STATUS: {}", context());
    let sound = [a.props, a.strain, a.dstrain, a.stress.cast_const(), a.statev.cast_const()]
        .iter()
        .all(|pointer| !pointer.is_null())
        && StressState::from_counts(ntens, ndi, ntens.wrapping_sub(ndi)).is_some()
        && states >= sample.states;
    let of_point = |array: usize, k: usize, rows: usize| -> (Vec<f64>, bool) {
        let values: Vec<f64> = (0..rows).map(|row| outputs[array].values()[row * n + k]).collect();
        let same = (0..rows).all(|row| values[row].to_bits() == before[1][array][row * n + k]);
        (values, same)
    };
    let changed = !call.props.is_empty() || !call.factors.is_empty();
    for k in 0..n {
        let length = (!a.celent.is_null()).then_some(celent[k]);
        let described = &library.laws()[0];
        let accepted = sound && is_accepted(&described.validate(&props, None));
        // a length is checked at a point's first call; α of inelastic_damage for the dimension of the stress state
        let validation = described.validate(&props, length);
        let lacks_length = matches!(validation, Validation::NeedsCharacteristicLength(_));
        let may_be_refused = !is_accepted(&validation) || sample.name == "inelastic_damage" && changed;
        let strains = (0..rows).all(|row| (strain[row * n + k] + dstrain[row * n + k]).is_finite());
        let finite = strains && (0..sample.states.min(states)).all(|row| statev[row * n + k].is_finite());
        let (stress, stress_kept) = of_point(0, k, rows);
        let (states, states_kept) = of_point(1, k, states);
        let (tangent, tangent_kept) = of_point(2, k, rows * rows);
        let numbers = |values: &[f64]| values.iter().all(|x| x.is_finite() && *x != GARBAGE);
        let spoilt = |values: &[f64], pointer: *mut f64, kept: bool| {
            if pointer.is_null() || !(1..=6).contains(&ntens) { kept } else { values.iter().all(|x| x.is_nan()) }
        };
        let done = numbers(&stress)
            && numbers(&states[..sample.states.min(states.len())])
            && if a.ddsdde.is_null() { tangent_kept } else { numbers(&tangent) };
        let refused = states_kept && spoilt(&stress, a.stress, stress_kept) && spoilt(&tangent, a.ddsdde, tangent_kept);
        // without STATUS the stress shows a cut-back
        let kept = if a.status.is_null() { refused } else { stress_kept && states_kept && tangent_kept };
        let has_status = |result: i32| a.status.is_null() || status[k + 1] == result;
        let well = match (accepted, finite) {
            (false, true) => refused && has_status(batch_results::REFUSED),
            (false, false) => {
                refused && has_status(batch_results::REFUSED) || kept && has_status(batch_results::CUT_BACK)
            }
            (true, false) => kept && has_status(batch_results::CUT_BACK),
            (true, true) if lacks_length => refused && has_status(batch_results::REFUSED),
            (true, true) => {
                done && has_status(batch_results::DONE)
                    || kept && has_status(batch_results::CUT_BACK)
                    || may_be_refused && refused && has_status(batch_results::REFUSED)
            }
        };
        assert!(well, "point {k} of {n}: {stress:?} {states:?} {tangent:?}, {}", context());
    }
}

proptest! {
    #![proptest_config(fuzz::config(2000))]

    #[test]
    fn any_batch_does_no_harm(call in call()) {
        check(&call);
    }
}

//! UMAT, of each law's own library and of the one of all laws.

use super::{Answer, Changes, Fenced, GARBAGE, Output};
use super::{apply, changes, count, factors, is_accepted, judge, name, nullify, nulls, number, pnewdt, scale};
use crate::Loaded;
use end_to_end_tests::{LAWS, PointMemory, Sample, fuzz, plugin, strain_path};
use proptest::prelude::*;
use proptest::sample::{Index, select};
use std::ffi::c_char;
use std::sync::LazyLock;
use umat_abi::host::{Library, Validation};
use umat_abi::law::StressState;
use umat_abi::umat::{UmatArguments, UmatFunction};

/// The laws' own libraries.
static OWN: LazyLock<Vec<Loaded>> = LazyLock::new(|| LAWS.iter().map(Loaded::new).collect());
/// The library of all laws, which goes by CMNAME.
static ALL: LazyLock<(Library, UmatFunction)> = LazyLock::new(|| {
    let library = end_to_end_tests::open(&plugin("pullout_laws"));
    let umat = library.umat(None).expect("umat_");
    (library, umat)
});

/// A call.
#[derive(Clone, Debug)]
struct Call {
    law: usize,
    stress_state: StressState,
    by_name: bool,
    name: Vec<u8>,
    counts: [i32; 3],
    nstatv: i32,
    nprops: i32,
    factors: Changes,
    props: Changes,
    /// Increments of a path before, from the virgin state.
    history: usize,
    statev: Changes,
    stress: Changes,
    strain: [f64; 6],
    increment: [f64; 6],
    celent: f64,
    rotation: Changes,
    pnewdt: f64,
    nulls: Vec<Index>,
}

fn call() -> impl Strategy<Value = Call> {
    (0..LAWS.len(), select(&Sample::STRESS_STATES[..])).prop_flat_map(|(law, stress_state)| {
        let sample = &LAWS[law];
        let (ntens, ndi, nshr) = stress_state.counts();
        let strains = || [(); 6].map(|()| number(sample.strain));
        let scalars = (
            any::<bool>(),
            name(sample.name),
            [count(ntens), count(ndi), count(nshr)],
            count(sample.states as i32),
            count(sample.props.len() as i32),
        );
        let arrays = (factors(), changes(), 0..8_usize, changes(), changes(), strains(), strains());
        let rest = (number(100.0), changes(), pnewdt(), nulls());
        (scalars, arrays, rest).prop_map(
            move |(
                (by_name, name, counts, nstatv, nprops),
                (factors, props, history, statev, stress, strain, increment),
                (celent, rotation, pnewdt, nulls),
            )| Call {
                law,
                stress_state,
                by_name,
                name,
                counts,
                nstatv,
                nprops,
                factors,
                props,
                history,
                statev,
                stress,
                strain,
                increment,
                celent,
                rotation,
                pnewdt,
                nulls,
            },
        )
    })
}

/// The pointers among the arguments, in their order; the number of them.
fn null(arguments: &mut UmatArguments, which: usize) -> usize {
    nullify!(
        arguments,
        which,
        [
            stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp,
            dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent,
            dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, kinc,
        ]
    )
}

/// The state variables after some increments with the sample's parameters.
fn states_after(loaded: &Loaded, stress_state: StressState, increments: usize) -> PointMemory {
    let mut point = PointMemory::new(loaded.law, stress_state);
    for increment in strain_path(7, point.ntens(), loaded.law.strain, increments) {
        point.advance(loaded.umat, &increment);
    }
    point
}

/// Returns so many numbers: those of `values`, then `filler`.
fn resized(values: &[f64], length: usize, filler: f64) -> Vec<f64> {
    (0..length).map(|k| values.get(k).copied().unwrap_or(filler)).collect()
}

fn check(call: &Call) {
    let loaded = &OWN[call.law];
    let law = loaded.law;
    let [ntens, ndi, nshr] = call.counts;
    // arrays are as long as their counts say, as far as memory goes
    let length = |given: i32, most: usize| usize::try_from(given).map_or(0, |given| given.min(most));
    let components = if (1..=6).contains(&ntens) { ntens as usize } else { 6 };
    let start = states_after(loaded, call.stress_state, call.history);
    let mut statev = resized(&start.statev, length(call.nstatv, 80), -3.5);
    apply(&call.statev, &mut statev);
    let mut stress = start.stress[..components].to_vec();
    apply(&call.stress, &mut stress);
    // no more parameters than there is memory for: a host that lies about that cannot be helped
    let nprops = call.nprops.min(64);
    let mut props = resized(law.props, length(nprops, 64), 1.0);
    scale(&call.factors, &mut props);
    apply(&call.props, &mut props);
    let mut rotation = start.drot;
    apply(&call.rotation, &mut rotation);

    let refusable = if (1..=6).contains(&ntens) { components } else { 0 };
    let state_count = law.states.min(statev.len());
    // others leave their heat as it was
    let [scalar, vector] = if law.is_coupled() { [1, components] } else { [0, 0] };
    let mut outputs = [
        Output::new("STRESS", &stress, components, refusable),
        Output::new("DDSDDE", &vec![GARBAGE; components * components], components * components, refusable * refusable),
        Output::new("STATEV", &statev, state_count, 0),
        Output::new("SSE", &[GARBAGE], 1, 0),
        Output::new("SPD", &[GARBAGE], 1, 0),
        Output::new("SCD", &[GARBAGE], 1, 0),
        Output::new("RPL", &[GARBAGE], scalar, 0),
        Output::new("DDSDDT", &vec![GARBAGE; components], vector, 0),
        Output::new("DRPLDE", &vec![GARBAGE; components], vector, 0),
        Output::new("DRPLDT", &[GARBAGE], scalar, 0),
    ];
    let [stran, dstran] = [&call.strain, &call.increment].map(|values| values[..components].to_vec());
    let mut inputs = [&stran[..], &dstran, &props, &rotation, &[call.celent]].map(Fenced::new);
    let before = inputs.each_ref().map(Fenced::bits);
    let mut reached = Fenced::new(&[call.pnewdt]);

    // the rest of the arguments
    let mut point = PointMemory::new(law, call.stress_state);
    let mut arguments = point.arguments();
    let integers = [ntens, ndi, nshr, call.nstatv, nprops];
    let name: Vec<u8> = call.name.clone();
    {
        let [stress, ddsdde, statev, sse, spd, scd, rpl, ddsddt, drplde, drpldt] =
            outputs.each_mut().map(|output| output.memory.pointer());
        let [stran, dstran, props, drot, celent] = inputs.each_mut().map(|input| input.pointer().cast_const());
        let [ntens, ndi, nshr, nstatv, nprops] = integers.each_ref().map(std::ptr::from_ref);
        arguments = UmatArguments {
            stress,
            ddsdde,
            statev,
            sse,
            spd,
            scd,
            rpl,
            ddsddt,
            drplde,
            drpldt,
            stran,
            dstran,
            props,
            drot,
            celent,
            ntens,
            ndi,
            nshr,
            nstatv,
            nprops,
            pnewdt: reached.pointer(),
            cmname: name.as_ptr().cast::<c_char>(),
            cmname_length: name.len(),
            ..arguments
        };
    }
    let pointers = null(&mut arguments.clone(), usize::MAX);
    for which in &call.nulls {
        null(&mut arguments, which.index(pointers));
    }

    let a = &arguments;
    for (output, pointer) in
        outputs.iter_mut().zip([a.stress, a.ddsdde, a.statev, a.sse, a.spd, a.scd, a.rpl, a.ddsddt, a.drplde, a.drpldt])
    {
        output.given = !pointer.is_null();
    }
    if a.ntens.is_null() {
        outputs.iter_mut().for_each(|output| output.spoilt = 0);
    }
    let function = if call.by_name { ALL.1 } else { loaded.umat };
    // SAFETY: every pointer is NULL or valid for the sizes that the counts give, as far as a law may use it; the name is padded,
    // NUL-terminated or has 80 bytes.
    unsafe { arguments.call(function) };

    let needed = [a.stress.cast_const(), a.statev.cast_const(), a.stran, a.dstran, a.props];
    let counted = [a.ntens, a.ndi, a.nshr, a.nstatv, a.nprops];
    let present = needed.iter().all(|pointer| !pointer.is_null()) && counted.iter().all(|pointer| !pointer.is_null());
    let named = !call.by_name || !a.cmname.is_null() && names(&name, law.name);
    let described = &loaded.library.laws()[0];
    let length = (!a.celent.is_null()).then_some(call.celent);
    // a length is checked at a point's first call; α of inelastic_damage for the dimension of the stress state
    let changed = !call.props.is_empty() || !call.factors.is_empty();
    let validation = described.validate(&props, length);
    let may_be_refused = !is_accepted(&validation) || law.name == "inelastic_damage" && changed;
    let lacks_length = matches!(validation, Validation::NeedsCharacteristicLength(_));
    let sound = present
        && named
        && StressState::from_counts(ntens, ndi, nshr).is_some()
        && statev.len() >= law.states
        && is_accepted(&described.validate(&props, None));
    let strain_is_finite = stran.iter().zip(&dstran).all(|(a, b)| (a + b).is_finite());
    let turned = described.states.iter().any(|state| state.tensor_component > 0) && !a.drot.is_null();
    let finite = strain_is_finite
        && statev[..state_count].iter().all(|x| x.is_finite())
        && (!turned || rotation.iter().all(|x| x.is_finite()));
    let allowed: &[Answer] = match (sound, finite) {
        (false, true) => &[Answer::Refused],
        (false, false) => &[Answer::Refused, Answer::Untouched],
        (true, false) => &[Answer::Untouched],
        (true, true) if lacks_length => &[Answer::Refused],
        (true, true) if may_be_refused => &[Answer::Done, Answer::Untouched, Answer::Refused],
        (true, true) => &[Answer::Done, Answer::Untouched],
    };
    let pnewdt = (!a.pnewdt.is_null()).then(|| [call.pnewdt, reached.values()[0]]);
    judge(&outputs, pnewdt, allowed, &|| format!("{} with {props:?}, {statev:?}", law.name));
    assert!(reached.is_intact(), "written around PNEWDT");
    assert!(
        inputs.iter().all(Fenced::is_intact) && inputs.each_ref().map(Fenced::bits) == before,
        "an input was written"
    );
    assert_eq!((name, integers), (call.name.clone(), [ntens, ndi, nshr, call.nstatv, nprops]), "an input was written");
}

/// Returns whether a name begins with this law's and no longer one.
fn names(name: &[u8], law: &str) -> bool {
    let begins = |law: &str| {
        let blanks = name.iter().take_while(|byte| **byte == b' ').count();
        name[blanks..].to_ascii_lowercase().starts_with(law.as_bytes())
    };
    begins(law) && LAWS.iter().all(|other| other.name.len() <= law.len() || !begins(other.name))
}

proptest! {
    #![proptest_config(fuzz::config(4000))]

    #[test]
    fn any_arguments_do_no_harm(call in call()) {
        check(&call);
    }
}

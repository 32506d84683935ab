//! UINTER and FRIC of the bond law, of its own library and of the one of all laws.

use super::{Answer, Changes, Fenced, GARBAGE, Output};
use super::{apply, changes, count, factors, is_accepted, judge, name, nullify, nulls, number, pnewdt, scale};
use end_to_end_tests::{fuzz, plugin};
use proptest::prelude::*;
use proptest::sample::Index;
use std::ffi::c_char;
use std::sync::LazyLock;
use umat_abi::fric::FricArguments;
use umat_abi::host::{LawDescription, Library, Validation};
use umat_abi::uinter::UinterArguments;

const LAW: &str = "bond_slip";
/// Opening slips, mm.
const SLIP: f64 = 0.05;

/// The law's own library, and the one that goes by CINAME.
static LIBRARIES: LazyLock<[Library; 2]> =
    LazyLock::new(|| [LAW, "pullout_laws"].map(|name| end_to_end_tests::open(&plugin(name))));

fn law() -> &'static LawDescription {
    &LIBRARIES[0].laws()[0]
}

/// A call of either routine.
#[derive(Clone, Debug)]
struct Call {
    by_name: bool,
    name: Vec<u8>,
    directions: i32,
    nstatv: i32,
    nprops: Option<i32>,
    /// Laws A, B and none; powers or points; hard or soft.
    forms: [f64; 3],
    points: usize,
    factors: Changes,
    props: Changes,
    statev: Changes,
    virgin: bool,
    traction: Changes,
    displacement: [f64; 3],
    increment: [f64; 3],
    pressure: f64,
    lm: i32,
    pnewdt: f64,
    nulls: Vec<Index>,
}

fn call(most_directions: i32) -> impl Strategy<Value = Call> {
    let forms = (0..3_u8, 0..2_u8, 0..2_u8).prop_map(|(a, b, c)| [a, b, c].map(f64::from));
    let displacements = || [(); 3].map(|()| number(SLIP));
    let scalars = (
        any::<bool>(),
        name(LAW),
        (1..=most_directions).prop_flat_map(count),
        count(12),
        prop_oneof![6 => Just(None), 1 => any::<i32>().prop_map(Some), 1 => (-1..30_i32).prop_map(Some)],
        prop_oneof![5 => Just(1), 1 => Just(2), 1 => any::<i32>()],
    );
    let arrays = (forms, 0..4_usize, factors(), changes(), changes(), any::<bool>(), changes());
    let rest = (displacements(), displacements(), number(20.0), pnewdt(), nulls());
    (scalars, arrays, rest).prop_map(
        |(
            (by_name, name, directions, nstatv, nprops, lm),
            (forms, points, factors, props, statev, virgin, traction),
            (displacement, increment, pressure, pnewdt, nulls),
        )| Call {
            by_name,
            name,
            directions,
            nstatv,
            nprops,
            forms,
            points,
            factors,
            props,
            statev,
            virgin,
            traction,
            displacement,
            increment,
            pressure,
            lm,
            pnewdt,
            nulls,
        },
    )
}

/// Arguments of both routines.
struct Prepared {
    /// Within the range of the routine, or as much as there may be.
    directions: usize,
    props: Vec<f64>,
    statev: Vec<f64>,
    traction: Vec<f64>,
    /// Directions, NSTATV, NPROPS.
    integers: [i32; 3],
}

impl Call {
    fn prepare(&self, most_directions: usize) -> Prepared {
        let directions =
            usize::try_from(self.directions).ok().filter(|n| (1..=3).contains(n)).unwrap_or(most_directions);
        let fixed = law().parameters.len() - 2;
        let mut props: Vec<f64> = law().parameters[..fixed].iter().map(|parameter| parameter.default_value).collect();
        props[..3].copy_from_slice(&self.forms);
        // the role of the penalties is filled in by hosts, g_0 by nobody
        for (parameter, value) in law().parameters.iter().zip(&mut props) {
            match parameter.name.as_str() {
                "normal_stiffness" | "k_f" if *value == 0.0 => *value = 1e4,
                "g_0" if *value == 0.0 => *value = 0.1,
                _ => {}
            }
        }
        props[fixed - 1] = self.points as f64;
        for k in 0..self.points {
            props.extend([0.02 * k as f64 + 0.01, 5.0 / (1.0 + k as f64)]);
        }
        scale(&self.factors, &mut props);
        apply(&self.props, &mut props);
        let nprops = self.nprops.unwrap_or(props.len() as i32);
        let memory = usize::try_from(nprops).map_or(0, |given| given.min(64));
        props.resize(memory, 1.0);
        let states = usize::try_from(self.nstatv).map_or(0, |given| given.min(80));
        // slip, side, the largest slip and so on, of a point that has slid
        let slid = [0.02, 0.01, 1.0, 0.03, 0.01, 0.005, 0.01, 0.0, 0.0, 0.001, 0.3, 0.1];
        let mut statev: Vec<f64> =
            (0..states).map(|k| if self.virgin { 0.0 } else { slid.get(k).copied().unwrap_or(-3.5) }).collect();
        apply(&self.statev, &mut statev);
        let mut traction = vec![0.1; directions];
        apply(&self.traction, &mut traction);
        // no more parameters than there is memory for: a host that lies about that cannot be helped
        let integers = [self.directions, self.nstatv, nprops.min(64)];
        Prepared { directions, props, statev, traction, integers }
    }

    /// The law's library, or the one of all laws; whether the name is enough for it.
    fn library(&self, name: *const c_char) -> (&'static Library, bool) {
        let library = &LIBRARIES[usize::from(self.by_name)];
        let blanks = self.name.iter().take_while(|byte| **byte == b' ').count();
        let begins = self.name[blanks..].to_ascii_lowercase().starts_with(LAW.as_bytes());
        (library, !self.by_name || !name.is_null() && begins)
    }
}

fn allowed(sound: bool, validation: &Validation, finite: bool, may_refuse: bool) -> &'static [Answer] {
    match (sound && is_accepted(validation), finite) {
        (false, true) => &[Answer::Refused],
        (false, false) => &[Answer::Refused, Answer::Untouched],
        (true, false) if may_refuse => &[Answer::Refused, Answer::Untouched],
        (true, false) => &[Answer::Untouched],
        (true, true) if may_refuse => &[Answer::Done, Answer::Untouched, Answer::Refused],
        (true, true) => &[Answer::Done, Answer::Untouched],
    }
}

/// The pointers among the arguments, in their order; the number of them.
fn null_of_uinter(arguments: &mut UinterArguments, which: usize) -> usize {
    nullify!(
        arguments,
        which,
        [
            stress,
            ddsddr,
            dviscous,
            dstructural,
            flux,
            ddfddt,
            ddsddt,
            ddfddr,
            statev,
            sed,
            sfd,
            spd,
            svd,
            scd,
            pnewdt,
            rdisp,
            drdisp,
            temp,
            dtemp,
            predef,
            dpred,
            time,
            dtime,
            freqr,
            ciname,
            slname,
            msname,
            props,
            coords,
            alocaldir,
            drot,
            area,
            chrlngth,
            node,
            ndir,
            nstatv,
            npred,
            nprops,
            mcrd,
            kstep,
            kinc,
            kit,
            linper,
            lopenclose,
            lstate,
            lsdi,
            lprint,
        ]
    )
}

fn check_uinter(call: &Call) {
    let Prepared { directions: n, props, statev, traction, integers } = call.prepare(3);
    let refusable = if (1..=3).contains(&call.directions) { n } else { 0 };
    let mut outputs = [
        Output::new("STRESS", &traction, n, refusable),
        Output::new("DDSDDR", &vec![GARBAGE; n * n], n * n, refusable * refusable),
        Output::new("STATEV", &statev, law().states.len().min(statev.len()), 0),
        Output::new("SED", &[GARBAGE], 1, 0),
        Output::new("SFD", &[GARBAGE], 1, 0),
        Output::new("SPD", &[GARBAGE], 1, 0),
        Output::new("SVD", &[GARBAGE], 1, 0),
        Output::new("SCD", &[GARBAGE], 1, 0),
        Output::new("DVISCOUS", &vec![GARBAGE; n * n], 0, 0),
        Output::new("DSTRUCTURAL", &vec![GARBAGE; n * n], 0, 0),
        Output::new("FLUX", &[GARBAGE; 2], 0, 0),
        Output::new("DDFDDT", &[GARBAGE; 4], 0, 0),
        Output::new("DDSDDT", &vec![GARBAGE; 2 * n], 0, 0),
        Output::new("DDFDDR", &vec![GARBAGE; 2 * n], 0, 0),
    ];
    let mut inputs = [&call.displacement[..n], &call.increment[..n], &props].map(Fenced::new);
    let before = inputs.each_ref().map(Fenced::bits);
    let mut reached = Fenced::new(&[call.pnewdt]);
    let (zeros, ones, mut flags) = ([0.0; 9], [1; 8], [-1; 3]);
    let (number, integer) = (zeros.as_ptr(), ones.as_ptr());
    let mut arguments = {
        let [stress, ddsddr, statev, sed, sfd, spd, svd, scd, dviscous, dstructural, flux, ddfddt, ddsddt, ddfddr] =
            outputs.each_mut().map(|output| output.memory.pointer());
        let [rdisp, drdisp, props] = inputs.each_mut().map(|input| input.pointer().cast_const());
        let [ndir, nstatv, nprops] = integers.each_ref().map(std::ptr::from_ref);
        let [lopenclose, lstate, lsdi] = flags.each_mut().map(std::ptr::from_mut);
        let names = call.name.as_ptr().cast::<c_char>();
        UinterArguments {
            stress,
            ddsddr,
            dviscous,
            dstructural,
            flux,
            ddfddt,
            ddsddt,
            ddfddr,
            statev,
            sed,
            sfd,
            spd,
            svd,
            scd,
            pnewdt: reached.pointer(),
            rdisp,
            drdisp,
            temp: number,
            dtemp: number,
            predef: number,
            dpred: number,
            time: number,
            dtime: number,
            freqr: number,
            ciname: names,
            slname: names,
            msname: names,
            props,
            coords: number,
            alocaldir: number,
            drot: number,
            area: number,
            chrlngth: number,
            node: integer,
            ndir,
            nstatv,
            npred: integer,
            nprops,
            mcrd: integer,
            kstep: integer,
            kinc: integer,
            kit: integer,
            linper: integer,
            lopenclose,
            lstate,
            lsdi,
            lprint: integer,
            ciname_length: call.name.len(),
            slname_length: call.name.len(),
            msname_length: call.name.len(),
        }
    };
    let pointers = null_of_uinter(&mut arguments.clone(), usize::MAX);
    for which in &call.nulls {
        null_of_uinter(&mut arguments, which.index(pointers));
    }
    let a = &arguments;
    let given = [
        a.stress,
        a.ddsddr,
        a.statev,
        a.sed,
        a.sfd,
        a.spd,
        a.svd,
        a.scd,
        a.dviscous,
        a.dstructural,
        a.flux,
        a.ddfddt,
        a.ddsddt,
        a.ddfddr,
    ];
    mark(&mut outputs, &given, a.ndir.is_null());
    let (library, named) = call.library(a.ciname);
    let function = library.uinter(None).expect("uinter_");
    // SAFETY: every pointer is NULL or valid for the sizes that the counts give, as far as a law may use it; the name is padded,
    // NUL-terminated or has 80 bytes.
    unsafe { arguments.call(function) };

    let needed = [a.stress.cast_const(), a.statev.cast_const(), a.rdisp, a.drdisp, a.props];
    let sound = named
        && refusable > 0
        && statev.len() >= law().states.len()
        && needed.iter().all(|pointer| !pointer.is_null())
        && [a.ndir, a.nstatv, a.nprops].iter().all(|pointer| !pointer.is_null());
    let displacements = call.displacement[..n].iter().chain(&call.increment[..n]);
    let states = statev.iter().take(law().states.len());
    let finite = displacements.chain(states).all(|x| x.is_finite());
    // hard contact without a penalty, for which a host would fill in its own
    let may_refuse = props.get(3) == Some(&0.0);
    let allowed = allowed(sound, &law().validate(&props, None), finite, may_refuse);
    let pnewdt = (!a.pnewdt.is_null()).then(|| [call.pnewdt, reached.values()[0]]);
    judge(&outputs, pnewdt, allowed, &|| format!("UINTER with {props:?}, {statev:?}"));
    assert!(reached.is_intact() && inputs.iter().all(Fenced::is_intact) && flags == [-1; 3]);
    assert_eq!(inputs.each_ref().map(Fenced::bits), before, "an input was written");
}

/// Notes which outputs the call is given.
fn mark(outputs: &mut [Output], given: &[*mut f64], countless: bool) {
    for (output, pointer) in outputs.iter_mut().zip(given) {
        output.given = !pointer.is_null();
        if countless {
            output.spoilt = 0;
        }
    }
}

/// The pointers among the arguments, in their order; the number of them.
fn null_of_fric(arguments: &mut FricArguments, which: usize) -> usize {
    nullify!(
        arguments,
        which,
        [
            lm, tau, ddtddg, ddtddp, dslip, sed, sfd, ddtddt, pnewdt, statev, dgam, taulm, press, dpress, ddpddh, slip,
            kstep, kinc, time, dtime, noel, ciname, slname, msname, npt, node, npatch, coords, rcoord, drot, temp,
            predef, nfdir, mcrd, npred, nstatv, chrlngth, props, nprops,
        ]
    )
}

/// LM of a point that is open: nothing is asked of the law.
const OPEN: i32 = 2;

fn check_fric(call: &Call) {
    let Prepared { directions: n, props, statev, traction, integers } = call.prepare(2);
    let refusable = if (1..=3).contains(&call.directions) { n } else { 0 };
    let mut outputs = [
        Output::new("TAU", &traction, n, refusable),
        Output::new("DDTDDG", &vec![GARBAGE; n * n], n * n, refusable * refusable),
        Output::new("STATEV", &statev, law().states.len().min(statev.len()), 0),
        Output::new("DDTDDP", &vec![GARBAGE; n], n, 0),
        Output::new("DSLIP", &vec![GARBAGE; n], n, 0),
        Output::new("SED", &[GARBAGE], 1, 0),
        Output::new("SFD", &[GARBAGE], 1, 0),
        Output::new("DDTDDT", &vec![GARBAGE; 2 * n], 0, 0),
    ];
    let mut inputs = [&call.increment[..n], &[call.pressure], &props].map(Fenced::new);
    let before = inputs.each_ref().map(Fenced::bits);
    let mut reached = Fenced::new(&[call.pnewdt]);
    let (zeros, ones, mut lm) = ([0.0; 9], [1; 8], [call.lm, 77]);
    let (number, integer) = (zeros.as_ptr(), ones.as_ptr());
    let mut arguments = {
        let [tau, ddtddg, statev, ddtddp, dslip, sed, sfd, ddtddt] =
            outputs.each_mut().map(|output| output.memory.pointer());
        let [dgam, press, props] = inputs.each_mut().map(|input| input.pointer().cast_const());
        let [nfdir, nstatv, nprops] = integers.each_ref().map(std::ptr::from_ref);
        let names = call.name.as_ptr().cast::<c_char>();
        FricArguments {
            lm: lm.as_mut_ptr(),
            tau,
            ddtddg,
            ddtddp,
            dslip,
            sed,
            sfd,
            ddtddt,
            pnewdt: reached.pointer(),
            statev,
            dgam,
            taulm: number,
            press,
            dpress: number,
            ddpddh: number,
            slip: number,
            kstep: integer,
            kinc: integer,
            time: number,
            dtime: number,
            noel: integer,
            ciname: names,
            slname: names,
            msname: names,
            npt: integer,
            node: integer,
            npatch: integer,
            coords: number,
            rcoord: number,
            drot: number,
            temp: number,
            predef: number,
            nfdir,
            mcrd: integer,
            npred: integer,
            nstatv,
            chrlngth: number,
            props,
            nprops,
            ciname_length: call.name.len(),
            slname_length: call.name.len(),
            msname_length: call.name.len(),
        }
    };
    let pointers = null_of_fric(&mut arguments.clone(), usize::MAX);
    for which in &call.nulls {
        null_of_fric(&mut arguments, which.index(pointers));
    }
    let a = &arguments;
    mark(&mut outputs, &[a.tau, a.ddtddg, a.statev, a.ddtddp, a.dslip, a.sed, a.sfd, a.ddtddt], a.nfdir.is_null());
    let (library, named) = call.library(a.ciname);
    let function = library.fric(None).expect("fric_");
    // SAFETY: as for UINTER.
    unsafe { arguments.call(function) };

    let is_open = named && !a.lm.is_null() && call.lm == OPEN;
    if is_open {
        outputs.iter_mut().for_each(|output| output.written = 0);
    }
    let needed = [a.tau.cast_const(), a.statev.cast_const(), a.dgam, a.press, a.props];
    let sound = named
        && (1..=2).contains(&call.directions)
        && statev.len() >= law().states.len()
        && needed.iter().all(|pointer| !pointer.is_null())
        && [a.nfdir, a.nstatv, a.nprops].iter().all(|pointer| !pointer.is_null());
    let slips = call.increment[..n].iter().chain([&call.pressure]);
    let finite = slips.chain(statev.iter().take(law().states.len())).all(|x| x.is_finite());
    let validation = law().validate(&props, None);
    let allowed = if is_open { &[Answer::Done] } else { allowed(sound, &validation, finite, false) };
    let pnewdt = (!a.pnewdt.is_null()).then(|| [call.pnewdt, reached.values()[0]]);
    judge(&outputs, pnewdt, allowed, &|| format!("FRIC with {props:?}, {statev:?}"));
    assert!(reached.is_intact() && inputs.iter().all(Fenced::is_intact) && lm[1] == 77);
    assert!(lm[0] == call.lm || lm[0] == 0 && allowed.contains(&Answer::Done), "LM {}", lm[0]);
    assert_eq!(inputs.each_ref().map(Fenced::bits), before, "an input was written");
}

proptest! {
    #![proptest_config(fuzz::config(4000))]

    #[test]
    fn any_arguments_of_uinter_do_no_harm(call in call(3)) {
        check_uinter(&call);
    }

    #[test]
    fn any_arguments_of_fric_do_no_harm(call in call(2)) {
        check_fric(&call);
    }
}

/// Slips beyond all measure: DSLIP was infinite in a call that was done.
#[test]
fn an_inelastic_slip_that_overflows_is_cut_back() {
    check_fric(&Call {
        by_name: false,
        name: b"bond_slip\0".to_vec(),
        directions: 1,
        nstatv: 12,
        nprops: None,
        forms: [1.0, 0.0, 0.0],
        points: 0,
        factors: Vec::new(),
        props: Vec::new(),
        // d of law B, which no update writes
        statev: vec![(10, 2.113_890_756_901_247_4e300)],
        virgin: false,
        traction: Vec::new(),
        displacement: [0.0; 3],
        increment: [1e16, 0.0, 0.0],
        pressure: 0.0,
        lm: 1,
        pnewdt: 1.0,
        nulls: Vec::new(),
    });
}

//! UMATs in Fortran and C, compiled here, and the plugin of the same law: our host drives both along one path.

use end_to_end_tests::{Tool, difference, find, plugin, run, strain_path, workspace, worst};
use std::path::PathBuf;
use umat_abi::host::{CallOutcome, Library, UmatCall};
use umat_abi::law::{Request, StressState};

/// Two formulations of one law differ by rounding alone.
const ROUNDING: f64 = 1e-12;

const STEEL: [f64; 2] = [210_000.0, 0.3];
const YIELD_STRESS: f64 = 347.0;
const HARDENING: f64 = 2100.0;
/// The plugin's hardening table ends here, far beyond the path.
const END_OF_TABLE: f64 = 10.0;

/// A source in `tests/umats/` and what it needs.
struct Foreign {
    source: &'static str,
    tool: Tool,
    flags: &'static [&'static str],
    props: Vec<f64>,
    states: usize,
}

/// Compiles a UMAT to a shared library that lives as long as the folder.
fn compile(foreign: &Foreign) -> Option<(tempfile::TempDir, PathBuf)> {
    let mut compiler = find(foreign.tool)?;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let library = folder.path().join("libforeign.so");
    run(compiler
        .args(["-shared", "-fPIC", "-O2", "-Wall"])
        .args(foreign.flags)
        .arg("-I")
        .arg(workspace("umat-abi/include"))
        .arg("-o")
        .arg(&library)
        .arg(workspace("tests/umats").join(foreign.source))
        .arg("-lm"));
    Some((folder, library))
}

fn compare(foreign: &Foreign, law: &str, props: &[f64], stress_state: StressState, strain: f64) {
    let Some((_folder, path)) = compile(foreign) else { return };
    let theirs = end_to_end_tests::open(&path);
    assert!(theirs.laws().is_empty(), "a plain UMAT describes nothing");
    let ours = end_to_end_tests::open(&plugin(law));
    let states = ours.laws()[0].states.len();
    let mut ours = UmatCall::new(&ours, None, law, stress_state, states, props).expect("umat_");
    let mut theirs =
        UmatCall::new(&theirs, None, law, stress_state, foreign.states, &foreign.props).expect("umat_ of the compiler");
    let (mut yielded, mut largest_stress) = (0, 0.0_f64);
    for (number, increment) in strain_path(99, ours.ntens(), strain, 400).iter().enumerate() {
        for call in [&mut ours, &mut theirs] {
            call.dstran = *increment;
            let outcome = call.call(Request::StressAndTangent).expect("no overrun");
            assert_eq!(outcome, CallOutcome::Done);
            for k in 0..6 {
                call.stran[k] += increment[k];
            }
        }
        // Stresses pass near zero where a path turns: what rounding leaves is relative to what the path reached.
        largest_stress = ours.stress().iter().fold(largest_stress, |m, x| m.max(x.abs()));
        let apart = worst(ours.stress().iter().zip(theirs.stress()).map(|(a, b)| (a - b).abs()));
        assert!(apart <= ROUNDING * largest_stress, "{}, {number}: stress {apart:e}", foreign.source);
        let tangents = difference(theirs.ddsdde(), ours.ddsdde());
        assert!(tangents <= ROUNDING, "{}, {number}: tangent {tangents:e}", foreign.source);
        yielded += usize::from(states > 2 && ours.statev()[0] > 0.0);
    }
    assert!(states == 2 || yielded > 300, "{}: the path is to yield", foreign.source);
    assert!(largest_stress > 10.0);
}

#[test]
fn elasticity_in_fixed_form_fortran() {
    let foreign = Foreign {
        source: "elastic.f",
        tool: Tool::Fortran,
        // NDI … KINC of the classic list are not used; that is what the warnings would say.
        flags: &["-Wno-unused-dummy-argument"],
        props: STEEL.to_vec(),
        states: 1,
    };
    for stress_state in [StressState::ThreeD, StressState::PlaneStrainOrAxisymmetric, StressState::PlaneStress] {
        compare(&foreign, "linear_elastic", &STEEL, stress_state, 1e-3);
    }
}

#[test]
fn elasticity_in_c() {
    let foreign = Foreign { source: "elastic.c", tool: Tool::C, flags: &["-Wextra"], props: STEEL.to_vec(), states: 1 };
    for stress_state in [StressState::ThreeD, StressState::PlaneStrainOrAxisymmetric] {
        compare(&foreign, "linear_elastic", &STEEL, stress_state, 1e-3);
    }
}

fn compare_plasticity(source: &'static str, tool: Tool, flags: &'static [&'static str]) {
    let [e, nu] = STEEL;
    let end = YIELD_STRESS + HARDENING * END_OF_TABLE;
    let ours = [e, nu, YIELD_STRESS, 0.0, end, END_OF_TABLE];
    let foreign = Foreign { source, tool, flags, props: vec![e, nu, YIELD_STRESS, HARDENING], states: 7 };
    for stress_state in [StressState::ThreeD, StressState::PlaneStrainOrAxisymmetric] {
        compare(&foreign, "j2_plasticity", &ours, stress_state, 1e-2);
    }
}

#[test]
fn plasticity_in_free_form_fortran() {
    compare_plasticity("j2.f90", Tool::Fortran, &["-std=f2008", "-Wno-unused-dummy-argument"]);
}

#[test]
fn plasticity_in_c() {
    compare_plasticity("j2.c", Tool::C, &["-Wextra"]);
}

/// Two libraries with a COMMON block and helpers of the same names, called in turn: each keeps its own.
#[test]
fn shared_names_do_not_disturb() {
    // what the sources include comes with the program: here it is written out
    let include = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(include.path().join("ABA_PARAM.INC"), "      implicit real*8 (a-h,o-z)\n").expect("a file");
    let library = |source: &str| {
        let mut compiler = find(Tool::Fortran)?;
        let folder = tempfile::tempdir().expect("a temporary folder");
        let library = folder.path().join("libshared.so");
        compiler.args(["-shared", "-fPIC", "-std=legacy", "-I"]).arg(include.path()).arg("-o").arg(&library);
        run(compiler.arg(workspace("tests/umats").join(source)));
        Some((folder, end_to_end_tests::open(&library)))
    };
    let (Some((_a, a)), Some((_b, b))) = (library("common_a.f"), library("common_b.f")) else { return };
    let call = |library: &Library| {
        UmatCall::new(library, None, "shared", StressState::ThreeD, 1, &STEEL).expect("umat_ of the compiler")
    };
    let mut calls = [call(&a), call(&b)];
    for number in 1..=50 {
        for (call, factor) in calls.iter_mut().zip([1.0, 3.0]) {
            call.dstran[0] = 1e-6;
            call.call(Request::StressAndTangent).expect("no overrun");
            let shear_modulus = factor * STEEL[0] / (2.0 * (1.0 + STEEL[1]));
            assert!((call.tangent(5, 5) - shear_modulus).abs() < ROUNDING * shear_modulus);
            assert_eq!(call.statev(), [f64::from(number)], "calls that its own COMMON has counted");
        }
    }
}

//! The laws in Fortran are the laws.

use super::super::Settings;
use super::super::solid::{Situation, solids};
use super::fortran::{self, Target};
use umat_abi::host::{CallOutcome, Library, UmatCall};
use umat_abi::law::{Request, StressState};

/// A path that winds about: growth, unloading, reversal; some of it along the axes.
fn strain(i: usize, size: f64) -> [f64; 6] {
    let t = i as f64 / 400.0;
    let wave = |pace: f64, shift: f64| size * t * (pace * 6.0 * t + shift).sin();
    if i < 60 {
        let e = 2.0 * size * i as f64 / 60.0;
        return [e, -0.2 * e, -0.1 * e, 0.0, 0.0, 0.0];
    }
    [wave(1.0, 0.3) - 2.0 * size * t, wave(1.3, 1.0), wave(0.7, 2.0), wave(1.1, 0.0), wave(0.9, 1.5), wave(1.7, 0.7)]
}

fn advance(call: &mut UmatCall, end: &[f64; 6]) {
    for i in 0..6 {
        call.dstran[i] = end[i] - call.stran[i];
    }
    assert_eq!(call.call(Request::StressAndTangent), Ok(CallOutcome::Done));
    for i in 0..6 {
        call.stran[i] += call.dstran[i];
    }
}

fn difference(ours: &[f64], theirs: &[f64], scale: f64) -> f64 {
    ours.iter().zip(theirs).fold(0.0, |worst: f64, (a, b)| {
        let difference = (a - b).abs() / scale;
        if difference.is_nan() { f64::INFINITY } else { worst.max(difference) }
    })
}

#[test]
fn the_laws_in_fortran_are_the_laws() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = Settings { quick: true, states: None, python: None, plugin_paths: Vec::new() };
    let mut compared = 0;
    for solid in solids() {
        let path = match fortran::library(solid.law, Target::Portable, folder.path()).expect("sources that compile") {
            fortran::Library::Built(path) => path,
            fortran::Library::NotInstalled => {
                let required = std::env::var_os("PULLOUT_REQUIRE_CLIENTS").is_some_and(|value| value == "1");
                assert!(!required, "gfortran is not installed, and PULLOUT_REQUIRE_CLIENTS=1");
                eprintln!("NOTICE: gfortran is not installed: this check is skipped");
                return;
            }
            fortran::Library::None => continue,
        };
        let plugin = solid.library(&settings).expect("a plugin that Cargo built");
        // SAFETY: as in the benchmark.
        let twin = unsafe { Library::open(&path).expect("a library").vouched_for() };
        let new = |library: &Library| {
            UmatCall::new(library, None, solid.law, StressState::ThreeD, solid.states, &solid.props).expect("umat_")
        };
        let (mut ours, mut theirs) = (new(&plugin), new(&twin));
        let mut grew = 0.0_f64;
        for i in 1..=400 {
            let end = strain(i, solid.strain);
            advance(&mut ours, &end);
            advance(&mut theirs, &end);
            let modulus = solid.props[0];
            let stress = difference(ours.stress(), theirs.stress(), modulus * solid.strain);
            assert!(stress < 1e-12, "{}, increment {i}: stress {stress:e}", solid.law);
            let tangent = difference(ours.ddsdde(), theirs.ddsdde(), modulus);
            assert!(tangent < 1e-9, "{}, increment {i}: tangent {tangent:e}", solid.law);
            let energies = difference(&ours.energies[..2], &theirs.energies[..2], ours.energies[0] + ours.energies[1]);
            assert!(energies < 1e-11, "{}, increment {i}: energies {energies:e}", solid.law);
            grew = grew.max(ours.energies[1]);
        }
        assert!(solid.law == "linear_elastic" || grew > 0.0, "{} was never beyond its limit", solid.law);
        compared += 1;
    }
    assert_eq!(compared, 4);
}

#[test]
fn situations_are_what_they_are_called() {
    let settings = Settings { quick: true, states: None, python: None, plugin_paths: Vec::new() };
    for solid in solids().iter().filter(|solid| solid.law != "linear_elastic") {
        let library = solid.library(&settings).expect("a plugin that Cargo built");
        for situation in Situation::ALL {
            let mut call = solid.call(&library, situation).expect("a usable way");
            let before = call.energies[1];
            call.dstran = solid.increment(situation);
            assert_eq!(call.call(Request::StressAndTangent), Ok(CallOutcome::Done));
            let grows = call.energies[1] != before;
            assert_eq!(grows, situation == Situation::Inelastic, "{} {}", solid.law, situation.name());
        }
    }
}

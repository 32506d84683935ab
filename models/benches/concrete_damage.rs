//! ns per update of the bare law: `cargo bench -p models --bench concrete_damage`.
//!
//! Strains are made beforehand, so that only the law is timed; the least of several repetitions counts.

use models::concrete_damage::ConcreteDamage;
use std::hint::black_box;
use std::time::Instant;
use umat_abi::law::{Increment, Law, Request, StressState, advance_values, parameters_of};

/// Few enough to fit between two interruptions by the scheduler.
const UPDATES: usize = 10_000;
const REPETITIONS: usize = 60;

/// A path: its name, stress state and strain at 0 ≤ t ≤ 1.
struct Path {
    name: &'static str,
    stress_state: StressState,
    strain: fn(f64) -> [f64; 6],
}

fn run(props: &[f64], length: Option<f64>, path: &Path, request: Request) -> f64 {
    let strains: Vec<[f64; 6]> = (0..=UPDATES).map(|i| (path.strain)(i as f64 / UPDATES as f64)).collect();
    let mut best = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let mut state = [0.0; 13];
        let mut stress = [0.0; 6];
        let start = Instant::now();
        for pair in strains.windows(2) {
            let increment = Increment {
                stress_state: path.stress_state,
                strain: pair[1],
                strain_increment: std::array::from_fn(|i| pair[1][i] - pair[0][i]),
                stress,
                characteristic_length: length,
                time_increment: 1.0,
                temperature: 0.0,
            };
            let parameters = parameters_of::<ConcreteDamage>(black_box(props)).expect("consistent");
            let response =
                advance_values::<ConcreteDamage>(&parameters, &increment, &mut state, request).expect("an update");
            stress = response.stress;
            black_box(&response.tangent);
        }
        best = best.min(start.elapsed().as_nanos() as f64 / UPDATES as f64);
        black_box(state);
    }
    best
}

fn main() {
    let defaults: Vec<f64> = ConcreteDamage::INFO.parameters.iter().map(|p| p.default_value).collect();
    let with = |changes: &[(usize, f64)]| {
        let mut props = defaults.clone();
        for &(index, value) in changes {
            props[index] = value;
        }
        props
    };
    let sets = [
        ("IV-H", defaults.clone(), None),
        ("IV-HP", with(&[(10, 0.3), (11, 0.3)]), None),
        ("IV-H, crack band", with(&[(12, 0.1), (13, 20.0)]), Some(20.0)),
    ];
    let three_d = StressState::ThreeD;
    let paths = [
        Path { name: "elastic", stress_state: three_d, strain: |t| [5e-5 * t, -1e-5 * t, -1e-5 * t, 0.0, 0.0, 0.0] },
        Path { name: "tension", stress_state: three_d, strain: |t| [6e-4 * t, 0.0, 0.0, 0.0, 0.0, 0.0] },
        Path {
            name: "compression",
            stress_state: three_d,
            strain: |t| [-4e-3 * t, 1.6e-3 * t, 1.6e-3 * t, 0.0, 0.0, 0.0],
        },
        Path {
            name: "cyclic",
            stress_state: three_d,
            strain: |t| {
                let e = 2e-3 * t * (60.0 * t).sin();
                [e, -0.18 * e, -0.15 * e, 0.0, 0.0, 0.0]
            },
        },
        Path {
            name: "cyclic shear",
            stress_state: StressState::PlaneStrainOrAxisymmetric,
            strain: |t| {
                let e = 1e-3 * t * (60.0 * t).sin();
                [0.3 * e, -0.2 * e, 0.0, e, 0.0, 0.0]
            },
        },
        Path {
            name: "general",
            stress_state: three_d,
            strain: |t| {
                let e = 1e-3 * t * (60.0 * t).sin();
                [e, -0.4 * e, 0.1 * e, 0.7 * e, -0.3 * e, 0.2 * e]
            },
        },
        Path {
            name: "plane stress",
            stress_state: StressState::PlaneStress,
            strain: |t| {
                let e = 1e-3 * t * (60.0 * t).sin();
                [0.3 * e, -0.2 * e, 0.0, e, 0.0, 0.0]
            },
        },
    ];
    println!("{:<18} {:<14} {:>14} {:>14}", "ns per update", "path", "with tangent", "stress only");
    for (set, props, length) in &sets {
        for path in &paths {
            let tangent = run(props, *length, path, Request::StressAndTangent);
            let stress = run(props, *length, path, Request::Stress);
            println!("{set:<18} {:<14} {tangent:>14.0} {stress:>14.0}", path.name);
        }
    }
}

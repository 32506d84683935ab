use super::*;
use crate::battery::{self, STRESS_STATES, reference};

/// Reference sets (README of `tests/reference`), IV-H.
const B094: [f64; 14] =
    [31800.0, 0.18, 7000.0, 1.1, 1.926098e-4, 31.52083, 0.94, 3e-4, 0.23441, 0.0, 0.0, 0.0, 0.0, 0.0];
const B120: [f64; 14] =
    [31800.0, 0.18, 7000.0, 1.1, 1.926098e-4, 32.25788, 1.2, 3e-4, 0.10988, 0.0, 0.0, 0.0, 0.0, 0.0];

fn defaults() -> [f64; 14] {
    std::array::from_fn(|i| PARAMETERS[i].default_value)
}

/// A parameter set with some values replaced.
fn with(mut props: [f64; 14], changes: &[(&str, f64)]) -> [f64; 14] {
    for &(name, value) in changes {
        let index = PARAMETERS.iter().position(|p| p.name() == name).expect("a parameter's name");
        props[index] = value;
    }
    props
}

#[test]
fn reproduces_the_forty_digit_references() {
    let plastic = with(B120, &[("b_t", 0.3), ("b_c", 0.3)]);
    for (set, props) in [("IVH_b094", B094), ("IVH_b120", B120), ("IVHP_b120", plastic)] {
        for path in ["bi_c1_052", "bi_c1_1", "bi_t1_055", "bi_t1_1", "cyclic", "shear", "unicomp", "unitens"] {
            let file = format!("{set}_{path}.csv");
            reference::check::<ConcreteDamage>(&file, StressState::ThreeD, &props, &[("D_t", 0), ("D_c", 1)]);
        }
    }
}

#[test]
fn passes_the_battery() {
    let plastic = with(defaults(), &[("b_t", 0.3), ("b_c", 0.2)]);
    let confined = with(defaults(), &[("zeta_c", 2.0)]);
    for (props, count) in [(defaults(), 10_000), (plastic, 10_000), (confined, 3000)] {
        for stress_state in STRESS_STATES {
            let (tried, excluded) = battery::check_tangent::<ConcreteDamage>(&props, stress_state, 3e-4, count);
            println!("{stress_state:?}: {excluded} of {tried} near kinks");
            battery::check_rotation::<ConcreteDamage>(&props, stress_state, 3e-4, 500);
            let monotone = ["eta_t", "eta_c", "Y_t_max", "Y_c_max"];
            battery::check_invariants::<ConcreteDamage>(&props, stress_state, 3e-4, 500, &monotone, true);
        }
    }
}

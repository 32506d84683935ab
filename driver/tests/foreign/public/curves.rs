//! Curves that the laws compute along their paths.

use super::super::close;
use super::cases;
use crate::program::Table;
use serde_json::{Value, json};

/// A row's values of some columns.
fn row<const N: usize>(history: &Table, k: usize, columns: [&str; N]) -> [f64; N] {
    columns.map(|name| history.column(name)[k])
}

/// The root of a function that grows.
fn root(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    while 0.5 * (low + high) > low && 0.5 * (low + high) < high {
        let middle = 0.5 * (low + high);
        if function(middle) > 0.0 { high = middle } else { low = middle }
    }
    high
}

/// Asserts that a column's last value goes to the exact one by the first order in the increment, as backward Euler does.
#[track_caller]
fn first_order(histories: &[Table; 2], column: &str, exact: f64, share: f64) {
    let [coarse, fine] = histories.each_ref().map(|history| history.last(column) - exact);
    println!("{column}: {exact}, errors {coarse:e}, {fine:e}");
    let order = (coarse / fine).log2();
    assert!((order - 1.0).abs() < 0.1, "order {order}");
    assert!((2.0 * fine - coarse).abs() < share * exact.abs(), "{:e} instead of {exact}", exact + 2.0 * fine - coarse);
}

/// σ of Holzapfel, Gasser and Ogden's law for stretches along the axes: the fibres' shears cancel.
fn hgo_stress(stretches: [f64; 3]) -> [f64; 3] {
    let [mu, kappa, k1, k2, angle] = cases::HGO_PROPS;
    let j: f64 = stretches.iter().product();
    let bar = stretches.map(|stretch| stretch * stretch * j.powf(-2.0 / 3.0));
    let fibre = [bar[0] * angle.to_radians().cos().powi(2), bar[1] * angle.to_radians().sin().powi(2), 0.0];
    let e = (fibre.iter().sum::<f64>() - 1.0).max(0.0);
    let kirchhoff: [f64; 3] = std::array::from_fn(|i| mu * bar[i] + 4.0 * k1 * e * (k2 * e * e).exp() * fibre[i]);
    let mean = kirchhoff.iter().sum::<f64>() / 3.0;
    kirchhoff.map(|tau| (tau - mean) / j + kappa * (j - 1.0))
}

#[test]
fn an_artery_along_a_path_of_stretches() {
    let Some(history) = cases::HGO.driven(|_| ()) else { return };
    for k in 0..history.rows.len() {
        let expected = hgo_stress(row(&history, k, ["F11", "F22", "F33"]));
        for (found, expected) in row(&history, k, ["s11", "s22", "s33"]).iter().zip(expected) {
            close(*found, expected);
        }
    }
    assert!(history.last("sdv1") > 1.1, "fibres in tension");
    // compressed along 1 and 2 the fibres are slack: neo-Hooke
    let slack = json!([{ "increments": 4, "F": [[0.8, 0.0, 0.0], [0.0, 0.9, 0.0], [0.0, 0.0, 1.4]] }]);
    let Some(history) = cases::HGO.driven(|case| case["steps"] = slack.clone()) else { return };
    let [mu, kappa, ..] = cases::HGO_PROPS;
    let j: f64 = 0.8 * 0.9 * 1.4;
    close(history.last("s11"), mu * j.powf(-5.0 / 3.0) * (0.64 - (0.64 + 0.81 + 1.96) / 3.0) + kappa * (j - 1.0));
}

/// Sides free: the stretches across are found by the driver, to its 1e-8 MPa.
#[test]
fn an_artery_in_uniaxial_tension() {
    let pulled = json!([{ "increments": 10, "target": { "e11": 0.3 } }]);
    let Some(history) = cases::HGO.driven(|case| case["steps"] = pulled.clone()) else { return };
    for k in 0..history.rows.len() {
        let [e11, f11, s11] = row(&history, k, ["e11", "F11", "s11"]);
        close(f11, e11.exp());
        let [along, across, through] = hgo_stress(row(&history, k, ["F11", "F22", "F33"]));
        close(s11, along);
        assert!(across.abs().max(through.abs()) <= 1.1e-8, "{across}, {through}");
    }
    assert!(history.last("F22") < history.last("F33") && history.last("sdv1") > 1.1, "fibres turn towards the pull");
}

/// Tension along a cube axis: eight systems with Schmid factors 1/√6 slip alike, σ̇ = E (ε̇ − 8 γ̇/√6); the classical
/// Runge–Kutta scheme in σ, g and one system's slip.
fn eight_systems(rate: f64, duration: f64) -> [f64; 3] {
    let modulus = (cases::C11 - cases::C12) * (cases::C11 + 2.0 * cases::C12) / (cases::C11 + cases::C12);
    let [h0, saturation, initial] = cases::HARDENING_OF_SLIP;
    let slope = |[stress, strength, slip]: [f64; 3]| {
        let slipping = cases::RATE * (stress / 6.0_f64.sqrt() / strength).powf(cases::EXPONENT);
        let hardening = h0 / (h0 * 8.0 * slip / (saturation - initial)).cosh().powi(2);
        let strain_rate = 8.0 * slipping / 6.0_f64.sqrt();
        [modulus * (rate - strain_rate), hardening * (1.0 + 7.0 * cases::LATENT) * slipping, slipping]
    };
    let steps = 40_000_u32;
    let h = duration / f64::from(steps);
    let ahead = |state: [f64; 3], by: f64, slope: [f64; 3]| std::array::from_fn(|i| state[i] + by * slope[i]);
    (0..steps).fold([0.0, initial, 0.0], |state, _| {
        let a = slope(state);
        let b = slope(ahead(state, 0.5 * h, a));
        let c = slope(ahead(state, 0.5 * h, b));
        let d = slope(ahead(state, h, c));
        std::array::from_fn(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
    })
}

#[test]
fn a_crystal_in_tension_along_a_cube_axis() {
    let [stress, strength, slip] = eight_systems(1e-3, 20.0);
    let Some(histories) = cases::CRYSTAL.refined(200) else { return };
    first_order(&histories, "s11", stress, 2e-5);
    first_order(&histories, "sdv121", 8.0 * slip, 2e-5);
    let strengths: Vec<f64> = (1..=12).map(|n| histories[1].last(&format!("sdv{n}"))).collect();
    let active = strengths.iter().filter(|found| (*found / strength - 1.0).abs() < 1e-3).count();
    assert_eq!(active, 8, "{strengths:?}");
}

#[test]
fn a_maxwell_body_on_a_ramp_that_is_held() {
    let Some(history) = cases::PRONY.driven(|_| ()) else { return };
    // G(t) folded with strain rate 1 until t = 2
    let folded = |time: f64| {
        let ramp = time.min(2.0);
        let long = cases::SHEAR * (1.0 - cases::PRONY_TERMS.iter().map(|term| term.0).sum::<f64>()) * ramp;
        cases::PRONY_TERMS.iter().fold(long, |sum, (share, tau)| {
            sum + cases::SHEAR * share * tau * (((ramp - time) / tau).exp() - (-time / tau).exp())
        })
    };
    for k in 0..history.rows.len() {
        let [time, e11, s11, s22, s12] = row(&history, k, ["time", "e11", "s11", "s22", "s12"]);
        let (axial, shear) = (0.5e-3 * folded(time), 1e-3 * folded(time));
        close(s12, shear);
        close(s11, cases::BULK * e11 + 4.0 / 3.0 * axial);
        close(s22, cases::BULK * e11 - 2.0 / 3.0 * axial);
    }
}

#[test]
fn a_heated_bar_that_is_held_and_let_go() {
    let Some(history) = cases::THERMAL.driven(|_| ()) else { return };
    for k in 1..=10 {
        let heat = 40.0 * k as f64;
        let table = cases::THERMAL_TABLE;
        let pair = if heat <= 200.0 { [table[0], table[1]] } else { [table[1], table[2]] };
        let share = (heat + 20.0 - pair[0][0]) / (pair[1][0] - pair[0][0]);
        let [modulus, expansion] = [1, 2].map(|n| pair[0][n] + share * (pair[1][n] - pair[0][n]));
        let [s11, e22] = row(&history, k, ["s11", "e22"]);
        close(s11, -modulus * expansion * heat);
        close(e22, (1.0 + cases::POISSON) * expansion * heat);
    }
    close(history.last("e11"), 15e-6 * 400.0);
}

/// The undrained path of modified Cam clay: p goes to 2^−Λ of the pressure at yielding p_y (M² + η²)/M² = p_c, q to M p.
#[test]
fn clay_that_is_sheared_undrained() {
    let [lambda, kappa, m, shear, void] = cases::CLAY;
    let (initial, consolidated) = (100.0, 150.0);
    let undrained = |history: &Table, k: usize| {
        let [s11, s22, s33] = row(history, k, ["s11", "s22", "s33"]);
        [-(s11 + s22 + s33) / 3.0, s22 - s11]
    };
    let Some(history) = cases::CAM_CLAY.driven(|_| ()) else { return };
    // elastic to q = M √(p (p_c − p)): q = 3 G ε_q, p stays
    let [p, q] = undrained(&history, 1);
    close(p, initial);
    close(q, 3.0 * shear * 0.1 / 200.0);
    let yielding = m * (initial * (consolidated - initial)).sqrt();
    let plastic = (lambda - kappa) / lambda;
    for k in 0..history.rows.len() {
        let [p, q] = undrained(&history, k);
        assert!(q <= yielding || p < initial, "drier than critical it would dilate");
    }
    let [p, q] = undrained(&history, history.rows.len() - 1);
    // p/p0 = ((M² + η0²)/(M² + η²))^Λ from the yield point on
    let at_yield = (m * m + (yielding / initial).powi(2)) / (2.0 * m * m);
    let critical = initial * at_yield.powf(plastic);
    println!("p {p} of {critical}, q {q} of {}", m * critical);
    assert!((p / critical - 1.0).abs() < 2e-3 && (q / (m * p) - 1.0).abs() < 1e-3, "{p}, {q}");
    // squeezed alike from all sides: κ to p_c, then λ
    let squeezed = json!([{ "increments": 40, "target": { "e11": -0.02, "e22": -0.02, "e33": -0.02 } }]);
    let Some(history) = cases::CAM_CLAY.driven(|case| case["steps"] = squeezed.clone()) else { return };
    for k in 0..history.rows.len() {
        let [p, _] = undrained(&history, k);
        let volume = 0.06 * k as f64 / 40.0;
        let to_yield = kappa / (1.0 + void) * (consolidated / initial).ln();
        let expected = if volume < to_yield {
            initial * (volume * (1.0 + void) / kappa).exp()
        } else {
            consolidated * ((volume - to_yield) * (1.0 + void) / lambda).exp()
        };
        close(p, expected);
        close(history.column("sdv3")[k], 0.9 - 1.9 * volume);
    }
}

#[test]
fn hardening_that_is_read_from_a_file() {
    let Some(history) = cases::READ_TABLE.driven(|_| ()) else { return };
    let points: Vec<[f64; 2]> = cases::HARDENING
        .lines()
        .skip(1)
        .map(|line| {
            let mut numbers = line.split(' ').map(|number| number.parse().expect("a number"));
            std::array::from_fn(|_| numbers.next().expect("two numbers"))
        })
        .collect();
    for k in 0..history.rows.len() {
        let [strain, stress, plastic] = row(&history, k, ["e11", "s11", "sdv1"]);
        close(plastic, strain - stress / cases::STEEL);
        if plastic > 0.0 {
            let pair = points.windows(2).find(|pair| plastic < pair[1][0]).expect("within the table");
            close(stress, pair[0][1] + (plastic - pair[0][0]) * (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]));
        } else {
            assert!(stress < points[0][1]);
        }
    }
}

#[test]
fn mazars_concrete_in_tension_and_compression() {
    let [modulus, poisson, threshold, a_t, b_t, a_c, b_c] = cases::CONCRETE;
    let damage = |equivalent: f64, a: f64, b: f64| {
        let beyond = equivalent.max(threshold);
        1.0 - threshold * (1.0 - a) / beyond - a * (-b * (beyond - threshold)).exp()
    };
    let Some(history) = cases::MAZARS.driven(|_| ()) else { return };
    for k in 0..history.rows.len() {
        let [strain, stress] = row(&history, k, ["e11", "s11"]);
        close(stress, (1.0 - damage(strain, a_t, b_t)) * modulus * strain);
    }
    let pressed = json!([{ "increments": 50, "target": { "e11": -4e-3 } }]);
    let Some(history) = cases::MAZARS.driven(|case| case["steps"] = pressed.clone()) else { return };
    for k in 0..history.rows.len() {
        let [strain, stress] = row(&history, k, ["e11", "s11"]);
        // two lateral strains ν ε each
        let equivalent = 2.0_f64.sqrt() * poisson * strain.abs();
        close(stress, (1.0 - damage(equivalent, a_c, b_c)) * modulus * strain);
    }
}

#[test]
fn a_ply_whose_damage_lags_by_an_increment() {
    let [e1, e2, nu12, .., gm] = cases::PLY;
    let strength = cases::PLY[6];
    let Some(history) = cases::HASHIN.driven(|_| ()) else { return };
    let nu21 = nu12 * e2 / e1;
    let end = 2.0 * gm * e2 / (strength * strength);
    let mut before = 0.0;
    for k in 0..history.rows.len() {
        let [e22, s22, damage] = row(&history, k, ["e22", "s22", "sdv2"]);
        close(s22, (1.0 - before) * e2 / (1.0 - (1.0 - before) * nu12 * nu21) * e22);
        let criterion = e2 / (1.0 - nu12 * nu21) * e22 / strength;
        before = if criterion > 1.0 { end * (criterion - 1.0) / (criterion * (end - 1.0)) } else { 0.0 };
        close(damage, before);
    }
    assert!(before > 0.5, "{before}");
}

/// σ = ±σ_y + X, dX = C dε_p − γ X |dε_p|: exponentials in ε_p.
#[test]
fn a_loop_of_armstrong_and_frederick() {
    let [modulus, _, yield_stress, c, gamma] = cases::CYCLIC;
    let up = |plastic: f64| c / gamma * (1.0 - (-gamma * plastic).exp());
    let first = root(|plastic| plastic + (yield_stress + up(plastic)) / modulus - 0.01, 0.0, 0.01);
    let down = |plastic: f64| -c / gamma + (up(first) + c / gamma) * (-gamma * (first - plastic)).exp();
    let second = root(|plastic| plastic + (down(plastic) - yield_stress) / modulus + 0.01, -0.01, first);
    let Some(histories) = cases::ARMSTRONG_FREDERICK.refined(200) else { return };
    first_order(&histories, "s11", down(second) - yield_stress, 1e-4);
    first_order(&histories, "sdv7", 2.0 * first - second, 1e-4);
}

#[test]
fn friction_that_falls_as_it_slips() {
    let [stiffness, rest, end, transition] = cases::SLIDING;
    let Some(history) = cases::FRICTION.driven(|_| ()) else { return };
    let strength = |slipped: f64| 10.0 * (end + (rest - end) * (-slipped / transition).exp());
    for k in 1..history.rows.len() {
        let [slip, traction, slipped] = row(&history, k, ["slip", "tau", "sdv1"]);
        // it slides at once: 1/20 · 100 MPa/mm is twice the strength less 1 MPa
        let expected = root(|slipped| slipped + strength(slipped) / stiffness - slip, 0.0, 1.0);
        let sticks = stiffness * slip < strength(0.0);
        close(slipped, if sticks { 0.0 } else { expected });
        close(traction, if sticks { stiffness * slip } else { strength(expected) });
    }
    // back and forth: |τ| of the whole way slipped
    let there_and_back = json!([
        { "increments": 1, "target": { "slip": 0.0, "p": 10.0 } },
        { "increments": 10, "target": { "slip": 0.5, "p": 10.0 } },
        { "increments": 10, "target": { "slip": 0.0, "p": 10.0 } },
    ]);
    let Some(history) = cases::FRICTION.driven(|case| case["steps"] = there_and_back.clone()) else { return };
    close(history.last("tau"), -strength(history.last("sdv1")));
    let turned = history.column("tau")[11];
    close(history.last("sdv1"), 1.0 - (2.0 * turned - history.last("tau")) / stiffness);
}

#[test]
fn a_cohesive_zone_in_mixed_opening() {
    let [stiffness, peak, end] = cases::COHESION;
    let Some(history) =
        cases::COHESIVE.driven(|case: &mut Value| case["steps"][0]["target"] = json!({ "slip": 0.03, "gap": 0.04 }))
    else {
        return;
    };
    for k in 0..history.rows.len() {
        let [slip, gap, tau, p] = row(&history, k, ["slip", "gap", "tau", "p"]);
        let length = slip.hypot(gap);
        let traction =
            if length <= peak { stiffness * length } else { stiffness * peak * (end - length) / (end - peak) };
        close(tau.hypot(p), traction);
        close(tau * gap, -p * slip);
    }
    assert!(history.last("sdv1") > 0.5);
}

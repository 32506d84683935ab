//! The laws and their paths.

use super::PublishedLaw;
use serde_json::{Value, json};

pub const HGO: PublishedLaw = PublishedLaw { sources: &["hgo.F90", "hgo_modules.f90"], case: hgo };
pub const CRYSTAL: PublishedLaw = PublishedLaw { sources: &["crystal.F"], case: crystal };
pub const PRONY: PublishedLaw = PublishedLaw { sources: &["prony.F"], case: prony };
pub const THERMAL: PublishedLaw = PublishedLaw { sources: &["thermal.F"], case: thermal };
pub const CAM_CLAY: PublishedLaw = PublishedLaw { sources: &["cam_clay.F"], case: cam_clay };
pub const READ_TABLE: PublishedLaw = PublishedLaw { sources: &["read_table.F"], case: read_table };
pub const MAZARS: PublishedLaw = PublishedLaw { sources: &["mazars.F"], case: mazars };
pub const HASHIN: PublishedLaw = PublishedLaw { sources: &["hashin.F"], case: hashin };
pub const ARMSTRONG_FREDERICK: PublishedLaw = PublishedLaw {
    sources: &["armstrong_frederick.f", "armstrong_frederick_return.F", "armstrong_frederick_elastic.f"],
    case: armstrong_frederick,
};
pub const FRICTION: PublishedLaw = PublishedLaw { sources: &["contact_with_state.F"], case: friction };
pub const COHESIVE: PublishedLaw = PublishedLaw { sources: &["contact_with_state.F"], case: cohesive };

/// mu, kappa, k1, k2, angle.
pub const HGO_PROPS: [f64; 5] = [0.03, 1.0, 0.05, 2.0, 40.0];

fn hgo(plugin: Value) -> Value {
    let f = [[1.3, 0.0, 0.0], [0.0, 1.1, 0.0], [0.0, 0.0, 0.75]];
    json!({ "kind": "point", "mode": "3d", "nlgeom": true,
        "material": { "plugin": plugin, "props": HGO_PROPS, "nstatv": 2 },
        "steps": [{ "increments": 10, "F": f }] })
}

/// Copper.
pub const C11: f64 = 168_400.0;
pub const C12: f64 = 121_400.0;
pub const EXPONENT: f64 = 10.0;
pub const RATE: f64 = 1e-3;
/// h0, τs, τ0.
pub const HARDENING_OF_SLIP: [f64; 3] = [541.5, 109.5, 60.8];
pub const LATENT: f64 = 1.4;

/// 160 constants; the crystal's (001) along axis 1, its (100) at 30° to axis 2.
fn crystal(plugin: Value) -> Value {
    let mut props = [0.0; 160];
    let mut set = |number: usize, values: &[f64]| props[number - 1..][..values.len()].copy_from_slice(values);
    set(1, &[C11, C12, 75_400.0]);
    set(57, &[0.0, 0.0, 1.0]);
    set(60, &[1.0, 0.0, 0.0]);
    set(65, &[1.0, 0.0, 0.0]);
    set(68, &[0.0, 0.75_f64.sqrt(), 0.5]);
    set(73, &[EXPONENT, RATE]);
    set(97, &HARDENING_OF_SLIP);
    set(105, &[LATENT, LATENT]);
    set(145, &[1.0]);
    set(153, &[1.0, 50.0, 1e-14]);
    json!({ "kind": "point", "mode": "3d",
        "material": { "plugin": plugin, "props": props.to_vec(), "nstatv": 121, "cmname": "COPPER" },
        "steps": [{ "increments": 100, "time": 20.0, "target": { "e11": 0.02 } }] })
}

pub const BULK: f64 = 1000.0;
pub const SHEAR: f64 = 500.0;
/// Shares and times of relaxation.
pub const PRONY_TERMS: [(f64, f64); 2] = [(0.3, 0.5), (0.4, 5.0)];

/// A ramp of 2 s, held for 8 s.
fn prony(plugin: Value) -> Value {
    let [(a, s), (b, t)] = PRONY_TERMS;
    let end = json!({ "e11": 1e-3, "e22": 0, "e33": 0, "g12": 2e-3 });
    json!({ "kind": "point", "mode": "3d",
        "material": { "plugin": plugin, "props": [BULK, SHEAR, a, s, b, t], "nstatv": 12 },
        "steps": [
            { "increments": 8, "time": 2.0, "target": end },
            { "increments": 5, "time": 8.0, "target": end },
        ] })
}

pub const POISSON: f64 = 0.25;
/// Temperature, modulus, expansion.
pub const THERMAL_TABLE: [[f64; 3]; 3] = [[20.0, 200e3, 12e-6], [220.0, 150e3, 14e-6], [620.0, 50e3, 16e-6]];

/// Held along axis 1 and heated by 400, then let go.
fn thermal(plugin: Value) -> Value {
    let mut props = vec![POISSON, 3.0, 20.0];
    props.extend(THERMAL_TABLE.as_flattened());
    json!({ "kind": "point", "mode": "3d", "temperature": 20.0,
        "material": { "plugin": plugin, "props": props, "nstatv": 1 },
        "steps": [
            { "increments": 10, "temperature": 420.0, "target": { "e11": 0.0 } },
            { "increments": 1, "target": { "s11": 0.0 } },
        ] })
}

/// λ, κ, M, G, e0.
pub const CLAY: [f64; 5] = [0.15, 0.03, 1.1, 6000.0, 0.9];

/// Clay at 100 kPa, overconsolidated by 1.5 (SIGINI, SDVINI): sheared undrained.
fn cam_clay(plugin: Value) -> Value {
    let end = json!({ "e11": -0.1, "e22": 0.05, "e33": 0.05 });
    json!({ "kind": "point", "mode": "3d",
        "material": { "plugin": plugin, "props": CLAY, "nstatv": 3 },
        "steps": [{ "increments": 200, "target": end }] })
}

/// Plastic strain and yield stress.
pub const HARDENING: &str = "4\n0.0 250.0\n0.002 300.0\n0.01 350.0\n0.1 380.0\n";
pub const STEEL: f64 = 210e3;

fn read_table(plugin: Value) -> Value {
    json!({ "kind": "point", "mode": "3d",
        "material": { "plugin": plugin, "props": [STEEL, 0.3], "nstatv": 1 },
        "steps": [{ "increments": 20, "target": { "e11": 0.02 } }] })
}

/// E, ν, ε_D0, A_t, B_t, A_c, B_c.
pub const CONCRETE: [f64; 7] = [30e3, 0.2, 1e-4, 0.9, 1.0e4, 1.2, 1500.0];

fn mazars(plugin: Value) -> Value {
    json!({ "kind": "point", "mode": "3d",
        "material": { "plugin": plugin, "props": CONCRETE, "nstatv": 2 },
        "steps": [{ "increments": 50, "target": { "e11": 1e-3 } }] })
}

/// E1, E2, ν12, G12, X_T, X_C, Y_T, Y_C, S_L, G_f, G_m.
pub const PLY: [f64; 11] = [140e3, 10e3, 0.3, 5e3, 2000.0, 1200.0, 50.0, 200.0, 80.0, 90.0, 0.5];

fn hashin(plugin: Value) -> Value {
    json!({ "kind": "point", "mode": "plane_stress", "characteristic_length": 1.0,
        "material": { "plugin": plugin, "props": PLY, "nstatv": 5 },
        "steps": [{ "increments": 20, "target": { "e11": 0.0, "e22": 0.015, "g12": 0.0 } }] })
}

/// E, ν, σ_y, C, γ.
pub const CYCLIC: [f64; 5] = [200e3, 0.3, 200.0, 20e3, 200.0];

fn armstrong_frederick(plugin: Value) -> Value {
    json!({ "kind": "point", "mode": "3d",
        "material": { "plugin": plugin, "props": CYCLIC, "nstatv": 7 },
        "steps": [
            { "increments": 50, "target": { "e11": 0.01 } },
            { "increments": 50, "target": { "e11": -0.01 } },
        ] })
}

/// Elastic stiffness, coefficients at rest and in the end, slip of the transition.
pub const SLIDING: [f64; 4] = [100.0, 0.6, 0.2, 0.3];

fn friction(plugin: Value) -> Value {
    json!({ "kind": "interface", "material": { "plugin": plugin, "entry": "fric", "props": SLIDING, "nstatv": 1 },
        "steps": [
            { "increments": 1, "target": { "slip": 0.0, "p": 10.0 } },
            { "increments": 20, "target": { "slip": 1.0, "p": 10.0 } },
        ] })
}

/// Stiffness, lengths at the peak and at the end.
pub const COHESION: [f64; 3] = [1000.0, 0.01, 0.1];

fn cohesive(plugin: Value) -> Value {
    json!({ "kind": "interface", "material": { "plugin": plugin, "entry": "uinter", "props": COHESION, "nstatv": 1 },
        "steps": [{ "increments": 20, "target": { "slip": 0.06, "gap": 0.08 } }] })
}

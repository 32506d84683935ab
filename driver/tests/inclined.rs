//! Inclined fibres from the case to the curve.

mod program;

use program::{Desk, Run};
use serde_json::{Value, json};

/// A fibre in elastic concrete, with bond and no snubbing.
fn fibre(specimen: Value, slip: f64) -> Value {
    let steel =
        json!({ "plugin": "j2_plasticity", "props": { "E": 210e3, "nu": 0.3, "hardening": [[347, 0], [2447, 1]] } });
    let concrete = json!({ "plugin": "linear_elastic", "props": { "E": 23.7e3, "nu": 0.15 } });
    let bond = json!({ "normal_law": "hard", "p_0": 1000, "delta_N": 0.004, "k_e": 400, "a_1": 3.44, "b_1": 0.13865,
                       "a_2": 1, "b_2": -0.1772, "tau_res": 0, "k_u": 0, "mu": 0 });
    json!({
        "kind": "pullout",
        "mesh": { "specimen": specimen },
        "parts": { "fibre": { "material": steel }, "matrix": { "material": concrete, "nlgeom": false } },
        "contact": { "law": { "plugin": "bond_slip", "props": bond } },
        "nlgeom": true,
        "steps": [ { "slip": slip, "increments": { "initial": 0.001, "maximum": 0.01 } } ],
        "output": { "vtu": false, "plots": false },
    })
}

fn run(desk: &Desk, name: &str, case: &Value) -> Run {
    desk.run(&desk.case(&format!("{name}.json"), case), &[], name, 0)
}

/// Peak load, N, and work to the end, N mm.
fn peak_and_work(run: &Run) -> [f64; 2] {
    let load = run.history.column("load");
    [load.iter().copied().fold(0.0, f64::max), run.history.last("external_work")]
}

fn worst_energy_error(run: &Run) -> f64 {
    run.history.column("energy_error").iter().fold(0.0, |worst: f64, error| worst.max(error.abs()))
}

/// Triangles and rounded edges against the rectangles of the perpendicular specimen, which is verified by itself. The
/// rounded edges take 0.1 of 12.2 mm of the bond on each side.
#[test]
fn without_inclination_it_is_the_perpendicular_fibre() {
    let desk = Desk::new();
    let straight = run(&desk, "perpendicular", &fibre(json!({ "type": "perpendicular_fibre" }), 0.3));
    let bent = run(&desk, "inclined", &fibre(json!({ "type": "inclined_fibre", "angle_deg": 0 }), 0.3));
    let bonded = (12.2 - 0.1015) / 12.2;
    for (expected, found) in std::iter::zip(peak_and_work(&straight), peak_and_work(&bent)) {
        assert!((found / (expected * bonded) - 1.0).abs() < 5e-3, "{found} instead of {expected} × {bonded}");
    }
    let lateral = bent.history.column("load_lateral");
    assert!(lateral.iter().all(|force| force.abs() < 0.02 * peak_and_work(&bent)[0]), "{lateral:?}");
}

#[test]
fn bent_and_straight_fibres_slide_around_their_exit_in_balance() {
    let desk = Desk::new();
    for (name, shape, free_length) in [("bent", "bent", 3.0), ("exit", "straight", 0.0), ("outside", "straight", 1.0)] {
        let specimen = json!({
            "type": "inclined_fibre", "angle_deg": 45, "shape": shape, "free_length": free_length, "mesh_size": 2,
        });
        let found = run(&desk, name, &fibre(specimen, 0.3));
        let error = worst_energy_error(&found);
        assert!(error < 1e-3, "{name}: the energies differ by {error:e} of the work");
        // uniform slip at the peak of the bond would give 31.1 N along the fibre; straightening and friction at the exit are
        // what is different
        let [peak, _] = peak_and_work(&found);
        assert!((15.0..60.0).contains(&peak), "{name}: {peak} N");
        let dissipated = found.history.column("plastic_energy");
        assert!(dissipated.windows(2).all(|pair| pair[1] >= pair[0] - 1e-9), "{name}");
        assert!(found.history.last("plastic_energy") > 0.0, "{name}: the fibre yields at its exit");
        assert!(found.history.last("slip_tail") > 0.05, "{name}: the whole fibre slides");
    }
}

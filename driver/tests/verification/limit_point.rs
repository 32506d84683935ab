//! A flat arch of two bars that snaps through.

use super::grids::{Grids, Places, elastic, model, steps};
use super::{run, run_to_end};
use fe_core::assembly::Location;
use fe_core::model::Model;
use fe_core::stepping::RunError;
use serde_json::{Value, json};

/// Half of the span, the rise and the bar's height, mm.
const SPAN: f64 = 20.0;
const RISE: f64 = 1.0;
const HEIGHT: f64 = 0.8;

/// A bar between a pin and an apex that stays in the middle, with other members of the case.
fn arch(members: Value) -> Model {
    let mut grids = Grids::default();
    let mut bar = Places::new();
    let length = SPAN.hypot(RISE);
    let along = steps(0.0, length, 40);
    grids.cells(&mut bar, "bar", &along, &steps(-0.5 * HEIGHT, 0.5 * HEIGHT, 2), |_, _| true);
    grids.points(&mut bar, "pin", |x| [x, 0.0], &along[..1]);
    grids.points(&mut bar, "apex", |x| [x, 0.0], &along[40..]);
    let (cosine, sine) = (SPAN / length, RISE / length);
    for [x, y] in &mut grids.nodes {
        [*x, *y] = [cosine * *x - sine * *y, sine * *x + cosine * *y];
    }
    let mut case = json!({
        "kind": "pullout", "nlgeom": true, "mesh": { "file": "mesh.msh" },
        "parts": { "bar": { "material": elastic(10e3, 0.0), "model": "plane_stress", "thickness": 1 } },
    });
    let members = members.as_object().expect("members").clone();
    case.as_object_mut().expect("a case").extend(members);
    model(&case, &grids)
}

/// Displacement control gives the whole path. The largest load on it is the limit point, which the run under load control
/// reaches and names. The work passes through 0 on the way; the error of the energies is relative to the largest work so far.
#[test]
fn a_limit_point_of_a_load_is_named() {
    let held = json!({ "nodes": "apex", "direction": "x" });
    let driven = arch(json!({
        "supports": { "pin": {}, "held": held, "down": { "nodes": "apex", "direction": [0, -1], "drive": "w" } },
        "measure": { "slip": "w", "load": "down" },
        "steps": [ { "drives": { "w": 2.4 } } ],
    }));
    let (mut greatest, mut least, mut energies) = (0.0_f64, 0.0_f64, 0.0_f64);
    run_to_end(&driven, |record, _| {
        if record.slip < RISE {
            greatest = greatest.max(record.load);
        }
        least = least.min(record.load);
        energies = energies.max(record.energy_error.abs());
    });
    let loaded = arch(json!({
        "supports": { "pin": {}, "held": held },
        "loads": { "apex": { "force": [0, -1], "drive": "F" } },
        "measure": { "slip": "F", "load": "pin", "direction": "y" },
        "steps": [ { "drives": { "F": 4 } } ],
    }));
    let mut reached = 0.0;
    let end = run(&loaded, |_, snapshot| reached = snapshot.drives()[0]);
    println!("limit {greatest:.6} N, under the load {reached:.6} N; least {least:.6} N, energies {energies:.1e}");
    let Err(RunError::Failed { trouble, .. }) = end else { panic!("{end:?}") };
    assert!(trouble.is_limit_point && matches!(trouble.place, Location::Node { .. }), "{trouble}");
    assert!((reached / greatest - 1.0).abs() < 1e-2, "{reached} N, {greatest} N");
    // it snaps through and comes back to 0 work on the other side
    assert!(least < -0.9 * greatest && energies < 2e-3, "{least} {energies}");
}

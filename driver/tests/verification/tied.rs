//! A fine zone in a coarse one that shares no nodes with it: its nodes are tied to the coarse edges, each of which ends at one of them.

use super::grids::{Grids, Places, elastic, model, steps};
use super::run_to_end;
use end_to_end_tests::worst;
use fe_core::model::Model;
use serde_json::json;

/// A constant stress goes through two tied lines, one along it and one across it.
#[test]
fn a_tie_passes_the_patch_test() {
    let mut grids = Grids::default();
    let (mut fine, mut coarse) = (Places::new(), Places::new());
    grids.cells(&mut fine, "fine", &steps(0.0, 2.0, 5), &steps(0.0, 2.0, 5), |_, _| true);
    let lines = [0.0, 0.8, 2.0, 4.0];
    grids.cells(&mut coarse, "coarse", &lines, &lines, |x, y| x > 2.0 || y > 2.0);
    // what is tied is not held besides
    for (places, ends, count) in [(&mut fine, steps(0.0, 2.0, 5), 10), (&mut coarse, vec![2.0, 4.0], 3)] {
        let values: Vec<f64> =
            ends.windows(2).flat_map(|ends| [ends[0], 0.5 * (ends[0] + ends[1])]).chain([4.0]).collect();
        grids.points(places, "bottom", |x| [x, 0.0], &values[..count]);
        grids.points(places, "left", |y| [0.0, y], &values[..count]);
    }
    grids.line(&mut coarse, "top", |x| [x, 4.0], &lines);
    grids.line(&mut fine, "follows", |x| [x, 2.0], &steps(0.0, 2.0, 5));
    grids.line(&mut fine, "follows", |y| [2.0, y], &steps(0.0, 2.0, 5));
    grids.line(&mut coarse, "leads", |x| [x, 2.0], &lines[..3]);
    grids.line(&mut coarse, "leads", |y| [2.0, y], &lines[..3]);
    let part = json!({ "model": "plane_stress", "thickness": 1, "material": elastic(30e3, 0.2) });
    let case = json!({
        "kind": "pullout", "mesh": { "file": "mesh.msh" },
        "parts": { "fine": part, "coarse": part },
        "couplings": [ { "tie": "follows", "to": "leads" } ],
        "supports": { "left": { "direction": "x" }, "bottom": { "direction": "y" } },
        "grip": { "nodes": "top", "direction": "y", "lateral": "free" },
        "steps": [ { "slip": 0.004, "increments": 1 } ],
    });
    let model = model(&case, &grids);
    let mut greatest = 0.0_f64;
    run_to_end(&model, |record, snapshot| {
        if record.step == 0 {
            return;
        }
        for element in 0..model.mesh.elements().len() {
            for point in 0..snapshot.solids().point_count(element) {
                let stress = snapshot.solids().point(element, point).stress;
                let expected = [0.0, 30.0, 0.0, 0.0];
                let errors = stress.iter().zip(expected).map(|(stress, expected)| (stress - expected).abs() / 30.0);
                greatest = worst(errors.chain([greatest]));
            }
        }
    });
    println!("worst error {greatest:.1e}");
    assert!(greatest < 1e-10, "{greatest:e}");
}

const RADIUS: f64 = 16.0;
const LENGTH: f64 = 350.0;
/// The fine zone: 1.5 diameters on both sides of the bar, and below it.
const ZONE: [f64; 2] = [64.0, LENGTH + 48.0];

/// The straight bar of chapter 8 in elastic concrete, with a fine mesh next to the bar. The rest has lines of the same height, or
/// is coarse and tied.
fn bar(is_tied: bool) -> (Model, usize) {
    let mut grids = Grids::default();
    let (mut steel, mut fine) = (Places::new(), Places::new());
    let mut depths = steps(-ZONE[1], -LENGTH, 3);
    depths.extend(&steps(-LENGTH, 0.0, 28)[1..]);
    let heights = [&depths[3..], &steps(0.0, 100.0, 6)[1..]].concat();
    grids.cells(&mut steel, "fibre", &[-RADIUS, 0.0, RADIUS], &heights, |_, _| true);
    let offsets = [0.0, 6.0, 14.0, 26.0, 48.0].map(|x| RADIUS + x);
    let mut across: Vec<f64> = offsets.iter().rev().map(|x| -x).chain([0.0]).collect();
    across.extend(offsets);
    let is_block = |x: f64, y: f64| x.abs() > RADIUS || y < -LENGTH;
    grids.cells(&mut fine, "matrix", &across, &depths, is_block);
    let zone_elements = grids.groups.iter().map(|(.., elements)| elements.len()).sum();
    let mut own = Places::new();
    let outer = [-300.0, -240.0, -180.0, -125.0, -80.0, -ZONE[0], ZONE[0], 80.0, 125.0, 180.0, 240.0, 300.0];
    let (coarse, lines, base) = if is_tied {
        // every fourth of the fine lines; all near the corner where the held face begins, whose stresses coarse elements smear
        let heights =
            [&steps(-625.0, -ZONE[1], 4)[..4], &[-ZONE[1]], &steps(-LENGTH, -50.0, 6), &steps(-37.5, 0.0, 3)].concat();
        (&mut own, heights, vec![-ZONE[0], 0.0, ZONE[0]])
    } else {
        (&mut fine, [&steps(-625.0, -ZONE[1], 4)[..4], &depths].concat(), across.clone())
    };
    let xs = [&outer[..5], &base, &outer[7..]].concat();
    grids.cells(coarse, "matrix", &xs, &lines, |x, y| x.abs() > ZONE[0] || y < -ZONE[1]);
    for (name, range) in [("support", &outer[..5]), ("support", &outer[7..])] {
        grids.line(coarse, name, |x| [x, 0.0], range);
    }
    if is_tied {
        for x in [-ZONE[0], ZONE[0]] {
            grids.line(&mut own, "leads", |y| [x, y], &lines[4..]);
            grids.line(&mut fine, "follows", |y| [x, y], &depths);
        }
        grids.line(&mut own, "leads", |x| [x, -ZONE[1]], &base);
        grids.line(&mut fine, "follows", |x| [x, -ZONE[1]], &across);
    }
    for (side, x) in [("left", -RADIUS), ("right", RADIUS)] {
        grids.line(&mut fine, &format!("hole_{side}"), |y| [x, y], &depths[3..]);
        grids.line(&mut steel, &format!("fibre_{side}"), |y| [x, y], &depths[3..]);
    }
    grids.line(&mut steel, "grip", |x| [x, 100.0], &[-RADIUS, 0.0, RADIUS]);
    let law = json!({ "plugin": "bond_slip", "props": { "normal_stiffness": 0 } });
    let pair = |side: &str| {
        json!({ "name": side, "slave": format!("hole_{side}"), "master": format!("fibre_{side}"), "law": law,
                "width": std::f64::consts::PI * RADIUS })
    };
    let mut case = json!({
        "kind": "pullout", "mesh": { "file": "mesh.msh" }, "nlgeom": true,
        "parts": {
            "fibre": { "model": "plane_stress", "thickness": std::f64::consts::FRAC_PI_2 * RADIUS,
                       "material": elastic(205.7e3, 0.3) },
            "matrix": { "model": "plane_strain", "thickness": 300, "material": elastic(31.8e3, 0.18), "nlgeom": false },
        },
        "contact": [pair("left"), pair("right")],
        "grip": { "nodes": "grip", "direction": "y" },
        "supports": { "support": {} },
        "steps": [ { "slip": 0.4, "increments": 20 } ],
    });
    if is_tied {
        case["couplings"] = json!([{ "tie": "follows", "to": "leads" }]);
    }
    (model(&case, &grids), zone_elements)
}

#[test]
fn a_bar_in_tied_zones_bears_what_it_does_in_one() {
    let runs = [false, true].map(|is_tied| {
        let (model, zone) = bar(is_tied);
        let (mut loads, mut stresses) = (Vec::new(), Vec::new());
        run_to_end(&model, |record, snapshot| {
            loads.push(record.load);
            // the block's elements along the tied lines
            stresses.clear();
            for element in 0..zone {
                for point in 0..snapshot.solids().point_count(element) {
                    let view = snapshot.solids().point(element, point);
                    let [x, y] = view.position;
                    if x.abs() > ZONE[0] - 22.0 || y < -ZONE[1] + 16.0 {
                        stresses.push(view.stress);
                    }
                }
            }
        });
        (loads, stresses, model.mesh.nodes().len())
    });
    let [(matching, one, many), (tied, other, few)] = runs;
    let greatest = matching.iter().copied().fold(0.0, f64::max);
    let apart = worst(matching.iter().zip(&tied).map(|(a, b)| (a - b).abs() / greatest));
    let size = one.iter().flatten().fold(0.0, |size: f64, stress| size.max(stress.abs()));
    let differences = one.iter().flatten().zip(other.iter().flatten()).map(|(a, b)| (a - b).abs() / size);
    let stress = worst(differences);
    println!("{greatest:.0} N, {many} and {few} nodes: loads {apart:.1e}, stresses near the tie {stress:.1e} apart");
    assert!(few < many && greatest > 45e3, "{few} of {many} nodes, {greatest} N");
    assert!(apart < 2e-3, "loads {apart:e}");
    assert!(one.len() == other.len() && stress < 0.05, "stresses {stress:e}");
}

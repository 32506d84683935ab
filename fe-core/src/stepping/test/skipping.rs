//! Skipping changes no load curve by more than the solver's tolerance: a plate with a hole in plastic flow.

use super::*;
use crate::mesh::specimen::{PlateWithHole, plate_with_hole};

/// Residuals relative to the force scale.
const FORCE_TOLERANCE: f64 = 1e-9;
/// A load is a sum of some ten nodal reactions, each as exact as the residuals.
const LOAD_TOLERANCE: f64 = 10.0 * FORCE_TOLERANCE;

/// The plate pulled along y, through flow all across it, and half of the way back.
pub(super) fn plate(cells: usize, nlgeom: bool) -> Model {
    let law = PluginLaw::shipped("j2_plasticity", &[("E", 200e3), ("nu", 0.3)]).followed_by(&[250.0, 0.0, 1250.0, 1.0]);
    let mut model = strip(law, PlaneModel::PlaneStrain, 0.02, StepControl::Fixed { increments: 8 });
    let mesh = plate_with_hole(&PlateWithHole {
        width: 10.0,
        height: 10.0,
        radius: 1.0,
        cells,
        grading: 10.0,
        element: ElementKind::Q8,
    });
    model.mesh = Mesh::new(mesh.unwrap()).unwrap();
    let support = |set: &str, direction, drive| {
        let nodes = model.mesh.node_set(set).unwrap().to_vec();
        Support { name: set.into(), nodes, direction, drive }
    };
    model.supports = vec![
        support("symmetry_x", [1.0, 0.0], None),
        support("symmetry_y", [0.0, 1.0], None),
        support("top", [0.0, 1.0], Some(0)),
    ];
    model.measured.direction = [0.0, 1.0];
    model.controls.force_tolerance = FORCE_TOLERANCE;
    let back = Step { time: 1.0, targets: vec![Some(0.01)], control: StepControl::Fixed { increments: 4 } };
    model.steps.push(back);
    model.nlgeom.fill(nlgeom);
    model
}

fn loads(model: &Model, skipping: Skipping) -> Vec<f64> {
    let model = Model { skipping, ..model.clone() };
    run(&model).0.iter().map(|record| record.load).collect()
}

fn same_loads(model: &Model, skipping: &[Skipping]) {
    let reference = loads(model, Skipping::NONE);
    let greatest = reference.iter().copied().fold(0.0, f64::max);
    assert!(reference[12] < 0.5 * greatest, "it unloads");
    for skipping in skipping {
        let loads = loads(model, *skipping);
        assert_eq!(loads.len(), reference.len());
        for (increment, (load, reference)) in loads.iter().zip(&reference).enumerate() {
            let difference = (load - reference).abs() / greatest;
            assert!(difference < LOAD_TOLERANCE, "{skipping:?}, increment {increment}: {difference:.1e}");
        }
    }
}

#[test]
fn no_item_changes_the_load_curve_of_a_plate_in_plastic_flow() {
    let (all, none) = (Skipping::ALL, Skipping::NONE);
    same_loads(
        &plate(128, false),
        &[
            all,
            Skipping { unchanged_elements: true, ..none },
            Skipping { factor_reuse: true, ..none },
            Skipping { factor_reuse: false, ..all },
        ],
    );
}

#[test]
fn skipping_does_not_change_the_load_curve_under_large_displacements() {
    same_loads(&plate(128, true), &[Skipping::ALL]);
}

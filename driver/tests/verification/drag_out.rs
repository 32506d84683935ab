//! A strip that is dragged out from under a block.

use super::{model, run_to_end};

#[test]
fn the_drag_is_the_coefficient_of_friction_times_the_load() {
    let model = model("drag-out-strip", &[]);
    let mut drags = Vec::new();
    run_to_end(&model, |record, _| {
        if record.step == 2 && record.slip >= 0.5 {
            drags.push(record.load);
        }
    });
    println!("drag: {drags:.4?}");
    assert!(drags.len() > 10);
    for drag in drags {
        approx::assert_relative_eq!(drag, 15.0, max_relative = 5e-3);
    }
}

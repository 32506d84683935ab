use super::*;

const AUTOMATIC: StepControl = StepControl::Automatic { initial: 0.01, maximum: 0.1, minimum: 1e-6 };

#[test]
fn easy_increments_grow_up_to_the_greatest_and_hard_ones_shrink() {
    let mut size = IncrementSize::new(AUTOMATIC);
    size.accepted(3, 3);
    assert_eq!(size.next(1.0), 0.01);
    size.accepted(3, 3);
    assert_eq!(size.next(1.0), 0.015);
    for _ in 0..40 {
        size.accepted(3, 3);
    }
    assert_eq!(size.next(1.0), 0.1);
    size.accepted(14, 14);
    assert_eq!(size.next(1.0), 0.1 * 0.75);
}

#[test]
fn the_end_of_the_step_is_met_without_a_splinter() {
    let size = IncrementSize::new(StepControl::Fixed { increments: 3 });
    let mut at = 0.0;
    let mut count = 0;
    while at < 1.0 {
        let next = size.next(1.0 - at);
        at = if next == 1.0 - at { 1.0 } else { at + next };
        count += 1;
    }
    assert_eq!(count, 3);
}

#[test]
fn cuts_end_at_the_least_increment() {
    let mut size = IncrementSize::new(AUTOMATIC);
    assert!(size.cut(1e-5, 0.25));
    assert_eq!(size.next(1.0), 2.5e-6);
    assert!(!size.cut(2.5e-6, 0.25));
}

#[test]
fn equal_increments_come_back_after_a_cut() {
    let mut size = IncrementSize::new(StepControl::Fixed { increments: 10 });
    assert!(size.cut(0.1, 0.25));
    for _ in 0..10 {
        size.accepted(4, 4);
    }
    assert_eq!(size.next(0.9), 0.1);
}

use super::*;
use crate::model::StepControl;

#[test]
fn fields_go_linearly_to_the_ends_of_steps() {
    let values = |temperature: f64| FieldValues { temperature, variables: vec![2.0 * temperature] };
    let fields = Fields { initial: values(10.0), ends: vec![values(30.0), values(30.0), values(0.0)] };
    let step = |time| Step { time, targets: Vec::new(), control: StepControl::Fixed { increments: 1 } };
    let steps = [step(4.0), step(1.0), step(2.0)];
    let over = |step, step_time, time_increment| {
        let context = IncrementContext { step, step_time, time_increment, ..IncrementContext::default() };
        fields.over(&steps, &context)
    };
    assert_eq!(over(1, 0.0, 0.0), [values(10.0), values(10.0)]);
    assert_eq!(over(1, 1.0, 3.0), [values(15.0), values(30.0)]);
    assert_eq!(over(2, 0.5, 0.5), [values(30.0), values(30.0)]);
    assert_eq!(over(3, 0.0, 1.0), [values(30.0), values(15.0)]);
    assert!(fields.change() && !Fields::default().change());
    let nothing = [FieldValues::default(), FieldValues::default()];
    assert_eq!(Fields::default().over(&steps, &IncrementContext::default()), nothing);
}

//! Temperature and field variables, which are the same at all points and change from step to step.

use super::{IncrementContext, Step};

#[cfg(test)]
mod test;

/// Values at a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldValues {
    /// TEMP.
    pub temperature: f64,
    /// PREDEF.
    pub variables: Vec<f64>,
}

impl FieldValues {
    /// Makes it the values between two, of as many variables; exact at both ends.
    pub fn set_between(&mut self, start: &Self, end: &Self, fraction: f64) {
        let at = |a: f64, b: f64| match fraction {
            0.0 => a,
            1.0 => b,
            _ => a + fraction * (b - a),
        };
        self.temperature = at(start.temperature, end.temperature);
        self.variables.clear();
        self.variables.extend(start.variables.iter().zip(&end.variables).map(|(a, b)| at(*a, *b)));
    }
}

/// Temperature and field variables that laws are given: in each step they change linearly to its end values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fields {
    /// Values at the start.
    pub initial: FieldValues,
    /// Values at the end of each step; none: they stay as they are.
    pub ends: Vec<FieldValues>,
}

impl Fields {
    /// Returns whether anything changes.
    pub fn change(&self) -> bool {
        self.ends.iter().any(|end| *end != self.initial)
    }

    /// Returns the field values at the start and at the end of an increment of these steps.
    pub fn over(&self, steps: &[Step], context: &IncrementContext) -> [FieldValues; 2] {
        let index = (context.step as usize).saturating_sub(1);
        let before = index.checked_sub(1).and_then(|before| self.ends.get(before)).unwrap_or(&self.initial);
        let after = self.ends.get(index).unwrap_or(before);
        let duration = steps.get(index).map_or(0.0, |step| step.time);
        let at = |time: f64| {
            let fraction = if duration > 0.0 { (time / duration).clamp(0.0, 1.0) } else { 0.0 };
            let mut values = FieldValues::default();
            values.set_between(before, after, fraction);
            values
        };
        [at(context.step_time), at(context.step_time + context.time_increment)]
    }
}

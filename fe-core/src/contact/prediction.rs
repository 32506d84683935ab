//! Gaps that the tangent predicts: laws are evaluated at them while the surfaces still turn under a correction.

use super::Contact;
use super::history::PointStatus;
use super::pair::Pair;

/// Part of the greatest pressure: where the gap differs from the predicted one by less than makes this much pressure, its
/// law is evaluated at the gap itself.
const UNNOTICED: f64 = 0.05;

/// Gaps of patches along a correction, to first order.
#[derive(Debug, Default)]
pub(super) struct GapPrediction {
    /// Empty where nothing is predicted.
    patches: Vec<Course>,
    /// Part of the correction that is applied.
    part: f64,
    /// The greatest |p| at the start of the increment over ε_N, mm.
    scale: f64,
    /// Whether a law was evaluated elsewhere than at its gap in the last evaluation.
    pub elsewhere: bool,
}

/// The gap of a patch along a correction.
#[derive(Clone, Copy, Debug)]
struct Course {
    start: f64,
    change: f64,
    was_open: bool,
}

impl GapPrediction {
    /// Returns the gap at which the law of a patch with this gap is to be evaluated.
    pub fn gap(&self, patch: usize, gap: f64) -> f64 {
        let Some(Course { start, change, was_open }) = self.patches.get(patch) else { return gap };
        let prediction = start + self.part * change;
        let asked_at = if (gap - prediction).abs() > UNNOTICED * self.scale { prediction } else { gap };
        // what closes in one iteration has no pressure yet that friction could hold on to
        if *was_open { asked_at.max(-self.scale) } else { asked_at }
    }
}

impl Pair {
    /// Predicts the gaps. `change`: correction of all displacements; `predicts`: laws are evaluated where the increment starts.
    fn predict_gaps(&mut self, change: &[f64], predicts: bool) {
        let pressures = self.state.committed.points.iter().map(|point| point.pressure.abs());
        let scale = pressures.fold(0.0, f64::max) / self.penalty;
        // without any pressure there is nothing that could be noticed
        let count = if scale > 0.0 { self.patches.len() } else { 0 };
        let course = |number| {
            let course = self.course(number, change);
            if predicts { Course { change: 0.0, ..course } } else { course }
        };
        let patches = (0..count).map(course).collect();
        self.prediction = GapPrediction { patches, part: 1.0, scale, elsewhere: false };
    }

    fn course(&self, number: usize, change: &[f64]) -> Course {
        let patch = self.patches[number].clone();
        let start = self.mean_gap(patch.clone());
        let (mut sum, mut area, mut was_open) = (0.0, 0.0, true);
        for (index, kinematics) in self.members(&patch) {
            let (point, state) = (&self.points[index], &self.state.trial.points[index]);
            let own = kinematics.gap - self.datum(index);
            let by_weight =
                self.state.weight_slopes[index] * (own - start) * kinematics.along(&kinematics.slip_gradient, change);
            sum += point.area * (state.weight * kinematics.along(&kinematics.gap_gradient, change) + by_weight);
            area += point.area * state.weight;
            was_open &= matches!(state.status, PointStatus::Open | PointStatus::Released);
        }
        Course { start, change: if area > 0.0 { sum / area } else { 0.0 }, was_open }
    }
}

impl Contact {
    /// Predicts the gaps along a correction of all displacements from the state of the last evaluation. Until
    /// [`Self::end_prediction`] is called, laws whose gaps differ from the prediction are evaluated at the predicted ones and
    /// followed from there along their own tangents; while the drives move (`predicts`), at those of the start of the increment.
    pub(crate) fn predict_gaps(&mut self, change: &[f64], predicts: bool) {
        self.pairs.iter_mut().for_each(|pair| pair.predict_gaps(change, predicts));
    }

    /// Sets the part of the correction that is applied.
    pub(crate) fn set_predicted_part(&mut self, part: f64) {
        self.pairs.iter_mut().for_each(|pair| pair.prediction.part = part);
    }

    /// Ends the prediction: laws are evaluated at the gaps themselves.
    pub(crate) fn end_prediction(&mut self) {
        self.pairs.iter_mut().for_each(|pair| pair.prediction = GapPrediction::default());
    }

    /// Returns whether a law was evaluated elsewhere than at its gap in the last evaluation.
    pub(crate) fn is_elsewhere(&self) -> bool {
        self.pairs.iter().any(|pair| pair.prediction.elsewhere)
    }
}

//! Overlaps that drives bring about: what the next increment starts from, and the work of pressing surfaces apart.

use super::Contact;
use super::pair::Pair;

impl Contact {
    /// Presses surfaces apart by their interferences at these values of the drives, from the next evaluation on.
    pub fn set_drives(&mut self, drives: &[f64]) {
        for pair in &mut self.pairs {
            if let Some(interference) = pair.fit.interference {
                pair.state.fitted[1] = drives[interference.drive];
            }
        }
    }

    /// Adds the forces, N, by which a change of the drives pushes bodies apart to first order, from the state and the tangents of
    /// the last evaluation.
    pub(crate) fn add_drive_forces(&self, change: &[f64], forces: &mut [f64]) {
        for pair in &self.pairs {
            if let Some(interference) = pair.fit.interference {
                pair.add_drive_forces(change[interference.drive], forces);
            }
        }
    }

    /// Returns the work of pressing surfaces apart in the increment that was evaluated last, by trapezoids, N·mm.
    pub(crate) fn fitting_work(&self) -> f64 {
        self.pairs.iter().map(Pair::fitting_work).sum()
    }
}

impl Pair {
    /// Adds W v̄ dp̄ − ∑ A w ∂s dτ of each patch, where its mean gap falls by the mean of the overlaps that the drive adds.
    fn add_drive_forces(&self, change: f64, forces: &mut [f64]) {
        if change == 0.0 {
            return;
        }
        for patch in &self.patches {
            let (mut area, mut pressed, mut stiffness) = (0.0, 0.0, 0.0);
            for (index, _) in self.members(patch) {
                let share = self.points[index].area * self.state.trial.points[index].weight;
                area += share;
                pressed += share * self.points[index].overlap * change;
                stiffness += share * self.state.tangents[index][0][0];
            }
            if area == 0.0 {
                continue;
            }
            let deeper = pressed / area;
            let pressure = stiffness / area * deeper;
            for (index, kinematics) in self.members(patch) {
                let share = self.points[index].area * self.state.trial.points[index].weight;
                let shear = self.state.tangents[index][1][0] * deeper;
                for (i, freedom) in kinematics.freedoms().into_iter().take(kinematics.freedom_count()).enumerate() {
                    forces[freedom] += share * (pressure * kinematics.pull[i] - shear * kinematics.slip_gradient[i]);
                }
            }
        }
    }

    fn fitting_work(&self) -> f64 {
        let [before, after] = self.state.fitted;
        if before == after {
            return 0.0;
        }
        let states = self.state.committed.points.iter().zip(&self.state.trial.points);
        let forces = self.points.iter().zip(states).map(|(point, (start, end))| {
            let pressing = [start, end].map(|state| state.weight * (state.pressure + state.own_pressure));
            0.5 * (pressing[0] + pressing[1]) * point.area * point.overlap
        });
        forces.sum::<f64>() * (after - before)
    }
}

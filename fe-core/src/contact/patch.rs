//! Points of one slave edge that share a gap: their tractions become forces and one block.

use super::kinematics::Kinematics;
use super::pair::{Output, Pair, PairState};
use std::ops::Range;

/// Part of an edge's length by which a point may lie deeper than its edge does on the mean. Edges that bend with a fibre
/// stay below it, edges of torn matter turn through the surface.
const DEEPER: f64 = 0.01;
/// Fraction of the penalty applied to a point deeper than its edge. Torn matter turns easily; 381 increments instead of 539
/// with the whole penalty at 45°.
const SOFTER: f64 = 1e-3;

/// Quantities that the points of a patch share; the module's page has the equations.
struct Shared {
    /// Σ A w, mm².
    area: f64,
    /// ḡ, mm.
    gap: f64,
    /// p̄, MPa.
    pressure: f64,
    /// Number of points.
    points: usize,
}

/// The freedoms of a patch, those of its points one after the other, each once.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    nodes: Vec<usize>,
    freedoms: Vec<usize>,
    /// Freedoms of each point by their place in `freedoms`, point by point.
    places: Vec<usize>,
    /// −v̄, −∂ḡ/∂x and the rest of ∂p̄/∂x besides c̄ (−∂ḡ/∂x).
    pushed: Vec<f64>,
    pressing: Vec<f64>,
    other: Vec<f64>,
    block: Vec<f64>,
}

impl Scratch {
    fn gather<'k>(&mut self, points: impl Iterator<Item = &'k Kinematics>) {
        self.nodes.clear();
        self.places.clear();
        for kinematics in points {
            for &node in kinematics.nodes() {
                let place = self.nodes.iter().position(|&other| other == node).unwrap_or_else(|| {
                    self.nodes.push(node);
                    self.nodes.len() - 1
                });
                self.places.extend([2 * place, 2 * place + 1]);
            }
        }
        self.freedoms.clear();
        self.freedoms.extend(self.nodes.iter().flat_map(|node| [2 * node, 2 * node + 1]));
        let count = self.freedoms.len();
        for vector in [&mut self.pushed, &mut self.pressing, &mut self.other] {
            vector.clear();
            vector.resize(count, 0.0);
        }
        self.block.clear();
        self.block.resize(count * count, 0.0);
    }
}

impl Pair {
    /// ḡ = Σ A w (g − g_start)/Σ A w of a patch, from kinematics and weights on trial; the plain mean where nothing is left.
    pub(super) fn mean_gap(&self, patch: Range<usize>) -> f64 {
        let mean = |weight: &dyn Fn(usize) -> f64| {
            let (mut sum, mut area) = (0.0, 0.0);
            for index in patch.clone() {
                let Some(kinematics) = &self.state.kinematics[index] else { continue };
                let share = weight(index);
                sum += share * (kinematics.gap - self.datum(index));
                area += share;
            }
            (sum, area)
        };
        let weighted = |index: usize| self.points[index].area * self.state.trial.points[index].weight;
        match mean(&weighted) {
            (sum, area) if area > 0.0 => sum / area,
            _ => {
                let (sum, area) = mean(&|index| self.points[index].area);
                if area > 0.0 { sum / area } else { 0.0 }
            }
        }
    }

    /// The pressure of a point that lies deeper in the master than its patch with this gap by more than [`DEEPER`].
    pub(super) fn press_alone(&mut self, index: usize, shared: f64) {
        let point = &self.points[index];
        let own = self.state.kinematics[index].as_ref().map_or(shared, |kinematics| kinematics.gap - self.datum(index));
        let turned = self.state.committed.points[index].turned;
        let excess = (shared.min(0.0) - own - DEEPER * point.edge_length - turned).max(0.0);
        let state = &mut self.state.trial.points[index];
        let pressure = SOFTER * self.penalty * excess;
        (state.own_pressure, state.own_energy) = (pressure, 0.5 * pressure * excess);
    }

    /// Crushes the surface under a point whose own pressure raises the total above the surface's strength. Its law has
    /// been asked before.
    pub(super) fn crush_alone(&mut self, index: usize) {
        let Some(bearing) = &self.bearing else { return };
        let state = &mut self.state.trial.points[index];
        let borne = (bearing.strength - state.pressure).max(0.0);
        let stiffness = SOFTER * self.penalty;
        state.turning = ((state.own_pressure - borne) / stiffness).max(0.0);
        if state.turning > 0.0 {
            (state.own_pressure, state.own_energy) = (borne, 0.5 * borne * borne / stiffness);
        }
    }

    /// The points of a patch that transmit, or may.
    pub(super) fn members(&self, patch: &Range<usize>) -> impl Iterator<Item = (usize, &Kinematics)> {
        let points = patch.clone().filter(|&index| self.state.trial.points[index].weight > 0.0);
        points.filter_map(|index| Some((index, self.state.kinematics[index].as_ref()?)))
    }

    /// Adds the forces of a patch with its shared gap, and its block.
    pub(super) fn add(&mut self, patch: Range<usize>, gap: f64, output: &mut Output<'_>) {
        let wants_tangent = output.request.wants_tangent();
        let PairState { trial, tangents, shear_stiffness, .. } = &mut self.state;
        for index in patch.clone().filter(|_| wants_tangent) {
            shear_stiffness[index] = trial.points[index].weight * self.points[index].area * tangents[index][1][1];
        }
        let Some(shared) = self.shared(&patch, gap) else { return };
        for (index, kinematics) in self.members(&patch) {
            let (state, area, freedoms) =
                (&self.state.trial.points[index], self.points[index].area, kinematics.freedoms());
            for i in 0..kinematics.freedom_count() {
                let pressure = shared.pressure + state.own_pressure;
                let force = area * (state.shear * kinematics.slip_gradient[i] - pressure * kinematics.pull[i]);
                output.forces[freedoms[i]] += state.weight * force;
            }
        }
        if wants_tangent {
            let mut scratch = std::mem::take(&mut self.scratch);
            scratch.gather(self.members(&patch).map(|(_, kinematics)| kinematics));
            self.fill(&mut scratch, &patch, &shared);
            output.blocks.push(&scratch.freedoms, &scratch.block);
            self.scratch = scratch;
        }
    }

    /// `None`: the patch transmits nothing and would not.
    fn shared(&self, patch: &Range<usize>, gap: f64) -> Option<Shared> {
        let (mut area, mut force, mut points, mut last) = (0.0, 0.0, 0_usize, 0.0);
        let mut silent = true;
        for (index, _) in self.members(patch) {
            let state = &self.state.trial.points[index];
            let share = self.points[index].area * state.weight;
            area += share;
            force += share * state.pressure;
            (points, last) = (points + 1, state.pressure);
            let no_tangent = self.state.tangents[index].iter().flatten().all(|entry| *entry == 0.0);
            silent &= state.pressure == 0.0 && state.shear == 0.0 && state.own_pressure == 0.0 && no_tangent;
        }
        // one point has its own pressure, to the bit
        let pressure = if points == 1 { last } else { force / area };
        (area > 0.0 && !silent).then_some(Shared { area, gap, pressure, points })
    }

    fn fill(&self, scratch: &mut Scratch, patch: &Range<usize>, shared: &Shared) {
        let Scratch { freedoms, places, pushed, pressing, other, block, .. } = scratch;
        let count = freedoms.len();
        let mut stiffness = 0.0;
        let mut start = 0;
        for (index, kinematics) in self.members(patch) {
            let (point, state) = (&self.points[index], &self.state.trial.points[index]);
            let share = if shared.points == 1 { 1.0 } else { point.area * state.weight / shared.area };
            let slope = point.area * self.state.weight_slopes[index] / shared.area;
            let [[c_pp, c_ps], _] = self.state.tangents[index];
            let (gap, pressure) = (kinematics.gap - self.datum(index), state.pressure);
            stiffness += share * c_pp;
            for i in 0..kinematics.freedom_count() {
                let (place, sliding) = (places[start + i], kinematics.slip_gradient[i]);
                pushed[place] -= share * kinematics.pull[i];
                pressing[place] -= share * kinematics.gap_gradient[i] + slope * (gap - shared.gap) * sliding;
                other[place] += (share * c_ps + slope * (pressure - shared.pressure)) * sliding;
            }
            start += kinematics.freedom_count();
        }
        for i in 0..count {
            for j in 0..count {
                block[i * count + j] = shared.area * (stiffness * (pushed[i] * pressing[j]) + pushed[i] * other[j]);
            }
        }
        let mut start = 0;
        for (index, kinematics) in self.members(patch) {
            let (point, state) = (&self.points[index], &self.state.trial.points[index]);
            let slope = point.area * self.state.weight_slopes[index];
            let area = point.area * state.weight;
            let [[c_pp, c_ps], [c_sp, c_ss]] = self.state.tangents[index];
            let own = &places[start..start + kinematics.freedom_count()];
            let sliding = &kinematics.slip_gradient;
            let pressure = shared.pressure + state.own_pressure;
            if state.turning > 0.0 {
                // p + q stays at the capacity of the surface
                for (i, &row) in own.iter().enumerate() {
                    let force = area * kinematics.pull[i];
                    (0..count).for_each(|column| block[row * count + column] += force * c_pp * pressing[column]);
                    for (j, &column) in own.iter().enumerate() {
                        block[row * count + column] += force * c_ps * sliding[j];
                    }
                }
            } else if state.own_pressure > 0.0 {
                let stiffness = area * SOFTER * self.penalty;
                for (i, &row) in own.iter().enumerate() {
                    let force = stiffness * kinematics.pull[i];
                    for (j, &column) in own.iter().enumerate() {
                        block[row * count + column] += force * kinematics.gap_gradient[j];
                    }
                    if shared.gap < 0.0 {
                        // −∂ḡ is what presses
                        (0..count).for_each(|column| block[row * count + column] += force * pressing[column]);
                    }
                }
            }
            for (i, &row) in own.iter().enumerate() {
                let force = state.shear * sliding[i] - pressure * kinematics.pull[i];
                for (j, &column) in own.iter().enumerate() {
                    let geometric = kinematics.second_derivative(-pressure, state.shear, i, j);
                    block[row * count + column] +=
                        area * (c_ss * (sliding[i] * sliding[j]) + geometric) + slope * force * sliding[j];
                }
                for column in 0..count {
                    block[row * count + column] += area * c_sp * sliding[i] * pressing[column];
                }
            }
            start += kinematics.freedom_count();
        }
    }
}

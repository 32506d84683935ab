//! A scalar field on the nodes, in addition to the displacements: temperature, or the phase field of a law.
//!
//! ```text
//! R_i = ∫ N_i (r − c (θ − θ_n)/Δt) − k ∇N_i·∇θ dV + ∫ N_i q dA = 0
//! K_ij = ∫ k ∇N_i·∇N_j + (c/Δt − ∂r/∂θ) N_i N_j dV
//! ```
//!
//! r and ∂r/∂θ are RPL and DRPLDT of the laws, and FLUX of HETVAL, at the last displacements, integrated at the points
//! of the laws. UMATHT gives ∫ N_i ρ (U − U_n)/Δt and ∫ ∇N_i·f in place of c and k. The law gets Σ N_i θ_i at its point
//! as TEMP + DTEMP. Displacements and field are found in turn. A [`Field`] predicts θ, does one Newton iteration a
//! pass, and reports when it no longer changes ([`crate::model::FieldCoupling`]):
//!
//! ```text
//! θ ← θ_n + 0.9 Δt/Δt_n (θ_n − θ_{n−1}),   then in each pass   θ ← θ + 1.4 K⁻¹R,   until max |K⁻¹R| ≤ tolerance
//! ```
//!
//! Prediction and over-relaxation are for phase fields: they save two of three passes where cracks grow steadily. If a
//! pass changes more than the one before, the rest of the increment does without them. Slow passes whose corrections
//! form a geometric series are summed up at once.
//!
//! Where the field leads, the growth g of the node that grows fastest is given, and the drives follow along their line
//! by δλ in each pass. At fixed drives the passes would leave the branch on which the load falls with the drives:
//!
//! ```text
//! a = K⁻¹R,   b = K⁻¹ ∂R/∂λ,   δλ = (g − (θ − θ_n)_k − a_k)/b_k,   θ ← θ + a + δλ b
//! ```

mod element;
mod full;

use crate::assembly::Solids;
use crate::assembly::loads::{Bearers, external};
use crate::mesh::Mesh;
use crate::model::{CrackSurface, FieldCoupling, FieldKind, Flux, IncrementContext, LoadKind, ScalarField};
use crate::solver::{LinearSolver, Pattern, SolverError, SolverOptions, Symmetry, SystemMatrix};
use element::FieldElement;
use full::FullSystem;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

#[cfg(test)]
mod test;

/// Part of its last change by which a phase field is predicted to change, by the ratio of the increments.
const PREDICTION: f64 = 0.9;
/// Part of a correction of a phase field that is applied.
const OVER_RELAXATION: f64 = 1.4;
/// Passes of an increment with them; a slow one is better off without.
const FAST_PASSES: usize = 25;
/// Difference of a correction from a multiple of the one before, relative to itself, up to which those that follow go on like this.
const GEOMETRIC: f64 = 0.1;
/// Sum of them that is applied at once, at most, in corrections.
const LONGEST_SUM: f64 = 100.0;
/// ε: part of the force scale by which the last correction may change a force. Bars with l = 0.15 to 5 mm then bear their strength to
/// 2·10⁻⁴.
pub(crate) const FORCE_CHANGE: f64 = 3e-3;
/// Corrections of the field at the same displacements, in one pass.
const FIELD_CORRECTIONS: usize = 12;
/// Passes of an increment, after which it is given up.
const MOST_PASSES: usize = 300;
/// Last change of a field that leads, as a part of its growth, below which it says nothing of how it grows on.
const LEAST_FORETOLD: f64 = 0.1;

/// Number of an equation that is none.
const NONE: usize = usize::MAX;

/// What of a field is kept between increments.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FieldState {
    /// θ, one per node: 0 where there is none.
    values: Vec<f64>,
    /// θ that the laws were given last; other than `values` in one-pass mode.
    given: Vec<f64>,
    /// θ one increment before.
    earlier: Vec<f64>,
    /// The time between them; 0: there is none before.
    time: f64,
}

/// Result of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// The laws have got another field: displacements follow.
    Changed,
    /// The same, by a correction so small that the field is the last one if it leaves the forces as they were ([`Field::accept`]).
    Near,
    /// The laws have got another field at the same displacements, from which a further correction follows.
    Again,
    /// The laws have got the field again with which the displacements were found.
    Back,
    /// So many passes that a smaller increment is to be tried.
    GivenUp,
}

/// The growth of a field that leads.
#[derive(Clone, Copy, Debug)]
struct Leading {
    growth: f64,
    /// The node that grows by it, once it is known.
    node: Option<usize>,
}

/// A correction of the field at fixed drives.
#[derive(Clone, Debug)]
pub(crate) struct Correction {
    /// K⁻¹R, by equations.
    change: Vec<f64>,
    /// R.
    residual: Vec<f64>,
}

/// A field and its equations.
pub(crate) struct Field {
    definition: ScalarField,
    elements: Vec<FieldElement>,
    /// Whether each node has a value.
    has_field: Vec<bool>,
    /// The equation of each node, [`NONE`] without one.
    equations: Vec<usize>,
    /// Nodal fluxes of each flux of the definition at a drive of 1.
    fluxes: Vec<Vec<f64>>,
    matrix: SystemMatrix,
    solver: LinearSolver,
    committed: FieldState,
    trial: Vec<f64>,
    /// The field that follows, of one pass.
    next: Vec<f64>,
    /// The time that the present attempt takes.
    time: f64,
    passes: usize,
    /// Whether displacements alone are still to be found.
    is_accepted: bool,
    last_change: f64,
    is_fast: bool,
    leading: Option<Leading>,
    /// The correction of the pass before, of slow ones; empty: none.
    last_correction: Vec<f64>,
    /// The system of both, once it has been needed.
    full: Option<Box<FullSystem>>,
}

impl std::fmt::Debug for Field {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Field").field("definition", &self.definition).finish_non_exhaustive()
    }
}

impl Field {
    /// Numbers the equations of a field of a mesh.
    pub(crate) fn new(definition: &ScalarField, mesh: &Mesh) -> Self {
        let elements: Vec<FieldElement> = (0..mesh.elements().len())
            .filter(|&element| definition.parts[mesh.elements()[element].part()])
            .map(|element| FieldElement::new(mesh, element))
            .collect();
        let mut has_field = vec![false; mesh.nodes().len()];
        elements.iter().flat_map(|element| &element.nodes).for_each(|&node| has_field[node] = true);
        let mut is_free = has_field.clone();
        definition.fixed.iter().flat_map(|fixed| &fixed.nodes).for_each(|&node| is_free[node] = false);
        let nodes: Vec<usize> = (0..is_free.len()).filter(|&node| is_free[node]).collect();
        let mut equations = vec![NONE; is_free.len()];
        nodes.iter().enumerate().for_each(|(equation, &node)| equations[node] = equation);
        let groups: Vec<Vec<usize>> = elements
            .iter()
            .map(|element| element.nodes.iter().map(|&node| equations[node]).filter(|&e| e != NONE).collect())
            .collect();
        let pattern = Arc::new(Pattern::from_groups(nodes.len(), groups.iter().map(Vec::as_slice)));
        let positions = nodes.iter().map(|&node| mesh.nodes()[node]).collect();
        let solver = LinearSolver::new(&pattern, &nodes, SolverOptions::default()).with_positions(positions);
        let values: Vec<f64> = has_field.iter().map(|has| if *has { definition.initial } else { 0.0 }).collect();
        let bearers = Bearers { thickness: &|_| None, shares: None };
        let fluxes = definition.fluxes.iter().map(|flux| {
            // as a force along x
            let load = LoadKind::Traction { edges: flux.edges.clone(), traction: [1.0, 0.0] };
            let mut forces = vec![0.0; 2 * mesh.nodes().len()];
            external(mesh, &bearers, &load, flux.flux, &[], &mut forces, None);
            forces.chunks_exact(2).map(|force| force[0]).collect()
        });
        Self {
            elements,
            fluxes: fluxes.collect(),
            matrix: SystemMatrix::new(pattern),
            solver,
            committed: FieldState { given: values.clone(), earlier: values.clone(), values: values.clone(), time: 0.0 },
            trial: values.clone(),
            next: values,
            passes: 0,
            is_accepted: false,
            last_change: f64::INFINITY,
            is_fast: true,
            leading: None,
            last_correction: Vec::new(),
            full: None,
            has_field,
            equations,
            time: 0.0,
            definition: definition.clone(),
        }
    }

    /// θ at the end of the last increment, one per node; NaN where there is none.
    pub(crate) fn values(&self) -> Vec<f64> {
        let shown = |(value, has_field): (&f64, &bool)| if *has_field { *value } else { f64::NAN };
        self.committed.values.iter().zip(&self.has_field).map(shown).collect()
    }

    /// Returns the largest θ.
    pub(crate) fn largest(&self) -> f64 {
        self.values().into_iter().fold(f64::NAN, f64::max)
    }

    /// Returns what is kept between increments.
    pub(crate) fn state(&self) -> FieldState {
        self.committed.clone()
    }

    /// Takes over what another field of the same definition kept.
    pub(crate) fn set_state(&mut self, state: &FieldState, solids: &mut Solids) {
        self.committed.clone_from(state);
        self.trial.clone_from(&state.given);
        self.hand_over(solids);
    }

    /// Begins an attempt at an increment with drives at its end: the field that the laws are given first. `growth`: that of its leading
    /// node, if it leads.
    pub(crate) fn begin(
        &mut self,
        drives: &[f64],
        context: &IncrementContext,
        growth: Option<f64>,
        solids: &mut Solids,
    ) {
        let FieldState { values, earlier, time, .. } = &self.committed;
        let is_one_pass = self.definition.coupling == FieldCoupling::OnePass;
        let share = match self.definition.coupling {
            FieldCoupling::Staggered if self.definition.is_phase_field() => PREDICTION,
            // the first iteration predicts both
            FieldCoupling::Staggered | FieldCoupling::Full => 0.0,
            FieldCoupling::OnePass => 1.0,
        };
        let ratio = match growth {
            Some(growth) => {
                let grown = values.iter().zip(earlier).map(|(now, before)| now - before).fold(0.0, f64::max);
                if grown > LEAST_FORETOLD * growth { share * growth / grown } else { 0.0 }
            }
            None if *time > 0.0 => share * context.time_increment / time,
            None => 0.0,
        };
        self.trial.clear();
        self.trial.extend(values.iter().zip(earlier).map(|(now, before)| {
            let change = ratio * (now - before);
            // what cracks does not heal
            now + if is_one_pass && self.definition.is_phase_field() { change.max(0.0) } else { change }
        }));
        self.time = context.time_increment;
        if self.time > 0.0 {
            self.definition.fixed.iter().for_each(|fixed| fixed.set(drives, &mut self.trial));
        }
        self.leading = growth.map(|growth| Leading { growth, node: None });
        (self.passes, self.last_change) = (0, f64::INFINITY);
        self.is_fast = self.definition.is_phase_field() && growth.is_none();
        self.is_accepted = false;
        self.last_correction.clear();
        self.next.clone_from(&self.trial);
        self.give(&self.trial, solids);
    }

    /// Gives the laws the field of the start.
    pub(crate) fn hand_over(&self, solids: &mut Solids) {
        self.give(&self.trial, solids);
    }

    /// Gives the laws a field at the end of the increment.
    fn give(&self, end: &[f64], solids: &mut Solids) {
        for element in &self.elements {
            let at = |point: usize| element.at(point, [&self.committed.given, end]);
            solids.set_field(element.element, (0..element.point_count()).map(at));
        }
    }

    /// Corrects the field, and gives it to the laws. Returns with it which part of the correction was applied.
    pub(crate) fn pass(
        &mut self,
        Correction { change: correction, .. }: Correction,
        solids: &mut Solids,
    ) -> (Pass, f64) {
        self.passes += 1;
        let change = correction.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let is_small = change <= self.definition.tolerance * self.scale();
        if self.definition.coupling == FieldCoupling::OnePass {
            self.apply(&correction, 1.0);
            let goes_on = !is_small && self.passes < FIELD_CORRECTIONS;
            self.give(if goes_on { &self.next } else { &self.trial }, solids);
            return (if goes_on { Pass::Again } else { Pass::Back }, 1.0);
        }
        if self.passes >= MOST_PASSES || !change.is_finite() {
            return (Pass::GivenUp, 0.0);
        }
        self.is_fast &= self.passes <= 2 || (change <= self.last_change && self.passes <= FAST_PASSES);
        self.last_change = change;
        let part = if self.is_fast {
            OVER_RELAXATION
        } else if self.passes > FAST_PASSES {
            self.sum_of_slow(&correction)
        } else {
            1.0
        };
        self.apply(&correction, part);
        self.trial.clone_from(&self.next);
        self.give(&self.trial, solids);
        (if is_small { Pass::Near } else { Pass::Changed }, part)
    }

    /// Adds to a correction what the drives add that follow the field, by its change with them. Returns how far they go.
    pub(crate) fn lead(&mut self, correction: &mut Correction, response: &[f64]) -> f64 {
        let Some(Leading { growth, node }) = &mut self.leading else { return 0.0 };
        let follows = |node: &usize| self.equations[*node] != NONE;
        let by = |node: &usize| response[self.equations[*node]];
        let fastest = || (0..self.equations.len()).filter(follows).max_by(|a, b| by(a).total_cmp(&by(b)));
        *node = node.or_else(fastest);
        let Some(node) = *node else { return f64::NAN };
        let missing = *growth - (self.next[node] - self.committed.values[node]);
        let share = (missing - correction.change[self.equations[node]]) / by(&node);
        correction.change.iter_mut().zip(response).for_each(|(change, by)| *change += share * by);
        share
    }

    /// Returns K⁻¹ ∂R/∂λ, K being that of a correction, from the heat of the laws at displacements of drives that are further by `length`.
    pub(crate) fn response(
        &mut self,
        correction: &Correction,
        length: f64,
        drives: &[f64],
        solids: &Solids,
    ) -> Result<Vec<f64>, SolverError> {
        let mut change = self.equations_at(drives, solids, None);
        change.iter_mut().zip(&correction.residual).for_each(|(there, here)| *there = (*there - here) / length);
        self.solve(&mut change)?;
        Ok(change)
    }

    /// What the tolerance is relative to.
    fn scale(&self) -> f64 {
        match self.definition.kind {
            FieldKind::PhaseField(_) => 1.0,
            FieldKind::Temperature => self.next.iter().fold(0.0_f64, |most, value| most.max(value.abs())),
        }
    }

    /// Returns whether corrections of a phase field have grown in this increment: passes leave a state that is unstable.
    pub(crate) fn departs(&self) -> bool {
        self.definition.is_phase_field() && !self.is_fast
    }

    /// Returns whether the present field is that of the end of the increment.
    pub(crate) fn is_accepted(&self) -> bool {
        self.is_accepted
    }

    /// Makes the present field that of the end of the increment, or takes this back where displacements go elsewhere.
    pub(crate) fn accept(&mut self, is_accepted: bool) {
        self.is_accepted = is_accepted;
    }

    /// Returns how many corrections like this one all that would follow add up to, 1/(1 − q), if it is q times the one before; 1 if
    /// not. Near the onset of a crack in a uniform field q is close to 1.
    fn sum_of_slow(&mut self, correction: &[f64]) -> f64 {
        let before = std::mem::take(&mut self.last_correction);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let factor = dot(correction, &before) / dot(&before, &before);
        let rest: f64 = correction.iter().zip(&before).map(|(now, before)| (now - factor * before).powi(2)).sum();
        // not so where there is none before
        if factor > 0.0 && factor < 1.0 && rest <= GEOMETRIC * GEOMETRIC * dot(correction, correction) {
            return (1.0 / (1.0 - factor)).min(LONGEST_SUM);
        }
        self.last_correction.extend_from_slice(correction);
        1.0
    }

    /// Adds a part of a correction to what follows.
    fn apply(&mut self, correction: &[f64], part: f64) {
        for (value, &equation) in self.next.iter_mut().zip(&self.equations) {
            if equation != NONE {
                *value += part * correction[equation];
            }
        }
    }

    /// Returns K⁻¹R at the present displacements.
    ///
    /// # Errors
    ///
    /// The equations have no solution.
    pub(crate) fn correction(&mut self, drives: &[f64], solids: &Solids) -> Result<Correction, SolverError> {
        // drives that something leads have moved
        self.definition.fixed.iter().for_each(|fixed| fixed.set(drives, &mut self.next));
        let mut symmetry = Symmetry::Symmetric;
        let mut values = std::mem::take(&mut self.matrix.values);
        let residual = self.equations_at(drives, solids, Some((&mut values, &mut symmetry)));
        self.matrix.values = values;
        if !residual.is_empty() {
            self.solver.factorise(&self.matrix, symmetry)?;
        }
        let mut change = residual.clone();
        self.solve(&mut change)?;
        Ok(Correction { change, residual })
    }

    /// Solves with the last factor.
    fn solve(&mut self, right_side: &mut [f64]) -> Result<(), SolverError> {
        if right_side.iter().any(|value| *value != 0.0) {
            self.solver.solve(&self.matrix, right_side)?;
        }
        Ok(())
    }

    /// Returns R by the heat that the laws returned, with K and its symmetry if they are asked for.
    fn equations_at(
        &self,
        drives: &[f64],
        solids: &Solids,
        matrix: Option<(&mut Vec<f64>, &mut Symmetry)>,
    ) -> Vec<f64> {
        let mut residual = vec![0.0; self.matrix.pattern().size()];
        self.add_fluxes(|flux| flux.drive.map_or(1.0, |drive| drives[drive]), &mut residual);
        self.add_elements(solids, &mut residual, matrix);
        residual
    }

    /// Adds R of the elements, and gives K and its symmetry if they are asked for.
    fn add_elements(&self, solids: &Solids, residual: &mut [f64], mut matrix: Option<(&mut Vec<f64>, &mut Symmetry)>) {
        let density = self.definition.transfer.as_ref().map_or(0.0, |transfer| transfer.density);
        let medium = element::Medium {
            conductivity: self.definition.conductivity,
            capacity_rate: self.definition.capacity / self.time,
            density_rate: density / self.time,
        };
        if let Some((values, _)) = &mut matrix {
            values.fill(0.0);
        }
        let pattern = self.matrix.pattern();
        for element in &self.elements {
            let count = element.nodes.len();
            let at = |values: &[f64]| -> Vec<f64> { element.nodes.iter().map(|&node| values[node]).collect() };
            let (end, start) = (at(&self.next), at(&self.committed.values));
            let heat = solids.heat(element.element);
            let (forces, stiffness) = element.equations(medium, [&start, &end], heat);
            for (i, &row) in element.nodes.iter().enumerate() {
                let row = self.equations[row];
                if row == NONE {
                    continue;
                }
                residual[row] += forces[i];
                let Some((values, symmetry)) = &mut matrix else { continue };
                if heat.iter().any(|returned| returned.transfer.is_some()) {
                    **symmetry = Symmetry::Unsymmetric;
                }
                for (j, &column) in element.nodes.iter().enumerate() {
                    let column = self.equations[column];
                    if column != NONE
                        && let Some(place) = pattern.index(row, column)
                    {
                        values[place] += stiffness[i * count + j];
                    }
                }
            }
        }
    }

    /// Adds the nodal fluxes, each times a factor.
    fn add_fluxes(&self, factor: impl Fn(&Flux) -> f64, residual: &mut [f64]) {
        for (flux, nodal) in self.definition.fluxes.iter().zip(&self.fluxes) {
            let factor = factor(flux);
            for (value, &equation) in nodal.iter().zip(&self.equations) {
                if equation != NONE {
                    residual[equation] += factor * value;
                }
            }
        }
    }

    /// Makes the last attempt the committed state.
    pub(crate) fn commit(&mut self) {
        let values = std::mem::replace(&mut self.committed.values, self.next.clone());
        self.committed.earlier = values;
        self.committed.given.clone_from(&self.trial);
        self.committed.time = self.time;
    }

    /// The area of its cracks, mm², and their energy, N·mm; `None` if it is not known to have any.
    pub(crate) fn crack(&self) -> Option<[f64; 2]> {
        let FieldKind::PhaseField(Some(CrackSurface { fracture_energy, length })) = self.definition.kind else {
            return None;
        };
        let surface = |element: &FieldElement| element.surface(&self.committed.values, length);
        let area: f64 = self.elements.iter().map(surface).sum();
        Some([area, fracture_energy * area])
    }
}

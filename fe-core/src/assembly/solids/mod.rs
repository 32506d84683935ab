//! The solids: all material points through their UMATs, internal forces, element stiffnesses.
//!
//! # Flow
//!
//! [`Solids::evaluate`] leads every active element from its committed state to given end displacements: kinematics, one
//! call of the UMAT per point, forces, and, when tangents are asked for, stiffnesses. Nothing is committed before
//! [`Solids::commit`]; evaluations in between start from the same state, in any order.
//!
//! # What is skipped
//!
//! With [`crate::model::Skipping::unchanged_elements`]
//!
//! - an element whose end displacements are, to the last bit, those of its last evaluation from the same state gives
//!   the same forces again without a call;
//! - under small strains a stiffness is built again only when a DDSDDE of the element is another one, to the last bit.
//!
//! Neither changes a bit of the result. [`Solids::stiffness_version`] tells which stiffnesses are new.
//!
//! # Large displacements
//!
//! With `nlgeom` the kinematics are those of [`crate::kinematics::finite`], and stiffnesses are the exact derivative of
//! that incremental map, so [`Solids::symmetric`] is false, unless [`Solids::set_tangent_form`] asks for the usual
//! spatial form. Energies are counted per reference volume: what is dissipated
//! then never decreases.
//!
//! # Symmetry
//!
//! A DDSDDE that is symmetric but for rounding is made exactly so when it arrives; everything after decides by exact
//! equality.

mod element;
mod error;
mod kernel;
mod points;
mod record;
mod state;
mod summary;

pub use error::SolidsError;
pub use state::SolidsState;
pub use summary::{Counters, PointCall, PointCounts, PointView, SolidEnergies};

use super::{IncrementContext, Place, Trouble};
use crate::element::ElementKind;
use crate::kinematics::finite::TangentForm;
use crate::model::Model;
use element::{Motions, Task, advance_finite, advance_small, stiffness_finite, stiffness_small};
use kernel::Nodal;
use points::same_bits;
use record::{Body, Record, bodies, number_of};
use umat_abi::law::Request;

#[cfg(test)]
mod test;

/// Below this det F an increment is given up: the element is as good as inverted.
pub const LEAST_VOLUME_RATIO: f64 = 0.2;

/// Which tangent of its points an element's stiffness is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TangentChoice {
    /// DDSDDE of the increment: Newton's method converges quadratically.
    #[default]
    Consistent,
    /// DDSDDE of an increment of zero from the end state, where nothing grows: the secant at frozen damage, the elastic
    /// tangent of a plastic law.
    Frozen,
    /// DDSDDE of the virgin state.
    Elastic,
}

/// The solids of a model.
///
/// Indices of elements and points that the model does not have panic like those of a slice.
#[derive(Debug)]
pub struct Solids {
    /// Of the stabilisation, s.
    relaxation_time: f64,
    skip_unchanged: bool,
    tangent_form: TangentForm,
    bodies: Vec<Body>,
    records: Vec<Record>,
    active: Vec<bool>,
    /// Displacements of each element's nodes, element by element: committed, and of the last evaluation.
    committed: Vec<[f64; 2]>,
    evaluated: Vec<[f64; 2]>,
    /// Internal forces of the last evaluation, likewise.
    forces: Vec<[f64; 2]>,
    stiffnesses: Vec<f64>,
    version: u64,
    unsymmetric: usize,
    context: IncrementContext,
    counters: Counters,
}

impl Solids {
    /// The solids of a model, in their virgin state.
    ///
    /// # Errors
    ///
    /// A part without a usable law.
    pub fn new(model: &Model) -> Result<Self, SolidsError> {
        let (bodies, records) = bodies(model)?;
        let nodal = records.last().map_or(0, |record| record.nodal.end);
        let entries = records.last().map_or(0, |record| record.stiffness.end);
        Ok(Self {
            relaxation_time: model.controls.relaxation_time,
            skip_unchanged: model.skipping.unchanged_elements,
            tangent_form: TangentForm::default(),
            active: vec![true; records.len()],
            committed: vec![[0.0; 2]; nodal],
            evaluated: vec![[0.0; 2]; nodal],
            forces: vec![[0.0; 2]; nodal],
            stiffnesses: vec![0.0; entries],
            version: 0,
            unsymmetric: 0,
            context: IncrementContext::default(),
            counters: Counters::default(),
            bodies,
            records,
        })
    }

    /// Which elements are evaluated: the others are left as they are, and give no forces.
    ///
    /// # Panics
    ///
    /// If there is not one entry per element.
    pub fn set_active(&mut self, active: &[bool]) {
        self.active.copy_from_slice(active);
    }

    /// Which elements are evaluated.
    pub fn active(&self) -> &[bool] {
        &self.active
    }

    /// Whether the tangent of an element may be negative: its law damages, or does not say.
    pub fn softens(&self, element: usize) -> bool {
        self.bodies[self.records[element].part].softens
    }

    /// Which tangent an element's stiffness is made of from the next evaluation on.
    pub fn set_tangent_choice(&mut self, element: usize, choice: TangentChoice) {
        let record = &mut self.records[element];
        if record.choice != choice {
            record.choice = choice;
            record.has_tangent = false;
        }
    }

    /// Which derivative stiffnesses of large displacements are, from the next evaluation on. Small strains have one only.
    pub fn set_tangent_form(&mut self, form: TangentForm) {
        if self.tangent_form != form {
            self.tangent_form = form;
            self.records.iter_mut().for_each(|record| record.has_tangent = false);
        }
    }

    /// Leads the active elements from the committed state to these end displacements (two per node, mm) and adds their
    /// internal forces (N) to `forces`. With [`Request::StressAndTangent`] stiffnesses follow.
    ///
    /// # Errors
    ///
    /// A point whose law asks for a smaller increment or fails, or that collapses. `forces` are then incomplete.
    ///
    /// # Panics
    ///
    /// If `displacements` or `forces` do not hold two per node.
    pub fn evaluate(
        &mut self,
        displacements: &[f64],
        context: &IncrementContext,
        request: Request,
        forces: &mut [f64],
    ) -> Result<(), Trouble> {
        self.set_context(context);
        let (displacements, _) = displacements.as_chunks::<2>();
        let (forces, _) = forces.as_chunks_mut::<2>();
        for element in 0..self.records.len() {
            if !self.active[element] {
                continue;
            }
            match self.records[element].kind {
                ElementKind::T3 => self.evaluate_element::<3>(element, displacements, request)?,
                ElementKind::Q4 => self.evaluate_element::<4>(element, displacements, request)?,
                ElementKind::T6 => self.evaluate_element::<6>(element, displacements, request)?,
                ElementKind::Q8 => self.evaluate_element::<8>(element, displacements, request)?,
            }
            let record = &self.records[element];
            for (&node, [x, y]) in record.nodes().iter().zip(&self.forces[record.nodal.clone()]) {
                forces[node][0] += x;
                forces[node][1] += y;
            }
        }
        Ok(())
    }

    /// As [`Self::evaluate`], without the stabilisation: of elements that are condensed as elastic ones.
    ///
    /// # Errors
    ///
    /// As [`Self::evaluate`].
    pub fn evaluate_unstabilised(
        &mut self,
        displacements: &[f64],
        context: &IncrementContext,
        request: Request,
        forces: &mut [f64],
    ) -> Result<(), Trouble> {
        let relaxation_time = std::mem::take(&mut self.relaxation_time);
        let result = self.evaluate(displacements, context, request, forces);
        self.relaxation_time = relaxation_time;
        self.set_viscosity(relaxation_time);
        result
    }

    /// Only parts that may lose their stability need stabilisation.
    fn set_viscosity(&mut self, relaxation_time: f64) {
        let duration = self.context.time_increment;
        let viscosity = if duration > 0.0 { relaxation_time / duration } else { 0.0 };
        for body in &mut self.bodies {
            body.points.viscosity = if body.may_lose_stability { viscosity } else { 0.0 };
        }
    }

    /// Tells the laws of the increment. Times are arguments of a law: with others no result is kept.
    fn set_context(&mut self, context: &IncrementContext) {
        let times = |context: &IncrementContext| [context.step_time, context.total_time, context.time_increment];
        if !same_bits(&times(&self.context), &times(context)) {
            self.records.iter_mut().for_each(Record::forget);
        }
        self.context = *context;
        self.set_viscosity(self.relaxation_time);
        let from_one = |number: u32| i32::try_from(number).unwrap_or(i32::MAX);
        for body in &mut self.bodies {
            let call = &mut body.points.call;
            call.time = [context.step_time, context.total_time];
            call.dtime = context.dtime();
            call.jstep[0] = from_one(context.step);
            call.jstep[2] = i32::from(body.nlgeom);
            call.kinc = from_one(context.increment);
        }
    }

    fn evaluate_element<const N: usize>(
        &mut self,
        element: usize,
        displacements: &[[f64; 2]],
        request: Request,
    ) -> Result<(), Trouble> {
        let record = &mut self.records[element];
        let end: Nodal<N> = std::array::from_fn(|k| displacements[record.nodes()[k]]);
        let evaluated = &mut self.evaluated[record.nodal.clone()];
        let wants_tangent = request == Request::StressAndTangent;
        if self.skip_unchanged
            && record.is_evaluated
            && (record.has_tangent || !wants_tangent)
            && same_bits(end.as_flattened(), evaluated.as_flattened())
        {
            self.counters.skipped_evaluations += 1;
            return Ok(());
        }
        record.forget();
        let nlgeom = self.bodies[record.part].nlgeom;
        let (shape, points) = self.bodies[record.part].split::<N>(record);
        points.call.celent = record.characteristic_length;
        points.call.noel = number_of(element);
        let task = Task { request, choice: record.choice };
        let forces = &mut self.forces[record.nodal.clone()].as_chunks_mut::<N>().0[0];
        let changed = &mut record.moduli_changed;
        let motions = if nlgeom {
            let start = &self.committed[record.nodal.clone()].as_chunks::<N>().0[0];
            advance_finite(&shape, points, [start, &end], task, forces, changed).map(Some)
        } else {
            advance_small(&shape, points, &end, task, forces, changed).map(|()| None)
        };
        let motions = motions.map_err(|(point, trouble)| Trouble {
            place: Place::Element { element, point, position: shape.positions[point] },
            reason: trouble.reason,
            fraction: trouble.fraction,
        })?;
        evaluated.copy_from_slice(&end);
        (record.is_evaluated, record.has_tangent) = (true, wants_tangent);
        self.counters.evaluations += 1;
        if wants_tangent && (record.moduli_changed || nlgeom || !self.skip_unchanged) {
            self.build_stiffness::<N>(element, motions.as_ref());
        }
        Ok(())
    }

    /// The stiffness of the last evaluation, whose motions large displacements need.
    fn build_stiffness<const N: usize>(&mut self, element: usize, motions: Option<&Motions>) {
        let record = &mut self.records[element];
        let (shape, points) = self.bodies[record.part].split::<N>(record);
        let (rows, _) = self.stiffnesses[record.stiffness.clone()].as_chunks_mut::<2>();
        let (rows, _) = rows.as_chunks_mut::<N>();
        let is_symmetric = match motions {
            Some(motions) => stiffness_finite(&shape, motions, self.tangent_form, points, rows),
            None => stiffness_small(&shape, &points.moduli[record.points.clone()], rows),
        };
        self.version += 1;
        self.unsymmetric = self.unsymmetric + usize::from(!is_symmetric) - usize::from(record.is_unsymmetric);
        record.is_unsymmetric = !is_symmetric;
        record.moduli_changed = false;
        record.version = self.version;
        self.counters.stiffness_builds += 1;
    }

    /// ∂force/∂displacement of an element, row by row, freedoms ordered node by node as the mesh has them: of its last
    /// evaluation that asked for tangents; 0 before.
    pub fn stiffness(&self, element: usize) -> &[f64] {
        &self.stiffnesses[self.records[element].stiffness.clone()]
    }

    /// A number that grows whenever an element's stiffness is built; 0 before.
    pub fn stiffness_version(&self, element: usize) -> u64 {
        self.records[element].version
    }

    /// The greatest version of all elements.
    pub fn latest_version(&self) -> u64 {
        self.version
    }

    /// The elements whose stiffness was built after the latest version was `version`, ascending.
    pub fn changed_since(&self, version: u64) -> impl Iterator<Item = usize> {
        self.records.iter().enumerate().filter(move |(_, record)| record.version > version).map(|(element, _)| element)
    }

    /// Whether all stiffnesses are symmetric: all DDSDDE are, to the last bit, and displacements are small or the
    /// tangent's form is [`TangentForm::Spatial`].
    pub fn symmetric(&self) -> bool {
        self.unsymmetric == 0
    }

    /// Makes the state of the last evaluation the committed one, in every element whose last evaluation was at these
    /// displacements. The others (those that are not active) stay where they were and catch up when they are next
    /// evaluated.
    ///
    /// # Panics
    ///
    /// If `displacements` does not hold two per node.
    pub fn commit(&mut self, displacements: &[f64]) {
        let (displacements, _) = displacements.as_chunks::<2>();
        for record in &mut self.records {
            let evaluated = &self.evaluated[record.nodal.clone()];
            let mut pairs = record.nodes().iter().zip(evaluated);
            if record.is_evaluated && pairs.all(|(&node, own)| same_bits(&displacements[node], own)) {
                self.bodies[record.part].points.commit(record.points.clone());
                self.committed[record.nodal.clone()].copy_from_slice(evaluated);
            }
            record.forget();
        }
    }

    /// Gives the evaluations since the last commit up. Stiffnesses stay those of the last one.
    pub fn restore(&mut self) {
        self.records.iter_mut().for_each(Record::forget);
    }
}

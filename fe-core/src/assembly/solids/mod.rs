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
//! Neither changes a bit of the result.
//!
//! # Threads
//!
//! Elements are kept in blocks, each with its own points and UMAT call; with [`Solids::set_threads`] several threads
//! take blocks. Forces are added up element by element afterwards, in the order of the mesh, so the number of threads
//! changes no bit. A block stops at its first failing element and the others go on; the first failure in the order of
//! the mesh is reported. A model has one block for each part and one thread if its laws are not all known to be
//! thread-safe, or are watched. Sums over points run in the order of each part's elements, so the result has the same
//! bits too.
//!
//! # Large displacements
//!
//! With `nlgeom` the kinematics are those of [`crate::kinematics::finite`], and stiffnesses are the exact derivative of
//! that incremental map, so [`Solids::symmetric`] is false. Energies are counted per reference volume: what is dissipated
//! then never decreases.
//!
//! # Symmetry
//!
//! A DDSDDE that is symmetric up to rounding is made exactly symmetric when it arrives; all later decisions test exact
//! equality.

mod block;
mod element;
mod heat;
mod kernel;
mod points;
mod record;
mod state;
mod summary;
mod trust;

pub(crate) use heat::{PointField, ReturnedHeat};
pub use state::SolidsState;
pub(crate) use summary::Branch;
pub use summary::{Counters, GreatestInPart, PointCall, PointCounts, PointView, SolidEnergies};
pub use trust::PartAccount;

use super::{Location, PointFailure};
use crate::model::{Fields, IncrementContext, Model, ModelError, Step};
use crate::threads::Threads;
use block::{BlockPlace, ElementBlock, Evaluation};
use record::{Body, Divided, ElementData, blocks, may_share_threads};
use trust::Trust;
use umat_abi::host::same_bits;
use umat_abi::law::Request;

#[cfg(test)]
mod test;

/// Below this det F an increment is given up: the element is as good as inverted.
pub(crate) const LEAST_VOLUME_RATIO: f64 = 0.2;

/// Tangent of its points from which an element's stiffness is built.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
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
    /// Relaxation time of the stabilisation, s.
    relaxation_time: f64,
    skip_unchanged: bool,
    /// Whether the laws may be called by several threads.
    may_share_threads: bool,
    threads: Threads,
    blocks: Vec<ElementBlock>,
    /// Places of each element.
    places: Vec<BlockPlace>,
    active: Vec<bool>,
    version: u64,
    context: IncrementContext,
    fields: Fields,
    /// Steps over which the fields change.
    steps: Vec<Step>,
    /// Counts from before the present state was taken over.
    earlier: Counters,
    /// Notes on the laws for users.
    notes: Vec<String>,
    /// Trust in each part's law.
    trust: Vec<Trust>,
}

impl Solids {
    /// The solids of a model, in their virgin state.
    ///
    /// # Errors
    ///
    /// A part without a usable law.
    pub fn new(model: &Model) -> Result<Self, ModelError> {
        let may_share_threads = may_share_threads(&model.laws);
        let Divided { blocks, places, notes } = blocks(model, may_share_threads)?;
        let mut this = Self {
            relaxation_time: model.controls.relaxation_time,
            skip_unchanged: model.skipping.unchanged_elements,
            may_share_threads,
            threads: Threads::default(),
            active: vec![true; places.len()],
            version: 0,
            context: IncrementContext::default(),
            fields: model.fields.clone(),
            steps: model.steps.clone(),
            earlier: Counters::default(),
            notes,
            trust: model.laws.iter().map(Trust::new).collect(),
            blocks,
            places,
        };
        model.field.iter().for_each(|field| this.call_heat_routines(field));
        Ok(this)
    }

    /// The threads that evaluate blocks. Without an effect where a law may be called by one thread only.
    pub fn set_threads(&mut self, threads: &Threads) {
        if self.may_share_threads {
            self.threads = threads.clone();
        }
    }

    /// Sets the elements that are evaluated: the others are left as they are, and give no forces.
    ///
    /// # Panics
    ///
    /// If there is not one entry per element.
    pub(crate) fn set_active(&mut self, active: &[bool]) {
        self.active.copy_from_slice(active);
    }

    /// Returns which elements are evaluated.
    pub fn active(&self) -> &[bool] {
        &self.active
    }

    /// The block of an element.
    fn block(&self, element: usize) -> &ElementBlock {
        &self.blocks[self.places[element].block]
    }

    fn record(&self, element: usize) -> &ElementData {
        &self.block(element).records[self.places[element].local]
    }

    /// Returns the mean of the present per reference thickness at the points of an element with large displacements, by the trial state.
    pub(crate) fn thickness_ratio(&self, element: usize) -> f64 {
        let (points, record) = (&self.block(element).body.points, self.record(element));
        let count = record.points.len() as f64;
        record.points.clone().map(|point| points.thickness_ratio(point)).sum::<f64>() / count
    }

    /// Returns whether the tangent of an element may be negative: its law damages, or has no metadata on that.
    pub fn softens(&self, element: usize) -> bool {
        self.block(element).body.part.softens
    }

    /// Sets the tangent from which an element's stiffness is built from the next evaluation on.
    pub(crate) fn set_tangent_choice(&mut self, element: usize, choice: TangentChoice) {
        let BlockPlace { block, local } = self.places[element];
        let record = &mut self.blocks[block].records[local];
        if record.built.choice != choice {
            record.built.choice = choice;
            record.has_tangent = false;
        }
    }

    /// Leads the active elements from the committed state to these end displacements (two per node, mm) and adds their
    /// internal forces (N) to `forces`. With [`Request::StressAndTangent`] stiffnesses follow.
    ///
    /// # Errors
    ///
    /// A point whose law asks for a smaller increment or fails, or that collapses: that of the first element in
    /// trouble. `forces` are as they were then.
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
    ) -> Result<(), PointFailure> {
        self.set_context(context);
        let evaluation = Evaluation {
            displacements: displacements.as_chunks::<2>().0,
            active: &self.active,
            request,
            skip_unchanged: self.skip_unchanged,
            version: self.version + 1,
        };
        let builds =
            |blocks: &[ElementBlock]| -> u64 { blocks.iter().map(|block| block.counters.stiffness_builds).sum() };
        let before = builds(&self.blocks);
        let trouble = self.threads.least(
            &mut self.blocks,
            |block| block.evaluate(&evaluation).err(),
            |trouble| match trouble.place {
                Location::Element { element, .. } => Some(element),
                _ => None,
            },
        );
        self.version += u64::from(builds(&self.blocks) > before);
        if let Some(trouble) = trouble {
            return Err(trouble);
        }
        let (forces, _) = forces.as_chunks_mut::<2>();
        for (place, _) in self.places.iter().zip(&self.active).filter(|(_, active)| **active) {
            let block = &self.blocks[place.block];
            let record = &block.records[place.local];
            for (&node, [x, y]) in record.nodes().iter().zip(&block.forces[record.nodal.clone()]) {
                forces[node][0] += x;
                forces[node][1] += y;
            }
        }
        Ok(())
    }

    /// Evaluates as [`Self::evaluate`] does, without the stabilisation: of elements that are condensed as elastic ones.
    pub(crate) fn evaluate_unstabilised(
        &mut self,
        displacements: &[f64],
        context: &IncrementContext,
        request: Request,
        forces: &mut [f64],
    ) -> Result<(), PointFailure> {
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
        for Body { part, points, .. } in self.blocks.iter_mut().map(|block| &mut block.body) {
            points.viscosity = if part.may_lose_stability { viscosity } else { 0.0 };
        }
    }

    /// Passes the increment to the laws. Times are arguments of a law: results for other times are discarded.
    fn set_context(&mut self, context: &IncrementContext) {
        let times = |context: &IncrementContext| [context.step_time, context.total_time, context.time_increment];
        if !same_bits(&times(&self.context), &times(context)) || self.context.step != context.step {
            self.restore();
        }
        self.context = *context;
        if self.fields.change() {
            let [start, end] = self.fields.over(&self.steps, context);
            self.blocks.iter_mut().for_each(|block| block.set_fields(&start, &end));
        }
        self.set_viscosity(self.relaxation_time);
        self.blocks.iter_mut().for_each(|block| block.set_context(context));
    }

    /// ∂force/∂displacement of an element, row by row, freedoms ordered node by node as the mesh has them: of its last
    /// evaluation that asked for tangents; 0 before.
    pub fn stiffness(&self, element: usize) -> &[f64] {
        &self.block(element).stiffnesses[self.record(element).stiffness.clone()]
    }

    /// A number that grows whenever an evaluation builds stiffnesses.
    pub(crate) fn latest_version(&self) -> u64 {
        self.version
    }

    /// Returns whether all stiffnesses are symmetric: all DDSDDE are, to the last bit, and displacements are small.
    pub fn symmetric(&self) -> bool {
        self.blocks.iter().all(|block| block.unsymmetric == 0)
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
        self.blocks.iter_mut().for_each(|block| block.commit(displacements));
    }

    /// Releases elements after an accepted increment. Their laws are no longer called, and their forces are those of
    /// that increment times a share. Their states stay, except for stress and stored energy.
    pub fn release(&mut self, elements: &[usize]) {
        for &element in elements {
            let BlockPlace { block, local } = self.places[element];
            self.blocks[block].release(local);
        }
    }

    /// Sets what part of its forces a released element still has, from the next evaluation on; others have all of theirs.
    pub(crate) fn set_share(&mut self, element: usize, share: f64) {
        let BlockPlace { block, local } = self.places[element];
        self.blocks[block].set_share(local, share);
    }

    /// Discards the evaluations since the last commit. Stiffnesses stay those of the last one.
    pub fn restore(&mut self) {
        self.blocks.iter_mut().for_each(ElementBlock::forget);
    }
}

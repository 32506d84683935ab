//! A block: some elements of one part with everything that is known of them, so that one thread can evaluate it while
//! others have their own.

use super::element::{
    Motions, Task, advance_finite, advance_small, coupling, motions, stiffness_finite, stiffness_small,
};
use super::heat::ElementCoupling;
use super::kernel::Nodal;
use super::record::{Body, ElementData, Spalled, number_of};
use super::summary::Counters;
use crate::assembly::{Location, PointFailure};
use crate::element::WithNodeCount;
use crate::model::{FieldValues, IncrementContext};
use umat_abi::host::same_bits;
use umat_abi::law::Request;

/// Block of an element, and its place in it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BlockPlace {
    pub(super) block: usize,
    pub(super) local: usize,
}

/// Request to all blocks.
pub(super) struct Evaluation<'a> {
    /// Two per node, mm.
    pub(super) displacements: &'a [[f64; 2]],
    /// True for elements that are evaluated.
    pub(super) active: &'a [bool],
    pub(super) request: Request,
    pub(super) skip_unchanged: bool,
    /// Version of stiffnesses that are built.
    pub(super) version: u64,
}

/// Evaluation of an element of a block.
struct ElementOfBlock<'a, 'e> {
    block: &'a mut ElementBlock,
    local: usize,
    evaluation: &'a Evaluation<'e>,
}

impl WithNodeCount<Result<(), PointFailure>> for ElementOfBlock<'_, '_> {
    fn run<const N: usize>(self) -> Result<(), PointFailure> {
        self.block.evaluate_element::<N>(self.local, self.evaluation)
    }
}

/// An element of a block whose coupling with a field is wanted.
struct CouplingOfElement<'b> {
    block: &'b ElementBlock,
    local: usize,
}

impl WithNodeCount<ElementCoupling> for CouplingOfElement<'_> {
    fn run<const N: usize>(self) -> ElementCoupling {
        self.block.coupling_of::<N>(self.local)
    }
}

/// Some elements of one part.
#[derive(Debug)]
pub(super) struct ElementBlock {
    pub(super) body: Body,
    pub(super) records: Vec<ElementData>,
    /// Displacements of each element's nodes, element by element: committed, and of the last evaluation.
    pub(super) committed: Vec<[f64; 2]>,
    evaluated: Vec<[f64; 2]>,
    /// Internal forces of the last evaluation, likewise.
    pub(super) forces: Vec<[f64; 2]>,
    pub(super) stiffnesses: Vec<f64>,
    /// Number of unsymmetric stiffnesses.
    pub(super) unsymmetric: usize,
    /// All but the calls of the UMAT, which the points count.
    pub(super) counters: Counters,
}

impl ElementBlock {
    /// Elements in their virgin state.
    pub(super) fn new(body: Body, records: Vec<ElementData>) -> Self {
        let nodal = records.last().map_or(0, |record| record.nodal.end);
        let entries = records.last().map_or(0, |record| record.stiffness.end);
        Self {
            body,
            records,
            committed: vec![[0.0; 2]; nodal],
            evaluated: vec![[0.0; 2]; nodal],
            forces: vec![[0.0; 2]; nodal],
            stiffnesses: vec![0.0; entries],
            unsymmetric: 0,
            counters: Counters::default(),
        }
    }

    /// Discards the last evaluations.
    pub(super) fn forget(&mut self) {
        self.records.iter_mut().for_each(ElementData::forget);
    }

    /// Passes the increment to the law.
    pub(super) fn set_context(&mut self, context: &IncrementContext) {
        let from_one = |number: u32| i32::try_from(number).unwrap_or(i32::MAX);
        let call = &mut self.body.points.call;
        call.time = [context.step_time, context.total_time];
        call.dtime = context.dtime();
        call.jstep[0] = from_one(context.step);
        call.jstep[2] = i32::from(self.body.part.nlgeom);
        call.kinc = from_one(context.increment);
    }

    /// Passes temperature and field variables at the start and at the end of the increment to the law.
    pub(super) fn set_fields(&mut self, start: &FieldValues, end: &FieldValues) {
        let call = &mut self.body.points.call;
        (call.temp, call.dtemp) = (start.temperature, end.temperature - start.temperature);
        // there is always one that a law may read
        if !start.variables.is_empty() {
            call.predef.clone_from(&start.variables);
            call.dpred = start.variables.iter().zip(&end.variables).map(|(start, end)| end - start).collect();
        }
    }

    /// Evaluates the active elements, up to the first in trouble.
    pub(super) fn evaluate(&mut self, evaluation: &Evaluation<'_>) -> Result<(), PointFailure> {
        for local in 0..self.records.len() {
            let ElementData { element, kind, .. } = self.records[local];
            if !evaluation.active[element] {
                continue;
            }
            kind.with_node_count(ElementOfBlock { block: self, local, evaluation })?;
        }
        Ok(())
    }

    fn evaluate_element<const N: usize>(
        &mut self,
        local: usize,
        evaluation: &Evaluation<'_>,
    ) -> Result<(), PointFailure> {
        let Evaluation { displacements, request, skip_unchanged, .. } = *evaluation;
        let wants_tangent = request.wants_tangent();
        let record = &mut self.records[local];
        let end: Nodal<N> = std::array::from_fn(|k| displacements[record.nodes()[k]]);
        let evaluated = &mut self.evaluated[record.nodal.clone()];
        if skip_unchanged
            && record.is_evaluated
            && (record.has_tangent || !wants_tangent)
            && same_bits(end.as_flattened(), evaluated.as_flattened())
        {
            self.counters.skipped_evaluations += 1;
            return Ok(());
        }
        record.forget();
        if record.built.spalled.is_some() {
            self.evaluate_spalled::<N>(local, &end, evaluation);
            return Ok(());
        }
        let nlgeom = self.body.part.nlgeom;
        let (shape, points) = self.body.split::<N>(record);
        points.call.celent = record.characteristic_length;
        points.call.noel = number_of(record.element);
        let task = Task { request, choice: record.built.choice };
        let forces = &mut self.forces[record.nodal.clone()].as_chunks_mut::<N>().0[0];
        let changed = &mut record.built.moduli_changed;
        let motions = if nlgeom {
            let start = &self.committed[record.nodal.clone()].as_chunks::<N>().0[0];
            advance_finite(&shape, points, [start, &end], task, forces, changed).map(Some)
        } else {
            advance_small(&shape, points, &end, task, forces, changed).map(|()| None)
        };
        let element = record.element;
        let place = |point: usize| Location::Element { element, point, position: shape.positions[point] };
        let motions = motions.map_err(|(point, trouble)| trouble.at(place(point)))?;
        evaluated.copy_from_slice(&end);
        (record.is_evaluated, record.has_tangent) = (true, wants_tangent);
        self.counters.evaluations += 1;
        if wants_tangent && (record.built.moduli_changed || nlgeom || !skip_unchanged) {
            self.build_stiffness::<N>(local, motions.as_ref(), evaluation);
        }
        Ok(())
    }

    /// Evaluates the remaining forces of a released element at the end displacements of its nodes.
    fn evaluate_spalled<const N: usize>(&mut self, local: usize, end: &Nodal<N>, evaluation: &Evaluation<'_>) {
        if self.records[local].built.moduli_changed {
            self.build_stiffness::<N>(local, None, evaluation);
        }
        let record = &mut self.records[local];
        let nodal = record.nodal.clone();
        if let Some(spalled) = &mut record.built.spalled {
            let stiffness = &self.stiffnesses[record.stiffness.clone()];
            spalled.act([&self.committed[nodal.clone()], end], stiffness, &mut self.forces[nodal.clone()]);
        }
        self.evaluated[nodal].copy_from_slice(end);
        (record.is_evaluated, record.has_tangent) = (true, true);
    }

    /// Sets what part of its forces a released element still has.
    pub(super) fn set_share(&mut self, local: usize, share: f64) {
        let Self { body, records, .. } = self;
        let record = &mut records[local];
        let Some(spalled) = &mut record.built.spalled else { return };
        let part = spalled.set_share(share);
        let points = &mut body.points;
        for point in record.points.clone() {
            points.moduli[point] = points.elastic.map(|row| row.map(|modulus| part * modulus));
        }
        record.built.moduli_changed = true;
        record.forget();
    }

    /// The stiffness of the last evaluation, whose motions large displacements need.
    fn build_stiffness<const N: usize>(
        &mut self,
        local: usize,
        motions: Option<&Motions>,
        evaluation: &Evaluation<'_>,
    ) {
        let record = &mut self.records[local];
        let (shape, points) = self.body.split::<N>(record);
        let (rows, _) = self.stiffnesses[record.stiffness.clone()].as_chunks_mut::<2>();
        let (rows, _) = rows.as_chunks_mut::<N>();
        let is_symmetric = match motions {
            Some(motions) => {
                stiffness_finite(&shape, motions, points, rows);
                false
            }
            None => stiffness_small(&shape, &points.moduli[record.points.clone()], rows),
        };
        self.unsymmetric = self.unsymmetric + usize::from(!is_symmetric) - usize::from(record.built.is_unsymmetric);
        record.built.is_unsymmetric = !is_symmetric;
        record.built.moduli_changed = false;
        record.built.version = evaluation.version;
        self.counters.stiffness_builds += 1;
    }

    /// How forces and sources of an element depend on the field and on displacements, at its last evaluation.
    pub(super) fn coupling(&self, local: usize) -> ElementCoupling {
        self.records[local].kind.with_node_count(CouplingOfElement { block: self, local })
    }

    fn coupling_of<const N: usize>(&self, local: usize) -> ElementCoupling {
        let record = &self.records[local];
        if record.built.spalled.is_some() {
            let none = vec![0.0; 2 * N * N];
            return ElementCoupling { force_by_field: none.clone(), source_by_displacement: none };
        }
        let shape = self.body.reference::<N>(record);
        let [start, end] =
            [&self.committed, &self.evaluated].map(|all| &all[record.nodal.clone()].as_chunks::<N>().0[0]);
        // an element that cannot move so has been refused
        let motions = if self.body.part.nlgeom { motions(&shape, [start, end]).ok() } else { None };
        coupling(&shape, &self.body.points, motions.as_ref().map(|(motions, _)| motions))
    }

    /// Releases an element after an increment that was accepted.
    pub(super) fn release(&mut self, local: usize) {
        let Self { body, records, forces, committed, .. } = self;
        let record = &mut records[local];
        let points = &mut body.points;
        let mut stored = 0.0;
        for point in record.points.clone() {
            stored += points.committed.reference_energies[point][0] * body.volumes[point];
            for states in [&mut points.committed, &mut points.trial] {
                states.reference_energies[point][0] = 0.0;
                states.stress[point] = [0.0; 4];
            }
        }
        let nodal = record.nodal.clone();
        record.built.spalled = Some(Spalled::new(&forces[nodal.clone()], &committed[nodal], stored));
        self.set_share(local, 1.0);
    }

    /// Takes over the states of elements whose last evaluation was at these displacements.
    pub(super) fn commit(&mut self, displacements: &[[f64; 2]]) {
        for record in &mut self.records {
            let evaluated = &self.evaluated[record.nodal.clone()];
            let mut pairs = record.nodes().iter().zip(evaluated);
            if record.is_evaluated && pairs.all(|(&node, own)| same_bits(&displacements[node], own)) {
                self.body.points.commit(record.points.clone());
                self.committed[record.nodal.clone()].copy_from_slice(evaluated);
                if let Some(spalled) = &mut record.built.spalled {
                    spalled.commit();
                }
            }
            record.forget();
        }
    }
}

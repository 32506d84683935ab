//! A temperature of its own for each point, and the heat that its law returns.

use super::Solids;
use super::block::BlockPlace;
use crate::kinematics::finite::Components;
use crate::model::ScalarField;
use umat_abi::host::{GRADIENTS, Transfer, same_bits};

/// The field at a point.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PointField {
    /// TEMP, and TEMP + DTEMP.
    pub(crate) ends: [f64; 2],
    /// Its gradient at the end.
    pub(crate) gradient: [f64; GRADIENTS],
}

/// Heat that a law returned at a point.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ReturnedHeat {
    /// RPL and DRPLDT, with FLUX of HETVAL.
    pub(crate) source: [f64; 2],
    /// The answer of UMATHT, if there is one, with the increment of U in the place of U.
    pub(crate) transfer: Option<Transfer>,
    /// DDSDDT, and DRPLDE.
    pub(super) coupling: [Components; 2],
}

/// Derivatives of an element's nodal forces and sources.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ElementCoupling {
    /// ∂f/∂θ: the two forces of each node, for one node of the field after the other.
    pub(crate) force_by_field: Vec<f64>,
    /// ∂(∫ N_i r dV)/∂u: by the two displacements of each node, for one N_i after the other.
    pub(crate) source_by_displacement: Vec<f64>,
}

/// Temperature of the points of a block, and heat: nothing without a field.
#[derive(Clone, Debug, Default)]
pub(super) struct PointHeat {
    fields: Vec<PointField>,
    /// What the last call returned.
    returned: Vec<ReturnedHeat>,
}

impl PointHeat {
    /// The field at a point, if it has its own.
    #[inline]
    pub(super) fn field(&self, point: usize) -> Option<PointField> {
        self.fields.get(point).copied()
    }

    /// Notes what the law returned.
    #[inline]
    pub(super) fn note(&mut self, point: usize, returned: ReturnedHeat) {
        self.returned[point] = returned;
    }

    /// DDSDDT and DRPLDE of the last call at a point.
    #[inline]
    pub(super) fn coupling(&self, point: usize) -> [Components; 2] {
        self.returned[point].coupling
    }
}

impl Solids {
    /// Makes HETVAL and UMATHT of the libraries follow the laws of the parts that have a field, as it says.
    pub(super) fn call_heat_routines(&mut self, field: &ScalarField) {
        for block in self.blocks.iter_mut().filter(|block| field.parts[block.body.index]) {
            let points = &mut block.body.points;
            if field.has_generation {
                points.call.generate_heat();
            }
            if let Some(transfer) = &field.transfer {
                points.transfer_heat(&transfer.props);
            }
        }
    }

    /// Makes what UMATHT returned in the virgin state, without an increment, the start of the first one.
    pub(crate) fn begin_transfer(&mut self) {
        for block in &mut self.blocks {
            let points = &mut block.body.points;
            points.committed.transfer.clone_from(&points.trial.transfer);
        }
    }

    /// Gives the points of an element the field. The element is evaluated again if it changes.
    pub(crate) fn set_field(&mut self, element: usize, field: impl Iterator<Item = PointField>) {
        let BlockPlace { block, local } = self.places[element];
        let block = &mut self.blocks[block];
        let record = &mut block.records[local];
        let count = block.body.volumes.len();
        let points = &mut block.body.points;
        let reads_gradient = !points.committed.transfer.is_empty();
        let own = &mut points.heat;
        own.fields.resize(count, PointField::default());
        own.returned.resize(count, ReturnedHeat::default());
        for (own, given) in own.fields[record.points.clone()].iter_mut().zip(field) {
            let is_same = same_bits(&own.ends, &given.ends);
            if !is_same || (reads_gradient && !same_bits(&own.gradient, &given.gradient)) {
                record.forget();
            }
            *own = given;
        }
    }

    /// What the laws at the points of an element returned at its last evaluation.
    pub(crate) fn heat(&self, element: usize) -> &[ReturnedHeat] {
        &self.block(element).body.points.heat.returned[self.record(element).points.clone()]
    }

    /// How forces and sources of an element depend on the field and on displacements, by DDSDDT and DRPLDE at its last evaluation.
    pub(crate) fn coupling(&self, element: usize) -> ElementCoupling {
        self.block(element).coupling(self.places[element].local)
    }
}

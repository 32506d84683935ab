//! A temperature of its own for each point, and the heat that its law returns.

use super::Solids;
use super::block::BlockPlace;
use umat_abi::host::same_bits;

/// Temperature of the points of a block, and heat: nothing without a field.
#[derive(Clone, Debug, Default)]
pub(super) struct PointHeat {
    /// TEMP, and TEMP + DTEMP.
    temperatures: Vec<[f64; 2]>,
    /// RPL and DRPLDT of the last call.
    heat: Vec<[f64; 2]>,
}

impl PointHeat {
    /// The temperatures of a point at the start and at the end of the increment, if it has its own.
    #[inline]
    pub(super) fn temperature(&self, point: usize) -> Option<[f64; 2]> {
        self.temperatures.get(point).copied()
    }

    /// Notes what the law returned, where somebody asks for it.
    #[inline]
    pub(super) fn note(&mut self, point: usize, heat: impl FnOnce() -> [f64; 2]) {
        if let Some(noted) = self.heat.get_mut(point) {
            *noted = heat();
        }
    }
}

impl Solids {
    /// Gives the points of an element temperatures at the start and at the end of the increment. The element is evaluated again if
    /// they change.
    pub(crate) fn set_temperatures(&mut self, element: usize, temperatures: impl Iterator<Item = [f64; 2]>) {
        let BlockPlace { block, local } = self.places[element];
        let block = &mut self.blocks[block];
        let record = &mut block.records[local];
        let count = block.body.volumes.len();
        let own = &mut block.body.points.heat;
        own.temperatures.resize(count, [0.0; 2]);
        own.heat.resize(count, [0.0; 2]);
        for (own, given) in own.temperatures[record.points.clone()].iter_mut().zip(temperatures) {
            if !same_bits(own, &given) {
                *own = given;
                record.forget();
            }
        }
    }

    /// RPL and DRPLDT of the points of an element at its last evaluation.
    pub(crate) fn heat(&self, element: usize) -> &[[f64; 2]] {
        &self.block(element).body.points.heat.heat[self.record(element).points.clone()]
    }
}

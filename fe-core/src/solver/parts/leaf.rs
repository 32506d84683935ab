//! A part that is not cut: sparse, its border condensed.

use faer::{Mat, MatRef};

use super::{Elimination, Substructure};
use crate::solver::zone::SchurComplement;
use crate::solver::{Pattern, SolverError};
use crate::threads::Threads;

pub(super) struct Leaf {
    /// Equations in the system and those of its border, ascending.
    equations: Vec<usize>,
    /// Indices of the values of its matrix among those of the system.
    from: Vec<usize>,
    values: Vec<f64>,
    /// Whether there is a factor of these values.
    is_factorised: bool,
    zone: SchurComplement,
    /// The border in the system, ascending, and the place in the zone of each.
    border: Vec<usize>,
    place_in_zone: Vec<usize>,
    /// S in the order of the border: of the lower triangle.
    schur: Mat<f64>,
    x: Vec<f64>,
    ordered: Vec<f64>,
    border_part: Vec<f64>,
}

impl Leaf {
    /// The part of the equations `inside`.
    pub(super) fn new(
        pattern: &Pattern,
        nodes: &[usize],
        positions: &[[f64; 2]],
        inside: &[usize],
    ) -> Result<Self, SolverError> {
        let mut is_inside = vec![false; pattern.size()];
        inside.iter().for_each(|&equation| is_inside[equation] = true);
        let rows = inside.iter().flat_map(|&equation| pattern.column(equation)).copied();
        let mut border: Vec<usize> = rows.filter(|&row| !is_inside[row]).collect();
        border.sort_unstable();
        border.dedup();
        let mut equations = [inside, &border].concat();
        equations.sort_unstable();
        let (own, from) = pattern.restricted_to(&equations);
        let own_nodes: Vec<usize> = equations.iter().map(|&equation| nodes[equation]).collect();
        let own_positions: Vec<[f64; 2]> = equations.iter().map(|&equation| positions[equation]).collect();
        let last: Vec<usize> = (0..equations.len()).filter(|&k| !is_inside[equations[k]]).collect();
        let zone = SchurComplement::new(&own, &own_nodes, &own_positions, &last)?;
        let (size, count) = (equations.len(), border.len());
        Ok(Self {
            values: vec![0.0; from.len()],
            from,
            is_factorised: false,
            place_in_zone: last.iter().map(|&k| zone.place_of[k]).collect(),
            zone,
            border,
            schur: Mat::zeros(count, count),
            x: vec![0.0; size],
            ordered: vec![0.0; size],
            border_part: vec![0.0; count],
            equations,
        })
    }
}

impl Substructure for Leaf {
    fn border(&self) -> &[usize] {
        &self.border
    }

    fn each_leaf(&self, give: &mut dyn FnMut(&[usize])) {
        give(&self.border);
    }

    fn forget(&mut self) {
        self.is_factorised = false;
    }

    fn factorise(&mut self, values: &[f64], _: &Threads) -> Elimination {
        let mut is_same = self.is_factorised;
        for (value, &from) in self.values.iter_mut().zip(&self.from) {
            is_same &= value.to_bits() == values[from].to_bits();
            *value = values[from];
        }
        if is_same {
            return Elimination::Unchanged;
        }
        self.is_factorised = self.zone.condense(&self.values).is_ok();
        if !self.is_factorised {
            return Elimination::Refused;
        }
        for (column, &from) in self.place_in_zone.iter().enumerate() {
            for row in column..self.border.len() {
                self.schur[(row, column)] = self.zone.schur[(self.place_in_zone[row], from)];
            }
        }
        Elimination::Done(self.zone.flops())
    }

    fn schur(&self) -> MatRef<'_, f64> {
        self.schur.as_ref()
    }

    fn forward(&mut self, right_side: &[f64], _: &Threads) {
        self.x.iter_mut().zip(&self.equations).for_each(|(value, &equation)| *value = right_side[equation]);
        self.zone.gather(&self.x, &mut self.ordered);
        let first = self.ordered.len() - self.border.len();
        self.ordered[first..].fill(0.0);
        self.zone.forward(&mut self.ordered);
        let in_zone = &self.ordered[first..];
        self.border_part.iter_mut().zip(&self.place_in_zone).for_each(|(value, &place)| *value = in_zone[place]);
    }

    fn border_part(&self) -> &[f64] {
        &self.border_part
    }

    fn backward(&mut self, x: &[f64], places: &[usize], _: &Threads) {
        let first = self.ordered.len() - self.border.len();
        for (&in_zone, &place) in self.place_in_zone.iter().zip(places) {
            self.ordered[first + in_zone] = x[place];
        }
        self.zone.backward(&mut self.ordered);
        self.zone.scatter(&self.ordered, &mut self.x);
    }

    /// The border too, to other bits than where it was found: that is written later.
    fn collect(&self, x: &mut [f64]) {
        self.equations.iter().zip(&self.x).for_each(|(&equation, value)| x[equation] = *value);
    }

    fn entries(&self) -> usize {
        self.zone.entries()
    }
}

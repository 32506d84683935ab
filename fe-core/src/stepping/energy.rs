//! The energy balance of a run.
//!
//! ```text
//! external work = elastic + plastic + damage + spalled + unaccounted + interface + opening + stabilisation
//! ```
//!
//! External work is a trapezoidal sum over increments of reactions times the drives, loads times displacements and pressures times the
//! overlaps that interferences add;
//! the solids' parts are what the laws report (of a law whose energies cannot be believed, a trapezoidal sum of stresses
//! times strains, which is stored or dissipated: unaccounted), the interface's a trapezoidal sum of tractions times relative
//! displacements. The two sides are computed apart from each other: their difference is the error of both.

use super::newton::{Committed, dot};
use crate::assembly::Equations;
use serde::{Deserialize, Serialize};

/// Energies since the start of the run, N mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energies {
    /// Work of supports that move, of loads and of interferences.
    pub external_work: f64,
    /// Stored in the solids.
    pub elastic: f64,
    /// Dissipated by laws without damage.
    pub plastic: f64,
    /// Dissipated by laws with damage.
    pub damage: f64,
    /// Lost with elements that were released: what they stored, and the work of their fading forces.
    pub spalled: f64,
    /// Work of the stresses of laws whose energies cannot be believed.
    pub unaccounted: f64,
    /// Work of the interfaces: stored and dissipated.
    pub interface: f64,
    /// The part of it that laws and penalties say can be had back.
    pub interface_stored: f64,
    /// Spent on opening bonded interfaces and lost where contact fades at an end.
    pub opening: f64,
    /// Spent on what helps over instabilities: viscous stress, the overstress of laws that extrapolate, drag on contact.
    pub stabilisation: f64,
}

impl Energies {
    /// Returns what the interfaces have dissipated.
    pub fn interface_dissipation(&self) -> f64 {
        self.interface - self.interface_stored
    }

    /// External work less all that it went into.
    pub fn imbalance(&self) -> f64 {
        self.external_work - (self.elastic + self.interface_stored) - self.spent()
    }

    /// Returns what cannot be had back.
    pub(super) fn spent(&self) -> f64 {
        self.plastic
            + self.damage
            + self.spalled
            + self.unaccounted
            + (self.interface_dissipation() + self.opening + self.stabilisation)
    }

    /// Returns what was added since a datum.
    pub(super) fn since(&self, datum: &Self) -> Self {
        Self {
            external_work: self.external_work - datum.external_work,
            elastic: self.elastic - datum.elastic,
            plastic: self.plastic - datum.plastic,
            damage: self.damage - datum.damage,
            spalled: self.spalled - datum.spalled,
            unaccounted: self.unaccounted - datum.unaccounted,
            interface: self.interface - datum.interface,
            interface_stored: self.interface_stored - datum.interface_stored,
            opening: self.opening - datum.opening,
            stabilisation: self.stabilisation - datum.stabilisation,
        }
    }

    /// The work of supports and loads between two states.
    pub(super) fn work_between(equations: &Equations, start: &Committed, end: &Committed) -> f64 {
        let mean = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect() };
        let change = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| b - a).collect() };
        let reactions = equations.drive_forces(&mean(&start.reactions, &end.reactions));
        let by_supports = dot(&reactions, &change(&start.drives, &end.drives));
        let loads = mean(&start.external, &end.external);
        by_supports + dot(&loads, &change(&start.displacements, &end.displacements))
    }
}

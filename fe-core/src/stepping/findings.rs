//! Findings by which an increment that converged is judged: its load, its slips, and what its energies miss.

use super::control::Findings;
use super::newton::{Committed, Converged, Equilibrium, largest};
use super::{Analysis, Energies, Snapshot};
use crate::field::Field;
use crate::stepping::constants::{LEAST_DISSIPATION, ROUNDINGS};

impl Analysis<'_> {
    /// Returns the quantities that a converged increment is judged by.
    pub(super) fn findings(&self, converged: &Converged) -> Findings {
        let Equilibrium { solids, contact, .. } = &self.equilibrium;
        let trial = Snapshot { committed: &converged.end, ..self.snapshot() };
        let [load, _] = self.measured_load(&trial);
        let drive = |state: &Committed| self.model.measured.slip_of(&state.drives);
        let is_driven_alone = self.model.is_driven_alone();
        let [energy_error_before, energy_error] =
            if is_driven_alone { self.energy_errors_of(&converged.end) } else { [0.0; 2] };
        let external_work = self.external_work_at(&converged.end);
        let overstress = if self.model.extrapolates() {
            let reference = self.work_reference(external_work, &converged.end);
            let spent = solids.trial_energies().overstress - solids.energies().overstress;
            if reference > 0.0 { spent / reference } else { 0.0 }
        } else {
            0.0
        };
        Findings {
            load: load.abs(),
            wire_utilisations: self.present.stretches.utilisations(&self.snapshot(), &trial),
            pulls_on: (drive(&converged.end) - drive(&self.present.committed)) * load > 0.0,
            field_departs: self.equilibrium.field.as_ref().is_some_and(Field::departs),
            slip_growth: contact.largest_slip_growth(),
            energy_error,
            energy_error_before,
            overstress,
            stabilisation_before: self.stabilisation_share(),
            gives_back: is_driven_alone && self.gives_back(external_work - self.present.energies.external_work),
        }
    }

    /// Returns whether an increment gives energy back that it does not take from what fails: elastic unloading. `work`: that of the
    /// increment.
    fn gives_back(&self, work: f64) -> bool {
        // sums over all points
        let spent = || self.equilibrium.trial_energies().since(&self.equilibrium.energies()).spent();
        work < 0.0 && spent() < LEAST_DISSIPATION * -work
    }

    /// Returns what a converged increment is judged by, once laws that report energies which nobody can believe are found. `refused`:
    /// the increment's size if its energies do not balance.
    pub(super) fn believed_findings(
        &mut self,
        findings: Findings,
        converged: &Converged,
        refused: Option<f64>,
    ) -> Findings {
        if !self.equilibrium.solids.has_unproven_energies() {
            return findings;
        }
        let end = &converged.end;
        let added = findings.energy_error * self.work_reference(self.external_work_at(end), end);
        let refused = refused.map(|size| [size, added]);
        let found = self.equilibrium.solids.judge_energies(refused);
        if found.is_empty() {
            return findings;
        }
        for part in found {
            let Some(account) = self.present.datum_accounts.get(part) else { continue };
            let datum = &mut self.present.datum;
            datum.elastic -= account.stored;
            *if account.damages { &mut datum.damage } else { &mut datum.plastic } -= account.dissipated;
            datum.unaccounted += account.work;
        }
        self.book_energies(self.present.energies.external_work);
        self.findings(converged)
    }

    /// The imbalance of the energies, and what an increment would add to it, relative to the work at its end.
    fn energy_errors_of(&self, end: &Committed) -> [f64; 2] {
        let external_work = self.external_work_at(end);
        let energies = Energies { external_work, ..self.equilibrium.trial_energies().since(&self.present.datum) };
        let reference = self.work_reference(external_work, end);
        let before = self.present.energies.imbalance();
        let relative = |imbalance: f64| if reference > 0.0 { imbalance / reference } else { 0.0 };
        [before, energies.imbalance() - before].map(relative)
    }

    /// The work of supports, loads and interferences up to the end of an increment, N mm.
    fn external_work_at(&self, end: &Committed) -> f64 {
        self.present.energies.external_work + self.work_to(end)
    }

    /// Returns the work of an increment to this end, N mm: of supports, loads and interferences.
    pub(super) fn work_to(&self, end: &Committed) -> f64 {
        let Equilibrium { system, contact, .. } = &self.equilibrium;
        Energies::work_between(system.equations(), &self.present.committed, end) + contact.fitting_work()
    }

    /// Returns what an imbalance of the energies is compared with, N mm: the largest work so far, for that of a specimen which gives its
    /// energy back passes through 0.
    pub(super) fn work_reference(&self, external_work: f64, state: &Committed) -> f64 {
        let rounding = self.equilibrium.memory.rounding * largest(&state.displacements);
        external_work.abs().max(self.present.greatest_work).max(ROUNDINGS * rounding)
    }
}

//! Records of increments, and their observers.

use super::{Analysis, Checkpoint, Energies, Iteration, Snapshot, Tried};
use crate::assembly::GreatestInPart;
use crate::field::Field;
use std::io;

/// Results of one accepted increment, or of the initial state (step 0, increment 0).
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Step, from 1; 0 for the initial state.
    pub step: u32,
    /// Increment within the step, from 1; 0 for the initial state.
    pub increment: u32,
    /// Total time at its end, s.
    pub time: f64,
    /// Value of the measured drive, mm.
    pub slip: f64,
    /// Reaction in the pull direction, N; NaN where no support is measured, as the components below.
    pub load: f64,
    /// Reaction along the left normal of the pull direction, N.
    pub load_lateral: f64,
    /// Component of the load along the embedded fibre, P_f, N ([`crate::model::Measured::components`]).
    pub load_axial: f64,
    /// Component of the load across it, P_b, N.
    pub load_shear: f64,
    /// Displacement of the exit node along the embedded fibre, mm; NaN without one.
    pub slip_exit: f64,
    /// Displacement of the tail node along the embedded fibre, mm; NaN without one.
    pub slip_tail: f64,
    /// Energies, N mm.
    pub energies: Energies,
    /// Imbalance of the energies relative to max(work so far, 1e-3 × the greatest work); NaN where temperature or fields change: what
    /// they do to a material is no work of the drives.
    pub energy_error: f64,
    /// Counts of material points and contact points.
    pub counts: Counts,
    /// Reference volume of the damaged points, mm³.
    pub damaged_volume: f64,
    /// Reference volume of torn matter that was released, mm³.
    pub spalled_volume: f64,
    /// Depth of the torn matter below the exit node, against the pull direction, mm; 0 without such a node.
    pub spalled_depth: f64,
    /// Open length of the interface line that has opened most, mm ([`crate::model::Measured::interface_lines`]).
    pub separation_length: f64,
    /// The greatest bearing pressure of a contact point, MPa ([`crate::model::Measured::bearing_factor`]).
    pub greatest_bearing_pressure: f64,
    /// The greatest equivalent plastic strain of fibres ([`crate::model::Measured::part`]); NaN where there is none.
    pub plastic_strain: f64,
    /// The greatest principal stress of fibres, MPa; NaN without one.
    pub principal_stress: f64,
    /// Largest value of the scalar field; NaN without one.
    pub largest_field: f64,
    /// Area of the cracks of a phase field, mm², and their energy, N mm; NaN without them.
    pub crack: [f64; 2],
    /// The greatest axial strain and stress of each of [`crate::model::Measured::wires`].
    pub wires: Vec<WireRecord>,
    /// Number of attempts given up before it.
    pub cutbacks: u32,
    /// Number of Newton iterations.
    pub iterations: Vec<Iteration>,
    /// Results of each of several fibres ([`crate::model::Measured::fibres`]).
    pub fibres: Vec<FibreRecord>,
    /// The attempts that led to it, the last of which stands.
    pub tried: Vec<Tried>,
}

/// Results of one of several fibres, as those of [`Record`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreRecord {
    /// Value of its drive, mm.
    pub slip: f64,
    /// Reaction in the pull direction, N.
    pub load: f64,
    /// Component of the reaction along its axis, N.
    pub load_axial: f64,
    /// Component across it, N.
    pub load_shear: f64,
    /// Displacement of its exit node along its axis, mm.
    pub slip_exit: f64,
    /// Displacement of its tail node along its axis, mm.
    pub slip_tail: f64,
    /// Open length of its interface line that has opened most, mm.
    pub separation_length: f64,
    /// The greatest equivalent plastic strain of its points; NaN where its law has none.
    pub plastic_strain: f64,
    /// The greatest principal stress of its points, MPa.
    pub principal_stress: f64,
}

/// What the sections of a wire carry along its axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WireRecord {
    /// The greatest elongation over the gauge length; bending has none.
    pub strain: f64,
    /// The greatest mean stress of a section along the axis, on its initial area, MPa.
    pub stress: f64,
}

/// Numbers of points by their state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Material points of laws with damage that have dissipated.
    pub damaged: usize,
    /// Material points of laws without damage that have dissipated.
    pub yielding: usize,
    /// Contact points that carry shear without having slid.
    pub sticking: usize,
    /// Contact points that have slid.
    pub slipping: usize,
    /// Contact points that are open.
    pub open: usize,
    /// Contact points that have left the master.
    pub released: usize,
}

/// Continuation of a run after an increment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Directive {
    /// The next increment of the step follows.
    GoOn,
    /// The next step follows.
    EndStep,
    /// The run ends.
    EndRun,
}

/// Receives each accepted increment.
pub trait IncrementObserver {
    /// Receives the initial state, then each accepted increment; the snapshot gives fields on demand.
    ///
    /// # Errors
    ///
    /// Whatever kept it from being written; the run stops.
    fn increment(&mut self, record: &Record, snapshot: &Snapshot<'_>) -> io::Result<Directive>;

    /// The run may be resumed from here: the increment reported last is complete, and another one follows.
    ///
    /// # Errors
    ///
    /// Whatever kept it from being written; the run stops.
    fn checkpoint(&mut self, _checkpoint: &Checkpoint) -> io::Result<()> {
        Ok(())
    }
}

impl Analysis<'_> {
    /// Returns the record of the present state, at the end of an increment.
    pub(super) fn record(&self, step: u32, increment: u32, cutbacks: u32, iterations: Vec<Iteration>) -> Record {
        let snapshot = self.snapshot();
        let measured = &self.model.measured;
        let is_measured = !measured.supports.is_empty();
        let [load, load_lateral] = if is_measured { self.measured_load(&snapshot) } else { [f64::NAN; 2] };
        let [axis, across] = measured.components();
        let [pull_x, pull_y] = measured.direction;
        let force = [load * pull_x - load_lateral * pull_y, load * pull_y + load_lateral * pull_x];
        let along = |node: Option<usize>| node.map_or(f64::NAN, |node| snapshot.displacement_of(node, axis));
        let open = measured.interface_lines.iter().map(|line| snapshot.contact().open_length(line));
        let open: Vec<f64> = open.collect();
        let strained = |part: Option<usize>| snapshot.solids().greatest_in_part(part);
        let fibres = measured.fibres.iter().map(|fibre| {
            let GreatestInPart { plastic_strain, principal_stress } = strained(fibre.part);
            let along = |node: usize| snapshot.displacement_of(node, fibre.axis);
            let [load_axial, load_shear] =
                measured.components_along(fibre.axis).map(|direction| snapshot.reaction_of(fibre.support, direction));
            FibreRecord {
                slip: self.present.committed.drives[fibre.slip],
                load: snapshot.reaction_of(fibre.support, measured.direction),
                load_axial,
                load_shear,
                slip_exit: along(fibre.exit_node),
                slip_tail: along(fibre.tail_node),
                separation_length: fibre.lines.iter().map(|&line| open[line]).fold(0.0, f64::max),
                plastic_strain,
                principal_stress,
            }
        });
        let reference = self.work_reference(self.present.energies.external_work, &self.present.committed);
        let fibres: Vec<FibreRecord> = fibres.collect();
        // of several fibres: loads together, slips on average
        let sum = |of: fn(&FibreRecord) -> f64, alone: f64| match fibres.is_empty() {
            true => alone,
            false => fibres.iter().map(of).sum(),
        };
        let mean = |of: fn(&FibreRecord) -> f64, node| sum(of, along(node)) / fibres.len().max(1) as f64;
        let alone = strained(measured.part.filter(|_| fibres.is_empty()));
        let greatest = |of: fn(&FibreRecord) -> f64, alone: f64| fibres.iter().map(of).fold(alone, f64::max);
        Record {
            step,
            increment,
            time: self.present.total_time,
            slip: measured.slip_of(&self.present.committed.drives),
            load,
            load_lateral,
            load_axial: sum(|fibre| fibre.load_axial, force[0] * axis[0] + force[1] * axis[1]),
            load_shear: sum(|fibre| fibre.load_shear, force[0] * across[0] + force[1] * across[1]),
            slip_exit: mean(|fibre| fibre.slip_exit, measured.exit_node),
            slip_tail: mean(|fibre| fibre.slip_tail, measured.tail_node),
            energies: self.present.energies,
            energy_error: if !self.model.is_driven_alone() {
                f64::NAN
            } else if reference > 0.0 {
                self.present.energies.imbalance() / reference
            } else {
                0.0
            },
            counts: self.equilibrium.counts(),
            damaged_volume: snapshot.solids().damaged_volume(),
            spalled_volume: self.present.spalled.volume,
            spalled_depth: self.present.spalled.depth,
            separation_length: open.iter().copied().fold(0.0, f64::max),
            greatest_bearing_pressure: measured.bearing_factor * snapshot.greatest_pressure(),
            plastic_strain: greatest(|fibre| fibre.plastic_strain, alone.plastic_strain),
            principal_stress: greatest(|fibre| fibre.principal_stress, alone.principal_stress),
            largest_field: snapshot.field.map_or(f64::NAN, Field::largest),
            crack: snapshot.field.and_then(Field::crack).unwrap_or([f64::NAN; 2]),
            wires: self.present.stretches.records(&snapshot),
            cutbacks,
            iterations,
            fibres,
            tried: Vec::new(),
        }
    }
}

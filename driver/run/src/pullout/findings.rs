//! Findings of a specimen's run besides its history.

use super::peak::PeakLoad;
use crate::columns::{Group, SPECIMEN};
use crate::number::significant;
use fe_core::assembly::Location;
use fe_core::mesh::Overlap;
use fe_core::model::{Measured, Wire};
use fe_core::stepping::{Analysis, Record, Times, WireRecord};
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Elongation over 5 diameters by which a wire whose load has fallen must have grown to count as necked.
const NECKING: f64 = 0.005;

/// The part of `summary.json` that only specimens have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// The greatest load; absent if nothing was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_load: Option<PeakLoad>,
    /// The greatest imbalance of the energies, relative as in the history; absent where temperature or fields change.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy_error_max: Option<f64>,
    /// Share of the work taken by stabilisation and by the overstress of laws that extrapolate.
    #[serde(default)]
    pub stabilisation_share: f64,
    /// First increment in which each fibre passed its strength or its elongation, or without both the elongation
    /// `output.rupture_strain`, by the fibres' names ("fibre" for one without a name).
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub ruptures: IndexMap<String, Rupture>,
    /// The deepest overlap of deformed bodies at the greatest load and at the end, mm; 0 where there is none.
    #[serde(default)]
    pub overlap_max: f64,
    /// Deepest overlap over the fibre's diameter; without a fibre over the shortest edge in contact, without contact
    /// over the shortest outer edge.
    #[serde(default)]
    pub overlap_relative: f64,
    /// Places at which bodies overlap at the greatest load, `peak`, and at the `end`, where they do.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub overlaps: IndexMap<String, Overlap<String>>,
    /// Energies at the end by their columns, N·mm; `unaccounted_energy`, the stress work of parts whose law reports none that
    /// can be believed, has no column.
    pub energies: IndexMap<String, f64>,
    /// Counts of operations.
    pub statistics: IndexMap<String, u64>,
    /// Times by task, s.
    pub times: IndexMap<String, f64>,
    /// Penalties of the normal direction by contact pair, MPa/mm.
    pub penalties: IndexMap<String, f64>,
    /// The greatest displacement before the first step, mm, by which an initial stress found its equilibrium; absent if there
    /// was none, or supports held it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_displacement: Option<f64>,
    /// Why and where the run stopped early.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<SpecimenFailure>,
}

/// The first increment in which a fibre is strained beyond what it is said to bear.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rupture {
    /// Slip, mm, of that fibre where each has its own.
    pub slip: f64,
    /// Load of that fibre, N.
    pub load: f64,
    /// Greatest equivalent plastic strain of that fibre.
    pub plastic_strain: f64,
    /// Greatest principal stress of that fibre, MPa.
    pub stress: f64,
    /// Greatest elongation over 5 diameters, without bending.
    #[serde(default)]
    pub axial_strain: f64,
    /// Greatest mean axial stress of a section, on its initial area, MPa.
    #[serde(default)]
    pub axial_stress: f64,
    /// Step, from 1.
    pub step: u32,
    /// Increment, from 1.
    pub increment: u32,
}

/// What a wire has borne so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Borne {
    /// Greatest mean axial stress of a section, on its initial area, MPa.
    stress: f64,
    /// Greatest elongation over 5 diameters at that moment.
    strain: f64,
}

impl Borne {
    /// Adds an increment; returns whether the wire necks: it grows longer while its load falls. The load of a hook that straightens
    /// falls, too, but the wire does not grow longer.
    fn necks(&mut self, of_wire: &WireRecord) -> bool {
        if of_wire.stress >= self.stress {
            *self = Self { stress: of_wire.stress, strain: of_wire.strain };
        }
        of_wire.strain > self.strain + NECKING
    }
}

impl Rupture {
    /// Adds those of an increment that break for the first time; returns whether one of them breaks by its own strength or elongation, or
    /// necks before it reaches them.
    pub fn add(
        ruptures: &mut IndexMap<String, Self>,
        borne: &mut Vec<Borne>,
        record: &Record,
        measured: &Measured,
        limit: f64,
    ) -> bool {
        borne.resize(measured.wires.len(), Borne::default());
        let &Record { step, increment, .. } = record;
        let mut breaks = false;
        for (index, (wire, of_wire)) in measured.wires.iter().zip(&record.wires).enumerate() {
            let has_limits = wire.has_limits();
            let &WireRecord { strain: axial_strain, stress: axial_stress } = of_wire;
            let necks = borne[index].necks(of_wire);
            let is_over =
                if has_limits { necks || wire.breaks(axial_strain, axial_stress) } else { axial_strain > limit };
            let name = Self::name(measured, index);
            if !is_over || ruptures.contains_key(name) {
                continue;
            }
            let [slip, load, plastic_strain, stress] = match record.fibres.get(index) {
                Some(of) => [of.slip, of.load, of.plastic_strain, of.principal_stress],
                None => [record.slip, record.load, record.plastic_strain, record.principal_stress],
            };
            let rupture = Self { slip, load, plastic_strain, stress, axial_strain, axial_stress, step, increment };
            ruptures.insert(name.to_owned(), rupture);
            breaks |= has_limits;
        }
        breaks
    }

    /// Says which fibres have broken by their own strength or elongation, and which are stretched beyond `limit` without having any.
    pub fn warnings(ruptures: &IndexMap<String, Self>, measured: &Measured, limit: f64) -> Vec<String> {
        let message = |(index, wire): (usize, &Wire)| {
            let (name, rupture) = ruptures.get_key_value(Self::name(measured, index))?;
            let [slip, load, stress] =
                [rupture.slip, rupture.load, rupture.axial_stress].map(|value| significant(value, 4));
            let strain = significant(100.0 * rupture.axial_strain, 3);
            Some(if wire.has_limits() {
                format!(
                    "{name}: the wire breaks at a slip of {slip} mm under {load} N, and the run ends. Its largest stress is {stress} MPa on the initial area, its largest elongation {strain} % over 5 diameters"
                )
            } else {
                format!(
                    "{name}: at a slip of {slip} mm the elongation of the wire over 5 diameters is {strain} %, more than {} %, but the wire does not break: give its part a strength and an elongation",
                    significant(100.0 * limit, 3)
                )
            })
        };
        measured.wires.iter().enumerate().filter_map(message).collect()
    }

    /// The name of a wire's fibre.
    fn name(measured: &Measured, index: usize) -> &str {
        measured.fibres.get(index).map_or("fibre", |fibre| &fibre.name)
    }
}

/// A run that stopped early.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpecimenFailure {
    /// Step, from 1.
    pub step: u32,
    /// Increment, from 1; 0: equilibrium before the first step.
    pub increment: u32,
    /// Part of the step that was done.
    pub progress: f64,
    /// Location of the failure.
    pub place: Location,
    /// Reason for the failure.
    pub reason: String,
}

/// Energies by their columns, of the values of a row.
pub fn energies(values: &[f64], unaccounted: f64) -> IndexMap<String, f64> {
    // a specimen without a phase field has no energy of one
    let columns =
        SPECIMEN.iter().zip(values).filter(|(column, value)| column.group == Group::Energy && value.is_finite());
    let named = columns.map(|(column, value)| (column.name, *value));
    let unaccounted = Some(("unaccounted_energy", unaccounted)).filter(|(_, energy)| *energy != 0.0);
    named.chain(unaccounted).map(|(name, value)| (name.to_owned(), value)).collect()
}

/// Returns the time spent, s. The analysis also has the times of its parts, which do not add up to its whole.
pub fn times(set_up: Duration, analysis: Duration, parts: &Times, fields: Duration) -> IndexMap<String, f64> {
    let named = [
        ("set_up", set_up),
        ("analysis", analysis),
        ("analysis_solids", parts.solids),
        ("analysis_contact", parts.contact),
        ("analysis_assembly", parts.assembly),
        ("analysis_factorisation", parts.factorisation),
        ("analysis_solution", parts.solution),
        ("writing_fields", fields),
    ];
    named.into_iter().map(|(name, time)| (name.to_owned(), time.as_secs_f64())).collect()
}

/// Returns what was done how often.
pub fn statistics(analysis: &Analysis<'_>) -> IndexMap<String, u64> {
    let done = analysis.statistics();
    let snapshot = analysis.snapshot();
    let solids = snapshot.solids().counters();
    let named = [
        ("force_evaluations", done.evaluations),
        ("element_evaluations", solids.evaluations),
        ("skipped_element_evaluations", solids.skipped_evaluations),
        ("element_stiffnesses", solids.stiffness_builds),
        ("umat_calls", solids.umat_calls),
        ("contact_law_calls", snapshot.contact().law_calls()),
        ("factorisations", done.factorisations),
        ("contact_factorisations", done.block_factorisations),
        ("solutions", done.solutions),
        ("contact_settlements", done.settlements),
        ("field_passes", done.field_passes),
        ("far_field_expansions", done.expansions),
        ("increments_through_drag", done.dragged),
    ];
    named.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

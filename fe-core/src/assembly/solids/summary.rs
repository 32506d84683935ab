//! Output of the solids: energies, counts, single points.

use super::Solids;
use super::block::ElementBlock;
use super::element::present_position;
use super::points::{Points, States};
use super::record::{Body, Spalled, number_of};
use super::trust::add_work;
use crate::kinematics::finite::{Components, rotated};
use crate::plane::principal;
use umat_abi::host::recorder::UmatRecord;

/// Energies of the committed state, N·mm (of a plane part over its thickness).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolidEnergies {
    /// Stored: SSE.
    pub stored: f64,
    /// Dissipated by laws without a damage: SPD + SCD.
    pub plastic: f64,
    /// Dissipated by laws with a damage: SPD + SCD.
    pub damage: f64,
    /// Work of the stresses of laws whose energies cannot be believed.
    pub unaccounted: f64,
    /// Dissipated by the viscous stress of the stabilisation.
    pub viscous: f64,
    /// The work of the overstress of laws that extrapolate; not in what their damage or flow has dissipated.
    pub overstress: f64,
    /// Stored in elements when they were released, and the work of their fading forces.
    pub spalled: f64,
}

impl std::ops::AddAssign for SolidEnergies {
    fn add_assign(&mut self, other: Self) {
        self.stored += other.stored;
        self.plastic += other.plastic;
        self.damage += other.damage;
        self.unaccounted += other.unaccounted;
        self.viscous += other.viscous;
        self.overstress += other.overstress;
        self.spalled += other.spalled;
    }
}

/// The branch of a law that a point is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Branch {
    /// Of a law with damage: which principal stresses are tensile, once it is damaged.
    Tears(Option<[bool; 2]>),
    /// Of a law without: whether it dissipates in the increment.
    Flows(bool),
}

/// Numbers of points whose damage has grown or that, where the law has none, have dissipated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PointCounts {
    /// Points of laws without a damage.
    pub plastic: usize,
    /// Points of laws with a damage.
    pub damaged: usize,
}

/// Counts of operations since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Counters {
    /// Calls of UMATs.
    pub umat_calls: u64,
    /// Elements evaluated.
    pub evaluations: u64,
    /// Elements that gave their last forces again.
    pub skipped_evaluations: u64,
    /// Stiffnesses built.
    pub stiffness_builds: u64,
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.umat_calls += other.umat_calls;
        self.evaluations += other.evaluations;
        self.skipped_evaluations += other.skipped_evaluations;
        self.stiffness_builds += other.stiffness_builds;
    }
}

/// The committed state of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointView<'a> {
    /// Present position, mm; that of the reference under small strains.
    pub position: [f64; 2],
    /// σ 11, 22, 33, 12, MPa.
    pub stress: Components,
    /// ε 11, 22, 33, γ12; 33 is 0 in plane stress, where only the law knows it, unless it is called with six
    /// components.
    pub strain: Components,
    /// STATEV.
    pub statev: &'a [f64],
    /// SSE, SPD, SCD, N·mm/mm³.
    pub energies: [f64; 3],
    /// Reference volume, mm³.
    pub volume: f64,
}

/// Extremes over the points of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GreatestInPart {
    /// Equivalent plastic strain.
    pub plastic_strain: f64,
    /// Principal stress, MPa; tension is positive.
    pub principal_stress: f64,
}

/// The last call of a point's UMAT.
#[derive(Clone, Debug, PartialEq)]
pub struct PointCall {
    /// Arguments, with what the UMAT changes as it was at the start: turned with the body, as the UMAT got it.
    pub arguments: UmatRecord,
    /// ε33 at the start, if the UMAT was called with six components.
    pub strain_33: Option<f64>,
}

fn sum(parts: Vec<SolidEnergies>) -> SolidEnergies {
    let mut sum = SolidEnergies::default();
    parts.into_iter().for_each(|part| sum += part);
    sum
}

impl Solids {
    /// The last call of the law of an element's part, if it was for this point: the one that failed, where a law did.
    pub fn last_call(&self, element: usize, point: usize) -> Option<PointCall> {
        let call = &self.block(element).body.points.call;
        if [call.noel, call.npt] != [number_of(element), number_of(point)] {
            return None;
        }
        let PointView { stress, strain, statev, energies, .. } = self.point(element, point);
        let rotation = (call.drot[0][0], call.drot[0][1]);
        let turned = |tensor: &Components, shear: f64| -> Vec<f64> {
            let turned = rotated(tensor, rotation, shear);
            call.stress_state().components().iter().map(|&component| turned[component]).collect()
        };
        let mut arguments = UmatRecord {
            stress: turned(&stress, 1.0),
            statev: statev.to_vec(),
            energies: energies.to_vec(),
            ..UmatRecord::of(call)
        };
        arguments.inputs.stran[..call.ntens()].copy_from_slice(&turned(&strain, 2.0));
        Some(PointCall { arguments, strain_33: call.is_through_solid().then_some(strain[2]) })
    }

    /// Energies of each part.
    pub fn part_energies(&self) -> Vec<SolidEnergies> {
        self.energies_of(|points| &points.committed, |spalled| spalled.energy)
    }

    /// Energies of all parts at the last evaluation of each point.
    pub(crate) fn trial_energies(&self) -> SolidEnergies {
        sum(self.energies_of(|points| &points.trial, |spalled| spalled.energy + spalled.work))
    }

    /// Sums point by point in the order of each part's elements: the bits do not depend on how these are divided into blocks.
    fn energies_of(&self, states: fn(&Points) -> &States, spalled: fn(&Spalled) -> f64) -> Vec<SolidEnergies> {
        let mut parts = vec![SolidEnergies::default(); self.trust.len()];
        for ElementBlock { body: Body { part, index, points, volumes, .. }, records, .. } in &self.blocks {
            let sum = &mut parts[*index];
            let released = records.iter().filter_map(|record| record.built.spalled.as_ref());
            released.for_each(|element| sum.spalled += spalled(element));
            let states = states(points);
            add_work(&mut sum.viscous, &states.viscous, volumes);
            if !self.trust[*index].believes() {
                add_work(&mut sum.unaccounted, &states.work, volumes);
                continue;
            }
            for (point, ([stored, plastic, creep], volume)) in states.reference_energies.iter().zip(volumes).enumerate()
            {
                let overstress = part.overstress_work.map_or(0.0, |state| states.statev[points.statev(point)][state]);
                sum.stored += stored * volume;
                sum.overstress += overstress * volume;
                let dissipated = if part.damages { &mut sum.damage } else { &mut sum.plastic };
                *dissipated += (plastic + creep - overstress) * volume;
            }
        }
        parts
    }

    pub(super) fn bodies(&self) -> impl Iterator<Item = &Body> {
        self.blocks.iter().map(|block| &block.body)
    }

    /// Energies of all parts.
    pub fn energies(&self) -> SolidEnergies {
        sum(self.part_energies())
    }

    /// Returns what all points have dissipated at the last evaluation of each: SPD + SCD, N·mm.
    pub(crate) fn trial_dissipation(&self) -> f64 {
        self.accounts_of(|points| &points.trial).iter().map(|account| account.dissipated).sum()
    }

    /// Returns how many points have failed: their damage has grown, or, of laws without one, they have dissipated.
    pub fn counts(&self) -> PointCounts {
        let mut counts = PointCounts::default();
        for body in self.bodies() {
            let failed = (0..body.volumes.len()).filter(|&point| body.has_failed(point)).count();
            *if body.part.damages { &mut counts.damaged } else { &mut counts.plastic } += failed;
        }
        counts
    }

    /// Reference volume of the points whose law's damage has grown, mm³.
    pub fn damaged_volume(&self) -> f64 {
        let mut parts = vec![0.0; self.trust.len()];
        for body in self.bodies().filter(|body| body.part.damages) {
            let damaged = body.volumes.iter().enumerate().filter(|(point, _)| body.has_failed(*point));
            damaged.for_each(|(_, volume)| parts[body.index] += volume);
        }
        parts.iter().sum()
    }

    /// Returns the branch of each point at the last evaluation.
    pub(crate) fn branches(&self) -> impl Iterator<Item = Branch> {
        self.bodies().flat_map(|body| {
            let Points { committed, trial, .. } = &body.points;
            (0..body.volumes.len()).map(move |point| {
                if body.part.damages {
                    let signs = principal(trial.stress[point]).map(|stress| stress > 0.0);
                    return Branch::Tears(body.has_failed(point).then_some(signs));
                }
                let spent = |states: &States| states.energies[point][1] + states.energies[point][2];
                Branch::Flows(spent(trial) > spent(committed))
            })
        })
    }

    /// Returns whether the damage of any point of an element has grown, or, of a law without one, any has dissipated.
    pub fn has_failed(&self, element: usize) -> bool {
        let (block, record) = (self.block(element), self.record(element));
        record.points.clone().any(|point| block.body.has_failed(point))
    }

    /// Returns whether an element is torn matter that was released.
    pub(crate) fn is_spalled(&self, element: usize) -> bool {
        self.record(element).built.spalled.is_some()
    }

    /// Returns the share of its forces that an element has: 1 unless it was released.
    pub(crate) fn share(&self, element: usize) -> f64 {
        self.record(element).built.spalled.as_ref().map_or(1.0, Spalled::share)
    }

    /// The elements that were released, ascending.
    pub fn spalled(&self) -> Vec<usize> {
        (0..self.places.len()).filter(|&element| self.is_spalled(element)).collect()
    }

    /// Returns whether an element is torn. At all its points the crack must be open by more than `opening` (greatest
    /// principal strain × CELENT, mm), and no principal stress may exceed `stress` in magnitude, MPa.
    pub(crate) fn is_torn(&self, element: usize, opening: f64, stress: f64) -> bool {
        let (block, record) = (self.block(element), self.record(element));
        let states = &block.body.points.committed;
        record.points.clone().all(|point| {
            let [e11, e22, e33, gamma] = states.strain[point];
            let [widest, _] = principal([e11, e22, e33, 0.5 * gamma]);
            let [greatest, least] = principal(states.stress[point]);
            let borne = least.abs().max(greatest.abs()).max(states.stress[point][2].abs());
            widest * record.characteristic_length > opening && borne <= stress
        })
    }

    /// Returns whether what an element's law dissipates is damage.
    pub fn damages(&self, element: usize) -> bool {
        self.block(element).body.part.damages
    }

    /// Returns how many integration points an element has.
    pub fn point_count(&self, element: usize) -> usize {
        self.record(element).points.len()
    }

    /// The committed state of a point of an element.
    pub fn point(&self, element: usize, point: usize) -> PointView<'_> {
        let (block, record) = (self.block(element), self.record(element));
        let body = &block.body;
        let index = record.points.start + point;
        let mut position = body.positions[index];
        if body.part.nlgeom {
            let values = body.part.values(record.kind, point);
            position = present_position(position, values, &block.committed[record.nodal.clone()]);
        }
        let states = &body.points.committed;
        PointView {
            position,
            stress: states.stress[index],
            strain: states.strain[index],
            statev: &states.statev[body.points.statev(index)],
            energies: states.energies[index],
            volume: body.volumes[index],
        }
    }

    /// The stress of a point of an element at the last evaluation, MPa.
    pub(crate) fn trial_stress(&self, element: usize, point: usize) -> Components {
        self.block(element).body.points.trial.stress[self.record(element).points.start + point]
    }

    /// The greatest equivalent plastic strain of the points of a part, and their greatest principal stress, MPa: along a fibre, by tension
    /// and bending. NaN without a part or points, or without a law that has such a strain.
    pub(crate) fn greatest_in_part(&self, of: Option<usize>) -> GreatestInPart {
        let mut greatest = GreatestInPart { plastic_strain: f64::NAN, principal_stress: f64::NAN };
        for Body { part, points, .. } in self.bodies().filter(|body| of == Some(body.index)) {
            let states = &points.committed;
            if let Some(state) = part.plastic_strain {
                let strains = points.state_at_all(states, state);
                greatest.plastic_strain =
                    strains.fold(greatest.plastic_strain, |greatest, &strain| greatest.max(strain));
            }
            let stresses = states.stress.iter().map(|&stress| principal(stress)[0].max(stress[2]));
            greatest.principal_stress = stresses.fold(greatest.principal_stress, f64::max);
        }
        greatest
    }

    /// E of each part, MPa: the modulus along x of the virgin state with the other direct stresses 0.
    pub(crate) fn elastic_moduli(&self) -> Vec<f64> {
        let mut moduli = vec![0.0; self.trust.len()];
        self.bodies().for_each(|body| moduli[body.index] = body.points.uniaxial_modulus());
        moduli
    }

    /// Returns what was done since the start.
    pub fn counters(&self) -> Counters {
        let mut sum = self.earlier;
        self.blocks.iter().for_each(|block| sum += Counters { umat_calls: block.body.points.calls, ..block.counters });
        sum
    }
}

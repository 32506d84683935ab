//! The material points of one block: their states, and calls of their UMAT.

use super::TangentChoice;
use super::heat::{PointHeat, ReturnedHeat};
use crate::assembly::{Setback, USUAL_FRACTION};
use crate::kinematics::finite::{Components, FiniteIncrement, Gradient, IDENTITY, Moduli, columns, rotated};
use crate::kinematics::{MAX_COMPONENTS, PlaneModel};
use crate::model::{ModelError, PluginLaw};
use crate::plane::dot;
use serde::{Deserialize, Serialize};
use umat_abi::host::{
    CallOutcome, FOLLOWS_GRADIENT, FreeStrain, NotFinite, Overrun, TangentSource, Transfer, UmatCall, judge, same_bits,
};
use umat_abi::law::{Request, StressState};

/// DDSDDE that differs from its transpose by less than this share of its greatest entry is symmetric: a symmetric tangent
/// computed in another order differs by some 1e-16 of it (measured: 1.2e-16).
const SYMMETRY_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// States of all points, one array each.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct States {
    pub(super) stress: Vec<Components>,
    pub(super) strain: Vec<Components>,
    pub(super) statev: Vec<f64>,
    /// SSE, SPD, SCD.
    pub(super) energies: Vec<[f64; 3]>,
    /// Energies per reference volume: ∫J dSSE of laws for small strains, J SSE of others; ∫J dSPD, ∫J dSCD.
    pub(super) reference_energies: Vec<[f64; 3]>,
    /// Viscous part of the stress.
    viscous_stress: Vec<Components>,
    /// Dissipated by the viscous stress, N·mm/mm³: trapezoidal, like the external work that it is compared with.
    pub(super) viscous: Vec<f64>,
    /// ∫σ:dε per reference volume, likewise, of a law without metadata that vouch for its energies; empty for others.
    pub(super) work: Vec<f64>,
    /// U and FLUX of UMATHT; empty without it.
    pub(super) transfer: Vec<[f64; 3]>,
}

impl States {
    fn virgin(points: usize, law: &PluginLaw) -> Self {
        let nstatv = law.nstatv;
        Self {
            stress: vec![[0.0; MAX_COMPONENTS]; points],
            strain: vec![[0.0; MAX_COMPONENTS]; points],
            statev: vec![0.0; points * nstatv],
            energies: vec![[0.0; 3]; points],
            reference_energies: vec![[0.0; 3]; points],
            viscous_stress: vec![[0.0; MAX_COMPONENTS]; points],
            viscous: vec![0.0; points],
            work: if law.law.is_some() { Vec::new() } else { vec![0.0; points] },
            transfer: Vec::new(),
        }
    }
}

/// Increment of a point: the strain increment, and under large displacements its motion.
pub(super) struct PointIncrement<'a> {
    pub(super) strain: Components,
    /// Motion under large displacements: F at the start and at the end.
    pub(super) motion: Option<(&'a FiniteIncrement, &'a Gradient, &'a Gradient)>,
}

/// The thickness of plane stress under large displacements, as of the last evaluation.
#[derive(Clone, Copy, Debug)]
struct Thickness {
    /// λ = exp ε₃₃: present per reference thickness.
    ratio: f64,
    /// ∂ε₃₃/∂ε, of the last evaluation that asked for tangents.
    rate: Components,
}

impl Thickness {
    const OF_REFERENCE: Self = Self { ratio: 1.0, rate: [0.0; MAX_COMPONENTS] };
}

/// Step of strains for ∂ε₃₃/∂ε: rounding of a strain of 0.1 makes 1e-9 of it, and the yield strain of metals is 1e5 steps.
const THICKNESS_STEP: f64 = 1e-8;

/// The material points of one block.
#[derive(Debug)]
pub(super) struct Points {
    pub(super) call: UmatCall,
    /// Indices, among the four components, of those that the UMAT has.
    components: &'static [usize],
    nstatv: usize,
    /// Index of the state that is the strain 33 of plane stress, if the law names one.
    strain_33: Option<usize>,
    /// A law for small strains, whose SSE grows by σ : Δε per present volume, according to its metadata. What others report as
    /// stored is a potential.
    is_incremental: bool,
    /// Thickness of each point in plane stress; others have none.
    thickness: Vec<Thickness>,
    pub(super) committed: States,
    pub(super) trial: States,
    /// Relaxation time per time increment, η/Δt: the viscous stress is η/Δt C Δε with the virgin moduli C.
    pub(super) viscosity: f64,
    /// The stress of the trial state that forces see: the law's and the viscous one.
    pub(super) acting: Vec<Components>,
    /// DDSDDE of the last evaluation that asked for it, and the viscous moduli.
    pub(super) moduli: Vec<Moduli>,
    /// DDSDDE at zero strain with the initial states.
    pub(super) elastic: Moduli,
    /// Calls of the UMAT.
    pub(super) calls: u64,
    /// Temperature and heat of each point, with a field.
    pub(super) heat: PointHeat,
}

impl Points {
    /// `count` virgin points.
    pub(super) fn new(law: &PluginLaw, model: PlaneModel, part: &str, count: usize) -> Result<Self, ModelError> {
        let call = law.umat(model.stress_state()).map_err(|error| ModelError::of_part(part, law.error(error)))?;
        let components = call.stress_state().components();
        let states = States::virgin(count, law);
        let zero = [[0.0; MAX_COMPONENTS]; MAX_COMPONENTS];
        Ok(Self {
            call,
            components,
            nstatv: law.nstatv,
            strain_33: law.strain_33(),
            is_incremental: law.law.is_some(),
            thickness: if model == PlaneModel::PlaneStress { vec![Thickness::OF_REFERENCE; count] } else { Vec::new() },
            committed: states.clone(),
            trial: states,
            viscosity: 0.0,
            acting: vec![[0.0; MAX_COMPONENTS]; count],
            moduli: vec![zero; count],
            elastic: zero,
            calls: 0,
            heat: PointHeat::default(),
        })
    }

    /// Sets the states of a point at the start.
    pub(super) fn set_initial_states(&mut self, point: usize, statev: &[f64]) {
        let place = self.statev(point);
        self.committed.statev[place.clone()].copy_from_slice(statev);
        self.trial.statev[place].copy_from_slice(statev);
    }

    /// Sets the stress of a point at the start, in the order of UMAT's components.
    pub(super) fn set_initial_stress(&mut self, point: usize, stress: &[f64]) {
        for (&value, &component) in stress.iter().zip(self.components) {
            self.committed.stress[point][component] = value;
        }
        self.trial.stress[point] = self.committed.stress[point];
        self.acting[point] = self.committed.stress[point];
    }

    /// Determines how the UMAT is called, unless the user has set it, and DDSDDE at zero strain with the initial states
    /// and the initial stress of the first point. Returns notes for users.
    pub(super) fn prepare(&mut self, law: &PluginLaw, part: &str, nlgeom: bool) -> Result<Vec<String>, ModelError> {
        self.set_virgin();
        let error = |error| ModelError::of_part(part, law.error(error));
        let reason = law.probe(&mut self.call).map_err(error)?;
        let doubt = law.doubt_of_plane(&mut self.call).map_err(error)?;
        if law.law.is_none() && !nlgeom && self.call.follows_gradient_alone() {
            return Err(ModelError::of_part(part, format!("{}: {FOLLOWS_GRADIENT}", law.name)));
        }
        // nothing grows by itself in these calls, whatever time they take
        self.call.set_free_strain(FreeStrain::AtStart);
        let found = self.find_elastic(law, part);
        self.call.set_free_strain(FreeStrain::Grows);
        found?;
        let initial = self.committed.stress.first().copied().unwrap_or_default();
        let changed = self.call.judge_initial_stress(&initial);
        let changed = changed.map_err(|dropped| ModelError::of_part(part, format!("{} {dropped}", law.name)))?;
        let reason = reason.map(|reason| format!("is called with NTENS = 6: {reason}"));
        let notes = [reason, doubt, changed].into_iter().flatten();
        Ok(notes.map(|note| format!("part '{part}': {} {note}", law.name)).collect())
    }

    /// Takes over the findings of [`Self::prepare`] for the first points of the part.
    pub(super) fn take_from(&mut self, law: &PluginLaw, first: &Self, part: &str) -> Result<(), ModelError> {
        self.elastic = first.elastic;
        if first.call.is_through_solid() && !self.call.is_through_solid() {
            let solid =
                law.plain_umat(StressState::ThreeD).map_err(|error| ModelError::of_part(part, law.error(error)))?;
            self.call.go_through(solid);
        }
        self.call.fence();
        Ok(())
    }

    /// The arguments of the first point in its virgin state.
    fn set_virgin(&mut self) {
        let zero = [0.0; MAX_COMPONENTS];
        self.call.drot = columns(IDENTITY);
        self.call.dfgrd0 = columns(IDENTITY);
        self.call.dfgrd1 = columns(IDENTITY);
        let stress = self.committed.stress.first().copied().unwrap_or(zero);
        let statev = self.committed.statev.get(..self.nstatv).map_or_else(|| vec![0.0; self.nstatv], <[f64]>::to_vec);
        self.call.set_point([&zero, &zero, &stress], &statev, [0.0; 3]);
    }

    /// Finds DDSDDE at zero strain.
    fn find_elastic(&mut self, law: &PluginLaw, part: &str) -> Result<(), ModelError> {
        let error = |reason: String| {
            ModelError::of_part(part, format!("{} gives no usable stiffness at zero strain: {reason}", law.name))
        };
        self.set_virgin();
        self.run(Request::StressAndTangent).map_err(|trouble| error(trouble.reason))?;
        self.elastic = self.returned_moduli();
        let modulus = self.uniaxial_modulus();
        if modulus > 0.0 && modulus.is_finite() {
            return Ok(());
        }
        let is_reported = self.call.tangent_source() == TangentSource::Reported;
        let advice = if is_reported { " (\"tangent\": \"numerical\" does without DDSDDE)" } else { "" };
        Err(error(format!("the modulus along 1 is {modulus:?} MPa{advice}")))
    }

    /// E: the modulus along 1 of the virgin state with the other direct stresses 0.
    pub(super) fn uniaxial_modulus(&self) -> f64 {
        let c = &self.elastic;
        if self.components.len() < MAX_COMPONENTS {
            return c[0][0] - c[0][1] * c[1][0] / c[1][1];
        }
        let minor = |a: usize, b: usize| c[1][a] * c[2][b] - c[1][b] * c[2][a];
        (c[0][0] * minor(1, 2) - c[0][1] * minor(0, 2) + c[0][2] * minor(0, 1)) / minor(1, 2)
    }

    /// Returns one of the states of the law at all points.
    pub(super) fn state_at_all<'s>(&self, states: &'s States, state: usize) -> impl Iterator<Item = &'s f64> {
        states.statev.iter().skip(state).step_by(self.nstatv)
    }

    /// STATEV of a point.
    pub(super) fn statev(&self, point: usize) -> std::ops::Range<usize> {
        point * self.nstatv..(point + 1) * self.nstatv
    }

    /// Advances a point from its committed state, and returns whether its tangent changed in any bit.
    pub(super) fn advance(
        &mut self,
        point: usize,
        increment: &PointIncrement<'_>,
        request: Request,
        choice: TangentChoice,
    ) -> Result<bool, Setback> {
        let (mut stress, mut strain) = (self.committed.stress[point], self.committed.strain[point]);
        if let Some((motion, start, end)) = increment.motion {
            let rotation = motion.rotation();
            (stress, strain) = (rotated(&stress, rotation, 1.0), rotated(&strain, rotation, 2.0));
            let (cosine, sine) = rotation;
            self.call.drot = columns([cosine, -sine, sine, cosine, 1.0]);
            (self.call.dfgrd0, self.call.dfgrd1) = (columns(*start), columns(*end));
        }
        let statev = self.statev(point);
        let (states, energies) = (&self.committed.statev[statev.clone()], self.committed.energies[point]);
        self.call.set_point([&strain, &increment.strain, &stress], states, energies);
        if let Some(field) = self.heat.field(point) {
            let [start, end] = field.ends;
            (self.call.temp, self.call.dtemp) = (start, end - start);
        }
        let own = if choice == TangentChoice::Consistent { request } else { Request::Stress };
        self.run(own)?;
        self.note_heat(point)?;
        self.trial.strain[point] = std::array::from_fn(|k| strain[k] + increment.strain[k]);
        if self.components.len() < MAX_COMPONENTS {
            // in plane stress through six components ε33 is the host's
            self.trial.strain[point][2] = self.call.strain_33;
        }
        for (source, &target) in self.call.stress().iter().zip(self.components) {
            self.trial.stress[point][target] = *source;
        }
        self.trial.statev[statev].copy_from_slice(self.call.statev());
        // J at the end and half-way
        let [thickness, middle_thickness] = self.thickness_ratios(point, increment);
        let volume_ratios = increment
            .motion
            .map(|(motion, ..)| [motion.volume_ratio * thickness, motion.middle_volume_ratio * middle_thickness]);
        self.book_energies(point, volume_ratios);
        self.acting[point] = self.trial.stress[point];
        let volume_ratio = volume_ratios.map_or(1.0, |[_, middle]| middle);
        if let Some(work) = self.trial.work.get_mut(point) {
            let spent = 0.5 * (dot(stress, increment.strain) + dot(self.trial.stress[point], increment.strain));
            *work = self.committed.work[point] + volume_ratio * spent;
        }
        if self.viscosity > 0.0 {
            self.add_viscous_stress(point, increment.strain, volume_ratio);
        }
        if thickness != 1.0 {
            self.acting[point] = self.acting[point].map(|stress| thickness * stress);
        }
        if let Some(own) = self.thickness.get_mut(point) {
            own.ratio = thickness;
        }
        if request == Request::Stress {
            return Ok(false);
        }
        let mut moduli = match choice {
            TangentChoice::Consistent => self.returned_moduli(),
            TangentChoice::Frozen => self.frozen(point)?,
            TangentChoice::Elastic => self.elastic,
        };
        if self.viscosity > 0.0 {
            let viscous = self.elastic.as_flattened().iter().map(|modulus| self.viscosity * modulus);
            moduli.as_flattened_mut().iter_mut().zip(viscous).for_each(|(sum, modulus)| *sum += modulus);
        }
        let changed = !same_bits(self.moduli[point].as_flattened(), moduli.as_flattened());
        self.moduli[point] = moduli;
        if self.follows_thickness(increment) {
            // what makes the stiffness safer leaves it out
            let is_consistent = choice == TangentChoice::Consistent;
            let rate = if is_consistent { self.thickness_rate(point, &stress, &strain, increment) } else { None };
            self.thickness[point].rate = rate.unwrap_or_default();
        }
        Ok(changed)
    }

    /// Returns whether somebody knows the strain 33 of plane stress.
    pub(super) fn knows_thickness(&self) -> bool {
        self.strain_33.is_some() || self.call.is_through_solid()
    }

    /// Returns whether the thickness changes over an increment.
    fn follows_thickness(&self, increment: &PointIncrement<'_>) -> bool {
        increment.motion.is_some() && !self.thickness.is_empty() && self.knows_thickness()
    }

    /// ε₃₃ of a point in plane stress, whose logarithmic strain it is; 0 where it is unknown. `free`: the part of it that the law
    /// does not see.
    fn thickness_strain(&self, point: usize, states: &States, free: f64) -> f64 {
        if self.call.is_through_solid() {
            states.strain[point][2]
        } else {
            self.strain_33.map_or(0.0, |state| states.statev[point * self.nstatv + state] + free)
        }
    }

    /// Returns λ of the trial state of a point with large displacements; 1 if it is unknown, and outside plane stress.
    pub(super) fn thickness_ratio(&self, point: usize) -> f64 {
        if self.thickness.is_empty() {
            1.0
        } else {
            self.thickness_strain(point, &self.trial, self.call.free_strain_33_at_end()).exp()
        }
    }

    /// λ at the end of an increment that the law has answered, and half-way.
    fn thickness_ratios(&self, point: usize, increment: &PointIncrement<'_>) -> [f64; 2] {
        if !self.follows_thickness(increment) {
            return [1.0; 2];
        }
        let start =
            self.thickness_strain(point, &self.committed, self.call.free_strain_33(self.call.temp, self.call.time[1]));
        let end = self.thickness_strain(point, &self.trial, self.call.free_strain_33_at_end());
        [end.exp(), (0.5 * (start + end)).exp()]
    }

    /// ∂ε₃₃/∂ε of an increment from a turned state, by differences: no UMAT of plane stress returns it. `None` if the law does
    /// not answer nearby.
    fn thickness_rate(
        &mut self,
        point: usize,
        stress: &Components,
        strain: &Components,
        increment: &PointIncrement<'_>,
    ) -> Option<Components> {
        let free = self.call.free_strain_33_at_end();
        let end = self.thickness_strain(point, &self.trial, free);
        let statev = self.statev(point);
        let mut rate = [0.0; MAX_COMPONENTS];
        let mut is_known = true;
        for &component in self.components {
            let mut shifted = increment.strain;
            shifted[component] += THICKNESS_STEP;
            let (states, energies) = (&self.committed.statev[statev.clone()], self.committed.energies[point]);
            self.call.set_point([strain, &shifted, stress], states, energies);
            is_known &= self.run(Request::Stress).is_ok();
            let nearby = match self.strain_33 {
                Some(state) if !self.call.is_through_solid() => self.call.statev()[state] + free,
                _ => self.call.strain_33,
            };
            rate[component] = (nearby - end) / (shifted[component] - increment.strain[component]);
        }
        // the call describes the increment itself again
        let (states, energies) = (&self.trial.statev[statev], self.trial.energies[point]);
        self.call.set_point([strain, &increment.strain, stress], states, energies);
        (is_known && rate.iter().all(|rate| rate.is_finite())).then_some(rate)
    }

    /// The derivative of the acting stress, λ σ: λ C + λ σ ⊗ ∂ε₃₃/∂ε.
    pub(super) fn acting_moduli(&self, point: usize) -> Moduli {
        let moduli = &self.moduli[point];
        let Some(Thickness { ratio, rate }) = self.thickness.get(point) else { return *moduli };
        let acting = &self.acting[point];
        std::array::from_fn(|row| {
            std::array::from_fn(|column| ratio * moduli[row][column] + acting[row] * rate[column])
        })
    }

    /// The derivative of the acting stress by the field at a fixed thickness, and that of RPL by the strain.
    pub(super) fn coupling(&self, point: usize) -> [Components; 2] {
        let [stress, source] = self.heat.coupling(point);
        let ratio = self.thickness.get(point).map_or(1.0, |thickness| thickness.ratio);
        [stress.map(|component| ratio * component), source]
    }

    /// A UMAT's energies are per present volume; `volume_ratios`: J at the end of a motion and half-way.
    fn book_energies(&mut self, point: usize, volume_ratios: Option<[f64; 2]>) {
        let energies = self.call.energies;
        self.trial.energies[point] = energies;
        self.trial.reference_energies[point] = match volume_ratios {
            None => energies,
            Some([end, middle]) => {
                let (start, sums) = (&self.committed.energies[point], &self.committed.reference_energies[point]);
                let spent = |k: usize| sums[k] + middle * (energies[k] - start[k]);
                [if self.is_incremental { spent(0) } else { end * energies[0] }, spent(1), spent(2)]
            }
        };
    }

    /// η/Δt C Δε.
    fn add_viscous_stress(&mut self, point: usize, strain_increment: Components, volume_ratio: f64) {
        let start = self.committed.viscous_stress[point];
        let end = self.elastic.map(|row| self.viscosity * dot(row, strain_increment));
        self.acting[point].iter_mut().zip(&end).for_each(|(sum, viscous)| *sum += viscous);
        let spent = 0.5 * (dot(start, strain_increment) + dot(end, strain_increment));
        self.trial.viscous[point] = self.committed.viscous[point] + volume_ratio * spent;
        self.trial.viscous_stress[point] = end;
    }

    /// Returns the tangent of the trial state if nothing grows: that of a zero increment from it.
    fn frozen(&mut self, point: usize) -> Result<Moduli, Setback> {
        self.call.drot = columns(IDENTITY);
        self.call.dfgrd0 = self.call.dfgrd1;
        let (strain, stress) = (&self.trial.strain[point], &self.trial.stress[point]);
        let statev = &self.trial.statev[self.statev(point)];
        self.call.set_point([strain, &[0.0; MAX_COMPONENTS], stress], statev, self.trial.energies[point]);
        self.call.set_free_strain(FreeStrain::AtEnd);
        let outcome = self.run(Request::StressAndTangent);
        self.call.set_free_strain(FreeStrain::Grows);
        outcome?;
        Ok(self.returned_moduli())
    }

    /// Sets the components of the strain that follow from the displacements.
    pub(super) fn set_trial_strain(&mut self, point: usize, strain: Components) {
        let strain_33 = self.trial.strain[point][2];
        self.trial.strain[point] = strain;
        if self.components.len() < MAX_COMPONENTS {
            self.trial.strain[point][2] = strain_33;
        }
    }

    /// Calls the UMAT and judges what came back.
    fn run(&mut self, request: Request) -> Result<(), Setback> {
        self.calls += 1;
        let outcome = self.call.call(request);
        let moduli = || self.call.moduli_not_finite().filter(|_| request == Request::StressAndTangent);
        self.judged(outcome, self.call.not_finite().or_else(moduli))
    }

    fn judged(&self, outcome: Result<CallOutcome, Overrun>, not_finite: Option<NotFinite>) -> Result<(), Setback> {
        judge(outcome, not_finite).map_err(|failure| Setback {
            reason: format!("plugin '{}': {failure}", self.call.plugin()),
            fraction: failure.fraction(USUAL_FRACTION),
        })
    }

    /// Makes UMATHT of the law's library, if it has one, follow its calls.
    pub(super) fn transfer_heat(&mut self, props: &[f64]) {
        if self.call.transfer_heat(props) {
            let virgin = vec![[0.0; 3]; self.committed.stress.len()];
            self.trial.transfer.clone_from(&virgin);
            self.committed.transfer = virgin;
        }
    }

    /// Notes the heat that the last call returned at a point with a field, and lets HETVAL and UMATHT follow.
    fn note_heat(&mut self, point: usize) -> Result<(), Setback> {
        let Some(field) = self.heat.field(point) else { return Ok(()) };
        let generated = self.call.add_generated_heat().map(|()| CallOutcome::Done);
        self.judged(generated, self.call.heat_not_finite())?;
        let mut transfer = None;
        if let Some(&[energy, x, y]) = self.committed.transfer.get(point) {
            let answer = self.call.transfer(field.gradient, (energy, [x, y]));
            let found = answer.ok().flatten().map(|(answer, _)| answer);
            let outcome = answer.map(|answer| answer.map_or(CallOutcome::Done, |(_, outcome)| outcome));
            self.judged(outcome, found.as_ref().and_then(Transfer::not_finite))?;
            transfer = found.map(|answer| {
                self.trial.transfer[point] = [answer.energy, answer.flux[0], answer.flux[1]];
                Transfer { energy: answer.energy - energy, ..answer }
            });
        }
        let heat = self.call.heat();
        let mut coupling = [[0.0; MAX_COMPONENTS]; 2];
        for (own, law) in coupling.iter_mut().zip([&heat.ddsddt, &heat.drplde]) {
            law.iter().zip(self.components).for_each(|(source, &target)| own[target] = *source);
        }
        self.heat.note(point, ReturnedHeat { source: [heat.rpl, heat.drpldt], transfer, coupling });
        Ok(())
    }

    /// DDSDDE over all four components.
    fn returned_moduli(&self) -> Moduli {
        let mut moduli = self.call.moduli();
        remove_rounding(&mut moduli);
        moduli
    }

    /// Takes over the trial states of these points.
    pub(super) fn commit(&mut self, points: std::ops::Range<usize>) {
        let (committed, trial) = (&mut self.committed, &self.trial);
        committed.stress[points.clone()].copy_from_slice(&trial.stress[points.clone()]);
        committed.strain[points.clone()].copy_from_slice(&trial.strain[points.clone()]);
        committed.energies[points.clone()].copy_from_slice(&trial.energies[points.clone()]);
        committed.reference_energies[points.clone()].copy_from_slice(&trial.reference_energies[points.clone()]);
        if !committed.work.is_empty() {
            committed.work[points.clone()].copy_from_slice(&trial.work[points.clone()]);
        }
        if self.viscosity > 0.0 {
            committed.viscous_stress[points.clone()].copy_from_slice(&trial.viscous_stress[points.clone()]);
            committed.viscous[points.clone()].copy_from_slice(&trial.viscous[points.clone()]);
        }
        if !committed.transfer.is_empty() {
            committed.transfer[points.clone()].copy_from_slice(&trial.transfer[points.clone()]);
        }
        let statev = points.start * self.nstatv..points.end * self.nstatv;
        committed.statev[statev.clone()].copy_from_slice(&trial.statev[statev]);
    }
}

/// Makes a matrix exactly symmetric that is symmetric up to rounding.
fn remove_rounding(moduli: &mut Moduli) {
    let greatest = moduli.as_flattened().iter().fold(0.0_f64, |greatest, entry| greatest.max(entry.abs()));
    let below_diagonal = || (1..MAX_COMPONENTS).flat_map(|row| (0..row).map(move |column| (row, column)));
    let asymmetry = |(row, column): (usize, usize)| (moduli[row][column] - moduli[column][row]).abs();
    if below_diagonal().all(|place| asymmetry(place) <= SYMMETRY_ROUNDING * greatest) {
        below_diagonal().for_each(|(row, column)| moduli[row][column] = moduli[column][row]);
    }
}

/// Returns whether DDSDDE is symmetric to the last bit.
pub(super) fn is_symmetric(moduli: &Moduli) -> bool {
    (1..MAX_COMPONENTS).all(|row| (0..row).all(|column| moduli[row][column] == moduli[column][row]))
}

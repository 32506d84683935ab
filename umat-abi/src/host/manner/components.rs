//! Plane calls of a UMAT that knows six components only.

use super::super::call::{CallOutcome, UmatCall};
use super::super::memory::Overrun;
use crate::law::{Heat, Request, StressState};

/// Tolerance of σ33 in plane stress, relative to the largest stress, or to the stiffness times the largest strain.
const STRESS_TOLERANCE: f64 = 1e-13;
/// Tolerance of σ33 in plane stress that is accepted if no iteration comes closer.
const LARGEST_STRESS: f64 = 1e-9;
/// Iterations on ε33.
const MAX_ITERATIONS: usize = 50;
/// Fraction of the increment that is tried next where no state of plane stress is found.
const CUT: f64 = 0.5;
/// 33 among the six components.
const THROUGH: usize = 2;

impl UmatCall {
    /// Makes a plane call through one with six components. The plane's other strains are 0, their stresses are dropped.
    pub(super) fn call_through(&mut self, solid: &mut Self, request: Request) -> Result<CallOutcome, Overrun> {
        self.hand_over(solid);
        let outcome = if self.stress_state() == StressState::PlaneStress {
            self.call_without_through_stress(solid, request)?
        } else {
            self.set_start(solid);
            solid.call(request)?
        };
        self.take_over(solid, request);
        Ok(match outcome {
            CallOutcome::Done => outcome,
            CallOutcome::CutBack(fraction) => self.cut_back(fraction),
        })
    }

    /// Copies the arguments common to both calls.
    pub(super) fn hand_over(&mut self, solid: &mut Self) {
        (solid.time, solid.dtime) = (self.time, self.dtime);
        (solid.temp, solid.dtemp) = (self.temp, self.dtemp);
        solid.predef.clone_from(&self.predef);
        solid.dpred.clone_from(&self.dpred);
        (solid.coords, solid.drot, solid.celent) = (self.coords, self.drot, self.celent);
        (solid.dfgrd0, solid.dfgrd1) = (self.dfgrd0, self.dfgrd1);
        (solid.noel, solid.npt, solid.jstep, solid.kinc) = (self.noel, self.npt, self.jstep, self.kinc);
        (solid.stran, solid.dstran) = ([0.0; 6], [0.0; 6]);
        for (k, &component) in self.stress_state().components().iter().enumerate() {
            solid.stran[component] = self.stran[k];
            solid.dstran[component] = self.dstran[k];
        }
        self.restore_outcome();
    }

    /// Sets stress, states and energies of the other call to those at the start.
    pub(super) fn set_start(&self, solid: &mut Self) {
        solid.stress_mut().fill(0.0);
        for (stress, &component) in self.stress().iter().zip(self.stress_state().components()) {
            solid.stress_mut()[component] = *stress;
        }
        solid.statev_mut().copy_from_slice(self.statev());
        solid.energies = self.energies;
    }

    /// Finds ε33 for which σ33 = 0: Newton's first step, then secants, which need no true tangent, inside a bracket as soon as
    /// there is one.
    fn call_without_through_stress(&mut self, solid: &mut Self, request: Request) -> Result<CallOutcome, Overrun> {
        let start = self.strain_33;
        solid.stran[THROUGH] = start;
        let attempt = |solid: &mut Self, increment: f64, request: Request| {
            self.set_start(solid);
            solid.dstran[THROUGH] = increment;
            if solid.jstep[2] != 0 {
                solid.dfgrd0[THROUGH][THROUGH] = start.exp();
                solid.dfgrd1[THROUGH][THROUGH] = (start + increment).exp();
            }
            solid.call(request)
        };
        let strain = solid.dstran.iter().fold(0.0_f64, |most, by| most.max(by.abs()));
        let mut at = 0.0;
        let mut outcome = attempt(solid, at, Request::StressAndTangent)?;
        let mut slope = solid.tangent(THROUGH, THROUGH);
        let mut residual = solid.stress()[THROUGH];
        let mut bracket: Option<[(f64, f64); 2]> = None;
        let mut best = (f64::INFINITY, at);
        let mut has_tangent = true;
        for _ in 0..MAX_ITERATIONS {
            if outcome != CallOutcome::Done || !solid.has_finite_stress() {
                return Ok(outcome);
            }
            let largest = solid.stress().iter().fold(0.0_f64, |most, stress| most.max(stress.abs()));
            let scale = largest.max(slope.abs() * strain.max(at.abs()));
            let left = if residual == 0.0 { 0.0 } else { residual.abs() / scale };
            if left < best.0 {
                best = (left, at);
            }
            if left <= STRESS_TOLERANCE {
                break;
            }
            let mut next = at - residual / slope;
            if let Some(ends) = &mut bracket {
                let place = usize::from(ends[1].1.is_sign_positive() == residual.is_sign_positive());
                ends[place] = (at, residual);
                let [low, high] = if ends[0].0 < ends[1].0 { [ends[0].0, ends[1].0] } else { [ends[1].0, ends[0].0] };
                if !(next > low && next < high) {
                    next = 0.5 * (low + high);
                }
            }
            if !next.is_finite() || next == at {
                break;
            }
            let (last, before) = (at, residual);
            (at, has_tangent) = (next, false);
            outcome = attempt(solid, at, Request::Stress)?;
            residual = solid.stress()[THROUGH];
            let secant = (residual - before) / (at - last);
            if secant != 0.0 {
                slope = secant;
            }
            if bracket.is_none() && residual.is_sign_positive() != before.is_sign_positive() {
                bracket = Some([(last, before), (at, residual)]);
            }
        }
        if best.0 > LARGEST_STRESS {
            return Ok(CallOutcome::CutBack(CUT));
        }
        // heat that follows ε33 is condensed with the tangent
        let follows = |heat: Heat| heat.ddsddt[THROUGH] != 0.0 || heat.drplde[THROUGH] != 0.0;
        let request = if follows(solid.heat()) { Request::StressAndTangent } else { request };
        if at != best.1 || (request.wants_tangent() && !has_tangent) {
            at = best.1;
            outcome = attempt(solid, at, request)?;
        }
        self.strain_33 = start + at;
        Ok(outcome)
    }

    /// Takes over the results of the other call: the plane's components, in plane stress those of C − C,₃ ⊗ C₃,/C₃₃.
    fn take_over(&mut self, solid: &Self, request: Request) {
        let components = self.stress_state().components();
        for (k, &component) in components.iter().enumerate() {
            self.stress_mut()[k] = solid.stress()[component];
        }
        self.statev_mut().copy_from_slice(solid.statev());
        self.energies = solid.energies;
        let condenses = self.stress_state() == StressState::PlaneStress;
        self.set_heat(heat_of_plane(solid, components, condenses));
        if !request.wants_tangent() {
            return;
        }
        let ntens = components.len();
        for (j, &column) in components.iter().enumerate() {
            for (i, &row) in components.iter().enumerate() {
                let mut entry = solid.tangent(row, column);
                if condenses {
                    let product = solid.tangent(row, THROUGH) * solid.tangent(THROUGH, column);
                    entry -= product / solid.tangent(THROUGH, THROUGH);
                }
                self.tangent.as_mut_slice()[j * ntens + i] = entry;
            }
        }
    }
}

/// Heat of a call with six components in those of a plane; in plane stress ε33 follows temperature and strains so that σ33 stays 0:
/// dε33 = −(C₃ⱼ dεⱼ + DDSDDT₃ dT)/C₃₃.
fn heat_of_plane(solid: &UmatCall, components: &[usize], condenses: bool) -> Heat {
    let all = solid.heat();
    let (by_temperature, by_strain) = (all.ddsddt[THROUGH], all.drplde[THROUGH]);
    let follows = condenses && (by_temperature != 0.0 || by_strain != 0.0);
    let through = if follows { 1.0 / solid.tangent(THROUGH, THROUGH) } else { 0.0 };
    let mut heat = Heat { rpl: all.rpl, drpldt: all.drpldt - by_strain * through * by_temperature, ..Heat::default() };
    for (k, &component) in components.iter().enumerate() {
        heat.ddsddt[k] = all.ddsddt[component];
        heat.drplde[k] = all.drplde[component];
        if follows {
            heat.ddsddt[k] -= solid.tangent(component, THROUGH) * through * by_temperature;
            heat.drplde[k] -= solid.tangent(THROUGH, component) * through * by_strain;
        }
    }
    heat
}

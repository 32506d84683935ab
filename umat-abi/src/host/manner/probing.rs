//! Trial calls that find out whether a plugin without metadata handles the components of a plane call.

use super::super::call::{CallOutcome, UmatCall};
use super::super::probe::{Alignment, Probed, ask};
use super::super::{LawDescription, LoadError, Plugin, Trespass};
use super::Manner;
use crate::law::{Request, StressState};
use crate::metadata::stress_states;

/// The largest strain of the calls: everything is elastic.
const STRAIN: f64 = 1e-6;
/// Components in a plane: 11, 22, 33, 12.
const PLANE_STRAIN: [f64; 4] = [STRAIN, -0.4 * STRAIN, 0.0, 0.6 * STRAIN];
/// Stresses of both calls that differ by less than this part of the largest are the same.
const SAME: f64 = 1e-3;
/// The largest strains of the calls beyond those, where most laws are not elastic.
const LARGE_STRAINS: [f64; 3] = [1e-4, 1e-3, 1e-2];
/// The part of the stress that DFGRD1 makes which strains make in a law that does not read them: rounding.
const UNREAD: f64 = 1e-6;

/// What to do about a stress that follows DFGRD1 and not the strains ([`UmatCall::follows_gradient_alone`]).
pub const FOLLOWS_GRADIENT: &str =
    "its stress follows DFGRD1 and not the strains, as that of a law of finite strain does: set \"nlgeom\": true";

/// What to try with a UMAT that leaves its own arrays in a plane.
pub const WRITTEN_FOR_SIX: &str =
    "in plane modes, a law written for six components writes past its arrays: \"as\": \"3d\" calls it with six";

impl Plugin {
    /// Calls of its UMAT with these components, through one with six if the manner or the metadata require it.
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn umat(&self, stress_state: StressState) -> Result<UmatCall, LoadError> {
        let mut call = self.plain_umat(stress_state)?;
        if self.goes_through_six(stress_state) == Some(true) {
            call.go_through(self.plain_umat(StressState::ThreeD)?);
        }
        call.set_tangent_source(self.manner.tangent.unwrap_or_default());
        call.set_frame(self.frame.clone());
        Ok(call)
    }

    /// Returns whether calls with these components go through one with six; `None`: trial calls decide ([`Self::probe`]).
    pub fn goes_through_six(&self, stress_state: StressState) -> Option<bool> {
        match &self.law {
            _ if !stress_state.is_plane() => Some(false),
            Some(law) => Some(self.manner.has_six(law, stress_state)),
            None => self.manner.as_three_d,
        }
    }

    /// Makes a call go through six components if the UMAT comes without metadata and does not work with those of the
    /// plane; then returns the reason. The arguments are those of an undeformed virgin point, and stay so. Trial calls
    /// that may crash or write out of bounds run in a child process first. From then on the call's arrays are fenced
    /// ([`UmatCall::fence`]).
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn probe(&self, call: &mut UmatCall) -> Result<Option<String>, LoadError> {
        let mut reason = None;
        if self.goes_through_six(call.stress_state()).is_none() {
            let (tangent, framed) = (call.tangent_source(), call.take_framed());
            let mut solid = self.plain_umat(StressState::ThreeD)?;
            reason = call.why_not_plane(&mut solid);
            if reason.is_some() {
                call.go_through(solid);
                call.set_tangent_source(tangent);
            }
            call.put_framed(framed);
        }
        call.fence();
        Ok(reason)
    }

    /// Returns what speaks for six components in a call of plane strain of which nothing is known, beyond what [`Self::probe`]
    /// finds: trial calls in child processes with large strains. A law that leaves its arrays with six components, as one does
    /// that keeps a state for each, says nothing.
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn doubt_of_plane(&self, call: &mut UmatCall) -> Result<Option<String>, LoadError> {
        let is_open = self.goes_through_six(call.stress_state()).is_none() && !call.is_through_solid();
        if !is_open || call.stress_state() != StressState::PlaneStrainOrAxisymmetric {
            return Ok(None);
        }
        let mut solid = self.plain_umat(StressState::ThreeD)?;
        call.hand_over(&mut solid);
        call.set_start(&mut solid);
        let serves = ask(|| {
            solid.leave_record();
            LARGE_STRAINS.iter().all(|strain| solid.stresses_at(*strain).is_some())
        });
        if serves.ok().flatten() != Some(true) || LARGE_STRAINS.iter().any(|&size| solid.trespass_at(size).is_some()) {
            return Ok(None);
        }
        if let Some(trespass) = LARGE_STRAINS.iter().find_map(|&size| call.trespass_at(size)) {
            return Ok(Some(format!("with NTENS = 4 it {trespass}, at large strains; {WRITTEN_FOR_SIX}")));
        }
        let differs = ask(|| {
            call.leave_record();
            solid.leave_record();
            LARGE_STRAINS.iter().any(|&strain| {
                let Some(six) = solid.stresses_at(strain) else { return false };
                let largest = six.iter().fold(0.0_f64, |most, stress| most.max(stress.abs()));
                let plane = call.stresses_at(strain);
                plane.is_none_or(|plane| plane.iter().zip(&six).any(|(a, b)| (a - b).abs() > SAME * largest))
            })
        });
        let what = match differs {
            Ok(Some(true)) => "gives another stress than with 6 at large strains",
            Ok(None) => "does not return at large strains, but does with 6",
            _ => return Ok(None),
        };
        Ok(Some(format!("with NTENS = 4 it {what}; {WRITTEN_FOR_SIX}")))
    }
}

impl Manner {
    /// Returns whether plane calls of a law go through six components: as is said, or because it has not those of the plane.
    pub fn has_six(self, law: &LawDescription, stress_state: StressState) -> bool {
        let has = |bits: u32| law.stress_states & bits != 0;
        let is_wanted = self.as_three_d.unwrap_or_else(|| !has(stress_state.bits()));
        stress_state.is_plane() && is_wanted && has(stress_states::THREE_D)
    }
}

impl UmatCall {
    /// Returns why the plugin is better called with six components: with those of the plane it fails or gives another
    /// stress, and with six it works.
    fn why_not_plane(&mut self, solid: &mut Self) -> Option<String> {
        let mut start = super::Point::default();
        self.keep(&mut start);
        let strains = (self.stran, self.dstran, self.dfgrd1);
        self.set_plane_strain(STRAIN);
        self.deform();
        let fault = self.fault();
        let plane = fault.is_none().then(|| self.stresses()).flatten();
        let reason = if plane.is_some() { None } else { Some(fault.unwrap_or_else(|| "gives no stress".to_owned())) };
        self.put_back(&start);
        self.hand_over(solid);
        self.set_start(solid);
        let reason = if solid.fault().is_some() || !solid.resists() {
            None
        } else if let Some(plane) = plane {
            self.differs(solid, &start, &plane)
        } else {
            reason
        };
        self.put_back(&start);
        (self.stran, self.dstran, self.dfgrd1) = strains;
        self.restore_outcome();
        reason.map(|reason| format!("with NTENS = {} it {reason}", self.ntens()))
    }

    /// The stresses of a plane strain increment of this size from where the call stands, which is kept.
    fn stresses_at(&mut self, size: f64) -> Option<Vec<f64>> {
        let mut start = super::Point::default();
        self.keep(&mut start);
        let strains = (self.dstran, self.dfgrd1);
        self.set_plane_strain(size);
        self.deform();
        let stresses = self.stresses();
        (self.dstran, self.dfgrd1) = strains;
        self.put_back(&start);
        self.restore_outcome();
        stresses
    }

    /// Returns where a plane strain increment of this size from where the call stands leaves an array; calls are made in child
    /// processes.
    fn trespass_at(&mut self, size: f64) -> Option<Trespass> {
        let mut start = super::Point::default();
        self.keep(&mut start);
        let strains = (self.dstran, self.dfgrd1);
        self.set_plane_strain(size);
        self.deform();
        let found = self.trespass();
        (self.dstran, self.dfgrd1) = strains;
        self.put_back(&start);
        found
    }

    /// Sets DSTRAN to one of plane strain.
    fn set_plane_strain(&mut self, size: f64) {
        for (k, &component) in self.stress_state().components().iter().enumerate() {
            self.dstran[k] = PLANE_STRAIN.get(component).map_or(0.0, |strain| strain / STRAIN * size);
        }
    }

    /// Returns whether the stress follows DFGRD1 and not DSTRAN. The call stands at a point, which is kept.
    pub fn follows_gradient_alone(&mut self) -> bool {
        let mut start = super::Point::default();
        self.keep(&mut start);
        let strains = (self.dstran, self.dfgrd1);
        let change = |call: &mut Self| {
            let stresses = call.stresses();
            call.put_back(&start);
            let change = |stresses: Vec<f64>| {
                stresses.iter().zip(&start.stress).fold(0.0_f64, |most, (end, start)| most.max((end - start).abs()))
            };
            stresses.map(change)
        };
        self.set_plane_strain(STRAIN);
        self.dfgrd1 = self.dfgrd0;
        let by_strain = change(self);
        for k in 0..self.ntens() {
            self.stretch(k, self.dstran[k]);
        }
        let by_both = change(self);
        (self.dstran, self.dfgrd1) = strains;
        self.restore_outcome();
        by_strain.zip(by_both).is_some_and(|(strain, both)| both > 0.0 && strain <= UNREAD * both)
    }

    /// Lets DFGRD1 follow DSTRAN where displacements are large; in plane stress it keeps the volume, as a run has it.
    fn deform(&mut self) {
        const THROUGH: usize = 2;
        if self.jstep[2] == 0 {
            return;
        }
        self.dfgrd1 = self.dfgrd0;
        for k in 0..self.ntens() {
            self.stretch(k, self.dstran[k]);
        }
        if self.stress_state() == StressState::PlaneStress {
            let [a, b, _] = self.dfgrd1;
            self.dfgrd1[THROUGH][THROUGH] = 1.0 / (a[0] * b[1] - a[1] * b[0]);
        }
    }

    /// Returns what goes wrong in a child process.
    fn fault(&mut self) -> Option<String> {
        for alignment in [Alignment::End, Alignment::Start] {
            match self.probe(alignment).ok()? {
                Probed::Clean => {}
                Probed::Trespass(trespass) => return Some(trespass.to_string()),
                Probed::Ended(how) => return Some(format!("does not come back: {how}")),
            }
        }
        None
    }

    /// The stresses of the call as it is prepared.
    fn stresses(&mut self) -> Option<Vec<f64>> {
        let done = self.call(Request::StressAndTangent).ok()? == CallOutcome::Done && self.has_finite_stress();
        done.then(|| self.stress().to_vec())
    }

    /// Makes the last call again in child processes, from the stress, states and energies that are set; returns where it leaves
    /// an array, if it does. Goes through six components if calls do.
    pub fn trespass_again(&mut self) -> Option<Trespass> {
        let Some(mut detour) = self.detour.take() else { return self.trespass() };
        let super::Detour { framed, solid, .. } = &mut *detour;
        let mut again = |this: &mut Self| match solid {
            Some(solid) => {
                this.set_start(solid);
                solid.trespass()
            }
            None => this.trespass(),
        };
        let found = match framed {
            Some(framed) => self.in_frame(framed, Request::Stress, again),
            None => again(self),
        };
        self.detour = Some(detour);
        found
    }

    /// Returns whether each strain of six alone changes its stress.
    fn resists(&mut self) -> bool {
        let mut start = super::Point::default();
        self.keep(&mut start);
        let strains = (std::mem::take(&mut self.dstran), self.dfgrd1);
        let all = (0..6).all(|component| {
            self.put_back(&start);
            self.dstran = [0.0; 6];
            self.dstran[component] = STRAIN;
            self.deform();
            self.stresses().is_some_and(|stress| stress[component] > start.stress[component])
        });
        (self.dstran, self.dfgrd1) = strains;
        self.put_back(&start);
        all
    }

    /// Returns how the stress through six components differs.
    fn differs(&mut self, solid: &mut Self, start: &super::Point, plane: &[f64]) -> Option<String> {
        let strain_33 = self.strain_33;
        self.put_back(start);
        let done = self.call_through(solid, Request::Stress).is_ok_and(|outcome| outcome == CallOutcome::Done);
        self.strain_33 = strain_33;
        let largest = plane.iter().chain(self.stress()).fold(0.0_f64, |most, stress| most.max(stress.abs()));
        let far = self.stress().iter().zip(plane).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        (done && self.has_finite_stress() && far > SAME * largest).then(|| {
            format!(
                "gives another stress than with 6 (off by {:.1} % of the largest in an elastic increment)",
                1e2 * far / largest
            )
        })
    }
}

//! The host's normal laws: hard with a tension cap (6.19), soft exponential (6.20 corrected).

use crate::model::{HardLaw, NormalLaw, SoftLaw};
use serde::{Deserialize, Serialize};
use std::f64::consts::E;

/// y = 1 − gap/g_0 from which on the exponential is continued by its tangent.
const LINEAR_FROM: f64 = 7.0;

/// State of the host's normal law at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct NormalState {
    /// λ, MPa.
    pub multiplier: f64,
    /// Whether the tension cap was exceeded at a converged state: for good.
    pub latched: bool,
    /// Largest gap o beyond the start of opening, mm.
    pub opening: f64,
}

/// Pressure and derivative at a penetration u = −g_N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct NormalResponse {
    pub pressure: f64,
    /// dp/du.
    pub stiffness: f64,
    /// o at the end.
    pub opening: f64,
    /// Whether anything is transmitted, shear as well.
    pub closed: bool,
    /// Whether the penalty (and the multiplier) holds the point: what Uzawa updates.
    pub held: bool,
    /// Stored energy per area, N/mm.
    pub stored_energy: f64,
}

/// A normal law with the stiffness of its penalty.
#[derive(Clone, Copy, Debug)]
pub(super) struct HostNormal {
    pub law: NormalLaw,
    /// ε_N; with a condensed perturbed multiplier ε_N + ε'. MPa/mm.
    pub stiffness: f64,
}

impl HostNormal {
    /// Returns whether tension is carried until a latch ends it.
    pub fn carries_tension(&self) -> bool {
        matches!(self.law, NormalLaw::Hard(HardLaw { p_0, .. }) if p_0 > 0.0)
    }

    /// Returns how far the tension of a converged bonded point is over the cap, MPa; `None` if it is not.
    pub fn excess(&self, pressure: f64, state: &NormalState) -> Option<f64> {
        match self.law {
            NormalLaw::Hard(law) if law.p_0 > 0.0 && !state.latched && -pressure > law.p_0 => Some(-pressure - law.p_0),
            _ => None,
        }
    }

    /// Returns the pressure at a penetration. `state` is that of the start of the increment, except for the multiplier
    /// and the latch, which change between convergences.
    pub fn advance(&self, penetration: f64, state: &NormalState) -> NormalResponse {
        match self.law {
            NormalLaw::Hard(law) => self.hard(&law, penetration, state),
            NormalLaw::Soft(law) => soft(&law, penetration),
        }
    }

    fn hard(&self, law: &HardLaw, penetration: f64, state: &NormalState) -> NormalResponse {
        let elastic = NormalResponse {
            pressure: state.multiplier + self.stiffness * penetration,
            stiffness: self.stiffness,
            opening: state.opening,
            closed: true,
            held: true,
            stored_energy: 0.5 * self.stiffness * penetration * penetration,
        };
        if law.p_0 > 0.0 && !state.latched {
            return elastic;
        }
        let cap_gap = law.p_0 / self.stiffness;
        let opening = if law.p_0 > 0.0 { state.opening.max(-penetration - cap_gap) } else { 0.0 };
        let left = remaining(law, opening);
        let response = NormalResponse { opening, closed: left > 0.0, ..NormalResponse::default() };
        // surfaces that touch have the penalty's stiffness: nothing else holds a body that a force presses on at first
        if left == 0.0 && elastic.pressure < 0.0 {
            response
        } else if left == 0.0 || penetration >= 0.0 {
            NormalResponse { opening, ..elastic }
        } else if opening > state.opening && opening > 0.0 {
            let pressure = -law.p_0 * left;
            let stored_energy = 0.5 * pressure * penetration;
            NormalResponse { pressure, stiffness: -law.p_0 / law.delta_n, stored_energy, ..response }
        } else {
            // back towards the origin along the secant
            let stiffness = law.p_0 * left / (cap_gap + opening);
            let pressure = stiffness * penetration;
            NormalResponse { pressure, stiffness, stored_energy: 0.5 * pressure * penetration, ..response }
        }
    }
}

/// 1 − o/δ_N ≥ 0: what is left of the tension cap. Nothing of one that is brittle, or that there never was.
fn remaining(law: &HardLaw, opening: f64) -> f64 {
    if law.p_0 > 0.0 && law.delta_n > 0.0 { (1.0 - opening.max(0.0) / law.delta_n).max(0.0) } else { 0.0 }
}

/// p, dp/du and ∫ p du of the exponential law; open from the gap g_0 on.
fn soft(law: &SoftLaw, penetration: f64) -> NormalResponse {
    let y = 1.0 + penetration / law.g_0;
    if y <= 0.0 {
        return NormalResponse::default();
    }
    let exponential = |y: f64| {
        let growth = y.exp_m1();
        [y * growth, growth + y * (growth + 1.0), (y - 1.0) * growth + y - 0.5 * y * y]
    };
    let [value, slope, area] = if y <= LINEAR_FROM {
        exponential(y)
    } else {
        let [value, slope, area] = exponential(LINEAR_FROM);
        let excess = y - LINEAR_FROM;
        [value + excess * slope, slope, area + excess * (value + 0.5 * excess * slope)]
    };
    let scale = law.p_0 / (E - 1.0);
    NormalResponse {
        pressure: scale * value,
        stiffness: scale * slope / law.g_0,
        closed: true,
        stored_energy: scale * area * law.g_0,
        ..NormalResponse::default()
    }
}

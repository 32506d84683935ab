//! The normal part: hard contact with a tension cap that fades, or the soft exponential law
//! (doc.md; thesis 6.19, 6.20 corrected), and what an opening leaves of the bond.

use super::State;
use super::tangential::{Integrity, Vector, scaled};
use std::f64::consts::E;

/// The normal law that the parameter `normal_law` selects.
#[derive(Clone, Copy, Debug)]
pub(super) enum NormalLaw {
    Hard(Hard),
    Soft(Soft),
}

/// Penalty contact, bilateral up to the tension p_0, which falls to 0 over the opening δ_N.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hard {
    /// ε_N, MPa/mm.
    pub stiffness: f64,
    /// p_0, MPa.
    pub tension: f64,
    /// δ_N, mm; 0: brittle.
    pub fade: f64,
}

/// Repulsion that begins at the gap g_0 and reaches p_0 at gap 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Soft {
    /// p_0, MPa.
    pub pressure: f64,
    /// g_0, mm.
    pub clearance: f64,
}

/// Pressure and bond fraction with their derivatives by the penetration u = −gap.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NormalResponse {
    pub pressure: f64,
    pub stiffness: f64,
    pub bond_fraction: f64,
    pub bond_fraction_slope: f64,
    /// ∂pressure/∂slip: mixed mode.
    pub by_slip: Vector,
    pub stored_energy: f64,
    /// Energy of opening in this increment, ≥ 0.
    pub dissipation: f64,
}

impl NormalLaw {
    /// Advances opening and returns the pressure at a penetration (negative: gap).
    #[inline]
    pub fn advance(&self, penetration: f64, state: &mut State) -> NormalResponse {
        match self {
            Self::Hard(law) => law.advance(penetration, state),
            Self::Soft(law) => law.advance(penetration, state),
        }
    }

    /// Returns what the largest opening so far has left of the bond: 1 … 0.
    #[inline]
    pub fn bond_fraction(&self, state: &State) -> f64 {
        match self {
            _ if state.open != 0.0 => 0.0,
            Self::Hard(law) => law.remaining(state.opening),
            Self::Soft(law) => law.smoothstep(state.opening).0,
        }
    }
}

impl Hard {
    /// Mixed mode: the tension is that of what the damage of law B has left, (1 − d) ε_N u.
    pub fn damaged(&self, penetration: [f64; 2], integrity: &Integrity, state: &mut State) -> NormalResponse {
        let [gap_before, gap] = penetration.map(|penetration| (-penetration).max(0.0));
        let [_, penetration] = penetration;
        state.opening = state.opening.max(gap);
        if integrity.end == 0.0 {
            state.open = 1.0;
        }
        let elastic = self.stiffness * penetration;
        let (left, by_slip, by_gap) =
            if gap > 0.0 { (integrity.end, integrity.by_slip, integrity.by_gap) } else { (1.0, [0.0; 2], 0.0) };
        let pressure = left * elastic;
        NormalResponse {
            pressure,
            stiffness: left * self.stiffness - by_gap * elastic,
            bond_fraction: 1.0,
            by_slip: scaled(by_slip, elastic),
            stored_energy: 0.5 * pressure * penetration,
            // the trapezoid's work less what is stored: ½ ε_N gap gap_before Δd
            dissipation: 0.5 * self.stiffness * gap * gap_before * (integrity.start - integrity.end).max(0.0),
            ..NormalResponse::default()
        }
    }

    /// 1 − o/δ_N ≥ 0: what is left of the tension cap at the opening o beyond it.
    fn remaining(&self, opening: f64) -> f64 {
        if opening <= 0.0 {
            1.0
        } else if opening < self.fade {
            1.0 - opening / self.fade
        } else {
            0.0
        }
    }

    fn advance(&self, penetration: f64, state: &mut State) -> NormalResponse {
        let gap = -penetration;
        let cap_gap = self.tension / self.stiffness;
        let left_before = if state.open != 0.0 { 0.0 } else { self.remaining(state.opening) };
        let opens = gap - cap_gap > 0.0 && gap - cap_gap >= state.opening;
        state.opening = state.opening.max(gap - cap_gap);
        let left = left_before.min(self.remaining(state.opening));
        if left == 0.0 {
            state.open = 1.0;
        }
        let fading = opens && left > 0.0;
        let left_slope = if fading { 1.0 / self.fade } else { 0.0 };
        let (pressure, stiffness) = if penetration >= 0.0 || left == 1.0 {
            (self.stiffness * penetration, self.stiffness)
        } else if fading {
            (-self.tension * left, -self.tension * left_slope)
        } else {
            // back towards the origin along the secant; 0 once open
            let secant = self.tension * left / (cap_gap + state.opening);
            (secant * penetration, secant)
        };
        NormalResponse {
            pressure,
            stiffness,
            bond_fraction: left,
            bond_fraction_slope: left_slope,
            stored_energy: 0.5 * pressure * penetration,
            // the triangle under the cap, in proportion: ½ p_0 (g_cap + δ_N)(1 − left)
            dissipation: 0.5 * self.tension * (cap_gap + self.fade) * (left_before - left),
            ..NormalResponse::default()
        }
    }
}

/// Gap, as a part of g_0, where the bond begins to fade.
const FADE_START: f64 = 0.8;
/// Value of y = 1 − gap/g_0 from which the tangent of the exponential takes its place.
const LINEAR_FROM: f64 = 7.0;

impl Soft {
    /// 1 − z²(3 − 2z), z = o/(0.2 g_0), and its derivative by the opening o.
    fn smoothstep(&self, opening: f64) -> (f64, f64) {
        let width = (1.0 - FADE_START) * self.clearance;
        let z = (opening / width).clamp(0.0, 1.0);
        (1.0 - z * z * (3.0 - 2.0 * z), -6.0 * z * (1.0 - z) / width)
    }

    fn advance(&self, penetration: f64, state: &mut State) -> NormalResponse {
        let y = 1.0 + penetration / self.clearance;
        let beyond = -penetration - FADE_START * self.clearance;
        let opens = beyond > 0.0 && beyond >= state.opening;
        state.opening = state.opening.max(beyond);
        let (left, slope) = self.smoothstep(state.opening);
        let left = if state.open != 0.0 { 0.0 } else { left };
        if left == 0.0 {
            state.open = 1.0;
        }
        let (pressure, stiffness, stored_energy) = self.repulsion(y);
        NormalResponse {
            pressure,
            stiffness,
            bond_fraction: left,
            bond_fraction_slope: if opens && left > 0.0 { -slope } else { 0.0 },
            stored_energy,
            ..NormalResponse::default()
        }
    }

    /// p, dp/du and the energy ∫ p du at y: (6.20) with its third branch made continuous.
    fn repulsion(&self, y: f64) -> (f64, f64, f64) {
        let scale = self.pressure / (E - 1.0);
        let exponential = |y: f64| {
            let growth = y.exp_m1();
            (y * growth, growth + y * (growth + 1.0), (y - 1.0) * growth + y - 0.5 * y * y)
        };
        let (value, slope, area) = if y <= 0.0 {
            (0.0, 0.0, 0.0)
        } else if y <= LINEAR_FROM {
            exponential(y)
        } else {
            let (value, slope, area) = exponential(LINEAR_FROM);
            let excess = y - LINEAR_FROM;
            (value + excess * slope, slope, area + excess * (value + 0.5 * excess * slope))
        };
        (scale * value, scale * slope / self.clearance, scale * area * self.clearance)
    }
}

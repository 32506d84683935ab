//! The tangential part: which law, the vectors of two slip directions, and what a law returns.

use super::State;
use super::friction::Friction;
use super::law_a::LawA;
use super::law_b::LawB;

/// Two tangential components; the second is 0 where the host has one direction.
pub(super) type Vector = [f64; 2];
/// `m[i][j]` = ∂vector_i/∂vector_j.
pub(super) type Matrix = [[f64; 2]; 2];

#[inline]
pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[inline]
pub(super) fn norm(a: Vector) -> f64 {
    if a[1] == 0.0 { a[0].abs() } else { a[0].hypot(a[1]) }
}

#[inline]
pub(super) fn scaled(a: Vector, factor: f64) -> Vector {
    [factor * a[0], factor * a[1]]
}

#[inline]
pub(super) fn difference(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1]]
}

/// factor · 1.
#[inline]
pub(super) fn scaled_identity(factor: f64) -> Matrix {
    [[factor, 0.0], [0.0, factor]]
}

/// a ⊗ b.
#[inline]
pub(super) fn outer(a: Vector, b: Vector) -> Matrix {
    [scaled(b, a[0]), scaled(b, a[1])]
}

/// Sum of two matrices.
#[inline]
pub(super) fn sum(a: Matrix, b: Matrix) -> Matrix {
    [0, 1].map(|i| [0, 1].map(|j| a[i][j] + b[i][j]))
}

/// Matrix product.
#[inline]
pub(super) fn product(a: Matrix, b: Matrix) -> Matrix {
    [0, 1].map(|i| [0, 1].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

/// Matrix times vector.
#[inline]
pub(super) fn image(a: Matrix, v: Vector) -> Vector {
    [dot(a[0], v), dot(a[1], v)]
}

/// Total slip before and after the increment, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slip {
    pub start: Vector,
    pub end: Vector,
}

impl Slip {
    /// Returns what an increment dissipates, from tractions and stored energies at its start and its end: the work of the mean
    /// traction less what was stored, which is the balance of a host that uses the trapezoid; 0 if it is not above rounding.
    #[inline]
    pub fn dissipation(&self, [start, end]: [Vector; 2], [stored_before, stored]: [f64; 2]) -> f64 {
        let mean = [0, 1].map(|i| 0.5 * (start[i] + end[i]));
        let work = dot(mean, difference(self.end, self.start));
        let dissipation = work - (stored - stored_before);
        let rounding = 16.0 * f64::EPSILON * (work.abs() + stored_before + stored);
        if dissipation > rounding { dissipation } else { 0.0 }
    }
}

/// Fraction of the bond that the opening of the gap has left intact (1 … 0), before and after the increment.
#[derive(Clone, Copy, Debug)]
pub(super) struct BondFraction {
    pub start: f64,
    pub end: f64,
}

/// Integrity of law B's bond, 1 − d, before and after the increment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Integrity {
    pub start: f64,
    pub end: f64,
    pub by_slip: Vector,
    pub by_gap: f64,
}

/// Contribution of one mechanism to the response.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contribution {
    pub traction: Vector,
    /// ∂traction/∂slip.
    pub slip_tangent: Matrix,
    /// ∂traction/∂pressure.
    pub pressure_tangent: Vector,
    /// ∂traction/∂bond fraction.
    pub bond_fraction_tangent: Vector,
    /// ∂traction/∂gap at fixed pressure: mixed mode of law B.
    pub gap_tangent: Vector,
    /// Integrity of law B's bond.
    pub integrity: Integrity,
    pub stored_energy: f64,
    /// Energy dissipated in this increment, ≥ 0.
    pub dissipation: f64,
}

/// The tangential law that the parameter `law` selects.
#[derive(Clone, Copy, Debug)]
pub(super) enum TangentialLaw<'p> {
    /// The thesis's bond with consistent unloading, parallel to a friction spring.
    A(LawA<'p>),
    /// Interfacial damage with friction on the damaged part.
    B(LawB<'p>),
    /// No bond: Coulomb friction.
    None,
}

impl TangentialLaw<'_> {
    /// Advances bond and friction from the committed `state`; `gap`: ⟨gap⟩ of mixed mode.
    #[inline]
    pub fn advance(
        &self,
        friction: &Friction,
        slip: &Slip,
        gap: f64,
        pressure: f64,
        fraction: BondFraction,
        state: &mut State,
    ) -> Contribution {
        let contribution = match self {
            Self::A(law) => {
                let bond = law.advance(slip, fraction, state);
                let rubbing = friction.advance(slip, pressure, &mut state.friction_slip);
                Contribution {
                    traction: [0, 1].map(|i| bond.traction[i] + rubbing.traction[i]),
                    slip_tangent: sum(bond.slip_tangent, rubbing.slip_tangent),
                    stored_energy: bond.stored_energy + rubbing.stored_energy,
                    dissipation: bond.dissipation + rubbing.dissipation,
                    pressure_tangent: rubbing.pressure_tangent,
                    ..bond
                }
            }
            Self::B(law) => law.advance(friction, slip, gap, pressure, fraction, state),
            Self::None => {
                state.largest_slip = state.largest_slip.max(norm(slip.end));
                friction.advance(slip, pressure, &mut state.friction_slip)
            }
        };
        state.slip = slip.end;
        contribution
    }

    /// The part of the slip that unloading does not recover: g_pl of law A's bond, d g_s of law B
    /// (t = k_e (g − d g_s)), g_s without bond.
    pub fn inelastic_slip(&self, state: &State) -> Vector {
        match self {
            Self::A(_) => state.plastic_slip,
            Self::B(_) => scaled(state.friction_slip, state.damage),
            Self::None => state.friction_slip,
        }
    }
}

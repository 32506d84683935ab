//! The fibre, and what its elasticity adds to the slip of the bond.

use super::curve::LoadSlipCurve;
use models::roots::bracketed_newton;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Position at which the slip of a curve was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
pub enum SlipAt {
    /// At the grip: the free length stretches as well.
    Grip,
    /// At the exit face.
    Exit,
}

impl SlipAt {
    /// The history's column that holds it.
    pub fn column(self) -> &'static str {
        match self {
            Self::Grip => "slip",
            Self::Exit => "slip_exit",
        }
    }
}

/// A round fibre, perpendicular to the face that it is pulled out of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TestFibre {
    /// φ, mm.
    pub diameter: f64,
    /// L, mm.
    pub embedded_length: f64,
    /// Length from the exit face to the grip, mm.
    pub free_length: f64,
    /// E, MPa.
    pub youngs_modulus: f64,
}

/// Smallest fraction of L that must still be in the matrix: points at larger slips do not determine the bond.
const LEAST_EMBEDDED: f64 = 0.02;

/// A mean bond traction at a mean slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BondPoint {
    /// mm.
    pub slip: f64,
    /// MPa.
    pub traction: f64,
}

impl TestFibre {
    /// EA, N.
    pub fn axial_stiffness(&self) -> f64 {
        self.youngs_modulus * PI / 4.0 * self.diameter.powi(2)
    }

    /// Slip at the exit face of a point of the curve, mm.
    pub fn exit_slip(&self, slip: f64, load: f64, at: SlipAt) -> f64 {
        match at {
            SlipAt::Grip => slip - load * self.free_length / self.axial_stiffness(),
            SlipAt::Exit => slip,
        }
    }

    /// Mean traction P/(πφ(L − g)) against mean slip g of every point with both above 0, by rising slip.
    ///
    /// Under a uniform traction the fibre's stretch falls linearly from P/EA at the exit to 0 at the tail: the mean slip
    /// is PL/(3EA) below that of the exit.
    pub fn mean_bond(&self, curve: &LoadSlipCurve, at: SlipAt) -> Vec<BondPoint> {
        let length = self.embedded_length;
        let point = |(&slip, &load): (&f64, &f64)| {
            let slip = self.exit_slip(slip, load, at) - load * length / (3.0 * self.axial_stiffness());
            BondPoint { slip, traction: load / (PI * self.diameter * (length - slip)) }
        };
        let is_usable = |point: &BondPoint| {
            point.slip > 0.0 && point.traction > 0.0 && point.slip < (1.0 - LEAST_EMBEDDED) * length
        };
        let mut points: Vec<BondPoint> = curve.slips.iter().zip(&curve.loads).map(point).filter(is_usable).collect();
        points.sort_by(|a, b| a.slip.total_cmp(&b.slip));
        points
    }

    /// The bond's elastic stiffness k_e whose fibre is as stiff as one of the apparent stiffness k of [`Self::mean_bond`]:
    /// P = EA β tanh(βL) u with β = √(πφ k_e/EA), and u/P = L/(3EA) + 1/(πφLk).
    pub fn elastic_stiffness(&self, apparent: f64) -> f64 {
        let (length, axial) = (self.embedded_length, self.axial_stiffness());
        let flexibility = length / (3.0 * axial) + 1.0 / (PI * self.diameter * length * apparent);
        let ratio = length / (axial * flexibility);
        // x tanh x = ratio for x = βL
        let x = bracketed_newton([0.0, ratio + 1.0], ratio.max(ratio.sqrt()).min(ratio + 0.5), 0.0, |x: f64| {
            (x * x.tanh() - ratio, x.tanh() + x / x.cosh().powi(2))
        });
        axial * (x / length).powi(2) / (PI * self.diameter)
    }
}

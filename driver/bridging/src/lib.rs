#![doc = include_str!("doc.md")]

mod average;
mod beam;
mod bond;
mod bridging;
mod composite;
mod inclination;
mod interpolation;
mod inverse;
mod model_code;
mod orientation;
mod quadrature;
mod scatter;
mod table;
#[cfg(test)]
mod test;
mod work;

pub use average::{Average, averages, averages_with_shares};
pub use beam::{BeamLoad, LayeredBeam, NotchedBeam, RESIDUAL_CMOD, Residual, SectionLaw};
pub use bond::{BondLaw, Closed, Debonding, Hook, ShearLag, Sides, Sliding};
pub use bridging::{Bond, BridgingFibre, FibreResponse};
pub use composite::{Composite, Matrix, Softening};
pub use inclination::Inclination;
pub use interpolation::Polyline;
pub use inverse::{
    BridgingFit, Estimate, Fitted, IDENTIFIABLE, MeasuredBeam, OPENINGS, Shape, SoughtBond, bond_from_bridging,
    bond_from_strengths, differences, estimates, fast_inverse, full_inverse,
};
pub use model_code::{Concrete, EurocodeClass, ModelCode2010, StrengthClass};
pub use orientation::{Directions, Faces, Orientation, wall_zones};
pub use scatter::{Beams, Scatter, quantile, scatter};
pub use table::{Curve, Table};
pub use work::{CrackStress, CrackTotals, CrackWork};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Input that makes no sense, with its place as in a case.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place} {rule}")]
pub struct Invalid {
    /// The keys that lead to it, joined by points.
    pub place: String,
    /// Requirement on the value.
    pub rule: String,
}

impl Invalid {
    pub(crate) fn unless(holds: bool, place: String, rule: &str) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self { place, rule: rule.into() }) }
    }

    pub(crate) fn unless_positive(value: f64, place: String) -> Result<(), Self> {
        Self::unless(value > 0.0 && value.is_finite(), place, "must be above 0")
    }

    pub(crate) fn if_negative(value: f64, place: String) -> Result<(), Self> {
        Self::unless(value >= 0.0 && value.is_finite(), place, "must not be below 0")
    }
}

/// A round fibre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Fibre {
    /// d, mm.
    pub diameter: f64,
    /// L_f, mm; 5 diameters or more.
    pub length: f64,
    /// Young's modulus, MPa.
    #[serde(rename = "E")]
    pub modulus: f64,
    /// Tensile strength σ_fu, MPa (default: it does not break).
    #[serde(default)]
    pub strength: Option<f64>,
    /// f_r: the strength at an angle is σ_fu exp(−f_r θ).
    #[serde(default)]
    pub rupture_f: f64,
}

impl Fibre {
    /// A fibre this much longer than thick bridges by its length.
    const LEAST_SLENDERNESS: f64 = 5.0;

    /// A_f, mm².
    pub fn area(&self) -> f64 {
        0.25 * PI * self.diameter * self.diameter
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// A number without sense.
    pub fn check(&self) -> Result<(), Invalid> {
        let place = |name| format!("fibre.{name}");
        Invalid::unless_positive(self.diameter, place("diameter"))?;
        Invalid::unless_positive(self.length, place("length"))?;
        Invalid::unless_positive(self.modulus, place("E"))?;
        let slender = self.length >= Self::LEAST_SLENDERNESS * self.diameter;
        Invalid::unless(slender, place("length"), "must be 5 diameters or more")?;
        if let Some(strength) = self.strength {
            Invalid::unless_positive(strength, place("strength"))?;
        }
        Invalid::if_negative(self.rupture_f, place("rupture_f"))
    }
}

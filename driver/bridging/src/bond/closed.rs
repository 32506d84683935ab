//! Constant friction with elastic or no debonding, and slip hardening, in closed form.

use super::Side;
use crate::{Fibre, Invalid};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Loss of the bond along the fibre before it slides as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Debonding {
    /// The fibre does not stretch: it slides at once (C2).
    Rigid,
    /// Friction τ along the debonded length, and the energy G_d (C1).
    #[default]
    Elastic,
    /// Friction τ (1 + β s/d) along it (C3).
    Hardening,
}

/// Course of the load while the fibre slides as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Sliding {
    /// The embedded length shrinks (C2, C2β).
    #[default]
    Shortening,
    /// The load stays constant: for small openings, as in C1 and C3.
    Held,
}

/// Friction along a straight fibre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Closed {
    /// Friction τ, MPa.
    pub tau: f64,
    /// Slip hardening β.
    #[serde(default)]
    pub beta: f64,
    /// Energy of debonding G_d, N/mm.
    #[serde(default)]
    pub debonding_energy: f64,
    /// Course of the load up to the end of debonding.
    #[serde(default)]
    pub debonding: Debonding,
    /// Branch after debonding: sliding.
    #[serde(default)]
    pub sliding: Sliding,
}

impl Closed {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A number without sense.
    pub fn check(&self) -> Result<(), Invalid> {
        let place = |name| format!("fibre.{name}");
        Invalid::unless_positive(self.tau, place("tau"))?;
        Invalid::unless(self.beta.is_finite(), place("beta"), "must be a number")?;
        let hardens = self.debonding == Debonding::Hardening;
        Invalid::unless(!hardens || self.beta > 0.0, place("beta"), "debonding \"hardening\" needs it above 0")?;
        let energy = self.debonding_energy;
        Invalid::if_negative(energy, place("debonding_energy"))?;
        let elastic = self.debonding == Debonding::Elastic;
        let rule = "belongs to debonding \"elastic\"";
        Invalid::unless(elastic || energy == 0.0, place("debonding_energy"), rule)
    }

    pub(crate) fn side(&self, fibre: &Fibre, modulus: f64) -> ClosedSide {
        ClosedSide {
            law: *self,
            diameter: fibre.diameter,
            modulus,
            omega: (4.0 * self.beta * self.tau / modulus).sqrt(),
        }
    }
}

/// The law with the fibre it acts on.
#[derive(Clone, Debug)]
pub(crate) struct ClosedSide {
    law: Closed,
    diameter: f64,
    /// (1 + η_E) E.
    modulus: f64,
    /// ω of C3.
    omega: f64,
}

impl ClosedSide {
    /// s_d: the slip at the exit when the fibre is debonded to its end.
    fn debonded_slip(&self, embedded: f64) -> f64 {
        let Closed { tau, beta, debonding_energy, debonding, .. } = self.law;
        let stiffness = self.modulus * self.diameter;
        match debonding {
            Debonding::Rigid => 0.0,
            Debonding::Elastic => {
                2.0 * tau * embedded * embedded / stiffness + embedded * (8.0 * debonding_energy / stiffness).sqrt()
            }
            Debonding::Hardening => {
                let half = (0.5 * self.omega * embedded / self.diameter).sinh();
                2.0 * self.diameter / beta * half * half
            }
        }
    }

    /// P² = this × s while debonding (elastic).
    fn square_per_slip(&self, embedded: f64) -> f64 {
        let energy = self.law.debonding_energy;
        let chemical = if energy == 0.0 { 0.0 } else { energy / self.debonded_slip(embedded) };
        0.5 * PI * PI * self.modulus * self.diameter.powi(3) * (self.law.tau + chemical)
    }

    /// (πd²/4) E ω/β.
    fn hardening_force(&self) -> f64 {
        0.25 * PI * self.diameter * self.diameter * self.modulus * self.omega / self.law.beta
    }

    fn debonding_load(&self, slip: f64, embedded: f64) -> f64 {
        match self.law.debonding {
            Debonding::Rigid => self.sliding_start(embedded),
            Debonding::Elastic => (self.square_per_slip(embedded) * slip).sqrt(),
            Debonding::Hardening => {
                // sinh(arcosh(1 + y)) = √(y (y + 2))
                let y = self.law.beta * slip / self.diameter;
                self.hardening_force() * (y * (y + 2.0)).sqrt()
            }
        }
    }

    /// The load at which the fibre begins to slide.
    fn sliding_start(&self, embedded: f64) -> f64 {
        match self.law.debonding {
            Debonding::Hardening => self.hardening_force() * (self.omega * embedded / self.diameter).sinh(),
            _ => PI * self.diameter * self.law.tau * embedded,
        }
    }

    /// The load after sliding by u.
    fn sliding_load(&self, u: f64, embedded: f64) -> f64 {
        let start = self.sliding_start(embedded);
        match self.law.sliding {
            Sliding::Held => start,
            Sliding::Shortening if u < embedded => {
                (start * (1.0 - u / embedded) * (1.0 + self.law.beta * u / self.diameter)).max(0.0)
            }
            Sliding::Shortening => 0.0,
        }
    }

    /// u of the greatest load of sliding.
    fn sliding_peak(&self, embedded: f64) -> f64 {
        match self.law.sliding {
            Sliding::Shortening if self.law.beta > 0.0 => (0.5 * (embedded - self.diameter / self.law.beta)).max(0.0),
            _ => 0.0,
        }
    }
}

impl Side for ClosedSide {
    fn loads(&self, slip: f64, embedded: f64) -> (f64, f64) {
        let debonded = self.debonded_slip(embedded);
        if slip <= debonded {
            let load = self.debonding_load(slip, embedded);
            return (load, load);
        }
        let (u, peak) = (slip - debonded, self.sliding_peak(embedded));
        let load = self.sliding_load(u, embedded);
        let sliding = if u <= peak { load } else { self.sliding_load(peak, embedded) };
        (load, self.debonding_load(debonded, embedded).max(sliding))
    }

    fn stage(&self, slip: f64, embedded: f64) -> u8 {
        let u = slip - self.debonded_slip(embedded);
        if u <= 0.0 {
            0
        } else if self.sliding_load(u, embedded) == 0.0 {
            3
        } else {
            1 + u8::from(u > self.sliding_peak(embedded))
        }
    }

    fn turning_slip(&self, embedded: f64) -> f64 {
        self.debonded_slip(embedded)
    }

    fn loading_slip(&self, load: f64, embedded: f64) -> f64 {
        let debonded = self.debonded_slip(embedded);
        if load <= self.debonding_load(debonded, embedded) {
            return match self.law.debonding {
                Debonding::Rigid => 0.0,
                Debonding::Elastic => load * load / self.square_per_slip(embedded),
                Debonding::Hardening => {
                    let x = (load / self.hardening_force()).powi(2);
                    self.diameter / self.law.beta * x / (1.0 + (1.0 + x).sqrt())
                }
            };
        }
        // load = start (1 − u/L)(1 + βu/d), the smaller u
        let (a, b) = (self.law.beta / (self.diameter * embedded), self.law.beta / self.diameter - 1.0 / embedded);
        let c = load / self.sliding_start(embedded) - 1.0;
        let u = 2.0 * c / (b + (b * b - 4.0 * a * c).max(0.0).sqrt());
        debonded + if u.is_finite() { u.clamp(0.0, embedded) } else { 0.0 }
    }
}

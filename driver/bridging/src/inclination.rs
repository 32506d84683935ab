//! Effect of the inclination angle on the load of a fibre.

use crate::bond::Bridged;
use crate::quadrature::{maximum, root};
use crate::{Fibre, Invalid};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Relation between the load along the crack normal and the load P_b of a perpendicular fibre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Inclination {
    /// P = P_b e^(fθ) (Li, Wang, Backer 1990).
    Exp {
        /// f: 0.35 for steel up to 30–45°, 0.7 polypropylene, 0.99 nylon.
        f: f64,
    },
    /// P = P_b e^(fθ) cos^s θ.
    ExpCos {
        /// f.
        f: f64,
        /// s.
        s: f64,
    },
    /// The matrix spalls by s_f along the fibre, and the free part of the fibre rotates (form used in discrete models
    /// of fibre concrete).
    Spalling {
        /// k of e^(kφ′), φ′ the angle between fibre and free part.
        k: f64,
        /// k_sp.
        k_sp: f64,
        /// Tensile strength of the matrix, MPa.
        ft: f64,
    },
    /// P = P_b e^(fθ) + 2 M_p c/ρ: the wire yields as it is drawn round a corner.
    Hinge {
        /// Friction in the corner.
        f: f64,
        /// Yield stress of the wire, MPa.
        yield_stress: f64,
        /// ρ, mm: the radius of the corner.
        radius: f64,
    },
}

impl Default for Inclination {
    fn default() -> Self {
        Self::Exp { f: 0.35 }
    }
}

/// An inclined fibre at an opening, unless it has broken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inclined {
    /// Load along the normal now, N,
    pub load: f64,
    /// and the greatest so far.
    pub greatest: f64,
    /// s_f: length along the fibre that has spalled, mm.
    pub spalled: f64,
    /// Stage: between two stages the load has a kink.
    pub(crate) stage: u8,
}

impl Inclination {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A number without sense.
    pub fn check(&self) -> Result<(), Invalid> {
        let place = |name: &str| format!("fibre.inclination.{name}");
        let sound = |value: f64, name: &str| Invalid::if_negative(value, place(name));
        let above = |value: f64, name: &str| Invalid::unless_positive(value, place(name));
        match *self {
            Self::Exp { f } => sound(f, "f"),
            Self::ExpCos { f, s } => sound(f, "f").and(sound(s, "s")),
            Self::Spalling { k, k_sp, ft } => sound(k, "k").and(above(k_sp, "k_sp")).and(above(ft, "ft")),
            Self::Hinge { f, yield_stress, radius } => {
                sound(f, "f").and(sound(yield_stress, "yield_stress")).and(above(radius, "radius"))
            }
        }
    }

    /// Applies the inclination to `base`, the perpendicular fibre at the opening; `at` gives the same with a spalled length. `spalls` are those of
    /// this fibre and matrix.
    #[expect(clippy::too_many_arguments, reason = "a fibre at an opening, and all that it may depend on")]
    pub(crate) fn apply(
        &self,
        fibre: &Fibre,
        angle: f64,
        opening: f64,
        embedded: f64,
        base: &Bridged,
        spalls: Option<&Spalls>,
        at: impl Fn(f64) -> Bridged,
    ) -> Inclined {
        let scaled = |factor: f64| Inclined {
            load: base.load * factor,
            greatest: base.greatest * factor,
            spalled: 0.0,
            stage: 0,
        };
        match *self {
            Self::Exp { f } => scaled((f * angle).exp()),
            Self::ExpCos { f, s } => scaled((f * angle).exp() * angle.cos().powf(s)),
            Self::Hinge { f, yield_stress, radius } => {
                let mut inclined = scaled((f * angle).exp());
                if angle > 0.0 && base.slip < embedded {
                    let moment = yield_stress * fibre.diameter.powi(3) / 6.0;
                    let turned = base.slip / (radius * angle);
                    let bending = 2.0 * moment / radius * turned.min(1.0);
                    inclined.load += bending;
                    inclined.stage = u8::from(turned >= 1.0);
                    inclined.greatest += bending;
                }
                inclined
            }
            Self::Spalling { k, k_sp, ft } => {
                let spalling = Spalling::new(fibre, k, k_sp * ft, angle, embedded);
                match spalls {
                    Some(spalls) => spalling.after(opening, spalls.largest(embedded, angle), at),
                    None => scaled(1.0),
                }
            }
        }
    }

    /// Returns how far the matrix spalls; `at` gives a perpendicular fibre: (opening, embedded length, spalled length).
    pub(crate) fn spalls(&self, fibre: &Fibre, at: impl Fn(f64, f64, f64) -> Bridged + Sync) -> Option<Spalls> {
        let Self::Spalling { k, k_sp, ft } = *self else { return None };
        let half = 0.5 * fibre.length;
        let row = |i: usize| -> Vec<[f64; 3]> {
            let embedded = half * i as f64 / LENGTHS as f64;
            let largest = |j: usize| {
                if i == 0 || j == 0 {
                    return [0.0; 3];
                }
                let spalling = Spalling::new(fibre, k, k_sp * ft, FRAC_PI_2 * j as f64 / ANGLES as f64, embedded);
                let of = |root: f64| {
                    let opening = half * root * root;
                    spalling.alone(opening, &|spalled| at(opening, embedded, spalled))
                };
                let (root, spalled) = maximum(of, 0.0, 1.0, STEPS);
                let opening = half * root * root;
                [opening, spalled, spalling.load(opening, spalled, &|spalled| at(opening, embedded, spalled))]
            };
            (0..=ANGLES).map(largest).collect()
        };
        Some(Spalls { half, largest: (0..=LENGTHS).into_par_iter().map(row).collect() })
    }
}

/// Intervals of the length and of the right angle, between which the greatest spall is linear; golden section steps over
/// the square root of the opening where it is reached.
const LENGTHS: usize = 24;
const ANGLES: usize = 18;
const STEPS: usize = 20;

/// The greatest spalled length of a whole pull-out, with the opening at which it is reached and the load there, by length
/// and angle: [opening, length, load].
#[derive(Clone, Debug)]
pub(crate) struct Spalls {
    half: f64,
    largest: Vec<Vec<[f64; 3]>>,
}

impl Spalls {
    fn largest(&self, embedded: f64, angle: f64) -> [f64; 3] {
        let place = |part: f64, count: usize| {
            let place = (part * count as f64).min(count as f64);
            let index = (place as usize).min(count - 1);
            (index, place - index as f64)
        };
        let (i, t) = place(embedded / self.half, LENGTHS);
        let (j, s) = place(angle / FRAC_PI_2, ANGLES);
        let [a, b] = [&self.largest[i], &self.largest[i + 1]];
        [0, 1, 2]
            .map(|k| (1.0 - t) * ((1.0 - s) * a[j][k] + s * a[j + 1][k]) + t * ((1.0 - s) * b[j][k] + s * b[j + 1][k]))
    }
}

/// A matrix that spalls where a fibre leaves it.
struct Spalling {
    k: f64,
    /// s_f/P_N = sin(θ/2)/(k_sp f_t d cos²(θ/2)).
    per_force: f64,
    angle: f64,
    embedded: f64,
}

impl Spalling {
    fn new(fibre: &Fibre, k: f64, strength: f64, angle: f64, embedded: f64) -> Self {
        let (sine, cosine) = (0.5 * angle).sin_cos();
        Self { k, per_force: sine / (strength * fibre.diameter * cosine * cosine), angle, embedded }
    }

    /// The angle of the free part from the normal.
    fn free_angle(&self, opening: f64, spalled: f64) -> f64 {
        let (sine, cosine) = self.angle.sin_cos();
        (2.0 * spalled * sine).atan2(opening + 2.0 * spalled * cosine)
    }

    fn load(&self, opening: f64, spalled: f64, at: &impl Fn(f64) -> Bridged) -> f64 {
        at(spalled).load * (self.k * (self.angle - self.free_angle(opening, spalled))).exp()
    }

    /// s_f of an opening without those before it.
    fn alone(&self, opening: f64, at: &impl Fn(f64) -> Bridged) -> f64 {
        if self.per_force == 0.0 {
            return 0.0;
        }
        let excess = |spalled: f64| {
            let normal = self.load(opening, spalled, at) * self.free_angle(opening, spalled).cos();
            spalled - self.per_force * normal
        };
        // a fibre that spalls out altogether carries nothing
        root(excess, 0.0, self.embedded)
    }

    /// Returns the load at an opening after the greatest spall was reached at another: spalls do not heal.
    fn after(&self, opening: f64, [peak, largest, highest]: [f64; 3], at: impl Fn(f64) -> Bridged) -> Inclined {
        let is_largest = opening >= peak;
        let spalled = if is_largest { largest } else { self.alone(opening, &at).min(largest) };
        let load = self.load(opening, spalled, &at);
        let greatest = if is_largest { load.max(highest) } else { load };
        Inclined { load, greatest, spalled, stage: at(spalled).stage % 8 + 8 * u8::from(is_largest) }
    }
}

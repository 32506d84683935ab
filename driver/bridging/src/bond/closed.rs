//! Constant friction with elastic or no debonding, and slip hardening, in closed form.

use super::Side;
use crate::quadrature::root;
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

/// A hooked end: a plastic hinge over friction at each bend (Alwan, Naaman, Guerrero 1999). It knows no concrete: its
/// channel is rigid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hook {
    /// Lengths of the pieces from the fibre's end on, mm, each up to a bend: two of a hook with two bends.
    pub lengths: Vec<f64>,
    /// Angle of each bend, degrees.
    pub angle_deg: f64,
    /// Radius of the bends, mm: over its arc a hinge comes and goes.
    pub radius: f64,
    /// Friction coefficient μ in the bends.
    pub friction: f64,
    /// Yield stress of the wire, MPa (default the fibre's strength).
    #[serde(default)]
    pub yield_stress: Option<f64>,
}

/// More bends than this has no fibre.
const MOST_BENDS: usize = 8;
/// Least angle of a bend, degrees: a hook of one that is smaller is none, and the number may be one in radians.
const LEAST_ANGLE: f64 = 5.0;
/// A curvature below this part of the load is rounding.
const ROUNDING: f64 = 1e-9;

impl Hook {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A number without sense.
    pub fn check(&self, fibre: &Fibre) -> Result<(), Invalid> {
        let place = |name| format!("fibre.hook.{name}");
        let some = (1..=MOST_BENDS).contains(&self.lengths.len());
        Invalid::unless(some, place("lengths"), "must be 1 to 8: one for each bend")?;
        for (k, &length) in self.lengths.iter().enumerate() {
            Invalid::unless_positive(length, format!("fibre.hook.lengths[{k}]"))?;
        }
        let within = self.lengths.iter().sum::<f64>() < 0.5 * fibre.length;
        Invalid::unless(within, place("lengths"), "must be shorter than half the fibre together")?;
        let bent = self.angle_deg >= LEAST_ANGLE && self.angle_deg < 90.0;
        Invalid::unless(bent, place("angle_deg"), "must lie between 5 and 90 degrees")?;
        let round = self.radius >= 0.5 * fibre.diameter && self.radius.is_finite();
        Invalid::unless(round, place("radius"), "must be at least half of the fibre's diameter")?;
        for (k, &length) in self.lengths.iter().enumerate() {
            let taken = Self::taken_by_bends(k, self.angle_deg.to_radians(), self.radius);
            let rule = format!("must be more than {taken:.4} mm, which its bends take, or radius or angle smaller");
            Invalid::unless(length > taken, format!("fibre.hook.lengths[{k}]"), &rule)?;
        }
        let slides = self.friction >= 0.0 && self.pulley() < 1.0;
        Invalid::unless(slides, place("friction"), "must not be below 0, nor so high that the bends lock")?;
        let known = self.yield_stress.or(fibre.strength).is_some();
        Invalid::unless(known, place("yield_stress"), "is needed where the fibre has no strength")?;
        Invalid::unless_positive(self.yield_stress.or(fibre.strength).unwrap_or(0.0), place("yield_stress"))
    }

    /// Returns what the arcs of the bends take of a piece of a hook, counted from the tip, mm: the tip has one bend, others two.
    pub fn taken_by_bends(piece: usize, angle: f64, radius: f64) -> f64 {
        let cut = radius * (0.5 * angle).tan();
        if piece == 0 { cut } else { 2.0 * cut }
    }

    /// Returns the greatest load of the hook of a fibre that is embedded beyond it, and the load of all hinges at their full moment, N.
    /// The first is less if a bend is straight before others have slid by their arcs.
    pub fn greatest_loads(&self, fibre: &Fibre) -> [f64; 2] {
        let bends = Bends::new(self, fibre);
        let loads = bends.kinks(f64::INFINITY).into_iter().map(|u| bends.load(u, f64::INFINITY));
        [loads.fold(0.0, f64::max), bends.sum(bends.places.iter().map(|_| 1.0))]
    }

    /// Returns the arc of a bend, over which its hinge comes and goes, mm.
    pub fn arc(&self) -> f64 {
        self.radius * self.angle_deg.to_radians()
    }

    /// μ cos β with β = (π − θ)/2, the angle between wire and reaction in a bend.
    fn pulley(&self) -> f64 {
        self.friction * (0.5 * (PI - self.angle_deg.to_radians())).cos()
    }
}

/// Friction along a straight fibre, and a hook.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Closed {
    /// Friction τ, MPa.
    pub tau: f64,
    /// Slip hardening β.
    #[serde(default)]
    pub beta: f64,
    /// Energy of debonding G_d, N/mm.
    #[serde(default)]
    pub debonding_energy: f64,
    /// Debonding, until the fibre slides as a whole.
    #[serde(default)]
    pub debonding: Debonding,
    /// Sliding of the fibre as a whole.
    #[serde(default)]
    pub sliding: Sliding,
    /// Hooks at both ends (default none).
    #[serde(default)]
    pub hook: Option<Hook>,
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
            law: self.clone(),
            bends: self.hook.as_ref().map(|hook| Bends::new(hook, fibre)),
            diameter: fibre.diameter,
            modulus,
            omega: (4.0 * self.beta * self.tau / modulus).sqrt(),
        }
    }
}

/// The bends of a hook.
#[derive(Clone, Debug)]
struct Bends {
    /// Distances of the bends from the fibre's end.
    places: Vec<f64>,
    /// Arc of a bend: the slip over which its hinge comes and goes.
    arc: f64,
    /// σ_y π r²/(6 cos θ).
    hinge: f64,
    /// μ cos β.
    pulley: f64,
}

impl Bends {
    fn new(hook: &Hook, fibre: &Fibre) -> Self {
        let yield_stress = hook.yield_stress.or(fibre.strength).unwrap_or(0.0);
        let angle = hook.angle_deg.to_radians();
        let place = |place: &mut f64, length: &f64| {
            *place += length;
            Some(*place)
        };
        Self {
            places: hook.lengths.iter().scan(0.0, place).collect(),
            arc: hook.arc(),
            hinge: yield_stress * fibre.area() / (6.0 * angle.cos()),
            pulley: hook.pulley(),
        }
    }

    /// Returns the load of the hook after sliding by u. From the end on, each embedded bend that wire still passes adds
    /// its hinge, and friction in proportion to the loads on both of its sides.
    fn load(&self, u: f64, embedded: f64) -> f64 {
        let passed = self.places.iter().filter(|place| **place < embedded && **place > u);
        self.sum(passed.map(|place| (u / self.arc).min((place - u) / self.arc).clamp(0.0, 1.0)))
    }

    /// Returns the load of bends, from the end on, whose hinges carry these parts of their full moment.
    fn sum(&self, parts: impl Iterator<Item = f64>) -> f64 {
        parts.fold(0.0, |load, part| (load * (1.0 + self.pulley) + part * self.hinge) / (1.0 - self.pulley))
    }

    /// Slips by which the load has kinks, in order.
    fn kinks(&self, embedded: f64) -> Vec<f64> {
        let embedded = self.places.iter().filter(|place| **place < embedded);
        let of = |place: &f64| {
            if *place > 2.0 * self.arc {
                [self.arc, place - self.arc, *place]
            } else {
                [0.5 * place, 0.5 * place, *place]
            }
        };
        let mut kinks: Vec<f64> = embedded.flat_map(of).collect();
        kinks.sort_by(f64::total_cmp);
        kinks.dedup();
        kinks
    }
}

/// The law with the fibre it acts on.
#[derive(Clone, Debug)]
pub(crate) struct ClosedSide {
    law: Closed,
    bends: Option<Bends>,
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

    /// Distances of the bends from the fibre's end.
    pub fn bends(&self) -> &[f64] {
        self.bends.as_ref().map_or(&[], |bends| bends.places.as_slice())
    }

    /// The load after sliding by u, of the straight fibre and the hook.
    fn load_after(&self, u: f64, embedded: f64) -> f64 {
        let hook = self.bends.as_ref().map_or(0.0, |bends| bends.load(u, embedded));
        self.sliding_load(u, embedded) + hook
    }

    /// Returns the slips at which the load after sliding has kinks, or is greatest between them, in order. `first`:
    /// only up to the first maximum.
    fn turns(&self, bends: &Bends, embedded: f64, first: bool) -> Vec<f64> {
        let mut kinks = bends.kinks(embedded);
        let end = bends.places.iter().copied().fold(embedded, f64::max);
        kinks.push(end);
        let mut from = 0.0;
        let mut turns = Vec::new();
        for to in kinks {
            // of a parabola through three of its points
            let [a, b, c] = [from, 0.5 * (from + to), to].map(|u| self.load_after(u, embedded));
            let (bend, slope) = (2.0 * (a - 2.0 * b + c), 4.0 * b - 3.0 * a - c);
            let top = -slope / (2.0 * bend);
            if bend < -ROUNDING * a.max(c) && top > 0.0 && top < 1.0 {
                turns.push(from + top * (to - from));
                if first {
                    return turns;
                }
            }
            if first && c <= a {
                return turns;
            }
            turns.push(to);
            from = to;
        }
        turns
    }

    /// The load after sliding by u, and the greatest so far.
    fn hooked_loads(&self, bends: &Bends, u: f64, embedded: f64) -> (f64, f64) {
        let load = self.load_after(u, embedded);
        let turns = self.turns(bends, embedded, false).into_iter().take_while(|turn| *turn < u);
        (load, turns.map(|turn| self.load_after(turn, embedded)).fold(load, f64::max))
    }

    /// The load after sliding by u, of the straight fibre.
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
        if let Some(bends) = &self.bends {
            let (load, sliding) = self.hooked_loads(bends, u, embedded);
            return (load, self.debonding_load(debonded, embedded).max(sliding));
        }
        let load = self.sliding_load(u, embedded);
        let sliding = if u <= peak { load } else { self.sliding_load(peak, embedded) };
        (load, self.debonding_load(debonded, embedded).max(sliding))
    }

    fn stage(&self, slip: f64, embedded: f64) -> u8 {
        let u = slip - self.debonded_slip(embedded);
        if u <= 0.0 {
            0
        } else if let Some(bends) = &self.bends {
            let passed = self.turns(bends, embedded, false).into_iter().filter(|turn| *turn < u).count();
            // neighbouring stages differ, and there are eight
            if self.load_after(u, embedded) == 0.0 { 7 } else { 1 + (passed % 6) as u8 }
        } else if self.sliding_load(u, embedded) == 0.0 {
            3
        } else {
            1 + u8::from(u > self.sliding_peak(embedded))
        }
    }

    fn turning_slip(&self, embedded: f64) -> f64 {
        let rises = |bends: &Bends| self.turns(bends, embedded, true).last().copied().unwrap_or(0.0);
        self.debonded_slip(embedded) + self.bends.as_ref().map_or(0.0, rises)
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
        if self.bends.is_some() {
            let rise = self.turning_slip(embedded) - debonded;
            let excess = |u: f64| self.load_after(u, embedded) - load;
            let u = if excess(rise) <= 0.0 { rise } else { root(excess, 0.0, rise) };
            return debonded + u;
        }
        // load = start (1 − u/L)(1 + βu/d), the smaller u
        let (a, b) = (self.law.beta / (self.diameter * embedded), self.law.beta / self.diameter - 1.0 / embedded);
        let c = load / self.sliding_start(embedded) - 1.0;
        let u = 2.0 * c / (b + (b * b - 4.0 * a * c).max(0.0).sqrt());
        debonded + if u.is_finite() { u.clamp(0.0, embedded) } else { 0.0 }
    }
}

//! The crack band: post-peak strain stretched so that h ∫ σ dε is the fracture energy (docs/theory/crack-band.md).
//!
//! Beyond the peak x_p of the uniaxial curve the law at x is reached only at
//! x̃ = x + (r − 1)(x_in(x) − x_in(x_p)), x_in = x − σ/E, which adds (r − 1)(g − W_p + σ_p²/2E) to
//! g = ∫ σ dx. The factor r follows from the wanted energy; D̃ from f(D̃) = σ(x)/(E x̃).

use super::Parameters;
use super::uniaxial::{Point, Uniaxial};
use crate::damage_law::{ETA_MAX, damage, integrity};
use umat_abi::law::ConfigurationError;
use umat_abi::table::require;

impl Parameters {
    /// Returns whether a fracture energy is given.
    #[inline(always)]
    pub(super) fn wants_crack_band(&self) -> bool {
        self.fracture_energy > 0.0 || self.crushing_energy > 0.0
    }

    /// ∫ σ dε of the curve itself is infinite for B ≤ 1: no stretch gives it an energy.
    #[inline(always)]
    pub(super) fn check_exponents(&self) -> Result<(), ConfigurationError> {
        let rule = "G_f > 0 needs B_t > 1: otherwise the curve dissipates without limit";
        require(self.fracture_energy <= 0.0 || self.tension.b > 1.0, rule, self.tension.b)?;
        let rule = "G_c > 0 needs B_c > 1: otherwise the curve dissipates without limit";
        require(self.crushing_energy <= 0.0 || self.compression.b > 1.0, rule, self.compression.b)
    }

    /// Refuses a length that the crack bands cannot work with, and none where there are any.
    #[inline(never)]
    pub(super) fn check_characteristic_length(&self, length: Option<f64>) -> Result<(), ConfigurationError> {
        if self.wants_crack_band() && length.is_none() {
            let parameter = if self.fracture_energy > 0.0 { "G_f" } else { "G_c" };
            return Err(ConfigurationError::CharacteristicLengthMissing { parameter });
        }
        for (softening, name) in self.softening(length).iter().zip(["G_f", "G_c"]) {
            if let Some(band) = &softening.band {
                band.check(&softening.curve, name)?;
            }
        }
        Ok(())
    }

    /// The two branches, with crack bands as far as energies and a length are given.
    #[inline]
    pub(super) fn softening(&self, length: Option<f64>) -> [Softening; 2] {
        let band = |fracture_energy: f64, inelastic_fraction: f64| {
            let length = length.filter(|_| fracture_energy > 0.0)?;
            Some(CrackBand { fracture_energy, length, inelastic_fraction })
        };
        [
            Softening {
                curve: Uniaxial::tension(&self.elasticity, self.tension),
                band: band(self.fracture_energy, self.b_t),
            },
            Softening {
                curve: Uniaxial::compression(&self.elasticity, self.compression, self.beta),
                band: band(self.crushing_energy, self.b_c),
            },
        ]
    }
}

/// Crack band of one branch: the energy that it dissipates and the length over which it does so.
#[derive(Clone, Copy, Debug)]
pub(super) struct CrackBand {
    /// G_f or G_c, N/mm.
    pub fracture_energy: f64,
    /// CELENT, mm.
    pub length: f64,
    /// b: the inelastic fraction of the growth of strain.
    pub inelastic_fraction: f64,
}

/// A post-peak state of the stretched curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretched {
    /// η̃.
    pub eta: f64,
    /// dD̃/dY.
    pub rate: f64,
    /// The point of the unstretched curve with the same stress.
    point: Point,
    /// x̃.
    strain: f64,
}

/// The stretch of one curve: its peak and r.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    peak: Point,
    peak_work: f64,
    /// r.
    factor: f64,
}

/// Iterations that suffice for Newton in a bracket: each step at least halves it or converges quadratically.
const MAX_ITERATIONS: usize = 80;

/// A Newton step this small leaves an error of its square, below rounding.
const LAST_STEP: f64 = 3e-9;

/// Root of an increasing function of q, given as (value, slope), between `lower` and `upper`. Newton converges from everywhere here: the
/// bisections by which [`crate::roots::bracketed_newton`] guards against cycles would change the last digits.
fn increasing_root(f: impl Fn(f64) -> (f64, f64), mut lower: f64, mut upper: f64, start: f64) -> f64 {
    let mut q = start.clamp(lower, upper);
    for _ in 0..MAX_ITERATIONS {
        let (value, slope) = f(q);
        if value > 0.0 {
            upper = q
        } else {
            lower = q
        }
        let newton = q - value / slope;
        let next = if newton > lower && newton < upper { newton } else { 0.5 * (lower + upper) };
        if (next - q).abs() <= LAST_STEP && next == newton {
            return next;
        }
        q = next;
    }
    q
}

/// The peak of the curve, where R = 2Y D̂' (−f')/f = 1; unique for B > 1/2, found in q = ln η, in
/// which ln R is nearly linear.
pub(super) fn peak(curve: &Uniaxial) -> Point {
    let p = 1.0 / curve.law.b;
    let q = increasing_root(
        |q| {
            let point = curve.point(q);
            let ratio = curve.stiffness_ratio(point.eta);
            let (loss, loss_rate) = curve.stiffness_losses(integrity(point.eta));
            let d = damage(point.eta);
            let slope = p * (point.excess / point.energy - 1.0) + 1.0 - 2.0 * d
                + (loss_rate / loss + loss / ratio) * d / (1.0 + point.eta);
            ((1.0 - point.slope / ratio).ln(), slope)
        },
        -300.0,
        300.0,
        -(2.0 * curve.law.b - 1.0).ln(),
    );
    curve.point(q)
}

impl CrackBand {
    /// The energy ∫ σ dx̃ that the curve must have: G/h less what the recovering sides give back and
    /// the inelastic strain dissipates beyond the threshold, where it stretches strain by 1/(1 − b).
    fn wanted_work(&self, curve: &Uniaxial) -> f64 {
        let b = self.inelastic_fraction;
        let elastic = curve.youngs_modulus / curve.modulus * curve.law.threshold;
        (1.0 - b) * self.fracture_energy / (self.length * (1.0 - curve.recovery)) + b * elastic
    }

    /// The stretch that gives the wanted energy.
    #[inline(never)]
    pub fn stretch(&self, curve: &Uniaxial) -> Stretch {
        let peak = peak(curve);
        let peak_work = curve.work(peak.energy, peak.eta);
        let factor = 1.0 + (self.wanted_work(curve) - total_work(curve)) / stretchable_work(curve, &peak, peak_work);
        Stretch { peak, peak_work, factor }
    }

    /// Refuses a length beyond which the strain of a softening element would run backwards.
    pub fn check(&self, curve: &Uniaxial, parameter: &'static str) -> Result<(), ConfigurationError> {
        let stretch = self.stretch(curve);
        if self.allows(curve, &stretch) {
            return Ok(());
        }
        let limit = self.limit(curve, &stretch.peak, stretch.peak_work);
        Err(ConfigurationError::CharacteristicLengthTooLarge { parameter, length: self.length, limit })
    }

    /// Returns whether the strain runs forwards with this length, from its stretch; lengths far below the limit are recognised at once.
    pub fn allows(&self, curve: &Uniaxial, stretch: &Stretch) -> bool {
        let bound = curve.slope_bound(&stretch.peak);
        stretch.factor > self.least_factor(curve, bound)
            || self.is_below(self.limit(curve, &stretch.peak, stretch.peak_work))
    }

    fn is_below(&self, limit: f64) -> bool {
        self.length < limit || limit < 0.0
    }

    /// The length at which the wanted work is the least one.
    #[inline(never)]
    fn limit(&self, curve: &Uniaxial, peak: &Point, peak_work: f64) -> f64 {
        let least_factor = self.least_factor(curve, steepest_slope(curve, peak));
        let least_work = total_work(curve) + (least_factor - 1.0) * stretchable_work(curve, peak, peak_work);
        let b = self.inelastic_fraction;
        let elastic = curve.youngs_modulus / curve.modulus * curve.law.threshold;
        (1.0 - b) * self.fracture_energy / ((1.0 - curve.recovery) * (least_work - b * elastic))
    }

    /// dε/dx > 0 on the whole tail, with ε = x̃ − κ(x̃ − σ/E), asks for
    /// r − 1 > −(1 + m s)/(1 − s), m = κ(1 − b)/(1 − κ), at the steepest s = σ'/E.
    fn least_factor(&self, curve: &Uniaxial, steepest: f64) -> f64 {
        let recovered = curve.recovery * (1.0 - self.inelastic_fraction) / (1.0 - curve.recovery);
        1.0 - (1.0 + recovered * steepest) / (1.0 - steepest)
    }
}

/// ∫₀^∞ σ dx of the curve itself.
fn total_work(curve: &Uniaxial) -> f64 {
    curve.youngs_modulus / curve.modulus * curve.total_dissipation()
}

/// ∫ σ dx_in beyond the peak: g − W_p + σ_p²/2E.
fn stretchable_work(curve: &Uniaxial, peak: &Point, peak_work: f64) -> f64 {
    let ratio = curve.stiffness_ratio(peak.eta) * peak.strain;
    total_work(curve) - peak_work + 0.5 * curve.youngs_modulus * ratio * ratio
}

/// Range of q = ln η beyond the peak in which the steepest slope is sought, and number of intervals of the first scan.
const SEARCH: (f64, usize) = (20.0, 400);

/// min σ'(x)/E beyond the peak: a scan, then golden sections.
fn steepest_slope(curve: &Uniaxial, peak: &Point) -> f64 {
    let first = peak.eta.ln();
    let width = SEARCH.0 / SEARCH.1 as f64;
    let slope = |q: f64| curve.point(q).slope;
    let best = (0..=SEARCH.1)
        .map(|i| first + i as f64 * width)
        .min_by(|a, b| slope(*a).total_cmp(&slope(*b)))
        .unwrap_or(first);
    slope(maximum(|q| -slope(q), best - width, best + width, 1e-9))
}

/// The place of the one maximum of a function between two places, to within a `width`: golden sections.
pub(super) fn maximum(f: impl Fn(f64) -> f64, mut lower: f64, mut upper: f64, width: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    while upper - lower > width {
        let (a, b) = (upper - golden * (upper - lower), lower + golden * (upper - lower));
        if f(a) > f(b) { upper = b } else { lower = a }
    }
    0.5 * (lower + upper)
}

impl Stretch {
    /// The state at an energy release rate; `None` before the peak, where the curve itself holds. A state
    /// nearby shortens the search.
    pub fn at(&self, curve: &Uniaxial, energy: f64, nearby: Option<&Stretched>) -> Option<Stretched> {
        if energy <= self.peak.energy {
            return None;
        }
        let strain = curve.strain(energy);
        let stretch = self.factor - 1.0;
        let peak_inelastic = self.peak.strain * (1.0 - curve.stiffness_ratio(self.peak.eta));
        // x (1 + (r − 1)(1 − f)) = x̃ + (r − 1) x_in(x_p), solved for q = ln η in logarithms
        let target = strain + stretch * peak_inelastic;
        let ceiling = if stretch > 0.0 { strain } else { target / self.factor };
        let ceiling_energy = 0.5 * curve.modulus * ceiling * ceiling;
        let lower = self.peak.eta.ln();
        let upper = curve.law.eta(ceiling_energy).min(ETA_MAX).ln().max(lower) + 1e-9;
        let q = increasing_root(
            |q| {
                let point = curve.point(q);
                let reach = point.strain * (1.0 + stretch * (1.0 - curve.stiffness_ratio(point.eta)));
                let strain_slope = point.excess / (curve.law.b * curve.modulus * point.strain);
                ((reach / target).ln(), strain_slope * (1.0 + stretch * (1.0 - point.slope)) / reach)
            },
            lower,
            upper,
            nearby.map_or(upper, |state| state.point.eta.ln()),
        );
        let point = curve.point(q);
        let ratio = curve.stiffness_ratio(point.eta) * point.strain / strain;
        let eta = curve.eta_of_stiffness(ratio);
        let slope = point.slope / (1.0 + stretch * (1.0 - point.slope));
        let rate = (ratio - slope) / (2.0 * energy * curve.stiffness_loss(eta, eta));
        Some(Stretched { eta, rate, point, strain })
    }

    /// ∫₀ Y (−f') dD̃ up to a stretched state: (E*/E)(∫ σ dx̃ − ½ σ x̃).
    pub fn dissipation(&self, curve: &Uniaxial, state: &Stretched) -> f64 {
        let e = curve.youngs_modulus;
        let stress = |point: &Point| e * curve.stiffness_ratio(point.eta) * point.strain;
        let (now, peak) = (stress(&state.point), stress(&self.peak));
        let work = curve.work(state.point.energy, state.point.eta);
        let stretched = self.peak_work + self.factor * (work - self.peak_work)
            - (self.factor - 1.0) * (now * now - peak * peak) / (2.0 * e);
        curve.modulus / e * (stretched - 0.5 * now * state.strain)
    }
}

/// One branch's D(Y): D̂, stretched beyond the peak if there is a crack band.
#[derive(Clone, Copy, Debug)]
pub(super) struct Softening {
    /// The branch in uniaxial stress.
    pub curve: Uniaxial,
    /// The crack band, if any.
    pub band: Option<CrackBand>,
}

/// Damage at an energy release rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Damage {
    /// η.
    pub eta: f64,
    /// dD/dY.
    pub rate: f64,
    /// Stretch and state of the stretched curve, where the damage is taken from it.
    pub stretched: Option<(Stretch, Stretched)>,
}

impl Softening {
    /// η and dD/dY at an energy release rate above the threshold.
    #[inline]
    pub fn damage(&self, energy: f64) -> Damage {
        let eta = self.curve.law.eta(energy);
        let rate = self.curve.law.damage_rate(energy, eta);
        if let Some(band) = &self.band {
            // before the peak the unstretched curve applies; its slope shows this without computing the peak
            if self.curve.slope(energy, eta, rate) < 0.0 {
                let stretch = band.stretch(&self.curve);
                if !band.allows(&self.curve, &stretch) {
                    // CELENT grew beyond the limit after the first call: the update reports it
                    return Damage { eta: f64::NAN, rate: f64::NAN, stretched: None };
                }
                if let Some(state) = stretch.at(&self.curve, energy, None) {
                    return Damage { eta: state.eta, rate: state.rate, stretched: Some((stretch, state)) };
                }
            }
        }
        Damage { eta, rate, stretched: None }
    }
}

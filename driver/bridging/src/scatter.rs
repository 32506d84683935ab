//! Beams with fibres at random: how many cross the notch, where, how long and at what angle.
//!
//! The mean is the quadrature's business; this is for the scatter about it. Every beam draws from a stream of its own,
//! so that results do not depend on the number of threads.

use crate::beam::{BeamLoad, LayeredBeam, NotchedBeam, Residual, SectionLaw};
use crate::interpolation::Polyline;
use crate::{Composite, Invalid};
use rand_distr::{Distribution, LogNormal, Poisson, StandardUniform};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Loads are tabulated at so many lengths and angles, linear in between.
const LENGTHS: usize = 64;
const ANGLES: usize = 32;
/// Points of the distribution of angles.
const DISTRIBUTION: usize = 4000;
/// More beams, strips or fibres a beam than these are a mistake.
const MOST_BEAMS: usize = 1_000_000;
const MOST_STRIPS: usize = 100;
const MOST_FIBRES: f64 = 1e6;

/// Quantities that vary from beam to beam.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Scatter {
    /// Number of beams.
    pub beams: usize,
    /// Coefficient of variation of a fibre's load due to its bond (lognormal, mean 1).
    pub bond_cv: f64,
    /// Coefficient of variation of the strength.
    pub strength_cv: f64,
    /// Number of strips of the ligament, each with the fibres that cross it.
    pub strips: usize,
    /// Seed.
    pub seed: u64,
}

impl Default for Scatter {
    fn default() -> Self {
        Self { beams: 1000, bond_cv: 0.2, strength_cv: 0.0, strips: 10, seed: 1 }
    }
}

impl Scatter {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A number without sense.
    pub fn check(&self) -> Result<(), Invalid> {
        let place = |name| format!("scatter.{name}");
        let some = (2..=MOST_BEAMS).contains(&self.beams);
        Invalid::unless(some, place("beams"), "must lie between 2 and 1000000")?;
        Invalid::unless((1..=MOST_STRIPS).contains(&self.strips), place("strips"), "must lie between 1 and 100")?;
        for (cv, name) in [(self.bond_cv, "bond_cv"), (self.strength_cv, "strength_cv")] {
            Invalid::unless((0.0..=2.0).contains(&cv), place(name), "must lie between 0 and 2")?;
        }
        Ok(())
    }
}

/// The beams, in the order of their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beams {
    /// Fibres across the notch.
    pub fibres: Vec<usize>,
    /// σ_f of the whole ligament at the openings, by beam, MPa.
    pub bridging: Vec<Vec<f64>>,
    /// The test at the given CMODs, by beam.
    pub loads: Vec<Vec<BeamLoad>>,
    /// Strengths by beam.
    pub residual: Vec<Residual>,
}

/// Makes the beams. `openings` rise from 0; `cmods` are those of [`Beams::loads`]. `None`: before all beams were made,
/// `is_stopped` said so.
///
/// # Errors
/// Numbers without sense.
pub fn scatter(
    composite: &Composite,
    geometry: &NotchedBeam,
    openings: &[f64],
    cmods: &[f64],
    settings: &Scatter,
    is_stopped: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Beams>, Invalid> {
    settings.check()?;
    geometry.check()?;
    let rising = openings.first() == Some(&0.0) && openings.windows(2).all(|pair| pair[1] > pair[0]);
    Invalid::unless(rising, "openings".into(), "must rise from 0")?;
    let area = geometry.width * geometry.ligament();
    let mean = composite.fibres_per_area() * area;
    let some = mean > 0.0 && mean <= MOST_FIBRES;
    Invalid::unless(some, "beam".into(), "must be crossed by at most 1000000 fibres")?;
    let population = Population::new(composite, openings);
    let number = Poisson::new(mean).expect("the mean is above 0");
    let [bond, strength] = [settings.bond_cv, settings.strength_cv].map(|cv| {
        let variance = (cv * cv).ln_1p();
        LogNormal::new(-0.5 * variance, variance.sqrt()).expect("the variance is finite")
    });
    let made: Option<Vec<_>> = (0..settings.beams)
        .into_par_iter()
        .map(|beam| {
            if is_stopped() {
                return None;
            }
            let mut random = Pcg64::new(u128::from(settings.seed), beam as u128);
            let fibres = number.sample(&mut random) as usize;
            let mut strips = vec![vec![0.0; openings.len()]; settings.strips];
            for _ in 0..fibres {
                let strip = (uniform(&mut random) * settings.strips as f64) as usize;
                let interpolation = population.draw(&mut random);
                let factors = (bond.sample(&mut random), strength.sample(&mut random));
                population.add(interpolation, factors, &mut strips[strip.min(settings.strips - 1)]);
            }
            let scale = settings.strips as f64 / area;
            strips.iter_mut().flatten().for_each(|stress| *stress *= scale);
            let mean = |k: usize| strips.iter().map(|strip| strip[k]).sum::<f64>() / settings.strips as f64;
            let bridging: Vec<f64> = (0..openings.len()).map(mean).collect();
            let law = |strip: &Vec<f64>| {
                let bridging = Polyline::new(openings.iter().copied().zip(strip.iter().copied()));
                SectionLaw::new(&composite.matrix, &composite.with_matrix(&bridging), geometry.hinge())
            };
            let laws: Vec<SectionLaw> = strips.iter().map(law).collect();
            let tested = LayeredBeam::new(*geometry, &laws, &composite.matrix);
            let loads: Vec<BeamLoad> = cmods.iter().map(|&cmod| tested.at(cmod)).collect();
            Some((fibres, bridging, loads, tested.residual()))
        })
        .collect();
    let Some(made) = made else { return Ok(None) };
    let mut beams = Beams::default();
    for (fibres, bridging, loads, residual) in made {
        beams.fibres.push(fibres);
        beams.bridging.push(bridging);
        beams.loads.push(loads);
        beams.residual.push(residual);
    }
    Ok(Some(beams))
}

/// The value that a part of the values is below, straight between order statistics.
pub fn quantile(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = part.clamp(0.0, 1.0) * (sorted.len() as f64 - 1.0);
    match (sorted.get(place.floor() as usize), sorted.get(place.ceil() as usize)) {
        (Some(low), Some(high)) => low + (place - place.floor()) * (high - low),
        _ => f64::NAN,
    }
}

fn uniform(random: &mut Pcg64) -> f64 {
    StandardUniform.sample(random)
}

/// Unbroken loads of all possible fibres, and the distribution of their angles.
struct Population {
    /// Loads at (length, angle), over the openings.
    loads: Vec<Vec<f64>>,
    /// 0 unless all fibres are at one angle.
    angles: usize,
    /// Part of the fibres across a crack that are at a smaller angle, over it.
    distribution: Polyline,
    /// Breaking load over the angle.
    strength: Option<(f64, f64)>,
}

/// Interpolation of the load of a random fibre: indices of four loads with their weights, and the angle.
struct Interpolation {
    corners: [(usize, f64); 4],
    angle: f64,
}

impl Population {
    fn new(composite: &Composite, openings: &[f64]) -> Self {
        let half = 0.5 * composite.fibre.fibre.length;
        let directions = &composite.directions;
        let single = directions.is_single().then(|| directions.nodes(0, 0)[0].0);
        let angles = if single.is_some() { 0 } else { ANGLES };
        let angle = |k: usize| single.unwrap_or(FRAC_PI_2 * k as f64 / ANGLES as f64);
        let loads: Vec<Vec<Vec<f64>>> = (0..=LENGTHS)
            .into_par_iter()
            .map(|length| {
                let mut rows = vec![vec![0.0; openings.len()]; angles + 1];
                if length > 0 {
                    for (k, &opening) in openings.iter().enumerate() {
                        let opening = opening - composite.activation;
                        if opening < 0.0 {
                            continue;
                        }
                        let prepared = composite.fibre.prepare(opening, half * length as f64 / LENGTHS as f64);
                        for (j, row) in rows.iter_mut().enumerate() {
                            row[k] = composite.fibre.unbroken(&prepared, angle(j)).load;
                        }
                    }
                }
                rows
            })
            .collect();
        let mut below = 0.0;
        let step = FRAC_PI_2 / DISTRIBUTION as f64;
        let mut points = vec![(0.0, 0.0)];
        for k in 0..DISTRIBUTION {
            let middle = (k as f64 + 0.5) * step;
            below += single.map_or_else(|| directions.density(middle) * middle.cos() * step, |_| step);
            points.push(((k + 1) as f64 * step, below));
        }
        let distribution = match single {
            Some(angle) => Polyline::new([(angle, 1.0)]),
            None => Polyline::new(points.into_iter().map(|(angle, part)| (angle, part / below))),
        };
        let fibre = &composite.fibre.fibre;
        let strength = fibre.strength.map(|strength| (strength * fibre.area(), fibre.rupture_f));
        Self { loads: loads.into_iter().flatten().collect(), angles, distribution, strength }
    }

    fn draw(&self, random: &mut Pcg64) -> Interpolation {
        let length = uniform(random) * LENGTHS as f64;
        let angle = self.distribution.first_reaching(uniform(random));
        let (i, t) = (length as usize, length.fract());
        let row = self.angles + 1;
        let (j, s) = if self.angles == 0 {
            (0, 0.0)
        } else {
            let place = (angle / FRAC_PI_2 * ANGLES as f64).min(ANGLES as f64 - 1e-9);
            (place as usize, place.fract())
        };
        let beside = usize::from(self.angles > 0);
        let at = |i: usize, j: usize| i * row + j;
        let corners = [
            (at(i, j), (1.0 - t) * (1.0 - s)),
            (at(i, j + beside), (1.0 - t) * s),
            (at(i + 1, j), t * (1.0 - s)),
            (at(i + 1, j + beside), t * s),
        ];
        Interpolation { corners, angle }
    }

    /// Adds a fibre's load to those of its strip, up to where it breaks.
    fn add(&self, Interpolation { corners, angle }: Interpolation, (bond, strength): (f64, f64), strip: &mut [f64]) {
        let [a, b, c, d] = corners.map(|(at, _)| &self.loads[at][..strip.len()]);
        let [p, q, r, s] = corners.map(|(_, weight)| bond * weight);
        let load = |k: usize| p * a[k] + q * b[k] + r * c[k] + s * d[k];
        match self.strength {
            None => (0..strip.len()).for_each(|k| strip[k] += load(k)),
            Some((mean, f)) => {
                let breaking = strength * mean * (-f * angle).exp();
                for (k, sum) in strip.iter_mut().enumerate() {
                    let load = load(k);
                    if load > breaking {
                        break;
                    }
                    *sum += load;
                }
            }
        }
    }
}

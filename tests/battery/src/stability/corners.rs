//! Admissible parameters of every law, far from ordinary ones, and a characteristic length.

use crate::Random;
use crate::samples::biaxial_damage as biaxial;
use std::f64::consts::PI;

/// PROPS and CELENT.
pub type Corner = (Vec<f64>, Option<f64>);

/// E over six decades, ν from −0.9 to 0.4999, 0 included.
fn elasticity(random: &mut Random) -> [f64; 2] {
    let poisson_ratio = match (random.unit() * 10.0) as u32 {
        0 => 0.0,
        1 | 2 => 0.4999,
        _ => -0.9 + 1.39 * random.unit(),
    };
    [10_f64.powf(6.0 * random.unit()), poisson_ratio]
}

/// A from 1e-4 to 1e20, B from 0.1 to 30, Y₀ from 1e-6 to 1 or 0.
fn damage_law(random: &mut Random) -> [f64; 3] {
    let threshold = if random.unit() < 0.3 { 0.0 } else { 10_f64.powf(-6.0 * random.unit()) };
    [10_f64.powf(24.0 * random.unit() - 4.0), 10_f64.powf(2.5 * random.unit() - 1.0), threshold]
}

fn pick(random: &mut Random, choices: &[f64]) -> f64 {
    choices[(random.unit() * choices.len() as f64) as usize]
}

pub fn linear(random: &mut Random) -> Corner {
    (elasticity(random).to_vec(), None)
}

pub fn pure(random: &mut Random) -> Corner {
    ([elasticity(random).as_slice(), &damage_law(random)].concat(), None)
}

/// α = 1: the closed criterion.
pub fn inelastic_closed(random: &mut Random) -> Corner {
    inelastic(random, 1.0)
}

/// α ≠ 1: the marched one.
pub fn inelastic_marched(random: &mut Random) -> Corner {
    let alpha = 0.1 + 3.0 * random.unit();
    inelastic(random, alpha)
}

fn inelastic(random: &mut Random, alpha: f64) -> Corner {
    let kappa = random.signed().signum() * 10_f64.powf(8.0 * random.unit() - 4.0);
    let kappa = if random.unit() < 0.2 { 0.0 } else { kappa };
    let rest = [kappa, alpha, (2.0 * random.unit()).floor()];
    ([elasticity(random).as_slice(), &damage_law(random), &rest].concat(), None)
}

pub fn reverse(random: &mut Random, variant: f64) -> Corner {
    let (tension, compression) = (damage_law(random), damage_law(random));
    ([elasticity(random).as_slice(), &tension, &compression, &[variant]].concat(), None)
}

pub fn biaxial(random: &mut Random) -> Corner {
    let tension = [pick(random, &[0.0, 1e-3, 7000.0, 1e18]), pick(random, &[0.05, 0.5, 1.1, 6.4, 40.0])];
    let compression = [pick(random, &[0.0, 29.0, 1e18]), pick(random, &[0.05, 0.94, 1.0, 6.4])];
    let thresholds = [pick(random, &[0.0, 1.9e-4, 3e-2]), pick(random, &[0.0, 3e-4])];
    let hydrostatic = [pick(random, &[0.0, 2.0, 1e18]), pick(random, &[0.0, 0.7, 1e3])];
    let choices = [pick(random, &biaxial::BETA), pick(random, &[biaxial::IMPLICIT, biaxial::LAGGED])];
    let props = [
        [31800.0, pick(random, &[0.0, 0.18, 0.2, 0.499, 0.499_999, -0.9])],
        tension,
        [thresholds[0], compression[0]],
        [compression[1], thresholds[1]],
        hydrostatic,
        choices,
    ];
    (props.concat(), None)
}

/// Any parameters of `concrete_damage`; with a band B > 1 in its branch and a length that is mostly small enough.
pub fn concrete(random: &mut Random, inelastic: bool, band: bool) -> Corner {
    let mut laws = [damage_law(random), damage_law(random)];
    let mut energies = [0.0; 2];
    if band {
        for (law, energy) in laws.iter_mut().zip(&mut energies) {
            law[1] = 1.0 + 5.0 * random.unit().powi(2) + 1e-3;
            *energy = pick(random, &[0.0, 1.0, 1.0]) * 10_f64.powf(4.0 * random.unit() - 2.0);
        }
    }
    let any = random.unit();
    let beta = pick(random, &[0.0, 0.17, 1.0, any]);
    let zeta_c = pick(random, &[0.0, 0.0, 1.0, 10.0]);
    let fractions =
        if inelastic { [pick(random, &[0.0, 0.3, 0.9, 0.999]), pick(random, &[0.0, 0.3, 0.9])] } else { [0.0; 2] };
    let length = band.then(|| 10_f64.powf(3.0 * random.unit() - 2.0));
    let shared = [beta, zeta_c];
    ([elasticity(random).as_slice(), &laws[0], &laws[1], &shared, &fractions, &energies].concat(), length)
}

/// Any parameters of `concrete_phase_field`, with a length that is mostly short enough.
pub fn phase_field(random: &mut Random) -> Corner {
    let [youngs_modulus, poisson_ratio] = elasticity(random);
    let band = youngs_modulus * (1.0 - poisson_ratio) / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio));
    let tensile_strength = youngs_modulus * 10_f64.powf(-6.0 + 3.0 * random.unit());
    let fracture_energy = 10_f64.powf(4.0 * random.unit() - 3.0);
    let [p, a_2, a_3] = [2.0 + 8.0 * random.unit().powi(2), -0.9 * random.unit(), 3.0 * random.unit()];
    let longest = 4.0 * band * fracture_energy / (PI * tensile_strength * tensile_strength * (a_2 + p + 0.5));
    let crack = [tensile_strength, fracture_energy, 1.1 * random.unit() * longest, p, a_2, a_3];
    let any = random.unit();
    let shared = [pick(random, &[0.0, 0.17, 1.0, any]), pick(random, &[0.0, 0.0, 1.0, 10.0])];
    ([&[youngs_modulus, poisson_ratio], crack.as_slice(), &damage_law(random), &shared].concat(), None)
}

pub fn mises(random: &mut Random) -> Corner {
    let mut props = elasticity(random).to_vec();
    let mut stress = props[0] * 10_f64.powf(-6.0 + 5.0 * random.unit());
    let mut peeq = 0.0;
    props.extend([stress, peeq]);
    for _ in 0..(random.unit() * 6.0) as usize {
        let softest = -0.9999 * 0.5 * props[0] / (1.0 - props[1]);
        let slope = if random.unit() < 0.5 { softest * random.unit() } else { 30.0 * props[0] * random.unit() };
        let step = 10_f64.powf(-6.0 + 4.0 * random.unit());
        // a table that would soften to nothing stops at half its stress
        let step = if stress + slope * step > 0.0 { step } else { -0.5 * stress / slope };
        stress += slope * step;
        peeq += step;
        props.extend([stress, peeq]);
    }
    (props, None)
}

pub fn cone(random: &mut Random) -> Corner {
    let friction = pick(random, &[0.0, 1e-9, 1e-3, 10.0, 35.0, 50.0, 60.0]);
    let dilation = friction * pick(random, &[0.0, 1e-6, 0.5, 1.0]);
    let [e, nu] = elasticity(random);
    let cohesion = e * 10_f64.powf(-6.0 + 5.0 * random.unit());
    (vec![e, nu, cohesion, friction, dilation, pick(random, &[0.0, 1.0, 2.0])], None)
}

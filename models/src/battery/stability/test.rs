//! Every law of a solid, thrown at.

use super::{Subject, check};
use crate::battery::{Random, Sample};
use crate::biaxial_damage::{BiaxialDamage, test as biaxial};
use crate::concrete_damage::{ConcreteDamage, test as concrete};
use crate::drucker_prager::{DruckerPrager, test as cone};
use crate::inelastic_damage::{InelasticDamage, test as inelastic};
use crate::j2_plasticity::{J2Plasticity, test as mises};
use crate::linear_elastic::LinearElastic;
use crate::pure_damage::{PureDamage, test as pure};
use crate::reverse_cyclic_damage::{ReverseCyclicDamage, test as reverse};

const BRANCHES: &[&str] = &["eta_t", "eta_c", "Y_t_max", "Y_c_max"];

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

#[test]
fn linear_elastic() {
    check::<LinearElastic>(&Subject {
        label: "",
        samples: vec![Sample::new(&[31800.0, 0.18], 1e-3)],
        corner: |random| (elasticity(random).to_vec(), None),
        monotone: &[],
        dissipative: true,
        continuous: true,
        steady: true,
    });
}

#[test]
fn pure_damage() {
    check::<PureDamage>(&Subject {
        label: "",
        samples: Sample::all(&pure::SETS),
        corner: |random| ([elasticity(random).as_slice(), &damage_law(random)].concat(), None),
        monotone: &["eta", "Y_max"],
        dissipative: true,
        continuous: true,
        steady: true,
    });
}

/// Both forms of λ: corners of the closed criterion (α = 1) and of the marched one.
fn inelastic_corner(random: &mut Random, alpha: f64) -> Vec<f64> {
    let kappa = random.signed().signum() * 10_f64.powf(8.0 * random.unit() - 4.0);
    let kappa = if random.unit() < 0.2 { 0.0 } else { kappa };
    let rest = [kappa, alpha, (2.0 * random.unit()).floor()];
    [elasticity(random).as_slice(), &damage_law(random), &rest].concat()
}

#[test]
fn inelastic_damage() {
    let subject = |label, samples, corner| Subject {
        label,
        samples,
        corner,
        monotone: &["eta"],
        dissipative: true,
        continuous: true,
        steady: true,
    };
    check::<InelasticDamage>(&subject("alpha = 1", Sample::all(&inelastic::CLOSED), |random| {
        (inelastic_corner(random, 1.0), None)
    }));
    check::<InelasticDamage>(&subject("alpha != 1", Sample::all(&inelastic::MARCHED), |random| {
        let alpha = 0.1 + 3.0 * random.unit();
        (inelastic_corner(random, alpha), None)
    }));
}

fn reverse_corner(random: &mut Random, variant: f64) -> (Vec<f64>, Option<f64>) {
    let (tension, compression) = (damage_law(random), damage_law(random));
    ([elasticity(random).as_slice(), &tension, &compression, &[variant]].concat(), None)
}

#[test]
fn reverse_cyclic_damage() {
    for (variant, label) in [(0.0, "thesis"), (1.0, "regular")] {
        check::<ReverseCyclicDamage>(&Subject {
            label,
            samples: Sample::all(&reverse::SETS).into_iter().filter(|s| s.props[8] == variant).collect(),
            corner: if variant == 0.0 {
                |random| reverse_corner(random, 0.0)
            } else {
                |random| reverse_corner(random, 1.0)
            },
            monotone: BRANCHES,
            dissipative: true,
            // models.md §5.1: the stress jumps where a principal strain changes its sign
            continuous: variant == 1.0,
            steady: true,
        });
    }
}

#[test]
fn biaxial_damage() {
    for (weights, label) in [(biaxial::IMPLICIT, "implicit"), (biaxial::LAGGED, "lagged")] {
        let sets = biaxial::BETA.map(|mode| (biaxial::props(mode, weights), 4e-4));
        check::<BiaxialDamage>(&Subject {
            label,
            samples: Sample::all(&sets),
            corner: |random| {
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
            },
            monotone: BRANCHES,
            // not hyperelastic, several branches (models.md §6)
            dissipative: false,
            continuous: false,
            // lagged weights are those of the stress before
            steady: weights == biaxial::IMPLICIT,
        });
    }
}

/// Any parameters of `concrete_damage`; with a band B > 1 in its branch and a length that is mostly small enough.
fn concrete_corner(random: &mut Random, inelastic: bool, band: bool) -> (Vec<f64>, Option<f64>) {
    let mut laws = [damage_law(random), damage_law(random)];
    let mut energies = [0.0; 2];
    if band {
        for (law, energy) in laws.iter_mut().zip(&mut energies) {
            law[1] = 1.0 + 5.0 * random.unit().powi(2) + 1e-3;
            *energy = pick(random, &[0.0, 1.0, 1.0]) * 10_f64.powf(4.0 * random.unit() - 2.0);
        }
    }
    let beta = pick(random, &[0.0, 0.17, 1.0, random.0 as f64 / u64::MAX as f64]);
    let zeta_c = pick(random, &[0.0, 0.0, 1.0, 10.0]);
    let fractions =
        if inelastic { [pick(random, &[0.0, 0.3, 0.9, 0.999]), pick(random, &[0.0, 0.3, 0.9])] } else { [0.0; 2] };
    let length = band.then(|| 10_f64.powf(3.0 * random.unit() - 2.0));
    let shared = [beta, zeta_c];
    ([elasticity(random).as_slice(), &laws[0], &laws[1], &shared, &fractions, &energies].concat(), length)
}

/// One form of `concrete_damage`: which of its test's variants, and corners.
fn concrete_form(label: &'static str, which: &[usize], corner: fn(&mut Random) -> (Vec<f64>, Option<f64>)) {
    let variants = concrete::variants();
    check::<ConcreteDamage>(&Subject {
        label,
        samples: which.iter().map(|&k| concrete::sample(&variants[k])).collect(),
        corner,
        monotone: BRANCHES,
        dissipative: true,
        continuous: true,
        steady: true,
    });
}

#[test]
fn concrete_damage() {
    concrete_form("IV-H", &[0, 2], |random| concrete_corner(random, false, false));
}

#[test]
fn concrete_damage_inelastic() {
    concrete_form("IV-HP", &[1], |random| concrete_corner(random, true, false));
}

#[test]
fn concrete_damage_crack_band() {
    concrete_form("IV-H, crack band", &[3], |random| concrete_corner(random, false, true));
}

#[test]
fn concrete_damage_inelastic_crack_band() {
    concrete_form("IV-HP, crack band", &[4], |random| concrete_corner(random, true, true));
}

#[test]
fn j2_plasticity() {
    check::<J2Plasticity>(&Subject {
        label: "",
        samples: mises::SETS.map(|props| Sample::new(props, 3e-3)).to_vec(),
        corner: |random| {
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
        },
        monotone: &["peeq"],
        dissipative: true,
        continuous: true,
        steady: true,
    });
}

#[test]
fn drucker_prager() {
    check::<DruckerPrager>(&Subject {
        label: "",
        samples: cone::SETS.each_ref().map(|props| Sample::new(props, 3e-3)).to_vec(),
        corner: |random| {
            let friction = pick(random, &[0.0, 1e-9, 1e-3, 10.0, 35.0, 50.0, 60.0]);
            let dilation = friction * pick(random, &[0.0, 1e-6, 0.5, 1.0]);
            let [e, nu] = elasticity(random);
            let cohesion = e * 10_f64.powf(-6.0 + 5.0 * random.unit());
            (vec![e, nu, cohesion, friction, dilation, pick(random, &[0.0, 1.0, 2.0])], None)
        },
        monotone: &["peeq"],
        dissipative: true,
        continuous: true,
        steady: true,
    });
}

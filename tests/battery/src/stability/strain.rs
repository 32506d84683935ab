//! The strains that are thrown.

use crate::{Random, rotated};
use umat_abi::law::StressState;

/// A strain, and a strain with exactly repeated principal values close by if that is what it tests.
pub struct Thrown {
    pub strain: [f64; 6],
    pub neighbour: Option<[f64; 6]>,
    /// Not placed where kinks are: at zero, at a committed strain, on an axis, at repeated values.
    pub generic: bool,
}

impl Thrown {
    /// The next strain of a history; `size` is about that of the peak.
    pub fn random(random: &mut Random, stress_state: StressState, committed: &[f64; 6], size: f64) -> Self {
        let decades = |random: &mut Random, from: f64, to: f64| 10_f64.powf(from + (to - from) * random.unit());
        let kind = (random.unit() * 18.0) as u32;
        let any = decades(random, -16.0, 1.0);
        let near = size * decades(random, -1.5, 2.0);
        let strain = match kind {
            0 => [0.0; 6],
            1 => *committed,
            2 => committed.map(|x| -x),
            3 => random.strain(stress_state, 1e-310),
            4 => with_subnormal(random, stress_state, near),
            5 => random.strain(stress_state, 1e3 * size),
            6 => {
                let change = random.strain(stress_state, 1e-12 * size);
                std::array::from_fn(|i| committed[i] + change[i])
            }
            7 | 8 => return repeated(random, stress_state, near),
            9 => axial(random, stress_state, near),
            10..=13 => random.strain(stress_state, any),
            _ => random.strain(stress_state, near),
        };
        Self { strain, neighbour: None, generic: kind == 5 || kind >= 10 }
    }
}

/// Some components subnormal or zero, the others not.
fn with_subnormal(random: &mut Random, stress_state: StressState, size: f64) -> [f64; 6] {
    let mut strain = random.strain(stress_state, size);
    for &i in stress_state.components() {
        match (random.unit() * 4.0) as u32 {
            0 => strain[i] = 1e-320 * random.signed().signum(),
            1 => strain[i] = 0.0,
            _ => {}
        }
    }
    strain
}

/// Along one axis, with free sides of a random Poisson ratio, fixed sides, or the same along the second axis.
fn axial(random: &mut Random, stress_state: StressState, size: f64) -> [f64; 6] {
    let axial = size * random.signed();
    let lateral = [0.0, -0.18 * axial, -0.5 * random.unit() * axial, axial][(random.unit() * 4.0) as usize];
    let third = if stress_state == StressState::PlaneStress { 0.0 } else { lateral };
    [axial, lateral, third, 0.0, 0.0, 0.0]
}

/// Two or three principal strains equal, and the same apart by one unit of the last digit or 1e-16 … 1e-4 of them,
/// half of them turned out of the axes.
fn repeated(random: &mut Random, stress_state: StressState, size: f64) -> Thrown {
    let (a, b) = (size * random.signed(), size * random.signed());
    let split = match (random.unit() * 4.0) as u32 {
        0 => a,
        1 => a.next_up(),
        _ => a * (1.0 + 10_f64.powf(-16.0 + 12.0 * random.unit())),
    };
    let solid = stress_state != StressState::PlaneStress;
    let (exact, apart) = match (random.unit() * 4.0) as u32 {
        0 if solid => ([a, b, a], [split, b, a]),
        1 if solid => ([a, a, a], [split, a, a]),
        _ if stress_state == StressState::ThreeD => ([a, a, b], [split, a, b]),
        _ => ([a, a, 0.0], [split, a, 0.0]),
    };
    let full = |e: [f64; 3]| [e[0], e[1], e[2], 0.0, 0.0, 0.0];
    let (mut strain, mut neighbour) = (full(apart), full(exact));
    if random.unit() < 0.5 {
        let rotation = random.rotation_in(stress_state);
        strain = rotated(&strain, &rotation, 2.0);
        neighbour = rotated(&neighbour, &rotation, 2.0);
    }
    Thrown { strain, neighbour: Some(neighbour), generic: false }
}

//! The strain paths on which laws are integrated, in any number of increments.

use std::f64::consts::PI;

/// Six components 11, 22, 33, 12, 13, 23: strains with engineering shear, or stresses in MPa.
pub(crate) type Components = [f64; 6];

/// A path of the strain in three dimensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Path {
    /// e11 grows, the sides follow as they do in elastic uniaxial stress.
    Tension,
    /// e11 decreases, the sides follow as they do in elastic uniaxial stress.
    Compression,
    /// The strain of elastic stresses −1 : −0.52 : 0 grows.
    Biaxial,
    /// Tension and compression in turn, each further than before; the sides at −0.18 and −0.15 of e11.
    Cyclic,
    /// All components at their own pace: principal directions rotate, maxima are passed between two increments.
    NonProportional,
}

/// Greatest strains that a law is taken to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// e11 in tension.
    pub tension: f64,
    /// −e11 in compression.
    pub compression: f64,
    /// Amplitude of the non-proportional path.
    pub general: f64,
    /// ν of the elastic sides.
    pub poisson_ratio: f64,
}

/// Straight pieces of the cyclic path: numbers of increments are multiples of it.
pub const LEGS: usize = 5;

impl Path {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Tension, Self::Compression, Self::Biaxial, Self::Cyclic, Self::NonProportional];

    /// Returns the name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tension => "uniaxial tension",
            Self::Compression => "uniaxial compression",
            Self::Biaxial => "biaxial −1/−0.52",
            Self::Cyclic => "reverse cyclic",
            Self::NonProportional => "non-proportional 3-D",
        }
    }

    /// Returns the name in file names.
    pub fn stem(self) -> &'static str {
        match self {
            Self::Tension => "tension",
            Self::Compression => "compression",
            Self::Biaxial => "biaxial",
            Self::Cyclic => "cyclic",
            Self::NonProportional => "non-proportional",
        }
    }

    /// Returns whether a function of the end strain and of maxima so far is met exactly in any number of increments:
    /// its maxima are at increments.
    pub fn is_met_by_any_increments(self) -> bool {
        self != Self::NonProportional
    }

    /// The strain after `i` of `n` increments: the same double for the same i/n.
    pub fn strain(self, extent: &Extent, i: usize, n: usize) -> Components {
        let t = i as f64 / n as f64;
        let nu = extent.poisson_ratio;
        match self {
            Self::Tension => along([1.0, -nu, -nu], extent.tension * t),
            Self::Compression => along([-1.0, nu, nu], extent.compression * t),
            Self::Biaxial => {
                let (first, second) = (-1.0, -0.52);
                let strains = [first - nu * second, second - nu * first, -nu * (first + second)];
                along(strains.map(|e| e / -strains[0]), extent.compression * t)
            }
            Self::Cyclic => along([1.0, -0.18, -0.15], self.cyclic(extent, i, n)),
            Self::NonProportional => {
                let phase = 3.0 * PI * t;
                let directions = [
                    phase.sin(),
                    -0.3 * (phase + 0.5).sin(),
                    0.2 * phase.cos(),
                    0.8 * (phase + 1.0).sin(),
                    -0.5 * (1.3 * phase).cos(),
                    0.4 * (0.7 * phase).sin(),
                ];
                directions.map(|e| extent.general * t * e)
            }
        }
    }

    /// e11 of the cyclic path: straight between corners, exact at them.
    fn cyclic(self, extent: &Extent, i: usize, n: usize) -> f64 {
        let corners = Self::corners(extent);
        let (leg, rest) = (i * LEGS / n, i * LEGS % n);
        let fraction = rest as f64 / n as f64;
        match corners.get(leg + 1) {
            Some(next) if rest > 0 => corners[leg] + fraction * (next - corners[leg]),
            _ => corners[leg],
        }
    }

    /// e11 at the corners of the cyclic path.
    pub fn corners(extent: &Extent) -> [f64; LEGS + 1] {
        let (tension, compression) = (extent.tension, extent.compression);
        [0.0, 0.6 * tension, -0.5 * compression, tension, -compression, 0.5 * tension]
    }

    /// The strains after each of `n` increments.
    pub fn strains(self, extent: &Extent, n: usize) -> Vec<Components> {
        (1..=n).map(|i| self.strain(extent, i, n)).collect()
    }
}

fn along(direction: [f64; 3], size: f64) -> Components {
    let [a, b, c] = direction.map(|e| size * e);
    [a, b, c, 0.0, 0.0, 0.0]
}

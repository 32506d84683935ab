//! Fibre concrete across a crack: σ(w) = σ_m(w) (1 − V_f) + σ_f(w − w_a).

use crate::interpolation::Polyline;
use crate::orientation::Directions;
use crate::{Average, BridgingFibre, Invalid, Orientation, averages};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// More is no concrete with short fibres.
const LARGEST_VOLUME_FRACTION: f64 = 0.2;
/// A matrix that softens is resolved by so many points up to where it is spent, narrower at the beginning.
const SOFTENING_POINTS: usize = 60;
/// Opening from which an exponential counts as spent, in G_f/f_t.
const SPENT: f64 = 12.0;

/// Decrease of the matrix's stress with the opening.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Softening {
    /// Falls to zero at once.
    #[default]
    None,
    /// f_t exp(−f_t w/G_f).
    Exponential,
    /// Hordijk (1991).
    Hordijk,
    /// 0.2 f_t at w = G_f/f_t, 0 at 5 G_f/f_t (fib Model Code 2010, 5.1.8.2).
    Bilinear,
}

/// The matrix of the composite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Matrix {
    /// Young's modulus, MPa.
    #[serde(rename = "E")]
    pub modulus: f64,
    /// Tensile strength, MPa.
    pub ft: f64,
    /// Softening beyond the tensile strength.
    #[serde(default)]
    pub softening: Softening,
    /// Fracture energy, N/mm.
    #[serde(rename = "Gf", default)]
    pub fracture_energy: f64,
    /// Compressive strength, MPa (default: compression stays elastic).
    #[serde(default)]
    pub fc: Option<f64>,
}

impl Matrix {
    /// Checks the numbers.
    ///
    /// # Errors
    /// A number without sense.
    pub fn check(&self) -> Result<(), Invalid> {
        let place = |name| format!("matrix.{name}");
        Invalid::unless_positive(self.modulus, place("E"))?;
        Invalid::unless_positive(self.ft, place("ft"))?;
        if self.softening != Softening::None {
            Invalid::unless_positive(self.fracture_energy, place("Gf"))?;
        }
        self.fc.map_or(Ok(()), |fc| Invalid::unless_positive(fc, place("fc")))
    }

    /// σ_m(w).
    pub fn stress(&self, opening: f64) -> f64 {
        let spent = opening * self.ft / self.fracture_energy;
        match self.softening {
            Softening::None => 0.0,
            Softening::Exponential => self.ft * (-spent).exp(),
            Softening::Hordijk => {
                let (c_1, c_2): (f64, f64) = (3.0, 6.93);
                let x = spent / 5.14;
                let falls = (1.0 + (c_1 * x).powi(3)) * (-c_2 * x).exp() - x * (1.0 + c_1.powi(3)) * (-c_2).exp();
                if x < 1.0 { self.ft * falls } else { 0.0 }
            }
            Softening::Bilinear => {
                let beyond = if spent <= 1.0 { 1.0 - 0.8 * spent } else { 0.05 * (5.0 - spent) };
                self.ft * beyond.max(0.0)
            }
        }
    }

    /// Openings that resolve the softening.
    fn openings(&self) -> Vec<f64> {
        let end = match self.softening {
            Softening::None => return Vec::new(),
            Softening::Exponential => SPENT,
            Softening::Hordijk => 5.14,
            Softening::Bilinear => 5.0,
        } * self.fracture_energy
            / self.ft;
        (0..=SOFTENING_POINTS).map(|k| end * (k as f64 / SOFTENING_POINTS as f64).powi(2)).collect()
    }

    /// The sum of this part of σ_m and a law whose first opening is 0.
    pub(crate) fn added_to(&self, law: &Polyline, part: f64) -> Polyline {
        self.together_with(law, |fibres, matrix| fibres + part * matrix)
    }

    /// The law that takes over as the matrix softens: σ_m + (1 − σ_m/f_t) σ. A crack begins with f_t.
    pub(crate) fn relieved_by(&self, law: &Polyline) -> Polyline {
        self.together_with(law, |fibres, matrix| matrix + (1.0 - matrix / self.ft) * fibres)
    }

    /// What a law, whose first opening is 0, and σ_m give together.
    fn together_with(&self, law: &Polyline, sum: impl Fn(f64, f64) -> f64) -> Polyline {
        let mut openings: Vec<f64> = law.points().map(|point| point.0).chain(self.openings()).collect();
        openings.sort_by(f64::total_cmp);
        Polyline::new(openings.into_iter().map(|w| (w, sum(law.at(w), self.stress(w)))))
    }
}

/// Fibres in a matrix.
#[derive(Clone, Debug)]
pub struct Composite {
    /// One fibre.
    pub fibre: BridgingFibre,
    /// V_f.
    pub volume_fraction: f64,
    /// Directions of the fibres.
    pub directions: Directions,
    /// Directions of the fibres, with panels that end at the bins of shares.
    pub(crate) binned: Directions,
    /// The matrix.
    pub matrix: Matrix,
    /// w_a, mm: the opening at which fibres begin to carry.
    pub activation: f64,
    /// Whether averages are as close as those of tables: 3e-4.
    pub(crate) rough: bool,
}

impl Composite {
    /// Puts it together.
    ///
    /// # Errors
    /// Numbers without sense.
    pub fn new(
        fibre: BridgingFibre,
        volume_fraction: f64,
        orientation: &Orientation,
        matrix: Matrix,
        activation: f64,
    ) -> Result<Self, Invalid> {
        let sound = volume_fraction > 0.0 && volume_fraction <= LARGEST_VOLUME_FRACTION;
        Invalid::unless(sound, "volume_fraction".into(), "must be above 0 and not above 0.2")?;
        Invalid::if_negative(activation, "activation".into())?;
        matrix.check()?;
        let mut breaks = fibre.angles();
        let directions = orientation.directions(fibre.fibre.length, &breaks)?;
        breaks.extend(Self::bin_edges());
        let binned = orientation.directions(fibre.fibre.length, &breaks)?;
        Ok(Self { fibre, volume_fraction, directions, binned, matrix, activation, rough: false })
    }

    /// Fibres through a unit of area, 1/mm²: η V_f/A_f.
    pub fn fibres_per_area(&self) -> f64 {
        self.directions.efficiency * self.volume_fraction / self.fibre.fibre.area()
    }

    /// σ_m (1 − V_f).
    pub fn matrix_stress(&self, opening: f64) -> f64 {
        self.matrix.stress(opening) * (1.0 - self.volume_fraction)
    }

    /// σ(w) from σ_f at rising openings, the first 0, with openings in between that resolve the matrix.
    pub fn law(&self, fibres: &[Average]) -> Polyline {
        let bridging = Polyline::new(fibres.iter().map(|average| (average.opening, average.stress)));
        self.with_matrix(&bridging)
    }

    /// σ_f(w) and the matrix.
    pub(crate) fn with_matrix(&self, bridging: &Polyline) -> Polyline {
        self.matrix.added_to(bridging, 1.0 - self.volume_fraction)
    }

    /// Returns the composite with averages as close as those of tables, 3e-4, in place of rounding: for pictures and searches.
    pub fn roughly(&self) -> Self {
        Self { rough: true, ..self.clone() }
    }

    /// σ(w) at openings from 0 to `end`, narrower at the beginning.
    pub fn law_to(&self, end: f64, points: usize) -> Polyline {
        let openings: Vec<f64> = (0..points).map(|k| end * (k as f64 / (points - 1) as f64).powi(2)).collect();
        self.law(&averages(self, &openings))
    }
}

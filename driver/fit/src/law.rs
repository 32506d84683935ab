//! Bond laws as the fit moves them: in coordinates that may be any numbers and still make a law.
//!
//! Powers (6.24), by their peak, where the curve says most, and shapes around it:
//!
//! ```text
//! ln τ_p,  ln g_p,  ln(k_e g_p/τ_p − 1),  ln(b₁/(1 − b₁)),  ln(−b₂)
//! ```
//!
//! so that 0 < g_crit < g_p, 0 < b₁ < 1 and b₂ < 0 hold of themselves. Piecewise (6.23), by secant stiffnesses
//! k_i = τ_i/g_i, which must fall, and joints between 0 and the greatest slip g_N, which stays:
//!
//! ```text
//! ln k_1,  ln(ln(k_{i−1}/k_i)) for i = 2 … N,  ln(x/(1 − x)) with x = g_i/g_{i+1} for i = 1 … N−1
//! ```

use models::bond_slip::Envelope;
use serde_json::{Map, Value, json};
use umat_abi::law::ConfigurationError;

/// Coordinates of ratios and shapes stay within ± this: beyond, nothing changes but rounding.
const LARGEST_SHAPE: f64 = 12.0;

/// k_e s, a₁ s^b₁, a₂ s^b₂.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Powers {
    /// k_e, MPa/mm.
    pub elastic_stiffness: f64,
    /// a₁, b₁.
    pub rise: [f64; 2],
    /// a₂, b₂.
    pub fall: [f64; 2],
}

/// Straight lines from (0, 0) through points; k_e is the slope of the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise {
    /// Slip, mm, and traction, MPa.
    pub points: Vec<[f64; 2]>,
}

/// A bond law.
#[derive(Clone, Debug, PartialEq)]
pub enum BondSlipLaw {
    /// 6.24.
    Powers(Powers),
    /// 6.23.
    Piecewise(Piecewise),
}

/// A number of a law as its user knows it.
#[derive(Clone, Debug, PartialEq)]
pub struct LawQuantity {
    /// Name: that of the plugin's parameter, if it is one.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
}

impl BondSlipLaw {
    /// Returns what messages and files call the form; the plugin's word for it.
    pub fn form(&self) -> &'static str {
        match self {
            Self::Powers(_) => "powers",
            Self::Piecewise(_) => "piecewise",
        }
    }

    /// Returns where it is in the space that the fit moves in.
    pub fn coordinates(&self) -> Vec<f64> {
        let shape = |coordinate: f64| coordinate.clamp(-LARGEST_SHAPE, LARGEST_SHAPE);
        match self {
            Self::Powers(law) => {
                let [[a_1, b_1], [a_2, b_2]] = [law.rise, law.fall];
                let peak_slip = (a_2 / a_1).powf(1.0 / (b_1 - b_2));
                let peak = a_1 * peak_slip.powf(b_1);
                // a start from a regression may miss the rule that k_e g_p > τ_p
                let stiffness = (law.elastic_stiffness * peak_slip / peak - 1.0).max(0.0);
                let shapes = [stiffness.ln(), (b_1 / (1.0 - b_1)).ln(), (-b_2).ln()];
                [peak.ln(), peak_slip.ln()].into_iter().chain(shapes.map(shape)).collect()
            }
            Self::Piecewise(law) => {
                let secant = |[slip, traction]: [f64; 2]| traction / slip;
                let falls = law.points.windows(2).map(|pair| (secant(pair[0]) / secant(pair[1])).ln().ln());
                let places = law.points.windows(2).map(|pair| (pair[0][0] / (pair[1][0] - pair[0][0])).ln());
                let first = law.points.first().map(|point| secant(*point).ln());
                first.into_iter().chain(falls.chain(places).map(shape)).collect()
            }
        }
    }

    /// The law of the same form at these coordinates.
    pub fn at(&self, coordinates: &[f64]) -> Self {
        let shape = |coordinate: f64| coordinate.clamp(-LARGEST_SHAPE, LARGEST_SHAPE);
        match (self, coordinates) {
            (Self::Powers(_), &[peak, peak_slip, stiffness, rise, fall]) => {
                let [peak, peak_slip, stiffness] = [peak.exp(), peak_slip.exp(), shape(stiffness).exp()];
                let (b_1, b_2) = (logistic(shape(rise)), -shape(fall).exp());
                Self::Powers(Powers {
                    elastic_stiffness: peak / peak_slip * (1.0 + stiffness),
                    rise: [peak / peak_slip.powf(b_1), b_1],
                    fall: [peak / peak_slip.powf(b_2), b_2],
                })
            }
            (Self::Powers(law), _) => Self::Powers(*law),
            (Self::Piecewise(law), _) => {
                let count = law.points.len();
                let mut points = law.points.clone();
                for k in (0..count - 1).rev() {
                    points[k][0] = points[k + 1][0] * logistic(shape(coordinates[count + k]));
                }
                let mut logarithm = coordinates[0];
                for (k, point) in points.iter_mut().enumerate() {
                    if k > 0 {
                        logarithm -= shape(coordinates[k]).exp();
                    }
                    point[1] = logarithm.exp() * point[0];
                }
                Self::Piecewise(Piecewise { points })
            }
        }
    }

    /// Returns the numbers, the joints included.
    pub fn quantities(&self) -> Vec<LawQuantity> {
        let quantity = |name: &str, unit, value| LawQuantity { name: name.to_owned(), unit, value };
        match self {
            Self::Powers(law) => {
                let [[a_1, b_1], [a_2, b_2]] = [law.rise, law.fall];
                let parameters = [
                    quantity("k_e", "MPa/mm", law.elastic_stiffness),
                    quantity("a_1", "MPa/mm^b_1", a_1),
                    quantity("b_1", "-", b_1),
                    quantity("a_2", "MPa/mm^b_2", a_2),
                    quantity("b_2", "-", b_2),
                ];
                let joints = Envelope::powers(law.elastic_stiffness, law.rise, law.fall, 0.0).into_iter();
                let joints = joints.flat_map(|envelope| {
                    let [critical, peak] = [envelope.critical_slip, envelope.peak_slip];
                    [
                        quantity("g_crit", "mm", critical),
                        quantity("tau_crit", "MPa", envelope.strength(critical).traction),
                        quantity("g_peak", "mm", peak),
                        quantity("tau_peak", "MPa", envelope.strength(peak).traction),
                    ]
                });
                parameters.into_iter().chain(joints).collect()
            }
            Self::Piecewise(law) => {
                let points = law.points.iter().zip(1..).flat_map(|([slip, traction], k)| {
                    [quantity(&format!("g_{k}"), "mm", *slip), quantity(&format!("tau_{k}"), "MPa", *traction)]
                });
                std::iter::once(quantity("k_e", "MPa/mm", law.elastic_stiffness())).chain(points).collect()
            }
        }
    }

    /// Returns the parameters as the plugin's props name them.
    pub fn props(&self) -> Map<String, Value> {
        let props = match self {
            Self::Powers(Powers { elastic_stiffness, rise: [a_1, b_1], fall: [a_2, b_2] }) => {
                json!({ "k_e": elastic_stiffness, "a_1": a_1, "b_1": b_1, "a_2": a_2, "b_2": b_2 })
            }
            Self::Piecewise(law) => json!({ "k_e": law.elastic_stiffness(), "points": law.points }),
        };
        let form = [("law".to_owned(), json!("A")), ("form".to_owned(), json!(self.form()))];
        form.into_iter().chain(props.as_object().cloned().unwrap_or_default()).collect()
    }

    /// Tractions at slips, for pictures.
    ///
    /// # Errors
    /// Reason why the plugin would not accept the law.
    pub fn tractions(&self, slips: &[f64], residual: f64) -> Result<Vec<f64>, ConfigurationError> {
        let envelope = match self {
            Self::Powers(law) => Envelope::powers(law.elastic_stiffness, law.rise, law.fall, residual)?,
            Self::Piecewise(law) => Envelope::piecewise(law.elastic_stiffness(), &law.points, residual)?,
        };
        Ok(slips.iter().map(|&slip| envelope.strength(slip).traction).collect())
    }
}

impl Piecewise {
    /// k_e, MPa/mm.
    pub fn elastic_stiffness(&self) -> f64 {
        self.points.first().map_or(0.0, |[slip, traction]| traction / slip)
    }
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

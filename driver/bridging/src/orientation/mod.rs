//! Directions of fibres in the volume: the density p(θ) of the angle from the crack's normal, ∫ p dθ = 1.

mod bingham;
mod walls;

pub use walls::{Faces, wall_zones};

use crate::Invalid;
use crate::quadrature::{DEGREES, root, rule};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use statrs::distribution::{Continuous, ContinuousCDF, Normal};
use statrs::function::beta::beta;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Orientation of the fibres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Orientation {
    /// Random in space.
    Random3d,
    /// Random in a plane perpendicular to the crack.
    Planar,
    /// Normal distribution between 0 and 90°; spread 0: all at the mean.
    Aligned {
        /// Degrees.
        mean_deg: f64,
        /// Degrees.
        spread_deg: f64,
    },
    /// p ∝ (sin θ)^(2r − 1) (cos θ)^(2q − 1): sin² θ is beta-distributed.
    Beta {
        /// r ≥ ½.
        r: f64,
        /// q ≥ ½.
        q: f64,
    },
    /// Maximum entropy on the sphere with the orientation tensor a (Bingham).
    Tensor {
        /// a, trace 1.
        a: [[f64; 3]; 3],
        /// Normal of the crack.
        #[serde(default = "first_axis")]
        normal: [f64; 3],
    },
    /// Histogram of counted directions: edges and counts, or a file.
    Histogram {
        /// Edges of the bins, degrees.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        edges_deg: Vec<f64>,
        /// Number of fibres in each bin, counted in the volume.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        counts: Vec<f64>,
        /// CSV file, relative to the case file, with the columns from_deg, to_deg and count. Each row is a bin, which
        /// begins where the one before it ends.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        file: Option<String>,
    },
    /// The normal distribution between 0 and 90° with a given η.
    Number {
        /// η = ∫ p cos θ dθ.
        eta: f64,
        /// Degrees.
        #[serde(default = "usual_spread")]
        spread_deg: f64,
    },
    /// Random in space between the walls of a mould.
    Section {
        /// Width and height, mm.
        size: [f64; 2],
        /// Number of walls that bound the width and the height.
        faces: Faces,
    },
}

fn first_axis() -> [f64; 3] {
    [1.0, 0.0, 0.0]
}

fn usual_spread() -> f64 {
    20.0
}

#[derive(Clone, Debug)]
enum Density {
    Random,
    Planar,
    /// Truncated normal distribution, with the part of it that is kept.
    Normal(Normal, f64),
    Beta {
        r: f64,
        q: f64,
        scale: f64,
    },
    /// Density at equal distances over [0, π/2].
    Sampled(Vec<f64>),
    Steps {
        edges: Vec<f64>,
        heights: Vec<f64>,
    },
}

impl Density {
    fn at(&self, angle: f64) -> f64 {
        match self {
            Self::Random => angle.sin(),
            Self::Planar => FRAC_2_PI,
            Self::Normal(normal, mass) => normal.pdf(angle) / mass,
            Self::Beta { r, q, scale } => {
                scale * angle.sin().powf(2.0 * r - 1.0) * angle.cos().max(0.0).powf(2.0 * q - 1.0)
            }
            Self::Sampled(values) => sampled(values, angle),
            Self::Steps { edges, heights } => {
                let right = edges.partition_point(|&edge| edge <= angle);
                if right == 0 { 0.0 } else { heights.get(right - 1).copied().unwrap_or(0.0) }
            }
        }
    }
}

/// The cubic through four neighbours.
fn sampled(values: &[f64], angle: f64) -> f64 {
    let place = angle / FRAC_PI_2 * (values.len() - 1) as f64;
    let first = (place.floor() as usize).saturating_sub(1).min(values.len() - 4);
    let t = place - first as f64;
    let [y_0, y_1, y_2, y_3] = [0, 1, 2, 3].map(|k| values[first + k]);
    let (a, b, c, d) = (t, t - 1.0, t - 2.0, t - 3.0);
    -b * c * d * y_0 / 6.0 + a * c * d * y_1 / 2.0 - a * b * d * y_2 / 2.0 + a * b * c * y_3 / 6.0
}

/// p(θ) with where it is smooth.
#[derive(Clone, Debug)]
pub struct Directions {
    density: Density,
    /// All fibres at this angle.
    single: Option<f64>,
    /// Ends of the panels on which p is smooth.
    pub(crate) panels: Vec<f64>,
    /// Nodes by degree of the rule and panel: (θ, weight p dθ).
    nodes: Vec<Vec<Vec<(f64, f64)>>>,
    /// The same times cos θ: the part of the fibres that cross.
    crossing: Vec<Vec<Vec<(f64, f64)>>>,
    /// η = ∫ p cos θ dθ.
    pub efficiency: f64,
}

/// Standard deviations from the mean at which panels of a normal distribution end.
const DEVIATIONS: [f64; 9] = [-8.0, -5.0, -3.0, -1.5, 0.0, 1.5, 3.0, 5.0, 8.0];
/// Grading of panels towards an end: ratio of successive ends, and the exponent before which they stop.
const GRADING: (f64, i32) = (0.25, 12);
/// The panels of a tensor's density.
const TENSOR_PANELS: usize = 12;
/// Panels of a section's.
const SECTION_PANELS: usize = 8;
/// Least spread of a normal distribution.
const LEAST_SPREAD_DEG: f64 = 0.1;
/// Tolerance on the orientation number η.
const EFFICIENCY_ROUNDING: f64 = 1e-12;

impl Orientation {
    /// Returns p(θ), with all integrals over it prepared. `breaks` are angles at which loads have kinks.
    ///
    /// # Errors
    /// Parameters outside their admissible range.
    pub fn directions(&self, fibre_length: f64, breaks: &[f64]) -> Result<Directions, Invalid> {
        let place = |name: &str| format!("orientation.{name}");
        match self {
            Self::Random3d => Ok(Directions::new(Density::Random, &[], breaks)),
            Self::Planar => Ok(Directions::new(Density::Planar, &[], breaks)),
            Self::Aligned { mean_deg, spread_deg } => {
                let within = (0.0..=90.0).contains(mean_deg);
                Invalid::unless(within, place("mean_deg"), "must lie between 0 and 90 degrees")?;
                let wide = *spread_deg == 0.0 || (LEAST_SPREAD_DEG..=90.0).contains(spread_deg);
                Invalid::unless(wide, place("spread_deg"), "must be 0, or between 0.1 and 90 degrees")?;
                Ok(if *spread_deg == 0.0 {
                    Directions::single(mean_deg.to_radians())
                } else {
                    normal(mean_deg.to_radians(), spread_deg.to_radians(), breaks)
                })
            }
            Self::Beta { r, q } => {
                for (value, name) in [(r, "r"), (q, "q")] {
                    let rule = "must be ½ or more: p would have no bound";
                    Invalid::unless(*value >= 0.5 && *value <= 1e3, place(name), rule)?;
                }
                let graded: Vec<f64> = (1..GRADING.1).map(|k| GRADING.0.powi(k)).collect();
                let ends = graded.iter().flat_map(|part| [part * FRAC_PI_2, (1.0 - part) * FRAC_PI_2]);
                let density = Density::Beta { r: *r, q: *q, scale: 2.0 / beta(*r, *q) };
                Ok(Directions::new(density, &ends.collect::<Vec<_>>(), breaks))
            }
            Self::Tensor { a, normal } => {
                let density = Density::Sampled(bingham::marginal(a, normal)?);
                Ok(Directions::new(density, &even(TENSOR_PANELS), breaks))
            }
            Self::Histogram { edges_deg, counts, .. } => histogram(edges_deg, counts, breaks),
            Self::Number { eta, spread_deg } => {
                let wide = (LEAST_SPREAD_DEG..=90.0).contains(spread_deg);
                Invalid::unless(wide, place("spread_deg"), "must lie between 0.1 and 90 degrees")?;
                let of = |mean: f64| normal(mean, spread_deg.to_radians(), &[]).efficiency;
                let (greatest, least) = (of(0.0), of(FRAC_PI_2));
                let rule = format!("must lie between {least:.3} and {greatest:.3} at this spread");
                Invalid::unless((least..=greatest).contains(eta), place("eta"), &rule)?;
                let mean = root(|mean| of(mean) - eta, 0.0, FRAC_PI_2);
                Ok(normal(mean, spread_deg.to_radians(), breaks))
            }
            Self::Section { size, faces } => {
                let parts = walls::zone_parts(*size, faces, fibre_length)?;
                let mut directions =
                    Directions::new(Density::Sampled(walls::density(parts)), &even(SECTION_PANELS), breaks);
                directions.normalise();
                Ok(directions)
            }
        }
    }
}

fn even(count: usize) -> Vec<f64> {
    (1..count).map(|k| FRAC_PI_2 * k as f64 / count as f64).collect()
}

fn normal(mean: f64, spread: f64, breaks: &[f64]) -> Directions {
    let distribution = Normal::new(mean, spread).expect("the spread is above 0");
    let mass = distribution.cdf(FRAC_PI_2) - distribution.cdf(0.0);
    let ends: Vec<f64> = DEVIATIONS.iter().map(|deviation| mean + deviation * spread).collect();
    Directions::new(Density::Normal(distribution, mass), &ends, breaks)
}

fn histogram(edges_deg: &[f64], counts: &[f64], breaks: &[f64]) -> Result<Directions, Invalid> {
    let place = |name: &str| format!("orientation.{name}");
    let paired = !counts.is_empty() && edges_deg.len() == counts.len() + 1;
    Invalid::unless(paired, place("edges_deg"), "must be one more than counts")?;
    let rising = edges_deg.windows(2).all(|pair| pair[1] > pair[0]);
    let within = edges_deg.iter().all(|edge| (0.0..=90.0).contains(edge));
    Invalid::unless(rising && within, place("edges_deg"), "must rise between 0 and 90 degrees")?;
    let total: f64 = counts.iter().sum();
    let counted = counts.iter().all(|count| *count >= 0.0) && total > 0.0 && total.is_finite();
    Invalid::unless(counted, place("counts"), "must not be below 0, nor all 0")?;
    let edges: Vec<f64> = edges_deg.iter().map(|edge| edge.to_radians()).collect();
    let heights = counts.iter().zip(edges.windows(2)).map(|(count, edge)| count / total / (edge[1] - edge[0]));
    let density = Density::Steps { heights: heights.collect(), edges: edges.clone() };
    Ok(Directions::new(density, &edges, breaks))
}

/// Nodes with weights times cos θ.
fn crossing(nodes: &[Vec<Vec<(f64, f64)>>]) -> Vec<Vec<Vec<(f64, f64)>>> {
    let times = |&(angle, weight): &(f64, f64)| (angle, weight * angle.cos());
    let of_panel = |panel: &Vec<(f64, f64)>| panel.iter().map(times).collect();
    nodes.iter().map(|panels| panels.iter().map(of_panel).collect()).collect()
}

impl Directions {
    fn new(density: Density, ends: &[f64], breaks: &[f64]) -> Self {
        let inside = ends.iter().chain(breaks).copied().filter(|end| *end > 0.0 && *end < FRAC_PI_2);
        let mut panels: Vec<f64> = [0.0, FRAC_PI_2].into_iter().chain(inside).collect();
        panels.sort_by(f64::total_cmp);
        panels.dedup();
        let mut directions =
            Self { density, single: None, panels, nodes: Vec::new(), crossing: Vec::new(), efficiency: 0.0 };
        directions.nodes = (0..DEGREES.len())
            .map(|level| {
                let ends = directions.panels.windows(2);
                ends.map(|ends| directions.nodes_of(level, ends[0], ends[1])).collect()
            })
            .collect();
        directions.crossing = crossing(&directions.nodes);
        directions.efficiency = directions.converged(|angle| angle.cos());
        directions
    }

    fn single(angle: f64) -> Self {
        let nodes = vec![vec![vec![(angle, 1.0)]]; DEGREES.len()];
        let panels = vec![0.0, FRAC_PI_2];
        let crossing = crossing(&nodes);
        Self { density: Density::Random, single: Some(angle), panels, nodes, crossing, efficiency: angle.cos() }
    }

    /// p(θ); infinite where all fibres lie.
    pub fn density(&self, angle: f64) -> f64 {
        match self.single {
            Some(single) if angle == single => f64::INFINITY,
            Some(_) => 0.0,
            None => self.density.at(angle),
        }
    }

    /// Divides by ∫ p dθ where that is known numerically only.
    fn normalise(&mut self) {
        let mass = self.converged(|_| 1.0);
        if let Density::Sampled(values) = &mut self.density {
            values.iter_mut().for_each(|value| *value /= mass);
        }
        let nodes = self.nodes.iter_mut().chain(&mut self.crossing);
        nodes.flatten().flatten().for_each(|node| node.1 /= mass);
        self.efficiency /= mass;
    }

    /// ∫ f p dθ by the first rule that the next one confirms.
    pub fn converged(&self, f: impl Fn(f64) -> f64) -> f64 {
        let by =
            |level: usize| self.nodes[level].iter().flatten().map(|(angle, weight)| weight * f(*angle)).sum::<f64>();
        let mut value = by(1);
        for level in 2..DEGREES.len() {
            let finer = by(level);
            let agrees = (finer - value).abs() <= EFFICIENCY_ROUNDING * finer.abs();
            value = finer;
            if agrees {
                break;
            }
        }
        value
    }

    /// Returns whether all fibres are at one angle.
    pub(crate) fn is_single(&self) -> bool {
        self.single.is_some()
    }

    /// (θ, weight p dθ) of a panel.
    pub(crate) fn nodes(&self, level: usize, panel: usize) -> &[(f64, f64)] {
        &self.nodes[level][panel]
    }

    /// (θ, weight p cos θ dθ) of a panel.
    pub(crate) fn crossing(&self, level: usize, panel: usize) -> &[(f64, f64)] {
        &self.crossing[level][panel]
    }

    /// (θ, weight p dθ) of a whole panel. A sampled density is no polynomial of low degree there, what is integrated over it nearly is:
    /// weights are the integrals of p times the polynomials that are 1 at one node and 0 at the others.
    fn nodes_of(&self, level: usize, from: f64, to: f64) -> Vec<(f64, f64)> {
        let Density::Sampled(values) = &self.density else { return self.nodes_between(level, from, to).collect() };
        let intervals = values.len() - 1;
        let nodes = rule(level);
        let inverse = |j: usize| {
            let others = nodes.iter().enumerate().filter(|(k, _)| *k != j);
            // times 4, the inverse of the capacity of the unit interval: products of 48 stay in range
            1.0 / others.map(|(_, other)| 4.0 * (nodes[j].0 - other.0)).product::<f64>()
        };
        let scales: Vec<f64> = (0..nodes.len()).map(inverse).collect();
        let mut weights = vec![0.0; nodes.len()];
        let place = |angle: f64| angle / FRAC_PI_2 * intervals as f64;
        let samples = place(from).floor() as usize + 1..place(to).ceil() as usize;
        let inside =
            samples.map(|k| FRAC_PI_2 * k as f64 / intervals as f64).filter(|angle| *angle > from && *angle < to);
        let ends: Vec<f64> = [from].into_iter().chain(inside).chain([to]).collect();
        for pair in ends.windows(2) {
            for (angle, mass) in self.nodes_between(0, pair[0], pair[1]) {
                let at = (angle - from) / (to - from);
                if let Some(j) = nodes.iter().position(|(node, _)| *node == at) {
                    weights[j] += mass;
                    continue;
                }
                // of Lagrange's polynomials in barycentric form
                let quotients: Vec<f64> =
                    nodes.iter().zip(&scales).map(|((node, _), scale)| scale / (at - node)).collect();
                let share = mass / quotients.iter().sum::<f64>();
                weights.iter_mut().zip(&quotients).for_each(|(weight, quotient)| *weight += share * quotient);
            }
        }
        nodes.iter().zip(weights).map(|((node, _), weight)| (from + (to - from) * node, weight)).collect()
    }

    /// (θ, weight p dθ) of a part of a panel.
    pub(crate) fn nodes_between(&self, level: usize, from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        rule(level).iter().map(move |(node, weight)| {
            let angle = from + (to - from) * node;
            (angle, weight * (to - from) * self.density.at(angle))
        })
    }
}

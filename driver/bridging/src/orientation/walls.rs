//! Walls: a fibre whose middle is nearer to a wall than L_f/2 cannot lie across it.
//!
//! ```text
//! all directions are alike but those that the wall forbids:  |p·m| ≤ ζ = z/(L_f/2), m the wall's normal
//! one wall, mean over 0 < ζ < 1:  p(θ) = sin θ ln(2/sin θ),  η = ½ ln 2 + ¼ = 0.5966
//! ```
//!
//! which is the 0.60 of Dupont and Vandewalle (2005).

use crate::Invalid;
use crate::quadrature::integral;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, LN_2};
use std::sync::LazyLock;

/// η without walls, near one, near two (Dupont, Vandewalle 2005).
const EFFICIENCIES: [f64; 3] = [0.5, 0.6, 0.84];
/// Intervals of the density over the quarter circle.
const SAMPLES: usize = 512;
/// Panels over the distance from either wall of a corner.
const CORNER_PANELS: usize = 4;
const CORNER_LEVEL: usize = 1;

/// Number of walls, 0 to 2, that bound the width and the height of a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Faces {
    /// Across the width.
    pub width: u8,
    /// Across the height.
    pub height: u8,
}

/// Parts of the section without walls within L_f/2, with one, and with two.
pub fn zone_parts(size: [f64; 2], faces: &Faces, fibre_length: f64) -> Result<[f64; 3], Invalid> {
    let part = |size: f64, count: u8, name: &str| {
        let place = format!("orientation.size[{}]", usize::from(name == "height"));
        Invalid::unless(count <= 2, format!("orientation.faces.{name}"), "must be 0, 1 or 2")?;
        let part = 0.5 * f64::from(count) * fibre_length / size;
        let rule = "must be at least the length of a fibre between two walls, and half of it at one wall";
        Invalid::unless(size > 0.0 && part <= 1.0, place, rule)?;
        Ok(part)
    };
    let (x, y) = (part(size[0], faces.width, "width")?, part(size[1], faces.height, "height")?);
    Ok([(1.0 - x) * (1.0 - y), x * (1.0 - y) + y * (1.0 - x), x * y])
}

/// η of a section by the three zones of Dupont and Vandewalle.
///
/// # Errors
/// A section that is smaller than the fibre.
pub fn wall_zones(size: [f64; 2], faces: &Faces, fibre_length: f64) -> Result<f64, Invalid> {
    let parts = zone_parts(size, faces, fibre_length)?;
    Ok(parts.iter().zip(EFFICIENCIES).map(|(part, efficiency)| part * efficiency).sum())
}

/// p(θ) of a section at equal distances over [0, π/2]; its integral is 1 to the accuracy of the corner's part.
pub fn density(parts: [f64; 3]) -> Vec<f64> {
    let at = |angle: f64| {
        let sine = angle.sin();
        if sine == 0.0 {
            return 0.0;
        }
        sine * (parts[0] + parts[1] * (LN_2 - sine.ln()))
    };
    let mut values: Vec<f64> = (0..=SAMPLES).map(|k| at(FRAC_PI_2 * k as f64 / SAMPLES as f64)).collect();
    if parts[2] > 0.0 {
        // the same for all sections, and not made at once
        static CORNER: LazyLock<Vec<f64>> = LazyLock::new(corner);
        values.iter_mut().zip(CORNER.iter()).for_each(|(value, corner)| *value += parts[2] * corner);
    }
    values
}

/// p(θ) between two walls at right angles, the mean over both distances: |p_y| ≤ ζ_1, |p_z| ≤ ζ_2.
fn corner() -> Vec<f64> {
    let mut values = vec![0.0; SAMPLES + 1];
    let sines: Vec<f64> = (0..=SAMPLES).map(|k| (FRAC_PI_2 * k as f64 / SAMPLES as f64).sin()).collect();
    let panels = CORNER_PANELS as f64;
    for (i, j) in (0..CORNER_PANELS).flat_map(|i| (0..CORNER_PANELS).map(move |j| (i, j))) {
        for (u, weight_u) in crate::quadrature::rule(CORNER_LEVEL) {
            for (v, weight_v) in crate::quadrature::rule(CORNER_LEVEL) {
                // squares of the unit interval: the density is singular at the walls
                let (a, b) = ((i as f64 + u) / panels, (j as f64 + v) / panels);
                let (near, far) = (a * a, b * b);
                let weight = 4.0 * a * b * weight_u * weight_v / (panels * panels);
                let allowed = solid_angle(near, far);
                for (value, sine) in values.iter_mut().zip(&sines) {
                    if *sine > 0.0 {
                        let free = (far / sine).min(1.0).asin() - (near / sine).min(1.0).acos();
                        *value += weight * sine * 8.0 * free.max(0.0) / allowed;
                    }
                }
            }
        }
    }
    values
}

/// Solid angle of |p_y| ≤ ζ_1, |p_z| ≤ ζ_2: 8 ∫_0^ζ_1 arcsin(min(1, ζ_2/√(1 − y²))) dy.
fn solid_angle(near: f64, far: f64) -> f64 {
    let split = (1.0 - far * far).max(0.0).sqrt().min(near);
    let below = integral(2, 0.0, split, |y| (far / (1.0 - y * y).sqrt()).min(1.0).asin());
    8.0 * (below + FRAC_PI_2 * (near - split))
}

//! Principal stresses of a plane state.

use crate::plane::principal;

/// Principal stresses of 11, 22, 33, 12, where 33 is one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principal {
    /// The greatest of the three, MPa.
    pub maximum: f64,
    /// The one between, MPa.
    pub middle: f64,
    /// The least of the three, MPa.
    pub minimum: f64,
    /// The two in the plane, the greater one first, MPa.
    pub in_plane: [f64; 2],
    /// The angle from x to the direction of the greater one in the plane, rad, −π/2 < θ ≤ π/2.
    pub angle: f64,
}

impl Principal {
    /// Finds the principal values of a stress 11, 22, 33, 12; all NaN if any component is.
    pub fn new([s11, s22, s33, s12]: [f64; 4]) -> Self {
        let in_plane = principal([s11, s22, s33, s12]);
        let mut ordered = [in_plane[0], in_plane[1], s33];
        if ordered.iter().any(|value| value.is_nan()) {
            return Self {
                maximum: f64::NAN,
                middle: f64::NAN,
                minimum: f64::NAN,
                in_plane: [f64::NAN; 2],
                angle: f64::NAN,
            };
        }
        ordered.sort_unstable_by(f64::total_cmp);
        let [minimum, middle, maximum] = ordered;
        Self { maximum, middle, minimum, in_plane, angle: 0.5 * s12.atan2(0.5 * (s11 - s22)) }
    }

    /// The unit vector along the greatest of the three: (0, 0, 1) where that is the one out of the plane.
    pub fn direction(&self) -> [f64; 3] {
        if self.maximum > self.in_plane[0] { [0.0, 0.0, 1.0] } else { [self.angle.cos(), self.angle.sin(), 0.0] }
    }
}

/// The von Mises stress of 11, 22, 33, 12, MPa.
pub(crate) fn von_mises([s11, s22, s33, s12]: [f64; 4]) -> f64 {
    let squares = (s11 - s22).powi(2) + (s22 - s33).powi(2) + (s33 - s11).powi(2);
    (0.5 * squares + 3.0 * s12 * s12).sqrt()
}

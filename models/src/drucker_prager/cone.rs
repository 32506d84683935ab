//! The cone in stress space: α and k of eq. 5.22, ᾱ of the potential.

use umat_abi::law::ConfigurationError;
use umat_abi::table::{Field, require};

/// α, k, ᾱ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// α of F = αI₁ + √J₂ − k.
    pub friction: f64,
    /// k, MPa.
    pub shear_strength: f64,
    /// ᾱ of Ψ = ᾱI₁ + √J₂.
    pub dilation: f64,
}

umat_abi::choices! {
    /// Meaning of cohesion and angles: the cone that is matched to them.
    pub enum Match {
        /// β and d of ABAQUS' linear model.
        Abaqus = 0.0 c"abaqus",
        /// Mohr–Coulomb's compression edges.
        Outer = 1.0 c"outer",
        /// Mohr–Coulomb in plane strain.
        PlaneStrain = 2.0 c"plane_strain",
    }
}

impl Match {
    /// α of an angle.
    fn slope(self, angle: f64) -> f64 {
        match self {
            Self::Abaqus => angle.tan() / (3.0 * 3.0_f64.sqrt()),
            Self::Outer => 2.0 * angle.sin() / (3.0_f64.sqrt() * (3.0 - angle.sin())),
            Self::PlaneStrain => angle.tan() / (9.0 + 12.0 * angle.tan() * angle.tan()).sqrt(),
        }
    }

    /// k.
    fn shear_strength(self, cohesion: f64, angle: f64) -> f64 {
        match self {
            Self::Abaqus => cohesion / 3.0_f64.sqrt(),
            Self::Outer => 6.0 * cohesion * angle.cos() / (3.0_f64.sqrt() * (3.0 - angle.sin())),
            Self::PlaneStrain => 3.0 * cohesion / (9.0 + 12.0 * angle.tan().powi(2)).sqrt(),
        }
    }
}

impl Field<4> for Cone {
    fn read([cohesion, friction_degrees, dilation_degrees, matched]: [f64; 4]) -> Result<Self, ConfigurationError> {
        Self::new(cohesion, friction_degrees, dilation_degrees, Match::read([matched])?)
    }
}

impl Cone {
    /// Makes a cone from cohesion (MPa) and angles (degrees).
    ///
    /// # Errors
    /// If the dilation angle exceeds the friction angle.
    pub fn new(
        cohesion: f64,
        friction_degrees: f64,
        dilation_degrees: f64,
        matched: Match,
    ) -> Result<Self, ConfigurationError> {
        let rule = "dilation_angle_deg must not exceed friction_angle_deg";
        require(dilation_degrees <= friction_degrees, rule, dilation_degrees)?;
        let friction = friction_degrees.to_radians();
        Ok(Self {
            friction: matched.slope(friction),
            shear_strength: matched.shear_strength(cohesion, friction),
            dilation: matched.slope(dilation_degrees.to_radians()),
        })
    }

    /// Mean stress at the apex, k/(3α); infinite without friction.
    #[inline]
    pub fn apex(&self) -> f64 {
        self.shear_strength / (3.0 * self.friction)
    }

    /// F(σ_m, √J₂).
    #[inline]
    pub(crate) fn yield_function(&self, mean_stress: f64, root_j2: f64) -> f64 {
        3.0 * self.friction * mean_stress + root_j2 - self.shear_strength
    }
}

//! The bond envelope τ(s): largest bond traction after the largest slip s (doc.md; thesis 6.23, 6.24).

use umat_abi::law::ConfigurationError;
use umat_abi::table::{require, require_at_most};

/// Rounding allowed where two slopes given by the user should be equal.
const SLOPE_ROUNDING: f64 = 1e-9;

/// Form of the envelope after its linear start.
#[derive(Clone, Copy, Debug)]
enum Form<'p> {
    /// a₁ s^b₁ up to the peak, then a₂ s^b₂ (6.24).
    Powers { rise: [f64; 2], fall: [f64; 2] },
    /// Straight lines through (slip, traction) pairs, one after the other; constant after the last (6.23).
    Piecewise { points: &'p [[f64; 2]] },
}

/// A bond envelope: k_e s up to `critical_slip`, then the form; after the peak not below the residual.
#[derive(Clone, Copy, Debug)]
pub struct Envelope<'p> {
    /// k_e, MPa/mm.
    pub elastic_stiffness: f64,
    /// τ_res, MPa.
    pub residual: f64,
    /// g_crit: where debonding starts, mm.
    pub critical_slip: f64,
    /// g_peak, mm.
    pub peak_slip: f64,
    form: Form<'p>,
}

/// Traction on the envelope and its slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// τ(s), MPa.
    pub traction: f64,
    /// τ'(s), MPa/mm; at a joint the slope of the side of smaller slips, from which loading comes.
    pub slope: f64,
}

impl<'p> Envelope<'p> {
    /// Linear, power, power. The joints are the intersections (closed form), so that τ is continuous:
    /// g_crit = (a₁/k_e)^(1/(1−b₁)), g_peak = (a₂/a₁)^(1/(b₁−b₂)).
    ///
    /// # Errors
    /// Coefficients that give no rise followed by a fall.
    pub fn powers(
        elastic_stiffness: f64,
        rise: [f64; 2],
        fall: [f64; 2],
        residual: f64,
    ) -> Result<Self, ConfigurationError> {
        let ([a_1, b_1], [a_2, b_2]) = (rise, fall);
        require(elastic_stiffness > 0.0, "laws A and B need k_e > 0", elastic_stiffness)?;
        require(a_1 > 0.0, "the powers form needs a_1 > 0", a_1)?;
        require(a_2 > 0.0, "the powers form needs a_2 > 0", a_2)?;
        require(b_1 > 0.0 && b_1 < 1.0, "the powers form needs 0 < b_1 < 1", b_1)?;
        require(b_2 < 0.0, "the powers form needs b_2 < 0", b_2)?;
        let critical_slip = (a_1 / elastic_stiffness).powf(1.0 / (1.0 - b_1));
        let peak_slip = (a_2 / a_1).powf(1.0 / (b_1 - b_2));
        let ordered = critical_slip.is_normal() && peak_slip.is_finite() && critical_slip < peak_slip;
        require(ordered, "the joints of the powers form must satisfy 0 < g_crit < g_peak", critical_slip)?;
        let envelope =
            Self { elastic_stiffness, residual, critical_slip, peak_slip, form: Form::Powers { rise, fall } };
        envelope.with_residual_below_peak()
    }

    /// Interpolates linearly between (slip, traction) pairs, starting at (0, 0) unless the first slip is 0: such a bond
    /// is rigid except for k_e. g_crit is the slip where k_e s meets the lines.
    ///
    /// # Errors
    /// The slips do not increase; the secant stiffness grows or exceeds k_e, so that unloading could return more energy
    /// than was spent; or there is no traction at all.
    pub fn piecewise(
        elastic_stiffness: f64,
        points: &'p [[f64; 2]],
        residual: f64,
    ) -> Result<Self, ConfigurationError> {
        require(elastic_stiffness > 0.0, "laws A and B need k_e > 0", elastic_stiffness)?;
        // a written (0, 0) is the one that is meant anyway
        let points = if points.first() == Some(&[0.0; 2]) { &points[1..] } else { points };
        let rule = "the piecewise form needs at least one point in addition to (0, 0)";
        let [Some(&[first_slip, first_traction]), Some(&[_, last_traction])] = [points.first(), points.last()] else {
            return Err(ConfigurationError::Inconsistent { rule, value: 0.0 });
        };
        let within = first_traction <= elastic_stiffness * first_slip * (1.0 + SLOPE_ROUNDING);
        let rule = "the first segment must not be steeper than k_e, in MPa/mm";
        require_at_most(first_slip == 0.0 || within, rule, first_traction / first_slip, elastic_stiffness)?;
        let (mut peak_slip, mut peak) = (first_slip, first_traction);
        let mut critical_slip = if first_traction < elastic_stiffness * first_slip * (1.0 - SLOPE_ROUNDING) {
            Some(0.0)
        } else {
            (elastic_stiffness * first_slip >= first_traction * (1.0 - SLOPE_ROUNDING)).then_some(first_slip)
        };
        for [g_i, tau_i, g_j, tau_j] in segments(points) {
            require(g_j > g_i, "the slips of the points must increase", g_j)?;
            let falling = tau_j * g_i <= tau_i * g_j * (1.0 + SLOPE_ROUNDING);
            let rule = "the secant stiffness traction/slip of the points must not grow, in MPa/mm";
            require_at_most(falling, rule, tau_j / g_j, tau_i / g_i)?;
            if critical_slip.is_none() && elastic_stiffness * g_j >= tau_j {
                let slope = (tau_j - tau_i) / (g_j - g_i);
                critical_slip = Some((tau_i - slope * g_i) / (elastic_stiffness - slope));
            }
            if tau_j > peak {
                (peak_slip, peak) = (g_j, tau_j);
            }
        }
        require(peak > 0.0, "the piecewise form needs a traction > 0", peak)?;
        let critical_slip = critical_slip.unwrap_or(last_traction / elastic_stiffness);
        let form = Form::Piecewise { points };
        let peak_slip = peak_slip.max(critical_slip);
        Self { elastic_stiffness, residual, critical_slip, peak_slip, form }.with_residual_below_peak()
    }

    fn with_residual_below_peak(self) -> Result<Self, ConfigurationError> {
        let peak = self.strength(self.peak_slip).traction;
        let rule = "tau_res must not exceed the peak of the envelope, in MPa";
        require_at_most(self.residual <= peak, rule, self.residual, peak)?;
        Ok(self)
    }

    /// τ(s) and τ'(s), s ≥ 0.
    #[inline]
    pub fn strength(&self, slip: f64) -> Strength {
        if slip <= self.critical_slip {
            return Strength { traction: self.elastic_stiffness * slip, slope: self.elastic_stiffness };
        }
        let strength = match self.form {
            Form::Powers { rise, fall } => {
                let [a, b] = if slip <= self.peak_slip { rise } else { fall };
                let traction = a * slip.powf(b);
                Strength { traction, slope: b * traction / slip }
            }
            Form::Piecewise { points } => interpolated(points, slip),
        };
        if slip > self.peak_slip && strength.traction < self.residual {
            return Strength { traction: self.residual, slope: 0.0 };
        }
        strength
    }

    /// k_u(κ) = min(k_e, max(k_u, τ(κ)/κ)) and its derivative by κ: never softer than the secant, so
    /// that the inelastic slip grows monotonically and unloading gives no energy.
    #[inline]
    pub(crate) fn unloading_stiffness(&self, largest_slip: f64, parameter: f64) -> (f64, f64) {
        if largest_slip <= self.critical_slip {
            return (self.elastic_stiffness, 0.0);
        }
        let Strength { traction, slope } = self.strength(largest_slip);
        let secant = traction / largest_slip;
        if secant >= self.elastic_stiffness || parameter >= self.elastic_stiffness {
            (self.elastic_stiffness, 0.0)
        } else if secant > parameter {
            (secant, (slope - secant) / largest_slip)
        } else {
            (parameter, 0.0)
        }
    }

    /// 1 − d(κ) = (τ(κ) − τ_res)/(k_e κ − τ_res) of law B, 1 up to g_crit, and its derivative by κ.
    #[inline]
    pub fn integrity(&self, largest_slip: f64) -> (f64, f64) {
        if largest_slip <= self.critical_slip {
            return (1.0, 0.0);
        }
        let Strength { traction, slope } = self.strength(largest_slip);
        let elastic = self.elastic_stiffness * largest_slip - self.residual;
        let integrity = ((traction - self.residual) / elastic).clamp(0.0, 1.0);
        (integrity, (slope - self.elastic_stiffness * integrity) / elastic)
    }

    /// Checks that law B can follow this envelope: τ_res below τ(g_crit), and d(κ) never decreasing.
    ///
    /// # Errors
    /// The rule that is broken.
    pub(crate) fn check_damage(&self) -> Result<(), ConfigurationError> {
        let (k, residual) = (self.elastic_stiffness, self.residual);
        let allowed = residual == 0.0 || residual < self.strength(self.critical_slip).traction;
        require(allowed, "law B needs tau_res below the traction at the end of the linear start", residual)?;
        // for the powers it is a theorem; on a line τ = c + m s: d' ∝ k (c − τ_res) + m τ_res
        if let Form::Piecewise { points } = self.form {
            for [g_i, tau_i, g_j, tau_j] in segments(points) {
                let m = (tau_j - tau_i) / (g_j - g_i);
                let growth = k * (tau_i - m * g_i - residual) + m * residual;
                let floored = g_i >= self.peak_slip && tau_i.max(tau_j) <= residual;
                let elastic = g_j <= self.critical_slip;
                let rule = "law B cannot follow a piecewise envelope along which its damage would decrease";
                require(elastic || floored || growth >= -SLOPE_ROUNDING * k * tau_i, rule, g_j)?;
            }
        }
        Ok(())
    }
}

/// Consecutive pairs of points as (g_i, τ_i, g_j, τ_j).
fn segments(points: &[[f64; 2]]) -> impl Iterator<Item = [f64; 4]> {
    points.windows(2).map(|pair| [pair[0][0], pair[0][1], pair[1][0], pair[1][1]])
}

/// The piecewise linear function through (0, 0) (unless the first slip is 0) and the points, constant
/// after the last; at a point the slope before it.
fn interpolated(points: &[[f64; 2]], slip: f64) -> Strength {
    let before = points.partition_point(|[g, _]| *g < slip);
    let Some(&[g_j, tau_j]) = points.get(before) else {
        return Strength { traction: points[points.len() - 1][1], slope: 0.0 };
    };
    let [g_i, tau_i] = if before == 0 { [0.0; 2] } else { points[before - 1] };
    if g_j <= g_i {
        return Strength { traction: tau_j, slope: 0.0 };
    }
    let slope = (tau_j - tau_i) / (g_j - g_i);
    // measured from the nearer end, so that the points themselves are met exactly
    let traction = if slip - g_i <= g_j - slip { tau_i + slope * (slip - g_i) } else { tau_j - slope * (g_j - slip) };
    Strength { traction, slope }
}

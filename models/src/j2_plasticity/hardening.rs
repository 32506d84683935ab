//! σ_y(p): the yield stress as a piecewise linear function of the equivalent plastic strain,
//! constant beyond its last point.

use crate::tensor::Elasticity;
use umat_abi::law::ConfigurationError;
use umat_abi::table::require;

/// A view of the (yield stress, equivalent plastic strain) pairs in PROPS.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hardening<'p> {
    points: &'p [[f64; 2]],
}

impl<'p> From<&'p [[f64; 2]]> for Hardening<'p> {
    #[inline(always)]
    fn from(points: &'p [[f64; 2]]) -> Self {
        Self { points }
    }
}

impl Hardening<'_> {
    /// Checks the table: starts at p = 0, p strictly increasing, softening slopes mild enough for a
    /// unique return in every stress state (see the notes of the law).
    #[inline(always)]
    pub(super) fn check(&self, elasticity: &Elasticity) -> Result<(), ConfigurationError> {
        let points = self.points;
        let start = points[0][1];
        require(start == 0.0, "the hardening table must start at equivalent plastic strain 0", start)?;
        let steepest = -equibiaxial_modulus(elasticity);
        for pair in points.windows(2) {
            let [[start_stress, start], [end_stress, end]] = [pair[0], pair[1]];
            require(end > start, "equivalent plastic strains of the hardening table must increase", end)?;
            // this runs in every call: no division
            let (rise, run) = (end_stress - start_stress, end - start);
            if !(rise.abs() < f64::MAX * run && rise > steepest * run) {
                return Err(ConfigurationError::Inconsistent {
                    rule: "hardening slopes must be finite and above -E/(2(1-nu))",
                    value: rise / run,
                });
            }
        }
        Ok(())
    }

    /// The least yield stress of the table, MPa.
    pub fn least(&self) -> f64 {
        self.points.iter().fold(f64::INFINITY, |least, point| least.min(point[0]))
    }

    /// σ_y(p), MPa.
    #[inline(always)]
    pub fn yield_stress(&self, peeq: f64) -> f64 {
        let segment = self.segment(peeq);
        let [stress, start] = self.points[segment];
        stress + self.slope_of(segment) * (peeq - start)
    }

    /// H = dσ_y/dp, MPa; at a joint that of the following segment.
    #[inline]
    pub fn slope(&self, peeq: f64) -> f64 {
        self.slope_of(self.segment(peeq))
    }

    /// ∫ σ_y dp between two equivalent plastic strains: exact, segment by segment.
    pub fn work(&self, from: f64, to: f64) -> f64 {
        let mut work = 0.0;
        let mut start = from;
        let mut segment = self.segment(from);
        while start < to {
            let joint = self.points.get(segment + 1).map_or(f64::INFINITY, |point| point[1]);
            let end = to.min(joint);
            let [stress, origin] = self.points[segment];
            work += (end - start) * (stress + self.slope_of(segment) * (0.5 * (start + end) - origin));
            start = end;
            segment += 1;
        }
        work
    }

    /// The Δp and H of the radial return: q_trial − 3μ Δp = σ_y(p + Δp), in closed form. What is
    /// left of q_trial at a joint, less σ_y there, falls along the table: its last positive joint
    /// begins the segment where the return ends.
    pub(crate) fn radial_return(&self, trial: f64, peeq: f64, three_mu: f64) -> (f64, f64) {
        let beyond =
            self.points.partition_point(|&[stress, joint]| joint <= peeq || trial - three_mu * (joint - peeq) > stress);
        let segment = beyond.saturating_sub(1);
        let [stress, joint] = self.points[segment];
        let slope = self.slope_of(segment);
        if joint <= peeq {
            let excess = trial - (stress + slope * (peeq - joint));
            (excess / (three_mu + slope), slope)
        } else {
            let excess = trial - three_mu * (joint - peeq) - stress;
            (joint - peeq + excess / (three_mu + slope), slope)
        }
    }

    #[inline(always)]
    fn segment(&self, peeq: f64) -> usize {
        // reading the table looked at all of it: no search is worth its while
        self.points[1..].iter().take_while(|point| point[1] <= peeq).count()
    }

    #[inline(always)]
    fn slope_of(&self, segment: usize) -> f64 {
        match self.points.get(segment + 1) {
            Some(next) => {
                let [stress, start] = self.points[segment];
                (next[0] - stress) / (next[1] - start)
            }
            None => 0.0,
        }
    }
}

/// −dq/dp of the plane-stress return in equibiaxial stress, E/(2(1 − ν)): the least of all stress
/// states (3μ in shear and in three dimensions).
#[inline(always)]
fn equibiaxial_modulus(elasticity: &Elasticity) -> f64 {
    0.5 * elasticity.youngs_modulus / (1.0 - elasticity.poisson_ratio)
}

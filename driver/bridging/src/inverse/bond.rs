//! The bond from σ_f(w), or from strengths.

use super::{Estimate, Fitted, LeastSquares, assess, least_squares};
use crate::average::averages;
use crate::beam::{LayeredBeam, NotchedBeam, Residual, SectionLaw};
use crate::interpolation::Polyline;
use crate::{Composite, Invalid};

/// Largest correlation of τ and f for which both are reported. Above it only g(f) τ can be determined, and a search in
/// an undetermined direction takes a minute.
const LARGEST_CORRELATION: f64 = 0.9999;
/// Evaluations per parameter.
const PATIENCE: usize = 12;
/// A quantity is sought up to this factor from its start: beyond it nothing is a fibre's.
const LARGEST_FACTOR: f64 = 20.0;
/// Differences where nothing is a fibre's: so large that the search turns back.
const NO_FIBRE: f64 = 10.0;
/// Openings from which the strengths of a beam are computed, to the last, mm, closer at the beginning.
const OPENINGS: (f64, usize) = (3.5, 14);

/// Fibres with a bond that is sought.
pub struct SoughtBond<'c> {
    /// The composite with one quantity, or two: the friction, and the snubbing f, say.
    pub composite: &'c dyn Fn(&[f64]) -> Result<Composite, Invalid>,
    /// The quantities from which the search begins; the second is sought if the data determine it.
    pub start: &'c [f64],
}

impl SoughtBond<'_> {
    /// Returns the quantities with the least differences. There are `rows` differences, each relative to the greatest
    /// value.
    fn find(&self, rows: usize, differences: &dyn Fn(&Composite) -> Vec<f64>) -> Result<Fitted, Invalid> {
        (self.composite)(self.start)?;
        let begin: Vec<f64> = self.start.iter().map(|start| start.ln()).collect();
        let residuals = |parameters: &[f64]| -> Vec<f64> {
            let is_near = |(parameter, start): (&f64, &f64)| (parameter - start).abs() <= LARGEST_FACTOR.ln();
            let composite = parameters.iter().zip(&begin).all(is_near).then(|| {
                let sought = parameters.iter().map(|parameter| parameter.exp());
                let quantities: Vec<f64> = sought.chain(self.start.iter().skip(parameters.len()).copied()).collect();
                (self.composite)(&quantities).ok()
            });
            composite.flatten().map_or_else(|| vec![NO_FIBRE; rows], |composite| differences(&composite))
        };
        let quantities = |parameters: &[f64]| parameters.iter().map(|x| x.exp()).collect();
        let problem = LeastSquares { residuals: &residuals, quantities: &quantities, data: rows, patience: PATIENCE };
        let alone = least_squares(&problem, &begin[..1]);
        let Some(second) = begin.get(1) else { return Ok(alone) };
        let begin = vec![alone.parameters[0], *second];
        if !alone.reached || assess(&problem, begin.clone()).correlation[(0, 1)].abs() > LARGEST_CORRELATION {
            return Ok(alone);
        }
        let both = least_squares(&problem, &begin);
        Ok(if both.reached && both.estimates.iter().all(Estimate::is_identifiable) { both } else { alone })
    }
}

/// Finds the quantities whose σ_f(w) is nearest to the given one, (w, σ_f) by rising w: their logarithms are sought. Of
/// friction and snubbing f, without rupture σ_f depends on g(f) τ alone: where the second is not determined it keeps its
/// value.
///
/// # Errors
/// Numbers without sense.
pub fn bond_from_bridging(sought: &SoughtBond<'_>, target: &[[f64; 2]]) -> Result<Fitted, Invalid> {
    Invalid::unless(target.len() >= 2, "bridging".into(), "must have two points or more")?;
    let greatest = target.iter().map(|row| row[1]).fold(0.0, f64::max);
    Invalid::unless(greatest > 0.0, "bridging".into(), "must have a stress above 0")?;
    sought.find(target.len(), &|composite| {
        target.iter().map(|&[opening, stress]| (composite.average(opening).stress - stress) / greatest).collect()
    })
}

/// Finds the quantities from the mean of the strengths f_R1–4 of beams. They are compared with the strengths of the
/// computed beam, without a σ(w) in between.
///
/// # Errors
/// Numbers without sense.
pub fn bond_from_strengths(
    sought: &SoughtBond<'_>,
    geometry: &NotchedBeam,
    beams: &[Residual],
) -> Result<Fitted, Invalid> {
    geometry.check()?;
    let mean = Residual::mean(beams).residual;
    let greatest = mean.into_iter().fold(0.0, f64::max);
    Invalid::unless(greatest > 0.0, "test".into(), "must have strengths above 0")?;
    let (end, count) = OPENINGS;
    let openings: Vec<f64> = (0..count).map(|k| end * (k as f64 / (count - 1) as f64).powi(2)).collect();
    sought.find(mean.len(), &|composite| {
        let stresses: Vec<f64> =
            averages(&composite.roughly(), &openings).iter().map(|average| average.stress).collect();
        let bridging = Polyline::smooth(&openings, &stresses);
        let section = [SectionLaw::new(&composite.matrix, &composite.with_matrix(&bridging), geometry.hinge())];
        let computed = LayeredBeam::new(*geometry, &section, &composite.matrix).residual().residual;
        computed.into_iter().zip(mean).map(|(computed, tested)| (computed - tested) / greatest).collect()
    })
}

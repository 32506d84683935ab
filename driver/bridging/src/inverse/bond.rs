//! The bond from σ_f(w).

use super::{Estimate, Fitted, LeastSquares, assess, least_squares};
use crate::composite::Matrix;
use crate::{Bond, BridgingFibre, Closed, Composite, Fibre, Inclination, Invalid, Orientation, Sides};

/// Largest correlation of τ and f with which both are reported. Beyond it only g(f) τ is; a search in an undetermined
/// direction takes a minute.
const LARGEST_CORRELATION: f64 = 0.9999;

/// Finds the friction τ and, as far as the data determine it, the snubbing f whose σ_f(w) is nearest to the given one,
/// (w, σ_f) by rising w: their logarithms are sought, from `start`. Without rupture σ_f depends on g(f) τ alone: where
/// f is not determined it keeps its value, and τ alone is sought.
///
/// # Errors
/// Numbers without sense.
pub fn bond_from_bridging(
    fibre: &Fibre,
    volume_fraction: f64,
    orientation: &Orientation,
    sides: Sides,
    start: (&Closed, f64),
    target: &[[f64; 2]],
) -> Result<Fitted, Invalid> {
    let matrix = Matrix { modulus: 3e4, ft: 1.0, softening: Default::default(), fracture_energy: 0.0, fc: None };
    let composite = |tau: f64, f: f64| {
        let bond = Bond::Closed(Closed { tau, ..*start.0 });
        let fibre = BridgingFibre::new(*fibre, &bond, Inclination::Exp { f }, sides, 0.0)?;
        Composite::new(fibre, volume_fraction, orientation, matrix, 0.0)
    };
    Invalid::unless(start.1 > 0.0, "fibre.inclination.f".into(), "must be above 0 to be sought")?;
    Invalid::unless(target.len() >= 2, "bridging".into(), "must have two points or more")?;
    composite(start.0.tau, start.1)?;
    let greatest = target.iter().map(|row| row[1]).fold(0.0, f64::max);
    Invalid::unless(greatest > 0.0, "bridging".into(), "must have a stress above 0")?;
    let residuals = |parameters: &[f64]| -> Vec<f64> {
        let f = parameters.get(1).map_or(start.1, |logarithm| logarithm.exp());
        let Ok(composite) = composite(parameters[0].exp(), f) else {
            return vec![f64::NAN; target.len()];
        };
        target.iter().map(|&[opening, stress]| (composite.average(opening).stress - stress) / greatest).collect()
    };
    let quantities = |parameters: &[f64]| parameters.iter().map(|x| x.exp()).collect();
    let problem = LeastSquares { residuals: &residuals, quantities: &quantities, data: target.len() };
    let alone = least_squares(&problem, &[start.0.tau.ln()]);
    let begin = [alone.parameters[0], start.1.ln()];
    if assess(&problem, begin.to_vec()).correlation[(0, 1)].abs() > LARGEST_CORRELATION {
        return Ok(alone);
    }
    let both = least_squares(&problem, &begin);
    Ok(if both.estimates.iter().all(Estimate::is_identifiable) { both } else { alone })
}

//! Least squares under linear inequalities (Lawson and Hanson 1974, chapters 20 and 23).

use nalgebra::{DMatrix, DVector};

/// A gain below this part of the data is rounding.
const ROUNDING: f64 = 1e-12;
/// Most changes of the set of unknowns that are not 0, for each unknown.
const PATIENCE: usize = 6;

/// min |A x − b| with G x ≥ 0. A has more rows than columns, whose rank is full; `None` if it is not.
pub(super) fn constrained(a: DMatrix<f64>, b: &DVector<f64>, constraints: &DMatrix<f64>) -> Option<DVector<f64>> {
    let factors = a.qr();
    let (free, triangle) = (factors.q().transpose() * b, factors.r());
    let inverse = triangle.try_inverse()?;
    // with x = R⁻¹ (y + Qᵀb) the least distance |y| that meets the inequalities
    let bounds = constraints * inverse.clone();
    let right = -(&bounds * &free);
    let unknowns = free.len();
    let mut dual = DMatrix::zeros(unknowns + 1, constraints.nrows());
    dual.rows_mut(0, unknowns).copy_from(&bounds.transpose());
    dual.row_mut(unknowns).copy_from(&right.transpose());
    let mut one = DVector::zeros(unknowns + 1);
    one[unknowns] = 1.0;
    let rest = &dual * non_negative(&dual, &one) - one;
    let y = rest.rows(0, unknowns) / -rest[unknowns];
    let x = inverse * (y + free);
    x.iter().all(|value| value.is_finite()).then_some(x)
}

/// min |E u − f| with u ≥ 0.
fn non_negative(e: &DMatrix<f64>, f: &DVector<f64>) -> DVector<f64> {
    let count = e.ncols();
    let mut passive = vec![false; count];
    let mut u = DVector::zeros(count);
    let mut left = PATIENCE * count;
    loop {
        let gradient = e.transpose() * (f - e * &u);
        let steepest = (0..count).filter(|&k| !passive[k]).max_by(|&i, &j| gradient[i].total_cmp(&gradient[j]));
        let small = ROUNDING * f.norm() * e.norm();
        let Some(enters) = steepest.filter(|&k| gradient[k] > small && left > 0) else { return u };
        passive[enters] = true;
        loop {
            left = left.saturating_sub(1);
            let among: Vec<usize> = (0..count).filter(|&k| passive[k]).collect();
            let some = e.select_columns(&among);
            let Ok(solution) = some.svd(true, true).solve(f, ROUNDING) else { return u };
            let part = |(place, &k): (usize, &usize)| {
                (solution[place] <= 0.0).then(|| (k, u[k] / (u[k] - solution[place]).max(f64::MIN_POSITIVE)))
            };
            let first = among.iter().enumerate().filter_map(part).min_by(|a, b| a.1.total_cmp(&b.1));
            let step = first.map_or(1.0, |(_, part)| part);
            among.iter().enumerate().for_each(|(place, &k)| u[k] += step * (solution[place] - u[k]));
            let Some((leaves, _)) = first.filter(|_| left > 0) else { break };
            passive[leaves] = false;
            u[leaves] = 0.0;
            for k in among {
                if u[k] <= 0.0 {
                    (passive[k], u[k]) = (false, 0.0);
                }
            }
        }
    }
}

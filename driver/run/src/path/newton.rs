//! Mixed control: strains are found for which the controlled stresses and the linear relations hold.
//!
//! Newton on the plugin's tangent, with a backtracking line search. When the tangent predicts the
//! change of the residual badly, the iteration goes on with Broyden's secant update of the last
//! matrix that served; a singular or unusable matrix is replaced by one from finite differences.

use crate::program::{Constraint, Control};
use fe_core::stepping::line_search;
use nalgebra::{SMatrix, SVector};

/// |Δs| ≤ 1e-8 · max(1, |s|) MPa: the contract of docs/reference/command-line.md.
pub(super) const STRESS_TOLERANCE: f64 = 1e-8;
/// Stress that rounding leaves, relative to the largest so far: more than [`STRESS_TOLERANCE`] in a case in Pa, where the 0 of
/// a free side is a difference of 1e8.
const STRESS_ROUNDING: f64 = 1e-12;
/// Tolerance of relations that hold strains alone, relative to max(1e-6, largest strain).
const STRAIN_TOLERANCE: f64 = 1e-10;
/// A strain that is sought changes in an increment by at most so many times the largest strain there: what changes more is looked
/// at closely, since it may be another equilibrium, as that of torn matter, whose stresses vanish however large its strains are.
pub(super) const LARGEST_CHANGE: f64 = 3.0;
/// A residual that counts as zero changes the strains of an equilibrium by less than this share of the increment. In
/// torn matter it determines no strain.
const DETERMINED: f64 = 1e-3;
/// A full step should at least halve the residual, else the tangent is called poor.
const POOR_REDUCTION: f64 = 0.5;
/// Parts of a correction that are tried, the whole one included.
const PARTS: u32 = 6;
/// A correction is taken if the residual falls by this fraction of the part that is taken.
const SUFFICIENT_DECREASE: f64 = 1e-3;
/// Strain step of the finite-difference matrix relative to max(1e-6, largest strain).
const DIFFERENCE_STEP: f64 = 1e-6;

type Matrix = SMatrix<f64, 6, 6>;
type Vector = SVector<f64, 6>;

/// Stress and tangent at a strain increment, as the plugin returned them.
pub(super) struct Evaluation {
    /// Stress, six components.
    pub(super) stress: [f64; 6],
    /// ∂σ_i/∂ε_j.
    pub(super) tangent: [[f64; 6]; 6],
}

/// Conditions at the end of an increment.
#[derive(Clone, Debug)]
pub(super) struct Targets<'a> {
    /// Components that exist.
    pub(super) components: &'a [usize],
    /// Control of each component; `Strain` and `Stress` hold the values at the end.
    pub(super) controls: [Control; 6],
    /// The relations, with their right sides at the end.
    pub(super) constraints: &'a [Constraint],
    /// Total strain at the start.
    pub(super) strain: [f64; 6],
    /// The largest component of stress at the end of any increment so far.
    pub(super) largest_stress: f64,
    /// The largest strain at the start of the step and of those that drive it; `None` if something else drives it.
    pub(super) measure: Option<f64>,
}

/// The increment's strains were not found.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Divergence<E> {
    /// The plugin failed.
    Evaluation(E),
    /// No convergence; the residual of each component that is not controlled by strain.
    NotConverged {
        /// Target minus stress (or relation), by component.
        residual: [f64; 6],
    },
    /// The equilibrium that was found is not the next one.
    Far {
        /// The strain that changed most.
        component: usize,
        /// Change of that strain.
        change: f64,
        /// Whether the conditions determine the strains there: then it may be the next one of a large increment.
        is_determined: bool,
        /// Iterations that led there.
        iterations: u32,
    },
}

/// Returns whether a law knows nothing of a component: neither does its stress depend on any strain nor any stress on its
/// strain.
#[inline]
pub(super) fn is_unknown(components: &[usize], component: usize, tangent: &[[f64; 6]; 6]) -> bool {
    tangent[component][component] == 0.0
        && components.iter().all(|&j| tangent[component][j] == 0.0 && tangent[j][component] == 0.0)
}

impl Targets<'_> {
    /// True if every component is given by its strain.
    pub(super) fn strain_only(&self) -> bool {
        self.components.iter().all(|&i| matches!(self.controls[i], Control::Strain(_)))
    }

    /// The strain among those that are sought that has changed most, and by how much.
    pub(super) fn largest_change(&self, end: &[f64; 6], start: &[f64; 6]) -> (usize, f64) {
        let mut largest = (0, 0.0_f64);
        for &i in self.components {
            let change = end[i] - start[i];
            if change.abs() > largest.1.abs() && !matches!(self.controls[i], Control::Strain(_)) {
                largest = (i, change);
            }
        }
        largest
    }

    /// Measure of the strains that are sought.
    fn size(&self) -> Option<f64> {
        self.measure.map(|measure| self.strain.iter().fold(measure, |size, strain| size.max(strain.abs())))
    }

    /// Returns what is to be looked at closely in an equilibrium that was found with these iterations, if it may not be the next one.
    fn far<E>(
        &self,
        increment: &[f64; 6],
        tangent: &[[f64; 6]; 6],
        residuals: [&Vector; 2],
        iterations: u32,
    ) -> Option<Divergence<E>> {
        let (component, change) = self.largest_change(increment, &[0.0; 6]);
        if change.abs() <= LARGEST_CHANGE * self.size()? {
            return None;
        }
        let [residual, tolerance] = residuals;
        let tolerance = tolerance.map(|t| if t.is_finite() { t } else { 0.0 });
        let undetermined =
            self.matrix(tangent, residual).try_inverse().map(|inverse| (inverse.abs() * tolerance).amax());
        let is_determined = undetermined.is_some_and(|undetermined| undetermined < DETERMINED * change.abs());
        Some(Divergence::Far { component, change, is_determined, iterations })
    }

    /// The strain at the end: exactly the prescribed values, not the sums of their increments.
    pub(super) fn end(&self, increment: &[f64; 6]) -> [f64; 6] {
        let mut end = self.strain;
        for &i in self.components {
            end[i] = match self.controls[i] {
                Control::Strain(value) => value,
                _ => end[i] + increment[i],
            };
        }
        end
    }

    fn residual(&self, increment: &[f64; 6], stress: &[f64; 6]) -> Vector {
        let mut residual = Vector::zeros();
        for &i in self.components {
            residual[i] = match self.controls[i] {
                Control::Stress(value) => stress[i] - value,
                Control::Constraint(k) => {
                    let relation = &self.constraints[k];
                    let mut sum = -relation.equals;
                    for &j in self.components {
                        sum += relation.strain[j] * (self.strain[j] + increment[j]) + relation.stress[j] * stress[j];
                    }
                    sum
                }
                Control::Strain(_) | Control::HoldStrain | Control::HoldStress => 0.0,
            };
        }
        residual
    }

    /// The largest residual that counts as zero, by component.
    fn tolerance(&self, increment: &[f64; 6], stress: &[f64; 6]) -> Vector {
        let rounding = STRESS_ROUNDING * stress.iter().fold(self.largest_stress, |largest, s| largest.max(s.abs()));
        let of_stress = |stress: f64| (STRESS_TOLERANCE * stress.abs().max(1.0)).max(rounding);
        let mut tolerance = Vector::repeat(f64::INFINITY);
        for &i in self.components {
            tolerance[i] = match self.controls[i] {
                Control::Stress(value) => of_stress(value),
                Control::Constraint(k) => {
                    let relation = &self.constraints[k];
                    let stresses: f64 =
                        self.components.iter().map(|&j| relation.stress[j].abs() * of_stress(stress[j])).sum();
                    let strains: f64 = self
                        .components
                        .iter()
                        .map(|&j| {
                            let size = (self.strain[j] + increment[j]).abs().max(1e-6);
                            relation.strain[j].abs() * STRAIN_TOLERANCE * size
                        })
                        .sum();
                    if stresses > 0.0 { stresses } else { strains }
                }
                _ => f64::INFINITY,
            };
        }
        tolerance
    }

    /// ∂residual/∂increment; components that are controlled by strain, and those that are unknown to the law and need nothing,
    /// get the identity, scaled like the rest.
    fn matrix(&self, tangent: &[[f64; 6]; 6], residual: &Vector) -> Matrix {
        let scale = self.components.iter().fold(0.0_f64, |m, &i| m.max(tangent[i][i].abs())).max(f64::MIN_POSITIVE);
        let mut matrix = Matrix::identity() * scale;
        for &i in self.components {
            match self.controls[i] {
                Control::Stress(_)
                    if is_unknown(self.components, i, tangent) && residual[i].abs() <= STRESS_TOLERANCE => {}
                Control::Stress(_) => {
                    for &j in self.components {
                        matrix[(i, j)] = tangent[i][j];
                    }
                }
                Control::Constraint(k) => {
                    let relation = &self.constraints[k];
                    for &j in self.components {
                        matrix[(i, j)] = relation.strain[j]
                            + self.components.iter().map(|&l| relation.stress[l] * tangent[l][j]).sum::<f64>();
                    }
                }
                _ => {}
            }
        }
        matrix
    }

    /// The end of a Newton step: strain-controlled components do not move.
    fn solve(&self, matrix: Matrix, residual: &Vector) -> Option<Vector> {
        let step = matrix.lu().solve(&-residual)?;
        step.iter().all(|x| x.is_finite()).then_some(step)
    }

    /// Adds to a guess what the last tangent predicts for the components not controlled by strain.
    pub(super) fn first_guess(&self, increment: &mut [f64; 6], stress: &[f64; 6], tangent: &[[f64; 6]; 6]) {
        let mut predicted = *stress;
        for &i in self.components {
            predicted[i] += self.components.iter().map(|&j| tangent[i][j] * increment[j]).sum::<f64>();
        }
        let residual = self.residual(increment, &predicted);
        if let Some(step) = self.solve(self.matrix(tangent, &residual), &residual) {
            for &i in self.components {
                increment[i] += step[i];
            }
        }
    }

    /// Finds the strain increment. `increment` holds the first guess on entry (strain-controlled components exact) and
    /// the solution on return, whose evaluation is the last one made, also that of [`Divergence::Far`]. Returns the iterations.
    pub(super) fn solve_increment<E>(
        &self,
        increment: &mut [f64; 6],
        max_iterations: u32,
        mut evaluate: impl FnMut(&[f64; 6]) -> Result<Evaluation, E>,
    ) -> Result<u32, Divergence<E>> {
        let first_guess = *increment;
        let found = self.solve_by_steps(increment, f64::INFINITY, max_iterations, &mut evaluate);
        let (Err(Divergence::Far { is_determined, .. }), Some(size)) = (&found, self.size()) else { return found };
        *increment = first_guess;
        let beside = self.solve_by_steps(increment, size, max_iterations, &mut evaluate);
        if beside.is_ok() || !is_determined {
            return beside;
        }
        *increment = first_guess;
        self.solve_by_steps(increment, f64::INFINITY, max_iterations, &mut evaluate)
    }

    /// Finds it by iterations that change no strain by more than `longest`.
    fn solve_by_steps<E>(
        &self,
        increment: &mut [f64; 6],
        longest: f64,
        max_iterations: u32,
        mut evaluate: impl FnMut(&[f64; 6]) -> Result<Evaluation, E>,
    ) -> Result<u32, Divergence<E>> {
        let mut here = evaluate(increment).map_err(Divergence::Evaluation)?;
        let mut residual = self.residual(increment, &here.stress);
        let mut matrix = self.matrix(&here.tangent, &residual);
        let mut secant = false;
        let not_converged = |residual: &Vector| Divergence::NotConverged { residual: (*residual).into() };
        for iteration in 1..=max_iterations {
            let tolerance = self.tolerance(increment, &here.stress);
            if residual.iter().zip(&tolerance).all(|(r, t)| r.abs() <= *t) {
                return self
                    .far(increment, &here.tangent, [&residual, &tolerance], iteration)
                    .map_or(Ok(iteration), Err);
            }
            if !residual.iter().all(|r| r.is_finite()) {
                return Err(not_converged(&residual));
            }
            let step = match self.solve(matrix, &residual) {
                Some(step) => step,
                None => {
                    matrix = self.difference_matrix(increment, &residual, &mut evaluate)?;
                    secant = true;
                    self.solve(matrix, &residual).ok_or_else(|| not_converged(&residual))?
                }
            };
            let step = step * (longest / step.amax()).min(1.0);
            let found = self.line_search(increment, &residual, &tolerance, &step, &mut evaluate)?;
            let Some((length, evaluation, new_residual)) = found else {
                // no descent: a matrix from differences is the last resort, once per failure
                if secant {
                    return Err(not_converged(&residual));
                }
                matrix = self.difference_matrix(increment, &residual, &mut evaluate)?;
                secant = true;
                continue;
            };
            let moved = step * length;
            for &i in self.components {
                increment[i] += moved[i];
            }
            let weighted = |r: &Vector| r.component_div(&tolerance).norm();
            let poor = length < 1.0 || weighted(&new_residual) > POOR_REDUCTION * weighted(&residual);
            secant = secant || (poor && iteration > 1);
            if secant {
                // Broyden: J += (Δr − J Δx) Δxᵀ / |Δx|²
                let error = new_residual - residual - matrix * moved;
                matrix += error * moved.transpose() / moved.norm_squared();
            } else {
                matrix = self.matrix(&evaluation.tangent, &new_residual);
            }
            here = evaluation;
            residual = new_residual;
        }
        Err(not_converged(&residual))
    }

    /// Backtracks until the residual (in units of its tolerance) falls. The last evaluation made is the accepted one.
    #[allow(clippy::type_complexity, reason = "length, evaluation and residual of the accepted point")]
    fn line_search<E>(
        &self,
        increment: &[f64; 6],
        residual: &Vector,
        tolerance: &Vector,
        step: &Vector,
        evaluate: &mut impl FnMut(&[f64; 6]) -> Result<Evaluation, E>,
    ) -> Result<Option<(f64, Evaluation, Vector)>, Divergence<E>> {
        let merit = |r: &Vector| r.component_div(tolerance).norm();
        let before = merit(residual);
        let mut last = None;
        let length = line_search::halved(1.0, PARTS, |length| {
            let mut trial = *increment;
            for &i in self.components {
                trial[i] += length * step[i];
            }
            let evaluation = evaluate(&trial).map_err(Divergence::Evaluation)?;
            let new_residual = self.residual(&trial, &evaluation.stress);
            let after = merit(&new_residual);
            last = Some((evaluation, new_residual));
            Ok(after <= (1.0 - SUFFICIENT_DECREASE * length) * before || after <= 1.0)
        })?;
        Ok(length.zip(last).map(|(length, (evaluation, residual))| (length, evaluation, residual)))
    }

    fn difference_matrix<E>(
        &self,
        increment: &[f64; 6],
        residual: &Vector,
        evaluate: &mut impl FnMut(&[f64; 6]) -> Result<Evaluation, E>,
    ) -> Result<Matrix, Divergence<E>> {
        let size = self.components.iter().fold(1e-6_f64, |m, &i| m.max((self.strain[i] + increment[i]).abs()));
        let h = DIFFERENCE_STEP * size;
        let mut matrix = Matrix::identity();
        for &j in self.components {
            if matches!(self.controls[j], Control::Strain(_)) {
                continue;
            }
            let mut shifted = *increment;
            shifted[j] += h;
            let evaluation = evaluate(&shifted).map_err(Divergence::Evaluation)?;
            let column = (self.residual(&shifted, &evaluation.stress) - residual) / h;
            matrix.set_column(j, &column);
        }
        Ok(matrix)
    }
}

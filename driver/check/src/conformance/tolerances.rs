//! Every tolerance of the checks, with its reason.

/// Tangent against fourth-order differences at the best step: truncation and rounding are ~1e-9, a wrong
/// formula shows at 1e-3 or more.
pub(super) const TANGENT: f64 = 1e-6;
/// An entry of a stiffness relative to its own row and column, which is a small part of the largest entry: a wrong formula shows.
pub(super) const SMALL_ENTRY: f64 = 1e-4;
/// Such an error must be so many times what iterations and rounding may leave of the differences.
pub(super) const SMALL_ENTRY_RESOLVED: f64 = 10.0;
/// A derivative of which so small a part of what is differentiated would come over the size of the input is rounding of the differences.
pub(super) const ROUNDING_OF_DIFFERENCES: f64 = 1e-6;
/// Two difference quotients that disagree by more than this share of the tangent's error decide nothing.
pub(super) const DIFFERENCES_DECIDE: f64 = 0.1;
/// A tangent that changes by more than this between neighbours 1e-4 apart jumps: a kink.
pub(super) const TANGENT_JUMP: f64 = 2e-2;
/// Share of the states that may lie at kinks or be undecided before the check is worth a warning.
pub(super) const EXCLUDED_SHARE: f64 = 0.05;
/// C_ij − C_ji relative to the largest entry: rounding of a symmetric formula.
pub(super) const SYMMETRY: f64 = 1e-12;
/// Rotated path against path, relative to the largest stress: the rotation rounds the strains to 1e-16, laws
/// with powers of the strain amplify that.
pub(super) const ROTATION: f64 = 1e-10;
/// Rounding error of a rotated and strained deformation gradient, as a strain.
pub(super) const ROUNDING_OF_F: f64 = 16.0 * f64::EPSILON;
/// Zero increment: the same formula at the same strain.
pub(super) const ZERO_INCREMENT: f64 = 1e-12;
/// 1 against 1000 increments if the law claims exactness.
pub(super) const PATH_EXACT: f64 = 1e-12;
/// Rounding of a stress that is a small difference of elastic stresses, relative to those.
pub(super) const CANCELLATION: f64 = 1e-15;
/// Same components computed by two stress states.
pub(super) const AGREEMENT: f64 = 1e-9;
/// A plane-stress iteration stops at this share of the elastic stress.
pub(super) const PLANE_STRESS_ITERATION: f64 = 1e-12;
/// Energy error relative to the work that a few kinks inside increments of 1/320 leave, even if the law is exact
/// between them: 1/n².
pub(super) const ENERGY_KINKS: f64 = 1e-5;
/// Energy error relative to the work after the finest subdivision: ~1/n² for the trapezoidal rule, 1/n for a
/// law that integrates its dissipation by Euler's rule.
pub(super) const ENERGY: f64 = 2e-2;
/// Halving the increment must reduce the energy error at least by this (first order: 2).
pub(super) const ENERGY_REDUCTION: f64 = 1.6;
/// Dissipation may fall by this share of the work: rounding.
pub(super) const DISSIPATION: f64 = 1e-12;
/// A stress that differs from the elastic one by more than this share of it is not elastic: more than the secant of a
/// thousandth of the step errs.
pub(super) const NONLINEAR: f64 = 1e-4;

//! The constants by which increments and iterations are governed, each with its reason.

// Iterations: when they end.

/// Part of a force that is negligible next to it. A residual so far below its tolerance needs no small correction to prove convergence:
/// linear problems end at once. So much of the largest force scale is the least one, as a fibre that has left carries nothing. So much
/// of what there is to correct along another run may be left.
pub(super) const NEGLIGIBLE: f64 = 1e-4;
/// Corrections are compared with the increment's displacements, or with this part of all so far: a tiny increment
/// after many cuts needs no finer ones than the state that it starts from.
pub(super) const LEAST_RELATIVE_MOVE: f64 = 1e-2;
/// After so many of a kind in a row another way is taken: an attempt whose residual grew in as many iterations is given up; tangents are
/// put in doubt after as many that converge slowly; no more parts of a correction are tried, from a half on; after as many failures
/// something else leads.
pub(super) const PATIENCE: u32 = 4;
/// Iterations in which an increment should have converged. Up to then a correction with which contact opens or closes is applied in full:
/// the residual of what has closed is large, and the next correction knows of it; later ones may go to and fro. Then elements out of
/// balance whose law may soften get their stiffness at frozen damage, and after twice as many the elastic one (doc.md). That of plastic
/// ones is safe, and the elastic one far too stiff where flow spreads. Old factors are used after increments that needed no more.
pub(super) const USUAL_ITERATIONS: usize = 6;
/// Multipliers are updated before the next iteration once the residual is below this part of the force scale. Further off, pressures are not
/// yet those of the increment: with 1 a fibre at 45° with a cover takes 16 % more iterations. With 0 (after convergence alone) a hook takes
/// twice as many.
pub(super) const NEAR: f64 = 1e-2;

// Tangents and factors.

/// Ratio of successive residuals below which no safer stiffness is needed.
pub(super) const SLOW_REDUCTION: f64 = 0.5;
/// Iterations that still converge as slowly as this put tangents in doubt: Newton's method squares what is left.
pub(super) const LINEAR_REDUCTION: f64 = 0.1;
/// Ratio of successive residuals below which an old factor is used again, and the next correction is that part of the last one.
pub(super) const FAST_REDUCTION: f64 = 0.05;
/// Positions are known to a few units of their last place.
pub(super) const POSITION_ROUNDING: f64 = 4.0 * f64::EPSILON;

// How much of a correction is applied.

/// A correction that makes the largest residual grow is kept if it leaves no more than this part of the work of the
/// residuals along it: where plastic flow spreads, the largest residual moves on and grows on the best of paths. Not with
/// contact: at the kinks of its laws such steps go to and fro.
pub(super) const WORK_REDUCTION: f64 = 0.8;
/// Part of the work of the unbalanced forces along a correction, of that at its start, at which the energy is at its minimum along it.
pub(super) const MINIMUM_REACHED: f64 = 0.2;
/// Most trials of a search: of secants for that minimum, of steps of the differences below.
pub(super) const MOST_TRIALS: usize = 10;
/// A secant ends not nearer to the shorter correction than this part of the bracket: beyond a kink the work may be 10⁵ times
/// as large.
pub(super) const LEAST_OF_BRACKET: f64 = 0.1;
/// Step of the differences for derivatives of the dissipation, as part of the last increment.
pub(super) const PROBE: f64 = 1e-4;
/// Least step of these differences, as part of the displacements, which are rounded.
pub(super) const LEAST_PROBE: f64 = 1e-8;
/// Factor by which such a step is longer where nothing loads with it, and drag thicker where an increment goes back on the way of the one
/// before.
pub(super) const LARGER: f64 = 10.0;

// Attempts.

/// Fraction of its increment with which an attempt that did not converge is repeated: an attempt of a whole system is dear, and one
/// half as long seldom converges where this one did not. A material point, whose calls cost little, halves its increments.
pub(super) const CUT: f64 = 0.25;

// Sizes of increments.

/// An increment that needs at most so many iterations is easy.
pub(super) const EASY: usize = 9;
/// An increment that needs more iterations than this is hard.
pub(super) const HARD: usize = 13;
/// Number of easy increments in a row after which the size grows.
pub(super) const STREAK: usize = 2;
/// Factor by which an increment may grow.
pub(super) const GROWTH: f64 = 1.5;
/// Factor by which the increment after a hard one is smaller.
pub(super) const SHRINKAGE: f64 = 0.75;
/// Sums of parts of a step, or of its times, are known to this part of them: a smaller remainder is taken along with an increment, and times that
/// differ by less are the same.
pub(super) const SUMMED: f64 = 1e-9;

// What leads.

/// Part of the usual increment to which increments under the drives are cut where they creep towards a limit point: something else
/// leads then.
pub(super) const CREEPING: f64 = 1e-2;
/// Number of changes of the lead without an accepted increment after which all leads have failed.
pub(super) const LEADS: u32 = 6;
/// Factor by which the usual sizes fade with each increment.
pub(super) const FADING: f64 = 0.8;
/// The first increment of what leads now, as part of the usual one, and the part of the largest under the drives to which its increments must have
/// grown before these lead again: shorter ones would only be cut again.
pub(super) const FIRST_LED: f64 = 0.5;
/// Least increment of a lead, as part of its first one.
pub(super) const LEAST_LED: f64 = 1e-6;
/// An increment led by dissipation grows while the load changes by less than this part of the greatest so far, and
/// shrinks when it changes by twice as much: the path is curved, and its energies are trapezoidal sums. At a load no greater than that
/// the drives lead again after a phase field: a crack that is open grows no more.
pub(super) const LOAD_CHANGE: f64 = 0.02;
/// Usual growth of a phase field, from 0 to 1, in an increment that it leads.
pub(super) const FIELD_GROWTH: f64 = 0.1;
/// Greatest part of a whole in an increment under another lead than the drives: of a phase field, from 0 to 1; of the time left, as the
/// drives lead to the end of a step; of the way left.
pub(super) const LARGEST_PART: f64 = 0.5;
/// After as many increments in a row under another lead in which the drives advanced, they lead again.
pub(super) const ADVANCES_BEFORE_DRIVE_CONTROL: u32 = 5;
/// Where displacements grow so many times faster with the drives than they did in the step, and no equilibrium is found further on, the
/// drives are at a limit point.
pub(super) const LIMIT_POINT: f64 = 10.0;
/// Part of the greatest increment below which increments under the drives have no equilibrium near.
pub(super) const CRAWLING: f64 = 1e-5;
/// Part by which an increment through drag changes things: the drives go this part of the usual increment before drag leads, and the load
/// changes by this part of itself at most, or of the same part of the greatest load: what is dissipated is a trapezoidal sum over the way.
/// Where it falls by more, drag becomes thicker; where it rises, the drives go a shorter way.
pub(super) const THROUGH_DRAG: f64 = 0.1;
/// Factor by which the drives go further before drag leads where the next equilibrium was no better.
pub(super) const LARGER_NUDGE: f64 = 4.0;
/// First resistance of drag, as part of the load over that way of the drives: with some hundred freedoms of contact, drag adds a hundredth to the
/// load.
pub(super) const RESISTANCE: f64 = 1e-5;
/// Greatest resistance, as a multiple of the first.
pub(super) const GREATEST_RESISTANCE: f64 = 1e8;
/// Factor by which the resistance falls after an easy increment.
pub(super) const EASING: f64 = 0.4;
/// Most increments through drag in a row.
pub(super) const MOST_THROUGH: u32 = 1000;
/// After so many turns drag has come as near to equilibrium as it can: between two states to and fro, in neither of which forces balance.
pub(super) const MOST_TURNS: u32 = 20;

// Which increments stand.

/// An increment under the drives may add so much of the work to the imbalance of the energies, which are trapezoidal sums.
pub(super) const ENERGY_TOLERANCE: f64 = 3e-4;
/// Imbalance of energies allowed for all increments together, as part of the work (doc.md). The less of it remains, the
/// less an increment may add. Increments whose size the step chooses keep to it, except for failures and indirect
/// control; equal increments need not.
pub const ENERGY_BUDGET: f64 = 1e-3;
/// Part of the work that stabilisation and the overstress of extrapolating laws may take in a run before a warning.
/// Increments keep to it likewise, except for viscosity, snap-backs and drag, whose share does not depend on their
/// size.
pub const STABILISATION_BUDGET: f64 = 1e-2;
/// Least imbalance or overstress that an increment may always add, as part of its usual share.
pub(super) const LEAST_SHARE: f64 = 0.05;
/// Greatest part of an increment that a repeated one has where its energies miss the work, and to which the resistance of drag falls after
/// an increment that was accepted but not easy.
pub(super) const CAUTIOUS: f64 = 0.7;
/// Overstress cuts increments to this part of the greatest.
pub(super) const LEAST_FOR_OVERSTRESS: f64 = 1.0 / 256.0;
/// Equal increments are not refused for their energies. So many of a step are looked at in smaller ones.
pub(super) const MAX_ENERGY_LOOKS: u32 = 3;
/// The load of neighbours of the peak differs by less than this part of it.
pub(super) const PEAK_RESOLUTION: f64 = 2e-3;
/// A wire breaks at its strength or its elongation within this part of it.
pub(super) const BREAK_RESOLUTION: f64 = 1e-3;
/// The drives move at most so many times as far as in the last increment where dissipation leads: elastic unloading needs
/// next to none of it, and would be taken for the path.
pub(super) const LARGEST_TURN: f64 = 2.0;
/// A load that falls by more than this part of the greatest in one increment, while the drive pulls on, has jumped over a
/// snap-back, which another lead can follow.
pub(super) const LARGEST_FALL: f64 = 0.05;
/// After so many refusals a jump stands, as no lead follows it, and so do energies that miss the work.
pub(super) const MAX_REFUSALS: u32 = 12;
/// Part of an increment that converged but may not stand with which it is tried again: one that jumped, one whose energies are looked at, and
/// by division the resistance of drag.
pub(super) const SMALLER: f64 = 0.3;
/// The part of what an increment may do, in slip or in energies missed, that the next one aims at.
pub(super) const AIM: f64 = 0.9;
/// Least part of the energy that the drives take back which an increment dissipates: less is elastic unloading.
pub(super) const LEAST_DISSIPATION: f64 = 1e-2;
/// The energy error is relative to at least this many times the rounding of the work: rounding is no error. Along another run, a
/// residual so many times smaller than rounding may make it has nothing to correct: so small a difference has been left by the sums of the
/// displacements.
pub(super) const ROUNDINGS: f64 = 1e3;

// The far field.

/// Rings of elements around those that must iterate, so that a zone that grows does not grow at every increment.
pub(super) const ZONE_MARGIN: usize = 1;
/// Rings added around elements that stopped being elastic.
pub(super) const ZONE_GROWTH: usize = 3;
/// A far field of fewer elements than this part of all is not worth a condensation.
pub(super) const LEAST_FAR_FIELD: f64 = 0.3;

// Along another run.

/// Residual that a first correction by the factor of another run may leave: as a part of what there was to correct, since an
/// error of first order adds up where matter softens, and of what rounding may make of a residual, which mostly makes less.
pub(super) const PARALLEL_ROUGH_REMAINDER: [f64; 2] = [1e-6, 0.1];
/// The part of its growth to which the leading quantity is known.
pub(super) const GROWTH_ROUNDING: f64 = 1e-11;
/// Number of factors that go round: as many runs work at a time.
pub(super) const SHARED_FACTORS: usize = 4;

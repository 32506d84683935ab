//! One contact pair: its points from displacements to forces.

use super::bearing;
use super::chain::{Chain, Foot};
use super::exposed::Torn;
use super::history::{History, PointState, PointStatus};
use super::kinematics::Kinematics;
use super::law::{PointLaw, Situation, Tangent};
use super::patch::Scratch;
use super::prediction::GapPrediction;
use super::projection::Projection;
use super::quadrature::ContactPoint;
use crate::assembly::{Location, PointFailure, Setback, USUAL_FRACTION};
use crate::mesh::ElementEdge;
use crate::model::{Bearing, Enforcement, Fit, IncrementContext};
use crate::solver::Blocks;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use umat_abi::law::Request;

/// A weight nearer to 1 than this is 1: the last point of a slave edge that ends with the master.
const WEIGHT_ROUNDING: f64 = 1e-9;
/// Part of an edge's length to which a point may lie in the master where it comes over an end: what is deeper met the end's face, or
/// another side of the body.
const ENTERS: f64 = 0.5;

/// Counts of one evaluation of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Evaluation {
    /// Points evaluated.
    pub points: usize,
    /// Feet that were searched for on the whole master.
    pub searches: usize,
    /// Points that are open now and were not at the last evaluation, or the other way round.
    pub changes: usize,
}

/// Forces and blocks to which an evaluation adds, and the results requested of it.
pub(super) struct Output<'a> {
    pub request: Request,
    pub forces: &'a mut [f64],
    pub blocks: &'a mut Blocks,
}

/// A pair with its points' history.
#[derive(Debug)]
pub(super) struct Pair {
    pub name: String,
    pub chain: Chain,
    pub points: Vec<ContactPoint>,
    pub law: PointLaw,
    pub enforcement: Enforcement,
    pub penalty: f64,
    pub critical_slip: f64,
    pub state: PairState,
    /// Points that share a gap, in order.
    pub patches: Vec<Range<usize>>,
    pub scratch: Scratch,
    pub release: bool,
    pub fit: Fit,
    pub bearing: Option<Bearing>,
    /// Whether feet are looked for from the last ones.
    pub walks: bool,
    /// NSTATV.
    pub state_count: usize,
    /// Gaps of the patches that are predicted along a correction.
    pub prediction: GapPrediction,
    /// Number of points on the slave surface of the model; the points after them are on surfaces that were exposed
    /// later.
    pub own: usize,
    /// A point of a torn surface, if matter may be torn.
    pub torn: Option<Torn>,
}

/// What is kept of a pair between runs: the history of its points, and what their last evaluation left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PairState {
    /// Edges that came to light, by the releases with which they did.
    pub exposed: Vec<Vec<ElementEdge>>,
    pub committed: History,
    pub trial: History,
    /// Kinematics of the last evaluation; `None`: never evaluated, or released.
    pub kinematics: Vec<Option<Kinematics>>,
    /// ∂(p, τ)/∂(u, s) and dw/ds of the points of their last evaluation.
    pub tangents: Vec<Tangent>,
    pub weight_slopes: Vec<f64>,
    /// ∂t_T/∂s of the points, N/mm, of their last evaluation with tangents.
    pub shear_stiffness: Vec<f64>,
    /// Values of the drive of the interference: committed and on trial.
    pub fitted: [f64; 2],
}

impl Pair {
    /// The points on the slave surface of the model with their states on trial.
    pub fn own_points(&self) -> impl Iterator<Item = (&ContactPoint, &PointState)> {
        self.points.iter().zip(&self.state.trial.points).take(self.own)
    }

    /// Returns the gap of the surfaces at which a point measures 0, mm.
    pub fn datum(&self, index: usize) -> f64 {
        let ContactPoint { start_gap, overlap, .. } = self.points[index];
        start_gap + self.state.fitted[1] * overlap - self.state.committed.points[index].crushed
    }

    /// w and dw/ds at an arc length.
    pub fn weight(&self, index: usize, arc_length: f64) -> (f64, f64) {
        if !self.release || self.chain.closed {
            return (1.0, 0.0);
        }
        let ContactPoint { length, length_before, .. } = self.points[index];
        let clip = |share: f64, slope: f64| match share {
            share if share >= 1.0 - WEIGHT_ROUNDING => (1.0, 0.0),
            share if share <= 0.0 => (0.0, 0.0),
            share => (share, slope),
        };
        let (end, end_slope) = clip((self.chain.length - arc_length + length_before) / length, -1.0 / length);
        let (start, start_slope) = clip((arc_length + length - length_before) / length, 1.0 / length);
        (start * end, start_slope * end + start * end_slope)
    }

    /// A point on trial with the energies of the increment.
    pub fn booked(&self, index: usize) -> PointState {
        let (start, mut end) = (&self.state.committed.points[index], self.state.trial.points[index]);
        if !start.gone {
            end.book(start, self.points[index].area);
        }
        end
    }

    /// Evaluates all points; see [`super::Contact::evaluate`].
    pub fn evaluate(
        &mut self,
        position: &impl Fn(usize) -> [f64; 2],
        context: &IncrementContext,
        output: &mut Output<'_>,
    ) -> Result<Evaluation, PointFailure> {
        let mut evaluation = Evaluation::default();
        self.prediction.elsewhere = false;
        for number in 0..self.patches.len() {
            let patch = self.patches[number].clone();
            for index in patch.clone() {
                evaluation.searches += usize::from(self.find_foot(index, position)?);
            }
            let gap = self.mean_gap(patch.clone());
            let asked_at = self.prediction.gap(number, gap);
            self.prediction.elsewhere |= asked_at != gap;
            if patch.len() > 1 {
                patch.clone().for_each(|index| self.press_alone(index, gap));
            }
            for index in patch.clone() {
                let Some(kinematics) = self.state.kinematics[index] else { continue };
                evaluation.points += 1;
                let is_beyond = self.state.committed.points[index].is_beyond();
                let is_open = |status| status == PointStatus::Open || is_beyond && status == PointStatus::Released;
                let was_open = is_open(self.state.trial.points[index].status);
                self.advance(index, &kinematics, [gap, asked_at], context)
                    .map_err(|failure| failure.at(self.place(index, kinematics.position)))?;
                self.crush_alone(index);
                evaluation.changes += usize::from(was_open != is_open(self.state.trial.points[index].status));
            }
            self.add(patch, gap, output);
        }
        Ok(evaluation)
    }

    fn place(&self, index: usize, position: [f64; 2]) -> Location {
        Location::Contact { pair: self.name.clone(), point: index, position }
    }

    /// Kinematics, foot, slip and weight of a point on trial; whether its foot was searched for on the whole master.
    fn find_foot(&mut self, index: usize, position: &impl Fn(usize) -> [f64; 2]) -> Result<bool, PointFailure> {
        let start = &self.state.committed.points[index];
        if start.gone {
            self.state.kinematics[index] = None;
            return Ok(false);
        }
        let is_beyond = start.is_beyond();
        let at = self.points[index].slave.position(position);
        let (kinematics, foot, searched) = match self.project(index, at, position) {
            // nothing is lost that was never touched
            Err(_) if is_beyond || start.apart => {
                self.state.kinematics[index] = None;
                self.state.trial.points[index] = self.state.committed.points[index];
                return Ok(false);
            }
            found => found.map_err(|lost| lost.at(self.place(index, at)))?,
        };
        let (weight, slope) = self.weight(index, kinematics.arc_length);
        if is_beyond && (weight == 0.0 || self.lies_too_deep(index, &kinematics)) {
            self.stay_beyond(index, foot, &kinematics);
            return Ok(searched);
        }
        self.state.kinematics[index] = Some(kinematics);
        self.state.weight_slopes[index] = slope;
        let datum = self.datum(index);
        let (start, end) = (&self.state.committed.points[index], &mut self.state.trial.points[index]);
        (end.foot, end.weight, end.slip) = (foot, weight, kinematics.arc_length - start.origin);
        (end.origin, end.apart) = (start.origin, start.apart);
        (end.own_gap, end.lean) = (kinematics.gap - datum, kinematics.lean);
        end.largest_slip = start.largest_slip.max(end.slip.abs());
        Ok(searched)
    }

    /// Returns whether a point past an end lies deeper in the master than what comes over its end: it was not pressed in from
    /// the master's side.
    fn lies_too_deep(&self, index: usize, kinematics: &Kinematics) -> bool {
        kinematics.gap - self.datum(index) < -ENTERS * self.points[index].edge_length
    }

    /// Keeps a point past an end of the master: what it has slid does not change until it comes back.
    fn stay_beyond(&mut self, index: usize, foot: Foot, kinematics: &Kinematics) {
        self.state.kinematics[index] = None;
        let start = &self.state.committed.points[index];
        let own_gap = kinematics.gap - self.datum(index);
        let origin = kinematics.arc_length - start.slip;
        let lean = kinematics.lean;
        self.state.trial.points[index] = PointState { foot, origin, own_gap, gap: own_gap, lean, ..*start };
    }

    /// Foot, gap and slip of a point, and whether its foot was searched for on the whole master.
    fn project(
        &self,
        index: usize,
        at: [f64; 2],
        position: &impl Fn(usize) -> [f64; 2],
    ) -> Result<(Kinematics, Foot, bool), Setback> {
        let lost = |reason: &str| Setback { reason: reason.to_owned(), fraction: Some(USUAL_FRACTION) };
        let projection = Projection { chain: &self.chain, position };
        let of = |foot: Foot| Kinematics::new(&self.chain, &self.points[index].slave, foot, position);
        let last = self.state.committed.points[index].foot;
        let near = projection.near(at, last);
        if self.walks
            && let Some(foot) = near
            && let Ok(kinematics) = of(foot)
        {
            return Ok((kinematics, foot, false));
        }
        let mut foot = projection.anywhere(at).ok_or_else(|| lost("the point has no foot on the master"))?;
        foot.edge = self.same_round(foot.edge, last.edge);
        // the same foot to the last bit, where the way from the last one ends at it too
        foot = near.filter(|near| (near.edge, near.corner) == (foot.edge, foot.corner)).unwrap_or(foot);
        of(foot).map(|kinematics| (kinematics, foot, true)).map_err(lost)
    }

    /// The edge of a closed chain in the round that is nearest to where the point was.
    fn same_round(&self, edge: i64, last: i64) -> i64 {
        let count = self.chain.len() as i64;
        if self.chain.closed { edge + count * (last - edge + count / 2).div_euclid(count) } else { edge }
    }

    /// The law of a point whose foot was found, into its trial state and tangent: asked at one gap, and from there along
    /// its tangent to the gap that is.
    fn advance(
        &mut self,
        index: usize,
        kinematics: &Kinematics,
        [gap, asked_at]: [f64; 2],
        context: &IncrementContext,
    ) -> Result<(), Setback> {
        if self.state.committed.points[index].is_beyond() {
            self.enter(index, kinematics)?;
        }
        let Self { points, law, bearing, state, state_count, .. } = self;
        let PairState { committed, trial, tangents, .. } = state;
        let (start, end) = (&committed.points[index], &mut trial.points[index]);
        end.gap = gap;
        let states = index * *state_count..(index + 1) * *state_count;
        let (start_statev, statev) = (&committed.statev[states.clone()], &mut trial.statev[states]);
        if start.apart && (end.weight == 0.0 || asked_at > 0.0) {
            (end.pressure, end.shear, end.held, end.status) = (0.0, 0.0, false, PointStatus::Open);
            (end.origin, end.slip, end.largest_slip) = (kinematics.arc_length, 0.0, 0.0);
            statev.copy_from_slice(start_statev);
            tangents[index] = [[0.0; 2]; 2];
            return Ok(());
        }
        end.apart = false;
        if end.weight == 0.0 {
            (end.pressure, end.shear, end.held, end.status) = (0.0, 0.0, false, PointStatus::Released);
            (end.own_pressure, end.own_energy) = (0.0, start.own_energy);
            (end.plugin_energies, end.normal_energy) = (start.plugin_energies, start.normal_energy);
            statev.copy_from_slice(start_statev);
            tangents[index] = [[0.0; 2]; 2];
            return Ok(());
        }
        let (point, slip) = (&points[index], end.slip);
        let situation = Situation { gap: asked_at, slip, point, index, kinematics, start, start_statev, context };
        tangents[index] = bearing::advance(law, bearing.as_ref(), &situation, end, statev)?;
        let [[by_gap, _], [shear_by_gap, _]] = tangents[index];
        end.pressure += by_gap * (asked_at - gap);
        end.shear += shear_by_gap * (asked_at - gap);
        Ok(())
    }
}

//! One contact pair: its points from displacements to forces.

use super::chain::{Chain, Foot};
use super::history::{History, PointState, PointStatus};
use super::kinematics::{Kinematics, MAX_FREEDOMS, NoGap};
use super::law::{LawFailure, PointLaw, Situation, Tangent};
use super::projection::Projection;
use super::quadrature::ContactPoint;
use crate::assembly::{Blocks, IncrementContext, Place, Trouble};
use crate::model::Enforcement;
use umat_abi::law::Request;

/// A weight nearer to 1 than this is 1: the last point of a slave edge that ends with the master.
const WEIGHT_ROUNDING: f64 = 1e-9;
/// What is left of an increment after a point lost the master.
const FRACTION_AFTER_LOSS: f64 = 0.5;

/// What a point's start is measured from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Datum {
    pub gap: f64,
    pub arc_length: f64,
    /// How much of its length lies behind the point in the direction of the master.
    pub behind: f64,
}

/// What one evaluation of a pair did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Evaluation {
    /// Points evaluated.
    pub points: usize,
    /// Feet that were searched for on the whole master.
    pub searches: usize,
    /// Points that are open now and were not at the last evaluation, or the other way round.
    pub changes: usize,
}

/// Where an evaluation adds to, and what it is asked for.
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
    pub committed: History,
    pub trial: History,
    /// Of the last evaluation; `None`: never evaluated, or released.
    pub kinematics: Vec<Option<Kinematics>>,
    /// ∂t_T/∂s of the points, N/mm, of their last evaluation with tangents.
    pub shear_stiffness: Vec<f64>,
    /// Whether all blocks of the last evaluation that made any were symmetric.
    pub symmetric: bool,
    pub release: bool,
    /// Whether feet are looked for from the last ones.
    pub walks: bool,
    pub data: Vec<Datum>,
    /// NSTATV.
    pub state_count: usize,
}

impl Pair {
    /// w and dw/ds at an arc length.
    pub fn weight(&self, index: usize, arc_length: f64) -> (f64, f64) {
        if !self.release || self.chain.is_closed() {
            return (1.0, 0.0);
        }
        let (length, behind) = (self.points[index].length, self.data[index].behind);
        let clip = |share: f64, slope: f64| match share {
            share if share >= 1.0 - WEIGHT_ROUNDING => (1.0, 0.0),
            share if share <= 0.0 => (0.0, 0.0),
            share => (share, slope),
        };
        let (end, end_slope) = clip((self.chain.length() - arc_length + behind) / length, -1.0 / length);
        let (start, start_slope) = clip((arc_length + length - behind) / length, 1.0 / length);
        (start * end, start_slope * end + start * end_slope)
    }

    /// Evaluates all points; see [`super::Contact::evaluate`].
    pub fn evaluate(
        &mut self,
        position: &impl Fn(usize) -> [f64; 2],
        context: &IncrementContext,
        output: &mut Output<'_>,
    ) -> Result<Evaluation, Trouble> {
        let mut evaluation = Evaluation::default();
        self.symmetric |= output.request.wants_tangent();
        for index in 0..self.points.len() {
            if self.committed.points[index].status == PointStatus::Released {
                self.kinematics[index] = None;
                continue;
            }
            evaluation.points += 1;
            let was_open = self.trial.points[index].status == PointStatus::Open;
            let at = self.points[index].slave.position(position);
            let trouble = |(reason, fraction)| Trouble {
                place: Place::Contact { pair: self.name.clone(), point: index, position: at },
                reason,
                fraction,
            };
            let (kinematics, foot, searched) = self.project(index, at, position).map_err(trouble)?;
            evaluation.searches += usize::from(searched);
            let advanced = self.advance(index, &kinematics, foot, context);
            let (tangent, weight_slope) = advanced.map_err(|failure| Trouble {
                place: Place::Contact { pair: self.name.clone(), point: index, position: at },
                reason: failure.reason,
                fraction: failure.fraction,
            })?;
            evaluation.changes += usize::from(was_open != (self.trial.points[index].status == PointStatus::Open));
            self.kinematics[index] = Some(kinematics);
            self.add(index, &kinematics, &tangent, weight_slope, output);
        }
        Ok(evaluation)
    }

    /// Foot, gap and slip of a point, and whether its foot was searched for on the whole master.
    fn project(
        &self,
        index: usize,
        at: [f64; 2],
        position: &impl Fn(usize) -> [f64; 2],
    ) -> Result<(Kinematics, Foot, bool), (String, Option<f64>)> {
        let lost = |reason: &str| (reason.to_owned(), Some(FRACTION_AFTER_LOSS));
        let projection = Projection { chain: &self.chain, position };
        let of = |foot: Foot| Kinematics::new(&self.chain, &self.points[index].slave, foot, position);
        if self.walks
            && let Some(foot) = projection.near(at, self.committed.points[index].foot)
            && let Ok(kinematics) = of(foot)
        {
            return Ok((kinematics, foot, false));
        }
        let mut foot = projection.anywhere(at).ok_or_else(|| lost("the point has no foot on the master"))?;
        foot.edge = self.same_round(foot.edge, self.committed.points[index].foot.edge);
        of(foot).map(|kinematics| (kinematics, foot, true)).map_err(|no_gap| lost(no_gap.reason()))
    }

    /// The edge of a closed chain in the round that is nearest to where the point was.
    fn same_round(&self, edge: i64, last: i64) -> i64 {
        let count = self.chain.len() as i64;
        if self.chain.is_closed() { edge + count * (last - edge + count / 2).div_euclid(count) } else { edge }
    }

    /// Law and weight of a point, into its trial state; the tangent and dw/ds.
    fn advance(
        &mut self,
        index: usize,
        kinematics: &Kinematics,
        foot: Foot,
        context: &IncrementContext,
    ) -> Result<(Tangent, f64), LawFailure> {
        let (weight, weight_slope) = self.weight(index, kinematics.arc_length);
        let Self { points, data, law, committed, trial, state_count, .. } = self;
        let (start, end) = (&committed.points[index], &mut trial.points[index]);
        let datum = data[index];
        (end.foot, end.weight) = (foot, weight);
        (end.gap, end.slip) = (kinematics.gap - datum.gap, kinematics.arc_length - datum.arc_length);
        end.largest_slip = start.largest_slip.max(end.slip.abs());
        let states = index * *state_count..(index + 1) * *state_count;
        let (start_statev, statev) = (&committed.statev[states.clone()], &mut trial.statev[states]);
        if weight == 0.0 {
            (end.pressure, end.shear, end.held, end.status) = (0.0, 0.0, false, PointStatus::Released);
            (end.plugin_energies, end.normal_energy) = (start.plugin_energies, start.normal_energy);
            statev.copy_from_slice(start_statev);
            return Ok(([[0.0; 2]; 2], 0.0));
        }
        let situation = situation(&points[index], kinematics, index, [end.gap, end.slip], start, start_statev, context);
        Ok((law.advance(&situation, end, statev)?, weight_slope))
    }

    /// Adds a point's forces and its block.
    fn add(
        &mut self,
        index: usize,
        kinematics: &Kinematics,
        tangent: &Tangent,
        weight_slope: f64,
        output: &mut Output<'_>,
    ) {
        let PointState { pressure, shear, weight, .. } = self.trial.points[index];
        let silent = pressure == 0.0 && shear == 0.0 && tangent.iter().flatten().all(|entry| *entry == 0.0);
        if output.request.wants_tangent() {
            self.shear_stiffness[index] = weight * self.points[index].area * tangent[1][1];
        }
        if weight == 0.0 || silent {
            return;
        }
        let (count, freedoms) = (kinematics.freedom_count(), kinematics.freedoms());
        let area = self.points[index].area;
        // What p pushes; penetration and slip by positions.
        let pushed = kinematics.pull.map(|entry| -entry);
        let pressing = kinematics.gap_gradient.map(|entry| -entry);
        let sliding = &kinematics.slip_gradient;
        let force: [f64; MAX_FREEDOMS] = std::array::from_fn(|i| area * (pressure * pushed[i] + shear * sliding[i]));
        for i in 0..count {
            output.forces[freedoms[i]] += weight * force[i];
        }
        if !output.request.wants_tangent() {
            return;
        }
        let [[c_pp, c_ps], [c_sp, c_ss]] = *tangent;
        let mut block = [0.0; MAX_FREEDOMS * MAX_FREEDOMS];
        for i in 0..count {
            for j in 0..count {
                let even = c_pp * (pushed[i] * pressing[j]) + c_ss * (sliding[i] * sliding[j]);
                let coupled = c_ps * pushed[i] * sliding[j] + c_sp * sliding[i] * pressing[j];
                let geometric = kinematics.second_derivative(-pressure, shear, i, j);
                block[i * count + j] =
                    area * weight * (even + coupled + geometric) + weight_slope * force[i] * sliding[j];
            }
        }
        let block = &block[..count * count];
        self.symmetric &= (0..count).all(|i| (0..i).all(|j| block[i * count + j] == block[j * count + i]));
        output.blocks.push(&freedoms[..count], block);
    }
}

impl NoGap {
    /// In words.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Collapsed => "the master edge under it has no length",
            Self::BeyondCentre => "it lies beyond the centre of the master's curvature",
        }
    }
}

/// A point as its law sees it.
pub(super) fn situation<'a>(
    point: &ContactPoint,
    kinematics: &Kinematics,
    index: usize,
    [gap, slip]: [f64; 2],
    start: &'a PointState,
    start_statev: &'a [f64],
    context: &'a IncrementContext,
) -> Situation<'a> {
    Situation {
        gap,
        slip,
        position: kinematics.position,
        foot: kinematics.foot,
        normal: kinematics.normal,
        tangent: kinematics.tangent,
        area: point.area,
        length: point.edge_length,
        number: i32::try_from(index + 1).unwrap_or(i32::MAX),
        start,
        start_statev,
        context,
    }
}

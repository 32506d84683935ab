//! One contact pair: its points from displacements to forces.

use super::chain::{Chain, Foot};
use super::error::ContactError;
use super::history::{History, PointState, PointStatus};
use super::kinematics::{Kinematics, MAX_FREEDOMS, NoGap};
use super::law::{LawFailure, PointLaw, Situation, Tangent};
use super::projection::Projection;
use super::quadrature::{ContactPoint, contact_points};
use crate::assembly::{Blocks, IncrementContext, Place, Trouble};
use crate::mesh::Mesh;
use crate::model::{ContactPair, Enforcement, Width};
use umat_abi::law::Request;

/// Gaps at the start up to this × the contact width (a given one, otherwise the slave edge's length) come from faceted
/// curves: stored and subtracted.
const INITIAL_GAP: f64 = 1e-3;
/// A weight nearer to 1 than this is 1: the last point of a slave edge that ends with the master.
const WEIGHT_ROUNDING: f64 = 1e-9;
/// What is left of an increment after a point lost the master.
const FRACTION_AFTER_LOSS: f64 = 0.5;

/// What a point's start is measured from.
#[derive(Clone, Copy, Debug)]
struct Datum {
    gap: f64,
    arc_length: f64,
    /// How much of its length lies behind the point in the direction of the master.
    behind: f64,
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
    /// Whether all blocks of the last evaluation were symmetric.
    pub symmetric: bool,
    release: bool,
    search: bool,
    data: Vec<Datum>,
    state_count: usize,
}

impl Pair {
    /// A pair of a mesh without displacements.
    ///
    /// # Errors
    /// Everything in [`ContactError`].
    pub fn new(mesh: &Mesh, pair: &ContactPair, moduli: &[f64], search: bool) -> Result<Self, ContactError> {
        check_numbers(pair)?;
        let chain = Chain::new(mesh, &pair.master, &pair.name)?;
        let points = contact_points(mesh, pair, &chain)?;
        let penalty = penalty(mesh, pair, moduli, &points);
        let law = PointLaw::new(pair, penalty)?;
        let state_count = match &law {
            PointLaw::Uinter { call, .. } => call.statev().len(),
            PointLaw::Fric { call, .. } => call.statev().len(),
        };
        let empty = History { points: Vec::new(), statev: vec![0.0; points.len() * state_count] };
        let mut pair_points = Self {
            name: pair.name.clone(),
            chain,
            law,
            enforcement: pair.enforcement,
            penalty,
            critical_slip: pair.critical_slip,
            committed: empty.clone(),
            trial: empty,
            kinematics: vec![None; points.len()],
            symmetric: true,
            release: pair.release,
            search,
            data: Vec::with_capacity(points.len()),
            state_count,
            points,
        };
        for index in 0..pair_points.points.len() {
            pair_points.start_point(mesh, pair, index)?;
        }
        pair_points.trial.points.clone_from(&pair_points.committed.points);
        Ok(pair_points)
    }

    /// Finds where a point starts.
    fn start_point(&mut self, mesh: &Mesh, pair: &ContactPair, index: usize) -> Result<(), ContactError> {
        let position = |node: usize| mesh.nodes()[node];
        let point = self.points[index];
        let at = point.slave.position(&position);
        let no_foot = |reason| ContactError::NoFoot { pair: self.name.clone(), point: index, position: at, reason };
        let projection = Projection { chain: &self.chain, position };
        let foot = projection.anywhere(at).ok_or_else(|| no_foot("no foot on the master"))?;
        let kinematics =
            Kinematics::new(&self.chain, &point.slave, foot, &position).map_err(|no_gap| no_foot(no_gap.reason()))?;
        let width = match pair.width {
            Width::Given(width) => width,
            Width::OfPart => point.edge_length,
        };
        let (gap, allowed) = (kinematics.gap, INITIAL_GAP * width);
        let too_large =
            || ContactError::InitialGap { pair: pair.name.clone(), point: index, position: at, gap, allowed };
        let is_fault = gap.abs() <= allowed;
        if !is_fault && gap < 0.0 {
            return Err(too_large());
        }
        let along = kinematics.tangent[0] * point.direction[0] + kinematics.tangent[1] * point.direction[1] >= 0.0;
        let behind = if along { point.behind } else { point.length - point.behind };
        self.data.push(Datum { gap: if is_fault { gap } else { 0.0 }, arc_length: kinematics.arc_length, behind });
        let (weight, _) = self.weight(index, kinematics.arc_length);
        let mut state = PointState::new(foot, weight);
        state.gap = gap - self.data[index].gap;
        if weight == 0.0 {
            state.status = PointStatus::Released;
        }
        self.committed.points.push(state);
        if !is_fault && self.is_bonded(index, &kinematics, allowed)? {
            return Err(too_large());
        }
        Ok(())
    }

    /// Whether the law would carry tension or shear at a small gap and slip.
    fn is_bonded(&mut self, index: usize, kinematics: &Kinematics, length: f64) -> Result<bool, ContactError> {
        let start = PointState::new(self.committed.points[index].foot, 1.0);
        let context =
            IncrementContext { step: 1, increment: 1, iteration: 1, time_increment: 1.0, ..Default::default() };
        let virgin = vec![0.0; self.state_count];
        let situation = situation(&self.points[index], kinematics, index, [length, length], &start, &virgin, &context);
        let refused =
            |failure: LawFailure| ContactError::Parameters { pair: self.name.clone(), message: failure.reason };
        self.law.is_bonded(&situation, &mut virgin.clone()).map_err(refused)
    }

    /// w and dw/ds at an arc length.
    fn weight(&self, index: usize, arc_length: f64) -> (f64, f64) {
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
        request: Request,
        forces: &mut [f64],
        blocks: &mut Blocks,
    ) -> Result<Evaluation, Trouble> {
        let mut evaluation = Evaluation::default();
        self.symmetric = true;
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
            self.add(index, &kinematics, &tangent, weight_slope, request, forces, blocks);
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
        if self.search
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
        request: Request,
        forces: &mut [f64],
        blocks: &mut Blocks,
    ) {
        let PointState { pressure, shear, weight, .. } = self.trial.points[index];
        let silent = pressure == 0.0 && shear == 0.0 && tangent.iter().flatten().all(|entry| *entry == 0.0);
        if weight == 0.0 || silent {
            return;
        }
        let (count, freedoms) = (kinematics.freedom_count(), kinematics.freedoms());
        let area = self.points[index].area;
        // −∂g/∂x and ∂s/∂x: penetration and slip by positions
        let pressing = kinematics.gap_gradient.map(|entry| -entry);
        let sliding = &kinematics.slip_gradient;
        let force: [f64; MAX_FREEDOMS] = std::array::from_fn(|i| area * (pressure * pressing[i] + shear * sliding[i]));
        for i in 0..count {
            forces[freedoms[i]] += weight * force[i];
        }
        if !request.wants_tangent() {
            return;
        }
        let [[c_pp, c_ps], [c_sp, c_ss]] = *tangent;
        let mut block = [0.0; MAX_FREEDOMS * MAX_FREEDOMS];
        for i in 0..count {
            for j in 0..count {
                let even = c_pp * (pressing[i] * pressing[j]) + c_ss * (sliding[i] * sliding[j]);
                let coupled = c_ps * pressing[i] * sliding[j] + c_sp * sliding[i] * pressing[j];
                let geometric = kinematics.second_derivative(-pressure, shear, i, j);
                block[i * count + j] =
                    area * weight * (even + coupled + geometric) + weight_slope * force[i] * sliding[j];
            }
        }
        let block = &block[..count * count];
        self.symmetric &= (0..count).all(|i| (0..i).all(|j| block[i * count + j] == block[j * count + i]));
        blocks.push(&freedoms[..count], block);
    }
}

impl NoGap {
    fn reason(self) -> &'static str {
        match self {
            Self::Collapsed => "the master edge under it has no length",
            Self::BeyondCentre => "it lies beyond the centre of the master's curvature",
        }
    }
}

fn situation<'a>(
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

/// Numbers of a pair that must be in range.
fn check_numbers(pair: &ContactPair) -> Result<(), ContactError> {
    use crate::model::{ContactLaw, NormalLaw};
    let check = |what, value: f64, fine: bool, rule| {
        let error = ContactError::Value { pair: pair.name.clone(), what, value, rule };
        if fine { Ok(()) } else { Err(error) }
    };
    let positive = |value: f64| value > 0.0 && value.is_finite();
    let not_negative = |value: f64| value >= 0.0 && value.is_finite();
    check("the penalty factor", pair.penalty_factor, positive(pair.penalty_factor), "positive")?;
    check("the critical slip", pair.critical_slip, not_negative(pair.critical_slip), "0 or positive")?;
    if let Width::Given(width) = pair.width {
        check("the contact width", width, positive(width), "positive")?;
    }
    match pair.enforcement {
        Enforcement::Penalty => {}
        Enforcement::Uzawa { tolerance, .. } => check("the gap tolerance", tolerance, positive(tolerance), "positive")?,
        Enforcement::PerturbedLagrangian { ratio } => {
            check("ε'/ε_N", ratio, ratio >= 1e4 && ratio.is_finite(), "at least 1e4")?
        }
    }
    match &pair.law {
        ContactLaw::Fric { normal: NormalLaw::Hard(law), .. } => {
            check("p_0", law.p_0, not_negative(law.p_0), "0 or positive")?;
            check("delta_n", law.delta_n, not_negative(law.delta_n), "0 or positive")
        }
        ContactLaw::Fric { normal: NormalLaw::Soft(law), .. } => {
            check("p_0", law.p_0, positive(law.p_0), "positive")?;
            check("g_0", law.g_0, positive(law.g_0), "positive")
        }
        ContactLaw::Uinter(_) => Ok(()),
    }
}

/// ε_N = f min(E t/h)/width over the edges of both surfaces, MPa/mm: t the depth, h the element's size across the edge.
/// A slave without a width of its own has that of its part, so that t/width is 1 there.
fn penalty(mesh: &Mesh, pair: &ContactPair, moduli: &[f64], points: &[ContactPoint]) -> f64 {
    let sum = |of: fn(&ContactPoint) -> f64| points.iter().map(of).sum::<f64>();
    let width = sum(|point| point.area) / sum(|point| point.length);
    let mut least = f64::INFINITY;
    for &edge in pair.slave.iter().chain(&pair.master) {
        let element = mesh.elements()[edge.element];
        let part = &mesh.parts()[element.part()];
        let ends = mesh.edge_nodes(edge);
        let [start, end] = [0, 1].map(|k| mesh.nodes()[ends.nodes()[k]]);
        let length = (end[0] - start[0]).hypot(end[1] - start[1]);
        // A triangle is twice as high as its mean height.
        let shape = if element.kind().corner_count() == 3 { 2.0 } else { 1.0 };
        let height = shape * mesh.element_area(edge.element) / length;
        let depth = part.model.depth(0.5 * (start[0] + end[0]), part.thickness);
        least = least.min(moduli[element.part()] * depth / height);
    }
    pair.penalty_factor * least / width
}

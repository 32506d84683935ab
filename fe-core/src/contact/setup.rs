//! A pair made from its definition in the model: numbers checked, penalty chosen, every point put on its foot.

use super::chain::Chain;
use super::facets::Facets;
use super::history::{History, PointState, PointStatus};
use super::kinematics::Kinematics;
use super::law::{PointLaw, Situation};
use super::pair::{Pair, PairState};
use super::patch::Scratch;
use super::prediction::GapPrediction;
use super::quadrature::{ContactPoint, contact_points, patches};
use crate::assembly::{Location, Setback};
use crate::mesh::Mesh;
use crate::model::{
    Bearing, ContactLaw, ContactPair, Enforcement, FieldValues, IncrementContext, Interference, ModelError, NormalLaw,
    Width,
};
use crate::plane::{distance, dot};

/// The largest gap and slip at which a law is asked whether it is bonded, as part of an edge.
const BOND_PROBE: f64 = 1e-3;

/// The first slip at which a law is asked for its elastic limit, as part of an edge.
const FIRST_PROBE: f64 = 1e-7;
/// A shear that is on its first line within this is elastic.
const ELASTIC_PROBE: f64 = 1e-6;
/// Halvings by which the limit is found: to a hundredth of itself.
const PROBES: usize = 7;
/// The increment in which a law is asked.
const FIRST: IncrementContext =
    IncrementContext { step: 1, increment: 1, iteration: 1, step_time: 0.0, total_time: 0.0, time_increment: 1.0 };

impl Pair {
    /// A pair of a mesh without displacements.
    pub fn new(
        mesh: &Mesh,
        pair: &ContactPair,
        moduli: &[f64],
        walks: bool,
        initial: &FieldValues,
    ) -> Result<Self, ModelError> {
        check_numbers(pair)?;
        let chain = Chain::new(mesh, &pair.master, &pair.name, pair.master_bends)?;
        let points = contact_points(mesh, pair, &pair.slave, &chain)?;
        let penalty = penalty(mesh, pair, moduli, &points);
        let law = PointLaw::new(pair, penalty, initial)?;
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
            state: PairState {
                exposed: Vec::new(),
                committed: empty.clone(),
                trial: empty,
                kinematics: vec![None; points.len()],
                tangents: vec![[[0.0; 2]; 2]; points.len()],
                weight_slopes: vec![0.0; points.len()],
                shear_stiffness: vec![0.0; points.len()],
                fitted: [0.0; 2],
            },
            patches: patches(&points),
            scratch: Scratch::default(),
            release: pair.release,
            fit: pair.fit,
            bearing: pair.bearing,
            walks,
            state_count,
            prediction: GapPrediction::default(),
            own: points.len(),
            torn: None,
            points,
        };
        let facets = Facets::new(mesh, &pair.slave, &pair.master);
        for index in 0..pair_points.points.len() {
            pair_points.start_point(mesh, &pair.name, &facets, index)?;
        }
        pair_points.share_gaps();
        pair_points.state.trial.points.clone_from(&pair_points.state.committed.points);
        if pair_points.critical_slip == 0.0 {
            pair_points.critical_slip = pair_points.elastic_slip(mesh)?;
        }
        Ok(pair_points)
    }

    /// The slip up to which a virgin point's shear is a straight line, asked of the law itself at gap 0; 0 where it has
    /// none without pressure.
    fn elastic_slip(&mut self, mesh: &Mesh) -> Result<f64, ModelError> {
        let is_closed = |state: &PointState| !matches!(state.status, PointStatus::Released) && state.gap <= 0.0;
        let Some(index) = self.state.committed.points.iter().position(is_closed) else { return Ok(0.0) };
        let position = |node: usize| mesh.nodes()[node];
        let point = self.points[index];
        let foot = self.state.committed.points[index].foot;
        let Ok(kinematics) = Kinematics::new(&self.chain, &point.slave, foot, &position) else { return Ok(0.0) };
        let virgin = vec![0.0; self.state_count];
        let mut shear_at = |slip: f64| {
            let asked = self.ask(index, &kinematics, (PointState::new(foot, 1.0), &virgin), [0.0, slip]);
            asked.map(|(end, _)| end.shear).map_err(|failure| ModelError::of_pair(&self.name, failure.reason))
        };
        let first = FIRST_PROBE * point.edge_length;
        let stiffness = shear_at(first)? / first;
        if stiffness <= 0.0 {
            return Ok(0.0);
        }
        let (mut elastic, mut beyond) = (first, first);
        while beyond < point.edge_length {
            beyond *= 2.0;
            if (shear_at(beyond)? / (stiffness * beyond) - 1.0).abs() > ELASTIC_PROBE {
                break;
            }
            elastic = beyond;
        }
        for _ in 0..PROBES {
            let middle = 0.5 * (elastic + beyond);
            let is_elastic = (shear_at(middle)? / (stiffness * middle) - 1.0).abs() <= ELASTIC_PROBE;
            *(if is_elastic { &mut elastic } else { &mut beyond }) = middle;
        }
        Ok(elastic)
    }

    /// Gives the points of each patch the mean of the gaps that they start with.
    fn share_gaps(&mut self) {
        for patch in &self.patches {
            let points = &mut self.state.committed.points[patch.clone()];
            let areas = self.points[patch.clone()].iter().map(|point| point.area);
            let shares = || areas.clone().zip(points.iter()).map(|(area, state)| (area * state.weight, state.gap));
            let area: f64 = shares().map(|(area, _)| area).sum();
            if area > 0.0 {
                let mean = shares().map(|(area, gap)| area * gap).sum::<f64>() / area;
                points.iter_mut().for_each(|state| state.gap = mean);
            }
        }
    }

    /// Finds where a point starts.
    fn start_point(&mut self, mesh: &Mesh, name: &str, facets: &Facets, index: usize) -> Result<(), ModelError> {
        let position = |node: usize| mesh.nodes()[node];
        let point = self.points[index];
        let at = point.slave.position(&position);
        let wrong = |reason: &str| {
            let place = Location::Contact { pair: name.to_owned(), point: index, position: at };
            ModelError(format!("{place}: {reason}"))
        };
        let (foot, kinematics) = self.over(&point, &position).map_err(wrong)?;
        let (gap, allowed) = (kinematics.gap, facets.allowed(&point, at, foot));
        let too_large = || {
            let open = if gap > 0.0 { "; more may only open a pair that carries neither tension nor bond" } else { "" };
            let limit = format!("up to ±{allowed:.3e} is taken as a fault of the mesh{open}");
            wrong(&format!("its gap is {gap:.3e} mm at the start, {limit}"))
        };
        let is_fault = gap.abs() <= allowed;
        let along = dot(kinematics.tangent, point.direction) >= 0.0;
        let is_pressed_out = matches!(self.fit.interference, Some(Interference { depth: None, .. })) && gap < 0.0;
        let is_closed = is_fault || is_pressed_out || gap.abs() <= self.fit.closes_within;
        let start_gap = if is_closed { gap } else { 0.0 };
        let overlap = match self.fit.interference {
            Some(Interference { depth: Some(depth), .. }) => depth,
            Some(_) if is_pressed_out => -gap,
            _ => 0.0,
        };
        let length_before = if along { point.length_before } else { point.length - point.length_before };
        self.points[index] = ContactPoint { start_gap, overlap, length_before, ..point };
        let (weight, _) = self.weight(index, kinematics.arc_length);
        // past an end there is no surface that it could lie in, or lose its bond to
        let is_over = weight > 0.0;
        if is_over && !is_closed && gap < 0.0 {
            return Err(too_large());
        }
        let mut state = PointState { origin: kinematics.arc_length, ..PointState::new(foot, weight) };
        state.gap = gap - start_gap;
        state.own_gap = state.gap;
        if !is_over {
            state.status = PointStatus::Released;
        }
        self.state.committed.points.push(state);
        if is_over && !is_closed && self.is_bonded(index, &kinematics, gap.min(BOND_PROBE * point.edge_length))? {
            return Err(too_large());
        }
        Ok(())
    }

    /// Returns whether the law would carry tension or shear at a small gap and slip.
    fn is_bonded(&mut self, index: usize, kinematics: &Kinematics, length: f64) -> Result<bool, ModelError> {
        if matches!(&self.law, PointLaw::Fric { normal, .. } if normal.carries_tension()) {
            return Ok(true);
        }
        let start = PointState::new(self.state.committed.points[index].foot, 1.0);
        let virgin = vec![0.0; self.state_count];
        let asked = self.ask(index, kinematics, (start, &virgin), [length, length]);
        let (end, _) = asked.map_err(|failure| ModelError::of_pair(&self.name, failure.reason))?;
        // The soft law of FRIC presses there; what matters is whether a bond would be lost.
        Ok(matches!(self.law, PointLaw::Uinter { .. }) && (end.pressure < 0.0 || end.shear != 0.0))
    }

    /// Asks the law of a point, from a state and STATEV, at a gap and a slip: both then.
    pub(super) fn ask(
        &mut self,
        index: usize,
        kinematics: &Kinematics,
        (start, start_statev): (PointState, &[f64]),
        [gap, slip]: [f64; 2],
    ) -> Result<(PointState, Vec<f64>), Setback> {
        let point = &self.points[index];
        let situation = Situation { gap, slip, point, index, kinematics, start: &start, start_statev, context: &FIRST };
        let (mut end, mut statev) = (start, start_statev.to_vec());
        self.law.advance(&situation, &mut end, &mut statev)?;
        Ok((end, statev))
    }
}

/// Numbers of a pair that must be in range.
fn check_numbers(pair: &ContactPair) -> Result<(), ModelError> {
    let check = |what: &str, value: f64, fine: bool, rule: &str| {
        let reason = format!("{what} is {value}, it must be {rule}");
        if fine { Ok(()) } else { Err(ModelError::of_pair(&pair.name, reason)) }
    };
    let positive = |value: f64| value > 0.0 && value.is_finite();
    let not_negative = |value: f64| value >= 0.0 && value.is_finite();
    check("the penalty factor", pair.penalty_factor, positive(pair.penalty_factor), "positive")?;
    check("the critical slip", pair.critical_slip, not_negative(pair.critical_slip), "0 or positive")?;
    let closes = pair.fit.closes_within;
    check("the gap that is closed", closes, closes >= 0.0, "0 or positive")?;
    if let Some(Interference { depth: Some(depth), .. }) = pair.fit.interference {
        check("the interference", depth, depth.is_finite(), "finite")?;
    }
    if let Some(Bearing { strength, depth }) = pair.bearing {
        check("the bearing strength", strength, positive(strength), "positive")?;
        check("the depth of crushing", depth, not_negative(depth), "0 or positive")?;
    }
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

/// Returns the penalty ε_N = f min(E t/h)/width over the edges of both surfaces, MPa/mm, where t is the depth and h the
/// element's size across the edge. A slave without its own width has that of its part, so that t/width is 1 there.
fn penalty(mesh: &Mesh, pair: &ContactPair, moduli: &[f64], points: &[ContactPoint]) -> f64 {
    let sum = |of: fn(&ContactPoint) -> f64| points.iter().map(of).sum::<f64>();
    let width = sum(|point| point.area) / sum(|point| point.length);
    let mut least = f64::INFINITY;
    for &edge in pair.slave.iter().chain(&pair.master) {
        let element = mesh.elements()[edge.element];
        let model = mesh.parts()[element.part()].model;
        let ends = mesh.edge_nodes(edge);
        let [start, end] = [0, 1].map(|k| mesh.nodes()[ends.nodes()[k]]);
        let length = distance(end, start);
        // A triangle is twice as high as its mean height.
        let height = element.kind().count_in_square() * mesh.element_area(edge.element) / length;
        let depth = model.depth(0.5 * (start[0] + end[0]), element.thickness());
        least = least.min(moduli[element.part()] * depth / height);
    }
    pair.penalty_factor * least / width
}

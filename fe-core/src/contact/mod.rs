#![doc = include_str!("doc.md")]

mod bearing;
mod chain;
mod exposed;
mod facets;
mod history;
mod interference;
mod kinematics;
mod law;
mod normal;
mod pair;
mod patch;
mod prediction;
mod projection;
mod quadrature;
mod settle;
mod setup;
mod state;

pub use history::PointStatus;
pub use pair::Evaluation;
pub use state::ContactState;

use crate::assembly::PointFailure;
use crate::mesh::Mesh;
use crate::model::{ContactPair, FieldValues, IncrementContext, ModelError};
use crate::solver::Blocks;
use history::PointState;
use kinematics::Kinematics;
use pair::{Output, Pair, PairState};
use umat_abi::host::recorder::RecordedArguments;
use umat_abi::law::Request;

/// Where a straight line through the two points of an edge, at ±1/√3, rises from 0, its value at the edge's end over that at the other point.
const AT_EDGE_END: f64 = 1.366_025_403_784_438_6;

#[cfg(test)]
mod test;

/// The contact pairs of a model with the history of their points.
#[derive(Debug)]
pub struct Contact {
    reference: Vec<[f64; 2]>,
    pairs: Vec<Pair>,
    freedoms: Vec<usize>,
    /// Multiplier updates of the increment so far: at balance, between iterations.
    updates: [usize; 2],
    /// Calls of the plugins before the state that was taken over.
    earlier_calls: u64,
}

/// Energies since the start, N·mm: work = stored + dissipated + opening + released, up to the error of the trapezoids.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Work of the tractions on gap and slip, by trapezoids.
    pub work: f64,
    /// Work of pressures on slips where normals are smoothed and lean against their edges: nothing on the mean.
    pub leaning: f64,
    /// Energy stored according to the plugins (SED), over the remaining areas.
    pub plugin_stored: f64,
    /// Energy dissipated according to the plugins (SFD, SPD, SVD, SCD).
    pub plugin_dissipated: f64,
    /// Stored in the host's normal law, and by points that lie deeper than the edge they share a gap with.
    pub normal_stored: f64,
    /// Lost by opening under the host's normal law.
    pub opening: f64,
    /// Stored energy lost at the ends of masters.
    pub released: f64,
}

/// A contact point for output, as of the last evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointRecord<'a> {
    /// Name of the pair.
    pub pair: &'a str,
    /// Index of the point in the pair.
    pub point: usize,
    /// Present position, mm; `None`: not evaluated, past an end of the master, or gone.
    pub position: Option<[f64; 2]>,
    /// Reference arc length along the slave edges in their order, mm.
    pub coordinate: f64,
    /// g_N, mm, > 0 open; what a faceted mesh had at the start is subtracted.
    pub gap: f64,
    /// p, MPa, > 0 compression.
    pub pressure: f64,
    /// g, mm, along the master.
    pub slip: f64,
    /// τ, MPa: resists the slip.
    pub shear: f64,
    /// A_con, mm², of the reference configuration.
    pub area: f64,
    /// w: the part of the area that is still over the master.
    pub weight: f64,
    /// Status of the point.
    pub status: PointStatus,
    /// Whether the host's tension cap was passed.
    pub latched: bool,
    /// STATEV.
    pub statev: &'a [f64],
}

/// A contact point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointIndex {
    /// Index of its pair.
    pub pair: usize,
    /// Index in the pair.
    pub point: usize,
}

impl Contact {
    /// The pairs of a mesh without displacements. `moduli`: an elastic modulus of each part, MPa, for the penalty.
    /// `contact_search`: whether feet are looked for from the last ones. `initial`: temperature and field variables.
    ///
    /// # Errors
    /// The error of the first pair that has one: a master that is no single row of edges, nothing to put points on, a point
    /// without a foot on the master, surfaces that do not lie on each other, a number out of range, an enforcement that the law
    /// cannot have, a law that refuses its parameters or cannot be called.
    ///
    /// # Panics
    /// If `moduli` does not hold one for each part.
    pub fn new(
        mesh: &Mesh,
        pairs: &[ContactPair],
        moduli: &[f64],
        contact_search: bool,
        initial: &FieldValues,
    ) -> Result<Self, ModelError> {
        assert_eq!(moduli.len(), mesh.parts().len(), "one modulus for each part");
        let edges = pairs.iter().flat_map(|pair| pair.slave.iter().chain(&pair.master));
        let mut freedoms = Vec::new();
        exposed::add_freedoms(&mut freedoms, mesh, edges);
        let pairs = pairs.iter().map(|pair| Pair::new(mesh, pair, moduli, contact_search, initial));
        Ok(Self {
            reference: mesh.nodes().to_vec(),
            pairs: pairs.collect::<Result<_, _>>()?,
            freedoms,
            updates: [0; 2],
            earlier_calls: 0,
        })
    }

    /// Indices of all degrees of freedom that contact can touch, ascending.
    pub fn freedoms(&self) -> &[usize] {
        &self.freedoms
    }

    /// ε_N of each pair, MPa/mm.
    pub fn penalties(&self) -> impl Iterator<Item = f64> {
        self.pairs.iter().map(|pair| pair.penalty)
    }

    /// Returns what users should know of how laws are called.
    pub fn remarks(&self) -> impl Iterator<Item = String> {
        let of_pair = |pair: &Pair| Some(format!("contact '{}': {}", pair.name, pair.law.remark()?));
        self.pairs.iter().filter_map(of_pair)
    }

    /// Calls of the plugins so far.
    pub fn law_calls(&self) -> u64 {
        self.earlier_calls + self.pairs.iter().map(|pair| pair.law.calls()).sum::<u64>()
    }

    /// The last call of a pair's law, if it was for this point: the one that failed, where a law did. What the law changes is
    /// as it was at the start.
    pub fn last_call(&self, pair: &str, point: usize) -> Option<RecordedArguments> {
        let pair = self.pairs.iter().find(|other| other.name == pair)?;
        let statev = pair.state.committed.statev.get(point * pair.state_count..(point + 1) * pair.state_count)?;
        pair.law.last_call(point, pair.state.committed.points.get(point)?, statev)
    }

    /// Passes temperature and field variables at the start and at the end of the increment to the laws.
    pub fn set_fields(&mut self, start: &FieldValues, end: &FieldValues) {
        self.pairs.iter_mut().for_each(|pair| pair.law.set_fields(start, end));
    }

    /// Evaluates from the committed state to the end displacements (two per node). Adds the internal contact forces
    /// and, if a tangent is wanted, one block for each patch of points that transmits anything to `blocks`.
    ///
    /// # Errors
    /// A plugin wants a smaller increment or failed, or a point lost its master. Forces and blocks are then incomplete.
    pub fn evaluate(
        &mut self,
        displacements: &[f64],
        context: &IncrementContext,
        request: Request,
        forces: &mut [f64],
        blocks: &mut Blocks,
    ) -> Result<Evaluation, PointFailure> {
        let Self { reference, pairs, .. } = self;
        let position = |node: usize| {
            let [x, y] = reference[node];
            [x + displacements[2 * node], y + displacements[2 * node + 1]]
        };
        let mut all = Evaluation::default();
        let mut output = Output { request, forces, blocks };
        for pair in pairs {
            let evaluation = pair.evaluate(&position, context, &mut output)?;
            all.points += evaluation.points;
            all.searches += evaluation.searches;
            all.changes += evaluation.changes;
        }
        Ok(all)
    }

    /// The increment that was evaluated last is accepted.
    pub fn commit(&mut self) {
        for pair in &mut self.pairs {
            for index in 0..pair.points.len() {
                pair.state.trial.points[index] = pair.booked(index).crushed_for_good();
            }
            pair.state.committed.copy_from(&pair.state.trial);
            pair.state.fitted[0] = pair.state.fitted[1];
        }
        self.updates = [0; 2];
        self.end_prediction();
    }

    /// The attempt is given up: back to the committed state.
    pub fn restore(&mut self) {
        for pair in &mut self.pairs {
            pair.state.trial.copy_from(&pair.state.committed);
            pair.state.fitted[1] = pair.state.fitted[0];
        }
        self.updates = [0; 2];
        self.end_prediction();
    }

    /// Returns how many points have a status after the last evaluation.
    pub fn count(&self, status: PointStatus) -> usize {
        self.pairs
            .iter()
            .flat_map(|pair| &pair.state.trial.points)
            .filter(|state| state.counted_status() == status)
            .count()
    }

    /// Returns how much of the reference length of these pairs is open after the last evaluation, mm.
    pub(crate) fn open_length(&self, pairs: &[usize]) -> f64 {
        let points = pairs.iter().flat_map(|&pair| self.pairs[pair].own_points());
        let open = points.filter(|(_, state)| state.counted_status() == PointStatus::Open);
        // the sum of nothing would be -0
        open.fold(0.0, |sum, (point, _)| sum + point.length)
    }

    /// Energies at the last commit.
    pub fn energies(&self) -> Energies {
        self.energies_of(|pair, index| pair.state.committed.points[index])
    }

    /// Energies if the increment that was evaluated last is accepted.
    pub(crate) fn trial_energies(&self) -> Energies {
        self.energies_of(Pair::booked)
    }

    fn energies_of(&self, state: fn(&Pair, usize) -> PointState) -> Energies {
        let mut sum = Energies::default();
        for pair in &self.pairs {
            for (index, point) in pair.points.iter().enumerate() {
                let state = state(pair, index);
                sum.work += state.work;
                sum.leaning += state.leaning;
                sum.plugin_stored += point.area * state.weight * state.plugin_energies[0];
                sum.plugin_dissipated += state.dissipated;
                sum.normal_stored += point.area * state.weight * (state.normal_energy + state.own_energy);
                sum.opening += state.opening;
                sum.released += state.released;
            }
        }
        sum
    }

    /// All points, pair by pair, as of the last evaluation.
    pub fn points(&self) -> impl Iterator<Item = PointRecord<'_>> {
        self.pairs.iter().flat_map(|pair| {
            let PairState { trial, kinematics, .. } = &pair.state;
            let count = trial.statev.len() / pair.points.len().max(1);
            pair.points.iter().zip(&trial.points).enumerate().map(move |(index, (point, state))| PointRecord {
                pair: &pair.name,
                point: index,
                position: kinematics[index].map(|kinematics| kinematics.position),
                coordinate: point.coordinate,
                gap: state.gap,
                pressure: state.pressure + state.own_pressure,
                slip: state.slip,
                shear: state.shear,
                area: point.area,
                weight: state.weight,
                status: state.counted_status(),
                latched: state.normal.latched,
                statev: &trial.statev[index * count..(index + 1) * count],
            })
        })
    }

    /// Returns the greatest depth to which a surface with a limited pressure has been crushed, at the ends of edges, and yields, mm.
    pub fn crushed(&self) -> f64 {
        let depth_of = |pair: &Pair| {
            let crushed =
                pair.state.committed.points.iter().map(|state| state.crushed + state.turned).fold(0.0, f64::max);
            let yields = pair.bearing.map_or(0.0, |bearing| bearing.strength / pair.penalty);
            AT_EDGE_END * crushed + if crushed > 0.0 { yields } else { 0.0 }
        };
        self.pairs.iter().map(depth_of).fold(0.0, f64::max)
    }

    /// The area-weighted mean of the slips, mm, each pair's taken in the direction in which it slid so far: the two
    /// sides of a fibre run in opposite directions. Released points keep their last slip.
    pub(crate) fn mean_slip(&self) -> f64 {
        let slips = self.pairs.iter().map(|pair| {
            let terms = pair.own_points().map(|(point, state)| point.area * state.slip);
            sliding_direction(pair) * terms.sum::<f64>()
        });
        let areas = self.pairs.iter().flat_map(Pair::own_points).map(|(point, _)| point.area);
        slips.sum::<f64>() / areas.sum::<f64>()
    }

    /// Returns whether there is such a point.
    pub fn has(&self, point: PointIndex) -> bool {
        self.pairs.get(point.pair).is_some_and(|pair| point.point < pair.points.len())
    }

    /// The slip of a point, mm, in the direction in which its pair slid so far.
    ///
    /// # Panics
    ///
    /// If there is no such point.
    pub fn slip_of(&self, point: PointIndex) -> f64 {
        let pair = &self.pairs[point.pair];
        sliding_direction(pair) * pair.state.trial.points[point.point].slip
    }

    /// The derivative of [`Self::slip_of`] along a change of all displacements; 0 of a point without contact.
    ///
    /// # Panics
    ///
    /// If there is no such point.
    pub(crate) fn slip_along(&self, point: PointIndex, change: &[f64]) -> f64 {
        let pair = &self.pairs[point.pair];
        let kinematics = pair.state.kinematics[point.point].as_ref();
        kinematics.map_or(0.0, |kinematics| sliding_direction(pair) * slip_along(kinematics, change))
    }

    /// The point in contact whose slip changes most along a change of all displacements.
    pub(crate) fn fastest_point(&self, change: &[f64]) -> Option<PointIndex> {
        let in_contact =
            self.points_in_contact().map(|(point, kinematics)| (slip_along(kinematics, change).abs(), point));
        in_contact.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, point)| point)
    }

    /// The point in contact whose shear falls most steeply with its slip, if any falls: the one that breaks.
    pub(crate) fn breaking_point(&self) -> Option<PointIndex> {
        let stiffness = |point: PointIndex| self.pairs[point.pair].state.shear_stiffness[point.point];
        let in_contact = self.points_in_contact().map(|(point, _)| point).filter(|point| stiffness(*point) < 0.0);
        in_contact.min_by(|a, b| stiffness(*a).total_cmp(&stiffness(*b)))
    }

    fn points_in_contact(&self) -> impl Iterator<Item = (PointIndex, &Kinematics)> {
        self.pairs.iter().enumerate().flat_map(|(pair, of_pair)| {
            let points = of_pair.state.kinematics.iter().zip(&of_pair.state.trial.points).enumerate();
            points.filter_map(move |(point, (of_point, state))| {
                let kinematics = of_point.as_ref().filter(|_| !state.apart)?;
                Some((PointIndex { pair, point }, kinematics))
            })
        })
    }

    /// The growth |Δg| of the slip in the increment that was evaluated last over max(g_crit, κ/2), κ the largest |g| at the
    /// start: of the closed point where it is greatest; 0 without such a point, and where there is no elastic bond.
    pub(crate) fn largest_slip_growth(&self) -> f64 {
        let mut largest: f64 = 0.0;
        for pair in self.pairs.iter().filter(|pair| pair.critical_slip > 0.0) {
            for (start, end) in pair.state.committed.points.iter().zip(&pair.state.trial.points) {
                // what comes over an end has no bond that increments could miss
                if !start.is_beyond() && !matches!(end.status, PointStatus::Open | PointStatus::Released) {
                    let growth = (end.slip - start.slip).abs();
                    largest = largest.max(growth / pair.critical_slip.max(0.5 * start.largest_slip));
                }
            }
        }
        largest
    }
}

/// ±1: where the points of a pair slid on average, up to the start of the increment if they did.
fn sliding_direction(pair: &Pair) -> f64 {
    let slip = |states: &[history::PointState]| -> f64 {
        pair.points.iter().zip(states).take(pair.own).map(|(point, state)| point.area * state.slip).sum()
    };
    match slip(&pair.state.committed.points) {
        0.0 if slip(&pair.state.trial.points) < 0.0 => -1.0,
        committed if committed < 0.0 => -1.0,
        _ => 1.0,
    }
}

/// The change of a slip along a change of all displacements.
fn slip_along(kinematics: &Kinematics, change: &[f64]) -> f64 {
    kinematics.along(&kinematics.slip_gradient, change)
}

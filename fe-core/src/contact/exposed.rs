//! Surfaces that come to light where a slave body loses matter: contact moves to them.

use super::Contact;
use super::chain::Foot;
use super::history::{PointState, PointStatus};
use super::kinematics::Kinematics;
use super::normal::NormalState;
use super::pair::Pair;
use super::projection::Projection;
use super::quadrature::{ContactPoint, contact_points, patches};
use crate::assembly::Setback;
use crate::mesh::{ElementEdge, Mesh};
use crate::model::{ContactPair, Model, ModelError};
use crate::plane::dot;
use std::collections::BTreeSet;

/// The gap at which no bond is left, as part of an edge.
const FAR: f64 = 1e3;

/// Initial state of a point of a torn surface: matter was there, so that no bond holds it, and no law says otherwise.
#[derive(Clone, Debug)]
pub(super) struct Torn {
    state: PointState,
    statev: Vec<f64>,
}

impl Pair {
    /// Asks the law what is left of a virgin point after an opening that no bond outlasts.
    fn tear(&mut self, mesh: &Mesh) -> Result<(), ModelError> {
        let position = |node: usize| mesh.nodes()[node];
        // an edge on the axis has no points
        let Some((point, virgin)) = self.points.first().zip(self.state.committed.points.first()) else {
            return Ok(());
        };
        let foot = virgin.foot;
        let name = self.name.clone();
        let refused = |reason: String| {
            ModelError::of_pair(&name, format!("at the gap of a surface that was torn free: {reason}"))
        };
        let kinematics = Kinematics::new(&self.chain, &point.slave, foot, &position);
        let kinematics = kinematics.map_err(|reason| refused(reason.to_owned()))?;
        let virgin = (PointState::new(foot, 1.0), vec![0.0; self.state_count]);
        let asked = self.without_bond(0, &kinematics, (virgin.0, &virgin.1));
        let (state, statev) = asked.map_err(|setback| refused(setback.reason))?;
        self.torn = Some(Torn { state: PointState { apart: true, ..state }, statev });
        Ok(())
    }

    /// Asks the law what is left of a point, from a state and STATEV, after an opening that no bond outlasts: both then, open.
    fn without_bond(
        &mut self,
        index: usize,
        kinematics: &Kinematics,
        (start, statev): (PointState, &[f64]),
    ) -> Result<(PointState, Vec<f64>), Setback> {
        let gap = FAR * self.points[index].edge_length;
        let normal = NormalState { latched: true, opening: gap, ..NormalState::default() };
        let start = PointState { normal, ..start };
        let (mut state, statev) = self.ask(index, kinematics, (start, statev), [gap, start.slip])?;
        (state.pressure, state.shear, state.status, state.held) = (0.0, 0.0, PointStatus::Open, false);
        Ok((state, statev))
    }

    /// Takes the bond from a point that comes over an end of the master for the first time since it was past it: no bond outlasts
    /// that, and none has grown on what was never there. It starts open.
    pub(super) fn enter(&mut self, index: usize, kinematics: &Kinematics) -> Result<(), Setback> {
        let start = self.state.committed.points[index];
        if start.status != PointStatus::Released {
            return Ok(());
        }
        let range = index * self.state_count..(index + 1) * self.state_count;
        let statev = self.state.committed.statev[range.clone()].to_vec();
        let (state, statev) = self.without_bond(index, kinematics, (start, &statev))?;
        self.state.committed.points[index] = state;
        self.state.trial.points[index].normal = state.normal;
        self.state.committed.statev[range].copy_from_slice(&statev);
        Ok(())
    }

    /// Adds points on some edges, which start from the state of a torn surface; their places are not known yet.
    ///
    /// # Errors
    /// No matter of this pair may be torn.
    pub fn add_exposed(&mut self, mesh: &Mesh, pair: &ContactPair, edges: Vec<ElementEdge>) -> Result<(), ModelError> {
        let whole = || ModelError::of_pair(&self.name, "no surface of it comes to light");
        let torn = self.torn.as_ref().ok_or_else(whole)?;
        let mut points = contact_points(mesh, pair, &edges, &self.chain)?;
        let before = self.points.iter().map(|point| point.coordinate + point.edge_length).fold(0.0, f64::max);
        for point in &mut points {
            point.coordinate += before;
            point.length_before = 0.5 * point.length;
        }
        let first = self.points.len();
        self.patches.extend(patches(&points).into_iter().map(|patch| patch.start + first..patch.end + first));
        self.points.extend(points);
        let count = self.points.len();
        for history in [&mut self.state.committed, &mut self.state.trial] {
            history.points.resize(count, torn.state);
            history.statev.extend(torn.statev.repeat(count - first));
        }
        self.state.kinematics.resize(count, None);
        self.state.tangents.resize(count, [[0.0; 2]; 2]);
        self.state.weight_slopes.resize(count, 0.0);
        self.state.shear_stiffness.resize(count, 0.0);
        self.state.exposed.push(edges);
        Ok(())
    }

    /// Releases the points on edges of elements that are gone, and adds points on the newly exposed edges that face the
    /// master.
    fn release(
        &mut self,
        mesh: &Mesh,
        pair: &ContactPair,
        covers: &[usize],
        position: &impl Fn(usize) -> [f64; 2],
        is_gone: &impl Fn(usize) -> bool,
    ) {
        for (point, state) in self.points.iter().zip(&mut self.state.committed.points) {
            if point.elements.into_iter().all(is_gone) {
                state.release(point.area);
            }
        }
        let known: BTreeSet<ElementEdge> = self.state.exposed.iter().flatten().copied().collect();
        let edges = exposed(mesh, &pair.slave, covers, is_gone);
        let edges: Vec<ElementEdge> =
            edges.into_iter().filter(|edge| !known.contains(edge) && self.faces(mesh, pair, *edge, position)).collect();
        if self.torn.is_some() && !edges.is_empty() {
            let first = self.points.len();
            self.add_exposed(mesh, pair, edges).expect("points are put on edges as when the pair was made");
            for index in first..self.points.len() {
                let Ok((foot, kinematics)) = self.over(&self.points[index], position) else { continue };
                let state = &mut self.state.committed.points[index];
                (state.foot, state.gap, state.own_gap) = (foot, kinematics.gap, kinematics.gap);
                (state.origin, state.lean) = (kinematics.arc_length, kinematics.lean);
            }
        }
        self.state.trial.copy_from(&self.state.committed);
    }

    /// Returns whether an edge faces the master: the edge lies before it, and the edge's body on the far side.
    fn faces(&self, mesh: &Mesh, pair: &ContactPair, edge: ElementEdge, position: &impl Fn(usize) -> [f64; 2]) -> bool {
        let [start, end] = [0, 1].map(|end| position(mesh.edge_nodes(edge).nodes()[end]));
        // the body is on the left
        let outward = [end[1] - start[1], start[0] - end[0]];
        let Ok(points) = contact_points(mesh, pair, &[edge], &self.chain) else { return false };
        points.iter().all(|point| {
            let over = self.over(point, position);
            over.is_ok_and(|(_, over)| over.gap > 0.0 && dot(over.normal, outward) < 0.0)
        })
    }

    /// Returns the foot of a point on the whole master, and gap and slip there.
    ///
    /// # Errors
    /// The reason why there is none.
    pub(super) fn over(
        &self,
        point: &ContactPoint,
        position: &impl Fn(usize) -> [f64; 2],
    ) -> Result<(Foot, Kinematics), &'static str> {
        let projection = Projection { chain: &self.chain, position };
        let foot = projection.anywhere(point.slave.position(position)).ok_or("no foot on the master")?;
        Ok((foot, Kinematics::new(&self.chain, &point.slave, foot, position)?))
    }
}

/// Returns the edges inside the body that are exposed where elements of a slave surface are gone, ascending. Edges of
/// covers are left out: what slides does so in front of covers, which have no surface for it.
fn exposed(mesh: &Mesh, slave: &[ElementEdge], covers: &[usize], is_gone: &impl Fn(usize) -> bool) -> Vec<ElementEdge> {
    let is_cover = |element: usize| covers.contains(&mesh.elements()[element].part());
    let mut gone: Vec<usize> = slave.iter().map(|edge| edge.element).filter(|&element| is_gone(element)).collect();
    let mut seen: BTreeSet<usize> = gone.iter().copied().collect();
    let mut edges = BTreeSet::new();
    while let Some(element) = gone.pop() {
        for edge in 0..mesh.elements()[element].kind().corner_count() {
            match mesh.neighbour(ElementEdge { element, edge }) {
                Some(other) if is_cover(other.element) => {}
                Some(other) if !is_gone(other.element) => _ = edges.insert(other),
                Some(other) if seen.insert(other.element) => gone.push(other.element),
                _ => {}
            }
        }
    }
    edges.into_iter().collect()
}

/// Adds the freedoms of the nodes of some edges to others; ascending, each once.
pub(super) fn add_freedoms<'e>(freedoms: &mut Vec<usize>, mesh: &Mesh, edges: impl Iterator<Item = &'e ElementEdge>) {
    let nodes = edges.flat_map(|&edge| mesh.edge_nodes(edge).nodes().to_vec());
    freedoms.extend(nodes.flat_map(|node| [2 * node, 2 * node + 1]));
    freedoms.sort_unstable();
    freedoms.dedup();
}

impl Contact {
    /// Asks the laws what is left of their bonds where matter is torn off, so that [`Self::release`] finds it.
    ///
    /// # Errors
    /// A law that does not say.
    pub(crate) fn tear(&mut self, mesh: &Mesh) -> Result<(), ModelError> {
        self.pairs.iter_mut().try_for_each(|pair| pair.tear(mesh))
    }

    /// Releases, after a commit, the points on slave edges of elements that are gone. Contact moves to the newly
    /// exposed edges that face the master.
    pub(crate) fn release(&mut self, model: &Model, displacements: &[f64], is_gone: impl Fn(usize) -> bool) {
        let reference = &self.reference;
        let position = |node: usize| [0, 1].map(|k| reference[node][k] + displacements[2 * node + k]);
        let covers = model.parts_behind();
        for (pair, of_model) in self.pairs.iter_mut().zip(&model.contacts) {
            pair.release(&model.mesh, of_model, &covers, &position, &is_gone);
        }
        self.take_exposed(&model.mesh);
    }

    /// Counts the freedoms of edges that came to light among those of contact.
    pub(super) fn take_exposed(&mut self, mesh: &Mesh) {
        let edges = self.pairs.iter().flat_map(|pair| pair.state.exposed.iter().flatten());
        add_freedoms(&mut self.freedoms, mesh, edges);
    }
}

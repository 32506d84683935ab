//! Torn matter: the elements that no longer carry load, and those that nothing holds once these are gone.

use super::Analysis;
use crate::mesh::{ElementEdge, Mesh, preflight};
use crate::model::Spalling;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Elements that have been released, and those that may be soon.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Spalled {
    /// Elements that are torn, and the slip from which on they were, mm.
    torn: BTreeMap<usize, f64>,
    /// Elements whose forces fade, and the slip at which they were released, mm.
    fading: BTreeMap<usize, f64>,
    /// The greatest slip so far, mm.
    slip: f64,
    /// Reference volume of what was released, mm³, and how far below the exit it reaches, mm.
    pub(super) volume: f64,
    pub(super) depth: f64,
}

impl Analysis<'_> {
    /// Lets forces of released elements fade and releases what is torn for long enough, with what then is loose.
    pub(super) fn spall(&mut self) {
        let Some(spalling) = self.model.controls.spalling else { return };
        let mesh = &self.model.mesh;
        let (solids, spalled) = (&mut self.equilibrium.solids, &mut self.present.spalled);
        let slip = self.model.measured.slip_of(&self.present.committed.drives);
        spalled.slip = spalled.slip.max(slip);
        let slip = spalled.slip;
        spalled.fading.retain(|&element, from| {
            let share = (1.0 - (slip - *from) / spalling.fade).max(0.0);
            solids.set_share(element, share);
            share > 0.0
        });
        let Spalling { opening, stress, wait, .. } = spalling;
        let candidates =
            (0..mesh.elements().len()).filter(|&element| solids.damages(element) && !solids.is_spalled(element));
        let torn = candidates.filter(|&element| solids.is_torn(element, opening, stress));
        let since = torn.map(|element| (element, spalled.torn.get(&element).copied().unwrap_or(slip)));
        spalled.torn = since.collect();
        let (mut gone, torn): (BTreeMap<_, _>, _) = spalled.torn.iter().partition(|(_, from)| slip - **from >= wait);
        if gone.is_empty() {
            return;
        }
        spalled.torn = torn;
        let solids = &self.equilibrium.solids;
        let loose = self.loose(|element| solids.is_spalled(element) || gone.contains_key(&element));
        gone.extend(loose.into_iter().map(|element| (element, slip)));
        self.release(gone.into_keys().collect(), slip);
    }

    /// Releases elements at a slip.
    fn release(&mut self, elements: Vec<usize>, slip: f64) {
        let mesh = &self.model.mesh;
        let measured = &self.model.measured;
        let along = |[x, y]: [f64; 2]| x * measured.direction[0] + y * measured.direction[1];
        let exit = measured.exit_node.or(measured.fibres.first().map(|fibre| fibre.exit_node));
        let face = exit.map(|node| along(mesh.nodes()[node]));
        let (solids, spalled) = (&self.equilibrium.solids, &mut self.present.spalled);
        for &element in &elements {
            spalled.torn.remove(&element);
            spalled.fading.insert(element, slip);
            spalled.volume +=
                (0..solids.point_count(element)).map(|point| solids.point(element, point).volume).sum::<f64>();
            let lowest = mesh.elements()[element].nodes().iter().map(|&node| along(mesh.nodes()[node]));
            let lowest = lowest.fold(f64::INFINITY, f64::min);
            spalled.depth = spalled.depth.max(face.map_or(0.0, |face| face - lowest));
        }
        self.equilibrium.release(&elements, &self.present.committed.displacements);
        self.book_energies(self.present.energies.external_work);
    }

    /// The elements that hold on to nothing once others are gone: in pieces that are less than the rest of their body and have
    /// no support.
    pub(super) fn loose(&self, is_gone: impl Fn(usize) -> bool) -> Vec<usize> {
        let mesh = &self.model.mesh;
        let bodies = preflight::bodies(mesh);
        let body_of = |piece: &[usize]| bodies.iter().position(|body| body.elements.binary_search(&piece[0]).is_ok());
        let left = pieces(mesh, is_gone);
        let mut greatest = BTreeMap::new();
        for piece in &left {
            let most = greatest.entry(body_of(piece)).or_insert(0);
            *most = piece.len().max(*most);
        }
        let held: BTreeSet<usize> = self.model.supports.iter().flat_map(|support| &support.nodes).copied().collect();
        let stays = |&element: &usize| {
            let is_held = mesh.elements()[element].nodes().iter().any(|node| held.contains(node));
            is_held || !self.equilibrium.solids.active()[element]
        };
        let is_loose = |piece: &&Vec<usize>| piece.len() < greatest[&body_of(piece)] && !piece.iter().any(stays);
        left.iter().filter(is_loose).flatten().copied().collect()
    }
}

/// The elements that are left, in pieces that hang together by edges; each ascending.
fn pieces(mesh: &Mesh, is_gone: impl Fn(usize) -> bool) -> Vec<Vec<usize>> {
    let mut is_seen: Vec<bool> = (0..mesh.elements().len()).map(is_gone).collect();
    let mut pieces = Vec::new();
    for first in 0..is_seen.len() {
        if std::mem::replace(&mut is_seen[first], true) {
            continue;
        }
        let mut piece = vec![first];
        let mut next = 0;
        while let Some(&element) = piece.get(next) {
            next += 1;
            for edge in 0..mesh.elements()[element].kind().corner_count() {
                if let Some(other) = mesh.neighbour(ElementEdge { element, edge })
                    && !std::mem::replace(&mut is_seen[other.element], true)
                {
                    piece.push(other.element);
                }
            }
        }
        piece.sort_unstable();
        pieces.push(piece);
    }
    pieces
}

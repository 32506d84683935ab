//! Which elements iterate, and which are condensed until their laws say that they are no longer elastic.

use crate::assembly::{Condensation, Equations, Solids, System, loaded_freedoms, may_be_condensed, touching};
use crate::mesh::Mesh;
use crate::model::Model;
use crate::solver::{SolverError, SolverOptions};
use crate::stepping::constants::{LEAST_FAR_FIELD, ZONE_GROWTH, ZONE_MARGIN};
use serde::{Deserialize, Serialize};

/// The elements that iterate.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Zone {
    pub(super) active: Vec<bool>,
    /// Whether the others are condensed.
    pub(super) condenses: bool,
}

impl Zone {
    /// The elements at contact surfaces, at loads, couplings and moving supports, and a margin; all, if condensing is off
    /// or does not pay. A part with large displacements has no linear element, and without contact nothing says where the zone is.
    pub(super) fn new(model: &Model, equations: &Equations, contact: &[usize]) -> Self {
        let mesh = &model.mesh;
        let mut zone = Self { active: vec![true; mesh.elements().len()], condenses: false };
        // RPL is wanted of all points
        if model.skipping.elastic_far_field && !model.contacts.is_empty() && model.field.is_none() {
            let condensable = may_be_condensed(mesh, equations, &loaded_freedoms(model));
            zone.active = touching(mesh, contact);
            let linear = mesh.elements().iter().map(|element| !model.nlgeom[element.part()]);
            let may_be = condensable.into_iter().zip(linear).map(|(condensable, linear)| condensable && linear);
            zone.active.iter_mut().zip(may_be).for_each(|(active, may_be)| *active |= !may_be);
            zone.grow(mesh, ZONE_MARGIN);
            zone.condenses = zone.pays();
        }
        zone
    }

    fn pays(&mut self) -> bool {
        let far = self.active.iter().filter(|active| !**active).count();
        let pays = far as f64 >= LEAST_FAR_FIELD * self.active.len() as f64;
        if !pays {
            self.active.fill(true);
        }
        pays
    }

    fn grow(&mut self, mesh: &Mesh, rings: usize) {
        for _ in 0..rings {
            let mut nodes = vec![false; mesh.nodes().len()];
            for (element, _) in mesh.elements().iter().zip(&self.active).filter(|(_, active)| **active) {
                element.nodes().iter().for_each(|&node| nodes[node] = true);
            }
            for (element, active) in mesh.elements().iter().zip(&mut self.active) {
                *active |= element.nodes().iter().any(|&node| nodes[node]);
            }
        }
    }

    /// Takes in the elements at some freedoms, and a few rings around them; `false` if they are all in already.
    pub(super) fn take_in(&mut self, mesh: &Mesh, freedoms: &[usize]) -> bool {
        let before = self.active.iter().filter(|active| **active).count();
        let mut added = Self { active: touching(mesh, freedoms), condenses: false };
        added.grow(mesh, ZONE_GROWTH);
        self.active.iter_mut().zip(added.active).for_each(|(active, added)| *active |= added);
        self.condenses = self.pays();
        self.active.iter().filter(|active| **active).count() > before
    }

    /// The system of this partition, whose blocks couple these freedoms; the solids' stiffnesses are those of the virgin state, or were.
    pub(super) fn system(
        &self,
        model: &Model,
        equations: Equations,
        coupled: &[usize],
        solids: &Solids,
    ) -> Result<System, SolverError> {
        let condensation =
            self.condenses.then_some(Condensation { elements: solids, active: &self.active, retained: coupled });
        let options = SolverOptions { forgets: !model.skipping.unchanged_elements, ..SolverOptions::default() };
        System::new(&model.mesh, equations, condensation, options)
    }
}

//! The fields of a run.

use super::fields::{Activity, ContactPoint, Fields};
use crate::assembly::Solids;
use crate::contact::PointStatus;
use crate::kinematics::PlaneModel;
use crate::stepping::Snapshot;

impl Fields {
    /// The state at the end of an increment.
    ///
    /// States come under the names of the laws' metadata, followed by their derived outputs; those of a law without
    /// metadata are `sdv1`… The strain 33 of plane stress is not known here. Contact points that have left their master
    /// have no place and are left out.
    pub fn of(snapshot: &Snapshot<'_>) -> Self {
        let (model, solids) = (snapshot.model(), snapshot.solids());
        let mesh = &model.mesh;
        let count = (0..mesh.elements().len()).map(|element| solids.point_count(element)).sum();
        let (mut stresses, mut strains) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut states = Vec::new();
        for (index, element) in mesh.elements().iter().enumerate() {
            let law = &model.laws[element.part()];
            let is_plane_stress = mesh.parts()[element.part()].model == PlaneModel::PlaneStress;
            for point in 0..solids.point_count(index) {
                let view = solids.point(index, point);
                let [e11, e22, e33, g12] = view.strain;
                stresses.push(view.stress);
                strains.push([e11, e22, if is_plane_stress { f64::NAN } else { e33 }, g12]);
                states.extend_from_slice(view.statev);
                states.extend(law.law.iter().flat_map(|law| &law.derived).map(|derived| derived.value(view.statev)));
            }
        }
        Self {
            time: snapshot.time(),
            scalar: snapshot.field().zip(model.field.as_ref()).map(|(values, field)| (field.name().to_owned(), values)),
            displacements: snapshot.displacements().to_vec(),
            reactions: snapshot.reactions(),
            stresses,
            strains,
            states,
            state_names: model.laws.iter().map(|law| law.state_names()).collect(),
            pairs: model.contacts.iter().map(|pair| pair.name.clone()).collect(),
            contact: contact_points(snapshot),
            activities: (0..mesh.elements().len()).map(|element| activity(solids, element)).collect(),
            behind: model.parts_behind(),
        }
    }
}

fn activity(solids: &Solids, element: usize) -> Activity {
    if solids.is_spalled(element) {
        Activity::Spalled
    } else if solids.has_failed(element) {
        if solids.damages(element) { Activity::Damaged } else { Activity::Yielded }
    } else if solids.active()[element] {
        Activity::Elastic
    } else {
        Activity::Condensed
    }
}

/// The contact points of all pairs that have a place.
pub fn contact_points(snapshot: &Snapshot<'_>) -> Vec<ContactPoint> {
    let pairs = &snapshot.model().contacts;
    let points = snapshot.contact().points().filter_map(|point| {
        Some(ContactPoint {
            pair: pairs.iter().position(|pair| pair.name == point.pair)?,
            position: point.position?,
            arc: point.coordinate,
            gap: point.gap,
            pressure: point.pressure,
            slip: point.slip,
            shear_traction: point.shear,
            open: point.status == PointStatus::Open,
            weight: point.weight,
        })
    });
    points.collect()
}

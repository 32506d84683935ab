//! Fields of a run for ParaView.

use fe_core::contact::PointStatus;
use fe_core::model::{Model, PluginLaw};
use fe_core::output::{ContactPoint, Fields, Series};
use fe_core::stepping::Snapshot;
use std::io;
use std::path::Path;

/// Writes the fields of increments beside the history.
#[derive(Debug)]
pub struct FieldWriter {
    series: Series,
    state_names: Vec<Vec<String>>,
    pairs: Vec<String>,
}

impl FieldWriter {
    /// Into `fields/` of a folder, indexed by `fields.pvd`.
    ///
    /// # Errors
    /// The folder cannot be made.
    pub fn create(folder: &Path, model: &Model) -> io::Result<Self> {
        Ok(Self {
            series: Series::create(folder, &model.mesh).map_err(io::Error::other)?,
            state_names: model.laws.iter().map(state_names).collect(),
            pairs: model.contacts.iter().map(|pair| pair.name.clone()).collect(),
        })
    }

    /// Adds an increment.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&mut self, snapshot: &Snapshot<'_>) -> io::Result<()> {
        let reactions = snapshot.reactions();
        let fields = fields(snapshot, &reactions, &self.state_names, &self.pairs);
        self.series.write(&fields).map_err(io::Error::other)
    }
}

/// Names of a law's states and derived outputs: those of its metadata, or `sdv1`…
fn state_names(law: &PluginLaw) -> Vec<String> {
    let described = law.law.iter().flat_map(|law| &law.states).map(|state| state.name.clone());
    let count = law.law.as_ref().map_or(0, |law| law.states.len());
    let others = (count + 1..=law.nstatv).map(|k| format!("sdv{k}"));
    let derived = law.law.iter().flat_map(|law| &law.derived).map(|derived| derived.name.clone());
    described.chain(others).chain(derived).collect()
}

/// The state of all points, in the mesh's order.
fn fields<'a>(
    snapshot: &Snapshot<'a>,
    reactions: &'a [f64],
    state_names: &'a [Vec<String>],
    pairs: &'a [String],
) -> Fields<'a> {
    let (model, solids) = (snapshot.model(), snapshot.solids());
    let mesh = &model.mesh;
    let (mut stresses, mut strains, mut states) = (Vec::new(), Vec::new(), Vec::new());
    for (index, element) in mesh.elements().iter().enumerate() {
        let law = &model.laws[element.part()];
        for point in 0..solids.point_count(index) {
            let view = solids.point(index, point);
            stresses.push(view.stress);
            strains.push(view.strain);
            states.extend_from_slice(view.statev);
            states.extend(law.law.iter().flat_map(|law| &law.derived).map(|derived| derived.value(view.statev)));
        }
    }
    let contact = snapshot.contact().points().filter_map(|point| {
        Some(ContactPoint {
            pair: pairs.iter().position(|name| name == point.pair)?,
            // a point that was released is nowhere
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
    Fields {
        mesh,
        time: snapshot.time(),
        displacements: snapshot.displacements(),
        reactions,
        stresses,
        strains,
        states,
        state_names,
        pairs,
        contact: contact.collect(),
    }
}

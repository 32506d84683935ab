//! State of a model at the end of an increment.

use crate::mesh::Mesh;
use serde::{Deserialize, Serialize};

/// The state of a model at one time.
///
/// Values at integration points come element by element, point by point within the element, in the mesh's order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Fields {
    /// Total time, s.
    pub time: f64,
    /// The scalar field by its name, one value per node, NaN where it has none.
    #[serde(default)]
    pub scalar: Option<(String, Vec<f64>)>,
    /// Displacements, two per node, mm.
    pub displacements: Vec<f64>,
    /// Forces of supports on the nodes, two per node, N; 0 at free nodes.
    pub reactions: Vec<f64>,
    /// Cauchy stresses at the points: 11, 22, 33, 12, MPa; 33 is 0 in plane stress.
    pub stresses: Vec<[f64; 4]>,
    /// Strains at the points: 11, 22, 33 and the engineering shear 12; 33 is NaN where it is unknown.
    pub strains: Vec<[f64; 4]>,
    /// State variables and derived outputs at the points: as many at each as the element's part has names.
    pub states: Vec<f64>,
    /// Names, of each part.
    pub state_names: Vec<Vec<String>>,
    /// Names of the contact pairs.
    pub pairs: Vec<String>,
    /// The contact points of all pairs.
    pub contact: Vec<ContactPoint>,
    /// Activity of each element.
    pub activities: Vec<Activity>,
    /// Parts in front of which others slide ([`crate::model::Model::parts_behind`]).
    pub behind: Vec<usize>,
}

/// Activity of an element at one time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Activity {
    /// Part of the condensed far field: elastic, and not computed.
    Condensed,
    /// Computed; none of its points has dissipated.
    Elastic,
    /// A point of a law with damage has dissipated.
    Damaged,
    /// A point of a law without damage has dissipated.
    Yielded,
    /// Torn and released.
    Spalled,
}

/// A contact point at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactPoint {
    /// Index of its pair.
    pub pair: usize,
    /// Present position, mm.
    pub position: [f64; 2],
    /// Arc length along the slave surface in the reference configuration, mm.
    pub arc: f64,
    /// g_N, mm: positive where open.
    pub gap: f64,
    /// Contact pressure, MPa: positive in compression.
    pub pressure: f64,
    /// Slip, mm.
    pub slip: f64,
    /// Tangential traction, MPa: the bond.
    pub shear_traction: f64,
    /// Whether it is open.
    pub open: bool,
    /// The weight w of its area: 1, fading to 0 as it leaves the master surface.
    pub weight: f64,
}

/// Message that fields do not belong to their mesh.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FieldsError(String);

impl Fields {
    /// Checks all lengths.
    ///
    /// # Errors
    ///
    /// The first vector that does not fit the mesh, or a contact point without a pair.
    pub fn check(&self, mesh: &Mesh) -> Result<(), FieldsError> {
        expect_length("displacements", self.displacements.len(), 2 * mesh.nodes().len())?;
        expect_length("reactions", self.reactions.len(), 2 * mesh.nodes().len())?;
        expect_length("lists of state names", self.state_names.len(), mesh.parts().len())?;
        if let Some((name, values)) = &self.scalar {
            expect_length(name, values.len(), mesh.nodes().len())?;
        }
        let counts = |element: usize| mesh.integration_points(element).len();
        let points = (0..mesh.elements().len()).map(counts).sum();
        expect_length("stresses", self.stresses.len(), points)?;
        expect_length("strains", self.strains.len(), points)?;
        let states = mesh.elements().iter().enumerate();
        let states = states.map(|(index, element)| counts(index) * self.state_names[element.part()].len()).sum();
        expect_length("state variables", self.states.len(), states)?;
        expect_length("activities", self.activities.len(), mesh.elements().len())?;
        let count = self.pairs.len();
        match self.contact.iter().zip(1..).find(|(point, _)| point.pair >= count) {
            Some((&ContactPoint { pair, .. }, point)) => {
                Err(FieldsError(format!("contact point {point} belongs to pair {}, there are {count}", pair + 1)))
            }
            None => Ok(()),
        }
    }

    /// The different names of state variables, part by part.
    pub fn distinct_state_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for name in self.state_names.iter().flatten() {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        names
    }

    /// A state variable at all points; NaN in the parts that do not have it. The fields must have passed [`Self::check`] with
    /// this mesh.
    pub fn state(&self, mesh: &Mesh, name: &str) -> Vec<f64> {
        let places: Vec<Option<usize>> =
            self.state_names.iter().map(|names| names.iter().position(|other| other == name)).collect();
        let mut values = Vec::with_capacity(self.stresses.len());
        let mut start = 0;
        for (index, element) in mesh.elements().iter().enumerate() {
            let count = self.state_names[element.part()].len();
            for _ in mesh.integration_points(index) {
                values.push(places[element.part()].map_or(f64::NAN, |place| self.states[start + place]));
                start += count;
            }
        }
        values
    }
}

pub(super) fn expect_length(what: &str, found: usize, expected: usize) -> Result<(), FieldsError> {
    if found != expected {
        return Err(FieldsError(format!("there are {found} {what}, the mesh needs {expected}")));
    }
    Ok(())
}

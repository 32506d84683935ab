#![doc = include_str!("doc.md")]

mod conversion;
mod element_type;
mod error;
mod file;
mod source;

#[cfg(test)]
mod test;

pub use error::GmshError;

use std::collections::BTreeMap;
use std::path::Path;

use super::MeshDefinition;
use crate::element::Integration;
use crate::kinematics::PlaneModel;

/// Properties of a part that a mesh file does not contain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartProperties {
    /// Assumption about the third direction.
    pub model: PlaneModel,
    /// Reference thickness, mm; unused in axial symmetry.
    pub thickness: f64,
    /// The integration of all its elements; `None`: each kind's default.
    pub integration: Option<Integration>,
}

/// Reads the bytes of a mesh file, which messages call `path`; `parts` has the properties of each physical surface by its name.
/// Beside the mesh: the file's tags of the elements that went clockwise there and are turned round.
///
/// # Errors
///
/// The first fault of the file with its place; all names that the file or `parts` lacks at once.
pub fn read(
    path: &Path,
    bytes: &[u8],
    parts: &BTreeMap<String, PartProperties>,
) -> Result<(MeshDefinition, Vec<u64>), GmshError> {
    let mut source = source::Source::new(bytes);
    let file = file::File::read(&mut source).map_err(|trouble| source.error(path, trouble))?;
    conversion::mesh_definition(&file, parts).map_err(|(place, fault)| match place {
        Some(position) => source.error(path, (position, fault)),
        None => GmshError(format!("{}: {fault}", path.display())),
    })
}

#![doc = include_str!("doc.md")]

mod conversion;
mod element_type;
mod file;
mod source;

#[cfg(test)]
mod test;

use std::path::Path;

use super::{MeshDefinition, MeshError, Part};

/// Reads the bytes of a mesh file, which messages call `path`; `parts` are its physical surfaces, in any order. Returns
/// the mesh and the file's tags of clockwise elements, whose nodes are reversed.
///
/// # Errors
///
/// The first fault of the file with its place; all names that the file or `parts` lacks at once.
pub fn read(path: &Path, bytes: &[u8], parts: &[Part]) -> Result<(MeshDefinition, Vec<u64>), MeshError> {
    let mut source = source::MeshReader::new(bytes);
    let file = file::File::read(&mut source).map_err(|trouble| source.error(path, trouble))?;
    conversion::mesh_definition(&file, parts).map_err(|(place, fault)| match place {
        Some(position) => source.error(path, (position, fault)),
        None => MeshError(format!("{}: {fault}", path.display())),
    })
}

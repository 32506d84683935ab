//! A run as a series of VTK files.

use super::fields::{Activity, ContactPoint, Fields, FieldsError};
use super::principal::{Principal, von_mises};
use super::recovery::Recovery;
use super::vtu::{Array, Grid, VERTEX};
use crate::mesh::{Element, Mesh};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};

const VECTOR: [&str; 3] = ["x", "y", "z"];
/// The order of VTK's symmetric tensors.
const STRESS: [&str; 6] = ["s11", "s22", "s33", "s12", "s23", "s13"];
const STRAIN: [&str; 4] = ["e11", "e22", "e33", "g12"];

/// Writes increments to `fields/000000.vtu`, … and lists them in `fields.pvd`.
///
/// The first file of an increment holds the solids on their reference positions. Parts that others slide in front of
/// are set back from the plane by half of their thickness. Where parts share a node the file has a point for each of
/// them. Point data: `node`, `displacement`, `reaction`, `stress`, `principal_stress_max`, `_mid`, `_min`,
/// `principal_direction`, `von_mises`, `strain`, the scalar field (`phase_field` or `temperature`), and each state
/// variable by its name (NaN in parts without it). Cells are the elements that were not torn off. Cell data: `part`,
/// `element` and `thickness` (meaningless in axial symmetry). Numbers count from 1; field data name them
/// (`part fibre`).
///
/// The second file, `contact_000000.vtu`, part 1 of the series, holds the contact points at their present positions:
/// `pair`, `arc`, `gap`, `pressure`, `slip`, `bond_traction`, `open`, `weight`. A model without contact pairs has none.
///
/// A file appears under its name only when it is complete, and in the list only after that: a killed run leaves a
/// series that can be opened.
#[derive(Debug)]
pub struct Series {
    directory: PathBuf,
    pub(super) recovery: Recovery,
    files: SeriesFiles,
}

/// The files of a series so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SeriesFiles {
    /// Entries of each data set: time, part of the series, file.
    entries: Vec<(f64, usize, String)>,
    written: usize,
}

impl SeriesFiles {
    /// Returns the names, in the order in which they were written.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().map(|(_, _, name)| name.as_str())
    }
}

impl Series {
    /// A series of this mesh in a folder that is made if missing. Files of an earlier series are replaced one by one.
    ///
    /// # Errors
    ///
    /// The folder cannot be made.
    pub fn create(directory: &Path, mesh: &Mesh) -> io::Result<Self> {
        let folder = directory.join("fields");
        std::fs::create_dir_all(&folder).map_err(failed(&folder))?;
        let (directory, recovery) = (directory.to_owned(), Recovery::new(mesh));
        Ok(Self { directory, recovery, files: SeriesFiles::default() })
    }

    /// Continues a series after these files; later ones are removed.
    ///
    /// # Errors
    ///
    /// The folder cannot be made, or a file not be written or removed.
    pub fn resume(directory: &Path, mesh: &Mesh, files: SeriesFiles) -> io::Result<Self> {
        let series = Self { files, ..Self::create(directory, mesh)? };
        series.replace("fields.pvd", Ok(series.list().into_bytes()))?;
        let later = (series.files.written..).map(|number| names(number).map(|name| directory.join(name)));
        for paths in later.take_while(|paths| paths.iter().any(|path| path.exists())) {
            for path in paths.into_iter().filter(|path| path.exists()) {
                std::fs::remove_file(&path).map_err(failed(&path))?;
            }
        }
        Ok(series)
    }

    /// The files so far.
    pub fn files(&self) -> &SeriesFiles {
        &self.files
    }

    /// Adds an increment, on the mesh that the series was made for.
    ///
    /// # Errors
    ///
    /// The fields do not fit the mesh, or a file cannot be written.
    pub fn write(&mut self, mesh: &Mesh, fields: &Fields) -> io::Result<()> {
        fields.check(mesh).map_err(io::Error::other)?;
        let [file, contact_file] = names(self.files.written);
        self.replace(&file, solids(mesh, fields, &self.recovery).map_err(io::Error::other)?.bytes())?;
        self.files.entries.push((fields.time, 0, file));
        if !fields.pairs.is_empty() {
            self.replace(&contact_file, contact(fields).bytes())?;
            self.files.entries.push((fields.time, 1, contact_file));
        }
        self.files.written += 1;
        self.replace("fields.pvd", Ok(self.list().into_bytes()))
    }

    /// Writes a temporary file in the same folder and renames it.
    fn replace(&self, file: &str, content: io::Result<Vec<u8>>) -> io::Result<()> {
        let path = self.directory.join(file);
        let partial = path.with_extension("partial");
        let written = content
            .and_then(|content| std::fs::write(&partial, content))
            .and_then(|()| std::fs::rename(&partial, &path));
        if written.is_err() {
            let _ = std::fs::remove_file(&partial);
        }
        written.map_err(failed(&path))
    }

    fn list(&self) -> String {
        let mut xml = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
        );
        for (time, part, file) in &self.files.entries {
            // writing to a String cannot fail
            let _ = writeln!(xml, "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{file}\"/>");
        }
        xml.push_str("</Collection>\n</VTKFile>\n");
        xml
    }
}

/// Adds the place to what went wrong there.
fn failed(path: &Path) -> impl FnOnce(io::Error) -> io::Error {
    move |error| io::Error::other(format!("{}: {error}", path.display()))
}

/// The files of an increment: of solids and of contact.
fn names(number: usize) -> [String; 2] {
    [format!("fields/{number:06}.vtu"), format!("fields/contact_{number:06}.vtu")]
}

/// The bodies.
fn solids(mesh: &Mesh, fields: &Fields, recovery: &Recovery) -> Result<Grid, FieldsError> {
    let vectors = |values: &[f64]| -> Vec<[f64; 3]> {
        recovery.nodes().iter().map(|&node| [values[2 * node], values[2 * node + 1], 0.0]).collect()
    };
    let stresses = recovery.recover(&fields.stresses)?;
    let principal: Vec<Principal> = stresses.iter().map(|&stress| Principal::new(stress)).collect();
    let tensors: Vec<[f64; 6]> = stresses.iter().map(|&[a, b, c, d]| [a, b, c, d, 0.0, 0.0]).collect();
    let directions: Vec<[f64; 3]> = principal.iter().map(Principal::direction).collect();
    let mut point_data = vec![
        Array::numbers("node", recovery.nodes().iter().copied()),
        Array::tuples("displacement", &VECTOR, &vectors(&fields.displacements)),
        Array::tuples("reaction", &VECTOR, &vectors(&fields.reactions)),
        Array::tuples("stress", &STRESS, &tensors),
        Array::scalars("principal_stress_max", principal.iter().map(|p| p.maximum)),
        Array::scalars("principal_stress_mid", principal.iter().map(|p| p.middle)),
        Array::scalars("principal_stress_min", principal.iter().map(|p| p.minimum)),
        Array::tuples("principal_direction", &VECTOR, &directions),
        Array::scalars("von_mises", stresses.iter().map(|&stress| von_mises(stress))),
        Array::tuples("strain", &STRAIN, &recovery.recover(&fields.strains)?),
    ];
    if let Some((name, values)) = &fields.scalar {
        point_data.push(Array::scalars(name, recovery.nodes().iter().map(|&node| values[node])));
    }
    for name in fields.distinct_state_names() {
        // a law's own "stress" must not replace the stress
        let taken = point_data.iter().any(|array| array.name == name);
        let shown = if taken { format!("state_{name}") } else { name.to_owned() };
        point_data.push(Array::scalars(shown, recovery.recover_limited(mesh, &fields.state(mesh, name))?));
    }
    // without what was torn off
    let shown: Vec<usize> =
        (0..mesh.elements().len()).filter(|&element| fields.activities[element] != Activity::Spalled).collect();
    let elements = || shown.iter().map(|&index| &mesh.elements()[index]);
    let (mut connectivity, mut offsets) = (Vec::new(), Vec::new());
    for &index in &shown {
        connectivity.extend(recovery.of_element(index).iter().map(|&place| place as i64));
        offsets.push(connectivity.len() as i64);
    }
    Ok(Grid {
        time: fields.time,
        numbers: numbers("part", mesh.parts().iter().map(|part| part.name.as_str())),
        points: std::iter::zip(recovery.nodes(), recovery.parts())
            .map(|(&node, part)| {
                let [x, y] = mesh.nodes()[node];
                let is_behind = fields.behind.contains(part);
                [x, y, if is_behind { -0.5 * mesh.parts()[*part].thickness } else { 0.0 }]
            })
            .collect(),
        connectivity,
        offsets,
        types: elements().map(|element| element.kind().vtk_type()).collect(),
        point_data,
        cell_data: vec![
            Array::numbers("part", elements().map(Element::part)),
            Array::numbers("element", shown.iter().copied()),
            Array::scalars("thickness", elements().map(Element::thickness)),
        ],
    })
}

/// The contact points, as vertices.
fn contact(fields: &Fields) -> Grid {
    let points = &fields.contact;
    let count = points.len() as i64;
    let scalars = |name, value: fn(&ContactPoint) -> f64| Array::scalars(name, points.iter().map(value));
    Grid {
        time: fields.time,
        numbers: numbers("pair", fields.pairs.iter().map(String::as_str)),
        points: points.iter().map(|&ContactPoint { position: [x, y], .. }| [x, y, 0.0]).collect(),
        connectivity: (0..count).collect(),
        offsets: (1..=count).collect(),
        types: vec![VERTEX; points.len()],
        point_data: vec![
            Array::numbers("pair", points.iter().map(|point| point.pair)),
            scalars("arc", |point| point.arc),
            scalars("gap", |point| point.gap),
            scalars("pressure", |point| point.pressure),
            scalars("slip", |point| point.slip),
            scalars("bond_traction", |point| point.shear_traction),
            Array::switches("open", points.iter().map(|point| point.open)),
            scalars("weight", |point| point.weight),
        ],
        cell_data: Vec::new(),
    }
}

/// "part fibre" is 1, and so on.
fn numbers<'n>(what: &str, names: impl Iterator<Item = &'n str>) -> Vec<(String, i32)> {
    names.zip(1..).map(|(name, number)| (format!("{what} {name}"), number)).collect()
}

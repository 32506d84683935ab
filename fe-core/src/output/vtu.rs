//! Unstructured grids as VTK XML files: Float64, little endian, each array compressed by zlib and appended as it is.
//!
//! The crates that write this format name no components and leave out the counts of an empty piece, without which no
//! reader takes the file; what is needed of it is these few lines.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::fmt::Write as _;
use std::io::{self, Write as _};

/// A named array of tuples.
pub(super) struct Array {
    pub name: String,
    /// A name for each component; one empty name for a scalar.
    components: &'static [&'static str],
    /// VTK's name of its numbers.
    kind: &'static str,
    /// The numbers, tuple by tuple.
    bytes: Vec<u8>,
}

/// A grid with data.
pub(super) struct Grid {
    pub time: f64,
    /// Numbers that the arrays refer to, by name: field data, for not every reader takes text.
    pub numbers: Vec<(String, i32)>,
    /// (x, y, z) point by point.
    pub points: Vec<[f64; 3]>,
    /// Points of the cells, cell by cell.
    pub connectivity: Vec<i64>,
    /// End of each cell in `connectivity`.
    pub offsets: Vec<i64>,
    /// VTK's type of each cell.
    pub types: Vec<u8>,
    pub point_data: Vec<Array>,
    pub cell_data: Vec<Array>,
}

/// VTK's number of a vertex.
pub(super) const VERTEX: u8 = 1;

impl Array {
    /// One real number per tuple.
    pub(super) fn scalars(name: impl Into<String>, data: impl IntoIterator<Item = f64>) -> Self {
        let bytes = data.into_iter().flat_map(f64::to_le_bytes).collect();
        Self { name: name.into(), components: &[""], kind: "Float64", bytes }
    }

    /// The number of each index, as people count.
    pub(super) fn numbers(name: &str, indices: impl IntoIterator<Item = usize>) -> Self {
        let bytes = indices.into_iter().flat_map(|index| (index as i32 + 1).to_le_bytes()).collect();
        Self { name: name.into(), components: &[""], kind: "Int32", bytes }
    }

    /// Whether something holds, per tuple.
    pub(super) fn switches(name: &str, data: impl IntoIterator<Item = bool>) -> Self {
        Self { name: name.into(), components: &[""], kind: "UInt8", bytes: data.into_iter().map(u8::from).collect() }
    }

    /// Tuples of real numbers.
    pub(super) fn tuples<const N: usize>(
        name: &str,
        components: &'static [&'static str; N],
        data: &[[f64; N]],
    ) -> Self {
        Self { components, ..Self::scalars(name, data.as_flattened().iter().copied()) }
    }

    fn write(&self, file: &mut File) -> io::Result<()> {
        let named: String = match self.components {
            [_] => String::new(),
            several => several.iter().enumerate().map(|(k, name)| format!(" ComponentName{k}=\"{name}\"")).collect(),
        };
        let attributes = format!("NumberOfComponents=\"{}\"{named}", self.components.len());
        file.data_array(self.kind, &escaped(&self.name), &attributes, &self.bytes)
    }
}

impl Grid {
    /// Returns the bytes of the file.
    pub(super) fn bytes(&self) -> io::Result<Vec<u8>> {
        let mut file = File {
            xml: String::from(
                "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
                 header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n<FieldData>\n",
            ),
            appended: Vec::new(),
        };
        file.data_array("Float64", "TimeValue", "NumberOfTuples=\"1\"", &self.time.to_le_bytes())?;
        for (name, number) in &self.numbers {
            file.data_array("Int32", &escaped(name), "NumberOfTuples=\"1\"", &number.to_le_bytes())?;
        }
        let (points, cells) = (self.points.len(), self.types.len());
        // writing to a String cannot fail
        let _ = writeln!(
            file.xml,
            "</FieldData>\n<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n<PointData>"
        );
        self.point_data.iter().try_for_each(|array| array.write(&mut file))?;
        file.xml.push_str("</PointData>\n<CellData>\n");
        self.cell_data.iter().try_for_each(|array| array.write(&mut file))?;
        file.xml.push_str("</CellData>\n<Points>\n");
        let positions: Vec<u8> = self.points.iter().flatten().copied().flat_map(f64::to_le_bytes).collect();
        file.data_array("Float64", "Points", "NumberOfComponents=\"3\"", &positions)?;
        file.xml.push_str("</Points>\n<Cells>\n");
        for (name, numbers) in [("connectivity", &self.connectivity), ("offsets", &self.offsets)] {
            let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
            file.data_array("Int64", name, "", &bytes)?;
        }
        file.data_array("UInt8", "types", "", &self.types)?;
        file.xml.push_str("</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
        let mut bytes = file.xml.into_bytes();
        bytes.append(&mut file.appended);
        bytes.extend_from_slice(b"\n</AppendedData>\n</VTKFile>\n");
        Ok(bytes)
    }
}

/// A file being written: the header that gives the places of arrays, and the arrays.
struct File {
    xml: String,
    appended: Vec<u8>,
}

impl File {
    /// Adds an array as one block: how many blocks there are, their size, that of a last smaller one (none), the compressed
    /// size, and the data. An array of nothing has no block.
    fn data_array(&mut self, kind: &str, name: &str, attributes: &str, bytes: &[u8]) -> io::Result<()> {
        let offset = self.appended.len();
        let _ = writeln!(
            self.xml,
            "<DataArray type=\"{kind}\" Name=\"{name}\" {attributes} format=\"appended\" offset=\"{offset}\"/>"
        );
        let mut count = |number: usize| self.appended.extend_from_slice(&(number as u64).to_le_bytes());
        if bytes.is_empty() {
            [0; 3].into_iter().for_each(count);
            return Ok(());
        }
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(bytes)?;
        let block = encoder.finish()?;
        [1, bytes.len(), 0, block.len()].into_iter().for_each(&mut count);
        self.appended.extend_from_slice(&block);
        Ok(())
    }
}

/// Text inside an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

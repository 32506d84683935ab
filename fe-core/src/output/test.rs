use super::principal::von_mises;
use super::*;
use crate::element::{ElementKind, Integration, MappedPoint};
use crate::kinematics::PlaneModel;
use crate::mesh::{ElementDefinition, Mesh, MeshDefinition, Part};
use approx::assert_abs_diff_eq;
use std::io::Read as _;
use std::path::Path;

/// Place on a grid of half an element's side, by reference coordinates.
type Map = fn([f64; 2]) -> [f64; 2];

/// Two parts side by side on shared nodes, each of 2×2 elements of a kind with 2 triangles in place of a quadrilateral;
/// inner nodes are moved, so that elements are distorted.
fn two_parts(kind: ElementKind, integration: Integration) -> Mesh {
    let mut nodes = Vec::new();
    for row in 0..5 {
        for column in 0..9 {
            let (x, y) = (0.5 * f64::from(column), 0.5 * f64::from(row));
            let bend = 0.04 * (x * (4.0 - x) * y * (2.0 - y)).sin();
            nodes.push([x + bend, y - 0.5 * bend]);
        }
    }
    let node = |column: usize, row: usize| row * 9 + column;
    let mut elements = Vec::new();
    for (column, row) in (0..4).flat_map(|column| (0..2).map(move |row| (2 * column, 2 * row))) {
        let grid = |[i, j]: [usize; 2]| node(column + i, row + j);
        // a square, or two triangles along its diagonal
        let maps: &[Map] = match kind.corner_count() {
            3 => &[|[xi, eta]| [2.0 * (xi + eta), 2.0 * eta], |[xi, eta]| [2.0 * xi, 2.0 * (xi + eta)]],
            _ => &[|[xi, eta]| [xi + 1.0, eta + 1.0]],
        };
        for map in maps {
            let nodes =
                kind.reference_coordinates().iter().map(|&place| grid(map(place).map(|x| x as usize))).collect();
            elements.push(ElementDefinition { kind, part: column / 4, nodes });
        }
    }
    let part = |name: &str| Part { integration: Some(integration), ..Part::new(name, PlaneModel::PlaneStrain, 1.0) };
    Mesh::new(MeshDefinition {
        nodes,
        parts: vec![part("fibre"), part("matrix")],
        elements,
        ..MeshDefinition::default()
    })
    .unwrap()
}

const RULES: [(ElementKind, Integration); 5] = [
    (ElementKind::T3, Integration::Full),
    (ElementKind::T6, Integration::Full),
    (ElementKind::Q4, Integration::Full),
    (ElementKind::Q8, Integration::Reduced),
    (ElementKind::Q8, Integration::Full),
];

/// A field's value at every integration point, from the position and the reference coordinates.
fn at_points<T>(mesh: &Mesh, field: impl Fn(usize, [f64; 2], [f64; 2]) -> T) -> Vec<T> {
    let mut values = Vec::new();
    for element in 0..mesh.elements().len() {
        let (positions, count) = mesh.element_positions(element);
        for point in mesh.integration_points(element) {
            let kind = mesh.elements()[element].kind();
            let mapped = MappedPoint::new(kind, &positions[..count], point.coordinates).unwrap();
            values.push(field(element, mapped.position, point.coordinates));
        }
    }
    values
}

#[test]
fn each_element_recovers_the_polynomials_of_its_points() {
    type Polynomial = fn([f64; 2]) -> f64;
    let constant: Polynomial = |_| -2.5;
    let linear: Polynomial = |[x, y]| 1.0 - 3.0 * x + 0.7 * y;
    let bilinear: Polynomial = |[x, y]| 0.3 + x - 2.0 * y + 1.7 * x * y;
    let biquadratic: Polynomial = |[x, y]| 0.3 + x * x - 2.0 * y + 1.7 * x * y * y - 0.9 * (x * y).powi(2);
    for ((kind, integration), polynomial) in RULES.into_iter().zip([constant, linear, bilinear, bilinear, biquadratic])
    {
        // one element: there is nothing to average
        let nodes = kind.reference_coordinates().to_vec();
        let element = ElementDefinition { kind, part: 0, nodes: (0..nodes.len()).collect() };
        let parts = vec![Part { integration: Some(integration), ..Part::new("one", PlaneModel::PlaneStress, 1.0) }];
        let definition = MeshDefinition { nodes, parts, elements: vec![element], ..MeshDefinition::default() };
        let mesh = Mesh::new(definition).unwrap();
        let values = at_points(&mesh, |_, _, reference| [polynomial(reference)]);
        let nodal = Recovery::new(&mesh).recover(&values).unwrap();
        for (value, &node) in nodal.iter().zip(kind.reference_coordinates()) {
            assert_abs_diff_eq!(value[0], polynomial(node), epsilon = 2e-14);
        }
    }
}

#[test]
fn a_linear_field_is_recovered_on_distorted_meshes_and_stays_apart_between_parts() {
    let field = |part: usize, [x, y]: [f64; 2]| if part == 0 { 2.0 + x - 3.0 * y } else { 100.0 - 4.0 * x + y };
    for (kind, integration) in RULES {
        // one point holds no linear field, and bilinear extrapolation holds it only where the map is bilinear
        if kind == ElementKind::T3 || (kind, integration) == (ElementKind::Q8, Integration::Reduced) {
            continue;
        }
        let mesh = match kind {
            ElementKind::T6 => straightened(two_parts(kind, integration)),
            _ => two_parts(kind, integration),
        };
        let values = at_points(&mesh, |element, position, _| [field(mesh.elements()[element].part(), position)]);
        let recovery = Recovery::new(&mesh);
        let nodal = recovery.recover(&values).unwrap();
        let places = &recovery;
        for (place, value) in nodal.iter().enumerate() {
            let exact = field(places.parts()[place], mesh.nodes()[places.nodes()[place]]);
            assert_abs_diff_eq!(value[0], exact, epsilon = 2e-12);
        }
        let limited = recovery.recover_limited(&mesh, values.as_flattened()).unwrap();
        let range = |part| {
            let own = |&(element, _): &(usize, &[f64; 1])| mesh.elements()[element].part() == part;
            let element_of = at_points(&mesh, |element, _, _| element);
            let inside = element_of.into_iter().zip(&values).filter(own).map(|(_, value)| value[0]);
            inside.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)))
        };
        let ranges = [range(0), range(1)];
        for ((value, free), &part) in limited.iter().zip(&nodal).zip(places.parts()) {
            assert_eq!(*value, free[0].clamp(ranges[part].0, ranges[part].1));
        }
    }
}

/// Returns the mesh with every middle node in the middle of its edge.
fn straightened(mesh: Mesh) -> Mesh {
    let mut nodes = mesh.nodes().to_vec();
    for edge in mesh.edges() {
        if let [start, end, middle] = *mesh.edge_nodes(edge).nodes() {
            nodes[middle] = [0, 1].map(|k| 0.5 * (mesh.nodes()[start][k] + mesh.nodes()[end][k]));
        }
    }
    let elements = mesh.elements().iter();
    let elements =
        elements.map(|e| ElementDefinition { kind: e.kind(), part: e.part(), nodes: e.nodes().to_vec() }).collect();
    Mesh::new(MeshDefinition { nodes, parts: mesh.parts().to_vec(), elements, ..MeshDefinition::default() }).unwrap()
}

#[test]
fn nodes_are_means_over_the_elements_of_their_part() {
    let mesh = two_parts(ElementKind::T3, Integration::Full);
    let recovery = Recovery::new(&mesh);
    let values = at_points(&mesh, |element, _, _| [element as f64]);
    let nodal = recovery.recover(&values).unwrap();
    let places = &recovery;
    for place in 0..nodal.len() {
        let (node, part) = (places.nodes()[place], places.parts()[place]);
        let elements = mesh.elements().iter().enumerate();
        let own: Vec<f64> =
            elements.filter(|(_, e)| e.part() == part && e.nodes().contains(&node)).map(|(i, _)| i as f64).collect();
        assert_abs_diff_eq!(nodal[place][0], own.iter().sum::<f64>() / own.len() as f64, epsilon = 1e-13);
    }
    // 5 rows of corners would be 15 + 15 with the shared column twice: 3 rows × 5 columns + 3
    assert_eq!(nodal.len(), 18);
}

#[test]
fn a_nan_spoils_only_the_nodes_of_its_element() {
    let mesh = two_parts(ElementKind::Q8, Integration::Reduced);
    let recovery = Recovery::new(&mesh);
    let mut values = vec![0.25; 32];
    values[5] = f64::NAN;
    let nodal = recovery.recover_limited(&mesh, &values).unwrap();
    let spoiled = recovery.of_element(1);
    for (place, value) in nodal.iter().enumerate() {
        assert!(
            if spoiled.contains(&place) { value.is_nan() } else { (value - 0.25).abs() < 1e-15 },
            "{place}: {value}"
        );
    }
}

#[test]
fn principal_stresses_are_eigenvalues_along_their_direction() {
    let stresses = [
        [3.0, -1.0, 0.5, 2.0],
        [-5.0, -4.0, 2.0, 1.0],
        [1.0, 1.0, 1.0, 0.0],
        [0.0, 2.0, 0.0, 0.0],
        [-1.0, -2.0, -9.0, -0.3],
    ];
    for stress in stresses {
        let [s11, s22, s33, s12] = stress;
        let principal = Principal::new(stress);
        let [x, y, z] = principal.direction();
        let product = [s11 * x + s12 * y, s12 * x + s22 * y, s33 * z];
        for (component, unit) in product.into_iter().zip([x, y, z]) {
            assert_abs_diff_eq!(component, principal.maximum * unit, epsilon = 1e-14);
        }
        let (a, b, c) = (principal.maximum, principal.middle, principal.minimum);
        assert!(a >= b && b >= c);
        assert_abs_diff_eq!(a + b + c, s11 + s22 + s33, epsilon = 1e-14);
        assert_abs_diff_eq!(a * b * c, (s11 * s22 - s12 * s12) * s33, epsilon = 1e-13);
        let deviator = (0.5 * ((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2))).sqrt();
        assert_abs_diff_eq!(von_mises(stress), deviator, epsilon = 1e-14);
    }
    assert!(Principal::new([1.0, f64::NAN, 0.0, 0.0]).maximum.is_nan());
    assert_eq!(Principal::new([0.0, 2.0, 0.0, 0.0]).angle, std::f64::consts::FRAC_PI_2);
}

/// A state of the mesh in which every value identifies its place.
struct Snapshot {
    displacements: Vec<f64>,
    names: Vec<Vec<String>>,
    pairs: Vec<String>,
}

impl Snapshot {
    fn new(mesh: &Mesh) -> Self {
        let displacements = mesh.nodes().iter().flat_map(|&[x, y]| [1e-3 * x, 1e-3 * (y - x)]).collect();
        let names = vec![vec![], vec!["D_t".into(), "strain".into()]];
        Self { displacements, names, pairs: vec!["upper & \"lower\"".into()] }
    }

    fn fields(&self, mesh: &Mesh, time: f64) -> Fields {
        let stresses = at_points(mesh, |_, [x, y], _| [x, y, time, x - y]);
        let states = at_points(mesh, |element, [x, _], _| match mesh.elements()[element].part() {
            0 => vec![],
            _ => vec![x / 10.0, 7.0],
        });
        let point = |k: usize| ContactPoint {
            pair: 0,
            position: [0.1 * k as f64, 1.0],
            arc: k as f64,
            gap: 1e-4,
            pressure: -3.0,
            slip: 0.02,
            shear_traction: 5.5,
            open: k == 1,
            weight: 1.0,
        };
        Fields {
            time,
            scalar: None,
            displacements: self.displacements.clone(),
            reactions: self.displacements.clone(),
            strains: stresses.clone(),
            stresses,
            states: states.concat(),
            state_names: self.names.clone(),
            activities: vec![Activity::Elastic; mesh.elements().len()],
            behind: Vec::new(),
            pairs: self.pairs.clone(),
            contact: (0..3).map(point).collect(),
        }
    }
}

/// A file's XML without what is appended, and that.
struct Vtu {
    text: String,
    appended: Vec<u8>,
}

impl Vtu {
    fn read(path: &Path) -> Self {
        const MARK: &[u8] = b"<AppendedData encoding=\"raw\">\n_";
        let content = std::fs::read(path).unwrap();
        let place = content.windows(MARK.len()).position(|window| window == MARK).unwrap();
        let end = b"\n</AppendedData>\n</VTKFile>\n";
        let appended = content[place + MARK.len()..].strip_suffix(end).unwrap().to_vec();
        let text = String::from_utf8(content[..place].to_vec()).unwrap() + "</VTKFile>";
        Self { text, appended }
    }

    fn document(&self) -> roxmltree::Document<'_> {
        roxmltree::Document::parse(&self.text).unwrap()
    }

    /// The bytes of an array.
    fn bytes(&self, name: &str) -> Vec<u8> {
        let document = self.document();
        assert_eq!(document.root_element().attribute("compressor"), Some("vtkZLibDataCompressor"));
        let array = document.descendants().find(|node| node.attribute("Name") == Some(name)).unwrap();
        let start: usize = array.attribute("offset").unwrap().parse().unwrap();
        let count = |k: usize| {
            let at = start + 8 * k;
            u64::from_le_bytes(self.appended[at..at + 8].try_into().unwrap()) as usize
        };
        if count(0) == 0 {
            return Vec::new();
        }
        assert_eq!([count(0), count(2)], [1, 0], "one block, and none smaller");
        let mut bytes = Vec::new();
        let block = &self.appended[start + 32..start + 32 + count(3)];
        flate2::read::ZlibDecoder::new(block).read_to_end(&mut bytes).unwrap();
        assert_eq!(bytes.len(), count(1));
        bytes
    }

    fn reals(&self, name: &str) -> Vec<f64> {
        self.bytes(name).as_chunks::<8>().0.iter().map(|&chunk| f64::from_le_bytes(chunk)).collect()
    }

    fn integers(&self, name: &str) -> Vec<i64> {
        self.bytes(name).as_chunks::<8>().0.iter().map(|&chunk| i64::from_le_bytes(chunk)).collect()
    }
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

/// Parts that others slide in front of are set back by half of their thickness; cells hold their thickness.
#[test]
fn parts_behind_others_lie_behind_the_plane() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = two_parts(ElementKind::T6, Integration::Full);
    let snapshot = Snapshot::new(&mesh);
    let fields = Fields { behind: vec![1], ..snapshot.fields(&mesh, 0.0) };
    let mut series = Series::create(folder.path(), &mesh).unwrap();
    series.write(&mesh, &fields).unwrap();
    let vtu = Vtu::read(&folder.path().join("fields/000000.vtu"));
    let points = vtu.reals("Points");
    for (place, &part) in series.recovery.parts().iter().enumerate() {
        let expected = if part == 1 { -0.5 * mesh.parts()[1].thickness } else { 0.0 };
        assert_eq!(points[3 * place + 2], expected);
    }
    let thicknesses: Vec<f64> = mesh.elements().iter().map(|element| element.thickness()).collect();
    assert_eq!(vtu.reals("thickness"), thicknesses);
}

#[test]
fn a_written_increment_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, integration) in RULES {
        let mesh = two_parts(kind, integration);
        let snapshot = Snapshot::new(&mesh);
        let fields = snapshot.fields(&mesh, 0.5);
        let mut series = Series::create(folder.path(), &mesh).unwrap();
        series.write(&mesh, &fields).unwrap();
        let vtu = Vtu::read(&folder.path().join("fields/000000.vtu"));
        let document = vtu.document();
        let piece = document.descendants().find(|node| node.has_tag_name("Piece")).unwrap();
        let places = &series.recovery;
        let count = places.nodes().len();
        assert_eq!(piece.attribute("NumberOfPoints").unwrap(), count.to_string());
        assert_eq!(piece.attribute("NumberOfCells").unwrap(), mesh.elements().len().to_string());
        assert_eq!(vtu.reals("TimeValue"), [0.5]);

        let number = [(ElementKind::T3, 5), (ElementKind::Q4, 9), (ElementKind::T6, 22), (ElementKind::Q8, 23)];
        let number = number.iter().find(|(of, _)| *of == kind).unwrap().1;
        assert_eq!(vtu.bytes("types"), vec![number; mesh.elements().len()]);
        let (connectivity, offsets) = (vtu.integers("connectivity"), vtu.integers("offsets"));
        let points = vtu.reals("Points");
        let mut start = 0;
        for (element, &end) in mesh.elements().iter().zip(&offsets) {
            let corners = &connectivity[start..end as usize];
            let positions: Vec<[f64; 2]> =
                corners.iter().map(|&c| [points[3 * c as usize], points[3 * c as usize + 1]]).collect();
            let expected: Vec<[f64; 2]> = element.nodes().iter().map(|&node| mesh.nodes()[node]).collect();
            assert_eq!(positions, expected);
            start = end as usize;
        }
        assert_eq!(connectivity.len(), start);

        let displacement = vtu.reals("displacement");
        let (stress, damage) = (vtu.reals("stress"), vtu.reals("D_t"));
        let maximum = vtu.reals("principal_stress_max");
        let exact = series.recovery.recover(&fields.stresses).unwrap();
        for place in 0..count {
            let node = places.nodes()[place];
            assert_eq!(displacement[3 * place..][..2], snapshot.displacements[2 * node..][..2]);
            assert_eq!(stress[6 * place..][..4], exact[place]);
            assert_eq!(maximum[place], Principal::new(exact[place]).maximum);
            assert_eq!(damage[place].is_nan(), places.parts()[place] == 0);
        }
        // the law has a variable called as the strain is
        let constant = vtu.reals("state_strain");
        assert!(constant.iter().zip(places.parts()).all(|(&v, &part)| part == 0 || (v - 7.0).abs() < 1e-14));
        assert_eq!(vtu.reals("strain").len(), 4 * count);
        let stress = document.descendants().find(|node| node.attribute("Name") == Some("stress")).unwrap();
        assert_eq!((stress.attribute("ComponentName3"), stress.attribute("type")), (Some("s12"), Some("Float64")));

        let vtu = Vtu::read(&folder.path().join("fields/contact_000000.vtu"));
        assert_eq!(vtu.reals("bond_traction"), [5.5; 3]);
        assert_eq!(vtu.bytes("open"), [0, 1, 0]);
        assert_eq!(vtu.bytes("types"), [1; 3]);
        assert_eq!(vtu.reals("Points"), [0.0, 1.0, 0.0, 0.1, 1.0, 0.0, 0.2, 1.0, 0.0]);
        assert_eq!(vtu.bytes("pair upper & \"lower\""), 1i32.to_le_bytes());
    }
}

#[test]
fn torn_elements_are_no_cells() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = two_parts(ElementKind::Q4, Integration::Full);
    let snapshot = Snapshot::new(&mesh);
    let mut fields = snapshot.fields(&mesh, 0.0);
    fields.activities[2] = Activity::Spalled;
    let mut series = Series::create(folder.path(), &mesh).unwrap();
    series.write(&mesh, &fields).unwrap();
    let vtu = Vtu::read(&folder.path().join("fields/000000.vtu"));
    let left: Vec<i64> = (1..=mesh.elements().len() as i64).filter(|&number| number != 3).collect();
    let numbers: Vec<i64> =
        vtu.bytes("element").as_chunks::<4>().0.iter().map(|&chunk| i64::from(i32::from_le_bytes(chunk))).collect();
    assert_eq!(numbers, left);
    assert_eq!(vtu.integers("offsets"), (1..=left.len() as i64).map(|cell| 4 * cell).collect::<Vec<_>>());
    assert_eq!(vtu.reals("thickness").len(), left.len());
}

#[test]
fn the_list_is_whole_after_each_increment() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = two_parts(ElementKind::Q4, Integration::Full);
    let snapshot = Snapshot::new(&mesh);
    let mut series = Series::create(folder.path(), &mesh).unwrap();
    for increment in 0..4 {
        let time = 0.1 * f64::from(increment);
        // contact points may all have left: the file must still be one that is read
        let fields = Fields { contact: Vec::new(), ..snapshot.fields(&mesh, time) };
        series.write(&mesh, &fields).unwrap();
        let text = read(&folder.path().join("fields.pvd"));
        let document = roxmltree::Document::parse(&text).unwrap();
        let sets: Vec<_> = document.descendants().filter(|node| node.has_tag_name("DataSet")).collect();
        assert_eq!(sets.len(), 2 * (increment as usize + 1));
        for set in &sets {
            let vtu = Vtu::read(&folder.path().join(set.attribute("file").unwrap()));
            let file = vtu.document();
            let piece = file.descendants().find(|node| node.has_tag_name("Piece")).unwrap();
            let solids = set.attribute("part") == Some("0");
            assert_eq!(piece.attribute("NumberOfCells"), Some(if solids { "8" } else { "0" }));
        }
        let last = sets.last().unwrap();
        assert_eq!(last.attribute("timestep").unwrap().parse(), Ok(time));
    }
    let left: Vec<_> = std::fs::read_dir(folder.path().join("fields")).unwrap().map(|f| f.unwrap().path()).collect();
    assert_eq!(left.len(), 8);
    assert!(left.iter().all(|path| path.extension().is_some_and(|extension| extension == "vtu")));
}

#[test]
fn a_model_without_contact_has_one_file_per_increment() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = two_parts(ElementKind::Q4, Integration::Full);
    let snapshot = Snapshot { pairs: Vec::new(), ..Snapshot::new(&mesh) };
    let fields = Fields { contact: Vec::new(), ..snapshot.fields(&mesh, 0.0) };
    Series::create(folder.path(), &mesh).unwrap().write(&mesh, &fields).unwrap();
    assert_eq!(read(&folder.path().join("fields.pvd")).matches("<DataSet").count(), 1);
    assert!(!folder.path().join("fields/contact_000000.vtu").exists());
}

#[test]
fn fields_of_another_mesh_are_refused_and_nothing_is_listed() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = two_parts(ElementKind::Q4, Integration::Full);
    let snapshot = Snapshot::new(&mesh);
    let mut series = Series::create(folder.path(), &mesh).unwrap();
    let mut refuse = |change: &dyn Fn(&mut Fields), message: &str| {
        let mut fields = snapshot.fields(&mesh, 0.0);
        change(&mut fields);
        assert_eq!(series.write(&mesh, &fields).unwrap_err().to_string(), message);
    };
    refuse(&|fields| fields.displacements = vec![0.0], "there are 1 displacements, the mesh needs 90");
    refuse(&|fields| fields.stresses.truncate(3), "there are 3 stresses, the mesh needs 32");
    refuse(&|fields| fields.states.clear(), "there are 0 state variables, the mesh needs 32");
    refuse(&|fields| fields.contact[2].pair = 4, "contact point 3 belongs to pair 5, there are 1");
    assert!(!folder.path().join("fields.pvd").exists());
    let blocked = folder.path().join("file");
    std::fs::write(&blocked, "").unwrap();
    let error = Series::create(&blocked, &mesh).unwrap_err().to_string();
    assert!(error.contains("fields: "), "{error}");
}

/// A quarter of a ring of radius 2.5, 0.9 thick, of four layers of elements of unlike lengths: 100 MPa along it and 1000 MPa more on its outer
/// half, less on its inner half, as in a wire that yields in its bend.
#[test]
fn bending_has_no_part_in_the_axial_stress() {
    let angles = [0.0, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.3, 1.45, 1.57_f64];
    let at = |angle: f64, radius: f64| [radius * angle.cos(), radius * angle.sin()];
    let layers = 5;
    let nodes =
        angles.iter().flat_map(|&angle| (0..layers).map(move |k| at(angle, 2.05 + 0.225 * f64::from(k)))).collect();
    let node = |column: usize, layer: usize| column * 5 + layer;
    let element = |column: usize, layer: usize| ElementDefinition {
        kind: ElementKind::Q4,
        part: 0,
        nodes: vec![node(column, layer), node(column, layer + 1), node(column + 1, layer + 1), node(column + 1, layer)],
    };
    let elements =
        (0..10).flat_map(|column| (0..4).map(move |layer| (column, layer))).map(|(i, j)| element(i, j)).collect();
    let parts = vec![Part::new("fibre", PlaneModel::PlaneStress, 1.0)];
    let mesh = Mesh::new(MeshDefinition { nodes, parts, elements, ..MeshDefinition::default() }).unwrap();
    let axis = angles.map(|angle| at(angle, 2.5));
    let stresses = at_points(&mesh, |element, _, _| {
        // along the chord of the element's column
        let (column, layer) = (element / 4, element % 4);
        let middle = 0.5 * (angles[column] + angles[column + 1]);
        let (axial, [c, s]) = (if layer < 2 { -900.0 } else { 1100.0 }, [-middle.sin(), middle.cos()]);
        [axial * c * c, axial * s * s, 0.0, axial * c * s]
    });
    let fields = still(&mesh, stresses);
    let profile = axial_stress(&mesh, &fields, 0, &axis, 400).unwrap();
    assert_eq!(profile.len(), 10, "columns of elements");
    for (arc, stress) in profile {
        assert!((stress - 100.0).abs() < 6.0, "{stress} at {arc}");
    }
}

/// Bending on a straight part whose cross-sections lean, as they do where a bend begins: layers of one lie apart along the axis.
#[test]
fn leaning_cross_sections_are_not_taken_apart() {
    let [columns, layers] = [8usize, 4usize];
    let nodes =
        (0..=columns).flat_map(|i| (0..=layers).map(move |j| [0.5 * i as f64 + 0.15 * j as f64, 0.2 * j as f64]));
    let element = |i: usize, j: usize| {
        let node = |i, j| i * (layers + 1) + j;
        let nodes = vec![node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
        ElementDefinition { kind: ElementKind::Q4, part: 0, nodes }
    };
    let elements = (0..columns).flat_map(|i| (0..layers).map(move |j| element(i, j))).collect();
    let parts = vec![Part::new("fibre", PlaneModel::PlaneStress, 1.0)];
    let mesh =
        Mesh::new(MeshDefinition { nodes: nodes.collect(), parts, elements, ..MeshDefinition::default() }).unwrap();
    let stresses = at_points(&mesh, |_, [_, y], _| [100.0 + 2000.0 * (y - 0.4), 0.0, 0.0, 0.0]);
    let profile = axial_stress(&mesh, &still(&mesh, stresses), 0, &[[0.0, 0.4], [6.0, 0.4]], 400).unwrap();
    assert_eq!(profile.len(), columns);
    for (arc, stress) in profile {
        assert_abs_diff_eq!(stress, 100.0, epsilon = 1e-9);
        assert!((0.0..6.0).contains(&arc));
    }
}

/// Stresses of a body that has not moved.
fn still(mesh: &Mesh, stresses: Vec<[f64; 4]>) -> Fields {
    let displacements = vec![0.0; 2 * mesh.nodes().len()];
    Fields {
        time: 0.0,
        scalar: None,
        reactions: displacements.clone(),
        displacements,
        strains: stresses.clone(),
        stresses,
        states: Vec::new(),
        state_names: vec![vec![]],
        activities: vec![Activity::Elastic; mesh.elements().len()],
        behind: Vec::new(),
        pairs: Vec::new(),
        contact: Vec::new(),
    }
}

/// A straight part turned by 40° with a stress along it that is linear in its arc length, before and after another turn.
#[test]
fn the_axial_stress_follows_the_axis_as_it_turns() {
    let (angle, turn) = (40f64.to_radians(), 0.7f64);
    let rotated = |[x, y]: [f64; 2], by: f64| [x * by.cos() - y * by.sin(), x * by.sin() + y * by.cos()];
    let grid = (0..3).flat_map(|row| (0..11).map(move |column| [f64::from(column), 0.1 * f64::from(row) - 0.1]));
    let nodes: Vec<[f64; 2]> = grid.map(|place| rotated(place, angle)).collect();
    let element = |(column, row): (usize, usize)| {
        let node = |i, j| (row + j) * 11 + column + i;
        ElementDefinition {
            kind: ElementKind::Q4,
            part: 0,
            nodes: vec![node(0, 0), node(1, 0), node(1, 1), node(0, 1)],
        }
    };
    let elements = (0..20).map(|k| element((k % 10, k / 10))).collect();
    let parts = vec![Part::new("fibre", PlaneModel::PlaneStress, 1.0)];
    let mesh = Mesh::new(MeshDefinition { nodes, parts, elements, ..MeshDefinition::default() }).unwrap();
    let axis = [[0.0, 0.0], [4.0, 0.0], [10.0, 0.0]].map(|place| rotated(place, angle));
    for turn in [0.0, turn] {
        let moved = |node: &[f64; 2]| {
            let new = rotated(*node, turn);
            [new[0] - node[0], new[1] - node[1]]
        };
        let displacements: Vec<f64> = mesh.nodes().iter().flat_map(moved).collect();
        let stress = |_, position: [f64; 2], _| {
            let (axial, [c, s]) = (50.0 - 4.0 * rotated(position, -angle)[0], rotated([1.0, 0.0], angle + turn));
            [axial * c * c, axial * s * s, 0.0, axial * c * s]
        };
        let stresses = at_points(&mesh, stress);
        let fields = Fields { displacements, ..still(&mesh, stresses) };
        for sections in [1, 5, 10, 20, 37] {
            let profile = axial_stress(&mesh, &fields, 0, &axis, sections).unwrap();
            assert_eq!(profile.len(), sections.min(10), "columns of elements");
            for (arc, stress) in profile {
                assert_abs_diff_eq!(stress, 50.0 - 4.0 * arc, epsilon = 1e-12);
            }
        }
        assert!(axial_stress(&mesh, &fields, 0, &axis[..1], 5).unwrap().is_empty());
        assert!(axial_stress(&mesh, &fields, 0, &axis, 0).unwrap().is_empty());
    }
}

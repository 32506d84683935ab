use super::*;
use crate::element::ElementKind::{self, *};
use crate::kinematics::PlaneModel;
use crate::mesh::{ElementEdge, Mesh};

mod random;

/// A Q4 of the part "left" and two T3 of the part "right" on 3 × 1; the triangles are clockwise. Node 9 is unused.
const VERSION_2: &str = "$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
5
0 1 \"corner\"
1 2 \"bottom\"
1 3 \"seam\"
2 4 \"left\"
2 5 \"right part\"
$EndPhysicalNames
$Nodes
7
1 0 0 0
2 1 0 0
3 3 0 0
4 0 1 0
5 1 1 0
6 3 1 0
9 7 7 7
$EndNodes
$Elements
8
1 15 2 1 1 4
2 1 2 2 1 1 2
3 1 2 2 1 3 2
4 1 2 3 2 2 5
5 1 2 0 2 4 5
6 3 2 4 1 1 2 5 4
7 2 2 5 2 2 6 3
8 2 2 5 2 2 5 6
$EndElements
";

/// The mesh of [`VERSION_2`] in version 4.1.
const VERSION_4: &str = "$MeshFormat
4.1 0 8
$EndMeshFormat
$Comments
$Nodes in a comment
$EndComments
$PhysicalNames
5
0 1 \"corner\"
1 2 \"bottom\"
1 3 \"seam\"
2 4 \"left\"
2 5 \"right part\"
$EndPhysicalNames
$Entities
1 4 2 0
1 0 1 0 1 1
1 0 0 0 1 0 0 1 2 2 1 -2
2 1 0 0 3 0 0 1 -2 0
3 1 0 0 1 1 0 1 3 0
4 0 1 0 1 1 0 0 0
1 0 0 0 1 1 0 1 4 1 1
2 1 0 0 3 1 0 1 5 0
$EndEntities
$Nodes
3 7 1 9
1 1 1 2
1
2
0 0 0 0.5
1 0 0 0.5
2 1 0 4
3
4
5
6
3 0 0
0 1 0
1 1 0
3 1 0
0 7 0 1
9
7 7 7
$EndNodes
$Elements
7 8 1 8
0 1 15 1
1 4
1 1 1 1
2 1 2
1 2 1 1
3 3 2
1 3 1 1
4 2 5
1 4 1 1
5 4 5
2 1 3 1
6 1 2 5 4
2 2 2 2
7 2 6 3
8 2 5 6
$EndElements
$Periodic
0
$EndPeriodic
";

fn properties(names: &[&str]) -> Vec<Part> {
    names.iter().map(|name| Part::new(*name, PlaneModel::PlaneStrain, 2.0)).collect()
}

fn parts() -> Vec<Part> {
    properties(&["left", "right part"])
}

fn read_text(text: &str) -> Result<MeshDefinition, MeshError> {
    read(Path::new("case.msh"), text.as_bytes(), &parts()).map(|(definition, _)| definition)
}

fn edge(element: usize, edge: usize) -> ElementEdge {
    ElementEdge { element, edge }
}

#[test]
fn both_versions_give_the_same_mesh() {
    for text in [VERSION_2.to_owned(), VERSION_4.to_owned(), VERSION_2.replace('\n', "\r\n")] {
        let definition = read_text(&text).unwrap();
        assert_eq!(
            definition.parts.iter().map(|part| (&*part.name, part.thickness)).collect::<Vec<_>>(),
            [("left", 2.0), ("right part", 2.0)]
        );
        let kinds: Vec<(ElementKind, usize)> = definition.elements.iter().map(|e| (e.kind, e.part)).collect();
        assert_eq!(kinds, [(Q4, 0), (T3, 1), (T3, 1)]);
        assert_eq!(definition.nodes, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [3.0, 1.0], [3.0, 0.0]]);
        let mesh = Mesh::new(definition).unwrap();
        assert_eq!([0, 1, 2].map(|element| mesh.element_area(element)), [1.0; 3]);
        assert_eq!(mesh.node_set("corner"), Some(&[3][..]));
        assert_eq!(mesh.node_set("bottom"), Some(&[0, 1, 5][..]));
        assert_eq!(mesh.edge_set("bottom"), Some(&[edge(0, 0), edge(1, 0)][..]));
        // Line 2–5 runs upwards: the quadrilateral is on its left.
        assert_eq!(mesh.edge_set("seam"), Some(&[edge(0, 1)][..]));
        assert_eq!(mesh.edge_set_names().collect::<Vec<_>>(), ["bottom", "seam"]);
        assert_eq!(mesh.free_nodes(), [0; 0]);
    }
}

#[test]
fn a_seam_belongs_to_the_element_on_its_left() {
    let mesh = Mesh::new(read_text(&VERSION_2.replace("3 2 2 5\n", "3 2 5 2\n")).unwrap()).unwrap();
    let seam = mesh.edge_set("seam").unwrap()[0];
    assert_eq!(mesh.elements()[seam.element].kind(), T3);
    assert_eq!(mesh.neighbour(seam), Some(edge(0, 1)));
}

#[test]
fn groups_without_names_have_their_number() {
    let (head, tail) = (VERSION_2.find("$PhysicalNames").unwrap(), VERSION_2.find("$Nodes").unwrap());
    let text = format!("{}{}", &VERSION_2[..head], &VERSION_2[tail..]);
    let (definition, _) = read(Path::new("case.msh"), text.as_bytes(), &properties(&["4", "5"])).unwrap();
    assert_eq!(definition.node_sets.keys().collect::<Vec<_>>(), ["1", "2", "3"]);
}

/// Quadratic elements over [0, 1]², with Gmsh's order of nodes: corners, then the middles from corner 1 on.
fn quadratic(kind: ElementKind, clockwise: bool) -> String {
    let mut positions = vec![[0, 0], [2, 0], [2, 2], [0, 2]];
    let mut elements = if kind == Q8 { vec![vec![0, 1, 2, 3]] } else { vec![vec![0, 1, 2], vec![0, 2, 3]] };
    for corners in &mut elements {
        if clockwise {
            corners.reverse();
        }
        for start in 0..corners.len() {
            let count = kind.corner_count();
            let [a, b] = [corners[start], corners[(start + 1) % count]].map(|node| positions[node]);
            let middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
            let known = positions.iter().position(|&position| position == middle);
            corners.push(known.unwrap_or(positions.len()));
            if known.is_none() {
                positions.push(middle);
            }
        }
    }
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", positions.len());
    for (node, [x, y]) in positions.iter().enumerate() {
        text += &format!("{} {} {} 0\n", node + 1, f64::from(*x) / 2.0, f64::from(*y) / 2.0);
    }
    let bottom = 1 + positions.iter().position(|&position| position == [1, 0]).unwrap();
    text += &format!("$EndNodes\n$Elements\n{}\n1 8 2 9 1 1 2 {bottom}\n", elements.len() + 1);
    for (index, element) in elements.iter().enumerate() {
        let nodes: Vec<String> = element.iter().map(|node| (node + 1).to_string()).collect();
        text += &format!("{} {} 2 3 1 {}\n", index + 2, if kind == Q8 { 16 } else { 9 }, nodes.join(" "));
    }
    text + "$EndElements\n"
}

#[test]
fn quadratic_elements_keep_their_middles_between_their_corners() {
    for kind in [T6, Q8] {
        for clockwise in [false, true] {
            let text = quadratic(kind, clockwise);
            let (definition, turned) = read(Path::new("q.msh"), text.as_bytes(), &properties(&["3"])).unwrap();
            assert_eq!(turned.len(), if clockwise { definition.elements.len() } else { 0 });
            let mesh = Mesh::new(definition).unwrap();
            let area: f64 = (0..mesh.elements().len()).map(|element| mesh.element_area(element)).sum();
            approx::assert_abs_diff_eq!(area, 1.0, epsilon = 1e-15);
            for edge in mesh.edges() {
                let nodes = mesh.edge_nodes(edge);
                let [a, b, m] = [0, 1, 2].map(|i| mesh.nodes()[nodes.nodes()[i]]);
                assert_eq!(m, [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
            }
            assert_eq!(mesh.node_set("9").unwrap().len(), 3);
            let bottom = mesh.edge_nodes(mesh.edge_set("9").unwrap()[0]);
            assert!(bottom.nodes().iter().all(|&node| mesh.nodes()[node][1] == 0.0));
        }
    }
}

/// The mesh of [`VERSION_2`] in binary, little-endian.
fn binary_2() -> Vec<u8> {
    let mut bytes = b"$MeshFormat\n2.2 1 8\n".to_vec();
    let int = |bytes: &mut Vec<u8>, values: &[i32]| bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    int(&mut bytes, &[1]);
    bytes.extend(b"\n$EndMeshFormat\n$PhysicalNames\n5\n0 1 \"corner\"\n1 2 \"bottom\"\n1 3 \"seam\"\n2 4 \"left\"\n2 5 \"right part\"\n$EndPhysicalNames\n$Nodes\n7\n");
    for (tag, position) in NODES {
        int(&mut bytes, &[tag]);
        bytes.extend(position.iter().flat_map(|x| x.to_le_bytes()));
    }
    bytes.extend(b"\n$EndNodes\n$Elements\n8\n");
    int(&mut bytes, &[15, 1, 2, 1, 1, 1, 4]);
    int(&mut bytes, &[1, 4, 2, 2, 2, 1, 1, 2, 3, 2, 1, 3, 2, 4, 3, 2, 2, 5, 5, 0, 2, 4, 5]);
    int(&mut bytes, &[3, 1, 2, 6, 4, 1, 1, 2, 5, 4]);
    int(&mut bytes, &[2, 2, 2, 7, 5, 2, 2, 6, 3, 8, 5, 2, 2, 5, 6]);
    bytes.extend(b"\n$EndElements\n");
    bytes
}

const NODES: [(i32, [f64; 3]); 7] = [
    (1, [0.0, 0.0, 0.0]),
    (2, [1.0, 0.0, 0.0]),
    (3, [3.0, 0.0, 0.0]),
    (4, [0.0, 1.0, 0.0]),
    (5, [1.0, 1.0, 0.0]),
    (6, [3.0, 1.0, 0.0]),
    (9, [7.0, 7.0, 7.0]),
];

/// Numbers of version 4.1 in binary: i an int, s a size_t, r a double.
fn binary_numbers(text: &str) -> Vec<u8> {
    text.split_whitespace()
        .flat_map(|word| match word.split_at(1) {
            ("i", value) => value.parse::<i32>().unwrap().to_le_bytes().to_vec(),
            ("s", value) => value.parse::<u64>().unwrap().to_le_bytes().to_vec(),
            (_, value) => value.parse::<f64>().unwrap().to_le_bytes().to_vec(),
        })
        .collect()
}

/// The mesh of [`VERSION_4`] in binary.
fn binary_4() -> Vec<u8> {
    let names = &VERSION_4[VERSION_4.find("$PhysicalNames").unwrap()..VERSION_4.find("$Entities").unwrap()];
    let mut bytes = b"$MeshFormat\n4.1 1 8\n".to_vec();
    bytes.extend(binary_numbers("i1"));
    bytes.extend(format!("\n$EndMeshFormat\n{names}$Entities\n").as_bytes());
    bytes.extend(binary_numbers(
        "s1 s4 s2 s0  i1 r0 r1 r0 s1 i1  i1 r0 r0 r0 r1 r0 r0 s1 i2 s2 i1 i-2  i2 r1 r0 r0 r3 r0 r0 s1 i-2 s0
         i3 r1 r0 r0 r1 r1 r0 s1 i3 s0  i4 r0 r1 r0 r1 r1 r0 s0 s0  i1 r0 r0 r0 r1 r1 r0 s1 i4 s1 i1
         i2 r1 r0 r0 r3 r1 r0 s1 i5 s0",
    ));
    bytes.extend(b"\n$EndEntities\n$Nodes\n");
    bytes.extend(binary_numbers(
        "s2 s7 s1 s9  i1 i1 i1 s2 s1 s2 r0 r0 r0 r0.5 r1 r0 r0 r0.5
         i2 i1 i0 s5 s3 s4 s5 s6 s9 r3 r0 r0 r0 r1 r0 r1 r1 r0 r3 r1 r0 r7 r7 r7",
    ));
    bytes.extend(b"\n$EndNodes\n$Elements\n");
    bytes.extend(binary_numbers(
        "s7 s8 s1 s8  i0 i1 i15 s1 s1 s4  i1 i1 i1 s1 s2 s1 s2  i1 i2 i1 s1 s3 s3 s2  i1 i3 i1 s1 s4 s2 s5
         i1 i4 i1 s1 s5 s4 s5  i2 i1 i3 s1 s6 s1 s2 s5 s4  i2 i2 i2 s2 s7 s2 s6 s3 s8 s2 s5 s6",
    ));
    bytes.extend(b"\n$EndElements\n");
    bytes
}

#[test]
fn binary_files_give_the_mesh_of_their_text() {
    let expected = read_text(VERSION_2).unwrap();
    for bytes in [binary_2(), binary_4()] {
        assert_eq!(read(Path::new("b.msh"), &bytes, &parts()).unwrap().0, expected);
    }
}

#[test]
fn faults_of_binary_files_name_the_byte() {
    for (bytes, version) in [(binary_2(), "2.2"), (binary_4(), "4.1")] {
        let message = |bytes: &[u8]| read(Path::new("b.msh"), bytes, &parts()).unwrap_err().to_string();
        let cut = bytes.len() - 40;
        assert!(message(&bytes[..cut]).starts_with(&format!("b.msh, byte {cut}: the file ends where a")), "{version}");
        let mut reversed = bytes.clone();
        reversed[20..24].reverse();
        assert_eq!(
            message(&reversed),
            "b.msh, byte 20: binary data with its highest byte first is not read; save as text with Mesh.Binary = 0"
        );
        let mut small = bytes.clone();
        small[18] = b'4';
        assert!(message(&small).contains("binary data with numbers of 4 bytes"), "{}", message(&small));
    }
}

/// Text to be replaced, its replacement, and the message.
type Fault = (&'static str, &'static str, &'static str);

#[track_caller]
fn check_faults(text: &str, faults: &[Fault]) {
    for (from, to, message) in faults {
        assert!(text.contains(from), "{from} is not in the file");
        let found = read_text(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert_eq!(found, *message, "{from} -> {to}");
    }
}

#[test]
fn malformed_text_is_named_by_line() {
    let counts = "; is a count of this section wrong, or the file edited?";
    let owned = |message: &str| -> &'static str { format!("case.msh:{message}{counts}").leak() };
    check_faults(
        VERSION_2,
        &[
            ("$MeshFormat", "solid", "case.msh:1: this is no Gmsh mesh: it must start with $MeshFormat, found 'solid'"),
            (
                "2.2 0",
                "4.0 0",
                "case.msh:2: format version 4.0 is not read; save with Mesh.MshFileVersion = 4.1 (or 2.2)",
            ),
            ("2.2 0", "2.2 2", owned("2: expected 0 (text) or 1 (binary), found '2'")),
            ("\n7\n1 0", "\n8\n1 0", owned("21: expected a node tag, found '$EndNodes'")),
            ("\n7\n1 0", "\n6\n1 0", owned("20: expected $EndNodes, found '9'")),
            ("$Elements\n8", "$Elements\n9", owned("32: expected an element tag, found '$EndElements'")),
            ("2 1 0 0\n", "2 1 0,5 0\n", owned("15: expected a coordinate of a node, found '0,5'")),
            ("2 1 0 0\n", "-2 1 0 0\n", owned("15: expected a node tag, found '-2'")),
            ("2 1 0 0\n", "2 1 NaN 0\n", "case.msh:15: node 2: its position is not finite"),
            ("2 1 0 0\n", "1 1 0 0\n", "case.msh:15: node 1 is defined twice"),
            ("\"seam\"", "seam", owned("8: expected the name of a physical group in quotes, found 'seam'")),
            ("$Nodes", "$Nodes 7", owned("12: expected the end of the line, found '7'")),
            ("$Nodes", "Nodes", owned("12: expected a section, such as $Nodes, found 'Nodes'")),
            ("2 6 3\n", "2 66 3\n", "case.msh:30: element 7 has node 66, which is not in $Nodes"),
        ],
    );
    check_faults(
        VERSION_4,
        &[
            ("3 7 1 9", "3 8 1 9", owned("26: expected 8 entries (the number of nodes of the header), found '7'")),
            ("7 8 1 8", "7 7 1 8", owned("46: expected 7 entries (the number of elements of the header), found '8'")),
            ("2 1 3 1", "1 1 3 1", owned("57: expected a block of dimension 2, as its type of element, found '1'")),
            (
                "1 0 0 0 1 0 0 1 2 2 1 -2",
                "1 0 0 0 1 0 0 1001 2 2 1 -2",
                owned("18: expected at most 1000 physical groups of an entity, found '1001'"),
            ),
            (
                "2 1 3 1\n",
                "2 7 3 1\n",
                "case.msh:57: elements of the entity of dimension 2 and tag 7, which is not in $Entities; save the mesh from Gmsh again",
            ),
            (
                "$Periodic",
                "$PartitionedEntities",
                "case.msh:63: the mesh is partitioned; save it with Mesh.PartitionSplitMeshFiles = 0 and without partitions",
            ),
            (
                "$Comments\n",
                "$Comments\n$EndComments\n$Nodes\n0 0 0 0\n$EndNodes\n$Comments\n",
                "case.msh:30: section $Nodes comes a second time; a file holds one mesh",
            ),
        ],
    );
}

#[test]
fn meshes_that_cannot_be_computed_are_refused_with_a_remedy() {
    check_faults(
        VERSION_2,
        &[
            (
                "6 3 2 4 1 1 2 5 4",
                "6 10 2 4 1 1 2 5 4 1 2 5 4 4",
                "case.msh:29: element type 10 (9-node quadrilateral) is not computed; with Mesh.ElementOrder = 2 also set Mesh.SecondOrderIncomplete = 1 (second-order incomplete: 8 nodes)",
            ),
            (
                "6 3 2 4",
                "6 4 2 4",
                "case.msh:29: element type 4 (tetrahedron) is not computed; put only surfaces, curves and points into physical groups",
            ),
            (
                "6 3 2 4",
                "6 21 2 4",
                "case.msh:29: element type 21 (triangle of a higher order) is not computed; set Mesh.ElementOrder to 1 or 2",
            ),
            (
                "6 3 2 4",
                "6 777 2 4",
                "case.msh:29: element type 777 (unknown or of a higher order) is not computed; set Mesh.ElementOrder to 1 or 2",
            ),
            (
                "7 2 2 5 2 2 6 3\n8 2 2 5",
                "7 2 2 0 2 2 6 3\n8 2 2 0",
                "case.msh:30: element 7 (the first of 2) is in no physical surface; add Physical Surface(\"name\") = {...} over all surfaces",
            ),
            (
                "6 3 2 4 1",
                "6 3 2 0 1",
                "case.msh:29: element 6 is in no physical surface; add Physical Surface(\"name\") = {...} over all surfaces",
            ),
            (
                "7 2 2 5 2 2 6 3",
                "7 2 2 4 2 2 5 6",
                "case.msh:31: elements 7 (physical surface 'left') and 8 ('right part') have the same nodes; every surface belongs to one part, once",
            ),
            ("6 3 1 0\n", "6 3 1 0.5\n", "case.msh:19: node 6 lies at z = 0.5, others at 0; a plane mesh has one z"),
            (
                "4 1 2 3 2 2 5",
                "4 1 2 3 2 2 4",
                "case.msh:27: line element 4 of the physical curve 'seam' is no edge of a surface element of its order; the curve must bound a meshed surface",
            ),
            (
                "4 1 2 3 2 2 5",
                "4 8 2 3 2 2 5 9",
                "case.msh:27: line element 4 of the physical curve 'seam' is no edge of a surface element of its order; the curve must bound a meshed surface",
            ),
            (
                "0 1 \"corner\"",
                "0 1 \"seam\"",
                "case.msh: 'seam' names a physical point and a physical curve; both would become the node set of this name",
            ),
            (
                "6 3 2 4 1 1 2 5 4",
                "6 3 2 4 1 1 5 2 4",
                "case.msh:29: element 6: the Jacobian determinant is -1.443e-1 where it must be positive; it is folded or collapsed, repair the mesh (Mesh > Inspect shows it)",
            ),
            (
                "5 1 1 0\n",
                "5 0.4 0.4 0\n",
                "case.msh:29: element 6: at its corner 3 the Jacobian determinant is -5.000e-2; it is folded there, repair the mesh (Mesh > Inspect shows it)",
            ),
            (
                "2 5 \"right part\"",
                "2 5 \"middle\"",
                "case.msh: no physical surface with elements is called 'right part'; no properties are given for the physical surface 'middle'; the file's physical surfaces are 'left', 'middle'",
            ),
        ],
    );
    check_faults(
        VERSION_4,
        &[(
            "2 1 0 0 3 1 0 1 5 0",
            "2 1 0 0 3 1 0 2 4 5 0",
            "case.msh:60: element 7 is in the physical surfaces 'left' and 'right part'; every surface belongs to one part",
        )],
    );
}

#[test]
fn a_file_needs_nodes_and_surface_elements() {
    let cut = |from: &str, to: &str| {
        let (head, tail) = (VERSION_2.find(from).unwrap(), VERSION_2.find(to).unwrap() + to.len());
        read_text(&format!("{}{}", &VERSION_2[..head], &VERSION_2[tail..])).unwrap_err().to_string()
    };
    assert_eq!(
        cut("$Elements", "$EndElements"),
        "case.msh:23: there is no section $Elements; mesh the model (Mesh > 2D) before saving it"
    );
    assert_eq!(cut("$Nodes", "$EndNodes"), "case.msh:15: element 1 has node 4, which is not in $Nodes");
    let lines = VERSION_2
        .replace("\n8\n1 15", "\n5\n1 15")
        .replace("6 3 2 4 1 1 2 5 4\n7 2 2 5 2 2 6 3\n8 2 2 5 2 2 5 6\n", "");
    assert_eq!(
        read_text(&lines).unwrap_err().to_string(),
        "case.msh: there are no triangles or quadrilaterals; mesh the surfaces (Mesh > 2D) and put them into physical groups"
    );
}

/// Every beginning of a file is an error or, where only blanks or sections without meaning are missing, the same mesh.
#[test]
fn truncated_files_are_refused() {
    let expected = read_text(VERSION_2).unwrap();
    for bytes in [VERSION_2.as_bytes().to_vec(), VERSION_4.as_bytes().to_vec(), binary_2(), binary_4()] {
        let end = bytes.windows(12).position(|window| window == b"$EndElements").unwrap() + 12;
        for length in 0..bytes.len() {
            match read(Path::new("t.msh"), &bytes[..length], &parts()) {
                Ok((definition, _)) => assert!(length >= end && definition == expected, "{length}"),
                // What is cut off after the mesh may start a section.
                Err(error) => assert!(length < end || bytes[end..length].contains(&b'$'), "{error}"),
            }
        }
    }
}

/// Elements share the name of their group: a megabyte of name and ten thousand elements are no 10 GB.
#[test]
fn a_name_is_held_once() {
    let name = "n".repeat(1 << 20);
    let triangles = 10_000;
    let positions = |i: usize| format!("{} {i} 0 0\n{} {i} 1 0\n", 2 * i + 1, 2 * i + 2);
    let nodes = String::from_iter((0..=triangles).map(positions));
    let element = |i: usize| format!("{} 2 1 1 {} {} {}\n", i + 1, 2 * i + 1, 2 * i + 3, 2 * i + 2);
    let elements = String::from_iter((0..triangles).map(element));
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"{name}\"\n$EndPhysicalNames\n$Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{triangles}\n{elements}$EndElements\n",
        2 * triangles + 2
    );
    let (definition, _) = read(Path::new("n.msh"), text.as_bytes(), &properties(&[&name])).unwrap();
    assert_eq!((definition.elements.len(), definition.parts.len()), (triangles, 1));
}

/// Files written by Gmsh itself; `data/README.md` describes them.
const FILES: [(&str, &[u8]); 6] = [
    ("quadrilaterals, 2.2, text", include_bytes!("data/quadrilaterals_2.2_text.msh")),
    ("quadrilaterals, 2.2, binary", include_bytes!("data/quadrilaterals_2.2_binary.msh")),
    ("quadrilaterals, 4.1, text", include_bytes!("data/quadrilaterals_4.1_text.msh")),
    ("quadrilaterals, 4.1, binary", include_bytes!("data/quadrilaterals_4.1_binary.msh")),
    ("triangles, 2.2, binary", include_bytes!("data/triangles_2.2_binary.msh")),
    ("triangles, 4.1, binary", include_bytes!("data/triangles_4.1_binary.msh")),
];

/// Gmsh places nodes to about 1e-11 of the size.
#[test]
fn files_of_gmsh_are_read() {
    for (name, bytes) in FILES {
        let (definition, _) = read(Path::new(name), bytes, &properties(&["matrix", "the fibre"])).unwrap();
        let mesh = Mesh::new(definition).unwrap();
        let kind = if name.starts_with("quadrilaterals") { Q8 } else { T6 };
        assert!(mesh.elements().iter().all(|element| element.kind() == kind), "{name}");
        let mut areas = [0.0; 2];
        for (index, element) in mesh.elements().iter().enumerate() {
            areas[element.part()] += mesh.element_area(index);
            let left = mesh.nodes()[element.nodes()[0]][0] + mesh.nodes()[element.nodes()[2]][0] < 2.0 + 1e-9;
            assert_eq!(left, element.part() == 0, "{name}: parts on their sides");
        }
        approx::assert_abs_diff_eq!(areas[..], [1.0, 1.0][..], epsilon = 1e-9);
        // (line, where on it, length)
        for (set, axis, at, length) in [("bottom", 1, 0.0, 2.0), ("seam", 0, 1.0, 1.0)] {
            let mut found = 0.0;
            for &edge in mesh.edge_set(set).unwrap() {
                let [start, end, middle] = [0, 1, 2].map(|i| mesh.nodes()[mesh.edge_nodes(edge).nodes()[i]]);
                found += (end[0] - start[0]).hypot(end[1] - start[1]);
                approx::assert_abs_diff_eq!(middle[0], 0.5 * (start[0] + end[0]), epsilon = 1e-9);
                approx::assert_abs_diff_eq!(middle[1], 0.5 * (start[1] + end[1]), epsilon = 1e-9);
                assert_eq!(
                    mesh.elements()[edge.element].part(),
                    usize::from(set == "bottom" && start[0] >= 1.0 - 1e-9)
                );
            }
            approx::assert_abs_diff_eq!(found, length, epsilon = 1e-9);
            assert!(mesh.node_set(set).unwrap().iter().all(|&node| (mesh.nodes()[node][axis] - at).abs() < 1e-9));
        }
        assert_eq!(
            mesh.node_set("grip").unwrap().iter().map(|&node| mesh.nodes()[node]).collect::<Vec<_>>(),
            [[2.0, 1.0]]
        );
        assert_eq!(mesh.boundary_loops().len(), 1, "{name}");
        assert_eq!(crate::mesh::preflight::findings(&mesh, &[]), []);
    }
    let nine =
        read(Path::new("nine.msh"), include_bytes!("data/nine_nodes.msh"), &properties(&["matrix", "the fibre"]));
    let message = nine.unwrap_err().to_string();
    assert!(
        message.contains("element type 10 (9-node quadrilateral)") && message.contains("second-order incomplete"),
        "{message}"
    );
}

//! Any bytes, damaged files and files with wild numbers: a mesh or an error, never a panic, nor memory beyond the file's
//! order.
//!
//! The long form, with a limit on memory:
//! `(ulimit -v 4000000; PROPTEST_CASES=1000000 cargo test -p fe-core --lib mesh::gmsh::test::random)`.

use super::*;
use crate::mesh::preflight;
use end_to_end_tests::fuzz::{self, WILD_NUMBERS, damage, damaged, wild_word};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};

/// Reads, and where the mesh stands the check, looks at all that the driver looks at.
fn read_and_look(bytes: &[u8], names: &[&str]) {
    match read(Path::new("d.msh"), bytes, &properties(names)) {
        Ok((definition, _)) => {
            assert!(definition.nodes.len() <= bytes.len() && definition.elements.len() <= bytes.len());
            look(definition);
        }
        Err(error) => {
            let words = error.to_string();
            assert!(!words.is_empty() && words.len() <= 1000 + 10 * bytes.len(), "{} bytes: {words}", bytes.len());
        }
    }
}

/// Checks a mesh that the reader has accepted: it is refused, or usable.
fn look(definition: MeshDefinition) {
    let Ok(mesh) = Mesh::new(definition) else { return };
    for element in 0..mesh.elements().len() {
        let length = mesh.characteristic_length(element);
        assert!(length > 0.0 && length.is_finite(), "element {element}: CELENT {length}");
    }
    let edges: usize = mesh.boundary_loops().iter().map(Vec::len).sum();
    assert_eq!(edges, mesh.boundary_edges().count());
    mesh.free_nodes();
    assert!(preflight::findings(&mesh, &[]).iter().all(|finding| !finding.to_string().is_empty()));
}

/// Valid files, each with the parts that it has.
fn originals() -> Vec<(Vec<u8>, [&'static str; 2])> {
    let own = [VERSION_2.as_bytes().to_vec(), VERSION_4.as_bytes().to_vec(), binary_2(), binary_4()];
    let own = own.into_iter().map(|bytes| (bytes, ["left", "right part"]));
    own.chain(FILES.map(|(_, bytes)| (bytes.to_vec(), ["matrix", "the fibre"]))).collect()
}

/// A file of version 2.2 all of whose words are of the right kind, and hardly one of them right.
fn wild_file() -> impl Strategy<Value = String> {
    let word = || prop_oneof![8 => (0_i64..9).prop_map(|n| n.to_string()), 1 => wild_word()];
    let coordinate = prop_oneof![
        8 => (0_u8..4).prop_map(f64::from),
        1 => select(&WILD_NUMBERS[..]),
        1 => -1e3..1e3,
    ];
    let out_of_plane = prop_oneof![8 => Just(0.0), 1 => coordinate.clone()];
    let node = (word(), (coordinate.clone(), coordinate, out_of_plane));
    let element =
        (word(), select(&[1, 2, 3, 8, 9, 15, 16, 10, -1, i64::MAX][..]), vec(word(), 0..3), vec(word(), 1..9));
    (vec(node, 0..9), vec(element, 0..7), [word(), word()], prop::bool::weighted(0.1)).prop_map(
        |(nodes, elements, counts, wrong)| {
            let mut text = String::from(
                "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"left\"\n$EndPhysicalNames\n",
            );
            let count = |k: usize, right: usize| if wrong { counts[k].clone() } else { right.to_string() };
            text += &format!("$Nodes\n{}\n", count(0, nodes.len()));
            for (tag, (x, y, z)) in &nodes {
                text += &format!("{tag} {x:e} {y:e} {z:e}\n");
            }
            text += &format!("$EndNodes\n$Elements\n{}\n", count(1, elements.len()));
            for (tag, kind, tags, nodes) in &elements {
                text += &format!("{tag} {kind} {} {} {}\n", tags.len(), tags.join(" "), nodes.join(" "));
            }
            text + "$EndElements\n"
        },
    )
}

/// Sound meshes of one to nine quadrilaterals of any size, with positions, indices and sets changed at random.
fn wild_definition() -> impl Strategy<Value = MeshDefinition> {
    let number = || prop_oneof![select(&WILD_NUMBERS[..]), -10.0..10.0, any::<f64>()];
    let index = || prop_oneof![4 => 0_usize..20, 1 => Just(usize::MAX), 1 => any::<usize>()];
    let change = (any::<Index>(), 0_u8..9, number(), index());
    (1_usize..4, 1_usize..4, select(&[1.0, 1e-150, 1e-8, 1e8, 1e150][..]), vec(change, 0..4)).prop_map(
        |(columns, rows, size, changes)| {
            let node = |i: usize, j: usize| i + j * (columns + 1);
            let cells = || (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
            let mut definition = MeshDefinition {
                nodes: (0..=rows)
                    .flat_map(|j| (0..=columns).map(move |i| [size * i as f64, size * j as f64]))
                    .collect(),
                parts: vec![crate::mesh::Part::new("left", PlaneModel::PlaneStrain, 1.0)],
                elements: cells()
                    .map(|(i, j)| crate::mesh::ElementDefinition {
                        kind: Q4,
                        part: 0,
                        nodes: vec![node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)],
                    })
                    .collect(),
                ..MeshDefinition::default()
            };
            for (place, what, number, index) in changes {
                let count = definition.nodes.len();
                let element = place.index(definition.elements.len());
                let kinds = [T3, T6, Q4, Q8];
                match what {
                    0..3 => definition.nodes[place.index(count)][usize::from(what & 1)] = number,
                    3 => definition.elements[element].nodes[place.index(4) % 3] = index,
                    4 => definition.elements[element].kind = kinds[place.index(kinds.len())],
                    5 => definition.elements[element].part = index,
                    6 => definition.parts[0].thickness = number,
                    7 => drop(definition.node_sets.insert("nodes".into(), vec![index, place.index(count)])),
                    _ => {
                        let edges = vec![ElementEdge { element: index, edge: 1 }, ElementEdge { element, edge: index }];
                        definition.edge_sets.insert("edges".into(), edges);
                    }
                }
            }
            definition
        },
    )
}

proptest! {
    #![proptest_config(fuzz::config(500))]

    #[test]
    fn any_bytes_do_no_harm(bytes in vec(any::<u8>(), 0..300), begins in 0..3_u8) {
        let header: &[u8] = match begins {
            0 => b"",
            1 => b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n",
            _ => b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Entities\n",
        };
        read_and_look(&[header, &bytes].concat(), &["left"]);
    }

    #[test]
    fn wild_numbers_do_no_harm(text in wild_file()) {
        read_and_look(text.as_bytes(), &["left"]);
    }

    #[test]
    fn wild_definitions_do_no_harm(definition in wild_definition()) {
        look(definition);
    }
}

proptest! {
    #![proptest_config(fuzz::config(3000))]

    #[test]
    fn damaged_files_do_no_harm(original in any::<Index>(), changes in damage()) {
        let originals = originals();
        let (bytes, names) = &originals[original.index(originals.len())];
        read_and_look(&damaged(bytes, &changes), names);
    }
}

//! Concrete in front of a fibre and at its back, from the case to the curve.

use super::run;
use crate::program::{Desk, Run, Table, xml_of_fields};
use end_to_end_tests::worst;
use fe_core::element::ElementKind;
use fe_core::mesh::specimen::{FibreMesh, PerpendicularFibre, perpendicular_fibre};
use fe_core::mesh::{ElementDefinition, MeshDefinition};
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Makes a fibre in elastic concrete, whose bond carries 3 MPa in the normal direction.
fn fibre(specimen: Value, slip: f64) -> Value {
    let mut case = super::fibre(specimen, slip);
    case["contact"]["law"]["props"]["p_0"] = json!(3);
    case["contact"]["law"]["props"]["mu"] = json!(0.1);
    case["steps"][0]["increments"]["maximum"] = json!(0.05);
    case
}

fn peak(run: &Run) -> f64 {
    run.history.column("load").iter().copied().fold(0.0, f64::max)
}

fn perpendicular(cover: bool) -> PerpendicularFibre {
    let mesh = FibreMesh { embedded_elements: 10, exit_size: None, interface_size: 0.4, ..FibreMesh::default() };
    PerpendicularFibre { cover, mesh, ..PerpendicularFibre::default() }
}

/// A Gmsh file of a mesh: each part and edge set a physical group; curves go as their elements have them, or `turned`.
pub(super) fn gmsh(definition: &MeshDefinition, turned: bool) -> String {
    let node_sets = ["grip", "sides", "exit", "tail"].map(|name| (name, &definition.node_sets[name]));
    let names = definition.parts.iter().map(|part| (2, part.name.as_str()));
    let names = names.chain(definition.edge_sets.keys().map(|name| (1, name.as_str())));
    let names: Vec<(usize, &str)> = names.chain(node_sets.map(|(name, _)| (0, name))).collect();
    let tag = |name: &str| names.iter().position(|(_, other)| *other == name).unwrap() + 1;
    let mut lines: Vec<(usize, usize, Vec<usize>)> = Vec::new();
    let numbers = [(ElementKind::T3, 2), (ElementKind::Q4, 3), (ElementKind::T6, 9), (ElementKind::Q8, 16)];
    for element in &definition.elements {
        let (_, number) = numbers.into_iter().find(|(kind, _)| *kind == element.kind).expect("a kind with a number");
        lines.push((number, tag(&definition.parts[element.part].name), element.nodes.clone()));
    }
    for (name, edges) in &definition.edge_sets {
        for edge in edges {
            let element = &definition.elements[edge.element];
            let (local, count) = element.kind.edge_nodes(edge.edge);
            let mut nodes: Vec<usize> = local[..count].iter().map(|&k| element.nodes[k]).collect();
            if turned {
                nodes.swap(0, 1);
            }
            lines.push((if count == 3 { 8 } else { 1 }, tag(name), nodes));
        }
    }
    for (name, nodes) in node_sets {
        lines.extend(nodes.iter().map(|&node| (15, tag(name), vec![node])));
    }
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n", names.len());
    for (dimension, name) in &names {
        text.push_str(&format!("{dimension} {} \"{name}\"\n", tag(name)));
    }
    text.push_str(&format!("$EndPhysicalNames\n$Nodes\n{}\n", definition.nodes.len()));
    for (node, [x, y]) in definition.nodes.iter().enumerate() {
        text.push_str(&format!("{} {x} {y} 0\n", node + 1));
    }
    text.push_str(&format!("$EndNodes\n$Elements\n{}\n", lines.len()));
    for (number, (kind, tag, nodes)) in lines.iter().enumerate() {
        let nodes: Vec<String> = nodes.iter().map(|node| (node + 1).to_string()).collect();
        text.push_str(&format!("{} {kind} 2 {tag} {tag} {}\n", number + 1, nodes.join(" ")));
    }
    text + "$EndElements\n"
}

/// Returns the case with its fibre from a file.
pub(super) fn from_file(mut case: Value) -> Value {
    case["mesh"] = json!({ "file": "fibre.msh" });
    case["parts"]["fibre"]["model"] = json!("plane_stress");
    case["parts"]["fibre"]["thickness"] = json!(std::f64::consts::FRAC_PI_4 * 0.406);
    case["parts"]["matrix"]["thickness"] = json!(3.26);
    case["parts"]["cover"] = case["parts"]["matrix"].clone();
    case["parts"]["cover"]["thickness"] = json!(3.26 - 0.406);
    let law = case["contact"]["law"].clone();
    let pair = |side: &str| {
        json!({ "name": side, "slave": format!("hole_{side}"), "master": format!("fibre_{side}"), "law": law,
                "width": std::f64::consts::FRAC_PI_2 * 0.406 })
    };
    case["contact"] = json!([pair("left"), pair("right")]);
    case["grip"] = json!({ "nodes": "grip", "direction": "y" });
    case["supports"] = json!({ "sides": {} });
    case["measure"] = json!({ "exit": "exit", "tail": "tail" });
    case
}

#[test]
#[ignore = "long: the stiffness with a cover is that of a solid below, and a file may have one"]
fn a_cover_is_of_the_matrix_and_joins_the_halves() {
    let desk = Desk::new();
    let mut case = fibre(json!({ "type": "inclined_fibre", "angle_deg": 45, "mesh_size": 2 }), 0.1);
    case["output"] = json!({ "vtu": 1000 });
    let specimen = |name: &str, more: Value| {
        let mut case = case.clone();
        let given = case["mesh"]["specimen"].as_object_mut().unwrap();
        given.extend(more.as_object().unwrap().clone());
        run(&desk, name, &case)
    };
    let without = specimen("without", json!({ "cover": false }));
    let with = specimen("with", json!({ "cover": true }));
    let graded = specimen("graded", json!({ "cover": true, "graded_thickness": { "slope": 1.0 } }));
    // the halves no longer come apart where the bond opens, and a thinner block is softer
    assert!(peak(&with) > 1.05 * peak(&without), "{} and {} N", peak(&with), peak(&without));
    assert!(peak(&graded) < peak(&with), "{} and {} N", peak(&graded), peak(&with));
    for run in [&with, &graded] {
        let worst = worst(run.history.column("energy_error").iter().map(|error| error.abs()));
        assert!(worst < 1e-3, "{worst:e}");
        let report = std::fs::read_to_string(run.folder.join("report.html")).expect("a report");
        assert!(report.contains("plane strain, thickness 2.854 mm"), "the part 'cover' is reported");
        let picture = std::fs::read_to_string(run.folder.join("plots/deformed_mesh.svg")).expect("a picture");
        assert!(picture.contains("cover"));
        let fields = xml_of_fields(&run.folder.join("fields/000000.vtu"));
        assert!(fields.contains("part cover") && fields.contains("\"thickness\""));
    }
}

#[test]
fn a_file_may_have_a_cover() {
    let desk = Desk::new();
    let generated = json!({ "type": "perpendicular_fibre", "cover": true, "embedded_elements": 10, "equal_sizes": true,
                            "interface_size": 0.4 });
    let expected = run(&desk, "generated", &fibre(generated, 0.05));
    let definition = perpendicular_fibre(&perpendicular(true)).unwrap().definition;
    // whichever side of the walls the curves are on
    for turned in [false, true] {
        desk.write("fibre.msh", &gmsh(&definition, turned));
        let found = run(&desk, &format!("file-{turned}"), &from_file(fibre(json!({}), 0.05)));
        let (expected, found) = (expected.history.column("load"), found.history.column("load"));
        let scale = expected.iter().copied().fold(0.0, f64::max);
        let rows = expected.len();
        assert!((found[rows - 1] / expected[rows - 1] - 1.0).abs() < 1e-6, "{expected:?} {found:?}");
        assert!(scale > 20.0);
    }
}

/// One Q8 from wall to wall, with a middle node of its own in the middle of the hole: its lower end lies on two edges of the
/// hole's end and on the fibre's tail.
#[test]
fn a_cover_may_end_between_the_nodes_of_the_hole() {
    let desk = Desk::new();
    let mut definition = perpendicular_fibre(&perpendicular(false)).unwrap().definition;
    definition.parts.push(fe_core::mesh::Part::new("cover", fe_core::kinematics::PlaneModel::PlaneStrain, 1.0));
    let walls = ["hole_left", "hole_right"].map(|wall| {
        let nodes = definition.edge_sets[wall].iter().flat_map(|edge| {
            let element = &definition.elements[edge.element];
            let (local, _) = element.kind.edge_nodes(edge.edge);
            local.map(|k| element.nodes[k])
        });
        let mut nodes: Vec<usize> = BTreeSet::from_iter(nodes).into_iter().collect();
        nodes.sort_by(|&a, &b| definition.nodes[a][1].total_cmp(&definition.nodes[b][1]));
        nodes
    });
    let mut across = |row: usize| {
        let [[x, y], [u, v]] = [walls[0][row], walls[1][row]].map(|node| definition.nodes[node]);
        definition.nodes.push([0.5 * (x + u), 0.5 * (y + v)]);
        definition.nodes.len() - 1
    };
    let middles: Vec<usize> = (0..walls[0].len()).step_by(2).map(&mut across).collect();
    let [left, right] = &walls;
    for (cell, ends) in middles.windows(2).enumerate() {
        let [low, middle, high] = [2 * cell, 2 * cell + 1, 2 * cell + 2];
        let corners = [left[low], right[low], right[high], left[high]];
        let nodes = [corners, [ends[0], right[middle], ends[1], left[middle]]].concat();
        definition.elements.push(ElementDefinition { kind: ElementKind::Q8, part: 2, nodes });
    }
    desk.write("fibre.msh", &gmsh(&definition, false));
    let found = run(&desk, "across", &from_file(fibre(json!({}), 0.05)));
    assert!((29.0..31.2).contains(&peak(&found)), "{} N", peak(&found));
    assert!(found.outcome.stderr.contains("hangs on edge"), "{}", found.outcome.stderr);
}

#[test]
fn what_a_cover_cannot_be_is_reported() {
    let desk = Desk::new();
    let refused = |specimen: Value, part: Option<&str>, words: &str| {
        let mut case = fibre(specimen, 0.1);
        if let Some(part) = part {
            case["parts"][part] = case["parts"]["matrix"].clone();
        }
        let path = desk.case("refused.json", &case);
        let outcome = desk.pullout(["check".as_ref(), path.as_os_str()]).expect(2);
        assert!(outcome.stderr.contains(words), "{}", outcome.stderr);
    };
    let inclined = |more: Value| {
        let mut specimen = json!({ "type": "inclined_fibre", "mesh_size": 2 });
        specimen.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        specimen
    };
    refused(inclined(json!({ "cover": true })), Some("cover"), "parts.cover");
    refused(inclined(json!({ "cover": true, "matrix_thickness": 0.4 })), None, "matrix_thickness");
    refused(inclined(json!({ "graded_thickness": { "slope": 0 } })), None, "slope");
    refused(json!({ "type": "perpendicular_fibre", "axisymmetric": true, "cover": true }), None, "mesh.specimen.cover");
    let mut case = fibre(inclined(json!({ "graded_thickness": { "slope": 1.0 } })), 0.1);
    case["supports"] = json!("face_near");
    let path = desk.case("held.json", &case);
    let outcome = desk.pullout(["check".as_ref(), path.as_os_str()]).expect(0);
    assert!(outcome.stderr.contains("graded thickness"), "{} {}", outcome.stdout, outcome.stderr);
}

/// The stiffness of a fibre's end that moves along it or across it, N/mm, in a block that it is bonded to for good.
fn stiffness(desk: &Desk, degrees: f64, thickness: f64, lateral: bool, more: Value) -> f64 {
    let mut specimen = json!({ "type": "inclined_fibre", "shape": "straight", "angle_deg": degrees, "free_length": 0.25,
                               "exit_radius": 0.06, "matrix_thickness": thickness });
    specimen.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    let elastic =
        |modulus: f64, poisson: f64| json!({ "plugin": "linear_elastic", "props": { "E": modulus, "nu": poisson } });
    let bond = json!({ "normal_law": "hard", "p_0": 1e9, "delta_N": 0.004, "k_e": 1e7, "a_1": 1e6, "b_1": 0.1,
                       "a_2": 1e6, "b_2": -0.1, "tau_res": 0, "k_u": 0, "mu": 0 });
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let case = json!({
        "kind": "pullout",
        "mesh": { "specimen": specimen },
        "parts": {
            "fibre": { "material": elastic(210e3, 0.3) }, "matrix": { "material": elastic(23.7e3, 0.15) }
        },
        "contact": { "law": { "plugin": "bond_slip", "props": bond }, "penalty_factor": 1000, "enforcement": "penalty" },
        "grip": { "direction": if lateral { [cosine, -sine] } else { [sine, cosine] }, "lateral": "free" },
        "steps": [ { "slip": 1e-3, "increments": 1 } ],
        "output": { "vtu": false, "plots": false },
    });
    let found = run(desk, "stiffness", &case);
    found.history.last("load") / found.history.last("slip")
}

/// Solids of a half model (`tests/reference/inclined_fibre`), the finest mesh of each.
#[test]
fn with_cover_and_graded_thickness_a_fibre_is_as_stiff_as_in_space() {
    let desk = Desk::new();
    let reference = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/reference/inclined_fibre/solid.csv");
    let solid = Table::read(std::path::Path::new(reference));
    let finest = solid.rows.iter().filter(|row| row[2] == 3.0);
    for row in finest {
        for (lateral, expected) in [(false, row[4]), (true, row[5])] {
            let with = stiffness(&desk, row[0], row[1], lateral, json!({ "cover": true, "graded_thickness": {} }));
            let off = with / expected - 1.0;
            assert!(off.abs() < 0.2, "{}°, {} mm, lateral {lateral}: {with} N/mm, {off:+.3}", row[0], row[1]);
        }
    }
}

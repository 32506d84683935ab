use super::*;
use crate::mesh::Mesh;
use crate::mesh::specimen::{ContactSurfaces, SurfaceRole};

const ANGLES: [f64; 10] = [0.0, 2.0, 5.0, 14.0, 19.5, 27.0, 45.0, 60.0, 70.0, 75.0];

fn outsides() -> [Outside; 3] {
    [Outside::Bent { radius: None, length: 3.0 }, Outside::Straight { length: 0.0 }, Outside::Straight { length: 1.0 }]
}

fn made(degrees: f64, outside: Outside) -> (InclinedFibre, Specimen, Mesh) {
    let parameters = InclinedFibre { angle: degrees.to_radians(), outside, ..InclinedFibre::default() };
    let specimen = inclined_fibre(&parameters).unwrap_or_else(|error| panic!("{degrees}° {outside:?}: {error}"));
    let mesh = Mesh::new(specimen.definition.clone()).unwrap_or_else(|error| panic!("{degrees}° {outside:?}: {error}"));
    (parameters, specimen, mesh)
}

fn pair<'s>(specimen: &'s Specimen, name: &str) -> &'s ContactSurfaces {
    specimen.contact_pairs.iter().find(|pair| pair.name == name).unwrap()
}

#[test]
fn every_inclination_gives_a_mesh_of_the_right_areas() {
    for degrees in ANGLES {
        for outside in outsides() {
            let (parameters, _, mesh) = made(degrees, outside);
            let area = |part: usize| -> f64 {
                let elements = (0..mesh.elements().len()).filter(|&e| mesh.elements()[e].part() == part);
                elements.map(|element| mesh.element_area(element)).sum()
            };
            let fibre = parameters.fibre_diameter * (parameters.embedded_length + parameters.outer_end());
            assert!((area(0) / fibre - 1.0).abs() < 1e-4, "{degrees}° {outside:?}: fibre {}", area(0));
            // the hole is a rectangle cut by the face; what the rounded edges take is small
            let hole = parameters.fibre_diameter * parameters.embedded_length;
            let block = parameters.width * parameters.depth - hole;
            let missing = block - area(1);
            assert!(missing > 0.0 && missing < 0.35, "{degrees}° {outside:?}: {missing}");
            let count = mesh.elements().len();
            assert!((500..4000).contains(&count), "{degrees}° {outside:?}: {count} elements");
        }
    }
}

#[test]
fn walls_are_nested_in_the_fibre_and_lie_on_it() {
    for degrees in ANGLES {
        for outside in outsides() {
            let (_, specimen, mesh) = made(degrees, outside);
            for name in ["interface_left", "interface_right"] {
                let ContactSurfaces { slave, master, role, .. } = pair(&specimen, name);
                assert_eq!(*role, SurfaceRole::Bonded);
                let positions = |set: &str| -> Vec<Vec<[f64; 2]>> {
                    let edges = mesh.edge_set(set).unwrap().iter();
                    edges
                        .map(|&edge| mesh.edge_nodes(edge).nodes().iter().map(|&n| mesh.nodes()[n]).collect())
                        .collect()
                };
                let masters = positions(master);
                for edge in positions(slave) {
                    // the same nodes, in the other direction
                    let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12;
                    let same = |m: &&Vec<[f64; 2]>| near(m[0], edge[1]) && near(m[1], edge[0]) && near(m[2], edge[2]);
                    assert_eq!(masters.iter().filter(same).count(), 1, "{degrees}° {outside:?} {name} {edge:?}");
                }
            }
        }
    }
}

#[test]
fn the_bonded_length_is_the_embedded_one_but_for_the_exit() {
    let (parameters, specimen, mesh) = made(60.0, Outside::Straight { length: 0.0 });
    let length = |set: &str| -> f64 {
        let edges = mesh.edge_set(set).unwrap().iter();
        let ends = edges.map(|&edge| [0, 1].map(|k| mesh.nodes()[mesh.edge_nodes(edge).nodes()[k]]));
        ends.map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum()
    };
    let axis = parameters.axis();
    let start = axis.exit_start(0.203, 0.1015);
    assert!((length(&pair(&specimen, "interface_left").slave) - 12.2 - start).abs() < 1e-9, "{start}");
    // on the other side the wall reaches above the end of the fibre
    assert!((length(&pair(&specimen, "interface_right").slave) - 12.2).abs() < 1e-9);
    assert!(length("hole_beyond") > 0.1);
    // the rounded edge turns by 90° + θ
    let arc = length("hole_exit_left") / (0.1015 * (150.0_f64).to_radians());
    assert!((0.97..1.0).contains(&arc), "{arc}");
}

#[test]
fn loading_at_the_exit_hangs_on_a_node_that_moves_by_the_mean() {
    let (_, specimen, mesh) = made(45.0, Outside::Straight { length: 0.0 });
    let grip = mesh.node_set("grip").unwrap();
    assert_eq!((grip.len(), mesh.free_nodes()), (1, grip.to_vec()));
    assert!(mesh.nodes()[grip[0]][0].abs() < 1e-12 && mesh.nodes()[grip[0]][1].abs() < 1e-12);
    let [coupling] = &specimen.couplings[..] else { panic!("one coupling") };
    // a rigid motion, turned about the grip's node, leaves it where it is
    let moved = |node: usize| {
        let [x, y] = mesh.nodes()[node];
        [0.3 - 0.2 * y, -0.1 + 0.2 * x]
    };
    for component in 0..2 {
        let sum: f64 = coupling.terms.iter().map(|&(node, factor)| factor * moved(node)[component]).sum();
        assert!((sum - moved(coupling.dependent)[component]).abs() < 1e-12);
    }
}

#[test]
fn sizes_scale_with_one_parameter() {
    let count = |size: f64| {
        let mesh = InclinedMesh { size, ..InclinedMesh::default() };
        let specimen = inclined_fibre(&InclinedFibre { mesh, ..InclinedFibre::default() }).unwrap();
        specimen.definition.elements.len()
    };
    let counts = [2.0, 1.4, 1.0, 0.7, 0.5].map(count);
    assert!(counts.windows(2).all(|pair| pair[1] as f64 > 1.25 * pair[0] as f64), "{counts:?}");
}

#[test]
fn separation_divides_the_walls_at_its_length() {
    let parameters = InclinedFibre { separation_length: 0.8, ..InclinedFibre::default() };
    let specimen = inclined_fibre(&parameters).unwrap();
    let names: Vec<&str> = specimen.contact_pairs.iter().map(|pair| pair.name.as_str()).collect();
    assert_eq!(
        names,
        ["interface_left", "interface_right", "separation_left", "separation_right", "exit_left", "exit_right"]
    );
    assert_eq!(pair(&specimen, "separation_left").role, SurfaceRole::Separation);
    assert_eq!(pair(&specimen, "exit_left").role, SurfaceRole::Exit);
}

#[test]
fn what_cannot_be_is_told_at_once() {
    let parameters = InclinedFibre {
        angle: 1.5,
        width: 5.0,
        matrix: PartMesh { kind: ElementKind::Q8, integration: None },
        outside: Outside::Bent { radius: Some(0.1), length: 0.0 },
        ..InclinedFibre::default()
    };
    let SpecimenError::Parameters { problems } = inclined_fibre(&parameters).unwrap_err() else { panic!("parameters") };
    let names: Vec<&str> = problems.iter().map(|problem| problem.name).collect();
    for name in ["angle_deg", "embedded_length", "matrix_element", "bend_radius", "free_length"] {
        assert!(names.contains(&name), "{name} in {names:?}");
    }
}

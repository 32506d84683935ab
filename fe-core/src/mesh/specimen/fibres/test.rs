use super::*;
use crate::mesh::Mesh;
use crate::mesh::specimen::{ContactSurfaces, SurfaceRole};
use std::f64::consts::FRAC_PI_6;

const ANGLES: [f64; 10] = [0.0, 2.0, 5.0, 14.0, 19.5, 27.0, 45.0, 60.0, 70.0, 75.0];

type Shape = (&'static str, fn(f64) -> Fibre);

const SHAPES: [Shape; 3] = [
    ("bent", |angle| Fibre::bent(angle, None, 3.0)),
    ("A", |angle| Fibre::straight(angle, 0.0)),
    ("B", |angle| Fibre::straight(angle, 1.0)),
];

fn alone(fibre: Fibre) -> Fibres {
    Fibres { fibres: vec![fibre], ..Fibres::default() }
}

fn made(parameters: &Fibres) -> (Specimen, Mesh) {
    let specimen = fibres(parameters).unwrap_or_else(|error| panic!("{error}"));
    let mesh = Mesh::new(specimen.definition.clone()).unwrap_or_else(|error| panic!("{error}"));
    (specimen, mesh)
}

fn area(mesh: &Mesh, part: usize) -> f64 {
    let elements = (0..mesh.elements().len()).filter(|&e| mesh.elements()[e].part() == part);
    elements.map(|element| mesh.element_area(element)).sum()
}

fn pair<'s>(specimen: &'s Specimen, name: &str) -> &'s ContactSurfaces {
    specimen.contact_pairs.iter().find(|pair| pair.name == name).unwrap()
}

#[test]
fn every_inclination_gives_a_mesh_of_the_right_areas() {
    for degrees in ANGLES {
        for (shape, fibre) in SHAPES {
            let parameters = alone(fibre(degrees.to_radians()));
            let (_, mesh) = made(&parameters);
            let Laid { fibre, path, .. } = &parameters.laid().unwrap()[0];
            let whole = fibre.diameter * (fibre.embedded_length + path.end());
            assert!((area(&mesh, 0) / whole - 1.0).abs() < 1e-4, "{degrees}° {shape}: fibre {}", area(&mesh, 0));
            // the hole is a rectangle cut by the face; what the rounded edges take is small
            let hole = fibre.diameter * fibre.embedded_length;
            let block = parameters.width * parameters.depth - hole;
            let missing = block - area(&mesh, 1);
            assert!(missing > 0.0 && missing < 0.35, "{degrees}° {shape}: {missing}");
            let count = mesh.elements().len();
            assert!((500..4000).contains(&count), "{degrees}° {shape}: {count} elements");
        }
    }
}

#[test]
fn walls_are_nested_in_the_fibre_and_lie_on_it() {
    for degrees in ANGLES {
        for (shape, fibre) in SHAPES {
            let (specimen, mesh) = made(&alone(fibre(degrees.to_radians())));
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
                    assert_eq!(masters.iter().filter(same).count(), 1, "{degrees}° {shape} {name} {edge:?}");
                }
            }
        }
    }
}

#[test]
fn the_bonded_length_is_the_embedded_one_but_for_the_exit() {
    let parameters = alone(Fibre::straight(60.0_f64.to_radians(), 0.0));
    let (specimen, mesh) = made(&parameters);
    let length = |set: &str| -> f64 {
        let edges = mesh.edge_set(set).unwrap().iter();
        let ends = edges.map(|&edge| [0, 1].map(|k| mesh.nodes()[mesh.edge_nodes(edge).nodes()[k]]));
        ends.map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum()
    };
    let start = parameters.laid().unwrap()[0].path.exit_start(0.203, 0.1015, 5.0).unwrap();
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
    let (specimen, mesh) = made(&alone(Fibre::straight(45.0_f64.to_radians(), 0.0)));
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
        let mesh = FibresMesh { size, ..FibresMesh::default() };
        let specimen = fibres(&Fibres { mesh, ..alone(Fibre::bent(0.785, None, 3.0)) }).unwrap();
        specimen.definition.elements.len()
    };
    let counts = [2.0, 1.4, 1.0, 0.7, 0.5].map(count);
    assert!(counts.windows(2).all(|pair| pair[1] as f64 > 1.25 * pair[0] as f64), "{counts:?}");
}

/// Coarse meshes in which a curved wall would close a narrow corner of a triangle: `Mesh::new` refuses a fold.
#[test]
fn no_corner_is_folded_by_a_curved_edge() {
    for degrees in 76..=80 {
        for size in [2.0, 2.5, 3.0, 4.0] {
            let mesh = FibresMesh { size, ..FibresMesh::default() };
            made(&Fibres { mesh, ..alone(Fibre::bent(f64::from(degrees).to_radians(), None, 3.0)) });
        }
    }
}

#[test]
fn separation_divides_the_walls_at_its_length() {
    let (specimen, _) = made(&alone(Fibre { separation_length: 0.8, ..Fibre::bent(0.785, None, 3.0) }));
    let names: Vec<&str> = specimen.contact_pairs.iter().map(|pair| pair.name.as_str()).collect();
    assert_eq!(
        names,
        ["interface_left", "interface_right", "separation_left", "separation_right", "exit_left", "exit_right"]
    );
    assert_eq!(pair(&specimen, "separation_left").role, SurfaceRole::Separation);
    assert_eq!(pair(&specimen, "exit_left").role, SurfaceRole::Exit);
}

fn problems(parameters: &Fibres) -> String {
    match fibres(parameters) {
        Err(SpecimenError::Parameters { problems }) => {
            problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn impossible_parameters_are_reported_at_once() {
    let bent = Fibre { embedded_length: -1.0, ..Fibre::bent(0.5, Some(0.1), 3.0) };
    let matrix_element = ElementKind::Q8;
    let messages = problems(&Fibres { width: 0.0, matrix_element, ..alone(bent) });
    for name in ["width", "embedded_length", "matrix_element", "bend_radius"] {
        assert!(messages.contains(name), "{name} in {messages}");
    }
    let messages = problems(&Fibres { width: 5.0, ..alone(Fibre::bent(1.3, None, 3.0)) });
    assert!(
        messages.starts_with("embedded_length is 12.2, it must be such that the fibre stays in the block"),
        "{messages}"
    );
    assert!(problems(&alone(Fibre::straight(1.5, 1.0))).starts_with("angle_deg is 85.9°"));
}

fn named(name: &str, exit: f64, fibre: Fibre) -> Fibre {
    Fibre { name: Some(name.to_owned()), exit, ..fibre }
}

/// Two fibres at a spacing that lean away from each other by an angle.
fn pair_of(spacing: f64, angle: f64) -> Fibres {
    let fibre = |name: &str, side: f64| named(name, 0.5 * side * spacing, Fibre::bent(-side * angle, None, 3.0));
    Fibres { fibres: vec![fibre("left", -1.0), fibre("right", 1.0)], ..Fibres::default() }
}

#[test]
fn fibres_stand_side_by_side_each_with_its_parts_sets_and_pairs() {
    for (spacing, angle) in [(0.812, 0.0), (0.812, FRAC_PI_6), (6.5, FRAC_PI_6), (2.436, -0.05)] {
        let (specimen, mesh) = made(&pair_of(spacing, angle));
        let names: Vec<&str> = mesh.parts().iter().map(|part| part.name.as_str()).collect();
        assert_eq!(names, ["fibre.left", "fibre.right", "matrix"]);
        assert!((area(&mesh, 0) / area(&mesh, 1) - 1.0).abs() < 1e-12);
        let holes = 25.4 * 12.7 - area(&mesh, 2);
        assert!((9.9..10.6).contains(&holes), "{spacing} {angle}: {holes}");
        let pairs: Vec<&str> = specimen.contact_pairs.iter().map(|pair| pair.name.as_str()).collect();
        let of = |name: &str| ["left", "right", "exit.left", "exit.right"].map(|side| format!("{name}.{side}"));
        assert_eq!(pairs, [of("left"), of("right")].concat());
        for pair in &specimen.contact_pairs {
            assert!(mesh.edge_set(&pair.slave).is_some() && mesh.edge_set(&pair.master).is_some(), "{pair:?}");
        }
        let grip = mesh.node_set("grip").unwrap();
        assert_eq!(grip.len(), mesh.node_set("grip.left").unwrap().len() + mesh.node_set("grip.right").unwrap().len());
        for (fibre, x) in std::iter::zip(&specimen.fibres, [-0.5 * spacing, 0.5 * spacing]) {
            let [exit_x, exit_y] = mesh.nodes()[fibre.exit_node];
            assert!((exit_x - x).abs() < 1e-12 && exit_y.abs() < 1e-12);
        }
    }
}

#[test]
fn between_fibres_close_to_each_other_there_are_three_elements() {
    let (_, mesh) = made(&pair_of(0.812, 0.0));
    // a line across the middle of the gap, from wall to wall, in the depth of the block
    for y in [-0.5, -2.0, -6.0, -11.0] {
        let crossed = (0..mesh.elements().len()).filter(|&element| {
            let (positions, _) = mesh.element_positions(element);
            let corners = &positions[..3];
            let between = corners.iter().all(|[x, _]| x.abs() < 0.204);
            let [low, high] = [f64::min, f64::max].map(|of| corners.iter().map(|p| p[1]).reduce(of).unwrap());
            mesh.elements()[element].part() == 2 && between && low < y && high > y
        });
        assert!(crossed.count() >= 3, "{y}");
    }
}

#[test]
fn mirrored_fibres_give_a_mirrored_outline() {
    let (specimen, mesh) = made(&pair_of(1.6, FRAC_PI_6));
    let positions = |name: &str| -> Vec<[f64; 2]> {
        let nodes = mesh.edge_set(name).unwrap().iter().flat_map(|&edge| mesh.edge_nodes(edge).nodes().to_vec());
        nodes.map(|node| mesh.nodes()[node]).collect()
    };
    let of = |name: &str| specimen.contact_pairs.iter().find(|pair| pair.name == name).unwrap().slave.clone();
    for (one, other) in [("left.left", "right.right"), ("left.exit.right", "right.exit.left")] {
        let (one, other) = (positions(&of(one)), positions(&of(other)));
        assert_eq!(one.len(), other.len());
        for [x, y] in one {
            assert!(other.iter().any(|[u, v]| (x + u).abs() < 1e-9 && (y - v).abs() < 1e-9), "{x} {y}");
        }
    }
}

/// A hook: the tail, two corners, the shank.
fn hooked(angle: f64) -> Fibre {
    let corner = |to: f64| Segment::Arc { radius: 0.75, to };
    let straight = |length: f64| Segment::Straight { length };
    let path = vec![straight(2.0), corner(angle - 0.785), straight(1.5), corner(angle), straight(10.0)];
    Fibre { diameter: 0.5, embedded_length: 11.0, path, ..Fibre::new(angle, Vec::new()) }
}

#[test]
fn hooks_waves_and_enlarged_ends_are_meshed_with_their_covers() {
    let wave = Segment::Wave { amplitude: 0.4, length: 8.0, count: 2.0 };
    let crimped = Fibre { embedded_length: 11.0, path: vec![wave], diameter: 0.75, ..Fibre::new(0.0, Vec::new()) };
    let profile = vec![[0.0, 0.75], [2.0, 0.5]];
    let paddled = Fibre { profile, diameter: 0.5, embedded_length: 11.0, ..Fibre::straight(0.0, 0.0) };
    let paddled = Fibre { path: vec![Segment::Straight { length: 14.0 }], ..paddled };
    for (name, fibre) in [("hook", hooked(0.0)), ("leaning hook", hooked(0.7)), ("wave", crimped), ("paddle", paddled)]
    {
        let parameters = Fibres { cover: true, ..alone(fibre) };
        let (specimen, mesh) = made(&parameters);
        let Laid { fibre, path, .. } = &parameters.laid().unwrap()[0];
        let whole: f64 =
            fibre.diameter * (fibre.embedded_length + path.end()) + if name == "paddle" { 0.25 } else { 0.0 };
        assert!((area(&mesh, 0) / whole - 1.0).abs() < 2e-3, "{name}: {} {whole}", area(&mesh, 0));
        // the cover fills the hole: together with the matrix the whole block
        let left = 25.4 * 12.7 - area(&mesh, 1) - area(&mesh, 2);
        assert!(left.abs() < 1e-9, "{name}: {left}");
        let embedded = specimen.contact_pairs.iter().filter(|pair| pair.role == SurfaceRole::Bonded);
        for pair in embedded {
            let (slave, master) = (mesh.edge_set(&pair.slave).unwrap(), mesh.edge_set(&pair.master).unwrap());
            assert!(slave.len() >= 20 && master.len() >= slave.len(), "{name}");
        }
    }
}

#[test]
fn impossible_paths_are_reported_with_their_fibre_and_place() {
    let two = |a: Fibre, b: Fibre| Fibres { fibres: vec![a, b], ..Fibres::default() };
    // tails that converge cross
    let messages = problems(&pair_of(2.0, -FRAC_PI_6));
    assert!(
        messages.starts_with("fibre 1: path is -0.3") && messages.contains("fibre 'right' (near x ="),
        "{messages}"
    );
    let messages = problems(&two(Fibre::bent(0.0, None, 3.0), Fibre { exit: 3.0, ..Fibre::bent(0.0, None, 3.0) }));
    assert!(messages.contains("name is missing"), "{messages}");
    let same = named("a", 0.0, Fibre::bent(0.0, None, 3.0));
    assert!(problems(&two(same.clone(), Fibre { exit: 3.0, ..same })).contains("fibre 2: name is a"));
    let straight = |length: f64| Segment::Straight { length };
    let arc = |radius: f64, to: f64| Segment::Arc { radius, to };
    // out of the face before its end, back into the block after it, a loop, a corner too tight, a path too short
    let of =
        |lean: f64, path: Vec<Segment>, embedded: f64| Fibre { embedded_length: embedded, ..Fibre::new(lean, path) };
    for (fibre, words) in [
        (
            of(0.0, vec![straight(3.0), arc(1.0, 3.2), straight(8.0), arc(1.0, 0.0), straight(9.0)], 20.0),
            "path is near x",
        ),
        (of(0.0, vec![straight(3.0), arc(1.0, 3.1), straight(9.0)], 3.0), "it goes back into it"),
        (of(0.0, vec![straight(3.0), arc(0.2, 1.0), straight(9.0)], 10.0), "radius of more than half"),
        (of(0.0, vec![straight(3.0)], 10.0), "not more than the length of the path, 3.000"),
        (
            of(0.0, vec![straight(5.0), arc(1.5, 4.2), straight(5.0), arc(1.5, 0.0), straight(20.0)], 35.0),
            "clear of the same fibre's other parts",
        ),
    ] {
        let messages = problems(&alone(fibre));
        assert!(messages.contains(words), "{words} in {messages}");
    }
}

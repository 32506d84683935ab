use super::*;
use crate::element::{EdgeKind, ElementKind, ElementKind::*};
use crate::kinematics::PlaneModel::*;
use crate::mesh::{Mesh, preflight};
use std::f64::consts::PI;

const AXISYMMETRIC: Configuration = Configuration::Axisymmetric { outer_radius: None };

/// A checked mesh without findings.
#[track_caller]
fn sound(definition: MeshDefinition) -> Mesh {
    let mesh = Mesh::new(definition).unwrap();
    assert_eq!(preflight::findings(&mesh, &[]), []);
    assert_eq!(mesh.free_nodes(), [0; 0]);
    mesh
}

fn part_area(mesh: &Mesh, part: &str) -> f64 {
    let index = mesh.parts().iter().position(|candidate| candidate.name == part).unwrap();
    let of_part = |&element: &usize| mesh.elements()[element].part() == index;
    (0..mesh.elements().len()).filter(of_part).map(|element| mesh.element_area(element)).sum()
}

fn positions(mesh: &Mesh, set: &str) -> Vec<[f64; 2]> {
    mesh.node_set(set).unwrap().iter().map(|&node| mesh.nodes()[node]).collect()
}

/// All nodes of the mesh of this part for which this holds.
fn nodes_where(mesh: &Mesh, part: usize, holds: impl Fn([f64; 2]) -> bool) -> Vec<usize> {
    let elements = mesh.elements().iter().filter(|element| element.part() == part);
    let mut nodes: Vec<usize> =
        elements.flat_map(|element| element.nodes()).copied().filter(|&node| holds(mesh.nodes()[node])).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// Start and end of each edge of a set, which must be a chain on the boundary.
#[track_caller]
fn chain(mesh: &Mesh, set: &str) -> Vec<[[f64; 2]; 2]> {
    let edges = mesh.edge_set(set).unwrap();
    for pair in edges.windows(2) {
        assert_eq!(mesh.edge_nodes(pair[0]).nodes()[1], mesh.edge_nodes(pair[1]).nodes()[0], "{set}");
    }
    assert!(edges.iter().all(|&edge| mesh.neighbour(edge).is_none()), "{set} is on the boundary");
    edges.iter().map(|&edge| [0, 1].map(|end| mesh.nodes()[mesh.edge_nodes(edge).nodes()[end]])).collect()
}

fn fibre_with(change: impl FnOnce(&mut PerpendicularFibre)) -> PerpendicularFibre {
    let mut parameters = PerpendicularFibre::default();
    change(&mut parameters);
    parameters
}

/// The default, plane and axisymmetric, with elements of each kind.
fn fibres_of_all_kinds() -> Vec<PerpendicularFibre> {
    let mut all = Vec::new();
    for configuration in [Configuration::Plane, AXISYMMETRIC] {
        for kind in ElementKind::ALL {
            let default = PerpendicularFibre::default();
            all.push(PerpendicularFibre { configuration, fibre_element: kind, matrix_element: kind, ..default });
        }
    }
    all
}

#[test]
fn the_default_is_the_specimen_of_chapter_6() {
    let specimen = perpendicular_fibre(&PerpendicularFibre::default()).unwrap();
    let mesh = sound(specimen.definition);
    let phi = 0.406;
    assert_eq!(
        mesh.parts().iter().map(|part| (&*part.name, part.model)).collect::<Vec<_>>(),
        [("fibre", PlaneStress), ("matrix", PlaneStrain)]
    );
    // Area of the fibre's section and circumference of two lines.
    approx::assert_relative_eq!(mesh.parts()[0].thickness * phi, PI * phi * phi / 4.0, max_relative = 1e-14);
    approx::assert_relative_eq!(2.0 * specimen.contact_pairs[0].width.unwrap(), PI * phi, max_relative = 1e-14);
    assert_eq!(mesh.parts()[1].thickness, 3.26);
    assert!(mesh.elements().iter().all(|element| element.kind() == Q8));
    approx::assert_relative_eq!(part_area(&mesh, "fibre"), phi * 15.2, max_relative = 1e-12);
    approx::assert_relative_eq!(part_area(&mesh, "matrix"), 25.4 * 12.7 - phi * 12.2, max_relative = 1e-12);
    assert_eq!(specimen.pull_direction, [0.0, 1.0]);
    assert_eq!(mesh.nodes()[specimen.fibres[0].exit_node], [0.0, 0.0]);
    assert_eq!(mesh.nodes()[specimen.fibres[0].tail_node], [0.0, -12.2]);
    assert_eq!(mesh.node_set("exit"), Some(&[specimen.fibres[0].exit_node][..]));
    assert_eq!(mesh.node_set("tail"), Some(&[specimen.fibres[0].tail_node][..]));
}

#[test]
fn sets_of_a_plane_specimen_hold_all_of_their_nodes_and_no_others() {
    for parameters in fibres_of_all_kinds().into_iter().take(4) {
        let specimen = perpendicular_fibre(&parameters).unwrap();
        let mesh = sound(specimen.definition);
        let near = 0.203 + 2.0 * 0.406;
        let expected: [(&str, Vec<usize>); 5] = [
            ("grip", nodes_where(&mesh, 0, |[_, y]| y == 3.0)),
            ("sides", nodes_where(&mesh, 1, |[x, _]| x.abs() == 12.7)),
            ("bottom", nodes_where(&mesh, 1, |[_, y]| y == -12.7)),
            ("face_near", nodes_where(&mesh, 1, |[x, y]| y == 0.0 && x.abs() >= near - 1e-9)),
            ("face_away", nodes_where(&mesh, 1, |[x, y]| y == 0.0 && x.abs() >= 9.7 - 1e-9)),
        ];
        for (name, nodes) in expected {
            assert_eq!(mesh.node_set(name).unwrap(), nodes, "{name}");
        }
        for (name, limit) in [("face_near", near), ("face_away", 9.7)] {
            let innermost = positions(&mesh, name).into_iter().map(|[x, _]| x.abs()).fold(f64::INFINITY, f64::min);
            approx::assert_abs_diff_eq!(innermost, limit, epsilon = 1e-12);
        }
        assert_eq!((mesh.node_set("axis"), mesh.node_set("outer")), (None, None));
        let ends = |set: &str| {
            let chain = chain(&mesh, set);
            [chain[0][0], chain[chain.len() - 1][1]]
        };
        let r = 0.203;
        assert_eq!(ends("fibre_left"), [[-r, 3.0], [-r, -12.2]]);
        assert_eq!(ends("fibre_right"), [[r, -12.2], [r, 3.0]]);
        assert_eq!(ends("hole_left"), [[-r, -12.2], [-r, 0.0]]);
        assert_eq!(ends("hole_right"), [[r, 0.0], [r, -12.2]]);
        assert_eq!(ends("fibre_tail"), [[-r, -12.2], [r, -12.2]]);
        assert_eq!(ends("hole_end"), [[r, -12.2], [-r, -12.2]]);
        assert_eq!(ends("bottom_face"), [[-12.7, -12.7], [12.7, -12.7]]);
        let face: f64 = mesh
            .edge_set("exit_face")
            .unwrap()
            .iter()
            .map(|&edge| {
                let [start, end] = [0, 1].map(|end| mesh.nodes()[mesh.edge_nodes(edge).nodes()[end]]);
                assert_eq!((start[1], end[1]), (0.0, 0.0));
                start[0] - end[0]
            })
            .sum();
        approx::assert_relative_eq!(face, 25.4 - 0.406, max_relative = 1e-13);
        let names: Vec<_> =
            specimen.contact_pairs.iter().map(|pair| [&*pair.name, &pair.slave, &pair.master]).collect();
        assert_eq!(
            names,
            [["interface_left", "hole_left", "fibre_left"], ["interface_right", "hole_right", "fibre_right"]]
        );
    }
}

#[test]
fn sets_of_an_axisymmetric_specimen_hold_all_of_their_nodes_and_no_others() {
    for parameters in fibres_of_all_kinds().into_iter().skip(4) {
        let specimen = perpendicular_fibre(&parameters).unwrap();
        let mesh = sound(specimen.definition);
        let radius = (25.4_f64 * 3.26 / PI).sqrt();
        approx::assert_abs_diff_eq!(radius, 5.13, epsilon = 0.005);
        assert!(mesh.parts().iter().all(|part| part.model == Axisymmetric));
        assert_eq!(mesh.node_set("outer").unwrap(), nodes_where(&mesh, 1, |[x, _]| x == radius));
        let mut axis = nodes_where(&mesh, 0, |[x, _]| x == 0.0);
        axis.extend(nodes_where(&mesh, 1, |[x, _]| x == 0.0));
        assert_eq!(mesh.node_set("axis").unwrap(), axis);
        assert!(positions(&mesh, "axis").contains(&[0.0, -12.7]) && positions(&mesh, "axis").contains(&[0.0, 3.0]));
        assert_eq!((mesh.node_set("sides"), mesh.edge_set("hole_left")), (None, None));
        assert_eq!(specimen.contact_pairs[0].width, None);
        assert_eq!(mesh.nodes()[specimen.fibres[0].exit_node], [0.0, 0.0]);
        assert_eq!(mesh.nodes()[specimen.fibres[0].tail_node], [0.0, -12.2]);
        assert_eq!(specimen.contact_pairs.len(), 1);
        let hole = chain(&mesh, &specimen.contact_pairs[0].slave);
        assert_eq!([hole[0][0], hole[hole.len() - 1][1]], [[0.203, 0.0], [0.203, -12.2]]);
        // Pappus: the volume of the matrix.
        let volume: f64 = (0..mesh.elements().len())
            .filter(|&element| mesh.elements()[element].part() == 1)
            .flat_map(|element| {
                let (nodes, count) = mesh.element_positions(element);
                let kind = mesh.elements()[element].kind();
                kind.full_integration_points().iter().map(move |point| {
                    let mapped = crate::element::MappedPoint::new(kind, &nodes[..count], point.coordinates).unwrap();
                    2.0 * PI * mapped.position[0] * mapped.determinant * point.weight
                })
            })
            .sum();
        let exact = PI * (radius * radius * 12.7 - 0.203 * 0.203 * 12.2);
        approx::assert_relative_eq!(volume, exact, max_relative = 1e-12);
    }
}

#[test]
fn fibre_and_matrix_touch_without_sharing_nodes() {
    for parameters in fibres_of_all_kinds() {
        let mesh = sound(perpendicular_fibre(&parameters).unwrap().definition);
        let bodies = preflight::bodies(&mesh);
        assert_eq!(bodies.len(), 2);
        // Held at the grip alone, the matrix floats.
        let grip: Vec<_> =
            mesh.node_set("grip").unwrap().iter().flat_map(|&n| [(n, [1.0, 0.0]), (n, [0.0, 1.0])]).collect();
        assert_eq!(preflight::rigid_body_freedom(&mesh, &bodies[0], &grip), []);
        let floating = preflight::rigid_body_freedom(&mesh, &bodies[1], &grip);
        assert_eq!(floating.len(), if parameters.configuration == AXISYMMETRIC { 1 } else { 3 });
    }
}

/// Every slave edge lies within one master edge, with ends that are the same to the bit where edges end together.
#[test]
fn slave_edges_are_nested_in_master_edges() {
    for (ratio, gap) in [(1, 0.0), (2, 0.0), (3, 0.1)] {
        for configuration in [Configuration::Plane, AXISYMMETRIC] {
            let parameters = fibre_with(|p| {
                p.configuration = configuration;
                p.mesh.slave_edges_per_master = ratio;
                p.tail_gap = gap;
            });
            let specimen = perpendicular_fibre(&parameters).unwrap();
            let mesh = sound(specimen.definition);
            for pair in &specimen.contact_pairs {
                let (slaves, masters) = (chain(&mesh, &pair.slave), chain(&mesh, &pair.master));
                assert_eq!(slaves.len(), 40 * ratio);
                let embedded: Vec<_> = masters.iter().filter(|[a, b]| a[1].max(b[1]) <= 0.0).collect();
                assert_eq!(embedded.len(), 40);
                for (index, master) in embedded.iter().rev().enumerate() {
                    let within = &slaves[index * ratio..(index + 1) * ratio];
                    assert_eq!(within[0][0], master[1]);
                    assert_eq!(within[ratio - 1][1], master[0]);
                }
            }
        }
    }
}

#[test]
fn the_hole_can_be_longer_than_the_fibre() {
    for configuration in [Configuration::Plane, AXISYMMETRIC] {
        let mesh = sound(
            perpendicular_fibre(&fibre_with(|p| {
                p.configuration = configuration;
                p.tail_gap = 0.2;
            }))
            .unwrap()
            .definition,
        );
        let half = if configuration == AXISYMMETRIC { 0.5 } else { 1.0 };
        let end = chain(&mesh, "hole_end");
        approx::assert_abs_diff_eq!(end[0][0][1], -12.4, epsilon = 1e-12);
        approx::assert_abs_diff_eq!(end[0][0][0] - end[end.len() - 1][1][0], half * 0.406, epsilon = 1e-12);
        let width = if configuration == AXISYMMETRIC { (25.4_f64 * 3.26 / PI).sqrt() } else { 25.4 };
        approx::assert_relative_eq!(
            part_area(&mesh, "matrix"),
            width * 12.7 - half * 0.406 * 12.4,
            max_relative = 1e-12
        );
    }
}

#[test]
fn a_plane_specimen_is_its_own_mirror_image() {
    for parameters in fibres_of_all_kinds().into_iter().take(4) {
        let mesh = sound(perpendicular_fibre(&parameters).unwrap().definition);
        // Each element by its corners, to the bit; its mirror image must be there.
        let key = |element: &crate::mesh::Element, sign: f64| {
            let corners = &element.nodes()[..element.kind().corner_count()];
            let mut positions: Vec<[u64; 2]> = corners
                .iter()
                .map(|&node| {
                    let [x, y] = mesh.nodes()[node];
                    // + 0.0: one zero.
                    [(sign * x + 0.0).to_bits(), (y + 0.0).to_bits()]
                })
                .collect();
            positions.sort_unstable();
            (element.part(), positions)
        };
        let all: std::collections::BTreeSet<_> = mesh.elements().iter().map(|element| key(element, 1.0)).collect();
        for element in mesh.elements() {
            assert!(all.contains(&key(element, -1.0)), "{element:?}");
        }
    }
}

#[test]
fn sizes_start_at_the_interface_and_the_exit() {
    let mesh = sound(perpendicular_fibre(&PerpendicularFibre::default()).unwrap().definition);
    let hole = chain(&mesh, "hole_right");
    approx::assert_relative_eq!(hole[0][0][1] - hole[0][1][1], 0.15, max_relative = 1e-9);
    assert!(hole.windows(2).all(|pair| pair[1][0][1] - pair[1][1][1] > pair[0][0][1] - pair[0][1][1]));
    let mut face: Vec<f64> =
        mesh.edge_set("exit_face").unwrap().iter().map(|&e| mesh.nodes()[mesh.edge_nodes(e).nodes()[0]][0]).collect();
    face.sort_by(f64::total_cmp);
    let right: Vec<f64> = std::iter::once(0.203).chain(face.into_iter().filter(|&x| x > 0.21)).collect();
    let sizes: Vec<f64> = right.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!((0.08..0.125).contains(&sizes[0]), "{}", sizes[0]);
    // Each piece between stops is scaled to fill it.
    assert!(sizes.iter().all(|&size| size < 1.3 * 2.0));
    assert!(sizes.windows(2).all(|pair| (0.5..2.0).contains(&(pair[1] / pair[0]))), "{sizes:?}");
    // Equal sizes where no exit size is given.
    let equal = sound(perpendicular_fibre(&fibre_with(|p| p.mesh.exit_size = None)).unwrap().definition);
    for [start, end] in chain(&equal, "hole_right") {
        approx::assert_relative_eq!(start[1] - end[1], 12.2 / 40.0, max_relative = 1e-12);
    }
}

/// Parameters at random within wide bounds: always a sound mesh of the right area.
#[test]
fn specimens_are_sound_over_a_range_of_parameters() {
    let mut numbers = end_to_end_tests::Random::new(42);
    let mut random = move |low: f64, high: f64| numbers.between(low, high);
    for trial in 0..60 {
        let kinds = [(); 2].map(|()| ElementKind::ALL[random(0.0, 4.0) as usize]);
        let diameter = random(0.1, 2.0);
        let embedded = random(2.0, 30.0);
        let gap = if trial % 3 == 0 { random(0.0, 0.5) } else { 0.0 };
        let width = random(3.0 * diameter, 40.0);
        let matrix_thickness = random(0.8 * diameter, 5.0);
        let parameters = PerpendicularFibre {
            configuration: if trial % 2 == 0 {
                Configuration::Plane
            } else {
                Configuration::Axisymmetric { outer_radius: Some(0.5 * width) }
            },
            width,
            depth: embedded + gap + random(0.05, 10.0),
            matrix_thickness,
            cover: trial % 4 == 0 && matrix_thickness > 1.1 * diameter,
            graded_thickness: None,
            fibre_diameter: diameter,
            embedded_length: embedded,
            free_length: random(0.1, 6.0),
            tail_gap: gap,
            fibre_element: kinds[0],
            matrix_element: kinds[1],
            mesh: FibreMesh {
                embedded_elements: 1 + random(1.0, 40.0) as usize,
                exit_size: (trial % 4 != 0).then(|| random(0.02, 1.0)),
                elements_across: 2 * random(1.0, 4.0) as usize,
                slave_edges_per_master: random(1.0, 4.0) as usize,
                interface_size: random(0.1, 1.0) * diameter,
                growth: random(1.0, 1.8),
                largest_size: random(0.5, 4.0),
            },
        };
        let specimen = perpendicular_fibre(&parameters).unwrap_or_else(|error| panic!("{error}: {parameters:?}"));
        let mesh = sound(specimen.definition);
        let axisymmetric = trial % 2 == 1;
        let (half, matrix_width) = if axisymmetric { (0.5, 0.5 * width) } else { (1.0, width) };
        let hole = half * diameter * (embedded + gap);
        approx::assert_relative_eq!(
            part_area(&mesh, "matrix"),
            matrix_width * parameters.depth - hole,
            max_relative = 1e-9
        );
        assert_eq!(mesh.nodes()[specimen.fibres[0].exit_node], [0.0, 0.0]);
        assert_eq!(preflight::bodies(&mesh).len(), 2);
        let missing = specimen.notes.iter().filter(|note| note.contains("too narrow")).count();
        assert_eq!(missing, ["face_near", "face_away"].iter().filter(|name| mesh.node_set(name).is_none()).count());
    }
}

#[test]
fn all_wrong_parameters_are_reported_at_once() {
    let message =
        |change: fn(&mut PerpendicularFibre)| perpendicular_fibre(&fibre_with(change)).unwrap_err().to_string();
    assert_eq!(
        message(|p| {
            p.width = -1.0;
            p.free_length = f64::NAN;
            p.embedded_length = 12.7;
            p.mesh.growth = 0.9;
            p.mesh.elements_across = 0;
        }),
        "width is -1, it must be positive; free_length is NaN, it must be positive; \
         embedded_length + tail_gap is 12.7, it must be less than the depth 12.7: the ligament below the hole holds the halves together; \
         elements_across is 0, it must be at least 1; growth is 0.9, it must be at least 1"
    );
    assert_eq!(message(|p| p.tail_gap = -0.1), "tail_gap is -0.1, it must be 0 or positive");
    assert_eq!(
        message(|p| p.mesh.exit_size = Some(20.0)),
        "exit_size is 20, it must be positive and less than the embedded_length 12.2"
    );
    assert_eq!(
        message(|p| {
            p.fibre_element = Q4;
            p.mesh.elements_across = 3;
        }),
        "elements_across is 3, it must be even with Q4: the fibre needs nodes on its axis"
    );
    assert_eq!(
        message(|p| p.configuration = Configuration::Axisymmetric { outer_radius: Some(0.1) }),
        "outer_radius is 0.1, it must be such that the block reaches beyond the fibre's radius 0.203: it reaches 0.1000"
    );
    assert_eq!(
        message(|p| p.fibre_diameter = 30.0),
        "width is 25.4, it must be such that the block reaches beyond the fibre's radius 15: it reaches 12.7000; \
         matrix_thickness is 3.26, it must be at least πφ/4 = 23.5619, the thickness of the fibre that lies in the block"
    );
    let thin =
        "matrix_thickness is 0.3, it must be at least πφ/4 = 0.3189, the thickness of the fibre that lies in the block";
    assert_eq!(message(|p| p.matrix_thickness = 0.3), thin);
    let thick = fibre_with(|p| p.matrix_thickness = std::f64::consts::PI * p.fibre_diameter / 4.0);
    perpendicular_fibre(&thick).expect("as thick as the fibre");
    assert!(
        message(|p| p.mesh.interface_size = 1e-7)
            .starts_with("interface_size below the fibre: a length of 0.203 would be divided 203000")
    );
    assert!(
        message(|p| p.mesh.exit_size = Some(1e-12)).starts_with("exit_size and embedded_elements along the fibre: ")
    );
}

#[test]
fn a_plate_with_a_hole_has_its_area_and_sides() {
    for kind in ElementKind::ALL {
        for (width, height, cells) in [(10.0, 10.0, 200), (10.0, 25.0, 98), (9.0, 4.0, 2)] {
            let parameters = PlateWithHole { width, height, radius: 2.0, cells, grading: 3.0, element: kind };
            let mesh = sound(plate_with_hole(&parameters).unwrap());
            let per_cell = if kind.corner_count() == 3 { 2 } else { 1 };
            assert_eq!(mesh.elements().len(), cells * per_cell);
            let area = part_area(&mesh, "plate");
            if cells == 200 && kind.edge_kind() == EdgeKind::Quadratic {
                approx::assert_relative_eq!(area, width * height - PI, max_relative = 1e-5);
            }
            assert_eq!(mesh.node_set("symmetry_x").unwrap(), nodes_where(&mesh, 0, |[x, _]| x == 0.0));
            assert_eq!(mesh.node_set("symmetry_y").unwrap(), nodes_where(&mesh, 0, |[_, y]| y == 0.0));
            assert_eq!(mesh.node_set("right").unwrap(), nodes_where(&mesh, 0, |[x, _]| x >= width - 1e-9));
            assert_eq!(mesh.node_set("top").unwrap(), nodes_where(&mesh, 0, |[_, y]| y >= height - 1e-9));
            assert!(positions(&mesh, "hole").iter().all(|[x, y]| (x.hypot(*y) - 2.0).abs() < 1e-12));
            let sides = ["symmetry_x", "symmetry_y", "right", "top", "hole"];
            let edges: usize = sides.iter().map(|side| chain(&mesh, side).len()).sum();
            assert_eq!(edges, mesh.boundary_edges().count());
        }
    }
    // The sizes of the benchmark.
    for cells in [5_000, 20_000] {
        let parameters = PlateWithHole { width: 10.0, height: 10.0, radius: 2.0, cells, grading: 5.0, element: Q8 };
        assert_eq!(plate_with_hole(&parameters).unwrap().elements.len(), cells);
    }
}

#[test]
fn thick_cylinders_have_their_area_and_sides() {
    for kind in ElementKind::ALL {
        let parameters = ThickCylinder {
            inner_radius: 5.0,
            outer_radius: 9.0,
            radial_cells: 6,
            grading: 2.0,
            other_cells: 12,
            element: kind,
            ..ThickCylinder::default()
        };
        let quarter = sound(thick_cylinder(&parameters).unwrap());
        let error = if kind.edge_kind() == EdgeKind::Quadratic { 1e-5 } else { 5e-3 };
        approx::assert_relative_eq!(part_area(&quarter, "cylinder"), PI / 4.0 * 56.0, max_relative = error);
        assert!(positions(&quarter, "inner").iter().all(|[x, y]| (x.hypot(*y) - 5.0).abs() < 1e-12));
        assert_eq!(quarter.node_set("symmetry_x").unwrap(), nodes_where(&quarter, 0, |[x, _]| x == 0.0));
        assert_eq!(quarter.node_set("symmetry_y").unwrap(), nodes_where(&quarter, 0, |[_, y]| y == 0.0));
        let ring = ThickCylinder { axisymmetric: true, height: 2.0, other_cells: 3, ..parameters };
        let ring = sound(thick_cylinder(&ring).unwrap());
        approx::assert_relative_eq!(part_area(&ring, "cylinder"), 8.0, max_relative = 1e-13);
        assert_eq!(ring.parts()[0].model, Axisymmetric);
        assert_eq!(ring.node_set("inner").unwrap(), nodes_where(&ring, 0, |[x, _]| x == 5.0));
        assert_eq!(ring.node_set("outer").unwrap(), nodes_where(&ring, 0, |[x, _]| x == 9.0));
        assert_eq!(chain(&ring, "outer").len(), 3);
    }
}

#[test]
fn cooks_membrane_and_the_beam_have_their_area_and_sides() {
    for kind in ElementKind::ALL {
        let membrane = sound(cook_membrane(&CookMembrane { cells: 4, element: kind }).unwrap());
        approx::assert_relative_eq!(part_area(&membrane, "membrane"), 48.0 * (44.0 + 16.0) / 2.0, max_relative = 1e-13);
        assert_eq!(membrane.node_set("left").unwrap(), nodes_where(&membrane, 0, |[x, _]| x == 0.0));
        let right = chain(&membrane, "right");
        assert_eq!([right[0][0], right[3][1]], [[48.0, 44.0], [48.0, 60.0]]);
        let parameters = Beam { length: 48.0, height: 12.0, cells: [8, 3], element: kind };
        let beam = sound(beam(&parameters).unwrap());
        approx::assert_relative_eq!(part_area(&beam, "beam"), 576.0, max_relative = 1e-13);
        assert_eq!(
            chain(&beam, "right"),
            [[[48.0, -6.0], [48.0, -2.0]], [[48.0, -2.0], [48.0, 2.0]], [[48.0, 2.0], [48.0, 6.0]]]
        );
    }
}

#[test]
fn two_blocks_touch_with_any_edges() {
    for element in [Q4, T3, T6, Q8] {
        let parameters = TwoBlocks { width: 4.0, heights: [2.0, 1.0], edges: [5, 7], rows: [2, 1], element };
        let mesh = sound(two_blocks(&parameters).unwrap());
        assert_eq!(preflight::bodies(&mesh).len(), 2);
        let (lower, upper) = (chain(&mesh, "lower_contact"), chain(&mesh, "upper_contact"));
        assert_eq!([lower[0][0], lower[4][1]], [[4.0, 0.0], [0.0, 0.0]]);
        assert_eq!([upper[0][0], upper[6][1]], [[0.0, 0.0], [4.0, 0.0]]);
        approx::assert_relative_eq!(part_area(&mesh, "lower"), 8.0, max_relative = 1e-14);
        approx::assert_relative_eq!(part_area(&mesh, "upper"), 4.0, max_relative = 1e-14);
        assert_eq!(mesh.node_set("top").unwrap(), nodes_where(&mesh, 1, |[_, y]| y == 1.0));
        assert_eq!(mesh.node_set("lower_left").unwrap(), nodes_where(&mesh, 0, |[x, _]| x == 0.0));
    }
}

fn cylinder(kind: ElementKind) -> Hertz {
    Hertz {
        radius: 10.0,
        half_width: 4.0,
        height: 4.0,
        depth: 4.0,
        contact_zone: 0.5,
        contact_edges: 20,
        growth: 1.2,
        element: kind,
    }
}

#[test]
fn a_cylinder_touches_its_plane_in_one_point() {
    for kind in ElementKind::ALL {
        let mesh = sound(hertz(&cylinder(kind)).unwrap());
        let (arc, plane) = (chain(&mesh, "cylinder_contact"), chain(&mesh, "base_contact"));
        assert_eq!(arc[0][0], [0.0, 0.0]);
        assert_eq!(arc.len(), plane.len());
        for (edge, below) in arc.iter().zip(plane.iter().rev()) {
            assert_eq!((edge[0][0], edge[1][0]), (below[1][0], below[0][0]), "above each other");
        }
        for &edge in mesh.edge_set("cylinder_contact").unwrap() {
            // Middle nodes too.
            for &node in mesh.edge_nodes(edge).nodes() {
                let [x, y] = mesh.nodes()[node];
                approx::assert_abs_diff_eq!(x.hypot(y - 10.0), 10.0, epsilon = 1e-12);
            }
        }
        for edge in &arc[..20] {
            approx::assert_relative_eq!(edge[1][0] - edge[0][0], 0.025, max_relative = 1e-10);
        }
        // The area below the chord y = 4 over half of the arc: 16 − ∫ (R − √(R² − x²)).
        let under = 10.0 * 4.0 - 0.5 * (4.0 * 84.0_f64.sqrt() + 100.0 * 0.4_f64.asin());
        let error = if kind.edge_kind() == EdgeKind::Quadratic { 1e-6 } else { 1e-3 };
        approx::assert_relative_eq!(part_area(&mesh, "cylinder"), 16.0 - under, max_relative = error);
        assert_eq!(part_area(&mesh, "base").round(), 16.0);
        assert_eq!(mesh.node_set("top").unwrap(), nodes_where(&mesh, 0, |[_, y]| y == 4.0));
    }
}

#[test]
fn the_drag_out_strip_lies_under_its_block() {
    for kind in ElementKind::ALL {
        let mesh = sound(drag_out_strip(&DragOutStrip { element: kind, ..DragOutStrip::default() }).unwrap());
        approx::assert_relative_eq!(part_area(&mesh, "strip"), 3.0, max_relative = 1e-12);
        approx::assert_relative_eq!(part_area(&mesh, "block"), 50.0, max_relative = 1e-12);
        let (strip, block) = (chain(&mesh, "strip_contact"), chain(&mesh, "block_contact"));
        assert_eq!([strip[0][0], strip[95][1]], [[12.0, 0.25], [0.0, 0.25]]);
        assert_eq!([block[0][0], block[79][1]], [[2.0, 0.25], [12.0, 0.25]]);
        // Nested, as 96/12 = 80/10.
        for (edge, master) in block.iter().rev().zip(&strip) {
            approx::assert_abs_diff_eq!(edge[1][0], master[0][0], epsilon = 1e-12);
        }
        assert_eq!(mesh.node_set("sliding_end").unwrap(), nodes_where(&mesh, 0, |[x, _]| x == 12.0));
        assert_eq!(mesh.node_set("symmetry").unwrap(), nodes_where(&mesh, 0, |[_, y]| y == 0.0));
        assert_eq!(chain(&mesh, "pressure").len(), 80);
    }
}

#[test]
fn wrong_parameters_of_the_other_specimens_are_reported() {
    let message = |result: Result<MeshDefinition, SpecimenError>| result.unwrap_err().to_string();
    let plate = PlateWithHole { width: 1.0, height: 2.0, radius: 1.5, cells: 1, grading: 0.0, element: Q4 };
    assert_eq!(
        message(plate_with_hole(&plate)),
        "grading is 0, it must be positive; radius is 1.5, it must be less than width and height, 1; cells is 1, it must be at least 2"
    );
    let thick = ThickCylinder {
        inner_radius: 2.0,
        outer_radius: 1.0,
        radial_cells: 0,
        grading: 1.0,
        other_cells: 1,
        element: Q4,
        ..ThickCylinder::default()
    };
    assert_eq!(
        message(thick_cylinder(&thick)),
        "outer_radius is 1, it must be more than the inner_radius 2; radial_cells is 0, it must be at least 1"
    );
    assert_eq!(message(cook_membrane(&CookMembrane { cells: 0, element: Q4 })), "cells is 0, it must be at least 1");
    let none = Beam { length: 0.0, height: 1.0, cells: [1, 0], element: Q4 };
    assert_eq!(message(beam(&none)), "length is 0, it must be positive; cells is 0, it must be at least 1");
    let blocks = TwoBlocks { width: 1.0, heights: [1.0, -1.0], edges: [0, 1], rows: [1, 1], element: Q4 };
    assert_eq!(message(two_blocks(&blocks)), "heights is -1, it must be positive; edges is 0, it must be at least 1");
    let high = Hertz { height: 0.5, contact_zone: 5.0, ..cylinder(Q4) };
    assert!(
        message(hertz(&high)).starts_with(
            "contact_zone is 5, it must be less than the half_width 4; height is 0.5, it must be more than the arc rises over the half_width, 0.83"
        )
    );
    assert_eq!(
        message(hertz(&Hertz { half_width: 11.0, ..cylinder(Q4) })),
        "half_width is 11, it must be less than the radius 10"
    );
    let strip = DragOutStrip { block_start: 3.0, strip_rows: 0, growth: 0.5, ..DragOutStrip::default() };
    assert_eq!(
        message(drag_out_strip(&strip)),
        "block_start + block_length is 13, it must be not more than the strip_length 12; strip_rows is 0, it must be at least 1; growth is 0.5, it must be at least 1"
    );
    let huge = DragOutStrip { strip_edges: 1_000_000, ..DragOutStrip::default() };
    assert!(message(drag_out_strip(&huge)).starts_with("strip_edges: a length of 12 would be divided 1000000 times"));
}

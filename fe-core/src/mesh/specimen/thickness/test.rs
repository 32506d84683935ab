use super::super::{
    Configuration, Fibre, Fibres, FibresMesh, PerpendicularFibre, Specimen, SpecimenError, fibres, perpendicular_fibre,
};
use super::GradedThickness;
use crate::element::ElementKind;
use crate::mesh::{Mesh, MeshDefinition, preflight};

const DIAMETER: f64 = 0.406;
const FULL: f64 = 3.26;
const WIDTH: f64 = 25.4;
const DEPTH: f64 = 12.7;

fn part(mesh: &Mesh, name: &str) -> usize {
    mesh.parts().iter().position(|part| part.name == name).unwrap()
}

/// Area and volume of a part.
fn measures(mesh: &Mesh, name: &str) -> [f64; 2] {
    let index = part(mesh, name);
    let elements = mesh.elements().iter().enumerate().filter(|(_, element)| element.part() == index);
    elements.fold([0.0; 2], |[area, volume], (number, element)| {
        let own = mesh.element_area(number);
        [area + own, volume + own * element.thickness()]
    })
}

/// Fibres of all shapes and kinds of elements, with cover.
fn covered(graded: Option<GradedThickness>) -> Vec<(String, Specimen)> {
    let mut all = Vec::new();
    for degrees in [0.0_f64, 5.0, 14.0, 30.0, 45.0, 60.0, 75.0] {
        let angle = degrees.to_radians();
        for (shape, fibre) in [("bent", Fibre::bent(angle, None, 3.0)), ("straight", Fibre::straight(angle, 0.0))] {
            for kind in [ElementKind::T6, ElementKind::T3] {
                let parameters = Fibres {
                    fibres: vec![fibre.clone()],
                    matrix_element: kind,
                    cover: true,
                    graded_thickness: graded,
                    ..Fibres::default()
                };
                all.push((format!("{degrees}° {shape} {kind}"), fibres(&parameters).unwrap()));
            }
        }
    }
    for kind in ElementKind::ALL {
        for tail_gap in [0.0, 0.2] {
            let matrix_element = kind;
            let parameters = PerpendicularFibre {
                matrix_element,
                tail_gap,
                cover: true,
                graded_thickness: graded,
                ..PerpendicularFibre::default()
            };
            all.push((format!("perpendicular {kind}, gap {tail_gap}"), perpendicular_fibre(&parameters).unwrap()));
        }
    }
    all
}

/// The cover closes the slot: with it the block is a rectangle in one piece, and its nodes are those of the walls.
#[test]
fn a_cover_makes_a_rectangle_of_the_block() {
    for (name, specimen) in covered(None) {
        let mesh = Mesh::new(specimen.definition).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(preflight::findings(&mesh, &[]), [], "{name}");
        let [[matrix, _], [cover, volume]] = ["matrix", "cover"].map(|part| measures(&mesh, part));
        assert!(((matrix + cover) / (WIDTH * DEPTH) - 1.0).abs() < 1e-12, "{name}: {matrix} + {cover}");
        assert!((volume / (cover * (FULL - DIAMETER)) - 1.0).abs() < 1e-12, "{name}");
        let bodies = preflight::bodies(&mesh);
        assert_eq!(bodies.len(), 2, "{name}: the fibre, and the block with its cover");
        for pair in &specimen.contact_pairs {
            for &edge in mesh.edge_set(&pair.slave).unwrap() {
                let across = mesh.neighbour(edge).map(|other| mesh.elements()[other.element].part());
                let this = mesh.elements()[edge.element].part();
                assert_eq!((this, across), (part(&mesh, "matrix"), Some(part(&mesh, "cover"))), "{name} {}", pair.name);
            }
        }
        let outside = mesh.part_boundary_edges(part(&mesh, "cover")).filter(|&edge| mesh.neighbour(edge).is_none());
        for edge in outside {
            assert!(mesh.edge_nodes(edge).nodes().iter().all(|&node| mesh.nodes()[node][1] == 0.0), "{name}");
        }
    }
}

/// ∫t dA over the block by hand: t W D less 2 e ∫(t − φ − 2mξ)dξ = e (t − φ)²/2m; the cover has t(ξ) − φ.
#[test]
fn graded_volumes_are_those_of_the_closed_form() {
    for slope in [0.5, 1.0, 1.5, 4.0] {
        let extent = 3.0;
        let graded = GradedThickness { slope, extent: Some(extent) };
        for (name, specimen) in covered(Some(graded)) {
            let mesh = Mesh::new(specimen.definition).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(mesh.free_nodes().len(), specimen.couplings.len(), "{name}: left-out elements leave no node");
            let [[matrix, block], [cover, before]] = ["matrix", "cover"].map(|part| measures(&mesh, part));
            // elements of a cover thinner than 2 % of t are left out, at the face
            let bare = WIDTH * DEPTH - matrix - cover;
            assert!((-1e-9..0.02 * FULL / (2.0 * slope) * 3.0).contains(&bare), "{name}: {bare}");
            let missing = extent * (FULL - DIAMETER).powi(2) / (2.0 * slope);
            let expected = FULL * WIDTH * DEPTH - missing - DIAMETER * (cover + bare);
            let off = (block + before - expected) / missing;
            // triangles do not end where the graded thickness does
            let allowed = if name.starts_with("perpendicular") { 2e-3 } else { 2e-2 };
            assert!(off.abs() < allowed, "{name}, slope {slope}: {off:e} of what is missing");
            for (index, element) in mesh.elements().iter().enumerate() {
                let beyond = element.nodes().iter().all(|&node| mesh.nodes()[node][0].abs() > extent);
                let full = mesh.parts()[element.part()].thickness;
                assert!(!beyond || element.thickness() == full, "{name}: element {index} outside the graded part");
                let thickness = element.thickness();
                if element.part() == part(&mesh, "fibre") {
                    assert!((thickness - std::f64::consts::FRAC_PI_4 * DIAMETER).abs() < 1e-12);
                } else {
                    // the two triangles of a rectangle are left out together
                    let least = if element.part() == part(&mesh, "cover") { 0.01 * FULL } else { DIAMETER };
                    assert!((least..=FULL).contains(&thickness), "{name}: element {index}, {thickness}");
                }
            }
        }
    }
}

#[test]
fn the_graded_part_is_as_wide_as_its_cone() {
    let specimen = |angle: f64, extent: Option<f64>| {
        let graded_thickness = Some(GradedThickness { slope: 1.0, extent });
        let mesh = FibresMesh { size: 0.5, ..FibresMesh::default() };
        let bent = vec![Fibre::bent(angle, None, 3.0)];
        fibres(&Fibres { fibres: bent, graded_thickness, mesh, ..Fibres::default() }).unwrap()
    };
    // 2 φ + (t − φ)/2 (1 + tan θ)
    for (angle, extent) in [(0.0, 0.812 + 1.427), (std::f64::consts::FRAC_PI_4, 0.812 + 2.854)] {
        let [implied, given] = [None, Some(extent)].map(|extent| specimen(angle, extent).definition.thicknesses);
        assert_eq!(implied, given);
    }
    assert!(specimen(0.0, None).notes.iter().any(|note| note.contains("within 2.239 mm of the exit")));
}

#[test]
fn impossible_thicknesses_are_reported() {
    let inclined = Fibres {
        fibres: vec![Fibre::bent(0.785, None, 3.0)],
        matrix_thickness: 0.4,
        cover: true,
        graded_thickness: Some(GradedThickness { slope: 0.0, extent: Some(-1.0) }),
        ..Fibres::default()
    };
    let axisymmetric = PerpendicularFibre {
        configuration: Configuration::Axisymmetric { outer_radius: None },
        cover: true,
        graded_thickness: Some(GradedThickness { slope: 1.0, extent: None }),
        ..PerpendicularFibre::default()
    };
    let names = |made: Result<Specimen, SpecimenError>| match made.unwrap_err() {
        SpecimenError::Parameters { problems } => problems.iter().map(|problem| problem.name).collect::<Vec<_>>(),
        other => panic!("{other}"),
    };
    let expected = ["matrix_thickness", "graded_thickness.slope", "graded_thickness.extent"];
    assert_eq!(names(fibres(&inclined)), expected);
    assert_eq!(names(perpendicular_fibre(&axisymmetric)), ["cover", "graded_thickness"]);
}

#[test]
fn thicknesses_of_elements_are_checked() {
    let definition = perpendicular_fibre(&PerpendicularFibre::default()).unwrap().definition;
    let count = definition.elements.len();
    for (element, thickness) in [(0, 0.0), (3, f64::NAN), (5, f64::INFINITY), (count, 1.0)] {
        let thicknesses = [(element, thickness)].into();
        let refused = Mesh::new(MeshDefinition { thicknesses, ..definition.clone() }).unwrap_err();
        let place = format!("element {}: its thickness is {thickness}", element + 1);
        assert_eq!(refused.to_string(), format!("{place}, it must be positive, of one of the {count} elements"));
    }
}

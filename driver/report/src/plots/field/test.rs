use super::canvas::part_color;
use super::levels::Levels;
use super::region::Region;
use super::*;
use crate::plots::figure::UNIT;
use fe_core::output::Activity;
use plotters::style::RGBColor;
use std::f64::consts::FRAC_PI_4;

/// A quarter ring of Q8 elements with curved edges, an inner part and an outer one, nodes of their own where they meet.
/// `count` elements along the arc, `rows` in each part across it.
fn ring(count: usize, rows: usize) -> PictureMesh {
    let mut mesh = PictureMesh {
        nodes: Vec::new(),
        displacements: Vec::new(),
        elements: Vec::new(),
        parts: vec!["fibre".into(), "matrix".into()],
        behind: Vec::new(),
    };
    for (part, radii) in [[1.0, 2.0], [2.0, 6.0]].into_iter().enumerate() {
        let first = mesh.nodes.len();
        let (across, along) = (2 * rows + 1, 2 * count + 1);
        for (i, j) in (0..across).flat_map(|i| (0..along).map(move |j| (i, j))) {
            let radius = radii[0] + (radii[1] - radii[0]) * i as f64 / (2 * rows) as f64;
            let angle = 2.0 * FRAC_PI_4 * j as f64 / (2 * count) as f64;
            mesh.nodes.push([radius * angle.cos(), radius * angle.sin()]);
            mesh.displacements.push([0.002 * radius * angle.sin(), 0.001 * radius]);
        }
        for (i, j) in (0..rows).flat_map(|i| (0..count).map(move |j| (2 * i, 2 * j))) {
            let node = |di: usize, dj: usize| first + (i + di) * along + j + dj;
            let nodes = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)].map(|(a, b)| node(a, b));
            mesh.elements.push(PictureElement { kind: ElementKind::Q8, part, nodes: nodes.to_vec() });
        }
    }
    // the middle of the grid's cells is no node of Q8: it stays unused
    mesh
}

/// The hoop stress of a thick tube of radii 1 and 6 under an inner pressure of 100 MPa, and a gradient across.
fn hoop(mesh: &PictureMesh) -> Vec<f64> {
    mesh.nodes.iter().map(|[x, y]| (1.0 + 36.0 / (x * x + y * y)) / 35.0 * 100.0 - 3.0 * x).collect()
}

fn stress() -> Quantity {
    Quantity { name: "σ_{max}".into(), unit: "MPa".into() }
}

fn texts(document: &roxmltree::Document<'_>) -> Vec<String> {
    let gather = |node: roxmltree::Node<'_, '_>| {
        let text: String = node.descendants().filter(|d| d.is_text()).filter_map(|d| d.text()).collect();
        text.trim().to_string()
    };
    document.descendants().filter(|node| node.has_tag_name("text")).map(gather).collect()
}

/// Colours of filled paths in the order of drawing.
fn fills(document: &roxmltree::Document<'_>) -> Vec<String> {
    let paths = document.descendants().filter(|node| node.has_tag_name("path"));
    paths.filter_map(|path| path.attribute("fill")).filter(|&fill| fill != "none").map(String::from).collect()
}

#[test]
fn contours_have_a_colour_for_each_band_and_a_bar_from_least_to_greatest() {
    let mesh = ring(6, 2);
    let field = hoop(&mesh);
    let svg = contour(&FieldPicture::new("Ring & <more>", &mesh), &field, &stress(), None).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let used: Vec<f64> = mesh.elements.iter().flat_map(|e| e.nodes.iter().map(|&node| field[node])).collect();
    let least = used.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = used.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let levels = Levels::new(&stress(), (least, greatest));
    assert_eq!(levels.range, (least, greatest));
    let fills = fills(&document);
    assert_eq!(fills.len(), levels.count());
    assert_eq!(fills.iter().collect::<std::collections::BTreeSet<_>>().len(), levels.count());
    let texts = texts(&document);
    // round numbers 10 apart: the ends have one decimal
    let ends = [least, greatest].map(|end| format!("{end:.1}").replace('-', "−"));
    // a level too near to an end has no number of its own
    let inside = |level: &&f64| **level > least + 4.0 && **level < greatest - 6.0;
    let levels = levels.between.iter().filter(inside).map(|level| format!("{level}").replace('-', "−"));
    for expected in levels
        .chain(ends)
        .chain(["Ring & <more>", "deformed, to scale", "x [mm]", "y [mm]", "σmax[MPa]"].map(String::from))
    {
        assert!(texts.contains(&expected), "{expected} in {texts:?}");
    }
}

#[test]
fn levels_are_round_numbers_inside_the_range() {
    for (range, expected) in [
        ((0.0, 1.0), "0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9"),
        ((-3.2, 3.1), "−3 −2.5 −2 −1.5 −1 −0.5 0 0.5 1 1.5 2 2.5 3"),
        ((0.0, 2.6e-4), "0.02 0.04 0.06 0.08 0.1 0.12 0.14 0.16 0.18 0.2 0.22 0.24"),
        ((5.0, 5.0), ""),
        ((5.0, 5.0 + 1e-12), ""),
    ] {
        let levels = Levels::new(&stress(), range);
        let texts: Vec<f64> =
            levels.between.iter().map(|&level| levels.text(level).replace('−', "-").parse().unwrap()).collect();
        let expected: Vec<f64> =
            expected.split_whitespace().map(|text| text.replace('−', "-").parse().unwrap()).collect();
        assert_eq!(texts, expected);
        assert!(levels.between.iter().all(|&level| range.0 < level && level < range.1));
        assert_eq!((levels.band(0).0, levels.band(levels.count() - 1).1), range);
        assert!(levels.numbered(400).iter().all(|level| levels.between.contains(level)));
    }
}

/// Area of the paths' polygons, square drawing units; holes count negative.
fn area(path: &str) -> f64 {
    let mut doubled = 0.0;
    for outline in path.split('M').skip(1) {
        let spaced = outline.trim_end_matches('z').replace('l', " ").replace('-', " -");
        let numbers: Vec<f64> = spaced.split_whitespace().map(|number| number.parse().unwrap()).collect();
        let (mut x, mut y) = (0.0, 0.0);
        let mut places = Vec::new();
        for step in numbers.chunks_exact(2) {
            (x, y) = (x + step[0], y + step[1]);
            places.push((x, y));
        }
        let next = places.iter().cycle().skip(1);
        doubled += places.iter().zip(next).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum::<f64>();
    }
    (0.5 * doubled).abs()
}

#[test]
fn fills_cover_the_area_of_the_bodies_and_of_what_lies_above_a_level() {
    let mesh = ring(8, 3);
    let view = View::new(&Window::around(&mesh.nodes).unwrap());
    let unit = view.pixels(1.0) * f64::from(UNIT);
    let surface = Surface::new(&mesh, mesh.nodes.clone(), &view);
    let ring_area = |inner: f64, outer: f64| FRAC_PI_4 * (outer * outer - inner * inner) * unit * unit;
    let close = |path: &str, exact: f64| {
        let found = area(path);
        assert!((found / exact - 1.0).abs() < 2e-3, "{found} against {exact}");
    };
    close(&surface.area(|_, _| true), ring_area(1.0, 6.0));
    close(&surface.area(|_, element| element.part == 0), ring_area(1.0, 2.0));
    let radius: Vec<f64> = mesh.nodes.iter().map(|[x, y]| x.hypot(*y)).collect();
    for level in [1.0, 1.37, 2.0, 3.111, 5.9] {
        close(&surface.area_above(&radius, level), ring_area(level, 6.0));
    }
    assert_eq!(surface.area_above(&radius, 6.1), "");
}

#[test]
fn polygons_that_touch_become_one_outline_and_keep_their_hole() {
    let mut region = Region::default();
    let cells = (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).filter(|&cell| cell != (1, 1));
    for (i, j) in cells {
        let corner = |a: i32, b: i32| (100 * (i + a), 100 * (j + b));
        region.add(&[corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
    }
    let path = region.path();
    assert_eq!(path.matches('M').count(), 2, "{path}");
    assert_eq!(area(&path), 8e4);
    assert_eq!(Region::default().path(), "");
}

#[test]
fn the_deformed_mesh_names_its_parts_and_its_magnification() {
    let mesh = ring(4, 2);
    let mut picture = FieldPicture::new("Mesh", &mesh);
    picture.magnification = mesh.suggested_magnification();
    assert_eq!(picture.magnification, 20.0);
    let svg = deformed_mesh(&picture).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    assert_eq!(fills(&document).len(), 2);
    let texts = texts(&document);
    for expected in ["fibre", "matrix", "deformed, displacements × 20"] {
        assert!(texts.iter().any(|text| text == expected), "{expected} in {texts:?}");
    }
    // rings are curved along their edges in one direction, straight across
    assert!(svg.contains('q'));
    assert_eq!(svg.matches("stroke-dasharray").count(), 1);
    picture.window = Some(Window { x: 4.0..5.0, y: 1.0..1.5 });
    let svg = deformed_mesh(&picture).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    assert_eq!(fills(&document).len(), 1, "only the matrix lies in the window");
}

#[test]
fn pictures_stay_small() {
    let mesh = ring(50, 50);
    let picture = FieldPicture::new("5000 elements", &mesh);
    let mut random = fastrand::Rng::with_seed(1);
    let noise: Vec<f64> = mesh.nodes.iter().map(|_| random.f64()).collect();
    let sizes = [
        (contour(&picture, &hoop(&mesh), &stress(), None).unwrap().len(), 300_000),
        (deformed_mesh(&picture).unwrap().len(), 1_000_000),
    ];
    for (size, most) in sizes {
        assert!(size < most, "{size} B");
    }
    // nothing to merge: what no field of a computation looks like
    assert!(contour(&picture, &noise, &stress(), None).unwrap().len() < 6_000_000);
}

#[test]
fn elements_without_a_value_are_grey_and_values_beyond_the_range_are_reported() {
    let mesh = ring(4, 2);
    let field = hoop(&mesh);
    let holes: Vec<f64> = mesh
        .nodes
        .iter()
        .zip(&field)
        .map(|(node, &v)| if node[0].hypot(node[1]) < 1.5 { f64::NAN } else { v })
        .collect();
    let svg = contour(&FieldPicture::new("", &mesh), &holes, &stress(), Some((0.0, 2.0))).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    assert_eq!(fills(&document)[0], canvas::NO_VALUE);
    let texts = texts(&document);
    assert!(texts.iter().any(|text| text == "no value"), "{texts:?}");
    assert!(texts.iter().any(|text| text.starts_with("deformed, to scale; values from ")), "{texts:?}");
}

#[test]
fn any_field_can_be_drawn() {
    let mesh = ring(3, 2);
    let count = mesh.nodes.len();
    let picture = FieldPicture::new("^{}_{", &mesh);
    for (value, bands) in
        [(3.0, 1), (0.0, 1), (f64::NAN, 0), (f64::INFINITY, 0), (1e300, 0), (-1e-300, 1), (f64::MIN, 0)]
    {
        let svg = contour(&picture, &vec![value; count], &stress(), None).unwrap();
        let document = roxmltree::Document::parse(&svg).unwrap();
        let coloured = fills(&document).iter().filter(|fill| *fill != canvas::NO_VALUE).count();
        assert_eq!(coloured, bands, "{value}");
    }
    let mixed: Vec<f64> = (0..count).map(|k| [1e-300, f64::MAX, 2.0, -1e289][k % 4]).collect();
    for range in [None, Some((0.0, 0.0)), Some((f64::NAN, 1.0)), Some((1.0, -1.0)), Some((-1.0, 1.0))] {
        let svg = contour(&picture, &mixed, &stress(), range).unwrap();
        roxmltree::Document::parse(&svg).unwrap();
    }
    for magnification in [0.0, 1e12, -3.0, f64::NAN] {
        let picture = FieldPicture { magnification, ..picture.clone() };
        match deformed_mesh(&picture) {
            Ok(svg) => assert!(roxmltree::Document::parse(&svg).is_ok()),
            Err(error) => assert_eq!((error, magnification.is_nan()), (PictureError::Nothing, true)),
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let mesh = ring(3, 2);
    let picture = FieldPicture::new("", &mesh);
    let error = contour(&picture, &[1.0], &stress(), None).unwrap_err().to_string();
    assert_eq!(error, format!("there are 1 values, the picture's mesh has {} nodes", mesh.nodes.len()));
    let mut broken = mesh.clone();
    broken.elements[2].nodes[7] = 100_000;
    let error = deformed_mesh(&FieldPicture::new("", &broken)).unwrap_err().to_string();
    assert_eq!(error, "element 3 of the picture's mesh does not fit its nodes and parts");
    let elsewhere = FieldPicture { window: Some(Window { x: 100.0..101.0, y: 0.0..1.0 }), ..picture.clone() };
    assert_eq!(deformed_mesh(&elsewhere), Err(PictureError::Nothing));
    let empty = FieldPicture { window: Some(Window { x: 1.0..1.0, y: 0.0..1.0 }), ..picture };
    assert_eq!(deformed_mesh(&empty).unwrap_err().to_string(), "the window 1.0..1.0 × 0.0..1.0 has no area");
}

#[test]
fn pictures_and_profiles_come_from_computed_fields() {
    use fe_core::kinematics::PlaneModel;
    use fe_core::mesh::{ElementDefinition, Mesh, MeshDefinition, Part};
    use fe_core::output::ContactPoint;
    let nodes = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0]];
    let parts = ["fibre", "matrix"].map(|name| Part::new(name, PlaneModel::PlaneStress, 1.0)).to_vec();
    let element = |part: usize| ElementDefinition {
        kind: ElementKind::Q4,
        part,
        nodes: vec![part, part + 1, part + 4, part + 3],
    };
    let elements = vec![element(0), element(1)];
    let mesh = Mesh::new(MeshDefinition { nodes, parts, elements, ..MeshDefinition::default() }).unwrap();
    let point = |pair: usize, arc: f64, weight: f64| ContactPoint {
        pair,
        position: [arc, 0.0],
        arc,
        gap: 0.0,
        pressure: 2.0 + arc,
        slip: 0.0,
        shear_traction: 5.0 - arc,
        open: false,
        weight,
    };
    let fields = Fields {
        time: 1.0,
        scalar: None,
        displacements: vec![0.01; 12],
        reactions: vec![0.0; 12],
        stresses: vec![[1.0, 2.0, 0.0, 0.0]; 8],
        strains: vec![[0.0; 4]; 8],
        states: Vec::new(),
        state_names: vec![vec![], vec![]],
        activities: vec![Activity::Elastic; 2],
        behind: vec![1],
        pairs: vec!["upper".to_string(), "lower".to_string()],
        contact: vec![point(1, 0.5, 1.0), point(0, 0.7, 1.0), point(0, 0.2, 0.4), point(0, 0.9, 0.0)],
    };
    let picture = PictureMesh::new(&mesh, &fields, &Recovery::new(&mesh));
    assert_eq!((picture.nodes.len(), picture.parts.len()), (8, 2));
    let drawn: Vec<[f64; 2]> = picture.elements[1].nodes.iter().map(|&node| picture.nodes[node]).collect();
    assert_eq!(drawn, [[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]]);
    let figures = interface_profiles(&fields);
    assert_eq!(
        figures.iter().map(|figure| figure.name.as_str()).collect::<Vec<_>>(),
        ["interface_shear", "interface_pressure"]
    );
    let upper = &figures[0].lines[0];
    assert_eq!((upper.label.as_str(), upper.points[0], upper.points[1]), ("upper", (0.2, 4.8), (0.7, 4.3)));
    assert!(upper.points[2].1.is_nan(), "the point has left");
    assert_eq!(figures[1].lines[1].points, [(0.5, 2.5)]);
    assert!(figures.iter().all(|figure| roxmltree::Document::parse(&figure.svg().unwrap()).is_ok()));
}

#[test]
fn the_ends_of_the_bar_have_one_digit_more_than_the_levels() {
    let ends = |range: (f64, f64)| {
        let levels = Levels::new(&stress(), range);
        [range.0, range.1].map(|end| levels.end_text(end))
    };
    assert_eq!(ends((-12.345, 105.67)), ["−12.3", "105.7"]);
    assert_eq!(ends((1e-7, 1.0)), ["0", "1"]);
    assert_eq!(ends((-1e-9, 0.983)), ["0", "0.98"]);
    assert_eq!(ends((2.5, 2.5)), ["2.5", "2.5"]);
}

/// The strokes of a colour: (dx, dy) of each line, drawing units, y upwards.
fn strokes(svg: &str, color: &str) -> Vec<(f64, f64)> {
    let document = roxmltree::Document::parse(svg).expect("SVG");
    let is_drawn = |node: &roxmltree::Node<'_, '_>| node.attribute("stroke") == Some(color);
    let Some(path) = document.descendants().find(is_drawn).and_then(|node| node.attribute("d")) else {
        return Vec::new();
    };
    let line = |line: &str| {
        let (dx, dy) = line.split_once('l').expect("a line").1.split_once(' ').expect("two numbers");
        (dx.parse::<f64>().expect("dx"), -dy.parse::<f64>().expect("dy"))
    };
    path.split('M').skip(1).map(line).collect()
}

#[test]
fn crosses_lie_along_the_principal_directions_and_are_as_long_as_the_stresses() {
    let mesh = ring(6, 3);
    // tension of 4 MPa at 30° from x, compression of 1 MPa across it
    let (sine, cosine) = (FRAC_PI_4 / 1.5).sin_cos();
    let [s11, s22] = [4.0 * cosine * cosine - sine * sine, 4.0 * sine * sine - cosine * cosine];
    let stresses = vec![[s11, s22, 7.0, 5.0 * sine * cosine]; mesh.nodes.len()];
    let svg = crosses(&FieldPicture::new("Crosses", &mesh), &stresses, |_| true).expect("a picture");
    let [tension, compression] = ["#d55e00", "#0072b2"].map(|color| strokes(&svg, color));
    assert!(tension.len() > 50 && compression.len() == tension.len(), "{} {}", tension.len(), compression.len());
    let length = |(dx, dy): (f64, f64)| dx.hypot(dy);
    for (along, across) in tension.iter().zip(&compression) {
        // half lines are rounded to drawing units
        assert!((along.1 / along.0 - (FRAC_PI_4 / 1.5).tan()).abs() < 0.02, "{along:?}");
        assert!((along.0 * across.0 + along.1 * across.1).abs() < 0.05 * length(*along) * length(*across));
        assert!((length(*across) / length(*along) - 0.25).abs() < 0.02, "{across:?}");
    }
    assert!(svg.contains("longest line: 4 MPa and more"));
    // the scale is that of the second part: the first is cut there
    let inner = |part: usize| if part == 0 { 10.0 } else { 1.0 };
    let mut uniaxial = vec![[0.0; 4]; mesh.nodes.len()];
    for element in &mesh.elements {
        element.nodes.iter().for_each(|&node| uniaxial[node] = [inner(element.part), 0.0, 0.0, 0.0]);
    }
    let svg = crosses(&FieldPicture::new("Crosses", &mesh), &uniaxial, |part| part == 1).expect("a picture");
    let lines = strokes(&svg, "#d55e00");
    assert!(lines.iter().all(|line| *line == (16.0 * f64::from(UNIT), 0.0)), "{lines:?}");
    assert!(svg.contains("longest line: 1 MPa") && strokes(&svg, "#0072b2").is_empty());
    let nothing = vec![[f64::NAN; 4]; mesh.nodes.len()];
    assert_eq!(crosses(&FieldPicture::new("Crosses", &mesh), &nothing, |_| true), Err(PictureError::Nothing));
    assert!(crosses(&FieldPicture::new("Crosses", &mesh), &stresses[1..], |_| true).is_err());
}

#[test]
fn zones_have_a_colour_for_each_class_that_is_there() {
    let mesh = ring(4, 2);
    let classes: [Class<'_>; 3] =
        [(RGBColor(1, 2, 3), "calm"), (RGBColor(4, 5, 6), "never"), (RGBColor(7, 8, 9), "moving")];
    let of: Vec<usize> = (0..mesh.elements.len()).map(|index| if index % 2 == 0 { 0 } else { 2 }).collect();
    let svg = zones(&FieldPicture::new("Zones", &mesh), &of, &classes).expect("a picture");
    let document = roxmltree::Document::parse(&svg).expect("SVG");
    let is_filled = |color: &str| {
        document.descendants().any(|node| node.attribute("fill") == Some(color) && node.has_attribute("d"))
    };
    assert!(is_filled("#010203") && is_filled("#070809") && !is_filled("#040506"));
    assert!(svg.contains("calm") && svg.contains("moving") && !svg.contains("never"));
    assert!(zones(&FieldPicture::new("Zones", &mesh), &of[1..], &classes).is_err());
}

/// The part in the background is drawn first, with its edges: the later part hides it.
#[test]
fn what_lies_behind_is_hidden_by_what_lies_before_it() {
    let square =
        |part: usize| PictureElement { kind: ElementKind::Q4, part, nodes: (4 * part..4 * part + 4).collect() };
    let mesh = PictureMesh {
        nodes: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].repeat(2),
        displacements: vec![[0.0, 0.0]; 8],
        elements: vec![square(0), square(1)],
        parts: vec!["fibre".into(), "cover".into()],
        behind: vec![1],
    };
    let picture = FieldPicture::new("", &mesh);
    let svg = deformed_mesh(&picture).unwrap();
    let [fibre, cover] = [0, 1].map(|part| {
        let fill = format!("<path fill=\"{}\"", hexadecimal(part_color(part)));
        svg.rfind(&fill).expect("a path of this colour")
    });
    assert!(cover < fibre && svg[cover..fibre].contains("stroke=\"#222222\""), "{svg}");
    let svg = contour(&picture, &[[1.0; 4], [0.0; 4]].concat(), &stress(), None).unwrap();
    assert!(svg.find("stroke=\"#222222\"") < svg.rfind("<path fill=\"#"), "the cover's edges are under the fibre");
}

use super::levels::Levels;
use super::region::Region;
use super::*;
use crate::output::plots::figure::UNIT;
use std::f64::consts::FRAC_PI_4;

/// A quarter ring of Q8 elements with curved edges, an inner part and an outer one, nodes of their own where they meet.
/// `count` elements along the arc, `rows` in each part across it.
fn ring(count: usize, rows: usize) -> PictureMesh {
    let mut mesh = PictureMesh {
        nodes: Vec::new(),
        displacements: Vec::new(),
        elements: Vec::new(),
        parts: vec!["fibre".into(), "matrix".into()],
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

/// The hoop stress of a thick tube of radii 1 and 6 under inner pressure, −20 % of it in the fibre.
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
#[ignore]
fn look() {
    let dir = std::path::PathBuf::from(std::env::var("PICTURES").unwrap());
    let mesh = ring(8, 3);
    let field = hoop(&mesh);
    let save = |name: &str, svg: String| std::fs::write(dir.join(name), svg).unwrap();
    let mut picture = FieldPicture::new("Thick ring: maximum principal stress at slip 0.50 mm", &mesh);
    picture.magnification = mesh.suggested_magnification();
    save("contour.svg", contour(&picture, &field, &stress(), None).unwrap());
    save("mesh.svg", deformed_mesh(&picture).unwrap());
    let damage: Vec<f64> = mesh
        .nodes
        .iter()
        .enumerate()
        .map(
            |(k, [x, y])| {
                if k < 119 { f64::NAN } else { (1.02 - 0.5 * ((x - 3.0).powi(2) + (y - 2.0).powi(2))).max(-0.03) }
            },
        )
        .collect();
    let d = Quantity { name: "damage D_{t}".into(), unit: "".into() };
    picture.title = "Damage".into();
    save("damage.svg", contour(&picture, &damage, &d, Some((0.0, 1.0))).unwrap());
    picture.window = Some(Window { x: 1.5..2.5, y: 0.5..1.2 });
    picture.title = "Near the exit".into();
    save("zoom.svg", contour(&picture, &field, &stress(), None).unwrap());
    save("zoommesh.svg", deformed_mesh(&picture).unwrap());
    let big = ring(50, 50);
    let mut picture = FieldPicture::new("5 000 elements", &big);
    picture.magnification = 50.0;
    let start = std::time::Instant::now();
    save("big.svg", contour(&picture, &hoop(&big), &stress(), None).unwrap());
    eprintln!("big contour {:?}", start.elapsed());
    let start = std::time::Instant::now();
    save("bigmesh.svg", deformed_mesh(&picture).unwrap());
    eprintln!("big mesh {:?}", start.elapsed());
    let mut seed = 1u64;
    let noise: Vec<f64> = big
        .nodes
        .iter()
        .map(|_| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 40) as f64
        })
        .collect();
    let start = std::time::Instant::now();
    save("noise.svg", contour(&picture, &noise, &stress(), None).unwrap());
    eprintln!("noise {:?}", start.elapsed());
    let flat = PictureMesh { nodes: mesh.nodes.iter().map(|[x, y]| [x * 4.0, y * 0.1]).collect(), ..mesh.clone() };
    save(
        "flat.svg",
        contour(
            &FieldPicture::new("Flat", &flat),
            &field.iter().map(|f| f * 1e-5).collect::<Vec<_>>(),
            &stress(),
            None,
        )
        .unwrap(),
    );
    save(
        "constant.svg",
        contour(&FieldPicture::new("", &mesh), &vec![3.0; mesh.nodes.len()], &stress(), None).unwrap(),
    );
    let tall = PictureMesh { nodes: mesh.nodes.iter().map(|[x, y]| [x * 0.3, y * 4.0]).collect(), ..mesh.clone() };
    save(
        "tall.svg",
        contour(
            &FieldPicture::new("A tall body with a title that is longer than the picture is wide, so it wraps", &tall),
            &field,
            &stress(),
            None,
        )
        .unwrap(),
    );
}

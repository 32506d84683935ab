use super::axis::Axis;
use super::decimation::{Coordinate, decimate, drawable_stretches};
use super::figure::{Figure, Line, Marks, Scale, Style, UNIT};
use super::quantity::{Quantity, group_of};
use super::*;
use crate::directory::{Access, Kind, ResultDirectory};
use pullout_run::columns::Group;

fn line(label: &str, points: Vec<(f64, f64)>) -> Line {
    Line { label: label.into(), points, columns: ("e11".into(), "s11".into()), style: Style::default(), marked: false }
}

fn figure(lines: Vec<Line>, marks: Vec<Marks>) -> Figure {
    let quantity = |column| Quantity::of(column, &BTreeMap::new());
    let (x, y) = (quantity("e11"), quantity("s11"));
    Figure {
        name: "stress_strain".into(),
        title: "Tension & <more>".into(),
        x,
        y,
        lines,
        marks,
        equal_units: false,
        scale: Scale::Linear,
        key: None,
    }
}

fn texts(document: &roxmltree::Document<'_>) -> Vec<String> {
    let gather = |node: roxmltree::Node<'_, '_>| {
        let text: String = node.descendants().filter(|d| d.is_text()).filter_map(|d| d.text()).collect();
        text.trim().to_string()
    };
    document.descendants().filter(|node| node.has_tag_name("text")).map(gather).collect()
}

/// Data lines (the frame, grid and axes are thinner), those of the legend included.
fn data_lines<'a>(document: &'a roxmltree::Document<'a>) -> Vec<roxmltree::Node<'a, 'a>> {
    let width = (2 * UNIT).to_string();
    let thick = move |node: &roxmltree::Node<'_, '_>| node.attribute("stroke-width") == Some(&width);
    document.descendants().filter(|node| node.has_tag_name("polyline")).filter(thick).collect()
}

#[test]
fn a_picture_has_its_axes_lines_and_marks() {
    let curve = |k: f64| (0..50).map(|i| (f64::from(i) * 1e-5, k * f64::from(i))).collect::<Vec<_>>();
    let marks = Marks { label: "measured".into(), points: vec![(1e-4, 3.0), (2e-4, 8.0)], line: Some(0) };
    let second = Line { style: Style { color: 1, dash: 0 }, ..line("two", curve(0.5)) };
    let svg = figure(vec![line("one", curve(1.0)), second], vec![marks]).svg().unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let texts = texts(&document);
    for expected in ["ε11[10−3]", "σ11[MPa]", "Tension & <more>", "one", "two", "measured", "0.1", "0.5", "10", "40"]
    {
        assert!(texts.iter().any(|text| text == expected), "{expected} in {texts:?}");
    }
    assert_eq!(data_lines(&document).len(), 4, "two lines, each also in the legend");
    // two points and one in the legend, each filled and outlined
    assert_eq!(document.descendants().filter(|node| node.has_tag_name("circle")).count(), 6);
    let root = document.root_element();
    assert_eq!(root.attribute("width"), Some("640"));
    assert_eq!(root.attribute("viewBox").map(|view| view.starts_with("0 0 12800 ")), Some(true));
}

#[test]
fn dashes_and_colours_distinguish_lines() {
    let styled = |color, dash| Line { style: Style { color, dash }, ..line("l", vec![(0.0, 0.0), (1.0, 1.0)]) };
    let svg = figure(vec![styled(0, 0), styled(0, 1), styled(1, 2), styled(1, 9)], vec![]).svg().unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let look = |line: &roxmltree::Node<'_, '_>| {
        ["stroke", "stroke-dasharray"].map(|name| line.attribute(name).map(String::from))
    };
    let lines: Vec<_> = data_lines(&document).iter().map(look).collect();
    let distinct: std::collections::BTreeSet<_> = lines.iter().collect();
    assert_eq!((lines.len(), distinct.len()), (8, 4), "{lines:?}");
    let six = figure((0..6).map(|dash| styled(0, dash)).collect(), vec![]).svg().unwrap();
    let six = roxmltree::Document::parse(&six).unwrap();
    let distinct: std::collections::BTreeSet<_> = data_lines(&six).iter().map(look).collect();
    assert_eq!(distinct.len(), 6, "{distinct:?}");
    assert_eq!(lines[0][1], None);
}

#[test]
fn one_line_needs_no_legend_and_gaps_interrupt_it() {
    let points = vec![(0.0, 0.0), (1.0, 1.0), (f64::NAN, 1.0), (2.0, f64::INFINITY), (2.0, 2.0), (3.0, 1.0)];
    let svg = figure(vec![line("alone", points)], vec![]).svg().unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    assert!(!texts(&document).iter().any(|text| text == "alone"));
    assert_eq!(data_lines(&document).len(), 2);
}

#[test]
fn anything_can_be_drawn() {
    let strange: [Vec<(f64, f64)>; 8] = [
        vec![],
        vec![(0.0, 0.0)],
        vec![(f64::NAN, 1.0)],
        vec![(0.0, 5.0), (1.0, 5.0)],
        vec![(1e-300, 1e300), (-1e-300, -1e300)],
        vec![(1.0, 1.0), (1.0 + 1e-15, 1.0 - 1e-15)],
        vec![(f64::MAX, f64::MIN), (f64::MIN, f64::MAX)],
        vec![(5e-324, 0.0), (0.0, 5e-324)],
    ];
    for equal_units in [false, true] {
        for points in &strange {
            let marks = Marks { label: "^{}_{".into(), points: points.clone(), line: None };
            let drawn = Figure { equal_units, ..figure(vec![line("x_{", points.clone())], vec![marks]) };
            roxmltree::Document::parse(&drawn.svg().unwrap()).unwrap();
        }
    }
}

/// A jump at one abscissa leaves nothing to enlarge along x.
#[test]
fn a_jump_has_no_inset() {
    let jump = (1..=10).map(|k| (0.0, 1e7 * f64::from(k)));
    let tail = (1..=10).map(|k| (f64::from(k), 0.1));
    for shift in [0.0, 1.0, -1.0] {
        let points: Vec<_> = jump.clone().chain(tail.clone()).map(|(x, y)| (x + shift, y)).collect();
        let svg = figure(vec![line("jump", points)], vec![]).svg().unwrap();
        assert_eq!(data_lines(&roxmltree::Document::parse(&svg).unwrap()).len(), 1, "{shift}");
    }
}

/// A picture that cannot be drawn takes nothing else away.
#[test]
fn a_picture_that_cannot_be_drawn_is_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let mut directory = ResultDirectory::open(folder.path(), Kind::Run, Access::default()).unwrap();
    directory.begin(&[]).unwrap();
    let mut drawings = Drawings::default();
    let panics = guarded::<String>(|| panic!("no range {}", 1));
    drawings.keep(&mut directory, "plots", "first", panics).unwrap();
    drawings.keep(&mut directory, "plots", "second", guarded(|| Ok("<svg/>".into()))).unwrap();
    assert_eq!(drawings.warnings, ["the picture first could not be drawn: no range 1"]);
    assert_eq!(drawings.pictures.len(), 1);
}

#[test]
fn decimation_keeps_order_ends_and_extremes() {
    let points: Vec<(f64, f64)> = (0..100_000)
        .map(|k| {
            let t = f64::from(k) * 1e-4;
            let spike = if k == 77_777 { 9.0 } else { 0.0 };
            ((3.0 * t).sin() * t, (50.0 * t).cos() + spike)
        })
        .collect();
    let kept = decimate(&points, 2000);
    assert!(kept.len() <= 2000 && kept.len() > 500, "{}", kept.len());
    assert_eq!((kept[0], kept[kept.len() - 1]), (points[0], points[99_999]));
    let extreme =
        |points: &[(f64, f64)], of: Coordinate, pick: fn(f64, f64) -> f64| points.iter().map(of).reduce(pick).unwrap();
    let coordinates: [Coordinate; 2] = [|point| point.0, |point| point.1];
    for of in coordinates {
        for pick in [f64::min, f64::max] {
            assert_eq!(extreme(&kept, of, pick), extreme(&points, of, pick));
        }
    }
    let mut rest = points.iter();
    assert!(kept.iter().all(|point| rest.any(|other| other == point)), "order");
    assert_eq!(decimate(&points[..1500], 2000), points[..1500]);
    assert_eq!(drawable_stretches(&[(0.0, 0.0), (f64::NAN, 0.0)]).count(), 1);
}

#[test]
fn axes_use_handy_numbers() {
    let axis = |column: &str, range| Axis::new(&Quantity::of(column, &BTreeMap::new()), range, 0.0, 9);
    let strain = axis("e11", (-0.005, 0.0));
    assert_eq!(strain.label, "ε_{11} [10^{−3}]");
    assert_eq!(strain.range.end, 0.0);
    let texts: Vec<String> = strain.ticks().iter().map(|&tick| strain.text(tick)).collect();
    assert_eq!(texts, ["−5", "−4", "−3", "−2", "−1", "0"]);
    let stress = axis("s11", (0.0, 3.5));
    assert_eq!(stress.label, "σ_{11} [MPa]");
    let texts: Vec<String> = stress.ticks().iter().map(|&tick| stress.text(tick)).collect();
    assert_eq!(texts, ["0.0", "0.5", "1.0", "1.5", "2.0", "2.5", "3.0", "3.5"]);
    assert_eq!(axis("slip", (0.0, 0.002)).label, "slip [10^{−3} mm]");
    assert_eq!(axis("slip", (0.0, 2.5)).label, "slip [mm]");
    assert_eq!(axis("load", (0.0, 2.5e6)).label, "load [10^{6} N]");
}

#[test]
fn columns_have_names_and_units() {
    let units = BTreeMap::from([("kappa".to_string(), "mm".to_string()), ("eta_t".to_string(), "-".to_string())]);
    let label = |column: &str| Quantity::of(column, &units).label(0);
    assert_eq!(label("g12"), "γ_{12} [–]");
    assert_eq!(label("kappa"), "κ [mm]");
    assert_eq!(label("eta_t"), "η_{t} [–]");
    assert_eq!(label("Y_t_max"), "Y_{t,max} [–]");
    assert_eq!(label("plastic_strain_11"), "plastic strain 11 [–]");
    assert_eq!(label("tau"), "τ [MPa]");
    for (column, group) in
        [("e11", Group::Strain), ("s23", Group::Stress), ("D_c", Group::Damage), ("sse", Group::Other)]
    {
        assert_eq!(group_of(column), group);
    }
    for odd in ["", "e", "é11", "s", "sé"] {
        assert_eq!(group_of(odd), Group::Other, "{odd}");
    }
}

#[test]
fn the_spec_survives_its_file_and_errors_name_theirs() {
    let folder = tempfile::tempdir().unwrap();
    let history = History::from_columns(vec![("e11".into(), vec![0.0, 1e-3]), ("s11".into(), vec![0.0, 3.0])]);
    let spec = Spec {
        title: "case".into(),
        law: "law".into(),
        subject: CaseKind::Point { controlled: vec![0] },
        units: BTreeMap::from([("eta".to_string(), "-".to_string())]),
        curves: vec![MeasuredCurve {
            label: "m".into(),
            x: "e11".into(),
            y: "s11".into(),
            points: vec![(0.1 + 0.2, -1e-9)],
        }],
        inputs: BTreeMap::from([("B_c".to_string(), "1.2".to_string())]),
        captions: Default::default(),
    };
    let mut directory = ResultDirectory::join(folder.path(), Kind::Run).unwrap();
    let pictures = draw(&mut directory, "plots", &history, &spec).unwrap().pictures;
    assert_eq!(std::fs::read_to_string(&pictures[0].path).unwrap(), pictures[0].svg);
    assert_eq!(Spec::read(&folder.path().join("plots").join(SPEC_FILE)).unwrap(), spec);
    std::fs::write(folder.path().join("file"), "").unwrap();
    let error = draw(&mut directory, "file/plots", &history, &spec).unwrap_err().to_string();
    assert!(error.contains("file/plots"), "{error}");
}

/// The bars of one name stand side by side on zero; what is no number has none.
#[test]
fn categories_have_bars_from_zero() {
    let marked = |label: &str, color, points: &[f64]| Line {
        marked: true,
        style: Style { color, dash: color },
        ..line(label, points.iter().enumerate().map(|(k, &y)| (k as f64, y)).collect())
    };
    let names = ["one", "two", "three"].map(String::from).to_vec();
    let lines = vec![marked("first", 0, &[1.0, 2.0, 4.0]), marked("second", 1, &[-1.0, f64::NAN, 1.0])];
    let svg = Figure { scale: Scale::Names(names), ..figure(lines, vec![]) }.svg().unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    assert_eq!(data_lines(&document).len(), 0);
    let rectangles = |fill: &str| -> Vec<[f64; 4]> {
        let filled =
            document.descendants().filter(|node| node.has_tag_name("rect") && node.attribute("fill") == Some(fill));
        let number = |node: &roxmltree::Node<'_, '_>, name| node.attribute(name).unwrap().parse::<f64>().unwrap();
        filled.map(|node| ["x", "y", "width", "height"].map(|name| number(&node, name))).collect()
    };
    let (first, second) = (rectangles("#0072B2"), rectangles("#D55E00"));
    assert_eq!((first.len(), second.len()), (3 + 1, 2 + 1), "with those of the legend");
    let [x, y, width, height] = first[0];
    assert!((first[1][3] / height - 2.0).abs() < 0.01 && (first[2][3] / height - 4.0).abs() < 0.01, "{first:?}");
    assert!((second[0][0] - (x + width)).abs() <= 2.0, "side by side");
    assert!((second[0][1] - (y + height)).abs() <= 2.0, "what is negative hangs from zero");
    assert!(texts(&document).iter().any(|text| text == "0"));
}

/// A peak too narrow to be seen is drawn again, larger; the legend makes room for it.
#[test]
fn a_spike_has_an_inset() {
    let load = |slip: f64| if slip < 0.02 { 500.0 * slip } else { 10.0 * (-(slip - 0.02) / 0.02).exp() + 0.2 };
    let points: Vec<(f64, f64)> = (0..2000).map(|k| f64::from(k) * 1e-3).map(|slip| (slip, load(slip))).collect();
    let shallow = points.iter().map(|&(x, y)| (x, 0.5 * y)).collect();
    let second = Line { style: Style { color: 1, dash: 0 }, ..line("two", shallow) };
    let svg = figure(vec![line("one", points.clone()), second], vec![]).svg().unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    assert_eq!(data_lines(&document).len(), 6, "two lines, in the picture, the inset and the legend");
    // the inset's lines are wider than the spike in the picture by far
    let across = |node: &roxmltree::Node<'_, '_>| {
        let xs = node
            .attribute("points")
            .unwrap()
            .split_whitespace()
            .map(|p| p.split(',').next().unwrap().parse::<f64>().unwrap());
        xs.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)))
    };
    let inset = across(&data_lines(&document)[2]);
    assert!(inset.1 - inset.0 > f64::from(150 * UNIT), "{inset:?}");
    let wide = points.iter().map(|&(x, _)| (x, x * (2.0 - x))).collect();
    let svg = figure(vec![line("hill", wide)], vec![]).svg().unwrap();
    assert_eq!(data_lines(&roxmltree::Document::parse(&svg).unwrap()).len(), 1, "no inset");
}

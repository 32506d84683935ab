use super::super::Spec;
use super::*;
use crate::history::History;
use pullout_run::program::Caption;
use std::collections::BTreeMap;

fn history(columns: &[(&str, &[f64])]) -> History {
    History::from_columns(columns.iter().map(|(name, values)| (name.to_string(), values.to_vec())).collect())
}

fn spec(subject: CaseKind) -> Spec {
    Spec {
        title: "case".into(),
        law: "a_law".into(),
        subject,
        units: Default::default(),
        curves: vec![],
        inputs: Default::default(),
        captions: Default::default(),
    }
}

fn curve(x: &str, y: &str) -> MeasuredCurve {
    MeasuredCurve { label: format!("{y} at {x}"), x: x.into(), y: y.into(), points: vec![(0.0, 0.0), (1.0, 1.0)] }
}

fn names(figures: &[Figure]) -> Vec<&str> {
    figures.iter().map(|figure| figure.name.as_str()).collect()
}

fn biaxial() -> History {
    history(&[
        ("e11", &[0.0, 1e-4, 2e-4]),
        ("e22", &[0.0, -3e-4, -6e-4]),
        ("e33", &[f64::NAN, f64::NAN, f64::NAN]),
        ("s11", &[0.0, 1.0, 2.0]),
        ("s22", &[0.0, -3.0, -5.0]),
        ("s12", &[0.0, 0.0, 0.0]),
        ("D_t", &[0.0, 0.1, 0.2]),
        ("D_c", &[0.0, 0.3, 0.4]),
    ])
}

#[test]
fn a_point_is_drawn_along_the_controlled_component_with_the_largest_strain() {
    let history = biaxial();
    let spec = spec(CaseKind::Point { controlled: vec![0, 1] });
    let figures = figures(&[PlottedRun { history: &history, spec: &spec, name: "" }]);
    assert_eq!(names(&figures), ["stress_strain", "damage_strain", "stress_path"]);
    assert_eq!(figures[0].lines[0].columns, ("e22".into(), "s22".into()));
    assert_eq!((figures[0].x.name.as_str(), figures[0].y.label(0).as_str()), ("ε_{22}", "σ_{22} [MPa]"));
    let labels: Vec<&str> = figures[1].lines.iter().map(|line| line.label.as_str()).collect();
    assert_eq!(labels, ["D_{t}", "D_{c}"]);
    assert_eq!(figures[1].y.name, "damage");
    assert_eq!(figures[2].lines[0].columns, ("s11".into(), "s22".into()));
    // a component that no step controls is not driven, however far it moves
    let spec = Spec { subject: CaseKind::Point { controlled: vec![0] }, ..spec };
    let figures = super::figures(&[PlottedRun { history: &history, spec: &spec, name: "" }]);
    assert_eq!(figures[0].lines[0].columns, ("e11".into(), "s11".into()));
}

#[test]
fn shear_turns_the_stress_path() {
    let history = history(&[
        ("g12", &[0.0, 1e-3]),
        ("s11", &[0.0, 0.5]),
        ("s22", &[0.0, 0.5]),
        ("s12", &[0.0, 3.0]),
        ("peeq", &[0.0, 1e-3]),
    ]);
    let spec = spec(CaseKind::Point { controlled: vec![3] });
    let figures = figures(&[PlottedRun { history: &history, spec: &spec, name: "" }]);
    assert_eq!(names(&figures), ["stress_strain", "plastic_strain", "stress_path"]);
    assert_eq!(figures[0].lines[0].columns, ("g12".into(), "s12".into()));
    assert_eq!(figures[2].lines[0].columns, ("s11".into(), "s12".into()));
}

/// Pure shear has no other stress, and a fibre whose exit moves with its grip no other slip.
#[test]
fn what_another_picture_shows_has_none_of_its_own() {
    let shear = history(&[("g12", &[0.0, 1e-3]), ("s11", &[0.0, 1e-12]), ("s12", &[0.0, 3.0])]);
    let of_shear = spec(CaseKind::Point { controlled: vec![3] });
    assert_eq!(names(&figures(&[PlottedRun { history: &shear, spec: &of_shear, name: "" }])), ["stress_strain"]);
    let fibre = |tail: [f64; 3]| {
        let fibre = history(&[
            ("slip", &[0.0, 0.1, 0.2]),
            ("load", &[0.0, 30.0, 20.0]),
            ("slip_exit", &[0.0, 0.0999, 0.1999]),
            ("slip_tail", &tail),
        ]);
        let figures = figures(&[PlottedRun { history: &fibre, spec: &spec(CaseKind::Pullout), name: "" }]);
        figures.into_iter().map(|figure| (figure.name, figure.lines.len())).collect::<Vec<_>>()
    };
    assert_eq!(fibre([0.0, 0.0998, 0.1998]), [("load_slip".to_owned(), 1)]);
    assert_eq!(fibre([0.0, 0.01, 0.1]), [("load_slip".to_owned(), 1), ("load_local_slip".to_owned(), 1)]);
}

/// A matrix without strength carries nothing.
#[test]
fn a_line_that_stays_at_nothing_is_left_out_beside_others() {
    let curves = |fibre: f64| {
        history(&[
            ("w", &[0.0, 1.0]),
            ("sigma", &[fibre, 0.0]),
            ("sigma_fibre", &[fibre, 0.0]),
            ("sigma_matrix", &[0.0, 0.0]),
        ])
    };
    let spec = spec(CaseKind::Bridging);
    let drawn = |history: &History| figures(&[PlottedRun { history, spec: &spec, name: "" }])[0].lines.len();
    assert_eq!((drawn(&curves(2.0)), drawn(&curves(0.0))), (1, 1), "σ = σ_f; without any all are one line");
}

#[test]
fn every_measured_curve_is_in_a_picture() {
    let history = biaxial();
    let mut spec = spec(CaseKind::Point { controlled: vec![1] });
    // its own, another pair of strain and stress, a damage, and something else
    spec.curves = vec![curve("e22", "s22"), curve("e11", "s22"), curve("e22", "D_c"), curve("D_t", "s11")];
    let figures = figures(&[PlottedRun { history: &history, spec: &spec, name: "" }]);
    assert_eq!(names(&figures), ["stress_strain", "damage_strain", "stress_path", "s11_D_t"]);
    let stress = &figures[0];
    assert_eq!(stress.marks.len(), 2);
    assert_eq!(stress.lines.len(), 2);
    assert_eq!(stress.marks.iter().map(|marks| marks.line).collect::<Vec<_>>(), [Some(0), Some(1)]);
    assert_eq!((stress.x.name.as_str(), stress.y.name.as_str()), ("ε", "σ_{22}"));
    assert_eq!(stress.lines[1].label, "a law, ε_{11}");
    assert_eq!(figures[1].marks[0].line, Some(1));
    assert_eq!(figures[3].marks.len(), 1);
}

/// A constant says nothing, nor does what rounding leaves of one: the load of 30 N is of its group.
#[test]
fn nothing_is_drawn_of_what_does_not_move() {
    let history = history(&[
        ("time", &[0.0, 1.0, 2.0]),
        ("slip", &[0.0, 0.1, 0.2]),
        ("load", &[0.0, 30.0, 20.0]),
        ("load_lateral", &[0.0, 1e-11, -2e-11]),
        ("slip_exit", &[0.0, 0.05, 0.15]),
        ("slip_tail", &[0.0, 0.0, 0.1]),
        ("sticking_points", &[160.0, 160.0, 160.0]),
        ("iterations", &[3.0, 3.0, 3.0]),
    ]);
    let spec = spec(CaseKind::Pullout);
    let run = PlottedRun { history: &history, spec: &spec, name: "" };
    assert_eq!(names(&figures(&[run])), ["load_slip", "load_local_slip"]);
    assert!(moves(&run, "load") && !moves(&run, "load_lateral"));
}

#[test]
fn lines_that_lie_on_each_other_are_one_with_both_names() {
    let line =
        |label: &str, end: f64| Line { label: label.into(), points: vec![(0.0, 0.0), (1.0, end)], ..Line::default() };
    // 0.1 % of the axis is less than a line is wide, 1 % is not
    let mut lines = vec![line("a", 1.0), line("b", 0.999), line("c", 0.99), line("d", 0.5)];
    assert_eq!(merge(&mut lines), [0, 0, 1, 2]);
    let labels: Vec<&str> = lines.iter().map(|line| line.label.as_str()).collect();
    assert_eq!(labels, ["a = b", "c", "d"]);
}

#[test]
fn runs_of_one_title_are_named_by_what_differs() {
    let history = biaxial();
    let with = |inputs: &[(&str, &str)]| {
        let inputs = inputs.iter().map(|(key, value)| (key.to_string(), value.to_string())).collect();
        Spec { inputs, ..spec(CaseKind::Point { controlled: vec![1] }) }
    };
    let named = |specs: [Spec; 2]| {
        let [first, second] = &specs;
        let runs =
            [(first, "case"), (second, "steeper")].map(|(spec, name)| PlottedRun { history: &history, spec, name });
        super::names(&runs)
    };
    let alike = [("E", "31800"), ("B_c", "1.05")];
    assert_eq!(named([with(&alike), with(&[("E", "31800"), ("B_c", "1.2")])]), ["B_c = 1.05", "B_c = 1.2"]);
    assert_eq!(named([with(&alike), with(&alike)]), ["case", "steeper"]);
}

#[test]
fn runs_are_named_by_title_and_share_a_measured_curve() {
    let history = biaxial();
    let mut first = spec(CaseKind::Point { controlled: vec![1] });
    first.curves = vec![curve("e22", "s22")];
    let second = Spec { title: "other".into(), ..first.clone() };
    let figures = figures(&[
        PlottedRun { history: &history, spec: &first, name: "" },
        PlottedRun { history: &history, spec: &second, name: "" },
    ]);
    let labels: Vec<&str> = figures[0].lines.iter().map(|line| line.label.as_str()).collect();
    assert_eq!(labels, ["case", "other"]);
    assert_eq!(figures[0].marks.len(), 1);
    let labels: Vec<&str> = figures[1].lines.iter().map(|line| line.label.as_str()).collect();
    assert_eq!(labels, ["case: D_{t}", "case: D_{c}", "other: D_{t}", "other: D_{c}"]);
    assert_eq!(figures[0].title, "");
}

#[test]
fn an_interface_gets_tractions_and_states() {
    let columns: [(&str, &[f64]); 6] = [
        ("slip", &[0.0, 0.1, 0.2]),
        ("gap", &[0.0, 0.0, 0.01]),
        ("tau", &[0.0, 5.0, 2.0]),
        ("p", &[1.0, 1.0, 0.0]),
        ("kappa", &[0.0, 0.1, 0.2]),
        ("d", &[0.0, 0.5, 0.9]),
    ];
    let spec = spec(CaseKind::Interface);
    let all = figures(&[PlottedRun { history: &history(&columns), spec: &spec, name: "" }]);
    assert_eq!(names(&all), ["traction_slip", "pressure_gap", "traction_path", "damage_slip", "kappa_slip"]);
    // FRIC knows no gap
    let friction = history(&[("slip", &[0.0, 0.1]), ("gap", &[f64::NAN; 2]), ("tau", &[0.0, 1.0]), ("p", &[2.0, 2.0])]);
    assert_eq!(names(&figures(&[PlottedRun { history: &friction, spec: &spec, name: "" }])), ["traction_slip"]);
}

#[test]
fn a_history_without_the_columns_gives_no_picture() {
    let spec = spec(CaseKind::Point { controlled: vec![] });
    assert!(figures(&[PlottedRun { history: &History::default(), spec: &spec, name: "" }]).is_empty());
    assert!(figures(&[]).is_empty());
}

#[test]
fn the_peak_of_the_first_curve_is_marked_where_it_falls_behind_it() {
    let peak = |slip: &[f64], load: &[f64]| {
        let history = history(&[("slip", slip), ("load", load)]);
        let spec = spec(CaseKind::Pullout);
        let figures = figures(&[PlottedRun { history: &history, spec: &spec, name: "" }]);
        figures[0].marks.iter().map(|marks| (marks.label.clone(), marks.points.clone(), marks.line)).collect::<Vec<_>>()
    };
    let marked = peak(&[0.0, 0.1, 0.2, 0.3], &[0.0, 31.25, 20.0, 10.0]);
    assert_eq!(marked, [("peak 31.25 N at 0.1 mm".into(), vec![(0.1, 31.25)], Some(0))]);
    // compression; the end of the path, and one from which it turned back; a plateau
    let pressed = peak(&[0.0, -0.1, -0.2], &[0.0, -3.0, -1.0]);
    assert_eq!(pressed, [("peak −3 N at −0.1 mm".into(), vec![(-0.1, -3.0)], Some(0))]);
    assert!(peak(&[0.0, 0.1, 0.2], &[0.0, 1.0, 2.0]).is_empty());
    assert!(peak(&[0.0, 0.2, 0.0], &[0.0, 2.0, 0.0]).is_empty());
    assert!(peak(&[0.0, 0.1, 0.2], &[0.0, 2.0, 1.95]).is_empty());
}

/// The load at the CMODs of EN 14651, between the rows.
#[test]
fn the_strengths_of_a_beam_are_marked() {
    let history = history(&[("cmod", &[0.0, 1.0, 2.0, 3.0, 4.0]), ("load", &[0.0, 10.0, 9.0, 8.0, 7.0])]);
    let spec = spec(CaseKind::Bridging);
    let figures = figures(&[PlottedRun { history: &history, spec: &spec, name: "" }]);
    let marks = figures[0].marks.iter().find(|marks| marks.points.len() == 4).expect("four loads");
    assert_eq!(marks.points, [(0.5, 5.0), (1.5, 9.5), (2.5, 8.5), (3.5, 7.5)]);
}

#[test]
fn pictures_have_the_titles_and_legends_of_the_case() {
    let history = biaxial();
    let legend = BTreeMap::from([("D_t".to_owned(), "in tension".to_owned())]);
    let captions = BTreeMap::from([
        ("stress_strain".to_owned(), Caption { title: Some("Test 3".into()), legend: BTreeMap::default() }),
        ("damage_strain".to_owned(), Caption { title: None, legend }),
    ]);
    let spec = Spec { captions, ..spec(CaseKind::Point { controlled: vec![0] }) };
    let figures = figures(&[PlottedRun { history: &history, spec: &spec, name: "" }]);
    let titles: Vec<&str> = figures.iter().map(|figure| figure.title.as_str()).collect();
    assert_eq!(titles[..2], ["Test 3", "Damage against strain"]);
    let labels: Vec<&str> = figures[1].lines.iter().map(|line| line.label.as_str()).collect();
    assert_eq!(labels, ["in tension", "D_{c}"]);
}

use super::super::Spec;
use super::*;
use crate::history::History;

fn history(columns: &[(&str, &[f64])]) -> History {
    History::from_columns(columns.iter().map(|(name, values)| (name.to_string(), values.to_vec())).collect())
}

fn spec(subject: CaseKind) -> Spec {
    Spec { title: "case".into(), law: "a_law".into(), subject, units: Default::default(), curves: vec![] }
}

fn curve(x: &str, y: &str) -> Curve {
    Curve { label: format!("{y} at {x}"), x: x.into(), y: y.into(), points: vec![(0.0, 0.0), (1.0, 1.0)] }
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
    let figures = figures(&[Run { history: &history, spec: &spec }]);
    assert_eq!(names(&figures), ["stress_strain", "damage_strain", "stress_path"]);
    assert_eq!(figures[0].lines[0].columns, ("e22".into(), "s22".into()));
    assert_eq!((figures[0].x.name.as_str(), figures[0].y.label(0).as_str()), ("ε_{22}", "σ_{22} [MPa]"));
    let labels: Vec<&str> = figures[1].lines.iter().map(|line| line.label.as_str()).collect();
    assert_eq!(labels, ["D_{t}", "D_{c}"]);
    assert_eq!(figures[1].y.name, "damage");
    assert_eq!(figures[2].lines[0].columns, ("s11".into(), "s22".into()));
    // a component that no step controls is not driven, however far it moves
    let spec = Spec { subject: CaseKind::Point { controlled: vec![0] }, ..spec };
    let figures = super::figures(&[Run { history: &history, spec: &spec }]);
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
    let figures = figures(&[Run { history: &history, spec: &spec }]);
    assert_eq!(names(&figures), ["stress_strain", "plastic_strain", "stress_path"]);
    assert_eq!(figures[0].lines[0].columns, ("g12".into(), "s12".into()));
    assert_eq!(figures[2].lines[0].columns, ("s11".into(), "s12".into()));
}

#[test]
fn every_measured_curve_is_in_a_picture() {
    let history = biaxial();
    let mut spec = spec(CaseKind::Point { controlled: vec![1] });
    // its own, another pair of strain and stress, a damage, and something else
    spec.curves = vec![curve("e22", "s22"), curve("e11", "s22"), curve("e22", "D_c"), curve("D_t", "s11")];
    let figures = figures(&[Run { history: &history, spec: &spec }]);
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

#[test]
fn runs_are_told_apart_by_title_and_share_a_measured_curve() {
    let history = biaxial();
    let mut first = spec(CaseKind::Point { controlled: vec![1] });
    first.curves = vec![curve("e22", "s22")];
    let second = Spec { title: "other".into(), ..first.clone() };
    let figures = figures(&[Run { history: &history, spec: &first }, Run { history: &history, spec: &second }]);
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
    let all = figures(&[Run { history: &history(&columns), spec: &spec }]);
    assert_eq!(names(&all), ["traction_slip", "pressure_gap", "traction_path", "damage_slip", "kappa_slip"]);
    // FRIC knows no gap
    let friction = history(&[("slip", &[0.0, 0.1]), ("gap", &[f64::NAN; 2]), ("tau", &[0.0, 1.0]), ("p", &[2.0, 2.0])]);
    assert_eq!(names(&figures(&[Run { history: &friction, spec: &spec }])), ["traction_slip"]);
}

#[test]
fn a_history_without_the_columns_gives_no_picture() {
    let spec = spec(CaseKind::Point { controlled: vec![] });
    assert!(figures(&[Run { history: &History::default(), spec: &spec }]).is_empty());
    assert!(figures(&[]).is_empty());
}

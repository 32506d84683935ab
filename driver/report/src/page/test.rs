use super::super::summary;
use super::*;
use crate::directory::{self, ResultDirectory};
use pullout_run::program::*;
use umat_abi::host::{Found, Plugin, search_paths};

fn account() -> Account {
    Account {
        case_file: "cases/x.json".into(),
        description: "A 5 % <strain> & \"back\"".into(),
        law: "pure_damage".into(),
        law_description: "Isotropic damage".into(),
        mode: "material point, 3-D (NTENS 6)".into(),
        settings: vec![("Characteristic length".into(), "10 mm".into())],
        parameters: vec![Parameter {
            name: "E".into(),
            value: "31800".into(),
            unit: "MPa".into(),
            meaning: "Young's modulus".into(),
        }],
        laws: vec![],
        defaults: vec!["material.props: nu = 0.18".into()],
        steps: vec!["100 increments, time 1: e11 → −0.005".into()],
        steps_left_out: 12,
    }
}

fn picture(path: &str, svg: String) -> Picture {
    Picture { path: path.into(), svg, is_field: false }
}

fn page_of(summary: &Summary) -> String {
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\"><text>σ</text></svg>".to_string();
    super::page_of(&account(), summary, &[picture("plots/a.svg", svg)], None).into_string()
}

#[test]
fn shows_everything() {
    let page = page_of(&summary::test::summary());
    let expected = [
        "<title>A &lt;title&gt; &amp; more</title>",
        "A 5 % &lt;strain&gt; &amp; &quot;back&quot;",
        "cases/x.json",
        "pure_damage 0.1.0 – Isotropic damage",
        &"ab".repeat(32),
        "<svg xmlns",
        "Young's modulus",
        "31800",
        "Characteristic length",
        "e11 → −0.005",
        "12 more steps",
        "Defaults used",
        "material.props: nu = 0.18",
        "strains beyond 5 %",
        "measured.csv",
        "1.25",
        "3.5",
        "Zero throughout or unknown: <code>e33</code>",
        ">done<",
    ];
    for text in expected {
        assert!(page.contains(text), "{text}\n{page}");
    }
}

#[test]
fn the_first_paragraph_of_a_description_is_its_caption() {
    let html = |text: &str| description(text).into_string();
    assert_eq!(html("One & two."), "<p class=\"description\">One &amp; two.</p>");
    let folded = html("Caption.\n\nData.\n\nSources.");
    let (caption, details) = folded.split_once("<details>").expect("a folded part");
    assert!(caption.contains("Caption.") && details.contains("<p>Data.</p><p>Sources.</p>"), "{folded}");
    assert_eq!(html(""), "");
}

#[test]
fn what_rounding_leaves_is_no_peak() {
    let mut summary = summary::test::summary();
    let noise = Peak { max: Some(2.6645e-15), min: Some(-1e-16), ..summary.peaks["s11"] };
    summary.peaks.insert("s22".into(), noise);
    let page = page_of(&summary);
    assert!(page.contains("Zero throughout or unknown: <code>e33, s22</code>") && !page.contains("10⁻¹⁵"), "{page}");
    // alone it is the greatest of its kind
    summary.peaks.shift_remove("s11");
    assert!(page_of(&summary).contains("2.6645·10⁻¹⁵"));
}

#[test]
fn no_wall_time_is_shown_as_that_of_a_call() {
    assert!(!page_of(&summary::test::summary()).contains("per plugin call"));
}

/// The answer, the pictures, the inputs, and what the solver did: in this order.
#[test]
fn the_answer_comes_first_and_the_solver_folded() {
    let account = account();
    let svg = |name: &str| picture(&format!("plots/{name}.svg"), format!("<svg id=\"{name}\"></svg>"));
    let field = Picture { is_field: true, ..svg("damage_D_t_peak") };
    let pictures = [svg("stress_strain"), svg("iterations"), field, svg("damage")];
    let page = super::page_of(&account, &summary::test::summary(), &pictures, None).into_string();
    let places = [
        ">done<",
        "Law: pure_damage",
        "stress_strain",
        "RMS difference from measured.csv",
        "Greatest σ<sub>11</sub>",
        "strains beyond 5 %",
        "id=\"damage\"",
        "<summary>Fields",
        "id=\"damage_D_t_peak\"",
        "What was run",
        "<summary>Solver",
        "id=\"iterations\"",
        "SHA-256",
    ];
    let found = places.map(|text| page.find(text).unwrap_or_else(|| panic!("{text}\n{page}")));
    assert!(found.is_sorted(), "{found:?}");
}

/// Inverted pictures show compression as tension.
#[test]
fn colours_of_data_are_the_same_in_the_dark() {
    assert!(!STYLE.contains("filter") && !STYLE.contains("invert"));
}

#[test]
fn needs_nothing_but_itself() {
    let page = page_of(&summary::test::summary());
    for reference in ["href", "src=", "url(", "@import", "<script", "<link", "https:"] {
        assert!(!page.contains(reference), "{reference}");
    }
    // the only address is the name of SVG's namespace
    assert_eq!(page.matches("http:").count(), page.matches("http://www.w3.org/2000/svg").count());
}

#[test]
fn says_why_a_run_failed() {
    let message = "no convergence at <e11>: stress control cannot pass a peak";
    let failed = Summary { status: Status::Failed, message: Some(message.into()), ..summary::test::summary() };
    let page = page_of(&failed);
    assert!(page.contains("no convergence at &lt;e11&gt;: stress control cannot pass a peak"));
    assert!(page.contains(">failed<"));
}

#[test]
fn the_page_is_written_or_the_error_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("report.html");
    let mut directory = ResultDirectory::join(folder.path(), directory::Kind::Run).unwrap();
    let drawings = Drawings { warnings: vec!["the picture a could not be drawn: why".into()], ..Drawings::default() };
    write(&mut directory, &account(), &mut summary::test::summary(), &drawings, None).unwrap();
    let warnings = Summary::read(&folder.path().join(summary::FILE)).unwrap().warnings;
    assert!(warnings.contains(&drawings.warnings[0]), "{warnings:?}");
    assert!(std::fs::read_to_string(&path).unwrap().starts_with("<!DOCTYPE html>"));
    let missing = folder.path().join("report.html/none");
    let error = ResultDirectory::join(&missing, directory::Kind::Run).unwrap_err();
    assert!(error.to_string().contains("report.html/none"));
}

/// `linear_elastic` along a ramp with a relation, a row of a table and a bound.
fn program() -> Program {
    let found = Found::by_name("linear_elastic", &search_paths(&[])).expect("plugins are built next to the tests");
    let library = pullout_run::isolation::load(&found.path).expect("a library");
    let law = library.laws().iter().find(|law| law.name == "linear_elastic").expect("the law").clone();
    let mut controls = [Control::FREE; 6];
    controls[0] = Control::Strain(-0.005);
    controls[3] = Control::HoldStrain;
    let (mut strain, mut stress) = ([0.0; 6], [0.0; 6]);
    (strain[1], stress[0]) = (2.0, -0.52);
    let until = Until { column: 3, absolute: true, greater_than: Some(0.01), less_than: None };
    let step = |(pace, rows), constraints: Vec<Constraint>, until| PointStep {
        pace,
        goal: PointGoal { drive: PointDrive::Components { controls, rows }, constraints },
        until,
        fields: StepFields::default(),
    };
    let ramp = (Pace::Equal { increments: 100, time: 1.0 }, Vec::new());
    let table = (Pace::Rows(vec![1.0]), vec![[0.0; 6]]);
    Program {
        about: About {
            case_file: "case.json".into(),
            title: "t".into(),
            description: "about".into(),
            every: 10,
            plots: true,
            ..About::default()
        },
        document: serde_json::Value::Null,
        plugin: Plugin { props: vec![31800.0, 0.18, -7.5], ..Plugin::with_defaults(&library, &law) },
        kind: PointKind::Point(PointProgram {
            heat: false,
            mode: Mode::PlaneStress,
            nlgeom: false,
            measure: Measure::Logarithmic,
            arguments: pullout_run::arguments::UmatArguments::default(),
            initial: PointState {
                strain: [0.0; 6],
                stress: None,
                statev: None,
                time: 0.0,
                deformation_gradient: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                fields: FieldValues::default(),
            },
            steps: std::iter::once(step(
                ramp,
                vec![Constraint { strain, stress, equals: 3.0, hold: false }],
                Some(until),
            ))
            .chain((0..50).map(|_| step(table.clone(), vec![], None)))
            .collect(),
        }),
        characteristic_length: Some(12.5),
        controls: IterationLimits::default(),
    }
}

#[test]
fn a_program_is_described_by_sentences() {
    let account = Account::of_point(&program());
    let expected = "100 increments, time 1: e11 → −0.005, g12 held; 2 e22 + −0.52 s11 = 3; until |e11| > 0.01";
    assert_eq!(account.steps[0], expected);
    assert_eq!(account.steps[1], "table of 1 row: e11, g12");
    assert_eq!(account.steps.len() + account.steps_left_out, 51);
    assert_eq!(account.mode, "material point, plane stress (NTENS 3)");
    let settings = [("Characteristic length", "12.5 mm"), ("History", "every 10th increment")];
    assert_eq!(account.settings, settings.map(|(key, value)| (key.to_string(), value.to_string())));
    let parameters: Vec<_> = account.parameters.iter().map(|p| (p.name.as_str(), p.value.as_str())).collect();
    // the metadata know two
    assert_eq!(parameters, [("E", "31800"), ("nu", "0.18"), ("PROPS(3)", "−7.5")]);
    assert_eq!(account.parameters[0].unit, "MPa");
    assert!(!account.parameters[0].meaning.is_empty());
}

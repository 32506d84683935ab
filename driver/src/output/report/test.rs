use super::super::summary;
use super::*;
use std::path::PathBuf;

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
        steps: vec!["100 increments, time 1: e11 → −0.005".into()],
        steps_left_out: 12,
    }
}

fn page_of(summary: &Summary) -> String {
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\"><text>σ</text></svg>".to_string();
    page(&account(), summary, &[Picture { path: PathBuf::from("plots/a.svg"), svg }]).into_string()
}

#[test]
fn tells_everything() {
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
        "strains beyond 5 %",
        "measured.csv",
        "1.25",
        "3.5",
        "Zero throughout or not known: <code>e33</code>",
        ">done<",
    ];
    for text in expected {
        assert!(page.contains(text), "{text}\n{page}");
    }
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
    write(&path, &account(), &summary::test::summary(), &[]).unwrap();
    assert!(std::fs::read_to_string(&path).unwrap().starts_with("<!DOCTYPE html>"));
    let missing = folder.path().join("none/report.html");
    let error = write(&missing, &account(), &summary::test::summary(), &[]).unwrap_err();
    assert!(error.to_string().contains("none/report.html"));
}

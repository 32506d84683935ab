//! Errors that a UMAT has at first, and what the program says of them.

use super::{built, check, point};
use crate::program::{Desk, Run};
use end_to_end_tests::workspace;
use serde_json::json;

fn warnings(run: &Run) -> String {
    let texts = run.summary["warnings"].as_array().expect("a list").iter();
    texts.map(|text| text.as_str().expect("text")).collect::<Vec<_>>().join("\n")
}

/// Where inputs lie next to each other, a write behind one is a write into the next.
#[test]
fn a_write_behind_an_input_names_both() {
    let desk = Desk::new();
    let text = |name: &str| format!("   call spoil({name})\n");
    let spoil = "subroutine spoil(a, n)\n   real(8) :: a(*)\n   integer :: n\n   a(n) = 1\nend subroutine\n";
    for (call, words) in [
        ("stran, 7", "writes DSTRAN (or STRAN behind its end, where DSTRAN lies), which"),
        ("time, 3", "writes DTIME (or TIME behind its end, where DTIME lies), which"),
        ("dstran, 1", "writes DSTRAN (or STRAN behind its end, where DSTRAN lies), which"),
        ("dstran, 2", "writes DSTRAN, which"),
    ] {
        desk.write("spoil.f90", spoil);
        let source = std::fs::read_to_string(workspace("tests/umats/j2_habits.f90")).expect("a source");
        let place = "   statev(1) = statev(1) + multiplier\n";
        let source = source.replace("real(dp), intent(in) :: stran(*)", "external spoil\n   real(dp) :: stran(*)");
        let source = source.replace("predef(*), dpred(*)\n   real(dp), intent(in)", "predef(*), dpred(*)\n   real(dp)");
        let file = desk.write("mine.f90", &source.replace(place, &format!("{}{place}", text(call))));
        let spoil = desk.path("spoil.f90");
        let files = [file.to_str().expect("UTF-8"), spoil.to_str().expect("UTF-8")];
        let Some(library) = super::built_of(&desk, &files, &[]) else { return };
        let material = json!({ "plugin": library, "props": [200e3, 0.3, 250, 1000, 0, 0, 0], "nstatv": 7 });
        let steps = json!([{ "increments": 2, "target": { "e11": 1e-3 } }]);
        let run = super::run(&desk, "spoilt", &point(material, "3d", steps));
        assert!(warnings(&run).contains(words), "{call}: {}", warnings(&run));
    }
}

/// What depends on F at the end alone does not depend on the number of increments.
#[test]
fn hyperelasticity_does_not_depend_on_the_size_of_increments() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    let material = json!({ "plugin": library, "props": [80.0, 500.0], "nstatv": 0 });
    let mut case = point(material, "3d", json!([{ "increments": 20, "target": { "e11": 0.8 } }]));
    case["nlgeom"] = json!(true);
    let case = desk.case("case.json", &case);
    let arguments = ["plugin", "check", library.as_str().expect("a path"), "--states", "40", "--case"];
    let outcome = desk.pullout(arguments.iter().map(AsRef::as_ref).chain([case.as_os_str()])).expect(0);
    let row = check::row(&outcome, "increment size");
    let figure: f64 =
        row.get(50..).and_then(|rest| rest.split_whitespace().next()).and_then(|x| x.parse().ok()).expect(row);
    assert!(figure < 1e-9, "{row}");
}

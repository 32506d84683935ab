//! The crack band through the program: h·∫σ dε = G_f for any characteristic length h, and what is refused.

mod program;

use program::{Desk, cases, json};
use serde_json::{Value, json};

/// Of `cases/examples/crack-band-50mm.json`.
const FRACTURE_ENERGY: f64 = 0.1;
/// B_t of the default parameters.
const EXPONENT: f64 = 1.3;

fn case() -> Value {
    json(&cases().join("examples/crack-band-50mm.json"))
}

/// h·∫σ dε of a crack that opens by 40 mm, the tail beyond it included.
///
/// By the trapezoidal rule on increments that grow with the opening; the law alone keeps its energy to 1e-6 (tests of
/// `models`), so 1e-4 is what the rule leaves. The tail of σ ~ ε^(1−2B) beyond the last strain is σ ε / (2B − 2).
fn dissipated(desk: &Desk, length: f64) -> f64 {
    let mut case = case();
    case["characteristic_length"] = json!(length);
    case["steps"] = json!([
        { "increments": 400, "target": { "e11": 4e-4 } },
        { "increments": 4000, "target": { "e11": 0.4 / length } },
        { "increments": 20000, "target": { "e11": 40.0 / length } },
    ]);
    case["output"] = json!({ "plots": false });
    let run = desk.run(&desk.case(&format!("{length}.json"), &case), &[], &format!("{length}"), 0);
    let tail = run.history.last("s11") * run.history.last("e11") / (2.0 * EXPONENT - 2.0);
    length * (run.history.area("e11", "s11") + tail)
}

#[test]
fn the_energy_is_that_of_the_crack_for_any_length() {
    let desk = Desk::new();
    for length in [10.0, 30.0, 50.0, 100.0] {
        let energy = dissipated(&desk, length);
        println!("h = {length} mm: {energy} N/mm");
        assert!((energy / FRACTURE_ENERGY - 1.0).abs() < 1e-4, "h = {length}: {energy} N/mm");
    }
}

#[test]
fn the_energy_of_the_case_itself_is_as_described() {
    let desk = Desk::new();
    let run = desk.run(&cases().join("examples/crack-band-50mm.json"), &[], "out", 0);
    let energy = 50.0 * run.history.area("e11", "s11");
    assert!((energy - 0.0909).abs() < 1e-4, "{energy}");
    assert!(case()["description"].as_str().is_some_and(|text| text.contains("Up to e11 = 0.008 it is 0.091 N/mm")));
}

#[test]
fn a_length_too_large_is_refused_with_the_limit() {
    let desk = Desk::new();
    for (length, energy, limit) in [("1000", "G_f", "235.1"), ("200", "G_c", "108.8")] {
        let mut case = case();
        case["characteristic_length"] = json!(length.parse::<f64>().expect("a number"));
        let outcome = desk.pullout(["run".as_ref(), desk.case("large.json", &case).as_os_str()]).expect(2);
        let message = &outcome.stderr;
        assert!(
            message.contains(&format!("length {length} mm is too large for {energy}: the limit is {limit}")),
            "{message}"
        );
        assert!(message.contains("$.material.props") || message.contains("$.characteristic_length"), "{message}");
        assert!(!desk.has_results());
    }
}

#[test]
fn a_missing_length_is_refused() {
    let desk = Desk::new();
    let mut case = case();
    case.as_object_mut().expect("an object").remove("characteristic_length");
    let outcome = desk.pullout(["run".as_ref(), desk.case("none.json", &case).as_os_str()]).expect(2);
    assert!(outcome.stderr.contains("$.characteristic_length: is missing"), "{}", outcome.stderr);
    assert!(!desk.has_results());
}

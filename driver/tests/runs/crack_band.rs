//! The crack band through the program: h·∫σ dε = G_f for any characteristic length h, and what is refused.

use crate::program::{Desk, Table, cases, json};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Parameters of `cases/examples/crack-band-50mm.json`.
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

/// Returns the folder of the beam and its reference.
fn study() -> PathBuf {
    cases().parent().expect("the workspace").join("bench/crack-band")
}

/// From an outer x or the bottom to the ligament, coarse to fine, mm.
const COLUMNS: [f64; 17] = [
    -170.0, -160.0, -150.0, -138.0, -126.0, -114.0, -102.0, -90.0, -78.0, -66.0, -54.0, -42.0, -30.0, -20.0, -12.0,
    -5.0, -2.5,
];
/// The rows of the notch; above it they are 5 mm high.
const NOTCH_ROWS: [f64; 6] = [0.0, 12.0, 24.0, 34.0, 42.0, 50.0];

/// The beam of the study in elements of one kind, Gmsh's number `kind`, 5 mm at the ligament, as a mesh file. `moved` is
/// where a node goes.
fn beam(kind: u32, moved: impl Fn([f64; 2]) -> [f64; 2]) -> String {
    let columns: Vec<f64> = COLUMNS.iter().copied().chain(COLUMNS.iter().rev().map(|x| -x)).collect();
    let rows: Vec<f64> = NOTCH_ROWS.iter().copied().chain((1..=10).map(|k| 50.0 + 5.0 * f64::from(k))).collect();
    let (is_quadratic, is_triangle) = (matches!(kind, 9 | 16), matches!(kind, 2 | 9));
    let mut nodes: Vec<[f64; 2]> = Vec::new();
    let mut node = |position: [f64; 2]| {
        let found = nodes.iter().position(|other| *other == position);
        1 + found.unwrap_or_else(|| {
            nodes.push(position);
            nodes.len() - 1
        })
    };
    let mut elements = Vec::new();
    for x in columns.windows(2) {
        for y in rows.windows(2).filter(|y| x[0] * x[1] > 0.0 || y[0] >= 50.0) {
            let corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]].map(&moved);
            let halves: &[&[usize]] = if is_triangle { &[&[0, 1, 2], &[0, 2, 3]] } else { &[&[0, 1, 2, 3]] };
            for half in halves {
                let corner = |k: usize| corners[half[k % half.len()]];
                let middle = |k: usize| [0, 1].map(|i| 0.5 * (corner(k)[i] + corner(k + 1)[i]));
                let count = if is_quadratic { 2 * half.len() } else { half.len() };
                let numbers = (0..count).map(|k| if k < half.len() { corner(k) } else { middle(k - half.len()) });
                elements.push(numbers.map(|position| node(position).to_string()).collect::<Vec<_>>().join(" "));
            }
        }
    }
    let sets = [(1, [-5.0, 100.0]), (1, [5.0, 100.0]), (2, [-150.0, 0.0]), (3, [150.0, 0.0])];
    let points = sets.map(|(set, position)| format!("15 2 {set} {set} {}", node(position)));
    let numbered = |lines: &[String]| -> String {
        let lines = lines.iter().enumerate();
        lines.map(|(k, line)| format!("{} {line}\n", k + 1)).collect()
    };
    let nodes: Vec<String> = nodes.iter().map(|[x, y]| format!("{x} {y} 0")).collect();
    let elements: Vec<String> =
        points.into_iter().chain(elements.iter().map(|nodes| format!("{kind} 2 4 4 {nodes}"))).collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n0 1 \"load\"\n0 2 \"left\"\n0 3 \"right\"\n2 4 \"beam\"\n\
         $EndPhysicalNames\n$Nodes\n{}\n{}$EndNodes\n$Elements\n{}\n{}$EndElements\n",
        nodes.len(),
        numbered(&nodes),
        elements.len(),
        numbered(&elements)
    )
}

/// Peak and work of a beam against those of a cohesive crack, and the warnings of its crack band.
fn against_cohesive_crack(law: &str, mesh: &str) -> ([f64; 2], Vec<String>) {
    let desk = Desk::new();
    desk.write("beam.msh", mesh);
    let mut case = json(&study().join("beam.json"));
    case["parts"]["beam"]["material"]["plugin"] = json!(law);
    let run = desk.run(&desk.case("beam.json", &case), &[], "out", 0);
    let cohesive = Table::read(&study().join("cohesive.csv"));
    let peak = |table: &Table| table.column("load").into_iter().fold(0.0, f64::max);
    let ratios =
        [peak(&run.history) / peak(&cohesive), run.history.area("slip", "load") / cohesive.area("slip", "load")];
    let warnings = run.summary["warnings"].as_array().expect("a list").iter().filter_map(Value::as_str);
    (ratios, warnings.filter(|warning| warning.contains("crack band")).map(str::to_owned).collect())
}

/// The straight crack of an aligned beam dissipates G_f times its area in elements of every kind: the curve is that of a
/// cohesive crack with the law's own σ(w) (`bench/crack-band`).
#[test]
fn an_aligned_crack_is_the_cohesive_crack_in_every_kind_of_element() {
    for (name, kind) in [("T3", 2), ("Q4", 3), ("T6", 9), ("Q8", 16)] {
        let ([peak, work], warnings) = against_cohesive_crack("concrete_damage", &beam(kind, |position| position));
        println!("{name}: peak {peak:.3}, work {work:.3}");
        assert!((peak - 1.0).abs() < 0.04 && (work - 1.0).abs() < 0.05, "{name}: {peak} {work}");
        assert!(warnings.is_empty(), "{name}: {warnings:?}");
    }
}

/// Checks that warnings are given where the elements cannot reach the fracture energy: columns that lean by 27° lock; a column of
/// Q8 that is not quite regular opens at one of its two columns of points; a column of flat elements is not as wide as √A.
fn leaning_columns_lock(kinds: &[(&str, u32)]) {
    let leaning = |[x, y]: [f64; 2]| {
        let to_the_side = 0.5 * (25.0 - (y - 75.0).abs()).max(0.0);
        [x + to_the_side * (1.0 - x.abs() / 60.0).max(0.0), y]
    };
    for &(name, kind) in kinds {
        let ([peak, work], warnings) = against_cohesive_crack("concrete_damage", &beam(kind, leaning));
        println!("{name}: peak {peak:.3}, work {work:.3}, {warnings:?}");
        assert!(work > 1.2 && warnings.iter().any(|warning| warning.contains("lock")), "{name}: {work} {warnings:?}");
    }
}

#[test]
#[ignore = "long: a_crack_that_misses_its_energy_is_reported has one kind of element"]
fn a_crack_that_misses_its_energy_is_reported_in_every_kind_of_element() {
    leaning_columns_lock(&[("T3", 2), ("Q4", 3), ("T6", 9)]);
}

#[test]
fn a_crack_that_misses_its_energy_is_reported() {
    leaning_columns_lock(&[("Q4", 3)]);
    let uneven = |[x, y]: [f64; 2]| {
        let is_inside = x.abs() < 12.0 && y > 50.0 && y < 100.0;
        if is_inside { [x + 0.25 * (0.7 * (x + y)).sin(), y] } else { [x, y] }
    };
    let ([peak, work], warnings) = against_cohesive_crack("concrete_damage_implex", &beam(16, uneven));
    println!("uneven Q8: peak {peak:.3}, work {work:.3}, {warnings:?}");
    assert!(work < 0.7 && warnings.iter().any(|warning| warning.contains("partly open")), "{work} {warnings:?}");
    // a column above the notch as wide as a quarter of its elements' height: √A is twice that
    let narrow = |[x, y]: [f64; 2]| if x.abs() < 3.0 { [0.25 * x, y] } else { [x, y] };
    let ([peak, work], warnings) = against_cohesive_crack("concrete_damage", &beam(3, narrow));
    println!("narrow Q4: peak {peak:.3}, work {work:.3}, {warnings:?}");
    assert!(work < 0.7 && warnings.iter().any(|warning| warning.contains("not as wide")), "{work} {warnings:?}");
}

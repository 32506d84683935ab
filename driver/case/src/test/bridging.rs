use super::malformed::{Sample, Seen::ByMeaning, Seen::BySchema, check};
use super::{Bench, Case};
use pullout_bridging::{Bond, Orientation};
use pullout_run::bridging::Source;
use serde_json::{Value, json};

fn case() -> Value {
    json!({
        "kind": "bridging",
        "fibre": { "diameter": 0.5, "length": 30, "E": 210000, "model": "closed", "tau": 3 },
        "volume_fraction": 0.01,
        "matrix": { "E": 30000, "ft": 3, "softening": "exponential", "Gf": 0.1 },
        "beam": {}
    })
}

const TABLE: &str = r#"fibre={"diameter": 0.5, "length": 30, "E": 210000, "model": "table", "file": "curves.csv"}"#;
const LAW: &str =
    r#"fibre={"diameter": 0.5, "length": 30, "E": 210000, "model": "shear_lag", "law": [[0, 1], [0, 2]]}"#;

const COUNTED: &str = r#"orientation={"type": "histogram", "file": "path.csv"}"#;
const RUNS: &str = r#"fibre={"diameter": 0.406, "length": 24.4, "E": 210000, "model": "fe", "base": "fibre.json"}"#;

const MALFORMED: &[Sample] = &[
    (&["fibre.model=close"], "$.fibre.model", "nearest valid name: 'closed'", BySchema),
    (&["fibre.tua=3"], "$.fibre.tua", "unknown key", BySchema),
    (&[r#"fibre={"diameter": 0.5, "length": 30, "E": 2e5, "model": "closed"}"#], "$.fibre.tau", "is missing", BySchema),
    (&["fibre.tau=high"], "$.fibre.tau", "expected a number", BySchema),
    (&["fibre.tau=-3"], "$.fibre.tau", "must be above 0", ByMeaning),
    (&["fibre.length=2"], "$.fibre.length", "must be 5 diameters or more", ByMeaning),
    (&["fibre.E=0"], "$.fibre.E", "must be above 0", ByMeaning),
    (&["fibre.strength=-1"], "$.fibre.strength", "must be above 0", ByMeaning),
    (&[r#"fibre.inclination={"type": "exp", "f": -1}"#], "$.fibre.inclination.f", "must not be below 0", ByMeaning),
    (
        &[r#"fibre.inclination={"type": "expo", "f": 1}"#],
        "$.fibre.inclination.type",
        "nearest valid name: 'exp'",
        BySchema,
    ),
    (&["volume_fraction=0.3"], "$.volume_fraction", "must be above 0 and not above 0.2", ByMeaning),
    (&["volume_fraction=0"], "$.volume_fraction", "must be > 0", BySchema),
    (&["matrix.Gf=0"], "$.matrix.Gf", "must be above 0", ByMeaning),
    (&["matrix.softening=steep"], "$.matrix.softening", "expected", BySchema),
    (&["modular_ratio=-1"], "$.modular_ratio", "must be >= 0", BySchema),
    (&[r#"orientation={"type": "beta", "r": 0.2, "q": 1}"#], "$.orientation.r", "p would have no bound", ByMeaning),
    (
        &[r#"orientation={"type": "histogram", "edges_deg": [0, 50, 40], "counts": [1, 2]}"#],
        "$.orientation.edges_deg",
        "must rise between 0 and 90 degrees",
        ByMeaning,
    ),
    (&[r#"orientation={"type": "histogram"}"#], "$.orientation.edges_deg", "must be one more than counts", ByMeaning),
    (&[COUNTED], "$.orientation.file", "no column is called 'from_deg'", ByMeaning),
    (
        &[COUNTED, "orientation.file=bins.csv"],
        "$.orientation.file",
        "the bin to 20° is followed by one from 30°",
        ByMeaning,
    ),
    (&[COUNTED, "orientation.file=nothing-counted.csv"], "$.orientation.file", "nor all 0", ByMeaning),
    (&[COUNTED, "orientation.counts=[1]"], "$.orientation.file", "beside edges_deg or counts", ByMeaning),
    (&[r#"orientation={"type": "number", "eta": 0.999}"#], "$.orientation.eta", "must lie between", ByMeaning),
    (&["openings={\"points\": 1}"], "$.openings.points", "must be >= 3", BySchema),
    (&["openings={\"to\": -1}"], "$.openings.to", "must be > 0", BySchema),
    (&["sides=three"], "$.sides", "expected", BySchema),
    (&["beam={\"notch\": 200}"], "$.beam.notch", "less than the height", ByMeaning),
    (&["beam={\"depth\": 200}"], "$.beam.depth", "unknown key", BySchema),
    (&["scatter={\"beams\": 1}"], "$.scatter.beams", "must lie between 2 and 1000000", ByMeaning),
    (&["beam=null", "scatter={}"], "$.scatter", "give \"beam\" too", ByMeaning),
    (
        &[r#"compare=[{"file": "curve.csv", "file_x": "strain", "file_y": "other", "x": "w", "y": "load"}]"#],
        "$.compare[0].y",
        "columns of two files",
        ByMeaning,
    ),
    (&[TABLE], "$.fibre.file", "curves.csv cannot be read", ByMeaning),
    (&[TABLE, "fibre.file=path.csv"], "$.fibre.file", "no column is called 'theta_deg'", ByMeaning),
    (&[TABLE, "fibre.file=short.csv"], "$.fibre.curves", "must reach half the length of the fibre", ByMeaning),
    (&[LAW], "$.fibre.law[1]", "must have a greater slip", ByMeaning),
    (&[RUNS, "fibre.base=case.json"], "$.fibre.base", "is no case of kind \"pullout\"", ByMeaning),
    (&[RUNS, "fibre.base=nowhere.json"], "$.fibre.base", "cannot be read", ByMeaning),
    (&[RUNS, "fibre.diameter=0.5"], "$.fibre.base", "has a fibre of 0.406 mm, this one is 0.5 mm thick", ByMeaning),
    (&[RUNS, "fibre.set={\"steps.0.slip\": \"far\"}"], "$.fibre.base", "$.steps[0].slip", ByMeaning),
    (&[RUNS, "fibre.angles_deg=[0, 45, 30]"], "$.fibre.angles_deg", "must rise", ByMeaning),
    (&[RUNS, "fibre.angles_deg=[0, 89]"], "$.fibre.angles_deg", "no length reaches 2 diameters deep", ByMeaning),
    (&[RUNS, "fibre.lengths=[0.5]"], "$.fibre.lengths", "from above 0 to 1", ByMeaning),
    (
        &[LAW, r#"fibre.law={"plugin": "bond_slip", "props": {"k_x": 1}}"#],
        "$.fibre.law",
        "has no parameter 'k_x'",
        ByMeaning,
    ),
    (&[LAW, "fibre.law=5"], "$.fibre.law", "expected", BySchema),
    (&["until={}"], "$.until", "unknown key", BySchema),
];

#[test]
fn malformed_cases_of_bridging_are_explained() {
    check(&case(), MALFORMED);
}

#[test]
fn one_mistake_is_told_once() {
    let bench = Bench::new();
    for (overrides, place, ..) in MALFORMED {
        let errors = bench.read(&case(), overrides).expect_err("malformed");
        assert_eq!(errors.problems.len(), 1, "{place}:\n{errors}");
    }
}

#[test]
fn mistakes_in_several_parts_are_told_at_once() {
    let overrides = ["fibre.tau=0", "matrix.ft=0", "beam.width=0", r#"orientation={"type": "beta", "r": 0, "q": 1}"#];
    let errors = Bench::new().read(&case(), &overrides).expect_err("malformed");
    let places: Vec<&str> = errors.problems.iter().filter_map(|p| p.place.as_ref()).map(|p| p.as_str()).collect();
    assert_eq!(places, ["$.fibre.tau", "$.matrix.ft", "$.beam.width"], "{errors}");
}

#[test]
fn what_a_case_leaves_out_is_random_and_two_sided() {
    let Ok(Case::Bridging(program)) = Bench::new().read(&case(), &[]) else { panic!("a case") };
    assert_eq!(program.orientation, Orientation::Random3d);
    assert_eq!((program.openings.len(), program.openings[0], program.openings[199]), (200, 0.0, 3.5));
    assert!((program.modular_ratio - 210e3 * 0.01 / (30e3 * 0.99)).abs() < 1e-12);
    assert!(program.columns().iter().any(|column| column == "cmod"));
    assert!(!program.columns().iter().any(|column| column == "load_05"), "nothing was drawn at random");
}

#[test]
fn counted_directions_are_read_from_a_file() {
    let of_file = [COUNTED, "orientation.file=counted.csv"];
    let Ok(Case::Bridging(program)) = Bench::new().read(&case(), &of_file) else { panic!("a case") };
    let given = Orientation::Histogram { edges_deg: vec![0.0, 20.0, 90.0], counts: vec![3.0, 4.0], file: None };
    assert_eq!(program.orientation, given);
}

/// A plugin's law is the traction that it has under a growing slip.
#[test]
fn a_law_of_contact_is_sampled() {
    let law = r#"fibre.law={"plugin": "bond_slip", "props": {"law": "A", "form": "piecewise", "normal_law": "hard", "p_0": 3,
        "delta_N": 0.004, "k_e": 400, "tau_res": 0, "k_u": 0, "mu": 0, "points": [[0.004, 1.6], [1, 0.6]]}}"#;
    let Ok(Case::Bridging(program)) = Bench::new().read(&case(), &[LAW, law]) else { panic!("a case") };
    let Source::Bond(Bond::ShearLag(bond), _) = &program.source else { panic!("a bond law") };
    let points = &bond.law.points;
    assert!(points[0] == [0.0, 0.0] && (points.last().expect("points")[0] - 15.0).abs() < 1e-9);
    for [slip, traction] in points {
        let exact = if *slip <= 0.004 { 400.0 * slip } else { 1.6 - (slip.min(1.0) - 0.004) / 0.996 };
        assert!((traction - exact).abs() < 1e-9, "{slip}: {traction} for {exact}");
    }
}

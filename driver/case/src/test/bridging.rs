use super::malformed::{Sample, Seen::ByMeaning, Seen::BySchema, check};
use super::{Bench, Case};
use pullout_bridging::{Bond, Orientation, Polyline};
use pullout_run::bridging::{BridgingProgram, BridgingResults, LoadSource, run};
use serde_json::{Value, json};
use std::f64::consts::PI;

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

const HOOK: &str =
    r#"fibre.hook={"lengths": [2, 2.5], "angle_deg": 45, "radius": 1, "friction": 0.2, "yield_stress": 1000}"#;

const MALFORMED: &[Sample] = &[
    (&[TABLE, "fibre.file=falling.csv"], "$.fibre.file", "at 30°, 15 mm the slip 0.1 mm follows 0.2 mm", ByMeaning),
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
    (&[r#"matrix={"ft": 3}"#], "$.matrix.E", "is missing", ByMeaning),
    (&[r#"matrix={"E": 3e4}"#], "$.matrix.ft", "is missing", ByMeaning),
    (&["matrix.concrete=B40"], "$.matrix.concrete", "is no class", ByMeaning),
    (&["matrix.concrete=C200"], "$.matrix.concrete", "from C12 to C120", ByMeaning),
    (&["matrix.concrete=9"], "$.matrix.concrete", "from 20 to 128 MPa", ByMeaning),
    (&["matrix.concrete=-40"], "$.matrix.concrete", "must be > 0", BySchema),
    (&["matrix.concrete=[40]"], "$.matrix.concrete", "expected", BySchema),
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
    (&[COUNTED, "orientation.counts=[1]"], "$.orientation.file", "together with edges_deg or counts", ByMeaning),
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
    (&[TABLE, "fibre.file=pushed.csv"], "$.fibre.file", "the load -5 N pushes the fibre in", ByMeaning),
    (&[LAW], "$.fibre.law[1]", "must have a greater slip", ByMeaning),
    (&[RUNS, "fibre.base=case.json"], "$.fibre.base", "is no case of kind \"pullout\"", ByMeaning),
    (&[RUNS, "fibre.base=nowhere.json"], "$.fibre.base", "cannot be read", ByMeaning),
    (&[RUNS, "fibre.diameter=0.5"], "$.fibre.base", "has a fibre of 0.406 mm, this one is 0.5 mm thick", ByMeaning),
    (&[RUNS, "fibre.set={\"steps.0.slip\": \"far\"}"], "$.fibre.set[\"steps.0.slip\"]", "$.steps[0].slip", ByMeaning),
    (&[RUNS, "fibre.length_key=mesh.specimen.lenght"], "$.fibre.length_key", "unknown key", ByMeaning),
    (
        &[RUNS, "fibre.length_key=mesh.specimen.free_length"],
        "$.fibre.length_key",
        "is not the embedded length",
        ByMeaning,
    ),
    (&[RUNS, "fibre.angle_key=mesh.specimen.angle"], "$.fibre.angle_key", "unknown key", ByMeaning),
    (
        &[RUNS, "fibre.angle_key=steps.0.slip", "fibre.angles_deg=[1, 30]"],
        "$.fibre.angle_key",
        "from 1 to 30 turns the fibre by 0°",
        ByMeaning,
    ),
    (
        &[TABLE, "fibre.file=to-60.csv", r#"fibre.inclination={"type": "exp", "f": 0.3}"#],
        "$.fibre.inclination",
        "goes with curves at 0° alone",
        ByMeaning,
    ),
    (&[TABLE, "fibre.scale=0"], "$.fibre.scale", "must be > 0", BySchema),
    (&[HOOK, "fibre.hook.radius=0"], "$.fibre.hook.radius", "at least half of the", ByMeaning),
    (&[HOOK, "fibre.hook.friction=-1"], "$.fibre.hook.friction", "must not be below 0", ByMeaning),
    (&[HOOK, "fibre.hook.lengths=[]"], "$.fibre.hook.lengths", "one for each bend", ByMeaning),
    (&[HOOK, "fibre.hook.yield_stress=null"], "$.fibre.hook.yield_stress", "no strength", ByMeaning),
    (&[HOOK, "fibre.hook.mu=1"], "$.fibre.hook.mu", "unknown key", BySchema),
    (&[RUNS, "fibre.angles_deg=[0, 45, 30]"], "$.fibre.angles_deg", "must rise", ByMeaning),
    (&[RUNS, "fibre.angles_deg=[0, 89]"], "$.fibre.angles_deg", "no length reaches 2 diameters deep", ByMeaning),
    (&[RUNS, "fibre.lengths=[0.5]"], "$.fibre.lengths", "from above 0 to 1", ByMeaning),
    (
        &[LAW, r#"fibre.law={"plugin": "bond_slip", "props": {"k_x": 1}}"#],
        "$.fibre.law.props.k_x",
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
fn one_mistake_is_reported_once() {
    let bench = Bench::new();
    for (overrides, place, ..) in MALFORMED {
        let errors = bench.read(&case(), overrides).expect_err("malformed");
        assert_eq!(errors.problems.len(), 1, "{place}:\n{errors}");
    }
}

#[test]
fn mistakes_in_several_parts_are_reported_at_once() {
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

/// A fibre with a path has its angle and its length under other keys than a straight one.
#[test]
fn runs_of_a_hooked_fibre_turn_its_path() {
    let bench = Bench::new();
    let mut base = Bench::base();
    base["mesh"]["specimen"] = json!({
        "type": "fibres", "width": 40, "depth": 50, "matrix_thickness": 10, "mesh_size": 2,
        "fibres": [{ "name": "hook", "diameter": 0.9, "exit": 0, "embedded": 30,
                     "path": { "type": "hooked", "hook": [2.1, 2.95], "radius": 2 } }]
    });
    std::fs::write(bench.0.path().join("fibre.json"), base.to_string()).expect("a case");
    let fibre = r#"fibre={"diameter": 0.9, "length": 60, "E": 2e5, "model": "fe", "base": "fibre.json", "angles_deg": [0, 20],
        "lengths": [0.5, 1]}"#;
    let Ok(Case::Bridging(program)) = bench.read(&case(), &[fibre]) else { panic!("a case") };
    let LoadSource::Simulated(simulations) = &program.source else { panic!("runs") };
    let last = &simulations.runs[simulations.runs.len() - 1].overrides;
    assert_eq!(last[..], ["mesh.specimen.fibres.0.rotate_deg=20", "mesh.specimen.fibres.0.embedded=30"]);
}

/// Tests at 0° with an angle's effect in addition, and a factor: twice the loads are twice the stress.
#[test]
fn curves_at_right_angles_take_an_inclination() {
    let bench = Bench::new();
    let zero = "theta_deg,embedded,slip,load\n0,15,0.1,10\n0,15,5,5\n";
    std::fs::write(bench.0.path().join("zero.csv"), zero).expect("a table");
    let stress = |more: &[&str]| {
        let all = [&[TABLE, "fibre.file=zero.csv"], more].concat();
        let Ok(Case::Bridging(program)) = bench.read(&case(), &all) else { panic!("a case") };
        let messages = program.assumptions(&[]).expect("curves");
        assert_eq!(
            messages.iter().any(|message| message.contains("largest angle")),
            more[0].contains("cut_deg"),
            "{messages:?}"
        );
        program.composite(&[]).expect("a composite").average(1.0).stress
    };
    let plain = stress(&["fibre.cut_deg=90"]);
    let snubbed = stress(&[r#"fibre.inclination={"type": "exp", "f": 0.5}"#]);
    // g of f = 0.5 over that of 0, the closed form of random fibres
    assert!((snubbed / plain / 1.502720023876713 - 1.0).abs() < 1e-3, "{snubbed} {plain}");
    let twice = stress(&[r#"fibre.inclination={"type": "exp", "f": 0.5}"#, "fibre.scale=2"]);
    assert!((twice / snubbed - 2.0).abs() < 1e-9, "{twice}");
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
    let LoadSource::Bond(Bond::ShearLag(bond), _) = &program.source else { panic!("a bond law") };
    let points = &bond.law.points;
    assert!(points[0] == [0.0, 0.0] && (points.last().expect("points")[0] - 15.0).abs() < 1e-9);
    for [slip, traction] in points {
        let exact = if *slip <= 0.004 { 400.0 * slip } else { 1.6 - (slip.min(1.0) - 0.004) / 0.996 };
        assert!((traction - exact).abs() < 1e-9, "{slip}: {traction} for {exact}");
    }
}

/// A bond with a corner in the first interval of slips, one that falls at once, and several in a row.
#[test]
fn a_law_of_contact_keeps_its_corners() {
    for corners in [
        vec![[1e-6, 2.0], [100.0, 2.0]],
        vec![[0.02, 3.0], [3.0, 3.0], [3.001, 0.5], [100.0, 0.5]],
        vec![[0.01, 5.0], [0.1, 6.0], [1.0, 2.0], [1.37, 2.0], [1.3701, 0.7], [100.0, 0.7]],
    ] {
        let program = of_law(&corners);
        let LoadSource::Bond(Bond::ShearLag(bond), _) = &program.source else { panic!("a bond law") };
        let found = Polyline::new(bond.law.points.iter().map(|point| (point[0], point[1])));
        let exact = Polyline::new([(0.0, 0.0)].into_iter().chain(corners.iter().map(|corner| (corner[0], corner[1]))));
        let greatest = corners.iter().map(|corner| corner[1]).fold(0.0, f64::max);
        let everywhere = (0..=20_000).map(|k| 1e-8 * (15e8_f64).powf(f64::from(k) / 20_000.0));
        let beside = corners.iter().flat_map(|corner| [0.99, 0.9999, 1.0, 1.0001, 1.01].map(|part| part * corner[0]));
        for slip in everywhere.chain(beside).filter(|slip| *slip < 15.0) {
            let off = (found.at(slip) - exact.at(slip)).abs();
            assert!(off < 1e-3 * greatest, "{corners:?} at {slip}: off by {off}");
        }
        assert!(bond.law.points.len() < 1000, "{}", bond.law.points.len());
    }
}

/// The slope at slip 0 is found however small the traction of the corner is compared with the greatest.
#[test]
fn a_law_of_contact_begins_with_its_stiffness() {
    let program = of_law(&[[1e-5, 1e-4], [1.0, 5.0], [100.0, 5.0]]);
    let LoadSource::Bond(Bond::ShearLag(bond), _) = &program.source else { panic!("a bond law") };
    let [slip, traction] = bond.law.points[1];
    assert!((traction / slip / 10.0 - 1.0).abs() < 0.02, "{}", traction / slip);
}

/// σ = V_f/A_f (2/L_f) g π d τ(w) (L_f/2 − w)²/2 of stiff fibres, g = 1/2 without snubbing, near a corner of τ.
#[test]
fn stiff_fibres_follow_the_corners_of_their_law() {
    let program = of_law(&[[0.02, 3.0], [3.0, 3.0], [3.001, 0.5], [100.0, 0.5]]);
    let composite = program.composite(&[]).expect("a composite");
    for (opening, traction) in [(1.0, 3.0), (2.9, 3.0), (2.999, 3.0), (3.002, 0.5), (3.1, 0.5), (10.0, 0.5)] {
        let closed =
            0.01 / (0.25 * PI * 0.25) * (2.0 / 30.0) * 0.5 * PI * 0.5 * traction * (15.0_f64 - opening).powi(2) / 2.0;
        let found = composite.average(opening).stress;
        assert!((found / closed - 1.0).abs() < 1e-3, "{opening}: {found} for {closed}");
    }
}

/// Stiff fibres in a bond of straight lines without snubbing, pulled out of one side.
fn of_law(corners: &[[f64; 2]]) -> BridgingProgram {
    let law = json!({ "plugin": "bond_slip", "props": { "law": "A", "form": "piecewise", "normal_law": "hard", "p_0": 1000,
        "delta_N": 0.004, "k_e": corners[0][1] / corners[0][0], "tau_res": 0, "k_u": 0, "mu": 0, "points": corners } });
    let law = format!("fibre.law={law}");
    let overrides = [LAW, &law, "fibre.E=1e13", r#"fibre.inclination={"type": "exp", "f": 0}"#, "sides=one"];
    match Bench::new().read(&case(), &overrides) {
        Ok(Case::Bridging(program)) => *program,
        Ok(_) => panic!("a case of bridging"),
        Err(errors) => panic!("{corners:?}: {errors}"),
    }
}

fn results(overrides: &[&str]) -> Result<BridgingResults, String> {
    let Ok(Case::Bridging(program)) = Bench::new().read(&case(), overrides) else { panic!("a case") };
    run(&program, &program.composite(&[]).expect("a composite"), std::num::NonZeroUsize::MIN)
}

/// How far and how closely σ is given is no matter of the strengths.
#[test]
fn strengths_do_not_depend_on_the_openings_that_are_given() {
    let drawn = [r#"matrix={"E": 32000, "ft": 2.9, "softening": "hordijk", "Gf": 0.14}"#, r#"scatter={"beams": 20}"#];
    let strengths = |openings: &str| {
        let results = results(&[drawn[0], drawn[1], openings]).expect("results");
        let beam = results.findings.beam.expect("a beam");
        let scatter = results.findings.scatter.expect("beams");
        let code = beam.model_code_2010;
        let of_code = [code.rigid_plastic, code.serviceability, code.ultimate].into_iter().chain(code.sigma);
        let drawn = [scatter.limit.mean, scatter.residual[0].mean, scatter.residual[3].characteristic];
        let all = [beam.limit].into_iter().chain(beam.residual).chain(of_code).chain(drawn).collect::<Vec<f64>>();
        (all, results.rows.iter().map(|row| row.fibres.opening).collect::<Vec<f64>>())
    };
    let (usual, _) = strengths("openings={}");
    for (openings, count, last) in [
        (r#"openings={"to": 0.05, "points": 20}"#, 20, 0.05),
        (r#"openings={"to": 0.5}"#, 200, 0.5),
        (r#"openings={"to": 15, "points": 5, "spacing": "even"}"#, 5, 15.0),
        (r#"openings={"to": 4, "points": 1000}"#, 1000, 4.0),
    ] {
        let (found, given) = strengths(openings);
        assert_eq!((given.len(), given[0], *given.last().expect("openings")), (count, 0.0, last));
        for (found, usual) in found.iter().zip(&usual) {
            assert!((found / usual - 1.0).abs() < 2e-3, "{openings}: {found} for {usual}");
        }
    }
}

/// e^(1000 θ) is more than a number can hold.
#[test]
fn a_stress_that_is_no_number_fails_the_run() {
    let message = results(&[r#"fibre.inclination={"type": "exp", "f": 1000}"#]).expect_err("no results");
    assert!(message.contains("σ of the fibres at w = 0"), "{message}");
}

#[test]
fn numbers_that_are_hardly_meant_are_warned_of() {
    let bench = Bench::new();
    let warnings = |overrides: &[&str]| {
        let Ok(Case::Bridging(program)) = bench.read(&case(), overrides) else { panic!("a case") };
        program.about.warnings
    };
    assert_eq!(warnings(&[]), Vec::<String>::new());
    for (entry, what) in [
        ("fibre.E=200", "fibre.E = 200 MPa is outside the usual range, 1000 to 1·10⁶ MPa"),
        ("fibre.strength=1.2", "fibre.strength = 1.2 MPa"),
        ("fibre.diameter=0.001", "fibre.diameter = 0.001 mm"),
        ("fibre.length=300", "fibre.length = 300 mm"),
        ("fibre.tau=3e6", "fibre.tau = "),
        (
            r#"fibre.hook={"lengths": [2.1, 2.9], "angle_deg": 45, "radius": 1, "friction": 0.2, "yield_stress": 1.16}"#,
            "fibre.hook.yield_stress = 1.16 MPa",
        ),
        ("matrix.E=30", "matrix.E = 30 MPa"),
        ("matrix.ft=3e6", "matrix.ft = "),
        ("matrix.Gf=140", "matrix.Gf = 140 N/mm"),
        ("matrix.fc=40e6", "matrix.fc = "),
        (
            r#"beam={"span": 0.5, "height": 0.15, "width": 0.15, "notch": 0.025}"#,
            "beam.height = 0.15 mm is outside the usual range, 10 to 3000 mm",
        ),
    ] {
        let messages = warnings(&[entry]);
        let [warning] = &messages[..] else { panic!("{entry}: {messages:?}") };
        assert!(warning.starts_with(what) && warning.ends_with("is it in units of N, mm, MPa?"), "{warning}");
    }
    assert_eq!(
        warnings(&["matrix.ft=4.2", "matrix.fc=3.2"]),
        ["matrix.ft = 4.2 MPa is greater than matrix.fc = 3.2 MPa: are they interchanged?"]
    );
    assert_eq!(
        warnings(&[r#"fibre.inclination={"type": "exp", "f": 20}"#]),
        ["fibre.inclination.f = 20 is outside the usual range, 0 to 2, of this number without a unit"]
    );
}

/// Numbers that nothing asks for.
#[test]
fn numbers_without_effect_are_reported() {
    for (overrides, what) in [
        (&["fibre.rupture_f=0.3"][..], "$.fibre.rupture_f"),
        (&[r#"scatter={"strength_cv": 0.1}"#], "$.scatter.strength_cv"),
        (&["matrix.fc=40", "beam=null"], "$.matrix.fc"),
        (&[r#"matrix={"E": 30000, "ft": 3, "Gf": 140}"#], "$.matrix.Gf"),
    ] {
        let warnings = |overrides: &[&str]| {
            let Ok(Case::Bridging(program)) = Bench::new().read(&case(), overrides) else { panic!("a case") };
            program.about.warnings
        };
        let messages = warnings(overrides);
        assert!(messages.len() == 1 && messages[0].starts_with(&format!("{what}: has no effect")), "{messages:?}");
        let used = [overrides, &["fibre.strength=1000", "beam={}"]].concat();
        let used = if what.ends_with("Gf") { vec![r#"matrix={"E": 30000, "ft": 3}"#] } else { used };
        assert_eq!(warnings(&used), Vec::<String>::new(), "{used:?}");
    }
}

/// Random fibres whose curves end at 60° and at a slip of 2 mm: both is said, with what is assumed.
#[test]
fn what_curves_do_not_determine_is_reported() {
    let assumed = |entry: &str| {
        let Ok(Case::Bridging(program)) = Bench::new().read(&case(), &[TABLE, "fibre.file=to-60.csv", entry]) else {
            panic!("a case")
        };
        program.assumptions(&[]).expect("curves")
    };
    let messages = assumed("openings={\"to\": 1}");
    let [first, beyond] = &messages[..] else { panic!("{messages:?}") };
    assert!(first.starts_with("fibre at 0°, 15 mm (and 1 more): its curve ends at a slip of 2 mm with 5 N"), "{first}");
    // the beam opens the crack by more than 2 mm; without it 1 mm is all
    let messages = assumed("beam=null");
    assert_eq!(messages.len(), 2);
    // sin² 80° − sin² 60° over sin² 80° of equal loads
    let share = 1.0 - 0.75 / 80.0_f64.to_radians().sin().powi(2);
    let of_all = format!("carry up to {:.0} %", 100.0 * share);
    assert!(beyond.contains("at more than 60°") && beyond.contains(&of_all), "{beyond} {of_all}");
    assert!(assumed("fibre.cut_deg=60").iter().all(|message| !message.contains("largest angle")));
}

/// f_t = 0.3 · 40^(2/3), E = 21500 · 4.8^(1/3), G_f = 0.073 · 48^0.18.
#[test]
fn the_matrix_may_be_the_class_of_a_concrete() {
    let matrix = |overrides: &[&str]| match Bench::new().read(&case(), overrides) {
        Ok(Case::Bridging(program)) => (program.matrix, program.about.notes.join("\n")),
        other => panic!("{other:?}"),
    };
    let (of_class, notes) = matrix(&[r#"matrix={"concrete": "C40/50"}"#]);
    let found = [of_class.ft, of_class.modulus, of_class.fracture_energy];
    for (found, expected) in found.into_iter().zip([3.508_82, 36_267.6, 0.146_536_7]) {
        assert!((found / expected - 1.0).abs() < 1e-5, "{of_class:?}");
    }
    assert_eq!(of_class.softening, pullout_bridging::Softening::Bilinear);
    assert!(notes.contains("f_c = 48 MPa"), "{notes}");
    let own = r#"matrix={"concrete": 48, "ft": 2, "softening": "hordijk", "fc": 44}"#;
    let (own, _) = matrix(&[own, "beam={}"]);
    assert_eq!((own.ft, own.fc, own.modulus), (2.0, Some(44.0), of_class.modulus));
    assert_eq!(own.softening, pullout_bridging::Softening::Hordijk);
}

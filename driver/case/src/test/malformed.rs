use super::{Bench, interface_case, overridden, plain_library, point_case, schema_accepts};
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Overrides that spoil a case, the place and a part of the message that must follow, and whether the schema alone
/// sees it.
pub(super) type Sample = (&'static [&'static str], &'static str, &'static str, Seen);

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Seen {
    BySchema,
    ByMeaning,
}
use Seen::{ByMeaning, BySchema};

const POINT: &[Sample] = &[
    // structure
    (&["kind=punkt"], "$.kind", "no kind of case is called 'punkt'", BySchema),
    (&["kind=7"], "$.kind", "expected one of point, interface, pullout, bridging, found 7", BySchema),
    (&["tilte=x"], "$.tilte", "unknown key; nearest valid name: 'title'", BySchema),
    (&["title=5"], "$.title", "expected a text, found 5", BySchema),
    (&["mode=plane-stress"], "$.mode", "nearest valid name: 'plane_stress'", BySchema),
    (&["mode=2"], "$.mode", "expected \"3d\"", BySchema),
    (&["material=null"], "$.material", "expected an object, found null", BySchema),
    (&["material={}"], "$.material.plugin", "is missing", BySchema),
    (&["material.plugn=x"], "$.material.plugn", "unknown key; nearest valid name: 'plugin'", BySchema),
    (&["mode=3d", "material.as=plane"], "$.material.as", "mode 3d has all six components", ByMeaning),
    (&["material.props.E=true"], "$.material.props.E", "expected a number, a text or an array, found true", BySchema),
    (&["material.props=5"], "$.material.props", "expected an object or an array, found 5", BySchema),
    (&["material.nstatv=-1"], "$.material.nstatv", "must be >= 0, found -1", BySchema),
    (&["material.nstatv=2.5"], "$.material.nstatv", "expected a whole number, found 2.5", BySchema),
    (&["material.entry=vumat"], "$.material.entry", "nearest valid name: 'umat'", BySchema),
    (&["material.call_time_limit_s=0"], "$.material.call_time_limit_s", "must be > 0", BySchema),
    (&["material.isolate=1"], "$.material.isolate", "expected true or false, found 1", BySchema),
    (&["steps=[]"], "$.steps", "needs at least 1 entry, found 0", BySchema),
    (&["steps={}"], "$.steps", "expected an array, found {}", BySchema),
    (&["steps.0=5"], "$.steps[0]", "expected an object, found 5", BySchema),
    (&["steps.0.increments=0"], "$.steps[0].increments", "must be >= 1, found 0", BySchema),
    (&["steps.0.increments=1e12"], "$.steps[0].increments", "must be <= 100000000", BySchema),
    (&["steps.0.increments=2.5"], "$.steps[0].increments", "expected a whole number, found 2.5", BySchema),
    (&["steps.0.increments=ten"], "$.steps[0].increments", "expected a whole number, found \"ten\"", BySchema),
    (&["steps.0.incremnts=5"], "$.steps[0].incremnts", "nearest valid name: 'increments'", BySchema),
    (&["steps.0={\"target\": {\"e11\": 1}}"], "$.steps[0].increments", "is missing", BySchema),
    (&["steps.0={}"], "$.steps[0].increments", "is missing", BySchema),
    (&["steps.0={\"table\": 5}"], "$.steps[0].table", "expected a text or an object, found 5", BySchema),
    (&["steps.0={\"repeat\": 5}"], "$.steps[0].steps", "is missing", BySchema),
    (&["steps.0={\"cycles\": {\"repeat\": 5}}"], "$.steps[0].cycles.steps", "is missing", BySchema),
    (&["steps.0.time=0"], "$.steps[0].time", "must be > 0, found 0", BySchema),
    (&["steps.0.target.e12=1"], "$.steps[0].target.e12", "unknown key; nearest valid name: 'g12'", BySchema),
    (&["steps.0.target.e11=keep"], "$.steps[0].target.e11", "expected a number or \"hold\", found \"keep\"", BySchema),
    (&["steps.0.target.F=[[1,0],[0,1]]"], "$.steps[0].target.F", "needs at least 3 entries, found 2", BySchema),
    (&["steps.0={\"tabel\": \"path.csv\"}"], "$.steps[0].tabel", "nearest valid name: 'table'", BySchema),
    (&["steps.0={\"table\": \"path.csv\", \"increments\": 3}"], "$.steps[0].increments", "unknown key", BySchema),
    (&["steps.0={\"repeat\": 0, \"steps\": [{\"increments\": 1}]}"], "$.steps[0].repeat", "must be >= 1", BySchema),
    (
        &["steps.0={\"repeat\": 2, \"steps\": [{\"increments\": \"x\"}]}"],
        "$.steps[0].steps[0].increments",
        "expected a whole number",
        BySchema,
    ),
    (
        &["steps.0.constraints=[{\"s12\": 1, \"equal\": 0}]"],
        "$.steps[0].constraints[0].equal",
        "nearest valid name: 'equals'",
        BySchema,
    ),
    (&["steps.0.until={\"quantity\": \"s11\", \"above\": 1}"], "$.steps[0].until.above", "unknown key", BySchema),
    (&["until={\"greater_than\": 1}"], "$.until.quantity", "is missing", BySchema),
    (&["arguments={\"noel\": 2147483648}"], "$.arguments.noel", "from -2147483648 to 2147483647", ByMeaning),
    (&["arguments={\"noel\": 5.0}"], "$.arguments.noel", "without a decimal point, found 5.0", ByMeaning),
    (&["until=5"], "$.until", "expected an object, found 5", BySchema),
    (&["characteristic_length=-3"], "$.characteristic_length", "must be > 0, found -3", BySchema),
    (&["controls={\"max_cutbacks\": 100}"], "$.controls.max_cutbacks", "must be <= 60", BySchema),
    (
        &["controls={\"max_iteration\": 3}"],
        "$.controls.max_iteration",
        "nearest valid name: 'max_iterations'",
        BySchema,
    ),
    (&["output={\"every\": 0}"], "$.output.every", "must be >= 1", BySchema),
    (&["initial={\"strains\": [0]}"], "$.initial.strains", "nearest valid name: 'strain'", BySchema),
    (&["initial={\"time\": -1}"], "$.initial.time", "must be >= 0", BySchema),
    (&["compare=[{\"file\": \"curve.csv\"}]"], "$.compare[0].file_x", "is missing", BySchema),
    // overrides
    (&["increments"], "--set increments", "no '='", ByMeaning),
    (&["a..b=1"], "--set a..b=1", "an empty name in the path", ByMeaning),
    (&["steps.7.increments=1"], "--set steps.7.increments=1", "'7' is no index of it", ByMeaning),
    (&["mode.x=1"], "--set mode.x=1", "$.mode is neither an object nor an array", ByMeaning),
    // plugin and parameters
    (
        &["material.props.e=1"],
        "$.material.props.e",
        "linear_elastic has no parameter 'e'; nearest valid name: 'E'",
        ByMeaning,
    ),
    (&["material.props.E=-1"], "$.material.props.E", "E = -1 is not admissible: it must be > 0 MPa", ByMeaning),
    (&["material.props.nu=0.5"], "$.material.props.nu", "must be in (-1, 0.5)", ByMeaning),
    (&["material.props.nu=low"], "$.material.props.nu", "expected a number, found the text 'low'", ByMeaning),
    (&["material.props=[1]"], "$.material.props", "1 values given, linear_elastic takes 2: E, nu", ByMeaning),
    (&["material.props=[1, 0.7]"], "$.material.props[1]", "nu = 0.7", ByMeaning),
    (&["material.nstatv=1"], "$.material.nstatv", "linear_elastic needs 2 state variables, 1 given", ByMeaning),
    (&["material.entry=uinter"], "$.material.entry", "use kind \"interface\"", ByMeaning),
    (
        &["material.statev0=[1]"],
        "$.material.statev0",
        "1 values given, linear_elastic has 2 state variables",
        ByMeaning,
    ),
    (&["initial.statev=[1, 2, 3]"], "$.initial.statev", "3 values given", ByMeaning),
    (&["material.statev0=[1, 2]", "initial.statev=[1, 2]"], "$.initial.statev", "given twice", ByMeaning),
    // components and modes
    (
        &["steps.0.target.s11=1"],
        "$.steps[0].target.s11",
        "the same component is given as 'e11' and as 's11'",
        ByMeaning,
    ),
    (&["mode=plane_strain", "steps.0.target.e33=0"], "$.steps[0].target.e33", "fixes e33 = g13 = g23 = 0", ByMeaning),
    (&["mode=plane_stress", "steps.0.target.s33=0"], "$.steps[0].target.s33", "fixes s33 = s13 = s23 = 0", ByMeaning),
    (&["mode=axisymmetric", "steps.0.target.g13=0"], "$.steps[0].target.g13", "fixes g13 = g23 = 0", ByMeaning),
    (&["initial.strain=[1, 2]"], "$.initial.strain", "2 values given, 6 needed", ByMeaning),
    (&["initial.stress={\"e11\": 1}"], "$.initial.stress.e11", "unknown key; nearest valid name: 's11'", ByMeaning),
    (
        &["mode=plane_strain", "initial.strain=[0,0,1,0,0,0]"],
        "$.initial.strain",
        "e33 must be 0 in mode plane_strain",
        ByMeaning,
    ),
    (
        &["mode=plane_stress", "initial.stress={\"s33\": 1}"],
        "$.initial.stress",
        "s33 must be 0 in mode plane_stress",
        ByMeaning,
    ),
    // deformation gradients
    (
        &["steps.0.F=[[1,0,0],[0,1,0],[0,0,1]]", "steps.0.target={}"],
        "$.steps[0].F",
        "needs \"nlgeom\": true",
        ByMeaning,
    ),
    (&["nlgeom=true", "steps.0.F=[[1,0,0],[0,1,0],[0,0,1]]"], "$.steps[0].F", "F determines all strains", ByMeaning),
    (
        &["nlgeom=true", "steps.0.target={}", "steps.0.F=[[1,0,0],[0,1,0],[0,0,-1]]"],
        "$.steps[0].F",
        "determinant must be > 0",
        ByMeaning,
    ),
    (
        &["nlgeom=true", "mode=plane_strain", "steps.0.target={}", "steps.0.F=[[1,0,0.1],[0,1,0],[0,0,1]]"],
        "$.steps[0].F",
        "needs F13 = F23 = F31 = F32 = 0",
        ByMeaning,
    ),
    (
        &["nlgeom=true", "mode=plane_strain", "steps.0.target={}", "steps.0.F=[[1,0,0],[0,1,0],[0,0,2]]"],
        "$.steps[0].F",
        "needs F33 = 1",
        ByMeaning,
    ),
    (&["initial.F=[[2,0,0],[0,1,0],[0,0,1]]"], "$.initial.F", "needs \"nlgeom\": true", ByMeaning),
    (&["nlgeom=true", "initial.F=[[1,0.2,0],[0,1,0],[0,0,1]]"], "$.steps[0]", "the material has turned", ByMeaning),
    (
        &["nlgeom=true", "arguments={\"dfgrd0\": [[1,0,0],[0,1,0],[0,0,1]]}"],
        "$.arguments",
        "belong to cases without nlgeom",
        ByMeaning,
    ),
    // measures
    (&["measure=nominal"], "$.measure", "needs \"nlgeom\": true", ByMeaning),
    (
        &["nlgeom=true", "measure=nominal", "steps.0.target={\"e11\": -1}"],
        "$.steps[0].target.e11",
        "must be > -1",
        ByMeaning,
    ),
    // constraints
    (&["steps.0.constraints=[{\"equals\": 1}]"], "$.steps[0].constraints[0]", "no coefficient other than 0", ByMeaning),
    (
        &["steps.0.constraints=[{\"s11\": 1, \"equals\": 1}]"],
        "$.steps[0].constraints[0]",
        "no stress-free component of its own",
        ByMeaning,
    ),
    (
        &["steps.0.constraints=[{\"s22\": 1, \"s33\": 1}, {\"s22\": 2, \"s33\": 2}]"],
        "$.steps[0].constraints[1]",
        "the constraints are singular",
        ByMeaning,
    ),
    (
        &["steps.0.constraints=[{\"s22\": 1, \"s11\": -0.5}, {\"s22\": 1, \"s11\": -0.6}]"],
        "$.steps[0].constraints[1]",
        "no stress-free component of its own",
        ByMeaning,
    ),
    (
        &["mode=plane_stress", "steps.0.constraints=[{\"s33\": 1, \"s22\": 1}]"],
        "$.steps[0].constraints[0].s33",
        "mode plane_stress fixes",
        ByMeaning,
    ),
    // files
    (
        &["steps.0={\"table\": \"nowhere.csv\"}"],
        "$.steps[0].table",
        "nowhere.csv cannot be read: No such file",
        ByMeaning,
    ),
    (&["steps.0={\"table\": \".\"}"], "$.steps[0].table", "is a folder", ByMeaning),
    (
        &["steps.0={\"table\": \"unknown_column.csv\"}"],
        "$.steps[0].table",
        "no component is called 'e12'; nearest valid name: 'g12'",
        ByMeaning,
    ),
    (&["steps.0={\"table\": \"twice.csv\"}"], "$.steps[0].table", "the column 'e11' is there twice", ByMeaning),
    (&["steps.0={\"table\": \"both.csv\"}"], "$.steps[0].table", "given as 'e11' and as 's11'", ByMeaning),
    (
        &["steps.0={\"table\": \"text.csv\"}"],
        "$.steps[0].table",
        "text.csv, line 2, column 'e11': 'abc' is not a finite number",
        ByMeaning,
    ),
    (
        &["steps.0={\"table\": \"text.csv\"}"],
        "$.steps[0].table",
        "line 3, column 'e11': 'nan' is not a finite number",
        ByMeaning,
    ),
    (&["steps.0={\"table\": \"backwards.csv\"}"], "$.steps[0].table", "line 3: the time 1 is not greater", ByMeaning),
    (&["steps.0={\"table\": \"negative.csv\"}"], "$.steps[0].table", "line 2: the time -1 is negative", ByMeaning),
    (&["steps.0={\"table\": \"ragged.csv\"}"], "$.steps[0].table", "line 2: 3 fields, but the header has 2", ByMeaning),
    (&["steps.0={\"table\": \"only_time.csv\"}"], "$.steps[0].table", "no column names a component", ByMeaning),
    (&["steps.0={\"table\": \"no_rows.csv\"}"], "$.steps[0].table", "has no rows", ByMeaning),
    (&["steps.0={\"table\": \"empty.csv\"}"], "$.steps[0].table", "is empty", ByMeaning),
    (&["mode=plane_strain", "steps.0={\"table\": \"fixed.csv\"}"], "$.steps[0].table", "leave 'e33' out", ByMeaning),
    (
        &["compare=[{\"file\": \"no.csv\", \"file_x\": \"a\", \"file_y\": \"b\", \"x\": \"e11\", \"y\": \"s11\"}]"],
        "$.compare[0].file",
        "cannot be read",
        ByMeaning,
    ),
    (
        &[
            "compare=[{\"file\": \"curve.csv\", \"file_x\": \"strian\", \"file_y\": \"stress_MPa\", \"x\": \"e11\", \"y\": \"s11\"}]",
        ],
        "$.compare[0].file_x",
        "nearest valid name: 'strain'",
        ByMeaning,
    ),
    (
        &[
            "compare=[{\"file\": \"curve.csv\", \"file_x\": \"strain\", \"file_y\": \"stress_MPa\", \"x\": \"e1\", \"y\": \"s11\"}]",
        ],
        "$.compare[0].x",
        "the history has no column 'e1'; nearest valid name: 'e11'",
        ByMeaning,
    ),
    // until, limits, field variables
    (
        &["until={\"quantity\": \"abs(damage)\", \"greater_than\": 1}"],
        "$.until.quantity",
        "no column 'damage'",
        ByMeaning,
    ),
    (&["until={\"quantity\": \"s11\"}"], "$.until", "needs \"greater_than\" or \"less_than\"", ByMeaning),
    (
        &["until={\"quantity\": \"s11\", \"greater_than\": 1, \"less_than\": 2}"],
        "$.until",
        "it would stop at once",
        ByMeaning,
    ),
    (&["until={\"quantity\": \"abs(s11)\", \"less_than\": -2}"], "$.until.less_than", "never less", ByMeaning),
    (
        &["steps.0.until={\"quantity\": \"S11\", \"greater_than\": 1}"],
        "$.steps[0].until.quantity",
        "nearest valid name: 's11'",
        ByMeaning,
    ),
    (&["steps.0.predef=[1]"], "$.steps[0].predef", "the case has 0 initial field variables", ByMeaning),
    (
        &["steps.0={\"repeat\": 1000000, \"steps\": [{\"repeat\": 1000000, \"steps\": [{\"increments\": 1}]}]}"],
        "$.steps[0].repeat",
        "at most 1000000 are possible",
        ByMeaning,
    ),
    (
        &["steps.0={\"repeat\": 3, \"steps\": [{\"increments\": 50000000}]}"],
        "$.steps[0].repeat",
        "makes 150000000 increments in all",
        ByMeaning,
    ),
];

const INTERFACE: &[Sample] = &[
    (&["steps.0.target.e11=1"], "$.steps[0].target.e11", "unknown key; valid names: slip, slip2, gap, p", BySchema),
    (&["mode=3d"], "$.mode", "unknown key", BySchema),
    (&["steps.0={\"increments\": 2}"], "$.steps[0].target", "is missing", BySchema),
    (&["steps.0.target.slip=stay"], "$.steps[0].target.slip", "expected a number or \"hold\"", BySchema),
    (&["initial.gap=wide"], "$.initial.gap", "expected a number", BySchema),
    (&["material.entry=umat"], "$.material.entry", "use kind \"point\" for umat", ByMeaning),
    (&["material.entry=fric", "steps.0.target.gap=0"], "$.steps[0].target.gap", "FRIC has no normal law", ByMeaning),
    (&["material.entry=fric", "initial.gap=0"], "$.initial.gap", "FRIC has no normal law", ByMeaning),
    (&["steps.0.target.gap=0", "steps.0.target.p=0"], "$.steps[0].target.p", "give one of them", ByMeaning),
    (&["steps.0={\"table\": \"path.csv\"}"], "$.steps[0].table", "no component is called 'e11'", ByMeaning),
    (
        &["until={\"quantity\": \"tau2\", \"greater_than\": 1}"],
        "$.until.quantity",
        "nearest valid name: 'tau'",
        ByMeaning,
    ),
    (&["material.props={\"a\": 1}"], "$.material.props", "give an array in PROPS order", ByMeaning),
];

/// Returns what is wrong with the answer to a sample; empty if nothing.
fn complaint(bench: &Bench, case: &Value, sample: &Sample) -> String {
    let (overrides, place, message, seen) = sample;
    let Err(errors) = bench.read(case, overrides) else { return format!("{overrides:?} was accepted\n") };
    let found = errors.problems.iter().any(|problem| {
        problem.place.as_ref().is_some_and(|p| p.as_str() == *place) && problem.message.contains(message)
    });
    let seen_by_schema = !schema_accepts(&overridden(case, overrides));
    if found && errors.exit_code() == 2 && seen_by_schema == (*seen == BySchema) {
        return String::new();
    }
    format!(
        "{overrides:?}: '{place}: …{message}…' found: {found}, exit code {}, refused by the printed schema: \
         {seen_by_schema}\n{errors}\n\n",
        errors.exit_code()
    )
}

pub(super) fn check(case: &Value, samples: &[Sample]) {
    let bench = Bench::new();
    let complaints: String = samples.iter().map(|sample| complaint(&bench, case, sample)).collect();
    assert!(complaints.is_empty(), "{complaints}");
}

#[test]
fn malformed_point_cases_are_explained() {
    check(&point_case(), POINT);
}

#[test]
fn malformed_interface_cases_are_explained() {
    check(&interface_case(), INTERFACE);
}

#[test]
fn nothing_is_said_twice() {
    let bench = Bench::new();
    for overrides in [
        &["until={\"quantity\": \"s11\", \"above\": 1}"][..],
        &["material.props.E=true"],
        &["steps.0.increments=ten"],
        &["steps.0={\"repeat\": 2, \"steps\": [{\"increments\": \"x\"}]}"],
        &["material={\"plugin\": 3}"],
    ] {
        let errors = bench.read(&point_case(), overrides).expect_err("malformed");
        assert_eq!(errors.problems.len(), 1, "{overrides:?}:\n{errors}");
    }
}

/// Exit code and text of a case that must fail.
fn failure(case: &Value, overrides: &[&str]) -> (u8, String) {
    let errors = Bench::new().read(case, overrides).expect_err("malformed");
    (errors.exit_code(), errors.to_string())
}

/// Not read as if its elements were the members.
#[test]
fn an_array_in_place_of_an_object_is_reported_once() {
    let mut case = super::specimen::pullout_case();
    case["mesh"] = json!([{ "s22": 1 }]);
    let errors = Bench::new().read(&case, &[]).expect_err("no mesh");
    let messages: Vec<String> = errors.problems.iter().map(ToString::to_string).collect();
    assert_eq!(messages, [r#"$.mesh: expected an object, found [{"s22":1}]"#]);
}

#[test]
fn a_plugin_that_cannot_be_loaded_is_exit_code_3() {
    let symbol = ["material.symbol=umat_of_mine"];
    for (overrides, message) in [
        (&["material.plugin=linear_elastik"][..], "nearest name there: 'linear_elastic'"),
        (&["material.plugin=zzz"], "no plugin 'zzz' was found; searched: "),
        (&["material.plugin=lib/nothing.so"], "lib/nothing.so"),
        (&["material.plugin=no_library.so"], "cannot be loaded"),
        (&symbol, "$.material.symbol: "),
        (&["material.symbol=system"], "$.material.symbol: 'system' is not the name of an entry point"),
    ] {
        let (code, text) = failure(&point_case(), overrides);
        assert!(code == 3 && text.contains(message), "{code}: {text}");
    }
    let mut case = interface_case();
    case["material"] = json!({ "plugin": plain_library(), "nstatv": 0 });
    let (code, text) = failure(&case, &[]);
    assert!(code == 3 && text.contains("has none of the symbols uinter_, uinter, UINTER, "), "{code}: {text}");
}

#[test]
fn a_missing_plugin_and_wrong_input_are_exit_code_2() {
    let (code, text) = failure(&point_case(), &["material.plugin=zzz", "steps.0.target.s11=1"]);
    assert_eq!((code, text.lines().count()), (2, 2), "{text}");
}

#[test]
fn a_law_of_a_solid_is_no_interface_law() {
    let mut case = interface_case();
    case["material"] = json!({ "plugin": "linear_elastic" });
    for (entry, name) in [("uinter", "UINTER"), ("fric", "FRIC")] {
        let (code, text) = failure(&case, &[&format!("material.entry={entry}")]);
        let expected = format!("$.material.plugin: linear_elastic has no {name}: it is a law of a material point");
        assert!(code == 2 && text.contains(&expected), "{code}: {text}");
    }
}

#[test]
fn a_plain_library_needs_nstatv_and_an_array() {
    let mut case = point_case();
    case["material"] = json!({ "plugin": plain_library(), "symbol": "umat_" });
    let (code, text) = failure(&case, &[]);
    assert!(code == 2 && text.contains("$.material.nstatv: is missing: the library describes no law"), "{text}");
}

/// First all that is wrong with the structure, then, of a document of the right structure, all that is wrong with what it means.
#[test]
fn all_problems_are_reported_at_once() {
    let mut case = json!({
        "kind": "point",
        "material": { "plugin": "linear_elastic", "props": { "E": -1, "mu": 0.2 }, "nstatv": 1, "colour": "red" },
        "mode": "plane_strain",
        "steps": [
            { "increments": 0, "target": { "e11": 1 } },
            { "increments": 5, "target": { "e33": 1, "e22": 0, "s22": 0, "e12": 0 } },
            { "repeat": 2, "steps": [ { "table": "nowhere.csv" }, { "increments": 1, "time": -1 } ] }
        ],
        "until": { "quantity": "x", "greater_than": 1 },
        "compare": [ { "file": "curve.csv", "file_x": "q", "file_y": "stress_MPa", "x": "e11", "y": "s11", "scale": 2 } ],
        "output": { "every": "all" },
        "unknown": 1
    });
    let check = |case: &Value, expected: &[&str]| {
        let errors = Bench::new().read(case, &["also wrong"]).expect_err("malformed");
        let places = errors.problems.iter().filter_map(|p| p.place.as_ref()).map(|p| p.as_str());
        assert_eq!(places.collect::<BTreeSet<_>>(), expected.iter().copied().collect(), "{errors}");
        let text = errors.to_string();
        assert_eq!(text.lines().count(), expected.len());
        assert!(text.lines().all(|line| line.contains("case.json: ")), "{text}");
    };
    check(
        &case,
        &[
            "--set also wrong",
            "$.unknown",
            "$.material.colour",
            "$.steps[0].increments",
            "$.steps[1].target.e12",
            "$.steps[2].steps[1].time",
            "$.compare[0].scale",
            "$.output.every",
        ],
    );
    let remove = |object: &mut Value, key: &str| object.as_object_mut().map(|members| members.remove(key));
    remove(&mut case, "unknown");
    remove(&mut case, "output");
    remove(&mut case["material"], "colour");
    remove(&mut case["compare"][0], "scale");
    remove(&mut case["steps"][1]["target"], "e12");
    case["steps"][0]["increments"] = json!(1);
    case["steps"][2]["steps"][1]["time"] = json!(1);
    check(
        &case,
        &[
            "--set also wrong",
            "$.material.props.E",
            "$.material.props.mu",
            "$.material.nstatv",
            "$.steps[1].target.e33",
            "$.steps[1].target.s22",
            "$.steps[2].steps[0].table",
            "$.until.quantity",
            "$.compare[0].file_x",
        ],
    );
}

#[test]
fn broken_json_says_line_and_column() {
    for (text, expected) in [
        (
            "{\n  \"kind\": \"point\",\n  \"mode\" \"3d\"\n}",
            "case.json: line 3, column 10: not valid JSON: expected `:`",
        ),
        ("", "line 1, column 0: not valid JSON: EOF"),
        ("{\"kind\": NaN}", "not valid JSON: expected value"),
        ("{\"temperature\": 1e999}", "number out of range"),
        ("{} {}", "trailing characters"),
        ("[1]", "$: expected an object, found [1]"),
        ("{}", "$.kind: is missing; valid names: point, interface, pullout, bridging"),
    ] {
        let errors = Bench::new().read_text(text, &[]).expect_err("malformed");
        assert!(errors.exit_code() == 2 && errors.to_string().contains(expected), "{errors}");
    }
}

#[test]
fn a_component_twice_in_the_text_is_an_error() {
    let text = point_case().to_string().replace("\"e11\":-0.001", "\"e11\":-0.001,\"e11\":-0.002");
    let errors = Bench::new().read_text(&text, &[]).expect_err("malformed");
    assert_eq!(errors.problems[0].to_string(), "$.steps[0].target.e11: the key is given twice; give it once");
}

#[test]
fn a_component_twice_in_an_override_is_an_error() {
    let errors =
        Bench::new().read(&point_case(), &[r#"material.props={"E": 5, "E": 7, "nu": 0}"#]).expect_err("malformed");
    assert!(errors.to_string().contains("in its value, $.E: the key is given twice; give it once"), "{errors}");
}

#[test]
fn a_missing_or_unreadable_case_file_is_an_error() {
    let bench = Bench::new();
    let errors = super::read(&bench.path(), &[], &[]).expect_err("no file");
    assert!(errors.exit_code() == 2 && errors.to_string().contains("the case file cannot be read: No such file"));
    std::fs::write(bench.path(), [0xff, 0xfe, 0x00]).expect("a file");
    let errors = super::read(&bench.path(), &[], &[]).expect_err("no text");
    assert!(errors.to_string().contains("UTF-8"), "{errors}");
}

#[test]
fn a_plugin_that_is_not_found_is_reported_with_what_to_do() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let nowhere = super::super::not_found("linear_elastic", &[folder.path().to_path_buf()]);
    for expected in ["--plugin-path", "PULLOUT_PLUGIN_PATH", "cargo xtask install", &folder.path().to_string_lossy()] {
        assert!(nowhere.contains(expected), "{nowhere}");
    }
    // where the laws are, it is another plugin that is missing
    let other = super::super::not_found("linear_elastik", &umat_abi::host::search_paths(&[]));
    assert!(other.contains("--plugin-path") && other.contains("'linear_elastic'"), "{other}");
    assert!(!other.contains("xtask"), "{other}");
}

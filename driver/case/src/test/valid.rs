use super::{Bench, interface_case, overridden, point_case, schema_accepts};
use pullout_run::program::{
    Constraint, Control, InterfaceEntry, InterfaceProgram, Mode, NormalControl, Pace, PathStep, PointDrive, PointKind,
    PointProgram, Program, Until,
};
use serde_json::json;

fn program(case: &serde_json::Value, overrides: &[&str]) -> Program {
    assert!(schema_accepts(&overridden(case, overrides)), "the schema refuses {overrides:?}");
    Bench::new().read_point(case, overrides).unwrap_or_else(|errors| panic!("{errors}"))
}

fn point(program: &Program) -> &PointProgram {
    match &program.kind {
        PointKind::Point(point) => point,
        PointKind::Interface(_) => panic!("a point case"),
    }
}

fn interface(program: &Program) -> &InterfaceProgram {
    match &program.kind {
        PointKind::Interface(interface) => interface,
        PointKind::Point(_) => panic!("an interface case"),
    }
}

fn controls(program: &Program, step: usize) -> [Control; 6] {
    match &point(program).steps[step].goal.drive {
        PointDrive::Components { controls, .. } => *controls,
        PointDrive::DeformationGradient(_) => panic!("no components"),
    }
}

const FREE: Control = Control::FREE;

#[test]
fn the_smallest_case_takes_the_defaults() {
    let program = program(&point_case(), &[]);
    let point = point(&program);
    assert_eq!((program.about.title.as_str(), program.about.description.as_str()), ("case", ""));
    assert_eq!((point.mode, point.nlgeom), (Mode::ThreeD, false));
    assert_eq!(program.plugin.props, [31800.0, 0.18]);
    assert_eq!((program.plugin.cmname.as_str(), program.plugin.nstatv), ("LINEAR_ELASTIC", 2));
    assert_eq!(point.initial.statev, None);
    assert_eq!((program.controls.max_iterations, program.controls.max_cutbacks), (25, 12));
    assert_eq!((program.about.every, program.about.plots), (1, true));
    assert_eq!(point.steps[0].pace, Pace::Equal { increments: 10, time: 1.0 });
    assert_eq!(controls(&program, 0), [Control::Strain(-0.001), FREE, FREE, FREE, FREE, FREE]);
    assert!(program.about.warnings.is_empty());
}

#[test]
fn the_contracts_example_is_read() {
    let case = json!({
        "kind": "point",
        "title": "Uniaxial compression (Karsan & Jirsa 1969)",
        "description": "text",
        "material": { "plugin": "linear_elastic", "props": { "E": 30000 } },
        "mode": "3d",
        "steps": [
            { "increments": 100, "time": 1.0,
              "target": { "e11": -0.005, "s22": 0, "s33": 0, "g12": 0, "g13": 0, "g23": 0 } },
            { "increments": 50, "target": { "s11": 0.0 } }
        ],
        "until": { "quantity": "abs(e11)", "greater_than": 0.01 },
        "compare": [ { "file": "curve.csv", "file_x": "strain", "file_y": "stress_MPa",
                       "x": "e11", "y": "s11", "scale_x": -1, "scale_y": -1 } ]
    });
    let program = program(&case, &[]);
    assert_eq!(program.plugin.props, [30000.0, 0.18]);
    assert_eq!(
        program.about.until,
        Some(Until { column: 3, absolute: true, greater_than: Some(0.01), less_than: None })
    );
    let curve = &program.about.compare[0];
    assert_eq!((curve.x, curve.y, curve.scale_x, curve.scale_y), (3, 9, -1.0, -1.0));
    assert_eq!(curve.points, [(0.0, 0.0), (1e-3, 10.0)], "the row with a blank is left out");
    assert_eq!(curve.label, "curve");
    let zero = Control::Strain(0.0);
    assert_eq!(controls(&program, 0), [Control::Strain(-0.005), FREE, FREE, zero, zero, zero]);
    assert_eq!(controls(&program, 1), [FREE; 6]);
}

#[test]
fn hold_keeps_strains_and_stresses() {
    let program = program(&point_case(), &["steps.0.target.e22=hold", "steps.0.target.s33=hold"]);
    let controls = controls(&program, 0);
    assert_eq!(controls[1..3], [Control::HoldStrain, Control::HoldStress]);
}

#[test]
fn modes_follow_their_names() {
    for (name, mode) in
        [("plane_strain", Mode::PlaneStrain), ("axisymmetric", Mode::Axisymmetric), ("plane_stress", Mode::PlaneStress)]
    {
        assert_eq!(point(&program(&point_case(), &[&format!("mode={name}")])).mode, mode);
    }
}

#[test]
fn tables_are_read() {
    let program = program(&point_case(), &[r#"steps.0={"table": "path.csv"}"#, r#"steps.1={"table": "untimed.csv"}"#]);
    let table = |step: usize| {
        let PathStep { pace: Pace::Rows(times), goal, .. } = &point(&program).steps[step] else { panic!("a table") };
        let PointDrive::Components { controls, rows } = &goal.drive else { panic!("components") };
        (times, controls, rows)
    };
    let (time_increments, controls, rows) = table(0);
    assert_eq!(controls[..3], [Control::Strain(0.0), Control::Stress(0.0), FREE]);
    assert_eq!(time_increments, &[0.5, 1.5]);
    assert_eq!(rows, &[[1e-4, 0.0, 0.0, 0.0, 0.0, 0.0], [2e-4, -1.5, 0.0, 0.0, 0.0, 0.0]]);
    let (time_increments, _, rows) = table(1);
    assert_eq!((time_increments.as_slice(), rows.len()), ([1.0, 1.0, 1.0].as_slice(), 3));
}

#[test]
fn a_table_from_time_zero_is_read_with_a_warning() {
    let program = program(&point_case(), &[r#"steps.0={"table": "from_zero.csv"}"#]);
    assert_eq!(point(&program).steps[0].pace, Pace::Rows(vec![0.0, 1.0]));
    assert!(program.about.warnings[0].contains("at time 0"));
}

#[test]
fn cycles_are_expanded_in_order() {
    let inner = json!({ "repeat": 2, "steps": [ { "increments": 3, "target": { "e11": 3.0 } } ] });
    let outer = json!([
        { "increments": 1, "target": { "e11": 1.0 } },
        { "repeat": 2, "steps": [ { "increments": 2.0, "target": { "e11": 2.0 } }, inner ] },
        { "cycles": { "repeat": 1, "steps": [ { "increments": 4 } ] } }
    ]);
    let mut case = point_case();
    case["steps"] = outer;
    let program = program(&case, &[]);
    let increments: Vec<usize> = point(&program).steps.iter().map(|step| step.pace.increments()).collect();
    assert_eq!(increments, [1, 2, 3, 3, 2, 3, 3, 4]);
}

#[test]
fn a_constraint_takes_the_place_of_the_stress_free_component_that_it_names() {
    let program = program(&point_case(), &[r#"steps.0.constraints=[{"s22": 1, "s11": -0.52, "equals": 0}]"#]);
    assert_eq!(controls(&program, 0), [Control::Strain(-0.001), Control::Constraint(0), FREE, FREE, FREE, FREE]);
    let expected = Constraint { strain: [0.0; 6], stress: [-0.52, 1.0, 0.0, 0.0, 0.0, 0.0], equals: 0.0, hold: false };
    assert_eq!(point(&program).steps[0].goal.constraints, [expected]);
    assert!(program.about.warnings.is_empty());
}

#[test]
fn constraints_are_matched_so_that_all_find_a_place() {
    let constraints = r#"steps.0.constraints=[{"s22": 1, "s33": -1}, {"s22": 1, "s11": -0.5}]"#;
    let program = program(&point_case(), &[constraints]);
    let controls = controls(&program, 0);
    assert!(matches!(controls[1..3], [Control::Constraint(_), Control::Constraint(_)]), "{controls:?}");
}

#[test]
fn an_ambiguous_constraint_is_reported_but_runs() {
    let overrides = [r#"steps.0.target={}"#, r#"steps.0.constraints=[{"s22": 1, "s11": 1, "equals": 2}]"#];
    let program = program(&point_case(), &overrides);
    assert_eq!(controls(&program, 0)[0], Control::Constraint(0));
    assert!(program.about.warnings[0].contains("chosen: s11"), "{:?}", program.about.warnings);
}

#[test]
fn constraints_go_with_tables_and_strains() {
    let step =
        r#"steps.0={"table": "untimed.csv", "constraints": [{"e22": 1, "e33": -1}, {"e33": 1, "equals": 1e-4}]}"#;
    let program = program(&point_case(), &[step]);
    assert!(matches!(controls(&program, 0)[1..3], [Control::Constraint(_), Control::Constraint(_)]));
}

#[test]
fn constraints_may_hold_what_there_is() {
    let step = r#"steps.0.constraints=[{"e11": 1, "e22": 1, "e33": 1, "equals": "hold"}]"#;
    let program = program(&point_case(), &[step]);
    assert!(point(&program).steps[0].goal.constraints[0].hold);
}

#[test]
fn deformation_gradients_stand_in_the_step_or_its_target() {
    let f = "[[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]";
    for key in ["steps.0.F", "steps.0.target.F"] {
        let overrides = ["nlgeom=true", "steps.0.target={}", &format!("{key}={f}")];
        let program = program(&point_case(), &overrides);
        let step = &point(&program).steps[0];
        assert_eq!(step.pace, Pace::Equal { increments: 10, time: 1.0 });
        let PointDrive::DeformationGradient(end) = step.goal.drive else { panic!("a deformation gradient") };
        assert_eq!(end, [[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert!(program.columns().contains(&"F12".to_owned()));
    }
}

#[test]
fn initial_states_temperature_and_field_variables() {
    let program = program(
        &point_case(),
        &[
            r#"initial={"strain": [1,2,3,4,5,6], "stress": {"s22": -7}, "statev": [8, 9], "time": 10}"#,
            "temperature=20",
            "predef=[1, 2]",
            "steps.0.temperature=30",
            "steps.0.predef=[3, 4]",
        ],
    );
    let point = point(&program);
    assert_eq!(point.initial.strain, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(point.initial.stress, Some(Box::new([0.0, -7.0, 0.0, 0.0, 0.0, 0.0])));
    assert_eq!((point.initial.statev.as_deref(), point.initial.time), (Some([8.0, 9.0].as_slice()), 10.0));
    assert_eq!(
        (point.initial.fields.temperature, point.initial.fields.variables.as_slice()),
        (20.0, [1.0, 2.0].as_slice())
    );
    assert_eq!(
        (point.steps[0].fields.temperature, point.steps[0].fields.predef.as_deref()),
        (Some(30.0), Some([3.0, 4.0].as_slice()))
    );
}

#[test]
fn initial_components_may_be_those_of_the_mode() {
    let program = program(&point_case(), &["mode=plane_stress", "initial.strain=[1, 2, 3]", "material.statev0=[5, 6]"]);
    assert_eq!(point(&program).initial.strain, [1.0, 2.0, 0.0, 3.0, 0.0, 0.0]);
    assert_eq!(point(&program).initial.statev.as_deref(), Some([5.0, 6.0].as_slice()));
}

#[test]
fn parameters_may_be_an_array_and_states_more_than_needed() {
    let program = program(&point_case(), &["material.props=[20000, 0.2]", "material.nstatv=4"]);
    assert_eq!(program.plugin.props, [20000.0, 0.2]);
    assert_eq!(program.plugin.nstatv, 4);
    assert!(program.columns().contains(&"sdv4".to_owned()));
}

#[test]
fn the_library_may_be_a_path() {
    let found = umat_abi::host::Found::by_name("linear_elastic", &umat_abi::host::search_paths(&[])).expect("a plugin");
    let mut case = point_case();
    case["material"]["plugin"] = json!(found.path);
    assert_eq!(program(&case, &[]).plugin.name, "linear_elastic");
}

#[test]
fn a_plain_library_is_read_with_symbol_and_states() {
    let mut case = interface_case();
    case["kind"] = json!("point");
    case["steps"] = point_case()["steps"].clone();
    let program = program(&case, &["until={\"quantity\": \"sdv2\", \"less_than\": -1}", "material.cmname=steel"]);
    assert!(program.plugin.law.is_none());
    assert_eq!((program.plugin.cmname.as_str(), program.plugin.props.as_slice()), ("steel", [1.0, 2.5].as_slice()));
    assert_eq!(program.about.until.map(|until| until.column), Some(16));
}

#[test]
fn controls_output_step_until_and_the_other_material_keys() {
    let program = program(
        &point_case(),
        &[
            r#"controls={"max_iterations": 7, "max_cutbacks": 0}"#,
            r#"output={"every": 5, "plots": false, "vtu": true}"#,
            r#"steps.0.until={"quantity": "s11", "less_than": -30}"#,
            "material.isolate=true",
            "material.thread_safe=true",
            "material.call_time_limit_s=5",
            "material.entry=umat",
            "characteristic_length=12.5",
            "$schema=https://example.org/schema.json",
        ],
    );
    assert_eq!((program.controls.max_iterations, program.controls.max_cutbacks), (7, 0));
    assert_eq!((program.about.every, program.about.plots), (5, false));
    assert_eq!(point(&program).steps[0].until.as_ref().map(|until| until.column), Some(9));
    assert_eq!(program.characteristic_length, Some(12.5));
    // the law is thread-safe by its metadata, and nothing has a mesh
    assert_eq!(program.about.warnings.len(), 2, "thread_safe, VTU: {:?}", program.about.warnings);
}

#[test]
fn overrides_create_replace_and_append() {
    let program = program(
        &point_case(),
        &["steps.0.increments=5", "title=a b", "steps.1.increments=2", "steps.1.target.e22=0.5", "initial.time=3"],
    );
    assert_eq!(program.about.title, "a b");
    assert_eq!(controls(&program, 1)[1], Control::Strain(0.5));
    assert_eq!(point(&program).initial.time, 3.0);
    assert_eq!(program.document["steps"][0]["increments"], 5);
    assert_eq!(point(&program).steps[0].pace.increments(), 5);
}

#[test]
fn interface_targets_and_their_normal_control() {
    let mut case = interface_case();
    case["steps"] = json!([
        { "increments": 4, "target": { "slip": 0.1 } },
        { "increments": 4, "target": { "slip": "hold", "p": 2 } },
        { "repeat": 2, "steps": [ { "increments": 1, "target": { "slip": 0 } }, { "increments": 1, "target": { "gap": 0.1 } } ] }
    ]);
    case["initial"] = json!({ "slip": 0.01, "gap": -0.02, "statev": [1, 2], "time": 4 });
    let program = program(&case, &["until={\"quantity\": \"abs(tau)\", \"greater_than\": 3}"]);
    let interface = interface(&program);
    assert_eq!((interface.entry, interface.tangential_directions), (InterfaceEntry::Uinter, 1));
    assert_eq!(interface.initial_displacement, [0.01, 0.0, -0.02]);
    assert_eq!((interface.initial_statev.as_slice(), interface.initial_time), ([1.0, 2.0].as_slice(), 4.0));
    let normal: Vec<NormalControl> = interface.steps.iter().map(|step| step.goal.normal).collect();
    use NormalControl::{Gap, Pressure};
    assert_eq!(normal, [Gap, Pressure, Pressure, Gap, Gap, Gap], "what a step does not name goes on");
    assert_eq!(interface.steps[1].goal.ends, [[None, None, Some(2.0)]]);
    assert_eq!(program.about.until.map(|until| until.column), Some(5));
}

#[test]
fn interface_tables_and_the_second_direction() {
    let overrides = ["steps.0={\"table\": \"contact.csv\"}", "material.entry=fric"];
    let program = program(&interface_case(), &overrides);
    let interface = interface(&program);
    assert_eq!((interface.entry, interface.tangential_directions), (InterfaceEntry::Fric, 2));
    assert_eq!(interface.steps[0].goal.normal, NormalControl::Pressure);
    assert_eq!(interface.steps[0].goal.ends[1], [Some(0.2), Some(0.05), Some(3.0)]);
    assert_eq!(interface.steps[0].pace, Pace::Rows(vec![1.0, 1.0]));
    assert!(program.columns().contains(&"tau2".to_owned()));
}

#[test]
fn the_schema_says_units_and_denies_unknown_keys() {
    let schema = super::schema();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    let text = schema.to_string();
    assert!(text.contains("Characteristic length, mm") && text.contains("Stress 11, MPa"));
    for name in ["PointCase", "InterfaceCase", "Material", "PointRamp", "StepTarget", "Until", "Compare"] {
        assert_eq!(schema["$defs"][name]["additionalProperties"], false, "{name}");
    }
    assert_eq!(schema["$defs"]["PointCase"]["required"], json!(["kind", "material", "steps"]));
}

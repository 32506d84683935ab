//! Jobs whose course ABAQUS's rules determine: the case has the same values at the end of each increment.

use crate::{ImportOptions, Imported, import};
use serde_json::{Value, json};

const BRICK: &str = "*NODE
1, 1., 1., 0.
2, 3., 1., 0.
3, 3., 4., 0.
4, 1., 4., 0.
5, 1., 1., 4.
6, 3., 1., 4.
7, 3., 4., 4.
8, 1., 4., 4.
*ELEMENT, TYPE=C3D8, ELSET=E
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=X0
1, 4, 5, 8
*NSET, NSET=X1
2, 3, 6, 7
*NSET, NSET=Y0
1, 2, 5, 6
*NSET, NSET=Y1
3, 4, 7, 8
*NSET, NSET=Z0
1, 2, 3, 4
*NSET, NSET=N, GENERATE
1, 8
*SURFACE, NAME=SX
E, S4
*SOLID SECTION, ELSET=E, MATERIAL=M
*MATERIAL, NAME=M
*USER MATERIAL, CONSTANTS=2
200.E3, 0.3
*INITIAL CONDITIONS, TYPE=TEMPERATURE
N, 20.
*BOUNDARY
X0, 1
Y0, 2
Z0, 3
";

/// Imports a job of the brick with some more lines.
fn of_job(job: &str) -> Result<Imported, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("job.inp");
    std::fs::write(&file, job).expect("a job");
    let name = format!("{}/", folder.path().display());
    let without_folder = |text: String| text.replace(&name, "");
    let options = ImportOptions { material: None, plugin: Some("./libumat.so") };
    let imported = import(&file, options).map_err(without_folder)?;
    Ok(Imported { left_out: imported.left_out.into_iter().map(without_folder).collect(), ..imported })
}

/// Imports a material of a job.
fn material_of(job: &str, name: &str) -> Imported {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("job.inp");
    std::fs::write(&file, job).expect("a job");
    import(&file, ImportOptions { material: Some(name), plugin: Some("./libumat.so") }).expect("a material")
}

fn imported(history: &str) -> Imported {
    of_job(&format!("{BRICK}{history}")).expect("it can be imported")
}

/// Returns the steps of a job from which nothing is left out.
fn steps(history: &str) -> Vec<Value> {
    let imported = imported(history);
    assert_eq!(imported.left_out, Vec::<String>::new(), "{history}");
    imported.document["steps"].as_array().expect("steps").clone()
}

fn refused(history: &str) -> String {
    of_job(&format!("{BRICK}{history}")).expect_err("it cannot be imported")
}

/// The place of the line with a text.
fn line_of(history: &str, text: &str) -> String {
    let job = format!("{BRICK}{history}");
    format!("job.inp:{}: ", job.lines().position(|line| line.contains(text)).expect("it is there") + 1)
}

fn step(lines: &str) -> String {
    format!("*STEP\n*STATIC, DIRECT\n0.1, 1.\n{lines}*END STEP\n")
}

/// The values of a column at the ends of increments.
fn column(step: &Value, name: &str) -> Vec<f64> {
    let values = step["table"][name].as_array().unwrap_or_else(|| panic!("{name} in {step}"));
    values.iter().map(|value| value.as_f64().expect("a number")).collect()
}

fn assert_close(values: &[f64], expected: impl Fn(f64) -> f64) {
    assert_eq!(values.len(), 10);
    for (k, value) in values.iter().enumerate() {
        let expected = expected((k + 1) as f64 / 10.0);
        assert!((value - expected).abs() <= 1e-12 * expected.abs().max(1e-3), "{k}: {value}, not {expected}");
    }
}

/// Relaxation: the whole displacement in the first increment, which then stays.
#[test]
fn an_amplitude_that_starts_at_1_jumps() {
    let lines = step("*BOUNDARY, AMPLITUDE=A\nX1, 1, 1, 0.02\n");
    let steps = steps(&format!("*AMPLITUDE, NAME=A\n0., 1., 1., 1.\n{lines}"));
    assert_eq!(steps.len(), 1);
    // 0.02 mm of 2 mm
    assert_close(&column(&steps[0], "e11"), |_| 0.01);
    assert_close(&column(&steps[0], "time"), |time| time);
    assert_close(&column(&steps[0], "g12"), |_| 0.0);
    assert!(steps[0]["table"]["s22"].is_null() && steps[0]["constraints"].is_null());
}

/// A load, a pressure, a temperature and a field variable are amplitude times value at the end of each increment.
#[test]
fn loads_and_fields_are_their_value_times_the_amplitude() {
    let half = "*AMPLITUDE, NAME=A\n0., 0.5, 1., 1.\n";
    // 4 · 30 N on 3 mm · 4 mm
    let force = steps(&(half.to_owned() + &step("*CLOAD, AMPLITUDE=A\nX1, 1, 30.\n")));
    assert_close(&column(&force[0], "s11"), |time| 10.0 * (0.5 + 0.5 * time));
    for load in ["*DSLOAD, AMPLITUDE=A\nSX, P, -10.\n", "*DLOAD, AMPLITUDE=A\nE, P4, -10.\n"] {
        let pressed = steps(&(half.to_owned() + &step(load)));
        assert_close(&column(&pressed[0], "s11"), |time| 10.0 * (0.5 + 0.5 * time));
    }
    let constant = "*AMPLITUDE, NAME=A\n0., 100., 1., 100.\n";
    let heated = steps(&(constant.to_owned() + &step("*TEMPERATURE, AMPLITUDE=A\nN, 1.\n")));
    assert_close(&column(&heated[0], "temperature"), |_| 100.0);
    let field = "*INITIAL CONDITIONS, TYPE=FIELD, VARIABLE=1\nN, 0.5\n";
    let changed = steps(&(field.to_owned() + half + &step("*FIELD, AMPLITUDE=A, VARIABLE=1\nN, 2.\n")));
    assert_close(&column(&changed[0], "predef1"), |time| 1.0 + time);
    // an amplitude that starts where the value is, and bends within increments only, has values at their ends
    let bent = "*AMPLITUDE, NAME=A\n0., 0., 0.25, 1., 1., 0.\n";
    let force = steps(&(bent.to_owned() + &step("*CLOAD, AMPLITUDE=A\nX1, 1, 30.\n")));
    assert_close(&column(&force[0], "s11"), |time| 10.0 * if time < 0.25 { 4.0 * time } else { (1.0 - time) / 0.75 });
    // one that is a line from there is a ramp
    let line = steps(&("*AMPLITUDE, NAME=A\n0., 0., 2., 2.\n".to_owned() + &step("*CLOAD, AMPLITUDE=A\nX1, 1, 30.\n")));
    assert_eq!(line[0]["target"]["s11"], 10.0);
}

/// Over the total time, first used in step 2 (0.28 of 0.03 mm at its first end), then left alone in step 3.
#[test]
fn an_amplitude_over_the_total_time_goes_on_where_it_is() {
    let history = "*AMPLITUDE, NAME=A, TIME=TOTAL TIME\n0., 0., 1., 0.2, 2., 1., 3., 0.\n".to_owned()
        + &step("*BOUNDARY\nX1, 1, 1, 0.012\n")
        + &step("*BOUNDARY, AMPLITUDE=A\nY1, 2, 2, 0.03\n")
        + &step("*CLOAD\nX1, 3, 0.\n");
    let steps = steps(&history);
    assert_eq!(steps[0]["target"]["e11"], 0.006);
    assert_close(&column(&steps[1], "e22"), |time| 0.01 * (0.2 + 0.8 * time));
    assert_close(&column(&steps[1], "e11"), |_| 0.006);
    // "continues to follow its associated amplitude definition, provided that the amplitude curve is defined in terms of
    // total time" (Getting Started with ABAQUS, general analysis procedures)
    assert_eq!(steps[2]["target"]["e22"], 0.0);
    let held = history.replace(", TIME=TOTAL TIME", "");
    // over the time of the step it stays where step 2 ended: A(1) = 0.2
    let steps = imported(&held).document["steps"].clone();
    assert_eq!(steps[2]["target"]["e22"], json!(0.002));
}

/// AMPLITUDE=STEP, which is the default of *VISCO, applies values at the start of the step.
#[test]
fn values_of_a_step_variation_jump() {
    let boundary = "*BOUNDARY\nX1, 1, 1, 0.02\n*TEMPERATURE\nN, 100.\n";
    let at_once = step(boundary).replace("*STEP", "*STEP, AMPLITUDE=STEP");
    let visco = step(boundary).replace("*STATIC, DIRECT", "*VISCO, CETOL=1.E-3, DIRECT");
    for history in [&at_once, &visco] {
        let steps = steps(history);
        assert_close(&column(&steps[0], "e11"), |_| 0.01);
        assert_close(&column(&steps[0], "temperature"), |_| 100.0);
    }
    let ramped = visco.replace("*STEP", "*STEP, AMPLITUDE=RAMP");
    assert_eq!(steps(&ramped)[0]["target"]["e11"], 0.01);
    // a support that is taken away has no stress afterwards
    let away = step("*BOUNDARY, OP=NEW\nX0, 1\nY0, 2\nZ0, 3\n");
    let steps = steps(&(step(boundary) + &away.replace("*STEP", "*STEP, AMPLITUDE=STEP")));
    assert!(steps[1]["table"]["e11"].is_null() && steps[1]["constraints"].is_null(), "{}", steps[1]);
}

/// A support that a step takes away unloads along a line, also where other values follow an amplitude; so does a displacement
/// that a step prescribes for the first time.
#[test]
fn what_starts_from_an_unknown_value_goes_straight_to_its_end() {
    let jump = "*AMPLITUDE, NAME=A\n0., 1., 1., 1.\n";
    let freed = "*BOUNDARY, OP=NEW\nX0, 1\nY0, 2\nZ0, 3\n*TEMPERATURE, AMPLITUDE=A\nN, 50.\n";
    let steps_of = |second: &str| steps(&(jump.to_owned() + &step("*BOUNDARY\nX1, 1, 1, 0.02\n") + &step(second)));
    let steps = steps_of(freed);
    assert_eq!(steps[1]["constraints"], json!([{ "s11": 1.0, "equals": 0.0 }]));
    assert_close(&column(&steps[1], "temperature"), |_| 50.0);
    let held = steps_of("*BOUNDARY\nY1, 2, 2, 0.03\n*TEMPERATURE, AMPLITUDE=A\nN, 50.\n");
    assert_eq!(held[1]["constraints"], json!([{ "e22": 1.0, "equals": 0.01 }]));
    assert_close(&column(&held[1], "e11"), |_| 0.01);
}

/// OP=NEW of *TEMPERATURE or *FIELD without data: back to the initial values.
#[test]
fn fields_that_are_taken_away_return_to_their_initial_values() {
    let field = "*INITIAL CONDITIONS, TYPE=FIELD, VARIABLE=1\nN, 0.5\n";
    let history = field.to_owned()
        + &step("*TEMPERATURE\nN, 120.\n*FIELD, VARIABLE=1\nN, 2.\n")
        + &step("*TEMPERATURE, OP=NEW\n*FIELD, OP=NEW\n");
    let steps = steps(&history);
    assert_eq!((&steps[0]["temperature"], &steps[0]["predef"]), (&json!(120.0), &json!([2.0])));
    assert_eq!((&steps[1]["temperature"], &steps[1]["predef"]), (&json!(20.0), &json!([0.5])));
}

/// Pressures of surfaces and of elements add up, and OP=NEW takes away those of its own keyword.
#[test]
fn op_new_is_that_of_its_keyword() {
    let history = step("*DSLOAD\nSX, P, -5.\n*DLOAD\nE, P4, -10.\n") + &step("*DLOAD, OP=NEW\n");
    let steps = steps(&history);
    assert_eq!((&steps[0]["target"]["s11"], &steps[1]["target"]["s11"]), (&json!(15.0), &json!(5.0)));
    // what OP=NEW gives again starts where it was
    let history = "*AMPLITUDE, NAME=A\n0., 1., 1., 1.\n".to_owned()
        + &step("*BOUNDARY\nX1, 1, 1, 0.02\n")
        + &step("*BOUNDARY, OP=NEW\nX0, 1\nY0, 2\nZ0, 3\nX1, 1, 1, 0.04\n*CLOAD, AMPLITUDE=A\nY1, 2, 24.\n");
    let steps = self::steps(&history);
    assert_close(&column(&steps[1], "e11"), |time| 0.01 + 0.01 * time);
    // 4 · 24 N on 2 mm · 4 mm
    assert_close(&column(&steps[1], "s22"), |_| 12.0);
}

#[test]
fn a_perturbation_is_left_out_with_its_end() {
    let perturbed = step("*BOUNDARY\nX1, 1, 1, 0.04\n").replace("*STEP", "*STEP, PERTURBATION");
    let history = step("*BOUNDARY\nX1, 1, 1, 0.02\n") + &perturbed + &step("*TEMPERATURE\nN, 30.\n");
    let imported = imported(&history);
    let steps = imported.document["steps"].as_array().expect("steps");
    assert_eq!((steps.len(), &steps[1]["target"]["e11"]), (2, &json!(0.01)));
    assert_eq!(imported.left_out.len(), 1);
    assert!(imported.left_out[0].starts_with(&line_of(&history, "PERTURBATION")), "{:?}", imported.left_out);
    assert!(refused(&perturbed).contains("there is no other step"));
}

/// The element's mean s12 is 14.37 and 5.83 MPa there (full integration, E = 200 GPa, ν = 0.3, 0.0005 mm), not the 19.23 and
/// 12.82 MPa of the uniform shear.
#[test]
fn a_shear_of_which_faces_are_free_is_refused() {
    for (lines, strain, last) in [
        ("N, 2, 2\nN, 3, 3\nX1, 2, 2, 0.01\n", "g12", "X1, 2, 2"),
        ("Y1, 1, 1, 0.01\nY0, 1, 1, 0.\n", "g12", "Y1, 1, 1"),
    ] {
        let history = step(&format!("*BOUNDARY\n{lines}"));
        let reason = refused(&history);
        assert!(reason.starts_with(&line_of(&history, last)), "{reason}");
        assert!(reason.contains(strain) && reason.contains("nodes are free along 1 or 2"), "{reason}");
    }
    let all = steps(&step("*BOUNDARY\nN, 1, 3\nX1, 2, 2, 0.01\n"));
    assert_eq!(all[0]["target"]["g12"], 0.005);
}

/// One displacement at each end of a diagonal: u = 0.01 along it is a sum of three gradients.
#[test]
fn displacements_that_determine_only_a_sum_are_refused() {
    let history = BRICK.replace("X0, 1\n", "1, 1\n") + &step("*BOUNDARY\n7, 1, 1, 0.01\n");
    let reason = of_job(&history).expect_err("refused");
    assert!(reason.contains("determine only a combination of strains"), "{reason}");
}

/// An oblique material shears where faces are free: the zero shear of the case is that of its nodes only.
#[test]
fn a_zero_shear_that_an_oblique_material_would_not_have_is_named() {
    let job = |axes: &str| {
        let section = "MATERIAL=M, ORIENTATION=O";
        let brick = BRICK.replace("MATERIAL=M\n*MAT", &format!("{section}\n*ORIENTATION, NAME=O\n{axes}*MAT"));
        of_job(&(brick + &step("*BOUNDARY\nX1, 1, 1, 0.02\n"))).expect("it can be imported")
    };
    assert!(job("1., 1., 0., -1., 1., 0.\n").left_out[0].contains("the case holds g12, g13, g23 at 0"));
    assert_eq!(job("0., 1., 0., -1., 0., 0.\n").left_out, Vec::<String>::new());
    // a further rotation of 10° about 3, and one of 90° about 1, the default
    let turned = job("1., 1., 0., -1., 1., 0.\n3, 10.\n").document["material"]["orientation"].clone();
    let (sine, cosine) = 55_f64.to_radians().sin_cos();
    for (vector, expected) in [[cosine, sine, 0.0], [-sine, cosine, 0.0]].into_iter().enumerate() {
        for (axis, expected) in expected.into_iter().enumerate() {
            assert!((turned[vector][axis].as_f64().expect("a number") - expected).abs() < 1e-15, "{turned}");
        }
    }
    let turned = job("2., 0., 0., 0., 3., 0.\n, 90.\n").document["material"]["orientation"].clone();
    assert!((turned[1][2].as_f64().expect("a number") - 1.0).abs() < 1e-15, "{turned}");
}

#[test]
fn an_orientation_that_cannot_be_imported_is_named_with_its_line() {
    let section = "MATERIAL=M, ORIENTATION=O\n*ORIENTATION, NAME=O\n1., 0., 0., 0., 1., 0.\n4, 10.\n*MAT";
    let job = BRICK.replace("MATERIAL=M\n*MAT", section) + &step("");
    let reason = of_job(&job).expect_err("refused");
    let line = job.lines().position(|line| line == "4, 10.").expect("it is there") + 1;
    assert!(reason.starts_with(&format!("job.inp:{line}: ")) && reason.contains("about the axis 4"), "{reason}");
}

/// Increments of 0.3 in a step of 1: the last is 0.1.
#[test]
fn increments_that_do_not_divide_the_step_keep_their_length() {
    let uneven = |lines: &str| step(lines).replace("0.1, 1.", "0.3, 1.");
    let drive = "*BOUNDARY\nX1, 1, 1, 0.02\n*TEMPERATURE\nN, 120.\n";
    let steps = steps(&uneven(drive));
    let near = |name: &str, expected: [f64; 4]| {
        let values = column(&steps[0], name);
        assert_eq!(values.len(), 4);
        assert!(values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12 * b), "{values:?}");
    };
    near("time", [0.3, 0.6, 0.9, 1.0]);
    near("e11", [0.003, 0.006, 0.009, 0.01]);
    near("temperature", [50.0, 80.0, 110.0, 120.0]);
    // a deformation gradient has no table
    let sheared = uneven("*BOUNDARY\nN, 1, 3\nX1, 2, 2, 0.01\n").replace("*STEP", "*STEP, NLGEOM");
    let imported = imported(&sheared);
    assert!(imported.left_out[0].contains("it becomes 2 steps"), "{:?}", imported.left_out);
    let steps = &imported.document["steps"];
    assert_eq!((&steps[0]["increments"], &steps[1]["increments"]), (&json!(3), &json!(1)));
    assert!((steps[0]["F"][1][0].as_f64().expect("a number") - 0.0045).abs() < 1e-15);
    assert_eq!(steps[1]["F"][1][0], 0.005);
}

/// A shear that jumps, and goes back: the case follows the deformation gradient, whose rotation goes back too.
#[test]
fn a_shear_at_large_deformations_follows_its_amplitude() {
    let shear = "*BOUNDARY, AMPLITUDE=A\nN, 1, 3\nX1, 2, 2, 0.2\n";
    let history = "*AMPLITUDE, NAME=A\n0., 1., 0.5, 1., 1., 0.\n".to_owned()
        + &step(shear).replace("*STEP", "*STEP, NLGEOM")
        + &step("*TEMPERATURE\nN, 20.\n");
    let imported = imported(&history);
    assert_eq!(imported.left_out.len(), 1, "{:?}", imported.left_out);
    let pieces: Vec<_> = imported.document["steps"]
        .as_array()
        .expect("steps")
        .iter()
        .map(|step| (step["increments"].as_u64(), step["F"][1][0].as_f64()))
        .collect();
    let piece = |increments: u64, shear: f64| (Some(increments), Some(shear));
    assert_eq!(pieces, [piece(1, 0.1), piece(4, 0.1), piece(5, 0.0), piece(10, 0.0)]);
}

/// A shear that begins only at the half of the step.
#[test]
fn a_shear_that_begins_later_has_a_deformation_gradient_from_the_start() {
    let history = "*AMPLITUDE, NAME=A\n0., 0., 0.5, 0., 1., 1.\n".to_owned()
        + &step("*BOUNDARY, AMPLITUDE=A\nN, 1, 3\nX1, 2, 2, 0.2\n").replace("*STEP", "*STEP, NLGEOM");
    let steps = imported(&history).document["steps"].clone();
    let identity = json!([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!((&steps[0]["increments"], &steps[0]["F"]), (&json!(5), &identity));
    assert_eq!((&steps[1]["increments"], &steps[1]["F"][1][0]), (&json!(5), &json!(0.1)));
}

/// Each option that is not understood is listed with its line.
#[test]
fn options_that_would_be_lost_are_listed() {
    for (from, to, words) in [
        ("*STATIC, DIRECT", "*STATIC, DIRECT, STABILIZE", "STABILIZE of *STATIC"),
        ("*TEMPERATURE", "*TEMPERATURE, BSTEP=2", "BSTEP of *TEMPERATURE"),
        ("*USER MATERIAL", "*USER MATERIAL, EFFMOD", "EFFMOD of *USER MATERIAL"),
        ("*INITIAL", "*DEPVAR, DELETE=1\n1\n*INITIAL", "DELETE of *DEPVAR"),
        ("*STEP", "*STEP, INC=10, UNSYMM=YES", ""),
    ] {
        let job = format!("{BRICK}{}", step("*TEMPERATURE\nN, 30.\n")).replacen(from, to, 1);
        let left_out = of_job(&job).expect("it can be imported").left_out;
        let line = job.lines().position(|line| to.starts_with(line) || line.starts_with(to)).expect("it is there") + 1;
        let expected = if words.is_empty() { Vec::new() } else { vec![format!("job.inp:{line}: {words}")] };
        assert_eq!(left_out, expected);
    }
    let moved = BRICK.replace("C3D8", "CAX4").replace("1, 1, 2, 3, 4, 5, 6, 7, 8", "1, 1, 2, 3, 4")
        + "*INSTANCE, NAME=I, PART=P\n2., 0., 0.\n*END INSTANCE\n"
        + &step("");
    assert!(of_job(&moved).expect_err("refused").contains("a moved axisymmetric instance"));
    let shifted =
        "*AMPLITUDE, NAME=A, SHIFTY=1.\n0., 0., 1., 1.\n".to_owned() + &step("*CLOAD, AMPLITUDE=A\nX1, 1, 30.\n");
    assert!(refused(&shifted).contains("an amplitude with SHIFTY cannot be imported"));
    let twice = step("*CLOAD\nX1, 1, 30.\nX1, 1, 60.\n");
    let imported = imported(&twice);
    assert!(imported.left_out[0].starts_with(&line_of(&twice, "X1, 1, 30.")), "{:?}", imported.left_out);
    assert_eq!(imported.document["steps"][0]["target"]["s11"], 20.0);
}

/// What a material alone loses is listed too; what other materials and the job lose is not.
#[test]
fn what_a_material_loses_is_listed() {
    let material =
        |name: &str, lines: &str| format!("*MATERIAL, NAME={name}\n*USER MATERIAL, CONSTANTS=1\n1.\n{lines}");
    let job = format!(
        "{}{}*STEP\n*CONTROLS\n*END STEP\n",
        material("A", "*DENSITY\n1.\n*DEPVAR, DELETE=1\n2\n"),
        material("B", "*EXPANSION, TYPE=ANISO\n1.\n")
    );
    let ends = |name: &str| -> Vec<String> {
        let left_out = material_of(&job, name).left_out;
        left_out.iter().map(|line| line.rsplit("job.inp:").next().expect("a line").to_owned()).collect()
    };
    assert_eq!(ends("A"), ["4: *DENSITY", "6: DELETE of *DEPVAR"]);
    assert_eq!(ends("B"), ["11: *EXPANSION that is neither ISO nor ORTHO over the temperature alone"]);
}

#[test]
fn what_writes_a_job_is_named_as_that() {
    let parameter = format!("*PARAMETER\nE = 200.E3\n{}", step(""));
    assert!(refused(&parameter).ends_with("*PARAMETER is not imported: write the numbers in"));
    assert!(refused("*NGEN, NSET=A\n1, 3, 1\n").contains("write out the nodes"));
}

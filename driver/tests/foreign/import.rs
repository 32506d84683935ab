//! `pullout import`: one-element jobs become cases, and what cannot become one is refused with its line.

use super::{built, close};
use crate::program::Desk;
use serde_json::{Value, json};

const CUBE: &str = "*NODE, NSET=ALL
1, 0., 0., 0.
2, 2., 0., 0.
3, 2., 2., 0.
4, 0., 2., 0.
5, 0., 0., 4.
6, 2., 0., 4.
7, 2., 2., 4.
8, 0., 2., 4.
*ELEMENT, TYPE=C3D8R, ELSET=CUBE
1, 1, 2, 3, 4,
5, 6, 7, 8
*NSET, NSET=LEFT
1, 4, 5, 8
*NSET, NSET=RIGHT
2, 3, 6, 7
*NSET, NSET=FRONT
1, 2, 5, 6
*NSET, NSET=BOTTOM, GENERATE
1, 4
*SOLID SECTION, ELSET=CUBE, MATERIAL=STEEL
";
const STEEL: &str = "*MATERIAL, NAME=STEEL\n*DEPVAR\n 3,\n*USER MATERIAL, CONSTANTS=2\n 200.D3, 0.25\n";
const ROLLERS: &str = "*BOUNDARY\nLEFT, 1\nFRONT, 2\nBOTTOM, 3\n";

/// A case of a job, and what was not imported.
fn imported(desk: &Desk, job: &str) -> (Value, String) {
    desk.write("job.inp", job);
    let outcome = desk.pullout(["import", "job.inp"]).expect(0);
    (serde_json::from_str(&outcome.stdout).expect("JSON"), outcome.stderr)
}

/// Returns the reason why a job is refused.
fn refused(desk: &Desk, job: &str) -> String {
    desk.write("job.inp", job);
    desk.pullout(["import", "job.inp"]).expect(2).stderr
}

/// The line of a job that a text stands on.
fn line_of(job: &str, text: &str) -> String {
    let number = job.lines().position(|line| line.contains(text)).expect("it is there") + 1;
    format!("job.inp:{number}: ")
}

#[test]
fn a_job_in_tension_gives_the_stress_of_hookes_law() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    // Up to 1e-3 at the fourth of the time, down to -1e-3 at its end; pressure on the sides; then up to 2e-3.
    let job = format!(
        "*HEADING\nTension and back\n** a comment\n{CUBE}{STEEL}*SURFACE, NAME=BACK, TYPE=ELEMENT\nCUBE, S5\n*AMPLITUDE, \
         NAME=saw\n0., 0., 0.25, 1., 1., -1.\n{ROLLERS}*STEP, NAME=first\n*STATIC, DIRECT\n0.05, 1.\n*BOUNDARY, \
         AMPLITUDE=SAW\nRIGHT, 1, 1, 0.002\n*DSLOAD\nBACK, P, 30.\n*OUTPUT, FIELD\n*END STEP\n*STEP\n*STATIC, DIRECT\n1., \
         2.\n*BOUNDARY\nRIGHT, 1, 1, 0.004\n*END STEP\n"
    );
    let (case, left_out) = imported(&desk, &job);
    let library_line = line_of(&job, "*MATERIAL");
    let message = "the library of STEEL: \"plugin\" is ./libumat.so; --plugin sets it";
    assert_eq!(left_out, format!("not imported: {library_line}{message}\n"));
    assert_eq!(case["title"], "Tension and back");
    assert_eq!(case["characteristic_length"], json!(16.0_f64.cbrt()));
    let steps = case["steps"].as_array().expect("steps");
    assert_eq!(steps.len(), 2);
    let table = &steps[0]["table"];
    for (row, time, e11) in [(0, 0.05, 2e-4), (4, 0.25, 1e-3), (19, 1.0, -1e-3)] {
        close(table["time"][row].as_f64().expect("a number"), time);
        close(table["e11"][row].as_f64().expect("a number"), e11);
        close(table["s22"][row].as_f64().expect("a number"), -30.0 * time);
    }
    assert_eq!((&steps[1]["increments"], &steps[1]["time"]), (&json!(2), &json!(2.0)));
    assert_eq!(steps[1]["target"], json!({ "e11": 2e-3, "s22": -30.0, "g12": 0.0, "g13": 0.0, "g23": 0.0 }));

    let output = desk.path("case.json");
    let arguments = ["import", "job.inp", "--plugin", library.as_str().expect("a path"), "-o"];
    desk.pullout(arguments.iter().copied().chain([output.to_str().expect("UTF-8")])).expect(0);
    let history = desk.run(&output, &[], "out", 0).history;
    // s11 = E e11 + nu s22 (s33 = 0)
    close(history.last("s11"), 200e3 * 2e-3 - 0.25 * 30.0);
    close(history.last("time"), 3.0);
    let quarter = history.column("time").iter().position(|time| (time - 0.25).abs() < 1e-9).expect("a row");
    close(history.column("s11")[quarter], 200e3 * 1e-3 - 0.25 * 7.5);
    let again = desk.pullout(arguments.iter().copied().chain(["case.json"])).expect(2);
    assert!(again.stderr.contains("is not overwritten"), "{}", again.stderr);
}

#[test]
fn a_face_that_is_driven_in_part_is_named() {
    let desk = Desk::new();
    const WORDS: &str = "a displacement of only some nodes of a face";
    let job = |nodes: &str, supports: &str| {
        format!("{CUBE}{STEEL}{supports}*STEP\n*STATIC\n1., 1.\n*BOUNDARY\n{nodes}, 1, 1, 0.002\n*END STEP\n")
    };
    for (nodes, supports, is_whole) in [
        ("RIGHT", ROLLERS, true),
        ("2", ROLLERS, false),
        ("RIGHT", "*BOUNDARY\n1, 1\n4, 1\n5, 1\nFRONT, 2\nBOTTOM, 3\n", false),
        // nodes that are held against turning alone
        ("RIGHT", "*BOUNDARY\nLEFT, 1\n1, 2\n1, 3\n2, 3\n", true),
    ] {
        let (case, left_out) = imported(&desk, &job(nodes, supports));
        assert_eq!(case["steps"][0]["target"]["e11"], json!(1e-3));
        assert_eq!(!left_out.contains(WORDS), is_whole, "{nodes}, {supports}: {left_out}");
    }
}

#[test]
fn all_of_a_law_with_many_constants_is_taken_over() {
    let desk = Desk::new();
    // 184 constants, blanks for zeros, a file of its own in the job's folder
    let constants: Vec<f64> = (0..184).map(|k| if k % 7 == 3 { 0.0 } else { 1.5 * f64::from(k) - 20.0 }).collect();
    let lines: String = constants
        .chunks(8)
        .map(|line| {
            let values: Vec<_> =
                line.iter().map(|value| if *value == 0.0 { String::new() } else { value.to_string() }).collect();
            values.join(", ") + ",\n"
        })
        .collect();
    desk.write("crystal.inc", &format!("*USER MATERIAL, CONSTANTS=184, UNSYMM\n{lines}*DEPVAR\n125,\n"));
    let job = "*MATERIAL, NAME=Crystal\n*INCLUDE, INPUT=crystal.inc\n*DENSITY\n7.8E-9\n";
    desk.write("job.inp", job);
    let outcome = desk.pullout(["import", "job.inp", "--material", "crystal", "--plugin", "./libcp.so"]).expect(0);
    let material: Value = serde_json::from_str(&outcome.stdout).expect("JSON");
    let expected = json!({ "plugin": "./libcp.so", "props": constants, "nstatv": 125, "cmname": "CRYSTAL" });
    assert_eq!(material, expected);
    assert!(refused(&desk, job).contains("has no element; --material NAME"));
    let missing = desk.pullout(["import", "job.inp", "--material", "steel"]).expect(2).stderr;
    assert!(missing.contains("has no *USER MATERIAL steel; there is CRYSTAL"), "{missing}");
    desk.write("crystal.inc", &format!("*USER MATERIAL, CONSTANTS=192\n{lines}"));
    let words = refused(&desk, job);
    assert!(words.contains("crystal.inc:1: CONSTANTS=192, but 184 are given"), "{words}");
}

#[test]
fn what_plugin_info_prints_can_be_imported() {
    let desk = Desk::new();
    for law in ["concrete_damage", "bond_slip", "linear_elastic"] {
        let text = desk.pullout(["plugin", "info", law, "--abaqus"]).expect(0).stdout;
        desk.write("material.inp", &text);
        if law == "bond_slip" {
            // no user material, only an interface
            desk.pullout(["import", "material.inp", "--material", law]).expect(2);
            continue;
        }
        let outcome = desk.pullout(["import", "material.inp", "--material", law]).expect(0);
        let material: Value = serde_json::from_str(&outcome.stdout).expect("JSON");
        assert_eq!(material["plugin"], law);
        let case = |material: &Value| {
            json!({ "kind": "point", "mode": "3d", "material": material, "characteristic_length": 10.0,
                "steps": [{ "increments": 4, "target": { "e11": 2e-4 } }] })
        };
        let s11 = |name: &str, material: &Value| {
            let file = desk.case(&format!("{name}.json"), &case(material));
            desk.run(&file, &[], name, 0).history.last("s11")
        };
        let defaults = json!({ "plugin": law });
        assert_eq!(s11("imported", &material).to_bits(), s11("defaults", &defaults).to_bits(), "{law}");
    }
}

#[test]
fn plane_and_axisymmetric_elements_and_parts_are_understood() {
    let desk = Desk::new();
    let job = |kind: &str, x: f64| {
        format!(
            "*PART, NAME=P\n*NODE\n1, {x}, 0.\n2, {}, 0.\n3, {}, 5.\n4, {x}, 5.\n*ELEMENT, TYPE={kind}\n1, 1, 2, 3, \
             4\n*ELSET, ELSET=E\n1,\n*SOLID SECTION, ELSET=E, MATERIAL=STEEL\n2.,\n*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, \
             NAME=P-1, PART=P\n*END INSTANCE\n*NSET, NSET=TOP, INSTANCE=P-1\n3, 4\n*NSET, \
             NSET=ALL, INSTANCE=P-1\n1, 2, TOP\n*END ASSEMBLY\n{STEEL}*INITIAL \
             CONDITIONS, TYPE=STRESS\nP-1.E, -1., -2., -3., 0.\n*INITIAL CONDITIONS, TYPE=SOLUTION\nE, 1., 2., 3.\n*INITIAL \
             CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n*INITIAL CONDITIONS, TYPE=FIELD, VARIABLE=2\nALL, \
             0.5\n*BOUNDARY\nP-1.1, 1, 2\nP-1.4, 1\nP-1.2, 2\n*STEP\n*STATIC\n1., 1.\n*CLOAD\nTOP, 2, \
             100.\n*TEMPERATURE\nALL, 80.\n*FIELD, VARIABLE=2\nALL, 1.5\n*END STEP\n",
            x + 10.0,
            x + 10.0
        )
    };
    for (kind, mode) in [("CPE4R", "plane_strain"), ("CPS4", "plane_stress"), ("CPE4H", "plane_strain")] {
        let (case, _) = imported(&desk, &job(kind, 7.0));
        assert_eq!(case["mode"], mode);
        // 2 · 100 N on 10 mm · 2 mm
        let step = json!({ "increments": 1, "time": 1.0, "target": { "s22": 10.0, "g12": 0.0 },
            "temperature": 80.0, "predef": [0.0, 1.5] });
        assert_eq!(case["steps"], json!([step]));
        assert_eq!(case["initial"], json!({ "stress": [-1.0, -2.0, -3.0, 0.0], "statev": [1.0, 2.0, 3.0] }));
        assert_eq!((&case["temperature"], &case["predef"]), (&json!(20.0), &json!([0.0, 0.5])));
        assert_eq!(case["characteristic_length"], json!(50.0_f64.sqrt()));
    }
    let pressed = |x: f64| {
        job("CAX4", x).replace("*CLOAD\nTOP, 2, 100.", "*BOUNDARY\n2, 1, 1, 0.05\n3, 1, 1, 0.05\nTOP, 2, 2, -0.1")
    };
    let (case, _) = imported(&desk, &pressed(0.0));
    assert_eq!(case["steps"][0]["target"], json!({ "e11": 0.005, "e33": 0.005, "e22": -0.02, "g12": 0.0 }));
    let words = refused(&desk, &pressed(7.0));
    assert!(words.contains("off the axis"), "{words}");
}

#[test]
fn large_deformations_are_nominal_strains_or_a_deformation_gradient() {
    let desk = Desk::new();
    let job = |boundary: &str| {
        format!("{CUBE}{STEEL}{ROLLERS}*STEP, NLGEOM=YES\n*STATIC, DIRECT\n0.1, 1.\n*BOUNDARY\n{boundary}*END STEP\n")
    };
    let (case, _) = imported(&desk, &job("RIGHT, 1, 1, 1.0\n"));
    assert_eq!((&case["nlgeom"], &case["measure"]), (&json!(true), &json!("nominal")));
    assert_eq!(case["steps"][0]["target"]["e11"], 0.5);
    // a shear of the top along 1, everything else held
    let held = "ALL, 2, 3\nBOTTOM, 1\n5, 1, 1, 0.8\n6, 1, 1, 0.8\n7, 1, 1, 0.8\n8, 1, 1, 0.8\n";
    let sheared = job(held).replace("LEFT, 1\n", "");
    let (case, _) = imported(&desk, &sheared);
    assert_eq!(case["steps"][0]["F"], json!([[1.0, 0.0, 0.2], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]));
    let free = sheared.replace("ALL, 2, 3", "ALL, 2");
    let words = refused(&desk, &free);
    assert!(words.contains("nodes are free along 1 or 3"), "{words}");
    let words = refused(&desk, &free.replace("BOTTOM, 3\n", "1, 3\n"));
    assert!(words.contains("its rotation is not known"), "{words}");
    let small = sheared.replace(", NLGEOM=YES", "");
    let (case, _) = imported(&desk, &small);
    assert_eq!(case["steps"][0]["target"]["g13"], 0.2);
}

#[test]
fn what_is_no_material_point_is_refused_with_its_line() {
    let desk = Desk::new();
    let end = "*STEP\n*STATIC\n0.5, 1.\n*BOUNDARY\nRIGHT, 1, 1, 0.002\n*END STEP\n";
    let job = format!("{CUBE}{STEEL}{ROLLERS}{end}");
    for (from, to, words) in [
        ("7, 2., 2., 4.", "7, 2., 2.1, 4.", "is no box"),
        ("5, 6, 7, 8\n", "5, 6, 7, 8\n2, 1, 2, 3, 4, 5, 6, 7, 8\n", "a second element"),
        ("C3D8R", "C3D10", "C3D10 make no material point"),
        ("RIGHT, 1, 1, 0.002", "2, 1, 1, 0.002\n3, 1, 1, 0.003", "of no uniform strain"),
        ("RIGHT, 1, 1", "WRONG, 1, 1", "there is no node set WRONG"),
        ("RIGHT, 1, 1, 0.002", "RIGHT, 1, 1, O.002", "'O.002' is no number"),
        ("*STEP", "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nLEFT, 20.\nRIGHT, 30.\n*STEP", "not the same at all nodes"),
        ("*STATIC", "*DYNAMIC", "*DYNAMIC makes it another problem"),
        ("*STEP", "*EQUATION\n2\n2, 1, 1., 3, 1, -1.\n*STEP", "*EQUATION makes it another problem"),
        ("*BOUNDARY\nRIGHT", "*BOUNDARY, AMPLITUDE=A\nRIGHT", "there is no amplitude A"),
        ("*BOUNDARY\nRIGHT, 1, 1, 0.002", "*CLOAD\n2, 1, 5.", "make no uniform stress"),
        ("MATERIAL=STEEL", "MATERIAL=TIN", "has no *USER MATERIAL TIN; there is STEEL"),
        ("*STEP", "*INCLUDE, INPUT=gone.inp\n*STEP", "gone.inp"),
    ] {
        let wrong = job.replacen(from, to, 1);
        assert_ne!(wrong, job, "{from}");
        let found = refused(&desk, &wrong);
        assert!(found.contains(words) && found.starts_with("job.inp:"), "{words}: {found}");
    }
    // what only narrows the job is named
    let (case, left_out) = imported(&desk, &job.replace(end, &format!("*ORIENTATION, NAME=O\n1., 0., 0.\n{end}")));
    assert!(left_out.contains("*ORIENTATION") && left_out.contains("automatic increments"), "{left_out}");
    let description = case["description"].as_str().expect("a text");
    assert!(description.starts_with("Imported from job.inp. Not imported: job.inp:"), "{description}");
}

/// A displacement that is there from the first increment on, and a temperature that is taken away again.
#[test]
fn a_job_that_jumps_gives_its_stress_in_the_first_increment() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let expansion = "*EXPANSION\n1.E-5,\n";
    let job = format!(
        "{CUBE}{STEEL}{expansion}*AMPLITUDE, NAME=A\n0., 1., 1., 1.\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, \
         20.\n{ROLLERS}*STEP\n*STATIC, DIRECT\n0.1, 1.\n*BOUNDARY, AMPLITUDE=A\nRIGHT, 1, 1, 0.002\n*END \
         STEP\n*STEP\n*STATIC, DIRECT\n0.3, 1.\n*BOUNDARY, OP=NEW\nLEFT, 1\nFRONT, 2\nBOTTOM, 3\n*TEMPERATURE\nALL, \
         120.\n*END STEP\n*STEP\n*STATIC\n1., 1.\n*TEMPERATURE, OP=NEW\n*END STEP\n"
    );
    desk.write("job.inp", &job);
    let plugin = library.as_str().expect("a path");
    desk.pullout(["import", "job.inp", "--plugin", plugin, "-o", "jump.json"]).expect(0);
    let history = desk.run(&desk.path("jump.json"), &[], "out", 0).history;
    let (times, stresses, strains) = (history.column("time"), history.column("s11"), history.column("e11"));
    let at = |time: f64| times.iter().position(|other| (other - time).abs() < 1e-9).expect("a row");
    for time in [0.1, 0.5, 1.0] {
        close(stresses[at(time)], 200e3 * 1e-3);
    }
    // the reaction goes to 0 along a line over four increments, the temperature along one over the time
    close(stresses[at(1.3)], 200e3 * 1e-3 * 0.75);
    close(strains[at(1.3)], 1e-3 * 0.75 + 1e-5 * 30.0);
    close(stresses[at(2.0)], 0.0);
    close(strains[at(2.0)], 1e-5 * 100.0);
    close(strains[at(3.0)], 0.0);
}

/// A cube of rubber that is pulled to one and a half times its length between frictionless rollers, or with free faces.
#[test]
fn a_job_with_large_deformations_gives_the_stress_of_the_closed_form() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    let (mu, kappa, stretch) = (0.8, 40.0, 1.5_f64);
    let rubber = format!("*MATERIAL, NAME=STEEL\n*USER MATERIAL, CONSTANTS=2\n {mu}, {kappa}\n");
    let confined = "*BOUNDARY\nALL, 2, 3\n";
    let ran = |confined: &str| {
        let job = format!(
            "{CUBE}{rubber}{ROLLERS}*STEP, NLGEOM=YES\n*STATIC, DIRECT\n0.1, 1.\n*BOUNDARY\nRIGHT, 1, 1, \
             {}\n{confined}*END STEP\n",
            2.0 * (stretch - 1.0)
        );
        desk.write("job.inp", &job);
        desk.pullout(["import", "job.inp", "--plugin", library.as_str().expect("a path"), "-o", "rubber.json"])
            .expect(0);
        let history = desk.run(&desk.path("rubber.json"), &[], "out", 0).history;
        std::fs::remove_file(desk.path("rubber.json")).expect("a case");
        history
    };
    // Cauchy's stresses of stretches
    let stress = |stretches: [f64; 3]| {
        let volume: f64 = stretches.iter().product();
        let squares = stretches.map(|stretch| (stretch * volume.powf(-1.0 / 3.0)).powi(2));
        let mean = squares.iter().sum::<f64>() / 3.0;
        squares.map(|square| mu * (square - mean) / volume + kappa * (volume - 1.0))
    };
    let held = ran(confined);
    close(held.last("e11"), stretch - 1.0);
    // force per area before the deformation
    let [along, across, _] = stress([stretch, 1.0, 1.0]);
    close(held.last("s11"), along);
    close(held.last("s22"), across * stretch);
    let free = ran("");
    let across = 1.0 + free.last("e22");
    let [along, aside, _] = stress([stretch, across, across]);
    assert!(aside.abs() < 1e-8 && across < 1.0, "{aside}");
    close(free.last("s11"), along * across * across);
}

/// A foreign UMAT does not report its thickness. What a sheet cannot have is named, and the case runs.
#[test]
fn large_deformations_of_a_sheet_are_named_as_left_out() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let job = format!(
        "*NODE\n1, 0., 0.\n2, 1., 0.\n3, 1., 1.\n4, 0., 1.\n*ELEMENT, TYPE=CPS4, ELSET=E\n1, 1, 2, 3, 4\n*SOLID SECTION, \
         ELSET=E, MATERIAL=STEEL\n1.\n{STEEL}*BOUNDARY\n1, 1, 2\n4, 1\n2, 2\n*STEP, NLGEOM\n*STATIC, DIRECT\n0.5, \
         1.\n*BOUNDARY\n2, 1, 1, 0.001\n3, 1, 1, 0.001\n*END STEP\n"
    );
    desk.write("job.inp", &job);
    let plugin = library.as_str().expect("a path");
    let outcome = desk.pullout(["import", "job.inp", "--plugin", plugin, "-o", "sheet.json"]).expect(0);
    assert!(outcome.stderr.contains(&line_of(&job, "*STEP, NLGEOM")), "{}", outcome.stderr);
    let history = desk.run(&desk.path("sheet.json"), &[], "out", 0).history;
    close(history.last("s11"), 200e3 * 1e-3);
}

/// A temperature given to one node is not that of the element.
#[test]
fn a_temperature_of_some_nodes_is_refused() {
    let desk = Desk::new();
    for (nodes, is_whole) in [("ALL", true), ("RIGHT", false), ("1", false)] {
        let job = format!(
            "{CUBE}{STEEL}*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n{ROLLERS}*STEP\n*STATIC, DIRECT\n1., \
             1.\n*TEMPERATURE\n{nodes}, 60.\n*END STEP\n"
        );
        if is_whole {
            assert_eq!(imported(&desk, &job).0["steps"][0]["temperature"], 60.0);
        } else {
            let words = refused(&desk, &job);
            assert!(
                words.contains(&line_of(&job, &format!("{nodes}, 60."))) && words.contains("some nodes"),
                "{words}"
            );
        }
    }
}

#[test]
fn expansion_and_orientation_of_a_job_become_those_of_the_case() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "lamina.f90", &[]) else { return };
    let cube = CUBE.replace("MATERIAL=STEEL", "MATERIAL=PLY, ORIENTATION=ORI");
    let job = format!(
        "{cube}*ORIENTATION, NAME=ORI\n0., 1., 0., -1., 0., 0.\n*MATERIAL, NAME=PLY\n*DEPVAR\n1,\n*EXPANSION, TYPE=ORTHO, \
         ZERO=20.\n1.E-6, 3.E-5, 3.E-5, 0.\n3.E-6, 4.E-5, 4.E-5, 100.\n*USER MATERIAL, CONSTANTS=9\n140.E3, 10.E3, 10.E3, 0.3, 0.3, \
         0.45, 5.E3, 5.E3\n3.5E3\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 50.\n{ROLLERS}*STEP\n*STATIC, DIRECT\n0.5, \
         1.\n*TEMPERATURE\nALL, 100.\n*END STEP\n"
    );
    let (mut case, left_out) = imported(&desk, &job);
    assert!(!left_out.contains("EXPANSION") && !left_out.contains("ORIENTATION"), "{left_out}");
    case["material"]["plugin"] = library;
    let history = super::run(&desk, "job", &case).history;
    // local axis 1 is along 2: α₁(100) 80 − α₁(50) 30
    close(history.last("e22"), 3e-6 * 80.0 - 2e-6 * 30.0);
    close(history.last("e11"), 4e-5 * 80.0 - 3.5e-5 * 30.0);
    close(history.last("s11"), 0.0);
}

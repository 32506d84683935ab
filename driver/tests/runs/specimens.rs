//! Results of a specimen's run: fields for ParaView, pictures, summary, report, and replays of failed runs.

use crate::program::{self, Desk, Run, command, json, xml_of_fields};
use end_to_end_tests::worst;
use serde_json::{Value, json};
use std::io::Read;
use std::path::Path;
use std::time::{Duration, Instant};

/// A coarse fibre in elastic concrete, pulled in two steps past the peak of its bond.
fn fibre() -> Value {
    let elastic =
        |modulus: f64| json!({ "material": { "plugin": "linear_elastic", "props": { "E": modulus, "nu": 0.2 } } });
    json!({
        "kind": "pullout",
        "title": "A coarse fibre",
        "mesh": { "specimen": program::coarse_fibre() },
        "parts": { "fibre": elastic(210e3), "matrix": elastic(23.7e3) },
        "contact": { "law": { "plugin": "bond_slip", "props": { "k_e": 400.0 } } },
        "steps": [
            { "slip": 0.03, "increments": { "initial": 0.01, "maximum": 0.1 } },
            { "slip": 0.2, "increments": { "initial": 0.01, "maximum": 0.2 } },
        ],
        "output": { "vtu": 5 },
    })
}

/// A plate with a hole, pulled; the law of its points as given.
fn plate(material: Value, end: f64, increments: u32) -> Value {
    json!({
        "kind": "pullout",
        "title": "A plate",
        "mesh": { "specimen": { "type": "plate_with_hole", "cells": 6, "element": "Q4" } },
        "parts": { "plate": { "material": material } },
        "grip": { "nodes": "top", "direction": [0, 1], "lateral": "free" },
        "steps": [ { "slip": end, "increments": increments } ],
        "output": { "vtu": 2 },
    })
}

/// Times of the data sets of a series, each file of which is there and can be read.
fn series(folder: &Path) -> Vec<(f64, String)> {
    let text = std::fs::read_to_string(folder.join("fields.pvd")).expect("a series");
    let document = roxmltree::Document::parse(&text).expect("XML");
    let sets = document.descendants().filter(|node| node.has_tag_name("DataSet"));
    let attribute = |node: roxmltree::Node<'_, '_>, name: &str| node.attribute(name).expect("an attribute").to_owned();
    sets.map(|node| {
        let file = attribute(node, "file");
        roxmltree::Document::parse(&xml_of_fields(&folder.join(&file))).expect("XML");
        (attribute(node, "timestep").parse().expect("a time"), file)
    })
    .collect()
}

fn exists(run: &Run, names: &[&str]) {
    for name in names {
        let path = run.folder.join("plots").join(format!("{name}.svg"));
        let svg = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        roxmltree::Document::parse(&svg).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

/// The stress in the fibre's free length is the load over its section, and its plastic strain is the stress beyond
/// first yield over the hardening.
#[test]
fn a_run_reports_when_its_fibre_ruptures_and_shows_the_moments_that_are_asked_for() {
    const YIELD: f64 = 150.0;
    const HARDENING: f64 = 2100.0;
    let desk = Desk::new();
    let mut case = fibre();
    case["parts"]["fibre"]["material"] = json!({
        "plugin": "j2_plasticity",
        "props": { "E": 210e3, "nu": 0.3, "hardening": [[YIELD, 0], [YIELD + HARDENING, 1]] },
    });
    case["output"] = json!({ "vtu": 1000, "pictures_at": [0.05, 5.0], "rupture_strain": 0.004 });
    let run = desk.run(&desk.case("case.json", &case), &[], "out", 0);
    let [slip, load, strain, stress] =
        ["slip", "load", "plastic_strain_max", "stress_max"].map(|name| run.history.column(name));
    let section = std::f64::consts::FRAC_PI_4 * 0.406 * 0.406;
    let mut greatest = 0.0_f64;
    for row in 1..slip.len() {
        let mean = load[row] / section;
        greatest = greatest.max(mean);
        // near the exit the bond stresses the edges of the fibre more than its middle, until they yield
        let most = if mean > YIELD { 1.06 } else { 1.25 };
        assert!((0.999..most).contains(&(stress[row] / mean)), "{} MPa, {mean} on the mean", stress[row]);
        let flow = (greatest - YIELD).max(0.0) / HARDENING;
        assert!(strain[row] >= 0.999 * flow && strain[row] < 1.06 * flow + 0.002, "{} of {flow}", strain[row]);
    }
    let mean = run.history.column("axial_strain_max");
    let row = mean.iter().position(|strain| *strain > 0.004).expect("it is strained beyond that");
    let rupture = &run.summary["ruptures"]["fibre"];
    assert_eq!([&rupture["slip"], &rupture["load"]].map(Value::as_f64), [Some(slip[row]), Some(load[row])]);
    exists(&run, &["deformed_mesh_at_1", "principal_stress_max_at_1", "deformed_mesh"]);
    assert!(!run.folder.join("plots/deformed_mesh_at_2.svg").exists(), "the slip did not reach 5 mm");
    assert!(
        run.summary["warnings"].to_string().contains("did not reach a slip of 5 mm"),
        "{}",
        run.summary["warnings"]
    );
    let first = slip.iter().position(|slip| *slip >= 0.05).expect("a row");
    let time = run.history.column("time")[first];
    assert!(series(&run.folder).iter().any(|(other, _)| (other - time).abs() < 1e-12), "no fields at {time}");
    let picture = std::fs::read_to_string(run.folder.join("plots/deformed_mesh_at_1.svg")).expect("a picture");
    assert!(picture.contains("at 0.05 mm"));
}

/// Tensile strength of the wires that break, MPa, and their elongation at it.
const STRENGTH: f64 = 400.0;
const ELONGATION: f64 = 0.03;

/// A wire that bond holds until it breaks. True stresses: f_u (1 + A_gt) at ln(1 + A_gt), and from there on `slope` times that stress, of
/// which 1 keeps the force.
fn wire(specimen: Value, slope: f64) -> Value {
    let mut case = fibre();
    case["mesh"]["specimen"] = specimen;
    case["nlgeom"] = json!(true);
    case["parts"]["matrix"]["nlgeom"] = json!(false);
    let [stress, strain] = [STRENGTH * (1.0 + ELONGATION), ELONGATION.ln_1p()];
    let hardening = json!([[360, 0], [stress, strain], [(1.0 + slope) * stress, 1.0 + strain]]);
    case["parts"]["fibre"] = json!({ "strength": STRENGTH,
        "material": { "plugin": "j2_plasticity", "props": { "E": 210e3, "nu": 0.3, "hardening": hardening } } });
    case["contact"]["law"]["props"] = json!({ "law": "A", "normal_law": "hard", "p_0": 1000, "k_e": 4000, "form": "piecewise",
        "points": [[0.005, 20], [9, 20]] });
    case["steps"] = json!([{ "slip": 1.5 }]);
    case
}

/// A straight fibre at an angle, pulled outside of its block.
fn inclined(angle: f64) -> Value {
    json!({ "type": "inclined_fibre", "angle_deg": angle, "mesh_size": 3, "embedded_length": 6, "depth": 8, "width": 12, "free_length": 2 })
}

/// A run of a wire that breaks, with its greatest and its last load over A f_u.
fn broken(desk: &Desk, case: &Value) -> (Run, [f64; 2]) {
    let run = desk.run(&desk.case("case.json", case), &[], "out", 0);
    let load = run.history.column("load");
    let last = run.summary["ruptures"]["fibre"]["load"].as_f64().expect("it breaks");
    assert_eq!(load.last().copied(), Some(last), "it is the last row");
    assert!(run.summary["warnings"].to_string().contains("the wire breaks"), "{}", run.summary["warnings"]);
    let greatest = load.iter().copied().fold(0.0, f64::max);
    let force = STRENGTH * std::f64::consts::FRAC_PI_4 * 0.406 * 0.406;
    (run, [greatest / force, last / force])
}

/// The greatest force of a wire is its strength times its initial area, along the pull and bent over the exit; what is bent there is
/// strained three times as much as the wire that breaks.
#[test]
fn a_wire_breaks_at_its_strength_and_bending_is_no_rupture() {
    let desk = Desk::new();
    for (specimen, least_strain) in [(program::coarse_fibre(), 0.0), (inclined(30.0), 0.09), (inclined(45.0), 0.09)] {
        let mut case = wire(specimen, 1.0);
        case["parts"]["fibre"]["elongation"] = json!(ELONGATION);
        let (run, [greatest, _]) = broken(&desk, &case);
        assert!((greatest - 1.0).abs() < 0.02, "{greatest}");
        let bending = run.history.column("plastic_strain_max");
        assert!(bending.last().is_some_and(|strain| *strain > least_strain), "{bending:?}");
    }
}

/// An elastic wire breaks under strength × area, whatever the increments: the one in which it breaks is shortened to the break.
#[test]
fn an_increment_ends_where_the_wire_breaks() {
    let desk = Desk::new();
    for (number, strength) in [20.0, 50.0, 100.0, 185.0].into_iter().enumerate() {
        for increments in [json!(7), json!({ "initial": 0.02, "maximum": 0.3 })] {
            let mut case = wire(program::coarse_fibre(), 1.0);
            case["nlgeom"] = json!(false);
            let elastic = json!({ "plugin": "linear_elastic", "props": { "E": 210e3, "nu": 0.3 } });
            case["parts"]["fibre"] = json!({ "strength": strength, "material": elastic });
            case["steps"] = json!([{ "slip": 0.2, "increments": increments }]);
            let name = format!("{number}-{}", increments.is_number());
            let run = desk.run(&desk.case("case.json", &case), &[], &name, 0);
            let load = run.summary["ruptures"]["fibre"]["load"].as_f64().expect("it breaks");
            let force = strength * std::f64::consts::FRAC_PI_4 * 0.406 * 0.406;
            assert!((load / force - 1.0).abs() < 2e-3, "{strength} MPa, {increments}: {load} N, not {force} N");
        }
    }
}

/// A wire that necks at 400 MPa breaks there, though its strength is said to be 420 MPa: it does not go on as a pull-out.
#[test]
fn a_wire_that_necks_below_its_strength_breaks() {
    let mut case = wire(program::coarse_fibre(), 1.0);
    case["parts"]["fibre"]["strength"] = json!(420);
    let (_, [_, last]) = broken(&Desk::new(), &case);
    assert!((last - 1.0).abs() < 0.02, "{last}");
}

/// Bent over the exit a wire is stretched beyond its uniform elongation, where it carries (1 + h x) e^−x of its strength with a slope of h
/// and a strain of x in excess: what it breaks at depends on its law there, 17 % below with half the slope. Along the pull a wire breaks by
/// Considère's construction at its uniform elongation, and the law beyond it has no part in that.
#[test]
fn a_wire_bent_over_the_exit_breaks_by_its_law_beyond_uniform_elongation() {
    let desk = Desk::new();
    let of = |specimen: Value| {
        [0.5, 1.0, 5.0].map(|slope| {
            let mut case = wire(specimen.clone(), slope);
            case["steps"] = json!([{ "slip": 0.5, "increments": { "initial": 0.005, "maximum": 0.01 } }]);
            broken(&desk, &case).1[0]
        })
    };
    let [straight, bent] = [of(program::coarse_fibre()), of(inclined(45.0))];
    assert!(straight.iter().all(|part| (part - 1.0).abs() < 0.01), "{straight:?}");
    assert!(bent[0] < 0.9 && bent[1] < bent[2] - 0.01 && (bent[2] - 1.0).abs() < 0.01, "{bent:?}");
}

/// The wire presses the concrete with no more than k f_c on its diameter, however the edges of its bends turn, and what it crushes is
/// neither lost work nor an overlap of bodies.
#[test]
fn a_hooked_fibre_crushes_the_concrete_under_it() {
    let desk = Desk::new();
    desk.pullout(["new", "hooked-fibre"]).expect(0);
    let settings = ["steps.0.slip=0.25", "contact.bearing=2", "mesh.specimen.mesh_size=3", "output.plots=false"];
    let run = desk.run(&desk.path("hooked.json"), &settings, "out", 0);
    let pressure = run.history.column("bearing_pressure_max");
    let borne = 2.0 * 33.01;
    assert!(pressure.iter().all(|pressure| *pressure < 1.001 * borne), "{pressure:?}");
    assert!(pressure.last().is_some_and(|pressure| *pressure > 0.999 * borne), "{pressure:?}");
    let error = run.summary["energy_error_max"].as_f64().expect("a number");
    assert!(error < 1e-3, "{error:e}");
    assert_eq!(run.summary["warnings"], json!([]));
    assert!(run.summary["notes"].to_string().contains("k = 2,"), "{}", run.summary["notes"]);
}

#[test]
fn a_pull_out_leaves_fields_pictures_summary_and_report() {
    let desk = Desk::new();
    let run = desk.run(&desk.case("case.json", &fibre()), &[], "out", 0);
    let (steps, increments) = (run.history.column("step"), run.history.column("increment"));
    let times = run.history.column("time");
    let rows = times.len();
    let is_due = |k: usize| increments[k] % 5.0 == 0.0 || k + 1 == rows || steps[k + 1] != steps[k];
    let due: Vec<f64> = (0..rows).filter(|&k| is_due(k)).map(|k| times[k]).collect();
    let sets = series(&run.folder);
    let of = |prefix: &str| -> Vec<f64> {
        sets.iter().filter(|(_, file)| file.starts_with(prefix)).map(|(time, _)| *time).collect()
    };
    assert_eq!((of("fields/0"), of("fields/contact_")), (due.clone(), due));
    exists(
        &run,
        &[
            "load_slip",
            "energies",
            "iterations",
            "points",
            "axial_stress",
            "interface_shear",
            "interface_pressure",
            "deformed_mesh",
            "deformed_mesh_exit",
            "deformed_mesh_peak",
            "principal_stress_max",
            "principal_stress_max_exit_peak",
            "principal_stress_min_peak",
            "principal_stress_min_exit",
            "principal_directions",
            "principal_directions_exit_peak",
            "active_zone",
            "active_zone_exit_peak",
        ],
    );
    let load = run.history.column("load");
    let greatest = (0..rows).max_by(|&a, &b| load[a].total_cmp(&load[b])).expect("a row");
    let peak = &run.summary["peak_load"];
    assert_eq!(peak["load"].as_f64(), Some(load[greatest]));
    assert_eq!(peak["slip"].as_f64(), Some(run.history.column("slip")[greatest]));
    assert!(greatest + 1 < rows, "the run goes on beyond the peak");
    let statistic = |name: &str| run.summary["statistics"][name].as_u64().unwrap_or_else(|| panic!("{name}"));
    assert!(statistic("contact_law_calls") > 0 && statistic("umat_calls") > 0);
    let calls = statistic("contact_law_calls") + statistic("umat_calls");
    assert_eq!(run.summary["plugin_calls"].as_u64(), Some(calls));
    assert_eq!(run.summary["energies"]["external_work"].as_f64(), Some(run.history.last("external_work")));
    let errors = run.history.column("energy_error");
    let worst = worst(errors.iter().map(|error| error.abs()));
    assert_eq!(run.summary["energy_error_max"].as_f64(), Some(worst));
    assert!(run.summary.get("failure").is_none());
    let report = std::fs::read_to_string(run.folder.join("report.html")).expect("a report");
    for text in ["Greatest load", "Energies at the end", "Penalties of contact", "Skipping", "interface_left", "<svg"] {
        assert!(report.contains(text), "{text}");
    }
    let drawn = desk.pullout(["plot", "out"]).expect(0).stdout;
    assert!(drawn.contains("load_slip.svg"), "{drawn}");
    // into another folder the fields come along
    desk.pullout(["plot", "out", "--pdf", "--out", "paper"]).expect(0);
    for picture in ["load_slip", "deformed_mesh_peak", "principal_stress_max_peak"] {
        let pdf = std::fs::read(desk.path(&format!("paper/{picture}.pdf"))).expect(picture);
        assert!(pdf.starts_with(b"%PDF-"), "{picture}");
    }
    // in motion: frames of the same specimen, which a reader of GIF finds
    assert!(desk.pullout(["animate", "out", "--frames", "8"]).expect(0).stdout.contains("animation.gif"));
    let file = std::fs::read(desk.path("out/plots/animation.gif")).expect("an animation");
    let mut decoder = gif::DecodeOptions::new().read_info(&file[..]).expect("a GIF");
    let frames = std::iter::from_fn(|| decoder.read_next_frame().expect("a frame").map(|frame| frame.buffer.len()));
    assert_eq!(frames.count(), 8);
    let refused = desk.pullout(["animate", "out", "--field", "humidity"]).expect(2).stderr;
    assert!(refused.contains("principal stress, greatest"), "{refused}");
    desk.pullout(["animate", "out", "--view", "1,0,0,1"]).expect(2);
    assert!(desk.pullout(["animate", "paper"]).expect(2).stderr.contains("report.html"));
    // runs that are overlaid leave the pictures of the first as they are
    let own = |name: &str| std::fs::read(run.folder.join(name)).expect("a picture");
    let before = own("plots/load_slip.svg");
    desk.pullout(["plot", "out", "out"]).expect(0);
    assert!(own("plots/load_slip.svg") == before && own("compared/load_slip.svg") != before);
    // and are drawn again, next to results that can be replaced
    desk.pullout(["plot", "out", "out"]).expect(0);
    desk.pullout(["plot", "out"]).expect(0);
}

/// What the viewer of a report reads: its head, and the numbers.
fn viewer(folder: &Path) -> (Value, Vec<u8>) {
    let page = std::fs::read_to_string(folder.join("report.html")).expect("a report");
    let part = |class: &str| {
        let from = page.split_once(&format!("<script class=\"{class}\"")).expect("a script").1;
        from.split_once('>').and_then(|(_, rest)| rest.split_once("</script>")).expect("its end").0
    };
    let packed = base64::Engine::decode(&base64::engine::general_purpose::STANDARD, part("data")).expect("base64");
    let mut data = Vec::new();
    flate2::read::DeflateDecoder::new(packed.as_slice()).read_to_end(&mut data).expect("deflated");
    (serde_json::from_str(part("head")).expect("JSON"), data)
}

/// A plate that is pulled upwards tears from its hole along the x-axis: the lines lie across the pull, there and open.
#[test]
fn a_torn_point_is_an_open_crack_across_the_pull() {
    let desk = Desk::new();
    let concrete = json!({ "plugin": "pure_damage", "props": { "E": 3e4, "nu": 0.2 } });
    let run = desk.run(&desk.case("case.json", &plate(concrete, 0.01, 20)), &[], "out", 0);
    let (head, data) = viewer(&run.folder);
    let count = |value: &Value| value.as_u64().expect("a count") as usize;
    let frames = head["frames"].as_array().expect("frames");
    let cracks: Vec<usize> = frames.iter().map(|frame| count(&frame["cracks"])).collect();
    assert!(cracks[0] == 0 && cracks.is_sorted() && *cracks.last().expect("frames") > 0, "{cracks:?}");
    let contacts: usize = frames.iter().map(|frame| count(&frame["contacts"])).sum();
    let words = 2 * count(&head["nodes"]) + 3 * count(&head["triangles"]) + 2 * count(&head["edges"]) + 6 * contacts;
    let all: usize = cracks.iter().sum();
    let lines = data[4 * words..][..24 * all].as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
    let lines: Vec<f32> = lines.collect();
    for [x, y, _, v, a, b] in lines.as_chunks::<6>().0 {
        assert!(*x > 0.0 && *y > 0.0 && *v > 0.0, "a quarter of the plate, pulled up: {x} {y} {v}");
        assert!(a.abs() > b.abs(), "{a} {b} at {x} {y}");
    }
}

/// The viewer's states are rows of the history, from the first to the last, and its numbers are as many as its head says.
#[test]
fn the_report_shows_states_over_the_run() {
    let desk = Desk::new();
    let run = desk.run(&desk.case("case.json", &fibre()), &[], "out", 0);
    let (head, data) = viewer(&run.folder);
    let count = |key: &str| head[key].as_u64().expect("a count") as usize;
    let frames = head["frames"].as_array().expect("frames");
    let (slips, loads) = (run.history.column("slip"), run.history.column("load"));
    // a peak that was not kept anyway comes besides
    assert!((10..=25).contains(&frames.len()), "{}", frames.len());
    let point_of = |frame: &Value| [&frame["slip"], &frame["load"]].map(|value| value.as_f64().expect("a number"));
    assert_eq!(point_of(&frames[0]), [slips[0], loads[0]]);
    assert_eq!(point_of(&frames[frames.len() - 1]), [*slips.last().expect("rows"), *loads.last().expect("rows")]);
    let is_row = |frame: &Value| slips.iter().zip(&loads).any(|(slip, load)| point_of(frame) == [*slip, *load]);
    assert!(frames.iter().all(is_row));
    // it opens at the greatest load of the run, and says so
    let peak = loads.iter().copied().fold(0.0, f64::max);
    let opened = &frames[count("opensAt")];
    assert_eq!((point_of(opened)[1], opened["name"].as_str()), (peak, Some("peak")));
    assert_eq!((frames[0]["name"].as_str(), frames[frames.len() - 1]["name"].as_str()), (Some("start"), Some("end")));
    // steel and concrete each have their range: one is stressed at least ten times as much
    let parts: Vec<&str> = head["parts"].as_array().expect("parts").iter().filter_map(Value::as_str).collect();
    let greatest = |name: &str| {
        let part = parts.iter().position(|part| *part == name).expect("the part");
        head["fields"][0]["ranges"][part][1].as_f64().expect("a number")
    };
    assert!(greatest("fibre") > 10.0 * greatest("matrix"), "{} {}", greatest("fibre"), greatest("matrix"));
    let contacts: usize = frames.iter().map(|frame| frame["contacts"].as_u64().expect("a count") as usize).sum();
    let fields = head["fields"].as_array().expect("fields").len();
    assert_eq!(fields, 2, "the concrete is elastic");
    let (nodes, states) = (count("nodes"), frames.len());
    let cracks = |frame: &Value| frame["cracks"].as_u64().expect("a count");
    assert!(frames.iter().all(|frame| cracks(frame) == 0), "the concrete is elastic");
    let words = 2 * nodes + 3 * count("triangles") + 2 * count("edges") + 6 * contacts;
    assert_eq!(data.len(), 4 * words + 2 * nodes + 2 * states * nodes * (2 + fields));
}

#[test]
fn fields_and_pictures_can_be_switched_off() {
    let desk = Desk::new();
    let material = json!({ "plugin": "linear_elastic" });
    let overrides = ["output.vtu=false", "output.plots=false"];
    let run = desk.run(&desk.case("case.json", &plate(material, 1e-3, 1)), &overrides, "out", 0);
    assert!(!run.folder.join("fields.pvd").exists() && !run.folder.join("plots").exists());
    assert!(run.summary["peak_load"]["load"].as_f64() > Some(0.0));
}

#[test]
fn a_law_that_fails_is_named_with_its_place_and_can_be_replayed() {
    let desk = Desk::new();
    let run = desk.run(&desk.case("case.json", &plate(json!({ "plugin": "panicking" }), 0.05, 100)), &[], "out", 1);
    let failure = &run.summary["failure"];
    assert_eq!(failure["place"]["kind"], "element", "{failure}");
    let [element, point] = ["element", "point"].map(|key| failure["place"][key].as_u64().expect("a number"));
    let message = run.summary["message"].as_str().expect("a message");
    assert!(message.contains(&format!("element {element}, integration point {point}")), "{message}");
    assert!(message.contains("replay.json"), "{message}");
    // what was reached is kept, its fields as well
    let last = run.history.last("time");
    assert!(run.history.rows.len() > 2);
    assert_eq!(series(&run.folder).last().map(|(time, _)| *time), Some(last));
    exists(&run, &["load_slip", "deformed_mesh", "principal_stress_max"]);
    // the point alone fails in the same increment
    let replay = run.folder.join("replay.json");
    desk.pullout(["check".as_ref(), replay.as_os_str()]).expect(0);
    assert_eq!(json(&replay)["initial"]["time"].as_f64(), Some(last));
    let again = desk.run(&replay, &[], "again", 1);
    assert!(again.outcome.stderr.contains("plugin 'panicking', step 1, increment 1"), "{}", again.outcome.stderr);
}

#[test]
fn fields_of_a_killed_run_can_be_opened() {
    let desk = Desk::new();
    let mut case = plate(json!({ "plugin": "linear_elastic" }), 1e-3, 5_000_000);
    case["output"]["vtu"] = json!(1);
    desk.case("case.json", &case);
    let mut child = command()
        .current_dir(desk.path(""))
        .args(["run", "--quiet", "--out", "out", "case.json"])
        .spawn()
        .expect("the program starts");
    let series_file = desk.path("out/fields.pvd");
    let start = Instant::now();
    while std::fs::metadata(&series_file).map_or(0, |file| file.len()) < 1000 {
        assert!(start.elapsed() < Duration::from_secs(60), "no series after a minute");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().expect("the run goes on");
    child.wait().expect("an end");
    assert!(series(&desk.path("out")).len() > 3);
}

/// Increments that the program chooses keep the energies within 0.1 % of the work, also where a law for small strains stores
/// them at large ones; of equal ones that do not the summary says so, with the figure.
#[test]
fn energies_balance_or_the_summary_says_so() {
    let desk = Desk::new();
    let j2 =
        json!({ "plugin": "j2_plasticity", "props": { "E": 200e3, "nu": 0.3, "hardening": [[300, 0], [500, 0.1]] } });
    let elastic = json!({ "plugin": "linear_elastic", "props": { "E": 2000, "nu": 0.3 } });
    for (material, end, bound) in [(j2, 0.05, 1.0), (elastic, 2.0, 1e-2)] {
        for model in ["plane_strain", "plane_stress"] {
            let mut case = plate(material.clone(), end, 10);
            case["nlgeom"] = json!(true);
            case["parts"]["plate"]["model"] = json!(model);
            case["output"]["plots"] = json!(false);
            let outcome_of = |run: &Run| {
                let error = run.summary["energy_error_max"].as_f64().expect("a figure");
                let warnings = run.summary["warnings"].as_array().expect("warnings").clone();
                let warns = warnings.iter().filter_map(Value::as_str).any(|warning| warning.contains("miss the work"));
                (error, warns, warnings)
            };
            let (error, warns, warnings) = outcome_of(&desk.run(&desk.case("case.json", &case), &[], "equal", 0));
            assert!(error < bound && warns == (error > 1e-3), "{model}: {error:e}, {warnings:?}");
            case["steps"][0]["increments"] = json!({});
            let (error, warns, warnings) = outcome_of(&desk.run(&desk.case("case.json", &case), &[], "chosen", 0));
            assert!(error < 1e-3 && !warns, "{model}: {error:e}, {warnings:?}");
        }
    }
}

/// Two elements one above the other with 0.1 mm between them, without a contact pair.
const TWO_BLOCKS: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n2 1 \"lower\"\n2 2 \"upper\"\n1 3 \"held\"\n1 4 \"pushed\"\n\
    $EndPhysicalNames\n$Nodes\n8\n1 0 0 0\n2 2 0 0\n3 2 1 0\n4 0 1 0\n5 0.5 1.1 0\n6 1.5 1.1 0\n7 1.5 2.1 0\n8 0.5 2.1 0\n$EndNodes\n\
    $Elements\n6\n1 3 2 1 1 1 2 3 4\n2 3 2 2 2 5 6 7 8\n3 1 2 3 3 1 2\n4 1 2 3 3 3 4\n5 1 2 4 4 5 6\n6 1 2 4 4 7 8\n$EndElements\n";

#[test]
fn bodies_that_no_contact_pair_keeps_apart_are_found_in_each_other() {
    let desk = Desk::new();
    desk.write("blocks.msh", TWO_BLOCKS);
    let part = json!({ "model": "plane_strain", "thickness": 1, "material": { "plugin": "linear_elastic" } });
    let case = json!({
        "kind": "pullout",
        "mesh": { "file": "blocks.msh" },
        "parts": { "lower": part, "upper": part },
        "grip": { "nodes": "pushed", "direction": [0, -1] },
        "supports": { "held": {} },
        "steps": [ { "slip": 0.05, "increments": 1 } ],
        "output": { "vtu": false, "plots": false },
    });
    let case = desk.case("case.json", &case);
    let apart = desk.run(&case, &[], "apart", 0);
    assert_eq!(apart.summary["overlap_max"], json!(0.0));
    let pushed = desk.run(&case, &["steps.0.slip=0.35"], "pushed", 0);
    let depth = pushed.summary["overlap_max"].as_f64().expect("a depth");
    assert!((depth - 0.25).abs() < 1e-12, "{depth}");
    // the shortest outer edge is 1 mm long
    assert_eq!(pushed.summary["overlap_relative"].as_f64(), Some(depth));
    let there = &pushed.summary["overlaps"]["end"];
    assert_eq!((&there["part"], &there["inside"]), (&json!("upper"), &json!("lower")));
    let warning = "part 'upper' lies in part 'lower' by 0.25 mm, 25 % of the shortest outer edge";
    assert!(pushed.summary["warnings"].to_string().contains(warning), "{}", pushed.summary["warnings"]);
    let report = std::fs::read_to_string(pushed.folder.join("report.html")).expect("a report");
    assert!(report.contains("Overlap of deformed bodies at the end: 0.25 mm, upper in lower"), "{report}");
}

/// The penetration of a penalty is p/ε_N everywhere.
#[test]
fn blocks_in_contact_overlap_by_what_their_penalty_lets_through() {
    let desk = Desk::new();
    let case = program::cases().join("verification/contact-patch.json");
    let run = desk.run(&case, &["contact.enforcement=penalty", "output.plots=false"], "out", 0);
    let penalties = run.summary["penalties"].as_object().expect("penalties");
    let penalty = penalties.values().next().and_then(Value::as_f64).expect("one pair");
    let depth = run.summary["overlap_max"].as_f64().expect("a depth");
    assert!((depth * penalty / 10.0 - 1.0).abs() < 1e-6, "{depth} with {penalty}");
}

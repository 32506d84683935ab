//! Cases of kind "pullout" on a mesh file with two bodies.

use super::malformed::Seen::{ByMeaning, BySchema};
use super::malformed::{Sample, check};
use super::{Bench, overridden, schema_accepts};
use crate::Case;
use fe_core::kinematics::PlaneModel;
use fe_core::model::{
    ContactLaw, CrackSurface, Enforcement, FieldKind, Fit, Freedom, HardLaw, Interference, LoadKind, Model, NormalLaw,
    Quadrature, ScalarField, Skipping, SoftLaw, Spalling, StepControl, Width,
};
use pullout_run::pullout::PulloutProgram;
use pullout_run::pullout::fibre::FibreGeometry;
use serde_json::{Value, json};

/// Columns and rows of elements of a body, and its box.
struct Body {
    columns: usize,
    rows: usize,
    low: [f64; 2],
    high: [f64; 2],
    first_node: usize,
}

impl Body {
    fn node(&self, column: usize, row: usize) -> usize {
        self.first_node + row * (self.columns + 1) + column
    }

    fn nodes(&self) -> Vec<[f64; 2]> {
        let along =
            |k: usize, part: usize, of: usize| self.low[k] + (self.high[k] - self.low[k]) * part as f64 / of as f64;
        (0..=self.rows)
            .flat_map(|row| (0..=self.columns).map(move |column| (row, column)))
            .map(|(row, column)| [along(0, column, self.columns), along(1, row, self.rows)])
            .collect()
    }

    fn elements(&self) -> Vec<Vec<usize>> {
        (0..self.rows)
            .flat_map(|row| (0..self.columns).map(move |column| (row, column)))
            .map(|(r, c)| vec![self.node(c, r), self.node(c + 1, r), self.node(c + 1, r + 1), self.node(c, r + 1)])
            .collect()
    }

    fn column(&self, column: usize) -> Vec<Vec<usize>> {
        (0..self.rows).map(|row| vec![self.node(column, row), self.node(column, row + 1)]).collect()
    }

    fn row(&self, row: usize) -> Vec<Vec<usize>> {
        (0..self.columns).map(|column| vec![self.node(column, row), self.node(column + 1, row)]).collect()
    }
}

/// A Gmsh file: a matrix left of x = 0 and a fibre right of it, each 2 mm high, that share no node.
pub(super) fn two_bodies() -> String {
    let matrix = Body { columns: 2, rows: 4, low: [-1.0, 0.0], high: [0.0, 2.0], first_node: 1 };
    let fibre = Body { columns: 1, rows: 4, low: [0.0, 0.0], high: [0.4, 2.0], first_node: 16 };
    let both = |a: Vec<Vec<usize>>, b: Vec<Vec<usize>>| a.into_iter().chain(b).collect();
    let groups: Vec<(usize, &str, Vec<Vec<usize>>)> = vec![
        (2, "matrix", matrix.elements()),
        (2, "fibre", fibre.elements()),
        (1, "hole", matrix.column(2)),
        (1, "surface", fibre.column(0)),
        (1, "side", matrix.column(0)),
        (1, "bottom", matrix.row(0)),
        (1, "grip", fibre.row(4)),
        (1, "fibre_bottom", fibre.row(0)),
        (1, "pieces", both(matrix.row(0), matrix.row(4))),
        (1, "ring", both(both(fibre.column(0), fibre.column(1)), both(fibre.row(0), fibre.row(4)))),
        (0, "exit", vec![vec![fibre.node(0, 4)]]),
        (0, "tail", vec![vec![fibre.node(0, 0)]]),
        (1, "inside", matrix.column(1)),
        (0, "alone", vec![vec![26]]),
    ];
    let nodes: Vec<[f64; 2]> = matrix.nodes().into_iter().chain(fibre.nodes()).chain([[0.2, 2.0]]).collect();
    gmsh(&nodes, &groups)
}

/// A Gmsh file of nodes and physical groups: their dimension, name and elements.
fn gmsh(nodes: &[[f64; 2]], groups: &[(usize, &str, Vec<Vec<usize>>)]) -> String {
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n", groups.len());
    for (tag, (dimension, name, _)) in groups.iter().enumerate() {
        text.push_str(&format!("{dimension} {} \"{name}\"\n", tag + 1));
    }
    text.push_str(&format!("$EndPhysicalNames\n$Nodes\n{}\n", nodes.len()));
    for (k, [x, y]) in nodes.iter().enumerate() {
        text.push_str(&format!("{} {x} {y} 0\n", k + 1));
    }
    let elements: Vec<(usize, usize, &Vec<usize>)> = groups
        .iter()
        .enumerate()
        .flat_map(|(tag, (dimension, _, elements))| elements.iter().map(move |nodes| (*dimension, tag + 1, nodes)))
        .collect();
    text.push_str(&format!("$EndNodes\n$Elements\n{}\n", elements.len()));
    for (k, (dimension, tag, nodes)) in elements.iter().enumerate() {
        // 15: a point, 1: a line, 3: a quadrilateral
        let kind = [15, 1, 3][*dimension];
        let nodes: Vec<String> = nodes.iter().map(ToString::to_string).collect();
        text.push_str(&format!("{} {kind} 2 {tag} {tag} {}\n", k + 1, nodes.join(" ")));
    }
    text.push_str("$EndElements\n");
    text
}

/// The fibre is pulled up along the matrix.
pub(super) fn pullout_case() -> Value {
    json!({
        "kind": "pullout",
        "mesh": { "file": "two.msh" },
        "parts": {
            "matrix": { "material": { "plugin": "linear_elastic", "props": { "E": 23700, "nu": 0.15 } } },
            "fibre": {
                "material": { "plugin": "linear_elastic", "props": { "E": 210e3, "nu": 0.3 } },
                "model": "plane_stress",
                "thickness": 0.3
            }
        },
        "contact": {
            "slave": "hole",
            "master": "surface",
            "law": { "plugin": "bond_slip", "props": { "normal_law": "hard" } },
            "width": 0.6
        },
        "grip": { "direction": "y", "nodes": "grip" },
        "supports": { "side": {} },
        "measure": { "exit": "exit", "tail": [0, 0] },
        "steps": [ { "slip": 0.1 } ]
    })
}

fn accepted(case: &Value, overrides: &[&str]) -> PulloutProgram {
    assert!(schema_accepts(&overridden(case, overrides)), "the schema refuses {overrides:?}");
    match Bench::new().read(case, overrides) {
        Ok(Case::Pullout(program)) => *program,
        Ok(_) => panic!("a case of a specimen"),
        Err(errors) => panic!("{errors}"),
    }
}

/// A mesh has an axis of rotation for all its parts, or for none.
#[test]
fn plane_parts_next_to_round_ones_are_refused() {
    for overrides in [
        ["mesh.specimen.axisymmetric=true", "parts.fibre.model=plane_stress"],
        ["mesh.specimen.axisymmetric=false", "parts.matrix.model=axisymmetric"],
    ] {
        let mut case = specimen_case(json!({ "type": "perpendicular_fibre" }), &["fibre", "matrix"]);
        case["contact"] = json!({ "law": { "plugin": "bond_slip" } });
        case["steps"] = json!([{ "slip": 1 }]);
        let Err(errors) = Bench::new().read(&case, &overrides) else { panic!("{overrides:?} is read") };
        let message = errors.to_string();
        assert!(message.contains(".model") && message.contains("a mesh has an axis"), "{message}");
    }
}

fn program(overrides: &[&str]) -> PulloutProgram {
    accepted(&pullout_case(), overrides)
}

#[test]
fn a_file_and_its_groups_become_a_model() {
    let program = program(&[]);
    let model = &program.model;
    let mesh = &model.mesh;
    assert_eq!((program.mesh.as_str(), mesh.elements().len(), mesh.nodes().len()), ("file two.msh", 12, 26));
    let parts: Vec<_> = mesh.parts().iter().map(|p| (p.name.as_str(), p.model, p.thickness)).collect();
    assert_eq!(parts, [("fibre", PlaneModel::PlaneStress, 0.3), ("matrix", PlaneModel::PlaneStrain, 1.0)]);
    assert_eq!(model.laws.iter().map(|law| law.props[0]).collect::<Vec<_>>(), [210e3, 23700.0]);
    let [pair] = &model.contacts[..] else { panic!("one pair") };
    assert_eq!((pair.name.as_str(), pair.slave.len(), pair.master.len()), ("contact 1", 4, 4));
    assert_eq!((pair.width, pair.quadrature), (Width::Given(0.6), Quadrature::Gauss(2)));
    assert_eq!(pair.enforcement, Enforcement::Uzawa { tolerance: 1e-6, max_updates: 4 });
    assert!(matches!(&pair.law, ContactLaw::Uinter(law) if law.props[3] == 0.0), "the penalty is the pair's to fill");
    assert_eq!(model.drives, ["slip"]);
    let supports: Vec<_> =
        model.supports.iter().map(|s| (s.name.as_str(), s.nodes.len(), s.direction, s.drive)).collect();
    assert_eq!(
        supports,
        [
            ("grip", 2, [0.0, 1.0], Some(0)),
            ("grip, lateral", 2, [-1.0, 0.0], None),
            ("side", 5, [1.0, 0.0], None),
            ("side", 5, [0.0, 1.0], None)
        ]
    );
    let measured = &model.measured;
    assert_eq!((&measured.slip[..], &measured.supports[..]), (&[0][..], &[0][..]));
    assert_eq!(measured.direction, [0.0, 1.0]);
    assert_eq!(measured.exit_node.map(|node| mesh.nodes()[node]), Some([0.0, 2.0]));
    assert_eq!(model.steps[0].targets, [Some(0.1)]);
    assert_eq!(model.steps[0].control, StepControl::Automatic { initial: 1e-3, maximum: 0.02, minimum: 1e-8 });
    assert_eq!((model.skipping, model.nlgeom.clone()), (Skipping::ALL, vec![false; 2]));
    assert!(program.about.warnings.is_empty(), "{:?}", program.about.warnings);
}

#[test]
fn edges_of_a_chain_follow_each_other() {
    let model = program(&[]).model;
    for chain in [&model.contacts[0].slave, &model.contacts[0].master] {
        let nodes: Vec<[usize; 2]> = chain
            .iter()
            .map(|&edge| model.mesh.edge_nodes(edge))
            .map(|edge| [edge.nodes()[0], edge.nodes()[1]])
            .collect();
        assert!(nodes.windows(2).all(|pair| pair[0][1] == pair[1][0]), "{nodes:?}");
    }
}

#[test]
fn steps_drives_and_cycles() {
    let program = program(&[
        "supports.base={\"nodes\": \"fibre_bottom\", \"direction\": [0, 2], \"drive\": \"lift\"}",
        "loads={\"side\": {\"pressure\": 5}, \"own\": {\"nodes\": \"tail\", \"force\": [1, 2], \"drive\": \"lift\"}}",
        "steps=[{\"repeat\": 2, \"steps\": [{\"slip\": 0.1, \"increments\": 7}, {\"slip\": 0, \"time\": 3}]}, \
         {\"drives\": {\"side\": 2, \"lift\": 0.5}, \"increments\": {\"initial\": 0.1}, \
         \"until\": {\"quantity\": \"load\", \"less_than\": -1}}]",
        "until={\"quantity\": \"abs(slip_exit)\", \"greater_than\": 1}",
        "grip.lateral=free",
    ]);
    let model = &program.model;
    assert_eq!(model.drives, ["slip", "lift", "side"]);
    let targets: Vec<_> = model.steps.iter().map(|step| step.targets.clone()).collect();
    let (pulled, back) = (vec![Some(0.1), None, None], vec![Some(0.0), None, None]);
    assert_eq!(targets, [pulled.clone(), back.clone(), pulled, back, vec![None, Some(0.5), Some(2.0)]]);
    assert_eq!(model.steps[0].control, StepControl::Fixed { increments: 7 });
    assert_eq!(model.steps[4].control, StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 1e-8 });
    assert_eq!(model.steps[1].time, 3.0);
    let until = program.step_untils[4].as_ref().expect("until");
    assert_eq!((program.columns()[until.column].as_str(), until.less_than), ("load", Some(-1.0)));
    assert!(
        program
            .about
            .until
            .as_ref()
            .is_some_and(|until| until.absolute && program.columns()[until.column] == "slip_exit")
    );
    let supports: Vec<_> = model.supports.iter().map(|s| (s.name.as_str(), s.direction, s.drive)).collect();
    assert_eq!(supports[..2], [("grip", [0.0, 1.0], Some(0)), ("base", [0.0, 1.0], Some(1))]);
    let pressure = model.loads.iter().find(|load| load.name == "side").expect("the load");
    assert!(matches!(&pressure.kind, LoadKind::Pressure { edges, pressure } if edges.len() == 4 && *pressure == 5.0));
    assert!(
        model
            .loads
            .iter()
            .any(|load| load.drive == 1 && matches!(load.kind, LoadKind::Force { force: [1.0, 2.0], .. }))
    );
}

#[test]
fn contact_in_all_its_forms() {
    let pairs = |overrides: &[&str]| program(overrides).model.contacts;
    let fric = pairs(&["contact.law.entry=fric", "contact.normal={\"hard\": {\"p_0\": 3, \"delta_N\": 0.1}}"]);
    let law = NormalLaw::Hard(HardLaw { p_0: 3.0, delta_n: 0.1 });
    assert!(matches!(&fric[0].law, ContactLaw::Fric { normal, .. } if *normal == law));
    let soft = pairs(&[
        "contact.law.entry=fric",
        "contact.law.props={}",
        "contact.normal={\"soft\": {\"p_0\": 2, \"g_0\": 0.05}}",
    ]);
    let law = NormalLaw::Soft(SoftLaw { p_0: 2.0, g_0: 0.05 });
    assert!(matches!(&soft[0].law, ContactLaw::Fric { normal, .. } if *normal == law));
    let other = pairs(&[
        "contact.quadrature={\"segments\": 3}",
        "contact.width=part",
        "contact.penalty_factor=7",
        "contact.enforcement={\"perturbed_lagrangian\": {\"ratio\": 2e4}}",
        "contact.release=false",
        "contact.name=seam",
    ]);
    assert_eq!((other[0].quadrature, other[0].width), (Quadrature::Segments(3), Width::OfPart));
    assert_eq!((other[0].penalty_factor, other[0].release, other[0].name.as_str()), (7.0, false, "seam"));
    assert_eq!(other[0].enforcement, Enforcement::PerturbedLagrangian { ratio: 2e4 });
    assert_eq!(other[0].fit, Fit::default());
    let closes = |given: &str| pairs(&[&format!("contact.initial_gap={given}")])[0].fit.closes_within;
    assert_eq!(["keep", "close", "{\"close\": 0.02}"].map(closes), [0.0, f64::INFINITY, 0.02]);
    for (given, depth) in [("{\"drive\": \"fit\", \"depth\": 0.01}", Some(0.01)), ("{\"drive\": \"fit\"}", None)] {
        let program = program(&[&format!("contact.interference={given}"), "steps.0.drives={\"fit\": 1}"]);
        let Model { drives, contacts, .. } = &program.model;
        let drive = drives.iter().position(|name| name == "fit").expect("a drive");
        assert_eq!(contacts[0].fit.interference, Some(Interference { drive, depth }));
        assert!(program.about.warnings.is_empty(), "{:?}", program.about.warnings);
    }
    let penalty = pairs(&["contact.enforcement=penalty", "contact.quadrature=nodes"]);
    assert_eq!((penalty[0].enforcement, penalty[0].quadrature), (Enforcement::Penalty, Quadrature::Nodes));
    let mut case = pullout_case();
    case["contact"] = json!([case["contact"].clone()]);
    assert_eq!(accepted(&case, &[]).model.contacts.len(), 1);
    case.as_object_mut().expect("an object").remove("contact");
    assert!(accepted(&case, &[]).model.contacts.is_empty());
}

#[test]
fn a_body_that_nothing_holds_is_named() {
    let mut case = pullout_case();
    case["supports"] = json!({});
    case["contact"] = json!([]);
    let text = Bench::new().read(&case, &[]).map(|_| String::new()).unwrap_or_else(|errors| errors.to_string());
    assert!(
        text.contains("$.supports: the body with element 1 (part 'matrix') can move along x and can move along y"),
        "{text}"
    );
    // supports by name replace all that a specimen has
    let mut case = specimen_case(json!({ "type": "plate_with_hole" }), &["plate"]);
    accepted(&case, &[]);
    case["supports"] = json!({ "symmetry_x": { "direction": "x" } });
    let text = problems_of(&case, &[]);
    assert!(text.ends_with("replace those of the specimen, standard (symmetry_x: x, symmetry_y: y)"), "{text}");
}

/// A minimal case on a specimen.
fn specimen_case(specimen: Value, parts: &[&str]) -> Value {
    let material = json!({ "material": { "plugin": "linear_elastic", "props": { "E": 2e5, "nu": 0.2 } } });
    let parts: serde_json::Map<String, Value> =
        parts.iter().map(|name| ((*name).to_owned(), material.clone())).collect();
    json!({ "kind": "pullout", "mesh": { "specimen": specimen }, "parts": parts, "steps": [{}] })
}

#[test]
fn a_perpendicular_fibre_needs_little_more_than_its_laws() {
    let mut case =
        specimen_case(json!({ "type": "perpendicular_fibre", "embedded_elements": 10 }), &["fibre", "matrix"]);
    case["contact"] = json!({ "law": { "plugin": "bond_slip" } });
    case["steps"] = json!([{ "slip": 12.2 }]);
    let model = accepted(&case, &[]).model;
    assert_eq!(model.contacts.len(), 2);
    let quarter_circumference = std::f64::consts::PI * 0.406 / 2.0;
    assert!(model.contacts.iter().all(|pair| pair.width == Width::Given(quarter_circumference)));
    assert!(model.contacts[0].name != model.contacts[1].name);
    assert_eq!(model.measured.direction, [0.0, 1.0]);
    let position = |node: Option<usize>| node.map(|node| model.mesh.nodes()[node]);
    assert_eq!(position(model.measured.exit_node), Some([0.0, 0.0]));
    assert_eq!(position(model.measured.tail_node).map(|[_, y]| y), Some(-12.2));
    let fibre = model.mesh.parts().iter().find(|part| part.name == "fibre").expect("the part");
    assert_eq!((fibre.model, fibre.thickness), (PlaneModel::PlaneStress, std::f64::consts::PI / 4.0 * 0.406));
    for way in ["sides", "face_near", "face_away", "bottom"] {
        let model = accepted(&case, &[&format!("supports={way}")]).model;
        let supports: Vec<&str> = model.supports.iter().map(|support| support.name.as_str()).collect();
        assert_eq!(supports, ["grip", "grip, lateral", way, way]);
    }
    let about = accepted(&case, &[]).about;
    // what every fibre has is no warning
    assert!(about.warnings.is_empty(), "{:?}", about.warnings);
    let notes = about.notes;
    let round = "fibre: height 0.406 mm, thickness 0.3189 mm; area 1.000 and bending inertia 1.333 of the round one";
    assert_eq!(notes[0], round);
    // over a matrix of 3.26 mm; the slave is the wall of the hole
    for (width, words) in [("0.5", ["0.5000 mm wide", "0.153 of"]), ("part", ["3.2600 mm wide", "1.000 of"])] {
        let notes = accepted(&case, &[&format!("contact.width={width}")]).about.notes;
        let messages: Vec<&String> = notes.iter().filter(|note| note.starts_with("each contact line")).collect();
        assert!(messages.len() == 1 && words.iter().all(|word| messages[0].contains(word)), "{notes:?}");
    }
    let inertia = accepted(&case, &["parts.fibre.thickness=equal_inertia"]);
    let warnings = &inertia.about.warnings;
    assert!(warnings.iter().any(|note| note.contains("area 0.750 and bending inertia 1.000")), "{warnings:?}");
    let inertia = inertia.model;
    let fibre = inertia.mesh.parts().iter().find(|part| part.name == "fibre").expect("the part");
    assert!((fibre.thickness - 3.0 * std::f64::consts::PI * 0.406 / 16.0).abs() < 1e-15);
    let round = accepted(&case, &["mesh.specimen.axisymmetric=true"]).model;
    assert_eq!((round.contacts.len(), round.contacts[0].width), (1, Width::OfPart));
    assert_eq!((round.measured.axis, round.measured.bearing_factor), (Some([0.0, 1.0]), 1.0));
    assert!(round.mesh.parts().iter().all(|part| part.model == PlaneModel::Axisymmetric));
}

#[test]
fn what_contact_leaves_to_defaults_is_reported_once() {
    let defaults = accepted(&inclined_case(), &[]).about.defaults;
    let of_contact: Vec<&String> = defaults.iter().filter(|line| line.starts_with("contact.law.props")).collect();
    let different: std::collections::BTreeSet<&&String> = of_contact.iter().collect();
    assert!(!of_contact.is_empty() && of_contact.len() == different.len(), "{of_contact:?}");
}

#[test]
fn notes_on_fibres_and_lines_name_each_of_them() {
    let fibre = |name: &str, diameter: f64, exit: f64| json!({ "name": name, "diameter": diameter, "exit": exit, "embedded": 6, "path": [{ "straight": 9 }] });
    let unlike = json!({ "type": "fibres", "mesh_size": 2, "cover": false,
                         "fibres": [fibre("a", 0.4, -3.0), fibre("b", 0.5, 3.0)] });
    let mut case = specimen_case(unlike, &["fibre", "matrix"]);
    case["contact"] = json!({ "law": { "plugin": "bond_slip" } });
    case["steps"] = json!([{ "slip": 1 }]);
    let notes = |overrides: &[&str], of: &str| -> Vec<String> {
        let about = accepted(&case, overrides).about;
        let notes = about.notes.into_iter().chain(about.warnings);
        notes
            .filter(|note| note.starts_with(of))
            .map(|note| note.split(';').next().unwrap_or_default().into())
            .collect()
    };
    let thick = ["parts.fibre.thickness=0.3"];
    assert_eq!(
        notes(&thick, "fibre: "),
        ["fibre: height 0.4 mm, thickness 0.3000 mm", "fibre: height 0.5 mm, thickness 0.3000 mm"]
    );
    let widths = notes(&[], "each contact line ");
    assert!(widths.len() == 2 && widths[0].contains("0.6283") && widths[1].contains("0.7854"), "{widths:?}");
}

/// A minimal case of an inclined fibre.
fn inclined_case() -> Value {
    let mut case =
        specimen_case(json!({ "type": "inclined_fibre", "mesh_size": 2, "cover": false }), &["fibre", "matrix"]);
    case["contact"] = json!({ "law": { "plugin": "bond_slip", "props": { "normal_law": "hard", "p_0": 1000 } } });
    case["steps"] = json!([{ "slip": 2 }]);
    case
}

#[test]
fn an_inclined_fibre_may_touch_its_exit_and_separate_there() {
    let case = inclined_case();
    let names = |model: &Model| -> Vec<String> { model.contacts.iter().map(|pair| pair.name.clone()).collect() };
    let props = |model: &Model, name: &str| -> Vec<f64> {
        let pair = model.contacts.iter().find(|pair| pair.name == name).expect("the pair");
        let ContactLaw::Uinter(law) = &pair.law else { panic!("UINTER") };
        law.props.clone()
    };
    let model = accepted(&case, &["nlgeom=true", "parts.matrix.nlgeom=false"]).model;
    assert_eq!(names(&model), ["interface_left", "interface_right", "exit_left", "exit_right"]);
    // the bond's own parameters do not keep the law from surfaces without it
    let mixed = ["nlgeom=true", "parts.matrix.nlgeom=false", "contact.law.props.law=B", "contact.law.props.c_N=3"];
    let mixed = accepted(&case, &mixed).model;
    assert_eq!(["interface_left", "exit_left"].map(|name| props(&mixed, name)[0]), [1.0, 2.0]);
    assert_eq!(model.nlgeom, [true, false]);
    assert_eq!(model.measured.axis, Some(std::f64::consts::FRAC_PI_4.sin_cos().into()));
    assert_eq!(model.measured.interface_lines, [[0], [1]]);
    // what pictures follow: 12.2 mm in the block, the bend of radius 1.5 φ, 3 mm
    let axis = FibreGeometry::of(&model).expect("a fibre").axis;
    let length: f64 = axis.windows(2).map(|ends| (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1])).sum();
    assert!((length - (12.2 + 1.5 * 0.406 * std::f64::consts::FRAC_PI_4 + 3.0)).abs() < 2e-3, "{length} mm");
    assert!((model.measured.bearing_factor - std::f64::consts::FRAC_PI_2).abs() < 1e-15, "t_N/(φ L)");
    assert!(model.contacts.iter().all(|pair| pair.master_bends), "the fibre is the master");
    // law and p_0: no bond at the rounded edges
    assert_eq!([0, 4].map(|k| props(&model, "interface_left")[k]), [0.0, 1000.0]);
    assert_eq!(props(&model, "exit_left")[0], 2.0);
    let model =
        accepted(&case, &["mesh.specimen.separation_length=thesis", "contact.exit={\"law\": \"none\", \"mu\": 0}"])
            .model;
    assert_eq!(names(&model)[2..4], ["separation_left", "separation_right"]);
    assert_eq!(model.measured.interface_lines, [[0, 2], [1, 3]]);
    assert_eq!([0, 4].map(|k| props(&model, "separation_left")[k]), [0.0, 2.0]);
    assert_eq!([0, 14].map(|k| props(&model, "exit_right")[k]), [2.0, 0.0]);
    // φ (tan θ + 1/(2 tan θ)) at 45°: the walls lose 1.5 φ, as far as stations fall on it
    let length = |name: &str| -> f64 {
        let edges = model.mesh.edge_set(name).expect("the set").iter().map(|&edge| model.mesh.edge_nodes(edge));
        let ends = edges.map(|edge| [0, 1].map(|k| model.mesh.nodes()[edge.nodes()[k]]));
        ends.map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum()
    };
    let start = 0.609 - 0.1015 * (1.0 + 0.5_f64.sqrt()) * 2.0_f64.sqrt() - 0.203;
    assert!((length("hole_separation_left") - start).abs() < 0.21, "{}", length("hole_separation_left"));
    // 0 below 15°
    let model = accepted(&case, &["mesh.specimen.separation_length=thesis", "mesh.specimen.angle_deg=14"]).model;
    assert_eq!(model.contacts.len(), 4);
}

/// Coarse elements that bend over the exit's edge would make the load a saw.
#[test]
fn what_the_steps_pull_out_is_meshed_finely() {
    let longest = |overrides: &[&str], below: f64| {
        let model = accepted(&inclined_case(), &[&["mesh.specimen.mesh_size=1"], overrides].concat()).model;
        // elements along the embedded axis from the exit to this depth
        let axis = FibreGeometry::of(&model).expect("a fibre").axis;
        let depth = |node: &[f64; 2]| -(node[0] + node[1]) * 0.5_f64.sqrt();
        let nodes: Vec<f64> = axis.iter().map(depth).filter(|depth| (-1e-9..below).contains(depth)).collect();
        nodes.windows(2).map(|ends| (ends[1] - ends[0]).abs()).fold(0.0, f64::max)
    };
    let usual = longest(&[], 2.0);
    assert!(usual < 0.115, "{usual}");
    assert!(longest(&["steps.0.slip=5"], 5.0) <= 1.05 * usual);
    assert!(longest(&["steps.0.slip=13"], 12.2) <= 1.05 * usual);
    let cycles = r#"steps=[{"repeat": 2, "steps": [{"slip": 4}, {"slip": 1}]}]"#;
    assert!(longest(&[cycles], 4.0) <= 1.05 * usual);
    // what is given stays
    assert!(longest(&["steps.0.slip=5", "mesh.specimen.fine_length=2"], 5.0) > 3.0 * usual);
    assert!(longest(&[], 5.0) > 3.0 * usual);
}

/// A hook of 0.9 mm at mesh size 2 has elements of about 1 mm, whether its fibre is pulled by 1 mm or by its whole length. The latter used to
/// refine it to 0.45 mm: at 30° it then carried 425 N at a slip of 0.25 mm, and 396 N in a shorter pull. A length that is given counts.
#[test]
fn the_mesh_of_a_hook_does_not_depend_on_how_far_it_is_pulled() {
    let mut case = two_fibres();
    case["mesh"]["specimen"] = json!({ "type": "fibres", "width": 40, "depth": 40, "mesh_size": 2, "elements_across": 4, "fibres": [
        { "name": "a", "diameter": 0.9, "embedded": 30.0,
          "path": { "type": "hooked", "hook": [2.12, 2.95], "angle_deg": 45, "radius": 2.5 } } ] });
    // elements in the lowest 5 mm
    let elements = |overrides: &[&str]| -> usize {
        let mesh = accepted(&case, overrides).model.mesh;
        let wire = || mesh.elements().iter().filter(|element| mesh.parts()[element.part()].name.starts_with("fibre"));
        let height = |node: &usize| mesh.nodes()[*node][1];
        let lowest = wire().flat_map(|element| element.nodes()).map(height).fold(f64::INFINITY, f64::min);
        wire().filter(|element| element.nodes().iter().all(|node| height(node) < lowest + 5.0)).count()
    };
    let short = elements(&["steps.0.slip=1"]);
    assert!((16..=28).contains(&short), "{short}");
    for slip in ["5", "20", "24", "30"] {
        let long = elements(&[&format!("steps.0.slip={slip}")]);
        assert!(long.abs_diff(short) <= 4, "{slip} mm: {long}, not {short}");
    }
    let fine = elements(&["steps.0.slip=5", "mesh.specimen.fibres.0.fine_length=30"]);
    assert!(2 * fine > 3 * short, "{fine}, {short}");
}

#[test]
fn an_inclined_fibre_has_a_cover_unless_it_is_as_thick_as_its_block() {
    let mut case = inclined_case();
    case["mesh"]["specimen"].as_object_mut().expect("a specimen").remove("cover");
    let parts = |overrides: &[&str]| accepted(&case, overrides).model.laws.len();
    assert_eq!(parts(&[]), 3);
    assert_eq!(parts(&["mesh.specimen.cover=false"]), 2, "the thesis's plane model");
    assert_eq!(parts(&["mesh.specimen.matrix_thickness=0.406"]), 2);
}

#[test]
fn torn_matter_is_released_as_the_case_says() {
    let case = inclined_case();
    assert_eq!(accepted(&case, &[]).model.controls.spalling, None);
    let found = accepted(&case, &[r#"spalling={"opening": 0.2, "stress": 0.03, "wait": 0.1}"#]).model.controls.spalling;
    assert_eq!(found, Some(Spalling { opening: 0.2, stress: 0.03, wait: 0.1, fade: 0.02 }));
}

#[test]
fn a_fibre_loaded_at_its_exit_hangs_on_a_node() {
    let model = accepted(&inclined_case(), &["mesh.specimen.shape=straight"]).model;
    assert_eq!(model.couplings.len(), 2, "x and y");
    let grip = &model.supports[0];
    assert_eq!((grip.name.as_str(), grip.nodes.len()), ("grip", 1));
    assert_eq!(model.mesh.free_nodes(), grip.nodes);
    let model = accepted(&inclined_case(), &["mesh.specimen.shape=straight", "mesh.specimen.free_length=1"]).model;
    assert!(model.couplings.is_empty() && model.supports[0].nodes.len() == 5);
}

#[test]
fn impossible_inclined_fibres_are_explained() {
    for (overrides, place, message) in [
        (&["mesh.specimen.angle_deg=81"][..], "$.mesh.specimen.angle_deg", "80"),
        (&["mesh.specimen.width=10"], "$.mesh.specimen.embedded_length", "stays in the block"),
        (&["mesh.specimen.matrix_element=Q8"], "$.mesh.specimen.matrix_element", "T6 or T3"),
        (&["contact.exit={\"mu_\": 0}"], "$.contact.law.props.mu_", "no parameter 'mu_'"),
        (
            &["contact.law.props=[0, 0, 0, 0, 1000, 0, 0, 400, 3.44, 0.13865, 1, -0.1772, 0, 0, 0.1, 0, 0]"],
            "$.contact.exit",
            "by name",
        ),
    ] {
        let text = Bench::new().read(&inclined_case(), overrides).map(|_| String::new());
        let text = text.unwrap_or_else(|errors| errors.to_string());
        assert!(text.contains(place) && text.contains(message), "{overrides:?}: {text}");
    }
}

/// Keys that another key or the kind of the model makes meaningless are refused, or reported if a study may reach them.
#[test]
fn keys_without_effect_are_reported() {
    let fibre = |kind: &str, axisymmetric: bool| {
        let mut case = specimen_case(json!({ "type": kind }), &["fibre", "matrix"]);
        if axisymmetric {
            case["mesh"]["specimen"]["axisymmetric"] = json!(true);
        }
        case["contact"] = json!({ "law": { "plugin": "bond_slip" } });
        case["steps"] = json!([{ "slip": 1 }]);
        case
    };
    let [plane, round] = [false, true].map(|axisymmetric| fibre("perpendicular_fibre", axisymmetric));
    let inclined = fibre("inclined_fibre", false);
    let mut cylinder = specimen_case(json!({ "type": "thick_cylinder" }), &["cylinder"]);
    cylinder["loads"] = json!({ "inner": { "pressure": 1 } });
    cylinder["steps"] = json!([{ "drives": { "inner": 1 } }]);
    let soft = r#"contact.normal={"soft": {"p_0": 1, "g_0": 0.1}}"#;
    let refused: [(&Value, &[&str], &str); 11] = [
        (&plane, &["mesh.specimen.outer_radius=5"], "$.mesh.specimen.outer_radius"),
        (&plane, &["mesh.specimen.equal_sizes=true", "mesh.specimen.exit_size=0.2"], "$.mesh.specimen.equal_sizes"),
        (&plane, &["mesh.specimen.matrix_thickness=4", "parts.matrix.thickness=3"], "$.mesh.specimen.matrix_thickness"),
        (&plane, &["contact.law.entry=fric", soft, "contact.enforcement=penalty"], "$.contact.enforcement"),
        (&plane, &["contact.law.entry=fric", soft, "contact.penalty_factor=9"], "$.contact.penalty_factor"),
        (&round, &["mesh.specimen.outer_radius=5", "mesh.specimen.width=20"], "$.mesh.specimen.width"),
        (
            &round,
            &["mesh.specimen.outer_radius=5", "mesh.specimen.matrix_thickness=2"],
            "$.mesh.specimen.matrix_thickness",
        ),
        (&round, &["parts.matrix.thickness=3"], "$.parts.matrix.thickness"),
        (&inclined, &["mesh.specimen.shape=straight", "mesh.specimen.bend_radius=3"], "$.mesh.specimen.bend_radius"),
        (
            &inclined,
            &["mesh.specimen.matrix_thickness=4", "parts.matrix.thickness=3"],
            "$.mesh.specimen.matrix_thickness",
        ),
        (&cylinder, &["mesh.specimen.height=2"], "$.mesh.specimen.height"),
    ];
    for (case, overrides, place) in refused {
        let errors =
            Bench::new().read(case, overrides).map(|_| String::new()).unwrap_or_else(|errors| errors.to_string());
        assert!(errors.contains(place) && errors.lines().count() == 1, "{overrides:?}: {errors}");
        // the keys that it conflicts with are accepted
        accepted(case, &overrides[..overrides.len() - 1]);
    }
    for (case, overrides, place) in [
        (&plane, &[r#"contact.separation={"p_0": 1}"#][..], "$.contact.separation"),
        (&plane, &[r#"contact.exit={"p_0": 1}"#], "$.contact.exit"),
        (&plane, &["parts.matrix.average_dilatation=false"], "$.parts.matrix.average_dilatation"),
        (&plane, &["parts.fibre.strength=1160", "output.rupture_strain=0.1"], "$.output.rupture_strain"),
        (&plane, &["parts.matrix.strength=3"], "$.parts.matrix.strength"),
        (&plane, &["output.plots=false", "output.pictures_at=[0.1]"], "$.output.pictures_at"),
        (&plane, &[r#"spalling={"opening": 0.2, "stress": 0.03}"#], "$.spalling"),
        (&plane, &["controls.relaxation_time=1"], "$.controls.relaxation_time"),
        (&plane, &["controls.max_stabilisation_share=0.1"], "$.controls.max_stabilisation_share"),
        (&plane, &["parts.fibre.material.nstatv=3"], "$.parts.fibre.material.nstatv"),
        (&plane, &["parts.fibre.material.thread_safe=true"], "$.parts.fibre.material.thread_safe"),
        (&plane, &["contact.law.call_time_limit_s=5"], "$.contact.law.call_time_limit_s"),
    ] {
        let warnings = accepted(case, overrides).about.warnings;
        let messages = warnings.iter().filter(|warning| warning.contains("has no effect")).collect::<Vec<_>>();
        assert!(messages.len() == 1 && messages[0].starts_with(place), "{overrides:?}: {warnings:?}");
    }
}

#[test]
fn a_body_that_only_its_drive_holds_is_reported() {
    let mut case = pullout_case();
    let messages = |case: &Value| -> Vec<String> {
        let warnings = accepted(case, &[]).about.warnings;
        warnings.into_iter().filter(|warning| warning.contains("nothing holds it back")).collect()
    };
    assert_eq!(messages(&case), Vec::<String>::new());
    case["supports"] = json!({});
    let messages = messages(&case);
    assert!(messages.len() == 1 && messages[0].contains("can move along y with the drive 'slip'"), "{messages:?}");
}

#[test]
fn every_specimen_has_a_smallest_case() {
    for (name, parts) in [
        ("plate_with_hole", &["plate"][..]),
        ("thick_cylinder", &["cylinder"]),
        ("cook_membrane", &["membrane"]),
        ("beam", &["beam"]),
        ("two_blocks", &["lower", "upper"]),
        ("hertz", &["cylinder", "base"]),
        ("drag_out_strip", &["strip", "block"]),
    ] {
        let mut case = specimen_case(json!({ "type": name }), parts);
        if parts.len() > 1 {
            let law = json!({ "plugin": "bond_slip", "entry": "fric", "props": { "law": "none" } });
            case["contact"] = json!({ "law": law, "normal": { "hard": {} } });
        }
        let model = accepted(&case, &[]).model;
        assert_eq!(model.laws.len(), parts.len(), "{name}");
        assert!(!model.supports.is_empty() && model.contacts.len() == parts.len() - 1, "{name}");
    }
}

#[test]
fn controls_skipping_and_output() {
    let program = program(&[
        "controls={\"force_tolerance\": 1e-8, \"max_iterations\": 9, \"line_search\": false, \"relaxation_time\": 2}",
        "skip={\"elastic_far_field\": false}",
        "output={\"every\": 5, \"vtu\": 3, \"plots\": false}",
        "nlgeom=true",
    ]);
    let controls = program.model.controls;
    assert_eq!((controls.force_tolerance, controls.max_iterations, controls.line_search), (1e-8, 9, false));
    assert_eq!((controls.relaxation_time, controls.max_cutbacks), (2.0, 30));
    assert_eq!(program.model.skipping, Skipping { elastic_far_field: false, ..Skipping::ALL });
    assert_eq!((program.about.every, program.fields_every, program.about.plots), (5, Some(3), false));
    assert!(program.model.has_large_displacements());
    let old = self::program(&["skip={\"unused_tangents\": false, \"symmetric_solver\": true}"]);
    assert_eq!(old.model.skipping, Skipping::ALL);
    let warned = old.about.warnings.iter().filter(|warning| warning.contains("has no effect any more"));
    assert_eq!(warned.count(), 2, "{:?}", old.about.warnings);
    let program = self::program(&["skip=none", "output.vtu=false"]);
    assert_eq!((program.model.skipping, program.fields_every), (Skipping::NONE, None));
}

#[test]
fn couplings_by_terms_and_ties() {
    let program = program(&["couplings=[{\"dependent\": {\"node\": [0.4, 1.5], \"component\": \"x\"}, \
         \"terms\": [{\"node\": \"exit\", \"component\": \"y\", \"factor\": -2}]}, \
         {\"tie\": \"hole\", \"to\": \"surface\"}]"]);
    let model = &program.model;
    let exit = model.mesh.node_set("exit").expect("the set")[0];
    assert_eq!(model.mesh.nodes()[model.couplings[0].dependent.node], [0.4, 1.5]);
    assert_eq!(model.couplings[0].terms, [(Freedom { node: exit, component: 1 }, -2.0)]);
    // five nodes at the places of five others, two directions
    assert_eq!(model.couplings.len(), 1 + 10);
    for coupling in &model.couplings[1..] {
        let own = model.mesh.nodes()[coupling.dependent.node];
        let place = coupling.terms.iter().fold([0.0; 2], |[x, y], (freedom, weight)| {
            let node = model.mesh.nodes()[freedom.node];
            [x + weight * node[0], y + weight * node[1]]
        });
        assert!((own[0] - place[0]).hypot(own[1] - place[1]) < 1e-12, "{own:?} {place:?}");
    }
}

#[test]
fn a_drive_that_nothing_moves_is_reported() {
    let program = program(&["loads={\"side\": {\"pressure\": 1}}"]);
    assert_eq!(program.about.warnings, ["loads.side: no step moves the drive 'side': it stays 0"]);
}

#[test]
fn a_crack_band_is_judged_by_the_elements_of_its_part() {
    let mut case = pullout_case();
    let material =
        |crushing_energy: f64| json!({ "plugin": "concrete_damage", "props": { "G_f": 0.1, "G_c": crushing_energy } });
    case["parts"]["matrix"]["material"] = material(15.0);
    accepted(&case, &[]);
    // elements of 0.5 mm × 0.5 mm dissipate more than this before they soften
    case["parts"]["matrix"]["material"] = material(1e-4);
    let text = Bench::new().read(&case, &[]).map(|_| String::new()).unwrap_or_else(|errors| errors.to_string());
    let expected = "$.parts.matrix.material.props: concrete_damage: in element ";
    assert!(text.contains(expected) && text.contains("of length 0.5000 mm"), "{text}");
}

const MALFORMED: &[Sample] = &[
    // structure
    (&["mesh=5"], "$.mesh", "expected an object, found 5", BySchema),
    (&["mesh={}"], "$.mesh.file", "is missing", BySchema),
    (&["mesh={\"file\": 3}"], "$.mesh.file", "expected a text, found 3", BySchema),
    (&["mesh={\"fiel\": \"two.msh\"}"], "$.mesh.fiel", "nearest valid name: 'file'", BySchema),
    (&["part=1"], "$.part", "unknown key; nearest valid name: 'parts'", BySchema),
    (&["parts=[]"], "$.parts", "expected an object, found []", BySchema),
    (&["parts.fibre.material=null"], "$.parts.fibre.material", "expected an object", BySchema),
    (&["parts.fibre={}"], "$.parts.fibre.material", "is missing", BySchema),
    (&["parts.fibre.model=3d"], "$.parts.fibre.model", "expected \"plane_stress\"", BySchema),
    (&["parts.fibre.thickness=-1"], "$.parts.fibre.thickness", "must be > 0", BySchema),
    (&["parts.fibre.thickness=thick"], "$.parts.fibre.thickness", "expected a number", BySchema),
    (&["parts.fibre.integration=half"], "$.parts.fibre.integration", "\"full\"", BySchema),
    (&["contact=7"], "$.contact", "expected an object or an array", BySchema),
    (&["contact.lwa={}"], "$.contact.lwa", "unknown key", BySchema),
    (&["contact={\"slave\": \"hole\", \"master\": \"surface\"}"], "$.contact.law", "is missing", BySchema),
    (&["contact.quadrature={\"gauss\": 11}"], "$.contact.quadrature.gauss", "must be <= 10", BySchema),
    (&["contact.width=0"], "$.contact.width", "must be > 0", BySchema),
    (&["contact.enforcement=glue"], "$.contact.enforcement", "\"penalty\"", BySchema),
    (&["contact.penalty_factor=0"], "$.contact.penalty_factor", "must be > 0", BySchema),
    (&["contact.initial_gap=open"], "$.contact.initial_gap", "\"close\"", BySchema),
    (&["contact.initial_gap={\"close\": 0}"], "$.contact.initial_gap.close", "must be > 0", BySchema),
    (&["contact.interference={\"depth\": 0.01}"], "$.contact.interference.drive", "is missing", BySchema),
    (
        &["contact.interference={\"drive\": \"fit\", \"depth\": -1}"],
        "$.contact.interference.depth",
        "must be > 0",
        BySchema,
    ),
    (&["grip.lateral=loose"], "$.grip.lateral", "expected \"fixed\" or \"free\"", BySchema),
    (&["grip.direction=z"], "$.grip.direction", "expected \"x\", \"y\" or an array", BySchema),
    (&["grip.direction=[1]"], "$.grip.direction", "needs at least 2 entries", BySchema),
    (&["supports.side.direction=5"], "$.supports.side.direction", "found 5", BySchema),
    (&["steps.0.slip=far"], "$.steps[0].slip", "expected a number, found \"far\"", BySchema),
    (&["steps.0.slpi=1"], "$.steps[0].slpi", "unknown key; nearest valid name: 'slip'", BySchema),
    (&["steps.0.increments=0"], "$.steps[0].increments", "must be >= 1", BySchema),
    (&["steps.0.increments={\"initial\": 2}"], "$.steps[0].increments.initial", "must be <= 1", BySchema),
    (
        &["steps.0.increments={\"intial\": 0.1}"],
        "$.steps[0].increments.intial",
        "nearest valid name: 'initial'",
        BySchema,
    ),
    (&["controls={\"force_tolerance\": 0}"], "$.controls.force_tolerance", "must be > 0", BySchema),
    (&["controls={\"relaxation_time\": -1}"], "$.controls.relaxation_time", "must be >= 0", BySchema),
    (&["skip=some"], "$.skip", "expected \"all\", \"none\" or an object", BySchema),
    (&["skip={\"far_field\": true}"], "$.skip.far_field", "unknown key", BySchema),
    (&["output.vtu=often"], "$.output.vtu", "expected true or false or a whole number", BySchema),
    (&["couplings=[{\"tei\": \"a\", \"to\": \"b\"}]"], "$.couplings[0].tei", "nearest valid name: 'tie'", BySchema),
    (&["mesh={\"specimen\": {}}"], "$.mesh.specimen.type", "is missing", BySchema),
    (&["mesh={\"specimen\": {\"type\": \"beem\"}}"], "$.mesh.specimen.type", "nearest valid name: 'beam'", BySchema),
    (
        &["mesh={\"specimen\": {\"type\": \"beam\", \"lenght\": 3}}"],
        "$.mesh.specimen.lenght",
        "unknown key; nearest valid name: 'length'",
        BySchema,
    ),
    (
        &["mesh={\"specimen\": {\"type\": \"perpendicular_fibre\", \"width\": 0}}"],
        "$.mesh.specimen.width",
        "must be > 0",
        BySchema,
    ),
    // mesh and sets
    (
        &["mesh={\"specimen\": {\"type\": \"perpendicular_fibre\", \"embedded_length\": 20}}"],
        "$.mesh.specimen.embedded_length",
        "is 20, it must be",
        ByMeaning,
    ),
    (
        &["mesh={\"specimen\": {\"type\": \"cook_membrane\"}}"],
        "$.parts.membrane",
        "is missing: the specimen has this part",
        ByMeaning,
    ),
    (&["mesh={\"specimen\": {\"type\": \"beam\"}}"], "$.parts.fibre", "the specimen has no part 'fibre'", ByMeaning),
    (&["mesh.file=nowhere.msh"], "$.mesh.file", "cannot be read: No such file", ByMeaning),
    (&["mesh.file=curve.csv"], "$.mesh.file", "this is no Gmsh mesh", ByMeaning),
    (&["parts={\"bar\": {\"material\": {\"plugin\": \"linear_elastic\"}}}"], "$.mesh.file", "matrix", ByMeaning),
    (&["grip.nodes=girp"], "$.grip.nodes", "no node set 'girp'; nearest valid name: 'grip'", ByMeaning),
    (&["grip={}"], "$.grip.nodes", "is missing", ByMeaning),
    (&["grip={}"], "$.grip.direction", "is missing", ByMeaning),
    (&["grip.direction=[0, 0]"], "$.grip.direction", "[0, 0] has no direction", ByMeaning),
    (&["supports=sides"], "$.supports", "the mesh has no supports of its own", ByMeaning),
    (&["supports={\"sied\": {}}"], "$.supports.sied", "nearest valid name: 'side'", ByMeaning),
    (&["supports.side.nodes=sied"], "$.supports.side.nodes", "nearest valid name: 'side'", ByMeaning),
    (&["supports.side.drive=lift"], "$.supports.side.direction", "is missing: a drive moves", ByMeaning),
    (&["supports.grip={}"], "$.supports.grip", "this name is taken", ByMeaning),
    (&["contact.slave=hoel"], "$.contact.slave", "no edge set 'hoel'; nearest valid name: 'hole'", ByMeaning),
    (&["contact.master=tail"], "$.contact.master", "the mesh has no edge set 'tail'", ByMeaning),
    (&["contact.slave=pieces"], "$.contact.slave", "its edges are 2 pieces", ByMeaning),
    (&["contact.master=ring"], "$.contact.master", "a closed ring", ByMeaning),
    (&["contact.master=hole"], "$.contact.master", "the slave has as well", ByMeaning),
    (&["measure.exit=side"], "$.measure.exit", "has 5 nodes; one is needed", ByMeaning),
    (&["measure.tail=[9, 9]"], "$.measure.tail", "no node is at (9, 9)", ByMeaning),
    (&["measure.load=bottom"], "$.measure.load", "there is no support 'bottom'", ByMeaning),
    (&["measure.slip=lift"], "$.measure.slip", "has the drive 'lift'", ByMeaning),
    // laws
    (&["parts.fibre.material.props.E=0"], "$.parts.fibre.material.props.E", "must be > 0", ByMeaning),
    (
        &["parts.fibre.material.entry=uinter"],
        "$.parts.fibre.material.entry",
        "a part calls the entry point umat",
        ByMeaning,
    ),
    (&["parts.fibre.material.statev0=[0, 0, 0]"], "$.parts.fibre.material.statev0", "3 values given", ByMeaning),
    (
        &["parts.fibre.material={\"plugin\": \"bond_slip\"}"],
        "$.parts.fibre.material.plugin",
        "has no UMAT: it is a law of contact",
        ByMeaning,
    ),
    (
        &["contact.law={\"plugin\": \"linear_elastic\"}"],
        "$.contact.law.plugin",
        "has no UINTER: it is a law of a part",
        ByMeaning,
    ),
    (&["contact.law.entry=umat"], "$.contact.law.entry", "uinter or fric", ByMeaning),
    (&["contact.law.props.mu=-1"], "$.contact.law.props.mu", "must be >= 0", ByMeaning),
    (&["contact.law.entry=fric"], "$.contact.normal", "is missing: FRIC has no normal law", ByMeaning),
    (&["contact.normal={\"hard\": {}}"], "$.contact.normal", "a UINTER plugin has the normal law", ByMeaning),
    (&["parts.fibre.thickness=equal_area"], "$.parts.fibre.thickness", "the mesh has no round fibre", ByMeaning),
    // loads, couplings, steps
    (&["loads={\"side\": {}}"], "$.loads.side", "needs exactly one of", ByMeaning),
    (&["loads={\"side\": {\"pressure\": 1, \"force\": [1, 0]}}"], "$.loads.side", "needs exactly one of", ByMeaning),
    (&["loads={\"exit\": {\"pressure\": 1}}"], "$.loads.exit", "the mesh has no edge set 'exit'", ByMeaning),
    (&["loads={\"inside\": {\"pressure\": 1}}"], "$.loads.inside", "lies inside the body, between the", ByMeaning),
    (
        &["loads={\"a\": {\"traction\": [1, 0], \"edges\": \"inside\"}}"],
        "$.loads.a.edges",
        "lies inside the body, between the elements 1 and 2",
        ByMeaning,
    ),
    (&["loads={\"alone\": {\"force\": [1, 0]}}"], "$.loads.alone", "belongs to no element", ByMeaning),
    (&["grip.nodes=alone"], "$.grip.nodes", "node 26 of 'alone' at (0.2, 2) belongs to no element", ByMeaning),
    (&["supports.alone={}"], "$.supports.alone", "belongs to no element", ByMeaning),
    (&["measure.exit=alone"], "$.measure.exit", "belongs to no element", ByMeaning),
    (&["measure.tail=[0.2, 2]"], "$.measure.tail", "node 26 at (0.2, 2) belongs to no element", ByMeaning),
    (
        &["loads={\"slip\": {\"edges\": \"side\", \"pressure\": 1}}"],
        "$.loads.slip",
        "has the name of the grip's drive 'slip'",
        ByMeaning,
    ),
    (
        &["loads={\"a\": {\"pressure\": 1, \"nodes\": \"side\"}}"],
        "$.loads.a.nodes",
        "name the set as \"edges\"",
        ByMeaning,
    ),
    (
        &["couplings=[{\"tie\": \"side\", \"to\": \"hole\"}]"],
        "$.couplings[0]",
        "away from the edges of 'hole'",
        ByMeaning,
    ),
    (
        &["couplings=[{\"dependent\": {\"node\": \"exit\", \"component\": \"x\"}, \
           \"terms\": [{\"node\": \"exit\", \"component\": \"x\"}]}]"],
        "$.couplings[0].terms[0]",
        "cannot follow itself",
        ByMeaning,
    ),
    (&["steps.0.drives={\"lift\": 1}"], "$.steps[0].drives.lift", "has the drive 'lift'", ByMeaning),
    (&["steps.0.drives={\"slip\": 1}"], "$.steps[0].drives.slip", "given twice", ByMeaning),
    (
        &["steps.0.increments={\"initial\": 0.1, \"maximum\": 0.01}"],
        "$.steps[0].increments.initial",
        "0.1 is greater than the maximum, 0.01",
        ByMeaning,
    ),
    (
        &["steps.0.increments={\"initial\": 0.001, \"minimum\": 0.01}"],
        "$.steps[0].increments.minimum",
        "greater than the initial increment",
        ByMeaning,
    ),
    (&["steps.0.until={\"quantity\": \"laod\", \"less_than\": 1}"], "$.steps[0].until.quantity", "'load'", ByMeaning),
    (
        &["parts.matrix.initial={\"stress\": [5, 0, 0, 0]}"],
        "$",
        "part 'matrix': linear_elastic drops the initial stress: without a strain increment it returns none",
        ByMeaning,
    ),
    (&["until={\"quantity\": \"load\"}"], "$.until", "needs \"greater_than\" or \"less_than\"", ByMeaning),
    (
        &[
            "compare=[{\"file\": \"curve.csv\", \"file_x\": \"strain\", \"file_y\": \"other\", \"x\": \"slip\", \"y\": \"P\"}]",
        ],
        "$.compare[0].y",
        "the history has no column 'P'",
        ByMeaning,
    ),
];

#[test]
fn malformed_pullout_cases_are_explained() {
    check(&pullout_case(), MALFORMED);
}

/// A scalar field that the case is given, and what is wrong with it.
const MALFORMED_FIELDS: &[Sample] = &[
    (&["field=phase_field"], "$.field", "expected an object", BySchema),
    (&["field={}"], "$.field.kind", "is missing", BySchema),
    (&["field.kind=heat"], "$.field.kind", "expected \"temperature\"", BySchema),
    (&["field.knd=temperature"], "$.field.knd", "nearest valid name: 'kind'", BySchema),
    (&["field.conductivity=0"], "$.field.conductivity", "must be > 0", BySchema),
    (&["field.conductivity=x"], "$.field.conductivity", "expected a number", BySchema),
    (&["field.capacity=-1"], "$.field.capacity", "must be > 0", BySchema),
    (&["field.tolerance=0"], "$.field.tolerance", "must be > 0", BySchema),
    (&["field.initial=warm"], "$.field.initial", "expected a number", BySchema),
    (&["field.coupling=fully"], "$.field.coupling", "expected \"staggered\"", BySchema),
    (&["field.parts=matrix"], "$.field.parts", "expected an array", BySchema),
    (&["field.parts=[\"matrx\"]"], "$.field.parts[0]", "nearest valid name: 'matrix'", ByMeaning),
    (&["field.parts=[]"], "$.field.parts", "names no part", ByMeaning),
    (&["field.fixed={}"], "$.field.fixed", "expected an array", BySchema),
    (&["field.fixed=[{\"value\": 1}]"], "$.field.fixed[0].nodes", "is missing", BySchema),
    (&["field.fixed=[{\"nodes\": \"side\"}]"], "$.field.fixed[0].value", "is missing", BySchema),
    (
        &["field.fixed=[{\"nodes\": \"sde\", \"value\": 1}]"],
        "$.field.fixed[0].nodes",
        "no node set 'sde'; nearest valid name: 'side'",
        ByMeaning,
    ),
    (
        &["field.fixed=[{\"nodes\": \"side\", \"value\": 1, \"drve\": \"slip\"}]"],
        "$.field.fixed[0].drve",
        "nearest valid name: 'drive'",
        BySchema,
    ),
    (&["field.fluxes=[{\"edges\": \"side\"}]"], "$.field.fluxes[0].flux", "is missing", BySchema),
    (&["field.fluxes=[{\"edges\": \"no\", \"flux\": 1}]"], "$.field.fluxes[0].edges", "no edge set 'no'", ByMeaning),
    (&["field.crack={\"G_f\": 0, \"l\": 1}"], "$.field.crack.G_f", "must be > 0", BySchema),
    (&["field.crack={\"G_f\": 1}"], "$.field.crack.l", "is missing", BySchema),
    (&["field.routines=hetval"], "$.field.routines", "expected an array", BySchema),
    (&["field.routines=[\"hetvl\"]"], "$.field.routines[0]", "expected \"hetval\"", BySchema),
    (&["field.routines=[\"umatht\"]"], "$.field.routines[0]", "no library of its parts has UMATHT", ByMeaning),
    (&["field.umatht=[1.0]"], "$.field.umatht", "expected an object", BySchema),
    (&["field.umatht={\"prop\": [1]}"], "$.field.umatht.prop", "nearest valid name: 'props'", BySchema),
    (&["field.umatht={\"props\": 1}"], "$.field.umatht.props", "expected an array", BySchema),
    (&["field.umatht={\"density\": 0}"], "$.field.umatht.density", "must be > 0", BySchema),
    (&["field.crack={\"G_f\": 1, \"l\": 1}"], "$.field.crack", "a temperature has no cracks", ByMeaning),
];

#[test]
fn malformed_fields_are_explained() {
    let mut case = pullout_case();
    case["field"] = json!({ "kind": "temperature" });
    check(&case, MALFORMED_FIELDS);
}

#[test]
fn a_field_takes_its_defaults_and_the_cracks_of_its_law() {
    let mut case = pullout_case();
    case["field"] = json!({ "kind": "phase_field", "parts": ["matrix"] });
    case["parts"]["matrix"]["material"] =
        json!({ "plugin": "concrete_phase_field", "props": { "G_f": 0.06, "l": 2.0 } });
    let field = accepted(&case, &[]).model.field.expect("a field");
    let crack = CrackSurface { fracture_energy: 0.06, length: 2.0 };
    assert_eq!(
        field,
        ScalarField { parts: vec![false, true], ..ScalarField::new(FieldKind::PhaseField(Some(crack)), 2) }
    );
}

#[test]
fn a_phase_field_in_full_coupling_is_warned_of() {
    let warnings = |field: &str| {
        let all = accepted(&inclined_case(), &[&format!("field={field}")]).about.warnings;
        all.into_iter().filter(|warning| warning.contains("$.field.coupling")).count()
    };
    assert_eq!(warnings(r#"{"kind": "phase_field", "parts": ["matrix"], "coupling": "full"}"#), 1);
    assert_eq!(warnings(r#"{"kind": "phase_field", "parts": ["matrix"]}"#), 0);
    assert_eq!(warnings(r#"{"kind": "temperature", "coupling": "full", "capacity": 1}"#), 0);
}

/// Parts expand from the temperature with which they begin: of the field, of the case, or their own.
#[test]
fn parts_are_free_of_thermal_strain_at_their_own_start() {
    let mut case = inclined_case();
    case["temperature"] = json!(7.0);
    for part in ["matrix", "fibre"] {
        case["parts"][part]["material"]["expansion"] = json!(1e-5);
    }
    let initial = |overrides: &[&str]| {
        let model = accepted(&case, &[&["mesh.specimen.cover=true"], overrides].concat()).model;
        let laws = model.mesh.parts().iter().zip(&model.laws).map(|(part, law)| {
            let expansion = law.frame.as_ref().and_then(|frame| frame.expansion.as_ref()).expect("it expands");
            (part.name.clone(), expansion.initial_temperature)
        });
        let laws: std::collections::BTreeMap<String, f64> = laws.collect();
        ["fibre", "matrix", "cover"].map(|part| laws[part])
    };
    let field =
        |parts: &str| format!(r#"field={{"kind": "temperature", "initial": 30, "capacity": 1, "parts": {parts}}}"#);
    assert_eq!(initial(&[]), [7.0, 7.0, 7.0]);
    assert_eq!(initial(&[&field("null")]), [30.0, 30.0, 30.0]);
    assert_eq!(initial(&[&field(r#"["matrix"]"#)]), [7.0, 30.0, 30.0]);
    // of one law in two parts
    assert_eq!(initial(&[&field(r#"["cover"]"#)]), [7.0, 7.0, 30.0]);
    let own = r#"parts.matrix.material.expansion={"alpha": 1e-5, "initial_temperature": -3}"#;
    assert_eq!(initial(&[&field(r#"["matrix"]"#), own]), [7.0, -3.0, -3.0]);
    let defaults = accepted(&case, &[&field(r#"["matrix"]"#)]).about.defaults;
    for line in
        ["fibre.material.expansion: initial_temperature = 7", "matrix.material.expansion: initial_temperature = 30"]
    {
        assert!(defaults.iter().any(|default| default.ends_with(line)), "{defaults:?}");
    }
    let warnings = |parts: &str| {
        let all = accepted(&case, &[&field(parts)]).about.warnings;
        all.iter().filter(|warning| warning.contains("$.temperature")).count()
    };
    assert_eq!([warnings("null"), warnings(r#"["matrix"]"#)], [1, 0], "the fibre has the temperature of the case");
    let phase_field = problems_of(&case, &[r#"field={"kind": "phase_field"}"#]);
    assert!(
        phase_field.contains("$.parts.matrix.material.expansion: would expand with the phase field"),
        "{phase_field}"
    );
}

/// Heat that no value holds, and values where there is no field.
#[test]
fn a_steady_temperature_needs_a_value_in_each_body() {
    let mut case = pullout_case();
    case["field"] = json!({ "kind": "temperature", "fixed": [{ "nodes": "side", "value": 1 }] });
    let loose = problems_of(&case, &[]);
    assert!(loose.contains("$.field.fixed: the body with element") && loose.contains("(part 'fibre')"), "{loose}");
    assert_eq!(loose.lines().count(), 1, "the matrix has one: {loose}");
    accepted(&case, &["field.parts=[\"matrix\"]"]);
    accepted(&case, &["field.capacity=1"]);
    let elsewhere = problems_of(&case, &["field.parts=[\"fibre\"]", "field.capacity=1"]);
    assert!(elsewhere.contains("$.field.fixed[0]: is where no part has the field"), "{elsewhere}");
}

#[test]
fn a_cover_has_the_phase_field_of_the_matrix() {
    let case = inclined_case();
    let parts = |field: &str| {
        let model = accepted(&case, &["mesh.specimen.cover=true", &format!("field={field}")]).model;
        let with_field = model.mesh.parts().iter().zip(model.field.expect("a field").parts);
        with_field.filter(|(_, has_field)| *has_field).map(|(part, _)| part.name.clone()).collect::<Vec<_>>()
    };
    let mut concrete = parts(r#"{"kind": "phase_field", "parts": ["matrix"]}"#);
    concrete.sort();
    assert_eq!(concrete, ["cover", "matrix"]);
    assert_eq!(parts(r#"{"kind": "phase_field"}"#).len(), 2, "nothing would hold it in the fibre");
    assert_eq!(parts(r#"{"kind": "temperature", "capacity": 1}"#).len(), 3);
    assert_eq!(parts(r#"{"kind": "phase_field", "parts": ["cover"]}"#), ["cover"]);
}

/// Problems of a case, one a line.
fn problems_of(case: &Value, overrides: &[&str]) -> String {
    Bench::new().read(case, overrides).map(|_| String::new()).unwrap_or_else(|errors| errors.to_string())
}

#[test]
fn a_node_without_an_element_may_be_loaded_where_a_coupling_joins_it() {
    let coupling = r#"couplings=[{"dependent": {"node": "alone", "component": "x"}, "terms": [{"node": "exit", "component": "x"}]}]"#;
    program(&[coupling, r#"loads={"alone": {"force": [1, 0]}}"#, r#"measure.exit="alone""#]);
}

#[test]
fn a_load_may_say_that_the_grip_drives_it() {
    program(&[r#"loads={"slip": {"edges": "side", "pressure": 1, "drive": "slip"}}"#]);
}

#[test]
fn consequences_of_what_is_wrong_are_not_reported() {
    for (overrides, count) in [
        (&[r#"loads={"side": {"force": [1]}}"#, r#"steps.0.drives={"side": 1}"#][..], 1),
        (&[r#"loads={"side": {"pressure": 1}}"#, r#"steps.0.drives={"sied": 1}"#], 1),
        (
            &[
                r#"couplings=[{"dependent": {"node": "side", "component": "x"}, "terms": [{"node": [-1, 0], "component": "x"}]}]"#,
            ],
            1,
        ),
        (&["measure.load=nothing"], 1),
    ] {
        let messages = problems_of(&pullout_case(), overrides);
        assert_eq!(messages.lines().count(), count, "{messages}");
        assert!(!messages.contains("side, side"), "{messages}");
    }
}

#[test]
fn a_node_set_that_is_called_like_a_part_is_not_taken_for_the_part() {
    let bench = Bench::new();
    let text = two_bodies().replace("\"fibre_bottom\"", "\"fibre\"");
    std::fs::write(bench.0.path().join("named.msh"), text).expect("a mesh");
    let set = |overrides: &[&str]| match bench.read(&pullout_case(), &[&["mesh.file=named.msh"], overrides].concat()) {
        Ok(_) => String::new(),
        Err(errors) => errors.to_string(),
    };
    assert_eq!(set(&[]), "");
    let messages = set(&["supports.fibre={}"]);
    assert!(messages.contains("$.supports.fibre: 'fibre' is a part and a node set of the mesh"), "{messages}");
}

/// Warnings on two bodies with these numbers of columns, of which the upper follows the lower unless overrides say otherwise.
fn warnings_of_tie(columns: [usize; 2], overrides: &[&str]) -> Vec<String> {
    let lower = Body { columns: columns[0], rows: 1, low: [0.0, 0.0], high: [12.0, 1.0], first_node: 1 };
    let upper =
        Body { columns: columns[1], rows: 1, low: [0.0, 1.0], high: [12.0, 2.0], first_node: 1 + 2 * (columns[0] + 1) };
    let groups = [
        (2, "lower", lower.elements()),
        (2, "upper", upper.elements()),
        (1, "base", lower.row(0)),
        (1, "below", lower.row(1)),
        (1, "above", upper.row(0)),
        (1, "top", upper.row(1)),
    ];
    let nodes: Vec<[f64; 2]> = lower.nodes().into_iter().chain(upper.nodes()).collect();
    let bench = Bench::new();
    std::fs::write(bench.0.path().join("tied.msh"), gmsh(&nodes, &groups)).expect("a mesh");
    let material = json!({ "material": { "plugin": "linear_elastic" } });
    let case = json!({
        "kind": "pullout",
        "mesh": { "file": "tied.msh" },
        "parts": { "lower": material, "upper": material },
        "supports": { "base": {} },
        "couplings": [{ "tie": "above", "to": "below" }],
        "grip": { "nodes": "top", "direction": "y" },
        "steps": [{ "slip": 0.1 }]
    });
    match bench.read(&case, overrides) {
        Ok(Case::Pullout(program)) => program.about.warnings,
        Ok(_) => panic!("a case of a specimen"),
        Err(errors) => panic!("{errors}"),
    }
}

#[test]
fn a_tie_of_the_coarser_side_to_the_finer_one_is_reported() {
    for columns in [[12, 4], [2, 1], [6, 4]] {
        let warnings = warnings_of_tie(columns, &[]);
        let expected = "$.couplings[0]: 'above' is coarser than 'below', which it follows: an edge near (";
        assert!(matches!(&warnings[..], [warning] if warning.starts_with(expected)), "{columns:?}: {warnings:?}");
        let swapped = r#"couplings=[{"tie": "below", "to": "above"}]"#;
        assert_eq!(warnings_of_tie(columns, &[swapped]), [""; 0], "{columns:?}");
    }
    assert_eq!(warnings_of_tie([4, 4], &[]), [""; 0]);
}

#[test]
fn columns_that_stay_nan_end_nothing() {
    let mut case = pullout_case();
    case.as_object_mut().expect("an object").remove("grip");
    case["supports"]["fibre_bottom"] = json!({ "direction": "y" });
    case["supports"]["grip"] = json!({ "direction": "x" });
    case["loads"] = json!({ "surface": { "traction": [0, 1] } });
    case["measure"] = json!({});
    case["steps"] = json!([{ "drives": { "surface": 1 } }]);
    accepted(&case, &[]);
    let until = |column: &str| format!(r#"{{"quantity": "abs({column})", "greater_than": 0.1}}"#);
    for (column, why) in [
        ("load", "nothing is gripped and $.measure.load names no support"),
        ("load_lateral", "nothing is gripped"),
        ("slip_tail", "$.measure.tail names no node"),
    ] {
        for place in ["until", "steps.0.until"] {
            let messages = problems_of(&case, &[&format!("{place}={}", until(column))]);
            let place = place.replace("steps.0", "steps[0]");
            assert!(
                messages.contains(&format!("$.{place}.quantity: '{column}' is nan throughout: {why}")),
                "{messages}"
            );
        }
    }
    accepted(&case, &["measure.load=side", &format!("until={}", until("load"))]);
}

#[test]
fn without_a_grip_nothing_slips() {
    let mut case = pullout_case();
    case.as_object_mut().expect("an object").remove("grip");
    let text = Bench::new().read(&case, &[]).map(|_| String::new()).unwrap_or_else(|errors| errors.to_string());
    assert!(text.contains("$.steps[0].slip: nothing is pulled"), "{text}");
    case["steps"] = json!([{ "drives": { "lift": 1 } }]);
    case["supports"]["fibre_bottom"] = json!({ "direction": "y", "drive": "lift" });
    case["measure"] = json!({ "slip": "lift", "load": "fibre_bottom" });
    let measured = accepted(&case, &[]).model.measured;
    assert_eq!((measured.slip, measured.direction), (vec![0], [0.0, 1.0]));
}

/// μ⟨p − p_ref⟩, where p_ref is the host's pressure at gap 0.
#[test]
fn a_law_called_as_fric_has_the_normal_law_of_its_host() {
    const HARD: &str = r#"contact.normal={"hard": {"p_0": 1}}"#;
    const SOFT: &str = r#"contact.normal={"soft": {"p_0": 3, "g_0": 0.05}}"#;
    let fric = |props: &str, normal: &str| {
        let mut case = pullout_case();
        case["contact"]["law"] = json!({ "plugin": "bond_slip", "entry": "fric" });
        (case, [format!("contact.law.props={props}"), normal.to_owned()])
    };
    // normal_law and p_0 of PROPS
    let read = |props: &str, normal: &str| {
        let (case, overrides) = fric(props, normal);
        let program = accepted(&case, &overrides.each_ref().map(String::as_str));
        let ContactLaw::Fric { law, .. } = &program.model.contacts[0].law else { panic!("FRIC") };
        ([law.props[2], law.props[4]], program.about.warnings)
    };
    assert_eq!(read(r#"{"law": "none", "mu": 0.3}"#, HARD).0[0], 0.0, "its own would be soft");
    assert_eq!(read("{}", SOFT).0, [1.0, 3.0]);
    assert_eq!(read(r#"{"normal_law": "soft", "p_0": 3}"#, SOFT).0, [1.0, 3.0]);
    let (values, warnings) = read(r#"{"p_0": 2}"#, HARD);
    assert_eq!(values, [0.0, 2.0]);
    let message =
        "$.contact.law.props.p_0: has no effect: under FRIC the tension that opens is $.contact.normal.hard.p_0";
    assert!(warnings.iter().any(|warning| warning == message), "{warnings:?}");
    for (props, normal, expected) in [
        (
            r#"{"normal_law": "soft"}"#,
            HARD,
            "$.contact.law.props.normal_law: is another normal law than $.contact.normal.hard: ",
        ),
        (
            r#"{"normal_law": "hard"}"#,
            SOFT,
            "$.contact.law.props.normal_law: is another normal law than $.contact.normal.soft: ",
        ),
        (r#"{"p_0": 2}"#, SOFT, "$.contact.law.props.p_0: p_0 is 2, but $.contact.normal.soft.p_0 is 3: "),
        (
            "[2, 0, 1, 0, 2, 0.32, 0.05, 950, 1.5921, 0.0832, 0.87, -0.2678, 0.5, 850, 0.1, 0, 0, 0]",
            HARD,
            "$.contact.law.props[2]: is another normal law than $.contact.normal.hard: ",
        ),
    ] {
        let (case, overrides) = fric(props, normal);
        let messages = problems_of(&case, &overrides.each_ref().map(String::as_str));
        assert!(messages.contains(expected), "{messages}");
    }
}

#[test]
fn the_reaction_of_a_support_is_the_load_along_the_pull() {
    let direction = |overrides: &[&str]| program(overrides).model.measured.direction;
    // both directions: the first of them, x, is across the pull
    assert_eq!(direction(&["measure.load=side"]), [0.0, 1.0]);
    assert_eq!(direction(&["measure.load=side", "grip.direction=[3, 4]"]), [0.6, 0.8]);
    assert_eq!(direction(&["measure.load=side", "measure.direction=x"]), [1.0, 0.0]);
    // one direction: across it there is no reaction
    let roller = r#"supports.roller={"nodes": "bottom", "direction": "x"}"#;
    assert_eq!(direction(&[roller, "measure.load=roller"]), [1.0, 0.0]);
    let mut case = pullout_case();
    case.as_object_mut().expect("an object").remove("grip");
    case["steps"] = json!([{ "drives": { "lift": 1 } }]);
    case["supports"]["fibre_bottom"] = json!({ "direction": "y", "drive": "lift" });
    case["measure"] = json!({ "slip": "lift", "load": "side" });
    assert_eq!(accepted(&case, &[]).model.measured.direction, [0.0, 1.0], "that of what the slip moves");
    let specimen = json!({ "type": "inclined_fibre", "angle_deg": 30 });
    let mut case = specimen_case(specimen, &["fibre", "matrix"]);
    case["contact"] = json!({ "law": { "plugin": "bond_slip", "props": { "normal_law": "hard" } } });
    case["steps"] = json!([{ "slip": 1 }]);
    let [own, sides] =
        [&[] as &[&str], &["measure.load=sides"]].map(|overrides| accepted(&case, overrides).model.measured);
    assert_eq!(sides.direction, own.direction);
    assert_ne!(sides.supports, own.supports);
}

/// Two fibres, 4 mm from each other.
fn two_fibres() -> Value {
    let fibre = |name: &str, exit: f64| {
        let path = json!([{ "straight": 10.6, "tilt_deg": 0 }, { "straight": 2 }]);
        json!({ "name": name, "exit": exit, "embedded": 10.6, "path": path })
    };
    let specimen = json!({ "type": "fibres", "mesh_size": 2, "fibres": [fibre("a", -2.0), fibre("b", 2.0)] });
    let mut case = specimen_case(specimen, &["fibre", "matrix"]);
    case["contact"] = json!({ "law": { "plugin": "bond_slip", "props": { "normal_law": "hard", "p_0": 3 } } });
    case["steps"] = json!([{ "slip": 2 }]);
    case
}

#[test]
fn several_fibres_are_pulled_together_or_each_and_measured_each() {
    let model = accepted(&two_fibres(), &[]).model;
    let supports: Vec<&str> = model.supports.iter().map(|support| support.name.as_str()).collect();
    assert_eq!(supports[..4], ["grip.a", "grip.a, lateral", "grip.b", "grip.b, lateral"]);
    assert_eq!((&model.drives[..], &model.measured.slip[..]), (&["slip".to_owned()][..], &[0][..]));
    assert_eq!((&model.measured.supports[..], model.steps[0].targets.clone()), (&[0, 2][..], vec![Some(2.0)]));
    // bonded lines: left and right wall of a, then of b
    let of = |model: &Model| -> Vec<(String, usize, Vec<usize>)> {
        let fibres = model.measured.fibres.iter();
        fibres.map(|fibre| (fibre.name.clone(), fibre.slip, fibre.lines.clone())).collect()
    };
    assert_eq!(of(&model), [("a".to_owned(), 0, vec![0, 1]), ("b".to_owned(), 0, vec![2, 3])]);
    let parts = model.measured.fibres.iter().map(|fibre| model.mesh.parts()[fibre.part.expect("a part")].name.as_str());
    assert_eq!(parts.collect::<Vec<_>>(), ["fibre.a", "fibre.b"]);
    let columns = accepted(&two_fibres(), &["steps.0.until={\"quantity\": \"load.b\", \"less_than\": -1}"]).columns();
    assert_eq!(columns.iter().filter(|name| name.ends_with(".b")).count(), 9, "{columns:?}");
    for (overrides, targets) in [
        (&["mesh.specimen.grips=each"][..], [Some(2.0), Some(2.0)]),
        (&["mesh.specimen.grips=each", r#"steps.0.drives={"slip.b": 1}"#], [Some(2.0), Some(1.0)]),
    ] {
        let model = accepted(&two_fibres(), overrides).model;
        assert_eq!(model.drives, ["slip.a", "slip.b"]);
        assert_eq!((&model.measured.slip[..], &model.steps[0].targets[..]), (&[0, 1][..], &targets[..]));
        assert_eq!(of(&model)[1].1, 1);
    }
}

#[test]
fn a_drive_that_is_called_like_a_fibres_leaves_the_slip_to_the_grip() {
    let mut case = pullout_case();
    case["supports"]["fibre_bottom"] = json!({ "direction": "x", "drive": "slip.extra" });
    case["steps"] = json!([{ "slip": 0.1, "drives": { "slip.extra": 0.0 } }]);
    let model = accepted(&case, &[]).model;
    let target = |name: &str| model.drives.iter().position(|drive| drive == name).map(|k| model.steps[0].targets[k]);
    assert_eq!([target("slip"), target("slip.extra")], [Some(Some(0.1)), Some(Some(0.0))]);
}

#[test]
fn parts_of_fibres_are_named_one_by_one_or_all_at_once() {
    let model = accepted(&two_fibres(), &["parts.fibre.material.props.E=1000"]).model;
    let names: Vec<&str> = model.mesh.parts().iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["fibre.a", "fibre.b", "matrix", "cover"]);
    let moduli = |model: &Model| -> Vec<f64> { model.laws.iter().map(|law| law.props[0]).collect() };
    assert_eq!(moduli(&model)[..2], [1000.0, 1000.0]);
    let mut case = two_fibres();
    case["parts"]["fibre.b"] = json!({ "material": { "plugin": "linear_elastic", "props": { "E": 2000 } } });
    assert_eq!(moduli(&accepted(&case, &["parts.fibre.material.props.E=1000"]).model)[..2], [1000.0, 2000.0]);
    case["parts"]["fibre.c"] = case["parts"]["fibre.b"].clone();
    let text = Bench::new().read(&case, &[]).map(|_| String::new()).unwrap_or_else(|errors| errors.to_string());
    assert!(text.contains(r#"$.parts["fibre.c"]: the specimen has no part 'fibre.c'"#), "{text}");
}

#[test]
fn impossible_fibres_are_reported_with_their_place() {
    let path = "mesh.specimen.fibres.0.path";
    let set = |key: &str, value: &str| format!("{key}={value}");
    let fibre = |key: &str, value: &str| format!("mesh.specimen.fibres.0.{key}={value}");
    let mut wrong = Vec::new();
    for (change, place, words) in [
        (set("mesh.specimen.fibres", "[]"), "$.mesh.specimen.fibres", "1"),
        (set("mesh.specimen.grips", "all"), "$.mesh.specimen.grips", "together"),
        (set("mesh.specimen.matrix_element", "Q8"), "$.mesh.specimen.matrix_element", "T6 or T3"),
        (set("mesh.specimen.matrix_thickness", "0.4"), "$.mesh.specimen", "thickness"),
        (set("mesh.specimen.width", "4"), "$.mesh.specimen.fibres[0]", "within the width"),
        (set("mesh.specimen.depth", "10"), "$.mesh.specimen.fibres[0].embedded", "stays in the block"),
        (fibre("name", "b"), "$.mesh.specimen.fibres[1].name", "another"),
        (fibre("name", "a.b"), "$.mesh.specimen.fibres[0].name", "a.b"),
        (fibre("exit", "1.8"), "$.mesh.specimen.fibres[0].path", "away from the fibre 'b'"),
        (fibre("exit", "20"), "$.mesh.specimen.fibres[0]", "width"),
        (fibre("diameter", "-1"), "$.mesh.specimen.fibres[0].diameter", "-1"),
        (fibre("embedded", "30"), "$.mesh.specimen.fibres[0].embedded", "length of the path"),
        (fibre("exit_radius", "0.001"), "$.mesh.specimen.fibres[0].exit_radius", "size of elements at the exit"),
        (fibre("exit_radius", "11"), "$.mesh.specimen.fibres[0].exit_radius", "exit"),
        (fibre("separation_length", "11"), "$.mesh.specimen.fibres[0].separation_length", "less than the embedded"),
        (fibre("fine_length", "11"), "$.mesh.specimen.fibres[0].fine_length", "embedded"),
        (fibre("tail_gap", "-1"), "$.mesh.specimen.fibres[0].tail_gap", "-1"),
        (fibre("width_profile", "[[0, 0.5]]"), "$.mesh.specimen.fibres[0].width_profile", "two points"),
        (fibre("width_profile", "[[2, 0.5], [1, 0.4]]"), "$.mesh.specimen.fibres[0].width_profile", "ascending"),
        (fibre("radius", "1"), "$.mesh.specimen.fibres[0].radius", "unknown key"),
        (set(path, "[]"), "$.mesh.specimen.fibres[0].path", "1"),
        (set(path, r#"[{"straight": 10, "tilt_deg": 85}]"#), "$.mesh.specimen.fibres[0]", "embedded"),
        (set(path, r#"[{"straight": 12, "tilt_deg": 85}]"#), "$.mesh.specimen.fibres[0].path", "80°"),
        (
            set(path, r#"[{"straight": 10.6}, {"straight": 2, "tilt_deg": 5}]"#),
            "$.mesh.specimen.fibres[0].path",
            "piece 2",
        ),
        (set(path, r#"[{"straight": 10.6}, {"tilt_deg": 5}]"#), "$.mesh.specimen.fibres[0].path", "piece 2"),
        (set(path, r#"[{"straight": 11}, {}]"#), "$.mesh.specimen.fibres[0].path", "one of"),
        (set(path, r#"[{"straight": 10.6}, {"bend": 2}]"#), "$.mesh.specimen.fibres[0].path[1].bend", "unknown key"),
        (
            set(path, r#"[{"straight": 9}, {"arc": {"radius": 0.2, "to_deg": 30}}, {"straight": 3}]"#),
            "$.mesh.specimen.fibres[0].path",
            "radius",
        ),
        (
            set(path, r#"[{"straight": 2}, {"arc": {"radius": 1, "to_deg": 170}}, {"straight": 9}]"#),
            "$.mesh.specimen.fibres[0]",
            "path",
        ),
        (set(path, r#"[{"straight": 9}, {"arc": {"radius": 1}}]"#), "$.mesh.specimen.fibres[0].path", "by_deg"),
        (set(path, r#"{"type": "hooked", "hook": [2, 3], "bends": 3}"#), "$.mesh.specimen.fibres[0].path", "as many"),
        (set(path, r#"{"type": "hooked", "hook": [0.2, 3]}"#), "$.mesh.specimen.fibres[0].path", "room"),
        (set(path, r#"{"type": "hooked", "hook": [9, 3]}"#), "$.mesh.specimen.fibres[0].path", "shaft"),
        (fibre("diameter", "0.0009"), "$.mesh.specimen.fibres[0].diameter", "mm"),
        (fibre("embedded", "9000"), "$.mesh.specimen.fibres[0].embedded", "mm"),
        (
            set(path, r#"[{"wave": {"amplitude": 0.4, "length": 1.5, "n": 8}}]"#),
            "$.mesh.specimen.fibres[0].path",
            "crests",
        ),
        (
            set(path, r#"[{"wave": {"amplitude": 0.1, "length": 8, "n": 1.3}}]"#),
            "$.mesh.specimen.fibres[0].path",
            "halves",
        ),
    ] {
        let text = Bench::new().read(&two_fibres(), &["mesh.specimen.cover=true", &change]).map(|_| String::new());
        let text = text.unwrap_or_else(|errors| errors.to_string());
        if !(text.contains(place) && text.contains(words)) {
            wrong.push(format!("{change}: {text}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A hooked fibre by its data sheet with one thing wrong each, by the place that is named.
#[test]
fn malformed_keys_of_hooked_fibres_are_reported_with_their_place() {
    let mut case = two_fibres();
    case["mesh"]["specimen"] = json!({ "type": "fibres", "width": 24, "depth": 24, "mesh_size": 3, "elements_across": 4, "fibres": [
        { "name": "a", "diameter": 0.9, "embedded": 15.0,
          "path": { "type": "hooked", "hook": [2.12, 2.95], "angle_deg": 45, "radius": 2.0 } } ] });
    case["parts"]["fibre"]["thickness"] = json!("layers");
    accepted(&case, &["parts.fibre.strength=1160", "parts.fibre.elongation=0.03", "contact.bearing=rigid"]);
    let fibre = "mesh.specimen.fibres.0";
    let at = |key: &str| format!("$.mesh.specimen.fibres[0].{key}");
    let given = |key: &str, value: &str| format!("{fibre}.{key}={value}");
    let mut samples: Vec<(String, String)> = [
        ("path.type", "crooked", "path.type"),
        ("path.shape", "3D", "path.shape"),
        ("path.hook", "[]", "path.hook"),
        ("path.hook", "3", "path.hook"),
        ("path.hook", "[2.12, -1]", "path.hook[1]"),
        ("path.hook", r#"[2.12, "long"]"#, "path.hook[1]"),
        ("path.hook", "[0.2, 3]", "path"),
        ("path.hook", "[14, 3]", "path"),
        ("path.angle_deg", "0", "path.angle_deg"),
        ("path.angle_deg", "-45", "path.angle_deg"),
        ("path.angle_deg", "120", "path.angle_deg"),
        ("path.angle_deg", "wide", "path.angle_deg"),
        ("path.bends", "0", "path"),
        ("path.bends", "3", "path"),
        ("path.bends", "1.5", "path.bends"),
        ("path.radius", "0", "path.radius"),
        ("path.radius", "30", "path"),
        ("path.free_length", "-1", "path.free_length"),
        ("path.bend_radius", "-1", "path.bend_radius"),
        ("rotate_deg", "85", "path"),
        ("rotate_deg", "steep", "rotate_deg"),
        ("embedded", "5", "path"),
        ("embedded", "0", "embedded"),
        ("embedded", "40", "embedded"),
        ("diameter", "0.0009", "diameter"),
    ]
    .map(|(key, value, place)| (given(key, value), at(place)))
    .into();
    samples.extend(
        [
            ("mesh.specimen.elements_across=3", "$.parts.fibre.thickness"),
            ("mesh.specimen.elements_across=0", "$.mesh.specimen.elements_across"),
            ("parts.fibre.thickness=round", "$.parts.fibre.thickness"),
            ("parts.matrix.thickness=layers", "$.parts.matrix.thickness"),
            ("parts.fibre.strength=0", "$.parts.fibre.strength"),
            ("parts.fibre.strength=high", "$.parts.fibre.strength"),
            ("parts.fibre.elongation=-0.1", "$.parts.fibre.elongation"),
            ("contact.bearing=0", "$.contact.bearing"),
            ("contact.bearing=crushed", "$.contact.bearing"),
            ("output.rupture_strain=-1", "$.output.rupture_strain"),
        ]
        .map(|(change, place)| (change.to_owned(), place.to_owned())),
    );
    for (change, place) in &samples {
        let errors = Bench::new().read(&case, &[change]).map(|_| ()).expect_err(change);
        let places: Vec<&str> = errors.problems.iter().filter_map(|p| p.place.as_ref()).map(|p| p.as_str()).collect();
        assert_eq!(places, [place], "{change}: {errors}");
    }
    // m in place of mm
    let slips = |slip: f64| {
        let warnings = accepted(&case, &[&format!(r#"steps=[{{"slip": {slip}}}]"#)]).about.warnings;
        warnings.iter().filter(|warning| warning.contains("many times the embedded length")).count()
    };
    assert_eq!([slips(30.0), slips(15_500.0)], [0, 1]);
    // strength in GPa, elongation in percent
    for (change, words) in
        [("parts.fibre.strength=1.16", "1.16 MPa"), ("parts.fibre.elongation=3", "parts.fibre.elongation = 3")]
    {
        let warnings = accepted(&case, &[change]).about.warnings.join("\n");
        assert!(warnings.contains(words) && warnings.contains("outside the usual range"), "{warnings}");
    }
}

/// A wire of f_y 1050 and f_u 1160 MPa: on its first section its law carries no more, so that with the strength of a better wire it necks and
/// never breaks.
#[test]
fn the_strength_of_a_wire_is_that_of_its_law() {
    let case = two_fibres();
    let warnings = |law: &str, strength: &str| -> Vec<String> {
        let (law, strength) = (format!("parts.fibre.material={law}"), format!("parts.fibre.strength={strength}"));
        let warnings = accepted(&case, &[&law, &strength]).about.warnings;
        warnings.into_iter().filter(|warning| warning.starts_with("parts.fibre.strength")).collect()
    };
    let wire = r#"{"plugin": "j2_plasticity", "props": {"E": 200000, "nu": 0.3, "hardening": [[1050, 0], [1194.8, 0.02956], [2389.6, 1.02956]]}}"#;
    for strength in ["1160", "1100", "1050"] {
        assert_eq!(warnings(wire, strength), Vec::<String>::new());
    }
    let necks = warnings(wire, "2300");
    assert!(necks.len() == 1 && necks[0].contains("at most 1156 MPa on its first section"), "{necks:?}");
    let breaks = warnings(wire, "800");
    assert!(breaks.len() == 1 && breaks[0].contains("yields at 10"), "{breaks:?}");
    let elastic = r#"{"plugin": "linear_elastic", "props": {"E": 200000, "nu": 0.3}}"#;
    assert_eq!(warnings(elastic, "1160"), Vec::<String>::new());
}

/// A number without a unit is not asked for its unit.
#[test]
fn unusual_numbers_without_a_unit_are_called_so() {
    let warnings = accepted(&two_fibres(), &["contact.law.props.mu=20"]).about.warnings.join("\n");
    assert!(
        warnings.contains("mu = 20 is outside the usual range, 0 to 2, of this number without a unit"),
        "{warnings}"
    );
}

#[test]
fn lengths_in_metres_are_refused_in_every_specimen_of_a_fibre() {
    for kind in ["perpendicular_fibre", "inclined_fibre"] {
        let case = specimen_case(json!({ "type": kind }), &["fibre", "matrix"]);
        for (key, value) in [("fibre_diameter", "0.0004"), ("embedded_length", "9000")] {
            let text = problems_of(&case, &[&format!("mesh.specimen.{key}={value}")]);
            assert!(text.contains(&format!("$.mesh.specimen.{key}")) && text.contains("mm"), "{text}");
        }
    }
}

/// Asserts that a value is within a part of what it must be.
fn assert_close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance * expected.abs(), "{value}, not {expected}");
}

/// A 3D hook by its data sheet, and by the pieces that follow from it with a pocket calculator: tan 22.5° × 2 mm = 0.828427 mm.
#[test]
fn a_hooked_path_is_that_of_its_pieces_and_may_be_inclined_by_one_key() {
    let mut case = two_fibres();
    case["mesh"]["specimen"] = json!({ "type": "fibres", "width": 24, "depth": 24, "mesh_size": 3, "fibres": [
        { "name": "a", "diameter": 0.9, "embedded": 15.0,
          "path": { "type": "hooked", "hook": [2.12, 2.95], "angle_deg": 45, "bends": 2, "radius": 2.0, "free_length": 2 } } ] });
    let cut = 2.0 * (std::f64::consts::PI / 8.0).tan();
    let arc = 2.0 * std::f64::consts::FRAC_PI_4;
    let [tip, aslant] = [2.12 - cut, 2.95 - 2.0 * cut];
    let shaft = 15.0 - tip - aslant - 2.0 * arc;
    let nodes = |path: Option<Value>, rotate: f64| {
        let mut case = case.clone();
        let fibre = &mut case["mesh"]["specimen"]["fibres"][0];
        if let Some(path) = path {
            fibre["path"] = path;
        }
        fibre["rotate_deg"] = json!(rotate);
        accepted(&case, &[]).model.mesh.nodes().to_vec()
    };
    let same = |a: Vec<[f64; 2]>, b: Vec<[f64; 2]>| {
        // rounding may change the order of the block's nodes
        let nearest = |a: &[f64; 2]| b.iter().map(|b| (a[0] - b[0]).hypot(a[1] - b[1])).fold(f64::INFINITY, f64::min);
        let apart = a.iter().map(nearest).fold(0.0, f64::max);
        assert!(a.len() == b.len() && apart < 1e-9, "{} and {} nodes, {apart:e}", a.len(), b.len());
    };
    let pieces = |turns: [Value; 2], behind: Value| {
        let mut path = vec![json!({ "straight": tip })];
        path.extend([turns[0].clone(), json!({ "straight": aslant }), turns[1].clone()]);
        path.extend(behind.as_array().cloned().unwrap_or_default());
        Some(json!(path))
    };
    let to = |degrees: f64| json!({ "arc": { "radius": 2.0, "to_deg": degrees } });
    let by = |degrees: f64| json!({ "arc": { "radius": 2.0, "by_deg": degrees } });
    same(nodes(None, 0.0), nodes(pieces([to(45.0), to(0.0)], json!([{ "straight": shaft + 2.0 }])), 0.0));
    let out = json!([{ "straight": shaft }, { "arc": { "radius": 1.35, "to_deg": 0 } }, { "straight": 2 }]);
    let inclined = nodes(None, 30.0);
    same(inclined.clone(), nodes(pieces([to(45.0), to(0.0)], out.clone()), 30.0));
    same(inclined, nodes(pieces([by(45.0), by(-45.0)], out), 30.0));
}

/// Uniaxial compression of Drucker–Prager's outer cone is that of Mohr and Coulomb: 2 c cos φ/(1 − sin φ) = 4 c for sin φ = 3/5.
#[test]
fn what_concrete_bears_under_a_wire_follows_from_its_own_strength() {
    let mut case = two_fibres();
    let angle = 0.6_f64.asin().to_degrees();
    case["parts"]["matrix"]["material"] = json!({ "plugin": "drucker_prager", "props": {
        "E": 30000, "nu": 0.2, "cohesion": 10, "friction_angle_deg": angle, "dilation_angle_deg": 10, "cone": "outer" } });
    let bearing = |case: &Value, overrides: &[&str]| -> Vec<Option<[f64; 2]>> {
        let contacts = accepted(case, overrides).model.contacts;
        contacts.iter().map(|pair| pair.bearing.map(|bearing| [bearing.strength, bearing.depth])).collect()
    };
    for values in bearing(&case, &["contact.bearing=crushing"]) {
        // on each line of πφ/2
        let [strength, depth] = values.expect("it is crushed");
        assert_close(strength, 5.07 * 40.0 / (0.5 * std::f64::consts::PI), 1e-6);
        assert_close(depth, 5.07 * 5.07 * 40.0 / 30000.0 * 0.406, 1e-6);
    }
    let half = bearing(&case, &["contact.bearing=2.535"])[0].expect("it is crushed");
    assert_close(half[0], 2.535 * 80.0 / std::f64::consts::PI, 1e-6);
    let is_rigid = |case: &Value, overrides: &[&str]| bearing(case, overrides).iter().all(Option::is_none);
    assert!(is_rigid(&case, &[]) && is_rigid(&case, &["contact.bearing=rigid"]), "straight fibres");
    // of several fibres the hooked ones
    let mut hooked = case.clone();
    hooked["mesh"]["specimen"]["fibres"][0]["path"] = json!({ "type": "hooked", "hook": [1.5, 1.5], "radius": 0.6 });
    let program = accepted(&hooked, &[]);
    for pair in &program.model.contacts {
        let is_hooked = pair.name.starts_with("a.");
        assert_eq!(pair.bearing.is_some(), is_hooked, "{}", pair.name);
        assert_eq!((pair.penalty_factor == 1.0, pair.enforcement == Enforcement::Penalty), (is_hooked, is_hooked));
    }
    let notes = program.about.notes.join("\n");
    assert!(
        notes.contains("f_c = 40.00 MPa") && notes.contains("k = 5.07") && notes.contains("p_b = 129.1 MPa"),
        "{notes}"
    );
    // what decides the hook is shown, and the defaults are those of each kind of line
    assert!(program.about.highlights.len() == 1 && program.about.highlights[0].contains("f_c = 40.00 MPa"));
    let defaults = program.about.defaults.iter().filter(|line| line.starts_with("contact"));
    let defaults: Vec<&String> = defaults.filter(|line| line.contains("penalty_factor")).collect();
    let (first, others) = defaults.split_first().expect("the lines of the hook");
    assert!(first.contains("penalty_factor = 1,") && !others.is_empty(), "{defaults:?}");
    assert!(others.iter().all(|line| line.contains("penalty_factor = 100,")), "{defaults:?}");
    assert!(is_rigid(&hooked, &["contact.bearing=rigid"]));
    assert_eq!(accepted(&hooked, &["contact.penalty_factor=7"]).model.contacts[0].penalty_factor, 7.0);
    // elastic concrete has no strength
    let elastic = r#"parts.matrix.material={"plugin": "linear_elastic", "props": {"E": 30000, "nu": 0.2}}"#;
    assert!(is_rigid(&hooked, &[elastic]));
    for (overrides, words) in [
        (&[elastic, "contact.bearing=crushing"][..], "no strength"),
        (&["contact.bearing=-1"], "-1"),
        (&["contact.bearing=soft"], "soft"),
    ] {
        let text = problems_of(&case, overrides);
        assert!(text.contains("$.contact.bearing") && text.contains(words), "{text}");
    }
    let specimen = json!({ "type": "perpendicular_fibre", "axisymmetric": true, "embedded_elements": 10 });
    let mut perpendicular = specimen_case(specimen, &["fibre", "matrix"]);
    perpendicular["contact"] = case["contact"].clone();
    let text = problems_of(&perpendicular, &["contact.bearing=crushing"]);
    assert!(text.contains("$.contact.bearing") && text.contains("plane specimens"), "{text}");
}

/// The law that a class fills in has the class's f_c (40 + 8 MPa) where it is compressed.
#[test]
fn a_law_takes_the_class_of_a_concrete() {
    let mut case = two_fibres();
    let of = |material: Value| {
        let mut case = case.clone();
        case["parts"]["matrix"]["material"] = material;
        case
    };
    let by_class = of(json!({ "plugin": "concrete_damage_implex", "concrete": "C40/50" }));
    let program = accepted(&by_class, &["contact.bearing=crushing"]);
    let notes = program.about.notes.join("\n");
    assert!(notes.contains("f_c = 48 MPa, f_t = 3.509 MPa, E = 36268 MPa, G_f = 0.1465 N/mm"), "{notes}");
    assert!(program.about.highlights.join("\n").contains("f_c = 48.0"), "{:?}", program.about.highlights);
    let props = |case: &Value, overrides: &[&str]| {
        let laws = accepted(case, overrides).model.laws;
        laws.last().expect("the matrix's").props.clone()
    };
    let law = props(&by_class, &[]);
    assert_eq!(law, props(&by_class, &["parts.matrix.material.concrete=48"]));
    // what is given stands, and the strengths are the class's
    let stiff = [r#"parts.matrix.material.props={"E": 30000}"#, "contact.bearing=crushing"];
    assert_eq!(props(&by_class, &stiff[..1])[0], 30000.0);
    let highlights = accepted(&by_class, &stiff).about.highlights.join("\n");
    assert!(highlights.contains("f_c = 48.0"), "{highlights}");
    for (material, place, words) in [
        (json!({ "plugin": "concrete_damage", "concrete": "B40" }), "$.parts.matrix.material.concrete", "is no class"),
        (json!({ "plugin": "concrete_damage", "concrete": "C7" }), "$.parts.matrix.material.concrete", "C12 to C120"),
        (json!({ "plugin": "concrete_damage", "concrete": 300 }), "$.parts.matrix.material.concrete", "128 MPa"),
        (json!({ "plugin": "concrete_damage", "concrete": true }), "$.parts.matrix.material.concrete", "expected"),
        (
            json!({ "plugin": "concrete_damage", "concrete": "C40", "props": [30000] }),
            "$.parts.matrix.material.props",
            "list",
        ),
        (
            json!({ "plugin": "concrete_damage", "concrete": "C40", "props": { "nu": 0.6 } }),
            "$.parts.matrix.material.props",
            "nu",
        ),
        (json!({ "plugin": "linear_elastic", "concrete": "C40" }), "$.parts.matrix.material.concrete", "no strength"),
    ] {
        let text = problems_of(&of(material.clone()), &[]);
        assert!(text.contains(place) && text.contains(words), "{material}: {text}");
    }
    case["contact"]["law"]["concrete"] = json!("C40");
    let text = problems_of(&case, &[]);
    assert!(text.contains("$.contact.law.concrete") && text.contains("bond_slip"), "{text}");
}

#[test]
fn a_layered_fibre_has_the_area_and_the_plastic_moment_of_the_round_one() {
    let mut case = two_fibres();
    case["parts"]["fibre"]["thickness"] = json!("layers");
    let model = accepted(&case, &["mesh.specimen.elements_across=4"]).model;
    let (mut area, mut moment) = (0.0, 0.0);
    // the lowest row of the fibre at x = −2
    let at = |node: usize| model.mesh.nodes()[node];
    let row = model.mesh.elements().iter().filter(|element| {
        let is_lowest = element.nodes()[..4].iter().any(|&node| (at(node)[1] + 10.6).abs() < 1e-9);
        model.mesh.parts()[element.part()].name == "fibre.a" && is_lowest
    });
    for element in row {
        let corners = &element.nodes()[..4];
        let [low, high] =
            [f64::min, f64::max].map(|of| corners.iter().map(|&node| at(node)[0] + 2.0).reduce(of).expect("corners"));
        area += element.thickness() * (high - low);
        moment += element.thickness() * 0.5 * (high * high - low * low).abs();
    }
    assert_close(area, std::f64::consts::FRAC_PI_4 * 0.406 * 0.406, 1e-9);
    assert_close(moment, 0.406_f64.powi(3) / 6.0, 1e-9);
    let text = problems_of(&case, &[]);
    assert!(text.contains("$.parts.fibre.thickness") && text.contains("elements_across"), "{text}");
}

#[test]
fn clockwise_elements_of_a_file_are_reversed_and_reported() {
    let bench = Bench::new();
    let text = two_bodies();
    assert!(program(&[]).about.warnings.is_empty());
    // a quadrilateral of the matrix the other way round
    let line = text.lines().find(|line| line.starts_with("2 3 2 ")).expect("an element");
    let words: Vec<&str> = line.split(' ').collect();
    let turned = [&words[..5], &[words[8], words[7], words[6], words[5]]].concat().join(" ");
    std::fs::write(bench.0.path().join("turned.msh"), text.replace(line, &turned)).expect("a mesh");
    let Ok(Case::Pullout(program)) = bench.read(&pullout_case(), &["mesh.file=turned.msh"]) else { panic!("a case") };
    let [warning] = program.about.warnings.as_slice() else { panic!("{:?}", program.about.warnings) };
    assert!(warning.ends_with("turned.msh: element 2 has clockwise nodes: turned round"), "{warning}");
    let areas = |mesh: &fe_core::mesh::Mesh| (0..12).map(|element| mesh.element_area(element)).sum::<f64>();
    assert!((areas(&program.model.mesh) - 2.8).abs() < 1e-12);
}

/// Consequences of a mesh that cannot be made, or of a misspelt key, are not reported: only the cause is.
#[test]
fn of_a_specimen_that_cannot_be_read_only_the_cause_is_reported() {
    let mut case = pullout_case();
    for key in ["grip", "supports", "measure"] {
        case.as_object_mut().expect("an object").remove(key);
    }
    let specimen = json!({ "type": "perpendicular_fibre", "embedded_elements": 6, "interface_size": 2.0 });
    case["mesh"] = json!({ "specimen": specimen });
    case["contact"] = json!({ "law": case["contact"]["law"] });
    case["steps"] = json!([{ "slip": 0.001, "increments": 2 }]);
    let problems = |case: &Value| {
        let errors = Bench::new().read(case, &[]).expect_err("malformed");
        errors.problems.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let renamed = |place: &str, key: &str, other: &str| {
        let mut case = case.clone();
        let members = case.pointer_mut(place).and_then(Value::as_object_mut).expect("an object");
        let value = members.remove(key).expect("a member");
        members.insert(other.into(), value);
        problems(&case)
    };
    for (key, value, place) in [
        ("embedded_elements", json!(-1), "$.mesh.specimen.embedded_elements: must be >= 1"),
        ("embedded_length", json!(-1), "$.mesh.specimen.embedded_length: must be > 0"),
        ("type", json!("perpendicular_fibr"), "$.mesh.specimen.type: there is no 'perpendicular_fibr'"),
        ("interface_size", json!("x"), "$.mesh.specimen.interface_size: expected a number"),
    ] {
        let mut case = case.clone();
        case["mesh"]["specimen"][key] = value;
        let problems = problems(&case);
        assert!(problems.len() == 1 && problems[0].starts_with(place), "{problems:?}");
    }
    for (place, key, other, expected) in [
        ("/mesh/specimen", "type", "typ", "$.mesh.specimen.typ: unknown key"),
        ("/mesh", "specimen", "speciment", "$.mesh.speciment: unknown key"),
        ("", "mesh", "mes", "$.mes: unknown key"),
        ("", "parts", "part", "$.part: unknown key"),
        ("", "contact", "contac", "$.contac: unknown key"),
        ("/contact", "law", "lw", "$.contact.lw: unknown key"),
        ("/parts", "fibre", "fibr", "$.parts.fibr: the specimen has no part 'fibr'"),
    ] {
        let problems = renamed(place, key, other);
        assert!(problems.len() == 1 && problems[0].starts_with(expected), "{problems:?}");
    }
}

#[test]
fn all_problems_of_a_specimen_are_reported_at_once() {
    let of_structure = ["output.every=0", "colour=red"];
    let of_meaning = [
        "grip.nodes=nowhere",
        "contact.slave=nothing",
        "parts.fibre.material.props.E=-1",
        "parts.matrix.material.plugin=bond_slip",
        "steps.0.drives={\"x\": 1}",
    ];
    let both = [&of_structure[..], &of_meaning].concat();
    for (overrides, count) in [(&of_structure[..], 2), (&both, 2), (&of_meaning, 7)] {
        let errors = Bench::new().read(&pullout_case(), overrides).expect_err("malformed");
        assert_eq!((errors.problems.len(), errors.exit_code()), (count, 2), "{errors}");
    }
}

#[test]
fn a_thickness_that_nobody_means_is_reported() {
    let warnings = |thickness: &str| program(&[&format!("parts.fibre.thickness={thickness}")]).about.warnings;
    let expected = "the thickness of the part 'fibre' = 1·10⁻¹² mm is outside the usual range, 0.001 to 100000 mm";
    assert!(warnings("1e-12").iter().any(|warning| warning.starts_with(expected)), "{:?}", warnings("1e-12"));
    assert!(!warnings("0.3").iter().any(|warning| warning.contains("usual range")));
}

#[test]
fn sizes_that_a_specimen_takes_by_default_are_listed() {
    let mut case = pullout_case();
    case["mesh"] = json!({ "specimen": { "type": "perpendicular_fibre", "embedded_length": 2.0 } });
    for key in ["contact", "grip", "supports", "measure"] {
        case.as_object_mut().expect("an object").remove(key);
    }
    case["contact"] = json!({ "law": { "plugin": "bond_slip", "props": {} } });
    let defaults = accepted(&case, &[]).about.defaults;
    let sizes = defaults.iter().find(|line| line.starts_with("mesh.specimen: ")).expect("sizes");
    assert!(sizes.contains("fibre_diameter = ") && sizes.contains("width = "), "{sizes}");
    assert!(!sizes.contains("embedded_length"), "{sizes}");
    assert!(defaults.iter().any(|line| line.starts_with("contact.law.props: law = A")), "{defaults:?}");
    assert!(
        defaults.iter().any(|line| line.starts_with("contact: quadrature.gauss = 2, penalty_factor = 100")),
        "{defaults:?}"
    );
}

#[test]
fn all_that_a_plate_takes_by_default_is_listed() {
    let mut case = specimen_case(json!({ "type": "plate_with_hole", "cells": 8 }), &["plate"]);
    case["parts"]["plate"]["integration"] = json!("reduced");
    case["controls"] = json!({ "force_tolerance": 1e-4 });
    assert_eq!(
        accepted(&case, &[]).about.defaults,
        [
            "mesh.specimen: width = 10, height = 10, radius = 1, grading = 10, element = Q8",
            "parts.plate: model = plane_strain, thickness = 1, nlgeom = false",
            "supports: standard (symmetry_x: x, symmetry_y: y)",
            "steps: time = 1, increments.maximum = 0.02, increments.initial = 0.001, increments.minimum = 1·10⁻⁸",
            "controls: displacement_tolerance = 1·10⁻⁵, max_iterations = 20, max_cutbacks = 30, line_search = true, \
             locate_peak = true, relaxation_time = 0",
        ]
    );
    let overrides = ["mesh.specimen.element=Q4", "parts.plate.integration=full", "nlgeom=true"];
    let defaults = accepted(&case, &overrides).about.defaults;
    assert_eq!(defaults[1], "parts.plate: model = plane_strain, thickness = 1, average_dilatation = true");
}

#[test]
fn a_key_with_a_default_takes_null_and_whole_numbers_with_a_point() {
    let given = json!({ "type": "plate_with_hole", "cells": 8.0, "width": null, "grading": 5 });
    let case = specimen_case(given, &["plate"]);
    let program = accepted(&case, &["controls={\"max_iterations\": null, \"max_cutbacks\": 0.0}"]);
    assert_eq!(program.about.defaults[0], "mesh.specimen: width = 10, height = 10, radius = 1, element = Q8");
    let controls = program.about.defaults.iter().find(|line| line.starts_with("controls: ")).expect("controls");
    assert!(controls.contains("max_iterations = 20") && !controls.contains("max_cutbacks"), "{controls}");
    assert_eq!(program.model.controls.max_cutbacks, 0);
}

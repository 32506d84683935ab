//! The replay case of a failed run: the state of the failing point before the increment, and the increment.

use super::Program;
use crate::isolation::replay::{self as recorded, umat_arguments};
use crate::path::replay::{StrainDrive, duration, set_fields};
use crate::program::job_folder;
use crate::program::{STRAIN_NAMES, STRESS_NAMES};
use fe_core::assembly::{Place, Trouble};
use fe_core::contact::NormalDrive;
use fe_core::kinematics::PlaneModel;
use fe_core::model::{ContactLaw, PluginLaw};
use fe_core::stepping::Snapshot;
use serde_json::{Map, Value, json};
use umat_abi::host::TangentSource;

/// Of a material or contact point whose law was called last and stopped the run; null where there is none.
pub fn of(program: &Program, trouble: &Trouble, snapshot: &Snapshot<'_>) -> Value {
    let title = format!("Replay of a failed increment: {}, {}", program.about.title, trouble.place);
    let case = match &trouble.place {
        Place::Element { element, point, .. } => material_point(program, [*element, *point], title, snapshot),
        Place::Contact { pair, point, .. } => contact_point(program, pair, *point, title, snapshot),
        Place::Node { .. } | Place::System => None,
    };
    case.map_or(Value::Null, |mut case| {
        case["job_folder"] = json!(job_folder(&program.about.case_file, &Value::Null).to_string_lossy());
        case
    })
}

/// A case of kind "point". What large displacements turn is given as turned, and its rotation left out.
fn material_point(
    program: &Program,
    [element, point]: [usize; 2],
    title: String,
    snapshot: &Snapshot<'_>,
) -> Option<Value> {
    let call = snapshot.solids().last_call(element, point)?;
    let mesh = &program.model.mesh;
    let part = mesh.elements()[element].part();
    let law = &program.model.laws[part];
    let model = mesh.parts()[part].model;
    let has_strain_33 = model == PlaneModel::Axisymmetric || call.strain[2] != 0.0 || call.strain_increment[2] != 0.0;
    // the four components of the plane are the first of the six of a case
    let StrainDrive { mode, components, driven } = StrainDrive::new(model.stress_state(), has_strain_33);
    let named = |names: &[&str; 6], which: &[usize], values: [f64; 4]| {
        which.iter().map(|&k| (names[k].to_owned(), json!(values[k]))).collect::<Map<_, _>>()
    };
    // what the program finds of plane stress it goes on from
    let strains = if call.through_six { &[0, 1, 2, 3] } else { components };
    let mut material = material(law, &law.props, None);
    if call.through_six {
        material["as"] = json!("3d");
    }
    if law.manner.tangent == Some(TangentSource::Numerical) {
        material["tangent"] = json!("numerical");
    }
    let end = std::array::from_fn(|k| call.strain[k] + call.strain_increment[k]);
    let mut case = json!({
        "kind": "point",
        "title": title,
        "material": material,
        "mode": mode,
        "characteristic_length": call.characteristic_length,
        "initial": {
            "strain": named(&STRAIN_NAMES, strains, call.strain),
            "stress": named(&STRESS_NAMES, components, call.stress),
            "statev": call.statev,
            "time": call.time,
        },
        "steps": [{
            "increments": 1,
            "time": duration(call.time_increment),
            "target": named(&STRAIN_NAMES, driven, end),
        }],
    });
    case["arguments"] = umat_arguments(&call.arguments, true);
    let [start, end] = &call.fields;
    set_fields(&mut case, start, end);
    Some(case)
}

/// A case of kind "interface".
fn contact_point(program: &Program, pair: &str, point: usize, title: String, snapshot: &Snapshot<'_>) -> Option<Value> {
    let call = snapshot.contact().last_call(pair, point)?;
    let (law, entry) = match &program.model.contacts.iter().find(|other| other.name == pair)?.law {
        ContactLaw::Uinter(law) => (law, "uinter"),
        ContactLaw::Fric { law, .. } => (law, "fric"),
    };
    let [start, end] = call.slip;
    let mut initial = json!({ "statev": call.statev, "time": call.time, "slip": start });
    let mut target = json!({ "slip": end });
    match call.normal {
        NormalDrive::Gap([start, end]) => (initial["gap"], target["gap"]) = (json!(start), json!(end)),
        NormalDrive::Pressure(end) => target["p"] = json!(end),
    }
    let mut case = json!({
        "kind": "interface",
        "title": title,
        "material": material(law, call.props, Some(entry)),
        "characteristic_length": call.characteristic_length,
        "initial": initial,
        "steps": [{ "increments": 1, "time": duration(call.time_increment), "target": target }],
    });
    case["arguments"] = recorded::contact_point(&call.arguments)?["arguments"].take();
    let [start, end] = &call.fields;
    set_fields(&mut case, start, end);
    Some(case)
}

/// The library by its absolute path: the case may be moved.
fn material(law: &PluginLaw, props: &[f64], entry: Option<&str>) -> Value {
    let path = law.library.path();
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let mut material = json!({ "plugin": path.to_string_lossy(), "cmname": law.cmname, "props": props });
    if let Some(symbol) = &law.symbol {
        material["symbol"] = json!(symbol);
    }
    if let Some(entry) = entry {
        material["entry"] = json!(entry);
    }
    if law.law.is_none() {
        material["nstatv"] = json!(law.nstatv);
    }
    material
}

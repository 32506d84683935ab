//! The replay case of a failed run: the state of the failing point before the increment, and the increment.

use super::PulloutProgram;
use crate::isolation::replay::of_call;
use crate::program::{STRAIN_NAMES, job_folder};
use crate::replay::{OF_INCREMENT, entitle};
use fe_core::assembly::solids::PointCall;
use fe_core::assembly::{Location, PointFailure};
use fe_core::model::{ContactLaw, PluginLaw};
use fe_core::stepping::Snapshot;
use serde_json::{Value, json};
use umat_abi::host::TangentSource;
use umat_abi::host::recorder::{CallRecord, RecordedArguments};

/// Returns the case of a material or contact point whose law was called last and stopped the run; null where there is none. What large
/// displacements turn is given as turned.
pub fn of(program: &PulloutProgram, trouble: &PointFailure, snapshot: &Snapshot<'_>) -> Value {
    let case = match &trouble.place {
        Location::Element { element, point, .. } => material_point(program, [*element, *point], snapshot),
        Location::Contact { pair, point, .. } => contact_point(program, pair, *point, snapshot),
        Location::Node { .. } | Location::System => None,
    };
    case.map_or(Value::Null, |mut case| {
        let title = format!("{}, {}", program.about.title, trouble.place);
        entitle(&mut case, OF_INCREMENT, &title, &job_folder(&program.about.case_file, &Value::Null));
        case
    })
}

/// A case of kind "point".
fn material_point(program: &PulloutProgram, [element, point]: [usize; 2], snapshot: &Snapshot<'_>) -> Option<Value> {
    let PointCall { arguments, strain_33 } = snapshot.solids().last_call(element, point)?;
    let law = &program.model.laws[program.model.mesh.elements()[element].part()];
    let mut case = of_call(&record(law, RecordedArguments::Umat(arguments)))?;
    if let Some(strain_33) = strain_33 {
        // what the program finds of plane stress it goes on from
        case["initial"]["strain"][STRAIN_NAMES[2]] = json!(strain_33);
        case["material"]["as"] = json!("3d");
    }
    if law.manner.tangent == Some(TangentSource::Numerical) {
        case["material"]["tangent"] = json!("numerical");
    }
    Some(case)
}

/// A case of kind "interface".
fn contact_point(program: &PulloutProgram, pair: &str, point: usize, snapshot: &Snapshot<'_>) -> Option<Value> {
    let (ContactLaw::Uinter(law) | ContactLaw::Fric { law, .. }) =
        &program.model.contacts.iter().find(|other| other.name == pair)?.law;
    of_call(&record(law, snapshot.contact().last_call(pair, point)?))
}

fn record(law: &PluginLaw, arguments: RecordedArguments) -> CallRecord {
    CallRecord {
        name: law.name.clone(),
        library: law.library.path().to_path_buf(),
        symbol: law.symbol.clone(),
        cmname: law.cmname.clone(),
        wants_tangent: true,
        arguments,
    }
}

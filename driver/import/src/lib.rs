//! `pullout import`: a one-element ABAQUS job as a case of kind "point".
//!
//! `keywords` reads the lines, `model` what they mean, `element` and `history` make strains and stresses of
//! displacements and loads. What a material point has no place for is left out and named; what would make another
//! problem of it is refused with its line.

mod element;
mod history;
mod keywords;
mod model;
mod options;
mod orientation;
mod schedule;
#[cfg(test)]
mod test;
mod uniform;

use history::Evolution;
use model::{Material, Model};
use orientation::Axes;
use serde_json::{Value, json};
use std::path::Path;
use umat_abi::host::{Found, search_paths};

/// A case made from an input file.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The case, or the material alone.
    pub document: Value,
    /// Keywords that were not taken over, with their places.
    pub left_out: Vec<String>,
}

/// Options of an import.
#[derive(Clone, Copy, Debug, Default)]
pub struct ImportOptions<'w> {
    /// Only the material of this name.
    pub material: Option<&'w str>,
    /// The law's name or library; default: the shipped law with the name of the material.
    pub plugin: Option<&'w str>,
}

/// Reads a job.
///
/// # Errors
/// Why it is no job of one box-shaped element with a user material, with the place.
pub fn import(job: &Path, options: ImportOptions<'_>) -> Result<Imported, String> {
    let mut model = Model::default();
    for keyword in keywords::read(job)? {
        model.take(&keyword)?;
    }
    if let Some(name) = options.material {
        let material = model.material(name).map_err(|error| format!("{}: {error}", job.display()))?;
        let mut left_out = material.left_out.clone();
        let document = material_block(material, options.plugin, &mut left_out);
        return Ok(Imported { document, left_out });
    }
    let mut left_out = std::mem::take(&mut model.left_out);
    let (brick, material) = model.brick_and_material().map_err(|error| format!("{}: {error}", job.display()))?;
    let mut case = json!({ "kind": "point", "mode": brick.shape.mode });
    if let Some(title) = &model.title {
        case["title"] = json!(title);
    }
    case["material"] = material_block(material, options.plugin, &mut left_out);
    let axes = model.local_axes()?;
    if let Some(axes) = axes.and_then(Axes::for_case) {
        case["material"]["orientation"] = axes;
        if !model.initial.stress.is_empty() {
            left_out
                .push("the local axes of the initial stress: the case applies it in the axes of the job".to_owned());
        }
    }
    case["characteristic_length"] = json!(brick.characteristic_length());
    // a shipped law reports its thickness strain
    let has_thickness = brick.shape.mode != "plane_stress" || case["material"]["nstatv"].is_null();
    if let Some(reason) = model.without_steps() {
        return Err(format!("{}: {reason}", job.display()));
    }
    let evolution = Evolution::of(&model, &brick, has_thickness)?;
    left_out.extend(evolution.left_out);
    let is_sheared_at_start = model.initial.stress.iter().skip(3).any(|stress| *stress != 0.0);
    if !evolution.loose_shears.is_empty() && (is_sheared_at_start || axes.is_some_and(Axes::is_oblique)) {
        let names: Vec<_> = evolution.loose_shears.into_iter().collect();
        let place = model.section_place().map(|place| format!("{place}: "));
        left_out.push(format!(
            "{}the shear of free faces: the case holds {} at 0, the job only at some nodes. The results are the same only if \
             the law has no shear stress there",
            place.unwrap_or_default(),
            names.join(", ")
        ));
    }
    if evolution.nlgeom {
        case["nlgeom"] = json!(true);
        // displacements that grow in proportion are stretches that do
        case["measure"] = json!("nominal");
    }
    let initial = &model.initial;
    for (key, values) in [("stress", &initial.stress), ("statev", &initial.states)] {
        if !values.is_empty() {
            case["initial"][key] = json!(values);
        }
    }
    if let Some(temperature) = initial.temperature {
        case["temperature"] = json!(temperature);
    }
    if !initial.fields.is_empty() {
        case["predef"] = json!(initial.fields);
    }
    case["steps"] = json!(evolution.steps);
    let name = job.file_name().unwrap_or_default().to_string_lossy();
    let rest = if left_out.is_empty() { String::new() } else { format!(" Not imported: {}.", left_out.join("; ")) };
    case["description"] = json!(format!("Imported from {name}.{rest}"));
    Ok(Imported { document: case, left_out })
}

/// Returns the material block of a case.
fn material_block(material: &Material, plugin: Option<&str>, left_out: &mut Vec<String>) -> Value {
    let own = material.name.to_lowercase();
    let shipped = Found::by_name(&own, &search_paths(&[])).map(|_| own);
    let (plugin, is_shipped) = match (plugin, shipped) {
        (Some(plugin), _) => (plugin.to_owned(), false),
        (None, Some(own)) => (own, true),
        (None, None) => {
            left_out.push(format!(
                "{}: the library of {}: \"plugin\" is ./libumat.so; --plugin sets it",
                material.place, material.name
            ));
            ("./libumat.so".to_owned(), false)
        }
    };
    let mut block = json!({ "plugin": plugin, "props": material.constants });
    if let Some(expansion) = &material.expansion {
        block["expansion"] = expansion.clone();
    }
    if !is_shipped {
        block["nstatv"] = json!(material.states);
        block["cmname"] = json!(material.name);
    }
    block
}

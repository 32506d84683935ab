//! CalculiX decks of models: what the two cases need and no more.

use crate::BenchError;
use fe_core::element::{ElementKind, Integration};
use fe_core::kinematics::PlaneModel;
use fe_core::model::{LoadKind, Model, PluginLaw, StepControl};
use std::fmt::Write as _;

/// The element type: that of a part's model, reduced as ours.
fn element_type(kind: ElementKind, model: PlaneModel) -> String {
    let family = match model {
        PlaneModel::PlaneStress => "CPS",
        PlaneModel::PlaneStrain => "CPE",
        PlaneModel::Axisymmetric => "CAX",
    };
    let reduced = if kind.default_integration() == Integration::Reduced { "R" } else { "" };
    format!("{family}{}{reduced}", kind.node_count())
}

fn unknown(what: &str) -> BenchError {
    BenchError::Failed(format!("no deck of CalculiX is written of {what}"))
}

fn material(law: &PluginLaw, name: &str) -> Result<String, BenchError> {
    let [modulus, poisson, hardening @ ..] = &law.props[..] else { return Err(unknown("a law without E and nu")) };
    let mut text = format!("*MATERIAL, NAME={name}\n*ELASTIC\n{modulus}, {poisson}\n");
    if !hardening.is_empty() {
        text.push_str("*PLASTIC\n");
        for pair in hardening.chunks_exact(2) {
            let _ = writeln!(text, "{}, {}", pair[0], pair[1]);
        }
    }
    Ok(text)
}

/// Nodes, elements by part, materials, sections.
fn bodies(model: &Model) -> Result<String, BenchError> {
    let mesh = &model.mesh;
    let mut text = String::from("*NODE, NSET=NALL\n");
    for (node, [x, y]) in mesh.nodes().iter().enumerate() {
        let _ = writeln!(text, "{}, {x:.12e}, {y:.12e}, 0.", node + 1);
    }
    for (index, (part, law)) in mesh.parts().iter().zip(&model.laws).enumerate() {
        let elements = mesh.elements().iter().enumerate().filter(|(_, element)| element.part() == index);
        for (count, (number, element)) in elements.enumerate() {
            if count == 0 {
                let kind = element_type(element.kind(), part.model);
                let _ = writeln!(text, "*ELEMENT, TYPE={kind}, ELSET=PART{index}");
            }
            let nodes: Vec<String> = element.nodes().iter().map(|node| (node + 1).to_string()).collect();
            let _ = writeln!(text, "{}, {}", number + 1, nodes.join(", "));
        }
        text.push_str(&material(law, &format!("LAW{index}"))?);
        let _ = writeln!(text, "*SOLID SECTION, ELSET=PART{index}, MATERIAL=LAW{index}\n{}", part.thickness);
    }
    Ok(text)
}

fn set(text: &mut String, name: &str, nodes: &[usize]) {
    let _ = writeln!(text, "*NSET, NSET={name}");
    for node in nodes {
        let _ = writeln!(text, "{}", node + 1);
    }
}

/// Node sets and fixed boundaries of all supports that no drive moves.
fn supports(model: &Model) -> String {
    let mut text = String::new();
    for (index, support) in model.supports.iter().enumerate() {
        set(&mut text, &format!("S{index}"), &support.nodes);
    }
    text.push_str("*BOUNDARY\n");
    for (index, support) in model.supports.iter().enumerate().filter(|(_, support)| support.drive.is_none()) {
        let component = 1 + usize::from(support.direction[1] != 0.0);
        let _ = writeln!(text, "S{index}, {component}, {component}");
    }
    text
}

fn step(model: &Model, index: usize, body: &str) -> Result<String, BenchError> {
    let step = &model.steps[index];
    let nlgeom = if model.has_large_displacements() { ", NLGEOM" } else { "" };
    let sizes = match step.control {
        StepControl::Fixed { increments } => {
            format!("*STATIC, DIRECT\n{}, {}\n", step.time / increments as f64, step.time)
        }
        StepControl::Automatic { initial, maximum, minimum } => format!(
            "*STATIC\n{}, {}, {}, {}\n",
            initial * step.time,
            step.time,
            minimum * step.time,
            maximum * step.time
        ),
    };
    let measured = *model.measured.supports.first().ok_or_else(|| unknown("a case that measures no load"))?;
    Ok(format!(
        "*STEP, INC=100000{nlgeom}\n{sizes}{body}*NODE PRINT, NSET=S{measured}, TOTALS=ONLY, FREQUENCY=100000\nRF\n*END STEP\n"
    ))
}

/// Values of supports that drives move, at the end of a step.
fn driven(model: &Model, step: usize) -> String {
    let mut text = String::from("*BOUNDARY\n");
    for (index, support) in model.supports.iter().enumerate() {
        let Some(drive) = support.drive else { continue };
        let component = 1 + usize::from(support.direction[1] != 0.0);
        let value = model.steps[..=step].iter().filter_map(|step| step.targets[drive]).next_back().unwrap_or(0.0);
        let sign = support.direction[component - 1].signum();
        let _ = writeln!(text, "S{index}, {component}, {component}, {}", sign * value);
    }
    text
}

/// Bodies, supports and steps: the plate with a hole.
pub fn plate(model: &Model) -> Result<String, BenchError> {
    let mut text = bodies(model)? + &supports(model);
    for index in 0..model.steps.len() {
        text += &step(model, index, &driven(model, index))?;
    }
    Ok(text)
}

/// A surface. Faces of plane elements are their edges, counted from 1 in the order in which ours count from 0.
fn faces(text: &mut String, name: &str, edges: &[fe_core::mesh::ElementEdge]) {
    let _ = writeln!(text, "*SURFACE, NAME={name}, TYPE=ELEMENT");
    for edge in edges {
        let _ = writeln!(text, "{}, S{}", edge.element + 1, edge.edge + 1);
    }
}

/// Penalty of CalculiX's contact, MPa/mm: 5 times the stiffer Young's modulus, the least that its manual advises. With 50
/// times it diverges in these increments.
const NORMAL_PENALTY: f64 = 5.0 * 210e3;
/// Tension at large clearance, MPa, which smooths the corner of the law, and the clearance up to which contact is looked
/// for, relative to the face's size.
const TENSION_AND_CLEARANCE: [f64; 2] = [1.0, 1e-3];
/// Coefficient of friction, and stiffness of sticking, MPa/mm: a hundredth of the penalty.
const FRICTION: [f64; 2] = [0.3, 0.01 * NORMAL_PENALTY];

/// Writes the drag-out strip: node-to-surface penalty contact with friction.
pub fn strip(model: &Model) -> Result<String, BenchError> {
    let [pair] = &model.contacts[..] else { return Err(unknown("anything but one pair of surfaces")) };
    let mut text = bodies(model)? + &supports(model);
    faces(&mut text, "SLAVE", &pair.slave);
    faces(&mut text, "MASTER", &pair.master);
    let [tension, clearance] = TENSION_AND_CLEARANCE;
    let [coefficient, sticking] = FRICTION;
    let _ = writeln!(
        text,
        "*SURFACE INTERACTION, NAME=RUB\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n\
         {NORMAL_PENALTY}, {tension}, {clearance}\n*FRICTION\n{coefficient}, {sticking}\n\
         *CONTACT PAIR, INTERACTION=RUB, TYPE=NODE TO SURFACE\nSLAVE, MASTER"
    );
    for index in 0..model.steps.len() {
        let mut body = driven(model, index);
        for load in &model.loads {
            let value =
                model.steps[..=index].iter().filter_map(|step| step.targets[load.drive]).next_back().unwrap_or(0.0);
            let LoadKind::Pressure { edges, pressure } = &load.kind else {
                return Err(unknown("a load that is no pressure"));
            };
            body.push_str("*DLOAD\n");
            for edge in edges {
                let _ = writeln!(body, "{}, P{}, {}", edge.element + 1, edge.edge + 1, pressure * value);
            }
        }
        text += &step(model, index, &body)?;
    }
    Ok(text)
}

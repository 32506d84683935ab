//! Checks of a specimen as a whole: it may be impossible to compute although each of its parts is sound.

use super::mesh::{COVER, DefaultSupports, MATRIX};
use super::scalar_field::may_have_source;
use crate::problem::Place;
use crate::reader::Reader;
use fe_core::mesh::preflight::{self, Body, Finding, RigidMode};
use fe_core::mesh::{Element, Mesh};
use fe_core::model::{Model, Support};
use std::collections::BTreeSet;

/// Nodes that hang, and bodies that nothing holds. `replaced`: the supports of the specimen that those of the case replace.
pub fn check(reader: &mut Reader<'_>, model: &Model, replaced: Option<&DefaultSupports>) {
    let joints = joints(model);
    let exempt: Vec<usize> = joints.iter().flatten().copied().collect::<BTreeSet<_>>().into_iter().collect();
    let behind = model.parts_behind();
    for finding in preflight::findings(&model.mesh, &exempt) {
        if finding.is_fault() && !is_end_of_cover(&model.mesh, &behind, &finding) {
            reader.problem(&Place::root().key("mesh"), finding.to_string());
        } else {
            reader.warn(format!("mesh: {finding}"));
        }
    }
    let mut reported: Vec<&str> = Vec::new();
    for support in &model.supports {
        let is_graded = |element: &&Element| {
            let part = &model.mesh.parts()[element.part()];
            [MATRIX, COVER].contains(&part.name.as_str()) && element.thickness() < part.thickness
        };
        let mut graded = model.mesh.elements().iter().filter(is_graded).flat_map(Element::nodes);
        if !reported.contains(&support.name.as_str()) && graded.any(|node| support.nodes.contains(node)) {
            reported.push(&support.name);
            let message =
                "holds elements of graded thickness: they are thinner than what it stands on; give a smaller extent";
            reader.warn(format!("support '{}' {message}", support.name));
        }
    }
    check_field(reader, model);
    let held = held(model.supports.iter());
    for group in groups(&model.mesh, &joints) {
        let free = preflight::rigid_body_freedom(&model.mesh, &group, &held);
        if !free.is_empty() {
            let modes: Vec<String> = free.iter().map(ToString::to_string).collect();
            let (body, modes) = (in_words(model, &group), modes.join(" and "));
            let own = replaced.map_or_else(String::new, |own| {
                format!("; \"supports\" of the case replace those of the specimen, {}", own.in_words())
            });
            let message = format!("{body} {modes}: no support holds it, nor anything that it touches{own}");
            reader.problem(&Place::root().key("supports"), message);
        } else if model.loads.is_empty() {
            warn_of_free_ride(reader, model, &group);
        }
    }
}

/// Values and fluxes where there is no field, and steady heat that no value determines.
fn check_field(reader: &mut Reader<'_>, model: &Model) {
    let Some(field) = &model.field else { return };
    let root = Place::root().key("field");
    let bodies = preflight::bodies_of(&model.mesh, |element| field.parts[element.part()]);
    let has_field = |node: &usize| bodies.iter().any(|body| body.nodes.binary_search(node).is_ok());
    for (index, fixed) in field.fixed.iter().enumerate() {
        if !fixed.nodes.iter().any(has_field) {
            reader.problem(&root.key("fixed").index(index), OUTSIDE);
        }
    }
    for (index, flux) in field.fluxes.iter().enumerate() {
        if !flux.edges.iter().any(|&edge| model.mesh.edge_nodes(edge).nodes().iter().all(has_field)) {
            reader.problem(&root.key("fluxes").index(index), OUTSIDE);
        }
    }
    // a source that falls with the field determines it as well
    let is_of_routines = field.has_generation || field.transfer.is_some();
    if field.is_phase_field() || field.capacity > 0.0 || is_of_routines {
        return;
    }
    for body in bodies {
        let is_fixed =
            field.fixed.iter().flat_map(|fixed| &fixed.nodes).any(|node| body.nodes.binary_search(node).is_ok());
        let mut laws = body.elements.iter().map(|&element| &model.laws[model.mesh.elements()[element].part()]);
        if !is_fixed && !laws.any(may_have_source) {
            let body = in_words(model, &body);
            let message = format!(
                "{body} has no fixed value, without which a steady temperature is not determined: fix the value of some nodes, or give \
                 a \"capacity\""
            );
            reader.problem(&root.key("fixed"), message);
        }
    }
}

/// Says that fixed values or fluxes have no effect.
const OUTSIDE: &str = "is where no part has the field: \"parts\" of the field names those that have it";

/// A body by its first element.
fn in_words(model: &Model, body: &Body) -> String {
    let first = body.elements[0];
    let part = &model.mesh.parts()[model.mesh.elements()[first].part()].name;
    format!("the body with element {} (part '{part}')", first + 1)
}

/// The nodes that supports hold, and the direction of each.
fn held<'m>(supports: impl Iterator<Item = &'m Support>) -> Vec<(usize, [f64; 2])> {
    supports.flat_map(|support| support.nodes.iter().map(|&node| (node, support.direction))).collect()
}

/// Warns of bodies that only one drive holds along some direction: they go along with it, and nothing resists.
fn warn_of_free_ride(reader: &mut Reader<'_>, model: &Model, group: &Body) {
    let drives: BTreeSet<usize> = model.supports.iter().filter_map(|support| support.drive).collect();
    for drive in drives {
        let held = held(model.supports.iter().filter(|support| support.drive != Some(drive)));
        let free = preflight::rigid_body_freedom(&model.mesh, group, &held);
        if let Some(mode @ RigidMode::Translation { .. }) = free.first() {
            let (body, drive) = (in_words(model, group), &model.drives[drive]);
            reader.warnings.push(format!(
                "supports: {body} and what it touches {mode} with the drive '{drive}': nothing holds it back"
            ));
        }
    }
}

/// Returns whether a node hangs where the end of a cover meets the end of its hole, not joined to it: the slot there is as short as
/// the fibre is thick, and the walls hold both.
fn is_end_of_cover(mesh: &Mesh, behind: &[usize], finding: &Finding) -> bool {
    let Finding::HangingNode { node, element, .. } = *finding else { return false };
    let is_behind = |element: &Element| behind.contains(&element.part());
    let mut with_node = mesh.elements().iter().filter(|element| element.nodes().contains(&node));
    is_behind(&mesh.elements()[element]) || with_node.all(is_behind)
}

/// Sets of nodes that contact or a coupling joins.
fn joints(model: &Model) -> Vec<Vec<usize>> {
    let edges = |pair: &fe_core::model::ContactPair| {
        pair.slave.iter().chain(&pair.master).flat_map(|&edge| model.mesh.edge_nodes(edge).nodes().to_vec()).collect()
    };
    model.contacts.iter().map(edges).chain(model.couplings.iter().map(|coupling| coupling.nodes().collect())).collect()
}

/// Bodies that joints hold together, as one each.
fn groups(mesh: &Mesh, joints: &[Vec<usize>]) -> Vec<Body> {
    let mut groups = preflight::bodies(mesh);
    for joint in joints {
        let (touched, others): (Vec<Body>, Vec<Body>) =
            groups.into_iter().partition(|body| joint.iter().any(|node| body.nodes.binary_search(node).is_ok()));
        groups = others;
        let nodes: BTreeSet<usize> = touched.iter().flat_map(|body| body.nodes.iter().copied()).collect();
        let elements: BTreeSet<usize> = touched.iter().flat_map(|body| body.elements.iter().copied()).collect();
        if !elements.is_empty() {
            groups.push(Body { nodes: nodes.into_iter().collect(), elements: elements.into_iter().collect() });
        }
    }
    groups
}

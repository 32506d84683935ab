//! Depth of the overlap between deformed bodies at the greatest load and at the end of a run.

use super::{Findings, PulloutProgram};
use crate::number::significant;
use fe_core::mesh::{ElementEdge, Overlap};
use fe_core::model::Model;

/// Largest overlap without a warning, as a part of the length that overlaps are compared with.
const LARGE_OVERLAP: f64 = 0.01;

/// Measures the deepest overlap of a model whose nodes have these displacements, without what was released; `None` where
/// nothing overlaps.
fn deepest(model: &Model, (displacements, spalled): (&[f64], &[usize])) -> Option<Overlap<String>> {
    let mesh = &model.mesh;
    let behind = model.parts_behind();
    let is_left_out = |element: usize| behind.contains(&mesh.elements()[element].part()) || spalled.contains(&element);
    let Overlap { depth, position, part, inside } = mesh.overlap(displacements, is_left_out)?;
    let [part, inside] = [part, inside].map(|part| mesh.parts()[part].name.clone());
    Some(Overlap { depth, position, part, inside })
}

/// Measures overlaps at the peak, if there was one, and at the end, by displacements and the elements that had been released.
/// Returns a warning of a large one: what contact has crushed, up to this depth, is there in the mesh alone.
pub fn measure(
    program: &PulloutProgram,
    peak: Option<(&[f64], &[usize])>,
    end: (&[f64], &[usize]),
    crushed: f64,
    findings: &mut Findings,
) -> Option<String> {
    let states = [("peak", peak), ("end", Some(end))];
    for (when, state) in states {
        let overlap = state.and_then(|state| deepest(&program.model, state));
        findings.overlaps.extend(overlap.map(|overlap| (when.to_owned(), overlap)));
    }
    let depth = |(_, overlap): &(&String, &Overlap<String>)| overlap.depth;
    let (when, deepest) = findings.overlaps.iter().max_by(|a, b| depth(a).total_cmp(&depth(b)))?;
    let (length, whose) = reference(program)?;
    findings.overlap_max = deepest.depth;
    findings.overlap_relative = deepest.depth / length;
    if deepest.depth - crushed <= LARGE_OVERLAP * length {
        return None;
    }
    let Overlap { depth, position: [x, y], part, inside } = deepest;
    let what = if part == inside {
        format!("part '{part}' lies in itself")
    } else {
        format!("part '{part}' lies in part '{inside}'")
    };
    let when = if when == "peak" { "greatest load" } else { "end" };
    let why = match pair_between(&program.model, [part, inside]) {
        Some(pair) => format!(
            "contact pair '{pair}' keeps these parts apart, but not there: its surfaces end before, or an edge of one turned"
        ),
        None => "no contact pair keeps them apart".to_owned(),
    };
    Some(format!(
        "bodies overlap: at the {when} {what} by {} mm, {} % of {whose}, at ({}, {}): {why}",
        significant(*depth, 3),
        significant(100.0 * findings.overlap_relative, 3),
        significant(*x, 4),
        significant(*y, 4)
    ))
}

/// The name of a contact pair whose surfaces are on these parts.
fn pair_between<'m>(model: &'m Model, [one, other]: [&str; 2]) -> Option<&'m str> {
    let Model { mesh, contacts, .. } = model;
    let is_on = |edges: &[ElementEdge], part: &str| {
        edges.iter().any(|edge| mesh.parts()[mesh.elements()[edge.element].part()].name == part)
    };
    let mut pairs = contacts.iter();
    let joins = |slave: &[ElementEdge], master: &[ElementEdge]| {
        is_on(slave, one) && is_on(master, other) || is_on(slave, other) && is_on(master, one)
    };
    pairs.find(|pair| joins(&pair.slave, &pair.master)).map(|pair| pair.name.as_str())
}

/// The length that overlaps are compared with, mm, and its name.
fn reference(program: &PulloutProgram) -> Option<(f64, &'static str)> {
    if let Some(diameter) = program.fibre_diameter {
        return Some((diameter, "the fibre's diameter"));
    }
    let Model { mesh, contacts, .. } = &program.model;
    let length = |edge: ElementEdge| {
        let [start, end] = [0, 1].map(|k| mesh.nodes()[mesh.edge_nodes(edge).nodes()[k]]);
        (end[0] - start[0]).hypot(end[1] - start[1])
    };
    let surfaces = contacts.iter().flat_map(|pair| pair.slave.iter().chain(&pair.master)).copied();
    let of_contact = surfaces.map(length).reduce(f64::min).map(|least| (least, "the shortest edge in contact"));
    let of_boundary =
        || mesh.boundary_edges().map(length).reduce(f64::min).map(|least| (least, "the shortest outer edge"));
    of_contact.or_else(of_boundary)
}

mod arguments;
mod finite;
mod patch;
mod skipping;
mod stiffness;
mod summary;

use super::*;
use crate::element::{ElementKind, Integration};
use crate::kinematics::PlaneModel;
use crate::mesh::{ElementDefinition, Mesh, MeshDefinition, Part};
use crate::model::{Controls, Measured, PluginLaw, Skipping};
use std::collections::HashMap;

impl Solids {
    /// Returns how many threads evaluate blocks.
    pub(crate) fn thread_count(&self) -> usize {
        self.threads.count()
    }

    /// The [`Self::latest_version`] after the evaluation that built an element's stiffness; 0 before.
    pub(crate) fn stiffness_version(&self, element: usize) -> u64 {
        self.record(element).built.version
    }
}

/// The patch of MacNeal and Harder (1985): five quadrilaterals in a rectangle of 0.24 by 0.12.
const PATCH_NODES: [[f64; 2]; 8] =
    [[0.0, 0.0], [0.24, 0.0], [0.24, 0.12], [0.0, 0.12], [0.04, 0.02], [0.18, 0.03], [0.16, 0.08], [0.08, 0.08]];
const PATCH_QUADRILATERALS: [[usize; 4]; 5] = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]];

/// An element with its integration, with or without B-bar.
#[derive(Clone, Copy, Debug)]
struct Variant {
    kind: ElementKind,
    integration: Option<Integration>,
    average: bool,
}

impl Variant {
    const fn new(kind: ElementKind) -> Self {
        Self { kind, integration: None, average: false }
    }

    const ALL: [Self; 6] = [
        Self::new(ElementKind::T3),
        Self::new(ElementKind::T6),
        Self::new(ElementKind::Q4),
        Self { average: true, ..Self::new(ElementKind::Q4) },
        Self::new(ElementKind::Q8),
        Self { integration: Some(Integration::Full), ..Self::new(ElementKind::Q8) },
    ];
}

/// The patch at a distance from the axis; `curvature` moves middle nodes off their chords by this share.
fn patch(variant: Variant, model: PlaneModel, radius: f64, curvature: f64) -> Mesh {
    let mut nodes: Vec<[f64; 2]> = PATCH_NODES.iter().map(|[x, y]| [x + radius, *y]).collect();
    let corners = PATCH_QUADRILATERALS.iter().flat_map(|&[a, b, c, d]| match variant.kind.corner_count() {
        3 => vec![vec![a, b, c], vec![a, c, d]],
        _ => vec![vec![a, b, c, d]],
    });
    let mut middles = HashMap::new();
    let mut elements = Vec::new();
    for mut element in corners {
        let count = element.len();
        if variant.kind.node_count() > count {
            for start in 0..count {
                let ends = [element[start], element[(start + 1) % count]];
                let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                element.push(*middles.entry([low, high]).or_insert_with(|| {
                    let (a, b) = (nodes[low], nodes[high]);
                    nodes.push([
                        0.5 * (a[0] + b[0]) - curvature * (b[1] - a[1]),
                        0.5 * (a[1] + b[1]) + curvature * (b[0] - a[0]),
                    ]);
                    nodes.len() - 1
                }));
            }
        }
        if element.len() < variant.kind.node_count() {
            let corners = element[..count].iter().map(|&node| nodes[node]);
            let centre = corners.fold([0.0; 2], |sum, [x, y]| [sum[0] + x / count as f64, sum[1] + y / count as f64]);
            element.push(nodes.len());
            nodes.push(centre);
        }
        elements.push(ElementDefinition { kind: variant.kind, part: 0, nodes: element });
    }
    mesh(nodes, variant, model, elements)
}

/// The first element of the patch alone.
fn single(variant: Variant, model: PlaneModel, radius: f64) -> Mesh {
    let patch = patch(variant, model, radius, 0.03);
    let (positions, count) = patch.element_positions(0);
    let element = ElementDefinition { kind: variant.kind, part: 0, nodes: (0..count).collect() };
    mesh(positions[..count].to_vec(), variant, model, vec![element])
}

fn mesh(nodes: Vec<[f64; 2]>, variant: Variant, model: PlaneModel, elements: Vec<ElementDefinition>) -> Mesh {
    let part = Part { integration: variant.integration, ..Part::new("body", model, 0.7) };
    Mesh::new(MeshDefinition { nodes, parts: vec![part], elements, ..MeshDefinition::default() }).unwrap()
}

fn model(mesh: Mesh, law: &PluginLaw, average: bool, nlgeom: bool) -> Model {
    Model {
        fields: crate::model::Fields::default(),
        laws: vec![law.clone(); mesh.parts().len()],
        average_dilatation: vec![average; mesh.parts().len()],
        nlgeom: vec![nlgeom; mesh.parts().len()],
        mesh,
        contacts: Vec::new(),
        drives: Vec::new(),
        supports: Vec::new(),
        couplings: Vec::new(),
        loads: Vec::new(),
        measured: Measured::default(),
        steps: Vec::new(),
        controls: Controls::default(),
        initial_drives: Vec::new(),
        field: None,
        skipping: Skipping::ALL,
    }
}

const CONTEXT: IncrementContext =
    IncrementContext { step: 1, increment: 1, iteration: 1, step_time: 0.0, total_time: 0.0, time_increment: 1.0 };

/// Internal forces at these displacements.
fn forces(solids: &mut Solids, displacements: &[f64], request: Request) -> Vec<f64> {
    let mut forces = vec![0.0; displacements.len()];
    solids.evaluate(displacements, &CONTEXT, request, &mut forces).unwrap();
    forces
}

fn advance(solids: &mut Solids, displacements: &[f64]) {
    forces(solids, displacements, Request::Stress);
    solids.commit(displacements);
}

/// Displacements of all nodes to where `motion` takes them.
fn moved(mesh: &Mesh, motion: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
    let to = |&x: &[f64; 2]| {
        let end = motion(x);
        [end[0] - x[0], end[1] - x[1]]
    };
    mesh.nodes().iter().flat_map(to).collect()
}

fn linear_elastic() -> PluginLaw {
    PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)])
}

/// Yields at a strain of 1e-2, hardens.
fn j2_plasticity() -> PluginLaw {
    let mut law = PluginLaw::shipped("j2_plasticity", &[]);
    law.plugin.props = vec![1000.0, 0.3, 10.0, 0.0, 30.0, 1.0];
    law
}

fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [cosine * x - sine * y, sine * x + cosine * y]
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

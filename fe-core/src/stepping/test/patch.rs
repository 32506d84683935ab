//! Patch tests through whole runs: a patch of distorted elements whose boundary moves linearly in the coordinates has one
//! strain and one stress, and its inside moves linearly too.

use super::*;
use crate::element::EdgeKind;
use crate::mesh::structured::{Grading, MeshBlock};
use end_to_end_tests::rotated_in_plane;

/// Relative to the largest displacement or stress.
const EXACT: f64 = 1e-10;
/// E, MPa.
const MODULUS: f64 = 1000.0;
/// ν.
const POISSON: f64 = 0.3;
/// The patch is a square of this side with so many cells along it.
const SIDE: f64 = 3.0;
const CELLS: usize = 3;
/// Increments of the runs.
const INCREMENTS: usize = 4;

pub(super) type Matrix = [[f64; 2]; 2];

/// A patch whose boundary nodes follow two drives each, `x` first. It starts at radius 1.
pub(super) fn patch(kind: ElementKind, plane: PlaneModel, law: PluginLaw) -> Model {
    let mut mesh = MeshDefinition::default();
    let part = mesh.add_part(Part::new("patch", plane, 0.5));
    let line = Grading::Uniform { count: CELLS }.positions(SIDE).unwrap();
    let distorted = |[x, y]: [f64; 2]| {
        let bubble = 0.2 * x * (SIDE - x) * y * (SIDE - y) / (SIDE * SIDE);
        [1.0 + x + bubble * (3.0 * x + y).sin(), y + bubble * (x + 2.0 * y).cos()]
    };
    mesh.block(&MeshBlock::new(part, kind, &line, &line).mapped(&distorted)).unwrap();
    let mut definition = mesh;
    if plane == PlaneModel::Axisymmetric {
        // the rules integrate the radius of straight edges only
        straighten(&mut definition);
    }
    let on_boundary = |[x, y]: [f64; 2]| x == 1.0 || x == 1.0 + SIDE || y == 0.0 || y == SIDE;
    let boundary: Vec<usize> = (0..definition.nodes.len()).filter(|&n| on_boundary(definition.nodes[n])).collect();
    let mut supports = Vec::new();
    for (k, &node) in boundary.iter().enumerate() {
        for (component, direction) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
            let name = format!("node {node}");
            supports.push(Support { name, nodes: vec![node], direction, drive: Some(2 * k + component) });
        }
    }
    Model {
        fields: crate::model::Fields::default(),
        mesh: Mesh::new(definition).unwrap(),
        laws: vec![law],
        average_dilatation: vec![true],
        contacts: Vec::new(),
        drives: (0..supports.len()).map(|k| format!("drive {k}")).collect(),
        supports,
        couplings: Vec::new(),
        loads: Vec::new(),
        nlgeom: vec![false],
        measured: Measured::default(),
        steps: Vec::new(),
        controls: Controls { force_tolerance: 1e-12, displacement_tolerance: 1e-11, ..Controls::default() },
        initial_drives: Vec::new(),
        field: None,
        skipping: Skipping::ALL,
    }
}

/// Puts middle nodes into the middle of their edges.
fn straighten(definition: &mut MeshDefinition) {
    for element in &definition.elements {
        if element.kind.edge_kind() == EdgeKind::Linear {
            continue;
        }
        let corners = element.kind.corner_count();
        for corner in 0..corners {
            let [a, b] = [corner, (corner + 1) % corners].map(|n| definition.nodes[element.nodes[n]]);
            definition.nodes[element.nodes[corners + corner]] = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        }
    }
}

/// Moves the boundary to F X in one step.
pub(super) fn step_to(model: &Model, gradient: Matrix, increments: usize) -> Step {
    let target = |support: &Support| {
        let [x, y] = displacement(gradient, model.mesh.nodes()[support.nodes[0]]);
        Some(x * support.direction[0] + y * support.direction[1])
    };
    let targets = model.supports.iter().map(target).collect();
    Step { time: 1.0, targets, control: StepControl::Fixed { increments } }
}

fn displacement([[a, b], [c, d]]: Matrix, [x, y]: [f64; 2]) -> [f64; 2] {
    [(a - 1.0) * x + b * y, c * x + (d - 1.0) * y]
}

/// The greatest differences of displacements and stresses from what they should be, relative.
pub(super) fn errors(snapshot: &Snapshot<'_>, gradient: Matrix, stress: [f64; 4]) -> [f64; 2] {
    let mesh = &snapshot.model().mesh;
    let (mut largest, mut off) = (0.0_f64, 0.0_f64);
    for (node, position) in mesh.nodes().iter().enumerate() {
        for (component, expected) in displacement(gradient, *position).into_iter().enumerate() {
            largest = largest.max(expected.abs());
            off = off.max((snapshot.displacements()[2 * node + component] - expected).abs());
        }
    }
    let scale = stress.iter().fold(0.0_f64, |scale, s| scale.max(s.abs()));
    let mut stress_off = 0.0_f64;
    for element in 0..mesh.elements().len() {
        for point in 0..snapshot.solids().point_count(element) {
            let there = snapshot.solids().point(element, point).stress;
            stress_off = stress.iter().zip(there).fold(stress_off, |off, (s, t)| off.max((s - t).abs()));
        }
    }
    [off / largest, stress_off / scale]
}

/// σ of isotropic elasticity from ε 11, 22, 33, γ12; 33 is not used in plane stress.
fn elastic(plane: PlaneModel, [e11, e22, e33, g12]: [f64; 4]) -> [f64; 4] {
    let shear = MODULUS / (2.0 * (1.0 + POISSON));
    let lame = match plane {
        PlaneModel::PlaneStress => 2.0 * shear * POISSON / (1.0 - POISSON),
        _ => 2.0 * shear * POISSON / (1.0 - 2.0 * POISSON),
    };
    let trace = lame * (e11 + e22 + if plane == PlaneModel::PlaneStress { 0.0 } else { e33 });
    let s33 = if plane == PlaneModel::PlaneStress { 0.0 } else { trace + 2.0 * shear * e33 };
    [trace + 2.0 * shear * e11, trace + 2.0 * shear * e22, s33, shear * g12]
}

/// The hoop strain of a displacement that is linear in the radius is the radial one.
fn hoop(plane: PlaneModel, radial: f64) -> f64 {
    if plane == PlaneModel::Axisymmetric { radial } else { 0.0 }
}

/// σ at F = I + H in equal increments of H: midpoint strains, stress rotated by Hughes & Winget.
fn hypoelastic(plane: PlaneModel, [[a, b], [c, d]]: Matrix) -> [f64; 4] {
    let h = [[a - 1.0, b], [c, d - 1.0]];
    let mut stress = [0.0; 4];
    for n in 0..INCREMENTS {
        let part = 1.0 / INCREMENTS as f64;
        let middle = (n as f64 + 0.5) * part;
        let f = [[1.0 + middle * h[0][0], middle * h[0][1]], [middle * h[1][0], 1.0 + middle * h[1][1]]];
        let det = f[0][0] * f[1][1] - f[0][1] * f[1][0];
        let inverse = [[f[1][1] / det, -f[0][1] / det], [-f[1][0] / det, f[0][0] / det]];
        let l = |i: usize, j: usize| part * (h[i][0] * inverse[0][j] + h[i][1] * inverse[1][j]);
        // (I − W/2)⁻¹ (I + W/2) is a rotation by 2 atan(w/2)
        let spin = 0.5 * (l(1, 0) - l(0, 1));
        let increment = elastic(plane, [l(0, 0), l(1, 1), hoop(plane, l(0, 0)), l(0, 1) + l(1, 0)]);
        let rotated = rotated_in_plane(stress, 2.0 * (0.5 * spin).atan(), 1.0);
        stress = std::array::from_fn(|k| rotated[k] + increment[k]);
    }
    stress
}

const KINDS: [ElementKind; 4] = [ElementKind::T3, ElementKind::T6, ElementKind::Q4, ElementKind::Q8];

fn law() -> PluginLaw {
    PluginLaw::shipped("linear_elastic", &[("E", MODULUS), ("nu", POISSON)])
}

/// A linear displacement field: all strains, and rotation but in axial symmetry, where shear needs body forces.
fn gradient_of(plane: PlaneModel, scale: f64) -> Matrix {
    match plane {
        PlaneModel::Axisymmetric => [[1.0 + scale, 0.0], [0.0, 1.0 - 0.7 * scale]],
        _ => [[1.0 + scale, 0.8 * scale], [-0.3 * scale, 1.0 - 0.6 * scale]],
    }
}

#[test]
fn every_element_passes_the_patch_test_under_small_strains() {
    for (kind, plane) in KINDS.into_iter().flat_map(|kind| PlaneModel::ALL.map(|plane| (kind, plane))) {
        let gradient = gradient_of(plane, 1e-3);
        let mut model = patch(kind, plane, law());
        model.steps = vec![step_to(&model, gradient, 1)];
        let [[a, b], [c, d]] = gradient;
        let stress = elastic(plane, [a - 1.0, d - 1.0, hoop(plane, a - 1.0), b + c]);
        let [displacement, stress] = errors_at_end(&model, gradient, stress);
        assert!(displacement < EXACT && stress < EXACT, "{kind:?} {plane:?}: {displacement:.1e} {stress:.1e}");
    }
}

#[test]
fn every_element_passes_the_patch_test_under_large_displacements() {
    for (kind, plane) in KINDS.into_iter().flat_map(|kind| PlaneModel::ALL.map(|plane| (kind, plane))) {
        let gradient = gradient_of(plane, 0.3);
        let mut model = patch(kind, plane, law());
        model.nlgeom.fill(true);
        model.steps = vec![step_to(&model, gradient, INCREMENTS)];
        let [displacement, stress] = errors_at_end(&model, gradient, hypoelastic(plane, gradient));
        assert!(displacement < EXACT && stress < EXACT, "{kind:?} {plane:?}: {displacement:.1e} {stress:.1e}");
    }
}

fn errors_at_end(model: &Model, gradient: Matrix, stress: [f64; 4]) -> [f64; 2] {
    let mut last = [f64::NAN; 2];
    let look = |_: &Record, snapshot: &Snapshot<'_>| last = errors(snapshot, gradient, stress);
    Analysis::new(model).unwrap().run(&mut Looking(look)).unwrap();
    last
}

/// Calls a closure.
pub(super) struct Looking<F>(pub(super) F);

impl<F: FnMut(&Record, &Snapshot<'_>)> IncrementObserver for Looking<F> {
    fn increment(&mut self, record: &Record, snapshot: &Snapshot<'_>) -> io::Result<Directive> {
        (self.0)(record, snapshot);
        Ok(Directive::GoOn)
    }
}

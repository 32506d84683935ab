//! Time of an element besides its UMAT: internal forces, and forces with stiffness, for small strains and large
//! displacements.
//!
//! `cargo bench -p fe-core --bench element`. The law is linear elasticity, nothing is skipped, and the time of as many
//! calls of the plugin alone is taken off. Ways alternate in short repeats, and medians are compared.

use fe_core::assembly::Solids;
use fe_core::element::{ElementKind, Integration};
use fe_core::kinematics::PlaneModel;
use fe_core::mesh::structured::{Grading, MeshBlock};
use fe_core::mesh::{Mesh, MeshDefinition, Part};
use fe_core::model::{Controls, IncrementContext, Measured, Model, PluginLaw, Skipping};
use std::hint::black_box;
use std::time::Instant;
use umat_abi::host::Plugin;
use umat_abi::law::Request;

/// Elements along each side of a square.
const SIDE: usize = 20;
const REPEATS: usize = 101;
/// The aim for a Q8R, small strains, forces and stiffness: µs.
const AIM_MICROSECONDS: f64 = 2.0;

struct Case {
    name: &'static str,
    kind: ElementKind,
    integration: Option<Integration>,
    average: bool,
    model: PlaneModel,
}

const CASES: [Case; 7] = [
    case("T3", ElementKind::T3, None, false, PlaneModel::PlaneStrain),
    case("T6", ElementKind::T6, None, false, PlaneModel::PlaneStrain),
    case("Q4", ElementKind::Q4, None, false, PlaneModel::PlaneStrain),
    case("Q4 B-bar", ElementKind::Q4, None, true, PlaneModel::PlaneStrain),
    case("Q8R", ElementKind::Q8, None, false, PlaneModel::PlaneStrain),
    case("Q8R axisymmetric", ElementKind::Q8, None, false, PlaneModel::Axisymmetric),
    case("Q8", ElementKind::Q8, Some(Integration::Full), false, PlaneModel::PlaneStrain),
];

const fn case(
    name: &'static str,
    kind: ElementKind,
    integration: Option<Integration>,
    average: bool,
    model: PlaneModel,
) -> Case {
    Case { name, kind, integration, average, model }
}

/// A square of SIDE × SIDE cells, one element or two triangles each; x from 1.
fn square(case: &Case) -> Mesh {
    let line = Grading::Uniform { count: SIDE }.positions(1.0).expect("a line");
    let shift = |[x, y]: [f64; 2]| [1.0 + x, y];
    let mut mesh = MeshDefinition::default();
    let part = mesh.add_part(Part { integration: case.integration, ..Part::new("square", case.model, 1.0) });
    mesh.block(&MeshBlock::new(part, case.kind, &line, &line).mapped(&shift)).expect("a square");
    Mesh::new(mesh).expect("a square")
}

fn linear_elastic() -> PluginLaw {
    let library = end_to_end_tests::open(&end_to_end_tests::plugin("linear_elastic"));
    Plugin { props: vec![210e3, 0.3], ..Plugin::with_defaults(&library, &library.laws()[0]) }.into()
}

fn model(case: &Case, nlgeom: bool) -> Model {
    Model {
        fields: fe_core::model::Fields::default(),
        mesh: square(case),
        laws: vec![linear_elastic()],
        average_dilatation: vec![case.average],
        contacts: Vec::new(),
        drives: Vec::new(),
        supports: Vec::new(),
        couplings: Vec::new(),
        loads: Vec::new(),
        nlgeom: vec![nlgeom],
        measured: Measured::default(),
        steps: Vec::new(),
        controls: Controls::default(),
        initial_drives: Vec::new(),
        field: None,
        skipping: Skipping::NONE,
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Microseconds that `body` takes.
fn time(body: impl FnOnce()) -> f64 {
    let start = Instant::now();
    body();
    start.elapsed().as_secs_f64() * 1e6
}

/// Microseconds per element without UMAT: forces, and forces with stiffness.
fn measure(case: &Case, nlgeom: bool, repeats: usize) -> [f64; 2] {
    let model = model(case, nlgeom);
    let mut solids = Solids::new(&model).expect("a sound model");
    let mut call = model.laws[0].umat(case.model.stress_state()).expect("the law's UMAT");
    let displacements: Vec<f64> = model.mesh.nodes().iter().flat_map(|[x, y]| [1e-4 * x * y, 1e-4 * x]).collect();
    let mut forces = vec![0.0; displacements.len()];
    let elements = model.mesh.elements().len();
    let points = elements * solids.point_count(0);
    let context = IncrementContext::default();
    let requests = [Request::Stress, Request::StressAndTangent];
    let mut samples = [const { [const { Vec::new() }; 2] }; 2];
    for _ in 0..repeats {
        for (request, [with, without]) in requests.into_iter().zip(&mut samples) {
            with.push(time(|| {
                forces.fill(0.0);
                solids.evaluate(black_box(&displacements), &context, request, &mut forces).expect("an elastic body");
            }));
            without.push(time(|| {
                for _ in 0..points {
                    black_box(call.call(request)).expect("an elastic point");
                }
            }));
        }
    }
    samples.map(|[with, without]| (median(with) - median(without)) / elements as f64)
}

fn main() {
    // `cargo test --benches` runs this too, without `--bench`: then it only shows that it works.
    let measuring = std::env::args().any(|argument| argument == "--bench");
    let repeats = if measuring { REPEATS } else { 1 };
    println!("µs an element without its UMAT, medians of {repeats} repeats of a square of {SIDE} × {SIDE}");
    println!("{:<18} {:>10} {:>12} {:>14} {:>16}", "", "forces", "+ stiffness", "nlgeom forces", "+ stiffness");
    let mut slow = false;
    for case in &CASES {
        let [forces, both] = measure(case, false, repeats);
        let [finite_forces, finite_both] = measure(case, true, repeats);
        println!("{:<18} {forces:>10.3} {both:>12.3} {finite_forces:>14.3} {finite_both:>16.3}", case.name);
        slow |= case.name == "Q8R" && both > AIM_MICROSECONDS;
    }
    if measuring && slow {
        println!("Q8R takes more than {AIM_MICROSECONDS} µs");
        std::process::exit(1);
    }
}

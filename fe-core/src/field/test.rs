//! Heat in bars, plates and rings against closed forms.

use crate::element::ElementKind;
use crate::kinematics::PlaneModel;
use crate::mesh::structured::{Grading, MeshBlock};
use crate::mesh::{ElementEdge, Mesh, MeshDefinition, Part};
use crate::model::{
    Controls, FieldCoupling, FieldKind, FixedValue, Flux, Measured, Model, PluginLaw, ScalarField, Skipping, Step,
    StepControl, Support,
};
use crate::stepping::{Analysis, Directive, IncrementObserver, Record, Snapshot};
use std::f64::consts::PI;
use std::io;

struct Silent;

impl IncrementObserver for Silent {
    fn increment(&mut self, _: &Record, _: &Snapshot<'_>) -> io::Result<Directive> {
        Ok(Directive::GoOn)
    }
}

/// A rectangle that begins at x = `start`, its inside distorted by a part of its size; the material is elastic and at rest.
struct Plate {
    kind: ElementKind,
    plane: PlaneModel,
    start: f64,
    size: [f64; 2],
    cells: [usize; 2],
    distortion: f64,
}

impl Plate {
    fn bar(kind: ElementKind, columns: usize) -> Self {
        let (plane, size, cells) = (PlaneModel::PlaneStrain, [4.0, 1.0], [columns, 2]);
        Self { kind, plane, start: 0.0, size, cells, distortion: 0.0 }
    }

    fn mesh(&self) -> Mesh {
        let Self { kind, plane, start, size, cells, distortion } = *self;
        let mut mesh = MeshDefinition::default();
        let part = mesh.add_part(Part::new("plate", plane, 0.5));
        let [xi, eta] = [0, 1].map(|k| Grading::Uniform { count: cells[k] }.positions(size[k]).unwrap());
        let map = |[x, y]: [f64; 2]| {
            let bubble = distortion * x * (size[0] - x) * y * (size[1] - y) / (size[0] * size[1]);
            [start + x + bubble * (3.0 * x + y).sin(), y + bubble * (x + 2.0 * y).cos()]
        };
        mesh.block(&MeshBlock::new(part, kind, &xi, &eta).mapped(&map)).unwrap();
        Mesh::new(mesh).unwrap()
    }

    /// Nodes whose x is that of one end.
    fn end(&self, mesh: &Mesh, is_right: bool) -> Vec<usize> {
        let x = self.start + if is_right { self.size[0] } else { 0.0 };
        (0..mesh.nodes().len()).filter(|&node| (mesh.nodes()[node][0] - x).abs() < 1e-12).collect()
    }

    /// Edges of the right end.
    fn right_edges(&self, mesh: &Mesh) -> Vec<ElementEdge> {
        let right = self.end(mesh, true);
        mesh.boundary_edges()
            .filter(|&edge| mesh.edge_nodes(edge).nodes().iter().all(|node| right.contains(node)))
            .collect()
    }

    /// θ at the nodes after a time.
    fn solve(&self, field: impl FnOnce(&Mesh) -> ScalarField, time: f64, increments: usize) -> (Mesh, Vec<f64>) {
        let (model, values) = self.run(field, time, increments, 0, &mut Silent);
        (model.mesh, values)
    }

    /// The same with so many drives that go to 1, and an observer of the increments.
    fn run(
        &self,
        field: impl FnOnce(&Mesh) -> ScalarField,
        time: f64,
        increments: usize,
        drives: usize,
        observer: &mut impl IncrementObserver,
    ) -> (Model, Vec<f64>) {
        let mesh = self.mesh();
        let support = |direction| Support {
            name: "all".into(),
            nodes: (0..mesh.nodes().len()).collect(),
            direction,
            drive: None,
        };
        let model = Model {
            fields: crate::model::Fields::default(),
            field: Some(field(&mesh)),
            laws: vec![PluginLaw::shipped("linear_elastic", &[])],
            average_dilatation: vec![false],
            nlgeom: vec![false],
            contacts: Vec::new(),
            drives: vec!["drive".into(); drives],
            initial_drives: Vec::new(),
            supports: vec![support([1.0, 0.0]), support([0.0, 1.0])],
            couplings: Vec::new(),
            loads: Vec::new(),
            measured: Measured::default(),
            steps: vec![Step { time, targets: vec![Some(1.0); drives], control: StepControl::Fixed { increments } }],
            controls: Controls::default(),
            skipping: Skipping::ALL,
            mesh,
        };
        let mut analysis = Analysis::new(&model).unwrap();
        analysis.run(observer).unwrap();
        let values = analysis.snapshot().field().unwrap();
        drop(analysis);
        (model, values)
    }
}

fn heat() -> ScalarField {
    ScalarField::new(FieldKind::Temperature, 1)
}

fn fixed(nodes: Vec<usize>, value: f64) -> FixedValue {
    FixedValue { nodes, value, drive: None }
}

/// The largest error against a closed form.
fn error((mesh, values): &(Mesh, Vec<f64>), exact: impl Fn([f64; 2]) -> f64) -> f64 {
    mesh.nodes().iter().zip(values).map(|(&at, value)| (value - exact(at)).abs()).fold(0.0, f64::max)
}

#[test]
fn steady_heat_between_two_ends_is_linear_on_any_mesh() {
    for kind in ElementKind::ALL {
        let plate = Plate { distortion: 0.2, ..Plate::bar(kind, 4) };
        let field = |mesh: &Mesh| ScalarField {
            initial: 20.0,
            fixed: vec![fixed(plate.end(mesh, false), 20.0), fixed(plate.end(mesh, true), 100.0)],
            ..heat()
        };
        let error = error(&plate.solve(field, 1.0, 1), |[x, _]| 20.0 + 80.0 * x / 4.0);
        assert!(error < 1e-10, "{kind}: {error:e}");
    }
}

#[test]
fn a_flux_makes_a_gradient_of_flux_over_conductivity() {
    for kind in ElementKind::ALL {
        let plate = Plate { distortion: 0.2, ..Plate::bar(kind, 4) };
        let field = |mesh: &Mesh| ScalarField {
            conductivity: 2.5,
            fixed: vec![fixed(plate.end(mesh, false), 1.0)],
            fluxes: vec![Flux { edges: plate.right_edges(mesh), flux: 7.0, drive: None }],
            ..heat()
        };
        let error = error(&plate.solve(field, 1.0, 1), |[x, _]| 1.0 + 7.0 / 2.5 * x);
        assert!(error < 1e-9, "{kind}: {error:e}");
    }
}

/// A value that follows a drive is that of the end of each increment, not of its start; so in any way to solve it.
#[test]
fn fixed_values_follow_their_drive_in_the_same_increment() {
    struct Largest(Vec<f64>);
    impl IncrementObserver for Largest {
        fn increment(&mut self, record: &Record, _: &Snapshot<'_>) -> io::Result<Directive> {
            self.0.push(record.largest_field);
            Ok(Directive::GoOn)
        }
    }
    for coupling in [FieldCoupling::Staggered, FieldCoupling::OnePass, FieldCoupling::Full] {
        let plate = Plate::bar(ElementKind::Q8, 4);
        let field = |mesh: &Mesh| ScalarField {
            fixed: vec![
                fixed(plate.end(mesh, false), 0.0),
                FixedValue { drive: Some(0), ..fixed(plate.end(mesh, true), 100.0) },
            ],
            coupling,
            ..heat()
        };
        let mut seen = Largest(Vec::new());
        let (model, values) = plate.run(field, 1.0, 4, 1, &mut seen);
        let error = error(&(model.mesh, values), |[x, _]| 100.0 * x / 4.0);
        let expected: Vec<f64> = (0..=4).map(|k| 25.0 * f64::from(k)).collect();
        let largest =
            seen.0.iter().zip(&expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
        assert!(seen.0.len() == 5 && error < 1e-8 && largest < 1e-8, "{coupling:?}: {error:e}, {:?}", seen.0);
    }
}

/// A ring between two temperatures: θ = ln(r/a)/ln(b/a).
#[test]
fn steady_heat_in_a_ring_converges_to_the_logarithm() {
    for (kind, order) in
        [(ElementKind::T3, 1.7), (ElementKind::Q4, 1.7), (ElementKind::T6, 2.8), (ElementKind::Q8, 2.8)]
    {
        let at = |columns: usize| {
            let bar = Plate::bar(kind, columns);
            let cells = [columns, columns / 4];
            let plate = Plate { plane: PlaneModel::Axisymmetric, start: 1.0, cells, ..bar };
            let field = |mesh: &Mesh| ScalarField {
                fixed: vec![fixed(plate.end(mesh, false), 0.0), fixed(plate.end(mesh, true), 1.0)],
                ..heat()
            };
            error(&plate.solve(field, 1.0, 1), |[r, _]| r.ln() / 5.0_f64.ln())
        };
        let [coarse, fine] = [16, 32].map(at);
        let found = (coarse / fine).log2();
        assert!(found > order && fine < 1e-3, "{kind}: order {found}, {fine:e}");
    }
}

/// A bar at 1 whose ends are cooled to 0: Fourier's series, of first order in time.
#[test]
fn a_bar_that_cools_follows_the_series_to_first_order_in_time() {
    let (length, conductivity, capacity, time) = (4.0, 2.0, 0.5, 1.0);
    let exact = |[x, _]: [f64; 2]| -> f64 {
        let diffusivity = conductivity / capacity;
        (0..200)
            .map(|k| {
                let wave = f64::from(2 * k + 1) * PI / length;
                4.0 / (length * wave) * (wave * x).sin() * (-diffusivity * wave * wave * time).exp()
            })
            .sum()
    };
    let plate = Plate::bar(ElementKind::Q8, 8);
    let at = |increments: usize| {
        let field = |mesh: &Mesh| ScalarField {
            conductivity,
            capacity,
            initial: 1.0,
            fixed: vec![fixed(plate.end(mesh, false), 0.0), fixed(plate.end(mesh, true), 0.0)],
            ..heat()
        };
        error(&plate.solve(field, time, increments), exact)
    };
    let [coarse, middle, fine] = [50, 100, 200].map(at);
    let orders = [(coarse / middle).log2(), (middle / fine).log2()];
    assert!(orders.iter().all(|order| (0.9..1.1).contains(order)) && fine < 2e-3, "{orders:?}, {fine:e}");
}

//! Timoshenko's cantilever with the exact tractions at its end and the exact displacements at its root.

use super::{model, orders, run_to_end, scientific};
use end_to_end_tests::analytical::beam::Cantilever;
use fe_core::model::{Load, LoadKind, Model, Step, StepControl, Support};
use fe_core::stepping::Snapshot;

const BEAM: Cantilever =
    Cantilever { length: 10.0, height: 2.0, thickness: 1.0, modulus: 1000.0, poisson: 0.3, load: 10.0 };
/// Abscissae and weights of three Gauss points on −1 … 1.
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// The case's mesh and material; root and end as the solution has them.
fn cantilever(element: &str, refinement: usize) -> Model {
    let cells = format!("mesh.specimen.cells=[{},{}]", 5 * refinement, refinement);
    let mut model = model("cantilever", &[&format!("mesh.specimen.element={element}"), &cells]);
    model.drives = vec!["load".into()];
    model.supports.clear();
    let mut targets = vec![Some(1.0)];
    for &node in model.mesh.node_set("left").unwrap() {
        let moved = BEAM.displacement(model.mesh.nodes()[node]);
        for (direction, value) in [[1.0, 0.0], [0.0, 1.0]].into_iter().zip(moved) {
            let drive = Some(targets.len());
            model.supports.push(Support { name: format!("root node {node}"), nodes: vec![node], direction, drive });
            model.drives.push(format!("root {}", targets.len()));
            targets.push(Some(value));
        }
    }
    model.loads = end_shear(&model);
    model.steps = vec![Step { time: 1.0, targets, control: StepControl::Fixed { increments: 1 } }];
    model
}

/// Nodal forces of the parabolic shear, integrated exactly.
fn end_shear(model: &Model) -> Vec<Load> {
    let mut loads = Vec::new();
    for &edge in model.mesh.edge_set("right").unwrap() {
        let edge = model.mesh.edge_nodes(edge);
        let mut positions = [[0.0; 2]; 3];
        for (position, &node) in positions.iter_mut().zip(edge.nodes()) {
            *position = model.mesh.nodes()[node];
        }
        for (k, &node) in edge.nodes().iter().enumerate() {
            let part = |&(at, weight): &(f64, f64)| {
                let point = edge.kind().point(&positions, at);
                let length = point.tangent[0].hypot(point.tangent[1]);
                let [_, _, shear] = BEAM.stress(point.position);
                weight * length * BEAM.thickness * edge.kind().shape_functions(at)[k] * shear
            };
            let force = [0.0, GAUSS.iter().map(part).sum()];
            let kind = LoadKind::Force { nodes: vec![node], force };
            loads.push(Load { name: format!("end, node {node}"), drive: 0, kind });
        }
    }
    loads
}

/// √(energy of the stresses' error / energy).
fn energy_error(snapshot: &Snapshot<'_>) -> f64 {
    let mut energy = 0.0;
    for element in 0..snapshot.model().mesh.elements().len() {
        for point in 0..snapshot.solids().point_count(element) {
            let point = snapshot.solids().point(element, point);
            let exact = BEAM.stress(point.position);
            let [x, y, xy] = [0, 1, 3].map(|k| point.stress[k]);
            let [x, y, xy] = [x - exact[0], y - exact[1], xy - exact[2]];
            let twice = x * x + y * y - 2.0 * BEAM.poisson * x * y + 2.0 * (1.0 + BEAM.poisson) * xy * xy;
            energy += 0.5 * twice / BEAM.modulus * point.volume;
        }
    }
    (energy / BEAM.strain_energy()).sqrt()
}

#[test]
fn energy_errors_fall_with_the_order_of_the_elements() {
    for (element, expected) in [("T3", 1.0), ("Q4", 1.0), ("T6", 2.0), ("Q8", 2.0)] {
        let mut errors = Vec::new();
        for refinement in [4, 8, 16] {
            let model = cantilever(element, refinement);
            run_to_end(&model, |_, snapshot| errors.push(energy_error(snapshot)));
            // the initial state has no stress
            errors.remove(errors.len() - 2);
        }
        let orders = orders(&errors);
        println!("{element}: {}, orders {orders:.2?}", scientific(&errors));
        // meshes of 8 cells across are not quite where orders are those of the limit
        assert!(orders[1] > expected - 0.1, "{element}: {errors:?}, orders {orders:?}");
    }
}

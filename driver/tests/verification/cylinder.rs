//! A thick cylinder under internal pressure: Lamé and Hill.

use super::{model, orders, run, run_to_end, scientific};
use end_to_end_tests::analytical::cylinder::Cylinder;
use fe_core::stepping::Snapshot;

/// MPa.
const PRESSURE: f64 = 100.0;
/// Tolerance for nothing but rounding.
const EXACT: f64 = 1e-11;
const YIELD_STRESS: f64 = 240.0;

fn cylinder(poisson: f64) -> Cylinder {
    Cylinder { inner: 1.0, outer: 2.0, modulus: 210e3, poisson }
}

/// Errors of radial displacements and of in-plane stresses, roots of mean squares relative to the largest.
fn errors(element: &str, axisymmetric: bool, cells: usize) -> [f64; 2] {
    let given = [
        format!("mesh.specimen.element={element}"),
        format!("mesh.specimen.axisymmetric={axisymmetric}"),
        format!("mesh.specimen.radial_cells={cells}"),
        format!("mesh.specimen.other_cells={cells}"),
    ];
    let model = model("thick-cylinder-elastic", &given.each_ref().map(String::as_str));
    let exact = cylinder(0.3);
    let mut errors = [f64::NAN; 2];
    run_to_end(&model, |_, snapshot| errors = errors_of(snapshot, &exact, axisymmetric));
    errors
}

fn errors_of(snapshot: &Snapshot<'_>, exact: &Cylinder, axisymmetric: bool) -> [f64; 2] {
    let mesh = &snapshot.model().mesh;
    let mut displacement = 0.0;
    for (node, &[x, y]) in mesh.nodes().iter().enumerate() {
        let radius = if axisymmetric { x } else { x.hypot(y) };
        let along = if axisymmetric { [1.0, 0.0] } else { [x / radius, y / radius] };
        let off = snapshot.displacement_of(node, along) - exact.elastic_displacement(PRESSURE, radius);
        displacement += off * off / mesh.nodes().len() as f64;
    }
    let (mut sum, mut volume) = (0.0, 0.0);
    for element in 0..mesh.elements().len() {
        for point in 0..snapshot.solids().point_count(element) {
            let point = snapshot.solids().point(element, point);
            let [s11, s22, s33, s12] = point.stress;
            let [x, y] = point.position;
            let ([radial, hoop], radius) = if axisymmetric {
                ([s11, s33], x)
            } else {
                let radius = x.hypot(y);
                let (c, s) = (x / radius, y / radius);
                let radial = c * c * s11 + s * s * s22 + 2.0 * c * s * s12;
                ([radial, s11 + s22 - radial], radius)
            };
            let (exact_radial, exact_hoop) = exact.elastic_stress(PRESSURE, radius);
            sum += ((radial - exact_radial).powi(2) + (hoop - exact_hoop).powi(2)) * point.volume;
            volume += point.volume;
        }
    }
    let (_, greatest) = exact.elastic_stress(PRESSURE, exact.inner);
    [displacement.sqrt() / exact.elastic_displacement(PRESSURE, exact.inner), (sum / volume).sqrt() / greatest]
}

#[test]
fn elastic_errors_fall_with_the_order_of_the_elements() {
    // of displacements and stresses
    for (element, expected) in [("T3", [2.0, 1.0]), ("Q4", [2.0, 1.0]), ("T6", [3.0, 2.0]), ("Q8", [3.0, 2.0])] {
        for axisymmetric in [true, false] {
            let found = [4, 8, 16, 32].map(|cells| errors(element, axisymmetric, cells));
            for (k, what) in ["displacement", "stress"].into_iter().enumerate() {
                let orders = orders(&found.map(|errors| errors[k]));
                println!("{element} axisymmetric {axisymmetric} {what}: {:.2e}, orders {orders:.2?}", found[3][k]);
                // a mesh of 8 cells is not yet where orders are those of the limit
                // reduced Q8 are exact at the nodes of this problem in axial symmetry
                assert!(
                    orders[2] > expected[k] - 0.1 || found[0][k] < EXACT,
                    "{element}, {axisymmetric}, {what}: orders {orders:?}"
                );
            }
        }
    }
}

/// The greatest radius that has yielded, and the displacement of the outer surface.
fn plastic_state(snapshot: &Snapshot<'_>) -> [f64; 2] {
    let mesh = &snapshot.model().mesh;
    let mut front = 0.0_f64;
    for element in 0..mesh.elements().len() {
        for point in 0..snapshot.solids().point_count(element) {
            let point = snapshot.solids().point(element, point);
            if point.statev[0] > 0.0 {
                front = front.max(point.position[0]);
            }
        }
    }
    let outer = mesh.node_set("outer").unwrap()[0];
    [front, snapshot.displacement_of(outer, [1.0, 0.0])]
}

#[test]
fn the_plastic_front_is_hills() {
    let exact = cylinder(0.4999);
    let mut errors = Vec::new();
    for cells in [8, 16, 32] {
        let size = 1.0 / f64::from(cells);
        let model = model("thick-cylinder-plastic", &[&format!("mesh.specimen.radial_cells={cells}")]);
        let mut worst = 0.0_f64;
        let mut seen = 0;
        run_to_end(&model, |_, snapshot| {
            let pressure = snapshot.drives()[0];
            if pressure <= exact.pressure_of_front(YIELD_STRESS, 1.0) {
                return;
            }
            let front = front_at(&exact, pressure);
            let [found, outer] = plastic_state(snapshot);
            // the front lies between two points of an element's width
            assert!((found - front).abs() <= size, "{cells} cells, {pressure} MPa: front {found} for {front}");
            worst = worst.max((outer / exact.outer_displacement(YIELD_STRESS, front) - 1.0).abs());
            seen += 1;
        });
        assert!(seen > 5);
        errors.push(worst);
    }
    println!("displacement of the outer surface: {}, orders {:.2?}", scientific(&errors), orders(&errors));
    assert!(errors[2] < 2e-3 && errors.is_sorted_by(|a, b| a > b), "{errors:?}");
}

/// The front under a pressure, by bisection.
fn front_at(exact: &Cylinder, pressure: f64) -> f64 {
    let (mut low, mut high) = (exact.inner, exact.outer);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if exact.pressure_of_front(YIELD_STRESS, middle) < pressure { low = middle } else { high = middle }
    }
    low
}

#[test]
fn the_cylinder_collapses_at_its_limit_pressure() {
    let limit = cylinder(0.4999).limit_pressure(YIELD_STRESS);
    let mut errors = Vec::new();
    for cells in [8, 16] {
        let given = [
            format!("mesh.specimen.radial_cells={cells}"),
            "steps.0.drives.pressure=200".into(),
            "steps.0.increments={\"initial\":0.05,\"maximum\":0.05,\"minimum\":1e-5}".into(),
        ];
        let model = model("thick-cylinder-plastic", &given.each_ref().map(String::as_str));
        let mut reached = 0.0;
        let end = run(&model, |_, snapshot| reached = snapshot.drives()[0]);
        assert!(end.is_err(), "a pressure above the limit was carried: {reached}");
        errors.push((reached / limit - 1.0).abs());
    }
    println!("limit pressure: {}", scientific(&errors));
    assert!(errors[1] < 1e-3, "{errors:?}");
}

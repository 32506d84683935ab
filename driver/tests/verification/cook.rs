//! Cook's membrane.

use super::{model, node_at, run_to_end};

/// Deflection in the middle of the loaded side, mm.
const REFERENCE: f64 = 23.96;

fn deflection(element: &str, cells: usize) -> f64 {
    let [element, cells] = [format!("mesh.specimen.element={element}"), format!("mesh.specimen.cells={cells}")];
    let model = model("cook-membrane", &[&element, &cells]);
    let middle = node_at(&model, [48.0, 52.0]);
    let mut deflection = f64::NAN;
    run_to_end(&model, |_, snapshot| deflection = snapshot.displacement_of(middle, [0.0, 1.0]));
    deflection
}

#[test]
fn deflections_converge_to_the_reference_from_below() {
    for (element, cells, tolerance) in [("T3", 32, 0.03), ("Q4", 32, 0.01), ("T6", 32, 1e-3), ("Q8", 32, 1e-3)] {
        let deflections = [cells / 4, cells / 2, cells].map(|cells| deflection(element, cells));
        let [coarse, middle, fine] = deflections;
        // reduced integration makes Q8 softer than the displacement method: it comes from above
        let differences = [(middle - coarse).abs(), (fine - middle).abs()];
        let order = (differences[0] / differences[1]).log2();
        println!("{element}: {deflections:.4?}, order {order:.2}");
        assert!((fine / REFERENCE - 1.0).abs() < tolerance, "{element}: {deflections:?}");
        // the corner at the upper end of the held side limits the order of displacements to about 1.4
        assert!(order > 0.9, "{element}: order {order}");
    }
}

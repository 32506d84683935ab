//! Arguments of a UMAT besides strain, stress and states.

use super::*;
use crate::kinematics::finite::columns;

#[test]
fn a_umat_receives_place_and_time() {
    for nlgeom in [false, true] {
        let mesh = patch(Variant::new(ElementKind::Q8), PlaneModel::PlaneStrain, 0.1, 0.0);
        let mut solids = Solids::new(&model(mesh.clone(), &linear_elastic(), false, nlgeom)).unwrap();
        let f0 = [1.1, 0.2, -0.1, 0.9, 1.0];
        let f1 = [1.2, 0.1, 0.1, 1.0, 1.0];
        let at = |f: [f64; 5]| moved(&mesh, |[x, y]| [f[0] * x + f[1] * y, f[2] * x + f[3] * y]);
        advance(&mut solids, &at(f0));
        let context = IncrementContext {
            step: 3,
            increment: 7,
            iteration: 2,
            step_time: 0.5,
            total_time: 2.5,
            time_increment: 0.125,
        };
        let mut forces = vec![0.0; 2 * mesh.nodes().len()];
        solids.evaluate(&at(f1), &context, Request::Stress, &mut forces).unwrap();
        // The arguments of the last call: the last point of the last element.
        let call = &solids.blocks[0].body.points.call;
        assert_eq!((call.noel, call.npt, call.kinc), (5, 4, 7));
        assert_eq!(call.jstep, [3, 1, i32::from(nlgeom), 0]);
        assert_eq!((call.time, call.dtime), ([0.5, 2.5], 0.125));
        assert_eq!(call.celent, mesh.characteristic_length(4));
        let (kind, (nodes, _)) = (ElementKind::Q8, mesh.element_positions(4));
        let reference = mesh.integration_points(4)[3].coordinates;
        let [x, y] = crate::element::MappedPoint::new(kind, &nodes, reference).unwrap().position;
        let position = if nlgeom { [f1[0] * x + f1[1] * y, f1[2] * x + f1[3] * y, 0.0] } else { [x, y, 0.0] };
        let (start, end) = if nlgeom { (columns(f0), columns(f1)) } else { ([[0.0; 3]; 3], [[0.0; 3]; 3]) };
        for k in 0..3 {
            approx::assert_abs_diff_eq!(call.coords[k], position[k], epsilon = 1e-14);
            for l in 0..3 {
                let identity = if nlgeom { 0.0 } else { f64::from(k == l) };
                approx::assert_abs_diff_eq!(call.dfgrd0[k][l], start[k][l] + identity, epsilon = 1e-13);
                approx::assert_abs_diff_eq!(call.dfgrd1[k][l], end[k][l] + identity, epsilon = 1e-13);
            }
        }
        // DROT turns counter-clockwise as F does: its first column is where the first axis goes.
        assert_eq!(call.drot[0][1] > 0.0, nlgeom);
        assert_eq!(call.drot[0][1], -call.drot[1][0]);
    }
}

//! The closed forms against the equations that they solve.

use super::beam::Cantilever;
use super::capstan::Capstan;
use super::cylinder::Cylinder;
use super::hertz::LineContact;
use super::pull_out::{DroppingBond, Fibre};

const FIBRE: Fibre = Fibre { diameter: 0.406, modulus: 210e3, length: 12.2 };

/// EA u'' = πφ k u integrated from the tail by small steps of the midpoint rule.
#[test]
fn the_elastic_fibre_solves_its_differential_equation() {
    let stiffness = 400.0;
    let steps = 100_000;
    let step = FIBRE.length / f64::from(steps);
    let (mut slip, mut force) = (1e-3, 0.0);
    for _ in 0..steps {
        let middle_slip = slip + 0.5 * step * force / FIBRE.axial_stiffness();
        let middle_force = force + 0.5 * step * FIBRE.perimeter() * stiffness * slip;
        slip += step * middle_force / FIBRE.axial_stiffness();
        force += step * FIBRE.perimeter() * stiffness * middle_slip;
    }
    assert!((FIBRE.elastic_load(stiffness, slip) / force - 1.0).abs() < 1e-7);
    assert!((FIBRE.elastic_tail_slip(stiffness, slip) / 1e-3 - 1.0).abs() < 1e-7);
}

#[test]
fn debonding_begins_where_elasticity_ends_and_peaks_where_given() {
    let bond = DroppingBond { stiffness: 400.0, strength: 2.0, friction: 1.0 };
    let (load, slip) = FIBRE.debonding(&bond, 0.0);
    assert!((FIBRE.elastic_load(bond.stiffness, slip) / load - 1.0).abs() < 1e-12);
    let peak = FIBRE.debonded_at_peak(&bond);
    let at = |a: f64| FIBRE.debonding(&bond, a).0;
    assert!(at(peak) > at(peak - 1e-3) && at(peak) > at(peak + 1e-3));
    let (load, _) = FIBRE.debonding(&bond, FIBRE.length);
    assert!((load / FIBRE.friction_load(bond.friction, 0.0) - 1.0).abs() < 1e-12);
}

#[test]
fn the_cylinder_meets_its_boundary_conditions() {
    let cylinder = Cylinder { inner: 100.0, outer: 200.0, modulus: 210e3, poisson: 0.3 };
    assert!((cylinder.elastic_stress(50.0, 100.0).0 + 50.0).abs() < 1e-12);
    assert!(cylinder.elastic_stress(50.0, 200.0).0.abs() < 1e-12);
    // ε_θ = u/r = [(1−ν²) σ_θ − ν(1+ν) σ_r]/E
    let (radial, hoop) = cylinder.elastic_stress(50.0, 130.0);
    let strain = ((1.0 - 0.09) * hoop - 0.3 * 1.3 * radial) / 210e3;
    assert!((cylinder.elastic_displacement(50.0, 130.0) / 130.0 / strain - 1.0).abs() < 1e-12);
    // the front starts at the inner surface when the elastic stresses reach Y there
    let pressure = cylinder.pressure_of_front(240.0, 100.0);
    let (radial, hoop) = cylinder.elastic_stress(pressure, 100.0);
    assert!(((hoop - radial) / (2.0 * 240.0 / 3.0_f64.sqrt()) - 1.0).abs() < 1e-12);
    assert!((cylinder.pressure_of_front(240.0, 200.0) / cylinder.limit_pressure(240.0) - 1.0).abs() < 1e-12);
    let outer = cylinder.elastic_displacement(pressure, 200.0);
    assert!((cylinder.outer_displacement(240.0, 100.0) / outer - 1.0).abs() < 1e-12);
}

/// Hooke's law in plane stress between the displacements' differences and the stresses; the energy by quadrature.
#[test]
fn the_cantilever_is_a_solution_of_plane_stress() {
    let beam = Cantilever { length: 8.0, height: 2.0, thickness: 0.5, modulus: 1000.0, poisson: 0.3, load: 3.0 };
    let h = 1e-5;
    let difference = |[x, y]: [f64; 2], axis: usize, component: usize| {
        let shift = if axis == 0 { [h, 0.0] } else { [0.0, h] };
        let at = |sign: f64| beam.displacement([x + sign * shift[0], y + sign * shift[1]])[component];
        (at(1.0) - at(-1.0)) / (2.0 * h)
    };
    for point in [[1.0, 0.3], [4.0, -0.9], [7.5, 0.0]] {
        let (e_x, e_y) = (difference(point, 0, 0), difference(point, 1, 1));
        let shear = difference(point, 1, 0) + difference(point, 0, 1);
        let [s_x, s_y, s_xy] = beam.stress(point);
        assert!((e_x - (s_x - 0.3 * s_y) / 1000.0).abs() < 1e-8);
        assert!((e_y - (s_y - 0.3 * s_x) / 1000.0).abs() < 1e-8);
        assert!((shear - s_xy * 2.6 / 1000.0).abs() < 1e-8);
    }
    let (nx, ny) = (400, 400);
    let mut energy = 0.0;
    for i in 0..nx {
        for j in 0..ny {
            let x = 8.0 * (f64::from(i) + 0.5) / f64::from(nx);
            let y = -1.0 + 2.0 * (f64::from(j) + 0.5) / f64::from(ny);
            let [s_x, _, s_xy] = beam.stress([x, y]);
            energy += (s_x * s_x / 2000.0 + s_xy * s_xy * 2.6 / 2000.0) * 0.5 * 16.0 / f64::from(nx * ny);
        }
    }
    assert!((energy / beam.strain_energy() - 1.0).abs() < 1e-4);
}

#[test]
fn hertz_pressure_carries_the_force() {
    let contact = LineContact { radius: 10.0, bodies: [(210e3, 0.3), (70e3, 0.33)] };
    let a = contact.half_width(500.0);
    let n = 200_000;
    let sum: f64 = (0..n).map(|k| contact.pressure(500.0, a * (2.0 * (f64::from(k) + 0.5) / f64::from(n) - 1.0))).sum();
    assert!((sum * 2.0 * a / f64::from(n) / 500.0 - 1.0).abs() < 1e-6);
}

/// dT/dθ integrated by small steps of the midpoint rule; without bond on the arc the load is amplified as a whole.
#[test]
fn the_capstan_solves_its_differential_equation() {
    for (friction, bond) in [(0.3, 0.1), (0.3, 0.0), (0.0, 0.1)] {
        let capstan = Capstan { radius: 10.0, line_radius: 10.1, angle: 1.5, friction, bond };
        let steps = 100_000;
        let step = capstan.angle / f64::from(steps);
        let slope = |force: f64| 10.0 / 10.1 * (friction * force + 10.0 * bond);
        let mut force = 7.0;
        for _ in 0..steps {
            force += step * slope(force + 0.5 * step * slope(force));
        }
        assert!((capstan.pull(7.0) / force - 1.0).abs() < 1e-9);
    }
    let thin = Capstan { radius: 10.0, line_radius: 10.0, angle: 1.5, friction: 0.3, bond: 0.0 };
    assert!((thin.pull(7.0) / thin.amplified_pull(7.0) - 1.0).abs() < 1e-14);
    assert!(Capstan { bond: 0.1, ..thin }.pull(7.0) < Capstan { bond: 0.1, ..thin }.amplified_pull(7.0));
}

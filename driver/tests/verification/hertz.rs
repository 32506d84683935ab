//! A cylinder on a plane.

use super::{model, run_to_end};
use end_to_end_tests::analytical::hertz::LineContact;

/// Cylinder and base.
const PAIR: LineContact = LineContact { radius: 10.0, bodies: [(210e3, 0.3); 2] };

#[test]
fn half_width_and_peak_pressure_are_hertz_with_one_point_on_an_edge_and_with_two() {
    // two share the gap of their quadratic edge; the pressures of neighbouring edges still alternate a little
    for (points, accepted) in [(1, 1e-2), (2, 3e-2)] {
        half_width_and_peak_pressure_are_hertz(&format!("contact.quadrature={{\"gauss\": {points}}}"), accepted);
    }
}

/// `accepted`: allowed error of the greatest pressure of a point; the value from all points together is within 1 %.
fn half_width_and_peak_pressure_are_hertz(quadrature: &str, accepted: f64) {
    half_width_and_peak_pressure_are(&PAIR, &[quadrature], accepted);
}

/// A part all of whose nodes are moved by a drive does not deform.
#[test]
fn half_width_and_peak_pressure_are_hertz_under_a_rigid_cylinder() {
    let supports = serde_json::json!({
        "base": { "nodes": "bottom" },
        "symmetry": { "direction": "x" },
        "tool": { "nodes": "cylinder", "direction": [0, -1], "drive": "press" },
        "across": { "nodes": "cylinder", "direction": "x" },
    });
    let rigid = LineContact { bodies: [(f64::INFINITY, 0.0), PAIR.bodies[1]], ..PAIR };
    let supports = format!("supports={supports}");
    half_width_and_peak_pressure_are(&rigid, &[&supports, "steps.0.drives.press=0.006"], 1e-2);
}

fn half_width_and_peak_pressure_are(pair: &LineContact, overrides: &[&str], accepted: f64) {
    let model = model("hertz", overrides);
    let base =
        model.supports.iter().position(|support| support.name.starts_with("base") && support.direction[1] == 1.0);
    let base = base.unwrap();
    let (mut force, mut points) = (0.0, Vec::new());
    run_to_end(&model, |_, snapshot| {
        // the model is one half
        force = 2.0 * snapshot.reaction_of(base, [0.0, 1.0]);
        let point = |point: fe_core::contact::PointRecord<'_>| {
            (point.position.map(|x| x[0]), point.pressure, point.area * point.weight)
        };
        points = snapshot.contact().points().map(point).collect();
    });
    let (half_width, peak) = (pair.half_width(force), pair.peak_pressure(force));
    // the surfaces share the cylinder's curvature as they share the compliance, and lean by it
    let [of_cylinder, of_base] = pair.bodies.map(|(modulus, poisson)| (1.0 - poisson * poisson) / modulus);
    let lean = |x: f64| x / pair.radius * of_base / (of_cylinder + of_base);
    let carried: f64 =
        points.iter().map(|(x, pressure, area)| 2.0 * pressure * area * x.map_or(1.0, |x| lean(x).cos())).sum();
    approx::assert_relative_eq!(carried, force, max_relative = 1e-4);

    // p² = p_0² (1 − x²/a²) is a line in x², fitted where it is not next to the edge of contact
    let inside = points.iter().filter_map(|&(x, p, _)| x.filter(|x| *x < 0.8 * half_width).map(|x| (x * x, p * p)));
    let inside: Vec<(f64, f64)> = inside.collect();
    let count = inside.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| inside.iter().map(f).sum::<f64>() / count;
    let (mx, my) = (mean(&|p| p.0), mean(&|p| p.1));
    let slope = mean(&|p| (p.0 - mx) * (p.1 - my)) / mean(&|p| (p.0 - mx).powi(2));
    let fitted_peak = (my - slope * mx).sqrt();
    let fitted_width = fitted_peak / (-slope).sqrt();
    let greatest = points.iter().fold(0.0_f64, |greatest, (_, pressure, _)| greatest.max(*pressure));
    let closed = points.iter().filter(|(_, pressure, _)| *pressure > 0.0);
    let last = closed.filter_map(|(x, ..)| *x).fold(0.0, f64::max);
    println!(
        "{overrides:?}: P {force:.1} N/mm: a {half_width:.4}, fitted {fitted_width:.4}, last closed point {last:.4}"
    );
    println!("p_0 {peak:.1}, fitted {fitted_peak:.1}, greatest {greatest:.1} MPa, {count} points");
    approx::assert_relative_eq!(fitted_width, half_width, max_relative = 1e-2);
    approx::assert_relative_eq!(fitted_peak, peak, max_relative = 1e-2);
    approx::assert_relative_eq!(greatest, peak, max_relative = accepted);
}

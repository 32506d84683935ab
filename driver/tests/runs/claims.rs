//! Behaviour that the case descriptions state: unloading, closing cracks, bond cycles, closed forms of the
//! examples.

use crate::program::{Desk, Run, cases};

fn run(desk: &Desk, case: &str, overrides: &[&str]) -> Run {
    desk.run(&cases().join(case), overrides, &case.replace('/', "_"), 0)
}

/// Value of a column at the end of each step, the initial state first.
fn ends(run: &Run, column: &str) -> Vec<f64> {
    let (step, values) = (run.history.column("step"), run.history.column(column));
    let last = |k: &usize| k + 1 == step.len() || step[k + 1] != step[*k];
    (0..step.len()).filter(last).map(|k| values[k]).collect()
}

/// Slope of the first increment of each step.
fn first_slopes(run: &Run, x: &str, y: &str) -> Vec<f64> {
    let (step, x, y) = (run.history.column("step"), run.history.column(x), run.history.column(y));
    let first = |k: &usize| step[*k] != step[k - 1];
    (1..step.len()).filter(first).map(|k| (y[k] - y[k - 1]) / (x[k] - x[k - 1])).collect()
}

/// Slope of the first increment that is wholly in compression, and of the first in tension after it.
fn slopes_after_reversal(run: &Run) -> (f64, f64) {
    let (e, s) = (run.history.column("e11"), run.history.column("s11"));
    let slope = |k: usize| (s[k] - s[k - 1]) / (e[k] - e[k - 1]);
    let rounding = 1e-12;
    let compressed = (1..e.len()).find(|&k| e[k] < e[k - 1] && e[k - 1] < rounding).expect("compression");
    let extended = (compressed..e.len()).find(|&k| e[k] > e[k - 1] && e[k - 1] > -rounding).expect("tension");
    (slope(compressed), slope(extended))
}

#[test]
fn model_i_unloads_to_the_origin() {
    let desk = Desk::new();
    for mode in ["tension-plane-strain", "tension-plane-stress", "compression-plane-strain", "compression-plane-stress"]
    {
        let run = run(&desk, &format!("chapter-4/4.5-{mode}.json"), &[]);
        let (strain, slopes) = (ends(&run, "e11"), first_slopes(&run, "e11", "s11"));
        for k in [2, 4, 6, 8] {
            assert!(strain[k].abs() < 1e-12, "{mode}, step {k}: {}", strain[k]);
            // the slope of unloading falls from cycle to cycle, below that of the virgin material
            assert!(slopes[k - 1] < 0.999 * slopes[(k - 2).max(1) - 1], "{mode}, step {k}: {slopes:?}");
        }
    }
}

#[test]
fn model_ii_keeps_a_permanent_strain() {
    let desk = Desk::new();
    for (mode, expected) in [
        ("tension-plane-stress", [0.018173, 0.037449, 0.076626, 0.141448]),
        ("compression-plane-stress", [-0.058660, -0.093580, -0.148831, -0.225316]),
    ] {
        let run = run(&desk, &format!("chapter-4/4.6-{mode}.json"), &[]);
        let strain = ends(&run, "e11");
        for (k, expected) in [2, 4, 6, 8].into_iter().zip(expected) {
            assert!((strain[k] / expected - 1.0).abs() < 1e-4, "{mode}, step {k}: {}", strain[k]);
        }
    }
}

#[test]
fn the_stiffness_recovers_on_reversal() {
    let desk = Desk::new();
    for (case, stiffness) in [
        ("5.1-plane-stress", 31800.0 / 0.96),
        ("5.1-plane-strain", 31800.0 * 0.8 / (1.2 * 0.6)),
        ("5.8-reverse-cyclic-model-iv", 31800.0),
        ("5.8-reverse-cyclic-concrete-damage", 31800.0),
    ] {
        let run = run(&desk, &format!("chapter-5/{case}.json"), &["output.plots=false"]);
        let (compressed, extended) = slopes_after_reversal(&run);
        // the first compression after damage in tension has the virgin stiffness (where compression damages from
        // the first increments on, less their damage)
        let virgin = if case.starts_with("5.1") { 2e-2 } else { 1e-9 };
        assert!((compressed / stiffness - 1.0).abs() < virgin, "{case}: {compressed}");
        // back in tension, that of the damage in tension
        assert!(extended < 0.8 * stiffness, "{case}: {extended}");
    }
}

#[test]
fn cracks_close_at_the_permanent_strain() {
    let desk = Desk::new();
    let run = run(&desk, "chapter-5/5.8-reverse-cyclic-inelastic.json", &[]);
    // back at zero strain after an opening to 2e-4, the closed crack is already compressed, with full stiffness
    let (stress, slopes) = (ends(&run, "s11"), first_slopes(&run, "e11", "s11"));
    assert!((stress[4] + 0.900).abs() < 1e-3, "{}", stress[4]);
    assert!((slopes[4] / 31800.0 - 1.0).abs() < 1e-9, "{}", slopes[4]);
}

#[test]
fn the_bond_law_meets_its_joints() {
    let desk = Desk::new();
    let runs = ["a", "b"].map(|law| run(&desk, &format!("chapter-8/8.1-bond-monotonic-law-{law}.json"), &[]));
    for run in &runs {
        let slips = [0.0009383090765017663, 0.178762367451237, 7.9112, 10.0];
        for (slip, expected) in slips.into_iter().zip([0.8913936, 1.3796207, 0.5, 0.5]) {
            let traction = run.history.at("slip", slip, "tau");
            assert!((traction - expected).abs() < 2e-4, "{slip}: {traction}");
        }
        assert!((run.peak("tau", "max") - 1.3796207).abs() < 1e-7);
        assert!(run.history.column("p").iter().all(|p| (p - 2.0).abs() < 1e-12));
    }
    // law B has the envelope of law A
    let [a, b] = runs.map(|run| run.history.column("tau"));
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-13));
}

#[test]
fn bond_cycles_unload_and_return() {
    let desk = Desk::new();
    for (law, stiffness) in [("a", 850.0), ("b", 950.0)] {
        let case = format!("chapter-8/8.14-bond-cyclic-law-{law}.json");
        let whole = run(&desk, &case, &[]);
        let traction = ends(&whole, "tau");
        for cycle in 0..4 {
            let unloading = 3 * cycle + 2;
            // small increments: the stick part of the branch is short
            let fine = format!("steps.{}.increments=20000", unloading - 1);
            let slope = first_slopes(&run(&desk, &case, &[&fine, "output.plots=false"]), "slip", "tau")[unloading - 1];
            assert!((slope / stiffness - 1.0).abs() < 1e-9, "law {law}, step {unloading}: {slope}");
            // reloading ends on the envelope, where it was left
            let (left, found) = (traction[unloading - 1], traction[unloading + 1]);
            assert!((found - left).abs() < 1e-9, "law {law}, cycle {cycle}: {found} for {left}");
        }
    }
}

#[test]
fn the_examples_have_their_closed_forms() {
    let desk = Desk::new();
    let shear = run(&desk, "examples/j2-cyclic-shear.json", &[]);
    let plastic = shear.history.column("peeq");
    let stress = shear.history.column("s12");
    let yielding = plastic.iter().position(|p| *p > 0.0).expect("it yields");
    assert!((stress[yielding] - 347.0 / 3.0_f64.sqrt()).abs() < 0.03, "{}", stress[yielding]);
    let large = run(&desk, "examples/simple-shear-large.json", &[]);
    let expected = 400.0 * 1.0_f64.sin();
    assert!((large.history.last("s12") / expected - 1.0).abs() < 3e-4, "{}", large.history.last("s12"));
}

/// A bar that is unloaded slides back over the shear lag of the bond's stiffness k, of the bar's own shear, and of what is free at the
/// exit: 1/K = coth(βL)/(EAβ) + r/(EA), β² = k'πφ/(EA), 1/k' = 1/k + φ/(3G); a line of contact is twice as wide as the bar's section.
#[test]
fn a_bar_under_cycles_unloads_over_its_shear_lag_and_returns_to_its_envelope() {
    const DIAMETER: f64 = 32.0;
    const YOUNGS_MODULUS: f64 = 205_700.0;
    const SHEAR_MODULUS: f64 = YOUNGS_MODULUS / 2.6;
    // of the coarse mesh: the hole's rounded edge
    const FREE: f64 = 8.0;
    let desk = Desk::new();
    let cycle = |slip: f64, first: f64| {
        format!(
            r#"{{"slip":{slip},"increments":{{"initial":0.02,"maximum":0.2}}}},
               {{"slip":-{slip},"increments":{{"initial":{first},"maximum":0.2}},"until":{{"quantity":"load","less_than":0}}}},
               {{"slip":{slip},"increments":{{"initial":0.01,"maximum":0.2}}}}"#
        )
    };
    let steps = format!("steps=[{},{}]", cycle(0.1, 0.002), cycle(0.5, 0.0004));
    for (law, stiffness) in [("A", 850.0), ("B", 950.0)] {
        let overrides = [
            &format!("contact.law.props.law={law}"),
            &steps,
            "contact.law.props.mu=0",
            r#"parts.matrix.material={"plugin":"linear_elastic","props":{"E":31800000,"nu":0.18}}"#,
            "mesh.specimen.mesh_size=1.5",
            "mesh.specimen.exit_size=8",
            "mesh.specimen.fibres.0.exit_radius=8",
            "output.plots=false",
        ];
        let run = run(&desk, "chapter-8/8.14-bar-cyclic.json", &overrides);
        let stiffness = 1.0 / (1.0 / stiffness + DIAMETER / (3.0 * SHEAR_MODULUS));
        let axial = YOUNGS_MODULUS * 0.25 * std::f64::consts::PI * DIAMETER * DIAMETER;
        let beta = (stiffness * std::f64::consts::PI * DIAMETER / axial).sqrt();
        let expected = 1.0 / (1.0 / (axial * beta * (beta * (350.0 - FREE)).tanh()) + FREE / axial);
        let (slopes, loads) = (first_slopes(&run, "slip_exit", "load"), ends(&run, "load"));
        for unloading in [2, 5] {
            let error = slopes[unloading - 1] / expected - 1.0;
            assert!(error.abs() < 0.01, "law {law}, step {unloading}: {error:.4}");
            assert!(loads[unloading] < 0.0, "law {law}, step {unloading}: {}", loads[unloading]);
            let returned = loads[unloading + 1] / loads[unloading - 1] - 1.0;
            assert!(returned.abs() < 0.005, "law {law}, step {unloading}: {returned:.2e}");
        }
        let (dissipated, work) = (run.history.column("interface_dissipation"), run.history.last("external_work"));
        assert!(dissipated.windows(2).all(|pair| pair[1] - pair[0] > -1e-9 * work), "law {law}");
    }
}

//! Paths with closed-form answers, driven through the shipped plugins.

use super::{Observer, Row, Statistics, Stop, run};
use crate::program::*;
use std::io;
use umat_abi::host::{Found, Plugin, search_paths};

/// Keeps every row.
#[derive(Default)]
struct Rows(Vec<Vec<f64>>);

impl Observer for Rows {
    fn row(&mut self, row: Row<'_>) -> io::Result<()> {
        let mut line = vec![f64::from(row.step), f64::from(row.increment)];
        line.extend_from_slice(row.values);
        line.push(f64::from(row.iterations));
        self.0.push(line);
        Ok(())
    }

    fn increment_done(&mut self, _row: Row<'_>, _so_far: Statistics) {}
}

fn plugin(name: &str, props: &[f64]) -> Plugin {
    let found = Found::by_name(name, &search_paths(&[])).expect("plugins are built next to the tests");
    let library = crate::isolation::load(&found.path).expect("a library");
    Plugin { props: props.to_vec(), ..Plugin::with_defaults(&library, &library.laws()[0]) }
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn program(plugin: Plugin, mode: Mode, nlgeom: bool, steps: Vec<PointStep>) -> Program {
    Program {
        about: About { case_file: "case.json".into(), title: "test".into(), every: 1, ..About::default() },
        document: serde_json::json!({ "kind": "point", "material": { "plugin": plugin.name } }),
        plugin,
        kind: PointKind::Point(PointProgram {
            mode,
            nlgeom,
            measure: Measure::Logarithmic,
            heat: false,
            arguments: crate::arguments::UmatArguments::default(),
            initial: PointState {
                strain: [0.0; 6],
                stress: None,
                statev: None,
                time: 0.0,
                deformation_gradient: IDENTITY,
                fields: FieldValues::default(),
            },
            steps,
        }),
        characteristic_length: None,
        controls: IterationLimits::default(),
    }
}

fn step(pace: Pace, drive: PointDrive) -> PointStep {
    let goal = PointGoal { drive, constraints: Vec::new() };
    PointStep { pace, goal, until: None, fields: StepFields::default() }
}

fn ramp(increments: usize, controls: [Control; 6]) -> PointStep {
    step(Pace::Equal { increments, time: 1.0 }, PointDrive::Components { controls, rows: Vec::new() })
}

fn deformation(increments: usize, end: [[f64; 3]; 3]) -> PointStep {
    step(Pace::Equal { increments, time: 1.0 }, PointDrive::DeformationGradient(end))
}

fn rows(program: &Program) -> (Vec<Vec<f64>>, Statistics) {
    let mut rows = Rows::default();
    let (statistics, result) = run(program, &mut rows);
    result.unwrap_or_else(|stop| panic!("{stop:?}"));
    (rows.0, statistics)
}

const FREE: Control = Control::FREE;
const STRAIN: usize = 3;
const STRESS: usize = 9;

#[test]
fn uniaxial_stress_by_mixed_control() {
    let controls = [Control::Strain(1e-3), FREE, FREE, FREE, FREE, FREE];
    let case = program(plugin("linear_elastic", &[31800.0, 0.18]), Mode::ThreeD, false, vec![ramp(10, controls)]);
    let (rows, statistics) = rows(&case);
    assert_eq!(rows.len(), 11);
    let last = rows.last().expect("rows");
    assert!((last[STRESS] - 31.8).abs() < 1e-12);
    assert!((last[STRAIN + 1] + 0.18e-3).abs() < 1e-15);
    assert!(last[STRESS + 1].abs() < 1e-8);
    assert_eq!(last[2], 1.0);
    // the elastic tangent predicts every increment but the first exactly
    assert!(statistics.plugin_calls <= 11, "{statistics:?}");
}

#[test]
fn stress_control_in_every_mode_gives_hookes_law() {
    for (mode, transverse) in [
        (Mode::ThreeD, -0.18),
        (Mode::PlaneStress, -0.18),
        (Mode::Axisymmetric, -0.18),
        (Mode::PlaneStrain, -0.18 / (1.0 - 0.18)),
    ] {
        let controls = [Control::Stress(3.0), FREE, FREE, FREE, FREE, FREE];
        let case = program(plugin("linear_elastic", &[31800.0, 0.18]), mode, false, vec![ramp(3, controls)]);
        let (rows, _) = rows(&case);
        let last = rows.last().expect("rows");
        assert!((last[STRESS] - 3.0).abs() < 1e-8);
        assert!((last[STRAIN + 1] / last[STRAIN] - transverse).abs() < 1e-9, "{mode:?}");
        assert!(last.iter().all(|x| x.is_finite()), "{mode:?}: every column is known");
    }
}

#[test]
fn hardening_is_followed_under_stress_control_to_the_plateau_and_refused_beyond() {
    // 347 MPa, hardening to 400 at 2 % plastic strain, then perfect
    let props = [210_000.0, 0.3, 347.0, 0.0, 400.0, 0.02];
    let to = |stress| [Control::Stress(stress), FREE, FREE, FREE, FREE, FREE];
    let case = program(plugin("j2_plasticity", &props), Mode::ThreeD, false, vec![ramp(20, to(399.0))]);
    let last = rows(&case).0.pop().expect("rows");
    let expected = 399.0 / 210_000.0 + 0.02 * (399.0 - 347.0) / 53.0;
    assert!((last[STRAIN] - expected).abs() < 1e-10, "{} {expected}", last[STRAIN]);

    let case = program(plugin("j2_plasticity", &props), Mode::ThreeD, false, vec![ramp(20, to(420.0))]);
    let mut observed = Rows::default();
    let (statistics, result) = run(&case, &mut observed);
    let Err(Stop::Failed(failure)) = result else { panic!("{result:?}") };
    assert!(failure.message.contains("control e11 by strain"), "{}", failure.message);
    assert_eq!(observed.0.len() as u64, statistics.increments + 1);
    assert_eq!(failure.increment as u64, statistics.increments + 1);
    let attempted = failure.replay["steps"][0]["target"]["s11"].as_f64().expect("the end of the last attempt");
    assert!((400.0..420.0).contains(&attempted), "{attempted}");
}

#[test]
fn free_sides_of_a_case_in_pascals_are_found_as_in_megapascals() {
    let paths = [1.0, 1e6].map(|unit| {
        let props = [210_000.0 * unit, 0.3, 347.0 * unit, 0.0, 2447.0 * unit, 1.0];
        let pulled = [Control::Strain(0.1), FREE, FREE, FREE, FREE, FREE];
        let steps = vec![ramp(50, pulled), ramp(10, [FREE; 6]), ramp(2, [FREE; 6])];
        rows(&program(plugin("j2_plasticity", &props), Mode::ThreeD, false, steps)).0
    });
    for [here, there] in (0..paths[0].len()).map(|row| [&paths[0][row], &paths[1][row]]) {
        for i in 0..6 {
            assert!((there[STRAIN + i] - here[STRAIN + i]).abs() < 1e-10, "{here:?} {there:?}");
            assert!((there[STRESS + i] - 1e6 * here[STRESS + i]).abs() < 1e-8 * 347e6, "{here:?} {there:?}");
        }
    }
}

#[test]
fn a_linear_relation_takes_the_place_of_a_free_component() {
    let mut controls = [Control::Strain(-1e-3), Control::Constraint(0), FREE, FREE, FREE, FREE];
    let relation =
        |equals| Constraint { strain: [0.0; 6], stress: [-0.52, 1.0, 0.0, 0.0, 0.0, 0.0], equals, hold: false };
    let mut first = ramp(5, controls);
    first.goal.constraints = vec![relation(0.0)];
    controls[0] = Control::HoldStrain;
    let mut second = ramp(5, controls);
    second.goal.constraints = vec![relation(2.0)];
    let case = program(plugin("linear_elastic", &[31800.0, 0.18]), Mode::ThreeD, false, vec![first, second]);
    let (rows, _) = rows(&case);
    for row in &rows[1..=5] {
        assert!((row[STRESS + 1] - 0.52 * row[STRESS]).abs() < 1e-7);
    }
    let last = rows.last().expect("rows");
    assert!((last[STRESS + 1] - 0.52 * last[STRESS] - 2.0).abs() < 1e-7);
    assert_eq!(last[STRAIN], -1e-3);
}

#[test]
fn a_table_is_followed_row_by_row_and_until_ends_it() {
    let mut controls = [FREE; 6];
    controls[0] = Control::Strain(0.0);
    let table: Vec<[f64; 6]> = [1e-4, 3e-4, -2e-4, 5e-4].iter().map(|&e| [e, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
    let table = step(Pace::Rows(vec![0.5, 0.25, 1.0, 1.0]), PointDrive::Components { controls, rows: table });
    let mut case = program(plugin("linear_elastic", &[31800.0, 0.18]), Mode::PlaneStress, false, vec![table]);
    case.about.until = Some(Until { column: STRESS, absolute: false, greater_than: None, less_than: Some(-1.0) });
    let (rows, _) = rows(&case);
    assert_eq!(rows.len(), 4, "the row that passes the bound is kept, the rest is not run");
    assert_eq!([rows[1][2], rows[2][2], rows[3][2]], [0.5, 0.75, 1.75]);
    assert!((rows[3][STRESS] + 2e-4 * 31800.0).abs() < 1e-9);
    assert!((rows[3][STRAIN + 2] - 0.18 * 2e-4).abs() < 1e-15, "plane stress determines e33");
}

/// A stretched point is spun rigidly: the stress rotates, nothing else changes.
#[test]
fn rigid_rotation_rotates_the_stress() {
    let stretch = [[1.001, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let quarter_turn = [[0.0, -1.0, 0.0], [1.001, 0.0, 0.0], [0.0, 0.0, 1.0]];
    // F = R U with R turning in many increments: a table of rotations keeps each increment rigid
    let mut steps = vec![deformation(1, stretch)];
    let turns = 4000;
    for k in 1..=turns {
        let angle = std::f64::consts::FRAC_PI_2 * f64::from(k) / f64::from(turns);
        let (s, c) = angle.sin_cos();
        steps.push(deformation(1, [[1.001 * c, -s, 0.0], [1.001 * s, c, 0.0], [0.0, 0.0, 1.0]]));
    }
    let case = program(plugin("linear_elastic", &[31800.0, 0.18]), Mode::ThreeD, true, steps);
    let (rows, _) = rows(&case);
    let (start, last) = (&rows[1], rows.last().expect("rows"));
    for (i, j) in [(0, 1), (1, 0), (2, 2)] {
        assert!((last[STRESS + j] - start[STRESS + i]).abs() < 1e-6 * start[STRESS]);
        assert!((last[STRAIN + i] - start[STRAIN + i]).abs() < 1e-12, "U does not turn");
    }
    assert!((last[15] - quarter_turn[0][0]).abs() < 1e-12 && (last[18] - quarter_turn[1][0]).abs() < 1e-12);
}

/// Simple shear of an elastic law in rotated total strain: with Jaumann's rate σ12 = μ sin γ,
/// σ11 = −σ22 = μ (1 − cos γ). The unrotated strain increment of ABAQUS's convention is first-order in the
/// increment: the error must be small and halve.
#[test]
fn simple_shear_follows_the_jaumann_solution() {
    let mu = 400.0;
    let errors = [1000, 2000].map(|increments| {
        let end = [[1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let shear = deformation(increments, end);
        let case = program(plugin("linear_elastic", &[1000.0, 0.25]), Mode::ThreeD, true, vec![shear]);
        let last = rows(&case).0.pop().expect("rows");
        assert!((last[STRESS + 1] + last[STRESS]).abs() < 1e-9);
        let shear = last[STRESS + 3] - mu * 1.0_f64.sin();
        let normal = last[STRESS] - mu * (1.0 - 1.0_f64.cos());
        shear.hypot(normal) / mu
    });
    assert!(errors[0] < 1e-3, "{errors:?}");
    assert!((errors[0] / errors[1] - 2.0).abs() < 0.01, "{errors:?}");
}

/// Beyond the peak a step to zero stress unloads; it does not follow the softening branch.
#[test]
fn a_step_to_zero_stress_unloads_a_softening_law() {
    // pure_damage, table 5.1 tension: peak 3.58 MPa at 1.14e-4
    let props = [31800.0, 0.18, 5000.0, 1.3, 2e-4];
    for mode in [Mode::PlaneStrain, Mode::PlaneStress, Mode::ThreeD] {
        let controls = |first| [first, FREE, FREE, FREE, FREE, FREE];
        let steps = vec![ramp(20, controls(Control::Strain(2e-4))), ramp(10, controls(Control::Stress(0.0)))];
        let case = program(plugin("pure_damage", &props), mode, false, steps);
        let (rows, _) = rows(&case);
        let (top, last) = (&rows[20], rows.last().expect("rows"));
        assert!(last[STRAIN].abs() < 1e-12 && last[STRESS].abs() < 1e-8, "{mode:?}: back at the origin");
        assert_eq!(last[15], top[15], "{mode:?}: eta does not grow");
    }
}

/// A step without F that follows one with F must not rotate the tensor states again and again.
#[test]
fn a_step_after_a_rotation_does_not_rotate_on() {
    let (s, c) = 0.1_f64.sin_cos();
    let turned = [[1.01 * c, -0.99 * s, 0.0], [1.01 * s, 0.99 * c, 0.0], [0.0, 0.0, 1.0]];
    let hold = ramp(5, [Control::HoldStrain; 6]);
    let rotate = deformation(1, turned);
    let case = program(plugin("j2_plasticity", &[210_000.0, 0.3, 347.0, 0.0]), Mode::ThreeD, true, vec![rotate, hold]);
    let (rows, statistics) = rows(&case);
    assert_eq!(statistics.iterations, 6);
    let plastic_shear = 15 + 9 + 4;
    assert!(rows[1][plastic_shear].abs() > 1e-4, "the step with F yields in shear");
    for row in &rows[2..] {
        assert_eq!(row[plastic_shear], rows[1][plastic_shear]);
    }
}

/// Uniaxial stress to 30 % in logarithmic strain: E ln λ and −ν ln λ as the midpoint rule has them, of second order.
#[test]
fn hypoelastic_stress_converges_to_the_logarithmic_law() {
    let (modulus, ratio, strain) = (1000.0, 0.25, 0.3);
    let errors = [10, 20, 40].map(|increments| {
        let controls = [Control::Strain(strain), FREE, FREE, FREE, FREE, FREE];
        let case =
            program(plugin("linear_elastic", &[modulus, ratio]), Mode::ThreeD, true, vec![ramp(increments, controls)]);
        let last = rows(&case).0.pop().expect("rows");
        assert_eq!(last[STRAIN], strain);
        let across = last[STRAIN + 1] + ratio * strain;
        // 9 components of F follow the stresses
        let stretch = last[STRESS + 6];
        assert!((stretch - strain.exp()).abs() < 1e-15);
        (last[STRESS] / modulus - strain).abs().max(across.abs())
    });
    let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.05), "{errors:?}");
    assert!(errors[2] < 2e-6, "{errors:?}");
}

/// Torn matter is free of stress at any large strain, to all digits that count, but that is not the equilibrium next to
/// the last one.
#[test]
fn free_sides_do_not_jump_to_where_all_is_torn() {
    let props = [31_800.0, 0.18, 5e3, 1.3, 1.905_077e-4, 31.474_79, 1.05, 3e-4, 0.172_27, 0.0, 0.0, 0.0, 0.0, 0.0];
    let sheared = |name: &str, props: &[f64], mode: Mode, increments: usize| {
        let controls = [FREE, FREE, FREE, Control::Strain(6e-4), FREE, FREE];
        let mut rows = Rows::default();
        let (_, result) = run(&program(plugin(name, props), mode, false, vec![ramp(increments, controls)]), &mut rows);
        let largest = rows.0.iter().flat_map(|row| &row[STRAIN..STRAIN + 6]).fold(0.0_f64, |most, e| most.max(e.abs()));
        assert!(largest < 1e-2, "{name}, {mode:?}, {increments} increments: a strain of {largest}");
        (rows.0.pop().expect("a row"), result)
    };
    for increments in [3, 5, 6, 10, 15, 50, 100] {
        let (last, result) = sheared("concrete_damage", &props, Mode::ThreeD, increments);
        assert!(result.is_ok(), "{increments} increments: {result:?}");
        assert!((last[STRESS + 3] / 0.225_702_122_8 - 1.0).abs() < 1e-8, "{}", last[STRESS + 3]);
        assert!((last[STRAIN] / 2.916_248_898e-4 - 1.0).abs() < 1e-8, "{}", last[STRAIN]);
    }
    // where there is no equilibrium near
    for mode in [Mode::ThreeD, Mode::PlaneStrain, Mode::PlaneStress] {
        for increments in [2, 3, 4, 5, 6, 7, 8, 20, 30, 200, 1000] {
            let _ = sheared("concrete_damage", &props, mode, increments);
        }
    }
}

/// Where the stress falls, brittle matter must not be led along its softening to strains without end; where it holds none, rounding
/// is no jump.
#[test]
fn falling_stresses_do_not_lead_to_where_all_is_torn() {
    let damage = [31_800.0, 0.18, 5e3, 1.3, 1.905_077e-4, 31.474_79, 1.05, 3e-4, 0.172_27, 0.0, 0.0, 0.0, 0.0, 0.0];
    let law = |name: &str, props: &[f64]| {
        let mut plugin = plugin(name, props);
        if props.is_empty() {
            let parameters = plugin.law.iter().flat_map(|law| &law.parameters);
            plugin.props = parameters.map(|parameter| parameter.default_value).collect();
        }
        plugin
    };
    let pulled = |to: f64| [Control::Strain(to), FREE, FREE, FREE, FREE, FREE];
    let falling = |to: f64| [Control::Stress(to), FREE, FREE, FREE, FREE, FREE];
    let sheared = |to: f64| [FREE, FREE, FREE, Control::Strain(to), FREE, FREE];
    let falling_and_sheared = [Control::Stress(0.05), FREE, FREE, Control::Strain(1e-3), FREE, FREE];
    let run = |law: Plugin, mode: Mode, steps: Vec<PointStep>| {
        let mut rows = Rows::default();
        let (_, result) = run(&program(law, mode, false, steps), &mut rows);
        let strains = rows.0.iter().flat_map(|row| &row[STRAIN..STRAIN + 6]).filter(|strain| !strain.is_nan());
        (result, strains.fold(0.0_f64, |most, strain| most.max(strain.abs())))
    };
    for mode in [Mode::ThreeD, Mode::PlaneStrain, Mode::PlaneStress] {
        for n in [2, 3, 8, 20, 100, 400] {
            for steps in [
                vec![ramp(n, pulled(2e-4)), ramp(n, falling(0.2)), ramp(n, falling(0.05))],
                vec![ramp(n, pulled(1e-3)), ramp(n, falling(0.0))],
                vec![ramp(n, pulled(2e-4)), ramp(n, falling(0.2)), ramp(n, falling_and_sheared)],
                vec![ramp(n, sheared(6e-4))],
                vec![ramp(n, sheared(3e-3))],
            ] {
                for (name, props) in
                    [("concrete_damage_implex", &damage[..]), ("inelastic_damage", &[]), ("biaxial_damage", &[])]
                {
                    let (_, largest) = run(law(name, props), mode, steps.clone());
                    assert!(largest < 2e-2, "{name}, {mode:?}, {n} increments: a strain of {largest}");
                }
            }
        }
    }
    for n in [2, 20] {
        let steps = vec![
            ramp(n, pulled(1e-3)),
            ramp(n, falling(0.0)),
            ramp(n, [Control::HoldStrain, FREE, FREE, FREE, FREE, FREE]),
        ];
        let (result, _) = run(law("reverse_cyclic_damage", &[]), Mode::ThreeD, steps);
        assert!(result.is_ok(), "{n} increments: {result:?}");
    }
}

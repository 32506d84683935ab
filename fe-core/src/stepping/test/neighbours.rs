//! Runs that go along, against differences of runs with the same increments and against closed forms.

use super::pull_out::{AXISYMMETRIC, bond, bond_with, elastic, fibre, steel};
use super::recorded::{recorded, repeat};
use super::{snap_back, *};
use crate::mesh::specimen::Configuration;
use crate::model::ContactLaw;
use end_to_end_tests::analytical::pull_out::Fibre;

/// Records of a run, and of the runs that go along with it, row by row.
#[derive(Default)]
struct Accompanied {
    records: Vec<Record>,
    neighbours: Vec<Vec<Option<Record>>>,
}

impl Observer for Accompanied {
    fn increment(&mut self, record: &Record, _: &Snapshot<'_>) -> io::Result<Directive> {
        self.records.push(record.clone());
        Ok(Directive::GoOn)
    }

    fn neighbours(&mut self, records: &[Option<Record>]) -> io::Result<()> {
        self.neighbours.push(records.to_vec());
        Ok(())
    }
}

/// Relative step of neighbours.
const STEP: f64 = 1e-5;

fn accompanied(model: &Model, others: &[Model]) -> (Accompanied, Vec<Option<String>>) {
    let mut analysis = Analysis::new(model).unwrap();
    others.iter().for_each(|other| analysis.accompany(other).unwrap());
    let mut keeper = Accompanied::default();
    analysis.run(&mut keeper).unwrap();
    let lost = analysis.lost_neighbours().map(|lost| lost.map(str::to_owned)).collect();
    (keeper, lost)
}

/// Multiplies a parameter of a law.
fn scale(law: &mut PluginLaw, name: &str, factor: f64) {
    let described = law.law.as_ref().unwrap();
    let index = described.parameters.iter().position(|parameter| parameter.name == name).unwrap();
    law.props[index] *= factor;
}

fn with_bond(model: &Model, name: &str, factor: f64) -> Model {
    let mut model = model.clone();
    for pair in &mut model.contacts {
        let (ContactLaw::Uinter(law) | ContactLaw::Fric { law, .. }) = &mut pair.law;
        scale(law, name, factor);
    }
    model
}

fn with_part(model: &Model, part: usize, name: &str, factor: f64) -> Model {
    let mut model = model.clone();
    scale(&mut model.laws[part], name, factor);
    model
}

/// Compares derivatives of numbers told of each increment, of neighbours moved by a part, with central differences of repeated
/// runs; as part of the greatest.
fn error_against_differences(
    run: &Accompanied,
    (which, moved): (usize, f64),
    vary: &dyn Fn(f64) -> Model,
    value: fn(&Record) -> f64,
) -> f64 {
    let own: Vec<f64> = (run.neighbours.iter().zip(&run.records))
        .map(|(neighbours, record)| (value(neighbours[which].as_ref().unwrap()) - value(record)) / moved)
        .collect();
    let increments = recorded(&run.records);
    let step = 10.0 * moved;
    let [high, low] = [step, -step].map(|step| repeat(&vary(1.0 + step), &increments).unwrap());
    let central = high.iter().zip(&low).map(|(high, low)| (value(high) - value(low)) / (2.0 * step));
    let greatest = own.iter().fold(0.0_f64, |greatest, slope| greatest.max(slope.abs()));
    assert!(greatest > 0.0);
    own.iter().zip(central).map(|(a, b)| (a - b).abs() / greatest).fold(0.0, f64::max)
}

/// Cracks, friction, slip over the peak, multipliers of contact, and elements that leave the far field.
#[test]
fn derivatives_of_a_pull_out_are_those_of_differences() {
    let concrete = PluginLaw::shipped("concrete_damage", &[("E", 23.7e3), ("nu", 0.15), ("Y_t0", 2e-6)]);
    let control = StepControl::Automatic { initial: 1e-3, maximum: 0.05, minimum: 1e-9 };
    let mut model = fibre(Configuration::PLANE, [steel(), concrete], &bond(0.1), 0.1, control);
    for pair in &mut model.contacts {
        pair.enforcement = crate::model::Enforcement::Uzawa { tolerance: 1e-9, max_updates: 4 };
    }
    assert_eq!(model.mesh.parts()[1].name, "matrix");
    let of_bond = ["k_e", "a_1", "b_1", "mu"];
    let of_matrix = ["E", "Y_t0"];
    let vary = |which: usize, factor: f64| match of_bond.get(which) {
        Some(name) => with_bond(&model, name, factor),
        None => with_part(&model, 1, of_matrix[which - of_bond.len()], factor),
    };
    let count = of_bond.len() + of_matrix.len();
    let others: Vec<Model> = (0..count).map(|which| vary(which, 1.0 + STEP)).collect();
    let (run, lost) = accompanied(&model, &others);
    assert!(lost.iter().all(Option::is_none), "{lost:?}");
    let (alone, statistics) = super::run(&model);
    assert!(format!("{alone:?}") == format!("{:?}", run.records), "the run has the same bits alone");
    assert!(statistics.settlements > 0 && statistics.expansions > 0 && statistics.cutbacks > 0, "{statistics:?}");
    let last = run.records.last().unwrap();
    assert!(last.counts.damaged > 0 && last.load < run.records.iter().map(|record| record.load).fold(0.0, f64::max));
    for which in 0..count {
        let error = |value| error_against_differences(&run, (which, STEP), &|factor| vary(which, factor), value);
        let errors = [error(|record| record.load), error(|record| record.energies.external_work)];
        // the last matters so little (it moves the load by 1e-4 of itself) that the noise of positions shows
        let tolerance = if which == count - 1 { 2e-3 } else { 1e-4 };
        assert!(errors.iter().all(|error| *error < tolerance), "{which}: {errors:?}");
    }
}

/// What leads is differentiated too: the drive turns back. At the last increment before, next to the limit point, the curve
/// bends so much that a step of 1e-5 would show as 4 % there, and in all that follows.
#[test]
fn derivatives_through_a_snap_back_are_those_of_differences() {
    let mut model = snap_back::bar();
    // differences see how far from its target Newton's method stops
    model.controls = Controls { force_tolerance: 1e-11, displacement_tolerance: 1e-9, ..model.controls };
    let vary = |factor: f64| with_part(&model, 1, "Y_0", factor);
    let moved = 1e-8;
    let (run, lost) = accompanied(&model, &[vary(1.0 + moved)]);
    assert_eq!(lost, [None]);
    assert!(run.records.windows(2).any(|pair| pair[1].slip < pair[0].slip));
    let values: [fn(&Record) -> f64; 3] =
        [|record| record.slip, |record| record.load, |record| record.energies.elastic];
    let errors = values.map(|value| error_against_differences(&run, (0, moved), &vary, value));
    // 1.5e-4 seen: next to the limit point a change of a state, and so its rounding over the step, shows some 10⁴ times as large
    assert!(errors.iter().all(|error| *error < 5e-4), "{errors:?}");
}

/// P = EAβ tanh(βL) u behind a free length, in a rigid block: dP/dk.
#[test]
fn the_derivative_of_an_elastic_bond_is_that_of_shear_lag() {
    let (modulus, stiffness, slip) = (20e3, 400.0, 1e-3);
    let laws = [elastic(modulus, 0.0), elastic(1e9, 0.0)];
    let control = StepControl::Fixed { increments: 1 };
    let model = fibre(AXISYMMETRIC, laws, &bond_with(&[("k_e", stiffness)]), slip, control);
    let (run, lost) = accompanied(&model, &[with_bond(&model, "k_e", 1.0 + STEP)]);
    assert_eq!(lost, [None]);
    let closed = Fibre { diameter: 0.406, modulus, length: 3.0 };
    let load = |stiffness: f64| {
        let free = 0.5 / closed.axial_stiffness();
        slip / (1.0 / closed.elastic_load(stiffness, 1.0) + free)
    };
    let record = run.records.last().unwrap();
    let slope = (run.neighbours.last().unwrap()[0].as_ref().unwrap().load - record.load) / (STEP * stiffness);
    let exact = (load(stiffness * 1.001) - load(stiffness * 0.999)) / (0.002 * stiffness);
    approx::assert_relative_eq!(record.load, load(stiffness), max_relative = 1e-2);
    approx::assert_relative_eq!(slope, exact, max_relative = 2e-2);
}

#[test]
fn models_with_another_mesh_do_not_go_along() {
    let model = snap_back::bar();
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.0)]);
    let control = StepControl::Fixed { increments: 1 };
    let other = fibre(Configuration::PLANE, [law.clone(), law], &bond(0.0), 0.1, control);
    let error = Analysis::new(&model).unwrap().accompany(&other).unwrap_err();
    assert!(error.to_string().contains("another mesh"), "{error}");
}

/// One that is too far off is given up, and the run goes on.
#[test]
fn what_cannot_go_along_is_lost_and_says_where() {
    let model = snap_back::bar();
    let (run, lost) = accompanied(&model, &[with_part(&model, 1, "A", 50.0)]);
    let reason = lost[0].as_ref().expect("it is another path");
    assert!(reason.starts_with("step 1, increment "), "{reason}");
    let is_there: Vec<bool> = run.neighbours.iter().map(|neighbours| neighbours[0].is_some()).collect();
    assert!(is_there[0] && !is_there.last().unwrap(), "{is_there:?}");
    assert!(is_there.windows(2).all(|pair| pair[0] || !pair[1]), "{is_there:?}");
    assert!(format!("{:?}", run.records) == format!("{:?}", super::run(&model).0));
}

//! A short fibre pulled out of a block: the tangent of the whole system, Newton's convergence, energy, full extraction.

use super::super::newton::{Attempt, Committed, Equilibrium, IncrementGoal};
use super::{Keeper, run};
use crate::assembly::Equations;
use crate::kinematics::PlaneModel;
use crate::mesh::Mesh;
use crate::mesh::specimen::{Configuration, FibreMesh, PerpendicularFibre, perpendicular_fibre};
use crate::model::{
    ContactLaw, ContactPair, Controls, Enforcement, Fit, IncrementContext, Measured, Model, PluginLaw, Quadrature,
    Skipping, Step, StepControl, Support, Width,
};
use crate::output::Activity::{Condensed, Damaged, Elastic, Yielded};
use crate::stepping::{Analysis, Directive, IncrementObserver, Record, Snapshot};

impl Equilibrium<'_> {
    /// Returns the residual at a trial state.
    fn residual_at(&mut self, trial: &Committed, context: IncrementContext) -> Vec<f64> {
        self.evaluate(&Attempt::new(trial, &IncrementGoal::Drives(Vec::new()), context, None)).unwrap();
        self.memory.residual.clone()
    }

    /// Multiplies unknowns by the stiffness K of the last evaluation; the result is by rows.
    fn tangent_times(&mut self, unknowns: &[f64]) -> Vec<f64> {
        self.system.assemble_elements(&self.solids);
        self.system.set_blocks(&self.memory.blocks);
        self.system.multiply(unknowns)
    }
}

/// The bond of chapter 6 with friction.
fn bond(friction: f64) -> PluginLaw {
    bond_with(&[("mu", friction)])
}

/// The bond of chapter 6 without friction, with some parameters changed.
pub(super) fn bond_with(others: &[(&str, f64)]) -> PluginLaw {
    let parameters = [
        ("law", 0.0),
        ("form", 0.0),
        ("normal_law", 0.0),
        ("p_0", 1000.0),
        ("delta_N", 0.004),
        ("k_e", 400.0),
        ("a_1", 3.44),
        ("b_1", 0.13865),
        ("a_2", 1.0),
        ("b_2", -0.1772),
        ("tau_res", 0.0),
        ("k_u", 0.0),
        ("mu", 0.0),
    ];
    let value =
        |(name, value)| (name, others.iter().find(|(other, _)| *other == name).map_or(value, |(_, other)| *other));
    PluginLaw::shipped("bond_slip", &parameters.map(value))
}

fn elastic(modulus: f64, poisson: f64) -> PluginLaw {
    PluginLaw::shipped("linear_elastic", &[("E", modulus), ("nu", poisson)])
}

/// A fibre embedded 3 mm in six elements, pulled by `slip`.
pub(super) fn fibre(
    configuration: Configuration,
    laws: [PluginLaw; 2],
    bond: &PluginLaw,
    slip: f64,
    control: StepControl,
) -> Model {
    let specimen = perpendicular_fibre(&PerpendicularFibre {
        configuration,
        depth: 3.5,
        width: 8.0,
        embedded_length: 3.0,
        free_length: 0.5,
        mesh: FibreMesh {
            embedded_elements: 6,
            exit_size: None,
            interface_size: 0.4,
            growth: 2.0,
            ..FibreMesh::default()
        },
        ..PerpendicularFibre::default()
    })
    .unwrap();
    let mesh = Mesh::new(specimen.definition).unwrap();
    let set = |name: &str| mesh.node_set(name).unwrap().to_vec();
    let support = |name: &str, nodes, direction, drive| Support { name: name.into(), nodes, direction, drive };
    let mut supports = vec![support("grip", set("grip"), [0.0, 1.0], Some(0))];
    match configuration {
        Configuration::Plane => {
            supports.push(support("grip across", set("grip"), [1.0, 0.0], None));
            for direction in [[1.0, 0.0], [0.0, 1.0]] {
                supports.push(support("sides", set("sides"), direction, None));
            }
        }
        Configuration::Axisymmetric { .. } => {
            supports.push(support("axis", set("axis"), [1.0, 0.0], None));
            for direction in [[1.0, 0.0], [0.0, 1.0]] {
                supports.push(support("outer", set("outer"), direction, None));
            }
        }
    }
    let contacts = specimen
        .contact_pairs
        .iter()
        .map(|pair| ContactPair {
            name: pair.name.to_string(),
            slave: mesh.edge_set(&pair.slave).unwrap().to_vec(),
            master: mesh.edge_set(&pair.master).unwrap().to_vec(),
            law: ContactLaw::Uinter(bond.clone()),
            quadrature: Quadrature::Gauss(2),
            width: pair.width.map_or(Width::OfPart, Width::Given),
            penalty_factor: 100.0,
            enforcement: Enforcement::Uzawa { tolerance: 1e-6, max_updates: 4 },
            release: true,
            critical_slip: 0.0,
            fit: Fit::default(),
            bearing: None,
            master_bends: false,
        })
        .collect();
    let [fibre, matrix] = laws;
    let laws =
        mesh.parts().iter().map(|part| if part.name == "fibre" { fibre.clone() } else { matrix.clone() }).collect();
    Model {
        fields: crate::model::Fields::default(),
        average_dilatation: vec![false; mesh.parts().len()],
        laws,
        contacts,
        drives: vec!["slip".into()],
        supports,
        couplings: Vec::new(),
        loads: Vec::new(),
        nlgeom: vec![false; mesh.parts().len()],
        measured: Measured {
            slip: vec![0],
            supports: vec![0],
            direction: specimen.pull_direction,
            exit_node: Some(specimen.fibres[0].exit_node),
            tail_node: Some(specimen.fibres[0].tail_node),
            ..Measured::default()
        },
        steps: vec![Step { time: 1.0, targets: vec![Some(slip)], control }],
        controls: Controls::default(),
        initial_drives: Vec::new(),
        field: None,
        skipping: Skipping::ALL,
        mesh,
    }
}

const AUTOMATIC: StepControl = StepControl::Automatic { initial: 1e-3, maximum: 0.05, minimum: 1e-9 };
const AXISYMMETRIC: Configuration = Configuration::Axisymmetric { outer_radius: None };

fn steel() -> PluginLaw {
    elastic(210e3, 0.3)
}

fn mortar() -> PluginLaw {
    elastic(23.7e3, 0.15)
}

/// πφL times the greatest bond bounds the load; the work is that of the bond; nothing is left at the end.
#[test]
fn a_fibre_is_pulled_out_to_the_last_and_its_energy_is_accounted_for() {
    for (configuration, nlgeom) in [(Configuration::Plane, false), (Configuration::Plane, true), (AXISYMMETRIC, false)]
    {
        let mut model = fibre(configuration, [steel(), mortar()], &bond(0.0), 3.2, AUTOMATIC);
        model.nlgeom.fill(nlgeom);
        let (records, _) = run(&model);
        let peak = records.iter().map(|record| record.load).fold(0.0, f64::max);
        let bound = std::f64::consts::PI * 0.406 * 3.0 * 2.0;
        assert!(peak < bound && peak > 0.97 * bound, "{configuration:?}: peak {peak}, bound {bound}");
        let last = records.last().unwrap();
        assert!(last.load.abs() < 1e-6 * peak, "{configuration:?}: {} left", last.load);
        assert_eq!(last.counts.released, model.contacts.len() * 24 / 2);
        for record in &records {
            assert!(record.energy_error.abs() < 1e-3, "{configuration:?}: {record:?}");
        }
    }
}

/// Where forces balance, and the last correction reduced the residual so far that the next one is within its tolerance, no iteration is made to
/// prove it. The drive's growth is a lower bound of what the increment moves.
#[test]
fn no_iteration_only_proves_that_the_one_before_converged() {
    let model = fibre(Configuration::Plane, [steel(), mortar()], &bond(0.3), 0.5, AUTOMATIC);
    let (records, _) = run(&model);
    let Controls { force_tolerance, displacement_tolerance, .. } = model.controls;
    let (mut slip, mut seen) = (0.0, 0);
    for record in &records {
        let moved = record.slip - slip;
        slip = record.slip;
        for three in record.iterations.windows(3).filter(|three| !three[1].begins_round && !three[2].begins_round) {
            let [before, last, next] = [three[0], three[1], three[2]];
            let reduction = last.residual / before.residual;
            let balances = last.residual <= force_tolerance * last.scale;
            let left = if reduction < 0.05 { reduction * last.correction } else { last.correction };
            assert!(!balances || left > displacement_tolerance * moved, "at {slip}: {before:?} {last:?} {next:?}");
            seen += 1;
        }
    }
    assert!(seen > 10, "{seen}");
}

/// A bond that sticks gives back what it took; one that slid keeps it.
#[test]
fn the_energy_of_interfaces_is_what_can_be_had_back_and_what_cannot() {
    let mut model = fibre(Configuration::Plane, [steel(), mortar()], &bond(0.0), 1e-4, AUTOMATIC);
    let (records, _) = run(&model);
    let last = records.last().unwrap().energies;
    assert!(last.interface > 0.0 && (last.interface_stored / last.interface - 1.0).abs() < 1e-6, "{last:?}");
    model.steps[0].targets = vec![Some(3.2)];
    let (records, _) = run(&model);
    let mut before = 0.0;
    for record in &records {
        let energies = record.energies;
        let dissipation = energies.interface_dissipation();
        // the work by trapezoids is as exact as increments are asked to be
        assert!(dissipation >= before - 1e-3 * energies.external_work, "{record:?}");
        before = before.max(dissipation);
    }
    let last = records.last().unwrap().energies;
    assert!(last.interface_stored.abs() < 1e-6 * last.interface, "{last:?}");
    assert!((last.interface_dissipation() / last.external_work - 1.0).abs() < 1e-2, "{last:?}");
}

/// K δ against central differences of the residual, of the whole system, where points stick, harden, soften, rub.
#[test]
fn the_system_s_tangent_is_the_derivative_of_its_forces() {
    for (configuration, nlgeom) in [(Configuration::Plane, false), (Configuration::Plane, true), (AXISYMMETRIC, false)]
    {
        for friction in [0.0, 0.3] {
            for slip in [0.002, 0.012, 0.2] {
                let fixed = StepControl::Fixed { increments: 3 };
                let mut model = fibre(configuration, [steel(), mortar()], &bond(friction), slip, fixed);
                model.nlgeom.fill(nlgeom);
                let error = tangent_error(&model);
                assert!(error < 1e-6, "{configuration:?}, nlgeom {nlgeom}, μ {friction}, slip {slip}: {error:e}");
            }
        }
    }
}

/// The largest error of K δ relative to the largest entry, at the end of a run and a little on.
fn tangent_error(model: &Model) -> f64 {
    let mut model = model.clone();
    model.skipping = Skipping::NONE;
    let mut analysis = Analysis::new(&model).unwrap();
    analysis.run(&mut Keeper::default()).unwrap();
    let start = analysis.present.committed.clone();
    let equilibrium = &mut analysis.equilibrium;
    let context =
        IncrementContext { step: 1, increment: 9, iteration: 1, step_time: 0.9, total_time: 0.9, time_increment: 0.1 };
    let rows = equilibrium.system.row_count();
    // a point of the next increment: the fibre moves on by 1 µm, so that slips grow, every row by its own small share
    let mut numbers = end_to_end_tests::Random::new(1);
    let mut random = move || 0.5 * numbers.signed();
    let drives = [1e-3];
    let moved: Vec<f64> = (0..rows).map(|_| 1e-7 * random()).collect();
    let direction: Vec<f64> = (0..rows).map(|_| random()).collect();
    let mut fibre_freedom = vec![false; start.displacements.len()];
    for element in model.mesh.elements().iter().filter(|element| model.mesh.parts()[element.part()].name == "fibre") {
        element.nodes().iter().for_each(|node| fibre_freedom[2 * node + 1] = true);
    }
    let at = |equilibrium: &Equilibrium<'_>, share: f64| {
        let unknowns: Vec<f64> = moved.iter().zip(&direction).map(|(a, b)| a + share * b).collect();
        let change = equilibrium.system.displacements(&unknowns, &drives);
        let mut state = start.clone();
        state.displacements.iter_mut().zip(change).for_each(|(u, du)| *u += du);
        state.drives[0] += drives[0];
        for (freedom, value) in equilibrium.system.displacements(&unknowns, &[0.0]).into_iter().enumerate() {
            if fibre_freedom[freedom] {
                state.displacements[freedom] = start.displacements[freedom] + drives[0] + value;
            }
        }
        state
    };
    let h = 2e-9;
    let (plus, minus) = (at(equilibrium, h), at(equilibrium, -h));
    let [plus, minus] = [plus, minus].map(|state| equilibrium.residual_at(&state, context));
    let middle = at(equilibrium, 0.0);
    equilibrium.residual_at(&middle, context);
    let product = equilibrium.tangent_times(&direction);
    let scale = product.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    plus.iter()
        .zip(&minus)
        .zip(&product)
        .map(|((plus, minus), product)| ((minus - plus) / (2.0 * h) - product).abs() / scale)
        .fold(0.0, f64::max)
}

/// Force that rounding of positions leaves through the penalties, relative to the force scale.
const ROUNDING: f64 = 1e-9;

/// Once no point changes its branch the residual falls quadratically: sticking, softening, flowing, cracking.
#[test]
fn newton_converges_quadratically_in_every_state() {
    let plastic =
        PluginLaw::shipped("j2_plasticity", &[("E", 210e3), ("nu", 0.3)]).followed_by(&[20.0, 0.0, 2120.0, 1.0]);
    let concrete = PluginLaw::shipped("concrete_damage", &[("E", 23.7e3), ("nu", 0.15)]);
    let brittle = PluginLaw::shipped("concrete_damage", &[("E", 23.7e3), ("nu", 0.15), ("Y_t0", 2e-8)]);
    for (name, laws, slip) in [
        ("stick", [steel(), mortar()], 0.002),
        ("slip", [steel(), mortar()], 0.012),
        ("softening", [steel(), mortar()], 0.1),
        ("J2 fibre", [plastic, mortar()], 0.02),
        ("concrete_damage", [steel(), concrete], 0.02),
        ("cracking concrete_damage", [steel(), brittle], 0.02),
    ] {
        let fixed = StepControl::Fixed { increments: 5 };
        let mut model = fibre(Configuration::Plane, laws, &bond(0.1), slip, fixed);
        model.skipping = Skipping::NONE;
        model.controls.force_tolerance = 1e-9;
        model.controls.locate_peak = false;
        model.contacts.iter_mut().for_each(|pair| pair.enforcement = Enforcement::Penalty);
        let (records, _) = run(&model);
        let last = &records.last().unwrap().iterations;
        let relative: Vec<f64> = last.iter().map(|iteration| iteration.residual / iteration.scale).collect();
        eprintln!("{name:26} {}", relative.iter().map(|r| format!("{r:9.1e}")).collect::<String>());
        let [.., before, end] = relative[..] else { panic!("{name}: one iteration") };
        assert!(end < 100.0 * before * before + ROUNDING, "{name}: {relative:?}");
    }
}

/// An attempt that diverges has forces of any size. It does not make the tolerance of the next one coarser.
#[test]
fn attempts_that_are_given_up_leave_the_tolerance_as_it_was() {
    let model = fibre(Configuration::Plane, [steel(), mortar()], &bond(0.1), 0.1, AUTOMATIC);
    let mut analysis = Analysis::new(&model).unwrap();
    let start = analysis.present.committed.clone();
    let equilibrium = &mut analysis.equilibrium;
    let mut far = start.clone();
    far.displacements.iter_mut().enumerate().for_each(|(freedom, u)| *u += 1e-3 * (freedom % 7) as f64);
    let context = IncrementContext { step: 1, increment: 1, iteration: 1, ..IncrementContext::default() };
    equilibrium.residual_at(&far, context);
    assert!(equilibrium.force_scale() > 1e3, "{} N", equilibrium.force_scale());
    equilibrium.restore();
    equilibrium.residual_at(&start, context);
    assert!(equilibrium.force_scale() < 1e-6, "{} N", equilibrium.force_scale());
}

/// Condensing, keeping and reusing change nothing but the cost.
#[test]
fn skipping_gives_the_same_curve() {
    let concrete = PluginLaw::shipped("concrete_damage", &[("E", 23.7e3), ("nu", 0.15)]);
    let mut model =
        fibre(Configuration::Plane, [steel(), concrete], &bond(0.1), 0.3, StepControl::Fixed { increments: 60 });
    let (with, all) = run(&model);
    model.skipping = Skipping::NONE;
    let (without, none) = run(&model);
    assert_eq!(with.len(), without.len());
    for (a, b) in with.iter().zip(&without) {
        assert!((a.load - b.load).abs() < 1e-5 * 7.6, "{} against {}", a.load, b.load);
    }
    assert!(all.factorisations < none.factorisations / 2, "{all:?} against {none:?}");
}

/// What docs/theory/skipping.md says of each item, of a fibre whose concrete cracks: without it the loads keep their bits, or differ
/// within the tolerance of equilibrium.
#[test]
fn without_an_item_loads_keep_their_bits_or_differ_within_the_tolerance() {
    let brittle = PluginLaw::shipped("concrete_damage", &[("E", 23.7e3), ("nu", 0.15), ("Y_t0", 2e-8)]);
    let fixed = StepControl::Fixed { increments: 20 };
    let model = fibre(Configuration::Plane, [steel(), brittle], &bond(0.3), 0.1, fixed);
    let all = Skipping::ALL;
    let run_with = |skipping| run(&Model { skipping, ..model.clone() }).0;
    let records = run_with(all);
    let damaged = records.last().unwrap().counts.damaged;
    assert!(damaged > 5, "it cracks at {damaged} points");
    let greatest = records.iter().map(|record| record.load).fold(0.0, f64::max);
    let apart = |skipping| {
        let others = run_with(skipping);
        assert_eq!(others.len(), records.len(), "{skipping:?}");
        let pairs = others.iter().zip(&records);
        let apart: Vec<f64> = pairs.map(|(other, record)| (other.load - record.load).abs() / greatest).collect();
        eprintln!("{skipping:?}: {apart:?}");
        apart
    };
    let largest = |apart: &[f64]| apart.iter().copied().fold(0.0, f64::max);
    assert_eq!(largest(&apart(Skipping { unchanged_elements: false, ..all })), 0.0);
    assert_eq!(largest(&apart(Skipping { contact_search: false, ..all })), 0.0);
    // the load is a sum of some ten nodal reactions, each as exact as the residuals
    let tolerance = 10.0 * model.controls.force_tolerance;
    let far = apart(Skipping { elastic_far_field: false, ..all });
    assert!(largest(&far) < tolerance, "{far:?}");
    let reuse = apart(Skipping { factor_reuse: false, ..all });
    assert!(largest(&reuse) < tolerance, "{reuse:?}");
}

/// Checks that fields show which elements are condensed, and to which points the counts of the record belong.
struct ActivityCheck {
    increments: usize,
    condensed: usize,
    damaged: usize,
}

impl IncrementObserver for ActivityCheck {
    fn increment(&mut self, record: &Record, snapshot: &Snapshot<'_>) -> std::io::Result<Directive> {
        let activities = crate::output::Fields::of(snapshot).activities;
        let count = |activity| activities.iter().filter(|other| **other == activity).count();
        let active = snapshot.solids().active().iter().filter(|active| **active).count();
        assert_eq!(count(Elastic) + count(Damaged) + count(Yielded), active);
        assert_eq!(count(Damaged) > 0, record.counts.damaged > 0);
        assert_eq!(count(Yielded) > 0, record.counts.yielding > 0);
        assert!(count(Damaged) <= record.counts.damaged && count(Yielded) <= record.counts.yielding);
        self.increments += 1;
        self.condensed = self.condensed.max(count(Condensed));
        self.damaged = self.damaged.max(count(Damaged));
        Ok(Directive::GoOn)
    }
}

#[test]
fn fields_show_what_elements_do() {
    // cracks at a third of a megapascal
    let concrete = PluginLaw::shipped("concrete_damage", &[("E", 23.7e3), ("nu", 0.15), ("Y_t0", 2e-6)]);
    let control = StepControl::Fixed { increments: 20 };
    let model = fibre(Configuration::Plane, [steel(), concrete], &bond(0.1), 0.02, control);
    let mut check = ActivityCheck { increments: 0, condensed: 0, damaged: 0 };
    Analysis::new(&model).unwrap().run(&mut check).unwrap();
    let ActivityCheck { increments, condensed, damaged } = check;
    assert!(increments > 20 && condensed > 0 && damaged > 0, "{increments} {condensed} {damaged}");
}

/// The virgin model has its equations whatever is condensed.
#[test]
fn condensed_models_have_fewer_rows() {
    let model = fibre(Configuration::Plane, [steel(), mortar()], &bond(0.1), 0.1, AUTOMATIC);
    let equations = Equations::new(&model).unwrap();
    let count = equations.count();
    let equilibrium = Equilibrium::new(&model, equations).unwrap();
    assert!(equilibrium.system.row_count() + equilibrium.system.condensed_count() == count);
    assert!(equilibrium.system.condensed_count() > 0, "{count} equations, none condensed");
    assert_eq!(model.mesh.parts()[0].model, PlaneModel::PlaneStress);
}

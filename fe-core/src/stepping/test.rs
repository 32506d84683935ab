//! Whole runs against closed forms: what the parts of an increment give together.

mod pull_out;
mod recorded;
mod skipping;

use super::*;
use crate::element::ElementKind;
use crate::kinematics::PlaneModel;
use crate::mesh::{ElementDefinition, ElementEdge, Mesh, MeshDefinition, Part};
use crate::model::{Controls, Load, LoadKind, Measured, PluginLaw, Skipping, StepControl, Support};
use crate::output::Fields;
use std::io;

mod cover;
mod patch;
mod snap_back;
mod spalling;
mod spin;
mod threads;

/// Keeps the records that it receives.
#[derive(Default)]
struct Keeper(Vec<Record>);

impl IncrementObserver for Keeper {
    fn increment(&mut self, record: &Record, _: &Snapshot<'_>) -> io::Result<Directive> {
        self.0.push(record.clone());
        Ok(Directive::GoOn)
    }
}

/// A strip 4 × 1 of eight Q8, held at x = 0 along x and at its corner along y, pulled along x at the other end.
pub(super) fn strip(law: PluginLaw, model: PlaneModel, end: f64, control: StepControl) -> Model {
    chain(vec![law], model, end, control)
}

/// As [`strip`], its last quarter of the last law.
fn chain(laws: Vec<PluginLaw>, model: PlaneModel, end: f64, control: StepControl) -> Model {
    let (columns, rows) = (4, 2);
    let mut nodes = Vec::new();
    let mut number = std::collections::BTreeMap::new();
    for j in 0..=2 * rows {
        for i in 0..=2 * columns {
            if i % 2 == 0 || j % 2 == 0 {
                number.insert((i, j), nodes.len());
                nodes.push([0.5 * i as f64, 0.25 * j as f64]);
            }
        }
    }
    let mut elements = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let at = |a: usize, b: usize| number[&(2 * i + a, 2 * j + b)];
            let nodes = vec![at(0, 0), at(2, 0), at(2, 2), at(0, 2), at(1, 0), at(2, 1), at(1, 2), at(0, 1)];
            elements.push(ElementDefinition {
                kind: ElementKind::Q8,
                part: if i + 1 == columns { laws.len() - 1 } else { 0 },
                nodes,
            });
        }
    }
    let on = |x: f64| -> Vec<usize> { (0..nodes.len()).filter(|&n| nodes[n][0] == x).collect() };
    let (left, right) = (on(0.0), on(4.0));
    let mesh = Mesh::new(MeshDefinition {
        nodes: nodes.clone(),
        parts: (0..laws.len()).map(|k| Part::new(format!("part {k}"), model, 0.5)).collect(),
        elements,
        ..MeshDefinition::default()
    })
    .unwrap();
    let support = |name: &str, nodes, direction, drive| Support { name: name.into(), nodes, direction, drive };
    Model {
        fields: crate::model::Fields::default(),
        mesh,
        average_dilatation: vec![false; laws.len()],
        nlgeom: vec![false; laws.len()],
        laws,
        contacts: Vec::new(),
        drives: vec!["pull".into()],
        supports: vec![
            support("root", left, [1.0, 0.0], None),
            support("corner", vec![0], [0.0, 1.0], None),
            support("grip", right, [1.0, 0.0], Some(0)),
        ],
        couplings: Vec::new(),
        loads: Vec::new(),
        measured: Measured { slip: vec![0], supports: vec![2], direction: [1.0, 0.0], ..Measured::default() },
        steps: vec![Step { time: 1.0, targets: vec![Some(end)], control }],
        controls: Controls::default(),
        initial_drives: Vec::new(),
        field: None,
        skipping: Skipping::ALL,
    }
}

fn run(model: &Model) -> (Vec<Record>, AnalysisStatistics) {
    let mut keeper = Keeper::default();
    let mut analysis = Analysis::new(model).unwrap();
    analysis.run(&mut keeper).unwrap();
    (keeper.0, analysis.statistics())
}

#[test]
fn an_elastic_strip_needs_one_iteration_and_balances_its_energy() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let model = strip(law, PlaneModel::PlaneStress, 0.04, StepControl::Fixed { increments: 4 });
    let (records, statistics) = run(&model);
    assert_eq!(records.len(), 5);
    assert_eq!(statistics.factorisations, 1, "nothing changes, so one factor is used in all increments");
    for record in &records[1..] {
        assert_eq!(record.iterations.len(), 1);
        // σ = E ε over 1 × 0.5
        let load = 1000.0 * record.slip / 4.0 * 0.5;
        approx::assert_relative_eq!(record.load, load, max_relative = 1e-12);
        approx::assert_relative_eq!(record.energies.elastic, 0.5 * load * record.slip, max_relative = 1e-12);
        assert!(record.energy_error.abs() < 1e-12);
    }
}

#[test]
fn newton_is_quadratic_in_plastic_flow_and_follows_the_hardening_line() {
    let law = PluginLaw::shipped("j2_plasticity", &[("E", 200e3), ("nu", 0.3)]).followed_by(&[400.0, 0.0, 2400.0, 1.0]);
    let mut model = strip(law, PlaneModel::PlaneStress, 0.08, StepControl::Fixed { increments: 4 });
    model.skipping = Skipping::NONE;
    // as near as is asserted
    model.controls.force_tolerance = 1e-9;
    let (records, _) = run(&model);
    for record in &records[1..] {
        let strain: f64 = record.slip / 4.0;
        let yield_strain = 400.0 / 200e3;
        let hardening = 200e3 * 2000.0 / 202e3;
        let stress = if strain < yield_strain { 200e3 * strain } else { 400.0 + hardening * (strain - yield_strain) };
        approx::assert_relative_eq!(record.load, 0.5 * stress, max_relative = 1e-9);
    }
}

#[test]
fn fields_of_a_snapshot_hold_the_stress_of_the_load() {
    for model in [PlaneModel::PlaneStress, PlaneModel::PlaneStrain] {
        let law = PluginLaw::shipped("pure_damage", &[("E", 1000.0), ("nu", 0.25)]);
        let model = strip(law, model, 1e-5, StepControl::Fixed { increments: 1 });
        let mut analysis = Analysis::new(&model).unwrap();
        let mut keeper = Keeper::default();
        analysis.run(&mut keeper).unwrap();
        let snapshot = analysis.snapshot();
        let fields = Fields::of(&snapshot);
        fields.check(&model.mesh).unwrap();
        let load = keeper.0[1].load;
        for (stress, strain) in fields.stresses.iter().zip(&fields.strains) {
            // the cross-section is 1 × 0.5
            approx::assert_relative_eq!(stress[0], load / 0.5, max_relative = 1e-10);
            approx::assert_relative_eq!(strain[0], 1e-5 / 4.0, max_relative = 1e-10);
            let is_plane_stress = model.mesh.parts()[0].model == PlaneModel::PlaneStress;
            assert_eq!(strain[2].is_nan(), is_plane_stress, "nobody knows it in plane stress only");
        }
        let names = &fields.state_names[0];
        assert!(names.contains(&"eta".to_owned()) && names.contains(&"D".to_owned()), "{names:?}");
        assert!(fields.state(&model.mesh, "D").iter().all(|damage| *damage == 0.0));
        let pulled: f64 = fields.reactions.iter().step_by(2).filter(|force| **force > 0.0).sum();
        approx::assert_relative_eq!(pulled, load, max_relative = 1e-10);
    }
}

/// A pressure that turns with its edge pushes down on the edge's projection, however it bends, and couples freedoms
/// although there is no contact.
#[test]
fn a_pressure_follows_the_body_without_contact() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let mut model = strip(law, PlaneModel::PlaneStrain, 1.0, StepControl::Fixed { increments: 2 });
    let (pressure, length, thickness) = (1.0, 4.0, 0.5);
    model.nlgeom.fill(true);
    model.supports.truncate(2);
    let edges = (4..8).map(|element| ElementEdge { element, edge: 2 }).collect();
    model.loads = vec![Load { name: "top".into(), drive: 0, kind: LoadKind::Pressure { edges, pressure } }];
    let tip = model.mesh.nodes().len() - 1;
    model.measured = Measured { supports: vec![1], direction: [1.0, 0.0], exit_node: Some(tip), ..Measured::default() };
    let (records, _) = run(&model);
    let end = records.last().unwrap();
    assert!(end.slip_exit.abs() > 1e-3 * length, "it bends: {end:?}");
    approx::assert_relative_eq!(end.load_lateral, pressure * thickness * (length + end.slip_exit), max_relative = 1e-6);
    assert!(records[1..].iter().all(|record| record.cutbacks == 0 && record.iterations.len() <= 8), "{records:?}");
}

/// A pressure acts on the present section: as Cauchy's stress it is E ln λ, however thin the plate has become.
#[test]
fn a_pressure_acts_on_the_present_thickness() {
    let modulus = 1000.0;
    let law = PluginLaw::shipped("linear_elastic", &[("E", modulus), ("nu", 0.3)]);
    let mut model = strip(law, PlaneModel::PlaneStress, 1.0, StepControl::Fixed { increments: 4 });
    model.nlgeom.fill(true);
    model.supports.truncate(2);
    let edges: Vec<ElementEdge> = [3, 7].map(|element| ElementEdge { element, edge: 1 }).into();
    let tip = model.mesh.nodes().len() - 1;
    model.measured = Measured { supports: vec![0], direction: [1.0, 0.0], exit_node: Some(tip), ..Measured::default() };
    for pressure in [-100.0, 100.0] {
        model.loads =
            vec![Load { name: "end".into(), drive: 0, kind: LoadKind::Pressure { edges: edges.clone(), pressure } }];
        let mut analysis = Analysis::new(&model).unwrap();
        let mut records = Keeper::default();
        analysis.run(&mut records).unwrap();
        let stretch = 1.0 + analysis.snapshot().displacements()[2 * tip] / 4.0;
        // strains are those of the middle of each increment; the thickness changes by 3 %
        approx::assert_relative_eq!(modulus * stretch.ln(), -pressure, max_relative = 1e-4);
        let is_easy = |record: &Record| record.cutbacks == 0 && record.iterations.len() <= 8;
        assert!(records.0[1..].iter().all(is_easy), "{:?}", records.0);
    }
}

/// An attempt that cannot converge is cut as often as the controls allow.
#[test]
fn an_increment_is_given_up_after_the_cutbacks_that_are_allowed() {
    let law = PluginLaw::shipped("j2_plasticity", &[("E", 200e3), ("nu", 0.3)]).followed_by(&[400.0, 0.0, 2400.0, 1.0]);
    let mut model = strip(law, PlaneModel::PlaneStress, 0.08, StepControl::Fixed { increments: 1 });
    model.skipping = Skipping::NONE;
    model.controls.max_iterations = 1;
    model.controls.force_tolerance = 1e-14;
    let attempts = |model: &Model| {
        let mut keeper = Keeper::default();
        let mut analysis = Analysis::new(model).unwrap();
        assert!(analysis.run(&mut keeper).is_err());
        (keeper.0.len(), analysis.statistics().cutbacks)
    };
    model.controls.max_cutbacks = 0;
    assert_eq!(attempts(&model), (1, 1), "the initial state, and one attempt");
    model.controls.max_cutbacks = 3;
    assert!(attempts(&model).0 > 1, "three cuts reach the elastic range");
}

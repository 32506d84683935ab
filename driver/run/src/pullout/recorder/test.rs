use super::*;
use crate::columns::{SPECIMEN, place_in_specimen};
use crate::program::{About, Until};
use crate::pullout::checkpoint::Checkpoints;
use fe_core::element::ElementKind::Q4;
use fe_core::kinematics::PlaneModel::PlaneStrain;
use fe_core::mesh::{ElementDefinition, Mesh, MeshDefinition, Part};
use fe_core::model::{Controls, Measured, Model, Skipping, Step, StepControl};
use fe_core::stepping::{Counts, Energies, Iteration, WireRecord};

/// Two steps of 1 s and 2 s on a mesh that is not computed.
fn program(every: usize) -> PulloutProgram {
    let mesh = Mesh::new(MeshDefinition {
        nodes: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        parts: vec![Part::new("block", PlaneStrain, 1.0)],
        elements: vec![ElementDefinition { kind: Q4, part: 0, nodes: vec![0, 1, 2, 3] }],
        ..MeshDefinition::default()
    });
    let step = |time| Step { time, targets: vec![], control: StepControl::Fixed { increments: 4 } };
    PulloutProgram {
        about: About { case_file: "case.json".into(), every, ..About::default() },
        fields_every: None,
        pictures_at: Vec::new(),
        rupture_strain: 0.03,
        mesh: String::new(),
        fibre_diameter: None,
        fibre_axis: None,
        model: Model {
            fields: fe_core::model::Fields::default(),
            mesh: mesh.expect("a mesh"),
            laws: vec![],
            average_dilatation: vec![],
            contacts: vec![],
            drives: vec![],
            supports: vec![],
            couplings: vec![],
            loads: vec![],
            nlgeom: vec![],
            measured: Measured::default(),
            steps: vec![step(1.0), step(2.0)],
            controls: Controls::default(),
            initial_drives: Vec::new(),
            field: None,
            skipping: Skipping::ALL,
        },
        step_untils: vec![None, None],
    }
}

pub fn record(step: u32, increment: u32, time: f64) -> Record {
    Record {
        step,
        increment,
        time,
        slip: 0.1 * time,
        load: 7.0,
        load_lateral: 8.0,
        load_axial: 8.25,
        load_shear: 8.5,
        slip_exit: 9.0,
        slip_tail: 10.0,
        energies: Energies {
            external_work: 11.0,
            interface: 15.0,
            interface_stored: 12.0,
            opening: 16.0,
            ..Energies::default()
        },
        energy_error: 18.0,
        counts: Counts { damaged: 19, released: 24, ..Counts::default() },
        damaged_volume: 24.25,
        spalled_volume: 24.3,
        spalled_depth: 24.4,
        largest_field: 0.5,
        crack: [1.5, 29.0],
        separation_length: 24.5,
        greatest_bearing_pressure: 25.0,
        plastic_strain: 27.0,
        principal_stress: 28.0,
        wires: vec![WireRecord { strain: 0.029, stress: 1.0 }, WireRecord { strain: 0.001, stress: 30.0 }],
        cutbacks: 26,
        iterations: vec![Iteration::default(); 3],
        fibres: Vec::new(),
        tried: Vec::new(),
    }
}

/// Step, increment and iterations of the rows that are written.
#[derive(Default)]
struct Rows {
    written: Vec<(u32, u32, u32)>,
    values: Vec<f64>,
    done: usize,
}

impl path::Observer for Rows {
    fn row(&mut self, row: Row<'_>) -> io::Result<()> {
        self.written.push((row.step, row.increment, row.iterations));
        self.values = row.values.to_vec();
        Ok(())
    }

    fn increment_done(&mut self, _: Row<'_>, _: Statistics) {
        self.done += 1;
    }
}

/// Step 1 in four increments, step 2 in three of its four.
fn observed(program: &PulloutProgram) -> (Rows, Vec<Directive>) {
    let mut rows = Rows::default();
    let checkpoints = Checkpoints::default();
    let settings = SpecimenSettings::new(program, Path::new(""), &checkpoints);
    let mut recorder = Recorder::new(program, &settings, &mut rows, None);
    let records = (1..=4).map(|k| record(1, k, 0.25 * f64::from(k))).chain((1..=3).map(|k| {
        // three halves of a second: not the end of the step
        record(2, k, 1.0 + 0.5 * f64::from(k))
    }));
    let records: Vec<Record> = std::iter::once(record(0, 0, 0.0)).chain(records).collect();
    let directives =
        records.iter().map(|record| recorder.accept(record).expect("nothing is written to disk")).collect();
    recorder.finish_history().expect("nothing is written to disk");
    (rows, directives)
}

#[test]
fn the_last_row_of_a_step_and_of_the_run_are_written_whatever_the_stride() {
    let (rows, directives) = observed(&program(3));
    assert_eq!(rows.written, [(0, 0, 3), (1, 3, 3), (1, 4, 3), (2, 3, 3)]);
    assert_eq!((rows.done, directives.iter().all(|directive| *directive == Directive::GoOn)), (7, true));
    let (rows, _) = observed(&program(2));
    // the run ends in the middle of its second step: its last row is kept
    assert_eq!(rows.written, [(0, 0, 3), (1, 2, 3), (1, 4, 3), (2, 2, 3), (2, 3, 3)]);
}

#[test]
fn values_stand_under_their_columns() {
    let (rows, _) = observed(&program(1));
    let column = |name: &str| rows.values[place_in_specimen(name).expect("a column")];
    assert_eq!(rows.values.len(), SPECIMEN.len());
    let expected = [
        ("time", 2.5),
        ("slip", 0.25),
        ("load", 7.0),
        ("load_lateral", 8.0),
        ("load_axial", 8.25),
        ("load_shear", 8.5),
        ("slip_exit", 9.0),
        ("slip_tail", 10.0),
        ("external_work", 11.0),
        ("interface_energy", 15.0),
        ("interface_stored_energy", 12.0),
        ("interface_dissipation", 3.0),
        ("opening_energy", 16.0),
        ("energy_error", 18.0),
        ("damaged_points", 19.0),
        ("released_points", 24.0),
        ("damaged_volume", 24.25),
        ("spalled_volume", 24.3),
        ("spalled_depth", 24.4),
        ("separation_length", 24.5),
        ("bearing_pressure_max", 25.0),
        ("cutbacks", 26.0),
        ("plastic_strain_max", 27.0),
        ("stress_max", 28.0),
        ("field_max", 0.5),
        ("field_energy", 29.0),
        // each the greatest of both wires
        ("axial_strain_max", 0.029),
        ("axial_stress_max", 30.0),
    ];
    for (name, value) in expected {
        assert_eq!(column(name), value, "{name}");
    }
}

#[test]
fn bounds_end_a_step_or_the_run() {
    let time_beyond = |bound| Until { column: 2, absolute: false, greater_than: Some(bound), less_than: None };
    let mut of_step = program(10);
    of_step.step_untils[0] = Some(time_beyond(0.6));
    let (rows, directives) = observed(&of_step);
    assert_eq!(directives[3], Directive::EndStep);
    assert!(rows.written.contains(&(1, 3, 3)));
    let mut of_run = program(10);
    of_run.about.until = Some(time_beyond(1.6));
    let (_, directives) = observed(&of_run);
    assert_eq!(directives.iter().position(|directive| *directive == Directive::EndRun), Some(6));
}

/// A relaxation time that is not given cannot be made shorter.
#[test]
fn advice_on_stabilisation_names_what_there_is() {
    let warning = |share, relaxes| stabilisation_warning(share, relaxes).unwrap_or_default();
    assert_eq!(warning(0.009, true), "");
    assert!(warning(0.03, true).ends_with("(a shorter relaxation_time or smaller increments take less)"));
    assert!(warning(0.03, false).ends_with("(smaller increments take less)"));
}

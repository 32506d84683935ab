//! The softening quarter of a bar that is torn off and released.

use super::snap_back::{AREA, LENGTHS, MODULUS, bar, stress};
use super::*;
use crate::model::{ContactLaw, ContactPair, Enforcement, Fit, Quadrature, Spalling, Width};
use crate::output::Activity;

const SPALLING: Spalling = Spalling { opening: 0.01, stress: 0.005, wait: 0.002, fade: 0.004 };
/// Pulled so far, mm.
const END: f64 = 0.04;

fn torn_bar() -> Model {
    let mut model = bar();
    model.steps[0].targets = vec![Some(END)];
    model.controls.spalling = Some(SPALLING);
    model
}

/// Records, the activities at the end, and a checkpoint that is made after the release.
#[derive(Default)]
struct Watch {
    records: Vec<Record>,
    activities: Vec<Activity>,
    checkpoint: Option<Checkpoint>,
}

impl Watch {
    /// Asserts that a run from its checkpoint goes on to the same records.
    fn is_resumed_to_the_bit(&self, model: &Model) {
        let checkpoint = self.checkpoint.as_ref().expect("a checkpoint after the release");
        let mut rest = Watch::default();
        Analysis::resume(model, checkpoint).unwrap().run(&mut rest).unwrap();
        let words = |records: &[Record]| format!("{records:?}");
        assert!(
            words(&rest.records) == words(&self.records[self.records.len() - rest.records.len()..]),
            "to the last bit"
        );
    }
}

impl IncrementObserver for Watch {
    fn increment(&mut self, record: &Record, snapshot: &Snapshot<'_>) -> io::Result<Directive> {
        self.records.push(record.clone());
        self.activities = Fields::of(snapshot).activities;
        Ok(Directive::GoOn)
    }

    fn checkpoint(&mut self, checkpoint: &Checkpoint) -> io::Result<()> {
        if self.records.last().is_some_and(|record| record.spalled_volume > 0.0) {
            self.checkpoint.get_or_insert_with(|| checkpoint.clone());
        }
        Ok(())
    }
}

#[test]
fn a_torn_quarter_is_released_its_force_fades_and_the_energies_balance() {
    let model = torn_bar();
    let mut watch = Watch::default();
    let mut analysis = Analysis::new(&model).unwrap();
    analysis.checkpoint_every(1);
    analysis.run(&mut watch).unwrap();
    let records = &watch.records;
    let released = records.iter().position(|record| record.spalled_volume > 0.0).expect("it is released");
    let strain = |record: &Record| record.slip - record.load / AREA * LENGTHS[0] / 5000.0;
    for record in &records[1..=released] {
        // at a thousandth of the strength the iteration's tolerance is seen
        approx::assert_relative_eq!(record.load / AREA, stress(strain(record)), max_relative = 1e-5, epsilon = 1e-5);
    }
    let at = &records[released];
    approx::assert_relative_eq!(at.spalled_volume, AREA * LENGTHS[1], max_relative = 1e-12);
    assert!(at.energies.spalled > 0.0, "what it stored");
    let torn = records.iter().find(|record| {
        let length = model.mesh.characteristic_length(3);
        strain(record) * length > SPALLING.opening && record.load / AREA <= SPALLING.stress
    });
    let torn = torn.expect("it is torn before").slip;
    assert!(at.slip - torn >= SPALLING.wait && records[released - 1].slip - torn < SPALLING.wait, "{torn} {}", at.slip);
    let mut force = at.load;
    for pair in records[released..].windows(2) {
        // of the slip before: what fades is known when an increment begins
        let share = (1.0 - (pair[0].slip - at.slip) / SPALLING.fade).max(0.0);
        // and a soft spring of 1e-5 of the virgin stiffness parallel to it
        let stretched = strain(&pair[1]) - strain(at);
        force = share * (at.load + 1e-5 * AREA * MODULUS * stretched / LENGTHS[1]);
        approx::assert_relative_eq!(pair[1].load, force, max_relative = 1e-4, epsilon = 1e-9);
    }
    assert_eq!(force, 0.0, "nothing is left of it");
    let last = records.last().unwrap();
    assert_eq!(last.slip, END);
    let added = |released: f64, pair: &[Record]| {
        released + 0.5 * (pair[0].load + pair[1].load) * (pair[1].slip - pair[0].slip) - pair[1].energies.elastic
            + pair[0].energies.elastic
    };
    let added = records[released..].windows(2).fold(0.0, added);
    approx::assert_relative_eq!(last.energies.spalled - at.energies.spalled, added, max_relative = 1e-6);
    let imbalance = |record: &Record| record.energies.imbalance();
    let changes = records[released..].windows(2).map(|pair| imbalance(&pair[1]) - imbalance(&pair[0]));
    let largest = changes.map(f64::abs).fold(0.0, f64::max);
    assert!(largest < 1e-9 * last.energies.external_work, "{largest:e} of {}", last.energies.external_work);
    let expected = |element: usize| if element % 4 == 3 { Activity::Spalled } else { Activity::Elastic };
    assert!(watch.activities.iter().enumerate().all(|(element, activity)| *activity == expected(element)));

    watch.is_resumed_to_the_bit(&model);
}

/// The softening quarter is pulled apart across the bar as well, by less than it still carries when it is torn.
#[test]
fn loads_on_a_released_quarter_fade_and_the_energies_balance() {
    let mut model = torn_bar();
    model.drives.push("press".into());
    // pressed first: no load grows while the elements that carry it go
    let pull = model.steps[0].clone();
    model.steps[0].targets = vec![None, Some(1.0)];
    model.steps.push(Step { targets: vec![Some(END), None], ..pull });
    for (name, element, edge, traction) in [("below", 3, 0, -1e-5), ("above", 7, 2, 1e-5)] {
        let kind = LoadKind::Traction { edges: vec![ElementEdge { element, edge }], traction: [0.0, traction] };
        model.loads.push(Load { name: name.into(), drive: 1, kind });
    }
    let mut watch = Watch::default();
    let mut analysis = Analysis::new(&model).unwrap();
    analysis.run(&mut watch).unwrap();
    let records = &watch.records;
    let released = records.iter().position(|record| record.spalled_volume > 0.9 * AREA * LENGTHS[1]).expect("both are");
    let last = records.last().unwrap();
    assert_eq!(last.slip, END);
    let state = &analysis.present.committed;
    assert!(state.drives[1] == 1.0 && state.external.iter().all(|force| *force == 0.0), "nothing is loaded any more");
    // loaded middle nodes of what is gone are not driven away
    assert!(state.displacements.iter().all(|displacement| displacement.abs() <= 1.01 * END));
    let imbalance = |record: &Record| record.energies.imbalance();
    let changes = records[released..].windows(2).map(|pair| imbalance(&pair[1]) - imbalance(&pair[0]));
    let largest = changes.map(f64::abs).fold(0.0, f64::max);
    assert!(largest < 1e-7 * last.energies.external_work, "{largest:e} of {}", last.energies.external_work);
}

/// Adds nodes, and a stiff element that is a part of its own.
fn add_part(model: &mut Model, added: &[[f64; 2]], of_element: Vec<usize>) {
    let mesh = &model.mesh;
    let definition = |element: &crate::mesh::Element| ElementDefinition {
        kind: element.kind(),
        part: element.part(),
        nodes: element.nodes().to_vec(),
    };
    let mut elements: Vec<_> = mesh.elements().iter().map(definition).collect();
    let part = mesh.parts().len();
    elements.push(ElementDefinition { kind: ElementKind::Q8, part, nodes: of_element });
    let nodes = mesh.nodes().iter().chain(added).copied().collect();
    let parts = (0..=part).map(|k| Part::new(format!("part {k}"), PlaneModel::PlaneStress, 0.5)).collect();
    model.mesh = Mesh::new(MeshDefinition { nodes, parts, elements, ..MeshDefinition::default() }).unwrap();
    model.laws.push(PluginLaw::shipped("linear_elastic", &[("E", BLOCK), ("nu", 0.0)]));
    (model.average_dilatation, model.nlgeom) = (vec![false; part + 1], vec![false; part + 1]);
}

/// The bar of [`torn_bar`], pulled by a block that is bonded to its end.
fn bonded_bar() -> Model {
    let mut model = torn_bar();
    let first = model.mesh.nodes().len();
    let block = [[4.0, 0.0], [5.0, 0.0], [5.0, 1.0], [4.0, 1.0], [4.5, 0.0], [5.0, 0.5], [4.5, 1.0], [4.0, 0.5]];
    add_part(&mut model, &block, (first..first + 8).collect());
    let end = vec![first + 1, first + 2, first + 5];
    model.supports[2].nodes.clone_from(&end);
    model.supports.push(Support { name: "guide".into(), nodes: end, direction: [0.0, 1.0], drive: None });
    let bond = PluginLaw::shipped("bond_slip", &[("normal_law", 0.0), ("p_0", 1000.0), ("delta_N", 0.1), ("mu", 0.3)]);
    model.contacts.push(ContactPair {
        name: "bond".into(),
        slave: [3, 7].map(|element| ElementEdge { element, edge: 1 }).to_vec(),
        master: vec![ElementEdge { element: 8, edge: 3 }],
        law: ContactLaw::Uinter(bond),
        quadrature: Quadrature::Gauss(2),
        width: Width::OfPart,
        penalty_factor: 100.0,
        enforcement: Enforcement::Penalty,
        release: false,
        critical_slip: 0.0,
        fit: Fit::default(),
        bearing: None,
        master_bends: false,
    });
    model
}

/// Modulus of the block, MPa.
const BLOCK: f64 = 1e6;

#[test]
fn contact_moves_to_the_surface_behind_what_was_torn_off_and_is_not_bonded_to_it() {
    let mut model = bonded_bar();
    let control = StepControl::Automatic { initial: 0.02, maximum: 0.05, minimum: 1e-8 };
    let step = |target| Step { time: 1.0, targets: vec![Some(target)], control };
    // torn, pushed on to what is left, and away from it
    let pushed = 0.1;
    model.steps = vec![step(END), step(-LENGTHS[1] - pushed), step(0.0)];
    let mut watch = Watch::default();
    let mut analysis = Analysis::new(&model).unwrap();
    analysis.checkpoint_every(1);
    analysis.run(&mut watch).unwrap();
    let records = &watch.records;
    let compliance =
        (LENGTHS[0] / 5000.0 + LENGTHS[1] / BLOCK + 1.0 / analysis.equilibrium.contact.penalties().next().unwrap())
            / AREA;
    let (mut apart, mut pressed) = (0, 0);
    for record in records.iter().filter(|record| record.step > 1) {
        let shortening = -record.slip - LENGTHS[1];
        let expected = -shortening.max(0.0) / compliance;
        approx::assert_relative_eq!(record.load, expected, max_relative = 1e-6, epsilon = 1e-6);
        *(if shortening > 0.0 { &mut pressed } else { &mut apart }) += 1;
    }
    assert!(pressed > 3 && apart > 3, "{pressed} {apart}");
    let last = records.last().unwrap();
    assert_eq!(last.slip, 0.0);
    let imbalance = |record: &Record| record.energies.imbalance();
    let torn = records.iter().rfind(|record| record.step == 1).unwrap();
    let changes = records.iter().filter(|record| record.step > 1).map(|record| imbalance(record) - imbalance(torn));
    let largest = changes.map(f64::abs).fold(0.0, f64::max);
    assert!(largest < 1e-6 * 0.5 * pushed * pushed / compliance, "{largest:e}");

    watch.is_resumed_to_the_bit(&model);
}

/// The lower half of the bar's end is gone, and of a cover in front of the block what is fixed to it.
#[test]
fn contact_moves_to_what_faces_the_master_and_not_to_a_cover() {
    let mut model = bonded_bar();
    let at = |place: [f64; 2]| model.mesh.nodes().iter().position(|node| *node == place).unwrap();
    let [below, above, middle] = [[4.0, 0.0], [4.0, 0.5], [4.0, 0.25]].map(at);
    let first = model.mesh.nodes().len();
    let cover = [[4.5, 0.0], [4.5, 0.5], [4.25, 0.0], [4.5, 0.25], [4.25, 0.5]];
    let nodes = vec![below, first, first + 1, above, first + 2, first + 3, first + 4, middle];
    add_part(&mut model, &cover, nodes);
    let first = model.mesh.nodes().len();
    let further = [[5.0, 0.0], [5.0, 0.5], [4.75, 0.0], [5.0, 0.25], [4.75, 0.5]];
    let nodes = vec![first - 5, first, first + 1, first - 4, first + 2, first + 3, first + 4, first - 2];
    add_part(&mut model, &further, nodes);
    assert_eq!(model.parts_behind(), [3]);

    let mut analysis = Analysis::new(&model).unwrap();
    let displacements = vec![0.0; 2 * model.mesh.nodes().len()];
    let count = analysis.equilibrium.contact.points().count();
    analysis.equilibrium.release(&[3, 9], &displacements);
    let contact = &mut analysis.equilibrium.contact;
    let mut forces = displacements.clone();
    let context = IncrementContext { step: 1, increment: 1, iteration: 1, ..IncrementContext::default() };
    let request = umat_abi::law::Request::Stress;
    contact.evaluate(&displacements, &context, request, &mut forces, &mut Default::default()).unwrap();
    let new: Vec<_> = contact.points().skip(count).map(|point| (point.position, point.gap)).collect();
    let place = |y: f64| (Some([3.0, y]), 1.0);
    let half = 0.25 / 3.0_f64.sqrt();
    for ((position, gap), (expected, distance)) in new.iter().zip([place(0.25 - half), place(0.25 + half)]) {
        approx::assert_relative_eq!(position.unwrap()[..], expected.unwrap()[..], max_relative = 1e-14);
        approx::assert_relative_eq!(*gap, distance, max_relative = 1e-14);
    }
    assert_eq!(new.len(), 2, "neither the upper half's side nor the rest of the cover");
}

#[test]
fn what_holds_on_to_nothing_is_loose() {
    let mut model = torn_bar();
    // eight elements, four in a row: elements 3 and 7 are at the grip
    let loose = |model: &Model, gone: &[usize]| Analysis::new(model).unwrap().loose(|element| gone.contains(&element));
    assert_eq!(loose(&model, &[2, 7]), [0; 0], "the grip holds element 3");
    assert_eq!(loose(&model, &[5]), [0; 0], "all others hang together");
    assert_eq!(loose(&model, &[1, 6, 3]), [2], "0, 4 and 5 are the greater piece, the grip holds 7");
    model.supports.retain(|support| support.name != "grip");
    (model.measured.supports, model.drives) = (Vec::new(), Vec::new());
    (model.measured.slip, model.steps, model.controls.spalling) = (Vec::new(), Vec::new(), None);
    assert_eq!(loose(&model, &[2, 7]), [3], "an edge holds it, not a corner");
    assert_eq!(loose(&model, &[2, 3, 5]), [6, 7], "less than 0, 1 and 4");
    assert_eq!(loose(&model, &[1, 5, 6]), [0; 0], "the root holds what is less");
}

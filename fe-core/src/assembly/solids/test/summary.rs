//! Energies, counts, volumes, moduli, and models that cannot be computed.

use super::*;
use approx::assert_relative_eq;
use std::f64::consts::PI;
use umat_abi::metadata::flags;

fn point_count(solids: &Solids) -> usize {
    (0..solids.active().len()).map(|element| solids.point_count(element)).sum()
}

#[test]
fn stored_energy_is_half_of_displacement_times_force() {
    for variant in Variant::ALL {
        for plane_model in PlaneModel::ALL {
            let mesh = patch(variant, plane_model, 0.1, 0.03);
            let displacements = moved(&mesh, |[x, y]| [x + 0.01 * (x * y + y), y + 0.02 * (x * x - y)]);
            let mut solids = Solids::new(&model(mesh, &linear_elastic(), variant.average, false)).unwrap();
            let found = forces(&mut solids, &displacements, Request::Stress);
            solids.commit(&displacements);
            let work: f64 = found.iter().zip(&displacements).map(|(force, u)| 0.5 * force * u).sum();
            let energies = solids.energies();
            assert_relative_eq!(energies.stored, work, max_relative = 1e-12);
            assert_eq!((energies.plastic, energies.damage), (0.0, 0.0));
        }
    }
}

/// The work done on a plastic body is stored or dissipated, better and better with smaller increments.
#[test]
fn work_is_stored_or_dissipated() {
    for (nlgeom, law) in [(false, j2_plasticity()), (true, j2_plasticity())] {
        let mesh = patch(Variant::new(ElementKind::Q8), PlaneModel::PlaneStrain, 0.1, 0.03);
        let mut solids = Solids::new(&model(mesh.clone(), &law, false, nlgeom)).unwrap();
        let at = |share: f64| {
            moved(&mesh, |[x, y]| [x + share * (0.04 * x + 0.1 * x * y), y + share * (0.05 * x - 0.04 * y)])
        };
        let mut before = (at(0.0), vec![0.0; 2 * mesh.nodes().len()]);
        let mut work = 0.0;
        for increment in 1..=100 {
            let now = at(f64::from(increment) / 100.0);
            let found = forces(&mut solids, &now, Request::Stress);
            solids.commit(&now);
            for freedom in 0..now.len() {
                work += 0.5 * (found[freedom] + before.1[freedom]) * (now[freedom] - before.0[freedom]);
            }
            before = (now, found);
        }
        let energies = solids.energies();
        assert!(energies.plastic > 0.1 * energies.stored && energies.damage == 0.0);
        // Cauchy stress works on the present volume, energies are counted per reference volume: it changes by 1 %.
        let tolerance = if nlgeom { 1e-2 } else { 1e-3 };
        assert_relative_eq!(energies.stored + energies.plastic, work, max_relative = tolerance);
        assert_eq!(solids.counts().plastic, point_count(&solids));
    }
}

#[test]
fn what_a_damage_law_dissipates_is_damage() {
    let mesh = patch(Variant::new(ElementKind::T3), PlaneModel::PlaneStress, 0.1, 0.0);
    let mut solids =
        Solids::new(&model(mesh.clone(), &PluginLaw::shipped("concrete_damage", &[]), false, false)).unwrap();
    advance(&mut solids, &moved(&mesh, |[x, y]| [x + 4e-4 * x, y]));
    let (energies, counts) = (solids.energies(), solids.counts());
    assert!(energies.damage > 0.0 && energies.plastic == 0.0);
    assert_eq!((counts, point_count(&solids)), (PointCounts { plastic: 0, damaged: 10 }, 10));
    assert_eq!(solids.part_energies(), [energies]);
}

/// A strip of triangles of two parts in turns, torn: 30 elements of each, in blocks of 16 or in one.
#[test]
fn sums_have_the_same_bits_however_elements_are_divided() {
    let nodes = (0..=30).flat_map(|k| [0.0, 0.13].map(|y| [0.1 * f64::from(k), y])).collect();
    let triangle = |part, nodes: [usize; 3]| ElementDefinition { kind: ElementKind::T3, part, nodes: nodes.into() };
    let starts = (0..60).step_by(2);
    let elements = starts.flat_map(|a| [triangle(0, [a, a + 2, a + 3]), triangle(1, [a, a + 3, a + 1])]).collect();
    let parts = ["lower", "upper"].map(|name| Part::new(name, PlaneModel::PlaneStress, 0.7)).into();
    let mesh = Mesh::new(MeshDefinition { nodes, parts, elements, ..MeshDefinition::default() }).unwrap();
    for (law, scale) in [(PluginLaw::shipped("concrete_damage_implex", &[]), 1.0), (j2_plasticity(), 60.0)] {
        let [divided, whole] = [flags::THREAD_SAFE, 0].map(|flag| {
            let mut model = model(mesh.clone(), &law, false, false);
            for law in model.laws.iter_mut().filter_map(|law| law.plugin.law.as_mut()) {
                law.flags = law.flags & !flags::THREAD_SAFE | flag;
            }
            let mut solids = Solids::new(&model).unwrap();
            let sums = [1e-4, 3e-4, 4e-4, 7e-4, 3e-4].map(|size| {
                let size = scale * size;
                let end = moved(&mesh, |[x, y]| [x + size * x * (0.3 + x + y), y + 0.3 * size * x * y]);
                forces(&mut solids, &end, Request::Stress);
                let trial = (solids.trial_energies(), solids.trial_dissipation());
                solids.commit(&end);
                (trial, solids.part_energies(), solids.accounts(), solids.damaged_volume())
            });
            (solids.blocks.len(), sums)
        });
        assert_eq!([divided.0, whole.0], [4, 2]);
        assert!(divided.1[4].1.iter().all(|energies| energies.damage + energies.plastic > 0.0));
        assert_eq!(divided.1, whole.1, "{}", law.name);
    }
}

#[test]
fn volumes_are_those_of_rings_and_plates() {
    for variant in Variant::ALL {
        for (plane_model, volume) in [
            (PlaneModel::PlaneStress, 0.7 * 0.24 * 0.12),
            (PlaneModel::Axisymmetric, PI * (0.34 * 0.34 - 0.1 * 0.1) * 0.12),
        ] {
            let solids =
                Solids::new(&model(patch(variant, plane_model, 0.1, 0.0), &linear_elastic(), false, false)).unwrap();
            let points = (0..solids.active().len())
                .flat_map(|element| (0..solids.point_count(element)).map(move |point| (element, point)));
            let sum: f64 = points.map(|(element, point)| solids.point(element, point).volume).sum();
            assert_relative_eq!(sum, volume, max_relative = 1e-13);
        }
    }
}

#[test]
fn elastic_moduli_are_youngs() {
    for plane_model in PlaneModel::ALL {
        let mesh = patch(Variant::new(ElementKind::T3), plane_model, 0.1, 0.0);
        let solids = Solids::new(&model(mesh, &linear_elastic(), false, false)).unwrap();
        assert_relative_eq!(solids.elastic_moduli()[0], 1000.0, max_relative = 1e-12);
    }
}

#[test]
fn models_that_cannot_be_computed_are_refused() {
    let mesh = patch(Variant::new(ElementKind::T3), PlaneModel::PlaneStrain, 0.1, 0.0);
    let refused = |model: &Model| Solids::new(model).unwrap_err().to_string();
    let mut fault = model(mesh.clone(), &linear_elastic(), false, false);
    fault.laws.clear();
    assert_eq!(refused(&fault), "the mesh has 1 parts, but 0 laws were given");
    fault = model(mesh.clone(), &linear_elastic(), false, false);
    fault.average_dilatation.push(true);
    assert_eq!(refused(&fault), "the mesh has 1 parts, but 2 choices of average dilatation were given");
    fault = model(mesh.clone(), &PluginLaw::shipped("linear_elastic", &[("nu", 0.7)]), false, false);
    let message = refused(&fault);
    assert!(message.starts_with("part 'body', element ") && message.contains("linear_elastic: nu = 0.7"), "{message}");
    fault.laws[0].plugin.symbol = Some("no_such_symbol".into());
    fault.laws[0].plugin.law = None;
    assert!(refused(&fault).starts_with("part 'body': linear_elastic: "));
    // A plain UMAT of which nothing is known: what it returns is judged.
    fault.laws[0].plugin.symbol = None;
    assert!(refused(&fault).contains("no usable stiffness"), "{}", refused(&fault));
}

#[test]
fn a_law_that_refuses_an_increment_is_trouble_with_its_place() {
    let mesh = patch(Variant::new(ElementKind::Q4), PlaneModel::PlaneStrain, 0.1, 0.0);
    let mut solids = Solids::new(&model(mesh.clone(), &j2_plasticity(), false, false)).unwrap();
    let mut displacements = vec![0.0; 2 * mesh.nodes().len()];
    displacements[4] = f64::NAN;
    let mut forces = vec![0.0; displacements.len()];
    let trouble = solids.evaluate(&displacements, &CONTEXT, Request::Stress, &mut forces).unwrap_err();
    assert!(matches!(trouble.place, Location::Element { element: 1, point: 0, .. }), "{trouble}");
    assert!(trouble.fraction.is_some_and(|fraction| 0.0 < fraction && fraction < 1.0));
}

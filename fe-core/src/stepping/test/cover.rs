//! Blocks with a cover on both faces of their fibre.

use super::pull_out::bond_with;
use super::{Analysis, Keeper, Record, run};
use crate::mesh::specimen::{
    Fibre, FibreMesh, Fibres, FibresMesh, GradedThickness, PerpendicularFibre, Specimen, SurfaceRole, fibres,
    perpendicular_fibre,
};
use crate::mesh::{Mesh, MeshDefinition};
use crate::model::{
    ContactLaw, ContactPair, Controls, Enforcement, Fit, Measured, Model, PluginLaw, Quadrature, Skipping, Step,
    StepControl, Support, Width,
};

fn elastic(modulus: f64, poisson: f64) -> PluginLaw {
    PluginLaw::shipped("linear_elastic", &[("E", modulus), ("nu", poisson)])
}

/// A coarse bent fibre at 45°.
fn specimen(cover: bool, graded_thickness: Option<GradedThickness>) -> Specimen {
    let mesh = FibresMesh { size: 3.0, ..FibresMesh::default() };
    let bent = vec![Fibre::bent(std::f64::consts::FRAC_PI_4, None, 3.0)];
    fibres(&Fibres { fibres: bent, cover, graded_thickness, mesh, ..Fibres::default() }).unwrap()
}

/// A fibre pulled out of a block that is held at its sides; its bond carries up to `tension` across it, MPa.
fn pulled(specimen: Specimen, tension: f64, slip: f64) -> Vec<Record> {
    let sets = &specimen.definition.node_sets;
    let support = |name: &str, nodes: &[usize], direction, drive| Support {
        name: name.into(),
        nodes: nodes.to_vec(),
        direction,
        drive,
    };
    let (grip, sides) = (&sets["grip"], &sets["sides"]);
    let supports = vec![
        support("grip", grip, [0.0, 1.0], Some(0)),
        support("grip across", grip, [1.0, 0.0], None),
        support("sides", sides, [1.0, 0.0], None),
        support("sides along", sides, [0.0, 1.0], None),
    ];
    let bond = |friction_only: bool| {
        let others = if friction_only { [("law", 2.0), ("p_0", 0.0)] } else { [("law", 0.0), ("p_0", tension)] };
        ContactLaw::Uinter(bond_with(&others))
    };
    let mut model = model(specimen.definition.clone(), supports, 1);
    let edges = |name: &str| model.mesh.edge_set(name).unwrap().to_vec();
    let pairs = specimen.contact_pairs.iter().map(|pair| ContactPair {
        name: pair.name.clone(),
        slave: edges(&pair.slave),
        master: edges(&pair.master),
        law: bond(pair.role == SurfaceRole::Exit),
        quadrature: Quadrature::Gauss(2),
        width: pair.width.map_or(Width::OfPart, Width::Given),
        penalty_factor: 100.0,
        // updates that end by a tolerance end elsewhere in the mirror image
        enforcement: Enforcement::Penalty,
        release: true,
        critical_slip: 0.0,
        fit: Fit::default(),
        bearing: None,
        master_bends: true,
    });
    model.contacts = pairs.collect();
    model.nlgeom = model.mesh.parts().iter().map(|part| part.name == "fibre").collect();
    model.measured = Measured {
        slip: vec![0],
        supports: vec![0],
        direction: specimen.pull_direction,
        exit_node: Some(specimen.fibres[0].exit_node),
        tail_node: Some(specimen.fibres[0].tail_node),
        ..Measured::default()
    };
    let control = StepControl::Automatic { initial: 1e-3, maximum: 0.05, minimum: 1e-9 };
    model.steps = vec![Step { time: 1.0, targets: vec![Some(slip)], control }];
    model.controls = Controls { force_tolerance: 1e-9, displacement_tolerance: 1e-9, ..Controls::default() };
    run(&model).0
}

fn peak(records: &[Record]) -> f64 {
    records.iter().map(|record| record.load).fold(0.0, f64::max)
}

/// The mirror image at x = 0: elements go round the other way.
fn mirrored(mut specimen: Specimen) -> Specimen {
    let definition = &mut specimen.definition;
    definition.nodes.iter_mut().for_each(|[x, _]| *x = -*x);
    for element in &mut definition.elements {
        let (corners, middles) = element.nodes.split_at_mut(element.kind.corner_count());
        corners[1..].reverse();
        middles.reverse();
    }
    for edges in definition.edge_sets.values_mut() {
        for edge in edges.iter_mut() {
            edge.edge = definition.elements[edge.element].kind.corner_count() - 1 - edge.edge;
        }
        edges.reverse();
    }
    specimen
}

/// A model in which nothing touches anything.
fn model(definition: MeshDefinition, supports: Vec<Support>, drives: usize) -> Model {
    let mesh = Mesh::new(definition).unwrap();
    let law = |name: &str| if name == "fibre" { elastic(210e3, 0.3) } else { elastic(23.7e3, 0.15) };
    Model {
        fields: crate::model::Fields::default(),
        laws: mesh.parts().iter().map(|part| law(&part.name)).collect(),
        average_dilatation: vec![false; mesh.parts().len()],
        nlgeom: vec![false; mesh.parts().len()],
        contacts: Vec::new(),
        drives: (0..drives).map(|k| format!("drive {k}")).collect(),
        supports,
        couplings: Vec::new(),
        loads: Vec::new(),
        measured: Measured::default(),
        steps: Vec::new(),
        controls: Controls { force_tolerance: 1e-12, displacement_tolerance: 1e-11, ..Controls::default() },
        initial_drives: Vec::new(),
        field: None,
        skipping: Skipping::ALL,
        mesh,
    }
}

/// The block alone, as thick in the cover as next to it. Its outer boundary moves linearly, so without the slot it
/// would strain evenly. It does, so the cover joins the halves and adds nothing else.
#[test]
fn a_block_with_a_cover_strains_as_one_without_a_slot() {
    let mut definition = specimen(true, None).definition;
    let [fibre, matrix, cover] =
        ["fibre", "matrix", "cover"].map(|name| definition.parts.iter().position(|part| part.name == name).unwrap());
    definition.parts[cover].thickness = definition.parts[matrix].thickness;
    let gradient = [[1e-3, -4e-4], [7e-4, 2e-3]];
    let is_outer = |[x, y]: [f64; 2]| x.abs() == 12.7 || y == 0.0 || y == -12.7;
    let of_fibre: std::collections::BTreeSet<usize> = definition
        .elements
        .iter()
        .filter(|element| element.part == fibre)
        .flat_map(|element| element.nodes.clone())
        .collect();
    let (mut supports, mut targets) = (Vec::new(), Vec::new());
    for (node, &[x, y]) in definition.nodes.iter().enumerate() {
        let held = of_fibre.contains(&node);
        if !held && !is_outer([x, y]) {
            continue;
        }
        for (component, direction) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
            let drive = (!held).then(|| {
                targets.push(Some(gradient[component][0] * x + gradient[component][1] * y));
                targets.len() - 1
            });
            supports.push(Support { name: format!("node {node}"), nodes: vec![node], direction, drive });
        }
    }
    let nodes = definition.nodes.clone();
    let mut model = model(definition, supports, targets.len());
    model.steps = vec![Step { time: 1.0, targets, control: StepControl::Fixed { increments: 1 } }];
    let mut analysis = Analysis::new(&model).unwrap();
    let mut keeper = Keeper::default();
    analysis.run(&mut keeper).unwrap();
    let (records, displacements) = (keeper.0, analysis.snapshot().displacements().to_vec());
    for (node, &[x, y]) in nodes.iter().enumerate().filter(|(node, _)| !of_fibre.contains(node)) {
        for (component, row) in gradient.iter().enumerate() {
            let expected = row[0] * x + row[1] * y;
            let found = displacements[2 * node + component];
            assert!((found - expected).abs() < 1e-12, "({x}, {y}): {found} instead of {expected}");
        }
    }
    // σ : ε over the volume of the block without a slot
    let [e_11, e_22, g_12] = [gradient[0][0], gradient[1][1], gradient[0][1] + gradient[1][0]];
    let (modulus, poisson) = (23.7e3, 0.15);
    let shear = modulus / (2.0 * (1.0 + poisson));
    let lame = modulus * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let density = 0.5 * lame * (e_11 + e_22).powi(2) + shear * (e_11 * e_11 + e_22 * e_22 + 0.5 * g_12 * g_12);
    let expected = density * 25.4 * 12.7 * 3.26;
    let found = records.last().unwrap().energies.elastic;
    assert!((found / expected - 1.0).abs() < 1e-10, "{found} instead of {expected}");
}

#[test]
fn the_mirror_image_has_the_mirrored_load() {
    let graded = GradedThickness { slope: 1.0, extent: None };
    let this = pulled(specimen(true, Some(graded)), 3.0, 0.1);
    let other = pulled(mirrored(specimen(true, Some(graded))), 3.0, 0.1);
    assert_eq!(this.len(), other.len());
    let scale = peak(&this);
    assert!(scale > 10.0, "{scale} N");
    for (a, b) in this.iter().zip(&other) {
        assert!((a.load - b.load).abs() < 1e-8 * scale, "{} and {}", a.load, b.load);
        assert!((a.load_lateral + b.load_lateral).abs() < 1e-8 * scale, "{} and {}", a.load_lateral, b.load_lateral);
    }
}

/// Along the normal nothing presses the fibre to either side, so its cover changes nothing.
#[test]
fn a_perpendicular_fibre_does_not_feel_its_cover() {
    let specimen = |cover: bool| {
        let mesh = FibreMesh { embedded_elements: 12, exit_size: None, interface_size: 0.4, ..FibreMesh::default() };
        perpendicular_fibre(&PerpendicularFibre { cover, mesh, ..PerpendicularFibre::default() }).unwrap()
    };
    let without = peak(&pulled(specimen(false), 1000.0, 0.06));
    let with = peak(&pulled(specimen(true), 1000.0, 0.06));
    assert!((with / without - 1.0).abs() < 5e-3, "{with} N instead of {without} N");
}

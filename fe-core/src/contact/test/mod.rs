//! Scenes of two blocks, one on the other, that the tests share.

mod bearing;
mod enforcement;
mod kinematics;
mod quadrature;
mod sliding;
mod tangent;

use super::{Contact, PointStatus};
use crate::element::ElementKind;
use crate::kinematics::PlaneModel;
use crate::mesh::{ElementDefinition, ElementEdge, Mesh, MeshDefinition, Part};
use crate::model::{
    ContactLaw, ContactPair, Enforcement, FieldValues, Fit, HardLaw, IncrementContext, NormalLaw, PluginLaw,
    Quadrature, SoftLaw, Width,
};
use crate::solver::Blocks;
use end_to_end_tests::Random;
use std::collections::HashMap;
use umat_abi::law::Request;

/// One row of elements on one side of y = curve(x).
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub kind: ElementKind,
    pub from: f64,
    pub to: f64,
    pub count: usize,
}

/// Part 0 below the curve, whose upper edges are the master; part 1 above it, whose lower edges are the slave.
pub(super) struct Scene {
    pub mesh: Mesh,
    pub master: Vec<ElementEdge>,
    pub slave: Vec<ElementEdge>,
}

const HEIGHT: f64 = 1.0;

impl Scene {
    pub fn new(master: Row, slave: Row, curve: fn(f64) -> f64, model: PlaneModel) -> Self {
        let mut definition = MeshDefinition {
            parts: vec![Part::new("fibre", model, 0.7), Part::new("matrix", model, 0.9)],
            ..MeshDefinition::default()
        };
        add_row(&mut definition, master, 0, curve, -HEIGHT);
        add_row(&mut definition, slave, 1, curve, 0.0);
        let mesh = Mesh::new(definition).unwrap();
        let edges = |from: usize, count: usize, edge: usize| {
            (from..from + count).map(|element| ElementEdge { element, edge }).collect()
        };
        Self { mesh, master: edges(0, master.count, 2), slave: edges(master.count, slave.count, 0) }
    }

    /// Straight, 4 master and 3 slave edges on 0 … 4 and 0.5 … 3.1.
    pub fn straight(kind: ElementKind) -> Self {
        Self::rows(kind, |_| 0.0, PlaneModel::PlaneStrain)
    }

    pub fn rows(kind: ElementKind, curve: fn(f64) -> f64, model: PlaneModel) -> Self {
        let master = Row { kind, from: 1.0, to: 5.0, count: 4 };
        let slave = Row { kind, from: 1.5, to: 4.1, count: 3 };
        Self::new(master, slave, curve, model)
    }

    pub fn pair(&self, law: ContactLaw) -> ContactPair {
        ContactPair {
            name: "fibre".into(),
            slave: self.slave.clone(),
            master: self.master.clone(),
            law,
            quadrature: Quadrature::Gauss(2),
            width: Width::Given(30.0),
            penalty_factor: 100.0,
            enforcement: Enforcement::Penalty,
            release: false,
            critical_slip: 0.0,
            fit: Fit::default(),
            bearing: None,
            master_bends: false,
        }
    }

    /// A modulus of which the penalty comes out near 200 MPa/mm: with it the geometric terms of a tangent count.
    pub fn contact(&self, pair: ContactPair) -> Contact {
        Contact::new(&self.mesh, &[pair], &[86.0, 86.0], true, &FieldValues::default()).unwrap()
    }

    pub fn freedom_count(&self) -> usize {
        2 * self.mesh.nodes().len()
    }

    /// Displacements of one part's nodes.
    pub fn moved(&self, part: usize, movement: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
        let mut displacements = vec![0.0; self.freedom_count()];
        for element in self.mesh.elements().iter().filter(|element| element.part() == part) {
            for &node in element.nodes() {
                displacements[2 * node..2 * node + 2].copy_from_slice(&movement(self.mesh.nodes()[node]));
            }
        }
        displacements
    }

    /// The slave moved as a rigid body, everything shaken a little.
    pub fn shaken(&self, movement: [f64; 2], amplitude: f64) -> Vec<f64> {
        let mut random = Random::new(7);
        self.moved(1, |_| movement).iter().map(|u| u + amplitude * random.signed()).collect()
    }
}

fn add_row(definition: &mut MeshDefinition, row: Row, part: usize, curve: fn(f64) -> f64, below: f64) {
    let mut places = HashMap::new();
    let step = (row.to - row.from) / row.count as f64;
    for element in 0..row.count {
        let corners = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1]];
        let nodes = corners.iter().take(row.kind.node_count()).map(|&[i, j]| {
            *places.entry((2 * element + i, j)).or_insert_with(|| {
                let x = row.from + 0.5 * step * (2 * element + i) as f64;
                definition.nodes.push([x, curve(x) + below + 0.5 * HEIGHT * j as f64]);
                definition.nodes.len() - 1
            })
        });
        let nodes = nodes.collect();
        definition.elements.push(ElementDefinition { kind: row.kind, part, nodes });
    }
}

pub(super) fn context() -> IncrementContext {
    IncrementContext { step: 1, increment: 1, iteration: 1, step_time: 0.0, total_time: 0.0, time_increment: 1.0 }
}

/// Forces at displacements, and the dense stiffness by rows.
pub(super) fn forces(contact: &mut Contact, displacements: &[f64]) -> Vec<f64> {
    let mut forces = vec![0.0; displacements.len()];
    let mut blocks = Blocks::default();
    contact.evaluate(displacements, &context(), Request::Stress, &mut forces, &mut blocks).unwrap();
    assert!(blocks.is_empty());
    forces
}

pub(super) fn stiffness(contact: &mut Contact, displacements: &[f64]) -> Vec<Vec<f64>> {
    let count = displacements.len();
    let mut blocks = Blocks::default();
    let mut forces = vec![0.0; count];
    contact.evaluate(displacements, &context(), Request::StressAndTangent, &mut forces, &mut blocks).unwrap();
    let mut stiffness = vec![vec![0.0; count]; count];
    for (rows, values) in blocks.iter() {
        for (i, row) in rows.iter().enumerate() {
            for (j, column) in rows.iter().enumerate() {
                stiffness[*row][*column] += values[i * rows.len() + j];
            }
        }
    }
    stiffness
}

/// The bond with a g_crit of 0.023 mm and a g_peak of 0.18 mm; hard normal law, its penalty left to the host.
pub(super) fn bond(given: &[(&str, f64)]) -> PluginLaw {
    let usual = [("normal_law", 0.0), ("p_0", 1000.0), ("k_e", 50.0), ("k_u", 30.0), ("mu", 0.0), ("tau_res", 0.1)];
    let given: Vec<_> = usual.iter().chain(given).copied().collect();
    PluginLaw::shipped("bond_slip", &given)
}

pub(super) fn uinter(given: &[(&str, f64)]) -> ContactLaw {
    ContactLaw::Uinter(bond(given))
}

pub(super) fn hard(p_0: f64, delta_n: f64, given: &[(&str, f64)]) -> ContactLaw {
    ContactLaw::Fric { law: bond(given), normal: NormalLaw::Hard(HardLaw { p_0, delta_n }) }
}

pub(super) fn soft(given: &[(&str, f64)]) -> ContactLaw {
    ContactLaw::Fric { law: bond(given), normal: NormalLaw::Soft(SoftLaw { p_0: 2.0, g_0: 0.1 }) }
}

pub(super) fn parabola(x: f64) -> f64 {
    0.06 * (x - 2.5) * (x - 2.5)
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

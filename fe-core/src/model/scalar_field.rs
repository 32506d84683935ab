//! One scalar per node: temperature, or the phase field of a law.

use crate::mesh::ElementEdge;
use crate::schema::positive;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A value that nodes of the field have.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedValue {
    /// Nodes.
    pub nodes: Vec<usize>,
    /// The value, or at a drive of 1.
    pub value: f64,
    /// The drive that multiplies it; `None`: it is constant.
    pub drive: Option<usize>,
}

impl FixedValue {
    /// Sets the value at its nodes, of values at all nodes of the mesh.
    pub(crate) fn set(&self, drives: &[f64], values: &mut [f64]) {
        let value = self.value * self.drive.map_or(1.0, |drive| drives[drive]);
        self.nodes.iter().for_each(|&node| values[node] = value);
    }
}

/// A flux into the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Flux {
    /// Edges.
    pub edges: Vec<ElementEdge>,
    /// Flux per reference area, or at a drive of 1.
    pub flux: f64,
    /// The drive that multiplies it; `None`: it is constant.
    pub drive: Option<usize>,
}

/// Meaning of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldKind {
    /// Heat, which is energy, or whatever is no crack: the energies of the laws are not compared with the work of the drives.
    Temperature,
    /// The phase field of a law, from 0 to 1, without a scale of energy; with the fracture energy and the length l of its cracks, if known.
    PhaseField(Option<CrackSurface>),
}

/// Energy and length of the cracks of a phase field.
// ∫ (α/l + l |∇d|²)/π dV with α = 2d − d²
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CrackSurface {
    /// Fracture energy, N/mm.
    #[serde(rename = "G_f")]
    #[schemars(schema_with = "positive")]
    pub fracture_energy: f64,
    /// Length of the phase field, mm.
    #[serde(rename = "l")]
    #[schemars(schema_with = "positive")]
    pub length: f64,
}

/// How displacements and field are solved in an increment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FieldCoupling {
    /// In turn until neither changes.
    #[default]
    Staggered,
    /// Once each: displacements with the extrapolated field, then the field. Faster; take increments half as large.
    OnePass,
    /// Together, by Newton's method: forces follow the field by DDSDDT, its sources the strains by DRPLDE.
    Full,
}

/// UMATHT of the laws' libraries, which takes the place of conductivity and capacity where a library has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeatTransfer {
    /// PROPS.
    pub props: Vec<f64>,
    /// ρ, by which U counts; 0: steady.
    pub density: f64,
}

/// A field θ on all nodes of some parts: c ∂θ/∂t = k ∇²θ + r, r being RPL of the laws, which are given θ as temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalarField {
    /// Meaning.
    pub kind: FieldKind,
    /// Whether each part has it.
    pub parts: Vec<bool>,
    /// k.
    pub conductivity: f64,
    /// c, per volume; 0: steady.
    pub capacity: f64,
    /// θ at the start.
    pub initial: f64,
    /// Whether HETVAL of the laws' libraries adds to RPL and DRPLDT.
    pub has_generation: bool,
    /// UMATHT, if it is called.
    pub transfer: Option<HeatTransfer>,
    /// Values that nodes have.
    pub fixed: Vec<FixedValue>,
    /// Fluxes into the body.
    pub fluxes: Vec<Flux>,
    /// How it is solved.
    pub coupling: FieldCoupling,
    /// Largest change of θ in the last pass of an increment; of a temperature, as a part of its largest magnitude.
    pub tolerance: f64,
}

impl ScalarField {
    /// A steady field of conductivity 1 on all of `parts` parts.
    pub fn new(kind: FieldKind, parts: usize) -> Self {
        let tolerance = if kind == FieldKind::Temperature { 1e-9 } else { 3e-4 };
        Self {
            kind,
            parts: vec![true; parts],
            conductivity: 1.0,
            capacity: 0.0,
            initial: 0.0,
            has_generation: false,
            transfer: None,
            fixed: Vec::new(),
            fluxes: Vec::new(),
            coupling: FieldCoupling::default(),
            tolerance,
        }
    }

    /// Name in files.
    pub fn name(&self) -> &'static str {
        if self.is_phase_field() { "phase_field" } else { "temperature" }
    }

    /// Returns whether it may lead an increment: cracks that grow, of which no value follows a drive.
    pub(crate) fn may_lead(&self) -> bool {
        self.is_phase_field()
            && self.coupling == FieldCoupling::Staggered
            && self.fixed.iter().all(|fixed| fixed.drive.is_none())
            && self.fluxes.iter().all(|flux| flux.drive.is_none())
    }

    /// Returns whether it is no energy.
    pub fn is_phase_field(&self) -> bool {
        self.kind != FieldKind::Temperature
    }
}

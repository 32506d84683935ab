//! A scalar per node.

use super::super::Positive;
use fe_core::model::{CrackSurface, FieldCoupling};
use schemars::JsonSchema;
use serde::Deserialize;

/// A scalar θ at every node, which the laws get as temperature: c ∂θ/∂t = k ∇²θ + RPL. Displacements and θ are found in turn by default.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ScalarField {
    /// Meaning of the scalar.
    pub kind: FieldKind,
    /// Names of the parts that have it (default: all; of a phase field in a specimen, the matrix). A cover has it with the matrix.
    pub parts: Option<Vec<String>>,
    /// Conductivity k (default 1).
    pub conductivity: Option<Positive>,
    /// Capacity c per volume; without one the field is steady.
    pub capacity: Option<Positive>,
    /// Value at the start (default 0), at which an expansion gives no thermal strain.
    pub initial: Option<f64>,
    /// Routines that are called in addition to UMAT. HETVAL adds FLUX(1) to RPL and FLUX(2) to DRPLDT; UMATHT replaces
    /// conductivity and capacity (default: those that the libraries of its parts have).
    pub routines: Option<Vec<HeatRoutine>>,
    /// Parameters and density that UMATHT gets, the same for all parts.
    pub umatht: Option<Umatht>,
    /// Values that node sets are kept at from the first increment on. A steady temperature needs one in each body.
    pub fixed: Option<Vec<FixedValue>>,
    /// Fluxes into the body through edge sets.
    pub fluxes: Option<Vec<Flux>>,
    /// How an increment is solved (default "staggered").
    pub coupling: Option<FieldCoupling>,
    /// Largest change of θ in the last pass of an increment. Default for a phase field: 3e-4. Default for a temperature:
    /// 1e-9 of its largest magnitude. The last correction must also leave all forces as they were, to 3e-3 of the force
    /// scale.
    pub tolerance: Option<Positive>,
    /// Fracture energy and length of the cracks of a phase field, for the column field_energy; default: the parameters G_f and l of the
    /// law, if it has them.
    pub crack: Option<CrackSurface>,
}

/// Meaning of a scalar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FieldKind {
    /// Heat: RPL is an energy.
    Temperature,
    /// Damage from 0 to 1: RPL has no scale, the energies of the laws must balance the work.
    PhaseField,
}

/// A routine of heat in the library of a UMAT.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum HeatRoutine {
    /// Heat that is generated.
    Hetval,
    /// Heat that is stored and conducted.
    Umatht,
}

/// What UMATHT is given.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Umatht {
    /// Its PROPS (default: none).
    pub props: Option<Vec<f64>>,
    /// Density, by which U counts; without one the field is steady.
    pub density: Option<Positive>,
}

/// A value that nodes are kept at.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FixedValue {
    /// Node set.
    pub nodes: String,
    /// Value, or the value at a drive of 1.
    pub value: f64,
    /// Drive that multiplies it (default: it is constant).
    pub drive: Option<String>,
}

/// A flux into the body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Flux {
    /// Edge set.
    pub edges: String,
    /// Flux per area, or the flux at a drive of 1.
    pub flux: f64,
    /// Drive that multiplies it (default: it is constant).
    pub drive: Option<String>,
}

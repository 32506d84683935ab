//! Kind "bridging".

use super::{CommonCaseEntries, ConcreteStrength, Material, Plots, Positive, Whole, WithDefaults};
use pullout_bridging::{BondLaw, Closed, Fibre, Inclination, NotchedBeam, Orientation, Scatter, Sides, Softening};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use std::borrow::Cow;

/// Fibres across a crack: from one fibre to σ(w), the notched beam and its scatter (kind "bridging").
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct BridgingCase {
    /// "bridging".
    #[expect(dead_code, reason = "dispatched on before")]
    #[schemars(extend("const" = "bridging"))]
    pub kind: String,
    /// Title, text, files, curves.
    #[serde(flatten)]
    pub head: CommonCaseEntries,
    /// The fibre, and the source of its load.
    pub fibre: FibreOfFile,
    /// V_f, at most 0.2.
    pub volume_fraction: Positive,
    /// The matrix, by its numbers or by the class of its concrete.
    pub matrix: MatrixOfFile,
    /// η_E, the matrix's part in the stretch of the fibre (default E V_f/(E_m (1 − V_f)); 0: a stiff matrix).
    #[schemars(range(min = 0.0))]
    pub modular_ratio: Option<f64>,
    /// Orientation of the fibres (default random_3d).
    pub orientation: Option<Orientation>,
    /// Sides of the crack from which fibres pull out (default two).
    pub sides: Option<Sides>,
    /// w_a, the opening at which fibres begin to carry (default 0).
    #[schemars(range(min = 0.0))]
    pub activation: Option<f64>,
    /// Openings at which σ(w) is written. Strengths of beams do not depend on them. Work and peaks depend on the last alone.
    pub openings: Option<Openings>,
    /// A notched beam in three-point bending (`{}`: that of EN 14651; default: none).
    pub beam: Option<NotchedBeam>,
    /// Beams with randomly placed fibres (default: none). Needs `beam`.
    pub scatter: Option<Scatter>,
    /// Settings of the output.
    pub output: Option<BridgingOutput>,
}

/// The matrix of the composite.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MatrixOfFile {
    /// Concrete by its class ("C40", "C40/50") or its mean compressive strength, MPa: by the fib Model Code 2010 it gives the
    /// other numbers that are left out, and the softening "bilinear".
    pub concrete: Option<ConcreteStrength>,
    /// Young's modulus, MPa; required without `concrete`.
    #[serde(rename = "E")]
    pub modulus: Option<f64>,
    /// Tensile strength, MPa; required without `concrete`.
    pub ft: Option<f64>,
    /// Softening beyond the tensile strength (default none).
    pub softening: Option<Softening>,
    /// Fracture energy, N/mm.
    #[serde(rename = "Gf")]
    pub fracture_energy: Option<f64>,
    /// Compressive strength of a beam, MPa (default: compression stays elastic).
    pub fc: Option<f64>,
}

/// Settings of the output.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BridgingOutput {
    /// Draw plots (default true), or draw them with these titles and legends.
    pub plots: Option<Plots>,
    /// Write σ(w) as `*CONCRETE TENSION STIFFENING, TYPE=DISPLACEMENT` of ABAQUS's concrete damaged plasticity, abaqus.inp
    /// (default false).
    pub abaqus: Option<bool>,
    /// Width h of the elements that a crack localises in, mm. If given, σ is written over the crack strain w/h and over
    /// the strain w/h + σ/E, crack_band.csv, for programs with smeared cracks (default none).
    pub crack_band: Option<Positive>,
}

/// Openings at which σ is evaluated.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Openings {
    /// The last opening, mm (default 3.5).
    pub to: Option<Positive>,
    /// Number of openings, the first at 0 (default 200).
    pub points: Option<Whole<3, 10_000>>,
    /// Spacing of the openings (default power2).
    pub spacing: Option<Spacing>,
}

/// Spacing of the openings.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Spacing {
    /// With the square of their number: close at the beginning.
    #[default]
    Power2,
    /// At equal distances.
    Even,
}

/// A straight round fibre, and the model that gives its load.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(tag = "model", rename_all = "snake_case")]
pub(crate) enum FibreOfFile {
    /// Closed form with constant friction, debonding, slip hardening, inclination and rupture.
    Closed(ClosedFibre),
    /// A bond law τ(s) along an elastic fibre.
    ShearLag(ShearLagFibre),
    /// Measured curves.
    Table(TableFibre),
    /// Curves computed with a specimen that has one fibre.
    Fe(FeFibre),
}

/// A bond law: points, or a plugin with its parameters.
#[derive(Clone, Debug, Deserialize)]
#[serde(transparent)]
pub(crate) struct LawOfFile(pub serde_json::Value);

impl JsonSchema for LawOfFile {
    fn schema_name() -> Cow<'static, str> {
        "BondLawOfFile".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let [points, law] = [generator.subschema_for::<BondLaw>(), generator.subschema_for::<Material>()];
        json_schema!({ "anyOf": [points, law] })
    }
}

/// A fibre with constant friction.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct ClosedFibre {
    /// The fibre.
    #[serde(flatten)]
    pub fibre: WithDefaults<Fibre>,
    /// Its bond.
    #[serde(flatten)]
    pub bond: WithDefaults<Closed>,
    /// Effect of the inclination angle (default exp with f = 0.35).
    pub inclination: Option<Inclination>,
}

/// A fibre with a bond law.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct ShearLagFibre {
    /// The fibre.
    #[serde(flatten)]
    pub fibre: WithDefaults<Fibre>,
    /// τ(s): points [slip, traction], constant after the last; or a law in the form of contact.law, evaluated
    /// without pressure.
    pub law: LawOfFile,
    /// Effect of the inclination angle (default exp with f = 0.35).
    pub inclination: Option<Inclination>,
}

/// A fibre whose curves were measured.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct TableFibre {
    /// The fibre.
    #[serde(flatten)]
    pub fibre: WithDefaults<Fibre>,
    /// CSV file, relative to the case file, with the columns theta_deg, embedded, slip and load. Each pair of angle
    /// and embedded length has a curve with rising slip. The load acts along the crack normal.
    #[schemars(length(min = 1))]
    pub file: String,
    /// Angle, degrees, above which fibres carry nothing (default 80, or the largest angle of the curves if that is
    /// more; with inclination 90). Between the largest angle of the curves and this one, the load is that at the
    /// largest angle.
    pub cut_deg: Option<f64>,
    /// Effect of the inclination angle, of curves at 0° alone (default: the load is the same at all angles).
    pub inclination: Option<Inclination>,
    /// Factor on all loads, which `fit beam` seeks (default 1).
    pub scale: Option<Positive>,
}

/// A fibre whose curves are runs of a specimen, kept for later use.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct FeFibre {
    /// The fibre.
    #[serde(flatten)]
    pub fibre: WithDefaults<Fibre>,
    /// Case of kind "pullout" with this one fibre, relative to this file.
    #[schemars(length(min = 1))]
    pub base: String,
    /// Entries of the base to set in all runs, by dotted path.
    pub set: Option<serde_json::Map<String, serde_json::Value>>,
    /// Angles, degrees (default 0, 15, 30, 45, 60, 75).
    pub angles_deg: Option<Vec<f64>>,
    /// Embedded lengths as fractions of half the fibre's length; the last is 1 (default 0.125, 0.25, 0.5, 0.75, 1).
    pub lengths: Option<Vec<f64>>,
    /// Entry of the base that sets the angle (default mesh.specimen.angle_deg, of a fibre with a path
    /// mesh.specimen.fibres.0.rotate_deg; a specimen without one is at 0°).
    pub angle_key: Option<String>,
    /// Entry of the base that sets the embedded length (default mesh.specimen.embedded_length, of a fibre with a path
    /// mesh.specimen.fibres.0.embedded).
    pub length_key: Option<String>,
    /// Angle, degrees, above which fibres carry nothing (default 80, or the largest angle of the runs if that is
    /// more). Between the largest angle of the runs and this one, the load is that at the largest angle.
    pub cut_deg: Option<f64>,
    /// Folder that keeps the runs, relative to the current folder (default out/fibres).
    pub cache: Option<String>,
}

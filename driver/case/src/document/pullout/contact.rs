//! Contact pairs.

use super::super::{Material, Piece, Positive, PropValue, Whole};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// One object for all pairs of the specimen, or pair by pair.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Contact {
    /// One contact for all pairs of the specimen.
    All(Box<Pair>),
    /// Pair by pair.
    Pairs(Vec<Piece<Pair>>),
}

/// Two surfaces that touch. Where both are pieces of one curve, the gaps that their edges make of it are no gaps; all others, and those of straight surfaces, are kept, and an overlap at the start is refused.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// Name in messages; one of the specimen's pairs takes its surfaces and width from the specimen.
    pub name: Option<String>,
    /// Edge set that carries the contact points: the hole.
    pub slave: Option<String>,
    /// Edge set that they slide on: the fibre.
    pub master: Option<String>,
    /// The plugin of the contact law; its entry is uinter (default) or fric.
    pub law: Piece<Material>,
    /// Parameters in place of the law's where a hole's rounded edges at the exit may come to touch the fibre (default: no
    /// bond, "law": "none" of bond_slip).
    pub exit: Option<Piece<OtherProps>>,
    /// Parameters in place of the law's between the end of a fibre and that of its hole, for fibres that are pushed in:
    /// {"law": "none", "p_0": 0} of bond_slip bears pressure alone (default: no contact there).
    pub end: Option<Piece<OtherProps>>,
    /// Parameters in place of the law's along the separation length (default: tensile capacity "p_0": 2 of bond_slip).
    pub separation: Option<Piece<OtherProps>>,
    /// The host's normal law beside a FRIC plugin, also where the law's parameters have one (normal_law and p_0 of
    /// bond_slip).
    pub normal: Option<Piece<Normal>>,
    /// Position of the contact points (default 2 Gauss points on each slave edge).
    pub quadrature: Option<Piece<Quadrature>>,
    /// Contact area per length of the slave edge: mm, or "part" for the thickness of the slave's part; default: the
    /// specimen's, else "part".
    pub width: Option<Piece<Width>>,
    /// Factor on min(E t/h of either body)/width of the hard normal law's penalty (default 100; 1, with the enforcement "penalty", where
    /// `bearing` crushes the concrete and the case gives neither). From 1e5 on the rounding
    /// of positions can show in the pressure.
    pub penalty_factor: Option<Piece<Positive>>,
    /// What the concrete under a round fibre bears sideways, in plane specimens: "crushing", at most 5.07 f_c on the diameter (the dowel
    /// formula of Model Code 1990), a number in place of 5.07, or "rigid": any pressure. f_c is that of the matrix's law in uniaxial
    /// compression (default "crushing" for fibres with a hooked path, where that law has a strength, else "rigid").
    pub bearing: Option<Piece<Bearing>>,
    /// Enforcement of the hard normal law (default uzawa).
    pub enforcement: Option<Piece<Enforcement>>,
    /// Slip up to which the bond is elastic, mm: limits increments until the load has peaked (default: the law is asked).
    pub critical_slip: Option<Piece<Positive>>,
    /// Gaps and overlaps that the mesh has at the start: "keep" (default) keeps them, and refuses overlaps; "close" measures them as 0, so
    /// that they neither press nor part; { "close": mm } does so up to that size.
    pub initial_gap: Option<Piece<InitialGap>>,
    /// Overlap that presses the surfaces apart, ramped by a drive: a shaft shrunk into its sleeve.
    pub interference: Option<Piece<Interference>>,
    /// Whether the master has ends (default true): contact fades as a point passes one, and comes back with the point, with its friction
    /// and pressure but without bond. A point may start past an end. With false the master goes on along the tangent of its end,
    /// without end: what has passed it still presses and slides on nothing.
    pub release: Option<Piece<bool>>,
}

/// Treatment of the gaps and overlaps of the mesh.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum InitialGap {
    /// All or none.
    Word(InitialGapWord),
    /// Up to a size.
    Within(InitialGapWithin),
}

/// Whether gaps and overlaps of the mesh are measured.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum InitialGapWord {
    /// They are measured; overlaps are refused.
    Keep,
    /// They are measured as 0.
    Close,
}

/// Gaps and overlaps that are measured as 0.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InitialGapWithin {
    /// The greatest of them, mm.
    pub close: Positive,
}

/// Overlap that presses surfaces apart.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Interference {
    /// The drive that multiplies it.
    pub drive: String,
    /// Overlap at a drive of 1, mm, the same everywhere; default: that of the mesh at each point, which presses nothing at a drive of 0.
    pub depth: Option<Positive>,
}

/// Parameters of the pair's law by name; those not named are the law's own.
pub type OtherProps = BTreeMap<String, PropValue>;

/// The host's normal law.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Normal {
    /// Penalty, bilateral up to a tension.
    Hard(Hard),
    /// Soft exponential.
    Soft(Soft),
}

/// Penalty, bilateral up to a tension.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hard {
    /// Tension that opens a point for good, MPa (default 0: unilateral).
    #[schemars(range(min = 0.0))]
    pub p_0: Option<f64>,
    /// Opening over which the tension falls to 0, mm (default 0: at once).
    #[serde(rename = "delta_N")]
    #[schemars(range(min = 0.0))]
    pub delta_n: Option<f64>,
}

/// Soft exponential.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Soft {
    /// Pressure at gap 0, MPa.
    pub p_0: Positive,
    /// Gap at which the pressure is 0, mm.
    pub g_0: Positive,
}

/// Number of points.
pub type Points = Whole<1, 10>;

/// Position of the contact points.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quadrature {
    /// The slave nodes.
    Nodes,
    /// Number of Gauss points on each slave edge.
    Gauss(Points),
    /// Number of Gauss points on each segment between slave nodes and projected master nodes.
    Segments(Points),
}

/// Contact area per length of the slave edge.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Width {
    /// mm.
    Given(Positive),
    /// "part".
    Part(PartWord),
}

/// What the concrete under a wire bears.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Bearing {
    /// The greatest pressure on the diameter over f_c.
    Factor(Positive),
    /// "crushing" or "rigid".
    Word(BearingWord),
}

/// Whether the concrete under a wire is crushed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum BearingWord {
    /// It is.
    Crushing,
    /// It bears any pressure.
    Rigid,
}

/// The word "part".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PartWord {
    /// The thickness of the slave's part; 2πr in axial symmetry.
    Part,
}

/// Enforcement of the hard normal law.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Enforcement {
    /// The penalty alone.
    Penalty,
    /// Penalty with updates of the multiplier.
    Uzawa(Uzawa),
    /// In one loop, the multiplier condensed locally: 10 to 300 times slower than updates where points open and close, and from ratios of
    /// 30 000 on often without an end. For comparisons.
    PerturbedLagrangian(Perturbed),
}

/// Penalty with updates of the multiplier.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Uzawa {
    /// Greatest gap or penetration of a closed point, mm (default 1e-6).
    pub tolerance: Option<Positive>,
    /// Most updates in an increment (default 4).
    pub max_updates: Option<Whole<1, 100>>,
}

/// The multiplier condensed locally.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Perturbed {
    /// Stiffness of the multiplier over the penalty (default 1e4).
    #[schemars(range(min = 1e4))]
    pub ratio: Option<f64>,
}

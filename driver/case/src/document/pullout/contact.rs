//! Contact pairs.

use super::super::{Material, Positive, PropValue, WithDefaults};
use fe_core::model::{Enforcement, NormalLaw, Quadrature};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// One object for all pairs of the specimen, or pair by pair.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Contact {
    /// One contact for all pairs of the specimen.
    All(Box<Pair>),
    /// Pair by pair.
    Pairs(Vec<Pair>),
}

/// Two surfaces that touch. If both follow the same curve, gaps due to their straight edges are ignored. All other gaps
/// are kept, and an initial overlap is refused.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Pair {
    /// Name for messages. With the name of one of the specimen's pairs, surfaces and width come from the specimen.
    pub name: Option<String>,
    /// Edge set that carries the contact points: the hole.
    pub slave: Option<String>,
    /// Edge set that the contact points slide on: the fibre.
    pub master: Option<String>,
    /// The plugin of the contact law; its entry is uinter (default) or fric.
    pub law: Material,
    /// Parameters that replace those of the law at the rounded edges of the exit, which may come to touch the fibre
    /// (default: no bond, "law": "none" of bond_slip).
    pub exit: Option<OtherProps>,
    /// Parameters that replace those of the law between the end of a fibre and the end of its hole, for fibres that are
    /// pushed in (default: no contact there). With bond_slip, {"law": "none", "p_0": 0} carries only pressure.
    pub end: Option<OtherProps>,
    /// Parameters that replace those of the law along the separation length (default: tensile capacity "p_0": 2 of
    /// bond_slip).
    pub separation: Option<OtherProps>,
    /// Normal law that pullout uses with a FRIC plugin, even if the law has parameters for one (normal_law and p_0 of
    /// bond_slip).
    pub normal: Option<NormalLaw>,
    /// Position of the contact points (default 2 Gauss points on each slave edge).
    pub quadrature: Option<WithDefaults<Quadrature>>,
    /// Contact area per length of the slave edge: mm, or "part" for the thickness of the slave's part; default: the
    /// specimen's, else "part".
    pub width: Option<Width>,
    /// Factor on min(E t/h of either body)/width of the hard normal law's penalty (default 100; 1, with the enforcement
    /// "penalty", where `bearing` crushes the concrete and the case gives neither). From 1e5 on the rounding of positions
    /// can show in the pressure.
    pub penalty_factor: Option<Positive>,
    /// Sideways pressure that the concrete under a round fibre can carry, in plane specimens. "crushing": at most 5.07
    /// f_c on the diameter (the dowel formula of Model Code 1990); a number replaces 5.07; "rigid": any pressure. f_c
    /// is the uniaxial compressive strength of the matrix's law (default "crushing" for fibres with a hooked path, if
    /// that law has a strength, else "rigid").
    pub bearing: Option<Bearing>,
    /// Enforcement of the hard normal law (default uzawa).
    pub enforcement: Option<WithDefaults<Enforcement>>,
    /// Slip, mm, up to which the bond is elastic. It limits increments until the load has peaked (default: from the
    /// law).
    pub critical_slip: Option<Positive>,
    /// Treatment of initial gaps and overlaps of the mesh. "keep" (default) keeps gaps and refuses overlaps; "close"
    /// counts both as 0; { "close": mm } counts those up to this size as 0.
    pub initial_gap: Option<InitialGap>,
    /// Interference fit, ramped by a drive, such as a shaft shrunk into a sleeve.
    pub interference: Option<Interference>,
    /// Whether contact ends at the ends of the master (default true). It fades as a point passes an end. If the point
    /// comes back, friction and pressure return, but not the bond. A point may start beyond an end. With false, the
    /// master continues for ever along its end tangent, and points beyond the end still press and slide.
    pub release: Option<bool>,
}

/// Treatment of the gaps and overlaps of the mesh.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum InitialGap {
    /// All of them.
    Word(InitialGapWord),
    /// Up to a size.
    Within(InitialGapWithin),
}

/// Treatment of all initial gaps and overlaps.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum InitialGapWord {
    /// Gaps are kept; overlaps are refused.
    Keep,
    /// Gaps and overlaps count as 0.
    Close,
}

/// Gaps and overlaps up to a size count as 0.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct InitialGapWithin {
    /// Largest gap or overlap, mm, that counts as 0.
    pub close: Positive,
}

/// Interference fit.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Interference {
    /// Drive that multiplies the overlap.
    pub drive: String,
    /// Overlap at a drive of 1, mm, the same everywhere. Default: the overlap of the mesh at each point, which causes
    /// no pressure at a drive of 0.
    pub depth: Option<Positive>,
}

/// Parameters of the pair's law by name; those not named are the law's own.
pub(crate) type OtherProps = BTreeMap<String, PropValue>;

/// Contact area per length of the slave edge.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Width {
    /// mm.
    Given(Positive),
    /// "part".
    Part(PartWord),
}

/// Sideways strength of the concrete under a wire.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Bearing {
    /// The greatest pressure on the diameter over f_c.
    Factor(Positive),
    /// "crushing" or "rigid".
    Word(BearingWord),
}

/// Whether the concrete under a wire is crushed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum BearingWord {
    /// It is.
    Crushing,
    /// Any pressure.
    Rigid,
}

/// The word "part".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum PartWord {
    /// The thickness of the slave's part; 2πr in axial symmetry.
    Part,
}

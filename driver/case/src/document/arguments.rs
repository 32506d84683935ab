//! Arguments of a plugin that a path leaves open.

use super::Matrix;
use schemars::JsonSchema;
use serde::Deserialize;

/// Arguments of UMAT that the path leaves open, as a replay of a recorded call gives them.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UmatArguments {
    /// SSE, SPD, SCD at the start (default 0).
    pub energies: Option<[f64; 3]>,
    /// TIME(1) at the start, s (default 0).
    pub step_time: Option<f64>,
    /// COORDS, mm (default 0).
    pub coords: Option<[f64; 3]>,
    /// DROT, row by row, in steps without F.
    pub drot: Option<Matrix>,
    /// DFGRD0, row by row, in steps without F.
    pub dfgrd0: Option<Matrix>,
    /// DFGRD1, row by row, in steps without F.
    pub dfgrd1: Option<Matrix>,
    /// NOEL (default 1).
    pub noel: Option<i32>,
    /// NPT (default 1).
    pub npt: Option<i32>,
    /// JSTEP of the first step; JSTEP(1) counts on.
    pub jstep: Option<[i32; 4]>,
    /// KINC of the first increment of each step; it counts on (default 1).
    pub kinc: Option<i32>,
    /// Whether DDSDDE is wanted where the path does not need it (default false).
    pub ddsdde: Option<bool>,
    /// DSTRAN of the first call, NTENS values, in steps without F; default: end minus start of its increment, which rounds.
    pub dstran: Option<Vec<f64>>,
    /// DTIME of the first call, s.
    pub dtime: Option<f64>,
    /// DTEMP of the first call.
    pub dtemp: Option<f64>,
    /// DPRED of the first call, of each field variable.
    pub dpred: Option<Vec<f64>>,
}

/// Arguments of UINTER or FRIC that the path leaves open, as a replay of a recorded call gives them.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ContactArguments {
    /// p and the two shear tractions at the start, MPa; default: what UINTER finds at the initial place.
    pub traction: Option<[f64; 3]>,
    /// SED, SFD, SPD, SVD, SCD at the start (default 0).
    pub energies: Option<[f64; 5]>,
    /// LOPENCLOSE and LSTATE at the start (default -1).
    pub flags: Option<[i32; 2]>,
    /// LM on entry (default 1).
    pub lm: Option<i32>,
    /// FRIC's SLIP at the start, mm (default 0).
    pub slip: Option<[f64; 2]>,
    /// TIME(1) at the start, s (default 0).
    pub step_time: Option<f64>,
    /// COORDS, mm (default 0).
    pub coords: Option<[f64; 3]>,
    /// RCOORD, mm (default 0).
    pub rcoord: Option<[f64; 3]>,
    /// ALOCALDIR, column by column.
    pub alocaldir: Option<[f64; 9]>,
    /// AREA, mm^2 (default 1).
    pub area: Option<f64>,
    /// NODE (default 1).
    pub node: Option<i32>,
    /// KSTEP of the first step; it counts on (default 1).
    pub kstep: Option<i32>,
    /// KINC of the first increment of each step; it counts on (default 1).
    pub kinc: Option<i32>,
    /// KIT (default 1).
    pub kit: Option<i32>,
    /// TIME of the first call, s; default, as of the increments below: what its ends tell, which rounds.
    pub time: Option<[f64; 2]>,
    /// DTIME of the first call, s.
    pub dtime: Option<f64>,
    /// DRDISP of UINTER's first call, mm: of the penetration, then of the slips.
    pub drdisp: Option<[f64; 3]>,
    /// DPRESS of FRIC's first call, MPa.
    pub dpress: Option<f64>,
    /// DTEMP of the first call.
    pub dtemp: Option<f64>,
    /// DPRED of the first call, of each field variable.
    pub dpred: Option<Vec<f64>>,
}

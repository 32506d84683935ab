//! Arguments of a plugin that a path leaves open. A replay of a recorded call gives them, so that the plugin is called
//! with what it was called with.

use schemars::JsonSchema;
use serde::Deserialize;
use umat_abi::host::{FricCall, UinterCall, UmatCall};

/// UMAT arguments that the path does not determine. The replay of a recorded call sets them.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UmatArguments {
    /// SSE, SPD, SCD at the start (default 0).
    pub energies: Option<[f64; 3]>,
    /// TIME(1) at the start, s (default 0).
    pub step_time: Option<f64>,
    /// COORDS, mm (default 0).
    pub coords: Option<[f64; 3]>,
    /// DROT, row by row, in steps without F.
    pub drot: Option<[[f64; 3]; 3]>,
    /// DFGRD0, row by row, in steps without F.
    pub dfgrd0: Option<[[f64; 3]; 3]>,
    /// DFGRD1, row by row, in steps without F.
    pub dfgrd1: Option<[[f64; 3]; 3]>,
    /// NOEL (default 1).
    pub noel: Option<i32>,
    /// NPT (default 1).
    pub npt: Option<i32>,
    /// JSTEP of the first step; JSTEP(1) increases by 1 per step.
    pub jstep: Option<[i32; 4]>,
    /// KINC of the first increment of each step; it increases by 1 per increment (default 1).
    pub kinc: Option<i32>,
    /// Request DDSDDE even where the path does not need it (default false).
    pub ddsdde: Option<bool>,
    /// DSTRAN of the first call, NTENS values, in steps without F. Default: end minus start of the increment, which has
    /// rounding errors.
    pub dstran: Option<Vec<f64>>,
    /// DTIME of the first call, s.
    pub dtime: Option<f64>,
    /// DTEMP of the first call.
    pub dtemp: Option<f64>,
    /// DPRED of the first call, of each field variable.
    pub dpred: Option<Vec<f64>>,
}

impl UmatArguments {
    /// Sets what stays the same in all calls.
    pub fn set(&self, call: &mut UmatCall) {
        call.coords = self.coords.unwrap_or_default();
        call.noel = self.noel.unwrap_or(call.noel);
        call.npt = self.npt.unwrap_or(call.npt);
        call.jstep = self.jstep.unwrap_or(call.jstep);
        // Fortran's order: column by column
        let columns = |rows: [[f64; 3]; 3]| std::array::from_fn(|j| rows.map(|row| row[j]));
        call.drot = self.drot.map_or(call.drot, columns);
        call.dfgrd0 = self.dfgrd0.map_or(call.dfgrd0, columns);
        call.dfgrd1 = self.dfgrd1.map_or(call.dfgrd1, columns);
    }

    /// JSTEP(1) of a step and KINC of an increment, both from 1.
    pub(crate) fn counters(&self, step: u32, increment: u32) -> [i32; 2] {
        [counted(self.jstep.map(|jstep| jstep[0]), step), counted(self.kinc, increment)]
    }

    /// TIME(1) at the start, s.
    pub(crate) fn start(&self) -> f64 {
        self.step_time.unwrap_or_default()
    }
}

/// UINTER or FRIC arguments that the path does not determine. The replay of a recorded call sets them.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ContactArguments {
    /// Pressure p and the two shear tractions at the start, MPa. Default: what UINTER returns at the initial position.
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
    /// KSTEP of the first step; it increases by 1 per step (default 1).
    pub kstep: Option<i32>,
    /// KINC of the first increment of each step; it increases by 1 per increment (default 1).
    pub kinc: Option<i32>,
    /// KIT (default 1).
    pub kit: Option<i32>,
    /// TIME of the first call, s. Default, as for the increments below: computed from the ends of the increment, which
    /// has rounding errors.
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

impl ContactArguments {
    /// Sets what stays the same in all calls.
    pub fn set_uinter(&self, call: &mut UinterCall) {
        call.coords = self.coords.unwrap_or_default();
        call.local_directions = self.alocaldir.unwrap_or(call.local_directions);
        call.area = self.area.unwrap_or(call.area);
        call.node = self.node.unwrap_or(call.node);
    }

    /// Sets what stays the same in all calls.
    pub fn set_fric(&self, call: &mut FricCall) {
        (call.coords, call.rcoord) = (self.coords.unwrap_or_default(), self.rcoord.unwrap_or_default());
        call.node = self.node.unwrap_or(call.node);
    }

    /// KSTEP of a step, KINC of an increment, both from 1, and KIT.
    pub(crate) fn counters(&self, step: u32, increment: u32) -> [i32; 3] {
        [counted(self.kstep, step), counted(self.kinc, increment), self.kit.unwrap_or(1)]
    }

    /// TIME(1) at the start, s.
    pub(crate) fn start(&self) -> f64 {
        self.step_time.unwrap_or_default()
    }
}

/// The number `number` of a count that begins with `first`.
fn counted(first: Option<i32>, number: u32) -> i32 {
    let number = i32::try_from(number).unwrap_or(i32::MAX);
    first.unwrap_or(1).saturating_add(number - 1)
}

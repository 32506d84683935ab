//! Arguments of a plugin that a path leaves open. A replay of a recorded call gives them, so that the plugin is called
//! with what it was called with.

use crate::deformation::columns;
use nalgebra::Matrix3;
use umat_abi::host::{FricCall, UinterCall, UmatCall};

/// What UMAT is told besides the path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UmatArguments {
    /// SSE, SPD, SCD at the start.
    pub energies: [f64; 3],
    /// TIME(1) at the start, s.
    pub step_time: f64,
    /// COORDS, mm.
    pub coords: [f64; 3],
    /// DROT, DFGRD0 and DFGRD1 at small strain; `None`: 1.
    pub kinematics: Option<[Matrix3<f64>; 3]>,
    /// NOEL and NPT, from 1.
    pub element: Option<[i32; 2]>,
    /// JSTEP of the first step; JSTEP(1) counts on.
    pub jstep: Option<[i32; 4]>,
    /// KINC of the first increment of each step; it counts on.
    pub kinc: Option<i32>,
    /// Whether DDSDDE is wanted where the path does not need it.
    pub ddsdde: bool,
    /// DSTRAN of the first call, NTENS values, which the ends of its increment tell but for rounding.
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
        call.coords = self.coords;
        [call.noel, call.npt] = self.element.unwrap_or([call.noel, call.npt]);
        call.jstep = self.jstep.unwrap_or(call.jstep);
        if let Some(kinematics) = &self.kinematics {
            [call.drot, call.dfgrd0, call.dfgrd1] = kinematics.map(|matrix| columns(&matrix));
        }
    }

    /// JSTEP(1) of a step and KINC of an increment, both from 1.
    pub(crate) fn counters(&self, step: u32, increment: u32) -> [i32; 2] {
        [counted(self.jstep.map(|jstep| jstep[0]), step), counted(self.kinc, increment)]
    }
}

/// What UINTER or FRIC is told besides the path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactArguments {
    /// p and the shear tractions at the start, MPa; `None`: what UINTER finds at the initial place, 0 for FRIC.
    pub traction: Option<[f64; 3]>,
    /// SED, SFD, SPD, SVD, SCD at the start.
    pub energies: [f64; 5],
    /// LOPENCLOSE and LSTATE at the start.
    pub flags: Option<[i32; 2]>,
    /// LM on entry.
    pub lm: Option<i32>,
    /// FRIC's SLIP at the start, mm.
    pub slip: [f64; 2],
    /// TIME(1) at the start, s.
    pub step_time: f64,
    /// COORDS, mm.
    pub coords: [f64; 3],
    /// RCOORD, mm.
    pub rcoord: [f64; 3],
    /// ALOCALDIR, column by column.
    pub alocaldir: Option<[f64; 9]>,
    /// AREA, mm².
    pub area: Option<f64>,
    /// NODE, from 1.
    pub node: Option<i32>,
    /// KSTEP of the first step; it counts on.
    pub kstep: Option<i32>,
    /// KINC of the first increment of each step; it counts on.
    pub kinc: Option<i32>,
    /// KIT.
    pub kit: Option<i32>,
    /// TIME of the first call, s.
    pub time: Option<[f64; 2]>,
    /// DTIME of the first call, s.
    pub dtime: Option<f64>,
    /// DRDISP of the first call, mm: the penetration's, then the slips'.
    pub drdisp: Option<[f64; 3]>,
    /// DPRESS of the first call, MPa.
    pub dpress: Option<f64>,
    /// DTEMP of the first call.
    pub dtemp: Option<f64>,
    /// DPRED of the first call, of each field variable.
    pub dpred: Option<Vec<f64>>,
}

impl ContactArguments {
    /// Sets what stays the same in all calls.
    pub fn set_uinter(&self, call: &mut UinterCall) {
        call.coords = self.coords;
        call.local_directions = self.alocaldir.unwrap_or(call.local_directions);
        call.area = self.area.unwrap_or(call.area);
        call.node = self.node.unwrap_or(call.node);
    }

    /// Sets what stays the same in all calls.
    pub fn set_fric(&self, call: &mut FricCall) {
        (call.coords, call.rcoord) = (self.coords, self.rcoord);
        call.node = self.node.unwrap_or(call.node);
    }

    /// KSTEP of a step, KINC of an increment, both from 1, and KIT.
    pub(crate) fn counters(&self, step: u32, increment: u32) -> [i32; 3] {
        [counted(self.kstep, step), counted(self.kinc, increment), self.kit.unwrap_or(1)]
    }
}

/// The number `number` of a count that begins with `first`.
fn counted(first: Option<i32>, number: u32) -> i32 {
    let number = i32::try_from(number).unwrap_or(i32::MAX);
    first.unwrap_or(1).saturating_add(number - 1)
}

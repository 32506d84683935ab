//! FRIC: the tangential law of a contact point. 39 pointers and three CHARACTER lengths (docs/reference/abi.md).

use crate::umat::entry_point;

entry_point! {
    ($) fric
    /// `fric_` as gfortran compiles it on Linux.
    type FricFunction, fric_symbol;
    /// The arguments of FRIC in order.
    struct FricArguments {
        /// LM: on entry 0 slipping, 1 sticking, 2 open; on return 0: TAU, DDTDDG, DDTDDP, DSLIP are given.
        lm: *mut i32,
        /// `(nfdir)` shear traction.
        tau: *mut f64,
        /// `(nfdir,nfdir)` out: d tau / d slip.
        ddtddg: *mut f64,
        /// `(nfdir)` out: d tau / d pressure.
        ddtddp: *mut f64,
        /// `(nfdir)` out: inelastic slip increment.
        dslip: *mut f64,
        /// out: stored energy per area.
        sed: *mut f64,
        /// out: dissipated energy per area.
        sfd: *mut f64,
        /// `(nfdir,2)` d tau / d temperature of the two surfaces; our laws do not write it.
        ddtddt: *mut f64,
        /// out on failure: requested fraction of the increment, in (0,1).
        pnewdt: *mut f64,
        /// `(nstatv)` state variables, all 0 in the virgin state.
        statev: *mut f64,
        /// `(nfdir)` slip increment.
        dgam: *const f64,
        /// `(nfdir)` constraint traction of the sticking point.
        taulm: *const f64,
        /// pressure at the end, positive in compression.
        press: *const f64,
        /// pressure increment.
        dpress: *const f64,
        /// d pressure / d overclosure.
        ddpddh: *const f64,
        /// `(nfdir)` inelastic slip at the start.
        slip: *const f64,
        /// step number.
        kstep: *const i32,
        /// increment number.
        kinc: *const i32,
        /// `(2)` step time and total time at the end.
        time: *const f64,
        /// time increment.
        dtime: *const f64,
        /// element number.
        noel: *const i32,
        /// `(80)` name of the interaction property, blank-padded.
        ciname: *const std::ffi::c_char,
        /// `(80)` slave surface.
        slname: *const std::ffi::c_char,
        /// `(80)` master surface.
        msname: *const std::ffi::c_char,
        /// contact point.
        npt: *const i32,
        /// slave node.
        node: *const i32,
        /// master patch.
        npatch: *const i32,
        /// `(mcrd)` coordinates of the point.
        coords: *const f64,
        /// `(mcrd)` projection of the point on the master surface.
        rcoord: *const f64,
        /// `(2,2)` incremental rotation of the tangential directions.
        drot: *const f64,
        /// `(2)` temperatures of the two surfaces.
        temp: *const f64,
        /// `(2,*)` field variables of the two surfaces.
        predef: *const f64,
        /// number of tangential directions.
        nfdir: *const i32,
        /// number of coordinates.
        mcrd: *const i32,
        /// number of field variables.
        npred: *const i32,
        /// number of state variables.
        nstatv: *const i32,
        /// characteristic element length.
        chrlngth: *const f64,
        /// `(nprops)` parameters.
        props: *const f64,
        /// number of parameters.
        nprops: *const i32,
        /// hidden CHARACTER length.
        ciname_length: usize,
        /// hidden CHARACTER length.
        slname_length: usize,
        /// hidden CHARACTER length.
        msname_length: usize,
    }
}

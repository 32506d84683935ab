//! UINTER: the full law of a contact point. 47 pointers and three CHARACTER lengths (docs/reference/abi.md).
//!
//! Unlike UMAT, STRESS(1) > 0 is compression, RDISP(1) > 0 is penetration, and RDISP, TIME and TEMP
//! are values at the end of the increment.

use crate::umat::entry_point;

entry_point! {
    ($) uinter
    /// `uinter_` as gfortran compiles it on Linux.
    type UinterFunction, uinter_symbol;
    /// The arguments of UINTER in order.
    struct UinterArguments {
        /// `(ndir)` traction; (1) is normal, positive in compression.
        stress: *mut f64,
        /// `(ndir,ndir)` out: d traction / d relative displacement.
        ddsddr: *mut f64,
        /// `(ndir,ndir)` viscous damping; our laws do not write it.
        dviscous: *mut f64,
        /// `(ndir,ndir)` structural damping; our laws do not write it.
        dstructural: *mut f64,
        /// `(2)` heat fluxes; our laws do not write them.
        flux: *mut f64,
        /// `(2,2)` d flux / d temperature; our laws do not write it.
        ddfddt: *mut f64,
        /// `(ndir,2)` d traction / d temperature; our laws do not write it.
        ddsddt: *mut f64,
        /// `(2,ndir)` d flux / d relative displacement; our laws do not write it.
        ddfddr: *mut f64,
        /// `(nstatv)` state variables, all 0 in the virgin state.
        statev: *mut f64,
        /// out: stored energy per area.
        sed: *mut f64,
        /// out: dissipated energy per area.
        sfd: *mut f64,
        /// out: energy dissipated by plasticity per area; our laws return 0.
        spd: *mut f64,
        /// out: energy dissipated by viscosity per area; our laws return 0.
        svd: *mut f64,
        /// out: energy dissipated by creep per area; our laws return 0.
        scd: *mut f64,
        /// out on failure: requested fraction of the increment, in (0,1).
        pnewdt: *mut f64,
        /// `(ndir)` relative displacement at the end; (1) positive is penetration.
        rdisp: *const f64,
        /// `(ndir)` increment of the relative displacement.
        drdisp: *const f64,
        /// `(2)` temperatures of the two surfaces at the end.
        temp: *const f64,
        /// `(2)` temperature increments of the two surfaces.
        dtemp: *const f64,
        /// `(2,npred)` field variables at the end.
        predef: *const f64,
        /// `(2,npred)` increments of the field variables.
        dpred: *const f64,
        /// `(2)` step time and total time at the end.
        time: *const f64,
        /// time increment.
        dtime: *const f64,
        /// frequency.
        freqr: *const f64,
        /// `(80)` name of the interaction property, blank-padded.
        ciname: *const std::ffi::c_char,
        /// `(80)` slave surface.
        slname: *const std::ffi::c_char,
        /// `(80)` master surface.
        msname: *const std::ffi::c_char,
        /// `(nprops)` parameters.
        props: *const f64,
        /// `(mcrd)` coordinates of the point.
        coords: *const f64,
        /// `(mcrd,mcrd)` local directions; the first is the normal.
        alocaldir: *const f64,
        /// `(2,2)` incremental rotation of the tangential directions.
        drot: *const f64,
        /// area of the point.
        area: *const f64,
        /// characteristic element length.
        chrlngth: *const f64,
        /// slave node.
        node: *const i32,
        /// number of directions, normal included.
        ndir: *const i32,
        /// number of state variables.
        nstatv: *const i32,
        /// number of field variables.
        npred: *const i32,
        /// number of parameters.
        nprops: *const i32,
        /// number of coordinates.
        mcrd: *const i32,
        /// step number.
        kstep: *const i32,
        /// increment number.
        kinc: *const i32,
        /// iteration number.
        kit: *const i32,
        /// 1 in a linear perturbation step.
        linper: *const i32,
        /// contact state of the point; -1 at the start.
        lopenclose: *mut i32,
        /// the law's own flag; -1 at the start.
        lstate: *mut i32,
        /// set to 1 to ask for a severe discontinuity iteration.
        lsdi: *mut i32,
        /// 1: messages are requested.
        lprint: *const i32,
        /// hidden CHARACTER length.
        ciname_length: usize,
        /// hidden CHARACTER length.
        slname_length: usize,
        /// hidden CHARACTER length.
        msname_length: usize,
    }
}

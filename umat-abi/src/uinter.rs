//! UINTER: the full law of a contact point. 47 pointers and three CHARACTER lengths (abi.md §1).
//!
//! Unlike UMAT, STRESS(1) > 0 is compression, RDISP(1) > 0 is penetration, and RDISP, TIME and TEMP
//! are values at the end of the increment.

use crate::umat::entry_point;
use std::ffi::c_char;

entry_point! {
    /// `uinter_` as gfortran compiles it on Linux.
    type UinterFunction;
    /// The arguments of UINTER in order.
    struct UinterArguments {
        stress: *mut f64,
        ddsddr: *mut f64,
        dviscous: *mut f64,
        dstructural: *mut f64,
        flux: *mut f64,
        ddfddt: *mut f64,
        ddsddt: *mut f64,
        ddfddr: *mut f64,
        statev: *mut f64,
        sed: *mut f64,
        sfd: *mut f64,
        spd: *mut f64,
        svd: *mut f64,
        scd: *mut f64,
        pnewdt: *mut f64,
        rdisp: *const f64,
        drdisp: *const f64,
        temp: *const f64,
        dtemp: *const f64,
        predef: *const f64,
        dpred: *const f64,
        time: *const f64,
        dtime: *const f64,
        freqr: *const f64,
        ciname: *const c_char,
        slname: *const c_char,
        msname: *const c_char,
        props: *const f64,
        coords: *const f64,
        alocaldir: *const f64,
        drot: *const f64,
        area: *const f64,
        chrlngth: *const f64,
        node: *const i32,
        ndir: *const i32,
        nstatv: *const i32,
        npred: *const i32,
        nprops: *const i32,
        mcrd: *const i32,
        kstep: *const i32,
        kinc: *const i32,
        kit: *const i32,
        linper: *const i32,
        lopenclose: *mut i32,
        lstate: *mut i32,
        lsdi: *mut i32,
        lprint: *const i32,
        ciname_length: usize,
        slname_length: usize,
        msname_length: usize,
    }
}

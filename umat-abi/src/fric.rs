//! FRIC: the tangential law of a contact point. 39 pointers and three CHARACTER lengths (abi.md §1).

use crate::umat::entry_point;
use std::ffi::c_char;

entry_point! {
    /// `fric_` as gfortran compiles it on Linux.
    type FricFunction;
    /// The arguments of FRIC in order.
    struct FricArguments {
        /// On entry 0 slipping, 1 sticking, 2 open; on return 0: TAU, DDTDDG, DDTDDP, DSLIP are given.
        lm: *mut i32,
        tau: *mut f64,
        ddtddg: *mut f64,
        ddtddp: *mut f64,
        dslip: *mut f64,
        sed: *mut f64,
        sfd: *mut f64,
        ddtddt: *mut f64,
        pnewdt: *mut f64,
        statev: *mut f64,
        dgam: *const f64,
        taulm: *const f64,
        press: *const f64,
        dpress: *const f64,
        ddpddh: *const f64,
        slip: *const f64,
        kstep: *const i32,
        kinc: *const i32,
        time: *const f64,
        dtime: *const f64,
        noel: *const i32,
        ciname: *const c_char,
        slname: *const c_char,
        msname: *const c_char,
        npt: *const i32,
        node: *const i32,
        npatch: *const i32,
        coords: *const f64,
        rcoord: *const f64,
        drot: *const f64,
        temp: *const f64,
        predef: *const f64,
        nfdir: *const i32,
        mcrd: *const i32,
        npred: *const i32,
        nstatv: *const i32,
        chrlngth: *const f64,
        props: *const f64,
        nprops: *const i32,
        ciname_length: usize,
        slname_length: usize,
        msname_length: usize,
    }
}

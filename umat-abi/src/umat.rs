//! UMAT: a material point. 37 pointers and one trailing CHARACTER length (abi.md §1).

use std::ffi::c_char;

/// Declares an entry point's function type, the struct that names its arguments, and the call with
/// that struct: one list, so that order and types cannot drift apart.
macro_rules! entry_point {
    (
        $(#[$type_doc:meta])* type $function:ident;
        $(#[$struct_doc:meta])* struct $arguments:ident { $($(#[$doc:meta])* $name:ident: $type:ty,)+ }
    ) => {
        $(#[$type_doc])*
        pub type $function = unsafe extern "C" fn($($type),+);

        $(#[$struct_doc])*
        #[derive(Clone, Copy, Debug)]
        #[allow(missing_docs, reason = "the arguments are defined in the ABAQUS manual and in the header")]
        pub struct $arguments { $($(#[$doc])* pub $name: $type,)+ }

        impl $arguments {
            /// Calls a function with these arguments.
            ///
            /// # Safety
            /// Every pointer must be valid for what the function reads and writes through it.
            #[inline]
            pub unsafe fn call(&self, function: $function) {
                // SAFETY: forwarded to the caller.
                unsafe { function($(self.$name),+) }
            }
        }
    };
}
pub(crate) use entry_point;

entry_point! {
    /// `umat_` as gfortran compiles it on Linux.
    type UmatFunction;
    /// The arguments of UMAT in order. Arrays are Fortran arrays: DDSDDE(NTENS,NTENS) column-major.
    struct UmatArguments {
        stress: *mut f64,
        statev: *mut f64,
        ddsdde: *mut f64,
        sse: *mut f64,
        spd: *mut f64,
        scd: *mut f64,
        rpl: *mut f64,
        ddsddt: *mut f64,
        drplde: *mut f64,
        drpldt: *mut f64,
        stran: *const f64,
        dstran: *const f64,
        time: *const f64,
        dtime: *const f64,
        temp: *const f64,
        dtemp: *const f64,
        predef: *const f64,
        dpred: *const f64,
        cmname: *const c_char,
        ndi: *const i32,
        nshr: *const i32,
        ntens: *const i32,
        nstatv: *const i32,
        props: *const f64,
        nprops: *const i32,
        coords: *const f64,
        drot: *const f64,
        pnewdt: *mut f64,
        celent: *const f64,
        dfgrd0: *const f64,
        dfgrd1: *const f64,
        noel: *const i32,
        npt: *const i32,
        layer: *const i32,
        kspt: *const i32,
        jstep: *const i32,
        kinc: *const i32,
        cmname_length: usize,
    }
}

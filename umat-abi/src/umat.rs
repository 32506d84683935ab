//! UMAT: a material point. 37 pointers and one trailing CHARACTER length (docs/reference/abi.md).

/// Declares an entry point's function type, the struct that names its arguments, the call with that struct, and the macro that
/// defines a symbol of it: one list, so that order and types cannot drift apart.
///
/// The C header and the Fortran module are generated from this list as well: where a field's documentation begins with a shape in
/// backticks, the argument is an array of that shape. `$` stands first because a macro cannot write one for the macro it makes.
macro_rules! entry_point {
    (
        ($d:tt) $module:ident
        $(#[$type_doc:meta])* type $function:ident, $symbol:ident;
        $(#[$struct_doc:meta])* struct $arguments:ident { $($(#[$doc:meta])* $name:ident: $type:ty,)+ }
    ) => {
        $(#[$type_doc])*
        pub type $function = unsafe extern "C" fn($($type),+);

        $(#[$struct_doc])*
        #[derive(Clone, Copy, Debug)]
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

        /// Defines one symbol of this entry point, which runs `$body` on its arguments.
        #[doc(hidden)]
        #[macro_export]
        macro_rules! $symbol {
            ($d symbol:expr, $d ident:ident, $d body:expr) => {
                /// An entry point; see the C header.
                ///
                /// # Safety
                /// Every pointer is NULL or valid for what ABAQUS defines.
                #[allow(clippy::too_many_arguments, reason = "the argument list is ABAQUS's")]
                #[unsafe(export_name = $d symbol)]
                pub unsafe extern "C" fn $d ident($($name: $type),+) {
                    let arguments = $d crate::$module::$arguments { $($name),+ };
                    // SAFETY: forwarded to the caller.
                    unsafe { $d body(&arguments) }
                }
            };
        }
    };
}
pub(crate) use entry_point;

entry_point! {
    ($) umat
    /// `umat_` as gfortran compiles it on Linux.
    type UmatFunction, umat_symbol;
    /// The arguments of UMAT in order. Arrays are Fortran arrays: DDSDDE(NTENS,NTENS) column-major.
    struct UmatArguments {
        /// `(ntens)` in: stress at the start, rotated by the host; out: at the end.
        stress: *mut f64,
        /// `(nstatv)` state variables, all 0 in the virgin state.
        statev: *mut f64,
        /// `(ntens,ntens)` out: consistent tangent, engineering shear; NULL: not requested.
        ddsdde: *mut f64,
        /// out: stored energy per volume.
        sse: *mut f64,
        /// out: dissipated energy per volume.
        spd: *mut f64,
        /// out: energy dissipated by creep per volume; our laws return 0.
        scd: *mut f64,
        /// out: heat generation per volume and time; 0 on entry, written by coupled laws only.
        rpl: *mut f64,
        /// `(ntens)` out: d stress / d temperature; 0 on entry, written by coupled laws only.
        ddsddt: *mut f64,
        /// `(ntens)` out: d RPL / d strain, engineering shear; 0 on entry, written by coupled laws only.
        drplde: *mut f64,
        /// out: d RPL / d temperature; 0 on entry, written by coupled laws only.
        drpldt: *mut f64,
        /// `(ntens)` total strain at the start, engineering shear.
        stran: *const f64,
        /// `(ntens)` strain increment.
        dstran: *const f64,
        /// `(2)` step time and total time at the start.
        time: *const f64,
        /// time increment.
        dtime: *const f64,
        /// temperature at the start.
        temp: *const f64,
        /// temperature increment.
        dtemp: *const f64,
        /// `(*)` field variables at the start.
        predef: *const f64,
        /// `(*)` increments of the field variables.
        dpred: *const f64,
        /// `(80)` material name, blank-padded.
        cmname: *const std::ffi::c_char,
        /// number of direct components.
        ndi: *const i32,
        /// number of shear components.
        nshr: *const i32,
        /// number of components: 11, 22, 33, 12, 13, 23.
        ntens: *const i32,
        /// number of state variables.
        nstatv: *const i32,
        /// `(nprops)` parameters.
        props: *const f64,
        /// number of parameters.
        nprops: *const i32,
        /// `(3)` coordinates of the point.
        coords: *const f64,
        /// `(3,3)` incremental rotation.
        drot: *const f64,
        /// out on failure: requested fraction of the increment, in (0,1).
        pnewdt: *mut f64,
        /// characteristic element length.
        celent: *const f64,
        /// `(3,3)` deformation gradient at the start.
        dfgrd0: *const f64,
        /// `(3,3)` deformation gradient at the end.
        dfgrd1: *const f64,
        /// element number.
        noel: *const i32,
        /// integration point.
        npt: *const i32,
        /// layer.
        layer: *const i32,
        /// section point.
        kspt: *const i32,
        /// `(4)` step number, procedure, NLGEOM, linear perturbation.
        jstep: *const i32,
        /// increment number.
        kinc: *const i32,
        /// hidden CHARACTER length.
        cmname_length: usize,
    }
}

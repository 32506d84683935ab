//! The export macros: one line turns a law into a cdylib.

/// Defines one symbol of UMAT that runs `$body(&UmatArguments)`.
#[doc(hidden)]
#[macro_export]
macro_rules! umat_symbol {
    ($symbol:expr, $ident:ident, $body:expr) => {
        /// UMAT; see the C header.
        ///
        /// # Safety
        /// Every pointer is NULL or valid for what ABAQUS defines.
        #[allow(clippy::too_many_arguments, reason = "the argument list is ABAQUS's")]
        #[unsafe(export_name = $symbol)]
        pub unsafe extern "C" fn $ident(
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
            cmname: *const ::std::ffi::c_char,
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
        ) {
            let arguments = $crate::umat::UmatArguments {
                stress,
                statev,
                ddsdde,
                sse,
                spd,
                scd,
                rpl,
                ddsddt,
                drplde,
                drpldt,
                stran,
                dstran,
                time,
                dtime,
                temp,
                dtemp,
                predef,
                dpred,
                cmname,
                ndi,
                nshr,
                ntens,
                nstatv,
                props,
                nprops,
                coords,
                drot,
                pnewdt,
                celent,
                dfgrd0,
                dfgrd1,
                noel,
                npt,
                layer,
                kspt,
                jstep,
                kinc,
                cmname_length,
            };
            // SAFETY: forwarded to the caller.
            unsafe { $body(&arguments) }
        }
    };
}

/// Defines one symbol of FRIC that runs `$body(&FricArguments)`.
#[doc(hidden)]
#[macro_export]
macro_rules! fric_symbol {
    ($symbol:expr, $ident:ident, $body:expr) => {
        /// FRIC; see the C header.
        ///
        /// # Safety
        /// Every pointer is NULL or valid for what ABAQUS defines.
        #[allow(clippy::too_many_arguments, reason = "the argument list is ABAQUS's")]
        #[unsafe(export_name = $symbol)]
        pub unsafe extern "C" fn $ident(
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
            ciname: *const ::std::ffi::c_char,
            slname: *const ::std::ffi::c_char,
            msname: *const ::std::ffi::c_char,
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
        ) {
            let arguments = $crate::fric::FricArguments {
                lm,
                tau,
                ddtddg,
                ddtddp,
                dslip,
                sed,
                sfd,
                ddtddt,
                pnewdt,
                statev,
                dgam,
                taulm,
                press,
                dpress,
                ddpddh,
                slip,
                kstep,
                kinc,
                time,
                dtime,
                noel,
                ciname,
                slname,
                msname,
                npt,
                node,
                npatch,
                coords,
                rcoord,
                drot,
                temp,
                predef,
                nfdir,
                mcrd,
                npred,
                nstatv,
                chrlngth,
                props,
                nprops,
                ciname_length,
                slname_length,
                msname_length,
            };
            // SAFETY: forwarded to the caller.
            unsafe { $body(&arguments) }
        }
    };
}

/// Defines one symbol of UINTER that runs `$body(&UinterArguments)`.
#[doc(hidden)]
#[macro_export]
macro_rules! uinter_symbol {
    ($symbol:expr, $ident:ident, $body:expr) => {
        /// UINTER; see the C header.
        ///
        /// # Safety
        /// Every pointer is NULL or valid for what ABAQUS defines.
        #[allow(clippy::too_many_arguments, reason = "the argument list is ABAQUS's")]
        #[unsafe(export_name = $symbol)]
        pub unsafe extern "C" fn $ident(
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
            ciname: *const ::std::ffi::c_char,
            slname: *const ::std::ffi::c_char,
            msname: *const ::std::ffi::c_char,
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
        ) {
            let arguments = $crate::uinter::UinterArguments {
                stress,
                ddsddr,
                dviscous,
                dstructural,
                flux,
                ddfddt,
                ddsddt,
                ddfddr,
                statev,
                sed,
                sfd,
                spd,
                svd,
                scd,
                pnewdt,
                rdisp,
                drdisp,
                temp,
                dtemp,
                predef,
                dpred,
                time,
                dtime,
                freqr,
                ciname,
                slname,
                msname,
                props,
                coords,
                alocaldir,
                drot,
                area,
                chrlngth,
                node,
                ndir,
                nstatv,
                npred,
                nprops,
                mcrd,
                kstep,
                kinc,
                kit,
                linper,
                lopenclose,
                lstate,
                lsdi,
                lprint,
                ciname_length,
                slname_length,
                msname_length,
            };
            // SAFETY: forwarded to the caller.
            unsafe { $body(&arguments) }
        }
    };
}

/// Runs when the library is loaded: a plugin's panics are caught and reported by the boundary, so the
/// default hook must not print. Part of every export macro.
#[doc(hidden)]
#[macro_export]
macro_rules! silence_panics_on_load {
    () => {
        #[used]
        #[cfg_attr(target_os = "macos", unsafe(link_section = "__DATA,__mod_init_func"))]
        #[cfg_attr(not(target_os = "macos"), unsafe(link_section = ".init_array"))]
        static SILENCE_PANICS: extern "C" fn() = $crate::export::install_silent_panic_hook;
    };
}

/// Defines a symbol of a function that returns `$plugin`.
#[doc(hidden)]
#[macro_export]
macro_rules! plugin_symbol {
    ($symbol:expr, $plugin:expr) => {
        const _: () = {
            /// A description; see the C header.
            #[unsafe(export_name = $symbol)]
            pub extern "C" fn plugin() -> *const $crate::metadata::Plugin {
                static PLUGIN: $crate::metadata::Plugin = $plugin;
                &raw const PLUGIN
            }
        };
    };
}

/// Defines a symbol of UMAT for many points.
#[doc(hidden)]
#[macro_export]
macro_rules! batch_symbol {
    ($symbol:expr, $law:ty) => {
        const _: () = {
            /// UMAT for many points; see the C header.
            ///
            /// # Safety
            /// Every pointer is NULL or valid for the values that the counts tell.
            #[allow(clippy::too_many_arguments, reason = "the argument list is the contract's")]
            #[unsafe(export_name = $symbol)]
            pub unsafe extern "C" fn batch(
                n: usize,
                ntens: i32,
                ndi: i32,
                props: *const f64,
                nprops: i32,
                strain: *const f64,
                dstrain: *const f64,
                stress: *mut f64,
                statev: *mut f64,
                nstatv: i32,
                ddsdde: *mut f64,
                celent: *const f64,
                status: *mut i32,
            ) {
                let arguments = $crate::export::BatchArguments {
                    n,
                    ntens,
                    ndi,
                    props,
                    nprops,
                    strain,
                    dstrain,
                    stress,
                    statev,
                    nstatv,
                    ddsdde,
                    celent,
                    status,
                };
                // SAFETY: forwarded to the caller.
                unsafe { $crate::export::batch::<$law>(&arguments) }
            }
        };
    };
}

/// The version of the crate that exports, as a C string.
#[doc(hidden)]
#[macro_export]
macro_rules! crate_version {
    () => {
        match ::std::ffi::CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => panic!("a crate version holds no NUL"),
        }
    };
}

/// The description of one law: `(umat Law)` or `(interface Law)`.
#[doc(hidden)]
#[macro_export]
macro_rules! law_plugin {
    ((umat $law:ty)) => {
        $crate::metadata::Plugin::new(
            &<$law as $crate::law::Law>::INFO,
            $crate::crate_version!(),
            $crate::metadata::kinds::UMAT,
            <$law as $crate::law::Law>::STRESS_STATES,
            $crate::export::validate_solid::<$law>,
        )
    };
    ((interface $law:ty)) => {
        $crate::metadata::Plugin::new(
            &<$law as $crate::law::InterfaceLaw>::INFO,
            $crate::crate_version!(),
            $crate::metadata::kinds::UINTER | $crate::metadata::kinds::FRIC,
            0,
            $crate::export::validate_interface::<$law>,
        )
    };
}

/// The descriptions of several laws, linked by `next`.
#[doc(hidden)]
#[macro_export]
macro_rules! plugin_chain {
    ($law:tt) => { $crate::law_plugin!($law) };
    ($law:tt, $($rest:tt),+) => {
        $crate::law_plugin!($law).followed_by(&const { $crate::plugin_chain!($($rest),+) })
    };
}

/// Compares a name with the law's table, when the crate is compiled.
#[doc(hidden)]
#[macro_export]
macro_rules! assert_law_name {
    ($info:expr, $name:literal) => {
        const _: () = assert!($crate::export::is_named(&$info, $name), "the name is not that of the law's table");
    };
}

/// The symbols of one law that bear its name: programs may link several of them.
#[doc(hidden)]
#[macro_export]
macro_rules! own_umat_symbols {
    ($law:ty, $name:literal) => {
        $crate::assert_law_name!(<$law as $crate::law::Law>::INFO, $name);
        const _: () = {
            $crate::umat_symbol!(concat!($name, "_umat_"), umat_unique, $crate::export::umat::<$law>);
            $crate::kratos_symbol!(concat!($name, "_umat_kratos_"), umat_unique);
        };
        $crate::batch_symbol!(concat!($name, "_umat_batch_v1"), $law);
        $crate::plugin_symbol!(concat!($name, "_plugin_v1"), $crate::law_plugin!((umat $law)));
    };
}

/// Defines a symbol of UMAT in Kratos's order of components, by a function in ABAQUS's.
#[doc(hidden)]
#[macro_export]
macro_rules! kratos_symbol {
    ($symbol:expr, $umat:ident) => {
        const _: () = {
            unsafe fn exchanged(arguments: &$crate::umat::UmatArguments) {
                // SAFETY: forwarded to the caller.
                unsafe { $crate::export::umat_kratos($umat, arguments) }
            }
            $crate::umat_symbol!($symbol, umat_kratos, exchanged);
        };
    };
}

/// The symbols of one interface law that bear its name.
#[doc(hidden)]
#[macro_export]
macro_rules! own_interface_symbols {
    ($law:ty, $name:literal) => {
        $crate::assert_law_name!(<$law as $crate::law::InterfaceLaw>::INFO, $name);
        const _: () = {
            $crate::uinter_symbol!(concat!($name, "_uinter_"), uinter_unique, $crate::export::uinter::<$law>);
            $crate::fric_symbol!(concat!($name, "_fric_"), fric_unique, $crate::export::fric::<$law>);
        };
        $crate::plugin_symbol!(concat!($name, "_plugin_v1"), $crate::law_plugin!((interface $law)));
    };
}

/// Turns a [`Law`](crate::law::Law) into the symbols of a cdylib: `umat_`, `umat`, `UMAT`, `pullout_umat_batch_v1` and
/// `pullout_plugin_v1`; and, with the law's name in place of `my_law`, `my_law_umat_`, `my_law_umat_kratos_`,
/// `my_law_umat_batch_v1` and `my_law_plugin_v1`, which programs may link of several laws.
///
/// ```ignore
/// umat_abi::export_umat!(MyLaw, "my_law");
/// ```
#[macro_export]
macro_rules! export_umat {
    ($law:ty, $name:literal) => {
        $crate::silence_panics_on_load!();
        $crate::umat_symbol!("umat_", umat_fortran, $crate::export::umat::<$law>);
        $crate::umat_symbol!("umat", umat_plain, $crate::export::umat::<$law>);
        $crate::umat_symbol!("UMAT", umat_upper, $crate::export::umat::<$law>);
        $crate::batch_symbol!("pullout_umat_batch_v1", $law);
        $crate::plugin_symbol!("pullout_plugin_v1", $crate::law_plugin!((umat $law)));
        $crate::own_umat_symbols!($law, $name);
    };
}

/// Turns a [`Law`](crate::law::Law) into a cdylib for Kratos, which looks for `umat_` and orders shears 12, 23, 13. There is no
/// `umat`, which Kratos would call for rows of DDSDDE, and no description: other hosts are to take the other library.
///
/// ```ignore
/// umat_abi::export_umat_for_kratos!(MyLaw, "my_law");
/// ```
#[macro_export]
macro_rules! export_umat_for_kratos {
    ($law:ty, $name:literal) => {
        $crate::silence_panics_on_load!();
        $crate::assert_law_name!(<$law as $crate::law::Law>::INFO, $name);
        $crate::umat_symbol!(concat!($name, "_umat_"), umat_unique, $crate::export::umat::<$law>);
        $crate::kratos_symbol!("umat_", umat_unique);
    };
}

/// Turns an [`InterfaceLaw`](crate::law::InterfaceLaw) into the symbols of a cdylib: UINTER and FRIC, each under the three usual
/// spellings, and `pullout_plugin_v1`; and, with the law's name in place of `my_bond`, `my_bond_uinter_`, `my_bond_fric_` and
/// `my_bond_plugin_v1`.
///
/// ```ignore
/// umat_abi::export_interface!(MyBond, "my_bond");
/// ```
#[macro_export]
macro_rules! export_interface {
    ($law:ty, $name:literal) => {
        $crate::silence_panics_on_load!();
        $crate::uinter_symbol!("uinter_", uinter_fortran, $crate::export::uinter::<$law>);
        $crate::uinter_symbol!("uinter", uinter_plain, $crate::export::uinter::<$law>);
        $crate::uinter_symbol!("UINTER", uinter_upper, $crate::export::uinter::<$law>);
        $crate::fric_symbol!("fric_", fric_fortran, $crate::export::fric::<$law>);
        $crate::fric_symbol!("fric", fric_plain, $crate::export::fric::<$law>);
        $crate::fric_symbol!("FRIC", fric_upper, $crate::export::fric::<$law>);
        $crate::plugin_symbol!("pullout_plugin_v1", $crate::law_plugin!((interface $law)));
        $crate::own_interface_symbols!($law, $name);
    };
}

/// The UMAT entries of a library of several laws.
#[doc(hidden)]
#[macro_export]
macro_rules! library_umat_symbols {
    ($($law:ty),+) => {
        unsafe fn umat_by_name(arguments: &$crate::umat::UmatArguments) {
            // SAFETY: forwarded to the caller.
            unsafe {
                $crate::export::umat_by_name(
                    &[$($crate::export::NamedEntry {
                        name: <$law as $crate::law::Law>::INFO.name,
                        function: $crate::export::umat::<$law> as unsafe fn(&$crate::umat::UmatArguments),
                    }),+],
                    arguments,
                );
            }
        }
        $crate::umat_symbol!("umat_", umat_fortran, umat_by_name);
        $crate::umat_symbol!("umat", umat_plain, umat_by_name);
        $crate::umat_symbol!("UMAT", umat_upper, umat_by_name);
        $crate::kratos_symbol!("umat_kratos_", umat_fortran);
    };
}

/// The UINTER and FRIC entries of a library of several laws; none for a library without interface laws.
#[doc(hidden)]
#[macro_export]
macro_rules! library_interface_symbols {
    () => {};
    ($($law:ty),+) => {
        unsafe fn uinter_by_name(arguments: &$crate::uinter::UinterArguments) {
            // SAFETY: forwarded to the caller.
            unsafe {
                $crate::export::uinter_by_name(
                    &[$($crate::export::NamedEntry {
                        name: <$law as $crate::law::InterfaceLaw>::INFO.name,
                        function: $crate::export::uinter::<$law> as unsafe fn(&$crate::uinter::UinterArguments),
                    }),+],
                    arguments,
                );
            }
        }
        unsafe fn fric_by_name(arguments: &$crate::fric::FricArguments) {
            // SAFETY: forwarded to the caller.
            unsafe {
                $crate::export::fric_by_name(
                    &[$($crate::export::NamedEntry {
                        name: <$law as $crate::law::InterfaceLaw>::INFO.name,
                        function: $crate::export::fric::<$law> as unsafe fn(&$crate::fric::FricArguments),
                    }),+],
                    arguments,
                );
            }
        }
        $crate::uinter_symbol!("uinter_", uinter_fortran, uinter_by_name);
        $crate::uinter_symbol!("uinter", uinter_plain, uinter_by_name);
        $crate::uinter_symbol!("UINTER", uinter_upper, uinter_by_name);
        $crate::fric_symbol!("fric_", fric_fortran, fric_by_name);
        $crate::fric_symbol!("fric", fric_plain, fric_by_name);
        $crate::fric_symbol!("FRIC", fric_upper, fric_by_name);
    };
}

/// Several laws in one cdylib: UMAT, UINTER and FRIC dispatch on the material name (CMNAME, CINAME); the symbols that bear the name of a
/// law are those of its own library. With no interface law (`interface: []`) the library has neither UINTER nor FRIC.
///
/// ```ignore
/// umat_abi::export_library!(umat: [Elastic => "elastic", Damage => "damage"], interface: [Bond => "bond"]);
/// ```
#[macro_export]
macro_rules! export_library {
    (
        umat: [$($umat:ty => $umat_name:literal),+ $(,)?],
        interface: [$($interface:ty => $interface_name:literal),* $(,)?] $(,)?
    ) => {
        $crate::silence_panics_on_load!();
        $crate::library_umat_symbols!($($umat),+);
        $crate::library_interface_symbols!($($interface),*);
        $crate::plugin_symbol!(
            "pullout_plugin_v1",
            $crate::plugin_chain!($((umat $umat)),+ $(, (interface $interface))*)
        );
        $($crate::own_umat_symbols!($umat, $umat_name);)+
        $($crate::own_interface_symbols!($interface, $interface_name);)*
    };
}

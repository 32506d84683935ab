//! The export macros: one line turns a law into a cdylib.

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

/// Defines an entry point under its three usual spellings.
#[doc(hidden)]
#[macro_export]
macro_rules! usual_symbols {
    ($symbol:ident, $name:ident: [$fortran:literal, $plain:literal, $upper:literal], $body:expr) => {
        $crate::$symbol!($fortran, $name, $body);
        const _: () = {
            $crate::$symbol!($plain, plain, $body);
            $crate::$symbol!($upper, upper, $body);
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
        <$law as $crate::law::Law>::INFO.plugin(
            $crate::crate_version!(),
            $crate::metadata::kinds::UMAT,
            <$law as $crate::law::Law>::STRESS_STATES,
            $crate::export::validate_solid::<$law>,
        )
    };
    ((interface $law:ty)) => {
        <$law as $crate::law::InterfaceLaw>::INFO.plugin(
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

/// The symbols with the name of one law: programs may link several of them.
#[doc(hidden)]
#[macro_export]
macro_rules! own_umat_symbols {
    ($law:ty, $name:literal) => {
        $crate::assert_law_name!(<$law as $crate::law::Law>::INFO, $name);
        const _: () = {
            $crate::umat_symbol!(concat!($name, "_umat_"), umat_unique, $crate::export::umat::<$law>);
            $crate::kratos_symbol!(concat!($name, "_umat_kratos_"), umat_unique);
        };
        const _: () = {
            $crate::batch_symbol!(concat!($name, "_umat_batch_v1"), batch, $crate::export::batch::<$law>);
        };
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

/// The symbols with the name of one interface law.
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
        $crate::usual_symbols!(umat_symbol, umat_fortran: ["umat_", "umat", "UMAT"], $crate::export::umat::<$law>);
        $crate::batch_symbol!("pullout_umat_batch_v1", umat_batch, $crate::export::batch::<$law>);
        $crate::plugin_symbol!("pullout_plugin_v1", $crate::law_plugin!((umat $law)));
        $crate::own_umat_symbols!($law, $name);
    };
}

/// Turns a [`Law`](crate::law::Law) into a cdylib for Kratos, which looks for `umat_` and orders shears 12, 23, 13.
/// There is no `umat`, which Kratos would call for rows of DDSDDE, and no description: other hosts need the other
/// library.
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
        $crate::usual_symbols!(uinter_symbol, uinter_fortran: ["uinter_", "uinter", "UINTER"], $crate::export::uinter::<$law>);
        $crate::usual_symbols!(fric_symbol, fric_fortran: ["fric_", "fric", "FRIC"], $crate::export::fric::<$law>);
        $crate::plugin_symbol!("pullout_plugin_v1", $crate::law_plugin!((interface $law)));
        $crate::own_interface_symbols!($law, $name);
    };
}

/// The UMAT entries of a library of several laws.
#[doc(hidden)]
#[macro_export]
macro_rules! library_umat_symbols {
    ($($law:ty),+) => {
        $crate::run_by_name!(umat_by_name, UmatArguments, Law, umat, $($law),+);
        $crate::usual_symbols!(umat_symbol, umat_fortran: ["umat_", "umat", "UMAT"], umat_by_name);
        $crate::kratos_symbol!("umat_kratos_", umat_fortran);
    };
}

/// The UINTER and FRIC entries of a library of several laws; none for a library without interface laws.
#[doc(hidden)]
#[macro_export]
macro_rules! library_interface_symbols {
    () => {};
    ($($law:ty),+) => {
        $crate::run_by_name!(uinter_by_name, UinterArguments, InterfaceLaw, uinter, $($law),+);
        $crate::run_by_name!(fric_by_name, FricArguments, InterfaceLaw, fric, $($law),+);
        $crate::usual_symbols!(uinter_symbol, uinter_fortran: ["uinter_", "uinter", "UINTER"], uinter_by_name);
        $crate::usual_symbols!(fric_symbol, fric_fortran: ["fric_", "fric", "FRIC"], fric_by_name);
    };
}

/// Defines a function that runs the law that the arguments name.
#[doc(hidden)]
#[macro_export]
macro_rules! run_by_name {
    ($function:ident, $arguments:ident, $trait:ident, $entry:ident, $($law:ty),+) => {
        unsafe fn $function(arguments: &$crate::export::$arguments) {
            let laws = [$($crate::export::NamedEntry {
                name: <$law as $crate::law::$trait>::INFO.name,
                function: $crate::export::$entry::<$law>,
            }),+];
            // SAFETY: forwarded to the caller.
            unsafe { $crate::export::by_name(&laws, arguments) }
        }
    };
}

/// Several laws in one cdylib: UMAT, UINTER and FRIC dispatch on the material name (CMNAME, CINAME). The symbols with
/// the name of a law are those of its own library. With no interface law (`interface: []`) the library has neither
/// UINTER nor FRIC.
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

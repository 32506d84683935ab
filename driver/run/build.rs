//! Passes to the macro `shipped::manifest` where Cargo puts the plugins that are built with the program.

use std::path::{Path, PathBuf};
use std::{env, fs};

/// Every folder here is the package of a plugin.
const PLUGINS: &str = "../../models/plugins";
/// The routines that plugins call.
const UTILITIES: &str = "pullout_utilities";

fn main() {
    println!("cargo::rerun-if-changed={PLUGINS}");
    // <target>/<profile>/build/driver-…/out
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("Cargo sets OUT_DIR"));
    let folder = out.ancestors().nth(3).expect("OUT_DIR lies in Cargo's target folder").join("deps");
    let names = fs::read_dir(PLUGINS).expect("the plugins' packages").flatten().map(|package| package.file_name());
    let library = |name: &Path| format!("{}{}{}", env::consts::DLL_PREFIX, name.display(), env::consts::DLL_SUFFIX);
    let names = names.chain([UTILITIES.into()]);
    let mut libraries: Vec<PathBuf> = names.map(|name| folder.join(library(Path::new(&name)))).collect();
    libraries.sort();
    let list = env::join_paths(&libraries).expect("paths without a separator of paths");
    println!("cargo::rustc-env=PULLOUT_SHIPPED_PLUGINS={}", list.display());
}

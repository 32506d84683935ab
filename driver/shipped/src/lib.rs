//! The manifest of the plugins shipped with pullout. It is compiled into the program, so that it cannot be replaced.
//!
//! The plugins are dependencies of the program's crate. Cargo links them before it compiles that crate, and compiles
//! the crate again when one of them changes: the files hashed here are those that are installed with the program.

use proc_macro::TokenStream;
use sha2::{Digest, Sha256};
use std::env;

/// Lists length and SHA-256 of each library in `PULLOUT_SHIPPED_PLUGINS` (set by the crate's build script) as a
/// `&[(u64, [u8; 32])]`. Libraries that Cargo has not built, as in `cargo check`, are left out.
#[proc_macro]
pub fn manifest(_: TokenStream) -> TokenStream {
    let libraries = env::var_os("PULLOUT_SHIPPED_PLUGINS").unwrap_or_default();
    let contents = env::split_paths(&libraries).filter_map(|library| std::fs::read(library).ok());
    let entries =
        contents.map(|content| format!("({}, {:?}),", content.len(), <[u8; 32]>::from(Sha256::digest(content))));
    format!("&[{}]", entries.collect::<String>()).parse().expect("numbers in brackets")
}

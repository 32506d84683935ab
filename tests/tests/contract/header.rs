//! `pullout_umat.h`, written by cbindgen from declarations made of the contract.

use crate::source::EntryPoint;
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

const PREFACE: &str = "\
/* The plugin contract of Pullout: UMAT, FRIC and UINTER as gfortran compiles them on Linux, and the
 * self-description of a plugin.
 *
 * Generated from umat-abi/src by the test `contract`; do not edit. */";

const DECLARE: &str = "
/* Declare the symbols of a law, for programs that link several laws: PULLOUT_DECLARE_UMAT(linear_elastic); gives
 * linear_elastic_umat_. The library of a law and libpullout_laws have them. Kratos: shears 12, 23, 13. */
#ifdef __cplusplus
#define PULLOUT_DECLARE extern \"C\"
#else
#define PULLOUT_DECLARE extern
#endif
#define PULLOUT_DECLARE_UMAT(law) PULLOUT_DECLARE __typeof__(umat_) law##_umat_
#define PULLOUT_DECLARE_UMAT_KRATOS(law) PULLOUT_DECLARE __typeof__(umat_) law##_umat_kratos_
#define PULLOUT_DECLARE_UMAT_BATCH(law) PULLOUT_DECLARE __typeof__(pullout_umat_batch_v1) law##_umat_batch_v1
#define PULLOUT_DECLARE_FRIC(law) PULLOUT_DECLARE __typeof__(fric_) law##_fric_
#define PULLOUT_DECLARE_UINTER(law) PULLOUT_DECLARE __typeof__(uinter_) law##_uinter_
#define PULLOUT_DECLARE_PLUGIN(law) PULLOUT_DECLARE __typeof__(pullout_plugin_v1) law##_plugin_v1";

/// The whole header.
pub fn generate(entry_points: &[EntryPoint], metadata: &TokenStream) -> String {
    let declarations: TokenStream = entry_points.iter().map(declaration).collect();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let source = folder.path().join("contract.rs");
    std::fs::write(&source, quote!(#metadata #declarations).to_string()).expect("a file");
    let mut header = Vec::new();
    cbindgen::Builder::new()
        .with_config(configuration())
        .with_src(source)
        .generate()
        .expect("declarations that cbindgen understands")
        .write(&mut header);
    old_comments(&String::from_utf8(header).expect("UTF-8"))
}

/// Replaces comments to the end of a line, which cbindgen writes after its `#endif`: C89 has none.
fn old_comments(header: &str) -> String {
    let line = |line: &str| match line.split_once("// ") {
        Some((code, comment)) if code.starts_with("#endif") => format!("{code}/* {comment} */\n"),
        _ => format!("{line}\n"),
    };
    header.lines().map(line).collect()
}

fn configuration() -> cbindgen::Config {
    cbindgen::Config {
        language: cbindgen::Language::C,
        style: cbindgen::Style::Both,
        header: Some(PREFACE.into()),
        after_includes: Some(DECLARE.into()),
        include_guard: Some("PULLOUT_UMAT_H".into()),
        no_includes: true,
        sys_includes: vec!["stddef.h".into(), "stdint.h".into()],
        cpp_compat: true,
        usize_is_size_t: true,
        documentation: true,
        documentation_style: cbindgen::DocumentationStyle::C,
        line_length: 110,
        ..cbindgen::Config::default()
    }
}

/// The prototype and the type of its pointers, documented with the list of arguments.
fn declaration(entry: &EntryPoint) -> TokenStream {
    let symbol = format_ident!("{}_", entry.name);
    let pointer = format_ident!("pullout_{}_function", entry.name);
    let names: Vec<_> = entry.arguments.iter().map(|argument| format_ident!("{}", argument.name)).collect();
    let types: Vec<_> = entry.arguments.iter().map(|argument| &argument.rust_type).collect();
    let mut doc: Vec<String> = entry.doc.iter().map(|line| format!(" {line}")).collect();
    doc.push(String::new());
    doc.extend(entry.arguments.iter().map(|a| format!(" - {}{}: {}", a.name, a.shape, a.doc)));
    let pointer_doc = format!(" A pointer to `{symbol}`.");
    quote! {
        #(#[doc = #doc])*
        #[unsafe(no_mangle)]
        pub extern "C" fn #symbol(#(#names: #types),*) {}
        #[doc = #pointer_doc]
        pub type #pointer = unsafe extern "C" fn(#(#names: #types),*);
    }
}

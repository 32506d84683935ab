//! The C header and the Fortran module say what the Rust source of the contract says; documents cite what is there and use the
//! words of the glossary; crates and modules stand in an order.
//!
//! Header and module are generated from `umat-abi/src`; these tests compare the committed files with the source, and
//! `PULLOUT_REGENERATE=1 cargo test -p end-to-end-tests --test contract` writes them anew.

mod documents;
mod fortran;
mod header;
mod rooms;
mod source;
mod words;

use end_to_end_tests::{Tool, find, run, workspace};
use source::EntryPoint;
use std::path::Path;

const HEADER: &str = "umat-abi/include/pullout_umat.h";
const MODULE: &str = "umat-abi/fortran/pullout_umat.f90";

/// Compares a committed file with what the source makes of it, or writes it.
fn check_current(file: &str, generated: &str) {
    let path = workspace(file);
    if std::env::var_os("PULLOUT_REGENERATE").is_some_and(|value| value == "1") {
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("the folder of a generated file");
        std::fs::write(&path, generated).expect("writing a generated file");
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(committed == generated, "{file} is not current: run this test with PULLOUT_REGENERATE=1 and commit it");
}

#[test]
fn c_header_is_current() {
    check_current(HEADER, &header::generate(&EntryPoint::read_all(), &source::metadata()));
}

#[test]
fn fortran_module_is_current() {
    check_current(MODULE, &fortran::generate(&EntryPoint::read_all(), &source::batch_arguments()));
}

#[test]
fn entry_points_have_the_vendors_number_of_arguments() {
    let counts: Vec<_> = EntryPoint::read_all()
        .iter()
        .map(|entry| (entry.name.clone(), entry.arguments.iter().filter(|a| !a.is_hidden_length()).count()))
        .collect();
    assert_eq!(counts, [("umat".into(), 37), ("fric".into(), 39), ("uinter".into(), 47)]);
}

fn compile_header(tool: Tool, standard: &str, suffix: &str) {
    let Some(mut compiler) = find(tool) else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join(format!("includes.{suffix}"));
    let declarations = ["UMAT", "UMAT_KRATOS", "UMAT_BATCH", "FRIC", "UINTER", "PLUGIN"];
    let declarations = declarations.map(|what| format!("PULLOUT_DECLARE_{what}(some_law);\n")).concat();
    std::fs::write(&program, format!("#include \"pullout_umat.h\"\n{declarations}")).expect("a file");
    let include = workspace(HEADER);
    let include = include.parent().map_or(Path::new(""), |folder| folder);
    run(compiler
        .args([standard, "-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only", "-I"])
        .arg(include)
        .arg(&program));
}

#[test]
fn c_header_compiles_as_c89_and_c99() {
    compile_header(Tool::C, "-std=c89", "c");
    compile_header(Tool::C, "-std=c99", "c");
}

#[test]
fn c_header_compiles_as_cpp() {
    compile_header(Tool::Cpp, "-std=c++11", "cpp");
}

#[test]
fn fortran_module_compiles_as_fortran_2008() {
    let Some(mut compiler) = find(Tool::Fortran) else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    run(compiler
        .current_dir(folder.path())
        .args(["-std=f2008", "-Wall", "-Wextra", "-pedantic", "-Werror", "-c"])
        .arg(workspace(MODULE)));
}

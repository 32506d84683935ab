//! The C and the Fortran example, built by pkg-config and by CMake.

use super::{Installation, example, history, numbers};
use end_to_end_tests::{Tool, difference, find, run, workspace};
use std::path::Path;
use std::process::Command;

/// A path of strains in steps of their own sum: the last digits of a strain differ, and so do those of a stress.
const ROUNDING: f64 = 1e-12;

/// The example computes what the installed program does.
fn check(installation: &Installation, example_program: &Path, folder: &Path) {
    let printed = numbers(&run(&mut Command::new(example_program)).stdout);
    let out = folder.join("result");
    installation.run_case(&example("uniaxial-strain.json"), &[], &out);
    let mut expected = history(&out, &["e11", "s11", "s22", "s33"]);
    // the state before the first increment, where the history has it
    expected.retain(|row| row[0] != 0.0);
    assert_eq!(printed.len(), 60);
    assert_eq!(expected.len(), 60);
    for column in 0..4 {
        let of = |rows: &[Vec<f64>]| rows.iter().map(|row| row[column]).collect::<Vec<_>>();
        let apart = difference(&of(&printed), &of(&expected));
        assert!(apart <= ROUNDING, "column {column}: {apart:e} apart");
    }
    // cracked, then crushed beyond the strength of 27.6 MPa by the lateral pressure
    assert!(expected[19][1] > 0.0 && expected[59][1] < -50.0, "{:?} {:?}", expected[19], expected[59]);
}

/// Returns the answer of pkg-config, word by word.
fn pkg_config(installation: &Installation, questions: &[&str]) -> Option<Vec<String>> {
    let mut command = find(Tool::PkgConfig)?;
    command.env("PKG_CONFIG_PATH", installation.prefix.join("lib/pkgconfig")).args(questions).arg("pullout");
    Some(String::from_utf8_lossy(&run(&mut command).stdout).split_whitespace().map(str::to_owned).collect())
}

#[test]
fn the_c_example_builds_by_pkg_config() {
    let Some(installation) = Installation::find() else { return };
    let Some(words) = pkg_config(&installation, &["--cflags", "--libs"]) else { return };
    let Some(mut compiler) = find(Tool::C) else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("uniaxial_strain");
    compiler.args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-o"]).arg(&program);
    run(compiler.arg(example("c/uniaxial_strain.c")).args(words));
    check(&installation, &program, folder.path());
}

/// Batches of several laws, from the one library that pkg-config names.
#[test]
fn batches_are_linked_by_pkg_config() {
    let Some(installation) = Installation::find() else { return };
    let Some(words) = pkg_config(&installation, &["--cflags", "--libs"]) else { return };
    let Some(mut compiler) = find(Tool::C) else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("two_laws");
    compiler.args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-o"]).arg(&program);
    run(compiler.arg(workspace("tests/clients/two_laws.c")).args(words));
    let output = run(&mut Command::new(&program));
    assert!(output.stdout.starts_with(b"linear_elastic j2_plasticity\n"));
    assert_eq!(String::from_utf8_lossy(&output.stdout).lines().count(), 7);
}

#[test]
fn the_c_example_builds_by_cmake() {
    let Some(installation) = Installation::find() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let build = folder.path().join("build");
    let Some(mut configure) = find(Tool::CMake) else { return };
    configure.arg("-S").arg(example("c")).arg("-B").arg(&build);
    run(configure.arg(format!("-DCMAKE_PREFIX_PATH={}", installation.prefix.display())));
    let Some(mut compile) = find(Tool::CMake) else { return };
    run(compile.arg("--build").arg(&build));
    check(&installation, &build.join("uniaxial_strain"), folder.path());
}

/// find_package with a version: this series and nothing newer.
#[test]
fn cmake_takes_versions_as_cargo_does() {
    let Some(installation) = Installation::find() else { return };
    let version = env!("CARGO_PKG_VERSION");
    for (wanted, found) in [(version, true), ("0.1", true), ("0.1.99", false), ("0.0", false), ("1.0", false)] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let project = format!(
            "cmake_minimum_required(VERSION 3.13)\nproject(p LANGUAGES NONE)\nset(pullout_DIR \
             {}/lib/cmake/pullout)\nfind_package(pullout {wanted} CONFIG)\nif(pullout_FOUND)\nmessage(STATUS taken)\nendif()\n",
            installation.prefix.display()
        );
        std::fs::write(folder.path().join("CMakeLists.txt"), project).expect("a file");
        let Some(mut configure) = find(Tool::CMake) else { return };
        let output = run(configure.arg("-S").arg(folder.path()).arg("-B").arg(folder.path().join("b")));
        assert_eq!(String::from_utf8_lossy(&output.stdout).contains("-- taken"), found, "{wanted}");
    }
}

#[test]
fn the_fortran_example_builds_with_the_shipped_module() {
    let Some(installation) = Installation::find() else { return };
    let Some(module) = pkg_config(&installation, &["--variable=fortran_module"]) else { return };
    let Some(libraries) = pkg_config(&installation, &["--libs"]) else { return };
    let Some(mut compiler) = find(Tool::Fortran) else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("uniaxial_strain");
    compiler.current_dir(folder.path()).args(["-std=f2008", "-Wall", "-Werror", "-o"]).arg(&program).args(module);
    run(compiler.arg(example("fortran/uniaxial_strain.f90")).args(libraries));
    check(&installation, &program, folder.path());
}

/// The program finds its plugins under the prefix and nowhere else.
#[test]
fn the_installed_program_finds_its_plugins() {
    let Some(installation) = Installation::find() else { return };
    let listed = run(installation.program().args(["plugin", "list"]));
    let text = String::from_utf8_lossy(&listed.stdout).into_owned();
    let folder = installation.prefix.join("lib/pullout");
    let (laws, _) = text.split_once("Searched:").expect("laws, then folders");
    for law in end_to_end_tests::LAWS {
        let line = laws.lines().find(|line| line.starts_with(&format!("{} ", law.name)));
        assert!(line.is_some_and(|line| line.contains(&folder.display().to_string())), "{}:\n{text}", law.name);
    }
    // ABAQUS's name for the library of all laws
    let same = std::fs::read(folder.join("abaqus/libstandardU.so")).expect("ABAQUS's library");
    assert_eq!(same, std::fs::read(installation.library("pullout_laws")).expect("the library"));
}

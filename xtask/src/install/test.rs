use super::*;
use std::os::unix::fs::PermissionsExt;

/// A program that writes a page as the real one does.
const PROGRAM: &str = "#!/bin/sh\n[ $1 = pages ] && mkdir -p $2/man/man1 && echo page > $2/man/man1/pullout.1\n";

/// Products of a build, as empty as can be.
fn products(folder: &Path, libraries: &[&str]) -> Products {
    let file = |name: &str| {
        let path = folder.join(name);
        fs::write(&path, name).expect("a file");
        path
    };
    let libraries = libraries.iter().map(|name| file(name)).collect();
    let program = file("pullout");
    fs::write(&program, PROGRAM).expect("a file");
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).expect("our own file");
    Products { program, libraries, kratos: vec![file("libother_kratos.so")] }
}

fn all_laws() -> String {
    format!("{}{ALL_LAWS}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

#[test]
fn everything_is_put_under_the_prefix_and_can_be_put_there_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let products = products(folder.path(), &[&all_laws(), "libother.so"]);
    let prefix = folder.path().join("new/prefix");
    for _ in 0..2 {
        let files = install(&crate::workspace(), &products, &prefix).expect("an installation");
        let mut found: Vec<_> =
            files.iter().map(|file| file.strip_prefix(&prefix).expect("below").display().to_string()).collect();
        let all = found.len();
        found.retain(|file| !file.starts_with(CASES));
        assert!(all > found.len() + 100, "the cases travel with the program");
        assert!(prefix.join(CASES).join("examples/j2-cyclic-shear.json").is_file());
        found.sort();
        let laws = format!("lib/pullout/{}", all_laws());
        let mut expected = vec![
            "bin/pullout",
            "include/pullout_umat.f90",
            "include/pullout_umat.h",
            "lib/cmake/pullout/pullout-config-version.cmake",
            "lib/cmake/pullout/pullout-config.cmake",
            "lib/pkgconfig/pullout.pc",
            "lib/pullout/abaqus/libstandardU.so",
            "lib/pullout/kratos/libother.so",
            "lib/pullout/libother.so",
            laws.as_str(),
            "share/doc/pullout/LICENSE-APACHE",
            "share/doc/pullout/LICENSE-MIT",
            "share/doc/pullout/THIRD-PARTY.txt",
            "share/doc/pullout/pullout.cdx.json",
            "share/man/man1/pullout.1",
        ];
        expected.sort();
        assert_eq!(found, expected);
        assert!(files.iter().all(|file| file.is_file()) && !prefix.join("share.unfinished").exists());
    }
    let without = folder.path().join("without");
    all_but_the_program(&crate::workspace(), &products, &without).expect("an installation");
    let plugins = without.join("lib/pullout");
    assert!(plugins.join("libother.so").is_file());
    assert!(!plugins.join("abaqus").exists() && !plugins.join("kratos").exists() && !without.join("bin").exists());
    let package = fs::read_to_string(prefix.join("lib/pkgconfig/pullout.pc")).expect("a file");
    assert!(package.contains(&format!("Version: {}\n", env!("CARGO_PKG_VERSION"))));
    assert!(!package.contains("@VERSION@"));
}

#[test]
fn what_is_missing_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let message = |products: &Products, prefix: &Path| {
        install(&crate::workspace(), products, prefix).expect_err("no installation")
    };
    let incomplete = products(folder.path(), &["libother.so"]);
    assert_eq!(message(&incomplete, &folder.path().join("p")), "the build made no pullout_laws");
    let complete = products(folder.path(), &[&all_laws()]);
    let occupied = folder.path().join("pullout");
    assert!(message(&complete, &occupied).starts_with(&format!("{}/bin", occupied.display())));
    fs::remove_file(&complete.program).expect("the file is there");
    assert!(message(&complete, &folder.path().join("p")).ends_with("pullout: does not exist"));
}

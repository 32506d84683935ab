use super::{FOLDER, linker, make, tag_is_kept};
use crate::Build;
use std::path::Path;

#[test]
fn maturin_is_looked_for_before_anything_is_built() {
    let workspace = tempfile::tempdir().expect("a folder");
    let earlier = workspace.path().join(FOLDER);
    std::fs::create_dir_all(&earlier).expect("a folder");
    // has no module at all
    let how = Build { profile: "dev".into(), zig: false, python: "false".into() };
    let refused = make(workspace.path(), &how, &[]).expect_err("no maturin");
    assert!(refused.contains("pip install maturin"), "{refused}");
    assert!(earlier.is_dir());
}

/// The builds may have another folder than that of the workspace.
#[test]
fn a_linker_is_written_where_nothing_was_built() {
    let workspace = tempfile::tempdir().expect("a folder");
    // answers whatever it is asked
    let python = Path::new("echo");
    assert!(linker(workspace.path(), python).is_ok_and(|file| file.is_file()));
}

#[test]
fn a_wheel_is_not_named_for_an_older_system_than_its_libraries_need() {
    let name = "pullout_fe-0.1.0-cp310-abi3-manylinux_2_17_x86_64.manylinux2014_x86_64.whl";
    let words = |tag: &str| format!("{name} is consistent with the following\nplatform tag: \"{tag}\".\nmore");
    assert!(tag_is_kept(name, &words("manylinux_2_17_x86_64")).is_ok());
    assert!(tag_is_kept(name, &words("manylinux_2_5_x86_64")).is_ok());
    assert!(tag_is_kept(name, &words("manylinux_2_34_x86_64")).is_err());
    assert!(tag_is_kept(name, &words("linux_x86_64")).is_err());
    assert!(tag_is_kept("pullout_fe-0.1.0-cp310-abi3-linux_x86_64.whl", &words("manylinux_2_17_x86_64")).is_err());
}

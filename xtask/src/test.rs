use super::*;

#[test]
fn what_is_installed_is_stripped_unless_another_profile_is_named() {
    let profile = |more: &[&str]| {
        let line = ["xtask", "install", "--prefix", "P"].iter().chain(more);
        match Arguments::parse_from(line).task {
            Task::Install { build, .. } | Task::Deb { build, .. } | Task::Wheel { build, .. } => build.profile,
        }
    };
    assert_eq!(profile(&["--profile", "dev"]), "dev");
    let manifest = std::fs::read_to_string(workspace().join("Cargo.toml")).expect("the workspace's manifest");
    let (_, section) = manifest.split_once(&format!("[profile.{}]\n", profile(&[]))).expect("the profile");
    let section = section.split("\n[").next().unwrap_or_default();
    assert!(section.lines().any(|line| line == "strip = true"), "{section}");
}

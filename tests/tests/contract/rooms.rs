//! Rooms of the house: no crate depends on one that stands above it, no two top modules of a crate on each other, none is
//! built twice.

use end_to_end_tests::workspace;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Crates by floor, from the ground up; crates on one floor do not know each other.
const FLOORS: [&[&str]; 11] = [
    &["umat-abi"],
    &["models", "fe-core"],
    &["pullout-bridging"],
    &["pullout-run"],
    &["pullout-case"],
    &["pullout-import", "pullout-report"],
    &["pullout-engine"],
    &["pullout-check", "pullout-fit", "pullout-study"],
    &["pullout-sweep", "pullout-lab"],
    &["driver"],
    &["pullout-bench", "pullout-python"],
];

fn floor(package: &str) -> Option<usize> {
    FLOORS.iter().position(|floor| floor.contains(&package))
}

/// Name, manifest and dependencies (those of tests left out) of the crates on the floors.
fn packages() -> Vec<(String, PathBuf, Vec<String>)> {
    let mut cargo = Command::new(option_env!("CARGO").unwrap_or("cargo"));
    cargo.args(["metadata", "--no-deps", "--offline", "--format-version", "1"]).current_dir(workspace(""));
    let metadata: Value = serde_json::from_slice(&cargo.output().expect("cargo metadata").stdout).expect("JSON");
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let packages = metadata["packages"].as_array().expect("packages").iter().map(|package| {
        let needed = package["dependencies"].as_array().into_iter().flatten().filter(|d| d["kind"] != "dev");
        let needed = needed.map(|dependency| text(&dependency["name"])).collect();
        (text(&package["name"]), PathBuf::from(text(&package["manifest_path"])), needed)
    });
    packages.filter(|(name, ..)| floor(name).is_some()).collect()
}

#[test]
fn crates_depend_on_lower_ones_only() {
    let packages = packages();
    assert_eq!(packages.len(), FLOORS.iter().map(|floor| floor.len()).sum::<usize>());
    for (name, _, needed) in packages {
        let above = needed.iter().filter(|other| floor(other).is_some_and(|other| Some(other) >= floor(&name)));
        assert_eq!(above.collect::<Vec<_>>(), Vec::<&String>::new(), "{name} depends on what is not below it");
    }
}

/// Adds the top modules that a source names after `crate::`, or after as many `super::` as lead to the crate's root.
fn named(source: &str, depth: usize, found: &mut BTreeSet<String>) {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let code: String = source.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    for root in ["crate::".to_owned(), "super::".repeat(depth)] {
        for (at, _) in code.match_indices(&root).filter(|(at, _)| !code[..*at].ends_with([':', '_'])) {
            let path = &code[at + root.len()..];
            let list = path.strip_prefix('{').map_or(path, |list| list.split("};").next().unwrap_or(list));
            let names = list.split(',').take(if list.len() < path.len() { usize::MAX } else { 1 });
            found.extend(names.map(|name| name.trim().chars().take_while(|c| is_word(*c)).collect::<String>()));
        }
    }
}

/// Adds what the files of a top module name, tests left out.
fn walk(path: &Path, depth: usize, found: &mut BTreeSet<String>) {
    if path.ends_with("test") || path.ends_with("test.rs") {
        return;
    }
    if path.is_dir() {
        let entries = std::fs::read_dir(path).expect("a folder").flatten();
        entries.for_each(|entry| walk(&entry.path(), depth + 1, found));
    } else if path.extension() == Some("rs".as_ref()) {
        named(&std::fs::read_to_string(path).expect("a source"), depth - usize::from(path.ends_with("mod.rs")), found);
    }
}

#[test]
fn top_modules_of_a_crate_have_no_circles() {
    for (name, manifest, _) in packages() {
        let mut needed: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for entry in std::fs::read_dir(manifest.with_file_name("src")).expect("sources").flatten() {
            let module = entry.path().file_stem().expect("a name").to_string_lossy().into_owned();
            if !["lib", "main", "bin", "test"].contains(&module.as_str()) {
                walk(&entry.path(), 1, needed.entry(module).or_default());
            }
        }
        let modules: BTreeSet<String> = needed.keys().cloned().collect();
        needed
            .iter_mut()
            .for_each(|(module, others)| others.retain(|other| other != module && modules.contains(other)));
        // those that need none of the others stand; what is left stands on itself
        while let Some(ground) = needed.iter().find(|(_, others)| others.is_empty()).map(|(module, _)| module.clone()) {
            needed.remove(&ground);
            needed.values_mut().for_each(|others| others.retain(|other| *other != ground));
        }
        assert!(needed.is_empty(), "{name}: a circle among {needed:?}");
    }
}

/// Dependencies with their features, as a build of some packages has them.
fn dependencies(selection: &[&str]) -> BTreeSet<String> {
    let mut cargo = Command::new(option_env!("CARGO").unwrap_or("cargo"));
    cargo.args(["tree", "--offline", "--prefix", "none", "--format", "{p} {f}"]).args(selection);
    let output = cargo.current_dir(workspace("")).output().expect("cargo tree");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

#[test]
fn the_extension_of_python_builds_no_dependency_that_the_tests_do_not() {
    let extension = dependencies(&["--package", "pullout-python", "--edges", "normal,build"]);
    let tests = dependencies(&["--workspace", "--edges", "normal,build,dev"]);
    assert!(extension.len() > 100, "{}", extension.len());
    assert_eq!(extension.difference(&tests).collect::<Vec<_>>(), Vec::<&String>::new());
}

//! Rooms of the house: no crate depends on one that stands above it, no two top modules of a crate on each other.

use end_to_end_tests::workspace;
use proc_macro2::{TokenStream, TokenTree};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// From the ground up; crates on one floor do not know each other.
const FLOORS: [&[&str]; 7] = [
    &["umat-abi"],
    &["models", "fe-core", "pullout-bridging"],
    &["pullout-run"],
    &["pullout-case"],
    &["pullout-report"],
    &["pullout-check", "pullout-fit", "pullout-study"],
    &["driver", "pullout-bench"],
];
/// The floors whose crates have modules without circles.
const WITHOUT_CIRCLES: std::ops::RangeFrom<usize> = 2..;

fn floor(package: &str) -> Option<usize> {
    FLOORS.iter().position(|floor| floor.contains(&package))
}

/// Name, manifest and dependencies (those of tests left out) of the crates on the floors.
fn packages() -> Vec<(String, PathBuf, Vec<String>)> {
    let cargo = option_env!("CARGO").unwrap_or("cargo");
    let told = Command::new(cargo)
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(workspace(""))
        .output()
        .expect("cargo metadata");
    let told: Value = serde_json::from_slice(&told.stdout).expect("JSON");
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let packages = told["packages"].as_array().expect("packages").iter().map(|package| {
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

/// The top modules that a file names by `crate::` or as many `super::` as lead to the crate's root.
fn named(tokens: TokenStream, depth: usize, found: &mut BTreeSet<String>) {
    let (mut ups, mut is_root) = (0, false);
    for token in tokens {
        match token {
            TokenTree::Punct(punct) if punct.as_char() == ':' => continue,
            TokenTree::Ident(ident) if ident == "super" => {
                ups += 1;
                is_root = ups == depth;
                continue;
            }
            TokenTree::Ident(ident) if ident == "crate" => {
                is_root = true;
                continue;
            }
            TokenTree::Ident(ident) if is_root => {
                found.insert(ident.to_string());
            }
            TokenTree::Group(group) if is_root => {
                let mut is_first = true;
                for token in group.stream() {
                    if let (TokenTree::Ident(ident), true) = (&token, is_first) {
                        found.insert(ident.to_string());
                    }
                    is_first = matches!(&token, TokenTree::Punct(punct) if punct.as_char() == ',');
                }
            }
            TokenTree::Group(group) => named(group.stream(), depth, found),
            _ => {}
        }
        (ups, is_root) = (0, false);
    }
}

/// What the files of a top module name, tests left out.
fn walk(path: &Path, depth: usize, found: &mut BTreeSet<String>) {
    if path.is_dir() {
        let entries = std::fs::read_dir(path).expect("a folder").flatten();
        entries.for_each(|entry| walk(&entry.path(), depth + 1, found));
    } else if path.extension().is_some_and(|extension| extension == "rs") && path.file_stem() != Some("test".as_ref()) {
        let depth = depth - usize::from(path.ends_with("mod.rs"));
        let text = std::fs::read_to_string(path).expect("a source");
        named(text.parse().expect("Rust"), depth, found);
    }
}

#[test]
fn top_modules_of_a_crate_have_no_circles() {
    for (name, manifest, _) in packages() {
        if !floor(&name).is_some_and(|floor| WITHOUT_CIRCLES.contains(&floor)) {
            continue;
        }
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

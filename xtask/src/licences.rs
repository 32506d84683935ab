//! Third-party packages in the program and the laws: their collected licences, and a bill of materials.

use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// The packages from which products are made.
const ROOTS: [&str; 3] = ["driver", "pullout-python", "pullout_laws"];
/// The list of licences that are allowed; cargo-deny reads it too.
const ALLOWED: &str = "deny.toml";

/// A package of others.
#[derive(Debug, PartialEq, Eq)]
pub struct Package {
    name: String,
    version: String,
    licence: String,
    /// Texts of the files of its licences.
    texts: Vec<String>,
}

/// Returns the third-party packages that are part of the build, by name.
///
/// # Errors
/// A message: Cargo's graph cannot be read, or a package has a licence that `deny.toml` does not allow.
pub fn packages(workspace: &Path) -> Result<Vec<Package>, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(workspace).args(["metadata", "--format-version", "1", "--locked"]);
    command.args(["--filter-platform", &format!("{}-unknown-linux-gnu", std::env::consts::ARCH)]);
    let output = command.stderr(Stdio::inherit()).output().map_err(|error| format!("cargo does not start: {error}"))?;
    if !output.status.success() {
        return Err(format!("cargo metadata: {}", output.status));
    }
    let metadata = serde_json::from_slice(&output.stdout).map_err(|error| format!("cargo metadata: {error}"))?;
    let rules = fs::read_to_string(workspace.join(ALLOWED)).map_err(|error| format!("{ALLOWED}: {error}"))?;
    let packages = linked(&metadata);
    let refused = refused(&packages, &allowed(&rules)?);
    if refused.is_empty() { Ok(packages) } else { Err(format!("{ALLOWED} does not allow: {}", refused.join(", "))) }
}

/// Packages that the products are linked from, in Cargo's graph: not what only builds or tests them.
fn linked(metadata: &Value) -> Vec<Package> {
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let packages: HashMap<String, Value> =
        list(&metadata["packages"]).into_iter().map(|package| (text(&package["id"]), package)).collect();
    let nodes: HashMap<String, Value> =
        list(&metadata["resolve"]["nodes"]).into_iter().map(|node| (text(&node["id"]), node)).collect();
    let is_root = |package: &Value| ROOTS.contains(&text(&package["name"]).as_str());
    let mut open: Vec<String> =
        packages.iter().filter(|(_, package)| is_root(package)).map(|(id, _)| id.clone()).collect();
    let mut seen: BTreeSet<String> = open.iter().cloned().collect();
    let mut found = Vec::new();
    while let Some(id) = open.pop() {
        let Some(package) = packages.get(&id) else { continue };
        let is_macro = list(&package["targets"]).iter().any(|target| target["kind"][0] == "proc-macro");
        if is_macro {
            continue;
        }
        if !package["source"].is_null() {
            let folder = Path::new(package["manifest_path"].as_str().unwrap_or_default()).parent();
            let texts = folder.map(texts_in).unwrap_or_default();
            let [name, version, licence] = ["name", "version", "license"].map(|key| text(&package[key]));
            found.push(Package { name, version, licence, texts });
        }
        for dependency in nodes.get(&id).map(|node| list(&node["deps"])).unwrap_or_default() {
            let is_linked = list(&dependency["dep_kinds"]).iter().any(|kind| kind["kind"].is_null());
            let id = text(&dependency["pkg"]);
            if is_linked && seen.insert(id.clone()) {
                open.push(id);
            }
        }
    }
    found.sort_by(|a, b| (&a.name, &a.version).cmp(&(&b.name, &b.version)));
    found
}

/// Returns the texts of licences and notices next to a manifest.
fn texts_in(folder: &Path) -> Vec<String> {
    let mut files: Vec<_> = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    files.sort();
    let is_wanted = |path: &Path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
        ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"].iter().any(|word| name.starts_with(word))
    };
    let texts = files.iter().filter(|path| is_wanted(path)).filter_map(|path| fs::read_to_string(path).ok());
    texts.map(|text| text.replace("\r\n", "\n").trim().to_owned()).filter(|text| !text.is_empty()).collect()
}

/// The list `allow` of `deny.toml`.
fn allowed(rules: &str) -> Result<BTreeSet<String>, String> {
    let list = rules.split("\nallow = [").nth(1).and_then(|rest| rest.split(']').next());
    let list = list.ok_or_else(|| format!("{ALLOWED} has no list `allow`"))?;
    Ok(list.split('"').skip(1).step_by(2).map(str::to_owned).collect())
}

/// Returns the packages whose licence offers no allowed choice.
fn refused(packages: &[Package], allowed: &BTreeSet<String>) -> Vec<String> {
    let is_refused = |package: &&Package| !is_allowed(&package.licence, allowed);
    packages.iter().filter(is_refused).map(|p| format!("{} {} ({})", p.name, p.version, p.licence)).collect()
}

/// Whether an expression of SPDX ("(MIT OR Apache-2.0) AND Unicode-3.0", as well with the "/" of old) can be kept to with
/// what is allowed.
fn is_allowed(expression: &str, allowed: &BTreeSet<String>) -> bool {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let mut place = 0;
    either(&words, &mut place, allowed) && place == words.len()
}

fn either(words: &[&str], place: &mut usize, allowed: &BTreeSet<String>) -> bool {
    let mut is_so = both(words, place, allowed);
    while words.get(*place) == Some(&"OR") {
        *place += 1;
        is_so |= both(words, place, allowed);
    }
    is_so
}

fn both(words: &[&str], place: &mut usize, allowed: &BTreeSet<String>) -> bool {
    let mut is_so = one(words, place, allowed);
    while words.get(*place) == Some(&"AND") {
        *place += 1;
        is_so &= one(words, place, allowed);
    }
    is_so
}

fn one(words: &[&str], place: &mut usize, allowed: &BTreeSet<String>) -> bool {
    let Some(word) = words.get(*place) else {
        // no end of an expression
        *place += 1;
        return false;
    };
    *place += 1;
    if *word == "(" {
        let is_so = either(words, place, allowed);
        let is_closed = words.get(*place) == Some(&")");
        *place += 1;
        return is_so && is_closed;
    }
    let mut licence = (*word).to_owned();
    if let (Some(&"WITH"), Some(exception)) = (words.get(*place), words.get(*place + 1)) {
        *place += 2;
        licence = format!("{licence} WITH {exception}");
    }
    allowed.contains(&licence)
}

/// Returns one text of all licences, each with its packages.
pub fn collected(packages: &[Package]) -> String {
    let mut text = "Pullout has parts of these packages, under their own licences.\n\n".to_owned();
    let mut by_text: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for Package { name, version, licence, texts } in packages {
        text += &format!("{name} {version}: {licence}\n");
        for one in texts {
            by_text.entry(one).or_default().push(format!("{name} {version}"));
        }
    }
    for (licence, names) in by_text {
        text += &format!("\n{}\n{}\n\n{licence}\n", "-".repeat(80), names.join(", "));
    }
    text
}

/// The bill of materials, in CycloneDX's format.
pub fn bill(packages: &[Package], version: &str) -> String {
    let component = |Package { name, version, licence, .. }: &Package| {
        let expression = licence.replace('/', " OR ");
        json!({
            "type": "library", "name": name, "version": version,
            "purl": format!("pkg:cargo/{name}@{version}"),
            "licenses": [{ "expression": expression }],
        })
    };
    let components: Vec<Value> = packages.iter().map(component).collect();
    let subject = json!({ "type": "application", "name": "pullout", "version": version });
    let bill = json!({
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "metadata": { "component": subject }, "components": components,
    });
    format!("{bill:#}\n")
}

#[cfg(test)]
mod test;

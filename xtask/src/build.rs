//! Products of Cargo, as it reports them itself.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Package and name of the program, which depends on the plugins.
const PROGRAM: [&str; 2] = ["driver", "pullout"];
/// Package and name of Python's extension, which contains the program.
const EXTENSION: [&str; 2] = ["pullout-python", "_core"];
/// The package of all laws in one library.
pub const ALL_LAWS: &str = "pullout_laws";
/// The folder of the plugins' packages, whose examples are the libraries for Kratos.
const PLUGINS: &str = "models/plugins/";
/// The folder of the utility routines.
const UTILITIES: &str = "umat-abi/";
/// The profile for distribution. Builds with another profile are for tests.
pub const FOR_OTHERS: &str = "dist";

/// The target for older C libraries than this machine's, and the variables that name the target's linker and C compiler.
#[cfg(target_arch = "aarch64")]
const OLDER: [&str; 3] =
    ["aarch64-unknown-linux-gnu", "CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", "CC_aarch64_unknown_linux_gnu"];
#[cfg(not(target_arch = "aarch64"))]
const OLDER: [&str; 3] =
    ["x86_64-unknown-linux-gnu", "CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_LINKER", "CC_x86_64_unknown_linux_gnu"];

/// Files that Cargo made.
#[derive(Debug, PartialEq, Eq)]
pub struct Products {
    /// The program; for a wheel, the extension.
    pub program: PathBuf,
    /// The plugins and the library of the utility routines.
    pub libraries: Vec<PathBuf>,
    /// The plugins in Kratos's order of components: `lib<law>_kratos.so`.
    pub kratos: Vec<PathBuf>,
}

/// Builds program and plugins, at once: the program knows its plugins by their hashes, and a second build with other
/// features would make others.
///
/// Where it is for tests, the whole workspace is built: dependencies have other features then, and the tests build them so.
///
/// `wheel`: Python's extension instead of the program and the libraries for Kratos. `linker`: that of another Linux, if it is not this
/// machine's.
///
/// # Errors
/// A message: Cargo cannot be started, or the build fails (Cargo has printed why), or makes no program.
pub fn build(workspace: &Path, profile: &str, wheel: bool, linker: Option<&Path>) -> Result<Products, String> {
    let [package, name] = if wheel { EXTENSION } else { PROGRAM };
    products(&messages(workspace, profile, package, linker)?, name)
}

/// Makes a Cargo build use a linker for older Linux. Builds that name the linker alike share their products.
pub fn link_by(command: &mut Command, linker: &Path) {
    let [target, of_rust, of_c] = OLDER;
    command.args(["--target", target]).envs([of_rust, of_c].map(|name| (name, linker)));
}

/// Cargo's messages of the build.
fn messages(workspace: &Path, profile: &str, package: &str, linker: Option<&Path>) -> Result<String, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(workspace).args(["build", "--lib", "--bins"]);
    if let Some(linker) = linker {
        link_by(&mut command, linker);
    }
    if profile == FOR_OTHERS {
        command.args(["--package", package]);
        let plugins = workspace.join(PLUGINS);
        let packages = plugins.read_dir().map_err(|error| format!("{}: {error}", plugins.display()))?;
        for package in packages.flatten() {
            command.arg("--package").arg(package.file_name());
        }
        if package == PROGRAM[0] {
            command.args(["--features", "driver/full"]);
        }
    } else {
        command.arg("--workspace");
    }
    if !(profile == FOR_OTHERS && package == EXTENSION[0]) {
        command.arg("--examples");
    }
    command.args(["--profile", profile, "--message-format=json-render-diagnostics"]).stderr(Stdio::inherit());
    let output = command.output().map_err(|error| format!("cargo does not start: {error}"))?;
    if !output.status.success() {
        return Err(format!("the build failed ({})", output.status));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Reads the messages about artifacts from Cargo's messages, one JSON object per line.
fn artifacts(messages: &str) -> Result<Vec<Value>, String> {
    let mut artifacts = Vec::new();
    for line in messages.lines() {
        let message: Value = serde_json::from_str(line).map_err(|error| format!("Cargo's message {line}: {error}"))?;
        if message["reason"] == "compiler-artifact" {
            artifacts.push(message);
        }
    }
    Ok(artifacts)
}

/// The shared libraries among the laws' targets of a kind: dependencies and tests have some too, which nobody asked for.
fn libraries(messages: &str, kind: &str) -> Result<Vec<PathBuf>, String> {
    let has = |list: &Value, word: &str| list.as_array().is_some_and(|list| list.iter().any(|entry| entry == word));
    let mut libraries = Vec::new();
    for artifact in artifacts(messages)? {
        let package = artifact["package_id"].as_str().unwrap_or_default();
        let is_ours =
            package.starts_with("path+") && [PLUGINS, UTILITIES].iter().any(|folder| package.contains(folder));
        if is_ours && has(&artifact["target"]["kind"], kind) && has(&artifact["target"]["crate_types"], "cdylib") {
            let files = artifact["filenames"].as_array().into_iter().flatten().filter_map(Value::as_str);
            libraries.extend(files.filter(|file| file.ends_with(std::env::consts::DLL_SUFFIX)).map(PathBuf::from));
        }
    }
    Ok(libraries)
}

/// Returns the program or the extension (by its name), the plugins, and the libraries for Kratos.
fn products(messages: &str, name: &str) -> Result<Products, String> {
    let artifacts = artifacts(messages)?;
    let program = artifacts.iter().find(|artifact| artifact["target"]["name"] == name);
    // an extension is no executable, but the only file of its target
    let program = program.and_then(|artifact| artifact["executable"].as_str().or(artifact["filenames"][0].as_str()));
    let program = program.ok_or_else(|| format!("the build made no {name}"))?;
    let (libraries, kratos) = (libraries(messages, "cdylib")?, libraries(messages, "example")?);
    Ok(Products { program: program.into(), libraries, kratos })
}

#[cfg(test)]
mod test;

//! What Cargo builds, as it tells it itself.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The package of the program; the plugins are among its dependencies.
const PROGRAM: &str = "driver";

/// Files that Cargo made.
#[derive(Debug, PartialEq, Eq)]
pub struct Products {
    /// The program.
    pub program: PathBuf,
    /// The plugins and the library of the utility routines.
    pub libraries: Vec<PathBuf>,
}

/// Builds program and plugins.
///
/// # Errors
/// In words: Cargo cannot be started, or the build fails (it has said why), or makes no program.
pub fn build(workspace: &Path, profile: &str) -> Result<Products, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .current_dir(workspace)
        .args(["build", "--package", PROGRAM, "--profile", profile, "--message-format=json-render-diagnostics"])
        .stderr(Stdio::inherit());
    let output = command.output().map_err(|error| format!("cargo does not start: {error}"))?;
    if !output.status.success() {
        return Err(format!("the build failed ({})", output.status));
    }
    products(&String::from_utf8_lossy(&output.stdout))
}

/// Reads Cargo's messages, one JSON object a line: artifacts of target kind `cdylib`, and the executable.
fn products(messages: &str) -> Result<Products, String> {
    let mut program = None;
    let mut libraries = Vec::new();
    for line in messages.lines() {
        let message: Value = serde_json::from_str(line).map_err(|error| format!("Cargo's message {line}: {error}"))?;
        if message["reason"] != "compiler-artifact" {
            continue;
        }
        if let Some(executable) = message["executable"].as_str() {
            program = Some(PathBuf::from(executable));
        }
        let is_library = message["target"]["kind"].as_array().is_some_and(|kinds| kinds.iter().any(|k| k == "cdylib"));
        if is_library {
            let files = message["filenames"].as_array().into_iter().flatten().filter_map(Value::as_str);
            let suffix = std::env::consts::DLL_SUFFIX;
            libraries.extend(files.filter(|file| file.ends_with(suffix)).map(PathBuf::from));
        }
    }
    match program {
        Some(program) => Ok(Products { program, libraries }),
        None => Err("the build made no program".to_owned()),
    }
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn artifacts_are_read_from_cargos_messages() {
        let suffix = std::env::consts::DLL_SUFFIX;
        let messages = format!(
            r#"{{"reason":"compiler-artifact","target":{{"kind":["lib"]}},"filenames":["/t/libserde.rlib"],"executable":null}}
{{"reason":"compiler-artifact","target":{{"kind":["cdylib"]}},"filenames":["/t/deps/liba{suffix}","/t/deps/liba.debug"],"executable":null}}
{{"reason":"compiler-artifact","target":{{"kind":["bin"]}},"filenames":["/t/pullout"],"executable":"/t/pullout"}}
{{"reason":"build-finished","success":true}}"#
        );
        let expected =
            Products { program: "/t/pullout".into(), libraries: vec![format!("/t/deps/liba{suffix}").into()] };
        assert_eq!(products(&messages), Ok(expected));
        assert!(products(r#"{"reason":"build-finished"}"#).expect_err("no program").contains("no program"));
        assert!(products("no JSON").is_err());
    }
}

//! `cargo xtask`: what Cargo itself does not do for this workspace.

mod build;
mod install;

use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Tasks of the workspace.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Build program and plugins, and put them with header, Fortran module, pkg-config file and CMake package under a
    /// prefix: bin, lib/pullout, include, lib/pkgconfig, lib/cmake/pullout; manual pages and the shells' completions: share.
    Install {
        /// Where to; made if it does not exist. The tree may be moved later.
        #[arg(long, value_name = "DIR")]
        prefix: PathBuf,
        /// Cargo profile to build with.
        #[arg(long, value_name = "NAME", default_value = "dist")]
        profile: String,
    },
}

fn main() -> ExitCode {
    let Task::Install { prefix, profile } = Arguments::parse().task;
    match build::build(&workspace(), &profile).and_then(|products| install::install(&workspace(), &products, &prefix)) {
        Ok(files) => {
            for file in files {
                println!("{}", file.display());
            }
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("cargo xtask install: {message}");
            ExitCode::FAILURE
        }
    }
}

/// The folder of the workspace.
fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask/ lies in the workspace").to_path_buf()
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn what_is_installed_is_stripped_unless_another_profile_is_named() {
        let profile = |more: &[&str]| {
            let line = ["xtask", "install", "--prefix", "P"].iter().chain(more);
            let Task::Install { profile, .. } = Arguments::parse_from(line).task;
            profile
        };
        assert_eq!(profile(&["--profile", "dev"]), "dev");
        let manifest = std::fs::read_to_string(workspace().join("Cargo.toml")).expect("the workspace's manifest");
        let (_, section) = manifest.split_once(&format!("[profile.{}]\n", profile(&[]))).expect("the profile");
        let section = section.split("\n[").next().unwrap_or_default();
        assert!(section.lines().any(|line| line == "strip = true"), "{section}");
    }
}

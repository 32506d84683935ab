//! `cargo xtask`: what Cargo itself does not do for this workspace.

mod build;
mod deb;
mod install;
mod licences;
mod wheel;

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
        #[arg(long, value_name = "NAME", default_value = build::FOR_OTHERS)]
        profile: String,
    },
    /// Make a package for Debian of what `install` puts, and print its name.
    Deb {
        /// Where it is put.
        #[arg(long, value_name = "DIR", default_value = "target")]
        out: PathBuf,
        /// Cargo profile to build with. Packages of others than "dist" are not compressed: they are for tests.
        #[arg(long, value_name = "NAME", default_value = build::FOR_OTHERS)]
        profile: String,
    },
    /// Build the wheel of the Python package, with the program, the laws and what belongs to them, but without the copies of
    /// the laws for ABAQUS and Kratos, and print its name: it is put into target/wheel.
    Wheel {
        /// Cargo profile to build with. Wheels of others than "dist" are larger, and not audited: they are for tests.
        #[arg(long, value_name = "NAME", default_value = build::FOR_OTHERS)]
        profile: String,
        /// Link with zig, for Linux from 2014 on (manylinux_2_17): the Python has ziglang too.
        #[arg(long)]
        zig: bool,
        /// A Python that has maturin. If it has auditwheel and abi3audit too, they must find nothing.
        #[arg(long, value_name = "PYTHON", default_value = "python3")]
        python: PathBuf,
        /// More options of `maturin build`.
        #[arg(last = true)]
        maturin: Vec<String>,
    },
}

fn main() -> ExitCode {
    let workspace = workspace();
    let (name, done) = match Arguments::parse().task {
        Task::Install { prefix, profile } => {
            let products = build::build(&workspace, &profile, false, None);
            ("install", products.and_then(|products| install::install(&workspace, &products, &prefix)))
        }
        Task::Deb { out, profile } => {
            let products = build::build(&workspace, &profile, false, None);
            let made = products.and_then(|products| deb::make(&workspace, &products, &profile, &out));
            ("deb", made.map(|package| vec![package]))
        }
        Task::Wheel { profile, zig, python, maturin } => {
            ("wheel", wheel::make(&workspace, &profile, zig, &python, &maturin).map(|wheel| vec![wheel]))
        }
    };
    match done {
        Ok(files) => {
            for file in files {
                println!("{}", file.display());
            }
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("cargo xtask {name}: {message}");
            ExitCode::FAILURE
        }
    }
}

/// The folder of the workspace.
fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask/ lies in the workspace").to_path_buf()
}

#[cfg(test)]
mod test;

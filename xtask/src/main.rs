//! `cargo xtask`: what Cargo itself does not do for this workspace.

mod build;
mod deb;
mod install;
mod licences;
mod wheel;

use clap::{Args, Parser, Subcommand};
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
        #[command(flatten)]
        build: Build,
    },
    /// Make a package for Debian of what `install` puts, and print its name.
    Deb {
        /// Where it is put.
        #[arg(long, value_name = "DIR", default_value = "target")]
        out: PathBuf,
        #[command(flatten)]
        build: Build,
    },
    /// Build the wheel of the Python package, with the program, the laws and what belongs to them, but without the copies of
    /// the laws for ABAQUS and Kratos, and print its name: it is put into target/wheel.
    ///
    /// The Python has maturin. If it has auditwheel and abi3audit too, they must find nothing.
    Wheel {
        #[command(flatten)]
        build: Build,
        /// More options of `maturin build`.
        #[arg(last = true)]
        maturin: Vec<String>,
    },
}

/// How the products are built.
#[derive(Debug, Args)]
struct Build {
    /// Cargo profile to build with. Profiles other than "dist" are for tests: their products are large and not checked.
    #[arg(long, value_name = "NAME", default_value = build::FOR_OTHERS)]
    profile: String,
    /// Link with zig, for Linux from 2014 on (glibc 2.17, manylinux2014). The Python needs maturin and ziglang.
    #[arg(long)]
    zig: bool,
    /// The Python that has the tools.
    #[arg(long, value_name = "PYTHON", default_value = "python3")]
    python: PathBuf,
}

impl Build {
    /// The program and the libraries.
    fn products(&self, workspace: &Path) -> Result<build::Products, String> {
        build::build(workspace, &self.profile, false, self.linker(workspace)?.as_deref())
    }

    /// The linker for older Linux, where it is asked for.
    fn linker(&self, workspace: &Path) -> Result<Option<PathBuf>, String> {
        self.zig.then(|| wheel::linker(workspace, &self.python)).transpose()
    }
}

fn main() -> ExitCode {
    let workspace = workspace();
    let (name, done) = match Arguments::parse().task {
        Task::Install { prefix, build } => {
            let products = build.products(&workspace);
            ("install", products.and_then(|products| install::install(&workspace, &products, &prefix)))
        }
        Task::Deb { out, build } => {
            let products = build.products(&workspace);
            let made = products.and_then(|products| deb::make(&workspace, &products, &build.profile, &out));
            ("deb", made.map(|package| vec![package]))
        }
        Task::Wheel { build, maturin } => ("wheel", wheel::make(&workspace, &build, &maturin).map(|wheel| vec![wheel])),
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

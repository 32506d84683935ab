//! A package for Debian and what is made of it: what `install` puts, below /usr.

use crate::build::{FOR_OTHERS, Products};
use crate::install;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const DESCRIPTION: &str = "constitutive laws as UMAT plugins, and fibre pull-out by finite elements
 The program pullout drives UMAT, UINTER and FRIC libraries along strain, stress
 and mixed paths, checks them, and pulls fibres out of concrete with them. The
 laws come as libraries for ABAQUS, Kratos, OOFEM and programs of one's own.";

/// Licences as Debian wants them, in addition to those that `install` copies.
const COPYRIGHT: &str = include_str!("../templates/copyright");

/// Makes the package in `folder`; the result is its file. `dpkg-deb` does it.
///
/// # Errors
/// A message.
pub fn make(workspace: &Path, products: &Products, profile: &str, folder: &Path) -> Result<PathBuf, String> {
    let within = |file: &Path, error: std::io::Error| format!("{}: {error}", file.display());
    let tree = folder.join("pullout.tree");
    if tree.exists() {
        fs::remove_dir_all(&tree).map_err(|error| within(&tree, error))?;
    }
    let files = install::install(workspace, products, &tree.join("usr"))?;
    let mut glibc = [2, 17];
    let mut bytes = 0;
    for file in &files {
        let content = fs::read(file).map_err(|error| within(file, error))?;
        bytes += content.len();
        glibc = glibc.max(needed(&content));
    }
    let version = env!("CARGO_PKG_VERSION");
    let architecture = if cfg!(target_arch = "aarch64") { "arm64" } else { "amd64" };
    let [major, minor] = glibc;
    let control = format!(
        "Package: pullout\nVersion: {version}\nArchitecture: {architecture}\nSection: science\nPriority: optional\n\
         Maintainer: The Pullout developers\nInstalled-Size: {}\nDepends: libc6 (>= {major}.{minor}), libgcc-s1\n\
         Recommends: fonts-dejavu-core\nSuggests: gfortran, gcc\n\
         Description: {DESCRIPTION}\n",
        bytes.div_ceil(1024)
    );
    let about = tree.join("DEBIAN");
    let written = fs::create_dir_all(&about)
        .and_then(|()| fs::write(about.join("control"), control))
        .and_then(|()| fs::write(tree.join("usr/share/doc/pullout/copyright"), COPYRIGHT));
    written.map_err(|error| within(&about, error))?;
    let package = folder.join(format!("pullout_{version}_{architecture}.deb"));
    // what is for tests is large, and used at once
    let compression: &[&str] = if profile == FOR_OTHERS { &["-Zxz"] } else { &["-Znone"] };
    let mut command = Command::new("dpkg-deb");
    command.args(["--root-owner-group", "--build"]).args(compression).arg(&tree).arg(&package);
    let output = command.output().map_err(|error| format!("dpkg-deb does not start: {error}"))?;
    if !output.status.success() {
        return Err(format!("dpkg-deb: {}", String::from_utf8_lossy(&output.stderr).trim()));
    }
    fs::remove_dir_all(&tree).map_err(|error| within(&tree, error))?;
    Ok(package)
}

/// The version of the C library that a program or library asks for: the greatest among the names of its symbols' versions.
fn needed(content: &[u8]) -> [u32; 2] {
    const NAME: &[u8] = b"\0GLIBC_2.";
    let mut greatest = [0, 0];
    for (place, _) in content.windows(NAME.len()).enumerate().filter(|(_, window)| *window == NAME) {
        let digits = content[place + NAME.len()..].iter().take_while(|byte| byte.is_ascii_digit());
        let minor =
            digits.fold(0_u32, |number, digit| number.saturating_mul(10).saturating_add(u32::from(digit - b'0')));
        greatest = greatest.max([2, minor]);
    }
    greatest
}

#[cfg(test)]
mod test;

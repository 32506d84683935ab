//! The wheel: extension, program, laws and headers in one file for Python. The program is a script that calls the extension:
//! a second copy of the engine would be a third of the wheel.

use crate::Build;
use crate::build::{self, FOR_OTHERS};
use crate::install;
use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folder in the workspace where the wheel is made. `python/pyproject.toml` takes the files to install from there.
const FOLDER: &str = "target/wheel";
/// Folder of files that Python's installers put under the prefix, and with the programs.
const DATA: &str = "pullout_fe.data";
/// The program, in the workspace.
const PROGRAM: &str = "python/pullout";
/// Path of the extension below a folder that Python searches for modules.
const EXTENSION: &str = "pullout_fe/_core.abi3.so";
/// A wheel should have no more: it is refused by nobody, but waited for by everybody.
const BYTES: u64 = 12_000_000;

/// Builds everything, and makes the wheel of it; the result is its file.
///
/// The Python of `how` has maturin; where it has auditwheel and abi3audit as well, they must find nothing. `maturin`: further arguments of
/// `maturin build`.
///
/// # Errors
/// A message; the output of a tool is on the standard error.
pub fn make(workspace: &Path, how: &Build, maturin: &[String]) -> Result<PathBuf, String> {
    let Build { profile, python, .. } = how;
    if !has(python, "maturin") {
        let python = python.display();
        return Err(format!("{python} has no maturin, which makes the wheel: {python} -m pip install maturin"));
    }
    let folder = workspace.join(FOLDER);
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let linker = how.linker(workspace)?;
    let products = build::build(workspace, profile, true, linker.as_deref())?;
    let data = folder.join(DATA).join("data");
    install::all_but_the_program(workspace, &products, &data)?;
    let (program, modules) = (folder.join(DATA).join("scripts/pullout"), folder.join("modules"));
    install::copy(&workspace.join(PROGRAM), &program)?;
    install::copy(&products.program, &modules.join(EXTENSION))?;
    let mut pages = Command::new(python);
    pages.arg(&program).env("PYTHONPATH", &modules);
    install::pages(pages, &data.join("share"))?;
    let mut command = Command::new(python);
    command.args(["-m", "maturin", "build", "--profile", profile, "--manifest-path"]);
    command.arg(workspace.join("python/Cargo.toml")).arg("--out").arg(&folder).args(maturin);
    command.args(match profile.as_str() {
        FOR_OTHERS => ["--compression-level", "9", "--auditwheel", "check"],
        // unstripped and used at once
        _ => ["--compression-method", "stored", "--auditwheel", "skip"],
    });
    if let Some(linker) = &linker {
        build::link_by(&mut command, linker);
        command.args(["--compatibility", "manylinux2014"]);
    }
    run(&mut command, "maturin")?;
    for library in &products.libraries {
        let installed = data.join("lib/pullout").join(library.file_name().unwrap_or_default());
        // maturin may have built the laws again, in the same place
        let content = |file: &Path| fs::read(file).map_err(|error| format!("{}: {error}", file.display()));
        if content(library)? != content(&installed)? {
            return Err(format!("{}: the extension knows another one than is in the wheel", library.display()));
        }
    }
    let files = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let wheel = files.flatten().map(|file| file.path()).find(|file| file.extension().is_some_and(|end| end == "whl"));
    let wheel = wheel.ok_or("maturin made no wheel")?;
    if profile == FOR_OTHERS {
        audit(&wheel, python)?;
    }
    Ok(wheel)
}

/// Checks the requirements on a wheel for others.
fn audit(wheel: &Path, python: &Path) -> Result<(), String> {
    let size = fs::metadata(wheel).map_err(|error| format!("{}: {error}", wheel.display()))?.len();
    eprintln!("{}: {:.2} MB", wheel.display(), size as f64 / 1e6);
    if size > BYTES {
        eprintln!("warning: that is more than {:.0} MB", BYTES as f64 / 1e6);
    }
    if has(python, "auditwheel") {
        // "is consistent with the following platform tag: manylinux_…"; maturin does not check the libraries next to
        let output = Command::new(python).args(["-m", "auditwheel", "show"]).arg(wheel).output();
        let output = output.map_err(|error| format!("auditwheel: {error}"))?;
        let words = String::from_utf8_lossy(&output.stdout).into_owned();
        eprintln!("{}", words.trim());
        tag_is_kept(&wheel.file_name().unwrap_or_default().to_string_lossy(), &words)?;
    }
    if has(python, "abi3audit") {
        run(Command::new(python).args(["-m", "abi3audit", "--strict", "--summary"]).arg(wheel), "abi3audit")?;
    }
    Ok(())
}

/// Compares the platform in a wheel's name with what auditwheel says of its libraries.
fn tag_is_kept(name: &str, words: &str) -> Result<(), String> {
    /// Returns the version of the C library in the first tag.
    fn glibc(text: &str) -> Option<[u32; 2]> {
        let (_, behind) = text.split_once("manylinux_")?;
        let mut numbers = behind.split('_').map(|number| number.parse().ok());
        Some([numbers.next()??, numbers.next()??])
    }
    let (_, tag) = words.split_once("platform tag").unwrap_or_default();
    match (glibc(name), glibc(tag)) {
        (Some(named), Some(needed)) if needed <= named => Ok(()),
        (named, needed) => {
            Err(format!("the wheel is named for the C library {named:?}, its libraries need {needed:?}"))
        }
    }
}

/// Writes the linker for glibc 2.17, that of manylinux2014, the oldest for which the standard library of Rust is built: zig, as `maturin
/// --zig` calls it, which names another linker than `cargo zigbuild`: each would build everything again.
///
/// # Errors
/// A message: the Python has no zig, or the file cannot be written.
pub fn linker(workspace: &Path, python: &Path) -> Result<PathBuf, String> {
    let scripts = "import ziglang, sysconfig; print(sysconfig.get_path('scripts'), end='')";
    let output = Command::new(python).args(["-c", scripts]).stderr(Stdio::null()).output();
    let output = output.map_err(|error| format!("{}: {error}", python.display()))?;
    if !output.status.success() {
        return Err(format!("{} has no zig: pip install ziglang", python.display()));
    }
    // maturin looks for the Python that has zig there
    let scripts = String::from_utf8_lossy(&output.stdout);
    let text = format!(
        "#!/bin/sh\nPATH='{scripts}':$PATH\nexec maturin zig cc -- -g -fno-sanitize=all -target {}-linux-gnu.2.17 \"$@\"\n",
        std::env::consts::ARCH
    );
    let folder = workspace.join("target");
    let file = folder.join("zig-cc");
    let written = fs::create_dir_all(folder).and_then(|()| fs::write(&file, text));
    let written = written.and_then(|()| fs::set_permissions(&file, Permissions::from_mode(0o755)));
    written.map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(file)
}

fn has(python: &Path, module: &str) -> bool {
    let import = format!("import {module}");
    let found = Command::new(python).args(["-c", &import]).stderr(Stdio::null()).status();
    found.is_ok_and(|status| status.success())
}

/// Runs a tool with its output on the standard error, because the standard output is the wheel's name.
fn run(command: &mut Command, name: &str) -> Result<(), String> {
    let ended =
        command.stdout(std::io::stderr()).status().map_err(|error| format!("{name} does not start: {error}"))?;
    if ended.success() { Ok(()) } else { Err(format!("{name}: {ended}")) }
}

#[cfg(test)]
mod test;

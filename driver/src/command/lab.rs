//! `pullout lab`.

use super::{DONE, Refusal, complain, say};
use pullout_lab::{Error, Lab, Settings};
use pullout_run::isolation;
use std::path::PathBuf;
use std::process::{Command, Stdio};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Name of a law, a case, a library, or a source (Fortran, C, C++), which is built again whenever it is saved.
    #[arg(value_name = "LAW|CASE.json|SOURCE|FILE.so")]
    subject: Option<String>,
    /// Port on this machine [default: a free one].
    #[arg(long, value_name = "PORT", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Only print the address.
    #[arg(long)]
    no_open: bool,
    /// Search this folder for plugins first (may be repeated).
    #[arg(long = "plugin-path", value_name = "DIR")]
    plugin_paths: Vec<PathBuf>,
    /// End with this process.
    #[arg(long, hide = true)]
    parent: Option<u32>,
}

pub(super) fn run(arguments: Arguments) -> Result<u8, Refusal> {
    let Arguments { subject, port, no_open, plugin_paths, parent } = arguments;
    if let Some(parent) = parent {
        // where it cannot be asked for, a lab outlives who has opened it
        let _ = isolation::die_with(parent);
    }
    let refused = |error: Error| match error {
        Error::Subject(message) => Refusal::input(message),
        Error::System(error) => Refusal::failed(error),
    };
    let lab = Lab::open(&Settings { subject, plugin_paths, port }).map_err(refused)?;
    say(&format!("{}\n", lab.address()));
    complain("Ctrl-C ends the lab");
    if !no_open {
        show(&lab.address());
    }
    lab.serve().map_err(refused)?;
    Ok(DONE)
}

/// Has the desktop's browser show a page; where there is none, the address was printed.
fn show(address: &str) {
    let program = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let has_desktop =
        cfg!(target_os = "macos") || ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    if has_desktop {
        let quiet = Stdio::null;
        let _ = Command::new(program).arg(address).stdin(quiet()).stdout(quiet()).stderr(quiet()).spawn();
    }
}

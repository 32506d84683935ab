//! The desktop's browser.

use std::env::var_os;
use std::ffi::OsStr;
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};

/// Environment variables: a desktop sets one of them, or a user who has named a browser.
const OF_A_DESKTOP: [&str; 3] = ["DISPLAY", "WAYLAND_DISPLAY", "BROWSER"];

/// Shows an address or a file in the desktop's browser.
///
/// # Errors
/// A message, if there is none.
pub(super) fn show(what: impl AsRef<OsStr>) -> Result<(), String> {
    let is_mac = cfg!(target_os = "macos");
    let program = if is_mac { "open" } else { "xdg-open" };
    if !is_mac && OF_A_DESKTOP.iter().all(|name| var_os(name).is_none()) {
        return Err("there is no desktop (DISPLAY, WAYLAND_DISPLAY and BROWSER are not set)".into());
    }
    let quiet = Stdio::null;
    let mut command = Command::new(program);
    // Ctrl-C is not the browser's
    command.arg(what).stdin(quiet()).stdout(quiet()).stderr(quiet()).process_group(0);
    let mut opening = command.spawn().map_err(|error| format!("{program} cannot be started: {error}"))?;
    // one that nobody waits for stays as a process that has ended
    std::thread::spawn(move || opening.wait());
    Ok(())
}

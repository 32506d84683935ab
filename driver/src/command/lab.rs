//! `pullout lab`.

use super::{DONE, Refusal, browser, complain, new, say};
use pullout_lab::{Lab, LabError, LabSettings};
use pullout_run::isolation;
use std::path::PathBuf;

/// Name that opens the lab for a mix of fibres.
const BRIDGING: &str = "bridging";

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Name of a law, a case, a library, a source (Fortran, C, C++), the result directory of a run, or "bridging" (from
    /// fibres to σ(w) and f_R). A source is built again whenever it is saved.
    #[arg(value_name = "LAW|CASE.json|SOURCE|FILE.so|bridging|RESULT_DIR")]
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
    /// End together with this process.
    #[arg(long, hide = true)]
    parent: Option<u32>,
}

pub(super) fn run(arguments: Arguments) -> Result<u8, Refusal> {
    let Arguments { subject, port, no_open, plugin_paths, parent } = arguments;
    if let Some(parent) = parent {
        // where it cannot be asked for, a lab outlives who has opened it
        let _ = isolation::die_with(parent);
    }
    let refused = |error: LabError| match error {
        LabError::Subject(message) => Refusal::input(message),
        LabError::System(error) => Refusal::failed(error),
    };
    let document = (subject.as_deref() == Some(BRIDGING)).then(new::bridging).transpose()?;
    let lab = Lab::open(&LabSettings { subject, document, plugin_paths, port }).map_err(refused)?;
    say(&format!("{}\n", lab.address()));
    complain("Ctrl-C ends the lab");
    if !no_open {
        // where there is none, the address was printed
        let _ = browser::show(lab.address());
    }
    lab.serve().map_err(refused)?;
    Ok(DONE)
}

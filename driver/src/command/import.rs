//! `pullout import`.

use super::{DONE, Refusal, complain, say};
use pullout_import::ImportOptions;
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(super) struct ImportArguments {
    /// The ABAQUS input file.
    #[arg(value_name = "JOB.inp")]
    job: PathBuf,
    /// New file for the case [default: standard output].
    #[arg(short, long, value_name = "CASE.json")]
    output: Option<PathBuf>,
    /// Import only this material, as the "material" of a case.
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    /// The law [default: the shipped law with the name of the material].
    #[arg(long, value_name = "NAME|FILE.so")]
    plugin: Option<String>,
}

pub(super) fn run(arguments: &ImportArguments) -> Result<u8, Refusal> {
    let options = ImportOptions { material: arguments.material.as_deref(), plugin: arguments.plugin.as_deref() };
    let imported = pullout_import::import(&arguments.job, options).map_err(Refusal::input)?;
    let text = format!("{:#}\n", imported.document);
    match &arguments.output {
        None => say(&text),
        Some(output) => {
            let mut file = File::create_new(output).map_err(|error| {
                let is_there = error.kind() == std::io::ErrorKind::AlreadyExists;
                let advice = if is_there { "; it is not overwritten" } else { "" };
                Refusal::input(format!("{}: {error}{advice}", output.display()))
            })?;
            let written = file.write_all(text.as_bytes());
            written.map_err(|error| Refusal::failed(format!("{}: {error}", output.display())))?;
        }
    }
    for what in &imported.left_out {
        complain(format!("not imported: {what}"));
    }
    Ok(DONE)
}

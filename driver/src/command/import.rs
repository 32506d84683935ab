//! `pullout import`.

use super::{BAD_INPUT, DONE, FAILED, complain, say};
use pullout_case::import::{self, Wishes};
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The input file.
    #[arg(value_name = "JOB.inp")]
    job: PathBuf,
    /// The case, a new file; default: standard output.
    #[arg(short, long, value_name = "CASE.json")]
    output: Option<PathBuf>,
    /// Only this material, as the "material" of a case.
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    /// The law; default: the shipped one that is called like the material.
    #[arg(long, value_name = "NAME|FILE.so")]
    plugin: Option<String>,
}

pub(super) fn run(arguments: &Arguments) -> u8 {
    let wishes = Wishes { material: arguments.material.as_deref(), plugin: arguments.plugin.as_deref() };
    let imported = match import::import(&arguments.job, wishes) {
        Ok(imported) => imported,
        Err(message) => {
            complain(message);
            return BAD_INPUT;
        }
    };
    let text = format!("{:#}\n", imported.document);
    let Some(output) = &arguments.output else {
        say(&text);
        tell(&imported.left_out);
        return DONE;
    };
    match File::create_new(output).and_then(|mut file| file.write_all(text.as_bytes())) {
        Ok(()) => {
            tell(&imported.left_out);
            DONE
        }
        Err(error) => {
            let is_there = error.kind() == std::io::ErrorKind::AlreadyExists;
            let advice = if is_there { "; it is not overwritten" } else { "" };
            complain(format!("{}: {error}{advice}", output.display()));
            if is_there { BAD_INPUT } else { FAILED }
        }
    }
}

fn tell(left_out: &[String]) {
    for what in left_out {
        complain(format!("not taken over: {what}"));
    }
}

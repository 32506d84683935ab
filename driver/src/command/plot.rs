//! `pullout plot`.

use super::{BAD_INPUT, DONE, FAILED, complain, say};
use crate::output::history::History;
use crate::output::plots::{self, Run, SPEC_FILE, Spec};
use std::io;
use std::path::{Path, PathBuf};

pub(super) fn plot(results: &[PathBuf], out: Option<&Path>) -> u8 {
    let mut runs = Vec::new();
    for folder in results {
        match read(folder) {
            Ok(run) => runs.push(run),
            Err(error) => {
                complain(format!("{error}: is it the result directory of a run with pictures?"));
                return BAD_INPUT;
            }
        }
    }
    let folder = out.map_or_else(|| results[0].join("plots"), Path::to_path_buf);
    let drawn = if let ([(history, spec)], None) = (&runs[..], out) {
        plots::draw(&folder, history, spec)
    } else {
        let runs: Vec<_> = runs.iter().map(|(history, spec)| Run { history, spec }).collect();
        plots::draw_overlay(&folder, &runs)
    };
    match drawn {
        Ok(pictures) => {
            pictures.iter().for_each(|picture| say(&format!("{}\n", picture.path.display())));
            DONE
        }
        Err(error) => {
            complain(error);
            FAILED
        }
    }
}

fn read(folder: &Path) -> io::Result<(History, Spec)> {
    let history = History::read(&folder.join("history.csv"))?;
    let spec = Spec::read(&folder.join("plots").join(SPEC_FILE))?;
    Ok((history, spec))
}

//! `pullout plot`.

use super::{BAD_INPUT, DONE, FAILED, complain, say};
use crate::output::history::History;
use crate::output::plots::{self, Run, SPEC_FILE, Spec, png};
use std::io;
use std::path::{Path, PathBuf};

/// `as_png`: every picture of the folder as PNG as well, those of a specimen's fields among them.
pub(super) fn plot(results: &[PathBuf], out: Option<&Path>, as_png: bool) -> u8 {
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
    let drawn = drawn.and_then(|pictures| {
        let paths = pictures.into_iter().map(|picture| picture.path).collect();
        if as_png { rasterise(&folder, paths) } else { Ok(paths) }
    });
    match drawn {
        Ok(paths) => {
            paths.iter().for_each(|path| say(&format!("{}\n", path.display())));
            DONE
        }
        Err(error) => {
            complain(error);
            FAILED
        }
    }
}

/// Adds a PNG to every SVG in a folder.
fn rasterise(folder: &Path, mut paths: Vec<PathBuf>) -> io::Result<Vec<PathBuf>> {
    let files = std::fs::read_dir(folder)?.flatten().map(|entry| entry.path());
    let mut drawings: Vec<PathBuf> =
        files.filter(|path| path.extension().is_some_and(|extension| extension == "svg")).collect();
    drawings.sort();
    for drawing in drawings {
        let png = drawing.with_extension("png");
        png::write(&png, &std::fs::read_to_string(&drawing)?)?;
        paths.push(png);
    }
    Ok(paths)
}

fn read(folder: &Path) -> io::Result<(History, Spec)> {
    let history = History::read(&folder.join("history.csv"))?;
    let spec = Spec::read(&folder.join("plots").join(SPEC_FILE))?;
    Ok((history, spec))
}

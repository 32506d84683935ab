//! `pullout plot`.

use super::{DONE, Refusal, complain, say};
use pullout_report::directory::{Kind, ResultDirectory};
use pullout_report::plots::export::{self, Export};
use pullout_report::plots::redraw::{DrawnRun, Redrawing};
use std::path::PathBuf;

/// Settings for drawing pictures again.
#[derive(Debug, clap::Args)]
pub(super) struct PlotArguments {
    /// Result directories of runs; or of one study, with --png or --pdf.
    #[arg(required = true, value_name = "RESULT_DIR")]
    results: Vec<PathBuf>,
    /// Directory for the pictures, including the field pictures of a single run [default: plots/ of the run; for
    /// several runs compared/ of the first].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also save every picture as PNG, including the field pictures of a specimen.
    #[arg(long)]
    png: bool,
    /// Also save every picture as PDF.
    #[arg(long)]
    pdf: bool,
    /// Also replace pictures that pullout did not write or that were changed since.
    #[arg(long)]
    overwrite: bool,
}

pub(super) fn plot(arguments: &PlotArguments) -> Result<u8, Refusal> {
    if arguments.png || arguments.pdf {
        export::can_export().map_err(Refusal::input)?;
    }
    let mut runs = Vec::new();
    let first = &arguments.results[0];
    let is_single = arguments.results.len() == 1;
    let is_study = is_single && first.join(pullout_study::FILE).is_file();
    if is_study && !arguments.png && !arguments.pdf {
        let message = "`pullout study` draws the pictures of a study; --png or --pdf saves them as such files";
        return Err(Refusal::input(format!("{}: {message}", first.display())));
    }
    for folder in arguments.results.iter().filter(|_| !is_study) {
        let refused = |error| Refusal::input(format!("{error}: is it the result directory of a run with pictures?"));
        runs.push(DrawnRun::read(folder).map_err(refused)?);
    }
    let (root, kind, folder) = match &arguments.out {
        Some(out) => (out, Kind::Pictures, ""),
        None if is_single => (first, if is_study { Kind::Study } else { Kind::Run }, "plots"),
        // the pictures of a run stay its own
        None => (first, Kind::Run, "compared"),
    };
    let formats: [(bool, &str, Export); 2] = [(arguments.png, "png", export::png), (arguments.pdf, "pdf", export::pdf)];
    let formats = formats.iter().filter(|(is_wanted, ..)| *is_wanted).map(|&(_, name, export)| (name, export));
    let mut directory = ResultDirectory::open_to_add(root, kind).map_err(Refusal::input)?;
    let source = is_single.then_some(first.as_path());
    let redrawing = Redrawing::new(&runs, &directory, folder, source, &Vec::from_iter(formats));
    directory.admit(redrawing.names(), arguments.overwrite).map_err(Refusal::input)?;
    directory.notes().iter().for_each(complain);
    let drawings = redrawing.draw(&mut directory)?;
    drawings.warnings.iter().for_each(|warning| complain(format!("warning: {warning}")));
    let exported = redrawing.export(&mut directory)?;
    directory.finish()?;
    let drawn = drawings.pictures.iter().map(|picture| &picture.path);
    drawn.chain(&exported).for_each(|path| say(&format!("{}\n", path.display())));
    Ok(DONE)
}

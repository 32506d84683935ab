//! `pullout animate`.

use super::{DONE, Refusal, complain, say};
use pullout_report::directory::{Kind, ResultDirectory};
use pullout_report::plots::{FOLDER, export, within};
use pullout_report::viewer::gif;
use std::path::PathBuf;

/// Name of the file.
const FILE: &str = "animation.gif";

/// Settings for an animation.
#[derive(Debug, clap::Args)]
pub(super) struct AnimateArguments {
    /// Result directory of a specimen's run.
    #[arg(value_name = "RESULT_DIR")]
    result: PathBuf,
    /// Directory for animation.gif [default: plots/ of the run].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Field to show, e.g. damage; part of its name is enough [default: the greatest principal stress].
    #[arg(long, value_name = "NAME")]
    field: Option<String>,
    /// Rectangle to show, mm [default: the whole specimen].
    #[arg(long, value_name = "X0,X1,Y0,Y1", value_parser = view, allow_hyphen_values = true)]
    view: Option<View>,
    /// Number of frames, at equal intervals of slip.
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u16).range(2..=600))]
    frames: u16,
    /// Also replace a file that pullout did not write or that was changed since.
    #[arg(long)]
    overwrite: bool,
}

/// Parses smallest x, largest x, smallest y, largest y.
type View = [f64; 4];

fn view(text: &str) -> Result<View, String> {
    let numbers: Vec<f64> = text.split(',').map(|number| number.trim().parse().unwrap_or(f64::NAN)).collect();
    let view: View = numbers.try_into().map_err(|_| "four numbers are wanted: X0,X1,Y0,Y1".to_owned())?;
    let [left, right, low, high] = view;
    let is_sound = view.iter().all(|number| number.is_finite()) && left < right && low < high;
    is_sound.then_some(view).ok_or_else(|| "X0 < X1 and Y0 < Y1 are wanted".to_owned())
}

pub(super) fn animate(arguments: &AnimateArguments) -> Result<u8, Refusal> {
    export::can_export().map_err(Refusal::input)?;
    let (root, kind, folder) = match &arguments.out {
        Some(out) => (out, Kind::Pictures, ""),
        None => (&arguments.result, Kind::Run, FOLDER),
    };
    let mut directory = ResultDirectory::open_to_add(root, kind).map_err(Refusal::input)?;
    let name = within(folder, FILE);
    directory.admit([name.as_str()], arguments.overwrite).map_err(Refusal::input)?;
    directory.notes().iter().for_each(complain);
    let frames = arguments.frames.into();
    let made = gif(&arguments.result, arguments.field.as_deref(), arguments.view, frames).map_err(Refusal::input)?;
    let file = directory.write(&name, made)?;
    directory.finish()?;
    say(&format!("{}\n", file.display()));
    Ok(DONE)
}

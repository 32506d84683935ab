//! `pullout sweep`: many runs of a case of which numbers are kept.

use super::{DONE, FAILED, Refusal, say};
use pullout_run::isolation::prints::Prints;
use pullout_run::signals;
use pullout_sweep::{Collection, Planning, Standing, Store, Work, Worked, slurm};
use serde_json::json;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Action on a sweep.
#[derive(Debug, clap::Subcommand)]
pub(super) enum Action {
    /// Begin a sweep, or give it other runs; says how many there are and how many are done.
    Plan {
        /// Sweep file; with --design it may be a case.
        #[arg(value_name = "SWEEP.json")]
        file: PathBuf,
        /// The folder of the sweep.
        #[arg(short, long, value_name = "DIR")]
        out: PathBuf,
        /// The runs as a CSV table whose header has dotted paths of the case.
        #[arg(long, value_name = "TABLE.csv")]
        design: Option<PathBuf>,
        /// Look for plugins here first (may be repeated).
        #[arg(long = "plugin-path", value_name = "DIR")]
        plugin_paths: Vec<PathBuf>,
        /// Trust no file: plugins of the search path only, no symbol in them, and no reading outside
        /// the files' folders.
        #[arg(long)]
        untrusted: bool,
    },
    /// Run what is left; a second process at the same time does no harm, and what is done is never run again.
    Work(Toil),
    /// Say how far a sweep is.
    Status {
        /// The folder of the sweep.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Print as JSON.
        #[arg(long)]
        json: bool,
    },
    /// Write one table of all rows: CSV, or lines of JSON or Parquet with the curves.
    Collect {
        /// The folder of the sweep.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// The table, by its name .csv, .jsonl or .parquet; default: CSV to the standard output.
        #[arg(short, long, value_name = "TABLE")]
        out: Option<PathBuf>,
        /// Replace a file of that name also if it is no table that was collected of this sweep, or was changed since.
        #[arg(long, requires = "out")]
        overwrite: bool,
    },
    /// Print a script that works a sweep off as an array of jobs.
    Submit {
        /// The folder of the sweep.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// The script is one for SLURM: hand it to sbatch.
        #[arg(long, required = true)]
        slurm: bool,
        /// First and last number of the array, e.g. 0-99.
        #[arg(long, value_name = "A-B", value_parser = array)]
        array: (usize, usize),
        /// Processes of each job.
        #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
        jobs: u16,
    },
}

/// Settings for working a sweep off.
#[derive(Debug, clap::Args)]
pub(super) struct Toil {
    /// The folder of the sweep.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Only the part K of N parts of the runs, K from 0.
    #[arg(long, value_name = "K/N", value_parser = chunk)]
    chunk: Option<(usize, usize)>,
    /// Processes at a time; default: the number of processors.
    #[arg(long, value_name = "J", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Write rows each time that so many runs are over; default: after half a minute.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    chunk_runs: Option<u32>,
    /// Run again what failed, crashed or took too long.
    #[arg(long)]
    again: bool,
    /// Threads of this process instead of processes, if all runs call only libraries that were built with it.
    #[arg(long)]
    in_process: bool,
    /// Trust no folder: plugins of the search path only, no symbol in them, and no reading outside the folders below files/.
    #[arg(long)]
    untrusted: bool,
    /// Say nothing but errors.
    #[arg(long)]
    quiet: bool,
}

/// "3/10".
fn chunk(text: &str) -> Result<(usize, usize), String> {
    let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    parts.filter(|(k, n)| k < n).ok_or_else(|| "write K/N, K from 0 to N - 1".into())
}

/// "0-99".
fn array(text: &str) -> Result<(usize, usize), String> {
    let ends = text.split_once('-').and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    ends.filter(|(a, b)| a <= b).ok_or_else(|| "write A-B, e.g. 0-99".into())
}

/// Does it; the result is the exit code.
pub(super) fn act(action: &Action) -> Result<u8, Refusal> {
    let done = match action {
        Action::Plan { file, out, design, plugin_paths, untrusted } => {
            let _prints = Prints::discard();
            let store = Store::new(out);
            let how = Planning { design: design.as_deref(), plugin_paths, is_untrusted: *untrusted };
            pullout_sweep::plan(file, how, &store).map_err(|errors| {
                let code = signals::received().map_or(errors.exit_code(), signals::Interrupt::exit_code);
                Refusal { code, ..errors.into() }
            })?;
            status(&store, false)
        }
        Action::Work(toil) => work(toil),
        Action::Status { folder, json } => status(&Store::new(folder), *json),
        Action::Collect { folder, out, overwrite } => collect(&Store::new(folder), out.as_deref(), *overwrite),
        Action::Submit { folder, slurm: _, array, jobs } => {
            slurm::script(&Store::new(folder), *array, *jobs).map(|script| {
                say(&script);
                DONE
            })
        }
    };
    done.map_err(|error| match error.kind() {
        io::ErrorKind::InvalidData => Refusal::input(error),
        _ => Refusal::failed(error),
    })
}

fn work(toil: &Toil) -> io::Result<u8> {
    let jobs = toil.jobs.map_or_else(|| super::processors().get(), usize::from);
    let how = Work {
        chunk: toil.chunk,
        jobs,
        chunk_runs: toil.chunk_runs.map(|count| count as usize),
        in_process: toil.in_process,
        again: toil.again,
        is_untrusted: toil.untrusted,
    };
    let start = Instant::now();
    let told = |over: usize, of: usize| {
        if !toil.quiet {
            let each = start.elapsed().as_secs_f64() / over.max(1) as f64;
            let left = Duration::from_secs_f64(each * (of - over) as f64).as_secs();
            say(&format!("{over}/{of} runs, {left} s left\n"));
        }
    };
    let Worked { kept, ran, elsewhere, left } = pullout_sweep::work(&Store::new(&toil.folder), &how, &told)?;
    if !toil.quiet {
        let seconds = start.elapsed().as_secs_f64();
        let others = if elsewhere > 0 { format!(", {elsewhere} claimed by other workers") } else { String::new() };
        let folder = toil.folder.display();
        say(&format!("{folder}: {ran} runs in {seconds:.3} s, {kept} finished before{others}, {left} to do\n"));
    }
    Ok(match signals::received() {
        Some(signal) if left > 0 => signal.exit_code(),
        _ if left > 0 => FAILED,
        _ => DONE,
    })
}

fn status(store: &Store, json: bool) -> io::Result<u8> {
    let standing = Standing::of(store)?;
    let Standing { runs, over: endings, cpu_s, wall_s } = &standing;
    say(&match json {
        true => format!(
            "{}\n",
            json!({
                "folder": store.folder(), "runs": runs, "finished": standing.finished(), "endings": endings,
                "to_do": standing.left(), "cpu_s": cpu_s, "wall_s": wall_s,
            })
        ),
        false => format!("{}: {standing}\n", store.folder().display()),
    });
    Ok(DONE)
}

fn collect(store: &Store, out: Option<&Path>, overwrite: bool) -> io::Result<u8> {
    let place = out.map(|path| Collection::at(store, path, overwrite)).transpose()?;
    let table = pullout_sweep::collect(store)?;
    match place {
        Some(place) => place.write(&table)?,
        None => {
            let mut text = Vec::new();
            table.write_csv(&mut text)?;
            say(&String::from_utf8_lossy(&text));
        }
    }
    Ok(DONE)
}

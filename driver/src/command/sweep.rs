//! `pullout sweep`: runs a case many times and keeps numbers of each run.

use super::{DONE, FAILED, Refusal, say};
use pullout_run::isolation::prints::Prints;
use pullout_run::signals;
use pullout_sweep::{Collection, Planning, Standing, Store, WorkSettings, Worked, slurm};
use serde_json::json;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Action on a sweep.
#[derive(Debug, clap::Subcommand)]
pub(super) enum Action {
    /// Start a sweep or change its runs, and print how many runs it has and how many are finished.
    Plan {
        /// Sweep file; with --design it may be a case.
        #[arg(value_name = "SWEEP.json")]
        file: PathBuf,
        /// The folder of the sweep.
        #[arg(short, long, value_name = "DIR")]
        out: PathBuf,
        /// CSV table of the runs; its header has dotted paths of the case.
        #[arg(long, value_name = "TABLE.csv")]
        design: Option<PathBuf>,
        /// Search this folder for plugins first (may be repeated).
        #[arg(long = "plugin-path", value_name = "DIR")]
        plugin_paths: Vec<PathBuf>,
        /// Treat files as untrusted: use only plugins of the search path, refuse "symbol", and read no file outside the
        /// folders of the files.
        #[arg(long)]
        untrusted: bool,
    },
    /// Execute the remaining runs. Several processes can work at the same time; finished runs are never repeated.
    Work(WorkerArguments),
    /// Print the progress of a sweep.
    Status {
        /// The folder of the sweep.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Print as JSON.
        #[arg(long)]
        json: bool,
    },
    /// Write all rows to one table: CSV, or JSON lines or Parquet, which include the curves.
    Collect {
        /// The folder of the sweep.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// The table, named *.csv, *.jsonl or *.parquet [default: CSV to standard output].
        #[arg(short, long, value_name = "TABLE")]
        out: Option<PathBuf>,
        /// Replace the file even if it is not a table collected from this sweep, or was changed since.
        #[arg(long, requires = "out")]
        overwrite: bool,
    },
    /// Print a script that executes a sweep as a job array.
    Submit {
        /// The folder of the sweep.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Print a script for SLURM; submit it with sbatch.
        #[arg(long, required = true)]
        slurm: bool,
        /// First and last index of the array, e.g. 0-99.
        #[arg(long, value_name = "A-B", value_parser = array)]
        array: (usize, usize),
        /// Number of processes in each job.
        #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
        jobs: u16,
    },
}

/// Settings for executing a sweep.
#[derive(Debug, clap::Args)]
pub(super) struct WorkerArguments {
    /// The folder of the sweep.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Execute only part K of N equal parts of the runs, K from 0 to N - 1.
    #[arg(long, value_name = "K/N", value_parser = chunk)]
    chunk: Option<(usize, usize)>,
    /// Number of processes [default: the number of processors].
    #[arg(long, value_name = "J", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Write rows after every N finished runs [default: every half minute].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    chunk_runs: Option<u32>,
    /// Repeat runs that failed, crashed or took too long.
    #[arg(long)]
    again: bool,
    /// Use threads instead of processes, if all runs call only libraries built with pullout.
    #[arg(long)]
    in_process: bool,
    /// Treat the folder as untrusted: use only plugins of the search path, refuse "symbol", and read no file outside the
    /// folders below files/.
    #[arg(long)]
    untrusted: bool,
    /// Print only errors.
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

/// Executes the action. Returns the exit code.
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
        Action::Work(arguments) => work(arguments),
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

fn work(arguments: &WorkerArguments) -> io::Result<u8> {
    let jobs = arguments.jobs.map_or_else(|| super::processors().get(), usize::from);
    let how = WorkSettings {
        chunk: arguments.chunk,
        jobs,
        chunk_runs: arguments.chunk_runs.map(|count| count as usize),
        in_process: arguments.in_process,
        again: arguments.again,
        is_untrusted: arguments.untrusted,
    };
    let start = Instant::now();
    let report_progress = |finished: usize, of: usize| {
        if !arguments.quiet {
            let each = start.elapsed().as_secs_f64() / finished.max(1) as f64;
            let seconds = Duration::from_secs_f64(each * (of - finished) as f64).as_secs();
            say(&format!("{finished}/{of} runs finished, {seconds} s to go\n"));
        }
    };
    let Worked { kept, ran, elsewhere, left } =
        pullout_sweep::work(&Store::new(&arguments.folder), &how, &report_progress)?;
    if !arguments.quiet {
        let seconds = start.elapsed().as_secs_f64();
        let others = if elsewhere > 0 { format!(", {elsewhere} claimed by other workers") } else { String::new() };
        let folder = arguments.folder.display();
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

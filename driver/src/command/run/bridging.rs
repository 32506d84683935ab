//! Runs of cases of kind "bridging": no history grows while they go on.

use super::super::{DONE, say};
use pullout_bridging::Curve;
use pullout_case::Case;
use pullout_engine::Job;
use pullout_report::bridging::conclude;
use pullout_report::directory::ResultDirectory;
use pullout_report::record::cpu_time;
use pullout_report::summary::Summary;
use pullout_run::bridging::{BridgingProgram, LoadSource, SimulationFindings, complete};
use pullout_study::Execution;
use std::io;
use std::num::NonZeroUsize;
use std::time::Instant;

/// Runs a case and writes its results. The second result is the error if something could not be written.
pub(super) fn run_case(
    case: &Case,
    program: &BridgingProgram,
    job: &Job,
    threads: NonZeroUsize,
    directory: &mut ResultDirectory,
) -> io::Result<(Summary, io::Result<()>)> {
    directory.begin(&[])?;
    let (start, cpu_start) = (Instant::now(), cpu_time());
    let done = curves(program, job, threads).and_then(|simulated| complete(program, simulated, threads));
    let times = [start.elapsed().as_secs_f64(), (cpu_time() - cpu_start).as_secs_f64()];
    let done = done.as_ref().map(|(composite, results)| (program, composite, results)).map_err(Clone::clone);
    conclude(case, directory, done, times, job.keep.draws(case))
}

/// Curves of runs of a specimen, if the case asks for them.
fn curves(
    program: &BridgingProgram,
    job: &Job,
    threads: NonZeroUsize,
) -> Result<Option<(Vec<Curve>, SimulationFindings)>, String> {
    let LoadSource::Simulated(simulations) = &program.source else { return Ok(None) };
    let execution = Execution {
        out: &simulations.cache,
        jobs: threads.get(),
        threads: 1,
        only: &[],
        force: false,
        keep_failed: true,
        overwrite: false,
    };
    let report = |name: &str, code: u8, count: usize, of: usize| {
        if !job.options.quiet {
            let how = if code == DONE { "done" } else { "FAILED" };
            say(&format!("[{count}/{of}] fibre at {name}: {how}\n"));
        }
    };
    pullout_study::curves_of_fibres(simulations, &job.case, &execution, &report).map(Some)
}

//! Sweeps on a cluster.

use crate::store::Store;
use std::io;

/// Returns the script of an array of jobs for SLURM, with these first and last numbers, each of which runs its part of a sweep
/// in so many processes.
///
/// # Errors
/// The store has no plan.
pub fn script(store: &Store, (first, last): (usize, usize), jobs: u16) -> io::Result<String> {
    let sweep = store.sweep()?;
    let name: String = sweep.title.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
    let folder = std::path::absolute(store.folder())?;
    let quoted = format!("'{}'", folder.display().to_string().replace('\'', "'\\''"));
    let count = last - first + 1;
    Ok(format!(
        "#!/bin/sh\n#SBATCH --job-name={name}\n#SBATCH --array={first}-{last}\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task={jobs}\n\
         exec pullout sweep work --quiet --jobs {jobs} --chunk $((SLURM_ARRAY_TASK_ID - {first}))/{count} -- {quoted}\n"
    ))
}

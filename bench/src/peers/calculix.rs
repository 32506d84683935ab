//! CalculiX, one thread, as `ccx` of the PATH.

use super::Side;
use crate::BenchError;
use crate::timing::children_time;
use std::path::Path;
use std::process::Command;

/// Name and version; `None`: it is not installed.
pub fn installed() -> Option<String> {
    let output = Command::new("ccx").arg("-v").output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let version = text.split_whitespace().find(|word| word.starts_with(|first: char| first.is_ascii_digit()));
    Some(format!("CalculiX {}", version.unwrap_or("")).trim().to_owned())
}

/// Runs a deck; the result is a component of the last printed reaction.
///
/// # Errors
/// The run does not finish.
pub fn run(program: &str, deck: &str, component: usize) -> Result<Side, BenchError> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("job.inp"), deck)?;
    let before = children_time();
    let output = Command::new("ccx").arg("job").current_dir(folder.path()).env("OMP_NUM_THREADS", "1").output()?;
    let seconds = (children_time() - before).as_secs_f64();
    let log = String::from_utf8_lossy(&output.stdout);
    let text = std::fs::read_to_string(folder.path().join("job.dat")).unwrap_or_default();
    match reaction(&text, component).filter(|_| log.contains("Job finished")) {
        Some(result) => {
            Ok(Side { program: program.to_owned(), seconds, result, iterations: iterations(folder.path()) })
        }
        None => Err(BenchError::Failed(format!("{program} did not finish:\n{}", last_lines(&log)))),
    }
}

/// A component of the last total force in the printed results.
fn reaction(text: &str, component: usize) -> Option<f64> {
    let totals = text.lines().skip_while(|line| !line.contains("total force"));
    let forces = totals.filter_map(|line| {
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        (numbers.len() == 3).then(|| numbers[component])
    });
    forces.last()
}

/// Returns the total number of iterations from the job's `.cvg` file; 0 if it lists none.
fn iterations(folder: &Path) -> u64 {
    let text = std::fs::read_to_string(folder.join("job.cvg")).unwrap_or_default();
    let rows =
        text.lines().filter(|line| line.split_whitespace().next().is_some_and(|word| word.parse::<u32>().is_ok()));
    rows.count() as u64
}

fn last_lines(log: &str) -> String {
    let lines: Vec<&str> = log.lines().collect();
    lines[lines.len().saturating_sub(15)..].join("\n")
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn the_last_total_force_is_the_reaction() {
        let text = "\n total force (fx,fy,fz) for set S1 and time  0.5\n\n        1.0E+00 2.0E+00  0.0E+00\n\n \
                    total force (fx,fy,fz) for set S1 and time  1.0\n\n       -1.5E+00  4.25E+02  0.0E+00\n";
        assert_eq!(reaction(text, 0), Some(-1.5));
        assert_eq!(reaction(text, 1), Some(425.0));
        assert_eq!(reaction("nothing", 1), None);
    }
}

//! Machine on which a figure was measured.

use pullout_run::date;
use std::time::SystemTime;

/// The machine, the compiler and the day.
#[derive(Clone, Debug)]
pub(super) struct Machine {
    processor: String,
    cores: usize,
    system: String,
    compiler: String,
    build: &'static str,
    date: String,
}

impl Machine {
    /// This one, today.
    pub fn here() -> Self {
        Self {
            processor: processor().unwrap_or_else(|| "unknown processor".into()),
            cores: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            compiler: compiler().unwrap_or_else(|| "unknown compiler".into()),
            build: if cfg!(debug_assertions) { "development build" } else { "release build" },
            date: date::day(SystemTime::now()),
        }
    }

    /// Returns it in one line.
    pub fn line(&self) -> String {
        let Self { processor, cores, system, compiler, build, date } = self;
        let cores = if *cores == 1 { "1 core".to_owned() } else { format!("{cores} cores") };
        format!("{processor}, {cores}, {system}; {compiler}, {build}; {date}")
    }
}

/// The first "model name" that Linux knows.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// Returns the compiler's note in this program.
fn compiler() -> Option<String> {
    use object::{Object, ObjectSection};
    let file = std::fs::read(std::env::current_exe().ok()?).ok()?;
    let program = object::File::parse(&*file).ok()?;
    let section = program.section_by_name(".comment")?;
    let notes = section.data().ok()?;
    let notes = notes.split(|byte| *byte == 0).map(String::from_utf8_lossy);
    let mut versions = notes.filter_map(|note| Some(note.strip_prefix("rustc version ")?.to_owned()));
    versions.next().map(|version| format!("rustc {}", version.split(' ').next().unwrap_or(&version)))
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn the_machine_has_a_compiler_and_cores() {
        let line = Machine::here().line();
        assert!(line.contains("rustc 1."), "{line}");
        assert!(line.contains("core"), "{line}");
    }
}

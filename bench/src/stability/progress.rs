//! Progress of a long part: a bar on a terminal, now and then a line otherwise.

use indicatif::{ProgressBar, ProgressStyle};
use pullout_report::progress::Schedule;
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Progress of a part, which all of its threads report.
pub(super) struct Progress {
    display: Display,
    part: &'static str,
    total: u64,
    done: AtomicU64,
    start: Instant,
}

enum Display {
    #[cfg(test)]
    Quiet,
    Bar(ProgressBar),
    Lines(Mutex<Lines>),
}

struct Lines {
    schedule: Schedule,
    to: Box<dyn Write + Send>,
}

impl Progress {
    /// Shows the progress of a part on standard error.
    pub fn new(part: &'static str, total: u64) -> Self {
        if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(total);
            let style = ProgressStyle::with_template("{prefix} [{bar:30}] {percent} % {elapsed}<{eta} {msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.set_prefix(part);
            bar.enable_steady_tick(Duration::from_secs(1));
            Self::with(Display::Bar(bar), part, total)
        } else {
            Self::lines(part, total, Box::new(std::io::stderr()))
        }
    }

    fn lines(part: &'static str, total: u64, to: Box<dyn Write + Send>) -> Self {
        Self::with(Display::Lines(Mutex::new(Lines { schedule: Schedule::default(), to })), part, total)
    }

    /// Says nothing.
    #[cfg(test)]
    pub fn quiet() -> Self {
        Self::with(Display::Quiet, "", 0)
    }

    fn with(display: Display, part: &'static str, total: u64) -> Self {
        Self { display, part, total, done: AtomicU64::new(0), start: Instant::now() }
    }

    /// Reports that `by` more items are done; `of` names them.
    pub fn advance(&self, by: u64, of: &str) {
        let done = by + self.done.fetch_add(by, Ordering::Relaxed);
        match &self.display {
            #[cfg(test)]
            Display::Quiet => {}
            Display::Bar(bar) => {
                bar.set_position(done);
                bar.set_message(of.to_owned());
            }
            Display::Lines(lines) => {
                let Lines { schedule, to } = &mut *lines.lock().unwrap_or_else(PoisonError::into_inner);
                let now = self.start.elapsed();
                if schedule.due(done, self.total, now) {
                    let percent = 100 * done / self.total.max(1);
                    // a closed standard error is no reason to stop
                    let _ = writeln!(to, "stability, {}: {percent} % ({} s) {of}", self.part, now.as_secs());
                }
            }
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod test {
    use super::*;
    use std::sync::Arc;

    /// A line that others may read.
    #[derive(Clone, Default)]
    struct Shared(Arc<Mutex<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().expect("no panic").write(bytes)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_line_says_how_much_of_what_is_done_and_short_parts_say_nothing() {
        let written = Shared::default();
        let mut progress = Progress::lines("laws", 1000, Box::new(written.clone()));
        progress.advance(100, "linear_elastic, 3-D");
        assert!(written.0.lock().expect("no panic").is_empty());
        progress.start = Instant::now().checked_sub(Duration::from_secs(70)).expect("a clock that ran for a minute");
        progress.advance(250, "pure_damage, 3-D");
        progress.advance(1, "pure_damage, 3-D");
        let text = String::from_utf8(written.0.lock().expect("no panic").clone()).expect("text");
        assert_eq!(text, "stability, laws: 35 % (70 s) pure_damage, 3-D\n");
    }
}

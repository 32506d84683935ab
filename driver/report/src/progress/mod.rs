//! Progress of a run: a bar on a terminal, now and then a line otherwise, nothing when quiet.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use pullout_case::Case;
use pullout_run::columns::LEADING;
use pullout_run::isolation::worker;
use pullout_run::number;
use pullout_run::path::Row;
use pullout_run::program::PointKind;
use std::fmt::Write as _;
use std::io::Write;
use std::time::{Duration, Instant};

#[cfg(test)]
mod test;

/// The bar is redrawn, and the clock read, about this often.
const REFRESH: Duration = Duration::from_millis(50);
/// Times a second that the line is written anew at most.
const REFRESHES: u8 = 20;
/// Lines are at least so far apart.
const LEAST_PAUSE: Duration = Duration::from_secs(2);
/// A line is due after so long, however little was done.
const GREATEST_PAUSE: Duration = Duration::from_secs(60);

/// Extent of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// A greatest number of increments.
    Increments(u64),
    /// A duration, s, in increments of any size.
    Time(f64),
}

/// Number of parts in which the progress of a run of some duration is shown.
const PARTS: f64 = 1000.0;

impl Extent {
    /// Returns what is done of what: increments, or parts of the time.
    fn share(self, done: u64, time: f64) -> (u64, u64) {
        match self {
            Self::Increments(total) => (done, total),
            Self::Time(total) => ((PARTS * (time / total).clamp(0.0, 1.0)) as u64, PARTS as u64),
        }
    }
}

/// Reports to standard error.
pub struct Progress {
    display: Display,
    /// Names of what is shown, and their indices among the values given to [`Self::advance`].
    shown: Vec<(String, usize)>,
    extent: Extent,
    start: Instant,
    pace: Pace,
}

enum Display {
    Quiet,
    Bar(ProgressBar),
    Lines { title: String, schedule: Schedule, to: Box<dyn Write + Send> },
    Listener(Listener),
}

/// Receives the share of a run that is done, and the present row, some 20 times a second.
pub type Listener = Box<dyn FnMut(f64, &Row<'_>) + Send>;

impl Progress {
    /// Shows the progress of a case's run of some extent.
    pub fn of(case: &Case, extent: Extent, quiet: bool) -> Self {
        Self::new(&case.name(), extent, shown(case), quiet)
    }

    /// Shows the progress of a run of some extent. `shown`: the values of the current state to show, as (name, index among the
    /// values of a row), for example `("s11", 7)`.
    fn new(title: &str, extent: Extent, shown: Vec<(String, usize)>, quiet: bool) -> Self {
        let display = if quiet {
            Display::Quiet
        } else if let Some(terminal) = worker::terminal() {
            let to = ProgressDrawTarget::term(terminal, REFRESHES);
            let bar = ProgressBar::with_draw_target(Some(extent.share(0, 0.0).1), to);
            let template = match extent {
                Extent::Increments(_) => "{prefix} [{bar:30}] {pos}/{len} {elapsed}<{eta} {msg}",
                Extent::Time(_) => "{prefix} [{bar:30}] {percent} % {elapsed}<{eta} {msg}",
            };
            bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.set_prefix(title.to_owned());
            Display::Bar(bar)
        } else {
            let to = Box::new(std::io::stderr());
            Display::Lines { title: title.to_owned(), schedule: Schedule::default(), to }
        };
        Self { display, shown, extent, start: Instant::now(), pace: Pace::default() }
    }

    /// Reports to another listener, or to none.
    pub fn to(listener: Option<Listener>, extent: Extent) -> Self {
        let display = listener.map_or(Display::Quiet, Display::Listener);
        Self { display, shown: Vec::new(), extent, start: Instant::now(), pace: Pace::default() }
    }

    /// `done` increments are finished; `row` is the last one. Costs a comparison unless something is due.
    #[inline]
    pub fn advance(&mut self, done: u64, row: &Row<'_>) {
        if done >= self.pace.next && !matches!(self.display, Display::Quiet) {
            self.report(done, row);
        }
    }

    #[cold]
    fn report(&mut self, done: u64, row: &Row<'_>) {
        let now = self.start.elapsed();
        self.pace.adapt(done, now);
        let present = || {
            let mut text = self.shown.iter().fold(String::new(), |mut text, (name, index)| {
                let value = row.values.get(*index).copied().unwrap_or(f64::NAN);
                let _ = write!(text, " {name} = {}", number::significant(value, 4));
                text
            });
            if let Extent::Time(_) = self.extent {
                let _ = write!(text, " iterations = {}", row.iterations);
            }
            text
        };
        // the first value of a row is the time
        let (part, total) = self.extent.share(done, row.values.first().copied().unwrap_or(0.0));
        match &mut self.display {
            Display::Quiet => {}
            Display::Listener(listener) => listener(part as f64 / total.max(1) as f64, row),
            Display::Bar(bar) => {
                bar.set_position(part);
                bar.set_message(present());
            }
            Display::Lines { title, schedule, to } => {
                if schedule.due(part, total, now) {
                    let percent = 100 * part / total.max(1);
                    let count = match self.extent {
                        Extent::Increments(total) => format!("{done}/{total}"),
                        Extent::Time(_) => format!("increment {done}"),
                    };
                    let seconds = now.as_secs();
                    // a closed standard error is no reason to stop a run
                    let _ = writeln!(to, "{title}: {count} ({percent} %, {seconds} s){}", present());
                }
            }
        }
    }

    /// Takes the bar away.
    pub fn finish(&mut self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}

/// Returns the columns that a progress line shows: the first strain and stress, slip and traction, or slip and load.
fn shown(case: &Case) -> Vec<(String, usize)> {
    let names: &[&str] = match case {
        Case::Path(program) => match &program.kind {
            PointKind::Point(_) => &["e11", "s11"],
            PointKind::Interface(_) => &["slip", "tau"],
        },
        Case::Pullout(_) => &["slip", "load"],
        Case::Bridging(_) => &[],
    };
    let columns = case.columns();
    let index = |name: &str| columns.iter().position(|column| column == name).map(|k| k - LEADING.len());
    names.iter().filter_map(|name| Some(((*name).to_owned(), index(name)?))).collect()
}

/// Number of increments between two readings of the clock: doubled or halved until that takes about [`REFRESH`].
struct Pace {
    next: u64,
    stride: u64,
    last: Duration,
}

impl Default for Pace {
    fn default() -> Self {
        Self { next: 1, stride: 1, last: Duration::ZERO }
    }
}

impl Pace {
    fn adapt(&mut self, done: u64, now: Duration) {
        let elapsed = now.saturating_sub(self.last);
        if elapsed < REFRESH / 2 {
            self.stride = self.stride.saturating_mul(2);
        } else if elapsed > REFRESH * 2 {
            self.stride = (self.stride / 2).max(1);
        }
        self.last = now;
        self.next = done.saturating_add(self.stride);
    }
}

/// Schedule of progress lines: about every tenth of the run, but with a smallest and a largest pause between lines. A run of
/// less than two seconds prints none.
#[derive(Default)]
pub struct Schedule {
    last: Duration,
    tenths: u64,
}

impl Schedule {
    /// Returns whether a line is due now; if so, it is the last one.
    pub fn due(&mut self, done: u64, total: u64, now: Duration) -> bool {
        let tenths = 10 * done / total.max(1);
        let pause = now.saturating_sub(self.last);
        let due = pause >= LEAST_PAUSE && (tenths > self.tenths || pause >= GREATEST_PAUSE);
        if due {
            (self.last, self.tenths) = (now, tenths);
        }
        due
    }
}

use super::*;
use std::sync::{Arc, Mutex};

#[derive(Clone, Debug, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl Shared {
    /// Whether the text is the expected one for a number of seconds from 3 to what has passed by now.
    fn is(&self, start: Instant, expected: impl Fn(u64) -> String) -> bool {
        let text = String::from_utf8(self.0.lock().unwrap().clone()).unwrap();
        (3..=start.elapsed().as_secs()).any(|seconds| text == expected(seconds))
    }
}

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn lines_come_by_tenths_and_not_too_often() {
    let mut schedule = Schedule::default();
    // 1000 increments at 0.1 s: a tenth takes 10 s
    let seconds = |k: u64| Duration::from_millis(100 * k);
    let lines: Vec<u64> = (1..=1000).filter(|&k| schedule.due(k, 1000, seconds(k))).collect();
    assert_eq!(lines, [100, 200, 300, 400, 500, 600, 700, 800, 900, 1000]);
    // 4 s in all: a line at 2 s and one at the end
    let mut schedule = Schedule::default();
    let lines: Vec<u64> = (1..=1000).filter(|&k| schedule.due(k, 1000, Duration::from_millis(4 * k))).collect();
    assert_eq!(lines, [500, 1000]);
    // one second in all: silence
    let mut schedule = Schedule::default();
    assert!((1..=1000).all(|k| !schedule.due(k, 1000, Duration::from_millis(k))));
    // a very slow one: a sign of life every minute
    let mut schedule = Schedule::default();
    assert_eq!((1..=10).filter(|&k| schedule.due(k, 1000, Duration::from_secs(30 * k))).count(), 5);
}

#[test]
fn the_clock_is_read_rarely() {
    let mut pace = Pace::default();
    // a microsecond an increment
    let readings = (1..=1_000_000).filter(|&k| {
        let due = k >= pace.next;
        if due {
            pace.adapt(k, Duration::from_micros(k));
        }
        due
    });
    assert!((10..100).contains(&readings.count()));
}

fn row(values: &[f64]) -> Row<'_> {
    Row { step: 1, increment: 1, values, iterations: 4 }
}

#[test]
fn increments_of_any_size_are_measured_by_the_time() {
    let text = Shared::default();
    let lines = Display::Lines { title: "run".into(), schedule: Schedule::default(), to: Box::new(text.clone()) };
    let start = Instant::now() - Duration::from_secs(3);
    let shown = vec![("slip".to_string(), 1), ("load".to_string(), 2)];
    let extent = Extent::Time(2.0);
    let mut progress = Progress { display: lines, shown, extent, start, pace: Pace::default() };
    progress.advance(7, &row(&[1.5, 0.2, 11.0]));
    let is_shown = text.is(start, |s| format!("run: increment 7 (75 %, {s} s) slip = 0.2 load = 11 iterations = 4\n"));
    assert!(is_shown, "{text:?}");
}

#[test]
fn a_line_shows_how_far_and_where() {
    let text = Shared::default();
    let lines = Display::Lines { title: "run".into(), schedule: Schedule::default(), to: Box::new(text.clone()) };
    let start = Instant::now() - Duration::from_secs(3);
    let shown = vec![("e11".to_string(), 1), ("s11".to_string(), 2)];
    let extent = Extent::Increments(200);
    let mut progress = Progress { display: lines, shown, extent, start, pace: Pace::default() };
    progress.advance(50, &row(&[0.25, -1e-3, 3.25]));
    progress.advance(51, &row(&[0.25, -1e-3, 3.25]));
    assert!(text.is(start, |s| format!("run: 50/200 (25 %, {s} s) e11 = −0.001 s11 = 3.25\n")), "{text:?}");
}

#[test]
fn quiet_is_quiet_and_an_empty_run_is_no_division_by_zero() {
    let mut progress = Progress::new("run", Extent::Increments(0), vec![], true);
    progress.advance(10, &row(&[]));
    assert_eq!(progress.pace.next, 1);
    let mut progress = Progress::new("run", Extent::Increments(0), vec![("s11".into(), 3)], false);
    progress.advance(10, &row(&[]));
}

//! CPU time from the kernel's books (`/proc/self/stat`).

/// Ticks per second on Linux, as user space sees them.
const TICKS: f64 = 100.0;

/// CPU time since it was started. Its methods panic where there is no `/proc`.
#[derive(Clone, Copy, Debug)]
pub struct CpuClock {
    own: f64,
    children: f64,
}

impl CpuClock {
    /// Starts a clock.
    pub fn start() -> Self {
        let (own, children) = read();
        Self { own, children }
    }

    /// Seconds of this process, user and system.
    pub fn own(&self) -> f64 {
        read().0 - self.own
    }

    /// Seconds of children that were waited for.
    pub fn children(&self) -> f64 {
        read().1 - self.children
    }
}

fn read() -> (f64, f64) {
    let text = std::fs::read_to_string("/proc/self/stat").expect("Linux has CPU times in /proc");
    // the second field, in parentheses, may hold blanks
    let after = text.rsplit_once(')').map_or("", |(_, after)| after);
    let ticks =
        |field: usize| -> f64 { after.split_whitespace().nth(field - 3).and_then(|t| t.parse().ok()).unwrap_or(0.0) };
    ((ticks(14) + ticks(15)) / TICKS, (ticks(16) + ticks(17)) / TICKS)
}

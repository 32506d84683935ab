//! The analysis as a library sees it: calls of UEXTERNALDB, and the number of the increment.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError, Weak};
use umat_abi::host::{Clock, ExternalDatabases, Library};

/// The analysis in which this process calls a library. It begins with the first call of any of its laws and ends with the last
/// [`crate::law::Plugin`] of the file: as in an analysis of several materials, all laws share one library.
#[derive(Debug, Default)]
pub(crate) struct Analysis {
    databases: Option<ExternalDatabases>,
    present: Option<Clock>,
}

/// Those of the libraries that are loaded.
static ANALYSES: Mutex<Vec<(PathBuf, Weak<Mutex<Analysis>>)>> = Mutex::new(Vec::new());

impl Analysis {
    /// That of a library.
    pub fn of(library: &Library) -> Arc<Mutex<Self>> {
        let mut analyses = ANALYSES.lock().unwrap_or_else(PoisonError::into_inner);
        analyses.retain(|(_, analysis)| analysis.strong_count() > 0);
        if let Some(analysis) =
            analyses.iter().find(|(path, _)| path == library.path()).and_then(|(_, it)| it.upgrade())
        {
            return analysis;
        }
        let analysis = Arc::default();
        analyses.push((library.path().to_owned(), Arc::downgrade(&analysis)));
        analysis
    }

    /// Begins it, unless it has begun: UEXTERNALDB with LOP = 0.
    pub fn begin(&mut self, library: &Library) -> &mut ExternalDatabases {
        self.databases.get_or_insert_with(|| ExternalDatabases::begin([library]))
    }

    /// Goes to the increment that begins at a time and takes `dtime`; its number, KINC. It is the present one as long as it begins at the
    /// same time, whatever it takes; a later beginning says that the present one has converged. The first is that which begins at 0.
    pub fn increment(&mut self, library: &Library, [time, dtime]: [f64; 2]) -> i32 {
        let before = self.present;
        let number = match before {
            _ if time <= 0.0 => 1,
            Some(clock) if clock.time[0] == time => clock.increment,
            Some(clock) if clock.time[0] < time => clock.increment + 1,
            _ => 2,
        };
        let clock = Clock { time: [time; 2], time_increment: dtime, step: 1, increment: number };
        self.present = Some(clock);
        let databases = self.begin(library);
        if let Some(before) = before.filter(|before| before.time[0] < time) {
            databases.increment_ends(Clock { time: before.time.map(|start| start + before.time_increment), ..before });
        }
        databases.increment_starts(clock);
        number
    }
}

//! Demands on a plugin (docs/reference/abi.md), tested through the dynamic loader on every shipped law.

mod calculix;
mod floating_point;
mod hosts;
mod kratos;
mod numbers;
mod random;
mod refusals;
mod rotation;

use end_to_end_tests::{LAWS, PointMemory, Sample, plugin, strain_path};
use umat_abi::host::Library;
use umat_abi::law::StressState;
use umat_abi::umat::UmatFunction;

/// A law's library with its entry point.
struct Loaded {
    law: &'static Sample,
    library: Library,
    umat: UmatFunction,
}

impl Loaded {
    fn new(law: &'static Sample) -> Self {
        let library = end_to_end_tests::open(&plugin(law.name));
        let umat = library.umat(None).expect("umat_");
        Self { law, library, umat }
    }

    /// A point some increments into a path beyond the elastic limit, and the path.
    fn loaded_point(&self, stress_state: StressState) -> (PointMemory, Vec<[f64; 6]>) {
        let mut point = PointMemory::new(self.law, stress_state);
        let path = strain_path(7, point.ntens(), self.law.strain, 12);
        for increment in &path[..8] {
            point.advance(self.umat, increment);
        }
        assert!(point.stress().iter().all(|stress| stress.is_finite() && *stress != 0.0), "{:?}", point.stress());
        point.dstran = path[8];
        (point, path)
    }
}

/// Runs a check on every law and stress state.
fn for_each_law(check: impl Fn(&Loaded, StressState)) {
    for law in LAWS {
        let loaded = Loaded::new(law);
        for stress_state in Sample::STRESS_STATES {
            check(&loaded, stress_state);
        }
    }
}

/// Runs an ignored test of this program in a process of its own and returns its stderr.
fn stderr_of_child(test: &str) -> String {
    let program = std::env::current_exe().expect("the path of this program");
    let output = std::process::Command::new(program)
        .args(["--exact", test, "--ignored", "--nocapture", "--test-threads=1"])
        .output()
        .expect("this program runs again");
    let stdout = String::from_utf8_lossy(&output.stdout);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{test}: {}\n{stdout}\n{stderr}", output.status);
    assert!(stdout.contains("1 passed"), "{test} did not run:\n{stdout}");
    stderr
}

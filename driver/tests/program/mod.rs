//! The program as its users meet it: run as a process, its files read back.
#![allow(dead_code, reason = "each test program uses a part of this module")]

use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Exit code and output of a process.
#[derive(Debug)]
pub struct Outcome {
    /// Exit code; a signal is a panic of the test.
    pub code: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Outcome {
    /// Asserts the exit code, with the messages if it is another one.
    pub fn expect(self, code: i32) -> Self {
        assert_eq!(self.code, code, "stdout:\n{}\nstderr:\n{}", self.stdout, self.stderr);
        assert!(!self.stderr.contains("panicked at"), "{}", self.stderr);
        self
    }
}

/// Sends a signal to a process.
pub fn send(signal: Signal, process: u32) {
    let process = Pid::from_raw(process.try_into().expect("a number of a process")).expect("a process");
    kill_process(process, signal).expect("a living process");
}

/// The program, with nothing of the caller's plugins.
pub fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pullout"));
    command.env_remove("PULLOUT_PLUGIN_PATH").stdin(Stdio::null());
    command
}

/// Copies the program by another process: a file that a fork of another test has open for writing cannot be started ("text file
/// busy").
pub fn copy_program_to(place: &Path) {
    let copied = Command::new("cp").arg(env!("CARGO_BIN_EXE_pullout")).arg(place).status();
    assert!(copied.expect("cp starts").success());
}

/// Runs `pullout ARGUMENTS` in a folder.
pub fn pullout_in<S: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = S>) -> Outcome {
    let output = command().current_dir(folder).args(arguments).output().expect("the program starts");
    Outcome {
        code: output.status.code().expect("an exit code, not a signal"),
        stdout: String::from_utf8(output.stdout).expect("UTF-8"),
        stderr: String::from_utf8(output.stderr).expect("UTF-8"),
    }
}

/// Asserts that a run makes the same files with a checkpoint after so many increments as without, and again where it goes on from it.
pub fn goes_on_from_a_checkpoint(desk: &Desk, case: &Path, increments: &str) {
    let run = |more: &[&str]| {
        let words = ["run".as_ref(), "--quiet".as_ref(), case.as_os_str()];
        desk.pullout(words.into_iter().chain(more.iter().map(AsRef::as_ref))).expect(0);
    };
    let [plain, kept] = ["plain", "kept"].map(|name| desk.path(name));
    run(&["--out", "plain", "--overwrite"]);
    run(&["--out", "kept", "--overwrite", "--checkpoint-every", increments]);
    // that a library's own memory is in no checkpoint is a warning
    let summary = |folder: &Path| {
        let mut summary = timeless(folder);
        summary["warnings"].take();
        summary
    };
    for again in [false, true] {
        if again {
            run(&["--restart", "kept"]);
        }
        assert!(files(&plain) == files(&kept), "goes on: {again}");
        assert_eq!(summary(&plain), summary(&kept));
    }
}

/// The mesh of a fibre that is as coarse as still shows a pull-out.
pub fn coarse_fibre() -> Value {
    json!({ "type": "perpendicular_fibre", "embedded_elements": 6, "interface_size": 2.0, "largest_size": 6.0 })
}

/// A folder for cases and results that vanishes at the end of the test.
pub struct Desk {
    folder: TempDir,
}

impl Desk {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file (folders of its name are made) and returns its path.
    pub fn write(&self, name: &str, content: &str) -> PathBuf {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
        std::fs::write(&path, content).expect("a file");
        path
    }

    /// Writes a case.
    pub fn case(&self, name: &str, case: &Value) -> PathBuf {
        self.write(name, &case.to_string())
    }

    /// `pullout ARGUMENTS` in this folder.
    pub fn pullout<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Outcome {
        pullout_in(self.folder.path(), arguments)
    }

    /// Runs a case quietly into the folder `out` and reads what it wrote.
    pub fn run(&self, case: &Path, overrides: &[&str], out: &str, code: i32) -> Run {
        let settings: Vec<&str> = overrides.iter().flat_map(|entry| ["--set", entry]).collect();
        self.run_with(case, &settings, out, code)
    }

    /// Runs a case with any further arguments.
    pub fn run_with(&self, case: &Path, more: &[&str], out: &str, code: i32) -> Run {
        let folder = self.path(out);
        let arguments =
            ["run", "--quiet", "--out"].iter().map(OsStr::new).chain([folder.as_os_str(), case.as_os_str()]);
        let outcome = self.pullout(arguments.chain(more.iter().map(OsStr::new))).expect(code);
        Run::read(&folder, outcome)
    }

    /// Returns whether any result was made here.
    pub fn has_results(&self) -> bool {
        self.path("out").exists()
    }
}

/// Returns the XML of a VTU file, without the arrays that follow it, which are bytes.
pub fn xml_of_fields(file: &Path) -> String {
    const ARRAYS: &[u8] = b"<AppendedData";
    let bytes = std::fs::read(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let end = bytes.windows(ARRAYS.len()).position(|window| window == ARRAYS).expect("arrays after the XML");
    String::from_utf8_lossy(&bytes[..end]).into_owned() + "</VTKFile>"
}

/// A result directory.
#[derive(Debug)]
pub struct Run {
    pub folder: PathBuf,
    pub outcome: Outcome,
    pub history: Table,
    pub summary: Value,
}

impl Run {
    /// Reads what an outcome left in a folder.
    pub fn read(folder: &Path, outcome: Outcome) -> Self {
        Self {
            folder: folder.to_path_buf(),
            outcome,
            history: Table::read(&folder.join("history.csv")),
            summary: json(&folder.join("summary.json")),
        }
    }

    /// Returns the text that the plugins printed on unit 6 and the standard output.
    pub fn log(&self) -> String {
        fs::read_to_string(self.folder.join("umat.log")).unwrap_or_default()
    }

    /// Returns the text that the plugins printed on unit 7.
    pub fn messages(&self) -> String {
        fs::read_to_string(self.folder.join("umat.msg")).unwrap_or_default()
    }

    /// The largest or least value of a column, over all increments.
    pub fn peak(&self, column: &str, which: &str) -> f64 {
        self.summary["peaks"][column][which].as_f64().unwrap_or_else(|| panic!("peaks.{column}.{which}"))
    }
}

/// A JSON file.
pub fn json(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A CSV file of numbers.
#[derive(Clone, Debug)]
pub struct Table {
    pub columns: Vec<String>,
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    /// Reads a file; every line must be whole, and every field a number.
    pub fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(text.ends_with('\n'), "{}: the last line is cut off", path.display());
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let columns: Vec<String> = lines.next().expect("a header").split(',').map(str::to_owned).collect();
        let number = |field: &str| field.parse().unwrap_or_else(|_| panic!("{}: '{field}'", path.display()));
        let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(number).collect()).collect();
        for row in &rows {
            assert_eq!(row.len(), columns.len(), "{}: {row:?}", path.display());
        }
        Self { columns, rows }
    }

    pub fn column(&self, name: &str) -> Vec<f64> {
        let k = self.columns.iter().position(|column| column == name).unwrap_or_else(|| panic!("no column {name}"));
        self.rows.iter().map(|row| row[k]).collect()
    }

    pub fn last(&self, name: &str) -> f64 {
        *self.column(name).last().expect("a row")
    }

    /// y at x by linear interpolation, where x first passes it.
    pub fn at(&self, x: &str, value: f64, y: &str) -> f64 {
        let (x, y) = (self.column(x), self.column(y));
        for k in 1..x.len() {
            if (x[k - 1] - value) * (x[k] - value) <= 0.0 && x[k] != x[k - 1] {
                return y[k - 1] + (y[k] - y[k - 1]) * (value - x[k - 1]) / (x[k] - x[k - 1]);
            }
        }
        panic!("{value} is not reached")
    }

    /// ∫ y dx by the trapezoidal rule.
    pub fn area(&self, x: &str, y: &str) -> f64 {
        let (x, y) = (self.column(x), self.column(y));
        (1..x.len()).map(|k| 0.5 * (y[k] + y[k - 1]) * (x[k] - x[k - 1])).sum()
    }
}

/// The folder of the shipped cases.
pub fn cases() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace").join("cases")
}

/// Every shipped case file, sorted.
pub fn case_files() -> Vec<PathBuf> {
    fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                collect(&path, files);
            } else if path.extension().is_some_and(|extension| extension == "json") {
                files.push(path);
            }
        }
    }
    let mut files = Vec::new();
    collect(&cases(), &mut files);
    files.sort();
    assert!(files.len() > 40, "{} case files", files.len());
    files
}

/// Returns all files of a result directory, without the checkpoint and without times.
pub fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for within in ["", "fields", "plots"] {
        for entry in fs::read_dir(folder.join(within)).into_iter().flatten() {
            let path = entry.expect("an entry").path();
            let name = path.strip_prefix(folder).expect("within").to_string_lossy().into_owned();
            if path.is_file()
                && !["checkpoint.bin", "manifest.json", "summary.json", "report.html"].contains(&name.as_str())
            {
                found.insert(name, fs::read(&path).expect("a file"));
            }
        }
    }
    found
}

/// A summary without times.
pub fn timeless(folder: &Path) -> Value {
    let mut summary = json(&folder.join("summary.json"));
    let members = summary.as_object_mut().expect("an object");
    members.retain(|name, _| !name.contains("time"));
    summary
}
